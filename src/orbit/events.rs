//! What happens within a step of a branch: where it is, and how well that is known.

use super::crossings::{OutsideCount, crossings, is_crossing};
use super::located::{AT_ZERO, BranchEvent, LocatedEvent, Step, TURN};
use super::monitor::{self, MonitorStop};
use super::special::OrbitRefusal;
use super::{
    AtZero, EndWithin, Examined, MarginFunction, Orbit, SignVerdict, find, retrace, uncertainty,
};
use crate::continuation::arclength::{self, Node};
use crate::continuation::locate::{self, Place, Target};
use crate::continuation::newton::{self, Plane};
use crate::linalg::{Vector, condition};

/// A tangent whose parameter component is below this does not tell a direction.
pub(super) const VERTICAL: f64 = 1e-7;

/// Parts of a step after which the direction of the parameter is looked for.
const NEAR: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// An event known less well than this, relative to the parameter or its range, is not reported;
/// rounding at the stiff end leaves 1e-9. With a coarse tolerance: than this many tolerances.
const UNCERTAIN: f64 = 1e-6;
const MOST_UNCERTAIN: f64 = 1e4;

/// Beside a change known less well than this, relative to the same, others that vanish with it are looked for.
const BADLY: f64 = 1e-9;

/// A margin below this at a point is zero but for rounding.
pub(super) fn rounding<O: Orbit>(orbit: &O, place: &Place, margin: &O::Margin) -> f64 {
    let all = Vector::repeat(place.node.point.len(), 1.0);
    AT_ZERO + 8.0 * place.blur * orbit.reach(margin, &all)
}

/// Whether the tangent at a node does not tell the direction of the parameter: beyond the opening of some zones
/// the branch starts with none, but for rounding, which thin layers magnify.
pub(super) fn is_vertical<O: Orbit>(orbit: &O, node: &Node) -> bool {
    node.tangent[node.tangent.len() - 1].abs() <= VERTICAL || orbit.opens(&node.point)
}

/// A margin is level at the end of a step where its slope would take this part of its first value away.
const LEVEL: f64 = 1e-3;

/// All that happens within a step: also where an edge of `range` and the ordered values of `stop_at` are met. `told` says
/// where the number of multipliers outside the unit circle was last known before.
pub(super) fn located<O: Orbit>(
    orbit: &O,
    range: (f64, f64),
    (stop_at, monitors): (&[f64], &[MonitorStop]),
    told: Option<OutsideCount>,
    step: &Step<O>,
) -> Result<Vec<(Place, LocatedEvent<O>)>, OrbitRefusal<O>> {
    if let Some(ends) = ends(orbit, range, stop_at, step) {
        return ends;
    }
    let changes = changes(orbit, step)?;
    // where zones of both halves of an orbit close at once the equations are singular, and no fold is found
    let fold = match fold(orbit, step) {
        None if turns_at_closing(orbit, step, &changes) => None,
        found => found.ok_or(OrbitRefusal::NotFound)?,
    };
    let targets =
        targets(orbit, range, stop_at, step, fold.as_ref()).ok_or(OrbitRefusal::NotFound)?;
    // where a zone closes, or a guard is met at zero speed that is squared in the equations, the parameter is stationary
    // along the arc: that is the event itself
    let apart = |fold: &(Place, LocatedEvent<O>)| {
        let value = |place: &Place| orbit.value_at(&place.node.point);
        changes.iter().all(|(place, change)| {
            let rounding = change.uncertainty + fold.1.uncertainty;
            let same = (value(place) - value(&fold.0)).abs() <= rounding;
            let stationary = || {
                let grazes = match (&change.event, &fold.1.event) {
                    (BranchEvent::Change(margin), BranchEvent::Fold) => margin.grazes(),
                    _ => false,
                };
                grazes || orbit.closes(&place.node.point)
            };
            (place.s - fold.0.s).abs() > step.at_once() && !(same && stationary())
        }) && (changes.is_empty() || !orbit.closes(&fold.0.node.point))
    };
    let turns = fold.as_ref().map(|(place, _)| place.s);
    let fold = fold.filter(&apart);
    let crossings = crossings(orbit, step, &changes, turns).ok_or(OrbitRefusal::NotFound)?;
    let on_crossing = |one| at_crossing(orbit, one, &crossings);
    let targets: Vec<_> = targets.into_iter().map(on_crossing).collect();
    // a loss of symmetry is seen as a fold and as a crossing
    let seen = |(place, located): &(Place, LocatedEvent<O>)| match (&fold, &located.event) {
        (
            Some((
                _,
                LocatedEvent {
                    event: BranchEvent::Image(special, _),
                    ..
                },
            )),
            BranchEvent::Crossing(test),
        ) => is_crossing(orbit, *test, &place.node, special),
        _ => false,
    };
    let crossings: Vec<_> = crossings
        .into_iter()
        .filter(|one| apart(one) && !seen(one))
        .collect();
    // where a branch meets the middle of another one its parameter is stationary, and that is no fold
    let fold = fold.filter(|fold| !crossings.iter().any(|one| is_turn(orbit, step, fold, one)));
    check_uncertainty(orbit, step, fold.iter().chain(&changes))?;
    let monitors = at_monitors(orbit, monitors, step, &changes).ok_or(OrbitRefusal::NotFound)?;
    let nothing = fold.is_none() && changes.is_empty() && crossings.is_empty();
    let unseen = told
        .filter(|_| nothing)
        .and_then(|told| told.unseen(orbit, step));
    let exact = fold.into_iter().chain(targets).chain(monitors);
    let all = exact.chain(changes).chain(crossings);
    Ok(all.chain(unseen).collect())
}

