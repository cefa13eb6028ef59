//! The states of contacts that a state of the system lies in.
//!
//! Slips, gaps and the forces of springs follow from the state of the system, and say of each contact in which states it may
//! be there. Where a slip or a gap is zero its force decides between these.

use super::law::{
    BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, OPEN, STICK,
};
use crate::affine::mode::{AffineMode, AffineSystem, Row};
use crate::affine::motion::{Moment, Motion};
use crate::affine::system::System;
use crate::linalg::Vector;

/// Part of the terms of a slip or a gap, or of what their rates make of the time in which the forcing turns by 1, below which it is zero:
/// a state is written in so many digits, and the velocity of what rests is rounding.
const ZERO: f64 = 1e-9;

/// Most combinations of states of contacts that are tried where slips or gaps are zero.
const MOST: usize = 4096;

/// Why a place is none of the mode that it names.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Contradiction {
    /// A contact is in another state there.
    #[error("the contact `{contact}` is in another state there: the mode that fits is `{fits}`")]
    Other {
        /// Its name.
        contact: String,
        /// Name of the mode with the states that fit.
        fits: String,
    },
    /// A Jenkins element is stretched beyond its bound.
    #[error("`{state}` is beyond the bound of its element, {bound:.6}")]
    Beyond {
        /// Its state.
        state: String,
        /// The stretch at its bound.
        bound: f64,
    },
    /// It lies behind a stop: the contact has no state there.
    #[error("the state lies behind the stop `{contact}`: its gap is {gap:.6} there")]
    Behind {
        /// The stop.
        contact: String,
        /// Its gap.
        gap: f64,
    },
}

/// A place with modes of contacts.
struct PlaceOfContacts<'a> {
    system: &'a System,
    at: &'a AffineSystem,
    place: &'a Moment,
    /// The user's mode.
    own: usize,
    /// The state, with what modes are made of.
    z: Vector,
}

impl System {
    /// Whether a state is that of a Jenkins element.
    pub fn is_stretch(&self, name: &str) -> bool {
        let state = self.source.states.iter().position(|state| state == name);
        state.is_some() && self.stretches.contains(&state)
    }

    /// The stretch of a Jenkins element in a mode, where nothing else tells: none where it holds, that at its bound where it
    /// slips.
    pub fn stretch(&self, at: &AffineSystem, mode: usize, name: &str) -> f64 {
        let state = self.source.states.iter().position(|state| state == name);
        let contact = state.and_then(|_| self.stretches.iter().position(|known| *known == state));
        let (Some(products), Some(contact)) = (&self.products, contact) else {
            return 0.0;
        };
        let (own, digits) = products.digits(mode);
        let rest = vec![0.0; self.source.states.len()];
        let place = Moment {
            time: 0.0,
            phase: 0.0,
            mode,
            state: rest,
        };
        let of_contacts = PlaceOfContacts::new(self, at, &place, own);
        let bound = of_contacts.bound(contact, digits[contact]);
        bound.map_or(0.0, |(_, stretch)| stretch)
    }

    /// Refuses a place whose contacts are in other states than its mode names.
    ///
    /// # Errors
    /// The first contact that is, or has no state there.
    pub fn admits(&self, at: &AffineSystem, place: &Moment) -> Result<(), Contradiction> {
        let Moment {
            mode: fits, state, ..
        } = self.fitting(at, place.clone())?;
        let Some(products) = &self.products else {
            return Ok(());
        };
        let fitting = products.name(fits);
        if fitting == products.name(place.mode) {
            let mut changed = state.iter().zip(&place.state);
            let beyond = changed.position(|(fits, given)| fits != given);
            return match beyond {
                Some(index) => Err(Contradiction::Beyond {
                    state: self.source.states[index].clone(),
                    bound: state[index],
                }),
                None => Ok(()),
            };
        }
        let [named, fits] = [place.mode, fits].map(|mode| products.digits(mode).1);
        let other = named.iter().zip(&fits).position(|(one, two)| one != two);
        let contact = other.and_then(|contact| self.source.contacts.names().nth(contact));
        Err(Contradiction::Other {
            contact: contact.unwrap_or_default().to_owned(),
            fits: fitting,
        })
    }

