//! The linearised motion over a period, by its multipliers, and what changes its sign where one of these passes.

use nalgebra::Complex;

use super::multiplier::{Multiplier, own};

/// The linearised motion over a period, by its multipliers.
#[derive(Clone, Debug)]
pub struct Monodromy {
    /// Multipliers that are not trivial, the largest first.
    pub(super) own: Vec<Multiplier>,
    /// How fast every guard falls at the end of its zone, scaled to order one.
    pub(super) falls: Vec<f64>,
    /// Whether one of these is zero and a jump infinite with it.
    pub(super) grazes: bool,
    /// Dimensions that are taken away.
    pub(super) zeros: usize,
    /// Dimensions in which everything stays: the shift in time without forcing, and what is kept of the start.
    pub(super) ones: usize,
}

impl Monodromy {
    /// All multipliers, the largest first.
    pub fn multipliers(&self) -> Vec<Multiplier> {
        let trivial = |value: f64| Multiplier {
            value: Complex::new(value, 0.0),
            trivial: true,
            error: 0.0,
        };
        let ones = (0..self.ones).map(|_| trivial(1.0));
        let mut all: Vec<Multiplier> = self.own.iter().copied().chain(ones).collect();
        all.sort_by(|one, other| other.value.norm().total_cmp(&one.value.norm()));
        all.extend((0..self.zeros).map(|_| trivial(0.0)));
        all
    }

    /// Of all multipliers det(M + 1), det(M − 1) and ∏(1 − μᵢμⱼ) over pairs, of what is not trivial: they change their sign where
    /// a multiplier passes −1, where one passes 1, and where a pair has the product 1.
    ///
    /// At a graze one multiplier is infinite. The determinants have a simple pole there, which the speeds of the
    /// guards divide out; the product is not looked at. Entries of M are so large then that its determinant is lost
    /// in rounding: the multipliers are not.
    pub fn tests(&self, multipliers: &[Multiplier]) -> [f64; 3] {
        let values: Vec<Complex<f64>> = own(multipliers).map(|one| one.value).collect();
        // where nothing is left no speed is divided out
        let speeds: f64 = match values.is_empty() {
            true => 1.0,
            false => self.falls.iter().product(),
        };
        let shifted = |by: f64| {
            let product: Complex<f64> = values.iter().map(|value| value + by).product();
            // a multiplier that a switch takes away is zero
            speeds * f64::powi(by, self.zeros as i32) * product.re
        };
        let torus = || {
            let factors = pairs(values.len()).map(|(i, j)| 1.0 - values[i] * values[j]);
            factors.product::<Complex<f64>>().re
        };
        let tests = [
            shifted(1.0),
            shifted(-1.0),
            if self.grazes { 0.0 } else { torus() },
        ];
        let finite = |test: f64| if test.is_finite() { test } else { 0.0 };
        tests.map(finite)
    }

    /// The pair of multipliers whose product is nearest to 1.
    fn nearest_pair(&self) -> Option<[Complex<f64>; 2]> {
        let (i, j) = self.place_of_nearest_pair()?;
        Some([self.own[i].value, self.own[j].value])
    }

    fn place_of_nearest_pair(&self) -> Option<(usize, usize)> {
        let values: Vec<Complex<f64>> = self.own.iter().map(|one| one.value).collect();
        let far = |&(i, j): &(usize, usize)| (1.0 - values[i] * values[j]).norm();
        pairs(values.len()).min_by(|one, other| far(one).total_cmp(&far(other)))
    }

    /// The multipliers of that pair with the derivatives of ∏(1 − μᵢμⱼ) in them where their own factor is zero: of two
    /// that are conjugate one, for both.
    pub fn slopes_of_pair(&self) -> Option<Vec<(Complex<f64>, Complex<f64>)>> {
        let (i, j) = self.place_of_nearest_pair()?;
        let value = |index: usize| self.own[index].value;
        let others = pairs(self.own.len()).filter(|pair| *pair != (i, j));
        let rest: Complex<f64> = others.map(|(i, j)| 1.0 - value(i) * value(j)).product();
        let slope = |one: usize, other: usize| (value(one), -value(other) * rest);
        if value(i).im == 0.0 {
            return Some(vec![slope(i, j), slope(j, i)]);
        }
        let (value, by) = slope(i, j);
        (value == self.own[j].value.conj()).then(|| vec![(value, 2.0 * by)])
    }

    /// Argument of that pair, between 0 and π; `None` where they are real: a saddle whose multipliers are μ and
    /// 1/μ.
    pub fn angle_on_circle(&self) -> Option<f64> {
        let [one, _] = self.nearest_pair()?;
        (one.im != 0.0).then(|| one.arg().abs())
    }

    /// Half the sum of that pair: the cosine of its angle where it is on the unit circle.
    pub fn cosine(&self) -> Option<f64> {
        let [one, other] = self.nearest_pair()?;
        Some(0.5 * (one.re + other.re))
    }
}

/// All pairs i < j of so many.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(|j| (0..j).map(move |i| (i, j)))
}
