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
//! Data flows one way, and what stands further left imports nothing from further right:
//!
//! ```text
//! linalg ─► continuation ─► orbit ─┐   ┌─► affine ─► problem      interval ─► problem, certify
//! model ───────────────────────────┴─► flow ─► wave ─► stability ─► problem ─► branch, hybrid ─► certify, curve, map,
//!   │                          └──► steady                  ▲           │       discretised, accuracy
//!   └─► simulation ─────────────────────────────────────────┘           └───────► output ─► cli
//!                                                              table ─────────────┘
//! ```
//!
//! - [`model`] has the parameters, the laws of friction and impact, the coefficients, the regimes and the
//!   table of switches between them;
//! - [`flow`] is the exact flow of one regime with its derivatives, and signs over whole zones;
//! - [`affine`] has hybrid systems that a user writes down: expressions, exact flows of affine modes, motions,
//!   equilibria;
//! - [`continuation`] follows zero curves of any system and knows nothing of waves; [`linalg`] serves it;
//! - [`wave`] poses a wave as a boundary-value problem for one signature, has its closed form, examines
//!   it, and finds candidates for its successor;
//! - [`stability`] has all eigenvalues of a wave from its eigenfunction problem, and the verdict;
//! - [`steady`] has the stability of steady sliding, where the waves come from;
//! - [`simulation`] moves a ring or the whole tube in time, with the model and none of the above, so that
//!   agreement is evidence;
//! - [`problem`] reads and checks problem files;
//! - [`orbit`] follows a branch of periodic orbits of any hybrid system, change by change, event by event;
//! - [`branch`] follows waves in one parameter: first wave, changes of regime, points and labels;
//! - [`hybrid`] follows orbits of a user's system in one parameter;
//! - [`interval`] is arithmetic that rounds outwards, [`certify`] proves in it the special points that a
//!   branch has located;
//! - [`curve`] follows one event in two parameters, [`map`] lays branches through a plane of them;
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
pub mod flow;
pub mod hybrid;
pub mod interval;
pub mod linalg;
pub mod map;
mod messages;
pub mod model;
pub mod orbit;
#[cfg(feature = "cli")]
pub mod output;
pub mod problem;
pub mod simulation;
pub mod stability;
pub mod steady;
// results and messages need what nothing else does
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
mod table;
pub mod wave;

pub use branch::{Branch, BranchPoint, Event, EventType};
pub use model::{Model, Parameter};
pub use problem::Problem;
pub use stability::spectrum::Spectrum;
pub use wave::Wave;
