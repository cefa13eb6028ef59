//! The expressions of a system as forms, with coefficients of any kind.

use std::collections::HashMap;

use super::algebra::Obstacle;
use super::contact::law::Law;
use super::contact::mistake::ContactMistake;
use super::dual::{Coefficient, Dual, Measured};
use super::expression::{Expression, ExpressionFlaw};
use super::form::{Form, Signs};
use super::system::{Mistake, Switch, System, SystemError};

/// A switch with its expressions as forms.
#[derive(Clone, Debug, PartialEq)]
pub struct FormSwitch<C = Dual> {
    pub guard: Form<C>,
    pub to: usize,
    pub rest: Option<usize>,
    pub reset: Vec<(usize, Form<C>)>,
    pub conditions: Vec<Form<C>>,
    /// The guard of `to` that is zero there, with so many orders.
    pub tangent: Option<(usize, usize)>,
    /// Number of its guard where several switches have one: of those of contacts. Others with equal forms have one guard.
    pub group: Option<usize>,
    /// Its name.
    pub name: Option<String>,
    /// Why no motion takes it.
    pub refusal: Option<ContactMistake>,
    /// Whether its guard keeps its value within the mode: one that is zero ends nothing.
    pub keeps: bool,
}

/// A mode with its expressions as forms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FormMode<C = Dual> {
    /// Rates in the order of the states.
    pub rates: Vec<Form<C>>,
    /// Switches in the order of the file.
    pub switches: Vec<FormSwitch<C>>,
    /// What contacts hold at zero all along.
    pub held: Vec<Form<C>>,
    /// Bounds of friction that slips, where they are no constants, each with the number of the guard that is its slip: a negative
    /// one makes no sense.
    pub bounds: Vec<(usize, Form<C>)>,
}

impl<C> FormSwitch<C> {
    /// All forms of it.
    pub fn forms(&self) -> impl Iterator<Item = &Form<C>> {
        let reset = self.reset.iter().map(|(_, form)| form);
        std::iter::once(&self.guard)
            .chain(reset)
            .chain(&self.conditions)
    }
}

impl<C> FormMode<C> {
    /// All forms of it.
    pub fn forms(&self) -> impl Iterator<Item = &Form<C>> {
        let switches = self.switches.iter().flat_map(FormSwitch::forms);
        let bounds = self.bounds.iter().map(|(_, form)| form);
        let own = self.rates.iter().chain(&self.held);
        own.chain(switches).chain(bounds)
    }
}

impl<C> FormSwitch<C> {
    /// The same with every coefficient through a function; `None` where a form has terms that are not affine.
    ///
    /// # Errors
    /// The first that the function has.
    fn convert<D, E>(
        &self,
        change: &impl Fn(&C) -> Result<D, E>,
    ) -> Result<Option<FormSwitch<D>>, E> {
        let Some(guard) = self.guard.convert(change)? else {
            return Ok(None);
        };
        let reset = self.reset.iter().map(|(state, form)| {
            let form = form.convert(change)?;
            Ok(form.map(|form| (*state, form)))
        });
        let reset = reset.collect::<Result<Option<Vec<_>>, E>>()?;
        let conditions = converted(&self.conditions, change)?;
        Ok(reset.zip(conditions).map(|(reset, conditions)| FormSwitch {
            guard,
            to: self.to,
            rest: self.rest,
            reset,
            conditions,
            tangent: self.tangent,
            group: self.group,
            name: self.name.clone(),
            refusal: self.refusal.clone(),
            keeps: self.keeps,
        }))
    }
}

impl<C> FormMode<C> {
    /// The same with every coefficient through a function; `None` where a form has terms that are not affine.
    ///
    /// # Errors
    /// The first that the function has.
    pub(crate) fn convert<D, E>(
        &self,
        change: &impl Fn(&C) -> Result<D, E>,
    ) -> Result<Option<FormMode<D>>, E> {
        let switches = self.switches.iter().map(|switch| switch.convert(change));
        let switches = switches.collect::<Result<Option<Vec<_>>, E>>()?;
        let rates = converted(&self.rates, change)?;
        let held = converted(&self.held, change)?;
        let bounds = self.bounds.iter().map(|(guard, form)| {
            let form = form.convert(change)?;
            Ok(form.map(|form| (*guard, form)))
        });
        let bounds = bounds.collect::<Result<Option<Vec<_>>, E>>()?;
        let parts = rates.zip(switches).zip(held.zip(bounds));
        Ok(parts.map(|((rates, switches), (held, bounds))| FormMode {
            rates,
            switches,
            held,
            bounds,
        }))
    }
}

impl<C: PartialEq> FormMode<C> {
    /// Of every switch, the number of its guard: those of one form have one, but for contacts, which say it.
    pub(crate) fn guards(&self) -> Vec<usize> {
        let mut known: Vec<&Form<C>> = Vec::new();
        let mut guards = Vec::new();
        for switch in &self.switches {
            let place = match switch.group {
                Some(group) => (group < known.len()).then_some(group),
                None => known.iter().position(|form| **form == switch.guard),
            };
            guards.push(place.unwrap_or(known.len()));
            if place.is_none() {
                known.push(&switch.guard);
            }
        }
        guards
    }
}

