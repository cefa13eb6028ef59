//! Coefficients of Taylor series in time, order by order, with their derivatives.
//!
//! The components of z that are made of others follow from their operands by the well-known recurrences, the others from
//! their rates (G.F. Corliss, Y.F. Chang, ACM Trans. Math. Software 8, 1982; A. Griewank, A. Walther, Evaluating
//! Derivatives, 2008, chapter 13). A coefficient carries its derivatives in the states, in the phase of the forcing and in the
//! parameters that vary along: these *lanes* go through one convolution, in groups that fit into registers.

use std::ops::Range;
use std::sync::Arc;

use super::dual::{Dual, VARYING};
use super::expression::{Function, root};
use super::form::Rule;
use super::rows::Row;
use crate::linalg::{Matrix, Vector};

/// An operand of `abs` that is smaller than this part of its terms is zero: the next coefficient has its sign.
const KINK: f64 = 1e-12;

/// Derivatives that go through a convolution together.
const TOGETHER: usize = 4;

/// Some of the derivatives of a number.
type Lanes = [f64; TOGETHER];

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
    fn component(&self) -> Option<usize> {
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

/// A component of z that is made of others.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Step {
    pub rule: Rule,
    pub operands: [Sparse; 2],
}

/// What a series begins from, and how it goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recurrences<'a> {
    /// How the components of z beyond the first are made, and which of them count.
    pub steps: &'a [Step],
    pub needed: &'a [bool],
    /// Rates of the components before them; none where everything is linear.
    pub rates: &'a [Sparse],
    /// Where their operands stand, and how many places components and operands take.
    pub places: &'a Places,
    /// Signs of the operands of `abs`, where they are known.
    pub signs: &'a [f64],
    /// Components before them, and of those the states.
    pub base: usize,
    pub states: usize,
    /// How many of the parameters that vary have to do with them.
    pub parameters: usize,
}

/// Coefficients of z in time, and of what it is made of.
#[derive(Clone, Debug)]
pub struct Series {
    /// Components of z, of them those before the terms, and of these the states.
    size: usize,
    base: usize,
    states: usize,
    table: Arc<CoefficientTable>,
    /// Place of the operands of every step in the table.
    places: Arc<[[usize; 2]]>,
    /// Signs of the operands of `abs`.
    pub(super) signs: Vec<f64>,
    /// Which of the parameters is the first of those of a system whose rows it is asked about.
    parameter: usize,
}

/// Coefficients of components, operands and what is found with a component: of every place all orders after one another.
#[derive(Clone, Debug)]
struct CoefficientTable {
    orders: usize,
    values: Vec<f64>,
    /// Groups of derivatives that a coefficient has, none where they are not asked for: in what z is made of at the beginning, so
    /// much, then in the parameters.
    groups: usize,
    inner: usize,
    parameters: usize,
    lanes: Vec<Lanes>,
}

/// Where the operands of every step stand in a table: with a component that they are, or behind all components.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Places {
    operands: Arc<[[usize; 2]]>,
    count: usize,
}

impl Places {
    /// Those of steps that follow so many components.
    pub fn new(steps: &[Step], base: usize) -> Places {
        let mut count = base + steps.len();
        let mut place = |operand: &Sparse| {
            let component = operand.component();
            component.unwrap_or_else(|| {
                count += 1;
                count - 1
            })
        };
        let operands = steps.iter();
        let operands = operands.map(|step| step.operands.each_ref().map(&mut place));
        Places {
            operands: operands.collect(),
            count,
        }
    }
}

/// Where a step finds its operands, and where it leaves what it makes.
#[derive(Clone, Copy)]
struct Around {
    a: usize,
    b: usize,
    own: usize,
    helper: usize,
}

impl CoefficientTable {
    fn value(&self, place: usize, k: usize) -> f64 {
        self.values[place * self.orders + k]
    }

    /// Where the derivatives of the coefficient of order k of a place begin.
    fn at(&self, place: usize, k: usize) -> usize {
        (place * self.orders + k) * self.groups
    }

