//! The periodic Schur form: unitary turns of rows and columns that make all factors of a product triangular.

use super::Factor;
use super::product::{Number, Scalar, exponent_of, size, times_power};

/// Whether a shift is so many times what begins a block that a sweep with it does nothing.
pub(super) fn is_out_of_proportion<S: Scalar, T: Scalar>(shift: S, begin: T, below: T) -> bool {
    /// A shift may be this many times the first of the block.
    const MOST: f64 = 1e6;
    let shift = size(shift);
    !shift.is_finite() || shift > MOST * (size(begin) + size(below))
}

/// Brings numbers that are multiplied on and on back to order one where they come near the end of the range. The power of two that
/// is taken out of them; none where they all vanish or are no numbers.
pub(super) fn kept_in_range<T: Scalar>(numbers: &mut [T]) -> Option<i64> {
    /// Between these sizes products with a factor of any size are numbers.
    const RANGE: std::ops::Range<f64> = 1e-100..1e100;
    let most = |most: f64, number: &T| most.max(number.norm1());
    let largest = numbers.iter().fold(0.0, most);
    if RANGE.contains(&largest) {
        return Some(0);
    }
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let by = exponent_of(largest);
    let each = numbers.iter_mut();
    each.for_each(|number| *number = times_power(*number, -by));
    Some(by)
}

/// A rotation [c s; −s̄ c] of two coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneRotation<T> {
    c: f64,
    s: T,
}

impl<T: Scalar> PlaneRotation<T> {
    /// That which takes (a, b) to (r, 0).
    fn onto_first(a: T, b: T) -> PlaneRotation<T> {
        let (first, other) = (size(a), size(b));
        let length = size(Number::new(first, other));
        if other == 0.0 || !length.is_finite() {
            return PlaneRotation {
                c: 1.0,
                s: T::zero(),
            };
        }
        let unit = if first == 0.0 {
            T::one()
        } else {
            a.unscale(first)
        };
        PlaneRotation {
            c: first / length,
            s: unit * b.conjugate().unscale(length),
        }
    }
}

/// The factors, columns of one after those of the other, the first first; and how often they were turned.
pub(super) struct Chain<T> {
    pub n: usize,
    pub count: usize,
    pub entries: Vec<T>,
    pub turns: usize,
}

impl<T: Scalar> Chain<T> {
    pub fn at(&self, factor: usize, row: usize, column: usize) -> T {
        self.entries[(factor * self.n + column) * self.n + row]
    }

    fn set(&mut self, factor: usize, row: usize, column: usize, value: T) {
        self.entries[(factor * self.n + column) * self.n + row] = value;
    }

    /// Turns rows i and i + 1 of a factor, which are zero before a column.
    pub fn turn_rows(&mut self, factor: usize, i: usize, turn: PlaneRotation<T>, from: usize) {
        let n = self.n;
        let PlaneRotation { c, s } = turn;
        let back = s.conjugate();
        let entries = &mut self.entries[(factor * n + from) * n..(factor + 1) * n * n];
        for column in entries.chunks_exact_mut(n) {
            if let [first, second] = &mut column[i..i + 2] {
                let (x, y) = (*first, *second);
                *first = x.scale(c) + s * y;
                *second = y.scale(c) - back * x;
            }
        }
    }

    /// Turns columns i and i + 1 of a factor back, which are zero from a row on.
    pub fn turn_columns(&mut self, factor: usize, i: usize, turn: PlaneRotation<T>, to: usize) {
        let n = self.n;
        let PlaneRotation { c, s } = turn;
        let back = s.conjugate();
        let begin = (factor * n + i) * n;
        let (first, second) = self.entries[begin..begin + 2 * n].split_at_mut(n);
        for (x, y) in first[..to].iter_mut().zip(&mut second[..to]) {
            let (a, b) = (*x, *y);
            *x = a.scale(c) + back * b;
            *y = b.scale(c) - s * a;
        }
    }

