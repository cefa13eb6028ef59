//! The expressions of a system at a place: where its states and parameters are numbers of any kind.

use crate::affine::algebra::Algebra;
use crate::affine::expression::Expression;
use crate::affine::system::System;
use crate::interval::{Gradient, Interval, Number};

/// What the names of a system stand for.
pub struct NameValues<'a, A> {
    system: &'a System,
    states: Vec<A>,
    /// Forces of contacts; none where nothing has any.
    forces: Vec<A>,
    parameters: Vec<A>,
    pi: A,
    /// Abbreviations; `None` of those that have no value here.
    abbreviations: Vec<Option<A>>,
}

impl<'a, A: Algebra> NameValues<'a, A> {
    /// Where states, forces, parameters and π are these.
    pub fn new(
        system: &'a System,
        [states, forces, parameters]: [Vec<A>; 3],
        pi: A,
    ) -> NameValues<'a, A> {
        let mut place = NameValues {
            system,
            states,
            forces,
            parameters,
            pi,
            abbreviations: Vec::new(),
        };
        for expression in &system.define {
            let value = place.value(expression);
            place.abbreviations.push(value);
        }
        place
    }

    fn meaning(&self, name: &str) -> Option<A> {
        let source = &self.system.source;
        if let Some(state) = source.states.iter().position(|state| state == name) {
            return self.states.get(state).cloned();
        }
        if let Some(contact) = source.contacts.index(name) {
            return self.forces.get(contact).cloned();
        }
        if let Some(index) = source.parameters.index(name) {
            return self.parameters.get(index).cloned();
        }
        if let Some(index) = source.define.index(name) {
            return self.abbreviations.get(index).cloned().flatten();
        }
        (name == "pi").then(|| self.pi.clone())
    }

    /// The value of an expression; `None` where it has none, or none that is known.
    pub fn value(&self, expression: &Expression) -> Option<A> {
        expression.evaluate(&|name| self.meaning(name)).ok()
    }

    /// The rates of a mode of the file.
    pub fn rates(&self, mode: usize) -> Option<Vec<A>> {
        let rates = self.system.modes.get(mode)?.rates.iter();
        rates.map(|rate| self.value(rate)).collect()
    }

    /// The `zero` of a switch of a mode.
    pub fn zero(&self, [mode, switch]: [usize; 2]) -> Option<A> {
        let switches = &self.system.modes.get(mode)?.switches;
        self.value(&switches.get(switch)?.zero)
    }
}

/// A number that does not vary.
pub fn still(value: Interval) -> Gradient<Interval, 1> {
    Gradient::constant(value)
}

/// A number with its derivative in one quantity.
pub fn moving(value: Interval, by: Interval) -> Gradient<Interval, 1> {
    Gradient { value, by: [by] }
}
