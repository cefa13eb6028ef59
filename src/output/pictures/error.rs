//! What can go wrong while drawing.

use std::path::PathBuf;

use thiserror::Error;

use crate::output::render::RenderError;
use crate::output::store::StoreError;

/// Failure to draw a picture.
#[derive(Debug, Error)]
pub enum PlotError {
    /// A table or folder could not be read.
    #[error("{0}")]
    Read(StoreError),
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
    #[error("branch.csv has no numeric column `{name}`; it has {}", known.join(", "))]
    UnknownColumn {
        /// The name asked for.
        name: String,
        /// The names that can be asked for.
        known: Vec<String>,
    },
    /// A picture could not be rendered.
    #[error("{0}")]
    Render(#[from] RenderError),
    /// A picture could not be written.
    #[error("{0}")]
    Store(#[from] StoreError),
}
