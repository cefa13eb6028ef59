//! The logistic function σ(a) = 1/(1 + e⁻ᵃ).
//!
//! A gate of a channel, 1/(1 + exp((v₀ − v)/k)), or a step of a smooth relay: of a quotient the exponential has no value from
//! exp 710 on, where the function is 0 or 1 with all its derivatives zero. With the complement σ(−a) = 1 − σ(a), kept apart so that
//! it has all its digits where σ is 1, the slope is their product.

/// σ and its first derivatives, with c = 1 − σ: σc, σc(c − σ), σc((c − σ)² − 2σc).
pub(super) fn derivatives(a: f64) -> [f64; 4] {
    let [value, complement] = [at(a), at(-a)];
    let (slope, apart) = (value * complement, complement - value);
    let third = slope * (apart * apart - 2.0 * slope);
    [value, slope, slope * apart, third]
}

/// 1/(1 + e⁻ᵃ) by an exponential below one.
pub(super) fn at(a: f64) -> f64 {
    let power = (-a.abs()).exp();
    let above = if a < 0.0 { power } else { 1.0 };
    above / (1.0 + power)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It is (1 + tanh a/2)/2; small values have all their digits, and where the exponential has none they are 0 and 1.
    #[test]
    fn it_is_a_hyperbolic_tangent() {
        for a in [-40.0_f64, -3.0, -1e-3, 0.0, 0.7, 5.0] {
            let [value, slope, second, third] = derivatives(a);
            let t = (0.5 * a).tanh();
            let near = |one: f64, other: f64| (one - other).abs() <= 4.0 * f64::EPSILON;
            let by_t = 0.5 * 0.5 * (1.0 - t * t);
            assert!(near(value, 0.5 * (1.0 + t)) && near(slope, by_t), "{a}");
            assert!(near(second, -t * by_t), "{a}");
            assert!(near(third, by_t * (1.5 * t * t - 0.5)), "{a}");
        }
        let power = (-40.0_f64).exp();
        assert!((derivatives(-40.0)[0] / power - 1.0).abs() <= 4.0 * f64::EPSILON);
        assert_eq!(derivatives(1e4), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(derivatives(-1e4)[0], 0.0);
    }
}
