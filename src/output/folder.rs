//! The result folder: written as the branch grows, readable after a kill, resumable.
//!
//! Rows are appended one by one. `branch.ron` holds every labelled wave and the progress of the
//! run; it is replaced as a whole at every label, by writing beside it and renaming, so that it is
//! never seen half written. A resumed run cuts the tables back to the last progress saved and goes
//! on from there, through the same steps as an uninterrupted one.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use csv::StringRecord;
use serde::{Deserialize, Serialize};

use super::{plots, tables};
use crate::curve::start::Labelled;
use crate::problem::Problem;
use crate::run::{Branch, Item, Progress, SavedWave};

/// What is wrong with a folder.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The operating system refused.
    #[error("{}: {error}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system said.
        error: io::Error,
    },
    /// There are results already.
    #[error(
        "{} holds results already; --force replaces them, --resume goes on, --out DIR takes \
         another folder",
        .0.display()
    )]
    Exists(PathBuf),
    /// `branch.ron` is missing or damaged.
    #[error("{}: {reason}", path.display())]
    Restart {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

fn io_error(path: &Path) -> impl FnOnce(io::Error) -> FolderError + '_ {
    move |error| FolderError::Io {
        path: path.to_path_buf(),
        error,
    }
}

/// Content of `branch.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Restart {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: Problem,
    /// State of the run.
    pub progress: Progress,
    /// Every labelled wave, in order.
    pub waves: Vec<SavedWave>,
}

impl Restart {
    /// Reads the restart file of a folder.
    pub fn read(folder: &Path) -> Result<Restart, FolderError> {
        let path = folder.join(RESTART);
        let text = fs::read_to_string(&path).map_err(io_error(&path))?;
        ron::from_str(&text).map_err(|error| FolderError::Restart {
            path,
            reason: format!("not a restart file of this version: {error}"),
        })
    }

    /// The wave of a label.
    pub fn wave(&self, folder: &Path, label: usize) -> Result<&SavedWave, FolderError> {
        self.waves
            .iter()
            .find(|wave| wave.label == label)
            .ok_or_else(|| FolderError::Restart {
                path: folder.join(RESTART),
                reason: format!(
                    "no label {label}; labels run from 1 to {}",
                    self.waves.len()
                ),
            })
    }
}

/// The event of a label, from `events.csv`.
///
/// # Errors
/// The file is missing or damaged, or has no such label.
pub fn labelled(folder: &Path, label: usize) -> Result<Labelled, FolderError> {
    let path = folder.join(EVENTS);
    let text = fs::read(&path).map_err(io_error(&path))?;
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let damaged = |reason: String| FolderError::Restart {
        path: path.clone(),
        reason,
    };
    let header = reader
        .headers()
        .map_err(|error| damaged(error.to_string()))?
        .clone();
    let records = reader.records().filter_map(Result::ok);
    let rows: Vec<StringRecord> = records.collect();
    let row = rows
        .iter()
        .find(|row| field(&header, row, "label") == Some(label))
        .ok_or_else(|| damaged(format!("no label {label}; there are {}", rows.len())))?;
    Ok(Labelled {
        kind: field(&header, row, "type")
            .ok_or_else(|| damaged(format!("label {label} has no type")))?,
        sector: field(&header, row, "sector").unwrap_or(0),
        omega: field(&header, row, "omega"),
    })
}

/// A field of a table by the name of its column.
fn field<T: FromStr>(header: &StringRecord, row: &StringRecord, name: &str) -> Option<T> {
    let column = header.iter().position(|known| known == name)?;
    row.get(column)?.parse().ok()
}

/// Name of the restart file.
pub const RESTART: &str = "branch.ron";
const BRANCH: &str = "branch.csv";
const EVENTS: &str = "events.csv";
const SPECTRUM: &str = "spectrum.csv";
const PROFILES: &str = "profiles";

/// Intervals of a profile over one wavelength.
const PROFILE_RESOLUTION: usize = 360;

/// A result folder being written.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    branch: File,
    events: File,
    /// With a `stability` section only.
    spectrum: Option<File>,
    with_profiles: bool,
    restart: Restart,
}

impl Folder {
    /// Creates the folder for a run that begins. An existing one is refused unless `force`, which
    /// removes the files of an earlier run and no others.
    pub fn create(
        path: &Path,
        problem: &Problem,
        branch: &Branch,
        force: bool,
    ) -> Result<Folder, FolderError> {
        if path.exists() {
            let occupied =
                !path.is_dir() || fs::read_dir(path).map_err(io_error(path))?.next().is_some();
            if occupied && !force {
                return Err(FolderError::Exists(path.to_path_buf()));
            }
            clear(path)?;
        }
        fs::create_dir_all(path).map_err(io_error(path))?;
        let with_profiles = problem.output.profiles > 0;
        if with_profiles {
            let profiles = path.join(PROFILES);
            fs::create_dir_all(&profiles).map_err(io_error(&profiles))?;
        }
        let table = |name: &str, header: &str| -> Result<File, FolderError> {
            let path = path.join(name);
            let mut file = File::create(&path).map_err(io_error(&path))?;
            writeln!(file, "{header}").map_err(io_error(&path))?;
            Ok(file)
        };
        let folder = Folder {
            branch: table(BRANCH, tables::BRANCH_HEADER)?,
            events: table(EVENTS, &tables::events_header(problem.model.friction_law))?,
            spectrum: if branch.with_stability() {
                Some(table(SPECTRUM, tables::SPECTRUM_HEADER)?)
            } else {
                None
            },
            path: path.to_path_buf(),
            with_profiles,
            restart: Restart {
                version: env!("CARGO_PKG_VERSION").to_string(),
                problem: problem.clone(),
                progress: branch.progress().clone(),
                waves: Vec::new(),
            },
        };
        Ok(folder)
    }

