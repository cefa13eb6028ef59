//! From the complex stiffness κ of a perturbation to its growth and its Hopf point.
//!
//! Elasticity and friction are linear in the displacement; with mass damping α and stiffness
//! damping β every perturbation e^{ikφ+λt} of steady sliding obeys
//!
//! ```text
//! λ² + αλ + (1 + βλ)κ = 0,        κ = κ(k, f) complex, Im κ ≠ 0 with friction.
//! ```
//!
//! Undamped, λ = ±√−κ: one growing and one decaying wave. At a Hopf point λ = iω, so that κ lies
//! on the curve
//!
//! ```text
//! κ = (ω² − iαω)/(1 + iβω).
//! ```

use faer::c64;

use crate::problem::Damping;

/// A perturbation e^{ikφ+λt} as a wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Re λ, in units of Ω.
    pub growth: f64,
    /// ω = Im λ, in units of Ω.
    pub omega: f64,
    /// Speed −ω/k, in units of Ω; positive with the shaft.
    pub speed: f64,
}

impl Wave {
    /// The wave with the larger growth of the two that belong to κ.
    pub fn fastest(kappa: c64, mode: u32, damping: Damping) -> Wave {
        let [one, other] = eigenvalues(kappa, damping);
        let lambda = if one.re >= other.re { one } else { other };
        Wave {
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

/// κ(ω) on the curve of Hopf points, and dκ/dω.
pub fn hopf_curve(omega: f64, damping: Damping) -> (c64, c64) {
    let (alpha, beta) = (damping.mass, damping.stiffness);
    let numerator = c64::new(omega * omega, -alpha * omega);
    let denominator = c64::new(1.0, beta * omega);
    let kappa = numerator / denominator;
    let slope = (c64::new(2.0 * omega, -alpha) - c64::new(0.0, beta) * kappa) / denominator;
    (kappa, slope)
}
