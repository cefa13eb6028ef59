//! Why a branch of orbits ends that goes no further.

use super::candidates::candidates;
use super::examine::Examination;
use super::layout::AffineOrbit;
use super::margin::Margin;
use super::passage::Passage;
use super::setting::Scales;
use super::signature::Zone;
use super::stay::{FAR, apart};
use super::termination::OrbitTermination;
use super::{CLOSING, Critical, Watch};
use crate::affine::mode::Row;
use crate::continuation::Node;
use crate::continuation::locate::node_at;
use crate::continuation::unbounded;
use crate::continuation::walk::Segment;
use crate::linalg::Vector;
use crate::orbit::{
    Changes as _, CoordinateChanges as _, EndWithin, Inequalities as _, Limit, Situation,
    Terminations, Zones, rounding_at,
};

/// The parameter is stationary, to rounding, where it changes by less than this along a unit tangent; if nothing but
/// durations changes there, by this part at least, they grow without bound.
const STATIONARY: f64 = 1e-11;
/// The same where no step succeeds any more: a long stay beside a saddle has taken the digits.
const NEARLY_STATIONARY: f64 = 1e-5;
/// The same where it may come to a saddle-node of equilibria, which is looked for from there on.
const SLOWLY: f64 = 1e-2;
const GROWING: f64 = 0.9;

/// An orbit whose parameter still changes by more than this part of its unit in a turn beside a saddle need not come to a
/// connection: it may only pass the saddle, at any parameter, along what stays invariant.
const NEARLY_THERE: f64 = 2e-3;

/// States of an orbit that comes to rest vary by less than this part of their units; by the second where no step
/// succeeds any more.
const AT_REST: f64 = 1e-8;
const NEARLY_AT_REST: f64 = 1e-4;

/// An orbit that begins as near as this to an equilibrium, in units of its states, has half of all digits of the distance.
const AT_EQUILIBRIUM: f64 = 1e-8;

/// Where no step succeeds any more an orbit of this size, in units of its states, is one that shrinks to a point.
pub(super) const NEARLY_A_POINT: f64 = 1e-6;

/// Growth in the longest zone, as a power of e, that has taken half of all digits.
const DIGITS: f64 = 18.0;

/// Where an orbit that switches has no size.
pub(super) struct Vanishing {
    /// The parameter there, and its error.
    pub parameter: f64,
    pub error: f64,
    /// Whether the switches make no difference there: it is a Hopf point.
    is_hopf: bool,
}

impl Vanishing {
    /// What is said of it.
    pub(super) fn outcome(&self) -> (Critical, OrbitTermination) {
        vanishes(self.is_hopf)
    }
}

/// What is said of an orbit without size, at a Hopf point or elsewhere.
pub(super) fn vanishes(is_hopf: bool) -> (Critical, OrbitTermination) {
    match is_hopf {
        true => (Critical::Shrinking, OrbitTermination::Shrinks),
        false => (Critical::Vanishing, OrbitTermination::Vanishes),
    }
}

impl AffineOrbit {
    /// Whether durations grow and the parameter changes by less than a part along the branch, or than rounding, which
    /// a stay beside a saddle magnifies as it does any perturbation: beyond that points are chance.
    fn lengthens(&self, node: &Node, stationary: f64) -> Option<OrbitTermination> {
        let tangent = &self.tangent_of_zones(node);
        let along = tangent[tangent.len() - 1].abs();
        let growth: f64 = (0..self.zones())
            .map(|zone| tangent[self.duration_index(zone)])
            .sum();
        let free = self.has_own_period() && !self.opens(&node.point);
        if !free || growth <= GROWING {
            return None;
        }
        // the period grows like the inverse root of what is left beside a saddle-node: hundreds of times before that is rounding
        let saddle_node = || self.comes_to_a_saddle_node(node);
        if let Some(stop) = (along < SLOWLY).then(saddle_node).flatten() {
            return Some(stop);
        }
        if along >= NEARLY_STATIONARY {
            return None;
        }
        let Some(stay) = self.longest_stay(&node.point) else {
            return self.comes_to_a_boundary(node).or_else(|| {
                let is_unbounded = along < stationary && self.nearly_rests(&node.point);
                is_unbounded.then_some(OrbitTermination::Unbounded)
            });
        };
        // of a unit of the branch, of which a step is a small part; growth counts over one shot
        let growth = stay.growth / self.shots(stay.zone) as f64;
        let noise = 16.0 * f64::EPSILON * growth.exp();
        let lost = || along < noise && self.left_beside_a_saddle(node) < noise;
        (along < stationary || lost()).then(|| self.comes_to(stay, node))
    }

