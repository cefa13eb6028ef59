//! The branch beyond a change of regime.

use super::entry::{
    Beyond, Entry, NotEntered, RESIDUAL_AT_EVENT, TRIES, enter, enter_along, solved,
};
use super::located::LocatedEvent;
use super::special::{BranchTermination, OrbitRefusal, Tried};
use super::{AtZero, Candidate, Examined, MarginFunction as _, Orbit, Situation, events};
use crate::continuation::locate::Place;
use crate::continuation::walk::{self, Refused, Segment};
use crate::continuation::{Node, Steps, arclength};
use crate::linalg::Vector;

/// The result of looking for the branch beyond an event.
#[derive(Clone, Debug)]
pub struct BeyondSearch<O: Orbit> {
    /// The continuation, if there is one.
    pub beyond: Option<Beyond<O>>,
    /// Signatures that were tried and refused.
    pub refused: Vec<Tried<O>>,
    /// Further signatures that are admissible too.
    pub others: Vec<O::Signature>,
}

/// Looks for the admissible continuation beyond the zero of a margin.
pub fn beyond<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    ds: f64,
    tolerance: f64,
) -> BeyondSearch<O> {
    let mut search = BeyondSearch::of(None);
    let list = match orbit.candidates(point, margin) {
        Ok(list) => list,
        Err(error) => {
            search.refused.push(Tried {
                signature: None,
                reason: Refused::Curve(OrbitRefusal::Flow(error)),
            });
            return search;
        }
    };
    for candidate in list {
        match enter(&candidate, ds, tolerance) {
            Ok(beyond) => match &search.beyond {
                Some(known) if known.ds >= beyond.ds => {
                    search.others.push(beyond.orbit.signature().clone());
                }
                _ => {
                    if let Some(known) = search.beyond.replace(beyond) {
                        search.others.push(known.orbit.signature().clone());
                    }
                }
            },
            Err(reason) => {
                let reason = match reason {
                    NotEntered::Refused(reason) => reason,
                    NotEntered::NoSolution => Refused::Curve(OrbitRefusal::NoSolution),
                };
                search.add_refused([Tried {
                    signature: Some(candidate.orbit.signature().clone()),
                    reason,
                }]);
            }
        }
    }
    search
}

impl<O: Orbit> BeyondSearch<O> {
    /// Nothing else found than this, and nothing refused.
    pub(super) fn of(beyond: Option<Beyond<O>>) -> BeyondSearch<O> {
        BeyondSearch {
            beyond,
            refused: Vec::new(),
            others: Vec::new(),
        }
    }

    /// Adds signatures that were refused, each once: how near it came to an admissible one counts.
    pub(super) fn add_refused(&mut self, refused: impl IntoIterator<Item = Tried<O>>) {
        for one in refused {
            let mut known = self.refused.iter_mut();
            match known.find(|known| known.signature == one.signature) {
                Some(known) if known.is_no_solution() => *known = one,
                Some(_) => {}
                None => self.refused.push(one),
            }
        }
    }
}

impl<O: Orbit> Tried<O> {
    /// Whether the orbit of the event does not solve its equations.
    pub fn is_no_solution(&self) -> bool {
        matches!(self.reason, Refused::Curve(OrbitRefusal::NoSolution))
    }
}

/// Margins by the instant of the period at which each is looked at, in their order.
pub fn instants<O: Orbit>(orbit: &O, point: &Vector, margins: &[O::Margin]) -> Vec<Vec<O::Margin>> {
    /// Parts of a period closer than this are one instant: zones that vanish have no length, but for rounding.
    const SAME: f64 = 1e-6;
    let mut found: Vec<(f64, Vec<O::Margin>)> = Vec::new();
    for margin in margins {
        let instant = orbit.instant(point, margin);
        let same = |(other, _): &&mut (f64, _)| {
            let apart = (instant - *other).rem_euclid(1.0);
            apart.min(1.0 - apart) <= SAME
        };
        match found.iter_mut().find(same) {
            Some((_, group)) => {
                if !group.iter().any(|known| known.is_same(margin)) {
                    group.push(margin.clone());
                }
            }
            None => found.push((instant, vec![margin.clone()])),
        }
    }
    found.into_iter().map(|(_, group)| group).collect()
}

/// All changes of regime of one place at once.
#[derive(Clone, Debug)]
pub struct Together<O: Orbit> {
    /// The margin of the first of them.
    pub margin: O::Margin,
    /// Signature after the first of them alone.
    pub between: O::Signature,
    /// What lies beyond all.
    pub search: BeyondSearch<O>,
}

