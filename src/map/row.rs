//! The rows of a map.

use crate::orbit::legs::Run as _;
use std::collections::{BTreeMap, BTreeSet};

use super::cell::{Cell, CellPoint, Missing};
use super::lattice::Lattice;
use super::line::{Hit, MapLine, Met};
use super::plane::MapPlane;
use crate::branch::run::RunError;
use crate::problem::{Map, Problem, Start, Toward};
use crate::tube::stability::spectrum::SpectrumRequest;

/// The rows of a map, any of which can be computed by itself.
pub struct Rows<'a> {
    problem: &'a Problem,
    map: &'a Map,
    plane: MapPlane,
    lattice: Lattice<'a>,
}

/// What the branches of one start meet on a row.
struct Branches {
    met: Met,
    /// Columns where a wave of theirs is listed under another start.
    listed: Vec<usize>,
}

impl<'a> Rows<'a> {
    /// Follows the lines from whose waves the rows are followed. `watch` is told the number of waves on
    /// them so far.
    ///
    /// # Errors
    /// When the problem asks for something that no row can have.
    pub fn new(
        problem: &'a Problem,
        map: &'a Map,
        watch: &mut dyn FnMut(usize),
    ) -> Result<Rows<'a>, RunError> {
        let plane = MapPlane::new(map);
        Ok(Rows {
            problem,
            map,
            lattice: Lattice::new(problem, map, &plane, watch)?,
            plane,
        })
    }

    /// All cells of a row: by start, by column, by passage.
    ///
    /// # Errors
    /// When the problem asks for something that no row can have; a wave that does not exist is none.
    pub fn row(&self, index: usize) -> Result<Vec<Cell>, RunError> {
        let points = self.plane.row(index);
        match self.plane.axes() {
            Some(_) => self.along(index, &points),
            None => self.one_by_one(index, &points),
        }
    }

    /// The line through points of the same first parameter.
    fn line(&self, first: f64, values: Vec<f64>) -> MapLine<'a> {
        MapLine {
            problem: self.problem,
            along: self.map.second,
            across: (self.map.first.parameter, first),
            values,
            // of the spectrum a map keeps the leading eigenvalue and the count
            request: self.problem.request().map(|request| SpectrumRequest {
                eigenvalues: 1,
                ..request
            }),
        }
    }

    /// The row of a grid: the branches of its own slip-stick waves, and those through waves of the
    /// lattice that they do not meet.
    fn along(&self, index: usize, points: &[[f64; 2]]) -> Result<Vec<Cell>, RunError> {
        let first = points[0][0];
        let line = self.line(first, points.iter().map(|point| point[1]).collect());
        let own = |start| {
            Ok(Branches {
                met: line.follow_start(start)?,
                listed: Vec::new(),
            })
        };
        let own: Result<_, RunError> = self.map.starts.0.iter().map(own).collect();
        let mut starts: Vec<Branches> = own?;
        once_each(&mut starts);
        for (seed, start) in self.lattice.on_row(index) {
            let known = |hit: &Hit| {
                let mut hits = starts.iter().flat_map(|branches| &branches.met.hits);
                hits.any(|other| hit.is(other))
            };
            if !known(&seed) {
                let met = line.follow_wave(&seed, &known)?;
                starts[start].met.hits.extend(met.hits);
                starts[start].met.gaps.extend(met.gaps);
            }
        }
        let mut cells = Vec::new();
        for (number, branches) in starts.iter().enumerate() {
            let Branches { met, listed } = branches;
            for (column, values) in points.iter().enumerate() {
                let here = met.hits.iter().filter(|hit| hit.index == column);
                let why = || {
                    let gap = met.gaps.iter().find_map(|gap| gap.hides(values[1]));
                    match &met.missing {
                        _ if listed.contains(&column) => Missing::Listed,
                        Some(Missing::NoStart(reason)) => gap
                            .or_else(|| self.lattice.gap(column, first, number))
                            .unwrap_or_else(|| Missing::NoBranch(reason.clone())),
                        other => gap
                            .or_else(|| self.lattice.gap(column, first, number))
                            .or_else(|| other.clone())
                            .unwrap_or(Missing::Elsewhere),
                    }
                };
                self.add([index, column], *values, number, here, why, &mut cells);
            }
        }
        Ok(cells)
    }

    /// Quasi-random points, each by itself.
    fn one_by_one(&self, index: usize, points: &[[f64; 2]]) -> Result<Vec<Cell>, RunError> {
        let mut cells = Vec::new();
        for (number, start) in self.map.starts.0.iter().enumerate() {
            for (column, values) in points.iter().enumerate() {
                let line = self.line(values[0], Vec::new());
                let begun = line.begin(start.clone(), values[1], Toward::Both, None);
                let (mut hits, mut why) = (Vec::new(), Missing::Elsewhere);
                match begun {
                    Ok(mut branch) => {
                        for item in branch.step() {
                            let mut point = item.point.clone();
                            line.add_stability(&item, &mut None, &mut point);
                            let saved = item.saved;
                            hits.extend(saved.map(|saved| Hit {
                                index: column,
                                point,
                                saved,
                            }));
                        }
                    }
                    Err(RunError::NoStart(reason)) => why = Missing::NoStart(reason),
                    Err(error) => return Err(error),
                }
                let place = [index, column];
                self.add(
                    place,
                    *values,
                    number,
                    hits.iter(),
                    || why.clone(),
                    &mut cells,
                );
            }
        }
        Ok(cells)
    }

    /// Adds the cells of one start at a point.
    fn add<'h>(
        &self,
        [row, column]: [usize; 2],
        [first, second]: [f64; 2],
        number: usize,
        hits: impl Iterator<Item = &'h Hit>,
        why: impl FnOnce() -> Missing,
        cells: &mut Vec<Cell>,
    ) {
        let start = match self.map.starts.0[number] {
            Start::Slow => "slow",
            Start::Fast | Start::Hopf | Start::Restart { .. } | Start::Switch { .. } => "fast",
        };
        let cell = |passage, found| Cell {
            row,
            column,
            start,
            passage,
            found,
        };
        let before = cells.len();
        let waves = hits.map(|hit| CellPoint::Wave(Box::new(hit.point.clone())));
        cells.extend((1..).zip(waves).map(|(passage, wave)| cell(passage, wave)));
        if cells.len() == before {
            let model = self.problem.model.with(self.map.first.parameter, first);
            let model = Box::new(model.with(self.map.second.parameter, second));
            cells.push(cell(0, CellPoint::Nothing { model, why: why() }));
        }
    }
}

