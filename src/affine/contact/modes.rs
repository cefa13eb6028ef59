//! Modes of a system with contacts, made when they are asked for.

use super::arrivals::{Arrival, Ending, Instant};
use super::forms::ContactForms;
use super::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, PARTING, STICK,
};
use super::mistake::ContactMistake;
use crate::affine::algebra::{Algebra, Obstacle};
use crate::affine::dual::Measured;
use crate::affine::evaluation::{FormMode, FormSwitch};
use crate::affine::form::Form;

impl<C: Measured> ContactForms<C> {
    /// A mode by its number.
    ///
    /// # Errors
    /// Its forces are not determined.
    pub fn mode(&self, number: usize) -> Result<FormMode<C>, ContactMistake> {
        let (own, digits) = self.products.digits(number);
        let name = self.name(own, &digits);
        let failed = |obstacle| ContactMistake::Obstacle(name.clone(), obstacle);
        let forces = self.forces(own, &digits)?;
        let rates = self.rates(own, &digits, forces).map_err(failed)?;
        let endings = (0..digits.len())
            .map(|contact| self.endings((own, &digits), contact, forces))
            .collect::<Result<Vec<_>, _>>()
            .map_err(failed)?;
        let mut switches = Vec::new();
        let ends = Ends::new(&endings, &self.reduced(own, &digits));
        let holds_what_slips = self.holds_what_slips(own, &digits);
        let all = endings.iter().enumerate();
        let all = all.flat_map(|(contact, own)| own.iter().map(move |one| (contact, one)));
        for (group, (contact, ending)) in all.enumerate() {
            let together = self.together((own, &digits), &ends, (contact, ending), group);
            let jump = match ending.impact {
                Some(_) => self.jump(own, contact).map_err(failed)?,
                None => Vec::new(),
            };
            let instant = Instant {
                forms: self,
                own,
                before: &digits,
                forces,
                guard: &ending.guard,
                contact: Some((contact, ending)),
                together: &together,
                jump: &jump,
            };
            let arrivals = match holds_what_slips {
                true => vec![instant.direct()],
                false => instant.arrivals()?,
            };
            for arrival in arrivals {
                let beyond = arrival.digits.clone();
                let switch = self.switch(&instant, (contact, ending), arrival, group);
                switches.extend(self.carried(&instant, (switch, &beyond))?);
            }
        }
        for switch in &self.switches[own] {
            switches.extend(self.own_switches(switch, &digits, forces)?);
        }
        let held = self.held(own, &digits);
        let mode = FormMode {
            rates,
            switches,
            held,
            bounds: self.bounds(&digits, forces),
        };
        mode.within().map_err(failed)
    }

    /// The rates with these forces.
    fn rates(
        &self,
        own: usize,
        digits: &[usize],
        forces: &[Form<C>],
    ) -> Result<Vec<Form<C>>, Obstacle> {
        let mut rates = self.own[own].rates.clone();
        let contacts = forces.iter().zip(&self.own[own].weights);
        for (force, weights) in contacts.filter(|(force, _)| !force.is_zero()) {
            for (rate, weight) in rates.iter_mut().zip(weights) {
                if !weight.is_zero() {
                    let more = weight.clone().times(force.clone())?;
                    *rate = std::mem::take(rate).held_by(more)?;
                }
            }
        }
        for (contact, (law, digit)) in self.laws.iter().zip(digits).enumerate() {
            let moving = &self.own[own].kinematics[contact];
            if let (Law::Jenkins { slip, .. }, HELD, Some(stretch)) = (law, *digit, moving.stretch)
            {
                rates[stretch] = slip.clone();
            }
        }
        Ok(rates)
    }

    /// The bounds of friction that slips, where their law makes them no constants, with the numbers of the guards that are its slip:
    /// what its force is, without the sign. That of another friction may be a number in a mode, and negative.
    fn bounds(&self, digits: &[usize], forces: &[Form<C>]) -> Vec<(usize, Form<C>)> {
        let contacts = self.laws.iter().zip(digits).zip(forces).enumerate();
        let bounds = contacts.filter_map(|(contact, ((law, digit), force))| {
            let Law::Friction { bound, .. } = law else {
                return None;
            };
            let own = match *digit {
                FORWARD => force.clone().negative(),
                BACKWARD => force.clone(),
                _ => return None,
            };
            let may_fall = !bound.is_constant() && !own.is_zero();
            may_fall.then(|| (self.first_guard(digits, contact), own))
        });
        bounds.collect()
    }

