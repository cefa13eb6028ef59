//! Sign of a smooth function over a whole interval through Bernstein polynomials, verified up to rounding.
//!
//! On a piece of a zone not longer than a radian a component of the flow equals its Taylor
//! polynomial of degree 16 up to a known remainder. In the Bernstein basis of that piece the
//! polynomial lies between its smallest and its largest coefficient, so coefficients of one sign
//! tell the sign on the whole piece; where they do not, the piece is halved. A known m-fold zero
//! at an end of the piece makes the m coefficients next to it vanish and divides out by leaving
//! them aside: p(t) = tᵐ·r(t) and the remaining coefficients are those of r, but for positive
//! factors.

use std::convert::Infallible;

use crate::continuation::zero::{Bracket, zero};

/// Degree of the Taylor polynomials. For pieces of one radian the remainder is 1/17! ≈ 3e-15 of
/// the amplitude.
pub(crate) const DEGREE: usize = 16;

pub(crate) const COEFFICIENTS: usize = DEGREE + 1;

/// 1/17!.
pub(crate) const REMAINDER: f64 = 2.8114572543455206e-15;

/// Halvings after which a piece is given up as undecided: 2⁻⁵⁰ of a piece is below rounding.
const DEEPEST: u32 = 50;

/// Rounding of a Bernstein coefficient relative to the largest Taylor coefficient: 17 additions.
const ROUNDING: f64 = 17.0 * f64::EPSILON;

/// A polynomial on \[0, 1\] by its Bernstein coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Bernstein {
    coefficients: [f64; COEFFICIENTS],
    /// Bound of |function − polynomial| and of the rounding of the coefficients.
    noise: f64,
}

/// The differences of a row of coefficients: the first and the last that exceed the noise (zero
/// if none does), and how often they change their sign.
struct Differences {
    first: f64,
    last: f64,
    changes: usize,
}

/// What could be shown of a function that should be positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignVerdict {
    /// Positive on the whole interval but for the known zeros at its ends.
    Positive,
    /// Negative somewhere, by more than rounding and remainder.
    Negative,
    /// Closer to zero than rounding and remainder allow to tell.
    Undecided,
}

impl SignVerdict {
    /// The verdict for two functions together.
    pub(crate) fn and(self, other: SignVerdict) -> SignVerdict {
        use SignVerdict::{Negative, Positive, Undecided};
        match (self, other) {
            (Negative, _) | (_, Negative) => Negative,
            (Undecided, _) | (_, Undecided) => Undecided,
            (Positive, Positive) => Positive,
        }
    }
}

/// C(j, i)/C(16, i), the conversion from Taylor coefficients i to Bernstein coefficients j.
const CONVERSION: [[f64; COEFFICIENTS]; COEFFICIENTS] = {
    let mut table = [[0.0; COEFFICIENTS]; COEFFICIENTS];
    let mut j = 0;
    while j < COEFFICIENTS {
        table[0][j] = 1.0;
        let mut i = 0;
        while i < j {
            // C(j, i+1)/C(n, i+1) = C(j, i)/C(n, i) · (j − i)/(n − i)
            table[i + 1][j] = table[i][j] * ((j - i) as f64) / ((DEGREE - i) as f64);
            i += 1;
        }
        j += 1;
    }
    table
};

impl Bernstein {
    /// The polynomial Σ aᵢtⁱ on \[0, 1\]; `remainder` bounds what the series leaves out.
    pub(crate) fn from_taylor(taylor: &[f64; COEFFICIENTS], remainder: f64) -> Bernstein {
        let mut coefficients = [0.0; COEFFICIENTS];
        for (row, a) in CONVERSION.iter().zip(taylor) {
            let sums = coefficients.iter_mut().zip(row);
            sums.for_each(|(sum, c)| *sum += c * a);
        }
        Bernstein {
            coefficients,
            noise: Bernstein::noise(taylor, remainder),
        }
    }

