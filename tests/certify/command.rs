//! `brakewave certify` on the command line.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

fn brakewave(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brakewave"))
        .args(arguments)
        .output()
        .unwrap()
}

fn problem(name: &str) -> String {
    format!("{}/problems/{name}.ron", env!("CARGO_MANIFEST_DIR"))
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_certificate_is_written_and_verified() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("certified");
    let out = out.to_str().unwrap();
    let first = brakewave(&["certify", &problem("mode4_mismatch"), "--out", out]);
    assert_eq!(first.status.code(), Some(0), "{first:?}");
    let lines = text(&first);
    assert!(
        lines.contains("GR: proven; δ in [0.050228410362755"),
        "{lines}"
    );
    assert!(lines.contains("unique within") && lines.contains("13 inequalities proven"));
    let table = fs::read_to_string(Path::new(out).join("certificates.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let header = "label,type,parameter,low,high,speed_low,speed_high,unique,inequalities,proven,why,unstable,arc,arc_why,growing,stable,stable_why";
    assert_eq!(
        reader
            .headers()
            .unwrap()
            .iter()
            .collect::<Vec<_>>()
            .join(","),
        header
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 12);
    for row in &rows {
        let [low, high]: [f64; 2] = [3, 4].map(|index: usize| row[index].parse().unwrap());
        assert!(low < high && high - low < 1e-13);
        assert_eq!(&row[9], "yes");
    }
    for path in [out.to_owned(), format!("{out}/certificate.ron")] {
        let verified = brakewave(&["certify", "--verify", &path]);
        assert_eq!(verified.status.code(), Some(0), "{verified:?}");
        assert_eq!(text(&verified).matches("verified").count(), 12);
    }
    // a type that is another's
    let file = Path::new(out).join("certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    for (old, new) in [
        ("kind: GR", "kind: CO"),
        ("regime: Separation", "regime: Slip"),
        ("friction: \"0.5\"", "friction: \"0.6\""),
    ] {
        assert!(honest.contains(old), "{old}");
        fs::write(&file, honest.replace(old, new)).unwrap();
        let refused = brakewave(&["certify", "--verify", out]);
        assert_eq!(refused.status.code(), Some(1), "{old}: {refused:?}");
        assert!(text(&refused).contains("refused"));
    }
    fs::write(&file, &honest).unwrap();
    // another decimal of the same double, another type of the same value, another table
    for (name, old, new, reason) in [
        (
            "certificate.ron",
            "friction: \"0.5\"",
            "friction: \"0.50000000000000001\"",
            "problem file",
        ),
        ("certificate.ron", "kind: EP", "kind: UZ", "problem file"),
        (
            "certificates.csv",
            "label,",
            "label,best,",
            "certificates.csv: refused",
        ),
        (
            "certificates.csv",
            ",yes,,",
            ",yes,stable,",
            "certificates.csv: refused",
        ),
    ] {
        let file = Path::new(out).join(name);
        let honest = fs::read_to_string(&file).unwrap();
        assert!(honest.contains(old), "{old}");
        fs::write(&file, honest.replacen(old, new, 1)).unwrap();
        let refused = brakewave(&["certify", "--verify", out]);
        assert_eq!(refused.status.code(), Some(1), "{old}: {refused:?}");
        assert!(text(&refused).contains(reason), "{refused:?}");
        fs::write(&file, &honest).unwrap();
    }
    let head = honest.split("points: [").next().unwrap();
    fs::write(&file, format!("{head}points: [])")).unwrap();
    let empty = brakewave(&["certify", "--verify", out]);
    assert_eq!(empty.status.code(), Some(1), "{empty:?}");
    assert!(text(&empty).contains("nothing is stated"));
    fs::write(&file, "(points: )").unwrap();
    assert_eq!(
        brakewave(&["certify", "--verify", out]).status.code(),
        Some(4)
    );
}

#[test]
fn what_is_not_proven_is_named_and_fails() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("certified");
    let out = out.to_str().unwrap();
    let found = brakewave(&["certify", &problem("mode4_stribeck"), "--out", out]);
    assert_eq!(found.status.code(), Some(1), "{found:?}");
    assert!(text(&found).contains("not proven; not covered"));
    let table = fs::read_to_string(Path::new(out).join("certificates.csv")).unwrap();
    assert!(table.contains(",no,not covered"));
    assert_eq!(
        brakewave(&["certify", "--verify", out]).status.code(),
        Some(1)
    );
}

#[test]
fn check_proves_where_a_file_asks_for_it() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("certified.ron");
    let plain = fs::read_to_string(problem("mode4_curve")).unwrap();
    let asked = |text: &str| {
        let end = text.rfind(')').unwrap();
        format!("{}    certify: true,\n)\n", &text[..end])
    };
    fs::write(&file, asked(&plain)).unwrap();
    let checked = brakewave(&["check", file.to_str().unwrap()]);
    assert_eq!(checked.status.code(), Some(0), "{checked:?}");
    assert_eq!(text(&checked).matches(": proven;").count(), 4);
    let smooth = plain.replace(
        "friction: 0.5,",
        "friction: 0.5, friction_law: Stribeck(ratio: 1.01, velocity: 0.5),",
    );
    let smooth = smooth.replace("tolerance: 1e-11", "tolerance: 0.1");
    fs::write(&file, asked(&smooth)).unwrap();
    let checked = brakewave(&["check", file.to_str().unwrap()]);
    assert_eq!(checked.status.code(), Some(1), "{checked:?}");
    assert!(text(&checked).contains("FAIL EP: not proven"));
}

