//! A travelling wave of the semi-discrete ring, and its spectrum.

use std::f64::consts::TAU;

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use super::band::Band;
use super::ring::{
    CLOSE, MOST_ITERATIONS, RingEquations, RingFailure, RingPerturbations, TOO_LARGE, Values,
    size_of,
};
use super::{Error, RingSettings};
use crate::branch::first_wave::first_wave;
use crate::continuation;
use crate::linalg::Vector;
use crate::tube::flow::FlowError;
use crate::tube::model::signature::Regime;
use crate::tube::model::{Model, Parameter};
use crate::tube::stability::spectrum::{SpectrumRequest, symmetric};
use crate::tube::wave::Wave;
use crate::tube::wave::profile::{self, switches};

/// ε at which a wave is first sought, unless a larger one is asked for.
pub const FIRST_EPSILON: f64 = 0.2;

/// Least ε at which the exact wave is close enough to start from, if larger ones fail.
const LAST_FIRST_EPSILON: f64 = 0.0125;

/// Largest and least factor of ε from one wave to the next; the first is [`FIRST_FACTOR`].
const LEAST_FACTOR: f64 = 0.2;
const FIRST_FACTOR: f64 = 0.5;
const MOST_FACTOR: f64 = 0.97;

/// Where ε is so small that [`CLOSE`] would ask for more than rounding allows.
const FLOOR: f64 = 1e-10;
/// Corrections (in units of ε) beyond which the time steps are chosen anew.
const NEW_STEPS: f64 = 0.1;
/// Part of the range of V̇ that a wave keeps at least from where the iteration starts. Steady sliding,
/// V̇ = 0, satisfies all equations of a wave for every T, and draws the iteration where a wave is small.
const KEPT: f64 = 0.25;

/// A travelling wave of the semi-discrete system with its fundamental matrix.
#[derive(Clone, Debug)]
pub struct SemiDiscreteWave {
    /// Model.
    pub model: Model,
    /// Mode k.
    pub mode: u32,
    /// Width ε of the friction law.
    pub epsilon: f64,
    /// Signed speed c.
    pub speed: f64,
    /// V and V̇ at the n points of a cell, in the order of φ.
    pub values: Vec<[f64; 2]>,
    /// Iterations of Newton's method spent on the way.
    pub newton: usize,
    tolerance: f64,
    pub(super) ring: RingEquations,
    pub(super) steps: Vec<RingPerturbations>,
    pub(super) band: Band,
}

struct Guess {
    state: Values,
    period: f64,
}

struct RingWave {
    state: Values,
    period: f64,
    steps: Vec<RingPerturbations>,
    band: Band,
    iterations: usize,
}

/// The semi-discrete wave of mode k of a model, continued from the exact wave.
///
/// # Errors
/// Settings out of range, no exact wave in full contact, or an ε that cannot be reached with so
/// few points.
pub fn solve(model: &Model, mode: u32, settings: &RingSettings) -> Result<SemiDiscreteWave, Error> {
    settings.check()?;
    let width = model.mismatch.abs().max(f64::MIN_POSITIVE);
    let steps = continuation::Steps {
        ds: 0.01,
        ds_min: 1e-12,
        ds_max: 0.05,
        tolerance: 1e-10,
    };
    let (wave, point) = first_wave(
        model,
        Parameter::Mismatch,
        mode,
        settings.which,
        width,
        steps,
    )?;
    solve_from(&wave, &point, settings)
}

/// The semi-discrete wave next to a given exact one; [`RingSettings::which`] is not used.
///
/// # Errors
/// As for [`solve`].
pub fn solve_from(
    wave: &Wave,
    point: &Vector,
    settings: &RingSettings,
) -> Result<SemiDiscreteWave, Error> {
    let model = wave.model_at(point);
    settings.check()?;
    if wave.signature.has(Regime::Separation) {
        return Err(Error::Separation {
            signature: wave.signature.to_string(),
        });
    }
    let mut first = settings.epsilon.max(FIRST_EPSILON);
    let mut ring = RingEquations::new(&model, wave.mode, settings.points, first);
    let speed = wave.speed_at(point);
    let guess = Guess {
        state: sampled(wave, point, settings.points)?,
        period: ring.spacing / speed.abs(),
    };
    let start = loop {
        match correct(&ring, &guess, speed, settings.tolerance) {
            Ok(start) => break start,
            // close to the Hopf point of steady sliding a wave does not live with so large an ε
            Err(failure) if first <= settings.epsilon.max(LAST_FIRST_EPSILON) => {
                return Err(Error::Unreached {
                    points: settings.points,
                    wanted: settings.epsilon,
                    failed: first,
                    failure,
                });
            }
            Err(_) => {
                first = (0.5 * first).max(settings.epsilon);
                ring.epsilon = first;
            }
        }
    };
    SemiDiscreteWave {
        model,
        mode: wave.mode,
        epsilon: first,
        speed: speed.signum() * ring.spacing / start.period,
        values: start.state,
        newton: start.iterations,
        tolerance: settings.tolerance,
        ring,
        steps: start.steps,
        band: start.band,
    }
    .with_epsilon(settings.epsilon)
}

