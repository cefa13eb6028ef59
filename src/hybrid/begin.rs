//! The orbit that the branch of a problem begins with.

use super::saved::SavedOrbit;
use crate::affine::orbit::AffineOrbit;
use crate::affine::orbit::start::{NoOrbit, Wanted, polished};
use crate::linalg::Vector;
use crate::orbit::special::ResumeMismatch;
use crate::problem::Continuation;
use crate::problem::{OrbitStart, SystemProblem};

/// Why a run cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStart {
    /// There is no orbit.
    #[error("no start: {0}")]
    NoOrbit(#[from] NoOrbit),
    /// The branch does not begin there.
    #[error("no start: {0}")]
    NoLeg(ResumeMismatch<AffineOrbit>),
    /// The mode, a state or the parameter is not one of the system.
    #[error("no start: the beginning is none of the system")]
    Unknown,
    /// The orbit to restart from is not one of this system.
    #[error("label {label} is no orbit of this system")]
    NoRestart {
        /// Its label.
        label: usize,
    },
    /// The orbit to restart from lies outside the range.
    #[error("label {label} has {column} = {value}, outside the range ({low}, {high})")]
    LabelOutside {
        /// Its label.
        label: usize,
        /// Name of the parameter.
        column: String,
        /// Its value there.
        value: f64,
        /// Lower end of the range.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// The other branch at an event cannot be entered yet.
    #[error("`Switch` is not there yet: begin with `Simulate`, `Given` or `Restart`")]
    Switch,
}

impl NoStart {
    /// The path of the field of the problem that this is about, and what would be right there.
    pub fn about(&self) -> (&'static str, &'static str) {
        match self {
            NoStart::NoOrbit(NoOrbit::NotPeriodic { .. }) => (
                "orbit",
                "let it settle longer, admit more `periods`, or begin at other values of the parameters",
            ),
            NoStart::NoOrbit(NoOrbit::DoesNotClose { .. }) => (
                "orbit.start",
                "give the state just after a switch, and the period, to a few digits more",
            ),
            NoStart::LabelOutside { .. } => (
                "continuation.range",
                "widen the range to contain the point to restart from",
            ),
            NoStart::Switch => ("orbit.start", "write for example `start: Restart(…)`"),
            _ => (
                "orbit.start",
                "begin at another state, or at other values of the parameters",
            ),
        }
    }
}

/// Finds the first orbit of a problem. `restart` is the orbit that `start: Restart(…)` names.
pub(super) fn begin(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    restart: Option<&SavedOrbit>,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let system = &problem.system;
    let names = &system.source.parameters;
    let parameter = names.index(&continuation.parameter);
    let parameter = parameter.ok_or(NoStart::Unknown)?;
    let (low, high) = continuation.range;
    let wanted = Wanted {
        system,
        values: problem.values(),
        parameter,
        width: high - low,
        stability: problem.stability.is_some(),
    };
    let start = &problem.orbit.start;
    let place = start.beginning();
    let place = place.and_then(|beginning| beginning.place(system));
    let periods = problem.orbit.periods;
    Ok(match (start, restart) {
        (OrbitStart::Simulate { settle, .. }, _) => {
            wanted.simulated(place.ok_or(NoStart::Unknown)?, *settle, periods)?
        }
        (OrbitStart::Given { period, .. }, _) => {
            wanted.given(place.ok_or(NoStart::Unknown)?, *period, periods)?
        }
        (OrbitStart::Restart { label, .. }, Some(saved)) => {
            let value = saved.parameters.get(parameter).copied().unwrap_or(f64::NAN);
            if !(value >= low && value <= high) {
                return Err(NoStart::LabelOutside {
                    label: *label,
                    column: continuation.parameter.clone(),
                    value,
                    low,
                    high,
                });
            }
            let posed = saved.orbit(problem, parameter, high - low);
            let (orbit, guess) = posed.ok_or(NoStart::NoRestart { label: *label })?;
            let point = polished(&orbit, &guess)?;
            (orbit, point)
        }
        (OrbitStart::Restart { label, .. }, None) => {
            return Err(NoStart::NoRestart { label: *label });
        }
        (OrbitStart::Switch { .. }, _) => return Err(NoStart::Switch),
    })
}
