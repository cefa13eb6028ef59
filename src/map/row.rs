//! One row of a map.

use super::cell::{Cell, CellPoint};
use super::plane::Plane;
use crate::branch::run::{End, Item, RunError, Runner, answer};
use crate::branch::{BranchPoint, EventType};
use crate::model::Parameter;
use crate::problem::{Continuation, Map, Problem, Start, Toward};
use crate::stability::characteristic::Characteristic;
use crate::stability::spectrum::{Request, Spectrum, spectrum};

/// Points after which either way of a branch within a row is given up: round folds it passes the range a few
/// times, at the default step lengths a hundred points each.
pub const MOST_POINTS: usize = 20_000;

/// Parts of the range at which a wave to begin with is looked for, after the ends, where the
/// second parameter is not the mismatch.
const INNER_STARTS: [f64; 3] = [0.5, 0.25, 0.75];

/// Relative difference of speed and amplitude up to which two waves at the same parameters are one:
/// far above what solving leaves, 1e-13, far below what tells neighbours at a fold apart.
const SAME_WAVE: f64 = 1e-9;

/// A wave of a branch at one column of the row.
struct Hit {
    column: usize,
    point: BranchPoint,
}

impl Hit {
    /// Whether this is a wave met before. Its signature may begin elsewhere on the circle where
    /// there is no stick to begin with.
    fn is(&self, other: &Hit) -> bool {
        let close = |one: f64, other: f64| (one - other).abs() <= SAME_WAVE * other.abs();
        self.column == other.column
            && close(self.point.speed, other.point.speed)
            && close(self.point.amplitude, other.point.amplitude)
    }
}

/// All cells of a row: by start, by column, by passage.
///
/// # Errors
/// When the problem asks for something that no row can have; a wave that does not exist is none.
pub fn row(problem: &Problem, map: &Map, index: usize) -> Result<Vec<Cell>, RunError> {
    let plane = Plane::new(map);
    let points = plane.row(index);
    let mut cells = Vec::with_capacity(points.len() * map.starts.len());
    for start in &map.starts {
        let name = match start {
            Start::Slow => "slow",
            Start::Fast | Start::Hopf | Start::Restart { .. } => "fast",
        };
        let search = Search {
            problem,
            map,
            start,
            // of the spectrum a map keeps the leading eigenvalue and the count
            request: problem.request().map(|request| Request {
                eigenvalues: 1,
                ..request
            }),
        };
        let (hits, whys) = if plane.is_grid() {
            let (hits, why) = search.along(&points)?;
            (hits, vec![why; points.len()])
        } else {
            search.one_by_one(&points)?
        };
        for (column, values) in points.iter().enumerate() {
            let cell = |passage, found| Cell {
                row: index,
                column,
                start: name,
                passage,
                found,
            };
            let here = hits.iter().filter(|hit| hit.column == column);
            let waves = here.map(|hit| CellPoint::Wave(Box::new(hit.point.clone())));
            let before = cells.len();
            cells.extend((1..).zip(waves).map(|(passage, wave)| cell(passage, wave)));
            if cells.len() == before {
                let model = problem.model.with(map.first.parameter, values[0]);
                let model = Box::new(model.with(map.second.parameter, values[1]));
                let why = whys[column].clone();
                cells.push(cell(0, CellPoint::Nothing { model, why }));
            }
        }
    }
    Ok(cells)
}

/// Looks for the waves of one start.
struct Search<'a> {
    problem: &'a Problem,
    map: &'a Map,
    start: &'a Start,
    request: Option<Request>,
}