    /// Whether a zone of an orbit without forcing begins within this many units of the states of an equilibrium from which
    /// everything goes away.
    fn stalls(&self, point: &Vector, most: f64) -> Option<OrbitTermination> {
        /// What the orbit has gone by when the zone ends, at least.
        const FAR: f64 = 1e-2;
        if self.is_forced() {
            return None;
        }
        let at = self.at(point).ok()?;
        let Scales { states, time, .. } = &self.setting.scales;
        let units = || states.iter().enumerate();
        let stalls = |zone: &usize| {
            // the speed there costs little
            let Zone { mode, .. } = self.sequence.zone(*zone);
            let own = &at.zones[*zone].state;
            let rate = |state: usize| {
                let jet = at.at_entry(*zone, &Row::unit(at.posed.system.size(), state), 1);
                jet.value.abs() * time
            };
            if units().any(|(state, unit)| rate(state) > 100.0 * most * unit) {
                return false;
            }
            let near = at.posed.system.equilibrium_near(*mode, own);
            let Some(near) =
                near.filter(|near| near.eigenvalues.iter().all(|value| value.re > 0.0))
            else {
                return false;
            };
            let off = |state: usize| (near.state[state] - own[state]).abs();
            let end = at.passage(*zone, at.zones[*zone].duration);
            let end = end.map(|passage| passage.end);
            units().all(|(state, unit)| off(state) <= most * unit)
                && end.is_ok_and(|end| {
                    units().any(|(state, unit)| (end[state] - own[state]).abs() >= FAR * unit)
                })
        };
        let zone = (0..self.zones()).find(stalls)?;
        let mode = self.sequence.zone(zone).name.clone();
        Some(OrbitTermination::Stalls { mode })
    }

    /// Whether a zone vanishes at a point since the one before it, of another mode than the one after, only just comes to
    /// its guard: its speed there vanishes with the zone.
    pub(super) fn barely_reaches(&self, point: &Vector, zone: usize) -> Option<OrbitTermination> {
        let count = self.zones();
        let before = (zone + count - 1) % count;
        if count < 3 || self.sequence.zone(before).mode == self.sequence.zone(zone + 1).mode {
            return None;
        }
        let at = self.at(point).ok()?;
        let speed = at.edge(Watch::Speed, before, &at.shots_of(before).ok()?)?;
        (speed.value.abs() <= CLOSING).then(|| OrbitTermination::Misses {
            held: self.inequality(&speed),
        })
    }

    /// Whether states grow and the parameter comes to a limit.
    fn grows(&self, node: &Node) -> Option<OrbitTermination> {
        let tangent = self.tangent_of_zones(node);
        let grows = unbounded::grows(&node.point, &tangent, self.stretch(&node.point));
        grows.then_some(OrbitTermination::Grows)
    }

    /// Whether the zones of all modes but one shrink, and every state of the orbit varies by less than this part of its
    /// unit.
    fn rests(&self, node: &Node, most: f64) -> Option<OrbitTermination> {
        /// Those zones last less than this part of their units.
        const SHORT: f64 = 1e-2;
        let Node { point, tangent, .. } = node;
        let duration = |zone: &usize| point[self.duration_index(*zone)];
        let shrinks =
            |zone: &usize| duration(zone) < SHORT && tangent[self.duration_index(*zone)] < 0.0;
        let (moving, resting): (Vec<usize>, Vec<usize>) = (0..self.zones()).partition(shrinks);
        if moving.is_empty() || resting.is_empty() {
            return None;
        }
        let at = self.at(point).ok()?;
        let longest = self.sequence.zone(self.longest(point)?).mode;
        // nothing moves in modes whose rates are all zero
        let rests = |mode: usize| {
            let rates = &at.posed.system.modes[mode].matrix.at;
            mode == longest || rates.rows(0, self.states()).iter().all(|rate| *rate == 0.0)
        };
        let mut modes: Vec<String> = Vec::new();
        for zone in resting {
            let Zone { mode, name, .. } = self.sequence.zone(zone);
            if !rests(*mode) {
                return None;
            }
            if !modes.contains(name) {
                modes.push(name.clone());
            }
        }
        self.varies_within(point, most)
            .then_some(OrbitTermination::Rests { modes })
    }

