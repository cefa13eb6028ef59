//! `check` passes what is right, fails what is wrong in a single figure, and tells a machine.

use std::fs;

use crate::cli::harness::{Bench, PROBLEMS, SMALL, changed, problem};

/// Number of times a word occurs.
fn count(text: &str, word: &str) -> usize {
    text.matches(word).count()
}

#[test]
fn every_problem_of_the_repository_is_as_expected() {
    let bench = Bench::new();
    let mut files = Vec::new();
    let (mut expectations, mut with) = (0, 0);
    for entry in fs::read_dir(PROBLEMS).expect("the problems") {
        let path = entry.expect("an entry").path();
        // a wave that takes as long as ten others; `.ci/run` checks it
        let is_long = path.ends_with("ring_separation_circle.ron");
        if path.extension().is_some_and(|extension| extension == "ron") && !is_long {
            let text = fs::read_to_string(&path).expect("a problem");
            let expect = text.split_once("expect:").map(|(_, expect)| expect);
            expectations += expect.map_or(0, |expect| count(expect, "(event:"));
            // points to be proven are expected, too
            with += usize::from(expect.is_some() || text.contains("certify: true"));
            files.push(path.to_str().expect("UTF-8").to_owned());
        }
    }
    files.sort();
    assert!(files.len() >= 6 && expectations >= 25);
    let mut arguments = vec!["check"];
    arguments.extend(files.iter().map(String::as_str));
    arguments.extend(["--junit", "report.xml"]);
    let outcome = bench.run(&arguments).expect(0);
    assert!(!outcome.stdout.contains("FAIL"), "{}", outcome.stdout);
    // what expects nothing is no success
    let skipped = files.len() - with;
    let total = format!("{with} of {with} problem files as expected\n");
    assert!(outcome.stdout.ends_with(&total), "{}", outcome.stdout);
    let xml = fs::read_to_string(bench.path("report.xml")).expect("a report");
    assert!(xml.starts_with("<?xml"));
    assert_eq!(count(&xml, "<testsuite "), files.len());
    let proven = count(&outcome.stdout, ": proven;");
    assert!(proven >= 100, "{}", outcome.stdout);
    assert_eq!(count(&xml, "<testcase "), expectations + proven + skipped);
    assert_eq!(count(&xml, "<skipped"), skipped);
    assert_eq!(count(&xml, "<failure") + count(&xml, "<error"), 0);
    // a check leaves no results
    assert_eq!(bench.names(), ["report.xml"]);
}

/// The numbers of the `expect` list: each with its byte range, in order.
fn figures(text: &str) -> Vec<std::ops::Range<usize>> {
    let from = text.find("expect:").expect("a list of expectations");
    let mut found = Vec::new();
    for name in ["mismatch: ", "speed: "] {
        for (at, _) in text[from..].match_indices(name) {
            let start = from + at + name.len();
            let length = text[start..].find([',', ')']).expect("an end");
            found.push(start..start + length);
        }
    }
    found
}

#[test]
fn a_single_false_figure_is_noticed() {
    let bench = Bench::new();
    // its expectations alone
    let text = changed(&problem("mode4_mismatch.ron"), "    certify: true,\n", "");
    let figures = figures(&text);
    assert_eq!(figures.len(), 20);
    for place in figures {
        let figure: f64 = text[place.clone()].parse().expect("a number");
        let mut copy = text.clone();
        copy.replace_range(place.clone(), &format!("{:e}", figure * (1.0 + 1e-9)));
        bench.put("copy.ron", &copy);
        let outcome = bench
            .run(&["check", "copy.ron", "--junit", "report.xml"])
            .expect(1);
        // that one and no other
        assert_eq!(count(&outcome.stdout, "FAIL"), 1, "{}", outcome.stdout);
        assert_eq!(count(&outcome.stdout, "ok  "), 19, "{}", outcome.stdout);
        assert!(
            outcome.stdout.contains("difference 1.0e-9"),
            "{}",
            outcome.stdout
        );
        let xml = fs::read_to_string(bench.path("report.xml")).expect("a report");
        assert_eq!(
            (count(&xml, "<testcase "), count(&xml, "<failure")),
            (10, 1)
        );
        assert!(xml.contains("failures=\"1\""));
    }
}

#[test]
fn a_false_word_is_noticed() {
    let bench = Bench::new();
    let text = problem("mode4_mismatch.ron");
    for (from, to) in [
        ("regimes_before: \"slip-stick\"", "regimes_before: \"slip\""),
        (
            "regimes_after: \"slip-separation\"",
            "regimes_after: \"slip-stick\"",
        ),
        ("(event: ST", "(event: ST, label: 2"),
    ] {
        bench.put("copy.ron", changed(&text, from, to));
        let outcome = bench.run(&["check", "copy.ron"]).expect(1);
        assert!(outcome.stdout.contains("FAIL"), "{to}: {}", outcome.stdout);
    }
}

