//! A simulation from its beginning to its end: steps, samples at equal intervals, measures.

use super::measure::{self, Measure, TimeSample};
use super::motion::{MotionError, Saved, SimulatedMotion};
use super::perturbations::{Perturbations, RefusedPerturbations, perturbations};
use super::profile::Profile;
use super::task::{Circle, Simulation, SimulationStart};
use crate::tube::model::{Constants, Model};

/// Parts of a simulation at whose ends its state is worth saving.
const PARTS: usize = 50;

/// Most steps of nodes: four months at 1e8 a second, which one core takes.
const MOST_WORK: f64 = 1e15;

/// Steps of nodes that one call takes: the time between two looks at the clock.
const STRIDE: u64 = 10_000_000;

/// A simulation that is going on.
pub struct SimulationCourse {
    motion: SimulatedMotion,
    parameters: Constants,
    wave: Option<Profile>,
    perturbations: Vec<Perturbations>,
    /// Mode watched, and the number of waves the circle is compared in.
    watched: u32,
    waves: usize,
    /// Whole intervals between samples, and the time after the last of them.
    whole: usize,
    rest: f64,
    duration: f64,
    snapshots: usize,
    per_sample: u64,
    start: f64,
    samples: Vec<TimeSample>,
    /// Steps to the next sample.
    left: u64,
    /// Steps taken before this process.
    before: u64,
}

/// Why a simulation cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum NoCourse {
    /// There is no such motion.
    #[error("{0}")]
    Motion(#[from] MotionError),
    /// Perturbations cannot be asked for.
    #[error("{0}")]
    Growth(#[from] RefusedPerturbations),
    /// More steps of nodes than a machine takes in months.
    #[error(
        "{steps:.1e} steps of {time_step:.1e} of {nodes} nodes and what `growth` adds are {work:.1e} \
         steps of a node; at most {most:.0e} are admitted, which take months: take fewer points, a larger \
         `courant` or a shorter `duration`",
        most = MOST_WORK
    )]
    TooLong {
        /// Steps.
        steps: f64,
        /// Time step.
        time_step: f64,
        /// Nodes.
        nodes: usize,
        /// Steps times nodes, with those of `growth`.
        work: f64,
    },
}

/// Why a simulation ends early.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Stopped {
    /// The state has overflowed.
    #[error("the motion is no longer finite at t = {0}")]
    NotFinite(f64),
}

/// Where a call has led to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoursePiece {
    /// Between two samples.
    Between,
    /// To the last of [`SimulationCourse::samples`].
    Sampled {
        /// Snapshots that are due up to here.
        snapshots: usize,
        /// Whether a part has ended.
        part: bool,
    },
}

impl SimulationCourse {
    /// The motion of a section with this model, at its beginning.
    ///
    /// # Errors
    /// When there is none, or no machine ends it.
    pub fn begin(
        section: &Simulation,
        model: &Model,
        mode: u32,
        wave: Option<Profile>,
    ) -> Result<SimulationCourse, NoCourse> {
        let parameters = model.constants();
        let motion = SimulatedMotion::begin(section, model, mode, wave.as_ref())?;
        let perturbations = perturbations(section, model, mode, wave.as_ref())?;
        let (whole, rest) = section.intervals();
        let mut course = SimulationCourse {
            watched: match (&section.start, section.perturbation) {
                (SimulationStart::SteadySliding, Some(perturbation)) => perturbation.mode,
                _ => mode,
            },
            waves: match section.circle {
                Circle::Whole => mode as usize,
                Circle::Wavelength => 1,
            },
            whole,
            rest,
            duration: section.duration,
            snapshots: section.snapshots,
            per_sample: (section.every / motion.time_step()).round() as u64,
            start: motion.energy().0,
            samples: Vec::new(),
            left: 0,
            before: 0,
            motion,
            parameters,
            wave,
            perturbations,
        };
        if course.work() > MOST_WORK {
            return Err(NoCourse::TooLong {
                steps: course.steps(),
                time_step: course.motion.time_step(),
                nodes: course.motion.size(),
                work: course.work(),
            });
        }
        course.samples = vec![course.sample()];
        Ok(course)
    }

    /// Goes on after these samples, the one at the beginning included, from a state that was saved.
    ///
    /// # Errors
    /// When it is of another body.
    pub fn resume(
        &mut self,
        samples: Vec<TimeSample>,
        energy: f64,
        state: Saved,
        steps: u64,
    ) -> Result<(), MotionError> {
        self.motion.resume(state, steps)?;
        (self.samples, self.start, self.before) = (samples, energy, steps);
        Ok(())
    }

