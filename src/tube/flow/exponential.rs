//! The exponential of a 4 × 4 matrix with derivatives, by scaling and squaring of a Taylor polynomial.

use std::ops::{Add, Mul, Sub};

use nalgebra::{Complex, Matrix4, Scalar};

/// What matrices are made of: real or complex numbers.
pub trait Element:
    Scalar + Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + From<f64>
{
    /// The square of the modulus.
    fn square(self) -> f64;
    /// Multiplication by a real number.
    fn scaled(self, factor: f64) -> Self;
}

impl Element for f64 {
    fn square(self) -> f64 {
        self * self
    }
    fn scaled(self, factor: f64) -> f64 {
        self * factor
    }
}

impl Element for Complex<f64> {
    fn square(self) -> f64 {
        self.norm_sqr()
    }
    fn scaled(self, factor: f64) -> Complex<f64> {
        self * factor
    }
}

/// A matrix with its derivatives in D quantities, times e^{exponent}.
#[derive(Clone, Copy, Debug)]
pub struct MatrixJet<T: Element, const D: usize> {
    pub at: Matrix4<T>,
    pub by: [Matrix4<T>; D],
    /// Real exponent of the scale.
    pub exponent: f64,
}

/// Degree of the Taylor polynomial of exp(B), ‖B‖ ≤ 1: the remainder is 1/19! ≈ 8e-18.
const DEGREE: u32 = 18;

/// After a squaring the scale is taken out of a matrix with a square of entries beyond this, or below
/// its reciprocal.
const LARGE: f64 = 1e60;

/// A product, column by column: for complex numbers the general one of the library takes twice as long.
fn product<T: Element>(x: &Matrix4<T>, y: &Matrix4<T>) -> Matrix4<T> {
    let mut out = *x;
    for j in 0..4 {
        let mut column = [0, 1, 2, 3].map(|i| x[(i, 0)] * y[(0, j)]);
        for k in 1..4 {
            for (i, sum) in column.iter_mut().enumerate() {
                *sum = *sum + x[(i, k)] * y[(k, j)];
            }
        }
        for (i, sum) in column.into_iter().enumerate() {
            out[(i, j)] = sum;
        }
    }
    out
}

impl<T: Element, const D: usize> MatrixJet<T, D> {
    fn times(&self, other: &MatrixJet<T, D>) -> MatrixJet<T, D> {
        MatrixJet {
            at: product(&self.at, &other.at),
            by: std::array::from_fn(|i| {
                product(&self.by[i], &other.at).zip_map(&product(&self.at, &other.by[i]), Add::add)
            }),
            exponent: self.exponent + other.exponent,
        }
    }

    /// Matrix and derivatives times a number.
    pub(crate) fn scaled(&self, factor: f64) -> MatrixJet<T, D> {
        MatrixJet {
            at: self.at.map(|x| x.scaled(factor)),
            by: self.by.map(|by| by.map(|x| x.scaled(factor))),
            exponent: self.exponent,
        }
    }

    fn plus(&self, other: &MatrixJet<T, D>) -> MatrixJet<T, D> {
        MatrixJet {
            at: self.at.zip_map(&other.at, Add::add),
            by: std::array::from_fn(|i| self.by[i].zip_map(&other.by[i], Add::add)),
            exponent: self.exponent,
        }
    }

    /// Keeps the entries near one.
    fn normalised(self) -> MatrixJet<T, D> {
        let size = self.at.iter().fold(0.0_f64, |size, x| size.max(x.square()));
        if size > LARGE || size < LARGE.recip() && size > 0.0 {
            let shift = 0.5 * size.ln();
            return MatrixJet {
                exponent: self.exponent + shift,
                ..self.scaled((-shift).exp())
            };
        }
        self
    }

    /// exp(2ⁿB) of this matrix B, ‖B‖ ≤ 1, with its derivatives.
    pub(crate) fn exponential(&self, n: u32) -> MatrixJet<T, D> {
        let zero = T::from(0.0);
        let multiple = |factor: f64| MatrixJet {
            at: Matrix4::from_fn(|i, j| if i == j { T::from(factor) } else { zero }),
            by: [Matrix4::repeat(zero); D],
            exponent: 0.0,
        };
        let inverse_factorial = |j: u32| 1.0 / (1..=j).map(f64::from).product::<f64>();
        // Paterson–Stockmeyer: Σ B^j/j! as a cubic in B⁵ whose coefficients are quartic in B
        let b2 = self.times(self);
        let b3 = b2.times(self);
        let b4 = b2.times(&b2);
        let b5 = b4.times(self);
        let block = |first: u32| {
            let mut sum = multiple(inverse_factorial(first));
            for (offset, power) in [(1, self), (2, &b2), (3, &b3), (4, &b4)] {
                if first + offset <= DEGREE {
                    sum = sum.plus(&power.scaled(inverse_factorial(first + offset)));
                }
            }
            sum
        };
        let mut result = block(DEGREE / 5 * 5);
        for first in (0..DEGREE / 5).rev() {
            result = block(5 * first).plus(&b5.times(&result));
        }
        for _ in 0..n {
            result = result.times(&result).normalised();
        }
        result
    }
}
