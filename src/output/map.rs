//! The folder of a map: a file per finished row, at last one table.
//!
//! `map.ron` holds the problem. `rows/` has a file for every row that is finished, put there by
//! renaming, so that none is ever seen half written: a killed map has lost no finished row, and
//! shards of a map on several machines are folders with some of its rows. The first line of a row
//! says which row of which map it is, and carries a checksum. Once all rows are there they are joined
//! in order to `map.csv`, which therefore does not depend on who computed them.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::pictures::Sole;
use super::render::Format;
use super::store::{
    Checkpoint, READ, Store, StoreError, VERSION, damaged, encode, hash, io_error, read, refused,
    replace,
};
use crate::map::{Cell, CellRow, Plane};
use crate::problem::Problem;
use crate::table::{self, number};

/// The joined table.
pub(crate) const TABLE: &str = "map.csv";
/// The joined table as Parquet.
pub(crate) const PARQUET: &str = "map.parquet";
const ROWS: &str = "rows";

/// Content of `map.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Description {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem.
    pub problem: Problem,
}

impl Checkpoint for Description {
    const FILE: &'static str = "map.ron";

    fn problem(&self) -> &Problem {
        &self.problem
    }
}

impl Description {
    /// The description of a problem by this version.
    pub(crate) fn new(problem: &Problem) -> Description {
        Description {
            version: VERSION.to_owned(),
            problem: problem.clone(),
        }
    }

    /// Reads `map.ron` of a shard.
    ///
    /// # Errors
    /// When it is missing, damaged, or of another version.
    pub(crate) fn of_shard(folder: &Path) -> Result<Description, StoreError> {
        let found = Description::read(folder)?;
        if found.version != VERSION {
            let reason = format!(
                "written by version {}, this is {VERSION}; join shards of one version by that \
                 version",
                found.version
            );
            return Err(refused(&folder.join(Description::FILE), reason));
        }
        Ok(found)
    }

    /// Number of rows of the map; zero without a `map` section.
    pub(crate) fn rows(&self) -> usize {
        self.plane().map_or(0, |plane| plane.rows())
    }

    fn plane(&self) -> Option<Plane> {
        self.problem.map.as_ref().map(Plane::new)
    }
}

/// The folder of a map, or of a shard of it.
#[derive(Debug)]
pub(crate) struct MapFolder {
    store: Store,
    description: Description,
    /// Hash of the description: which map this is.
    identity: u64,
    begun: Mutex<bool>,
}

impl MapFolder {
    /// The folder of a map in a store that was opened for it.
    ///
    /// # Errors
    /// When the description cannot be written down.
    pub(crate) fn new(store: Store, description: Description) -> Result<MapFolder, StoreError> {
        let text = encode(&store.path().join(Description::FILE), &description)?;
        Ok(MapFolder {
            begun: Mutex::new(false),
            identity: hash(text.as_bytes()),
            description,
            store,
        })
    }

