//! Certificates beside problem files that they are not of.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

fn brakewave(arguments: &[&str]) -> (Option<i32>, String) {
    let run = Command::new(env!("CARGO_BIN_EXE_brakewave"))
        .args(arguments)
        .output()
        .unwrap();
    (run.status.code(), format!("{run:?}"))
}

/// Certifies a problem; returns the folder of its certificate.
fn certified(text: &str, folder: &Path) -> PathBuf {
    let (file, out) = (folder.join("problem.ron"), folder.join("out"));
    fs::write(&file, text).unwrap();
    let [file, to] = [&file, &out].map(|path| path.to_str().unwrap());
    let (code, told) = brakewave(&["certify", file, "--out", to, "--force"]);
    assert_eq!(code, Some(0), "{told}");
    out
}

/// Exit code and words of a check of a certificate beside another problem.
fn beside(out: &Path, source: &str) -> (Option<i32>, String) {
    fs::write(out.join("source.ron"), source).unwrap();
    brakewave(&["certify", "--verify", out.to_str().unwrap()])
}

/// A problem in which texts are replaced by others.
fn edited(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replace(old, new)
    })
}

const CLOCK: &str = r#"(
    system: (
        states: ["t", "y", "z"], parameters: {"p": 1.0, "k": 0.05},
        modes: {"run": (rates: {"t": "1", "y": "z", "z": "2"},
            until: [(zero: "1 + p - t", to: "run", reset: {"t": "0", "y": "1.8 + k*p", "z": "-2.7"})])},
    ),
    orbit: (start: Given(mode: "run", state: {"t": 0.0, "y": 1.85, "z": -2.7}, period: 2.0)),
    continuation: (parameter: "p", range: (0.5, 1.0), toward: Down, stop_at: [0.75]),
    stability: (),
)"#;
const EQUILIBRIA: &str = r#"(
    system: (
        states: ["x"], parameters: {"p": 1.0, "k": 0.05},
        modes: {"run": (rates: {"x": "p - k*x"})},
    ),
    equilibrium: (start: Given(mode: "run", state: {"x": 20.0})),
    continuation: (parameter: "p", range: (0.5, 1.0), toward: Down, stop_at: [0.75]),
)"#;
const WAVES: &str = r#"(
    model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2),
    wave: (mode: 4, start: Fast),
    continuation: (parameter: Mismatch, range: (0.15, 0.2), toward: Down, stop_at: [0.17]),
)"#;

/// The numbers of a branch that goes on from an earlier run do not stand in its file, which is said; all else is compared.
#[test]
fn a_branch_goes_on_from_an_earlier_run() {
    let folder = TempDir::new().unwrap();
    let label = "Restart(dir: \"earlier\", label: 1)";
    let given = "Given(mode: \"run\", state: {\"t\": 0.0, \"y\": 1.85, \"z\": -2.7}, period: 2.0)";
    let rests = "Given(mode: \"run\", state: {\"x\": 20.0})";
    let cases = [
        (
            CLOCK,
            given,
            [
                ("\"-2.7\"", "\"-2.6\""),
                ("parameter: \"p\"", "parameter: \"k\""),
            ],
        ),
        (
            EQUILIBRIA,
            rests,
            [
                ("p - k*x", "p - 2*k*x"),
                ("parameter: \"p\"", "parameter: \"k\""),
            ],
        ),
        (
            WAVES,
            "Fast",
            [
                ("mode: 4", "mode: 5"),
                ("parameter: Mismatch", "parameter: Friction"),
            ],
        ),
    ];
    for (text, start, others) in cases {
        let out = certified(text, folder.path());
        let restart = edited(text, &[(start, label)]);
        // what is not written there may be anything
        let numbers = restart.replace("\"k\": 0.05", "\"k\": 0.07");
        let (code, told) = beside(&out, &numbers.replace("friction: 0.5", "friction: 0.4"));
        assert_eq!(code, Some(0), "{told}");
        assert!(told.contains("numbers: not compared"), "{told}");
        assert!(told.contains(": verified"), "{told}");
        assert!(!told.contains("refused"), "{told}");
        let values = [
            ("0.75", "0.76"),
            ("0.17", "0.18"),
            ("(0.5,", "(0.6,"),
            ("(0.15,", "(0.16,"),
        ];
        let values = values.iter().filter(|(old, _)| restart.contains(old));
        for edit in values.chain(&others) {
            let (code, told) = beside(&out, &edited(&restart, &[*edit]));
            assert_eq!(code, Some(1), "{edit:?}: {told}");
            assert!(told.contains("is not that of the problem file"), "{told}");
        }
    }
}

