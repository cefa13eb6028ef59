//! Discs about eigenvalues that are so near to one another that their vectors tell nothing: of one that is double and has one vector
//! errors of the factors move each by their root.
//!
//! In units dⱼ = gʲ of the components of the triangular form what is above the diagonal is as small as one likes, and errors below it
//! grow: Gershgorin's discs of the product hold the eigenvalues for every g, and the smallest are taken.

use super::ProductEigenvalue;
use super::chain::Chain;
use super::product::Number;
use crate::linalg::Matrix;

/// Units of one component in those of the one before.
const GRADES: [f64; 9] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

/// Eigenvalues with the smallest of their discs, by their vectors or, where these tell nothing, by graded units. Very small ones may be
/// anything within the norm of all factors.
pub(super) fn bounded(
    chain: &Chain<Number>,
    errors: &[f64],
    mut all: Vec<ProductEigenvalue>,
) -> Vec<ProductEigenvalue> {
    let open: Vec<usize> = (0..all.len())
        .filter(|index| !is_apart(*index, &all))
        .collect();
    if open.is_empty() {
        return all;
    }
    for grade in GRADES {
        let product = GradedProduct::of(chain, errors, grade);
        let radii = product.log_radii();
        // a disc about the eigenvalue that holds the one about 0
        let about_zero = product.log_norm() + std::f64::consts::LN_2;
        for index in &open {
            let one = &mut all[*index];
            one.log_error = one.log_error.min(radii[*index]).min(about_zero);
        }
    }
    all
}

/// Whether the disc of an eigenvalue by its vectors holds neither 0 nor a part of that of another one: where it does, these tell
/// nothing of it.
fn is_apart(index: usize, all: &[ProductEigenvalue]) -> bool {
    let one = &all[index];
    let unit = one.exponent;
    let error = |other: &ProductEigenvalue| other.error_over(unit);
    let apart = |(other, each): (usize, &ProductEigenvalue)| {
        let off = (each.value_over(unit) - one.mantissa).norm();
        other == index || off > error(one) + error(each)
    };
    one.log_error < one.log_modulus() && all.iter().enumerate().all(apart)
}

/// The product of all factors in graded units, over a power that keeps it a number.
struct GradedProduct {
    /// Its triangular form.
    triangular: Vec<Vec<Number>>,
    /// The same with the moduli of all entries of the factors.
    sizes: Matrix,
    /// What errors of the factors change in it, by entries.
    off: Matrix,
    /// Logarithm of that power.
    log: f64,
}

impl GradedProduct {
    fn of(chain: &Chain<Number>, errors: &[f64], grade: f64) -> GradedProduct {
        let n = chain.n;
        let by = |row: usize, column: usize| grade.powi(column as i32 - row as i32);
        let zero = Number::new(0.0, 0.0);
        let mut product = GradedProduct {
            triangular: (0..n)
                .map(|row| {
                    (0..n)
                        .map(|column| Number::new(f64::from(row == column), 0.0))
                        .collect()
                })
                .collect(),
            sizes: Matrix::identity(n, n),
            off: Matrix::zeros(n, n),
            log: 0.0,
        };
        for (factor, error) in errors.iter().enumerate() {
            let entry = |row: usize, column: usize| chain.at(factor, row, column) * by(row, column);
            let own = Matrix::from_fn(n, n, |row, column| entry(row, column).norm());
            let error = Matrix::from_fn(n, n, |row, column| error * by(row, column));
            product.off = (&own + &error) * &product.off + &error * &product.sizes;
            product.sizes = &own * &product.sizes;
            let times = |row: usize, column: usize| {
                let inner = row..=column;
                inner.fold(zero, |sum, k| {
                    sum + entry(row, k) * product.triangular[k][column]
                })
            };
            let triangular = (0..n).map(|row| (0..n).map(|column| times(row, column)).collect());
            product.triangular = triangular.collect();
            let size = product.sizes.amax();
            if size.is_normal() {
                product.sizes /= size;
                product.off /= size;
                let entries = product.triangular.iter_mut().flatten();
                entries.for_each(|entry| *entry /= size);
                product.log += size.ln();
            }
        }
        product
    }

    /// Logarithm of its norm, errors included.
    fn log_norm(&self) -> f64 {
        let rows = (&self.sizes + &self.off).column_sum();
        rows.amax().ln() + self.log
    }

    /// Logarithms of radii of discs about all eigenvalues. What lies in one of several discs that meet may lie in any of them.
    fn log_radii(&self) -> Vec<f64> {
        let n = self.sizes.nrows();
        let own = |row: usize| self.triangular[row][row];
        let radius = |row: usize| -> f64 {
            let above = self.triangular[row][row + 1..]
                .iter()
                .map(|entry| entry.norm());
            above.sum::<f64>() + self.off.row(row).sum()
        };
        let radii: Vec<f64> = (0..n).map(radius).collect();
        let reach = |row: usize| {
            let apart = |other: usize| (own(row) - own(other)).norm();
            let meets = (0..n).filter(|other| apart(*other) <= radii[row] + radii[*other]);
            meets
                .map(|other| apart(other) + radii[other])
                .fold(radii[row], f64::max)
        };
        (0..n).map(|row| reach(row).ln() + self.log).collect()
    }
}
