//! Components of z that are made of others: the steps by which terms of forms are evaluated one after another.

use std::collections::HashMap;
use std::sync::Arc;

use super::algebra::Function;
use super::coefficients::Sparse;
use super::dual::{Coefficient, Dual};
use super::form::{Form, Rule, Term};
use super::recurrence::ProgramStep;
use super::rows::{MatrixBy, Row};
use crate::interval::Interval;

/// Whole exponents up to this are products of intervals.
const MOST_FACTORS: f64 = 64.0;

/// How the components of z beyond states and phase are made, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Components before them: states, 1, cosines and sines; and the states.
    pub(super) base: usize,
    pub(super) states: usize,
    pub(super) steps: Vec<ProgramStep>,
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
            states,
            steps: Vec::new(),
        };
        Terms {
            states,
            program,
            known: HashMap::new(),
        }
    }

    /// With this program already, for forms that have no terms.
    pub fn of(program: &Program) -> Terms {
        Terms {
            states: program.states,
            program: program.clone(),
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
            let step = ProgramStep {
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
        Sparse::new(terms.into_iter())
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
                open.extend(operands.flat_map(|operand| &operand.terms).map(|(c, _)| *c));
            }
        }
        false
    }

    /// The symmetric matrix Q of a row of z that is zᵀQz in the components before those that are made of others; `None`
    /// where it is no polynomial of degree 2 in them.
    pub(super) fn quadratic(&self, row: &Row) -> Option<MatrixBy> {
        let mut matrix = MatrixBy::zero(self.base, self.base);
        let mut add = |(i, j): (usize, usize), value: Dual| {
            let half = value.sum(0.5, Dual::default(), 0.0);
            matrix.add(i, j, half);
            matrix.add(j, i, half);
        };
        for c in (0..self.size()).filter(|c| row.has(*c)) {
            let factor = row.dual(c);
            let Some(step) = c.checked_sub(self.base).map(|index| &self.steps[index]) else {
                // the component after the states is 1
                add((c, self.states), factor);
                continue;
            };
            let [one, other] = &step.operands;
            let inner = |operand: &Sparse| operand.terms.iter().all(|(c, _)| *c < self.base);
            if step.rule != Rule::Product || !inner(one) || !inner(other) {
                return None;
            }
            for (i, a) in &one.terms {
                for (j, b) in &other.terms {
                    add((*i, *j), factor.times(a.times(*b)));
                }
            }
        }
        Some(matrix)
    }

    /// Marks also those components of which the marked ones are made.
    pub(super) fn complete(&self, needed: &mut [bool]) {
        for (index, step) in self.steps.iter().enumerate().rev() {
            if needed[index] {
                let terms = step.operands.iter().flat_map(|operand| &operand.terms);
                let inner = terms.filter_map(|(c, _)| c.checked_sub(self.base));
                inner.for_each(|inner| needed[inner] = true);
            }
        }
    }

    /// Whether another differs in the values of coefficients only.
    pub fn has_same_shape(&self, other: &Program) -> bool {
        let alike = |(one, other): (&Sparse, &Sparse)| {
            let [one, other] = [one, other].map(|sparse| sparse.terms.iter().map(|(c, _)| c));
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

impl Rule {
    /// Its value where the operands lie in intervals.
    pub(super) fn enclose(self, a: Interval, b: impl Fn() -> Interval) -> Interval {
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
            Rule::Function(function) => function.enclose(a),
        }
    }
}
