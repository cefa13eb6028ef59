//! `brakewave accuracy`: it keeps what it has measured, keeps to its budget, and leaves nothing behind
//! where there is nothing to measure.

use std::fs;

use crate::cli::harness::{Bench, SMALL, Table, changed, problem, snapshot};

/// Every method but the ring, which takes longest.
fn small() -> String {
    changed(
        SMALL,
        "mismatch: 0.2,\n    )",
        "mismatch: 0.2,\n        friction_law: Static(ratio: 1.05),\n    )",
    )
}

/// Rows by cells.
fn rows(text: &str) -> Vec<Vec<&str>> {
    let lines = text.lines().skip(1);
    lines.map(|line| line.split(',').collect()).collect()
}

/// Columns of times.
const TIMES: std::ops::Range<usize> = 9..11;

#[test]
fn what_was_measured_is_kept_on_resuming() {
    let bench = Bench::new();
    bench.put("p.ron", small());
    let measured = [
        "accuracy",
        "p.ron",
        "--out",
        "a",
        "--repeats",
        "1",
        "--quiet",
    ];
    let resumed = [&measured[..], &["--resume"]].concat();
    bench.run(&measured).expect(0);
    let table = bench.path("a/accuracy.csv");
    let whole = fs::read_to_string(&table).expect("a table");
    let names: Vec<&str> = rows(&whole).iter().map(|row| row[0]).collect();
    assert_eq!(names.len(), 11);
    assert_eq!(
        (names[0], names[1], names[10]),
        ("exact", "shooting", "collocation")
    );
    // a finished one is read, not measured again
    let before = snapshot(&bench.path("a"));
    bench.run(&resumed).expect(0);
    assert!(snapshot(&bench.path("a")) == before);
    // no more is promised: times are not measured twice alike
    let help = bench.run(&["accuracy", "--help"]).expect(0).stdout;
    assert!(help.contains("times included"), "{help}");
    assert!(!help.contains("as if it had not been"), "{help}");
    // killed within the fifth row
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    let kept = lines[..5].concat();
    fs::write(&table, format!("{kept}{}", &lines[5][..20])).expect("a file");
    fs::remove_file(bench.path("a/accuracy.svg")).expect("a picture");
    bench.run(&resumed).expect(0);
    let again = fs::read_to_string(&table).expect("a table");
    assert!(again.starts_with(&kept), "{again}");
    assert!(bench.path("a/accuracy.svg").exists());
    let without_times = |text: &str| -> Vec<Vec<String>> {
        let all = rows(text).into_iter();
        all.map(|mut row| {
            row.drain(TIMES);
            row.into_iter().map(str::to_owned).collect()
        })
        .collect()
    };
    assert_eq!(without_times(&again), without_times(&whole));
    // rows that a budget left out come in their places
    fs::write(&table, [lines[0], lines[1], lines[4], lines[8]].concat()).expect("a file");
    bench.run(&resumed).expect(0);
    let again = fs::read_to_string(&table).expect("a table");
    assert_eq!(without_times(&again), without_times(&whole));
    // a row of another table
    for damaged in [
        whole.replace("shooting,tolerance 1e-9", "shooting,tolerance 2e-9"),
        whole.replace("exact,,", "exact,,many"),
        format!("{whole}{}", lines[3]),
    ] {
        fs::write(&table, damaged).expect("a file");
        let said = bench.run(&resumed).expect(4).stderr;
        assert!(
            said.contains("accuracy.csv") && said.contains("--force"),
            "{said}"
        );
    }
    // the folder of something else, and of another problem
    bench
        .run(&["run", "p.ron", "--out", "r", "--quiet"])
        .expect(0);
    let run = snapshot(&bench.path("r"));
    for how in ["--force", "--resume"] {
        bench
            .run(&["accuracy", "p.ron", "--out", "r", how])
            .expect(2);
    }
    assert!(snapshot(&bench.path("r")) == run);
    bench.put("q.ron", small().replace("0.19,", "0.191,"));
    let said = bench
        .run(&["accuracy", "q.ron", "--out", "a", "--resume"])
        .expect(2);
    assert!(said.stderr.contains("another problem"), "{}", said.stderr);
}

