//! What makes a point of a branch special, why a step is refused, and why a branch ends: as data. Their
//! sentences are made in one place, `words`.

use serde::{Deserialize, Serialize};

use super::conditioning::Conditioning;
use super::follow::Branch;
use super::progress::Unfit;
use super::{EventType, Reason};
use crate::continuation::walk::{EndOf, RefusalOf};
use crate::flow::FlowError;
use crate::flow::sign::Verdict;
use crate::model::Parameter;
use crate::model::signature::{Entry, Regime, Signature};
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
    pub reason: RefusalOf<Branch>,
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

/// How the walk along a branch ended.
pub type Ending = EndOf<Branch>;

/// Why a branch ended before its range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Failure {
    /// As the walk along it ended.
    Ended(Box<Ending>),
    /// A leg does not begin.
    NoLeg(Unfit),
}

/// Type of a change of regime, from the margin that vanished and the signatures on both sides.
fn classify(before: &Signature, after: Option<&Signature>, margin: &Margin) -> EventType {
    let vanished = (margin.watch == Watch::Duration).then(|| before.zone(margin.zone).regime);
    let born =
        |regime: Regime| after.is_some_and(|after| after.count(regime) > before.count(regime));
    let reverse_at_stick = |signature: &Signature| {
        (0..signature.len()).any(|index| {
            signature.zone(index).regime == Regime::Slip
                && signature.zone(index + 1).regime == Regime::Reverse
                && signature.zone(index + 1).entry == Entry::Reversal
                && signature.zone(index + 2).regime == Regime::Stick
        })
    };
    match (vanished, margin.watch) {
        // a zone that begins with a touch closes on the impact, not at zero pressure
        (Some(Regime::Separation), _) if before.zone(margin.zone).entry == Entry::Touch => {
            EventType::CO
        }
        (Some(Regime::Separation), _) | (_, Watch::Pressure) => EventType::GR,
        (Some(Regime::Stick), _) => EventType::ST,
        (None, Watch::LowerForce) => EventType::RV,
        (Some(Regime::Reverse), _)
            if reverse_at_stick(before) && !born(Regime::Slip) && !born(Regime::Separation) =>
        {
            EventType::RV
        }
        (None, Watch::Rate) if born(Regime::Stick) && !before.has(Regime::Stick) => EventType::ST,
        _ => EventType::CO,
    }
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
