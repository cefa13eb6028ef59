//! Bad input is refused with exit code 2, told where and why, and leaves nothing behind.

use std::fs;
use std::time::{Duration, Instant};

use crate::cli::harness::{Bench, Outcome, SMALL, changed};

/// Runs a bad problem text by `run` and by `check`; nothing may be left in the folder.
#[track_caller]
fn refused(text: &str) -> Outcome {
    let bench = Bench::new();
    bench.put("problem.ron", text);
    let outcome = bench.run(&["run", "problem.ron"]).expect(2);
    assert_eq!(outcome.stdout, "");
    // neither `results` nor anything else
    assert_eq!(bench.names(), ["problem.ron"]);
    let checked = bench.run(&["check", "problem.ron"]).expect(2);
    let message = outcome.stderr.strip_prefix("error: ").expect("an error");
    assert!(checked.stdout.contains(message.trim_end()), "same message");
    assert_eq!(bench.names(), ["problem.ron"]);
    outcome
}

/// Refuses [`SMALL`] with `from` replaced, points to `marked` and says all of `words`.
#[track_caller]
fn case(from: &str, to: &str, marked: &str, words: &[&str]) {
    let text = changed(SMALL, from, to);
    let at = text.find(to).expect("the change") + to.find(marked).expect("marked text");
    let line = 1 + text[..at].matches('\n').count();
    let start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let column = 1 + text[start..at].chars().count();
    let stderr = refused(&text).stderr;
    let place = format!("error: problem.ron:{line}:{column}: ");
    assert!(stderr.starts_with(&place), "not at {place}\n{stderr}");
    let source = text.lines().nth(line - 1).expect("the line");
    assert!(stderr.contains(&format!("{line} | {source}\n")), "{stderr}");
    // carets stand under the offending text, and all of it
    let carets = stderr.lines().nth(2).expect("a line of carets");
    let under = format!("{}{}", " ".repeat(column - 1), "^".repeat(marked.len()));
    assert!(carets.ends_with(&format!("| {under}")), "{stderr}");
    assert!(stderr.contains("\nhelp: "), "{stderr}");
    for word in words {
        assert!(stderr.contains(word), "no `{word}` in\n{stderr}");
    }
}

#[test]
fn unknown_names_are_shown_with_the_nearest_known_one() {
    for (from, to, marked, known) in [
        ("friction: 0.5", "frictoin: 0.5", "frictoin", "`friction`"),
        (
            "continuation:",
            "continutaion:",
            "continutaion",
            "`continuation`",
        ),
        ("stop_at", "stop_ta", "stop_ta", "`stop_at`"),
        (
            "parameter: Mismatch",
            "parameter: Mismach",
            "Mismach",
            "`Mismatch`",
        ),
        ("event: UZ", "event: UZZ", "UZZ", "`UZ`"),
        ("start: Fast", "start: Fats", "Fats", "`Fast`"),
    ] {
        case(from, to, marked, &[&format!("did you mean {known}")]);
    }
}

#[test]
fn a_missing_range_is_named() {
    let stderr = refused(&changed(SMALL, "        range: (0.19, 0.2),\n", "")).stderr;
    assert!(stderr.starts_with("error: problem.ron:"), "{stderr}");
    assert!(
        stderr.contains("missing field `range` in `continuation`"),
        "{stderr}"
    );
    assert!(
        stderr.contains("\nhelp: add for example `range: ("),
        "{stderr}"
    );
}

