//! Intervals of real numbers that are rounded outwards: what they enclose is proven.
//!
//! An operation on intervals encloses every result of the operation on their members. Its ends are doubles,
//! rounded down and up: + − × ÷ √ of IEEE 754 are rounded to the nearest double, and the sign of what was
//! cut off is known exactly (Knuth's sum, a fused multiply-add), so that an end moves to its neighbour only
//! where it must, and exact results stay exact. The library functions of the system are never relied on:
//! exp, ln, sin and cos ([`elementary`]) are Taylor polynomials with a bound of what they leave out.
//!
//! R.E. Moore, R.B. Kearfott, M.J. Cloud, Introduction to Interval Analysis (2009); IEEE 1788.

mod decimal;
mod elementary;
mod number;
mod taylor;

use std::ops::{Add, Div, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

pub use decimal::{Decimal, NoDecimal};
pub use elementary::PI;
pub use number::{Gradient, Normed, Number};
pub use taylor::TaylorModel;

/// The real numbers from `low` to `high`; none where low > high.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interval {
    /// Lower end; −∞ if there is none.
    pub low: f64,
    /// Upper end; ∞ if there is none.
    pub high: f64,
}

/// Products and quotients below this may have lost bits to underflow, and with them the exact remainder.
const TINY: f64 = 1e-250;

/// The double not above a number whose nearest double is `nearest`, `rest` having the sign of what that
/// leaves out; NaN where it is not known. A zero that a product came down to has the sign of the product.
fn down(nearest: f64, rest: f64) -> f64 {
    if nearest == 0.0 || !nearest.is_finite() {
        let stays = rest >= 0.0 || nearest == 0.0 && nearest.is_sign_positive();
        return if stays { nearest } else { nearest.next_down() };
    }
    // the neighbour below without a branch: the sign of the rest is as good as random
    let bits = nearest.to_bits();
    let away = ((bits as i64) >> 63) as u64 | 1;
    let moves = u64::from(rest.is_nan() || rest < 0.0);
    f64::from_bits(bits.wrapping_sub(away.wrapping_mul(moves)))
}

fn up(nearest: f64, rest: f64) -> f64 {
    -down(-nearest, -rest)
}

/// Sum and the exact rest (Knuth); NaN where it overflows.
fn sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// Product and the exact rest; 0 · ∞ = 0, the limit of 0 · x.
fn product(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 {
        return (0.0, 0.0);
    }
    let p = a * b;
    let known = p.abs() > TINY && p.is_finite();
    (
        p,
        if known {
            product_rest(a, b, p)
        } else {
            f64::NAN
        },
    )
}

/// ab − p of the double p nearest to ab (Dekker): a fused multiply-add without such an instruction is slow.
fn product_rest(a: f64, b: f64, p: f64) -> f64 {
    /// 2²⁷ + 1: halves of a double; beyond the bound they might overflow.
    const HALVES: f64 = 134_217_729.0;
    const LARGE: f64 = 1e290;
    if a.abs() > LARGE || b.abs() > LARGE {
        return a.mul_add(b, -p);
    }
    let halves = |x: f64| {
        let t = HALVES * x;
        let high = t - (t - x);
        (high, x - high)
    };
    let ((a, a_low), (b, b_low)) = (halves(a), halves(b));
    ((a * b - p) + a * b_low + a_low * b) + a_low * b_low
}

/// Quotient by b ≠ 0 and the sign of the rest.
fn quotient(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b.is_infinite() && a.is_finite() {
        // a/∞ is the limit of quotients that tend to 0
        return (0.0, 0.0);
    }
    let q = a / b;
    let known = q.abs() > TINY && a.abs() > TINY && q.is_finite();
    let rest = if known {
        // a − qb as a − p − (qb − p) of the double p nearest to qb: the first difference is exact, for p is next to a
        let p = q * b;
        ((a - p) - product_rest(q, b, p)) * b.signum()
    } else {
        f64::NAN
    };
    (q, rest)
}

impl Interval {
    /// All real numbers.
    pub const ENTIRE: Interval = Interval {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };
    /// No number.
    pub const EMPTY: Interval = Interval {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };
    /// Zero.
    pub const ZERO: Interval = Interval::point(0.0);
    /// One.
    pub const ONE: Interval = Interval::point(1.0);

    /// One number.
    pub const fn point(value: f64) -> Interval {
        Interval {
            low: value,
            high: value,
        }
    }

