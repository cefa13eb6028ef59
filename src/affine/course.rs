//! A motion seen at equal times, at every period of the forcing, and at its switches.

use super::mode::AffineSystem;
use super::motion::{Halt, Moment, Motion, Step, Switching};

/// What is seen of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// Where it is at one of equally spaced times.
    Sample(Moment),
    /// Where it is after a whole number of periods of the forcing.
    Section(Moment),
    /// A switch.
    Switch(Switching),
}

/// A motion from a place through a time, as an iterator: samples at k·duration/samples for k = 0 … samples,
/// section samples at k·2π/ω, and every switch, in the order of time. It ends after the first [`Halt`].
#[derive(Debug)]
pub struct Course<'a> {
    motion: Motion<'a>,
    begun: f64,
    duration: f64,
    samples: usize,
    /// Period of the forcing.
    period: Option<f64>,
    /// How many samples and section samples have been taken.
    taken: [usize; 2],
    ended: bool,
}

impl<'a> Course<'a> {
    /// A motion that begins at a place; `samples` > 0 and `duration` > 0.
    pub fn new(
        system: &'a AffineSystem,
        place: Moment,
        duration: f64,
        samples: usize,
    ) -> Course<'a> {
        let omega = system.omega.value;
        Course {
            begun: place.time,
            motion: Motion::new(system, place, duration),
            duration,
            samples,
            period: (omega > 0.0).then_some(std::f64::consts::TAU / omega),
            taken: [0, 0],
            ended: false,
        }
    }

    /// Where the motion is.
    pub fn place(&self) -> &Moment {
        self.motion.place()
    }
}

impl Iterator for Course<'_> {
    type Item = Result<Seen, Halt>;

    fn next(&mut self) -> Option<Self::Item> {
        let [samples, sections] = self.taken;
        let sample = self.duration * (samples as f64 / self.samples as f64);
        let sample = Some(sample).filter(|_| samples <= self.samples);
        let section = self.period.map(|period| sections as f64 * period);
        let section = section.filter(|time| *time <= self.duration);
        let (time, is_sample) = match (sample, section) {
            _ if self.ended => return None,
            (Some(sample), Some(section)) => (sample.min(section), sample <= section),
            (Some(sample), None) => (sample, true),
            (None, Some(section)) => (section, false),
            (None, None) => return None,
        };
        let until = self.begun + time;
        if until > self.motion.place().time {
            match self.motion.step(until) {
                Ok(Step::Reached | Step::Section) => {}
                Ok(Step::Switched(switching)) => return Some(Ok(Seen::Switch(switching))),
                Err(halt) => {
                    self.ended = true;
                    return Some(Err(halt));
                }
            }
        }
        let place = self.motion.place().clone();
        self.taken[usize::from(!is_sample)] += 1;
        Some(Ok(match is_sample {
            true => Seen::Sample(place),
            false => Seen::Section(place),
        }))
    }
}
