//! Multiple shooting: a zone along which a motion grows by much is gone through in several shots of equal duration, each from states of its
//! own.
//!
//! From the entry alone an error of the states there, and the rounding of every piece, would be as much larger at the end of the zone as
//! a motion grows, and Newton's method would find its way only as far beside an orbit as one over that. With states at the beginning of
//! every shot as further unknowns,
//!
//! ```text
//! x_{j+1} − φ(T/s; x_j) = 0,   j = 0 .. s − 2,
//! ```
//!
//! growth counts over one shot only (U. Ascher, R. Mattheij, R. Russell, Numerical Solution of Boundary Value Problems, 1995, chapter
//! 4), so that an orbit beside a saddle, or one that stays at what repels it, is known as well as any other. The zone remains one: its
//! inequalities, switches and names know nothing of its shots.

use std::sync::Arc;

use super::layout::{AffineOrbit, OrbitAt};
use super::passage::{Derivatives, Integrated, Passage, in_no_time, moved};
use super::setting::OrbitFailure;
use super::signature::{Sequence, ZonePoint};
use crate::affine::flow::ModeFlow;
use crate::affine::mode::Row;
use crate::continuation::Node;
use crate::linalg::{Matrix, Vector, product};

/// Growth over a shot, as a power of e, from which a zone is gone through in more: a quarter of all digits.
const GROWS: f64 = 9.0;

/// The same where steps are short: a step may be as long as one over the growth.
const GROWS_AND_CREEPS: f64 = 6.0;

/// Growth over each of the shots then.
const OF_A_SHOT: f64 = 6.0;

/// Most shots of a zone.
const MOST: usize = 200;

/// How much a motion grows along a zone, as powers of e.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ZoneGrowth {
    /// Over one of its shots, at most.
    of_shot: f64,
    /// Over any part of it, at most.
    of_zone: f64,
}

impl AffineOrbit {
    /// How many shots a zone is gone through in.
    pub(super) fn shots(&self, zone: usize) -> usize {
        self.sequence.zone(zone).shots()
    }

    /// How many shots there are before a zone, or in all of them.
    pub(super) fn shots_before(&self, zone: usize) -> usize {
        self.firsts[zone]
    }

    /// Unknowns of all zones: their entries and durations, and the beginnings of their further shots.
    pub(super) fn unknowns_of_zones(&self) -> usize {
        let further = self.shots_before(self.zones()) - self.zones();
        self.width() * self.zones() + self.states() * further
    }

    /// Index of the first of the states at the beginning of a shot.
    pub(super) fn shot_index(&self, zone: usize, shot: usize) -> usize {
        match shot.checked_sub(1) {
            None => self.width() * zone,
            Some(further) => {
                let before = self.shots_before(zone) - zone + further;
                self.width() * self.zones() + self.states() * before
            }
        }
    }

    /// The states at the beginnings of the further shots of a zone: those that are known or, where these are not as many, those that the
    /// motion from its entry has.
    pub(super) fn inner_states(
        &self,
        index: usize,
        zone: &ZonePoint,
        values: &[f64],
    ) -> Vec<Vec<f64>> {
        let shots = self.shots(index);
        if zone.inner.len() + 1 == shots {
            return zone.inner.clone();
        }
        // what has no value there is no solution either
        let Ok(system) = self.setting.system.at(values, &[]) else {
            return vec![zone.state.clone(); shots - 1];
        };
        let mode = self.sequence.zone(index).mode;
        let flow = ModeFlow::new(&system.modes[mode], self.setting.scales.time);
        let entry = system.lift(mode, &zone.state, zone.phase);
        let states = |shot: usize| {
            let z = flow.after(&entry, zone.duration * shot as f64 / shots as f64);
            z.rows(0, self.states()).iter().copied().collect()
        };
        (1..shots).map(states).collect()
    }

    /// The same orbits with their zones in so many shots.
    pub(super) fn in_shots(&self, shots: &[usize]) -> Option<AffineOrbit> {
        let zones = self.sequence.0.iter().zip(shots);
        let zones = zones.map(|(zone, shots)| zone.clone().in_shots(*shots));
        self.with_sequence(Sequence(zones.collect()))
    }

    /// How long a tangent is in these unknowns alone.
    pub(super) fn outer_part(&self, node: &Node) -> f64 {
        let (entries, all) = (self.width() * self.zones(), self.unknowns_of_zones());
        let inner = node.tangent.rows(entries, all - entries).norm_squared();
        (1.0 - inner).max(0.0).sqrt()
    }

