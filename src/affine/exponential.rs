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
fn live_columns(by: &Columns, matrix: &Columns, size: usize) -> Vec<bool> {
    let mut live: Vec<bool> = repeat_n(false, size).collect();
    by.each().for_each(|(column, _)| live[column] = true);
    loop {
        let mut grown = false;
        for (to, entries) in matrix.each() {
            if !live[to] && entries.iter().any(|(from, _)| live[*from]) {
                (live[to], grown) = (true, true);
            }
        }
        if !grown {
            return live;
        }
    }
}

/// The columns of a matrix that have entries which are not zero.
#[derive(Clone)]
struct Columns {
    /// The number of each, and where its entries end.
    ends: Vec<(usize, usize)>,
    /// Row and value.
    entries: Vec<(usize, f64)>,
}

impl Columns {
    fn of(matrix: &Matrix) -> Columns {
        let mut columns = Columns {
            ends: Vec::with_capacity(matrix.ncols()),
            entries: Vec::with_capacity(4 * matrix.nrows()),
        };
        let values = matrix.as_slice().chunks_exact(matrix.nrows().max(1));
        for (number, values) in values.enumerate() {
            let values = values.iter().enumerate();
            let entries = values.filter(|(_, value)| **value != 0.0);
            columns
                .entries
                .extend(entries.map(|(row, value)| (row, *value)));
            columns.end(number);
        }
        columns
    }

    /// Ends a column, which is none where nothing has been put into it.
    fn end(&mut self, number: usize) {
        let (last, end) = (
            self.ends.last().map_or(0, |(_, end)| *end),
            self.entries.len(),
        );
        if end > last {
            self.ends.push((number, end));
        }
    }

    /// Every one with its entries.
    #[inline(always)]
    fn each(&self) -> impl Iterator<Item = (usize, &[(usize, f64)])> {
        let mut begun = 0;
        self.ends.iter().map(move |(number, end)| {
            let entries = &self.entries[begun..*end];
            begun = *end;
            (*number, entries)
        })
    }

    /// The entries of a column.
    fn column(&self, number: usize) -> &[(usize, f64)] {
        let mut each = self.each();
        each.find(|(own, _)| *own == number)
            .map_or(&[], |(_, entries)| entries)
    }

    /// The next term, which is factor·term·M, in the place of another that has the same columns; it is added to the sum. Columns have
    /// this length.
    #[inline(always)]
    fn step(&self, factor: f64, term: &[f64], next: &mut [f64], sum: &mut [f64], rows: usize) {
        match rows {
            2 => self.step_of::<2>(factor, term, next, sum),
            3 => self.step_of::<3>(factor, term, next, sum),
            4 => self.step_of::<4>(factor, term, next, sum),
            _ => self.step_of_any(factor, term, next, sum, rows),
        }
    }

    /// The same where the length is known to the compiler.
    #[inline(always)]
    fn step_of<const ROWS: usize>(
        &self,
        factor: f64,
        term: &[f64],
        next: &mut [f64],
        sum: &mut [f64],
    ) {
        let (term, _) = term.as_chunks::<ROWS>();
        let (next, _) = next.as_chunks_mut::<ROWS>();
        let (sum, _) = sum.as_chunks_mut::<ROWS>();
        for (to, entries) in self.each() {
            let mut own = [0.0; ROWS];
            for (from, weight) in entries {
                let (weight, from) = (factor * weight, &term[*from]);
                for row in 0..ROWS {
                    own[row] += weight * from[row];
                }
            }
            next[to] = own;
            for row in 0..ROWS {
                sum[to][row] += own[row];
            }
        }
    }

    /// The same of any length.
    #[inline(always)]
    fn step_of_any(
        &self,
        factor: f64,
        term: &[f64],
        next: &mut [f64],
        sum: &mut [f64],
        rows: usize,
    ) {
        for (to, entries) in self.each() {
            let own = &mut next[to * rows..][..rows];
            own.fill(0.0);
            for (from, weight) in entries {
                let (weight, from) = (factor * weight, &term[from * rows..][..rows]);
                let pairs = own.iter_mut().zip(from);
                pairs.for_each(|(sum, entry)| *sum += weight * entry);
            }
            let pairs = sum[to * rows..][..rows].iter_mut().zip(own);
            pairs.for_each(|(sum, term)| *sum += *term);
        }
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
    /// Whether there is any in the columns of the states.
    is_live: bool,
    sum: &'a mut [f64],
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
    let own = Columns::of(matrix);
    let count = 1 + by.iter().flatten().count();
    // exp(Mt) and its derivatives E′ together are the series of one matrix: E′ ← E′M + EM′
    let mut all = own.clone();
    let mut live = Vec::with_capacity(VARYING);
    for (number, by) in by.iter().flatten().enumerate() {
        // what depends on a parameter is often the forcing alone: its columns, and those that it comes to
        let by = Columns::of(by);
        let own_live = live_columns(&by, &own, size);
        let first = (number + 1) * size;
        for to in 0..size {
            let of_live = own.column(to).iter().filter(|(from, _)| own_live[*from]);
            all.entries
                .extend(of_live.map(|(from, x)| (first + from, *x)));
            all.entries.extend(by.column(to));
            all.end(first + to);
        }
        live.push(own_live[..states].contains(&true));
    }
    // memory filled here is had faster than zeros of the system
    let mut room: Vec<f64> = repeat_n(0.0, 3 * count * numbers).collect();
    let (sum, rest) = room.split_at_mut(count * numbers);
    let (mut term, mut next) = rest.split_at_mut(count * numbers);
    for state in 0..states {
        sum[state * states + state] = 1.0;
        term[state * states + state] = 1.0;
    }
    for k in 1..=terms {
        all.step(step / f64::from(k), term, next, sum, states);
        std::mem::swap(&mut term, &mut next);
        if k == 1 {
            // of the first term there are columns that no other one has
            next.fill(0.0);
        }
    }
    let (mut sum, sums) = sum.split_at_mut(numbers);
    let mut next = &mut next[..numbers];
    let (mut sums, mut live) = (sums.chunks_exact_mut(numbers.max(1)), live.into_iter());
    let mut derivatives = by.map(|by| {
        Some(Derivative {
            by: by?,
            is_live: live.next()?,
            sum: sums.next()?,
        })
    });
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
