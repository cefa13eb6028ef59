//! Forms in which states stand for other forms.

use std::collections::HashMap;
use std::sync::Arc;

use super::algebra::{Algebra, Obstacle, Operation};
use super::dual::{Coefficient, Measured};
use super::form::{Form, Rule, Term};

impl<C: Coefficient> Form<C> {
    /// The sum of two.
    ///
    /// # Errors
    /// It has no finite coefficients.
    pub(super) fn plus(self, other: Form<C>) -> Result<Form<C>, Obstacle> {
        self.operate(Operation::Plus, other)
    }

    /// The difference of two.
    ///
    /// # Errors
    /// See [`Form::plus`].
    pub(super) fn minus(self, other: Form<C>) -> Result<Form<C>, Obstacle> {
        self.operate(Operation::Minus, other)
    }

    /// The product of two.
    ///
    /// # Errors
    /// It is no form.
    pub(super) fn times(self, other: Form<C>) -> Result<Form<C>, Obstacle> {
        self.operate(Operation::Times, other)
    }

    /// The quotient of two.
    ///
    /// # Errors
    /// It is no form, or not finite.
    pub(super) fn over(self, other: Form<C>) -> Result<Form<C>, Obstacle> {
        self.operate(Operation::Over, other)
    }

    /// The same without states and harmonics at its end whose coefficients are zero.
    pub(super) fn trimmed(mut self) -> Form<C> {
        let zero = C::default();
        while self.states.last() == Some(&zero) {
            self.states.pop();
        }
        while self
            .harmonics
            .last()
            .is_some_and(|pair| pair.iter().all(|one| *one == zero))
        {
            self.harmonics.pop();
        }
        self
    }

    /// Whether a state of this number or a higher one stands in it.
    pub(super) fn has_from(&self, first: usize) -> bool {
        let mut states = self.states.iter().skip(first);
        let mut terms = self.beyond.iter().flat_map(|(_, term)| &term.operands);
        states.any(|one| *one != C::default()) || terms.any(|form| form.has_from(first))
    }

    /// The form with other forms in the place of states, where `new` has one.
    ///
    /// # Errors
    /// An operation that has no result then.
    pub(super) fn with(&self, new: &dyn Fn(usize) -> Option<Form<C>>) -> Result<Form<C>, Obstacle> {
        self.with_known(new, &mut HashMap::new())
    }

    /// The same; `known` has the terms that have been met.
    fn with_known(
        &self,
        new: &dyn Fn(usize) -> Option<Form<C>>,
        known: &mut HashMap<*const Term<C>, Form<C>>,
    ) -> Result<Form<C>, Obstacle> {
        let mut sum = Form {
            states: Vec::new(),
            beyond: Vec::new(),
            ..self.clone()
        };
        for (state, coefficient) in self.states.iter().enumerate() {
            if *coefficient != C::default() {
                let form = new(state).unwrap_or_else(|| Form::state(state));
                sum = sum.plus(form.times(Form::constant(coefficient.clone()))?)?;
            }
        }
        for (coefficient, term) in &self.beyond {
            let place = Arc::as_ptr(term);
            if !known.contains_key(&place) {
                let [one, other] = &term.operands;
                let one = one.with_known(new, known)?;
                let other = other.with_known(new, known)?;
                let form = match term.rule {
                    Rule::Quotient if one.is_zero() => Ok(Form::default()),
                    rule => rule.of([one, other]),
                };
                known.insert(place, form?);
            }
            if let Some(form) = known.get(&place) {
                let form = form.clone();
                sum = sum.plus(form.times(Form::constant(coefficient.clone()))?)?;
            }
        }
        Ok(sum.trimmed())
    }
}

impl<C: Measured> Form<C> {
    /// What a unit of a state adds to it.
    ///
    /// # Errors
    /// See [`Form::times`].
    pub(super) fn slope(&self, state: usize) -> Result<Form<C>, Obstacle> {
        if self.beyond.is_empty() {
            let by = self.states.get(state).cloned();
            return Ok(Form::constant(by.unwrap_or_default()));
        }
        let mut unit = vec![Form::default(); state + 1];
        unit[state] = Form::number(1.0);
        Ok(self.lie(&unit, C::default())?.trimmed())
    }

