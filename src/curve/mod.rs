//! Curves of events in two parameters.
//!
//! An event of a branch — a fold, a change of regime, a Hopf point — moves along a curve when a second
//! parameter is let go. What orbits it belongs to, [`ParameterPlane`] says: waves of a [`WavesInPlane`], [`OrbitsInPlane`] of a user's
//! system, or its [`EquilibriaInPlane`]. [`system`] poses it, the walker of [`crate::continuation`] follows it,
//! and at every point all other inequalities of the orbit are verified, as on a branch. On the way,
//! points of codimension two are located:
//!
//! | type | point | test function |
//! |---|---|---|
//! | `GR+RV`, `LP+GR`, … | another margin vanishes: two events at once | the margin |
//! | `GR+LP`, `HB+LP`, … | the wave has a fold too | det F_x |
//! | `CP` | cusp: the curve of folds turns round | (p₁′, p₂′) · (−wᵀF_{p₂}, wᵀF_{p₁}) |
//! | `BT` | ω → 0 in sector 0 or k/2 | ω |
//! | `GH` | of equilibria: the first Lyapunov coefficient of a Hopf point is zero | it, without its poles |
//! | `ZH`, `HH` | of equilibria: a pair ± iω beside an eigenvalue zero, or beside another pair | det, sums of pairs |
//! | `R1`, `R2`, `R3`, `R4` | a pair of multipliers is e^(±2πi/n) | cosine of its angle |
//! | `HB+BE`, `GH`, … | the orbits shrink to a point: the curve ends | its limit, by a polynomial in their size |
//!
//! where wᵀF_x = 0 along the folds: from F_x x′ + F_p p′ = 0 it follows that wᵀF_p p′ = 0, so that p′ is
//! a multiple of (−wᵀF_{p₂}, wᵀF_{p₁}), and the factor changes sign where the curve has its cusp.
//!
//! Where another margin vanishes the wave changes its regimes. A change of regime that is followed
//! goes on as one of the next wave, if the candidates of the switching table have one on which all
//! inequalities hold: the same margin vanishes there. Folds and Hopf points end: the parameter is
//! stationary at the opening of a zone, and its spectrum is not the continuation of the one before.

mod closing;
mod entry;
mod equilibria;
mod equilibrium_start;
mod event;
mod follow;
mod located;
mod memo;
mod null_pair;
mod orbits;
mod plane;
mod point;
mod regions;
mod run;
mod saved;
pub mod search;
pub mod start;
pub mod system;
mod tube;
mod watched;
mod whole;

pub use equilibria::{CriticalEquilibrium, EquilibriaInPlane};
pub use equilibrium_start::{find_of_equilibria, labelled_of_equilibria};
pub use event::CurveRefusal;
pub use orbits::OrbitsInPlane;
pub use plane::{
    EventCondition, EventCurves, NotEvaluated, ParameterOf, ParameterPlane, PlaneNames,
    PlaneOfOrbits, SpectralEvents, Test, TestValues,
};
pub use point::{CurveLimits, CurvePoint, Gone, PointType, Region, RegionName, What};
pub use run::{CurveRun, Singular, follow};
pub use saved::{CurveEnd, CurveEndReason, CurveHead, CurveState, CurveStep, Next, SolvedPoint};
pub use tube::{BlochPair, WavesInPlane};
pub use whole::WholeCurve;
