//! exp, ln, sin and cos of intervals, and what is made of them: arcs and hyperbolic functions.
//!
//! The argument is reduced by multiples of ln 2 or π/2, which are split into parts of so few bits that the
//! products are exact, and a remainder that is an interval. A Taylor polynomial in interval arithmetic
//! follows, with the bound of its remainder added: of terms that alternate or fall faster than a geometric
//! series of ratio ½ that is twice the first term left out.

use super::{Interval, TINY};

/// π.
pub const PI: Interval = Interval {
    low: std::f64::consts::PI,
    high: 3.141_592_653_589_793_6,
};

/// π/2 = 33 bits + 33 bits + what is left.
const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11];
const HALF_PI_REST: Interval = Interval {
    low: 2.022_266_248_795_950_6e-21,
    high: 2.022_266_248_795_951e-21,
};

/// ln 2 = 32 bits + what is left.
const LN_2: f64 = 0.693_147_180_369_123_8;
const LN_2_REST: Interval = Interval {
    low: 1.908_214_929_270_587_7e-10,
    high: 1.908_214_929_270_588e-10,
};

/// Multiples of π/2 up to this are taken exactly: 33 + 20 bits.
const MOST_TURNS: f64 = 1_048_576.0;

/// Degree of the Taylor polynomials on |x| ≤ 0.8: 0.8²²/22! is 7e-24.
const DEGREE: u32 = 21;

/// 1 + v/d₁(1 + v/d₂(1 + …)) for |x| ≤ 0.8, times a factor, with the remainder of a series in x.
fn series(x: Interval, v: Interval, divisors: &[u32], factor: Interval) -> Interval {
    let nested = divisors.iter().rev().fold(Interval::ONE, |sum, divisor| {
        Interval::ONE + v * sum / Interval::point(f64::from(*divisor))
    });
    let factorial: f64 = (1..=DEGREE + 1).map(f64::from).product();
    // twice the first term left out, with room for the rounding of the bound itself
    let rest = 4.0 * x.magnitude().powi(DEGREE as i32 + 1) / factorial + TINY;
    nested * factor + Interval::new(-rest, rest)
}

fn exp_series(x: Interval) -> Interval {
    let divisors: [u32; 21] = std::array::from_fn(|j| j as u32 + 1);
    series(x, x, &divisors, Interval::ONE)
}

fn cosine_series(x: Interval) -> Interval {
    let divisors: [u32; 10] = std::array::from_fn(|j| (2 * j as u32 + 1) * (2 * j as u32 + 2));
    series(x, -x.square(), &divisors, Interval::ONE)
}

fn sine_series(x: Interval) -> Interval {
    let divisors: [u32; 10] = std::array::from_fn(|j| (2 * j as u32 + 2) * (2 * j as u32 + 3));
    series(x, -x.square(), &divisors, x)
}

fn exp_point(x: f64) -> Interval {
    if x > 710.0 {
        return Interval::new(f64::MAX, f64::INFINITY);
    }
    // e⁻⁷⁴⁶ is less than the smallest double
    if x < -746.0 {
        return Interval::new(0.0, f64::from_bits(1));
    }
    if x == 0.0 {
        return Interval::ONE;
    }
    let n = (x / std::f64::consts::LN_2).round();
    // n has 11 bits at most: n·LN_2 is exact
    let reduced = Interval::point(x) - Interval::point(n * LN_2) - Interval::point(n) * LN_2_REST;
    // in two parts, neither of which over- or underflows
    let half = (n / 2.0).trunc();
    let power = |n: f64| Interval::point(2.0_f64.powi(n as i32));
    exp_series(reduced) * power(half) * power(n - half)
}

/// ln of one positive number: the library's guess y, and ln(x e^{−y}) = ln(1 + t), t − t² ≤ … ≤ t.
fn ln_point(x: f64) -> Interval {
    let guess = x.ln();
    let t = Interval::point(x) * exp_point(-guess) - Interval::ONE;
    // an unusable guess leaves the bounds 1 − 1/x ≤ ln x ≤ x − 1
    if t.magnitude() > 0.1 {
        let x = Interval::point(x);
        let low = Interval::ONE - Interval::ONE / x;
        return Interval::new(low.low, (x - Interval::ONE).high);
    }
    Interval::point(guess) + Interval::new((t - t.square()).low, t.high)
}

