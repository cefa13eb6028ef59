//! Periodic vectors of the eigenvalues: Aₖxₖ = αₖxₖ₊₁ from the right, y*ₖ₊₁Aₖ = αₖy*ₖ from the left. Their norms say how far an
//! error of a factor moves an eigenvalue.

use super::chain::Chain;
use super::product::{Product, Scalar, size, times_power};

impl<T: Scalar> Chain<T> {
    /// A diagonal of all factors.
    fn diagonal(&self, j: usize) -> Vec<T> {
        (0..self.count)
            .map(|factor| self.at(factor, j, j))
            .collect()
    }

    /// Norms of the periodic right vectors of the eigenvalue j, whose own component is 1, before every factor, and of the left
    /// ones after it.
    pub(super) fn vectors(&self, j: usize, diagonals: &Diagonals<T>) -> [Vec<f64>; 2] {
        let all = [
            self.right_vectors(j, diagonals),
            self.left_vectors(j, diagonals),
        ];
        all.map(|all| {
            let vectors = all.chunks_exact(all.len() / self.count);
            let square = |vector: &[T]| vector.iter().map(|one| one.modulus_squared()).sum::<f64>();
            vectors.map(|vector| square(vector).sqrt()).collect()
        })
    }

    /// The right vectors, components of one before every factor together.
    fn right_vectors(&self, j: usize, diagonals: &Diagonals<T>) -> Vec<T> {
        let (n, long) = (self.n, j + 1);
        // before a component is known, what the others add to it
        let mut right = vec![T::zero(); long * self.count];
        let mut own = vec![T::one(); self.count];
        let mut cyclic = Cyclic::new(self.count);
        for l in (0..=j).rev() {
            if l < j {
                let sums = right.iter().skip(l).step_by(long);
                own.iter_mut().zip(sums).for_each(|(own, sum)| *own = *sum);
                cyclic.solve(diagonals, [l, j], true, &mut own);
            }
            let columns = self.entries.chunks_exact(n).skip(l).step_by(n);
            let vectors = right.chunks_exact_mut(long);
            for ((vector, column), by) in vectors.zip(columns).zip(&own) {
                let places = vector.iter_mut().zip(column).take(l);
                places.for_each(|(place, entry)| *place += *entry * *by);
                vector[l] = *by;
            }
        }
        right
    }

    /// The left vectors, components of one after every factor together. They go the other way round: that before a factor follows
    /// from that after it.
    fn left_vectors(&self, j: usize, diagonals: &Diagonals<T>) -> Vec<T> {
        let (n, long) = (self.n, self.n - j);
        let mut left = vec![T::zero(); long * self.count];
        left.iter_mut()
            .step_by(long)
            .for_each(|one| *one = T::one());
        let mut own = vec![T::zero(); self.count];
        let mut cyclic = Cyclic::new(self.count);
        for i in j + 1..n {
            let factors = self.entries.chunks_exact(n * n);
            let vectors = left.chunks_exact(long);
            for ((sum, vector), factor) in own.iter_mut().zip(vectors).zip(factors) {
                let column = &factor[i * n + j..i * n + i];
                let terms = vector.iter().zip(column);
                *sum = terms.fold(T::zero(), |sum, (one, entry)| sum + *one * *entry);
            }
            cyclic.solve(diagonals, [i, j], false, &mut own);
            let places = left.iter_mut().skip(i - j).step_by(long);
            places.zip(&own).for_each(|(place, own)| *place = *own);
        }
        left
    }
}

/// The diagonals of all factors, those of one index together.
pub(super) struct Diagonals<T> {
    /// Those of the first factor first.
    pub own: Vec<Vec<T>>,
    /// Their inverses.
    over: Vec<Vec<T>>,
    /// Their products.
    pub products: Vec<Product>,
    /// Logarithms of the moduli of these.
    logs: Vec<f64>,
}

