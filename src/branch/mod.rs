//! A branch of waves in one parameter: first wave, steps, events, points and labels.

mod begin;
pub mod conditioning;
pub mod first_wave;
mod item;
mod iterator;
pub mod orbit;
pub mod passage;
mod point;
mod progress;
pub mod row;
pub mod run;
mod saved;
mod slip_stick;
pub mod special;
pub mod wanted;

pub use iterator::Branch;
pub use orbit::NotEntered;
pub use point::*;
pub use saved::SavedWave;
pub use slip_stick::polish;
