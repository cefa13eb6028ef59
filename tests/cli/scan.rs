//! Scans: samples by closed form, the same bytes however they are computed, and what is refused.

use std::f64::consts::TAU;
use std::fs;

use crate::cli::harness::{Bench, Table, changed};

/// An oscillator that hits a stop at d.
fn problem(scan: &str) -> String {
    format!(
        r#"(
    title: "scanned",
    system: (
        states: ["x", "v"],
        parameters: {{"c": 0.1, "A": 1.0, "w": 1.5, "d": 1.0, "e": 0.8}},
        forcing: "w",
        modes: {{"free": (
            rates: {{"x": "v", "v": "A*cos(phase) - c*v - x"}},
            until: [(zero: "d - x", to: "free", reset: {{"v": "-e*v"}})],
        )}},
    ),
    orbit: (start: Simulate(mode: "free", state: {{"x": 0.0, "v": 0.0}}, settle: 200)),
    continuation: (parameter: "A", range: (0.5, 1.2), toward: Down),
    scan: ({scan}),
)"#
    )
}

const SWEEP: &str =
    "parameter: \"A\", values: Linear(0.8, 2.4, 40), sweep: Both, settle: 30, keep: 4";
const FRESH: &str =
    "parameter: \"A\", values: Linear(0.8, 2.4, 40), sweep: Fresh, seed: 7, settle: 0, keep: 2";

fn scanned(bench: &Bench, out: &str, more: &[&str]) -> String {
    let arguments = [&["scan", "p.ron", "--quiet", "--out", out], more].concat();
    bench.run(&arguments).expect(0);
    fs::read_to_string(bench.path(out).join("scan.csv")).unwrap()
}

/// Below the graze x = Re(A e^{iφ}/(1 − ω² + icω)), whatever the sweep and the section; from rest it swings to twice that
/// at most, and does not touch.
#[test]
fn samples_below_the_graze_have_a_closed_form() {
    let (c, w): (f64, f64) = (0.1, 1.5);
    let (re, im) = (1.0 - w * w, c * w);
    let size = re.hypot(im);
    for (section, phase) in [
        ("Phase(0.0)", Some(0.0)),
        ("Phase(-1.0)", Some(TAU - 1.0)),
        ("Zero(\"v\")", None),
        ("Zero(\"-v\")", None),
    ] {
        let bench = Bench::new();
        bench.put(
            "p.ron",
            problem(&format!(
                "parameter: \"A\", values: Linear(0.2, 0.6, 3), sweep: Both, settle: 400, keep: 3, section: {section}"
            )),
        );
        let table = Table::parse(scanned(&bench, "s", &[]).as_bytes());
        assert_eq!(table.rows.len(), 18);
        for row in 0..table.rows.len() {
            let number = |column| table.number(row, column);
            let expected = match (phase, section) {
                (Some(phase), _) => {
                    assert_eq!(number("phase"), phase);
                    (re * phase.cos() + im * phase.sin()) / size.powi(2)
                }
                (None, "Zero(\"v\")") => -1.0 / size,
                (None, _) => 1.0 / size,
            };
            // what is left of the start is exp(−cT/2) = 1e-36; each of 1200 periods, a sweep of three values, rounds
            // a phase of 2500 to 2e-13
            let error = (number("x") - number("value") * expected).abs();
            assert!(error < 1200.0 * 3e-13, "{section}: {error:e}");
            assert_eq!(table.text(row, "sample"), (row % 3).to_string());
            let up = table.text(row, "sweep") == "up";
            assert_eq!(up, row < 9);
            let place = if up { row / 3 } else { 5 - row / 3 };
            assert!((number("value") - [0.2, 0.4, 0.6][place]).abs() < 1e-15);
        }
    }
}

