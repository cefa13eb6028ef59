//! The relative exponential φ(a) = (eᵃ − 1)/a = ∫₀¹ e^{sa} ds, 1 where a is zero.
//!
//! A quotient κa/(eᵃ − 1), as in the rates of Hodgkin and Huxley's channels (J. Physiol. 117, 1952), has a value where it is 0/0, and
//! its series in time no pole there. Division by the small number a₀ would amplify the rounding of every order by the ones
//! before it, so that a series beside a = 0 would end where a vanishes. There φ = e^{a/2}S(a²/4), S(y) = Σ yʲ/(2j + 1)!, has no
//! quotient.

use crate::interval::Interval;

/// |a| from which on φ is a quotient: a piece whose length is for sixteen digits at order 17 moves a by an eighth of its distance
/// from the pole of 1/φ at 2πi, which is less, so that errors of earlier orders do not grow.
pub(super) const APART: f64 = 1.0;

/// Terms of Σ aʲ/(j!(j + m + 1)) for |a| ≤ 1: the next one is 1/20!.
const TERMS: usize = 20;

/// φ and its first derivatives ∫₀¹ sᵐe^{sa} ds: by parts each is (eᵃ − m times the one before)/a.
pub(super) fn derivatives(a: f64) -> [f64; 4] {
    let mut last = a.exp_m1() / a;
    std::array::from_fn(|m| {
        if a.abs() < APART {
            return series(a, m);
        }
        if m > 0 {
            last = (a.exp() - m as f64 * last) / a;
        }
        last
    })
}

/// Σ aʲ/(j!(j + m + 1)).
fn series(a: f64, m: usize) -> f64 {
    let from_the_last = (0..TERMS).rev();
    from_the_last.fold(0.0, |sum, j| {
        ((j + m + 1) as f64).recip() + a * sum / (j + 1) as f64
    })
}

/// φ in an interval, where it increases.
pub(super) fn enclose(a: Interval) -> Interval {
    match a.is_empty() {
        true => a,
        false => Interval::new(at(a.low).low, at(a.high).high),
    }
}

fn at(a: f64) -> Interval {
    let a = Interval::point(a);
    let one = Interval::ONE;
    if a.low.abs() >= APART {
        return (a.exp() - one) / a;
    }
    // Σ aʲ/(j + 1)!, what is left out being at most twice its first term
    let mut sum = Interval::new(0.0, 2.0);
    for j in (1..=TERMS).rev() {
        sum = one + a * sum / Interval::point((j + 1) as f64);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against ∫₀¹ sᵐe^{sa} ds by Simpson's rule of 2000 parts, whose error is 1/2880 of the fourth derivative, at most
    /// e^{|a|}(1 + |a|)⁴·24, by the fourth power of a part; at zero they are 1/(m + 1).
    #[test]
    fn derivatives_are_moments_of_the_exponential() {
        for a in [-7.0_f64, -1.0, -0.99, -1e-9, 0.0, 1e-300, 0.3, 1.0, 2.5] {
            for (m, found) in derivatives(a).into_iter().enumerate() {
                let at = |s: f64| s.powi(m as i32) * (s * a).exp();
                let parts = 2000;
                let width = 1.0 / f64::from(parts);
                let part = |i: i32| {
                    let s = f64::from(i) * width;
                    at(s) + 4.0 * at(s + 0.5 * width) + at(s + width)
                };
                let integral = (0..parts).map(part).sum::<f64>() * width / 6.0;
                let bound = a.abs().exp() * (1.0 + a.abs()).powi(4) * 24.0 / 2880.0;
                let error = bound * width.powi(4) + 1e-14 * integral;
                assert!((found - integral).abs() <= error, "{a}, {m}");
                let interval = enclose(Interval::point(a));
                assert!(m > 0 || interval.low <= found && found <= interval.high);
                assert!(m > 0 || interval.high - interval.low <= 1e-14 * found);
            }
        }
    }
}
