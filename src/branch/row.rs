//! The tables of a branch: what stands in their rows, field by field.

use serde::{Serialize, Serializer};

use super::{BranchPoint, Event, EventType, Stability};
use crate::tube::model::{Model, Parameter};
use crate::tube::stability::spectrum::WaveEigenvalue;

/// The parameters of a model, each in its column: the later ones, or those before them.
#[derive(Clone, Copy, Debug, Default)]
struct Parameters<const LATER: bool>(Option<Model>);

impl<const LATER: bool> Parameters<LATER> {
    fn columns(&self) -> impl Iterator<Item = (&'static str, Option<f64>)> {
        let of_table = |parameter: &Parameter| parameter.is_later() == LATER;
        let value = |parameter| self.0.and_then(|model| model.value(parameter));
        let listed = Parameter::ALL.into_iter().filter(of_table);
        listed.map(move |parameter| (parameter.column(), value(parameter)))
    }

    /// Whether the model has none of them.
    fn are_absent(&self) -> bool {
        self.columns().all(|(_, value)| value.is_none())
    }
}

impl<const LATER: bool> Serialize for Parameters<LATER> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.columns())
    }
}

/// Columns of `branch.csv` that hold words: no curve can be drawn of them.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) const WORD_COLUMNS: [&str; 4] = ["type", "regimes", "stable", "why"];

/// A wave and its stability, as the tables of branches and of maps have them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct WaveRow<'a> {
    regimes: &'a str,
    parameters: Parameters<false>,
    speed: Option<f64>,
    switches: &'a [f64],
    min_pressure: Option<f64>,
    max_gap: Option<f64>,
    amplitude: Option<f64>,
    stable: Option<&'static str>,
    unstable: Option<usize>,
    lead_re: Option<f64>,
    lead_im: Option<f64>,
    lead_sector: Option<usize>,
}

impl<'a> WaveRow<'a> {
    /// The wave of a point.
    pub fn new(point: &'a BranchPoint) -> WaveRow<'a> {
        WaveRow {
            regimes: &point.regimes,
            parameters: Parameters(Some(point.model)),
            speed: Some(point.speed),
            switches: &point.switches,
            min_pressure: Some(point.min_pressure),
            max_gap: Some(point.max_gap),
            amplitude: Some(point.amplitude),
            stable: point.stable.map(Stability::word),
            unstable: point.unstable,
            lead_re: point.lead.map(|lead| lead.re),
            lead_im: point.lead.map(|lead| lead.im),
            lead_sector: point.lead.map(|lead| lead.sector),
        }
    }

    /// The parameters of a place where there is no wave.
    pub fn nothing(model: Model) -> WaveRow<'a> {
        WaveRow {
            parameters: Parameters(Some(model)),
            ..WaveRow::default()
        }
    }
}

/// What a verdict rests on, where that is not plain.
pub fn why(point: &BranchPoint) -> String {
    let reasons: Vec<String> = point.why.iter().map(ToString::to_string).collect();
    reasons.join("; ")
}

/// A row of `branch.csv`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BranchRow<'a> {
    point: usize,
    label: Option<usize>,
    #[serde(rename = "type")]
    kind: Option<EventType>,
    wave: WaveRow<'a>,
    newton: usize,
    residual: f64,
    leg: usize,
    later: Parameters<true>,
    condition: Option<f64>,
    expected_error: Option<f64>,
    why: String,
    /// Where the rotation of the shaft is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    hertz: Option<f64>,
}

impl<'a> BranchRow<'a> {
    /// A row for the names of its columns, with a frequency or without.
    pub fn columns(hertz: Option<f64>) -> BranchRow<'a> {
        BranchRow {
            hertz,
            ..BranchRow::default()
        }
    }

    /// A point of a leg, and the frequency in hertz that is heard of it, where that is known.
    pub fn new(point: &'a BranchPoint, leg: usize, hertz: Option<f64>) -> BranchRow<'a> {
        let (condition, expected_error) = point.conditioning.unzip();
        BranchRow {
            point: point.point,
            label: point.label,
            kind: point.kind,
            wave: WaveRow::new(point),
            newton: point.newton,
            residual: point.residual,
            leg,
            later: Parameters(Some(point.model)),
            condition,
            expected_error,
            why: why(point),
            hertz,
        }
    }
}

