//! The waves at the Hopf point of steady sliding.
//!
//! Without material damping the perturbation of steady sliding of mode k that travels with the growing
//! wave neither grows nor decays where α√K = kf|D|, K = ak² + h: there F = fκ − α = 0 at |c| = √K/k, and
//!
//! ```text
//! V = fgδ/h − A cos √K s,   V̇ = A√K sin √K s
//! ```
//!
//! is a wave of any amplitude A as long as it slips everywhere: a vertical family, all at the same
//! value of the parameter, up to A√K = 1. There V̇ touches 1 and a stick zone opens: the slip-stick wave
//! of the closed form begins with T2 = 0.

use crate::begin::scales;
use crate::linalg::Vector;
use crate::model::Model;
use crate::model::signature::{Entry, Regime, Signature, Zone};
use crate::problem::Parameter;

use super::Wave;

/// Why there is no branch from a Hopf point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoHopf {
    /// The parameter does not pass the Hopf point in closed form.
    #[error(
        "`start: Hopf` looks for the Hopf point in Friction or MassDamping; continue in one of them"
    )]
    Parameter,
    /// No damping, or no friction: the Hopf point lies at zero.
    #[error(
        "steady sliding has its Hopf point where α√(ak² + h) = kf|D|; with {missing} = 0 there is none \
         but at zero"
    )]
    Zero {
        /// What is zero.
        missing: &'static str,
    },
    /// The pressure of the family vanishes before a stick zone opens.
    #[error(
        "the pressure vanishes before V̇ reaches 1: take the mismatch above δ = {least:.12}, it is \
         {mismatch}"
    )]
    Separation {
        /// δ.
        mismatch: f64,
        /// δ needed.
        least: f64,
    },
}

/// The vertical family.
#[derive(Clone, Debug)]
pub struct Family {
    /// Value of the parameter at the Hopf point.
    pub critical: f64,
    /// The model there.
    pub model: Model,
    /// One zone of slip, cut where V̇ = 0 rises.
    pub wave: Wave,
    /// Waves of amplitude 0 to 1/√K, V̇ reaching 1 in the last.
    pub points: Vec<Vector>,
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
    let coefficients = model.parameters().coefficients;
    let k = f64::from(mode);
    let frequency = (coefficients.a * k * k + coefficients.h).sqrt();
    let drive = k * coefficients.coupling.abs();
    let missing = |missing| Err(NoHopf::Zero { missing });
    let critical = match parameter {
        Parameter::Friction if model.mass_damping > 0.0 => model.mass_damping * frequency / drive,
        Parameter::Friction => return missing("α"),
        Parameter::MassDamping if model.friction > 0.0 => model.friction * drive / frequency,
        Parameter::MassDamping => return missing("f"),
        _ => return Err(NoHopf::Parameter),
    };
    let model = model.with(parameter, critical);
    // |c| = √K/k, so that e = √(1 + x) − 1 with x = h/(ak²)
    let x = coefficients.h / (coefficients.a * k * k);
    let excess = x / (1.0 + (1.0 + x).sqrt());
    let least = coefficients.coupling.abs() * k / (frequency * coefficients.g);
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
        Signature(vec![Zone {
            regime: Regime::Slip,
            entry: Entry::Section,
        }]),
        scales(&model, mode, excess, 1.0, width),
    );
    let period = std::f64::consts::TAU / frequency;
    let points = (0..count)
        .map(|index| {
            let amplitude = index as f64 / (count - 1).max(1) as f64 / frequency;
            wave.pack(&[[-amplitude, 0.0, period]], excess, critical)
        })
        .collect();
    Ok(Family {
        critical,
        model,
        wave,
        points,
    })
}