/// Arcs between the points of a branch are in the certificate, and are proven again.
#[test]
fn arcs_are_proven_and_verified() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("friction.ron");
    let plain = fs::read_to_string(problem("mode4_friction")).unwrap();
    let text_of = |text: &str| {
        let shorter = text.replace("range: (0.2, 3.0)", "range: (0.2, 0.4)");
        let shorter = shorter.replace("stop_at: [0.3, 0.5, 0.8]", "stop_at: [0.3]");
        let expectations = shorter.find("    expect:").unwrap();
        format!("{})\n", &shorter[..expectations])
    };
    fs::write(&file, text_of(&plain)).unwrap();
    let out = folder.path().join("certified");
    let out = out.to_str().unwrap();
    let found = brakewave(&["certify", file.to_str().unwrap(), "--arcs", "--out", out]);
    assert_eq!(found.status.code(), Some(0), "{found:?}");
    assert_eq!(
        text(&found)
            .matches("no other event but HB and BP before it: proven")
            .count(),
        2
    );
    let table = fs::read_to_string(Path::new(out).join("certificates.csv")).unwrap();
    assert_eq!(table.matches(",yes,,,yes,").count(), 2, "{table}");
    let verified = brakewave(&["certify", "--verify", out]);
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
    // an arc to the first point, from none
    let certificate = Path::new(out).join("certificate.ron");
    let honest = fs::read_to_string(&certificate).unwrap();
    assert_eq!(honest.matches("arc: Some(Proven)").count(), 2);
    let falsified = honest.replacen("outcome:", "arc: Some(Proven), outcome:", 1);
    fs::write(&certificate, falsified).unwrap();
    let refused = brakewave(&["certify", "--verify", out]);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    assert!(text(&refused).contains("refused: the arc"));
}

/// A wave that is stable and one that is not, at the ends of a branch without a `stability` section.
#[test]
fn growing_eigenvalues_are_counted_and_verified() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("certified");
    let out = out.to_str().unwrap();
    let found = brakewave(&[
        "certify",
        &problem("ring_damped_circle"),
        "--spectrum",
        "--out",
        out,
    ]);
    assert_eq!(found.status.code(), Some(0), "{found:?}");
    assert!(text(&found).contains("the wave is stable"));
    assert!(text(&found).contains("growing with |Im λ| up to 12: 2, in sectors from 0 on 0 1 0"));
    let table = fs::read_to_string(Path::new(out).join("certificates.csv")).unwrap();
    assert!(
        table.contains(",0,yes,\n") && table.contains(",2,no,\n"),
        "{table}"
    );
    let verified = brakewave(&["certify", "--verify", out]);
    assert_eq!(text(&verified).matches("verified").count(), 2);
    let certificate = Path::new(out).join("certificate.ron");
    let honest = fs::read_to_string(&certificate).unwrap();
    let falsified = honest.replace("verdict: Unstable", "verdict: HighFrequency");
    assert_ne!(falsified, honest);
    fs::write(&certificate, falsified).unwrap();
    let refused = brakewave(&["certify", "--verify", out]);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    assert!(text(&refused).contains("refused: what grows"));
}
