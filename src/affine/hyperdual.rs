//! Numbers with derivatives along three directions: u = Σ u_S ε_S over the subsets S of {1, 2, 3}, with εᵢ² = 0.
//!
//! With x = x₀ + ε₁a + ε₂b + ε₃c the coefficients of f(x) are its derivatives along these directions: f′a of ε₁,
//! f″(a, b) of ε₁ε₂, f‴(a, b, c) of ε₁ε₂ε₃, without truncation (J. Fike, J. Alonso, AIAA 2011-886).

use super::algebra::Function;
use super::form::Rule;

/// Directions.
pub(super) const DIRECTIONS: usize = 3;

/// Subsets of them.
const SUBSETS: usize = 1 << DIRECTIONS;

/// A number with its derivatives: the coefficient of a subset stands at the number whose bits are its members.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct HyperDual([f64; SUBSETS]);

/// A product of two numbers of which one may be no number, for a slope that jumps at a kink: it is finite on both sides, so that zero times it is
/// zero, and an infinite number times it infinite.
fn by_slope(a: f64, b: f64) -> f64 {
    let of_jump = |other: f64| match other {
        0.0 => 0.0,
        other if other.is_infinite() => f64::INFINITY,
        _ => f64::NAN,
    };
    match (a.is_nan(), b.is_nan()) {
        (true, false) => of_jump(b),
        (false, true) => of_jump(a),
        _ => a * b,
    }
}

impl HyperDual {
    /// A number that is the same everywhere.
    pub fn constant(value: f64) -> HyperDual {
        HyperDual::along(value, [0.0; DIRECTIONS])
    }

    /// A coordinate, by its value and what it changes by along each direction.
    pub fn along(value: f64, by: [f64; DIRECTIONS]) -> HyperDual {
        let mut number = [0.0; SUBSETS];
        number[0] = value;
        for (direction, by) in by.into_iter().enumerate() {
            number[1 << direction] = by;
        }
        HyperDual(number)
    }

    /// Its value.
    pub fn value(&self) -> f64 {
        self.0[0]
    }

    /// Its derivative along these directions, each of them once: the value where there are none.
    pub fn derivative(&self, directions: &[usize]) -> f64 {
        self.0[directions
            .iter()
            .map(|direction| 1 << direction)
            .sum::<usize>()]
    }

