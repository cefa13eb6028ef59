//! What motions of systems settle on, against closed forms, and the same bytes however it is computed.

use std::collections::BTreeMap;
use std::f64::consts::{LN_2, PI, TAU};
use std::fs;

use brakewave::branch::Stability;
use brakewave::hybrid::OrbitPoint;
use brakewave::map::{MotionOutcome, Motions, Settled};
use brakewave::problem::{self, Any, SystemProblem};

use crate::map::{run, succeed};

/// An oscillator with a stop at d = 1, begun at rest.
fn oscillator(points: &str) -> String {
    format!(
        r#"(
    title: "mapped",
    system: (
        states: ["x", "v"],
        parameters: {{"c": 0.4, "A": 1.0, "w": 1.0, "d": 1.0, "e": 0.5}},
        forcing: "w",
        modes: {{"free": (
            rates: {{"x": "v", "v": "A*cos(phase) - c*v - x"}},
            until: [(zero: "d - x", to: "free", reset: {{"v": "-e*v"}})],
        )}},
    ),
    orbit: (start: Simulate(mode: "free", state: {{"x": 0.0, "v": 0.0}}, settle: 40), periods: 4),
    stability: (),
    map: (
        first: (parameter: "A", range: (0.1, 1.9)),
        second: (parameter: "w", range: (1.2, 2.0)),
        points: {points},
    ),
)"#
    )
}

/// A heater that is on until x reaches `high` and off until x falls to 1/2.
const THERMOSTAT: &str = r#"(
    system: (
        states: ["x"],
        parameters: {"Q": 2.0, "high": 1.0},
        modes: {
            "on": (rates: {"x": "Q - x"}, until: [(zero: "high - x", to: "off")]),
            "off": (rates: {"x": "-x"}, until: [(zero: "x - 0.5", to: "on")]),
        },
    ),
    orbit: (start: Simulate(mode: "on", state: {"x": 0.6}, settle: 20)),
    map: (
        first: (parameter: "Q", range: (0.65, 2.65)),
        second: (parameter: "high", range: (0.8, 1.2)),
        points: Grid(rows: 5, columns: 3),
        starts: [(mode: "on", state: {"x": 0.6}), (mode: "off", state: {"x": 0.7})],
    ),
)"#;

fn system(text: &str) -> SystemProblem {
    match problem::parse_any(text, "p.ron").unwrap() {
        Any::System(problem) => *problem,
        Any::Tube(_) => panic!("a tube"),
    }
}

fn outcomes(text: &str, rows: usize) -> Vec<MotionOutcome> {
    let problem = system(text);
    let motions = Motions::new(&problem).unwrap();
    (0..rows).flat_map(|row| motions.row(row)).collect()
}

fn orbit(outcome: &MotionOutcome) -> Option<(&OrbitPoint, Option<u32>)> {
    match &outcome.found {
        Settled::Orbit { point, periods } => Some((point, *periods)),
        Settled::Nothing(_) => None,
    }
}

/// With G = 1/(1 − ω² + icω) an orbit that does not touch has amplitude A|G|, the period of the force and multipliers of
/// modulus exp(−πc/ω). Where A|G| exceeds d there is none. Where even the transient stays below, the motion settles on
/// it: from rest |x| ≤ A|G|(1 + √(1 + ((ω + c/2)/Ω)²)) with Ω² = 1 − c²/4.
#[track_caller]
fn meets_the_graze(outcomes: &[MotionOutcome]) -> [usize; 2] {
    let (mut silent, mut touching) = (0, 0);
    for outcome in outcomes {
        let [c, force, w] = [0, 1, 2].map(|index| outcome.parameters[index]);
        let size = force / (1.0 - w * w).hypot(c * w);
        let natural = (1.0 - 0.25 * c * c).sqrt();
        let transient = size * (1.0 + (1.0_f64).hypot((w + 0.5 * c) / natural));
        let found = orbit(outcome);
        if transient < 1.0 {
            assert!(found.is_some(), "{outcome:?}");
        }
        let Some((point, periods)) = found else {
            continue;
        };
        let turns = f64::from(periods.unwrap());
        assert!((point.period * w / (turns * TAU) - 1.0).abs() < 1e-12);
        assert!(point.extremes[0].1 <= 1.0 + 1e-12);
        if point.switches.is_empty() {
            assert!(size < 1.0 && point.regimes == "free", "{outcome:?}");
            assert!((point.extremes[0].1 - size).abs() < 1e-11 && turns == 1.0);
            let modulus = point.leading().unwrap().norm();
            assert!((modulus - (-PI * c / w).exp()).abs() < 1e-11);
            assert_eq!(point.stable, Some(Stability::Yes));
            silent += 1;
        } else {
            assert!(transient >= 1.0, "{outcome:?}");
            // as many zones as switches, each entered from the stop
            assert_eq!(point.regimes.split('-').count(), point.switches.len());
            assert!((point.extremes[0].1 - 1.0).abs() < 1e-11);
            touching += 1;
        }
    }
    [silent, touching]
}

#[test]
fn impacts_begin_beyond_the_graze() {
    let outcomes = outcomes(&oscillator("Grid(rows: 5, columns: 6)"), 5);
    assert_eq!(outcomes.len(), 30);
    let [silent, touching] = meets_the_graze(&outcomes);
    assert!(silent >= 8 && touching >= 8, "{silent} {touching}");
}

