//! Switches that a motion comes through, and the zones between them.

use super::failure::NoStart;
use crate::affine::motion::{Moment, Motion, Step, Switching};

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
    loop {
        match motion.step(until).map_err(NoStart::Halted)? {
            Step::Reached | Step::Section => return Ok(switches),
            Step::Switched(switching) => switches.push((switching, motion.place().clone())),
        }
    }
}

/// The largest value of every state where a motion begins and at its switches.
pub(super) fn sizes(begin: &[f64], switches: &Switches) -> Vec<f64> {
    let mut sizes: Vec<f64> = begin.iter().map(|x| x.abs()).collect();
    for (Switching { before, .. }, place) in switches {
        for (size, (x, y)) in sizes.iter_mut().zip(before.iter().zip(&place.state)) {
            *size = size.max(x.abs()).max(y.abs());
        }
    }
    sizes
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
