//! Switches that a motion comes through, and the zones between them.

use super::failure::NoStart;
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Halt, Moment, Motion, Step, Switching};

/// Most switches of a motion that settles, of which each is kept in some hundred bytes.
const MOST_KEPT: usize = 4_000_000;

/// Most switches of one orbit.
pub(super) const MOST_SWITCHES: usize = 400;

/// Switches of a motion, each with the place where the next zone begins.
pub(in crate::affine::orbit) type Switches = Vec<(Switching, Moment)>;

/// The zones of a motion from a switch to the one that comes nearest to this time.
pub(super) fn from_switch(
    motion: &mut Motion,
    time: f64,
) -> Result<Vec<(Moment, Switching, f64)>, NoStart> {
    /// How much later than the time the switch may come.
    const LATE: f64 = 1.25;
    let begin = motion.place().clone();
    let switches = run(motion, begin.time + LATE * time)?;
    let off = |index: &usize| (switches[*index].0.time - begin.time - time).abs();
    let last = (0..switches.len()).min_by(|one, other| off(one).total_cmp(&off(other)));
    let last = last.ok_or(NoStart::Leaves { time: begin.time })?;
    if last >= MOST_SWITCHES {
        return Err(NoStart::Switches(last + 1));
    }
    let mut place = begin;
    let zones = switches
        .into_iter()
        .take(last + 1)
        .map(|(switching, next)| {
            let from = std::mem::replace(&mut place, next);
            let duration = switching.time - from.time;
            (from, switching, duration)
        });
    Ok(zones.collect())
}

/// Moves on to a time: the switches on the way.
pub(in crate::affine::orbit) fn run(motion: &mut Motion, until: f64) -> Result<Switches, NoStart> {
    let mut switches = Vec::new();
    let begin = motion.place().time;
    while switches.len() < MOST_KEPT {
        match motion.step(until).map_err(NoStart::Halted)? {
            Step::Reached | Step::Section => return Ok(switches),
            Step::Switched(switching) => switches.push((switching, motion.place().clone())),
        }
    }
    let time = motion.place().time;
    let piece = (time - begin) / MOST_KEPT as f64;
    Err(NoStart::Halted(Halt::Fast { time, piece }))
}

/// How a motion came to where it has settled.
pub(super) struct Settling {
    pub begin: Moment,
    pub switches: Switches,
    /// The largest value of every state where it begins, at its switches and at a last place, or what its rates make of a zone: on
    /// a surface a state may be zero at all of them.
    pub sizes: Vec<f64>,
}

impl Settling {
    /// Through switches to a last place.
    pub fn new(
        system: &AffineSystem,
        begin: Moment,
        switches: Switches,
        last: &Moment,
    ) -> Settling {
        let mut sizes: Vec<f64> = begin.state.iter().map(|x| x.abs()).collect();
        let ends = switches.iter().map(|(end, _)| (&end.before, end.time));
        let ends = ends.chain([(&last.state, last.time)]);
        let entries = std::iter::once(&begin).chain(switches.iter().map(|(_, place)| place));
        for (entry, (end, time)) in entries.zip(ends) {
            let moved = moved(system, entry, end, time);
            let states = entry.state.iter().zip(end).zip(moved);
            for (size, ((x, y), moved)) in sizes.iter_mut().zip(states) {
                *size = size.max(x.abs()).max(y.abs()).max(moved);
            }
        }
        Settling {
            begin,
            switches,
            sizes,
        }
    }

    /// Time of its last switch; zero where there was none.
    pub fn last_switch(&self) -> f64 {
        self.switches.last().map_or(0.0, |(last, _)| last.time)
    }

    /// Its zones.
    pub fn zones(&self) -> impl DoubleEndedIterator<Item = (&Moment, &Switching)> {
        zones(&self.begin, &self.switches)
    }
}

/// Entries and ends of the zones from a place through these switches.
pub(super) fn zones<'a>(
    begin: &'a Moment,
    switches: &'a [(Switching, Moment)],
) -> impl DoubleEndedIterator<Item = (&'a Moment, &'a Switching)> {
    (0..switches.len()).map(move |index| {
        let entry = index
            .checked_sub(1)
            .map_or(begin, |before| &switches[before].1);
        (entry, &switches[index].0)
    })
}

/// How far every state moves in a zone from its entry to an end at this time, or by its rate at the entry as long as that lasts.
pub(super) fn moved(system: &AffineSystem, entry: &Moment, end: &[f64], time: f64) -> Vec<f64> {
    let matrix = &system.modes[entry.mode].matrix.at;
    let rates = matrix * system.lift(entry.mode, &entry.state, entry.phase);
    let changes = matrix * &rates;
    let states = entry.state.iter().zip(end).zip(rates.iter().zip(&changes));
    let moved = states.map(|((x, y), (rate, change))| {
        let lasts = (rate / change).abs().min(time - entry.time);
        (y - x).abs().max(rate.abs() * lasts)
    });
    moved.collect()
}

/// The zones of a motion that has returned after `time` to where it was: from its first switch on.
pub(super) fn closed(mut switches: Switches, time: f64) -> Vec<(Moment, Switching, f64)> {
    let count = switches.len();
    switches.rotate_left(count.min(1));
    let ends = (0..count).map(|index| switches[index].0.clone());
    let zones = ends.enumerate().map(|(index, end)| {
        // entered by the switch before
        let (_, place) = &switches[(index + count - 1) % count];
        let wrapped = if index + 1 == count { time } else { 0.0 };
        (place.clone(), end.clone(), end.time - place.time + wrapped)
    });
    zones.collect()
}

/// Moves on to the next switch without forcing.
pub(super) fn next_switch(
    motion: &mut Motion,
    longest: f64,
) -> Result<(Switching, Moment), NoStart> {
    let since = motion.place().time;
    match motion.step(since + longest).map_err(NoStart::Halted)? {
        Step::Switched(switching) => Ok((switching, motion.place().clone())),
        Step::Reached | Step::Section => Err(NoStart::Leaves { time: since }),
    }
}