/// All values of cos and sin.
const CIRCULAR: Interval = Interval {
    low: -1.0,
    high: 1.0,
};

/// x − n·π/2 for the nearest integer n, and n modulo 4; none where that is too large.
fn quarter_turns(x: f64) -> Option<(Interval, u8)> {
    let n = (x / std::f64::consts::FRAC_PI_2).round();
    if n.is_nan() || n.abs() > MOST_TURNS {
        return None;
    }
    let reduced = Interval::point(x)
        - Interval::point(n * HALF_PI[0])
        - Interval::point(n * HALF_PI[1])
        - Interval::point(n) * HALF_PI_REST;
    Some((reduced, n.rem_euclid(4.0) as u8))
}

/// cos of one number.
fn cosine_point(x: f64) -> Interval {
    let cosine = match quarter_turns(x) {
        None => CIRCULAR,
        Some((reduced, 0)) => cosine_series(reduced),
        Some((reduced, 1)) => -sine_series(reduced),
        Some((reduced, 2)) => -cosine_series(reduced),
        Some((reduced, _)) => sine_series(reduced),
    };
    cosine.intersection(CIRCULAR)
}

/// sin of one number.
fn sine_point(x: f64) -> Interval {
    let sine = match quarter_turns(x) {
        None => CIRCULAR,
        Some((reduced, 0)) => sine_series(reduced),
        Some((reduced, 1)) => cosine_series(reduced),
        Some((reduced, 2)) => -sine_series(reduced),
        Some((reduced, _)) => -cosine_series(reduced),
    };
    sine.intersection(CIRCULAR)
}

/// The arc tangent of a number of [−1, 1]: the library's guess y, and atan x − y = atan t, t = (x − tan y)/(1 + x tan y), with
/// |atan t| ≤ |t|.
fn arc_point(x: f64) -> Interval {
    let guess = x.atan();
    let tangent = sine_point(guess) / cosine_point(guess);
    let x = Interval::point(x);
    let off = (x - tangent) / (Interval::ONE + x * tangent);
    let most = off.magnitude();
    Interval::point(guess) + Interval::new(-most, most)
}

/// The arc tangent of one number: beyond 1 it is ±π/2 − atan(1/x).
fn arc(x: f64) -> Interval {
    let quarter = PI * Interval::point(0.5);
    if x.is_infinite() {
        return if x > 0.0 { quarter } else { -quarter };
    }
    if x.abs() <= 1.0 {
        return arc_point(x);
    }
    let inverse = Interval::ONE / Interval::point(x);
    let inner = arc_point(inverse.low).hull(arc_point(inverse.high));
    match x > 0.0 {
        true => quarter - inner,
        false => -quarter - inner,
    }
}

/// sinh x = (eˣ − e⁻ˣ)/2.
fn hyperbolic_sine(x: f64) -> Interval {
    (exp_point(x) - exp_point(-x)) * Interval::point(0.5)
}

/// cos x + shift quarter turns, over an interval: its values at the ends, and ±1 where a multiple of π may
/// lie between them.
fn circular(x: Interval, quarter: f64, at: impl Fn(f64) -> Interval) -> Interval {
    if x.is_empty() {
        return x;
    }
    if x.width().is_nan() || x.width() > 6.0 || x.magnitude() > MOST_TURNS {
        return CIRCULAR;
    }
    let mut values = at(x.low);
    if x.low.to_bits() != x.high.to_bits() {
        values = values.hull(at(x.high));
    }
    // turns of π past the maximum: an integer n is an extreme, (−1)ⁿ
    let turns = x / PI - Interval::point(0.5 * quarter);
    let mut n = turns.low.ceil();
    while n <= turns.high {
        values = values.hull(Interval::point(if n.rem_euclid(2.0) == 0.0 {
            1.0
        } else {
            -1.0
        }));
        n += 1.0;
    }
    values
}

impl Interval {
    /// eˣ.
    pub fn exp(self) -> Interval {
        if self.is_empty() {
            return self;
        }
        Interval {
            low: exp_point(self.low).low.max(0.0),
            high: exp_point(self.high).high,
        }
    }

