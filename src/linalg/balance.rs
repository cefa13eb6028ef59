//! The scales in which a matrix is small.

use super::{Matrix, Vector};

/// Sweeps that balance a matrix: each at least halves what is left to gain.
const SWEEPS: usize = 20;

/// Which coordinates act on one another, by however many steps.
pub struct Acts {
    /// For every coordinate the first of those that it goes round with.
    groups: Vec<usize>,
    /// How many coordinates each acts on.
    counts: Vec<u32>,
}

impl Acts {
    /// Whether two coordinates act on one another, or are one.
    pub(super) fn goes_round(&self, i: usize, j: usize) -> bool {
        self.groups[i] == self.groups[j]
    }

    /// The entries of a matrix between coordinates that do.
    pub(super) fn round(&self, matrix: &Matrix) -> Matrix {
        let mut round = matrix.clone();
        let columns = round.as_mut_slice().chunks_exact_mut(matrix.nrows().max(1));
        for (own, column) in self.groups.iter().zip(columns) {
            for (entry, group) in column.iter_mut().zip(&self.groups) {
                if group != own {
                    *entry = 0.0;
                }
            }
        }
        round
    }
}

/// That of a matrix.
pub fn acts(matrix: &Matrix) -> Acts {
    let n = matrix.nrows();
    // those that a coordinate acts on, in a column of bits
    let words = n.div_ceil(64).max(1);
    let mut bits = vec![0_u64; n * words];
    let has = |column: &[u64], i: usize| column[i / 64] >> (i % 64) & 1 == 1;
    let columns = matrix.as_slice().chunks_exact(n.max(1));
    for (own, column) in bits.chunks_exact_mut(words).zip(columns) {
        for (i, _) in column.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            own[i / 64] |= 1 << (i % 64);
        }
    }
    let mut beyond = vec![0; words];
    for middle in 0..n {
        beyond.copy_from_slice(&bits[middle * words..][..words]);
        for column in bits.chunks_exact_mut(words) {
            if has(column, middle) {
                let pairs = column.iter_mut().zip(&beyond);
                pairs.for_each(|(own, other)| *own |= other);
            }
        }
    }
    let column = |j: usize| &bits[j * words..][..words];
    let mut groups: Vec<usize> = Vec::with_capacity(n);
    for own in 0..n {
        let goes_round = |other: &usize| {
            groups[*other] == *other && has(column(own), *other) && has(column(*other), own)
        };
        let first = (0..own).find(goes_round);
        groups.push(first.unwrap_or(own));
    }
    let count = |j| column(j).iter().map(|bits| bits.count_ones()).sum();
    Acts {
        counts: (0..n).map(count).collect(),
        groups,
    }
}

/// A matrix without entries that close loops which are rounding: where the entries of a loop are below ε of the matrix in the scales
/// that balance it, no eigenvalue is changed by what goes round there, and the smallest of them in the units of the matrix goes. A
/// state that stays zero acts on others by what rounding has left of it; balanced, both sides of such a loop would be alike, and
/// vectors of the matrix would have no digits.
pub fn without_noise(mut left: Matrix) -> Matrix {
    loop {
        let largest = left.amax();
        // it may be rounding times rounding
        let is_small = |x: f64| x != 0.0 && x.abs() < f64::EPSILON * largest;
        if !left.iter().any(|x| is_small(*x)) {
            return left;
        }
        let (scales, norm) = balance(&left, 0.0);
        let acts = acts(&left);
        let size = left.nrows();
        let places = (0..size * size).map(|index| (index / size, index % size));
        let noise = places.filter(|(i, j)| {
            let balanced = left[(*i, *j)] * scales[*j] / scales[*i];
            i != j
                && is_small(left[(*i, *j)])
                && acts.goes_round(*i, *j)
                && balanced.abs() < f64::EPSILON * norm
        });
        let least = noise.min_by(|one, other| left[*one].abs().total_cmp(&left[*other].abs()));
        match least {
            Some(place) => left[place] = 0.0,
            None => return left,
        }
    }
}

