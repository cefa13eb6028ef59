//! From the complex stiffness κ of a perturbation to its growth and its Hopf point.
//!
//! Elasticity and friction are linear in the displacement; with mass damping α and stiffness
//! damping β every perturbation e^{ikφ+λt} of steady sliding obeys
//!
//! ```text
//! λ² + αλ + (1 + βλ)κ = 0,        κ = κ(k, f) complex, Im κ ≠ 0 with friction.
//! ```
//!
//! Undamped, λ = ±√−κ: one growing and one decaying wave. At a Hopf point λ = iω.
//!
//! # Friction that depends on the velocity
//! With Q = fS(V̇)P and S = 1 for Coulomb's law, the tube slides at V̇ = 0 with fS(0) in place of f,
//! and a perturbation v of V changes Q by fS(0)P̃ + fS′(0)P₀v̇ = fS(0)P̃ − f𝒹λv: the pressure
//! P₀ = gδ of steady sliding enters, in 𝒹 = −gδS′(0). Friction that falls as the velocity 1 − V̇ of
//! sliding grows has S′ > 0 and 𝒹 < 0: it feeds every wave. [`SteadyFriction`] carries S(0) and 𝒹.

use faer::c64;

use crate::tube::flow::friction::multiplier;
use crate::tube::flow::jet::MultiDual;
use crate::tube::model::{Damping, FrictionLaw};

/// What the friction law is at the velocity of steady sliding, by unit of f.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyFriction {
    /// S(0): the coefficient of friction is f times this.
    pub strength: f64,
    /// 𝒹 = −gδS′(0), in units of Ω: friction damps the motion along the shaft by f times this.
    pub drag: f64,
}

impl SteadyFriction {
    /// Friction that does not depend on the velocity.
    pub const COULOMB: SteadyFriction = SteadyFriction {
        strength: 1.0,
        drag: 0.0,
    };

    /// A law under the pressure P₀ = gδ.
    pub fn new(law: FrictionLaw, pressure: f64) -> SteadyFriction {
        let smoothing = MultiDual::constant(law.smoothing());
        let found: MultiDual<1> = multiplier(law, 1.0, MultiDual::variable(0.0, 0), smoothing);
        // no negative zero
        SteadyFriction {
            strength: found.value,
            drag: 0.0 - pressure * found.by[0],
        }
    }
}

/// A perturbation e^{ikφ+λt} as a wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyWave {
    /// Re λ, in units of Ω.
    pub growth: f64,
    /// ω = Im λ, in units of Ω.
    pub omega: f64,
    /// Speed −ω/k, in units of Ω; positive with the shaft.
    pub speed: f64,
}

impl SteadyWave {
    /// The wave with the larger growth of the two that belong to κ.
    pub fn fastest(kappa: c64, mode: u32, damping: Damping) -> SteadyWave {
        let [one, other] = eigenvalues(kappa, damping);
        SteadyWave::of(if one.re >= other.re { one } else { other }, mode)
    }

    /// The wave of an eigenvalue λ.
    pub(crate) fn of(lambda: c64, mode: u32) -> SteadyWave {
        SteadyWave {
            // no negative zero
            growth: lambda.re + 0.0,
            omega: lambda.im,
            speed: -lambda.im / f64::from(mode),
        }
    }
}

/// Steady sliding begins to flutter: λ = iω.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hopf {
    /// Friction coefficient f_H; zero without damping.
    pub friction: f64,
    /// ω, in units of Ω; the wave runs with speed −ω/k.
    pub omega: f64,
}

/// Both roots of λ² + (α + βκ)λ + κ = 0. The one of larger modulus is free of cancellation, the
/// other one follows from their product.
pub fn eigenvalues(kappa: c64, damping: Damping) -> [c64; 2] {
    let half = 0.5 * (c64::new(damping.mass, 0.0) + damping.stiffness * kappa);
    let root = square_root(half * half - kappa);
    let aligned = half.re * root.re + half.im * root.im >= 0.0;
    let larger = if aligned { -half - root } else { root - half };
    if larger.norm() == 0.0 {
        return [larger; 2];
    }
    if half.norm() == 0.0 {
        // exact, where the quotient would round
        return [larger, -larger];
    }
    [larger, kappa / larger]
}

/// Principal square root with both components to full relative precision: the growth of an
/// undamped wave at small friction is a small component beside a large one.
fn square_root(z: c64) -> c64 {
    let size = (0.5 * (z.re.abs() + z.norm())).sqrt();
    if size == 0.0 {
        return c64::new(0.0, 0.0);
    }
    let small = 0.5 * z.im.abs() / size;
    if z.re >= 0.0 {
        c64::new(size, small.copysign(z.im))
    } else {
        c64::new(small, size.copysign(z.im))
    }
}

/// κ(λ) = −(λ² + αλ)/(1 + βλ), and dκ/dλ.
pub fn stiffness_at(lambda: c64, damping: Damping) -> (c64, c64) {
    let (alpha, beta) = (damping.mass, damping.stiffness);
    let denominator = 1.0 + beta * lambda;
    let kappa = -(lambda * lambda + alpha * lambda) / denominator;
    let slope = -(2.0 * lambda + alpha + beta * kappa) / denominator;
    (kappa, slope)
}
