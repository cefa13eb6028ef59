//! Discs about eigenvalues that are so near to one another that their vectors tell nothing: of one that is double and has one vector
//! errors of the factors move each by their root.
//!
//! In units dⱼ = gʲ of the components of the triangular form what is above the diagonal is as small as one likes, and errors below it
//! grow: Gershgorin's discs of the product hold the eigenvalues for every g, and the smallest are taken.

use super::ProductEigenvalue;
use super::chain::Chain;
use super::product::{Number, Scalar, size};
use crate::linalg::Matrix;

/// Units of one component in those of the one before.
const GRADES: [f64; 9] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

/// Eigenvalues with the smallest of their discs, by their vectors or, where these tell nothing, by graded units. Very small ones may be
/// anything within the norm of all factors.
pub(super) fn bounded<T: Scalar>(
    chain: &Chain<T>,
    errors: &[f64],
    mut all: Vec<ProductEigenvalue>,
) -> Vec<ProductEigenvalue> {
    let open: Vec<usize> = (0..all.len())
        .filter(|index| !is_apart(*index, &all))
        .collect();
    if open.is_empty() {
        return all;
    }
    let product = ProductWithErrors::of(chain, errors);
    for grade in GRADES {
        let product = product.graded(grade);
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

/// The product of all factors, over a power that keeps it a number. All by columns.
struct ProductWithErrors<T> {
    /// Its dimensions.
    n: usize,
    /// Its triangular form.
    triangular: Vec<T>,
    /// The moduli of its entries.
    moduli: Vec<f64>,
    /// The product of the moduli of all entries of the factors.
    sizes: Vec<f64>,
    /// What errors of the factors change in it, by entries.
    off: Vec<f64>,
    /// Logarithm of that power.
    log: f64,
}

impl<T: Scalar> ProductWithErrors<T> {
    fn of(chain: &Chain<T>, errors: &[f64]) -> ProductWithErrors<T> {
        let n = chain.n;
        let identity = Matrix::identity(n, n);
        let mut product = ProductWithErrors {
            n,
            triangular: identity.iter().map(|x| T::from_real(*x)).collect(),
            moduli: Vec::new(),
            sizes: identity.as_slice().to_vec(),
            off: vec![0.0; n * n],
            log: 0.0,
        };
        let factors = chain.entries.chunks_exact(n * n);
        for (factor, error) in factors.zip(errors) {
            product.times(factor, *error);
            let size = product.sizes.iter().fold(0.0, |most, x| x.max(most));
            if size.is_normal() {
                let over = size.recip();
                let real = product.sizes.iter_mut().chain(&mut product.off);
                real.for_each(|x| *x *= over);
                let entries = product.triangular.iter_mut();
                entries.for_each(|x| *x = x.scale(over));
                product.log += size.ln();
            }
        }
        product.moduli = product.triangular.iter().map(|x| size(*x)).collect();
        product
    }

    /// The product with a further factor.
    fn times(&mut self, factor: &[T], error: f64) {
        let n = self.n;
        let own: Vec<f64> = factor.iter().map(|entry| size(*entry)).collect();
        let columns = || factor.chunks_exact(n).zip(own.chunks_exact(n));
        let mut column = vec![T::zero(); n];
        let mut real = vec![0.0; n];
        let triangular = self.triangular.chunks_exact_mut(n);
        let sizes = self.sizes.chunks_exact_mut(n);
        let offs = self.off.chunks_exact_mut(n);
        for (j, ((product, sizes), offs)) in triangular.zip(sizes).zip(offs).enumerate() {
            // every entry of the factor may be wrong by as much
            let wrong = error * (sizes.iter().sum::<f64>() + offs.iter().sum::<f64>());
            real.fill(wrong);
            for (k, (off, (_, own))) in offs.iter().zip(columns()).enumerate() {
                let pairs = real.iter_mut().zip(own).take(k + 1);
                pairs.for_each(|(sum, entry)| *sum += entry * off);
            }
            offs.copy_from_slice(&real);
            real.fill(0.0);
            column.fill(T::zero());
            let terms = product.iter().zip(&*sizes).zip(columns()).take(j + 1);
            for (k, ((entry, size), (factor, own))) in terms.enumerate() {
                let pairs = column.iter_mut().zip(factor).take(k + 1);
                pairs.for_each(|(sum, each)| *sum += *each * *entry);
                let pairs = real.iter_mut().zip(own).take(k + 1);
                pairs.for_each(|(sum, each)| *sum += each * size);
            }
            sizes.copy_from_slice(&real);
            product.copy_from_slice(&column);
        }
    }

    /// The same in graded units: those of a product are those of its factors.
    fn graded(&self, grade: f64) -> GradedProduct {
        let n = self.n;
        let powers: Vec<f64> = (0..2 * n)
            .map(|place| grade.powi(place as i32 - n as i32))
            .collect();
        let zeros = || vec![0.0; n];
        let (mut norms, mut radii) = (zeros(), zeros());
        let columns = self.moduli.chunks_exact(n).zip(self.sizes.chunks_exact(n));
        let columns = columns.zip(self.off.chunks_exact(n)).enumerate();
        for (column, ((moduli, sizes), off)) in columns {
            let entries = moduli.iter().zip(sizes).zip(off).enumerate();
            let sums = norms.iter_mut().zip(&mut radii);
            for ((norm, radius), (row, ((modulus, size), off))) in sums.zip(entries) {
                let by = powers[n + column - row];
                let off = if *off == 0.0 { 0.0 } else { off * by };
                *norm += off;
                *radius += off;
                if row <= column {
                    *norm += size * by;
                }
                if row < column {
                    *radius += modulus * by;
                }
            }
        }
        let told = |number: f64| {
            if number.is_nan() {
                f64::INFINITY
            } else {
                number
            }
        };
        GradedProduct {
            own: self
                .triangular
                .iter()
                .step_by(n + 1)
                .map(|x| x.number())
                .collect(),
            norm: norms.into_iter().map(told).fold(0.0, f64::max),
            radii: radii.into_iter().map(told).collect(),
            log: self.log,
        }
    }
}

/// What is told of the product in graded units, over a power that keeps it a number.
struct GradedProduct {
    /// Its eigenvalues.
    own: Vec<Number>,
    /// The largest sum of a row, errors included.
    norm: f64,
    /// Radii of Gershgorin's discs.
    radii: Vec<f64>,
    /// Logarithm of that power.
    log: f64,
}

impl GradedProduct {
    /// Logarithm of its norm, errors included.
    fn log_norm(&self) -> f64 {
        self.norm.ln() + self.log
    }

    /// Logarithms of radii of discs about all eigenvalues. What lies in one of several discs that meet may lie in any of them.
    fn log_radii(&self) -> Vec<f64> {
        let GradedProduct { own, radii, .. } = self;
        let each = own.iter().zip(radii);
        let reach = |(value, radius): (&Number, &f64)| {
            let others = own.iter().zip(radii);
            let meets = others.map(|(other, reach)| ((value - other).norm(), *reach));
            let meets = meets.filter(|(apart, reach)| *apart <= radius + reach);
            meets
                .map(|(apart, reach)| apart + reach)
                .fold(*radius, f64::max)
        };
        each.map(|one| reach(one).ln() + self.log).collect()
    }
}
