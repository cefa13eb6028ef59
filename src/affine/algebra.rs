//! What expressions are made of, and what they can be evaluated in: operations, functions, and any [`Algebra`] that has them.
//!
//! Of a [`Function`] of one argument all that is known stands here. An expression calls it by its name. Its values are wanted in
//! real numbers and in intervals, its derivatives in numbers, forms and intervals, its series in time by a [`SeriesRule`], and a bound of
//! its slope. Two more are made of exponentials where expressions are read as forms: the relative exponential and the logistic
//! function.

use serde::{Deserialize, Serialize};

use super::{exprel, logistic};
use crate::interval::Interval;

/// An operation on two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Sum.
    Plus,
    /// Difference.
    Minus,
    /// Product.
    Times,
    /// Quotient.
    Over,
    /// Power.
    Power,
}

impl Operation {
    pub(super) const ALL: [Operation; 5] = [
        Operation::Plus,
        Operation::Minus,
        Operation::Times,
        Operation::Over,
        Operation::Power,
    ];
}

/// Which of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extremum {
    /// The lesser.
    Min,
    /// The greater.
    Max,
}

impl Extremum {
    /// Both with the names by which expressions call them.
    pub const ALL: [(&str, Extremum); 2] = [("min", Extremum::Min), ("max", Extremum::Max)];

    pub(super) fn named(name: &str) -> Option<Extremum> {
        let mut all = Extremum::ALL.into_iter();
        all.find_map(|(known, one)| (known == name).then_some(one))
    }
}

/// Why an operation has no result in an algebra.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum Obstacle {
    /// More products, quotients and functions of what changes within one another than are followed.
    #[error("too many products, quotients and functions within one another")]
    Deep,
    /// Products, quotients and functions of what depends on the states, where only affine forms serve.
    #[error("not affine in the states")]
    NotAffine,
    /// The phase outside `sin` and `cos`, or times something that is no whole number.
    #[error("the phase may stand in `sin` and `cos` only, times a whole number")]
    Phase,
    /// The result is not a finite number.
    #[error("the value is not a finite number")]
    NotFinite,
}

/// What an expression can be evaluated in.
pub trait Algebra: Clone {
    /// A number.
    fn number(value: f64) -> Self;
    /// A decimal as it is written, and the double next to it.
    fn decimal(value: f64, _text: &str) -> Self {
        Self::number(value)
    }
    /// −self.
    fn negative(self) -> Self;
    /// An operation on two elements.
    ///
    /// # Errors
    /// Where the algebra has no result.
    fn operate(self, operation: Operation, other: Self) -> Result<Self, Obstacle>;
    /// A function of an element.
    ///
    /// # Errors
    /// Where the algebra has no result.
    fn apply(self, function: Function) -> Result<Self, Obstacle>;
    /// The square of an element.
    ///
    /// # Errors
    /// Where the algebra has no result.
    fn square(self) -> Result<Self, Obstacle> {
        self.clone().operate(Operation::Times, self)
    }
    /// The lesser or the greater of two elements: b + (a − b ± |a − b|)/2.
    ///
    /// # Errors
    /// Where the algebra has no result.
    fn extremum(self, extremum: Extremum, other: Self) -> Result<Self, Obstacle> {
        let apart = self.operate(Operation::Minus, other.clone())?;
        let size = apart.clone().apply(Function::Abs)?;
        let way = match extremum {
            Extremum::Min => Operation::Minus,
            Extremum::Max => Operation::Plus,
        };
        let twice = apart.operate(way, size)?;
        let more = twice.operate(Operation::Times, Self::number(0.5))?;
        other.operate(Operation::Plus, more)
    }
}

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Sine, of radians.
    Sin,
    /// Cosine, of radians.
    Cos,
    /// Tangent, of radians.
    Tan,
    /// Exponential function.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// Hyperbolic tangent.
    Tanh,
    /// Arc sine, from −π/2 to π/2.
    Asin,
    /// Arc cosine, from 0 to π.
    Acos,
    /// Arc tangent, from −π/2 to π/2.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// (eᵃ − 1)/a, 1 where a is zero: of quotients alone.
    RelativeExponential,
    /// 1/(1 + e⁻ᵃ): of quotients alone.
    Logistic,
}

/// How the series of u = f(a) in time follows from that of a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SeriesRule {
    /// u = ±a, by the sign of a.
    Kink,
    /// au̇ = rȧu.
    Power(f64),
    /// u̇ = ȧu.
    Own,
    /// au̇ = ȧ.
    OverOperand,
    /// u̇ = ȧw with ẇ = ±ȧu.
    Pair { sign: f64 },
    /// u̇ = ȧw with w = 1 ± u².
    OneAndSquare { sign: f64 },
    /// wu̇ = ȧ with w = 1 + a².
    OverOneAndSquare,
    /// wu̇ = ȧ with ẇ = −au̇: w = ±√(1 − a²).
    OverRoot,
    /// As `exprel` has it.
    RelativeExponential,
    /// As `logistic` has it.
    Logistic,
}