impl<T: Scalar> Diagonals<T> {
    pub fn of(chain: &Chain<T>) -> Diagonals<T> {
        let own: Vec<Vec<T>> = (0..chain.n).map(|j| chain.diagonal(j)).collect();
        let over = |diagonal: &Vec<T>| diagonal.iter().map(|entry| T::one() / *entry).collect();
        let product = |diagonal: &Vec<T>| {
            let mut product = Product::ONE;
            diagonal
                .iter()
                .for_each(|entry| product.times(entry.number()));
            product
        };
        let products: Vec<Product> = own.iter().map(product).collect();
        Diagonals {
            over: own.iter().map(over).collect(),
            logs: products.iter().map(Product::log_modulus).collect(),
            products,
            own,
        }
    }

    /// The product of one diagonal over that of another one.
    fn ratio(&self, one: usize, other: usize) -> T {
        let (one, other) = (self.products[one], self.products[other]);
        let ratio = one.number / other.number;
        T::of(times_power(ratio, one.exponent - other.exponent))
    }
}

/// Linear recurrences that come back to where they began.
struct Cyclic<T> {
    gains: Vec<T>,
}

impl<T: Scalar> Cyclic<T> {
    fn new(count: usize) -> Cyclic<T> {
        Cyclic {
            gains: Vec::with_capacity(count),
        }
    }

    /// In place of the numbers b of all factors those u with du′ = au + b that come back to the first, a and d the diagonals of two
    /// indices and u′ that of the next factor, or of the one before.
    fn solve(
        &mut self,
        diagonals: &Diagonals<T>,
        [a, d]: [usize; 2],
        is_next_after: bool,
        numbers: &mut [T],
    ) {
        let ratio = diagonals.logs[a] - diagonals.logs[d];
        if ratio.is_nan() {
            // both are zero: what they have in common is none of their condition
            numbers.fill(T::zero());
            return;
        }
        // the way on which they shrink: u becomes (gain)u + (what is added)
        let shrinks = ratio <= 0.0;
        let (less, more) = if shrinks { (a, d) } else { (d, a) };
        let (own, over) = (&diagonals.own[less], &diagonals.over[more]);
        self.gains.clear();
        let pairs = own.iter().zip(over);
        self.gains.extend(pairs.map(|(own, over)| *own * *over));
        let pairs = numbers.iter_mut().zip(over);
        match shrinks {
            true => pairs.for_each(|(number, over)| *number *= *over),
            false => pairs.for_each(|(number, over)| *number *= -*over),
        }
        let mut apart = T::one() - diagonals.ratio(less, more);
        // eigenvalues are not told apart by less than their rounding
        let least = f64::EPSILON * numbers.len() as f64;
        if size(apart) < least {
            apart = T::from_real(least);
        }
        if shrinks == is_next_after {
            let once = once_round(self.gains.iter().zip(&*numbers));
            let steps = self.gains.iter().zip(numbers);
            go_round(steps, once / apart, shrinks);
        } else {
            let once = once_round(self.gains.iter().zip(&*numbers).rev());
            let steps = self.gains.iter().zip(numbers).rev();
            go_round(steps, once / apart, shrinks);
        }
    }
}

/// What becomes of zero. Two steps are taken at once here as there, for each has to wait for the one before.
fn once_round<'a, T: Scalar>(mut steps: impl Iterator<Item = (&'a T, &'a T)>) -> T {
    let mut u = T::zero();
    while let Some((gain, added)) = steps.next() {
        u = match steps.next() {
            Some((next, more)) => (*next * *gain) * u + (*next * *added + *more),
            None => *gain * u + *added,
        };
    }
    u
}

/// In place of what is added what it is added to, or what comes of it.
fn go_round<'a, T: Scalar>(
    mut steps: impl Iterator<Item = (&'a T, &'a mut T)>,
    mut u: T,
    is_before: bool,
) {
    while let Some((gain, number)) = steps.next() {
        let (own, after) = (u, *gain * u + *number);
        u = after;
        if let Some((next, other)) = steps.next() {
            u = (*next * *gain) * own + (*next * *number + *other);
            *other = if is_before { after } else { u };
        }
        *number = if is_before { own } else { after };
    }
}
