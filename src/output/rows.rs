//! The folder of a table that is computed row by row, a map or a scan: a file per finished row, at last one table.
//!
//! `map.ron` holds the problem. `rows/` has a file for every row that is finished, put there by
//! renaming, so that none is ever seen half written: a killed map has lost no finished row, and
//! shards of a map on several machines are folders with some of its rows. The first line of a row
//! says which row of which map it is, and carries a checksum. Once all rows are there they are joined
//! in order to `map.csv`, which therefore does not depend on who computed them. A row of a scan is a piece of it.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::layout::{self, ATTRACTORS, ATTRACTORS_SAVED, MAP, MAP_ORIGIN, SHARES, SHARES_PICTURE};
use super::origin::ProblemOrigin;
use super::render::Format;
use super::store::{
    FolderKind, Store, StoreError, VERSION, decode, encode, hash, io_error, numbered, read,
    refused, resumable,
};
use crate::branch::row::WaveRow;
use crate::map::{CellRow, MapPlane};
use crate::problem::{Problem, SystemMap, SystemProblem};
use crate::table::{self, number};

const ROWS: &str = "rows";

/// A kind of table that is computed row by row: the folders that have it, and its files.
pub(crate) struct RowFiles {
    /// What the folder holds once all rows are joined.
    pub kind: FolderKind,
    /// What it holds where it has some of the rows.
    pub shard: FolderKind,
    /// The file of the problem.
    pub origin: &'static str,
    /// The joined table.
    pub table: &'static str,
    /// The joined table as Parquet.
    pub parquet: Option<&'static str>,
}

/// A problem whose results are a table that is computed row by row.
pub(crate) trait Rowed: Clone + PartialEq + Serialize + DeserializeOwned {
    /// The kind of its table.
    const FILES: RowFiles;