/// Refuses a step with a fold or a change that is known too badly. Where branches cross the equations are singular: changes of
/// stability are told with any error, since shorter steps only come nearer.
fn check_uncertainty<'a, O: Orbit + 'a>(
    orbit: &O,
    step: &Step<O>,
    located: impl Iterator<Item = &'a (Place, LocatedEvent<O>)>,
) -> Result<(), OrbitRefusal<O>> {
    for (place, LocatedEvent { event, uncertainty }) in located {
        if matches!(event, BranchEvent::Image(..)) {
            continue;
        }
        let value = orbit.value_at(&place.node.point);
        let unit = orbit.unit().abs().max(value.abs());
        let most = UNCERTAIN.max(MOST_UNCERTAIN * step.steps.tolerance) * unit;
        if uncertainty.is_nan() || *uncertainty > most {
            return Err(OrbitRefusal::Uncertain {
                parameter: orbit.parameter(),
                value,
                error: *uncertainty,
            });
        }
    }
    Ok(())
}

/// Whether the parameter turns where zones close, and nowhere else in a step: its slopes at both ends are in proportion to the
/// distances from there.
fn turns_at_closing<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    changes: &[(Place, LocatedEvent<O>)],
) -> bool {
    /// The slope bends by this part of itself at most.
    const BENDS: f64 = 0.1;
    let last = step.from.tangent.len() - 1;
    let slopes = [step.from, step.to].map(|node| node.tangent[last]);
    let mut closings = changes
        .iter()
        .filter(|(place, _)| orbit.closes(&place.node.point));
    closings.any(|(place, _)| {
        let [before, after] = [slopes[0] * (step.ds - place.s), slopes[1] * place.s];
        slopes[0] * slopes[1] < 0.0
            && (before + after).abs() <= BENDS * before.abs().max(after.abs())
    })
}

/// A target at the place of the crossing of branches at its value: there a family of orbits has that value, and the equations do not
/// tell which of them lies on the branch.
fn at_crossing<O: Orbit>(
    orbit: &O,
    (place, target): (Place, LocatedEvent<O>),
    crossings: &[(Place, LocatedEvent<O>)],
) -> (Place, LocatedEvent<O>) {
    let value = orbit.value_at(&place.node.point);
    let there = crossings.iter().find(|(place, crossing)| {
        (orbit.value_at(&place.node.point) - value).abs() <= crossing.uncertainty
    });
    let Some((crossing, _)) = there else {
        return (place, target);
    };
    let mut crossing = crossing.clone();
    let last = crossing.node.point.len() - 1;
    crossing.node.point[last] = place.node.point[last];
    (crossing, target)
}

