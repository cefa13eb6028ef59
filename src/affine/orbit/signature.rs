//! The sequence of zones of an orbit.

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

use serde::{Deserialize, Serialize};

use crate::affine::mode::{AffineSystem, Exit};

/// The way a zone ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Way {
    /// The guard that is zero, by its number in the mode.
    pub guard: usize,
    /// The exit taken, by its number in the guard.
    pub exit: usize,
}

/// What a zone carries and is no part of what it is: no two zones differ in that.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Carried<T>(T);

impl<T> PartialEq for Carried<T> {
    fn eq(&self, _: &Carried<T>) -> bool {
        true
    }
}

impl<T> Eq for Carried<T> {}

impl<T> Hash for Carried<T> {
    fn hash<H: Hasher>(&self, _: &mut H) {}
}

impl<T> PartialOrd for Carried<T> {
    fn partial_cmp(&self, other: &Carried<T>) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Carried<T> {
    fn cmp(&self, _: &Carried<T>) -> Ordering {
        Ordering::Equal
    }
}

impl<T: Default + PartialEq> Carried<T> {
    fn is_default(&self) -> bool {
        self.0 == T::default()
    }
}

/// A zone: a mode, and how it ends.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Zone {
    /// Number of the mode.
    pub mode: usize,
    /// `None` where the orbit never switches.
    pub way: Option<Way>,
    /// Name of the mode.
    pub name: String,
    /// Name of the switch that it ends with, where the file gives one and a mode of the same name goes on: see
    /// [`Sequence::labelled`].
    #[serde(default, skip_serializing_if = "Carried::is_default")]
    pub label: Carried<Option<String>>,
    /// Of the first zone, where sums of states never change along a sequence: the states that they have at its beginning.
    #[serde(default, skip_serializing_if = "Carried::is_default")]
    pub kept: Carried<Vec<f64>>,
    /// How many shots it is gone through in beyond the first: see [`super::shots`].
    #[serde(default, skip_serializing_if = "Carried::is_default")]
    pub further: Carried<u32>,
    /// Of an orbit that neither switches nor is forced: the state that is greatest where it begins, where that is no more the one of the
    /// first orbit.
    #[serde(default, skip_serializing_if = "Carried::is_default")]
    pub section: Carried<Option<u8>>,
}

impl Zone {
    /// Of a mode with this name, and how it ends.
    pub fn new(mode: usize, way: Option<Way>, name: String) -> Zone {
        Zone {
            mode,
            way,
            name,
            label: Carried::default(),
            kept: Carried::default(),
            further: Carried::default(),
            section: Carried::default(),
        }
    }

    /// How many shots it is gone through in.
    pub fn shots(&self) -> usize {
        1 + self.further.0 as usize
    }

    /// The same zone gone through in so many shots, one at least.
    pub fn in_shots(mut self, shots: usize) -> Zone {
        self.further = Carried(u32::try_from(shots.saturating_sub(1)).unwrap_or(u32::MAX));
        self
    }

    /// The state that is greatest where it begins, where another one was where the first orbit begins.
    pub fn section(&self) -> Option<usize> {
        self.section.0.map(usize::from)
    }

    /// The same zone begun where this state is greatest.
    pub fn begun_where(mut self, state: usize) -> Zone {
        self.section = Carried(u8::try_from(state).ok());
        self
    }

    /// Whether its label is this one.
    pub fn has_label(&self, label: Option<&str>) -> bool {
        self.label.0.as_deref() == label
    }
}

/// The mode, with the switch that leads from it to itself where that has a name: `free(hit)`.
impl fmt::Display for Zone {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.name)?;
        match self.label.0.as_ref().filter(|_| self.way.is_some()) {
            Some(label) => write!(formatter, "({label})"),
            None => Ok(()),
        }
    }
}

/// A zone at a point, in physical units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ZonePoint {
    /// States at its entry.
    pub state: Vec<f64>,
    /// Its duration.
    pub duration: f64,
    /// Phase of the forcing at its entry; zero without.
    pub phase: f64,
    /// States at the beginnings of its further shots.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inner: Vec<Vec<f64>>,
}

impl ZonePoint {
    /// A zone of one shot.
    pub fn new(state: Vec<f64>, duration: f64, phase: f64) -> ZonePoint {
        ZonePoint {
            state,
            duration,
            phase,
            inner: Vec::new(),
        }
    }

    /// The states at the beginning of a shot.
    pub fn at_shot(&self, shot: usize) -> &[f64] {
        let further = shot.checked_sub(1).and_then(|index| self.inner.get(index));
        further.unwrap_or(&self.state)
    }
}

/// A cycle of zones; not empty.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Sequence(pub Vec<Zone>);

impl Sequence {
    /// Number of zones.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no zone.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// How many shots there are before every zone, and in all.
    pub(super) fn shots_before(&self) -> Vec<usize> {
        let mut all = Vec::with_capacity(self.len() + 1);
        all.push(0);
        let mut sum = 0;
        all.extend(self.0.iter().map(|zone| {
            sum += zone.shots();
            sum
        }));
        all
    }

    /// How many shots there are beyond the first ones.
    pub fn further_shots(&self) -> usize {
        self.0.iter().map(|zone| zone.further.0 as usize).sum()
    }

    /// The same sequence with every zone in one shot.
    pub fn in_whole_zones(&self) -> Sequence {
        Sequence(self.0.iter().map(|zone| zone.clone().in_shots(1)).collect())
    }

    /// Whether it is another sequence, in the same shots.
    pub fn has_unknowns_of(&self, other: &Sequence) -> bool {
        let mut pairs = self.0.iter().zip(&other.0);
        self == other && pairs.all(|(one, other)| one.further.0 == other.further.0)
    }

