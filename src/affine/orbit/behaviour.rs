//! What a motion looks like that settles on no orbit: by how fast motions next to it part, and by whether it comes back.

use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Moment, Motion, Step};

/// What a motion looks like after it was given time to settle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Behaviour {
    /// It is back after so many of the intervals that it was watched at.
    Periodic(usize),
    /// Motions next to it come nearer.
    Settles,
    /// They neither come nearer nor part.
    QuasiPeriodic,
    /// They part at this rate: its largest Lyapunov exponent.
    Chaotic(f64),
    /// The state with this number moves by as much in every interval, while what is left comes back.
    Drifts(usize, f64),
    /// They part at times and come nearer at others.
    Unclear,
}

/// A motion has returned where no state is further off than this part of its size.
pub(super) const RETURNED: f64 = 1e-6;

/// Intervals over which motions are compared, in two halves, and before that to learn the sizes of the states.
const INTERVALS: usize = 120;

/// How far apart two motions begin, in units of the states: their difference follows the linearised flow.
const APART: f64 = 1e-8;

/// Rates per interval below this are zero: a difference of bounded size may grow tenfold within one half.
const SLOW: f64 = 0.04;

/// Moves on to a time; false where the motion does not go on.
fn run(motion: &mut Motion, until: f64, sizes: &mut [f64]) -> bool {
    loop {
        let step = motion.step(until);
        let states = motion.place().state.iter();
        states
            .zip(&mut *sizes)
            .for_each(|(x, size)| *size = size.max(x.abs()));
        match step {
            Ok(Step::Reached) => return true,
            Ok(_) => {}
            Err(_) => return false,
        }
    }
}

/// The largest difference of two states in units of these sizes.
fn apart(one: &[f64], other: &[f64], sizes: &[f64]) -> f64 {
    let pairs = one.iter().zip(other).zip(sizes);
    let parts = pairs.filter(|(_, size)| **size > 0.0);
    parts
        .map(|((x, y), size)| (x - y).abs() / size)
        .fold(0.0, f64::max)
}

/// What a motion from a place looks like, watched at intervals; `None` where it does not go on, or none beside it does.
pub fn behaviour(system: &AffineSystem, place: &Moment, interval: f64) -> Option<Behaviour> {
    let mut sizes = vec![0.0; place.state.len()];
    let mut motion = Motion::new(system, place.clone(), interval);
    for index in 1..=INTERVALS / 2 {
        run(
            &mut motion,
            place.time + interval * index as f64,
            &mut sizes,
        )
        .then_some(())?;
    }
    // moved in all states a motion may be in no mode, as beside a surface in which it slides
    let mut axes = std::iter::once(None).chain((0..sizes.len()).map(Some));
    axes.find_map(|axis| parting(system, motion.place(), interval, &sizes, axis))
}

/// The same by a motion beside it that differs in one state at first, or in all.
fn parting(
    system: &AffineSystem,
    place: &Moment,
    interval: f64,
    sizes: &[f64],
    axis: Option<usize>,
) -> Option<Behaviour> {
    let beside = |place: &Moment, by: &dyn Fn(usize) -> f64| {
        let mut place = place.clone();
        (0..place.state.len()).for_each(|index| place.state[index] += by(index));
        Motion::new(system, place, interval)
    };
    let moved = |index: usize| match axis.is_none_or(|axis| axis == index) {
        true => APART * sizes[index],
        false => 0.0,
    };
    let mut motion = Motion::new(system, place.clone(), interval);
    let mut other = beside(place, &moved);
    let mut rates = [0.0; 2];
    let mut seen = Vec::new();
    for index in 0..INTERVALS {
        let now = place.time + interval * (index + 1) as f64;
        let goes_on = [&mut motion, &mut other].map(|motion| run(motion, now, &mut sizes.to_vec()));
        if goes_on != [true, true] {
            return None;
        }
        let (here, there) = (motion.place(), other.place());
        seen.push((here.mode, here.state.clone()));
        let off = apart(&here.state, &there.state, sizes);
        // at an instant when one has switched and the other not yet their difference says nothing
        if here.mode != there.mode || !off.is_finite() {
            continue;
        }
        // of motions that have met, rounding is left
        let off = off.max(f64::EPSILON);
        rates[2 * index / INTERVALS] += (off / APART).ln();
        let (here, state) = (here.clone(), there.state.clone());
        let scaled = |index: usize| (state[index] - here.state[index]) * APART / off;
        other = match off > f64::EPSILON {
            true => beside(&here, &scaled),
            false => beside(&here, &moved),
        };
    }
    let [first, second] = rates.map(|rate| 2.0 * rate / INTERVALS as f64);
    let (last_mode, last) = seen.pop()?;
    let back = seen
        .iter()
        .rev()
        .position(|(mode, state)| *mode == last_mode && apart(state, &last, sizes) <= RETURNED);
    seen.push((last_mode, last));
    let is_calm = first.max(second) <= SLOW;
    if let Some((state, by)) = drift(&seen, sizes).filter(|_| is_calm && back.is_none()) {
        return Some(Behaviour::Drifts(state, by));
    }
    Some(match back {
        Some(before) if first + second <= 2.0 * SLOW => Behaviour::Periodic(before + 1),
        _ if first.min(second) > 0.0 && first + second > 2.0 * SLOW => {
            Behaviour::Chaotic(0.5 * (first + second) / interval)
        }
        _ if first.max(second) < -SLOW => Behaviour::Settles,
        _ if first.abs().max(second.abs()) <= SLOW => Behaviour::QuasiPeriodic,
        _ => Behaviour::Unclear,
    })
}

