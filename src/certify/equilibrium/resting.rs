//! The mode that an equilibrium is one of.

use super::OpenEquilibrium;
use super::place::NameValues;
use crate::affine::algebra::{Algebra, Operation};
use crate::affine::contact::law::{CLOSED, Law, STICK};
use crate::affine::expression::Expression;
use crate::affine::system::System;
use crate::certify::orbit::exact::NamePolynomial;

/// The mode that an equilibrium is one of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Resting {
    /// One of the file.
    Mode(usize),
    /// A sliding mode.
    Sliding(SlidingSurface),
    /// One that contacts make.
    Contacts(RestingContacts),
}

/// A mode that contacts make.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RestingContacts {
    /// The user's mode.
    pub own: usize,
    /// The state of every contact.
    pub states: Vec<usize>,
}

/// The surface of a sliding mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SlidingSurface {
    /// The modes on its two sides.
    pub sides: [usize; 2],
    /// The switch of the first whose `zero` is its form h, positive in the first, as mode and index.
    pub zero: [usize; 2],
    /// That of the second, whose `zero` is −h.
    pub back: [usize; 2],
}

/// The names of a system as formulas, but for a state that stands for another.
pub fn formulas(
    system: &System,
    replaced: Option<(usize, NamePolynomial)>,
) -> NameValues<'_, NamePolynomial> {
    let named = |name: &str| NamePolynomial::named(name.to_owned());
    let states = system.source.states.iter().map(|name| named(name));
    let mut states: Vec<NamePolynomial> = states.collect();
    if let Some((state, formula)) = replaced {
        states[state] = formula;
    }
    let forces = system.source.contacts.names().map(named).collect();
    let parameters = system.source.parameters.names().map(named).collect();
    NameValues::new(system, [states, forces, parameters], named("pi"))
}

/// Whether two formulas add up to zero.
pub fn are_opposite(one: &NamePolynomial, other: &NamePolynomial) -> bool {
    let sum = one.clone().operate(Operation::Plus, other.clone());
    sum.is_ok_and(|sum| sum.is_zero())
}

impl Resting {
    /// The mode of a name.
    ///
    /// # Errors
    /// There is none, or its surface is not known.
    pub fn new(system: &System, name: &str) -> Result<Resting, OpenEquilibrium> {
        let mode = system.mode(name).ok_or(OpenEquilibrium::System)?;
        if let Some(products) = &system.products {
            let (own, states) = products.digits(mode);
            return Ok(Resting::Contacts(RestingContacts { own, states }));
        }
        let Some(index) = mode.checked_sub(system.modes.len()) else {
            return Ok(Resting::Mode(mode));
        };
        let sides = *system.sliding.get(index).ok_or(OpenEquilibrium::System)?;
        let place = formulas(system, None);
        let leading = |from: usize, to: usize| {
            let switches = system.modes[from].switches.iter().enumerate();
            let leading = switches.filter(move |(_, switch)| switch.to == to);
            leading.map(move |(index, _)| [from, index])
        };
        let [first, second] = sides;
        let mut pairs = leading(first, second)
            .flat_map(|zero| leading(second, first).map(move |back| (zero, back)));
        let is_surface = |(zero, back): &([usize; 2], [usize; 2])| {
            let both = place.zero(*zero).zip(place.zero(*back));
            both.is_some_and(|(zero, back)| are_opposite(&zero, &back))
        };
        let (zero, back) = pairs.find(is_surface).ok_or(OpenEquilibrium::Sliding)?;
        Ok(Resting::Sliding(SlidingSurface { sides, zero, back }))
    }

    /// What the unknowns beside the states follow from: λ of a sliding mode, the forces of contacts.
    pub fn constraints(&self, system: &System) -> Vec<ForceEquation> {
        match self {
            Resting::Mode(_) => Vec::new(),
            Resting::Sliding(surface) => vec![ForceEquation::Surface(surface.zero)],
            Resting::Contacts(contacts) => {
                let laws = system.contacts.iter().zip(&contacts.states).enumerate();
                let of = |(contact, (law, state)): (usize, (&Law<Expression>, &usize))| match (
                    law, *state,
                ) {
                    (Law::Friction { .. }, STICK) => ForceEquation::Slip(contact),
                    (Law::Stop { .. }, CLOSED) => ForceEquation::Gap(contact),
                    _ => ForceEquation::Law(contact),
                };
                laws.map(of).collect()
            }
        }
    }
}

/// What an unknown beside the states follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceEquation {
    /// The `zero` of a switch, as mode and index, is zero all along.
    Surface([usize; 2]),
    /// The slip of a contact is.
    Slip(usize),
    /// The gap of a contact is.
    Gap(usize),
    /// The law of a contact says its force.
    Law(usize),
}

impl ForceEquation {
    /// Whether it holds something at zero.
    pub fn holds(self) -> bool {
        !matches!(self, ForceEquation::Law(_))
    }
}
