//! Coefficients a, b, D, g, h of (M) from the tube: Poisson's ratio ν, ratio of radii ξ, and γ.
//!
//! The displacement field is X(r) = (ξ²/r − r)/(ξ² − 1) in both directions. Virtual work gives
//!
//! ```text
//! C = λ + 2μ = (1−ν)/((1+ν)(1−2ν)),   λ = ν/((1+ν)(1−2ν)),   μ = 1/(2(1+ν)),
//! I0 = ∫X² r dr,   I2 = ∫X²/r dr   over 1 < r < ξ,
//! γa = C I2/I0,   γb = μ I2/I0,   γD = −[C I2 − λ/2 + μ(I2 + ½)]/I0,
//! γg = [ξ² + 1/(1−2ν)]/[(1+ν)(ξ²−1)I0],   γh = ξ²/[(1+ν)(ξ²−1)I0].
//! ```
//!
//! The closed forms of I0 and I2 cancel as ξ → 1. With y = (ξ²−1)/(ξ²+1), so that ln ξ = artanh y,
//! they become series of positive terms,
//!
//! ```text
//! I0 = ¼ [ Σ_{j≥1} (1/(2j+1) + 1/(2j−1)) y^{2j−1} + Σ_{j≥2} 2/(2j−1) y^{2j−2} ],
//! I2 = Σ_{j≥1} y^{2j−1}/(4j²−1),
//! ```
//!
//! used for y < ½; beyond that the closed forms lose less than a digit.

use serde::{Deserialize, Serialize};

/// a, b, D, g, h of (M), all in units of Ω² since φ is an angle, or their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coefficients {
    /// Square of the tangential (longitudinal) wave speed, an angular one: a > b.
    pub a: f64,
    /// Square of the radial (shear) wave speed, b > 0.
    pub b: f64,
    /// Coupling D of radial and tangential motion; the wave runs in the direction of its sign.
    #[serde(rename = "D")]
    pub coupling: f64,
    /// Radial stiffness g > 0: the pressure of steady sliding is gδ.
    pub g: f64,
    /// Tangential stiffness h > 0: steady sliding has V = fgδ/h.
    pub h: f64,
}

/// The tube, of inner radius R: what its coefficients depend on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Geometry {
    /// Poisson's ratio, −1 < ν < ½.
    pub nu: f64,
    /// Outer by inner radius, ξ > 1.
    pub xi: f64,
    /// γ = ρR²Ω²/E > 0.
    pub gamma: f64,
}

/// Below this y the series are used. Their terms fall like y², so 30 terms reach 2⁻⁶⁰; above it
/// the closed forms cancel by less than a factor of 20.
const SERIES_LIMIT: f64 = 0.5;
const SERIES_TERMS: i32 = 30;

/// I0 and I2 with their derivatives in ξ.
#[derive(Clone, Copy, Debug)]
struct Integrals {
    i0: f64,
    i2: f64,
    i0_in_xi: f64,
    i2_in_xi: f64,
}

impl Integrals {
    fn new(xi: f64) -> Integrals {
        // (ξ − 1)(ξ + 1), because ξ² − 1 loses what ξ → 1 still carries
        let w = (xi - 1.0) * (xi + 1.0);
        let y = w / (xi * xi + 1.0);
        if y < SERIES_LIMIT {
            let (mut i0, mut i2, mut i0_in_y, mut i2_in_y) = (0.0, 0.0, 0.0, 0.0);
            // from the smallest term up
            for j in (1..=SERIES_TERMS).rev() {
                let n = f64::from(j);
                let odd = 0.25 * (1.0 / (2.0 * n + 1.0) + 1.0 / (2.0 * n - 1.0));
                let even = if j > 1 { 0.5 / (2.0 * n - 1.0) } else { 0.0 };
                let shear = 1.0 / (4.0 * n * n - 1.0);
                let (power, lower) = (y.powi(2 * j - 1), y.powi(2 * j - 2));
                i0 += odd * power + even * lower;
                i2 += shear * power;
                i0_in_y += odd * (2.0 * n - 1.0) * lower;
                if j > 1 {
                    i0_in_y += even * (2.0 * n - 2.0) * y.powi(2 * j - 3);
                }
                i2_in_y += shear * (2.0 * n - 1.0) * lower;
            }
            let y_in_xi = 4.0 * xi / (xi * xi + 1.0).powi(2);
            Integrals {
                i0,
                i2,
                i0_in_xi: i0_in_y * y_in_xi,
                i2_in_xi: i2_in_y * y_in_xi,
            }
        } else {
            let square = xi * xi;
            let log = xi.ln();
            let i0 = (square * square * log - square * w + 0.25 * w * (square + 1.0)) / (w * w);
            let i2 = (0.5 * w * (square + 1.0) - 2.0 * square * log) / (w * w);
            // with w as variable: (w²I0)′ = ξ² ln ξ² − w, (w²I2)′ = 1 + w − 1 − ln ξ²
            let i0_in_w = (2.0 * square * log - w) / (w * w) - 2.0 * i0 / w;
            let i2_in_w = (w - 2.0 * log) / (w * w) - 2.0 * i2 / w;
            Integrals {
                i0,
                i2,
                i0_in_xi: i0_in_w * 2.0 * xi,
                i2_in_xi: i2_in_w * 2.0 * xi,
            }
        }
    }
}

