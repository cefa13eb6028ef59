//! The friction laws as functions of the sliding velocity: Q = fSP with S = S(W).

use super::jet::JetNumber;
use crate::tube::model::FrictionLaw;

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
#[inline]
pub(crate) fn multiplier<N: JetNumber>(law: FrictionLaw, sigma: f64, w: N, smoothing: N) -> N {
    match law {
        FrictionLaw::Coulomb | FrictionLaw::Static { .. } => w.map(sigma, 0.0),
        FrictionLaw::Stribeck { ratio, velocity } => {
            let weakening = (ratio - 1.0) * (-sigma * (1.0 - w.value()) / velocity).exp();
            w.map(sigma * (1.0 + weakening), weakening / velocity)
        }
        FrictionLaw::Regularised { .. } => {
            let epsilon = smoothing.value();
            let inverse = smoothing.map(1.0 / epsilon, -1.0 / (epsilon * epsilon));
            let argument = (w * -1.0 + 1.0) * inverse;
            let value = argument.value().tanh();
            // sech² = 1 − tanh²
            argument.map(value, (1.0 - value) * (1.0 + value))
        }
    }
}

/// (S(1 + d) − S(1))/d, regular as d → 0.
pub(super) fn multiplier_quotient<N: JetNumber>(law: FrictionLaw, sigma: f64, d: N) -> N {
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
