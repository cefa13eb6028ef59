//! The branch beyond a change of regime.

use super::events;
use super::special::{Inadmissible, Refusal, StepRefused, Stop, Tried};
use crate::continuation::Node;
use crate::continuation::walk::{self, Refused};
use crate::continuation::{arclength, newton};
use crate::flow::sign::Verdict;
use crate::linalg::Vector;
use crate::model::signature::Signature;
use crate::wave::Wave;
use crate::wave::admissibility::{AtZero, Margin, Watch, examine};
use crate::wave::successor::{Candidate, candidates};

/// The branch beyond a change of regime.
#[derive(Clone, Debug)]
pub struct Beyond {
    /// Boundary-value problem of the new signature.
    pub wave: Wave,
    /// The event in its unknowns, with the tangent into the admissible side.
    pub node: Node,
    pub ds: f64,
}

/// The result of looking for the branch beyond an event.
#[derive(Clone, Debug, Default)]
pub struct Search {
    /// The continuation, if there is one.
    pub beyond: Option<Beyond>,
    /// Signatures that were tried and refused.
    pub refused: Vec<Tried>,
    /// Further signatures that are admissible too.
    pub others: Vec<Signature>,
}

/// A candidate solves its equations at the event to this scaled residual, or it is none: the
/// event itself is known to about 1e-13, and the reduced switching functions of nascent zones
/// amplify that by less than 1e4.
const RESIDUAL_AT_EVENT: f64 = 1e-8;

/// Lengths of the first step tried into a candidate.
const TRIES: usize = 14;

/// Looks for the admissible continuation beyond the zero of a margin.
pub fn beyond(wave: &Wave, point: &Vector, margin: &Margin, ds: f64, tolerance: f64) -> Search {
    let mut search = Search::default();
    let list = match candidates(wave, point, margin) {
        Ok(list) => list,
        Err(error) => {
            search.refused.push(Tried {
                signature: None,
                reason: Refused::Curve(error.into()),
            });
            return search;
        }
    };
    for candidate in list {
        match enter(&candidate, ds, tolerance) {
            Ok(beyond) => match &search.beyond {
                Some(known) if known.ds >= beyond.ds => {
                    search.others.push(beyond.wave.signature);
                }
                _ => {
                    if let Some(known) = search.beyond.replace(beyond) {
                        search.others.push(known.wave.signature);
                    }
                }
            },
            Err(NotEntered::Refused(reason)) => search.refused.push(Tried {
                signature: Some(candidate.wave.signature),
                reason,
            }),
            Err(NotEntered::NoSolution) => {}
        }
    }
    search
}

/// Two changes of regime at one place: within rounding neither of them comes first.
#[derive(Clone, Debug)]
pub struct Both {
    /// The margin that vanishes first.
    pub first: Margin,
    /// Boundary-value problem between the two.
    pub between: Wave,
    /// The event in its unknowns.
    pub node: Node,
    /// The other margin, as of the wave in between.
    pub second: Margin,
    /// How far along the branch the second is from the first, by its slope.
    pub distance: f64,
    pub search: Search,
}

/// Looks for the admissible continuation beyond the zeros of two margins where neither alone has one: the
/// wave between them lasts no longer than rounding.
pub fn beyond_both(
    wave: &Wave,
    at: &Node,
    margins: &[Margin],
    ds: f64,
    tolerance: f64,
) -> Option<Both> {
    let point = &at.point;
    let regime = |wave: &Wave, margin: &Margin| wave.signature.zone(margin.zone).regime;
    for first in margins {
        for candidate in candidates(wave, point, first).ok()? {
            let between = candidate.wave;
            let Some(node) = Node::on(&between, candidate.point).filter(solves) else {
                continue;
            };
            let Ok(examination) = examine(&between, &node.point) else {
                continue;
            };
            for other in margins
                .iter()
                .filter(|other| (other.watch, other.zone) != (first.watch, first.zone))
            {
                let mut zeros = examination.margins.iter().filter(|margin| {
                    margin.watch == other.watch
                        && regime(&between, margin) == regime(wave, other)
                        && margin.jet.value.abs() <= RESIDUAL_AT_EVENT
                });
                let entered = zeros.find_map(|second| {
                    let search = beyond(&between, &node.point, second, ds, tolerance);
                    // not back again by the same event
                    let after = &search.beyond.as_ref()?.wave.signature;
                    (!after.is_rotation_of(&wave.signature)).then_some((*second, search))
                });
                if let Some((second, search)) = entered {
                    let seen = AtZero { margin: *other }.margin_at(wave, point).ok()?;
                    return Some(Both {
                        distance: (seen.jet.value / seen.slope(wave, &at.tangent)).abs(),
                        first: *first,
                        between,
                        node,
                        second,
                        search,
                    });
                }
            }
        }
    }
    None
}

/// Whether an event is a wave of the equations that it is a node of.
fn solves(node: &Node) -> bool {
    node.residual <= RESIDUAL_AT_EVENT
}

