//! Steady sliding in the reduced model.
//!
//! With U = δ the contact force is P = gδ − DV̂′ and friction makes Q = fP. For V = δfg/h + v and
//! v ∝ e^{ikφ+λt} there remains λ² + αλ + (1 + βλ)κ = 0 with
//!
//! ```text
//! κ = K + iS,      K = ak² + h,      S = kfD.
//! ```
//!
//! Put λ = iω: the imaginary part gives ω = −S/(α + βK), the real part K = ω² + βωS, hence
//!
//! ```text
//! f_H² = K(α + βK)² / (k²D²(1 − αβ − β²K)),      ω² = K/(1 − αβ − β²K),      ωD < 0:
//! ```
//!
//! the wave runs with the shaft where D > 0 and against it where D < 0. Where 1 − αβ − β²K ≤ 0
//! the mode is damped at any friction.
//!
//! Friction that depends on the velocity has S = kfS(0)D and α + f𝒹 in place of α
//! ([`SteadyFriction`]). Then f_H is the least zero of
//!
//! ```text
//! r(f) = fS(0)k|D|√(1 − βA) − A√K,      A = α + f𝒹 + βK.
//! ```
//!
//! For 𝒹 > 0 r is concave, and Newton's method from f = 0 rises to the least zero; for 𝒹 < 0 it is
//! convex, and Newton's method falls from A = 0, where r > 0, to the only one.

use faer::c64;

use super::growth::{Hopf, SteadyFriction};
use crate::tube::model::Damping;
use crate::tube::model::coefficients::Coefficients;

/// Steps of Newton's method for f_H: it converges from one side, and quadratically but where two
/// zeros of r coincide.
const MOST_STEPS: usize = 60;
/// Relative step of f at which it has converged: rounding.
const SETTLED: f64 = 1e-15;

/// One mode of the reduced model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduced {
    /// K = ak² + h.
    pub elastic: f64,
    /// kD.
    pub coupling: f64,
}

impl Reduced {
    /// Mode k of a tube.
    pub fn new(coefficients: &Coefficients, mode: u32) -> Reduced {
        let k = f64::from(mode);
        Reduced {
            elastic: coefficients.a * k * k + coefficients.h,
            coupling: k * coefficients.coupling,
        }
    }

    /// κ at a friction coefficient.
    pub fn stiffness(&self, friction: f64) -> c64 {
        c64::new(self.elastic, friction * self.coupling)
    }

    /// The Hopf point under a friction law; `None` where the mode is damped at any friction.
    pub(crate) fn hopf_sliding(&self, damping: Damping, sliding: SteadyFriction) -> Option<Hopf> {
        let (beta, drag) = (damping.stiffness, sliding.drag);
        let coupling = self.coupling.abs() * sliding.strength;
        if drag == 0.0 {
            return self.hopf(damping).map(|point| Hopf {
                friction: point.friction / sliding.strength,
                ..point
            });
        }
        let root = self.elastic.sqrt();
        let least = damping.mass + beta * self.elastic;
        let mut friction = if drag > 0.0 { 0.0 } else { least / -drag };
        if coupling == 0.0 {
            return None;
        }
        for _ in 0..MOST_STEPS {
            let damped = least + friction * drag;
            let margin = 1.0 - beta * damped;
            if margin <= 0.0 {
                return None;
            }
            let value = friction * coupling * margin.sqrt() - damped * root;
            let slope = coupling * (margin.sqrt() - 0.5 * friction * beta * drag / margin.sqrt())
                - drag * root;
            if slope <= 0.0 {
                return None;
            }
            let next = friction - value / slope;
            let settled = (next - friction).abs() <= SETTLED * next.abs();
            friction = next;
            if settled {
                break;
            }
        }
        let omega =
            -(root / (1.0 - beta * (least + friction * drag)).sqrt()) * self.coupling.signum();
        (friction.is_finite() && omega.is_finite()).then_some(Hopf { friction, omega })
    }

    /// The Hopf point; `None` where the mode is damped at any friction.
    pub fn hopf(&self, damping: Damping) -> Option<Hopf> {
        let (alpha, beta, elastic) = (damping.mass, damping.stiffness, self.elastic);
        let margin = 1.0 - alpha * beta - beta * beta * elastic;
        if margin <= 0.0 || self.coupling == 0.0 {
            return None;
        }
        let omega = -(elastic / margin).sqrt() * self.coupling.signum();
        let friction = (alpha + beta * elastic) * omega.abs() / self.coupling.abs();
        (friction.is_finite() && omega.is_finite()).then_some(Hopf { friction, omega })
    }
}
