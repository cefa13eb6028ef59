//! Complex numbers with their derivative in λ: arithmetic, determinants, and roots of polynomials.

use std::ops::{Add, Mul, Sub};

use super::perturbation::ScaledComplex;
use super::{C64, ZERO};

/// A complex number with its derivative in λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct ComplexDual {
    pub(super) at: C64,
    pub(super) by: C64,
}

impl ComplexDual {
    pub(super) fn constant(at: impl Into<C64>) -> ComplexDual {
        ComplexDual {
            at: at.into(),
            by: ZERO,
        }
    }

    pub(super) fn inverse(self) -> ComplexDual {
        let at = self.at.inv();
        ComplexDual {
            at,
            by: -self.by * at * at,
        }
    }

    pub(super) fn exp(self) -> ComplexDual {
        let at = self.at.exp();
        ComplexDual {
            at,
            by: self.by * at,
        }
    }
}

impl Add for ComplexDual {
    type Output = ComplexDual;
    fn add(self, other: ComplexDual) -> ComplexDual {
        ComplexDual {
            at: self.at + other.at,
            by: self.by + other.by,
        }
    }
}

impl Sub for ComplexDual {
    type Output = ComplexDual;
    fn sub(self, other: ComplexDual) -> ComplexDual {
        ComplexDual {
            at: self.at - other.at,
            by: self.by - other.by,
        }
    }
}

impl Mul for ComplexDual {
    type Output = ComplexDual;
    fn mul(self, other: ComplexDual) -> ComplexDual {
        ComplexDual {
            at: self.at * other.at,
            by: self.by * other.at + self.at * other.by,
        }
    }
}

impl Mul<f64> for ComplexDual {
    type Output = ComplexDual;
    fn mul(self, factor: f64) -> ComplexDual {
        ComplexDual {
            at: self.at * factor,
            by: self.by * factor,
        }
    }
}

/// Columns below this are scaled up: the squares of their entries come near the limits of double precision.
const FAINT: f64 = 1e-100;

/// A determinant with its derivative, by elimination with the largest pivots of the columns of rows of
/// equal size.
pub(super) fn determinant(mut rows: Vec<Vec<ComplexDual>>) -> ScaledComplex {
    let count = rows.len();
    let mut product = ScaledComplex::ONE;
    for row in &mut rows {
        let size = row
            .iter()
            .fold(0.0_f64, |size, x| size.max(x.at.norm_sqr()));
        if size > 0.0 && size.is_finite() {
            let factor = size.sqrt().recip();
            row.iter_mut().for_each(|x| *x = *x * factor);
            product.exponent += 0.5 * size.ln();
        }
    }
    for index in 0..count {
        // a layer that has died away since the entry of its zone leaves entries whose squares vanish
        let most = rows[index..].iter().fold(0.0_f64, |most, row| {
            most.max(row[index].at.re.abs()).max(row[index].at.im.abs())
        });
        if most > 0.0 && most < FAINT {
            for row in &mut rows[index..] {
                row[index] = row[index] * most.recip();
            }
            product.exponent += most.ln();
        }
        let size = |row: &Vec<ComplexDual>| row[index].at.norm_sqr();
        let largest = (index..count)
            .max_by(|&one, &other| size(&rows[one]).total_cmp(&size(&rows[other])))
            .unwrap_or(index);
        if largest != index {
            rows.swap(largest, index);
            product.value = -product.value;
            product.derivative = -product.derivative;
        }
        let (done, left) = rows.split_at_mut(index + 1);
        let pivot = &done[index];
        product = product.times(ScaledComplex {
            value: pivot[index].at,
            derivative: pivot[index].by,
            exponent: 0.0,
        });
        let inverse = pivot[index].inverse();
        for row in left {
            if row[index].at == ZERO && row[index].by == ZERO {
                continue;
            }
            let factor = row[index] * inverse;
            for (entry, one) in row[index + 1..].iter_mut().zip(&pivot[index + 1..]) {
                *entry = *entry - factor * *one;
            }
        }
    }
    product
}

/// The inverse of a matrix by elimination with the largest pivots; `None` if it has none.
pub(super) fn inverse(mut rows: Vec<Vec<ComplexDual>>) -> Option<Vec<Vec<ComplexDual>>> {
    let count = rows.len();
    for (index, row) in rows.iter_mut().enumerate() {
        row.extend(
            (0..count).map(|column| ComplexDual::constant(f64::from(u8::from(column == index)))),
        );
    }
    for index in 0..count {
        let size = |row: usize| rows[row][index].at.norm_sqr();
        let largest = (index..count).max_by(|&one, &other| size(one).total_cmp(&size(other)))?;
        rows.swap(largest, index);
        let pivot = rows[index][index].inverse();
        if !pivot.at.is_finite() {
            return None;
        }
        for entry in &mut rows[index] {
            *entry = *entry * pivot;
        }
        let done = rows[index].clone();
        for (other, row) in rows.iter_mut().enumerate() {
            let factor = row[index];
            if other != index {
                for (entry, one) in row.iter_mut().zip(&done) {
                    *entry = *entry - factor * *one;
                }
            }
        }
    }
    Some(rows.into_iter().map(|row| row[count..].to_vec()).collect())
}

/// Most steps of the root search, and the last one relative to the root.
const MOST_STEPS: usize = 40;
const LAST_STEP: f64 = 1e-13;

/// All roots of a polynomial by the method of Aberth and Ehrlich from starts near them.
pub(super) fn simultaneous(mut roots: Vec<C64>, value: impl Fn(C64) -> ComplexDual) -> Vec<C64> {
    for _ in 0..MOST_STEPS {
        let mut found = true;
        for index in 0..roots.len() {
            let r = roots[index];
            let ComplexDual { at, by } = value(r);
            let others = roots.iter().filter(|other| **other != r);
            let repelled: C64 = others.map(|other| (r - other).inv()).sum();
            let step = at / (by - at * repelled);
            if !step.is_finite() {
                continue;
            }
            roots[index] = r - step;
            found &= step.norm_sqr() <= LAST_STEP * LAST_STEP * r.norm_sqr();
        }
        if found {
            break;
        }
    }
    roots
}
