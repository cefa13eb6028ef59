//! A branch of periodic orbits of a user's system in one parameter: first orbit, points, labels and events.

mod begin;
mod point;
pub mod row;
pub mod run;
mod saved;

pub use begin::{Named, NoStart};
pub use point::{Note, OrbitEvent, OrbitPoint};
pub use run::{Item, Runner};
pub use saved::LabelledOrbit;
