//! Changes of stability within a step: zeros of functions of the multipliers, and what the number of those outside the
//! unit circle says besides.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::bifurcation::Crossed;
use super::located::{AT_ZERO, BranchEvent, LocatedEvent, Step, TURN};
use super::{Examined, Growth, MarginFunction, Orbit, SpecialType, uncertainty};
use crate::continuation::Node;
use crate::continuation::locate::{self, Place};
use crate::continuation::newton::Plane;

/// Whether a test that changes its sign at a node is what makes it special.
pub(super) fn is_crossing<O: Orbit>(
    orbit: &O,
    test: usize,
    node: &Node,
    special: &O::Special,
) -> bool {
    let crossing = orbit.crossing(test, node);
    crossing.is_some_and(|crossing| crossing.kind() == special.kind())
}

/// How many multipliers are outside the unit circle; `None` where that is not told.
pub(super) fn outside(examination: &impl Examined) -> Option<usize> {
    let growths = examination.growths()?;
    let told = growths.iter().all(|one| one.told);
    told.then(|| growths.iter().filter(|one| one.log > 0.0).count())
}

/// A point where the number of multipliers outside the unit circle is told. Between two such points there may be others
/// where rounding decides, and among them one where it changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutsideCount {
    /// The number.
    outside: usize,
    /// The parameter there.
    value: f64,
}

impl OutsideCount {
    pub(super) fn at(value: f64, examination: &impl Examined) -> Option<OutsideCount> {
        let outside = outside(examination)?;
        Some(OutsideCount { outside, value })
    }

    /// A change since then that is told at the end of a step, and not at its beginning.
    pub(super) fn unseen<O: Orbit>(
        self,
        orbit: &O,
        step: &Step<O>,
    ) -> Option<(Place, LocatedEvent<O>)> {
        let there = OutsideCount::at(orbit.value_at(&step.to.point), step.after)?;
        let hidden = outside(step.before).is_none() && there.outside != self.outside;
        hidden.then(|| {
            let ends = [(self.outside, self.value), (there.outside, there.value)];
            unlocated(ends, step.ds, step.to)
        })
    }
}

/// Part of the way from an event, or to one, on which no change of stability is looked for: there multipliers are
/// lost in rounding, and beyond it the orbit is none.
const AT_EVENT: f64 = 1e-3;

/// What is seen of the stability at a place within a step.
struct SeenStability {
    s: f64,
    tests: Vec<f64>,
    growths: Option<Vec<Growth>>,
}

impl SeenStability {
    fn new<O: Orbit>(
        orbit: &O,
        s: f64,
        node: &Node,
        examination: &O::Examination,
    ) -> SeenStability {
        let tests = examination.tests().iter().enumerate();
        let across = tests.map(|(index, value)| orbit.across_folds(index, *value, node));
        SeenStability {
            s,
            tests: across.collect(),
            growths: examination.growths(),
        }
    }

    /// At an arclength; `None` where there is no orbit.
    fn at<O: Orbit>(orbit: &O, step: &Step<O>, s: f64) -> Option<SeenStability> {
        let node = locate::node_at(orbit, step.from, s, step.steps.tolerance)?;
        let examination = orbit.examination(&node.point).ok()?;
        Some(SeenStability::new(orbit, s, &node, &examination))
    }

    /// How many multipliers are outside the unit circle, by their values.
    fn outside(&self) -> usize {
        let growths = self.growths.iter().flatten();
        growths.filter(|growth| growth.log > 0.0).count()
    }

    /// The same; `None` where one of them is not farther from the circle than it is known to.
    fn known_outside(&self) -> Option<usize> {
        let mut growths = self.growths.as_ref()?.iter();
        let known = growths.all(|growth| growth.log.abs() > growth.error);
        known.then(|| self.outside())
    }

    /// How many more are outside at another place; `None` where rounding decides.
    fn change(&self, other: &SeenStability) -> Option<i64> {
        let numbers = |one: &SeenStability| {
            let growths = one.growths.as_ref()?;
            let sure = growths.iter().filter(|one| one.told && one.log > 0.0);
            let least = sure.count();
            let open = growths.iter().filter(|one| !one.told).count();
            Some((least as i64, (least + open) as i64))
        };
        let ((least, most), (low, high)) = (numbers(self)?, numbers(other)?);
        let told = most < low || high < least || (least == most && low == high);
        told.then(|| other.outside() as i64 - self.outside() as i64)
    }

