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

use faer::c64;

use super::growth::Hopf;
use crate::model::coefficients::Coefficients;
use crate::problem::Damping;

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