#[test]
fn events_that_are_not_there_are_reported() {
    let bench = Bench::new();
    // its expectations alone
    let text = changed(&problem("mode4_mismatch.ron"), "    certify: true,\n", "");
    for (more, said) in [
        ("(event: LP, mismatch: 0.1, tolerance: 1e-3)", "no LP"),
        ("(event: RV, mismatch: 0.05, tolerance: 1e-3)", "no RV"),
        // there is one, but it is somewhere else
        ("(event: GR, mismatch: 0.06, tolerance: 1e-3)", "no GR"),
        // no event serves two expectations
        (
            "(event: ST, mismatch: 0.0005044760768328024, tolerance: 1e-3)",
            "no ST",
        ),
    ] {
        bench.put(
            "copy.ron",
            changed(&text, "expect: [", &format!("expect: [{more}, ")),
        );
        let outcome = bench
            .run(&["check", "copy.ron", "--junit", "report.xml"])
            .expect(1);
        assert!(outcome.stdout.contains("FAIL"), "{}", outcome.stdout);
        assert!(outcome.stdout.contains(said), "{}", outcome.stdout);
        let xml = fs::read_to_string(bench.path("report.xml")).expect("a report");
        assert_eq!(count(&xml, "<testcase "), 11);
        assert!(count(&xml, "<failure") >= 1);
    }
}

#[test]
fn bad_input_outranks_all_but_spoils_nothing() {
    let bench = Bench::new();
    bench.put("good.ron", SMALL);
    bench.put(
        "false.ron",
        changed(SMALL, "UZ, mismatch: 0.195", "UZ, mismatch: 0.1951"),
    );
    bench.put("bad.ron", changed(SMALL, "mode: 4", "mode: 0"));
    bench.put("none.ron", changed(SMALL, "friction: 0.5", "friction: 1.2"));
    let files = [
        "check",
        "false.ron",
        "bad.ron",
        "none.ron",
        "good.ron",
        "missing.ron",
    ];
    let outcome = bench
        .run(&[&files[..], &["--junit", "report.xml"]].concat())
        .expect(2);
    let stdout = &outcome.stdout;
    assert!(
        stdout.contains("bad.ron:7:18: `wave.mode` is 0"),
        "{stdout}"
    );
    assert!(stdout.contains("missing.ron: cannot read"), "{stdout}");
    assert!(
        stdout.ends_with("1 of 5 problem files as expected\n"),
        "{stdout}"
    );
    assert_eq!(count(stdout, "ok  "), 3, "{stdout}");
    let xml = fs::read_to_string(bench.path("report.xml")).expect("a report");
    assert_eq!(count(&xml, "<testsuite "), 5);
    assert_eq!((count(&xml, "<failure"), count(&xml, "<error")), (1, 3));
    // without the bad ones, the wave that does not exist decides
    bench
        .run(&["check", "false.ron", "none.ron", "good.ron"])
        .expect(3);
    bench.run(&["check", "false.ron", "good.ron"]).expect(1);
    bench.run(&["check", "good.ron"]).expect(0);
    // a report that cannot be written is not passed over
    bench
        .run(&["check", "good.ron", "--junit", "good.ron/x"])
        .expect(4);
}

/// [`SMALL`] with these expectations.
fn expecting(list: &str) -> String {
    let known = "(event: UZ, mismatch: 0.195, speed: -1.242700800630082, tolerance: 1e-9),";
    changed(SMALL, known, list)
}

#[test]
fn nothing_expected_is_no_success() {
    let bench = Bench::new();
    bench.put("good.ron", SMALL);
    bench.put("none.ron", expecting(""));
    let simulated = "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
                     mismatch: 0.2), wave: (mode: 4, start: Fast), simulation: (body: Ring(points: \
                     32), start: SteadySliding, duration: 1.0))";
    bench.put("ring.ron", simulated);
    let files = ["check", "none.ron", "good.ron", "ring.ron"];
    let outcome = bench
        .run(&[&files[..], &["--junit", "report.xml"]].concat())
        .expect(0);
    let stdout = &outcome.stdout;
    assert!(
        stdout.ends_with("1 of 1 problem files as expected\n"),
        "{stdout}"
    );
    assert_eq!(count(stdout, "nothing expected"), 2, "{stdout}");
    assert!(
        outcome
            .stderr
            .contains("2 of 3 problem files expect nothing")
    );
    let xml = fs::read_to_string(bench.path("report.xml")).expect("a report");
    assert!(xml.contains("tests=\"3\""), "{xml}");
    assert_eq!(count(&xml, "<testcase "), 3, "{xml}");
    assert_eq!(count(&xml, "<skipped"), 2, "{xml}");
}

