//! The tables of a branch of orbits.

use std::path::Path;

use serde::Deserialize;

use super::layout::{self, EVENTS, MULTIPLIERS};
use super::render::Format;
use super::run::{Headers, Lines, PROFILE_RESOLUTION, Recorded, Restart};
use super::store::{self, StoreError, damaged};
use crate::affine::orbit::AffineOrbit;
use crate::hybrid::LabelledOrbit;
use crate::hybrid::row::{MultiplierRow, OrbitEventRow, OrbitRow, SampleRow};
use crate::hybrid::runner::SystemOrbit;
use crate::hybrid::{OrbitItem, OrbitRunner};
use crate::orbit::EventType;
use crate::problem::SystemProblem;
use crate::table;

/// Content of `branch.ron` of a branch of orbits.
pub(crate) type Orbits = Restart<OrbitRunner>;

impl Recorded for OrbitRunner {
    type Problem = SystemProblem;
    type Saved = LabelledOrbit;

    fn headers(problem: &SystemProblem) -> Headers {
        let source = &problem.system.source;
        let branch = table::columns(&OrbitRow::columns(source, problem.monitor.names()));
        let events = table::columns(&OrbitEventRow::columns(source, problem.monitor.names()));
        Headers {
            branch: table::line_of(&branch),
            events: table::line_of(&events),
            spectrum: problem
                .stability
                .map(|_| (MULTIPLIERS, table::header::<MultiplierRow>())),
            pictures: layout::pictures_of_orbits(problem, Format::Svg),
        }
    }

    fn lines(problem: &SystemProblem, item: &OrbitItem) -> Lines<LabelledOrbit> {
        let source = &problem.system.source;
        let event = item.event.as_ref();
        let saved = item.saved.as_ref();
        Lines {
            branch: table::line(&OrbitRow::new(source, &item.point)),
            event: event.map(|event| table::line(&OrbitEventRow::new(event))),
            spectrum: item.spectrum.iter().map(table::line).collect(),
            kept: saved.map(|saved| (saved.clone(), saved.label, profile(problem, item))),
        }
    }

    fn label(saved: &LabelledOrbit) -> usize {
        saved.label
    }

    fn broken(problem: &SystemProblem, saved: &[LabelledOrbit]) -> Option<usize> {
        let source = &problem.system.source;
        let counts = (source.states.len(), source.parameters.0.len());
        first_broken::<AffineOrbit>(problem, saved, |one| one.is_whole(counts.0, counts.1))
    }
}

/// The first of the saved points that is not whole or has other parameters than the problem, but for the one that is followed and the
/// one that is free for a prescribed period.
pub(super) fn first_broken<O: SystemOrbit>(
    problem: &SystemProblem,
    saved: &[O::Saved],
    is_whole: impl Fn(&O::Saved) -> bool,
) -> Option<usize> {
    let values = match (problem.earlier_run(), saved.first()) {
        (Some(_), Some(first)) => O::saved_parameters(first).to_vec(),
        _ => problem.values(),
    };
    let free = problem.orbit.free.as_ref();
    let free = free.and_then(|name| problem.system.source.parameters.index(name));
    let own = [problem.parameter(), free];
    saved.iter().position(|one| {
        let pairs = O::saved_parameters(one).iter().zip(&values).enumerate();
        let differs = |(index, (here, known)): (usize, (&f64, &f64))| {
            !own.contains(&Some(index)) && here != known
        };
        !is_whole(one) || pairs.into_iter().any(differs)
    })
}

/// The type of a labelled orbit, from `events.csv`; none where the label is that of a sample.
///
/// # Errors
/// The file is missing or damaged.
pub(crate) fn kind_of(folder: &Path, label: usize) -> Result<Option<EventType>, StoreError> {
    #[derive(Deserialize)]
    struct OrbitType {
        label: usize,
        #[serde(rename = "type")]
        kind: EventType,
    }
    let path = folder.join(EVENTS);
    let rows = store::table(&path)?.rows::<OrbitType>();
    let rows = rows.map_err(|error| damaged(&path, error.to_string()))?;
    let row = rows.iter().find(|row| row.label == label);
    Ok(row.map(|row| row.kind))
}

/// The profile of a labelled orbit, where profiles are asked for; one that overflows is left out.
fn profile(problem: &SystemProblem, item: &OrbitItem) -> Option<String> {
    if problem.output.profiles == 0 {
        return None;
    }
    let (orbit, point) = item.orbit();
    let samples = orbit
        .samples(point, PROFILE_RESOLUTION / orbit.zones().max(1))
        .ok()?;
    let rows = samples.iter();
    let rows = rows.map(|sample| SampleRow::new(&problem.system, sample));
    Some(table::table(rows))
}
