//! A hybrid system as its author writes it down, and its expressions once they are read.
//!
//! A mode has a rate for every state and lasts while every `zero` of its switches is positive. Where one falls
//! to zero the mode `to` begins, with some states reset. Two modes that meet in one surface may have a
//! sliding mode between them.

use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;

use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::contact::law::{Law, Products, stretch};
use super::contact::mistake::{ContactMistake, MAX_CONTACTS};
use super::expression::{Expression, Flaw, Obstacle, Wrong};
use super::monitor::Monitor;
use super::values;

/// Part of a component by which the terms of degree 17 may change it over a step of an integrated flow, where none is
/// given: as much as in an exact one.
pub const DEFAULT_FLOW_TOLERANCE: f64 = 1e-15;

/// Most states.
pub const MAX_STATES: usize = 50;

/// A map that keeps the order in which it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordered<T>(pub Vec<(String, T)>);

impl<T> Default for Ordered<T> {
    fn default() -> Self {
        Ordered(Vec::new())
    }
}

impl<T: Into<U>, U, const N: usize> From<[(&str, T); N]> for Ordered<U> {
    fn from(entries: [(&str, T); N]) -> Ordered<U> {
        Ordered(
            entries
                .map(|(name, value)| (name.to_owned(), value.into()))
                .into(),
        )
    }
}

impl<T> Ordered<T> {
    /// The index of a name.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|(known, _)| known == name)
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(name, _)| name.as_str())
    }
}

impl<T: Serialize> Serialize for Ordered<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Ordered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Ordered<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map `{\"name\": value, ..}`")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Ordered<T>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Ordered(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

/// The section `system` of a problem file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Names of the states.
    pub states: Vec<String>,
    /// Parameters and their values, which may be written as expressions in those before them.
    #[serde(default, deserialize_with = "parameters")]
    pub parameters: Ordered<f64>,
    /// Angular frequency of the forcing, an expression in the parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forcing: Option<String>,
    /// Abbreviations, each in terms of what stands before it.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    pub define: Ordered<String>,
    /// Contacts by name, which is that of their force.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    pub contacts: Ordered<Law>,
    /// Rates of a system with contacts that has no modes of its own.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    pub rates: Ordered<String>,
    /// Modes by name.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    pub modes: Ordered<ModeSource>,
    /// Sliding modes by name, each with the two modes that meet in its surface.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    pub sliding: Ordered<(String, String)>,
    /// Tolerance of the steps in which modes without an exact flow are integrated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_tolerance: Option<f64>,
}

fn parameters<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Ordered<f64>, D::Error> {
    values::read(deserializer).map(Ordered)
}

impl Source {
    /// Whether both are one system, but for the values of its parameters and the accuracy of its flow.
    pub fn is_same(&self, other: &Source) -> bool {
        let bare = |source: &Source| Source {
            parameters: Ordered::default(),
            flow_tolerance: None,
            ..source.clone()
        };
        self.parameters.names().eq(other.parameters.names()) && bare(self) == bare(other)
    }
}

/// A mode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeSource {
    /// Rate of every state.
    pub rates: Ordered<String>,
    /// What ends it.
    #[serde(default)]
    pub until: Vec<SwitchSource>,
}

/// A way for a mode to end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SwitchSource {
    /// What is positive during the mode and falls to zero at its end.
    pub zero: String,
    /// The mode that begins.
    pub to: String,
    /// States that jump, and their new values as expressions in the old ones.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    pub reset: Ordered<String>,
    /// Expressions that are not negative where this way is taken.
    #[serde(default, rename = "if", skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<String>,
    /// The mode that begins where infinitely many of these switches end in finite time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<String>,
    /// A name by which monitors call it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