/// The number of the parameter that varies is in no equation; it is that of the file none the less.
#[test]
fn the_number_of_the_parameter_that_varies_is_that_of_the_file() {
    let folder = TempDir::new().unwrap();
    for (text, number, others) in [
        (CLOCK, "\"p\": 1.0", ["\"p\": 0.9", "\"p\": 0.8"]),
        (EQUILIBRIA, "\"p\": 1.0", ["\"p\": 0.9", "\"p\": 0.8"]),
        (WAVES, "mismatch: 0.2", ["mismatch: 0.19", "mismatch: 0.18"]),
    ] {
        let out = certified(text, folder.path());
        for other in others {
            let (code, told) = beside(&out, &edited(text, &[(number, other)]));
            assert_eq!(code, Some(1), "{other}: {told}");
            assert!(told.contains("is not that of the problem file"), "{told}");
        }
    }
}

/// Where a period is prescribed and a parameter free for it, an orbit with the number that is written is none of the branch.
#[test]
fn a_prescribed_period_frees_a_parameter() {
    let folder = TempDir::new().unwrap();
    let out = certified(CLOCK, folder.path());
    let source = CLOCK.replace("orbit: (", "orbit: (period: \"1.9\", free: \"k\", ");
    let (code, told) = beside(&out, &source);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("the period is not that"), "{told}");
}

/// A problem of which nothing is followed, or something else, has no such points.
#[test]
fn what_is_not_followed_has_no_points() {
    let folder = TempDir::new().unwrap();
    let without = |text: &str| {
        let lines = text.lines().filter(|line| !line.contains("continuation:"));
        lines.collect::<Vec<_>>().join("\n")
    };
    for (text, others) in [
        (
            CLOCK,
            [EQUILIBRIA.to_owned(), WAVES.to_owned(), without(CLOCK)],
        ),
        (
            EQUILIBRIA,
            [CLOCK.to_owned(), WAVES.to_owned(), without(EQUILIBRIA)],
        ),
        (
            WAVES,
            [CLOCK.to_owned(), EQUILIBRIA.to_owned(), without(WAVES)],
        ),
    ] {
        let out = certified(text, folder.path());
        for other in others {
            let (code, told) = beside(&out, &other);
            assert_eq!(code, Some(1), "{other}: {told}");
            assert!(
                told.contains("it is not that of the problem file"),
                "{told}"
            );
        }
    }
}

