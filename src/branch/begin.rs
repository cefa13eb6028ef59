//! The wave that the branch of a problem begins with: in closed form, from a Hopf point, or restarted.

use super::first_wave::{self, beyond_hopf};
use super::saved::SavedWave;
use super::slip_stick::polish;
use super::wanted::{NoFirstWave, WaveRequest};
use crate::continuation::newton;
use crate::linalg::Vector;
use crate::orbit::switch;
use crate::problem::{Continuation, Problem, Start};
use crate::tube::flow::method::Method;
use crate::tube::model::{FrictionLaw, Model, Parameter};
use crate::tube::wave::Wave;
use crate::tube::wave::hopf::{Family, NoHopf, family};
use crate::tube::wave::start::{NoWave, Which};

/// Why a run cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunError {
    /// Something the problem asks for that this version does not do, or a bad restart.
    #[error("{0}")]
    Asked(#[from] RefusedRequest),
    /// There is no first wave.
    #[error("no start: {0}")]
    NoStart(#[from] NoFirstWave),
    /// There is no Hopf point to start from.
    #[error("no start: {0}")]
    NoHopf(#[from] NoHopf),
}

/// What a problem asks for in vain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RefusedRequest {
    /// Material damping under another friction law than Coulomb's.
    #[error("material damping β > 0 is posed for Coulomb's law, also as the parameter of a branch")]
    MaterialLaw,
    /// Material damping by a numerical method.
    #[error("with material damping β > 0 the waves are solved in closed form")]
    MaterialMethod,
    /// The Hopf point lies outside the range.
    #[error(
        "the Hopf point of mode {mode} lies at {column} = {value:.15}, outside the range ({low}, {high})"
    )]
    HopfOutside {
        /// Mode.
        mode: u32,
        /// Column of the parameter.
        column: &'static str,
        /// Its value at the Hopf point.
        value: f64,
        /// Lower end of the range.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// The wave to restart from lies outside the range.
    #[error("label {label} has {column} = {value}, outside the range ({low}, {high})")]
    LabelOutside {
        /// Its label.
        label: usize,
        /// Column of the parameter.
        column: &'static str,
        /// Its value there.
        value: f64,
        /// Lower end of the range.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// The wave to restart from is not given.
    #[error("the wave to restart from is missing")]
    NoRestart,
    /// Spectra would be too large.
    #[error(
        "max_frequency = {max_frequency:e} takes in about {count:.0e} eigenvalues in each sector at each \
         point; lower it below {most:.0e}"
    )]
    Eigenvalues {
        /// As asked for.
        max_frequency: f64,
        /// Eigenvalues of a sector below it.
        count: f64,
        /// Largest one admitted.
        most: f64,
    },
}

impl RefusedRequest {
    /// The path of the field, and what would be right there.
    fn about(&self) -> Option<(&'static str, &'static str)> {
        Some(match self {
            RefusedRequest::MaterialLaw => (
                "model.friction_law",
                "leave out `friction_law`, or take `damping: (stiffness: 0)` and another parameter",
            ),
            RefusedRequest::MaterialMethod => ("method", "write `method: Exact`, or leave it out"),
            RefusedRequest::HopfOutside { .. } => (
                "continuation.range",
                "widen the range to contain the Hopf point",
            ),
            RefusedRequest::LabelOutside { .. } => (
                "continuation.range",
                "widen the range to contain the point to restart from",
            ),
            RefusedRequest::NoRestart => return None,
            RefusedRequest::Eigenvalues { .. } => (
                "stability.max_frequency",
                "leave it out for 12/√γ, or write a smaller one",
            ),
        })
    }
}

