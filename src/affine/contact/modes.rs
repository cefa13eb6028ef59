//! Modes of a system with contacts, made when they are asked for.

use super::arrivals::{Arrival, Ending, Instant};
use super::forces::Own;
use super::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, PARTING, Products,
    STICK,
};
use super::mistake::{ContactMistake, MAX_PRODUCTS};
use crate::affine::evaluation::{FormMode, FormSwitch};
use crate::affine::expression::{Algebra, Obstacle};
use crate::affine::form::{Dual, Form};
use crate::affine::slots::Slots;

/// A system with contacts as forms, of which its modes are made.
#[derive(Debug)]
pub struct ContactForms {
    /// The user's modes.
    pub(super) own: Vec<Own>,
    /// The user's switches of these.
    switches: Vec<Vec<FormSwitch>>,
    /// The laws, bounds with forces as states from the number of states on.
    pub(super) laws: Vec<Law<Form>>,
    /// Names of the contacts.
    names: Vec<String>,
    products: Products,
    /// Forces of every mode that has been asked for.
    forces: Slots<Result<Vec<Form>, ContactMistake>>,
}

/// What is to be known of a system to make its modes.
pub struct Written<'a> {
    /// Names of the contacts.
    pub names: Vec<String>,
    /// Their laws.
    pub laws: Vec<Law<Form>>,
    /// The state of every Jenkins element.
    pub stretches: &'a [Option<usize>],
    /// The modes with the states of the contacts.
    pub products: Products,
    /// Angular frequency of the forcing.
    pub omega: Dual,
}

impl ContactForms {
    /// Of the user's modes, in whose rates forces are states from the number of states on.
    ///
    /// # Errors
    /// What is wrong with a contact, with its number.
    pub fn new(
        modes: Vec<FormMode>,
        written: Written,
    ) -> Result<ContactForms, (usize, ContactMistake)> {
        let Written {
            names,
            laws,
            stretches,
            products,
            omega,
        } = written;
        let states = modes.first().map_or(0, |mode| mode.rates.len());
        for (contact, law) in laws.iter().enumerate() {
            check(law, states, &laws).map_err(|mistake| (contact, mistake))?;
        }
        let mut own = Vec::new();
        let mut switches = Vec::new();
        for mode in modes {
            own.push(Own::new(&mode.rates, &laws, (&names, stretches), omega)?);
            switches.push(mode.switches);
        }
        Ok(ContactForms {
            own,
            switches,
            laws,
            names,
            forces: Slots::new(products.count()),
            products,
        })
    }

    /// How many modes there are.
    pub fn count(&self) -> usize {
        self.products.count()
    }

    /// Refuses more modes than are made at once.
    ///
    /// # Errors
    /// There are more.
    pub fn few(&self) -> Result<usize, ContactMistake> {
        let count = self.count();
        match count > MAX_PRODUCTS {
            true => Err(ContactMistake::Products(count)),
            false => Ok(count),
        }
    }

    /// Whether every form that modes are made of is affine, with forces that act with constant weights.
    pub fn is_affine(&self) -> bool {
        let affine = |form: &Form| form.beyond.is_empty();
        let own = self.own.iter().all(|own| {
            let weights = own.weights.iter().flatten();
            let moving = own.kinematics.iter();
            let by = moving.clone().flat_map(|moving| &moving.by);
            own.rates.iter().all(affine)
                && weights.chain(by).all(Form::is_constant)
                && moving
                    .flat_map(|moving| [&moving.speed, &moving.drift])
                    .all(affine)
        });
        let switches = self.switches.iter().flatten();
        let mut of_switches = switches.flat_map(|switch| {
            let reset = switch.reset.iter().map(|(_, form)| form);
            reset.chain(&switch.conditions).chain([&switch.guard])
        });
        let law = |law: &Law<Form>| match law {
            Law::Stop { gap, restitution } => affine(gap) && restitution.is_constant(),
            Law::Spring {
                gap,
                stiffness,
                damping,
            } => {
                affine(gap)
                    && [Some(stiffness), damping.as_ref()]
                        .into_iter()
                        .flatten()
                        .all(Form::is_constant)
            }
            Law::Jenkins {
                slip, stiffness, ..
            } => affine(slip) && stiffness.is_constant(),
            Law::Friction { .. } => law.parts().iter().all(|(_, form)| affine(form)),
        };
        own && of_switches.all(affine) && self.laws.iter().all(law)
    }

    /// Highest multiple of the phase in what modes are made of, where that is affine.
    pub fn highest(&self) -> usize {
        let own = self.own.iter().flat_map(|own| {
            let moving = own.kinematics.iter();
            let moving = moving.flat_map(|moving| [&moving.speed, &moving.drift]);
            own.rates.iter().chain(moving)
        });
        let laws = self.laws.iter().flat_map(|law| law.parts());
        let switches = self.switches.iter().flatten().flat_map(|switch| {
            let reset = switch.reset.iter().map(|(_, form)| form);
            reset.chain(&switch.conditions).chain([&switch.guard])
        });
        let all = own.chain(laws.map(|(_, form)| form)).chain(switches);
        all.map(Form::highest).max().unwrap_or(0)
    }

