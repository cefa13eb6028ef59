//! The folder of measured errors and times: a table that grows by a row for each method and setting.

use std::path::Path;

use serde::Serialize;

use super::layout::{self, ACCURACY as TABLE};
use super::origin::ProblemOrigin;
use super::render::Format;
use super::store::{self, FolderKind, GrowingFile, Store, StoreError, damaged, unfinished};
use crate::accuracy::{Rung, RungRow};
use crate::problem::Problem;
use crate::table::{self, Table};

#[derive(Debug)]
pub(crate) struct AccuracyFolder {
    store: Store,
    table: GrowingFile,
}

/// Rows that were measured, and the bytes of their table.
pub(crate) struct InterruptedTable {
    pub rows: Vec<RungRow>,
    length: usize,
}

/// The rows of a folder.
///
/// # Errors
/// When the table cannot be read.
pub(crate) fn rows(folder: &Path) -> Result<Vec<RungRow>, StoreError> {
    let path = folder.join(TABLE);
    if !path.exists() {
        return Err(unfinished(folder, "accuracy", "nothing is measured yet"));
    }
    parse(&path, &store::bytes(&path)?)
}

fn parse(path: &Path, text: &[u8]) -> Result<Vec<RungRow>, StoreError> {
    let rows = Table::parse(text).and_then(|table| table.rows());
    rows.map_err(|error| damaged(path, error.to_string()))
}

impl AccuracyFolder {
    /// The rows of an earlier run; none where there is no table.
    ///
    /// # Errors
    /// When it is damaged: of another header, with a row of no rung of the ladder, or of one twice.
    pub(crate) fn interrupted(
        store: &Store,
        ladder: &[Rung],
    ) -> Result<Option<InterruptedTable>, StoreError> {
        let path = store.path().join(TABLE);
        if !store.resumes() || !path.exists() {
            return Ok(None);
        }
        let text = store.lines(TABLE, None)?;
        if text.is_empty() {
            return Ok(None);
        }
        if !text.starts_with(table::header::<RungRow>().as_bytes()) {
            return Err(damaged(&path, "its header is another one"));
        }
        let rows = parse(&path, &text)?;
        let of = |row: &RungRow| ladder.iter().position(|rung| row.is_of(*rung));
        for (index, row) in rows.iter().enumerate() {
            if of(row).is_none() || rows[..index].iter().any(|other| of(other) == of(row)) {
                let reason = format!("row {} is of no method, or of one twice", index + 1);
                return Err(damaged(&path, reason));
            }
        }
        let length = text.len();
        Ok(Some(InterruptedTable { rows, length }))
    }

    /// Begins a table in place of an earlier one, or goes on with it.
    ///
    /// # Errors
    /// When a file cannot be written, like all that follow.
    pub(crate) fn open(
        store: Store,
        problem: &(impl Clone + Serialize),
        format: Format,
        interrupted: Option<&InterruptedTable>,
    ) -> Result<AccuracyFolder, StoreError> {
        let table = match interrupted {
            Some(earlier) => store.cut(TABLE, earlier.length)?,
            None => {
                let picture = layout::picture(FolderKind::Accuracy.name(), format);
                store.begin(
                    &[TABLE, ProblemOrigin::<Problem>::FILE],
                    vec![picture],
                    None,
                )?;
                ProblemOrigin::keep(&store, problem)?;
                store.table(TABLE, &table::header::<RungRow>(), None)?
            }
        };
        Ok(AccuracyFolder { store, table })
    }

    pub(crate) fn write(&mut self, row: &RungRow) -> Result<(), StoreError> {
        self.table.row(row)
    }

    /// Puts the rows in the order of the ladder: those of a resumed run come after the others.
    pub(crate) fn sort(&self, rows: &mut [RungRow], ladder: &[Rung]) -> Result<(), StoreError> {
        rows.sort_by_key(|row| ladder.iter().position(|rung| row.is_of(*rung)));
        let text = table::table(rows.iter().cloned());
        self.store.replace(TABLE, text.as_bytes())
    }

    pub(crate) fn store(&self) -> &Store {
        &self.store
    }
}
