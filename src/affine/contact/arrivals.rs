//! Where a mode with contacts ends, and which states of the contacts follow.
//!
//! What one contact does may make others change in the same instant: a block that stops loads its neighbour, an impact
//! turns a slip round. From the states that the contact which ends would lead to, every other one is looked at in the
//! order of the file, and where what it does hangs on the state of the instant both ways are followed, each with its
//! condition. What is left is every end of such a chain, one exit each. A switch of the user's own modes begins such a chain, too:
//! beyond it other forces act.

use super::forms::ContactForms;
use super::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, PARTING, STICK,
};
use super::mistake::ContactMistake;
use crate::affine::dual::{Dual, Measured};
use crate::affine::expression::{Algebra, Obstacle};
use crate::affine::form::Form;

/// A guard of a contact, and what it changes.
pub struct Ending<C = Dual> {
    /// What is positive as long as the contact stays as it is.
    pub guard: Form<C>,
    /// The state of the contact beyond.
    pub to: usize,
    /// Whether it is an impact, and whether that has a restitution.
    pub impact: Option<bool>,
    /// Orders of the zero that its guard beyond has there.
    pub zeros: usize,
    /// Whether the guard keeps its value within the mode.
    pub keeps: bool,
}

/// States of the contacts that follow.
pub struct Arrival<C = Dual> {
    /// These states.
    pub digits: Vec<usize>,
    /// What is not negative where they do.
    pub conditions: Vec<Form<C>>,
    /// A closed stop on which the impulse of the impact presses: no motion follows.
    pub pressed: Option<usize>,
}

/// Contacts in states that are on trial, with what is not negative where they came to them.
#[derive(Clone)]
struct Trial<C> {
    digits: Vec<usize>,
    conditions: Vec<Form<C>>,
    /// Contacts that have been looked at in these states.
    seen: Vec<bool>,
    /// States that the chain has been through.
    passed: Vec<Vec<usize>>,
    /// See [`Arrival::pressed`].
    pressed: Option<usize>,
}

/// The instant at which a mode ends.
pub struct Instant<'a, C = Dual> {
    /// The forms of the system.
    pub forms: &'a ContactForms<C>,
    /// The user's mode beyond.
    pub own: usize,
    /// States of the contacts before.
    pub before: &'a [usize],
    /// Forces before.
    pub forces: &'a [Form<C>],
    /// What is zero at the instant.
    pub guard: &'a Form<C>,
    /// The contact that ends, and how; none where the user's mode does.
    pub contact: Option<(usize, &'a Ending<C>)>,
    /// Others that end by the same guard, with their states beyond: two that act on one slip.
    pub together: &'a [(usize, usize)],
    /// New values of the states that jump.
    pub jump: &'a [(usize, Form<C>)],
}

