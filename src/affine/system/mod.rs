//! A hybrid system as its author writes it down, and its expressions once they are read.
//!
//! A mode has a rate for every state and lasts while every `zero` of its switches is positive. Where one falls
//! to zero the mode `to` begins, with some states reset. Two modes that meet in one surface may have a
//! sliding mode between them.

mod mistake;
mod ordered;
mod reader;
mod source;

pub use mistake::{BadName, Mistake, SystemError};
pub use ordered::Ordered;
pub(crate) use source::is_name;
pub use source::{ModeSource, Source, SwitchSource};

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::contact::law::{BACKWARD, FORWARD, Law, Products, STICK};
use super::expression::Expression;
use super::monitor::Monitor;
use reader::{Reader, Scope};

/// Part of a component by which the terms of degree 17 may change it over a step of an integrated flow, where none is
/// given: as much as in an exact one.
pub const DEFAULT_FLOW_TOLERANCE: f64 = 1e-15;

/// Most states.
pub const MAX_STATES: usize = 50;

/// A way for a mode to end, its expressions read.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Switch {
    pub zero: Expression,
    pub to: usize,
    pub reset: Vec<(usize, Expression)>,
    pub conditions: Vec<Expression>,
    pub rest: Option<usize>,
    pub name: Option<String>,
}

/// A mode, its expressions read: the rates in the order of the states.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mode {
    pub rates: Vec<Expression>,
    pub switches: Vec<Switch>,
}

/// A hybrid system whose names and expressions make sense.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Source", into = "Source")]
pub struct System {
    /// As it is written.
    pub source: Source,
    pub(crate) forcing: Option<Expression>,
    pub(crate) define: Vec<Expression>,
    pub(crate) modes: Vec<Mode>,
    /// Indices of the modes on the two sides of each sliding mode.
    pub(crate) sliding: Vec<[usize; 2]>,
    /// The laws of the contacts.
    pub(crate) contacts: Vec<Law<Expression>>,
    /// The modes that contacts make; none without contacts.
    pub(crate) products: Option<Products>,
    /// The guard of a mode beside those that contacts make, in which nothing moves: a section.
    pub(crate) section: Option<Expression>,
    /// Of every contact, the state that a Jenkins element adds.
    pub(crate) stretches: Vec<Option<usize>>,
    /// Whether modes that have an exact flow are integrated like the others.
    pub(crate) integrated: bool,
    /// Numbers that are asked for of its orbits.
    pub(super) monitors: Vec<Monitor>,
}

impl TryFrom<Source> for System {
    type Error = SystemError;

    fn try_from(source: Source) -> Result<System, SystemError> {
        System::new(source)
    }
}

impl From<System> for Source {
    fn from(system: System) -> Source {
        system.source
    }
}

impl System {
    /// Reads every expression and looks up every name.
    ///
    /// # Errors
    /// The first thing that is wrong, with its place.
    pub fn new(mut source: Source) -> Result<System, SystemError> {
        let stretches = source.add_stretches();
        let states = source.states.len();
        if states == 0 || states > MAX_STATES {
            return Err(SystemError::at("states", Mistake::States(states)));
        }
        source.check_modes()?;
        source.check_names()?;
        let read = Reader { source: &source };
        let forcing = source.forcing.as_ref();
        let forcing = forcing
            .map(|text| read.expression("forcing", text, Scope::Parameters))
            .transpose()?;
        let define = source
            .define
            .0
            .iter()
            .enumerate()
            .map(|(index, (name, text))| {
                read.expression(&format!("define.{name}"), text, Scope::Forces(index))
            });
        let define = define.collect::<Result<_, _>>()?;
        let modes = source.modes.0.iter();
        let modes = modes.map(|(name, mode)| read.mode(&format!("modes.{name}"), mode));
        let mut modes = modes.collect::<Result<Vec<Mode>, _>>()?;
        if modes.is_empty() {
            let rates = read.rates("rates", &source.rates)?;
            let switches = Vec::new();
            modes.push(Mode { rates, switches });
        }
        let contacts = source.contacts.0.iter().map(|(name, law)| {
            law.map(|field, text| {
                let path = format!("contacts.{name}.{field}");
                read.expression(&path, text, read.scope_of(field))
            })
        });
        let contacts: Vec<Law<Expression>> = contacts.collect::<Result<_, _>>()?;
        let products = (!contacts.is_empty()).then(|| {
            let own: Vec<String> = source.modes.names().map(str::to_owned).collect();
            let own = if own.is_empty() {
                vec![String::new()]
            } else {
                own
            };
            Products::new(own, contacts.iter().map(Law::states).collect())
        });
        let sliding = source.sliding.0.iter().map(|(name, (one, other))| {
            let mode = |side: &str| read.mode_index(&format!("sliding.{name}"), side);
            Ok([mode(one)?, mode(other)?])
        });
        let sliding = sliding.collect::<Result<_, SystemError>>()?;
        Ok(System {
            forcing,
            define,
            modes,
            sliding,
            contacts,
            products,
            section: None,
            stretches,
            integrated: false,
            monitors: Vec::new(),
            source,
        })
    }

