//! Taylor series in time of the motion of a mode whose rates are not affine, with their derivatives.
//!
//! Every product, quotient and function is a component u of z of its own, so that rates, guards and resets are
//! linear rows of z as those of an affine mode are: ẋ = Mz, and u follows from its operands, which are rows too.
//! [`super::recurrence`] finds the coefficients of a series order by order.

use std::sync::Arc;

use super::coefficients::Sparse;
use super::dual::Dual;
use super::expression::Function;
use super::form::Rule;
use super::hyperdual::HyperDual;
use super::program::Program;
use super::recurrence::{Places, Recurrences, Series};
use super::rows::{MatrixBy, Row};
use crate::interval::Interval;
use crate::linalg::Vector;
use crate::orbit::sign::{Bernstein, COEFFICIENTS};

/// Highest order of a series: two more than what signs are decided by, so that these know what they leave out.
pub(super) const ORDER: usize = COEFFICIENTS + 1;

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
    /// Where coefficients stand.
    places: Places,
    /// How many of the parameters that vary have to do with it: the first, if any, or both.
    parameters: usize,
    /// Whether the mode has to do with none of them.
    pub is_exact: bool,
    /// Part of a component of z by which the terms of degree 17 may change it over a piece.
    tolerance: f64,
}

impl Default for Field {
    /// That of a mode without such components.
    fn default() -> Field {
        Field {
            program: Arc::default(),
            needed: Vec::new(),
            at_switch: Vec::new(),
            rates: Vec::new(),
            places: Places::default(),
            parameters: 0,
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
        let entry = |row: usize, c: usize| {
            let by = matrix.by.each_ref().map(|by| by[(row, c)]);
            Dual::new(matrix.at[(row, c)], by)
        };
        let is_exact = !integrated && !at_switch.contains(&true);
        let rate = |row| Sparse::new((0..program.size()).map(|c| (c, entry(row, c))));
        let rates: Vec<Sparse> = match needed.is_empty() && !integrated {
            true => Vec::new(),
            false => (0..base).map(rate).collect(),
        };
        let operands = program.steps.iter().flat_map(|step| &step.operands);
        let parameters = operands.chain(&rates).map(|form| form.parameters).max();
        Field {
            places: Places::new(&program.steps, program.base),
            rates,
            parameters: parameters.unwrap_or(0),
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
            *z = self.run(&self.needed, z, 0, false, &[]).first();
        }
    }

    /// The same for the components that conditions and resets are made of, too: what makes no sense has no value.
    pub fn complete_at_switch(&self, z: &mut Vector) {
        if self.ends_by_more() {
            *z = self.run(&self.at_switch, z, 0, false, &[]).first();
        }
    }

    /// Appends every component of z that is made of others where those before it lie in intervals: all numbers where
    /// the mode has nothing to do with it.
    pub fn enclose(&self, z: &mut Vec<Interval>) {
        for (step, needed) in self.program.steps.iter().zip(&self.needed) {
            let operand = |operand: &Sparse| {
                let terms = operand.terms.iter();
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

    /// Appends every component of z that is made of others, with its derivatives along the directions of those before them;
    /// zero where the mode has nothing to do with it. `signs` are those of the operands of `abs`, by the number of its step, where they are
    /// known.
    pub(super) fn differentiate(&self, z: &mut Vec<HyperDual>, signs: &[f64]) {
        let signs = signs.iter().copied().chain(std::iter::repeat(0.0));
        let steps = self.program.steps.iter().zip(&self.needed);
        for ((step, needed), sign) in steps.zip(signs) {
            let operand = |operand: &Sparse| {
                let mut sum = HyperDual::default();
                let terms = operand.terms.iter();
                terms.for_each(|(c, by)| sum.add(by.value, &z[*c]));
                sum
            };
            let made = match needed {
                true if sign != 0.0 => {
                    let mut made = HyperDual::default();
                    made.add(sign, &operand(&step.operands[0]));
                    made
                }
                true => {
                    let [a, b] = step.operands.each_ref().map(operand);
                    HyperDual::by_rule(step.rule, &a, &b)
                }
                false => HyperDual::default(),
            };
            z.push(made);
        }
    }

    /// The operands of `abs` that the mode has to do with, as rows of z, each with the number of its step.
    pub(super) fn kinks(&self) -> impl Iterator<Item = (usize, Vec<f64>)> {
        let abs = Rule::Function(Function::Abs);
        let steps = self.program.steps.iter().zip(&self.needed).enumerate();
        let kinks = steps.filter(move |(_, (step, needed))| **needed && step.rule == abs);
        kinks.map(|(index, (step, _))| {
            let mut row = vec![0.0; self.program.size()];
            for (c, by) in &step.operands[0].terms {
                row[*c] += by.value;
            }
            (index, row)
        })
    }

    /// The series of z with its derivatives, up to an order.
    pub fn series(&self, z: &Vector, order: usize, derivatives: bool, forward: bool) -> Series {
        self.series_of(&self.needed, z, order, derivatives, forward)
    }

    /// The values of z with their derivatives, of all that these forms have to do with, too: they may come from the mode before.
    pub fn values_for(&self, forms: &[Row], z: &Vector) -> Series {
        let base = self.program.base;
        let occurs = |index: usize| forms.iter().any(|form| form.has(base + index));
        let mut needed: Vec<bool> = (0..self.program.made()).map(occurs).collect();
        let own = needed.iter_mut().zip(&self.needed);
        own.for_each(|(needed, own)| *needed |= own);
        self.program.complete(&mut needed);
        self.series_of(&needed, z, 0, true, true)
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
                    *sign = series.first_sign(&self.program.steps, index, direction);
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
        let recurrences = Recurrences {
            steps: &self.program.steps,
            needed,
            rates: &self.rates,
            places: &self.places,
            signs,
            base: self.program.base,
            states: self.program.states,
            parameters: self.parameters,
        };
        Series::new(recurrences, z, order, derivatives)
    }

    /// Sizes of the components of z, of a product those of the terms that it multiplies: where they cancel, it has their rounding.
    pub fn sizes(&self, z: &Vector) -> Vec<f64> {
        let base = z.len() - self.program.made();
        let mut sizes: Vec<f64> = z.iter().take(base).map(|z| z.abs()).collect();
        for (index, step) in self.program.steps.iter().enumerate() {
            let of = |operand: &Sparse| -> f64 {
                let terms = operand.terms.iter();
                terms.map(|(c, by)| by.value.abs() * sizes[*c]).sum()
            };
            let size = match step.rule {
                Rule::Product => step.operands.iter().map(of).product(),
                _ => z[base + index].abs(),
            };
            sizes.push(size);
        }
        sizes
    }

    /// Sum of the terms of which the rate of a form is made at the beginning of a series: where they cancel, it has
    /// their rounding.
    pub fn size_of_rate(&self, series: &Series, form: &Vector) -> f64 {
        let of = |(c, rate): (usize, &Sparse)| -> f64 {
            let terms = rate.terms.iter();
            let size: f64 = terms
                .map(|(j, by)| (by.value * series.value(0, *j)).abs())
                .sum();
            form[c].abs() * size
        };
        let rates = self.rates.iter().enumerate();
        rates.filter(|(c, _)| form[*c] != 0.0).map(of).sum()
    }

    /// What rounding of the terms of its rate leaves in an order of a state; zero of other components.
    fn rounding_of_order(&self, series: &Series, component: usize, order: usize) -> f64 {
        let terms = self
            .rates
            .get(component)
            .map_or(&[][..], |rate| &rate.terms);
        let size = terms
            .iter()
            .map(|(j, by)| (by.value * series.values(*j)[order - 1]).abs());
        2.0 * f64::EPSILON * size.sum::<f64>() / order as f64
    }

    /// Sizes of the terms of which a product is made, over a length of these powers: where they cancel, as in x(μ − x² − y²) on
    /// the circle, the product has their rounding. Zero of other components.
    fn size_of_product(&self, series: &Series, component: usize, powers: &[f64; ORDER + 1]) -> f64 {
        let step = component.checked_sub(self.program.base);
        let step = step.map(|index| &self.program.steps[index]);
        let Some(step) = step.filter(|step| step.rule == Rule::Product) else {
            return 0.0;
        };
        let largest = |j: usize| {
            let orders = series.values(j).iter().zip(powers);
            orders.fold(0.0, |most: f64, (z, power)| most.max(z.abs() * power))
        };
        let of = |operand: &Sparse| -> f64 {
            let terms = operand.terms.iter();
            terms.map(|(j, by)| by.value.abs() * largest(*j)).sum()
        };
        step.operands.iter().map(of).product()
    }

    /// Components before those that are made of others.
    pub fn base(&self) -> usize {
        self.program.base
    }

    /// How long the polynomial of degree 16 holds for z, and at most: until it has left out as much as the tolerance
    /// allows, or until an operand of `abs` changes its sign.
    pub fn length(&self, series: &Series, longest: f64, forward: bool) -> f64 {
        /// Products of the tolerance with what is smaller are none, and have no digits left: a square of a state that has died out.
        const LOST: f64 = f64::MIN_POSITIVE / (f64::EPSILON * f64::EPSILON);
        let base = self.program.base;
        let counts = |c: &usize| *c < base || self.needed[*c - base];
        // a number that is none has no greatest and no least
        if !series.is_finite() {
            return f64::NAN;
        }
        let mut length = longest;
        let mut powers = self::powers(length);
        for c in (0..series.size()).filter(counts) {
            let z = series.values(c);
            for last in [COEFFICIENTS, COEFFICIENTS + 1] {
                let tail = z[last].abs();
                // |z_K|hᴷ is at most the allowed part of |z_j|hʲ for one j: most components hold as long as others
                let holds = |j: usize| tail * powers[last - j] <= self.tolerance * z[j].abs();
                // a state whose rate vanishes but for rounding, as that across a surface, has no order of its own
                let rounding = || self.rounding_of_order(series, c, last);
                if tail > LOST && !(0..last).any(holds) && tail > rounding() {
                    let first = z[0].abs().max(self.size_of_product(series, c, &powers));
                    let own = |j: usize| if j == 0 { first } else { z[j].abs() };
                    let allowed = |j: usize| self.tolerance * own(j) / tail;
                    length = length.min(longest_of(allowed, last));
                    powers = self::powers(length);
                }
            }
        }
        if series.has_derivatives() {
            length = self.length_of_derivatives(series, length);
        }
        let direction = if forward { 1.0 } else { -1.0 };
        for (index, step) in self.program.steps.iter().enumerate() {
            if step.rule == Rule::Function(Function::Abs) && self.needed[index] {
                let sign = series.signs[index];
                let mut taylor: [f64; COEFFICIENTS] = std::array::from_fn(|k| {
                    sign * series.operand(k, index) * (direction * length).powi(k as i32)
                });
                let order = series.first_order(&self.program.steps, index);
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
        let largest = |l: usize| {
            let (mut power, mut size) = (1.0, 0.0_f64);
            for z in &series.values(l)[..=COEFFICIENTS] {
                size = size.max(z.abs() * power);
                power *= longest;
            }
            size
        };
        // the phase moves by a radian, as cosines and sines do by their size
        let states = (0..self.program.states).map(largest);
        let moved: Vec<f64> = states.chain([1.0]).collect();
        let (mut length, mut powers) = (longest, powers(longest));
        for c in 0..base {
            let size = |j: usize| {
                let lanes = series.by_inner(j, c).zip(&moved);
                lanes.fold(0.0_f64, |most, (by, size)| most.max(by.abs() * size))
            };
            for last in [COEFFICIENTS, COEFFICIENTS + 1] {
                let tail = size(last);
                let long = |own: f64| tail * powers[last] <= left_out * own;
                // the first order is enough for most
                if tail > 0.0 && !long(series.value(0, c).abs()) && !long(largest(c)) {
                    let allowed = |j: usize| left_out * size(j) / tail;
                    length = length.min(longest_of(allowed, last));
                    powers = self::powers(length);
                }
            }
        }
        length
    }
}

/// 1, h, h², … up to the highest order.
fn powers(h: f64) -> [f64; ORDER + 1] {
    let mut next = 1.0;
    std::array::from_fn(|_| {
        let power = next;
        next *= h;
        power
    })
}

/// The largest length h with h^{last−j} ≤ allowed(j) for one j at least.
fn longest_of(allowed: impl Fn(usize) -> f64, last: usize) -> f64 {
    let (mut most, mut powers) = (0.0_f64, powers(0.0));
    for j in 0..last {
        let (allowed, power) = (allowed(j), last - j);
        // most orders allow less than another, and roots are slow
        if allowed > powers[power] {
            most = allowed.powf((power as f64).recip()).max(most);
            powers = self::powers(most);
        }
    }
    most
}
