//! Files of the user are never lost: what the program did not write stays, links are not followed,
//! inputs are not replaced, and no two processes write to one folder.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use crate::cli::harness::{
    Bench, MANIFEST, SMALL, Snapshot, assert_same, changed, finest, problem, snapshot,
};

/// A bench with a finished run of `problem.ron` in `out`.
fn finished() -> (Bench, Snapshot) {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    bench
        .run(&["run", "problem.ron", "--out", "out", "--quiet"])
        .expect(0);
    let files = snapshot(&bench.path("out"));
    (bench, files)
}

/// Refused with this code and word, and not a byte below the bench is another one.
#[track_caller]
fn refused(bench: &Bench, arguments: &[&str], code: i32, word: &str) {
    let before = snapshot(&bench.path(""));
    let stderr = bench.run(arguments).expect(code).stderr;
    assert!(stderr.contains(word), "{arguments:?}: {stderr}");
    assert_same(
        &snapshot(&bench.path("")),
        &before,
        &format!("{arguments:?}"),
    );
}

/// The manifest names every file there is, and no other.
#[test]
fn the_manifest_lists_what_was_written() {
    let (bench, files) = finished();
    let format = if cfg!(feature = "raster") {
        "pdf"
    } else {
        "svg"
    };
    bench.run(&["plot", "out", "--format", format]).expect(0);
    let manifest = fs::read_to_string(bench.path("out").join(MANIFEST)).expect("a manifest");
    let mut lines = manifest.lines();
    let version = env!("CARGO_PKG_VERSION");
    assert_eq!(lines.next(), Some(format!("brakewave {version}").as_str()));
    assert!(
        lines
            .next()
            .is_some_and(|line| line.starts_with("run of problem "))
    );
    let mut listed: Vec<&Path> = lines.map(Path::new).collect();
    listed.sort();
    let there = snapshot(&bench.path("out"));
    let there: Vec<&Path> = there
        .keys()
        .map(|name| name.as_path())
        .filter(|name| *name != Path::new(MANIFEST))
        .collect();
    assert_eq!(listed, there);
    // a picture in another format is one more; the manifest is not in the list
    let more = usize::from(cfg!(feature = "raster"));
    assert_eq!(there.len(), files.len() - 1 + more);
}

#[test]
fn a_folder_that_is_no_result_is_left_alone() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    fs::create_dir(bench.path("mine")).expect("a folder");
    bench.put("mine/events.csv", "my events");
    for more in [&[][..], &["--force"], &["--resume"]] {
        let run = [&["run", "problem.ron", "--out", "mine"], more].concat();
        refused(&bench, &run, 2, "events.csv");
    }
    // the folder of the problem file itself
    bench.put("map.ron", problem("mode4_map.ron"));
    refused(
        &bench,
        &["map", "map.ron", "--out", ".", "--force"],
        2,
        "--out",
    );
    bench.put("branch.ron", SMALL);
    refused(
        &bench,
        &["run", "branch.ron", "--out", ".", "--force"],
        2,
        "--out",
    );
    refused(&bench, &["plot", "mine"], 2, "branch.ron");
}

/// A file of the user with the name of a result that was not written yet: before anything is lost.
#[test]
fn what_is_in_the_way_is_refused_before_old_results_go() {
    let (bench, _) = finished();
    let with = changed(SMALL, "profiles: 2", "profiles: 6");
    let with = changed(&with, "output:", "stability: (sectors: All),\n    output:");
    bench.put("more.ron", with);
    for name in ["spectrum.csv", "profiles/7.csv"] {
        bench.put(&format!("out/{name}"), "mine");
        let run = ["run", "more.ron", "--out", "out", "--force"];
        refused(&bench, &run, 2, name);
        fs::remove_file(bench.path("out").join(name)).expect("mine");
    }
    // results of another kind
    bench.put("map.ron", problem("mode4_map.ron"));
    let map = ["map", "map.ron", "--out", "out", "--force"];
    refused(&bench, &map, 2, "another kind");
}