impl RunError {
    /// The path of the field of the problem that this is about, and what would be right there.
    pub fn about(&self) -> Option<(&'static str, &'static str)> {
        let friction = "model.friction";
        let mass = "model.damping.mass";
        let stiffness = "model.damping.stiffness";
        let mismatch = "model.mismatch";
        let elsewhere = "begin at other values of the model, or restart from a wave near these";
        Some(match self {
            RunError::Asked(refused) => return refused.about(),
            RunError::NoStart(NoFirstWave::NoWave(reason)) => match reason {
                NoWave::Uncoupled => ("model.coefficients", "take coefficients with D ≠ 0"),
                NoWave::Frictionless => (friction, "write for example `friction: 0.5`"),
                NoWave::BeyondFold { .. } => (friction, "take a smaller friction coefficient"),
                NoWave::BeyondHopf { .. } => (mass, "take less damping, or more friction"),
            },
            RunError::NoStart(NoFirstWave::Damped { .. }) => (
                stiffness,
                "take less damping, or follow the branch to it in StiffnessDamping from 0",
            ),
            RunError::NoStart(NoFirstWave::Unreached { .. }) => (
                mismatch,
                "take a larger mismatch, or follow the branch to it in Mismatch",
            ),
            RunError::NoStart(NoFirstWave::Smoothing { .. }) => (
                "model.friction_law",
                "write `friction_law: Coulomb`, or take another ε",
            ),
            RunError::NoStart(
                NoFirstWave::Flow(_) | NoFirstWave::Newton(_) | NoFirstWave::NoBranch(_),
            ) => ("wave.start", elsewhere),
            RunError::NoHopf(reason) => match reason {
                NoHopf::Parameter => (
                    "continuation.parameter",
                    "write for example `parameter: MassDamping`",
                ),
                NoHopf::Zero { missing: "f" } => (friction, "write for example `friction: 0.5`"),
                NoHopf::Zero { .. } => (
                    "model.damping",
                    "give damping, for example `damping: (mass: 0.1)`, or continue in MassDamping",
                ),
                NoHopf::Stable { .. } => ("wave.start", "take less damping, or more friction"),
                NoHopf::Separation { .. } => (mismatch, "take a mismatch above that value"),
            },
        })
    }
}

/// The beginning of a branch.
pub(super) struct Begun {
    pub wave: Wave,
    pub point: Vector,
    /// Its model, with the value of the parameter.
    pub model: Model,
    /// The vertical family before it.
    pub family: Option<Family>,
    /// Ways that the branch goes, where they are not those of the problem.
    pub directions: Vec<bool>,
}

/// Waves shown of the vertical family at a Hopf point.
const FAMILY: usize = 11;

/// The slip-stick branch is entered at this relative distance from the Hopf point: its stick zone is
/// there like the square root of it.
const BEYOND_HOPF: f64 = 1e-9;

/// Relative residual up to which a saved wave is taken as it is: rounding leaves about 1e-13.
const RESTART_RESIDUAL: f64 = 1e-11;

/// Most eigenvalues of a sector that a spectrum may take in: one of so many takes half a minute.
const MOST_EIGENVALUES: f64 = 2e4;

/// Finds the first wave of a problem. `restart` is the wave that `start: Restart(…)` names.
pub(super) fn begin(
    problem: &Problem,
    continuation: &Continuation,
    restart: Option<&SavedWave>,
    observer: first_wave::Observer,
) -> Result<Begun, RunError> {
    let parameter = continuation.parameter;
    let model = problem.model;
    let material = model.has_material_damping(parameter);
    if material && model.law != FrictionLaw::Coulomb {
        return Err(RefusedRequest::MaterialLaw.into());
    }
    if material && problem.method.is_some_and(|method| method != Method::Exact) {
        return Err(RefusedRequest::MaterialMethod.into());
    }
    let mut slip_stick = |model: Model, which: Which| {
        let wanted = WaveRequest {
            model,
            parameter,
            mode: problem.wave.mode,
            which,
            width: continuation.range.1 - continuation.range.0,
        };
        first_wave::find(&wanted, continuation.steps(), observer).map(|(wave, point)| Begun {
            wave,
            point,
            model,
            family: None,
            directions: Vec::new(),
        })
    };
    let mut begun = match (&problem.wave.start, restart) {
        (Start::Fast, _) => slip_stick(model, Which::Fast)?,
        (Start::Slow, _) => slip_stick(model, Which::Slow)?,
        (Start::Hopf, _) => {
            let family = family_in_range(&model, problem, continuation)?;
            let begun = if material {
                let (wave, point) =
                    beyond_hopf(&family, continuation.steps()).map_err(NoFirstWave::Newton)?;
                Begun {
                    model: wave.model_at(&point),
                    wave,
                    point,
                    family: None,
                    directions: Vec::new(),
                }
            } else {
                let beyond = match parameter {
                    Parameter::MassDamping => 1.0 - BEYOND_HOPF,
                    _ => 1.0 + BEYOND_HOPF,
                };
                slip_stick(model.with(parameter, family.critical * beyond), Which::Fast)?
            };
            Begun {
                family: Some(family),
                ..begun
            }
        }
        (Start::Restart { .. }, Some(saved)) => restarted(saved, &model, problem, continuation)?,
        (Start::Switch { .. }, Some(saved)) => doubled(saved, &model, problem, continuation)?,
        (Start::Restart { .. } | Start::Switch { .. }, None) => {
            return Err(RefusedRequest::NoRestart.into());
        }
    };
    if let Some(method) = problem.method.filter(|method| *method != begun.wave.method) {
        begun.wave = begun.wave.with_method(method);
        begun.point = polish(&begun.wave, &begun.point)?;
    }
    check_count(problem, &begun)?;
    Ok(begun)
}

