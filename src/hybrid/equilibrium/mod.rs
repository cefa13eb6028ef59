//! A branch of equilibria of a user's system in one parameter: first equilibrium, points, labels and events.

pub(super) mod begin;
pub(super) mod birth;
mod point;
pub mod row;
pub mod run;

pub use begin::{NamedEquilibrium, NoEquilibriumStart};
pub use point::{EquilibriumEvent, EquilibriumPoint, LabelledEquilibrium};
pub use run::{EquilibriumItem, EquilibriumNote, EquilibriumRunner};
