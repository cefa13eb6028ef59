//! A run may be killed at any moment: what it leaves is valid, and going on from there ends in the
//! files of a run that was left alone, byte for byte.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use crate::cli::harness::{
    Bench, MANIFEST, SMALL, Snapshot, Table, assert_same, changed, finest, problem, snapshot,
};

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
    bench.put("problem.ron", finest());
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

    // killed twice, and what a power failure may add: rows torn within a character, a profile of a
    // label that is not saved, a name cut short
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
    let format = if cfg!(feature = "raster") {
        "png"
    } else {
        "svg"
    };
    bench.run(&["plot", "out", "--format", format]).expect(0);
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

/// A run from a Hopf point, whose first step hands out a whole family of waves.
#[test]
fn a_run_killed_in_its_first_step_goes_on() {
    let bench = Bench::new();
    let text = problem("mode4_hopf.ron");
    let text = changed(&text, "profiles: 4", "profiles: 40");
    bench.put("problem.ron", text);
    let out = bench.path("out");
    bench.run(&RUN).expect(0);
    let full = snapshot(&out);
    let header = full[Path::new("branch.csv")]
        .iter()
        .position(|byte| *byte == b'\n');
    let header = header.expect("a header") + 1;
    let moments: [&dyn Fn(&Path) -> bool; 5] = [
        &reaches(MANIFEST, 1),
        &reaches("branch.csv", 1),
        &reaches("branch.csv", header + 1),
        &reaches("events.csv", 300),
        &reaches("profiles/2.csv", 1),
    ];
    for (index, moment) in moments.iter().enumerate() {
        fs::remove_dir_all(&out)
            .or_else(absent)
            .expect("a fresh start");
        kill_at(&bench, &RUN, *moment);
        bench.run(&RESUME).expect(0);
        assert_same(&snapshot(&out), &full, &format!("moment {index}"));
    }
    // the very state of such a kill: all rows of the first step, and nothing saved but the beginning
    let restart = String::from_utf8(full[Path::new("branch.ron")].clone()).expect("text");
    let rows = Table::parse(&full[Path::new("branch.csv")]).rows.len();
    let begun = changed(&restart, &format!("points:{rows},"), "points:0,");
    fs::write(out.join("branch.ron"), begun).expect("a restart file");
    bench.run(&RESUME).expect(0);
    assert_same(&snapshot(&out), &full, "nothing saved");
}

/// A resumed run is reported as a whole, and a finished one is said to be finished.
#[test]
fn the_report_is_that_of_the_whole_run() {
    let bench = Bench::new();
    bench.put("problem.ron", finest());
    let out = bench.path("out");
    let loud: Vec<&str> = RUN.into_iter().filter(|word| *word != "--quiet").collect();
    let whole = bench.run(&loud).expect(0).stdout;
    let length = fs::metadata(out.join("branch.csv")).expect("a table").len() as usize;
    fs::remove_dir_all(&out).expect("a fresh start");
    kill_at(&bench, &RUN, &reaches("branch.csv", length / 2));
    let resume = [&loud[..], &["--resume"]].concat();
    let resumed = bench.run(&resume).expect(0).stdout;
    let finished = "the run was finished already: nothing was left to compute\n";
    assert_eq!(resumed.replace(finished, ""), whole);
    let again = bench.run(&resume).expect(0).stdout;
    assert_eq!(
        again,
        changed(&whole, "results in ", &format!("{finished}results in "))
    );
}

/// A restart file that was changed is told to be damaged; nothing is computed from it.
#[test]
fn a_damaged_restart_file_is_refused() {
    let bench = Bench::new();
    let text = changed(
        SMALL,
        "toward: Down",
        "toward: Down, stop_after: [(event: UZ, count: 9)]",
    );
    bench.put("problem.ron", text);
    let start = "start: Restart(dir: \"out\", label: 2)";
    let text = changed(SMALL, "start: Fast", start);
    bench.put("restart.ron", changed(&text, "[0.195]", "[]"));
    bench.run(&RUN).expect(0);
    let path = bench.path("out/branch.ron");
    let whole = fs::read_to_string(&path).expect("a restart file");
    // a list is emptied, or gets a number too many
    let emptied = |name: &str| {
        let at = whole.find(name).unwrap_or_else(|| panic!("{name}")) + name.len();
        let close = at + whole[at..].find(']').expect("the end of a list");
        format!("{}{}", &whole[..at], &whole[close..])
    };
    // the value of the first field of a name
    let set = |name: &str, value: &str| {
        let at = whole.find(name).unwrap_or_else(|| panic!("{name}")) + name.len();
        let close = at + whole[at..].find([',', ')']).expect("the end of a value");
        format!("{}{value}{}", &whole[..at], &whole[close..])
    };
    let longer = |name: &str, more: &str| whole.replacen(name, &format!("{name}{more},"), 1);
    let state = whole.find("state:Some(").expect("a state");
    let mut damages = vec![
        ("leg 0", set("leg:", "0")),
        ("leg 7", set("leg:", "7")),
        ("more labels than waves", set("labels:", "5")),
        ("no signature", emptied("signature:([")),
        ("no zones", emptied("zones:[")),
        ("a zone too many", longer("zones:[", "(0.1,0.2,0.3)")),
        ("a number that is none", set("excess:", "NaN")),
        ("met", emptied("met:[")),
        ("passed", longer("passed:[", "true")),
        ("labels", whole.replacen("label:2,", "label:3,", 1)),
        (
            "another model",
            changed(
                &whole,
                "friction:0.5,mismatch:0.195,",
                "friction:0.6,mismatch:0.195,",
            ),
        ),
        ("empty", String::new()),
        ("half", whole[..whole.len() / 2].to_owned()),
    ];
    for list in ["point:[", "tangent:["] {
        let (head, tail) = whole.split_at(state);
        let at = tail.find(list).expect("a list") + list.len();
        let close = at + tail[at..].find(']').expect("the end of a list");
        damages.push((list, format!("{head}{}{}", &tail[..at], &tail[close..])));
        let more = format!("{head}{}0.5,{}", &tail[..at], &tail[at..]);
        damages.push((list, more));
        let first = at + tail[at..].find(',').expect("a number");
        damages.push((list, format!("{head}{}NaN{}", &tail[..at], &tail[first..])));
    }
    for (name, text) in damages {
        assert_ne!(text, whole, "{name}");
        fs::write(&path, &text).expect("a file");
        let before = snapshot(&bench.path("out"));
        let stderr = bench.run(&RESUME).expect(4).stderr;
        assert!(stderr.contains("branch.ron: damaged: "), "{name}: {stderr}");
        assert_same(&snapshot(&bench.path("out")), &before, name);
        // a wave of it is taken only if it is whole
        let outcome = bench.run(&["run", "restart.ron", "--out", "new", "--force"]);
        let code = outcome.code;
        assert!(
            matches!(code, Some(0 | 4)),
            "{name}: {code:?} {}",
            outcome.stderr
        );
        assert!(
            !outcome.stderr.contains("panicked"),
            "{name}: {}",
            outcome.stderr
        );
    }
}