    /// Whether some states, not all, vary by next to nothing and ever less.
    ///
    /// Their ranges r fall like a power of what is left of the branch, ε: r = Cεᵖ, where p = 1 if what moves them lasts as
    /// long whatever it is, and more if it comes to last less. Two orbits on the way, of which the nearer is d off, give p,
    /// and ε = dq/(1 − q) with qᵖ = r/r₁. As p is known to what r bends by on that way only, ε is told by this and in
    /// proportion (p = 1), and by how much they differ besides.
    fn part_rests(&self, node: &Node) -> Option<OrbitTermination> {
        /// Back along the branch, to where ranges are much larger, and the tolerance of these steps.
        const BACK: [f64; 2] = [-1e-3, -1e-2];
        const COARSE: f64 = 1e-8;
        let units = &self.setting.scales.states;
        let ranges = |point: &Vector| -> Option<Vec<f64>> {
            let extremes = self.extremes(point).ok()?;
            let ranges = extremes.iter().zip(units);
            Some(
                ranges
                    .map(|((low, high), unit)| (high - low) / unit)
                    .collect(),
            )
        };
        let here = ranges(&node.point)?;
        let rests = |range: f64| range > 0.0 && range <= NEARLY_AT_REST;
        if !here.iter().any(|range| rests(*range)) {
            return None;
        }
        let last = node.point.len() - 1;
        let mut earlier = [(0.0, Vec::new()), (0.0, Vec::new())];
        for (step, (way, before)) in BACK.into_iter().zip(&mut earlier) {
            let node_there = node_at(self, node, step, COARSE)?;
            *way = (node_there.point[last] - node.point[last]).abs();
            *before = ranges(&node_there.point)?;
        }
        let [(way, near), (far_way, far)] = &earlier;
        let left = |state: usize| {
            let (now, near, far) = (here[state], near[state], far[state]);
            // a state that hardly moves anywhere does not come to rest
            if !(rests(now) && now < 0.5 * near && near < far) {
                return None;
            }
            let extrapolated = |power: f64| {
                let part = (now / near).powf(power.recip());
                way * part / (1.0 - part)
            };
            let power = (far / near).ln() / (far_way / way).ln();
            let (fitted, straight) = (extrapolated(power), extrapolated(1.0));
            let left = fitted.max(straight) + (fitted - straight).abs();
            left.is_finite().then_some(left)
        };
        let resting: Vec<(usize, f64)> = (0..units.len())
            .filter_map(|state| Some((state, left(state)?)))
            .collect();
        let left = resting.iter().map(|(_, left)| *left).fold(0.0, f64::max);
        if resting.is_empty() || resting.len() == units.len() || left > NEARLY_AT_REST {
            return None;
        }
        let names = &self.setting.system.source.states;
        let states = resting.iter().map(|(state, _)| names[*state].clone());
        Some(OrbitTermination::PartRests {
            states: states.collect(),
            left,
        })
    }

    /// Whether a linear mode comes back to the entry of a zone at its end, whatever switch is there: the orbit is one of its centre.
    /// A mode that is not linear has an orbit of its own beyond.
    pub(super) fn turns_by_itself(&self, point: &Vector, zone: usize) -> bool {
        /// In units of the states: events are located to about 1e-13.
        const CLOSES: f64 = 1e-8;
        let zone = zone % self.zones();
        let units = &self.setting.scales.states;
        self.at(point).is_ok_and(|at| {
            let Ok(passage) = at.passage(zone, at.zones[zone].duration) else {
                return false;
            };
            let (entry, end) = (&at.zones[zone].state, passage.end.as_slice());
            // units of the states alone: what follows them in z is not compared
            at.mode(zone).field.is_exact && apart(entry, end, units) <= CLOSES
        })
    }

    /// Whether no zone lasts at a point: no sequence of zones goes on from there.
    pub(super) fn lasts_no_time(&self, point: &Vector) -> bool {
        let mut zones = 0..self.zones();
        !self.is_forced() && zones.all(|zone| point[self.duration_index(zone)].abs() <= CLOSING)
    }

