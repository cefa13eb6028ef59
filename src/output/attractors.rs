//! The attractors of a basin: their numbers in its table, a table of their own, and their orbits, to restart from; and the
//! shares of motions that come to them along a parameter.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::layout::{ATTRACTORS, ATTRACTORS_SAVED, SHARES};
use super::store::{Checkpoint, Store, StoreError, VERSION, io_error, refused, resumable};
use crate::hybrid::LabelledOrbit;
use crate::map::{Attractor, Attractors, OrbitMark, SettledCell};
use crate::orbit::Stability;
use crate::problem::SystemProblem;
use crate::table::{Table, line_of, number as written};

/// Content of `attractors.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SavedAttractors {
    /// Version of brakewave that wrote it.
    version: String,
    /// The problem with all its settings.
    pub problem: SystemProblem,
    /// Those that are orbits.
    orbits: Vec<LabelledOrbit>,
    /// How many there are, points of rest included.
    count: usize,
}

impl Checkpoint for SavedAttractors {
    type Problem = SystemProblem;

    const FILE: &'static str = ATTRACTORS_SAVED;

    fn problem(&self) -> &SystemProblem {
        &self.problem
    }

    fn flaw(&self) -> Option<String> {
        let states = self.problem.system.source.states.len();
        let parameters = self.problem.values().len();
        let mut orbits = self.orbits.iter();
        let broken = orbits.find(|one| !one.is_whole(states, parameters));
        broken.map(|one| format!("attractor {} is not whole", one.label))
    }
}

impl SavedAttractors {
    /// The orbit of a number.
    ///
    /// # Errors
    /// There is none, or it is a point of rest.
    pub(crate) fn labelled(
        &self,
        folder: &Path,
        number: usize,
    ) -> Result<&LabelledOrbit, StoreError> {
        let mut orbits = self.orbits.iter();
        orbits.find(|one| one.label == number).ok_or_else(|| {
            let reason = match (1..=self.count).contains(&number) {
                true => format!("attractor {number} is a point of rest, not an orbit"),
                false => format!("no attractor {number}; they run from 1 to {}", self.count),
            };
            refused(&folder.join(ATTRACTORS_SAVED), reason)
        })
    }
}

/// The cells of a row of a map, with the numbers of their attractors.
///
/// # Errors
/// The row is not as it was written.
pub(crate) fn number(
    attractors: &mut Attractors,
    (path, header): (&Path, &str),
    cells: &str,
) -> Result<String, StoreError> {
    let fault = |error: csv::Error| resumable(path, error.to_string());
    let table = Table::parse((header.to_owned() + cells).as_bytes()).map_err(fault)?;
    let columns: Vec<String> = table.columns().map(str::to_owned).collect();
    let mut text = String::new();
    for row in 0..table.len() {
        let count = |column: &str| table.field(row, column).unwrap_or(0);
        let mark = table.list(row, "mark");
        let (phase, state) = mark.split_first().unwrap_or((&0.0, &[]));
        let number = attractors.number(&SettledCell {
            place: ["row", "column", "start"].map(count),
            found: table.text(row, "found"),
            regimes: table.text(row, "regimes"),
            periods: table.field(row, "periods"),
            mark: OrbitMark {
                phase: *phase,
                state: state.to_vec(),
            },
        });
        let cells = columns.iter().map(|column| match (&**column, number) {
            ("attractor", Some(number)) => number.to_string(),
            _ => table.text(row, column).to_owned(),
        });
        text.push_str(&line_of(&cells.collect::<Vec<_>>()));
    }
    Ok(text)
}

/// The cells of an attractor.
fn cells(number: usize, attractor: &Attractor, cells: usize) -> Vec<String> {
    let orbit = attractor.orbit.as_ref().map(|(point, _)| point);
    let periods = attractor.periods.map(|periods| periods.to_string());
    let stable = orbit.and_then(|point| point.stable).map(Stability::word);
    let own = [
        number.to_string(),
        attractor.regimes.clone(),
        orbit.map_or_else(String::new, |point| written(point.period)),
        periods.unwrap_or_default(),
        stable.unwrap_or_default().to_owned(),
        written(attractor.cells as f64 / cells as f64),
    ];
    let states = attractor.state.iter().map(|x| written(*x));
    own.into_iter().chain(states).collect()
}

/// The header of a table of attractors.
fn header(problem: &SystemProblem) -> Vec<String> {
    let names = [
        "attractor",
        "regimes",
        "period",
        "periods",
        "stable",
        "share",
    ];
    let states = problem.system.source.states.iter().cloned();
    names.map(str::to_owned).into_iter().chain(states).collect()
}

/// The header of the table of shares.
pub(crate) fn header_of_shares(problem: &SystemProblem) -> String {
    let before = ["value", "found"].map(str::to_owned).to_vec();
    line_of(&[before, header(problem)].concat())
}

/// The rows of a value in the table of shares, of which the motions are numbered cells of a map: one for each attractor, and
/// one for each word of what comes to none.
///
/// # Errors
/// A row is not as it was written.
pub(crate) fn shares(
    attractors: &mut Attractors,
    value: f64,
    place: (&Path, &str),
    rows: &str,
) -> Result<String, StoreError> {
    let path = place.0;
    let numbered = number(attractors, place, rows)?;
    let fault = |error: csv::Error| resumable(path, error.to_string());
    let table = Table::parse((place.1.to_owned() + &numbered).as_bytes()).map_err(fault)?;
    let mut without: BTreeMap<&str, usize> = BTreeMap::new();
    for row in 0..table.len() {
        if table.text(row, "attractor").is_empty() {
            *without.entry(table.text(row, "found")).or_default() += 1;
        }
    }
    let all = attractors.cells;
    let mut text = String::new();
    for (attractor, number) in attractors.met.iter().zip(1..) {
        let found = if attractor.orbit.is_some() {
            "orbit"
        } else {
            "equilibrium"
        };
        let before = vec![written(value), found.to_owned()];
        text.push_str(&line_of(&[before, cells(number, attractor, all)].concat()));
    }
    let states = attractors.states().len();
    for (found, count) in without {
        let mut row = vec![String::new(); 2 + 6 + states];
        row[0] = written(value);
        row[1] = found.to_owned();
        row[7] = written(count as f64 / all as f64);
        text.push_str(&line_of(&row));
    }
    Ok(text)
}

/// Writes the table of shares.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn write_shares(store: &Store, text: &str) -> Result<(), StoreError> {
    store.write(SHARES, |path, out| {
        out.write_all(text.as_bytes())
            .map_err(io_error("write it", path))
    })
}

/// Writes the table of the attractors that have been met, and their orbits.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn write(
    store: &Store,
    problem: &SystemProblem,
    attractors: &Attractors,
) -> Result<(), StoreError> {
    let mut text = line_of(&header(problem));
    for (attractor, number) in attractors.met.iter().zip(1..) {
        text.push_str(&line_of(&cells(number, attractor, attractors.cells)));
    }
    store.write(ATTRACTORS, |path, out| {
        out.write_all(text.as_bytes())
            .map_err(io_error("write it", path))
    })?;
    let orbits = attractors.met.iter().filter_map(|one| one.orbit.as_ref());
    let saved = SavedAttractors {
        version: VERSION.to_owned(),
        problem: problem.clone(),
        orbits: orbits.map(|(_, saved)| saved.clone()).collect(),
        count: attractors.met.len(),
    };
    store.save(ATTRACTORS_SAVED, &saved)
}
