//! Taylor series in time of the motion of a mode whose rates are not affine, with their derivatives.
//!
//! Every product, quotient and function is a component u of z of its own, so that rates, guards and resets are
//! linear rows of z as those of an affine mode are: ẋ = Mz, and u follows from its operands, which are rows too.
//! The coefficients of a series are found order by order: those of u from the well-known recurrences, those of
//! the states from their rates. A coefficient carries its derivatives along.

use std::collections::HashMap;
use std::sync::Arc;

use super::expression::Function;
use super::form::{Coefficient, Dual, Form, Rule, Term, VARYING};
use super::rows::{MatrixBy, Row};
use crate::interval::Interval;
use crate::linalg::{Matrix, Vector};
use crate::orbit::sign::{Bernstein, COEFFICIENTS};

/// Highest order of a series: two more than what signs are decided by, so that these know what they leave out.
pub(super) const ORDER: usize = COEFFICIENTS + 1;

/// An operand of `abs` that is smaller than this part of its terms is zero: the next coefficient has its sign.
const KINK: f64 = 1e-12;

/// Whole exponents up to this are products of intervals.
const MOST_FACTORS: f64 = 64.0;

/// A linear form of z with few terms.
#[derive(Clone, Debug, Default, PartialEq)]
struct Sparse(Vec<(usize, Dual)>);

/// A component of z that is made of others.
#[derive(Clone, Debug, PartialEq)]
struct Step {
    rule: Rule,
    operands: [Sparse; 2],
}

/// How the components of z beyond states and phase are made, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Components before them: states, 1, cosines and sines.
    base: usize,
    steps: Vec<Step>,
}

/// Where the terms of forms stand in z.
pub(super) struct Terms {
    states: usize,
    program: Program,
    known: HashMap<*const Term, usize>,
}

impl Terms {
    /// For z of so many states, and cosines and sines of so many multiples of the phase.
    pub fn new(states: usize, harmonics: usize) -> Terms {
        let program = Program {
            base: states + 1 + 2 * harmonics,
            steps: Vec::new(),
        };
        Terms {
            states,
            program,
            known: HashMap::new(),
        }
    }

    /// Takes in every term of a form.
    pub fn add(&mut self, form: &Form) {
        for (_, term) in &form.beyond {
            if self.known.contains_key(&Arc::as_ptr(term)) {
                continue;
            }
            term.operands.iter().for_each(|operand| self.add(operand));
            let operands = term.operands.each_ref().map(|operand| self.sparse(operand));
            let step = Step {
                rule: term.rule,
                operands,
            };
            let steps = &mut self.program.steps;
            let index = steps.iter().position(|known| *known == step);
            let index = index.unwrap_or_else(|| {
                steps.push(step);
                steps.len() - 1
            });
            self.known
                .insert(Arc::as_ptr(term), self.program.base + index);
        }
    }

    /// The coefficients of a form whose terms have been taken in, each with its component of z.
    pub fn coefficients<'a>(&'a self, form: &'a Form) -> impl Iterator<Item = (usize, Dual)> + 'a {
        let states = form.states.iter().copied().enumerate();
        let harmonics = form.harmonics.iter().flatten();
        let after = [&form.constant].into_iter().chain(harmonics).copied();
        let after = after.enumerate().map(|(index, c)| (self.states + index, c));
        let beyond = form.beyond.iter();
        let beyond = beyond.map(|(c, term)| (self.known[&Arc::as_ptr(term)], *c));
        states.chain(after).chain(beyond)
    }

    fn sparse(&self, form: &Form) -> Sparse {
        let mut terms: Vec<(usize, Dual)> = Vec::new();
        for (index, c) in self.coefficients(form) {
            match terms.iter_mut().find(|(known, _)| *known == index) {
                Some((_, sum)) => *sum = sum.sum(1.0, c, 1.0),
                None => terms.push((index, c)),
            }
        }
        terms.retain(|(_, c)| *c != Dual::default());
        Sparse(terms)
    }

    /// How all of them are made.
    pub fn program(&self) -> &Program {
        &self.program
    }
}

