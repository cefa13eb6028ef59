//! Stays of an orbit beside a saddle: where it takes ever longer, it comes to a connection of saddles.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::Critical;
use super::layout::{AffineOrbit, OrbitAt};
use super::setting::Scales;
use super::signature::Zone;
use super::termination::OrbitTermination;
use crate::affine::equilibrium::{
    EquilibriumScales, EquilibriumSetting, SpecialEquilibrium, boundary_near, fold_near,
};
use crate::continuation::Node;
use crate::continuation::locate::node_at;
use crate::linalg::Vector;
use crate::orbit::Zones;

/// How near a saddle an orbit comes, in units of its own, that has lost its digits before.
pub(super) const FAR: f64 = 0.2;

/// A stay beside a saddle.
pub(super) struct Stay {
    /// Its zone.
    pub zone: usize,
    /// The place of the zone at which it is next to the saddle.
    pub place: usize,
    /// Name of its mode.
    pub mode: String,
    /// The saddle.
    pub rest: Vec<f64>,
    /// A state where it leaves, and what grows is most of what it is off.
    pub leaving: Vec<f64>,
    /// How near that is, in units of the orbit's own.
    pub nearest: f64,
    /// How long it lasts.
    pub time: f64,
    /// How much a perturbation grows beside all saddles of its zone, as a power of e.
    pub growth: f64,
    /// Time in which the slowest decay and the slowest growth change by a factor e, or turn by half: what the parameter is off
    /// falls by that at least, for a longer period.
    pub turn: f64,
    /// The part of it that is left after that time, at most.
    pub falls: f64,
}

/// A stay comes as near a saddle as this, in units of the orbit's own.
pub(super) const NEAR: f64 = 1e-2;

/// A motion that is farther has gone away.
const BESIDE: f64 = 0.3;

/// Places of a zone that are looked at.
const PLACES: usize = 256;

/// Places of a zone, from its entry to its end.
fn way(at: &OrbitAt, zone: usize) -> Option<Vec<Vector>> {
    let time = at.zones[zone].duration;
    let times = (0..=PLACES).map(|place| time * place as f64 / PLACES as f64);
    at.along(zone, times).ok()
}

/// How far two states are apart, in their units.
pub(super) fn apart(one: &[f64], other: &[f64], units: &[f64]) -> f64 {
    let apart = one.iter().zip(other).zip(units);
    let apart = apart.map(|((one, other), unit)| ((one - other) / unit).abs());
    apart.fold(0.0, f64::max)
}

/// The place of a way at which it moves least.
fn slowest<'a>(way: &'a [Vector], units: &[f64]) -> Option<&'a Vector> {
    let slowest = way.windows(2).min_by(|one, other| {
        let moves = |pair: &[Vector]| apart(pair[0].as_slice(), pair[1].as_slice(), units);
        moves(one).total_cmp(&moves(other))
    });
    Some(&slowest?[0])
}

impl AffineOrbit {
    /// Units of an orbit's own: those of the first orbit, less by the part of them that it varies by at most, but where a state varies by
    /// much more than that, what it varies by.
    pub(super) fn extents(&self, point: &Vector) -> Vec<f64> {
        /// Up to so many units the unit serves. Of a state that varies by less it does: it may only follow the others.
        const ALIKE: f64 = 5.0;
        let units = &self.setting.scales.states;
        let Ok(extremes) = self.extremes(point) else {
            return units.clone();
        };
        let extents = extremes.iter().map(|(low, high)| high - low).zip(units);
        // far from the origin the orbit is a small part of all of them
        let parts = extents.clone().map(|(extent, unit)| extent / unit);
        let part = parts.fold(0.0, f64::max).min(1.0);
        let part = if part > 0.0 { part } else { 1.0 };
        let extents = extents.map(|(extent, unit)| {
            let unit = part * unit;
            if extent > ALIKE * unit { extent } else { unit }
        });
        extents.collect()
    }

    /// The longest zone.
    pub(super) fn longest(&self, point: &Vector) -> Option<usize> {
        let duration = |zone: &usize| point[self.duration_index(*zone)];
        (0..self.zones()).max_by(|one, other| duration(one).total_cmp(&duration(other)))
    }

