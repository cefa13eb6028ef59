//! The orbit that the branch of a problem begins with.

use super::saved::LabelledOrbit;
use crate::affine::motion::Halt;
use crate::affine::orbit::AffineOrbit;
use crate::affine::orbit::start::{self, Beginning, Search, Wanted, first, restart};
use crate::linalg::Vector;
use crate::orbit::special::ResumeMismatch;
use crate::problem::{Continuation, OrbitStart, SystemProblem};

/// Why a run cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStart {
    /// There is no orbit.
    #[error("no start: {0}")]
    NoOrbit(#[from] start::NoStart),
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
            NoStart::NoOrbit(start::NoStart::NotPeriodic { .. }) => (
                "orbit",
                "let it settle longer, admit more `periods`, or begin at other values of the parameters",
            ),
            NoStart::NoOrbit(start::NoStart::Halted(Halt::Chattering { .. })) => (
                "orbit.start",
                "name in `rest` of the switch the mode that begins where infinitely many of them end, or begin \
                 elsewhere",
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

/// Most returns of a motion without forcing to one switch, before it repeats itself.
const MOST_RETURNS: u32 = 64;

/// What is asked for of the first orbit.
pub(super) fn wanted(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    values: Vec<f64>,
) -> Result<Wanted, NoStart> {
    let names = &problem.system.source.parameters;
    let (low, high) = continuation.range;
    Ok(Wanted {
        system: problem.system.clone(),
        values,
        parameter: names
            .index(&continuation.parameter)
            .ok_or(NoStart::Unknown)?,
        width: high - low,
        periods: match problem.system.source.forcing {
            Some(_) => u32::try_from(problem.orbit.periods).unwrap_or(u32::MAX),
            None => MOST_RETURNS,
        },
        stability: problem.stability.is_some(),
    })
}

/// Finds the first orbit of a problem. `saved` is the orbit that `start: Restart(…)` names.
pub(super) fn begin(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    saved: Option<&LabelledOrbit>,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let start = &problem.orbit.start;
    let search = match start {
        OrbitStart::Simulate { settle, .. } => Search::Settles(*settle),
        OrbitStart::Given { period, .. } => Search::Guess(period.unwrap_or_default()),
        OrbitStart::Restart { label, .. } => {
            let saved = saved.ok_or(NoStart::NoRestart { label: *label })?;
            let wanted = wanted(problem, continuation, saved.orbit.values.clone())?;
            let value = wanted.values.get(wanted.parameter);
            let value = value.copied().unwrap_or(f64::NAN);
            let (low, high) = continuation.range;
            if !(value >= low && value <= high) {
                return Err(NoStart::LabelOutside {
                    label: *label,
                    column: continuation.parameter.clone(),
                    value,
                    low,
                    high,
                });
            }
            return Ok(restart(&wanted, &saved.orbit)?);
        }
        OrbitStart::Switch { .. } => return Err(NoStart::Switch),
    };
    let place = start.beginning();
    let place = place.and_then(|beginning| beginning.place(&problem.system));
    let place = place.ok_or(NoStart::Unknown)?;
    let beginning = Beginning {
        mode: place.mode,
        state: place.state,
        phase: place.phase,
    };
    let wanted = wanted(problem, continuation, problem.values())?;
    Ok(first(&wanted, &beginning, search)?)
}
