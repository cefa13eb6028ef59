//! Names of switches in sequences: where a mode follows itself, the sequence says by which switch.

use std::fs;

use crate::cli::harness::{Bench, Table, changed};

/// The oscillator that hits a stop: its impact leads from `free` to `free`.
const IMPACT: &str = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"c": 0.1, "A": 0.12, "w": 1.0, "d": 1.0, "e": 0.8},
        forcing: "w",
        modes: {"free": (
            rates: {"x": "v", "v": "A*cos(phase) - c*v - x"},
            until: [(zero: "d - x", name: "hit", to: "free", reset: {"v": "-e*v"})],
        )},
    ),
    orbit: (start: Given(mode: "free", state: {"x": 1.0, "v": -0.08}, phase: 1.03)),
    continuation: (parameter: "A", range: (0.05, 0.12), toward: Down),
    stability: (),
    curve: (event: GR, parameters: ("A", "w"), range: ((0.05, 0.2), (0.9, 1.1))),
    output: (plots: [Diagram]),
    expect: [(event: GR, A: 0.1, tolerance: 1e-12, regimes_before: "free(hit)", regimes_after: "free")],
)"#;

const NAME: &str = "name: \"hit\", ";

/// An orbit with an impact is `free(hit)`, and one without is `free`: in tables, lines of the terminal, expectations, legends and
/// curves. But for that the tables are those of the file without the name.
#[test]
fn an_orbit_with_an_impact_has_another_name_than_one_without() {
    let bench = Bench::new();
    bench.put("named.ron", IMPACT);
    bench.put("plain.ron", changed(IMPACT, NAME, ""));
    let said = bench.run(&["run", "named.ron", "--out", "named"]).expect(0);
    assert!(
        said.stdout.contains("free(hit) → free; "),
        "{}",
        said.stdout
    );
    bench.run(&["run", "plain.ron", "--out", "plain"]).expect(0);
    let text = |file: &str| fs::read_to_string(bench.path(file)).unwrap();
    let branch = Table::read(&bench.path("named/branch.csv"));
    for row in 0..branch.rows.len() {
        let switches = !branch.text(row, "switches").is_empty();
        let expected = if switches { "free(hit)" } else { "free" };
        assert_eq!(branch.text(row, "regimes"), expected);
    }
    let events = Table::read(&bench.path("named/events.csv"));
    let graze = events.only("type", "GR");
    assert_eq!(events.text(graze, "regimes_before"), "free(hit)");
    assert_eq!(events.text(graze, "regimes_after"), "free");
    for table in ["branch.csv", "events.csv"] {
        let unnamed = text(&format!("named/{table}")).replace("free(hit)", "free");
        assert!(unnamed == text(&format!("plain/{table}")), "{table}");
    }
    let picture = text("named/diagram.svg");
    for name in ["free(hit)", "free"] {
        let lines = picture.lines().filter(|line| *line == name);
        assert_eq!(lines.count(), 1, "{name} in the legend");
    }
    bench.run(&["check", "named.ron"]).expect(0);
    let wrong = changed(
        IMPACT,
        "regimes_before: \"free(hit)\"",
        "regimes_before: \"free\"",
    );
    bench.put("wrong.ron", wrong);
    let outcome = bench.run(&["check", "wrong.ron"]).expect(1);
    let message = "regimes before: expected free, found free(hit)";
    assert!(outcome.stdout.contains(message), "{}", outcome.stdout);
    bench
        .run(&["curve", "named.ron", "--out", "curve", "--quiet"])
        .expect(0);
    let curve = Table::read(&bench.path("curve/curve.csv"));
    for row in 0..curve.rows.len() {
        let sides = ["regimes_before", "regimes_after"].map(|column| curve.text(row, column));
        assert_eq!(sides, ["free(hit)", "free"]);
    }
}

/// A certificate says by which switch a zone ends; one that says it otherwise is refused.
#[test]
fn the_names_in_a_certificate_are_checked() {
    let bench = Bench::new();
    bench.put("named.ron", IMPACT);
    bench
        .run(&["certify", "named.ron", "--out", "proof", "--quiet"])
        .expect(0);
    bench.run(&["certify", "--verify", "proof"]).expect(0);
    let path = bench.path("proof/certificate.ron");
    let honest = fs::read_to_string(&path).unwrap();
    let theorem = fs::read_to_string(bench.path("proof/theorem.md")).unwrap();
    assert!(theorem.contains("the zones free(hit) (guard 0, exit 0)."));
    let label = "label: Some(\"hit\"),";
    assert!(honest.matches(label).count() > 1);
    for forged in [
        honest.replace(label, "label: Some(\"miss\"),"),
        honest.replace(label, ""),
    ] {
        fs::write(&path, forged).unwrap();
        let outcome = bench.run(&["certify", "--verify", "proof"]).expect(1);
        assert!(
            outcome.stdout.contains("the name of a zone"),
            "{}",
            outcome.stdout
        );
    }
}

