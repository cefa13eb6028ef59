//! What is positive at an equilibrium of a mode.

use super::resting::{Resting, are_opposite, formulas};
use crate::affine::expression::Algebra;
use crate::affine::system::System;

/// What is positive at an equilibrium of a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// λ of a sliding mode: the field of its first mode pushes to the surface.
    FirstPush,
    /// 1 − λ: that of its second mode does.
    SecondPush,
    /// The `zero` of a switch, by mode and index.
    Zero([usize; 2]),
}

impl Guard {
    /// In words, as the messages of a run have it.
    pub fn name(self, system: &System, resting: &Resting) -> String {
        let push = |side: usize| match resting {
            Resting::Sliding(surface) => {
                format!("the push of `{}`", system.mode_name(surface.sides[side]))
            }
            Resting::Mode(_) => String::new(),
        };
        match self {
            Guard::FirstPush => push(0),
            Guard::SecondPush => push(1),
            Guard::Zero([mode, switch]) => {
                let known = system.source.modes.0.get(mode);
                let known = known.and_then(|(_, mode)| mode.until.get(switch));
                format!("`{}`", known.map_or("", |switch| switch.zero.as_str()))
            }
        }
    }
}

/// The guards of a mode, those of one formula once. A sliding mode has, beside the pushes that hold it, those of the modes on its sides
/// but its surface.
pub fn guards(system: &System, resting: &Resting) -> Vec<Guard> {
    let place = formulas(system, None);
    let (mut found, sides, surface) = match resting {
        Resting::Mode(mode) => (Vec::new(), vec![*mode], None),
        Resting::Sliding(surface) => (
            vec![Guard::FirstPush, Guard::SecondPush],
            surface.sides.to_vec(),
            place.zero(surface.zero),
        ),
    };
    let mut known: Vec<_> = surface
        .into_iter()
        .flat_map(|surface| [surface.clone().negative(), surface])
        .collect();
    for mode in sides {
        let switches = system.modes.get(mode).map_or(0, |mode| mode.switches.len());
        for switch in 0..switches {
            let Some(formula) = place.zero([mode, switch]) else {
                // a formula without a value is no other's
                found.push(Guard::Zero([mode, switch]));
                continue;
            };
            let minus = formula.clone().negative();
            if !known.iter().any(|one| are_opposite(one, &minus)) {
                known.push(formula);
                found.push(Guard::Zero([mode, switch]));
            }
        }
    }
    found
}

/// Whether the `zero`s of two switches are one by their formulas.
pub fn are_one(system: &System, one: [usize; 2], other: [usize; 2]) -> bool {
    let place = formulas(system, None);
    let both = place.zero(one).zip(place.zero(other));
    one == other || both.is_some_and(|(one, other)| are_opposite(&one, &other.negative()))
}
