//! Coefficients of a system as intervals, with derivatives in the continuation parameter.

use crate::affine::algebra::Obstacle;
use crate::affine::dual::Coefficient;
use crate::certify::analytic::Analytic;
use crate::interval::{Gradient, Interval, Number};

/// A number that depends on the parameter, and its derivative in it.
pub type Enclosure = Gradient<Interval, 1>;

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
        self.is_finite().then_some(self).ok_or(Obstacle::NotFinite)
    }
}
