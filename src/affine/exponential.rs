//! Exponentials of matrices, with their derivatives.

use std::iter::repeat_n;

use nalgebra::{DMatrixView as MatrixView, DMatrixViewMut as MatrixViewMut};

use crate::linalg::Matrix;

/// Terms of the series of exp(Mh) for ‖Mh‖ ≤ 1 in the balanced norm: the remainder is 1/19! ≈ 8e-18.
pub(super) const TERMS: u32 = 18;

/// 1/18!.
const LEFT_OUT: f64 = 1.5619206968586225e-16;

/// Matrices larger than this are multiplied in blocks: smaller ones take longer to pack than to multiply.
const SMALL: usize = 32;

/// E = exp(Mt) for the norm of M, and ∂E/∂p for M′ = `by`: by the series of the balanced matrix over a part of the
/// time, and squares of it. With (E + εE′)² = E² + ε(EE′ + E′E) the derivative is as exact as the value.
///
/// Rows of M below the first, so many, are those of z beyond its `states`: they are constant, or turn in pairs by themselves.
pub(super) fn propagator(
    matrix: &Matrix,
    by: Option<&Matrix>,
    states: usize,
    norm: f64,
    time: f64,
) -> (Matrix, Option<Matrix>) {
    let by = by.filter(|by| by.as_slice().iter().any(|by| *by != 0.0));
    // the products of the sizes that oscillators have are compiled for them
    match states {
        2 => exponential(matrix, by, norm, time, 2),
        3 => exponential(matrix, by, norm, time, 3),
        4 => exponential(matrix, by, norm, time, 4),
        size => exponential(matrix, by, norm, time, size),
    }
}

/// Entries that are not zero: row, column, value.
pub(super) fn entries(matrix: &Matrix) -> Vec<(usize, usize, f64)> {
    let mut entries = Vec::with_capacity(4 * matrix.nrows());
    for (column, values) in matrix.as_slice().chunks_exact(matrix.nrows()).enumerate() {
        let values = values.iter().enumerate();
        let values = values.filter(|(_, value)| **value != 0.0);
        entries.extend(values.map(|(row, value)| (row, column, *value)));
    }
    entries
}

/// The columns of M′Mᵏ, k ≥ 0, that are not all zero: those of M′, and those that M leads them to.
fn live_columns(
    by: &[(usize, usize, f64)],
    entries: &[(usize, usize, f64)],
    size: usize,
) -> Vec<bool> {
    let mut live: Vec<bool> = repeat_n(false, size).collect();
    by.iter().for_each(|(_, column, _)| live[*column] = true);
    loop {
        let mut grown = false;
        for (from, to, _) in entries {
            if live[*from] && !live[*to] {
                (live[*to], grown) = (true, true);
            }
        }
        if !grown {
            return live;
        }
    }
}

/// Adds factor·left·right to a sum, for the entries of right; columns of left have this length.
#[inline(always)]
fn add_sparse(
    factor: f64,
    left: &[f64],
    right: &[(usize, usize, f64)],
    sum: &mut [f64],
    rows: usize,
) {
    for (from, to, weight) in right {
        let weight = factor * weight;
        let (sum, left) = (&mut sum[to * rows..][..rows], &left[from * rows..][..rows]);
        let pairs = sum.iter_mut().zip(left);
        pairs.for_each(|(sum, entry)| *sum += weight * entry);
    }
}

/// Adds left·right to a sum, left a square of this size.
#[inline(always)]
fn add_square(left: &[f64], right: &[f64], sum: &mut [f64], size: usize) {
    if size > SMALL {
        let columns = right.len() / size;
        let left = MatrixView::from_slice(left, size, size);
        let right = MatrixView::from_slice(right, size, columns);
        MatrixViewMut::from_slice(sum, size, columns).gemm(1.0, &left, &right, 1.0);
    } else {
        let left = &left[..size * size];
        for (sum, right) in sum.chunks_exact_mut(size).zip(right.chunks_exact(size)) {
            let sum = &mut sum[..size];
            for (weight, left) in right[..size].iter().zip(left.chunks_exact(size)) {
                // of large matrices many columns are zero
                if size <= 4 || *weight != 0.0 {
                    let pairs = sum.iter_mut().zip(&left[..size]);
                    pairs.for_each(|(sum, entry)| *sum += weight * entry);
                }
            }
        }
    }
}

/// What of z turns by itself: where a pair of components stands, its angular frequency, and the derivative of that;
/// the angle after a time by its sine and cosine, and the derivative of the angle.
#[derive(Clone, Copy)]
struct Turn {
    cosine: usize,
    speed: f64,
    by: f64,
    angle: ((f64, f64), f64),
}

impl Turn {
    fn at(self, time: f64) -> Turn {
        Turn {
            angle: ((self.speed * time).sin_cos(), self.by * time),
            ..self
        }
    }
}

/// The components of z beyond the states: pairs that turn, the others being constant.
fn turns(matrix: &Matrix, by: Option<&Matrix>, states: usize) -> Vec<Turn> {
    let cosines = (states + 1..matrix.nrows().saturating_sub(1)).step_by(2);
    let turns = cosines.map(|cosine| Turn {
        cosine,
        speed: matrix[(cosine + 1, cosine)],
        by: by.map_or(0.0, |by| by[(cosine + 1, cosine)]),
        angle: ((0.0, 1.0), 0.0),
    });
    turns.collect()
}