    /// The number of the first guard of a contact in a mode with these states.
    fn first_guard(&self, digits: &[usize], contact: usize) -> usize {
        let earlier = digits[..contact].iter().zip(&self.laws);
        earlier.map(|(digit, law)| law.guards(*digit).len()).sum()
    }

    /// What is zero all along in a mode: the slip of what sticks, the gap of what is closed.
    fn held(&self, own: usize, digits: &[usize]) -> Vec<Form<C>> {
        let contacts = self.laws.iter().zip(digits).enumerate();
        let held = contacts.flat_map(|(contact, (law, digit))| match (law, *digit) {
            (Law::Friction { slip, .. }, STICK) => vec![slip.clone()],
            (Law::Stop { gap, .. }, CLOSED) => {
                vec![gap.clone(), self.own[own].kinematics[contact].speed.clone()]
            }
            _ => Vec::new(),
        });
        held.collect()
    }

    /// What does not change in a mode, by the forces that hold: the slip of what sticks, the velocity of the gap that is closed.
    pub fn kept(&self, number: usize) -> Vec<Form<C>> {
        let (own, digits) = self.products.digits(number);
        let contacts = self.laws.iter().zip(&digits).enumerate();
        let kept = contacts.filter_map(|(contact, law)| match law {
            (Law::Friction { .. }, &STICK) | (Law::Stop { .. }, &CLOSED) => {
                Some(self.own[own].kinematics[contact].speed.clone())
            }
            _ => None,
        });
        kept.collect()
    }

    /// What is held in a mode, each without those before.
    pub(super) fn reduced(&self, own: usize, digits: &[usize]) -> Vec<Form<C>> {
        let mut known: Vec<Form<C>> = Vec::new();
        for held in self.held(own, digits) {
            known.push(held.where_zero(&known));
        }
        known
    }

    /// Whether a slip is zero all along in a mode.
    pub(super) fn is_held(&self, own: usize, digits: &[usize], slip: &Form<C>) -> bool {
        let held = self.reduced(own, digits);
        slip.clone().where_zero(&held).is_zero()
    }

    /// Whether what sticks holds at zero the slip of friction that slips in a mode, as the third of three slips of two blocks: no
    /// motion gets on in it, and of the chains of changes that would leave it there are thousands. What a closed stop holds is
    /// pressed on it by a force that friction alone does not hold.
    fn holds_what_slips(&self, own: usize, digits: &[usize]) -> bool {
        let opened = self.laws.iter().zip(digits);
        let opened = opened.map(|(law, digit)| match law {
            Law::Stop { .. } => OPEN,
            _ => *digit,
        });
        let opened: Vec<usize> = opened.collect();
        (0..self.laws.len()).any(|contact| self.is_slip_held(own, &opened, contact))
    }

    /// Whether the slip of friction that slips in a mode is held at zero there.
    pub(super) fn is_slip_held(&self, own: usize, digits: &[usize], contact: usize) -> bool {
        match (&self.laws[contact], digits[contact]) {
            (Law::Friction { slip, .. }, FORWARD | BACKWARD) => self.is_held(own, digits, slip),
            _ => false,
        }
    }

    /// Other contacts that end by the same guard as one, with their states beyond. Those whose guard is the same by what others hold
    /// end with it only where the forces beyond are determined then.
    fn together(
        &self,
        (own, digits): (usize, &[usize]),
        ends: &Ends<C>,
        (contact, ending): (usize, &Ending<C>),
        group: usize,
    ) -> Vec<(usize, usize)> {
        let found = ends.beside(contact, &ends.within[group], &ends.within);
        let mut beyond = digits.to_vec();
        beyond[contact] = ending.to;
        for (other, to) in &found {
            beyond[*other] = *to;
        }
        match found.is_empty() || self.forces(own, &beyond).is_ok() {
            true => found,
            false => ends.beside(contact, &ends.guards[group], &ends.guards),
        }
    }