/// Leaves every wave with one start: the one whose branch comes to it in fewer passages, the first of two.
fn once_each(starts: &mut [Branches]) {
    // passage, start and place among its hits of all waves of a column
    let mut columns: BTreeMap<usize, Vec<(usize, usize, usize)>> = BTreeMap::new();
    for (number, branches) in starts.iter().enumerate() {
        for (place, hit) in branches.met.hits.iter().enumerate() {
            let here = columns.entry(hit.index).or_default();
            let passage = here.iter().filter(|(_, of, _)| *of == number).count();
            here.push((passage, number, place));
        }
    }
    let mut again = vec![BTreeSet::new(); starts.len()];
    for mut here in columns.into_values() {
        here.sort_unstable();
        for (rank, (_, number, place)) in here.iter().enumerate() {
            let hit = |number: usize, place: usize| &starts[number].met.hits[place];
            let this = hit(*number, *place);
            let mut earlier = here[..rank].iter();
            if earlier.any(|(_, number, place)| this.is(hit(*number, *place))) {
                again[*number].insert(*place);
            }
        }
    }
    for (branches, again) in starts.iter_mut().zip(again) {
        let Branches { met, listed } = branches;
        let mut place = 0..;
        met.hits.retain(|hit| {
            let twice = place.next().is_some_and(|place| again.contains(&place));
            if twice {
                listed.push(hit.index);
            }
            !twice
        });
    }
}