    /// The mean growth of some of the multipliers, from the largest on; what is far from zero is cut off.
    fn mean(&self, ranks: &Range<usize>) -> Option<f64> {
        let growths = self.growths.as_ref()?.get(ranks.clone())?;
        let sum: f64 = growths.iter().map(|one| one.log.clamp(-1.0, 1.0)).sum();
        Some(sum / growths.len() as f64)
    }
}

/// Where stability changes within a step. `None` if a place is not found.
///
/// The number of multipliers outside the unit circle decides whether there is anything to be found; zeros of
/// [`Examined::tests`] are where most of it is.
pub(super) fn crossings<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    changes: &[(Place, LocatedEvent<O>)],
    fold: Option<f64>,
) -> Option<Vec<(Place, LocatedEvent<O>)>> {
    if step.before.tests().is_empty() {
        return Some(Vec::new());
    }
    let mut low = SeenStability::new(orbit, 0.0, step.from, step.before);
    let mut high = SeenStability::new(orbit, step.ds, step.to, step.after);
    let change = changes.iter().map(|(place, _)| place.s);
    let change = change.fold(f64::INFINITY, f64::min);
    let trimmed = AT_EVENT * change.min(step.ds);
    let mut margins = step.before.margins().iter();
    if margins.any(|margin| margin.value() <= AT_ZERO) {
        low = SeenStability::at(orbit, step, trimmed)?;
    }
    if change.is_finite() {
        high = SeenStability::at(orbit, step, change - trimmed)?;
    }
    if low.s >= high.s {
        return Some(Vec::new());
    }
    let signs = signs(orbit, step, [&low, &high], fold)?;
    let fold = fold.filter(|s| low.s < *s && *s < high.s);
    counted(orbit, step, [low, high], fold, signs)
}

/// Zeros of [`Examined::tests`] between two places of a step. `None` if one is not found.
fn signs<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    [low, high]: [&SeenStability; 2],
    fold: Option<f64>,
) -> Option<Vec<(Place, LocatedEvent<O>)>> {
    let tolerance = step.steps.tolerance;
    // a slope of the parameter whose sign rounding changes makes a function across folds change its own
    let slopes = [step.from, step.to].map(|node| node.tangent[node.tangent.len() - 1]);
    let by_rounding = (slopes[0] * slopes[1] < 0.0) != fold.is_some();
    let mut located = Vec::new();
    for (index, (&before, &after)) in low.tests.iter().zip(&high.tests).enumerate() {
        let ends = [step.before, step.after];
        let told = || ends.iter().all(|end| end.is_told(index));
        let differ = before * after < 0.0 && told();
        // nor where one of them is no number
        let own = ends[0].tests()[index] * ends[1].tests()[index];
        // and one that does not change makes it change at a fold
        let by_slope = match fold {
            Some(_) => orbit.across_folds(index, own, step.from).to_bits() != own.to_bits(),
            None => own > 0.0,
        };
        if !differ || by_rounding && by_slope {
            continue;
        }
        let value = |node: &Node| {
            let examination = orbit.examination(&node.point).ok()?;
            let value = examination.tests().get(index).copied()?;
            Some(orbit.across_folds(index, value, node))
        };
        let ends = ((low.s, before), (high.s, after));
        let regular = orbit.zero_of(Crossed::Zero(index), step.from, [low.s, high.s], tolerance);
        let (place, known, width) = match regular {
            Some((place, known)) => (place, Some(known), WIDTHS[0] * step.ds),
            None => {
                let (place, width) = narrowest(orbit, step, ends, value)?;
                (place, None, width)
            }
        };
        let node = &place.node;
        if orbit.crossing(index, node).is_none() && orbit.repeats(node).is_none() {
            continue;
        }
        let mut plane = Plane {
            normal: &step.from.tangent,
            through: &place.node.point,
        };
        let rounding = match known {
            Some(known) => known.max(rounding_beside(orbit, step, &place, [low, high])),
            None => {
                let of_orbit = uncertainty(orbit, &mut plane, &place);
                told_beside(orbit, step, &place, [low, high], of_orbit)
            }
        };
        // beside a homoclinic orbit a step moves the parameter by less than it is known to: its zeros are rounding
        let last = node.point.len() - 1;
        let moved = [step.from, step.to].map(|end| (end.point[last] - node.point[last]).abs());
        if rounding > (moved[0] + moved[1]) * orbit.unit().abs() {
            continue;
        }
        let located_there = LocatedEvent {
            event: BranchEvent::Crossing(index),
            // the place itself is known to the last bracket
            uncertainty: rounding + width * orbit.unit().abs(),
        };
        located.push((place, located_there));
    }
    Some(located)
}

