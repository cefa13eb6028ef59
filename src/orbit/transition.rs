//! The branch across a change of signature.
//!
//! Where margins vanish, the branch beyond is looked for behind each of them: behind all at once where they do so at several
//! instants of the period, and through a signature in between where two changes meet at one place. It may be known there and
//! yet end: where it would retrace itself, or where changes accumulate.

use std::sync::Arc;

use super::cascade::Cascade;
use super::change::{self, BeyondSearch, Both};
use super::entry::Beyond;
use super::follow::{LocatedPoint, Track};
use super::located::{BranchEvent, LocatedEvent};
use super::special::{BranchTermination, Change, Special, Tried};
use super::together::together;
use super::track::failed;
use super::{EventType, Examined, MarginFunction, Orbit, WITHOUT_LENGTH, events, find, retrace};
use crate::continuation::locate::Place;
use crate::continuation::walk::{self, CurveBeginning, Outcome, Segment};
use crate::continuation::{Node, Steps};

/// The first step tried into a new wave is at least this part of the first step of all, however close two
/// events lie: what opens like the square of a duration is lost in rounding where that is 1e-8.
const INTO: f64 = 1e-2;

/// What vanishes like a square root is zero to this beside its zero: the root of rounding, at most, in units of a margin.
const NEARLY: f64 = 1e-6;

/// A change of signature, and the search for the branch beyond it.
struct Transition<O: Orbit> {
    /// Its point: where two changes meet at one place that of the second.
    found: LocatedPoint<O>,
    /// The point of the first of the two.
    passed: Vec<LocatedPoint<O>>,
    /// The margin that vanishes.
    margin: O::Margin,
    /// Its type and what vanishes, where these are not told by the margin and what lies beyond.
    told: Option<(EventType, O::Inequality)>,
    search: BeyondSearch<O>,
}

impl<O: Orbit> Transition<O> {
    /// What the branch tells of it.
    fn change(&self) -> Change<O> {
        let beyond = self.search.beyond.as_ref();
        let after = beyond.map(|beyond| beyond.orbit.signature().clone());
        let mut change = Change {
            others: self.search.others.clone(),
            ..Change::new(self.found.orbit.as_ref(), after, self.margin.clone())
        };
        if let Some((kind, held)) = &self.told {
            (change.kind, change.held) = (*kind, held.clone());
        }
        change
    }
}

impl<O: Orbit> Track<O> {
    /// All margins that vanish at a change: those located there, and those whose zeros rounding keeps apart at the stiff
    /// end, or one of them from being located. The one that says most comes first.
    pub(super) fn vanishing(
        &self,
        step: &Segment<O::Examination>,
        place: &Place,
        together: &[LocatedEvent<O>],
        examination: &O::Examination,
    ) -> Vec<O::Margin> {
        let orbit = self.orbit.as_ref();
        let seen = || {
            together.iter().filter_map(|located| match &located.event {
                BranchEvent::Change(margin) => Some(margin),
                _ => None,
            })
        };
        let is_seen = |margin: &O::Margin| seen().any(|one| one.is_same(margin));
        // in the order of the period, for which zero rounding sees first is no order
        let vanished = examination.margins().iter().filter(|margin| {
            is_seen(margin)
                || margin.value().abs() <= events::rounding(orbit, place, margin)
                    && fails_beyond::<O>(step, margin)
        });
        let mut margins: Vec<O::Margin> = vanished.cloned().collect();
        let is_listed = |margin: &&O::Margin| find::<O>(examination, margin).is_some();
        margins.extend(seen().filter(|margin| !is_listed(margin)).cloned());
        margins.sort_by_key(MarginFunction::precedence);
        margins
    }

    /// Where margins vanish at several instants of the period at once, and the error of the parameter there. Zones
    /// that vanish together do so like square roots: each alone is located badly.
    pub(super) fn at_once(
        &self,
        step: &Segment<O::Examination>,
        place: &Place,
        examination: &O::Examination,
    ) -> Option<(Place, f64)> {
        let orbit = self.orbit.as_ref();
        let near = (examination.margins().iter())
            .filter(|margin| margin.value().abs() <= NEARLY && fails_beyond::<O>(step, margin));
        let mut near: Vec<O::Margin> = near.cloned().collect();
        near.sort_by_key(MarginFunction::precedence);
        let instants = change::instants(orbit, &place.node.point, &near);
        // of what vanishes at one instant that which says most and, where a zone closes, all that close with it
        let closes = |margin: &&O::Margin| margin.precedence() == WITHOUT_LENGTH;
        let first: Vec<O::Margin> = (instants.iter())
            .flat_map(|margins| {
                let closing = margins.iter().take_while(closes).count();
                margins.iter().take(closing.max(1))
            })
            .cloned()
            .collect();
        (first.len() > 1)
            .then(|| together(orbit, place, &first))
            .flatten()
    }

