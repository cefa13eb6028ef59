//! Forms where guards are positive, or zero: `abs` without its kink, and forms that are the same there.

use std::collections::HashMap;
use std::sync::Arc;

use super::{Form, Rule, Term};
use crate::affine::algebra::{Function, Obstacle, Operation};
use crate::affine::dual::Measured;

/// What is known of forms in a mode.
pub(in crate::affine) struct Signs<C> {
    /// Guards, none of which is negative.
    pub positive: Vec<Form<C>>,
    /// What is held at zero.
    pub zero: Vec<Form<C>>,
}

impl<C: Measured> Signs<C> {
    /// |form| without its kink: ±g for a multiple of what is not negative, and nothing for one of what is zero.
    fn absolute_value(&self, form: &Form<C>) -> Option<Result<Form<C>, Obstacle>> {
        let is_multiple = |zero: &Form<C>| form.sign_of_ratio(zero).is_some();
        if self.zero.iter().any(is_multiple) {
            return Some(Ok(Form::default()));
        }
        let mut signs = self
            .positive
            .iter()
            .filter_map(|one| form.sign_of_ratio(one));
        let sign = signs.next()?;
        Some(form.clone().scaled(C::number(sign)))
    }
}

impl<C: Measured> Form<C> {
    /// The form where the signs of others are known: ±g in the place of |g| where g is a multiple of what is not negative, and
    /// zero where it is one of what is held at zero.
    /// `known` has the terms that have been met, and whether they are others there.
    ///
    /// # Errors
    /// An operation that has no result there.
    pub(in crate::affine) fn where_signed(
        &self,
        signs: &Signs<C>,
        known: &mut HashMap<*const Term<C>, Option<Form<C>>>,
    ) -> Result<Form<C>, Obstacle> {
        let mut sum = Form {
            beyond: Vec::new(),
            ..self.clone()
        };
        for (coefficient, term) in &self.beyond {
            let place = Arc::as_ptr(term);
            if !known.contains_key(&place) {
                let form = term.where_signed(signs, known)?;
                known.insert(place, form);
            }
            match known.get(&place) {
                Some(Some(form)) => {
                    sum = sum.sum(form.clone().scaled(coefficient.clone())?, 1.0)?
                }
                _ => sum.beyond.push((coefficient.clone(), term.clone())),
            }
        }
        Ok(sum)
    }

    /// The sign of the number that it is times another form: of zero, it is 1.
    pub(in crate::affine) fn sign_of_ratio(&self, other: &Form<C>) -> Option<f64> {
        // a guard that has no state is one of time alone: where it is zero is known, and not what is multiplied with it
        let size = |state: &usize| other.states[*state].certain().abs();
        let pivot = (0..other.states.len()).max_by(|one, more| size(one).total_cmp(&size(more)))?;
        if size(&pivot) == 0.0 {
            return None;
        }
        let own = self.states.get(pivot).cloned().unwrap_or_default();
        let factor = own.operate(Operation::Over, other.states[pivot].clone());
        let factor = factor.ok()?;
        if factor.certain() == 0.0 && factor.largest() > 0.0 {
            return None;
        }
        let negative = factor.certain() < 0.0;
        let rest = other.clone().scaled(factor).ok()?;
        let rest = self.clone().sum(rest, -1.0).ok()?;
        (rest.largest() <= C::SAME * self.largest()).then(|| if negative { -1.0 } else { 1.0 })
    }

    pub(super) fn coefficients(&self) -> impl Iterator<Item = &C> {
        let harmonics = self.harmonics.iter().flatten();
        let terms = self.states.iter().chain(harmonics).chain([&self.constant]);
        terms.chain(self.beyond.iter().map(|(c, _)| c))
    }

    /// Size of its largest coefficient.
    pub(in crate::affine) fn largest(&self) -> f64 {
        let values = self.coefficients().map(C::largest);
        values.fold(0.0, f64::max)
    }

    /// Size of its largest coefficient, or the least that it may have where that is a number.
    pub(in crate::affine) fn certain(&self) -> f64 {
        match self.is_constant() {
            true => self.constant.certain().abs(),
            false => self.largest(),
        }
    }

    /// Whether it is the same as another where a guard is zero: their difference is nothing, or a multiple of the guard.
    pub(in crate::affine) fn is_same_at(&self, other: &Form<C>, guard: &Form<C>) -> bool {
        let size = self.largest().max(other.largest());
        let difference = self.clone().sum(other.clone(), -1.0);
        difference.is_ok_and(|difference| {
            difference.largest() <= C::SAME * size || difference.sign_of_ratio(guard).is_some()
        })
    }
}

impl<C: Measured> Term<C> {
    /// Another form of it where signs are known; `None` where it is the same.
    fn where_signed(
        &self,
        signs: &Signs<C>,
        known: &mut HashMap<*const Term<C>, Option<Form<C>>>,
    ) -> Result<Option<Form<C>>, Obstacle> {
        let [one, other] = &self.operands;
        let resolved = [
            one.where_signed(signs, known)?,
            other.where_signed(signs, known)?,
        ];
        if self.rule == Rule::Function(Function::Abs)
            && let Some(form) = signs.absolute_value(&resolved[0])
        {
            return form.map(Some);
        }
        let is_same = |one: &Form<C>, other: &Form<C>| {
            let mut pairs = one.beyond.iter().zip(&other.beyond);
            one.beyond.len() == other.beyond.len()
                && pairs.all(|((_, one), (_, other))| Arc::ptr_eq(one, other))
        };
        if is_same(&resolved[0], one) && is_same(&resolved[1], other) {
            return Ok(None);
        }
        self.rule.of(resolved).map(Some)
    }
}
