//! A branch of waves in one parameter: first wave, steps, events, points and labels.

mod begin;
mod change;
pub mod compare;
pub mod conditioning;
mod events;
pub mod first_wave;
pub mod follow;
mod item;
mod iterator;
pub mod passage;
mod point;
mod progress;
pub mod row;
pub mod run;
mod saved;
mod slip_stick;
pub mod special;
pub mod wanted;

pub use change::{NotEntered, beyond};
pub use iterator::Branch;
pub use point::*;
pub use saved::SavedWave;
pub use slip_stick::polish;
