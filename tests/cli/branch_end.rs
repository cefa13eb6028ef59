//! Waves that do not exist, and branches that end before their range: exit code 3, the reason,
//! and all that was found.

use std::fs;

use crate::cli::harness::{Bench, SMALL, Table, changed, off, snapshot};

/// Where fast and slow wave of mode 4 meet at ν = 0.3, ξ = 1.5, γ = 1.
const FOLD: f64 = 1.0915184203591;
/// Damping at which the stick zone of the mode-4 wave vanishes.
const NO_STICK: f64 = 0.3189475197930335;

/// The branch in damping that ends in a Hopf point of steady sliding.
fn damping() -> String {
    let text = changed(SMALL, "parameter: Mismatch", "parameter: MassDamping");
    let text = changed(&text, "range: (0.19, 0.2)", "range: (0.0, 0.4)");
    let text = changed(&text, "toward: Down", "toward: Up");
    changed(&text, "[0.195]", "[0.1]")
}

#[test]
fn a_wave_that_does_not_exist_is_told_with_the_fold() {
    let bench = Bench::new();
    bench.put(
        "problem.ron",
        changed(SMALL, "friction: 0.5", "friction: 1.2"),
    );
    let outcome = bench.run(&["run", "problem.ron"]).expect(3);
    let stderr = &outcome.stderr;
    assert!(stderr.contains("fold"), "{stderr}");
    let named = stderr
        .split_whitespace()
        .filter_map(|word| word.trim_end_matches([',', ';', ':', '.']).parse().ok())
        .any(|number: f64| off(number, FOLD) < 1e-10);
    assert!(named, "no f = {FOLD} in {stderr}");
    // there is no branch, hence no folder that --force would be needed for
    assert_eq!(bench.names(), ["problem.ron"]);
}

#[test]
fn a_branch_that_ends_early_keeps_what_was_found() {
    let bench = Bench::new();
    let few = "toward: Up, max_points: 40";
    bench.put("problem.ron", changed(&damping(), "toward: Up", few));
    let outcome = bench.run(&["run", "problem.ron", "--out", "out"]).expect(3);
    assert!(
        outcome.stderr.contains("ended before its range: "),
        "{}",
        outcome.stderr
    );
    // the report is printed all the same
    assert!(outcome.stdout.contains("UZ at "), "{}", outcome.stdout);
    let out = bench.path("out");
    let events = Table::read(&out.join("events.csv"));
    let branch = Table::read(&out.join("branch.csv"));
    let kinds: Vec<&str> = (0..events.rows.len())
        .map(|row| events.text(row, "type"))
        .collect();
    assert_eq!(kinds, ["EP", "UZ", "MX"]);
    // the reason is in the table as well, in the words of the warning
    let what = events.text(2, "what");
    assert!(what.len() > 20 && outcome.stderr.contains(what), "{what}");
    let last = branch.rows.len() - 1;
    assert_eq!(branch.text(last, "type"), "MX");
    assert_eq!(last, 40, "the way there is kept");
    for label in 1..=branch.all("label", "").len().abs_diff(last + 1) {
        assert!(
            out.join(format!("profiles/{label}.csv")).exists(),
            "profile {label}"
        );
    }
    assert!(out.join("diagram.svg").exists());
    // that run is finished: going on with it says the same and changes nothing
    let before = snapshot(&out);
    let again = bench
        .run(&["run", "problem.ron", "--out", "out", "--resume"])
        .expect(3);
    assert!(again.stderr.contains(what), "{}", again.stderr);
    assert!(snapshot(&out) == before);
    // a label of it can be restarted from
    assert!(fs::read_to_string(out.join("branch.ron")).is_ok_and(|text| text.contains("label:3")));
}

/// The slip-stick waves end where steady sliding has its Hopf point, in the vertical
/// family of waves that slip everywhere. That is no failure.
#[test]
fn a_branch_into_the_hopf_point_is_done() {
    let bench = Bench::new();
    bench.put("problem.ron", damping());
    let outcome = bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    assert_eq!(outcome.stderr, "");
    let events = Table::read(&bench.path("out/events.csv"));
    let branch = Table::read(&bench.path("out/branch.csv"));
    let (event, row) = (events.rows.len() - 1, branch.rows.len() - 1);
    assert_eq!(branch.text(row, "type"), "ST");
    assert!(off(branch.number(row, "mass_damping"), NO_STICK) < 1e-10);
    assert_eq!(events.text(event, "type"), "ST");
    assert_eq!(events.text(event, "regimes_before"), "slip-stick");
    assert_eq!(events.text(event, "regimes_after"), "slip");
    assert!(events.all("type", "MX").is_empty());
    // from the other side: the last wave of the family that begins at the Hopf point is the same
    let other = changed(&damping(), "start: Fast", "start: Hopf");
    bench.put("other.ron", changed(&other, "toward: Up", "toward: Down"));
    bench.run(&["run", "other.ron", "--out", "other"]).expect(0);
    let other = Table::read(&bench.path("other/branch.csv"));
    let opens = other.only("type", "ST");
    for column in ["mass_damping", "speed", "amplitude", "min_pressure"] {
        let (one, two) = (branch.number(row, column), other.number(opens, column));
        assert!(off(one, two) < 1e-12, "{column}: {one} and {two}");
    }
}

