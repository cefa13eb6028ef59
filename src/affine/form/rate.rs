//! The rate of change of a form along a flow, by the rules of differentiation.

use std::collections::HashMap;
use std::sync::Arc;

use super::{Form, Rule, Term};
use crate::affine::dual::Coefficient;
use crate::affine::expression::{Algebra, Function, Obstacle, Operation};

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
        Rule::RelativeExponential => {
            let moved = a.clone().apply(Function::Exp)?.sum(own, -1.0)?;
            times(a_rate, over(moved, a.clone())?)
        }
        // 1 − σ(a) is σ(−a)
        Rule::Logistic => times(a_rate, times(own, a.clone().negative().logistic()?)?),
        Rule::Function(function) => times(a_rate, slope(function, a, own)?),
    }
}

/// The slope of a function at a form, whose value there is `own`.
fn slope<C: Coefficient>(
    function: Function,
    a: &Form<C>,
    own: Form<C>,
) -> Result<Form<C>, Obstacle> {
    let one = || Form::number(1.0);
    let square = |form: &Form<C>| times(form.clone(), form.clone());
    match function {
        Function::Sin => a.clone().apply(Function::Cos),
        Function::Cos => Ok(a.clone().apply(Function::Sin)?.negative()),
        Function::Tan => one().sum(square(&own)?, 1.0),
        Function::Tanh => one().sum(square(&own)?, -1.0),
        Function::Exp => Ok(own),
        Function::Ln => over(one(), a.clone()),
        Function::Sqrt => over(Form::number(0.5), own),
        Function::Abs => over(own, a.clone()),
        Function::Asin | Function::Acos => {
            let rest = one().sum(square(a)?, -1.0)?;
            let slope = over(one(), rest.apply(Function::Sqrt)?)?;
            Ok(match function {
                Function::Asin => slope,
                _ => slope.negative(),
            })
        }
        Function::Atan => over(one(), one().sum(square(a)?, 1.0)?),
        Function::Sinh => a.clone().apply(Function::Cosh),
        Function::Cosh => a.clone().apply(Function::Sinh),
    }
}
