//! Maps: which waves exist where in a plane of two parameters, or what the motions of a system settle on there.
//!
//! ```text
//! problem ──► plane: where ──► lattice: a few lines in both parameters ──► row: branches through its cells
//!                                  └────────── line: a branch along it ───────────┘
//! ```
//!
//! Any row can be computed on any thread or machine: it depends on the problem alone. Along the row of a grid
//! branches are followed in the second parameter, through their folds and changes of regime, and meet the
//! values of the grid exactly: one for each start, from the slip-stick wave of the row, and one through every
//! wave of the [`lattice`] that these do not meet.
//! Quasi-random points have no neighbours to come from: each is reached by itself. So is every point of a map of a system:
//! [`Motions`] begin anew at each. Where the plane is one of initial states, [`Attractors`] tells which of them settle on the
//! same; [`Draws`] begin at random, along a parameter.

mod attractors;
mod cell;
mod lattice;
mod line;
mod motion;
mod plane;
mod row;
mod shares;

pub use attractors::{Attractor, Attractors, SettledCell};
#[cfg(feature = "cli")]
pub(crate) use cell::NOT_REACHED;
pub use cell::{Cell, CellPoint, CellRow, Missing};
pub use line::MOST_POINTS;
pub use motion::{BasinColumns, MotionOutcome, Motions, OrbitMark, Settled, SettledColumns};
#[cfg(feature = "cli")]
pub(crate) use motion::{NONE, UNDECIDED};
pub use plane::MapPlane;
pub use row::Rows;
pub use shares::Draws;
