//! The slip-stick wave in closed form, evaluated in 200 binary digits: what the errors of everything
//! else can be measured against.
//!
//! With F = fκ − α, p = F/(2m_a), q = h/m_a and ω² = q − p² the slip zone from release is
//!
//! ```text
//! V̇ = e^{pt}[cos ωt − (p/ω) sin ωt],   y = e^{pt}[y₀ cos ωt + ((1 − py₀)/ω) sin ωt],   y₀ = F/h,
//! ```
//!
//! and e, T1 solve V̇(T1) = 1 and (T1 + y₀ − y(T1))|c| = 2π/k, by Newton's method with derivatives
//! from differences, whose step of 2⁻¹⁰⁰ leaves quadratic convergence down to 2⁻¹⁰⁰ or so.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

use crate::tube::model::Model;

use super::start::SlipStick;

type Real = FBig<HalfEven, 2>;

const PRECISION: usize = 240;

/// Newton iterations: from 1e-13 to 1e-60 in three, one to be safe.
const ITERATIONS: usize = 5;

/// Speed c and durations T1, T2 of a slip-stick wave, rounded from many more digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precise {
    /// Angular speed c with the sign of D, in units of Ω.
    pub speed: f64,
    /// Excess speed |c|/√a − 1.
    pub excess: f64,
    /// Duration T1 of slip, in units of 1/Ω.
    pub slip: f64,
    /// Duration T2 of stick, in units of 1/Ω.
    pub stick: f64,
}

fn real(value: f64) -> Option<Real> {
    Some(
        Real::try_from(value)
            .ok()?
            .with_precision(PRECISION)
            .value(),
    )
}

/// The wave next to one known in double precision, of a model under Coulomb friction; `None` if a
/// number is not finite or Newton's method does not settle.
pub fn slip_stick(model: &Model, mode: u32, near: &SlipStick) -> Option<Precise> {
    let parameters = model.constants();
    let coefficients = parameters.coefficients;
    let one = real(1.0)?;
    let two = real(2.0)?;
    let a = real(coefficients.a)?;
    let h = real(coefficients.h)?;
    let coupling = real(coefficients.coupling.abs())?;
    let friction = real(parameters.friction)?;
    let damping = real(parameters.mass_damping)?;
    let wavelength = one.atan() * real(8.0)? / real(f64::from(mode))?;
    let root = a.sqrt();
    // V̇(T1) − 1 and the length minus 2π/k, with T2
    let equations = |excess: &Real, slip: &Real| -> [Real; 3] {
        let ratio = &one + excess;
        let mass = excess * (&two + excess) / (&ratio * &ratio);
        let speed = &root * &ratio;
        let force = &friction * &coupling / &speed - &damping;
        let p = &force / (&two * &mass);
        let omega = (&h / &mass - &p * &p).sqrt();
        let release = &force / &h;
        let growth = (&p * slip).exp();
        let angle = &omega * slip;
        let (sine, cosine) = (angle.sin(), angle.cos());
        let rate = &growth * (&cosine - &p / &omega * &sine);
        let end = &growth * (&release * &cosine + (&one - &p * &release) / &omega * &sine);
        let stick = &release - end;
        let length = (slip + &stick) * speed;
        [rate - &one, length - &wavelength, stick]
    };
    let mut excess = real(near.excess)?;
    let mut slip = real(near.slip)?;
    let step = real(2.0_f64.powi(-100))?;
    for _ in 0..ITERATIONS {
        let [r1, r2, _] = equations(&excess, &slip);
        let (by_excess, by_slip) = (&excess * &step, &slip * &step);
        let [e1, e2, _] = equations(&(&excess + &by_excess), &slip);
        let [s1, s2, _] = equations(&excess, &(&slip + &by_slip));
        let (j11, j21) = ((e1 - &r1) / &by_excess, (e2 - &r2) / &by_excess);
        let (j12, j22) = ((s1 - &r1) / &by_slip, (s2 - &r2) / &by_slip);
        let determinant = &j11 * &j22 - &j12 * &j21;
        if determinant == Real::ZERO {
            return None;
        }
        excess -= (&r1 * &j22 - &r2 * &j12) / &determinant;
        slip -= (&j11 * &r2 - &j21 * &r1) / &determinant;
        if excess <= Real::ZERO || slip <= Real::ZERO {
            return None;
        }
    }
    let [r1, r2, stick] = equations(&excess, &slip);
    let settled = |residual: Real| residual.to_f64().value().abs() < 1e-30;
    if !(settled(r1) && settled(r2)) {
        return None;
    }
    let speed = (&root * (&one + &excess)).to_f64().value();
    Some(Precise {
        speed: speed.copysign(coefficients.coupling),
        excess: excess.to_f64().value(),
        slip: slip.to_f64().value(),
        stick: stick.to_f64().value(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tube::model::Damping;
    use crate::tube::model::coefficients::Geometry;
    use crate::tube::wave::start::{self, Which};

    fn model(friction: f64, damping: f64) -> Model {
        Model {
            damping: Damping {
                mass: damping,
                stiffness: 0.0,
            },
            ..Model::tube(
                Geometry {
                    nu: 0.3,
                    xi: 1.5,
                    gamma: 1.0,
                },
                friction,
                0.2,
            )
        }
    }

    /// The double-precision closed form agrees to its rounding, which the slip zone's growth e^{pT1}
    /// and the distance to the fold amplify.
    #[test]
    fn double_precision_agrees_to_rounding() {
        for (friction, damping) in [(0.01, 0.0), (0.5, 0.0), (1.0, 0.0), (0.5, 0.3)] {
            for which in [Which::Fast, Which::Slow] {
                let model = model(friction, damping);
                let closed = start::slip_stick(&model, 4, which).unwrap();
                let precise = slip_stick(&model, 4, &closed).unwrap();
                let ma = precise.excess * (2.0 + precise.excess) / (1.0 + precise.excess).powi(2);
                let h = model.constants().coefficients.h;
                let allowed = 64.0 * f64::EPSILON * (1.0 + closed.slip * (h / ma).sqrt())
                    / (1.0 - 2.0 * closed.least_rate).recip();
                let error = (closed.excess / precise.excess - 1.0).abs();
                assert!(
                    error < allowed,
                    "f = {friction}, {which:?}: {error:e} {allowed:e}"
                );
                let error = (closed.slip / precise.slip - 1.0).abs();
                assert!(
                    error < allowed,
                    "f = {friction}, {which:?}: {error:e} {allowed:e}"
                );
            }
        }
    }
}