impl Program {
    /// Length of z.
    pub fn size(&self) -> usize {
        self.base + self.steps.len()
    }

    /// Whether a component is made of any of these states.
    pub fn depends(&self, component: usize, states: &[usize]) -> bool {
        let mut open = vec![component];
        let mut seen = vec![false; self.size()];
        while let Some(c) = open.pop() {
            if states.contains(&c) {
                return true;
            }
            if c >= self.base && !std::mem::replace(&mut seen[c], true) {
                let operands = self.steps[c - self.base].operands.iter();
                open.extend(operands.flat_map(|operand| &operand.0).map(|(c, _)| *c));
            }
        }
        false
    }

    /// Marks also those components of which the marked ones are made.
    fn complete(&self, needed: &mut [bool]) {
        for (index, step) in self.steps.iter().enumerate().rev() {
            if needed[index] {
                let terms = step.operands.iter().flat_map(|operand| &operand.0);
                let inner = terms.filter_map(|(c, _)| c.checked_sub(self.base));
                inner.for_each(|inner| needed[inner] = true);
            }
        }
    }

    /// Whether another differs in the values of coefficients only.
    pub fn has_same_shape(&self, other: &Program) -> bool {
        let alike = |(one, other): (&Sparse, &Sparse)| {
            let [one, other] = [one, other].map(|sparse| sparse.0.iter().map(|(c, _)| c));
            one.eq(other)
        };
        let mut steps = self.steps.iter().zip(&other.steps);
        (self.base, self.made()) == (other.base, other.made())
            && steps.all(|(one, other)| {
                let mut operands = one.operands.iter().zip(&other.operands);
                one.rule == other.rule && operands.all(alike)
            })
    }

    /// Whether one of them is an `abs`: what is zero may be another on its other side.
    pub fn has_kinks(&self) -> bool {
        let abs = Rule::Function(Function::Abs);
        self.steps.iter().any(|step| step.rule == abs)
    }

    /// How many components of z are made of others.
    pub fn made(&self) -> usize {
        self.steps.len()
    }
}

impl Sparse {
    fn new(at: impl Iterator<Item = (usize, Dual)>) -> Sparse {
        Sparse(at.filter(|(_, c)| *c != Dual::default()).collect())
    }
}

impl Rule {
    /// Its value where the operands lie in intervals.
    fn enclose(self, a: Interval, b: impl Fn() -> Interval) -> Interval {
        let one = Interval::ONE;
        match self {
            Rule::Product => a * b(),
            Rule::Quotient => a / b(),
            Rule::Power(2.0) => a.square(),
            Rule::Power(r) if r.fract() == 0.0 && r.abs() <= MOST_FACTORS => {
                let factors = 0..r.abs() as usize;
                let power = factors.fold(one, |power, _| power * a);
                if r < 0.0 { one / power } else { power }
            }
            Rule::Power(r) => (Interval::point(r) * a.ln()).exp(),
            Rule::Function(function) => match function {
                Function::Sin => a.sin(),
                Function::Cos => a.cos(),
                Function::Tan => a.sin() / a.cos(),
                Function::Exp => a.exp(),
                Function::Ln => a.ln(),
                Function::Sqrt => a.sqrt(),
                Function::Abs if a.low >= 0.0 => a,
                Function::Abs if a.high <= 0.0 => -a,
                Function::Abs => Interval::new(0.0, a.magnitude()),
                Function::Tanh => one - Interval::point(2.0) / ((a + a).exp() + one),
            },
        }
    }
}

/// How z moves in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    program: Arc<Program>,
    /// Which components beyond states and phase the mode has to do with along its flow: others may have no value in it.
    needed: Vec<bool>,
    /// The same at the instants at which it ends, where conditions and resets count, too.
    at_switch: Vec<bool>,
    /// Rates of the components before them; none where everything is linear.
    rates: Vec<Sparse>,
    /// Whether the mode has to do with none of them.
    pub is_exact: bool,
    /// Part of a component of z by which the terms of degree 17 may change it over a piece.
    tolerance: f64,
}