/// What is wrong with a system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Mistake {
    /// An expression.
    #[error("{}", .0.wrong)]
    Expression(Flaw),
    /// No states, or too many.
    #[error("{0} states; from 1 to {MAX_STATES} are possible")]
    States(usize),
    /// No mode.
    #[error("no modes: nothing moves")]
    NoModes,
    /// Rates beside modes, or without contacts.
    #[error("`rates` stands here where there are contacts and no `modes`")]
    Rates,
    /// Sliding modes beside contacts.
    #[error("`sliding` has no meaning beside contacts: a contact that sticks is one")]
    SlidingContacts,
    /// A contact.
    #[error("{0}")]
    Contact(ContactMistake),
    /// A name that is no name, has a meaning already, or stands for two things.
    #[error("`{0}` cannot be a name here: {1}")]
    Name(String, BadName),
    /// A state without rate.
    #[error("the rate of `{0}` is missing")]
    NoRate(String),
    /// A rate or a reset of something that is no state.
    #[error("`{0}` is no state")]
    NoState(String),
    /// A mode that there is not.
    #[error("`{0}` is no mode")]
    NoMode(String),
    /// A switch that there is not.
    #[error("no switch has the name `{0}`")]
    NoSwitch(String),
    /// The phase without a forcing.
    #[error("`phase` has no meaning without `forcing`")]
    NoForcing,
    /// The frequency of the forcing is not positive.
    #[error("the angular frequency of the forcing is {0}; it must be positive")]
    Frequency(f64),
    /// The period that is prescribed is not positive.
    #[error("the period of the orbit is {0}; it must be positive")]
    Period(f64),
    /// A mode whose expressions have no value within it.
    #[error("an expression of `{0}` has no value where its guards are positive: {1}")]
    Within(String, Obstacle),
    /// Two modes that do not meet in one surface.
    #[error(
        "the modes `{0}` and `{1}` do not meet in one surface: each needs one switch to the other with the same `zero` but for the sign"
    )]
    NoSurface(String, String),
    /// Two modes between which nothing slides.
    #[error(
        "sliding between `{0}` and `{1}` has no direction: the difference of their rates is zero, or has no value"
    )]
    NoSliding(String, String),
}

/// Why a name cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum BadName {
    /// It is no word.
    #[error("a name is a letter followed by letters, digits and `_`")]
    NoWord,
    /// The language has it.
    #[error("it has a meaning of its own")]
    Reserved,
    /// It is there twice.
    #[error("it stands for something else already")]
    Twice,
}

/// Something wrong with a system, and the place: names of fields joined by dots, as in
/// `modes.free.rates.v`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("{path}: {mistake}")]
pub struct SystemError {
    /// Path of the field below `system`.
    pub path: String,
    /// What is wrong with it.
    pub mistake: Mistake,
    /// A name that is known and nearly the same.
    pub nearest: Option<String>,
}

impl SystemError {
    pub(crate) fn at(path: impl Into<String>, mistake: Mistake) -> SystemError {
        SystemError {
            path: path.into(),
            mistake,
            nearest: None,
        }
    }

    /// With the nearest of the names that would be right.
    pub(super) fn near<'a>(
        mut self,
        name: &str,
        known: impl Iterator<Item = &'a str>,
    ) -> SystemError {
        let close = known.map(|known| (strsim::osa_distance(name, known), known));
        let nearest = close.min_by_key(|(distance, _)| *distance);
        let letters = name.chars().count();
        // a name of which no letter is right says nothing
        let alike = |distance: usize, known: &str| {
            3 * distance <= letters.max(3) && distance < letters.max(known.chars().count())
        };
        self.nearest = nearest
            .filter(|(distance, known)| alike(*distance, known))
            .map(|(_, known)| known.to_owned());
        self
    }
}

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

/// What every expression may name beside states, parameters and abbreviations.
const RESERVED: [&str; 2] = ["phase", "pi"];

/// Functions whose names nothing else may have. Of the others a name is told by its lack of brackets.
const RESERVED_FUNCTIONS: [&str; 8] = ["sin", "cos", "tan", "exp", "ln", "sqrt", "abs", "tanh"];

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

    /// Name of a mode: first those of the file, then the sliding ones; with contacts those that these make.
    pub fn mode_name(&self, mode: usize) -> Cow<'_, str> {
        match &self.products {
            Some(products) => products.name(mode).into(),
            None => self.mode_names().nth(mode).unwrap_or_default().into(),
        }
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

impl Source {
    /// An expression in the parameters alone.
    pub(super) fn of_parameters(&self, path: &str, text: &str) -> Result<Expression, SystemError> {
        Reader { source: self }.expression(path, text, Scope::Parameters)
    }

    /// Adds the state of every Jenkins element, where it is not there already, and says which it is.
    fn add_stretches(&mut self) -> Vec<Option<usize>> {
        let contacts = self.contacts.0.iter();
        let names =
            contacts.map(|(name, law)| matches!(law, Law::Jenkins { .. }).then(|| stretch(name)));
        let names: Vec<Option<String>> = names.collect();
        let index = |name: Option<String>| {
            let name = name?;
            let known = self.states.iter().position(|state| *state == name);
            Some(known.unwrap_or_else(|| {
                self.states.push(name);
                self.states.len() - 1
            }))
        };
        names.into_iter().map(index).collect()
    }

