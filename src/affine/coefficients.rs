//! Coefficients of series in a table, and the sums of products of which recurrences are made.
//!
//! Derivatives stand in groups that fill a register of the widest kind, of every group all places, of every place all orders after
//! one another: a sum over orders goes through four rows of numbers. Whoever calls this dispatches to the registers of the machine; no
//! operation is contracted or reordered, so that all machines have the same numbers.

use std::iter::repeat_n;
use std::ops::Range;

use super::dual::{Dual, VARYING};

/// Derivatives that go through a sum together.
pub(super) const TOGETHER: usize = 4;

/// Some of the derivatives of a number.
pub(super) type Lanes = [f64; TOGETHER];

/// A linear form of z with few terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sparse {
    pub terms: Vec<(usize, Dual)>,
    /// Of how many of the parameters that vary its coefficients are functions: the first, if any, or both.
    pub parameters: usize,
}

impl Sparse {
    /// The terms that are not zero.
    pub fn new(at: impl Iterator<Item = (usize, Dual)>) -> Sparse {
        let terms: Vec<_> = at.filter(|(_, c)| *c != Dual::default()).collect();
        let last = |by: &[f64; VARYING]| by.iter().rposition(|by| *by != 0.0);
        let counts = terms
            .iter()
            .map(|(_, c)| last(&c.by).map_or(0, |last| last + 1));
        Sparse {
            parameters: counts.max().unwrap_or(0),
            terms,
        }
    }

    /// The component of z that it is, if it is one.
    pub fn component(&self) -> Option<usize> {
        let one = Dual {
            value: 1.0,
            ..Dual::default()
        };
        match self.terms[..] {
            [(component, by)] if by == one => Some(component),
            _ => None,
        }
    }
}

/// Coefficients of components, operands and what is found with a component, each in a place.
#[derive(Clone, Debug)]
pub(super) struct CoefficientTable {
    /// How many orders and places there are.
    pub orders: usize,
    places: usize,
    values: Vec<f64>,
    /// Groups of derivatives that a coefficient has, none where they are not asked for: in what z is made of at the beginning, so
    /// much, then in the parameters.
    pub groups: usize,
    pub inner: usize,
    pub parameters: usize,
    lanes: Vec<Lanes>,
    /// Whether all numbers are finite, once that has been found out.
    pub is_finite: bool,
}

impl CoefficientTable {
    /// Zeros of so many orders and places, with derivatives in so much of what z is made of and in so many parameters, where they are
    /// asked for.
    #[inline(always)]
    pub fn new(
        [orders, places]: [usize; 2],
        [inner, parameters]: [usize; 2],
        derivatives: bool,
    ) -> CoefficientTable {
        let groups = match derivatives {
            true => (inner + parameters).div_ceil(TOGETHER),
            false => 0,
        };
        // memory filled here is had faster than zeros of the system
        CoefficientTable {
            orders,
            places,
            values: repeat_n(0.0, orders * places).collect(),
            groups,
            inner,
            parameters,
            lanes: repeat_n([0.0; TOGETHER], groups * orders * places).collect(),
            is_finite: false,
        }
    }

    /// The coefficient of order k of a place.
    #[inline(always)]
    pub fn value(&self, place: usize, k: usize) -> f64 {
        self.values[place * self.orders + k]
    }

    /// Sets it.
    #[inline(always)]
    pub fn set(&mut self, place: usize, k: usize, value: f64) {
        self.values[place * self.orders + k] = value;
    }

    /// The coefficients of all orders of a place.
    pub fn values(&self, place: usize) -> &[f64] {
        &self.values[place * self.orders..][..self.orders]
    }

    /// Groups of derivatives of the first places, so many, at a time after the beginning: of every place all groups.
    pub fn derivatives_at(&self, count: usize, time: f64) -> Vec<Lanes> {
        let table = self;
        pulp::Arch::new().dispatch(DerivativesAt { table, count, time })
    }

    /// A derivative of the coefficient of order k of a place.
    #[inline(always)]
    pub fn derivative(&self, place: usize, k: usize, lane: usize) -> f64 {
        self.lanes[self.at(place, k, lane / TOGETHER)][lane % TOGETHER]
    }

    /// The same, to be changed.
    #[inline(always)]
    pub fn derivative_mut(&mut self, place: usize, k: usize, lane: usize) -> &mut f64 {
        let at = self.at(place, k, lane / TOGETHER);
        &mut self.lanes[at][lane % TOGETHER]
    }

    /// Finds out whether all numbers are finite.
    #[inline(always)]
    pub fn check(&mut self) {
        // 0x is no number where x is none
        let values: f64 = self.values.iter().map(|x| 0.0 * x).sum();
        let mut sums = [values; TOGETHER];
        for lanes in &self.lanes {
            for lane in 0..TOGETHER {
                sums[lane] += 0.0 * lanes[lane];
            }
        }
        self.is_finite = sums == [0.0; TOGETHER];
    }

