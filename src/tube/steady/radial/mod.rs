//! Steady sliding of the elastic tube itself: the radial problem of one mode.
//!
//! # Equations
//! Plane strain with E = 1, displacement (u, v)e^{ikφ+λt}, and div σ = −γκ(u, v), where κ takes the
//! place of −λ² (see [`growth`](super::growth) for damping). With v = iw all coefficients are real.
//! In x = ln r, 0 < x < ln ξ and ′ = d/dx, strains times r are
//!
//! ```text
//! rε_rr = u′,      rε_φφ = u − kw,      2rε_rφ = i(w′ − w + ku).
//! ```
//!
//! Boundary conditions: u = w = 0 at r = ξ; u = 0 at r = 1, and friction there. The shaft pushes
//! with p = −σ_rr and, as the tube is slower than it, drags with q = −σ_rφ = fp, hence
//! σ_rφ = fσ_rr; with σ_rφ = iτ this is τ = −ifσ_rr.
//!
//! # Weak form
//! For test functions (U, W) that vanish at r = ξ,
//!
//! ```text
//! A(U, W; u, w) = ∫ { C[u′U′ + (u−kw)(U−kW)] + λ[u′(U−kW) + (u−kw)U′]
//!                     + μ(w′−w+ku)(W′−W+kU) } dx,        B = ∫(uU + wW)e^{2x} dx,
//! A − γκB = −[σ_rr U + τW] at r = 1.
//! ```
//!
//! The right side vanishes for all tests with U(1) = ifW(1): friction is a condition on the test
//! functions, u(1) = 0 one on the trial functions. Both forms are symmetric, so that without
//! friction κ is real and positive; friction changes one row.
//!
//! Where friction depends on the velocity ([`growth`](super::growth)), τ = −ifσ_rr + γI₀f𝒹λw/(1 + βλ)
//! with ∫X²r dr = I₀: the shaft resists the motion of the surface as well, and the elastic stress is
//! the 1/(1 + βλ)-th part of the whole. That adds γI₀f𝒹λ/(1 + βλ) w(1)W(1) to the left side: the
//! eigenvalue problem is quadratic in λ, and is solved by following each family from 𝒹 = 0.
//!
//! # Radial functions
//! The first one is the field of the reduced model, X = sinh(ln ξ − x)/sinh(ln ξ), for W and w and,
//! as a test function only, for U. The others are integrals of Legendre polynomials in x, which
//! vanish at both ends. Order 1 is the reduced model, exactly. κ converges geometrically in the
//! order, twice as fast as the displacement, as in any Galerkin method.
//!
//! Both matrices are divided by ∫X²r dr, and γ is left out of B: it only sets the unit of time, √γ,
//! so that what is solved for is γκ.

mod follow;

use std::num::NonZeroUsize;

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use gauss_quad::GaussLegendre;

use crate::tube::model::coefficients::{Geometry, lame};

/// Points of the quadrature beyond those that integrate products of the polynomials: e^{2x} and
/// the hyperbolic functions of X are entire, and 32 more points leave less than rounding for
/// ln ξ < 8.
const MORE_POINTS: usize = 32;
/// Relative change of κ at which its refinement ends: rounding, for convergence is cubic.
const REFINED: f64 = 1e-14;
/// Most steps of the refinement; two suffice unless two families almost coincide.
const MOST_REFINEMENTS: usize = 12;
/// Relative change of κ beyond which its refinement is not believed: it has gone to another
/// eigenvalue. The dense solver's error is far below.
const CREDIBLE: f64 = 1e-4;
/// Relative distance by which κ is moved off an eigenvalue that rounds the matrix to a singular
/// one.
const NUDGE: f64 = 1e-13;

/// The eigenvalues of the radial problem could not be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RadialError {
    /// The eigenvalue solver does not converge.
    #[error(
        "mode {mode}: the eigenvalues of a radial problem of {size} rows do not converge; \
         take another --order"
    )]
    Eigenvalues {
        /// Mode k.
        mode: u32,
        /// Rows of the matrices.
        size: usize,
    },
    /// A wave is lost on the way from friction that does not depend on the velocity.
    #[error(
        "mode {mode}: no wave of the tube was found under a friction law whose slope at steady \
         sliding damps by {drag:e}; take a smaller mismatch or a law that changes less"
    )]
    Slope {
        /// Mode k.
        mode: u32,
        /// f𝒹.
        drag: f64,
    },
    /// Fewer families than asked for.
    #[error("mode {mode}: a radial problem of {size} rows has no {families} families")]
    Families {
        /// Mode k.
        mode: u32,
        /// Rows of the matrices.
        size: usize,
        /// Families asked for.
        families: usize,
    },
}

