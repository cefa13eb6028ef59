//! Claims about the stability of waves, through the library alone: figures of an independent
//! program, symmetries, counts by a second method, closed forms at high frequency, extremes.
//!
//! Every module is one claim. `cargo test --release --test all stability:: -- --nocapture` shows the errors observed.

mod allowance;
mod beside_the_axis;
mod completeness;
mod conjugates;
mod crossings;
mod derivative;
mod eigenfunctions;
mod extremes;
mod folds;
mod high_frequency;
mod landing;
mod material;
mod material_ring;
mod reference;
mod scaling;
mod seeds;
mod translation;
mod uncertainty;
mod velocity;
mod verdict;
mod wavelength;
mod waves;

use crate::observed;
