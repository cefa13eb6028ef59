//! The laws of the model: friction, impact and damping.

use serde::{Deserialize, Serialize};

/// Friction coefficient as a function of the sliding velocity v = |1 − V̇|; f is [`Model::friction`].
///
/// [`Model::friction`]: super::Model::friction
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FrictionLaw {
    /// f whatever the velocity, and in stick.
    #[default]
    Coulomb,
    /// f in sliding, ratio·f in stick.
    Static {
        /// Static by kinetic coefficient, at least 1.
        ratio: f64,
    },
    /// f·(1 + (ratio − 1)e^{−v/velocity}): from ratio·f at rest down to f.
    Stribeck {
        /// Static by kinetic coefficient, at least 1.
        ratio: f64,
        /// Velocity over which friction falls, in units of RΩ, greater than 0.
        velocity: f64,
    },
    /// f·tanh((1 − V̇)/ε): no stick, the surface creeps instead.
    Regularised {
        /// ε > 0, in units of RΩ.
        epsilon: f64,
    },
}

impl FrictionLaw {
    /// Static by kinetic coefficient: friction holds up to this times fP in stick.
    pub(crate) fn static_ratio(self) -> f64 {
        match self {
            FrictionLaw::Coulomb | FrictionLaw::Regularised { .. } => 1.0,
            FrictionLaw::Static { ratio } | FrictionLaw::Stribeck { ratio, .. } => ratio,
        }
    }

    /// ε of the regularised law; zero for every other.
    pub fn smoothing(self) -> f64 {
        match self {
            FrictionLaw::Regularised { epsilon } => epsilon,
            _ => 0.0,
        }
    }

    /// Whether friction in sliding does not depend on the velocity: the flow has a closed form.
    pub fn piecewise_linear(self) -> bool {
        matches!(self, FrictionLaw::Coulomb | FrictionLaw::Static { .. })
    }

    /// Whether the friction force jumps at release, and V̈ with it.
    pub(crate) fn jumps_at_release(self) -> bool {
        matches!(self, FrictionLaw::Static { .. })
    }
}

/// Law of the impact that ends a separation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Impact {
    /// V̇ is continuous at landing.
    #[default]
    Frictionless,
    /// The impulse of landing carries friction: m_a[V̇] = ±f m_b|U̇⁻|, towards V̇ = 1 and not
    /// beyond.
    Coulomb,
}

/// Viscous damping: (M) has αU̇ and αV̇, and U + βU̇ and V + βV̇ in all its elastic terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Damping {
    /// Mass-proportional part α ≥ 0, in units of Ω.
    pub mass: f64,
    /// Stiffness-proportional part β ≥ 0, in units of 1/Ω.
    pub stiffness: f64,
}