/// The exact wave at the points of a cell, in the order of φ. Points lie half a spacing off the
/// release.
fn sampled(wave: &Wave, point: &Vector, points: usize) -> Result<Values, FlowError> {
    /// Samples per point: linear interpolation between them is closer to the exact wave than the
    /// semi-discrete one is.
    const FINER: usize = 16;
    let samples = profile::sample(wave, point, FINER * points)?;
    let length = switches(wave, point).last().copied().unwrap_or(0.0);
    let backwards = wave.speed_at(point) > 0.0;
    Ok((0..points)
        .map(|index| {
            let index = if backwards { points - 1 - index } else { index };
            let theta = (index as f64 + 0.5) * length / points as f64;
            let above = samples.partition_point(|sample| sample.theta < theta);
            let right = &samples[above.min(samples.len() - 1)];
            let left = &samples[above.saturating_sub(1)];
            let gap = right.theta - left.theta;
            let share = if gap > 0.0 {
                (theta - left.theta) / gap
            } else {
                0.0
            };
            [
                left.tangential + share * (right.tangential - left.tangential),
                left.tangential_rate + share * (right.tangential_rate - left.tangential_rate),
            ]
        })
        .collect())
}

impl SemiDiscreteWave {
    /// T = Δφ/|c|.
    pub(crate) fn period(&self) -> f64 {
        self.ring.spacing / self.speed.abs()
    }

    /// Number of time steps within T.
    pub fn time_steps(&self) -> usize {
        self.steps.len()
    }

    /// The same wave at another ε.
    ///
    /// # Errors
    /// When ε is not positive, or not reached.
    pub fn with_epsilon(mut self, epsilon: f64) -> Result<SemiDiscreteWave, Error> {
        if !(epsilon > 0.0 && epsilon.is_finite()) {
            return Err(Error::Epsilon { epsilon });
        }
        let mut factor = FIRST_FACTOR;
        // ε, values and T of the wave before
        let mut before: Option<(f64, Values, f64)> = None;
        while self.epsilon != epsilon {
            let next = if epsilon < self.epsilon {
                // no tiny last step
                let step = self.epsilon * factor;
                if step < 1.1 * epsilon { epsilon } else { step }
            } else {
                (self.epsilon / factor).min(epsilon)
            };
            let ring = RingEquations {
                epsilon: next,
                ..self.ring
            };
            let guess = self.predict(next, before.as_ref());
            match correct(&ring, &guess, self.speed, self.tolerance) {
                Ok(found) => {
                    let period = self.period();
                    let values = std::mem::replace(&mut self.values, found.state);
                    before = Some((self.epsilon, values, period));
                    self.epsilon = next;
                    self.speed = self.speed.signum() * ring.spacing / found.period;
                    self.newton += found.iterations;
                    self.ring = ring;
                    self.steps = found.steps;
                    self.band = found.band;
                    factor = factor.powf(1.5).max(LEAST_FACTOR);
                }
                Err(failure) => {
                    factor = factor.sqrt();
                    if factor > MOST_FACTOR {
                        return Err(Error::Unreached {
                            points: self.values.len(),
                            wanted: epsilon,
                            failed: next,
                            failure,
                        });
                    }
                }
            }
        }
        Ok(self)
    }

    /// Secant in ε through this wave and the one before.
    fn predict(&self, epsilon: f64, before: Option<&(f64, Values, f64)>) -> Guess {
        let mut guess = Guess {
            state: self.values.clone(),
            period: self.period(),
        };
        if let Some((other, values, period)) = before {
            let share = (epsilon - self.epsilon) / (self.epsilon - other);
            guess.period += share * (guess.period - period);
            for (now, then) in guess.state.iter_mut().zip(values) {
                for (now, then) in now.iter_mut().zip(then) {
                    *now += share * (*now - then);
                }
            }
        }
        guess
    }

    /// All 2n multipliers μ of a Bloch sector, in no particular order.
    ///
    /// # Errors
    /// When there is no such sector, or the iteration for the eigenvalues fails.
    pub fn multipliers(&self, sector: u32) -> Result<Vec<c64>, Error> {
        if sector >= self.mode {
            return Err(Error::Sector {
                sector,
                mode: self.mode,
            });
        }
        let size = 2 * self.values.len();
        let failed = |_| Error::Eigenvalues { size };
        let direction = direction(self.speed);
        // e^{±2πij/k} is real, and so is the matrix
        if sector == 0 || 2 * sector == self.mode {
            let sign = if sector == 0 { 1.0 } else { -1.0 };
            let mut matrix = Mat::<f64>::zeros(size, size);
            self.band.shifted(direction, |row, column, cell, value| {
                matrix[(row, column)] += if cell % 2 == 0 { value } else { sign * value };
            });
            return matrix.eigenvalues().map_err(failed);
        }
        let angle = TAU * f64::from(sector) / f64::from(self.mode);
        let mut matrix = Mat::<c64>::zeros(size, size);
        self.band.shifted(direction, |row, column, cell, value| {
            // x_{p−nq} = e^{−2πijdq/k} x_p
            let (sine, cosine) = (-angle * (direction * cell) as f64).sin_cos();
            matrix[(row, column)] += c64::new(value * cosine, value * sine);
        });
        matrix.eigenvalues().map_err(failed)
    }

