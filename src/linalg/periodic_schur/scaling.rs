//! Units of the states in which the factors of a product are alike in size: powers of two, so that nothing is rounded.

use crate::linalg::Matrix;
use crate::linalg::balance::acts;

/// Powers of two dₛ that make rows and columns of all Aₛₜdₜ/dₛ alike in size: the diagonal scaling of Parlett and Reinsch
/// (1969) of the sum of the moduli of all factors, each in units of the norm of what goes round in it.
pub fn balance(factors: &[&Matrix]) -> Vec<f64> {
    /// A step is taken where it takes this part of row and column away, as theirs; few rounds are needed.
    const WORTH: f64 = 0.95;
    const ROUNDS: usize = 100;
    let Some(n) = factors.first().map(|one| one.nrows()) else {
        return Vec::new();
    };
    let mut scales = vec![1.0; n];
    if n < 2 {
        return scales;
    }
    let mut all = Matrix::zeros(n, n);
    for factor in factors {
        let pairs = all.as_mut_slice().iter_mut().zip(factor.as_slice());
        pairs.for_each(|(sum, entry)| *sum += entry.abs());
    }
    let acts = acts(&all);
    let (mut sum, mut scaled) = (all.clone(), all);
    // the first time norms are those in the units of the states
    for _ in 0..2 {
        sum.fill(0.0);
        for factor in factors {
            for j in 0..n {
                for i in 0..n {
                    scaled[(i, j)] = factor[(i, j)].abs() * (scales[j] / scales[i]);
                }
            }
            let norm = acts.round(&scaled).norm();
            if norm > 0.0 && norm.is_finite() {
                let pairs = sum.as_mut_slice().iter_mut().zip(scaled.as_slice());
                pairs.for_each(|(sum, entry)| *sum += entry / norm);
            }
        }
        for _ in 0..ROUNDS {
            let mut settled = true;
            for state in 0..n {
                let others = (0..n).filter(|other| *other != state);
                let mut column: f64 = others.clone().map(|other| sum[(other, state)]).sum();
                let mut row: f64 = others.map(|other| sum[(state, other)]).sum();
                // what goes one way could be made as small as one likes: no larger than what is left alone
                if column == 0.0 || row == 0.0 {
                    column = column.max(sum[(state, state)]);
                    row = row.max(sum[(state, state)]);
                }
                if !(column > 0.0 && row > 0.0) {
                    continue;
                }
                let by = 2.0_f64.powi((0.5 * (row / column).log2()).round() as i32);
                let usable = by.is_normal() && (scales[state] * by).is_normal();
                if usable && column * by + row / by < WORTH * (column + row) {
                    settled = false;
                    scales[state] *= by;
                    sum.column_mut(state).scale_mut(by);
                    sum.row_mut(state).scale_mut(by.recip());
                }
            }
            if settled {
                break;
            }
        }
    }
    scales
}

/// Powers of two u for which rows and columns of all Aₖ[i, j]uₖ[j]/uₖ₊₁[i] are alike in size, u_K = u₀: units of every state at
/// the beginning of every factor. Osborne's scaling of the cyclic block matrix whose K-th power has these eigenvalues.
///
/// What a factor makes 1e10 times as large, and the next one as small again, would leave its rounding in all the rest. Where
/// no state loses three digits in this way all units are 1.
pub fn units_along(factors: &[&Matrix]) -> Vec<Vec<f64>> {
    /// Ratios of a row and a column from which on units are changed, and to which they are.
    const LOSES: f64 = 1e6;
    const LEFT: f64 = 4.0;
    const ROUNDS: usize = 100;
    let count = factors.len();
    let n = factors.first().map_or(0, |one| one.nrows());
    let mut units = vec![vec![1.0; n]; count];
    // none where a row and a column, zero or none where one of them, vanishes
    let ratio = |units: &[Vec<f64>], k: usize, i: usize| {
        let [before, after] = [(k + count - 1) % count, (k + 1) % count];
        let own = units[k][i];
        let row = (0..n).map(|j| factors[before][(i, j)].abs() * units[before][j] / own);
        let column = (0..n).map(|j| factors[k][(j, i)].abs() * own / units[after][j]);
        let ratio = row.sum::<f64>() / column.sum::<f64>();
        Some(ratio).filter(|ratio| ratio.is_normal())
    };
    let mut places = (0..count).flat_map(|k| (0..n).map(move |i| (k, i)));
    let beyond = |ratio: f64, most: f64| ratio > most || ratio < most.recip();
    let loses = |(k, i)| ratio(&units, k, i).is_some_and(|ratio| beyond(ratio, LOSES));
    if count < 2 || !places.any(loses) {
        return units;
    }
    for _ in 0..ROUNDS {
        let mut settled = true;
        for k in 0..count {
            for i in 0..n {
                let Some(ratio) = ratio(&units, k, i).filter(|ratio| beyond(*ratio, LEFT)) else {
                    continue;
                };
                let unit = units[k][i] * (0.5 * ratio.log2()).round().exp2();
                if unit.is_normal() {
                    settled = false;
                    units[k][i] = unit;
                }
            }
        }
        if settled {
            break;
        }
    }
    units
}
