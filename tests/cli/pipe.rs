//! A reader that has seen enough closes the pipe; that is no error, and no excuse either.

use std::fs;
use std::io;
use std::process::Stdio;

use crate::cli::harness::{Bench, SMALL, changed, snapshot};

/// Runs with a standard output that nobody reads, not even its first byte.
#[track_caller]
fn unread(bench: &Bench, arguments: &[&str], code: i32) -> String {
    let (reader, writer) = io::pipe().expect("a pipe");
    // before the binary starts, or it might have written all it has into the pipe
    drop(reader);
    let mut command = bench.command(arguments);
    command.stdout(writer).stderr(Stdio::piped());
    let output = command.spawn().and_then(|child| child.wait_with_output());
    let output = output.expect("the binary runs");
    let stderr = String::from_utf8(output.stderr).expect("stderr is UTF-8");
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    stderr
}

#[test]
fn a_closed_pipe_is_no_error() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    assert_eq!(unread(&bench, &["new"], 0), "");
    assert_eq!(unread(&bench, &["--help"], 0), "");
    assert_eq!(unread(&bench, &["check", "problem.ron"], 0), "");
    // the results are those of a run that is read
    assert_eq!(
        unread(&bench, &["run", "problem.ron", "--out", "unread"], 0),
        ""
    );
    bench
        .run(&["run", "problem.ron", "--out", "read"])
        .expect(0);
    assert!(snapshot(&bench.path("unread")) == snapshot(&bench.path("read")));
    fs::remove_file(bench.path("unread/diagram.svg")).expect("a picture");
    assert_eq!(unread(&bench, &["plot", "unread"], 0), "");
    assert!(bench.path("unread/diagram.svg").exists());
}

/// `check` on two files, of which the second is wrong, with the report for a machine.
#[test]
fn a_closed_pipe_does_not_hide_a_failure() {
    let bench = Bench::new();
    bench.put("good.ron", SMALL);
    bench.put(
        "false.ron",
        changed(SMALL, "UZ, mismatch: 0.195", "UZ, mismatch: 0.1951"),
    );
    unread(
        &bench,
        &["check", "good.ron", "false.ron", "--junit", "report.xml"],
        1,
    );
    assert!(bench.path("report.xml").exists());
    bench.put("bad.ron", "");
    unread(&bench, &["check", "good.ron", "bad.ron"], 2);
    // a branch that ends early
    let few = "toward: Down, max_points: 3";
    bench.put("ends.ron", changed(SMALL, "toward: Down", few));
    let stderr = unread(&bench, &["run", "ends.ron"], 3);
    assert!(stderr.contains("ended before its range"), "{stderr}");
}
