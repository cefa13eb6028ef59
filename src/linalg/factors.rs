//! LU factors of square matrices.
//!
//! Small or full ones are those of nalgebra. The equations of an orbit of many zones tie each zone to the next, the last to the
//! first, and all to few unknowns: nearly all entries are zero. There rows are kept as lists, and each is eliminated when its first
//! entry is that of the pivot: the work is in proportion to the zones. The pivot is the shortest of the rows whose entry in the column is
//! large enough, for a row with entries in all columns, as that of a tangent, would make others as long as itself.

use nalgebra::{Dyn, LU};

use super::{Matrix, Vector};

/// Fewer unknowns than this are factorised as they stand: lists take longer than the zeros of a small matrix.
const FEW: usize = 32;

/// A pivot is at least this part of the largest entry of its column: rounding grows by a factor 11 at most at one elimination, and most rows
/// take part in few (I.S. Duff, A.M. Erisman, J.K. Reid, Direct Methods for Sparse Matrices, 1986).
const LEAST: f64 = 0.1;

/// At least so many times as many entries as are not zero.
const SPARE: usize = 4;

/// LU factors of a square matrix.
#[derive(Clone, Debug)]
pub struct Factors(Stored);

#[derive(Clone, Debug)]
enum Stored {
    Full(Box<LU<f64, Dyn, Dyn>>),
    Lists(Lists),
}

/// Entries of a row that are not zero, each with its column, in order.
type List = Vec<(usize, f64)>;

/// Factors by rows.
#[derive(Clone, Debug)]
struct Lists {
    /// In the order of the columns: the row that is the pivot of each, and what of it is taken from which other rows.
    pivots: Vec<(usize, Vec<(usize, f64)>)>,
    /// The rows of U, each with its pivot first; empty where a column has none.
    upper: Vec<List>,
}

impl Factors {
    /// Factorises a square matrix.
    pub fn new(matrix: &Matrix) -> Factors {
        let entries = matrix.as_slice();
        let are_few =
            || entries.iter().filter(|entry| **entry != 0.0).count() * SPARE <= entries.len();
        Factors(if matrix.nrows() >= FEW && are_few() {
            Stored::Lists(Lists::new(matrix))
        } else {
            Stored::Full(Box::new(matrix.clone().lu()))
        })
    }

    /// Solves in place. False when the matrix is singular to working precision or the solution is
    /// not finite.
    pub fn solve(&self, right_side: &mut Vector) -> bool {
        let solved = match &self.0 {
            Stored::Full(factors) => factors.solve_mut(right_side),
            Stored::Lists(factors) => factors.solve(right_side),
        };
        solved && right_side.iter().all(|x| x.is_finite())
    }

    /// Inverse of the matrix, `None` when it is singular.
    pub fn inverse(&self) -> Option<Matrix> {
        let factors = match &self.0 {
            Stored::Full(factors) => return factors.try_inverse(),
            Stored::Lists(factors) => factors,
        };
        let mut inverse = Matrix::identity(factors.upper.len(), factors.upper.len());
        for mut column in inverse.column_iter_mut() {
            let mut right = column.clone_owned();
            if !factors.solve(&mut right) {
                return None;
            }
            column.copy_from(&right);
        }
        Some(inverse)
    }
}

/// row − factor·pivot beyond the first column of both.
fn eliminated(row: &List, factor: f64, pivot: &List) -> List {
    let (mut row, mut pivot) = (row[1..].iter().peekable(), pivot[1..].iter().peekable());
    let mut list = Vec::with_capacity(row.len() + pivot.len());
    loop {
        let at = |entry: Option<&&(usize, f64)>| entry.map_or(usize::MAX, |entry| entry.0);
        let (own, other) = (at(row.peek()), at(pivot.peek()));
        let column = own.min(other);
        if column == usize::MAX {
            return list;
        }
        let mut value = 0.0;
        if own == column {
            value = row.next().map_or(0.0, |entry| entry.1);
        }
        if other == column {
            value -= factor * pivot.next().map_or(0.0, |entry| entry.1);
        }
        list.push((column, value));
    }
}

