//! What happens to orbits, equilibria and motions of a user's system.

use std::fmt::{self, Display, Formatter};

use super::branch::Told;
use super::near_zero;
use crate::affine::equilibrium::EquilibriumCurve;
use crate::affine::motion::Halt;
use crate::affine::orbit::{self as affine, AffineOrbit};
use crate::affine::system::System;
use crate::hybrid::runner::SystemNote;
use crate::hybrid::scan::Lack;
use crate::orbit::{self, EventType};

/// Why a motion does not go on, with the names of its modes.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) fn halt(system: &System, halt: &Halt) -> String {
    let (mode, guard) = halt.place().unwrap_or_default();
    let name = format!("the mode `{}`", system.mode_name(mode));
    let words = halt.named(&name, &system.guard_name(mode, guard));
    match halt {
        Halt::Chattering { .. } => {
            format!("{words}; `rest` of a switch names the mode that begins there")
        }
        Halt::Refused { .. } => format!("{words}; let one of the two be a `Spring`"),
        Halt::Fast { .. } => format!("{words}; ask for less time, or scale what is so fast"),
        _ => words,
    }
}

/// What a motion does that has no samples.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) const AWAY: &str = "the motion does not come to the section";

/// Why a value of a scan has fewer samples than asked for.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) fn lack(system: &System, lack: &Lack) -> String {
    match lack {
        Lack::System(error) => format!("the system makes no sense here: {error}"),
        Lack::Halted(reason) => halt(system, reason),
        Lack::Away { time } => format!("{AWAY} for a time of {time}"),
        Lack::Contradicted(reason) => reason.to_string(),
        Lack::Outside => "no random state lies within the mode that motions begin in".to_owned(),
    }
}

impl Told for AffineOrbit {
    const NAME: &'static str = "orbit";

    fn event(change: &orbit::special::Change<AffineOrbit>) -> String {
        let affine::OrbitInequality { mode, guard, .. } = &change.held;
        match (change.margin.watch, change.kind) {
            (affine::Watch::Duration, EventType::GR) => {
                format!("a zone of `{mode}` between two of one mode shrinks to nothing: grazing")
            }
            (affine::Watch::Duration, _) => format!("a zone of `{mode}` shrinks to nothing"),
            (affine::Watch::Inside(_), _) => {
                format!("{guard} of `{mode}` touches zero from inside: grazing")
            }
            (affine::Watch::Speed | affine::Watch::Onset(_), EventType::GR) => {
                format!("{guard} of `{mode}` is met at zero speed: grazing")
            }
            (_, EventType::SL) => {
                format!(
                    "a condition where {guard} of `{mode}` is zero vanishes: the switch leads elsewhere"
                )
            }
            (affine::Watch::End(_), _) => {
                format!("{guard} of `{mode}` is zero at its end, too: two switches coalesce")
            }
            _ => format!("{guard} of `{mode}` is zero as it begins or ends"),
        }
    }
}

impl<I: Display> Display for SystemNote<I> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let SystemNote::Close {
            parameter,
            value,
            what,
        } = self;
        near_zero(f, parameter, *value, what)
    }
}

impl Told for EquilibriumCurve {
    const NAME: &'static str = "equilibrium";

    fn event(change: &orbit::special::Change<EquilibriumCurve>) -> String {
        let held = &change.held;
        match &change.after {
            None => format!("{held} is zero: a boundary equilibrium"),
            Some(after) if change.turned_back => {
                format!("nonsmooth fold: {held} is zero, and in `{after}` the branch goes on")
            }
            Some(after) => format!("persistence: {held} is zero, and it goes on in `{after}`"),
        }
    }
}
