//! The laws of contacts as their author writes them, and the states that each of them has.

use serde::{Deserialize, Serialize};

/// The law of a contact. Its name is its force, which stands linearly in the rates; a positive slip gets a negative
/// force, and the force of a stop or a spring opens the gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Law<T = String> {
    /// Dry friction: q = −B while s > 0, q = B while s < 0, and in between whatever keeps s at zero, up to a bound.
    Friction {
        /// s, the velocity of slip.
        slip: T,
        /// B, the friction while it slips.
        bound: T,
        /// The most that it holds while it sticks, where that is more than B.
        #[serde(default, rename = "static", skip_serializing_if = "Option::is_none")]
        hold: Option<T>,
    },
    /// A rigid stop: impacts with a restitution, and contact that lasts.
    Stop {
        /// g, positive while it is open.
        gap: T,
        /// e: an impact turns ġ into −eġ.
        restitution: T,
    },
    /// A spring on one side: −kg − cġ while it is closed, never tension.
    Spring {
        /// g, positive while it is open and at rest.
        gap: T,
        /// k.
        stiffness: T,
        /// c; none where it is left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        damping: Option<T>,
    },
    /// A spring in series with a slider: −kz, ż = s, up to the bound of the slider.
    Jenkins {
        /// s, the velocity over the element.
        slip: T,
        /// k.
        stiffness: T,
        /// B, the force at which the slider gives.
        bound: T,
    },
}

/// What a contact does: its name where the states of contacts are joined to that of a mode, and its number among the
/// states of its law, in the order that says which zone comes first.
pub type Names = &'static [&'static str];

/// States of dry friction.
pub const FORWARD: usize = 0;
/// See [`FORWARD`].
pub const BACKWARD: usize = 1;
/// See [`FORWARD`].
pub const STICK: usize = 2;
/// States of a stop or a spring.
pub const OPEN: usize = 0;
/// See [`OPEN`].
pub const CLOSED: usize = 1;
/// A damped spring that has lost its force before its gap has opened: open like the other.
pub const PARTING: usize = 2;
/// States of a Jenkins element.
pub const HELD: usize = 0;
/// See [`HELD`].
pub const GIVES_FORWARD: usize = 1;
/// See [`HELD`].
pub const GIVES_BACKWARD: usize = 2;

impl<T> Law<T> {
    /// Names of its states.
    pub fn states(&self) -> Names {
        match self {
            Law::Friction { .. } => &["forward", "backward", "stick"],
            Law::Spring {
                damping: Some(_), ..
            } => &["open", "closed", "open"],
            Law::Stop { .. } | Law::Spring { .. } => &["open", "closed"],
            Law::Jenkins { .. } => &["stick", "forward", "backward"],
        }
    }

    /// What its guards are about in a state, in their order.
    pub fn guards(&self, state: usize) -> Names {
        match (self, state) {
            (Law::Friction { .. }, STICK) | (Law::Jenkins { .. }, HELD) => &["bound", "bound"],
            (Law::Friction { .. } | Law::Jenkins { .. }, _) => &["slip"],
            (Law::Spring { .. }, PARTING) => &["gap", "force"],
            (
                Law::Stop { .. }
                | Law::Spring {
                    damping: Some(_), ..
                },
                CLOSED,
            ) => &["force"],
            (Law::Stop { .. } | Law::Spring { .. }, _) => &["gap"],
        }
    }

