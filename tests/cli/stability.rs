//! What the tables and messages say about stability.

use crate::cli::harness::{Bench, Table, changed, problem};

/// A stable-looking wave: nothing grows in sector 0, something does in sector 2.
const ONE_SECTOR: &str = r#"(
    model: (
        coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
        friction: 0.5,
        mismatch: 0.2,
        damping: (mass: 0.26, stiffness: 0.0),
    ),
    wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (0.195, 0.2), toward: Down),
    stability: (sectors: Only([0]), eigenvalues: 6, max_frequency: 12.0),
)
"#;

fn spectrum(bench: &Bench, arguments: &[&str]) -> (Table, String) {
    let mut all = vec!["spectrum"];
    all.extend(arguments);
    let outcome = bench.run(&all).expect(0);
    (Table::parse(outcome.stdout.as_bytes()), outcome.stderr)
}

#[test]
fn a_wave_is_stable_only_in_all_sectors() {
    let bench = Bench::new();
    let answer = |text: &str| {
        bench.put("p.ron", text);
        bench
            .run(&["run", "p.ron", "--out", "out", "--force", "--quiet"])
            .expect(0);
        let table = Table::read(&bench.path("out/branch.csv"));
        let column = |name| table.text(0, name).to_owned();
        (column("stable"), column("unstable"), column("why"))
    };
    let (stable, unstable, why) = answer(ONE_SECTOR);
    assert_eq!((stable.as_str(), unstable.as_str()), ("undecided", "0"));
    assert_eq!(why, "sectors not asked for: 1 2");
    // the growth is in another one, and `no` may be said from it alone
    let (stable, unstable, why) = answer(&changed(ONE_SECTOR, "[0]", "[2]"));
    assert_eq!((stable.as_str(), why.as_str()), ("no", ""));
    assert_ne!(unstable, "0");
    let (stable, unstable, _) = answer(&changed(ONE_SECTOR, "Only([0])", "All"));
    assert_eq!((stable.as_str(), unstable.as_str()), ("no", "4"));
    // more damping: each sector by itself proves nothing, all of them do
    let damped = changed(ONE_SECTOR, "mass: 0.26", "mass: 0.3172");
    let (stable, ..) = answer(&changed(&damped, "[0]", "[0, 1, 2]"));
    assert_eq!(stable, "yes");
    for list in ["[0]", "[1, 2]"] {
        let (stable, ..) = answer(&changed(&damped, "[0]", list));
        assert_eq!(stable, "undecided", "{list}");
    }
    let (table, stderr) = spectrum(&bench, &["p.ron", "--sector", "0"]);
    assert_eq!(table.text(0, "stable"), "undecided");
    assert!(stderr.contains("sectors not asked for: 1 2"), "{stderr}");
}

/// `stable` is plain from `unstable`, or `why` says where it comes from.
#[test]
fn a_verdict_has_its_reason() {
    let bench = Bench::new();
    for name in ["mode4_stability.ron", "mode4_damping.ron", "mode4_hopf.ron"] {
        let mut text = problem(name);
        if !text.contains("stability: (") {
            text = changed(
                &text,
                "    output: (",
                "    stability: (sectors: All),\n    output: (",
            );
        }
        bench.put("p.ron", text);
        bench
            .run(&["run", "p.ron", "--out", "out", "--force", "--quiet"])
            .expect(0);
        let table = Table::read(&bench.path("out/branch.csv"));
        let mut reasons = 0;
        for row in 0..table.rows.len() {
            let why = table.text(row, "why");
            let plain = match table.text(row, "stable") {
                "yes" => true,
                "no" => !matches!(table.text(row, "unstable"), "" | "0"),
                _ => false,
            };
            assert!(plain || !why.is_empty(), "{name}, row {row}");
            reasons += usize::from(!why.is_empty());
            if why.starts_with("grows at high frequency") {
                let (_, limit) = why.split_once("sup Re = ").expect("the limit");
                assert!(limit.parse::<f64>().expect("a number") > 0.0);
            }
        }
        println!("observed: {name}: {reasons} rows with a reason");
        assert!(reasons > 0, "{name}");
    }
}

/// 28 647 eigenvalues grow (counted by another program); they are too many to be listed.
#[test]
fn what_is_not_listed_is_counted_and_said() {
    let bench = Bench::new();
    bench.put(
        "p.ron",
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.02, \
         mismatch: 100.0), wave: (mode: 4, start: Slow), \
         continuation: (parameter: Mismatch, range: (99.0, 100.0), toward: Down, \
         stop_at: [99.998], stop_after: [(event: UZ, count: 1)]), \
         stability: (sectors: All, eigenvalues: 2, max_frequency: 12.0))",
    );
    let outcome = bench
        .run(&["run", "p.ron", "--out", "out", "--quiet"])
        .expect(0);
    assert!(outcome.stderr.contains("incomplete"), "{}", outcome.stderr);
    let table = Table::read(&bench.path("out/branch.csv"));
    for row in 0..table.rows.len() {
        assert_eq!(table.text(row, "unstable"), "28647");
        let why = table.text(row, "why");
        assert!(
            why.starts_with("incomplete: ") && why.ends_with(" of 28647 counted"),
            "{why}"
        );
    }
}

