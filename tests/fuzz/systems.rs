//! Problem files with systems and random damage, read by the library and simulated where they are accepted. They take
//! a thousandth of the time of a process: `BRAKEWAVE_FUZZ_INPUTS=2000` makes ten thousand of them.

use std::fs;
use std::panic::catch_unwind;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use brakewave::affine::course::Course;
use brakewave::problem::{Any, SystemProblem, parse_any};

use crate::cli::harness::PROBLEMS;
use crate::fuzz::dice::Dice;
use crate::fuzz::mutations::{bare, mutate};

/// Words of the format, and pieces of expressions.
const WORDS: [&str; 36] = [
    "x",
    "v",
    "y",
    "A",
    "w",
    "phase",
    "free",
    "flight",
    "slip",
    "stick",
    "Simulate",
    "Given",
    "Restart",
    "Down",
    "Diagram",
    "PD",
    "NS",
    "SL",
    "HB",
    "x*v",
    "1/x",
    "cos(x)",
    "cos(3*phase)",
    "phase^2",
    "tan(A)",
    "sqrt(-1)",
    "exp(1e3)",
    "(x",
    "x)",
    "-",
    "reset",
    "until",
    "if",
    "rest",
    "model",
    "sliding",
];

/// What comes of one input within this, or it does not end.
const PATIENCE: Duration = Duration::from_secs(60);
/// Modes, and samples, section samples and switches after which a motion is left.
const SEEN: usize = 500;
/// Pieces of the fastest mode, of which each is a matrix times a vector, that a motion lasts.
const PIECES: f64 = 200.0;

/// Moves an accepted system for a while; how many things were seen.
fn simulated(problem: &SystemProblem) -> usize {
    let Ok(affine) = problem.system.at(&problem.values(), &[]) else {
        panic!("accepted, but no system");
    };
    for mode in 0..affine.modes.len().min(SEEN) {
        // there may be none, which is data as well
        let _ = affine.equilibria(mode);
    }
    let Some(start) = problem
        .beginning()
        .and_then(|start| start.place(&problem.system, &affine))
    else {
        return 0;
    };
    let norms = affine
        .modes
        .written()
        .iter()
        .map(|mode| mode.matrix.at.norm());
    let duration = PIECES / norms.fold(1e-3, f64::max);
    Course::new(&affine, start, duration, 20).take(SEEN).count()
}

/// What is wrong with the refusal, if it is one; otherwise what is seen of the motion.
fn judged(text: &str) -> Result<Option<usize>, String> {
    match parse_any(text, "p.ron") {
        Ok(Any::System(problem)) => Ok(Some(simulated(&problem))),
        // the damage may leave nothing of the system
        Ok(Any::Tube(_)) => Err("read as a tube".to_owned()),
        Err(error) => {
            let lines = text.split('\n').count();
            let placed = error.line().is_some_and(|line| (1..=lines).contains(&line));
            let told = !error.message().is_empty() && !error.help().is_empty();
            let short = error.to_string().chars().count() < 3000;
            match placed && told && short {
                true => Ok(None),
                false => Err(format!("incomplete refusal: {error}")),
            }
        }
    }
}

#[test]
fn damaged_systems_are_refused_with_a_place_or_move() {
    let entries = fs::read_dir(PROBLEMS).expect("the problem files");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut files: Vec<String> = paths
        .filter(|path| path.is_file())
        .map(|path| bare(&fs::read_to_string(path).expect("a problem file")))
        .filter(|text| text.contains("system:"))
        .collect();
    files.sort();
    let (mut refused, mut moved, mut faults) = (0, 0, Vec::new());
    let inputs = crate::fuzz::inputs(500);
    for index in 0..inputs {
        let mut dice = Dice::new("systems", index);
        let mut text = dice.pick(&files).clone();
        for _ in 0..=dice.below(2) {
            if !text.is_empty() {
                text = String::from_utf8_lossy(&mutate(&mut dice, &text, &WORDS)).into_owned();
            }
        }
        let (tell, told) = mpsc::channel();
        let input = text.clone();
        thread::spawn(move || {
            // a thread that panics drops its end, which is told as well
            let outcome = catch_unwind(|| judged(&input));
            let _ = tell.send(outcome.unwrap_or_else(|_| Err("it panics".to_owned())));
        });
        let outcome = told
            .recv_timeout(PATIENCE)
            .unwrap_or_else(|error| match error {
                RecvTimeoutError::Timeout => Err("it does not end".to_owned()),
                RecvTimeoutError::Disconnected => Err("its thread is lost".to_owned()),
            });
        match outcome {
            Ok(Some(_)) => moved += 1,
            Ok(None) => refused += 1,
            Err(fault) => {
                eprintln!("FAULT {index}: {fault}\n{text}\n");
                faults.push(index);
            }
        }
    }
    eprintln!(
        "damaged systems: {inputs} inputs, {refused} refused, {moved} moved, {} faults",
        faults.len()
    );
    assert_eq!(faults, []);
    // the damage is neither too little nor too much
    assert!(
        10 * refused > inputs && 10 * moved > inputs,
        "{refused} {moved}"
    );
}
