//! What attracts the motions of a basin, each once: orbits that differ by their phase alone are one attractor.
//!
//! Cells are told apart by a mark, a point of their orbit, which lies on an orbit that is known or not. So a table can be
//! numbered when all of its rows are there, whoever computed them, in the order of its cells.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use super::motion::{Motions, OrbitMark, Settled, SettledOrbit};
use crate::affine::flow::{FlowPiece, ModeFlow};
use crate::affine::mode::AffineSystem;
use crate::affine::system::System;
use crate::hybrid::{LabelledOrbit, OrbitPoint};
use crate::linalg::{Vector, product};

/// Points of attractors are the same where no state differs by more than this part of its largest size there, and no phase by
/// more of a turn: Newton's method leaves 1e-10 in the worst of orbits that attract.
const SAME: f64 = 1e-6;

/// A state between two points of rest rests, too, where no rate is more than this part of its terms.
const RESTS: f64 = 1e-9;

/// What a row of the table tells of a motion.
#[derive(Clone, Debug)]
pub struct SettledCell<'a> {
    /// Row, column and number of the start.
    pub place: [usize; 3],
    /// `orbit`, `equilibrium`, or another word.
    pub found: &'a str,
    /// The modes.
    pub regimes: &'a str,
    /// Periods of the forcing, if there is one.
    pub periods: Option<u32>,
    /// A point of it.
    pub mark: OrbitMark,
}

/// What attracts motions.
#[derive(Clone, Debug)]
pub struct Attractor {
    /// The modes of an orbit, or that of a point of rest.
    pub regimes: String,
    /// Periods of the forcing that an orbit takes, if there is one.
    pub periods: Option<u32>,
    /// State where the phase is zero, or that of the point that a motion is known by.
    pub state: Vec<f64>,
    /// The orbit, with its number as label; none of a point of rest.
    pub orbit: Option<(Box<OrbitPoint>, LabelledOrbit)>,
    /// How many cells come to it.
    pub cells: usize,
    /// Points that a mark may be.
    marks: Vec<OrbitMark>,
    /// All of them, of a cycle without switches and forcing.
    trace: Option<CycleTrace>,
    /// Largest sizes of the states.
    sizes: Vec<f64>,
}

/// Finds the orbit that the motion of a cell settles on, with its stability.
pub(super) type FindOrbit<'a> = Box<dyn Fn([usize; 3]) -> Option<(Settled, SettledOrbit)> + 'a>;

/// The attractors of a basin in the order in which its cells come to them.
pub struct Attractors<'a> {
    find: FindOrbit<'a>,
    system: &'a System,
    /// At the values of its parameters.
    affine: Option<AffineSystem>,
    /// Sizes of the states in which motions begin.
    scales: Vec<f64>,
    /// Those that have been met.
    pub met: Vec<Attractor>,
    /// How many cells there are.
    pub cells: usize,
}

