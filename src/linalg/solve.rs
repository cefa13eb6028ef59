//! Systems of equations in which every unknown and every equation has a size of its own.
//!
//! Rows and columns are scaled by powers of two until the largest entry of each is of order one (Ruiz 2001), and the
//! solution is refined by residuals that are formed in twice the precision (Ogita, Rump and Oishi 2005): every unknown
//! is known to a few roundings of its own, in whatever units it stands, as long as the matrix is regular in the best units.

use super::{Factors, Matrix, Vector};

/// Condition in the best units above which a matrix is singular: refinement gains less than a factor of 10 at a step there.
pub const SINGULAR: f64 = 1e14;

/// Sweeps of the scaling at most: each takes the square root of what is out of scale.
const SWEEPS: usize = 40;

/// Steps of refinement at most: two digits each at the condition [`SINGULAR`].
const REFINEMENTS: usize = 20;

/// A matrix DAE with diagonal D and E of powers of two.
pub(super) struct Scaled {
    pub matrix: Matrix,
    pub rows: Vector,
    pub columns: Vector,
}

impl Scaled {
    /// The largest entry of every row and, where `columns` says so, of every column is between 1/2 and 2. Rows and
    /// columns of zeros stay.
    pub fn new(matrix: &Matrix, columns: bool) -> Scaled {
        let mut scaled = Scaled {
            matrix: matrix.clone(),
            rows: Vector::repeat(matrix.nrows(), 1.0),
            columns: Vector::repeat(matrix.ncols(), 1.0),
        };
        // both are scaled at once, each by the square root, or rows alone by all of it
        let share = if columns { -0.5 } else { -1.0 };
        let factor = |size: f64| match size.is_normal() {
            true => (share * size.log2()).round().clamp(-500.0, 500.0).exp2(),
            false => 1.0,
        };
        for _ in 0..SWEEPS {
            let of_rows: Vec<f64> = scaled
                .matrix
                .row_iter()
                .map(|row| factor(row.amax()))
                .collect();
            let of_columns: Vec<f64> = match columns {
                true => scaled
                    .matrix
                    .column_iter()
                    .map(|column| factor(column.amax()))
                    .collect(),
                false => vec![1.0; matrix.ncols()],
            };
            if of_rows
                .iter()
                .chain(&of_columns)
                .all(|factor| *factor == 1.0)
            {
                break;
            }
            for (column, of_column) in of_columns.iter().enumerate() {
                for (row, of_row) in of_rows.iter().enumerate() {
                    scaled.matrix[(row, column)] *= of_row * of_column;
                }
            }
            scaled
                .rows
                .iter_mut()
                .zip(of_rows)
                .for_each(|(all, own)| *all *= own);
            scaled
                .columns
                .iter_mut()
                .zip(of_columns)
                .for_each(|(all, own)| *all *= own);
        }
        scaled
    }
}

/// s + Σ ab as if formed in twice the precision and rounded once.
pub(super) fn exact_sum(start: f64, products: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut rest) = (start, 0.0);
    for (a, b) in products {
        let product = a * b;
        let next = sum + product;
        let added = next - sum;
        rest += (sum - (next - added)) + (product - added) + a.mul_add(b, -product);
        sum = next;
    }
    sum + rest
}

/// The least condition number of a square matrix in any units of its rows and columns: the spectral radius of |A⁻¹||A| (Bauer
/// 1963). Infinite for a singular one, or where entries are not finite.
pub fn condition(matrix: &Matrix) -> f64 {
    let scaled = Scaled::new(matrix, true).matrix;
    least_condition(&scaled, &Factors::new(&scaled))
}

/// The same, by the factors of the matrix.
fn least_condition(matrix: &Matrix, factors: &Factors) -> f64 {
    let Some(inverse) = factors
        .inverse()
        .filter(|inverse| inverse.iter().all(|x| x.is_finite()))
    else {
        return f64::INFINITY;
    };
    radius(&(inverse.abs() * matrix.abs()))
}

