//! Simulation in time: the ring (M) by finite differences, the whole tube by finite elements.
//!
//! Evidence that is independent of the rest: nothing here uses the exact flow, the boundary-value
//! problem of a wave or its eigenfunction problem. Both bodies know only the equations of motion and
//! the laws of contact and friction, which they solve node by node in each step without smoothing.
//!
//! ```text
//! profile ──► ring ──────┐
//! (a wave)    (M), finite │     motion          measures: speed, mode, regimes
//!             differences ├──►  either body ──► eigenvalues: growth of perturbations
//! steady ───► annulus ────┘     in time         checkpoint, snapshots
//! sliding     finite elements
//! ```

pub mod annulus;
pub mod course;
pub mod esprit;
pub mod growth;
pub mod line;
pub mod measure;
pub mod motion;
pub mod perturbations;
pub mod profile;
pub mod ring;
pub mod task;
