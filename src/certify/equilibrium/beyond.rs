//! The mode beyond a boundary equilibrium.
//!
//! That the equilibrium of one mode rests in another, too, no interval can tell: formulas do. In a sliding mode with λ = 0 or 1 the field is
//! that of one of its sides. Two modes of the file whose rates are the same wherever a guard is zero rest there together; for that a state
//! is expressed by the others, where the guard is ± this state and what has nothing to do with it. Where one contact alone is in another
//! state, and both guards are those that lead from the one to the other, the laws have one force there. Both branches have the parameter as
//! their coordinate, and the guards pass zero with slopes: where these have one sign, both branches lie on one side.

use serde::{Deserialize, Serialize};

use super::guard::{ContactGuard, ProvenGuard, are_one};
use super::resting::{Resting, RestingContacts, are_opposite, formulas};
use super::system::{EquilibriumCondition, EquilibriumSystem, NearEquilibrium, PosedEquilibrium};
use super::{OpenEquilibrium, place};
use crate::affine::algebra::{Algebra, Operation};
use crate::affine::contact::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, STICK,
};
use crate::affine::system::System;
use crate::certify::krawczyk::LinearEquations;
use crate::certify::orbit::exact::NamePolynomial;
use crate::interval::Interval;

/// The mode beyond a boundary equilibrium, as it is proven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeBeyond {
    /// Its name.
    pub mode: String,
    /// The guard of it that vanishes there.
    pub guard: usize,
    /// Whether the equilibria of the two modes lie on different sides of the parameter; else both lie on one, a nonsmooth fold.
    pub persists: bool,
}

/// A state and the formula that it is equal to wherever another one is zero: of a formula that is ± a state and what
/// has nothing to do with it.
fn expressed(system: &System, zero: [usize; 2]) -> Option<(usize, NamePolynomial)> {
    let place = formulas(system, None);
    let whole = place.zero(zero)?;
    let of_state = |state: usize| {
        let rest = formulas(system, Some((state, NamePolynomial::default()))).zero(zero)?;
        let name = NamePolynomial::named(system.source.states.get(state)?.clone());
        let alone = whole.clone().operate(Operation::Minus, rest.clone()).ok()?;
        let formula = if are_opposite(&alone, &name) {
            rest
        } else if are_opposite(&alone, &name.negative()) {
            rest.negative()
        } else {
            return None;
        };
        Some((state, formula))
    };
    (0..system.source.states.len()).find_map(of_state)
}

/// Whether two modes of the file rest together where the `zero` of a switch of the one is zero, and that of one of the other is, too.
fn rest_alike(system: &System, zero: [usize; 2], back: [usize; 2]) -> Option<bool> {
    let place = formulas(system, Some(expressed(system, zero)?));
    let (one, other) = (place.rates(zero[0])?, place.rates(back[0])?);
    let mut both = one.iter().zip(other);
    let alike = both.all(|(one, other)| are_opposite(one, &other.negative()));
    Some(alike && place.zero(back)?.is_zero())
}

/// Whether a switch with the `zero` of another leads to a mode and leaves all states as they are, whatever they are.
fn leads(system: &System, [mode, switch]: [usize; 2], to: usize) -> bool {
    let switches = system.modes[mode].switches.iter().enumerate();
    let mut leading = switches.filter(|(_, one)| one.to == to);
    leading.any(|(index, one)| {
        one.reset.is_empty()
            && one.conditions.is_empty()
            && are_one(system, [mode, index], [mode, switch])
    })
}

/// Whether the equilibrium of one mode at which a guard is zero is one of another at which a guard of that is zero, by formulas.
fn is_one_of(
    system: &System,
    (own, guard): (&Resting, ProvenGuard),
    (beyond, other): (&Resting, ProvenGuard),
) -> bool {
    let holds =
        |sliding: &Resting, push: ProvenGuard, mode: usize, zero: [usize; 2]| match (sliding, push)
        {
            (Resting::Sliding(surface), ProvenGuard::FirstPush) => {
                surface.sides[0] == mode && are_one(system, zero, surface.zero)
            }
            (Resting::Sliding(surface), ProvenGuard::SecondPush) => {
                surface.sides[1] == mode && are_one(system, zero, surface.back)
            }
            _ => false,
        };
    match ((own, guard), (beyond, other)) {
        ((Resting::Mode(mode), ProvenGuard::Zero(zero)), (sliding @ Resting::Sliding(_), push))
        | ((sliding @ Resting::Sliding(_), push), (Resting::Mode(mode), ProvenGuard::Zero(zero))) => {
            holds(sliding, push, *mode, zero)
        }
        (
            (Resting::Mode(_), ProvenGuard::Zero(zero)),
            (Resting::Mode(to), ProvenGuard::Zero(back)),
        ) => leads(system, zero, *to) && rest_alike(system, zero, back) == Some(true),
        (
            (Resting::Contacts(one), ProvenGuard::Zero(zero)),
            (Resting::Contacts(other), ProvenGuard::Zero(back)),
        ) => {
            one.states == other.states
                && leads(system, zero, other.own)
                && rest_alike(system, zero, back) == Some(true)
        }
        (
            (Resting::Contacts(one), ProvenGuard::Contact(guard)),
            (Resting::Contacts(other), ProvenGuard::Contact(back)),
        ) => rest_by_a_contact(system, (one, guard), (other, back)),
        _ => false,
    }
}

