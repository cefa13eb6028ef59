//! The folder of a map: a file per finished row, at last one table.
//!
//! `map.ron` holds the problem. `rows/` has a file for every row that is finished, put there by
//! renaming, so that none is ever seen half written: a killed map has lost no finished row, and
//! shards of a map on several machines are folders with some of its rows. Once all rows are there
//! they are joined in order to `map.csv`, which therefore does not depend on who computed them.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::tables::{MAP_HEADER, map_row};
use crate::map::{Cell, Plane};
use crate::problem::Problem;

/// The joined table.
pub const TABLE: &str = "map.csv";
/// The joined table as Parquet.
pub const PARQUET: &str = "map.parquet";
const DESCRIPTION: &str = "map.ron";
const ROWS: &str = "rows";

/// What is wrong with the folder of a map.
#[derive(Debug, thiserror::Error)]
pub enum MapFolderError {
    /// The operating system refused.
    #[error("{}: {error}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system said.
        error: io::Error,
    },
    /// There is something already.
    #[error(
        "{} holds a map already; --force replaces it, --resume goes on, --out DIR takes another \
         folder",
        .0.display()
    )]
    Exists(PathBuf),
    /// `map.ron` is missing or damaged, or belongs to another map.
    #[error("{}: {reason}", path.display())]
    Description {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Rows are missing.
    #[error(
        "{missing} of {all} rows are missing, the first of them row {first}: finish all shards, or \
         name all their folders"
    )]
    Missing {
        /// How many.
        missing: usize,
        /// Of how many.
        all: usize,
        /// The first of them.
        first: usize,
    },
    /// Two shards disagree.
    #[error(
        "{} and {} hold different results for row {row}: they were computed by different programs",
        one.display(),
        other.display()
    )]
    Disagree {
        /// Row.
        row: usize,
        /// A file.
        one: PathBuf,
        /// Another one.
        other: PathBuf,
    },
}

fn io_error(path: &Path) -> impl FnOnce(io::Error) -> MapFolderError + '_ {
    move |error| MapFolderError::Io {
        path: path.to_path_buf(),
        error,
    }
}

/// Content of `map.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem.
    pub problem: Problem,
}

impl Description {
    /// The description of a problem by this version.
    pub fn new(problem: &Problem) -> Description {
        Description {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            problem: problem.clone(),
        }
    }

    /// Reads `map.ron`.
    ///
    /// # Errors
    /// When it is missing, or not a description by this version.
    pub fn read(folder: &Path) -> Result<Description, MapFolderError> {
        let path = folder.join(DESCRIPTION);
        let text = fs::read_to_string(&path).map_err(io_error(&path))?;
        let found: Description =
            ron::from_str(&text).map_err(|error| MapFolderError::Description {
                path: path.clone(),
                reason: format!("not the description of a map by this version: {error}"),
            })?;
        if found.version != env!("CARGO_PKG_VERSION") {
            return Err(MapFolderError::Description {
                path,
                reason: format!(
                    "written by version {}, this is {}",
                    found.version,
                    env!("CARGO_PKG_VERSION")
                ),
            });
        }
        Ok(found)
    }

    /// Number of rows of the map; zero without a `map` section.
    pub fn rows(&self) -> usize {
        self.problem
            .map
            .as_ref()
            .map_or(0, |map| Plane::new(map).rows())
    }
}

/// The folder of a map, or of a shard of it.
#[derive(Clone, Debug)]
pub struct MapFolder {
    path: PathBuf,
}

impl MapFolder {
    /// Creates the folder or, with `resume`, opens what an earlier run of the same problem left.
    ///
    /// # Errors
    /// When there is a map already and neither `resume` nor `force`, or one of another problem; when
    /// the system refuses.
    pub fn open(
        path: &Path,
        description: &Description,
        resume: bool,
        force: bool,
    ) -> Result<MapFolder, MapFolderError> {
        let folder = MapFolder {
            path: path.to_path_buf(),
        };
        if path.exists() {
            let empty =
                path.is_dir() && fs::read_dir(path).map_err(io_error(path))?.next().is_none();
            let begun = path.join(DESCRIPTION).exists();
            if resume && begun {
                if Description::read(path)? != *description {
                    return Err(MapFolderError::Description {
                        path: path.join(DESCRIPTION),
                        reason: "written for another problem; --force starts anew".into(),
                    });
                }
                return Ok(folder);
            }
            if !empty && !force {
                return Err(MapFolderError::Exists(path.to_path_buf()));
            }
            folder.clear()?;
        }
        let rows = path.join(ROWS);
        fs::create_dir_all(&rows).map_err(io_error(&rows))?;
        folder.describe(description)?;
        Ok(folder)
    }

