//! Stability of a wave: its whole spectrum from the eigenfunction problem.
//!
//! [`characteristic`] turns a wave into analytic functions of λ whose zeros are the eigenvalues,
//! [`asymptotic`] says what they do at high frequency, [`spectrum`] finds all of them in a window,
//! [`eigenfunction`] gives their shapes, and [`track`] follows them along a branch.
//! [`verdict`] is the answer. [`crate::discretised`] is a check that shares nothing with these but the model.

pub mod asymptotic;
mod boundary;
pub mod characteristic;
mod course;
mod crossing;
mod dual;
pub mod eigenfunction;
mod material;
mod perturbation;
mod propagator;
mod segment;
mod separation;
mod sliding;
pub mod spectrum;
mod switch;
pub mod track;
pub mod verdict;

use nalgebra::Complex;

/// λ, and what depends on it.
type C64 = Complex<f64>;

const ZERO: C64 = C64::new(0.0, 0.0);
const ONE: C64 = C64::new(1.0, 0.0);