    /// The form where others are zero, each of which has no state that those before are without.
    pub(super) fn where_zero(self, zero: &[Form<C>]) -> Form<C> {
        zero.iter().fold(self, Form::without)
    }

    /// The form where another one is zero: nothing where it is a multiple of that, or else without the state of which that has
    /// most.
    fn without(self, zero: &Form<C>) -> Form<C> {
        if self.sign_of_ratio(zero).is_some() {
            return Form::default();
        }
        let size = |state: &usize| zero.states[*state].certain().abs();
        let pivot = (0..zero.states.len()).max_by(|one, other| size(one).total_cmp(&size(other)));
        let Some(pivot) = pivot.filter(|pivot| size(pivot) > 0.0 && zero.beyond.is_empty()) else {
            return self;
        };
        let own = self.states.get(pivot).cloned().unwrap_or_default();
        if own == C::default() {
            return self;
        }
        let factor = own.operate(Operation::Over, zero.states[pivot].clone());
        let taken = factor.and_then(|factor| {
            let factor = Form::constant(factor).negative();
            zero.clone().times(factor)
        });
        let less = taken.and_then(|taken| self.clone().held_by(taken));
        less.unwrap_or(self)
    }

    /// The sum of two where what cancels is zero: a force that holds takes exactly away what it holds against.
    ///
    /// # Errors
    /// See [`Form::plus`].
    pub(super) fn held_by(self, other: Form<C>) -> Result<Form<C>, Obstacle> {
        let mut sum = self.clone().plus(other.clone())?;
        for (index, state) in sum.states.iter_mut().enumerate() {
            let of = |form: &Form<C>| form.states.get(index).cloned().unwrap_or_default();
            *state = of(&self).cancelled(of(&other));
        }
        sum.constant = self.constant.clone().cancelled(other.constant.clone());
        for (index, pair) in sum.harmonics.iter_mut().enumerate() {
            let of = |form: &Form<C>| form.harmonics.get(index).cloned().unwrap_or_default();
            let (one, other) = (of(&self), of(&other));
            *pair = [0, 1].map(|part| one[part].clone().cancelled(other[part].clone()));
        }
        for (coefficient, term) in &mut sum.beyond {
            let of = |form: &Form<C>| {
                let mut terms = form.beyond.iter();
                let own = terms.find(|(_, known)| Arc::ptr_eq(known, term));
                own.map_or_else(C::default, |(coefficient, _)| coefficient.clone())
            };
            *coefficient = of(&self).cancelled(of(&other));
        }
        sum.beyond
            .retain(|(coefficient, _)| *coefficient != C::default());
        Ok(sum.trimmed())
    }
}

#[cfg(test)]
mod tests {
    use super::super::expression::Expression;
    use super::*;

    fn form(text: &str) -> Form {
        let meaning = |name: &str| match name {
            "x" => Some(Form::state(0)),
            "y" => Some(Form::state(1)),
            "q" => Some(Form::state(2)),
            _ => None,
        };
        Expression::read(text).unwrap().evaluate(&meaning).unwrap()
    }

    /// 5.177(−1/0.892)0.892 is not −5.177 in doubles.
    #[test]
    fn what_is_held_is_zero() {
        let drift = form("(3.898*x - 0.159*y + 1.215)/0.892");
        let force = drift.clone().over(form("1/0.892")).unwrap().negative();
        let held = force.times(form("1/0.892")).unwrap();
        assert_eq!(
            drift.clone().held_by(held.clone()).unwrap(),
            Form::default()
        );
        assert_eq!(
            form("x + y").held_by(form("y - x")).unwrap(),
            form("0*x + 2*y")
        );
    }

    #[test]
    fn what_stands_for_a_state_stands_in_every_term() {
        let whole = form("3*x + 2*q + x*q/(1 + x^2) + exp(q - y)");
        assert!(whole.has_from(2) && !whole.has_from(3));
        let without = whole
            .with(&|state| (state == 2).then(Form::default))
            .unwrap();
        assert!(!without.has_from(2));
        // q = 0 leaves 3x + e^(-y): the product with nothing has gone
        assert_eq!(without.states, form("3*x").states);
        assert_eq!(without.beyond.len(), 1);
        let affine = form("3*x - q + 2").with(&|state| (state == 2).then(|| form("x + y")));
        assert_eq!(affine.unwrap(), form("2*x - y + 2"));
    }
}
