//! Stability of a wave from a discretised ring: a check that shares nothing with the exact
//! eigenvalues but the model.
//!
//! # System
//!
//! The ring has n points per wavelength, Δφ = 2π/(kn). ∂φ becomes central differences and the sign
//! of the sliding velocity tanh((1 − V̇)/ε). In full contact, U = δ, that leaves
//!
//! ```text
//! V̈_i + αV̇_i − a(V̂_{i+1} − 2V̂_i + V̂_{i−1})/Δφ² + hV̂_i = fP_i tanh((1 − V̇_i)/ε),
//! P_i = gδ − D(V̂_{i+1} − V̂_{i−1})/(2Δφ),   V̂ = V + βV̇,
//! ```
//!
//! an ordinary differential equation without switches; stick, slip and reverse slip are what tanh
//! makes of V̇ ≈ 1, V̇ < 1 and V̇ > 1. Write y_i = (V_i, V̇_i), and d = −sign c for the direction of
//! the index that the material meets: what a point does, its neighbour i − d does T = Δφ/|c|
//! later. A travelling wave satisfies
//!
//! ```text
//! y_i(T) = y_{i+d}(0),   y_{i+n} = y_i,   T = Δφ/|c|:
//! ```
//!
//! 2n + 1 unknowns, closed by orthogonality of the correction of V to the wave's own V̇. Newton's
//! method starts from the exact wave at a large ε, which is then reduced with a secant predictor
//! and a step control in ln ε.
//!
//! # Spectrum
//!
//! Let Y be the fundamental matrix of the ring over T. A perturbation with e^{λt}, of Bloch sector
//! j, satisfies Yx = μSx with (Sx)_i = x_{i+d}, x_{i+n} = e^{2πijd/k} x_i and μ = e^{λT}: the
//! multipliers of the sector are the 2n eigenvalues of S⁻¹Y on one cell, in which an entry that
//! reaches across an end of the cell takes the factor e^{±2πij/k}. That is N(λ)e^{−λT_w} = e^{2πij/k},
//! T_w = 2π/(k|c|), for the semi-discrete wave; for c < 0 its sector has ψ(θ + 2π/k) = e^{2πij/k}ψ(θ).
//! T is so short that the principal value of ln μ/T is the eigenvalue of everything that the grid
//! resolves: |Im λ| ≤ π/T = nk|c|/2. One μ of sector 0 is 1, translation in time.
//!
//! Stick forgets V̇ and passes V from point to point, so S⁻¹Y is nearly nilpotent there and its
//! eigenvalues near zero are sensitive to rounding: at the latest those with Re λ below −36/T_stick,
//! where e^{λT_stick} is the rounding unit, mean nothing. Those of interest lie far to the right.
//!
//! # Numerics
//!
//! Friction is stiff like fP/ε where V̇ ≈ 1, at one point at a time in a layer of duration ε/V̈ where
//! slip ends. The three-stage Radau IIA method (order 5, L-stable) takes it; its steps are found by
//! step doubling, then kept as fractions of T while Newton's method converges, so that the map is
//! smooth and Y is the exact derivative of the map that is computed. Each implicit step is a
//! (cyclic) block-tridiagonal system in the three stage values of V̇ at each point.
//!
//! Over T a signal runs √a T/Δφ = √a/|c| < 1 spacings. What lies m spacings off is reached with
//! order (a/c²)^m/(2m)!, below rounding at m = 12. So Y is a band, and is computed as one: the
//! perturbations of a group of points are followed in a window that extends 12 points beyond, in
//! O(n) operations in all. The linear system of Newton's method and the eigenvalue problems are
//! dense: the one is small beside the other, and of the other all eigenvalues are wanted.
//!
//! With β > 0 velocities diffuse by the number βaT/Δφ² = βa/(Δφ|c|) per T, which grows with n. The
//! implicit method needs no shorter steps for it, but the band widens. A perturbation e^{qi} of the
//! chain grows by e^x over T, x² = s(νx + a/c²) with ν the diffusion number and s = 4 sinh²(q/2): what
//! is felt m spacings off is at most the least of e^{x − qm} over q, and the window extends to where
//! that is below rounding (m = 16 at ν = ½, 34 at ν = 5).
//!
//! # What is left out
//!
//! Waves with separation are refused. A penalty P = max(0, gδ − DV′ + K(δ − U)) is smooth enough for
//! this method, but its limit K → ∞ at a fixed grid is not the wave's impact law, nor is the limit
//! Δφ → 0 after it. When a point has landed, its neighbour is still falling with U̇⁻ and lies above
//! it by |U̇⁻|(T − t) for the time T; the central difference of U″ at the landed point then pulls it
//! with b|U̇⁻|(T − t)/Δφ². The impulse of that, ∫₀ᵀ = b|U̇⁻|T²/(2Δφ²) = b|U̇⁻|/(2c²), does not depend
//! on the grid. Nothing but tension would hold the point down, so it leaves again with a fraction
//! b/(2c²) of the velocity it came with, where the wave demands rest. The semi-discrete waves
//! converge, to a problem with that restitution and other eigenvalues. Dropping U″ from landed
//! points removes it and replaces the flow by one that switches, for which the exact jumps of the
//! perturbation would have to be put in by hand: then it would not be an independent check. Reverse
//! slip needs nothing extra.
//!
//! Complex numbers are [`faer::c64`], which is num-complex's `Complex<f64>`.

use std::f64::consts::TAU;

use faer::{Mat, c64};
use nalgebra::Matrix3;

use crate::begin::{NoStart, first_wave};
use crate::continuation;
use crate::flow::FlowError;
use crate::linalg::Vector;
use crate::model::Model;
use crate::model::signature::Regime;
use crate::problem::Parameter;
use crate::wave::profile;
use crate::wave::start::Which;
use crate::wave::{Wave, profile::switches};

/// What to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Points per wavelength n, [`LEAST_POINTS`] to [`MOST_POINTS`].
    pub points: usize,
    /// Width ε > 0 of the friction law in V̇. Once the error from the spacing dominates, a smaller
    /// one costs steps and gains nothing.
    pub epsilon: f64,
    /// Which of the two slip-stick waves to start from.
    pub which: Which,
    /// Largest error of V and V̇ in one time step (absolute, V̇ is of order one). Through
    /// λ = ln μ/T an error of the step shows in the eigenvalues divided by T.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            points: 200,
            epsilon: 0.005,
            which: Which::Fast,
            tolerance: 1e-10,
        }
    }
}

/// Fewer points do not resolve a wave.
pub const LEAST_POINTS: usize = 8;

/// With more points the dense matrices take more than [`memory`] of this many, 3 GB, and hours.
pub const MOST_POINTS: usize = 4000;

/// Bytes that the eigenvalues of a cell of n points take: three complex matrices of 2n rows.
pub fn memory(points: f64) -> f64 {
    3.0 * 16.0 * (2.0 * points).powi(2)
}

