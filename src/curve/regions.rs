//! What lies beside a curve of events: names for places in the plane of its parameters.
//!
//! A name is what a computation finds at its place. From a point of the curve one parameter is let go
//! while the other stays: that is a branch through the event, and its arms are followed across the
//! range, through folds and changes of regime. A place on that line is named after the passages of the
//! branch through it:
//!
//! | event | name |
//! |---|---|
//! | GR, RV, CO, ST | the regimes of the waves that pass |
//! | LP | how many waves pass, and their regimes |
//! | HB | whether the pair of the event grows or decays there; no other event lies between |
//!
//! A number of waves is known where both arms come to an edge of the range, to the Hopf point of steady
//! sliding, or back to the event. For that the range is widened: waves may return from beyond it. Where
//! nothing is known, or nothing found, there is no name.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Complex;

use super::follow::{INTO, Solved};
use super::plane::Condition;
use super::point::{Limits, Name, PointType, Region};
use super::system::EventSystem;
use super::tube::{Hopf, Tube};
use crate::branch::orbit::{Follower, Found};
use crate::continuation::Node;
use crate::continuation::arclength::advance;
use crate::continuation::locate::retangent;
use crate::continuation::walk;
use crate::linalg::Vector;
use crate::orbit::EventType::{EP, LP, RV, ST, UZ};
use crate::orbit::Orbit as _;
use crate::orbit::change::beyond;
use crate::orbit::follow;
use crate::orbit::sign::Verdict;
use crate::tube::model::signature::{Regimes, Signature};
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::track;
use crate::tube::wave::Wave;

/// Part of the whole length that a stretch needs for its regions to be named.
const NAMED: f64 = 0.12;
/// Where along a stretch places are looked for, as parts of its length: the middle first.
const ALONG: [f64; 7] = [0.5, 0.2, 0.8, 0.35, 0.65, 0.1, 0.9];
/// Distances of places from the curve, as parts of a range. A picture takes the nearest with room.
const AWAY: [f64; 10] = [
    0.04, 0.055, 0.07, 0.085, 0.1, 0.125, 0.15, 0.175, 0.2, 0.225,
];
/// How far below its range a parameter goes that must be positive, as a part of its lower end.
const TOWARDS_ZERO: f64 = 0.05;
/// Least sine of the angle between the curve and the way to a place.
const ACROSS: f64 = 0.35;
/// Most steps of an arm, and most zones of its waves. Arms that take more are those of slow waves which
/// chatter; nothing near the curve is missed with them.
const MOST_STEPS: usize = 1200;
const MOST_ZONES: usize = 10;
/// The shortest step of an arm: shorter ones are those of an arm about to fail.
const SHORTEST: f64 = 1e-6;
/// Most steps of all arms together: about as long as the curve itself took, or a second.
const ALL_STEPS: usize = 20_000;
/// Longest step while a pair is followed, in units of the range: its eigenvalue moves little.
const SHORT: f64 = 0.01;
/// Largest way of the eigenvalue from one point to the next, in units of the frequency of the wave. A
/// longer one may have gone to another pair.
const LARGEST_MOVE: f64 = 0.05;

/// Names beside a curve. Of every stretch and side, the places to prefer come first: those in the region
/// next to the curve, and the nearest of them. Beside a fold only those are named, if there are any.
pub(super) fn regions(points: &[Solved], limits: &Limits) -> Vec<Region> {
    let stretches = stretches(points);
    let mut found = Vec::new();
    let mut budget = ALL_STEPS;
    // the middles of all stretches first
    for order in 0..ALONG.len() {
        for (stretch, places) in stretches.iter().enumerate() {
            let Some(index) = places.get(order) else {
                continue;
            };
            for axis in [0, 1] {
                for (rank, region) in beside(points, *index, axis, stretch, limits, &mut budget) {
                    found.push((stretch, rank, order, region));
                }
            }
        }
    }
    found.sort_by_key(|(stretch, rank, order, _)| (*stretch, *rank, *order));
    let fold = |first: &Solved| first.system.condition == Condition::Fold;
    if points.first().is_some_and(fold) {
        let next: BTreeSet<(usize, bool)> = found
            .iter()
            .filter(|(_, (beyond, _), _, _)| !beyond)
            .map(|(stretch, _, _, region)| (*stretch, region.left))
            .collect();
        found.retain(|(stretch, (beyond, _), _, region)| {
            !beyond || !next.contains(&(*stretch, region.left))
        });
    }
    found.into_iter().map(|(_, _, _, region)| region).collect()
}

