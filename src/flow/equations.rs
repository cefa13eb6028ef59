//! The equations of a zone as an initial-value problem that stays regular when the zone shrinks.
//!
//! Time is τ = s/T ∈ \[0, 1\] and every unknown starts from zero,
//!
//! ```text
//! V = V₀ + Tη,   W = W₀ + T^m ω,                                   contact, m = 0, 1, 2
//! U = δ + T^m γ,   U̇ = T^{m−1} β   (m = 0: U̇ = β),   V = V₀ + Tη,   W = W₀ + Tω,   separation, m = 0, 2, 3
//! ```
//!
//! m being the order of the zero of W − 1 or U − δ at the entry, which is divided out: ω and γ at τ = 1
//! are the switching functions. With S(W) the friction multiplier (Q = fSP) and ∎₀ the value at the entry,
//!
//! ```text
//! η′ = W,   ω′ = T^{1−m}(V̈ − V̈₀),   m_a V̈ = fSP − αW − hV        V̈₀ = 0 taken out for m = 2 only,
//! γ′ = β,   β′ = T^{2−m}Ü,   m_b Ü = −αU̇ − gU − κW,   ω′ = V̈,   m_a V̈ = −αW − hV + κU̇,
//! ```
//!
//! where for m = 3 the pressure gδ + κW₀ = 0 of a take-off is taken out of Ü. Differences over the
//! zone are formed from η, ω, β, γ, never by subtraction, so that T may pass through zero.
//!
//! The right sides are written once for plain numbers and for numbers with derivatives ([`Jet`]): the
//! second integrates the variational equations with the first.

use super::{DURATION, ENTRY_W, ENTRY_Y, Frame, Jet};
use crate::model::FrictionLaw;

/// A number or a number with derivatives.
pub trait Number: Copy {
    /// The number itself.
    fn value(self) -> f64;
    /// scale·self + offset.
    fn affine(self, scale: f64, offset: f64) -> Self;
    /// self + other.
    fn add(self, other: Self) -> Self;
    /// self·other.
    fn times(self, other: Self) -> Self;
    /// A function of self by its value and slope there.
    fn map(self, value: f64, slope: f64) -> Self;
    /// The same number without its derivatives.
    fn of(jet: Jet) -> Self;
}

impl Number for f64 {
    fn value(self) -> f64 {
        self
    }
    fn affine(self, scale: f64, offset: f64) -> f64 {
        scale * self + offset
    }
    fn add(self, other: f64) -> f64 {
        self + other
    }
    fn times(self, other: f64) -> f64 {
        self * other
    }
    fn map(self, value: f64, _: f64) -> f64 {
        value
    }
    fn of(jet: Jet) -> f64 {
        jet.value
    }
}

impl Number for Jet {
    fn value(self) -> f64 {
        self.value
    }
    fn affine(self, scale: f64, offset: f64) -> Jet {
        Jet::affine(self, scale, offset)
    }
    fn add(self, other: Jet) -> Jet {
        self.plus(1.0, other)
    }
    fn times(self, other: Jet) -> Jet {
        Jet::times(self, other)
    }
    fn map(self, value: f64, slope: f64) -> Jet {
        Jet {
            value,
            by: self.by.map(|by| slope * by),
        }
    }
    fn of(jet: Jet) -> Jet {
        jet
    }
}

/// A number with its derivatives in the D unknowns of a zone's equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const D: usize> {
    /// The number.
    pub value: f64,
    /// Its derivatives.
    pub by: [f64; D],
}

impl<const D: usize> Dual<D> {
    /// A number that does not vary.
    pub fn constant(value: f64) -> Dual<D> {
        Dual {
            value,
            by: [0.0; D],
        }
    }
}

