//! The equilibrium that the branch of a problem begins with.

use super::point::LabelledEquilibrium;
use crate::affine::equilibrium::EquilibriumCurve;
use crate::affine::equilibrium::start::{
    EquilibriumGuess, EquilibriumRequest, NoFirstEquilibrium, first,
};
use crate::linalg::Vector;
use crate::orbit::EventType;
use crate::orbit::special::ResumeMismatch;
use crate::orbit::switch::{NoBranch, other};
use crate::problem::{Continuation, EquilibriumStart, SystemProblem};

/// Why a run of equilibria cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoEquilibriumStart {
    /// There is no equilibrium.
    #[error("no start: {0}")]
    None(#[from] NoFirstEquilibrium),
    /// The branch does not begin there.
    #[error("no start: {0}")]
    NoLeg(ResumeMismatch<EquilibriumCurve>),
    /// No other branch begins there.
    #[error("no start: {0}")]
    NoBranch(NoBranch<EquilibriumCurve>),
    /// The mode, a state or the parameter is not one of the system, or there is no section.
    #[error("no start: the beginning is none of the system")]
    Unknown,
    /// The equilibrium to restart from lies outside the range.
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
    /// Only at BP another branch passes.
    #[error("label {label} is of type {kind}: another branch of equilibria begins at BP only")]
    NotBranching {
        /// The label.
        label: usize,
        /// Its type.
        kind: String,
    },
}

impl NoEquilibriumStart {
    /// The path of the field of the problem that this is about, and what would be right there.
    pub fn about(&self) -> (&'static str, &'static str) {
        match self {
            NoEquilibriumStart::LabelOutside { .. } => (
                "continuation.range",
                "widen the range to contain the point to restart from",
            ),
            NoEquilibriumStart::NotBranching { .. } => (
                "equilibrium.start",
                "name a label of that type, or write `Restart` for the branch itself",
            ),
            _ => (
                "equilibrium.start",
                "`brakewave steady` lists equilibria of every mode; begin at one that is admissible, or at other values of \
                 the parameters",
            ),
        }
    }
}

/// The saved equilibrium that a problem names.
#[derive(Clone, Debug)]
pub struct NamedEquilibrium {
    /// The equilibrium.
    pub saved: LabelledEquilibrium,
    /// What it is in `events.csv`; none where it is no event.
    pub kind: Option<EventType>,
}

impl NamedEquilibrium {
    /// Values of its parameters.
    pub fn values(&self) -> &[f64] {
        &self.saved.values
    }
}

/// The first equilibrium of a branch.
pub(super) struct FirstEquilibrium {
    pub curve: EquilibriumCurve,
    pub point: Vector,
    /// Ways that the branch goes from there.
    pub directions: Vec<bool>,
}

/// Finds the first equilibrium of a problem. `named` is the one that `start: Restart(…)` or `Switch(…)` names.
pub(super) fn begin(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    named: Option<&NamedEquilibrium>,
) -> Result<FirstEquilibrium, NoEquilibriumStart> {
    let unknown = || NoEquilibriumStart::Unknown;
    let section = problem.equilibrium.as_ref().ok_or_else(unknown)?;
    let directions = continuation.toward.directions().to_vec();
    let request = |values: Vec<f64>, mode: &str| {
        let source = &problem.system.source;
        let (low, high) = continuation.range;
        Some(EquilibriumRequest {
            parameter: source.parameters.index(&continuation.parameter)?,
            mode: problem.system.mode(mode)?,
            system: problem.system.clone().with_monitors(problem.monitors()),
            width: high - low,
            values,
        })
    };
    let (request, guess) = match &section.start {
        EquilibriumStart::Given { mode, .. } => {
            let beginning = section.start.beginning();
            let at = problem.system.at(&problem.values(), &[]);
            let at = at.map_err(NoFirstEquilibrium::System)?;
            let place = beginning.and_then(|beginning| beginning.place(&problem.system, &at));
            let state = place.ok_or_else(unknown)?.state;
            let request = request(problem.values(), mode);
            (request, EquilibriumGuess::State(state.as_slice().to_vec()))
        }
        EquilibriumStart::Steady { mode, index } => {
            let request = request(problem.values(), mode);
            (request, EquilibriumGuess::Index(*index))
        }
        EquilibriumStart::Restart { .. } | EquilibriumStart::Switch { .. } => {
            let NamedEquilibrium { saved, kind } = named.ok_or_else(unknown)?;
            let request = request(saved.values.clone(), &saved.mode).ok_or_else(unknown)?;
            within(continuation, saved, request.parameter)?;
            if matches!(section.start, EquilibriumStart::Switch { .. }) {
                return switched(&request, saved, *kind, &directions);
            }
            (Some(request), EquilibriumGuess::State(saved.state.clone()))
        }
    };
    let (curve, point) = first(&request.ok_or_else(unknown)?, &guess)?;
    Ok(FirstEquilibrium {
        curve,
        point,
        directions,
    })
}

/// Refuses a saved equilibrium outside the range.
fn within(
    continuation: &Continuation<String>,
    saved: &LabelledEquilibrium,
    parameter: usize,
) -> Result<(), NoEquilibriumStart> {
    let (low, high) = continuation.range;
    let value = saved.values.get(parameter).copied().unwrap_or(f64::NAN);
    let outside = NoEquilibriumStart::LabelOutside {
        label: saved.label,
        column: continuation.parameter.clone(),
        value,
        low,
        high,
    };
    (low..=high).contains(&value).then_some(()).ok_or(outside)
}

/// The other branch at a saved event.
fn switched(
    request: &EquilibriumRequest,
    saved: &LabelledEquilibrium,
    kind: Option<EventType>,
    directions: &[bool],
) -> Result<FirstEquilibrium, NoEquilibriumStart> {
    if kind != Some(EventType::BP) {
        return Err(NoEquilibriumStart::NotBranching {
            label: saved.label,
            kind: kind.map_or_else(|| "none".to_owned(), |kind| kind.to_string()),
        });
    }
    let at = EquilibriumCurve::at(request, &saved.state);
    let (curve, point) = at.map_err(NoFirstEquilibrium::NoValue)?;
    let along = saved.along.as_ref().map(|along| curve.scaled(along));
    let (point, ways) =
        other(&curve, (&point, along), directions).map_err(NoEquilibriumStart::NoBranch)?;
    Ok(FirstEquilibrium {
        curve,
        point,
        directions: ways,
    })
}
