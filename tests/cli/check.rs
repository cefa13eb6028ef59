//! `check` passes what is right, fails what is wrong in a single figure, and tells a machine.

use std::fs;

use crate::harness::{Bench, PROBLEMS, SMALL, changed, problem};

/// Number of times a word occurs.
fn count(text: &str, word: &str) -> usize {
    text.matches(word).count()
}

#[test]
fn every_problem_of_the_repository_is_as_expected() {
    let bench = Bench::new();
    let mut files = Vec::new();
    let mut expectations = 0;
    for entry in fs::read_dir(PROBLEMS).expect("the problems") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "ron") {
            let text = fs::read_to_string(&path).expect("a problem");
            if let Some((_, expect)) = text.split_once("expect:") {
                expectations += count(expect, "(event:");
            }
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
    let total = format!("{0} of {0} problem files as expected\n", files.len());
    assert!(outcome.stdout.ends_with(&total), "{}", outcome.stdout);
    let xml = fs::read_to_string(bench.path("report.xml")).expect("a report");
    assert!(xml.starts_with("<?xml"));
    assert_eq!(count(&xml, "<testsuite "), files.len());
    assert_eq!(count(&xml, "<testcase "), expectations);
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
    let text = problem("mode4_mismatch.ron");
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
    let text = problem("mode4_mismatch.ron");
    for (more, said) in [
        ("(event: LP, mismatch: 0.1, tolerance: 1e-3)", "no LP"),
        (
            "(event: HB, sector: 1, mismatch: 0.1, tolerance: 1e-3)",
            "no HB sector 1",
        ),
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
        assert!(
            outcome.stdout.contains(said) || said == "no GR",
            "{}",
            outcome.stdout
        );
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
    assert_eq!(count(stdout, "ok  "), 1, "{stdout}");
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
        .expect(2);
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
