//! Numbers that depend on parameters, with their derivatives in those that vary: what coefficients of forms are.

use super::algebra::{Algebra, Extremum, Function, Obstacle, Operation};

/// How many parameters may vary at once: two along a curve of events.
pub const VARYING: usize = 2;

/// What the coefficients of a form are: numbers that depend on parameters only.
pub trait Coefficient: Algebra + Default + PartialEq {
    /// Whether forms with such coefficients may have terms that are not affine.
    const TERMS: bool;
    /// Combination of both with weights that are doubles.
    fn sum(self, weight: f64, other: Self, other_weight: f64) -> Self;
    /// Product.
    fn times(self, other: Self) -> Self;
    /// The number that it is, whatever the parameters.
    fn fixed(&self) -> Option<f64>;
    /// Itself, unless it is no finite number.
    ///
    /// # Errors
    /// Where it is not.
    fn finite(self) -> Result<Self, Obstacle>;

    /// The factor that makes every second number of these pairs the first, but for rounding, whatever the parameters: told of
    /// doubles, whose rounding is known.
    fn ratio(_pairs: &[(Self, Self)]) -> Option<Self> {
        None
    }

    /// The whole number that it is, whatever the parameters.
    fn whole(&self) -> Option<f64> {
        self.fixed().filter(|number| number.fract() == 0.0)
    }
}

/// A coefficient whose size decides: which terms cancel, which guards are one, which way a force acts.
pub trait Measured: Coefficient {
    /// Part of its largest coefficient by which a form and a multiple of another may differ where they are the same for the
    /// mathematics.
    const SAME: f64;
    /// The number nearest to zero that it may be.
    fn certain(&self) -> f64;
    /// The largest modulus that it may have.
    fn largest(&self) -> f64;
    /// The sum of two, zero where that is nothing but rounding.
    fn cancelled(self, other: Self) -> Self;
}

/// How a number depends on the parameter along which a system is led.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Degree {
    /// Not at all, or none is.
    #[default]
    Fixed,
    /// By its slope alone.
    Affine,
    /// In some other way.
    Beyond,
}

/// A number with its derivatives in the parameters that vary.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// Its value.
    pub value: f64,
    /// ∂/∂p of the parameters that vary, zero where fewer do.
    pub by: [f64; VARYING],
    /// How it depends on the first of them, where a system is led along that.
    pub degree: Degree,
}

impl Dual {
    /// The value of the parameter that varies as number `index` among those that do, if it does.
    pub(crate) fn parameter(value: f64, index: Option<usize>) -> Dual {
        let mut by = [0.0; VARYING];
        if let Some(index) = index {
            by[index] = 1.0;
        }
        Dual::new(value, by)
    }

    /// Of this value with these derivatives.
    pub(super) fn new(value: f64, by: [f64; VARYING]) -> Dual {
        let degree = Degree::Fixed;
        Dual { value, by, degree }
    }

    /// The same with a degree; what is affine and has no slope is fixed.
    pub(super) fn of_degree(self, degree: Degree) -> Dual {
        let degree = match degree {
            Degree::Affine if self.by[0] == 0.0 => Degree::Fixed,
            degree => degree,
        };
        Dual { degree, ..self }
    }

    /// Parameters by their index, at these values, of which that of the index `along` is the one that a system is led along.
    pub(super) fn led(values: &[f64], along: usize) -> impl Fn(usize) -> Dual {
        move |index| {
            let varies = (index == along).then_some(0);
            Dual::parameter(values[index], varies).of_degree(Degree::Affine)
        }
    }

    /// Parameters by their index, at these values, of which those of the indices `varying` vary.
    pub(super) fn parameters(values: &[f64], varying: &[usize]) -> impl Fn(usize) -> Dual {
        move |index| {
            let varies = varying.iter().position(|varying| *varying == index);
            Dual::parameter(values[index], varies)
        }
    }

    /// f(self) for a function with this value and derivative.
    fn chain(self, (value, derivative): (f64, f64)) -> Dual {
        let by = self
            .by
            .map(|by| if by == 0.0 { 0.0 } else { derivative * by });
        Dual::new(value, by).of_degree(self.bent())
    }

    /// The degree of a function of it.
    fn bent(self) -> Degree {
        match self.degree {
            Degree::Fixed => Degree::Fixed,
            _ => Degree::Beyond,
        }
    }

    /// self/other, whatever that is.
    pub(super) fn over(self, other: Dual) -> Dual {
        let x = other.value;
        self.times(other.chain((x.recip(), -x.powi(-2))))
    }

