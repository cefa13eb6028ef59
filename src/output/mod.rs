//! What is left behind: tables, checkpoints and pictures, in folders.

#[cfg(feature = "cli")]
pub mod accuracy;
#[cfg(feature = "cli")]
pub mod curve;
#[cfg(feature = "cli")]
pub mod map;
#[cfg(feature = "cli")]
pub mod npy;
#[cfg(feature = "parquet")]
pub mod parquet;
#[cfg(feature = "cli")]
pub(crate) mod pictures;
#[cfg(feature = "cli")]
pub(crate) mod render;
#[cfg(feature = "cli")]
pub mod run;
#[cfg(feature = "cli")]
pub mod simulation;
#[cfg(feature = "cli")]
pub mod store;
#[cfg(feature = "cli")]
pub mod vtk;
mod words;
