//! The sequence that follows an event, by one rule.
//!
//! Where a margin is zero the orbit is cut open at that instant, between a mode before and a mode after it. Every
//! chain of exits from the one to the other that the state of the instant allows is a candidate: modes on the way
//! get zones of no length. Where both sides are one mode in one state, no switch at all is a candidate, too. Whether a
//! candidate solves its equations at the event, and whether it is admissible a step further on, decides.

use std::f64::consts::TAU;

use super::layout::{AffineOrbit, OrbitAt, ZonePoint};
use super::margin::{Margin, Watch};
use super::setting::OrbitFailure;
use super::signature::{Sequence, Way, Zone};
use super::{CLOSING, Critical, OrbitTermination};
use crate::affine::algebra::Algebra as _;
use crate::affine::dual::{Dual, Measured as _};
use crate::affine::mode::Row;
use crate::linalg::Vector;
use crate::orbit::{Candidate, Changes, EventType, Zones};

/// Zones of no length between two others, and how many ways with fewer are enough: where several contacts change at one instant
/// there are thousands.
const LONGEST: usize = 4;
const MANY: usize = 100;

/// A state of an event is known to 1e-13; what is zero there is smaller than this, in its own units, and what is not
/// is larger but for a second event nearby, which would then be tried too.
const NEAR: f64 = 1e-7;

/// A zone of a cycle that may become an orbit.
#[derive(Clone, Debug)]
struct Piece {
    zone: Zone,
    at: ZonePoint,
    /// Whether it has no length yet.
    nascent: bool,
}

/// An orbit cut open at one instant.
struct Opened {
    /// From just after the instant to just before it; the way in which the last one ends is open.
    pieces: Vec<Piece>,
    /// z at the instant, before any switch.
    z: Vector,
    /// Phase at the instant.
    phase: f64,
    /// Both sides are two parts of one zone: nothing new needs no switch.
    joined: bool,
    /// How far the states move in what is left out at the instant.
    moved: Vec<f64>,
}

/// A mode on the way, with the state in which it begins.
#[derive(Clone)]
struct Stage {
    mode: usize,
    state: Vec<f64>,
    /// How the stage before ends.
    way: Way,
}

/// Every candidate for the sequence beyond the zero of a margin.
pub fn candidates(
    orbit: &AffineOrbit,
    point: &Vector,
    margin: &Margin,
) -> Result<Vec<Candidate<AffineOrbit>>, OrbitFailure> {
    let at = orbit.at(point)?;
    let mut found: Vec<Candidate<AffineOrbit>> = Vec::new();
    let mut add = |pieces: Vec<Piece>| {
        let pieces = from_beginning(pieces);
        let sequence = Sequence(pieces.iter().map(|piece| piece.zone.clone()).collect());
        if sequence.is_rotation_of(&orbit.sequence) {
            return;
        }
        let Some(other) = orbit.with_sequence(sequence) else {
            return;
        };
        let zones: Vec<ZonePoint> = pieces.iter().map(|piece| piece.at.clone()).collect();
        let other = other.keeping(&zones[0].state);
        let point = other.pack(&zones, &at.values);
        let nascent = (0..pieces.len())
            .filter(|index| pieces[*index].nascent)
            .collect();
        let candidate = Candidate {
            orbit: other,
            point,
            nascent,
        };
        let known = |one: &Candidate<AffineOrbit>| {
            one.orbit == candidate.orbit && one.nascent == candidate.nascent
        };
        if !found.iter().any(known) {
            found.push(candidate);
        }
    };
    for opened in at.open(margin)? {
        for pieces in at.closed(&opened) {
            add(pieces);
        }
    }
    Ok(found)
}

impl AffineOrbit {
    /// Whether a guard that is zero as a zone begins leads back to there: beyond the event no time passes any more.
    pub(super) fn held_at(&self, point: &Vector, margin: &Margin) -> Option<OrbitTermination> {
        let at = self.at(point).ok()?;
        let Watch::Onset(guard) = margin.watch else {
            return None;
        };
        let Zone { mode, name, .. } = self.sequence.zone(margin.zone);
        let exits = at.exits(*mode, &at.entry(margin.zone));
        let back = |stage: &Stage| {
            let state = Vector::from_column_slice(&stage.state);
            stage.way.guard == guard
                && stage.mode == *mode
                && at.agree(&state, &at.zones[margin.zone].state, &[])
        };
        exits.iter().any(back).then(|| OrbitTermination::Held {
            guard: self.setting.system.guard_name(*mode, guard),
            mode: name.clone(),
        })
    }
}

