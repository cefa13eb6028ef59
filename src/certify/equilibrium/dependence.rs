//! How the motion of a mode depends on the states, as it is written.

use super::place::NameValues;
use super::resting::Resting;
use crate::affine::algebra::{Algebra, Function, Obstacle, Operation};
use crate::affine::contact::law::Law;
use crate::affine::expression::Expression;
use crate::affine::system::System;

/// How an expression depends on the states, as it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Dependence {
    Fixed,
    Affine,
    Beyond,
}

impl Algebra for Dependence {
    fn number(_: f64) -> Dependence {
        Dependence::Fixed
    }

    fn negative(self) -> Dependence {
        self
    }

    fn operate(self, operation: Operation, other: Dependence) -> Result<Dependence, Obstacle> {
        use Dependence::{Beyond, Fixed};
        Ok(match (operation, self, other) {
            (Operation::Plus | Operation::Minus, one, other) => one.max(other),
            (Operation::Times, Fixed, one) | (Operation::Times | Operation::Over, one, Fixed) => {
                one
            }
            (Operation::Power, Fixed, Fixed) => Fixed,
            _ => Beyond,
        })
    }

    fn apply(self, _: Function) -> Result<Dependence, Obstacle> {
        Ok(match self {
            Dependence::Fixed => self,
            _ => Dependence::Beyond,
        })
    }
}

/// Whether all that moves the states in a mode is affine in them and in the forces of contacts, whatever the parameters, as it is
/// written.
pub fn is_affine(system: &System, resting: &Resting) -> bool {
    let named = |count: usize, dependence| vec![dependence; count];
    let names = [
        named(system.source.states.len(), Dependence::Affine),
        named(system.contacts.len(), Dependence::Affine),
        named(system.source.parameters.0.len(), Dependence::Fixed),
    ];
    let place = NameValues::new(system, names, Dependence::Fixed);
    let mode = match resting {
        Resting::Mode(mode) => *mode,
        Resting::Sliding(_) => return false,
        Resting::Contacts(contacts) => contacts.own,
    };
    let most = |expression: &Expression, most: Dependence| {
        place.value(expression).is_some_and(|value| value <= most)
    };
    let rates = place
        .rates(mode)
        .unwrap_or_else(|| vec![Dependence::Beyond]);
    let law = |law: &Law<Expression>| {
        let mut parts = law.parts().into_iter();
        parts.all(|(field, part)| match field {
            "stiffness" | "damping" => most(part, Dependence::Fixed),
            _ => most(part, Dependence::Affine),
        })
    };
    rates.iter().all(|rate| *rate != Dependence::Beyond) && system.contacts.iter().all(law)
}