    /// A system with contacts and one more mode, which nothing leads to, in which nothing moves, and the guard of which is
    /// this expression, and the number of that mode.
    ///
    /// # Errors
    /// What is wrong with the expression.
    pub(crate) fn with_section(&self, zero: &str) -> Result<(System, usize), SystemError> {
        let source = &self.source;
        let scope = Scope::All(source.define.0.len());
        let zero = Reader { source }.expression("section", zero, scope)?;
        let number = self.products.as_ref().map_or(0, Products::count);
        let system = System {
            section: Some(zero),
            ..self.clone()
        };
        Ok((system, number))
    }

    /// The same system with every mode integrated, also those that have an exact flow: to compare the two.
    pub fn integrated(mut self, tolerance: f64) -> System {
        self.source.flow_tolerance = Some(tolerance);
        self.integrated = true;
        self
    }

    /// Tolerance of the steps of an integrated flow.
    pub fn flow_tolerance(&self) -> f64 {
        self.source.flow_tolerance.unwrap_or(DEFAULT_FLOW_TOLERANCE)
    }

    /// Values of the parameters, in the order of the file.
    pub fn values(&self) -> Vec<f64> {
        let parameters = self.source.parameters.0.iter();
        parameters.map(|(_, value)| *value).collect()
    }

    /// Names of the modes of the file, then of the sliding ones.
    pub(crate) fn mode_names(&self) -> impl Iterator<Item = &str> {
        self.source.modes.names().chain(self.source.sliding.names())
    }

    /// The modes on the two sides of each surface in which a mode slides: those that it lies between, and those in which a contact
    /// that sticks slips either way. What holds more at rest than in slip is no sliding.
    pub(crate) fn sides(&self, mode: usize) -> Vec<[usize; 2]> {
        let Some(products) = &self.products else {
            let sliding = mode.checked_sub(self.source.modes.0.len());
            let sides = sliding.and_then(|index| self.sliding.get(index));
            return sides.into_iter().copied().collect();
        };
        let (own, digits) = products.digits(mode);
        let contacts = self.contacts.iter().zip(&digits).enumerate();
        let sticks = contacts.filter(|(_, (law, digit))| {
            matches!(law, Law::Friction { hold: None, .. }) && **digit == STICK
        });
        let slips = sticks.map(|(contact, _)| {
            [FORWARD, BACKWARD].map(|way| {
                let mut digits = digits.clone();
                digits[contact] = way;
                products.number(own, &digits)
            })
        });
        slips.collect()
    }