    pub(super) fn name(&self, own: usize, digits: &[usize]) -> String {
        self.products.name(self.products.number(own, digits))
    }

    /// The forces of contacts in these states.
    pub(super) fn forces(&self, own: usize, digits: &[usize]) -> Result<&[Form], ContactMistake> {
        let name = || self.name(own, digits);
        let find = || self.own[own].forces(&self.laws, digits, (&self.names, &name));
        let number = self.products.number(own, digits);
        let found = self.forces.get_or_make(number, find);
        found.as_deref().map_err(Clone::clone)
    }

    /// The most that friction holds, given all forces.
    pub(super) fn hold(&self, law: &Law<Form>, forces: &[Form]) -> Result<Form, Obstacle> {
        let Law::Friction { bound, hold, .. } = law else {
            return Ok(Form::default());
        };
        let states = self.own[0].rates.len();
        let of = |state: usize| forces.get(state.checked_sub(states)?).cloned();
        hold.as_ref().unwrap_or(bound).with(&of)
    }

    /// The rate of the slip of a contact, or of the velocity of its gap, with these forces.
    pub(super) fn acceleration(
        &self,
        own: usize,
        contact: usize,
        forces: &[Form],
    ) -> Result<Form, Obstacle> {
        let moving = &self.own[own].kinematics[contact];
        let mut rate = moving.drift.clone();
        for (force, by) in forces.iter().zip(&moving.by) {
            rate = rate.plus(by.clone().times(force.clone())?)?;
        }
        Ok(rate.trimmed())
    }

    /// A mode by its number.
    ///
    /// # Errors
    /// Its forces are not determined.
    pub fn mode(&self, number: usize) -> Result<FormMode, ContactMistake> {
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
        let all = endings.iter().enumerate();
        let all = all.flat_map(|(contact, own)| own.iter().map(move |one| (contact, one)));
        for (group, (contact, ending)) in all.enumerate() {
            let together = together(contact, ending, &endings);
            let jump = match ending.impact {
                Some(_) => self.jump(own, contact).map_err(failed)?,
                None => Vec::new(),
            };
            let instant = Instant {
                forms: self,
                own,
                before: &digits,
                forces,
                contact,
                ending,
                together: &together,
                jump: &jump,
            };
            for arrival in instant.arrivals()? {
                switches.push(self.switch(&instant, arrival, group));
            }
        }
        for switch in &self.switches[own] {
            let number = |mode: usize| self.products.number(mode, &digits);
            switches.push(FormSwitch {
                to: number(switch.to),
                rest: switch.rest.map(number),
                ..switch.clone()
            });
        }
        let held = self.held(own, &digits);
        FormMode { rates, switches }.within(&held).map_err(failed)
    }

    /// A form in which forces stand as states in a mode, with these as they are there.
    ///
    /// # Errors
    /// The forces are not determined, or it has no value.
    pub fn of_mode(&self, form: &Form, number: usize) -> Result<Form, ContactMistake> {
        let (own, digits) = self.products.digits(number);
        let forces = self.forces(own, &digits)?;
        let states = self.own[own].rates.len();
        let of = |state: usize| forces.get(state.checked_sub(states)?).cloned();
        let failed = |obstacle| ContactMistake::Obstacle(self.products.name(number), obstacle);
        form.with(&of).map_err(failed)
    }

