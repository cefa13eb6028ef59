//! Eigenvalues of real matrices, whatever the units of their coordinates.
//!
//! A matrix falls into blocks of coordinates that act on one another both ways: its eigenvalues are those of the
//! blocks, one coordinate alone being its own. Each block is balanced by powers of two (Parlett and Reinsch 1969).

use nalgebra::{Complex, DMatrix, DVector};

use super::Matrix;
use super::balance::{acts, balance};
use super::solve::exact_sum;

/// Roundings of the decomposition per coordinate, relative to the matrix.
const ROUNDINGS: f64 = 8.0;

/// An eigenvalue with what rounding may have left in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigenvalue {
    /// Its value.
    pub value: Complex<f64>,
    /// What a rounding of each entry of the matrix, and of the value, may move it by.
    pub error: f64,
}

/// All eigenvalues of a square matrix; `None` where entries are not finite or the decomposition fails.
pub fn eigenvalues(matrix: &Matrix) -> Option<Vec<Complex<f64>>> {
    let values = blocks(matrix)?.into_iter().map(|block| values(&block));
    Some(values.collect::<Option<Vec<_>>>()?.concat())
}

/// The same with an error of each, and values refined by residuals in twice the precision where they are simple.
pub fn known_eigenvalues(matrix: &Matrix) -> Option<Vec<Eigenvalue>> {
    let mut known = Vec::new();
    for block in blocks(matrix)? {
        for value in values(&block)? {
            known.push(refined(&block, value));
        }
    }
    Some(known)
}

/// The blocks of coordinates that act on one another, each balanced.
fn blocks(matrix: &Matrix) -> Option<Vec<Matrix>> {
    let n = matrix.nrows();
    if !matrix.is_square() || !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let acts = acts(matrix);
    let mut seen = vec![false; n];
    let mut blocks = Vec::new();
    for first in 0..n {
        if seen[first] {
            continue;
        }
        let own: Vec<usize> = (first..n)
            .filter(|other| acts.goes_round(first, *other))
            .collect();
        own.iter().for_each(|index| seen[*index] = true);
        let block = Matrix::from_fn(own.len(), own.len(), |i, j| matrix[(own[i], own[j])]);
        let (scales, _) = balance(&block, 0.0);
        blocks.push(Matrix::from_fn(own.len(), own.len(), |i, j| {
            block[(i, j)] * scales[j] / scales[i]
        }));
    }
    Some(blocks)
}

fn values(block: &Matrix) -> Option<Vec<Complex<f64>>> {
    let n = block.nrows();
    if n == 1 {
        return Some(vec![Complex::new(block[(0, 0)], 0.0)]);
    }
    faer::MatRef::from_column_major_slice(block.as_slice(), n, n)
        .eigenvalues()
        .ok()
}

/// An eigenvector by inverse iteration, of length 1; `shift` is some roundings of the matrix.
fn vector(matrix: &DMatrix<Complex<f64>>, shift: f64) -> Option<DVector<Complex<f64>>> {
    let n = matrix.nrows();
    // at an eigenvalue that is exact to the last digit a pivot is zero
    [0.0, 1.0, 4.0, 16.0].into_iter().find_map(|times| {
        let shifted = matrix + DMatrix::identity(n, n) * Complex::from(times * shift);
        let factors = shifted.lu();
        let mut vector = DVector::from_fn(n, |i, _| Complex::from(1.0 + (i as f64).sqrt().fract()));
        for _ in 0..3 {
            vector = factors.solve(&vector)?;
            let size = vector.norm();
            if !size.is_normal() {
                return None;
            }
            vector.unscale_mut(size);
        }
        Some(vector)
    })
}