/// Lamé's C = λ + 2μ, λ and μ of a material with E = 1.
pub(crate) fn lame(nu: f64) -> [f64; 3] {
    let product = (1.0 + nu) * (1.0 - 2.0 * nu);
    [(1.0 - nu) / product, nu / product, 0.5 / (1.0 + nu)]
}

/// Elastic constants with their derivatives in ν.
struct Elastic {
    c: f64,
    lambda: f64,
    mu: f64,
    c_in_nu: f64,
    lambda_in_nu: f64,
    mu_in_nu: f64,
}

impl Elastic {
    fn new(nu: f64) -> Elastic {
        let product = (1.0 + nu) * (1.0 - 2.0 * nu);
        let [c, lambda, mu] = lame(nu);
        Elastic {
            c,
            lambda,
            mu,
            c_in_nu: 2.0 * nu * (2.0 - nu) / (product * product),
            lambda_in_nu: (1.0 + 2.0 * nu * nu) / (product * product),
            mu_in_nu: -0.5 / ((1.0 + nu) * (1.0 + nu)),
        }
    }
}

impl Geometry {
    /// The coefficients of (M), by the formulas at the top of this file.
    pub fn coefficients(&self) -> Coefficients {
        let Integrals { i0, i2, .. } = Integrals::new(self.xi);
        let Elastic { c, lambda, mu, .. } = Elastic::new(self.nu);
        let scale = 1.0 / (self.gamma * i0);
        let ring = scale / ((1.0 + self.nu) * (self.xi - 1.0) * (self.xi + 1.0));
        let square = self.xi * self.xi;
        Coefficients {
            a: c * i2 * scale,
            b: mu * i2 * scale,
            coupling: -(c * i2 - 0.5 * lambda + mu * (i2 + 0.5)) * scale,
            g: (square + 1.0 / (1.0 - 2.0 * self.nu)) * ring,
            h: square * ring,
        }
    }

    /// ∂/∂γ: every coefficient is proportional to 1/γ.
    pub(crate) fn derivative_in_gamma(&self) -> Coefficients {
        let value = self.coefficients();
        let factor = -1.0 / self.gamma;
        Coefficients {
            a: factor * value.a,
            b: factor * value.b,
            coupling: factor * value.coupling,
            g: factor * value.g,
            h: factor * value.h,
        }
    }

    /// Derivatives of the coefficients in ν, at constant ξ and γ.
    pub(crate) fn derivative_in_nu(&self) -> Coefficients {
        let value = self.coefficients();
        let Integrals { i0, i2, .. } = Integrals::new(self.xi);
        let elastic = Elastic::new(self.nu);
        let scale = 1.0 / (self.gamma * i0);
        let ring = scale / ((1.0 + self.nu) * (self.xi - 1.0) * (self.xi + 1.0));
        Coefficients {
            a: elastic.c_in_nu * i2 * scale,
            b: elastic.mu_in_nu * i2 * scale,
            coupling: -(elastic.c_in_nu * i2 - 0.5 * elastic.lambda_in_nu
                + elastic.mu_in_nu * (i2 + 0.5))
                * scale,
            g: 2.0 / (1.0 - 2.0 * self.nu).powi(2) * ring - value.g / (1.0 + self.nu),
            h: -value.h / (1.0 + self.nu),
        }
    }

