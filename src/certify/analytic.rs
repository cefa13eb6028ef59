//! Expressions in intervals with derivatives of any order: the algebra of [`Gradient`]s, nested as deeply as derivatives are asked for.

use crate::affine::expression::{Algebra, Function, Obstacle, Operation};
use crate::interval::{Decimal, Gradient, Interval, Number};

/// Whole exponents up to this are products.
const MOST_FACTORS: f64 = 64.0;

/// A number to which the functions of expressions apply.
pub trait Analytic: Number {
    /// f of it; `None` where f may have a kink or no value.
    fn function(self, function: Function) -> Option<Self>;
    /// x², of one and the same x.
    fn square(self) -> Self;
    /// Whether it and all its derivatives are known to be finite numbers.
    fn is_finite(&self) -> bool;
}

impl Analytic for Interval {
    fn function(self, function: Function) -> Option<Interval> {
        let one = Interval::ONE;
        let has_value = match function {
            Function::Sqrt => self.low >= 0.0,
            Function::Asin | Function::Acos => self.low >= -1.0 && self.high <= 1.0,
            _ => true,
        };
        if !has_value {
            return None;
        }
        Some(match function {
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.sin() / self.cos(),
            Function::Exp => self.exp(),
            Function::Ln => self.ln(),
            Function::Sqrt => self.sqrt(),
            Function::Abs if self.low >= 0.0 => self,
            Function::Abs if self.high <= 0.0 => -self,
            Function::Abs => return None,
            Function::Tanh => one - Interval::point(2.0) / ((self + self).exp() + one),
            Function::Asin => self.asin(),
            Function::Acos => self.acos(),
            Function::Atan => self.atan(),
            Function::Sinh => self.sinh(),
            Function::Cosh => self.cosh(),
        })
    }

    fn square(self) -> Interval {
        Interval::square(self)
    }

    fn is_finite(&self) -> bool {
        !self.is_empty() && self.low.is_finite() && self.high.is_finite()
    }
}

/// f′(x), where f(x) is this value.
fn slope<N: Analytic>(function: Function, x: N, value: N) -> Option<N> {
    let one = N::double(1.0);
    let root = || (one - x.square()).sqrt().recip();
    Some(match function {
        Function::Sin => x.function(Function::Cos)?,
        Function::Cos => -x.function(Function::Sin)?,
        Function::Tan => one + value.square(),
        Function::Exp => value,
        Function::Ln => x.recip(),
        Function::Sqrt => value.recip().scaled(Interval::point(0.5)),
        Function::Abs if x.value().low >= 0.0 => one,
        Function::Abs => -one,
        Function::Tanh => one - value.square(),
        Function::Asin => root(),
        Function::Acos => -root(),
        Function::Atan => (one + x.square()).recip(),
        Function::Sinh => x.function(Function::Cosh)?,
        Function::Cosh => x.function(Function::Sinh)?,
    })
}

impl<N: Analytic, const D: usize> Analytic for Gradient<N, D> {
    fn function(self, function: Function) -> Option<Self> {
        let value = self.value.function(function)?;
        let slope = slope(function, self.value, value)?;
        Some(Gradient {
            value,
            by: self.by.map(|by| by * slope),
        })
    }

    fn square(self) -> Self {
        let slope = self.value.scaled(Interval::point(2.0));
        Gradient {
            value: self.value.square(),
            by: self.by.map(|by| by * slope),
        }
    }

    fn is_finite(&self) -> bool {
        self.value.is_finite() && self.by.iter().all(N::is_finite)
    }
}

/// The whole number that a number is, whatever it may depend on.
fn whole<N: Number>(number: &N) -> Option<f64> {
    let Interval { low, high } = number.value();
    let rests = (*number - N::double(low)).is_zero();
    (low == high && low.fract() == 0.0 && rests).then_some(low)
}

fn finite<N: Analytic>(number: N) -> Result<N, Obstacle> {
    number
        .is_finite()
        .then_some(number)
        .ok_or(Obstacle::NotFinite)
}

impl<N: Analytic, const D: usize> Algebra for Gradient<N, D> {
    fn number(value: f64) -> Self {
        Self::double(value)
    }

    fn decimal(value: f64, text: &str) -> Self {
        let unknown = Interval::new(value.next_down(), value.next_up());
        let decimal = Decimal::try_from(text.to_owned());
        Self::constant(decimal.map_or(unknown, |decimal| decimal.interval()))
    }

    fn negative(self) -> Self {
        -self
    }

    fn operate(self, operation: Operation, other: Self) -> Result<Self, Obstacle> {
        match operation {
            Operation::Plus => finite(self + other),
            Operation::Minus => finite(self - other),
            Operation::Times => finite(self * other),
            // zero times what may have no value is not zero
            Operation::Over => finite(self * finite(other.recip())?),
            Operation::Power => match whole(&other).filter(|n| n.abs() <= MOST_FACTORS) {
                Some(n) => {
                    let factors = 0..n.abs() as usize;
                    let power = factors.fold(Self::double(1.0), |power, _| power * self);
                    finite(if n < 0.0 { power.recip() } else { power })
                }
                None => finite((other * finite(self.ln())?).exp()),
            },
        }
    }

    fn apply(self, function: Function) -> Result<Self, Obstacle> {
        finite(self.function(function).ok_or(Obstacle::NotAffine)?)
    }
}
