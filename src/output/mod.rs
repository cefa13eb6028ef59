//! What a run leaves behind: tables, the restart file, pictures.

pub mod curve_folder;
pub mod folder;
pub mod map_folder;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod plots;
pub mod tables;
