//! Taylor series in time of the motion of a mode whose rates are not affine, with their derivatives.
//!
//! Every product, quotient and function is a component u of z of its own, so that rates, guards and resets are
//! linear rows of z as those of an affine mode are: ẋ = Mz, and u follows from its operands, which are rows too.
//! [`super::recurrence`] finds the coefficients of a series order by order.

use std::sync::Arc;

use super::algebra::Function;
use super::coefficients::Sparse;
use super::dual::Dual;
use super::form::Rule;
use super::hyperdual::HyperDual;
use super::program::Program;
use super::recurrence::{Places, ProgramStep, Recurrences, Series};
use super::rows::{MatrixBy, Row};
use crate::interval::Interval;
use crate::linalg::Vector;
use crate::orbit::sign::COEFFICIENTS;

/// Highest order of a series: two more than what signs are decided by, so that these know what they leave out.
pub(super) const ORDER: usize = COEFFICIENTS + 1;

/// Part of its terms by which what a power is of may be negative at an orbit or an equilibrium: Newton's method leaves as much.
pub(super) const BEYOND: f64 = 1e-9;

/// How z moves in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub(super) program: Arc<Program>,
    /// Which components beyond states and phase the mode has to do with along its flow: others may have no value in it.
    pub(super) needed: Vec<bool>,
    /// Forms of z that are looked at along it, of those that have such components.
    pub(super) looked_at: Vec<Sparse>,
    /// Which it has to do with at the instants at which it ends, where conditions and resets count, too.
    at_switch: Vec<bool>,
    /// Rates of the components before them; none where everything is linear.
    pub(super) rates: Vec<Sparse>,
    /// Where coefficients stand.
    places: Places,
    /// How many of the parameters that vary have to do with it: the first, if any, or both.
    parameters: usize,
    /// Whether the mode has to do with none of them.
    pub is_exact: bool,
    /// Part of a component of z by which the terms of degree 17 may change it over a piece.
    pub(super) tolerance: f64,
}

impl Default for Field {
    /// That of a mode without such components.
    fn default() -> Field {
        Field {
            program: Arc::default(),
            needed: Vec::new(),
            looked_at: Vec::new(),
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
        let mut looked_at = Vec::new();
        let mut at_switch = needed.clone();
        if program.made() > 0 {
            let take = |row: Row, needed: &mut [bool]| {
                for (index, needed) in needed.iter_mut().enumerate() {
                    *needed |= row.has(base + index);
                }
            };
            let rates = (0..base).map(|row| matrix.row(row));
            rates.for_each(|row| take(row, &mut needed));
            for row in along {
                looked_at.extend(of_made(&row.at, base));
                take(row, &mut needed);
            }
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
            looked_at,
            at_switch,
            tolerance,
        }
    }

    /// Makes the components that a form has, too.
    pub fn watch(&mut self, form: &Vector) {
        self.looked_at.extend(of_made(form, self.program.base));
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

    /// Whether a root that has no slope there is zero at the beginning of a series.
    pub(super) fn begins_at_root(&self, series: &Series) -> bool {
        let steps = self.program.steps.iter().zip(&self.needed).enumerate();
        let is_steep = |rule: Rule| rule.is_a_root() && !rule.ends_at_zero();
        let mut roots = steps.filter(|(_, (step, needed))| **needed && is_steep(step.rule));
        roots.any(|(index, _)| series.value(0, self.program.base + index) == 0.0)
    }

    /// The steps that the flow has to do with and that end where their operand is zero.
    fn ending(&self) -> impl Iterator<Item = &ProgramStep> {
        let steps = self.program.steps.iter().zip(&self.needed);
        let ending = steps.filter(|(step, needed)| **needed && step.rule.ends_at_zero());
        ending.map(|(step, _)| step)
    }

    /// Whether there are places at which the flow has no value although its pieces do not end there.
    pub(super) fn ends(&self) -> bool {
        self.ending().next().is_some()
    }

    /// Whether it has none at z, given by its components: what a power that ends at zero is of is negative by more than this part of its
    /// terms.
    pub(super) fn lacks_value(&self, z: impl Fn(usize) -> f64, part: f64) -> bool {
        self.ending().any(|step| {
            let terms = step.operands[0].terms.iter();
            let terms = terms.map(|(c, by)| by.value * z(*c));
            let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term| {
                (sum + term, size + term.abs())
            });
            sum < -part * size
        })
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
            flow: &self.needed,
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

    /// Components before those that are made of others.
    pub fn base(&self) -> usize {
        self.program.base
    }
}

/// A form of z that has components made of others.
fn of_made(form: &Vector, base: usize) -> Option<Sparse> {
    let terms = form.iter().enumerate();
    let terms = terms.map(|(c, by)| (c, Dual::new(*by, Default::default())));
    let has = form.iter().skip(base).any(|by| *by != 0.0);
    has.then(|| Sparse::new(terms))
}
