//! The few dense operations the continuation needs.
//!
//! Newton systems of 8 to 40 unknowns are solved by nalgebra's LU with partial pivoting,
//! which at that size is two to three times faster than faer's blocked one; those of orbits of many zones, nearly all of
//! whose entries are zero, by lists of their entries. Null vectors and condition numbers, wanted only at events, come from
//! faer's singular value decomposition. That of nalgebra loses matrices of condition 1e5 whose entries differ in size, and
//! is not used.

mod balance;
mod eigenvalues;
mod factors;
pub mod periodic_schur;
mod solve;

use faer::traits::ComplexField;
use nalgebra::{DMatrix, DVector};

pub use balance::{acts, balance, without_noise};
pub use eigenvalues::{Eigenvalue, eigenvalues, known_eigenvalues};
pub use factors::Factors;
pub use solve::{condition, pseudo_inverse, radius, solve};

/// Dense matrix, column-major.
pub type Matrix = DMatrix<f64>;
/// Dense column vector.
pub type Vector = DVector<f64>;

/// Adds factor·left·right to a sum, all by columns, `rows` that of left: zeros of right cost nothing. Most matrices
/// of users' systems have few entries, or are too small for the blocks of a general product.
#[inline]
pub fn add_product(factor: f64, left: &[f64], rows: usize, right: &[f64], sum: &mut [f64]) {
    let columns = right.chunks_exact(left.len() / rows);
    for (column, sum) in columns.zip(sum.chunks_exact_mut(rows)) {
        for (weight, left) in column.iter().zip(left.chunks_exact(rows)) {
            if *weight != 0.0 {
                let weight = factor * weight;
                let pairs = sum.iter_mut().zip(left);
                pairs.for_each(|(sum, entry)| *sum += weight * entry);
            }
        }
    }
}

/// A matrix times a vector: of few entries, as [`add_product`].
pub fn product(matrix: &Matrix, vector: &Vector) -> Vector {
    let mut sum = Vector::zeros(matrix.nrows());
    let (left, right) = (matrix.as_slice(), vector.as_slice());
    add_product(1.0, left, matrix.nrows(), right, sum.as_mut_slice());
    sum
}

/// Numbers in [0, 1) that fill it evenly, of every coordinate one for each place: multiples of the root of a prime, so that no
/// coordinate keeps to a few values and no two go together.
pub fn even(place: usize) -> impl Iterator<Item = f64> {
    let is_prime = |number: &usize| {
        let mut others = (2..).take_while(|other| other * other <= *number);
        others.all(|other| !number.is_multiple_of(other))
    };
    let primes = (2..).filter(is_prime);
    primes.map(move |prime| (place as f64 * (prime as f64).sqrt()).fract())
}

/// Singular values of an n × (n+1) matrix and its null vector.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// Unit vector t with Jt = 0.
    pub null_vector: Vector,
    /// Largest singular value.
    pub largest: f64,
    /// Smallest of the n singular values: zero where the null space has more than one dimension.
    pub smallest: f64,
}

/// Null vector of an n × (n+1) matrix, n ≥ 1. `None` if the decomposition fails, as it does for
/// entries that are not finite.
pub fn kernel(matrix: &Matrix) -> Option<Kernel> {
    let (rows, columns) = matrix.shape();
    if columns != rows + 1 || !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let view = faer::MatRef::from_column_major_slice(matrix.as_slice(), rows, columns);
    let decomposition = view.svd().ok()?;
    let right = decomposition.V();
    let values = decomposition.S().column_vector();
    Some(Kernel {
        null_vector: Vector::from_fn(columns, |i, _| right[(i, columns - 1)]),
        largest: values[0],
        smallest: values[rows - 1],
    })
}

/// Orthonormal bases of what a matrix nearly takes to zero, from either side.
#[derive(Clone, Debug)]
pub struct NullSpaces {
    /// Columns x with Jx = 0.
    pub right: Matrix,
    /// Columns y with Jᵀy = 0.
    pub left: Matrix,
}

