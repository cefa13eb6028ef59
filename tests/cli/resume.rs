//! A run may be killed at any moment: what it leaves is valid, and going on from there ends in the
//! files of a run that was left alone, byte for byte.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use crate::harness::{
    Bench, MANIFEST, SMALL, Snapshot, Table, assert_same, changed, problem, snapshot,
};

/// Two legs through changes of regime, with small steps, many labels, profiles and pictures.
fn long() -> String {
    let text = problem("mode4_mismatch.ron");
    let text = changed(&text, "range: (0.0003, 0.2)", "range: (0.0003, 0.21)");
    // both legs have a start and an end; the count of them has to survive a kill
    let steps = "toward: Both, ds_max: 2e-4, stop_after: [(event: EP, count: 4)]";
    let text = changed(&text, "toward: Down", steps);
    // the switches of so many points would make a picture of megabytes
    let text = changed(&text, "Column(\"switches\"), ", "");
    changed(&text, "profiles: 9", "profiles: 40")
}

/// Starts a run and kills it when `moment` has come; whether it was still running then.
fn kill_at(bench: &Bench, arguments: &[&str], moment: &dyn Fn(&Path) -> bool) -> bool {
    let out = bench.path("out");
    let mut child = bench
        .command(arguments)
        .stdout(Stdio::null())
        .spawn()
        .expect("the binary runs");
    while !moment(&out) && child.try_wait().expect("a child").is_none() {
        thread::sleep(Duration::from_micros(200));
    }
    child.kill().expect("the child can be killed");
    // a killed process has no exit code
    child.wait().expect("a child").code().is_none()
}

/// Whether a file of the folder has reached a length.
fn reaches(file: &'static str, length: usize) -> impl Fn(&Path) -> bool {
    move |out| fs::metadata(out.join(file)).is_ok_and(|file| file.len() >= length as u64)
}

/// The tables hold the first rows of the full ones and no more than a piece of a row besides;
/// the restart file is absent or whole.
fn assert_readable(bench: &Bench, full: &Snapshot) {
    let out = bench.path("out");
    for name in ["branch.csv", "events.csv"] {
        let Ok(text) = fs::read(out.join(name)) else {
            continue;
        };
        let whole = text
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        assert!(full[Path::new(name)].starts_with(&text[..whole]), "{name}");
        if whole > 0 {
            // every row has the columns of the header
            Table::parse(&text[..whole]);
        }
    }
    if out.join("branch.ron").exists() {
        // the binary itself reads it: what is drawn is replaced when the run goes on
        bench.run(&["plot", "out"]).expect(0);
    }
}

const RUN: [&str; 5] = ["run", "problem.ron", "--out", "out", "--quiet"];
const RESUME: [&str; 6] = ["run", "problem.ron", "--out", "out", "--quiet", "--resume"];

#[test]
fn a_killed_run_goes_on_to_the_same_bytes() {
    let bench = Bench::new();
    bench.put("problem.ron", long());
    let out = bench.path("out");
    bench.run(&RUN).expect(0);
    let full = snapshot(&out);
    let length = full[Path::new("branch.csv")].len();
    assert!(full.len() > 40, "profiles and pictures");

    type Moment<'a> = (&'a str, &'a dyn Fn(&Path) -> bool, bool);
    // where `true`, the run has so much before it that it must have been killed
    let moments: &[Moment] = &[
        ("at once", &|_| true, true),
        ("folder", &|out| out.exists(), true),
        ("first row", &reaches("branch.csv", 300), true),
        ("restart file", &reaches("branch.ron", 1), true),
        ("profile", &reaches("profiles/5.csv", 1), true),
        ("half", &reaches("branch.csv", length / 2), false),
        ("second leg", &reaches("branch.csv", length - 20_000), false),
        ("pictures", &reaches("diagram.svg", 1), false),
    ];
    for (name, moment, certain) in moments {
        fs::remove_dir_all(&out)
            .or_else(absent)
            .expect("a fresh start");
        let killed = kill_at(&bench, &RUN, *moment);
        assert!(killed || !certain, "{name}: finished before it was killed");
        assert_readable(&bench, &full);
        bench.run(&RESUME).expect(0);
        assert_same(&snapshot(&out), &full, name);
    }

    // killed twice, and what a power failure may add: rows torn within a character, a restart
    // file half written, a profile of a label that is not saved, a name cut short
    fs::remove_dir_all(&out).expect("a fresh start");
    assert!(kill_at(&bench, &RUN, &reaches("branch.csv", length / 5)));
    kill_at(&bench, &RESUME, &reaches("branch.csv", length / 2));
    let manifest = fs::read_to_string(out.join(MANIFEST)).expect("the manifest");
    let profiles = manifest.matches("profiles/").count();
    let next = format!("profiles/{}.csv", profiles + 1);
    let named = format!("{next}\nprofiles/99");
    for (name, torn) in [
        ("branch.csv", &b"99,,,slip-sti"[..]),
        ("events.csv", &b"99,RV,1.0,\xce"[..]),
        ("branch.ron.new", &b"(version:\"0"[..]),
        (&next, &b"theta,U"[..]),
        (MANIFEST, named.as_bytes()),
    ] {
        let path = out.join(name);
        let mut bytes = fs::read(&path).unwrap_or_default();
        bytes.extend(torn);
        fs::write(&path, bytes).expect("a file can be written");
    }
    bench.run(&RESUME).expect(0);
    assert_same(&snapshot(&out), &full, "torn");
}