    fn lanes(&self, place: usize, k: usize, group: usize) -> Lanes {
        self.lanes[self.at(place, k) + group]
    }

    /// Puts the coefficient of an order of a form, times a number, as that of order k.
    fn gather(&mut self, place: usize, row: &Sparse, (from, k): (usize, usize), factor: f64) {
        let at = self.at(place, k);
        let mut value = 0.0;
        for (c, by) in &row.terms {
            value += by.value * self.value(*c, from);
        }
        self.values[place * self.orders + k] = value * factor;
        for group in 0..self.groups {
            let mut sum = [0.0; TOGETHER];
            for (c, by) in &row.terms {
                let z = &self.lanes[self.at(*c, from) + group];
                for lane in 0..TOGETHER {
                    sum[lane] += by.value * z[lane];
                }
            }
            self.lanes[at + group] = sum.map(|x| x * factor);
        }
        if self.groups > 0 && row.parameters > 0 {
            for (c, by) in &row.terms {
                let value = self.value(*c, from) * factor;
                for (lane, by) in (self.inner..).zip(&by.by[..row.parameters]) {
                    self.lanes[at + lane / TOGETHER][lane % TOGETHER] += by * value;
                }
            }
        }
    }

    /// Σ w(i)aᵢb_{k−i} over orders i, and a group of its derivatives where there are any.
    #[inline(always)]
    fn convolved(
        &self,
        pair: [usize; 2],
        orders: (Range<usize>, usize),
        weight: impl Fn(usize) -> f64,
        group: usize,
    ) -> (f64, Lanes) {
        // most have one group
        match self.groups {
            1 => self.convolved_of(pair, orders, weight, (0, 1)),
            groups => self.convolved_of(pair, orders, weight, (group, groups)),
        }
    }

    #[inline(always)]
    fn convolved_of(
        &self,
        [a, b]: [usize; 2],
        (orders, k): (Range<usize>, usize),
        weight: impl Fn(usize) -> f64,
        (group, groups): (usize, usize),
    ) -> (f64, Lanes) {
        let count = orders.len();
        let firsts = [
            a * self.orders + orders.start,
            b * self.orders + k + 1 - orders.end,
        ];
        let [a, b] = firsts.map(|first| &self.values[first..][..count]);
        let (mut value, mut sum) = (0.0, [0.0; TOGETHER]);
        if groups == 0 {
            for i in 0..count {
                value += weight(orders.start + i) * a[i] * b[count - 1 - i];
            }
            return (value, sum);
        }
        let [a_by, b_by] = firsts.map(|first| &self.lanes[first * groups..][..count * groups]);
        for i in 0..count {
            let (back, weight) = (count - 1 - i, weight(orders.start + i));
            let (x, y) = (weight * a[i], weight * b[back]);
            let (x_by, y_by) = (&a_by[i * groups + group], &b_by[back * groups + group]);
            value += x * b[back];
            for lane in 0..TOGETHER {
                sum[lane] += x * y_by[lane] + y * x_by[lane];
            }
        }
        (value, sum)
    }

    /// Puts Σ w(i)aᵢb_{k−i} over orders i.
    #[inline(always)]
    fn convolve(
        &mut self,
        place: usize,
        pair: [usize; 2],
        (orders, k): (Range<usize>, usize),
        weight: impl Fn(usize) -> f64,
    ) {
        let at = self.at(place, k);
        for group in 0..self.groups.max(1) {
            let (value, lanes) = self.convolved(pair, (orders.clone(), k), &weight, group);
            self.values[place * self.orders + k] = value;
            if let Some(own) = self.lanes.get_mut(at + group) {
                *own = lanes;
            }
        }
    }

