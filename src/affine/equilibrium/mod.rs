//! Branches of equilibria of a hybrid system, through its modes and sliding modes.
//!
//! [`curve`] has the unknowns and equations of one mode, with derivatives from [`field`]; [`examine`] its guards and, by
//! [`spectrum`], the stability; `branch` makes it something that the engine follows: where a guard is zero at the
//! equilibrium that of a neighbouring mode goes on. [`extended`] locates folds, Hopf and branch points, [`normal_form`] has
//! the cycles that are born, of which [`cycle`] guesses one, as `boundary` those that grow from a boundary equilibrium, and
//! [`start`] the first equilibrium. [`plane`] has curves of
//! special equilibria in two parameters, [`codimension`] what vanishes where two of them meet; `monitor` has the values of
//! expressions that a problem asks for.

mod boundary;
mod branch;
pub mod codimension;
pub mod curve;
pub mod cycle;
mod examine;
mod extended;
mod field;
mod monitor;
pub mod normal_form;
pub mod plane;
mod spectrum;
pub mod start;

use std::fmt;

use serde::{Deserialize, Serialize};

pub use curve::{
    EquilibriumCurve, EquilibriumFailure, EquilibriumScales, EquilibriumSetting, RestMode,
};
pub use examine::{EquilibriumExamination, EquilibriumMargin};
pub use extended::{SpecialEquilibrium, boundary_near, fold_near};
pub use normal_form::Lyapunov;

/// What is positive at an admissible equilibrium.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EquilibriumGuard {
    /// Name of the mode.
    pub mode: String,
    /// The guard as the file has it, or the push that holds a sliding mode.
    pub guard: String,
}

impl fmt::Display for EquilibriumGuard {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} of `{}` at the equilibrium",
            self.guard, self.mode
        )
    }
}

/// Why an equilibrium is not admissible.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum VirtualEquilibrium {
    /// A guard is not positive.
    #[error("{guard} is {value:.3e}: it must be positive in its mode")]
    Guard {
        /// Which.
        guard: EquilibriumGuard,
        /// Its value, in the units of the system.
        value: f64,
    },
    /// A guard is zero but for rounding.
    #[error("{guard} is zero but for rounding: it must be positive in its mode")]
    Zero {
        /// Which.
        guard: EquilibriumGuard,
    },
    /// None is told to be negative.
    #[error("rounding decides whether the guards of the mode are positive at the equilibrium")]
    Undecided,
}

/// A change of stability of equilibria.
#[derive(Clone, Debug, PartialEq)]
pub enum EquilibriumBifurcation {
    /// A pair of eigenvalues is imaginary.
    Hopf {
        /// Their imaginary part, positive.
        omega: f64,
        /// The first Lyapunov coefficient; `None` where it has no value.
        lyapunov: Option<Lyapunov>,
    },
    /// An eigenvalue is zero other than at a fold: another branch passes.
    Branching,
    /// So many eigenvalues pass the imaginary axis together, not as one pair.
    Several {
        /// Two or more.
        count: usize,
        /// Whether some of them are complex.
        complex: bool,
    },
    /// The number of those that grow changes, and where is not known.
    Unlocated {
        /// Number before and beyond.
        growing: [usize; 2],
        /// Between these values of the parameter.
        between: [f64; 2],
    },
}

impl EquilibriumBifurcation {
    /// ω and l₁ of a Hopf point.
    pub fn hopf(&self) -> Option<(f64, Option<f64>)> {
        match self {
            EquilibriumBifurcation::Hopf { omega, lyapunov } => {
                Some((*omega, lyapunov.map(Lyapunov::value)))
            }
            _ => None,
        }
    }
}

impl fmt::Display for EquilibriumBifurcation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EquilibriumBifurcation::Hopf { omega, lyapunov } => {
                write!(f, "Hopf point, ω = {omega:.9}")?;
                match lyapunov.filter(|one| *one != Lyapunov::Vertical) {
                    Some(lyapunov) => write!(f, ", l₁ = {:.6e}: ", lyapunov.value())?,
                    None => f.write_str(": ")?,
                }
                match lyapunov {
                    Some(Lyapunov::Known(value)) if *value < 0.0 => f.write_str(
                        "supercritical, the cycles attract within the plane of the pair",
                    ),
                    Some(Lyapunov::Known(_)) => f.write_str("subcritical, the cycles repel within the plane of the pair"),
                    Some(Lyapunov::Undecided(_)) => {
                        f.write_str("the first Lyapunov coefficient is zero to rounding")
                    }
                    Some(Lyapunov::Vertical) => f.write_str(
                        "the mode is affine, its cycles are a vertical family at this value of the parameter",
                    ),
                    None => f.write_str("the first Lyapunov coefficient has no value"),
                }
            }
            EquilibriumBifurcation::Branching => {
                f.write_str("an eigenvalue passes zero: another branch of equilibria passes")
            }
            EquilibriumBifurcation::Several { count, .. } => {
                write!(f, "{count} eigenvalues pass the imaginary axis together")
            }
            EquilibriumBifurcation::Unlocated {
                growing: [before, after],
                between: [from, to],
            } if from == to => write!(
                f,
                "the number of eigenvalues that grow jumps from {before} to {after} at a kink of the rates"
            ),
            EquilibriumBifurcation::Unlocated {
                growing: [before, after],
                between: [from, to],
            } => write!(
                f,
                "the number of eigenvalues that grow changes from {before} to {after} between {from} and {to}: where is \
                 not known"
            ),
        }
    }
}

/// Ends of a branch of equilibria for reasons of the system itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum EquilibriumTermination {
    /// In no mode that a switch leads to there the system rests at the equilibrium.
    NoneBeyond {
        /// What is zero.
        guard: EquilibriumGuard,
    },
    /// The states grow without bound.
    Grows,
}

impl fmt::Display for EquilibriumTermination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EquilibriumTermination::Grows => f.write_str(
                "the states of the equilibrium grow without bound, while the parameter comes to a limit",
            ),
            EquilibriumTermination::NoneBeyond { guard } => write!(
                f,
                "the branch ends: in no mode to which {} of `{}` leads do equilibria go on from there",
                guard.guard, guard.mode
            ),
        }
    }
}
