//! What makes a point of a branch special, why a step is refused, and why a branch ends: as data. Their
//! sentences are made in one place, `messages`.

use serde::{Deserialize, Serialize};

use super::conditioning::Conditioning;
use super::{EventType, Reason};
use crate::continuation::walk::{End, Refused};
use crate::flow::FlowError;
use crate::flow::sign::Verdict;
use crate::model::Parameter;
use crate::model::signature::{Entry, Regime, Signature, Zone};
use crate::stability::track::Remark;
use crate::wave::Wave;
use crate::wave::admissibility::{Examination, Margin, Watch};

/// What makes a point special.
#[derive(Clone, Debug, PartialEq)]
pub enum Special {
    /// The first point of a leg.
    Start,
    /// The Hopf point of steady sliding, where a vertical family begins.
    HopfPoint,
    /// The end of that family, where a stick zone opens.
    StickOpens,
    /// A fold in the parameter.
    Fold(Parameter),
    /// A value that was asked for.
    User(Parameter, f64),
    /// An edge of the range.
    Edge(Parameter, f64),
    /// An edge of the range at β = 0, where a wave that separates is one with Coulomb impacts.
    CoulombLimit,
    /// The first point of the branch once more.
    Closed,
    /// A change of regime.
    Change(Box<Change>),
    /// An eigenvalue crosses the imaginary axis.
    Crossing {
        /// Bloch sector.
        sector: usize,
        /// Im λ of a complex pair; `None` where the eigenvalue is real.
        omega: Option<f64>,
        /// Whether it becomes unstable along the branch.
        grows: bool,
    },
    /// The branch ends before its range.
    Failed(Failure),
}

impl Special {
    /// Its type.
    pub fn kind(&self) -> EventType {
        match self {
            Special::Start
            | Special::HopfPoint
            | Special::Edge(..)
            | Special::CoulombLimit
            | Special::Closed => EventType::EP,
            Special::StickOpens => EventType::ST,
            Special::Fold(_) => EventType::LP,
            Special::User(..) => EventType::UZ,
            Special::Change(change) => change.kind,
            Special::Crossing { omega: None, .. } => EventType::BP,
            Special::Crossing { .. } => EventType::HB,
            Special::Failed(_) => EventType::MX,
        }
    }

    /// Signature beyond the point, where it changes.
    pub fn after(&self) -> Option<Signature> {
        match self {
            Special::StickOpens => Some(Signature::slip_stick()),
            Special::Change(change) if change.end == Some(Stop::SlipAlone) => {
                Some(Signature::slip_alone())
            }
            Special::Change(change) => change.after.clone(),
            _ => None,
        }
    }
}

/// A change of regime.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Its type.
    pub kind: EventType,
    /// Signature before it.
    pub before: Signature,
    /// Signature beyond it, if there is an admissible one.
    pub after: Option<Signature>,
    /// The margin that vanishes.
    pub margin: Margin,
    /// Further signatures that are admissible beyond it.
    pub others: Vec<Signature>,
    /// Whether the branch turns back in the parameter.
    pub turned_back: bool,
    /// Why the branch ends there, if it does.
    pub end: Option<Stop>,
    /// What is to be said of the spectrum.
    pub spectrum: Option<Remark>,
}

impl Change {
    /// A change of regime where this margin vanishes.
    pub fn new(before: &Signature, after: Option<Signature>, margin: Margin) -> Change {
        Change {
            kind: classify(before, after.as_ref(), &margin),
            before: before.clone(),
            after,
            margin,
            others: Vec::new(),
            turned_back: false,
            end: None,
            spectrum: None,
        }
    }
}

/// Why a point is not admissible.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Inadmissible {
    /// A margin is negative.
    Margin {
        /// Regime of its zone.
        regime: Regime,
        /// What it measures.
        watch: Watch,
        /// Its value.
        value: f64,
    },
    /// An inequality is closer to zero than rounding can tell.
    Undecided,
    /// A switching condition is crossed the wrong way.
    WrongWay,
}