    /// Where a group of derivatives stands.
    #[inline(always)]
    fn at(&self, place: usize, k: usize, group: usize) -> usize {
        (group * self.places + place) * self.orders + k
    }

    #[inline(always)]
    fn lanes(&self, place: usize, k: usize, group: usize) -> Lanes {
        self.lanes[self.at(place, k, group)]
    }

    /// Puts the coefficient of an order of a form, times a number, as that of order k.
    #[inline(always)]
    pub fn gather(&mut self, place: usize, row: &Sparse, (from, k): (usize, usize), factor: f64) {
        let mut value = 0.0;
        for (c, by) in &row.terms {
            value += by.value * self.value(*c, from);
        }
        self.set(place, k, value * factor);
        for group in 0..self.groups {
            let mut sum = [0.0; TOGETHER];
            for (c, by) in &row.terms {
                let z = &self.lanes[self.at(*c, from, group)];
                for lane in 0..TOGETHER {
                    sum[lane] += by.value * z[lane];
                }
            }
            let at = self.at(place, k, group);
            self.lanes[at] = sum.map(|x| x * factor);
        }
        if self.groups > 0 && row.parameters > 0 {
            for (c, by) in &row.terms {
                let value = self.value(*c, from) * factor;
                for (lane, by) in (self.inner..).zip(&by.by[..row.parameters]) {
                    // most coefficients depend on none
                    if *by != 0.0 {
                        *self.derivative_mut(place, k, lane) += by * value;
                    }
                }
            }
        }
    }

    /// Σ w(i)aᵢb_{k−i} over orders i, and a group of its derivatives where there are any.
    #[inline(always)]
    fn convolved(
        &self,
        [a, b]: [usize; 2],
        (orders, k): (Range<usize>, usize),
        weight: impl Fn(usize) -> f64,
        group: usize,
    ) -> (f64, Lanes) {
        let count = orders.len();
        let (first, last) = (orders.start, k + 1 - orders.end);
        let values =
            |place: usize, from: usize| &self.values[place * self.orders + from..][..count];
        let (a_at, b_at) = (values(a, first), values(b, last));
        let (mut value, mut sum) = (0.0, [0.0; TOGETHER]);
        if self.groups == 0 {
            for (index, a) in a_at.iter().enumerate() {
                value += weight(first + index) * a * b_at[count - 1 - index];
            }
            return (value, sum);
        }
        let lanes = |place: usize, from: usize| &self.lanes[self.at(place, from, group)..][..count];
        let (a_by, b_by) = (lanes(a, first), lanes(b, last));
        for (index, (a, a_by)) in a_at.iter().zip(a_by).enumerate() {
            let (weight, back) = (weight(first + index), count - 1 - index);
            let (b, b_by) = (b_at[back], &b_by[back]);
            let (x, y) = (weight * a, weight * b);
            value += x * b;
            for lane in 0..TOGETHER {
                sum[lane] += x * b_by[lane] + y * a_by[lane];
            }
        }
        (value, sum)
    }

    /// Puts Σ w(i)aᵢb_{k−i} over orders i.
    #[inline(always)]
    pub fn convolve(
        &mut self,
        place: usize,
        pair: [usize; 2],
        (orders, k): (Range<usize>, usize),
        weight: impl Fn(usize) -> f64,
    ) {
        for group in 0..self.groups.max(1) {
            let (value, lanes) = self.convolved(pair, (orders.clone(), k), &weight, group);
            self.set(place, k, value);
            let at = self.at(place, k, group);
            if let Some(own) = self.lanes.get_mut(at) {
                *own = lanes;
            }
        }
    }

    /// Puts u of order k, where bu of this order is a_k or nothing and Σ w(i)xᵢy_{k−i} over orders i, x or y being u.
    #[inline(always)]
    pub fn divide(
        &mut self,
        (own, b): (usize, usize),
        first: Option<usize>,
        pair: [usize; 2],
        (orders, k): (Range<usize>, usize),
        weight: impl Fn(usize) -> f64,
    ) {
        let divisor = self.value(b, 0);
        for group in 0..self.groups.max(1) {
            let (sum, mut lanes) = self.convolved(pair, (orders.clone(), k), &weight, group);
            let value = (first.map_or(0.0, |a| self.value(a, k)) + sum) / divisor;
            self.set(own, k, value);
            if group < self.groups {
                let first = first.map_or([0.0; TOGETHER], |a| self.lanes(a, k, group));
                let by = self.lanes(b, 0, group);
                for lane in 0..TOGETHER {
                    lanes[lane] = (first[lane] + lanes[lane] - value * by[lane]) / divisor;
                }
                let at = self.at(own, k, group);
                self.lanes[at] = lanes;
            }
        }
    }

