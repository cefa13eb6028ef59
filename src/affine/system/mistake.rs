//! What is wrong with a system, and where.

use serde::{Deserialize, Serialize};

use super::MAX_STATES;
use crate::affine::algebra::Obstacle;
use crate::affine::contact::mistake::ContactMistake;
use crate::affine::expression::ExpressionFlaw;

/// What is wrong with a system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Mistake {
    /// An expression.
    #[error("{}", .0.wrong)]
    Expression(ExpressionFlaw),
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
    pub(in crate::affine) fn near<'a>(
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
