//! Exponentials of matrices, with their derivatives.

use std::iter::repeat_n;

use nalgebra::{DMatrixView as MatrixView, DMatrixViewMut as MatrixViewMut};

use super::dual::VARYING;
use crate::linalg::Matrix;

/// Terms of the series of exp(Mh) for ‖Mh‖ ≤ 1 in the balanced norm: the remainder is 1/19! ≈ 8e-18.
pub(super) const TERMS: u32 = 18;

/// 1/18!.
const LEFT_OUT: f64 = 1.5619206968586225e-16;

/// Matrices larger than this are multiplied in blocks: smaller ones take longer to pack than to multiply.
const SMALL: usize = 32;

/// E = exp(Mt) for the norm of M, and ∂E/∂p for every M′ of `by` that is not zero: by the series of the balanced matrix over
/// a part of the time, and squares of it. With (E + εE′)² = E² + ε(EE′ + E′E) the derivative is as exact as the value.
///
/// Rows of M below the first, so many, are those of z beyond its `states`: they are constant, or turn in pairs by themselves.
pub(super) fn propagator(
    matrix: &Matrix,
    by: [Option<&Matrix>; VARYING],
    states: usize,
    norm: f64,
    time: f64,
) -> (Matrix, [Option<Matrix>; VARYING]) {
    let by = by.map(|by| by.filter(|by| by.as_slice().iter().any(|by| *by != 0.0)));
    pulp::Arch::new().dispatch(Exponential {
        matrix,
        by,
        states,
        norm,
        time,
    })
}

/// What an exponential follows from.
struct Exponential<'a> {
    matrix: &'a Matrix,
    by: [Option<&'a Matrix>; VARYING],
    states: usize,
    norm: f64,
    time: f64,
}

impl pulp::WithSimd for Exponential<'_> {
    type Output = (Matrix, [Option<Matrix>; VARYING]);

    /// In the widest registers of the machine; no operation is contracted or reordered.
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Exponential {
            matrix,
            by,
            states,
            norm,
            time,
        } = self;
        // the products of the sizes that oscillators have are compiled for them
        match states {
            2 => exponential(matrix, by, norm, time, 2),
            3 => exponential(matrix, by, norm, time, 3),
            4 => exponential(matrix, by, norm, time, 4),
            size => exponential(matrix, by, norm, time, size),
        }
    }
}

/// The same without derivatives.
pub(super) fn plain_propagator(matrix: &Matrix, states: usize, norm: f64, time: f64) -> Matrix {
    propagator(matrix, [None; VARYING], states, norm, time).0
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

/// What of z turns by itself: where a pair of components stands, its angular frequency, and the sine and cosine of its angle
/// after a time.
#[derive(Clone, Copy)]
struct Turn {
    cosine: usize,
    speed: f64,
    angle: (f64, f64),
}

impl Turn {
    fn at(self, time: f64) -> Turn {
        Turn {
            angle: (self.speed * time).sin_cos(),
            ..self
        }
    }
}

/// The components of z beyond the states: pairs that turn, the others being constant.
fn turns(matrix: &Matrix, states: usize) -> Vec<Turn> {
    let cosines = (states + 1..matrix.nrows().saturating_sub(1)).step_by(2);
    let turns = cosines.map(|cosine| Turn {
        cosine,
        speed: matrix[(cosine + 1, cosine)],
        angle: (0.0, 1.0),
    });
    turns.collect()
}

/// Adds to a sum G·W, where W = exp(Mt) of the components beyond the states and G are the columns of these.
#[inline(always)]
fn add_turned(turns: &[Turn], left: &[f64], sum: &mut [f64], rows: usize) {
    let pairs = sum[rows * rows..].iter_mut().zip(&left[rows * rows..]);
    pairs.for_each(|(sum, entry)| *sum += entry);
    for Turn { cosine, angle, .. } in turns {
        let (sine, cosine_at) = angle;
        let cosine_less = cosine_at - 1.0;
        for row in 0..rows {
            let [c, s] = [cosine * rows + row, (cosine + 1) * rows + row];
            sum[c] += cosine_less * left[c] + sine * left[s];
            sum[s] += cosine_less * left[s] - sine * left[c];
        }
    }
}

/// A derivative on its way: M′, and what of it and of its products with M is not zero.
struct Derivative<'a> {
    by: &'a Matrix,
    /// Entries of M′, those of M in the columns that these come to, and whether those of the states are among them.
    own: Vec<(usize, usize, f64)>,
    of_live: Vec<(usize, usize, f64)>,
    is_live: bool,
    sum: &'a mut [f64],
    term: &'a mut [f64],
}