/// Whether a fold is a crossing of branches at which the parameter is stationary.
fn is_turn<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    fold: &(Place, LocatedEvent<O>),
    (place, located): &(Place, LocatedEvent<O>),
) -> bool {
    let BranchEvent::Crossing(test) = located.event else {
        return false;
    };
    let value = |place: &Place| orbit.value_at(&place.node.point);
    let apart = (value(place) - value(&fold.0)).abs();
    let known = located.uncertainty + fold.1.uncertainty;
    O::turns_at(test) && apart <= known && (place.s - fold.0.s).abs() <= TURN * step.ds
}

/// The end of a branch within a step, and user points and edges before it. Beyond an equilibrium to which orbits shrink every
/// inequality has the other sign: nothing else is looked for.
#[allow(clippy::type_complexity)] // what `located` gives, or none
fn ends<O: Orbit>(
    orbit: &O,
    range: (f64, f64),
    stop_at: &[f64],
    step: &Step<O>,
) -> Option<Result<Vec<(Place, LocatedEvent<O>)>, OrbitRefusal<O>>> {
    match orbit.ends_within(step) {
        EndWithin::Not => None,
        EndWithin::Far => Some(Err(OrbitRefusal::NotFound)),
        EndWithin::At {
            s,
            node,
            special,
            stop,
            uncertainty,
        } => {
            let end = LocatedEvent {
                event: BranchEvent::End(special, stop),
                uncertainty,
            };
            let to = Node {
                tangent: step.from.tangent.clone(),
                ..*node
            };
            let place = Place {
                s,
                node: to.clone(),
                blur: 0.0,
            };
            let before = Step::<O> {
                to: &to,
                ds: s,
                ..*step
            };
            let targets = targets(orbit, range, stop_at, &before, None);
            let all = targets.map(|targets| targets.into_iter().chain([(place, end)]).collect());
            Some(all.ok_or(OrbitRefusal::NotFound))
        }
    }
}

/// Whether there is a fold within a step, where the slope of the parameter is not much more than rounding, as beside a homoclinic
/// orbit or along a canard: the orbits tell, if they do.
pub(super) fn turns<O: Orbit>(orbit: &O, step: &Step<O>) -> Option<bool> {
    /// The slope at both ends, where it is not much more: rounding is magnified by what grows along an orbit.
    const LITTLE: f64 = 1e-5;
    let last = step.from.tangent.len() - 1;
    let slopes = [step.from, step.to].map(|node| node.tangent[last].abs());
    let is_little = slopes.iter().all(|slope| *slope <= LITTLE);
    is_little.then(|| orbit.turns(step)).flatten()
}

/// The place of a fold within a step along which the slope of the parameter is rounding, as what an orbit has there tells, and that
/// slope.
fn told_fold<O: Orbit>(orbit: &O, step: &Step<O>) -> Option<(Place, f64)> {
    /// The place is known to this part of the step: the parameter is to rounding all along it.
    const HALVINGS: usize = 12;
    let (mut low, mut high) = (0.0, step.ds);
    let mut node = step.to.clone();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let to = locate::node_at(orbit, step.from, middle, step.steps.tolerance)?;
        let after = orbit.examination(&to.point).ok()?;
        let first = Step::<O> {
            to: &to,
            after: &after,
            ds: middle,
            ..*step
        };
        match orbit.turns(&first) {
            Some(false) => low = middle,
            Some(true) => (high, node) = (middle, to),
            None => {
                (high, node) = (middle, to);
                break;
            }
        }
    }
    let slope = node.tangent[node.tangent.len() - 1];
    let place = Place {
        s: high,
        node,
        blur: 0.0,
    };
    Some((place, slope))
}

/// Whether a step at whose beginning the parameter is stationary, but for next to nothing, may begin beside a fold: neither does a zone
/// open there, nor do branches cross.
fn may_begin_at_fold<O: Orbit>(orbit: &O, step: &Step<O>) -> bool {
    /// Condition of the equations with the tangent, above which they are singular.
    const CROSSING: f64 = 1e8;
    let node = step.from;
    let mut margins = step.before.margins().iter();
    if orbit.opens(&node.point) || margins.any(|margin| margin.value() <= AT_ZERO) {
        return false;
    }
    let mut plane = Plane {
        normal: &node.tangent,
        through: &node.point,
    };
    let bordered = newton::bordered(orbit, &mut plane, &node.point);
    bordered.is_ok_and(|bordered| condition(&bordered.matrix) < CROSSING)
}

