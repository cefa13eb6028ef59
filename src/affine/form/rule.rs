//! The rules by which terms are made of forms.

use super::Form;
use crate::affine::dual::Coefficient;
use crate::affine::expression::{Algebra, Function, Obstacle, Operation};

/// How a term that is not affine is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// ab.
    Product,
    /// a/b.
    Quotient,
    /// aʳ.
    Power(f64),
    /// (eᵃ − 1)/a, 1 where a is zero.
    RelativeExponential,
    /// f(a).
    Function(Function),
}

impl Rule {
    /// What it makes of forms.
    pub(in crate::affine) fn of<C: Coefficient>(
        self,
        [one, other]: [Form<C>; 2],
    ) -> Result<Form<C>, Obstacle> {
        match self {
            Rule::Product => one.operate(Operation::Times, other),
            Rule::Quotient => one.operate(Operation::Over, other),
            Rule::Power(r) => one.operate(Operation::Power, Form::number(r)),
            Rule::RelativeExponential => one.relative_exponential(),
            Rule::Function(function) => one.apply(function),
        }
    }
}

impl<C: Coefficient> Form<C> {
    /// (eᵃ − 1)/a of a form a.
    fn relative_exponential(self) -> Result<Form<C>, Obstacle> {
        Form::term(Rule::RelativeExponential, [self, Form::default()])
    }

    /// A quotient by something that changes. Where that is b(1 − eᵃ) and this is κa, both zero together, it is −κ/b by
    /// (eᵃ − 1)/a, which is never zero.
    pub(super) fn over_what_changes(self, other: Form<C>) -> Result<Form<C>, Obstacle> {
        match self.beside_exponential(&other) {
            Some((factor, exponent)) => {
                let operands = [Form::constant(factor), exponent.relative_exponential()?];
                Form::term(Rule::Quotient, operands)
            }
            None => Form::term(Rule::Quotient, [self, other]),
        }
    }

    /// −κ/b and a of such a quotient.
    fn beside_exponential(&self, other: &Form<C>) -> Option<(C, Form<C>)> {
        let [(slope, term)] = &other.beyond[..] else {
            return None;
        };
        let (b, [power, _]) = (&other.constant, &term.operands);
        let alone = other.states.is_empty() && other.harmonics.is_empty() && other.phase.is_none();
        let affine = [self, power].map(|form| form.beyond.is_empty() && form.phase.is_none());
        if term.rule != Rule::Function(Function::Exp) || !alone || affine != [true; 2] {
            return None;
        }
        // b + s eᵘ = b(1 − e^{u + ln(−s/b)})
        let over = |one: C, other: &C| one.operate(Operation::Over, other.clone()).ok();
        let shift = over(slope.clone().negative(), b)?
            .apply(Function::Ln)
            .ok()?;
        let exponent = power.clone().sum(Form::constant(shift), 1.0).ok()?;
        let ratio = C::ratio(&self.affine_coefficients(&exponent))?;
        Some((over(ratio.negative(), b)?, exponent))
    }

    /// Coefficients of two forms side by side, without those of terms.
    fn affine_coefficients(&self, other: &Form<C>) -> Vec<(C, C)> {
        let all = |form: &Form<C>, states: usize, harmonics: usize| {
            let mut all = form.states.clone();
            all.resize(states, C::default());
            all.push(form.constant.clone());
            all.extend(form.harmonics.iter().flatten().cloned());
            all.resize(states + 1 + 2 * harmonics, C::default());
            all
        };
        let states = self.states.len().max(other.states.len());
        let harmonics = self.harmonics.len().max(other.harmonics.len());
        let [one, two] = [self, other].map(|form| all(form, states, harmonics));
        one.into_iter().zip(two).collect()
    }
}