/// The discretised radial problem of one mode.
#[derive(Clone, Debug)]
pub struct Radial {
    mode: u32,
    order: usize,
    gamma: f64,
    /// A over all functions: those of u, then those of w. The first of u is a test function only.
    stiffness: Mat<f64>,
    /// B over the same functions.
    mass: Mat<f64>,
}

/// An eigenvalue κ with the coefficients of its displacement and of the adjoint one.
#[derive(Clone, Debug)]
pub struct RadialPair {
    /// κ.
    pub kappa: c64,
    right: Mat<c64>,
    left: Mat<c64>,
}

impl Radial {
    /// Mode k of a tube with `order` ≥ 1 radial functions per component.
    pub fn new(geometry: &Geometry, mode: u32, order: usize) -> Radial {
        let order = order.max(1);
        let [c, lambda, mu] = lame(geometry.nu);
        let k = f64::from(mode);
        let length = (geometry.xi - 1.0).ln_1p();
        // grows with the exponentials that X and e^{2x} contain
        let points = order + MORE_POINTS + (4.0 * length).ceil().clamp(0.0, 400.0) as usize;
        let rule = GaussLegendre::new(NonZeroUsize::new(points).unwrap_or(NonZeroUsize::MIN));
        let size = 2 * order;
        let mut stiffness = Mat::<f64>::zeros(size, size);
        let mut mass = Mat::<f64>::zeros(size, size);
        let (mut values, mut slopes) = (vec![0.0; order], vec![0.0; order]);
        for (node, weight) in rule.iter() {
            let x = 0.5 * (node + 1.0) * length;
            let weight = 0.5 * weight * length;
            radial_functions(*node, length, &mut values, &mut slopes);
            let inertia = weight * (2.0 * x).exp();
            for i in 0..order {
                let (test, test_slope) = (values[i], slopes[i]);
                for j in 0..order {
                    let (trial, trial_slope) = (values[j], slopes[j]);
                    let both = test * trial;
                    let (to_test, to_trial) = (test * trial_slope, test_slope * trial);
                    let bent = test_slope * trial_slope;
                    stiffness[(i, j)] += weight
                        * (c * (bent + both) + lambda * (to_test + to_trial) + mu * k * k * both);
                    let mixed =
                        weight * k * (-lambda * to_trial - c * both + mu * (to_test - both));
                    stiffness[(i, order + j)] += mixed;
                    stiffness[(order + j, i)] += mixed;
                    stiffness[(order + i, order + j)] +=
                        weight * (c * k * k * both + mu * (bent - to_test - to_trial + both));
                    mass[(i, j)] += inertia * both;
                    mass[(order + i, order + j)] += inertia * both;
                }
            }
        }
        let scale = mass[(0, 0)];
        for j in 0..size {
            for i in 0..size {
                stiffness[(i, j)] /= scale;
                mass[(i, j)] /= scale;
            }
        }
        Radial {
            mode,
            order,
            gamma: geometry.gamma,
            stiffness,
            mass,
        }
    }

    /// Rows and columns of the eigenvalue problem.
    fn size(&self) -> usize {
        2 * self.order - 1
    }

    /// An entry of the row of X in W, with the share of the row of X in U that friction adds.
    fn entry(&self, matrix: &Mat<f64>, friction: f64, row: usize, column: usize) -> c64 {
        let value = matrix[(row + 1, column + 1)];
        if row + 1 == self.order {
            c64::new(value, friction * matrix[(0, column + 1)])
        } else {
            c64::new(value, 0.0)
        }
    }

    /// A(f) or B(f) on trial functions with u(1) = 0 and test functions with U(1) = ifW(1).
    fn with_friction(&self, matrix: &Mat<f64>, friction: f64) -> Mat<c64> {
        Mat::from_fn(self.size(), self.size(), |row, column| {
            self.entry(matrix, friction, row, column)
        })
    }

