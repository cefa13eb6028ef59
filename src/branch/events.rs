//! What happens within a step of a branch: where it is, and how well that is known.

use super::special::{Close, Refusal};
use crate::continuation::arclength::{self, Node};
use crate::continuation::locate::{self, Least, Place, Target};
use crate::continuation::newton::{self, Constraint, Plane, System};
use crate::continuation::walk::{Segment, Within};
use crate::flow::sign::Verdict;
use crate::linalg::Vector;
use crate::model::signature::Entry;
use crate::wave::Wave;
use crate::wave::admissibility::{AtZero, Examination, Margin};

/// What is located within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A fold in the parameter.
    Fold,
    /// A value that was asked for.
    User(f64),
    /// An edge of the range.
    Edge(f64),
    Change(Margin),
}

/// An event and the error of the parameter there, in physical units.
#[derive(Clone, Copy, Debug)]
pub struct Located {
    pub event: Event,
    pub uncertainty: f64,
}

/// A scaled margin below this is zero but for rounding.
pub(crate) const AT_ZERO: f64 = 1e-9;

/// A tangent whose parameter component is below this does not tell a direction.
const VERTICAL: f64 = 1e-7;

/// Parts of a step after which the direction of the parameter is looked for.
const NEAR: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// Slope of the parameter along the arc at which a fold counts as found. The parameter is
/// quadratic there, so its error is of order 1e-26; speed and zone lengths are linear, with an
/// error near 1e-13.
const FOLD_SLOPE: f64 = 1e-13;

/// Part of a step over which the slope of a tangent is taken as a difference.
const DIFFERENCE: f64 = 1e-4;

/// An event known less well than this, relative to the parameter or its range, is not reported;
/// rounding at the stiff end leaves 1e-9. With a coarse tolerance: than this many tolerances.
const UNCERTAIN: f64 = 1e-6;
const MOST_UNCERTAIN: f64 = 1e4;

type Step<'a> = Segment<'a, Examination>;

/// A margin below this at a point is zero but for rounding.
pub(super) fn rounding(place: &Place, margin: &Margin) -> f64 {
    let slopes: f64 = margin.jet.by.iter().map(|by| by.abs()).sum();
    AT_ZERO + 8.0 * place.blur * slopes
}

/// Whether the tangent at a node does not tell the direction of the parameter: beyond the opening of a
/// separation zone the branch starts with none, but for rounding, which thin layers magnify.
pub(super) fn is_vertical(wave: &Wave, node: &Node) -> bool {
    let opens = |zone: usize| {
        wave.signature.zone(zone).entry == Entry::TakeOff
            && wave.duration_at(&node.point, zone) == 0.0
    };
    node.tangent[node.tangent.len() - 1].abs() <= VERTICAL || (0..wave.zones()).any(opens)
}

/// Whether D = 0 but for rounding.
pub(super) fn is_undriven(wave: &Wave, point: &Vector) -> bool {
    let coupling = wave.flows(point).map(|flows| flows.frame.at.kappa);
    coupling.is_ok_and(|kappa| kappa.abs() < AT_ZERO * wave.scales.pressure)
}

