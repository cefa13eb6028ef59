//! The folder of a map: a file per finished row, at last one table.
//!
//! `map.ron` holds the problem. `rows/` has a file for every row that is finished, put there by
//! renaming, so that none is ever seen half written: a killed map has lost no finished row, and
//! shards of a map on several machines are folders with some of its rows. The first line of a row
//! says which row of which map it is, and carries a checksum. Once all rows are there they are joined
//! in order to `map.csv`, which therefore does not depend on who computed them.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::layout::{self, MAP as TABLE, MAP_ORIGIN as ORIGIN};
use super::origin::Origin;
use super::render::Format;
use super::store::{
    Kind, Store, StoreError, VERSION, decode, encode, hash, io_error, numbered, read, refused,
    resumable,
};
use crate::map::{Cell, CellRow, Plane};
use crate::table::{self, number};

/// The joined table as Parquet.
pub(crate) const PARQUET: &str = "map.parquet";
const ROWS: &str = "rows";

/// Reads `map.ron` of a shard.
///
/// # Errors
/// When it is missing, damaged, or of another version.
pub(crate) fn of_shard(folder: &Path) -> Result<Origin, StoreError> {
    let path = folder.join(ORIGIN);
    let found: Origin = decode(&path)?;
    if found.version != VERSION {
        let reason = format!(
            "written by version {}, this is {VERSION}; join shards of one version by that version",
            found.version
        );
        return Err(refused(&path, reason));
    }
    Ok(found)
}

/// The folder of a map, or of a shard of it.
#[derive(Debug)]
pub(crate) struct MapFolder {
    store: Store,
    origin: Origin,
    /// Hash of the problem as it is kept: which map this is.
    identity: u64,
    begun: Mutex<bool>,
}

impl MapFolder {
    /// The folder of a map in a store that was opened for it.
    ///
    /// # Errors
    /// When the problem cannot be written down.
    pub(crate) fn new(store: Store, origin: Origin) -> Result<MapFolder, StoreError> {
        let text = encode(&store.path().join(ORIGIN), &origin)?;
        Ok(MapFolder {
            begun: Mutex::new(false),
            identity: hash(text.as_bytes()),
            origin,
            store,
        })
    }

    /// Number of rows of the map; zero without a `map` section.
    pub(crate) fn rows(&self) -> usize {
        self.plane().map_or(0, |plane| plane.rows())
    }

    fn plane(&self) -> Option<Plane> {
        self.origin.problem.map.as_ref().map(Plane::new)
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
        let mut names = layout::pictures(Kind::Map, &self.origin.problem, Format::Svg);
        names.extend(cfg!(feature = "parquet").then(|| PARQUET.to_owned()));
        names.extend(rows.iter().map(|row| row_name(*row)));
        if self.store.resumes() {
            self.store.retain(|_| true)?;
            self.store.claim([ORIGIN, TABLE])?;
            self.store.claim(names)?;
        } else {
            self.store.begin(&[ORIGIN, TABLE], names, Some(ROWS))?;
        }
        self.store.save(ORIGIN, &self.origin)?;
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
        let first = self.plane().and_then(|plane| {
            let point = plane.row(row).first().copied()?;
            Some(number(point[0]))
        });
        format!(
            "# brakewave map {:016x}, row {row} of {}, first parameter {},",
            self.identity,
            self.rows(),
            first.unwrap_or_default()
        )
    }

    /// The cells of a row as they were written.
    fn cells(&self, row: usize, file: &Path) -> Result<String, StoreError> {
        let mut text = read(file)?;
        if !text.starts_with(&self.place(row)) {
            return Err(resumable(file, format!("it is not row {row} of this map")));
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

    /// Joins the rows of these folders to a table in this one, after all have been looked at.
    ///
    /// # Errors
    /// When a row is missing or damaged, when folders disagree, or when the system refuses.
    pub(crate) fn join(&self, from: &[PathBuf]) -> Result<(), StoreError> {
        let mut rows: BTreeMap<usize, PathBuf> = BTreeMap::new();
        let all = self.rows();
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
        self.store.write(TABLE, |path, out| {
            out.write_all(table::header::<CellRow>().as_bytes())
                .map_err(io_error("write it", path))?;
            for (row, file) in &rows {
                let cells = self.cells(*row, file)?;
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
        use super::parquet::{Kind, convert};
        let kind = |name: &str| match name {
            "row" | "column" | "passage" | "unstable" | "lead_sector" => Kind::Integer,
            "start" | "found" | "regimes" | "switches" | "stable" | "why" => Kind::Text,
            _ => Kind::Number,
        };
        let table = self.path().join(TABLE);
        self.store.write(PARQUET, |path, out| {
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
