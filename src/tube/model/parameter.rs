//! The parameters that a branch can be followed in: one table, from which headers, options, axes,
//! checks and derivatives are read.

use serde::{Deserialize, Serialize};

use super::coefficients::{Coefficients, Geometry};
use super::laws::FrictionLaw;
use super::range::AdmittedRange;
use super::{CoefficientSource, Constants, Model};

/// A parameter that a branch can be followed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Parameter {
    /// Mismatch δ > 0, in units of R.
    Mismatch,
    /// Friction coefficient f ≥ 0 of sliding.
    Friction,
    /// Mass-proportional damping α ≥ 0, in units of Ω.
    MassDamping,
    /// Stiffness-proportional damping β ≥ 0, in units of 1/Ω.
    StiffnessDamping,
    /// γ = ρR²Ω²/E > 0, of a model with the tube.
    Gamma,
    /// Poisson's ratio ν in (−1, ½), of a model with the tube.
    Nu,
    /// Outer by inner radius ξ > 1, of a model with the tube.
    Xi,
    /// ε > 0 of the regularised friction law, in units of RΩ.
    Smoothing,
}

/// What is known of a parameter.
struct Properties {
    parameter: Parameter,
    /// Name in tables and on the command line.
    column: &'static str,
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    words: &'static str,
    /// Symbol on axes and in messages.
    symbol: &'static str,
    /// Path in a problem file.
    path: &'static str,
    /// Values with which the model makes sense.
    range: AdmittedRange,
    rule: &'static str,
    /// What a model without it has instead, and how the problem file gives it one.
    absent: (&'static str, &'static str),
    /// Where its value stands; `None` in a model without it.
    place: fn(&mut Model) -> Option<&mut f64>,
    /// Derivative of the constants of the equations.
    derivative: fn(&Model) -> Constants,
}

/// Every model has the parameter.
const NEVER: (&str, &str) = ("", "");
/// The parameter is one of the tube.
const GIVEN: (&str, &str) = (
    "the coefficients are `Given`",
    "coefficients: Geometry(nu: .., xi: .., gamma: ..)",
);

/// So many parameters have had their columns side by side from the beginning.
const FIRST_COLUMNS: usize = 7;

/// The properties of each parameter, in the order of the columns in tables.
const TABLE: [Properties; 8] = [
    Properties {
        parameter: Parameter::Mismatch,
        column: "mismatch",
        words: "mismatch",
        symbol: "δ",
        path: "model.mismatch",
        range: AdmittedRange::above(0.0),
        rule: "the mismatch must be {}",
        absent: NEVER,
        place: |model| Some(&mut model.mismatch),
        derivative: |_| Constants {
            mismatch: 1.0,
            ..Constants::default()
        },
    },
    Properties {
        parameter: Parameter::Friction,
        column: "friction",
        words: "friction",
        symbol: "f",
        path: "model.friction",
        range: AdmittedRange::from(0.0),
        rule: "the friction coefficient must be {}",
        absent: NEVER,
        place: |model| Some(&mut model.friction),
        derivative: |_| Constants {
            friction: 1.0,
            ..Constants::default()
        },
    },
    Properties {
        parameter: Parameter::MassDamping,
        column: "mass_damping",
        words: "mass damping",
        symbol: "α",
        path: "model.damping.mass",
        range: AdmittedRange::from(0.0),
        rule: "damping must be {}",
        absent: NEVER,
        place: |model| Some(&mut model.damping.mass),
        derivative: |_| Constants {
            mass_damping: 1.0,
            ..Constants::default()
        },
    },
    Properties {
        parameter: Parameter::StiffnessDamping,
        column: "stiffness_damping",
        words: "stiffness damping",
        symbol: "β",
        path: "model.damping.stiffness",
        range: AdmittedRange::from(0.0),
        rule: "damping must be {}",
        absent: NEVER,
        place: |model| Some(&mut model.damping.stiffness),
        derivative: |_| Constants {
            stiffness_damping: 1.0,
            ..Constants::default()
        },
    },
    Properties {
        parameter: Parameter::Gamma,
        column: "gamma",
        words: "",
        symbol: "γ",
        path: "model.coefficients.gamma",
        range: AdmittedRange::above(0.0),
        rule: "gamma must be {}",
        absent: GIVEN,
        place: |model| match &mut model.source {
            CoefficientSource::Geometry { gamma, .. } => Some(gamma),
            CoefficientSource::Given { .. } => None,
        },
        derivative: |model| of_tube(model, Geometry::derivative_in_gamma),
    },
    Properties {
        parameter: Parameter::Nu,
        column: "nu",
        words: "Poisson's ratio",
        symbol: "ν",
        path: "model.coefficients.nu",
        range: AdmittedRange::above(-1.0).below(0.5),
        rule: "Poisson's ratio must lie {}",
        absent: GIVEN,
        place: |model| match &mut model.source {
            CoefficientSource::Geometry { nu, .. } => Some(nu),
            CoefficientSource::Given { .. } => None,
        },
        derivative: |model| of_tube(model, Geometry::derivative_in_nu),
    },
    Properties {
        parameter: Parameter::Xi,
        column: "xi",
        words: "radius ratio",
        symbol: "ξ",
        path: "model.coefficients.xi",
        range: AdmittedRange::above(1.0),
        rule: "the ratio of the radii must be {}",
        absent: GIVEN,
        place: |model| match &mut model.source {
            CoefficientSource::Geometry { xi, .. } => Some(xi),
            CoefficientSource::Given { .. } => None,
        },
        derivative: |model| of_tube(model, Geometry::derivative_in_xi),
    },
    Properties {
        parameter: Parameter::Smoothing,
        column: "smoothing",
        words: "smoothing",
        symbol: "ε",
        path: "model.friction_law.epsilon",
        range: AdmittedRange::above(0.0),
        rule: "the smoothing must be {}",
        absent: (
            "the friction law has no smoothing",
            "friction_law: Regularised(epsilon: 0.02)",
        ),
        place: |model| match &mut model.law {
            FrictionLaw::Regularised { epsilon } => Some(epsilon),
            _ => None,
        },
        derivative: |_| Constants {
            smoothing: 1.0,
            ..Constants::default()
        },
    },
];