/// The spectral radius of a matrix without negative entries, to a few per cent: what its largest row sum comes to in the units in which
/// that is least.
pub fn radius(matrix: &Matrix) -> f64 {
    /// Iterations of the power method.
    const ITERATIONS: usize = 16;
    let mut vector = Vector::repeat(matrix.nrows(), 1.0);
    let mut radius = 0.0;
    for _ in 0..ITERATIONS {
        vector = matrix * vector;
        radius = vector.amax();
        // of a triangular matrix without diagonal nothing is left
        if radius == 0.0 {
            return radius;
        }
        vector /= radius;
    }
    radius
}

/// Solves Ax = b for a square A; `None` where its [`condition`] exceeds 1e14, where x overflows, or where the residual is
/// not at rounding in every equation.
pub fn solve(matrix: &Matrix, right: &Vector) -> Option<Vector> {
    let scaled = Scaled::new(matrix, true);
    let factors = Factors::new(&scaled.matrix);
    let condition = least_condition(&scaled.matrix, &factors);
    let regular = condition <= SINGULAR;
    if !regular || !right.iter().all(|x| x.is_finite()) {
        return None;
    }
    let n = right.len();
    let mut solution = Vector::zeros(n);
    let mut before = f64::INFINITY;
    for _ in 0..REFINEMENTS {
        let residual = |row: usize| {
            let row_of = (0..n).map(|column| (-matrix[(row, column)], solution[column]));
            exact_sum(right[row], row_of)
        };
        let mut step = Vector::from_fn(n, |row, _| scaled.rows[row] * residual(row));
        let size = solution.component_div(&scaled.columns).amax();
        if !factors.solve(&mut step) {
            return None;
        }
        let change = step.amax();
        step.component_mul_assign(&scaled.columns);
        let still = step.iter().zip(&solution);
        let still = still
            .into_iter()
            .all(|(step, x)| step.abs() <= f64::EPSILON * x.abs());
        solution += step;
        // rounding is left where steps no longer fall
        if still || change == 0.0 || change >= 0.5 * before && change <= 1e-14 * size {
            break;
        }
        before = change;
    }
    // an unknown that is zero keeps the rounding of the last step, whose size is a rounding of the others
    let zero = condition * f64::EPSILON * solution.component_div(&scaled.columns).amax();
    let at_rounding = (0..n).all(|row| {
        let terms = (0..n).map(|column| (-matrix[(row, column)], solution[column]));
        let size: f64 = terms.clone().map(|(a, x)| (a * x).abs()).sum::<f64>() + right[row].abs();
        let rounding = size.max(zero / scaled.rows[row]);
        exact_sum(right[row], terms).abs() <= 4.0 * f64::EPSILON * rounding
    });
    (at_rounding && solution.iter().all(|x| x.is_finite())).then_some(solution)
}

