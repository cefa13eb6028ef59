//! What a jump of states does to contacts in the same instant. An impact of one turns the slip of others, opens and closes them, or
//! presses on one that is closed; a reset of the user's own may move gaps, too.

use super::arrivals::{Instant, Trial, ways};
use super::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, PARTING, STICK,
};
use super::mistake::ContactMistake;
use crate::affine::algebra::{Algebra, Obstacle};
use crate::affine::dual::Measured;
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

/// A state of a contact that may follow.
struct Follower<C> {
    to: usize,
    /// What is not negative where it does.
    conditions: Vec<Form<C>>,
    /// Whether no motion follows.
    refused: bool,
}

/// A state that follows where these are not negative.
fn to<C>(to: usize, conditions: Vec<Form<C>>) -> Follower<C> {
    Follower {
        to,
        conditions,
        refused: false,
    }
}

impl<C: Measured> Trial<C> {
    /// The trials in which a contact follows to other states, if motion follows from this one.
    fn followed(&self, contact: usize, followers: &[Follower<C>]) -> Vec<Trial<C>> {
        if self.pressed.is_some() {
            return vec![self.clone()];
        }
        let follow = |follower: &Follower<C>| {
            let mut trial = self.clone();
            trial.digits[contact] = follower.to;
            trial.conditions.extend(follower.conditions.iter().cloned());
            trial.pressed = follower.refused.then_some(contact);
            trial
        };
        followers.iter().map(follow).collect()
    }
}

/// A slip or a gap before and after a reset, where what contacts hold is zero.
pub(super) struct Moved<C> {
    before: Form<C>,
    /// After it.
    pub after: Form<C>,
}

impl<C: Measured> Moved<C> {
    /// Whether the reset leaves it as it is where a guard is zero.
    pub fn stays(&self, guard: &Form<C>) -> bool {
        self.after.is_same_at(&self.before, guard)
    }

    /// Whether the reset keeps its sign, if that is known.
    fn keeps_sign(&self) -> Option<bool> {
        let sign = self.after.sign_of_ratio(&self.before)?;
        Some(sign > 0.0)
    }
}

/// The states that follow by the sign of a form, that of now first.
fn by_sign<C: Measured>(form: &Form<C>, [up, down]: [usize; 2], now: usize) -> Vec<Follower<C>> {
    let mut followers = vec![
        to(up, vec![form.clone()]),
        to(down, vec![form.clone().negative()]),
    ];
    followers.sort_by_key(|follower| follower.to != now);
    followers
}

/// The states of a damped spring by its gap and by the force that it has lost, kg + cġ, that of now first.
fn of_damped<C: Measured>(gap: Form<C>, lost: Form<C>, now: usize) -> Vec<Follower<C>> {
    let behind = gap.clone().negative();
    let mut followers = vec![
        to(OPEN, vec![gap]),
        to(CLOSED, vec![behind.clone(), lost.clone().negative()]),
        to(PARTING, vec![behind, lost]),
    ];
    followers.sort_by_key(|follower| follower.to != now);
    followers
}