    /// Name of a mode: first those of the file, then the sliding ones; with contacts those that these make.
    pub fn mode_name(&self, mode: usize) -> Cow<'_, str> {
        match &self.products {
            Some(products) => products.name(mode).into(),
            None => self.mode_names().nth(mode).unwrap_or_default().into(),
        }
    }

    /// Whether a mode is the one of its name: a damped spring that has lost its force is open before its gap is.
    pub fn is_of_its_name(&self, mode: usize) -> bool {
        let products = self.products.as_ref();
        products.is_none_or(|products| products.mode(&products.name(mode)) == Some(mode))
    }

    /// Whether the contact of a name changes its state, as it is called, from one mode to another; `None` where no contact has the name
    /// or its state is the same.
    pub fn contact_changes(&self, name: &str, modes: [usize; 2]) -> Option<bool> {
        let products = self.products.as_ref()?;
        let contact = self
            .source
            .contacts
            .names()
            .position(|known| known == name)?;
        let [one, other] = modes.map(|mode| products.digits(mode).1[contact]);
        let states = self.contacts[contact].states();
        (one != other).then(|| states[one] != states[other])
    }

    /// A guard of a mode as the file has it: its expression; of the conditions of a sliding mode, the field that each is
    /// held against.
    pub fn guard_name(&self, mode: usize, guard: usize) -> String {
        let modes = &self.source.modes.0;
        if let Some(name) = self.contact_guard(mode, guard) {
            return name;
        }
        let sliding = mode.checked_sub(modes.len());
        let sides = sliding.and_then(|index| self.source.sliding.0.get(index));
        if let Some((_, (first, second))) = sides.filter(|_| guard < 2) {
            return format!("the push of `{}`", if guard == 0 { first } else { second });
        }
        // guards with the same form are one, as the modes of a sliding mode may share theirs
        let system = self.at(&self.values(), &[]).ok();
        let known = system
            .as_ref()
            .and_then(|system| system.modes.get(mode)?.guards.get(guard)?.written);
        let written = known.and_then(|[mode, switch]| modes.get(mode)?.1.until.get(switch));
        format!("`{}`", written.map_or("", |switch| switch.zero.as_str()))
    }

    /// Whether the bound of friction has anything but parameters.
    pub(super) fn has_varying_bounds(&self) -> bool {
        let parameters = &self.source.parameters;
        let mut varies = false;
        for law in &self.contacts {
            if let Law::Friction { bound, .. } = law {
                bound.names(&mut |name, _| varies |= parameters.index(name).is_none());
            }
        }
        varies
    }

    /// The name of a guard of a mode that contacts make.
    fn contact_guard(&self, mode: usize, guard: usize) -> Option<String> {
        let products = self.products.as_ref()?;
        let (own, digits) = products.digits(mode);
        let mut left = guard;
        for ((name, law), digit) in self.source.contacts.0.iter().zip(&digits) {
            let guards = law.guards(*digit);
            match guards.get(left) {
                Some(what) => return Some(format!("the {what} of `{name}`")),
                None => left -= guards.len(),
            }
        }
        let (_, mode) = self.source.modes.0.get(own)?;
        Some(format!("`{}`", mode.until.get(left)?.zero))
    }

    /// Index of a mode by its name.
    pub fn mode(&self, name: &str) -> Option<usize> {
        match &self.products {
            Some(products) => products.mode(name),
            None => self.mode_names().position(|known| known == name),
        }
    }

    /// Names of parameters that no expression has.
    pub fn unused_parameters(&self) -> Vec<&str> {
        let mut used = HashSet::new();
        let mut take = |name: &str, _: &Range<usize>| {
            used.insert(name.to_owned());
        };
        let all = self.expressions().chain(&self.define);
        all.for_each(|expression| expression.names(&mut take));
        let names = self.source.parameters.names();
        names.filter(|name| !used.contains(*name)).collect()
    }

    /// All expressions but abbreviations: rates, guards, resets, conditions, and the frequency of the forcing.
    pub(super) fn expressions(&self) -> impl Iterator<Item = &Expression> {
        let switches = self.modes.iter().flat_map(|mode| &mode.switches);
        let of_switches = switches.flat_map(|switch| {
            let reset = switch.reset.iter().map(|(_, expression)| expression);
            [&switch.zero]
                .into_iter()
                .chain(reset)
                .chain(&switch.conditions)
        });
        let rates = self.modes.iter().flat_map(|mode| &mode.rates);
        let contacts = self.contacts.iter().flat_map(Law::parts);
        let contacts = contacts.map(|(_, expression)| expression);
        rates
            .chain(of_switches)
            .chain(contacts)
            .chain(&self.forcing)
    }

    /// Names of modes to which no switch leads; none of them is a sliding mode.
    pub fn unentered_modes(&self) -> Vec<&str> {
        // contacts lead everywhere
        if self.products.is_some() {
            return Vec::new();
        }
        let switches = self.modes.iter().flat_map(|mode| &mode.switches);
        let mut entered: HashSet<usize> = switches
            .flat_map(|switch| [Some(switch.to), switch.rest])
            .flatten()
            .collect();
        entered.extend(self.sliding.iter().flatten());
        let names = self.source.modes.names().enumerate();
        let alone = names.filter(|(index, _)| !entered.contains(index));
        alone.map(|(_, name)| name).collect()
    }
}
