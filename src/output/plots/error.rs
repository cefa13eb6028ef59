//! What can go wrong while drawing.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::output::store::StoreError;

/// Failure to draw a picture.
#[derive(Debug, Error)]
pub enum PlotError {
    /// A table or folder could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A table is not comma-separated text.
    #[error("{} is not a table: {source}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        source: csv::Error,
    },
    /// A table has not even a header.
    #[error("{} is empty: it has no header", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A table lacks a column that the picture is made from.
    #[error("{} has no column `{column}`", path.display())]
    MissingColumn {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
    },
    /// The parameter or the column asked for is not a numeric column of `branch.csv`.
    #[error("branch.csv has no numeric column `{name}`; it has {known}")]
    UnknownColumn {
        /// The name asked for.
        name: String,
        /// The names that can be asked for, separated by commas.
        known: String,
    },
    /// PNG and PDF were left out when the program was built.
    #[error("this build writes SVG only; build it with the feature `raster` for {0}")]
    FormatMissing(&'static str),
    /// A picture could not be composed.
    #[error("cannot compose the picture: {0}")]
    Compose(String),
    /// A composed picture could not be converted.
    #[error("cannot convert the picture to {format}: {reason}")]
    Convert {
        /// The format asked for.
        format: &'static str,
        /// Why.
        reason: String,
    },
    /// A picture could not be written.
    #[error("{0}")]
    Store(#[from] StoreError),
}
