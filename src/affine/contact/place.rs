//! Whether a state is one of the contacts that a mode names.

use super::law::{BACKWARD, CLOSED, FORWARD, Law, OPEN, STICK};
use crate::affine::mode::AffineSystem;
use crate::affine::motion::Moment;
use crate::affine::system::System;

/// Part of the terms of a slip or a gap, or of what their rates make of the time in which the forcing turns by 1, below which it is zero:
/// a state is written in so many digits, and the velocity of what rests is rounding.
const ZERO: f64 = 1e-9;

impl System {
    /// Whether a state is that of a Jenkins element.
    pub fn is_stretch(&self, name: &str) -> bool {
        let state = self.source.states.iter().position(|state| state == name);
        state.is_some() && self.stretches.contains(&state)
    }

    /// The first contact that a place contradicts, and the name of the mode with the states that it has instead.
    pub fn contradicted(&self, at: &AffineSystem, place: &Moment) -> Option<(&str, String)> {
        let products = self.products.as_ref()?;
        let (own, digits) = products.digits(place.mode);
        // every slip and every gap is the first guard of its contact in its first state, but for Jenkins elements
        let first = vec![0; digits.len()];
        let mode = products.number(own, &first);
        let z = at.lift(mode, &place.state, place.phase);
        let guards = &at.modes[mode].guards;
        let matrix = at.modes[mode].matrix.at.abs();
        let moved = match at.omega.value {
            0.0 => z.map(|_| 0.0),
            omega => matrix * z.abs() / omega.abs(),
        };
        let mut fits = digits.clone();
        let mut wrong = None;
        let mut index = 0;
        let contacts = self
            .source
            .contacts
            .0
            .iter()
            .zip(&self.contacts)
            .enumerate();
        for (contact, ((name, _), law)) in contacts {
            let row = &guards.get(index)?.row;
            index += law.guards(0).len();
            let (value, size) = (row.value(&z), row.size(&z).max(row.size(&moved)));
            let sign = if value.abs() <= ZERO * size {
                0.0
            } else {
                value.signum()
            };
            let digit = digits[contact];
            let better = match (law, digit) {
                (Law::Friction { .. }, FORWARD) if sign < 0.0 => Some(BACKWARD),
                (Law::Friction { .. }, BACKWARD) if sign > 0.0 => Some(FORWARD),
                (Law::Friction { .. }, STICK) if sign != 0.0 => {
                    Some(if sign > 0.0 { FORWARD } else { BACKWARD })
                }
                (Law::Stop { .. }, CLOSED) if sign > 0.0 => Some(OPEN),
                (Law::Spring { .. }, OPEN) if sign < 0.0 => Some(CLOSED),
                (Law::Spring { damping: None, .. }, CLOSED) if sign > 0.0 => Some(OPEN),
                _ => None,
            };
            if let Some(better) = better {
                fits[contact] = better;
                wrong = wrong.or(Some(name.as_str()));
            }
        }
        wrong.map(|name| (name, products.name(products.number(own, &fits))))
    }
}
