//! One wave, or none, at one point of a map.

use serde::Serialize;

use crate::branch::BranchPoint;
use crate::branch::row::{WaveRow, why};
use crate::model::Model;

/// A wave that exists at a point of the plane, or the statement that none was found there.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Row, from 0: along it the first parameter of a grid is constant.
    pub row: usize,
    /// Column, from 0.
    pub column: usize,
    /// Name of the wave the branch began with: `fast` or `slow`.
    pub start: &'static str,
    /// Which passage of the branch through this point, from 1; 0 where there is none.
    pub passage: usize,
    /// What was found.
    pub found: CellPoint,
}

/// What was found at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum CellPoint {
    /// A wave. Its `point` and `label` are those of the branch and mean nothing here.
    Wave(Box<BranchPoint>),
    /// No wave of this start.
    Nothing {
        /// Model with the parameters of the point.
        model: Box<Model>,
        /// Why the branch does not come here.
        why: String,
    },
}

/// A row of `map.csv`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CellRow<'a> {
    row: usize,
    column: usize,
    start: &'static str,
    passage: usize,
    wave: WaveRow<'a>,
    why: String,
}

impl<'a> CellRow<'a> {
    /// What was found at a point.
    pub fn new(cell: &'a Cell) -> CellRow<'a> {
        let (wave, why) = match &cell.found {
            CellPoint::Wave(point) => (WaveRow::new(point), why(point)),
            CellPoint::Nothing { model, why } => (WaveRow::nothing(**model), why.clone()),
        };
        CellRow {
            row: cell.row,
            column: cell.column,
            start: cell.start,
            passage: cell.passage,
            wave,
            why,
        }
    }
}
