//! `brakewave simulate`: its files, and that they do not depend on interruptions or threads.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const SMALL: &str = r#"(
    title: "Small",
    model: (
        coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
        friction: 0.5,
        mismatch: 0.1,
    ),
    wave: (mode: 4, start: Fast),
    simulation: (
        body: BODY,
        start: SteadySliding,
        perturbation: (mode: 4, amplitude: 0.02),
        duration: 30.0,
        snapshots: 3,
    ),
)
"#;

const RING: &str = "Ring(points: 96)";
const ANNULUS: &str = "Annulus(around: 66, across: 4)";

struct Bench(tempfile::TempDir);

impl Bench {
    fn new(problem: &str) -> Bench {
        let bench = Bench(tempfile::tempdir().expect("a temporary folder"));
        fs::write(bench.path("p.ron"), problem).expect("a file can be written");
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_brakewave"));
        command
            .args(arguments)
            .current_dir(self.0.path())
            .stdin(Stdio::null());
        command
    }

    #[track_caller]
    fn run(&self, arguments: &[&str], code: i32) -> String {
        let Output {
            status,
            stdout,
            stderr,
        } = self.command(arguments).output().expect("the binary runs");
        let (out, error) = (
            String::from_utf8_lossy(&stdout),
            String::from_utf8_lossy(&stderr),
        );
        assert_eq!(status.code(), Some(code), "{out}\n{error}");
        assert!(!error.contains("panicked"), "{error}");
        format!("{out}{error}")
    }
}

fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.insert(path.clone(), fs::read(&path).expect("a file"));
        }
    }
    found
}

#[track_caller]
fn same(one: &Path, other: &Path) {
    let (left, right) = (files(one), files(other));
    let names = |files: &BTreeMap<PathBuf, Vec<u8>>, root: &Path| -> Vec<PathBuf> {
        let inside = |path: &PathBuf| path.strip_prefix(root).expect("inside").to_owned();
        files.keys().map(inside).collect()
    };
    assert_eq!(names(&left, one), names(&right, other));
    for ((name, left), right) in left.iter().zip(right.values()) {
        assert!(left == right, "{} differs", name.display());
    }
}

#[test]
fn files_are_written_and_do_not_depend_on_threads() {
    for (body, extension) in [(RING, "npy"), (ANNULUS, "vtk")] {
        let bench = Bench::new(&SMALL.replace("BODY", body));
        let text = bench.run(&["simulate", "p.ron"], 0);
        assert!(text.contains("node-steps per second") && text.contains("energy balance"));
        let folder = bench.path("results/p_simulation");
        for name in [
            "series.csv",
            "measures.csv",
            "regimes.npy",
            "start.csv",
            "end.csv",
            "checkpoint.ron",
            "space_time.svg",
            "phase_plane.svg",
            "profiles.svg",
        ] {
            assert!(
                folder.join(name).metadata().expect(name).len() > 100,
                "{name}"
            );
        }
        for number in 1..=3 {
            assert!(
                folder
                    .join(format!("snapshots/000{number}.{extension}"))
                    .exists()
            );
        }
        let series = fs::read_to_string(folder.join("series.csv")).expect("a series");
        assert_eq!(series.lines().count(), 602);
        let measures = fs::read_to_string(folder.join("measures.csv")).expect("measures");
        assert!(measures.contains("speed,") && measures.contains("growth,"));
        bench.run(
            &[
                "simulate",
                "p.ron",
                "--out",
                "one",
                "--threads",
                "1",
                "--quiet",
            ],
            0,
        );
        same(&folder, &bench.path("one"));
        // results are not overwritten unasked
        assert!(bench.run(&["simulate", "p.ron"], 2).contains("--force"));
        bench.run(&["simulate", "p.ron", "--force", "--quiet"], 0);
        same(&folder, &bench.path("one"));
    }
}

