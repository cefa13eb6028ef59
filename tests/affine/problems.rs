//! The problem files of the repository: read, and their motions settle on periodic orbits.

use std::fs;

use brakewave::affine::motion::{Moment, Motion, Step};
use brakewave::hybrid::OrbitRunner;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{Any, OrbitStart, SystemProblem, read_any};

/// Every problem of the repository with a system.
fn problems() -> Vec<(String, SystemProblem)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/problems");
    let entries = fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let paths = paths.filter(|path| path.is_file());
    let problems = paths.filter_map(|path| {
        let (problem, text) = read_any(&path).unwrap_or_else(|error| panic!("{error}"));
        let Any::System(problem) = problem else {
            return None;
        };
        // those of equilibria have no orbit to begin with
        if problem.equilibrium.is_some() {
            return None;
        }
        let name = path.display().to_string();
        assert!(text.lines().count() <= 40, "{name} is a page");
        Some((name, *problem))
    });
    problems.collect()
}

/// The state at the next entry of a mode from another one, or of a mode that is alone.
fn next_entry(motion: &mut Motion, mode: usize) -> Moment {
    loop {
        let until = motion.place().time + 1e3;
        match motion.step(until).unwrap() {
            Step::Switched(switching) if switching.to == mode => return motion.place().clone(),
            Step::Switched(_) => {}
            Step::Reached | Step::Section => panic!("mode {mode} is not entered again"),
        }
    }
}

/// Largest difference of two states, relative to their size, and what remains of it after a period: the leading
/// multiplier is 0.955 at the bouncing ball's start and less than 0.9 elsewhere, and its guess has four digits.
fn distance(one: &[f64], other: &[f64]) -> f64 {
    let size = one.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    let pairs = one.iter().zip(other);
    pairs.fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs())) / size
}

#[test]
fn the_starts_of_problem_files_are_periodic() {
    let problems = problems();
    assert_eq!(problems.len(), 31);
    for (name, problem) in problems {
        let system = &problem.system;
        let affine = system.at(&problem.values(), &[]).unwrap();
        let beginning = problem.beginning().unwrap();
        let start = beginning.place(system, &affine).unwrap();
        let omega = affine.omega.value;
        let forced = omega > 0.0;
        let unit = if forced {
            std::f64::consts::TAU / omega
        } else {
            1.0
        };
        let mut modes = 0..affine.modes.len();
        // modes that contacts make are entered several times in a period
        let contacts = !system.source.contacts.0.is_empty();
        if contacts || modes.all(|mode| affine.modes[mode].guards.is_empty()) {
            let section = problem.continuation.as_ref().unwrap();
            let run = OrbitRunner::begin(&problem, section, None).unwrap();
            assert!(run.progress().end.is_none(), "{name}");
            continue;
        }
        let (settle, allowed) = match problem.orbit.start {
            OrbitStart::Simulate { settle, .. } => (settle * unit, 1e-9),
            _ => (0.0, 1e-4),
        };
        let mut motion = Motion::new(&affine, start, settle.max(unit));
        while let Step::Switched(_) = motion.step(settle).unwrap() {}
        let states: Vec<Vec<f64>> = (1..=2)
            .map(|period| match forced {
                true => {
                    let until = settle + f64::from(period) * unit;
                    while let Step::Switched(_) = motion.step(until).unwrap() {}
                    motion.place().state.clone()
                }
                // an orbit may enter its first mode more than once, but none of these does
                false => next_entry(&mut motion, 1).state,
            })
            .collect();
        let moved = distance(&states[0], &states[1]);
        assert!(moved < allowed, "{name}: {moved:e} {states:?}");
    }
}
