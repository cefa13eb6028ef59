//! Work that is interrupted says how to go on, and a problem may come from standard input.

use std::fs;
use std::io::Write;
use std::process::Stdio;

use crate::cli::harness::{Bench, Outcome, SMALL, changed, snapshot};

/// Runs the binary with this text on its standard input.
fn given(bench: &Bench, text: &str, arguments: &[&str]) -> Outcome {
    let mut command = bench.command(arguments);
    command.stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the binary starts");
    let mut input = child.stdin.take().expect("its standard input");
    // one that refuses its arguments reads nothing
    let _ = input.write_all(text.as_bytes());
    drop(input);
    let output = child.wait_with_output().expect("the binary runs");
    Outcome {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).expect("stdout is UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("stderr is UTF-8"),
    }
}

/// A problem on standard input has the results of the same file, and is kept beside them.
#[test]
fn a_problem_comes_from_standard_input() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    let file = ["run", "problem.ron", "-q", "--out", "file"];
    assert_eq!(bench.run(&file).expect(0).stdout, "");
    given(&bench, SMALL, &["run", "-", "-q"]).expect(0);
    let [file, input] = ["file", "results/stdin"].map(|name| snapshot(&bench.path(name)));
    assert!(file == input);
    let source = fs::read_to_string(bench.path("results/stdin/source.ron")).expect("it");
    assert_eq!(source, SMALL);
    given(&bench, SMALL, &["run", "-", "-q"]).expect(2);
    given(&bench, SMALL, &["run", "-", "-q", "--resume"]).expect(0);
    given(&bench, SMALL, &["check", "-"]).expect(0);
    // what is wrong with it is said of it, and what ends at once is no problem
    let wrong = changed(SMALL, "mode: 4", "mode: 0");
    let refused = given(&bench, &wrong, &["run", "-"]).expect(2).stderr;
    assert!(refused.contains("standard input"), "{refused}");
    given(&bench, "", &["map", "-"]).expect(2);
    let map = "map: (first: (parameter: Friction, range: (0.4, 0.5)), second: (parameter: Mismatch, \
               range: (0.19, 0.2)), points: Grid(rows: 2, columns: 2), starts: [Fast]),\n    output:";
    let map = changed(SMALL, "output:", map);
    given(&bench, &map, &["map", "-", "-q", "--out", "map"]).expect(0);
}

/// The command line that an interrupt names ends in the files of a run that was left alone.
#[cfg(unix)]
#[test]
fn an_interrupted_run_names_the_command_that_goes_on() {
    use crate::cli::harness::{assert_same, finest};
    use std::process::Command;
    let bench = Bench::new();
    bench.put("my problem.ron", finest());
    let whole = ["run", "my problem.ron", "--out", "whole", "-q"];
    bench.run(&whole).expect(0);
    let arguments = [
        "run",
        "my problem.ron",
        "--out",
        "out",
        "--quiet",
        "--force",
    ];
    let mut command = bench.command(&arguments);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let begun = bench.path("out/branch.ron");
    while !begun.exists() && child.try_wait().expect("a child").is_none() {
        std::thread::sleep(std::time::Duration::from_micros(200));
    }
    let signal = ["-INT", &child.id().to_string()];
    Command::new("kill").args(signal).status().expect("kill");
    let output = child.wait_with_output().expect("the binary ends");
    // a fast machine may be done before
    if output.status.code() == Some(0) {
        return;
    }
    assert_eq!(output.status.code(), Some(130));
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    let command = said.split('`').nth(1).expect("a command line");
    assert!(command.contains("'my problem.ron'"), "{said}");
    let shell = Command::new("sh")
        .args(["-c", command])
        .current_dir(bench.path(""))
        .stdin(Stdio::null())
        .status();
    assert!(shell.expect("a shell").success(), "{said}");
    let [whole, out] = ["whole", "out"].map(|name| snapshot(&bench.path(name)));
    assert_same(&whole, &out, "the command of the interrupt");
}