/// Powers of two d for which the largest column sum of D⁻¹MD is small, and that sum.
///
/// Osborne's method: rows and columns of one index get the same size. Units as different as volts and seconds
/// would otherwise make pieces a hundred times too short. It tells nothing of a coordinate that acts on others which do
/// not act back, as a constant or a speed that stays do: what goes one way could be made as small as one likes. It is made
/// no larger than what goes round, or than `slow`, a rate that counts for nothing, and not much smaller than the rates of what it
/// acts on: then scales follow units.
pub fn balance(matrix: &Matrix, slow: f64) -> (Vector, f64) {
    let size = matrix.nrows();
    let mut scales = Vector::repeat(size, 1.0);
    let mut scaled = matrix.clone();
    let entries = scaled.as_mut_slice().iter_mut();
    entries.for_each(|entry| *entry = entry.abs());
    scaled.fill_diagonal(0.0);
    let norm = |scaled: &Matrix| {
        let columns = scaled.as_slice().chunks_exact(size.max(1)).enumerate();
        let sums = columns.map(|(i, column)| column.iter().sum::<f64>() + matrix[(i, i)].abs());
        sums.fold(0.0, f64::max)
    };
    let acts = acts(&scaled);
    let mut round = acts.round(&scaled);
    let is_whole = round == scaled;
    even(&mut round, &mut scales, 0.0);
    if is_whole {
        let norm = norm(&round);
        return (scales, norm);
    }
    let least = norm(&round).max(slow);
    let columns = round.as_slice().chunks_exact(size).enumerate();
    let own = columns.map(|(i, column)| column.iter().sum::<f64>() + matrix[(i, i)].abs());
    // of every group, where its first coordinate stands
    let mut rates = vec![slow; size];
    for (group, own) in acts.groups.iter().zip(own) {
        rates[*group] = own.max(rates[*group]);
    }
    lead(&scaled, &acts, &mut scales, &rates);
    let columns = scaled.as_mut_slice().chunks_exact_mut(size);
    for (own, column) in scales.iter().zip(columns) {
        let entries = column.iter_mut().zip(&scales);
        entries.for_each(|(entry, other)| *entry *= own / other);
    }
    even(&mut scaled, &mut scales, least);
    let norm = norm(&scaled);
    (scales, norm)
}

/// Scales what acts on others that do not act back: where that is next to nothing beside the rates of what it acts on it is made a
/// small part of them, and where it is far more than they are on all of it, no more than many times as large. What is acted on
/// comes first. The rates are those of groups, by their first coordinates.
fn lead(matrix: &Matrix, acts: &Acts, scales: &mut Vector, rates: &[f64]) {
    /// It adds little to the norm, and what follows is as small as this at least.
    const LEAST: f64 = 1.0 / 64.0;
    /// Rows and columns are made alike afterwards: left alone, what is larger would make what it acts on as large as its root, and
    /// what that acts on small beside it.
    const MOST: f64 = 4096.0;
    let size = matrix.nrows();
    let mut order: Vec<usize> = (0..size).filter(|j| acts.groups[*j] == *j).collect();
    order.sort_by_key(|j| acts.counts[*j]);
    for first in order {
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for i in (0..size).filter(|i| acts.groups[*i] != first) {
            let rate = rates[acts.groups[i]];
            let group = (0..size).filter(|j| acts.groups[*j] == first);
            let on = group.map(|j| matrix[(i, j)] * scales[j] / (scales[i] * rate));
            let on = on.fold(0.0, f64::max);
            if on > 0.0 {
                (least, most) = (least.min(on), most.max(on));
            }
        }
        // where it is far more on some of them alone, their own scales are too small
        let wanted = if most < LEAST {
            LEAST / most
        } else if least > MOST {
            MOST / least
        } else {
            1.0
        };
        let exponent = wanted.log2().floor();
        if exponent != 0.0 && exponent.abs() < 100.0 {
            let group = (0..size).filter(|j| acts.groups[*j] == first);
            group.for_each(|j| scales[j] *= exponent.exp2());
        }
    }
}

