//! The periodic Schur form: unitary turns of rows and columns that make all factors of a product triangular.

use nalgebra::ComplexField;

use super::product::{Number, Product, exponent_of, size, times_power};

/// A rotation [c s; −s̄ c] of two coordinates.
#[derive(Clone, Copy, Debug)]
struct PlaneRotation<T> {
    c: f64,
    s: T,
}

impl<T: ComplexField<RealField = f64> + Copy> PlaneRotation<T> {
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

impl<T: ComplexField<RealField = f64> + Copy> Chain<T> {
    pub fn at(&self, factor: usize, row: usize, column: usize) -> T {
        self.entries[(factor * self.n + column) * self.n + row]
    }

    fn set(&mut self, factor: usize, row: usize, column: usize, value: T) {
        self.entries[(factor * self.n + column) * self.n + row] = value;
    }

    /// Turns rows i and i + 1 of a factor, which are zero before a column.
    fn turn_rows(&mut self, factor: usize, i: usize, turn: PlaneRotation<T>, from: usize) {
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
    fn turn_columns(&mut self, factor: usize, i: usize, turn: PlaneRotation<T>, to: usize) {
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
    fn level(&mut self, factor: usize, row: usize, column: usize) -> PlaneRotation<T> {
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
    fn pass(&mut self, i: usize, mut turn: PlaneRotation<T>, to: usize) {
        let last = self.count - 1;
        for factor in 0..last {
            self.turn_columns(factor, i, turn, i + 2);
            turn = self.level(factor, i, i);
        }
        self.turn_columns(last, i, turn, to);
        self.turns += 1;
    }

    /// The periodic Hessenberg-triangular form.
    pub fn reduce(&mut self) {
        let (n, last) = (self.n, self.count - 1);
        let mut most = 0;
        for factor in 0..last {
            let mut turns = 0;
            for column in 0..n {
                for row in (column..n - 1).rev() {
                    if self.at(factor, row + 1, column) == T::zero() {
                        continue;
                    }
                    let turn = self.level(factor, row, column);
                    self.turn_columns(factor + 1, row, turn, n);
                    turns += 1;
                }
            }
            most = most.max(turns);
        }
        self.turns += most;
        for column in 0..n.saturating_sub(2) {
            for row in (column + 1..n - 1).rev() {
                let turn = self.level(last, row, column);
                self.pass(row, turn, n);
            }
        }
    }
}

impl Chain<f64> {
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
    /// A sweep without shift, which puts larger eigenvalues before smaller ones whatever is singular.
    fn sort(&mut self, low: usize, high: usize) {
        let last = self.count - 1;
        let level = |chain: &mut Self, factor: usize| -> Vec<PlaneRotation<Number>> {
            (low..high).map(|i| chain.level(factor, i, i)).collect()
        };
        let mut turns = level(self, last);
        for factor in 0..=last {
            for (i, turn) in (low..high).zip(&turns) {
                self.turn_columns(factor, i, *turn, i + 2);
            }
            if factor < last {
                turns = level(self, factor);
            }
        }
        self.turns += high - low;
    }

    /// A sweep with the shift of Wilkinson. False where that is so much larger than what begins the block that the sweep
    /// would do nothing.
    fn shifted(&mut self, low: usize, high: usize) -> bool {
        /// A shift may be this many times the first of the block.
        const MOST: f64 = 1e6;
        let last = self.count - 1;
        let mut first = Product::ONE;
        for factor in 0..last {
            first.times(self.at(factor, low, low));
        }
        let Some((shift, exponent)) = self.shift(low, high) else {
            return false;
        };
        let (begin, below) = (self.at(last, low, low), self.at(last, low + 1, low));
        let relative = times_power(shift / first.number, exponent - first.exponent);
        let most = MOST * (size(begin) + size(below));
        if !relative.norm().is_finite() || relative.norm() > most {
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

    /// That eigenvalue of the last two dimensions of the product of a block that is nearer to its last entry.
    fn shift(&self, low: usize, high: usize) -> Option<(Number, i64)> {
        let last = self.count - 1;
        let begin = high.saturating_sub(2).max(low);
        let wide = high + 1 - begin;
        let zero = Number::new(0.0, 0.0);
        let mut product = [[zero; 3]; 3];
        for (i, row) in product.iter_mut().enumerate() {
            row[i] = Number::new(1.0, 0.0);
        }
        let mut exponent = 0;
        for factor in 0..=last {
            let mut next = [[zero; 3]; 3];
            let mut largest = 0.0_f64;
            for (i, row) in next.iter_mut().enumerate().take(wide) {
                for (j, entry) in row.iter_mut().enumerate().take(wide) {
                    let terms = product.iter().enumerate().take(wide);
                    *entry = terms
                        .map(|(l, row)| self.at(factor, begin + i, begin + l) * row[j])
                        .sum();
                    largest = largest.max(size(*entry));
                }
            }
            if !(largest > 0.0 && largest.is_finite()) {
                return None;
            }
            let by = exponent_of(largest);
            exponent += by;
            product = next.map(|row| row.map(|entry| times_power(entry, -by)));
        }
        let (a, b) = (product[wide - 2][wide - 2], product[wide - 2][wide - 1]);
        let (c, d) = (product[wide - 1][wide - 2], product[wide - 1][wide - 1]);
        let half = (a - d) * 0.5;
        let root = (half * half + b * c).sqrt();
        let way = if (half.conj() * root).re >= 0.0 {
            half + root
        } else {
            half - root
        };
        // of x² − (a − d)x − bc the root of smaller modulus, without cancellation
        let off = if way.norm() > 0.0 { b * c / way } else { zero };
        Some((d - off, exponent))
    }

    /// The norm of a factor.
    fn norm(&self, factor: usize) -> f64 {
        let own = factor * self.n * self.n..(factor + 1) * self.n * self.n;
        let entries = self.entries[own].iter();
        entries.map(|one| one.norm_sqr()).sum::<f64>().sqrt()
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
            let mut low = high;
            while low > 0 {
                let below = size(self.at(last, low, low - 1));
                let beside = size(self.at(last, low, low)) + size(self.at(last, low - 1, low - 1));
                let least = if beside > 0.0 { beside } else { norm };
                if below <= f64::EPSILON * least || (low == high && sweeps >= MOST) {
                    if sweeps >= MOST {
                        left_out = left_out.max(below / norm);
                    }
                    self.set(last, low, low - 1, Number::new(0.0, 0.0));
                    break;
                }
                low -= 1;
            }
            if low == high {
                high -= 1;
                sweeps = 0;
                continue;
            }
            if all % PLAIN == 0 || !self.shifted(low, high) {
                self.sort(low, high);
            }
            sweeps += 1;
            all += 1;
        }
        if left_out.is_finite() {
            left_out
        } else {
            f64::INFINITY
        }
    }
}
