//! Sweeps in real arithmetic with two shifts at once, a conjugate pair or one that is real, which take a product apart into blocks
//! of one and two: Francis' double step for the periodic Hessenberg-triangular form (Kressner 2001).
//!
//! A reflection of three coordinates goes through all factors. In each it makes one column zero below the diagonal; the column
//! beside it keeps an entry there until the next reflection comes, the last of which is a turn of two.

use super::chain::{Chain, is_out_of_proportion, kept_in_range};
use super::product::{Number, times_power};

/// A reflection of three coordinates I − τvv*, v = (1, v₁, v₂), with τv.
#[derive(Clone, Copy)]
struct ThreeReflection {
    v: [f64; 2],
    by: [f64; 3],
}

impl ThreeReflection {
    const NONE: ThreeReflection = ThreeReflection {
        v: [0.0; 2],
        by: [0.0; 3],
    };

    /// That which takes a vector to a multiple of its first coordinate, and that multiple.
    fn onto_first([a, b, c]: [f64; 3]) -> (ThreeReflection, f64) {
        /// Between these, squares that are lost are nothing beside the sum.
        const RANGE: std::ops::Range<f64> = 1e-280..1e280;
        if b == 0.0 && c == 0.0 {
            return (ThreeReflection::NONE, a);
        }
        let square = a * a + b * b + c * c;
        let end = match RANGE.contains(&square) {
            true => -square.sqrt().copysign(a),
            false => -a.hypot(b).hypot(c).copysign(a),
        };
        let (unit, over) = ((a - end).recip(), end.recip());
        if !(unit.is_finite() && over.is_finite() && end.is_finite()) {
            return (ThreeReflection::NONE, a);
        }
        let reflection = ThreeReflection {
            v: [b * unit, c * unit],
            by: [(end - a) * over, -b * over, -c * over],
        };
        (reflection, end)
    }

    fn of(&self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        let sum = a + self.v[0] * b + self.v[1] * c;
        [
            a - self.by[0] * sum,
            b - self.by[1] * sum,
            c - self.by[2] * sum,
        ]
    }
}

/// Two shifts over a power of two: a conjugate pair, or one real shift twice.
#[derive(Clone, Copy)]
struct Shifts {
    re: f64,
    im: f64,
    exponent: i64,
}

impl Chain<f64> {
    /// Reflects rows of a factor, which are zero before a column, so that the lower two are zero there, too.
    fn level_three(&mut self, factor: usize, row: usize, column: usize) -> ThreeReflection {
        let n = self.n;
        let begin = (factor * n + column) * n;
        let own = &mut self.entries[begin..(factor + 1) * n * n];
        let Some(first) = own.get_mut(row..).and_then(|own| own.first_chunk_mut()) else {
            return ThreeReflection::NONE;
        };
        let (reflection, end) = ThreeReflection::onto_first(*first);
        *first = [end, 0.0, 0.0];
        self.reflect_three_rows(factor, row, reflection, column + 1);
        reflection
    }

    /// Reflects three rows of a factor in its columns from one on.
    fn reflect_three_rows(&mut self, factor: usize, row: usize, by: ThreeReflection, from: usize) {
        let n = self.n;
        let own = &mut self.entries[(factor * n + from) * n + row..(factor + 1) * n * n];
        for column in own.chunks_mut(n) {
            if let Some(entries) = column.first_chunk_mut() {
                *entries = by.of(*entries);
            }
        }
    }

    /// Reflects three columns of a factor, which are zero from a row on.
    fn reflect_three_columns(&mut self, factor: usize, i: usize, by: ThreeReflection, to: usize) {
        let n = self.n;
        let begin = (factor * n + i) * n;
        let (first, others) = self.entries[begin..begin + 3 * n].split_at_mut(n);
        let (second, third) = others.split_at_mut(n);
        let others = second[..to].iter_mut().zip(&mut third[..to]);
        for (a, (b, c)) in first[..to].iter_mut().zip(others) {
            [*a, *b, *c] = by.of([*a, *b, *c]);
        }
    }

    /// A reflection of rows of the last factor goes through all others to its columns, which are zero from a row on. It counts
    /// as the two turns that it stands for.
    fn pass_three(&mut self, i: usize, mut by: ThreeReflection, to: usize) {
        let last = self.count - 1;
        for factor in 0..last {
            self.reflect_three_columns(factor, i, by, i + 3);
            by = self.level_three(factor, i, i);
        }
        self.reflect_three_columns(last, i, by, to);
        self.turns += 2;
    }