    /// Whether the longest zone of an orbit is nearly at rest somewhere, as one is that takes ever longer: a cycle whose parts are
    /// slow and fast, as that of a canard, may become several times longer at one value of the parameter, to rounding, but is as slow as
    /// its slow part everywhere there.
    pub(super) fn nearly_rests(&self, point: &Vector) -> bool {
        /// At its mean speed it would go over this part of its extent in its period.
        const SLOW: f64 = 1e-2;
        let slowest = || {
            let zone = self.longest(point)?;
            let way = way(&self.at(point).ok()?, zone)?;
            let units = &self.extents(point)[..];
            let moves = |pair: &[Vector]| apart(pair[0].as_slice(), pair[1].as_slice(), units);
            way.windows(2).map(moves).reduce(f64::min)
        };
        slowest().is_some_and(|least| least * (PLACES as f64) < SLOW)
    }

    /// The longest stay beside a saddle in the longest zone of an orbit without forcing.
    pub(super) fn longest_stay(&self, point: &Vector) -> Option<Stay> {
        self.longest_stay_within(point, NEAR)
    }

    /// The same, where it comes so near, in units of its own.
    pub(super) fn longest_stay_within(&self, point: &Vector, most: f64) -> Option<Stay> {
        let stays = self.stays_in(point, self.longest(point)?, most).into_iter();
        stays.reduce(|one, other| if other.time > one.time { other } else { one })
    }

    /// All stays of an orbit, in their order from one of them on: the others where it comes so near.
    pub(super) fn stays_from(&self, point: &Vector, first: &Stay, most: f64) -> Vec<Stay> {
        let is_first = |stay: &Stay| (stay.zone, stay.place) == (first.zone, first.place);
        let all = (0..self.zones()).flat_map(|zone| self.stays_in(point, zone, FAR));
        let mut stays: Vec<Stay> = all
            .filter(|stay| stay.nearest < most || is_first(stay))
            .collect();
        let begins = stays.iter().position(is_first).unwrap_or(0);
        stays.rotate_left(begins);
        stays
    }

    /// The stays of a zone beside saddles, in their order, where it comes so near, in units of its own: each is about a place at
    /// which the motion is slower than before and after. They share the time of the zone as they do that which is spent near.
    fn stays_in(&self, point: &Vector, zone: usize, most: f64) -> Vec<Stay> {
        if !self.has_own_period() {
            return Vec::new();
        }
        let passed = || {
            let at = self.at(point).ok()?;
            let way = way(&at, zone)?;
            Some((at, way))
        };
        let Some((at, way)) = passed() else {
            return Vec::new();
        };
        let units = &self.extents(point)[..];
        let moves = |pair: &[Vector]| apart(pair[0].as_slice(), pair[1].as_slice(), units);
        let speeds: Vec<f64> = way.windows(2).map(moves).collect();
        let is_slow = |place: &usize| {
            let before = place
                .checked_sub(1)
                .map_or(f64::INFINITY, |one| speeds[one]);
            let after = speeds.get(place + 1).copied().unwrap_or(f64::INFINITY);
            speeds[*place] < before && speeds[*place] <= after
        };
        let slow = (0..speeds.len()).filter(is_slow);
        let mut stays: Vec<Stay> = Vec::new();
        for stay in slow.filter_map(|place| self.stay_at(&at, (zone, &way), place, units)) {
            // rounding makes a motion slow several times, and so does a saddle about which it turns
            if stay.nearest < most && !stays.iter().any(|known| known.place == stay.place) {
                stays.push(stay);
            }
        }
        let time = at.zones[zone].duration;
        let all: f64 = stays.iter().map(|stay| stay.time).sum();
        stays.iter_mut().for_each(|stay| stay.time *= time / all);
        // so far each has the rate of its own
        let growth = stays.iter().map(|stay| stay.growth * stay.time).sum();
        stays.iter_mut().for_each(|stay| stay.growth = growth);
        stays
    }

