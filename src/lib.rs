//! Numerical continuation and bifurcation of friction-driven travelling waves.
//!
//! An elastic tube is pressed on a rigid shaft that turns inside it. Waves of stick, slip, reverse
//! slip and separation run round the contact — the squeal of a brake. This crate follows branches
//! of such waves in a parameter, proves at every point that contact and friction laws hold, and
//! locates every change of the sequence of regimes on the way. It implements and extends
//! Q.S. Nguyen, A. Oueslati, A. Steindl, A. Teufel, H. Troger, C. R. Mecanique 336 (2008).
//!
//! Data flows one way:
//!
//! ```text
//! problem ──► model ──► flow ──► wave ──► branch ──► output
//!  RON file   a b D g h  exact    boundary-  first wave,   tables,
//!             signature  flow,    value      events, legs, restart,
//!             switches   signs    problem    labels        pictures
//!                                              ▲
//!                                        continuation: newton, arclength, walk
//! ```
//!
//! - [`problem`] reads and validates problem files;
//! - [`model`] has the coefficients, the regimes and the table of switches between them;
//! - [`flow`] is the exact flow of one regime with its derivatives, and proofs of sign;
//! - [`wave`] poses a wave as a boundary-value problem for one signature, has its closed form, examines
//!   it, and finds candidates for its successor;
//! - [`continuation`] follows curves and knows nothing of waves; [`linalg`] serves it;
//! - [`branch`] follows waves in one parameter: first wave, changes of regime, points and labels;
//! - `accuracy` runs one problem by every method and compares errors and times;
//! - [`steady`] has the stability of steady sliding, where the waves come from;
//! - [`curve`] follows one event in two parameters;
//! - [`map`] lays branches through a plane of two parameters;
//! - [`simulation`] moves a ring or the whole tube in time, with the model and none of the above;
//! - `table` turns structures into rows of CSV and back;
//! - [`output`] writes them, [`cli`] is the command line.

#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(not(feature = "cli"), allow(dead_code))] // what only results and messages need
#![deny(clippy::print_stdout, clippy::print_stderr)]
mod accuracy;
pub mod branch;
#[cfg(feature = "cli")]
pub mod cli;
pub mod continuation;
pub mod curve;
pub mod discretised;
pub mod flow;
pub mod linalg;
pub mod map;
pub mod model;
pub mod output;
pub mod problem;
pub mod simulation;
pub mod stability;
pub mod steady;
mod table;
pub mod wave;