/// A point of the curve in units of the ranges.
fn scaled(solved: &Solved) -> [f64; 2] {
    let widths = solved.system.widths();
    [0, 1].map(|index| solved.point.parameters[index] / widths[index])
}

/// For every stretch with the same waves, broken at folds and cusps, the points beside which places
/// are looked for.
fn stretches(points: &[Solved]) -> Vec<Vec<usize>> {
    // way from the first point to each
    let mut way = vec![0.0];
    for pair in points.windows(2) {
        let (one, other) = (scaled(&pair[0]), scaled(&pair[1]));
        let so_far = way.last().copied().unwrap_or(0.0);
        way.push(so_far + (one[0] - other[0]).hypot(one[1] - other[1]));
    }
    let whole = way.last().copied().unwrap_or(0.0);
    let mut found = Vec::new();
    let mut from = 0;
    while from < points.len() {
        let turns = |index: &usize| {
            let kind = points[*index].point.kind;
            matches!(kind, Some(PointType::CP | PointType::Two(_, LP)))
        };
        let regimes = |index: usize| points[index].system.signature().regimes();
        let same = |index: &usize| regimes(*index) == regimes(from);
        let to = (from..points.len())
            .take_while(|index| same(index) && !(*index > from && turns(&(index - 1))))
            .last()
            .unwrap_or(from);
        // the ends of a stretch belong to two events at once
        if to > from + 2 && way[to] - way[from] >= NAMED * whole {
            let mut places: Vec<usize> = Vec::new();
            for part in ALONG {
                let wanted = way[from] + part * (way[to] - way[from]);
                let place = (from..to)
                    .find(|index| way[*index] >= wanted)
                    .unwrap_or(from);
                let place = place.clamp(from + 1, to - 1);
                if !places.contains(&place) {
                    places.push(place);
                }
            }
            found.push(places);
        }
        from = to + 1;
    }
    found
}

/// Named places on the line through a point of the curve along which one parameter changes. With each
/// whether it lies beyond the region next to the curve, and the number of its distance.
fn beside(
    points: &[Solved],
    index: usize,
    axis: usize,
    stretch: usize,
    limits: &Limits,
    budget: &mut usize,
) -> Vec<((bool, usize), Region)> {
    let Solved {
        point,
        system,
        unknowns,
    } = &points[index];
    let (one, other) = (scaled(&points[index - 1]), scaled(&points[index + 1]));
    let (dx, dy) = (other[0] - one[0], other[1] - one[1]);
    // across the curve: the sine, positive on its left, of the angle to larger values
    let sine = if axis == 0 { -dy } else { dx } / dx.hypot(dy);
    if sine.is_nan() || sine.abs() < ACROSS {
        return Vec::new();
    }
    let (low, high) = limits.ranges[axis];
    let mut targets = Vec::new();
    for (distance, away) in AWAY.iter().enumerate() {
        for sign in [1.0, -1.0] {
            let target = point.parameters[axis] + sign * away * (high - low);
            if target > low && target < high {
                targets.push((distance, (sine > 0.0) == (sign > 0.0), target));
            }
        }
    }
    let values: Vec<f64> = targets.iter().map(|(_, _, target)| *target).collect();
    let Some(section) = Section::through(system, unknowns, axis, &values, limits, budget) else {
        return Vec::new();
    };
    // names next to the curve on its right and its left; the targets come by distance
    let nearest = |side| {
        let number = targets.iter().position(|(_, left, _)| *left == side);
        number.and_then(|number| section.name(number))
    };
    let next = [nearest(false), nearest(true)];
    // where both are the same, one lies beyond another part of the curve, and which is not known
    let mut within = [next[0] != next[1]; 2];
    let named = targets.iter().enumerate().filter_map(|(number, target)| {
        let (distance, left, value) = *target;
        let side = usize::from(left);
        let name = section.name(number);
        within[side] &= next[side] == name;
        let mut place = point.parameters;
        place[axis] = value;
        let region = Region {
            stretch,
            left,
            place,
            name: name?,
        };
        Some(((!within[side], distance), region))
    });
    named.collect()
}