    /// Opens the folder of an interrupted run: tables are cut back to the saved progress.
    pub fn reopen(path: &Path, restart: Restart) -> Result<Folder, FolderError> {
        let table = |name: &str, rows: usize| -> Result<File, FolderError> {
            let path = path.join(name);
            // bytes, for a row cut short may end within a character
            let text = fs::read(&path).map_err(io_error(&path))?;
            let Some(length) = line_ends(&text).nth(rows) else {
                return Err(FolderError::Restart {
                    path,
                    reason: format!("fewer than the {rows} rows that were saved"),
                });
            };
            let file = OpenOptions::new()
                .append(true)
                .open(&path)
                .map_err(io_error(&path))?;
            file.set_len(length as u64).map_err(io_error(&path))?;
            Ok(file)
        };
        let branch = table(BRANCH, restart.progress.points)?;
        let events = table(EVENTS, restart.progress.events)?;
        let spectrum = if restart.problem.stability.is_some() {
            Some(table(SPECTRUM, restart.progress.eigenvalues)?)
        } else {
            None
        };
        remove_profiles(&path.join(PROFILES), restart.progress.labels)?;
        Ok(Folder {
            path: path.to_path_buf(),
            branch,
            events,
            spectrum,
            with_profiles: restart.problem.output.profiles > 0,
            restart,
        })
    }

    /// Writes what one step found, and the progress after it if it holds a label or the end.
    pub fn write(&mut self, items: &[Item], branch: &Branch) -> Result<(), FolderError> {
        for item in items {
            let path = self.path.join(BRANCH);
            self.branch
                .write_all(tables::branch_row(&item.point, item.leg).as_bytes())
                .map_err(io_error(&path))?;
            if let Some(event) = &item.event {
                let path = self.path.join(EVENTS);
                self.events
                    .write_all(tables::event_row(event).as_bytes())
                    .map_err(io_error(&path))?;
            }
            if let (Some(file), Some(label)) = (&mut self.spectrum, item.point.label) {
                let path = self.path.join(SPECTRUM);
                for (sector, numbers) in &item.eigenvalues {
                    file.write_all(tables::spectrum_row(Some(label), *sector, *numbers).as_bytes())
                        .map_err(io_error(&path))?;
                }
            }
            if let Some(saved) = &item.saved {
                self.restart.waves.push(saved.clone());
                if self.with_profiles {
                    let path = self
                        .path
                        .join(PROFILES)
                        .join(format!("{}.csv", saved.label));
                    // a profile that overflows is left out: the point itself has been solved
                    if let Ok(samples) = item.profile(PROFILE_RESOLUTION) {
                        fs::write(&path, tables::profile(&samples)).map_err(io_error(&path))?;
                    }
                }
            }
        }
        let labelled = items.iter().any(|item| item.saved.is_some());
        if labelled || branch.progress().end.is_some() {
            self.restart.progress = branch.progress().clone();
            self.save()?;
        }
        Ok(())
    }

    fn save(&self) -> Result<(), FolderError> {
        let path = self.path.join(RESTART);
        let beside = self.path.join("branch.ron.new");
        let text = ron::ser::to_string(&self.restart).map_err(|error| FolderError::Restart {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        fs::write(&beside, text).map_err(io_error(&beside))?;
        fs::rename(&beside, &path).map_err(io_error(&path))
    }
}

/// Whether a folder has no more of a branch than a run killed before its first label leaves
/// behind: nothing that would be missed.
pub fn barely_begun(path: &Path) -> bool {
    fs::read(path.join(BRANCH)).map_or(true, |text| line_ends(&text).count() <= 2)
}

/// Where the lines of a text end, each past its newline.
fn line_ends(text: &[u8]) -> impl Iterator<Item = usize> {
    text.iter()
        .enumerate()
        .filter(|(_, byte)| **byte == b'\n')
        .map(|(index, _)| index + 1)
}

/// Removes what an earlier run wrote, and nothing else.
fn clear(path: &Path) -> Result<(), FolderError> {
    for entry in fs::read_dir(path).map_err(io_error(path))?.flatten() {
        let file = entry.path();
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let table = [BRANCH, EVENTS, SPECTRUM, RESTART, "branch.ron.new"]
            .iter()
            .any(|known| name == *known);
        if file.is_file() && (table || plots::is_picture(&name)) {
            fs::remove_file(&file).map_err(io_error(&file))?;
        }
    }
    let profiles = path.join(PROFILES);
    remove_profiles(&profiles, 0)?;
    // stays where it is not empty
    let _ = fs::remove_dir(&profiles);
    Ok(())
}

/// Removes the profiles of all labels beyond `last`.
fn remove_profiles(profiles: &Path, last: usize) -> Result<(), FolderError> {
    let Ok(entries) = fs::read_dir(profiles) else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let label: Option<usize> = entry
            .file_name()
            .to_str()
            .and_then(|name| name.strip_suffix(".csv"))
            .and_then(|label| label.parse().ok());
        if label.is_some_and(|label| label > last) {
            let path = entry.path();
            fs::remove_file(&path).map_err(io_error(&path))?;
        }
    }
    Ok(())
}