    /// The stay beside the saddle next to a place of the way of a zone.
    fn stay_at(
        &self,
        at: &OrbitAt,
        (zone, way): (usize, &[Vector]),
        place: usize,
        units: &[f64],
    ) -> Option<Stay> {
        /// It leaves where it is so many times as far as next to the saddle, or as this.
        const LEAVES: f64 = 3.0;
        const LEAST: f64 = 1e-3;
        let Zone { mode, name, .. } = self.sequence.zone(zone);
        let system = &at.posed.system;
        let states = |place: usize| &way[place].as_slice()[..units.len()];
        let equilibrium = system.equilibrium_near(*mode, states(place))?;
        let values = &equilibrium.eigenvalues;
        let rate = values.first().filter(|value| value.re > 0.0)?.re;
        let turn = |value: &Complex<f64>| match value.im.abs() {
            0.0 => value.re.abs().recip(),
            turns => PI / turns,
        };
        // what slides or is held comes from without
        let slides = system.modes[*mode].surfaces().next().is_some();
        let growing = values.iter().rfind(|value| value.re > 0.0)?;
        let decaying = values.iter().find(|value| value.re < 0.0);
        let decaying = decaying.or(Some(growing).filter(|_| slides))?;
        let rest = &equilibrium.state;
        let far: Vec<f64> = (0..way.len())
            .map(|place| apart(states(place), rest, units))
            .collect();
        // as long as the motion has not gone away, from there or from what is near
        let beside = far[place].max(BESIDE);
        let gone = |place: &usize| far[*place] > beside;
        let first = (0..place).rfind(gone).map_or(0, |gone| gone + 1);
        let end = (place..way.len()).find(gone).unwrap_or(way.len());
        let next = (first..end).min_by(|one, other| far[*one].total_cmp(&far[*other]))?;
        let still_near = |place: &usize| far[*place] <= LEAVES * far[next].max(LEAST);
        let leaving = (next..way.len()).take_while(still_near).last()?;
        let turns = turn(decaying).max(turn(growing));
        let slowest = decaying.re.abs().min(growing.re);
        Some(Stay {
            zone,
            place: next,
            mode: name.clone(),
            nearest: far[next],
            time: (end - first) as f64,
            growth: rate,
            turn: turns,
            falls: (-slowest * turns).exp(),
            leaving: states(leaving).to_vec(),
            rest: rest.clone(),
        })
    }

    /// The special equilibrium to which the parameter comes while the period T grows without bound, where what is left of it is like
    /// dp/dT times a time of the passage, to this factor.
    fn comes_to_an_equilibrium(
        &self,
        Node { point, tangent, .. }: &Node,
        zone: usize,
        (found, time, like): (SpecialEquilibrium, f64, f64),
        special: Critical,
    ) -> Option<OrbitTermination> {
        let (index, last) = (self.duration_index(zone), point.len() - 1);
        let scales = &self.setting.scales;
        let slope = tangent[last] / tangent[index] * scales.parameter / scales.time;
        let left = (found.parameter - self.parameter_at(point)) / (slope * time);
        let comes = (like.recip()..=like).contains(&left);
        comes.then_some(OrbitTermination::Equilibrium {
            special,
            limit: found.parameter,
            error: found.error,
        })
    }

    /// The saddle-node of equilibria beside the longest zone of an orbit to which the parameter comes: the passage takes a time
    /// T = C/√|p − p₀|, so that half of it times dp/dT is left.
    pub(super) fn comes_to_a_saddle_node(&self, node: &Node) -> Option<OrbitTermination> {
        /// It passes as near, in units of the orbit's own: about as the root of what is left of its parameter.
        const NEAR: f64 = 0.2;
        /// The passage is this part of the zone at least.
        const MOST: f64 = 0.75;
        /// What is left is like that to this factor: the passage has an end on either side.
        const LIKE: f64 = 1.25;
        let point = &node.point;
        let zone = self.longest(point)?;
        let at = self.at(point).ok()?;
        let units = &self.extents(point)[..];
        let way = way(&at, zone)?;
        let place = |z: &Vector| z.rows(0, units.len()).as_slice().to_vec();
        let slow = place(slowest(&way, units)?);
        let beside = |rest: &[f64]| {
            let near = way
                .iter()
                .filter(|z| apart(&place(z), rest, units) <= BESIDE);
            near.count() as f64 / way.len() as f64
        };
        // most of the time it is near where it is slowest
        if beside(&slow) < MOST {
            return None;
        }
        let Zone { mode, name, .. } = self.sequence.zone(zone);
        let fold = fold_near(self.equilibria_beside(point, &slow), *mode)?;
        let part = beside(&fold.state);
        if part < MOST || apart(&fold.state, &slow, units) > NEAR {
            return None;
        }
        let time = 0.5 * part * at.zones[zone].duration;
        let special = Critical::SaddleNode { mode: name.clone() };
        self.comes_to_an_equilibrium(node, zone, (fold, time, LIKE), special)
    }

