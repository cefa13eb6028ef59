//! Result folders that were damaged, and runs that were killed at a random moment.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use crate::cli::harness::{Bench, Snapshot, snapshot};
use crate::fuzz::dice::Dice;
use crate::fuzz::watch::Record;

/// A small problem with a section for every verb that writes a folder.
const EVERYTHING: &str = r#"(
    title: "Everything",
    model: (
        coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
        friction: 0.5,
        mismatch: 0.2,
    ),
    wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (0.04, 0.21), toward: Both, ds_max: 0.01),
    stability: (sectors: Only([0]), eigenvalues: 2, max_frequency: 6.0),
    map: (
        first: (parameter: Friction, range: (0.4, 0.6)),
        second: (parameter: Mismatch, range: (0.02, 0.2)),
        points: Grid(rows: 6, columns: 8),
        starts: [Fast],
    ),
    curve: (
        event: GR,
        parameters: (Mismatch, Friction),
        range: ((0.03, 0.08), (0.4, 0.7)),
    ),
    simulation: (
        body: Ring(points: 96),
        start: SteadySliding,
        perturbation: (mode: 4, amplitude: 1e-2),
        duration: 8.0,
        every: 0.02,
        snapshots: 3,
    ),
    output: (plots: [Diagram, Pressure], profiles: 6),
)
"#;

/// The same without what is slow to write, and from the Hopf point.
const FROM_HOPF: &str = r#"(
    model: (
        coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
        friction: 0.1,
        mismatch: 0.2,
        damping: (mass: 0.1),
    ),
    wave: (mode: 4, start: Hopf),
    continuation: (parameter: Friction, range: (0.05, 0.6), toward: Up, ds_max: 0.005),
    output: (profiles: 6),
)
"#;

/// A verb with the problem it is killed on.
const KILLED: [(&str, &str); 5] = [
    ("run", EVERYTHING),
    ("run", FROM_HOPF),
    ("map", EVERYTHING),
    ("curve", EVERYTHING),
    ("simulate", EVERYTHING),
];

#[test]
fn a_run_killed_at_any_moment_goes_on_to_the_same_bytes() {
    let mut record = Record::default();
    // files and time of runs that were left alone
    let whole: Vec<(Snapshot, Duration)> = KILLED
        .iter()
        .map(|(verb, text)| {
            let bench = Bench::new();
            bench.put("problem.ron", text);
            let begun = Instant::now();
            record.run(&bench, &[verb, "problem.ron", "--out", "out"], &[0], text);
            (snapshot(&bench.path("out")), begun.elapsed())
        })
        .collect();
    for index in 0..crate::fuzz::inputs(5) {
        let mut dice = Dice::new("kills", index);
        let which = dice.below(KILLED.len());
        let (verb, text) = KILLED[which];
        let (files, duration) = &whole[which];
        let bench = Bench::new();
        bench.put("problem.ron", text);
        record.input();
        let mut resume = false;
        for _ in 0..=dice.below(2) {
            let mut words = vec![verb, "problem.ron", "--out", "out"];
            if resume {
                words.push("--resume");
            }
            let mut child = bench
                .command(&words)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .expect("the binary runs");
            thread::sleep(duration.mul_f64(dice.unit() * dice.unit()));
            child.kill().expect("the child can be killed");
            child.wait().expect("a child");
            resume = true;
        }
        let words = [verb, "problem.ron", "--out", "out", "--resume"];
        if record.run(&bench, &words, &[0], text).is_some() {
            let after = snapshot(&bench.path("out"));
            if let Some(name) = different(&after, files) {
                record.fault(format!(
                    "kill {index}: {verb} --resume ends in another {}",
                    name.display()
                ));
            }
        }
    }
    record.close("kills");
}

/// The first file that is not the same in both.
fn different<'a>(one: &'a Snapshot, other: &'a Snapshot) -> Option<&'a Path> {
    one.keys()
        .chain(other.keys())
        .find(|name| one.get(*name) != other.get(*name))
        .map(PathBuf::as_path)
}

