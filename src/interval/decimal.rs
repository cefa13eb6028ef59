//! Decimal numbers as they are written: the interval of doubles around the decimal, not around the double
//! next to it.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Interval;

/// A decimal number as text: digits, at most one point, an exponent. Two texts of one number are equal.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Decimal(String);

/// A text that is no finite decimal number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no decimal number")]
pub struct NoDecimal(String);

/// Integers and powers of ten up to these are doubles.
const EXACT_DIGITS: usize = 15;
const EXACT_POWER: i32 = 22;

impl Decimal {
    /// The shortest decimal that reads as a double.
    pub fn of(value: f64) -> Decimal {
        Decimal(format!("{value:?}"))
    }

    /// Its sign, its digits from the first to the last that is not 0, and the power of ten of the last; `None` where the exponent
    /// is out of range.
    fn parts(&self) -> Option<(bool, String, i64)> {
        let (mantissa, exponent) = self.0.split_once(['e', 'E']).unwrap_or((&self.0, "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let all = format!("{}{fraction}", whole.trim_start_matches(['-', '+']));
        let last = all.trim_end_matches('0');
        let power = exponent.parse::<i64>().ok()? - i64::try_from(fraction.len()).ok()?;
        let power = power.checked_add(i64::try_from(all.len() - last.len()).ok()?)?;
        Some(match last.trim_start_matches('0') {
            "" => (false, String::new(), 0),
            digits => (whole.starts_with('-'), digits.to_owned(), power),
        })
    }

    /// A fraction of whole numbers whose decimal ends; `None` for any other text.
    fn of_fraction(text: &str) -> Option<Decimal> {
        let (over, under) = text.split_once('/')?;
        let (mut over, mut under) = (over.parse::<i128>().ok()?, under.parse::<u64>().ok()?);
        if under == 0 {
            return None;
        }
        let mut places = 0;
        while under != 1 {
            // tenfold until 2 and 5 are divided out
            let common = [10, 5, 2].into_iter().find(|factor| under % factor == 0);
            match common {
                Some(factor) => {
                    under /= factor;
                    over = over.checked_mul(i128::from(10 / factor))?;
                    places += 1;
                }
                None if over % i128::from(under) == 0 => {
                    over /= i128::from(under);
                    under = 1;
                }
                None => return None,
            }
        }
        Some(Decimal(format!("{over}e-{places}")))
    }

    /// The double next to it.
    pub fn nearest(&self) -> f64 {
        self.0.parse().unwrap_or(f64::NAN)
    }

    /// Doubles on both sides, or the one double that it is.
    ///
    /// Reading rounds to the nearest double. Of at most 15 digits times a power of ten the sign of the
    /// error is known: digits − x·10ⁿ by a fused multiply-add.
    pub fn interval(&self) -> Interval {
        let nearest = self.nearest();
        let unknown = Interval::new(nearest.next_down(), nearest.next_up());
        let (mantissa, exponent) = self.0.split_once(['e', 'E']).unwrap_or((&self.0, "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{}", fraction.trim_end_matches('0'));
        let Ok(exponent) = exponent.parse::<i32>() else {
            return unknown;
        };
        let places = exponent.saturating_sub_unsigned(fraction.trim_end_matches('0').len() as u32);
        let count = digits.trim_start_matches(['-', '+', '0']).len();
        if count == 0 {
            return Interval::ZERO;
        }
        if count > EXACT_DIGITS || places.abs() > EXACT_POWER {
            return unknown;
        }
        let Ok(integer) = digits.parse::<i64>() else {
            return unknown;
        };
        // both are doubles: integers below 2⁵³, 10²² = 2²² · 5²² with 5²² below 2⁵²
        let (integer, power) = (
            Interval::point(integer as f64),
            Interval::point(10_i64.pow(places.unsigned_abs().min(18)) as f64)
                * Interval::point(10_i64.pow(places.unsigned_abs().saturating_sub(18)) as f64),
        );
        if places < 0 {
            integer / power
        } else {
            integer * power
        }
    }
}

impl PartialEq for Decimal {
    fn eq(&self, other: &Decimal) -> bool {
        match (self.parts(), other.parts()) {
            (Some(one), Some(other)) => one == other,
            _ => self.0 == other.0,
        }
    }
}

impl Eq for Decimal {}

impl TryFrom<String> for Decimal {
    type Error = NoDecimal;
    fn try_from(text: String) -> Result<Decimal, NoDecimal> {
        // RON allows underscores between digits
        let plain = text.replace('_', "");
        if let Some(fraction) = Decimal::of_fraction(&plain) {
            return Ok(fraction);
        }
        let finite = plain.parse::<f64>().is_ok_and(f64::is_finite);
        if finite && !plain.contains(|c: char| c.is_alphabetic() && c != 'e' && c != 'E') {
            Ok(Decimal(plain))
        } else {
            Err(NoDecimal(text))
        }
    }
}

impl From<Decimal> for String {
    fn from(decimal: Decimal) -> String {
        decimal.0
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}