    /// Whether an orbit and its period shrink to nothing at one value of the parameter, as where both fields of a sliding mode touch its
    /// surface from within: they fall in proportion, and what is left of the parameter as their square.
    fn shrinks_in_no_time(&self, node: &Node) -> Option<OrbitTermination> {
        /// All durations, in units of the first period.
        const SHORT: f64 = 1e-4;
        /// The slope of the parameter is as many times the longest of them at most.
        const SLOPE: f64 = 1e2;
        let Node { point, tangent, .. } = node;
        if self.is_forced() || !self.has_own_period() || self.sequence.switches() == 0 {
            return None;
        }
        let duration = |zone: usize| point[self.duration_index(zone)].abs();
        let longest = (0..self.zones()).map(duration).fold(0.0, f64::max);
        let shrinks = (0..self.zones()).all(|zone| tangent[self.duration_index(zone)] < 0.0);
        let stands = tangent[tangent.len() - 1].abs() <= SLOPE * longest;
        let is_short = longest <= SHORT && self.varies_within(point, SLOPE * SHORT);
        (is_short && shrinks && stands).then_some(OrbitTermination::Slides)
    }

    /// Why the branch does not go on from a node.
    pub(super) fn ends(&self, node: &Node) -> Option<OrbitTermination> {
        let unbounded = self.lengthens(node, STATIONARY);
        unbounded
            .or_else(|| self.has_lost_all_digits(node))
            .or_else(|| {
                let stalls = self.stalls(&node.point, AT_EQUILIBRIUM)?;
                // the saddle of a mode that slides is come to from without: there a connection ends
                Some(self.comes_slowly(node, 0.0).unwrap_or(stalls))
            })
            .or_else(|| self.grows(node))
            .or_else(|| self.shrinks_in_no_time(node))
            .or_else(|| self.rests(node, AT_REST))
            .or_else(|| {
                let vanishes = self.comes_to_a_point(node, AT_REST);
                vanishes.map(|vanishing| vanishing.outcome().1)
            })
    }

    /// The parameter where an orbit through several modes has no size, and its error. Beside a point where they meet,
    /// their fields are linear and their boundaries straight: the orbit is there the same but for its size, which is
    /// proportional to the distance of the parameter, and its durations remain. They change, as the slope does, by no
    /// more than in proportion to its size; where the switches make no difference the point is that of the smooth law.
    /// `None` where that is more than `most`, in units of the states.
    pub(super) fn comes_to_a_point(&self, node: &Node, most: f64) -> Option<Vanishing> {
        /// Most that a duration changes by on the way left, as a part of it.
        const LITTLE: f64 = 1e-3;
        /// A size that a located event may have at the point itself.
        const TINY: f64 = 1e-12;
        /// There a zone that is shorter than this part of the period closes, and its duration is a root of what is left.
        const SHORT: f64 = 1e-3;
        let Node { point, tangent, .. } = node;
        if self.sequence.switches() == 0 {
            return None;
        }
        let here = self.extent_within(point, most)?;
        if let Some(hopf) = self.smooth_hopf(point) {
            return Some(Vanishing {
                parameter: hopf.parameter,
                error: hopf.error,
                is_hopf: true,
            });
        }
        let left = if here > TINY {
            let before = self.extent(&(point - tangent * here))?;
            here * here / (before - here)
        } else {
            let durations = (0..self.zones()).map(|zone| point[self.duration_index(zone)]);
            let durations: Vec<f64> = durations.collect();
            let period: f64 = durations.iter().sum();
            if durations.iter().any(|one| *one < SHORT * period) {
                return None;
            }
            here
        };
        let remain = (0..self.zones()).all(|zone| {
            let index = self.duration_index(zone);
            (tangent[index] * left).abs() < LITTLE * point[index]
        });
        let last = point.len() - 1;
        let unit = self.setting.scales.parameter;
        let limit = point[last] + tangent[last] * left;
        let is_zero = limit.abs() <= 4.0 * f64::EPSILON * point[last].abs();
        let value = if is_zero { 0.0 } else { limit * unit };
        let error = left * left * unit.abs() + 2.0 * f64::EPSILON * value.abs();
        (left > 0.0 && remain).then_some(Vanishing {
            parameter: value,
            error,
            is_hopf: false,
        })
    }

