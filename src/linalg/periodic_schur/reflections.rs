//! The periodic Hessenberg-triangular form by reflections, each of which makes one column of a factor zero below a row and goes to
//! the columns of the next factor: what is still full there becomes triangular when its own column comes.

use super::chain::Chain;
use super::product::{exponent_of, times_power};

/// A reflection I − τvv* of the coordinates from one on; v begins with 1.
pub(super) struct Reflection {
    vector: Vec<f64>,
    by: f64,
    /// What a reflection of columns adds up.
    sum: Vec<f64>,
}

impl Reflection {
    fn of(n: usize) -> Reflection {
        Reflection {
            vector: Vec::with_capacity(n),
            by: 0.0,
            sum: vec![0.0; n],
        }
    }

    /// Becomes that which takes a vector to a multiple of its first coordinate, and takes it there.
    fn take(&mut self, column: &mut [f64]) {
        /// Between these squares are numbers.
        const RANGE: std::ops::Range<f64> = 1e-130..1e130;
        self.vector.clear();
        self.by = 0.0;
        let Some((first, rest)) = column.split_first_mut() else {
            return;
        };
        let largest = rest
            .iter()
            .fold(first.abs(), |most, entry| most.max(entry.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            rest.fill(0.0);
            return;
        }
        let power = if RANGE.contains(&largest) {
            0
        } else {
            exponent_of(largest)
        };
        let scaled = |entry: f64| match power {
            0 => entry,
            power => times_power(entry, -power),
        };
        self.vector.push(1.0);
        self.vector.extend(rest.iter().map(|entry| scaled(*entry)));
        let own = scaled(*first);
        let below = &self.vector[1..];
        let length = (own * own + dot(below, below)).sqrt();
        let end = -length.copysign(own);
        let unit = (own - end).recip();
        self.vector[1..].iter_mut().for_each(|entry| *entry *= unit);
        self.by = (end - own) / end;
        *first = times_power(end, power);
        rest.fill(0.0);
    }
}

/// A sum of products, as four sums, for which there are four places.
fn dot(left: &[f64], right: &[f64]) -> f64 {
    let (lefts, left_over) = left.as_chunks::<4>();
    let (rights, right_over) = right.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (left, right) in lefts.iter().zip(rights) {
        for (sum, (x, y)) in sums.iter_mut().zip(left.iter().zip(right)) {
            *sum += x * y;
        }
    }
    let [a, b, c, d] = sums;
    let over = left_over.iter().zip(right_over).map(|(x, y)| x * y);
    (a + c) + (b + d) + over.sum::<f64>()
}

impl Chain<f64> {
    /// The periodic Hessenberg-triangular form. A reflection of m coordinates counts as the m − 1 turns that it stands for.
    pub fn reduce(&mut self) {
        let (n, last) = (self.n, self.count - 1);
        let mut turns = vec![0; self.count];
        let mut reflection = Reflection::of(n);
        for column in 0..n - 1 {
            for (factor, turns) in turns.iter_mut().enumerate() {
                let row = column + usize::from(factor == last);
                let next = if factor == last { 0 } else { factor + 1 };
                let begin = (factor * n + column) * n;
                let own = &mut self.entries[begin + row..begin + n];
                if own.iter().skip(1).all(|entry| *entry == 0.0) {
                    continue;
                }
                *turns += n - 1 - row;
                if row + 2 == n {
                    let turn = self.level(factor, row, column);
                    self.turn_columns(next, row, turn, n);
                    continue;
                }
                reflection.take(own);
                self.reflect_rows(factor, row, &reflection, column + 1);
                self.reflect_columns(next, row, &mut reflection);
            }
        }
        self.turns += turns.into_iter().max().unwrap_or(0);
    }

    /// Reflects rows of a factor in its columns from one on.
    fn reflect_rows(&mut self, factor: usize, row: usize, reflection: &Reflection, from: usize) {
        let n = self.n;
        let Reflection { vector, by, .. } = reflection;
        for column in
            self.entries[(factor * n + from) * n..(factor + 1) * n * n].chunks_exact_mut(n)
        {
            let own = &mut column[row..];
            let sum = by * dot(vector, own);
            for (entry, v) in own.iter_mut().zip(vector) {
                *entry -= sum * v;
            }
        }
    }

    /// Reflects columns of a factor.
    fn reflect_columns(&mut self, factor: usize, column: usize, reflection: &mut Reflection) {
        let n = self.n;
        let Reflection { vector, by, sum } = reflection;
        let own = &mut self.entries[(factor * n + column) * n..(factor + 1) * n * n];
        sum.fill(0.0);
        for (column, v) in own.chunks_exact(n).zip(&*vector) {
            for (sum, entry) in sum.iter_mut().zip(column) {
                *sum += v * entry;
            }
        }
        for (column, v) in own.chunks_exact_mut(n).zip(&*vector) {
            let weight = *by * v;
            for (entry, sum) in column.iter_mut().zip(&*sum) {
                *entry -= weight * sum;
            }
        }
    }
}
