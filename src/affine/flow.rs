//! The flow of a mode at fixed parameters, piece by piece: exact states, and every guard as a polynomial whose
//! sign is proven over the whole piece.

use super::mode::AffineMode;
use crate::linalg::{Matrix, Vector};
use crate::orbit::sign::{Bernstein, COEFFICIENTS, REMAINDER};

/// Terms of the series of exp(Mh) for ‖Mh‖ ≤ 1 in the balanced norm: the remainder is 1/19! ≈ 8e-18.
pub(super) const TERMS: u32 = 18;

/// Sweeps that balance a matrix: each at least halves what is left to gain.
const SWEEPS: usize = 20;

/// A guard is zero at the beginning of a zone within this many units of the noise of its polynomial: the
/// state at a switch is known to a few of them.
const ON_GUARD: f64 = 8.0;

/// Longest step of the Newton step that polishes a crossing, in units of a piece: longer, and the crossing is so
/// flat that the guard itself is rounding there.
const POLISHED: f64 = 1e-10;

/// The flow of a mode.
#[derive(Clone, Debug)]
pub struct ModeFlow {
    matrix: Matrix,
    /// Length of a piece.
    pub length: f64,
    /// exp(M·length).
    step: Matrix,
    /// Scales d of z in which M is balanced: the norm of z is Σ|zᵢ|/dᵢ.
    scales: Vector,
    guards: Vec<GuardSeries>,
}

/// Taylor coefficients of a guard over a piece, as linear forms of z at its beginning.
#[derive(Clone, Debug)]
struct GuardSeries {
    coefficients: [Vector; COEFFICIENTS],
    /// max |cᵢ|dᵢ.
    size: f64,
}

/// What a guard does at the beginning of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Onset {
    /// It is positive, but for a zero of this order at the very beginning.
    Positive(usize),
    /// It is negative at once.
    Negative,
    /// It is zero over the whole piece.
    Zero,
}

impl ModeFlow {
    /// The flow of a mode in pieces no longer than `longest`.
    pub fn new(mode: &AffineMode, longest: f64) -> ModeFlow {
        let matrix = mode.matrix.at.clone();
        let (scales, norm) = balance(&matrix);
        let length = if norm * longest > 1.0 {
            norm.recip()
        } else {
            longest
        };
        let guards = mode.guards.iter().map(|guard| {
            let mut term = guard.row.at.clone();
            let size = term.component_mul(&scales).amax();
            let coefficients = std::array::from_fn(|k| {
                if k > 0 {
                    term = matrix.tr_mul(&term) * (length / k as f64);
                }
                term.clone()
            });
            GuardSeries { coefficients, size }
        });
        ModeFlow {
            guards: guards.collect(),
            step: series(&matrix, length),
            length,
            scales,
            matrix,
        }
    }

    /// z after a whole piece.
    pub fn advance(&self, z: &Vector) -> Vector {
        &self.step * z
    }

    /// z after a part of a piece, 0 ≤ `time` ≤ `length`.
    pub fn within(&self, z: &Vector, time: f64) -> Vector {
        let (mut sum, mut term) = (z.clone(), z.clone());
        for k in 1..=TERMS {
            term = &self.matrix * term * (time / f64::from(k));
            sum += &term;
        }
        sum
    }

    /// z at a time ≥ 0 after the beginning.
    pub(super) fn after(&self, z: &Vector, time: f64) -> Vector {
        let (mut z, mut rest) = (z.clone(), time);
        while rest > self.length {
            z = self.advance(&z);
            rest -= self.length;
        }
        self.within(&z, rest)
    }

    /// Every state over the beginning of a piece, as polynomials in time/`length`/`part`, and what they leave out.
    pub(super) fn states(&self, z: &Vector, part: f64, states: usize) -> Vec<Bernstein> {
        let mut taylor = vec![[0.0; COEFFICIENTS]; states];
        let mut term = z.clone();
        for k in 0..COEFFICIENTS {
            if k > 0 {
                term = &self.matrix * term * (part * self.length / k as f64);
            }
            for (state, taylor) in taylor.iter_mut().enumerate() {
                taylor[k] = term[state];
            }
        }
        let amplitude: f64 = z.iter().zip(&self.scales).map(|(z, d)| z.abs() / d).sum();
        let error = 1.06 * REMAINDER * part.powi(COEFFICIENTS as i32) * amplitude;
        let polynomials = taylor.iter().zip(&self.scales);
        polynomials
            .map(|(taylor, d)| Bernstein::from_taylor(taylor, error * d))
            .collect()
    }

