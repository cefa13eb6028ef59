//! What a message advises helps, and destroys nothing.

use std::fs;

use crate::cli::harness::{Bench, MANIFEST, SMALL, assert_same, changed, problem, snapshot};

/// Refused with this code; the message has and lacks these words.
#[track_caller]
fn says(bench: &Bench, arguments: &[&str], code: i32, has: &[&str], lacks: &[&str]) {
    let stderr = bench.run(arguments).expect(code).stderr;
    for word in has {
        assert!(
            stderr.contains(word),
            "{arguments:?}: no {word} in {stderr}"
        );
    }
    for word in lacks {
        assert!(!stderr.contains(word), "{arguments:?}: {word} in {stderr}");
    }
}

/// A small problem with a map of four cells.
fn with_map() -> String {
    let map = "map: (first: (parameter: Friction, range: (0.4, 0.5)), second: (parameter: Mismatch, \
               range: (0.19, 0.2)), points: Grid(rows: 2, columns: 2), starts: [Fast]),\n    output:";
    changed(SMALL, "output:", map)
}

/// What a kill leaves is not damaged: it is gone on with, and `--force` would throw it away.
#[test]
fn what_is_not_finished_is_gone_on_with() {
    let bench = Bench::new();
    bench.put("map.ron", with_map());
    bench.put("curve.ron", problem("mode4_curve.ron"));
    for (verb, lost) in [
        ("map", &["map.csv", "map.svg", "map.parquet"][..]),
        ("curve", &["curve.csv", "curve.svg", "curve.steps"]),
    ] {
        let file = format!("{verb}.ron");
        let compute = [verb, &file, "--out", verb, "--quiet"];
        bench.run(&compute).expect(0);
        let whole = snapshot(&bench.path(verb));
        for name in lost {
            // a build without Parquet has none
            fs::remove_file(bench.path(verb).join(name)).unwrap_or_default();
        }
        let again = format!("`brakewave {verb} PROBLEM.ron --out {verb} --resume`");
        for show in ["plot", "report"] {
            says(&bench, &[show, verb], 2, &[&again], &["--force", "damaged"]);
        }
        bench.run(&[&compute[..], &["--resume"]].concat()).expect(0);
        assert_same(&snapshot(&bench.path(verb)), &whole, verb);
        bench.run(&["plot", verb]).expect(0);
    }
    // killed before anything was written but the list of names
    for (kind, verb) in [
        ("run", "run"),
        ("map", "map"),
        ("curve", "curve"),
        ("accuracy", "accuracy"),
        ("simulation", "simulate"),
    ] {
        let version = env!("CARGO_PKG_VERSION");
        fs::create_dir_all(bench.path("bare")).expect("a folder");
        let manifest = format!("brakewave {version}\n{kind} of problem 0\n");
        bench.put(&format!("bare/{MANIFEST}"), manifest);
        for show in ["plot", "report"] {
            let words = [&format!("brakewave {verb} "), "--resume"];
            says(&bench, &[show, "bare"], 2, &words, &["--force", "damaged"]);
        }
    }
}

/// Without its branch a folder has nothing to show: `report` says so as `plot` does.
#[test]
fn a_run_without_its_branch_has_no_report() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    bench
        .run(&["run", "problem.ron", "--out", "out", "--quiet"])
        .expect(0);
    for empty in [true, false] {
        match empty {
            true => drop(bench.put("out/branch.csv", "")),
            false => fs::remove_file(bench.path("out/branch.csv")).expect("a table"),
        }
        for show in ["plot", "report"] {
            says(
                &bench,
                &[show, "out"],
                4,
                &["branch.csv: damaged"],
                &["--resume"],
            );
        }
        assert!(!bench.path("out/report.html").exists());
    }
}

/// A manifest that is none tells nobody what may be replaced: not even `--force` helps, and is not advised.
#[test]
fn a_manifest_that_is_none_takes_a_hand() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    bench
        .run(&["run", "problem.ron", "--out", "out", "--quiet"])
        .expect(0);
    bench.put(&format!("out/{MANIFEST}"), "junk\nmore\n");
    for more in [&[][..], &["--force"], &["--resume"]] {
        let run = [&["run", "problem.ron", "--out", "out"], more].concat();
        says(
            &bench,
            &run,
            4,
            &[MANIFEST, "by hand", "--out"],
            &["--force", "--resume"],
        );
    }
    says(
        &bench,
        &["report", "out"],
        4,
        &[MANIFEST],
        &["--force", "--resume"],
    );
}

/// A verb advises the options that it has.
#[test]
fn no_verb_advises_an_option_that_it_lacks() {
    let bench = Bench::new();
    bench.put("problem.ron", with_map());
    let merge = ["map", "merge", "map", "--out", "joined"];
    let map = ["map", "problem.ron", "--out", "map", "--quiet"];
    let steady = ["steady", "problem.ron", "--out", "steady"];
    for (verb, resumes) in [(&map[..], true), (&merge, false), (&steady, false)] {
        bench.run(verb).expect(0);
        let (has, lacks): (&[&str], &[&str]) = match resumes {
            true => (&["--force", "--resume", "--out"], &[]),
            false => (&["--force", "--out"], &["--resume"]),
        };
        says(&bench, verb, 2, has, lacks);
    }
    // a row that is damaged is computed once more, and no other is lost
    let row = bench.path("map/rows/000000001.csv");
    let text = fs::read_to_string(&row).expect("a row");
    fs::write(&row, &text[..text.len() - 9]).expect("a row");
    let merge = ["map", "merge", "map", "--out", "other"];
    says(&bench, &merge, 4, &["damaged", "--resume"], &["--force"]);
    bench.run(&[&map[..], &["--resume"]].concat()).expect(0);
    bench.run(&merge).expect(0);
    // a disk that is full
    #[cfg(target_os = "linux")]
    for (verb, resume) in [
        ("plot map", false),
        ("report map", false),
        ("steady problem.ron --out steady --force", false),
        ("map problem.ron --out map --force", true),
    ] {
        let script = format!(
            "ulimit -f 0; trap '' XFSZ; exec {} {verb}",
            env!("CARGO_BIN_EXE_brakewave")
        );
        let mut shell = std::process::Command::new("sh");
        let output = shell
            .args(["-c", &script])
            .current_dir(bench.path(""))
            .output();
        let output = output.expect("a shell");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{verb}: {stderr}");
        assert!(stderr.contains("make room"), "{verb}: {stderr}");
        assert_eq!(stderr.contains("--resume"), resume, "{verb}: {stderr}");
    }
}
