//! Eigenvalues of an equilibrium, and the functions that change their sign where its stability changes.

use nalgebra::Complex;

use super::curve::EquilibriumCurve;
use super::field::Linearised;
use crate::continuation::Node;
use crate::linalg::{Eigenvalue, Matrix, Vector, known_eigenvalues};
use crate::orbit::Growth;

/// Place of the function that vanishes where another branch passes: the determinant of the equations bordered by the
/// tangent, which has no zero at a fold.
pub(super) const BRANCHING: usize = 0;

/// Place of the function that vanishes where two eigenvalues have the sum zero: Π s/max(|s|, [`SMALL`]) over all pairs with
/// s = (λᵢ + λⱼ)/(|λᵢ| + |λⱼ|), real since complex ones come in pairs.
pub(super) const HOPF: usize = 1;

/// A relative sum of two eigenvalues below this makes the function of [`HOPF`] small: were larger ones to do so, the product
/// over the 1225 pairs of 50 states would leave the range of numbers.
pub(super) const SMALL: f64 = 0.1;

/// The fastest growing first; of a pair that with Im λ > 0.
pub(super) fn ordered(mut values: Vec<Eigenvalue>) -> Vec<Eigenvalue> {
    values.sort_by(|one, other| {
        let by_growth = other.value.re.total_cmp(&one.value.re);
        by_growth.then(other.value.im.total_cmp(&one.value.im))
    });
    values
}

/// All eigenvalues of the motion within its surfaces. Those of a motion that has no derivatives, or whose matrix has none that are known, are no
/// numbers, with errors of any size.
pub(super) fn eigenvalues(at: &Linearised) -> Vec<Eigenvalue> {
    let unknown = |count: usize| {
        let one = Eigenvalue {
            value: Complex::from(f64::NAN),
            error: f64::INFINITY,
        };
        vec![one; count]
    };
    if at.is_tangent {
        return unknown(at.rates.len() - 1);
    }
    let matrix = at.within();
    let known = known_eigenvalues(&matrix);
    ordered(known.unwrap_or_else(|| unknown(matrix.nrows())))
}

/// How perturbations grow, in this unit of rates.
pub(super) fn growths(eigenvalues: &[Eigenvalue], unit: f64) -> Vec<Growth> {
    let growth = |one: &Eigenvalue| Growth {
        log: one.value.re / unit,
        error: one.error / unit,
        told: one.value.re.abs() > one.error,
    };
    eigenvalues.iter().map(growth).collect()
}

/// Pairs of eigenvalues, each once.
fn pairs(values: &[Eigenvalue]) -> impl Iterator<Item = [&Eigenvalue; 2]> {
    let each = values.iter().enumerate();
    each.flat_map(|(index, one)| values[index + 1..].iter().map(move |other| [one, other]))
}

/// The function of [`HOPF`].
pub(super) fn sums(values: &[Eigenvalue]) -> f64 {
    let factors = pairs(values).map(|[one, other]| {
        let sum = (one.value + other.value) / (one.value.norm() + other.value.norm());
        sum / sum.norm().max(SMALL)
    });
    factors.product::<Complex<f64>>().re
}

/// Whether more than rounding tells the sign of a function.
pub(super) fn is_told(values: &[Eigenvalue], test: usize) -> bool {
    match test {
        BRANCHING => true,
        _ => pairs(values)
            .all(|[one, other]| (one.value + other.value).norm() > one.error + other.error),
    }
}

/// A pair of eigenvalues whose sum is next to zero: ω of a complex one, with its place among all.
pub(super) fn critical_pair(values: &[Eigenvalue]) -> Option<f64> {
    let sum = |pair: &[&Eigenvalue; 2]| {
        let [one, other] = pair.map(|one| one.value);
        (one + other).norm() / (one.norm() + other.norm())
    };
    let least = pairs(values).min_by(|one, other| sum(one).total_cmp(&sum(other)));
    let [one, other] = least?;
    let is_pair = one.value.im != 0.0 && one.value.im == -other.value.im;
    is_pair.then(|| one.value.im.abs())
}

/// The function of [`BRANCHING`] at a node: rows of length 1.
pub(super) fn bordered(curve: &EquilibriumCurve, node: &Node) -> Option<f64> {
    let at = curve.linearised(&node.point).ok()?;
    let rows = curve.followed(&at, &curve.place(&node.point));
    let n = rows.len() + 1;
    let matrix = Matrix::from_fn(n, n, |row, column| match rows.get(row) {
        Some(row) => row.by[column],
        None => node.tangent[column],
    });
    let unit = |row: Vector| {
        let size = row.norm();
        if size > 0.0 { row / size } else { row }
    };
    let rows: Vec<_> = matrix
        .row_iter()
        .map(|row| unit(row.transpose()).transpose())
        .collect();
    Some(Matrix::from_rows(&rows).determinant())
}
