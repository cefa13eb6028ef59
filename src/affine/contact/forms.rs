//! A system with contacts as forms: what its modes are made of.

use super::forces::Own;
use super::law::{Law, Products};
use super::mistake::{ContactMistake, MAX_PRODUCTS, SpringConstant};
use crate::affine::algebra::{Algebra, Obstacle};
use crate::affine::dual::{Dual, Measured};
use crate::affine::evaluation::{FormMode, FormSwitch};
use crate::affine::form::Form;
use crate::affine::slots::Slots;

/// A system with contacts as forms, of which its modes are made.
#[derive(Debug)]
pub struct ContactForms<C = Dual> {
    /// The user's modes.
    pub(super) own: Vec<Own<C>>,
    /// The user's switches of these.
    pub(super) switches: Vec<Vec<FormSwitch<C>>>,
    /// The laws, bounds with forces as states from the number of states on.
    pub(super) laws: Vec<Law<Form<C>>>,
    /// Names of the contacts.
    pub(super) names: Vec<String>,
    /// The modes with the states of the contacts.
    pub(super) products: Products,
    /// Forces of every mode that has been asked for.
    forces: Slots<Result<Vec<Form<C>>, ContactMistake>>,
}

/// What is to be known of a system to make its modes.
pub struct Written<'a, C = Dual> {
    /// Names of the contacts.
    pub names: Vec<String>,
    /// Their laws.
    pub laws: Vec<Law<Form<C>>>,
    /// The state of every Jenkins element.
    pub stretches: &'a [Option<usize>],
    /// The modes with the states of the contacts.
    pub products: Products,
    /// Angular frequency of the forcing.
    pub omega: C,
}