    /// Number of switches in a cycle.
    pub fn switches(&self) -> usize {
        self.0.iter().filter(|zone| zone.way.is_some()).count()
    }

    /// A zone, counted round the cycle.
    pub fn zone(&self, index: usize) -> &Zone {
        &self.0[index % self.0.len()]
    }

    /// The states that are kept of the start.
    pub fn kept(&self) -> &[f64] {
        self.0.first().map_or(&[], |zone| &zone.kept.0)
    }

    /// The same where these are.
    pub fn keeping(mut self, states: &[f64]) -> Sequence {
        for (index, zone) in self.0.iter_mut().enumerate() {
            zone.kept = Carried(if index == 0 {
                states.to_vec()
            } else {
                Vec::new()
            });
        }
        self
    }

    /// The same with the labels that the switches of a system give its zones.
    pub fn labelled(mut self, system: &AffineSystem) -> Sequence {
        for index in 0..self.len() {
            let says = self.zone(index).name == self.zone(index + 1).name;
            let exit = exit_of(system, &self, index).filter(|_| says);
            let label = exit.and_then(Exit::own_name).map(str::to_owned);
            self.0[index].label = Carried(label);
        }
        self
    }

    /// Whether a zone is told by its name: two modes of one name differ in nothing that a name tells, and are one where
    /// they follow one another by a switch without a name.
    pub fn is_told(&self, index: usize) -> bool {
        let (zone, next) = (self.zone(index), self.zone(index + 1));
        zone.name != next.name || zone.mode == next.mode || zone.label.0.is_some()
    }

    /// Whether another sequence is this one but for the zone it begins with.
    pub fn is_rotation_of(&self, other: &Sequence) -> bool {
        !self.rotations_to(other).is_empty()
    }

    /// Zones with which the sequence may begin and be another one; none where it is no rotation of that.
    pub fn rotations_to(&self, other: &Sequence) -> Vec<usize> {
        let count = self.len();
        let same = |shift: &usize| (0..count).all(|k| self.zone(k + shift) == other.zone(k));
        let shifts = 0..if count == other.len() { count } else { 0 };
        shifts.filter(same).collect()
    }

    /// Zones with which the name may begin, so that it comes first in the order of the modes: more than one
    /// where the sequence repeats itself.
    pub fn beginnings(&self) -> Vec<usize> {
        let count = self.len();
        let from = |start: usize| (0..count).map(move |k| self.zone(start + k));
        let modes = |start: usize| from(start).map(|zone| zone.mode);
        let ways = |start: usize| from(start).map(|zone| zone.way);
        let order = |one: &usize, other: &usize| {
            let first = modes(*one).cmp(modes(*other));
            first.then_with(|| ways(*one).cmp(ways(*other)))
        };
        let Some(best) = (0..count).min_by(order) else {
            return Vec::new();
        };
        let equal = |start: &usize| order(start, &best).is_eq();
        (0..count).filter(equal).collect()
    }

    /// Whether one zone of this sequence is split in the other: what stands between the two parts begins where a
    /// guard touches zero from inside.
    pub(super) fn is_split_in(&self, other: &Sequence) -> bool {
        let (short, long) = (self.len(), other.len());
        if short == 1 && self.zone(0).way.is_none() {
            return other.0.iter().any(|zone| zone.mode == self.zone(0).mode);
        }
        if short >= long {
            return false;
        }
        let more = long - short;
        let fits = |shift: usize, start: usize| {
            // zone `shift` of the short sequence is zones start..=start + more of the long one
            let split = self.zone(shift);
            other.zone(start).mode == split.mode
                && other.zone(start + more) == split
                && (1..short).all(|k| self.zone(shift + k) == other.zone(start + more + k))
        };
        (0..short).any(|shift| (0..long).any(|start| fits(shift, start)))
    }
}

/// The exit that a zone takes; `None` also for one that is not in the system.
pub fn exit_of<'a>(system: &'a AffineSystem, sequence: &Sequence, zone: usize) -> Option<&'a Exit> {
    let zone = sequence.zone(zone);
    let way = zone.way?;
    let guard = system.modes.get(zone.mode)?.guards.get(way.guard)?;
    guard.exits.get(way.exit)
}

impl Sequence {
    /// Whether a guard ends a mode as often in both sequences, but by other exits: a condition decides
    /// otherwise.
    pub(super) fn leads_elsewhere(&self, other: &Sequence) -> bool {
        let ways = |sequence: &Sequence| {
            let ways = sequence
                .0
                .iter()
                .filter_map(|zone| Some((zone.mode, zone.way?)));
            let mut ways: Vec<(usize, Way)> = ways.collect();
            ways.sort_unstable();
            ways
        };
        let (own, others) = (ways(self), ways(other));
        let of = |ways: &[(usize, Way)], mode: usize, guard: usize| -> Vec<usize> {
            let same = |one: &&(usize, Way)| (one.0, one.1.guard) == (mode, guard);
            ways.iter().filter(same).map(|one| one.1.exit).collect()
        };
        own.iter().any(|(mode, way)| {
            let (before, after) = (of(&own, *mode, way.guard), of(&others, *mode, way.guard));
            before.len() == after.len() && before != after
        })
    }
}

impl fmt::Display for Sequence {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = (0..self.len()).filter(|index| self.is_told(*index));
        for (place, index) in told.enumerate() {
            let dash = if place > 0 { "-" } else { "" };
            write!(formatter, "{dash}{}", self.zone(index))?;
        }
        Ok(())
    }
}
