//! The scales in which a matrix is small.

use super::{Matrix, Vector};

/// Sweeps that balance a matrix: each at least halves what is left to gain.
const SWEEPS: usize = 20;

/// Powers of two d for which the largest column sum of D⁻¹MD is small, and that sum.
///
/// Osborne's method: rows and columns of one index get the same size. Units as different as volts and seconds
/// would otherwise make pieces a hundred times too short.
pub fn balance(matrix: &Matrix) -> (Vector, f64) {
    let size = matrix.nrows();
    let mut scales = Vector::repeat(size, 1.0);
    let diagonal = matrix.diagonal().abs();
    let mut scaled = matrix.abs();
    scaled.fill_diagonal(0.0);
    // the power of two nearest to √(row/column)
    let wanted = |row: f64, column: f64| {
        if row < 2.0 * column && column < 2.0 * row {
            return None;
        }
        let exponent = (0.5 * (row / column).log2()).round();
        let wanted = row > 0.0 && column > 0.0 && exponent != 0.0 && exponent.abs() < 100.0;
        wanted.then(|| exponent.exp2())
    };
    let mut rows = vec![0.0; size];
    for _ in 0..SWEEPS {
        let mut changed = false;
        rows.fill(0.0);
        for column in scaled.as_slice().chunks_exact(size) {
            let pairs = rows.iter_mut().zip(column);
            pairs.for_each(|(sum, entry)| *sum += entry);
        }
        for i in 0..size {
            let own = &scaled.as_slice()[i * size..(i + 1) * size];
            let Some(factor) = wanted(rows[i], own.iter().sum()) else {
                continue;
            };
            scales[i] *= factor;
            changed = true;
            for (column, other) in scaled.as_mut_slice().chunks_exact_mut(size).enumerate() {
                let before = other[i];
                other[i] /= factor;
                if column != i {
                    rows[i] += other[i] - before;
                }
            }
            let own = &mut scaled.as_mut_slice()[i * size..(i + 1) * size];
            for (sum, entry) in rows.iter_mut().zip(own) {
                *sum += *entry * (factor - 1.0);
                *entry *= factor;
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
