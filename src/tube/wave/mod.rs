//! A travelling wave as a boundary-value problem for one signature.
//!
//! Unknowns are, for each zone i, the state (Y_i, W_i) just after its entry and its duration T_i,
//! then the excess speed e = |c|/√a − 1, as ln e, and the continuation parameter: 3n + 2 numbers. Equations are, for each zone,
//! the matching of Y and of W with the next entry and the switching condition at its end, then
//! the period Σ T_i·|c| = 2π/k: 3n + 1. Matching zone by zone, instead of following the flow once
//! round, keeps the growth of one zone out of the others.
//!
//! | switch | switching condition at the end of the zone | W after it |
//! |---|---|---|
//! | release | hY = rfκ + (r − 1)fgδ − α | 1 |
//! | arrest, reversal | (W − 1)/T^m = 0 | 1 |
//! | take-off | P = 0 | W |
//! | landing, touch | (U − δ)/T^m = 0 | W, or W ± f m_b \|U̇\|/m_a with a Coulomb impact |
//! | arrested landing | (U − δ)/T^m = 0 | 1 |
//! | section | W = 0 | 0 |
//!
//! With material damping β > 0 ([`crate::tube::flow::material`]) every zone has a fourth unknown, the layer
//! G_i at its end, and a fourth equation, the matching of V̈ with the next entry: V̈ = 0 at both ends
//! of stick, of which the one at release takes the place of Q = fP. In stick G = 0.
//!
//! m is the order of the zero at the entry of the zone. Of W − 1: 2 after a release (V̈ = 0 there),
//! 1 after a reversal, an arrested landing or a release from
//! static friction. Of U − δ: 3 after take-off, 2 after a touch. Divided out, the zone may shrink to nothing and
//! beyond while the equations stay regular, which is how zones open and close along a branch: the
//! square-root law T ∝ √(δ* − δ) of a nascent zone is the parabola δ* − δ ∝ T² of its duration.

pub mod admissibility;
pub mod hopf;
mod layout;
mod margin;
pub mod precise;
pub mod profile;
mod residual;
pub mod start;
pub mod successor;

pub use crate::tube::flow::Flows;
pub(crate) use layout::width;
pub use layout::{Wave, WaveAt, WaveScales};
