//! What is positive at an equilibrium: its guards, and what makes the forces of contacts hold it.

use super::field::inner;
use super::guard::{self, ContactGuard, ProvenGuard};
use super::system::{
    EquilibriumCondition, EquilibriumSystem, NearEquilibrium, PosedEquilibrium, plain, plain_one,
};
use super::{OpenEquilibrium, place};
use crate::affine::contact::law::{
    BACKWARD, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, STICK,
};
use crate::affine::expression::Expression;
use crate::certify::analytic::Analytic;
use crate::certify::krawczyk::LinearEquations;
use crate::interval::{Gradient, Interval, Number};

impl EquilibriumSystem<'_> {
    /// Proves that every guard but the one that vanishes is positive, and what forces need for that they hold a mode; returns how many
    /// inequalities these are. Of a sliding mode ∇h·(F₊ − F₋) > 0 is one.
    pub fn inequalities(&self, x: &[Interval]) -> Result<usize, OpenEquilibrium> {
        let vanishing = match self.condition {
            EquilibriumCondition::Boundary { guard } => Some(*guard),
            _ => None,
        };
        let y: Vec<_> = x[..self.size].iter().map(|x| place::still(*x)).collect();
        let parameter = place::still(x[self.size]);
        // of one formula with another, or of the surface: it has a value at least
        let at = self.place(&y, parameter);
        let mut zeros = guard::switches(self.system, &self.resting).into_iter();
        if !zeros.all(|zero| at.zero(zero).is_some()) {
            return Err(OpenEquilibrium::NotEnclosed);
        }
        let mut proven = 0;
        for (index, guard) in self.guards.iter().enumerate() {
            if vanishing == Some(index) {
                continue;
            }
            let value = self
                .guard(guard, &y, parameter)
                .ok_or(OpenEquilibrium::NotEnclosed)?;
            if !value.value.is_positive() {
                return Err(OpenEquilibrium::Guard(
                    guard.name(self.system, &self.resting),
                ));
            }
            proven += 1;
        }
        Ok(proven + self.held_by_forces(x)?)
    }

    /// The value of a guard.
    pub fn guard<N: Analytic, const D: usize>(
        &self,
        guard: &ProvenGuard,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
    ) -> Option<Gradient<N, D>> {
        let states = self.states();
        match guard {
            ProvenGuard::FirstPush => y.get(states).copied(),
            ProvenGuard::SecondPush => Some(Gradient::double(1.0) - *y.get(states)?),
            ProvenGuard::Zero(at) => self.place(y, parameter).zero(*at),
            ProvenGuard::Contact(at) => self.contact_guard(*at, y, parameter),
        }
    }

    /// That of a contact.
    fn contact_guard<N: Analytic, const D: usize>(
        &self,
        ContactGuard {
            contact,
            place: which,
        }: ContactGuard,
        y: &[Gradient<N, D>],
        parameter: Gradient<N, D>,
    ) -> Option<Gradient<N, D>> {
        let place = self.place(y, parameter);
        let force = *y.get(self.states() + contact)?;
        let of = |expression: &Expression| place.value(expression);
        Some(match (self.law(contact)?, which) {
            (
                (Law::Friction { slip, .. }, FORWARD) | (Law::Jenkins { slip, .. }, GIVES_FORWARD),
                _,
            ) => of(slip)?,
            (
                (Law::Friction { slip, .. }, BACKWARD)
                | (Law::Jenkins { slip, .. }, GIVES_BACKWARD),
                _,
            ) => -of(slip)?,
            ((Law::Friction { bound, hold, .. }, STICK), 0) => {
                of(hold.as_ref().unwrap_or(bound))? - force
            }
            ((Law::Friction { bound, hold, .. }, STICK), _) => {
                of(hold.as_ref().unwrap_or(bound))? + force
            }
            ((Law::Jenkins { bound, .. }, HELD), 0) => of(bound)? + force,
            ((Law::Jenkins { bound, .. }, HELD), _) => of(bound)? - force,
            ((Law::Stop { gap, .. } | Law::Spring { gap, .. }, OPEN), _) => of(gap)?,
            (
                (
                    Law::Spring {
                        gap, damping: None, ..
                    },
                    _,
                ),
                _,
            ) => -of(gap)?,
            _ => force,
        })
    }

    /// Proves that the laws of contacts make sense, and that what holds is held by its force: returns of how many numbers a sign is proven.
    fn held_by_forces(&self, x: &[Interval]) -> Result<usize, OpenEquilibrium> {
        let (states, base) = (self.states(), &x[..=self.size]);
        let open = || OpenEquilibrium::NotEnclosed;
        let followed = self
            .differentiated(base, |x| self.followed_only(x))
            .ok_or_else(open)?;
        let matrix = inner(&followed.jacobian, states, self.size);
        let solver = LinearEquations::new(&matrix).ok_or_else(open)?;
        let mut proven = 0;
        for (index, _) in self
            .constraints
            .iter()
            .enumerate()
            .filter(|(_, one)| one.holds())
        {
            let mut side = vec![Interval::ZERO; matrix.len()];
            side[index] = Interval::ONE;
            let column = solver.solve(&side).ok_or_else(open)?;
            if !column[index].is_positive() {
                return Err(OpenEquilibrium::Held);
            }
            proven += 1;
        }
        for contact in 0..self.system.contacts.len() {
            proven += self.makes_sense(contact, base)?;
        }
        Ok(proven)
    }

    /// Proves that a force works against the slip or for the gap of its contact, and that bounds and constants of its law are not negative.
    fn makes_sense(&self, contact: usize, base: &[Interval]) -> Result<usize, OpenEquilibrium> {
        let open = || OpenEquilibrium::NotEnclosed;
        let force = self.states() + contact;
        let (law, _) = self.law(contact).ok_or_else(open)?;
        let name = self
            .system
            .source
            .contacts
            .names()
            .nth(contact)
            .unwrap_or_default();
        let of_gap = matches!(law, Law::Stop { .. } | Law::Spring { .. });
        let speeds = self.differentiated(base, |x| {
            let (y, parameter) = (plain(&x[..self.size]), plain_one(x[self.size]));
            let speed = self.speed(&y, parameter, contact)?.value;
            let rate = self.acceleration(&y, parameter, contact)?;
            Some(vec![speed, rate.value])
        });
        let speeds = speeds.ok_or_else(open)?.jacobian;
        let of_forces = &speeds[0][self.states()..self.size];
        if of_gap && of_forces.iter().any(|by| *by != Interval::ZERO) {
            return Err(OpenEquilibrium::Law(name.to_owned()));
        }
        let mut signs = vec![(speeds[1][force], true)];
        let values: Vec<_> = base.iter().map(|x| place::still(*x)).collect();
        let place = self.place(&values[..self.size], values[self.size]);
        let value = |text: &Expression| Ok(place.value(text).ok_or_else(open)?.value);
        let mut not_negative = Vec::new();
        match law {
            Law::Friction { bound, hold, .. } => {
                let bound = value(bound)?;
                let more = hold.as_ref().map(|hold| Ok(value(hold)? - bound));
                not_negative.push(bound);
                not_negative.extend(more.transpose()?);
            }
            Law::Jenkins {
                bound, stiffness, ..
            } => {
                not_negative.extend([value(bound)?, value(stiffness)?]);
            }
            Law::Stop { restitution, .. } => {
                let restitution = value(restitution)?;
                not_negative.extend([restitution, Interval::ONE - restitution]);
            }
            Law::Spring {
                stiffness, damping, ..
            } => {
                not_negative.push(value(stiffness)?);
                not_negative.extend(damping.as_ref().map(value).transpose()?);
            }
        }
        signs.extend(not_negative.into_iter().map(|number| (number, false)));
        let holds = |(number, strictly): &(Interval, bool)| match strictly {
            true => number.is_positive(),
            false => number.low >= 0.0,
        };
        match signs.iter().all(holds) {
            true => Ok(signs.len()),
            false => Err(OpenEquilibrium::Law(name.to_owned())),
        }
    }
}

/// The guard that is nearest to zero at an equilibrium in doubles, beside what the unknowns change in it by their units.
pub fn nearest_to_zero(posed: &PosedEquilibrium, near: &NearEquilibrium) -> Option<usize> {
    let condition = EquilibriumCondition::Value(posed.values.get(posed.parameter)?.clone());
    let (system, guess) = EquilibriumSystem::new(posed, near, &condition).ok()?;
    let points: Vec<Interval> = guess.iter().map(|x| Interval::point(*x)).collect();
    let at = system.differentiated(&points, |x| {
        let (y, parameter) = (plain(&x[..system.size]), plain_one(x[system.size]));
        let value = |guard| Some(system.guard(guard, &y, parameter)?.value);
        system.guards.iter().map(value).collect()
    })?;
    let units = system.units(&guess);
    let distance = |index: usize| {
        let by = at.jacobian[index].iter().zip(&units);
        let change: f64 = by.map(|(by, unit)| by.magnitude() * unit).sum();
        at.residual[index].magnitude() / change
    };
    (0..system.guards.len()).min_by(|one, other| distance(*one).total_cmp(&distance(*other)))
}
