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

use crate::tube::flow::friction::{multiplier, multiplier_quotient};
use crate::tube::flow::jet::{DURATION, ENTRY_W, ENTRY_Y, Jet, JetNumber, MultiDual};
use crate::tube::flow::{Frame, Quantities};
use crate::tube::model::FrictionLaw;

/// The right side of an autonomous system in D unknowns.
pub trait VectorField<const D: usize, N: JetNumber> {
    /// Whether there are two unknowns, and the rate of the first is affine in the second alone, with the same slope
    /// everywhere.
    const IS_CHAIN: bool = false;

    /// dx/dτ at x, τ from 0 to 1 over the zone.
    fn rate(&self, x: &[N; D]) -> [N; D];
}

/// The right side of a sliding zone, x = (η, ω).
#[derive(Clone, Copy, Debug)]
pub struct SlidingEquations<N> {
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
    [
        Jet::variable(entry[0], ENTRY_Y),
        Jet::variable(entry[1], ENTRY_W),
        Jet::variable(duration, DURATION),
    ]
}

fn inverse(frame: &Frame, mass: f64, by: impl Fn(&Quantities) -> f64) -> Jet {
    let moved = frame.number(by).by.map(|moved| -moved / (mass * mass));
    Jet::lifted(MultiDual {
        value: 1.0 / mass,
        by: moved,
    })
}

impl<N: JetNumber> SlidingEquations<N> {
    /// The zone of this frame, entry and duration.
    pub(crate) fn new(
        frame: &Frame,
        law: FrictionLaw,
        sigma: f64,
        order: usize,
        entry: [f64; 2],
        duration: f64,
    ) -> SlidingEquations<N> {
        let [y0, w0, duration] = unknowns(entry, duration);
        let at = &frame.at;
        SlidingEquations {
            law,
            sigma,
            order,
            duration: N::of(duration),
            y0: N::of(y0),
            w0: N::of(w0),
            inverse_mass: N::of(inverse(frame, at.ma, |by| by.ma)),
            damping: N::of(frame.quantity(|of| of.damping)),
            stiffness: N::of(frame.quantity(|of| of.h)),
            friction: N::of(frame.quantity(|of| of.friction)),
            kappa: N::of(frame.kappa()),
            weight: N::of(frame.weight()),
            smoothing: N::of(frame.quantity(|of| of.smoothing)),
        }
    }

    /// V̈ at (Y, W): with hV = hY + fgδ the weight enters as f(S − 1)gδ.
    #[inline]
    pub(crate) fn acceleration(&self, y: N, w: N) -> N {
        let s = multiplier(self.law, self.sigma, w, self.smoothing);
        let drive = ((s - 1.0) * self.weight + s * self.kappa * w) * self.friction;
        (drive - (self.damping * w + self.stiffness * y)) * self.inverse_mass
    }

    /// (Y, W, ω) of a solution.
    #[inline]
    pub(crate) fn end(&self, x: &[N; 2]) -> [N; 3] {
        let mut change = x[1];
        for _ in 0..self.order {
            change = change * self.duration;
        }
        let w = self.w0 + change;
        let reduced = if self.order == 0 { w - 1.0 } else { x[1] };
        [self.y0 + self.duration * x[0], w, reduced]
    }
}

impl<N: JetNumber> VectorField<2, N> for SlidingEquations<N> {
    // η′ = W₀ + T^m ω
    const IS_CHAIN: bool = true;

    #[inline]
    fn rate(&self, x: &[N; 2]) -> [N; 2] {
        let [y, w, _] = self.end(x);
        let change = match self.order {
            0 => self.acceleration(y, w) * self.duration,
            1 => self.acceleration(y, w),
            _ => {
                let moved = self.duration * x[1];
                let s = multiplier(self.law, self.sigma, w, self.smoothing);
                let quotient = multiplier_quotient(self.law, self.sigma, self.duration * moved);
                // S(W)κ(W − W₀) + (S − S₀)P₀, over T
                let pressure = self.weight + self.kappa * self.w0;
                let drive = (s * self.kappa + quotient * pressure) * moved * self.friction;
                (drive - (self.damping * moved + self.stiffness * x[0])) * self.inverse_mass
            }
        };
        [w, change]
    }
}

/// The right side of a separation zone, x = (γ, β, η, ω).
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

impl<N: JetNumber> Separated<N> {
    /// The zone of this frame, entry and duration.
    pub(crate) fn new(frame: &Frame, order: usize, entry: [f64; 2], duration: f64) -> Separated<N> {
        let [y0, w0, duration] = unknowns(entry, duration);
        let at = &frame.at;
        Separated {
            order,
            duration: N::of(duration),
            v0: N::of(y0 + frame.steady()),
            w0: N::of(w0),
            steady: N::of(frame.steady()),
            inverse_ma: N::of(inverse(frame, at.ma, |by| by.ma)),
            inverse_mb: N::of(inverse(frame, at.mb, |by| by.mb)),
            damping: N::of(frame.quantity(|of| of.damping)),
            g: N::of(frame.quantity(|of| of.g)),
            h: N::of(frame.quantity(|of| of.h)),
            kappa: N::of(frame.kappa()),
            weight: N::of(frame.weight()),
            mismatch: N::of(frame.quantity(|of| of.mismatch)),
        }
    }

    fn power(&self, x: N, count: usize) -> N {
        (0..count).fold(x, |x, _| x * self.duration)
    }

    /// (U, U̇, Y, W, γ) of a solution.
    pub(crate) fn end(&self, x: &[N; 4]) -> [N; 5] {
        [
            self.mismatch + self.power(x[0], self.order),
            self.power(x[1], self.order.saturating_sub(1)),
            self.v0 + self.duration * x[2] - self.steady,
            self.w0 + self.duration * x[3],
            x[0],
        ]
    }
}

impl<N: JetNumber> VectorField<4, N> for Separated<N> {
    fn rate(&self, x: &[N; 4]) -> [N; 4] {
        let [gap, beta, eta, omega] = *x;
        let w = self.w0 + self.duration * omega;
        let v = self.v0 + self.duration * eta;
        let radial_rate = self.power(beta, self.order.saturating_sub(1));
        // −m_b Ü over the power of T that β′ leaves
        let resistance = if self.order == 3 {
            self.power(self.damping * beta, 1) + self.power(self.g * gap, 2) + self.kappa * omega
        } else {
            let gap = self.power(gap, self.order);
            self.damping * radial_rate + self.g * gap + self.weight + self.kappa * w
        };
        let mut rise = resistance * -1.0 * self.inverse_mb;
        let mut climb = beta;
        if self.order == 0 {
            rise = rise * self.duration;
            climb = climb * self.duration;
        }
        let drag = self.damping * w + self.h * v;
        let acceleration = (self.kappa * radial_rate - drag) * self.inverse_ma;
        [climb, rise, w, acceleration]
    }
}