    /// A guard over the beginning of a piece, as a polynomial in time/`length`/`part`.
    pub(super) fn taylor(&self, guard: usize, z: &Vector, part: f64) -> ([f64; COEFFICIENTS], f64) {
        let GuardSeries { coefficients, size } = &self.guards[guard];
        let mut power = 1.0;
        let taylor = std::array::from_fn(|k| {
            let coefficient = coefficients[k].dot(z) * power;
            power *= part;
            coefficient
        });
        let amplitude: f64 = z.iter().zip(&self.scales).map(|(z, d)| z.abs() / d).sum();
        // Σ_{k>16} 1/k! < 1.06/17!, and rounding of the products that each coefficient is made of
        let error = 1.06 * REMAINDER * power + 2.0 * f64::EPSILON;
        (taylor, error * size * amplitude)
    }

    /// What a guard does just after a zone begins at z.
    pub(super) fn onset(&self, guard: usize, z: &Vector) -> Onset {
        let (taylor, remainder) = self.taylor(guard, z, 1.0);
        let noise = ON_GUARD
            * (remainder
                + f64::EPSILON * taylor.iter().fold(0.0, |size: f64, a| size.max(a.abs())));
        match taylor.iter().position(|a| a.abs() > noise) {
            None => Onset::Zero,
            Some(order) if taylor[order] > 0.0 => Onset::Positive(order),
            Some(_) => Onset::Negative,
        }
    }

    /// Time at which a guard first becomes negative within `part` of the piece that begins at z, where it has a
    /// zero of this order: divided out, so that the shortest zone is told from none.
    pub(super) fn crossing(
        &self,
        guard: usize,
        z: &Vector,
        order: usize,
        part: f64,
    ) -> Option<f64> {
        let (mut taylor, remainder) = self.taylor(guard, z, part);
        taylor[..order].fill(0.0);
        taylor.rotate_left(order);
        // most guards are far from zero most of the time
        let others: f64 = taylor[1..].iter().map(|a| a.abs()).sum();
        if taylor[0] > others + remainder {
            return None;
        }
        let place = Bernstein::from_taylor(&taylor, remainder).first_crossing()?;
        let time = place * part * self.length;
        if order > 0 {
            return Some(time);
        }
        // one step of Newton's method on the guard itself takes away the rounding of the polynomial
        let [value, slope] = {
            let z = self.within(z, time);
            let coefficients = &self.guards[guard].coefficients;
            [
                coefficients[0].dot(&z),
                coefficients[1].dot(&z) / self.length,
            ]
        };
        let better = time - value / slope;
        let close = (better - time).abs() <= POLISHED * self.length;
        Some(if close { better.max(0.0) } else { time })
    }
}

/// exp(Mt) by its series, for ‖Mt‖ ≤ 1 in the balanced norm.
fn series(matrix: &Matrix, time: f64) -> Matrix {
    let size = matrix.nrows();
    let (mut sum, mut term) = (Matrix::identity(size, size), Matrix::identity(size, size));
    for k in 1..=TERMS {
        term = matrix * term * (time / f64::from(k));
        sum += &term;
    }
    sum
}

/// Powers of two d for which the largest column sum of D⁻¹MD is small, and that sum.
///
/// Osborne's method: rows and columns of one index get the same size. Units as different as volts and seconds
/// would otherwise make pieces a hundred times too short.
pub(super) fn balance(matrix: &Matrix) -> (Vector, f64) {
    let size = matrix.nrows();
    let mut scales = Vector::repeat(size, 1.0);
    let entry =
        |scales: &Vector, i: usize, j: usize| (matrix[(i, j)] * scales[j] / scales[i]).abs();
    for _ in 0..SWEEPS {
        let mut changed = false;
        for i in 0..size {
            let others = || (0..size).filter(|j| *j != i);
            let row: f64 = others().map(|j| entry(&scales, i, j)).sum();
            let column: f64 = others().map(|j| entry(&scales, j, i)).sum();
            if row > 0.0 && column > 0.0 {
                // the power of two nearest to √(row/column)
                let exponent = (0.5 * (row / column).log2()).round();
                if exponent != 0.0 && exponent.abs() < 100.0 {
                    scales[i] *= exponent.exp2();
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
    let sums = (0..size).map(|j| (0..size).map(|i| entry(&scales, i, j)).sum());
    (scales.clone(), sums.fold(0.0, f64::max))
}
