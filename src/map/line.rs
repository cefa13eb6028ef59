//! A line through the plane of a map: one parameter constant, the other one followed.

use crate::orbit::legs::Run as _;
use std::path::PathBuf;

use super::cell::Missing;
use crate::branch::run::{RunError, WaveItem, WaveRunner, answer};
use crate::branch::special::{Failure, Special};
use crate::branch::{BranchPoint, EventType, SavedWave};
use crate::problem::{Continuation, MapAxis, Output, Problem, Start, Toward, UserPoint};
use crate::tube::model::Parameter;
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::spectrum::{Spectrum, SpectrumRequest, spectrum};

/// Points after which either way of a branch within a row is given up: round folds it passes the range a few
/// times, at the default step lengths a hundred points each.
pub const MOST_POINTS: usize = 20_000;

/// Parts of the range at which a wave to begin with is looked for, after the ends, where the
/// parameter that is followed is not the mismatch.
const INNER_STARTS: [f64; 3] = [0.5, 0.25, 0.75];

/// Relative difference of speed and amplitude up to which two waves at the same parameters are one:
/// far above what solving leaves, 1e-13, far below what tells neighbours at a fold apart.
const SAME_WAVE: f64 = 1e-9;

/// A wave of a branch at one of the values of a line.
#[derive(Clone, Debug)]
pub(super) struct Hit {
    pub index: usize,
    /// The wave as a point of its branch.
    pub point: BranchPoint,
    /// What a branch begins with.
    pub saved: SavedWave,
}

impl Hit {
    /// Whether this is a wave met before.
    pub fn is(&self, other: &Hit) -> bool {
        let close = |one: f64, other: f64| (one - other).abs() <= SAME_WAVE * other.abs();
        self.index == other.index
            && close(self.point.speed, other.point.speed)
            && close(self.point.amplitude, other.point.amplitude)
    }
}

/// Where a branch fails: values beyond are not reached by it.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    /// Value of the parameter that is followed.
    at: f64,
    /// Whether it was on its way to larger values.
    up: bool,
    failure: Failure,
}

impl Gap {
    /// Why a value is not reached, if it lies beyond.
    pub fn hides(&self, value: f64) -> Option<Missing> {
        let beyond = if self.up {
            value >= self.at
        } else {
            value <= self.at
        };
        beyond.then(|| Missing::Cut(self.failure.clone()))
    }
}

/// What a branch meets on a line.
#[derive(Debug, Default)]
pub(super) struct Met {
    /// Its waves at the values, in its order.
    pub hits: Vec<Hit>,
    pub gaps: Vec<Gap>,
    /// Why it meets nothing, or nothing more.
    pub missing: Option<Missing>,
}

/// A line and how it is followed.
pub(super) struct MapLine<'a> {
    pub problem: &'a Problem,
    /// The parameter that is followed, and its range.
    pub along: MapAxis,
    /// The parameter that is constant, and its value.
    pub across: (Parameter, f64),
    pub values: Vec<f64>,
    /// The spectra that are wanted.
    pub request: Option<SpectrumRequest>,
}

