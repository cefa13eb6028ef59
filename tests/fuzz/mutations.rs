//! Problem files of the repository with random damage.

use std::fs;

use crate::cli::harness::{Bench, PROBLEMS};
use crate::fuzz::dice::Dice;
use crate::fuzz::models::{VERBS, words};
use crate::fuzz::watch::Record;

/// Numbers that are seldom thought of.
const NUMBERS: [&str; 26] = [
    "0",
    "-0.0",
    "-1",
    "1e-300",
    "1e300",
    "-1e300",
    "inf",
    "-inf",
    "NaN",
    "1e-17",
    "0.1",
    "1",
    "2",
    "3.7",
    "1e16",
    "4294967296",
    "18446744073709551615",
    "1e-5",
    "0.4999999",
    "0.5",
    "1.0000001",
    "127",
    "65536",
    "true",
    "\"1\"",
    "1_000",
];

/// Words of the format and of elsewhere.
const WORDS: [&str; 30] = [
    "Mismatch",
    "Friction",
    "Gamma",
    "Nu",
    "Xi",
    "MassDamping",
    "StiffnessDamping",
    "Smoothing",
    "Fast",
    "Slow",
    "Hopf",
    "Down",
    "Up",
    "Both",
    "All",
    "Only([0, 1])",
    "GR",
    "HB",
    "UZ",
    "ST",
    "Coulomb",
    "Static(ratio: 1.2)",
    "Stribeck(ratio: 1.2, velocity: 0.5)",
    "Regularised(epsilon: 0.01)",
    "Exact",
    "Restart(dir: \"out\", label: 1)",
    "Some(1)",
    "[]",
    "()",
    "Collocation(intervals: 20, degree: 4)",
];

/// Where numbers stand in a text: start and end of each.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    spans(text, |byte| byte.is_ascii_digit() || b".e-".contains(&byte))
        .into_iter()
        .filter(|&(from, to)| text[from..to].bytes().any(|byte| byte.is_ascii_digit()))
        .collect()
}

/// Where words stand in a text.
fn names(text: &str) -> Vec<(usize, usize)> {
    spans(text, |byte| byte.is_ascii_alphabetic() || byte == b'_')
}

fn spans(text: &str, belongs: impl Fn(u8) -> bool) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let mut spans = Vec::new();
    let mut from = 0;
    while from < bytes.len() {
        let to = (from..bytes.len())
            .find(|&at| !belongs(bytes[at]))
            .unwrap_or(bytes.len());
        if to > from {
            spans.push((from, to));
        }
        from = to + 1;
    }
    spans
}

/// The text without its comments, which damage would be lost in.
pub fn bare(text: &str) -> String {
    text.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .map(|line| line.split(" //").next().unwrap_or(line).to_owned() + "\n")
        .collect()
}

/// One random change of a text, some of them to one of these words.
pub fn mutate(dice: &mut Dice, text: &str, words: &[&str]) -> Vec<u8> {
    let replace = |(from, to): (usize, usize), by: &str| {
        [&text[..from], by, &text[to..]].concat().into_bytes()
    };
    let position = dice.below(text.len());
    let (numbers, names) = (numbers(text), names(text));
    match dice.below(10) {
        0..=3 if !numbers.is_empty() => {
            let place = *dice.pick(&numbers);
            replace(place, dice.pick::<&str>(&NUMBERS))
        }
        // near the number that was there
        4 if !numbers.is_empty() => {
            let place = *dice.pick(&numbers);
            let value: f64 = text[place.0..place.1].parse().unwrap_or(1.0);
            let factor = dice.logarithmic(1e-3, 1e3);
            replace(place, &format!("{}", value * factor))
        }
        5 | 6 if !names.is_empty() => {
            let place = *dice.pick(&names);
            replace(place, dice.pick::<&str>(words))
        }
        7 => {
            // a piece of lines left out or doubled
            let lines: Vec<&str> = text.lines().collect();
            let from = dice.below(lines.len());
            let to = (from + 1 + dice.below(3)).min(lines.len());
            let mut kept: Vec<&str> = lines[..from].to_vec();
            if dice.happens(0.5) {
                kept.extend(&lines[from..to]);
                kept.extend(&lines[from..to]);
            }
            kept.extend(&lines[to..]);
            kept.join("\n").into_bytes()
        }
        8 => text.as_bytes()[..position].to_vec(),
        _ => {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..=dice.below(4) {
                let at = dice.below(bytes.len());
                bytes[at] = match dice.below(4) {
                    0 => *dice.pick(b"(){}[],:\"'\\/\n\0"),
                    1 => *dice.pick(&[0xff, 0xfe, 0xc3, 0x1b, 0x7f, 0x80]),
                    _ => dice.below(256) as u8,
                };
            }
            bytes
        }
    }
}

#[test]
fn mutated_problem_files_end_by_the_contract() {
    let mut files: Vec<String> = fs::read_dir(PROBLEMS)
        .expect("the problem files")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .map(|path| bare(&fs::read_to_string(path).expect("a problem file")))
        // those of systems are damaged by a test of their own
        .filter(|text| !text.contains("system:"))
        .collect();
    files.sort();
    let mut record = Record::default();
    for index in 0..crate::fuzz::inputs(60) {
        let mut dice = Dice::new("mutations", index);
        let mut text = dice.pick(&files).clone().into_bytes();
        for _ in 0..=dice.below(3) {
            let Ok(whole) = String::from_utf8(text.clone()) else {
                break;
            };
            if whole.is_empty() {
                break;
            }
            text = mutate(&mut dice, &whole, &WORDS);
        }
        // the verb that the file is for, and sometimes another
        let has = |section: &str| text.windows(section.len()).any(|w| w == section.as_bytes());
        let verb = match dice.below(4) {
            0 => *dice.pick(&VERBS),
            _ if has("simulation:") => "simulate",
            _ if has("curve:") => "curve",
            _ if has("map:") => "map",
            _ => *dice.pick(&["run", "check"]),
        };
        let bench = Bench::new();
        let path = bench.put("problem.ron", &text);
        let mine = bench.put("events.csv", b"a table of the user's");
        record.input();
        let words = words(&mut dice, verb);
        let shown = String::from_utf8_lossy(&text).into_owned();
        record.run(&bench, &words, &[0, 1, 2, 3], &shown);
        record.untouched(&path, &text, verb);
        record.untouched(&mine, b"a table of the user's", verb);
    }
    record.close("mutated problem files");
}
