//! Coefficients of a system as intervals, with derivatives in the continuation parameter.

use crate::affine::dual::Coefficient;
use crate::affine::expression::{Algebra, Function, Obstacle, Operation};
use crate::interval::{Decimal, Gradient, Interval, Number};

/// A number that depends on the parameter, and its derivative in it.
pub type Enclosure = Gradient<Interval, 1>;

/// Whole exponents up to this are products.
const MOST_FACTORS: f64 = 64.0;

/// f(x) from f and f′ at the number.
fn chain(x: Enclosure, (value, slope): (Interval, Interval)) -> Enclosure {
    Enclosure {
        value,
        by: x.by.map(|by| by * slope),
    }
}

fn exp(x: Enclosure) -> Enclosure {
    let value = x.value.exp();
    chain(x, (value, value))
}

impl Algebra for Enclosure {
    fn number(value: f64) -> Enclosure {
        Enclosure::double(value)
    }

    fn decimal(value: f64, text: &str) -> Enclosure {
        let unknown = Interval::new(value.next_down(), value.next_up());
        let decimal = Decimal::try_from(text.to_owned());
        Enclosure::constant(decimal.map_or(unknown, |decimal| decimal.interval()))
    }

    fn negative(self) -> Enclosure {
        -self
    }

    fn operate(self, operation: Operation, other: Enclosure) -> Result<Enclosure, Obstacle> {
        let result = match operation {
            Operation::Plus => self + other,
            Operation::Minus => self - other,
            Operation::Times => self * other,
            Operation::Over => self * other.recip(),
            Operation::Power => match other.whole().filter(|n| n.abs() <= MOST_FACTORS) {
                Some(n) => {
                    let factors = 0..n.abs() as usize;
                    let power = factors.fold(Enclosure::double(1.0), |power, _| power * self);
                    if n < 0.0 { power.recip() } else { power }
                }
                None => exp(other * self.ln()),
            },
        };
        result.finite()
    }

    fn apply(self, function: Function) -> Result<Enclosure, Obstacle> {
        let (x, one) = (self.value, Interval::ONE);
        let result = match function {
            Function::Sin => chain(self, (x.sin(), x.cos())),
            Function::Cos => chain(self, (x.cos(), -x.sin())),
            Function::Tan => {
                let tangent = x.sin() / x.cos();
                chain(self, (tangent, one + tangent.square()))
            }
            Function::Exp => exp(self),
            Function::Ln => self.ln(),
            Function::Sqrt => self.sqrt(),
            Function::Abs if x.low >= 0.0 => self,
            Function::Abs if x.high <= 0.0 => -self,
            Function::Abs => return Err(Obstacle::NotAffine),
            Function::Tanh => {
                let twice = (x + x).exp();
                let tangent = one - Interval::point(2.0) / (twice + one);
                chain(self, (tangent, one - tangent.square()))
            }
            Function::Asin => chain(self, (x.asin(), one / (one - x.square()).sqrt())),
            Function::Acos => chain(self, (x.acos(), -(one / (one - x.square()).sqrt()))),
            Function::Atan => chain(self, (x.atan(), one / (one + x.square()))),
            Function::Sinh => chain(self, (x.sinh(), x.cosh())),
            Function::Cosh => chain(self, (x.cosh(), x.sinh())),
        };
        result.finite()
    }
}

impl Coefficient for Enclosure {
    const TERMS: bool = false;

    fn sum(self, weight: f64, other: Enclosure, other_weight: f64) -> Enclosure {
        self.scaled(Interval::point(weight)) + other.scaled(Interval::point(other_weight))
    }

    fn times(self, other: Enclosure) -> Enclosure {
        self * other
    }

    fn fixed(&self) -> Option<f64> {
        let Interval { low, high } = self.value;
        (low == high && self.by[0] == Interval::ZERO).then_some(low)
    }

    fn finite(self) -> Result<Enclosure, Obstacle> {
        let known = |x: Interval| !x.is_empty() && x.low.is_finite() && x.high.is_finite();
        let finite = known(self.value) && known(self.by[0]);
        finite.then_some(self).ok_or(Obstacle::NotFinite)
    }
}