    /// The guards of a contact in a mode with these forces.
    fn endings(
        &self,
        (own, digits): (usize, &[usize]),
        contact: usize,
        forces: &[Form<C>],
    ) -> Result<Vec<Ending<C>>, Obstacle> {
        let plain = |guard: Form<C>, to: usize| Ending {
            guard,
            to,
            impact: None,
            zeros: 0,
            keeps: false,
        };
        let law = &self.laws[contact];
        let speed = &self.own[own].kinematics[contact].speed;
        let still = |guard: &Form<C>, to: usize| Ending {
            keeps: self.is_held(own, digits, speed) && !self.holds_what_slips(own, digits),
            ..plain(guard.clone(), to)
        };
        Ok(match (law, digits[contact]) {
            (Law::Friction { slip, .. }, FORWARD) => vec![still(slip, STICK)],
            (Law::Friction { slip, .. }, BACKWARD) => vec![still(&slip.clone().negative(), STICK)],
            (Law::Friction { hold, .. }, STICK) => {
                let zeros = if hold.is_none() { 2 } else { 0 };
                let [upper, lower] = left(self.hold(law, forces)?, &forces[contact])?;
                [(upper, BACKWARD), (lower, FORWARD)]
                    .map(|(guard, to)| Ending {
                        zeros,
                        ..plain(guard, to)
                    })
                    .into()
            }
            (Law::Stop { gap, restitution }, OPEN) => {
                let impact = !restitution.is_zero();
                let to = if impact { OPEN } else { CLOSED };
                vec![Ending {
                    impact: Some(impact),
                    ..still(gap, to)
                }]
            }
            (Law::Stop { .. }, CLOSED) => vec![Ending {
                zeros: 3,
                ..plain(forces[contact].clone(), OPEN)
            }],
            (Law::Spring { gap, .. }, OPEN) => vec![still(gap, CLOSED)],
            (
                Law::Spring {
                    gap, damping: None, ..
                },
                CLOSED,
            ) => {
                vec![still(&gap.clone().negative(), OPEN)]
            }
            (Law::Spring { .. }, CLOSED) => vec![still(&forces[contact], PARTING)],
            (
                Law::Spring {
                    gap,
                    stiffness,
                    damping: Some(damping),
                },
                PARTING,
            ) => {
                let elastic = gap.clone().times(stiffness.clone())?;
                let force = elastic.plus(speed.clone().times(damping.clone())?)?;
                vec![still(&gap.clone().negative(), OPEN), still(&force, CLOSED)]
            }
            (Law::Jenkins { slip, bound, .. }, HELD) => {
                let keeps = self.is_held(own, digits, slip);
                let [upper, lower] = left(bound.clone(), &forces[contact])?;
                [(lower, GIVES_FORWARD), (upper, GIVES_BACKWARD)]
                    .map(|(guard, to)| Ending {
                        keeps,
                        ..plain(guard, to)
                    })
                    .into()
            }
            // the friction on its slip sticks: it goes on where that does, which is decided there
            (Law::Jenkins { slip, .. }, GIVES_FORWARD | GIVES_BACKWARD)
                if self.is_held(own, digits, slip) =>
            {
                vec![plain(Form::number(1.0), HELD)]
            }
            (Law::Jenkins { slip, .. }, GIVES_FORWARD) => vec![plain(slip.clone(), HELD)],
            (Law::Jenkins { slip, .. }, GIVES_BACKWARD) => {
                vec![plain(slip.clone().negative(), HELD)]
            }
            _ => Vec::new(),
        })
    }

    /// The states that jump at an impact of a contact: x − (1 + e)ġ w/(∇ġ·w).
    fn jump(&self, own: usize, contact: usize) -> Result<Vec<(usize, Form<C>)>, Obstacle> {
        let Law::Stop { restitution, .. } = &self.laws[contact] else {
            return Ok(Vec::new());
        };
        let own = &self.own[own];
        let moving = &own.kinematics[contact];
        let times = Form::number(1.0).plus(restitution.clone())?;
        let impulse = moving.speed.clone().times(times)?;
        let impulse = impulse.over(moving.by[contact].clone())?;
        let mut jump = Vec::new();
        for (state, weight) in own.weights[contact].iter().enumerate() {
            if !weight.is_zero() {
                let less = impulse.clone().times(weight.clone())?;
                jump.push((state, Form::state(state).held_by(less.negative())?));
            }
        }
        Ok(jump)
    }

