//! Running the binary and reading what it wrote.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tempfile::TempDir;

/// The problem files of the repository.
pub const PROBLEMS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems");

/// The file that lists what the program wrote in a folder.
pub const MANIFEST: &str = "brakewave.manifest";

/// A small problem: slip-stick all along, done in milliseconds.
pub const SMALL: &str = r#"(
    model: (
        coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
        friction: 0.5,
        mismatch: 0.2,
    ),
    wave: (mode: 4, start: Fast),
    continuation: (
        parameter: Mismatch,
        range: (0.19, 0.2),
        toward: Down,
        ds_min: 1e-9,
        ds_max: 0.02,
        stop_at: [0.195],
    ),
    output: (plots: [Diagram], profiles: 2),
    expect: [
        (event: UZ, mismatch: 0.195, speed: -1.242700800630082, tolerance: 1e-9),
    ],
)
"#;

/// How a run of the binary ended.
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    /// Panics with all that was said unless the exit code is this one.
    #[track_caller]
    pub fn expect(self, code: i32) -> Outcome {
        assert_eq!(
            self.code,
            Some(code),
            "exit code\n--- stdout\n{}\n--- stderr\n{}",
            self.stdout,
            self.stderr
        );
        // a thread may panic without a trace in the exit code
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        self
    }
}

/// A folder of its own to work in.
pub struct Bench(TempDir);

impl Bench {
    pub fn new() -> Bench {
        Bench(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    pub fn put(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).expect("a file can be written");
        path
    }

    /// The binary, ready to run in this folder.
    pub fn command<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_brakewave"));
        command
            .args(arguments)
            .current_dir(self.0.path())
            .stdin(Stdio::null());
        command
    }

    /// Runs the binary in this folder.
    pub fn run<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Outcome {
        let output = self.command(arguments).output().expect("the binary runs");
        Outcome {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("stdout is UTF-8"),
            stderr: String::from_utf8(output.stderr).expect("stderr is UTF-8"),
        }
    }

    /// Names of what lies in this folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.0.path())
            .expect("the folder can be read")
            .map(|entry| {
                let name = entry.expect("an entry").file_name();
                name.to_string_lossy().into_owned()
            })
            .collect();
        names.sort();
        names
    }
}

/// `text` with its only `from` replaced: a change that cannot silently be none.
#[track_caller]
pub fn changed(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "`{from}` occurs once");
    text.replacen(from, to, 1)
}

/// The text of a problem file of the repository.
pub fn problem(name: &str) -> String {
    let path = Path::new(PROBLEMS).join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Two legs through changes of regime, with small steps, many labels, profiles and pictures.
pub fn finest() -> String {
    let text = problem("mode4_mismatch.ron");
    let text = changed(&text, "range: (0.0003, 0.2)", "range: (0.0003, 0.21)");
    // both legs have a start and an end; the count of them has to survive a kill
    let steps = "toward: Both, ds_max: 5e-4, stop_after: [(event: EP, count: 4)]";
    let text = changed(&text, "toward: Down", steps);
    // the switches of so many points would make a picture of megabytes
    let text = changed(&text, "Column(\"switches\"), ", "");
    changed(&text, "profiles: 9", "profiles: 40")
}

/// Every file below a folder with its bytes.
pub type Snapshot = BTreeMap<PathBuf, Vec<u8>>;

pub fn snapshot(folder: &Path) -> Snapshot {
    fn collect(folder: &Path, root: &Path, files: &mut Snapshot) {
        for entry in fs::read_dir(folder).expect("the folder can be read") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                collect(&path, root, files);
            } else {
                let name = path.strip_prefix(root).expect("below the root").to_owned();
                files.insert(name, fs::read(&path).expect("the file can be read"));
            }
        }
    }
    let mut files = Snapshot::new();
    collect(folder, folder, &mut files);
    files
}

/// Compares byte for byte, but names the file rather than print megabytes.
#[track_caller]
pub fn assert_same(found: &Snapshot, expected: &Snapshot, when: &str) {
    let names = |files: &Snapshot| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(found), names(expected), "{when}");
    for (name, bytes) in expected {
        assert!(found[name] == *bytes, "{when}: {} differs", name.display());
    }
}

/// A table: header and rows of equal length.
pub struct Table {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    #[track_caller]
    pub fn read(path: &Path) -> Table {
        let text = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Table::parse(&text)
    }

    /// Refuses a row that is longer or shorter than the header.
    #[track_caller]
    pub fn parse(text: &[u8]) -> Table {
        let mut reader = csv::Reader::from_reader(text);
        let columns = reader
            .headers()
            .expect("a header")
            .iter()
            .map(str::to_owned);
        Table {
            columns: columns.collect(),
            rows: reader
                .records()
                .map(|row| row.expect("a row").iter().map(str::to_owned).collect())
                .collect(),
        }
    }

    #[track_caller]
    pub fn text(&self, row: usize, column: &str) -> &str {
        let index = self.columns.iter().position(|name| name == column);
        &self.rows[row][index.unwrap_or_else(|| panic!("column {column}"))]
    }

    #[track_caller]
    pub fn number(&self, row: usize, column: &str) -> f64 {
        finite(self.text(row, column))
    }

    /// The only row with this text in a column.
    #[track_caller]
    pub fn only(&self, column: &str, text: &str) -> usize {
        let rows = self.all(column, text);
        assert_eq!(rows.len(), 1, "rows with {column} = {text}");
        rows[0]
    }

    /// All rows with this text in a column.
    pub fn all(&self, column: &str, text: &str) -> Vec<usize> {
        (0..self.rows.len())
            .filter(|row| self.text(*row, column) == text)
            .collect()
    }
}

/// A finite number written with 17 significant digits.
#[track_caller]
pub fn finite(text: &str) -> f64 {
    let value: f64 = text
        .parse()
        .unwrap_or_else(|_| panic!("`{text}` is a number"));
    assert!(value.is_finite(), "`{text}` is finite");
    assert_eq!(text, format!("{value:.16e}"), "17 significant digits");
    value
}

/// Relative difference.
pub fn off(found: f64, expected: f64) -> f64 {
    ((found - expected) / expected).abs()
}
