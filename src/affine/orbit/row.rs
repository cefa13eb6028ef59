//! What results keep of an orbit: its modes in order of time, its switches, samples of it, and numbers from which it
//! is found again.

use std::f64::consts::TAU;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::OrbitTermination;
use super::layout::{AffineOrbit, ZonePoint};
use super::setting::{OrbitFailure, Setting};
use super::signature::{Sequence, Zone};
use crate::affine::flow::ModeFlow;
use crate::affine::mode::AffineSystem;
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::Zones;

/// An orbit in order of time, from the entry of the first mode of the file that occurs: that of the earliest phase in
/// \[0, 2π) where there are several, or without forcing that with which the names come first in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Names of the modes, one for each zone.
    pub names: Vec<String>,
    /// Its period.
    pub period: f64,
    /// Times of the switches since the first: none for an orbit that never switches.
    pub switches: Vec<f64>,
    /// Zone of the orbit with which it begins.
    pub first: usize,
}

/// A moment of an orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitSample {
    /// Time since the orbit's first switch.
    pub time: f64,
    /// Phase of the forcing in \[0, 2π); zero without.
    pub phase: f64,
    /// States.
    pub state: Vec<f64>,
    /// Number of the mode.
    pub mode: usize,
}

/// An orbit in physical numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedOrbit {
    /// Its zones.
    pub sequence: Sequence,
    /// Where they begin and how long they last.
    pub zones: Vec<ZonePoint>,
    /// Forcing periods in it.
    pub periods: u32,
    /// Values of all parameters in the order of the file.
    pub values: Vec<f64>,
    /// Of a branch point, what is beside it along the branch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beside: Option<OrbitBeside>,
}

/// An orbit beside another along their branch, to first order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitBeside {
    /// Where its zones begin and how long they last.
    pub zones: Vec<ZonePoint>,
    /// Values of all parameters in the order of the file.
    pub values: Vec<f64>,
}

impl SavedOrbit {
    /// Its zones with their places; `None` where one lacks the other.
    pub(super) fn parts(&self) -> Option<Vec<(Zone, ZonePoint)>> {
        let parts = self.sequence.0.iter().cloned();
        let fits = self.zones.len() == self.sequence.len();
        fits.then(|| parts.zip(self.zones.iter().cloned()).collect())
    }

    /// States where the phase of the forcing is zero, one for each of its periods; none without.
    pub fn strobes(&self, system: &AffineSystem) -> Vec<Vec<f64>> {
        let omega = system.omega.value;
        let mut phase = self.zones.first().map_or(0.0, |zone| zone.phase);
        let mut strobes = Vec::new();
        if omega <= 0.0 {
            return strobes;
        }
        for (zone, at) in self.sequence.0.iter().zip(&self.zones) {
            let mode = &system.modes[zone.mode];
            let flow = ModeFlow::new(mode, at.duration);
            let z = system.lift(zone.mode, &at.state, at.phase);
            // where the phases of a zone end those of the next begin, so that each is met once
            let end = phase + omega * at.duration;
            let mut next = (phase / TAU).ceil() * TAU;
            while next < end && strobes.len() < self.periods as usize {
                let after = flow.after(&z, (next - phase) / omega);
                strobes.push(after.rows(0, system.states).iter().copied().collect());
                next += TAU;
            }
            phase = end;
        }
        strobes
    }

    /// The first of so many equal parts.
    pub(super) fn part(&self, times: usize) -> SavedOrbit {
        let (sequence, zones) = first_of(times, &self.sequence, &self.zones);
        SavedOrbit {
            sequence,
            zones,
            periods: (self.periods / times as u32).max(1),
            values: self.values.clone(),
            beside: None,
        }
    }
}

/// The first of so many equal parts of a cycle: of one that never switches, of its only zone.
pub fn first_of(
    times: usize,
    sequence: &Sequence,
    zones: &[ZonePoint],
) -> (Sequence, Vec<ZonePoint>) {
    let (mut sequence, mut zones) = (sequence.clone(), zones.to_vec());
    if sequence.switches() == 0 {
        let parts = zones.iter_mut();
        parts.for_each(|zone| {
            zone.duration /= times as f64;
            zone.inner.clear();
        });
    } else {
        let count = zones.len() / times;
        sequence.0.truncate(count);
        zones.truncate(count);
    }
    (sequence, zones)
}

