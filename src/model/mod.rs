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
pub mod friction;
pub mod signature;

use serde::{Deserialize, Serialize};

use crate::branch::ParameterValues;
use crate::problem::{FrictionLaw, Impact, Parameter};
use coefficients::{Coefficients, Geometry};

/// Where the coefficients of (M) come from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Source {
    /// Computed from the tube.
    Geometry(Geometry),
    /// Given as numbers.
    Given(Coefficients),
}

/// The numbers that enter the equations of one wave. The same structure holds their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parameters {
    /// a, b, D, g, h of (M).
    pub coefficients: Coefficients,
    /// Friction coefficient f.
    pub friction: f64,
    /// Mismatch δ.
    pub mismatch: f64,
    /// Mass-proportional damping α.
    pub mass_damping: f64,
    /// Stiffness-proportional damping β.
    pub stiffness_damping: f64,
    /// ε of the regularised friction law; zero for every other.
    pub smoothing: f64,
}

impl Parameters {
    /// The same numbers seen in the direction of the shaft (+1) or against it (−1).
    pub fn seen(mut self, direction: f64) -> Parameters {
        self.coefficients.coupling *= direction;
        self
    }
}

/// A model with all its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Origin of a, b, D, g, h.
    pub source: Source,
    /// Friction coefficient f.
    pub friction: f64,
    /// Mismatch δ.
    pub mismatch: f64,
    /// Mass-proportional damping α.
    pub mass_damping: f64,
    /// Stiffness-proportional damping β.
    pub stiffness_damping: f64,
    /// Impact law.
    pub impact: Impact,
    /// Friction law.
    #[serde(default)]
    pub law: FrictionLaw,
}

impl Model {
    /// An undamped tube with frictionless impact under Coulomb's law.
    pub const fn tube(geometry: Geometry, friction: f64, mismatch: f64) -> Model {
        Model {
            source: Source::Geometry(geometry),
            friction,
            mismatch,
            mass_damping: 0.0,
            stiffness_damping: 0.0,
            impact: Impact::Frictionless,
            law: FrictionLaw::Coulomb,
        }
    }

    /// The numbers of the equations at these parameters.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            coefficients: match self.source {
                Source::Geometry(geometry) => geometry.coefficients(),
                Source::Given(coefficients) => coefficients,
            },
            friction: self.friction,
            mismatch: self.mismatch,
            mass_damping: self.mass_damping,
            stiffness_damping: self.stiffness_damping,
            smoothing: self.value(Parameter::Smoothing).unwrap_or(0.0),
        }
    }

    /// Value of one parameter; `None` for γ, ν, ξ where the coefficients were
    /// given, and for ε of a law without.
    pub fn value(&self, parameter: Parameter) -> Option<f64> {
        let geometry = match self.source {
            Source::Geometry(geometry) => Some(geometry),
            Source::Given(_) => None,
        };
        match parameter {
            Parameter::Mismatch => Some(self.mismatch),
            Parameter::Friction => Some(self.friction),
            Parameter::MassDamping => Some(self.mass_damping),
            Parameter::StiffnessDamping => Some(self.stiffness_damping),
            Parameter::Gamma => geometry.map(|geometry| geometry.gamma),
            Parameter::Nu => geometry.map(|geometry| geometry.nu),
            Parameter::Xi => geometry.map(|geometry| geometry.xi),
            Parameter::Smoothing => match self.law {
                FrictionLaw::Regularised { epsilon } => Some(epsilon),
                _ => None,
            },
        }
    }

    /// The same model with one parameter changed. γ, ν, ξ of given coefficients stay as they are.
    pub fn with(mut self, parameter: Parameter, value: f64) -> Model {
        match (parameter, &mut self.source) {
            (Parameter::Mismatch, _) => self.mismatch = value,
            (Parameter::Friction, _) => self.friction = value,
            (Parameter::MassDamping, _) => self.mass_damping = value,
            (Parameter::StiffnessDamping, _) => self.stiffness_damping = value,
            (Parameter::Gamma, Source::Geometry(geometry)) => geometry.gamma = value,
            (Parameter::Nu, Source::Geometry(geometry)) => geometry.nu = value,
            (Parameter::Xi, Source::Geometry(geometry)) => geometry.xi = value,
            (Parameter::Smoothing, _) => {
                if let FrictionLaw::Regularised { epsilon } = &mut self.law {
                    *epsilon = value;
                }
            }
            (_, Source::Given(_)) => {}
        }
        self
    }

    /// Whether material damping enters a wave posed in a parameter, be it at β = 0 where β is that
    /// parameter.
    pub fn has_material_damping(&self, parameter: Parameter) -> bool {
        self.stiffness_damping > 0.0 || parameter == Parameter::StiffnessDamping
    }

    /// Derivative of [`Model::parameters`] with respect to one parameter.
    pub fn derivative(&self, parameter: Parameter) -> Parameters {
        let mut derivative = Parameters::default();
        match (parameter, &self.source) {
            (Parameter::Mismatch, _) => derivative.mismatch = 1.0,
            (Parameter::Friction, _) => derivative.friction = 1.0,
            (Parameter::MassDamping, _) => derivative.mass_damping = 1.0,
            (Parameter::Smoothing, _) => derivative.smoothing = 1.0,
            (Parameter::Gamma, Source::Geometry(geometry)) => {
                derivative.coefficients = geometry.derivative_in_gamma();
            }
            (Parameter::Nu, Source::Geometry(geometry)) => {
                derivative.coefficients = geometry.derivative_in_nu();
            }
            (Parameter::Xi, Source::Geometry(geometry)) => {
                derivative.coefficients = geometry.derivative_in_xi();
            }
            (Parameter::StiffnessDamping, _) => derivative.stiffness_damping = 1.0,
            (_, Source::Given(_)) => {}
        }
        derivative
    }

    /// Speed c = ±√a(1 + e) of a wave of excess speed e; it has the sign of D.
    pub fn speed(&self, excess: f64) -> f64 {
        self.parameters().coefficients.a.sqrt() * (1.0 + excess) * self.direction()
    }

    /// Sign of D, and of the speed of waves.
    pub fn direction(&self) -> f64 {
        self.parameters().coefficients.coupling.signum()
    }

    /// The parameters by column name, for tables.
    pub fn values(&self) -> ParameterValues {
        ParameterValues {
            mismatch: self.mismatch,
            friction: self.friction,
            mass_damping: self.mass_damping,
            stiffness_damping: self.stiffness_damping,
            gamma: self.value(Parameter::Gamma),
            nu: self.value(Parameter::Nu),
            xi: self.value(Parameter::Xi),
            smoothing: self.value(Parameter::Smoothing),
        }
    }
}