/// Forms with every coefficient through a function.
fn converted<C, D, E>(
    forms: &[Form<C>],
    change: &impl Fn(&C) -> Result<D, E>,
) -> Result<Option<Vec<Form<D>>>, E> {
    forms.iter().map(|form| form.convert(change)).collect()
}

impl<C: Measured> FormMode<C> {
    /// The mode with every expression as it is within it, where its guards are not negative: the absolute value of a
    /// multiple of one has no kink there, and one of a form that is held at zero is nothing. Guards themselves know of what
    /// is held, and of guards other than themselves.
    ///
    /// # Errors
    /// An operation that has no result there.
    pub fn within(mut self) -> Result<Self, Obstacle> {
        let held = Signs {
            positive: Vec::new(),
            zero: self.held.clone(),
        };
        // a mode of contacts may have thousands of switches of few guards
        let places = self.guards();
        let mut guards = self.guards_once(&places);
        let mut known = HashMap::new();
        for guard in &mut guards {
            *guard = guard.where_signed(&held, &mut known)?;
        }
        let signs = Signs {
            positive: guards.clone(),
            zero: self.held.clone(),
        };
        for guard in &mut guards {
            if guard.beyond.is_empty() {
                continue;
            }
            let others = signs.positive.iter().filter(|one| *one != guard);
            let others = Signs {
                positive: others.cloned().collect(),
                zero: Vec::new(),
            };
            *guard = guard.where_signed(&others, &mut HashMap::new())?;
        }
        for (switch, place) in self.switches.iter_mut().zip(places) {
            switch.guard = guards[place].clone();
        }
        let mut known = HashMap::new();
        let mut resolve = |form: &mut Form<C>| {
            if !form.beyond.is_empty() {
                *form = form.where_signed(&signs, &mut known)?;
            }
            Ok(())
        };
        self.rates.iter_mut().try_for_each(&mut resolve)?;
        let bounds = self.bounds.iter_mut().map(|(_, form)| form);
        bounds.into_iter().try_for_each(&mut resolve)?;
        for switch in &mut self.switches {
            let reset = switch.reset.iter_mut().map(|(_, form)| form);
            reset
                .chain(&mut switch.conditions)
                .try_for_each(&mut resolve)?;
        }
        Ok(self)
    }

    /// An expression that is none of the mode's own as it is within it.
    ///
    /// # Errors
    /// An operation that has no result there.
    pub fn of_mode(&self, form: &Form<C>) -> Result<Form<C>, Obstacle> {
        if form.beyond.is_empty() {
            return Ok(form.clone());
        }
        form.where_signed(&self.signs(), &mut HashMap::new())
    }

    /// Its guards, each once, by the numbers that switches have of them.
    fn guards_once(&self, numbers: &[usize]) -> Vec<Form<C>> {
        let mut guards: Vec<Form<C>> = Vec::new();
        for (switch, number) in self.switches.iter().zip(numbers) {
            if *number == guards.len() {
                guards.push(switch.guard.clone());
            }
        }
        guards
    }

    /// Its guards, which are not negative within it, and what it holds at zero.
    fn signs(&self) -> Signs<C> {
        Signs {
            positive: self.guards_once(&self.guards()),
            zero: self.held.clone(),
        }
    }
}

/// Where an expression stands: told only if it is wrong.
type Path<'a> = &'a dyn Fn() -> String;

/// What the names of a system stand for.
pub struct Evaluation<'a, 'p, C> {
    system: &'a System,
    parameter: &'p dyn Fn(usize) -> C,
    pi: C,
    abbreviations: Vec<Form<C>>,
}

impl<'a, 'p, C: Coefficient> Evaluation<'a, 'p, C> {
    /// Where parameters, by their index, and π are these coefficients.
    ///
    /// # Errors
    /// An abbreviation that has no finite value, with its place.
    pub fn new(
        system: &'a System,
        parameter: &'p dyn Fn(usize) -> C,
        pi: C,
    ) -> Result<Evaluation<'a, 'p, C>, SystemError> {
        let mut evaluation = Evaluation {
            system,
            parameter,
            pi,
            abbreviations: Vec::new(),
        };
        let names = system.source.define.names();
        for (name, expression) in names.zip(&system.define) {
            // an abbreviation may stand for the phase: only its use tells whether that makes sense
            let form = evaluation.evaluate(&|| format!("define.{name}"), expression)?;
            evaluation.abbreviations.push(form);
        }
        Ok(evaluation)
    }

    /// The angular frequency of the forcing; zero without.
    ///
    /// # Errors
    /// It has no finite value.
    pub fn frequency(&self) -> Result<C, SystemError> {
        let forcing = self.system.forcing.as_ref();
        let form = forcing.map(|expression| self.form(&|| "forcing".into(), expression));
        Ok(form
            .transpose()?
            .map_or_else(C::default, |form| form.constant))
    }

