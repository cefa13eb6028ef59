//! What comes close to zero within a step and has one sign at both of its ends: a margin, the slope of the parameter, or the growth of
//! a multiplier.

use super::located::{AT_ZERO, BranchEvent, LocatedEvent, Step};
use super::special::Close;
use super::{AtZero, Examined, MarginFunction, Orbit, crossings, events, paired};
use crate::continuation::arclength::Node;
use crate::continuation::locate::{self, LeastWithin, Place};
use crate::continuation::newton::{self, Plane, Rounding};
use crate::continuation::walk::Within;
use crate::linalg::Vector;

/// Part of a step over which the slope of a tangent is taken as a difference.
const DIFFERENCE: f64 = 1e-4;

/// The same where the slope jumps: what rounding leaves of it is less than the jump.
const SHARP: f64 = 1e-8;

/// A margin below this is zero where a step starts from an event; between two zeros of one that lie close
/// together margins are as small as 1e-12.
const VANISHED: f64 = 1e-13;

/// A least value is negative, and two zeros lie beside it, where it is below this many times its rounding:
/// their places are then known to half a per cent of their distance.
const BELOW_ROUNDING: f64 = 100.0;

/// Whether a margin that is positive at both ends of a step may have been negative between them:
/// the cubic that shares values and slopes at the ends dips below zero.
pub(super) fn may_hide_a_pair<O: Orbit>(orbit: &O, step: &Step<O>) -> bool {
    paired::<O>(step.before, step.after).any(|(before, after)| {
        let (m0, m1) = (before.value(), after.value());
        // margins at zero belong to the event the step starts from
        if m0 <= AT_ZERO || m1 <= 0.0 {
            return false;
        }
        let d0 = step.ds * orbit.slope(before, &step.from.tangent);
        let d1 = step.ds * orbit.slope(after, &step.to.tangent);
        // a dip needs a fall at the beginning and a rise at the end
        if d0 >= 0.0 || d1 <= 0.0 {
            return false;
        }
        (1..16).any(|index| {
            let x = f64::from(index) / 16.0;
            let y = 1.0 - x;
            y * y * ((1.0 + 2.0 * x) * m0 + x * d0) + x * x * ((1.0 + 2.0 * y) * m1 - y * d1) < 0.0
        })
    })
}

/// Whether something that is positive at both ends of a step vanishes between them: a margin, or the slope
/// of the parameter. `located` is what is known to happen.
pub(super) fn within<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    located: &[(Place, LocatedEvent<O>)],
) -> Within<Close<O::Inequality>> {
    let tolerance = step.steps.tolerance;
    let ends = |event: &BranchEvent<O>| {
        matches!(
            event,
            BranchEvent::Change(_)
                | BranchEvent::Edge(_)
                | BranchEvent::Image(..)
                | BranchEvent::End(..)
        )
    };
    let mut ends = located.iter().filter(|(_, located)| ends(&located.event));
    // what is even in the duration of a zone that closes vanishes with it, and is no pair
    let end = ends.next().map(|(place, _)| place.s - step.at_once());
    let end = end.unwrap_or(f64::INFINITY);
    let mut close: Option<(f64, Close<O::Inequality>)> = None;
    let mut pair = f64::INFINITY;
    let mut take = |least: LeastWithin,
                    what: &dyn Fn() -> Close<O::Inequality>,
                    rounding: &dyn Fn(&Place) -> f64| match least {
        LeastWithin::Found(place, value) if place.s < end => {
            let rounding = rounding(&place);
            if value < -BELOW_ROUNDING * rounding {
                pair = pair.min(place.s);
            } else if value <= rounding {
                close.get_or_insert_with(|| (place.s, what()));
            }
        }
        LeastWithin::NotFound if step.ds < end => {
            close.get_or_insert_with(|| (step.ds, what()));
        }
        _ => {}
    };
    for (before, after) in paired::<O>(step.before, step.after) {
        // margins at zero belong to the event the step starts from
        if before.value() <= VANISHED || after.value() <= 0.0 {
            continue;
        }
        let ends = [(before, step.from), (after, step.to)]
            .map(|(margin, node)| (margin.value(), orbit.slope(margin, &node.tangent)));
        let mut at = AtZero {
            margin: before.clone(),
        };
        let least = locate::least(orbit, step.from, step.ds, ends, tolerance, |node| {
            let margin = at.margin_at(orbit, &node.point).ok()?;
            Some((margin.value(), orbit.slope(margin, &node.tangent)))
        });
        let rounding = |place: &Place| blur(orbit, step, &at.margin, place);
        let what = || Close::Margin(orbit.inequality(before));
        take(least, &what, &rounding);
    }
    take(folds(orbit, step), &|| Close::Fold, &|_| locate::FOLD_SLOPE);
    for (least, error) in at_the_circle(orbit, step, located) {
        take(least, &|| Close::Circle, &|_| error);
    }
    if pair.is_finite() {
        return Within::Pair(pair);
    }
    close.map_or(Within::Nothing, |(s, what)| Within::Close(s, what))
}

/// What rounding leaves in a margin at a point within a step.
fn blur<O: Orbit>(orbit: &O, step: &Step<O>, margin: &O::Margin, place: &Place) -> f64 {
    let point = &place.node.point;
    let rounding = rounding_across(orbit, &step.from.tangent, point);
    rounding.map_or(f64::INFINITY, |rounding| {
        of_margin(orbit, margin, &rounding, point)
    })
}

