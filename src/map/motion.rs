//! What motions of a system settle on at the points of a plane, each by itself.

use std::f64::consts::TAU;

use serde::Serialize;

use super::cell::CellRow;
use super::plane::MapPlane;
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Halt, Moment, Motion};
use crate::affine::orbit::AffineOrbit;
use crate::affine::orbit::start::{NoStart as NoOrbit, Search};
use crate::affine::system::{Ordered, Source, System};
use crate::continuation::newton;
use crate::hybrid::row::OrbitColumns;
use crate::hybrid::run::point;
use crate::hybrid::{NoFirstPoint, OrbitPoint, come_to};
use crate::linalg::Vector;
use crate::orbit::Zones;
use crate::problem::{BeginningSection, Continuation, Multipliers, OrbitStart, SystemProblem};

/// What the motion from a start settles on at a point of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionOutcome {
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
    /// In a basin of attraction, a point of it that tells what attracts the motion.
    pub mark: Option<OrbitMark>,
}

/// A point of an orbit: an entry of a zone or, where it never switches, where its equations begin; or a point of rest.
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitMark {
    /// Phase of the forcing in \[0, 2π).
    pub phase: f64,
    /// State.
    pub state: Vec<f64>,
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
    Nothing(NoFirstPoint),
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
            Settled::Nothing(NoFirstPoint::NoOrbit(reason)) => reason,
            Settled::Nothing(NoFirstPoint::Contradicted(_)) => return "stuck",
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
                | Halt::Outside { .. }
                | Halt::Outward { .. }
                | Halt::Refused { .. }
                | Halt::NegativeBound { .. }
                | Halt::Obstructed { .. } => "stuck",
                Halt::Undecided { .. } | Halt::Void { .. } | Halt::Fast { .. } => UNDECIDED,
            },
            NoOrbit::System(_) => NONE,
            _ => UNDECIDED,
        }
    }
}

/// What changes over the plane: parameters by their places among all, or states in which motions begin by their names.
enum Varied {
    Parameters([usize; 2]),
    States([String; 2]),
}

/// An orbit that a motion settles on, and its unknowns.
pub(super) type SettledOrbit = (AffineOrbit, Vector);

/// The motions of a map, any row of which can be computed by itself.
pub struct Motions<'a> {
    problem: &'a SystemProblem,
    /// The same, with stability.
    decided: SystemProblem,
    plane: MapPlane,
    varied: Varied,
    /// The system at the values of its parameters, where states vary.
    affine: Option<AffineSystem>,
    /// In which parameter an orbit would be followed, and how far.
    along: Continuation<String>,
    settle: f64,
    starts: Vec<BeginningSection>,
}