impl Search<'_> {
    /// The problem at a point of the plane. Stability is left out: it is wanted at cells only.
    fn at(&self, [first, second]: [f64; 2]) -> Problem {
        let mut problem = self.problem.clone();
        problem.wave.start = self.start.clone();
        problem.stability = None;
        problem.output = crate::problem::Output::default();
        let model = problem.model.with(self.map.first.parameter, first);
        problem.model = model.with(self.map.second.parameter, second);
        problem
    }

    /// How to follow the second parameter: with the steps of the `continuation` section, if any.
    fn continuation(&self, toward: Toward, stop_at: Vec<f64>) -> Continuation {
        let axis = &self.map.second;
        let defaults = Continuation::new(axis.parameter, axis.range);
        let steps = self.problem.continuation.as_ref().unwrap_or(&defaults);
        Continuation {
            toward,
            stop_at,
            ds: steps.ds,
            ds_min: steps.ds_min,
            ds_max: steps.ds_max,
            tolerance: steps.tolerance,
            max_points: Some(steps.most_points(self.problem.model.law).min(MOST_POINTS)),
            ..defaults.clone()
        }
    }

    /// The branch through a row of a grid, and why it does not come to the cells it misses.
    fn along(&self, points: &[[f64; 2]]) -> Result<(Vec<Hit>, String), RunError> {
        let (low, high) = self.map.second.range;
        let first = points[0][0];
        let inner: Vec<f64> = points
            .iter()
            .map(|point| point[1])
            .filter(|value| *value > low && *value < high)
            .collect();
        let mut reason = None;
        for value in self.starting_values() {
            let toward = match value {
                value if value == low => Toward::Up,
                value if value == high => Toward::Down,
                _ => Toward::Both,
            };
            let continuation = self.continuation(toward, inner.clone());
            let problem = self.at([first, value]);
            match Runner::begin(&problem, &continuation, None) {
                Ok(branch) => return Ok(self.walk(branch, points)),
                Err(RunError::NoStart(no_start)) => {
                    reason.get_or_insert(no_start.to_string());
                }
                Err(error) => return Err(error),
            }
        }
        Ok((Vec::new(), reason.unwrap_or_default()))
    }

    /// Values of the second parameter at which a first wave is looked for. At a large mismatch the
    /// wave is slip-stick in closed form; if the branch does not come down to there, it does not
    /// come to smaller ones either.
    fn starting_values(&self) -> Vec<f64> {
        let (low, high) = self.map.second.range;
        if self.map.second.parameter == Parameter::Mismatch {
            return vec![high];
        }
        let own = self.problem.model.value(self.map.second.parameter);
        let mut values: Vec<f64> = own
            .into_iter()
            .filter(|value| (low..=high).contains(value))
            .chain([high, low])
            .chain(INNER_STARTS.map(|part| low + part * (high - low)))
            .collect();
        let mut seen = Vec::new();
        values.retain(|value| {
            let new = !seen.contains(value);
            seen.push(*value);
            new
        });
        values
    }

    /// Follows a branch to its end and keeps what lies on the grid.
    fn walk(&self, mut branch: Runner, points: &[[f64; 2]]) -> (Vec<Hit>, String) {
        let mut hits: Vec<Hit> = Vec::new();
        let (mut leg, mut begun) = (1, false);
        let mut seeds = None;
        let (low, high) = self.map.second.range;
        let mut turned_back = false;
        while branch.progress().end.is_none() && !turned_back {
            for item in branch.step() {
                // a second leg begins with the first point once more, a closed branch ends with it
                let again = item.leg != leg;
                leg = item.leg;
                let first = !std::mem::replace(&mut begun, true);
                let Some(column) = self.column(&item, points) else {
                    continue;
                };
                let value = points[column][1];
                let inside = value > low && value < high;
                let closes = item.point.kind == Some(EventType::EP) && inside && !first;
                if again || closes {
                    continue;
                }
                let mut hit = Hit {
                    column,
                    point: item.point.clone(),
                };
                if hits.iter().any(|other| hit.is(other)) {
                    // where there is no stick a branch can end on itself: all that follows is known
                    turned_back = true;
                    break;
                }
                self.add_stability(&item, &mut seeds, &mut hit.point);
                hits.push(hit);
            }
        }
        let why = match &branch.progress().end {
            Some(End::Failed(reason)) => format!("the branch ends before: {reason}"),
            _ if turned_back => "the branch comes back to waves it has passed before".to_owned(),
            _ => "the branch does not come here".to_owned(),
        };
        (hits, why)
    }

    /// The column that a point of a branch lies on: values asked for and edges are met exactly.
    fn column(&self, item: &Item, points: &[[f64; 2]]) -> Option<usize> {
        let kind = item.point.kind?;
        if !matches!(kind, EventType::UZ | EventType::EP) {
            return None;
        }
        let value = item
            .saved
            .as_ref()?
            .model
            .value(self.map.second.parameter)?;
        points
            .binary_search_by(|point| point[1].total_cmp(&value))
            .ok()
    }

    /// Quasi-random points, each by itself, and why there is nothing where there is nothing.
    fn one_by_one(&self, points: &[[f64; 2]]) -> Result<(Vec<Hit>, Vec<String>), RunError> {
        let mut hits = Vec::new();
        let mut whys = vec![String::new(); points.len()];
        let continuation = self.continuation(Toward::Both, Vec::new());
        for (column, values) in points.iter().enumerate() {
            match Runner::begin(&self.at(*values), &continuation, None) {
                Ok(mut branch) => {
                    for item in branch.step() {
                        let mut point = item.point.clone();
                        self.add_stability(&item, &mut None, &mut point);
                        hits.push(Hit { column, point });
                    }
                }
                Err(RunError::NoStart(reason)) => whys[column] = reason.to_string(),
                Err(error) => return Err(error),
            }
        }
        Ok((hits, whys))
    }

    /// Adds the stability of a wave to its point where that is asked for. `seeds` is the spectrum
    /// of the cell before on the branch.
    fn add_stability(&self, item: &Item, seeds: &mut Option<Spectrum>, point: &mut BranchPoint) {
        let Some(request) = &self.request else {
            return;
        };
        let (wave, unknowns) = item.wave();
        let found = Characteristic::new(wave, unknowns)
            .ok()
            .map(|characteristic| spectrum(&characteristic, request, seeds.as_ref()));
        answer(point, found.as_ref(), wave, unknowns);
        *seeds = found;
    }
}
