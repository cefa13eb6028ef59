//! The section `system` as its author writes it: every name is a word that stands for one thing.

use std::collections::HashSet;

use serde::{Deserialize, Deserializer, Serialize};

use super::mistake::{BadName, Mistake, SystemError};
use super::ordered::Ordered;
use crate::affine::contact::law::{Law, stretch};
use crate::affine::contact::mistake::{ContactMistake, MAX_CONTACTS};
use crate::affine::values;

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

/// What every expression may name beside states, parameters and abbreviations.
pub(super) const RESERVED: [&str; 2] = ["phase", "pi"];

/// Functions whose names nothing else may have. Of the others a name is told by its lack of brackets.
const RESERVED_FUNCTIONS: [&str; 8] = ["sin", "cos", "tan", "exp", "ln", "sqrt", "abs", "tanh"];

impl Source {
    /// Adds the state of every Jenkins element, where it is not there already, and says which it is.
    pub(super) fn add_stretches(&mut self) -> Vec<Option<usize>> {
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
    pub(super) fn check_modes(&self) -> Result<(), SystemError> {
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

    /// Names of switches, and of contacts, which name every change of their own.
    pub fn switch_names(&self) -> impl Iterator<Item = &str> {
        let switches = self.modes.0.iter().flat_map(|(_, mode)| &mode.until);
        let written = switches.filter_map(|switch| switch.name.as_deref());
        written.chain(self.contacts.names())
    }

    /// Every name is a word and stands for one thing.
    pub(super) fn check_names(&self) -> Result<(), SystemError> {
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