    /// Begins the folder or goes on with it, once: when there is something to write.
    ///
    /// # Errors
    /// When something else is in the way, or the system refuses.
    pub(crate) fn begin(&self, rows: &[usize]) -> Result<(), StoreError> {
        let mut begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner);
        if *begun {
            return Ok(());
        }
        let picture = Sole::Map.file(Format::Svg);
        let fixed = [Description::FILE, TABLE, &picture]
            .map(str::to_owned)
            .into_iter();
        let parquet = cfg!(feature = "parquet").then(|| PARQUET.to_owned());
        let rows = rows.iter().map(|row| row_name(*row));
        let names = fixed.chain(parquet).chain(rows);
        if self.store.resumes() {
            self.store.retain(|_| true)?;
            self.store.claim(names)?;
        } else {
            self.store.begin(names, Some(ROWS))?;
        }
        self.store.save(&self.description)?;
        *begun = true;
        Ok(())
    }

    /// Rows that are finished; one that is damaged is not.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub(crate) fn finished(&self) -> Result<Vec<usize>, StoreError> {
        if !self.store.resumes() {
            return Ok(Vec::new());
        }
        let mut rows = Vec::new();
        for (row, file) in row_files(self.path())? {
            if self.cells(row, &file).is_ok() {
                rows.push(row);
            }
        }
        Ok(rows)
    }

    /// Keeps a finished row.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn write(&self, row: usize, cells: &[Cell]) -> Result<(), StoreError> {
        let rows = cells.iter().map(CellRow::new);
        let cells: String = rows.map(|row| table::line(&row)).collect();
        let text = self.head(row, &cells) + &cells;
        self.store.replace(&row_name(row), text.as_bytes())
    }

    /// The first line of a row with these cells: which row it is, and their checksum.
    fn head(&self, row: usize, cells: &str) -> String {
        format!(
            "{} {} cells, checksum {:016x}\n",
            self.place(row),
            cells.lines().count(),
            hash(cells.as_bytes())
        )
    }

    fn place(&self, row: usize) -> String {
        let first = self.description.plane().and_then(|plane| {
            let point = plane.row(row).first().copied()?;
            Some(number(point[0]))
        });
        format!(
            "# brakewave map {:016x}, row {row} of {}, first parameter {},",
            self.identity,
            self.description.rows(),
            first.unwrap_or_default()
        )
    }

    /// The cells of a row as they were written.
    fn cells(&self, row: usize, file: &Path) -> Result<String, StoreError> {
        let mut text = read(file)?;
        if !text.starts_with(&self.place(row)) {
            return Err(damaged(file, format!("it is not row {row} of this map")));
        }
        let cells = text.split_off(text.find('\n').map_or(text.len(), |end| end + 1));
        if text != self.head(row, &cells) {
            return Err(damaged(
                file,
                "it is cut short or changed: its checksum is not that of its cells",
            ));
        }
        Ok(cells)
    }

    /// Joins the rows of these folders to a table in this one, after all have been looked at.
    ///
    /// # Errors
    /// When a row is missing or damaged, when folders disagree, or when the system refuses.
    pub(crate) fn join(&self, from: &[PathBuf]) -> Result<(), StoreError> {
        let mut rows: BTreeMap<usize, PathBuf> = BTreeMap::new();
        let all = self.description.rows();
        for folder in from {
            for (row, file) in row_files(folder)? {
                let cells = self.cells(row, &file)?;
                if let Some(other) = rows.get(&row)
                    && self.cells(row, other)? != cells
                {
                    let reason = format!(
                        "row {row} is another one than in {}: they were computed by different \
                         programs",
                        other.display()
                    );
                    return Err(refused(&file, reason));
                }
                rows.insert(row, file);
            }
        }
        let mut missing = (0..all).filter(|row| !rows.contains_key(row));
        if let Some(first) = missing.next() {
            let reason = format!(
                "{} of {all} rows are missing, the first of them row {first}: finish all shards, or \
                 name all their folders",
                missing.count() + 1
            );
            return Err(refused(self.path(), reason));
        }
        self.begin(&[])?;
        let path = self.path().join(TABLE);
        replace(&path, |out| {
            out.write_all(table::header::<CellRow>().as_bytes())
                .map_err(io_error("write it", &path))?;
            for (row, file) in &rows {
                let cells = self.cells(*row, file)?;
                out.write_all(cells.as_bytes())
                    .map_err(io_error("write it", &path))?;
            }
            Ok(())
        })?;
        #[cfg(feature = "parquet")]
        self.convert(&path)?;
        Ok(())
    }

    /// The table as Parquet.
    #[cfg(feature = "parquet")]
    fn convert(&self, table: &Path) -> Result<(), StoreError> {
        use super::parquet::{Kind, convert};
        let kind = |name: &str| match name {
            "row" | "column" | "passage" | "unstable" | "lead_sector" => Kind::Integer,
            "start" | "regimes" | "switches" | "stable" | "why" => Kind::Text,
            _ => Kind::Number,
        };
        let parquet = self.path().join(PARQUET);
        replace(&parquet, |out| {
            convert(table, out, kind)
                .map_err(|error| io_error("write it", &parquet)(io::Error::other(error)))
        })
    }

    /// The folder as such.
    pub(crate) fn store(&self) -> &Store {
        &self.store
    }

    /// The folder.
    pub(crate) fn path(&self) -> &Path {
        self.store.path()
    }
}

fn row_name(row: usize) -> String {
    format!("{ROWS}/{row:09}.csv")
}

/// Files of the finished rows of a folder.
fn row_files(folder: &Path) -> Result<BTreeMap<usize, PathBuf>, StoreError> {
    let rows = folder.join(ROWS);
    let entries = match fs::read_dir(&rows) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(error) => return Err(io_error(READ, &rows)(error)),
    };
    let mut files = BTreeMap::new();
    for entry in entries {
        let path = entry.map_err(io_error(READ, &rows))?.path();
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