/// Candidates kept of those that make some of several changes.
const MOST_TOGETHER: usize = 64;

/// Second changes tried of all pairs: beside an event of many zones there are hundreds, and none leads on.
const MOST_PAIRS: usize = 16;

/// Looks for the admissible continuation that makes a change at every instant at which margins vanish together, as
/// they do in both halves of a symmetric orbit. `instants` are the margins of each.
pub fn beyond_together<O: Orbit>(
    orbit: &O,
    point: &Vector,
    instants: &[Vec<O::Margin>],
    ds: f64,
    tolerance: f64,
) -> Option<Together<O>> {
    let (first, rest) = instants.split_first()?;
    let mut list = Vec::new();
    for margin in first {
        let candidates = orbit.candidates(point, margin).ok()?;
        list.extend(
            candidates
                .into_iter()
                .map(|one| (margin, one.orbit.signature().clone(), one)),
        );
    }
    for margins in rest {
        let mut longer: Vec<(&O::Margin, O::Signature, Candidate<O>)> = Vec::new();
        for (margin, between, candidate) in list {
            if longer.len() >= MOST_TOGETHER {
                break;
            }
            let solved = solved(&candidate.orbit, &candidate.point);
            let examination = solved.map(|node| candidate.orbit.examination(&node.point));
            let Some(Ok(examination)) = examination else {
                continue;
            };
            let zeros = examination.margins().iter().filter(|zero| {
                let alike = |other| orbit.is_alike(other, &candidate.orbit, zero);
                zero.value().abs() <= RESIDUAL_AT_EVENT && margins.iter().any(alike)
            });
            for zero in zeros {
                let next = candidate.orbit.candidates(&candidate.point, zero).ok()?;
                for one in next {
                    let known = |(_, _, known): &(_, _, Candidate<O>)| {
                        known.orbit == one.orbit && known.nascent == one.nascent
                    };
                    let back = orbit.is_rotation(one.orbit.signature());
                    if !back && longer.len() < MOST_TOGETHER && !longer.iter().any(known) {
                        longer.push((margin, between.clone(), one));
                    }
                }
            }
        }
        list = longer;
    }
    let entered = list.into_iter().filter_map(|(margin, between, candidate)| {
        let beyond = enter(&candidate, ds, tolerance).ok()?;
        Some((margin, between, beyond))
    });
    let mut entered: Vec<_> = entered.collect();
    // the longest first step, the first of several
    entered.sort_by(|(.., one), (.., other)| other.ds.total_cmp(&one.ds));
    let mut entered = entered.into_iter();
    let (margin, between, beyond) = entered.next()?;
    Some(Together {
        margin: margin.clone(),
        between,
        search: BeyondSearch {
            others: entered
                .map(|(.., other)| other.orbit.signature().clone())
                .collect(),
            ..BeyondSearch::of(Some(beyond))
        },
    })
}

/// Looks for the branch that motions beside an event find, where no sequence goes on that its switches allow: with the parameter
/// further on, or back, where that is not the branch that led to the event.
pub fn beyond_by_motion<O: Orbit>(
    orbit: &O,
    point: &Vector,
    heading: f64,
    ds: f64,
    tolerance: f64,
) -> Option<Beyond<O>> {
    [heading, -heading].into_iter().find_map(|side| {
        let beside = orbit.beside(point, side)?;
        if orbit.is_rotation(beside.orbit.signature()) {
            return None;
        }
        let mut node = Node::within(&beside.orbit, beside.point, RESIDUAL_AT_EVENT)?;
        if node.tangent[node.tangent.len() - 1] * side < 0.0 {
            node.tangent.neg_mut();
        }
        enter_along(&beside.orbit, (&node, &[1.0]), ds, TRIES, tolerance).ok()
    })
}

/// The event at which a branch begins that motions beside it have found: the first change on the way back, to this scaled parameter and
/// as far again.
pub(super) fn begins<O: Orbit>(
    beyond: &Beyond<O>,
    parameter: f64,
    steps: &Steps,
) -> Option<(Place, LocatedEvent<O>)> {
    let Beyond { orbit, node, .. } = beyond;
    let from = Node {
        tangent: -&node.tangent,
        ..node.clone()
    };
    let last = from.point.len() - 1;
    let ds = 2.0 * (parameter - from.point[last]) / from.tangent[last];
    let before = orbit.examination(&from.point).ok()?;
    let to = arclength::advance(orbit, &from, &[], ds, steps.tolerance).ok()?;
    let after = orbit.examination(&to.node.point).ok()?;
    let step = Segment {
        from: &from,
        before: &before,
        to: &to.node,
        after: &after,
        ds,
        steps,
    };
    let changes = events::changes(orbit, &step).ok()?.into_iter();
    changes.min_by(|(one, _), (other, _)| one.s.total_cmp(&other.s))
}

