//! What an event is compared with.

use serde::{Deserialize, Serialize};

use crate::branch::EventType;

/// Most expectations of a problem.
pub const MAX_EXPECTATIONS: usize = 1000;
/// Coarsest tolerance of an expectation: a figure a tenth off is another figure.
pub const MAX_EXPECTED_TOLERANCE: f64 = 0.1;

/// An event that must be found, with the numbers it must have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// Type of the event.
    pub event: EventType,
    /// Admitted difference: relative, absolute where the expected value is 0.
    pub tolerance: f64,
    /// Bloch sector, at most half the mode.
    pub sector: Option<usize>,
    /// Im λ at the crossing, in units of Ω.
    pub omega: Option<f64>,
    /// Wave speed c, signed, in units of Ω.
    pub speed: Option<f64>,
    /// Mismatch δ.
    pub mismatch: Option<f64>,
    /// Friction coefficient f.
    pub friction: Option<f64>,
    /// Mass-proportional damping α, in units of Ω.
    pub mass_damping: Option<f64>,
    /// Stiffness-proportional damping β, in units of 1/Ω.
    pub stiffness_damping: Option<f64>,
    /// γ = ρR²Ω²/E.
    pub gamma: Option<f64>,
    /// Poisson's ratio ν.
    pub nu: Option<f64>,
    /// Ratio of the radii ξ.
    pub xi: Option<f64>,
    /// ε of the regularised friction law.
    pub smoothing: Option<f64>,
    /// Regimes before the event, joined by `-`.
    pub regimes_before: Option<String>,
    /// Regimes after the event, joined by `-`.
    pub regimes_after: Option<String>,
    /// Label of the event.
    pub label: Option<usize>,
}

impl Expectation {
    /// Least and greatest value that passes for the expected one.
    pub fn admitted(&self, expected: f64) -> [f64; 2] {
        let width = match expected {
            0.0 => self.tolerance,
            _ => self.tolerance * expected.abs(),
        };
        [expected - width, expected + width]
    }

    /// The numbers to compare, each with the name of its column.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        [
            ("omega", self.omega),
            ("speed", self.speed),
            ("mismatch", self.mismatch),
            ("friction", self.friction),
            ("mass_damping", self.mass_damping),
            ("stiffness_damping", self.stiffness_damping),
            ("gamma", self.gamma),
            ("nu", self.nu),
            ("xi", self.xi),
            ("smoothing", self.smoothing),
        ]
        .into_iter()
        .filter_map(|(name, value)| value.map(|value| (name, value)))
        .collect()
    }
}
