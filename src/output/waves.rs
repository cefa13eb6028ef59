//! The tables of a branch of waves.

use std::path::Path;

use serde::Deserialize;

use super::layout::{self, EVENTS, SPECTRUM};
use super::render::Format;
use super::run::{Headers, Lines, PROFILE_RESOLUTION, Recorded, Restart};
use super::store::{self, FolderKind, StoreError, damaged, refused};
use crate::branch::SavedWave;
use crate::branch::row::{BranchRow, EventRow, SpectrumRow};
use crate::branch::run::{WaveItem, WaveRunner};
use crate::curve::start::Labelled;
use crate::orbit::EventType;
use crate::problem::Problem;
use crate::table::{self, Table};
use crate::tube::model::signature::Regime;

/// Content of `branch.ron` of a branch of waves.
pub(crate) type Waves = Restart<WaveRunner>;

impl Recorded for WaveRunner {
    type Problem = Problem;
    type Saved = SavedWave;

    fn headers(problem: &Problem) -> Headers {
        let rotation = problem.output.rotation;
        let branch = table::columns(&BranchRow::columns(rotation));
        let events = table::columns(&EventRow::columns(problem.model, rotation));
        let spectrum = problem.stability.as_ref();
        Headers {
            branch: table::line_of(&branch),
            events: table::line_of(&events),
            spectrum: spectrum.map(|_| (SPECTRUM, table::header::<SpectrumRow>())),
            pictures: layout::pictures(FolderKind::Run, problem, Format::Svg),
        }
    }

    fn lines(problem: &Problem, item: &WaveItem) -> Lines<SavedWave> {
        let mode = f64::from(item.wave().0.mode);
        let hertz = |speed: f64| problem.output.hertz(mode * speed);
        let row = BranchRow::new(&item.point, item.leg, hertz(item.point.speed));
        let event = item.event.as_ref();
        let event = event.map(|event| table::line(&EventRow::new(event, hertz(event.speed))));
        let label = item.point.label.unwrap_or_default();
        let eigenvalues = item.eigenvalues.iter();
        let eigenvalues = eigenvalues.map(|&eigenvalue| SpectrumRow { label, eigenvalue });
        // a profile that overflows is left out: the point itself has been solved
        let profile = || {
            let wanted = problem.output.profiles > 0;
            let samples = wanted.then(|| item.profile(PROFILE_RESOLUTION).ok());
            samples.flatten().map(table::table)
        };
        let saved = item.saved.as_ref();
        Lines {
            branch: table::line(&row),
            event,
            spectrum: eigenvalues.map(|row| table::line(&row)).collect(),
            kept: saved.map(|saved| (saved.clone(), saved.label, profile())),
        }
    }

    fn label(saved: &SavedWave) -> usize {
        saved.label
    }

    /// All waves have the model of the problem, but for the parameter they were followed in.
    fn broken(problem: &Problem, saved: &[SavedWave]) -> Option<usize> {
        let parameter = problem.parameter();
        let model = match (problem.wave.start.label(), saved.first()) {
            (Some(_), Some(first)) => first.model,
            _ => problem.model,
        };
        saved.iter().position(|wave| {
            let value = wave.model.value(parameter).unwrap_or(f64::NAN);
            !wave.is_whole() || wave.model != model.with(parameter, value)
        })
    }
}

/// The event of a label, from `events.csv`.
///
/// # Errors
/// The file is missing or damaged, or has no such label.
pub(crate) fn labelled(folder: &Path, label: usize) -> Result<Labelled, StoreError> {
    #[derive(Deserialize)]
    struct LabelledRow {
        label: usize,
        #[serde(rename = "type")]
        kind: EventType,
        sector: Option<usize>,
        omega: Option<f64>,
    }
    let path = folder.join(EVENTS);
    let rows = store::table(&path)?.rows::<LabelledRow>();
    let rows = rows.map_err(|error| damaged(&path, error.to_string()))?;
    let row = rows.iter().find(|row| row.label == label);
    let row =
        row.ok_or_else(|| refused(&path, format!("no label {label}; there are {}", rows.len())))?;
    Ok(Labelled {
        kind: row.kind,
        sector: row.sector.unwrap_or(0),
        omega: row.omega,
    })
}

/// Whether a wave in the table of points lifts off.
pub(crate) fn separates(branch: &Table) -> bool {
    let separation = |name| Regime::named(name) == Some(Regime::Separation);
    (0..branch.len()).any(|row| branch.text(row, "regimes").split('-').any(separation))
}
