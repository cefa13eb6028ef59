//! The folder of the modes of steady sliding: `steady.csv`, a picture and the problem.

use super::layout::{self, STEADY};
use super::origin::Origin;
use super::render::Format;
use super::store::{Kind, Store, StoreError};
use crate::problem::Problem;

/// Writes the table and what belongs to it, in place of an earlier one.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn write(store: &Store, problem: &Problem, table: &str) -> Result<(), StoreError> {
    let pictures = layout::pictures(Kind::Steady, problem, Format::Svg);
    store.begin(&[STEADY, Origin::FILE], pictures, None)?;
    Origin::keep(store, problem)?;
    store.replace(STEADY, table.as_bytes())
}