    /// Bound of what the polynomial of these coefficients leaves out, and of its rounding.
    pub(crate) fn noise(taylor: &[f64; COEFFICIENTS], remainder: f64) -> f64 {
        let size = taylor.iter().fold(0.0_f64, |size, a| size.max(a.abs()));
        remainder + ROUNDING * size
    }

    /// The two halves, by de Casteljau's scheme.
    fn halves(&self) -> (Bernstein, Bernstein) {
        let mut row = self.coefficients;
        let mut left = [0.0; COEFFICIENTS];
        let mut right = [0.0; COEFFICIENTS];
        for level in 0..COEFFICIENTS {
            left[level] = row[0];
            right[DEGREE - level] = row[DEGREE - level];
            for index in 0..DEGREE - level {
                row[index] = 0.5 * (row[index] + row[index + 1]);
            }
        }
        let half = |coefficients| Bernstein {
            coefficients,
            noise: self.noise,
        };
        (half(left), half(right))
    }

    /// Whether the function is positive on \[0, 1\], with a zero of order `at_start` known at 0
    /// and of order `at_end` known at 1.
    pub(crate) fn verdict(&self, at_start: usize, at_end: usize) -> SignVerdict {
        self.verdict_at(at_start, at_end, 0)
    }

    fn verdict_at(&self, at_start: usize, at_end: usize, depth: u32) -> SignVerdict {
        let inner = &self.coefficients[at_start..COEFFICIENTS - at_end];
        // next to a known zero the noise has the zero too: it is measured where the function is
        let noise = if at_start + at_end > 0 {
            self.noise
                .min(1e-12 * inner.iter().fold(0.0, |size: f64, b| size.max(b.abs())))
        } else {
            self.noise
        };
        if inner.iter().all(|b| *b > noise) {
            return SignVerdict::Positive;
        }
        // a coefficient at a free end is a value of the function itself
        if (at_start == 0 && inner[0] < -noise) || (at_end == 0 && inner[inner.len() - 1] < -noise)
        {
            return SignVerdict::Negative;
        }
        if inner.iter().all(|b| *b < -noise) {
            return SignVerdict::Negative;
        }
        if depth == DEEPEST || inner.iter().all(|b| b.abs() <= noise) {
            return SignVerdict::Undecided;
        }
        let (left, right) = self.halves();
        match left.verdict_at(at_start, 0, depth + 1) {
            SignVerdict::Negative => SignVerdict::Negative,
            first => first.and(right.verdict_at(0, at_end, depth + 1)),
        }
    }

    /// The place in \[0, 1\] from which on the function is negative, where it is by more than noise: the first
    /// one, however short the dip.
    pub(crate) fn first_crossing(&self) -> Option<f64> {
        self.crossing_at(0)
    }

