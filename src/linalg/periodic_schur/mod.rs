//! Eigenvalues of a product of matrices from its factors, without the product.
//!
//! Unitary Q₀ … Q_K = Q₀ make every Q*ₖ₊₁AₖQₖ upper triangular, the periodic Schur form of Bojanczyk, Golub and Van
//! Dooren (1992): eigenvalues of A_K⋯A₁ are products of its diagonals. It is reached from the periodic
//! Hessenberg-triangular form by sweeps with and without shifts (Kressner 2001), every one of which is backward stable in
//! every factor: a product whose factors grow and shrink keeps its small eigenvalues as its large ones.
//!
//! Factors are real, and sweeps in real arithmetic take them apart into blocks of one and two. The form is complex where pairs are
//! left, and what is real or conjugate in it is told at the end. An eigenvalue has a bound of its own:
//! with periodic vectors Aₖxₖ = αₖxₖ₊₁ and y*ₖ₊₁Aₖ = αₖy*ₖ, y*ₖxₖ = 1, errors Eₖ of the factors move it by ∑ₖ y*ₖ₊₁Eₖxₖ ∏αₗ/αₖ.

mod chain;
mod discs;
mod double_shift;
mod pairs;
mod product;
mod reflections;
mod scaling;
mod singular;
#[cfg(test)]
mod tests;
mod vectors;

pub use scaling::{balance, units_along};
pub use singular::{Factor, regular_part};

use chain::Chain;
use discs::bounded;
use pairs::{ordered, resolved};
use product::{Number, Product, Scalar, size, times_power};
use vectors::Diagonals;

/// An eigenvalue z·2ᵉ: products of many factors leave the range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProductEigenvalue {
    /// z, of modulus 1 to 2, or 0.
    pub mantissa: Number,
    /// e.
    pub exponent: i64,
    /// Natural logarithm of the radius of a disc about it that holds the eigenvalue of the product of the exact factors.
    pub log_error: f64,
}

impl ProductEigenvalue {
    /// Its value, 0 or infinite where that is no number.
    pub fn value(&self) -> Number {
        times_power(self.mantissa, self.exponent)
    }

    /// Natural logarithm of its modulus.
    pub fn log_modulus(&self) -> f64 {
        self.mantissa.norm().ln() + self.exponent as f64 * std::f64::consts::LN_2
    }

    /// Radius of its disc.
    pub fn error(&self) -> f64 {
        self.log_error.exp()
    }

    /// Its value over a power of two.
    fn value_over(&self, exponent: i64) -> Number {
        times_power(self.mantissa, self.exponent - exponent)
    }

    /// Radius of its disc over a power of two.
    fn error_over(&self, exponent: i64) -> f64 {
        (self.log_error - exponent as f64 * std::f64::consts::LN_2).exp()
    }

    fn new(number: Number, exponent: i64) -> ProductEigenvalue {
        let mut product = Product { number, exponent };
        product.normalise();
        ProductEigenvalue {
            mantissa: product.number,
            exponent: product.exponent,
            log_error: f64::NEG_INFINITY,
        }
    }
}

/// What a turn leaves in a factor relative to its norm.
const TURN: f64 = 2.0 * f64::EPSILON;

/// The factors in their order round, the last of which is the one that is least triangular: it need not become so at first.
fn begun_after_the_fullest(factors: &[Factor], n: usize) -> Vec<&Factor> {
    let below = |one: &Factor| {
        let column = |j: usize| {
            let below = &one.matrix.as_slice()[j * n + j + 1..(j + 1) * n];
            below.iter().map(|x| usize::from(*x != 0.0)).sum::<usize>()
        };
        (0..n).map(column).sum::<usize>()
    };
    let full = (0..factors.len()).max_by_key(|index| below(&factors[*index]));
    let first = full.map_or(0, |full| full + 1);
    let round = factors.iter().cycle().skip(first);
    round.take(factors.len()).collect()
}

/// Eigenvalues of the product of square factors, the first of which acts first; the largest first, of a conjugate pair
/// that above the real axis. Those of no factor or of no dimension are none.
pub fn eigenvalues(factors: &[Factor]) -> Vec<ProductEigenvalue> {
    let Some(n) = factors
        .first()
        .map(|one| one.matrix.nrows())
        .filter(|n| *n > 0)
    else {
        return Vec::new();
    };
    let factors = begun_after_the_fullest(factors, n);
    let mut real = Chain::of(&factors, n);
    let mut pairs = Vec::new();
    if n > 1 {
        real.reduce();
        pairs = real.take_apart();
    }
    if real.is_triangular() {
        return of_diagonals(&real, &factors, &pairs, 0.0);
    }
    let mut chain = real.complex();
    let left_out = chain.triangularise();
    of_diagonals(&chain, &factors, &pairs, left_out)
}

/// The eigenvalues of a product of triangular factors with their discs. It is told where conjugate pairs begin, both eigenvalues
/// of which move by as much, and what had to be left out of the last factor, relative to its norm.
fn of_diagonals<T: Scalar>(
    chain: &Chain<T>,
    factors: &[&Factor],
    pairs: &[usize],
    left_out: f64,
) -> Vec<ProductEigenvalue> {
    let error = |(index, factor): (usize, &&Factor)| {
        let last = if index + 1 == chain.count {
            left_out
        } else {
            0.0
        };
        factor.size * (factor.error + last + TURN * chain.turns as f64)
    };
    let errors: Vec<f64> = factors.iter().enumerate().map(error).collect();
    let diagonals = Diagonals::of(chain);
    let mut log_error = f64::INFINITY;
    let eigenvalue = |j: usize| {
        if !(j > 0 && pairs.contains(&(j - 1))) {
            let [right, left] = chain.vectors(j, &diagonals);
            let moved = |k: usize| errors[k] * right[k] * left[k];
            log_error = radius(&diagonals.own[j], moved);
        }
        let Product { number, exponent } = diagonals.products[j];
        ProductEigenvalue {
            log_error,
            ..ProductEigenvalue::new(number, exponent)
        }
    };
    let all = (0..chain.n).map(eigenvalue).collect();
    let all = bounded(chain, &errors, all);
    ordered(resolved(all))
}

/// The logarithm of ∏(|αₖ| + δₖ) − ∏|αₖ|.
fn radius<T: Scalar>(diagonal: &[T], moved: impl Fn(usize) -> f64) -> f64 {
    let (mut log, mut growth) = (0.0, 0.0);
    for (k, entry) in diagonal.iter().enumerate() {
        let (size, by) = (size(*entry), moved(k));
        let sum = size + by;
        if sum.is_nan() {
            return f64::INFINITY;
        }
        log += sum.ln();
        growth += (by / size).ln_1p();
    }
    // ∏(|α| + δ)·(1 − 1/∏(1 + δ/|α|))
    if growth.is_nan() {
        return log;
    }
    log + (-(-growth).exp_m1()).ln()
}