/// Coefficients of z in time, and of what it is made of.
#[derive(Clone, Debug)]
pub struct Series {
    /// Numbers of a coefficient: its value, then its derivatives in z at the beginning and in the parameters.
    lanes: usize,
    /// Components of z, and of them those before the terms.
    size: usize,
    base: usize,
    /// Numbers of all coefficients of one order.
    width: usize,
    order: usize,
    data: Vec<f64>,
    /// Signs of the operands of `abs`.
    signs: Vec<f64>,
    /// Which of the parameters derivatives are asked for.
    parameter: usize,
}

impl Default for Field {
    /// That of a mode without such components.
    fn default() -> Field {
        Field {
            program: Arc::default(),
            needed: Vec::new(),
            at_switch: Vec::new(),
            rates: Vec::new(),
            is_exact: true,
            tolerance: 0.0,
        }
    }
}

impl Field {
    /// The field of a mode with this matrix, of which some rows are looked at along the flow, and others where it ends.
    pub fn new(
        program: &Arc<Program>,
        matrix: &MatrixBy,
        (along, at_end): (impl Iterator<Item = Row>, impl Iterator<Item = Row>),
        (tolerance, integrated): (f64, bool),
    ) -> Field {
        let base = program.base;
        let mut needed = vec![false; program.made()];
        let mut at_switch = needed.clone();
        if program.made() > 0 {
            let take = |row: Row, needed: &mut [bool]| {
                for (index, needed) in needed.iter_mut().enumerate() {
                    *needed |= row.has(base + index);
                }
            };
            let rates = (0..base).map(|row| matrix.row(row));
            rates.chain(along).for_each(|row| take(row, &mut needed));
            program.complete(&mut needed);
            at_switch.clone_from(&needed);
            at_end.for_each(|row| take(row, &mut at_switch));
            program.complete(&mut at_switch);
        }
        let entry = |row: usize, c: usize| Dual {
            value: matrix.at[(row, c)],
            by: matrix.by.each_ref().map(|by| by[(row, c)]),
        };
        let is_exact = !integrated && !at_switch.contains(&true);
        let rate = |row| Sparse::new((0..program.size()).map(|c| (c, entry(row, c))));
        Field {
            rates: if needed.is_empty() && !integrated {
                Vec::new()
            } else {
                (0..base).map(rate).collect()
            },
            program: program.clone(),
            is_exact,
            needed,
            at_switch,
            tolerance,
        }
    }

    /// Makes the components that a form has, too.
    pub fn watch(&mut self, form: &Vector) {
        for needed in [&mut self.needed, &mut self.at_switch] {
            for (index, needed) in needed.iter_mut().enumerate() {
                *needed |= form[self.program.base + index] != 0.0;
            }
            self.program.complete(needed);
        }
        self.is_exact &= !self.needed.contains(&true);
    }

    /// Whether the rates of the first components, so many, depend on the phase, in the mode with this matrix.
    pub fn is_forced(&self, matrix: &MatrixBy, states: usize) -> bool {
        let phases: Vec<usize> = (states + 1..self.program.base).collect();
        let occurs = |c: usize| (0..states).any(|row| matrix.row(row).has(c));
        let mut components = (0..self.program.size()).filter(|c| occurs(*c));
        components.any(|c| self.program.depends(c, &phases))
    }

    /// Gives every component of z that is made of others, and that the flow has to do with, its value.
    pub fn complete(&self, z: &mut Vector) {
        if !self.is_exact {
            let series = self.run(&self.needed, z, 0, false, &[]);
            z.copy_from_slice(&series.data[..self.program.size()]);
        }
    }

    /// The same for the components that conditions and resets are made of, too: what makes no sense has no value.
    pub fn complete_at_switch(&self, z: &mut Vector) {
        if self.ends_by_more() {
            let series = self.run(&self.at_switch, z, 0, false, &[]);
            z.copy_from_slice(&series.data[..self.program.size()]);
        }
    }

