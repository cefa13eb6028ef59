//! Periodic vectors of the eigenvalues: Aₖxₖ = αₖxₖ₊₁ from the right, y*ₖ₊₁Aₖ = αₖy*ₖ from the left. Their norms say how far an
//! error of a factor moves an eigenvalue.

use super::chain::Chain;
use super::product::{Number, Product, size, times_power};

impl Chain<Number> {
    /// A diagonal of all factors.
    fn diagonal(&self, j: usize) -> Vec<Number> {
        (0..self.count)
            .map(|factor| self.at(factor, j, j))
            .collect()
    }

    /// Norms of the periodic right vectors of the eigenvalue j, whose own component is 1, and of the left ones, before every
    /// factor.
    pub(super) fn vectors(&self, j: usize, logs: &[f64], diagonals: &Diagonals) -> [Vec<f64>; 2] {
        let (n, count) = (self.n, self.count);
        let (zero, one) = (Number::new(0.0, 0.0), Number::new(1.0, 0.0));
        let Diagonals { forward, backward } = diagonals;
        // components of one index together; before they are known, what the others add to them
        let mut right = vec![zero; (j + 1) * count];
        for l in (0..=j).rev() {
            let (before, own) = right.split_at_mut(l * count);
            let own = &mut own[..count];
            match l == j {
                true => own.fill(one),
                false => cyclic([&forward[l], &forward[j]], own, logs[l] - logs[j]),
            }
            for (k, by) in own.iter().enumerate() {
                let begin = (k * n + l) * n;
                let column = &self.entries[begin..begin + l];
                let places = before.iter_mut().skip(k).step_by(count);
                places
                    .zip(column)
                    .for_each(|(place, entry)| *place += entry * by);
            }
        }
        // row vectors go the other way round: that before factor k follows from that after it, and has place count − k
        let mut left = vec![zero; (n - j) * count];
        left[..count].fill(one);
        for i in j + 1..n {
            let (before, own) = left.split_at_mut((i - j) * count);
            let own = &mut own[..count];
            for (m, sum) in own.iter_mut().enumerate() {
                let begin = ((count - 1 - m) * n + i) * n;
                let column = &self.entries[begin + j..begin + i];
                let known = before.iter().skip(m).step_by(count);
                *sum = known.zip(column).map(|(one, entry)| one * entry).sum();
            }
            cyclic([&backward[i], &backward[j]], own, logs[i] - logs[j]);
        }
        let norms = |all: &[Number], place: &dyn Fn(usize) -> usize| {
            let length = |k: usize| {
                let components = all.iter().skip(place(k)).step_by(count);
                components.map(|one| one.norm_sqr()).sum::<f64>().sqrt()
            };
            (0..count).map(length).collect()
        };
        [
            norms(&right, &|k| k),
            norms(&left, &|k| (count - k) % count),
        ]
    }
}

/// The diagonals of all factors, those of one index together.
pub(super) struct Diagonals {
    /// Those of the first factor first.
    pub forward: Vec<Vec<Number>>,
    /// Those of the last factor first.
    backward: Vec<Vec<Number>>,
}

impl Diagonals {
    pub fn of(chain: &Chain<Number>) -> Diagonals {
        let forward: Vec<Vec<Number>> = (0..chain.n).map(|j| chain.diagonal(j)).collect();
        let back = |list: &Vec<Number>| list.iter().rev().copied().collect();
        Diagonals {
            backward: forward.iter().map(back).collect(),
            forward,
        }
    }
}

/// In place of the numbers bₖ those uₖ with dₖuₖ₊₁ = aₖuₖ + bₖ that come back to the first, a and d the diagonals of two
/// indices as the factors are gone through; `ratio` is the logarithm of |∏aₖ/dₖ|.
fn cyclic([a, d]: [&[Number]; 2], numbers: &mut [Number], ratio: f64) {
    let (count, zero) = (a.len(), Number::new(0.0, 0.0));
    if ratio.is_nan() {
        // both are zero: what they have in common is none of their condition
        numbers.fill(zero);
        return;
    }
    // the way on which they shrink: u becomes (gain)u + (what is added)
    let forward = ratio <= 0.0;
    let place = |step: usize| if forward { step } else { count - 1 - step };
    let gain = |k: usize| if forward { a[k] / d[k] } else { d[k] / a[k] };
    let mut once = zero;
    let mut product = Product::ONE;
    for k in (0..count).map(place) {
        let by = gain(k);
        numbers[k] = if forward {
            numbers[k] / d[k]
        } else {
            -numbers[k] / a[k]
        };
        once = by * once + numbers[k];
        product.times(by);
    }
    let around = times_power(product.number, product.exponent);
    let mut apart = Number::new(1.0, 0.0) - around;
    // eigenvalues are not told apart by less than their rounding
    let least = f64::EPSILON * count as f64;
    if size(apart) < least {
        apart = Number::new(least, 0.0);
    }
    let mut u = once / apart;
    for k in (0..count).map(place) {
        let next = gain(k) * u + numbers[k];
        numbers[k] = if forward { u } else { next };
        u = next;
    }
}
