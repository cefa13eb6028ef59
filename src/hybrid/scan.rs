//! What motions of a system settle on, value by value of a parameter, in pieces that are computed one by one.
//!
//! A motion of a sweep begins where the last sample of the value before was taken: what a row of a table tells of
//! it is enough to go on.

use std::f64::consts::TAU;
use std::ops::Range;

use super::exponents::{Exponent, PerturbedMotion};
use crate::affine::contact::place::Contradiction;
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Halt, Moment, Motion, Step};
use crate::affine::system::{Ordered, System, SystemError};
use crate::problem::{SampleSection, Scan, Sweep, SystemProblem};

/// Values of a piece: files of a thousand samples or so, and a loss of a second where it is interrupted.
const VALUES: usize = 16;

/// Random states that are tried before a mode is said to have none of the range.
const TRIES: usize = 1000;

/// What was seen of the motion at one value.
#[derive(Clone, Debug, PartialEq)]
pub struct ScannedMotion {
    /// The value.
    pub value: f64,
    /// `up`, `down` or `fresh`.
    pub sweep: &'static str,
    /// Where samples were taken, at times from the beginning.
    pub samples: Vec<Moment>,
    /// Why there are not as many as asked for.
    pub lacks: Option<Lack>,
    /// Lyapunov exponents over the samples, as many as are asked for.
    pub exponents: Vec<Exponent>,
}

/// Why a motion has fewer samples than asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Lack {
    /// The system makes no sense at the value.
    System(SystemError),
    /// The motion does not go on.
    Halted(Halt),
    /// It does not come to the section for as long as it settles, or as many periods as there are samples.
    Away {
        /// How long that is.
        time: f64,
    },
    /// No random state lies within the mode.
    Outside,
    /// It begins behind a stop.
    Contradicted(Contradiction),
}

/// A scan that is ready to be computed.
#[derive(Clone, Debug)]
pub struct Scanner<'a> {
    scan: &'a Scan,
    /// The system, with one more mode for the section.
    pub system: System,
    /// The mode whose first guard is the section.
    section: Option<usize>,
    values: Vec<f64>,
    parameter: usize,
    start: Moment,
}

impl Scan {
    /// Pieces of each sweep, by number: what must be computed one after the other.
    pub fn sweeps(&self) -> Vec<Range<usize>> {
        let pieces = self.values.count().div_ceil(VALUES);
        match self.sweep {
            Sweep::Up | Sweep::Down => std::iter::once(0..pieces).collect(),
            Sweep::Both => vec![0..pieces, pieces..2 * pieces],
            Sweep::Fresh => (0..pieces).map(|piece| piece..piece + 1).collect(),
        }
    }

    /// The word of the sweep of a piece, and its values, each with its number from the least.
    pub fn piece(&self, number: usize) -> (&'static str, Vec<(usize, f64)>) {
        let count = self.values.count();
        let pieces = count.div_ceil(VALUES);
        let word = match (self.sweep, number < pieces) {
            (Sweep::Fresh, _) => "fresh",
            (Sweep::Down, _) | (Sweep::Both, false) => "down",
            _ => "up",
        };
        let first = (number % pieces) * VALUES;
        let places = (first..count.min(first + VALUES)).map(|place| match word {
            "down" => count - 1 - place,
            _ => place,
        });
        let valued = places.map(|place| (place, self.values.value(place)));
        (word, valued.collect())
    }
}