impl<const D: usize> Number for Dual<D> {
    fn value(self) -> f64 {
        self.value
    }
    fn affine(self, scale: f64, offset: f64) -> Dual<D> {
        Dual {
            value: scale * self.value + offset,
            by: self.by.map(|by| scale * by),
        }
    }
    fn add(self, other: Dual<D>) -> Dual<D> {
        Dual {
            value: self.value + other.value,
            by: std::array::from_fn(|index| self.by[index] + other.by[index]),
        }
    }
    fn times(self, other: Dual<D>) -> Dual<D> {
        Dual {
            value: self.value * other.value,
            by: std::array::from_fn(|index| {
                self.by[index] * other.value + self.value * other.by[index]
            }),
        }
    }
    fn map(self, value: f64, slope: f64) -> Dual<D> {
        Dual {
            value,
            by: self.by.map(|by| slope * by),
        }
    }
    fn of(jet: Jet) -> Dual<D> {
        Dual::constant(jet.value)
    }
}

/// The right side of an autonomous system in D unknowns.
pub trait Field<const D: usize, N: Number> {
    /// dx/dτ.
    fn rate(&self, x: &[N; D]) -> [N; D];
}

/// (e^x − 1)/x and its derivative.
fn exponential_quotient(x: f64) -> (f64, f64) {
    /// Below it the series of the derivative, 1/2 + x/3 + x²/8 + …, to rounding.
    const SMALL: f64 = 1e-2;
    let quotient = if x == 0.0 { 1.0 } else { x.exp_m1() / x };
    let slope = if x.abs() < SMALL {
        // Σ (j+1) x^j/(j+2)!
        let mut sum = 0.0;
        for j in (0..9).rev() {
            let n = f64::from(j);
            let factorial: f64 = (1..=j + 2).map(f64::from).product();
            sum = sum * x + (n + 1.0) / factorial;
        }
        sum
    } else {
        (x.exp() - quotient) / x
    };
    (quotient, slope)
}

/// S(W) of a law in a sliding direction σ: Q = fSP.
pub fn multiplier<N: Number>(law: FrictionLaw, sigma: f64, w: N, smoothing: N) -> N {
    match law {
        FrictionLaw::Coulomb | FrictionLaw::Static { .. } => w.map(sigma, 0.0),
        FrictionLaw::Stribeck { ratio, velocity } => {
            let weakening = (ratio - 1.0) * (-sigma * (1.0 - w.value()) / velocity).exp();
            w.map(sigma * (1.0 + weakening), weakening / velocity)
        }
        FrictionLaw::Regularised { .. } => {
            let epsilon = smoothing.value();
            let inverse = smoothing.map(1.0 / epsilon, -1.0 / (epsilon * epsilon));
            let argument = w.affine(-1.0, 1.0).times(inverse);
            let value = argument.value().tanh();
            // sech² = 1 − tanh²
            argument.map(value, (1.0 - value) * (1.0 + value))
        }
    }
}

/// (S(1 + d) − S(1))/d, regular as d → 0.
fn multiplier_quotient<N: Number>(law: FrictionLaw, sigma: f64, d: N) -> N {
    match law {
        FrictionLaw::Stribeck { ratio, velocity } => {
            let scale = sigma / velocity;
            let (quotient, slope) = exponential_quotient(scale * d.value());
            let factor = (ratio - 1.0) / velocity;
            d.map(factor * quotient, factor * slope * scale)
        }
        _ => d.map(0.0, 0.0),
    }
}

/// A sliding zone.
#[derive(Clone, Copy, Debug)]
pub struct Sliding<N> {
    law: FrictionLaw,
    sigma: f64,
    order: usize,
    duration: N,
    y0: N,
    w0: N,
    inverse_mass: N,
    damping: N,
    stiffness: N,
    friction: N,
    kappa: N,
    weight: N,
    smoothing: N,
}

/// The entry state and the duration as unknowns of a zone.
fn unknowns(entry: [f64; 2], duration: f64) -> [Jet; 3] {
    let variable = |value: f64, index: usize| {
        let mut jet = Jet {
            value,
            ..Jet::default()
        };
        jet.by[index] = 1.0;
        jet
    };
    [
        variable(entry[0], ENTRY_Y),
        variable(entry[1], ENTRY_W),
        variable(duration, DURATION),
    ]
}