    /// The rates with these forces.
    fn rates(&self, own: usize, digits: &[usize], forces: &[Form]) -> Result<Vec<Form>, Obstacle> {
        let mut rates = self.own[own].rates.clone();
        let contacts = forces.iter().zip(&self.own[own].weights);
        for (force, weights) in contacts.filter(|(force, _)| !force.is_zero()) {
            for (rate, weight) in rates.iter_mut().zip(weights) {
                if !weight.is_zero() {
                    let more = weight.clone().times(force.clone())?;
                    *rate = std::mem::take(rate).plus(more)?.trimmed();
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

    /// What is zero all along in a mode: the slip of what sticks, the gap of what is closed.
    fn held(&self, own: usize, digits: &[usize]) -> Vec<Form> {
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

    /// Whether a slip is zero all along in a mode.
    fn is_held(&self, own: usize, digits: &[usize], slip: &Form) -> bool {
        let held = self.held(own, digits);
        held.iter().any(|held| slip.sign_of_ratio(held).is_some())
    }

    /// The guards of a contact in a mode with these forces.
    fn endings(
        &self,
        (own, digits): (usize, &[usize]),
        contact: usize,
        forces: &[Form],
    ) -> Result<Vec<Ending>, Obstacle> {
        let plain = |guard: Form, to: usize| Ending {
            guard,
            to,
            impact: None,
            zeros: 0,
        };
        let law = &self.laws[contact];
        let speed = &self.own[own].kinematics[contact].speed;
        Ok(match (law, digits[contact]) {
            (Law::Friction { slip, .. }, FORWARD) => vec![plain(slip.clone(), STICK)],
            (Law::Friction { slip, .. }, BACKWARD) => vec![plain(slip.clone().negative(), STICK)],
            (Law::Friction { hold, .. }, STICK) => {
                let zeros = if hold.is_none() { 2 } else { 0 };
                let (most, force) = (self.hold(law, forces)?, &forces[contact]);
                let upper = most.clone().minus(force.clone())?.trimmed();
                let lower = most.plus(force.clone())?.trimmed();
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
                    ..plain(gap.clone(), to)
                }]
            }
            (Law::Stop { .. }, CLOSED) => vec![Ending {
                zeros: 3,
                ..plain(forces[contact].clone(), OPEN)
            }],
            (Law::Spring { gap, .. }, OPEN) => vec![plain(gap.clone(), CLOSED)],
            (
                Law::Spring {
                    gap, damping: None, ..
                },
                CLOSED,
            ) => {
                vec![plain(gap.clone().negative(), OPEN)]
            }
            (Law::Spring { .. }, CLOSED) => vec![plain(forces[contact].clone(), PARTING)],
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
                vec![plain(gap.clone().negative(), OPEN), plain(force, CLOSED)]
            }
            (Law::Jenkins { bound, .. }, HELD) => {
                let force = &forces[contact];
                vec![
                    plain(bound.clone().plus(force.clone())?.trimmed(), GIVES_FORWARD),
                    plain(
                        bound.clone().minus(force.clone())?.trimmed(),
                        GIVES_BACKWARD,
                    ),
                ]
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
    fn jump(&self, own: usize, contact: usize) -> Result<Vec<(usize, Form)>, Obstacle> {
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
                jump.push((state, Form::state(state).minus(less)?.trimmed()));
            }
        }
        Ok(jump)
    }

    /// The switch of an instant that leads to these states.
    fn switch(&self, instant: &Instant, arrival: Arrival, group: usize) -> FormSwitch {
        let Instant {
            own,
            contact,
            ending,
            ..
        } = *instant;
        let Arrival { digits, conditions } = arrival;
        let rest = (ending.impact == Some(true)).then(|| {
            let mut closed = digits.clone();
            closed[contact] = CLOSED;
            self.products.number(own, &closed)
        });
        let earlier = digits[..contact].iter().zip(&self.laws);
        let index = earlier.map(|(digit, law)| law.guards(*digit).len()).sum();
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
        }
    }
}

/// Other contacts that end by the same guard as one, with their states beyond.
fn together(contact: usize, ending: &Ending, endings: &[Vec<Ending>]) -> Vec<(usize, usize)> {
    let same =
        |one: &&Ending| one.impact.is_none() && one.guard.sign_of_ratio(&ending.guard) == Some(1.0);
    let others = endings
        .iter()
        .enumerate()
        .filter(|(other, _)| *other != contact);
    let found = others.filter_map(|(other, all)| Some((other, all.iter().find(same)?.to)));
    found.collect()
}

/// Refuses a law with a force where none may stand, and bounds that have no meaning.
fn check(law: &Law<Form>, states: usize, laws: &[Law<Form>]) -> Result<(), ContactMistake> {
    let force_in = |form: &Form| form.has_from(states);
    let number = |form: &Form| form.is_constant().then_some(form.constant.value);
    let bounds: Vec<&Form> = match law {
        Law::Friction { slip, bound, hold } => {
            if force_in(slip) {
                return Err(ContactMistake::HasForce);
            }
            [Some(bound), hold.as_ref()].into_iter().flatten().collect()
        }
        Law::Jenkins { bound, .. } => {
            if number(bound).is_none() {
                return Err(ContactMistake::BoundChanges);
            }
            if law.parts().into_iter().any(|(_, form)| force_in(form)) {
                return Err(ContactMistake::HasForce);
            }
            vec![bound]
        }
        Law::Stop { restitution, .. } if number(restitution).is_some_and(|value| value < 0.0) => {
            return Err(ContactMistake::Restitution(restitution.constant.value));
        }
        Law::Stop { .. } | Law::Spring { .. } => {
            match law.parts().into_iter().any(|(_, form)| force_in(form)) {
                true => return Err(ContactMistake::HasForce),
                false => Vec::new(),
            }
        }
    };
    for bound in &bounds {
        if let Some(value) = number(bound).filter(|value| *value < 0.0) {
            return Err(ContactMistake::Bound(value));
        }
        let mut stops = laws.iter().enumerate();
        let impulse = stops.any(|(contact, law)| {
            let impacts = matches!(law, Law::Stop { restitution, .. } if !restitution.is_zero());
            let mut zero = vec![Form::default(); states + laws.len()];
            zero[states + contact] = Form::number(1.0);
            let by = bound.lie(&zero, Dual::default());
            impacts && by.is_ok_and(|by| !by.is_zero())
        });
        if impulse {
            return Err(ContactMistake::Impulse);
        }
    }
    match bounds.as_slice() {
        [bound, hold] => match (number(bound), number(hold)) {
            (Some(bound), Some(hold)) if hold < bound => Err(ContactMistake::Static(hold, bound)),
            _ => Ok(()),
        },
        _ => Ok(()),
    }
}