    /// The same where no step succeeds any more.
    pub(super) fn nearly_ends(&self, node: &Node) -> Option<OrbitTermination> {
        let accumulates = self.accumulates(&node.point);
        accumulates
            .or_else(|| self.lengthens(node, NEARLY_STATIONARY))
            .or_else(|| self.rests(node, NEARLY_AT_REST))
            .or_else(|| self.stalls(&node.point, NEARLY_AT_REST))
            .or_else(|| {
                let stay = self.longest_stay(&node.point)?;
                let stop = (stay.growth > DIGITS).then(|| self.comes_to(stay, node))?;
                let is_near =
                    || self.left_beside_a_saddle(node) < NEARLY_THERE && self.comes_nearer(node);
                (stop.is_located() || is_near()).then_some(stop)
            })
            .or_else(|| self.comes_slowly(node, DIGITS))
            .or_else(|| self.loses_digits(&node.point))
            .or_else(|| self.part_rests(node))
    }

    /// The homoclinic orbit to which an orbit comes that has lost its digits to this growth beside saddles, as a power of e, before
    /// it comes near: where decay is much slower than growth. The orbit itself is computed and tells.
    fn comes_slowly(&self, node: &Node, growth: f64) -> Option<OrbitTermination> {
        let stay = self.longest_stay_within(&node.point, FAR)?;
        let stop = (stay.growth > growth).then(|| self.comes_to(stay, node))?;
        stop.is_located().then_some(stop)
    }

    /// The same where nothing but the duration grows and the orbit has lost all digits: steps succeed beyond that, but by
    /// chance.
    fn has_lost_all_digits(&self, node: &Node) -> Option<OrbitTermination> {
        /// Growth, as a power of e, that has taken them.
        const ALL: f64 = 36.0;
        let (point, tangent) = (&node.point, self.tangent_of_zones(node));
        let along = tangent[tangent.len() - 1].abs();
        let zone = self.longest(point)?;
        let comes = self.has_own_period()
            && along < NEARLY_THERE
            && tangent[self.duration_index(zone)] > GROWING
            && self.longest_stay_within(point, FAR)?.growth > ALL;
        comes.then(|| self.comes_slowly(node, DIGITS)).flatten()
    }

    /// Whether what a motion is off grows within a zone until half of all digits are lost.
    fn loses_digits(&self, point: &Vector) -> Option<OrbitTermination> {
        /// Places from which growth to the end of a zone is measured.
        const PLACES: usize = 32;
        let at = self.at(point).ok()?;
        let units = &self.setting.scales.states;
        let of_zone = |zone: usize| {
            // what is lost in a shot is not in the next one
            let (duration, share) = (at.zones[zone].duration, at.share(zone));
            let time = |place: usize| duration * place as f64 / PLACES as f64;
            let left = |place: usize| share - time(place) % share;
            let along = at.along(zone, (0..PLACES).map(time)).ok()?;
            let mode = at.mode(zone);
            let growth = along.into_iter().enumerate().map(|(place, z)| {
                let norm = mode.matrix.at.norm();
                let passage = Passage::new(mode, norm, None, z, left(place));
                let forward = passage.forward();
                let entries = (0..units.len())
                    .flat_map(|row| (0..units.len()).map(move |column| (row, column)));
                entries
                    .map(|(row, column)| forward[(row, column)].abs() * units[column] / units[row])
                    .fold(0.0, f64::max)
            });
            Some((zone, growth.fold(0.0, f64::max)))
        };
        let (zone, growth) = (0..self.zones())
            .filter_map(of_zone)
            .max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (growth > DIGITS.exp()).then(|| OrbitTermination::LosesDigits {
            mode: self.sequence.zone(zone).name.clone(),
            growth,
        })
    }

    /// Why the branch ends where a margin vanishes and no candidate goes on.
    fn ends_at_change(&self, point: &Vector, margin: &Margin) -> Option<OrbitTermination> {
        if self.lasts_no_time(point) {
            return Some(OrbitTermination::Slides);
        }
        let vanishes = usize::from(margin.watch == Watch::Duration);
        let last =
            self.zones() - vanishes == 1 && matches!(margin.watch, Watch::Duration | Watch::Speed);
        let remains = margin.zone + vanishes;
        let is_centre = last && self.has_own_period() && self.turns_by_itself(point, remains);
        let centre = is_centre.then(|| OrbitTermination::Centre {
            zone: Zone {
                way: None,
                ..self.sequence.zone(remains).clone()
            },
        });
        // the guard is positive before: it touches zero, and what follows without the switch is no orbit nearby
        let misses = || {
            let none = candidates(self, point, margin).is_ok_and(|all| all.is_empty());
            let held = self.inequality(margin);
            match margin.watch {
                Watch::Speed if none => Some(OrbitTermination::Misses { held }),
                Watch::Duration if none => Some(OrbitTermination::Jumps { held }),
                _ => None,
            }
        };
        let accumulates = || self.accumulates(point);
        let barely = || {
            let vanishing = Some(margin).filter(|margin| margin.watch == Watch::Duration)?;
            self.barely_reaches(point, vanishing.zone)
        };
        centre
            .or_else(accumulates)
            .or_else(barely)
            .or_else(misses)
            .or_else(|| self.held_at(point, margin))
            .or_else(|| self.others_remain(point, margin))
            .or_else(|| self.family_beyond(point, margin))
            .or_else(|| self.jumps(point))
    }
}

