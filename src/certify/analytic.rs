//! Expressions in intervals with derivatives of any order: the algebra of [`Gradient`]s, nested as deeply as derivatives are asked for.

use crate::affine::algebra::{Algebra, Function, Obstacle, Operation};
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
        function.is_smooth_in(self).then(|| function.enclose(self))
    }

    fn square(self) -> Interval {
        Interval::square(self)
    }

    fn is_finite(&self) -> bool {
        !self.is_empty() && self.low.is_finite() && self.high.is_finite()
    }
}

impl<N: Analytic, const D: usize> Analytic for Gradient<N, D> {
    fn function(self, function: Function) -> Option<Self> {
        let value = self.value.function(function)?;
        let slope = match function {
            Function::Abs if self.value().low >= 0.0 => N::double(1.0),
            Function::Abs => N::double(-1.0),
            _ => function.slope(self.value, value).ok()?,
        };
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

impl<N: Analytic> Algebra for N {
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

    fn square(self) -> Result<Self, Obstacle> {
        finite(Analytic::square(self))
    }

    fn apply(self, function: Function) -> Result<Self, Obstacle> {
        finite(self.function(function).ok_or(Obstacle::NotAffine)?)
    }
}
