//! The folder of the modes of steady sliding: `steady.csv`, a picture and the problem.

use super::origin::Origin;
use super::pictures::{PlotError, Sole, draw_sole};
use super::render::Format;
use super::store::{Checkpoint, Store};
use crate::problem::Problem;

/// Name of the table.
pub(crate) const TABLE: &str = "steady.csv";

/// Writes the table and what belongs to it, in place of an earlier one.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn write(store: &Store, problem: &Problem, table: &str) -> Result<(), PlotError> {
    let picture = Sole::Steady.file(Format::Svg);
    store.begin([TABLE, Origin::FILE, &picture].map(str::to_owned), None)?;
    Origin::keep(store, problem)?;
    store.replace(TABLE, table.as_bytes())?;
    draw_sole(store, Sole::Steady, Format::Svg)?;
    Ok(())
}