    /// Puts u of order k, where bu of this order is a_k or nothing and Σ w(i)xᵢy_{k−i} over orders i, x or y being u.
    #[inline(always)]
    fn divide(
        &mut self,
        (own, b): (usize, usize),
        first: Option<usize>,
        pair: [usize; 2],
        (orders, k): (Range<usize>, usize),
        weight: impl Fn(usize) -> f64,
    ) {
        let divisor = self.value(b, 0);
        let at = self.at(own, k);
        for group in 0..self.groups.max(1) {
            let (sum, mut lanes) = self.convolved(pair, (orders.clone(), k), &weight, group);
            let value = (first.map_or(0.0, |a| self.value(a, k)) + sum) / divisor;
            self.values[own * self.orders + k] = value;
            if group < self.groups {
                let first = first.map_or([0.0; TOGETHER], |a| self.lanes(a, k, group));
                let by = self.lanes(b, 0, group);
                for lane in 0..TOGETHER {
                    lanes[lane] = (first[lane] + lanes[lane] - value * by[lane]) / divisor;
                }
                self.lanes[at + group] = lanes;
            }
        }
    }

    /// Puts a function of an operand at an order, by its value and its slope.
    fn scale(&mut self, place: usize, (a, k): (usize, usize), (value, slope): (f64, f64)) {
        self.values[place * self.orders + k] = value;
        let at = self.at(place, k);
        for group in 0..self.groups {
            self.lanes[at + group] = self.lanes(a, k, group).map(|by| by * slope);
        }
    }

    /// The coefficient of order k of a component that is made of others; `sign` is that of an operand of `abs`.
    fn step(&mut self, step: &Step, around: Around, k: usize, sign: f64) {
        let Around { a, b, own, helper } = around;
        for (operand, place) in step.operands.iter().zip([a, b]) {
            if operand.component().is_none() && !operand.terms.is_empty() {
                self.gather(place, operand, (k, k), 1.0);
            }
        }
        let over_k = |i: usize| i as f64 / k as f64;
        let (x, later) = (self.value(a, 0), (1..k + 1, k));
        match step.rule {
            Rule::Product => self.convolve(own, [a, b], (0..k + 1, k), |_| 1.0),
            Rule::Quotient => self.divide((own, b), Some(a), [own, b], (0..k, k), |_| -1.0),
            Rule::Power(_) | Rule::Function(Function::Sqrt) => {
                let r = match step.rule {
                    Rule::Power(r) => r,
                    _ => 0.5,
                };
                if k == 0 {
                    return self.scale(own, (a, 0), (x.powf(r), r * x.powf(r - 1.0)));
                }
                let weight = |i: usize| (r * i as f64 - (k - i) as f64) / k as f64;
                self.divide((own, a), None, [a, own], later, weight);
            }
            Rule::Function(Function::Abs) => {
                let sign = if sign == 0.0 { x.signum() } else { sign };
                self.scale(own, (a, k), (sign * self.value(a, k), sign));
            }
            Rule::Function(function) if k == 0 => {
                self.scale(own, (a, 0), function.at(x));
                let u = self.value(own, 0);
                match function {
                    Function::Sin => self.scale(helper, (a, 0), (x.cos(), -u)),
                    Function::Cos => self.scale(helper, (a, 0), (x.sin(), u)),
                    Function::Tan => self.scale(helper, (own, 0), (1.0 + u * u, 2.0 * u)),
                    Function::Tanh => self.scale(helper, (own, 0), (1.0 - u * u, -2.0 * u)),
                    Function::Sinh => self.scale(helper, (a, 0), (x.cosh(), u)),
                    Function::Cosh => self.scale(helper, (a, 0), (x.sinh(), u)),
                    Function::Atan => self.scale(helper, (a, 0), (1.0 + x * x, 2.0 * x)),
                    Function::Asin => self.scale(helper, (a, 0), (root(x), -x / root(x))),
                    Function::Acos => self.scale(helper, (a, 0), (-root(x), x / root(x))),
                    _ => {}
                }
            }
            Rule::Function(Function::Atan) => {
                // u̇w = ȧ with w = 1 + a²
                self.convolve(helper, [a, a], (0..k + 1, k), |_| 1.0);
                self.divide((own, helper), Some(a), [own, helper], (1..k, k), |i| {
                    -over_k(i)
                });
            }
            Rule::Function(Function::Asin | Function::Acos) => {
                // u̇w = ȧ with ẇ = −au̇: w = ±√(1 − a²)
                self.divide((own, helper), Some(a), [own, helper], (1..k, k), |i| {
                    -over_k(i)
                });
                self.convolve(helper, [own, a], later, |i| -over_k(i));
            }
            Rule::Function(Function::Ln) => {
                self.divide((own, a), Some(a), [own, a], (1..k, k), |i| -over_k(i));
            }
            Rule::Function(function) => {
                // u̇ = ±ȧw with ẇ = ∓ȧu of a sine or a cosine, ẇ = ȧu of a hyperbolic one, w = 1 ± u² of a tangent, w = u of
                // the exponential
                let sign = match function {
                    Function::Cos | Function::Tanh => -1.0,
                    _ => 1.0,
                };
                match function {
                    Function::Sin | Function::Cos => {
                        self.convolve(own, [a, helper], later.clone(), |i| sign * over_k(i));
                        self.convolve(helper, [a, own], later, |i| -sign * over_k(i));
                    }
                    Function::Sinh | Function::Cosh => {
                        self.convolve(own, [a, helper], later.clone(), over_k);
                        self.convolve(helper, [a, own], later, over_k);
                    }
                    Function::Tan | Function::Tanh => {
                        self.convolve(own, [a, helper], later, over_k);
                        self.convolve(helper, [own, own], (0..k + 1, k), |_| sign);
                    }
                    _ => self.convolve(own, [a, own], later, over_k),
                }
            }
        }
    }
}