/// At a take-off the separation zone has no length, and its jump is 0/0: no count, not a count of 0.
#[test]
fn a_run_that_restarts_from_a_change_of_regime_has_no_count_there() {
    let text = |start: &str, toward: &str| {
        format!(
            "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
             mismatch: 0.045), wave: (mode: 4, start: {start}), \
             continuation: (parameter: Mismatch, range: (0.045, 0.06), toward: {toward}), \
             stability: (sectors: All, eigenvalues: 2, max_frequency: 12.0))"
        )
    };
    let bench = Bench::new();
    bench.put("base.ron", text("Fast", "Up"));
    bench
        .run(&["run", "base.ron", "--out", "base", "--quiet"])
        .expect(0);
    let events = Table::read(&bench.path("base/events.csv"));
    let label = |row: usize| events.text(row, "label").to_owned();
    let changes: Vec<String> = events.all("type", "GR").into_iter().map(label).collect();
    let [label] = &changes[..] else {
        panic!("one take-off, not {changes:?}");
    };
    let of = |table: &Table, kind: &str| -> Vec<f64> {
        let rows = table.all("type", kind).into_iter();
        rows.map(|row| table.number(row, "mismatch")).collect()
    };
    for toward in ["Down", "Up"] {
        let start = format!("Restart(dir: \"base\", label: {label})");
        bench.put("again.ron", text(&start, toward));
        bench
            .run(&["run", "again.ron", "--out", "out", "--force", "--quiet"])
            .expect(0);
        let branch = Table::read(&bench.path("out/branch.csv"));
        assert_eq!(branch.text(0, "stable"), "undecided");
        assert_eq!(branch.text(0, "unstable"), "");
        assert!(branch.text(0, "why").contains("zone without length"));
        let again = Table::read(&bench.path("out/events.csv"));
        for row in 0..again.rows.len() {
            assert!(!again.text(row, "what").contains("crossing:  before"));
        }
        if toward == "Down" {
            // every HB below the take-off is met again, those of the first step too
            let (found, expected) = (of(&again, "HB"), of(&events, "HB"));
            let take_off = branch.number(0, "mismatch");
            let expected: Vec<f64> = expected.into_iter().filter(|one| *one < take_off).collect();
            assert!(expected.len() > 3);
            assert_eq!(found.len(), expected.len());
            for (one, other) in found.iter().zip(expected.iter().rev()) {
                assert!((one - other).abs() < 1e-11, "{one} for {other}");
            }
        }
    }
}

/// Sectors j and k − j are conjugate, on the command line too.
#[test]
fn a_sector_beyond_half_the_mode_is_the_conjugate_of_its_mirror() {
    let bench = Bench::new();
    bench.put("p.ron", problem("mode4_stability.ron"));
    let at = ["p.ron", "--at", "mismatch=0.045", "--sector"];
    let (one, _) = spectrum(&bench, &[&at[..], &["1"]].concat());
    let (other, _) = spectrum(&bench, &[&at[..], &["3"]].concat());
    assert_eq!(one.rows.len(), other.rows.len());
    assert!(one.rows.len() > 3);
    let mut complex = 0;
    for row in 0..one.rows.len() {
        assert_eq!(
            [one.text(row, "sector"), other.text(row, "sector")],
            ["1", "3"]
        );
        assert_eq!(one.text(row, "unstable"), other.text(row, "unstable"));
        let [re, im] = ["re", "im"].map(|name| (one.number(row, name), other.number(row, name)));
        assert!(
            (re.0 - re.1).abs() < 1e-11 && (im.0 + im.1).abs() < 1e-11,
            "{re:?} {im:?}"
        );
        complex += usize::from(im.0.abs() > 1e-3);
    }
    assert!(complex > 0);
}

/// The branch turns back: at f = 1 there are several waves, and one of them is taken.
#[test]
fn the_other_passages_are_named() {
    let bench = Bench::new();
    bench.put("p.ron", problem("mode4_friction.ron"));
    let at = ["p.ron", "--at", "friction=1.0", "--sector", "0"];
    let (first, stderr) = spectrum(&bench, &at);
    assert!(stderr.contains("passes friction = 1"), "{stderr}");
    assert!(
        stderr.contains("this is passage 1, `--passage N` takes another"),
        "{stderr}"
    );
    let (second, _) = spectrum(&bench, &[&at[..], &["--passage", "2"]].concat());
    let speeds = [&first, &second].map(|table| table.number(0, "speed"));
    assert!((speeds[0] - speeds[1]).abs() > 1e-3, "{speeds:?}");
    // one passage only, and the branch followed to its end: nothing to say
    let (_, stderr) = spectrum(&bench, &["p.ron", "--at", "friction=0.25"]);
    assert!(!stderr.contains("pass"), "{stderr}");
}