impl<'a> Attractors<'a> {
    /// Those of motions at the values of the parameters in the file, of which none is known yet.
    pub fn new(motions: &'a Motions<'a>, system: &'a System) -> Attractors<'a> {
        let find = Box::new(|place| motions.orbit(place));
        Attractors::at(find, (system, &system.values()), motions.scales())
    }

    /// The same at other values.
    pub(super) fn at(
        find: FindOrbit<'a>,
        (system, values): (&'a System, &[f64]),
        scales: Vec<f64>,
    ) -> Attractors<'a> {
        // a state that begins at zero everywhere is compared with the others
        let largest = scales
            .iter()
            .fold(0.0, |largest: f64, scale| largest.max(*scale));
        let scale = |scale: f64| if scale > 0.0 { scale } else { largest };
        Attractors {
            find,
            scales: scales.into_iter().map(scale).collect(),
            affine: system.at(values, &[]).ok(),
            system,
            met: Vec::new(),
            cells: 0,
        }
    }

    /// Names of the states.
    pub fn states(&self) -> &[String] {
        &self.system.source.states
    }

    /// The number, from 1, of what attracts the motion of a cell; none where it comes to neither an orbit nor rest.
    pub fn number(&mut self, cell: &SettledCell) -> Option<usize> {
        self.cells += 1;
        let known = self.met.iter().position(|one| self.is_at(one, cell));
        let number = match known {
            Some(index) => index + 1,
            None => {
                let attractor = self.attractor(cell)?;
                self.met.push(attractor);
                self.met.len()
            }
        };
        self.met[number - 1].cells += 1;
        Some(number)
    }

    /// What attracts the motion of a cell, where nothing like it is known.
    fn attractor(&self, cell: &SettledCell) -> Option<Attractor> {
        let plain = Attractor {
            regimes: cell.regimes.to_owned(),
            periods: cell.periods,
            state: cell.mark.state.clone(),
            orbit: None,
            cells: 0,
            marks: vec![cell.mark.clone()],
            trace: None,
            sizes: {
                let pairs = cell.mark.state.iter().zip(&self.scales);
                pairs.map(|(x, scale)| x.abs().max(*scale)).collect()
            },
        };
        match cell.found {
            "equilibrium" => Some(plain),
            "orbit" => {
                let (settled, (orbit, unknowns)) = (self.find)(cell.place)?;
                let Settled::Orbit { point, .. } = settled else {
                    return None;
                };
                let saved = orbit.saved(&unknowns).ok()?;
                let strobes: Vec<OrbitMark> = match &self.affine {
                    Some(affine) if affine.omega.value > 0.0 => {
                        let states = saved.strobes(affine).into_iter();
                        states
                            .map(|state| OrbitMark { phase: 0.0, state })
                            .collect()
                    }
                    _ => Vec::new(),
                };
                let extremes = point.extremes.iter();
                let entries = saved.zones.iter().map(|zone| OrbitMark {
                    phase: zone.phase.rem_euclid(TAU),
                    state: zone.state.clone(),
                });
                let never = point.switches.is_empty();
                let affine = self.affine.as_ref().filter(|_| never && strobes.is_empty());
                let trace = affine.and_then(|affine| {
                    let (part, at) = saved.sequence.0.iter().zip(&saved.zones).next()?;
                    let begin = affine.lift(part.mode, &at.state, 0.0);
                    Some(CycleTrace::new(affine, part.mode, begin, at.duration))
                });
                Some(Attractor {
                    trace,
                    state: first_of(&strobes).unwrap_or(plain.state),
                    marks: match never && !strobes.is_empty() {
                        true => strobes,
                        false => entries.collect(),
                    },
                    sizes: extremes
                        .map(|(low, high)| high.abs().max(low.abs()))
                        .collect(),
                    orbit: Some((
                        point,
                        LabelledOrbit {
                            label: self.met.len() + 1,
                            orbit: saved,
                        },
                    )),
                    ..plain
                })
            }
            _ => None,
        }
    }

    /// Whether a cell comes to an attractor.
    fn is_at(&self, attractor: &Attractor, cell: &SettledCell) -> bool {
        let is_orbit = cell.found == "orbit";
        if attractor.regimes != cell.regimes
            || attractor.periods != cell.periods
            || attractor.orbit.is_some() != is_orbit
        {
            return false;
        }
        if !is_orbit {
            let known = &attractor.marks[0];
            return attractor.has(known, &cell.mark) || self.rest_together(known, cell);
        }
        let mut marks = attractor.marks.iter();
        let passes = |trace: &CycleTrace| {
            let affine = self.affine.as_ref();
            affine.is_some_and(|affine| trace.passes(affine, &cell.mark.state, &attractor.sizes))
        };
        marks.any(|mark| attractor.has(mark, &cell.mark))
            || attractor.trace.as_ref().is_some_and(passes)
    }

    /// Whether two points of rest of a mode belong to one family: all between them rests, as it always does where rates are
    /// affine.
    fn rest_together(&self, known: &OrbitMark, cell: &SettledCell) -> bool {
        let (Some(affine), Some(number)) = (&self.affine, self.system.mode(cell.regimes)) else {
            return false;
        };
        let mode = &affine.modes[number];
        let rests = |part: f64| {
            let pairs = known.state.iter().zip(&cell.mark.state);
            let state: Vec<f64> = pairs.map(|(x, y)| x + part * (y - x)).collect();
            let z = affine.lift(number, &state, 0.0);
            let rates = product(&mode.matrix.at, &z);
            let terms = product(&mode.matrix.at.abs(), &z.abs());
            let states = 0..affine.states;
            let mut states = states.map(|state| (rates[state].abs(), terms[state]));
            states.all(|(rate, terms)| rate <= RESTS * terms)
        };
        mode.field.is_exact || [0.25, 0.5, 0.75].into_iter().all(rests)
    }
}

/// The state that comes first in the order of its numbers.
fn first_of(marks: &[OrbitMark]) -> Option<Vec<f64>> {
    let order = |one: &&OrbitMark, other: &&OrbitMark| {
        let pairs = one.state.iter().zip(&other.state);
        let orders = pairs.map(|(one, other)| one.total_cmp(other));
        orders.fold(Ordering::Equal, Ordering::then)
    };
    marks.iter().min_by(order).map(|mark| mark.state.clone())
}

/// A cycle without switches and forcing, which has no first point.
#[derive(Clone, Debug)]
struct CycleTrace {
    flow: ModeFlow,
    mode: usize,
    /// Its pieces, and how much of each belongs to it.
    pieces: Vec<(FlowPiece, f64)>,
}

impl CycleTrace {
    /// The motion from z in a mode over a period.
    fn new(affine: &AffineSystem, mode: usize, begin: Vector, period: f64) -> CycleTrace {
        let flow = ModeFlow::new(&affine.modes[mode], period);
        let (mut piece, mut rest) = (flow.piece(begin), period);
        let mut pieces = Vec::new();
        while piece.length > 0.0 && rest > 0.0 {
            let part = piece.length.min(rest);
            rest -= part;
            let next = flow.piece(flow.advance(&piece));
            pieces.push((std::mem::replace(&mut piece, next), part));
        }
        CycleTrace { flow, mode, pieces }
    }

