//! The numbers of the equations, enclosed, with derivatives in the speed and in the parameter.
//!
//! The numbers of a problem are decimals, and the coefficients a, b, D, g, h follow from ν, ξ, γ by the
//! formulas of [`crate::tube::model::coefficients`], written once for every kind of [`Number`]: the derivative in
//! ν, ξ or γ comes with them.

use serde::{Deserialize, Serialize};

use crate::interval::{Decimal, Interval, Number};
use crate::tube::flow::material;
use crate::tube::model::{CoefficientSource, FrictionLaw, Model, Parameter};

/// Where a, b, D, g, h come from, as written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum WrittenCoefficients {
    /// ν, ξ, γ.
    Geometry([Decimal; 3]),
    /// a, b, D, g, h.
    Given([Decimal; 5]),
}

/// The numbers of a model as the decimals that were written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrittenModel {
    /// Origin of the coefficients.
    pub origin: WrittenCoefficients,
    /// Friction coefficient f.
    pub friction: Decimal,
    /// Mismatch δ.
    pub mismatch: Decimal,
    /// Mass-proportional damping α.
    pub damping: Decimal,
    /// Stiffness-proportional damping β, where it enters: the equations of sliding are of third order then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Decimal>,
    /// Static by kinetic friction; none under Coulomb's law.
    pub ratio: Option<Decimal>,
}

impl WrittenModel {
    /// The numbers of a model, with material damping or without. `text` looks a number up by its path in a problem file; one that it does not
    /// know, or knows otherwise than the model does, is the shortest decimal that reads as the double.
    pub fn new(
        model: &Model,
        material: bool,
        text: impl Fn(&str) -> Option<Decimal>,
    ) -> WrittenModel {
        let decimal = |path: &str, value: f64| {
            let written = text(path).filter(|decimal| decimal.nearest() == value);
            written.unwrap_or_else(|| Decimal::of(value))
        };
        let coefficient = |name: &str, value| decimal(&format!("model.coefficients.{name}"), value);
        WrittenModel {
            origin: match model.source {
                CoefficientSource::Geometry { nu, xi, gamma } => WrittenCoefficients::Geometry([
                    coefficient("nu", nu),
                    coefficient("xi", xi),
                    coefficient("gamma", gamma),
                ]),
                CoefficientSource::Given {
                    a,
                    b,
                    coupling,
                    g,
                    h,
                } => WrittenCoefficients::Given([
                    coefficient("a", a),
                    coefficient("b", b),
                    coefficient("D", coupling),
                    coefficient("g", g),
                    coefficient("h", h),
                ]),
            },
            friction: decimal("model.friction", model.friction),
            mismatch: decimal("model.mismatch", model.mismatch),
            damping: decimal("model.damping.mass", model.damping.mass),
            material: material.then(|| decimal("model.damping.stiffness", model.damping.stiffness)),
            ratio: match model.law {
                FrictionLaw::Static { ratio } => Some(decimal("model.friction_law.ratio", ratio)),
                _ => None,
            },
        }
    }
}

/// Below this y the integrals are summed as series, as in [`crate::tube::model::coefficients`].
const SERIES_LIMIT: f64 = 0.5;
/// Terms of the series; those left out fall like y² ≤ ¼ from one to the next.
const SERIES_TERMS: i32 = 32;

/// I0 and I2 of ξ.
fn integrals<N: Number>(xi: N) -> [N; 2] {
    let one = N::double(1.0);
    let square = xi * xi;
    let w = (xi - one) * (xi + one);
    let y = w * (square + one).recip();
    let sq = y * y;
    let quotient = |p: f64, q: f64| Interval::point(p) / Interval::point(q);
    if y.value().high < SERIES_LIMIT {
        let (mut i0, mut i2) = (N::double(0.0), N::double(0.0));
        for j in (1..=SERIES_TERMS).rev() {
            let n = f64::from(j);
            // y^{2j−1}(odd + y·even of the next term)
            let odd = (quotient(1.0, 2.0 * n + 1.0) + quotient(1.0, 2.0 * n - 1.0))
                * Interval::point(0.25);
            let even = N::constant(quotient(0.5, 2.0 * n + 1.0)) * y;
            i0 = i0 * sq + N::constant(odd) + even;
            i2 = i2 * sq + N::constant(quotient(1.0, (2.0 * n - 1.0) * (2.0 * n + 1.0)));
        }
        // every coefficient left out is below 1: ‖rest‖ ≤ 2‖y‖^{2n}/(1 − ‖y‖²)
        let norm = Interval::point(y.norm());
        let power = (0..SERIES_TERMS).fold(Interval::ONE, |power, _| power * norm.square());
        let rest = Interval::point(2.0) * power / (Interval::ONE - norm.square());
        let rest = if norm.high < 0.75 {
            rest.high
        } else {
            f64::INFINITY
        };
        return [i0.widened(rest) * y, i2.widened(rest) * y];
    }
    let log = xi.ln();
    let inverse = (w * w).recip();
    let quarter = Interval::point(0.25);
    let half = Interval::point(0.5);
    let sum = w * (square + one);
    [
        (square * square * log - square * w + sum.scaled(quarter)) * inverse,
        (sum.scaled(half) - (square * log).scaled(Interval::point(2.0))) * inverse,
    ]
}