#[test]
fn a_branch_that_was_to_end_there_is_done() {
    let bench = Bench::new();
    let stop = "toward: Up, stop_after: [(event: ST, count: 1)]";
    bench.put("problem.ron", changed(&damping(), "toward: Up", stop));
    let outcome = bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    assert_eq!(outcome.stderr, "");
    let branch = Table::read(&bench.path("out/branch.csv"));
    let last = branch.rows.len() - 1;
    assert_eq!(branch.text(last, "type"), "ST");
    assert!(off(branch.number(last, "mass_damping"), NO_STICK) < 1e-10);
    let events = Table::read(&bench.path("out/events.csv"));
    assert!(events.all("type", "MX").is_empty());
}

/// The start lies on an end of the range, where one of both ways is none.
#[test]
fn both_ways_from_an_end_of_the_range_is_one_way() {
    let bench = Bench::new();
    bench.put(
        "problem.ron",
        changed(SMALL, "toward: Down", "toward: Both"),
    );
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    let branch = Table::read(&bench.path("out/branch.csv"));
    for row in 0..branch.rows.len() {
        let mismatch = branch.number(row, "mismatch");
        assert!(
            (0.19..=0.2 * (1.0 + 1e-15)).contains(&mismatch),
            "{mismatch}"
        );
    }
    assert_eq!(branch.text(branch.rows.len() - 1, "type"), "EP");
    assert_eq!(branch.number(branch.rows.len() - 1, "mismatch"), 0.19);
}

/// Friction drives waves and damping ends them: that is the side on which a branch leaves a Hopf point,
/// and it comes to the end of its range there.
#[test]
fn a_branch_from_a_hopf_point_goes_where_there_are_waves() {
    let bench = Bench::new();
    for (parameter, damping, range, column, end) in [
        ("Friction", "mass: 0.3", "(0.4, 0.5)", "friction", 0.5),
        (
            "MassDamping",
            "mass: 0.0",
            "(0.31, 0.4)",
            "mass_damping",
            0.31,
        ),
        (
            "StiffnessDamping",
            "stiffness: 0.0",
            "(0.0121, 0.2)",
            "stiffness_damping",
            0.0121,
        ),
    ] {
        bench.put(
            "p.ron",
            format!(
                "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
                 mismatch: 0.9, damping: ({damping})), wave: (mode: 4, start: Hopf), \
                 continuation: (parameter: {parameter}, range: {range}))"
            ),
        );
        let outcome = bench.run(&["run", "p.ron", "--out", "out", "--force"]);
        outcome.expect(0);
        let branch = Table::read(&bench.path("out/branch.csv"));
        let last = branch.rows.len() - 1;
        assert_eq!(branch.number(last, column), end, "{parameter}");
        assert_eq!(branch.text(last, "regimes"), "slip-stick", "{parameter}");
        assert_eq!(branch.text(0, "regimes"), "slip", "{parameter}");
    }
}

/// Why a branch ended is kept as data. A folder of before, which has a sentence there, is shown as ever, but not
/// gone on with.
#[test]
fn why_a_branch_ended_is_no_sentence() {
    let bench = Bench::new();
    let few = "toward: Up, max_points: 40";
    bench.put("problem.ron", changed(&damping(), "toward: Up", few));
    let run = ["run", "problem.ron", "--out", "out", "--quiet"];
    let said = bench.run(&run).expect(3).stderr;
    let resume = [&run[..], &["--resume"]].concat();
    assert_eq!(bench.run(&resume).expect(3).stderr, said);
    let path = bench.path("out/branch.ron");
    let text = std::fs::read_to_string(&path).expect("a restart file");
    let data = "Ended(MaxPoints(most:40))";
    assert_eq!(text.matches(data).count(), 2, "{text}");
    std::fs::write(&path, text.replace(data, "\"max_points = 40\"")).expect("a file");
    for show in ["plot", "report"] {
        bench.run(&[show, "out"]).expect(0);
    }
    let before = snapshot(&bench.path("out"));
    let said = bench.run(&resume).expect(4).stderr;
    assert!(said.contains("branch.ron: damaged"), "{said}");
    assert!(snapshot(&bench.path("out")) == before);
}
