//! Branches of equilibria from the command line: tables, pictures, what is refused, and the ways on from a label.

use crate::cli::harness::{Bench, Table, assert_same, changed, problem, snapshot};

fn followed(name: &str) -> Bench {
    let bench = Bench::new();
    bench.put("problem.ron", problem(&format!("{name}.ron")));
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
    bench
}

#[test]
fn a_run_has_states_eigenvalues_and_hopf_points_in_its_tables() {
    let bench = followed("brusselator");
    let branch = Table::read(&bench.path("out/branch.csv"));
    for row in 0..branch.rows.len() {
        let [x, y, b] = ["x", "y", "B"].map(|column| branch.number(row, column));
        assert!((x - 1.0).abs() <= 1e-14 && (y - b).abs() <= 1e-13);
        // λ² + (2 − B)λ + 1 = 0
        let (half, square) = (0.5 * (b - 2.0), 0.25 * (b - 2.0).powi(2) - 1.0);
        let im = f64::sqrt(-square);
        let [re, found] = ["re", "im"].map(|column| branch.number(row, column));
        assert!((re - half).abs() <= 1e-12 && (found - im).abs() <= 1e-12);
        let grows = if b > 2.0 { "2" } else { "0" };
        assert!(branch.text(row, "type") == "HB" || branch.text(row, "unstable") == grows);
    }
    let events = Table::read(&bench.path("out/events.csv"));
    let hopf = events.only("type", "HB");
    assert!((events.number(hopf, "lyapunov") + 0.5).abs() <= 1e-13);
    assert!((events.number(hopf, "omega") - 1.0).abs() <= 1e-13);
    let label = events.text(hopf, "label").to_owned();
    let eigenvalues = Table::read(&bench.path("out/eigenvalues.csv"));
    assert_eq!(eigenvalues.all("label", &label).len(), 2);
    bench.run(&["check", "problem.ron"]).expect(0);
    bench.run(&["report", "out"]).expect(0);
    bench.run(&["plot", "out", "--y", "y"]).expect(0);
    // the same run once more, and one that has nothing left to do
    let full = snapshot(&bench.path("out"));
    let again = ["run", "problem.ron", "--out", "out", "--quiet", "--resume"];
    bench.run(&again).expect(0);
    assert_same(&snapshot(&bench.path("out")), &full, "resumed");
    // the cycle that is born there, which is stable
    let text = changed(
        &problem("brusselator.ron"),
        "equilibrium: (start: Given(mode: \"flow\", state: {\"x\": 1.0, \"y\": 1.5})),",
        &format!("orbit: (start: Switch(dir: \"out\", label: {label})), stability: (),"),
    );
    let expected = &text[text.find("    expect").expect("an expectation")..];
    let text = changed(&text, expected, ")\n");
    let text = changed(&text, "Column(\"y\")", "Column(\"period\")");
    bench.put("cycle.ron", &text);
    bench.run(&["run", "cycle.ron", "--out", "cycle"]).expect(0);
    let branch = Table::read(&bench.path("cycle/branch.csv"));
    assert!(branch.number(0, "B") > 2.0 && branch.text(0, "stable") == "yes");
    // an equilibrium is no orbit to restart from, and an orbit no equilibrium
    bench.put(
        "no.ron",
        changed(&text, "Switch(dir: \"out\"", "Restart(dir: \"out\""),
    );
    bench.run(&["run", "no.ron"]).expect(2);
    let text = changed(&text, "dir: \"out\"", "dir: \"cycle\"");
    bench.put(
        "no.ron",
        changed(
            &text,
            "orbit: (start: Switch(dir: \"cycle\"",
            "equilibrium: (start: Switch(dir: \"cycle\"",
        ),
    );
    bench.run(&["run", "no.ron"]).expect(2);
}

#[test]
fn beyond_boundaries_the_run_goes_on_and_its_expectations_are_met() {
    let bench = followed("harvest");
    bench.run(&["check", "problem.ron"]).expect(0);
    let events = Table::read(&bench.path("out/events.csv"));
    let all = events.all("type", "BE");
    let what = |row: usize| events.text(row, "what").to_owned();
    assert!(what(all[0]).starts_with("nonsmooth fold") && what(all[1]).starts_with("persistence"));
    // in another parameter, from a label in sliding
    let label = events.text(events.only("type", "LP"), "label");
    let text = problem("harvest.ron");
    let text = changed(
        &text,
        "start: Given(mode: \"low\", state: {\"x\": 0.21, \"y\": 0.4})",
        &format!("start: Restart(dir: \"out\", label: {label})"),
    );
    let text = changed(
        &text,
        "parameter: \"al\", range: (0.3, 0.6)",
        "parameter: \"h\", range: (0.1, 0.2)",
    );
    let expected = &text[text.find("    expect").expect("an expectation")..];
    bench.put("other.ron", changed(&text, expected, ")\n"));
    // a fold is one in every parameter that moves the equilibrium, and h does not
    let outcome = bench.run(&["run", "other.ron"]);
    outcome.expect(3);
}

