//! Where a mode with contacts ends, and which states of the contacts follow.
//!
//! What one contact does may make others change in the same instant: a block that stops loads its neighbour, an impact
//! turns a slip round. From the states that the contact which ends would lead to, every one is looked at in the order of the
//! file, and where what it does hangs on the state of the instant the states beyond are looked at, too. Every combination of states
//! that is come to is one exit, with what makes each contact stay in its state there: by which of many chains of changes it is come
//! to decides nothing. A switch of the user's own modes begins such changes, too: beyond it other forces act.

use std::collections::HashSet;

use super::forms::ContactForms;
use super::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, STICK,
};
use super::mistake::{ContactMistake, MAX_STATES};
use crate::affine::algebra::{Algebra, Obstacle};
use crate::affine::dual::{Dual, Measured};
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
    /// A closed stop on which the impulse of the impact presses, or one behind which a reset leads: no motion follows.
    pub pressed: Option<usize>,
}

/// Contacts in states that are on trial.
#[derive(Clone)]
pub(super) struct Trial<C> {
    /// The state of each.
    pub digits: Vec<usize>,
    /// What is not negative where an impact leads to them, or to those from which other contacts have changed.
    pub conditions: Vec<Form<C>>,
    /// A contact that leaves its state whatever else it does there.
    released: Option<usize>,
    /// The state that each contact has left since, if it has, and what was negative there.
    left: Vec<Option<(usize, Form<C>)>>,
    /// See [`Arrival::pressed`].
    pub pressed: Option<usize>,
}

/// What is not negative where a contact stays in a state at an instant, and the state that follows where it is.
type Limit<C> = (Form<C>, usize);

/// What is still to be done where it is found what follows at an instant.
enum Open<C> {
    /// To look at a trial.
    Trial(Trial<C>),
    /// To take in an arrival.
    End(Arrival<C>),
}

/// What follows from a trial: the trials that come before it, it, and those beyond it.
type Looked<C> = (Vec<Trial<C>>, Arrival<C>, Vec<Trial<C>>);

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
pub(super) fn ways<C>(law: &Law<Form<C>>) -> [usize; 3] {
    match law {
        Law::Friction { .. } => [FORWARD, BACKWARD, STICK],
        Law::Jenkins { .. } => [HELD, HELD, HELD],
        Law::Stop { .. } | Law::Spring { .. } => [OPEN, CLOSED, CLOSED],
    }
}

