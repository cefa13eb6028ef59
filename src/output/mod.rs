//! What is left behind: tables, checkpoints and pictures, in folders.

#[cfg(feature = "cli")]
pub(crate) mod accuracy;
#[cfg(feature = "cli")]
pub(crate) mod certify;
#[cfg(feature = "cli")]
pub(crate) mod curve;
#[cfg(feature = "cli")]
pub(crate) mod map;
#[cfg(feature = "cli")]
pub(crate) mod npy;
#[cfg(feature = "cli")]
pub(crate) mod origin;
#[cfg(feature = "parquet")]
pub(crate) mod parquet;
#[cfg(feature = "cli")]
pub(crate) mod pictures;
#[cfg(feature = "cli")]
pub(crate) mod render;
#[cfg(feature = "cli")]
pub(crate) mod report;
#[cfg(feature = "cli")]
pub mod run;
#[cfg(feature = "cli")]
pub(crate) mod simulation;
#[cfg(feature = "cli")]
pub(crate) mod steady;
#[cfg(feature = "cli")]
pub mod store;
#[cfg(feature = "cli")]
pub(crate) mod vtk;
mod words;