    /// Turns rows of a factor, which are zero before a column, so that the lower one is zero there, too.
    pub fn level(&mut self, factor: usize, row: usize, column: usize) -> PlaneRotation<T> {
        let turn = PlaneRotation::onto_first(
            self.at(factor, row, column),
            self.at(factor, row + 1, column),
        );
        self.turn_rows(factor, row, turn, column);
        self.set(factor, row + 1, column, T::zero());
        turn
    }

    /// A turn of rows of the last factor goes through all others, which stay triangular, to its columns, which are zero
    /// from a row on.
    pub fn pass(&mut self, i: usize, mut turn: PlaneRotation<T>, to: usize) {
        let last = self.count - 1;
        for factor in 0..last {
            self.turn_columns(factor, i, turn, i + 2);
            turn = self.level(factor, i, i);
        }
        self.turn_columns(last, i, turn, to);
        self.turns += 1;
    }

    /// A sweep without shift, which puts larger eigenvalues before smaller ones whatever is singular.
    pub fn sort(&mut self, low: usize, high: usize) {
        let last = self.count - 1;
        let mut turns = Vec::with_capacity(high - low);
        turns.extend((low..high).map(|i| self.level(last, i, i)));
        for factor in 0..=last {
            for (i, turn) in (low..high).zip(&turns) {
                self.turn_columns(factor, i, *turn, i + 2);
            }
            if factor < last {
                turns.clear();
                turns.extend((low..high).map(|i| self.level(factor, i, i)));
            }
        }
        self.turns += high - low;
    }

    /// A sweep with a shift. False where that is so much larger than what begins the block that the sweep would do nothing.
    pub fn shifted(&mut self, low: usize, high: usize, shift: T, exponent: i64) -> bool {
        let last = self.count - 1;
        let (mut first, mut power) = ([T::one()], 0);
        for factor in 0..last {
            first[0] *= self.at(factor, low, low);
            let Some(by) = kept_in_range(&mut first) else {
                return false;
            };
            power += by;
        }
        let [first] = first;
        let relative = times_power(shift / first, exponent - power);
        let (begin, below) = (self.at(last, low, low), self.at(last, low + 1, low));
        if is_out_of_proportion(relative, begin, below) {
            return false;
        }
        // columns of the Hessenberg form end one row below the diagonal
        let n = self.n;
        let end = |i: usize| (i + 3).min(n);
        let turn = PlaneRotation::onto_first(begin - relative, below);
        self.turn_rows(last, low, turn, low);
        self.pass(low, turn, end(low));
        for column in low..high - 1 {
            let turn = self.level(last, column + 1, column);
            self.pass(column + 1, turn, end(column + 1));
        }
        true
    }

    /// The last two dimensions of the product of a block, by rows and over a power of two: the largest entry is of order one. None
    /// where they vanish or are no numbers.
    pub fn trailing(&self, low: usize, high: usize) -> Option<([T; 4], i64)> {
        let (last, begin, zero) = (self.count - 1, high - 1, T::zero());
        let at = |factor: usize, row: usize, column: usize| -> T {
            self.at(factor, begin + row, begin + column)
        };
        // the same of all factors but the last, and the row before them, which the last one brings back
        let mut rows = [zero, zero, T::one(), zero, T::one()];
        let mut exponent = 0;
        for factor in 0..last {
            let [mut before, mut beside, first, across, second] = rows;
            if low < begin {
                let [own, one, other] = [0, 1, 2].map(|j| self.at(factor, begin - 1, high - 2 + j));
                before = own * before + one * first;
                beside = own * beside + one * across + other * second;
            }
            let [a, b, d] = [at(factor, 0, 0), at(factor, 0, 1), at(factor, 1, 1)];
            rows = [
                before,
                beside,
                a * first,
                a * across + b * second,
                d * second,
            ];
            exponent += kept_in_range(&mut rows)?;
        }
        let [before, beside, first, across, second] = rows;
        let back = match low < begin {
            true => self.at(last, begin, begin - 1),
            false => zero,
        };
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| at(last, i, j));
        let mut block = [
            back * before + a * first,
            back * beside + a * across + b * second,
            c * first,
            c * across + d * second,
        ];
        let largest = block
            .iter()
            .fold(0.0, |most: f64, entry| most.max(entry.norm1()));
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        let by = exponent_of(largest);
        block = block.map(|entry| times_power(entry, -by));
        Some((block, exponent + by))
    }

    /// Where the block that ends with a dimension begins: what is so small that it is nothing is made zero there.
    pub fn begin_of_block(&mut self, high: usize, norm: f64) -> usize {
        let last = self.count - 1;
        let mut low = high;
        while low > 0 {
            let below = size(self.at(last, low, low - 1));
            let beside = size(self.at(last, low, low)) + size(self.at(last, low - 1, low - 1));
            let least = if beside > 0.0 { beside } else { norm };
            if below <= f64::EPSILON * least {
                self.set(last, low, low - 1, T::zero());
                break;
            }
            low -= 1;
        }
        low
    }

    /// The norm of a factor.
    pub fn norm(&self, factor: usize) -> f64 {
        let own = factor * self.n * self.n..(factor + 1) * self.n * self.n;
        let entries = self.entries[own].iter();
        let squares = entries.map(|one| one.modulus_squared());
        squares.sum::<f64>().sqrt()
    }
}

