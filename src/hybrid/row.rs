//! The tables of a branch of orbits: what stands in their rows, field by field.

use std::borrow::Cow;

use serde::{Serialize, Serializer};

use super::{OrbitEvent, OrbitPoint};
use crate::affine::orbit::Multiplier;
use crate::affine::orbit::row::OrbitSample;
use crate::affine::system::{Source, System};
use crate::orbit::{EventType, Stability};

/// Named numbers, each in its column.
#[derive(Clone, Debug, Default)]
pub(super) struct NamedNumbers(Vec<(String, Option<f64>)>);

impl Serialize for NamedNumbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let columns = self.0.iter();
        serializer.collect_map(columns.map(|(name, value)| (name, value)))
    }
}

impl NamedNumbers {
    pub fn without_values<'a>(names: impl Iterator<Item = &'a str>) -> NamedNumbers {
        NamedNumbers(names.map(|name| (name.to_owned(), None)).collect())
    }

    pub fn of(named: &[(String, Option<f64>)]) -> NamedNumbers {
        NamedNumbers(named.to_vec())
    }

    pub fn parameters(source: &Source, values: Option<&[f64]>) -> NamedNumbers {
        let names = source.parameters.names().enumerate();
        let value = |index: usize| values.and_then(|values| values.get(index).copied());
        NamedNumbers(
            names
                .map(|(index, name)| (name.to_owned(), value(index)))
                .collect(),
        )
    }

    pub fn states(source: &Source, values: Option<&[f64]>) -> NamedNumbers {
        let names = source.states.iter().cloned().enumerate();
        let value = |index: usize| values.and_then(|values| values.get(index).copied());
        NamedNumbers(names.map(|(index, name)| (name, value(index))).collect())
    }

    fn extremes(source: &Source, values: Option<&[(f64, f64)]>) -> NamedNumbers {
        let states = source.states.iter().enumerate();
        let columns = states.flat_map(|(index, state)| {
            let value = values.and_then(|values| values.get(index).copied());
            [
                (format!("min_{state}"), value.map(|(least, _)| least)),
                (format!("max_{state}"), value.map(|(_, largest)| largest)),
            ]
        });
        NamedNumbers(columns.collect())
    }
}

/// What a row tells of an orbit.
#[derive(Clone, Debug, Serialize)]
pub struct OrbitColumns<'a> {
    regimes: Cow<'a, str>,
    parameters: NamedNumbers,
    period: f64,
    switches: &'a [f64],
    extremes: NamedNumbers,
    monitors: NamedNumbers,
    stable: Option<&'static str>,
    unstable: Option<usize>,
    multiplier_re: Option<f64>,
    multiplier_im: Option<f64>,
}

impl<'a> OrbitColumns<'a> {
    /// An orbit.
    pub fn new(source: &Source, point: &'a OrbitPoint) -> OrbitColumns<'a> {
        let leading = point.leading();
        OrbitColumns {
            regimes: (&point.regimes).into(),
            parameters: NamedNumbers::parameters(source, Some(&point.parameters)),
            period: point.period,
            switches: &point.switches,
            extremes: NamedNumbers::extremes(source, Some(&point.extremes)),
            monitors: NamedNumbers(point.monitors.clone()),
            stable: point.stable.map(Stability::word),
            unstable: point.unstable,
            multiplier_re: leading.map(|value| value.re),
            multiplier_im: leading.map(|value| value.im),
        }
    }

    /// What is at these values of the parameters where there is no orbit: an equilibrium in a mode, or nothing.
    pub fn without(
        source: &Source,
        values: Option<&[f64]>,
        rest: Option<(Cow<'a, str>, &[f64])>,
    ) -> OrbitColumns<'a> {
        let state = rest
            .as_ref()
            .map(|(_, state)| state.iter().map(|x| (*x, *x)).collect::<Vec<_>>());
        OrbitColumns {
            regimes: rest.map_or("".into(), |(mode, _)| mode),
            parameters: NamedNumbers::parameters(source, values),
            period: f64::NAN,
            switches: &[],
            extremes: NamedNumbers::extremes(source, state.as_deref()),
            monitors: NamedNumbers::default(),
            stable: None,
            unstable: None,
            multiplier_re: None,
            multiplier_im: None,
        }
    }
}

/// A row of `branch.csv`.
#[derive(Clone, Debug, Serialize)]
pub struct OrbitRow<'a> {
    point: usize,
    label: Option<usize>,
    #[serde(rename = "type")]
    kind: Option<EventType>,
    orbit: OrbitColumns<'a>,
    newton: usize,
    residual: f64,
    leg: usize,
}

