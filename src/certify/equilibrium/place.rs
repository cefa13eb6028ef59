//! The expressions of a system at a place: where its states and parameters are numbers of any kind.

use crate::affine::expression::{Algebra, Expression, Function, Obstacle, Operation};
use crate::affine::system::System;
use crate::interval::{Gradient, Interval, Number};

/// What the names of a system stand for.
pub struct NameValues<'a, A> {
    system: &'a System,
    states: Vec<A>,
    parameters: Vec<A>,
    pi: A,
    /// Abbreviations; `None` of those that have no value here.
    abbreviations: Vec<Option<A>>,
}

impl<'a, A: Algebra> NameValues<'a, A> {
    /// Where states, parameters and π are these.
    pub fn new(system: &'a System, states: Vec<A>, parameters: Vec<A>, pi: A) -> NameValues<'a, A> {
        let mut place = NameValues {
            system,
            states,
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

/// Whether the rates of a mode are affine in the states, whatever the parameters, as they are written.
pub fn is_affine(system: &System, mode: usize) -> bool {
    let states = vec![Dependence::Affine; system.source.states.len()];
    let parameters = vec![Dependence::Fixed; system.source.parameters.0.len()];
    let place = NameValues::new(system, states, parameters, Dependence::Fixed);
    let rates = place
        .rates(mode)
        .unwrap_or_else(|| vec![Dependence::Beyond]);
    rates.iter().all(|rate| *rate != Dependence::Beyond)
}

/// A number that does not vary.
pub fn still(value: Interval) -> Gradient<Interval, 1> {
    Gradient::constant(value)
}

/// A number with its derivative in one quantity.
pub fn moving(value: Interval, by: Interval) -> Gradient<Interval, 1> {
    Gradient { value, by: [by] }
}