impl Chain<f64> {
    /// That of factors of n dimensions, which were not yet turned.
    pub fn of(factors: &[&Factor], n: usize) -> Chain<f64> {
        let entries: Vec<&[f64]> = factors.iter().map(|one| one.matrix.as_slice()).collect();
        Chain {
            n,
            count: factors.len(),
            entries: entries.concat(),
            turns: 0,
        }
    }

    /// Whether nothing is below the diagonal of the last factor, the only one that may not be triangular.
    pub fn is_triangular(&self) -> bool {
        let last = self.count - 1;
        (1..self.n).all(|i| self.at(last, i, i - 1) == 0.0)
    }

    /// The same in complex numbers.
    pub fn complex(&self) -> Chain<Number> {
        let entries = self.entries.iter();
        Chain {
            n: self.n,
            count: self.count,
            entries: entries.map(|entry| Number::new(*entry, 0.0)).collect(),
            turns: self.turns,
        }
    }
}

impl Chain<Number> {
    /// That eigenvalue of the last two dimensions of the product of a block that is nearer to its last entry.
    fn shift(&self, low: usize, high: usize) -> Option<(Number, i64)> {
        let ([a, b, c, d], exponent) = self.trailing(low, high)?;
        let half = (a - d) * 0.5;
        let root = (half * half + b * c).sqrt();
        let way = if (half.conj() * root).re >= 0.0 {
            half + root
        } else {
            half - root
        };
        // of x² − (a − d)x − bc the root of smaller modulus, without cancellation
        let off = if way.norm() > 0.0 {
            b * c / way
        } else {
            Number::new(0.0, 0.0)
        };
        Some((d - off, exponent))
    }

    /// The periodic Schur form. What had to be left out of the last factor, relative to its norm.
    pub fn triangularise(&mut self) -> f64 {
        /// Sweeps for one eigenvalue: two or three are enough. Of all sweeps every so many are without shift.
        const MOST: usize = 80;
        const PLAIN: usize = 6;
        let last = self.count - 1;
        let mut left_out = 0.0_f64;
        let norm = self.norm(last);
        let (mut high, mut sweeps, mut all) = (self.n - 1, 0, 0);
        while high > 0 {
            let mut low = self.begin_of_block(high, norm);
            if low < high && sweeps >= MOST {
                let below = size(self.at(last, high, high - 1));
                left_out = left_out.max(below / norm);
                self.set(last, high, high - 1, Number::new(0.0, 0.0));
                low = high;
            }
            if low == high {
                high -= 1;
                sweeps = 0;
                continue;
            }
            all += 1;
            let shift = self.shift(low, high).filter(|_| all % PLAIN != 0);
            if !shift.is_some_and(|(shift, power)| self.shifted(low, high, shift, power)) {
                self.sort(low, high);
            }
            sweeps += 1;
        }
        if left_out.is_finite() {
            left_out
        } else {
            f64::INFINITY
        }
    }
}
