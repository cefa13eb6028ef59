//! What equations are written in: intervals, and intervals with derivatives to any order.
//!
//! A [`Gradient`] has a number and its derivatives in D quantities; a gradient of gradients has second
//! derivatives. With the norm |v| + w Σ|∂v|, 0 < w ≤ 1, such numbers are a Banach algebra: ‖xy‖ ≤ ‖x‖‖y‖.
//! So the remainder of a power series is bounded in the norm, and with it all derivatives of the remainder.

use std::ops::{Add, Mul, Neg, Sub};

use super::Interval;

/// Weight w of derivatives in the norm, a power of two: small enough that a series of e^{At} with |A|t ≤ 1
/// converges in the norm as it does without derivatives.
const WEIGHT: f64 = 1.0 / 65536.0;

/// An element of a Banach algebra.
pub trait Normed {
    /// Upper bound of the norm.
    fn norm(&self) -> f64;
    /// The element with anything added whose norm is at most `bound`.
    fn widened(self, bound: f64) -> Self;
}

/// A number with as many derivatives as the type has.
pub trait Number:
    Copy + Normed + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// A number that does not vary.
    fn constant(value: Interval) -> Self;
    /// The number without its derivatives.
    fn value(&self) -> Interval;
    /// 1/x.
    fn recip(self) -> Self;
    /// √x.
    fn sqrt(self) -> Self;
    /// ln x.
    fn ln(self) -> Self;
    /// Whether it is zero, and does not vary.
    fn is_zero(&self) -> bool;
    /// eˣ.
    fn exp(self) -> Self;
    /// cos x and sin x.
    fn circular(self) -> (Self, Self);
    /// Its derivatives, with 0 in place of the number.
    fn varying(self) -> Self;
    /// A multiple.
    fn scaled(self, factor: Interval) -> Self;

    /// A double.
    fn double(value: f64) -> Self {
        Self::constant(Interval::point(value))
    }
}

impl Normed for Interval {
    fn norm(&self) -> f64 {
        self.magnitude()
    }
    fn widened(self, bound: f64) -> Interval {
        self + Interval::new(-bound, bound)
    }
}

impl Number for Interval {
    fn constant(value: Interval) -> Interval {
        value
    }
    fn value(&self) -> Interval {
        *self
    }
    fn recip(self) -> Interval {
        Interval::ONE / self
    }
    fn sqrt(self) -> Interval {
        Interval::sqrt(self)
    }
    fn ln(self) -> Interval {
        Interval::ln(self)
    }
    #[inline]
    fn is_zero(&self) -> bool {
        *self == Interval::ZERO
    }
    fn exp(self) -> Interval {
        Interval::exp(self)
    }
    fn circular(self) -> (Interval, Interval) {
        (self.cos(), self.sin())
    }
    fn varying(self) -> Interval {
        Interval::ZERO
    }
    fn scaled(self, factor: Interval) -> Interval {
        self * factor
    }
}

/// A number with its derivatives in D quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient<N, const D: usize> {
    /// The number.
    pub value: N,
    /// Its derivatives.
    pub by: [N; D],
}

impl<N: Number, const D: usize> Default for Gradient<N, D> {
    fn default() -> Self {
        Gradient::double(0.0)
    }
}

impl<N: Number, const D: usize> Gradient<N, D> {
    /// A quantity itself.
    pub fn variable(value: N, index: usize) -> Self {
        let mut by = [N::double(0.0); D];
        by[index] = N::double(1.0);
        Gradient { value, by }
    }

    /// f(x) from f and f′ at the number.
    fn chain(self, value: N, slope: N) -> Self {
        Gradient {
            value,
            by: self.by.map(|by| by * slope),
        }
    }
}

impl<N: Number, const D: usize> Add for Gradient<N, D> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Gradient {
            value: self.value + other.value,
            by: std::array::from_fn(|index| self.by[index] + other.by[index]),
        }
    }
}

impl<N: Number, const D: usize> Sub for Gradient<N, D> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<N: Number, const D: usize> Neg for Gradient<N, D> {
    type Output = Self;
    fn neg(self) -> Self {
        Gradient {
            value: -self.value,
            by: self.by.map(Neg::neg),
        }
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the product rule adds
impl<N: Number, const D: usize> Mul for Gradient<N, D> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        // most derivatives are zero: this takes a third of the time
        let by = |index: usize| match (self.by[index].is_zero(), other.by[index].is_zero()) {
            (true, true) => self.by[index],
            (true, false) => self.value * other.by[index],
            (false, true) => self.by[index] * other.value,
            _ => self.by[index] * other.value + self.value * other.by[index],
        };
        Gradient {
            value: self.value * other.value,
            by: std::array::from_fn(by),
        }
    }
}

impl<N: Number, const D: usize> Normed for Gradient<N, D> {
    fn norm(&self) -> f64 {
        let derivatives = self
            .by
            .iter()
            .fold(Interval::ZERO, |sum, by| sum + Interval::point(by.norm()));
        (Interval::point(self.value.norm()) + derivatives * Interval::point(WEIGHT)).high
    }
    fn widened(self, bound: f64) -> Self {
        Gradient {
            value: self.value.widened(bound),
            // WEIGHT is a power of two: the quotient is exact
            by: self.by.map(|by| by.widened(bound / WEIGHT)),
        }
    }
}

impl<N: Number, const D: usize> Number for Gradient<N, D> {
    fn constant(value: Interval) -> Self {
        Gradient {
            value: N::constant(value),
            by: [N::double(0.0); D],
        }
    }
    fn value(&self) -> Interval {
        self.value.value()
    }
    fn recip(self) -> Self {
        let value = self.value.recip();
        self.chain(value, -(value * value))
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.chain(value, value.recip().scaled(Interval::point(0.5)))
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    fn is_zero(&self) -> bool {
        self.value.is_zero() && self.by.iter().all(N::is_zero)
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }
    fn varying(self) -> Self {
        Gradient {
            value: self.value.varying(),
            by: self.by,
        }
    }
    fn circular(self) -> (Self, Self) {
        let (cosine, sine) = self.value.circular();
        (self.chain(cosine, -sine), self.chain(sine, cosine))
    }
    fn scaled(self, factor: Interval) -> Self {
        Gradient {
            value: self.value.scaled(factor),
            by: self.by.map(|by| by.scaled(factor)),
        }
    }
}