impl Inadmissible {
    /// The worst of what an examination found.
    pub fn of(wave: &Wave, examination: &Examination) -> Inadmissible {
        let negative = examination.margins.iter();
        let negative = negative.filter(|margin| margin.jet.value <= 0.0);
        match negative.min_by(|one, other| one.jet.value.total_cmp(&other.jet.value)) {
            Some(margin) => Inadmissible::Margin {
                regime: wave.signature.zone(margin.zone).regime,
                watch: margin.watch,
                value: margin.jet.value,
            },
            None if examination.verdict == Verdict::Undecided => Inadmissible::Undecided,
            None => Inadmissible::WrongWay,
        }
    }
}

/// Why a wave refuses a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Refusal {
    /// Its inequalities cannot be evaluated.
    Flow(#[from] FlowError),
    /// Inequalities fail, and none of their margins tells where.
    Inadmissible(Inadmissible),
    /// A fold or a user point was not found.
    NotFound,
    /// Margins are negative at the end and none of them is located.
    NotLocated(usize),
    /// An event is known too badly.
    Uncertain {
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// Its error.
        error: f64,
    },
    /// Another inequality fails where an event is.
    Order,
}

/// Why a branch ends for reasons of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Stop {
    /// D = 0 ends the wave.
    Undriven,
    /// D = 0: the wave would run against D.
    Against,
    /// The speed tends to √a.
    Sonic {
        /// |c|/√a − 1.
        excess: f64,
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// One zone of slip is left: steady sliding at its Hopf point.
    SlipAlone,
    /// No signature of the switching table solves the equations beyond the event.
    NoSignature,
    /// No signature is admissible beyond the event: those tried.
    NoneAdmissible(Vec<Tried>),
    /// The first point beyond an event cannot be evaluated.
    Flow(FlowError),
}

/// A signature tried beyond an event and refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// The signature; `None` where none could be made.
    pub signature: Option<Signature>,
    /// Why it was refused.
    pub reason: StepRefused,
}

/// Why a branch cannot be followed from a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum NoFollower {
    /// It has no direction there.
    #[error("the Newton matrix is singular at the start: the start is a fold")]
    Fold,
    /// Its inequalities cannot be evaluated.
    #[error("{0}")]
    Refused(#[from] Refusal),
    /// A saved state is not one of its signature.
    #[error("the saved state does not fit its signature")]
    Saved,
}

/// Saved progress from which a run does not go on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum ResumeMismatch {
    /// It is of another problem.
    #[error("the saved progress does not fit its problem")]
    Progress,
    /// The first wave has other unknowns.
    #[error("the first wave does not fit its signature")]
    FirstWave,
    /// The branch does not go on from it.
    #[error("{0}")]
    State(#[from] NoFollower),
}

/// What is so close to zero that rounding decides its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Close {
    /// A margin of a zone.
    Margin(Regime, Watch),
    /// The slope of the parameter along the branch, which vanishes at a fold.
    Fold,
}

impl Close {
    /// A margin of a wave.
    pub fn margin(wave: &Wave, margin: &Margin) -> Close {
        Close::Margin(wave.signature.zone(margin.zone).regime, margin.watch)
    }
}

/// Why a step along a branch was refused.
pub type StepRefused = Refused<FlowError, Refusal>;

/// How the walk along a branch ended.
pub type Ending = End<StepRefused, Stop>;

/// Why a branch ended before its range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Failure {
    /// As the walk along it ended.
    Ended(Box<Ending>),
    /// A leg does not begin.
    NoLeg(ResumeMismatch),
}

