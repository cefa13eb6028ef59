//! What is positive at an equilibrium of a mode.

use super::resting::{Resting, RestingContacts, are_opposite, formulas};
use crate::affine::algebra::Algebra;
use crate::affine::contact::law::Law;
use crate::affine::system::System;

/// What is positive at an equilibrium of a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProvenGuard {
    /// λ of a sliding mode: the field of its first mode pushes to the surface.
    FirstPush,
    /// 1 − λ: that of its second mode does.
    SecondPush,
    /// The `zero` of a switch, by mode and index.
    Zero([usize; 2]),
    /// One of those of a contact in its state.
    Contact(ContactGuard),
}

/// A guard of a contact in its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactGuard {
    pub contact: usize,
    /// Its place among those of the state.
    pub place: usize,
}

impl ProvenGuard {
    /// In words, as the messages of a run have it.
    pub fn name(self, system: &System, resting: &Resting) -> String {
        let push = |side: usize| match resting {
            Resting::Sliding(surface) => {
                format!("the push of `{}`", system.mode_name(surface.sides[side]))
            }
            Resting::Mode(_) | Resting::Contacts(_) => String::new(),
        };
        match self {
            ProvenGuard::Contact(ContactGuard { contact, place }) => {
                let name = system.source.contacts.names().nth(contact);
                let guards = match resting {
                    Resting::Contacts(RestingContacts { states, .. }) => {
                        system.contacts[contact].guards(states[contact])
                    }
                    _ => &[],
                };
                let what = guards.get(place).copied().unwrap_or_default();
                format!("the {what} of `{}`", name.unwrap_or_default())
            }
            ProvenGuard::FirstPush => push(0),
            ProvenGuard::SecondPush => push(1),
            ProvenGuard::Zero([mode, switch]) => {
                let known = system.source.modes.0.get(mode);
                let known = known.and_then(|(_, mode)| mode.until.get(switch));
                format!("`{}`", known.map_or("", |switch| switch.zero.as_str()))
            }
        }
    }
}

/// All switches of a mode, of a sliding mode those of the modes on its sides, by mode and index.
pub fn switches(system: &System, resting: &Resting) -> Vec<[usize; 2]> {
    let sides = match resting {
        Resting::Mode(mode) => vec![*mode],
        Resting::Sliding(surface) => surface.sides.to_vec(),
        Resting::Contacts(contacts) => vec![contacts.own],
    };
    let of_mode = |mode: usize| {
        let count = system.modes.get(mode).map_or(0, |mode| mode.switches.len());
        (0..count).map(move |switch| [mode, switch])
    };
    sides.into_iter().flat_map(of_mode).collect()
}

/// The guards of a mode, those of one formula once. A sliding mode has, beside the pushes that hold it, those of the modes on its sides
/// but its surface; one that contacts make those of each contact, before those of the user's mode.
pub fn guards(system: &System, resting: &Resting) -> Vec<ProvenGuard> {
    let place = formulas(system, None);
    let (mut found, surface) = match resting {
        Resting::Mode(_) => (Vec::new(), None),
        Resting::Sliding(surface) => (
            vec![ProvenGuard::FirstPush, ProvenGuard::SecondPush],
            place.zero(surface.zero),
        ),
        Resting::Contacts(contacts) => {
            let laws = system.contacts.iter().zip(&contacts.states).enumerate();
            let of_contact = |(contact, (law, state)): (usize, (&Law<_>, &usize))| {
                let places = 0..law.guards(*state).len();
                places.map(move |place| ProvenGuard::Contact(ContactGuard { contact, place }))
            };
            (laws.flat_map(of_contact).collect(), None)
        }
    };
    let surface = surface.into_iter();
    let mut known: Vec<_> = surface
        .flat_map(|surface| [surface.clone().negative(), surface])
        .collect();
    for at in switches(system, resting) {
        // a formula without a value is no other's
        let formula = place.zero(at);
        let minus = formula.clone().map(Algebra::negative);
        let is_known = |one: &_| minus.as_ref().is_some_and(|minus| are_opposite(one, minus));
        if !known.iter().any(is_known) {
            known.extend(formula);
            found.push(ProvenGuard::Zero(at));
        }
    }
    found
}

/// Whether the `zero`s of two switches are one by their formulas.
pub fn are_one(system: &System, one: [usize; 2], other: [usize; 2]) -> bool {
    let place = formulas(system, None);
    let both = place.zero(one).zip(place.zero(other));
    one == other || both.is_some_and(|(one, other)| are_opposite(&one, &other.negative()))
}