/// Why a candidate is not entered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotEntered {
    /// The event does not solve its equations.
    #[error("the equations do not hold at the event")]
    NoSolution,
    /// No step into it is admissible: the last refusal.
    #[error("{0}")]
    Refused(StepRefused),
}

/// The first admissible step into a candidate.
///
/// # Errors
/// The event is no wave of the candidate, or no step is admissible.
pub fn enter(candidate: &Candidate, ds: f64, tolerance: f64) -> Result<Beyond, NotEntered> {
    let wave = &candidate.wave;
    let node = Node::on(wave, candidate.point.clone());
    let mut node = node.filter(solves).ok_or(NotEntered::NoSolution)?;
    if growth(candidate, &node.tangent) < 0.0 {
        node.tangent.neg_mut();
    }
    let direct = enter_along(wave, &node, ds, tolerance);
    let length = direct.as_ref().map_or(0.0, |beyond| beyond.ds);
    if !wave.material || length >= IN_LAYER * ds {
        return direct;
    }
    // a layer thinner than any step turns the tangent within the first one, or hides it in rounding
    let settled = INSIDE
        .iter()
        .filter_map(|part| settled(candidate, &node, part * ds, tolerance));
    settled
        .filter_map(|node| enter_along(wave, &node, ds, tolerance).ok())
        .find(|beyond| beyond.ds > length)
        .map_or(direct, Ok)
}

/// A first step shorter than this part of the one asked for may end within a layer, where rounding
/// alone says what is admissible.
const IN_LAYER: f64 = 1e-6;

/// Parts of a step, as durations of a nascent zone, where the tangent beyond a layer is looked for.
const INSIDE: [f64; 3] = [1e-2, 1e-1, 1e-3];

/// An event with the tangent that the branch has where its nascent zone lasts this long.
fn settled(candidate: &Candidate, node: &Node, duration: f64, tolerance: f64) -> Option<Node> {
    let wave = &candidate.wave;
    let index = wave.width() * candidate.nascent.first()? + 2;
    let mut guess = node.point.clone();
    guess[index] = duration;
    let mut fixed = newton::Fixed {
        index,
        value: duration,
    };
    let settings = newton::Settings {
        tolerance,
        ..newton::Settings::default()
    };
    let corrected = arclength::correct(wave, &mut fixed, &guess, &node.tangent, &settings);
    let (mut inside, _) = corrected.ok()?;
    if inside.tangent[index] < 0.0 {
        inside.tangent.neg_mut();
    }
    Some(Node {
        tangent: inside.tangent,
        ..node.clone()
    })
}

/// The first admissible step from an event along its tangent.
fn enter_along(wave: &Wave, node: &Node, ds: f64, tolerance: f64) -> Result<Beyond, NotEntered> {
    let mut refused = Err(NotEntered::NoSolution);
    let entered = walk::enter(wave, node, ds, TRIES, tolerance, |from, step| {
        let forwards = from.tangent == node.tangent;
        let refusal = match step.map(|to| examine(wave, &to.point)) {
            Ok(Ok(examination)) if examination.verdict == Verdict::Positive => return Some(()),
            // what fails on the way back says nothing
            Ok(Ok(_)) if !forwards => return None,
            Ok(Ok(examination)) => {
                let reason = Inadmissible::of(wave, &examination);
                Refused::Curve(Refusal::Inadmissible(reason))
            }
            Ok(Err(error)) => Refused::Curve(error.into()),
            Err(refusal) => Refused::Step(refusal),
        };
        refused = Err(NotEntered::Refused(refusal));
        None
    });
    match entered {
        Some((node, ds, ())) => Ok(Beyond {
            wave: wave.clone(),
            node,
            ds,
        }),
        None => refused,
    }
}

/// How much nascent zones grow along a direction, or else margins that are zero.
fn growth(candidate: &Candidate, tangent: &Vector) -> f64 {
    let wave = &candidate.wave;
    let nascent = &candidate.nascent;
    if !nascent.is_empty() {
        return nascent
            .iter()
            .map(|zone| tangent[wave.width() * zone + 2])
            .sum();
    }
    examine(wave, &candidate.point).map_or(0.0, |examination| {
        examination
            .margins
            .iter()
            .filter(|margin| margin.jet.value.abs() < 1e-6)
            .map(|margin| margin.slope(wave, tangent))
            .sum()
    })
}

/// Why a branch ends at an event where a margin vanishes and none of these continues it.
pub(super) fn ending(wave: &Wave, point: &Vector, margin: &Margin, refused: Vec<Tried>) -> Stop {
    if events::is_undriven(wave, point) {
        return Stop::Undriven;
    }
    if margin.watch == Watch::Duration && wave.zones() == 2 {
        return Stop::SlipAlone;
    }
    if refused.is_empty() {
        return Stop::NoSignature;
    }
    Stop::NoneAdmissible(refused)
}
