//! `brakewave curve` on the command line.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use tempfile::TempDir;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brakewave"))
        .arg("curve")
        .args(arguments)
        .output()
        .unwrap()
}

fn problem(name: &str) -> String {
    format!("{}/problems/{name}.ron", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn table_and_picture_of_a_curve() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("curve");
    let text = out.to_str().unwrap();
    let file = problem("mode4_curve");
    let first = run(&[&file, "--out", text]);
    assert!(first.status.success(), "{first:?}");
    let table = fs::read(out.join("curve.csv")).unwrap();
    let picture = fs::read_to_string(out.join("curve.svg")).unwrap();
    assert!(picture.contains("<svg") && picture.contains("sl-sep-"));
    let mut reader = csv::Reader::from_reader(table.as_slice());
    let header: Vec<String> = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    assert_eq!(
        header[..5],
        ["point", "type", "mismatch", "friction", "speed"]
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert!(rows.len() > 50);
    let residual = header.iter().position(|name| name == "residual").unwrap();
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row[0], (index + 1).to_string());
        assert!(row[residual].parse::<f64>().unwrap() < 1e-11);
    }
    // both ends say why
    let what = header.iter().position(|name| name == "what").unwrap();
    for row in [&rows[0], &rows[rows.len() - 1]] {
        assert!(!row[what].is_empty());
    }
    // an earlier curve is kept unless told otherwise; the same bytes come again
    let refused = run(&[&file, "--out", text]);
    assert_eq!(refused.status.code(), Some(2));
    let again = run(&[&file, "--out", text, "--force", "--quiet"]);
    assert!(again.status.success() && again.stdout.is_empty());
    assert_eq!(fs::read(out.join("curve.csv")).unwrap(), table);
    assert_eq!(fs::read_to_string(out.join("curve.svg")).unwrap(), picture);
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let none = run(&[&problem("mode4_friction")]);
    assert_eq!(none.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&none.stderr).contains("missing field `curve`"));
    let folder = TempDir::new().unwrap();
    let text = fs::read_to_string(problem("mode4_curve")).unwrap();
    for (from, to, said) in [
        ("event: GR", "event: UZ", "unknown choice `UZ`"),
        (
            "event: GR",
            "event: Label(dir: \"nowhere\", label: 3)",
            "nowhere",
        ),
        (
            "event: GR",
            "event: Label(dir: \"nowhere\", label: 3), index: 2",
            "beside a label",
        ),
        ("event: GR", "event: GR, sector: 1", "has none"),
        ("event: GR", "event: GR, index: 0", "`curve.index` is 0"),
        (
            "(Mismatch, Friction)",
            "(Friction, Friction)",
            "must be different",
        ),
        (
            "(Mismatch, Friction)",
            "(Mismatch, Smoothing)",
            "`smoothing` is unknown",
        ),
        ("event: GR", "event: GR, ds_max: 0.001", "`ds_max` is 0.001"),
    ] {
        assert!(text.contains(from));
        let file = folder.path().join("p.ron");
        // the last one: comments and `expect` may hold the word too
        let at = text.find("curve: (").unwrap();
        let (head, tail) = text.split_at(at);
        fs::write(&file, format!("{head}{}", tail.replacen(from, to, 1))).unwrap();
        let output = run(&[file.to_str().unwrap(), "--out", "nowhere"]);
        assert_eq!(output.status.code(), Some(2), "{to}");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains(said), "{to}: {error}");
    }
}

/// A label of a result folder begins the same curve as the event found anew, and only events do.
#[test]
fn a_label_begins_the_same_curve() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let text = fs::read_to_string(problem("mode4_curve")).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_brakewave"))
        .args([
            "run",
            &problem("mode4_curve"),
            "--out",
            &path("run"),
            "--quiet",
        ])
        .output()
        .unwrap();
    assert!(done.status.success());
    let events = fs::read_to_string(folder.path().join("run/events.csv")).unwrap();
    let label = |kind: &str| {
        let row = events
            .lines()
            .find(|row| row.contains(&format!(",{kind},")));
        row.unwrap().split(',').next().unwrap().to_owned()
    };
    let curve = |name: &str, event: &str| {
        let file = path(&format!("{name}.ron"));
        fs::write(&file, text.replacen("event: GR", event, 1)).unwrap();
        run(&[&file, "--out", &path(name)])
    };
    assert!(curve("anew", "event: GR").status.success());
    let labelled = format!(
        "event: Label(dir: {:?}, label: {})",
        path("run"),
        label("GR")
    );
    let output = curve("labelled", &labelled);
    assert!(output.status.success(), "{output:?}");
    let ends = |name: &str| -> Vec<Vec<f64>> {
        let table = fs::read(folder.path().join(name).join("curve.csv")).unwrap();
        let mut reader = csv::Reader::from_reader(table.as_slice());
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        [&rows[0], &rows[rows.len() - 1]]
            .map(|row| (2..5).map(|column| row[column].parse().unwrap()).collect())
            .to_vec()
    };
    for (one, other) in ends("anew").into_iter().zip(ends("labelled")) {
        for (one, other) in one.into_iter().zip(other) {
            // ends of the ranges, met to rounding
            assert!((one / other - 1.0).abs() < 1e-10, "{one} {other}");
        }
    }
    let start = format!("event: Label(dir: {:?}, label: 1)", path("run"));
    let refused = curve("start", &start);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("label 1 is of type EP"));
}