    /// Derivatives of the coefficients in ξ, at constant ν and γ.
    pub(crate) fn derivative_in_xi(&self) -> Coefficients {
        let value = self.coefficients();
        let integrals = Integrals::new(self.xi);
        let Elastic { c, mu, .. } = Elastic::new(self.nu);
        let Integrals {
            i0,
            i2_in_xi,
            i0_in_xi,
            ..
        } = integrals;
        let scale = 1.0 / (self.gamma * i0);
        let w = (self.xi - 1.0) * (self.xi + 1.0);
        let ring = scale / ((1.0 + self.nu) * w);
        let log_i0 = i0_in_xi / i0;
        let log_ring = log_i0 + 2.0 * self.xi / w;
        Coefficients {
            a: c * i2_in_xi * scale - value.a * log_i0,
            b: mu * i2_in_xi * scale - value.b * log_i0,
            coupling: -(c + mu) * i2_in_xi * scale - value.coupling * log_i0,
            g: 2.0 * self.xi * ring - value.g * log_ring,
            h: 2.0 * self.xi * ring - value.h * log_ring,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of the derivation, computed by an independent program to 14 digits.
    #[test]
    fn coefficients_of_the_reference_tube() {
        let value = Geometry {
            nu: 0.3,
            xi: 1.5,
            gamma: 1.0,
        }
        .coefficients();
        for (found, expected) in [
            (value.a, 1.0875712069293),
            (value.b, 0.31073463055122),
            (value.coupling, -0.81095236229209),
            (value.g, 17.855545645728),
            (value.h, 8.4578900427131),
        ] {
            // half a unit of the last digit printed
            assert!((found / expected - 1.0).abs() < 1e-13, "{found} {expected}");
        }
    }

    /// Both forms of the integrals agree where they meet, to the cancellation of the closed form.
    #[test]
    fn series_and_closed_form_agree() {
        let y = SERIES_LIMIT;
        let xi = ((1.0 + y) / (1.0 - y)).sqrt();
        let below = Integrals::new(xi * (1.0 - 1e-12));
        let above = Integrals::new(xi * (1.0 + 1e-12));
        for (one, other) in [
            (below.i0, above.i0),
            (below.i2, above.i2),
            (below.i0_in_xi, above.i0_in_xi),
            (below.i2_in_xi, above.i2_in_xi),
        ] {
            assert!((one / other - 1.0).abs() < 2e-11, "{one} {other}");
        }
    }

    /// Thin tube: X falls linearly across ε = ξ − 1, so I0 → ε/3 and I2 → ε/3.
    #[test]
    fn thin_tube_limit() {
        for epsilon in [1e-4, 1e-6, 1e-8, 1e-10] {
            let integrals = Integrals::new(1.0 + epsilon);
            let exact = (1.0 + epsilon) - 1.0;
            assert!((integrals.i0 / exact * 3.0 - 1.0).abs() < 2.0 * epsilon + 1e-14);
            assert!((integrals.i2 / exact * 3.0 - 1.0).abs() < 2.0 * epsilon + 1e-14);
        }
    }

    /// Analytic derivatives against central differences; their error is O(step²) plus rounding/step.
    #[test]
    fn derivatives_match_differences() {
        for (nu, xi) in [
            (0.3, 1.5),
            (0.45, 1.25),
            (-0.4, 3.0),
            (0.3, 1.001),
            (0.4999, 1.8),
        ] {
            let geometry = Geometry { nu, xi, gamma: 0.7 };
            let fields = |value: Coefficients| [value.a, value.b, value.coupling, value.g, value.h];
            let compare = |analytic: Coefficients, step: f64, moved: &dyn Fn(f64) -> Geometry| {
                let (up, down) = (
                    fields(moved(step).coefficients()),
                    fields(moved(-step).coefficients()),
                );
                for (index, value) in fields(analytic).into_iter().enumerate() {
                    let difference = (up[index] - down[index]) / (2.0 * step);
                    let scale = value.abs().max(up[index].abs());
                    assert!(
                        (value - difference).abs() < 1e-5 * scale,
                        "{index}: {value} {difference} at ν {nu} ξ {xi}"
                    );
                }
            };
            let small = 1e-4 * (0.5 - nu).min(xi - 1.0);
            compare(geometry.derivative_in_nu(), small, &|step| Geometry {
                nu: nu + step,
                ..geometry
            });
            compare(geometry.derivative_in_xi(), small, &|step| Geometry {
                xi: xi + step,
                ..geometry
            });
            compare(geometry.derivative_in_gamma(), 1e-5, &|step| Geometry {
                gamma: 0.7 + step,
                ..geometry
            });
        }
    }
}
