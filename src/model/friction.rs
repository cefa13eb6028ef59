//! What the friction laws have in common.

use super::signature::Regime;
use crate::problem::{FrictionLaw, Method};

impl FrictionLaw {
    /// Static by kinetic coefficient: friction holds up to this times fP in stick.
    pub fn static_ratio(self) -> f64 {
        match self {
            FrictionLaw::Coulomb | FrictionLaw::Regularised { .. } => 1.0,
            FrictionLaw::Static { ratio } | FrictionLaw::Stribeck { ratio, .. } => ratio,
        }
    }

    /// Whether friction in sliding does not depend on the velocity: the flow has a closed form.
    pub fn piecewise_linear(self) -> bool {
        matches!(self, FrictionLaw::Coulomb | FrictionLaw::Static { .. })
    }

    /// Whether a regime occurs under the law: stick and sliding directions, or contact as a whole.
    pub fn has(self, regime: Regime) -> bool {
        let smooth = matches!(self, FrictionLaw::Regularised { .. });
        match regime {
            Regime::Separation => true,
            Regime::Contact => smooth,
            Regime::Stick | Regime::Slip | Regime::Reverse => !smooth,
        }
    }

    /// Whether the friction force jumps at release, and V̈ with it.
    pub fn jumps_at_release(self) -> bool {
        matches!(self, FrictionLaw::Static { .. })
    }

    /// The cheapest method that is exact for the law, or accurate to 1e-12.
    pub fn default_method(self) -> Method {
        match self {
            FrictionLaw::Coulomb | FrictionLaw::Static { .. } => Method::Exact,
            FrictionLaw::Stribeck { .. } => Method::Shooting { tolerance: 1e-13 },
            FrictionLaw::Regularised { .. } => Method::Collocation {
                intervals: 400,
                degree: 4,
            },
        }
    }
}