#[cfg(unix)]
#[test]
fn links_are_not_followed() {
    use std::os::unix::fs::symlink;

    let (bench, files) = finished();
    symlink("out", bench.path("link")).expect("a link");
    for more in [&[][..], &["--force"], &["--resume"]] {
        for out in ["link", "link/"] {
            let run = [&["run", "problem.ron", "--out", out], more].concat();
            refused(&bench, &run, 2, "link");
        }
    }
    refused(&bench, &["plot", "link"], 2, "link");
    // a file that is a link is replaced as a link
    bench.put("mine", "mine");
    let link = |name: &str| {
        let path = bench.path("out").join(name);
        fs::remove_file(&path).expect("a file");
        symlink(bench.path("mine"), path).expect("a link");
    };
    for name in ["branch.csv", "diagram.svg", "branch.ron", "profiles/1.csv"] {
        link(name);
    }
    bench.run(&["run", "problem.ron", "--out", "out", "--force"]);
    assert_same(&snapshot(&bench.path("out")), &files, "forced");
    link("diagram.svg");
    bench.run(&["plot", "out"]).expect(0);
    assert_same(&snapshot(&bench.path("out")), &files, "drawn");
    link("branch.csv");
    refused(
        &bench,
        &["run", "problem.ron", "--out", "out", "--resume"],
        4,
        "branch.csv",
    );
    assert_eq!(fs::read(bench.path("mine")).expect("mine"), b"mine");
    // a folder in it that is a link leads to files of somebody else
    fs::rename(bench.path("out/profiles"), bench.path("elsewhere")).expect("moved");
    symlink(bench.path("elsewhere"), bench.path("out/profiles")).expect("a link");
    for more in ["--force", "--resume"] {
        let run = ["run", "problem.ron", "--out", "out", more];
        refused(&bench, &run, if more == "--force" { 2 } else { 4 }, "out/");
    }
}

/// A backup made of hard links shares no byte with what is written later.
#[cfg(unix)]
#[test]
fn hard_links_are_not_written_through() {
    let (bench, files) = finished();
    let text = fs::read_to_string(bench.path("out/branch.ron")).expect("a restart file");
    let points = String::from_utf8_lossy(&files[Path::new("branch.csv")]);
    let saved = format!("points:{},", points.lines().count() - 1);
    // as a kill before the first step was saved leaves it
    let begun = changed(&text, &saved, "points:0,");
    bench.put("other.ron", changed(SMALL, "[0.195]", "[0.196]"));
    for (index, (restart, arguments)) in [
        (&text, &["run", "other.ron", "--out", "out", "--force"][..]),
        (&begun, &["run", "problem.ron", "--out", "out", "--resume"]),
        (&text, &["plot", "out", "--format", "tex"]),
        (&text, &["report", "out"]),
    ]
    .into_iter()
    .enumerate()
    {
        fs::remove_dir_all(bench.path("out")).expect("a folder");
        for (name, bytes) in &files {
            let path = bench.path("out").join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, bytes).expect("a file");
        }
        bench.put("out/branch.ron", restart);
        let before = snapshot(&bench.path("out"));
        let backup = format!("backup{index}");
        for name in before.keys() {
            let path = bench.path(&backup).join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::hard_link(bench.path("out").join(name), path).expect("a link");
        }
        bench.run(arguments).expect(0);
        let backed_up = snapshot(&bench.path(&backup));
        assert_same(&backed_up, &before, &format!("{arguments:?}"));
        bench
            .run(&["run", "problem.ron", "--out", &backup, "--resume"])
            .expect(0);
    }
}

/// Files are written beside their place under names that are not the user's.
#[test]
fn names_that_look_temporary_are_the_users_own() {
    let (bench, mut files) = finished();
    for name in ["branch.ron.new", "diagram.svg.new", "profiles/mine.csv.new"] {
        bench.put(&format!("out/{name}"), "mine");
        files.insert(name.into(), b"mine".to_vec());
    }
    for more in ["--force", "--resume"] {
        bench
            .run(&["run", "problem.ron", "--out", "out", more])
            .expect(0);
        assert_same(&snapshot(&bench.path("out")), &files, more);
    }
    bench.run(&["plot", "out"]).expect(0);
    assert_same(&snapshot(&bench.path("out")), &files, "drawn");
}

/// A folder of the user's with a name of the list: refused before any result is removed.
#[test]
fn a_folder_in_the_list_of_files_is_not_removed() {
    let (bench, _) = finished();
    fs::create_dir(bench.path("out/zdir")).expect("a folder");
    let manifest = fs::read_to_string(bench.path("out").join(MANIFEST)).expect("a manifest");
    bench.put(&format!("out/{MANIFEST}"), manifest + "zdir\n");
    let run = ["run", "problem.ron", "--out", "out", "--force"];
    refused(&bench, &run, 2, "out/zdir: in the way");
}

/// The stem of `..ron` is a dot: the folder of all results itself.
#[test]
fn a_file_of_dots_has_a_folder_of_its_own() {
    let bench = Bench::new();
    for name in ["..ron", "...ron"] {
        bench.put(name, SMALL);
        bench.run(&["run", name, "--quiet"]).expect(0);
        assert!(bench.path("results").join(name).join(MANIFEST).exists());
    }
    assert_eq!(bench.names(), ["...ron", "..ron", "results"]);
}

