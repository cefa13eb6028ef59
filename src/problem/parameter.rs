//! The parameters that a branch can be followed in.

use serde::{Deserialize, Serialize};

use super::Toward;

/// A parameter that a branch can be followed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Parameter {
    /// Mismatch δ.
    Mismatch,
    /// Friction coefficient f.
    Friction,
    /// Mass-proportional damping α.
    MassDamping,
    /// Stiffness-proportional damping β.
    StiffnessDamping,
    /// γ = ρR²Ω²/E.
    Gamma,
    /// Poisson's ratio ν.
    Nu,
    /// Ratio of the radii ξ.
    Xi,
    /// ε of the regularised friction law.
    Smoothing,
}

impl Parameter {
    /// All parameters, in the order of their columns.
    pub const ALL: [Parameter; 8] = [
        Parameter::Mismatch,
        Parameter::Friction,
        Parameter::MassDamping,
        Parameter::StiffnessDamping,
        Parameter::Gamma,
        Parameter::Nu,
        Parameter::Xi,
        Parameter::Smoothing,
    ];

    /// Name of the column in `branch.csv`.
    pub fn column(self) -> &'static str {
        match self {
            Parameter::Mismatch => "mismatch",
            Parameter::Friction => "friction",
            Parameter::MassDamping => "mass_damping",
            Parameter::StiffnessDamping => "stiffness_damping",
            Parameter::Gamma => "gamma",
            Parameter::Nu => "nu",
            Parameter::Xi => "xi",
            Parameter::Smoothing => "smoothing",
        }
    }

    /// Symbol for axes and messages.
    pub fn symbol(self) -> &'static str {
        match self {
            Parameter::Mismatch => "δ",
            Parameter::Friction => "f",
            Parameter::MassDamping => "α",
            Parameter::StiffnessDamping => "β",
            Parameter::Gamma => "γ",
            Parameter::Nu => "ν",
            Parameter::Xi => "ξ",
            Parameter::Smoothing => "ε",
        }
    }

    /// The parameter of a column of `branch.csv`; `None` when the column is no parameter.
    pub fn from_column(column: &str) -> Option<Self> {
        Parameter::ALL
            .into_iter()
            .find(|parameter| parameter.column() == column)
    }

    /// The way a branch leaves a Hopf point of steady sliding: damping ends the waves that friction
    /// drives.
    pub fn beyond_hopf(self) -> Toward {
        match self {
            Parameter::MassDamping | Parameter::StiffnessDamping => Toward::Down,
            _ => Toward::Up,
        }
    }

    /// The path of the value of this parameter in a problem file.
    pub(super) fn path(self) -> &'static str {
        match self {
            Parameter::Mismatch => "model.mismatch",
            Parameter::Friction => "model.friction",
            Parameter::MassDamping => "model.damping.mass",
            Parameter::StiffnessDamping => "model.damping.stiffness",
            Parameter::Gamma => "model.coefficients.gamma",
            Parameter::Nu => "model.coefficients.nu",
            Parameter::Xi => "model.coefficients.xi",
            Parameter::Smoothing => "model.friction_law.epsilon",
        }
    }

    /// Whether the model makes sense with this value, and the rule in words.
    pub(crate) fn admits(self, value: f64) -> (bool, &'static str) {
        match self {
            Parameter::Mismatch => (value > 0.0, "the mismatch must be greater than 0"),
            Parameter::Friction => (value >= 0.0, "the friction coefficient must be at least 0"),
            Parameter::MassDamping | Parameter::StiffnessDamping => {
                (value >= 0.0, "damping must be at least 0")
            }
            Parameter::Gamma => (value > 0.0, "gamma must be greater than 0"),
            Parameter::Nu => (
                value > -1.0 && value < 0.5,
                "Poisson's ratio must lie between -1 and 0.5, both excluded",
            ),
            Parameter::Smoothing => (value > 0.0, "the smoothing must be greater than 0"),
            Parameter::Xi => (value > 1.0, "the ratio of the radii must be greater than 1"),
        }
    }
}
