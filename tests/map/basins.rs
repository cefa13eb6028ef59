//! Basins of attraction: shares and orbits of an independent program, regions in closed form, the same bytes however they
//! are computed, and attractors to restart from.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use crate::map::{run, succeed};

const IMPACT: &str = include_str!("../../problems/impact_basin.ron");

/// A table: its columns, and its rows.
fn table(folder: &Path, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(folder.join(name)).unwrap();
    let mut lines = text.lines();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    let header = cells(lines.next().unwrap());
    (header, lines.map(cells).collect())
}

fn number(cell: &str) -> f64 {
    cell.parse().unwrap_or_else(|_| panic!("{cell}"))
}

/// The cells of a map in their order, by the numbers of their attractors.
fn numbers(folder: &Path) -> Vec<String> {
    let (header, rows) = table(folder, "map.csv");
    let column = header.iter().position(|one| one == "attractor").unwrap();
    rows.iter().map(|row| row[column].clone()).collect()
}

/// The figures of an independent program with the closed form of the flow and brackets of its own, for 40 × 40 initial
/// states: two attractors, of which the second is one orbit at either of its two phases.
#[test]
fn the_oscillator_has_two_attractors() {
    let folder = mapped(IMPACT);
    let path = folder.path();
    let (header, rows) = table(&path.join("m"), "attractors.csv");
    let names = "attractor,regimes,period,periods,stable,share,x,v";
    assert_eq!(header.join(","), names);
    assert_eq!(rows.len(), 2);
    let of = |periods: &str| rows.iter().find(|row| row[3] == periods).unwrap();
    let (swings, hits) = (of("1"), of("2"));
    // the lowest speed and place lead to impacts
    assert_eq!((&*hits[0], &*swings[0]), ("1", "2"));
    assert!((number(&swings[5]) - 935.0 / 1600.0).abs() < 1e-15);
    assert!((number(&hits[5]) - 665.0 / 1600.0).abs() < 1e-15);
    assert_eq!((&*swings[4], &*hits[4]), ("yes", "yes"));
    let at = |row: &[String], states: [f64; 2], most: f64| {
        assert!((number(&row[6]) - states[0]).abs() < most, "{row:?}");
        assert!((number(&row[7]) - states[1]).abs() < most, "{row:?}");
    };
    at(swings, [-0.20822397959405, 0.01049795897120002], 1e-14);
    assert!((number(&hits[2]) - 2.0 * TAU / 2.2).abs() < 1e-14);
    // the first line of the reference's picture, v = −1.95
    let first: String = numbers(&path.join("m"))[..40].concat();
    let reference = "1111111111111111000000000000000111111111";
    assert_eq!(first.replace('2', "0"), reference);
    // the orbit of either is there again; a number that is none is told
    for (label, x) in [(1, 0.837829749238), (2, -0.208223979594)] {
        let restart = format!("start: Restart(dir: \"m\", label: {label}), periods: 4");
        let from = IMPACT.find("start: Simulate").unwrap();
        let to = from + IMPACT[from..].find("periods: 4").unwrap() + "periods: 4".len();
        let mut text = IMPACT.to_owned();
        text.replace_range(from..to, &restart);
        let map = text.find("    map: (").unwrap();
        let end = map + text[map..].find("\n    ),\n").unwrap() + 8;
        text.replace_range(
            map..end,
            "    output: (plots: [Time(\"x\")], profiles: 9),\n",
        );
        let text = text.replace("range: (0.5, 5.0)", "range: (0.5, 0.9)");
        fs::write(path.join("r.ron"), &text).unwrap();
        succeed(path, &["run", "r.ron", "--out", "r", "--quiet", "--force"]);
        let (header, rows) = table(&path.join("r"), "branch.csv");
        let column = |name: &str| header.iter().position(|one| one == name).unwrap();
        assert_eq!(number(&rows[0][column("A")]), 0.8);
        let profile = fs::read_to_string(path.join("r/profiles/1.csv")).unwrap();
        let near = profile.lines().skip(1).any(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let phase = number(cells[1]);
            phase.min(TAU - phase) < 0.05 && (number(cells[2]) - x).abs() < 0.05
        });
        assert!(near, "{label}: {profile}");
        let other = text.replace(&format!("label: {label}"), "label: 3");
        fs::write(path.join("r.ron"), other).unwrap();
        let output = run(path, &["run", "r.ron", "--out", "n"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains("they run from 1 to 2"), "{said}");
    }
}