    fn describe(&self, description: &Description) -> Result<(), MapFolderError> {
        let file = self.path.join(DESCRIPTION);
        let text = ron::to_string(description).map_err(|error| MapFolderError::Description {
            path: file.clone(),
            reason: error.to_string(),
        })?;
        replace(&file, text.as_bytes())
    }

    /// Removes what an earlier map left, and nothing else.
    fn clear(&self) -> Result<(), MapFolderError> {
        for name in [DESCRIPTION, TABLE, PARQUET] {
            let file = self.path.join(name);
            if file.exists() {
                fs::remove_file(&file).map_err(io_error(&file))?;
            }
        }
        for file in row_files(&self.path)?.into_values() {
            fs::remove_file(&file).map_err(io_error(&file))?;
        }
        Ok(())
    }

    /// Rows that are finished.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn finished(&self) -> Result<Vec<usize>, MapFolderError> {
        Ok(row_files(&self.path)?.into_keys().collect())
    }

    /// Keeps a finished row.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, row: usize, cells: &[Cell]) -> Result<(), MapFolderError> {
        let text: String = cells.iter().map(map_row).collect();
        let file = self.path.join(ROWS).join(format!("{row:09}.csv"));
        replace(&file, text.as_bytes())
    }

    /// Joins the rows of these folders to a table in this one.
    ///
    /// # Errors
    /// When a row is missing, when folders disagree, or when the system refuses.
    pub fn join(
        &self,
        description: &Description,
        from: &[PathBuf],
    ) -> Result<PathBuf, MapFolderError> {
        let mut rows: BTreeMap<usize, PathBuf> = BTreeMap::new();
        for folder in from {
            for (row, file) in row_files(folder)? {
                if let Some(other) = rows.get(&row) {
                    let read = |path: &PathBuf| fs::read(path).map_err(io_error(path));
                    if read(other)? != read(&file)? {
                        return Err(MapFolderError::Disagree {
                            row,
                            one: other.clone(),
                            other: file,
                        });
                    }
                }
                rows.insert(row, file);
            }
        }
        let all = description.rows();
        let missing: Vec<usize> = (0..all).filter(|row| !rows.contains_key(row)).collect();
        if let Some(&first) = missing.first() {
            return Err(MapFolderError::Missing {
                missing: missing.len(),
                all,
                first,
            });
        }
        let table = self.path.join(TABLE);
        let beside = self.path.join("map.csv.new");
        let file = File::create(&beside).map_err(io_error(&beside))?;
        let mut out = BufWriter::new(file);
        writeln!(out, "{MAP_HEADER}").map_err(io_error(&beside))?;
        for path in rows.range(..all).map(|(_, path)| path) {
            let text = fs::read(path).map_err(io_error(path))?;
            out.write_all(&text).map_err(io_error(&beside))?;
        }
        out.flush().map_err(io_error(&beside))?;
        fs::rename(&beside, &table).map_err(io_error(&table))?;
        Ok(table)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Writes beside and renames.
fn replace(file: &Path, bytes: &[u8]) -> Result<(), MapFolderError> {
    let beside = file.with_extension("new");
    fs::write(&beside, bytes).map_err(io_error(&beside))?;
    fs::rename(&beside, file).map_err(io_error(file))
}

/// Files of the finished rows of a folder.
fn row_files(folder: &Path) -> Result<BTreeMap<usize, PathBuf>, MapFolderError> {
    let rows = folder.join(ROWS);
    let entries = match fs::read_dir(&rows) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(error) => return Err(io_error(&rows)(error)),
    };
    let mut files = BTreeMap::new();
    for entry in entries {
        let path = entry.map_err(io_error(&rows))?.path();
        let number = path
            .file_name()
            .and_then(|name| name.to_str())
            .and_then(|name| name.strip_suffix(".csv"))
            .and_then(|name| name.parse().ok());
        if let Some(row) = number {
            files.insert(row, path);
        }
    }
    Ok(files)
}
