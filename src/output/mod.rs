//! What is left behind: tables, checkpoints and pictures, in folders.

pub(crate) mod accuracy;
pub(crate) mod attractors;
pub(crate) mod certify;
pub(crate) mod curve;
pub(crate) mod equilibria;
pub(crate) mod layout;
pub(crate) mod motion;
pub(crate) mod npy;
pub(crate) mod orbits;
pub(crate) mod origin;
#[cfg(feature = "parquet")]
pub(crate) mod parquet;
pub(crate) mod pictures;
pub(crate) mod render;
pub(crate) mod report;
pub(crate) mod rows;
pub mod run;
pub(crate) mod scan;
pub(crate) mod simulation;
pub(crate) mod steady;
pub mod store;
pub(crate) mod theorem;
pub(crate) mod vtk;
pub(crate) mod waves;
