//! Coefficients of Taylor series in time, order by order, with their derivatives.
//!
//! The components of z that are made of others follow from their operands by the well-known recurrences, the others from
//! their rates (G.F. Corliss, Y.F. Chang, ACM Trans. Math. Software 8, 1982; A. Griewank, A. Walther, Evaluating
//! Derivatives, 2008, chapter 13). A coefficient carries its derivatives in the states, in the phase of the forcing and in the
//! parameters that vary along: these *lanes* go through one convolution, in groups that fit into registers.

use std::sync::Arc;

use super::algebra::{Function, SeriesRule};
use super::coefficients::{CoefficientTable, Sparse, TOGETHER};
use super::dual::VARYING;
use super::form::Rule;
use super::quotients;
use super::rows::Row;
use crate::linalg::{Matrix, Vector};

/// An operand of `abs` that is smaller than this part of its terms is zero: the next coefficient has its sign.
const KINK: f64 = 1e-12;

/// A component of z that is made of others.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ProgramStep {
    pub rule: Rule,
    pub operands: [Sparse; 2],
}

/// What a series begins from, and how it goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recurrences<'a> {
    /// How the components of z beyond the first are made, and which of them count.
    pub steps: &'a [ProgramStep],
    pub needed: &'a [bool],
    /// Which of them the flow has to do with: Newton's method may look beyond where they end.
    pub flow: &'a [bool],
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

/// Where the operands of every step stand in a table: with a component that they are, or behind all components.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Places {
    operands: Arc<[[usize; 2]]>,
    count: usize,
}

