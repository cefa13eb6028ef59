//! Claims about the waves, through the library alone: figures of an independent program, closed
//! forms, symmetries, an independent integration, derivatives against differences, and refusals.
//!
//! Every module is one claim. `cargo test --release --test all waves:: -- --nocapture` shows the errors observed.

mod admissibility;
pub mod branches;
mod close_events;
mod closed_form;
mod closing;
mod conditioning;
mod damping;
mod down_and_up;
mod ends;
mod folds;
mod hopf;
mod impact;
mod integration;
mod jacobian;
mod landing;
mod material;
mod opening;
mod reference;
mod refusals;
mod scaling;
mod start;
mod translation;
mod tube;
mod uncoupled;

use crate::observed;