/// An eigenvalue λ of a balanced matrix A with the error that rounding may leave in it: by its vectors x and y a change
/// E of A moves it by y*Ex/y*x, and by no more than (2‖A‖)^(1 − 1/n)‖E‖^(1/n) (Elsner 1985) however near others are.
fn refined(block: &Matrix, value: Complex<f64>) -> Eigenvalue {
    let n = block.nrows();
    if n == 1 {
        let error = f64::EPSILON * value.norm();
        return Eigenvalue { value, error };
    }
    let norm = block.norm();
    let roundings = ROUNDINGS * n as f64 * f64::EPSILON;
    let elsner = 2.0 * norm * (0.5 * roundings).powf(1.0 / n as f64);
    let unrefined = Eigenvalue {
        value,
        error: elsner,
    };
    let shifted = |conjugate: bool| {
        DMatrix::from_fn(n, n, |i, j| {
            let (entry, own) = match conjugate {
                false => (block[(i, j)], value),
                true => (block[(j, i)], value.conj()),
            };
            Complex::from(entry) - if i == j { own } else { Complex::from(0.0) }
        })
    };
    let shift = f64::EPSILON * norm;
    let vectors = vector(&shifted(false), shift).zip(vector(&shifted(true), shift));
    let Some((right, left)) = vectors else {
        return unrefined;
    };
    let across = left.dotc(&right).norm();
    let sizes = block.abs() * right.map(|x| x.norm());
    let moved = left.iter().zip(&sizes).map(|(y, size)| y.norm() * size);
    let error = f64::EPSILON * value.norm() + roundings * moved.sum::<f64>() / across;
    if error.is_nan() || error >= elsner {
        return unrefined;
    }
    let part = |row: usize, of: fn(&Complex<f64>) -> f64, turned: f64| {
        let rates = (0..n).map(|j| (block[(row, j)], of(&right[j])));
        let other = if turned > 0.0 {
            right[row].im
        } else {
            right[row].re
        };
        let own = [(-value.re, of(&right[row])), (turned * value.im, other)];
        exact_sum(0.0, rates.chain(own))
    };
    let residual = DVector::from_fn(n, |row, _| {
        Complex::new(part(row, |z| z.re, 1.0), part(row, |z| z.im, -1.0))
    });
    let step = left.dotc(&residual) / left.dotc(&right);
    // an eigenvalue that is real stays so
    let step = if value.im == 0.0 {
        Complex::from(step.re)
    } else {
        step
    };
    let value = if step.norm() <= error {
        value + step
    } else {
        value
    };
    Eigenvalue { value, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The companion matrix of (λ + 1)(λ + 2)(λ² + 2λ + 5)(λ − 3), in units 1e±6 that are powers of two: its eigenvalues
    /// are known, and their condition in the balanced matrix is below 1e4.
    #[test]
    fn eigenvalues_do_not_depend_on_units() {
        let coefficients = [-30.0, -47.0, -20.0, -2.0, 2.0];
        let unit = |index: usize| [20.0_f64, -17.0, 3.0, -20.0, 11.0][index].exp2();
        let matrix = Matrix::from_fn(5, 5, |i, j| {
            let entry = match () {
                () if i == 4 => -coefficients[j],
                () if j == i + 1 => 1.0,
                () => 0.0,
            };
            entry * unit(i) / unit(j)
        });
        let known = known_eigenvalues(&matrix).unwrap();
        let plain = eigenvalues(&matrix).unwrap();
        let exact = [
            (-1.0, 0.0),
            (-2.0, 0.0),
            (-1.0, 2.0),
            (-1.0, -2.0),
            (3.0, 0.0),
        ];
        for (re, im) in exact {
            let off = |value: &Complex<f64>| (value - Complex::new(re, im)).norm();
            let nearest = known
                .iter()
                .min_by(|a, b| off(&a.value).total_cmp(&off(&b.value)));
            let nearest = nearest.unwrap();
            assert!(
                off(&nearest.value) <= nearest.error && nearest.error < 1e-10,
                "{nearest:?}"
            );
            assert!(off(&nearest.value) < 1e-14, "{nearest:?}");
            assert!(plain.iter().any(|value| off(value) < 1e-11));
        }
    }

    /// With s = 2⁻⁴⁰ the trace is 1 + s and the determinant s, exactly: the eigenvalues are 1 and s.
    #[test]
    fn a_small_eigenvalue_is_known_to_its_own_digits() {
        let small = (-40.0_f64).exp2();
        let matrix = Matrix::from_row_slice(2, 2, &[0.5 + small, 0.5 - small, 0.5, 0.5]);
        let known = known_eigenvalues(&matrix).unwrap();
        for exact in [1.0, small] {
            let off = |value: Complex<f64>| (value - exact).norm();
            let nearest = known
                .iter()
                .map(|one| off(one.value))
                .fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= 4.0 * f64::EPSILON * exact,
                "{exact:e}: {known:?}"
            );
        }
    }

    /// A triangular matrix has its diagonal, to the last digit; a double eigenvalue in a Jordan block is known to the
    /// square root of rounding, and its error says so.
    #[test]
    fn blocks_are_told_apart_and_errors_hold() {
        let matrix =
            Matrix::from_row_slice(3, 3, &[1.0, 1e12, 5.0, 0.0, -2.0, 1e-9, 0.0, 0.0, 0.25]);
        let values = eigenvalues(&matrix).unwrap();
        let exact: Vec<Complex<f64>> = [1.0, -2.0, 0.25].map(Complex::from).to_vec();
        assert_eq!(values, exact);
        // (λ + 0.1)² in no triangular form
        let matrix = Matrix::from_row_slice(2, 2, &[0.0, 1.0, -0.01, -0.2]);
        for known in known_eigenvalues(&matrix).unwrap() {
            let off = (known.value + 0.1).norm();
            assert!(off <= known.error && known.error < 1e-6, "{known:?}");
        }
        assert_eq!(eigenvalues(&Matrix::repeat(2, 2, f64::NAN)), None);
    }
}