    /// A point and a direction there in the unknowns of the same orbits in other shots, or begun elsewhere.
    pub(super) fn carried_to(&self, other: &AffineOrbit, node: &Node) -> Option<Node> {
        if self.sequence.zone(0).section() != other.sequence.zone(0).section() {
            return self.carried_to_section(other, node);
        }
        let at = self.at(&node.point).ok()?;
        let count = other.count();
        let mut moved = Node::at(Vector::zeros(count), Vector::zeros(count));
        let pairs = [
            (&node.point, &mut moved.point),
            (&node.tangent, &mut moved.tangent),
        ];
        let entries = self.width() * self.zones();
        for (from, to) in pairs {
            to.rows_mut(0, entries).copy_from(&from.rows(0, entries));
            let last = self.count() - self.unknowns_of_zones();
            let (own, others) = (self.unknowns_of_zones(), other.unknowns_of_zones());
            to.rows_mut(others, last).copy_from(&from.rows(own, last));
        }
        for zone in 0..self.zones() {
            let shots = other.shots(zone);
            for shot in 1..shots {
                let part = shot as f64 / shots as f64;
                let first = other.shot_index(zone, shot);
                for (state, (value, along)) in at
                    .at_part(zone, part, &node.tangent)?
                    .into_iter()
                    .enumerate()
                {
                    moved.point[first + state] = value;
                    moved.tangent[first + state] = along;
                }
            }
        }
        Some(moved)
    }

    /// An orbit in as many shots as the growth along it asks for, where these are others.
    pub(super) fn in_own_shots(&self, point: &Vector) -> Option<(AffineOrbit, Vector)> {
        let at = self.at(point).ok()?;
        let growths = at.growths(&at.passages().ok()?, false);
        let parted = self.in_shots_for_growth(point, &growths, false)?;
        let node = Node::at(point.clone(), Vector::zeros(point.len()));
        let Node { point, .. } = self.carried_to(&parted, &node)?;
        Some((parted, point))
    }

    /// The same orbits in as many shots as the growth along one of them asks for, where these are others; `creeps` where
    /// steps are short.
    pub(super) fn in_shots_for_growth(
        &self,
        point: &Vector,
        known: &[ZoneGrowth],
        creeps: bool,
    ) -> Option<AffineOrbit> {
        let within = || {
            let at = self.at(point).ok()?;
            Some(at.growths(&at.passages().ok()?, true))
        };
        let within = creeps.then(within).flatten();
        let all = within.as_deref().unwrap_or(known);
        let wanted = |zone: usize| {
            let (shots, ZoneGrowth { of_shot, of_zone }) = (self.shots(zone), all[zone]);
            let most = if creeps { GROWS_AND_CREEPS } else { GROWS };
            // what grows in a small part of the zone takes more of them than its growth alone
            let few = (of_zone / OF_A_SHOT).max(shots as f64 * of_shot / OF_A_SHOT);
            let few = few.ceil().clamp(1.0, MOST as f64) as usize;
            match () {
                () if of_shot > most && few > shots => few,
                // that which is short again does not grow
                () if of_zone < 0.5 * GROWS_AND_CREEPS => 1,
                () => shots,
            }
        };
        let wanted: Vec<usize> = (0..self.zones()).map(wanted).collect();
        if (0..self.zones()).all(|zone| wanted[zone] == self.shots(zone)) {
            return None;
        }
        self.in_shots(&wanted)
    }
}

