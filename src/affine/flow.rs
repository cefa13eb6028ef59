//! The flow of a mode at fixed parameters, piece by piece: exact states, and every guard as a polynomial whose
//! sign is proven over the whole piece.

use super::mode::AffineMode;
use crate::linalg::{Matrix, Vector, add_product};
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

/// A guard over a piece.
#[derive(Clone, Debug)]
struct GuardSeries {
    /// Its Taylor coefficients in time/`length` as linear forms of z at the beginning, one in each column.
    coefficients: Matrix,
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
        let [step, _] = propagator(&matrix, &Matrix::zeros(0, 0), norm, length);
        let mut flow = ModeFlow {
            guards: Vec::new(),
            step,
            length,
            scales,
            matrix,
        };
        for guard in &mode.guards {
            flow.watch(guard.row.at.clone());
        }
        flow
    }

    /// One more linear form of z whose sign is looked at, after those that are there.
    pub(super) fn watch(&mut self, form: Vector) {
        let size = form.component_mul(&self.scales).amax();
        let mut coefficients = Matrix::zeros(form.len(), COEFFICIENTS);
        coefficients.set_column(0, &form);
        for k in 1..COEFFICIENTS {
            let (known, next) = coefficients.as_mut_slice().split_at_mut(k * form.len());
            let (last, next) = (&known[(k - 1) * form.len()..], &mut next[..form.len()]);
            let part = self.length / k as f64;
            add_product(part, last, 1, self.matrix.as_slice(), next);
        }
        self.guards.push(GuardSeries { coefficients, size });
    }

    /// z after a whole piece.
    pub fn advance(&self, z: &Vector) -> Vector {
        &self.step * z
    }

    /// z after a part of a piece, 0 ≤ `time` ≤ `length`.
    pub fn within(&self, z: &Vector, time: f64) -> Vector {
        let (mut sum, mut term, mut next) = (z.clone(), z.clone(), z.clone());
        for k in 1..=TERMS {
            self.rate(time / f64::from(k), &term, &mut next);
            std::mem::swap(&mut term, &mut next);
            sum += &term;
        }
        sum
    }

    /// Mz times a factor.
    fn rate(&self, factor: f64, z: &Vector, rate: &mut Vector) {
        rate.fill(0.0);
        let (matrix, rows) = (self.matrix.as_slice(), z.len());
        add_product(factor, matrix, rows, z.as_slice(), rate.as_mut_slice());
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
        let (mut term, mut next) = (z.clone(), z.clone());
        for k in 0..COEFFICIENTS {
            if k > 0 {
                self.rate(part * self.length / k as f64, &term, &mut next);
                std::mem::swap(&mut term, &mut next);
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
            let coefficient = coefficients.column(k).dot(z) * power;
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
                coefficients.column(0).dot(&z),
                coefficients.column(1).dot(&z) / self.length,
            ]
        };
        let better = time - value / slope;
        let close = (better - time).abs() <= POLISHED * self.length;
        Some(if close { better.max(0.0) } else { time })
    }
}

/// Matrices larger than this are squared in blocks.
const SMALL: usize = 8;

/// E = exp(Mt) for the norm of M, and ∂E/∂p where `by` has an entry: by the series of the balanced matrix over a part
/// of the time, and squares of it. With (E + εE′)² = E² + ε(EE′ + E′E) the derivative is as exact as the value.
pub(super) fn propagator(matrix: &Matrix, by: &Matrix, norm: f64, time: f64) -> [Matrix; 2] {
    let size = matrix.nrows();
    let doublings = (norm * time.abs()).log2().ceil().max(0.0);
    // what is not finite gives a propagator that is not
    let step = time * (-doublings).exp2();
    let doublings = if doublings.is_finite() {
        doublings as u32
    } else {
        0
    };
    let add = |factor: f64, left: &Matrix, right: &Matrix, sum: &mut Matrix| {
        let (left, right) = (left.as_slice(), right.as_slice());
        add_product(factor, left, size, right, sum.as_mut_slice());
    };
    let zero = Matrix::zeros(size, size);
    let mut term = Matrix::identity(size, size);
    let [mut sum, mut next, mut term_by, mut sum_by] =
        [term.clone(), zero.clone(), zero.clone(), zero];
    let parametric = by.iter().any(|by| *by != 0.0);
    for k in 1..=TERMS {
        let factor = step / f64::from(k);
        if parametric {
            next.fill(0.0);
            add(factor, &term_by, matrix, &mut next);
            add(factor, &term, by, &mut next);
            std::mem::swap(&mut term_by, &mut next);
            sum_by += &term_by;
        }
        next.fill(0.0);
        add(factor, &term, matrix, &mut next);
        std::mem::swap(&mut term, &mut next);
        sum += &term;
    }
    let add = |left: &Matrix, right: &Matrix, sum: &mut Matrix| {
        if size > SMALL {
            sum.gemm(1.0, left, right, 1.0);
        } else {
            add(1.0, left, right, sum);
        }
    };
    for _ in 0..doublings {
        if parametric {
            next.fill(0.0);
            add(&sum, &sum_by, &mut next);
            add(&sum_by, &sum, &mut next);
            std::mem::swap(&mut sum_by, &mut next);
        }
        next.fill(0.0);
        add(&sum, &sum, &mut next);
        std::mem::swap(&mut sum, &mut next);
    }
    [sum, sum_by]
}

/// Powers of two d for which the largest column sum of D⁻¹MD is small, and that sum.
///
/// Osborne's method: rows and columns of one index get the same size. Units as different as volts and seconds
/// would otherwise make pieces a hundred times too short.
pub(super) fn balance(matrix: &Matrix) -> (Vector, f64) {
    let size = matrix.nrows();
    let mut scales = Vector::repeat(size, 1.0);
    let diagonal = matrix.diagonal().abs();
    let mut scaled = matrix.abs();
    scaled.fill_diagonal(0.0);
    for _ in 0..SWEEPS {
        let mut changed = false;
        for i in 0..size {
            let (row, column) = (scaled.row(i).sum(), scaled.column(i).sum());
            if row > 0.0 && column > 0.0 {
                // the power of two nearest to √(row/column)
                let exponent = (0.5 * (row / column).log2()).round();
                if exponent != 0.0 && exponent.abs() < 100.0 {
                    let factor = exponent.exp2();
                    scales[i] *= factor;
                    scaled.row_mut(i).scale_mut(factor.recip());
                    scaled.column_mut(i).scale_mut(factor);
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
    let sums = scaled.column_iter().zip(&diagonal);
    let sums = sums.map(|(column, own)| column.sum() + own);
    (scales, sums.fold(0.0, f64::max))
}