    /// Puts a function of an operand at an order, by its value and its slope.
    #[inline(always)]
    pub fn scale(&mut self, place: usize, (a, k): (usize, usize), (value, slope): (f64, f64)) {
        self.set(place, k, value);
        for group in 0..self.groups {
            let at = self.at(place, k, group);
            self.lanes[at] = self.lanes(a, k, group).map(|by| by * slope);
        }
    }
}

/// Derivatives of the first places, so many, at a time.
struct DerivativesAt<'a> {
    table: &'a CoefficientTable,
    count: usize,
    time: f64,
}

impl pulp::WithSimd for DerivativesAt<'_> {
    type Output = Vec<Lanes>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Vec<Lanes> {
        let DerivativesAt { table, count, time } = self;
        let last = if time == 0.0 { 0 } else { table.orders - 1 };
        let mut sums = Vec::with_capacity(count * table.groups);
        for place in 0..count {
            for group in 0..table.groups {
                let orders = &table.lanes[table.at(place, 0, group)..][..=last];
                let mut sum = [0.0; TOGETHER];
                for lanes in orders.iter().rev() {
                    for lane in 0..TOGETHER {
                        sum[lane] = sum[lane] * time + lanes[lane];
                    }
                }
                sums.push(sum);
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDERS: usize = 19;

    /// u = x², v = u/w and ẋ = a − bv in seven derivatives, a and b depending on the last two, w being 1 + x.
    struct Example;

    impl pulp::WithSimd for Example {
        type Output = CoefficientTable;

        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _: S) -> CoefficientTable {
            let [x, one, u, w, v] = [0, 1, 2, 3, 4];
            let number = |value: f64, by: [f64; VARYING]| Dual::new(value, by);
            let rate = [
                (one, number(0.7, [1.0, 0.0])),
                (v, number(-1.3, [0.0, -1.0])),
            ];
            let rate = Sparse::new(rate.into_iter());
            let divisor = [one, x].map(|c| (c, number(1.0, [0.0; VARYING])));
            let divisor = Sparse::new(divisor.into_iter());
            let mut table = CoefficientTable::new([ORDERS, 5], [5, 2], true);
            table.set(x, 0, 0.3);
            table.set(one, 0, 1.0);
            for lane in 0..5 {
                *table.derivative_mut(x, 0, lane) = 1.0 / (1.0 + lane as f64);
            }
            for k in 0..ORDERS {
                table.convolve(u, [x, x], (0..k + 1, k), |_| 1.0);
                table.gather(w, &divisor, (k, k), 1.0);
                table.divide((v, w), Some(u), [v, w], (0..k, k), |_| -1.0);
                if k + 1 < ORDERS {
                    table.gather(x, &rate, (k, k + 1), ((k + 1) as f64).recip());
                }
            }
            table.check();
            table
        }
    }

    /// The registers of the machine give the numbers that any other one has, bit by bit.
    #[test]
    fn all_registers_have_the_same_numbers() {
        let [one, other] = [pulp::Arch::new(), pulp::Arch::Scalar].map(|on| on.dispatch(Example));
        assert!(one.is_finite && one.groups == 2);
        let bits = |table: &CoefficientTable| -> Vec<u64> {
            let lanes = table.lanes.as_flattened().iter();
            table
                .values
                .iter()
                .chain(lanes)
                .map(|x| x.to_bits())
                .collect()
        };
        assert_eq!(bits(&one), bits(&other));
        // ẍ = −b(d/dx)(x²/(1 + x))ẋ
        let (value, x) = (|k| one.value(0, k), 0.3_f64);
        let rate = 0.7 - 1.3 * x * x / (1.0 + x);
        let second = -1.3 * (2.0 * x + x * x) / (1.0 + x).powi(2) * rate;
        assert!((value(1) - rate).abs() <= 4.0 * f64::EPSILON);
        assert!((2.0 * value(2) - second).abs() <= 16.0 * f64::EPSILON);
    }

    /// What is no number in one place is seen, among the values and among the derivatives.
    #[test]
    fn numbers_that_are_none_are_seen() {
        let finite = |at: Option<usize>| {
            let mut table = CoefficientTable::new([ORDERS, 2], [3, 0], true);
            match at {
                Some(0) => table.set(1, 7, f64::INFINITY),
                Some(lane) => *table.derivative_mut(1, 7, lane) = f64::NAN,
                None => {}
            }
            table.check();
            table.is_finite
        };
        assert!(finite(None) && !finite(Some(0)) && !finite(Some(2)));
    }
}