    /// The numbers between two; all where an end is not a number.
    pub fn new(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            Interval::ENTIRE
        } else {
            Interval { low, high }
        }
    }

    /// `middle` ± `radius`.
    pub fn around(middle: f64, radius: f64) -> Interval {
        Interval::point(middle) + Interval::new(-radius, radius)
    }

    /// Whether it has no number.
    pub fn is_empty(self) -> bool {
        self.low > self.high
    }

    /// Whether a number is in it.
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Whether it lies within another.
    pub fn within(self, other: Interval) -> bool {
        self.is_empty() || other.low <= self.low && self.high <= other.high
    }

    /// What two have in common.
    pub fn intersection(self, other: Interval) -> Interval {
        let both = Interval {
            low: self.low.max(other.low),
            high: self.high.min(other.high),
        };
        if both.is_empty() {
            Interval::EMPTY
        } else {
            both
        }
    }

    /// The least interval that has both.
    pub fn hull(self, other: Interval) -> Interval {
        Interval {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Largest modulus.
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// A double near the middle; NaN where both ends are.
    pub fn middle(self) -> f64 {
        let middle = 0.5 * self.low + 0.5 * self.high;
        let (least, most) = (self.low.min(self.high), self.high.max(self.low));
        match least <= most {
            // of an interval that is one double, that double
            true => middle.clamp(least, most),
            false => f64::NAN,
        }
    }

    /// Length, rounded up.
    pub fn width(self) -> f64 {
        (Interval::point(self.high) - Interval::point(self.low)).high
    }

    /// Whether it has numbers, and all of them are positive.
    pub fn is_positive(self) -> bool {
        self.low > 0.0 && !self.is_empty()
    }

    /// Whether it has numbers, and all of them are negative.
    pub fn is_negative(self) -> bool {
        self.high < 0.0 && !self.is_empty()
    }

    /// √ of those numbers that are not negative.
    pub fn sqrt(self) -> Interval {
        if self.is_empty() || self.high < 0.0 {
            return Interval::EMPTY;
        }
        let root = |x: f64| {
            let s = x.sqrt();
            let known = x > TINY && x.is_finite();
            let rest = if known { (-s).mul_add(s, x) } else { f64::NAN };
            (s, if x == 0.0 { 0.0 } else { rest })
        };
        let (low, rest_low) = root(self.low.max(0.0));
        let (high, rest_high) = root(self.high);
        Interval {
            low: down(low, rest_low),
            high: up(high, rest_high),
        }
    }

    /// x², of one and the same x.
    pub fn square(self) -> Interval {
        let square = self * self;
        Interval {
            low: square.low.max(0.0),
            high: square.high,
        }
    }
}

impl Neg for Interval {
    type Output = Interval;
    fn neg(self) -> Interval {
        Interval {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl Add for Interval {
    type Output = Interval;
    fn add(self, other: Interval) -> Interval {
        // most derivatives are zero
        if other == Interval::ZERO {
            return self;
        }
        if self == Interval::ZERO {
            return other;
        }
        if self.is_empty() || other.is_empty() {
            return Interval::EMPTY;
        }
        let (low, rest_low) = sum(self.low, other.low);
        let (high, rest_high) = sum(self.high, other.high);
        Interval::new(down(low, rest_low), up(high, rest_high))
    }
}

impl Sub for Interval {
    type Output = Interval;
    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Interval;
    fn mul(self, other: Interval) -> Interval {
        if self.is_empty() || other.is_empty() {
            return Interval::EMPTY;
        }
        if self == Interval::ZERO || other == Interval::ZERO {
            return Interval::ZERO;
        }
        // the ends that give the least and the largest product, by signs
        let (a, b, c, d) = (self.low, self.high, other.low, other.high);
        let (least, largest) = match (a >= 0.0, b <= 0.0, c >= 0.0, d <= 0.0) {
            (true, _, true, _) => ((a, c), (b, d)),
            (true, _, _, true) => ((b, c), (a, d)),
            (true, ..) => ((b, c), (b, d)),
            (_, true, true, _) => ((a, d), (b, c)),
            (_, true, _, true) => ((b, d), (a, c)),
            (_, true, ..) => ((a, d), (a, c)),
            (_, _, true, _) => ((a, d), (b, d)),
            (_, _, _, true) => ((b, c), (a, c)),
            _ => {
                let end = |low: f64, high: f64| {
                    let (p, rest) = product(low, high);
                    (down(p, rest), up(p, rest))
                };
                let (ad, bc) = (end(a, d), end(b, c));
                let (ac, bd) = (end(a, c), end(b, d));
                return Interval::new(ad.0.min(bc.0), ac.1.max(bd.1));
            }
        };
        let (low, rest_low) = product(least.0, least.1);
        let (high, rest_high) = product(largest.0, largest.1);
        Interval::new(down(low, rest_low), up(high, rest_high))
    }
}

impl Div for Interval {
    type Output = Interval;
    /// All numbers where the divisor has zero inside, those beyond an end where zero is its end, none where
    /// it is zero itself.
    fn div(self, other: Interval) -> Interval {
        if self.is_empty() || other.is_empty() || other == Interval::ZERO {
            return Interval::EMPTY;
        }
        if other.low < 0.0 && other.high > 0.0 {
            return if self == Interval::ZERO {
                self
            } else {
                Interval::ENTIRE
            };
        }
        if other.high <= 0.0 {
            return -self / -other;
        }
        // 0 ≤ c ≤ d: the quotient is largest in modulus at c where self has not zero inside
        let end = |x: f64, near: f64, far: f64, round: fn(f64, f64) -> f64, outwards: bool| {
            let by = if outwards { near } else { far };
            if by == 0.0 {
                // x/0⁺
                return if x == 0.0 { 0.0 } else { x * f64::INFINITY };
            }
            let (q, rest) = quotient(x, by);
            round(q, rest)
        };
        Interval::new(
            end(self.low, other.low, other.high, down, self.low < 0.0),
            end(self.high, other.low, other.high, up, self.high > 0.0),
        )
    }
}