    /// Steps and snapshots that so many samples take, the one at the beginning included; none where
    /// there are not so many.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn at_sample(&self, samples: usize) -> Option<(u64, usize)> {
        let taken = samples.checked_sub(1)?;
        let last = if taken > self.whole {
            self.motion.steps_within(self.rest)
        } else {
            0
        };
        let steps = taken.min(self.whole) as u64 * self.per_sample + last;
        (taken <= self.count()).then(|| (steps, self.snapshots_at(taken)))
    }

    /// Snapshots that are due when so many intervals have passed.
    fn snapshots_at(&self, taken: usize) -> usize {
        taken * self.snapshots / self.count()
    }

    /// Goes on, not beyond the next sample; `None` at the end.
    ///
    /// # Errors
    /// When the equations no longer hold.
    pub fn step(&mut self) -> Result<Option<CoursePiece>, Stopped> {
        let count = self.count();
        let (done, here) = (self.samples.len(), self.samples[self.samples.len() - 1]);
        if !here.energy.is_finite() {
            return Err(Stopped::NotFinite(here.time));
        }
        let last = done == count && self.rest > 0.0;
        if self.left == 0 {
            if done > count {
                return Ok(None);
            }
            self.left = match last {
                true => self.motion.shorten(self.rest),
                false => self.per_sample,
            };
        }
        let some = self.left.min(STRIDE.div_ceil(self.motion.size() as u64));
        self.motion.advance(some);
        self.left -= some;
        if self.left > 0 {
            return Ok(Some(CoursePiece::Between));
        }
        let mut sample = self.sample();
        if last {
            sample.time = self.duration;
        }
        self.samples.push(sample);
        let part = done * PARTS / count > (done - 1) * PARTS / count || done == count;
        Ok(Some(CoursePiece::Sampled {
            snapshots: self.snapshots_at(done),
            part: part && sample.energy.is_finite(),
        }))
    }

    fn sample(&self) -> TimeSample {
        let mismatch = self.parameters.mismatch;
        TimeSample::of(&self.motion, self.watched, self.waves, mismatch, self.start)
    }

    /// Intervals between samples.
    pub fn count(&self) -> usize {
        self.whole + usize::from(self.rest > 0.0)
    }

    /// Time of the last interval if it is shorter than the others; else 0.
    pub fn rest(&self) -> f64 {
        self.rest
    }

    /// The motion.
    pub fn motion(&self) -> &SimulatedMotion {
        &self.motion
    }

    /// Samples taken.
    pub fn samples(&self) -> &[TimeSample] {
        &self.samples
    }

    /// Energy at the beginning.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Steps of the whole simulation.
    pub fn steps(&self) -> f64 {
        self.duration / self.motion.time_step()
    }

    /// Steps taken by this process.
    pub fn taken(&self) -> u64 {
        self.motion.steps() - self.before
    }

    /// Steps of nodes of the whole, with those of perturbations.
    fn work(&self) -> f64 {
        let more: f64 = self.perturbations.iter().map(|one| one.work).sum();
        self.steps() * self.motion.size() as f64 + more
    }

    /// Part of the work that is done when perturbations have taken this much.
    pub fn position(&self, perturbations: f64) -> f64 {
        let moved = (self.motion.steps() * self.motion.size() as u64) as f64;
        (moved + perturbations) / self.work()
    }

    /// What the motion has shown; samples at equal intervals only.
    pub fn measures(&self) -> Vec<Measure> {
        let even = &self.samples[..=self.whole];
        let mut measures = measure::linear_growth(even);
        measures.extend(measure::steady_state(even, self.watched));
        measures
    }

    /// Whether it begins with a wave.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn has_wave(&self) -> bool {
        self.wave.is_some()
    }

    /// The perturbations that are asked for, with the parameters and the wave they grow on.
    pub fn perturbations(&self) -> impl Iterator<Item = (&Perturbations, &Constants, &Profile)> {
        let wave = self.wave.as_ref();
        let all = wave.into_iter().flat_map(|wave| {
            let each = self.perturbations.iter();
            each.map(move |one| (one, wave))
        });
        all.map(|(one, wave)| (one, &self.parameters, wave))
    }
}