/// The error of the parameter where stability changes: that of the orbit or, where a multiplier passes the circle slowly or is known
/// badly, as where a motion grows by much, how far on both sides of the place it is told that it has passed.
fn told_beside<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    place: &Place,
    [low, high]: [&SeenStability; 2],
    of_orbit: f64,
) -> f64 {
    // of a motion without loss it is told nowhere
    if low.known_outside().or(high.known_outside()).is_none() {
        return of_orbit;
    }
    let along = along(orbit, step, place);
    let outside = |s: f64| SeenStability::at(orbit, step, s)?.known_outside();
    let passes = |beside: &f64| {
        let before = outside(place.s - beside);
        before.is_some_and(|before| outside(place.s + beside).is_some_and(|after| after != before))
    };
    // what is known of the orbit, and twice as far every time as long as it is between the ends that are told apart
    let first = (of_orbit / along).max(f64::EPSILON * step.ds);
    let most = (place.s - low.s).min(high.s - place.s);
    let distances = std::iter::successors(Some(first), |beside| Some(2.0 * beside));
    let beside = distances.take_while(|beside| *beside < most).find(passes);
    beside.map_or(of_orbit, |beside| of_orbit.max(beside * along))
}

/// The error that rounding of the multipliers that pass makes of the parameter at a place that is found by equations of its own,
/// which do not know how fast they pass: with g = cδ^q beside it, q odd, that of g moves it by (error/c)^(1/q). No more than the
/// step where q is not told.
fn rounding_beside<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    place: &Place,
    [low, high]: [&SeenStability; 2],
) -> f64 {
    /// A multiplier is known no better than to a few roundings, and as a rule no worse there: its own error is a bound.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    /// The two distances at which q is told: at the smaller one g is far above rounding unless q is large.
    const NEARER: f64 = 8.0;
    let passing = |distance: f64| {
        let [before, after] =
            [-distance, distance].map(|by| SeenStability::at(orbit, step, place.s + by));
        let both = [before?, after?];
        let [before, after] = both.each_ref().map(SeenStability::outside);
        let ranks = before.min(after)..before.max(after);
        let [before, after] = both.each_ref().map(|seen| seen.mean(&ranks));
        let growths = both.iter().flat_map(|seen| seen.growths.iter().flatten());
        let error = growths.map(|one| one.error).fold(0.0, f64::max);
        (!ranks.is_empty()).then_some((ranks, before?.abs().min(after?.abs()), error))
    };
    let far = 0.5 * (place.s - low.s).min(high.s - place.s);
    let near = far / NEARER;
    let both = passing(far).zip(passing(near));
    let Some(((far_ranks, far_growth, _), (ranks, growth, error))) = both else {
        return 0.0;
    };
    let order = match far_ranks == ranks {
        true => (far_growth / growth).log(NEARER),
        false => 1.0,
    };
    let order = 2.0 * (0.5 * (order - 1.0)).round().max(0.0) + 1.0;
    let off = near * (ROUNDING.min(error) / growth).powf(1.0 / order);
    off.min(step.ds) * along(orbit, step, place)
}

/// An arclength, and what happens there.
type Gathered<O> = (f64, Vec<(Place, LocatedEvent<O>)>);

/// The crossing that a fold of the parameter at an arclength is: of a pitchfork, and known better.
fn turning_crossing<O: Orbit>(
    step: &Step<O>,
    signs: &[(Place, LocatedEvent<O>)],
    s: f64,
) -> Option<f64> {
    let turns = |located: &LocatedEvent<O>| match located.event {
        BranchEvent::Crossing(test) => O::turns_at(test),
        _ => false,
    };
    let mut signs = signs.iter();
    let near = |(place, located): &&(Place, LocatedEvent<O>)| {
        turns(located) && (place.s - s).abs() <= TURN * step.ds
    };
    signs.find(near).map(|(place, _)| place.s)
}