/// Nothing is left behind where nothing can be measured.
#[test]
fn what_is_refused_leaves_no_folder() {
    let bench = Bench::new();
    for (problem, code) in [
        // no wave to begin with
        (
            changed(
                SMALL,
                "mismatch: 0.2,\n    )",
                "mismatch: 0.2,\n        damping: (mass: 9.0),\n    )",
            ),
            3,
        ),
        // a start that accuracy does not take
        (
            changed(
                SMALL,
                "start: Fast",
                "start: Restart(dir: \"none\", label: 1)",
            ),
            2,
        ),
        // a Hopf point in a parameter that has none
        (changed(SMALL, "start: Fast", "start: Hopf"), 2),
    ] {
        bench.put("p.ron", problem);
        bench.run(&["accuracy", "p.ron", "--out", "a"]).expect(code);
        assert_eq!(bench.names(), ["p.ron"]);
    }
    bench.put("p.ron", small());
    let said = bench
        .run(&["accuracy", "p.ron", "--out", "p.ron/a"])
        .expect(4);
    assert!(said.stderr.contains("p.ron"), "{}", said.stderr);
    assert_eq!(bench.names(), ["p.ron"]);
}

/// A budget holds for the reference as well, and for the sum of all methods.
#[test]
fn a_budget_is_kept() {
    let bench = Bench::new();
    // one step of the reference of this law takes longer
    bench.put(
        "slow.ron",
        crate::cli::harness::problem("mode4_regularised.ron"),
    );
    let said = bench.run(&["accuracy", "slow.ron", "--out", "a", "--budget", "0.001"]);
    let said = said.expect(2).stderr;
    assert!(
        said.contains("reference") && said.contains("--budget 0.001"),
        "{said}"
    );
    assert_eq!(bench.names(), ["slow.ron"]);
    // enough for the reference, not for every method: of a slow build the least one may not suffice
    bench.put("p.ron", small());
    let cut = ["0.3", "1.2", "4.8"].into_iter().any(|budget| {
        let outcome = bench.run(&[
            "accuracy", "p.ron", "--out", "b", "--budget", budget, "--force",
        ]);
        let left_out = outcome.stderr.contains("of 11 settings were left out");
        let table = || fs::read_to_string(bench.path("b/accuracy.csv")).expect("a table");
        outcome.code == Some(0) && left_out && table().contains("exact")
    });
    assert!(cut);
}

/// The exact flow of a system and its Taylor series come to one another as the tolerance falls, and so does an integrator
/// that knows neither; without an exact flow the series are compared with themselves and with it.
#[test]
fn the_flows_of_a_system_are_compared() {
    let bench = Bench::new();
    let text = problem("impact_oscillator.ron");
    let text = changed(
        &text,
        "range: (0.05, 1.0)",
        "range: (0.8, 1.0), ds: 0.05, ds_max: 0.2",
    );
    bench.put("impact.ron", changed(&text, "settle: 200", "settle: 40"));
    let wall = problem("pendulum_wall.ron");
    let steps = "range: (0.5, 0.53), ds: 0.05, ds_max: 0.2";
    bench.put("wall.ron", changed(&wall, "range: (0.47, 0.53)", steps));
    for (file, exact) in [("impact.ron", true), ("wall.ron", false)] {
        let outcome = bench.run(&["accuracy", file, "--out", "a", "--repeats", "1", "--force"]);
        let said = outcome.expect(0).stdout;
        assert!(said.contains("Eigenvalues: multipliers"), "{said}");
        let table = Table::read(&bench.path("a/accuracy.csv"));
        let methods = ["exact", "taylor", "dop853"].map(|name| table.all("method", name));
        assert_eq!(methods.each_ref().map(Vec::len), [usize::from(exact), 4, 5]);
        let error = |row: &usize| table.number(*row, "switch_error");
        for row in &methods[0] {
            assert!(error(row) < 1e-12 && table.number(*row, "eigenvalue_error") < 1e-12);
        }
        for (rows, finest) in [(&methods[1], 1e-12), (&methods[2], 1e-11)] {
            let (first, last) = (rows.first().unwrap(), rows.last().unwrap());
            assert!(error(first) > error(last) && error(last) < finest, "{said}");
        }
    }
    bench.run(&["plot", "a"]).expect(0);
    bench.run(&["report", "a"]).expect(0);
}