/// A folder with a problem, and its map in `m`.
fn mapped(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), text).unwrap();
    succeed(path, &["map", "p.ron", "--out", "m", "--quiet"]);
    folder
}

/// A basin with two attractors, and their rows.
fn with_two_attractors(text: &str) -> (tempfile::TempDir, Vec<Vec<String>>) {
    let folder = mapped(text);
    let (_, rows) = table(&folder.path().join("m"), "attractors.csv");
    assert_eq!(rows.len(), 2, "{rows:?}");
    (folder, rows)
}

/// A cycle of radius 2 around a point of rest, with the circle of radius 1 between their basins. The cycle has neither
/// switches nor a forcing: wherever a motion comes to it, it is the same.
#[test]
fn a_cycle_is_one_attractor_from_all_sides() {
    let text = r#"(
    system: (
        states: ["x", "y"],
        parameters: {"w": 1.5},
        define: {"r2": "x^2 + y^2", "grow": "-(r2 - 1)*(r2 - 4)/4"},
        modes: {"flow": (rates: {"x": "grow*x - w*y", "y": "grow*y + w*x"})},
    ),
    orbit: (start: Simulate(mode: "flow", state: {"x": 1.5, "y": 0.0}, settle: 40)),
    map: (
        first: (state: "y", range: (-1.3, 1.7)), second: (state: "x", range: (-1.4, 1.6)),
        points: Grid(rows: 4, columns: 4),
    ),
)"#;
    let (folder, rows) = with_two_attractors(text);
    let cycle = &rows[0];
    assert!((number(&cycle[2]) - TAU / 1.5).abs() < 1e-12);
    assert!((number(&cycle[6]).hypot(number(&cycle[7])) - 2.0).abs() < 1e-12);
    let rest = &rows[1];
    assert_eq!((&*rest[2], &*rest[3]), ("", ""));
    assert!(number(&rest[6]).abs() < 1e-9 && number(&rest[7]).abs() < 1e-9);
    for (index, found) in numbers(&folder.path().join("m")).iter().enumerate() {
        let (x, y) = (-1.4 + (index % 4) as f64, -1.3 + (index / 4) as f64);
        assert_eq!(found == "1", x.hypot(y) > 1.0, "{x} {y}");
    }
}

/// Two rotations, p' = p(i + g(p, q)) and q' = q(-i + g(q, p)), of which the larger one survives, seen as sums and differences: the
/// cycles turn opposite ways, with one period and the same extremes of all states.
#[test]
fn cycles_that_turn_opposite_ways_are_two() {
    let text = r#"(
    system: (
        states: ["x", "y", "u", "v"],
        parameters: {"c": 0.5},
        define: {
            "a": "(x + v)/2", "b": "(y + u)/2", "g": "(x - v)/2", "h": "(y - u)/2",
            "P": "c*(1 - a^2 - b^2 - 2*(g^2 + h^2))", "Q": "c*(1 - g^2 - h^2 - 2*(a^2 + b^2))",
            "da": "a*P - b", "db": "b*P + a", "dg": "g*Q + h", "dh": "h*Q - g",
        },
        modes: {"m": (rates: {"x": "da + dg", "y": "db + dh", "u": "db - dh", "v": "da - dg"})},
    ),
    orbit: (start: Simulate(mode: "m", state: {"x": 0.0, "y": 0.0, "u": 0.3, "v": 0.1}, settle: 100)),
    map: (
        first: (state: "x", range: (-1.5, 1.4)), second: (state: "y", range: (-1.4, 1.5)),
        points: Grid(rows: 4, columns: 4),
    ),
)"#;
    let (folder, _) = with_two_attractors(text);
    // |p| > |q| where xv + yu > 0
    let turns = |index: usize| {
        let part = |steps: usize| 2.9 / 3.0 * steps as f64;
        let (x, y) = (-1.5 + part(index / 4), -1.4 + part(index % 4));
        0.1 * x + 0.3 * y > 0.0
    };
    let found = numbers(&folder.path().join("m"));
    for (index, number) in found.iter().enumerate() {
        assert_eq!(
            *number == found[0],
            turns(index) == turns(0),
            "{index}: {found:?}"
        );
    }
}

