//! What motions of a system settle on at the points of a plane, each by itself.

use serde::Serialize;

use super::cell::CellRow;
use super::plane::Plane;
use crate::affine::motion::Halt;
use crate::affine::orbit::start::{NoStart as NoOrbit, Search};
use crate::affine::system::{Source, System};
use crate::continuation::newton;
use crate::hybrid::row::OrbitColumns;
use crate::hybrid::run::point;
use crate::hybrid::{NoStart, OrbitPoint, come_to};
use crate::orbit::Orbit as _;
use crate::problem::{Beginning, Continuation, OrbitStart, SystemProblem};

/// What the motion from a start settles on at a point of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Row, from 0: along it the first parameter of a grid is constant.
    pub row: usize,
    /// Column, from 0.
    pub column: usize,
    /// Number of the start, from 1.
    pub start: usize,
    /// Values of the parameters in the order of the file.
    pub parameters: Vec<f64>,
    /// What that is.
    pub found: Settled,
}

/// What a motion settles on.
#[derive(Clone, Debug, PartialEq)]
pub enum Settled {
    /// A periodic orbit.
    Orbit {
        /// The orbit. Its place on a branch means nothing here.
        point: Box<OrbitPoint>,
        /// Periods of the forcing that make it; none without.
        periods: Option<u32>,
    },
    /// No orbit, for this reason: the motion comes to rest, does not return or go on, or what it does is not known.
    Nothing(NoStart),
}

/// The word of the column `found` where it is not known what a motion does.
pub(crate) const UNDECIDED: &str = "undecided";

/// The word where the system makes no sense.
pub(crate) const NONE: &str = "none";

impl Settled {
    /// In a word.
    pub fn word(&self) -> &'static str {
        let reason = match self {
            Settled::Orbit { .. } => return "orbit",
            Settled::Nothing(NoStart::NoOrbit(reason)) => reason,
            Settled::Nothing(_) => return UNDECIDED,
        };
        match reason {
            NoOrbit::Rests { .. } => "equilibrium",
            NoOrbit::NotPeriodic { .. } => "not periodic",
            NoOrbit::Halted(halt) | NoOrbit::Stuck { halt, .. } => match halt {
                Halt::Chattering { .. } => "chattering",
                Halt::Unbounded { .. } => "unbounded",
                Halt::Livelock { .. }
                | Halt::SecondOrder { .. }
                | Halt::TwoSurfaces { .. }
                | Halt::Parted { .. } => "slides",
                Halt::NoExit { .. }
                | Halt::Undecided { .. }
                | Halt::Outside { .. }
                | Halt::Outward { .. }
                | Halt::Void { .. }
                | Halt::Fast { .. } => "stuck",
            },
            NoOrbit::System(_) => NONE,
            _ => UNDECIDED,
        }
    }
}

/// The motions of a map, any row of which can be computed by itself.
pub struct Motions<'a> {
    problem: &'a SystemProblem,
    plane: Plane,
    /// Places of the two parameters among all.
    parameters: [usize; 2],
    /// In which parameter an orbit would be followed, and how far.
    along: Continuation<String>,
    settle: f64,
    starts: Vec<Beginning>,
}

impl<'a> Motions<'a> {
    /// The map of a problem that has passed every check; none without a section `map`.
    pub fn new(problem: &'a SystemProblem) -> Option<Motions<'a>> {
        let map = problem.map.as_ref()?;
        let OrbitStart::Simulate { settle, .. } = problem.orbit.start else {
            return None;
        };
        let names = &problem.system.source.parameters;
        let mut starts = map.starts.clone();
        if starts.is_empty() {
            starts.extend(problem.orbit.start.beginning());
        }
        Some(Motions {
            problem,
            plane: Plane::new(map),
            parameters: [
                names.index(&map.first.parameter)?,
                names.index(&map.second.parameter)?,
            ],
            along: Continuation::new(map.second.parameter.clone(), map.second.range),
            settle,
            starts,
        })
    }

    /// All cells of a row: by start, by column.
    pub fn row(&self, row: usize) -> Vec<Outcome> {
        let points = self.plane.row(row);
        let of_start = |(start, beginning): (usize, &Beginning)| {
            let cells = points.iter().enumerate().map(|(column, point)| {
                let mut parameters = self.problem.values();
                for (index, value) in self.parameters.into_iter().zip(point) {
                    parameters[index] = *value;
                }
                let found = self.settled(beginning, &parameters);
                Outcome {
                    row,
                    column,
                    start: start + 1,
                    found: found.unwrap_or_else(Settled::Nothing),
                    parameters,
                }
            });
            cells.collect::<Vec<_>>()
        };
        let starts = self.starts.iter().enumerate();
        starts.flat_map(of_start).collect()
    }

    fn settled(&self, beginning: &Beginning, parameters: &[f64]) -> Result<Settled, NoStart> {
        let search = Search::Settles(self.settle);
        let values = parameters.to_vec();
        let (orbit, unknowns) =
            come_to(self.problem, &self.along, values.clone(), beginning, search)?;
        let examination = orbit.examination(&unknowns).map_err(|failure| {
            NoStart::NoOrbit(NoOrbit::Newton(newton::Failure::System(failure)))
        })?;
        let asked = self.problem.stability.is_some();
        let point = point((&orbit, &unknowns), &examination, None, values, asked);
        Ok(Settled::Orbit {
            point: Box::new(point),
            periods: orbit.is_forced().then_some(orbit.setting.periods),
        })
    }
}

/// What a row of `map.csv` tells of a motion.
#[derive(Clone, Debug, Serialize)]
pub struct SettledColumns<'a> {
    periods: Option<u32>,
    orbit: OrbitColumns<'a>,
}

impl<'a> CellRow<SettledColumns<'a>> {
    /// A row for the names of its columns.
    pub fn columns(source: &Source) -> CellRow<SettledColumns<'a>> {
        CellRow {
            row: 0,
            column: 0,
            start: String::new(),
            passage: 0,
            found: "",
            there: SettledColumns {
                periods: None,
                orbit: OrbitColumns::without(source, None, None),
            },
            why: String::new(),
        }
    }

    /// What was found at a point.
    pub fn settled(system: &'a System, cell: &'a Outcome) -> CellRow<SettledColumns<'a>> {
        let source = &system.source;
        let (orbit, periods, why) = match &cell.found {
            Settled::Orbit { point, periods } => {
                (OrbitColumns::new(source, point), *periods, String::new())
            }
            Settled::Nothing(reason) => {
                let (rest, why) = match reason {
                    NoStart::NoOrbit(NoOrbit::Rests { place, .. }) => (Some(place), String::new()),
                    NoStart::NoOrbit(reason) => (None, reason.to_string()),
                    other => (None, other.to_string()),
                };
                let rest = rest.map(|place| (system.mode_name(place.mode), &place.state[..]));
                let orbit = OrbitColumns::without(source, Some(&cell.parameters), rest);
                (orbit, None, why)
            }
        };
        let found = cell.found.word();
        CellRow {
            row: cell.row,
            column: cell.column,
            start: cell.start.to_string(),
            passage: usize::from(["orbit", "equilibrium"].contains(&found)),
            found,
            there: SettledColumns { periods, orbit },
            why,
        }
    }
}