/// Whether a margin that is positive at both ends of a step may have been negative between them:
/// the cubic that shares values and slopes at the ends dips below zero.
pub(super) fn may_hide_a_pair(wave: &Wave, step: &Step) -> bool {
    step.before.margins.iter().any(|before| {
        let Some(after) = step.after.find(before.watch, before.zone) else {
            return false;
        };
        let (m0, m1) = (before.jet.value, after.jet.value);
        // margins at zero belong to the event the step starts from
        if m0 <= AT_ZERO || m1 <= 0.0 {
            return false;
        }
        let d0 = step.ds * before.slope(wave, &step.from.tangent);
        let d1 = step.ds * after.slope(wave, &step.to.tangent);
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

/// A margin below this is zero where a step starts from an event; between two zeros of one that lie close
/// together margins are as small as 1e-12.
const VANISHED: f64 = 1e-13;

/// A margin is level at the end of a step where its slope would take this part of its first value away.
const LEVEL: f64 = 1e-3;

/// A least value is negative, and two zeros lie beside it, where it is below this many times its rounding:
/// their places are then known to half a per cent of their distance.
const BELOW_ROUNDING: f64 = 100.0;

/// Whether something that is positive at both ends of a step vanishes between them: a margin, or the slope
/// of the parameter. `located` is what is known to happen.
pub(super) fn within(wave: &Wave, step: &Step, located: &[(Place, Located)]) -> Within<Close> {
    let tolerance = step.steps.tolerance;
    let ends = |event: &Event| matches!(event, Event::Change(_) | Event::Edge(_));
    let mut ends = located.iter().filter(|(_, located)| ends(&located.event));
    // what is even in the duration of a zone that closes vanishes with it, and is no pair
    let end = ends.next().map(|(place, _)| place.s - step.at_once());
    let end = end.unwrap_or(f64::INFINITY);
    let mut close: Option<(f64, Close)> = None;
    let mut pair = f64::INFINITY;
    let mut take = |least: Least, what: Close, rounding: &dyn Fn(&Place) -> f64| match least {
        Least::Found(place, value) if place.s < end => {
            let rounding = rounding(&place);
            if value < -BELOW_ROUNDING * rounding {
                pair = pair.min(place.s);
            } else if value <= rounding {
                close.get_or_insert((place.s, what));
            }
        }
        Least::NotFound if step.ds < end => {
            close.get_or_insert((step.ds, what));
        }
        _ => {}
    };
    for before in &step.before.margins {
        let Some(after) = step.after.find(before.watch, before.zone) else {
            continue;
        };
        // margins at zero belong to the event the step starts from
        if before.jet.value <= VANISHED || after.jet.value <= 0.0 {
            continue;
        }
        let ends = [(before, step.from), (after, step.to)]
            .map(|(margin, node)| (margin.jet.value, margin.slope(wave, &node.tangent)));
        let mut at = AtZero { margin: *before };
        let least = locate::least(wave, step.from, step.ds, ends, tolerance, |node| {
            let margin = at.margin_at(wave, &node.point).ok()?;
            Some((margin.jet.value, margin.slope(wave, &node.tangent)))
        });
        let rounding = |place: &Place| blur(wave, step, &at.margin, place);
        take(least, Close::margin(wave, before), &rounding);
    }
    take(folds(wave, step), Close::Fold, &|_| FOLD_SLOPE);
    if pair.is_finite() {
        return Within::Pair(pair);
    }
    close.map_or(Within::Nothing, |(s, what)| Within::Close(s, what))
}

/// What rounding leaves in a margin at a point within a step.
fn blur(wave: &Wave, step: &Step, margin: &Margin, place: &Place) -> f64 {
    let point = &place.node.point;
    let mut plane = Plane {
        normal: &step.from.tangent,
        through: point,
    };
    let matrix = newton::bordered(wave, &mut plane, point).map(|bordered| bordered.matrix);
    let unknowns = matrix
        .ok()
        .and_then(|matrix| newton::rounding(&matrix, &point.abs(), None));
    unknowns.map_or(f64::INFINITY, |unknowns| {
        let of = |zone: usize, by: &[f64]| -> f64 {
            let columns = wave.columns(zone);
            columns
                .zip(by)
                .map(|(column, by)| by.abs() * unknowns[column])
                .sum()
        };
        of(margin.zone, &margin.jet.by) + of(margin.zone + 1, &margin.beyond.by) + f64::EPSILON
    })
}

/// The least slope of the parameter, in its own direction, within a step at whose ends it has one sign.
fn folds(wave: &Wave, step: &Step) -> Least {
    let last = step.from.tangent.len() - 1;
    let (t0, t1) = (step.from.tangent[last], step.to.tangent[last]);
    // the tangent turns little in a step: a component is not lost and found again that is larger
    let turn = (&step.to.tangent - &step.from.tangent).norm();
    if t0 * t1 <= 0.0 || t0.abs().min(t1.abs()) > turn || t0.abs() <= VERTICAL {
        return Least::Far;
    }
    let tolerance = step.steps.tolerance;
    let beside = DIFFERENCE * step.ds;
    let slope = |node: &Node, way: f64| {
        let other = locate::node_at(wave, node, way * beside, tolerance)?;
        Some(t0.signum() * way * (other.tangent[last] - node.tangent[last]) / beside)
    };
    let (Some(d0), Some(d1)) = (slope(step.from, 1.0), slope(step.to, -1.0)) else {
        return Least::NotFound;
    };
    let ends = [(t0.abs(), d0), (t1.abs(), d1)];
    locate::least(wave, step.from, step.ds, ends, tolerance, |node| {
        Some((t0.signum() * node.tangent[last], slope(node, 1.0)?))
    })
}

/// All that happens within a step: also where an edge of `range` and the ordered values of `stop_at` are met.
pub(super) fn located(
    wave: &Wave,
    range: (f64, f64),
    stop_at: &[f64],
    step: &Step,
) -> Result<Vec<(Place, Located)>, Refusal> {
    let fold = fold(wave, step).ok_or(Refusal::NotFound)?;
    let targets = targets(wave, range, stop_at, step, fold.as_ref()).ok_or(Refusal::NotFound)?;
    let changes = changes(wave, step)?;
    // where a zone closes the parameter is stationary along the arc: that is the event itself
    let apart = |fold: &(Place, Located)| {
        let mut places = changes.iter().map(|(place, _)| place.s);
        places.all(|s| (s - fold.0.s).abs() > step.at_once())
            && (changes.is_empty() || !wave.thinner_than_a_layer(&fold.0.node.point))
    };
    let fold = fold.filter(apart);
    for (place, Located { uncertainty, .. }) in fold.iter().chain(&changes) {
        let value = wave.parameter_at(&place.node.point);
        let unit = wave.scales.parameter.abs().max(value.abs());
        let most = UNCERTAIN.max(MOST_UNCERTAIN * step.steps.tolerance) * unit;
        if uncertainty.is_nan() || *uncertainty > most {
            return Err(Refusal::Uncertain {
                parameter: wave.parameter,
                value,
                error: *uncertainty,
            });
        }
    }
    Ok(fold.into_iter().chain(targets).chain(changes).collect())
}

/// The fold inside a step at whose ends the parameter moves in opposite directions: a zero of the last
/// component of the tangent. `None` if it is not found.
#[allow(clippy::option_option)] // found or not, there or not
fn fold(wave: &Wave, step: &Step) -> Option<Option<(Place, Located)>> {
    let tolerance = step.steps.tolerance;
    let last = step.from.tangent.len() - 1;
    let (mut low, high) = (
        (0.0, step.from.tangent[last]),
        (step.ds, step.to.tangent[last]),
    );
    if is_vertical(wave, step.from) {
        // where a zone opens the parameter is stationary: a short way on it tells its direction. A layer
        // may turn the branch on a shorter one
        low = NEAR.into_iter().find_map(|part| {
            let near = part * step.ds;
            let step = arclength::advance(wave, step.from, near, tolerance).ok()?;
            Some((near, step.node.tangent[last]))
        })?;
    }
    if low.1 * high.1 >= 0.0 {
        return Some(None);
    }
    let slope_at = |node: &Node| Some(node.tangent[last]);
    let small = (FOLD_SLOPE, 4.0 * f64::EPSILON * step.ds);
    let (place, slope) =
        locate::zero_along(wave, step.from, (low, high), small, tolerance, slope_at)?;
    let mut plane = Plane {
        normal: &step.from.tangent,
        through: &place.node.point,
    };
    let bordered = newton::bordered(wave, &mut plane, &place.node.point).ok()?;
    let rounding = wave.rounding(&bordered.matrix, &place.node.point, 0.0)?;
    // the parameter is off by ½·slope²/curvature, the curvature being the mean one of the step
    let curvature = (high.1 - low.1).abs() / (high.0 - low.0);
    let uncertainty = rounding + 0.5 * slope.abs() * slope.abs() / curvature;
    let located = Located {
        event: Event::Fold,
        uncertainty: uncertainty * wave.scales.parameter,
    };
    Some(Some((place, located)))
}

/// User points and edges of the range within a step; `None` if one is not found.
fn targets(
    wave: &Wave,
    (lower, upper): (f64, f64),
    stop_at: &[f64],
    step: &Step,
    fold: Option<&(Place, Located)>,
) -> Option<Vec<(Place, Located)>> {
    // on the pieces between these the parameter is monotone
    let fold = fold.map(|(place, _)| &place.node);
    let ends = std::iter::once(step.from).chain(fold).chain([step.to]);
    let ends: Vec<&Vector> = ends.map(|node| &node.point).collect();
    // of many user points those between the least and the largest value of the step
    let values = ends.iter().map(|point| wave.parameter_at(point));
    let (least, largest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let slack = 8.0 * f64::EPSILON * least.abs().max(largest.abs());
    let first = stop_at.partition_point(|value| *value < least - slack);
    let user = stop_at[first..]
        .iter()
        .take_while(|value| **value <= largest + slack);
    let wanted = user.map(|&value| (value, 0.0, Event::User(value))).chain([
        (lower, -1.0, Event::Edge(lower)),
        (upper, 1.0, Event::Edge(upper)),
    ]);
    let mut located = Vec::new();
    for (value, outside, event) in wanted {
        let target = Target {
            index: wave.unknowns() - 1,
            value: value / wave.scales.parameter,
            outside,
        };
        let places = target.meetings(wave, step.from, &ends, step.steps.tolerance)?;
        let located_there = Located {
            event,
            uncertainty: f64::EPSILON * value.abs(),
        };
        located.extend(places.into_iter().map(|place| (place, located_there)));
    }
    Some(located)
}

/// Margins that vanish within a step.
fn changes(wave: &Wave, step: &Step) -> Result<Vec<(Place, Located)>, Refusal> {
    if step.after.verdict == Verdict::Positive {
        return Ok(Vec::new());
    }
    let negative = || {
        let margins = step.after.margins.iter();
        margins.filter(|margin| margin.jet.value <= 0.0)
    };
    let count = negative().count();
    if count == 0 {
        let reason = super::special::Inadmissible::of(wave, step.after);
        return Err(Refusal::Inadmissible(reason));
    }
    let mut located: Vec<_> = negative()
        .filter_map(|margin| change(wave, step, margin))
        .collect();
    if located.is_empty() {
        // beside the least value between two zeros Newton's method leaves the step, a bracket does not
        located = negative()
            .filter_map(|margin| bracketed(wave, step, margin))
            .collect();
    }
    if located.is_empty() {
        return Err(Refusal::NotLocated(count));
    }
    Ok(located)
}

/// The zero of a margin that is negative at the end of a step.
fn change(wave: &Wave, step: &Step, margin: &Margin) -> Option<(Place, Located)> {
    let (start, end) = (&step.from.point, &step.to.point);
    let before = step.before.find(margin.watch, margin.zone);
    let guess = before
        .map(|before| before.jet.value)
        .filter(|m0| *m0 > 0.0)
        .map(|m0| start + (end - start) * (m0 / (m0 - margin.jet.value)));
    let mut guesses = guess.into_iter().chain([end.clone()]);
    guesses.find_map(|guess| zero_near(wave, step, margin, &guess))
}

/// The same in a bracket, of a margin that is positive at the beginning of the step and level at its end.
fn bracketed(wave: &Wave, step: &Step, margin: &Margin) -> Option<(Place, Located)> {
    let before = step.before.find(margin.watch, margin.zone)?.jet.value;
    let slope = margin.slope(wave, &step.to.tangent);
    if before <= 0.0 || (slope * step.ds).abs() > LEVEL * before {
        return None;
    }
    let mut at = AtZero { margin: *margin };
    let ends = ((0.0, before), (step.ds, margin.jet.value));
    let small = (0.0, 4.0 * f64::EPSILON * step.ds);
    let value = |node: &Node| Some(at.margin_at(wave, &node.point).ok()?.jet.value);
    let tolerance = step.steps.tolerance;
    let (place, _) = locate::zero_along(wave, step.from, ends, small, tolerance, value)?;
    zero_near(wave, step, margin, &place.node.point)
}

/// The zero of a margin within a step to which Newton's method leads from a guess.
fn zero_near(
    wave: &Wave,
    step: &Step,
    margin: &Margin,
    guess: &Vector,
) -> Option<(Place, Located)> {
    let mut constraint = AtZero { margin: *margin };
    let place = locate::solve(
        wave,
        step.from,
        guess,
        &mut constraint,
        step.steps.tolerance,
    )?;
    // a little outside is rounding of an event at the very end of the step
    if place.s < -1e-9 * step.ds || place.s > step.ds * (1.0 + 1e-9) {
        return None;
    }
    let uncertainty = uncertainty(wave, &mut constraint, &place);
    let margin = constraint.margin_at(wave, &place.node.point).ok()?;
    let located = Located {
        event: Event::Change(margin),
        uncertainty,
    };
    Some((place, located))
}

/// Error of the parameter at a point that a constraint fixes: rounding, and the last correction.
fn uncertainty(wave: &Wave, constraint: &mut impl Constraint<Wave>, place: &Place) -> f64 {
    let point = &place.node.point;
    newton::bordered(wave, constraint, point)
        .ok()
        .and_then(|bordered| newton::rounding(&bordered.matrix, &point.abs(), None))
        .map_or(f64::NAN, |rounding| {
            (rounding[rounding.len() - 1] + place.blur) * wave.scales.parameter
        })
}

/// Whether no margin has failed at a place, but for rounding.
pub(super) fn holds(place: &Place, examination: &Examination) -> bool {
    let mut margins = examination.margins.iter();
    margins.all(|margin| margin.jet.value >= -rounding(place, margin))
}