/// The zones of a cycle traversed twice. One that never switches is one zone, however long.
pub(super) fn twice(sequence: &Sequence, zones: &mut Vec<ZonePoint>) {
    match &mut zones[..] {
        [zone] if sequence.switches() == 0 => {
            zone.duration *= 2.0;
            zone.inner.clear();
        }
        _ => zones.extend_from_within(..),
    }
}

/// Parts of an orbit are one another's repetition where nothing differs by more than this in its own units: the
/// parameter differs by the square of it, and the equations are singular there, so that the place is not known better.
const REPEATED: f64 = 1e-3;

impl AffineOrbit {
    /// The orbit at a point in order of time.
    ///
    /// # Errors
    /// The system makes no sense there.
    pub fn cycle(&self, point: &Vector) -> Result<Cycle, OrbitFailure> {
        let zones = self.at(point)?.zones;
        let count = zones.len();
        let mode = |zone: &usize| self.sequence.zone(*zone).mode;
        let least = (0..count).map(|zone| mode(&zone)).min();
        // two zones that have one name are one
        let begins = |zone: usize| self.sequence.is_told((zone + count - 1) % count);
        let beginning = |zone: usize| {
            let mut before = (0..count).map(|index| (zone + count - index) % count);
            before.find(|zone| begins(*zone)).unwrap_or(zone)
        };
        let first = if self.is_forced() {
            let of_first = (0..count).filter(|zone| Some(mode(zone)) == least);
            let of_first = of_first.map(beginning);
            let phase = |zone: &usize| zones[*zone].phase.rem_euclid(TAU);
            of_first.min_by(|one, other| phase(one).total_cmp(&phase(other)))
        } else {
            let first = self.sequence.beginnings().first().copied();
            first.map(beginning)
        };
        let first = first.unwrap_or(0);
        let order = (0..count).map(|index| (first + index) % count);
        let mut time = 0.0;
        let mut switches = Vec::with_capacity(count);
        for zone in order.clone() {
            if begins(zone) {
                switches.push(time);
            }
            time += zones[zone].duration;
        }
        switches.truncate(self.sequence.switches());
        Ok(Cycle {
            names: order
                .filter(|zone| self.sequence.is_told(*zone))
                .map(|zone| self.sequence.zone(zone).to_string())
                .collect(),
            period: time,
            switches,
            first,
        })
    }

