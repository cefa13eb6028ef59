//! The first wave that is wanted, and why it is not found.

use super::orbit::NotEntered;
use super::special::ResumeMismatch;
use super::special::{Ending, InadmissibleWave, NoFollower};
use crate::continuation::{arclength, newton};
use crate::orbit::switch::NoBranch;
use crate::tube::flow::FlowError;
use crate::tube::model::{Model, Parameter};
use crate::tube::wave::hopf::NoHopf;
use crate::tube::wave::start::{NoWave, Which};
use crate::tube::wave::{Wave, WaveScales};

/// Most steps of a search for a first wave. At the default step lengths a branch takes a hundred
/// through its parameter and up to three hundred more through its changes of regime.
pub(super) const MOST_STEPS: usize = 5_000;

/// Why there is no first wave.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoFirstWave {
    /// No slip-stick wave exists.
    #[error("{0}")]
    NoWave(#[from] NoWave),
    /// The equations could not be evaluated.
    #[error("{0}")]
    Flow(#[from] FlowError),
    /// No wave was found at this material damping.
    #[error("no slip-stick wave is reached at β = {beta}: {reason}")]
    Damped {
        /// β asked for.
        beta: f64,
        /// How the search ended.
        reason: SearchFailure,
    },
    /// Newton's method failed on the closed form, or the branch does not begin there.
    #[error("Newton's method fails at the start: {0}")]
    Newton(SearchFailure),
    /// The wave of the regularised law was not found next to Coulomb's.
    #[error(
        "no wave of the regularised law was found next to the slip-stick wave: at ε = {epsilon} \
         V̇ comes to rest in layers of {layer:.0e} of the period, which the mesh must resolve ({reason})"
    )]
    Smoothing {
        /// ε tried.
        epsilon: f64,
        /// Length of the layers in units of the period.
        layer: f64,
        /// How Newton's method ended.
        reason: Box<NoFirstWave>,
    },
    /// The slip-stick wave does not exist at this δ, and the branch from where it exists does
    /// not reach it.
    #[error(
        "at δ = {mismatch} the wave is no longer slip-stick (its pressure vanishes or it reverses \
         below δ = {least:.15}), and the branch from there does not reach it: {reason}"
    )]
    Unreached {
        /// δ asked for.
        mismatch: f64,
        /// Least δ of the slip-stick wave.
        least: f64,
        /// How the branch ended.
        reason: SearchFailure,
    },
    /// No other branch leaves the event.
    #[error("no wave of twice the wavelength branches off: {0}")]
    NoBranch(NoBranch<Wave>),
}

impl NoFirstWave {
    /// Whether the search came to its end: the branch that leads to the model was followed until it turned
    /// back, or there is none. Otherwise it was cut short.
    pub fn came_to_an_end(&self) -> bool {
        match self {
            NoFirstWave::NoWave(_) => true,
            NoFirstWave::Damped { reason, .. } | NoFirstWave::Unreached { reason, .. } => {
                reason.came_to_an_end()
            }
            NoFirstWave::Flow(_)
            | NoFirstWave::Newton(_)
            | NoFirstWave::Smoothing { .. }
            | NoFirstWave::NoBranch(_) => false,
        }
    }
}

impl SearchFailure {
    fn came_to_an_end(&self) -> bool {
        match self {
            SearchFailure::NoStart(reason) => reason.came_to_an_end(),
            SearchFailure::Both(one, other) => one.came_to_an_end() && other.came_to_an_end(),
            SearchFailure::NoHopf(_)
            | SearchFailure::Folds { .. }
            | SearchFailure::TurnsBack { .. } => true,
            _ => false,
        }
    }
}

/// How a search for a first wave ended without one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SearchFailure {
    /// There is no wave to set out from.
    #[error("{0}")]
    NoStart(Box<NoFirstWave>),
    /// There is no Hopf point to set out from.
    #[error("{0}")]
    NoHopf(#[from] NoHopf),
    /// Neither from the undamped wave nor from the Hopf point of steady sliding.
    #[error("{0}; from the Hopf point of steady sliding: {1}")]
    Both(Box<SearchFailure>, Box<SearchFailure>),
    /// Newton's method fails.
    #[error("{0}")]
    Newton(#[from] newton::Failure<FlowError>),
    /// The wave is not admissible.
    #[error("{0}")]
    Inadmissible(#[from] InadmissibleWave),
    /// The slip-stick branch is not entered from its Hopf point.
    #[error("{0}")]
    NotEntered(#[from] NotEntered),
    /// A first step fails.
    #[error("{0}")]
    Step(#[from] arclength::Refusal<FlowError>),
    /// The branch does not begin.
    #[error("{0}")]
    NoFollower(#[from] NoFollower),
    /// The first wave is none of its branch.
    #[error("{0}")]
    ResumeMismatch(#[from] ResumeMismatch),
    /// The branch ends before.
    #[error("{0}")]
    Ended(Box<Ending>),
    /// The branch folds, where it may not.
    #[error("the branch folds at {column} = {value:e}")]
    Folds {
        /// Column of the parameter.
        column: &'static str,
        /// Its value.
        value: f64,
    },
    /// The branch winds up.
    #[error(
        "it winds through {folds} folds in {steps} steps and comes to {column} = {nearest:.6} only"
    )]
    Winds {
        /// Folds passed.
        folds: usize,
        /// Steps taken.
        steps: usize,
        /// Column of the parameter.
        column: &'static str,
        /// Its value nearest to the one wanted.
        nearest: f64,
    },
    /// The branch comes back to where it set out.
    #[error("it turns back to {column} = {value}")]
    TurnsBack {
        /// Column of the parameter.
        column: &'static str,
        /// Its value.
        value: f64,
    },
    /// The branch takes too many steps.
    #[error("it comes to {column} = {nearest:.6} only in {MOST_STEPS} steps")]
    Slow {
        /// Column of the parameter.
        column: &'static str,
        /// Its value nearest to the one wanted.
        nearest: f64,
    },
}

impl From<NoFirstWave> for SearchFailure {
    fn from(reason: NoFirstWave) -> SearchFailure {
        SearchFailure::NoStart(Box::new(reason))
    }
}

/// A first wave that is wanted.
#[derive(Clone, Copy, Debug)]
pub struct WaveRequest {
    /// Its model.
    pub model: Model,
    /// The parameter in which it is posed.
    pub parameter: Parameter,
    /// Its mode.
    pub mode: u32,
    /// Which of the two slip-stick waves it continues.
    pub which: Which,
    /// Unit of the parameter.
    pub width: f64,
}

impl WaveRequest {
    /// The same posed in another parameter.
    pub(super) fn posed_in(&self, parameter: Parameter, width: f64) -> WaveRequest {
        WaveRequest {
            parameter,
            width,
            ..*self
        }
    }

    /// Units of the wave when it has this excess speed and this largest |V̇|.
    pub(super) fn scales(&self, excess: f64, largest_rate: f64) -> WaveScales {
        WaveScales::new(&self.model, self.mode, excess, largest_rate, self.width)
    }
}