/// Adds to a sum G·W, where W = exp(Mt) of the components beyond the states and G are the columns of these.
#[inline(always)]
fn add_turned(turns: &[Turn], left: &[f64], sum: &mut [f64], rows: usize) {
    let pairs = sum[rows * rows..].iter_mut().zip(&left[rows * rows..]);
    pairs.for_each(|(sum, entry)| *sum += entry);
    for Turn { cosine, angle, .. } in turns {
        let ((sine, cosine_at), _) = angle;
        let cosine_less = cosine_at - 1.0;
        for row in 0..rows {
            let [c, s] = [cosine * rows + row, (cosine + 1) * rows + row];
            sum[c] += cosine_less * left[c] + sine * left[s];
            sum[s] += cosine_less * left[s] - sine * left[c];
        }
    }
}

/// Adds to a sum G·∂W/∂p.
#[inline(always)]
fn add_turned_by(turns: &[Turn], left: &[f64], sum: &mut [f64], rows: usize) {
    for Turn { cosine, angle, .. } in turns.iter().filter(|turn| turn.by != 0.0) {
        let ((sine, cosine_at), by) = angle;
        for row in 0..rows {
            let [c, s] = [cosine * rows + row, (cosine + 1) * rows + row];
            sum[c] += by * (cosine_at * left[s] - sine * left[c]);
            sum[s] -= by * (cosine_at * left[c] + sine * left[s]);
        }
    }
}

/// The rows of the states as they are, columns of this length, within a whole matrix.
fn whole(rows: &[f64], states: usize, size: usize) -> Matrix {
    let mut whole = Matrix::zeros(size, size);
    let columns = whole.as_mut_slice().chunks_exact_mut(size);
    for (column, known) in columns.zip(rows.chunks_exact(states)) {
        column[..states].copy_from_slice(known);
    }
    whole
}

#[inline(always)]
fn exponential(
    matrix: &Matrix,
    by: Option<&Matrix>,
    norm: f64,
    time: f64,
    states: usize,
) -> (Matrix, Option<Matrix>) {
    let doublings = (norm * time.abs()).log2().ceil().max(0.0);
    // what is not finite gives a propagator that is not
    let step = time * (-doublings).exp2();
    let doublings = if doublings.is_finite() {
        doublings as u32
    } else {
        0
    };
    // as many terms as leave out of the derivative what the longest series does for the longest step
    let (mut terms, mut left_out) = (0, 1.0);
    while terms == 0 || terms < TERMS && left_out > LEFT_OUT {
        terms += 1;
        left_out *= norm * step.abs() / f64::from(terms);
    }
    let size = matrix.nrows();
    let numbers = states * size;
    let mut turns = turns(matrix, by, states);
    let all = entries(matrix);
    // what depends on a parameter is often the forcing alone: its columns, and those that it comes to
    let by_entries = by.map(entries).unwrap_or_default();
    let live = live_columns(&by_entries, &all, size);
    let of_live: Vec<_> = all
        .iter()
        .copied()
        .filter(|(from, ..)| live[*from])
        .collect();
    // memory filled here is had faster than zeros of the system
    let mut room: Vec<f64> = repeat_n(0.0, 5 * numbers).collect();
    let mut parts = room.chunks_exact_mut(numbers);
    let [
        Some(mut sum),
        Some(mut term),
        Some(mut next),
        Some(mut sum_by),
        Some(mut term_by),
    ] = std::array::from_fn(|_| parts.next())
    else {
        return (Matrix::zeros(0, 0), None);
    };
    for state in 0..states {
        sum[state * states + state] = 1.0;
        term[state * states + state] = 1.0;
    }
    let add_up = |sum: &mut [f64], term: &[f64]| {
        let pairs = sum.iter_mut().zip(term);
        pairs.for_each(|(sum, term)| *sum += term);
    };
    for k in 1..=terms {
        let factor = step / f64::from(k);
        if by.is_some() {
            next.fill(0.0);
            add_sparse(factor, term_by, &of_live, next, states);
            add_sparse(factor, term, &by_entries, next, states);
            std::mem::swap(&mut term_by, &mut next);
            add_up(sum_by, term_by);
        }
        next.fill(0.0);
        add_sparse(factor, term, &all, next, states);
        std::mem::swap(&mut term, &mut next);
        add_up(sum, term);
    }
    let mut reached = step;
    for _ in 0..doublings {
        turns.iter_mut().for_each(|turn| *turn = turn.at(reached));
        if by.is_some() {
            next.fill(0.0);
            add_square(sum, sum_by, next, states);
            if live[..states].contains(&true) {
                add_square(sum_by, sum, next, states);
            }
            add_turned(&turns, sum_by, next, states);
            add_turned_by(&turns, sum, next, states);
            std::mem::swap(&mut sum_by, &mut next);
        }
        next.fill(0.0);
        add_square(sum, sum, next, states);
        add_turned(&turns, sum, next, states);
        std::mem::swap(&mut sum, &mut next);
        reached *= 2.0;
    }
    let mut flow = whole(sum, states, size);
    (states..size).for_each(|own| flow[(own, own)] = 1.0);
    let mut flow_by = by.map(|_| whole(sum_by, states, size));
    for turn in turns {
        let Turn { cosine, angle, .. } = turn.at(time);
        let ((sine, at), by) = angle;
        let both = [
            (cosine, cosine),
            (cosine, cosine + 1),
            (cosine + 1, cosine),
            (cosine + 1, cosine + 1),
        ];
        for (place, (value, slope)) in
            both.into_iter()
                .zip([(at, -sine), (-sine, -at), (sine, at), (at, -sine)])
        {
            flow[place] = value;
            if let Some(flow_by) = &mut flow_by {
                flow_by[place] = by * slope;
            }
        }
    }
    (flow, flow_by)
}