/// Whether a rule has a second component that is found with its own: the cosine of a sine, 1 ± u² of a tangent, the inverse of
/// the slope of an arc.
fn has_helper(rule: Rule) -> bool {
    use Function::{Acos, Asin, Atan, Cos, Cosh, Sin, Sinh, Tan, Tanh};
    let Rule::Function(function) = rule else {
        return false;
    };
    matches!(
        function,
        Sin | Cos | Tan | Tanh | Sinh | Cosh | Asin | Acos | Atan
    )
}

impl Series {
    /// The series from z up to an order, with derivatives where they are asked for.
    pub(super) fn new(
        recurrences: Recurrences,
        z: &Vector,
        order: usize,
        derivatives: bool,
    ) -> Series {
        Series {
            size: recurrences.base + recurrences.steps.len(),
            base: recurrences.base,
            states: recurrences.states,
            table: Arc::new(recurrences.run(z, order, derivatives)),
            places: recurrences.places.operands.clone(),
            signs: recurrences.signs.to_vec(),
            parameter: 0,
        }
    }
}

/// A component whose terms down to rounding are normal numbers, or zero: the coefficients of a smaller one have no digits, and
/// would tell how long its series holds.
fn kept(z: f64) -> f64 {
    const LEAST: f64 = f64::MIN_POSITIVE / f64::EPSILON;
    if z.abs() < LEAST { 0.0 } else { z }
}