/// A folder that is moved away takes its results along, and nothing is written to another in its place.
#[cfg(unix)]
#[test]
fn a_folder_replaced_during_a_run_is_left_alone() {
    let bench = Bench::new();
    bench.put("problem.ron", finest());
    let run = ["run", "problem.ron", "--out", "out", "--quiet"];
    bench.run(&run).expect(0);
    let whole = snapshot(&bench.path("out"));
    fs::remove_dir_all(bench.path("out")).expect("a folder");
    let child = bench
        .command(&run)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    while !bench.path("out/profiles/2.csv").exists() {
        thread::sleep(Duration::from_micros(200));
    }
    fs::rename(bench.path("out"), bench.path("moved")).expect("a folder");
    fs::create_dir(bench.path("out")).expect("a folder");
    bench.put("out/mine", "mine");
    let ended = child.wait_with_output().expect("a child");
    let stderr = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(4), "{stderr}");
    assert!(stderr.contains("out: moved away or replaced"), "{stderr}");
    assert_eq!(snapshot(&bench.path("out")).len(), 1, "{stderr}");
    let resume = [
        "run",
        "problem.ron",
        "--out",
        "moved",
        "--quiet",
        "--resume",
    ];
    bench.run(&resume).expect(0);
    assert_same(&snapshot(&bench.path("moved")), &whole, "moved");
}

#[test]
fn inputs_are_not_replaced() {
    let (bench, _) = finished();
    let check = ["check", "problem.ron", "--junit", "problem.ron"];
    refused(&bench, &check, 2, "read as well");
    // a wave of the folder that would be replaced
    let start = "start: Restart(dir: \"./out/../out\", label: 1)";
    bench.put("again.ron", changed(SMALL, "start: Fast", start));
    let run = ["run", "again.ron", "--out", "out", "--force"];
    refused(&bench, &run, 2, "from which they are computed");
    // a problem file in the place of a result
    bench.put("out/branch.ron", SMALL);
    let run = ["run", "out/branch.ron", "--out", "out", "--force"];
    refused(&bench, &run, 2, "from which they are computed");
}

#[test]
fn one_process_writes_to_a_folder() {
    let bench = Bench::new();
    bench.put("problem.ron", finest());
    bench.put("small.ron", SMALL);
    bench
        .run(&["run", "problem.ron", "--out", "alone", "--quiet"])
        .expect(0);
    let mut child = bench
        .command(&["run", "problem.ron", "--out", "out", "--quiet"])
        .stdout(Stdio::null())
        .spawn()
        .expect("the binary runs");
    while !bench.path("out/branch.csv").exists() {
        thread::sleep(Duration::from_micros(200));
    }
    for more in [&[][..], &["--force"], &["--resume"]] {
        for file in ["problem.ron", "small.ron"] {
            let run = [&["run", file, "--out", "out", "--quiet"], more].concat();
            let stderr = bench.run(&run).expect(2).stderr;
            assert!(stderr.contains("another process"), "{stderr}");
        }
    }
    let early = child.try_wait().expect("a child").is_some();
    assert!(!early, "the run was over before it was disturbed");
    assert!(child.wait().expect("a child").success());
    assert_same(
        &snapshot(&bench.path("out")),
        &snapshot(&bench.path("alone")),
        "disturbed",
    );
}

/// Another version may compute otherwise: its results are not gone on with.
#[test]
fn results_of_another_version_are_not_gone_on_with() {
    let (bench, files) = finished();
    let path = bench.path("out").join(MANIFEST);
    let text = fs::read_to_string(&path).expect("a manifest");
    let version = format!("brakewave {}\n", env!("CARGO_PKG_VERSION"));
    fs::write(&path, changed(&text, &version, "brakewave 0.0.7\n")).expect("a manifest");
    let run = ["run", "problem.ron", "--out", "out", "--resume"];
    refused(&bench, &run, 2, "version 0.0.7");
    bench
        .run(&["run", "problem.ron", "--out", "out", "--force"])
        .expect(0);
    assert_same(&snapshot(&bench.path("out")), &files, "forced");
    // what is no manifest of ours owns nothing
    fs::write(&path, "notes\nbranch.csv\n").expect("a file");
    let run = ["run", "problem.ron", "--out", "out", "--force"];
    refused(&bench, &run, 4, MANIFEST);
    fs::write(
        &path,
        format!("{version}run of problem 0\n../problem.ron\n"),
    )
    .expect("a file");
    refused(&bench, &run, 4, MANIFEST);
}