    /// A change of regime: the event, and the branch beyond it.
    pub(super) fn change(
        &self,
        found: LocatedPoint<O>,
        margins: &[O::Margin],
        step: &Segment<O::Examination>,
    ) -> Outcome<Track<O>> {
        let tolerance = step.steps.tolerance;
        let ds = step.ds.clamp(INTO * step.steps.ds, step.steps.ds);
        self.across(self.searched(found, margins, ds, tolerance))
    }

    /// The change at a node from which no step leads on, as the branch beyond has it: where zones of both halves of an orbit
    /// close at once the equations are singular there on this side, and regular on the other.
    pub(super) fn change_from_beyond(
        &self,
        node: &Node,
        examination: &O::Examination,
    ) -> Option<Outcome<Track<O>>> {
        /// The change is that of the node where their parameters agree to this, relative to its unit.
        const SAME: f64 = 1e-9;
        let orbit = self.orbit.as_ref();
        let near = examination.margins().iter();
        let near = near.filter(|margin| margin.value().abs() <= NEARLY);
        let margin = near.min_by_key(|margin| margin.precedence())?;
        let steps = &self.limits.steps;
        let (point, heading) = (&node.point, self.heading);
        let beyond = change::beyond_by_motion(orbit, point, heading, steps.ds, steps.tolerance)?;
        let (place, event) = change::begins(&beyond, point[point.len() - 1], steps)?;
        let BranchEvent::Change(seen) = event.event else {
            return None;
        };
        let here = LocatedPoint::new(&self.orbit, 0.0, node, examination);
        let parameter = orbit.value_at(&place.node.point);
        let off = (parameter - here.parameter).abs();
        let (from, into) = (beyond.orbit.signature(), orbit.signature());
        let kind = O::classify(from, Some(into), &seen);
        let told = Some((kind, beyond.orbit.inequality(&seen)));
        (off <= SAME * orbit.unit()).then(|| {
            self.across(Transition {
                found: LocatedPoint {
                    parameter,
                    uncertainty: event.uncertainty.max(off),
                    ..here
                },
                passed: Vec::new(),
                margin: margin.clone(),
                told,
                search: BeyondSearch::of(Some(beyond)),
            })
        })
    }

    /// What comes of a change with what lies beyond it.
    fn across(&self, transition: Transition<O>) -> Outcome<Track<O>> {
        let Steps {
            ds_min, tolerance, ..
        } = self.limits.steps;
        let mut change = transition.change();
        let Transition {
            mut found,
            mut passed,
            search: BeyondSearch {
                beyond, refused, ..
            },
            ..
        } = transition;
        let Some(Beyond {
            orbit,
            node,
            ds: step_in,
        }) = beyond
        else {
            return self.without_successor(found, change, refused);
        };
        let watched = match orbit.examination(&node.point) {
            Ok(watched) => watched,
            Err(error) => return ended_at(passed, found, change, BranchTermination::Flow(error)),
        };
        let mut cascade = self.cascade.clone();
        let more = orbit.unknowns().saturating_sub(self.orbit.unknowns());
        cascade.take(change.kind, more, found.parameter);
        let is_single = passed.is_empty();
        let accumulation = || Some((self.accumulation(&cascade, &change)?, true));
        let stop = self
            .retraces_beyond(&found.node, is_single, (&orbit, &node), step_in, tolerance)
            .or_else(accumulation);
        if let Some((stop, enters)) = stop {
            change.end = Some(stop.clone());
            if enters {
                found.entered = Some((Arc::new(orbit), node));
            }
            return ended_at(passed, found, change, stop);
        }
        let drift = node.tangent[node.tangent.len() - 1];
        change.turned_back = drift * self.heading < 0.0 && !events::is_vertical(&orbit, &node);
        let orbit = Arc::new(orbit);
        let curve = Track {
            orbit: orbit.clone(),
            heading: match change.turned_back {
                true => -self.heading,
                false => self.heading,
            },
            cascade,
            told: None,
            ..self.clone()
        };
        found.entered = Some((orbit, node.clone()));
        found.special = Some(Special::Change(Box::new(change)));
        passed.push(found);
        let entry = CurveBeginning {
            curve,
            node,
            watched,
            ds: step_in.max(ds_min),
        };
        Outcome::Entered(passed, entry)
    }

