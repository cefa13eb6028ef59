//! Numbers as text.

/// `value` with `decimals` digits after the point and a typographic minus sign; never `-0`.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.chars().all(|c| matches!(c, '-' | '0' | '.')) {
        return "0".to_owned();
    }
    text.replace('-', "\u{2212}")
}

/// `value` with about `digits` significant digits and without trailing zeros.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let exponent = decade(value);
    if !(-4..6).contains(&exponent) {
        let scale = 10f64.powi(exponent);
        let mantissa = trimmed(&fixed(value / scale, digits.saturating_sub(1)));
        return format!("{mantissa} × {}", power_of_ten(exponent));
    }
    let decimals = (digits as i32 - 1 - exponent).clamp(0, 15) as usize;
    trimmed(&fixed(value, decimals))
}

/// The values with as many digits as it takes to tell them apart, four at least.
pub(crate) fn distinct(values: &[f64]) -> Vec<String> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let enough = (4..=9)
        .find(|digits| {
            let texts: Vec<String> = sorted.iter().map(|v| significant(*v, *digits)).collect();
            texts.windows(2).all(|pair| pair[0] != pair[1])
        })
        .unwrap_or(9);
    values.iter().map(|v| significant(*v, enough)).collect()
}

/// Exponent of the power of ten at or below |value|.
pub(crate) fn decade(value: f64) -> i32 {
    let magnitude = value.abs();
    if magnitude < f64::MIN_POSITIVE {
        return 0;
    }
    // The logarithm of 1000 may come out just below 3.
    (magnitude.log10() + 1e-12).floor() as i32
}

/// 10ⁿ with the exponent in superior figures.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    const FIGURES: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let superior = |c: char| {
        c.to_digit(10)
            .map_or('⁻', |figure| FIGURES[figure as usize])
    };
    let figures: String = exponent.to_string().chars().map(superior).collect();
    format!("10{figures}")
}

/// The text without zeros at the end of its decimals.
pub(crate) fn trimmed(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stay_distinct() {
        assert_eq!(distinct(&[0.1, 0.25]), ["0.1", "0.25"]);
        assert_eq!(distinct(&[1.00001, 1.00002]), ["1.00001", "1.00002"]);
        assert_eq!(distinct(&[0.5, 0.5]), ["0.5", "0.5"]);
    }

    #[test]
    fn signs_and_powers_are_typographic() {
        assert_eq!(fixed(-0.0001, 2), "0");
        assert_eq!(fixed(-1.5, 2), "−1.50");
        assert_eq!(significant(2.5e-7, 3), "2.5 × 10⁻⁷");
    }
}