#[test]
fn values_without_sense_are_pointed_to() {
    let range = "range: (0.19, 0.2)";
    for (from, to, marked, words) in [
        (
            range,
            "range: (0.1, 0.199)",
            "(0.1, 0.199)",
            "outside the range",
        ),
        (
            range,
            "range: (0.2, 0.19)",
            "(0.2, 0.19)",
            "lower end first",
        ),
        (range, "range: (0.0, 0.2)", "0.0", "greater than 0"),
        ("nu: 0.3", "nu: 0.5", "0.5", "between -1 and 0.5"),
        ("nu: 0.3", "nu: -1.0", "-1.0", "between -1 and 0.5"),
        ("nu: 0.3", "nu: 7.0", "7.0", "between -1 and 0.5"),
        ("xi: 1.5", "xi: 1.0", "1.0", "greater than 1"),
        ("xi: 1.5", "xi: 0.5", "0.5", "greater than 1"),
        (
            "gamma: 1.0",
            "gamma: 0.0",
            "0.0",
            "gamma must be greater than 0",
        ),
        (
            "gamma: 1.0",
            "gamma: -1.0",
            "-1.0",
            "gamma must be greater than 0",
        ),
        (
            "friction: 0.5",
            "friction: -0.5",
            "-0.5",
            "friction coefficient must be at least 0",
        ),
        ("mode: 4", "mode: 0", "0", "waves around the circumference"),
        (
            "ds_min: 1e-9",
            "ds_min: 0.05",
            "0.05",
            "ds_min <= ds <= ds_max",
        ),
        ("ds_max: 0.02", "max_points: 0", "0", "at least 1 point"),
        ("[0.195]", "[0.25]", "0.25", "within the range"),
        (
            "toward: Down",
            "toward: Up",
            "Up",
            "nothing in this direction",
        ),
        ("tolerance: 1e-9", "tolerance: 0.0", "0.0", "greater than 0"),
        (
            "[Diagram]",
            r#"[Column("ampltude")]"#,
            r#"Column("ampltude")"#,
            "amplitude",
        ),
        (
            "[Diagram]",
            r#"[Column("regimes")]"#,
            r#"Column("regimes")"#,
            "min_pressure",
        ),
    ] {
        case(from, to, marked, &[words]);
    }
}

#[test]
fn numbers_that_are_none_are_refused_wherever_they_stand() {
    for (field, value) in [
        ("nu: ", "0.3"),
        ("xi: ", "1.5"),
        ("gamma: ", "1.0"),
        ("friction: ", "0.5"),
        ("mismatch: ", "0.2,"),
        ("range: (", "0.19"),
        ("range: (0.19, ", "0.2"),
        ("ds_min: ", "1e-9"),
        ("ds_max: ", "0.02"),
        ("stop_at: [", "0.195"),
        ("UZ, mismatch: ", "0.195"),
        ("tolerance: ", "1e-9"),
    ] {
        for number in ["NaN", "inf", "-inf"] {
            let from = format!("{field}{value}");
            let comma = if value.ends_with(',') { "," } else { "" };
            case(
                &from,
                &format!("{field}{number}{comma}"),
                number,
                &["is not admitted"],
            );
        }
    }
}

#[test]
fn files_that_are_no_problems_are_refused_at_once() {
    // all take less than a second: the limit is there for a quadratic or endless parser
    let patience = Duration::from_secs(10);
    for (name, text) in [
        ("empty", Vec::new()),
        ("blank", b" \n\n// nothing\n".to_vec()),
        ("ten megabytes of brackets", vec![b'['; 10 << 20]),
        ("ten megabytes of parentheses", vec![b'('; 10 << 20]),
        // just below the limit of size: these are parsed
        ("brackets", vec![b'['; (4 << 20) - 1]),
        ("parentheses", vec![b'('; (4 << 20) - 1]),
        ("closing", vec![b')'; (4 << 20) - 1]),
        ("nested", [&b"(title: "[..], &[b'('; 1 << 20]].concat()),
        ("not text", vec![0xff, 0xfe, 0x00, 0x80]),
        ("zeros", vec![0; 1 << 16]),
    ] {
        let bench = Bench::new();
        bench.put("problem.ron", text);
        let began = Instant::now();
        let outcome = bench.run(&["run", "problem.ron"]).expect(2);
        assert!(began.elapsed() < patience, "{name}: {:?}", began.elapsed());
        assert!(outcome.stderr.starts_with("error: problem.ron:"), "{name}");
        assert!(outcome.stderr.contains("\nhelp: "), "{name}");
        assert!(outcome.stderr.len() < 2000, "{name}: a message, not a copy");
        assert_eq!(bench.names(), ["problem.ron"], "{name}");
    }
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let bench = Bench::new();
    fs::create_dir(bench.path("folder.ron")).expect("a folder");
    for name in ["folder.ron", "missing.ron", "missing/problem.ron"] {
        for verb in ["run", "check"] {
            let outcome = bench.run(&[verb, name]).expect(2);
            let said = outcome.stdout + &outcome.stderr;
            let message = format!("{name}: cannot read the problem file: ");
            assert!(said.contains(&message), "{said}");
            assert!(said.contains("help: "), "{said}");
        }
    }
    assert_eq!(bench.names(), ["folder.ron"]);
}

