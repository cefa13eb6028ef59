//! The tables of a branch of orbits.

use serde::Serialize;

use super::layout::{self, MULTIPLIERS};
use super::render::Format;
use super::run::{Headers, Lines, Recorded, Restart};
use crate::affine::orbit::AffineOrbit;
use crate::hybrid::LabelledOrbit;
use crate::hybrid::row::{MultiplierRow, OrbitEventRow, OrbitRow};
use crate::hybrid::run::{Item, PROFILE_RESOLUTION, Progress, Runner};
use crate::orbit::legs;
use crate::problem::SystemProblem;
use crate::table;

/// Content of `branch.ron` of a branch of orbits.
pub(crate) type Orbits = Restart<Runner>;

impl Recorded for Runner {
    type Problem = SystemProblem;
    type Progress = Progress;
    type Saved = LabelledOrbit;

    fn saved(&self) -> Progress {
        self.state()
    }

    fn legs(progress: &Progress) -> &legs::Progress<AffineOrbit> {
        &progress.legs
    }

    fn eigenvalues(progress: &Progress) -> usize {
        progress.multipliers
    }

    fn headers(problem: &SystemProblem) -> Headers {
        let source = &problem.system.source;
        let line = |row: &dyn Fn() -> Vec<String>| table::line_of(&row());
        Headers {
            branch: line(&|| table::columns(&OrbitRow::columns(source))),
            events: line(&|| table::columns(&OrbitEventRow::columns(source))),
            spectrum: problem
                .stability
                .map(|_| (MULTIPLIERS, table::header::<MultiplierRow>())),
            pictures: layout::pictures_of_orbits(problem, Format::Svg),
        }
    }

    fn lines(problem: &SystemProblem, item: &Item) -> Lines<LabelledOrbit> {
        let source = &problem.system.source;
        let event = item.event.as_ref();
        let saved = item.saved.as_ref();
        Lines {
            branch: table::line(&OrbitRow::new(source, &item.point)),
            event: event.map(|event| table::line(&OrbitEventRow::new(event))),
            spectrum: item.multipliers.iter().map(table::line).collect(),
            kept: saved.map(|saved| (saved.clone(), saved.label, profile(problem, item))),
        }
    }

    fn label(saved: &LabelledOrbit) -> usize {
        saved.label
    }

    /// All orbits have the parameters of the problem, but for the one they were followed in.
    fn broken(problem: &SystemProblem, saved: &[LabelledOrbit]) -> Option<usize> {
        let values = match (problem.orbit.start.dir(), saved.first()) {
            (Some(_), Some(first)) => first.orbit.values.clone(),
            _ => problem.values(),
        };
        let states = problem.system.source.states.len();
        let followed = problem.parameter();
        saved.iter().position(|one| {
            let pairs = one.orbit.values.iter().zip(&values).enumerate();
            let differs = |(index, (own, known)): (usize, (&f64, &f64))| {
                Some(index) != followed && own != known
            };
            !one.is_whole(states, values.len()) || pairs.into_iter().any(differs)
        })
    }
}

/// A row of a profile.
#[derive(Clone, Debug, Default, Serialize)]
struct ProfileRow<'a> {
    time: f64,
    phase: f64,
    states: std::collections::BTreeMap<Ordered<'a>, f64>,
    mode: &'a str,
}

/// A name that keeps its place among others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Ordered<'a>(usize, &'a str);

impl Serialize for Ordered<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.1)
    }
}

/// The profile of a labelled orbit, where profiles are asked for; one that overflows is left out.
fn profile(problem: &SystemProblem, item: &Item) -> Option<String> {
    if problem.output.profiles == 0 {
        return None;
    }
    let (orbit, point) = item.orbit();
    let samples = orbit
        .samples(point, PROFILE_RESOLUTION / orbit.zones().max(1))
        .ok()?;
    let system = &problem.system;
    let rows = samples.into_iter().map(|sample| {
        let names = system.source.states.iter().enumerate();
        let states = names.zip(sample.state);
        ProfileRow {
            time: sample.time,
            phase: sample.phase,
            states: states
                .map(|((index, name), value)| (Ordered(index, name), value))
                .collect(),
            mode: system.mode_name(sample.mode),
        }
    });
    Some(table::table(rows))
}
