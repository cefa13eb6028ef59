//! What makes a point of a branch special, why a step is refused, and why a branch ends: as data. Their
//! sentences are made elsewhere.

use super::{EventType, Orbit, SpecialType, TerminationType};
use serde::{Deserialize, Serialize};

use crate::continuation::walk::{End, Refused};

/// What makes a point special.
#[derive(Clone, Debug, PartialEq)]
pub enum Special<O: Orbit> {
    /// The first point of a leg.
    Start,
    /// A fold in the parameter.
    Fold(O::Parameter),
    /// A value that was asked for.
    User(O::Parameter, f64),
    /// A value that was asked for of the monitor of this name.
    Monitor(String, f64),
    /// An edge of the range.
    Edge(O::Parameter, f64),
    /// The first point of the branch once more.
    Closed,
    /// A change of signature.
    Change(Box<Change<O>>),
    /// The branch ends before its range.
    Failed(BranchFailure<O>),
    /// Something that the system knows of.
    Own(O::Special),
}

impl<O: Orbit> Special<O> {
    /// Its type.
    pub fn kind(&self) -> EventType {
        match self {
            Special::Start | Special::Edge(..) | Special::Closed => EventType::EP,
            Special::Fold(_) => EventType::LP,
            Special::User(..) | Special::Monitor(..) => EventType::UZ,
            Special::Change(change) => change.kind,
            Special::Failed(_) => EventType::MX,
            Special::Own(special) => special.kind(),
        }
    }

    /// Signature beyond the point, where it changes.
    pub fn after(&self) -> Option<O::Signature> {
        match self {
            Special::Own(special) => special.beyond(),
            Special::Change(change) => match &change.end {
                Some(BranchTermination::Own(stop)) => stop.left().or_else(|| change.after.clone()),
                _ => change.after.clone(),
            },
            _ => None,
        }
    }
}

/// A change of signature.
#[derive(Clone, Debug, PartialEq)]
pub struct Change<O: Orbit> {
    /// Its type.
    pub kind: EventType,
    /// Signature before it.
    pub before: O::Signature,
    /// Signature beyond it, if there is an admissible one.
    pub after: Option<O::Signature>,
    /// The margin that vanishes.
    pub margin: O::Margin,
    /// What it measures.
    pub held: O::Inequality,
    /// Further signatures that are admissible beyond it.
    pub others: Vec<O::Signature>,
    /// Whether the branch turns back in the parameter.
    pub turned_back: bool,
    /// Why the branch ends there, if it does.
    pub end: Option<BranchTermination<O>>,
    /// What is to be said of the stability.
    pub spectrum: Option<O::Remark>,
}

impl<O: Orbit> Change<O> {
    /// A change of signature where this margin vanishes.
    pub fn new(orbit: &O, after: Option<O::Signature>, margin: O::Margin) -> Change<O> {
        let before = orbit.signature();
        Change {
            kind: O::classify(before, after.as_ref(), &margin),
            before: before.clone(),
            after,
            held: orbit.inequality(&margin),
            margin,
            others: Vec::new(),
            turned_back: false,
            end: None,
            spectrum: None,
        }
    }
}

/// Why an orbit refuses a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum OrbitRefusal<O: Orbit> {
    /// Its inequalities cannot be evaluated.
    Flow(O::Failure),
    /// Inequalities fail, and none of their margins tells where.
    Inadmissible(O::Inadmissible),
    /// A fold or a user point was not found.
    NotFound,
    /// Margins are negative at the end and none of them is located.
    NotLocated(usize),
    /// An event is known too badly.
    Uncertain {
        /// Parameter of the branch.
        parameter: O::Parameter,
        /// Its value.
        value: f64,
        /// Its error.
        error: f64,
    },
    /// Another inequality fails where an event is.
    Order,
    /// The orbit of an event does not solve the equations of a signature tried beyond it.
    NoSolution,
}

impl<O: Orbit> std::error::Error for OrbitRefusal<O> {}

/// Why a branch ends for reasons of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum BranchTermination<O: Orbit> {
    /// No signature solves the equations beyond the event.
    NoSignature,
    /// No signature is admissible beyond the event: those tried.
    NoneAdmissible(Vec<Tried<O>>),
    /// The first point beyond an event cannot be evaluated.
    Flow(O::Failure),
    /// Changes of one type follow one another without end, each with more zones than the one before.
    Converges {
        /// Their type.
        kind: EventType,
        /// How many were seen.
        changes: usize,
        /// Limit of the ratio of successive distances of their values.
        ratio: f64,
        /// Parameter of the branch.
        parameter: O::Parameter,
        /// The value to which theirs converge.
        limit: f64,
        /// Its error.
        error: f64,
    },
    /// Something that the system knows of.
    Own(O::Termination),
}

impl<O: Orbit> BranchTermination<O> {
    /// Whether the end leaves nothing undone: it is no failure.
    pub fn completes(&self) -> bool {
        match self {
            BranchTermination::Converges { .. } => true,
            BranchTermination::Own(stop) => stop.completes(),
            BranchTermination::NoSignature
            | BranchTermination::NoneAdmissible(_)
            | BranchTermination::Flow(_) => false,
        }
    }
}

/// A signature tried beyond an event and refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Tried<O: Orbit> {
    /// The signature; `None` where none could be made.
    pub signature: Option<O::Signature>,
    /// Why it was refused.
    pub reason: StepRefused<O>,
}

/// Why a branch cannot be followed from a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(bound = "")]
pub enum NoFollower<O: Orbit> {
    /// It has no direction there.
    #[error("the Newton matrix is singular at the start: the start is a fold")]
    Fold,
    /// It is not isolated.
    #[error(
        "the orbit is one of a family at this value of the parameter, without a branch of its own: multipliers 1, as \
         of a motion without loss at a resonance"
    )]
    Family,
    /// Its inequalities cannot be evaluated.
    #[error("{0}")]
    Refused(OrbitRefusal<O>),
    /// A saved state is not one of its signature.
    #[error("the saved state does not fit its signature")]
    Saved,
}

impl<O: Orbit> From<OrbitRefusal<O>> for NoFollower<O> {
    fn from(refusal: OrbitRefusal<O>) -> Self {
        NoFollower::Refused(refusal)
    }
}

/// Saved progress from which a run does not go on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(bound = "")]
pub enum ResumeMismatch<O: Orbit> {
    /// It is of another problem.
    #[error("the saved progress does not fit its problem")]
    Progress,
    /// The first orbit has other unknowns.
    #[error("the first wave does not fit its signature")]
    FirstWave,
    /// The branch does not go on from it.
    #[error("{0}")]
    State(NoFollower<O>),
}

impl<O: Orbit> From<NoFollower<O>> for ResumeMismatch<O> {
    fn from(reason: NoFollower<O>) -> Self {
        ResumeMismatch::State(reason)
    }
}

/// What is so close to zero that rounding decides its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Close<H> {
    /// A margin.
    Margin(H),
    /// The slope of the parameter along the branch, which vanishes at a fold.
    Fold,
    /// How far multipliers are from the unit circle, which comes to zero where one leaves it as another enters it.
    Circle,
}

/// Why a step along a branch was refused.
pub type StepRefused<O> =
    Refused<<O as crate::continuation::newton::Equations>::Failure, OrbitRefusal<O>>;

/// How the walk along a branch ended.
pub type Ending<O> = End<StepRefused<O>, BranchTermination<O>>;

/// Why a branch ended before its range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum BranchFailure<O: Orbit> {
    /// As the walk along it ended.
    Ended(Box<Ending<O>>),
    /// A leg does not begin.
    NoLeg(ResumeMismatch<O>),
}