/// A row of `events.csv`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct EventRow<'a> {
    label: usize,
    #[serde(rename = "type")]
    kind: Option<EventType>,
    parameters: Parameters<false>,
    speed: f64,
    sector: Option<usize>,
    omega: Option<f64>,
    regimes_before: &'a str,
    regimes_after: &'a str,
    uncertainty: f64,
    what: &'a str,
    #[serde(skip_serializing_if = "Parameters::are_absent")]
    later: Parameters<true>,
    /// Where the rotation of the shaft is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    hertz: Option<f64>,
}

impl<'a> EventRow<'a> {
    /// An event, and the frequency in hertz that is heard of its wave, where that is known.
    pub fn new(event: &'a Event, hertz: Option<f64>) -> EventRow<'a> {
        EventRow {
            label: event.label,
            kind: Some(event.kind),
            parameters: Parameters(Some(event.model)),
            speed: event.speed,
            sector: event.sector,
            omega: event.omega,
            regimes_before: &event.regimes_before,
            regimes_after: &event.regimes_after,
            uncertainty: event.uncertainty,
            what: &event.what,
            later: Parameters(Some(event.model)),
            hertz,
        }
    }

    /// A row for the names of its columns: later parameters have one only where the model has them.
    pub fn columns(model: Model, hertz: Option<f64>) -> EventRow<'a> {
        EventRow {
            later: Parameters(Some(model)),
            hertz,
            ..EventRow::default()
        }
    }
}

/// A row of `spectrum.csv`.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct SpectrumRow {
    /// Label of the point.
    pub label: usize,
    /// The eigenvalue.
    pub eigenvalue: EigenvalueRow,
}

/// An eigenvalue.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct EigenvalueRow {
    /// Bloch sector.
    pub sector: usize,
    /// Re λ.
    pub re: f64,
    /// Im λ.
    pub im: f64,
    /// Bound of its error; not a number where there is none.
    pub error: f64,
}

impl EigenvalueRow {
    /// An eigenvalue of a sector.
    pub fn new(sector: usize, eigenvalue: &WaveEigenvalue) -> EigenvalueRow {
        EigenvalueRow {
            sector,
            re: eigenvalue.re,
            im: eigenvalue.im,
            error: eigenvalue.error,
        }
    }
}

/// A row of `brakewave spectrum`: an eigenvalue, the wave it belongs to and, where they are known, its
/// stability and what that rests on.
#[derive(Clone, Debug, Default, Serialize)]
pub struct WaveEigenvalueRow<'a> {
    eigenvalue: EigenvalueRow,
    regimes: &'a str,
    parameters: Parameters<false>,
    speed: f64,
    switches: &'a [f64],
    stable: Option<&'static str>,
    unstable: Option<usize>,
    why: String,
}

impl<'a> WaveEigenvalueRow<'a> {
    /// An eigenvalue of the wave at a point.
    pub fn new(eigenvalue: EigenvalueRow, point: &'a BranchPoint) -> WaveEigenvalueRow<'a> {
        WaveEigenvalueRow {
            eigenvalue,
            regimes: &point.regimes,
            parameters: Parameters(Some(point.model)),
            speed: point.speed,
            switches: &point.switches,
            stable: point.stable.map(Stability::word),
            unstable: point.unstable,
            why: why(point),
        }
    }
}

/// A row of the eigenfunctions that `brakewave spectrum` writes.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct EigenfunctionRow {
    /// Bloch sector.
    pub sector: usize,
    /// Re λ.
    pub re: f64,
    /// Im λ.
    pub im: f64,
    /// Place.
    pub theta: f64,
    /// Re ψ.
    pub psi_re: f64,
    /// Im ψ.
    pub psi_im: f64,
    /// Re ψ′.
    pub slope_re: f64,
    /// Im ψ′.
    pub slope_im: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::drawable_columns;
    use crate::table;

    /// A problem file may ask for a picture of every column of numbers, and of no other.
    #[test]
    fn columns_of_numbers_can_be_drawn() {
        let mut columns = table::columns(&BranchRow::columns(Some(0.0)));
        columns.retain(|column| !WORD_COLUMNS.contains(&column.as_str()));
        assert_eq!(columns, drawable_columns());
    }
}
