//! Eigenvalues of a product of matrices from its factors, without the product.
//!
//! Unitary Q₀ … Q_K = Q₀ make every Q*ₖ₊₁AₖQₖ upper triangular, the periodic Schur form of Bojanczyk, Golub and Van
//! Dooren (1992): eigenvalues of A_K⋯A₁ are products of its diagonals. It is reached from the periodic
//! Hessenberg-triangular form by sweeps with and without a shift (Kressner 2001), every one of which is backward stable in
//! every factor: a product whose factors grow and shrink keeps its small eigenvalues as its large ones.
//!
//! Factors are real; the form is complex, and what is real or conjugate in it is told at the end. An eigenvalue has a bound of its own:
//! with periodic vectors Aₖxₖ = αₖxₖ₊₁ and y*ₖ₊₁Aₖ = αₖy*ₖ, y*ₖxₖ = 1, errors Eₖ of the factors move it by ∑ₖ y*ₖ₊₁Eₖxₖ ∏αₗ/αₖ.

use nalgebra::{Complex, ComplexField};

use super::Matrix;
use super::balance::acts;

type Number = Complex<f64>;

/// An eigenvalue z·2ᵉ: products of many factors leave the range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigenvalue {
    /// z, of modulus 1 to 2, or 0.
    pub mantissa: Number,
    /// e.
    pub exponent: i64,
    /// Natural logarithm of the radius of a disc about it that holds the eigenvalue of the product of the exact factors.
    pub log_error: f64,
}

/// z·2ᵉ without overflow on the way.
fn times_power(number: Number, exponent: i64) -> Number {
    let half = (exponent / 2).clamp(-1022, 1023);
    let rest = (exponent - half).clamp(-1022, 1023);
    let power = |exponent: i64| f64::from_bits(((exponent + 1023) as u64) << 52);
    number * power(half) * power(rest)
}

/// |x|: by its square, but where that leaves the range of numbers.
fn size<T: ComplexField<RealField = f64>>(number: T) -> f64 {
    const RANGE: std::ops::Range<f64> = 1e-280..1e280;
    let square = number.clone().modulus_squared();
    match RANGE.contains(&square) {
        true => square.sqrt(),
        false => number.modulus(),
    }
}

impl Eigenvalue {
    /// Its value, 0 or infinite where that is no number.
    pub fn value(&self) -> Number {
        times_power(self.mantissa, self.exponent)
    }

    /// Natural logarithm of its modulus.
    pub fn log_modulus(&self) -> f64 {
        self.mantissa.norm().ln() + self.exponent as f64 * std::f64::consts::LN_2
    }

    /// Radius of its disc.
    pub fn error(&self) -> f64 {
        self.log_error.exp()
    }

    fn new(number: Number, exponent: i64) -> Eigenvalue {
        let mut product = Product { number, exponent };
        product.normalise();
        Eigenvalue {
            mantissa: product.number,
            exponent: product.exponent,
            log_error: f64::NEG_INFINITY,
        }
    }
}

/// A number with an exponent of its own.
#[derive(Clone, Copy, Debug)]
struct Product {
    number: Number,
    exponent: i64,
}

impl Product {
    const ONE: Product = Product {
        number: Number::new(1.0, 0.0),
        exponent: 0,
    };

    fn normalise(&mut self) {
        let size = self.number.norm();
        if size > 0.0 && size.is_finite() {
            let by = exponent_of(size);
            self.number = times_power(self.number, -by);
            self.exponent += by;
        }
    }

    fn times(&mut self, factor: Number) {
        /// Between these a factor of any size leaves the product in the range of numbers.
        const RANGE: std::ops::Range<f64> = 1e-5..1e5;
        self.number *= factor;
        if !RANGE.contains(&self.number.l1_norm()) {
            self.normalise();
        }
    }

    fn log_modulus(&self) -> f64 {
        self.number.norm().ln() + self.exponent as f64 * std::f64::consts::LN_2
    }
}

/// The exponent of a positive number.
fn exponent_of(size: f64) -> i64 {
    match (size.to_bits() >> 52) as i64 & 0x7ff {
        0 => size.log2().floor() as i64,
        biased => biased - 1023,
    }
}

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

/// A factor of a product, and how many of its dimensions it takes away for reasons of its own.
#[derive(Clone, Debug)]
pub struct Factor {
    /// n×n.
    pub matrix: Matrix,
    /// n less its rank.
    pub lost: usize,
    /// Bound of the norm of its own error and of what rounding leaves, relative to that of the factor that it is a part of.
    pub error: f64,
    /// That norm.
    pub size: f64,
}