    /// Number of rows.
    fn rows(&self) -> usize;
    /// Value of the first parameter where a row begins.
    fn first(&self, row: usize) -> Option<f64>;
    /// The header of the table.
    fn header(&self) -> String;
    /// Other tables and files that are made once all rows are joined.
    fn beside(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A problem whose section `map` is computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Mapped<P>(pub P);

const MAP_FILES: RowFiles = RowFiles {
    kind: FolderKind::Map,
    shard: FolderKind::MapShard,
    origin: MAP_ORIGIN,
    table: MAP,
    parquet: match cfg!(feature = "parquet") {
        true => Some("map.parquet"),
        false => None,
    },
};

impl Rowed for Mapped<Problem> {
    const FILES: RowFiles = MAP_FILES;

    fn rows(&self) -> usize {
        let map = self.0.map.as_ref();
        map.map_or(0, |map| MapPlane::new(map).rows())
    }

    fn first(&self, row: usize) -> Option<f64> {
        first_of(&MapPlane::new(self.0.map.as_ref()?), row)
    }

    fn header(&self) -> String {
        table::header::<CellRow<WaveRow>>()
    }
}

/// The values of shares have a row each, after those of the plane.
impl Rowed for Mapped<SystemProblem> {
    const FILES: RowFiles = MAP_FILES;

    fn rows(&self) -> usize {
        let map = self.0.map.as_ref();
        map.map_or(0, |map| {
            let shares = map.shares.as_ref();
            MapPlane::new(map).rows() + shares.map_or(0, |shares| shares.values.count())
        })
    }

    fn first(&self, row: usize) -> Option<f64> {
        let map = self.0.map.as_ref()?;
        let plane = MapPlane::new(map);
        match row.checked_sub(plane.rows()) {
            Some(value) => Some(map.shares.as_ref()?.values.value(value)),
            None => first_of(&plane, row),
        }
    }

    fn header(&self) -> String {
        let row = CellRow::columns(&self.0.system.source);
        table::line_of(
            &match self.0.map.as_ref().is_some_and(SystemMap::is_basin) {
                true => table::columns(&CellRow::of_basin(row, None)),
                false => table::columns(&row),
            },
        )
    }

    fn beside(&self) -> Vec<String> {
        let Some(map) = &self.0.map else {
            return Vec::new();
        };
        let picture = layout::picture(SHARES_PICTURE, Format::Svg);
        let basin: &[&str] = &[ATTRACTORS, ATTRACTORS_SAVED];
        let shares: &[&str] = &[SHARES, &picture];
        let basin = basin.iter().filter(|_| map.is_basin());
        let shares = shares.iter().filter(|_| map.shares.is_some());
        basin.chain(shares).map(|name| (*name).to_owned()).collect()
    }
}

/// Value of the first parameter where a row of a plane begins.
fn first_of(plane: &MapPlane, row: usize) -> Option<f64> {
    let point = |row| plane.row(row).first().map(|point| point[0]);
    (row < plane.rows()).then(|| point(row)).flatten()
}

/// Reads the problem of a shard.
///
/// # Errors
/// When it is missing, damaged, or of another version.
pub(crate) fn of_shard<P: Rowed>(folder: &Path) -> Result<ProblemOrigin<P>, StoreError> {
    let path = folder.join(P::FILES.origin);
    let found: ProblemOrigin<P> = decode(&path)?;
    if found.version != VERSION {
        let reason = format!(
            "written by version {}, this is {VERSION}; join shards of one version by that version",
            found.version
        );
        return Err(refused(&path, reason));
    }
    Ok(found)
}

/// The folder of such a table, or of a shard of it.
#[derive(Debug)]
pub(crate) struct RowsFolder<P> {
    store: Store,
    origin: ProblemOrigin<P>,
    /// Hash of the problem as it is kept: which map this is.
    identity: u64,
    begun: Mutex<bool>,
}

impl<P: Rowed> RowsFolder<P> {
    /// The folder of a table in a store that was opened for it.
    ///
    /// # Errors
    /// When the problem cannot be written down.
    pub(crate) fn new(store: Store, origin: ProblemOrigin<P>) -> Result<RowsFolder<P>, StoreError> {
        let text = encode(&store.path().join(P::FILES.origin), &origin)?;
        Ok(RowsFolder {
            begun: Mutex::new(false),
            identity: hash(text.as_bytes()),
            origin,
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
        let mut names = vec![layout::picture(P::FILES.kind.name(), Format::Svg)];
        names.extend(P::FILES.parquet.map(str::to_owned));
        names.extend(self.origin.problem.beside());
        names.extend(rows.iter().map(|row| row_name(*row)));
        if self.store.resumes() {
            self.store.retain(|_| true)?;
            self.store.claim([P::FILES.origin, P::FILES.table])?;
            self.store.claim(names)?;
        } else {
            self.store
                .begin(&[P::FILES.origin, P::FILES.table], names, Some(ROWS))?;
        }
        self.store.save(P::FILES.origin, &self.origin)?;
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
        for (row, file) in numbered(&self.path().join(ROWS), ".csv")? {
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
    pub(crate) fn write(&self, row: usize, cells: &str) -> Result<(), StoreError> {
        let text = self.head(row, cells) + cells;
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
        format!(
            "# brakewave {} {:016x}, row {row} of {}, first parameter {},",
            P::FILES.kind.name(),
            self.identity,
            self.origin.problem.rows(),
            self.origin
                .problem
                .first(row)
                .map(number)
                .unwrap_or_default()
        )
    }

    /// The cells of a finished row.
    ///
    /// # Errors
    /// When it is missing or damaged.
    pub(crate) fn row(&self, row: usize) -> Result<String, StoreError> {
        self.cells(row, &self.path().join(row_name(row)))
    }

    /// The cells of a row as they were written.
    fn cells(&self, row: usize, file: &Path) -> Result<String, StoreError> {
        let mut text = read(file)?;
        if !text.starts_with(&self.place(row)) {
            return Err(resumable(
                file,
                format!("it is not row {row} of this {}", P::FILES.kind.name()),
            ));
        }
        let cells = text.split_off(text.find('\n').map_or(text.len(), |end| end + 1));
        if text != self.head(row, &cells) {
            return Err(resumable(
                file,
                "it is cut short or changed: its checksum is not that of its cells",
            ));
        }
        Ok(cells)
    }

    /// Joins the rows of these folders to a table in this one, after all have been looked at; `complete` gets the number and
    /// the cells of a row and adds what only all rows before it tell.
    ///
    /// # Errors
    /// When a row is missing or damaged, when folders disagree, or when the system refuses.
    pub(crate) fn join(
        &self,
        from: &[PathBuf],
        complete: &mut dyn FnMut(usize, String) -> Result<String, StoreError>,
    ) -> Result<(), StoreError> {
        let mut rows: BTreeMap<usize, PathBuf> = BTreeMap::new();
        let all = self.origin.problem.rows();
        for folder in from {
            for (row, file) in numbered(&folder.join(ROWS), ".csv")? {
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
        self.store.write(P::FILES.table, |path, out| {
            out.write_all(self.origin.problem.header().as_bytes())
                .map_err(io_error("write it", path))?;
            for (row, file) in &rows {
                let cells = complete(*row, self.cells(*row, file)?)?;
                out.write_all(cells.as_bytes())
                    .map_err(io_error("write it", path))?;
            }
            Ok(())
        })?;
        #[cfg(feature = "parquet")]
        self.convert()?;
        Ok(())
    }

    #[cfg(feature = "parquet")]
    fn convert(&self) -> Result<(), StoreError> {
        use super::parquet::{ColumnType, convert};
        let kind = |name: &str| match name {
            "row" | "column" | "passage" | "attractor" | "periods" | "unstable" | "lead_sector" => {
                ColumnType::Integer
            }
            "start" | "found" | "regimes" | "switches" | "mark" | "stable" | "why" => {
                ColumnType::Text
            }
            _ => ColumnType::Number,
        };
        let table = self.path().join(P::FILES.table);
        let Some(file) = P::FILES.parquet else {
            return Ok(());
        };
        self.store.write(file, |path, out| {
            convert(&table, out, kind)
                .map_err(|error| io_error("write it", path)(std::io::Error::other(error)))
        })
    }

    pub(crate) fn store(&self) -> &Store {
        &self.store
    }

    pub(crate) fn path(&self) -> &Path {
        self.store.path()
    }
}

fn row_name(row: usize) -> String {
    format!("{ROWS}/{row:09}.csv")
}
