//! How the equations of a zone are solved.

use serde::{Deserialize, Serialize};

use crate::tube::model::FrictionLaw;

/// How the equations of a zone are solved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Method {
    /// Closed form and matrix exponential: exact to rounding, for friction that does not depend on
    /// the velocity.
    Exact,
    /// Multiple shooting: an explicit Runge–Kutta method of order 8 with its variational equations.
    Shooting {
        /// Relative and absolute tolerance of a step.
        tolerance: f64,
    },
    /// Gauss–Legendre collocation on an adapted mesh in every zone.
    Collocation {
        /// Mesh intervals in a zone.
        intervals: usize,
        /// Collocation points in an interval: the order is twice that.
        degree: usize,
    },
}

/// Largest number of mesh intervals in a zone.
pub(crate) const MAX_INTERVALS: usize = 2000;
/// Largest number of collocation points in an interval.
pub(crate) const MAX_DEGREE: usize = 7;

impl Method {
    /// The cheapest method that is exact for the law, or accurate to 1e-12.
    pub(crate) fn cheapest(law: FrictionLaw) -> Method {
        match law {
            FrictionLaw::Coulomb | FrictionLaw::Static { .. } => Method::Exact,
            FrictionLaw::Stribeck { .. } => Method::Shooting { tolerance: 1e-13 },
            FrictionLaw::Regularised { .. } => Method::Collocation {
                intervals: 400,
                degree: 4,
            },
        }
    }
}