    /// Whether it passes a state but for a part of these sizes: where it is nearest to it.
    fn passes(&self, affine: &AffineSystem, state: &[f64], sizes: &[f64]) -> bool {
        /// Places of a piece that are looked at first, and steps from the nearest of all: a piece turns by less than a radian.
        const PLACES: u32 = 8;
        const STEPS: usize = 6;
        let off = |z: &Vector| -> Vec<f64> {
            let pairs = state.iter().zip(z).zip(sizes);
            pairs.map(|((x, z), size)| (x - z) / size).collect()
        };
        let places = self.pieces.iter().flat_map(|(piece, part)| {
            (0..=PLACES).map(move |place| {
                let time = part * f64::from(place) / f64::from(PLACES);
                let off = off(&self.flow.within(piece, time));
                let distance: f64 = off.iter().map(|off| off * off).sum();
                (distance, piece, (time, *part))
            })
        });
        let nearest = places.min_by(|(one, ..), (other, ..)| one.total_cmp(other));
        let Some((_, piece, (mut time, part))) = nearest else {
            return false;
        };
        for _ in 0..STEPS {
            let z = self.flow.within(piece, time);
            let rates = product(&affine.modes[self.mode].matrix.at, &z);
            let rates = rates.iter().zip(sizes).map(|(rate, size)| rate / size);
            let sums = off(&z)
                .iter()
                .zip(rates)
                .fold((0.0, 0.0), |sums, (off, rate)| {
                    (sums.0 + off * rate, sums.1 + rate * rate)
                });
            time = (time + sums.0 / sums.1).clamp(0.0, part);
        }
        let off = off(&self.flow.within(piece, time));
        off.iter().all(|off| off.abs() <= SAME)
    }
}

impl Attractor {
    /// Whether two points on it are the same.
    fn has(&self, known: &OrbitMark, mark: &OrbitMark) -> bool {
        let turn = (known.phase - mark.phase).rem_euclid(TAU) / TAU;
        let mut pairs = known.state.iter().zip(&mark.state).zip(&self.sizes);
        turn.min(1.0 - turn) <= SAME
            && known.state.len() == mark.state.len()
            && pairs.all(|((one, other), size)| (one - other).abs() <= SAME * size)
    }
}
