//! Exponentials of matrices, with their derivatives, and the scales in which a matrix is small.

use crate::linalg::{Matrix, Vector, add_product};

/// Terms of the series of exp(Mh) for ‖Mh‖ ≤ 1 in the balanced norm: the remainder is 1/19! ≈ 8e-18.
pub(super) const TERMS: u32 = 18;

/// Sweeps that balance a matrix: each at least halves what is left to gain.
const SWEEPS: usize = 20;

/// Matrices larger than this are squared in blocks: smaller ones take longer to pack than to multiply.
const SMALL: usize = 32;

/// Largest size of a matrix whose products are compiled for it.
const COMPILED: usize = 6;

/// E = exp(Mt) for the norm of M, and ∂E/∂p for M′ = `by`: by the series of the balanced matrix over a part of the
/// time, and squares of it. With (E + εE′)² = E² + ε(EE′ + E′E) the derivative is as exact as the value.
pub(super) fn propagator(
    matrix: &Matrix,
    by: Option<&Matrix>,
    norm: f64,
    time: f64,
) -> (Matrix, Option<Matrix>) {
    let by = by.filter(|by| by.iter().any(|by| *by != 0.0));
    // the products of the sizes that oscillators have are compiled for them
    match matrix.nrows() {
        3 => exponential(matrix, by, norm, time, 3),
        4 => exponential(matrix, by, norm, time, 4),
        5 => exponential(matrix, by, norm, time, 5),
        6 => exponential(matrix, by, norm, time, 6),
        size => exponential(matrix, by, norm, time, size),
    }
}

/// The columns of M′Mᵏ, k ≥ 0, that are not all zero, in order: those of M′ = `by`, and those that M leads them to.
fn columns_through(by: &Matrix, matrix: &Matrix) -> Vec<usize> {
    let size = matrix.nrows();
    let mut live: Vec<bool> = by
        .column_iter()
        .map(|column| column.iter().any(|entry| *entry != 0.0))
        .collect();
    let mut found: Vec<usize> = (0..size).filter(|column| live[*column]).collect();
    let mut done = 0;
    while let Some(&from) = found.get(done) {
        done += 1;
        for to in 0..size {
            if !live[to] && matrix[(from, to)] != 0.0 {
                live[to] = true;
                found.push(to);
            }
        }
    }
    found.sort_unstable();
    found
}

/// Adds factor·left·right to a sum, all of this size, which is known where it is compiled.
#[inline(always)]
fn add_whole(factor: f64, left: &[f64], right: &[f64], sum: &mut [f64], size: usize) {
    let numbers = size * size;
    add_product(
        factor,
        &left[..numbers],
        size,
        &right[..numbers],
        &mut sum[..numbers],
    );
}

/// The same where all other columns of left are zero.
#[inline(always)]
fn add_live(
    factor: f64,
    left: &[f64],
    right: &[f64],
    sum: &mut [f64],
    (live, size): (Option<&[usize]>, usize),
) {
    let Some(live) = live else {
        return add_whole(factor, left, right, sum, size);
    };
    for &j in live {
        let sum = &mut sum[j * size..(j + 1) * size];
        for &k in live {
            let weight = right[j * size + k];
            if weight != 0.0 {
                let weight = factor * weight;
                let pairs = sum.iter_mut().zip(&left[k * size..(k + 1) * size]);
                pairs.for_each(|(sum, entry)| *sum += weight * entry);
            }
        }
    }
}

#[inline(always)]
fn exponential(
    matrix: &Matrix,
    by: Option<&Matrix>,
    norm: f64,
    time: f64,
    size: usize,
) -> (Matrix, Option<Matrix>) {
    let doublings = (norm * time.abs()).log2().ceil().max(0.0);
    // what is not finite gives a propagator that is not
    let step = time * (-doublings).exp2();
    let doublings = if doublings.is_finite() {
        doublings as u32
    } else {
        0
    };
    let numbers = size * size;
    // what depends on a parameter is often the forcing alone: its columns, and those that it comes to
    let live = by.filter(|_| size > COMPILED);
    let live = live.map(|by| columns_through(by, matrix));
    let live = live.filter(|live| live.len() < size);
    let live = live.as_deref();
    let add_up = |sum: &mut [f64], term: &[f64]| {
        let pairs = sum[..numbers].iter_mut().zip(&term[..numbers]);
        pairs.for_each(|(sum, term)| *sum += term);
    };
    let matrix = matrix.as_slice();
    let mut sum = Matrix::identity(size, size);
    let mut room = vec![0.0; 3 * numbers];
    let (mut term, room) = room.split_at_mut(numbers);
    let (mut next, mut term_by) = room.split_at_mut(numbers);
    term.copy_from_slice(sum.as_slice());
    let mut sum_by = by.map(|_| Matrix::zeros(size, size));
    for k in 1..=TERMS {
        let factor = step / f64::from(k);
        if let Some((by, sum_by)) = by.zip(sum_by.as_mut()) {
            next.fill(0.0);
            add_live(factor, term_by, matrix, next, (live, size));
            add_whole(factor, term, by.as_slice(), next, size);
            std::mem::swap(&mut term_by, &mut next);
            add_up(sum_by.as_mut_slice(), term_by);
        }
        next.fill(0.0);
        add_whole(factor, term, matrix, next, size);
        std::mem::swap(&mut term, &mut next);
        add_up(sum.as_mut_slice(), term);
    }
    for _ in 0..doublings {
        if size > SMALL {
            if let Some(by) = &mut sum_by {
                let mut next = &sum * &*by;
                if live.is_some() {
                    add_live(
                        1.0,
                        by.as_slice(),
                        sum.as_slice(),
                        next.as_mut_slice(),
                        (live, size),
                    );
                } else {
                    next += &*by * &sum;
                }
                *by = next;
            }
            sum = &sum * &sum;
            continue;
        }
        if let Some(by) = &mut sum_by {
            next.fill(0.0);
            add_whole(1.0, sum.as_slice(), by.as_slice(), next, size);
            add_live(1.0, by.as_slice(), sum.as_slice(), next, (live, size));
            by.copy_from_slice(next);
        }
        next.fill(0.0);
        add_whole(1.0, sum.as_slice(), sum.as_slice(), next, size);
        sum.copy_from_slice(next);
    }
    (sum, sum_by)
}

/// Powers of two d for which the largest column sum of D⁻¹MD is small, and that sum.
///
/// Osborne's method: rows and columns of one index get the same size. Units as different as volts and seconds
/// would otherwise make pieces a hundred times too short.
pub(crate) fn balance(matrix: &Matrix) -> (Vector, f64) {
    let size = matrix.nrows();
    let mut scales = Vector::repeat(size, 1.0);
    let diagonal = matrix.diagonal().abs();
    let mut scaled = matrix.abs();
    scaled.fill_diagonal(0.0);
    // the power of two nearest to √(row/column)
    let wanted = |row: f64, column: f64| {
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
    let sums = scaled.column_iter().zip(&diagonal);
    let sums = sums.map(|(column, own)| column.sum() + own);
    (scales, sums.fold(0.0, f64::max))
}