/// ε at which a wave is first sought, unless a larger one is asked for.
pub const FIRST_EPSILON: f64 = 0.2;

/// Least ε at which the exact wave is close enough to start from, if larger ones fail.
const LAST_FIRST_EPSILON: f64 = 0.0125;

/// Number of spacings beyond which nothing is felt within T without material damping (see the text of
/// the module).
const LEAST_REACH: usize = 12;
/// What is felt beyond the window, at most, for perturbations of order one: below rounding.
const UNFELT: f64 = 1e-17;

/// Largest and least factor of ε from one wave to the next; the first is [`FIRST_FACTOR`].
const LEAST_FACTOR: f64 = 0.2;
const FIRST_FACTOR: f64 = 0.5;
const MOST_FACTOR: f64 = 0.97;

/// Iterations of Newton's method for a wave and for the stages of a step. Both start close.
const MOST_ITERATIONS: usize = 12;
/// The last correction of Newton's method in units of ε, over which friction bends; what remains is
/// its square.
const CLOSE: f64 = 1e-6;
/// Where ε is so small that [`CLOSE`] would ask for more than rounding allows.
const FLOOR: f64 = 1e-10;
/// Corrections (in units of ε) beyond which the time steps are chosen anew.
const NEW_STEPS: f64 = 0.1;
/// Part of the range of V̇ that a wave keeps at least from where the iteration starts. Steady sliding,
/// V̇ = 0, satisfies all equations of a wave for every T, and draws the iteration where a wave is small.
const KEPT: f64 = 0.25;
/// Corrections of V̇ beyond which Newton's method is given up.
const TOO_LARGE: f64 = 30.0;

/// Why there is no semi-discrete wave, or no spectrum of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Too few points, or too many.
    #[error("no ring of {points} points per wavelength: take {LEAST_POINTS} to {MOST_POINTS}")]
    Points {
        /// Points asked for.
        points: usize,
    },
    /// ε is not a positive number.
    #[error("ε = {epsilon} is no width of a friction law; take a positive number such as 0.01")]
    Epsilon {
        /// ε asked for.
        epsilon: f64,
    },
    /// The tolerance is out of range.
    #[error("tolerance {tolerance:e} of a time step is out of range; take 1e-13 to 1e-4")]
    Tolerance {
        /// Tolerance asked for.
        tolerance: f64,
    },
    /// The wave leaves contact.
    #[error("the discretised ring is in full contact, but the wave is {signature}")]
    Separation {
        /// Sequence of regimes.
        signature: String,
    },
    /// There is no exact wave to start from.
    #[error("{0}")]
    Start(#[from] NoStart),
    /// The exact wave cannot be evaluated.
    #[error("{0}")]
    Flow(#[from] FlowError),
    /// Newton's method does not reach the ε asked for.
    #[error(
        "with {points} points per wavelength the wave cannot be followed to ε = {wanted:e}: at \
         ε = {failed:e}, {failure}; take more points or a larger ε"
    )]
    Unreached {
        /// Points per wavelength.
        points: usize,
        /// ε asked for.
        wanted: f64,
        /// ε at which it failed.
        failed: f64,
        /// How it failed.
        failure: Failure,
    },
    /// No such sector.
    #[error("a wave of mode {mode} has the sectors 0 to {}, not {sector}", mode.saturating_sub(1))]
    Sector {
        /// Sector asked for.
        sector: u32,
        /// Mode k.
        mode: u32,
    },
    /// The iteration for the eigenvalues failed.
    #[error("the eigenvalues of a matrix of {size} rows do not converge")]
    Eigenvalues {
        /// Rows of the matrix.
        size: usize,
    },
}

/// Why one attempt of Newton's method failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The time steps became too small.
    #[error("the time steps fall below {step:e}")]
    Steps {
        /// Last step tried.
        step: f64,
    },
    /// The stages of a given step were not found.
    #[error("the implicit time step of {step:e} has no solution")]
    Stages {
        /// Step.
        step: f64,
    },
    /// The iteration ended in steady sliding.
    #[error("Newton's method ends in steady sliding (V̇ has a range of {range:e})")]
    SteadySliding {
        /// Largest less least V̇.
        range: f64,
    },
    /// The iteration does not converge.
    #[error("Newton's method does not converge (last correction {correction:e})")]
    Divergence {
        /// Largest component of the last correction.
        correction: f64,
    },
}

/// V and V̇ at the points of a cell.
type State = Vec<[f64; 2]>;
/// A number for each stage.
type Stages = [f64; 3];
/// Coupling of the stage values of two points.
type Block = Matrix3<f64>;

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
    ring: Ring,
    /// Linearised time steps.
    steps: Vec<Linear>,
    band: Band,
}

