//! Where a curve goes on the way to a point at which its equations are singular.

use crate::linalg::Vector;

/// What samples (x, value) of different x > 0 tend to as x → 0, by the polynomial through them, and an error of every entry:
/// what the farthest sample changes, which is what the last order does, and what the nearest does, which is known worst.
/// Source: Lagrange's formula.
pub fn limit(samples: &[(f64, Vector)]) -> Option<(Vector, Vector)> {
    let without = |left_out: Option<usize>| {
        let kept = || {
            samples
                .iter()
                .enumerate()
                .filter(|(index, _)| Some(*index) != left_out)
        };
        let parts = kept().map(|(index, (x, value))| {
            let others = kept().filter(|(other, _)| *other != index);
            value
                * others
                    .map(|(_, (other, _))| other / (other - x))
                    .product::<f64>()
        });
        parts.reduce(|sum, part| sum + part)
    };
    let by_x = |one: &usize, other: &usize| samples[*one].0.total_cmp(&samples[*other].0);
    let nearest = (0..samples.len()).min_by(by_x)?;
    let farthest = (0..samples.len()).max_by(by_x)?;
    let value = without(None)?;
    let changed = |left_out: usize| Some((without(Some(left_out))? - &value).abs());
    let error = changed(nearest)? + changed(farthest)?;
    Some((value, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exponential of x at 0.1, 0.2 .. 0.6: the error of the polynomial of degree 5 is at most 6!·1e-6·e^0.6/6!, those of
    /// degree 4 at most 5!·1e-5·e^0.5/5! and, from 0.2 on, 6!·1e-5·e^0.6/5!, less 5·1e-5.
    #[test]
    fn a_polynomial_meets_the_limit_within_its_error() {
        let samples: Vec<(f64, Vector)> = (1..=6)
            .rev()
            .map(|step| 0.1 * f64::from(step))
            .map(|x| (x, Vector::from_vec(vec![x.exp(), 3.0 - 2.0 * x])))
            .collect();
        let (value, error) = limit(&samples).unwrap();
        assert!((value[0] - 1.0).abs() < 1e-6 * 0.6_f64.exp());
        assert!((value[0] - 1.0).abs() < error[0] && error[0] < 6e-5 * 0.6_f64.exp());
        // weights of sizes up to 20 times roundings of values up to 3
        assert!((value[1] - 3.0).abs() < 400.0 * f64::EPSILON && error[1] < 400.0 * f64::EPSILON);
    }
}