/// Type of a change of regime: the same from either side, one of which sees open what the other sees close.
fn classify(before: &Signature, after: Option<&Signature>, margin: &Margin) -> EventType {
    let closed = (margin.watch == Watch::Duration).then(|| before.zone(margin.zone));
    // a zone that begins with a touch closes on the impact, not at zero pressure
    let lifts = |zone: Zone| zone.regime == Regime::Separation && zone.entry != Entry::Touch;
    if margin.watch == Watch::Pressure || closed.is_some_and(lifts) {
        return EventType::GR;
    }
    let Some(after) = after else {
        return match (closed.map(|zone| zone.regime), margin.watch) {
            (Some(Regime::Stick), _) => EventType::ST,
            (None, Watch::LowerForce) => EventType::RV,
            _ => EventType::CO,
        };
    };
    if before.count(Regime::Stick) != after.count(Regime::Stick) {
        return EventType::ST;
    }
    // reverse slip that begins at V̇ = 1: what lands in reverse slip is arrested before it closes
    let reverses = |signature: &Signature| {
        let before_stick = |index: &usize| {
            let (zone, next) = (signature.zone(*index), signature.zone(index + 1));
            zone.regime == Regime::Reverse
                && matches!(zone.entry, Entry::Reversal | Entry::ArrestedLanding)
                && next.regime == Regime::Stick
        };
        (0..signature.len()).filter(before_stick).count()
    };
    let others = [Regime::Slip, Regime::Separation];
    if reverses(before) != reverses(after)
        && before.len() != after.len()
        && others.map(|regime| before.count(regime)) == others.map(|regime| after.count(regime))
    {
        return EventType::RV;
    }
    EventType::CO
}

/// What could not be settled in a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// A crossing before a point is left out: its wave cannot be examined.
    CrossingLeftOut {
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// Something remains to be said of the spectrum.
    Spectrum {
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// What.
        remark: Remark,
    },
    /// The eigenvalues that a run may compute are used up.
    Spent {
        /// Points so far.
        points: usize,
        /// How many there were.
        allowance: usize,
    },
    /// The first point whose eigenvalues are not all listed.
    Incomplete {
        /// Its number.
        point: usize,
        /// Why.
        reason: Reason,
    },
    /// What comes so close to zero at a point, or between it and the one before, that rounding decides.
    Close {
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// What.
        what: Close,
    },
    /// A point is known less well than the tolerance asks.
    NotConverged {
        /// Its number.
        point: usize,
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// The tolerance.
        tolerance: f64,
        /// How well it is known.
        known: Conditioning,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::newton;
    use crate::continuation::walk::{End, Refused};
    use crate::flow::Unsolved;

    /// Why a branch ended is the same after it was saved, whatever it is.
    #[test]
    fn reasons_are_saved_as_data() {
        let flow = FlowError::Integration {
            duration: 0.1 + 0.2,
            reason: Unsolved::NotConverged,
        };
        let inadmissible = Refusal::Inadmissible(Inadmissible::Margin {
            regime: Regime::Slip,
            watch: Watch::Pressure,
            value: -1.0e-300,
        });
        let tried = |reason| Tried {
            signature: Some(Signature::slip_stick()),
            reason,
        };
        let step = newton::Failure::Slow {
            correction: f64::INFINITY,
            iterations: 7,
        };
        let ends = [
            End::NoStep {
                ds_min: 1e-9,
                reason: Refused::Curve(inadmissible.clone()),
            },
            End::Own(Stop::NoneAdmissible(vec![
                tried(Refused::Step(step.into())),
                tried(Refused::Step(newton::Failure::System(flow).into())),
                tried(Refused::Pair),
                tried(Refused::Curve(inadmissible.clone())),
            ])),
            End::Own(Stop::Flow(flow)),
        ];
        let mut reasons: Vec<Failure> = ends.map(|end| Failure::Ended(Box::new(end))).into();
        reasons.push(Failure::NoLeg(NoFollower::Refused(inadmissible).into()));
        for reason in reasons {
            let text = ron::to_string(&reason).unwrap();
            let again: Failure = ron::from_str(&text).unwrap();
            assert_eq!(again, reason);
            assert_eq!(again.to_string(), reason.to_string());
        }
    }
}
