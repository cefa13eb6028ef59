//! Functions that change their sign along a curve of special equilibria where it meets another one.
//!
//! They are functions of the matrix A of the motion, within the surfaces of its mode. Eigenvalues that the curve itself
//! keeps at zero, or at the sum zero, are left out.

use super::curve::{AT_KINK, EquilibriumCurve};
use super::field::Linear;
use super::normal_form::normal_form;
use super::spectrum::{SMALL, eigenvalues};
use crate::linalg::{Eigenvalue, Matrix, Vector, balance, least};
use nalgebra::Complex;

/// Eigenvalues that a curve of special equilibria keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeptEigenvalues {
    /// None.
    None,
    /// One at zero.
    Zero,
    /// A pair ± iω.
    Pair(f64),
}

/// Sums of pairs of the other eigenvalues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairSums {
    /// A product that changes its sign where one of them is zero.
    pub value: f64,
    /// Whether the pair whose sum is nearest to zero is complex.
    pub is_complex: bool,
}

/// Indices of the eigenvalues that are kept.
fn kept(values: &[Eigenvalue], kept: KeptEigenvalues) -> Vec<usize> {
    let nearest = |target: Complex<f64>| {
        let distance = |one: &Eigenvalue| (one.value - target).norm();
        let all = values.iter().enumerate();
        all.min_by(|(_, one), (_, other)| distance(one).total_cmp(&distance(other)))
            .map(|(index, _)| index)
    };
    let targets = match kept {
        KeptEigenvalues::None => Vec::new(),
        KeptEigenvalues::Zero => vec![Complex::from(0.0)],
        KeptEigenvalues::Pair(omega) => vec![Complex::new(0.0, omega), Complex::new(0.0, -omega)],
    };
    targets.into_iter().filter_map(nearest).collect()
}

/// The product Π s/max(|s|, [`SMALL`]) of the relative sums s of all pairs but that of the kept ones, of a kept zero of none with
/// it.
fn sums(values: &[Eigenvalue], own: KeptEigenvalues) -> PairSums {
    let kept = kept(values, own);
    let counts = |one: usize, other: usize| match own {
        KeptEigenvalues::Zero => !kept.contains(&one) && !kept.contains(&other),
        _ => !(kept.contains(&one) && kept.contains(&other)),
    };
    let mut product = Complex::from(1.0);
    let mut least = (f64::INFINITY, false);
    for (index, one) in values.iter().enumerate() {
        for (beyond, other) in values.iter().enumerate().skip(index + 1) {
            if !counts(index, beyond) {
                continue;
            }
            let size = one.value.norm() + other.value.norm();
            let sum = (one.value + other.value) / size;
            product *= sum / sum.norm().max(SMALL);
            if sum.norm() < least.0 {
                let paired = one.value.im != 0.0 && one.value.im == -other.value.im;
                least = (sum.norm(), paired);
            }
        }
    }
    PairSums {
        value: product.re,
        is_complex: least.1,
    }
}

/// A multiple of the trace of the adjugate of a singular matrix, which is the product of all eigenvalues but the one that is
/// zero. By its null vectors v and w it is ± w·v, with the sign of the bordered determinant of (A, w; vᵀ, 0): at a double
/// eigenvalue zero it is known to rounding, where eigenvalues are not.
fn adjugate_trace(matrix: &Matrix) -> Option<f64> {
    let (units, _) = balance(matrix, 0.0);
    let n = units.len();
    let entry = |i: usize, j: usize| matrix[(i, j)] * units[j] / units[i];
    let matrix = Matrix::from_fn(n, n, entry);
    let found = least(&matrix)?;
    let size = if found.largest > 0.0 {
        found.largest
    } else {
        1.0
    };
    let mut bordered = (matrix / size).resize(n + 1, n + 1, 0.0);
    for index in 0..n {
        bordered[(index, n)] = found.left[index];
        bordered[(n, index)] = found.right[index];
    }
    Some(-found.left.dot(&found.right) * bordered.determinant().signum())
}

impl EquilibriumCurve {
    /// What vanishes along a curve of folds where zero is a double eigenvalue.
    pub fn double_zero(&self, point: &Vector) -> Option<f64> {
        let at = self.linearised(point).ok()?;
        adjugate_trace(&at.within())
    }