/// The fold inside a step at whose ends the parameter moves in opposite directions: a zero of the last
/// component of the tangent. `None` if it is not found.
#[allow(clippy::option_option)] // found or not, there or not
fn fold<O: Orbit>(orbit: &O, step: &Step<O>) -> Option<Option<(Place, LocatedEvent<O>)>> {
    /// Slopes that are smaller are rounding alone: a fold may not change their sign. Others change it, or branches cross.
    const ROUNDING: f64 = 1e-9;
    let tolerance = step.steps.tolerance;
    let last = step.from.tangent.len() - 1;
    let mut low = (0.0, step.from.tangent[last]);
    let mut high = (step.ds, step.to.tangent[last]);
    if is_vertical(orbit, step.from) {
        // where a zone opens the parameter is stationary: a short way on it tells its direction, where that is more than
        // rounding. A layer may turn the branch on a shorter one
        let beside = |part: f64| {
            let near = part * step.ds;
            let step = arclength::advance(orbit, step.from, &[], near, tolerance).ok()?;
            Some((near, step.node.tangent[last]))
        };
        let is_told = |(_, slope): &(f64, f64)| slope.abs() > ROUNDING;
        let mut near = NEAR.into_iter().filter_map(beside);
        let first = near.next()?;
        let near = Some(first).filter(is_told).or_else(|| near.find(is_told));
        let near = near.unwrap_or(first);
        match low.1 * near.1 < 0.0 && may_begin_at_fold(orbit, step) {
            true => high = near,
            false => low = near,
        }
    }
    let is_rounding = low.1.abs().max(high.1.abs()) <= ROUNDING;
    let (place, slope) = match (turns(orbit, step), low.1 * high.1 < 0.0) {
        (Some(true), false) if is_rounding => told_fold(orbit, step)?,
        (Some(false), _) | (_, false) => return Some(None),
        (_, true) => locate::fold(orbit, step.from, (low, high), tolerance)?,
    };
    let mut plane = Plane {
        normal: &step.from.tangent,
        through: &place.node.point,
    };
    let bordered = newton::bordered(orbit, &mut plane, &place.node.point).ok()?;
    let rounding = orbit.rounding(&bordered.matrix, &place.node.point, 0.0);
    let image = retrace::at_fold(orbit, step.from, &place, step.ds, tolerance);
    // where branches cross the equations are singular
    let rounding = rounding.or(image.as_ref().map(|_| f64::INFINITY))?;
    // the parameter is off by ½·slope²/curvature, the curvature being the mean one of the step
    let curvature = (high.1 - low.1).abs().max(f64::MIN_POSITIVE) / (high.0 - low.0);
    let uncertainty = rounding + 0.5 * slope.abs() * slope.abs() / curvature;
    let located = LocatedEvent {
        event: image.map_or(BranchEvent::Fold, |(special, stop)| {
            BranchEvent::Image(special, stop)
        }),
        uncertainty: uncertainty * orbit.unit(),
    };
    Some(Some((place, located)))
}