impl Places {
    /// Those of steps that follow so many components.
    pub fn new(steps: &[ProgramStep], base: usize) -> Places {
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

/// Rounding of what a power is of, relative to its terms.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Where a step finds its operands, behind so many components where they are none, and where it leaves what it makes.
#[derive(Clone, Copy)]
struct Around {
    components: usize,
    a: usize,
    b: usize,
    own: usize,
    helper: usize,
    /// Whether what ends at zero goes on as zero.
    extends: bool,
}

impl CoefficientTable {
    /// The coefficient of order k of a component that is made of others; `sign` is that of an operand of `abs`.
    #[inline(always)]
    fn step(&mut self, step: &ProgramStep, around: Around, k: usize, sign: f64) {
        let Around {
            components,
            a,
            b,
            own,
            helper,
            extends,
        } = around;
        for (operand, place) in step.operands.iter().zip([a, b]) {
            if place >= components && !operand.terms.is_empty() {
                self.gather(place, operand, (k, k), 1.0);
            }
        }
        if k == 0 && a >= components {
            self.round_to_zero(step, a);
        }
        let x = self.value(a, 0);
        match step.rule {
            Rule::Product => self.convolve(own, [a, b], (0..k + 1, k), |_| 1.0),
            Rule::Quotient => self.divide((own, b), Some(a), [own, b], (0..k, k), |_| -1.0),
            Rule::Power(r) => {
                let is_beyond = extends && x < 0.0 && step.rule.ends_at_zero();
                self.power((a, own), r, k, is_beyond);
            }
            Rule::Function(function) => self.function(function, (a, own, helper), k, sign),
        }
    }

    /// The coefficient of order k of aʳ. From zero on it has no series, and is nothing there for a while; so it is all along where it is
    /// beyond its end.
    #[inline(always)]
    fn power(&mut self, (a, own): (usize, usize), r: f64, k: usize, is_beyond: bool) {
        let x = self.value(a, 0);
        if k == 0 {
            let [value, slope] = match is_beyond {
                true => [0.0; 2],
                false => [x.powf(r), r * x.powf(r - 1.0)],
            };
            self.scale(own, (a, 0), (value, slope));
        } else if !is_beyond && (x != 0.0 || r <= 0.0) {
            let weight = |i: usize| (r * i as f64 - (k - i) as f64) / k as f64;
            self.divide((own, a), None, [a, own], (1..k + 1, k), weight);
        }
    }

    /// The coefficient of order k of u = f(a), and of its helper w; `sign` is that of an operand of `abs`.
    #[inline(always)]
    fn function(
        &mut self,
        function: Function,
        (a, own, helper): (usize, usize, usize),
        k: usize,
        sign: f64,
    ) {
        let x = self.value(a, 0);
        let over_k = |i: usize| i as f64 / k as f64;
        let later = (1..k + 1, k);
        match function.series_rule() {
            SeriesRule::Kink => {
                let sign = if sign == 0.0 { x.signum() } else { sign };
                self.scale(own, (a, k), (sign * self.value(a, k), sign));
            }
            SeriesRule::Power(r) => self.power((a, own), r, k, false),
            SeriesRule::RelativeExponential => self.exprel(a, own, helper, k),
            SeriesRule::Logistic => self.logistic(a, own, helper, k),
            rule if k == 0 => {
                let (u, slope) = function.at(x);
                self.scale(own, (a, 0), (u, slope));
                match rule {
                    SeriesRule::Pair { sign } => self.scale(helper, (a, 0), (slope, sign * u)),
                    SeriesRule::OneAndSquare { sign } => {
                        self.scale(helper, (own, 0), (slope, 2.0 * sign * u));
                    }
                    SeriesRule::OverOneAndSquare => {
                        self.scale(helper, (a, 0), (1.0 + x * x, 2.0 * x));
                    }
                    SeriesRule::OverRoot => {
                        self.scale(helper, (a, 0), (slope.recip(), -x * slope));
                    }
                    _ => {}
                }
            }
            SeriesRule::Own => self.convolve(own, [a, own], later, over_k),
            SeriesRule::OverOperand => {
                self.divide((own, a), Some(a), [own, a], (1..k, k), |i| -over_k(i));
            }
            SeriesRule::Pair { sign } => {
                self.convolve(own, [a, helper], later.clone(), over_k);
                self.convolve(helper, [a, own], later, |i| sign * over_k(i));
            }
            SeriesRule::OneAndSquare { sign } => {
                self.convolve(own, [a, helper], later, over_k);
                self.convolve(helper, [own, own], (0..k + 1, k), |_| sign);
            }
            SeriesRule::OverOneAndSquare => {
                self.convolve(helper, [a, a], (0..k + 1, k), |_| 1.0);
                let moved = |i: usize| -over_k(i);
                self.divide((own, helper), Some(a), [own, helper], (1..k, k), moved);
            }
            SeriesRule::OverRoot => {
                let moved = |i: usize| -over_k(i);
                self.divide((own, helper), Some(a), [own, helper], (1..k, k), moved);
                self.convolve(helper, [own, a], later, moved);
            }
        }
    }

    /// An operand of a power that has no series at zero is zero where it is rounding of its terms, as at a switch.
    #[inline(always)]
    fn round_to_zero(&mut self, step: &ProgramStep, a: usize) {
        if step.rule.ends_at_zero() {
            let terms = step.operands[0].terms.iter();
            let sizes = terms.map(|(c, by)| (by.value * self.value(*c, 0)).abs());
            if self.value(a, 0).abs() <= ROUNDING * sizes.sum::<f64>() {
                self.set(a, 0, 0.0);
            }
        }
    }
}

/// How many components are found with that of a rule.
fn helpers(rule: Rule) -> usize {
    let Rule::Function(function) = rule else {
        return 0;
    };
    match function.series_rule() {
        SeriesRule::Pair { .. }
        | SeriesRule::OneAndSquare { .. }
        | SeriesRule::OverOneAndSquare
        | SeriesRule::OverRoot => 1,
        SeriesRule::RelativeExponential => quotients::OF_EXPREL,
        SeriesRule::Logistic => quotients::OF_LOGISTIC,
        _ => 0,
    }
}

impl Series {
    /// The series from z up to an order, with derivatives where they are asked for.
    pub(super) fn new(
        recurrences: Recurrences,
        z: &Vector,
        order: usize,
        derivatives: bool,
    ) -> Series {
        let beginning = SeriesBeginning {
            recurrences,
            z,
            orders: order + 1,
            derivatives,
        };
        Series {
            size: recurrences.base + recurrences.steps.len(),
            base: recurrences.base,
            states: recurrences.states,
            table: Arc::new(pulp::Arch::new().dispatch(beginning)),
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

/// From where recurrences go on, and how far.
struct SeriesBeginning<'a> {
    recurrences: Recurrences<'a>,
    z: &'a Vector,
    orders: usize,
    derivatives: bool,
}

impl pulp::WithSimd for SeriesBeginning<'_> {
    type Output = CoefficientTable;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> CoefficientTable {
        self.recurrences
            .table(self.z, self.orders, self.derivatives)
    }
}

impl Recurrences<'_> {
    /// The table of so many orders.
    #[inline(always)]
    fn table(&self, z: &Vector, orders: usize, derivatives: bool) -> CoefficientTable {
        let Places { operands, count } = self.places;
        let components = self.base + self.steps.len();
        let found_with: usize = self.steps.iter().map(|step| helpers(step.rule)).sum();
        let size = [orders, count + found_with];
        let lanes = [self.inner(), self.parameters];
        let mut table = CoefficientTable::new(size, lanes, derivatives);
        self.begin(z, &mut table);
        for k in 0..orders {
            // what is found with a component comes after all others
            let mut helper = *count;
            for (index, step) in self.steps.iter().enumerate() {
                if self.needed[index] {
                    let around = Around {
                        components,
                        a: operands[index][0],
                        b: operands[index][1],
                        own: self.base + index,
                        helper,
                        extends: self.flow[index],
                    };
                    let sign = self.signs.get(index).copied().unwrap_or(0.0);
                    table.step(step, around, k, sign);
                }
                helper += helpers(step.rule);
            }
            if k + 1 < orders {
                let moving = self.rates.iter().enumerate();
                for (c, rate) in moving.filter(|(_, rate)| !rate.terms.is_empty()) {
                    table.gather(c, rate, (k, k + 1), ((k + 1) as f64).recip());
                }
            }
        }
        table.check();
        table
    }

    /// In how much of what z is made of there are derivatives: cosines and sines follow from the phase, and what stays 1 has none.
    fn inner(&self) -> usize {
        self.states + usize::from(self.base > self.states + 1)
    }

    /// Puts what is made of nothing else at the beginning.
    fn begin(&self, z: &Vector, table: &mut CoefficientTable) {
        for c in 0..self.base {
            table.set(c, 0, kept(z[c]));
        }
        if table.groups > 0 {
            let states = self.states;
            (0..states).for_each(|state| *table.derivative_mut(state, 0, state) = 1.0);
            for (h, cosine) in (1..).zip((states + 1..self.base).step_by(2)) {
                let h = f64::from(h);
                *table.derivative_mut(cosine, 0, states) = -h * z[cosine + 1];
                *table.derivative_mut(cosine + 1, 0, states) = h * z[cosine];
            }
        }
    }
}

impl Series {
    /// Derivatives of the coefficient of this order of a component in the states, and in the phase where there is one.
    pub(super) fn by_inner(&self, k: usize, c: usize) -> impl Iterator<Item = f64> {
        (0..self.table.inner).map(move |lane| self.table.derivative(c, k, lane))
    }

    /// Derivatives in the components of z before the terms, from those in states and phase, put by their place: of the first cosine and
    /// sine what makes that in the phase, along which alone they move.
    fn spread(&self, lane: impl Fn(usize) -> f64, mut put: impl FnMut(usize, f64)) {
        (0..self.states).for_each(|state| put(state, lane(state)));
        if self.table.inner > self.states {
            let (cosine, sine) = (self.states + 1, self.states + 2);
            let by_phase = lane(self.states);
            put(cosine, -by_phase * self.value(0, sine));
            put(sine, by_phase * self.value(0, cosine));
        }
    }

    /// Derivative in a parameter.
    fn by_parameter(&self, lane: impl Fn(usize) -> f64, parameter: usize) -> f64 {
        match parameter < self.table.parameters {
            true => lane(self.table.inner + parameter),
            false => 0.0,
        }
    }

    /// Coefficient of this order of a component.
    pub fn value(&self, k: usize, c: usize) -> f64 {
        self.table.value(c, k)
    }

    /// Coefficients of all orders of a component.
    pub(super) fn values(&self, c: usize) -> &[f64] {
        self.table.values(c)
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
        self.table.is_finite
    }

    /// Coefficient of this order of the first operand of a step.
    pub(super) fn operand(&self, k: usize, step: usize) -> f64 {
        self.value(k, self.places[step][0])
    }

    /// Coefficients of all orders of the first operand of a step.
    pub(super) fn operands(&self, step: usize) -> &[f64] {
        self.values(self.places[step][0])
    }

    /// An operand of a step at the beginning, and the sum of the sizes of its further terms over a length of these powers.
    pub(super) fn of_operand(&self, (step, operand): (usize, usize), powers: &[f64]) -> (f64, f64) {
        let place = self.places[step][operand];
        (self.value(0, place), self.change(place, powers))
    }

    /// Bounds of the first operand of a step over a length of these powers in a direction, and what it is at the beginning: over it every
    /// term grows from nothing.
    pub(super) fn bounds_of_operand(
        &self,
        step: usize,
        powers: &[f64],
        direction: f64,
    ) -> [f64; 3] {
        let terms = self.operands(step).iter().zip(powers).enumerate();
        let terms = terms.map(|(k, (a, power))| a * power * direction.powi(k as i32));
        let first = self.operand(0, step);
        let (low, high) = terms.skip(1).fold((first, first), |(low, high), term| {
            (low + term.min(0.0), high + term.max(0.0))
        });
        [low, high, first]
    }

    /// The sum of the sizes of the terms of a component but for the first, over a length of these powers.
    pub(super) fn change(&self, c: usize, powers: &[f64]) -> f64 {
        let terms = self.values(c).iter().zip(powers).skip(1);
        terms.map(|(z, power)| z.abs() * power).sum()
    }

    /// The largest of its terms.
    pub(super) fn largest(&self, c: usize, powers: &[f64]) -> f64 {
        let orders = self.values(c).iter().zip(powers);
        orders.fold(0.0, |most: f64, (z, power)| most.max(z.abs() * power))
    }

    /// Order of the first coefficient of the first operand of a step that is not zero but for rounding.
    pub(super) fn first_order(&self, steps: &[ProgramStep], index: usize) -> usize {
        let counts = |k: &usize| {
            let terms = steps[index].operands[0].terms.iter();
            let size: f64 = terms
                .map(|(c, by)| match k {
                    0 => by.value.abs() * self.size_of(steps, *c),
                    k => (by.value * self.value(*k, *c)).abs(),
                })
                .sum();
            self.operand(*k, index).abs() > KINK * size
        };
        (0..=self.order()).find(counts).unwrap_or(self.order())
    }

    /// The size of a component at the beginning, or of what its rounding follows from: sin x at π has that of x.
    fn size_of(&self, steps: &[ProgramStep], c: usize) -> f64 {
        let own = self.value(0, c).abs();
        let Some(index) = c.checked_sub(self.base) else {
            return own;
        };
        let of = |operand: &Sparse| -> f64 {
            let terms = operand.terms.iter();
            let sizes = terms.map(|(c, by)| by.value.abs() * self.size_of(steps, *c));
            sizes.sum()
        };
        let ProgramStep { rule, operands } = &steps[index];
        let [a, b] = self.places[index].map(|place| self.value(0, place));
        match rule {
            Rule::Product => operands.iter().map(of).product(),
            Rule::Quotient => of(&operands[0]) / b.abs(),
            Rule::Power(r) => own.max((r * a.powf(r - 1.0)).abs() * of(&operands[0])),
            Rule::Function(function) => own.max(function.at(a).1.abs() * of(&operands[0])),
        }
    }

    /// The sign of that operand just after the beginning, or just before it.
    pub(super) fn first_sign(&self, steps: &[ProgramStep], index: usize, direction: f64) -> f64 {
        let k = self.first_order(steps, index);
        (self.operand(k, index) * direction.powi(k as i32)).signum()
    }

    /// z at a time after the beginning, without what is made of other components: that follows from these.
    pub fn at(&self, time: f64) -> Vector {
        let mut z = Vector::zeros(self.size);
        for (c, z) in z.as_mut_slice()[..self.base].iter_mut().enumerate() {
            let orders = self.values(c).iter().rev();
            *z = orders.fold(0.0, |sum, z| sum * time + z);
        }
        z
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
        let (groups, sums) = (self.table.groups, self.table.derivatives_at(count, time));
        for c in 0..count {
            let lane = |lane: usize| sums[c * groups + lane / TOGETHER][lane % TOGETHER];
            self.spread(lane, |column, x| at[(c, column)] = x);
            for (parameter, by) in by.iter_mut().enumerate() {
                by[c] = self.by_parameter(lane, parameter);
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
            let lane = |lane: usize| self.table.derivative(index, k, lane);
            self.spread(lane, |place, by| by_z[place] += c * by);
            for (by, place) in by.iter_mut().zip(places) {
                *by += c * self.by_parameter(lane, place);
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