    /// A switch of the user's mode from these states of the contacts with these forces: one for each end of the chain of changes
    /// that it begins.
    pub(super) fn own_switches(
        &self,
        switch: &FormSwitch<C>,
        before: &[usize],
        forces: &[Form<C>],
    ) -> Result<Vec<FormSwitch<C>>, ContactMistake> {
        let instant = Instant {
            forms: self,
            own: switch.to,
            before,
            forces,
            guard: &switch.guard,
            contact: None,
            together: &[],
            jump: &switch.reset,
        };
        let of_arrival = |arrival: Arrival<C>| {
            let Arrival {
                digits,
                conditions,
                pressed,
            } = arrival;
            let behind = |contact: usize| ContactMistake::Behind(self.names[contact].clone());
            let number = |mode: usize| self.products.number(mode, &digits);
            let mut switch = FormSwitch {
                to: number(switch.to),
                rest: switch.rest.map(number),
                refusal: pressed.map(behind),
                ..switch.clone()
            };
            switch.conditions.extend(conditions);
            switch
        };
        let arrivals = instant.arrivals()?;
        Ok(arrivals.into_iter().map(of_arrival).collect())
    }

    /// The switch of an instant at which a contact ends that leads to these states.
    fn switch(
        &self,
        instant: &Instant<C>,
        (contact, ending): (usize, &Ending<C>),
        arrival: Arrival<C>,
        group: usize,
    ) -> FormSwitch<C> {
        let own = instant.own;
        let Arrival {
            digits,
            conditions,
            pressed,
        } = arrival;
        let names = |closed: usize| [contact, closed].map(|one| self.names[one].clone());
        let rest = (ending.impact == Some(true)).then(|| {
            let mut closed = digits.clone();
            closed[contact] = CLOSED;
            self.products.number(own, &closed)
        });
        let index = self.first_guard(&digits, contact);
        let direct = digits[contact] == ending.to && ending.zeros > 0;
        FormSwitch {
            guard: ending.guard.clone(),
            to: self.products.number(own, &digits),
            rest,
            reset: instant.jump.to_vec(),
            conditions,
            tangent: direct.then_some((index, ending.zeros)),
            group: Some(group),
            name: Some(self.names[contact].clone()),
            refusal: pressed.map(|closed| {
                let [impact, closed] = names(closed);
                ContactMistake::Pressed { impact, closed }
            }),
            keeps: ending.keeps,
        }
    }
}

/// The ends of a mode, in the order of its guards.
struct Ends<C> {
    /// The contact of each, the state that it leads to, and whether it is an impact.
    of: Vec<(usize, usize, bool)>,
    /// The guard of each.
    guards: Vec<Form<C>>,
    /// The same where what contacts hold is zero.
    within: Vec<Form<C>>,
}

impl<C: Measured> Ends<C> {
    fn new(endings: &[Vec<Ending<C>>], held: &[Form<C>]) -> Ends<C> {
        let all = endings.iter().enumerate();
        let all = all.flat_map(|(contact, own)| own.iter().map(move |one| (contact, one)));
        let of = |(contact, one): (usize, &Ending<C>)| (contact, one.to, one.impact.is_some());
        let guards = all.clone().map(|(_, one)| one.guard.clone());
        let within = all
            .clone()
            .map(|(_, one)| one.guard.clone().where_zero(held));
        Ends {
            guards: guards.collect(),
            within: within.collect(),
            of: all.map(of).collect(),
        }
    }

    /// Contacts beside one that end by a guard, as these guards are, with their states beyond.
    fn beside(&self, contact: usize, guard: &Form<C>, guards: &[Form<C>]) -> Vec<(usize, usize)> {
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (other, (of, to, impact)) in guards.iter().zip(&self.of) {
            let new = *of != contact && found.iter().all(|(known, _)| known != of);
            if new && !impact && other.sign_of_ratio(guard) == Some(1.0) {
                found.push((*of, *to));
            }
        }
        found
    }
}

/// What a bound leaves of a force, above it and below.
fn left<C: Measured>(bound: Form<C>, force: &Form<C>) -> Result<[Form<C>; 2], Obstacle> {
    let above = bound.clone().minus(force.clone())?.trimmed();
    let below = bound.plus(force.clone())?.trimmed();
    Ok([above, below])
}