/// Two changes of regime at one place: within rounding neither of them comes first.
#[derive(Clone, Debug)]
pub struct Both<O: Orbit> {
    /// The margin that vanishes first.
    pub first: O::Margin,
    /// Boundary-value problem between the two.
    pub between: O,
    /// The event in its unknowns.
    pub node: Node,
    /// The other margin, as of the orbit in between.
    pub second: O::Margin,
    /// How far along the branch the second is from the first, by its slope.
    pub distance: f64,
    /// What lies beyond both.
    pub search: BeyondSearch<O>,
}

/// Looks for the admissible continuation beyond the zeros of two margins where neither alone has one: the
/// orbit between them lasts no longer than rounding.
pub fn beyond_both<O: Orbit>(
    orbit: &O,
    at: &Node,
    margins: &[O::Margin],
    ds: f64,
    tolerance: f64,
) -> Option<Both<O>> {
    let point = &at.point;
    // margins of different zones may be alike, and different margins lead to the same orbit between
    let mut tried: Vec<(O, O::Margin)> = Vec::new();
    for first in margins {
        for candidate in orbit.candidates(point, first).ok()? {
            let between = candidate.orbit;
            let Some(node) = solved(&between, &candidate.point) else {
                continue;
            };
            let Ok(examination) = between.examination(&node.point) else {
                continue;
            };
            for other in margins.iter().filter(|other| !other.is_same(first)) {
                let mut zeros = examination.margins().iter().filter(|margin| {
                    orbit.is_alike(other, &between, margin)
                        && margin.value().abs() <= RESIDUAL_AT_EVENT
                });
                let entered = zeros.find_map(|second| {
                    let same = |(orbit, margin): &(O, O::Margin)| {
                        margin.is_same(second) && *orbit == between
                    };
                    if tried.len() >= MOST_PAIRS || tried.iter().any(same) {
                        return None;
                    }
                    tried.push((between.clone(), second.clone()));
                    let search = beyond(&between, &node.point, second, ds, tolerance);
                    // not back again by the same event
                    let after = search.beyond.as_ref()?.orbit.signature();
                    (!orbit.is_rotation(after)).then_some((second.clone(), search))
                });
                if let Some((second, search)) = entered {
                    let mut seen = AtZero {
                        margin: other.clone(),
                    };
                    let seen = seen.margin_at(orbit, point).ok()?;
                    return Some(Both {
                        distance: (seen.value() / orbit.slope(seen, &at.tangent)).abs(),
                        first: first.clone(),
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

/// The branch beyond the zero of a margin as [`beyond`] has it, where nobody asks why candidates are refused: all are
/// tried with one first step before any is with a shorter one, since the longest step decides.
pub fn nearest_beyond<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    ds: f64,
    tolerance: f64,
) -> Option<Beyond<O>> {
    let candidates = orbit.candidates(point, margin).ok()?;
    if candidates.iter().any(|one| one.orbit.is_layered()) {
        return beyond(orbit, point, margin, ds, tolerance).beyond;
    }
    let entries: Vec<Entry<O>> = candidates.iter().flat_map(Entry::all).collect();
    let lengths = std::iter::successors(Some(ds), |ds| Some(ds * walk::SHORTER)).take(TRIES);
    let tries = lengths.flat_map(|length| entries.iter().map(move |entry| (length, entry)));
    let mut admitted = tries.filter_map(|(length, entry)| {
        let beyond = entry.along(length, 1, tolerance).ok()?;
        entry.shortest(ds, tolerance).is_ok().then_some(beyond)
    });
    admitted.next()
}

/// Why a branch ends at an event where a margin vanishes and none of these continues it.
pub(super) fn ending<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    refused: Vec<Tried<O>>,
) -> BranchTermination<O> {
    match orbit.termination(Situation::NoCandidate(point, margin)) {
        Some(stop) => BranchTermination::Own(stop),
        None if refused.is_empty() => BranchTermination::NoSignature,
        None => BranchTermination::NoneAdmissible(refused),
    }
}