/// What the number of multipliers outside the unit circle says: crossings at which it does not change are none, and where
/// it changes without one there is one more.
fn counted<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    [low, high]: [SeenStability; 2],
    fold: Option<f64>,
    signs: Vec<(Place, LocatedEvent<O>)>,
) -> Option<Vec<(Place, LocatedEvent<O>)>> {
    let number = |located: &LocatedEvent<O>| match located.event {
        BranchEvent::Crossing(test) => O::passed_by(test),
        _ => 0,
    };
    let fold = fold.map(|s| turning_crossing(step, &signs, s).unwrap_or(s));
    // what is known needs no second look
    let known = match (&signs[..], fold) {
        ([], None) => Some(0),
        ([(_, located)], None) => Some(number(located)),
        ([], Some(_)) => Some(1),
        ([(place, _)], Some(s)) if place.s == s => Some(0),
        _ => None,
    };
    let change = low.change(&high);
    if change.is_none() || change.map(i64::unsigned_abs) == known {
        return Some(signs);
    }
    // places, each with what happens there
    let mut all: Vec<Gathered<O>> = fold.map(|s| (s, Vec::new())).into_iter().collect();
    all.extend(signs.into_iter().map(|one| (one.0.s, vec![one])));
    all.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    let mut places: Vec<Gathered<O>> = Vec::with_capacity(all.len());
    for (s, events) in all {
        match places.last_mut() {
            Some((last, together)) if s - *last <= step.at_once() => together.extend(events),
            _ => places.push((s, events)),
        }
    }
    let ends: Vec<f64> = std::iter::once(low.s)
        .chain(places.iter().map(|(s, _)| *s))
        .chain([high.s])
        .collect();
    let mut found = Vec::new();
    let mut from = Some(low);
    for ((s, events), beside) in places.into_iter().zip(ends.windows(3)) {
        let before = SeenStability::at(orbit, step, s - AT_EVENT * (s - beside[0]));
        let after = SeenStability::at(orbit, step, s + AT_EVENT * (beside[2] - s));
        found.extend(uncounted(orbit, step, from.as_ref(), before.as_ref())?);
        let both = before.as_ref().zip(after.as_ref());
        let change = both.and_then(|(before, after)| before.change(after));
        let seen: u64 = events.iter().map(|(_, located)| number(located)).sum();
        let folds = fold.is_some_and(|fold| (fold - s).abs() <= step.at_once());
        match (change.map(i64::unsigned_abs), both) {
            // a zero of a sign there may be one of a branch that crosses this one
            (Some(passing), Some((before, after))) if !folds && passing != seen => {
                if passing > 0 && passings(orbit, step, before, after, &mut found).is_none() {
                    found.push(within_step(orbit, step, [before, after], &events[0].0.node));
                }
            }
            _ => found.extend(events),
        }
        from = after;
    }
    found.extend(uncounted(orbit, step, from.as_ref(), Some(&high))?);
    Some(found)
}

/// Where the number of multipliers outside the unit circle changes between two places of a step between which no
/// crossing is known. `None` if that is not found and a shorter step may be tried.
fn uncounted<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    low: Option<&SeenStability>,
    high: Option<&SeenStability>,
) -> Option<Vec<(Place, LocatedEvent<O>)>> {
    let both = low.zip(high);
    let Some((low, high)) = both.filter(|(low, high)| low.change(high).is_some_and(|by| by != 0))
    else {
        return Some(Vec::new());
    };
    let mut found = Vec::new();
    if passings(orbit, step, low, high, &mut found).is_some() {
        return Some(found);
    }
    // in a step that cannot be shorter it is told between which values it is
    let shortest = step.ds <= step.steps.ds_min * (1.0 + f64::EPSILON);
    shortest.then(|| vec![within_step(orbit, step, [low, high], step.to)])
}

/// A change of the number between two places of a step, told at a node.
fn within_step<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    ends: [&SeenStability; 2],
    node: &Node,
) -> (Place, LocatedEvent<O>) {
    let [from, to] = [step.from, step.to].map(|node| orbit.value_at(&node.point));
    let value = |s: f64| from + s / step.ds * (to - from);
    let s = ends[1].s;
    unlocated(ends.map(|seen| (seen.outside(), value(seen.s))), s, node)
}

/// A change of the number between two values of the parameter, told at a node this far along a step.
fn unlocated<O: Orbit>(ends: [(usize, f64); 2], s: f64, node: &Node) -> (Place, LocatedEvent<O>) {
    let between = ends.map(|(_, value)| value);
    let place = Place {
        s,
        node: node.clone(),
        blur: 0.0,
    };
    let located = LocatedEvent {
        event: BranchEvent::Passing {
            outside: ends.map(|(outside, _)| outside),
            between: Some(between),
        },
        uncertainty: (between[1] - between[0]).abs(),
    };
    (place, located)
}

