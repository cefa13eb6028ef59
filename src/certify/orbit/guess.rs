//! An orbit in doubles as unknowns of the equations, and back.

use std::f64::consts::TAU;

use super::OpenOrbit;
use super::enclosure::Enclosure;
use super::flow::{IntervalExponential, IntervalFlow};
use super::modes::IntervalModes;
use super::system::{NearOrbit, OrbitCondition, OrbitSystem, SegmentEnd};
use crate::affine::orbit::setting::Scales;
use crate::affine::orbit::{Watch, ZonePoint};
use crate::interval::Interval;

/// A step spans no more than this of the time scale of its mode.
const LONGEST: f64 = 4.0;
/// More unknowns of an orbit than this are not covered: a pair on the unit circle has three times as many, in dense
/// matrices, which takes a minute.
const MOST_UNKNOWNS: f64 = 1000.0;

/// The angle that differs from another by whole turns and is next to a third.
fn next_to(there: f64, angle: f64) -> f64 {
    angle + TAU * ((there - angle) / TAU).round()
}

impl OrbitSystem<'_> {
    /// The unknowns in doubles, and the numbers of steps.
    pub(super) fn guess(
        &mut self,
        near: &NearOrbit,
        modes: &IntervalModes<Enclosure>,
        condition: &OrbitCondition,
        least: &[usize],
    ) -> Result<Vec<f64>, OpenOrbit> {
        self.steps.clear();
        let mut guess = Vec::new();
        let mut carried: Option<(Vec<f64>, f64)> = None;
        let mut reached: Option<f64> = None;
        for (index, stretch) in self.stretches.iter().enumerate() {
            let zone = &near.zones[stretch.zone];
            let time = match condition {
                OrbitCondition::Margin {
                    watch: Watch::Inside(_),
                    zone: cut,
                    time,
                } if *cut == stretch.zone => {
                    // the part before the touch comes first
                    if carried.is_none() {
                        *time
                    } else {
                        zone.duration - time
                    }
                }
                _ => zone.duration,
            };
            let flow = IntervalFlow::new(&modes.modes[stretch.mode].matrix);
            let fewest = least.get(index).map_or(1.0, |steps| *steps as f64);
            let steps = (flow.norm * time / LONGEST).ceil().max(fewest);
            let before: usize = self.steps.iter().sum();
            if (steps + before as f64) * self.width() as f64 > MOST_UNKNOWNS {
                return Err(OpenOrbit::Long);
            }
            let (mut state, mut phase) = match carried.take() {
                Some(end) => end,
                // a phase is told but for whole turns
                None => (
                    zone.state.clone(),
                    reached.map_or(zone.phase, |there| next_to(there, zone.phase)),
                ),
            };
            let step = time / steps;
            let halvings = flow.parts(Interval::point(step));
            let part = flow.part(Interval::point(step), halvings);
            let whole = (0..halvings).fold(part, |part, _| part.doubled());
            self.steps.push(steps as usize);
            let forced = self.is_forced();
            for node in 0..=steps as usize {
                guess.extend(&state);
                if forced {
                    guess.push(phase);
                }
                if node < steps as usize {
                    state = self.stepped(&whole, &state, phase);
                    phase += modes.omega.value.middle() * step;
                }
            }
            guess.push(time);
            reached = Some(phase);
            if let SegmentEnd::Touch { .. } = stretch.end {
                carried = Some((state, phase));
            }
        }
        guess.push(near.parameter);
        match guess.iter().all(|x| x.is_finite()) {
            true => Ok(guess),
            false => Err(OpenOrbit::NotEnclosed),
        }
    }

    /// States after a step.
    fn stepped(&self, step: &IntervalExponential, state: &[f64], phase: f64) -> Vec<f64> {
        let y = state.iter().chain([&phase]).copied();
        let y: Vec<Interval> = y.map(Interval::point).collect();
        let z: Vec<f64> = self.lift(&y).iter().map(|z| z.middle()).collect();
        let mut state = times(step, &z);
        state.truncate(self.exact.states);
        state
    }

    /// Units of the unknowns.
    pub fn units(&self, guess: &[f64]) -> Vec<f64> {
        let Scales {
            states,
            time,
            parameter,
            ..
        } = &self.posed.units;
        let mut units = Vec::with_capacity(guess.len());
        for steps in &self.steps {
            for _ in 0..=*steps {
                units.extend(states);
                if self.is_forced() {
                    units.push(1.0);
                }
            }
            units.push(*time);
        }
        units.push(*parameter);
        let orbit = units.len() - 1;
        let Some(critical) = &self.critical else {
            return units;
        };
        for direction in 0..critical.directions() {
            let from = critical.first(direction);
            let of = |index: usize| guess[from + index].abs() / units[index];
            let size = (0..orbit).map(of).fold(0.0, f64::max);
            let own: Vec<f64> = units[..orbit].iter().map(|unit| unit * size).collect();
            units.extend(own);
        }
        units.resize(guess.len(), 1.0);
        units
    }

    /// An orbit in doubles from the unknowns, and the condition with its own.
    pub fn near(&self, near: &NearOrbit, guess: &[f64]) -> (NearOrbit, OrbitCondition) {
        let states = self.exact.states;
        let mut condition = self.condition.clone();
        let half = near.zones.len() / 2;
        let zone = |index: usize, at: &ZonePoint| {
            let centre = self.half.as_ref().filter(|_| index >= half);
            let zone = if centre.is_some() {
                index - half
            } else {
                index
            };
            let parts = self.stretches.iter().enumerate();
            let parts: Vec<usize> = parts
                .filter(|(_, stretch)| stretch.zone == zone)
                .map(|(index, _)| index)
                .collect();
            let Some(first) = parts.first().map(|first| self.node(*first, 0)) else {
                return at.clone();
            };
            let turn = centre.map_or(0.0, |_| self.turns().middle());
            let image = |(state, x): (usize, &f64)| match centre {
                Some(centre) => centre.image(state, Interval::point(*x)).middle(),
                None => *x,
            };
            let state = guess[first..first + states].iter().enumerate();
            ZonePoint {
                inner: Vec::new(),
                state: state.map(image).collect(),
                duration: parts.iter().map(|part| guess[self.duration(*part)]).sum(),
                phase: if self.is_forced() {
                    guess[first + states] + turn
                } else {
                    0.0
                },
            }
        };
        let zones = near.zones.iter().enumerate();
        match (&mut condition, &self.critical) {
            (
                OrbitCondition::Margin {
                    watch: Watch::Inside(_),
                    zone,
                    time,
                },
                _,
            ) => {
                let mut parts = self.stretches.iter().enumerate();
                let first = parts.find(|(_, stretch)| stretch.zone == *zone);
                if let Some((first, _)) = first {
                    *time = guess[self.duration(first)];
                }
            }
            (OrbitCondition::Torus { angle }, Some(_)) => {
                *angle = guess.last().copied().unwrap_or(*angle);
            }
            _ => {}
        }
        let near = NearOrbit {
            sequence: near.sequence.clone(),
            zones: zones.map(|(index, at)| zone(index, at)).collect(),
            parameter: guess[self.parameter()],
        };
        (near, condition)
    }
}

/// A step of z in doubles.
pub fn times(step: &IntervalExponential, z: &[f64]) -> Vec<f64> {
    let row = |row: &Vec<Interval>| row.iter().zip(z).map(|(e, z)| e.middle() * z).sum();
    step.at.iter().map(row).collect()
}
