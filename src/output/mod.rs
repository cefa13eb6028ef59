//! What a run leaves behind: tables, the restart file, pictures.

pub mod folder;
pub mod npy;
pub mod plots;
pub mod simulation;
pub mod tables;
pub mod vtk;