/// The semi-discrete wave of mode k of a model, continued from the exact wave.
///
/// # Errors
/// Settings out of range, no exact wave in full contact, or an ε that cannot be reached with so
/// few points.
pub fn solve(model: &Model, mode: u32, settings: &Settings) -> Result<SemiDiscreteWave, Error> {
    settings.check()?;
    let width = model.mismatch.abs().max(f64::MIN_POSITIVE);
    let steps = continuation::Settings {
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

/// The semi-discrete wave next to a given exact one; [`Settings::which`] is not used.
///
/// # Errors
/// As for [`solve`].
pub fn solve_from(
    wave: &Wave,
    point: &Vector,
    settings: &Settings,
) -> Result<SemiDiscreteWave, Error> {
    let model = wave.model_at(point);
    settings.check()?;
    if wave.signature.has(Regime::Separation) {
        return Err(Error::Separation {
            signature: wave.signature.to_string(),
        });
    }
    let mut first = settings.epsilon.max(FIRST_EPSILON);
    let mut ring = Ring::new(&model, wave.mode, settings.points, first);
    let speed = wave.speed_at(point);
    let guess = Guess {
        state: sampled(wave, point, settings.points)?,
        period: ring.spacing / speed.abs(),
    };
    let start = loop {
        match ring.correct(&guess, speed, settings.tolerance) {
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

impl Settings {
    fn check(&self) -> Result<(), Error> {
        if !(LEAST_POINTS..=MOST_POINTS).contains(&self.points) {
            return Err(Error::Points {
                points: self.points,
            });
        }
        if !(self.epsilon > 0.0 && self.epsilon.is_finite()) {
            return Err(Error::Epsilon {
                epsilon: self.epsilon,
            });
        }
        if !(1e-13..=1e-4).contains(&self.tolerance) {
            return Err(Error::Tolerance {
                tolerance: self.tolerance,
            });
        }
        Ok(())
    }
}

/// The exact wave at the points of a cell, in the order of φ. Points lie half a spacing off the
/// release.
fn sampled(wave: &Wave, point: &Vector, points: usize) -> Result<State, FlowError> {
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
    pub fn period(&self) -> f64 {
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
        let mut before: Option<(f64, State, f64)> = None;
        while self.epsilon != epsilon {
            let next = if epsilon < self.epsilon {
                // no tiny last step
                let step = self.epsilon * factor;
                if step < 1.1 * epsilon { epsilon } else { step }
            } else {
                (self.epsilon / factor).min(epsilon)
            };
            let ring = Ring {
                epsilon: next,
                ..self.ring
            };
            let guess = self.predict(next, before.as_ref());
            match ring.correct(&guess, self.speed, self.tolerance) {
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
    fn predict(&self, epsilon: f64, before: Option<&(f64, State, f64)>) -> Guess {
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

    /// All multipliers of the whole ring of kn points, computed without cells, sectors or windows:
    /// the union of those of all sectors. The work grows like (kn)³.
    ///
    /// # Errors
    /// When the iteration for the eigenvalues fails.
    pub fn whole_ring_multipliers(&self) -> Result<Vec<c64>, Error> {
        let points = self.values.len();
        let nodes = points * self.mode as usize;
        let size = 2 * nodes;
        let mut fan = Fan::new(0, nodes, 0, nodes, true);
        for step in &self.steps {
            if !fan.advance(&self.ring, step) {
                return Err(Error::Eigenvalues { size });
            }
        }
        let direction = direction(self.speed);
        let mut matrix = Mat::<f64>::zeros(size, size);
        for row in 0..nodes {
            let shifted = (row as isize + direction).rem_euclid(nodes as isize) as usize;
            for component in 0..2 {
                for (column, value) in fan.row(row, component).iter().enumerate() {
                    matrix[(2 * shifted + component, column)] = *value;
                }
            }
        }
        matrix
            .eigenvalues()
            .map_err(|_| Error::Eigenvalues { size })
    }
}

/// d = −sign c.
fn direction(speed: f64) -> isize {
    if speed < 0.0 { 1 } else { -1 }
}

/// Coefficients of the semi-discrete system.
#[derive(Clone, Copy, Debug)]
struct Ring {
    spacing: f64,
    /// a/Δφ².
    tension: f64,
    /// h.
    stiffness: f64,
    /// α.
    damping: f64,
    /// β.
    material: f64,
    /// gδ.
    weight: f64,
    /// D/(2Δφ).
    coupling: f64,
    friction: f64,
    epsilon: f64,
}

/// Radau IIA with three stages: coefficients. The last row holds the weights.
fn radau() -> Block {
    let root = 6.0_f64.sqrt();
    Block::new(
        (88.0 - 7.0 * root) / 360.0,
        (296.0 - 169.0 * root) / 1800.0,
        (-2.0 + 3.0 * root) / 225.0,
        (296.0 + 169.0 * root) / 1800.0,
        (88.0 + 7.0 * root) / 360.0,
        (-2.0 - 3.0 * root) / 225.0,
        (16.0 - root) / 36.0,
        (16.0 + root) / 36.0,
        1.0 / 9.0,
    )
}

/// Order 5: the error of two half steps is the difference from the full step over 2⁵ − 1.
const HALVED: f64 = 31.0;

/// Derivatives of the acceleration F_i(V̂_{i−1}, V̂_i, V̂_{i+1}, V̇_i) of a point at the stages of a
/// step; ∂F_i/∂V̂_i is constant.
#[derive(Clone, Copy, Debug, Default)]
struct Slopes {
    /// ∂F_i/∂V̇_i.
    rate: Stages,
    /// ∂F_i/∂V̂_{i+1}.
    ahead: Stages,
    /// ∂F_i/∂V̂_{i−1}.
    behind: Stages,
}

/// A time step, linearised.
#[derive(Clone, Debug)]
struct Linear {
    step: f64,
    slopes: Vec<Slopes>,
}

/// A time step taken.
struct Taken {
    linear: Linear,
    factors: Factors,
    /// V and V̇ at the stages of each point.
    displacement: Vec<Stages>,
    rate: Vec<Stages>,
}

impl Taken {
    fn end(&self) -> State {
        self.displacement
            .iter()
            .zip(&self.rate)
            .map(|(v, w)| [v[2], w[2]])
            .collect()
    }
}

/// Where Newton's method starts.
struct Guess {
    state: State,
    period: f64,
}

/// A wave found.
struct Found {
    state: State,
    period: f64,
    steps: Vec<Linear>,
    band: Band,
    iterations: usize,
}

/// The map of T and its derivative with respect to T.
struct Flow {
    end: State,
    by_period: State,
    steps: Vec<Linear>,
}

impl Ring {
    fn new(model: &Model, mode: u32, points: usize, epsilon: f64) -> Ring {
        let parameters = model.parameters();
        let coefficients = parameters.coefficients;
        let spacing = TAU / (f64::from(mode) * points as f64);
        Ring {
            spacing,
            tension: coefficients.a / (spacing * spacing),
            stiffness: coefficients.h,
            damping: parameters.mass_damping,
            material: parameters.stiffness_damping,
            weight: coefficients.g * parameters.mismatch,
            coupling: 0.5 * coefficients.coupling / spacing,
            friction: parameters.friction,
            epsilon,
        }
    }

    /// ∂F_i/∂V̂_i.
    fn own(&self) -> f64 {
        -2.0 * self.tension - self.stiffness
    }

    /// Number of spacings beyond which nothing is felt within T: the least m ≥ [`LEAST_REACH`] at
    /// which e^{x − qm} falls below [`UNFELT`] for some q.
    fn reach(&self, period: f64) -> usize {
        /// Trial values of q; the bound is flat around the best one.
        const TRIALS: [f64; 16] = [
            0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0,
        ];
        if self.material == 0.0 {
            return LEAST_REACH;
        }
        // friction joins neighbours, too, through the pressure
        let joined = self.tension + (self.friction * self.coupling).abs();
        let (spread, wave) = (joined * self.material * period, joined * period * period);
        let needed = TRIALS
            .map(|q| {
                let s = 4.0 * (0.5 * q).sinh().powi(2);
                let half = 0.5 * spread * s;
                (half + (half * half + wave * s).sqrt() - UNFELT.ln()) / q
            })
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        LEAST_REACH.max(needed.ceil() as usize)
    }

    /// Accelerations at the stages of point i from V̂ there and V̇, with their derivatives.
    fn acceleration(&self, [behind, here, ahead]: [&Stages; 3], rate: &Stages) -> (Stages, Slopes) {
        let mut force = Stages::default();
        let mut slopes = Slopes::default();
        for stage in 0..3 {
            let (before, after) = (behind[stage], ahead[stage]);
            let pressure = self.friction * (self.weight - self.coupling * (after - before));
            let sign = ((1.0 - rate[stage]) / self.epsilon).tanh();
            force[stage] = self.tension * (after - 2.0 * here[stage] + before)
                - self.damping * rate[stage]
                - self.stiffness * here[stage]
                + pressure * sign;
            slopes.rate[stage] =
                -self.damping - pressure * (1.0 - sign) * (1.0 + sign) / self.epsilon;
            let pull = self.friction * self.coupling * sign;
            slopes.ahead[stage] = self.tension - pull;
            slopes.behind[stage] = self.tension + pull;
        }
        (force, slopes)
    }

    /// Matrix of a step for the stage values of V̇:
    /// W_s − hΣA_sr[(∂F/∂W)_r W_r + (∂F/∂V̂)_r(βW_r + hΣA_rq W_q)].
    fn factors(&self, linear: &Linear, nodes: Nodes) -> Option<Factors> {
        let step = linear.step;
        let radau = radau();
        // V̂ of the stages from W
        let effective = radau * step + Block::identity() * self.material;
        let square = radau * effective * (step * self.own());
        let points = linear.slopes.len();
        let slopes = |index: usize| &linear.slopes[nodes.point(index, points)];
        let through = |slope: &Stages| {
            let weighted = Block::from_fn(|row, column| slope[row] * effective[(row, column)]);
            radau * weighted * -step
        };
        Factors::new(
            nodes,
            |index| {
                let rate = &slopes(index).rate;
                Block::from_fn(|row, column| {
                    f64::from(row == column)
                        - step * radau[(row, column)] * rate[column]
                        - square[(row, column)]
                })
            },
            |index| through(&slopes(index).ahead),
            |index| through(&slopes(index).behind),
        )
    }

    /// One time step.
    fn step(&self, from: &State, step: f64) -> Result<Taken, Failure> {
        let points = from.len();
        let nodes = Nodes {
            first: 0,
            count: points,
            cyclic: true,
        };
        let radau = radau();
        let failure = Failure::Stages { step };
        let mut rate: Vec<Stages> = from.iter().map(|&[_, w]| [w; 3]).collect();
        let mut linear = Linear {
            step,
            slopes: vec![Slopes::default(); points],
        };
        let mut displacement = vec![Stages::default(); points];
        let mut effective = vec![Stages::default(); points];
        let mut right = vec![0.0; 3 * points];
        let mut close = false;
        for _ in 0..MOST_ITERATIONS {
            for ((v, w), start) in displacement.iter_mut().zip(&rate).zip(from) {
                *v = std::array::from_fn(|stage| start[0] + step * dot(&radau, stage, w));
            }
            for ((hat, v), w) in effective.iter_mut().zip(&displacement).zip(&rate) {
                *hat = std::array::from_fn(|stage| v[stage] + self.material * w[stage]);
            }
            for index in 0..points {
                let around = [
                    &effective[(index + points - 1) % points],
                    &effective[index],
                    &effective[(index + 1) % points],
                ];
                let (force, slopes) = self.acceleration(around, &rate[index]);
                linear.slopes[index] = slopes;
                for stage in 0..3 {
                    right[3 * index + stage] =
                        from[index][1] - rate[index][stage] + step * dot(&radau, stage, &force);
                }
            }
            let factors = self.factors(&linear, nodes).ok_or(failure)?;
            if close {
                return Ok(Taken {
                    linear,
                    factors,
                    displacement,
                    rate,
                });
            }
            factors.solve(&mut right, 1);
            let largest = size_of(right.iter().copied());
            if largest > TOO_LARGE {
                return Err(failure);
            }
            for (w, correction) in rate.iter_mut().zip(right.chunks_exact(3)) {
                for (w, correction) in w.iter_mut().zip(correction) {
                    *w += correction;
                }
            }
            close = largest <= CLOSE * self.epsilon;
        }
        Err(failure)
    }

    /// Fractions of T at which no step errs by more than the tolerance, by step doubling.
    fn fractions(&self, from: &State, period: f64, tolerance: f64) -> Result<Vec<f64>, Failure> {
        /// Of T: fronts of ε = 1e-6 still have steps a hundred times longer.
        const SHORTEST: f64 = 1e-9;
        let mut fractions = Vec::new();
        let mut state = from.clone();
        let mut done = 0.0;
        let mut share = 0.25_f64;
        while done < 1.0 {
            // no tiny last step
            let left = 1.0 - done;
            let now = if share >= left {
                left
            } else {
                share.min(0.5 * left)
            };
            if now < SHORTEST {
                return Err(Failure::Steps { step: now * period });
            }
            let half = 0.5 * now * period;
            let attempt = self.step(&state, 2.0 * half).and_then(|whole| {
                let middle = self.step(&state, half)?;
                let end = self.step(&middle.end(), half)?;
                Ok((whole, end))
            });
            let Ok((whole, end)) = attempt else {
                share = 0.25 * now;
                continue;
            };
            let end = end.end();
            let whole = whole.end();
            let differences = whole
                .iter()
                .zip(&end)
                .flat_map(|(one, other)| [one[0] - other[0], one[1] - other[1]]);
            let error = size_of(differences) / HALVED;
            let advice = 0.9 * (tolerance / error.max(1e-3 * tolerance)).powf(1.0 / 6.0);
            share = now * advice.clamp(0.2, 3.0);
            if error <= tolerance {
                fractions.extend([0.5 * now; 2]);
                done = if now == left { 1.0 } else { done + now };
                state = end;
            }
        }
        Ok(fractions)
    }

    /// The map of T with given time steps.
    fn flow(&self, from: &State, period: f64, fractions: &[f64]) -> Result<Flow, Failure> {
        let radau = radau();
        let points = from.len();
        let mut state = from.clone();
        let mut by_period = vec![[0.0; 2]; points];
        let mut steps = Vec::with_capacity(fractions.len());
        let own = self.own();
        for fraction in fractions {
            let step = fraction * period;
            let taken = self.step(&state, step)?;
            // the stages of V with the derivatives of W left out
            let moved: Vec<Stages> = (0..points)
                .map(|index| {
                    std::array::from_fn(|stage| {
                        by_period[index][0]
                            + (taken.displacement[index][stage] - state[index][0]) / period
                    })
                })
                .collect();
            let mut right = Vec::with_capacity(3 * points);
            for index in 0..points {
                let slopes = &taken.linear.slopes[index];
                let (behind, ahead) = ((index + points - 1) % points, (index + 1) % points);
                let force: Stages = std::array::from_fn(|stage| {
                    own * moved[index][stage]
                        + slopes.ahead[stage] * moved[ahead][stage]
                        + slopes.behind[stage] * moved[behind][stage]
                });
                for stage in 0..3 {
                    right.push(
                        by_period[index][1]
                            + (taken.rate[index][stage] - state[index][1]) / period
                            + step * dot(&radau, stage, &force),
                    );
                }
            }
            taken.factors.solve(&mut right, 1);
            for (index, rate) in right.chunks_exact(3).enumerate() {
                by_period[index] = [
                    moved[index][2] + step * dot(&radau, 2, &[rate[0], rate[1], rate[2]]),
                    rate[2],
                ];
            }
            state = taken.end();
            steps.push(taken.linear);
        }
        Ok(Flow {
            end: state,
            by_period,
            steps,
        })
    }

    /// Newton's method for a wave that runs in the direction of `speed`.
    fn correct(&self, guess: &Guess, speed: f64, tolerance: f64) -> Result<Found, Failure> {
        let points = guess.state.len();
        let size = 2 * points + 1;
        let direction = direction(speed);
        let shifted =
            |index: usize| (index as isize + direction).rem_euclid(points as isize) as usize;
        let mut state = guess.state.clone();
        let mut period = guess.period;
        let mut fractions = Vec::new();
        let mut correction = f64::INFINITY;
        let range_before = range(&state);
        for iterations in 1..=MOST_ITERATIONS {
            if correction > NEW_STEPS * self.epsilon {
                fractions = self.fractions(&state, period, tolerance)?;
            }
            let flow = self.flow(&state, period, &fractions)?;
            let band = Band::new(self, &flow.steps, points, self.reach(period))
                .ok_or(Failure::Stages { step: period })?;
            if correction <= (CLOSE * self.epsilon).max(FLOOR) {
                let range = range(&state);
                if range < KEPT * range_before {
                    return Err(Failure::SteadySliding { range });
                }
                return Ok(Found {
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
                    // T as unknown in units of itself
                    matrix[(row, size - 1)] = flow.by_period[index][component] * period;
                    right[(row, 0)] = state[next][component] - flow.end[index][component];
                }
                // the guess fixes the phase: corrections of V are orthogonal to its V̇
                matrix[(size - 1, 2 * index)] = guess.state[index][1] / points as f64;
            }
            let solution = {
                use faer::linalg::solvers::Solve;

                matrix.partial_piv_lu().solve(&right)
            };
            correction = size_of((0..size).map(|index| solution[(index, 0)]));
            if correction > TOO_LARGE || solution[(size - 1, 0)] <= -0.5 {
                return Err(Failure::Divergence { correction });
            }
            for (index, values) in state.iter_mut().enumerate() {
                values[0] += solution[(2 * index, 0)];
                values[1] += solution[(2 * index + 1, 0)];
            }
            period *= 1.0 + solution[(size - 1, 0)];
        }
        Err(Failure::Divergence { correction })
    }
}

/// Largest less least V̇.
fn range(state: &State) -> f64 {
    let rates = || state.iter().map(|&[_, rate]| rate);
    rates().fold(f64::NEG_INFINITY, f64::max) - rates().fold(f64::INFINITY, f64::min)
}

/// Largest magnitude; infinite if something is not a number.
fn size_of(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| {
        if value.is_nan() {
            f64::INFINITY
        } else {
            f64::max(largest, value.abs())
        }
    })
}

/// Σ_r A_sr x_r.
fn dot(radau: &Block, stage: usize, x: &Stages) -> f64 {
    radau[(stage, 0)] * x[0] + radau[(stage, 1)] * x[1] + radau[(stage, 2)] * x[2]
}

/// Consecutive points of the ring or of its repetition.
#[derive(Clone, Copy, Debug)]
struct Nodes {
    first: isize,
    count: usize,
    /// Whether the last is next to the first.
    cyclic: bool,
}

impl Nodes {
    /// Point of the cell at an index.
    fn point(&self, index: usize, points: usize) -> usize {
        (self.first + index as isize).rem_euclid(points as isize) as usize
    }
}

/// Factors of a block-tridiagonal matrix, cyclic or not. The last point is eliminated last; in a
/// cyclic matrix it is next to the first, which fills its row and column. The matrices are close to
/// block-diagonal ones with dominant blocks (the coupling has the factor h²a/Δφ² < 1), so that
/// pivoting within blocks is enough.
#[derive(Clone, Debug)]
struct Factors {
    cyclic: bool,
    inverse: Vec<Block>,
    /// Coupling to the next point, above the diagonal.
    upper: Vec<Block>,
    /// Multiplier of the row before.
    lower: Vec<Block>,
    /// Coupling to the last point, in cyclic matrices.
    column: Vec<Block>,
    /// Multipliers for the row of the last point, in cyclic matrices.
    row: Vec<Block>,
}

impl Factors {
    fn new(
        nodes: Nodes,
        own: impl Fn(usize) -> Block,
        ahead: impl Fn(usize) -> Block,
        behind: impl Fn(usize) -> Block,
    ) -> Option<Factors> {
        let Nodes { count, cyclic, .. } = nodes;
        let last = count - 1;
        let zero = Block::zeros();
        let mut factors = Factors {
            cyclic,
            inverse: Vec::with_capacity(count),
            upper: Vec::with_capacity(count),
            lower: Vec::with_capacity(count),
            column: Vec::with_capacity(count),
            row: Vec::with_capacity(count),
        };
        let mut diagonal = own(0);
        let mut corner = own(last);
        let (mut column, mut row) = if cyclic {
            (behind(0), ahead(last))
        } else {
            (zero, zero)
        };
        for index in 0..last {
            let inverse = diagonal.try_inverse()?;
            let mut upper = ahead(index);
            if index + 1 == last {
                // the last point is the next point
                column += upper;
                row += behind(last);
                upper = zero;
            }
            let multiplier = row * inverse;
            corner -= multiplier * column;
            factors.row.push(multiplier);
            factors.column.push(column);
            factors.upper.push(upper);
            factors.inverse.push(inverse);
            if index + 1 < last {
                let lower = behind(index + 1) * inverse;
                diagonal = own(index + 1) - lower * upper;
                if cyclic {
                    row = -multiplier * upper;
                    column = -lower * column;
                }
                factors.lower.push(lower);
            }
        }
        factors.inverse.push(corner.try_inverse()?);
        Some(factors)
    }

    /// Solves in place for several right-hand sides, which lie side by side in rows: three rows for
    /// each point.
    fn solve(&self, x: &mut [f64], columns: usize) {
        let last = self.inverse.len() - 1;
        let width = 3 * columns;
        // in a matrix that is not cyclic only the neighbour touches the row of the last point
        let coupled = |index: usize| self.cyclic || index + 1 == last;
        for index in 0..last {
            let (left, right) = x.split_at_mut(width * (index + 1));
            let here = &left[width * index..];
            if index + 1 < last {
                subtract(&self.lower[index], here, &mut right[..width], columns);
            }
            if coupled(index) {
                let end = right.len() - width;
                subtract(&self.row[index], here, &mut right[end..], columns);
            }
        }
        multiply(&self.inverse[last], &mut x[width * last..], columns);
        for index in (0..last).rev() {
            let (left, right) = x.split_at_mut(width * (index + 1));
            let here = &mut left[width * index..];
            if index + 1 < last {
                subtract(&self.upper[index], &right[..width], here, columns);
            }
            if coupled(index) {
                let end = right.len() - width;
                subtract(&self.column[index], &right[end..], here, columns);
            }
            multiply(&self.inverse[index], here, columns);
        }
    }
}

/// The three rows of a point.
fn rows(x: &[f64], columns: usize) -> [&[f64]; 3] {
    [
        &x[..columns],
        &x[columns..2 * columns],
        &x[2 * columns..3 * columns],
    ]
}

/// to −= block·from.
fn subtract(block: &Block, from: &[f64], to: &mut [f64], columns: usize) {
    let [one, two, three] = rows(from, columns);
    for (row, to) in to.chunks_exact_mut(columns).enumerate() {
        let factors = [block[(row, 0)], block[(row, 1)], block[(row, 2)]];
        for (to, ((x, y), z)) in to.iter_mut().zip(one.iter().zip(two).zip(three)) {
            *to -= factors[0] * x + factors[1] * y + factors[2] * z;
        }
    }
}

/// x ← block·x.
fn multiply(block: &Block, x: &mut [f64], columns: usize) {
    let (one, rest) = x.split_at_mut(columns);
    let (two, three) = rest.split_at_mut(columns);
    for ((x, y), z) in one.iter_mut().zip(two).zip(three) {
        let product = block * nalgebra::Vector3::new(*x, *y, *z);
        (*x, *y, *z) = (product[0], product[1], product[2]);
    }
}

/// Perturbations of some points, followed at those and further points: rows for V and V̇ of each
/// point, and in them a column for V and for V̇ of each perturbed point.
struct Fan {
    nodes: Nodes,
    columns: usize,
    displacement: Vec<f64>,
    rate: Vec<f64>,
    work: Vec<f64>,
}

impl Fan {
    /// Unit perturbations of `group` points that begin `inset` points after the first.
    fn new(first: isize, count: usize, inset: usize, group: usize, cyclic: bool) -> Fan {
        let columns = 2 * group;
        let mut fan = Fan {
            nodes: Nodes {
                first,
                count,
                cyclic,
            },
            columns,
            displacement: vec![0.0; count * columns],
            rate: vec![0.0; count * columns],
            work: vec![0.0; 3 * count * columns],
        };
        for index in 0..group {
            let row = (inset + index) * columns;
            fan.displacement[row + 2 * index] = 1.0;
            fan.rate[row + 2 * index + 1] = 1.0;
        }
        fan
    }

    fn row(&self, index: usize, component: usize) -> &[f64] {
        let rows = if component == 0 {
            &self.displacement
        } else {
            &self.rate
        };
        &rows[index * self.columns..(index + 1) * self.columns]
    }

    /// Takes the perturbations through a time step. False where it is singular.
    fn advance(&mut self, ring: &Ring, linear: &Linear) -> bool {
        let Some(factors) = ring.factors(linear, self.nodes) else {
            return false;
        };
        let Nodes { count, cyclic, .. } = self.nodes;
        let (columns, step) = (self.columns, linear.step);
        let radau = radau();
        for index in 0..count {
            let slopes = &linear.slopes[self.nodes.point(index, linear.slopes.len())];
            let row = index * columns;
            let work = &mut self.work[3 * row..3 * (row + columns)];
            for (stage, work) in work.chunks_exact_mut(columns).enumerate() {
                // hΣA_sr(∂F/∂V̂)_r, V before the step being the same for all stages
                let own = step * ring.own() * dot(&radau, stage, &[1.0; 3]);
                work.copy_from_slice(&self.rate[row..row + columns]);
                add(own, &self.displacement[row..row + columns], work);
                let mut from = |slope: &Stages, neighbour: usize| {
                    let start = neighbour * columns;
                    add(
                        step * dot(&radau, stage, slope),
                        &self.displacement[start..start + columns],
                        work,
                    );
                };
                if cyclic || index + 1 < count {
                    from(&slopes.ahead, (index + 1) % count);
                }
                if cyclic || index > 0 {
                    from(&slopes.behind, (index + count - 1) % count);
                }
            }
        }
        factors.solve(&mut self.work, columns);
        for index in 0..count {
            let row = index * columns;
            let work = rows(&self.work[3 * row..], columns);
            for (stage, work) in work.iter().enumerate() {
                add(
                    step * radau[(2, stage)],
                    work,
                    &mut self.displacement[row..row + columns],
                );
            }
            self.rate[row..row + columns].copy_from_slice(work[2]);
        }
        true
    }
}

/// to += factor·from.
fn add(factor: f64, from: &[f64], to: &mut [f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += factor * from;
    }
}

/// The fundamental matrix over T as a band: for each point p of the cell the response of the points
/// p − reach to p + reach of an endless chain to perturbations of V_p and V̇_p.
#[derive(Clone, Debug)]
struct Band {
    points: usize,
    reach: usize,
    /// [point p][offset][component of response][component of perturbation].
    values: Vec<[[f64; 2]; 2]>,
}

impl Band {
    fn new(ring: &Ring, steps: &[Linear], points: usize, reach: usize) -> Option<Band> {
        // points that respond
        let width = 2 * reach + 1;
        let mut values = Vec::with_capacity(points * width);
        let mut begin = 0;
        while begin < points {
            // points followed together: with as many as the window has extra, half of the work is of
            // use, and a window stays in the cache
            let group = (2 * reach).min(points - begin);
            let first = begin as isize - reach as isize;
            let mut fan = Fan::new(first, group + 2 * reach, reach, group, false);
            for step in steps {
                if !fan.advance(ring, step) {
                    return None;
                }
            }
            for index in 0..group {
                for offset in 0..width {
                    values.push([0, 1].map(|component| {
                        let row = fan.row(index + offset, component);
                        [row[2 * index], row[2 * index + 1]]
                    }));
                }
            }
            begin += group;
        }
        Some(Band {
            points,
            reach,
            values,
        })
    }

    /// Visits the entries of S^{-1}Y, S⁻¹ shifting rows by `shift` points: row and column within the
    /// cell, by how many cells the row lies ahead of the column, value.
    fn shifted(&self, shift: isize, mut visit: impl FnMut(usize, usize, isize, f64)) {
        let points = self.points as isize;
        for (index, response) in self.values.iter().enumerate() {
            let width = 2 * self.reach + 1;
            let (point, offset) = (
                index / width,
                (index % width) as isize - self.reach as isize,
            );
            let row = point as isize + offset + shift;
            let cell = row.div_euclid(points);
            let row = row.rem_euclid(points) as usize;
            for (component, entries) in response.iter().enumerate() {
                for (other, value) in entries.iter().enumerate() {
                    visit(2 * row + component, 2 * point + other, cell, *value);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Source;
    use crate::model::coefficients::Geometry;

    fn model(mismatch: f64) -> Model {
        Model::tube(
            Geometry {
                nu: 0.3,
                xi: 1.5,
                gamma: 1.0,
            },
            0.5,
            mismatch,
        )
    }

    fn wave(points: usize, epsilon: f64) -> SemiDiscreteWave {
        damped(0.0, points, epsilon)
    }

    /// With material damping.
    fn damped(beta: f64, points: usize, epsilon: f64) -> SemiDiscreteWave {
        let settings = Settings {
            points,
            epsilon,
            ..Settings::default()
        };
        let model = Model {
            stiffness_damping: beta,
            ..model(0.2)
        };
        solve(&model, 4, &settings).unwrap()
    }

    fn nearest(values: &[c64], to: c64) -> f64 {
        values
            .iter()
            .map(|value| (value - to).norm())
            .fold(f64::INFINITY, f64::min)
    }

    /// Multipliers that do not belong to the nearly nilpotent part: rounding moves an eigenvalue
    /// of a chain of m points by 1e-16 to the power 1/m, the others by its own order.
    fn resolved(values: Vec<c64>) -> Vec<c64> {
        values.into_iter().filter(|mu| mu.norm() > 0.3).collect()
    }

    /// Both sets have the same size and every member of one has a partner in the other.
    fn assert_same(one: &[c64], other: &[c64], bound: f64) {
        assert_eq!(one.len(), other.len());
        for value in one {
            let distance = nearest(other, *value);
            assert!(distance < bound, "{value}: {distance:e}");
        }
        for value in other {
            let distance = nearest(one, *value);
            assert!(distance < bound, "{value}: {distance:e}");
        }
    }

    /// Y maps ẏ(0) to ẏ(T) = Sẏ(0): one multiplier is 1, up to the error of the time steps.
    #[test]
    fn translation_is_neutral_in_sector_zero() {
        for (beta, epsilon) in [(0.0, 0.1), (0.0, 0.02), (0.005, 0.1), (0.005, 0.02)] {
            let wave = damped(beta, 32, epsilon);
            let distance = nearest(&wave.multipliers(0).unwrap(), c64::new(1.0, 0.0));
            assert!(distance < 1e-8, "{distance:e}");
        }
    }

    /// The values satisfy y_i(T) = y_{i+1}(0) when followed with time steps of their own. Two
    /// sequences of steps that err by the tolerance in each of some ten steps differ by ten times it.
    #[test]
    fn the_wave_is_carried_on_by_one_point() {
        let wave = wave(40, 0.02);
        let fractions = wave
            .ring
            .fractions(&wave.values, wave.period(), 1e-12)
            .unwrap();
        let flow = wave
            .ring
            .flow(&wave.values, wave.period(), &fractions)
            .unwrap();
        for (index, end) in flow.end.iter().enumerate() {
            let next = wave.values[(index + 1) % 40];
            for (end, next) in end.iter().zip(next) {
                let error = (end - next).abs();
                assert!(error < 1e-8, "{index}: {error:e}");
            }
        }
    }

    /// Against differences of fourth order with the step h: their error is h⁴/30 times the fifth
    /// derivative, about 16fPT/ε⁵, rounding over h, and what Newton's method leaves in the stages
    /// (the square of its last correction over ε) over h: 1e-14, 1e-10 and 5e-9.
    #[test]
    fn fundamental_matrix_is_the_derivative_of_the_map() {
        const STEP: f64 = 1e-5;
        const BOUND: f64 = 1e-7;
        for beta in [0.0, 0.01] {
            derivatives_agree(&damped(beta, 16, 0.05), STEP, BOUND);
        }
    }

    fn derivatives_agree(wave: &SemiDiscreteWave, by: f64, bound: f64) {
        let (ring, period) = (wave.ring, wave.period());
        let fractions: Vec<f64> = wave.steps.iter().map(|step| step.step / period).collect();
        let map = |state: &State, period| ring.flow(state, period, &fractions).unwrap();
        let derivative = |moved: &dyn Fn(f64) -> State| -> State {
            let ends = [-2.0, -1.0, 1.0, 2.0].map(|steps| moved(steps * by));
            (0..16)
                .map(|index| {
                    [0, 1].map(|component| {
                        let [a, b, c, d] = [0, 1, 2, 3].map(|end| ends[end][index][component]);
                        (a - 8.0 * b + 8.0 * c - d) / (12.0 * by)
                    })
                })
                .collect()
        };
        let mut matrix = vec![[0.0; 32]; 32];
        wave.band
            .shifted(0, |row, column, _, value| matrix[row][column] += value);
        for column in 0..32 {
            let differences = derivative(&|shift| {
                let mut state = wave.values.clone();
                state[column / 2][column % 2] += shift;
                map(&state, period).end
            });
            for (row, entries) in matrix.iter().enumerate() {
                let error = (entries[column] - differences[row / 2][row % 2]).abs();
                assert!(error < bound, "{row} {column}: {error:e}");
            }
        }
        let differences = derivative(&|shift| map(&wave.values, period + shift).end);
        let flow = map(&wave.values, period);
        for (value, difference) in flow.by_period.iter().zip(&differences) {
            for (value, difference) in value.iter().zip(difference) {
                let error = (value - difference).abs();
                assert!(error < bound, "{error:e}");
            }
        }
    }

    #[test]
    fn sectors_and_their_complements_are_conjugate() {
        let wave = wave(24, 0.05);
        let one = resolved(wave.multipliers(1).unwrap());
        let three: Vec<c64> = resolved(wave.multipliers(3).unwrap())
            .iter()
            .map(c64::conj)
            .collect();
        assert!(one.len() > 10);
        assert_same(&one, &three, 1e-10);
    }

    /// The whole ring is computed without windows and without phases: this tests both.
    #[test]
    fn the_whole_ring_is_the_union_of_its_sectors() {
        for beta in [0.0, 0.01] {
            union_of_sectors(&damped(beta, 16, 0.1));
        }
    }

    fn union_of_sectors(wave: &SemiDiscreteWave) {
        let whole = wave.whole_ring_multipliers().unwrap();
        assert_eq!(whole.len(), 128);
        let union: Vec<c64> = (0..4)
            .flat_map(|sector| wave.multipliers(sector).unwrap())
            .collect();
        assert_eq!(union.len(), 128);
        let (whole, union) = (resolved(whole), resolved(union));
        assert!(whole.len() > 40);
        assert_same(&whole, &union, 1e-10);
    }

    /// A window ten points longer on either side sees nothing more: neither beyond the reach nor, through
    /// the ends of the window, within it. Diffusion numbers βaT/Δφ² of 0, 0.3 and 2.7.
    #[test]
    fn nothing_is_felt_beyond_the_reach() {
        let nearly_incompressible = Model {
            source: Source::Geometry(Geometry {
                nu: 0.45,
                xi: 1.25,
                gamma: 1.0,
            }),
            stiffness_damping: 0.045,
            ..model(0.4)
        };
        let settings = Settings {
            points: 170,
            epsilon: 0.1,
            ..Settings::default()
        };
        for wave in [
            damped(0.0, 24, 0.1),
            damped(0.01, 50, 0.1),
            solve(&nearly_incompressible, 2, &settings).unwrap(),
        ] {
            let reach = wave.band.reach;
            let longer = Band::new(&wave.ring, &wave.steps, wave.values.len(), reach + 10).unwrap();
            let (width, wider) = (2 * reach + 1, 2 * reach + 21);
            for (index, response) in longer.values.iter().enumerate() {
                let (point, offset) = (index / wider, index % wider);
                let inside = offset
                    .checked_sub(10)
                    .filter(|offset| *offset < width)
                    .map(|offset| wave.band.values[point * width + offset]);
                let known = inside.unwrap_or_default();
                for (one, other) in response.iter().flatten().zip(known.iter().flatten()) {
                    // V̇ answers V by 1/T
                    let error = (one - other).abs() * wave.period();
                    assert!(error < 1e-15, "{point} {offset}: {error:e}");
                }
            }
        }
    }

    /// φ → −φ with D → −D is a symmetry of the model: c changes its sign, and the condition
    /// N(λ)e^{−λT_w} = e^{2πij/k} does not change.
    #[test]
    fn mirror_image_has_the_same_sectors() {
        let original = model(0.2);
        let mut coefficients = original.parameters().coefficients;
        coefficients.coupling = -coefficients.coupling;
        let mirrored = Model {
            source: Source::Given(coefficients),
            ..original
        };
        let settings = Settings {
            points: 24,
            epsilon: 0.1,
            ..Settings::default()
        };
        let (one, other) = (
            solve(&original, 4, &settings).unwrap(),
            solve(&mirrored, 4, &settings).unwrap(),
        );
        assert!((one.speed + other.speed).abs() < 1e-9);
        for sector in 0..4 {
            assert_same(
                &resolved(one.multipliers(sector).unwrap()),
                &resolved(other.multipliers(sector).unwrap()),
                1e-8,
            );
        }
    }

    /// Figures of an independent program for the semi-discrete system with 200 points, to the
    /// digits given; and the exact eigenvalues of the sectors 1 and 2, which fix the sign of the
    /// phases (the conjugate is 2.6 away in sector 1): with a quarter of the ε their errors fall at
    /// least to a half.
    #[test]
    fn leading_pairs_at_two_hundred_points() {
        let exact = [
            c64::new(0.1279698868278, 1.319591652955),
            c64::new(0.107573000269, 0.8365151274592),
        ];
        let check = |wave: &SemiDiscreteWave, expected: c64| {
            for value in wave.eigenvalues(0, 12.0, 2).unwrap() {
                assert!((value.re - expected.re).abs() < 5e-5, "{value}");
                assert!((value.im.abs() - expected.im).abs() < 5e-4, "{value}");
            }
            [1, 2].map(|sector| {
                let leading = wave.eigenvalues(sector, 12.0, 2).unwrap();
                nearest(&leading, exact[sector as usize - 1])
            })
        };
        let wave = wave(200, 0.02);
        let before = check(&wave, c64::new(0.0297, 2.564));
        let wave = wave.with_epsilon(0.005).unwrap();
        let after = check(&wave, c64::new(0.0420, 2.552));
        for (after, before) in after.iter().zip(before) {
            assert!(*after < 0.5 * before, "{after:e} {before:e}");
            assert!(*after < 0.01, "{after:e}");
        }
    }

    /// At ε = 1e-5 the error is that of the spacing, of second order: from n and 2n it
    /// extrapolates to the exact eigenvalues, to a tenth at least of what it is at 2n.
    #[test]
    fn extrapolation_in_the_spacing_meets_the_exact_eigenvalues() {
        let exact = [
            c64::new(0.04965063748184, 2.541566892289),
            c64::new(0.1279698868278, 1.319591652955),
        ];
        let [coarse, fine] = [64, 128].map(|points| {
            let wave = wave(points, 1e-5);
            [(0, exact[0]), (1, exact[1])].map(|(sector, exact)| {
                let distance = |value: &c64| (value - exact).norm();
                let values = wave.eigenvalues(sector, 12.0, 20).unwrap();
                values
                    .into_iter()
                    .min_by(|one, other| distance(one).total_cmp(&distance(other)))
                    .unwrap()
            })
        });
        for ((coarse, fine), exact) in coarse.into_iter().zip(fine).zip(exact) {
            let extrapolated = fine + (fine - coarse) / 3.0;
            let error = (extrapolated - exact).norm();
            assert!(
                error < 0.1 * (fine - exact).norm(),
                "{extrapolated}: {error:e}"
            );
        }
    }

    /// With reverse slip nothing changes: the errors fall with n and ε at about first order.
    #[test]
    fn reverse_slip_converges_to_the_exact_eigenvalues() {
        let exact = [
            c64::new(0.028543473561, 2.554582046982),
            c64::new(0.1002644739858, 1.320228603567),
        ];
        let errors = [(50, 0.02), (100, 0.01), (200, 0.005)].map(|(points, epsilon)| {
            let settings = Settings {
                points,
                epsilon,
                ..Settings::default()
            };
            let wave = solve(&model(0.08), 4, &settings).unwrap();
            [(0, exact[0]), (1, exact[1])]
                .map(|(sector, exact)| nearest(&wave.eigenvalues(sector, 12.0, 20).unwrap(), exact))
        });
        for pair in errors.windows(2) {
            for (after, before) in pair[1].iter().zip(pair[0]) {
                assert!(*after < 0.7 * before, "{errors:?}");
            }
        }
        assert!(errors[2].iter().all(|error| *error < 0.012), "{errors:?}");
    }

    #[test]
    fn refusals_carry_their_numbers() {
        let attempt = |mismatch, change: &dyn Fn(&mut Settings)| {
            let mut settings = Settings {
                points: 16,
                epsilon: 0.1,
                ..Settings::default()
            };
            change(&mut settings);
            solve(&model(mismatch), 4, &settings).err()
        };
        assert_eq!(
            attempt(0.2, &|settings| settings.points = 5),
            Some(Error::Points { points: 5 })
        );
        assert_eq!(
            attempt(0.2, &|settings| settings.epsilon = -1.0),
            Some(Error::Epsilon { epsilon: -1.0 })
        );
        assert_eq!(
            attempt(0.2, &|settings| settings.tolerance = 1.0),
            Some(Error::Tolerance { tolerance: 1.0 })
        );
        assert_eq!(
            attempt(0.045, &|_| {}),
            Some(Error::Separation {
                signature: "slip-separation-slip-reverse-stick".into()
            })
        );
        let wave = wave(16, 0.1);
        assert_eq!(
            wave.multipliers(4).err(),
            Some(Error::Sector { sector: 4, mode: 4 })
        );
        assert_eq!(
            wave.with_epsilon(f64::NAN)
                .err()
                .map(|error| error.to_string()),
            Some(
                "ε = NaN is no width of a friction law; take a positive number such as 0.01".into()
            )
        );
    }
}