impl<C: Measured> Instant<'_, C> {
    /// Every combination of states that may follow.
    ///
    /// # Errors
    /// Forces that are not determined, or more combinations than are looked at.
    pub fn arrivals(&self) -> Result<Vec<Arrival<C>>, ContactMistake> {
        let trial = self.first();
        let first = match self.contact {
            Some((contact, _)) => self.turned(contact, trial)?,
            None => self.reset(trial)?,
        };
        let mut ends = Vec::new();
        let mut dead = Vec::new();
        for trial in first {
            let mut known = HashSet::new();
            let mut open = vec![Open::Trial(trial)];
            while let Some(next) = open.pop() {
                let trial = match next {
                    Open::End(end) => {
                        ends.push(end);
                        continue;
                    }
                    Open::Trial(trial) if known.contains(&trial.digits) => continue,
                    Open::Trial(trial) => trial,
                };
                let Some((before, end, beyond)) = self.looked_at(&trial)? else {
                    dead.push(self.dead_end(trial)?);
                    continue;
                };
                if known.len() == MAX_STATES {
                    let name = self.forms.name(self.own, self.before);
                    return Err(ContactMistake::States(name));
                }
                known.insert(trial.digits);
                open.extend(beyond.into_iter().map(Open::Trial).rev());
                open.push(Open::End(end));
                open.extend(before.into_iter().map(Open::Trial).rev());
            }
        }
        // where no motion follows comes last
        ends.extend(dead);
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
        let mut released = None;
        if let Some((contact, ending)) = self.contact {
            digits[contact] = ending.to;
            // what is released leaves by the sign of what was too much, as long as nothing else changes
            let is_released = self.is_friction(contact) && self.before[contact] == STICK;
            released = is_released.then_some(contact);
        }
        for (contact, to) in self.together {
            digits[*contact] = *to;
        }
        // a slip that a closed stop has held is zero: where that holds it no more it sticks if its friction does
        let beyond = digits.clone();
        for (contact, digit) in digits.iter_mut().enumerate() {
            let is_held = |digits: &[usize]| self.forms.is_slip_held(self.own, digits, contact);
            if is_held(self.before) && !is_held(&beyond) {
                *digit = STICK;
            }
        }
        // after an impact the sign of the slip tells
        let leads = |contact: &usize| !self.is_impact() || self.is_friction(*contact);
        for contact in self.ended().filter(leads) {
            self.follow(contact, &mut digits);
        }
        Trial {
            released,
            conditions: Vec::new(),
            left: vec![None; digits.len()],
            pressed: None,
            digits,
        }
    }

    /// A form after the jump.
    pub(super) fn after(&self, form: &Form<C>) -> Result<Form<C>, Obstacle> {
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
        if digit != self.before[contact] || self.is_impact() || self.is_reset_to_rest(contact)? {
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

    /// Whether friction has no velocity of slip at the instant: it has just stuck, or comes through zero, or a jump leaves none.
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
        Ok(match self.reset_slip(contact)? {
            Some(slip) => slip.is_zero(),
            None => self.ends(contact) || self.before[contact] == STICK,
        })
    }

    /// The slip of a contact after a reset of the user's own, if that changes it.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn reset_slip(&self, contact: usize) -> Result<Option<Form<C>>, Obstacle> {
        let (Law::Friction { slip, .. } | Law::Jenkins { slip, .. }) = &self.forms.laws[contact]
        else {
            return Ok(None);
        };
        if self.contact.is_some() || self.jump.is_empty() {
            return Ok(None);
        }
        let held = self.forms.reduced(self.own, self.before);
        let slip = self.moved(slip, &held)?;
        Ok((!slip.stays(self.guard)).then_some(slip.after))
    }

    /// Whether that leaves no slip.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn is_reset_to_rest(&self, contact: usize) -> Result<bool, Obstacle> {
        Ok(self.reset_slip(contact)?.is_some_and(|slip| slip.is_zero()))
    }

    /// Whether an impact leaves a contact no velocity, whatever it was.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn is_stopped(&self, contact: usize) -> Result<bool, Obstacle> {
        let speed = &self.forms.own[self.own].kinematics[contact].speed;
        Ok(self.is_impact() && self.after(speed)?.trimmed().is_zero())
    }

    pub(super) fn failed_in(&self, digits: &[usize], obstacle: Obstacle) -> ContactMistake {
        ContactMistake::Obstacle(self.forms.name(self.own, digits), obstacle)
    }

    /// What follows from a trial; nothing where the forces are not determined: the motion ends there, and the mode says why.
    fn looked_at(&self, trial: &Trial<C>) -> Result<Option<Looked<C>>, ContactMistake> {
        let mut conditions = trial.conditions.clone();
        let [mut before, mut beyond] = [const { Vec::new() }; 2];
        if trial.pressed.is_none() {
            let failed = |error| self.failed_in(&trial.digits, error);
            let forces = match self.forms.forces(self.own, &trial.digits) {
                Ok(forces) => forces,
                Err(ContactMistake::Singular(_) | ContactMistake::Paradox(..)) => return Ok(None),
                Err(mistake) => return Err(mistake),
            };
            for contact in self.others() {
                let stood_open = self.stood_open(contact, &trial.digits);
                let limits = self.open_limits(contact, trial, forces, stood_open);
                let limits = limits.map_err(failed)?;
                let next = limits
                    .iter()
                    .map(|limit| self.changed(trial, contact, limit));
                // at no gap it closes first
                let ways = match stood_open {
                    true => &mut before,
                    false => &mut beyond,
                };
                ways.extend(next);
                let own = match stood_open {
                    // at no gap it has been tried closed before
                    true => Ok(limits.into_iter().map(|(limit, _)| limit).collect()),
                    false => self.conditions(contact, trial, limits),
                };
                conditions.extend(own.map_err(failed)?);
            }
        }
        let end = Arrival {
            digits: trial.digits.clone(),
            conditions,
            pressed: trial.pressed,
        };
        Ok(Some((before, end, beyond)))
    }

    /// A trial from which no motion follows, with all that led to it.
    fn dead_end(&self, trial: Trial<C>) -> Result<Arrival<C>, ContactMistake> {
        let mut conditions = trial.conditions.clone();
        for contact in self.others() {
            let broken = self.broken(contact, &trial);
            conditions.extend(broken.map_err(|error| self.failed_in(&trial.digits, error))?);
        }
        Ok(Arrival {
            digits: trial.digits,
            conditions,
            pressed: None,
        })
    }

    /// All contacts, the one that ends first.
    fn others(&self) -> impl Iterator<Item = usize> {
        let first = self.contact.map(|(contact, _)| contact);
        let others = (0..self.before.len()).filter(move |contact| Some(*contact) != first);
        first.into_iter().chain(others)
    }

    /// A trial in which a contact has changed.
    fn changed(&self, trial: &Trial<C>, contact: usize, (limit, to): &Limit<C>) -> Trial<C> {
        let mut changed = trial.clone();
        changed.released = None;
        changed.left[contact] = Some((trial.digits[contact], limit.clone()));
        changed.digits[contact] = *to;
        self.follow(contact, &mut changed.digits);
        changed
    }

    /// What is not negative where a contact stays in its state on trial, if that hangs on the state of the instant: of a stop that
    /// stood open it does.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn open_limits(
        &self,
        contact: usize,
        trial: &Trial<C>,
        forces: &[Form<C>],
        stood_open: bool,
    ) -> Result<Vec<Limit<C>>, Obstacle> {
        let digit = trial.digits[contact];
        let settled = trial.released == Some(contact)
            || self.is_unchanged(contact, digit, forces)? && !stood_open;
        if settled {
            return Ok(Vec::new());
        }
        let mut limits = self.limits(contact, &trial.digits, forces)?;
        // what is zero whatever the state fails nowhere
        limits.retain(|(limit, _)| !limit.is_zero());
        Ok(limits)
    }

    /// What is not negative where a contact is in its state at an end with these limits: it holds there, or another state would
    /// not.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn conditions(
        &self,
        contact: usize,
        trial: &Trial<C>,
        limits: Vec<Limit<C>>,
    ) -> Result<Vec<Form<C>>, Obstacle> {
        let [_, _, held] = ways(&self.forms.laws[contact]);
        let holds = trial.digits[contact] == held;
        // a gap that stood open is another condition than the force that closes it
        let left = trial.left[contact].as_ref();
        let stood_open = left.is_some_and(|(left, _)| *left != held)
            && matches!(self.forms.laws[contact], Law::Stop { .. })
            && !self.ends(contact);
        let broken = match holds && !stood_open {
            true => None,
            false => self.broken(contact, trial)?,
        };
        let own = limits.into_iter().map(|(limit, _)| limit);
        let own = own.filter(|_| holds || broken.is_none());
        Ok(own.chain(broken.clone()).collect())
    }

    /// What is not negative where a contact has left a state because it does not stay in it, with all others as they are on trial;
    /// as they were then, where that state has no forces beside them.
    ///
    /// # Errors
    /// An operation that has no result there.
    fn broken(&self, contact: usize, trial: &Trial<C>) -> Result<Option<Form<C>>, Obstacle> {
        let Some((left, limit)) = &trial.left[contact] else {
            return Ok(None);
        };
        let mut beside = trial.digits.clone();
        beside[contact] = *left;
        let limit = match self.forms.forces(self.own, &beside) {
            Ok(forces) => {
                let limits = self.limits(contact, &beside, forces)?;
                let own = limits
                    .into_iter()
                    .find(|(limit, to)| *to == trial.digits[contact] && !limit.is_zero());
                own.map(|(limit, _)| limit)
            }
            Err(_) => Some(limit.clone()),
        };
        Ok(limit.map(Form::negative))
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
    ) -> Result<Vec<Limit<C>>, Obstacle> {
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
            // a slider that a reset has stopped goes on by the sign of its acceleration
            (Law::Jenkins { .. }, digit @ (GIVES_FORWARD | GIVES_BACKWARD))
                if self.is_reset_to_rest(contact)? =>
            {
                let rate = self.after(&self.forms.acceleration(self.own, contact, forces)?)?;
                let goes_on = match digit {
                    GIVES_FORWARD => rate,
                    _ => rate.negative(),
                };
                vec![(goes_on.trimmed(), HELD)]
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
            _ => Vec::new(),
        })
    }
}
