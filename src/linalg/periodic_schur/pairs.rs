//! Eigenvalues of a real product as they are without rounding: real or in conjugate pairs, the largest first.

use super::ProductEigenvalue;
use super::product::Number;

/// Eigenvalues of a real product are real or come in pairs: what rounding made of that is undone. Two that may be
/// conjugate are those of a real matrix of two dimensions with their trace and determinant.
pub(super) fn resolved(mut all: Vec<ProductEigenvalue>) -> Vec<ProductEigenvalue> {
    let mut found = Vec::with_capacity(all.len());
    let off_axis = |one: &ProductEigenvalue| {
        one.mantissa.im.abs() / one.mantissa.norm().max(f64::MIN_POSITIVE)
    };
    while !all.is_empty() {
        let order =
            |one: &usize, other: &usize| off_axis(&all[*one]).total_cmp(&off_axis(&all[*other]));
        let Some(index) = (0..all.len()).max_by(order) else {
            break;
        };
        let one = all.swap_remove(index);
        // in units of this one
        let unit = one.exponent;
        let of = |other: &ProductEigenvalue| other.value_over(unit);
        let error = |other: &ProductEigenvalue| other.error_over(unit);
        let off = |other: &usize| (of(&all[*other]) - one.mantissa.conj()).norm();
        let nearest = (0..all.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        let is_real = one.mantissa.im.abs() <= error(&one);
        let pair = nearest.filter(|other| {
            one.mantissa.im != 0.0 && (!is_real || off(other) <= error(&one) + error(&all[*other]))
        });
        let Some(other) = pair else {
            let real = Number::new(one.mantissa.re, 0.0);
            found.push(ProductEigenvalue {
                log_error: one.log_error,
                ..ProductEigenvalue::new(real, unit)
            });
            continue;
        };
        let other = all.swap_remove(other);
        let (z, w) = (one.mantissa, of(&other));
        let middle = 0.5 * (z.re + w.re);
        let half = (z - w) * 0.5;
        let square = (half * half).re;
        let by = square.abs().sqrt();
        let values = if square < 0.0 {
            [Number::new(middle, by), Number::new(middle, -by)]
        } else {
            [Number::new(middle + by, 0.0), Number::new(middle - by, 0.0)]
        };
        let log_error = one.log_error.max(other.log_error);
        found.extend(values.map(|value| ProductEigenvalue {
            log_error,
            ..ProductEigenvalue::new(value, unit)
        }));
    }
    found
}

/// The largest first; of a pair that above the axis.
pub(super) fn ordered(mut all: Vec<ProductEigenvalue>) -> Vec<ProductEigenvalue> {
    let key = |one: &ProductEigenvalue| one.log_modulus();
    all.sort_by(|one, other| {
        key(other)
            .total_cmp(&key(one))
            .then(one.mantissa.re.total_cmp(&other.mantissa.re))
            .then(one.mantissa.im.abs().total_cmp(&other.mantissa.im.abs()))
            .then(other.mantissa.im.total_cmp(&one.mantissa.im))
    });
    all
}
