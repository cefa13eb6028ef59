//! A labelled wave of an earlier run begins a new branch.

use crate::cli::harness::{Bench, SMALL, Table, changed, off, problem, snapshot};

/// A problem that restarts from a label of `base`, in friction.
fn from_label(label: usize, toward: &str) -> String {
    let start = format!("start: Restart(dir: \"base\", label: {label})");
    let text = changed(SMALL, "start: Fast", &start);
    let text = changed(&text, "parameter: Mismatch", "parameter: Friction");
    let text = changed(&text, "range: (0.19, 0.2)", "range: (0.49, 0.51)");
    let text = changed(&text, "[0.195]", "[]");
    changed(&text, "toward: Down", &format!("toward: {toward}"))
}

/// A folder with the branch to restart from.
fn base() -> Bench {
    let bench = Bench::new();
    bench.put("base.ron", problem("mode4_mismatch.ron"));
    bench
        .run(&["run", "base.ron", "--out", "base", "--quiet"])
        .expect(0);
    bench
}

#[test]
fn every_label_can_be_gone_on_from_in_another_parameter() {
    let bench = base();
    let before = snapshot(&bench.path("base"));
    let branch = Table::read(&bench.path("base/branch.csv"));
    let labels = Table::read(&bench.path("base/events.csv")).rows.len();
    assert!(labels > 10);
    for row in 0..branch.rows.len() {
        // start, user points and the end: at the other events the regimes are about to change
        if !["EP", "UZ"].contains(&branch.text(row, "type")) {
            continue;
        }
        let label = branch.text(row, "label").parse().expect("a label");
        for (toward, ends) in [
            ("Down", [0.49].as_slice()),
            ("Up", &[0.51]),
            ("Both", &[0.49, 0.51]),
        ] {
            bench.put("problem.ron", from_label(label, toward));
            let outcome = bench.run(&["run", "problem.ron", "--out", "out", "--force"]);
            outcome.expect(0);
            let found = Table::read(&bench.path("out/branch.csv"));
            let here = format!("label {label}, {toward}");
            let [first, speed] = [found.number(0, "speed"), branch.number(row, "speed")];
            assert!(
                off(first, speed) <= 1e-13,
                "{here}: c = {first}, was {speed}"
            );
            assert_eq!(
                found.text(0, "regimes"),
                branch.text(row, "regimes"),
                "{here}"
            );
            assert_eq!(
                found.text(0, "mismatch"),
                branch.text(row, "mismatch"),
                "{here}"
            );
            assert_eq!(
                found.text(0, "friction"),
                branch.text(row, "friction"),
                "{here}"
            );
            // the mismatch stays, the friction coefficient goes where it was sent
            let last: Vec<f64> = found
                .all("type", "EP")
                .into_iter()
                .map(|row| found.number(row, "friction"))
                .filter(|friction| *friction != 0.5)
                .collect();
            assert_eq!(last, ends, "{here}");
            let parts = if toward == "Both" { 2 } else { 1 };
            assert_eq!(found.all("type", "EP").len(), 2 * parts, "{here}");
        }
    }
    // what one restarts from is only read
    assert!(snapshot(&bench.path("base")) == before);
}

/// The way down and back again ends where it began.
#[test]
fn there_and_back() {
    let bench = base();
    let branch = Table::read(&bench.path("base/branch.csv"));
    let row = branch.all("type", "UZ")[0];
    let label = branch.text(row, "label").parse().expect("a label");
    bench.put("there.ron", from_label(label, "Down"));
    bench.run(&["run", "there.ron", "--out", "there"]).expect(0);
    let there = Table::read(&bench.path("there/branch.csv"));
    let last = there.rows.len() - 1;
    let (value, end) = (there.text(last, "friction"), there.text(last, "label"));
    assert_eq!(value, "4.8999999999999999e-1");
    let text = changed(&from_label(label, "Up"), "\"base\"", "\"there\"");
    let text = changed(&text, &format!("label: {label}"), &format!("label: {end}"));
    let text = changed(&text, "(0.49, 0.51)", "(0.49, 0.5)");
    bench.put("back.ron", text);
    bench.run(&["run", "back.ron", "--out", "back"]).expect(0);
    let back = Table::read(&bench.path("back/branch.csv"));
    let last = back.rows.len() - 1;
    assert_eq!(back.number(last, "friction"), 0.5);
    assert!(off(back.number(last, "speed"), branch.number(row, "speed")) <= 1e-13);
}

#[test]
fn restarts_that_cannot_be_are_refused() {
    let bench = base();
    let good = from_label(8, "Down");
    for (from, to, said) in [
        ("\"base\"", "\"missing\"", "missing/branch.ron"),
        ("\"base\"", "\"base.ron\"", "base.ron/branch.ron"),
        ("label: 8", "label: 0", "no label 0"),
        ("label: 8", "label: 500", "no label 500"),
        ("mode: 4", "mode: 5", "mode"),
        // the label has f = 0.5
        ("(0.49, 0.51)", "(0.6, 0.7)", "outside the range"),
        ("(0.49, 0.51)", "(0.5, 0.7)", "end of the range"),
    ] {
        bench.put("problem.ron", changed(&good, from, to));
        let stderr = bench
            .run(&["run", "problem.ron", "--out", "out"])
            .expect(2)
            .stderr;
        assert!(stderr.contains(said), "{to}: {stderr}");
        assert!(!bench.path("out").exists(), "{to}");
    }
    bench.put("problem.ron", good);
    bench.run(&["run", "problem.ron", "--out", "out"]).expect(0);
}

/// A branch of prescribed period has its own value of the free parameter at every label.
#[test]
fn a_branch_of_prescribed_period_is_gone_on_from() {
    let bench = Bench::new();
    let wave = changed(
        &problem("wave_as_orbit.ron"),
        "range: (0.0003, 0.2), toward: Down, stop_at: [0.045]",
        "range: (0.15, 0.2), toward: Down, stop_at: [0.17]",
    );
    bench.put("wave.ron", wave.clone());
    let wave_of = ["run", "wave.ron", "--out", "r", "--quiet"];
    bench.run(&wave_of).expect(0);
    let start = "start: Restart(dir: \"r\", label: 2)";
    let given = &wave[wave.find("start: Given").unwrap()..wave.find(", period: \"2*pi").unwrap()];
    bench.put("on.ron", changed(&wave, given, start));
    bench
        .run(&["run", "on.ron", "--out", "on", "--quiet"])
        .expect(0);
    let [first, again] =
        ["r", "on"].map(|dir| Table::read(&bench.path(&format!("{dir}/branch.csv"))));
    let at = |table: &Table, row: usize| ["d", "c"].map(|name| table.number(row, name));
    let label = (0..first.rows.len()).find(|row| first.text(*row, "label") == "2");
    // it is solved for once more
    for (one, other) in at(&first, label.unwrap()).iter().zip(at(&again, 0)) {
        assert!(
            (one - other).abs() <= 8.0 * f64::EPSILON,
            "{one} and {other}"
        );
    }
}