/// A block at rest anywhere within the reach of its friction is one attractor, a family.
#[test]
fn points_of_rest_of_a_family_are_one_attractor() {
    let text = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"F": 0.5},
        contacts: {"q": Friction(slip: "v", bound: "F")},
        rates: {"x": "v", "v": "-x + q"},
    ),
    orbit: (start: Simulate(mode: "forward", state: {"x": 0.0, "v": 1.0}, settle: 40)),
    map: (
        first: (state: "x", range: (-2.0, 2.1)), second: (state: "v", range: (-2.0, 2.0)),
        points: Grid(rows: 3, columns: 3),
    ),
)"#;
    let folder = mapped(text);
    let path = folder.path();
    let (_, rows) = table(&path.join("m"), "attractors.csv");
    assert_eq!(rows.len(), 1, "{rows:?}");
    assert_eq!((&*rows[0][1], number(&rows[0][5])), ("stick", 1.0));
    assert!(number(&rows[0][6]).abs() <= 0.5);
}

/// Two modes that meet in x = 0, each around a point of rest: a motion begins in the mode of its state.
#[test]
fn a_motion_begins_in_the_mode_of_its_state() {
    let text = r#"(
    system: (
        states: ["x", "y"],
        parameters: {"a": 1.0},
        modes: {
            "right": (rates: {"x": "a - x", "y": "-y"}, until: [(zero: "x", to: "left")]),
            "left": (rates: {"x": "-a - x", "y": "-y"}, until: [(zero: "-x", to: "right")]),
        },
    ),
    orbit: (start: Simulate(mode: "right", state: {"x": 1.0, "y": 0.0}, settle: 60)),
    map: (
        first: (state: "y", range: (-1.0, 1.0)), second: (state: "x", range: (-3.0, 2.0)),
        points: Grid(rows: 2, columns: 6),
        shares: (parameter: "a", values: Linear(0.5, 1.0, 2), draws: 40, seed: 1, within: {"x": (-3.0, 1.0)}),
    ),
)"#;
    let folder = mapped(text);
    let path = folder.path();
    let (_, rows) = table(&path.join("m"), "attractors.csv");
    let modes: Vec<&str> = rows.iter().map(|row| &*row[1]).collect();
    assert_eq!(modes, ["left", "right"]);
    for (row, x) in rows.iter().zip([-1.0, 1.0]) {
        assert!((number(&row[6]) - x).abs() < 1e-12, "{row:?}");
    }
    // x = −3, −2, −1 lead to the left; 0 lies in the mode of the start
    assert_eq!(numbers(&path.join("m"))[..6].concat(), "111222");
    let (_, rows) = table(&path.join("m"), "shares.csv");
    for row in rows.iter().filter(|row| row[3] == "left") {
        // three quarters of the range, four standard errors of 40
        assert!((number(&row[7]) - 0.75).abs() < 4.0 * (0.1875_f64 / 40.0).sqrt());
    }
    assert_eq!(rows.iter().filter(|row| row[3] == "left").count(), 2);
}

/// One table, one list of attractors and one picture, whoever computes what.
#[test]
fn the_bytes_of_one_basin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = IMPACT.replace("rows: 40, columns: 40", "rows: 5, columns: 7");
    fs::write(path.join("p.ron"), &text).unwrap();
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
    let names = [
        "map.csv",
        "map.svg",
        "map.ron",
        "attractors.csv",
        "attractors.ron",
    ];
    for name in names {
        assert!(read("whole", name).len() > 100);
        assert!(read("whole", name) == read("both", name), "{name}: threads");
        assert!(
            read("whole", name) == read("merged", name),
            "{name}: shards"
        );
    }
    fs::remove_file(path.join("both/rows/000000001.csv")).unwrap();
    fs::remove_file(path.join("both/attractors.csv")).unwrap();
    succeed(path, &["map", "p.ron", "--out", "both", "--resume"]);
    for name in names {
        assert!(read("whole", name) == read("both", name), "{name}: resumed");
    }
    let picture = String::from_utf8(read("whole", "map.svg")).unwrap();
    let places = ["1: 2T: ", "2: T: free, no switch"].map(|name| picture.find(name));
    assert!(places[0].is_some() && places[0] < places[1], "{picture}");
    succeed(path, &["plot", "both"]);
    succeed(path, &["report", "both"]);
}

