//! Expressions of a system as they are read, with the names that each may have.

use std::collections::HashSet;

use super::mistake::{BadName, Mistake, SystemError};
use super::ordered::Ordered;
use super::source::{ModeSource, RESERVED, Source, is_name};
use super::{Mode, Switch};
use crate::affine::contact::law::{Law, stretch};
use crate::affine::expression::{Expression, ExpressionFlaw, Wrong};

impl Source {
    /// An expression in the parameters alone.
    pub(in crate::affine) fn of_parameters(
        &self,
        path: &str,
        text: &str,
    ) -> Result<Expression, SystemError> {
        Reader { source: self }.expression(path, text, Scope::Parameters)
    }

    /// An expression in states, parameters, abbreviations, forces of contacts and the phase.
    pub(in crate::affine) fn of_all(
        &self,
        path: &str,
        text: &str,
    ) -> Result<Expression, SystemError> {
        let all = Scope::Forces(self.define.0.len());
        Reader { source: self }.expression(path, text, all)
    }
}

/// What an expression may name, with the number of abbreviations that stand before it.
#[derive(Clone, Copy)]
pub(super) enum Scope {
    Parameters,
    All(usize),
    /// The same, and the forces of contacts.
    Forces(usize),
}

pub(super) struct Reader<'a> {
    pub source: &'a Source,
}

impl Reader<'_> {
    pub fn expression(
        &self,
        path: &str,
        text: &str,
        scope: Scope,
    ) -> Result<Expression, SystemError> {
        let flawed = |flaw| SystemError::at(path, Mistake::Expression(flaw));
        let expression = Expression::read(text).map_err(flawed)?;
        let Source {
            states,
            parameters,
            define,
            forcing,
            contacts,
            ..
        } = self.source;
        let (states, abbreviations) = match scope {
            Scope::Parameters => (&[][..], 0),
            Scope::All(abbreviations) | Scope::Forces(abbreviations) => {
                (&states[..], abbreviations)
            }
        };
        let forces = matches!(scope, Scope::Forces(_)).then_some(contacts);
        let known = || {
            let states = states.iter().map(String::as_str);
            let define = define.names().take(abbreviations);
            let forces = forces.into_iter().flat_map(Ordered::names);
            states.chain(parameters.names()).chain(define).chain(forces)
        };
        let mut unknown = None;
        expression.names(&mut |name, span| {
            let here = known().any(|known| known == name) || name == "pi" || name == "phase";
            let unforced = name == "phase" && (forcing.is_none() || states.is_empty());
            if unknown.is_none() && (!here || unforced) {
                unknown = Some((name.to_owned(), span.clone()));
            }
        });
        let Some((name, span)) = unknown else {
            return Ok(expression);
        };
        if name == "phase" && forcing.is_none() {
            return Err(SystemError::at(path, Mistake::NoForcing));
        }
        let wrong = match scope {
            Scope::Parameters => Wrong::NoParameter(name.clone()),
            Scope::All(_) | Scope::Forces(_) => Wrong::Unknown(name.clone()),
        };
        let flaw = ExpressionFlaw { span, wrong };
        Err(flawed(flaw).near(&name, known().chain(RESERVED)))
    }

    pub fn mode_index(&self, path: &str, name: &str) -> Result<usize, SystemError> {
        let modes = &self.source.modes;
        modes.index(name).ok_or_else(|| {
            let error = SystemError::at(path, Mistake::NoMode(name.to_owned()));
            error.near(name, modes.names())
        })
    }

    /// The states that a map is about, each of them once.
    pub fn state_indices(
        &self,
        path: &str,
        map: &Ordered<String>,
    ) -> Result<Vec<usize>, SystemError> {
        let states = &self.source.states;
        let mut seen = HashSet::new();
        let indices = map.names().map(|name| {
            let path = format!("{path}.{name}");
            if !seen.insert(name) {
                let mistake = Mistake::Name(name.to_owned(), BadName::Twice);
                return Err(SystemError::at(path, mistake));
            }
            let index = states.iter().position(|state| state == name);
            index.ok_or_else(|| {
                let error = SystemError::at(path, Mistake::NoState(name.to_owned()));
                error.near(name, states.iter().map(String::as_str))
            })
        });
        indices.collect()
    }

    /// What a field of a contact may name: a bound the forces of other contacts, too.
    pub fn scope_of(&self, field: &str) -> Scope {
        let define = self.source.define.0.len();
        match field {
            "bound" | "static" => Scope::Forces(define),
            _ => Scope::All(define),
        }
    }

    /// The rates of all states; of the state of a Jenkins element its law has it.
    pub fn rates(
        &self,
        path: &str,
        rates: &Ordered<String>,
    ) -> Result<Vec<Expression>, SystemError> {
        let all = Scope::Forces(self.source.define.0.len());
        self.state_indices(path, rates)?;
        let contacts = self.source.contacts.0.iter();
        let elements = contacts.filter(|(_, law)| matches!(law, Law::Jenkins { .. }));
        let stretches: Vec<String> = elements.map(|(name, _)| stretch(name)).collect();
        let read = self.source.states.iter().map(|state| {
            let Some(index) = rates.index(state) else {
                return match stretches.contains(state) {
                    true => self.expression(path, "0", all),
                    false => Err(SystemError::at(path, Mistake::NoRate(state.clone()))),
                };
            };
            let (name, text) = &rates.0[index];
            let path = format!("{path}.{name}");
            match stretches.contains(state) {
                true => Err(SystemError::at(
                    path,
                    Mistake::Name(name.clone(), BadName::Twice),
                )),
                false => self.expression(&path, text, all),
            }
        });
        read.collect()
    }

    pub fn mode(&self, path: &str, mode: &ModeSource) -> Result<Mode, SystemError> {
        let all = Scope::All(self.source.define.0.len());
        let rates = self.rates(&format!("{path}.rates"), &mode.rates)?;
        let switches = mode.until.iter().enumerate();
        let switches = switches.map(|(index, switch)| {
            let path = format!("{path}.until.{index}");
            let states = self.state_indices(&format!("{path}.reset"), &switch.reset)?;
            let reset = states.into_iter().zip(&switch.reset.0);
            let reset = reset.map(|(state, (name, text))| {
                let path = format!("{path}.reset.{name}");
                Ok((state, self.expression(&path, text, all)?))
            });
            let conditions = switch.conditions.iter().enumerate();
            let conditions = conditions
                .map(|(index, text)| self.expression(&format!("{path}.if.{index}"), text, all));
            let rest = switch.rest.as_ref();
            let rest = rest.map(|name| self.mode_index(&format!("{path}.rest"), name));
            let wrong = switch.name.as_ref().filter(|name| !is_name(name));
            if let Some(name) = wrong {
                let mistake = Mistake::Name(name.clone(), BadName::NoWord);
                return Err(SystemError::at(format!("{path}.name"), mistake));
            }
            Ok(Switch {
                zero: self.expression(&format!("{path}.zero"), &switch.zero, all)?,
                to: self.mode_index(&format!("{path}.to"), &switch.to)?,
                reset: reset.collect::<Result<_, SystemError>>()?,
                conditions: conditions.collect::<Result<_, _>>()?,
                rest: rest.transpose()?,
                name: switch.name.clone(),
            })
        });
        let switches = switches.collect::<Result<_, SystemError>>()?;
        Ok(Mode { rates, switches })
    }
}
