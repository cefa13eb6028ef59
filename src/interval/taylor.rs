//! Taylor models: functions of t, |t| ≤ 1, as a polynomial in doubles and a bound of what it leaves out.
//!
//! A model stands for all functions Σ cₙtⁿ + e(t) with |e(t)| ≤ `rest` for every t. Roundings go to the rest, so
//! that a product takes about as long as that of two polynomials. With the norm Σ|cₙ| + `rest` models are a
//! Banach algebra, like numbers with derivatives (K. Makino, M. Berz, Int. J. Pure Appl. Math. 4 (2003) 379).

use std::ops::{Add, Mul, Neg, Sub};

use super::{Interval, Normed, Number};

/// Coefficients: of e^{2it}, what is left out is below 2¹²/12! = 9e-6.
const TERMS: usize = 12;
/// Sums of up to a hundred numbers that are not negative, times this, are not below the sum without rounding.
const UP: f64 = 1.0 + 1.0 / 70_368_744_177_664.0;
/// γ of a sum of up to `TERMS` products, in units of the sum of their moduli.
const ROUNDED: f64 = 2.0 * TERMS as f64 * f64::EPSILON;
/// More than all that underflow can take from a coefficient.
const UNDERFLOW: f64 = 1e-300;

/// A function of t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaylorModel {
    coefficients: [f64; TERMS],
    /// Coefficients that may not be zero.
    length: usize,
    rest: f64,
}

impl TaylorModel {
    /// Of whose values nothing is known.
    const UNKNOWN: TaylorModel = TaylorModel {
        coefficients: [0.0; TERMS],
        length: 0,
        rest: f64::INFINITY,
    };

    /// start + slope·t.
    pub fn line(start: f64, slope: f64) -> TaylorModel {
        let mut coefficients = [0.0; TERMS];
        (coefficients[0], coefficients[1]) = (start, slope);
        TaylorModel {
            coefficients,
            length: if slope == 0.0 { 1 } else { 2 },
            rest: 0.0,
        }
        .known()
    }

    fn known(self) -> TaylorModel {
        if self.rest.is_finite() && self.size().is_finite() {
            self
        } else {
            TaylorModel::UNKNOWN
        }
    }

    fn terms(&self) -> &[f64] {
        &self.coefficients[..self.length]
    }

    /// Σ|cₙ|, up to rounding.
    fn size(&self) -> f64 {
        self.terms().iter().fold(0.0, |sum, c| sum + c.abs())
    }

    /// The polynomial at |t| ≤ 1, and its derivative, each wrong by less than [`TaylorModel::blur`].
    pub fn at(&self, t: f64) -> [f64; 2] {
        let terms = self.terms().iter().rev();
        terms.fold([0.0; 2], |[value, slope], c| {
            [value * t + c, slope * t + value]
        })
    }

    /// Σ n(n − 1)|cₙ|, which bounds the second derivative of the polynomial.
    pub fn bend(&self) -> f64 {
        let terms = self.terms().iter().enumerate();
        let sum = terms.fold(0.0, |sum, (n, c)| {
            sum + (n * n.saturating_sub(1)) as f64 * c.abs()
        });
        sum * UP
    }

    /// The rest, and more than the rounding of values and slopes.
    pub fn blur(&self) -> f64 {
        (self.rest + 2.0 * ROUNDED * (self.size() + self.bend())) * UP
    }
}

impl Add for TaylorModel {
    type Output = TaylorModel;
    fn add(self, other: TaylorModel) -> TaylorModel {
        if other.is_zero() {
            return self;
        }
        if self.is_zero() {
            return other;
        }
        let length = self.length.max(other.length);
        let mut coefficients = self.coefficients;
        for (sum, c) in coefficients.iter_mut().zip(other.terms()) {
            *sum += c;
        }
        let mut sum = TaylorModel {
            coefficients,
            length,
            rest: 0.0,
        };
        sum.rest = (self.rest + other.rest + f64::EPSILON * sum.size()) * UP;
        sum.known()
    }
}

impl Sub for TaylorModel {
    type Output = TaylorModel;
    fn sub(self, other: TaylorModel) -> TaylorModel {
        self + -other
    }
}

impl Neg for TaylorModel {
    type Output = TaylorModel;
    fn neg(self) -> TaylorModel {
        TaylorModel {
            coefficients: self.coefficients.map(|c| -c),
            ..self
        }
    }
}

impl Mul for TaylorModel {
    type Output = TaylorModel;
    fn mul(self, other: TaylorModel) -> TaylorModel {
        if self.is_zero() || other.is_zero() {
            return TaylorModel::double(0.0);
        }
        let (a, b) = (self.terms(), other.terms());
        let mut coefficients = [0.0; TERMS];
        for (i, a) in a.iter().enumerate() {
            for (sum, b) in coefficients[i..].iter_mut().zip(b) {
                *sum += a * b;
            }
        }
        // Σ |aᵢ||bⱼ| over i + j ≥ TERMS
        let (mut cut, mut beyond) = (0.0, 0.0);
        for (i, a) in a.iter().enumerate() {
            beyond += b.get(TERMS - i).map_or(0.0, |b| b.abs());
            cut += a.abs() * beyond;
        }
        let (one, two) = (self.size() * UP, other.size() * UP);
        let rest = cut + ROUNDED * one * two + self.rest * (two + other.rest) + other.rest * one;
        TaylorModel {
            coefficients,
            length: (a.len() + b.len()).saturating_sub(1).min(TERMS),
            rest: rest * UP + UNDERFLOW,
        }
        .known()
    }
}

/// Functions other than sums and products are taken of the range: they are those of numbers that do not vary.
impl Normed for TaylorModel {
    fn norm(&self) -> f64 {
        (self.size() + self.rest) * UP
    }
    fn widened(self, bound: f64) -> TaylorModel {
        TaylorModel {
            rest: (self.rest + bound) * UP,
            ..self
        }
        .known()
    }
}

impl Number for TaylorModel {
    fn constant(value: Interval) -> TaylorModel {
        let middle = value.middle();
        let mut coefficients = [0.0; TERMS];
        coefficients[0] = middle;
        TaylorModel {
            coefficients,
            length: usize::from(middle != 0.0),
            rest: (value - Interval::point(middle)).magnitude(),
        }
        .known()
    }
    fn value(&self) -> Interval {
        let Some((first, others)) = self.terms().split_first() else {
            return Interval::new(-self.rest, self.rest);
        };
        let others = others.iter().fold(self.rest, |sum, c| sum + c.abs());
        Interval::around(*first, others * UP)
    }
    fn recip(self) -> TaylorModel {
        TaylorModel::constant(self.value().recip())
    }
    fn sqrt(self) -> TaylorModel {
        TaylorModel::constant(self.value().sqrt())
    }
    fn ln(self) -> TaylorModel {
        TaylorModel::constant(self.value().ln())
    }
    fn is_zero(&self) -> bool {
        self.rest == 0.0 && self.terms().iter().all(|c| *c == 0.0)
    }
    fn exp(self) -> TaylorModel {
        TaylorModel::constant(self.value().exp())
    }
    fn varying(self) -> TaylorModel {
        TaylorModel::constant(Interval::ZERO)
    }
    fn circular(self) -> (TaylorModel, TaylorModel) {
        let value = self.value();
        (
            TaylorModel::constant(value.cos()),
            TaylorModel::constant(value.sin()),
        )
    }
    fn scaled(self, factor: Interval) -> TaylorModel {
        self * TaylorModel::constant(factor)
    }
}