    /// There are modes, or rates with contacts.
    fn check_modes(&self) -> Result<(), SystemError> {
        let contacts = self.contacts.0.len();
        let refuse = |path: &str, mistake| Err(SystemError::at(path, mistake));
        if self.modes.0.is_empty() && self.rates.0.is_empty() {
            return refuse("modes", Mistake::NoModes);
        }
        if !self.rates.0.is_empty() && (contacts == 0 || !self.modes.0.is_empty()) {
            return refuse("rates", Mistake::Rates);
        }
        if contacts > 0 && !self.sliding.0.is_empty() {
            return refuse("sliding", Mistake::SlidingContacts);
        }
        if contacts > MAX_CONTACTS {
            let mistake = Mistake::Contact(ContactMistake::Many(contacts));
            return refuse("contacts", mistake);
        }
        Ok(())
    }

    /// An expression in states, parameters, abbreviations, forces of contacts and the phase.
    pub(super) fn of_all(&self, path: &str, text: &str) -> Result<Expression, SystemError> {
        let all = Scope::Forces(self.define.0.len());
        Reader { source: self }.expression(path, text, all)
    }

    /// Names of switches, and of contacts, which name every change of their own.
    pub fn switch_names(&self) -> impl Iterator<Item = &str> {
        let switches = self.modes.0.iter().flat_map(|(_, mode)| &mode.until);
        let written = switches.filter_map(|switch| switch.name.as_deref());
        written.chain(self.contacts.names())
    }

    /// Every name is a word and stands for one thing.
    fn check_names(&self) -> Result<(), SystemError> {
        let mut seen = HashSet::new();
        let values = [(
            "states",
            self.states.iter().map(String::as_str).collect::<Vec<_>>(),
        )];
        let values = values.into_iter().chain([
            ("parameters", self.parameters.names().collect()),
            ("define", self.define.names().collect()),
            ("contacts", self.contacts.names().collect()),
        ]);
        for (section, names) in values {
            for name in names {
                let reserved = RESERVED.contains(&name) || RESERVED_FUNCTIONS.contains(&name);
                check_name(section, name, reserved, &mut seen)?;
            }
        }
        let mut seen = HashSet::new();
        for (section, names) in [
            ("modes", self.modes.names().collect::<Vec<_>>()),
            ("sliding", self.sliding.names().collect()),
        ] {
            for name in names {
                check_name(section, name, false, &mut seen)?;
            }
        }
        Ok(())
    }
}

/// Whether a text is a name: a letter followed by letters, digits and `_`.
pub(crate) fn is_name(text: &str) -> bool {
    let mut letters = text.chars();
    let first = letters
        .next()
        .is_some_and(|c| c.is_alphabetic() || c == '_');
    first && letters.all(|c| c.is_alphanumeric() || c == '_')
}

fn check_name<'a>(
    section: &str,
    name: &'a str,
    reserved: bool,
    seen: &mut HashSet<&'a str>,
) -> Result<(), SystemError> {
    let bad = if !is_name(name) {
        BadName::NoWord
    } else if reserved {
        BadName::Reserved
    } else if !seen.insert(name) {
        BadName::Twice
    } else {
        return Ok(());
    };
    let path = format!("{section}.{name}");
    Err(SystemError::at(path, Mistake::Name(name.to_owned(), bad)))
}

/// What an expression may name, with the number of abbreviations that stand before it.
#[derive(Clone, Copy)]
enum Scope {
    Parameters,
    All(usize),
    /// The same, and the forces of contacts.
    Forces(usize),
}

struct Reader<'a> {
    source: &'a Source,
}

impl Reader<'_> {
    fn expression(&self, path: &str, text: &str, scope: Scope) -> Result<Expression, SystemError> {
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
        let flaw = Flaw { span, wrong };
        Err(flawed(flaw).near(&name, known().chain(RESERVED)))
    }

    fn mode_index(&self, path: &str, name: &str) -> Result<usize, SystemError> {
        let modes = &self.source.modes;
        modes.index(name).ok_or_else(|| {
            let error = SystemError::at(path, Mistake::NoMode(name.to_owned()));
            error.near(name, modes.names())
        })
    }

    /// The states that a map is about, each of them once.
    fn state_indices(&self, path: &str, map: &Ordered<String>) -> Result<Vec<usize>, SystemError> {
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
    fn scope_of(&self, field: &str) -> Scope {
        let define = self.source.define.0.len();
        match field {
            "bound" | "static" => Scope::Forces(define),
            _ => Scope::All(define),
        }
    }

    /// The rates of all states; of the state of a Jenkins element its law has it.
    fn rates(&self, path: &str, rates: &Ordered<String>) -> Result<Vec<Expression>, SystemError> {
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

    fn mode(&self, path: &str, mode: &ModeSource) -> Result<Mode, SystemError> {
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