#[test]
fn quasi_random_points_are_settled_one_by_one() {
    let outcomes = outcomes(&oscillator("QuasiRandom(count: 20)"), 1);
    assert_eq!(outcomes.len(), 20);
    let [silent, touching] = meets_the_graze(&outcomes);
    assert!(silent >= 4 && touching >= 4, "{silent} {touching}");
}

/// A heater with Q < high never reaches the upper end and comes to rest at x = Q, from either start; otherwise the period
/// is ln((Q − ½)/(Q − high)) + ln(2 high).
#[test]
fn motions_without_forcing_switch_or_rest() {
    let outcomes = outcomes(THERMOSTAT, 5);
    assert_eq!(outcomes.len(), 5 * 3 * 2);
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for outcome in &outcomes {
        let [heat, high] = [outcome.parameters[0], outcome.parameters[1]];
        let word = outcome.found.word();
        *counts.entry(word).or_default() += 1;
        if heat < high {
            assert_eq!(word, "equilibrium");
            continue;
        }
        let (point, periods) = orbit(outcome).unwrap();
        let period = ((heat - 0.5) / (heat - high)).ln() + high.ln() + LN_2;
        assert!((point.period - period).abs() < 1e-11, "{outcome:?}");
        assert_eq!((&*point.regimes, periods), ("on-off", None));
        // stability was not asked for
        assert_eq!(point.stable, None);
    }
    assert_eq!(counts, BTreeMap::from([("equilibrium", 8), ("orbit", 22)]));
}

/// What is no orbit is told apart: a ball on a plate that is still comes to infinitely many impacts in finite time,
/// pushed away it does not return, and pushed the harder the further it is, it is gone.
#[test]
fn what_is_no_orbit_is_told_apart() {
    let text = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"g": 1.0, "w": 1.0, "b": 0.0},
        forcing: "w",
        modes: {"flight": (rates: {"x": "v", "v": "b*x - g"}, until: [(zero: "x", to: "flight", reset: {"v": "-0.5*v"})])},
    ),
    orbit: (start: Simulate(mode: "flight", state: {"x": 1.0, "v": 0.0}, settle: 200)),
    map: (
        first: (parameter: "g", range: (-1.0, 1.0)),
        second: (parameter: "b", range: (0.0, 100.0)),
        points: Grid(rows: 2, columns: 2),
    ),
)"#;
    let outcomes = outcomes(text, 2);
    let words: Vec<&str> = outcomes.iter().map(|one| one.found.word()).collect();
    // x grows like t²/2: not without bound in finite time, but it does not return
    assert_eq!(
        words,
        ["not periodic", "unbounded", "chattering", "unbounded"]
    );
}

/// One table and one picture, whoever computes what.
#[test]
fn the_bytes_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), oscillator("Grid(rows: 3, columns: 3)")).unwrap();
    succeed(path, &["map", "p.ron", "--out", "whole", "--threads", "1"]);
    succeed(path, &["map", "p.ron", "--out", "both", "--threads", "2"]);
    for shard in ["1/2", "2/2"] {
        let out = format!("shard{}", &shard[..1]);
        succeed(path, &["map", "p.ron", "--shard", shard, "--out", &out]);
    }
    succeed(
        path,
        &["map", "merge", "shard2", "shard1", "--out", "merged"],
    );
    let read = |out: &str, name: &str| fs::read(path.join(out).join(name)).unwrap();
    for name in ["map.csv", "map.svg", "map.ron"] {
        assert!(read("whole", name).len() > 100);
        assert!(read("whole", name) == read("both", name), "{name}: threads");
        assert!(
            read("whole", name) == read("merged", name),
            "{name}: shards"
        );
    }
    // a row that is lost is computed again
    fs::remove_file(path.join("both/rows/000000001.csv")).unwrap();
    fs::remove_file(path.join("both/map.csv")).unwrap();
    succeed(path, &["map", "p.ron", "--out", "both", "--resume"]);
    assert!(read("whole", "map.csv") == read("both", "map.csv"));
    let table = String::from_utf8(read("whole", "map.csv")).unwrap();
    let header = "row,column,start,passage,found,periods,regimes,c,A,w,d,e,period,switches,min_x,max_x,min_v,max_v,\
        stable,unstable,multiplier_re,multiplier_im,why\n";
    assert!(table.starts_with(header), "{table}");
    assert_eq!(table.lines().count(), 1 + 9);
    // both are drawn again, and a report shows it
    fs::remove_file(path.join("both/map.svg")).unwrap();
    succeed(path, &["plot", "both"]);
    assert!(read("whole", "map.svg") == read("both", "map.svg"));
    let picture = String::from_utf8(read("whole", "map.svg")).unwrap();
    assert!(picture.contains("T: free, no switch") && picture.contains("mapped"));
    succeed(path, &["report", "both"]);
    let page = String::from_utf8(read("both", "report.html")).unwrap();
    assert!(page.contains("What motions settle on in the plane of w and A"));
    // how long a guess settles is not said
    let guess = oscillator("Grid(rows: 3, columns: 3)").replace("Simulate(", "Given(");
    fs::write(path.join("r.ron"), guess.replace(", settle: 40", "")).unwrap();
    let output = run(path, &["map", "r.ron"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.code() == Some(2) && said.contains("how long they settle"),
        "{said}"
    );
}