#[test]
fn a_killed_simulation_resumes_to_the_same_bytes() {
    for body in [RING.replace("96", "512"), ANNULUS.replace("66", "264")] {
        let problem = SMALL.replace("BODY", &body);
        let bench = Bench::new(&problem);
        bench.run(&["simulate", "p.ron", "--out", "whole", "--quiet"], 0);
        let mut child = bench
            .command(&["simulate", "p.ron", "--out", "cut", "--quiet"])
            .spawn()
            .expect("the binary runs");
        let series = bench.path("cut/series.csv");
        let patience = Instant::now();
        while fs::metadata(&series).map_or(0, |data| data.len()) < 30_000
            && patience.elapsed() < Duration::from_secs(20)
        {
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().expect("it can be killed");
        child.wait().expect("it ends");
        bench.run(
            &["simulate", "p.ron", "--out", "cut", "--resume", "--quiet"],
            0,
        );
        same(&bench.path("whole"), &bench.path("cut"));
        // a row cut short, and rows beyond the checkpoint, are taken back
        let path = bench.path("cut/series.csv");
        let mut text = fs::read(&path).expect("a series");
        text.extend_from_slice(b"1.0,2.0,spoilt");
        fs::write(&path, text).expect("a file can be written");
        bench.run(
            &["simulate", "p.ron", "--out", "cut", "--resume", "--quiet"],
            0,
        );
        same(&bench.path("whole"), &bench.path("cut"));
        fs::write(bench.path("p.ron"), problem.replace("0.02", "0.03")).expect("a file");
        let text = bench.run(&["simulate", "p.ron", "--out", "cut", "--resume"], 2);
        assert!(text.contains("another problem"), "{text}");
    }
}

#[test]
fn a_wave_is_taken_from_a_result_folder() {
    let problem = SMALL
        .replace("BODY", "Ring(points: 192)")
        .replace("mismatch: 0.1", "mismatch: 0.2")
        .replace("SteadySliding", "Wave(dir: \"wave\", label: 1)")
        .replace(
            "duration: 30.0",
            "duration: 5.0, growth: (sectors: Only([0]), pairs: 50)",
        )
        .replace(
            "simulation:",
            "continuation: (parameter: Mismatch, range: (0.19, 0.2), toward: Down),\n\
             output: (profiles: 1),\n    simulation:",
        );
    let bench = Bench::new(&problem);
    // the wave is not there yet
    bench.run(&["simulate", "p.ron"], 2);
    // and growth is refused before anything is simulated where the grid is too coarse for it
    let coarse = problem.replace("points: 192", "points: 48");
    fs::write(bench.path("c.ron"), coarse).expect("a file");
    let text = bench.run(&["simulate", "c.ron"], 2);
    assert!(text.contains("at least 14 points per wavelength"), "{text}");
    bench.run(&["run", "p.ron", "--out", "wave", "--quiet"], 0);
    bench.run(&["simulate", "p.ron"], 0);
    let growth = fs::read_to_string(bench.path("results/p_simulation/growth.csv")).expect("growth");
    // the same from the table itself
    let branch = fs::read_to_string(bench.path("wave/branch.csv")).expect("a branch");
    let cells = |line: usize| branch.lines().nth(line).expect("a row").split(',');
    let column = cells(0).position(|name| name == "speed").expect("a column");
    let speed = cells(1).nth(column).expect("a speed");
    let table = format!("Profile(file: \"wave/profiles/1.csv\", speed: {speed})");
    let from = "Wave(dir: \"wave\", label: 1)";
    assert!(problem.contains(from));
    fs::write(bench.path("q.ron"), problem.replace(from, &table)).expect("a file");
    bench.run(&["simulate", "q.ron", "--quiet"], 0);
    let read = |name: &str| {
        let path = format!("results/{name}_simulation/series.csv");
        fs::read(bench.path(&path)).expect("a series")
    };
    assert!(read("p") == read("q"));
    let row: Vec<f64> = growth
        .lines()
        .nth(1)
        .expect("an eigenvalue")
        .split(',')
        .map(|cell| cell.parse().expect("a number"))
        .collect();
    // sector, re, im, residual, scatter, grid
    assert!(
        (row[1] - 0.0497).abs() < 0.005 && (row[2] - 2.5416).abs() < 0.01,
        "{row:?}"
    );
}

#[test]
fn what_makes_no_sense_is_refused_with_its_place() {
    let problem = SMALL.replace("BODY", RING);
    for (from, to, words) in [
        (
            "    simulation: (",
            "    simulatoin: (",
            "did you mean `simulation`",
        ),
        (
            "Ring(points: 96)",
            "Ring(points: 3)",
            "`simulation.body.points` is 3",
        ),
        (
            "Ring(points: 96)",
            "Ring(point: 96)",
            "did you mean `points`",
        ),
        (
            "Ring(points: 96)",
            "Rings(points: 96)",
            "did you mean `Ring`",
        ),
        (
            "Ring(points: 96)",
            "Annulus(around: 66, across: 1)",
            "at least 2 elements across",
        ),
        (
            "Ring(points: 96)",
            "Ring(points: 96, friction: Tanh(epsilon: 0.0))",
            "width of the transition",
        ),
        (
            "duration: 30.0",
            "duration: -1.0",
            "`simulation.duration` is -1.0",
        ),
        (
            "duration: 30.0",
            "duration: 30.0, every: 40.0",
            "`simulation.every` is 40.0",
        ),
        (
            "duration: 30.0",
            "duration: 30.0, courant: 2.0",
            "`simulation.courant` is 2.0",
        ),
        (
            "duration: 30.0",
            "duration: 30.0, growth: ()",
            "no wave whose perturbations",
        ),
        ("mode: 4, amplitude", "mode: 90, amplitude", "modes 0 to 24"),
        ("snapshots: 3", "snapshots: 30000", "at most 1000 snapshots"),
        (
            "    ),
    wave: (mode: 4, start: Fast),
    simulation: (
        body: Ring(points: 96),",
            "        damping: (stiffness: 0.1),
    ),
    wave: (mode: 4, start: Fast),
    simulation: (
        body: Annulus(around: 66, across: 4),",
            "stiffness",
        ),
        (
            "mismatch: 0.1,",
            "mismatch: 0.1, impact: Coulomb,",
            "not simulated",
        ),
        ("SteadySliding", "Wave(dir: \"none\", label: 1)", "none"),
    ] {
        assert_eq!(problem.matches(from).count(), 1, "{from}");
        let bench = Bench::new(&problem.replace(from, to));
        let text = bench.run(&["simulate", "p.ron"], 2);
        assert!(text.contains(words), "{to}: {text}");
        if !to.contains("none") {
            assert!(text.contains("p.ron:") && text.contains('^'), "{text}");
        }
    }
    let start = problem.find("    simulation:").expect("the section");
    let end = problem.rfind(')').expect("an end");
    let without = format!("{}{}", &problem[..start], &problem[end..]);
    let bench = Bench::new(&without);
    let text = bench.run(&["simulate", "p.ron"], 2);
    assert!(text.contains("missing field `simulation`"), "{text}");
}

/// With β > 0 the ring is simulated while it stays on the shaft.
#[test]
fn material_damping_demands_contact() {
    let problem = |mismatch: &str| {
        let damped = format!("mismatch: {mismatch}, damping: (stiffness: 0.001),");
        let text = SMALL
            .replace("BODY", RING)
            .replace("mismatch: 0.1,", &damped);
        Bench::new(&text.replace("duration: 30.0", "duration: 12.0"))
    };
    problem("0.4").run(&["simulate", "p.ron", "--quiet"], 0);
    let text = problem("0.01").run(&["simulate", "p.ron"], 3);
    assert!(text.contains("left the shaft"), "{text}");
}
