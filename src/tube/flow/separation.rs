//! Flow without contact: two coupled oscillators, by the matrix exponential.
//!
//! In the variables x = (√g U, √m_b U̇, √h V, √m_a W) the energy is |x|²/2 and the system reads
//! ẋ = Ax with A skew but for the damping: exp(At) never grows, so scaling and squaring is stable
//! for zones of any length. Derivatives in ln e and in the parameter are propagated with it.
//!
//! A zone entered by take-off starts at U = δ, U̇ = 0 and, because P = 0 there, Ü = 0: U − δ grows
//! like s³. The landing condition is therefore (U − δ)/s³ = 0, which is regular down to s = 0.
//! After a touch Ü > 0, and the condition is (U − δ)/s² = 0.

use nalgebra::{Matrix4, RowVector4, Vector4};

use super::contact::{SHORT_TERMS, SHORT_ZONE};
use super::exponential::MatrixJet;
use super::jet::{
    DURATION, ENTRY_W, ENTRY_Y, EXCESS, Jet, JetNumber, MultiDual, PARAMETER, SOURCES,
};
use super::square::{Pair, Square};
use super::{FlowError, Frame, Quantities, ZoneEnd};

/// More halvings than this mean more than 2⁴⁰ radians: the phase itself is lost.
const MOST_HALVINGS: i32 = 40;

/// The equations of separation in one frame.
#[derive(Clone, Copy, Debug)]
pub struct SeparationFlow {
    /// Scale of each variable: x = scale ∘ (U, U̇, V, W), held constant under differentiation.
    scale: Vector4<f64>,
    generator: MatrixJet<f64, 2>,
    norm: f64,
    mismatch: Jet,
    steady: Jet,
}

impl SeparationFlow {
    /// The equations in this frame. m_a and m_b are positive there.
    pub(crate) fn new(frame: &Frame) -> SeparationFlow {
        let number = |of: fn(&Quantities) -> f64| frame.number(of);
        let [ma, mb] = [number(|of| of.ma), number(|of| of.mb)];
        let [alpha, kappa] = [number(|of| of.damping), number(|of| of.kappa)];
        let drag = Square([[alpha / mb, kappa / mb], [-(kappa / ma), alpha / ma]]);
        let stiffness = Square::diagonal(number(|of| of.g) / mb, number(|of| of.h) / ma);
        SeparationFlow::of(frame, &drag, &stiffness)
    }

    /// The flow of z̈ = −(drag·ż + stiffness·z), z = (U, V), in this frame.
    pub(super) fn of(frame: &Frame, drag: &Square<2>, stiffness: &Square<2>) -> SeparationFlow {
        let at = &frame.at;
        let scale = Vector4::new(at.g.sqrt(), at.mb.sqrt(), at.h.sqrt(), at.ma.sqrt());
        let fill = |unit: f64, of: &dyn Fn(&MultiDual<2>) -> f64| {
            Matrix4::from_fn(|i, j| {
                let entry = match (i % 2, j % 2) {
                    (0, 1) if i / 2 == j / 2 => unit,
                    (0, _) => 0.0,
                    (_, 0) => -of(&stiffness.0[i / 2][j / 2]),
                    _ => -of(&drag.0[i / 2][j / 2]),
                };
                entry * scale[i] / scale[j]
            })
        };
        let generator = fill(1.0, &|entry| entry.value);
        SeparationFlow {
            scale,
            // the largest column sum of a nearly skew matrix bounds its spectral norm
            norm: (0..4)
                .map(|j| generator.column(j).abs().sum())
                .fold(0.0, f64::max),
            generator: MatrixJet {
                at: generator,
                by: [0, 1].map(|index| fill(0.0, &|entry| entry.by[index])),
                exponent: 0.0,
            },
            mismatch: frame.quantity(|of| of.mismatch),
            steady: frame.steady(),
        }
    }

    /// A number of each of (U, U̇, V, W), scaled.
    fn scaled<const D: usize>(
        &self,
        [position, rate]: &[Pair<D>; 2],
        of: impl Fn(&MultiDual<D>) -> f64,
    ) -> Vector4<f64> {
        let [u, u_rate, v, w] = [&position[0], &rate[0], &position[1], &rate[1]].map(of);
        Vector4::new(u, u_rate, v, w).component_mul(&self.scale)
    }