/// A run without a first point has no results: neither a folder, nor a reason to lose old ones.
#[test]
fn no_first_point_no_change() {
    let (bench, _) = finished();
    let none = changed(SMALL, "friction: 0.5", "friction: 1.2");
    bench.put("none.ron", none);
    let run = ["run", "none.ron", "--out", "out", "--force"];
    refused(&bench, &run, 3, "keeps the results");
    refused(&bench, &["run", "none.ron", "--out", "new/er"], 3, "fold");
    // a Hopf point beyond the range is found to be so after the folder has been taken
    let text = changed(SMALL, "start: Fast", "start: Hopf");
    let text = changed(&text, "parameter: Mismatch", "parameter: MassDamping");
    let text = changed(&text, "(0.19, 0.2)", "(0.4, 0.5)");
    bench.put("beyond.ron", changed(&text, "[0.195]", "[]"));
    let run = ["run", "beyond.ron", "--out", "new/er"];
    refused(&bench, &run, 2, "range");
    let run = ["run", "beyond.ron", "--out", "out", "--force"];
    refused(&bench, &run, 2, "range");
}

#[cfg(not(feature = "raster"))]
#[test]
fn pictures_that_cannot_be_written_are_refused_at_once() {
    let (bench, _) = finished();
    bench.put("map.ron", problem("mode4_map.ron"));
    bench.put("curve.ron", problem("mode4_curve.ron"));
    for arguments in [
        &["plot", "out", "--format", "png"][..],
        &["map", "map.ron", "--plot", "map.png"],
        &["curve", "curve.ron", "--format", "pdf"],
        &["accuracy", "problem.ron", "--format", "pdf"],
        &["steady", "problem.ron", "--plot", "steady.png"],
    ] {
        refused(&bench, arguments, 2, "raster");
    }
}

/// A disk that is full does not end a run in wrong input, and what is there can be gone on with.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_of_output() {
    use std::process::Command;

    let bench = Bench::new();
    bench.put("problem.ron", finest());
    let run = ["run", "problem.ron", "--out", "out", "--quiet"];
    bench.run(&run).expect(0);
    let full = snapshot(&bench.path("out"));
    let size = |name: &str| full[Path::new(name)].len();
    // blocks of 512 bytes; the tables reach the limit before any picture does
    let limits = [0, size("branch.csv") / 3 / 512, size("branch.csv") / 512];
    for blocks in limits {
        fs::remove_dir_all(bench.path("out")).unwrap_or_default();
        let script = format!(
            "ulimit -f {blocks}; trap '' XFSZ; exec {} {}",
            env!("CARGO_BIN_EXE_brakewave"),
            run.join(" ")
        );
        let output = Command::new("sh")
            .args(["-c", &script])
            .current_dir(bench.path(""))
            .output()
            .expect("a shell");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(4), "{blocks} blocks: {stderr}");
        for word in ["out", "write", "make room", "--resume"] {
            assert!(stderr.contains(word), "no {word} in {stderr}");
        }
        bench.run(&[&run[..], &["--resume"]].concat()).expect(0);
        assert_same(&snapshot(&bench.path("out")), &full, "resumed");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_fails_has_its_own_exit_code() {
    let bench = Bench::new();
    bench.put("problem.ron", SMALL);
    let code = |arguments: &[&str], code: i32, words: &[&str]| {
        let stderr = bench.run(arguments).expect(code).stderr;
        for word in words {
            assert!(
                stderr.contains(word),
                "{arguments:?}: no {word} in {stderr}"
            );
        }
    };
    let check = ["check", "problem.ron", "--junit", "/dev/full"];
    code(&check, 4, &["/dev/full", "write", "make room"]);
    let check = ["check", "problem.ron", "--junit", "problem.ron/report.xml"];
    code(&check, 4, &["problem.ron", "write"]);
    let run = ["run", "problem.ron", "--out", "/proc/nothing"];
    code(&run, 4, &["/proc/nothing", "create"]);
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("a device");
    let mut command = bench.command(&["run", "problem.ron", "--out", "out"]);
    let status = command.stdout(full).stderr(Stdio::null()).status();
    assert_eq!(status.expect("the binary runs").code(), Some(4));
    // the results are there all the same
    assert!(bench.path("out/diagram.svg").exists());
    let help = bench.run(&["--help"]).expect(0).stdout;
    assert!(help.contains("4 input or output failed"), "{help}");
}
