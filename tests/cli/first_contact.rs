//! What meets somebody who tries the program on a tube of their own: SI units, hints, views, options.

use std::f64::consts::TAU;
use std::fs;

use crate::cli::harness::{Bench, PROBLEMS, SMALL, Table, changed};

/// A ring of steel; its mismatch is far above the waves that lift off.
const STEEL: &str = r#"(
    tube: (young: 210e9, density: 7850, poisson: 0.29, inner: 0.1, outer: 0.15, oversize: 50e-6,
           rotation: Rpm(600), friction: 0.3),
    wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (3e-4, 1e-3)),
    output: (plots: [Diagram]),
)"#;

/// A tube in metres gives the tables of its model, with hertz beside them, in those of events too.
#[test]
fn a_tube_in_metres_is_followed_like_its_model() {
    let bench = Bench::new();
    bench.put("si.ron", changed(STEEL, "(3e-4, 1e-3)", "(2e-5, 5e-4)"));
    let omega = 600.0 * TAU / 60.0;
    let gamma = 7850.0 * (0.1 * omega) * (0.1 * omega) / 210e9;
    let tube = &STEEL[STEEL.find("tube").expect("a tube")..STEEL.find("    wave").expect("a wave")];
    let model = format!(
        "model: (coefficients: Geometry(nu: 0.29, xi: {:?}, gamma: {gamma:?}), friction: 0.3, mismatch: {:?}),",
        0.15 / 0.1,
        50e-6 / 0.1
    );
    let plain = changed(STEEL, "(3e-4, 1e-3)", "(2e-5, 5e-4)").replace(tube.trim_end(), &model);
    bench.put("plain.ron", plain);
    for name in ["si", "plain"] {
        bench
            .run(&["run", &format!("{name}.ron"), "--out", name])
            .expect(0);
    }
    let table = |name: &str| Table::read(&bench.path(name));
    let (si, plain) = (table("si/branch.csv"), table("plain/branch.csv"));
    assert_eq!(si.rows.len(), plain.rows.len());
    for row in 0..si.rows.len() {
        assert_eq!(si.text(row, "speed"), plain.text(row, "speed"));
    }
    let events = table("si/events.csv");
    assert!(events.rows.len() > 3);
    for row in 0..events.rows.len() {
        let hertz = 4.0 * events.number(row, "speed").abs() * omega / TAU;
        assert!((events.number(row, "hertz") / hertz - 1.0).abs() < 1e-15);
    }
    assert!(
        !fs::read_to_string(bench.path("plain/events.csv"))
            .expect("a table")
            .contains("hertz")
    );
    // no ear hears steel of this size, and nothing else is odd about it
    let said = bench.run(&["steady", "si.ron"]).expect(0).stderr;
    assert!(
        said.contains("about 42 kHz") && said.matches(" si.ron: ").count() == 1,
        "{said}"
    );
}

/// A run without a change of regime says where the first ones are, and there they are.
#[test]
fn a_run_without_events_says_where_they_are() {
    let bench = Bench::new();
    bench.put("high.ron", STEEL);
    let said = bench
        .run(&["run", "high.ron", "--out", "high"])
        .expect(0)
        .stdout;
    let number = |before: &str| -> f64 {
        let rest = said
            .split(before)
            .nth(1)
            .unwrap_or_else(|| panic!("{said}"));
        let figure: String = rest.chars().take_while(|c| !c.is_whitespace()).collect();
        figure.parse().expect("a number")
    };
    let (reverse, separation) = (number("an RV at δ = "), number("a GR at about δ = "));
    // as the message about a range in metres says
    bench.put("metres.ron", changed(STEEL, "(3e-4, 1e-3)", "(5e-6, 1e-4)"));
    let refused = bench.run(&["run", "metres.ron"]).expect(2).stderr;
    let (_, range) = refused
        .trim()
        .split_once("a range to begin with is ")
        .expect("advice");
    assert_eq!(range, "(1.21e-6, 1.23e-3)");
    bench.put("low.ron", changed(STEEL, "(3e-4, 1e-3)", range));
    let said = bench
        .run(&["run", "low.ron", "--out", "low"])
        .expect(0)
        .stdout;
    assert!(!said.contains("no change of regime"), "{said}");
    let events = Table::read(&bench.path("low/events.csv"));
    let first = |kind: &str| {
        let row = (0..events.rows.len()).find(|row| events.text(*row, "type") == kind);
        events.number(row.expect(kind), "mismatch")
    };
    assert!((first("RV") / reverse - 1.0).abs() < 1e-6);
    // behind the RV another wave separates
    assert!((first("GR") / separation - 1.0).abs() < 0.5, "{separation}");
}