/// Multipliers that are this near to the circle, in the logarithm, where the mean of several is on it pass together: two that
/// are one in a Jordan block are known to the square root of rounding.
const PASS_TOGETHER: f64 = 1e-7;

/// Brackets in which changes are looked for, in parts of the step.
const WIDTHS: [f64; 3] = [4.0 * f64::EPSILON, 1e-10, 1e-7];

/// The zero of a function between two places of a step, and the bracket in which it is found: where branches cross there is no orbit
/// next to it.
fn narrowest<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    ends: ((f64, f64), (f64, f64)),
    mut value: impl FnMut(&Node) -> Option<f64>,
) -> Option<(Place, f64)> {
    WIDTHS.into_iter().find_map(|part| {
        let width = part * step.ds;
        let tolerance = step.steps.tolerance;
        let found = locate::zero_along(orbit, step.from, ends, (0.0, width), tolerance, &mut value);
        found.map(|(place, _)| (place, width))
    })
}

/// The same between two places at which the number differs: a zero of the mean growth of those that pass, and where they do
/// so one by one those on both sides of it.
fn passings<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    low: &SeenStability,
    high: &SeenStability,
    found: &mut Vec<(Place, LocatedEvent<O>)>,
) -> Option<()> {
    let outside = [low.outside(), high.outside()];
    let [before, after] = outside;
    let ranks = before.min(after)..before.max(after);
    if ranks.is_empty() {
        return Some(());
    }
    let event = BranchEvent::Passing {
        outside,
        between: None,
    };
    let (what, within) = (Crossed::Several(ranks.len()), [low.s, high.s]);
    if ranks.len() > 1
        && let Some((place, uncertainty)) =
            orbit.zero_of(what, step.from, within, step.steps.tolerance)
    {
        found.push((place, LocatedEvent { event, uncertainty }));
        return Some(());
    }
    let ends = ((low.s, low.mean(&ranks)?), (high.s, high.mean(&ranks)?));
    let mut seen = None;
    let mut value = |node: &Node| {
        let s = step.from.tangent.dot(&(&node.point - &step.from.point));
        let examination = orbit.examination(&node.point).ok()?;
        let there = SeenStability::new(orbit, s, node, &examination);
        let mean = there.mean(&ranks);
        seen = Some(there);
        mean
    };
    let (place, width) = narrowest(orbit, step, ends, &mut value)?;
    let there = seen?;
    let passing = there.growths.as_ref()?.get(ranks.clone())?;
    // each of them passes where its own growth is zero
    let off = passing.iter().map(|one| one.error + one.log.abs());
    let error = off.fold(0.0, f64::max);
    let passes = |one: &Growth| one.log.abs() <= PASS_TOGETHER + one.error;
    let between = there.outside();
    if !passing.iter().all(passes) {
        if between == before || between == after {
            // they jump from one side to the other
            let ends = match between == before {
                true => [&there, high],
                false => [low, &there],
            };
            found.push(within_step(orbit, step, ends, &place.node));
            return Some(());
        }
        passings(orbit, step, low, &there, found)?;
        return passings(orbit, step, &there, high, found);
    }
    let mut plane = Plane {
        normal: &step.from.tangent,
        through: &place.node.point,
    };
    let slope = (ends.1.1 - ends.0.1).abs() / (high.s - low.s);
    let blur = along(orbit, step, &place) * (error / slope + width);
    let rounding = uncertainty(orbit, &mut plane, &place);
    // where branches cross the equations are singular: no more than the step
    let rounding = rounding.min(moved(orbit, step));
    let uncertainty = rounding + blur;
    found.push((place, LocatedEvent { event, uncertainty }));
    Some(())
}

/// How far the parameter moves along a branch at a place within a step, for 1 of its length. Where branches cross the tangent may be
/// that of another one.
fn along<O: Orbit>(orbit: &O, step: &Step<O>, place: &Place) -> f64 {
    let tangent = &place.node.tangent;
    let slope = tangent[tangent.len() - 1].abs() * orbit.unit().abs();
    slope.max(moved(orbit, step) / step.ds)
}

/// How far the parameter moves within a step.
fn moved<O: Orbit>(orbit: &O, step: &Step<O>) -> f64 {
    let last = step.to.point.len() - 1;
    (step.to.point[last] - step.from.point[last]).abs() * orbit.unit().abs()
}