impl<C: Measured> ContactForms<C> {
    /// Of the user's modes, in whose rates forces are states from the number of states on.
    ///
    /// # Errors
    /// What is wrong with a contact, with its number.
    pub fn new(
        modes: Vec<FormMode<C>>,
        written: Written<C>,
    ) -> Result<ContactForms<C>, (usize, ContactMistake)> {
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
            own.push(Own::new(
                &mode.rates,
                &laws,
                (&names, stretches),
                omega.clone(),
            )?);
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
        let affine = |form: &Form<C>| form.beyond.is_empty();
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
        let mut of_switches = switches.flat_map(FormSwitch::forms);
        let law = |law: &Law<Form<C>>| match law {
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
        let switches = self.switches.iter().flatten();
        let switches = switches.flat_map(FormSwitch::forms);
        let all = own.chain(laws.map(|(_, form)| form)).chain(switches);
        all.map(Form::highest).max().unwrap_or(0)
    }

    /// The name of the first contact.
    pub fn first(&self) -> &str {
        self.names.first().map_or("", String::as_str)
    }

    /// Numbers that make no sense where they are negative: bounds, what a static one has more, restitutions, what these are less than 1,
    /// stiffnesses, dampings, and what forces do to what they act on.
    pub fn signs(&self) -> Vec<C> {
        let influence = self.own.iter().flat_map(|own| {
            let moving = own.kinematics.iter().enumerate();
            moving.map(|(contact, moving)| moving.by[contact].clone())
        });
        let of_laws = self.laws.iter().flat_map(|law| match law {
            Law::Friction { bound, hold, .. } => {
                let more = hold.clone().map(|hold| hold.minus(bound.clone()));
                let more = more.and_then(Result::ok);
                [Some(bound.clone()), more].into_iter().flatten().collect()
            }
            Law::Jenkins {
                bound, stiffness, ..
            } => vec![bound.clone(), stiffness.clone()],
            Law::Stop { restitution, .. } => {
                let lost = Form::number(1.0).minus(restitution.clone()).ok();
                std::iter::once(restitution.clone()).chain(lost).collect()
            }
            Law::Spring {
                stiffness, damping, ..
            } => [Some(stiffness.clone()), damping.clone()]
                .into_iter()
                .flatten()
                .collect(),
        });
        let numbers = influence.chain(of_laws).filter(Form::is_constant);
        numbers.map(|form| form.constant).collect()
    }

    pub(super) fn name(&self, own: usize, digits: &[usize]) -> String {
        self.products.name(self.products.number(own, digits))
    }

    /// The forces of contacts in these states.
    pub(super) fn forces(
        &self,
        own: usize,
        digits: &[usize],
    ) -> Result<&[Form<C>], ContactMistake> {
        let name = || self.name(own, digits);
        let find = || self.own[own].forces(&self.laws, digits, (&self.names, &name));
        let number = self.products.number(own, digits);
        let found = self.forces.get_or_make(number, find);
        found.as_deref().map_err(Clone::clone)
    }

    /// The most that friction holds, given all forces.
    pub(super) fn hold(&self, law: &Law<Form<C>>, forces: &[Form<C>]) -> Result<Form<C>, Obstacle> {
        let Law::Friction { bound, hold, .. } = law else {
            return Ok(Form::default());
        };
        self.with_forces(hold.as_ref().unwrap_or(bound), forces)
    }

    /// A form in which forces stand as states, with these in their place.
    fn with_forces(&self, form: &Form<C>, forces: &[Form<C>]) -> Result<Form<C>, Obstacle> {
        let states = self.own[0].rates.len();
        form.with(&|state| forces.get(state.checked_sub(states)?).cloned())
    }

    /// The rate of the slip of a contact, or of the velocity of its gap, with these forces.
    pub(super) fn acceleration(
        &self,
        own: usize,
        contact: usize,
        forces: &[Form<C>],
    ) -> Result<Form<C>, Obstacle> {
        let moving = &self.own[own].kinematics[contact];
        let mut rate = moving.drift.clone();
        for (force, by) in forces.iter().zip(&moving.by) {
            // what a force holds it takes away, of which rounding is left
            rate = rate.held_by(by.clone().times(force.clone())?)?;
        }
        Ok(rate)
    }

    /// A form in which forces stand as states in a mode, with these as they are there.
    ///
    /// # Errors
    /// The forces are not determined, or it has no value.
    pub fn of_mode(&self, form: &Form<C>, number: usize) -> Result<Form<C>, ContactMistake> {
        let (own, digits) = self.products.digits(number);
        let forces = self.forces(own, &digits)?;
        let failed = |obstacle| ContactMistake::Obstacle(self.products.name(number), obstacle);
        self.with_forces(form, forces).map_err(failed)
    }
}

/// Refuses a law with a force where none may stand, and bounds that have no meaning.
fn check<C: Measured>(
    law: &Law<Form<C>>,
    states: usize,
    laws: &[Law<Form<C>>],
) -> Result<(), ContactMistake> {
    let force_in = |form: &Form<C>| form.has_from(states);
    let number = |form: &Form<C>| form.is_constant().then_some(form.constant.certain());
    let is_none = |restitution: f64| !(0.0..=1.0).contains(&restitution);
    let bounds: Vec<&Form<C>> = match law {
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
        Law::Stop { restitution, .. } if number(restitution).is_some_and(is_none) => {
            return Err(ContactMistake::Restitution(restitution.constant.certain()));
        }
        Law::Stop { .. } | Law::Spring { .. } => {
            match law.parts().into_iter().any(|(_, form)| force_in(form)) {
                true => return Err(ContactMistake::HasForce),
                false => Vec::new(),
            }
        }
    };
    let coefficients = match law {
        Law::Spring {
            stiffness, damping, ..
        } => vec![
            (SpringConstant::Stiffness, Some(stiffness)),
            (SpringConstant::Damping, damping.as_ref()),
        ],
        Law::Jenkins { stiffness, .. } => vec![(SpringConstant::Stiffness, Some(stiffness))],
        Law::Friction { .. } | Law::Stop { .. } => Vec::new(),
    };
    for (coefficient, form) in coefficients {
        if let Some(value) = form.and_then(number).filter(|value| *value < 0.0) {
            return Err(ContactMistake::Coefficient(coefficient, value));
        }
    }
    for bound in &bounds {
        if let Some(value) = number(bound).filter(|value| *value < 0.0) {
            return Err(ContactMistake::Bound(value));
        }
        let mut stops = laws.iter().enumerate();
        let impulse = stops.any(|(contact, law)| {
            let impacts = matches!(law, Law::Stop { restitution, .. } if !restitution.is_zero());
            let by = bound.slope(states + contact);
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
