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

mod band;
mod chain;
mod ring;
#[cfg(test)]
mod tests;
mod wave;

pub use ring::RingFailure;
pub use wave::{FIRST_EPSILON, SemiDiscreteWave, solve, solve_from};

use crate::branch::wanted::NoFirstWave;
use crate::tube::flow::FlowError;
use crate::tube::wave::start::Which;

/// What to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingSettings {
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

impl Default for RingSettings {
    fn default() -> RingSettings {
        RingSettings {
            points: 200,
            epsilon: 0.005,
            which: Which::Fast,
            tolerance: 1e-10,
        }
    }
}

/// Fewer points do not resolve a wave.
pub(crate) const LEAST_POINTS: usize = 8;

/// With more points the dense matrices take more than [`memory`] of this many, 3 GB, and hours.
pub(crate) const MOST_POINTS: usize = 4000;

/// Bytes that the eigenvalues of a cell of n points take: three complex matrices of 2n rows.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) fn memory(points: f64) -> f64 {
    3.0 * 16.0 * (2.0 * points).powi(2)
}

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
    Start(#[from] NoFirstWave),
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
        failure: RingFailure,
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

impl RingSettings {
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
