//! The tables of a branch of equilibria: what stands in their rows, field by field.

use serde::Serialize;

use super::super::row::NamedNumbers;
use super::{EquilibriumEvent, EquilibriumPoint};
use crate::affine::system::Source;
use crate::linalg::Eigenvalue;
use crate::orbit::{EventType, Stability};

/// A row of `branch.csv`.
#[derive(Clone, Debug, Serialize)]
pub struct EquilibriumRow<'a> {
    point: usize,
    label: Option<usize>,
    #[serde(rename = "type")]
    kind: Option<EventType>,
    regimes: &'a str,
    parameters: NamedNumbers,
    states: NamedNumbers,
    monitors: NamedNumbers,
    stable: Option<&'static str>,
    unstable: usize,
    re: Option<f64>,
    im: Option<f64>,
    newton: usize,
    residual: f64,
    leg: usize,
}

impl<'a> EquilibriumRow<'a> {
    /// A row for the names of its columns, with those of monitors.
    pub fn columns<'b>(
        source: &Source,
        monitors: impl Iterator<Item = &'b str>,
    ) -> EquilibriumRow<'a> {
        EquilibriumRow {
            point: 0,
            label: None,
            kind: None,
            regimes: "",
            parameters: NamedNumbers::parameters(source, None),
            states: NamedNumbers::states(source, None),
            monitors: NamedNumbers::without_values(monitors),
            stable: None,
            unstable: 0,
            re: None,
            im: None,
            newton: 0,
            residual: 0.0,
            leg: 0,
        }
    }

    /// A point.
    pub fn new(source: &Source, point: &'a EquilibriumPoint) -> EquilibriumRow<'a> {
        let leading = point.leading();
        EquilibriumRow {
            point: point.point,
            label: point.label,
            kind: point.kind,
            regimes: &point.mode,
            parameters: NamedNumbers::parameters(source, Some(&point.parameters)),
            states: NamedNumbers::states(source, Some(&point.state)),
            monitors: NamedNumbers::of(&point.monitors),
            stable: Some(Stability::word(point.stable)),
            unstable: point.unstable,
            re: leading.map(|value| value.re),
            im: leading.map(|value| value.im),
            newton: point.newton,
            residual: point.residual,
            leg: point.leg,
        }
    }
}

/// A row of `events.csv`.
#[derive(Clone, Debug, Serialize)]
pub struct EquilibriumEventRow<'a> {
    label: usize,
    #[serde(rename = "type")]
    kind: Option<EventType>,
    parameters: NamedNumbers,
    states: NamedNumbers,
    monitors: NamedNumbers,
    re: Option<f64>,
    im: Option<f64>,
    omega: Option<f64>,
    lyapunov: Option<f64>,
    regimes_before: &'a str,
    regimes_after: &'a str,
    uncertainty: f64,
    what: &'a str,
}

impl<'a> EquilibriumEventRow<'a> {
    /// A row for the names of its columns, with those of monitors.
    pub fn columns<'b>(
        source: &Source,
        monitors: impl Iterator<Item = &'b str>,
    ) -> EquilibriumEventRow<'a> {
        EquilibriumEventRow {
            label: 0,
            kind: None,
            parameters: NamedNumbers::parameters(source, None),
            states: NamedNumbers::states(source, None),
            monitors: NamedNumbers::without_values(monitors),
            re: None,
            im: None,
            omega: None,
            lyapunov: None,
            regimes_before: "",
            regimes_after: "",
            uncertainty: 0.0,
            what: "",
        }
    }

    /// An event.
    pub fn new(source: &Source, event: &'a EquilibriumEvent) -> EquilibriumEventRow<'a> {
        let numbers = |named: &[(String, f64)]| -> Vec<f64> {
            named.iter().map(|(_, value)| *value).collect()
        };
        EquilibriumEventRow {
            label: event.label,
            kind: Some(event.kind),
            parameters: NamedNumbers::parameters(source, Some(&numbers(&event.parameters))),
            states: NamedNumbers::states(source, Some(&numbers(&event.state))),
            monitors: NamedNumbers::of(&event.monitors),
            re: event.leading.map(|value| value.re),
            im: event.leading.map(|value| value.im),
            omega: event.omega,
            lyapunov: event.lyapunov,
            regimes_before: &event.regimes_before,
            regimes_after: &event.regimes_after,
            uncertainty: event.uncertainty,
            what: &event.what,
        }
    }
}

/// A row of `eigenvalues.csv`.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct EquilibriumEigenvalueRow {
    label: usize,
    /// From 1, the fastest growing first.
    index: usize,
    re: f64,
    im: f64,
    error: f64,
}

impl EquilibriumEigenvalueRow {
    /// An eigenvalue of the equilibrium of a label; `index` counts from 0.
    pub fn new(label: usize, index: usize, eigenvalue: &Eigenvalue) -> EquilibriumEigenvalueRow {
        EquilibriumEigenvalueRow {
            label,
            index: index + 1,
            re: eigenvalue.value.re,
            im: eigenvalue.value.im,
            error: eigenvalue.error,
        }
    }
}
