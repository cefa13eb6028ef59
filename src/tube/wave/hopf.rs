//! The waves at the Hopf point of steady sliding.
//!
//! The perturbation of steady sliding of mode k that travels with the growing wave neither grows nor
//! decays where, with K = ak² + h, S = kf|D| and X = α + βK,
//!
//! ```text
//! KX² = S²(1 − βX),   ω = S/X = √(K + βS²/X),   |c| = ω/k;      β = 0:  α√K = S,  ω = √K.
//! ```
//!
//! There
//!
//! ```text
//! V = fgδ/h − A cos ωs,   V̇ = Aω sin ωs
//! ```
//!
//! is a wave of any amplitude A as long as it slips everywhere: a vertical family, all at the same
//! value of the parameter, up to Aω = 1. There V̇ touches 1 and a stick zone opens: the slip-stick wave
//! begins with T2 = 0.

use crate::linalg::Vector;
use crate::tube::flow::Slide;
use crate::tube::model::signature::Signature;
use crate::tube::model::{Model, Parameter};

use super::{Wave, WaveScales};
use crate::orbit::Candidate;

/// Why there is no branch from a Hopf point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoHopf {
    /// The parameter does not pass the Hopf point in closed form.
    #[error(
        "`start: Hopf` looks for the Hopf point in Friction, MassDamping or StiffnessDamping; continue \
         in one of them"
    )]
    Parameter,
    /// No damping, or no friction: the Hopf point lies at zero.
    #[error(
        "steady sliding has its Hopf point where K(α + βK)² = k²f²D²(1 − αβ − β²K), K = ak² + h; with \
         {missing} = 0 there is none but at zero"
    )]
    Zero {
        /// What is zero, in symbols: `α = β` or `f`.
        missing: &'static str,
    },
    /// Damping beyond what any friction overcomes, or friction below what the other damping needs.
    #[error(
        "steady sliding is stable in mode {mode} whatever the {parameter}: K(α + βK)² = \
         k²f²D²(1 − αβ − β²K), K = ak² + h, has no root"
    )]
    Stable {
        /// Mode k.
        mode: u32,
        /// Column of the parameter, see [`Parameter::column`].
        parameter: &'static str,
    },
    /// The pressure of the family vanishes before a stick zone opens.
    #[error(
        "the pressure vanishes before V̇ reaches 1: take the mismatch above δ = {least:.12}, it is \
         {mismatch}"
    )]
    Separation {
        /// δ of the model.
        mismatch: f64,
        /// δ at which the pressure of the last wave of the family just touches zero.
        least: f64,
    },
}

/// The vertical family of one mode, see the top of this file.
#[derive(Clone, Debug)]
pub struct Family {
    /// Value of the parameter at the Hopf point.
    pub critical: f64,
    /// The model with that value.
    pub model: Model,
    /// One zone of slip, cut where V̇ = 0 rises.
    pub wave: Wave,
    /// Waves of amplitude 0 to 1/√K, V̇ reaching 1 in the last.
    pub points: Vec<Vector>,
}

impl Family {
    /// The wave at the end of the family as a slip-stick wave whose stick zone has no length yet.
    pub(crate) fn opening(&self) -> Candidate<Wave> {
        let wave = self.wave.with_signature(Signature::slip_stick());
        let last = &self.points[self.points.len() - 1];
        let excess = self.wave.excess_at(last);
        let period = self.wave.duration_at(last, 0);
        let zones = [period, 0.0].map(|duration| Slide::bare([0.0, 1.0], duration));
        let point = wave.pack(&zones, excess, self.critical);
        Candidate {
            orbit: wave,
            point,
            nascent: vec![1],
        }
    }
}

/// The family of mode k in `count` ≥ 2 equal steps of the amplitude; `width` is the unit of the
/// parameter.
///
/// # Errors
/// See [`NoHopf`].
pub fn family(
    model: &Model,
    parameter: Parameter,
    mode: u32,
    width: f64,
    count: usize,
) -> Result<Family, NoHopf> {
    let coefficients = model.constants().coefficients;
    let k = f64::from(mode);
    let stiffness = coefficients.a * k * k + coefficients.h;
    let drive = k * coefficients.coupling.abs();
    let critical = critical(model, parameter, stiffness, drive)?;
    // written so that NaN is refused too
    if !(critical >= 0.0 && critical.is_finite()) {
        return Err(NoHopf::Stable {
            mode,
            parameter: parameter.column(),
        });
    }
    let model = model.with(parameter, critical);
    let force = model.friction * drive;
    let beta = model.damping.stiffness;
    let moved = beta * force * force / (model.damping.mass + beta * stiffness);
    // X = 0 with β = 0 only
    let moved = if beta == 0.0 { 0.0 } else { moved };
    let frequency = (stiffness + moved).sqrt();
    // |c| = ω/k, so that e = √(1 + x) − 1 with x = (ω²/k² − a)/a
    let x = (coefficients.h + moved) / (coefficients.a * k * k);
    let excess = x / (1.0 + (1.0 + x).sqrt());
    let least = coefficients.coupling.abs() * k / (frequency * coefficients.g)
        * (1.0 + (beta * frequency).powi(2)).sqrt();
    if model.mismatch <= least {
        return Err(NoHopf::Separation {
            mismatch: model.mismatch,
            least,
        });
    }
    let wave = Wave::new(
        model,
        parameter,
        mode,
        Signature::slip_alone(),
        WaveScales::new(&model, mode, excess, 1.0, width),
    );
    let period = std::f64::consts::TAU / frequency;
    let points = (0..count)
        .map(|index| {
            let amplitude = index as f64 / (count - 1).max(1) as f64 / frequency;
            wave.pack(&[Slide::bare([-amplitude, 0.0], period)], excess, critical)
        })
        .collect();
    Ok(Family {
        critical,
        model,
        wave,
        points,
    })
}

/// The value of the parameter at which steady sliding begins to flutter: there friction does as much work as damping takes.
fn critical(
    model: &Model,
    parameter: Parameter,
    stiffness: f64,
    drive: f64,
) -> Result<f64, NoHopf> {
    let missing = |missing| Err(NoHopf::Zero { missing });
    let (alpha, beta) = (model.damping.mass, model.damping.stiffness);
    let force = model.friction * drive;
    Ok(match parameter {
        Parameter::Friction if alpha > 0.0 || beta > 0.0 => {
            let x = alpha + beta * stiffness;
            x * (stiffness / (1.0 - beta * x)).sqrt() / drive
        }
        Parameter::Friction => return missing("α = β"),
        Parameter::MassDamping if force > 0.0 => {
            // KX² + βS²X − S² = 0
            let root = (beta * beta * force * force + 4.0 * stiffness).sqrt();
            2.0 * force / (beta * force + root) - beta * stiffness
        }
        Parameter::StiffnessDamping if force > 0.0 => {
            // (K + S²/K)X² − (αS²/K)X − S² = 0
            let square = force * force;
            let first = stiffness + square / stiffness;
            let second = alpha * square / stiffness;
            let x = (second + (second * second + 4.0 * first * square).sqrt()) / (2.0 * first);
            (x - alpha) / stiffness
        }
        Parameter::MassDamping | Parameter::StiffnessDamping => return missing("f"),
        _ => return Err(NoHopf::Parameter),
    })
}