    /// The place in the mode of the states that its contacts are in: those that it names, unless the state contradicts them. A Jenkins
    /// element that is stretched beyond its bound has given.
    ///
    /// # Errors
    /// It lies behind a stop.
    pub fn fitting(&self, at: &AffineSystem, mut place: Moment) -> Result<Moment, Contradiction> {
        let Some(products) = &self.products else {
            return Ok(place);
        };
        let (own, mut digits) = products.digits(place.mode);
        let given = PlaceOfContacts::new(self, at, &place, own).given();
        for Given {
            contact,
            state,
            digit,
            stretch,
        } in given
        {
            (place.state[state], digits[contact]) = (stretch, digit);
        }
        place.mode = products.number(own, &digits);
        let of_contacts = PlaceOfContacts::new(self, at, &place, own);
        let mut possible = Vec::with_capacity(digits.len());
        for contact in 0..digits.len() {
            possible.push(of_contacts.states(contact)?);
        }
        let pairs = || possible.iter().zip(&digits);
        if pairs().all(|(states, digit)| states.contains(digit)) {
            return Ok(place);
        }
        // what is named comes first where it is possible
        let possible = pairs().map(|(states, digit)| match states.contains(digit) {
            true => vec![*digit],
            false => states.clone(),
        });
        let mode = of_contacts.mode_among(&possible.collect::<Vec<_>>());
        Ok(Moment { mode, ..place })
    }
}

fn z_at(at: &AffineSystem, place: &Moment) -> Vector {
    let mut z = at.lift(place.mode, &place.state, place.phase);
    at.modes[place.mode].field.complete_at_switch(&mut z);
    z
}

/// A Jenkins element that is stretched beyond its bound: it has given.
struct Given {
    contact: usize,
    /// The state that is its stretch.
    state: usize,
    /// The state in which it gives.
    digit: usize,
    /// The stretch at its bound.
    stretch: f64,
}

impl<'a> PlaceOfContacts<'a> {
    /// In a mode of the user's.
    fn new(system: &'a System, at: &'a AffineSystem, place: &'a Moment, own: usize) -> Self {
        PlaceOfContacts {
            system,
            at,
            z: z_at(at, place),
            place,
            own,
        }
    }

    /// What the bound of a Jenkins element leaves of its force on the side on which it gives in a state, and its stretch at that bound.
    fn bound(&self, contact: usize, digit: usize) -> Option<(f64, f64)> {
        let side = match digit {
            GIVES_FORWARD => 0,
            GIVES_BACKWARD => 1,
            _ => return None,
        };
        let stretch = self.system.stretches[contact]?;
        let (mode, first) = self.mode(contact, HELD);
        let row = &mode.guards.get(first + side)?.row;
        let by_stretch = row.at[stretch];
        let left = self.value(mode, row);
        let at_bound = self.z[stretch] - row.value(&self.z) / by_stretch;
        at_bound.is_finite().then_some((left, at_bound))
    }

    /// The Jenkins elements that are stretched beyond their bounds.
    fn given(&self) -> Vec<Given> {
        let elements = self.system.stretches.iter().enumerate();
        let elements = elements.filter_map(|(contact, state)| Some((contact, (*state)?)));
        let beyond = elements.filter_map(|(contact, state)| {
            let mut sides = [GIVES_FORWARD, GIVES_BACKWARD].into_iter();
            sides.find_map(|digit| {
                let (left, stretch) = self.bound(contact, digit)?;
                let given = Given {
                    contact,
                    state,
                    digit,
                    stretch,
                };
                (left < 0.0).then_some(given)
            })
        });
        beyond.collect()
    }

    /// A mode in which a contact is in one state, and all others are in their first.
    fn mode(&self, contact: usize, digit: usize) -> (&AffineMode, usize) {
        let laws = &self.system.contacts;
        let mut digits = vec![0; laws.len()];
        digits[contact] = digit;
        let number = self.number(&digits);
        let earlier = laws[..contact].iter().map(|law| law.guards(0).len());
        (&self.at.modes[number], earlier.sum())
    }