/// Whether a guard of a contact in a state is where another state of it has the same force, with a guard of its own zero.
fn leads_to<T>(law: &Law<T>, [state, guard]: [usize; 2], to: usize) -> bool {
    match (law, state, guard) {
        (Law::Stop { .. } | Law::Spring { .. }, OPEN, _) => to == CLOSED,
        (Law::Stop { .. } | Law::Spring { .. }, CLOSED, _) => to == OPEN,
        // what friction holds beyond its bound it lets go with another force
        (Law::Friction { hold: Some(_), .. }, ..) => false,
        (Law::Friction { .. }, STICK, 0) => to == BACKWARD,
        (Law::Friction { .. }, STICK, _) => to == FORWARD,
        (Law::Jenkins { .. }, HELD, 0) => to == GIVES_FORWARD,
        (Law::Jenkins { .. }, HELD, _) => to == GIVES_BACKWARD,
        _ => false,
    }
}

/// Whether two modes that contacts make rest together where a guard of the one is zero, and one of the other is, too: by one contact alone.
fn rest_by_a_contact(
    system: &System,
    (one, guard): (&RestingContacts, ContactGuard),
    (other, back): (&RestingContacts, ContactGuard),
) -> bool {
    let contact = guard.contact;
    let places = one.states.iter().zip(&other.states).enumerate();
    let alone = |(index, (a, b)): (usize, (&usize, &usize))| (index == contact) == (a != b);
    let (state, to) = (one.states[contact], other.states[contact]);
    let law = &system.contacts[contact];
    one.own == other.own
        && back.contact == contact
        && places.into_iter().all(alone)
        && (leads_to(law, [state, guard.place], to) || leads_to(law, [to, back.place], state))
}

impl EquilibriumSystem<'_> {
    /// ∂/∂p of a guard along the equilibria of the mode, which have the parameter as their coordinate.
    fn guard_slope(&self, guard: &ProvenGuard, x: &[Interval]) -> Option<Interval> {
        let mut matrix = self.slopes(x)?;
        let last = |row: &mut Vec<Interval>| row.pop().map(|by| -by);
        let side: Vec<Interval> = matrix.iter_mut().map(last).collect::<Option<_>>()?;
        let along = LinearEquations::new(&matrix)?.solve(&side)?;
        let y = x[..self.size].iter().zip(along);
        let y: Vec<_> = y.map(|(x, by)| place::moving(*x, by)).collect();
        let parameter = place::moving(x[self.size], Interval::ONE);
        Some(self.guard(guard, &y, parameter)?.by[0])
    }
}

/// Whether the equilibria of a mode beyond lie on the other side of the parameter than those of this mode, whose boundary equilibrium is
/// enclosed.
///
/// # Errors
/// It is not proven, or not covered.
pub fn persists(
    own: &EquilibriumSystem,
    x: &[Interval],
    (mode, guard): (&str, usize),
) -> Result<bool, OpenEquilibrium> {
    let EquilibriumCondition::Boundary { guard: vanishing } = own.condition else {
        return Err(OpenEquilibrium::System);
    };
    let near = NearEquilibrium {
        mode: mode.to_owned(),
        ..own.near.clone()
    };
    let condition = EquilibriumCondition::Boundary { guard };
    let (other, _) = EquilibriumSystem::new(own.posed, &near, &condition)?;
    let (own_guard, other_guard) = (own.guards[*vanishing], other.guards[guard]);
    let of_own = (&own.resting, own_guard);
    if !is_one_of(own.system, of_own, (&other.resting, other_guard)) {
        return Err(OpenEquilibrium::Beyond);
    }
    let forces = match (&other.resting, other_guard) {
        (Resting::Contacts(_), _) => x[own.states()..own.size].to_vec(),
        (_, ProvenGuard::FirstPush) => vec![Interval::ZERO],
        (_, ProvenGuard::SecondPush) => vec![Interval::ONE],
        _ => Vec::new(),
    };
    let states = x[..own.states()].iter().copied();
    let there = states.chain(forces).chain([x[own.parameter()]]);
    let there: Vec<Interval> = there.collect();
    other.inequalities(&there)?;
    let slopes = own
        .guard_slope(&own_guard, x)
        .zip(other.guard_slope(&other_guard, &there));
    let (one, two) = slopes.ok_or(OpenEquilibrium::NotEnclosed)?;
    let product = one * two;
    match (product.is_negative(), product.is_positive()) {
        (true, _) => Ok(true),
        (_, true) => Ok(false),
        _ => Err(OpenEquilibrium::Beyond),
    }
}

/// The mode of a name beyond a boundary equilibrium, by whatever guard of it is zero there; `None` where that is not proven.
pub fn found(
    posed: &PosedEquilibrium,
    near: &NearEquilibrium,
    condition: &EquilibriumCondition,
    mode: &str,
) -> Option<ModeBeyond> {
    let (system, _, zero) = super::enclosed(posed, near, condition).ok()?;
    let resting = Resting::new(system.system, mode).ok()?;
    let guards = super::guard::guards(system.system, &resting).len();
    (0..guards).find_map(|guard| {
        let persists = persists(&system, &zero.at, (mode, guard)).ok()?;
        Some(ModeBeyond {
            mode: mode.to_owned(),
            guard,
            persists,
        })
    })
}
