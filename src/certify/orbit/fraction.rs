//! Fractions of whole numbers.

use std::fmt;
use std::ops::Neg;

use crate::affine::algebra::{Algebra, Obstacle, Operation};

/// A fraction in lowest terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fraction {
    over: i128,
    /// Positive.
    under: i128,
}

/// Powers of two and of ten up to these are divisors.
const MOST_HALVINGS: u32 = 100;
const MOST_DIGITS: i64 = 30;

fn common(one: i128, other: i128) -> i128 {
    let (mut one, mut other) = (one, other);
    while other != 0 {
        (one, other) = (other, one % other);
    }
    one
}

impl Fraction {
    pub const ZERO: Fraction = Fraction { over: 0, under: 1 };
    pub const ONE: Fraction = Fraction { over: 1, under: 1 };

    /// One whole number over another; `None` beyond the range of these, or over zero.
    fn new(over: i128, under: i128) -> Option<Fraction> {
        let common = common(over.checked_abs()?, under.checked_abs()?);
        let sign = if under < 0 { -1 } else { 1 };
        Some(Fraction {
            over: over.checked_div(common)? * sign,
            under: under.checked_div(common)? * sign,
        })
    }

    /// The fraction that a double is.
    pub fn of_double(value: f64) -> Option<Fraction> {
        let (mut over, mut halvings) = (value, 0);
        while over.fract() != 0.0 {
            over *= 2.0;
            halvings += 1;
            if halvings > MOST_HALVINGS {
                return None;
            }
        }
        // whole doubles so large are whole numbers of this range
        let fits = over.abs() < 2.0_f64.powi(120);
        fits.then(|| Fraction::new(over as i128, 1 << halvings))?
    }

    /// The fraction that a decimal without sign is as it is written.
    pub fn of_decimal(text: &str) -> Option<Fraction> {
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{part}").parse::<i128>().ok()?;
        let exponent = exponent.parse::<i64>().ok()?;
        let power = exponent.checked_sub(i64::try_from(part.len()).ok()?)?;
        if !(-MOST_DIGITS..=MOST_DIGITS).contains(&power) {
            return None;
        }
        let tens = 10_i128.checked_pow(u32::try_from(power.abs()).ok()?)?;
        match power < 0 {
            true => Fraction::new(digits, tens),
            false => Fraction::new(digits.checked_mul(tens)?, 1),
        }
    }

    pub fn is_zero(self) -> bool {
        self.over == 0
    }

    /// The whole number that it is.
    pub fn whole(self) -> Option<i64> {
        i64::try_from(self.over).ok().filter(|_| self.under == 1)
    }

    pub fn plus(self, other: Fraction) -> Option<Fraction> {
        let one = self.over.checked_mul(other.under)?;
        let two = other.over.checked_mul(self.under)?;
        Fraction::new(one.checked_add(two)?, self.under.checked_mul(other.under)?)
    }

    pub fn times(self, other: Fraction) -> Option<Fraction> {
        let over = self.over.checked_mul(other.over)?;
        Fraction::new(over, self.under.checked_mul(other.under)?)
    }

    /// 1 over it, which is none of zero.
    pub fn inverse(self) -> Option<Fraction> {
        (self.over != 0).then(|| Fraction::new(self.under, self.over))?
    }

    /// Its value.
    ///
    /// # Errors
    /// It is beyond the range of doubles.
    pub fn value<A: Algebra>(self) -> Result<A, Obstacle> {
        let whole = |number: i128| {
            let near = number as f64;
            match near as i128 == number {
                true => A::number(near),
                false => A::decimal(near, &number.to_string()),
            }
        };
        match self.under {
            1 => Ok(whole(self.over)),
            under => whole(self.over).operate(Operation::Over, whole(under)),
        }
    }
}

impl Neg for Fraction {
    type Output = Fraction;

    fn neg(self) -> Fraction {
        Fraction {
            over: -self.over,
            ..self
        }
    }
}

impl fmt::Display for Fraction {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.under {
            1 => write!(formatter, "{}", self.over),
            under => write!(formatter, "{}/{under}", self.over),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_in_lowest_terms() {
        let of = |text: &str| Fraction::of_decimal(text).unwrap();
        assert_eq!(of("0.75").to_string(), "3/4");
        assert_eq!(of("1.5e2").to_string(), "150");
        assert_eq!(of("25e-2"), Fraction::of_double(0.25).unwrap());
        assert_ne!(Some(of("0.1")), Fraction::of_double(0.1));
        assert_eq!(of("0.75").inverse().unwrap().to_string(), "4/3");
        assert_eq!(
            Fraction::of_double(-2.0)
                .unwrap()
                .inverse()
                .unwrap()
                .to_string(),
            "-1/2"
        );
        assert_eq!(of("0.1").plus(of("0.9")), Some(Fraction::ONE));
        assert_eq!(Fraction::ZERO.inverse(), None);
        for beyond in [f64::INFINITY, f64::NAN, 1e300, 1e-300] {
            assert_eq!(Fraction::of_double(beyond), None, "{beyond}");
        }
        for beyond in ["1e-31", "1e31", "1e-9223372036854775808"] {
            assert_eq!(Fraction::of_decimal(beyond), None, "{beyond}");
        }
        let most = Fraction::new(i128::MAX, 1).unwrap();
        assert_eq!(most.plus(most), None);
        assert_eq!(most.times(most), None);
        assert_eq!(Fraction::new(i128::MIN, 1), None);
    }
}