/// What is not there need not be removed.
fn absent(error: std::io::Error) -> std::io::Result<()> {
    match error.kind() {
        std::io::ErrorKind::NotFound => Ok(()),
        _ => Err(error),
    }
}

#[test]
fn threads_and_repetition_do_not_change_a_byte() {
    let bench = Bench::new();
    bench.put("problem.ron", problem("mode4_mismatch.ron"));
    let run = |out: &str, threads: &str| {
        let outcome = bench.run(&["run", "problem.ron", "--out", out, "--threads", threads]);
        let mut said = outcome.expect(0).stdout;
        // the last line names the folder
        let last = said.rfind("results in ").expect("the folder");
        said.truncate(last);
        (snapshot(&bench.path(out)), said)
    };
    let (first, first_said) = run("one", "1");
    assert!(first.len() > 25);
    for (out, threads) in [("again", "1"), ("two", "2"), ("five", "5")] {
        let (files, said) = run(out, threads);
        assert_same(&files, &first, out);
        assert_eq!(said, first_said, "{out}");
    }
}

#[test]
fn existing_results_are_guarded() {
    let bench = Bench::new();
    let out = bench.path("out");
    bench.put("problem.ron", SMALL);
    let other = changed(SMALL, "stop_at: [0.195]", "stop_at: [0.196]");
    bench.put("other.ron", other);
    let run = |file: &str, more: &[&str], code: i32| {
        let arguments = [&["run", file, "--out", "out"], more].concat();
        bench.run(&arguments).expect(code).stderr
    };
    run("problem.ron", &[], 0);
    let finished = snapshot(&out);

    // going on with a finished run changes nothing
    run("problem.ron", &["--resume"], 0);
    assert_same(&snapshot(&out), &finished, "resumed");
    // neither the same nor another problem may overwrite, nor may another problem go on
    for (file, more, said) in [
        ("problem.ron", &[][..], "--force"),
        ("other.ron", &[], "--force"),
        ("other.ron", &["--resume"], "another problem"),
    ] {
        let stderr = run(file, more, 2);
        assert!(stderr.contains(said), "{stderr}");
        assert_same(&snapshot(&out), &finished, said);
    }
    // a restart file that is lost or damaged is no licence to wipe the tables
    let restart = fs::read(out.join("branch.ron")).expect("the restart file");
    fs::write(out.join("branch.ron"), &restart[..restart.len() / 2]).expect("damaged");
    let damaged = snapshot(&out);
    let stderr = run("problem.ron", &["--resume"], 4);
    assert!(stderr.contains("branch.ron: damaged: "), "{stderr}");
    assert_same(&snapshot(&out), &damaged, "damaged");
    fs::remove_file(out.join("branch.ron")).expect("lost");
    let lost = snapshot(&out);
    run("problem.ron", &["--resume"], 4);
    assert_same(&snapshot(&out), &lost, "lost");
    // tables shorter than what is saved cannot be gone on with
    fs::write(out.join("branch.ron"), &restart).expect("restored");
    let rows = fs::read(out.join("branch.csv")).expect("the table");
    fs::write(out.join("branch.csv"), &rows[..rows.len() / 2]).expect("shortened");
    run("problem.ron", &["--resume"], 4);
}

#[test]
fn force_replaces_results_and_nothing_else() {
    let bench = Bench::new();
    let out = bench.path("out");
    // more labels, profiles and pictures than the run that replaces them
    bench.put("many.ron", problem("mode4_mismatch.ron"));
    bench.put("few.ron", SMALL);
    bench.run(&["run", "few.ron", "--out", "fresh"]).expect(0);
    let mut expected = snapshot(&bench.path("fresh"));
    bench.run(&["run", "many.ron", "--out", "out"]).expect(0);
    bench.run(&["plot", "out", "--format", "png"]).expect(0);
    fs::create_dir_all(out.join("deep/er")).expect("a folder");
    for name in [
        "notes.txt",
        "photo.png",
        "drawing.svg",
        "paper.pdf",
        "data.csv",
        "deep/er/branch.csv",
        "profiles/mine.csv",
        "profiles/README",
    ] {
        fs::write(out.join(name), name).expect("a file");
        expected.insert(name.into(), name.into());
    }
    bench
        .run(&["run", "few.ron", "--out", "out", "--force"])
        .expect(0);
    assert_same(&snapshot(&out), &expected, "forced");
    // going on leaves them alone too
    bench
        .run(&["run", "few.ron", "--out", "out", "--resume"])
        .expect(0);
    assert_same(&snapshot(&out), &expected, "resumed");
}

#[test]
fn resuming_what_has_not_begun_begins_it() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    bench
        .run(&["run", "problem.ron", "--out", "fresh"])
        .expect(0);
    fs::create_dir(bench.path("empty")).expect("a folder");
    for out in ["absent", "empty"] {
        bench
            .run(&["run", "problem.ron", "--out", out, "--resume"])
            .expect(0);
        assert_same(
            &snapshot(&bench.path(out)),
            &snapshot(&bench.path("fresh")),
            out,
        );
    }
    // where no folder is named it is the stem of the file below `results`
    bench.run(&["run", "problem.ron"]).expect(0);
    let default = snapshot(&bench.path("results/problem"));
    assert_same(&default, &snapshot(&bench.path("fresh")), "default folder");
}
