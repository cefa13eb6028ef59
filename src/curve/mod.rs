//! Curves of events in two parameters.
//!
//! An event of a branch — a fold, a change of regime, a Hopf point — moves along a curve when a second
//! parameter is let go. [`system`] poses it, the walker of [`crate::continuation`] follows it,
//! and at every point all other inequalities of the wave are verified, as on a branch. On the way,
//! points of codimension two are located:
//!
//! | type | point | test function |
//! |---|---|---|
//! | `GR+RV`, `LP+GR`, … | another margin vanishes: two events at once | the margin |
//! | `GR+LP`, `HB+LP`, … | the wave has a fold too | det F_x |
//! | `CP` | cusp: the curve of folds turns round | (p₁′, p₂′) · (−wᵀF_{p₂}, wᵀF_{p₁}) |
//! | `BT` | ω → 0 in sector 0 or k/2 | ω |
//!
//! where wᵀF_x = 0 along the folds: from F_x x′ + F_p p′ = 0 it follows that wᵀF_p p′ = 0, so that p′ is
//! a multiple of (−wᵀF_{p₂}, wᵀF_{p₁}), and the factor changes sign where the curve has its cusp.
//!
//! Where another margin vanishes the wave changes its regimes. A change of regime that is followed
//! goes on as one of the next wave, if the candidates of the switching table have one on which all
//! inequalities hold: the same margin vanishes there. Folds and Hopf points end: the parameter is
//! stationary at the opening of a zone, and its spectrum is not the continuation of the one before.

mod follow;
mod point;
mod regions;
mod run;
mod saved;
pub mod start;
pub mod system;
mod whole;

pub use follow::{Gone, Refusal, What};
pub use point::{Limits, Name, Point, PointType, Region};
pub use run::{Run, Singular, follow};
pub use saved::{End, Found, Head, Next, Reason, State, Step};
pub use whole::Curve;
