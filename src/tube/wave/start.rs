//! Slip-stick waves in closed form.
//!
//! With F = fD/c − α > 0 and y = V − fgδ/h the slip zone obeys m_a ÿ − Fẏ + hy = 0 from
//! y = F/h, ẏ = 1 to the next ẏ = 1 after T1; stick lasts T2 = y(0) − y(T1). In units of the
//! frequency ω = √(h/m_a) the zone depends on ζ = F/(2√(m_a h)) alone: ωT1 is the first zero of
//!
//! ```text
//! e^{ζτ}[cos(ητ) − (ζ/η) sin(ητ)] − 1,   η = √(1 − ζ²),
//! ```
//!
//! between π/η, where V̇ is least, and 2π/η. The wave's length L(e) = (T1 + T2)|c| tends to infinity as ζ → 1
//! and as e → ∞, so L = 2π/k has two roots — the slow and the fast wave — or none: they meet
//! where the least length is 2π/k, which is a fold.

use std::f64::consts::{PI, TAU};

use crate::continuation::zero::{boundary, zero_by_slope};
use crate::tube::model::{Constants, Model};

/// Which of the two waves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The one of larger |c|.
    Fast,
    /// Smaller |c|, close to √a: the stiff end.
    Slow,
}

/// A slip-stick wave in closed form, admissible or not: P ≥ 0 is not asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipStick {
    /// Excess speed e = |c|/√a − 1.
    pub excess: f64,
    /// Angular speed c with the sign of D, in units of Ω.
    pub speed: f64,
    /// Duration T1 of slip, in units of 1/Ω.
    pub slip: f64,
    /// Duration T2 of stick, in units of 1/Ω.
    pub stick: f64,
    /// Least V̇ in slip: it decides where the pressure first touches zero.
    pub least_rate: f64,
    /// Y = y at release, F/h.
    pub release: f64,
}

/// Why there is no slip-stick wave.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoWave {
    /// D = 0: radial and tangential motion are not coupled.
    #[error("D = 0: radial and tangential motion are not coupled, and no travelling wave exists")]
    Uncoupled,
    /// f = 0.
    #[error("f = 0: without friction nothing drives a wave; take friction > 0")]
    Frictionless,
    /// Beyond the fold in f.
    #[error(
        "no slip-stick wave of mode {mode} exists at f = {friction}: the fast and the slow wave \
         meet in a fold at f = {fold:.15} and vanish beyond it; take friction below that"
    )]
    BeyondFold {
        /// Mode k.
        mode: u32,
        /// f of the model.
        friction: f64,
        /// f at which the fast and the slow wave meet.
        fold: f64,
    },
    /// Damping too strong: the stick zone has vanished.
    #[error(
        "no slip-stick wave of mode {mode} exists at mass damping α = {damping}: its stick zone \
         vanishes at the Hopf point of steady sliding, α√(ak² + h) = kf|D|, here α = {hopf:.15}"
    )]
    BeyondHopf {
        /// Mode k.
        mode: u32,
        /// α of the model, in units of Ω.
        damping: f64,
        /// α at which the stick zone vanishes, in units of Ω.
        hopf: f64,
    },
}

/// First zero ωT1 of ẏ = 1 after release, and y(T1)·h/F there, for 0 < ζ < 1.
fn shape(zeta: f64) -> (f64, f64) {
    let eta = ((1.0 - zeta) * (1.0 + zeta)).sqrt();
    // y(τ)h/F and ẏ(τ) from y = F/h = 2ζ/ω (in units of 1/ω), ẏ = 1
    let y = |tau: f64| {
        let (sine, cosine) = (eta * tau).sin_cos();
        // y₀ = 2ζ, ẏ₀ − ζy₀ = 1 − 2ζ²
        (zeta * tau).exp() * (2.0 * zeta * cosine + (1.0 - 2.0 * zeta * zeta) / eta * sine)
    };
    // e^{−ζτ}(ẏ − 1): well scaled however large the growth. It is negative at ητ = π, where ẏ is
    // least, and positive at ητ = 2π; without its last term it vanishes at the first guess.
    let excess = |tau: f64| {
        let (sine, cosine) = (eta * tau).sin_cos();
        let decay = (-zeta * tau).exp();
        (
            cosine - zeta / eta * sine - decay,
            zeta * (decay - cosine) - eta * sine,
        )
    };
    let guess = (PI + eta.atan2(zeta)) / eta;
    let rounded = |step: f64, tau: f64| step <= 2.0 * f64::EPSILON * tau;
    let (tau, _) = zero_by_slope((PI / eta, TAU / eta), guess, rounded, excess);
    (tau, y(tau) / (2.0 * zeta))
}