    /// Appends every component of z that is made of others where those before it lie in intervals: all numbers where
    /// the mode has nothing to do with it.
    pub fn enclose(&self, z: &mut Vec<Interval>) {
        for (step, needed) in self.program.steps.iter().zip(&self.needed) {
            let operand = |operand: &Sparse| {
                let terms = operand.0.iter();
                terms.fold(Interval::ZERO, |sum, (c, by)| {
                    sum + Interval::point(by.value) * z[*c]
                })
            };
            let value = match needed {
                true => step
                    .rule
                    .enclose(operand(&step.operands[0]), || operand(&step.operands[1])),
                false => Interval::ENTIRE,
            };
            z.push(value);
        }
    }

    /// The series of z with its derivatives, up to an order.
    pub fn series(&self, z: &Vector, order: usize, derivatives: bool, forward: bool) -> Series {
        self.series_of(&self.needed, z, order, derivatives, forward)
    }

    /// The same with what conditions and resets are made of, where the mode ends.
    pub fn series_at_switch(&self, z: &Vector, order: usize, forward: bool) -> Series {
        self.series_of(&self.at_switch, z, order, true, forward)
    }

    /// Whether conditions and resets are made of more than the flow.
    pub fn ends_by_more(&self) -> bool {
        self.at_switch != self.needed
    }

    fn series_of(
        &self,
        needed: &[bool],
        z: &Vector,
        order: usize,
        derivatives: bool,
        forward: bool,
    ) -> Series {
        let direction = if forward { 1.0 } else { -1.0 };
        let has_kinks = || {
            let steps = self.program.steps.iter().zip(needed);
            let abs = Rule::Function(Function::Abs);
            steps
                .filter(|(step, needed)| **needed && step.rule == abs)
                .count()
                > 0
        };
        if !has_kinks() {
            return self.run(needed, z, order, derivatives, &[]);
        }
        // the sign of an operand that is zero here is that of its first coefficient that is not
        let mut signs = vec![0.0; self.program.made()];
        loop {
            let series = self.run(needed, z, order, false, &signs);
            let mut found = false;
            for (index, sign) in signs.iter_mut().enumerate() {
                if needed[index] && *sign == 0.0 {
                    *sign = series.first_sign(self, index, direction);
                    found |= *sign != 0.0;
                }
            }
            if !found {
                return self.run(needed, z, order, derivatives, &signs);
            }
        }
    }

    fn run(
        &self,
        needed: &[bool],
        z: &Vector,
        order: usize,
        derivatives: bool,
        signs: &[f64],
    ) -> Series {
        let Program { base, steps } = &*self.program;
        let (base, size) = (*base, self.program.size());
        let lanes = if derivatives { 1 + base + VARYING } else { 1 };
        let width = lanes * (size + 3 * steps.len());
        let mut series = Series {
            lanes,
            size,
            base,
            width,
            order,
            data: vec![0.0; width * (order + 1)],
            signs: signs.to_vec(),
            parameter: 0,
        };
        for c in 0..base {
            series.data[c * lanes] = z[c];
            if derivatives {
                series.data[c * lanes + 1 + c] = 1.0;
            }
        }
        let mut sum = vec![0.0; lanes];
        for k in 0..=order {
            for (index, step) in steps.iter().enumerate().filter(|(index, _)| needed[*index]) {
                series.step(index, step, k, &mut sum);
            }
            if k < order {
                for (c, rate) in self.rates.iter().enumerate() {
                    series.gather(rate, k, &mut sum);
                    sum.iter_mut().for_each(|x| *x /= (k + 1) as f64);
                    series.put(k + 1, c, &sum);
                }
            }
        }
        series
    }

    /// Sum of the terms of which the rate of a form is made at the beginning of a series: where they cancel, it has
    /// their rounding.
    pub fn size_of_rate(&self, series: &Series, form: &Vector) -> f64 {
        let of = |(c, rate): (usize, &Sparse)| -> f64 {
            let terms = rate.0.iter();
            let size: f64 = terms
                .map(|(j, by)| (by.value * series.value(0, *j)).abs())
                .sum();
            form[c].abs() * size
        };
        let rates = self.rates.iter().enumerate();
        rates.filter(|(c, _)| form[*c] != 0.0).map(of).sum()
    }

    /// Components before those that are made of others.
    pub fn base(&self) -> usize {
        self.program.base
    }

