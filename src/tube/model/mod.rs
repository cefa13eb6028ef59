//! The model (M): two coupled wave equations of the tube under unilateral contact and friction.
//!
//! With Û = U + βU̇, V̂ = V + βV̇ and ′ = ∂/∂φ,
//!
//! ```text
//! Ü + αU̇ − bÛ″ − DV̂′ + gÛ = P,      V̈ + αV̇ − aV̂″ + DÛ′ + hV̂ = Q,
//! P ≥ 0,  U ≥ δ,  P(U − δ) = 0,      |Q| ≤ fP,  Q(1 − V̇) = fP|1 − V̇|.
//! ```
//!
//! Lengths are measured by the inner radius R, stresses by E, time by 1/Ω.

pub mod coefficients;

#[cfg_attr(not(feature = "cli"), allow(dead_code))]
mod landing;
mod laws;
mod parameter;
pub(crate) mod range;
pub(crate) mod saved;
mod sectors;
pub mod signature;

use serde::{Deserialize, Serialize};

use coefficients::{Coefficients, Geometry};
pub(crate) use landing::Landing;
pub use laws::{Damping, FrictionLaw, Impact};
pub use parameter::Parameter;
pub use sectors::Sectors;

/// The constants of the equations of one wave. The same structure holds their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constants {
    /// a, b, D, g, h of (M).
    pub coefficients: Coefficients,
    /// Friction coefficient f of sliding.
    pub friction: f64,
    /// Mismatch δ, in units of R.
    pub mismatch: f64,
    /// Mass-proportional damping α, in units of Ω.
    pub mass_damping: f64,
    /// Stiffness-proportional damping β, in units of 1/Ω.
    pub stiffness_damping: f64,
    /// ε of the regularised friction law; zero for every other.
    pub smoothing: f64,
}

impl Constants {
    /// The same constants seen in the direction of the shaft (+1) or against it (−1).
    pub fn seen(mut self, direction: f64) -> Constants {
        self.coefficients.coupling *= direction;
        self
    }
}

/// The brake: an elastic tube in frictional contact with a rotating rigid shaft.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Origin of a, b, D, g, h.
    #[serde(rename = "coefficients")]
    pub source: CoefficientSource,
    /// Friction coefficient f ≥ 0.
    pub friction: f64,
    /// Mismatch δ > 0, in units of the inner radius R.
    pub mismatch: f64,
    /// Viscous damping α and β, both 0 unless given.
    #[serde(default)]
    pub damping: Damping,
    /// Law of the impact that ends a separation.
    #[serde(default)]
    pub impact: Impact,
    /// Law of friction; Coulomb's with one coefficient unless given.
    #[serde(default, rename = "friction_law")]
    pub law: FrictionLaw,
}

/// Where the coefficients of (M) come from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum CoefficientSource {
    /// Computed from the tube; see [`Geometry`].
    Geometry {
        /// Poisson's ratio ν in (−1, ½).
        nu: f64,
        /// Ratio of the radii ξ > 1.
        xi: f64,
        /// γ = ρR²Ω²/E > 0.
        gamma: f64,
    },
    /// Given as numbers, all dimensionless; see [`Coefficients`].
    Given {
        /// Square of the tangential wave speed, a > b.
        a: f64,
        /// Square of the radial wave speed, b > 0.
        b: f64,
        /// Coupling D ≠ 0 of the displacements.
        #[serde(rename = "D")]
        coupling: f64,
        /// Radial stiffness, g > 0.
        g: f64,
        /// Tangential stiffness, h > 0.
        h: f64,
    },
}

impl CoefficientSource {
    /// The tube; `None` where the coefficients are given.
    pub fn geometry(self) -> Option<Geometry> {
        match self {
            CoefficientSource::Geometry { nu, xi, gamma } => Some(Geometry { nu, xi, gamma }),
            CoefficientSource::Given { .. } => None,
        }
    }

    /// a, b, D, g, h.
    pub fn coefficients(self) -> Coefficients {
        match self {
            CoefficientSource::Geometry { nu, xi, gamma } => {
                Geometry { nu, xi, gamma }.coefficients()
            }
            CoefficientSource::Given {
                a,
                b,
                coupling,
                g,
                h,
            } => Coefficients {
                a,
                b,
                coupling,
                g,
                h,
            },
        }
    }
}

impl From<Geometry> for CoefficientSource {
    fn from(Geometry { nu, xi, gamma }: Geometry) -> CoefficientSource {
        CoefficientSource::Geometry { nu, xi, gamma }
    }
}

impl From<Coefficients> for CoefficientSource {
    fn from(given: Coefficients) -> CoefficientSource {
        let Coefficients {
            a,
            b,
            coupling,
            g,
            h,
        } = given;
        CoefficientSource::Given {
            a,
            b,
            coupling,
            g,
            h,
        }
    }
}

impl Model {
    /// An undamped tube with frictionless impact under Coulomb's law.
    pub const fn tube(geometry: Geometry, friction: f64, mismatch: f64) -> Model {
        let Geometry { nu, xi, gamma } = geometry;
        Model {
            source: CoefficientSource::Geometry { nu, xi, gamma },
            friction,
            mismatch,
            damping: Damping {
                mass: 0.0,
                stiffness: 0.0,
            },
            impact: Impact::Frictionless,
            law: FrictionLaw::Coulomb,
        }
    }

    /// The constants of the equations.
    pub fn constants(&self) -> Constants {
        Constants {
            coefficients: self.source.coefficients(),
            friction: self.friction,
            mismatch: self.mismatch,
            mass_damping: self.damping.mass,
            stiffness_damping: self.damping.stiffness,
            smoothing: self.law.smoothing(),
        }
    }

    /// Whether material damping enters a wave posed in a parameter, be it at β = 0 where β is that
    /// parameter.
    pub(crate) fn has_material_damping(&self, parameter: Parameter) -> bool {
        self.damping.stiffness > 0.0 || parameter == Parameter::StiffnessDamping
    }

    /// Speed c = ±√a(1 + e) of a wave of excess speed e; it has the sign of D.
    pub fn speed(&self, excess: f64) -> f64 {
        self.source.coefficients().a.sqrt() * (1.0 + excess) * self.direction()
    }

    /// Sign of D, and of the speed of waves.
    pub fn direction(&self) -> f64 {
        self.source.coefficients().coupling.signum()
    }
}
