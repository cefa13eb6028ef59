//! What a run leaves behind: tables, the restart file, pictures.

pub mod curve_folder;
pub mod folder;
pub mod map_folder;
pub mod npy;
#[cfg(feature = "parquet")]
pub mod parquet;
pub(crate) mod pictures;
pub(crate) mod render;
pub mod simulation;
pub mod store;
pub mod vtk;
mod words;