/// What rounding leaves in a margin at a point: what the unknowns are off, and what the margin is formed from.
pub(super) fn of_margin<O: Orbit>(
    orbit: &O,
    margin: &O::Margin,
    rounding: &Rounding,
    point: &Vector,
) -> f64 {
    let mut gradient = Vector::zeros(point.len());
    orbit.add_gradient(margin, gradient.as_mut_slice());
    rounding.of(&gradient) + f64::EPSILON * (1.0 + orbit.reach(margin, &point.abs()))
}

/// What rounding leaves at a point that was found across a tangent.
pub(crate) fn rounding_across<O: Orbit>(
    orbit: &O,
    tangent: &Vector,
    point: &Vector,
) -> Option<Rounding<'static>> {
    let mut plane = Plane {
        normal: tangent,
        through: point,
    };
    let bordered = newton::bordered(orbit, &mut plane, point).ok()?;
    Rounding::new(&bordered.matrix, &point.abs(), None)
}

/// The least slope of the parameter, in its own direction, within a step at whose ends it has one sign.
fn folds<O: Orbit>(orbit: &O, step: &Step<O>) -> LeastWithin {
    let last = step.from.tangent.len() - 1;
    let (t0, t1) = (step.from.tangent[last], step.to.tangent[last]);
    if events::turns(orbit, step) == Some(false) {
        return LeastWithin::Far;
    }
    // the tangent turns little in a step: a component is not lost and found again that is larger
    let turn = (&step.to.tangent - &step.from.tangent).norm();
    if t0 * t1 <= 0.0 || t0.abs().min(t1.abs()) > turn || t0.abs() <= events::VERTICAL {
        return LeastWithin::Far;
    }
    let tolerance = step.steps.tolerance;
    let beside = DIFFERENCE * step.ds;
    // the null vector of the Jacobian beside a node along its tangent is the tangent there but for second order
    let slope = |node: &Node, way: f64| {
        let point = &node.point + &node.tangent * (way * beside);
        let other = locate::retangent(orbit, &point, &node.tangent, 0)?;
        Some(t0.signum() * way * (other.tangent[last] - node.tangent[last]) / beside)
    };
    let Some(d0) = slope(step.from, 1.0) else {
        return LeastWithin::NotFound;
    };
    if d0 >= 0.0 {
        return LeastWithin::Far;
    }
    let Some(d1) = slope(step.to, -1.0) else {
        return LeastWithin::NotFound;
    };
    let ends = [(t0.abs(), d0), (t1.abs(), d1)];
    locate::least(orbit, step.from, step.ds, ends, tolerance, |node| {
        Some((t0.signum() * node.tangent[last], slope(node, 1.0)?))
    })
}

/// A multiplier may come to the unit circle and leave it within a step where the logarithm of its modulus is less than this at one
/// end: elsewhere nothing is looked for.
const NEAR_CIRCLE: f64 = 1e-2;

/// How near a multiplier, or a pair, comes to the unit circle from either side within a step in which nothing is known to happen, and
/// what it is known to there; negative where it is on the other side than at both ends.
fn at_the_circle<O: Orbit>(
    orbit: &O,
    step: &Step<O>,
    located: &[(Place, LocatedEvent<O>)],
) -> Vec<(LeastWithin, f64)> {
    let [before, after] = [step.before, step.after].map(crossings::outside);
    let count = before.filter(|count| after == Some(*count) && located.is_empty());
    let [first, last] = [step.before, step.after].map(Examined::growths);
    let Some(((count, first), last)) = count.zip(first).zip(last) else {
        return Vec::new();
    };
    // the least that is outside, and the largest that is inside
    let ranks = count.checked_sub(1).into_iter().chain([count]);
    let least = |rank: usize| {
        let (g0, g1) = (first.get(rank)?.log, last.get(rank)?.log);
        if g0.abs().min(g1.abs()) > NEAR_CIRCLE {
            return None;
        }
        let side = g0.signum();
        let growth = |point: &Vector| {
            let growths = orbit.examination(point).ok()?.growths()?;
            growths.get(rank).map(|one| (side * one.log, one.error))
        };
        let slope = |node: &Node, known: f64, beside: f64| {
            let (value, _) = growth(&(&node.point + &node.tangent * beside))?;
            Some((value - known) / beside)
        };
        let beside = DIFFERENCE * step.ds;
        let d0 = slope(step.from, side * g0, beside).filter(|d0| *d0 < 0.0)?;
        let d1 = slope(step.to, side * g1, -beside)?;
        let ends = [(side * g0, d0), (side * g1, d1)];
        let mut error = f64::INFINITY;
        let mut near = |guess: f64, beside: f64| {
            let (tolerance, within) = (step.steps.tolerance, (step.ds, guess));
            let least = locate::least_from(orbit, step.from, within, ends, tolerance, |node| {
                let (value, known_to) = growth(&node.point)?;
                error = known_to;
                Some((value, slope(node, value, beside)?))
            });
            match least {
                LeastWithin::Found(place, value) => Some((place, value)),
                _ => None,
            }
        };
        // where two multipliers pass one another the one of a rank has a kink, which a difference smears
        let ((place, value), smeared) = match locate::kink(step.ds, ends) {
            Some(guess) => {
                let (place, _) = near(guess, beside)?;
                let beside = SHARP * step.ds;
                (near(place.s, beside)?, d1.max(-d0) * beside)
            }
            None => (near(locate::dip(step.ds, ends)?, beside)?, 0.0),
        };
        Some((LeastWithin::Found(place, value), error + smeared))
    };
    ranks.filter_map(least).collect()
}