/// Factors of the same product in coordinates of what it leaves of a space, and the number of its eigenvalues that are
/// zero because of what its factors take away. No factor is taken for singular that does not say so.
pub fn regular_part(factors: Vec<Factor>) -> (Vec<Factor>, usize) {
    /// What of a subspace a singular factor takes away: the subspace is known to rounding times a condition.
    const NOTHING: f64 = 1e-11;
    let Some(n) = factors.first().map(|one| one.matrix.nrows()) else {
        return (factors, 0);
    };
    if factors.iter().all(|one| one.lost == 0) {
        return (factors, 0);
    }
    let mut basis = Matrix::identity(n, n);
    loop {
        let first = basis.clone();
        let mut left = Vec::with_capacity(factors.len());
        for factor in &factors {
            if basis.ncols() == 0 {
                return (Vec::new(), n);
            }
            let image = &factor.matrix * &basis;
            let (next, coordinates) = if factor.lost == 0 {
                let parts = image.qr();
                (parts.q(), parts.r())
            } else {
                let columns = image.ncols();
                let size = factor.size;
                let parts = image.col_piv_qr();
                let mut coordinates = parts.r();
                let small = |index: usize| match columns == n {
                    true => index + factor.lost >= n,
                    false => {
                        index + factor.lost >= columns
                            && coordinates[(index, index)].abs() <= NOTHING * size
                    }
                };
                let rank = (0..columns).find(|index| small(*index)).unwrap_or(columns);
                parts.p().inv_permute_columns(&mut coordinates);
                (
                    parts.q().columns(0, rank).into_owned(),
                    coordinates.rows(0, rank).into_owned(),
                )
            };
            left.push(Factor {
                matrix: coordinates,
                lost: 0,
                ..*factor
            });
            basis = next;
        }
        if basis.ncols() == first.ncols() {
            // the last basis in coordinates of the first: both span the same
            if let Some(last) = left.last_mut() {
                last.matrix = first.tr_mul(&basis) * &last.matrix;
            }
            return (left, n - basis.ncols());
        }
    }
}

/// A rotation [c s; −s̄ c] of two coordinates.
#[derive(Clone, Copy, Debug)]
struct Turn<T> {
    c: f64,
    s: T,
}

impl<T: ComplexField<RealField = f64> + Copy> Turn<T> {
    /// That which takes (a, b) to (r, 0).
    fn onto_first(a: T, b: T) -> Turn<T> {
        let (first, other) = (size(a), size(b));
        let length = size(Number::new(first, other));
        if other == 0.0 || !length.is_finite() {
            return Turn {
                c: 1.0,
                s: T::zero(),
            };
        }
        let unit = if first == 0.0 {
            T::one()
        } else {
            a.unscale(first)
        };
        Turn {
            c: first / length,
            s: unit * b.conjugate().unscale(length),
        }
    }
}

/// The factors, columns of one after those of the other, the first first; and how often they were turned.
struct Chain<T> {
    n: usize,
    count: usize,
    entries: Vec<T>,
    turns: usize,
}

impl<T: ComplexField<RealField = f64> + Copy> Chain<T> {
    fn at(&self, factor: usize, row: usize, column: usize) -> T {
        self.entries[(factor * self.n + column) * self.n + row]
    }

    fn set(&mut self, factor: usize, row: usize, column: usize, value: T) {
        self.entries[(factor * self.n + column) * self.n + row] = value;
    }

