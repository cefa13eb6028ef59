//! What a switch makes of perturbations, compared at equal time: S = Rₓ + (f⁺ − Rż⁻)gᵀ/ġ.

use super::passage::Passage;
use crate::affine::mode::Exit;
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

/// Both sides of a switch as forms of z before it, where what is made of states is the same function of them on both sides.
pub(in crate::affine) struct Sides<'a> {
    /// R.
    pub reset: &'a Matrix,
    /// Matrices of the mode that ends and of the one that begins.
    pub modes: [&'a Matrix; 2],
    /// g.
    pub guard: &'a Vector,
    /// z before the switch.
    pub end: &'a Vector,
}

impl Sides<'_> {
    /// A row of f⁺ − Rż⁻: f⁺ is one of the state after the reset.
    fn row(&self, i: usize) -> Vector {
        let ([before, after], n) = (self.modes, self.reset.nrows());
        let made = n..before.ncols();
        let own = |matrix: &Matrix, count: usize| matrix.row(i).columns(0, count).transpose();
        let mut row = self.reset.tr_mul(&own(after, n));
        row -= before.tr_mul(&own(self.reset, before.nrows()));
        made.for_each(|k| row[k] += after[(i, k)]);
        row
    }

    /// A form without its multiple of another by what that is most of, and the multiple.
    fn without(&self, row: &Vector, of: &Vector) -> (Vector, f64) {
        let share = |k: &usize| (of[*k] * self.end[*k]).abs();
        let pivots = (0..of.len()).filter(|k| of[*k] != 0.0);
        let pivot = pivots.max_by(|one, other| share(one).total_cmp(&share(other)));
        let part = pivot.map_or(0.0, |pivot| row[pivot] / of[pivot]);
        (row - of * part, part)
    }

    /// Size of the terms of a form.
    fn size(&self, row: &Vector) -> f64 {
        row.iter().zip(self.end).map(|(by, x)| (by * x).abs()).sum()
    }
}

impl Saltation {
    /// Of an exit at the end of a passage with this rate there, into a mode with this matrix at its entry.
    pub fn new(
        passage: &Passage,
        exit: &Exit,
        rate: &Vector,
        (matrix, entry): (&Matrix, &Vector),
    ) -> Saltation {
        let reset = &exit.reset.at;
        let n = reset.nrows();
        let after = product(matrix, entry).rows(0, n).into_owned();
        let (mut shift, mut terms) = (Vector::zeros(n), Vector::zeros(n));
        // sliding and contacts that end by their own condition leave without a jump
        if exit.tangent.is_none() {
            shift = &after - product(reset, rate);
            terms = sizes_of_product(matrix, entry).rows(0, n).into_owned();
            // fields that meet without a jump differ by rounding, which a graze would magnify without bound
            for (shift, size) in shift.iter_mut().zip(&terms) {
                if shift.abs() <= CONTINUOUS * size {
                    *shift = 0.0;
                }
            }
            terms += sizes_of_product(reset, rate);
        }
        Saltation {
            reset: passage.slopes(reset),
            terms,
            after,
            shift,
        }
    }

    /// Takes rows of f⁺ − Rż⁻ that are multiples of g for zero, as the guard is: of those below these sizes, what is left is rounding.
    pub fn without_guard(&mut self, sides: &Sides, sizes: impl Fn(usize) -> f64) {
        for i in 0..self.shift.len() {
            if self.shift[i] == 0.0 || self.shift[i].abs() >= sizes(i) {
                continue;
            }
            let own = sides.row(i);
            let (rest, _) = sides.without(&own, sides.guard);
            if sides.size(&rest) <= CONTINUOUS * sides.size(&own) {
                (self.shift[i], self.terms[i]) = (0.0, 0.0);
            }
        }
    }