    /// ln x of those numbers that are positive.
    pub fn ln(self) -> Interval {
        if self.is_empty() || self.high <= 0.0 {
            return Interval::EMPTY;
        }
        Interval {
            low: match self.low {
                low if low <= 0.0 => f64::NEG_INFINITY,
                low if low.is_infinite() => f64::MAX.ln().next_down(),
                low => ln_point(low).low,
            },
            high: if self.high.is_infinite() {
                f64::INFINITY
            } else {
                ln_point(self.high).high
            },
        }
    }

    /// atan x, from −π/2 to π/2.
    pub fn atan(self) -> Interval {
        if self.is_empty() {
            return self;
        }
        Interval {
            low: arc(self.low).low,
            high: arc(self.high).high,
        }
    }

    /// asin x = 2 atan(x/(1 + √(1 − x²))) of those numbers that have one.
    pub fn asin(self) -> Interval {
        let within = self.intersection(Interval::new(-1.0, 1.0));
        if within.is_empty() {
            return within;
        }
        let at = |x: f64| {
            let x = Interval::point(x);
            let root = ((Interval::ONE - x) * (Interval::ONE + x)).sqrt();
            (x / (Interval::ONE + root)).atan() * Interval::point(2.0)
        };
        Interval {
            low: at(within.low).low,
            high: at(within.high).high,
        }
    }

    /// acos x = π/2 − asin x of those numbers that have one.
    pub fn acos(self) -> Interval {
        PI * Interval::point(0.5) - self.asin()
    }

    /// sinh x.
    pub fn sinh(self) -> Interval {
        if self.is_empty() {
            return self;
        }
        Interval {
            low: hyperbolic_sine(self.low).low,
            high: hyperbolic_sine(self.high).high,
        }
    }

    /// cosh x = (eˣ + e⁻ˣ)/2.
    pub fn cosh(self) -> Interval {
        if self.is_empty() {
            return self;
        }
        let at = |x: f64| (exp_point(x) + exp_point(-x)) * Interval::point(0.5);
        let ends = at(self.low).hull(at(self.high));
        match self.low <= 0.0 && 0.0 <= self.high {
            true => Interval::new(1.0, ends.high),
            false => Interval::new(ends.low.max(1.0), ends.high),
        }
    }

    /// cos x.
    pub fn cos(self) -> Interval {
        circular(self, 0.0, cosine_point)
    }

    /// sin x.
    pub fn sin(self) -> Interval {
        circular(self, 1.0, sine_point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64) -> Interval {
        Interval::point(x)
    }

    /// Values in closed form lie in the enclosures, which are not much wider than rounding.
    #[test]
    fn arcs_and_hyperbolic_functions_are_enclosed() {
        let part = |times: f64| PI * point(times);
        let third = PI / point(3.0);
        let two = point(2.0);
        for (found, value) in [
            (point(1.0).atan(), part(0.25)),
            (point(3.0).sqrt().atan(), third),
            (point(-f64::INFINITY).atan(), part(-0.5)),
            (point(0.5).asin(), third * point(0.5)),
            (point(-1.0).asin(), part(-0.5)),
            (point(-1.0).acos(), PI),
            (point(0.5).acos(), third),
            (two.ln().sinh(), point(0.75)),
            ((-two.ln()).cosh(), point(1.25)),
            (point(0.0).sinh(), point(0.0)),
        ] {
            assert!(
                !found.intersection(value).is_empty(),
                "{found:?}, {value:?}"
            );
            assert!(found.width() <= 4e-15, "{found:?}");
        }
        // the inverse of the tangent, and x itself for small x
        for x in [1e-12, 1e-8, 0.3, 0.999, 1.001, 7.0, 1e9] {
            let arc = point(x).atan();
            let back = arc.sin() / arc.cos();
            assert!(back.low <= x && x <= back.high, "{x}: {back:?}");
            // a dozen roundings outwards
            assert!(arc.width() <= 3e-15 * arc.high, "{x}: {arc:?}");
        }
        // what is outside has no value, and an interval has the least within
        assert!(Interval::new(1.5, 2.0).asin().is_empty());
        let all = Interval::new(-2.0, 1.0).cosh();
        assert!(all.low == 1.0 && all.high >= 2.0_f64.cosh() && all.high < 3.77);
        let arcs = Interval::new(-0.5, 3.0).acos();
        assert!(arcs.low <= 0.0 && arcs.high >= 2.0943);
    }
}