/// Impacts lie in the stop, before the reset; a motion that does not come there says so and is no failure, one that
/// cannot go on is.
#[test]
fn samples_at_impacts_and_their_lack() {
    let bench = Bench::new();
    let section = "settle: 100, keep: 5, section: Zero(\"x - d\")";
    bench.put(
        "p.ron",
        problem(&format!(
            "parameter: \"A\", values: Linear(0.3, 2.0, 2), {section}"
        )),
    );
    let table = Table::parse(scanned(&bench, "s", &[]).as_bytes());
    // A = 0.3 swings to 0.24
    assert_eq!(table.text(0, "sample"), "");
    assert!(
        table
            .text(0, "why")
            .contains("does not come to the section")
    );
    assert_eq!(table.rows.len(), 6);
    for row in 1..6 {
        assert!((table.number(row, "x") - 1.0).abs() < 1e-13);
        assert!(table.number(row, "v") > 0.0);
    }
    // no `if` holds at the second value only
    let text = problem(&format!(
        "parameter: \"A\", values: Linear(0.3, 2.0, 2), {section}"
    ));
    bench.put(
        "p.ron",
        changed(&text, "reset:", "if: [\"1.5 - A\"], reset:"),
    );
    let arguments = ["scan", "p.ron", "--quiet", "--out", "t"];
    let said = bench.run(&arguments).expect(3).stderr;
    assert!(
        said.contains("1 of the motions") && said.contains("A = 2"),
        "{said}"
    );
    bench.run(&["plot", "t"]).expect(0);
}

#[test]
fn the_same_bytes_however_they_are_computed() {
    let exponents = format!("{SWEEP}, lyapunov: 2");
    for (section, shards) in [(SWEEP, 2), (FRESH, 3), (&exponents, 2)] {
        let bench = Bench::new();
        bench.put("p.ron", problem(section));
        let whole = scanned(&bench, "whole", &["--threads", "1"]);
        assert_eq!(whole, scanned(&bench, "parallel", &["--threads", "3"]));
        let names: Vec<String> = (1..=shards).map(|shard| format!("shard{shard}")).collect();
        for (number, name) in names.iter().enumerate() {
            let shard = format!("{}/{shards}", number + 1);
            let arguments = ["scan", "p.ron", "--quiet", "--shard", &shard, "--out", name];
            bench.run(&arguments).expect(0);
            bench.run(&["plot", name]).expect(2);
        }
        let mut merge = vec!["scan", "merge", "--out", "merged"];
        merge.extend(names.iter().map(String::as_str));
        bench.run(&merge).expect(0);
        let read = |folder: &str| fs::read_to_string(bench.path(folder).join("scan.csv")).unwrap();
        assert_eq!(whole, read("merged"));
        // a piece in the middle of a sweep is computed again from the one before it
        fs::remove_file(bench.path("whole/rows/000000001.csv")).unwrap();
        fs::remove_file(bench.path("whole/scan.csv")).unwrap();
        assert_eq!(whole, scanned(&bench, "whole", &["--resume"]));
        bench.run(&["scan", "p.ron", "--out", "whole"]).expect(2);
    }
}

/// Random starts lie in their ranges and within the mode, and depend on the seed.
#[test]
fn random_starts_are_those_of_the_seed() {
    let bench = Bench::new();
    let text = problem(&format!(
        "{FRESH}, within: {{\"x\": (0.5, 1.5)}}, section: Phase(0.0)"
    ));
    // a stronger force holds what begins next to the stop there, after infinitely many impacts
    let text = changed(&text, "Linear(0.8, 2.4, 40)", "Linear(0.3, 0.8, 40)");
    bench.put("p.ron", &text);
    let first = scanned(&bench, "a", &[]);
    let table = Table::parse(first.as_bytes());
    let mut seen = Vec::new();
    for row in (0..table.rows.len()).step_by(2) {
        // with nothing to settle the first sample is the start
        let (x, v) = (table.number(row, "x"), table.number(row, "v"));
        assert!((0.5..1.0).contains(&x) && v == 0.0, "{x} {v}");
        seen.push(x);
    }
    let mean = seen.iter().sum::<f64>() / seen.len() as f64;
    // 40 numbers of variance 1/48 about 0.75: five standard errors
    assert!(
        (mean - 0.75).abs() < 5.0 / (48.0_f64 * 40.0).sqrt(),
        "{mean}"
    );
    bench.put("p.ron", changed(&text, "seed: 7", "seed: 8"));
    assert_ne!(first, scanned(&bench, "b", &[]));
}

