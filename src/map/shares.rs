//! Motions that begin at random at each of the values of a parameter: how large a share of them comes to which attractor.

use super::attractors::Attractors;
use super::motion::{MotionOutcome, Motions, OrbitMark, Settled, SettledOrbit, fitting};
use crate::affine::motion::{Moment, Motion};
use crate::affine::system::Ordered;
use crate::hybrid::NoFirstPoint;
use crate::hybrid::scan::{Stream, random};
use crate::problem::{BeginningSection, Shares, SystemProblem};

/// The motions of shares, those of any value computed by themselves.
pub struct Draws<'a> {
    problem: &'a SystemProblem,
    shares: &'a Shares,
    motions: Motions<'a>,
    /// Place of the parameter among all.
    parameter: usize,
    start: BeginningSection,
}

impl<'a> Draws<'a> {
    /// Those of a problem that has passed every check; none where it asks for none.
    pub fn new(problem: &'a SystemProblem) -> Option<Draws<'a>> {
        let shares = problem.map.as_ref()?.shares.as_ref()?;
        let names = &problem.system.source.parameters;
        Some(Draws {
            problem,
            motions: Motions::new(problem)?,
            parameter: names.index(&shares.parameter)?,
            start: problem.orbit.start.beginning()?,
            shares,
        })
    }

    /// Values of all parameters at a value of that of the shares, by its number.
    fn values(&self, value: usize) -> Vec<f64> {
        let mut values = self.problem.values();
        values[self.parameter] = self.shares.values.value(value);
        values
    }

    /// The motions at a value, in the order of their numbers, as the row of a map.
    pub fn row(&self, value: usize) -> Vec<MotionOutcome> {
        let asked = self.problem.stability.is_some();
        let draws = 0..self.shares.draws;
        let outcomes = draws.map(|draw| {
            let settled = self.settled(value, draw, asked);
            let (found, orbit) = match settled {
                Ok((found, orbit)) => (found, Some(orbit)),
                Err(reason) => (Settled::Nothing(reason), None),
            };
            MotionOutcome {
                row: value,
                column: draw,
                start: 1,
                mark: OrbitMark::of(&found, orbit.as_ref()),
                found,
                parameters: self.values(value),
            }
        });
        outcomes.collect()
    }

    /// What attracts the motions at a value, of which none is known yet.
    pub fn attractors(&self, value: usize) -> Attractors<'_> {
        let find = Box::new(|[value, draw, _]: [usize; 3]| self.settled(value, draw, true).ok());
        let system = &self.problem.system;
        let mut scales = self.motions.scales();
        let within = self.shares.within.iter().flat_map(|within| &within.0);
        for (name, (low, high)) in within {
            let mut states = system.source.states.iter();
            if let Some(state) = states.position(|state| state == name) {
                scales[state] = scales[state].max(low.abs()).max(high.abs());
            }
        }
        Attractors::at(find, (system, &self.values(value)), scales)
    }

    /// The state in which a motion begins, in the mode that it lies in: the same at all values where it lies in one.
    fn begun(&self, values: &[f64], draw: usize) -> Option<BeginningSection> {
        let system = &self.problem.system;
        let affine = system.at(values, &[]).ok()?;
        let names = &system.source.states;
        let start = self.start.place(system, &affine)?;
        let stream = Stream(self.shares.seed).apart(draw as u64);
        let within = self.shares.within.as_ref();
        let inside = |place: Moment| {
            let place = fitting(system, &affine, place);
            let motion = Motion::new(&affine, place.clone(), 1.0);
            motion.is_inside().then_some(place)
        };
        let place = random(names, &start, within, stream, &inside)?;
        Some(BeginningSection {
            mode: system.mode_name(place.mode).into_owned(),
            state: Ordered(names.iter().cloned().zip(place.state).collect()),
            ..self.start.clone()
        })
    }

    fn settled(
        &self,
        value: usize,
        draw: usize,
        asked: bool,
    ) -> Result<(Settled, SettledOrbit), NoFirstPoint> {
        let values = self.values(value);
        // where the system has no meaning the motion says so
        let begun = match self.problem.system.at(&values, &[]) {
            Ok(_) => self.begun(&values, draw).ok_or(NoFirstPoint::Unknown)?,
            Err(_) => self.start.clone(),
        };
        self.motions.settled(&begun, &values, asked)
    }
}
