//! Error against run time: one problem by every method and a ladder of its settings.
//!
//! The branch of the problem is followed by each method in turn. Events are paired with those of the
//! reference in their order along the branch, waves at the user points and at the end of the range,
//! where the parameter is the same to the last digit. The reference is the exact flow; for a slip-stick
//! wave under Coulomb friction it is itself compared with the closed form in higher precision. Under
//! a friction law without an exact flow the reference is collocation of order 12 on a fine mesh.
//!
//! The discretised ring has no branch and no switching points: it is solved at each of those
//! waves that has no separation, and compared in speed and eigenvalues.
//!
//! Orbits of a system are followed by its exact flow, where it has one, and by Taylor series; single ones are integrated
//! by a Runge–Kutta method. The reference are Taylor series with a tolerance below rounding.

mod course;
mod measure;
mod orbits;
mod rung;
mod waves;

pub(crate) use course::{MeasurementLimits, Measurements};
pub(crate) use measure::{MeasuredFamily, Missed};
pub(crate) use orbits::OrbitBranch;
pub(crate) use rung::{Rung, RungRow};
pub(crate) use waves::WaveBranch;
