//! Claims about the ways a zone can be solved and about the friction laws: methods that share
//! nothing but the model agree, each converges at its own order, limits of the laws are met.
//!
//! `cargo test --release --test all methods:: -- --nocapture` shows the errors observed.

mod agreement;
mod laws;
mod orders;
mod waves;

use crate::observed;