    /// Turns rows i and i + 1 of a factor, which are zero before a column.
    fn turn_rows(&mut self, factor: usize, i: usize, turn: Turn<T>, from: usize) {
        let n = self.n;
        let Turn { c, s } = turn;
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
    fn turn_columns(&mut self, factor: usize, i: usize, turn: Turn<T>, to: usize) {
        let n = self.n;
        let Turn { c, s } = turn;
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
    fn level(&mut self, factor: usize, row: usize, column: usize) -> Turn<T> {
        let turn = Turn::onto_first(
            self.at(factor, row, column),
            self.at(factor, row + 1, column),
        );
        self.turn_rows(factor, row, turn, column);
        self.set(factor, row + 1, column, T::zero());
        turn
    }

    /// A turn of rows of the last factor goes through all others, which stay triangular, to its columns, which are zero
    /// from a row on.
    fn pass(&mut self, i: usize, mut turn: Turn<T>, to: usize) {
        let last = self.count - 1;
        for factor in 0..last {
            self.turn_columns(factor, i, turn, i + 2);
            turn = self.level(factor, i, i);
        }
        self.turn_columns(last, i, turn, to);
        self.turns += 1;
    }

    /// The periodic Hessenberg-triangular form.
    fn reduce(&mut self) {
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
    fn complex(&self) -> Chain<Number> {
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
        let level = |chain: &mut Self, factor: usize| -> Vec<Turn<Number>> {
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
        let turn = Turn::onto_first(begin - relative, below);
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
    fn triangularise(&mut self) -> f64 {
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

    /// A diagonal of all factors.
    fn diagonal(&self, j: usize) -> Vec<Number> {
        (0..self.count)
            .map(|factor| self.at(factor, j, j))
            .collect()
    }

    /// Norms of the periodic right vectors of the eigenvalue j, whose own component is 1, and of the left ones, before every
    /// factor.
    fn vectors(&self, j: usize, logs: &[f64], diagonals: &Diagonals) -> [Vec<f64>; 2] {
        let (n, count) = (self.n, self.count);
        let (zero, one) = (Number::new(0.0, 0.0), Number::new(1.0, 0.0));
        let Diagonals { forward, backward } = diagonals;
        // components of one index together; before they are known, what the others add to them
        let mut right = vec![zero; (j + 1) * count];
        for l in (0..=j).rev() {
            let (before, own) = right.split_at_mut(l * count);
            let own = &mut own[..count];
            match l == j {
                true => own.fill(one),
                false => cyclic([&forward[l], &forward[j]], own, logs[l] - logs[j]),
            }
            for (k, by) in own.iter().enumerate() {
                let begin = (k * n + l) * n;
                let column = &self.entries[begin..begin + l];
                let places = before.iter_mut().skip(k).step_by(count);
                places
                    .zip(column)
                    .for_each(|(place, entry)| *place += entry * by);
            }
        }
        // row vectors go the other way round: that before factor k follows from that after it, and has place count − k
        let mut left = vec![zero; (n - j) * count];
        left[..count].fill(one);
        for i in j + 1..n {
            let (before, own) = left.split_at_mut((i - j) * count);
            let own = &mut own[..count];
            for (m, sum) in own.iter_mut().enumerate() {
                let begin = ((count - 1 - m) * n + i) * n;
                let column = &self.entries[begin + j..begin + i];
                let known = before.iter().skip(m).step_by(count);
                *sum = known.zip(column).map(|(one, entry)| one * entry).sum();
            }
            cyclic([&backward[i], &backward[j]], own, logs[i] - logs[j]);
        }
        let norms = |all: &[Number], place: &dyn Fn(usize) -> usize| {
            let length = |k: usize| {
                let components = all.iter().skip(place(k)).step_by(count);
                components.map(|one| one.norm_sqr()).sum::<f64>().sqrt()
            };
            (0..count).map(length).collect()
        };
        [
            norms(&right, &|k| k),
            norms(&left, &|k| (count - k) % count),
        ]
    }
}

/// The diagonals of all factors, those of one index together.
struct Diagonals {
    /// Those of the first factor first.
    forward: Vec<Vec<Number>>,
    /// Those of the last factor first.
    backward: Vec<Vec<Number>>,
}

impl Diagonals {
    fn of(chain: &Chain<Number>) -> Diagonals {
        let forward: Vec<Vec<Number>> = (0..chain.n).map(|j| chain.diagonal(j)).collect();
        let back = |list: &Vec<Number>| list.iter().rev().copied().collect();
        Diagonals {
            backward: forward.iter().map(back).collect(),
            forward,
        }
    }
}

/// In place of the numbers bₖ those uₖ with dₖuₖ₊₁ = aₖuₖ + bₖ that come back to the first, a and d the diagonals of two
/// indices as the factors are gone through; `ratio` is the logarithm of |∏aₖ/dₖ|.
fn cyclic([a, d]: [&[Number]; 2], numbers: &mut [Number], ratio: f64) {
    let (count, zero) = (a.len(), Number::new(0.0, 0.0));
    if ratio.is_nan() {
        // both are zero: what they have in common is none of their condition
        numbers.fill(zero);
        return;
    }
    // the way on which they shrink: u becomes (gain)u + (what is added)
    let forward = ratio <= 0.0;
    let place = |step: usize| if forward { step } else { count - 1 - step };
    let gain = |k: usize| if forward { a[k] / d[k] } else { d[k] / a[k] };
    let mut once = zero;
    let mut product = Product::ONE;
    for k in (0..count).map(place) {
        let by = gain(k);
        numbers[k] = if forward {
            numbers[k] / d[k]
        } else {
            -numbers[k] / a[k]
        };
        once = by * once + numbers[k];
        product.times(by);
    }
    let around = times_power(product.number, product.exponent);
    let mut apart = Number::new(1.0, 0.0) - around;
    // eigenvalues are not told apart by less than their rounding
    let least = f64::EPSILON * count as f64;
    if size(apart) < least {
        apart = Number::new(least, 0.0);
    }
    let mut u = once / apart;
    for k in (0..count).map(place) {
        let next = gain(k) * u + numbers[k];
        numbers[k] = if forward { u } else { next };
        u = next;
    }
}

/// The factors in their order round, the last of which is the one that is least triangular: it need not become so at first.
fn begun_after_the_fullest(factors: &[Factor], n: usize) -> Vec<&Factor> {
    let below = |one: &Factor| {
        let column = |j: usize| {
            let column = one.matrix.column(j);
            let below = column.iter().skip(j + 1);
            below.filter(|x| **x != 0.0).count()
        };
        (0..n).map(column).sum::<usize>()
    };
    let full = (0..factors.len()).max_by_key(|index| below(&factors[*index]));
    let first = full.map_or(0, |full| full + 1);
    let round = factors.iter().cycle().skip(first);
    round.take(factors.len()).collect()
}

/// Eigenvalues of the product of square factors, the first of which acts first; the largest first, of a conjugate pair
/// that above the real axis. Those of no factor or of no dimension are none.
pub fn eigenvalues(factors: &[Factor]) -> Vec<Eigenvalue> {
    /// What a turn leaves in a factor relative to its norm.
    const TURN: f64 = 2.0 * f64::EPSILON;
    let Some(n) = factors
        .first()
        .map(|one| one.matrix.nrows())
        .filter(|n| *n > 0)
    else {
        return Vec::new();
    };
    let factors = begun_after_the_fullest(factors, n);
    let mut real = Chain {
        n,
        count: factors.len(),
        entries: factors
            .iter()
            .flat_map(|one| one.matrix.iter())
            .copied()
            .collect(),
        turns: 0,
    };
    if n > 1 {
        real.reduce();
    }
    let mut chain = real.complex();
    let left_out = chain.triangularise();
    let errors: Vec<f64> = factors
        .iter()
        .enumerate()
        .map(|(index, factor)| {
            let last = if index + 1 == chain.count {
                left_out
            } else {
                0.0
            };
            factor.size * (factor.error + last + TURN * chain.turns as f64)
        })
        .collect();
    let diagonals = Diagonals::of(&chain);
    let own = &diagonals.forward;
    let products: Vec<Product> = own
        .iter()
        .map(|diagonal| {
            let mut product = Product::ONE;
            diagonal.iter().for_each(|entry| product.times(*entry));
            product
        })
        .collect();
    let logs: Vec<f64> = products.iter().map(Product::log_modulus).collect();
    let all: Vec<Eigenvalue> = (0..n)
        .map(|j| {
            let [right, left] = chain.vectors(j, &logs, &diagonals);
            let moved = |k: usize| errors[k] * right[k] * left[(k + 1) % chain.count];
            let log_error = radius(&own[j], moved);
            let Product { number, exponent } = products[j];
            Eigenvalue {
                log_error,
                ..Eigenvalue::new(number, exponent)
            }
        })
        .collect();
    let all = bounded(&chain, &errors, all);
    ordered(resolved(all))
}

/// The logarithm of ∏(|αₖ| + δₖ) − ∏|αₖ|.
fn radius(diagonal: &[Number], moved: impl Fn(usize) -> f64) -> f64 {
    let (mut log, mut growth) = (0.0, 0.0);
    for (k, entry) in diagonal.iter().enumerate() {
        let (size, by) = (entry.norm(), moved(k));
        let sum = size + by;
        if sum.is_nan() {
            return f64::INFINITY;
        }
        log += sum.ln();
        growth += (by / size).ln_1p();
    }
    // ∏(|α| + δ)·(1 − 1/∏(1 + δ/|α|))
    if growth.is_nan() {
        return log;
    }
    log + (-(-growth).exp_m1()).ln()
}

/// Where eigenvalues are so near to one another that those of their vectors tell nothing, the norms of the factors in graded
/// units bound them all: where they are very small, by what is very small, too.
fn bounded(chain: &Chain<Number>, errors: &[f64], mut all: Vec<Eigenvalue>) -> Vec<Eigenvalue> {
    /// Units of one component in those of the one before.
    const GRADES: [f64; 9] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
    let told = |one: &Eigenvalue| one.log_error < one.log_modulus();
    if all.iter().all(told) {
        return all;
    }
    let n = chain.n;
    let norm = |factor: usize, grade: f64| {
        let sum = |row: usize| -> f64 {
            let entry = |column: usize| {
                let own = chain.at(factor, row, column).norm() + errors[factor];
                own * grade.powi(column as i32 - row as i32)
            };
            (0..n).map(entry).sum()
        };
        (0..n).map(sum).fold(0.0, f64::max)
    };
    let log = |grade: f64| -> f64 { (0..chain.count).map(|k| norm(k, grade).ln()).sum() };
    let least = GRADES.into_iter().map(log).fold(f64::INFINITY, f64::min);
    for one in all.iter_mut().filter(|one| !told(one)) {
        // a disc about the eigenvalue that holds the one about 0
        one.log_error = one.log_error.min(least + std::f64::consts::LN_2);
    }
    all
}

/// Eigenvalues of a real product are real or come in pairs: what rounding made of that is undone. Two that may be
/// conjugate are those of a real matrix of two dimensions with their trace and determinant.
fn resolved(mut all: Vec<Eigenvalue>) -> Vec<Eigenvalue> {
    let mut found = Vec::with_capacity(all.len());
    let off_axis =
        |one: &Eigenvalue| one.mantissa.im.abs() / one.mantissa.norm().max(f64::MIN_POSITIVE);
    while !all.is_empty() {
        let order =
            |one: &usize, other: &usize| off_axis(&all[*one]).total_cmp(&off_axis(&all[*other]));
        let Some(index) = (0..all.len()).max_by(order) else {
            break;
        };
        let one = all.swap_remove(index);
        // in units of this one
        let unit = one.exponent;
        let of = |other: &Eigenvalue| times_power(other.mantissa, other.exponent - unit);
        let error =
            |other: &Eigenvalue| (other.log_error - unit as f64 * std::f64::consts::LN_2).exp();
        let off = |other: &usize| (of(&all[*other]) - one.mantissa.conj()).norm();
        let nearest = (0..all.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        let is_real = one.mantissa.im.abs() <= error(&one);
        let pair = nearest.filter(|other| {
            one.mantissa.im != 0.0 && (!is_real || off(other) <= error(&one) + error(&all[*other]))
        });
        let Some(other) = pair else {
            let real = Number::new(one.mantissa.re, 0.0);
            found.push(Eigenvalue {
                log_error: one.log_error,
                ..Eigenvalue::new(real, unit)
            });
            continue;
        };
        let other = all.swap_remove(other);
        let (z, w) = (one.mantissa, of(&other));
        let middle = 0.5 * (z.re + w.re);
        let half = (z - w) * 0.5;
        let square = (half * half).re;
        let by = square.abs().sqrt();
        let values = if square < 0.0 {
            [Number::new(middle, by), Number::new(middle, -by)]
        } else {
            [Number::new(middle + by, 0.0), Number::new(middle - by, 0.0)]
        };
        let log_error = one.log_error.max(other.log_error);
        found.extend(values.map(|value| Eigenvalue {
            log_error,
            ..Eigenvalue::new(value, unit)
        }));
    }
    found
}

/// The largest first; of a pair that above the axis.
fn ordered(mut all: Vec<Eigenvalue>) -> Vec<Eigenvalue> {
    let key = |one: &Eigenvalue| one.log_modulus();
    all.sort_by(|one, other| {
        key(other)
            .total_cmp(&key(one))
            .then(one.mantissa.re.total_cmp(&other.mantissa.re))
            .then(one.mantissa.im.abs().total_cmp(&other.mantissa.im.abs()))
            .then(other.mantissa.im.total_cmp(&one.mantissa.im))
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between −1 and 1, the same every time.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn matrix(&mut self, n: usize) -> Matrix {
            Matrix::from_fn(n, n, |_, _| self.next())
        }

        fn orthogonal(&mut self, n: usize) -> Matrix {
            self.matrix(n).qr().q()
        }
    }

    fn factors(matrices: Vec<Matrix>) -> Vec<Factor> {
        let factor = |matrix: Matrix| Factor {
            size: matrix.norm(),
            matrix,
            lost: 0,
            error: f64::EPSILON,
        };
        matrices.into_iter().map(factor).collect()
    }

    /// Triangular factors, with blocks of two where a pair is wanted, in other orthonormal coordinates.
    fn planted(triangular: &[Matrix], numbers: &mut Numbers) -> Vec<Matrix> {
        let n = triangular[0].nrows();
        let bases: Vec<Matrix> = triangular.iter().map(|_| numbers.orthogonal(n)).collect();
        let turned = triangular.iter().enumerate().map(|(k, one)| {
            let next = &bases[(k + 1) % bases.len()];
            next * one * bases[k].transpose()
        });
        turned.collect()
    }

    /// Every eigenvalue is one of those expected, by logarithm of its modulus and by its argument, within its own error and
    /// within `allowed` of its size.
    fn compare(found: &[Eigenvalue], expected: &[(f64, f64)], allowed: f64) {
        assert_eq!(found.len(), expected.len());
        let mut left = expected.to_vec();
        for one in found {
            let off = |(log, argument): &(f64, f64)| {
                let ratio = Number::from_polar(
                    (log - one.log_modulus()).exp(),
                    argument - one.mantissa.arg(),
                );
                (ratio - 1.0).norm()
            };
            let nearest = (0..left.len()).min_by(|a, b| off(&left[*a]).total_cmp(&off(&left[*b])));
            let truth = left.swap_remove(nearest.unwrap());
            let error = off(&truth);
            let own = (one.log_error - one.log_modulus()).exp();
            assert!(error <= own, "{one:?}: off by {error:e}, told {own:e}");
            assert!(own <= allowed, "{one:?}: told {own:e}");
        }
    }

    /// Diagonals that grow and shrink in turn by 1e3: in the product, whose eigenvalues are of order one, they would be
    /// lost in 1e-16 times the norms
    /// of all eight factors, 1e24.
    #[test]
    fn eigenvalues_of_a_product_whose_factors_grow_and_shrink() {
        let mut numbers = Numbers(1);
        for n in 1..=6 {
            let count = 8;
            let mut logs = vec![0.0; n];
            let triangular: Vec<Matrix> = (0..count)
                .map(|k| {
                    let mut one = numbers.matrix(n).upper_triangle() * 1e-3;
                    for j in 0..n {
                        let size = if (j + k) % 2 == 0 { 1e3 } else { 1e-3 };
                        // moduli that differ by a third at least
                        one[(j, j)] = size * if k == 0 { 1.0 + 0.4 * j as f64 } else { 1.0 };
                        logs[j] += f64::ln(one[(j, j)]);
                    }
                    one
                })
                .collect();
            let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
            let expected: Vec<(f64, f64)> = logs.into_iter().map(|log| (log, 0.0)).collect();
            // some hundred turns leave 4e-14 of its norm in a factor, 1e3, beside whose least diagonal, 1e-3, that is 4e-8;
            // eight factors, and vectors of lengths of a few
            compare(&found, &expected, 1e-5);
        }
    }

    /// Multipliers from e⁻²⁰⁰⁰ to e²⁰⁰⁰, which are no numbers, beside some of order one.
    #[test]
    fn a_long_product_leaves_the_range_of_numbers() {
        let mut numbers = Numbers(2);
        let (n, count) = (5, 200);
        let rates = [10.0, 0.004, -0.002, -0.9, -10.0_f64];
        let triangular: Vec<Matrix> = (0..count)
            .map(|_| {
                let mut one = numbers.matrix(n).upper_triangle();
                one.set_diagonal(&crate::linalg::Vector::from_iterator(
                    n,
                    rates.iter().map(|rate| rate.exp()),
                ));
                for i in 0..n {
                    for j in i + 1..n {
                        one[(i, j)] *= rates[j].exp();
                    }
                }
                one
            })
            .collect();
        let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
        assert_eq!(found.len(), n);
        for (one, rate) in found.iter().zip(rates) {
            let log = count as f64 * rate;
            let off = one.log_modulus() - log;
            assert!(one.mantissa.im == 0.0 && one.mantissa.re > 0.0);
            // a factor of size e¹⁰ is known to 1e-16 of that: what it shrinks by more is rounding
            if rate >= -0.002 {
                assert!(off.abs() <= (one.log_error - log).exp(), "{off:e}");
                assert!((one.log_error - log).exp() < 1e-4);
            } else {
                assert!(one.log_error < -0.8 * 200.0, "{one:?}");
            }
        }
    }

    /// Two pairs of one modulus, and −0.5 twice beside 0.5: what pairs eigenvalues by their modulus mixes them up.
    #[test]
    fn equal_moduli_stay_apart() {
        let mut numbers = Numbers(3);
        for (n, allowed) in [(4, 1e-12), (7, 1e-12)] {
            let count = 6;
            let mut first = Matrix::zeros(n, n);
            for (place, angle) in [(0, 0.3_f64), (2, 2.1)] {
                let turn = [angle.cos(), angle.sin(), -angle.sin(), angle.cos()].map(|x| 0.8 * x);
                for (index, entry) in turn.into_iter().enumerate() {
                    first[(place + index % 2, place + index / 2)] = entry;
                }
            }
            let mut expected: Vec<(f64, f64)> = [0.3, -0.3, 2.1, -2.1]
                .map(|angle| (0.8_f64.ln(), angle))
                .to_vec();
            for (place, value) in [0.8_f64, -0.8, -0.8].into_iter().enumerate() {
                if 4 + place < n {
                    first[(4 + place, 4 + place)] = value;
                    let argument = if value < 0.0 {
                        std::f64::consts::PI
                    } else {
                        0.0
                    };
                    expected.push((0.8_f64.ln(), argument));
                }
            }
            let mut triangular = vec![Matrix::identity(n, n); count];
            triangular[0] = first;
            let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
            compare(&found, &expected, allowed);
            let real = found.iter().filter(|one| one.mantissa.im == 0.0).count();
            assert_eq!(real, n - 4);
        }
    }

    /// How many times an error of the factors relative to their norms is at most in an eigenvalue λ of their product P: with
    /// Px = λx, y*P = λy*, y*x = 1 this is ∑ ‖Aₖ‖‖Aₖ₋₁⋯A₁x‖‖y*A_K⋯Aₖ₊₁‖.
    fn condition(all: &[Matrix], value: Number) -> f64 {
        let all: Vec<_> = all
            .iter()
            .map(|one| one.map(|x| Number::new(x, 0.0)))
            .collect();
        let n = all[0].nrows();
        let identity = || nalgebra::DMatrix::<Number>::identity(n, n);
        let product = all.iter().fold(identity(), |product, one| one * product);
        // inverse iteration beside it
        let shifted = product - identity() * (value * (1.0 + 1e-9));
        let vector = |matrix: nalgebra::DMatrix<Number>| {
            let factors = matrix.lu();
            let mut vector = nalgebra::DVector::from_element(n, Number::new(1.0, 0.0));
            for _ in 0..3 {
                vector = factors.solve(&vector).unwrap().normalize();
            }
            vector
        };
        let (mut right, left) = (vector(shifted.clone()), vector(shifted.adjoint()));
        let mut lefts = vec![left.unscale(left.dotc(&right).norm())];
        for one in all.iter().skip(1).rev() {
            let next = one.adjoint() * &lefts[lefts.len() - 1];
            lefts.push(next);
        }
        let mut sum = 0.0;
        for (one, left) in all.iter().zip(lefts.iter().rev()) {
            sum += one.norm() * right.norm() * left.norm();
            right = one * right;
        }
        sum
    }

    /// In units that differ by up to 1e18 a product has the same eigenvalues within their bounds. These are no larger than
    /// what turns, of 2ε in every factor each, make of the condition: of four dimensions nine turns reduce a product, and some
    /// ten sweeps of three do the rest. Powers of two bring the units back to within two in each of two states, so that norms
    /// are up to four times as large, and products of left and right vectors, too; what goes one way becomes small at most.
    #[test]
    fn balancing_undoes_bad_units() {
        const LEFT: f64 = 4.0;
        const TURNS: f64 = 40.0;
        let mut numbers = Numbers(4);
        let n = 4;
        let all: Vec<Matrix> = (0..6).map(|_| numbers.matrix(n)).collect();
        let compare_in_units = |all: &[Matrix], truth: &[Eigenvalue], units: [f64; 4]| {
            let other: Vec<Matrix> = all
                .iter()
                .map(|one| Matrix::from_fn(n, n, |i, j| one[(i, j)] * units[j] / units[i]))
                .collect();
            let scales = balance(&other.iter().collect::<Vec<_>>());
            let found = eigenvalues(&factors(balanced(&other, &scales)));
            for (one, other) in found.iter().zip(truth) {
                let off = (one.value() - other.value()).norm();
                assert!(off <= one.error() + other.error(), "{units:?}: {off:e}");
                let allowed = 2.0 * TURNS * f64::EPSILON * condition(all, other.value());
                assert!(other.error() <= allowed, "{other:?}, {allowed:e}");
                let allowed = LEFT * LEFT * allowed;
                assert!(one.error() <= allowed, "{units:?}: {one:?}, {allowed:e}");
            }
            scales
        };
        let truth = eigenvalues(&factors(all.clone()));
        for k in -9..=9 {
            let unit = 10.0_f64.powi(k);
            let units = [1.0, unit, 1.0, unit.recip()];
            let scales = compare_in_units(&all, &truth, units);
            let left = || scales.iter().zip(units).map(|(scale, unit)| scale * unit);
            let [least, most] = [
                left().fold(f64::INFINITY, f64::min),
                left().fold(0.0, f64::max),
            ];
            assert!(most <= LEFT * least, "{units:?}: {scales:?}");
            // a state that acts on the others and on which none acts, or the other way round
            for transposed in [false, true] {
                let one_way = |one: &Matrix| {
                    let mut one = one.clone();
                    (0..n).filter(|j| *j != 1).for_each(|j| one[(1, j)] = 0.0);
                    if transposed { one.transpose() } else { one }
                };
                let all: Vec<Matrix> = all.iter().map(one_way).collect();
                let truth = eigenvalues(&factors(all.clone()));
                compare_in_units(&all, &truth, [1.0, unit, 1.0, 1.0]);
            }
        }
    }

    fn balanced(all: &[Matrix], scales: &[f64]) -> Vec<Matrix> {
        let one = |one: &Matrix| {
            Matrix::from_fn(one.nrows(), one.ncols(), |i, j| {
                one[(i, j)] * scales[j] / scales[i]
            })
        };
        all.iter().map(one).collect()
    }

    /// One state is 1e10 times as large in the middle of a product as at its ends. In the units of its ends its rounding would be
    /// 1e-6 of the rest; in units of its own the product is one of factors of order one, and the bounds are theirs.
    #[test]
    fn what_grows_and_shrinks_again_leaves_no_rounding() {
        let mut numbers = Numbers(8);
        let n = 3;
        let all: Vec<Matrix> = (0..2).map(|_| numbers.matrix(n)).collect();
        let truth = eigenvalues(&factors(all.clone()));
        let large = |i: usize| if i == 1 { 1e10 } else { 1.0 };
        let first = Matrix::from_fn(n, n, |i, j| all[0][(i, j)] * large(i));
        let second = Matrix::from_fn(n, n, |i, j| all[1][(i, j)] / large(j));
        let steep = [&first, &second];
        let units = units_along(&steep);
        let in_units: Vec<Matrix> = (0..2)
            .map(|k| {
                let (begin, end) = (&units[k], &units[(k + 1) % 2]);
                Matrix::from_fn(n, n, |i, j| steep[k][(i, j)] * begin[j] / end[i])
            })
            .collect();
        for (one, other) in eigenvalues(&factors(in_units)).iter().zip(&truth) {
            let off = (one.value() - other.value()).norm();
            assert!(off <= one.error() + other.error(), "{off:e}");
            assert!(one.error() <= 1e2 * other.error(), "{one:?}, {other:?}");
        }
        assert_eq!(units_along(&[&all[0], &all[1]]), vec![vec![1.0; n]; 2]);
    }

    /// A projection along what another one leaves takes a second dimension away, one along the same direction does not;
    /// what is left is exact.
    #[test]
    fn what_singular_factors_take_away_is_exactly_zero() {
        let mut numbers = Numbers(5);
        let n = 4;
        let project = |normal: usize, along: &Matrix| {
            let mut one = Matrix::identity(n, n);
            for i in 0..n {
                one[(i, normal)] -= along[(i, 0)] / along[(normal, 0)];
            }
            one
        };
        let along = numbers.matrix(n).columns(0, 1).into_owned();
        let flow = numbers.matrix(n);
        let of = |matrices: Vec<(Matrix, usize)>| {
            let all = matrices.into_iter().map(|(matrix, lost)| Factor {
                size: matrix.norm(),
                matrix,
                lost,
                error: f64::EPSILON,
            });
            let (left, zeros) = regular_part(all.collect());
            (eigenvalues(&left), zeros)
        };
        let once = of(vec![(project(0, &along), 1), (flow.clone(), 0)]);
        assert_eq!((once.1, once.0.len()), (1, 3));
        let twice = of(vec![
            (project(0, &along), 1),
            (Matrix::identity(n, n), 0),
            (project(0, &along), 1),
            (flow.clone(), 0),
        ]);
        assert_eq!(twice.1, 1);
        for (one, other) in once.0.iter().zip(&twice.0) {
            assert!((one.value() - other.value()).norm() <= one.error() + other.error());
        }
        // a direction in what the first one leaves
        let other = &flow * project(0, &along) * numbers.matrix(n).columns(0, 1);
        let both = of(vec![
            (project(0, &along), 1),
            (flow.clone(), 0),
            (project(1, &other), 1),
        ]);
        assert_eq!((both.1, both.0.len()), (2, 2));
        // the trace of the product is the sum of what is left
        let product = project(1, &other) * &flow * project(0, &along);
        let sum: Number = both.0.iter().map(Eigenvalue::value).sum();
        assert!((sum.re - product.trace()).abs() < 1e-13 && sum.im == 0.0);
    }

    /// A Jordan block is known to the square root of rounding, and says so.
    #[test]
    fn a_defective_eigenvalue_tells_its_error() {
        let mut numbers = Numbers(6);
        let block = Matrix::from_row_slice(2, 2, &[-1.0, 1.0, 0.0, -1.0]);
        let triangular = [block, Matrix::identity(2, 2), Matrix::identity(2, 2)];
        let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
        for one in found {
            let off = (one.value() + 1.0).norm();
            assert!(
                off <= one.error() && one.error() < 1e-5 && one.error() > 1e-9,
                "{one:?}"
            );
        }
    }

    /// Factors that shrink by more than rounding say no more than that.
    #[test]
    fn what_vanishes_is_small_and_no_error_of_order_one() {
        let mut numbers = Numbers(7);
        let n = 3;
        let mut one = numbers.matrix(n).upper_triangle();
        one.set_diagonal(&crate::linalg::Vector::from_vec(vec![0.5, 1e-19, 1e-20]));
        let triangular = vec![one; 4];
        let found = eigenvalues(&factors(planted(&triangular, &mut numbers)));
        assert!((found[0].value() - 0.0625).norm() <= found[0].error() && found[0].error() < 1e-12);
        for one in &found[1..] {
            assert!(one.value().norm() + one.error() < 1e-6, "{one:?}");
        }
    }
}