#[test]
fn a_curve_of_hopf_points_has_states_in_its_table() {
    let bench = Bench::new();
    let text = problem("fitzhugh_curve.ron");
    bench.put("problem.ron", &text);
    let run = ["curve", "problem.ron", "--out", "out", "--quiet"];
    bench.run(&run).expect(0);
    let table = Table::read(&bench.path("out/curve.csv"));
    let end = table.only("type", "BT");
    assert!((table.number(end, "b") - 0.08_f64.powf(-0.5)).abs() <= 1e-12);
    assert!(table.number(end, "omega").abs() <= 1e-6 && table.text(end, "lyapunov").is_empty());
    let degenerate = table.only("type", "GH");
    let v = -f64::sqrt(1.0 - 0.08 * table.number(degenerate, "b"));
    assert!((table.number(degenerate, "v") - v).abs() <= 1e-12);
    assert!(table.number(degenerate, "lyapunov").abs() <= 1e-12);
    bench.run(&["plot", "out"]).expect(0);
    bench.run(&["report", "out"]).expect(0);
    let full = snapshot(&bench.path("out"));
    let again = [
        "curve",
        "problem.ron",
        "--out",
        "out",
        "--quiet",
        "--resume",
    ];
    bench.run(&again).expect(0);
    assert_same(&snapshot(&bench.path("out")), &full, "resumed");
    // the same from a label of a run
    bench.run(&["run", "problem.ron", "--out", "run"]).expect(0);
    let events = Table::read(&bench.path("run/events.csv"));
    let label = events.text(events.all("type", "HB")[0], "label").to_owned();
    let event = format!("event: Label(dir: \"run\", label: {label})");
    bench.put(
        "label.ron",
        changed(
            &text,
            "event: HB, parameters",
            &format!("{event}, parameters"),
        ),
    );
    bench
        .run(&["curve", "label.ron", "--out", "label"])
        .expect(0);
    let table = Table::read(&bench.path("label/curve.csv"));
    assert!(table.all("type", "BT").len() == 1 && table.all("type", "GH").len() == 1);
    // what is no event of equilibria, and what is none of orbits
    bench.put(
        "no.ron",
        changed(&text, "event: HB, parameters", "event: PD, parameters"),
    );
    let outcome = bench.run(&["curve", "no.ron"]).expect(2);
    assert!(
        outcome.stderr.contains("no curve of PD"),
        "{}",
        outcome.stderr
    );
    bench.put(
        "no.ron",
        changed(&problem("impact_curve.ron"), "event: LP, p", "event: BE, p"),
    );
    let outcome = bench.run(&["curve", "no.ron"]).expect(2);
    assert!(
        outcome.stderr.contains("no curve of BE"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn what_has_no_equilibria_is_refused() {
    let bench = Bench::new();
    let text = problem("brusselator.ron");
    let cases = [
        (
            changed(
                &text,
                "states: [\"x\", \"y\"],",
                "states: [\"x\", \"y\"], forcing: \"A\",",
            ),
            "forcing",
        ),
        (
            changed(
                &text,
                "equilibrium: (",
                "orbit: (start: Restart(dir: \"out\", label: 1)), equilibrium: (",
            ),
            "beside `orbit`",
        ),
        (
            changed(&text, "mode: \"flow\"", "mode: \"flaw\""),
            "`flaw` is no mode",
        ),
        (
            changed(&text, "Column(\"y\")", "Multipliers"),
            "shows orbits",
        ),
        (
            changed(&text, "event: HB", "event: PD"),
            "no event of equilibria",
        ),
        (
            changed(
                &text,
                "Given(mode: \"flow\", state: {\"x\": 1.0, \"y\": 1.5})",
                "Steady(mode: \"flow\", index: 0)",
            ),
            "counted from 1",
        ),
    ];
    for (text, words) in cases {
        bench.put("problem.ron", &text);
        let outcome = bench.run(&["run", "problem.ron"]).expect(2);
        assert!(
            outcome.stderr.contains(words),
            "{words}: {}",
            outcome.stderr
        );
    }
    // an equilibrium that is not there
    let text = changed(
        &text,
        "Given(mode: \"flow\", state: {\"x\": 1.0, \"y\": 1.5})",
        "Steady(mode: \"flow\", index: 7)",
    );
    bench.put("problem.ron", &text);
    let outcome = bench.run(&["run", "problem.ron"]).expect(3);
    assert!(
        outcome.stderr.contains("number 7 is asked for"),
        "{}",
        outcome.stderr
    );
    // what is proven of an equilibrium is no matter of arcs
    bench.put("problem.ron", problem("brusselator.ron"));
    bench.run(&["certify", "problem.ron"]).expect(0);
    let outcome = bench.run(&["certify", "problem.ron", "--arcs"]).expect(2);
    assert!(
        outcome.stderr.contains("`--arcs` is of waves and orbits"),
        "{}",
        outcome.stderr
    );
}