    /// How long the polynomial of degree 16 holds for z, and at most: until it has left out as much as the tolerance
    /// allows, or until an operand of `abs` changes its sign.
    pub fn length(&self, series: &Series, longest: f64, forward: bool) -> f64 {
        let base = self.program.base;
        let counts = |c: &usize| *c < base || self.needed[*c - base];
        // a number that is none has no greatest and no least
        if series.data.iter().any(|x| !x.is_finite()) {
            return f64::NAN;
        }
        let mut length = longest;
        for c in (0..series.size).filter(counts) {
            for last in [COEFFICIENTS, COEFFICIENTS + 1] {
                let tail = series.value(last, c).abs();
                // |z_K|hᴷ is at most the allowed part of |z_j|hʲ for one j: most components hold as long as others
                let mut power = 1.0;
                let mut back = (0..last).rev();
                let long = back.any(|j| {
                    power *= length;
                    tail * power <= self.tolerance * series.value(j, c).abs()
                });
                if tail > 0.0 && !long {
                    let holds = (0..last).map(|j| {
                        let allowed = self.tolerance * series.value(j, c).abs() / tail;
                        allowed.powf(((last - j) as f64).recip())
                    });
                    length = length.min(holds.fold(0.0, f64::max));
                }
            }
        }
        if series.lanes > 1 {
            length = self.length_of_derivatives(series, length);
        }
        let direction = if forward { 1.0 } else { -1.0 };
        for (index, step) in self.program.steps.iter().enumerate() {
            if step.rule == Rule::Function(Function::Abs) && self.needed[index] {
                let sign = series.signs[index];
                let mut taylor: [f64; COEFFICIENTS] = std::array::from_fn(|k| {
                    sign * series.value(k, series.size + 3 * index)
                        * (direction * length).powi(k as i32)
                });
                let order = series.first_order(self, index);
                taylor[..order.min(COEFFICIENTS)].fill(0.0);
                taylor.rotate_left(order.min(COEFFICIENTS));
                if let Some(place) = Bernstein::from_taylor(&taylor, 0.0).first_crossing() {
                    length *= place;
                }
            }
        }
        length
    }
}

impl Field {
    /// How long the polynomials of the derivatives of the components before the terms hold, and at most. A motion on a slow
    /// manifold is smooth however fast perturbations of it decay: where a piece is long for these, their polynomials grow
    /// instead, and of the flow nothing is left.
    ///
    /// What perturbations of the sizes of the components make of one is looked at, against the largest of its own orders.
    fn length_of_derivatives(&self, series: &Series, longest: f64) -> f64 {
        /// How much more may be left out than of the motion, so that no piece is shorter for it where perturbations are as
        /// smooth as the motion.
        const MORE: f64 = 1e3;
        let (base, left_out) = (self.program.base, MORE * self.tolerance);
        let powers = |j: usize| longest.powi(j as i32);
        let sizes: Vec<f64> = (0..base)
            .map(|l| {
                let terms = (0..=COEFFICIENTS).map(|j| series.value(j, l).abs() * powers(j));
                terms.fold(0.0, f64::max)
            })
            .collect();
        let mut length = longest;
        for c in 0..base {
            let size = |j: usize| {
                let lanes = series.get(j, c)[1..=base].iter().zip(&sizes);
                lanes.fold(0.0_f64, |most, (by, size)| most.max(by.abs() * size))
            };
            for last in [COEFFICIENTS, COEFFICIENTS + 1] {
                let tail = size(last);
                let holds = |j: usize| {
                    let allowed = left_out * size(j) / tail;
                    allowed.powf(((last - j) as f64).recip())
                };
                let long = tail * length.powi(last as i32) <= left_out * sizes[c];
                if tail > 0.0 && !long {
                    length = length.min((0..last).map(holds).fold(0.0, f64::max));
                }
            }
        }
        length
    }
}

/// sum += weight·ab, with derivatives.
fn accumulate(sum: &mut [f64], weight: f64, a: &[f64], b: &[f64]) {
    sum[0] += weight * a[0] * b[0];
    for ((sum, a_by), b_by) in sum[1..].iter_mut().zip(&a[1..]).zip(&b[1..]) {
        *sum += weight * (a[0] * b_by + a_by * b[0]);
    }
}