/// A state that moves on by as much in every one of these intervals, and by how much: all others are where they were, or
/// move on, too.
fn drift(seen: &[(usize, Vec<f64>)], sizes: &[f64]) -> Option<(usize, f64)> {
    let (_, last) = seen.last()?;
    let steps = || seen.windows(2).map(|pair| (&pair[0].1, &pair[1].1));
    let mean = |state: usize| (last[state] - seen[0].1[state]) / (seen.len() - 1) as f64;
    let is_even = |state: usize| {
        let even = |by: f64| (by - mean(state)).abs() <= RETURNED * sizes[state];
        steps().all(|(one, next)| even(next[state] - one[state]))
    };
    let moves = |state: &usize| mean(*state).abs() > RETURNED * sizes[*state];
    let state = (0..last.len()).find(moves)?;
    let same_mode = seen.iter().all(|(mode, _)| *mode == seen[0].0);
    (same_mode && (0..last.len()).all(is_even)).then(|| (state, mean(state)))
}

/// Where a motion that does not switch is after a time, and how long it takes from there until it is back, to a thousandth of
/// its size; `None` where it is not within some hundreds of the time in which it moves by its size.
pub fn cycle(system: &AffineSystem, place: &Moment, longest: f64) -> Option<(Moment, f64)> {
    /// Steps per time in which the motion moves by its size, and steps at most.
    const STEPS: f64 = 16.0;
    const MOST: usize = 20_000;
    const BACK: f64 = 1e-3;
    let rates = |place: &Moment| {
        let z = system.lift(place.mode, &place.state, place.phase);
        let rates = &system.modes[place.mode].matrix.at * z;
        rates
            .rows(0, system.states)
            .iter()
            .copied()
            .collect::<Vec<f64>>()
    };
    let mut sizes = vec![0.0; place.state.len()];
    let mut motion = Motion::new(system, place.clone(), longest);
    let time = time_of_change(system, &mut motion, longest, rates, &mut sizes)?;
    let step = time / STEPS;
    if !step.is_normal() {
        return None;
    }
    let begin = motion.place().clone();
    let normal: Vec<f64> = rates(&begin)
        .iter()
        .zip(&sizes)
        .map(|(rate, size)| rate / (size * size))
        .collect();
    let side = |state: &[f64]| {
        let off = state.iter().zip(&begin.state).map(|(x, y)| x - y);
        let terms = off.zip(&normal).filter(|(_, normal)| normal.is_finite());
        terms.map(|(off, normal)| off * normal).sum::<f64>()
    };
    let mut before = (begin.time, 0.0);
    for index in 1..=MOST {
        let now = begin.time + step * index as f64;
        let start = motion.clone();
        run(&mut motion, now, &mut sizes).then_some(())?;
        let here = side(&motion.place().state);
        if before.1 < 0.0 && here >= 0.0 {
            let (time, at) = crossing(&start, [before.0, now], side, &mut sizes)?;
            if apart(&at, &begin.state, &sizes) <= BACK {
                let period = time - begin.time;
                return Some((begin, period));
            }
        }
        before = (now, here);
    }
    None
}

/// Follows a motion for a time and returns the least one in which a state would move by its size, as fast as it gets. A state that is
/// no larger than roundings of the terms of its rate over that time says nothing: its size is infinite.
fn time_of_change(
    system: &AffineSystem,
    motion: &mut Motion,
    longest: f64,
    rates: impl Fn(&Moment) -> Vec<f64>,
    sizes: &mut [f64],
) -> Option<f64> {
    const PARTS: u32 = 512;
    let begin = motion.place().time;
    let mut speeds = vec![0.0_f64; sizes.len()];
    let mut most = speeds.clone();
    for part in 1..=PARTS {
        let until = begin + longest * f64::from(part) / f64::from(PARTS);
        run(motion, until, sizes).then_some(())?;
        let now = rates(motion.place());
        let pairs = now.iter().zip(&mut speeds);
        pairs.for_each(|(rate, speed)| *speed = speed.max(rate.abs()));
        let Moment {
            mode, state, phase, ..
        } = motion.place();
        let now = system.terms_of_rates(*mode, state, *phase);
        let pairs = now.iter().zip(&mut most);
        pairs.for_each(|(terms, most)| *most = most.max(*terms));
    }
    for (size, terms) in sizes.iter_mut().zip(&most) {
        if *size <= f64::EPSILON * terms * longest {
            *size = f64::INFINITY;
        }
    }
    let pairs = sizes.iter().zip(&speeds);
    let moving = pairs.filter(|(size, speed)| **size > 0.0 && **speed > 0.0);
    let times = moving.map(|(size, speed)| size / speed);
    Some(times.fold(f64::INFINITY, f64::min))
}

/// The instant between two others at which a motion comes to the other side, by halving, and its state nearby.
fn crossing(
    start: &Motion,
    [mut low, mut high]: [f64; 2],
    side: impl Fn(&[f64]) -> f64,
    sizes: &mut [f64],
) -> Option<(f64, Vec<f64>)> {
    const HALVINGS: usize = 40;
    let mut at = Vec::new();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let mut trial = start.clone();
        run(&mut trial, middle, sizes).then_some(())?;
        at.clone_from(&trial.place().state);
        if side(&at) < 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    Some((high, at))
}