#[test]
fn bad_planes_of_states_are_told_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (from, to, message) in [
        ("(state: \"v\"", "(state: \"u\"", "`u` is no state"),
        ("(state: \"v\"", "(state: \"x\"", "must be different"),
        ("(state: \"v\"", "(parameter: \"A\"", "needs a `parameter`"),
        ("(state: \"x\"", "(parameter: \"A\"", "needs a `state`"),
        (
            "(state: \"v\"",
            "(state: \"v\", parameter: \"A\"",
            "needs a `state`",
        ),
        ("(-1.95, 0.95)", "(0.95, -1.95)", "the lower end first"),
        ("\"e\"", "\"share\"", "column of the attractors"),
    ] {
        let text = IMPACT.replace(from, to).replace(
            "-e*v",
            if to == "\"share\"" {
                "-share*v"
            } else {
                "-e*v"
            },
        );
        fs::write(path.join("p.ron"), text).unwrap();
        let output = run(path, &["map", "p.ron", "--out", "m"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.code() == Some(2) && said.contains(message),
            "{to}: {said}"
        );
    }
}

/// The origin and the cycle of radius 2 about it, with the circle of radius `a` between their basins: of initial states
/// evenly in a square of side 4 a share of πa²/16 comes to the origin.
#[test]
fn shares_are_those_of_the_areas() {
    let text = r#"(
    system: (
        states: ["x", "y"],
        parameters: {"w": 1.5, "a": 1.0},
        define: {"r2": "x^2 + y^2", "grow": "-(r2 - a^2)*(r2 - 4)/4"},
        modes: {"flow": (rates: {"x": "grow*x - w*y", "y": "grow*y + w*x"})},
    ),
    orbit: (start: Simulate(mode: "flow", state: {"x": 1.5, "y": 0.0}, settle: 60)),
    map: (
        first: (state: "y", range: (-1.3, 1.7)), second: (state: "x", range: (-1.4, 1.6)),
        points: Grid(rows: 2, columns: 2),
        shares: (
            parameter: "a", values: Linear(0.8, 1.2, 2), draws: 20, seed: 3,
            within: {"x": (-2.0, 2.0), "y": (-2.0, 2.0)},
        ),
    ),
)"#;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.ron"), text).unwrap();
    succeed(path, &["map", "p.ron", "--out", "one", "--threads", "1"]);
    succeed(path, &["map", "p.ron", "--out", "two", "--threads", "2"]);
    let read = |out: &str, name: &str| fs::read(path.join(out).join(name)).unwrap();
    for name in ["map.csv", "attractors.csv", "shares.csv", "shares.svg"] {
        assert!(read("one", name) == read("two", name), "{name}");
    }
    assert_eq!(numbers(&path.join("one")).len(), 4);
    let (header, rows) = table(&path.join("one"), "shares.csv");
    let names = "value,found,attractor,regimes,period,periods,stable,share,x,y";
    assert_eq!(header.join(","), names);
    for a in [0.8, 1.2] {
        let here = rows
            .iter()
            .filter(|row| (number(&row[0]) - a).abs() < 1e-12);
        let share = |found: &str| -> f64 {
            let of = here.clone().filter(|row| row[1] == found);
            of.map(|row| number(&row[7])).sum()
        };
        let (rest, cycle) = (share("equilibrium"), share("orbit"));
        assert!((rest + cycle - 1.0).abs() < 1e-12);
        let area = std::f64::consts::PI * a * a / 16.0;
        // 20 motions: four standard errors
        let error = (area * (1.0 - area) / 20.0).sqrt();
        assert!((rest - area).abs() < 4.0 * error, "{a}: {rest} {area}");
        assert_eq!(here.clone().filter(|row| row[1] == "orbit").count(), 1);
    }
    succeed(path, &["plot", "one"]);
    // other numbers begin elsewhere
    fs::write(path.join("p.ron"), text.replace("seed: 3", "seed: 4")).unwrap();
    succeed(path, &["map", "p.ron", "--out", "other"]);
    assert!(read("one", "shares.csv") != read("other", "shares.csv"));
    for (from, to, message) in [
        (
            "parameter: \"a\"",
            "parameter: \"b\"",
            "`b` is no parameter",
        ),
        ("draws: 20", "draws: 0", "`map.shares.draws` is 0"),
        (
            "Linear(0.8, 1.2, 2)",
            "Linear(1.6, 1.2, 2)",
            "the lower end first",
        ),
        ("within: {\"x\"", "within: {\"z\"", "`z` is no state"),
    ] {
        fs::write(path.join("p.ron"), text.replace(from, to)).unwrap();
        let output = run(path, &["map", "p.ron", "--out", "m"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.code() == Some(2) && said.contains(message),
            "{to}: {said}"
        );
    }
}