    /// Adds another one times a number.
    pub fn add(&mut self, factor: f64, other: &HyperDual) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            *own += factor * other;
        }
    }

    fn is_smooth(&self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }

    /// The product. A smooth factor that vanishes takes the kink of the other one away: where b = 0, (ab)′ = ab′ of any continuous a. One
    /// with a kink of its own takes it from the first derivatives.
    fn times(&self, other: &HyperDual) -> HyperDual {
        let vanishes = |one: &HyperDual, beside: &HyperDual| {
            one.0[0] == 0.0 && one.is_smooth() && beside.0[0].is_finite()
        };
        let (own, others) = (vanishes(self, other), vanishes(other, self));
        let of = |subset: usize| {
            let parts = (0..SUBSETS).filter(|part| part & !subset == 0);
            let pairs = parts.map(|part| (self.0[part], other.0[subset & !part]));
            let is_first = subset.is_power_of_two();
            let product = |(a, b): (f64, f64)| match own && a == 0.0 || others && b == 0.0 {
                true => 0.0,
                false if is_first => by_slope(a, b),
                false => a * b,
            };
            pairs.map(product).sum()
        };
        HyperDual(std::array::from_fn(of))
    }

    /// f of it, by f and its first three derivatives at its value (Faà di Bruno). Where f does not change to first order it takes a kink away
    /// from the first derivatives, and along directions that do not change it no derivative of f counts.
    fn composed(&self, [f0, f1, f2, f3]: [f64; 4]) -> HyperDual {
        let u = &self.0;
        let by = |f: f64, u: f64| if u == 0.0 { 0.0 } else { by_slope(f, u) };
        let two = |i: usize, j: usize| by(f1, u[i | j]) + by(f2, u[i] * u[j]);
        let mixed = u[1] * u[6] + u[2] * u[5] + u[4] * u[3];
        HyperDual([
            f0,
            by(f1, u[1]),
            by(f1, u[2]),
            two(1, 2),
            by(f1, u[4]),
            two(1, 4),
            two(2, 4),
            by(f1, u[7]) + by(f2, mixed) + by(f3, u[1] * u[2] * u[4]),
        ])
    }

    /// One that ends at zero goes on as zero, so that Newton's method may look beyond what ends a mode there.
    fn power(&self, r: f64) -> HyperDual {
        let x = self.value();
        if x < 0.0 && Rule::Power(r).ends_at_zero() {
            return HyperDual::constant(0.0);
        }
        let falling = [1.0, r, r * (r - 1.0), r * (r - 1.0) * (r - 2.0)];
        let order = [0.0, 1.0, 2.0, 3.0];
        self.composed(std::array::from_fn(|k| falling[k] * x.powf(r - order[k])))
    }

    /// Its absolute value where it is zero: there it has no derivative but along directions that do not change it.
    fn at_kink(&self) -> HyperDual {
        let of = |subset: usize| {
            let mut parts = (1..=subset).filter(|part| part & !subset == 0);
            match parts.all(|part| self.0[part] == 0.0) {
                true => 0.0,
                false => f64::NAN,
            }
        };
        HyperDual(std::array::from_fn(of))
    }

    fn function(&self, function: Function) -> HyperDual {
        match function {
            Function::Sqrt => self.power(0.5),
            Function::Abs if self.value() == 0.0 => self.at_kink(),
            _ => self.composed(function.derivatives(self.value())),
        }
    }

    /// What a rule makes of its operands.
    pub fn by_rule(rule: Rule, a: &HyperDual, b: &HyperDual) -> HyperDual {
        match rule {
            Rule::Product => a.times(b),
            Rule::Quotient => a.times(&b.power(-1.0)),
            Rule::Power(r) => a.power(r),
            Rule::Function(function) => a.function(function),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along one direction three times over, f‴ of every function is that of the series Σ fₖhᵏ/k! it begins with: the
    /// derivatives of tan by those of sin/cos, of tanh by exponentials.
    #[test]
    fn functions_of_two_kinds_have_the_same_derivatives() {
        let x = HyperDual::along(0.7, [1.3, -0.4, 0.9]);
        let of = |function| x.function(function);
        let tan = HyperDual::by_rule(Rule::Quotient, &of(Function::Sin), &of(Function::Cos));
        let mut twice = HyperDual::constant(0.0);
        twice.add(2.0, &x);
        let exp = twice.function(Function::Exp);
        let (mut above, mut below) = (exp, exp);
        above.add(-1.0, &HyperDual::constant(1.0));
        below.add(1.0, &HyperDual::constant(1.0));
        let tanh = HyperDual::by_rule(Rule::Quotient, &above, &below);
        let root = of(Function::Ln);
        let mut half = HyperDual::constant(0.0);
        half.add(0.5, &root);
        let (mut hyperbolic, exp_of_x) = (of(Function::Sinh), of(Function::Exp));
        hyperbolic.add(1.0, &of(Function::Cosh));
        let pairs = [
            (tan, of(Function::Tan)),
            (tanh, of(Function::Tanh)),
            (half.function(Function::Exp), of(Function::Sqrt)),
            (of(Function::Exp).function(Function::Ln), x),
            (of(Function::Asin).function(Function::Sin), x),
            (of(Function::Acos).function(Function::Cos), x),
            (of(Function::Atan).function(Function::Tan), x),
            (hyperbolic, exp_of_x),
        ];
        for (one, other) in pairs {
            for (one, other) in one.0.iter().zip(&other.0) {
                let size = one.abs().max(other.abs()).max(1.0);
                assert!((one - other).abs() <= 64.0 * f64::EPSILON * size);
            }
        }
        assert!(
            HyperDual::along(0.0, [1.0; 3])
                .function(Function::Abs)
                .derivative(&[0])
                .is_nan()
        );
    }

    /// |v|v has the derivative 0 at rest and no second one, |v|v² both, |v| none but along what does not change it.
    #[test]
    fn a_factor_that_vanishes_takes_a_kink_away() {
        let rule = |rule, a: &HyperDual, b: &HyperDual| HyperDual::by_rule(rule, a, b);
        let v = HyperDual::along(0.0, [1.3, -0.4, 0.0]);
        let size = v.function(Function::Abs);
        let drag = rule(Rule::Product, &size, &v);
        let [first, second, apart] = [&[0][..], &[0, 1], &[2]].map(|of| drag.derivative(of));
        assert_eq!((drag.value(), first, apart), (0.0, 0.0, 0.0));
        assert!(second.is_nan());
        for cubic in [
            rule(Rule::Product, &drag, &v),
            rule(Rule::Product, &v, &drag),
        ] {
            assert_eq!(
                (cubic.derivative(&[1]), cubic.derivative(&[0, 1])),
                (0.0, 0.0)
            );
        }
        assert_eq!(size.derivative(&[2]), 0.0);
        // a factor that is 2 there leaves the kink, and so does one that has a kink itself
        let mut beside = v;
        beside.add(2.0, &HyperDual::constant(1.0));
        assert!(
            rule(Rule::Product, &size, &beside)
                .derivative(&[0])
                .is_nan()
        );
        // max(0, v)² and max(0, v)^1.5 have the derivative 0
        let mut part = v;
        part.add(1.0, &size);
        let square = rule(Rule::Product, &part, &part);
        let none = HyperDual::default();
        let power = rule(Rule::Power(1.5), &part, &none);
        for smooth in [square, power] {
            assert_eq!((smooth.value(), smooth.derivative(&[0])), (0.0, 0.0));
            assert!(!smooth.derivative(&[0, 1]).is_finite());
        }
        // and √|v| times itself is |v|
        let root = size.function(Function::Sqrt);
        assert!(
            !rule(Rule::Product, &root, &root)
                .derivative(&[0])
                .is_finite()
        );
        let root = v.function(Function::Sqrt);
        assert!(
            !rule(Rule::Product, &root, &root)
                .derivative(&[0])
                .is_finite()
        );
    }
}