/// User points and edges of the range within a step; `None` if one is not found.
fn targets<O: Orbit>(
    orbit: &O,
    (lower, upper): (f64, f64),
    stop_at: &[f64],
    step: &Step<O>,
    fold: Option<&(Place, LocatedEvent<O>)>,
) -> Option<Vec<(Place, LocatedEvent<O>)>> {
    // on the pieces between these the parameter is monotone
    let fold = fold.map(|(place, _)| &place.node);
    let ends = std::iter::once(step.from).chain(fold).chain([step.to]);
    let ends: Vec<&Vector> = ends.map(|node| &node.point).collect();
    // of many user points those between the least and the largest value of the step
    let values = ends.iter().map(|point| orbit.value_at(point));
    let (least, largest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let slack = 8.0 * f64::EPSILON * least.abs().max(largest.abs());
    let first = stop_at.partition_point(|value| *value < least - slack);
    let user = stop_at[first..]
        .iter()
        .take_while(|value| **value <= largest + slack);
    let wanted = user
        .map(|&value| (value, 0.0, BranchEvent::User(value)))
        .chain([
            (lower, -1.0, BranchEvent::Edge(lower)),
            (upper, 1.0, BranchEvent::Edge(upper)),
        ]);
    let mut located = Vec::new();
    for (value, outside, event) in wanted {
        let target = Target {
            index: orbit.unknowns() - 1,
            value: value / orbit.unit(),
            outside,
        };
        let places = target.meetings(orbit, step.from, &ends, step.steps.tolerance)?;
        let located_there = LocatedEvent {
            event,
            uncertainty: f64::EPSILON * value.abs(),
        };
        located.extend(
            places
                .into_iter()
                .map(|place| (place, located_there.clone())),
        );
    }
    Some(located)
}

/// Where monitors have values that are asked for within a step, before the first of its changes. `None` if a place is not
/// found.
fn at_monitors<O: Orbit>(
    orbit: &O,
    stops: &[MonitorStop],
    step: &Step<O>,
    changes: &[(Place, LocatedEvent<O>)],
) -> Option<Vec<(Place, LocatedEvent<O>)>> {
    let places = changes.iter().map(|(place, _)| place);
    let first = places.min_by(|one, other| one.s.total_cmp(&other.s));
    let end = first.map_or((step.ds, step.to), |place| (place.s, &place.node));
    let all = monitor::located(orbit, stops, step, end)?.into_iter();
    let events = all.map(|one| {
        let event = BranchEvent::Monitor(one.stop);
        let uncertainty = one.uncertainty;
        (one.place, LocatedEvent { event, uncertainty })
    });
    Some(events.collect())
}

/// Margins that vanish within a step.
pub(super) fn changes<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
) -> Result<Vec<(Place, LocatedEvent<O>)>, OrbitRefusal<O>> {
    if step.after.verdict() == SignVerdict::Positive {
        return Ok(Vec::new());
    }
    let negative = || {
        let margins = step.after.margins().iter();
        margins.filter(|margin| margin.value() <= 0.0)
    };
    let count = negative().count();
    if count == 0 {
        return Err(OrbitRefusal::Inadmissible(orbit.inadmissible(step.after)));
    }
    let mut located: Vec<_> = negative()
        .filter_map(|margin| change(orbit, step, margin))
        .collect();
    if located.is_empty() {
        // beside the least value between two zeros Newton's method leaves the step, a bracket does not
        located = negative()
            .filter_map(|margin| bracketed(orbit, step, margin))
            .collect();
    }
    if located.is_empty() {
        return Err(OrbitRefusal::NotLocated(count));
    }
    let others = beside_one_known_badly(orbit, step, negative(), &located);
    located.extend(others);
    let better = |one| better_known(orbit, one, &located);
    let better: Vec<_> = located.iter().map(better).collect();
    let pairs = better.into_iter().zip(located);
    Ok(pairs.map(|(better, own)| better.unwrap_or(own)).collect())
}

/// The changes of margins that vanish with others, of which the best known is known badly, from the place of that one.
fn beside_one_known_badly<'a, O: Orbit + 'a>(
    orbit: &O,
    step: &Step<O>,
    negative: impl Iterator<Item = &'a O::Margin>,
    located: &[(Place, LocatedEvent<O>)],
) -> Vec<(Place, LocatedEvent<O>)> {
    let error = |one: &(Place, LocatedEvent<O>)| one.1.uncertainty;
    let best = located
        .iter()
        .min_by(|one, other| error(one).total_cmp(&error(other)));
    let badly = |(place, known): &&(Place, LocatedEvent<O>)| {
        let value = orbit.value_at(&place.node.point);
        known.uncertainty > BADLY * orbit.unit().abs().max(value.abs())
    };
    let Some((place, _)) = best.filter(badly) else {
        return Vec::new();
    };
    let is_known = |margin: &O::Margin| {
        located.iter().any(|(_, one)| match &one.event {
            BranchEvent::Change(own) => own.is_same(margin),
            _ => false,
        })
    };
    negative
        .filter(|margin| !is_known(margin))
        .filter_map(|margin| zero_near(orbit, step, margin, &place.node.point))
        .collect()
}

