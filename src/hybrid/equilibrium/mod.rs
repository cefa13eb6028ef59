//! A branch of equilibria of a user's system in one parameter: first equilibrium, points, labels and events.

mod begin;
mod point;
pub mod row;
pub mod run;

pub use begin::{NamedEquilibrium, NoEquilibriumStart};
pub use point::{EquilibriumEvent, EquilibriumNote, EquilibriumPoint, LabelledEquilibrium};
pub use run::{EquilibriumItem, EquilibriumRunner};