/// Derivative in a parameter of the tube; zero where the coefficients are given.
fn of_tube(model: &Model, derivative: fn(&Geometry) -> Coefficients) -> Constants {
    let tube = model.source.geometry();
    Constants {
        coefficients: tube.as_ref().map(derivative).unwrap_or_default(),
        ..Constants::default()
    }
}

impl Parameter {
    /// All parameters, in the order of their columns.
    pub const ALL: [Parameter; TABLE.len()] = {
        let mut all = [Parameter::Mismatch; TABLE.len()];
        let mut index = 0;
        while index < TABLE.len() {
            all[index] = TABLE[index].parameter;
            assert!(
                all[index] as usize == index,
                "the table has the order of the enum"
            );
            index += 1;
        }
        all
    };

    const fn properties(self) -> &'static Properties {
        &TABLE[self as usize]
    }

    /// Name in tables and on the command line.
    pub const fn column(self) -> &'static str {
        self.properties().column
    }

    /// Whether its column stands at the end of a table: few problems have it.
    pub(crate) fn is_later(self) -> bool {
        self as usize >= FIRST_COLUMNS
    }

    /// Name on axes; empty where the symbol says all.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn words(self) -> &'static str {
        self.properties().words
    }

    /// Symbol on axes and in messages.
    pub fn symbol(self) -> &'static str {
        self.properties().symbol
    }

    /// The parameter of a column; `None` when the column is no parameter.
    pub(crate) fn from_column(column: &str) -> Option<Self> {
        Parameter::ALL
            .into_iter()
            .find(|parameter| parameter.column() == column)
    }

    /// Path of its value in a problem file.
    pub(crate) fn path(self) -> &'static str {
        self.properties().path
    }

    /// What a model without it has instead, and how the problem file gives it one.
    pub(crate) fn absent(self) -> (&'static str, &'static str) {
        self.properties().absent
    }

    /// Whether the model makes sense with this value, which may be infinite.
    pub(crate) fn admits(self, value: f64) -> bool {
        self.properties().range.admits(value)
    }

    /// The values that are admitted, in words.
    pub(crate) fn rule(self) -> String {
        self.properties().range.rule(self.properties().rule)
    }
}

impl Model {
    /// Value of a parameter; `None` where the model does not have it: γ, ν and ξ of given
    /// coefficients, and ε of a law without.
    pub fn value(mut self, parameter: Parameter) -> Option<f64> {
        (parameter.properties().place)(&mut self).copied()
    }

    /// The same model with one parameter changed, if it has that parameter.
    pub fn with(mut self, parameter: Parameter, value: f64) -> Model {
        if let Some(place) = (parameter.properties().place)(&mut self) {
            *place = value;
        }
        self
    }

    /// Derivative of [`Model::constants`] with respect to a parameter.
    pub fn derivative(&self, parameter: Parameter) -> Constants {
        (parameter.properties().derivative)(self)
    }
}
