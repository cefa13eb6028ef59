//! The rate of change of a form along a flow, by the rules of differentiation.

use std::collections::HashMap;
use std::sync::Arc;

use super::{Form, Rule, Term};
use crate::affine::algebra::{Algebra, Obstacle, Operation};
use crate::affine::dual::Coefficient;

impl<C: Coefficient> Form<C> {
    /// Its rate of change where the states change at these rates and the phase at ω.
    pub(in crate::affine) fn lie(&self, rates: &[Form<C>], omega: C) -> Result<Form<C>, Obstacle> {
        self.lie_of(rates, omega, &mut HashMap::new())
    }

    /// The same; `known` has the rates of terms that have been met.
    fn lie_of(
        &self,
        rates: &[Form<C>],
        omega: C,
        known: &mut HashMap<*const Term<C>, Form<C>>,
    ) -> Result<Form<C>, Obstacle> {
        let mut sum = Form::default();
        for (coefficient, rate) in self.states.iter().zip(rates) {
            if *coefficient != C::default() {
                sum = sum.sum(rate.clone().scaled(coefficient.clone())?, 1.0)?;
            }
        }
        sum = sum.sum(self.rate_of_harmonics(omega.clone()), 1.0)?;
        for (coefficient, term) in &self.beyond {
            let rate = match known.get(&Arc::as_ptr(term)) {
                Some(rate) => rate.clone(),
                None => {
                    let rate = rate_of_term(term, rates, omega.clone(), known)?;
                    known.insert(Arc::as_ptr(term), rate.clone());
                    rate
                }
            };
            sum = sum.sum(rate.scaled(coefficient.clone())?, 1.0)?;
        }
        Ok(sum)
    }

    /// That of its cosines and sines of the phase.
    fn rate_of_harmonics(&self, omega: C) -> Form<C> {
        let turn = |(h, [c, s]): (usize, &[C; 2])| {
            let speed = omega.clone().times(C::number((h + 1) as f64));
            [
                s.clone().times(speed.clone()),
                c.clone().times(speed).negative(),
            ]
        };
        Form {
            harmonics: self.harmonics.iter().enumerate().map(turn).collect(),
            ..Form::default()
        }
    }
}

/// A product of a rate; of one that is zero nothing is left, whatever it is multiplied with.
fn times<C: Coefficient>(one: Form<C>, other: Form<C>) -> Result<Form<C>, Obstacle> {
    match one.is_zero() || other.is_zero() {
        true => Ok(Form::default()),
        false => one.operate(Operation::Times, other),
    }
}

fn over<C: Coefficient>(one: Form<C>, other: Form<C>) -> Result<Form<C>, Obstacle> {
    match one.is_zero() {
        true => Ok(Form::default()),
        false => one.operate(Operation::Over, other),
    }
}

/// The rate of a term by its rule: that of a product, of a quotient, or of a function by its slope.
fn rate_of_term<C: Coefficient>(
    term: &Arc<Term<C>>,
    rates: &[Form<C>],
    omega: C,
    known: &mut HashMap<*const Term<C>, Form<C>>,
) -> Result<Form<C>, Obstacle> {
    let [a, b] = &term.operands;
    let own = Form {
        beyond: vec![(C::number(1.0), term.clone())],
        ..Form::default()
    };
    let a_rate = a.lie_of(rates, omega.clone(), known)?;
    let b_rate = b.lie_of(rates, omega, known)?;
    match term.rule {
        Rule::Product => times(a_rate, b.clone())?.sum(times(a.clone(), b_rate)?, 1.0),
        Rule::Quotient => {
            let moved = times(own, b_rate)?;
            over(a_rate.sum(moved, -1.0)?, b.clone())
        }
        Rule::Power(r) => times(a_rate, over(own, a.clone())?.scaled(C::number(r))?),
        Rule::Function(function) => times(a_rate, function.slope(a.clone(), own)?),
    }
}