impl Changes for AffineOrbit {
    type Remark = Critical;

    fn candidates(
        &self,
        point: &Vector,
        margin: &Margin,
    ) -> Result<Vec<Candidate<AffineOrbit>>, OrbitFailure> {
        if self.lasts_no_time(point) {
            return Ok(Vec::new());
        }
        candidates(self, point, margin)
    }

    /// The same from either side: a zone that is split by a touch from inside merges on the way back.
    fn classify(before: &Sequence, after: Option<&Sequence>, margin: &Margin) -> EventType {
        if matches!(margin.watch, Watch::Inside(_) | Watch::Speed) {
            return EventType::GR;
        }
        match after {
            Some(after) if before.is_split_in(after) || after.is_split_in(before) => EventType::GR,
            Some(after) if before.leads_elsewhere(after) => EventType::SL,
            Some(_) => EventType::CO,
            None => match margin.watch {
                Watch::Condition(_) | Watch::Before(_) => EventType::SL,
                _ => EventType::CO,
            },
        }
    }

    /// The orbit by motions; `None` where they do not tell.
    fn beside(&self, point: &Vector, side: f64) -> Option<Candidate<AffineOrbit>> {
        self.by_motions_beside(point, side)
    }

    fn opens(&self, point: &Vector) -> bool {
        (0..self.zones()).any(|zone| point[self.duration_index(zone)] == 0.0)
    }

    fn closes(&self, point: &Vector) -> bool {
        (0..self.zones()).any(|zone| point[self.duration_index(zone)].abs() <= CLOSING)
    }
}

/// Rotates a cycle so that it begins where its name does; where it repeats itself the longest zone keeps the origin
/// steady.
fn from_beginning(mut pieces: Vec<Piece>) -> Vec<Piece> {
    let sequence = Sequence(pieces.iter().map(|piece| piece.zone.clone()).collect());
    let duration = |index: &usize| pieces[*index].at.duration;
    let beginnings = sequence.beginnings().into_iter();
    let start = beginnings.max_by(|one, other| duration(one).total_cmp(&duration(other)));
    pieces.rotate_left(start.unwrap_or(0));
    pieces
}