impl<'a> OrbitRow<'a> {
    /// A row for the names of its columns, with those of monitors.
    pub fn columns<'b>(source: &Source, monitors: impl Iterator<Item = &'b str>) -> OrbitRow<'a> {
        OrbitRow {
            point: 0,
            label: None,
            kind: None,
            orbit: OrbitColumns {
                monitors: NamedNumbers::without_values(monitors),
                ..OrbitColumns::without(source, None, None)
            },
            newton: 0,
            residual: 0.0,
            leg: 0,
        }
    }

    /// A point.
    pub fn new(source: &Source, point: &'a OrbitPoint) -> OrbitRow<'a> {
        OrbitRow {
            point: point.point,
            label: point.label,
            kind: point.kind,
            orbit: OrbitColumns::new(source, point),
            newton: point.newton,
            residual: point.residual,
            leg: point.leg,
        }
    }
}

/// A row of `events.csv`.
#[derive(Clone, Debug, Serialize)]
pub struct OrbitEventRow<'a> {
    label: usize,
    #[serde(rename = "type")]
    kind: Option<EventType>,
    parameters: NamedNumbers,
    period: f64,
    monitors: NamedNumbers,
    multiplier_re: Option<f64>,
    multiplier_im: Option<f64>,
    regimes_before: &'a str,
    regimes_after: &'a str,
    sliding: String,
    uncertainty: f64,
    what: &'a str,
}

impl<'a> OrbitEventRow<'a> {
    /// A row for the names of its columns, with those of monitors.
    pub fn columns<'b>(
        source: &Source,
        monitors: impl Iterator<Item = &'b str>,
    ) -> OrbitEventRow<'a> {
        OrbitEventRow {
            label: 0,
            kind: None,
            parameters: NamedNumbers::parameters(source, None),
            period: 0.0,
            monitors: NamedNumbers::without_values(monitors),
            multiplier_re: None,
            multiplier_im: None,
            regimes_before: "",
            regimes_after: "",
            sliding: String::new(),
            uncertainty: 0.0,
            what: "",
        }
    }

    /// An event.
    pub fn new(event: &'a OrbitEvent) -> OrbitEventRow<'a> {
        let parameters = event.parameters.iter();
        OrbitEventRow {
            label: event.label,
            kind: Some(event.kind),
            parameters: NamedNumbers(
                parameters
                    .map(|(name, value)| (name.clone(), Some(*value)))
                    .collect(),
            ),
            period: event.period,
            monitors: NamedNumbers(event.monitors.clone()),
            multiplier_re: event.leading.map(|value| value.re),
            multiplier_im: event.leading.map(|value| value.im),
            regimes_before: &event.regimes_before,
            regimes_after: &event.regimes_after,
            sliding: event
                .sliding
                .map_or_else(String::new, |sliding| sliding.to_string()),
            uncertainty: event.uncertainty,
            what: &event.what,
        }
    }
}

/// A row of `multipliers.csv`.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct MultiplierRow {
    label: usize,
    /// From 1, the largest first.
    index: usize,
    re: f64,
    im: f64,
    modulus: f64,
    error: f64,
}

impl MultiplierRow {
    /// A multiplier of the orbit of a label; `index` counts from 0.
    pub fn new(label: usize, index: usize, multiplier: &Multiplier) -> MultiplierRow {
        let value = multiplier.value;
        MultiplierRow {
            label,
            index: index + 1,
            re: value.re,
            im: value.im,
            modulus: value.norm(),
            error: multiplier.error,
        }
    }
}

/// A row of the profile of an orbit.
#[derive(Clone, Debug, Default, Serialize)]
pub struct SampleRow<'a> {
    time: f64,
    phase: f64,
    states: NamedNumbers,
    mode: Cow<'a, str>,
}

impl<'a> SampleRow<'a> {
    /// A moment of an orbit of a system.
    pub fn new(system: &'a System, sample: &OrbitSample) -> SampleRow<'a> {
        let values = sample.state.iter().map(|value| Some(*value));
        let names = system.source.states.iter().cloned();
        SampleRow {
            time: sample.time,
            phase: sample.phase,
            states: NamedNumbers(names.zip(values).collect()),
            mode: system.mode_name(sample.mode),
        }
    }
}