    /// Looks for the branch beyond: behind all margins at once, behind each, and behind two of them in turn.
    fn searched(
        &self,
        mut found: LocatedPoint<O>,
        margins: &[O::Margin],
        ds: f64,
        tolerance: f64,
    ) -> Transition<O> {
        let orbit = self.orbit.as_ref();
        let point = &found.node.point;
        let behind = |margin: &O::Margin| change::beyond(orbit, point, margin, ds, tolerance);
        let instants = change::instants(orbit, point, margins);
        let together = (instants.len() > 1)
            .then(|| change::beyond_together(orbit, point, &instants, ds, tolerance));
        let (mut margin, mut search, told) = match together.flatten() {
            Some(all) => {
                // the first of them names the event
                let kind = O::classify(orbit.signature(), Some(&all.between), &all.margin);
                let held = orbit.inequality(&all.margin);
                (all.margin, all.search, Some((kind, held)))
            }
            None => (margins[0].clone(), behind(&margins[0]), None),
        };
        for other in &margins[1..] {
            if search.beyond.is_some() {
                break;
            }
            let another = behind(other);
            if another.beyond.is_some() {
                (margin, search) = (other.clone(), another);
            } else {
                search.add_refused(another.refused);
            }
        }
        let mut passed = Vec::new();
        if search.beyond.is_none()
            && let Some(both) = change::beyond_both(orbit, &found.node, margins, ds, tolerance)
        {
            let second = self.second(&mut found, &both);
            margin = both.second;
            passed.push(std::mem::replace(&mut found, second));
            search = both.search;
        }
        if search.beyond.is_none() {
            let point = &found.node.point;
            search.beyond = change::beyond_by_motion(orbit, point, self.heading, ds, tolerance);
        }
        Transition {
            found,
            passed,
            margin,
            told,
            search,
        }
    }

    /// The second of two changes at the place of the first, which leads to the orbit in between.
    fn second(&self, first: &mut LocatedPoint<O>, both: &Both<O>) -> LocatedPoint<O> {
        let between = Arc::new(both.between.clone());
        let after = Some(between.signature().clone());
        let change = Change::new(self.orbit.as_ref(), after, both.first.clone());
        first.special = Some(Special::Change(Box::new(change)));
        first.entered = Some((between.clone(), both.node.clone()));
        let examination = between.examination(&both.node.point);
        let examination = examination.unwrap_or_else(|_| first.examination.clone());
        let drift = first.node.tangent[first.node.tangent.len() - 1].abs();
        LocatedPoint {
            uncertainty: first.uncertainty + both.distance * drift * between.unit(),
            ..LocatedPoint::new(&between, first.s, &both.node, &examination)
        }
    }

    /// The end of the branch at a change that no signature follows: a point of failure comes behind it, unless the end
    /// leaves nothing undone.
    fn without_successor(
        &self,
        mut found: LocatedPoint<O>,
        mut change: Change<O>,
        refused: Vec<Tried<O>>,
    ) -> Outcome<Track<O>> {
        let point = &found.node.point;
        let stop = change::ending(self.orbit.as_ref(), point, &change.margin, refused);
        change.end = Some(stop.clone());
        let completes = stop.completes();
        let end = walk::End::Own(stop);
        found.special = Some(Special::Change(Box::new(change)));
        if completes {
            return Outcome::Ended(vec![found], end);
        }
        let failure = LocatedPoint {
            special: Some(failed(&end)),
            ..found.clone()
        };
        Outcome::Ended(vec![found, failure], end)
    }

    /// Why the branch ends at a change where the orbit beyond is one of a part of its period, and the one before is not, or the
    /// image of one before; and whether it is entered all the same.
    fn retraces_beyond(
        &self,
        before: &Node,
        is_single: bool,
        (orbit, node): (&O, &Node),
        ds: f64,
        tolerance: f64,
    ) -> Option<(BranchTermination<O>, bool)> {
        let repeats = orbit.repeats(node);
        if let Some((_, stop)) = repeats.filter(|_| self.orbit.repeats(before).is_none()) {
            return Some((BranchTermination::Own(stop), true));
        }
        let here = is_single.then_some(self.orbit.as_ref())?;
        let (_, stop) = retrace::at_change(here, before, (orbit, node), ds, tolerance)?;
        Some((BranchTermination::Own(stop), false))
    }

    /// Why the branch ends where changes of one type follow one another ever closer: their limit lies within the range.
    fn accumulation(&self, cascade: &Cascade, change: &Change<O>) -> Option<BranchTermination<O>> {
        let (low, high) = self.limits.range;
        let limit = cascade.limit()?;
        (low < limit.value && limit.value < high).then(|| BranchTermination::Converges {
            kind: change.kind,
            changes: limit.changes,
            ratio: limit.ratio,
            parameter: self.orbit.parameter(),
            limit: limit.value,
            error: limit.error,
        })
    }
}

/// Whether a margin is positive no more at the end of a step.
fn fails_beyond<O: Orbit>(step: &Segment<O::Examination>, margin: &O::Margin) -> bool {
    find::<O>(step.after, margin).is_some_and(|beyond| beyond.value() <= 0.0)
}

/// The end of a branch at a change beyond which it is known but does not go on.
fn ended_at<O: Orbit>(
    mut passed: Vec<LocatedPoint<O>>,
    found: LocatedPoint<O>,
    change: Change<O>,
    stop: BranchTermination<O>,
) -> Outcome<Track<O>> {
    passed.push(LocatedPoint {
        special: Some(Special::Change(Box::new(change))),
        ..found
    });
    Outcome::Ended(passed, walk::End::Own(stop))
}
