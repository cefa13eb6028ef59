//! What an impact of one contact does to others in the same instant: it turns their slip, opens and closes them, or presses on one that
//! is closed.

use super::arrivals::{Instant, Trial, ways};
use super::law::{CLOSED, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, STICK};
use super::mistake::ContactMistake;
use crate::affine::dual::Measured;
use crate::affine::expression::Algebra;
use crate::affine::form::Form;

/// The trials to which an impact leads a contact from one of them, by its velocity after it; whether that rises, where it is known.
fn led<C: Measured>(
    law: &Law<Form<C>>,
    contact: usize,
    trial: &Trial<C>,
    (after, rises): (&Form<C>, Option<bool>),
) -> Vec<Trial<C>> {
    let [up, down, held] = ways(law);
    let digit = trial.digits[contact];
    let mut next = Vec::new();
    let mut lead = |to: usize, condition: Option<Form<C>>| {
        let mut trial = trial.clone();
        trial.digits[contact] = to;
        // a closed stop that is pressed on would have an impact of its own in the same instant
        let is_pressed = matches!(law, Law::Stop { .. }) && [digit, to] == [CLOSED; 2];
        trial.pressed = is_pressed.then_some(contact);
        trial.conditions.extend(condition);
        next.push(trial);
    };
    match (law, digit) {
        (Law::Friction { .. } | Law::Stop { .. }, digit) if digit == held => {
            if rises != Some(false) {
                lead(up, rises.is_none().then(|| after.clone()));
            }
            if rises != Some(true) {
                lead(down, rises.is_none().then(|| after.clone().negative()));
            }
        }
        // no slip is left: it sticks if it holds
        (Law::Friction { .. }, _) if after.is_zero() => lead(STICK, None),
        (Law::Friction { .. }, _) => {
            let ways = [(up, after.clone()), (down, after.clone().negative())];
            // what it does already comes first
            let order = if digit == up { [0, 1] } else { [1, 0] };
            for way in order {
                lead(ways[way].0, Some(ways[way].1.clone()));
            }
        }
        (Law::Jenkins { .. }, GIVES_FORWARD | GIVES_BACKWARD) => {
            let goes_on = match digit {
                GIVES_FORWARD => after.clone(),
                _ => after.clone().negative(),
            };
            lead(digit, Some(goes_on.clone()));
            lead(HELD, Some(goes_on.negative()));
        }
        _ => lead(digit, None),
    }
    next
}

impl<C: Measured> Instant<'_, C> {
    /// The trials after an impact of a contact, which turns the slip of others and the velocity of their gaps.
    pub(super) fn turned(
        &self,
        impact: usize,
        trial: Trial<C>,
    ) -> Result<Vec<Trial<C>>, ContactMistake> {
        let mut trials = vec![trial];
        if self.jump.is_empty() {
            return Ok(trials);
        }
        let own = &self.forms.own[self.own];
        let failed = |error| self.failed_in(self.before, error);
        for (contact, law) in self.forms.laws.iter().enumerate() {
            if contact == impact {
                continue;
            }
            let speed = &own.kinematics[contact].speed;
            let after = self.after(speed).map_err(failed)?;
            let after = after.trimmed();
            let change = after.clone().minus(speed.clone());
            let change = change.map_err(failed)?.trimmed();
            if change.largest() <= C::SAME.min(f64::EPSILON) * speed.largest() {
                continue;
            }
            // before an impact the velocity of the gap is negative
            let closing = &own.kinematics[impact].speed;
            let rises = change.sign_of_ratio(closing).map(|sign| sign < 0.0);
            let led = trials.iter().flat_map(|trial| match trial.pressed {
                Some(_) => vec![trial.clone()],
                None => led(law, contact, trial, (&after, rises)),
            });
            trials = led.collect();
        }
        self.open_where_held(impact, &mut trials);
        Ok(trials)
    }

    /// Opens the stop of an impact in trials in which friction holds what would be pressed on it: both forces together are not
    /// determined.
    fn open_where_held(&self, impact: usize, trials: &mut [Trial<C>]) {
        let closed =
            |trial: &&mut Trial<C>| trial.digits[impact] == CLOSED && trial.pressed.is_none();
        for trial in trials.iter_mut().filter(closed) {
            let forces = self.forms.forces(self.own, &trial.digits);
            if matches!(forces, Err(ContactMistake::Singular(_))) {
                trial.digits[impact] = OPEN;
            }
        }
    }
}