/// m_a and F at an excess speed e.
fn mass_and_force(parameters: &Constants, excess: f64) -> (f64, f64) {
    let coefficients = parameters.coefficients;
    let ratio = 1.0 + excess;
    let kappa = coefficients.coupling.abs() / (coefficients.a.sqrt() * ratio);
    (
        excess * (2.0 + excess) / (ratio * ratio),
        parameters.friction * kappa - parameters.mass_damping,
    )
}

/// The wave of given e, whatever its length: `None` unless 0 < ζ < 1.
fn at_excess(parameters: &Constants, excess: f64) -> Option<SlipStick> {
    let (ma, force) = mass_and_force(parameters, excess);
    let coefficients = parameters.coefficients;
    let h = coefficients.h;
    if !(ma > 0.0 && force > 0.0) {
        return None;
    }
    let omega = (h / ma).sqrt();
    let zeta = 0.5 * force / (ma * h).sqrt();
    if zeta >= 1.0 {
        return None;
    }
    let (tau, ratio) = shape(zeta);
    let eta = ((1.0 - zeta) * (1.0 + zeta)).sqrt();
    let release = force / h;
    Some(SlipStick {
        excess,
        speed: (coefficients.a.sqrt() * (1.0 + excess)).copysign(coefficients.coupling),
        slip: tau / omega,
        stick: release * (1.0 - ratio),
        // ÿ = 0 at ητ = π, where ẏ = −e^{ζπ/η}
        least_rate: -(zeta * PI / eta).exp(),
        release,
    })
}

fn length(parameters: &Constants, excess: f64) -> f64 {
    at_excess(parameters, excess).map_or(f64::INFINITY, |wave| {
        (wave.slip + wave.stick) * wave.speed.abs()
    })
}

/// e as a function of a variable x in (0, 1) that resolves both ends of the range of waves:
/// from ζ = 1 (x = 0) to F = 0 or |c| = ∞ (x = 1).
struct SpeedRange {
    lowest: f64,
    highest: f64,
}

impl SpeedRange {
    fn new(parameters: &Constants) -> Option<SpeedRange> {
        let coefficients = parameters.coefficients;
        let highest = if parameters.mass_damping > 0.0 {
            parameters.friction * coefficients.coupling.abs()
                / (parameters.mass_damping * coefficients.a.sqrt())
                - 1.0
        } else {
            f64::INFINITY
        };
        // ζ falls as e grows: bisection for ζ = 1 in log e
        let zeta_below_one = |excess: f64| {
            let (ma, force) = mass_and_force(parameters, excess);
            force < 2.0 * (ma * coefficients.h).sqrt()
        };
        let (_, log) = boundary((-80.0, 80.0), 0.0, |log| zeta_below_one(log.exp()));
        let lowest = log.exp();
        (lowest < highest).then_some(SpeedRange { lowest, highest })
    }

    fn excess(&self, x: f64) -> f64 {
        // the eighth power spreads e/lowest − 1 over many decades
        let ratio = (x / (1.0 - x)).powi(8);
        if self.highest.is_finite() {
            self.lowest + (self.highest - self.lowest) * (ratio / (1.0 + ratio))
        } else {
            self.lowest * (1.0 + ratio)
        }
    }
}

/// x of least length: a scan, and golden section where the scan finds nothing short enough.
fn shortest(parameters: &Constants, range: &SpeedRange, wanted: f64) -> f64 {
    const SCAN: u32 = 48;
    let length_at = |x: f64| length(parameters, range.excess(x));
    let mut best = (f64::INFINITY, 0.5);
    for index in 1..SCAN {
        let x = f64::from(index) / f64::from(SCAN);
        let value = length_at(x);
        if value < best.0 {
            best = (value, x);
        }
    }
    if best.0 < wanted {
        return best.1;
    }
    let width = 1.0 / f64::from(SCAN);
    let (mut low, mut high) = ((best.1 - width).max(0.0), (best.1 + width).min(1.0));
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..80 {
        let left = high - golden * (high - low);
        let right = low + golden * (high - low);
        if length_at(left) < length_at(right) {
            high = right;
        } else {
            low = left;
        }
    }
    0.5 * (low + high)
}