/// Words and cells that no one would read as those of the certificate are not taken for them.
#[test]
fn what_stands_beside_it_says_the_same() {
    let folder = TempDir::new().unwrap();
    let out = certified(CLOCK, folder.path());
    let told = || brakewave(&["certify", "--verify", out.to_str().unwrap()]);
    let (code, words) = told();
    assert_eq!(code, Some(0), "{words}");
    type Edit = fn(&str) -> String;
    let edits: [(&str, &str, Edit); 6] = [
        ("theorem.md", "theorem.md: refused", |text| {
            text.replace("inside the unit circle", "at rest")
        }),
        ("theorem.md", "theorem.md: refused", |text| {
            format!("{text}It is stable for all p.\n")
        }),
        ("certificates.csv", "certificates.csv: refused", |text| {
            format!("{text}99,UZ,p,0.1,0.2,1.0,2.0,0.001,2,yes,,0,,,,")
        }),
        ("certificates.csv", "certificates.csv: refused", |text| {
            text.replace(",,,,\n", ",,,,,stable\n")
        }),
        ("certificate.ron", "its labels do not ascend", |text| {
            text.replacen("label: 1,", "label: 99,", 1)
        }),
        ("certificate.ron", "its labels do not ascend", |text| {
            text.replacen("label: 2,", "label: 1,", 1)
        }),
    ];
    for (name, reason, edit) in edits {
        let file = out.join(name);
        let honest = fs::read_to_string(&file).unwrap();
        assert_ne!(edit(&honest), honest, "{name}: {reason}");
        fs::write(&file, edit(&honest)).unwrap();
        let (code, words) = told();
        assert_eq!(code, Some(1), "{name}: {words}");
        assert!(words.contains(reason), "{name}: {words}");
        fs::write(&file, honest).unwrap();
    }
    // another version may have other words, which are not known here: they may say anything, and are not taken for verified
    let file = out.join("certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    let version = format!("version: \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(honest.contains(&version), "{honest}");
    fs::write(&file, honest.replace(&version, "version: \"0.1.0\"")).unwrap();
    let (code, words) = told();
    assert_eq!(
        code,
        Some(0),
        "words of another version that are the same: {words}"
    );
    fs::write(out.join("theorem.md"), "# Otherwise\n").unwrap();
    let (code, words) = told();
    assert_eq!(code, Some(1), "{words}");
    assert!(words.contains("theorem.md: not compared"), "{words}");
    fs::remove_file(out.join("theorem.md")).unwrap();
    let (code, words) = told();
    assert_eq!(code, Some(0), "{words}");
}

/// What cannot be compared because a file is not there is said, and a certificate alone is not wholly verified.
#[test]
fn what_is_not_there_is_not_compared() {
    let folder = TempDir::new().unwrap();
    for text in [CLOCK, EQUILIBRIA, WAVES] {
        let out = certified(text, folder.path());
        let file = out.join("certificate.ron");
        for path in [&out, &file] {
            let (code, words) = brakewave(&["certify", "--verify", path.to_str().unwrap()]);
            assert_eq!(code, Some(0), "{words}");
            assert!(!words.contains("not compared"), "{words}");
        }
        let mut removed = Vec::new();
        for name in ["certificates.csv", "source.ron"] {
            fs::remove_file(out.join(name)).unwrap();
            removed.push(name);
            let (code, words) = brakewave(&["certify", "--verify", out.to_str().unwrap()]);
            assert_eq!(code, Some(1), "{words}");
            assert!(words.contains(": verified"), "{words}");
            assert!(!words.contains("refused"), "{words}");
            for name in &removed {
                assert!(words.contains(&format!("{name}: not compared")), "{words}");
            }
            assert_eq!(words.matches("not compared").count(), removed.len());
        }
    }
}

/// Without the orbit or the equilibrium that the branch begins with nothing tells the units of `unique`, and this is said.
#[test]
fn units_without_their_orbit() {
    let folder = TempDir::new().unwrap();
    for text in [CLOCK, EQUILIBRIA] {
        let out = certified(text, folder.path());
        for name in ["certificates.csv", "theorem.md"] {
            fs::remove_file(out.join(name)).unwrap();
        }
        let file = out.join("certificate.ron");
        let honest = fs::read_to_string(&file).unwrap();
        let points = honest.match_indices("        (\n            label: ");
        let points: Vec<usize> = points.map(|(place, _)| place).collect();
        let dropped = format!("{}{}", &honest[..points[0]], &honest[points[1]..]);
        fs::write(&file, dropped).unwrap();
        let (code, words) = brakewave(&["certify", "--verify", out.to_str().unwrap()]);
        assert_eq!(code, Some(1), "{words}");
        assert!(words.contains("units: not compared"), "{words}");
        assert!(words.contains(": verified"), "{words}");
    }
}

/// Eigenvalues are counted up to the frequency that the problem names, or that follows from its model.
#[test]
fn eigenvalues_are_counted_in_the_window_of_the_problem() {
    let folder = TempDir::new().unwrap();
    let text = edited(
        WAVES,
        &[("mismatch: 0.2)", "mismatch: 0.2, damping: (mass: 0.28))")],
    );
    for stability in ["", "stability: (max_frequency: 2.0),\n)"] {
        let text = match stability {
            "" => text.clone(),
            _ => format!("{}{stability}", text.trim_end().strip_suffix(')').unwrap()),
        };
        let (file, out) = (folder.path().join("problem.ron"), folder.path().join("out"));
        fs::write(&file, &text).unwrap();
        let [file, to] = [&file, &out].map(|path| path.to_str().unwrap());
        let (code, told) = brakewave(&["certify", file, "--spectrum", "--out", to, "--force"]);
        assert_eq!(code, Some(0), "{told}");
        let (code, told) = brakewave(&["certify", "--verify", to]);
        assert_eq!(code, Some(0), "{told}");
        let narrow = match stability {
            "" => format!(
                "{}stability: (max_frequency: 11.9),\n)",
                text.trim_end().strip_suffix(')').unwrap()
            ),
            _ => edited(&text, &[("max_frequency: 2.0", "max_frequency: 2.5")]),
        };
        let (code, told) = beside(&out, &narrow);
        assert_eq!(code, Some(1), "{told}");
        assert!(
            told.contains("the window of its eigenvalues is not that"),
            "{told}"
        );
    }
}
