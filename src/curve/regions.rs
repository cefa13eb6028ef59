//! What lies beside a curve of events: names for places in the plane of its parameters.
//!
//! A name is what a computation finds at its place. From a point of the curve one parameter is let go
//! while the other stays: that is a branch through the event, and its arms are followed across the
//! range, through folds and changes of regime. A place on that line is named after the passages of the
//! branch through it:
//!
//! | event | name |
//! |---|---|
//! | GR, RV, CO, ST, SL | the regimes of the orbits that pass, of a system with their stability |
//! | LP | how many orbits pass, and their regimes |
//! | HB | whether the pair of the event grows or decays there; no other event lies between. Of equilibria how many eigenvalues grow, with no fold between |
//! | PD, NS | how many multipliers of the orbit are outside the unit circle, with no fold between |
//!
//! A number of orbits is known where both arms come to an edge of the range, to an end of their own as the Hopf
//! point of steady sliding, or back to the event. For that the range is widened: orbits may return from beyond it.
//! Where nothing is known, or nothing found, there is no name.

use std::collections::{BTreeMap, BTreeSet};

use super::event::{INTO, Solved};
use super::plane::{EventCondition, ParameterPlane};
use super::point::{CurveLimits, PointType, Region, RegionName};
use super::system::EventSystem;
use crate::continuation::Node;
use crate::continuation::Steps;
use crate::continuation::arclength::advance;
use crate::continuation::locate::retangent;
use crate::continuation::newton;
use crate::continuation::walk;
use crate::linalg::Vector;
use crate::orbit::EventType::{EP, LP, UZ};
use crate::orbit::change::nearest_beyond;
use crate::orbit::follow::{self, Follower, LocatedPoint};
use crate::orbit::sign::SignVerdict;
use crate::orbit::special::BranchTermination;
use crate::orbit::{Examined, Inequalities, TerminationType, Zones};

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
/// Most steps of an arm, and most zones of its orbits unless those of the event have more. Arms that take more are
/// those of slow waves which chatter; nothing near the curve is missed with them.
const MOST_STEPS: usize = 1200;
const MOST_ZONES: usize = 10;
/// Evaluations of the equations of an orbit that a step of an arm may take, with an event in it, to count as one.
const PER_STEP: u64 = 64;
/// The shortest step of an arm: shorter ones are those of an arm about to fail.
const SHORTEST: f64 = 1e-6;

