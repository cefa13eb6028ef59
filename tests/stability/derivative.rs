//! The derivative of the characteristic function in λ against differences.
//!
//! t and d are sums of exponentials e^{−λτ} with delays τ up to a longest one, τ_max, apart from
//! slower factors. A fourth-order difference of step h then errs by about (hτ_max)⁴/30 of τ_max·|t|, and
//! rounding by ε(1 + |λ|τ_max)/(hτ_max) of it.

use brakewave::tube::stability::asymptotic::HighFrequency;
use brakewave::tube::stability::characteristic::{Characteristic, ScaledComplex};
use brakewave::tube::wave::start::Which;

use crate::stability::observed;
use crate::stability::waves::{C64, damped, follow, linearised, mode4, problem, tube};

/// h·τ_max.
const STEP: f64 = 2e-3;

/// Factors of both estimates: slower factors of λ and the operations of a matrix exponential.
const SAFETY: f64 = 50.0;

fn check(name: &str, characteristic: &Characteristic) {
    let delay = HighFrequency::new(characteristic)
        .longest_delay()
        .max(characteristic.period);
    let h = STEP / delay;
    let mut worst = 0.0_f64;
    for size in [0.0, 0.3, 2.0, 11.0, 130.0, 1e4] {
        for angle in [0.4, 1.2, 1.57, 1.9] {
            // far to the left nothing but the longest delay is left of t
            let mut lambda = C64::from_polar(size, angle);
            lambda.re = lambda.re.clamp(-3.0 / delay, 3.0 / delay);
            for pick in [
                |value: (ScaledComplex, ScaledComplex)| value.0,
                |value: (ScaledComplex, ScaledComplex)| value.1,
            ] {
                let at = |lambda: C64| {
                    let value = characteristic.evaluate(lambda);
                    pick((value.trace, value.determinant))
                };
                let f = |shift: f64| at(lambda + shift * h).number();
                let difference = ((f(1.0) - f(-1.0)) * 8.0 - (f(2.0) - f(-2.0))) / (12.0 * h);
                let exact = at(lambda);
                let derivative = exact.derivative * exact.exponent.exp();
                let scale = [-2.0, -1.0, 1.0, 2.0]
                    .iter()
                    .map(|shift| f(*shift).norm())
                    .fold(0.0, f64::max)
                    * delay;
                let rounding = f64::EPSILON * (1.0 + lambda.norm() * delay) / STEP;
                let allowed = SAFETY * (STEP.powi(4) / 30.0 + rounding) * scale;
                let error = (difference - derivative).norm();
                assert!(
                    error <= allowed,
                    "{name}, λ = {lambda}: {derivative} for {difference}, off by {error:e} of {scale:e}"
                );
                if scale > 0.0 {
                    worst = worst.max(error / scale / (STEP.powi(4) / 30.0 + rounding));
                }
            }
        }
    }
    observed(&format!("dF/dλ, {name}, in units of the estimate"), worst);
}

#[test]
fn derivative_in_lambda() {
    check("slip-stick", &linearised(&mode4(0.2), 4, Which::Fast));
    check("damped", &linearised(&damped(0.3), 4, Which::Fast));
    check("slow", &linearised(&mode4(2.0), 4, Which::Slow));
    check(
        "nearly incompressible",
        &linearised(&tube(0.4999, 1.5, 1e-4, 0.2), 4, Which::Fast),
    );
    // one wave of every signature of a branch: with reverse slip, separation, without stick
    let (mut problem, text) = problem("mode4_mismatch.ron");
    problem.stability = None;
    let mut seen = std::collections::BTreeSet::new();
    for item in follow(&problem, &text).items {
        let (wave, point) = item.wave();
        if item.point.kind.is_none() && seen.insert(item.point.regimes.clone()) {
            let characteristic = Characteristic::new(wave, point).expect("a linear law");
            check(&item.point.regimes, &characteristic);
        }
    }
    assert!(seen.len() > 4, "{seen:?}");
}
