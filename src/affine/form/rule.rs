//! The rules by which terms are made of forms.

use super::Form;
use crate::affine::algebra::{Algebra, Function, Obstacle, Operation};
use crate::affine::dual::Coefficient;

/// How a term that is not affine is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// ab.
    Product,
    /// a/b.
    Quotient,
    /// aʳ.
    Power(f64),
    /// f(a).
    Function(Function),
}

impl Rule {
    /// Whether it has a value and a slope where its operand is zero and none below, as a^1.5 has.
    pub(in crate::affine) fn ends_at_zero(self) -> bool {
        matches!(self, Rule::Power(r) if r > 1.0 && r.fract() != 0.0)
    }

    /// Whether it is never negative, and has no more derivatives where it is zero than its power tells: a square root and the like.
    pub(in crate::affine) fn is_a_root(self) -> bool {
        matches!(self, Rule::Power(r) if r > 0.0 && r.fract() != 0.0)
            || self == Rule::Function(Function::Sqrt)
    }

    /// What it makes of forms.
    pub(in crate::affine) fn of<C: Coefficient>(
        self,
        [one, other]: [Form<C>; 2],
    ) -> Result<Form<C>, Obstacle> {
        match self {
            Rule::Product => one.operate(Operation::Times, other),
            Rule::Quotient => one.operate(Operation::Over, other),
            Rule::Power(r) => one.operate(Operation::Power, Form::number(r)),
            Rule::Function(function) => one.apply(function),
        }
    }
}

fn over<C: Coefficient>(one: C, other: &C) -> Result<C, Obstacle> {
    one.operate(Operation::Over, other.clone())
}

impl<C: Coefficient> Form<C> {
    /// A quotient by something that changes. Where that is b(1 − eᵃ) and this is κa, both zero together, it is −κ/b by
    /// (eᵃ − 1)/a, which is never zero, and so for a multiple of this, and the other way round; where it is b(1 + eᵃ) it is made of
    /// logistic functions, which have values where eᵃ has none.
    pub(super) fn over_what_changes(self, other: Form<C>) -> Result<Form<C>, Obstacle> {
        if let Some((factor, exponent)) = self.beside_exponential(&other) {
            let below = exponent.apply(Function::RelativeExponential)?;
            return Form::term(Rule::Quotient, [Form::constant(factor), below]);
        }
        if let Some((factor, exponent)) = other.beside_exponential(&self) {
            let above = exponent.apply(Function::RelativeExponential)?;
            return above.scaled(over(C::number(1.0), &factor)?);
        }
        if let Some([factor, rest]) = self.factors() {
            let all = [(&factor, &rest), (&rest, &factor)];
            let mut with = all.into_iter();
            let vanishes =
                |(factor, _): &(&Form<C>, _)| factor.beside_exponential(&other).is_some();
            if let Some((factor, rest)) = with.find(vanishes) {
                let quotient = factor.clone().over_what_changes(other)?;
                return quotient.operate(Operation::Times, rest.clone());
            }
        }
        match other.exponential(1.0) {
            Some((b, slope, exponent)) => self.by_logistic(&other, (b, slope), exponent),
            None => Form::term(Rule::Quotient, [self, other]),
        }
    }

    /// Whether it is made of numbers and terms alone.
    fn is_of_terms(&self) -> bool {
        self.states.is_empty() && self.harmonics.is_empty() && self.phase.is_none()
    }

    /// The factors of a product.
    fn factors(&self) -> Option<[Form<C>; 2]> {
        let [(c, term)] = &self.beyond[..] else {
            return None;
        };
        let is_product = term.rule == Rule::Product && self.is_of_terms();
        let [one, other] = &term.operands;
        (is_product && self.constant == C::default())
            .then(|| Some([one.clone().scaled(c.clone()).ok()?, other.clone()]))?
    }

    /// b, s and a of a form b + s eᵘ = b(1 ± eᵃ), of this sign.
    fn exponential(&self, sign: f64) -> Option<(C, C, Form<C>)> {
        let [(slope, term)] = &self.beyond[..] else {
            return None;
        };
        let (b, [power, _]) = (&self.constant, &term.operands);
        if term.rule != Rule::Function(Function::Exp) || !self.is_of_terms() {
            return None;
        }
        // a = u + ln(±s/b)
        let ratio = over(slope.clone().times(C::number(sign)), b).ok()?;
        let shift = Form::constant(ratio.apply(Function::Ln).ok()?);
        let exponent = power.clone().sum(shift, 1.0).ok()?;
        Some((b.clone(), slope.clone(), exponent))
    }

    /// −κ/b and a of a quotient of κa by b(1 − eᵃ).
    fn beside_exponential(&self, other: &Form<C>) -> Option<(C, Form<C>)> {
        let (b, _, exponent) = other.exponential(-1.0)?;
        let affine = [self, &exponent].map(|form| form.beyond.is_empty() && form.phase.is_none());
        if affine != [true; 2] {
            return None;
        }
        let ratio = C::ratio(&self.affine_coefficients(&exponent))?;
        Some((over(ratio.negative(), &b).ok()?, exponent))
    }

    /// The quotient by b + s eᵘ = b(1 + eᵃ): 1 over that is σ(−a)/b, and eᵘ over it σ(a)/s.
    fn by_logistic(
        self,
        other: &Form<C>,
        (b, slope): (C, C),
        exponent: Form<C>,
    ) -> Result<Form<C>, Obstacle> {
        let inverse = |one: &C| over(C::number(1.0), one);
        let falling = exponent.clone().negative().apply(Function::Logistic)?;
        let falling = falling.scaled(inverse(&b)?)?;
        match (&self.beyond[..], &other.beyond[..]) {
            ([(factor, own)], [(_, term)]) if self.is_of_terms() && own == term => {
                let rising = exponent.apply(Function::Logistic)?;
                let rising = rising.scaled(inverse(&slope)?)?;
                let rising = rising.scaled(factor.clone())?;
                rising.sum(falling.scaled(self.constant)?, 1.0)
            }
            _ => self.operate(Operation::Times, falling),
        }
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