/// The slip-stick wave of mode k. Its numbers are exact to about 1e-15·(1 + growth of the slip
/// zone); Newton's method on the full system takes out what is left.
pub fn slip_stick(model: &Model, mode: u32, which: Which) -> Result<SlipStick, NoWave> {
    let parameters = model.constants();
    let coefficients = parameters.coefficients;
    if coefficients.coupling == 0.0 {
        return Err(NoWave::Uncoupled);
    }
    if parameters.friction <= 0.0 {
        return Err(NoWave::Frictionless);
    }
    let k = f64::from(mode);
    let wanted = TAU / k;
    let hopf = k * parameters.friction * coefficients.coupling.abs()
        / (coefficients.a * k * k + coefficients.h).sqrt();
    let beyond_hopf = NoWave::BeyondHopf {
        mode,
        damping: parameters.mass_damping,
        hopf,
    };
    let range = SpeedRange::new(&parameters).ok_or(beyond_hopf)?;
    let middle = shortest(&parameters, &range, wanted);
    if length(&parameters, range.excess(middle)) > wanted {
        return match fold_in_friction(model, mode) {
            Some(fold) if fold < parameters.friction => Err(NoWave::BeyondFold {
                mode,
                friction: parameters.friction,
                fold,
            }),
            _ => Err(beyond_hopf),
        };
    }
    // L is larger than wanted at the outer end and not larger in the middle
    let outer = match which {
        Which::Fast => 1.0,
        Which::Slow => 0.0,
    };
    if which == Which::Fast && range.highest.is_finite() {
        // F → 0: slip alone, of length 2π√(m_a/h)|c|, which must exceed the wavelength
        let (ma, _) = mass_and_force(&parameters, range.highest);
        let speed = coefficients.a.sqrt() * (1.0 + range.highest);
        if TAU * (ma / coefficients.h).sqrt() * speed <= wanted {
            return Err(beyond_hopf);
        }
    }
    let too_long = |x: f64| length(&parameters, range.excess(x)) > wanted;
    let (inner, _) = boundary((middle, outer), 0.0, too_long);
    at_excess(&parameters, range.excess(inner)).ok_or(beyond_hopf)
}

/// f at which the fast and the slow wave of mode k meet, all other parameters kept.
pub fn fold_in_friction(model: &Model, mode: u32) -> Option<f64> {
    let wanted = TAU / f64::from(mode);
    let parameters = model.constants();
    let excess = |friction: f64| {
        let parameters = Constants {
            friction,
            ..parameters
        };
        let range = SpeedRange::new(&parameters)?;
        let x = shortest(&parameters, &range, 0.0);
        Some(length(&parameters, range.excess(x)) - wanted)
    };
    // the least length grows with f; below the Hopf point of a damped model there is no wave
    let mut high = model.friction.max(1e-3);
    for _ in 0..60 {
        match excess(high) {
            Some(value) if value > 0.0 => break,
            _ => high *= 2.0,
        }
    }
    let mut low = high;
    for _ in 0..200 {
        low *= 0.7;
        match excess(low) {
            Some(value) if value <= 0.0 => break,
            Some(_) => high = low,
            None => return None,
        }
    }
    let too_long = |friction: f64| excess(friction).is_some_and(|value| value > 0.0);
    Some(boundary((low, high), 0.0, too_long).1)
}

/// Where the inequalities of the slip-stick wave fail as δ falls; it does not depend on δ itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipStickOnset {
    /// The pressure touches zero in slip at δ = −κ min V̇/g.
    pub separation: f64,
    /// Reverse slip appears before stick at δ = −(α + fκ + h(F/h − T2))/(2fg); below 0 where it never does.
    pub reverse: f64,
}

/// Where the slip-stick wave gives way to others.
pub fn onset(model: &Model, wave: &SlipStick) -> SlipStickOnset {
    let parameters = model.constants();
    let coefficients = parameters.coefficients;
    let kappa = coefficients.coupling / wave.speed;
    SlipStickOnset {
        separation: -kappa * wave.least_rate / coefficients.g,
        reverse: -(parameters.mass_damping
            + parameters.friction * kappa
            + coefficients.h * (wave.release - wave.stick))
            / (2.0 * parameters.friction * coefficients.g),
    }
}

/// δ below which the slip-stick wave is no longer admissible, for one reason or the other.
pub fn least_mismatch(model: &Model, wave: &SlipStick) -> f64 {
    let SlipStickOnset {
        separation,
        reverse,
    } = onset(model, wave);
    separation.max(reverse)
}