    /// The first column of (P − s)(P − s̄), P the product over the first entry of all factors but the last. None where both
    /// shifts are so much larger than what begins the block that the sweep would do nothing.
    fn first_column(&self, low: usize, shifts: Shifts) -> Option<[f64; 3]> {
        let last = self.count - 1;
        let ([first, beside, second], exponent) = self.leading(low)?;
        let [re, im] = [shifts.re, shifts.im]
            .map(|part| times_power(part / first, shifts.exponent - exponent));
        let [beside, second] = [beside / first, second / first];
        let at = |row: usize, column: usize| self.at(last, low + row, low + column);
        let (begin, below) = (at(0, 0), at(1, 0));
        if is_out_of_proportion(Number::new(re, im), begin, below) {
            return None;
        }
        let next = [0, 1].map(|row| at(row, 0) * beside + at(row, 1) * second);
        let lowest = at(2, 1) * second;
        let parts = [begin - re, im, below, next[0], next[1] - re, lowest];
        let largest = parts
            .iter()
            .fold(0.0_f64, |most, part| most.max(part.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        let [own, im, below, beside, next, lowest] = parts.map(|part| part / largest);
        let column = [
            own * own + im * im + beside * below,
            below * (own + next),
            below * lowest,
        ];
        column.iter().any(|entry| *entry != 0.0).then_some(column)
    }

    /// The product of all factors but the last in two dimensions: its first row, and what else is not zero, over a power of two.
    fn leading(&self, low: usize) -> Option<([f64; 3], i64)> {
        let mut entries = [1.0, 0.0, 1.0];
        let mut exponent = 0;
        for factor in 0..self.count - 1 {
            let at = |row: usize, column: usize| self.at(factor, low + row, low + column);
            let [first, beside, second] = entries;
            entries = [
                at(0, 0) * first,
                at(0, 0) * beside + at(0, 1) * second,
                at(1, 1) * second,
            ];
            exponent += kept_in_range(&mut entries)?;
        }
        Some((entries, exponent))
    }

    /// A sweep with two shifts. False where they are out of proportion.
    fn shifted_twice(&mut self, low: usize, high: usize, shifts: Shifts) -> bool {
        let (n, last) = (self.n, self.count - 1);
        let Some(first) = self.first_column(low, shifts) else {
            return false;
        };
        let end = |i: usize| (i + 4).min(n);
        let (by, _) = ThreeReflection::onto_first(first);
        self.reflect_three_rows(last, low, by, low);
        self.pass_three(low, by, end(low));
        for row in low + 1..high - 1 {
            let by = self.level_three(last, row, row - 1);
            self.pass_three(row, by, end(row));
        }
        let turn = self.level(last, high - 1, high - 2);
        self.pass(high - 1, turn, end(high - 1));
        true
    }

    /// The eigenvalues of the last two dimensions of the product of a block: where these are real, twice that which is nearer to
    /// its last entry. Some that are none where sweeps do not come to an end, as with permutations.
    fn shifts(&self, low: usize, high: usize, is_stalled: bool) -> Option<Shifts> {
        let ([a, b, c, d], exponent) = self.trailing(low, high)?;
        let half = 0.5 * (a - d);
        let square = half * half + b * c;
        let (re, im) = if is_stalled {
            // the largest entry of the product is of order one
            (d + 0.75, 0.6)
        } else if square < 0.0 {
            (d + half, (-square).sqrt())
        } else {
            let way = half + square.sqrt().copysign(half);
            (d - if way == 0.0 { 0.0 } else { b * c / way }, 0.0)
        };
        Some(Shifts { re, im, exponent })
    }

    /// Takes the product apart into blocks of one, and of two with a conjugate pair, the places of which are told. What does not
    /// come to that is left as it is.
    pub fn take_apart(&mut self) -> Vec<usize> {
        /// Sweeps for one block: two to four are enough. Of all sweeps every so many are without shift, and of those for one
        /// block every so many are with shifts of no meaning.
        const MOST: usize = 60;
        const PLAIN: usize = 6;
        const STALLED: usize = 10;
        /// The same for a block of two, which has its shift at once: after one sweep without, which tells a small eigenvalue from
        /// the rounding of a large one.
        const MOST_OF_TWO: usize = 7;
        let norm = self.norm(self.count - 1);
        let mut pairs = Vec::new();
        // those of a block of more and of one of two
        let mut sweeps = [0; 2];
        let (mut high, mut all) = (self.n - 1, 0);
        while high > 0 {
            let low = self.begin_of_block(high, norm);
            let is_two = low + 1 == high;
            let (own, most) = match is_two {
                true => (&mut sweeps[1], MOST_OF_TWO),
                false => (&mut sweeps[0], MOST),
            };
            let is_stalled = !is_two && *own % STALLED == STALLED - 1;
            let is_plain = match is_two {
                true => *own == 0,
                false => all % PLAIN == 0 && !is_stalled,
            };
            let is_done = low == high || *own >= most;
            *own += 1;
            let shifts = match is_done {
                true => None,
                false => self.shifts(low, high, is_stalled),
            };
            let is_pair = is_two && shifts.is_some_and(|shifts| shifts.im != 0.0);
            if is_pair {
                pairs.push(low);
            }
            if is_done || is_pair {
                high = low.saturating_sub(1);
                sweeps = [0; 2];
                continue;
            }
            let is_swept = match shifts {
                Some(_) if is_plain => false,
                Some(shifts) if is_two => self.shifted(low, high, shifts.re, shifts.exponent),
                Some(shifts) => self.shifted_twice(low, high, shifts),
                None => false,
            };
            if !is_swept {
                self.sort(low, high);
            }
            all += 1;
        }
        pairs
    }
}