/// A generalised inverse of a matrix: of equations that agree it gives the solution of least norm, of others that of
/// least squares after each has been scaled so that its largest coefficient is of order one. Singular values of the
/// scaled matrix below a part of the largest are zero. `None` if the decomposition fails.
pub fn pseudo_inverse(matrix: &Matrix, part: f64) -> Option<Matrix> {
    let (rows, columns) = matrix.shape();
    if matrix.is_empty() || !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let scaled = Scaled::new(matrix, false);
    let view = faer::MatRef::from_column_major_slice(scaled.matrix.as_slice(), rows, columns);
    let decomposition = view.thin_svd().ok()?;
    let (left, right) = (decomposition.U(), decomposition.V());
    let values = decomposition.S().column_vector();
    let rank = (0..rows.min(columns))
        .filter(|index| values[*index] > part * values[0])
        .count();
    Some(Matrix::from_fn(columns, rows, |i, j| {
        let terms = (0..rank).map(|k| right[(i, k)] * left[(j, k)] / values[k]);
        terms.sum::<f64>() * scaled.rows[j]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// States of size 10, 1e-3 and 1; coefficients are decimals, so that the solution in doubles is 4, 1/375, 8/15 to a
    /// rounding of the coefficients times the condition of the scaled matrix, about 30.
    #[test]
    fn unknowns_of_different_size_are_known_each_to_rounding() {
        let entries = [-3.0, -3000.0, 0.0, 0.001, -3.0, -0.03, -0.2, 100.0, 1.0];
        let matrix = Matrix::from_row_slice(3, 3, &entries);
        let right = Vector::from_vec(vec![-20.0, -0.02, 0.0]);
        let found = solve(&matrix, &right).unwrap();
        for (x, exact) in found.iter().zip([4.0, 1.0 / 375.0, 8.0 / 15.0]) {
            assert!(
                (x - exact).abs() < 100.0 * f64::EPSILON * exact,
                "{x} {exact}"
            );
        }
        assert!(condition(&matrix) < 100.0, "{}", condition(&matrix));
    }

    /// Hilbert's matrix of 8 rows in units 2^(±40), a condition of 1.5e10: with b the sum of its columns, entries
    /// that are whole numbers times a power of two, the exact solution is all ones in these units.
    #[test]
    fn an_ill_conditioned_matrix_in_odd_units_is_solved_to_the_last_digit() {
        const N: usize = 8;
        // the least common multiple of 1 to 15
        let whole = 360_360.0;
        let unit = |index: usize| {
            (40.0 * ((7 * index + 3) % 11) as f64 / 5.0 - 40.0)
                .round()
                .exp2()
        };
        let entry = |i: usize, j: usize| whole / (i + j + 1) as f64;
        let scaled = |i: usize, j: usize| unit(i) * entry(i, j) * unit(j + 5);
        let matrix = Matrix::from_fn(N, N, scaled);
        let right = Vector::from_fn(N, |i, _| unit(i) * (0..N).map(|j| entry(i, j)).sum::<f64>());
        let found = solve(&matrix, &right).unwrap();
        for (j, x) in found.iter().enumerate() {
            assert!(
                (x * unit(j + 5) - 1.0).abs() <= 2.0 * f64::EPSILON,
                "{j}: {x:e}"
            );
        }
    }

    /// The first two equations have the solution x = 0, y = 1/1.44, and the third follows x: z = 0. What is left of x by its
    /// rounding is the size of every term of the third.
    #[test]
    fn what_follows_an_unknown_that_is_zero_is_zero() {
        for a in [1.44, 1.2 * 1.2, 0.7 * 0.7, 2.3] {
            for b in [2.44, 1.0 + a, 3.1] {
                let entries = [b - 1.0, a, 0.0, -b, -a, 0.0, 0.3, 0.0, -1.4];
                let matrix = Matrix::from_row_slice(3, 3, &entries);
                for y in [1.0 / 3.0, 0.1, 7.7] {
                    let right = Vector::from_vec(vec![y, -y, 0.0]);
                    let found = solve(&matrix, &right).unwrap();
                    assert!((found[1] * a / y - 1.0).abs() < 8.0 * f64::EPSILON);
                    assert!(found[0].abs().max(found[2].abs()) < f64::EPSILON);
                }
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_called_so() {
        let matrix = Matrix::from_row_slice(2, 2, &[1e-9, 3e4, 1e-3, 3e10]);
        assert_eq!(solve(&matrix, &Vector::from_vec(vec![1.0, 2.0])), None);
        assert!(condition(&matrix) > SINGULAR);
        // but not one whose rows or columns are small
        let matrix = Matrix::from_row_slice(2, 2, &[1e-30, 2e-30, 1e30, 1e30]);
        let found = solve(&matrix, &Vector::from_vec(vec![3e-30, 2e30])).unwrap();
        assert!(found.iter().all(|x| (x - 1.0).abs() < 4.0 * f64::EPSILON));
    }

    /// x + y = 3 in any units and twice: the solution of least norm is x = y = 3/2; three equations that agree with
    /// x = 1, y = 2 give it.
    #[test]
    fn a_generalised_inverse_knows_no_units_of_equations() {
        let right = |values: &[f64]| Vector::from_column_slice(values);
        let matrix = Matrix::from_row_slice(2, 2, &[1.0, 1.0, 1e8, 1e8]);
        let found = pseudo_inverse(&matrix, 1e-12).unwrap() * right(&[3.0, 3e8]);
        assert!(found.iter().all(|x| (x - 1.5).abs() < 1e-14), "{found}");
        let matrix = Matrix::from_row_slice(3, 2, &[1e9, 0.0, 0.0, 1e-9, 1.0, 1.0]);
        let found = pseudo_inverse(&matrix, 1e-12).unwrap() * right(&[1e9, 2e-9, 3.0]);
        assert!((found[0] - 1.0).abs() < 1e-14 && (found[1] - 2.0).abs() < 1e-14);
    }
}