/// A branch is drawn over a scan, if it is one in the same parameter.
#[test]
fn a_branch_is_drawn_over_a_scan() {
    let bench = Bench::new();
    bench.put(
        "p.ron",
        problem("parameter: \"A\", values: Linear(0.6, 1.2, 5), settle: 50, keep: 2"),
    );
    scanned(&bench, "s", &[]);
    bench
        .run(&["run", "p.ron", "--quiet", "--out", "r"])
        .expect(0);
    bench.run(&["plot", "s", "--over", "r"]).expect(0);
    let picture = fs::read_to_string(bench.path("s/scan_over.svg")).unwrap();
    assert!(picture.contains("greatest and least x") && picture.contains("polyline"));
    let said = bench.run(&["plot", "r", "--over", "s"]).expect(2).stderr;
    assert!(said.contains("no scan"), "{said}");
    let said = bench.run(&["plot", "s", "--over", "s"]).expect(2).stderr;
    assert!(said.contains("no branch of orbits in `A`"), "{said}");
    bench.run(&["report", "s"]).expect(0);
    let page = fs::read_to_string(bench.path("s/report.html")).unwrap();
    assert!(page.contains("What motions settle on") && page.contains("scan.csv"));
}

/// The exponents stand in every row of their value, below each other in the picture, and change nothing else.
#[test]
fn exponents_are_columns_of_their_own() {
    let bench = Bench::new();
    bench.put("p.ron", problem(SWEEP));
    let without = scanned(&bench, "without", &[]);
    bench.put("p.ron", problem(&format!("{SWEEP}, lyapunov: 2")));
    let with = scanned(&bench, "with", &[]);
    let header =
        "value,sweep,sample,x,v,phase,mode,lyapunov,lyapunov_error,lyapunov_2,lyapunov_2_error,why";
    assert_eq!(with.lines().next(), Some(header));
    let bare = with.lines().map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        [&cells[..7], &cells[11..]].concat().join(",")
    });
    assert_eq!(
        bare.collect::<Vec<_>>(),
        without.lines().collect::<Vec<_>>()
    );
    let picture = fs::read_to_string(bench.path("with/scan.svg")).unwrap();
    assert!(picture.contains("exponents λ"));
    // volumes shrink by e^(−cT) in a period and by e² at each of its impacts, of which there is one
    let table = Table::parse(with.as_bytes());
    let sum = table.number(0, "lyapunov") + table.number(0, "lyapunov_2");
    let expected = -0.1 + 2.0 * 0.8_f64.ln() * 1.5 / TAU;
    assert!((sum - expected).abs() < 1e-12, "{sum} {expected}");
}

/// A view of a scan shows any of its states, and nothing that only a branch has.
#[test]
fn a_scan_is_drawn_in_any_state() {
    let bench = Bench::new();
    bench.put("p.ron", problem(SWEEP));
    scanned(&bench, "out", &[]);
    bench.run(&["plot", "out", "--y", "v"]).expect(0);
    let drawn = |name: &str| fs::read_to_string(bench.path("out").join(name)).unwrap();
    assert!(drawn("view.svg").contains(">\nv\n<") && !drawn("view.svg").contains(">\nx\n<"));
    assert!(drawn("scan.svg").contains(">\nx\n<"));
    // it was drawn already
    bench.run(&["plot", "out", "--y", "v"]).expect(2);
    bench.run(&["plot", "out", "--y", "v", "--force"]).expect(0);
    let refused = bench.run(&["plot", "out", "--y", "phase", "--force"]);
    assert!(refused.expect(2).stderr.contains("samples have x, v"));
    for option in ["--x", "--range"] {
        let value = if option == "--x" { "v" } else { "0,1" };
        bench.run(&["plot", "out", option, value]).expect(2);
    }
}