impl Lists {
    fn new(matrix: &Matrix) -> Lists {
        let size = matrix.nrows();
        let mut rows: Vec<List> = vec![Vec::new(); size];
        for (column, entries) in matrix.as_slice().chunks_exact(size).enumerate() {
            for (row, entry) in entries.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                rows[row].push((column, *entry));
            }
        }
        // the rows that are left, by the column of their first entry that is not zero
        let mut beginning: Vec<Vec<usize>> = vec![Vec::new(); size];
        let begins = |list: &mut List, row: usize, beginning: &mut Vec<Vec<usize>>| {
            let zeros = list.iter().take_while(|(_, entry)| *entry == 0.0).count();
            list.drain(..zeros);
            if let Some((column, _)) = list.first() {
                beginning[*column].push(row);
            }
        };
        for (row, list) in rows.iter_mut().enumerate() {
            begins(list, row, &mut beginning);
        }
        let mut factors = Lists {
            pivots: Vec::with_capacity(size),
            upper: Vec::with_capacity(size),
        };
        for column in 0..size {
            let mut here = std::mem::take(&mut beginning[column]);
            here.sort_unstable();
            let first = |row: &usize| rows[*row][0].1.abs();
            let largest = here.iter().map(first).fold(0.0, f64::max);
            let places = (0..here.len()).filter(|place| first(&here[*place]) >= LEAST * largest);
            let Some(place) = places.min_by_key(|place| rows[here[*place]].len()) else {
                // singular: no solution is asked for again
                factors.pivots.push((column, Vec::new()));
                factors.upper.push(Vec::new());
                continue;
            };
            let row = here.remove(place);
            let pivot = std::mem::take(&mut rows[row]);
            let mut taken = Vec::with_capacity(here.len());
            for other in here {
                let factor = rows[other][0].1 / pivot[0].1;
                let mut list = eliminated(&rows[other], factor, &pivot);
                begins(&mut list, other, &mut beginning);
                rows[other] = list;
                taken.push((other, factor));
            }
            factors.pivots.push((row, taken));
            factors.upper.push(pivot);
        }
        factors
    }

    /// Solves in place; false where a pivot is missing.
    fn solve(&self, right_side: &mut Vector) -> bool {
        if self.upper.iter().any(Vec::is_empty) {
            return false;
        }
        for (row, taken) in &self.pivots {
            let known = right_side[*row];
            for (other, factor) in taken {
                right_side[*other] -= factor * known;
            }
        }
        let mut solution = Vector::zeros(self.upper.len());
        for (column, (list, (row, _))) in self.upper.iter().zip(&self.pivots).enumerate().rev() {
            let rest = list[1..].iter();
            let rest: f64 = rest.map(|(column, by)| by * solution[*column]).sum();
            solution[column] = (right_side[*row] - rest) / list[0].1;
        }
        right_side.copy_from(&solution);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equations of an orbit: blocks on the diagonal and beside it, the last tied to the first, and a full border.
    fn cyclic(blocks: usize, size: usize) -> Matrix {
        let n = blocks * size + 1;
        let entry = |row: usize, column: usize| {
            let place = (7 * row * row + 13 * column + 5 * row * column + 1) as f64;
            let entry = place.sqrt().fract() - 0.5;
            // a tangent of length one
            if row == n - 1 { 0.05 * entry } else { entry }
        };
        Matrix::from_fn(n, n, |row, column| {
            let (own, other) = (row / size, column / size);
            let next = (own + 1) % blocks;
            let border = row == n - 1 || column == n - 1;
            match border || other == own || other == next {
                true => entry(row, column),
                false => 0.0,
            }
        })
    }

    /// What solves the equations leaves no more than rounding: n of ε times the sizes of a row, as Wilkinson has it, times what one
    /// elimination may add.
    #[test]
    fn lists_solve_what_full_factors_solve() {
        let matrix = cyclic(40, 4);
        let n = matrix.nrows();
        let factors = Factors::new(&matrix);
        assert!(matches!(factors.0, Stored::Lists(_)));
        let right = Vector::from_fn(n, |row, _| (row as f64).cos());
        let mut solution = right.clone();
        assert!(factors.solve(&mut solution));
        let residual = (&matrix * &solution - &right).abs();
        let size = matrix.abs() * solution.abs();
        for (residual, size) in residual.iter().zip(&size) {
            assert!(
                *residual <= 11.0 * n as f64 * f64::EPSILON * size,
                "{residual:e}"
            );
        }
        let inverse = factors.inverse().unwrap();
        let mut full = right;
        assert!(matrix.lu().solve_mut(&mut full));
        let condition = inverse.abs().row_sum().amax();
        assert!(
            (inverse * Vector::from_fn(n, |row, _| (row as f64).cos()) - &full).amax()
                < 1e-10 * condition
        );
        assert!((solution - &full).amax() < 1e-10 * condition);
    }

    /// Lists stay as short as the zones that meet in them: the pivot's own, the next, the last and the border.
    #[test]
    fn factors_grow_with_the_zones() {
        for blocks in [40, 80, 160] {
            let Stored::Lists(lists) = Factors::new(&cyclic(blocks, 4)).0 else {
                panic!("a full matrix");
            };
            let longest = lists.upper.iter().map(Vec::len).max();
            assert!(longest <= Some(3 * 4 + 1));
            let taken = lists.pivots.iter().map(|(_, taken)| taken.len()).max();
            assert!(taken <= Some(2 * 4 + 1));
        }
    }

    /// A column that follows from others has no pivot, and no solution is given.
    #[test]
    fn singular_matrices_are_told() {
        let mut matrix = cyclic(40, 4);
        let column = matrix.column(5).clone_owned();
        matrix.column_mut(6).copy_from(&column);
        let mut right = Vector::repeat(matrix.nrows(), 1.0);
        let solved = Factors::new(&matrix).solve(&mut right);
        assert!(!solved || right.amax() > 1e12);
    }
}
