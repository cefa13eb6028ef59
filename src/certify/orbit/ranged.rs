//! Coefficients of a system as formulas, and in which interval they are over a range of the parameter: what the making of modes
//! by contacts hangs on is decided by these for the whole range, or not at all.

use super::enclosure::Enclosure;
use super::exact::NamePolynomial;
use crate::affine::algebra::{Algebra, Function, Obstacle, Operation};
use crate::affine::dual::{Coefficient, Measured};
use crate::interval::{Interval, Number};

/// A formula, and an interval that has its values over a range of the parameter.
#[derive(Clone, Debug)]
pub struct Ranged {
    pub formula: NamePolynomial,
    range: Enclosure,
}

impl Ranged {
    /// A name that stands for a number in an interval.
    pub fn named(name: &str, range: Interval) -> Ranged {
        Ranged {
            formula: NamePolynomial::named(name.to_owned()),
            range: Enclosure::constant(range),
        }
    }

    /// Its values.
    pub fn range(&self) -> Interval {
        self.range.value
    }

    /// The two parts of a result: a formula that is zero is so whatever its interval.
    fn of(formula: NamePolynomial, range: Enclosure) -> Ranged {
        match formula.is_zero() {
            true => Ranged::default(),
            false => Ranged { formula, range },
        }
    }
}

impl Default for Ranged {
    fn default() -> Ranged {
        Ranged {
            formula: NamePolynomial::default(),
            range: Enclosure::constant(Interval::ZERO),
        }
    }
}

impl PartialEq for Ranged {
    fn eq(&self, other: &Ranged) -> bool {
        self.formula == other.formula
    }
}

impl Algebra for Ranged {
    fn number(value: f64) -> Ranged {
        let formula = <NamePolynomial as Algebra>::number(value);
        Ranged::of(formula, Enclosure::constant(Interval::point(value)))
    }

    fn decimal(value: f64, text: &str) -> Ranged {
        let range = <Enclosure as Algebra>::decimal(value, text);
        Ranged::of(NamePolynomial::decimal(value, text), range)
    }

    fn negative(self) -> Ranged {
        Ranged::of(self.formula.negative(), self.range.negative())
    }

    fn operate(self, operation: Operation, other: Ranged) -> Result<Ranged, Obstacle> {
        let range = self.range.operate(operation, other.range)?;
        let formula = self.formula.operate(operation, other.formula)?;
        Ok(Ranged::of(formula, range))
    }

    fn apply(self, function: Function) -> Result<Ranged, Obstacle> {
        let range = Algebra::apply(self.range, function)?;
        Ok(Ranged::of(self.formula.apply(function)?, range))
    }
}

impl Coefficient for Ranged {
    const TERMS: bool = false;

    fn sum(self, weight: f64, other: Ranged, other_weight: f64) -> Ranged {
        let range = self.range.sum(weight, other.range, other_weight);
        Ranged::of(self.formula.sum(weight, other.formula, other_weight), range)
    }

    fn times(self, other: Ranged) -> Ranged {
        let range = Coefficient::times(self.range, other.range);
        Ranged::of(self.formula.times(other.formula), range)
    }

    fn fixed(&self) -> Option<f64> {
        self.formula.fixed()
    }

    fn finite(self) -> Result<Ranged, Obstacle> {
        let Ranged { formula, range } = self;
        let range = range.finite()?;
        Ok(Ranged { formula, range })
    }
}

impl Measured for Ranged {
    const SAME: f64 = 0.0;

    fn certain(&self) -> f64 {
        let Interval { low, high } = self.range();
        match self.range() {
            range if range.is_positive() => low,
            range if range.is_negative() => high,
            _ => 0.0,
        }
    }

    fn largest(&self) -> f64 {
        self.range().magnitude()
    }

    fn cancelled(self, other: Ranged) -> Ranged {
        self.sum(1.0, other, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_is_certain_over_the_whole_range_or_not_at_all() {
        let k = Ranged::named("k", Interval::new(1.0, 2.0));
        let over = |number: f64| k.clone().sum(1.0, Ranged::number(number), -1.0).certain();
        assert!(over(0.5) >= 0.49 && over(3.0) <= -0.99);
        assert_eq!(over(1.5), 0.0);
        // what is zero by its formula has no interval around zero
        let nothing = k.clone().sum(1.0, k.clone(), -1.0);
        assert_eq!((nothing.largest(), &nothing), (0.0, &Ranged::default()));
        let near = Ranged::named("l", Interval::new(1.0, 2.0));
        assert!(k.clone().sum(1.0, near, -1.0).largest() > 0.0);
        // a division by what may be zero has no result
        let through = Ranged::named("z", Interval::new(-1.0, 1.0));
        let quotient = k.operate(Operation::Over, through);
        assert_eq!(quotient.err(), Some(Obstacle::NotFinite));
    }
}