/// Every file of a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<OsString, Vec<u8>> {
    fs::read_dir(folder)
        .unwrap()
        .map(|entry| {
            let entry = entry.unwrap();
            (entry.file_name(), fs::read(entry.path()).unwrap())
        })
        .collect()
}

/// Rows are there as they are found; a curve killed anywhere ends in the same files, byte for byte.
#[test]
fn a_killed_curve_resumes_to_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    let text = fs::read_to_string(problem("mode4_curve")).unwrap();
    let file = path("p.ron");
    fs::write(
        &file,
        text.replace("parameters: (", "ds_max: 0.02, parameters: ("),
    )
    .unwrap();
    let file = file.to_str().unwrap();
    let run = |name: &str, more: &[&str]| {
        let out = path(name);
        let mut arguments = vec![file, "--out", out.to_str().unwrap(), "--quiet"];
        arguments.extend(more);
        run(&arguments)
    };
    assert!(run("whole", &[]).status.success());
    let whole = files(&path("whole"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_brakewave"))
        .args(["curve", file, "--quiet", "--out"])
        .arg(path("cut"))
        .spawn()
        .unwrap();
    let table = path("cut").join("curve.csv");
    let patience = Instant::now();
    while fs::metadata(&table).map_or(0, |data| data.len()) < 3_000
        && patience.elapsed() < Duration::from_secs(20)
    {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let rows = fs::read_to_string(&table).unwrap().lines().count();
    assert!(rows > 10, "{rows} rows were there when it was killed");
    assert!(run("cut", &["--resume"]).status.success());
    assert_eq!(files(&path("cut")), whole);

    // cut short within a line, after the first line, and in the first one
    let steps = path("cut").join("curve.steps");
    let all = fs::read(&steps).unwrap();
    let lines: Vec<usize> = (0..all.len()).filter(|at| all[*at] == b'\n').collect();
    for length in [lines[lines.len() / 2] + 40, lines[0] + 1, lines[0] / 2] {
        fs::write(&steps, &all[..length]).unwrap();
        fs::write(&table, "spoilt").unwrap();
        fs::remove_file(path("cut").join("curve.svg")).unwrap();
        assert!(run("cut", &["--resume"]).status.success());
        assert!(files(&path("cut")) == whole, "{length}");
    }
    // a finished one stays as it is
    assert!(run("cut", &["--resume"]).status.success());
    assert_eq!(files(&path("cut")), whole);

    // a changed figure is noticed, and the folder stays as it is
    let mut damaged = all.clone();
    let place = lines[3]
        + 60
        + damaged[lines[3] + 60..]
            .iter()
            .position(|byte| *byte == b'.')
            .unwrap();
    damaged[place + 1] = if damaged[place + 1] == b'1' {
        b'2'
    } else {
        b'1'
    };
    fs::write(&steps, &damaged).unwrap();
    let before = files(&path("cut"));
    let output = run("cut", &["--resume"]);
    assert_eq!(output.status.code(), Some(4));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    for words in ["curve.steps", "line 5", "checksum", "--force"] {
        assert!(error.contains(words), "{error}");
    }
    assert!(files(&path("cut")) == before);
    assert!(run("cut", &["--force"]).status.success());
    assert!(files(&path("cut")) == whole);
}

/// Reaching `max_points` is an end of its own, not that of the curve.
#[test]
fn too_few_points_are_said_to_be() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("p.ron");
    let text = fs::read_to_string(problem("mode4_curve")).unwrap();
    fs::write(
        &file,
        text.replace("parameters: (", "max_points: 5, parameters: ("),
    )
    .unwrap();
    let out = folder.path().join("few");
    let output = run(&[file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        error.contains("`max_points`, 5 in either direction, are reached"),
        "{error}"
    );
    let table = fs::read_to_string(out.join("curve.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), 11);
    for row in [rows[0], rows[10]] {
        assert!(row.contains(",MX,") && row.contains("max_points"), "{row}");
    }
}

/// Close to where a Hopf curve meets the opening of a separation zone, steps shrink to 1e-8. The curve
/// ends there, and says where it is, instead of taking all the points it may.
#[test]
fn a_curve_that_creeps_says_so() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("p.ron");
    fs::write(
        &file,
        "(
    model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2),
    wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (0.03, 0.2), toward: Down),
    stability: (sectors: All, eigenvalues: 4, max_frequency: 12.0),
    curve: (event: HB, index: 9, sector: 1, parameters: (Mismatch, Friction), range: ((0.01, 0.3), (0.1, 1.2))),
)",
    )
    .unwrap();
    let out = folder.path().join("out");
    let output = run(&[file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let table = fs::read_to_string(out.join("curve.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert!(rows.len() < 1000, "{} rows", rows.len());
    assert!(
        rows[0].contains(",MX,") && rows[0].contains("beside a separation zone"),
        "{}",
        rows[0]
    );
}
