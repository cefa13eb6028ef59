//! Linear forms of z and matrices, with their derivatives in the parameters that vary.

use super::dual::{Dual, VARYING};
use crate::linalg::{Matrix, Vector, add_product};

/// A linear form in z with its derivatives in the parameters that vary.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its coefficients.
    pub at: Vector,
    /// Their derivatives.
    pub by: [Vector; VARYING],
}

impl Row {
    pub(super) fn zero(size: usize) -> Row {
        let zero = Vector::zeros(size);
        Row {
            by: [zero.clone(), zero.clone()],
            at: zero,
        }
    }

    /// The component of z with this index.
    pub(super) fn unit(size: usize, index: usize) -> Row {
        let mut row = Row::zero(size);
        row.at[index] = 1.0;
        row
    }

    /// Leads it to a value of the parameter in which it is affine; `origin` is it at zero. False where an entry that changes
    /// is zero by chance, or not finite.
    pub(super) fn lead(&mut self, origin: &Row, value: f64) -> bool {
        let entries = (origin.at.as_slice(), origin.by[0].as_slice());
        led(self.at.as_mut_slice(), entries, value)
    }

    pub(super) fn set(&mut self, column: usize, value: Dual) {
        self.at[column] = value.value;
        for (by, derivative) in self.by.iter_mut().zip(value.by) {
            by[column] = derivative;
        }
    }

    pub(super) fn add(&mut self, column: usize, value: Dual) {
        self.at[column] += value.value;
        for (by, derivative) in self.by.iter_mut().zip(value.by) {
            by[column] += derivative;
        }
    }

    /// Coefficient of a component of z.
    pub(super) fn dual(&self, column: usize) -> Dual {
        let by = self.by.each_ref().map(|by| by[column]);
        Dual::new(self.at[column], by)
    }

    /// Its value at z. Components that it does not have may have none.
    pub(super) fn value(&self, z: &Vector) -> f64 {
        let terms = self.at.iter().zip(z).filter(|(c, _)| **c != 0.0);
        terms.map(|(c, z)| c * z).sum()
    }

    /// Sum of the sizes of its terms at z.
    pub(super) fn size(&self, z: &Vector) -> f64 {
        let terms = self.at.iter().zip(z).filter(|(c, _)| **c != 0.0);
        terms.map(|(c, z)| (c * z).abs()).sum()
    }

    /// Takes another form times a factor away.
    pub(super) fn subtract(&mut self, factor: Dual, other: &Row) {
        if factor == Dual::default() {
            return;
        }
        for (by, (slope, other_by)) in self.by.iter_mut().zip(factor.by.iter().zip(&other.by)) {
            by.axpy(-factor.value, other_by, 1.0);
            if *slope != 0.0 {
                by.axpy(-slope, &other.at, 1.0);
            }
        }
        self.at.axpy(-factor.value, &other.at, 1.0);
    }

    /// Whether it depends on a component of z.
    pub(super) fn has(&self, column: usize) -> bool {
        self.at[column] != 0.0 || self.by.iter().any(|by| by[column] != 0.0)
    }

    /// cᵀM with derivatives: the rate of a form of states and phase.
    pub(super) fn through(&self, matrix: &MatrixBy) -> Row {
        let mut through = Row::zero(matrix.at.ncols());
        self.add_through(matrix, &mut through);
        through
    }

    /// The same in place of another form of this length.
    pub(super) fn put_through(&self, matrix: &MatrixBy, through: &mut Row) {
        through.at.fill(0.0);
        through.by.iter_mut().for_each(|by| by.fill(0.0));
        self.add_through(matrix, through);
    }

    fn add_through(&self, matrix: &MatrixBy, through: &mut Row) {
        let add = |row: &Vector, matrix: &Matrix, sum: &mut Vector| {
            let (row, matrix) = (row.as_slice(), matrix.as_slice());
            add_product(1.0, row, 1, matrix, sum.as_mut_slice());
        };
        add(&self.at, &matrix.at, &mut through.at);
        // most derivatives are zero: those of a parameter that does not vary all are
        for p in 0..VARYING {
            if self.by[p].as_slice().iter().any(|by| *by != 0.0) {
                add(&self.by[p], &matrix.at, &mut through.by[p]);
            }
            if matrix.by[p].as_slice().iter().any(|by| *by != 0.0) {
                add(&self.at, &matrix.by[p], &mut through.by[p]);
            }
        }
    }

    pub(super) fn negative(&self) -> Row {
        Row {
            at: -&self.at,
            by: self.by.each_ref().map(|by| -by),
        }
    }
}

/// A matrix with its derivatives in the parameters that vary.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixBy {
    /// Its entries.
    pub at: Matrix,
    /// Their derivatives.
    pub by: [Matrix; VARYING],
}

/// Leads entries from those at zero by their slopes.
fn led(at: &mut [f64], (origin, by): (&[f64], &[f64]), value: f64) -> bool {
    let mut regular = true;
    for ((at, origin), by) in at.iter_mut().zip(origin).zip(by) {
        if *by != 0.0 {
            *at = origin + value * by;
            regular &= *at != 0.0 && at.is_finite();
        }
    }
    regular
}

impl MatrixBy {
    /// See [`Row::lead`].
    pub(super) fn lead(&mut self, origin: &MatrixBy, value: f64) -> bool {
        let entries = (origin.at.as_slice(), origin.by[0].as_slice());
        led(self.at.as_mut_slice(), entries, value)
    }

    pub(super) fn zero(rows: usize, columns: usize) -> MatrixBy {
        let zero = Matrix::zeros(rows, columns);
        MatrixBy {
            by: [zero.clone(), zero.clone()],
            at: zero,
        }
    }

    pub(super) fn add(&mut self, row: usize, column: usize, value: Dual) {
        self.at[(row, column)] += value.value;
        for (by, derivative) in self.by.iter_mut().zip(value.by) {
            by[(row, column)] += derivative;
        }
    }

    pub(super) fn set_row(&mut self, row: usize, values: &Row) {
        self.at.row_mut(row).tr_copy_from(&values.at);
        for (by, values) in self.by.iter_mut().zip(&values.by) {
            by.row_mut(row).tr_copy_from(values);
        }
    }

    /// A row times z. Components that it does not have may have no value.
    pub(super) fn value(&self, row: usize, z: &Vector) -> f64 {
        let terms = self
            .at
            .row(row)
            .into_iter()
            .zip(z)
            .filter(|(c, _)| **c != 0.0);
        terms.map(|(c, z)| c * z).sum::<f64>()
    }

    pub(super) fn row(&self, row: usize) -> Row {
        Row {
            at: self.at.row(row).transpose(),
            by: self.by.each_ref().map(|by| by.row(row).transpose()),
        }
    }
}