/// sum/b, with derivatives.
fn divide(sum: &mut [f64], b: &[f64]) {
    sum[0] /= b[0];
    let value = sum[0];
    for (sum, b_by) in sum[1..].iter_mut().zip(&b[1..]) {
        *sum = (*sum - value * b_by) / b[0];
    }
}

impl Series {
    /// Coefficient of this order of a component, with derivatives.
    fn get(&self, k: usize, c: usize) -> &[f64] {
        &self.data[k * self.width + c * self.lanes..][..self.lanes]
    }

    /// Coefficient of this order of a component.
    pub fn value(&self, k: usize, c: usize) -> f64 {
        self.data[k * self.width + c * self.lanes]
    }

    fn put(&mut self, k: usize, c: usize, values: &[f64]) {
        self.data[k * self.width + c * self.lanes..][..self.lanes].copy_from_slice(values);
    }

    fn gather(&self, row: &Sparse, k: usize, sum: &mut [f64]) {
        sum.fill(0.0);
        for (c, coefficient) in &row.0 {
            let z = self.get(k, *c);
            for (sum, z) in sum.iter_mut().zip(z) {
                *sum += coefficient.value * z;
            }
            if self.lanes > 1 {
                for (sum, by) in sum[1 + self.base..].iter_mut().zip(coefficient.by) {
                    *sum += by * z[0];
                }
            }
        }
    }

    /// The coefficient of order k of a component that is made of others.
    fn step(&mut self, index: usize, step: &Step, k: usize, sum: &mut [f64]) {
        let first = self.size + 3 * index;
        let (own, [a, b, helper]) = (self.base + index, [first, first + 1, first + 2]);
        for (operand, c) in step.operands.iter().zip([a, b]) {
            self.gather(operand, k, sum);
            self.put(k, c, sum);
        }
        sum.fill(0.0);
        // Σ of weighted products of coefficients of a and of another
        let fold =
            |series: &Series, sum: &mut [f64], other: usize, weight: &dyn Fn(usize) -> f64| {
                for i in 1..=k {
                    accumulate(sum, weight(i), series.get(i, a), series.get(k - i, other));
                }
            };
        let over_k = |i: usize| i as f64 / k as f64;
        let start = |series: &Series, sum: &mut [f64], (value, slope): (f64, f64)| {
            sum.copy_from_slice(series.get(0, a));
            sum[1..].iter_mut().for_each(|by| *by *= slope);
            sum[0] = value;
        };
        let x = self.value(0, a);
        let function = match step.rule {
            Rule::Product => {
                for i in 0..=k {
                    accumulate(sum, 1.0, self.get(i, a), self.get(k - i, b));
                }
                return self.put(k, own, sum);
            }
            Rule::Quotient => {
                sum.copy_from_slice(self.get(k, a));
                for i in 0..k {
                    accumulate(sum, -1.0, self.get(i, own), self.get(k - i, b));
                }
                divide(sum, self.get(0, b));
                return self.put(k, own, sum);
            }
            Rule::Power(_) | Rule::Function(Function::Sqrt) => {
                let r = match step.rule {
                    Rule::Power(r) => r,
                    _ => 0.5,
                };
                if k == 0 {
                    start(self, sum, (x.powf(r), r * x.powf(r - 1.0)));
                } else {
                    fold(self, sum, own, &|i| {
                        (r * i as f64 - (k - i) as f64) / k as f64
                    });
                    divide(sum, self.get(0, a));
                }
                return self.put(k, own, sum);
            }
            Rule::Function(function) => function,
        };
        match function {
            _ if k == 0 && function != Function::Abs => {
                start(self, sum, function.at(x));
                self.put(0, own, sum);
                let value = sum[0];
                match function {
                    Function::Sin => start(self, sum, (x.cos(), -value)),
                    Function::Cos => start(self, sum, (x.sin(), value)),
                    Function::Tan | Function::Tanh => {
                        let sign = if function == Function::Tan { 1.0 } else { -1.0 };
                        sum.iter_mut().for_each(|by| *by *= 2.0 * sign * value);
                        sum[0] = 1.0 + sign * value * value;
                    }
                    _ => {}
                }
                self.put(0, helper, sum);
            }
            Function::Exp => {
                fold(self, sum, own, &over_k);
                self.put(k, own, sum);
            }
            Function::Ln => {
                sum.copy_from_slice(self.get(k, a));
                for i in 1..k {
                    accumulate(sum, -over_k(i), self.get(i, own), self.get(k - i, a));
                }
                divide(sum, self.get(0, a));
                self.put(k, own, sum);
            }
            Function::Sin | Function::Cos => {
                let sign = if function == Function::Sin { 1.0 } else { -1.0 };
                fold(self, sum, helper, &|i| sign * over_k(i));
                self.put(k, own, sum);
                sum.fill(0.0);
                fold(self, sum, own, &|i| -sign * over_k(i));
                self.put(k, helper, sum);
            }
            Function::Tan | Function::Tanh => {
                let sign = if function == Function::Tan { 1.0 } else { -1.0 };
                fold(self, sum, helper, &over_k);
                self.put(k, own, sum);
                sum.fill(0.0);
                for i in 0..=k {
                    accumulate(sum, sign, self.get(i, own), self.get(k - i, own));
                }
                self.put(k, helper, sum);
            }
            Function::Abs | Function::Sqrt => {
                let known = self.signs.get(index).copied().unwrap_or(0.0);
                let sign = if known == 0.0 { x.signum() } else { known };
                sum.copy_from_slice(self.get(k, a));
                sum.iter_mut().for_each(|x| *x *= sign);
                self.put(k, own, sum);
            }
        }
    }