    /// The equilibrium on a guard beside the longest zone of an orbit to which the parameter comes.
    pub(super) fn comes_to_a_boundary(&self, node: &Node) -> Option<OrbitTermination> {
        /// What is left is told to this factor: the time elsewhere does not grow, and other rates have decayed more.
        const LIKE: f64 = 1.5;
        let zone = self.longest(&node.point)?;
        let at = self.at(&node.point).ok()?;
        let (found, time) = self.boundary_beside(&at, &node.point, zone)?;
        let mode = self.sequence.zone(zone).name.clone();
        let special = Critical::RestOnBoundary { mode };
        self.comes_to_an_equilibrium(node, zone, (found, time, LIKE), special)
    }

    /// The equilibrium to which a zone comes on the guard that ends it: what the motion is off falls like e^(−λT) with the slowest
    /// rate λ of its decay, and so does what is left of the parameter.
    fn boundary_beside(
        &self,
        at: &OrbitAt,
        point: &Vector,
        zone: usize,
    ) -> Option<(SpecialEquilibrium, f64)> {
        let Zone { mode, way, .. } = self.sequence.zone(zone);
        let passage = at.passage(zone, at.zones[zone].duration).ok()?;
        let end = &passage.end.as_slice()[..self.states()];
        let rest = at.posed.system.equilibrium_near(*mode, end)?;
        let slowest = rest.eigenvalues.first().filter(|value| value.re < 0.0)?;
        let setting = self.equilibria_beside(point, &rest.state);
        let boundary = boundary_near(setting, *mode, way.as_ref()?.guard)?;
        Some((boundary, -slowest.re.recip()))
    }

    /// What the equilibria beside a state have in common, with the units of an orbit.
    fn equilibria_beside(&self, point: &Vector, state: &[f64]) -> EquilibriumSetting {
        let Scales {
            states,
            parameter,
            time,
            ..
        } = &self.setting.scales;
        let value = self.parameter_at(point);
        EquilibriumSetting {
            system: self.setting.system.clone(),
            values: self.values_at(point),
            parameter: self.setting.parameter,
            scales: EquilibriumScales {
                units: states.iter().copied().chain([parameter.abs()]).collect(),
                first: state.iter().copied().chain([value]).collect(),
                rate: time.recip(),
            },
        }
    }

    /// What the parameter changed by, at most, while the period grew by each of so many last turns beside a saddle, the last one
    /// first, as far as the branch goes back, with the part of it that a connection leaves from turn to turn.
    fn last_turns(&self, node: &Node, count: usize) -> Option<(Vec<f64>, f64)> {
        /// Steps back along the branch, and their tolerance: digits are lost here.
        const STEP: f64 = 0.02;
        const COARSE: f64 = 1e-6;
        const MOST: usize = 200;
        let Stay { turn, falls, .. } = self.longest_stay(&node.point)?;
        let turn = turn / self.setting.scales.time;
        let period = |node: &Node| -> f64 {
            let durations = (0..self.zones()).map(|zone| node.point[self.duration_index(zone)]);
            durations.sum()
        };
        let last = node.point.len() - 1;
        let (mut from, mut here) = (node.clone(), node.clone());
        let mut changes = vec![0.0_f64];
        for _ in 0..MOST {
            if period(&from) - period(&here) >= turn {
                if changes.len() == count {
                    return Some((changes, falls));
                }
                changes.push(0.0);
                from = here.clone();
            }
            // in the unknowns of the zones, whatever shots they have
            let outer = self.outer_part(&here);
            here = node_at(self, &here, -STEP / outer, COARSE)?;
            let change = changes.last_mut()?;
            *change = change.max((here.point[last] - from.point[last]).abs());
        }
        // the last of them is not whole
        changes.truncate((changes.len() - 1).max(1));
        Some((changes, falls))
    }

    /// Whether the parameter comes to the value of a connection: what it changes by falls from turn to turn, as far as the branch
    /// has come by two of them. A cycle whose parts are slow and fast may pass a saddle with a parameter that moves on.
    pub(super) fn comes_nearer(&self, node: &Node) -> bool {
        let Some((changes, falls)) = self.last_turns(node, 2) else {
            return true;
        };
        let [last, before] = changes[..] else {
            return true;
        };
        last <= falls.sqrt() * before
    }

    /// What is left to a homoclinic orbit, at most: the parameter swings about its own or comes from one side, and
    /// changed by more in the last turn.
    pub(super) fn left_beside_a_saddle(&self, node: &Node) -> f64 {
        let slope = node.tangent[node.tangent.len() - 1].abs();
        let turns = self.last_turns(node, 1);
        turns.map_or(slope, |(changes, _)| changes[0])
    }
}