    /// Eigenvalues λ = ln μ/T of a Bloch sector with |Im λ| ≤ `highest`, by falling real part; at
    /// most `count`. In sector 0 the translation λ = 0 is among them.
    ///
    /// # Errors
    /// As for [`SemiDiscreteWave::multipliers`].
    pub fn eigenvalues(&self, sector: u32, highest: f64, count: usize) -> Result<Vec<c64>, Error> {
        let period = self.period();
        let mut found: Vec<c64> = self
            .multipliers(sector)?
            .into_iter()
            .map(|multiplier| multiplier.ln() / period)
            .filter(|value| value.is_finite() && value.im.abs() <= highest)
            .collect();
        found.sort_by(|one, other| other.re.total_cmp(&one.re));
        found.truncate(count);
        Ok(found)
    }

    /// The eigenvalues that a request asks for, with their sectors: the translation mode, which is the
    /// one nearest to zero, is left out, and of conjugate pairs in a symmetric sector the member with
    /// Im λ < 0.
    ///
    /// # Errors
    /// As [`SemiDiscreteWave::eigenvalues`].
    pub fn leading(&self, request: &SpectrumRequest) -> Result<Vec<(usize, c64)>, Error> {
        let mut leading = Vec::new();
        for &sector in &request.sectors {
            let symmetric = symmetric(sector, self.mode);
            let all = self.eigenvalues(sector as u32, request.max_frequency, usize::MAX)?;
            let nearest = all.iter().map(|value| value.norm());
            let translation = (sector == 0).then(|| nearest.fold(f64::INFINITY, f64::min));
            let listed = all
                .iter()
                .filter(|value| translation != Some(value.norm()))
                .filter(|value| !symmetric || value.im >= 0.0);
            let first = listed.take(request.eigenvalues);
            leading.extend(first.map(|value| (sector, *value)));
        }
        Ok(leading)
    }
}

/// d = −sign c.
fn direction(speed: f64) -> isize {
    if speed < 0.0 { 1 } else { -1 }
}

/// Newton's method for a wave that runs in the direction of `speed`.
fn correct(
    ring: &RingEquations,
    guess: &Guess,
    speed: f64,
    tolerance: f64,
) -> Result<RingWave, RingFailure> {
    let points = guess.state.len();
    let size = 2 * points + 1;
    let direction = direction(speed);
    let shifted = |index: usize| (index as isize + direction).rem_euclid(points as isize) as usize;
    let mut state = guess.state.clone();
    let mut period = guess.period;
    let mut fractions = Vec::new();
    let mut correction = f64::INFINITY;
    let range_before = range(&state);
    for iterations in 1..=MOST_ITERATIONS {
        if correction > NEW_STEPS * ring.epsilon {
            fractions = ring.fractions(&state, period, tolerance)?;
        }
        let flow = ring.flow(&state, period, &fractions)?;
        let band = Band::new(ring, &flow.steps, points, ring.reach(period))
            .ok_or(RingFailure::Stages { step: period })?;
        if correction <= (CLOSE * ring.epsilon).max(FLOOR) {
            let range = range(&state);
            if range < KEPT * range_before {
                return Err(RingFailure::SteadySliding { range });
            }
            return Ok(RingWave {
                state,
                period,
                steps: flow.steps,
                band,
                iterations,
            });
        }
        let mut matrix = Mat::<f64>::zeros(size, size);
        let mut right = Mat::<f64>::zeros(size, 1);
        band.shifted(0, |row, column, _, value| matrix[(row, column)] += value);
        for index in 0..points {
            let next = shifted(index);
            for component in 0..2 {
                let row = 2 * index + component;
                matrix[(row, 2 * next + component)] -= 1.0;
                // T as unknown in units of itring
                matrix[(row, size - 1)] = flow.by_period[index][component] * period;
                right[(row, 0)] = state[next][component] - flow.end[index][component];
            }
            // the guess fixes the phase: corrections of V are orthogonal to its V̇
            matrix[(size - 1, 2 * index)] = guess.state[index][1] / points as f64;
        }
        let solution = matrix.partial_piv_lu().solve(&right);
        correction = size_of((0..size).map(|index| solution[(index, 0)]));
        if correction > TOO_LARGE || solution[(size - 1, 0)] <= -0.5 {
            return Err(RingFailure::Divergence { correction });
        }
        for (index, values) in state.iter_mut().enumerate() {
            values[0] += solution[(2 * index, 0)];
            values[1] += solution[(2 * index + 1, 0)];
        }
        period *= 1.0 + solution[(size - 1, 0)];
    }
    Err(RingFailure::Divergence { correction })
}

/// Largest less least V̇.
fn range(state: &Values) -> f64 {
    let rates = || state.iter().map(|&[_, rate]| rate);
    rates().fold(f64::NEG_INFINITY, f64::max) - rates().fold(f64::INFINITY, f64::min)
}