impl<'a> Scanner<'a> {
    /// A scan of a problem that has passed every check; none where the problem does not say where motions begin.
    pub fn new(problem: &SystemProblem, scan: &'a Scan) -> Option<Scanner<'a>> {
        let (system, section) = scan.system(&problem.system).ok()?;
        let start = scan.start.clone();
        let start = start.or(problem.start_of_motion())?;
        let values = problem.values();
        let at = system.at(&values, &[]).ok()?;
        Some(Scanner {
            scan,
            section,
            values,
            parameter: system.source.parameters.index(&scan.parameter)?,
            start: start.place(&system, &at)?,
            system,
        })
    }

    /// The values of a piece in their order. `before` is where the last sample of the piece before was taken, if
    /// there is one in its sweep.
    pub fn piece(&self, number: usize, before: Option<Moment>) -> Vec<ScannedMotion> {
        let (sweep, values) = self.scan.piece(number);
        let mut last = before;
        let settled = values.into_iter().map(|(number, value)| {
            let mut settled = ScannedMotion {
                value,
                sweep,
                samples: Vec::with_capacity(self.scan.keep),
                lacks: None,
                exponents: vec![Exponent::Unknown; self.scan.lyapunov.count()],
            };
            let mut values = self.values.clone();
            values[self.parameter] = value;
            let start = last.take().filter(|_| sweep != "fresh");
            settled.lacks = match self.system.at(&values, &[]) {
                Ok(system) => {
                    let fresh = || match self.scan.seed {
                        Some(seed) => {
                            let within = self.scan.within.as_ref();
                            let names = &self.system.source.states;
                            let stream = Stream(seed).apart(number as u64);
                            let inside = |place: Moment| {
                                let place = self.system.fitting(&system, place).ok()?;
                                let motion = Motion::new(&system, place.clone(), 1.0);
                                motion.is_inside().then_some(place)
                            };
                            let drawn = random(names, &self.start, within, stream, &inside);
                            drawn.ok_or(Lack::Outside)
                        }
                        None => Ok(self.start.clone()),
                    };
                    let begun = start.map_or_else(fresh, Ok);
                    // at another value of the parameter contacts may be in other states
                    let fitting = |start| {
                        let start = self.system.fitting(&system, start);
                        start.map_err(Lack::Contradicted)
                    };
                    let taken = begun
                        .and_then(fitting)
                        .and_then(|start| self.settle(&system, start, &mut settled.samples));
                    match taken {
                        Ok(exponents) => {
                            settled.exponents = exponents;
                            None
                        }
                        Err(lack) => Some(lack),
                    }
                }
                Err(error) => Some(Lack::System(error)),
            };
            last = settled
                .samples
                .last()
                .cloned()
                .map(|last| Moment { time: 0.0, ..last });
            settled
        });
        settled.collect()
    }

    /// Follows a motion, takes its samples, and finds its exponents.
    fn settle(
        &self,
        system: &AffineSystem,
        start: Moment,
        samples: &mut Vec<Moment>,
    ) -> Result<Vec<Exponent>, Lack> {
        let omega = system.omega.value;
        let unit = if omega > 0.0 { TAU / omega } else { 1.0 };
        let Scan { settle, keep, .. } = *self.scan;
        let begun = start.phase;
        let count = self.scan.lyapunov.count();
        let mut motion = PerturbedMotion::new(system, start, unit, count);
        let Some(mode) = self.section else {
            let phase = match self.scan.section {
                SampleSection::Phase(phase) => phase.rem_euclid(TAU),
                SampleSection::Zero(_) => 0.0,
            };
            let first = (phase - begun).rem_euclid(TAU) / omega;
            settled(&mut motion, first, settle.ceil(), unit)?;
            for sample in 0..keep {
                pass(&mut motion, first + (settle.ceil() + sample as f64) * unit)?;
                let there = motion.place().clone();
                samples.push(Moment { phase, ..there });
                motion.sample();
            }
            return Ok(motion.exponents());
        };
        settled(&mut motion, 0.0, settle, unit)?;
        let mut motion = motion.watching(mode);
        let time = settle.max(keep as f64) * unit;
        while samples.len() < keep {
            let since = samples.last().map_or(settle * unit, |last| last.time);
            match motion.step(since + time).map_err(Lack::Halted)? {
                Step::Switched(_) => {}
                Step::Reached => return Err(Lack::Away { time }),
                Step::Section => {
                    let there = motion.place().clone();
                    let phase = there.phase.rem_euclid(TAU);
                    samples.push(Moment { phase, ..there });
                    motion.sample();
                }
            }
        }
        Ok(motion.exponents())
    }
}

/// A start with random states in ranges that is admitted; none where no such state is found.
pub(crate) fn random(
    names: &[String],
    start: &Moment,
    within: Option<&Ordered<(f64, f64)>>,
    mut stream: Stream,
    admit: &dyn Fn(Moment) -> Option<Moment>,
) -> Option<Moment> {
    for _ in 0..TRIES {
        let mut place = start.clone();
        for (name, state) in names.iter().zip(&mut place.state) {
            let (low, high) = match within {
                None => {
                    let reach = state.abs().max(1.0);
                    (*state - reach, *state + reach)
                }
                Some(within) => match within.index(name) {
                    Some(index) => within.0[index].1,
                    None => continue,
                },
            };
            *state = low + (high - low) * stream.next();
        }
        if let Some(place) = admit(place) {
            return Some(place);
        }
    }
    None
}

/// Follows a motion until it has settled, period by period: a time that is a sum of many pieces is known no better
/// than its last digit times their number.
fn settled(motion: &mut PerturbedMotion, first: f64, settle: f64, unit: f64) -> Result<(), Lack> {
    let half = (0.5 * settle) as usize;
    for period in 0..settle as usize {
        pass(motion, first + period as f64 * unit)?;
        if period == half {
            motion.renew();
        }
    }
    pass(motion, first + settle * unit)
}

/// Follows a motion through its switches to a time.
fn pass(motion: &mut PerturbedMotion, until: f64) -> Result<(), Lack> {
    while motion.place().time < until {
        motion.step(until).map_err(Lack::Halted)?;
    }
    Ok(())
}

/// Random numbers: Steele, Lea & Flood's SplitMix64, the same on every machine.
pub(crate) struct Stream(pub u64);

impl Stream {
    /// One of many streams of the same seed.
    pub fn apart(mut self, number: u64) -> Stream {
        let mixed = self.bits();
        Stream(mixed ^ Stream(number).bits())
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to 1.
    fn next(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 2.0_f64.powi(-53)
    }
}