impl OrbitAt<'_> {
    /// Duration of a shot of a zone.
    pub(super) fn share(&self, zone: usize) -> f64 {
        let zone = zone % self.zones.len();
        match self.orbit.shots(zone) {
            1 => self.zones[zone].duration,
            shots => self.zones[zone].duration / shots as f64,
        }
    }

    /// z at the beginning of a shot of a zone.
    pub(super) fn shot_entry(&self, zone: usize, shot: usize) -> Vector {
        let at = &self.zones[zone % self.zones.len()];
        let mode = self.orbit.sequence.zone(zone).mode;
        let begun = self.share(zone) * shot as f64;
        let phase = at.phase + self.posed.system.omega.value * begun;
        self.posed.system.lift(mode, at.at_shot(shot), phase)
    }

    /// The passage through a zone up to a time after its entry: the part of it in the shot in which that time is.
    ///
    /// # Errors
    /// It leaves the range of numbers.
    pub(super) fn passage(&self, zone: usize, time: f64) -> Result<Passage<'_>, OrbitFailure> {
        let share = self.share(zone);
        let last = self.orbit.shots(zone) - 1;
        if last == 0 || time == self.zones[zone % self.zones.len()].duration {
            return self.shot(zone, last, if last == 0 { time } else { share });
        }
        let shot = ((time / share) as usize).min(last);
        self.shot(zone, shot, time - share * shot as f64)
    }

    /// The passage through a shot of a zone up to a time after its beginning.
    ///
    /// # Errors
    /// It leaves the range of numbers.
    pub(super) fn shot(
        &self,
        zone: usize,
        shot: usize,
        time: f64,
    ) -> Result<Passage<'_>, OrbitFailure> {
        let OrbitAt { orbit, posed, .. } = self;
        let name = &orbit.sequence.zone(zone).name;
        let mode = orbit.sequence.zone(zone).mode;
        let entry = self.shot_entry(zone, shot);
        let is_last = shot + 1 == orbit.shots(zone);
        let is_whole = is_last && time.to_bits() == self.share(zone).to_bits();
        let is_switch = orbit.sequence.zone(zone).way.is_some() && is_whole;
        let passage = match posed.system.modes[mode].field.is_exact {
            true => {
                let propagators = posed.propagators(zone % self.zones.len(), mode, time);
                let norm = posed.balance(mode).1;
                Passage::linear(&posed.system.modes[mode], norm, &propagators, entry, time)
            }
            false => self.integrated(zone, entry, (time, is_switch)),
        };
        let finite = passage.flow.as_slice().iter().all(|x| x.is_finite());
        finite
            .then(|| passage.of_shot(shot))
            .ok_or_else(|| OrbitFailure::Overflow {
                mode: name.clone(),
                duration: time,
            })
    }

    /// The passage through a shot whose mode is integrated, which is known as far as that through all of it is.
    pub(super) fn integrated(
        &self,
        zone: usize,
        entry: Vector,
        (time, is_switch): (f64, bool),
    ) -> Passage<'_> {
        let number = self.orbit.sequence.zone(zone).mode;
        let mode = &self.posed.system.modes[number];
        let whole = self.share(zone);
        let part = || {
            let (known, place) = self.known(number, &entry, whole);
            Some((Arc::new(known.until(mode, time)?), place))
        };
        let is_part = 0.0 < time && time < whole;
        let (known, place) = is_part
            .then(part)
            .flatten()
            .unwrap_or_else(|| self.known(number, &entry, time));
        Passage::integrated(mode, entry, (time, is_switch), &known, place)
    }

    /// What is known of the passage from z through a mode that is integrated, and the place of the continuation parameter
    /// among those of its derivatives.
    pub(super) fn known(
        &self,
        number: usize,
        entry: &Vector,
        time: f64,
    ) -> (Arc<Integrated>, usize) {
        let setting = &self.orbit.setting;
        let mode = &self.posed.system.modes[number];
        let varying = setting.varying();
        let parameters = (self.values.as_slice(), varying.as_slice());
        let memory = &self.orbit.memory;
        memory.passage((number, mode), parameters, entry, time)
    }

    /// The passages through all shots of all zones.
    ///
    /// # Errors
    /// One of them leaves the range of numbers.
    pub(super) fn passages(&self) -> Result<Vec<Passage<'_>>, OrbitFailure> {
        let shots = |zone: usize| (0..self.orbit.shots(zone)).map(move |shot| (zone, shot));
        let all = (0..self.zones.len()).flat_map(shots);
        all.map(|(zone, shot)| self.shot(zone, shot, self.share(zone)))
            .collect()
    }

    /// The passages through the shots of a zone.
    ///
    /// # Errors
    /// One of them leaves the range of numbers.
    pub(super) fn shots_of(&self, zone: usize) -> Result<Vec<Passage<'_>>, OrbitFailure> {
        let shots = 0..self.orbit.shots(zone);
        shots
            .map(|shot| self.shot(zone, shot, self.share(zone)))
            .collect()
    }

    /// Those of a zone among the passages through all shots.
    pub(super) fn of_zone<'p, 'a>(
        &self,
        passages: &'p [Passage<'a>],
        zone: usize,
    ) -> &'p [Passage<'a>] {
        &passages[self.orbit.shots_before(zone)..self.orbit.shots_before(zone + 1)]
    }

    /// The states of a zone after this part of its duration, with their derivatives along a direction of the unknowns.
    fn at_part(&self, zone: usize, part: f64, direction: &Vector) -> Option<Vec<(f64, f64)>> {
        let passage = self.passage(zone, part * self.zones[zone].duration).ok()?;
        let states = self.orbit.states();
        let shots = self.orbit.shots(zone) as f64;
        let state = |state: usize| {
            let mut jet = passage.at_end(&Row::unit(passage.end.len(), state));
            // since the beginning of its shot it is another part of the duration than a whole shot
            jet.by_time *= shots * part - passage.shot as f64;
            let unit = self.orbit.setting.scales.states[state];
            let mut along = 0.0;
            self.spread(zone, &jet, unit.recip(), &mut |index, by| {
                along += by * direction[index];
            });
            (jet.value / unit, along)
        };
        Some((0..states).map(state).collect())
    }

    /// How much a motion grows along every zone of these shots. Where a flow is integrated, growth within a shot after decay
    /// before it is seen where `within` says so.
    pub(super) fn growths(&self, passages: &[Passage], within: bool) -> Vec<ZoneGrowth> {
        let of_zone = |zone: usize| {
            let (mut growth, mut here) = (ZoneGrowth::default(), 0.0_f64);
            for passage in self.of_zone(passages, zone) {
                let [whole, part] = self.growth(zone, passage, within);
                here = (here + whole).max(part);
                growth.of_shot = growth.of_shot.max(part);
                growth.of_zone = growth.of_zone.max(here);
            }
            growth
        };
        (0..self.zones.len()).map(of_zone).collect()
    }

    /// Growth over a shot, and the most over a part of it that ends with it or within.
    fn growth(&self, zone: usize, passage: &Passage, within: bool) -> [f64; 2] {
        let log = |flow: &Matrix| self.norm(flow).max(f64::MIN_POSITIVE).ln();
        let whole = log(&passage.forward());
        let (mode, number) = (self.mode(zone), self.orbit.sequence.zone(zone).mode);
        if mode.field.is_exact || !within {
            return [whole, whole];
        }
        let known = self.known(number, &passage.entry, passage.time).0;
        let states = mode.states;
        let begun = in_no_time(mode.field.base());
        let (mut flow, mut most) = (begun.clone(), whole);
        for stage in &known.stages {
            flow = moved(&stage.series, &flow, stage.time);
            let grown = log(&flow.0.view((0, 0), (states, states)).into_owned());
            most = most.max(grown);
            // what has decayed has no part in what grows from here
            if grown < 0.0 {
                flow = begun.clone();
            }
        }
        [whole, most]
    }

    /// The flows of the states along parts of an integrated shot, with ẋ at the beginning of each, where so much decays along it that its
    /// product has lost what decays most: of every part it is known.
    pub(super) fn parts_that_decay(
        &self,
        zone: usize,
        passage: &Passage,
    ) -> Option<Vec<(Matrix, Vector)>> {
        /// Determinants of a shot and of a part, beside the power of the largest entry that they are the sum of products of.
        const LOST: f64 = 1e-8;
        const PART: f64 = 1e-4;
        let (mode, number) = (self.mode(zone), self.orbit.sequence.zone(zone).mode);
        let states = mode.states;
        let of_states = |flow: &Matrix| flow.view((0, 0), (states, states)).into_owned();
        // units of the states leave the determinant as it is
        let loses = |flow: &Matrix, part: f64| {
            let size = self.norm(flow).powi(states as i32);
            of_states(flow).determinant().abs() < part * size
        };
        if mode.field.is_exact || !loses(&passage.flow, LOST) {
            return None;
        }
        let known = self.known(number, &passage.entry, passage.time).0;
        let begun = in_no_time(mode.field.base());
        let mut parts: Vec<(Matrix, Vector)> = Vec::new();
        let mut flow: Option<Derivatives> = None;
        for stage in &known.stages {
            let longer = flow.map(|flow| moved(&stage.series, &flow, stage.time));
            let longer = longer.filter(|(flow, _)| !loses(flow, PART));
            let next = longer.unwrap_or_else(|| {
                let rate = product(&mode.matrix.at, &stage.series.first());
                parts.push((Matrix::default(), rate.rows(0, states).into_owned()));
                moved(&stage.series, &begun, stage.time)
            });
            parts.last_mut()?.0 = of_states(&next.0);
            flow = Some(next);
        }
        Some(parts).filter(|parts| parts.len() > 1)
    }

    /// The largest entry of a flow, in units of the states.
    fn norm(&self, flow: &Matrix) -> f64 {
        let units = &self.orbit.setting.scales.states;
        let entries = (0..units.len()).flat_map(|row| (0..units.len()).map(move |c| (row, c)));
        entries
            .map(|(row, column)| flow[(row, column)].abs() * units[column] / units[row])
            .fold(0.0, f64::max)
    }
}