    /// (U, V) and (U̇, V̇) after a time t from these; with derivatives `moving` says that t is the
    /// duration of the zone.
    pub(super) fn carried<const D: usize>(
        &self,
        from: [Pair<D>; 2],
        t: f64,
        moving: bool,
    ) -> Result<[Pair<D>; 2], FlowError> {
        let x0 = self.scaled(&from, |number| number.value);
        let (at, flow_by) = match D {
            SOURCES => {
                let flow = self.exponential(&self.generator, t)?;
                (flow.at, flow.by)
            }
            _ => (self.transition(t)?, [Matrix4::zeros(); 2]),
        };
        let x = at * x0;
        let mut by = [0; D].map(|_| Vector4::zeros());
        for (index, by) in by.iter_mut().enumerate() {
            *by = at * self.scaled(&from, |number| number.by[index]);
            if D == SOURCES {
                *by += match index {
                    DURATION if moving => self.generator.at * x,
                    EXCESS => flow_by[0] * x0,
                    PARAMETER => flow_by[1] * x0,
                    _ => Vector4::zeros(),
                };
            }
        }
        let jet = |row: usize| MultiDual {
            value: x[row] / self.scale[row],
            by: by.map(|by| by[row] / self.scale[row]),
        };
        Ok([[jet(0), jet(2)], [jet(1), jet(3)]])
    }

    /// Radians per unit of time: a bound of the rates of the flow.
    pub(crate) fn norm(&self) -> f64 {
        self.norm
    }

    /// exp(At) without derivatives.
    fn transition(&self, t: f64) -> Result<Matrix4<f64>, FlowError> {
        let generator = MatrixJet {
            at: self.generator.at,
            by: [],
            exponent: 0.0,
        };
        self.exponential(&generator, t).map(|flow| flow.at)
    }

    /// exp(At) with the derivatives of the generator A.
    fn exponential<const D: usize>(
        &self,
        generator: &MatrixJet<f64, D>,
        t: f64,
    ) -> Result<MatrixJet<f64, D>, FlowError> {
        let size = self.norm * t.abs();
        let halvings = if size > 1.0 {
            size.log2().ceil() as i32
        } else {
            0
        };
        if !size.is_finite() || halvings > MOST_HALVINGS {
            return Err(FlowError::Overflow { duration: t });
        }
        let short = t * 0.5_f64.powi(halvings);
        let flow = generator.scaled(short).exponential(halvings as u32);
        // 1 unless damping has left next to nothing
        Ok(flow.scaled(flow.exponent.exp()))
    }

    /// (U, V) and (U̇, V̇) at the entry (Y, W), where U = δ and U̇ = 0.
    fn entry<const D: usize>(&self, [y, w]: [f64; 2]) -> [Pair<D>; 2] {
        let v = MultiDual::own(y, ENTRY_Y) + MultiDual::of(self.steady);
        [
            [MultiDual::of(self.mismatch), v],
            [MultiDual::default(), MultiDual::own(w, ENTRY_W)],
        ]
    }

    /// (U, U̇, Y, W) after a time t from the entry (Y, W).
    pub(crate) fn state(&self, entry: [f64; 2], t: f64) -> Result<[f64; 4], FlowError> {
        let [[u, v], [radial_rate, w]] = self.carried(self.entry::<0>(entry), t, false)?;
        let y = v.value - self.steady.value;
        Ok([u.value, radial_rate.value, y, w.value])
    }

    /// (U, U̇, Y, W) after a time t from the entry (Y, W), with all derivatives.
    pub(crate) fn advance(&self, entry: [f64; 2], t: f64) -> Result<[Jet; 4], FlowError> {
        let [[u, v], [radial_rate, w]] = self.carried(self.entry(entry), t, true)?;
        Ok([u, radial_rate, v - self.steady, w])
    }