/// Damages a file at random; returns what was done.
fn damage(dice: &mut Dice, path: &Path) -> String {
    let mut bytes = fs::read(path).expect("a file of the folder");
    let end = bytes.len().max(1);
    let what = match dice.below(7) {
        0 => {
            fs::remove_file(path).expect("a file can be removed");
            return "removed".into();
        }
        1 => {
            bytes.clear();
            "emptied"
        }
        2 => {
            bytes.truncate(dice.below(end));
            "cut short"
        }
        3 => {
            for _ in 0..=dice.below(8) {
                let at = dice.below(end);
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = dice.below(256) as u8;
                }
            }
            "bytes changed"
        }
        4 => {
            // a number replaced by another, which only a check of content can see
            let digits: Vec<usize> = (0..bytes.len())
                .filter(|&at| bytes[at].is_ascii_digit())
                .collect();
            if !digits.is_empty() {
                let at = *dice.pick(&digits);
                bytes[at] = b'0' + dice.below(10) as u8;
            }
            "a digit changed"
        }
        5 => {
            let at = dice.below(end);
            let piece = bytes[at.min(bytes.len())..].to_vec();
            bytes.extend(piece);
            "a piece doubled"
        }
        _ => {
            // lists in restart files made shorter or empty
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let opens: Vec<usize> = text.match_indices('[').map(|(at, _)| at).collect();
            if let Some(&open) = (!opens.is_empty()).then(|| dice.pick(&opens))
                && let Some(close) = text[open..].find(']')
            {
                bytes = [&text[..=open], &text[open + close..]]
                    .concat()
                    .into_bytes();
            }
            "a list emptied"
        }
    };
    fs::write(path, bytes).expect("a file can be written");
    what.into()
}

fn copy(from: &Path, to: &Path) {
    for (name, bytes) in snapshot(from) {
        let path = to.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder can be made");
        fs::write(path, bytes).expect("a file can be written");
    }
}

#[test]
fn damaged_folders_are_refused_or_read_and_nothing_is_lost() {
    let mut record = Record::default();
    let verbs = ["run", "map", "curve", "simulate", "accuracy"];
    let source = Bench::new();
    source.put("problem.ron", EVERYTHING);
    for verb in verbs {
        let mut words = vec![verb, "problem.ron", "--out", verb];
        if verb == "accuracy" {
            words.extend(["--budget", "1", "--repeats", "1"]);
        }
        record.run(&source, &words, &[0], EVERYTHING);
    }
    // the same map in two parts, and a run half way
    for part in ["1/2", "2/2"] {
        let out = format!("part{}", &part[..1]);
        let words = ["map", "problem.ron", "--shard", part, "--out", &out];
        record.run(&source, &words, &[0], EVERYTHING);
    }
    let restart = EVERYTHING.replace("start: Fast", "start: Restart(dir: \"out\", label: 2)");
    for index in 0..crate::fuzz::inputs(10) {
        let mut dice = Dice::new("folders", index);
        let bench = Bench::new();
        let problem = bench.put("problem.ron", EVERYTHING);
        bench.put("restart.ron", &restart);
        let kind = *dice.pick(&[
            "run", "run", "map", "curve", "simulate", "accuracy", "part1",
        ]);
        copy(&source.path(kind), &bench.path("out"));
        if kind == "part1" {
            copy(&source.path("part2"), &bench.path("part2"));
        }
        let names: Vec<PathBuf> = snapshot(&bench.path("out")).into_keys().collect();
        let mut done = Vec::new();
        for _ in 0..=dice.below(2) {
            // what the program reads again is the best place for damage
            let states: Vec<&PathBuf> = names
                .iter()
                .filter(|name| name.extension().is_some_and(|extension| extension == "ron"))
                .collect();
            let name = match states.is_empty() || dice.happens(0.4) {
                true => dice.pick(&names).clone(),
                false => (*dice.pick(&states)).clone(),
            };
            let path = bench.path("out").join(&name);
            if path.exists() {
                let what = damage(&mut dice, &path);
                done.push(format!("{}: {what}", name.display()));
            }
        }
        // files of the user's within the folder, one named like one of ours
        let mine: Vec<(PathBuf, &[u8])> = [
            ("out/notes.txt", &b"what I thought"[..]),
            ("out/profiles/mine.csv", b"1,2,3"),
            ("out/0000.npy", b"numbers"),
        ]
        .into_iter()
        .map(|(name, text)| {
            let path = bench.path(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder can be made");
            fs::write(&path, text).expect("a file can be written");
            (path, text)
        })
        .collect();
        let words: Vec<&str> = match (kind, dice.below(4)) {
            ("part1", _) => vec!["map", "merge", "out", "part2", "--out", "whole"],
            (_, 0) => vec!["plot", "out"],
            ("run", 1) => vec!["run", "restart.ron", "--out", "next"],
            ("run", 2) => vec!["spectrum", "restart.ron", "--at", "mismatch=0.15"],
            ("accuracy", _) => vec![
                "accuracy",
                "problem.ron",
                "--out",
                "out",
                "--force",
                "--budget",
                "1",
                "--repeats",
                "1",
            ],
            (_, 1) => vec![kind, "problem.ron", "--out", "out", "--force"],
            _ => vec![kind, "problem.ron", "--out", "out", "--resume"],
        };
        record.input();
        let repeat = format!("folder {index}: {}", done.join("; "));
        record.run(&bench, &words, &[0, 2, 3, 4], &repeat);
        for (path, text) in &mine {
            record.untouched(path, text, &words.join(" "));
        }
        record.untouched(&problem, EVERYTHING.as_bytes(), &words.join(" "));
    }
    record.close("damaged folders");
}
