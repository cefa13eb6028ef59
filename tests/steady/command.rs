//! `brakewave steady` on the command line.

use std::path::Path;
use std::process::{Command, Output};

fn steady(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brakewave"))
        .arg("steady")
        .args(arguments)
        .output()
        .unwrap()
}

fn problem(name: &str) -> String {
    format!("{}/problems/{name}.ron", env!("CARGO_MANIFEST_DIR"))
}

/// The table by column.
fn table(output: &Output) -> (Vec<String>, Vec<Vec<String>>) {
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let rows = reader
        .records()
        .map(|row| row.unwrap().iter().map(str::to_owned).collect())
        .collect();
    (header, rows)
}

#[test]
fn a_row_for_every_mode_with_numbers_that_survive_reading() {
    let arguments = ["--modes", "3..5", "--at", "stiffness_damping=1e-4"];
    let file = problem("mode4_damping");
    let (header, rows) = table(&steady(&[&[file.as_str()], &arguments[..]].concat()));
    let column = |row: usize, name: &str| {
        let index = header.iter().position(|known| known == name).unwrap();
        rows[row][index].clone()
    };
    assert_eq!(rows.len(), 3);
    for (row, mode) in ["3", "4", "5"].iter().enumerate() {
        assert_eq!(column(row, "mode"), *mode);
        assert_eq!(column(row, "direction"), "against");
        let omega: f64 = column(row, "omega").parse().unwrap();
        let speed: f64 = column(row, "speed").parse().unwrap();
        let mode: f64 = mode.parse().unwrap();
        assert!((omega + mode * speed).abs() < 1e-15 * omega.abs() * 4.0);
        assert!(column(row, "radial_error").parse::<f64>().unwrap() < 1e-10);
    }
    let marks = |name: &str| (0..3).filter(|row| column(*row, name) == "yes").count();
    assert_eq!((marks("first"), marks("lead_first")), (1, 1));
}

/// Where only coefficients are given there is no tube to solve for.
#[test]
fn given_coefficients_have_the_reduced_model_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("given.ron");
    std::fs::write(
        &path,
        "(model: (coefficients: Given(a: 1.1, b: 0.3, D: -0.8, g: 18.0, h: 8.5), \
         friction: 0.5, mismatch: 0.2), wave: (mode: 4, start: Fast))",
    )
    .unwrap();
    let (header, rows) = table(&steady(&[path.to_str().unwrap()]));
    assert_eq!(rows.len(), 12);
    let first_full = header
        .iter()
        .position(|name| name == "full_growth")
        .unwrap();
    for row in rows {
        assert!(row[..first_full - 1].iter().all(|field| !field.is_empty()));
        assert!(row[first_full..].iter().all(String::is_empty));
    }
}

#[test]
fn pictures_are_written_and_bad_usage_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = problem("mode4_mismatch");
    let picture = folder.path().join("growth.svg");
    let output = steady(&[
        &file,
        "--modes",
        "1..6",
        "--plot",
        picture.to_str().unwrap(),
    ]);
    assert!(output.status.success());
    let text = std::fs::read_to_string(&picture).unwrap();
    assert!(text.starts_with("<svg") && text.contains("reduced model"));
    for arguments in [
        ["--plot", "growth.gif"],
        ["--modes", "0..3"],
        ["--modes", "5..3"],
        ["--modes", "1..9999999"],
        ["--modes", "many"],
        ["--families", "0"],
        ["--order", "1"],
        ["--at", "friction=-1"],
        ["--at", "speed=1"],
    ] {
        let output = steady(&[&file, arguments[0], arguments[1]]);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!Path::new("growth.gif").exists());
    }
}

/// The friction law of the file is honoured.
#[test]
fn the_friction_law_counts() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |law: &str| {
        let path = folder.path().join("law.ron");
        std::fs::write(
            &path,
            format!(
                "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
                 mismatch: 0.2, friction_law: {law}), wave: (mode: 4, start: Fast))"
            ),
        )
        .unwrap();
        table(&steady(&[path.to_str().unwrap(), "--modes", "3..4"])).1
    };
    let coulomb = rows("Coulomb");
    assert_eq!(coulomb, rows("Static(ratio: 1.5)"));
    for law in [
        "Stribeck(ratio: 1.5, velocity: 0.5)",
        "Regularised(epsilon: 0.5)",
    ] {
        for (one, other) in coulomb.iter().zip(rows(law)) {
            // growth of the reduced model and of the tube
            assert!(one[1] != other[1] && one[8] != other[8], "{law}");
        }
    }
}

/// Friction without bound gives an answer, not an endless iteration.
#[test]
fn huge_friction_is_answered() {
    let file = problem("mode4_mismatch");
    let (_, rows) = table(&steady(&[
        &file,
        "--modes",
        "1..3",
        "--at",
        "friction=1e16",
    ]));
    assert_eq!(rows.len(), 3);
}