    /// The derivative of yᵀ(A − κB)x with respect to friction: i times the perturbation of the
    /// contact pressure by x, weighted with the adjoint slip.
    fn by_friction(&self, pair: &RadialPair, kappa: c64) -> c64 {
        let pressure: c64 = (0..self.size())
            .map(|column| {
                let entry = self.stiffness[(0, column + 1)] - kappa * self.mass[(0, column + 1)];
                entry * pair.right[(column, 0)]
            })
            .sum();
        c64::new(0.0, 1.0) * pair.left[(self.order - 1, 0)] * pressure
    }

    /// All γκ by increasing modulus.
    fn scaled_eigenvalues(&self, friction: f64) -> Result<Vec<c64>, RadialError> {
        let failed = RadialError::Eigenvalues {
            mode: self.mode,
            size: self.size(),
        };
        let mut stiffness = self.with_friction(&self.stiffness, friction);
        let mut mass = self.with_friction(&self.mass, friction);
        // a row that friction makes huge would swamp the others; a power of two changes no digit
        if friction.is_finite() && friction > 1.0 {
            let scale = friction.log2().floor().exp2().recip();
            for column in 0..self.size() {
                stiffness[(self.order - 1, column)] *= scale;
                mass[(self.order - 1, column)] *= scale;
            }
        }
        if self.size() == 1 {
            // the reduced model needs no iteration, and the library's does not take a single row
            return Ok(vec![stiffness[(0, 0)] / mass[(0, 0)]]);
        }
        // The stiffness matrix is the well-conditioned one: 1/κ of the lowest families is largest.
        let pencil = mass.generalized_eigen(&stiffness).map_err(|_| failed)?;
        let mut found: Vec<c64> = (0..self.size())
            .map(|index| pencil.S_b()[index] / pencil.S_a()[index])
            .filter(|kappa| kappa.re.is_finite() && kappa.im.is_finite())
            .collect();
        found.sort_by(|one, other| one.norm().total_cmp(&other.norm()));
        Ok(found)
    }

    /// The families of least |κ|, refined to rounding; at most as many as there are.
    ///
    /// # Errors
    /// When the QZ iteration does not converge, or yields not a single eigenvalue.
    pub fn lowest(&self, friction: f64, families: usize) -> Result<Vec<RadialPair>, RadialError> {
        let mut pairs = self.scaled_lowest(friction, families)?;
        for pair in &mut pairs {
            pair.kappa /= self.gamma;
        }
        Ok(pairs)
    }

    /// The same with γκ in place of κ.
    fn scaled_lowest(
        &self,
        friction: f64,
        families: usize,
    ) -> Result<Vec<RadialPair>, RadialError> {
        let mut found = self.scaled_eigenvalues(friction)?;
        if found.is_empty() {
            return Err(RadialError::Families {
                mode: self.mode,
                size: self.size(),
                families,
            });
        }
        found.truncate(families.max(1));
        Ok(found
            .into_iter()
            .map(|kappa| self.refine(friction, kappa))
            .collect())
    }

    /// γκ by two-sided inverse iteration: x ← (A − κB)⁻¹Bx, y ← (A − κB)⁻ᵀBᵀy, κ = yᵀAx/yᵀBx.
    fn refine(&self, friction: f64, guess: c64) -> RadialPair {
        let stiffness = self.with_friction(&self.stiffness, friction);
        let mass = self.with_friction(&self.mass, friction);
        let start = Mat::from_fn(self.size(), 1, |row, _| {
            c64::new(1.0 / (row + 1) as f64, 0.0)
        });
        let mut pair = RadialPair {
            kappa: guess,
            right: start.clone(),
            left: start,
        };
        for _ in 0..MOST_REFINEMENTS {
            let Some(next) = iterate(&stiffness, &mass, &pair, pair.kappa) else {
                break;
            };
            let kappa = quotient(&stiffness, &mass, &next);
            let change = (kappa - pair.kappa).norm() / guess.norm();
            let credible = (kappa - guess).norm() <= CREDIBLE * guess.norm();
            pair = RadialPair {
                kappa: if credible { kappa } else { pair.kappa },
                ..next
            };
            if change <= REFINED {
                break;
            }
        }
        pair
    }