    /// The determinant of the equations in the states, which vanishes where an eigenvalue does.
    pub fn determinant(&self, point: &Vector) -> Option<f64> {
        let at = self.linearised(point).ok()?;
        let rows = self.followed(&at, &self.place(point));
        let n = rows.len();
        Some(Matrix::from_fn(n, n, |row, column| rows[row].by[column]).determinant())
    }

    /// The equilibria on one side of a kink of the rates, where one is at it at which the branch turns or eigenvalues that grow are more
    /// than on the other side. `None` where it is at none, or where several are.
    pub fn at_kink(&self, point: &Vector) -> Option<EquilibriumCurve> {
        /// A determinant that is smaller than this part of that on the other side is zero: a smooth fold of one side.
        const NOTHING: f64 = 1e-9;
        let place = self.place(point);
        let field = self.local(&place);
        let signs = field.on_side(1.0);
        let (_, at) = field.or_on_side(&signs)?;
        let sides = |(kink, (step, operand)): (usize, &(usize, Linear))| {
            if self.scaled_operand(operand).value.abs() > AT_KINK {
                return None;
            }
            // of the other kinks none ends the curve
            let mut side = self.clone();
            side.signature.signs = vec![0.0; signs.len()];
            side.signature.signs[*step] = 1.0;
            let beyond = side.beyond_kink(kink)?;
            let [one, other] = [&side, &beyond].map(|side| side.determinant(point));
            let (one, other) = one.zip(other)?;
            let growing = [&side, &beyond].map(|side| side.growing(point));
            let jumps = matches!(growing, [Some(few), Some(many)] if few != many);
            let is_told = one.abs().min(other.abs()) > NOTHING * one.abs().max(other.abs());
            (is_told && (one * other < 0.0 || jumps)).then_some(side)
        };
        at.kinks.iter().enumerate().find_map(sides)
    }

    /// The slowest growth and the slowest decay at a saddle.
    pub fn saddle_rates(&self, point: &Vector) -> Option<[f64; 2]> {
        let values = eigenvalues(&self.linearised(point).ok()?);
        let slowest = |sign: f64| {
            let own = values.iter().map(|one| sign * one.value.re);
            own.filter(|re| *re > 0.0).reduce(f64::min)
        };
        Some([slowest(1.0)?, slowest(-1.0)?])
    }

    /// What vanishes where another pair of eigenvalues has the sum zero.
    pub fn pair_sums(&self, point: &Vector, kept: KeptEigenvalues) -> Option<PairSums> {
        Some(sums(&eigenvalues(&self.linearised(point).ok()?), kept))
    }

    /// The first Lyapunov coefficient of a pair ± iω; `None` where it has no value.
    pub fn lyapunov(&self, point: &Vector, omega: f64) -> Option<f64> {
        let at = self.linearised(point).ok()?;
        let place = self.place(point);
        Some(
            normal_form(self.local(&place), &at, omega)?
                .lyapunov
                .value(),
        )
    }

    /// What vanishes along a curve of Hopf points where the first Lyapunov coefficient does: that times Π λ/(|λ| + ω) over all
    /// other eigenvalues, since it has a pole where one of them is zero.
    pub fn degenerate_hopf(&self, point: &Vector, omega: f64) -> Option<f64> {
        let coefficient = self.lyapunov(point, omega)?;
        let values = eigenvalues(&self.linearised(point).ok()?);
        let own = kept(&values, KeptEigenvalues::Pair(omega));
        let others = values
            .iter()
            .enumerate()
            .filter(|(index, _)| !own.contains(index));
        let factors = others.map(|(_, one)| one.value / (one.value.norm() + omega));
        Some(coefficient * factors.product::<Complex<f64>>().re)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a triangular matrix with the diagonal (0, a, 3) it has the sign of 3a, whatever stands above.
    #[test]
    fn the_trace_of_the_adjugate_passes_zero_with_the_second_eigenvalue() {
        let at = |a: f64| {
            let entries = [0.0, 1.0, -2.0, 0.0, a, 0.5, 0.0, 0.0, 3.0];
            adjugate_trace(&Matrix::from_row_slice(3, 3, &entries)).unwrap()
        };
        for a in [1e-12, 1e-3, 0.7] {
            assert!(at(a) * at(-a) < 0.0);
            assert!(at(a) * at(1.0) > 0.0);
        }
        assert!(at(0.0).abs() <= 4.0 * f64::EPSILON);
    }
}