/// Refuses a window with more eigenvalues than a spectrum may take in.
fn check_count(problem: &Problem, begun: &Begun) -> Result<(), RunError> {
    if let Some(request) = problem.request() {
        let zones = begun.wave.unpack(&begun.point);
        let period: f64 = zones.iter().map(|zone| zone.duration).sum();
        let count = request.max_frequency * period / std::f64::consts::PI;
        if count > MOST_EIGENVALUES {
            return Err(RunError::Asked(RefusedRequest::Eigenvalues {
                max_frequency: request.max_frequency,
                count,
                most: MOST_EIGENVALUES * std::f64::consts::PI / period,
            }));
        }
    }
    Ok(())
}

/// The vertical family at the Hopf point of steady sliding.
fn family_in_range(
    model: &Model,
    problem: &Problem,
    continuation: &Continuation,
) -> Result<Family, RunError> {
    let (low, high) = continuation.range;
    let mode = problem.wave.mode;
    let parameter = continuation.parameter;
    let found = family(model, parameter, mode, high - low, FAMILY)?;
    if (low..=high).contains(&found.critical) {
        return Ok(found);
    }
    Err(RunError::Asked(RefusedRequest::HopfOutside {
        mode,
        column: parameter.column(),
        value: found.critical,
        low,
        high,
    }))
}

/// A saved wave under the impact law of the problem, as it is.
fn posed(
    saved: &SavedWave,
    asked: &Model,
    problem: &Problem,
    continuation: &Continuation,
) -> Result<(Wave, Vector), RunError> {
    let parameter = continuation.parameter;
    let model = Model {
        impact: asked.impact,
        ..saved.model
    };
    let value = model.value(parameter).unwrap_or(f64::NAN);
    let (low, high) = continuation.range;
    if !(value >= low && value <= high) {
        return Err(RunError::Asked(RefusedRequest::LabelOutside {
            label: saved.label,
            column: parameter.column(),
            value,
            low,
            high,
        }));
    }
    let saved = SavedWave {
        model,
        ..saved.clone()
    };
    let wave = saved.wave(parameter, problem.wave.mode, high - low);
    let point = wave.pack(&saved.unknowns(), saved.excess, value);
    if wave.material && saved.layers.is_empty() {
        return Ok(wave.with_layers(&point).map_err(NoFirstWave::Flow)?);
    }
    Ok((wave, point))
}

/// The branch of a saved wave.
fn restarted(
    saved: &SavedWave,
    asked: &Model,
    problem: &Problem,
    continuation: &Continuation,
) -> Result<Begun, RunError> {
    let (wave, mut point) = posed(saved, asked, problem, continuation)?;
    // a saved wave solves its equations already; at a fold polishing it at a fixed parameter would fail
    let solved =
        newton::jacobian(&wave, &point).is_ok_and(|(_, residual)| residual <= RESTART_RESIDUAL);
    if !solved {
        point = polish(&wave, &point)?;
    }
    Ok(Begun {
        model: wave.model,
        wave,
        point,
        family: None,
        directions: Vec::new(),
    })
}

/// The branch of waves of twice the wavelength that leaves a saved wave, which is one of them traversed twice.
fn doubled(
    saved: &SavedWave,
    asked: &Model,
    problem: &Problem,
    continuation: &Continuation,
) -> Result<Begun, RunError> {
    let (wave, at) = posed(&saved.twice(), asked, problem, continuation)?;
    let asked = continuation.toward.directions();
    let (point, directions) =
        switch::other(&wave, (&at, None), asked).map_err(NoFirstWave::NoBranch)?;
    Ok(Begun {
        model: wave.model_at(&point),
        wave,
        point,
        family: None,
        directions,
    })
}