/// The change of a margin at the place of another one that vanishes with it and is known much better: of two zones that close
/// together, one of which begins beyond its guard, the equations tell the duration of that one badly.
fn better_known<O: Orbit>(
    orbit: &O,
    (place, own): &(Place, LocatedEvent<O>),
    all: &[(Place, LocatedEvent<O>)],
) -> Option<(Place, LocatedEvent<O>)> {
    /// Part of an error that is much better.
    const MUCH: f64 = 1e-2;
    let BranchEvent::Change(margin) = &own.event else {
        return None;
    };
    let better = |(_, one): &&(Place, LocatedEvent<O>)| one.uncertainty < MUCH * own.uncertainty;
    let mut at = AtZero {
        margin: margin.clone(),
    };
    all.iter().filter(better).find_map(|(other, known)| {
        let margin = at.margin_at(orbit, &other.node.point).ok()?;
        let together = margin.value().abs() <= rounding(orbit, place, margin);
        together.then(|| {
            let located = LocatedEvent {
                event: BranchEvent::Change(margin.clone()),
                uncertainty: known.uncertainty,
            };
            (other.clone(), located)
        })
    })
}

/// The zero of a margin that is negative at the end of a step.
fn change<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    margin: &O::Margin,
) -> Option<(Place, LocatedEvent<O>)> {
    let (start, end) = (&step.from.point, &step.to.point);
    let before = find::<O>(step.before, margin);
    let guess = before
        .map(MarginFunction::value)
        .filter(|m0| *m0 > 0.0)
        .map(|m0| start + (end - start) * (m0 / (m0 - margin.value())));
    let mut guesses = guess.into_iter().chain([end.clone()]);
    guesses.find_map(|guess| zero_near(orbit, step, margin, &guess))
}

/// The same in a bracket, of a margin that is positive at the beginning of the step and level at its end.
fn bracketed<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    margin: &O::Margin,
) -> Option<(Place, LocatedEvent<O>)> {
    let before = find::<O>(step.before, margin)?.value();
    let slope = orbit.slope(margin, &step.to.tangent);
    if before <= 0.0 || (slope * step.ds).abs() > LEVEL * before {
        return None;
    }
    let mut at = AtZero {
        margin: margin.clone(),
    };
    let ends = ((0.0, before), (step.ds, margin.value()));
    let small = (0.0, 4.0 * f64::EPSILON * step.ds);
    let value = |node: &Node| Some(at.margin_at(orbit, &node.point).ok()?.value());
    let tolerance = step.steps.tolerance;
    let (place, _) = locate::zero_along(orbit, step.from, ends, small, tolerance, value)?;
    zero_near(orbit, step, margin, &place.node.point)
}

/// The zero of a margin within a step to which Newton's method leads from a guess.
fn zero_near<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    margin: &O::Margin,
    guess: &Vector,
) -> Option<(Place, LocatedEvent<O>)> {
    let mut constraint = AtZero {
        margin: margin.clone(),
    };
    let place = locate::solve(
        orbit,
        step.from,
        guess,
        &mut constraint,
        step.steps.tolerance,
    )?;
    // a little outside is rounding of an event at the very end of the step
    if place.s < -1e-9 * step.ds || place.s > step.ds * (1.0 + 1e-9) {
        return None;
    }
    let uncertainty = uncertainty(orbit, &mut constraint, &place);
    let margin = constraint.margin_at(orbit, &place.node.point).ok()?;
    let located = LocatedEvent {
        event: BranchEvent::Change(margin.clone()),
        uncertainty,
    };
    Some((place, located))
}

/// Whether no margin has failed at a place, but for rounding.
pub(super) fn holds<O: Orbit>(orbit: &O, place: &Place, examination: &O::Examination) -> bool {
    let mut margins = examination.margins().iter();
    margins.all(|margin| margin.value() >= -rounding(orbit, place, margin))
}
