//! What a run leaves behind: tables, the restart file, pictures.

pub mod folder;
pub mod plots;
pub mod tables;
