//! Signs and turning points of a smooth function over a short piece: by its Taylor coefficients where these fall so
//! fast that the first of them decide, by its Bernstein polynomial where they do not.

use crate::orbit::sign::{Bernstein, COEFFICIENTS, DEGREE, SignVerdict};

/// Steps of Newton's method to a turning point at most: they converge quadratically.
const STEPS: usize = 12;

/// A function over a piece.
pub(super) struct Smooth<'a> {
    taylor: &'a [f64; COEFFICIENTS],
    left_out: f64,
}

/// What its coefficients tell of the slope.
enum Slope {
    /// It has the sign of this number all along.
    Keeps(f64),
    /// It grows, or falls, all along: it is this at the beginning and that at the end.
    Monotone(f64, f64),
    /// They do not tell.
    Open,
}

impl<'a> Smooth<'a> {
    /// The polynomial Σ aₖtᵏ on \[0, 1\], but for what it leaves out.
    pub fn new(taylor: &'a [f64; COEFFICIENTS], left_out: f64) -> Smooth<'a> {
        Smooth { taylor, left_out }
    }

    /// Bound of what its values may be off by.
    fn noise(&self) -> f64 {
        Bernstein::noise(self.taylor, self.left_out)
    }

    fn bernstein(&self) -> Bernstein {
        Bernstein::from_taylor(self.taylor, self.left_out)
    }

    /// The sizes of the derivatives of orders 0, 1 and 2 at the beginning, less all that they may change by.
    fn kept(&self) -> [f64; 3] {
        let [a0, a1, a2, ..] = self.taylor.map(f64::abs);
        let mut kept = [a0 - a1 - a2, a1 - 2.0 * a2, 2.0 * a2];
        for (k, a) in self.taylor.iter().enumerate().skip(3) {
            let (k, a) = (k as f64, a.abs());
            kept[0] -= a;
            kept[1] -= k * a;
            kept[2] -= k * (k - 1.0) * a;
        }
        kept
    }

    fn slope(&self, [_, first, second]: [f64; 3]) -> Slope {
        // slopes in the unit of the differences of Bernstein coefficients
        let noise = DEGREE as f64 * self.noise();
        let begin = self.taylor[1];
        if first > noise {
            return Slope::Keeps(begin);
        }
        let end = self.slopes(1.0).0;
        if second > 0.0 && begin.abs() > noise && end.abs() > noise {
            return Slope::Monotone(begin, end);
        }
        Slope::Open
    }

    /// Slope and curvature.
    fn slopes(&self, place: f64) -> (f64, f64) {
        let (mut slope, mut curvature) = (0.0, 0.0);
        for (k, a) in self.taylor.iter().enumerate().skip(1).rev() {
            curvature = curvature * place + slope;
            slope = slope * place + k as f64 * a;
        }
        (slope, curvature)
    }

    fn value(&self, place: f64) -> f64 {
        self.taylor.iter().rev().fold(0.0, |sum, a| sum * place + a)
    }

    /// Where the slope is zero that grows, or falls, from one sign to the other.
    fn stationary(&self, begin: f64, end: f64) -> Option<f64> {
        let mut place = begin / (begin - end);
        for _ in 0..STEPS {
            let (slope, curvature) = self.slopes(place);
            let next = (place - slope / curvature).clamp(0.0, 1.0);
            let step = (next - place).abs();
            place = next;
            if step <= 1e-9 {
                return Some(place);
            }
        }
        None
    }

    /// Whether it is positive, with zeros of these orders known at its ends; and, in order, the places of its local
    /// minima. `falling` says whether it fell at the end of the piece before, and is brought up to date.
    pub fn examined(
        &self,
        at_start: usize,
        at_end: usize,
        falling: &mut bool,
    ) -> (SignVerdict, Vec<f64>) {
        let kept = self.kept();
        let mut bernstein = None;
        let verdict = if at_start + at_end == 0 && kept[0] > self.noise() {
            match self.taylor[0] > 0.0 {
                true => SignVerdict::Positive,
                false => SignVerdict::Negative,
            }
        } else {
            bernstein
                .get_or_insert_with(|| self.bernstein())
                .verdict(at_start, at_end)
        };
        let told = match self.slope(kept) {
            Slope::Keeps(slope) => Some((slope, slope, None)),
            Slope::Monotone(begin, end) if begin < 0.0 && end > 0.0 => {
                let place = self.stationary(begin, end);
                place.map(|place| (begin, end, Some(place)))
            }
            Slope::Monotone(begin, end) => Some((begin, end, None)),
            Slope::Open => None,
        };
        let Some((begin, end, within)) = told else {
            let bernstein = bernstein.unwrap_or_else(|| self.bernstein());
            return (verdict, bernstein.minima(falling));
        };
        let between = (*falling && begin > 0.0).then_some(0.0);
        *falling = end < 0.0;
        (verdict, between.into_iter().chain(within).collect())
    }

    /// Widens bounds that hold at both ends so that they hold in between.
    pub fn widen(&self, bounds: &mut (f64, f64)) {
        let turns = self.turns(*bounds);
        let (low, high) = bounds;
        for value in turns.into_iter().map(|place| self.value(place)) {
            (*low, *high) = (low.min(value), high.max(value));
        }
    }

    /// Whether its coefficients say that it stays within bounds.
    pub fn stays(&self, (low, high): (f64, f64)) -> bool {
        let reach: f64 = self.taylor[1..].iter().map(|a| a.abs()).sum();
        let first = self.taylor[0];
        first - reach >= low && first + reach <= high
    }

    /// The places at which it turns where it may leave bounds that hold at both ends.
    pub fn turns(&self, (low, high): (f64, f64)) -> Vec<f64> {
        if self.stays((low, high)) {
            return Vec::new();
        }
        let turns = match self.slope(self.kept()) {
            Slope::Keeps(_) => return Vec::new(),
            Slope::Monotone(begin, end) if (begin > 0.0) == (end > 0.0) => return Vec::new(),
            Slope::Monotone(begin, end) => self.stationary(begin, end),
            Slope::Open => None,
        };
        turns.map_or_else(
            || {
                let polynomial = self.bernstein();
                let (least, largest) = polynomial.bounds();
                let minima = (least < low).then(|| polynomial.minima(&mut false));
                let upside_down = || polynomial.affine(-1.0, 0.0).minima(&mut false);
                let maxima = (largest > high).then(upside_down);
                [minima, maxima].into_iter().flatten().flatten().collect()
            },
            |turn| vec![turn],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the first coefficients tell is what Bernstein polynomials do, for pieces of cosines at all phases.
    #[test]
    fn coefficients_tell_what_bernstein_polynomials_do() {
        let mut told = 0;
        for step in 0..200 {
            let (phase, length) = (0.0317 * f64::from(step), 0.2 + 0.004 * f64::from(step));
            // derivatives of cos(phase + length·t)
            let mut factor = 1.0;
            let taylor: [f64; COEFFICIENTS] = std::array::from_fn(|k| {
                let derivative = (phase + k as f64 * std::f64::consts::FRAC_PI_2).cos();
                let coefficient = factor * derivative;
                factor *= length / (k + 1) as f64;
                coefficient
            });
            let smooth = Smooth::new(&taylor, 1e-15);
            let bernstein = smooth.bernstein();
            for falling in [false, true] {
                let (mut one, mut other) = (falling, falling);
                let (verdict, places) = smooth.examined(0, 0, &mut one);
                let expected = bernstein.minima(&mut other);
                assert_eq!(verdict, bernstein.verdict(0, 0));
                assert_eq!((one, places.len()), (other, expected.len()), "{phase}");
                for (place, expected) in places.iter().zip(expected) {
                    assert!((place - expected).abs() < 1e-13, "{place} for {expected}");
                }
            }
            let ends = [phase.cos(), (phase + length).cos()];
            let mut bounds = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let turns = (phase / std::f64::consts::PI).ceil() * std::f64::consts::PI;
            let expected = match turns < phase + length {
                true => (bounds.0.min(turns.cos()), bounds.1.max(turns.cos())),
                false => bounds,
            };
            smooth.widen(&mut bounds);
            assert!((bounds.0 - expected.0).abs() < 1e-14, "{phase}");
            assert!((bounds.1 - expected.1).abs() < 1e-14, "{phase}");
            told += usize::from(!matches!(smooth.slope(smooth.kept()), Slope::Open));
        }
        assert!(told > 150, "{told}");
    }
}
