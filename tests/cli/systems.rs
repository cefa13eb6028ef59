//! Problem files with systems of one's own: equilibria, motions, and the verbs that are for waves of a tube.

use std::f64::consts::TAU;

use crate::cli::harness::{Bench, Table, assert_same, changed, problem, snapshot};

/// One of the repository's problem files.
fn system(name: &str) -> String {
    problem(&format!("{name}.ron"))
}

/// Chua's circuit rests at x = ±1.5, y = 0, z = −x, and at the origin: λ³ + … of the inner region has one root above 0.
#[test]
fn equilibria_are_listed_mode_by_mode() {
    let bench = Bench::new();
    bench.put("chua.ron", system("chua"));
    let outcome = bench
        .run(&["steady", "chua.ron", "--at", "alpha=9"])
        .expect(0);
    let table = Table::parse(outcome.stdout.as_bytes());
    for (row, mode, x) in [(0, "inner", 0.0), (1, "upper", 1.5), (2, "lower", -1.5)] {
        assert_eq!(table.text(row, "mode"), mode);
        assert_eq!(table.text(row, "equilibrium"), "admissible");
        assert_eq!(table.text(row, "stable"), "no");
        for (state, expected) in [("x", x), ("y", 0.0), ("z", -x)] {
            assert!((table.number(row, state) - expected).abs() < 1e-13);
        }
        let sum: f64 = table
            .text(row, "re")
            .split(' ')
            .map(|re| re.parse::<f64>().unwrap())
            .sum();
        // the trace: −αm or −αn, and −1
        let slope = if row == 0 { -1.0 / 7.0 } else { 2.0 / 7.0 };
        assert!((sum + 9.0 * slope + 1.0).abs() < 1e-12, "{mode}: {sum}");
    }
    // as a table and as a folder
    let folder = ["steady", "chua.ron", "--at", "alpha=9", "--out", "rest"];
    assert_eq!(bench.run(&folder).expect(0).stdout, outcome.stdout);
    let files = snapshot(&bench.path("rest"));
    assert_eq!(
        files[std::path::Path::new("steady.csv")],
        outcome.stdout.as_bytes()
    );
    bench.run(&folder).expect(2);
    bench.run(&["plot", "rest"]).expect(2);
    bench.run(&["report", "rest"]).expect(0);
    // a relay rests in sliding only
    bench.put("relay.ron", system("relay"));
    let outcome = bench.run(&["steady", "relay.ron"]).expect(0);
    let table = Table::parse(outcome.stdout.as_bytes());
    let kinds =
        ["plus", "minus", "slide"].map(|mode| table.text(table.only("mode", mode), "equilibrium"));
    assert_eq!(kinds, ["virtual", "virtual", "admissible"]);
    assert!(table.text(0, "why").contains("minus"), "{}", outcome.stdout);
    assert_eq!(table.text(2, "re").split(' ').count(), 2);
    // what is forced does not rest
    bench.put("impact.ron", system("impact_oscillator"));
    let outcome = bench.run(&["steady", "impact.ron"]).expect(0);
    let table = Table::parse(outcome.stdout.as_bytes());
    assert_eq!(
        [table.text(0, "equilibrium"), table.text(0, "x")],
        ["none", ""]
    );
    assert!(table.text(0, "why").contains("forced"));
    for (words, message) in [
        (
            ["--at", "alfa=9"],
            "`alfa` is no parameter of the system; it has alpha, beta",
        ),
        (["--modes", "1..3"], "--modes is for waves of a tube"),
    ] {
        let arguments = [&["steady", "chua.ron"], &words[..]].concat();
        let outcome = bench.run(&arguments).expect(2);
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
}

/// Stick-slip without damping: 2π − 2 arctan(D/u) in slip, 2D/u in stick, with D = s − k = 0.5 and u = 1.
#[test]
fn a_motion_is_written_with_its_switches() {
    let bench = Bench::new();
    let text = changed(&system("belt"), "\"z\": 0.01", "\"z\": 0.0");
    let text = changed(&text, "toward: Both", "toward: Up");
    bench.put("belt.ron", text);
    let outcome = bench
        .run(&["simulate", "belt.ron", "--out", "out"])
        .expect(0);
    assert!(
        outcome.stdout.contains("switches by t = 30"),
        "{}",
        outcome.stdout
    );
    let switches = Table::read(&bench.path("out/switches.csv"));
    let times: Vec<f64> = (0..9).map(|row| switches.number(row, "time")).collect();
    for (row, pair) in times.windows(2).enumerate() {
        let expected = match switches.text(row, "to") {
            "stick" => 1.0,
            _ => TAU - 2.0 * 0.5_f64.atan(),
        };
        assert!(
            (pair[1] - pair[0] - expected).abs() < 1e-12,
            "{row}: {pair:?}"
        );
    }
    assert_eq!(switches.text(1, "from"), switches.text(0, "to"));
    assert_eq!(
        switches.number(0, "x_before"),
        switches.number(0, "x_after")
    );
    let series = Table::read(&bench.path("out/series.csv"));
    assert!((series.number(1000, "time") - 30.0).abs() < 1e-12);
    // in stick the mass has the speed of the belt
    for row in series.all("mode", "stick") {
        assert!((series.number(row, "v") - 1.0).abs() < 1e-13);
    }
    assert!(!bench.path("out/section.csv").exists());
    // the same bytes again, and no results lost
    let before = snapshot(&bench.path("out"));
    bench
        .run(&["simulate", "belt.ron", "--out", "out"])
        .expect(2);
    for option in ["--resume", "--force"] {
        bench
            .run(&["simulate", "belt.ron", "--out", "out", option, "--quiet"])
            .expect(0);
        assert_same(&snapshot(&bench.path("out")), &before, option);
    }
    bench.run(&["plot", "out"]).expect(0);
    assert_same(&snapshot(&bench.path("out")), &before, "plot");
    bench.run(&["report", "out"]).expect(0);
    // it says how each mode moves
    let says = |text: String, flows: &str| {
        bench.put("p.ron", text);
        let said = bench
            .run(&["simulate", "p.ron", "--force"])
            .expect(0)
            .stdout;
        assert!(said.contains(flows), "{said}");
    };
    says(system("belt"), "flows: `slip`, `stick` exact\n");
    let tolerance = "system: (\n        flow_tolerance: 1e-9,";
    says(
        changed(&system("pendulum_wall"), "system: (", tolerance),
        "flows: `free` integrated with the tolerance 1e-9\n",
    );
}

/// An impact takes the speed v to −ev at x = d, and the section repeats on a periodic orbit.
#[test]
fn a_forced_motion_has_a_section() {
    let bench = Bench::new();
    let text = changed(
        &system("impact_oscillator"),
        "duration: 100.0",
        "duration: 400.0, samples: 50",
    );
    bench.put("impact.ron", text);
    bench
        .run(&["simulate", "impact.ron", "--out", "out", "--quiet"])
        .expect(0);
    let switches = Table::read(&bench.path("out/switches.csv"));
    for row in switches.all("to", "free") {
        let [x, before, after] =
            ["x_before", "v_before", "v_after"].map(|name| switches.number(row, name));
        assert!((x - 1.0).abs() < 1e-14 && (after + 0.8 * before).abs() < 1e-15);
    }
    let section = Table::read(&bench.path("out/section.csv"));
    for row in 0..63 {
        assert!((section.number(row, "time") - TAU * row as f64).abs() < 1e-12);
    }
    // |μ| = 0.5843 a period: 20 periods take a difference below 1 to 1e-4 of it, 40 more to rounding
    let moved = ["x", "v"].map(|name| (section.number(62, name) - section.number(60, name)).abs());
    assert!(moved[0].max(moved[1]) < 1e-9, "{moved:?}");
    let phase = Table::read(&bench.path("out/series.csv"));
    assert!((phase.number(1, "phase") - 8.0 % TAU).abs() < 1e-13);
}

/// A ball on a table at rest comes to rest at 2v/(1 − e) after infinitely many bounces.
#[test]
fn a_motion_that_ends_says_why() {
    let bench = Bench::new();
    let text = changed(
        &system("bouncing_ball"),
        "\"G\": 1.0473022709517175",
        "\"G\": 0.0",
    );
    let text = changed(&text, "range: (1.0, 1.6)", "range: (0.0, 1.6)");
    let text = changed(&text, "toward: Both", "toward: Up");
    bench.put("ball.ron", &text);
    let outcome = bench
        .run(&["simulate", "ball.ron", "--out", "out"])
        .expect(3);
    assert!(
        outcome.stderr.contains("accumulate at t = 8.3775999"),
        "{}",
        outcome.stderr
    );
    let bounces = Table::read(&bench.path("out/switches.csv"));
    assert!((bounces.number(0, "time") - 2.0 * 2.0944).abs() < 1e-12);
    let text = changed(&text, "simulation: (duration: 100.0),", "");
    bench.put("none.ron", text);
    let outcome = bench.run(&["simulate", "none.ron"]).expect(2);
    assert!(
        outcome.stderr.contains("missing field `simulation`"),
        "{}",
        outcome.stderr
    );
    assert!(
        outcome.stderr.contains("simulation: (duration: 100.0"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn verbs_for_tubes_say_so() {
    let bench = Bench::new();
    bench.put("chua.ron", system("chua"));
    let said = bench.run(&["spectrum", "chua.ron"]).expect(2).stderr;
    let place = said.contains("chua.ron:7:5: this problem has a section `system`");
    assert!(place && said.contains("waves of a tube"), "{said}");
    let new = bench.run(&["new", "--for", "system"]).expect(0);
    bench.put("new.ron", &new.stdout);
    bench.run(&["simulate", "new.ron", "--quiet"]).expect(0);
    bench.put("new.ron", new.stdout.replace("A*cos(phase)", "A*cos(phas)"));
    let outcome = bench.run(&["steady", "new.ron"]).expect(2);
    let message = "`phas` is no state, parameter or abbreviation; did you mean `phase`?";
    assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
}

/// Impact oscillator with a stop at d = 1, k = 1, c = 0.1, ω = 1, e = 0.8: A²|G|² = (d − Vy)² + V²(e + W)²/ω² in the speed
/// V before the impact, so that the fold, the graze A = d/|G| = 0.1 and what lies beyond are known.
#[test]
fn a_branch_of_orbits_is_followed_through_its_graze() {
    let bench = Bench::new();
    bench.put("impact.ron", system("impact_oscillator"));
    let outcome = bench.run(&["run", "impact.ron", "--out", "out"]).expect(0);
    for said in ["fold in A", "flows: `free` exact\n"] {
        assert!(outcome.stdout.contains(said), "{}", outcome.stdout);
    }
    let events = Table::read(&bench.path("out/events.csv"));
    let fold = events.only("type", "LP");
    let known = 0.099_970_753_628_313_27;
    assert!((events.number(fold, "A") - known).abs() < 1e-13 * known);
    assert!((events.number(fold, "multiplier_re") - 1.0).abs() < 1e-10);
    let graze = events.only("type", "GR");
    assert!((events.number(graze, "A") - 0.1).abs() < 1e-14);
    let branch = Table::read(&bench.path("out/branch.csv"));
    let header = "point,label,type,regimes,c,A,w,d,e,period,switches,min_x,max_x,min_v,max_v,stable,unstable,\
                  multiplier_re,multiplier_im,newton,residual,leg";
    let text = std::fs::read_to_string(bench.path("out/branch.csv")).unwrap();
    assert_eq!(text.lines().next(), Some(header));
    for row in 0..branch.rows.len() {
        let period = branch.number(row, "period");
        assert!((period - TAU).abs() < 1e-12, "row {row}: {period}");
        let [amplitude, largest] = ["A", "max_x"].map(|name| branch.number(row, name));
        // 10 = |G|, and x ≤ d
        let expected = if branch.text(row, "switches").is_empty() {
            10.0 * amplitude
        } else {
            1.0
        };
        assert!((largest - expected).abs() < 1e-12, "row {row}: {largest}");
        assert_eq!(branch.text(row, "regimes"), "free");
    }
    // det of the linear flow: |μ|² = e^(−2πc) without an impact, e² times that with one
    let last = branch.rows.len() - 1;
    let size = branch
        .number(last, "multiplier_re")
        .hypot(branch.number(last, "multiplier_im"));
    assert!((size * size - (-0.1 * TAU).exp()).abs() < 1e-12);
    let multipliers = Table::read(&bench.path("out/multipliers.csv"));
    let of_first = multipliers.all("label", "1").into_iter();
    let product: f64 = of_first
        .map(|row| multipliers.number(row, "modulus"))
        .product();
    assert!((product - 0.64 * (-0.1 * TAU).exp()).abs() < 1e-12);
    for name in [
        "diagram.svg",
        "phase_x_v.svg",
        "time_x.svg",
        "multipliers.svg",
        "profiles/1.csv",
    ] {
        assert!(bench.path("out").join(name).exists(), "{name}");
    }
    // the mass is held at the stop: its greatest x says nothing
    let diagram = std::fs::read_to_string(bench.path("out/diagram.svg")).unwrap();
    assert!(diagram.contains("min x") && !diagram.contains("max x"));
    // the orbit beyond the graze has the same mode all the time and never switches; the unstable piece between fold and graze is hidden
    // by their marks
    assert!(diagram.contains("free, no switch"));
    assert!(!diagram.contains("unstable"));
    let drawn = std::fs::read_to_string(bench.path("out/multipliers.svg")).unwrap();
    assert!(drawn.contains("along the branch, the leading one") && drawn.contains("|μ|"));
}

/// Pictures of orbits show the labels that are asked for.
#[test]
fn pictures_show_the_orbits_of_labels() {
    let bench = Bench::new();
    let text = changed(
        &system("impact_oscillator"),
        "profiles: 9",
        "profiles: 9, labels: [5, 2]",
    );
    bench.put("impact.ron", text);
    bench
        .run(&["run", "impact.ron", "--out", "out", "-q"])
        .expect(0);
    let drawn = std::fs::read_to_string(bench.path("out/phase_x_v.svg")).unwrap();
    let told = |label: usize| drawn.contains(&format!("\n{label} (A = "));
    let told: Vec<usize> = (1..=12).filter(|label| told(*label)).collect();
    assert_eq!(told, [2, 5]);
}

/// Another run, a resumed run, and one on from a label: the same orbits.
#[test]
fn branches_of_orbits_are_resumed_and_restarted() {
    let bench = Bench::new();
    bench.put("impact.ron", system("impact_oscillator"));
    bench
        .run(&["run", "impact.ron", "--out", "one", "--quiet"])
        .expect(0);
    bench
        .run(&["run", "impact.ron", "--out", "two", "--quiet"])
        .expect(0);
    assert_same(
        &snapshot(&bench.path("one")),
        &snapshot(&bench.path("two")),
        "the same run",
    );
    bench
        .run(&["run", "impact.ron", "--out", "two", "--quiet"])
        .expect(2);
    bench
        .run(&["run", "impact.ron", "--out", "two", "--quiet", "--resume"])
        .expect(0);
    assert_same(
        &snapshot(&bench.path("one")),
        &snapshot(&bench.path("two")),
        "the same run",
    );
    bench.run(&["plot", "two"]).expect(0);
    assert_same(
        &snapshot(&bench.path("one")),
        &snapshot(&bench.path("two")),
        "the same run",
    );
    bench.run(&["plot", "two", "--y", "max_v"]).expect(0);
    assert!(bench.path("two/view.svg").exists());
    bench.run(&["report", "one"]).expect(0);
    let text = system("impact_oscillator");
    let from = text.find("start: Simulate").unwrap();
    let end = from + text[from..].find("settle:").unwrap();
    let end = end + text[end..].find(')').unwrap() + 1;
    let restart = format!(
        "{}start: Restart(dir: \"one\", label: 5){}",
        &text[..from],
        &text[end..]
    );
    bench.put("again.ron", restart);
    bench
        .run(&["run", "again.ron", "--out", "again", "--quiet"])
        .expect(0);
    let [one, again] =
        ["one", "again"].map(|name| Table::read(&bench.path(name).join("events.csv")));
    for kind in ["LP", "GR"] {
        let [first, second] =
            [&one, &again].map(|table| table.number(table.only("type", kind), "A"));
        assert!((first - second).abs() < 1e-13, "{kind}: {first} {second}");
    }
}

const BALL_START: &str =
    "start: Given(mode: \"flight\", state: {\"y\": 0.0, \"v\": 2.0944}, phase: 0.01414)";

/// The other branch at a doubling: resumed and restarted as any run, and refused in words.
#[test]
fn the_other_branch_at_a_doubling() {
    let bench = Bench::new();
    let text = changed(
        &system("bouncing_ball"),
        "range: (1.0, 1.6), toward: Both",
        "range: (1.0, 1.6), toward: Up",
    );
    bench.put("ball.ron", &text);
    bench
        .run(&["run", "ball.ron", "--out", "one", "--quiet"])
        .expect(0);
    let events = Table::read(&bench.path("one/events.csv"));
    let doubling = events.only("type", "PD");
    let label = events.text(doubling, "label").to_owned();
    let start = |text: &str, start: &str| changed(text, BALL_START, start);
    let switch = |dir: &str, label: &str| format!("start: Switch(dir: \"{dir}\", label: {label})");
    bench.put("two.ron", start(&text, &switch("one", &label)));
    for (out, option) in [
        ("two", "--quiet"),
        ("three", "--quiet"),
        ("two", "--resume"),
    ] {
        bench
            .run(&["run", "two.ron", "--out", out, option])
            .expect(0);
    }
    let same = [snapshot(&bench.path("two")), snapshot(&bench.path("three"))];
    assert_same(&same[0], &same[1], "the same run");
    let branch = Table::read(&bench.path("two/branch.csv"));
    let first = events.number(doubling, "G");
    for row in 0..branch.rows.len() {
        assert_eq!(branch.text(row, "regimes"), "flight-flight");
        assert!((branch.number(row, "period") - 2.0 * TAU).abs() < 1e-12);
        assert!(branch.number(row, "G") > first);
    }
    let restart = "start: Restart(dir: \"two\", label: 2)";
    let down = changed(&start(&text, restart), "toward: Up", "toward: Down");
    bench.put("back.ron", down);
    bench
        .run(&["run", "back.ron", "--out", "back", "--quiet"])
        .expect(0);
    // back at the doubling
    let back = Table::read(&bench.path("back/events.csv"));
    let end = back.number(back.only("type", "PD"), "G");
    assert!((end - first).abs() < 1e-6, "{end} {first}");
    let other = changed(&text, "-e*v", "-0.9*e*v");
    bench.put("tube.ron", problem("mode4_friction.ron"));
    bench
        .run(&["run", "tube.ron", "--out", "tube", "--quiet"])
        .expect(0);
    for (text, dir, label, message) in [
        (&text, "one", "99", "no label 99; labels run from 1 to"),
        (
            &text,
            "one",
            "1",
            "label 1 is of type EP: another branch begins at PD and BP only",
        ),
        (&other, "one", &*label, "one holds orbits of another system"),
        (
            &text,
            "tube",
            "1",
            "tube holds waves of a tube, not orbits of a system",
        ),
        (&text, "none", "1", "none/branch.ron: cannot read it"),
    ] {
        bench.put("wrong.ron", start(text, &switch(dir, label)));
        let outcome = bench.run(&["run", "wrong.ron", "--out", "wrong"]);
        assert_ne!(outcome.code, Some(0), "{message}");
        let is_of_the_file = message.starts_with("label");
        assert!(!is_of_the_file || outcome.code == Some(2), "{message}");
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
}

/// A curve of doublings by the command line: its table, its picture, the same bytes again, one from a label.
#[test]
fn a_curve_of_an_event_of_a_system() {
    let bench = Bench::new();
    let text = changed(
        &system("ball_curve"),
        "range: ((0.5, 2.5), (0.2, 0.9))",
        "range: ((1.3, 1.7), (0.4, 0.6))",
    );
    bench.put("ball.ron", &text);
    let outcome = bench.run(&["curve", "ball.ron", "--out", "one"]).expect(0);
    assert!(
        outcome.stdout.contains("event, G, e, period"),
        "{}",
        outcome.stdout
    );
    let header = "point,type,G,e,period,regimes_before,regimes_after,angle,newton,residual,what";
    let table = std::fs::read_to_string(bench.path("one/curve.csv")).unwrap();
    assert_eq!(table.lines().next(), Some(header));
    let curve = Table::read(&bench.path("one/curve.csv"));
    for row in 0..curve.rows.len() {
        let [g, e] = ["G", "e"].map(|name| curve.number(row, name));
        let fold = 0.5 * TAU * (1.0 - e) / (1.0 + e);
        let expected = fold.hypot(2.0 * (1.0 + e * e) / (1.0 + e).powi(2));
        assert!((g / expected - 1.0).abs() < 1e-10, "{g} {expected}");
    }
    for (out, option) in [("two", "--quiet"), ("one", "--resume")] {
        bench
            .run(&["curve", "ball.ron", "--out", out, option])
            .expect(0);
    }
    bench.run(&["plot", "two"]).expect(0);
    let [one, two] = ["one", "two"].map(|name| snapshot(&bench.path(name)));
    assert_same(&one, &two, "the same curve");
    assert!(bench.path("one/curve.svg").exists());
    bench.run(&["report", "one"]).expect(0);
    // from a label, in the other order of the parameters
    bench
        .run(&["run", "ball.ron", "--out", "run", "--quiet"])
        .expect(0);
    let events = Table::read(&bench.path("run/events.csv"));
    let label = events.text(events.only("type", "PD"), "label").to_owned();
    let named = format!("event: Label(dir: \"run\", label: {label}), parameters: (\"e\", \"G\")");
    let labelled = changed(&text, "event: PD, parameters: (\"G\", \"e\")", &named);
    let labelled = changed(
        &labelled,
        "((1.3, 1.7), (0.4, 0.6))",
        "((0.4, 0.6), (1.3, 1.7))",
    );
    bench.put("labelled.ron", &labelled);
    bench
        .run(&["curve", "labelled.ron", "--out", "labelled", "--quiet"])
        .expect(0);
    let other = Table::read(&bench.path("labelled/curve.csv"));
    let ends = |table: &Table, name: &str| {
        let last = table.rows.len() - 1;
        let [one, other] = [0, last].map(|row| table.number(row, name));
        (one.min(other), one.max(other))
    };
    let [first, second] = [&curve, &other].map(|table| ends(table, "e"));
    assert!((first.0 - second.0).abs() < 1e-10 && (first.1 - second.1).abs() < 1e-10);
    for (from, to, message) in [
        (
            "curve: (event: PD",
            "curve: (event: NS",
            "0 events of the kind asked for, NS",
        ),
        (
            "(1.3, 1.7)",
            "(1.3, 1.4)",
            "outside the range from 1.3 to 1.4",
        ),
        ("(\"G\", \"e\")", "(\"G\", \"G\")", "must be different"),
        ("(\"G\", \"e\")", "(\"G\", \"f\")", "`f` is no parameter"),
    ] {
        bench.put("wrong.ron", changed(&text, from, to));
        let outcome = bench.run(&["curve", "wrong.ron", "--out", "wrong"]);
        assert_ne!(outcome.code, Some(0), "{message}");
        let is_of_the_file = message.starts_with("label");
        assert!(!is_of_the_file || outcome.code == Some(2), "{message}");
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
}

/// A mass that falls on a damped spring leaves it before the spring is as long as before: `open` until it falls again, which is no
/// switch.
#[test]
fn a_damped_spring_that_parts_is_open() {
    let bench = Bench::new();
    let text = r#"(
        system: (
            states: ["y", "u"], parameters: {"k": 40.0, "c": 2.0},
            contacts: {"p": Spring(gap: "y", stiffness: "k", damping: "c")},
            rates: {"y": "u", "u": "-1 + p"},
        ),
        orbit: (start: Simulate(mode: "open", state: {"y": 0.5, "u": 0.0}, settle: 1)),
        simulation: (duration: 4.0, samples: 4),
    )"#;
    bench.put("fall.ron", text);
    let outcome = bench
        .run(&["simulate", "fall.ron", "--out", "out"])
        .expect(0);
    let switches = Table::read(&bench.path("out/switches.csv"));
    let rows = std::fs::read_to_string(bench.path("out/switches.csv")).unwrap();
    let count = rows.lines().count() - 1;
    assert!(count > 2);
    let told = format!("{count} switches by t = 4");
    assert!(outcome.stdout.contains(&told), "{}", outcome.stdout);
    for row in 0..count {
        let expected = [["open", "closed"], ["closed", "open"]][row % 2];
        assert_eq!(
            ["from", "to"].map(|name| switches.text(row, name)),
            expected
        );
    }
}