    fn power(self, exponent: Dual) -> Dual {
        let (x, n) = (self.value, exponent.value);
        if exponent.fixed().is_some() {
            let slope = if n == 0.0 { 0.0 } else { n * x.powf(n - 1.0) };
            return self.chain((x.powf(n), slope));
        }
        let value = x.powf(n);
        let by = [0, 1].map(|p| value * (n * self.by[p] / x + x.ln() * exponent.by[p]));
        Dual::new(value, by).of_degree(self.bent().max(exponent.bent()))
    }
}

impl Coefficient for Dual {
    const TERMS: bool = true;

    fn sum(self, weight: f64, other: Dual, other_weight: f64) -> Dual {
        let value = weight * self.value + other_weight * other.value;
        let by = [0, 1].map(|p| weight * self.by[p] + other_weight * other.by[p]);
        Dual::new(value, by).of_degree(self.degree.max(other.degree))
    }

    fn times(self, other: Dual) -> Dual {
        let degree = match (self.degree, other.degree) {
            (Degree::Fixed, degree) | (degree, Degree::Fixed) => degree,
            _ => Degree::Beyond,
        };
        let by = [0, 1].map(|p| self.by[p] * other.value + self.value * other.by[p]);
        Dual::new(self.value * other.value, by).of_degree(degree)
    }

    fn fixed(&self) -> Option<f64> {
        (self.by == [0.0; VARYING] && self.degree == Degree::Fixed).then_some(self.value)
    }

    fn finite(self) -> Result<Dual, Obstacle> {
        let finite = self.value.is_finite() && self.by.iter().all(|by| by.is_finite());
        finite.then_some(self).ok_or(Obstacle::NotFinite)
    }

    fn ratio(pairs: &[(Dual, Dual)]) -> Option<Dual> {
        let sized = |(_, second): &&(Dual, Dual)| second.value.abs();
        let largest = pairs
            .iter()
            .max_by(|one, other| sized(one).total_cmp(&sized(other)));
        let (first, second) = largest.filter(|pair| pair.1.value != 0.0)?;
        let ratio = first.over(*second);
        let is_rounding = |x: f64, size: f64| x.abs() <= Dual::SAME * size;
        let holds = |(first, second): &(Dual, Dual)| {
            let left = first.sum(1.0, ratio.times(*second), -1.0);
            let by = |p: usize| first.by[p].abs() + ratio.times(*second).by[p].abs();
            is_rounding(left.value, first.value.abs())
                && (0..VARYING).all(|p| is_rounding(left.by[p], by(p)))
        };
        (ratio.value != 0.0 && pairs.iter().all(holds)).then_some(ratio)
    }
}

impl Measured for Dual {
    const SAME: f64 = 1e-12;

    fn certain(&self) -> f64 {
        self.value
    }

    fn largest(&self) -> f64 {
        self.value.abs()
    }

    fn cancelled(self, other: Dual) -> Dual {
        /// Part of two coefficients below which their sum is nothing but the roundings of the few operations that made them.
        const ROUNDING: f64 = 16.0 * f64::EPSILON;
        let sum = |a: f64, b: f64| match (a + b).abs() <= ROUNDING * (a.abs() + b.abs()) {
            true => 0.0,
            false => a + b,
        };
        let by = std::array::from_fn(|p| sum(self.by[p], other.by[p]));
        Dual::new(sum(self.value, other.value), by).of_degree(self.degree.max(other.degree))
    }
}

impl Algebra for Dual {
    fn number(value: f64) -> Dual {
        Dual::parameter(value, None)
    }

    fn negative(self) -> Dual {
        self.sum(-1.0, Dual::default(), 0.0)
    }

    fn operate(self, operation: Operation, other: Dual) -> Result<Dual, Obstacle> {
        let result = match operation {
            Operation::Plus => self.sum(1.0, other, 1.0),
            Operation::Minus => self.sum(1.0, other, -1.0),
            Operation::Times => self.times(other),
            Operation::Over => self.over(other),
            Operation::Power => self.power(other),
        };
        result.finite()
    }

    fn apply(self, function: Function) -> Result<Dual, Obstacle> {
        self.chain(function.at(self.value)).finite()
    }

    fn extremum(self, extremum: Extremum, other: Dual) -> Result<Dual, Obstacle> {
        let takes_self = match extremum {
            Extremum::Min => self.value < other.value,
            Extremum::Max => self.value > other.value,
        };
        let degree = self.bent().max(other.bent());
        let taken = if takes_self { self } else { other };
        Ok(taken.of_degree(degree))
    }
}
