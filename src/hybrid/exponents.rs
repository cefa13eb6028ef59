//! Lyapunov exponents of a motion over its samples.

use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Halt, Moment, Motion, Step};
use crate::affine::tangent::TangentFrame;

/// A Lyapunov exponent, per unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exponent {
    /// Its estimate.
    Finite {
        /// The growth between the first and the last sample, by the time between them.
        value: f64,
        /// Its standard error, where there are at least two spans between samples.
        error: Option<f64>,
    },
    /// −∞: the motion has lost a dimension, as in stick.
    Lost,
    /// Growth is not resolved.
    Unknown,
}

/// What grows between two samples.
struct Span {
    time: f64,
    growth: Vec<f64>,
}

/// A motion with as many directions of its perturbations as there are exponents to find.
pub(super) struct PerturbedMotion<'a> {
    system: &'a AffineSystem,
    /// A unit of time.
    unit: f64,
    motion: Motion<'a>,
    /// How many exponents.
    count: usize,
    /// The directions, while their growth is known.
    frame: Option<TangentFrame<'a>>,
    spans: Vec<Span>,
    /// Time of the last sample.
    sampled: Option<f64>,
}

impl<'a> PerturbedMotion<'a> {
    pub fn new(
        system: &'a AffineSystem,
        start: Moment,
        unit: f64,
        count: usize,
    ) -> PerturbedMotion<'a> {
        let frame = (count > 0).then(|| TangentFrame::new(system, &start, count, unit).ok());
        PerturbedMotion {
            system,
            unit,
            motion: Motion::new(system, start, unit),
            count,
            frame: frame.flatten(),
            spans: Vec::new(),
            sampled: None,
        }
    }

    /// See [`Motion::watching`].
    pub fn watching(self, mode: usize) -> PerturbedMotion<'a> {
        PerturbedMotion {
            motion: self.motion.watching(mode),
            ..self
        }
    }

    pub fn place(&self) -> &Moment {
        self.motion.place()
    }

    /// Moves on as [`Motion::step`] does.
    pub fn step(&mut self, until: f64) -> Result<Step, Halt> {
        let Some(frame) = &mut self.frame else {
            return self.motion.step(until);
        };
        let before = self.motion.place().clone();
        let step = self.motion.step(until)?;
        let carried = match &step {
            Step::Switched(switching) => {
                let elapsed = switching.time - before.time;
                let carried = frame.carry(&before, elapsed);
                carried.and_then(|()| frame.jump(switching, elapsed))
            }
            Step::Reached | Step::Section => {
                frame.carry(&before, self.motion.place().time - before.time)
            }
        };
        if carried.is_err() {
            self.frame = None;
        }
        Ok(step)
    }

    /// Puts new directions in the place of those that a transient has lost, or in the place of all whose growth in it was not resolved,
    /// early enough for them to settle, too.
    pub fn renew(&mut self) {
        if self.frame.is_none() && self.count > 0 {
            let place = self.motion.place();
            self.frame = TangentFrame::new(self.system, place, self.count, self.unit).ok();
        }
        self.measure_anew();
    }

    fn measure_anew(&mut self) {
        let place = self.motion.place();
        let frame = self.frame.as_mut();
        let known = frame.is_none_or(|frame| frame.measure_anew(place).is_ok());
        if !known {
            self.frame = None;
        }
    }

    /// Begins a span at a sample, and ends the one before.
    pub fn sample(&mut self) {
        let now = self.motion.place().time;
        let Some(before) = self.sampled.replace(now) else {
            return self.measure_anew();
        };
        let Some(frame) = &mut self.frame else { return };
        match frame.take_growth() {
            Some(growth) => self.spans.push(Span {
                time: now - before,
                growth,
            }),
            None => self.spans.clear(),
        }
    }

    /// The exponents, the largest first.
    pub fn exponents(&self) -> Vec<Exponent> {
        let Some(frame) = &self.frame else {
            return vec![Exponent::Unknown; self.count];
        };
        let numbers = 0..self.count;
        let exponents = numbers.map(|number| match number < frame.len() {
            true => exponent(&self.spans, number),
            false => Exponent::Lost,
        });
        exponents.collect()
    }
}

/// The exponent with this number: λ = ΣL/ΣT of the growth L over times T. Its standard error is that of the means of b = √N
/// blocks of the N spans, s² = b/(b − 1) Σ(L − λT)²/(ΣT)², since neighbouring spans are not independent.
fn exponent(spans: &[Span], number: usize) -> Exponent {
    let time: f64 = spans.iter().map(|span| span.time).sum();
    let growth: f64 = spans.iter().map(|span| span.growth[number]).sum();
    let value = growth / time;
    if !value.is_finite() {
        return Exponent::Unknown;
    }
    let count = spans.len();
    let blocks = (count as f64).sqrt().round().max(2.0);
    let block = |span: usize| (span as f64 * blocks / count as f64) as usize;
    let mut off = vec![0.0; blocks as usize];
    for (index, span) in spans.iter().enumerate() {
        off[block(index)] += span.growth[number] - value * span.time;
    }
    let squares: f64 = off.iter().map(|off| off * off).sum();
    let error = (count > 1).then(|| (blocks / (blocks - 1.0) * squares).sqrt() / time);
    Exponent::Finite { value, error }
}