    fn number(&self, digits: &[usize]) -> usize {
        let products = self.system.products.as_ref();
        products.map_or(self.place.mode, |products| {
            products.number(self.own, digits)
        })
    }

    /// The value of a row, zero where it is nothing but rounding.
    fn value(&self, mode: &AffineMode, row: &Row) -> f64 {
        let z = &self.z;
        let moved = match self.at.omega.value {
            0.0 => z.map(|_| 0.0),
            omega => mode.matrix.at.abs() * z.abs() / omega.abs(),
        };
        let value = row.value(z);
        let size = row.size(z).max(row.size(&moved));
        if value.abs() <= ZERO * size {
            0.0
        } else {
            value
        }
    }

    /// The values of the guards of a contact in one of its states.
    fn guards(&self, contact: usize, digit: usize) -> Vec<f64> {
        let (mode, first) = self.mode(contact, digit);
        let count = self.system.contacts[contact].guards(digit).len();
        let own = mode.guards.iter().skip(first).take(count);
        own.map(|guard| self.value(mode, &guard.row)).collect()
    }

    /// The states of a contact that the state of the system allows.
    fn states(&self, contact: usize) -> Result<Vec<usize>, Contradiction> {
        let law = &self.system.contacts[contact];
        let none_negative = |digit: &usize| self.guards(contact, *digit).iter().all(|x| *x >= 0.0);
        let first = || self.guards(contact, 0).first().copied().unwrap_or_default();
        let possible = |digits: std::ops::Range<usize>| digits.filter(none_negative).collect();
        Ok(match law {
            Law::Friction { .. } if first() == 0.0 => vec![STICK, FORWARD, BACKWARD],
            Law::Friction { .. } => possible(FORWARD..STICK),
            Law::Jenkins { .. } => {
                let mut states: Vec<usize> = possible(HELD..law.states().len());
                states.retain(|digit| {
                    let bound = self.bound(contact, *digit);
                    bound.is_none_or(|(left, _)| left == 0.0)
                });
                // a slider that has not come to its bound holds
                if states.is_empty() {
                    vec![HELD]
                } else {
                    states
                }
            }
            Law::Stop { .. } => match first() {
                gap if gap < 0.0 => {
                    let contact = self.system.source.contacts.names().nth(contact);
                    let contact = contact.unwrap_or_default().to_owned();
                    return Err(Contradiction::Behind { contact, gap });
                }
                0.0 if self.rests(contact) => vec![CLOSED, OPEN],
                _ => vec![OPEN],
            },
            Law::Spring { damping: None, .. } => possible(OPEN..law.states().len()),
            Law::Spring { .. } => {
                let gap = first();
                let of_force = |digit: &usize| *digit == OPEN || gap <= 0.0;
                let states: Vec<usize> = possible(OPEN..law.states().len());
                states.into_iter().filter(of_force).collect()
            }
        })
    }

    /// Whether a gap that is zero has no velocity.
    fn rests(&self, contact: usize) -> bool {
        let (mode, _) = self.mode(contact, CLOSED);
        let mut held = mode.surfaces();
        held.all(|row| self.value(mode, row) == 0.0)
    }

    /// The first mode of these states of the contacts in which no guard is negative, or about to be; the first of all where there is
    /// none.
    fn mode_among(&self, possible: &[Vec<usize>]) -> usize {
        let count = possible
            .iter()
            .fold(1_usize, |count, states| count.saturating_mul(states.len()));
        let number = |combination: usize| {
            let mut left = combination;
            let digits = possible.iter().map(|states| {
                let digit = states[left % states.len()];
                left /= states.len();
                digit
            });
            self.number(&digits.collect::<Vec<_>>())
        };
        let is_inside = |mode: &usize| {
            let place = Moment {
                mode: *mode,
                ..self.place.clone()
            };
            let obstructed = self.at.modes[*mode].obstruction.is_some();
            !obstructed && Motion::new(self.at, place, 1.0).is_inside()
        };
        let mut numbers = (0..count.min(MOST)).map(number);
        numbers.find(is_inside).unwrap_or_else(|| number(0))
    }
}
