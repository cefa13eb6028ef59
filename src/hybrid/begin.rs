//! The orbit that the branch of a problem begins with.

use super::saved::LabelledOrbit;
use crate::affine::contact::place::Contradiction;
use crate::affine::equilibrium::cycle::NoCycle;
use crate::affine::motion::{Halt, Moment};
use crate::affine::orbit::behaviour::Behaviour;
use crate::affine::orbit::start::{self, Search, Wanted, first, restart};
use crate::affine::orbit::switch::switch;
use crate::affine::orbit::{AffineOrbit, OrbitTermination};
use crate::linalg::Vector;
use crate::orbit::special::ResumeMismatch;
use crate::orbit::{EventType, legs};
use crate::problem::{self, Continuation, DEFAULT_MAX_POINTS, OrbitStart, SystemProblem};

/// Why a run cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoFirstPoint {
    /// There is no orbit.
    #[error("no start: {0}")]
    NoOrbit(#[from] start::NoStart),
    /// The branch does not begin there.
    #[error("no start: {0}")]
    NoLeg(ResumeMismatch<AffineOrbit>),
    /// The problem is about equilibria.
    #[error("no start: the problem has an `equilibrium` in the place of an orbit")]
    NoSection,
    /// The mode, a state or the parameter is not one of the system.
    #[error("no start: the beginning is none of the system")]
    Unknown,
    /// The orbit to restart from is not one of this system.
    #[error("label {label} is no orbit of this system")]
    NoRestart {
        /// Its label.
        label: usize,
    },
    /// The orbit to restart from lies outside the range, or the other branch from it begins there.
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
    /// The orbit has shrunk to a point.
    #[error(
        "label {label} is where the orbits shrink to a point: the one there has no size but rounding"
    )]
    NoSize {
        /// The label.
        label: usize,
    },
    /// Only at PD and BP another branch passes.
    #[error("label {label} is of type {kind}: another branch begins at PD and BP only")]
    NotBranching {
        /// The label.
        label: usize,
        /// Its type.
        kind: String,
    },
    /// Only at HB and BE cycles are born from an equilibrium.
    #[error("label {label} is an equilibrium of type {kind}: cycles are born at HB and BE only")]
    NotHopf {
        /// The label.
        label: usize,
        /// Its type.
        kind: String,
    },
    /// The motion would begin behind a stop.
    #[error("no start: {0}")]
    Contradicted(#[from] Contradiction),
    /// The bound of friction is negative on the orbit.
    #[error("no start: {0}")]
    NegativeBound(OrbitTermination),
    /// No cycle is found there.
    #[error("no start: {0}")]
    NoCycle(NoCycle),
}

impl NoFirstPoint {
    /// The path of the field of the problem that this is about, and what would be right there.
    pub fn about(&self) -> (&'static str, &'static str) {
        match self {
            NoFirstPoint::NoOrbit(start::NoStart::NotPeriodic { .. }) => (
                "orbit",
                "let it settle longer, admit more `periods`, or begin at other values of the parameters",
            ),
            NoFirstPoint::NoOrbit(start::NoStart::Drifts { .. }) => (
                "system.modes",
                "let a reset bring the state back, as `\"s\": \"s - 1\"` does for a clock, or a bound hold it; leave it out where it \
                 only adds up",
            ),
            NoFirstPoint::NoOrbit(start::NoStart::Halted(Halt::Chattering { .. })) => (
                "orbit.start",
                "name in `rest` of the switch the mode that begins where infinitely many of them end, or begin \
                 elsewhere",
            ),
            NoFirstPoint::NoOrbit(start::NoStart::Stuck { halt, .. }) => match halt {
                Halt::Outside { .. } => (
                    "orbit.start",
                    "begin where every `zero` of the mode is positive; or reverse its sign, if the mode lies on the \
                     other side",
                ),
                Halt::Outward { .. } => (
                    "system.modes",
                    "let the reset turn the motion back, as `\"v\": \"-e*v\"` does at a stop",
                ),
                Halt::Refused { .. } => (
                    "system.contacts",
                    "let one of the two stops be a `Spring`, or begin elsewhere",
                ),
                Halt::Void { .. } => ("system.modes", "write a `zero` that the states change"),
                _ => (
                    "orbit.start",
                    "begin at another state, or at other values of the parameters",
                ),
            },
            NoFirstPoint::LabelOutside { .. } => (
                "continuation.range",
                "widen the range to contain the point to restart from",
            ),
            NoFirstPoint::NoSize { .. } => (
                "orbit.start",
                "name another label of that branch, or find orbits on the other side with `Simulate` or `Given`",
            ),
            NoFirstPoint::NoSection => (
                "equilibrium",
                "`run`, `check`, `curve` and `steady` take equilibria; write `orbit` for anything else",
            ),
            NoFirstPoint::NotHopf { .. } | NoFirstPoint::NoCycle(_) => (
                "orbit.start",
                "name the label of another HB or BE, or find a cycle with `Simulate` or `Given`",
            ),
            NoFirstPoint::NotBranching { .. } => (
                "orbit.start",
                "name a label of that type, or write `Restart` for the branch itself",
            ),
            _ => (
                "orbit.start",
                "begin at another state, or at other values of the parameters",
            ),
        }
    }
}