    /// Order of the first coefficient of an operand that is not zero but for rounding.
    fn first_order(&self, field: &Field, index: usize) -> usize {
        let operand = &field.program.steps[index].operands[0];
        let counts = |k: &usize| {
            let terms = operand.0.iter();
            let size: f64 = terms
                .map(|(c, by)| (by.value * self.value(*k, *c)).abs())
                .sum();
            self.value(*k, self.size + 3 * index).abs() > KINK * size
        };
        (0..=self.order).find(counts).unwrap_or(self.order)
    }

    /// The sign of an operand just after the beginning, or just before it.
    fn first_sign(&self, field: &Field, index: usize, direction: f64) -> f64 {
        let k = self.first_order(field, index);
        (self.value(k, self.size + 3 * index) * direction.powi(k as i32)).signum()
    }

    /// z at a time after the beginning.
    pub fn at(&self, time: f64) -> Vector {
        Vector::from_fn(self.size, |c, _| self.horner(c * self.lanes, time))
    }

    fn horner(&self, place: usize, time: f64) -> f64 {
        let orders = (0..=self.order).rev();
        orders.fold(0.0, |sum, k| sum * time + self.data[k * self.width + place])
    }

    /// Derivatives of z at a time in the components before the terms, and in the parameters.
    pub fn derivatives(&self, time: f64) -> (Matrix, [Vector; VARYING]) {
        let lane = |c: usize, lane: usize| self.horner(c * self.lanes + lane, time);
        let at = Matrix::from_fn(self.size, self.base, |row, column| lane(row, 1 + column));
        let by = std::array::from_fn(|parameter| {
            Vector::from_fn(self.size, |row, _| lane(row, 1 + self.base + parameter))
        });
        (at, by)
    }

    /// The same series, of which derivatives in another parameter are asked for.
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

    /// The same for a row of a system in one parameter, with its derivatives in the components of z at the beginning, and in
    /// that parameter.
    pub fn jet(&self, row: &Row, k: usize) -> (f64, Vector, f64) {
        let mut by_z = Vector::zeros(self.size);
        let mut by_parameter = self.of(&row.by[0], k);
        for (index, c) in row.at.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let lanes = self.get(k, index);
            for (by, lane) in by_z.iter_mut().zip(&lanes[1..=self.base]) {
                *by += c * lane;
            }
            by_parameter += c * lanes[1 + self.base + self.parameter];
        }
        (self.of(&row.at, k), by_z, by_parameter)
    }
}
