//! Numerical continuation and bifurcation of friction-driven travelling waves.
//!
//! An elastic tube is pressed on a rigid shaft that turns inside it. Waves of stick, slip, reverse
//! slip and separation run round the contact — the squeal of a brake. This crate follows branches
//! of such waves in a parameter, verifies at every point that contact and friction laws hold, and
//! locates every change of the sequence of regimes on the way. It implements and extends
//! Q.S. Nguyen, A. Oueslati, A. Steindl, A. Teufel, H. Troger, C. R. Mecanique 336 (2008).
//!
//! A branch is an iterator of points, the special ones with their events:
//!
//! ```
//! use brakewave::{Branch, EventType, problem};
//!
//! let text = "(
//!     model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2),
//!     wave: (mode: 4, start: Fast),
//!     continuation: (parameter: Mismatch, range: (0.045, 0.2), toward: Down),
//! )";
//! let problem = problem::parse(text, "mode 4")?;
//! let branch = Branch::follow(&problem, problem.continuation(text, "mode 4")?)?;
//! let mut events = branch.filter_map(|point| point.event);
//! let take_off = events.find(|event| event.kind == EventType::GR);
//! let mismatch = take_off.map(|event| event.model.mismatch).unwrap_or_default();
//! assert!((mismatch - 0.050228410362756).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Data flows one way, and what stands further right is imported by nothing further left:
//!
//! ```text
//! linalg ─► continuation ─► orbit ─┬─► tube ───┬─► problem ─┬─► branch ─┬─► certify, curve, map, discretised, accuracy
//!                                  └─► affine ─┘      ▲     └─► hybrid ─┘           │
//! tube::model ─► simulation ──────────────────────────┤                             └─► output ─► cli
//! interval ───────────────────────────────────────────┘                      table ──────┘
//! ```
//!
//! - [`linalg`] has what is asked of matrices; [`continuation`] follows zero curves of any system of equations;
//! - [`orbit`] follows a branch of periodic orbits of any hybrid system, change by change, event by event;
//! - [`tube`] is the tube on its shaft as such a system: model, flows, waves, stability, steady sliding;
//! - [`affine`] has hybrid systems that a user writes down: expressions, flows, motions, equilibria, orbits.
//!   It and the tube never import each other;
//! - [`simulation`] moves a ring or the whole tube in time, with the model and nothing else of the tube, so that
//!   agreement is evidence;
//! - [`problem`] reads and checks problem files;
//! - [`branch`] follows waves in one parameter: first wave, changes of regime, points and labels;
//! - [`hybrid`] does so with orbits of a user's system, and lays motions side by side in a scan;
//! - [`interval`] is arithmetic that rounds outwards, [`certify`] proves in it the special points that a
//!   branch has located;
//! - [`curve`] follows one event in two parameters, [`map`] lays branches through a plane of them, or
//!   motions of a system at its points;
//! - [`discretised`] has the eigenvalues of a ring of points, as a check;
//! - `accuracy` runs one problem by every method and compares errors and times;
//! - `messages` makes sentences of events, refusals and ends, which are data everywhere else;
//! - `table` turns structures into rows of CSV and back, `output` keeps them in folders and draws
//!   pictures, `cli` is the command line.

#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[cfg(feature = "cli")]
mod accuracy;
pub mod affine;
pub mod branch;
pub mod certify;
#[cfg(feature = "cli")]
pub mod cli;
pub mod continuation;
pub mod curve;
pub mod discretised;
pub mod hybrid;
pub mod interval;
pub mod linalg;
pub mod map;
mod messages;
pub mod orbit;
#[cfg(feature = "cli")]
pub mod output;
pub mod problem;
pub mod simulation;
// results and messages need what nothing else does
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
mod table;
pub mod tube;

pub use branch::{Branch, BranchPoint, Event, EventType};
pub use problem::Problem;
pub use tube::model::{Model, Parameter};
pub use tube::stability::spectrum::Spectrum;
pub use tube::wave::Wave;