/// A run that separates says by which landing, and so does its picture.
#[test]
fn the_landing_is_named() {
    let bench = Bench::new();
    let low = changed(SMALL, "(0.19, 0.2)", "(0.045, 0.2)");
    for (name, model, landing, remark) in [
        (
            "plain",
            "mismatch: 0.2,",
            "frictionless impact",
            "not the limit of any damped model",
        ),
        (
            "coulomb",
            "mismatch: 0.2, impact: Coulomb,",
            "Coulomb impact",
            "the limit of small material damping",
        ),
    ] {
        bench.put("p.ron", changed(&low, "mismatch: 0.2,", model));
        let said = bench.run(&["run", "p.ron", "--out", name]).expect(0).stdout;
        assert!(
            said.contains(&format!("landings by {landing}: ")) && said.contains(remark),
            "{said}"
        );
        let picture = fs::read_to_string(bench.path(name).join("diagram.svg")).expect("a picture");
        assert!(picture.contains(landing), "{landing}");
    }
    bench.put("small.ron", SMALL);
    let said = bench.run(&["run", "small.ron"]).expect(0).stdout;
    assert!(!said.contains("landings"), "{said}");
}

/// What cannot be meant is warned of; the tables of the repository, with γ = 1, are not.
#[test]
fn numbers_of_no_real_tube_are_warned_of() {
    let bench = Bench::new();
    let wide = changed(STEEL, "1e-3)", "1)");
    for (to, words) in [
        ("oversize: 0.02", "20.000 % thicker"),
        ("young: 210", "times the speed of sound"),
        ("rotation: RadPerSecond(600)", "`Rpm(600.0)`"),
    ] {
        let field = to.split(':').next().expect("a field");
        let from = STEEL
            .split([',', '(', '\n'])
            .find(|text| text.trim().starts_with(field))
            .expect(field);
        let from = if field == "rotation" {
            "rotation: Rpm(600)"
        } else {
            from.trim()
        };
        bench.put("odd.ron", changed(&wide, from, to));
        let said = bench
            .run(&["steady", "odd.ron", "--modes", "4"])
            .expect(0)
            .stderr;
        assert!(
            said.contains("warning: odd.ron: ") && said.contains(words),
            "{said}"
        );
    }
    let example = format!("{PROBLEMS}/mode4_mismatch.ron");
    assert_eq!(
        bench
            .run(&["steady", &example, "--modes", "4"])
            .expect(0)
            .stderr,
        ""
    );
}

/// Views of nothing are refused, and none is replaced by chance.
#[test]
fn views_show_something() {
    let bench = Bench::new();
    bench.put("p.ron", SMALL);
    bench.run(&["run", "p.ron", "--out", "o"]).expect(0);
    for (options, words) in [
        (
            &["--x", "why", "--y", "label"][..],
            "no numeric column `why`",
        ),
        (
            &["--y", "lead_re"],
            "`lead_re` of branch.csv has no values without the section `stability`",
        ),
        (
            &["--range", "5,6"],
            "no point has `mismatch` from 5 to 6: it goes from 0.19 to 0.2",
        ),
        (&["--range-y", "5,6"], "no point has `speed`"),
        (&["--x", "speed", "--log"], "`speed` is -1.24"),
        (&["--log", "y"], "`speed` is -1.24"),
    ] {
        let said = bench
            .run(&[&["plot", "o"], options].concat())
            .expect(2)
            .stderr;
        assert!(said.contains(words), "{said}");
        assert!(!bench.path("o/view.svg").exists());
    }
    let view = |options: &[&str], code: i32| {
        bench
            .run(&[&["plot", "o"], options].concat())
            .expect(code)
            .stderr
    };
    view(
        &[
            "--y",
            "amplitude",
            "--log",
            "x",
            "--log",
            "y",
            "--range-y",
            "0,1",
        ],
        0,
    );
    let drawn = fs::read(bench.path("o/view.svg")).expect("a picture");
    assert!(view(&["--log", "x"], 2).contains("--force replaces it"));
    assert_eq!(
        fs::read(bench.path("o/view.svg")).expect("a picture"),
        drawn
    );
    view(&["--log", "x", "--force"], 0);
    assert_ne!(
        fs::read(bench.path("o/view.svg")).expect("a picture"),
        drawn
    );
    for verb in ["plot", "report"] {
        let said = bench.run(&[verb, "nothere"]).expect(2).stderr;
        assert!(said.contains("nothere: there is no such folder"), "{said}");
    }
}

/// Options that would be ignored are refused.
#[test]
fn options_without_effect_are_refused() {
    let bench = Bench::new();
    bench.put("p.ron", SMALL);
    for (options, words) in [
        (
            &["spectrum", "p.ron", "--passage", "7"][..],
            "give --at mismatch=VALUE",
        ),
        (
            &[
                "spectrum",
                "p.ron",
                "--at",
                "friction=0.45",
                "--passage",
                "1",
            ],
            "give --at mismatch=VALUE",
        ),
        (
            &[
                "spectrum",
                "p.ron",
                "--at",
                "mismatch=0.193",
                "--at",
                "mismatch=0.194",
            ],
            "--at gives mismatch two values",
        ),
        (
            &["steady", "p.ron", "--at", "nu=0.3", "--at", "nu=0.2"],
            "--at gives nu two values",
        ),
    ] {
        let said = bench.run(options).expect(2).stderr;
        assert!(said.contains(words), "{said}");
    }
}
