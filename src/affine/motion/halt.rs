//! Why a motion does not go on, in words.

use std::fmt;

use crate::affine::contact::mistake::ContactMistake;

/// Why a motion does not go on.
#[derive(Clone, Debug, PartialEq)]
pub enum Halt {
    /// A guard is zero and no exit has its conditions fulfilled.
    NoExit {
        /// Its time.
        time: f64,
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
    },
    /// A guard is zero all along, so that nothing tells whether the mode lasts.
    Undecided {
        /// Its time.
        time: f64,
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
    },
    /// Infinitely many switches end in finite time.
    Chattering {
        /// Where they end.
        time: f64,
        /// Ratio of the lengths of successive zones.
        ratio: f64,
    },
    /// Modes hand over to one another without a rest.
    Livelock {
        /// Its time.
        time: f64,
        /// A mode among them.
        mode: usize,
        /// The guard that ends it.
        guard: usize,
    },
    /// Two modes follow one another ever faster while a guard and its rate, which is the same in both, tend to zero:
    /// sliding of second order.
    SecondOrder {
        /// Its time.
        time: f64,
        /// The mode.
        mode: usize,
        /// The guard that leads to the other.
        guard: usize,
        /// Duration of the last zone.
        duration: f64,
    },
    /// Sliding comes to a second surface, at which the motion beyond points back: it would slide in both.
    TwoSurfaces {
        /// Its time.
        time: f64,
        /// The sliding mode.
        mode: usize,
        /// The guard that is zero.
        guard: usize,
    },
    /// Sliding comes to a guard at which its two modes lead to different places.
    Parted {
        /// Its time.
        time: f64,
        /// The sliding mode.
        mode: usize,
        /// The guard that is zero.
        guard: usize,
    },
    /// A guard is negative where the motion begins, and no mode is found that the state lies in.
    Outside {
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
        /// Its value.
        value: f64,
    },
    /// A reset leads out through the guard of its own switch again.
    Outward {
        /// Its time.
        time: f64,
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
    },
    /// A guard is zero at every state.
    Void {
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
    },
    /// The flow is so fast that the time asked for would take too many pieces of it.
    Fast {
        /// Its time.
        time: f64,
        /// Length of a piece.
        piece: f64,
    },
    /// The forces of contacts make no motion.
    Obstructed {
        /// Its time.
        time: f64,
        /// The mode.
        mode: usize,
        /// Why not.
        mistake: ContactMistake,
    },
    /// A guard is zero, and nothing follows by the laws of contacts.
    Refused {
        /// Its time.
        time: f64,
        /// The mode.
        mode: usize,
        /// The guard that is zero.
        guard: usize,
        /// Why not.
        mistake: Box<ContactMistake>,
    },
    /// The bound of friction is negative where it slips.
    NegativeBound {
        /// Time at which it is least over a piece of the motion.
        time: f64,
        /// The mode.
        mode: usize,
        /// The guard that is the slip.
        guard: usize,
        /// The bound there.
        value: f64,
    },
    /// The state grows beyond all numbers, or comes to where an expression has no value.
    Unbounded {
        /// Time of the last state that was finite.
        time: f64,
    },
}

impl Halt {
    /// The mode and the guard that it is about.
    pub fn place(&self) -> Option<(usize, usize)> {
        match *self {
            Halt::NoExit { mode, guard, .. }
            | Halt::Undecided { mode, guard, .. }
            | Halt::SecondOrder { mode, guard, .. }
            | Halt::TwoSurfaces { mode, guard, .. }
            | Halt::Parted { mode, guard, .. }
            | Halt::Livelock { mode, guard, .. }
            | Halt::Outside { mode, guard, .. }
            | Halt::Outward { mode, guard, .. }
            | Halt::Refused { mode, guard, .. }
            | Halt::NegativeBound { mode, guard, .. }
            | Halt::Void { mode, guard } => Some((mode, guard)),
            Halt::Obstructed { .. }
            | Halt::Chattering { .. }
            | Halt::Fast { .. }
            | Halt::Unbounded { .. } => None,
        }
    }

    /// In words, with the names of what it is about.
    pub fn named(&self, mode: &str, guard: &str) -> String {
        match self {
            Halt::NoExit { time, .. } => {
                format!(
                    "at t = {time:?} {guard} of {mode} is zero, and no `if` of its switches holds"
                )
            }
            Halt::Undecided { time, .. } => format!(
                "at t = {time:?} {guard} of {mode} is zero and stays so: nothing tells whether the mode lasts"
            ),
            Halt::Chattering { time, ratio } => format!(
                "switches accumulate at t = {time:?}: chattering, each zone {ratio:.4} times as long as the one before"
            ),
            Halt::Livelock { time, .. } => format!(
                "at t = {time:?} modes follow one another without any time passing: {guard} of {mode} is negative, or \
                 falls from zero, as it begins, and so on: the state lies in none of them, or slides between two that \
                 no mode of `sliding` names"
            ),
            Halt::SecondOrder { time, duration, .. } => format!(
                "by t = {time:?} {mode} and the mode beyond its {guard} follow one another ever faster, the last for \
                 {duration:.1e}: {guard} and its rate, which is the same in both modes, tend to zero together. This is \
                 sliding of second order, which no mode of `sliding` has"
            ),
            Halt::TwoSurfaces { time, .. } => format!(
                "at t = {time:?} {guard} of {mode} is zero, and what lies beyond points back at it: the motion slides \
                 in two surfaces at once, which no mode of `sliding` has"
            ),
            Halt::Parted { time, .. } => format!(
                "at t = {time:?} {guard} of {mode} is zero, where the two modes between which it slides lead to \
                 different places: nothing tells to which of them sliding leads"
            ),
            Halt::Outside { value, .. } => format!(
                "the motion begins outside {mode}: {guard} is {value:.6} there, and positive in the mode; switches lead \
                 to no mode that the state lies in"
            ),
            Halt::Outward { time, .. } => format!(
                "at t = {time:?} the reset of {mode} leads out through {guard} again: it is zero, and still falls"
            ),
            Halt::Void { .. } => {
                format!("{guard} of {mode} is zero at every state: it can end no mode")
            }
            Halt::Fast { time, piece } => format!(
                "at t = {time:?} the motion changes within {piece:.1e}: so fast that the time asked for would take \
                 millions of steps"
            ),
            Halt::NegativeBound { time, value, .. } => format!(
                "at t = {time:?} the bound of the friction against {guard} is {value:.6} in {mode}: it is to be no less than \
                 zero, or friction drives what slips"
            ),
            Halt::Refused { time, mistake, .. } => {
                format!("at t = {time:?} {guard} of {mode} is zero, and {mistake}")
            }
            Halt::Obstructed { time, mistake, .. } => format!("at t = {time:?} {mistake}"),
            Halt::Unbounded { time } => format!(
                "by t = {time:?} the motion grows without bound, or comes to where its rates have no value"
            ),
        }
    }
}

impl fmt::Display for Halt {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mode, guard) = self.place().unwrap_or_default();
        formatter.write_str(&self.named(&format!("mode {mode}"), &format!("guard {guard}")))
    }
}

impl std::error::Error for Halt {}