/// The branch through an event along a line, as far as places on the line are concerned.
struct Section {
    condition: Condition<Tube>,
    /// For every place the regimes of the waves that pass, and Re λ of the pair that is followed.
    passages: BTreeMap<usize, Vec<(Regimes, Option<f64>)>>,
    /// Whether the whole of the branch has been seen.
    complete: bool,
}

impl Section {
    /// Follows the arms of the branch. `None` where it does not leave the event.
    fn through(
        system: &EventSystem,
        at: &Vector,
        axis: usize,
        targets: &[f64],
        limits: &Limits,
        budget: &mut usize,
    ) -> Option<Section> {
        let arms = arms(system, at, axis, limits.steps.tolerance);
        if arms.is_empty() {
            return None;
        }
        let mut section = Section {
            condition: system.condition.clone(),
            passages: BTreeMap::new(),
            complete: arms.len() == 2,
        };
        let mut steps = limits.steps;
        steps.ds_min = steps.ds_min.max(SHORTEST);
        let (mut low, mut high) = limits.ranges[axis];
        match &system.condition {
            Condition::Spectral(_) => {
                steps.ds_max = steps.ds_max.min(SHORT);
                steps.ds = steps.ds.min(SHORT);
            }
            // waves may come back from beyond an edge: they count
            Condition::Fold => {
                let parameter = system.parameters()[axis];
                let width = high - low;
                let further = |values: [f64; 2], edge: f64| {
                    let admitted = values.into_iter().find(|value| parameter.admits(*value));
                    admitted.unwrap_or(edge)
                };
                low = further([low - width, TOWARDS_ZERO * low], low);
                high = further([high + width, high], high);
            }
            Condition::Margin(_) => {}
        }
        let range = (low, high);
        for (wave, point, up) in arms {
            let limits = follow::Limits {
                range,
                stop_at: targets.to_vec(),
                steps,
            };
            let mut pair = match &system.condition {
                Condition::Spectral(Hopf { sector }) => Some(Pair {
                    sector: *sector,
                    lambda: Complex::new(0.0, system.angular(at)?),
                    most: LARGEST_MOVE * system.plane.frequency(),
                }),
                _ => None,
            };
            let mut seen = BTreeMap::new();
            let end = match Follower::new(wave, &point, up, limits) {
                Ok(arm) => walk(arm, range, targets, &mut pair, &mut seen, budget),
                Err(_) => End::Lost,
            };
            section.complete &= end != End::Lost;
            if system.condition == Condition::Fold && !section.complete {
                // waves that cannot be counted have no name
                break;
            }
            if end == End::Closed {
                // the other arm is the same loop the other way round
                section.passages = seen;
                section.complete = true;
                break;
            }
            for (target, waves) in seen {
                section.passages.entry(target).or_default().extend(waves);
            }
        }
        Some(section)
    }

