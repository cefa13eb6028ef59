//! Numbers in sentences: to as many digits as are known, in whatever unit.

/// Sizes of numbers that are written without a power of ten.
const PLAIN: std::ops::Range<f64> = 1e-5..1e9;

/// Most decimals of a number that is written so.
const MOST_DECIMALS: i32 = 20;

/// Digits behind the first one that a number may have: the next one is not that of the problem file, but of the nearest double.
const MOST_DIGITS: i32 = 15;

/// Digits of a number whose error is not known: those that every double has.
pub(crate) const ALL: usize = 15;

/// Digits that tell a place along a branch from others.
pub(crate) const PLACE: usize = 12;

/// A number to so many significant digits.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    let size = value.abs();
    let after = digits.saturating_sub(1);
    if value == 0.0 {
        "0".to_owned()
    } else if PLAIN.contains(&size) {
        let decimals = after as i32 - first_place(size);
        format!("{value:.*}", decimals.max(0) as usize)
    } else {
        format!("{value:.after$e}")
    }
}

/// A value and its error, `0.0999707536283141 ± 2e-15`: the value ends at the place of the error's first digit, and the error, rounded
/// up, counts what is left out behind it.
pub(crate) fn with_error(value: f64, error: f64) -> String {
    if !(value.is_finite() && error.is_finite() && error > 0.0) {
        return format!("{} ± {error:.0e}", significant(value, ALL));
    }
    let size = value.abs();
    let last = first_place(size.max(error)) - MOST_DIGITS;
    let place = first_place(error).max(last);
    let is_plain = PLAIN.contains(&size) || size <= error;
    let shown = if is_plain && (-MOST_DECIMALS..=0).contains(&place) {
        format!("{value:.*}", -place as usize)
    } else if size <= error {
        "0".to_owned()
    } else {
        let digits = (first_place(size) - place).max(0);
        format!("{value:.*e}", digits as usize)
    };
    let rounded: f64 = shown.parse().unwrap_or(value);
    let shown = match shown.strip_prefix('-') {
        Some(zero) if rounded == 0.0 => zero,
        _ => &shown,
    };
    format!("{shown} ± {}", rounded_up(error + (rounded - value).abs()))
}

/// One digit of an error, not below it but for rounding.
fn rounded_up(error: f64) -> String {
    /// Part of a digit that is rounding of the error itself.
    const ROUNDING: f64 = 1e-6;
    let place = first_place(error);
    let digit = (error / 10f64.powi(place) - ROUNDING).ceil();
    match digit < 10.0 {
        true => format!("{digit}e{place}"),
        false => format!("1e{}", place + 1),
    }
}

/// The power of ten of the first digit of a number > 0.
fn first_place(size: f64) -> i32 {
    size.log10().floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_end_where_their_errors_begin() {
        for (value, error, shown) in [
            (0.1 + 6.9e-16, 8e-16, "0.1000000000000007 ± 8e-16"),
            (0.099_970_753_628_314, 2e-15, "0.099970753628314 ± 2e-15"),
            (std::f64::consts::PI, 1.01e-3, "3.142 ± 2e-3"),
            (3.155_944_1e-4, 4e-11, "0.00031559441 ± 4e-11"),
            (3.155_944_1e-9, 4e-16, "3.1559441e-9 ± 4e-16"),
            (-1e-17, 4e-15, "0.000000000000000 ± 5e-15"),
            (1e-30, 4e-28, "0 ± 5e-28"),
            (2e-4, 4.4e-20, "0.0002000000000000000 ± 5e-20"),
            (-12_345.678, 31.0, "-1.235e4 ± 4e1"),
            (2.0, 0.0, "2.00000000000000 ± 0e0"),
            (2.0, f64::INFINITY, "2.00000000000000 ± inf"),
        ] {
            assert_eq!(with_error(value, error), shown);
        }
    }

    /// The value that is printed is off by no more than the error that is printed says, and as many digits are left in any unit.
    #[test]
    fn what_is_printed_holds_in_any_unit() {
        for power in -290..290 {
            let unit = 10f64.powi(power);
            let (value, error) = (1.234_567_890_123_456_7 * unit, 2.6e-13 * unit);
            let shown = with_error(value, error);
            let (printed, told) = shown.split_once(" ± ").unwrap();
            let [printed, told] = [printed, told].map(|text| text.parse::<f64>().unwrap());
            let least = error + (printed - value).abs();
            assert!(
                told >= least * (1.0 - 1e-6) && told <= 5e-13 * unit,
                "{shown}"
            );
            let number: f64 = significant(value, ALL).parse().unwrap();
            assert!(
                (number / value - 1.0).abs() <= 5e-15,
                "{number} for {value}"
            );
        }
    }
}