impl OrbitAt<'_> {
    fn piece(&self, zone: usize) -> Piece {
        let count = self.zones.len();
        Piece {
            zone: self.orbit.sequence.zone(zone).clone(),
            at: self.zones[zone % count].clone(),
            // one of two that open at one event
            nascent: self.zones[zone % count].duration == 0.0,
        }
    }

    /// The cycles that join the two sides of an orbit cut open, without a switch or by a chain of exits.
    fn closed(&self, opened: &Opened) -> Vec<Vec<Piece>> {
        let Some((first, last)) = opened.pieces.first().zip(opened.pieces.last()) else {
            return Vec::new();
        };
        let mut cycles = Vec::new();
        let same = first.zone.mode == last.zone.mode
            && self.agree(&opened.z, &first.at.state, &opened.moved);
        // without forcing what switches no more rests, or is one of a family that the parameter does not tell apart,
        // where the mode is linear
        let family = self.posed.system.modes[first.zone.mode].field.is_exact;
        let alone = opened.pieces.len() == 1 && self.orbit.has_own_period() && family;
        if same && !opened.joined && !alone {
            cycles.push(self.merged(&opened.pieces));
        }
        for chain in self.chains(last.zone.mode, opened, &first.at.state, first.zone.mode) {
            let mut pieces = opened.pieces.clone();
            for (index, stage) in chain.iter().enumerate() {
                if let Some(last) = pieces.last_mut() {
                    last.zone.way = Some(stage.way);
                }
                if index + 1 < chain.len() {
                    pieces.push(self.nascent(stage, opened.phase));
                }
            }
            cycles.push(pieces);
        }
        cycles
    }

    /// The zone of a mode on the way, which has no length yet.
    fn nascent(&self, stage: &Stage, phase: f64) -> Piece {
        let name = self.orbit.setting.system.mode_name(stage.mode).into_owned();
        Piece {
            zone: Zone::new(stage.mode, None, name),
            at: ZonePoint::new(stage.state.clone(), 0.0, phase),
            nascent: true,
        }
    }

    /// The orbit cut open where a margin is zero; also without the zones beside that instant that have come to no
    /// length by then, since zones may vanish together. Empty where nothing is left.
    fn open(&self, margin: &Margin) -> Result<Vec<Opened>, OrbitFailure> {
        let count = self.zones.len();
        let zone = margin.zone;
        // the zone before the instant, how many vanish there, and how many are left
        let (before, vanishing) = match margin.watch {
            Watch::Inside(_) => return Ok(vec![self.opened_within(zone, margin.time)?]),
            Watch::Duration => (zone + count - 1, 1),
            Watch::Onset(_) => (zone + count - 1, 0),
            Watch::End(_) | Watch::Speed | Watch::Condition(_) | Watch::Before(_) => (zone, 0),
        };
        let scale = self.orbit.setting.scales.time;
        let vanishes = |zone: &usize| self.zones[zone % count].duration.abs() <= CLOSING * scale;
        let further = (0..count)
            .map(|back| before + count - back)
            .take_while(vanishes)
            .count();
        let later = (before + 1 + vanishing..before + 1 + count)
            .take_while(vanishes)
            .count();
        let mut opened = Vec::new();
        for (back, vanishing) in [(0, vanishing), (further, vanishing + further + later)] {
            let known = opened.len() == 1 && further + later == 0;
            if vanishing < count && !known {
                let before = before + count - back;
                opened.push(self.opened_between(before, vanishing)?);
            }
        }
        Ok(opened)
    }

    /// The orbit cut open at the end of a zone, without so many zones that follow.
    fn opened_between(&self, before: usize, vanishing: usize) -> Result<Opened, OrbitFailure> {
        let count = self.zones.len();
        let first = before + 1 + vanishing;
        let before = before % count;
        let ends = &self.zones[before];
        Ok(Opened {
            pieces: (first..first + count - vanishing)
                .map(|zone| self.piece(zone))
                .collect(),
            z: self.passage(before, ends.duration)?.end,
            phase: ends.phase + self.posed.system.omega.value * ends.duration,
            joined: false,
            moved: self.moved((first - vanishing..first).map(|zone| zone % count))?,
        })
    }

    /// The orbit cut open within a zone.
    fn opened_within(&self, zone: usize, time: f64) -> Result<Opened, OrbitFailure> {
        let count = self.zones.len();
        let z = self.passage(zone, time)?.end;
        let phase = self.zones[zone].phase + self.posed.system.omega.value * time;
        let mut second = self.piece(zone);
        second.at.state = z.rows(0, self.orbit.states()).iter().copied().collect();
        second.at.phase = phase;
        second.at.inner.clear();
        let mut pieces = vec![second];
        if self.orbit.sequence.zone(zone).way.is_some() {
            pieces[0].at.duration -= time;
            pieces.extend((zone + 1..zone + count).map(|zone| self.piece(zone)));
            let mut first = self.piece(zone);
            first.at.duration = time;
            first.at.inner.clear();
            pieces.push(first);
        }
        Ok(Opened {
            pieces,
            z,
            phase,
            joined: true,
            moved: Vec::new(),
        })
    }

    /// Whether z has these states, but for what they have moved by.
    fn agree(&self, z: &Vector, state: &[f64], moved: &[f64]) -> bool {
        let units = &self.orbit.setting.scales.states;
        let moved = moved.iter().chain(std::iter::repeat(&0.0));
        let mut pairs = z.iter().zip(state).zip(units).zip(moved);
        pairs.all(|(((one, other), unit), moved)| (one - other).abs() <= NEAR * unit + moved)
    }

    /// How far the states move in zones that are left out since they have come to no length.
    fn moved(&self, zones: impl Iterator<Item = usize>) -> Result<Vec<f64>, OrbitFailure> {
        let mut moved = vec![0.0; self.orbit.states()];
        for zone in zones {
            let ZonePoint {
                state, duration, ..
            } = &self.zones[zone];
            let end = self.passage(zone, *duration)?.end;
            for (moved, (end, begun)) in moved.iter_mut().zip(end.iter().zip(state)) {
                *moved += (end - begun).abs();
            }
        }
        Ok(moved)
    }

    /// A form in its own units.
    fn relative(&self, row: &Row, z: &Vector) -> f64 {
        row.value(z) / self.orbit.size(row)
    }

    /// Every chain of exits from a mode to a mode and a state at an instant.
    fn chains(&self, from: usize, opened: &Opened, state: &[f64], to: usize) -> Vec<Vec<Stage>> {
        let mut found = Vec::new();
        let mut open: Vec<Vec<Stage>> = vec![Vec::new()];
        for _ in 0..=LONGEST {
            if found.len() >= MANY {
                break;
            }
            let mut longer = Vec::new();
            for chain in open {
                let (mode, z) = match chain.last() {
                    None => (from, opened.z.clone()),
                    Some(stage) => (
                        stage.mode,
                        self.posed
                            .system
                            .lift(stage.mode, &stage.state, opened.phase),
                    ),
                };
                for stage in self.exits(mode, &z) {
                    let there = Vector::from_column_slice(&stage.state);
                    // a mode that begins twice in one state leads on as it did before
                    let again =
                        |one: &Stage| one.mode == stage.mode && self.agree(&there, &one.state, &[]);
                    let repeats = chain.iter().any(again);
                    let mut chain = chain.clone();
                    chain.push(stage.clone());
                    if stage.mode == to && self.agree(&there, state, &opened.moved) {
                        found.push(chain.clone());
                    }
                    if !repeats {
                        longer.push(chain);
                    }
                }
            }
            open = longer;
        }
        found
    }

    /// Every exit that a state allows. Of guards that are one form, as where two contacts have one slip, the first has it: which of
    /// them is said to vanish makes no other sequence.
    fn exits(&self, mode: usize, z: &Vector) -> Vec<Stage> {
        let known = &self.posed.system.modes[mode];
        let mut z = z.clone();
        known.field.complete_at_switch(&mut z);
        let z = &z;
        let guards = known.guards.iter().enumerate();
        let mut stages: Vec<Stage> = Vec::new();
        for (guard, own) in guards {
            if self.relative(&own.row, z).abs() > NEAR {
                continue;
            }
            let is_one = |stage: &Stage| {
                stage.way.guard < guard && self.is_one(&known.guards[stage.way.guard].row, &own.row)
            };
            let taken = own.exits.iter().enumerate();
            for (exit, own) in taken.filter(|(_, exit)| exit.refusal.is_none()) {
                let state: Vec<f64> = (0..self.orbit.states())
                    .map(|state| own.reset.value(state, z))
                    .collect();
                let leads_there = |stage: &Stage| stage.mode == own.to && stage.state == state;
                let has = stages
                    .iter()
                    .any(|stage| leads_there(stage) && is_one(stage));
                let mut conditions = own.conditions.iter();
                if !has && conditions.all(|row| self.relative(row, z) >= -NEAR) {
                    stages.push(Stage {
                        mode: own.to,
                        state,
                        way: Way { guard, exit },
                    });
                }
            }
        }
        stages
    }

    /// Whether a form is a positive multiple of another.
    fn is_one(&self, one: &Row, other: &Row) -> bool {
        let [size, other_size] = [one, other].map(|row| self.orbit.size(row));
        let mut left = one.clone();
        left.subtract(Dual::number(size / other_size), other);
        self.orbit.size(&left) <= Dual::SAME * size
    }

    /// The cycle without a switch at the instant.
    fn merged(&self, pieces: &[Piece]) -> Vec<Piece> {
        let mut rest = pieces[1..].to_vec();
        let first = &pieces[0];
        if let Some(last) = rest.last_mut() {
            last.at.duration += first.at.duration;
            last.at.inner.clear();
            last.zone.way = first.zone.way;
            return rest;
        }
        // nothing switches any more: the phase begins at 0
        let mut only = first.clone();
        only.zone.way = None;
        let flow = self.posed.flow(only.zone.mode);
        let z = self
            .posed
            .system
            .lift(only.zone.mode, &only.at.state, only.at.phase);
        let omega = self.posed.system.omega.value;
        let time = if omega > 0.0 {
            (TAU - only.at.phase.rem_euclid(TAU)) / omega
        } else {
            let section = self.orbit.section(&self.posed.system.modes[only.zone.mode]);
            self.posed
                .to_section(only.zone.mode, section, &z, only.at.duration)
        };
        let z = flow.after(&z, time);
        only.at.state = z.rows(0, self.orbit.states()).iter().copied().collect();
        only.at.phase = 0.0;
        only.at.inner.clear();
        vec![only]
    }
}