impl Recurrences<'_> {
    /// The coefficients from z up to an order.
    fn run(&self, z: &Vector, order: usize, derivatives: bool) -> CoefficientTable {
        let Places { operands, count } = self.places;
        let (orders, base, states) = (order + 1, self.base, self.states);
        // cosines and sines follow from the phase, and what stays 1 has no derivative
        let is_forced = base > states + 1;
        let inner = states + usize::from(is_forced);
        let groups = match derivatives {
            true => (inner + self.parameters).div_ceil(TOGETHER),
            false => 0,
        };
        let helpers = self.steps.iter().filter(|step| has_helper(step.rule));
        let coefficients = orders * (count + helpers.count());
        let mut table = CoefficientTable {
            orders,
            values: vec![0.0; coefficients],
            groups,
            inner,
            parameters: self.parameters,
            lanes: vec![[0.0; TOGETHER]; groups * coefficients],
        };
        for c in 0..base {
            table.values[c * orders] = kept(z[c]);
        }
        if derivatives {
            let mut set = |c: usize, lane: usize, value: f64| {
                let at = table.at(c, 0);
                table.lanes[at + lane / TOGETHER][lane % TOGETHER] = value;
            };
            (0..states).for_each(|state| set(state, state, 1.0));
            for (h, cosine) in (1..).zip((states + 1..base).step_by(2)) {
                let h = f64::from(h);
                set(cosine, states, -h * z[cosine + 1]);
                set(cosine + 1, states, h * z[cosine]);
            }
        }
        for k in 0..orders {
            // what is found with a component comes after all others
            let mut helper = *count;
            for (index, step) in self.steps.iter().enumerate() {
                if self.needed[index] {
                    let [a, b] = operands[index];
                    let own = base + index;
                    let sign = self.signs.get(index).copied().unwrap_or(0.0);
                    table.step(step, Around { a, b, own, helper }, k, sign);
                }
                helper += usize::from(has_helper(step.rule));
            }
            if k + 1 < orders {
                let moving = self.rates.iter().enumerate();
                for (c, rate) in moving.filter(|(_, rate)| !rate.terms.is_empty()) {
                    table.gather(c, rate, (k, k + 1), ((k + 1) as f64).recip());
                }
            }
        }
        table
    }
}

impl Series {
    /// Derivatives of the coefficient of this order of a component, in the states, in the phase where there is one, and in the
    /// parameters.
    fn lanes(&self, k: usize, c: usize) -> &[f64] {
        let CoefficientTable { groups, lanes, .. } = &*self.table;
        lanes[self.table.at(c, k)..][..*groups].as_flattened()
    }

    /// Those in the states and in the phase.
    pub(super) fn by_inner(&self, k: usize, c: usize) -> &[f64] {
        &self.lanes(k, c)[..self.table.inner]
    }

    /// Derivatives in the components of z before the terms, from those in states and phase, put by their place: of the first cosine and
    /// sine what makes that in the phase, along which alone they move.
    fn spread(&self, lanes: &[f64], mut put: impl FnMut(usize, f64)) {
        for (state, by) in lanes[..self.states].iter().enumerate() {
            put(state, *by);
        }
        if self.table.inner > self.states {
            let (cosine, sine) = (self.states + 1, self.states + 2);
            let by_phase = lanes[self.states];
            put(cosine, -by_phase * self.value(0, sine));
            put(sine, by_phase * self.value(0, cosine));
        }
    }

    /// Derivative in a parameter.
    fn by_parameter(&self, lanes: &[f64], parameter: usize) -> f64 {
        match parameter < self.table.parameters {
            true => lanes[self.table.inner + parameter],
            false => 0.0,
        }
    }

    /// Coefficient of this order of a component.
    pub fn value(&self, k: usize, c: usize) -> f64 {
        self.table.value(c, k)
    }

    /// Coefficients of all orders of a component.
    pub(super) fn values(&self, c: usize) -> &[f64] {
        let CoefficientTable { orders, values, .. } = &*self.table;
        &values[c * orders..][..*orders]
    }

    /// The highest order.
    fn order(&self) -> usize {
        self.table.orders - 1
    }

    /// Components of z.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Whether derivatives are known.
    pub(super) fn has_derivatives(&self) -> bool {
        self.table.groups > 0
    }

    /// Whether all numbers are.
    pub(super) fn is_finite(&self) -> bool {
        let CoefficientTable { values, lanes, .. } = &*self.table;
        // 0x is no number where x is none
        let values: f64 = values.iter().map(|x| 0.0 * x).sum();
        let mut sums = [values; TOGETHER];
        for lanes in lanes {
            for (sum, x) in sums.iter_mut().zip(lanes) {
                *sum += 0.0 * x;
            }
        }
        sums == [0.0; TOGETHER]
    }

    /// Coefficient of this order of the first operand of a step.
    pub(super) fn operand(&self, k: usize, step: usize) -> f64 {
        self.value(k, self.places[step][0])
    }