    /// The orbit at so many even intervals of every zone, ends and entries both: states jump where they are reset. Where a flow
    /// is integrated there are more where its pieces are short.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn samples(
        &self,
        point: &Vector,
        intervals: usize,
    ) -> Result<Vec<OrbitSample>, OrbitFailure> {
        let first = self.cycle(point)?.first;
        let at = self.at(point)?;
        let omega = at.posed.system.omega.value;
        let mut samples = Vec::with_capacity(self.zones() * (intervals + 1));
        let mut begun = 0.0;
        for zone in (first..first + self.zones()).map(|zone| zone % self.zones()) {
            let ZonePoint {
                duration, phase, ..
            } = at.zones[zone];
            let mode = self.sequence.zone(zone).mode;
            let times = at.times(zone, intervals)?;
            for (time, z) in times.iter().zip(at.along(zone, times.iter().copied())?) {
                samples.push(OrbitSample {
                    time: begun + time,
                    phase: (phase + omega * time).rem_euclid(TAU),
                    state: z.rows(0, self.states()).iter().copied().collect(),
                    mode,
                });
            }
            begun += duration;
        }
        Ok(samples)
    }

    /// The orbit at a point in physical numbers.
    ///
    /// # Errors
    /// The system makes no sense there.
    pub fn saved(&self, point: &Vector) -> Result<SavedOrbit, OrbitFailure> {
        Ok(SavedOrbit {
            sequence: self.sequence.clone(),
            zones: self.at(point)?.zones,
            periods: self.setting.periods,
            values: self.values_at(point),
            beside: None,
        })
    }

    /// What is beside an orbit along the branch, to first order.
    ///
    /// # Errors
    /// The system makes no sense there.
    pub fn beside(&self, node: &Node) -> Result<OrbitBeside, OrbitFailure> {
        /// So far that differences have nine digits, and so little that the system makes sense where it does at the orbit.
        const BESIDE: f64 = 1e-6;
        let point = &node.point + &node.tangent * BESIDE;
        Ok(OrbitBeside {
            zones: self.at(&point)?.zones,
            values: self.values_at(&point),
        })
    }

    /// The direction in which that lies, of whatever length; `None` where it is none of these orbits.
    pub fn direction_to(&self, at: &Vector, beside: &OrbitBeside) -> Option<Vector> {
        let states = self.states();
        let fits = beside.zones.len() == self.zones()
            && beside.zones.iter().all(|zone| zone.state.len() == states)
            && beside.values.len() == self.setting.values.len();
        if !fits {
            return None;
        }
        let mut direction = self.pack(&beside.zones, &beside.values) - at;
        if let Some(phase) = self.phase_index() {
            direction[phase] -= (direction[phase] / TAU).round() * TAU;
        }
        direction.try_normalize(0.0)
    }

    /// Whether an orbit without forcing and switches is a point but for a small part of its units.
    pub fn is_point(&self, point: &Vector) -> bool {
        let rests = !self.is_forced() && self.sequence.switches() == 0;
        rests && self.varies_within(point, REPEATED)
    }

    /// Whether every state varies by no more than this part of its unit.
    pub(super) fn varies_within(&self, point: &Vector, most: f64) -> bool {
        self.extent(point).is_some_and(|size| size <= most)
    }

    /// The largest range of a state over the period, in units of the states.
    pub(super) fn extent(&self, point: &Vector) -> Option<f64> {
        let extremes = self.extremes(point).ok()?;
        let ranges = extremes.iter().zip(&self.setting.scales.states);
        Some(
            ranges
                .map(|((low, high), unit)| (high - low) / unit)
                .fold(0.0, f64::max),
        )
    }

    /// The same where it is at most this.
    pub fn extent_within(&self, point: &Vector, most: f64) -> Option<f64> {
        /// How much further an orbit may be than its size in the time of its period at the speed with which it begins.
        const SLOW: f64 = 1e3;
        let (n, width) = (self.states(), self.width());
        let units = &self.setting.scales.states;
        // most orbits go far on the way to the next entry, or set out fast: that costs little to see
        let entry = |zone: usize| point.rows(width * zone, n);
        let may_be = if self.zones() > 1 {
            let others = &mut (1..self.zones());
            others.all(|zone| (entry(zone) - entry(0)).amax() <= most)
        } else {
            let at = self.at(point).ok()?;
            let (duration, rate) = (at.zones[0].duration, &at.mode(0).matrix.at * at.entry(0));
            (0..n).all(|state| (duration * rate[state] / units[state]).abs() <= SLOW * most)
        };
        may_be
            .then(|| self.extent(point))
            .flatten()
            .filter(|size| *size <= most)
    }

    /// The orbit of half the period that this one is when traversed twice, with its stability, and its unknowns.
    pub(super) fn half(&self, point: &Vector) -> Option<(AffineOrbit, Vector)> {
        if self.setting.prescribed.is_some() || self.traversals(point) != 2 {
            return None;
        }
        let setting = Setting {
            periods: if self.is_forced() {
                self.setting.periods / 2
            } else {
                self.setting.periods
            },
            stability: true,
            ..(*self.setting).clone()
        };
        let (sequence, zones) = first_of(2, &self.sequence, &self.at(point).ok()?.zones);
        let half = AffineOrbit::new(Arc::new(setting), sequence)?;
        let point = half.pack(&zones, &self.values_at(point));
        Some((half, point))
    }

    /// Whether another orbit may be the image of this one under a symmetry: what that leaves alone is the same. Beside a
    /// fold a multiplier is as far from 1 on one side as on the other, and as far from that on the other side.
    pub(super) fn has_image(&self, point: &Vector, other: &AffineOrbit, of_other: &Vector) -> bool {
        /// Durations in units of the period, and multipliers by their distance from 1, are the same to this.
        const ALIKE: f64 = 1e-6;
        const SAME: f64 = 1e-3;
        let durations = |orbit: &AffineOrbit, point: &Vector| {
            let zones = 0..orbit.zones();
            let mut all: Vec<f64> = zones
                .map(|zone| point[orbit.duration_index(zone)])
                .collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let (one, two) = (durations(self, point), durations(other, of_other));
        let mut pairs = one.iter().zip(&two);
        if one.len() != two.len() || !pairs.all(|(one, two)| (one - two).abs() <= ALIKE) {
            return false;
        }
        let (Ok(one), Ok(two)) = (self.multipliers(point), other.multipliers(of_other)) else {
            return false;
        };
        let mut pairs = one.iter().zip(&two);
        one.len() == two.len()
            && one.iter().any(|multiplier| !multiplier.trivial)
            && pairs
                .all(|(one, two)| (one.value - two.value).norm() <= SAME * (one.value - 1.0).norm())
    }

    /// Zones of one mode in a row whose durations fall geometrically, down to next to nothing.
    pub(super) fn accumulates(&self, point: &Vector) -> Option<OrbitTermination> {
        /// Zones that tell a ratio, which is one that repeats itself but for this part.
        const LEAST: usize = 8;
        const ALIKE: f64 = 0.2;
        /// The last lasts less than this part of the period: what a flight of that length rises by is its square,
        /// and how fast that falls at its end is rounding.
        const NOTHING: f64 = 1e-4;
        let count = self.zones();
        if count <= LEAST {
            return None;
        }
        let duration = |zone: usize| point[self.width() * (zone % count) + self.states()];
        let period: f64 = (0..count).map(duration).sum();
        let order = |one: &usize, other: &usize| duration(*one).total_cmp(&duration(*other));
        let last = (0..count).min_by(order)?;
        let before = |back: usize| (last + 2 * count - back) % count;
        let ratio = |back: usize| duration(before(back)) / duration(before(back + 1));
        // the last of all is the one that rounding decides
        let settled = ratio(1);
        let falls = |back: &usize| {
            let alike = (ratio(*back) / settled - 1.0).abs() <= ALIKE;
            alike && self.sequence.zone(before(*back)).mode == self.sequence.zone(last).mode
        };
        let zones = (1..count).take_while(falls).count();
        let found = zones >= LEAST && settled < 1.0 && duration(last) <= NOTHING * period;
        // of all: near a graze the last few are longer than their share
        let all = duration(before(1)) / duration(before(zones + 1));
        found.then(|| OrbitTermination::Accumulates {
            zones,
            ratio: all.powf((zones as f64).recip()),
        })
    }

    /// How many times a shorter orbit is traversed: 1 unless parts of the orbit are the same, states and durations.
    pub fn traversals(&self, point: &Vector) -> usize {
        self.traversals_within(point, REPEATED)
    }

    /// The same, of parts that differ by no more than this in their own units.
    pub(super) fn traversals_within(&self, point: &Vector, most: f64) -> usize {
        if self.sequence.switches() == 0 {
            return self.turns_within(point, most);
        }
        let (count, width) = (self.zones(), self.width());
        let periods = self.setting.periods as usize;
        let fits = |times: &usize| {
            count.is_multiple_of(*times) && (!self.is_forced() || periods.is_multiple_of(*times))
        };
        let same = |times: &usize| {
            let shift = count / times;
            let alike = |zone: usize| {
                let other = (zone + shift) % count;
                let numbers = 0..width;
                self.sequence.zone(zone) == self.sequence.zone(other)
                    && numbers.into_iter().all(|index| {
                        let off = point[width * zone + index] - point[width * other + index];
                        off.abs() <= most
                    })
            };
            (0..count).all(alike)
        };
        (2..=count).rev().filter(fits).find(same).unwrap_or(1)
    }

    /// How many times a shorter orbit is traversed by one that never switches, of parts that differ by no more than this.
    fn turns_within(&self, point: &Vector, most: f64) -> usize {
        /// A guess without forcing may go round so often.
        const ROUND: usize = 8;
        let Ok(at) = self.at(point) else {
            return 1;
        };
        let (zone, units) = (&at.zones[0], &self.setting.scales.states);
        let returns = |times: &usize| {
            let end = at.passage(0, zone.duration / *times as f64);
            end.is_ok_and(|passage| {
                let mut states = passage.end.iter().zip(&zone.state).zip(units);
                states.all(|((one, other), unit)| (one - other).abs() <= most * unit)
            })
        };
        let periods = match self.is_forced() {
            true => self.setting.periods as usize,
            false => ROUND,
        };
        let mut parts = (2..=periods)
            .rev()
            .filter(|times| !self.is_forced() || periods.is_multiple_of(*times));
        parts.find(returns).unwrap_or(1)
    }
}
