//! What is left behind: tables, checkpoints and pictures, in folders.

pub mod accuracy;
pub mod curve;
pub mod map;
pub mod npy;
#[cfg(feature = "parquet")]
pub mod parquet;
pub(crate) mod pictures;
pub(crate) mod render;
pub mod run;
pub mod simulation;
pub mod store;
pub mod vtk;
mod words;
