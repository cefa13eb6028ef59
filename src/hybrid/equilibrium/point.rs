//! What a branch of equilibria is made of, as plain data.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::affine::system::System;
use crate::linalg::Eigenvalue;
use crate::orbit::{EventType, Stability};
use crate::problem::compare::Occurrence;

/// One accepted point of a branch: a row of `branch.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumPoint {
    /// Running number from 1.
    pub point: usize,
    /// Label of a labelled point: the key of events and eigenvalues.
    pub label: Option<usize>,
    /// Leg it belongs to, from 1.
    pub leg: usize,
    /// Type of a special point.
    pub kind: Option<EventType>,
    /// Name of its mode.
    pub mode: String,
    /// Values of the parameters in the order of the file.
    pub parameters: Vec<f64>,
    /// The states.
    pub state: Vec<f64>,
    /// Names and values of the monitors, of those that have one.
    pub monitors: Vec<(String, Option<f64>)>,
    /// Stability.
    pub stable: Stability,
    /// Eigenvalues with a positive real part.
    pub unstable: usize,
    /// All eigenvalues, in a sliding mode those within its surface, the fastest growing first.
    pub eigenvalues: Vec<Eigenvalue>,
    /// Newton iterations spent on the point.
    pub newton: usize,
    /// Largest relative residual of the equations.
    pub residual: f64,
}

impl EquilibriumPoint {
    /// The eigenvalue that grows fastest; none in a surface of no dimension.
    pub fn leading(&self) -> Option<Complex<f64>> {
        let leading = self.eigenvalues.first().map(|one| one.value);
        leading.filter(|value| value.re.is_finite())
    }
}

/// A special point: a row of `events.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumEvent {
    /// Label of the point in `branch.csv`.
    pub label: usize,
    /// Type of the event.
    pub kind: EventType,
    /// Names and values of the parameters, then of the states, in the order of the file.
    pub parameters: Vec<(String, f64)>,
    /// See [`EquilibriumEvent::parameters`].
    pub state: Vec<(String, f64)>,
    /// Names and values of the monitors, of those that have one.
    pub monitors: Vec<(String, Option<f64>)>,
    /// The leading eigenvalue.
    pub leading: Option<Complex<f64>>,
    /// Imaginary part of the pair of a Hopf point.
    pub omega: Option<f64>,
    /// Its first Lyapunov coefficient.
    pub lyapunov: Option<f64>,
    /// Mode before the event, along the branch.
    pub regimes_before: String,
    /// Mode after the event, along the branch.
    pub regimes_after: String,
    /// Bound or honest estimate of the error of the located parameter.
    pub uncertainty: f64,
    /// A short sentence.
    pub what: String,
}

impl EquilibriumEvent {
    /// What can be expected of it.
    pub fn occurrence(&self) -> Occurrence {
        let leading = self.leading;
        let own = [
            ("re", leading.map(|value| value.re)),
            ("im", leading.map(|value| value.im)),
            ("omega", self.omega),
            ("lyapunov", self.lyapunov),
        ];
        let own = own.map(|(name, value)| (name.to_owned(), value));
        let named = self.parameters.iter().chain(&self.state);
        let named = named.map(|(name, value)| (name.clone(), Some(*value)));
        let monitors = self.monitors.iter().cloned();
        Occurrence {
            kind: self.kind,
            label: self.label,
            sector: None,
            numbers: own.into_iter().chain(named).chain(monitors).collect(),
            regimes: [self.regimes_before.clone(), self.regimes_after.clone()],
        }
    }

    /// A number of it by the name of its column.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.occurrence().number(name)
    }
}

/// An equilibrium in physical numbers: what a restart needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LabelledEquilibrium {
    /// Label.
    pub label: usize,
    /// Name of its mode.
    pub mode: String,
    /// The states.
    pub state: Vec<f64>,
    /// Values of the parameters.
    pub values: Vec<f64>,
    /// Of a branch point, how the states and the parameter change along the branch there, of whatever length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<Vec<f64>>,
}

impl LabelledEquilibrium {
    /// Whether it has all its numbers, all finite, and a mode of the system: a damaged file may say otherwise.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn is_whole(&self, system: &System) -> bool {
        let all = || self.state.iter().chain(&self.values);
        self.state.len() == system.source.states.len()
            && self.values.len() == system.source.parameters.0.len()
            && all().all(|number| number.is_finite())
            && system.mode(&self.mode).is_some()
    }
}