impl MapLine<'_> {
    /// The branch that begins with a slip-stick wave.
    ///
    /// # Errors
    /// When the problem asks for something that no line can have; a wave that does not exist is none.
    pub fn follow_start(&self, start: &Start) -> Result<Met, RunError> {
        let (low, high) = self.along.range;
        let mut reason = None;
        for value in self.starting_values() {
            let toward = match value {
                value if value == low => Toward::Up,
                value if value == high => Toward::Down,
                _ => Toward::Both,
            };
            let mut met = Met::default();
            match self.begin(start.clone(), value, toward, None) {
                Ok(branch) => {
                    let back = self.walk(branch, false, &|_| false, &mut met);
                    met.missing = Some(if back {
                        Missing::ComesBack
                    } else {
                        Missing::Elsewhere
                    });
                    return Ok(met);
                }
                Err(RunError::NoStart(no_start)) => {
                    reason.get_or_insert(Missing::NoStart(no_start));
                }
                Err(error) => return Err(error),
            }
        }
        Ok(Met {
            missing: reason,
            ..Met::default()
        })
    }

    /// The branch through a wave at one of the values, as far as it meets waves that are not known.
    ///
    /// # Errors
    /// As [`MapLine::follow_start`].
    pub fn follow_wave(&self, from: &Hit, known: &dyn Fn(&Hit) -> bool) -> Result<Met, RunError> {
        let mut met = Met::default();
        let (low, high) = self.along.range;
        let value = self.values[from.index];
        let ways = [(Toward::Down, low), (Toward::Up, high)];
        for (toward, _) in ways.into_iter().filter(|(_, edge)| *edge != value) {
            let start = Start::Restart {
                dir: PathBuf::new(),
                label: from.saved.label,
            };
            match self.begin(start, value, toward, Some(&from.saved)) {
                Ok(branch) => {
                    let again = !met.hits.is_empty();
                    self.walk(branch, again, known, &mut met);
                }
                // a fold in this parameter: the branch through it is that of the other way
                Err(RunError::NoStart(_)) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(met)
    }

    /// A branch that begins at a value, with a slip-stick wave or a saved one.
    ///
    /// # Errors
    /// As [`MapLine::follow_start`], and when there is no such wave.
    pub fn begin(
        &self,
        start: Start,
        value: f64,
        toward: Toward,
        wave: Option<&SavedWave>,
    ) -> Result<WaveRunner, RunError> {
        let (low, high) = self.along.range;
        let inner = self.values.iter().copied();
        let inner = inner.filter(|value| *value > low && *value < high);
        let continuation = self.continuation(toward, inner.map(UserPoint::from).collect());
        WaveRunner::begin(&self.at(start, value), &continuation, wave)
    }

    /// The problem at a value. Stability is left out: it is wanted at the values only.
    fn at(&self, start: Start, value: f64) -> Problem {
        let mut problem = self.problem.clone();
        problem.wave.start = start;
        problem.stability = None;
        problem.output = Output::default();
        let model = problem.model.with(self.across.0, self.across.1);
        problem.model = model.with(self.along.parameter, value);
        problem
    }

    /// How to follow the line: with the steps of the `continuation` section, if any.
    fn continuation(&self, toward: Toward, stop_at: Vec<UserPoint>) -> Continuation {
        let defaults = Continuation::new(self.along.parameter, self.along.range);
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

    /// Values at which a first wave is looked for. At a large mismatch the wave is slip-stick in closed
    /// form; if the branch does not come down to there, it does not come to smaller ones either.
    fn starting_values(&self) -> Vec<f64> {
        let (low, high) = self.along.range;
        if self.along.parameter == Parameter::Mismatch {
            return vec![high];
        }
        let own = self.problem.model.value(self.along.parameter);
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

    /// Follows a branch to its end and keeps the waves at the values. Returns whether it has come to
    /// waves that are known; `again` says that its first one is.
    fn walk(
        &self,
        mut branch: WaveRunner,
        again: bool,
        known: &dyn Fn(&Hit) -> bool,
        met: &mut Met,
    ) -> bool {
        let (mut leg, mut begun) = (1, false);
        let mut seeds = None;
        let (low, high) = self.along.range;
        // the last two values of the parameter: the way of the branch
        let (mut before, mut here) = (f64::NAN, f64::NAN);
        while branch.progress().end.is_none() {
            for item in branch.step() {
                // a second leg begins with the first point once more, a closed branch ends with it
                let second = item.leg != leg;
                leg = item.leg;
                let first = !std::mem::replace(&mut begun, true);
                let value = item.point.model.value(self.along.parameter);
                let value = value.unwrap_or(f64::NAN);
                if value != here {
                    (before, here) = (here, value);
                }
                if let Some(Special::Failed(failure)) = &item.special {
                    met.gaps.push(Gap {
                        at: value,
                        up: here > before,
                        failure: failure.clone(),
                    });
                }
                let Some(index) = self.index(&item) else {
                    continue;
                };
                let inside = value > low && value < high;
                let closes = item.point.kind == Some(EventType::EP) && inside && !first;
                let Some(saved) = item.saved.clone() else {
                    continue;
                };
                if second || closes || (first && again) {
                    continue;
                }
                let mut hit = Hit {
                    index,
                    point: item.point.clone(),
                    saved,
                };
                if known(&hit) || met.hits.iter().any(|other| hit.is(other)) {
                    return true;
                }
                self.add_stability(&item, &mut seeds, &mut hit.point);
                met.hits.push(hit);
            }
        }
        false
    }

    /// The number of the value that a point of a branch lies on: those asked for and edges are met
    /// exactly.
    fn index(&self, item: &WaveItem) -> Option<usize> {
        if !matches!(item.point.kind?, EventType::UZ | EventType::EP) {
            return None;
        }
        let saved = item.saved.as_ref()?;
        let value = saved.model.value(self.along.parameter)?;
        self.values
            .binary_search_by(|one| one.total_cmp(&value))
            .ok()
    }

    /// Adds the stability of a wave to its point where that is asked for. `seeds` is the spectrum
    /// of the wave before on the branch.
    pub fn add_stability(
        &self,
        item: &WaveItem,
        seeds: &mut Option<Spectrum>,
        point: &mut BranchPoint,
    ) {
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