/// Makes rows and columns alike in size, where either is larger than `least`: a matrix without its diagonal, and the scales
/// in which it is.
fn even(scaled: &mut Matrix, scales: &mut Vector, least: f64) {
    let size = scaled.nrows();
    // the power of two nearest to √(row/column)
    let wanted = |row: f64, column: f64| {
        let (row, column) = (row.max(least), column.max(least));
        if row <= 2.0 * column && column <= 2.0 * row {
            return None;
        }
        let exponent = (0.5 * (row / column).log2()).round();
        let wanted = row > 0.0 && column > 0.0 && exponent != 0.0 && exponent.abs() < 100.0;
        wanted.then(|| exponent.exp2())
    };
    let mut rows = vec![0.0; size];
    for _ in 0..SWEEPS {
        let mut changed = false;
        rows.fill(0.0);
        for column in scaled.as_slice().chunks_exact(size) {
            let pairs = rows.iter_mut().zip(column);
            pairs.for_each(|(sum, entry)| *sum += entry);
        }
        for i in 0..size {
            let own = &scaled.as_slice()[i * size..(i + 1) * size];
            let Some(factor) = wanted(rows[i], own.iter().sum()) else {
                continue;
            };
            scales[i] *= factor;
            changed = true;
            for (column, other) in scaled.as_mut_slice().chunks_exact_mut(size).enumerate() {
                let before = other[i];
                other[i] /= factor;
                if column != i {
                    rows[i] += other[i] - before;
                }
            }
            let own = &mut scaled.as_mut_slice()[i * size..(i + 1) * size];
            for (sum, entry) in rows.iter_mut().zip(own) {
                *sum += *entry * (factor - 1.0);
                *entry *= factor;
            }
        }
        if !changed {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes whose ratio is 2 cannot come nearer to one another by powers of two: nothing swings between both.
    #[test]
    fn what_is_balanced_stays() {
        let matrix = Matrix::from_row_slice(3, 3, &[0.0, 2.0, 0.0, 1.0, 0.0, 4.0, 0.0, 2.0, 0.0]);
        let (scales, norm) = balance(&matrix, 0.0);
        let scaled = Matrix::from_fn(3, 3, |i, j| matrix[(i, j)] * scales[j] / scales[i]);
        assert!(norm <= matrix.row_sum().amax());
        assert_eq!(balance(&scaled, 0.0), (Vector::repeat(3, 1.0), norm));
    }

    /// ẋ = v, v̇ = 0, φ turning at rate 2, a force F cos φ + G on y: with every unit the norm is that of what turns.
    #[test]
    fn what_goes_one_way_makes_nothing_fast() {
        let of = |units: [f64; 5], turn: f64| {
            // x, v, y, cos, 1
            let mut matrix = Matrix::zeros(6, 6);
            matrix[(0, 1)] = 1.0;
            matrix[(2, 3)] = 0.7;
            matrix[(2, 5)] = 0.3;
            matrix[(3, 4)] = -turn;
            matrix[(4, 3)] = turn;
            let unit = |index: usize| units.get(index).copied().unwrap_or(1.0);
            Matrix::from_fn(6, 6, |i, j| matrix[(i, j)] * unit(j) / unit(i))
        };
        for turn in [0.0, 2.0] {
            for large in [1e-9, 1e-3, 1e6, 1e9] {
                for state in 0..3 {
                    let mut units = [1.0; 5];
                    units[state] = large;
                    let (scales, norm) = balance(&of(units, turn), 1.0);
                    assert!(norm <= 2.0 * (turn + 2.0), "{units:?}: {norm}");
                    assert!(scales.iter().all(|scale| scale.is_normal()));
                }
            }
        }
    }

    /// Scales follow the units of states, on which a phase and a constant without units act one way.
    #[test]
    fn scales_follow_units() {
        // x, v, cos, sin, 1
        let mut matrix = Matrix::zeros(5, 5);
        matrix[(0, 1)] = 1.0;
        matrix[(1, 0)] = -1.0;
        matrix[(1, 1)] = -0.1;
        (matrix[(1, 3)], matrix[(1, 4)]) = (0.3, -0.02);
        (matrix[(2, 3)], matrix[(3, 2)]) = (-0.5, 0.5);
        let (scales, norm) = balance(&matrix, 0.1);
        for state in 0..2 {
            for large in [1e-9, 1e-3, 1e6, 1e9] {
                let unit = |index: usize| if index == state { large } else { 1.0 };
                let other = Matrix::from_fn(5, 5, |i, j| matrix[(i, j)] * unit(j) / unit(i));
                let (found, of_other) = balance(&other, 0.1);
                // of what goes round it is known to a factor of two, and what goes one way is at most twice as large
                assert!(
                    of_other <= 4.0 * norm && norm <= 4.0 * of_other,
                    "{of_other} {norm}"
                );
                let ratios = (0..5).map(|i| found[i] * unit(i) / scales[i]);
                let ratios: Vec<f64> = ratios.collect();
                // what acts one way on v is between a 128th and four times the rate there, which is known to a factor of two
                let off = |ratio: &f64| (ratio / ratios[1]).log2().abs();
                assert!(
                    ratios.iter().all(|ratio| off(ratio) <= 10.0),
                    "{state} {large}: {ratios:?}"
                );
            }
        }
    }
}
