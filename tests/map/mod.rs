//! Claims about maps: their cells are the waves of the branches, wherever and in whatever order they
//! were computed.

mod basins;
mod cells;
mod motions;
mod shards;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The tube of the reference figures, mode 4.
const MODEL: &str = "model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), \
    friction: 0.5, mismatch: 0.2), wave: (mode: 4, start: Fast),";

/// A problem with this `map` section and whatever else.
fn problem(sections: &str) -> String {
    format!("({MODEL} {sections})")
}

/// Runs the binary in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brakewave"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

#[track_caller]
fn succeed(folder: &Path, arguments: &[&str]) {
    let output = run(folder, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
}

/// All files below a folder with their bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.insert(path.clone(), std::fs::read(&path).unwrap());
        }
    }
    found
}