    /// The same with every expression through a function, which is told the name of its field.
    ///
    /// # Errors
    /// The first that the function has.
    pub fn map<U, E>(
        &self,
        mut change: impl FnMut(&'static str, &T) -> Result<U, E>,
    ) -> Result<Law<U>, E> {
        Ok(match self {
            Law::Friction { slip, bound, hold } => Law::Friction {
                slip: change("slip", slip)?,
                bound: change("bound", bound)?,
                hold: hold
                    .as_ref()
                    .map(|hold| change("static", hold))
                    .transpose()?,
            },
            Law::Stop { gap, restitution } => Law::Stop {
                gap: change("gap", gap)?,
                restitution: change("restitution", restitution)?,
            },
            Law::Spring {
                gap,
                stiffness,
                damping,
            } => Law::Spring {
                gap: change("gap", gap)?,
                stiffness: change("stiffness", stiffness)?,
                damping: damping
                    .as_ref()
                    .map(|damping| change("damping", damping))
                    .transpose()?,
            },
            Law::Jenkins {
                slip,
                stiffness,
                bound,
            } => Law::Jenkins {
                slip: change("slip", slip)?,
                stiffness: change("stiffness", stiffness)?,
                bound: change("bound", bound)?,
            },
        })
    }

    /// Every expression, with the name of its field.
    pub fn parts(&self) -> Vec<(&'static str, &T)> {
        match self {
            Law::Friction { slip, bound, hold } => {
                let hold = hold.as_ref().map(|hold| ("static", hold));
                [("slip", slip), ("bound", bound)]
                    .into_iter()
                    .chain(hold)
                    .collect()
            }
            Law::Stop { gap, restitution } => vec![("gap", gap), ("restitution", restitution)],
            Law::Spring {
                gap,
                stiffness,
                damping,
            } => {
                let damping = damping.as_ref().map(|damping| ("damping", damping));
                [("gap", gap), ("stiffness", stiffness)]
                    .into_iter()
                    .chain(damping)
                    .collect()
            }
            Law::Jenkins {
                slip,
                stiffness,
                bound,
            } => vec![("slip", slip), ("stiffness", stiffness), ("bound", bound)],
        }
    }
}

/// Name of the state that a Jenkins element adds to those of the system.
pub fn stretch(contact: &str) -> String {
    format!("z_{contact}")
}

/// The modes of a system with contacts: the user's times the states of every contact, as the digits of a number. The
/// user's mode is the first digit and the last contact the last, so that numbers are in the order of the names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Products {
    /// Names of the user's modes; one without a name where there are none.
    own: Vec<String>,
    /// Names of the states of every contact.
    states: Vec<Names>,
}

impl Products {
    /// Of these modes and contacts with these states.
    pub fn new(own: Vec<String>, states: Vec<Names>) -> Products {
        Products { own, states }
    }

    /// How many there are; as many as can be counted where there are more.
    pub fn count(&self) -> usize {
        let states = self.states.iter().map(|names| names.len());
        states.fold(self.own.len(), usize::saturating_mul)
    }

    /// The user's mode and the states of the contacts.
    pub fn digits(&self, mode: usize) -> (usize, Vec<usize>) {
        let mut left = mode;
        let mut digits: Vec<usize> = vec![0; self.states.len()];
        for (digit, names) in digits.iter_mut().zip(&self.states).rev() {
            *digit = left % names.len();
            left /= names.len();
        }
        (left, digits)
    }

    /// The number of a mode.
    pub fn number(&self, own: usize, digits: &[usize]) -> usize {
        let places = digits.iter().zip(&self.states);
        places.fold(own, |number, (digit, names)| number * names.len() + digit)
    }

    /// The name of a mode.
    pub fn name(&self, mode: usize) -> String {
        let (own, digits) = self.digits(mode);
        let own = self.own.get(own).filter(|name| !name.is_empty());
        let states = digits
            .iter()
            .zip(&self.states)
            .map(|(digit, names)| names[*digit]);
        let parts = own.map(String::as_str).into_iter().chain(states);
        parts.collect::<Vec<_>>().join(".")
    }

    /// The number of the first mode of a name.
    pub fn mode(&self, name: &str) -> Option<usize> {
        let mut parts = name.split('.').peekable();
        let own = match self.own.as_slice() {
            [only] if only.is_empty() => 0,
            _ => {
                let own = parts.next()?;
                self.own.iter().position(|known| known == own)?
            }
        };
        let digits = self.states.iter().map(|names| {
            let part = parts.next()?;
            names.iter().position(|known| *known == part)
        });
        let digits: Vec<usize> = digits.collect::<Option<_>>()?;
        parts.next().is_none().then(|| self.number(own, &digits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_in_the_order_of_the_states() {
        let friction: Law = Law::Friction {
            slip: String::new(),
            bound: String::new(),
            hold: None,
        };
        let stop: Law = Law::Stop {
            gap: String::new(),
            restitution: String::new(),
        };
        let own = vec!["on".to_owned(), "off".to_owned()];
        let products = Products::new(own, vec![friction.states(), stop.states()]);
        assert_eq!(products.count(), 12);
        let names: Vec<String> = (0..12).map(|mode| products.name(mode)).collect();
        assert_eq!(names[0], "on.forward.open");
        assert_eq!(names[5], "on.stick.closed");
        assert_eq!(names[11], "off.stick.closed");
        for (mode, name) in names.iter().enumerate() {
            assert_eq!(products.mode(name), Some(mode));
        }
        for name in [
            "on.stick",
            "stick.open",
            "on.stick.closed.open",
            "on.open.stick",
        ] {
            assert_eq!(products.mode(name), None, "{name}");
        }
    }
}