    /// The modes of the file.
    ///
    /// # Errors
    /// An expression that has no finite value, or no form, with its place.
    pub fn modes(&self) -> Result<Vec<FormMode<C>>, SystemError> {
        // rates that stand in no mode have no name before them
        let names = self.system.source.modes.names();
        let homes = names.map(|name| format!("modes.{name}."));
        let homes = homes.chain(std::iter::repeat(String::new()));
        let modes = homes.zip(&self.system.modes).map(|(home, mode)| {
            let path = |rest: String| format!("{home}{rest}");
            let rates = self.system.source.states.iter().zip(&mode.rates);
            let rates =
                rates.map(|(state, rate)| self.form(&|| path(format!("rates.{state}")), rate));
            let switches = mode.switches.iter().enumerate();
            let switches = switches
                .map(|(index, switch)| self.switch(&|| path(format!("until.{index}")), switch));
            Ok(FormMode {
                rates: rates.collect::<Result<_, _>>()?,
                switches: switches.collect::<Result<_, _>>()?,
                held: Vec::new(),
                bounds: Vec::new(),
            })
        });
        modes.collect()
    }

    /// The mode beside those that contacts make, if there is one.
    ///
    /// # Errors
    /// See [`Evaluation::modes`].
    pub fn section(&self) -> Result<Option<FormMode<C>>, SystemError> {
        let guard = self.system.section.as_ref();
        let guard = guard.map(|zero| self.form(&|| "section".into(), zero));
        Ok(guard.transpose()?.map(|guard| FormMode {
            rates: vec![Form::default(); self.system.source.states.len()],
            switches: vec![FormSwitch {
                guard,
                to: 0,
                rest: None,
                reset: Vec::new(),
                conditions: Vec::new(),
                tangent: None,
                group: None,
                name: None,
                refusal: None,
                keeps: false,
            }],
            held: Vec::new(),
            bounds: Vec::new(),
        }))
    }

    /// The laws of the contacts; forces stand in them as states from the number of states on.
    ///
    /// # Errors
    /// See [`Evaluation::modes`].
    pub fn laws(&self) -> Result<Vec<Law<Form<C>>>, SystemError> {
        let names = self.system.source.contacts.names();
        let laws = names.zip(&self.system.contacts).map(|(name, law)| {
            law.map(|field, expression| {
                self.form(&|| format!("contacts.{name}.{field}"), expression)
            })
        });
        laws.collect()
    }

    fn meaning(&self, name: &str) -> Option<Form<C>> {
        let source = &self.system.source;
        if let Some(state) = source.states.iter().position(|state| state == name) {
            return Some(Form::state(state));
        }
        if let Some(index) = source.parameters.index(name) {
            return Some(Form::constant((self.parameter)(index)));
        }
        if let Some(index) = source.define.index(name) {
            return self.abbreviations.get(index).cloned();
        }
        if let Some(index) = source.contacts.index(name) {
            return Some(Form::state(source.states.len() + index));
        }
        match name {
            "pi" => Some(Form::constant(self.pi.clone())),
            "phase" => Some(Form::phase()),
            _ => None,
        }
    }

    fn evaluate(&self, path: Path, expression: &Expression) -> Result<Form<C>, SystemError> {
        let form = expression.evaluate(&|name| self.meaning(name));
        form.map_err(|flaw| SystemError::at(path(), Mistake::Expression(flaw)))
    }

    /// An expression as a form.
    ///
    /// # Errors
    /// It has no finite value, or no form, with its place.
    pub fn form(&self, path: Path, expression: &Expression) -> Result<Form<C>, SystemError> {
        let form = self.evaluate(path, expression)?;
        form.settled().map_err(|obstacle| {
            let flaw = ExpressionFlaw {
                wrong: obstacle.into(),
                span: expression.span.clone(),
            };
            SystemError::at(path(), Mistake::Expression(flaw))
        })
    }

    fn switch(&self, path: Path, switch: &Switch) -> Result<FormSwitch<C>, SystemError> {
        let names = &self.system.source.states;
        let reset = switch.reset.iter().map(|(state, expression)| {
            let path = || format!("{}.reset.{}", path(), names[*state]);
            Ok((*state, self.form(&path, expression)?))
        });
        let conditions = switch.conditions.iter().enumerate();
        let conditions = conditions
            .map(|(index, expression)| self.form(&|| format!("{}.if.{index}", path()), expression));
        Ok(FormSwitch {
            to: switch.to,
            rest: switch.rest,
            tangent: None,
            group: None,
            name: switch.name.clone(),
            refusal: None,
            keeps: false,
            guard: self.form(&|| format!("{}.zero", path()), &switch.zero)?,
            reset: reset.collect::<Result<_, SystemError>>()?,
            conditions: conditions.collect::<Result<_, _>>()?,
        })
    }
}