    /// The zone from (Y, W) to its end after a time t; the switching function is (U − δ)/t^m, from
    /// the power series with its first m terms left out for short zones: m = 3 after take-off,
    /// 2 after a touch.
    pub(crate) fn zone(&self, entry: [f64; 2], t: f64, m: usize) -> Result<ZoneEnd, FlowError> {
        let [u, radial_rate, y, w] = self.advance(entry, t)?;
        let switching = if self.norm * t.abs() > SHORT_ZONE {
            let mut gap = (u - self.mismatch) * t.powi(-(m as i32));
            gap.by[DURATION] -= m as f64 * gap.value / t;
            gap
        } else {
            self.short_gap(entry, t, m)
        };
        Ok(ZoneEnd {
            y,
            w,
            radial_rate,
            switching,
            ..ZoneEnd::default()
        })
    }

    /// Σ_{j≥m} t^{j−m}/j! (eᵀAʲx₀) with e the radial component.
    fn short_gap(&self, entry: [f64; 2], t: f64, m: usize) -> Jet {
        let from = self.entry::<SOURCES>(entry);
        let x0 = self.scaled(&from, |number| number.value);
        let x0_by = [0, 1].map(|i| self.scaled(&from, |number| number.by[EXCESS + i]));
        let mut row = RowVector4::new(1.0 / self.scale[0], 0.0, 0.0, 0.0);
        let mut row_by = [RowVector4::zeros(); 2];
        let mut sum = Jet::default();
        let mut power = 1.0;
        let mut power_before = 0.0;
        let mut factorial = 1.0;
        for j in 1..SHORT_TERMS + m {
            factorial *= j as f64;
            for (by, generator_by) in row_by.iter_mut().zip(&self.generator.by) {
                *by = *by * self.generator.at + row * generator_by;
            }
            row *= self.generator.at;
            if j < m {
                continue;
            }
            let scale = power / factorial;
            let value = (row * x0)[0];
            sum.value += scale * value;
            sum.by[ENTRY_Y] += scale * row[2] * self.scale[2];
            sum.by[ENTRY_W] += scale * row[3] * self.scale[3];
            sum.by[DURATION] += (j - m) as f64 * power_before / factorial * value;
            for i in 0..2 {
                sum.by[EXCESS + i] += scale * ((row_by[i] * x0)[0] + (row * x0_by[i])[0]);
            }
            power_before = power;
            power *= t;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tube::model::Constants;
    use crate::tube::model::coefficients::Geometry;

    fn frame(excess: f64, damping: f64) -> Frame {
        let geometry = Geometry {
            nu: 0.3,
            xi: 1.5,
            gamma: 1.0,
        };
        let parameters = Constants {
            coefficients: geometry.coefficients(),
            friction: 0.5,
            mismatch: 0.05,
            mass_damping: damping,
            ..Constants::default()
        };
        let derivative = Constants {
            coefficients: geometry.derivative_in_nu(),
            mismatch: 0.3,
            friction: 0.2,
            mass_damping: 0.1,
            ..Constants::default()
        };
        Frame::new(&parameters, &derivative, excess).unwrap()
    }

    /// Without damping the energy is kept, for zones from 1e-9 to thousands of periods.
    #[test]
    fn energy_is_kept() {
        for excess in [0.2, 3e-5, 1e-8] {
            let flow = SeparationFlow::new(&frame(excess, 0.0));
            for t in [1e-9, 0.4, 30.0, 4e3] {
                let entry = flow.scaled(&flow.entry::<0>([0.1, -0.8]), |number| number.value);
                let x = flow.transition(t).unwrap() * entry;
                let before = entry.norm();
                // every squaring doubles the relative error of the last
                let allowed = 1e-15 * (4.0 + flow.norm * t);
                assert!((x.norm() / before - 1.0).abs() < allowed, "{excess} {t}");
            }
        }
    }

    /// The landing function has one value where the series takes over.
    #[test]
    fn short_and_long_zones_meet() {
        let frame = frame(0.2, 0.05);
        let flow = SeparationFlow::new(&frame);
        // an entry at zero pressure
        let w = -frame.weight().value / frame.at.kappa;
        let t = SHORT_ZONE / flow.norm();
        let short = flow
            .zone([0.08, w], t * (1.0 - 1e-13), 3)
            .unwrap()
            .switching;
        let long = flow
            .zone([0.08, w], t * (1.0 + 1e-13), 3)
            .unwrap()
            .switching;
        // rounding of U ≈ δ divided by t³
        let allowed = 1e-15 * 0.05 / t.powi(3) + 1e-12 * short.value.abs();
        assert!((short.value - long.value).abs() < allowed);
    }
}