/// a, b, D, g, h from ν, ξ, γ.
fn coefficients<N: Number>([nu, xi, gamma]: [N; 3]) -> [N; 5] {
    let one = N::double(1.0);
    let half = |x: N| x.scaled(Interval::point(0.5));
    let [i0, i2] = integrals(xi);
    let plus = (one + nu).recip();
    let minus = (one - nu - nu).recip();
    let c = (one - nu) * plus * minus;
    let lambda = nu * plus * minus;
    let mu = half(plus);
    let scale = (gamma * i0).recip();
    let ring = scale * plus * ((xi - one) * (xi + one)).recip();
    [
        c * i2 * scale,
        mu * i2 * scale,
        -((c + mu) * i2 + half(mu - lambda)) * scale,
        (xi * xi + minus) * ring,
        xi * xi * ring,
    ]
}

/// The numbers of the equations in a frame that moves with c, see [`crate::tube::flow::Quantities`].
#[derive(Clone, Copy, Debug)]
pub struct IntervalFrame<N> {
    pub ma: N,
    pub mb: N,
    /// κ = |D/c|.
    pub kappa: N,
    /// |c|.
    pub speed: N,
    pub g: N,
    pub h: N,
    pub friction: N,
    /// rf, r being the static by the kinetic friction.
    pub static_friction: N,
    /// δ.
    pub mismatch: N,
    /// α.
    pub damping: N,
    /// a/b − 1, which must be positive.
    pub excess_ratio: N,
    /// gδ.
    pub weight: N,
    /// Y at the end of stick where Q = fP, (rfκ + (r − 1)fgδ − α)/h − β.
    pub release: N,
    /// Sliding with material damping, in slip and in reverse slip.
    pub layers: Option<[Layered<N>; 2]>,
}

/// A sliding equation −βãV⃛ + mV̈ + s₁V̇ + hV = σfgδ, ã = a/c², as one of second order, m̂V̈ + ŝV̇ + hV = σfgδ, and a
/// layer e^{t/ρ}: see [`crate::tube::flow::material`].
#[derive(Clone, Copy, Debug)]
pub struct Layered<N> {
    /// β.
    pub beta: N,
    /// ρ.
    pub rho: N,
    /// m̂.
    pub mass: N,
    /// ŝ.
    pub damping: N,
}

impl<N: Number> Layered<N> {
    /// From β, d = βã, m, s₁ and h. Every ρ with −d + mρ + s₁ρ² + hρ³ = 0 serves: one next to that in doubles is the only one
    /// in an interval for all numbers of the box (Newton's operator), and a smooth function of them. Its derivatives are
    /// those of Newton's iterates, of which each doubles the order that is known.
    fn new(beta: N, [d, m, s, h]: [N; 4]) -> Option<Layered<N>> {
        /// Widenings of the first interval.
        const INFLATIONS: usize = 12;
        let [middle_d, middle_m, middle_s, middle_h] = [d, m, s, h].map(|x| x.value().middle());
        let near = material::layer_time(middle_d, middle_m, middle_s, middle_h)?;
        let mut radius = 4.0 * f64::EPSILON * near.abs();
        let known = (0..INFLATIONS).find_map(|_| {
            let middle = Interval::point(near);
            let all = Interval::around(near, radius);
            let [d, m, s, h] = [d, m, s, h].map(|x| x.value());
            let inverse = Interval::ONE / slope([m, s, h], all);
            let next = middle - cubic([d, m, s, h], middle) * inverse;
            radius = 1.25 * (next - middle).magnitude() + 4.0 * f64::EPSILON * near.abs();
            next.within(all).then_some(next)
        })?;
        let newton =
            |rho: N| rho - cubic([d, m, s, h], rho).varying() * slope([m, s, h], rho).recip();
        // second derivatives are known after two
        let rho = newton(newton(N::constant(known)));
        let damping = s + h * rho;
        Some(Layered {
            beta,
            rho,
            mass: m + damping * rho,
            damping,
        })
    }
}

