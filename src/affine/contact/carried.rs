//! What an impact carries past a `zero` of the user's mode: that switch follows in the same instant.

use super::arrivals::Instant;
use super::forms::ContactForms;
use super::mistake::ContactMistake;
use crate::affine::algebra::{Algebra, Obstacle};
use crate::affine::dual::Measured;
use crate::affine::evaluation::FormSwitch;
use crate::affine::form::Form;

impl<C: Measured> ContactForms<C> {
    /// The switches that may follow an impact, which leads contacts to these states: it alone, where no `zero` of the user's mode is
    /// negative after it, and with each switch of the user's whose `zero` is.
    pub(super) fn carried(
        &self,
        instant: &Instant<C>,
        (mut impact, digits): (FormSwitch<C>, &[usize]),
    ) -> Result<Vec<FormSwitch<C>>, ContactMistake> {
        let failed = |error| instant.failed_in(digits, error);
        let mut further = Vec::new();
        if instant.jump.is_empty() || impact.refusal.is_some() {
            return Ok(vec![impact]);
        }
        let Ok(forces) = self.forces(instant.own, digits) else {
            // the mode says why there are none
            return Ok(vec![impact]);
        };
        let conditions = impact.conditions.clone();
        let mut kept: Vec<Form<C>> = Vec::new();
        for own in &self.switches[instant.own] {
            let after = instant.after(&own.guard).map_err(failed)?.trimmed();
            if after.is_same_at(&own.guard, instant.guard) {
                continue;
            }
            for next in self.own_switches(own, digits, forces)? {
                let negative = after.clone().negative();
                let mut both = composed(instant, &impact, next).map_err(failed)?;
                both.conditions
                    .splice(0..0, conditions.iter().cloned().chain([negative]));
                further.push(both);
            }
            if !kept.contains(&after) {
                kept.push(after);
            }
        }
        impact.conditions.extend(kept);
        further.insert(0, impact);
        Ok(further)
    }
}

/// An impact and the switch that follows it, with the conditions of this one.
fn composed<C: Measured>(
    instant: &Instant<C>,
    impact: &FormSwitch<C>,
    next: FormSwitch<C>,
) -> Result<FormSwitch<C>, Obstacle> {
    let after = |form: &Form<C>| instant.after(form);
    let conditions = next.conditions.iter().map(after);
    let mut reset = impact.reset.clone();
    for (state, form) in &next.reset {
        let form = after(form)?;
        match reset.iter_mut().find(|(known, _)| known == state) {
            Some((_, known)) => *known = form,
            None => reset.push((*state, form)),
        }
    }
    Ok(FormSwitch {
        to: next.to,
        rest: None,
        conditions: conditions.collect::<Result<_, _>>()?,
        reset,
        tangent: None,
        refusal: next.refusal,
        ..impact.clone()
    })
}