    /// The name of a place.
    fn name(&self, target: usize) -> Option<Name> {
        let waves = self.passages.get(&target).map_or(&[][..], Vec::as_slice);
        if let Condition::Spectral(_) = &self.condition {
            let (_, rate) = waves.first()?;
            return Some(Name::Pair {
                grows: (*rate)? > 0.0,
            });
        }
        let mut regimes: Vec<Regimes> = waves.iter().map(|(regimes, _)| regimes.clone()).collect();
        regimes.sort_by_key(Regimes::to_string);
        regimes.dedup();
        let count = match &self.condition {
            Condition::Fold if !self.complete => return None,
            Condition::Fold => Some(waves.len()),
            _ => None,
        };
        (!waves.is_empty()).then_some(Name::Waves { count, regimes })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// At an edge of the range, or where waves end.
    Edge,
    Closed,
    Lost,
}

/// The pair of a Hopf point on its way along a branch.
struct Pair {
    sector: usize,
    lambda: Complex<f64>,
    most: f64,
}

impl Pair {
    /// Follows it to the next wave. `None` where it may have been mistaken for another one.
    fn follow(&mut self, wave: &Wave, point: &Vector) -> Option<f64> {
        let characteristic = Characteristic::new(wave, point).ok()?;
        let z = characteristic.multiplier(self.sector);
        let lambda = track::follow(&characteristic, z, self.lambda)?;
        let near = (lambda - self.lambda).norm() <= self.most;
        self.lambda = lambda;
        near.then_some(lambda.re)
    }
}

/// Follows an arm to its end and notes its passages.
fn walk(
    mut arm: Follower,
    range: (f64, f64),
    targets: &[f64],
    pair: &mut Option<Pair>,
    seen: &mut BTreeMap<usize, Vec<(Regimes, Option<f64>)>>,
    budget: &mut usize,
) -> End {
    if arm.here().examination.verdict != Verdict::Positive {
        return End::Lost;
    }
    let most = MOST_STEPS.min(*budget);
    let (mut steps, mut end) = (0, End::Closed);
    while steps < most {
        let (found, ended) = arm.step();
        steps += 1;
        *budget -= 1;
        // where slip-stick waves lose their stick zone they end, at the Hopf point of steady sliding
        let vanished = found.iter().any(|found| {
            found.kind() == Some(ST) && found.orbit.signature == Signature::slip_stick()
        });
        for found in found {
            let kind = found.kind();
            let Found {
                orbit: wave,
                node,
                parameter,
                ..
            } = found;
            let mut rate = None;
            if let Some(pair) = pair {
                // the spectrum passes the opening of reverse slip, but not every change of regime
                if !matches!(kind, None | Some(UZ | LP | EP | RV)) {
                    return End::Lost;
                }
                rate = pair.follow(&wave, &node.point);
                if rate.is_none() {
                    return End::Lost;
                }
            }
            if kind == Some(EP) && [range.0, range.1].contains(&parameter) {
                end = End::Edge;
            }
            let target = targets.iter().position(|target| *target == parameter);
            if let (Some(UZ), Some(target)) = (kind, target) {
                let passages = seen.entry(target).or_default();
                passages.push((wave.signature.regimes(), rate));
            }
        }
        match ended {
            None if arm.curve().orbit.zones() <= MOST_ZONES => {}
            Some(walk::End::Edge | walk::End::Closed) => return end,
            Some(_) if vanished => return End::Edge,
            _ => return End::Lost,
        }
    }
    End::Lost
}

/// The arms of the branch through an event, a step away from it: wave, point and whether the
/// parameter grows.
fn arms(
    system: &EventSystem,
    point: &Vector,
    axis: usize,
    tolerance: f64,
) -> Vec<(Wave, Vector, bool)> {
    let Ok((wave, own)) = system.orbit(point, axis) else {
        return Vec::new();
    };
    let last = own.len() - 1;
    let mut along = Vector::zeros(last + 1);
    along[last] = 1.0;
    let step = |wave: &Wave, node: &Node, ds: f64| {
        let to = advance(wave, node, ds, tolerance).ok()?.node.point;
        let way = to[to.len() - 1] - node.point[to.len() - 1];
        (way != 0.0).then(|| (wave.clone(), to, way > 0.0))
    };
    let mut found = Vec::with_capacity(2);
    match &system.condition {
        Condition::Margin(margin) => {
            let here = wave.margin_at(margin, &own).unwrap_or(*margin);
            if let Some(mut node) = retangent(&wave, &own, &along, 0) {
                if here.slope(&wave, &node.tangent) < 0.0 {
                    node.tangent.neg_mut();
                }
                found.extend(step(&wave, &node, INTO));
            }
            if let Some(beyond) = beyond(&wave, &own, &here, INTO, tolerance).beyond {
                found.extend(step(&beyond.orbit, &beyond.node, beyond.ds));
            }
        }
        Condition::Fold => {
            let null = point.rows(last, last).clone_owned();
            for sign in [1.0, -1.0] {
                let tangent = &null * sign;
                let node = Node::at(own.clone(), tangent.insert_row(last, 0.0));
                found.extend(step(&wave, &node, INTO));
            }
        }
        Condition::Spectral(_) => {
            for up in [true, false] {
                found.push((wave.clone(), own.clone(), up));
            }
        }
    }
    found
}
