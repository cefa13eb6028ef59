//! What a switch makes of perturbations, compared at equal time: S = Rₓ + (f⁺ − Rż⁻)gᵀ/ġ.

use super::passage::Passage;
use crate::linalg::{Matrix, Vector, product};

/// Rates on both sides of a switch are the same to this part of the terms of one of them: those of states that are known
/// to a few roundings.
const CONTINUOUS: f64 = 16.0 * f64::EPSILON;

/// An entry is zero where it is less than this part of the terms it is made of.
pub(in crate::affine) const NOTHING: f64 = 16.0 * f64::EPSILON;

/// The parts of the linear map of a switch.
pub(in crate::affine) struct Saltation {
    /// Rₓ.
    pub reset: Matrix,
    /// f⁺.
    pub after: Vector,
    /// f⁺ − Rż⁻.
    pub shift: Vector,
    /// Sizes of the terms that the last is made of.
    terms: Vector,
}

/// The guard of a switch that is met slowly, and what is known of the motion there: at a graze what it divides vanishes with it.
pub(in crate::affine) struct Slow<'a> {
    /// g.
    pub guard: &'a Vector,
    /// Matrix of the mode that ends.
    pub before: &'a Matrix,
    /// ż⁻.
    pub rate: &'a Vector,
    /// ġ.
    pub fall: f64,
}

impl Saltation {
    /// Of the switch at the end of a passage with this reset and this rate there, into a mode with this matrix at its entry.
    pub fn new(
        passage: &Passage,
        reset: &Matrix,
        rate: &Vector,
        (matrix, entry): (&Matrix, &Vector),
    ) -> Saltation {
        let after = product(matrix, entry).rows(0, reset.nrows()).into_owned();
        let mut shift = &after - product(reset, rate);
        // fields that meet without a jump differ by rounding, which a graze would magnify without bound
        let sizes = sizes_of_product(matrix, entry);
        for (shift, size) in shift.iter_mut().zip(&sizes) {
            if shift.abs() <= CONTINUOUS * size {
                *shift = 0.0;
            }
        }
        let of_reset = sizes_of_product(reset, rate);
        Saltation {
            reset: passage.slopes(reset),
            terms: Vector::from_fn(reset.nrows(), |i, _| of_reset[i] + sizes[i]),
            after,
            shift,
        }
    }

    /// (f⁺ − Rż⁻)/ġ where the guard is met slowly, and how far every entry is off relative to the error of the state. Where a
    /// row of the jump is a multiple of ġ, but for one of g, which is zero there, the ratio is that, however slow: where a
    /// stick begins it is −1.
    pub fn refine(
        &mut self,
        passage: &Passage,
        reset: &Matrix,
        after: &Matrix,
        slow: &Slow,
    ) -> (Vector, Vector) {
        let (n, rows) = (reset.nrows(), slow.before.nrows());
        let (end, guard, columns) = (&passage.end, slow.guard, slow.before.ncols());
        let shift = &self.after - product(reset, slow.rate);
        // f⁺ is one of the state after the reset
        let mut difference =
            after.view((0, 0), (n, n)) * reset - reset.columns(0, rows) * slow.before;
        for column in n..columns {
            let mut sum = difference.column_mut(column);
            sum += after.view((0, column), (n, 1));
        }
        let of_guard = slow.before.tr_mul(&guard.rows(0, rows));
        let largest = |row: &Vector| {
            let share = |k: &usize| (row[*k] * end[*k]).abs();
            (0..columns).max_by(|one, other| share(one).total_cmp(&share(other)))
        };
        let size = |row: &Vector| {
            row.iter()
                .zip(end)
                .map(|(by, x)| (by * x).abs())
                .sum::<f64>()
        };
        let without = |row: &Vector, of: &Vector| -> (Vector, f64) {
            let pivot = largest(of).filter(|pivot| of[*pivot] != 0.0);
            let part = pivot.map_or(0.0, |pivot| row[pivot] / of[pivot]);
            (row - of * part, part)
        };
        let (falls, _) = without(&of_guard, guard);
        let (mut ratios, mut off) = (Vector::zeros(n), Vector::zeros(n));
        for i in 0..n {
            let own = difference.row(i).transpose();
            let (rest, ratio) = without(&without(&own, guard).0, &falls);
            if size(&rest) <= CONTINUOUS * (size(&own) + ratio.abs() * size(&of_guard)) {
                ratios[i] = ratio;
                self.terms[i] = 0.0;
                continue;
            }
            ratios[i] = shift[i] / slow.fall;
            let made = (rows..slow.rate.len())
                .map(|k| (reset[(i, k)] - ratios[i] * guard[k]) * slow.rate[k]);
            let made: f64 = made.map(f64::abs).sum();
            off[i] = (size(&(own - &of_guard * ratios[i])) + made) / slow.fall.abs();
        }
        (ratios, off)
    }

    /// Errors of the entries of the whole map, where a perturbation of a state comes to the switch by so much later. What has no
    /// terms has no error where that is infinite, as at a graze.
    pub fn bounds(&self, delay: impl Fn(usize) -> f64) -> Matrix {
        let n = self.reset.nrows();
        let delayed = |i: usize, j: usize| match self.terms[i] {
            0.0 => 0.0,
            terms => terms * delay(j),
        };
        Matrix::from_fn(n, n, |i, j| {
            (self.reset[(i, j)].abs() + delayed(i, j)) * NOTHING
        })
    }
}

/// Rank of a square matrix whose entries are known to bounds, whatever the units of its rows and columns: what is
/// eliminated first is known best, and what is left at the end may be zero.
pub(in crate::affine) fn rank(mut matrix: Matrix, mut bounds: Matrix) -> usize {
    let n = matrix.nrows();
    for step in 0..n {
        let places = (step..n).flat_map(|j| (step..n).map(move |i| (i, j)));
        let known = |&(i, j): &(usize, usize)| matrix[(i, j)].abs() / bounds[(i, j)];
        let told = places.filter(|place| matrix[*place].abs() > bounds[*place]);
        let Some((row, column)) = told.max_by(|one, other| known(one).total_cmp(&known(other)))
        else {
            return step;
        };
        for all in [&mut matrix, &mut bounds] {
            all.swap_rows(step, row);
            all.swap_columns(step, column);
        }
        let (pivot, off) = (
            matrix[(step, step)],
            bounds[(step, step)] / matrix[(step, step)].abs(),
        );
        for i in step + 1..n {
            let part = matrix[(i, step)] / pivot;
            let part_off = bounds[(i, step)] / pivot.abs() + part.abs() * off;
            // most jumps move few states
            if part_off == 0.0 {
                continue;
            }
            for j in step + 1..n {
                let by = matrix[(step, j)];
                bounds[(i, j)] += part.abs() * bounds[(step, j)]
                    + part_off * by.abs()
                    + f64::EPSILON * (part * by).abs();
                matrix[(i, j)] -= part * by;
            }
        }
    }
    n
}

/// Sums of the sizes of the terms of a product.
pub(in crate::affine) fn sizes_of_product(matrix: &Matrix, vector: &Vector) -> Vector {
    let rows = matrix.nrows();
    let mut sizes = Vector::zeros(rows);
    let columns = matrix.as_slice().chunks_exact(rows);
    for (column, factor) in columns.zip(vector.as_slice()) {
        let pairs = sizes.as_mut_slice().iter_mut().zip(column);
        pairs.for_each(|(sum, entry)| *sum += (entry * factor).abs());
    }
    sizes
}
