//! Matrices of order two of numbers with derivatives, and functions of them.

use std::array::from_fn;
use std::ops::{Add, Mul, Neg, Sub};

use super::jet::{JetNumber, MultiDual};

/// Two numbers: a radial and a tangential one.
pub(crate) type Pair<const D: usize> = [MultiDual<D>; 2];

/// A matrix of order two; row and column 0 are radial, 1 tangential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Square<const D: usize>(pub [Pair<D>; 2]);

/// Degree of the Taylor polynomial of exp(−X), ‖X‖ ≤ 1: the remainder is 1/19! ≈ 8e-18.
const DEGREE: u32 = 18;

impl<const D: usize> Square<D> {
    /// The matrix with these two numbers on its diagonal.
    pub(crate) fn diagonal(radial: MultiDual<D>, tangential: MultiDual<D>) -> Square<D> {
        let zero = MultiDual::default();
        Square([[radial, zero], [zero, tangential]])
    }

    /// A multiple of the unit matrix.
    pub(crate) fn unit(factor: f64) -> Square<D> {
        Square::diagonal(MultiDual::constant(factor), MultiDual::constant(factor))
    }

    fn entries(self, f: impl Fn(MultiDual<D>) -> MultiDual<D>) -> Square<D> {
        Square(self.0.map(|row| row.map(&f)))
    }

    /// The matrix with its derivatives in other quantities.
    pub(crate) fn map<const E: usize>(
        &self,
        f: impl Fn(MultiDual<D>) -> MultiDual<E>,
    ) -> Square<E> {
        Square(self.0.map(|row| row.map(&f)))
    }

    /// Its inverse, not finite where there is none.
    pub(crate) fn inverse(&self) -> Square<D> {
        let [[a, b], [c, d]] = self.0;
        let determinant = a * d - b * c;
        Square([[d, -b], [-c, a]]) * determinant.inverse()
    }

    /// Its largest row sum of moduli.
    pub(crate) fn norm(&self) -> f64 {
        let sums = self.0.map(|row| row[0].value.abs() + row[1].value.abs());
        sums[0].max(sums[1])
    }

    /// exp(−X) and the moments
    ///
    /// ```text
    /// p_m(X) = ∫₀¹ τ^{m−1}/(m−1)! e^{−Xτ} dτ = e^{−X} Σ_{j≥m} X^{j−m}/j!,   m = 1 … 4,
    /// ```
    ///
    /// from X/2ⁿ by doubling, a sum without cancellation for X that decays:
    /// p_m(2X) = 2^{−m}[p_m(X) + e^{−X} Σ_{j≤m} p_j(X)/(m−j)!].
    ///
    /// The doubling loses the smaller of two eigenvalues in the rounding of the larger: where they are
    /// far apart each has its moments.
    pub(crate) fn moments(&self) -> [Square<D>; 5] {
        let Some([(large, onto_large), (small, onto_small)]) = self.apart() else {
            return self.doubled_moments();
        };
        let of = |x: MultiDual<D>| {
            let moments = Square::diagonal(x, x).doubled_moments();
            moments.map(|moment| moment.0[0][0])
        };
        let (large, small) = (of(large), of(small));
        from_fn(|m| onto_large * large[m] + onto_small * small[m])
    }

    /// Both eigenvalues, positive ones that are far apart, with the projections on their vectors; the
    /// larger belongs to the first row. An entry that would cancel comes from
    /// (l − a)(l − d) = bc.
    fn apart(&self) -> Option<[(MultiDual<D>, Square<D>); 2]> {
        /// Eigenvalues of a smaller ratio are not told apart.
        const FAR: f64 = 16.0;
        let [[a, b], [c, d]] = self.0;
        let half = (a - d) * 0.5;
        let square = half * half + b * c;
        if !(square.value > 0.0 && half.value > 0.0) {
            return None;
        }
        let root = square.value.sqrt();
        let root = square.map(root, 0.5 / root);
        // l − d, and l − a = s − d but for the sign
        let rest = half + root;
        let small_rest = b * c * rest.inverse();
        let (large, small) = (a + small_rest, d - small_rest);
        if !(small.value > 0.0 && large.value > FAR * small.value) {
            return None;
        }
        let share = (root * 2.0).inverse();
        Some([
            (large, Square([[rest, b], [c, small_rest]]) * share),
            (small, Square([[small_rest, -b], [-c, rest]]) * share),
        ])
    }