fn inverse(frame: &Frame, mass: f64, by: impl Fn(&super::Quantities) -> f64) -> Jet {
    frame.jet(1.0 / mass, |moved| -by(moved) / (mass * mass))
}

impl<N: Number> Sliding<N> {
    /// The zone of this frame, entry and duration.
    pub fn new(
        frame: &Frame,
        law: FrictionLaw,
        sigma: f64,
        order: usize,
        entry: [f64; 2],
        duration: f64,
    ) -> Sliding<N> {
        let [y0, w0, duration] = unknowns(entry, duration);
        let at = &frame.at;
        Sliding {
            law,
            sigma,
            order,
            duration: N::of(duration),
            y0: N::of(y0),
            w0: N::of(w0),
            inverse_mass: N::of(inverse(frame, at.ma, |by| by.ma)),
            damping: N::of(frame.jet(at.damping, |by| by.damping)),
            stiffness: N::of(frame.jet(at.h, |by| by.h)),
            friction: N::of(frame.jet(at.friction, |by| by.friction)),
            kappa: N::of(frame.kappa()),
            weight: N::of(frame.weight()),
            smoothing: N::of(frame.jet(at.smoothing, |by| by.smoothing)),
        }
    }

    /// The same zone without derivatives in its entry, duration and frame.
    pub fn frozen(&self) -> Sliding<Dual<2>> {
        let plain = |number: N| Dual::constant(number.value());
        Sliding {
            law: self.law,
            sigma: self.sigma,
            order: self.order,
            duration: plain(self.duration),
            y0: plain(self.y0),
            w0: plain(self.w0),
            inverse_mass: plain(self.inverse_mass),
            damping: plain(self.damping),
            stiffness: plain(self.stiffness),
            friction: plain(self.friction),
            kappa: plain(self.kappa),
            weight: plain(self.weight),
            smoothing: plain(self.smoothing),
        }
    }

    /// V̈ at (Y, W): with hV = hY + fgδ the weight enters as f(S − 1)gδ.
    pub fn acceleration(&self, y: N, w: N) -> N {
        let s = multiplier(self.law, self.sigma, w, self.smoothing);
        let drive = s
            .affine(1.0, -1.0)
            .times(self.weight)
            .add(s.times(self.kappa).times(w))
            .times(self.friction);
        let resistance = self.damping.times(w).add(self.stiffness.times(y));
        drive
            .add(resistance.affine(-1.0, 0.0))
            .times(self.inverse_mass)
    }

    /// (Y, W, ω) of a solution.
    pub fn end(&self, x: &[N; 2]) -> [N; 3] {
        let mut change = x[1];
        for _ in 0..self.order {
            change = change.times(self.duration);
        }
        let w = self.w0.add(change);
        let reduced = if self.order == 0 {
            w.affine(1.0, -1.0)
        } else {
            x[1]
        };
        [self.y0.add(self.duration.times(x[0])), w, reduced]
    }
}

impl<N: Number> Field<2, N> for Sliding<N> {
    fn rate(&self, x: &[N; 2]) -> [N; 2] {
        let [y, w, _] = self.end(x);
        let change = match self.order {
            0 => self.acceleration(y, w).times(self.duration),
            1 => self.acceleration(y, w),
            _ => {
                let moved = self.duration.times(x[1]);
                let s = multiplier(self.law, self.sigma, w, self.smoothing);
                let quotient =
                    multiplier_quotient(self.law, self.sigma, self.duration.times(moved));
                // S(W)κ(W − W₀) + (S − S₀)P₀, over T
                let pressure = self.weight.add(self.kappa.times(self.w0));
                let drive = s
                    .times(self.kappa)
                    .add(quotient.times(pressure))
                    .times(moved)
                    .times(self.friction);
                let resistance = self.damping.times(moved).add(self.stiffness.times(x[0]));
                drive
                    .add(resistance.affine(-1.0, 0.0))
                    .times(self.inverse_mass)
            }
        };
        [w, change]
    }
}