/// Names beside a curve. Of every stretch and side, the places to prefer come first: those in the region
/// next to the curve, and the nearest of them. Beside a fold only those are named, if there are any.
pub(super) fn regions<P: ParameterPlane>(
    points: &[Solved<P>],
    limits: &CurveLimits,
) -> Vec<Region> {
    let stretches = stretches(points);
    let mut found = Vec::new();
    let mut budget = P::ALL_STEPS;
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
    let fold = |first: &Solved<P>| first.system.condition == EventCondition::Fold;
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
fn scaled<P: ParameterPlane>(solved: &Solved<P>) -> [f64; 2] {
    let widths = solved.system.widths();
    [0, 1].map(|index| solved.point.parameters[index] / widths[index])
}

/// For every stretch with the same regimes, broken at folds and cusps, the points beside which places
/// are looked for.
fn stretches<P: ParameterPlane>(points: &[Solved<P>]) -> Vec<Vec<usize>> {
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
        let same = |index: &usize| points[*index].point.before == points[from].point.before;
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
fn beside<P: ParameterPlane>(
    points: &[Solved<P>],
    index: usize,
    axis: usize,
    stretch: usize,
    limits: &CurveLimits,
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
    let Some(section) = RegionSection::through(system, unknowns, axis, &values, limits, budget)
    else {
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

/// For every place the regimes of the orbits that pass, and what the spectrum calls the place.
type Passages = BTreeMap<usize, Vec<(String, Option<RegionName>)>>;

/// The branch through an event along a line, as far as places on the line are concerned.
struct RegionSection<P: ParameterPlane> {
    condition: EventCondition<P>,
    passages: Passages,
    /// Whether the whole of the branch has been seen.
    complete: bool,
}

impl<P: ParameterPlane> RegionSection<P> {
    /// Follows the arms of the branch. `None` where it does not leave the event.
    fn through(
        system: &EventSystem<P>,
        at: &Vector,
        axis: usize,
        targets: &[f64],
        limits: &CurveLimits,
        budget: &mut usize,
    ) -> Option<RegionSection<P>> {
        let arms = arms(system, at, axis, limits.steps.tolerance);
        if arms.is_empty() {
            return None;
        }
        let mut section = RegionSection {
            condition: system.condition.clone(),
            passages: BTreeMap::new(),
            complete: arms.len() == 2,
        };
        let (range, steps) = Self::reach(system, axis, limits);
        let zones = MOST_ZONES.max(2 * P::zones(system.signature()));
        for (orbit, point, up) in arms {
            let limits = follow::Limits {
                range,
                stop_at: targets.to_vec(),
                steps,
            };
            let mut beside = match &system.condition {
                EventCondition::Spectral(spectral) => {
                    let angular = system.angular(at);
                    Some(system.plane.beside(spectral, angular)?)
                }
                _ => None,
            };
            let mut seen = Passages::new();
            let end = match Follower::new(orbit, &point, up, limits) {
                Ok(arm) => {
                    let mut walked = Walked {
                        range,
                        targets,
                        zones,
                        beside: &mut beside,
                        seen: &mut seen,
                        budget,
                    };
                    walked.walk::<P>(arm, &system.condition)
                }
                Err(_) => SectionEnd::Lost,
            };
            section.complete &= end != SectionEnd::Lost;
            if system.condition == EventCondition::Fold && !section.complete {
                // orbits that cannot be counted have no name
                break;
            }
            if end == SectionEnd::Closed {
                // the other arm is the same loop the other way round
                section.passages = seen;
                section.complete = true;
                break;
            }
            // what passes an event of the spectrum and comes back may be named otherwise: a place has the name of
            // the arm that leads to it
            if let EventCondition::Spectral(_) = &system.condition {
                let value = system.values(at)[axis];
                seen.retain(|target, _| (targets[*target] > value) == up);
            }
            for (target, orbits) in seen {
                section.passages.entry(target).or_default().extend(orbits);
            }
        }
        Some(section)
    }

    /// How far along the line its arms are followed, and in which steps.
    fn reach(system: &EventSystem<P>, axis: usize, limits: &CurveLimits) -> ((f64, f64), Steps) {
        let mut steps = limits.steps;
        steps.ds_min = steps.ds_min.max(SHORTEST);
        let (mut low, mut high) = limits.ranges[axis];
        match &system.condition {
            EventCondition::Spectral(_) => {
                steps.ds_max = steps.ds_max.min(P::LONGEST_BESIDE);
                steps.ds = steps.ds.min(P::LONGEST_BESIDE);
            }
            // orbits may come back from beyond an edge: they count
            EventCondition::Fold => {
                let width = high - low;
                let further = |values: [f64; 2], edge: f64| {
                    let mut values = values.into_iter();
                    let admitted = values.find(|value| system.plane.admits(axis, *value));
                    admitted.unwrap_or(edge)
                };
                low = further([low - width, TOWARDS_ZERO * low], low);
                high = further([high + width, high], high);
            }
            EventCondition::Margin(_) | EventCondition::Constant(_) => {}
        }
        ((low, high), steps)
    }

    /// The name of a place.
    fn name(&self, target: usize) -> Option<RegionName> {
        let orbits = self.passages.get(&target).map_or(&[][..], Vec::as_slice);
        if let EventCondition::Spectral(_) = &self.condition {
            return orbits.first()?.1.clone();
        }
        let mut regimes: Vec<String> = orbits.iter().map(|(regimes, _)| regimes.clone()).collect();
        regimes.sort();
        regimes.dedup();
        let count = match &self.condition {
            EventCondition::Fold if !self.complete => return None,
            EventCondition::Fold => Some(match orbits.len() {
                1 => (1, P::ORBIT),
                count => (count, P::ORBITS),
            }),
            _ => None,
        };
        (!orbits.is_empty()).then_some(RegionName::Orbits { count, regimes })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SectionEnd {
    /// At an edge of the range, or where waves end.
    Edge,
    Closed,
    Lost,
}

/// What an arm is followed for.
struct Walked<'a, B> {
    range: (f64, f64),
    targets: &'a [f64],
    /// Most zones of its orbits.
    zones: usize,
    /// What is carried along of the spectrum.
    beside: &'a mut Option<B>,
    seen: &'a mut Passages,
    budget: &'a mut usize,
}

impl<B> Walked<'_, B> {
    /// Follows an arm to its end and notes its passages.
    fn walk<P: ParameterPlane<Beside = B>>(
        &mut self,
        mut arm: Follower<P::Orbit>,
        condition: &EventCondition<P>,
    ) -> SectionEnd {
        if arm.here().examination.verdict() != SignVerdict::Positive {
            return SectionEnd::Lost;
        }
        let most = MOST_STEPS.min(*self.budget);
        let (mut steps, mut end) = (0, SectionEnd::Closed);
        while steps < most {
            let before = newton::evaluations();
            let (found, ended) = arm.step();
            // an event from which many orbits are tried takes as long as many steps
            let work = (newton::evaluations() - before) / PER_STEP;
            let cost = 1 + usize::try_from(work).unwrap_or(most);
            steps += cost;
            *self.budget = self.budget.saturating_sub(cost);
            for found in found {
                let kind = found.kind();
                let LocatedPoint {
                    orbit,
                    node,
                    parameter,
                    ..
                } = found;
                let mut name = None;
                if let Some(beside) = self.beside {
                    let Some(known) = P::name_beside(beside, &orbit, &node.point, kind) else {
                        return SectionEnd::Lost;
                    };
                    name = known;
                }
                // beyond a fold the branch is over the same places once more, and elsewhere on its way
                if let (Some(LP), EventCondition::Spectral(_)) = (kind, condition) {
                    return SectionEnd::Lost;
                }
                if kind == Some(EP) && [self.range.0, self.range.1].contains(&parameter) {
                    end = SectionEnd::Edge;
                }
                let mut targets = self.targets.iter();
                let target = targets.position(|target| *target == parameter);
                if let (Some(UZ), Some(target)) = (kind, target) {
                    let regimes = match condition {
                        EventCondition::Margin(_) => P::passing(&orbit, &node.point),
                        _ => P::name(&orbit, &node.point),
                    };
                    self.seen.entry(target).or_default().push((regimes, name));
                }
            }
            let zones = P::zones(arm.curve().orbit.signature());
            match ended {
                None if zones <= self.zones => {}
                Some(walk::End::Edge | walk::End::Closed) => return end,
                Some(walk::End::Own(BranchTermination::Own(stop))) if stop.completes() => {
                    return SectionEnd::Edge;
                }
                _ => return SectionEnd::Lost,
            }
        }
        SectionEnd::Lost
    }
}

/// The arms of the branch through an event, a step away from it: orbit, point and whether the
/// parameter grows.
fn arms<P: ParameterPlane>(
    system: &EventSystem<P>,
    point: &Vector,
    axis: usize,
    tolerance: f64,
) -> Vec<(P::Orbit, Vector, bool)> {
    let Ok((orbit, own)) = system.orbit(point, axis) else {
        return Vec::new();
    };
    let last = own.len() - 1;
    let mut along = Vector::zeros(last + 1);
    along[last] = 1.0;
    let step = |orbit: &P::Orbit, node: &Node, ds: f64| {
        let to = advance(orbit, node, &[], ds, tolerance).ok()?.node.point;
        let way = to[to.len() - 1] - node.point[to.len() - 1];
        (way != 0.0).then(|| (orbit.clone(), to, way > 0.0))
    };
    let mut found = Vec::with_capacity(2);
    match &system.condition {
        EventCondition::Margin(margin) => {
            let here = orbit
                .margin_at(margin, &own)
                .unwrap_or_else(|_| margin.clone());
            if let Some(mut node) = retangent(&orbit, &own, &along, 0) {
                if orbit.slope(&here, &node.tangent) < 0.0 {
                    node.tangent.neg_mut();
                }
                found.extend(step(&orbit, &node, INTO));
            }
            if let Some(beyond) = nearest_beyond(&orbit, &own, &here, INTO, tolerance) {
                found.extend(step(&beyond.orbit, &beyond.node, beyond.ds));
            }
        }
        EventCondition::Fold => {
            let null = point.rows(last, last).clone_owned();
            for sign in [1.0, -1.0] {
                let tangent = &null * sign;
                let node = Node::at(own.clone(), tangent.insert_row(last, 0.0));
                found.extend(step(&orbit, &node, INTO));
            }
        }
        // on both sides there are the same orbits
        EventCondition::Constant(_) => {}
        EventCondition::Spectral(_) => {
            for up in [true, false] {
                found.push((orbit.clone(), own.clone(), up));
            }
        }
    }
    found
}