/// How many times as long a motion settles that is not yet periodic, and is seen to be later.
const LATER: f64 = 4.0;

/// Most returns of a motion without forcing to one switch, before it repeats itself.
const MOST_RETURNS: u32 = 64;

/// What is asked for of the first orbit.
pub(super) fn wanted(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    values: Vec<f64>,
) -> Result<Wanted, NoFirstPoint> {
    let names = &problem.system.source.parameters;
    let (low, high) = continuation.range;
    Ok(Wanted {
        system: problem.system.clone(),
        values,
        parameter: names
            .index(&continuation.parameter)
            .ok_or(NoFirstPoint::Unknown)?,
        width: high - low,
        periods: match problem.system.source.forcing {
            Some(_) => u32::try_from(problem.orbit.periods).unwrap_or(u32::MAX),
            None => MOST_RETURNS,
        },
        stability: problem.stability.is_some(),
        prescribed: problem.prescribed(),
    })
}

/// The saved orbit that a problem names.
#[derive(Clone, Debug)]
pub struct NamedOrbit {
    /// The orbit.
    pub saved: LabelledOrbit,
    /// What it is in `events.csv`; none where it is no event.
    pub kind: Option<EventType>,
    /// Whether it has shrunk to a point, beside the other orbits of its run.
    pub has_shrunk: bool,
}

/// What is asked for of the legs.
pub(super) fn plan(problem: &SystemProblem, continuation: &Continuation<String>) -> legs::Plan {
    let most = continuation.max_points.unwrap_or(DEFAULT_MAX_POINTS);
    let number = |name: &str| problem.monitor.index(name);
    continuation.plan(most, problem.output.profiles, number)
}

/// The first orbit of a branch.
pub(super) struct FirstOrbit {
    pub orbit: AffineOrbit,
    pub point: Vector,
    /// Ways that the branch goes from there.
    pub directions: Vec<bool>,
}