/// The states of a contact in which what is turned rises and falls, and in which it is held.
fn ways<C>(law: &Law<Form<C>>) -> [usize; 3] {
    match law {
        Law::Friction { .. } => [FORWARD, BACKWARD, STICK],
        Law::Jenkins { .. } => [HELD, HELD, HELD],
        Law::Stop { .. } | Law::Spring { .. } => [OPEN, CLOSED, CLOSED],
    }
}

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
    /// Every end of the chain of changes.
    ///
    /// # Errors
    /// Forces that are not determined.
    pub fn arrivals(&self) -> Result<Vec<Arrival<C>>, ContactMistake> {
        let trial = self.first();
        let mut ends = Vec::new();
        let mut open = match self.contact {
            Some((contact, _)) => self.turned(contact, trial)?,
            None => vec![trial],
        };
        open.reverse();
        while let Some(trial) = open.pop() {
            let ways = match trial.pressed {
                Some(_) => None,
                None => self.unsettled(&trial)?,
            };
            match ways {
                None => ends.push(Arrival {
                    digits: trial.digits,
                    conditions: trial.conditions,
                    pressed: trial.pressed,
                }),
                Some(ways) => open.extend(ways.into_iter().rev()),
            }
        }
        Ok(ends)
    }

    /// The states that the contacts which end lead to, whatever these change.
    pub fn direct(&self) -> Arrival<C> {
        Arrival {
            digits: self.first().digits,
            conditions: Vec::new(),
            pressed: None,
        }
    }

    /// The first trial: what ends has ended.
    fn first(&self) -> Trial<C> {
        let mut digits = self.before.to_vec();
        let mut seen = vec![false; digits.len()];
        if let Some((contact, ending)) = self.contact {
            digits[contact] = ending.to;
            // what is released leaves by the sign of what was too much, as long as nothing else changes
            seen[contact] = self.is_friction(contact) && self.before[contact] == STICK;
        }
        for (contact, to) in self.together {
            digits[*contact] = *to;
        }
        // a slip that a closed stop has held is zero: it sticks if it holds
        for (contact, digit) in digits.iter_mut().enumerate() {
            if self.forms.is_slip_held(self.own, self.before, contact) {
                *digit = STICK;
            }
        }
        // after an impact the sign of the slip tells
        let released = |contact: &usize| !self.is_impact() || self.is_friction(*contact);
        for contact in self.ended().filter(released) {
            self.follow(contact, &mut digits);
        }
        Trial {
            seen,
            conditions: Vec::new(),
            passed: Vec::new(),
            pressed: None,
            digits,
        }
    }

    /// A form after the jump.
    fn after(&self, form: &Form<C>) -> Result<Form<C>, Obstacle> {
        if self.jump.is_empty() {
            return Ok(form.clone());
        }
        let new = |state: usize| {
            let mut jump = self.jump.iter();
            jump.find_map(|(changed, form)| (*changed == state).then(|| form.clone()))
        };
        form.with(&new)
    }

    fn is_friction(&self, contact: usize) -> bool {
        matches!(self.forms.laws[contact], Law::Friction { .. })
    }

    /// Lets sliders follow the friction on the same slip, or the stop whose gap moves with it: one that gives goes on where that
    /// sticks or slips on, or is closed, and holds where it slips back, or opens.
    fn follow(&self, leader: usize, digits: &mut [usize]) {
        let direction = match (&self.forms.laws[leader], digits[leader]) {
            (Law::Friction { .. }, FORWARD) | (Law::Stop { .. }, OPEN) => 1.0,
            (Law::Friction { .. }, BACKWARD) => -1.0,
            (Law::Friction { .. }, _) => 0.0,
            _ => return,
        };
        let sliders = self.forms.laws.iter().zip(self.before).enumerate();
        let sliders = sliders.filter_map(|(contact, (law, digit))| match (law, *digit) {
            (Law::Jenkins { slip, .. }, GIVES_FORWARD) => Some((contact, slip, 1.0)),
            (Law::Jenkins { slip, .. }, GIVES_BACKWARD) => Some((contact, slip, -1.0)),
            _ => None,
        });
        for (contact, slip, gives) in sliders {
            let Some(along) = self.one_speed(leader, slip) else {
                continue;
            };
            let back = direction * along * gives < 0.0;
            digits[contact] = if back { HELD } else { self.before[contact] };
        }
    }

    /// The contacts that end by the guard of the instant.
    fn ended(&self) -> impl Iterator<Item = usize> {
        let contact = self.contact.iter().map(|(contact, _)| *contact);
        contact.chain(self.together.iter().map(|(contact, _)| *contact))
    }

    /// Whether a contact ends by the guard of the instant.
    fn ends(&self, contact: usize) -> bool {
        self.ended().any(|ended| ended == contact)
    }

    /// Whether a contact has an impact at the instant.
    fn is_impact(&self) -> bool {
        self.contact.is_some() && !self.jump.is_empty()
    }

    /// Whether a contact stays in its state with what acts on it as it was.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn is_unchanged(
        &self,
        contact: usize,
        digit: usize,
        forces: &[Form<C>],
    ) -> Result<bool, Obstacle> {
        if digit != self.before[contact] || self.is_impact() {
            return Ok(false);
        }
        let is_same = |before: &Form<C>, form: &Form<C>| {
            let after = self.after(form)?;
            Ok(after == *before || after.is_same_at(before, self.guard))
        };
        let law = &self.forms.laws[contact];
        let holds = self.jump.is_empty() || {
            let before = self.forms.hold(law, self.forces)?;
            is_same(&before, &self.forms.hold(law, forces)?)?
        };
        Ok(holds && is_same(&self.forces[contact], &forces[contact])?)
    }

    /// Whether friction has no velocity of slip at the instant: it has just stuck, or comes through zero, or an impact leaves none.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn is_at_rest(&self, contact: usize) -> Result<bool, Obstacle> {
        if !self.is_friction(contact) {
            return Ok(false);
        }
        if self.is_impact() {
            return self.is_stopped(contact);
        }
        Ok(self.ends(contact) || self.before[contact] == STICK)
    }

    /// Whether an impact leaves a contact no velocity, whatever it was.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn is_stopped(&self, contact: usize) -> Result<bool, Obstacle> {
        let speed = &self.forms.own[self.own].kinematics[contact].speed;
        Ok(self.is_impact() && self.after(speed)?.trimmed().is_zero())
    }

    fn failed(&self, obstacle: Obstacle) -> ContactMistake {
        ContactMistake::Obstacle(self.forms.name(self.own, self.before), obstacle)
    }

    /// The trials after an impact of a contact, which turns the slip of others and the velocity of their gaps.
    fn turned(&self, impact: usize, trial: Trial<C>) -> Result<Vec<Trial<C>>, ContactMistake> {
        let mut trials = vec![trial];
        if self.jump.is_empty() {
            return Ok(trials);
        }
        let own = &self.forms.own[self.own];
        for (contact, law) in self.forms.laws.iter().enumerate() {
            if contact == impact {
                continue;
            }
            let speed = &own.kinematics[contact].speed;
            let after = self.after(speed).map_err(|error| self.failed(error))?;
            let after = after.trimmed();
            let change = after.clone().minus(speed.clone());
            let change = change.map_err(|error| self.failed(error))?.trimmed();
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

    /// The ways on from a trial: by the first contact whose state is not settled by what has held before. `None` where all
    /// are.
    fn unsettled(&self, trial: &Trial<C>) -> Result<Option<Vec<Trial<C>>>, ContactMistake> {
        let forms = self.forms;
        let name = || forms.name(self.own, &trial.digits);
        let forces = match forms.forces(self.own, &trial.digits) {
            Ok(forces) => forces,
            // the motion ends there, and the mode says why
            Err(ContactMistake::Singular(_) | ContactMistake::Paradox(..)) => return Ok(None),
            Err(mistake) => return Err(mistake),
        };
        let first = self.contact.map(|(contact, _)| contact);
        let others = (0..trial.digits.len()).filter(|contact| Some(*contact) != first);
        for contact in first.into_iter().chain(others) {
            if trial.seen[contact] {
                continue;
            }
            let digit = trial.digits[contact];
            let failed = |error| ContactMistake::Obstacle(name(), error);
            let stood_open = self.stood_open(contact, &trial.digits);
            let unchanged = self.is_unchanged(contact, digit, forces);
            if unchanged.map_err(failed)? && !stood_open {
                continue;
            }
            let mut limits = self
                .limits(contact, &trial.digits, forces)
                .map_err(failed)?;
            // what is zero whatever the state fails nowhere
            limits.retain(|(limit, _)| !limit.is_zero());
            if limits.is_empty() {
                continue;
            }
            let mut ways = Vec::new();
            let mut holds = trial.clone();
            holds.seen[contact] = true;
            holds
                .conditions
                .extend(limits.iter().map(|(limit, _)| limit.clone()));
            ways.push(holds);
            for (limit, to) in limits {
                let mut passed = trial.passed.clone();
                passed.push(trial.digits.clone());
                let mut digits = trial.digits.clone();
                digits[contact] = to;
                self.follow(contact, &mut digits);
                // the same states again are no way on
                if passed.contains(&digits) {
                    continue;
                }
                let mut conditions = trial.conditions.clone();
                conditions.push(limit.negative());
                let mut seen = vec![false; digits.len()];
                // released just now: it leaves by the sign of what was too much; a stop that closes has to be pressed on
                seen[contact] = !stood_open;
                ways.push(Trial {
                    pressed: None,
                    digits,
                    conditions,
                    seen,
                    passed,
                });
            }
            // at no gap it closes first
            ways.rotate_left(usize::from(stood_open));
            return Ok(Some(ways));
        }
        Ok(None)
    }

    /// Whether a stop is open whose gap friction has kept, which now closes it: there may be none.
    fn stood_open(&self, contact: usize, digits: &[usize]) -> bool {
        let is_stop = matches!(self.forms.laws[contact], Law::Stop { .. });
        let stood = is_stop && [digits, self.before].map(|digits| digits[contact]) == [OPEN; 2];
        if !stood || self.ends(contact) || !self.jump.is_empty() {
            return false;
        }
        let own = &self.forms.own[self.own];
        let speed = &own.kinematics[contact].speed;
        let released = (0..digits.len()).find_map(|friction| {
            let direction = match digits[friction] {
                FORWARD => 1.0,
                BACKWARD => -1.0,
                _ => return None,
            };
            let is_released = self.is_friction(friction) && self.before[friction] == STICK;
            let along = self.one_speed(friction, speed).filter(|_| is_released)?;
            Some(direction * along < 0.0)
        });
        released == Some(true)
    }

    /// The sign of the factor between the velocity of a contact and another one, which are one where others that stick hold their
    /// difference.
    fn one_speed(&self, contact: usize, other: &Form<C>) -> Option<f64> {
        let mut others = self.before.to_vec();
        others[contact] = 0;
        let held = self.forms.reduced(self.own, &others);
        let own = &self.forms.own[self.own].kinematics[contact].speed;
        let other = other.clone().where_zero(&held);
        other.sign_of_ratio(&own.clone().where_zero(&held))
    }

    /// What is not negative where a contact stays in a state at the instant, and what follows where it is.
    fn limits(
        &self,
        contact: usize,
        digits: &[usize],
        forces: &[Form<C>],
    ) -> Result<Vec<(Form<C>, usize)>, Obstacle> {
        let force = || self.after(&forces[contact]);
        Ok(match (&self.forms.laws[contact], digits[contact]) {
            (law @ Law::Friction { .. }, STICK) => {
                let hold = self.after(&self.forms.hold(law, forces)?)?;
                let upper = (hold.clone().minus(force()?)?.trimmed(), BACKWARD);
                let lower = (hold.plus(force()?)?.trimmed(), FORWARD);
                // a slip that falls to zero is held by a force on its own side
                match self.ends(contact).then(|| self.before[contact]) {
                    Some(FORWARD) => vec![upper],
                    Some(BACKWARD) => vec![lower],
                    _ => vec![upper, lower],
                }
            }
            // a slip that another change has made to begin the wrong way
            (Law::Friction { .. }, FORWARD) if self.is_at_rest(contact)? => {
                let rate = self.forms.acceleration(self.own, contact, forces)?;
                vec![(self.after(&rate)?, STICK)]
            }
            (Law::Friction { .. }, BACKWARD) if self.is_at_rest(contact)? => {
                let rate = self.forms.acceleration(self.own, contact, forces)?;
                vec![(self.after(&rate)?.negative(), STICK)]
            }
            (Law::Stop { .. }, CLOSED) => vec![(force()?, OPEN)],
            (Law::Stop { gap, .. }, OPEN) if self.stood_open(contact, digits) => {
                vec![(gap.clone(), CLOSED)]
            }
            // friction that holds bears what would press on it
            (Law::Stop { .. }, OPEN) if self.ends(contact) && self.is_stopped(contact)? => {
                let rate = self.forms.acceleration(self.own, contact, forces)?;
                vec![(self.after(&rate)?.trimmed(), CLOSED)]
            }
            (
                Law::Spring {
                    damping: Some(_), ..
                },
                CLOSED,
            ) if self.is_impact() => vec![(force()?, PARTING)],
            _ => Vec::new(),
        })
    }
}
