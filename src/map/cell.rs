//! What stands at one point of a map: a wave, or none.

use serde::Serialize;

use crate::branch::BranchPoint;
use crate::branch::row::{WaveRow, why};
use crate::branch::special::Failure;
use crate::branch::wanted::NoFirstWave;
use crate::tube::model::Model;

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
        /// Why no branch comes here.
        why: Missing,
    },
}

/// Why there is no wave of a start at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum Missing {
    /// There is none to begin with at this point.
    NoStart(NoFirstWave),
    /// There is none to begin with on this row, and none that begins on other lines comes here.
    NoBranch(NoFirstWave),
    /// A branch on its way here fails.
    Cut(Failure),
    /// The branch comes back to waves that it has passed.
    ComesBack,
    /// The branch passes elsewhere.
    Elsewhere,
    /// What the branch meets here is listed under another start.
    Listed,
}

impl Missing {
    /// Whether every search that could have come here came to its end; otherwise one was cut short,
    /// and whether there is a wave is not known.
    pub fn is_known(&self) -> bool {
        match self {
            Missing::NoStart(reason) | Missing::NoBranch(reason) => reason.came_to_an_end(),
            Missing::Cut(_) => false,
            Missing::ComesBack | Missing::Elsewhere | Missing::Listed => true,
        }
    }
}

/// The word of the column `found` where a search was cut short.
pub(crate) const NOT_REACHED: &str = "not reached";

/// A row of `map.csv`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CellRow<T> {
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) start: String,
    pub(super) passage: usize,
    pub(super) found: &'static str,
    /// What it tells of the wave or the orbit there.
    pub(super) there: T,
    pub(super) why: String,
}

impl<'a> CellRow<WaveRow<'a>> {
    /// What was found at a point.
    pub fn new(cell: &'a Cell) -> CellRow<WaveRow<'a>> {
        let (found, wave, why) = match &cell.found {
            CellPoint::Wave(point) => ("wave", WaveRow::new(point), why(point)),
            CellPoint::Nothing { model, why } => {
                let found = if why.is_known() { "none" } else { NOT_REACHED };
                (found, WaveRow::nothing(**model), why.to_string())
            }
        };
        CellRow {
            row: cell.row,
            column: cell.column,
            start: cell.start.to_owned(),
            passage: cell.passage,
            found,
            there: wave,
            why,
        }
    }
}