#[test]
fn expectations_that_cannot_fail_are_refused() {
    let bench = Bench::new();
    for (list, column, words) in [
        // +7 would pass for the speed −1.2427
        (
            "(event: UZ, speed: 7.0, tolerance: 2.0)",
            "tolerance",
            "at most 0.1",
        ),
        (
            "(event: UZ, speed: -1.24, tolerance: 1e300)",
            "tolerance",
            "at most 0.1",
        ),
        (
            "(event: UZ, speed: 0.0, tolerance: 0.5)",
            "tolerance",
            "at most 0.1",
        ),
        // all the range from 0.19 to 0.2
        (
            "(event: UZ, mismatch: 0.195, tolerance: 0.05)",
            "tolerance",
            "the whole range",
        ),
        // a branch in the mismatch keeps the friction
        (
            "(event: UZ, friction: 0.5, tolerance: 1e-9)",
            "expect",
            "keeps them",
        ),
        (
            "(event: GR, sector: 0, mismatch: 0.195, tolerance: 1e-9)",
            "sector",
            "has none",
        ),
        (
            "(event: LP, omega: 2.0, tolerance: 1e-9)",
            "omega",
            "has none",
        ),
        // nothing looks for it
        (
            "(event: HB, mismatch: 0.195, tolerance: 1e-9)",
            "event",
            "`stability`",
        ),
    ] {
        bench.put("p.ron", expecting(list));
        let stdout = bench.run(&["check", "p.ron"]).expect(2).stdout;
        assert!(stdout.contains("p.ron:18:"), "{list}: {stdout}");
        assert!(
            stdout.contains(column) && stdout.contains(words),
            "{list}: {stdout}"
        );
        assert!(stdout.contains("help: "), "{list}: {stdout}");
    }
    // identity may stand beside what can fail, and a coarse tolerance is one's own choice
    bench.put(
        "p.ron",
        expecting("(event: UZ, mismatch: 0.195, friction: 0.5, tolerance: 1e-2)"),
    );
    bench.run(&["check", "p.ron"]).expect(0);
    bench.put(
        "p.ron",
        expecting("(event: UZ, mismatch: 0.195, friction: 0.6, tolerance: 1e-2)"),
    );
    bench.run(&["check", "p.ron"]).expect(1);
}

/// Two user points of one speed: the first expectation fits both, the nearer one is the only one of
/// the second.
#[test]
fn expectations_and_events_are_paired_one_to_one() {
    let bench = Bench::new();
    let put = |list: &str| {
        let text = changed(&expecting(list), "[0.195]", "[0.192, 0.195]");
        bench.put("p.ron", text);
    };
    let either = "(event: UZ, mismatch: 0.1945, tolerance: 0.02)";
    let second = "(event: UZ, mismatch: 0.195, tolerance: 1e-9)";
    let first = "(event: UZ, mismatch: 0.192, tolerance: 1e-9)";
    for list in [
        [either, second].join(", "),
        [second, either].join(", "),
        [either, first].join(", "),
        [first, second].join(", "),
        [either, either].join(", "),
    ] {
        put(&list);
        let outcome = bench.run(&["check", "p.ron"]).expect(0);
        assert_eq!(count(&outcome.stdout, "ok  "), 2, "{list}");
    }
    // two events do not serve three expectations
    put(&[either, first, second].join(", "));
    let outcome = bench.run(&["check", "p.ron"]).expect(1);
    assert_eq!(
        count(&outcome.stdout, "no UZ was found"),
        1,
        "{}",
        outcome.stdout
    );
    // nor one event two equal ones
    put(&[second, second].join(", "));
    let outcome = bench.run(&["check", "p.ron"]).expect(1);
    assert_eq!(count(&outcome.stdout, "ok  "), 1, "{}", outcome.stdout);
}

#[test]
fn the_printed_template_is_a_problem_and_as_expected() {
    let bench = Bench::new();
    let outcome = bench.run(&["new"]).expect(0);
    assert_eq!(outcome.stderr, "");
    bench.put("new.ron", &outcome.stdout);
    let checked = bench.run(&["check", "new.ron"]).expect(0);
    assert!(checked.stdout.contains("ok  "), "{}", checked.stdout);
    bench.run(&["run", "new.ron"]).expect(0);
    assert!(bench.path("results/new/diagram.svg").exists());
}

/// The period of a forced orbit is that of the forcing: expected alone it could not fail, but where the frequency changes with the branch.
#[test]
fn a_period_that_stays_is_nothing_to_expect() {
    let bench = Bench::new();
    for (parameter, period, code) in [("A", 5.0, 2), ("w", 5.0, 0), ("w", 5.1, 1)] {
        let text = format!(
            r#"(
    system: (states: ["x", "v"], parameters: {{"A": 1.0, "w": 1.25}}, forcing: "w",
        modes: {{"free": (rates: {{"x": "v", "v": "A*cos(phase) - 0.1*v - x"}}, until: [])}}),
    orbit: (start: Simulate(mode: "free", state: {{"x": 0.0, "v": 0.0}}, settle: 200)),
    continuation: (parameter: "{parameter}", range: (1.0, {:?}), toward: Up),
    expect: [(event: EP, period: {period:?}, tolerance: 1e-12)],
)"#,
            std::f64::consts::TAU / 5.0 + f64::from(u8::from(parameter == "A"))
        );
        bench.put("p.ron", text);
        let stdout = bench.run(&["check", "p.ron"]).expect(code).stdout;
        assert_eq!(stdout.contains("keeps them"), code == 2, "{stdout}");
    }
}