/// Neither waits for a writer that never comes, nor reads what never ends.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_at_once() {
    let bench = Bench::new();
    let made = std::process::Command::new("mkfifo")
        .arg(bench.path("pipe"))
        .status();
    assert!(made.expect("mkfifo runs").success());
    let began = Instant::now();
    for verb in [
        "run", "check", "curve", "map", "scan", "steady", "simulate", "spectrum", "accuracy",
    ] {
        for path in ["pipe", "/dev/zero", "/dev/null", "/dev/stdin"] {
            let mut command = bench.command(&[verb, path]);
            // a pipe with a writer that says nothing
            command.stdin(std::process::Stdio::piped());
            let child = command
                .stdout(std::process::Stdio::piped())
                .stderr(std::process::Stdio::piped())
                .spawn()
                .expect("the binary runs");
            let output = child.wait_with_output().expect("the binary ends");
            assert_eq!(output.status.code(), Some(2), "{verb} {path}");
            let said = [output.stdout, output.stderr].concat();
            let said = String::from_utf8(said).expect("UTF-8");
            assert!(said.contains("a pipe or a device"), "{verb} {path}: {said}");
            assert!(said.contains("help: "), "{verb} {path}: {said}");
        }
    }
    assert!(began.elapsed() < Duration::from_secs(20));
    assert_eq!(bench.names(), ["pipe"]);
}

/// A restart takes the model of its label; another friction law beside it would be passed over.
#[test]
fn a_restart_under_another_friction_law_is_refused() {
    let bench = Bench::new();
    bench.put("first.ron", SMALL);
    bench.run(&["run", "first.ron", "--out", "first"]).expect(0);
    let text = changed(
        SMALL,
        "start: Fast",
        "start: Restart(dir: \"first\", label: 1)",
    );
    bench.put("second.ron", &text);
    bench.run(&["run", "second.ron"]).expect(0);
    let law = "mismatch: 0.2, friction_law: Static(ratio: 1.2),\n    )";
    bench.put("third.ron", changed(&text, "mismatch: 0.2,\n    )", law));
    let stderr = bench.run(&["run", "third.ron"]).expect(2).stderr;
    assert!(stderr.starts_with("error: third.ron:5:38: "), "{stderr}");
    assert!(stderr.contains("another friction law"), "{stderr}");
    assert!(stderr.contains("help: leave out"), "{stderr}");
}