/// Bases of the directions that a matrix with at least as many columns as rows shrinks below a part of its largest
/// singular value. `None` if the decomposition fails.
pub fn null_spaces(matrix: &Matrix, part: f64) -> Option<NullSpaces> {
    spaces(matrix, |values| {
        let above = values.iter().filter(|value| **value > part * values[0]);
        above.count()
    })
}

/// Bases of the directions that such a matrix shrinks most: so many from the left. `None` if the decomposition fails.
pub fn least_spaces(matrix: &Matrix, left: usize) -> Option<NullSpaces> {
    spaces(matrix, |values| values.len().saturating_sub(left))
}

/// Bases of what remains beyond a rank, which is told from the singular values.
fn spaces(matrix: &Matrix, rank: impl FnOnce(&[f64]) -> usize) -> Option<NullSpaces> {
    let (rows, columns) = matrix.shape();
    if rows > columns || rows == 0 || !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let view = faer::MatRef::from_column_major_slice(matrix.as_slice(), rows, columns);
    let decomposition = view.svd().ok()?;
    let (right, left) = (decomposition.V(), decomposition.U());
    let values = decomposition.S().column_vector();
    let values: Vec<f64> = values.iter().copied().collect();
    let rank = rank(&values);
    Some(NullSpaces {
        right: Matrix::from_fn(columns, columns - rank, |i, j| right[(i, rank + j)]),
        left: Matrix::from_fn(rows, rows - rank, |i, j| left[(i, rank + j)]),
    })
}

/// Right vector of the least singular value of a matrix with at least as many rows as columns, real or complex.
/// `None` if the decomposition fails.
pub fn least_vector<T: ComplexField + nalgebra::Scalar>(matrix: &DMatrix<T>) -> Option<DVector<T>> {
    let (rows, columns) = matrix.shape();
    if rows < columns || columns == 0 {
        return None;
    }
    let view = faer::MatRef::from_column_major_slice(matrix.as_slice(), rows, columns);
    let decomposition = view.svd().ok()?;
    let right = decomposition.V();
    Some(DVector::from_fn(columns, |i, _| {
        right[(i, columns - 1)].clone()
    }))
}

/// The least singular value of a square matrix with its vectors.
#[derive(Clone, Debug)]
pub struct Least {
    /// Left vector: wᵀM = σvᵀ.
    pub left: Vector,
    /// Right vector: Mv = σw.
    pub right: Vector,
    /// σ.
    pub value: f64,
    /// Largest singular value.
    pub largest: f64,
}

/// The least singular value of a square matrix. `None` if the decomposition fails, as it does for
/// entries that are not finite.
pub fn least(matrix: &Matrix) -> Option<Least> {
    let (rows, columns) = matrix.shape();
    if columns != rows || rows == 0 || !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let view = faer::MatRef::from_column_major_slice(matrix.as_slice(), rows, columns);
    let decomposition = view.svd().ok()?;
    let (left, right) = (decomposition.U(), decomposition.V());
    let values = decomposition.S().column_vector();
    Some(Least {
        left: Vector::from_fn(rows, |i, _| left[(i, rows - 1)]),
        right: Vector::from_fn(rows, |i, _| right[(i, rows - 1)]),
        value: values[rows - 1],
        largest: values[0],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernel_of_a_planted_matrix() {
        // rows orthogonal to (1, 2, 2)/3
        let matrix = Matrix::from_row_slice(2, 3, &[2.0, -1.0, 0.0, 0.0, 1.0, -1.0]);
        let kernel = kernel(&matrix).unwrap();
        let sign = kernel.null_vector[0].signum();
        for (found, expected) in kernel.null_vector.iter().zip([1.0, 2.0, 2.0]) {
            assert!((sign * found - expected / 3.0).abs() < 4.0 * f64::EPSILON);
        }
        // the determinant of JJᵀ is 9: the product of the singular values is 3
        assert!((kernel.largest * kernel.smallest - 3.0).abs() < 1e-14);
    }
}