    /// Distance of the displacement from the field (0, X) of the reduced model, relative to its
    /// norm ∫(|u|² + |v|²)r dr: the sine of the angle between them.
    pub fn field_error(&self, pair: &RadialPair) -> f64 {
        let size = self.size();
        let tangential = self.order - 1;
        let mass = |row: usize, column: usize| self.mass[(row + 1, column + 1)];
        let share: c64 = (0..size)
            .map(|column| mass(tangential, column) * pair.right[(column, 0)])
            .sum::<c64>()
            / mass(tangential, tangential);
        let norm = |removed: c64| {
            let field: Vec<c64> = (0..size)
                .map(|row| {
                    let part = if row == tangential {
                        removed
                    } else {
                        c64::new(0.0, 0.0)
                    };
                    pair.right[(row, 0)] - part
                })
                .collect();
            let mut square = 0.0;
            for row in 0..size {
                for column in 0..size {
                    square += mass(row, column) * (field[row].conj() * field[column]).re;
                }
            }
            square.max(0.0).sqrt()
        };
        norm(share) / norm(c64::new(0.0, 0.0))
    }
}

/// Values and slopes in x of X and of the normalised integrals of Legendre polynomials at
/// s = 2x/ln ξ − 1: φ_j = (P_j − P_{j−2})/√(2(2j−1)), j ≥ 2.
fn radial_functions(s: f64, length: f64, values: &mut [f64], slopes: &mut [f64]) {
    let rest = 0.5 * (1.0 - s) * length;
    // sinh(rest)/sinh(length) and −cosh(rest)/sinh(length) without overflow
    let decay = (rest - length).exp();
    let full = -(-2.0 * length).exp_m1();
    values[0] = decay * -(-2.0 * rest).exp_m1() / full;
    slopes[0] = -decay * (1.0 + (-2.0 * rest).exp()) / full;
    let (mut before, mut legendre) = (1.0, s);
    for j in 2..=values.len() {
        let n = j as f64;
        let next = ((2.0 * n - 1.0) * s * legendre - (n - 1.0) * before) / n;
        let unit = (2.0 * (2.0 * n - 1.0)).sqrt();
        values[j - 1] = (next - before) / unit;
        slopes[j - 1] = unit * legendre / length;
        (before, legendre) = (legendre, next);
    }
}

/// One step of two-sided inverse iteration; `None` where the matrix cannot be solved with.
fn iterate(
    stiffness: &Mat<c64>,
    mass: &Mat<c64>,
    pair: &RadialPair,
    kappa: c64,
) -> Option<RadialPair> {
    let size = stiffness.nrows();
    for shift in [kappa, kappa * (1.0 + NUDGE), kappa * (1.0 + 16.0 * NUDGE)] {
        let matrix = Mat::from_fn(size, size, |row, column| {
            stiffness[(row, column)] - shift * mass[(row, column)]
        });
        let factors = matrix.partial_piv_lu();
        let right = factors.solve(mass * &pair.right);
        let left = factors.solve_transpose(mass.transpose() * &pair.left);
        if let (Some(right), Some(left)) = (unit(right), unit(left)) {
            return Some(RadialPair { kappa, right, left });
        }
    }
    None
}

/// The vector divided by its length; `None` where that is zero or not finite.
fn unit(mut vector: Mat<c64>) -> Option<Mat<c64>> {
    let norm = vector.norm_l2();
    if !(norm.is_finite() && norm > 0.0) {
        return None;
    }
    for row in 0..vector.nrows() {
        vector[(row, 0)] /= norm;
    }
    Some(vector)
}

/// yᵀMx.
fn bilinear(matrix: &Mat<c64>, pair: &RadialPair) -> c64 {
    (pair.left.transpose() * matrix * &pair.right)[(0, 0)]
}

/// yᵀAx/yᵀBx.
fn quotient(stiffness: &Mat<c64>, mass: &Mat<c64>, pair: &RadialPair) -> c64 {
    bilinear(stiffness, pair) / bilinear(mass, pair)
}