/// A block that friction holds while a clock jumps back: sliding follows itself by the switch of both of its modes. Where the load is
/// too large it slips, and the first mode follows itself.
const CLOCK: &str = r#"(
    system: (
        states: ["v", "t"],
        parameters: {"F": 1.0, "a": 1.9},
        modes: {
            "forth": (rates: {"v": "-F + a*(t - 0.5)", "t": "1"},
                until: [(zero: "v", to: "back"), (zero: "1 - t", to: "forth", reset: {"t": "0"}, name: "tick")]),
            "back": (rates: {"v": "F + a*(t - 0.5)", "t": "1"},
                until: [(zero: "-v", to: "forth"), (zero: "1 - t", to: "back", reset: {"t": "0"}, name: "tick")]),
        },
        sliding: {"stick": ("forth", "back")},
    ),
    orbit: (start: Simulate(mode: "forth", state: {"v": 0.5, "t": 0.0}, settle: 50)),
    continuation: (parameter: "a", range: (1.8, 2.2), toward: Up),
)"#;

#[test]
fn sliding_that_follows_itself_says_so() {
    let bench = Bench::new();
    bench.put("clock.ron", CLOCK);
    bench
        .run(&["run", "clock.ron", "--out", "run", "--quiet"])
        .expect(0);
    let events = Table::read(&bench.path("run/events.csv"));
    // a(1 - 0.5) = F
    let slips = events.only("type", "CO");
    assert!((events.number(slips, "a") - 2.0).abs() < 1e-12);
    assert_eq!(events.text(slips, "regimes_before"), "stick(tick)");
    assert_eq!(
        events.text(slips, "regimes_after"),
        "forth(tick)-forth-back-stick"
    );
}

/// The names of contacts, and those of switches that lead to another mode, are in no sequence.
#[test]
fn other_names_are_not_shown() {
    let bench = Bench::new();
    let until = IMPACT.find("modes:").unwrap()..IMPACT.find("    orbit:").unwrap();
    let contact = IMPACT.replace(
        &IMPACT[until],
        "contacts: {\"p\": Stop(gap: \"d - x\", restitution: \"e\")},\n        \
         rates: {\"x\": \"v\", \"v\": \"A*cos(phase) - c*v - x - p\"}),\n",
    );
    let contact = changed(&contact, "mode: \"free\"", "mode: \"open\"");
    let elsewhere = r#"(
        system: (states: ["x", "v"], parameters: {"A": 1.0, "k": 1.0}, modes: {
            "up": (rates: {"x": "1", "v": "-v"}, until: [(zero: "1 - x", name: "top", to: "down", reset: {"v": "v + A"})]),
            "down": (rates: {"x": "-k", "v": "-v"}, until: [(zero: "x", name: "bottom", to: "up")]),
        }),
        orbit: (start: Simulate(mode: "up", state: {"x": 0.5, "v": 0.0}, settle: 40)),
        continuation: (parameter: "A", range: (0.5, 2.0)),
    )"#;
    for (text, name) in [(&*contact, "open"), (elsewhere, "up-down")] {
        bench.put("other.ron", text);
        bench
            .run(&["run", "other.ron", "--out", "other", "--quiet", "--force"])
            .expect(0);
        let branch = Table::read(&bench.path("other/branch.csv"));
        assert_eq!(branch.all("regimes", name).len(), branch.rows.len());
    }
}

/// A name has nothing that sequences or tables use.
#[test]
fn a_name_is_a_word() {
    let bench = Bench::new();
    for name in ["", "my hit", "hit-2", "a.b", "a,b", "hit)", "2nd"] {
        let named = changed(IMPACT, NAME, &format!("name: \"{name}\", "));
        bench.put("named.ron", named);
        let outcome = bench.run(&["run", "named.ron", "--out", "named"]).expect(2);
        let message = "named.ron:8:";
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
        let message = "a name is a letter followed by letters, digits and `_`";
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
}