    /// Order of the first coefficient of the first operand of a step that is not zero but for rounding.
    pub(super) fn first_order(&self, steps: &[Step], index: usize) -> usize {
        let counts = |k: &usize| {
            let terms = steps[index].operands[0].terms.iter();
            let size: f64 = terms
                .map(|(c, by)| (by.value * self.value(*k, *c)).abs())
                .sum();
            self.operand(*k, index).abs() > KINK * size
        };
        (0..=self.order()).find(counts).unwrap_or(self.order())
    }

    /// The sign of that operand just after the beginning, or just before it.
    pub(super) fn first_sign(&self, steps: &[Step], index: usize, direction: f64) -> f64 {
        let k = self.first_order(steps, index);
        (self.operand(k, index) * direction.powi(k as i32)).signum()
    }

    /// z at a time after the beginning.
    pub fn at(&self, time: f64) -> Vector {
        let of = |c: usize| {
            let orders = self.values(c).iter().rev();
            orders.fold(0.0, |sum, z| sum * time + z)
        };
        Vector::from_fn(self.size, |c, _| of(c))
    }

    /// z at the beginning, of this length.
    pub(super) fn first(&self) -> Vector {
        Vector::from_fn(self.size, |c, _| self.value(0, c))
    }

    /// Derivatives of z at the beginning in the components before the terms, and in the parameters.
    pub fn derivatives(&self) -> (Matrix, [Vector; VARYING]) {
        self.derivatives_of(self.size, 0.0)
    }

    /// The same for the first components, so many, at a time.
    pub(super) fn derivatives_of(&self, count: usize, time: f64) -> (Matrix, [Vector; VARYING]) {
        let mut at = Matrix::zeros(count, self.base);
        let mut by: [Vector; VARYING] = std::array::from_fn(|_| Vector::zeros(count));
        let groups = self.table.groups;
        let mut sum = vec![[0.0; TOGETHER]; groups];
        for c in 0..count {
            let last = if time == 0.0 { 0 } else { self.order() };
            let all = &self.table.lanes[self.table.at(c, 0)..self.table.at(c, last + 1)];
            for (group, sum) in sum.iter_mut().enumerate() {
                *sum = [0.0; TOGETHER];
                for lanes in all.chunks_exact(groups).rev() {
                    for (sum, next) in sum.iter_mut().zip(lanes[group]) {
                        *sum = *sum * time + next;
                    }
                }
            }
            let sum = sum.as_flattened();
            self.spread(sum, |column, x| at[(c, column)] = x);
            for (parameter, by) in by.iter_mut().enumerate() {
                by[c] = self.by_parameter(sum, parameter);
            }
        }
        (at, by)
    }

    /// The same series for a system whose first parameter has this place among those of the series.
    pub fn in_parameter(&self, parameter: usize) -> Series {
        Series {
            parameter,
            ..self.clone()
        }
    }

    /// Σ cᵢzᵢ of the coefficients of an order.
    pub fn of(&self, row: &Vector, k: usize) -> f64 {
        let all = row.iter().enumerate().filter(|(_, c)| **c != 0.0);
        all.map(|(index, c)| c * self.value(k, index)).sum()
    }

    /// The same for a row of a system, with its derivatives in the components of z at the beginning, and in the parameters of
    /// that system in their order.
    pub fn jet(&self, row: &Row, k: usize) -> (f64, Vector, [f64; VARYING]) {
        let mut by_z = Vector::zeros(self.size);
        let mut by = row.by.each_ref().map(|by| self.of(by, k));
        let places = in_order(self.parameter);
        for (index, c) in row.at.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let lanes = self.lanes(k, index);
            self.spread(lanes, |place, by| by_z[place] += c * by);
            for (by, place) in by.iter_mut().zip(places) {
                *by += c * self.by_parameter(lanes, place);
            }
        }
        (self.of(&row.at, k), by_z, by)
    }
}

/// The places of the parameters of a system among those of a series, where that of the first is known: two parameters have
/// one order or the other.
pub fn in_order(first: usize) -> [usize; VARYING] {
    [first, VARYING - 1 - first]
}