#[test]
fn bad_scans_are_told_with_their_place() {
    let bench = Bench::new();
    let good = format!("{SWEEP}, section: Phase(0.0)");
    for (from, to, message) in [
        (
            "parameter: \"A\", values",
            "parameter: \"B\", values",
            "`B` is no parameter",
        ),
        (
            "Linear(0.8, 2.4, 40)",
            "Linear(2.4, 0.8, 40)",
            "the lower end first",
        ),
        ("Linear(0.8, 2.4, 40)", "Linear(0.8, 2.4, 1)", "from 2 to"),
        ("keep: 4", "keep: 0", "`scan.keep` is 0"),
        ("settle: 30", "settle: -1", "`scan.settle`"),
        ("Phase(0.0)", "Zero(\"x - dd\")", "did you mean `d`"),
        ("Phase(0.0)", "Zero(\"x -\")", "makes no sense"),
        ("sweep: Both", "sweep: Bth", "Both"),
        ("settle: 30", "settle: 30, seed: 3", "sweep: Fresh"),
        (
            "sweep: Both",
            "sweep: Fresh, within: {\"x\": (0.0, 1.0)}",
            "seed",
        ),
        (
            "sweep: Both",
            "sweep: Fresh, seed: 1, within: {\"y\": (0.0, 1.0)}",
            "`y` is no state",
        ),
        (
            "sweep: Both",
            "sweep: Fresh, seed: 1, within: {\"x\": (1.0, 0.0)}",
            "the lower end first",
        ),
        ("settle: 30", "setle: 30", "settle"),
        (
            "keep: 4",
            "keep: 4, lyapunov: 3",
            "the system has 2 of them",
        ),
        ("keep: 4", "keep: 4, lyapunov: 0", "`scan.lyapunov` is 0"),
        ("keep: 4", "keep: 4, lyapunov: -1", "how many exponents"),
        ("keep: 4", "keep: 4, lyapunov: \"x\"", "how many exponents"),
        ("keep: 4", "keep: 1, lyapunov: true", "at least two"),
    ] {
        bench.put("p.ron", problem(&changed(&good, from, to)));
        let said = bench.run(&["scan", "p.ron", "--out", "s"]).expect(2).stderr;
        assert!(
            said.contains(message) && said.contains("help"),
            "{to}: {said}"
        );
        assert!(!bench.path("s").exists());
    }
    // the place within the expression
    bench.put(
        "p.ron",
        problem(&changed(&good, "Phase(0.0)", "Zero(\"x - dd\")")),
    );
    let said = bench.run(&["scan", "p.ron"]).expect(2).stderr;
    assert!(said.contains("^^") && said.contains("p.ron:14:"), "{said}");
    // without forcing there is no phase
    let text = changed(&problem(&good), "        forcing: \"w\",\n", "");
    let text = changed(&text, "A*cos(phase)", "A*w");
    bench.put("p.ron", changed(&text, "settle: 200", "settle: 20"));
    let said = bench.run(&["scan", "p.ron"]).expect(2).stderr;
    assert!(
        said.contains("no `forcing`") && said.contains("Zero("),
        "{said}"
    );
    // a tube, and a system without the section
    bench.put("p.ron", crate::cli::harness::SMALL);
    let said = bench.run(&["scan", "p.ron"]).expect(2).stderr;
    assert!(said.contains("waves of a tube"), "{said}");
    let text = problem(&good);
    bench.put(
        "p.ron",
        changed(&text, &format!("    scan: ({good}),\n"), ""),
    );
    let said = bench.run(&["scan", "p.ron"]).expect(2).stderr;
    assert!(said.contains("missing field `scan`"), "{said}");
}