    fn doubled_moments(&self) -> [Square<D>; 5] {
        let norm = self.norm();
        let halvings = if norm > 1.0 { norm.log2().ceil() } else { 0.0 };
        let x = *self * 0.5_f64.powi(halvings as i32);
        let (mut decay, mut tail) = (Square::unit(0.0), Square::unit(0.0));
        for j in (0..=DEGREE).rev() {
            // Σ (−X)^j/j! and Σ 4! X^j/(j+4)!
            decay = Square::unit(1.0) - x * decay * (1.0 / f64::from(j + 1));
            tail = Square::unit(1.0) + x * tail * (1.0 / f64::from(j + 5));
        }
        let fourth = decay * tail * (1.0 / 24.0);
        let third = decay * (1.0 / 6.0) + x * fourth;
        let second = decay * 0.5 + x * third;
        let first = decay + x * second;
        let mut moments = [decay, first, second, third, fourth];
        const FACTORIALS: [f64; 4] = [1.0, 1.0, 2.0, 6.0];
        for _ in 0..halvings as u32 {
            let [decay, ..] = moments;
            moments = from_fn(|m| {
                let beyond = (1..=m).fold(Square::unit(0.0), |sum, j| {
                    sum + moments[j] * (1.0 / FACTORIALS[m - j])
                });
                if m == 0 {
                    decay * decay
                } else {
                    (moments[m] + decay * beyond) * 0.5_f64.powi(m as i32)
                }
            });
        }
        moments
    }
}

impl<const D: usize> Mul for Square<D> {
    type Output = Square<D>;
    fn mul(self, other: Square<D>) -> Square<D> {
        let (x, y) = (self.0, other.0);
        Square(from_fn(|i| {
            from_fn(|j| x[i][0] * y[0][j] + x[i][1] * y[1][j])
        }))
    }
}

impl<const D: usize> Mul<Pair<D>> for Square<D> {
    type Output = Pair<D>;
    fn mul(self, [x, y]: Pair<D>) -> Pair<D> {
        self.0.map(|row| row[0] * x + row[1] * y)
    }
}

impl<const D: usize> Mul<MultiDual<D>> for Square<D> {
    type Output = Square<D>;
    fn mul(self, factor: MultiDual<D>) -> Square<D> {
        self.entries(|entry| entry * factor)
    }
}

impl<const D: usize> Mul<f64> for Square<D> {
    type Output = Square<D>;
    fn mul(self, factor: f64) -> Square<D> {
        self.entries(|entry| entry * factor)
    }
}

impl<const D: usize> Add for Square<D> {
    type Output = Square<D>;
    fn add(self, other: Square<D>) -> Square<D> {
        Square(from_fn(|i| from_fn(|j| self.0[i][j] + other.0[i][j])))
    }
}

impl<const D: usize> Sub for Square<D> {
    type Output = Square<D>;
    fn sub(self, other: Square<D>) -> Square<D> {
        self + -other
    }
}

impl<const D: usize> Neg for Square<D> {
    type Output = Square<D>;
    fn neg(self) -> Square<D> {
        self * -1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a diagonal matrix the moments are those of numbers: p_m = (p_{m−1} − e^{−x}/(m−1)!)/x, which
    /// is stable for large x, and 1/m! at 0.
    #[test]
    fn moments_are_incomplete_gamma_functions() {
        for (x, y) in [(1e6_f64, 40.0_f64), (7e9, 3.0)] {
            let matrix = Square::<0>::diagonal(MultiDual::constant(x), MultiDual::constant(y));
            for (index, value) in [x, y].into_iter().enumerate() {
                let moments = matrix.moments();
                let (mut p, mut factorial) = (-(-value).exp_m1() / value, 1.0);
                for (m, moment) in moments.iter().enumerate().skip(1) {
                    let seen = moment.0[index][index].value;
                    // each of the halvings doubles a relative error
                    assert!((seen / p - 1.0).abs() < 1e-14 * value.log2().max(10.0) * 10.0);
                    factorial *= m as f64;
                    p = (p - (-value).exp() / factorial) / value;
                }
            }
        }
        let none = Square::<0>::unit(0.0).moments();
        for (m, factorial) in [1.0, 1.0, 2.0, 6.0, 24.0].into_iter().enumerate() {
            assert!((none[m].0[0][0].value * factorial - 1.0).abs() < 1e-15);
        }
    }

    /// A matrix that is not diagonal: p₁(X)X = 1 − e^{−X}, and its derivative is that of differences;
    /// with eigenvalues near each other and far apart.
    #[test]
    fn moments_of_a_full_matrix() {
        moments_agree(2.0);
        moments_agree(0.2);
    }

    fn moments_agree(last: f64) {
        let matrix = |t: f64| {
            let entry = |value: f64| MultiDual {
                value: value * t,
                by: [value],
            };
            Square([[entry(5.0), entry(0.7)], [entry(-0.1), entry(last)]])
        };
        let [decay, first, ..] = matrix(1.0).moments();
        let left = first * matrix(1.0) + decay;
        let step = 1e-4;
        let (up, down) = (matrix(1.0 + step).moments(), matrix(1.0 - step).moments());
        for i in 0..2 {
            for j in 0..2 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((left.0[i][j].value - expected).abs() < 1e-14);
                for m in 0..5 {
                    let slope = (up[m].0[i][j].value - down[m].0[i][j].value) / (2.0 * step);
                    let seen = matrix(1.0).moments()[m].0[i][j].by[0];
                    // the third derivative is of the order 5³
                    assert!((slope - seen).abs() < 100.0 * step * step);
                }
            }
        }
    }
}