    /// (f⁺ − Rż⁻)/ġ where the guard is met slowly, and how far every entry is off relative to the error of the state. Where a
    /// row of the jump is a multiple of ġ, but for one of g, which is zero there, the ratio is that, however slow: where a
    /// stick begins it is −1.
    pub fn refine(&mut self, sides: &Sides, rate: &Vector, fall: f64) -> (Vector, Vector) {
        let (Sides { reset, guard, .. }, [before, _]) = (sides, sides.modes);
        let (n, rows) = (reset.nrows(), before.nrows());
        let shift = &self.after - product(reset, rate);
        let of_guard = before.tr_mul(&guard.rows(0, rows));
        let (falls, _) = sides.without(&of_guard, guard);
        let (mut ratios, mut off) = (Vector::zeros(n), Vector::zeros(n));
        for i in 0..n {
            let own = sides.row(i);
            let (rest, ratio) = sides.without(&sides.without(&own, guard).0, &falls);
            let terms = sides.size(&own) + ratio.abs() * sides.size(&of_guard);
            if sides.size(&rest) <= CONTINUOUS * terms {
                ratios[i] = ratio;
                self.terms[i] = 0.0;
                continue;
            }
            ratios[i] = shift[i] / fall;
            let made = (rows..rate.len()).map(|k| (reset[(i, k)] - ratios[i] * guard[k]) * rate[k]);
            let made: f64 = made.map(f64::abs).sum();
            off[i] = (sides.size(&(own - &of_guard * ratios[i])) + made) / fall.abs();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// ẋ = v, v̇ = -x meets a spring with a damper at x = 1, where v̇ has -4(x - 1) - v/2 more. That jumps by half the speed of the guard
    /// 1 - x, however slow: at a graze, too, where the speed is zero in every digit, S has 1/2 in its row of v.
    #[test]
    fn what_a_damper_does_is_a_ratio_where_nothing_is_left_of_the_speed() {
        let before = Matrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let mut after = before.clone();
        (after[(1, 0)], after[(1, 1)], after[(1, 2)]) = (-5.0, -0.5, 4.0);
        let reset = Matrix::identity(2, 3);
        let guard = Vector::from_vec(vec![-1.0, 0.0, 1.0]);
        for speed in [0.25, 1e-12, 0.0] {
            let end = Vector::from_vec(vec![1.0, speed, 1.0]);
            let rate = &before * &end;
            let mut saltation = Saltation {
                reset: Matrix::identity(2, 2),
                after: (&after * &end).rows(0, 2).into_owned(),
                shift: Vector::from_vec(vec![0.0, -0.5 * speed]),
                terms: Vector::zeros(2),
            };
            let sides = Sides {
                reset: &reset,
                modes: [&before, &after],
                guard: &guard,
                end: &end,
            };
            let (ratios, off) = saltation.refine(&sides, &rate, -speed);
            assert_eq!(ratios.as_slice(), [0.0, 0.5]);
            assert_eq!(off.as_slice(), [0.0, 0.0]);
        }
    }

    /// The rate of x jumps from v to 0 where v is the guard: what rounding has left of that is no jump, in whatever unit it is.
    #[test]
    fn a_jump_by_the_guard_is_none() {
        for unit in [1.0, 1e-9, 1e9] {
            let before =
                Matrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -unit, 0.0, 0.0, 0.0]);
            let after = Matrix::zeros(3, 3);
            let guard = Vector::from_vec(vec![0.0, 1.0, 0.0]);
            let end = Vector::from_vec(vec![unit, 1e-17 * unit, 1.0]);
            let mut saltation = Saltation {
                reset: Matrix::identity(2, 2),
                after: Vector::zeros(2),
                shift: Vector::from_vec(vec![-1e-17 * unit, unit]),
                terms: Vector::from_vec(vec![1e-17 * unit, unit]),
            };
            let reset = Matrix::identity(2, 3);
            let sides = Sides {
                reset: &reset,
                modes: [&before, &after],
                guard: &guard,
                end: &end,
            };
            saltation.without_guard(&sides, |_| 1e-6 * unit);
            assert_eq!(saltation.shift.as_slice(), [0.0, unit]);
            assert_eq!(saltation.terms.as_slice(), [0.0, unit]);
        }
    }
}
