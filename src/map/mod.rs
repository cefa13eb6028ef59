//! Maps: which waves exist where in a plane of two parameters.
//!
//! ```text
//! problem ──► plane: where ──► row: branches through its cells ──► cells, stability
//! ```
//!
//! A map falls into rows that know nothing of each other, so that any of them can be computed on
//! any thread or machine. Along the row of a grid one branch per start is followed in the second
//! parameter, through its folds and changes of regime, and meets the values of the grid exactly.
//! Quasi-random points have no neighbours to come from: each is reached by itself.
//!
//! A map shows the waves that are connected with the closed-form slip-stick waves within its row.

mod cell;
mod plane;
mod row;

pub use cell::{Cell, CellPoint, CellRow};
pub use plane::Plane;
pub use row::{MOST_POINTS, row};