impl Derivative<'_> {
    /// The derivative of the angle of a turn, after a time.
    fn of_angle(&self, turn: &Turn, time: f64) -> f64 {
        self.by[(turn.cosine + 1, turn.cosine)] * time
    }

    /// Adds to a sum G·∂W/∂p.
    #[inline(always)]
    fn add_turned(&self, turns: &[Turn], time: f64, left: &[f64], sum: &mut [f64], rows: usize) {
        for turn in turns {
            let by = self.of_angle(turn, time);
            if by == 0.0 {
                continue;
            }
            let Turn { cosine, angle, .. } = turn;
            let (sine, cosine_at) = angle;
            for row in 0..rows {
                let [c, s] = [cosine * rows + row, (cosine + 1) * rows + row];
                sum[c] += by * (cosine_at * left[s] - sine * left[c]);
                sum[s] -= by * (cosine_at * left[c] + sine * left[s]);
            }
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
    by: [Option<&Matrix>; VARYING],
    norm: f64,
    time: f64,
    states: usize,
) -> (Matrix, [Option<Matrix>; VARYING]) {
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
    let mut turns = turns(matrix, states);
    let all = entries(matrix);
    let varying = by.iter().flatten().count();
    // memory filled here is had faster than zeros of the system
    let mut room: Vec<f64> = repeat_n(0.0, (3 + 2 * varying) * numbers).collect();
    let mut parts = room.chunks_exact_mut(numbers);
    let [Some(mut sum), Some(mut term), Some(mut next)] = std::array::from_fn(|_| parts.next())
    else {
        return (Matrix::zeros(0, 0), [const { None }; VARYING]);
    };
    let mut derivatives = by.map(|by| {
        let by = by?;
        // what depends on a parameter is often the forcing alone: its columns, and those that it comes to
        let own = entries(by);
        let live = live_columns(&own, &all, size);
        let of_live = all.iter().copied().filter(|(from, ..)| live[*from]);
        Some(Derivative {
            of_live: of_live.collect(),
            is_live: live[..states].contains(&true),
            own,
            by,
            sum: parts.next()?,
            term: parts.next()?,
        })
    });
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
        for derivative in derivatives.iter_mut().flatten() {
            next.fill(0.0);
            add_sparse(factor, derivative.term, &derivative.of_live, next, states);
            add_sparse(factor, term, &derivative.own, next, states);
            std::mem::swap(&mut derivative.term, &mut next);
            add_up(derivative.sum, derivative.term);
        }
        next.fill(0.0);
        add_sparse(factor, term, &all, next, states);
        std::mem::swap(&mut term, &mut next);
        add_up(sum, term);
    }
    let mut reached = step;
    for _ in 0..doublings {
        turns.iter_mut().for_each(|turn| *turn = turn.at(reached));
        for derivative in derivatives.iter_mut().flatten() {
            next.fill(0.0);
            add_square(sum, derivative.sum, next, states);
            if derivative.is_live {
                add_square(derivative.sum, sum, next, states);
            }
            add_turned(&turns, derivative.sum, next, states);
            derivative.add_turned(&turns, reached, sum, next, states);
            std::mem::swap(&mut derivative.sum, &mut next);
        }
        next.fill(0.0);
        add_square(sum, sum, next, states);
        add_turned(&turns, sum, next, states);
        std::mem::swap(&mut sum, &mut next);
        reached *= 2.0;
    }
    let turns: Vec<Turn> = turns.into_iter().map(|turn| turn.at(time)).collect();
    let mut flow = whole(sum, states, size);
    (states..size).for_each(|own| flow[(own, own)] = 1.0);
    put_turns(&mut flow, &turns, |turn| {
        let (sine, cosine) = turn.angle;
        [cosine, -sine, sine, cosine]
    });
    let by = derivatives.map(|derivative| {
        let derivative = derivative?;
        let mut flow = whole(derivative.sum, states, size);
        put_turns(&mut flow, &turns, |turn| {
            let (sine, cosine) = turn.angle;
            let by = derivative.of_angle(turn, time);
            [-by * sine, -by * cosine, by * cosine, -by * sine]
        });
        Some(flow)
    });
    (flow, by)
}

/// Puts what every turn has, row by row, into a whole matrix.
fn put_turns(matrix: &mut Matrix, turns: &[Turn], of: impl Fn(&Turn) -> [f64; 4]) {
    for turn in turns {
        let cosine = turn.cosine;
        let sine = cosine + 1;
        let places = [
            (cosine, cosine),
            (cosine, sine),
            (sine, cosine),
            (sine, sine),
        ];
        for (place, value) in places.into_iter().zip(of(turn)) {
            matrix[place] = value;
        }
    }
}
