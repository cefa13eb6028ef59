//! Numbers with 17 significant digits, as `{:.16e}` writes them.

use std::fmt::{self, Write as _};

/// A number with 17 significant digits; empty where it is not finite.
pub(crate) fn number(value: f64) -> String {
    let mut text = String::new();
    // writing to memory does not fail
    let _ = put_number(&mut text, value);
    text
}

pub(super) fn put_number(text: &mut String, value: f64) -> fmt::Result {
    if !value.is_finite() {
        return Ok(());
    }
    match figures(value.abs()) {
        Some(figures) => put_figures(text, value.is_sign_negative(), figures),
        None => write!(text, "{value:.16e}"),
    }
}

/// Significant digits of a number.
const DIGITS: usize = 17;

/// Least number of one digit more.
const TOO_MANY: u128 = 10_u128.pow(DIGITS as u32);

/// Powers of five up to the last one whose product with a mantissa fits into 128 bits.
const FIVES: [u128; 33] = {
    let mut powers = [1; 33];
    let mut index = 1;
    while index < powers.len() {
        powers[index] = 5 * powers[index - 1];
        index += 1;
    }
    powers
};

/// The significant digits of a number ≥ 0 as an integer, rounded to the nearest one, of two to the even one, and the
/// decimal exponent of the first digit. None of numbers whose product with a power of ten takes more than 128 bits:
/// those below 1e-16 and those from 1e17.
fn figures(value: f64) -> Option<(u128, i32)> {
    if value == 0.0 {
        return Some((0, 0));
    }
    let bits = value.to_bits();
    // value = mantissa·2^exponent
    let mantissa = u128::from(bits & ((1 << 52) - 1) | 1 << 52);
    let exponent = i32::try_from(bits >> 52).ok()? - 1075;
    // log₁₀ 2 = 315653/2²⁰ to all digits that count; the mantissa may add one
    let least = ((exponent + 52) * 315_653) >> 20;
    let digits = |decimal: i32| {
        let scale = DIGITS as i32 - 1 - decimal;
        let product = mantissa * FIVES.get(usize::try_from(scale).ok()?)?;
        Some(match exponent + scale {
            up @ 0.. => product << up,
            down => rounded(product, down.unsigned_abs()),
        })
    };
    match digits(least)? {
        enough if enough < TOO_MANY => Some((enough, least)),
        _ => Some((digits(least + 1)?, least + 1)),
    }
}

/// n/2^bits to the nearest integer, of two to the even one.
fn rounded(n: u128, bits: u32) -> u128 {
    let (whole, rest, half) = (n >> bits, n & ((1 << bits) - 1), 1 << (bits - 1));
    whole + u128::from(rest > half || rest == half && whole % 2 == 1)
}

/// Puts digits below a text as `{:e}` does.
fn put_figures(text: &mut String, negative: bool, (digits, exponent): (u128, i32)) -> fmt::Result {
    let mut figures = *b"-0.0000000000000000e";
    // 17 digits are less than 2⁶⁴
    let mut left = digits as u64;
    for index in (1..=DIGITS + 1).rev().filter(|index| *index != 2) {
        figures[index] += (left % 10) as u8;
        left /= 10;
    }
    let shown = &figures[usize::from(!negative)..];
    text.push_str(std::str::from_utf8(shown).map_err(|_| fmt::Error)?);
    if exponent < 0 {
        text.push('-');
    }
    let size = exponent.unsigned_abs();
    for digit in [size / 10, size % 10]
        .into_iter()
        .skip(usize::from(size < 10))
    {
        text.extend(char::from_digit(digit, 10));
    }
    Ok(())
}
