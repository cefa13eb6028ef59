//! LU factors of square matrices.
//!
//! Small or full ones are those of nalgebra. The equations of an orbit of many zones tie each zone to the next, the last to the
//! first, and all to few unknowns: nearly all entries are zero. There rows are kept as lists, and each is eliminated when its first
//! entry is that of the pivot: the work is in proportion to the zones. The pivot is the shortest of the rows whose entry in the column is
//! large enough, for a row with entries in all columns, as that of a tangent, would make others as long as itself.

use std::sync::Arc;

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

/// Entries of a row that are not zero.
#[derive(Clone, Debug)]
struct EntryList {
    /// Their columns, in order: rows of one zone soon share them.
    columns: Arc<[usize]>,
    /// Their values.
    values: Vec<f64>,
    /// How many at the beginning count no more.
    gone: usize,
}

/// The columns of two rows beyond the first of both, and where in these those of each are.
struct Union {
    /// The columns of the first row.
    of: Arc<[usize]>,
    columns: Arc<[usize]>,
    own: Vec<usize>,
    other: Vec<usize>,
}

/// Factors by rows.
#[derive(Clone, Debug)]
struct Lists {
    /// In the order of the columns: the row that is the pivot of each, and what of it is taken from which other rows.
    pivots: Vec<(usize, Vec<(usize, f64)>)>,
    /// The rows of U, each with its pivot first; empty where a column has none.
    upper: Vec<EntryList>,
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
            // the library reads a first entry, which a matrix of no rows does not have
            Stored::Full(factors) => right_side.is_empty() || factors.solve_mut(right_side),
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

impl EntryList {
    fn new(columns: Vec<usize>, values: Vec<f64>) -> EntryList {
        EntryList {
            columns: columns.into(),
            values,
            gone: 0,
        }
    }

    fn columns(&self) -> &[usize] {
        &self.columns[self.gone..]
    }

    fn values(&self) -> &[f64] {
        &self.values[self.gone..]
    }

    /// self − factor·pivot beyond the first column of both; `union` is that of the last row.
    fn take(&mut self, factor: f64, pivot: &EntryList, union: &mut Option<Union>) {
        if self.columns() == pivot.columns() {
            let own = &mut self.values[self.gone..];
            for (own, other) in own.iter_mut().zip(pivot.values()) {
                *own -= factor * other;
            }
            self.gone += 1;
            return;
        }
        let known = union.take().filter(|union| *union.of == *self.columns());
        let known = known.unwrap_or_else(|| Union::new(self.columns(), pivot.columns()));
        let mut values = vec![0.0; known.columns.len()];
        for (place, value) in known.own.iter().zip(&self.values()[1..]) {
            values[*place] = *value;
        }
        for (place, value) in known.other.iter().zip(&pivot.values()[1..]) {
            values[*place] -= factor * value;
        }
        *self = EntryList {
            columns: known.columns.clone(),
            values,
            gone: 0,
        };
        *union = Some(known);
    }
}

impl Union {
    fn new(of: &[usize], pivot: &[usize]) -> Union {
        let (own, other) = (&of[1..], &pivot[1..]);
        let mut columns = Vec::with_capacity(own.len() + other.len());
        let mut places = [own, other].map(|columns| Vec::with_capacity(columns.len()));
        let (mut here, mut there) = (own.iter().peekable(), other.iter().peekable());
        loop {
            let at = |entry: Option<&&usize>| entry.map_or(usize::MAX, |column| **column);
            let next = [at(here.peek()), at(there.peek())];
            let column = next[0].min(next[1]);
            if column == usize::MAX {
                break;
            }
            if here.next_if(|one| **one == column).is_some() {
                places[0].push(columns.len());
            }
            if there.next_if(|one| **one == column).is_some() {
                places[1].push(columns.len());
            }
            columns.push(column);
        }
        let [own, other] = places;
        Union {
            of: of.into(),
            columns: columns.into(),
            own,
            other,
        }
    }
}

impl Lists {
    fn new(matrix: &Matrix) -> Lists {
        let size = matrix.nrows();
        let mut counts = vec![0; size];
        for (place, entry) in matrix.as_slice().iter().enumerate() {
            counts[place % size] += usize::from(*entry != 0.0);
        }
        let room = |count| (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut rows: Vec<(Vec<usize>, Vec<f64>)> = counts.into_iter().map(room).collect();
        for (column, entries) in matrix.as_slice().chunks_exact(size).enumerate() {
            for (row, entry) in entries.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                rows[row].0.push(column);
                rows[row].1.push(*entry);
            }
        }
        let rows = rows.into_iter();
        let mut rows: Vec<EntryList> = rows
            .map(|(at, entries)| EntryList::new(at, entries))
            .collect();
        // the rows that are left, by the column of their first entry that is not zero
        let mut beginning: Vec<Vec<usize>> = vec![Vec::new(); size];
        let begins = |list: &mut EntryList, row: usize, beginning: &mut Vec<Vec<usize>>| {
            list.gone += list.values().iter().take_while(|x| **x == 0.0).count();
            if let Some(column) = list.columns().first() {
                beginning[*column].push(row);
            }
        };
        for (row, list) in rows.iter_mut().enumerate() {
            begins(list, row, &mut beginning);
        }
        let none = EntryList::new(Vec::new(), Vec::new());
        let mut factors = Lists {
            pivots: Vec::with_capacity(size),
            upper: Vec::with_capacity(size),
        };
        for column in 0..size {
            let mut here = std::mem::take(&mut beginning[column]);
            here.sort_unstable();
            let first = |row: &usize| rows[*row].values()[0].abs();
            let largest = here.iter().map(first).fold(0.0, f64::max);
            let places = (0..here.len()).filter(|place| first(&here[*place]) >= LEAST * largest);
            let Some(place) = places.min_by_key(|place| rows[here[*place]].values().len()) else {
                // singular: no solution is asked for again
                factors.pivots.push((column, Vec::new()));
                factors.upper.push(none.clone());
                continue;
            };
            let row = here.remove(place);
            let pivot = std::mem::replace(&mut rows[row], none.clone());
            let mut union = None;
            let mut taken = Vec::with_capacity(here.len());
            for other in here {
                let list = &mut rows[other];
                let factor = list.values()[0] / pivot.values()[0];
                list.take(factor, &pivot, &mut union);
                begins(list, other, &mut beginning);
                taken.push((other, factor));
            }
            factors.pivots.push((row, taken));
            factors.upper.push(pivot);
        }
        factors
    }

    /// Solves in place; false where a pivot is missing.
    fn solve(&self, right_side: &mut Vector) -> bool {
        if self.upper.iter().any(|list| list.values().is_empty()) {
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
            let rest = list.columns()[1..].iter().zip(&list.values()[1..]);
            let rest: f64 = rest.map(|(column, by)| by * solution[*column]).sum();
            solution[column] = (right_side[*row] - rest) / list.values()[0];
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
            let longest = lists.upper.iter().map(|list| list.values().len()).max();
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
