//! Coefficients of the series of the relative exponential and of the logistic function.

use super::coefficients::CoefficientTable;
use super::{exprel, logistic};

/// Highest power of y in S: what is left out begins with y¹²/25!, where |a| ≤ 4 nothing in doubles, and it changes the coefficient
/// of order 17 by 1e-11 of itself.
const POWERS: usize = 11;

/// What is found with φ in a table: eᵃ or e^{a/2}, y, S and what it is summed by.
pub(super) const OF_EXPREL: usize = 2 + POWERS;

/// What is found with σ in a table: its complement and its slope.
pub(super) const OF_LOGISTIC: usize = 2;

impl CoefficientTable {
    /// The coefficient of order k of φ(a); `helper` is the first place of what is found with it.
    #[inline(always)]
    pub(super) fn exprel(&mut self, a: usize, own: usize, helper: usize, k: usize) {
        let x = self.value(a, 0);
        let over_k = |i: usize| i as f64 / k as f64;
        let (all, later) = ((0..k + 1, k), (1..k + 1, k));
        let near = x.abs() < exprel::APART;
        // eᵃ, or its root
        let part = if near { 0.5 } else { 1.0 };
        match k {
            0 => {
                let power = (part * x).exp();
                self.scale(helper, (a, 0), (power, part * power));
            }
            _ => self.convolve(helper, [a, helper], later, |i| part * over_k(i)),
        }
        if !near {
            return match k {
                0 => {
                    let [value, slope, ..] = exprel::derivatives(x);
                    self.scale(own, (a, 0), (value, slope));
                }
                // aφ = eᵃ − 1
                _ => self.divide((own, a), Some(helper), [own, a], (0..k, k), |_| -1.0),
            };
        }
        let (y, sums) = (helper + 1, helper + 2);
        self.convolve(y, [a, a], all.clone(), |_| 0.25);
        // S = s₀ with sⱼ = 1 + ysⱼ₊₁/((2j + 2)(2j + 3)), from the last one, which is 1
        for j in (0..POWERS).rev() {
            let factor = (((2 * j + 2) * (2 * j + 3)) as f64).recip();
            match j + 1 {
                POWERS => self.scale(sums + j, (y, k), (factor * self.value(y, k), factor)),
                next => self.convolve(sums + j, [y, sums + next], all.clone(), |_| factor),
            }
            if k == 0 {
                let sum = 1.0 + self.value(sums + j, 0);
                self.set(sums + j, 0, sum);
            }
        }
        self.convolve(own, [helper, sums], all, |_| 1.0);
    }

    /// The coefficient of order k of σ(a), by σ̇ = σ(1 − σ)ȧ; `helper` is the first place of what is found with it.
    #[inline(always)]
    pub(super) fn logistic(&mut self, a: usize, own: usize, helper: usize, k: usize) {
        let (complement, slope) = (helper, helper + 1);
        if k == 0 {
            let x = self.value(a, 0);
            let [value, first, second, _] = logistic::derivatives(x);
            self.scale(own, (a, 0), (value, first));
            self.scale(complement, (a, 0), (logistic::at(-x), -first));
            self.scale(slope, (a, 0), (first, second));
            return;
        }
        self.convolve(own, [a, slope], (1..k + 1, k), |i| i as f64 / k as f64);
        self.scale(complement, (own, k), (-self.value(own, k), -1.0));
        self.convolve(slope, [own, complement], (0..k + 1, k), |_| 1.0);
    }
}