/// −d + mρ + sρ² + hρ³.
fn cubic<N: Number>([d, m, s, h]: [N; 4], rho: N) -> N {
    ((h * rho + s) * rho + m) * rho - d
}

/// Its derivative in ρ.
fn slope<N: Number>([m, s, h]: [N; 3], rho: N) -> N {
    let [two, three] = [2.0, 3.0].map(Interval::point);
    ((h * rho).scaled(three) + s.scaled(two)) * rho + m
}

impl WrittenModel {
    /// a, b, D, g and h: of these proportions where the parameter is one of them, as written otherwise.
    fn coefficients_of<N: Number>(&self, tube: Option<[N; 3]>) -> [N; 5] {
        let known = |decimal: &Decimal| N::constant(decimal.interval());
        match (tube, &self.origin) {
            (Some(tube), _) => coefficients(tube),
            (None, WrittenCoefficients::Geometry(tube)) => {
                coefficients(tube.each_ref().map(Decimal::interval)).map(N::constant)
            }
            (None, WrittenCoefficients::Given(given)) => given.each_ref().map(known),
        }
    }

    /// The frame of excess speed e where the continuation parameter has a value; `direction` is the sign of
    /// c. `None` for a parameter that the equations here have not.
    pub fn frame<N: Number>(
        &self,
        parameter: Parameter,
        value: N,
        excess: N,
        direction: f64,
    ) -> Option<IntervalFrame<N>> {
        let known = |decimal: &Decimal| N::constant(decimal.interval());
        let [mut friction, mut mismatch, mut damping] =
            [&self.friction, &self.mismatch, &self.damping].map(known);
        let mut material = self.material.as_ref().map(known);
        let mut tube = None;
        match (parameter, &self.origin) {
            (Parameter::Friction, _) => friction = value,
            (Parameter::Mismatch, _) => mismatch = value,
            (Parameter::MassDamping, _) => damping = value,
            (Parameter::StiffnessDamping, _) => material = Some(value),
            (_, WrittenCoefficients::Geometry([nu, xi, gamma])) => {
                tube = Some(match parameter {
                    Parameter::Nu => [value, known(xi), known(gamma)],
                    Parameter::Xi => [known(nu), value, known(gamma)],
                    Parameter::Gamma => [known(nu), known(xi), value],
                    _ => return None,
                });
            }
            _ => return None,
        }
        let [a, b, coupling, g, h] = self.coefficients_of(tube);
        let one = N::double(1.0);
        let ratio = (one + excess).recip();
        let square = ratio * ratio;
        let root = a.sqrt();
        let kappa = (coupling * root.recip() * ratio).scaled(Interval::point(direction));
        let weight = g * mismatch;
        let ratio = self.ratio.as_ref().map_or(Interval::ONE, Decimal::interval);
        let static_friction = friction.scaled(ratio);
        let beyond = (friction * weight).scaled(ratio - Interval::ONE);
        let ma = excess * (excess + N::double(2.0)) * square;
        let release = (static_friction * kappa + beyond - damping) * h.recip();
        let sliding = |beta: N, sigma: f64| {
            let drive = (friction * kappa).scaled(Interval::point(sigma));
            let numbers = [
                beta * square,
                ma - beta * drive,
                damping + beta * h - drive,
                h,
            ];
            Layered::new(beta, numbers)
        };
        let layers = match material {
            Some(beta) => Some([sliding(beta, 1.0)?, sliding(beta, -1.0)?]),
            None => None,
        };
        Some(IntervalFrame {
            ma,
            mb: one - b * a.recip() * square,
            kappa,
            speed: root * (one + excess),
            g,
            h,
            friction,
            mismatch,
            damping,
            excess_ratio: a * b.recip() - one,
            weight,
            static_friction,
            release: material.map_or(release, |beta| release - beta),
            layers,
        })
    }
}