/// A separation zone.
#[derive(Clone, Copy, Debug)]
pub struct Separated<N> {
    order: usize,
    duration: N,
    v0: N,
    w0: N,
    steady: N,
    inverse_ma: N,
    inverse_mb: N,
    damping: N,
    g: N,
    h: N,
    kappa: N,
    weight: N,
    mismatch: N,
}

impl<N: Number> Separated<N> {
    /// The zone of this frame, entry and duration.
    pub fn new(frame: &Frame, order: usize, entry: [f64; 2], duration: f64) -> Separated<N> {
        let [y0, w0, duration] = unknowns(entry, duration);
        let at = &frame.at;
        Separated {
            order,
            duration: N::of(duration),
            v0: N::of(y0.plus(1.0, frame.steady())),
            w0: N::of(w0),
            steady: N::of(frame.steady()),
            inverse_ma: N::of(inverse(frame, at.ma, |by| by.ma)),
            inverse_mb: N::of(inverse(frame, at.mb, |by| by.mb)),
            damping: N::of(frame.jet(at.damping, |by| by.damping)),
            g: N::of(frame.jet(at.g, |by| by.g)),
            h: N::of(frame.jet(at.h, |by| by.h)),
            kappa: N::of(frame.kappa()),
            weight: N::of(frame.weight()),
            mismatch: N::of(frame.jet(at.mismatch, |by| by.mismatch)),
        }
    }

    /// The same zone without derivatives.
    pub fn frozen(&self) -> Separated<Dual<4>> {
        let plain = |number: N| Dual::constant(number.value());
        Separated {
            order: self.order,
            duration: plain(self.duration),
            v0: plain(self.v0),
            w0: plain(self.w0),
            steady: plain(self.steady),
            inverse_ma: plain(self.inverse_ma),
            inverse_mb: plain(self.inverse_mb),
            damping: plain(self.damping),
            g: plain(self.g),
            h: plain(self.h),
            kappa: plain(self.kappa),
            weight: plain(self.weight),
            mismatch: plain(self.mismatch),
        }
    }

    fn power(&self, x: N, count: usize) -> N {
        (0..count).fold(x, |x, _| x.times(self.duration))
    }

    /// (U, U̇, Y, W, γ) of a solution.
    pub fn end(&self, x: &[N; 4]) -> [N; 5] {
        let minus = self.steady.affine(-1.0, 0.0);
        [
            self.mismatch.add(self.power(x[0], self.order)),
            self.power(x[1], self.order.saturating_sub(1)),
            self.v0.add(self.duration.times(x[2])).add(minus),
            self.w0.add(self.duration.times(x[3])),
            x[0],
        ]
    }
}

impl<N: Number> Field<4, N> for Separated<N> {
    fn rate(&self, x: &[N; 4]) -> [N; 4] {
        let [gap, beta, eta, omega] = *x;
        let w = self.w0.add(self.duration.times(omega));
        let v = self.v0.add(self.duration.times(eta));
        let radial_rate = self.power(beta, self.order.saturating_sub(1));
        // −m_b Ü over the power of T that β′ leaves
        let resistance = if self.order == 3 {
            self.power(self.damping.times(beta), 1)
                .add(self.power(self.g.times(gap), 2))
                .add(self.kappa.times(omega))
        } else {
            self.damping
                .times(radial_rate)
                .add(self.g.times(self.power(gap, self.order)))
                .add(self.weight)
                .add(self.kappa.times(w))
        };
        let mut rise = resistance.affine(-1.0, 0.0).times(self.inverse_mb);
        let mut climb = beta;
        if self.order == 0 {
            rise = rise.times(self.duration);
            climb = climb.times(self.duration);
        }
        let drive = self.kappa.times(radial_rate);
        let drag = self.damping.times(w).add(self.h.times(v));
        let acceleration = drive.add(drag.affine(-1.0, 0.0)).times(self.inverse_ma);
        [climb, rise, w, acceleration]
    }
}