/// What only the mathematics refuses is pointed to as well, whatever the exit code.
#[test]
fn models_without_a_wave_are_pointed_to() {
    let cases = [
        ("friction: 0.5", "friction: 1.5", "1.5", 3, "meet in a fold"),
        (
            "friction: 0.5",
            "friction: 0.0",
            "0.0",
            3,
            "nothing drives a wave",
        ),
        (
            "mismatch: 0.2,\n    )",
            "mismatch: 0.2, damping: (mass: 0.4),\n    )",
            "0.4",
            3,
            "its stick zone vanishes",
        ),
        (
            "mismatch: 0.2,\n    )",
            "mismatch: 0.2, damping: (stiffness: 0.01), friction_law: Static(ratio: 1.1),\n    )",
            "Static(ratio: 1.1)",
            2,
            "posed for Coulomb's law",
        ),
        (
            "start: Fast",
            "start: Hopf",
            "Mismatch",
            2,
            "Friction, MassDamping or StiffnessDamping",
        ),
    ];
    for (from, to, marked, code, words) in cases {
        let text = changed(SMALL, from, to).replace("toward: Down,", "");
        let bench = Bench::new();
        bench.put("p.ron", &text);
        let stderr = bench.run(&["run", "p.ron"]).expect(code).stderr;
        assert!(stderr.contains(words), "{stderr}");
        assert!(stderr.contains("\nhelp: "), "{stderr}");
        let carets = stderr.lines().nth(2).expect("carets").chars();
        let source = stderr.lines().nth(1).expect("the line").chars();
        let under: String = source
            .zip(carets)
            .filter(|(_, mark)| *mark == '^')
            .map(|(c, _)| c)
            .collect();
        assert_eq!(under, marked, "{stderr}");
        assert_eq!(bench.names(), ["p.ron"]);
    }
    // the Hopf point lies at α = 0.3189
    let bench = Bench::new();
    let text = changed(SMALL, "start: Fast", "start: Hopf");
    let text = changed(&text, "parameter: Mismatch", "parameter: MassDamping");
    let text = changed(&text, "mismatch: 0.2", "mismatch: 0.9");
    bench.put("p.ron", changed(&text, "[0.195]", "[]"));
    let stderr = bench.run(&["run", "p.ron"]).expect(2).stderr;
    assert!(
        stderr.starts_with("error: p.ron:10:16: the Hopf point of mode 4 lies at"),
        "{stderr}"
    );
    assert!(stderr.contains("help: widen the range"), "{stderr}");
    // the scheme of order 6 is unstable at this step
    let section = "simulation: (body: Ring(points: 64, order: Sixth), start: SteadySliding, \
                   duration: 1.0, courant: 0.9, every: 1.0), output:";
    bench.put("p.ron", changed(SMALL, "output:", section));
    let stderr = bench.run(&["simulate", "p.ron"]).expect(2).stderr;
    assert!(stderr.contains("where the scheme is stable"), "{stderr}");
    assert!(stderr.contains("courant: 0.9, every"), "{stderr}");
    assert!(
        stderr.contains("help: take a smaller Courant number"),
        "{stderr}"
    );
}

#[test]
fn folders_that_cannot_be_written_are_refused() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    bench.put("file", "mine");
    // no user may write below a file, not even root
    let run = |out: &str, more: &[&str], code: i32| {
        let outcome = bench.run(&[&["run", "problem.ron", "--out", out], more].concat());
        let stderr = outcome.expect(code).stderr;
        assert!(stderr.starts_with(&format!("error: {out}")), "{stderr}");
    };
    run("file/x", &[], 4);
    run("file/x/y", &["--force"], 4);
    run("file/x", &["--resume"], 4);
    run("file", &[], 2);
    run("file", &["--force"], 2);
    run("file", &["--resume"], 2);
    let mut names = vec!["file", "problem.ron"];
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let folder = bench.path("locked");
        fs::create_dir(&folder).expect("a folder");
        fs::set_permissions(&folder, fs::Permissions::from_mode(0o555)).expect("permissions");
        // permissions do not bind root
        if fs::write(folder.join("probe"), "").is_err() {
            run("locked/x", &[], 4);
            run("locked", &[], 4);
        }
        fs::set_permissions(&folder, fs::Permissions::from_mode(0o755)).expect("permissions");
        names.insert(1, "locked");
    }
    assert_eq!(bench.names(), names);
    assert_eq!(fs::read(bench.path("file")).expect("the file"), b"mine");
}

#[test]
fn wrong_usage_is_refused() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    for arguments in [
        &[][..],
        &["frobnicate"],
        &["run"],
        &["check"],
        &["plot"],
        &["run", "problem.ron", "--resume", "--force"],
        &["run", "problem.ron", "--threads", "0"],
        &["run", "problem.ron", "--threads", "two"],
        &["run", "problem.ron", "--ouT", "x"],
        &["run", "problem.ron", "--out", ""],
        &["plot", "x", "--format", "gif"],
    ] {
        let outcome = bench.run(arguments).expect(2);
        assert!(outcome.stderr.contains("Usage: ") || outcome.stderr.contains("--help"));
        assert_eq!(bench.names(), ["problem.ron"], "{arguments:?}");
    }
}