    fn crossing_at(&self, depth: u32) -> Option<f64> {
        let inner = &self.coefficients;
        if inner.iter().all(|b| *b >= -self.noise) {
            return None;
        }
        if inner[0] < -self.noise || depth == DEEPEST {
            return Some(0.0);
        }
        let ends = [(0.0, inner[0]), (1.0, inner[DEGREE])];
        let changes = inner
            .windows(2)
            .filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0));
        let simple = ends[0].1 > 0.0 && ends[1].1 < -self.noise && changes.count() == 1;
        if simple {
            let bracket = Bracket::new(ends[0], ends[1]);
            let Ok(zero) = zero(bracket, f64::EPSILON, |place| {
                Ok::<_, Infallible>((self.value(place), ()))
            });
            return Some(zero.bracket.high.0);
        }
        let (left, right) = self.halves();
        let first = left.crossing_at(depth + 1).map(|place| 0.5 * place);
        let second = || right.crossing_at(depth + 1).map(|place| 0.5 + 0.5 * place);
        first.or_else(second)
    }

    /// A zero between 0 and a place at which the polynomial is negative, where it is positive at 0.
    pub(crate) fn zero_before(&self, place: f64) -> Option<f64> {
        let ends = [0.0, place].map(|place| (place, self.value(place)));
        if !(ends[0].1 > 0.0 && ends[1].1 < 0.0) {
            return None;
        }
        let bracket = Bracket::new(ends[0], ends[1]);
        let Ok(zero) = zero(bracket, f64::EPSILON * place, |place| {
            Ok::<_, Infallible>((self.value(place), ()))
        });
        Some(zero.bracket.high.0)
    }

    pub(crate) fn value(&self, t: f64) -> f64 {
        let mut row = self.coefficients;
        for level in 0..DEGREE {
            for index in 0..DEGREE - level {
                row[index] += t * (row[index + 1] - row[index]);
            }
        }
        row[0]
    }

    /// The least and the largest coefficient: the polynomial lies between them.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        let first = self.coefficients[0];
        let all = self.coefficients.iter();
        all.fold((first, first), |(low, high), b| (low.min(*b), high.max(*b)))
    }

    /// scale·self + offset.
    pub(crate) fn affine(&self, scale: f64, offset: f64) -> Bernstein {
        Bernstein {
            coefficients: self.coefficients.map(|b| scale * b + offset),
            noise: self.noise * scale.abs() + f64::EPSILON * offset.abs(),
        }
    }

    /// The place in \[0, 1) of every local minimum, in order.
    ///
    /// `falling` says whether the function fell at the end of the piece before (false at the
    /// first piece) and is brought up to date: a minimum may lie where two pieces meet.
    pub(crate) fn minima(&self, falling: &mut bool) -> Vec<f64> {
        let mut places = Vec::new();
        let slopes = self.slopes();
        if *falling && slopes.first > 0.0 {
            places.push(0.0);
        }
        if slopes.first != 0.0 {
            *falling = slopes.last < 0.0;
        }
        if slopes.changes > 0 {
            self.minima_in(0.0, 1.0, 0, &mut places);
        }
        places
    }

    /// Upper bound of the number of zeros of the derivative inside.
    pub(crate) fn turns(&self) -> usize {
        self.slopes().changes
    }

    /// Differences of neighbouring coefficients: the slope has no more changes of sign than they.
    fn slopes(&self) -> Differences {
        let mut slopes = Differences {
            first: 0.0,
            last: 0.0,
            changes: 0,
        };
        for pair in self.coefficients.windows(2) {
            let slope = pair[1] - pair[0];
            if slope.abs() <= self.noise {
                continue;
            }
            if slopes.first == 0.0 {
                slopes.first = slope;
            } else if (slope > 0.0) != (slopes.last > 0.0) {
                slopes.changes += 1;
            }
            slopes.last = slope;
        }
        slopes
    }

    fn minima_in(&self, from: f64, to: f64, depth: u32, places: &mut Vec<f64>) {
        let slopes = self.slopes();
        match slopes.changes {
            0 => {}
            1 if slopes.last < 0.0 => {}
            1 => places.push(from + (to - from) * self.stationary()),
            _ if depth < DEEPEST / 2 => {
                let (left, right) = self.halves();
                let middle = 0.5 * (from + to);
                left.minima_in(from, middle, depth + 1, places);
                right.minima_in(middle, to, depth + 1, places);
            }
            _ => places.push(0.5 * (from + to)),
        }
    }

    /// The one zero of the derivative.
    fn stationary(&self) -> f64 {
        let (mut low, high) = (0.0, 1.0);
        let (mut at_low, at_high) = (self.slope(low), self.slope(high));
        if at_low.abs() <= self.noise {
            // stationary already at the entry, as U̇ = 0 is at take-off, but for rounding: look beyond
            for exponent in 1..=40 {
                let place = 0.5_f64.powi(exponent);
                let slope = self.slope(place);
                if slope < 0.0 {
                    (low, at_low) = (place, slope);
                    break;
                }
            }
        }
        if at_low >= 0.0 {
            return low;
        }
        if at_high <= 0.0 {
            return high;
        }
        let bracket = Bracket::new((low, at_low), (high, at_high));
        let Ok(zero) = zero(bracket, 4.0 * f64::EPSILON, |place| {
            Ok::<_, Infallible>((self.slope(place), ()))
        });
        let Bracket { low, high, .. } = zero.bracket;
        if high.1 < -low.1 { high.0 } else { low.0 }
    }

    /// Derivative at t, up to the factor 16.
    fn slope(&self, t: f64) -> f64 {
        let mut row = [0.0; DEGREE];
        for (index, value) in row.iter_mut().enumerate() {
            *value = self.coefficients[index + 1] - self.coefficients[index];
        }
        for level in 1..DEGREE {
            for index in 0..DEGREE - level {
                row[index] += t * (row[index + 1] - row[index]);
            }
        }
        row[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Taylor coefficients of ∏(t − root).
    fn with_roots(roots: &[f64]) -> [f64; COEFFICIENTS] {
        let mut taylor = [0.0; COEFFICIENTS];
        taylor[0] = 1.0;
        for (degree, root) in roots.iter().enumerate() {
            for index in (0..=degree + 1).rev() {
                let lower = if index > 0 { taylor[index - 1] } else { 0.0 };
                taylor[index] = lower - root * taylor[index];
            }
        }
        taylor
    }

    #[test]
    fn sign_is_proven_or_refused() {
        let verdict = |roots: &[f64], at_start, at_end| {
            Bernstein::from_taylor(&with_roots(roots), 0.0).verdict(at_start, at_end)
        };
        assert_eq!(verdict(&[-0.1, -3.0], 0, 0), SignVerdict::Positive);
        assert_eq!(verdict(&[0.4, 0.4 + 1e-3], 0, 0), SignVerdict::Negative);
        assert_eq!(verdict(&[0.4, 0.4], 0, 0), SignVerdict::Undecided);
        // a dip whose depth is 1e-8 is seen, however narrow
        assert_eq!(verdict(&[0.3, 0.3002], 0, 0), SignVerdict::Negative);
        // zeros known at the ends do not count, zeros inside do
        assert_eq!(verdict(&[0.0, 0.0, -1.0], 2, 0), SignVerdict::Positive);
        assert_eq!(verdict(&[0.0, 1.0, 2.0], 1, 1), SignVerdict::Positive);
        assert_eq!(verdict(&[0.0, 0.5, 0.6], 1, 0), SignVerdict::Negative);
    }

    #[test]
    fn the_first_crossing_is_found_however_short_the_dip() {
        let first = |roots: &[f64]| {
            let bernstein = Bernstein::from_taylor(&with_roots(roots), 0.0);
            bernstein.first_crossing()
        };
        // (t − 0.4)(t − 0.4002) is negative for 2e-4 and 1e-8 deep: each root is known to noise over slope
        assert!((first(&[0.4, 0.4002]).unwrap() - 0.4).abs() < 1e-10);
        // a touch is no crossing
        assert_eq!(first(&[0.4, 0.4]), None);
        assert_eq!(first(&[-0.1, 1.2, 1.3]), None);
        // negative at once
        assert_eq!(first(&[0.5]), Some(0.0));
        // a bounce that lasts 1e-9 of the piece, its zero at the start divided out
        assert!((first(&[1e-9, 2.0]).unwrap() - 1e-9).abs() < 1e-15);
    }

    #[test]
    fn minima_are_found() {
        // (t − 0.2)²(t − 0.7)² has minima at 0.2 and 0.7
        let places =
            Bernstein::from_taylor(&with_roots(&[0.2, 0.2, 0.7, 0.7]), 0.0).minima(&mut false);
        assert_eq!(places.len(), 2);
        // the derivative is known to 1e-16 and has slope 0.5 there
        assert!((places[0] - 0.2).abs() < 1e-13 && (places[1] - 0.7).abs() < 1e-13);
    }
}