impl<'a> Motions<'a> {
    /// The map of a problem that has passed every check; none without a section `map`.
    pub fn new(problem: &'a SystemProblem) -> Option<Motions<'a>> {
        let map = problem.map.as_ref()?;
        let OrbitStart::Simulate { settle, .. } = problem.orbit.start else {
            return None;
        };
        let names = &problem.system.source.parameters;
        let sides = [&map.first, &map.second];
        let varied = match map.is_basin() {
            true => Varied::States(sides.map(|side| side.name().to_owned())),
            false => {
                let [first, second] = sides.map(|side| names.index(side.name()));
                Varied::Parameters([first?, second?])
            }
        };
        let along = match map.is_basin() {
            true => resting(problem)?,
            false => Continuation::new(map.second.name().to_owned(), map.second.range),
        };
        let mut starts = map.starts.clone();
        if starts.is_empty() {
            starts.extend(problem.orbit.start.beginning());
        }
        Some(Motions {
            decided: SystemProblem {
                stability: Some(Multipliers {}),
                ..problem.clone()
            },
            problem,
            plane: MapPlane::new(map),
            affine: match varied {
                Varied::States(_) => problem.system.at(&problem.values(), &[]).ok(),
                Varied::Parameters(_) => None,
            },
            varied,
            along,
            settle,
            starts,
        })
    }

    /// All cells of a row: by start, by column.
    pub fn row(&self, row: usize) -> Vec<MotionOutcome> {
        let points = self.plane.row(row);
        let of_start = |(start, beginning): (usize, &BeginningSection)| {
            let cells = points.iter().enumerate().map(|(column, point)| {
                let (beginning, parameters) = self.begun(beginning, *point);
                let asked = self.problem.stability.is_some();
                let found = self.settled(&beginning, &parameters, asked);
                let marked = matches!(self.varied, Varied::States(_));
                let (found, orbit) = match found {
                    Ok((found, orbit)) => (found, Some(orbit)),
                    Err(reason) => (Settled::Nothing(reason), None),
                };
                MotionOutcome {
                    row,
                    column,
                    start: start + 1,
                    mark: marked
                        .then(|| OrbitMark::of(&found, orbit.as_ref()))
                        .flatten(),
                    found,
                    parameters,
                }
            });
            cells.collect::<Vec<_>>()
        };
        let starts = self.starts.iter().enumerate();
        starts.flat_map(of_start).collect()
    }

    /// The orbit that the motion of a cell settles on, with its stability; none where it comes to none.
    pub(super) fn orbit(
        &self,
        [row, column, start]: [usize; 3],
    ) -> Option<(Settled, SettledOrbit)> {
        let beginning = self.starts.get(start.checked_sub(1)?)?;
        let point = *self.plane.row(row).get(column)?;
        let (beginning, parameters) = self.begun(beginning, point);
        self.settled(&beginning, &parameters, true).ok()
    }

    /// Largest sizes of the states in which motions begin.
    pub(super) fn scales(&self) -> Vec<f64> {
        let system = &self.problem.system;
        let names = system.source.states.iter();
        let begun = self.starts.iter().flat_map(|start| {
            let corners = self.plane.corners();
            corners.map(|corner| {
                let (beginning, values) = self.begun(start, corner);
                let at = system.at(&values, &[]).ok()?;
                beginning.place(system, &at)
            })
        });
        let begun: Vec<Moment> = begun.flatten().collect();
        let sizes = names.enumerate().map(|(state, _)| {
            let all = begun.iter().map(|place| place.state[state].abs());
            all.fold(0.0, f64::max)
        });
        sizes.collect()
    }

    /// Where the motion of a start begins at a point of the plane, and the values of the parameters there.
    fn begun(&self, beginning: &BeginningSection, point: [f64; 2]) -> (BeginningSection, Vec<f64>) {
        let mut parameters = self.problem.values();
        let mut beginning = beginning.clone();
        match &self.varied {
            Varied::Parameters(places) => {
                for (index, value) in places.iter().zip(point) {
                    parameters[*index] = value;
                }
            }
            Varied::States(names) => {
                for (name, value) in names.iter().zip(point) {
                    let Ordered(states) = &mut beginning.state;
                    match states.iter_mut().find(|(known, _)| known == name) {
                        Some((_, state)) => *state = value,
                        None => states.push((name.clone(), value)),
                    }
                }
                let system = &self.problem.system;
                // of contacts the motion itself says in which states they begin
                if system.products.is_none()
                    && let Some(affine) = &self.affine
                    && let Some(place) = beginning.place(system, affine)
                {
                    let mode = fitting(system, affine, place).mode;
                    beginning.mode = system.mode_name(mode).into_owned();
                }
            }
        }
        (beginning, parameters)
    }

    pub(super) fn settled(
        &self,
        beginning: &BeginningSection,
        parameters: &[f64],
        asked: bool,
    ) -> Result<(Settled, SettledOrbit), NoFirstPoint> {
        let search = Search::Settles(self.settle);
        let values = parameters.to_vec();
        let problem = if asked { &self.decided } else { self.problem };
        let (orbit, unknowns) = come_to(problem, &self.along, values.clone(), beginning, search)?;
        let examination = orbit.examination(&unknowns).map_err(|failure| {
            NoFirstPoint::NoOrbit(NoOrbit::Newton(newton::Failure::System(failure)))
        })?;
        let point = point((&orbit, &unknowns), &examination, None, values, asked);
        let settled = Settled::Orbit {
            point: Box::new(point),
            periods: orbit.is_forced().then_some(orbit.setting.periods),
        };
        Ok((settled, (orbit, unknowns)))
    }
}

/// A place in the mode that its state lies in: its own or, where it does not fit that, the first of the file with which no
/// `zero` is negative; with contacts their states follow from slips and gaps.
pub(super) fn fitting(system: &System, affine: &AffineSystem, place: Moment) -> Moment {
    if system.products.is_some() {
        return system.fitting(affine, place.clone()).unwrap_or(place);
    }
    let inside = |place: &Moment| Motion::new(affine, place.clone(), 1.0).is_inside();
    if inside(&place) {
        return place;
    }
    // a sliding mode lies in its surface alone
    let written = 0..system.source.modes.0.len();
    let others = written.map(|mode| Moment {
        mode,
        ..place.clone()
    });
    let fits = others.into_iter().find(inside);
    fits.unwrap_or(place)
}

/// A branch for orbits that are not followed: their equations have a parameter among the unknowns, in a unit.
fn resting(problem: &SystemProblem) -> Option<Continuation<String>> {
    if let Some(section) = &problem.continuation {
        return Some(section.clone());
    }
    /// A parameter changes by this part of itself, or of 1 where it is zero.
    const PART: f64 = 0.1;
    let (name, value) = problem.system.source.parameters.0.first()?;
    let width = PART * if *value == 0.0 { 1.0 } else { value.abs() };
    Some(Continuation::new(
        name.clone(),
        (value - width, value + width),
    ))
}

impl OrbitMark {
    pub(super) fn of(found: &Settled, orbit: Option<&SettledOrbit>) -> Option<OrbitMark> {
        if let Settled::Nothing(NoFirstPoint::NoOrbit(NoOrbit::Rests { place, .. })) = found {
            return Some(OrbitMark {
                phase: 0.0,
                state: place.state.clone(),
            });
        }
        let (orbit, unknowns) = orbit?;
        let first = orbit.cycle(unknowns).ok()?.first;
        let zone = orbit.saved(unknowns).ok()?.zones.swap_remove(first);
        Some(OrbitMark {
            phase: zone.phase.rem_euclid(TAU),
            state: zone.state,
        })
    }
}

/// What a row of `map.csv` tells of a motion in a basin of attraction.
#[derive(Clone, Debug, Serialize)]
pub struct BasinColumns<'a> {
    attractor: Option<usize>,
    settled: SettledColumns<'a>,
    mark: Vec<f64>,
}

impl<'a> CellRow<BasinColumns<'a>> {
    /// The row of a map with the mark of a basin, and room for the number of the attractor.
    pub fn of_basin(row: CellRow<SettledColumns<'a>>, mark: Option<&OrbitMark>) -> Self {
        let mark = mark.map(|mark| [&[mark.phase], &mark.state[..]].concat());
        CellRow {
            row: row.row,
            column: row.column,
            start: row.start,
            passage: row.passage,
            found: row.found,
            there: BasinColumns {
                attractor: None,
                settled: row.there,
                mark: mark.unwrap_or_default(),
            },
            why: row.why,
        }
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
    pub fn settled(system: &'a System, cell: &'a MotionOutcome) -> CellRow<SettledColumns<'a>> {
        let source = &system.source;
        let (orbit, periods, why) = match &cell.found {
            Settled::Orbit { point, periods } => {
                (OrbitColumns::new(source, point), *periods, String::new())
            }
            Settled::Nothing(reason) => {
                let (rest, why) = match reason {
                    NoFirstPoint::NoOrbit(NoOrbit::Rests { place, .. }) => {
                        (Some(place), String::new())
                    }
                    NoFirstPoint::NoOrbit(reason) => (None, reason.to_string()),
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