impl Terminations for AffineOrbit {
    type Termination = OrbitTermination;

    fn termination(&self, situation: Situation<'_, Margin>) -> Option<OrbitTermination> {
        match situation {
            Situation::At(node, _) => self.ends(node).or_else(|| self.negative_bound(&node.point)),
            Situation::NoStep(node) => self.nearly_ends(node),
            Situation::Change(_) => None,
            Situation::NoCandidate(point, margin) => self.ends_at_change(point, margin),
        }
    }

    /// Without bound: what the parameter changes by while the unknowns do by their units, since its slope decays in
    /// the time that growth beside a saddle takes, or by their size where that grows, twice so far where it does like a pole of order
    /// two. At rest: it changes by a power of the durations that vanish, of order one at least.
    fn short_of(&self, stop: &OrbitTermination, node: &Node) -> f64 {
        let Node { point, tangent, .. } = node;
        let slope = tangent[tangent.len() - 1].abs();
        match stop {
            OrbitTermination::Unbounded => slope,
            OrbitTermination::Slides => slope * self.extent(point).unwrap_or(1.0),
            // the time beside a focus that becomes a node is the inverse root of what the parameter lacks, beside a node
            // its logarithm, which is less
            OrbitTermination::Stalls { .. } => {
                let durations = (0..self.zones()).map(|zone| self.duration_index(zone));
                let (period, growth) = durations.fold((0.0, 0.0), |(period, growth), index| {
                    (period + point[index], growth + tangent[index])
                });
                0.5 * (slope * period / growth).abs()
            }
            OrbitTermination::Grows => unbounded::short_of(point, &self.tangent_of_zones(node)),
            OrbitTermination::PartRests { left, .. } => *left,
            OrbitTermination::Rests { modes } => {
                let moves = |zone: &usize| !modes.contains(&self.sequence.zone(*zone).name);
                let zones = (0..self.zones()).filter(moves);
                let rest = |zone| {
                    let index = self.duration_index(zone);
                    (slope * point[index] / tangent[index]).abs()
                };
                zones.map(rest).fold(0.0, f64::max)
            }
            _ => 0.0,
        }
    }

    fn limit(&self, termination: &OrbitTermination, node: &Node) -> Option<Limit<Critical>> {
        if *termination != OrbitTermination::Slides {
            return self.limit_of(termination, node);
        }
        let short = self.short_of(termination, node) * self.unit().abs();
        Some(Limit {
            special: Critical::Instant,
            parameter: self.parameter_at(&node.point),
            uncertainty: short + rounding_at(self, node),
        })
    }

    /// An orbit of amplitude a is off by a², and so is the parameter, which changes by its slope times a.
    fn shrunk(&self, node: &Node) -> Option<(Vector, f64)> {
        let point = &node.point;
        if !self.is_point(point) {
            return None;
        }
        let beside = || {
            let slope = node.tangent[node.tangent.len() - 1].abs();
            let left = slope * self.extent(point)? * self.unit().abs();
            let known = self.hopf_point(point).map(|hopf| hopf.error);
            let known = known.unwrap_or_else(|| rounding_at(self, node));
            Some((point.clone(), left + known))
        };
        self.hopf(point).or_else(beside)
    }

    fn vanishes(&self, node: &Node) -> Option<(f64, f64)> {
        let vanishing = self.comes_to_a_point(node, NEARLY_A_POINT)?;
        Some((vanishing.parameter, vanishing.error))
    }

    fn ends_within(&self, step: &Segment<Examination>) -> EndWithin<AffineOrbit> {
        let shrinks = self.shrinks_within(step);
        let ends = shrinks.or_else(|| self.enters_a_family(step));
        ends.unwrap_or(EndWithin::Not)
    }
}
