//! Decimal numbers as they are written: the interval of doubles around the decimal, not around the double
//! next to it.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Interval;

/// A decimal number as text: digits, at most one point, an exponent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
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

impl TryFrom<String> for Decimal {
    type Error = NoDecimal;
    fn try_from(text: String) -> Result<Decimal, NoDecimal> {
        // RON allows underscores between digits
        let plain = text.replace('_', "");
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