impl Function {
    /// Those that expressions may call.
    pub const ALL: [Function; 13] = [
        Function::Sin,
        Function::Cos,
        Function::Tan,
        Function::Exp,
        Function::Ln,
        Function::Sqrt,
        Function::Abs,
        Function::Tanh,
        Function::Asin,
        Function::Acos,
        Function::Atan,
        Function::Sinh,
        Function::Cosh,
    ];

    pub(super) fn named(name: &str) -> Option<Function> {
        let mut all = Function::ALL.into_iter();
        all.find(|function| function.name() == name)
    }

    /// The name by which expressions call it, or would.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tan => "tan",
            Function::Exp => "exp",
            Function::Ln => "ln",
            Function::Sqrt => "sqrt",
            Function::Abs => "abs",
            Function::Tanh => "tanh",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
            Function::Sinh => "sinh",
            Function::Cosh => "cosh",
            Function::RelativeExponential => "exprel",
            Function::Logistic => "logistic",
        }
    }

    /// Value and derivative at a real number.
    #[inline]
    pub(crate) fn at(self, x: f64) -> (f64, f64) {
        match self {
            Function::Sin => (x.sin(), x.cos()),
            Function::Cos => (x.cos(), -x.sin()),
            Function::Tan => (x.tan(), 1.0 + x.tan() * x.tan()),
            Function::Exp => (x.exp(), x.exp()),
            Function::Ln => (x.ln(), x.recip()),
            Function::Sqrt => (x.sqrt(), 0.5 / x.sqrt()),
            Function::Abs => (x.abs(), x.signum()),
            // of 1 − tanh² nothing would be left where the tangent is nearly 1
            Function::Tanh => (x.tanh(), x.cosh().powi(2).recip()),
            Function::Asin => (x.asin(), root(x).recip()),
            Function::Acos => (x.acos(), -root(x).recip()),
            Function::Atan => (x.atan(), (1.0 + x * x).recip()),
            Function::Sinh => (x.sinh(), x.cosh()),
            Function::Cosh => (x.cosh(), x.sinh()),
            Function::RelativeExponential => {
                let [value, slope, ..] = exprel::derivatives(x);
                (value, slope)
            }
            Function::Logistic => {
                let [value, slope, ..] = logistic::derivatives(x);
                (value, slope)
            }
        }
    }

    /// Value and first three derivatives at a real number.
    pub(super) fn derivatives(self, x: f64) -> [f64; 4] {
        let (u, slope) = self.at(x);
        let [second, third] = match self {
            Function::Sin | Function::Cos => [-u, -slope],
            Function::Tan => [2.0 * u * slope, slope * (2.0 + 6.0 * u * u)],
            Function::Exp => [u, u],
            Function::Ln => [-1.0 / (x * x), 2.0 / (x * x * x)],
            Function::Sqrt => [-0.5 * slope / x, 0.75 * slope / (x * x)],
            Function::Abs => [0.0; 2],
            Function::Tanh => [-2.0 * u * slope, slope * (6.0 * u * u - 2.0)],
            Function::Asin | Function::Acos => {
                let cube = slope.powi(3);
                [x * cube, cube + 3.0 * x * x * slope.powi(5)]
            }
            Function::Atan => {
                let third = (6.0 * x * x - 2.0) * slope.powi(3);
                [-2.0 * x * slope * slope, third]
            }
            Function::Sinh | Function::Cosh => [u, slope],
            Function::RelativeExponential => return exprel::derivatives(x),
            Function::Logistic => return logistic::derivatives(x),
        };
        [u, slope, second, third]
    }

    /// Its slope at an element of an algebra, where it has a value.
    ///
    /// # Errors
    /// Where the algebra has no result.
    pub(crate) fn slope<A: Algebra>(self, a: A, value: A) -> Result<A, Obstacle> {
        use Operation::{Minus, Over, Plus, Times};
        let one = A::number(1.0);
        match self {
            Function::Sin => a.apply(Function::Cos),
            Function::Cos => Ok(a.apply(Function::Sin)?.negative()),
            Function::Tan => one.operate(Plus, value.square()?),
            Function::Tanh => one.operate(Minus, value.square()?),
            Function::Exp => Ok(value),
            Function::Ln => one.operate(Over, a),
            Function::Sqrt => A::number(0.5).operate(Over, value),
            Function::Abs => value.operate(Over, a),
            Function::Asin => {
                let root = one.clone().operate(Minus, a.square()?)?;
                one.operate(Over, root.apply(Function::Sqrt)?)
            }
            Function::Acos => Ok(Function::Asin.slope(a, value)?.negative()),
            Function::Atan => {
                let below = one.clone().operate(Plus, a.square()?)?;
                one.operate(Over, below)
            }
            Function::Sinh => a.apply(Function::Cosh),
            Function::Cosh => a.apply(Function::Sinh),
            Function::RelativeExponential => {
                let moved = a.clone().apply(Function::Exp)?.operate(Minus, value)?;
                moved.operate(Over, a)
            }
            // 1 − σ(a) is σ(−a)
            Function::Logistic => value.operate(Times, a.negative().apply(Function::Logistic)?),
        }
    }

    /// Bounds of its values in an interval.
    pub(crate) fn enclose(self, a: Interval) -> Interval {
        let one = Interval::ONE;
        match self {
            Function::Sin => a.sin(),
            Function::Cos => a.cos(),
            Function::Tan => a.sin() / a.cos(),
            Function::Exp => a.exp(),
            Function::Ln => a.ln(),
            Function::Sqrt => a.sqrt(),
            Function::Abs if a.low >= 0.0 => a,
            Function::Abs if a.high <= 0.0 => -a,
            Function::Abs => Interval::new(0.0, a.magnitude()),
            Function::Tanh => one - Interval::point(2.0) / ((a + a).exp() + one),
            Function::Asin => a.asin(),
            Function::Acos => a.acos(),
            Function::Atan => a.atan(),
            Function::Sinh => a.sinh(),
            Function::Cosh => a.cosh(),
            Function::RelativeExponential => exprel::enclose(a),
            Function::Logistic => one / ((-a).exp() + one),
        }
    }

    /// Whether it has values all over an interval and no kink there. Of those whose value or slope grows beyond bounds at an end, the
    /// value tells.
    pub(crate) fn is_smooth_in(self, a: Interval) -> bool {
        match self {
            Function::Abs => a.low >= 0.0 || a.high <= 0.0,
            Function::Sqrt => a.low >= 0.0,
            Function::Asin | Function::Acos => a.low >= -1.0 && a.high <= 1.0,
            _ => true,
        }
    }

    /// Its value at zero, where that is a whole number.
    pub(crate) fn at_zero(self) -> Option<f64> {
        let value = self.at(0.0).0;
        (value.fract() == 0.0).then_some(value)
    }

    /// A bound of its slope within a distance of a number.
    pub(super) fn steepest(self, a: f64, distance: f64) -> f64 {
        let (least, most) = ((a.abs() - distance).max(0.0), a.abs() + distance);
        match self {
            Function::Sin | Function::Cos | Function::Tanh | Function::Atan | Function::Abs => 1.0,
            Function::Exp => (a + distance).exp(),
            Function::Ln => least.recip(),
            Function::Sqrt => 0.5 / least.sqrt(),
            Function::Sinh | Function::Cosh => most.cosh(),
            Function::Tan | Function::Asin | Function::Acos => f64::INFINITY,
            Function::RelativeExponential => (a + distance).max(0.0).exp(),
            // it is symmetric, and greatest at zero
            Function::Logistic => self.at(least).1,
        }
    }

    /// Whether it may be smaller than rounding with all of its derivatives; others have one that is not.
    pub(super) fn fades(self) -> bool {
        matches!(
            self,
            Function::Exp | Function::Tanh | Function::Sqrt | Function::Logistic
        )
    }

    /// How its series goes on.
    #[inline]
    pub(super) fn series_rule(self) -> SeriesRule {
        match self {
            Function::Sin | Function::Cos => SeriesRule::Pair { sign: -1.0 },
            Function::Sinh | Function::Cosh => SeriesRule::Pair { sign: 1.0 },
            Function::Tan => SeriesRule::OneAndSquare { sign: 1.0 },
            Function::Tanh => SeriesRule::OneAndSquare { sign: -1.0 },
            Function::Exp => SeriesRule::Own,
            Function::Ln => SeriesRule::OverOperand,
            Function::Sqrt => SeriesRule::Power(0.5),
            Function::Abs => SeriesRule::Kink,
            Function::Asin | Function::Acos => SeriesRule::OverRoot,
            Function::Atan => SeriesRule::OverOneAndSquare,
            Function::RelativeExponential => SeriesRule::RelativeExponential,
            Function::Logistic => SeriesRule::Logistic,
        }
    }
}

/// √(1 − x²).
fn root(x: f64) -> f64 {
    ((1.0 - x) * (1.0 + x)).sqrt()
}