impl<C: Measured> Instant<'_, C> {
    /// The trials after a reset of the user's own.
    pub(super) fn reset(&self, trial: Trial<C>) -> Result<Vec<Trial<C>>, ContactMistake> {
        let mut trials = vec![trial];
        if self.jump.is_empty() {
            return Ok(trials);
        }
        let held = self.forms.reduced(self.own, self.before);
        for (contact, digit) in self.before.iter().enumerate() {
            let followers = self.followers(contact, *digit, &held);
            let followers = followers.map_err(|error| self.failed_in(self.before, error))?;
            let led = trials
                .iter()
                .flat_map(|trial| trial.followed(contact, &followers));
            trials = led.collect();
        }
        Ok(trials)
    }

    /// A slip or a gap before and after the jump.
    pub(super) fn moved(&self, form: &Form<C>, held: &[Form<C>]) -> Result<Moved<C>, Obstacle> {
        Ok(Moved {
            before: form.clone().where_zero(held),
            after: self.after(form)?.where_zero(held).trimmed(),
        })
    }

    /// The states of a contact that a reset may lead to from one of them: they follow from its slip, its gap, and the force of a
    /// damped spring.
    fn followers(
        &self,
        contact: usize,
        digit: usize,
        held: &[Form<C>],
    ) -> Result<Vec<Follower<C>>, Obstacle> {
        let same = || vec![to(digit, Vec::new())];
        let speed = &self.forms.own[self.own].kinematics[contact].speed;
        Ok(match &self.forms.laws[contact] {
            Law::Friction { slip, .. } => {
                let slip = self.moved(slip, held)?;
                match (digit, slip.keeps_sign()) {
                    _ if slip.stays(self.guard) => same(),
                    // no slip is left: it sticks if it holds
                    _ if slip.after.is_zero() => vec![to(STICK, Vec::new())],
                    (FORWARD | BACKWARD, Some(true)) => same(),
                    (FORWARD, Some(false)) => vec![to(BACKWARD, Vec::new())],
                    (BACKWARD, Some(false)) => vec![to(FORWARD, Vec::new())],
                    _ => by_sign(&slip.after, [FORWARD, BACKWARD], digit),
                }
            }
            Law::Jenkins { .. } if digit == HELD => same(),
            Law::Jenkins {
                slip,
                stiffness,
                bound,
            } => {
                let stretch = self.forms.own[self.own].kinematics[contact].stretch;
                let stretch = Form::state(stretch.unwrap_or_default());
                self.slider_followers([slip, stiffness, bound, &stretch], digit, held)?
            }
            Law::Stop { gap, .. } => {
                let (gap, speed) = (self.moved(gap, held)?, self.moved(speed, held)?);
                match digit {
                    _ if !gap.stays(self.guard) && !gap.after.is_zero() => {
                        let behind = Follower {
                            refused: true,
                            ..to(OPEN, vec![gap.after.clone().negative()])
                        };
                        vec![to(OPEN, vec![gap.after]), behind]
                    }
                    // where it is pressed on an impact follows
                    CLOSED if !speed.stays(self.guard) => vec![to(OPEN, Vec::new())],
                    _ => same(),
                }
            }
            Law::Spring {
                gap,
                stiffness,
                damping,
            } => {
                let (gap, speed) = (self.moved(gap, held)?, self.moved(speed, held)?);
                let stays = gap.stays(self.guard);
                match damping {
                    None if stays => same(),
                    None => by_sign(&gap.after, [OPEN, CLOSED], digit),
                    Some(_) if stays && (digit == OPEN || speed.stays(self.guard)) => same(),
                    Some(damping) => {
                        let elastic = gap.after.clone().times(stiffness.clone())?;
                        let lost = elastic.plus(speed.after.times(damping.clone())?)?;
                        match stays {
                            true => by_sign(&lost, [PARTING, CLOSED], digit),
                            false => of_damped(gap.after, lost, digit),
                        }
                    }
                }
            }
        })
    }

    /// Those of a Jenkins element that slips: it holds where its slip has turned, or its stretch is no more that of its bound.
    fn slider_followers(
        &self,
        [slip, stiffness, bound, stretch]: [&Form<C>; 4],
        digit: usize,
        held: &[Form<C>],
    ) -> Result<Vec<Follower<C>>, Obstacle> {
        let same = || vec![to(digit, Vec::new())];
        let stretch = self.moved(stretch, held)?;
        if !stretch.stays(self.guard) {
            let force = stretch.after.times(stiffness.clone())?;
            let force = match digit {
                GIVES_FORWARD => force,
                _ => force.negative(),
            };
            let left = bound.clone().minus(force)?.trimmed();
            return Ok(by_sign(&left, [HELD, digit], HELD));
        }
        let slip = self.moved(slip, held)?;
        Ok(match slip.keeps_sign() {
            _ if slip.stays(self.guard) => same(),
            Some(true) => same(),
            Some(false) => vec![to(HELD, Vec::new())],
            None if digit == GIVES_FORWARD => by_sign(&slip.after, [digit, HELD], digit),
            None => by_sign(&slip.after, [HELD, digit], digit),
        })
    }

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
        let held = self.forms.reduced(self.own, self.before);
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
            let of_spring = match law {
                Law::Spring {
                    damping: Some(_), ..
                } => Some(self.followers(contact, self.before[contact], &held)),
                _ => None,
            };
            let of_spring = of_spring.transpose().map_err(failed)?;
            let led = trials.iter().flat_map(|trial| match &of_spring {
                Some(followers) => trial.followed(contact, followers),
                None if trial.pressed.is_some() => vec![trial.clone()],
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
