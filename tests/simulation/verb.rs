//! `brakewave simulate`: its files, and that they do not depend on interruptions or threads.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
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

pub struct Bench(tempfile::TempDir);

impl Bench {
    pub fn new(problem: &str) -> Bench {
        let bench = Bench(tempfile::tempdir().expect("a temporary folder"));
        fs::write(bench.path("p.ron"), problem).expect("a file can be written");
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
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
    pub fn run(&self, arguments: &[&str], code: i32) -> String {
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
            "velocity.svg",
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
    let text = bench.run(&["simulate", "p.ron"], 2);
    assert!(
        text.contains("`brakewave run`") && !text.contains("os error"),
        "{text}"
    );
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
        .take(7)
        .map(|cell| cell.parse().expect("a number"))
        .collect();
    // sector, re, im, residual, scatter, grid, error
    assert!(
        (row[1] - 0.0497).abs() < 0.005 && (row[2] - 2.5416).abs() < 0.01,
        "{row:?}"
    );
}

/// The wave of the file itself moves as the one of a folder to the last bit, wherever the branch would go;
/// the wave beyond a Hopf point brings its damping, and one of no branch needs no section for one.
#[test]
fn a_simulation_computes_its_own_wave() {
    let small = SMALL.replace("BODY", "Ring(points: 192)");
    let small = small.replace("perturbation: (mode: 4, amplitude: 0.02),", "");
    let small = small.replace("duration: 30.0", "duration: 1.0");
    let branch = "continuation: (parameter: Mismatch, range: (0.09, 0.1), toward: Down),\n\
                  output: (profiles: 1),\n    simulation:";
    let of_branch = small.replace("simulation:", branch);
    let bench = Bench::new(&of_branch);
    let put = |name: &str, text: String| fs::write(bench.path(name), text).expect("a file");
    put("own.ron", of_branch.replace("SteadySliding", "Wave"));
    let folder = "Wave(dir: \"wave\", label: 1)";
    put("folder.ron", of_branch.replace("SteadySliding", folder));
    put("alone.ron", small.replace("SteadySliding", "Wave"));
    bench.run(&["simulate", "own.ron"], 0);
    bench.run(&["run", "p.ron", "--out", "wave", "--quiet"], 0);
    bench.run(&["simulate", "folder.ron"], 0);
    let said = bench.run(&["simulate", "alone.ron"], 0);
    assert!(!said.contains("warning"), "{said}");
    let read = |name: &str, table: &str| {
        let path = format!("results/{name}_simulation/{table}.csv");
        fs::read(bench.path(&path)).expect("a table")
    };
    for table in ["series", "start", "end"] {
        assert!(read("own", table) == read("folder", table), "{table}");
    }
    // posed in other units of the parameter the same wave differs by rounding
    let first = |name: &str| String::from_utf8(read(name, "start")).expect("text");
    let cells = |text: String| -> Vec<f64> {
        let cells = text.split([',', '\n']).filter_map(|cell| cell.parse().ok());
        cells.collect()
    };
    let (own, alone) = (cells(first("own")), cells(first("alone")));
    assert_eq!(own.len(), alone.len());
    assert!(own.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-10));
    let hopf = of_branch
        .replace("SteadySliding", "Wave")
        .replace("Fast", "Hopf");
    put(
        "hopf.ron",
        hopf.replace(
            "Mismatch, range: (0.09, 0.1)",
            "MassDamping, range: (0.2, 0.4)",
        ),
    );
    let said = bench.run(&["simulate", "hopf.ron"], 0);
    assert!(said.contains("mass damping 0.3189475"), "{said}");
    // what is wrong with it is told at its place
    put(
        "none.ron",
        small.replace("SteadySliding", "Wave").replace("0.5", "1.5"),
    );
    let said = bench.run(&["simulate", "none.ron"], 3);
    assert!(
        said.contains("none.ron:5") && said.contains("fold"),
        "{said}"
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

/// A ring pressed on lightly lifts off and lands again, with material damping as with either law of impact.
#[test]
fn rings_separate_with_damping_and_impacts() {
    for laws in ["impact: Coulomb", "damping: (stiffness: 0.001)"] {
        let text = SMALL
            .replace("BODY", RING)
            .replace("mismatch: 0.1,", &format!("mismatch: 0.01, {laws},"));
        let bench = Bench::new(&text);
        let text = bench.run(&["simulate", "p.ron", "--out", "out"], 0);
        assert!(text.contains("energy balance closes"), "{text}");
        let rows = series(&bench, "out");
        // the share of separation
        assert!(rows[0][3] == 0.0 && rows[rows.len() - 1][3] > 0.0);
    }
}

/// Rows of the time series of a simulation, as numbers.
fn series(bench: &Bench, folder: &str) -> Vec<Vec<f64>> {
    let path = bench.path(folder).join("series.csv");
    let text = fs::read_to_string(path).expect("a series");
    let number = |cell: &str| cell.parse().expect("a number");
    (text.lines().skip(1))
        .map(|row| row.split(',').map(number).collect())
        .collect()
}

/// Samples come every `every`, and the last one at the end of the duration, however long that is.
#[test]
fn a_simulation_ends_at_its_duration() {
    for body in [RING, ANNULUS] {
        for (duration, every, times) in [
            (1.0, 0.7, &[0.0, 0.7, 1.0][..]),
            (1.0, 0.4, &[0.0, 0.4, 0.8, 1.0]),
            (1.2, 0.4, &[0.0, 0.4, 0.8, 1.2]),
            (0.7001, 0.7, &[0.0, 0.7, 0.7001]),
        ] {
            let span = format!("duration: {duration:?}, every: {every:?}");
            let problem = SMALL.replace("BODY", body).replace("duration: 30.0", &span);
            let bench = Bench::new(&problem);
            let text = bench.run(&["simulate", "p.ron", "--out", "s"], 0);
            let found: Vec<f64> = series(&bench, "s").iter().map(|row| row[0]).collect();
            assert_eq!(found.len(), times.len(), "{span}: {found:?}");
            for (one, other) in found.iter().zip(times) {
                // a sum of steps, each rounded relative to the time
                assert!((one - other).abs() <= 1e-13, "{span}: {found:?}");
            }
            let uneven = times[times.len() - 1] - times[times.len() - 2] < 0.99 * every;
            assert!(!uneven || found.last() == Some(&duration), "{found:?}");
            assert_eq!(
                text.contains("the last sample is at the end"),
                uneven,
                "{text}"
            );
            let snapshots = files(&bench.path("s/snapshots"));
            assert_eq!(snapshots.len(), 3, "{:?}", snapshots.keys());
        }
    }
}

/// Where all slips energy is balanced to rounding while the step is the same. Where it changes from Δ to
/// Δ′ the balance is left by ¼(Δ − Δ′)F·(V̇′ − V̇), of second order: two halvings are a factor of 16, of
/// first order they would be one of 4.
#[test]
fn a_shorter_last_interval_is_of_second_order() {
    for body in [RING, ANNULUS] {
        let left = [0.4, 0.1].map(|courant| {
            let span = format!("duration: 0.803, every: 0.4, courant: {courant}");
            let problem = SMALL.replace("BODY", body).replace("duration: 30.0", &span);
            let bench = Bench::new(&problem);
            bench.run(&["simulate", "p.ron", "--out", "s", "--quiet"], 0);
            let rows = series(&bench, "s");
            let [.., before, last] = &rows[..] else {
                panic!("{rows:?}")
            };
            assert!(before[4] == 1.0 && last[4] == 1.0, "all slips");
            assert!(before[2].abs() < 1e-11 * before[1].abs(), "{before:?}");
            last[2].abs()
        });
        assert!(left[1] > 0.0 && left[0] > 10.0 * left[1], "{left:?}");
    }
}

/// What no machine ends is refused before anything is written, and any number of threads is taken.
#[test]
fn absurd_sizes_are_refused_and_threads_are_not() {
    for absurd in [
        "Ring(points: 1000000)\n, courant: 1e-9",
        "Ring(points: 96)\n, courant: 1e-300",
        "Annulus(around: 1000, across: 1000)\n, courant: 1e-9",
    ] {
        let (body, courant) = absurd.split_once('\n').expect("two parts");
        let more = format!("duration: 30.0{courant}");
        let problem = SMALL.replace("BODY", body).replace("duration: 30.0", &more);
        let bench = Bench::new(&problem);
        let text = bench.run(&["simulate", "p.ron", "--out", "s"], 2);
        assert!(text.contains("at most 1e15 are admitted"), "{text}");
        assert!(!bench.path("s").exists());
    }
    let brief = SMALL.replace("BODY", RING).replace("30.0", "2.0");
    let bench = Bench::new(&brief);
    let run = |threads: &str| {
        bench.run(
            &["simulate", "p.ron", "--out", threads, "--threads", threads],
            0,
        );
    };
    run("1");
    run("65535");
    same(&bench.path("1"), &bench.path("65535"));
}

/// A long simulation says how long it takes, also off a terminal.
#[test]
fn a_long_simulation_says_so() {
    let problem = SMALL
        .replace("BODY", "Ring(points: 4096)")
        .replace("30.0", "30000.0");
    let bench = Bench::new(&problem);
    let mut child = bench
        .command(&["simulate", "p.ron", "--threads", "1"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let mut line = String::new();
    let error = child.stderr.take().expect("standard error");
    BufReader::new(error).read_line(&mut line).expect("a line");
    child.kill().expect("it can be killed");
    child.wait().expect("it ends");
    assert!(line.starts_with("0 %: step "), "{line}");
    assert!(
        line.contains(" of ") && line.trim_end().ends_with("left"),
        "{line}"
    );
}

/// A finished simulation of half a second of computation, and its folder.
fn finished(body: &str) -> (Bench, PathBuf) {
    let problem = SMALL.replace("BODY", body).replace("30.0", "3.0");
    let bench = Bench::new(&problem);
    bench.run(&["simulate", "p.ron", "--out", "s", "--quiet"], 0);
    let folder = bench.path("s");
    (bench, folder)
}

/// `--resume` and `--force` touch what the simulation wrote and nothing else.
#[test]
fn what_the_simulation_did_not_write_stays() {
    let (bench, folder) = finished(RING);
    fs::write(folder.join("notes.txt"), "mine").expect("a file");
    let whole = files(&folder);
    for how in ["--resume", "--force"] {
        bench.run(&["simulate", "p.ron", "--out", "s", "--quiet", how], 0);
        assert!(files(&folder) == whole, "{how}");
    }
    // finished, but its checkpoint is gone: nothing is begun anew over it
    fs::remove_file(folder.join("checkpoint.ron")).expect("it is there");
    let left = files(&folder);
    let text = bench.run(&["simulate", "p.ron", "--out", "s", "--resume"], 4);
    assert!(
        text.contains("checkpoint.ron") && text.contains("--force"),
        "{text}"
    );
    assert!(files(&folder) == left);
    // somebody's pictures, by names that a simulation would use
    fs::create_dir(bench.path("mine")).expect("a folder");
    for name in ["space_time.svg", "series.csv", "diagram.svg"] {
        fs::write(bench.path("mine").join(name), name).expect("a file");
    }
    let mine = files(&bench.path("mine"));
    for how in ["--resume", "--force"] {
        bench.run(&["simulate", "p.ron", "--out", "mine", how], 2);
        assert!(files(&bench.path("mine")) == mine, "{how}");
    }
    // where there is no folder to be
    let text = bench.run(&["simulate", "p.ron", "--out", "p.ron/below"], 4);
    assert!(text.contains("p.ron"), "{text}");
}

/// A damaged checkpoint is told from a good one, whatever is wrong with it, and nothing is lost by that.
#[test]
fn a_damaged_checkpoint_is_refused() {
    for (body, other) in [(RING, "Annulus"), (ANNULUS, "Ring")] {
        let (bench, folder) = finished(body);
        let path = folder.join("checkpoint.ron");
        let good = fs::read_to_string(&path).expect("a checkpoint");
        let list = |name: &str| {
            let from = good.find(&format!("{name}:[")).expect(name) + name.len() + 2;
            (from, from + good[from..].find(']').expect("its end"))
        };
        let with = |(from, to): (usize, usize), text: &str| {
            format!("{}{text}{}", &good[..from], &good[to..])
        };
        let number = |name: &str, text: &str| {
            // the problem before it has some of these names, too
            let from = good.rfind(&format!("{name}:")).expect(name) + name.len() + 1;
            with(
                (from, from + good[from..].find(',').expect("its end")),
                text,
            )
        };
        let mut damaged = vec![
            String::new(),
            good[..good.len() / 2].to_owned(),
            number("samples", "0"),
            number("samples", "7"),
            number("samples", "18446744073709551615"),
            number("steps", "1"),
            number("steps", "18446744073709551615"),
            number("snapshots", "900"),
            good.replacen("state:", &format!("state:{other}"), 1),
        ];
        for name in [
            "radial",
            "tangential_rate",
            if body == RING { "share" } else { "shear" },
        ] {
            let (from, to) = list(name);
            let first = from + good[from..].find(',').expect("more than one");
            damaged.push(with((from, to), ""));
            damaged.push(with((from, first + 1), ""));
            damaged.push(with((from, first), "NaN"));
        }
        let state = good.find("state:").expect("a state");
        damaged.push(format!("{}state:{other}(()))", &good[..state]));
        for text in damaged {
            fs::write(&path, &text).expect("a file");
            let before = files(&folder);
            let said = bench.run(&["simulate", "p.ron", "--out", "s", "--resume"], 4);
            for words in ["checkpoint.ron", "damaged", "--force"] {
                assert!(said.contains(words), "{said}");
            }
            assert!(files(&folder) == before);
        }
        // the tables that belong to it
        fs::write(&path, &good).expect("a file");
        for (name, length) in [("series.csv", 700), ("regimes.npy", 200)] {
            let whole = fs::read(folder.join(name)).expect("a file");
            fs::write(folder.join(name), &whole[..length]).expect("a file");
            let said = bench.run(&["simulate", "p.ron", "--out", "s", "--resume"], 4);
            assert!(said.contains(name), "{said}");
            fs::write(folder.join(name), &whole).expect("a file");
        }
        // another version
        let manifest = folder.join("brakewave.manifest");
        let text = fs::read_to_string(&manifest).expect("a manifest");
        let (_, rest) = text.split_once('\n').expect("lines");
        fs::write(&manifest, format!("brakewave 0.0.1\n{rest}")).expect("a file");
        let said = bench.run(&["simulate", "p.ron", "--out", "s", "--resume"], 2);
        assert!(said.contains("version 0.0.1"), "{said}");
    }
}

/// Of a simulation that was killed the pictures show what is there.
#[test]
fn a_killed_simulation_is_drawn() {
    for body in [RING, ANNULUS] {
        let (bench, folder) = finished(body);
        let pictures = [
            "space_time.svg",
            "velocity.svg",
            "phase_plane.svg",
            "profiles.svg",
        ];
        for name in ["end.csv", "measures.csv"].iter().chain(&pictures) {
            fs::remove_file(folder.join(name)).expect(name);
        }
        let cut = |name: &str, length: usize| {
            let whole = fs::read(folder.join(name)).expect(name);
            fs::write(folder.join(name), &whole[..length]).expect(name);
        };
        for (series, regimes) in [(2000, 1200), (1500, 700), (320, 90)] {
            cut("series.csv", series);
            cut("regimes.npy", regimes);
            bench.run(&["plot", "s"], 0);
            for name in pictures {
                let text = fs::read_to_string(folder.join(name)).expect(name);
                assert!(text.contains("<svg"), "{name}");
            }
        }
        let text = fs::read_to_string(folder.join("profiles.svg")).expect("a picture");
        assert!(text.contains("at the beginning") && !text.contains("at the end"));
        if body == RING {
            bench.run(
                &["simulate", "p.ron", "--out", "s", "--force", "--quiet"],
                0,
            );
            let text = fs::read_to_string(folder.join("profiles.svg")).expect("a picture");
            assert!(text.contains("at the end"));
        }
    }
}
