//! A branch of periodic orbits of a user's system in one parameter: first orbit, points, labels and events; and
//! [`scan`], what motions settle on without following anything, with their Lyapunov [`exponents`].

mod begin;
pub mod equilibrium;
pub mod exponents;
mod point;
pub mod row;
pub mod run;
pub mod runner;
mod saved;
pub mod scan;

pub use begin::{NamedOrbit, NoFirstPoint, come_to};
pub use point::{OrbitEvent, OrbitPoint};
pub use run::{EarlierPoint, Note, OrbitItem, OrbitRunner};
pub use saved::LabelledOrbit;
