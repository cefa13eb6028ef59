//! The folder of the modes of steady sliding: `steady.csv`, a picture and the problem.

use super::origin::Origin;
use super::pictures::{self, PlotError};
use super::render::Format;
use super::store::{Kind, Store};
use crate::problem::Problem;

/// Name of the table.
pub(crate) const TABLE: &str = "steady.csv";

/// Writes the table and what belongs to it, in place of an earlier one.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn write(store: &Store, problem: &Problem, table: &str) -> Result<(), PlotError> {
    let pictures = pictures::names(Kind::Steady, problem, Format::Svg);
    store.begin(&[TABLE, Origin::FILE], pictures, None)?;
    Origin::keep(store, problem)?;
    store.replace(TABLE, table.as_bytes())?;
    pictures::draw(store, Some(problem), Format::Svg)?;
    Ok(())
}