/// Finds the first orbit of a problem. `named` is the orbit that `start: Restart(…)` or `Switch(…)` names.
pub(super) fn begin(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    named: Option<&NamedOrbit>,
) -> Result<FirstOrbit, NoFirstPoint> {
    let start = &problem.orbit.start;
    let directions = continuation.toward.directions().to_vec();
    let along = |(orbit, point): (AffineOrbit, Vector)| FirstOrbit {
        orbit,
        point,
        directions: directions.clone(),
    };
    let search = match start {
        OrbitStart::Simulate { settle, .. } => Search::Settles(*settle),
        OrbitStart::Given { period, .. } => {
            let prescribed = || {
                let period = problem.prescribed()?.period(&problem.values(), &[]);
                Some(period.ok()?.value)
            };
            Search::Guess(period.or_else(prescribed).unwrap_or_default())
        }
        OrbitStart::Nowhere => return Err(NoFirstPoint::NoSection),
        OrbitStart::Restart { label, .. } | OrbitStart::Switch { label, .. } => {
            return from_label(problem, continuation, named, *label);
        }
    };
    let beginning = start.beginning().ok_or(NoFirstPoint::Unknown)?;
    let come_to =
        |search: Search| come_to(problem, continuation, problem.values(), &beginning, search);
    let explained = |reason: NoFirstPoint| {
        let wanted = wanted(problem, continuation, problem.values());
        let place = place(problem, &beginning, &problem.values());
        match (reason, wanted, place) {
            (NoFirstPoint::NoOrbit(reason), Ok(wanted), Ok(place)) => {
                NoFirstPoint::NoOrbit(start::explained(&wanted, &place.into(), search, reason))
            }
            (reason, ..) => reason,
        }
    };
    let reason = match come_to(search).map_err(explained) {
        Ok(found) => return Ok(along(found)),
        Err(reason) => reason,
    };
    // it has settled in the time in which it was watched
    let is_periodic = matches!(
        reason,
        NoFirstPoint::NoOrbit(start::NoStart::NotPeriodic {
            looks: Some(Behaviour::Periodic(periods)),
            ..
        }) if periods <= problem.orbit.periods
    );
    let later = match search {
        Search::Settles(time) if is_periodic && time > 0.0 => {
            come_to(Search::Settles(LATER * time)).ok()
        }
        _ => None,
    };
    later.map(along).ok_or(reason)
}

/// The first orbit of a branch that goes on from a saved one, or from another branch that passes there.
fn from_label(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    named: Option<&NamedOrbit>,
    label: usize,
) -> Result<FirstOrbit, NoFirstPoint> {
    let directions = continuation.toward.directions().to_vec();
    let NamedOrbit {
        saved,
        kind,
        has_shrunk,
    } = named.ok_or(NoFirstPoint::NoRestart { label })?;
    if *has_shrunk {
        return Err(NoFirstPoint::NoSize { label });
    }
    let wanted = wanted(problem, continuation, saved.orbit.values.clone())?;
    let (low, high) = continuation.range;
    let within = |values: &[f64]| {
        let value = values.get(wanted.parameter).copied().unwrap_or(f64::NAN);
        let outside = NoFirstPoint::LabelOutside {
            label,
            column: continuation.parameter.clone(),
            value,
            low,
            high,
        };
        (value >= low && value <= high).then_some(()).ok_or(outside)
    };
    within(&wanted.values)?;
    if matches!(problem.orbit.start, OrbitStart::Restart { .. }) {
        let (orbit, point) = restart(&wanted, &saved.orbit)?;
        return Ok(FirstOrbit {
            orbit,
            point,
            directions,
        });
    }
    let doubled = match kind {
        Some(EventType::PD) => true,
        Some(EventType::BP) => false,
        other => {
            let kind = other.map_or_else(|| "none".to_owned(), |kind| kind.to_string());
            return Err(NoFirstPoint::NotBranching { label, kind });
        }
    };
    let (orbit, point, directions) = switch(&wanted, &saved.orbit, doubled, &directions)?;
    within(&orbit.setting.values)?;
    Ok(FirstOrbit {
        orbit,
        point,
        directions,
    })
}

/// The orbit that a motion comes to at these values of the parameters, to be followed as a branch is, and its unknowns.
///
/// # Errors
/// Why there is none.
pub fn come_to(
    problem: &SystemProblem,
    continuation: &Continuation<String>,
    values: Vec<f64>,
    beginning: &problem::BeginningSection,
    search: Search,
) -> Result<(AffineOrbit, Vector), NoFirstPoint> {
    let wanted = wanted(problem, continuation, values)?;
    let place = place(problem, beginning, &wanted.values)?;
    Ok(first(&wanted, &place.into(), search)?)
}

/// Where a motion begins at these values of the parameters, in the mode that its contacts are in.
fn place(
    problem: &SystemProblem,
    beginning: &problem::BeginningSection,
    values: &[f64],
) -> Result<Moment, NoFirstPoint> {
    let system = &problem.system;
    let at = system.at(values, &[]).map_err(start::NoStart::System)?;
    let place = beginning.place(system, &at);
    Ok(system.fitting(&at, place.ok_or(NoFirstPoint::Unknown)?)?)
}
