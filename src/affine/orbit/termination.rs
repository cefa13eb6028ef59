//! The reasons of the system itself for which a branch of orbits ends, and their sentences.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::signature::Sequence;
use super::signature::Zone;
use super::{Critical, OrbitInequality};
use crate::affine::contact::mistake::ContactMistake;
use crate::orbit::TerminationType;

/// Ends of a branch for reasons of the system itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum OrbitTermination {
    /// The orbit has become one of a part of its period, traversed several times.
    Repeats {
        /// How many times.
        times: usize,
    },
    /// The orbit has a symmetry, and beyond it the branch is the image of what it was before.
    Retraces,
    /// Without forcing: beyond it the orbit does not switch any more, and belongs to a family at one value of the
    /// parameter.
    Centre {
        /// The mode that is left.
        zone: Zone,
    },
    /// Orbits beyond it are a family at one value of the parameter.
    Family,
    /// The period grows without bound.
    Unbounded,
    /// It does, beside a saddle that the orbit leaves and returns to in the limit, from others where it comes to more.
    Homoclinic {
        /// Name of the mode of the saddle.
        mode: String,
        /// Name of the mode of the next saddle, where it leads to another one.
        #[serde(default)]
        next: Option<String>,
        /// The parameter of that orbit, where it is known.
        #[serde(default)]
        limit: Option<f64>,
        /// Its error.
        #[serde(default)]
        error: f64,
    },
    /// It does, since the orbit passes a saddle-node of equilibria ever more slowly, or comes to rest where it would switch.
    Equilibrium {
        /// Which of them.
        special: Critical,
        /// The parameter of the equilibrium.
        limit: f64,
        /// Its error.
        error: f64,
    },
    /// It does, since the orbit comes to begin where nothing moves: an equilibrium on the boundary of its mode.
    Stalls {
        /// Name of the mode.
        mode: String,
    },
    /// The states grow without bound.
    Grows,
    /// The orbit shrinks to an equilibrium.
    Shrinks,
    /// The orbit shrinks, in proportion, to a point where its modes meet.
    Vanishes,
    /// The period shrinks to nothing.
    Slides,
    /// The motion comes to rest: zones in which it moves shrink to nothing together.
    Rests {
        /// Names of the modes that are left, each once.
        modes: Vec<String>,
    },
    /// Some states come to rest while others move: what they move by shrinks to nothing.
    PartRests {
        /// Names of the states.
        states: Vec<String>,
        /// What is left of the branch until then at most, in units of the parameter.
        #[serde(default)]
        left: f64,
    },
    /// The return map is discontinuous: on the one side of the event motions come back to its orbit, on the other they
    /// come to a place at a finite distance.
    Discontinuous {
        /// That distance, in units of the range of the states.
        apart: f64,
    },
    /// On one side of the event motions that begin on its orbit stay in the mode in which they begin.
    Stays {
        /// Its name.
        mode: String,
    },
    /// What a motion is off grows within a zone until too few digits are left, as along what repels it: a canard.
    LosesDigits {
        /// Name of the mode.
        mode: String,
        /// How many times it grows.
        growth: f64,
    },
    /// On the other side motions do not go on: modes follow one another at one instant, or no switch is allowed.
    Halts {
        /// Name of the mode in which they stop.
        mode: String,
        /// The guard that is zero there, as the file has it.
        guard: String,
        /// Whether contacts make the modes.
        #[serde(default)]
        by_contacts: bool,
    },
    /// On the other side motions come to where nothing follows by the laws of contacts.
    Refused {
        /// Name of the mode in which they stop.
        mode: String,
        /// The guard that is zero there, as the file has it.
        guard: String,
        /// Why not.
        mistake: Box<ContactMistake>,
    },
    /// The motion only just reaches a guard: beyond it, it misses the switch, and no orbit is near.
    Misses {
        /// What vanishes.
        held: OrbitInequality,
    },
    /// Two switches come at one instant, and in the other order they lead elsewhere.
    Jumps {
        /// What vanishes.
        held: OrbitInequality,
    },
    /// The orbit is one of a family, and keeps what its start has: beyond it others of the family go on, and this one does not.
    OthersRemain {
        /// What vanishes.
        held: OrbitInequality,
        /// Names of the states of which the others have other values where they begin.
        states: Vec<String>,
    },
    /// What slips ends to slip: orbits beyond it are a family, of which the one that keeps what the orbit has here is not admissible.
    FamilyBeyond {
        /// What vanishes.
        held: OrbitInequality,
        /// Names of the states of which orbits of the family have other values where they begin.
        states: Vec<String>,
    },
    /// Beyond it a switch leads to where it is met again at once.
    Held {
        /// The guard, as the file has it.
        guard: String,
        /// Name of the mode.
        mode: String,
    },
    /// The bound of friction is negative where it slips.
    NegativeBound {
        /// Name of the mode.
        mode: String,
        /// The slip, by the name of its contact.
        guard: String,
        /// The least value of the bound in a zone of the mode.
        value: f64,
        /// When that is, after the entry of the zone.
        time: f64,
    },
    /// The durations of successive zones fall geometrically: switches accumulate, and beyond it infinitely many follow
    /// one another in a finite time.
    Accumulates {
        /// How many zones in a row.
        zones: usize,
        /// Of one duration to that before.
        ratio: f64,
    },
}

impl OrbitTermination {
    /// Whether it is an orbit of infinite period whose parameter is known.
    pub(super) fn is_located(&self) -> bool {
        matches!(self, OrbitTermination::Homoclinic { limit: Some(_), .. })
    }
}

/// Names in a row, as a sentence has them.
pub(super) fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

impl fmt::Display for OrbitTermination {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OrbitTermination::Repeats { times } => write!(
                formatter,
                "the orbit is one of 1/{times} of its period, traversed {times} times"
            ),
            OrbitTermination::Retraces => write!(
                formatter,
                "the orbit is symmetric there, and beyond it the branch is the mirror image of what it was before"
            ),
            OrbitTermination::Centre { .. } => write!(
                formatter,
                "beyond it nothing switches: a family of orbits at one value of the parameter"
            ),
            OrbitTermination::Equilibrium { special, limit, .. } => {
                write!(formatter, "{special}, at {limit}")
            }
            OrbitTermination::Family => Critical::Family.fmt(formatter),
            OrbitTermination::Unbounded => write!(formatter, "the period grows without bound"),
            OrbitTermination::Homoclinic {
                mode, next, limit, ..
            } => {
                let (mode, next) = (mode.clone(), next.clone());
                Critical::Homoclinic { mode, next }.fmt(formatter)?;
                match limit {
                    Some(limit) => write!(formatter, ", at {limit}"),
                    None => Ok(()),
                }
            }
            OrbitTermination::Stalls { mode } => write!(
                formatter,
                "the period grows without bound: `{mode}` begins ever nearer to its equilibrium, which lies at its boundary, \
                 and leaves it ever later, until rounding decides when"
            ),
            OrbitTermination::Grows => {
                write!(formatter, "the states grow without bound: a resonance")
            }
            OrbitTermination::Rests { modes } => {
                let last = if modes.len() == 1 { "lasts" } else { "last" };
                let names = quoted(modes);
                write!(
                    formatter,
                    "the motion comes to rest: beyond it {names} {last} for ever, wherever it begins"
                )
            }
            OrbitTermination::PartRests { states, .. } => write!(
                formatter,
                "the motion of {} comes to rest while the rest moves on: beyond it they stand still, which no sequence \
                 of modes nearby has",
                quoted(states)
            ),
            OrbitTermination::Discontinuous { apart } => write!(
                formatter,
                "the return map is discontinuous there: motions beside its orbit on the one side of the event come back \
                 to it after a period, on the other they jump to {apart:.1e} of the range of the states away, however \
                 near they begin: the orbits there are others"
            ),
            OrbitTermination::Stays { mode } => write!(
                formatter,
                "beyond it motions that begin on its orbit stay in `{mode}` for good: nothing leads out of it any more"
            ),
            OrbitTermination::LosesDigits { mode, growth } => write!(
                formatter,
                "what a motion is off grows {growth:.0e} times within a zone of `{mode}`, since it follows what repels it \
                 for long (as a canard does): too few digits are left to go on"
            ),
            OrbitTermination::Halts {
                mode,
                guard,
                by_contacts,
            } => {
                write!(
                    formatter,
                    "beyond it motions beside its orbit stop where {guard} of `{mode}` is zero: "
                )?;
                formatter.write_str(match by_contacts {
                    true => {
                        "by the laws of contacts nothing goes on from there, or more of them hold there than their forces are \
                         determined for"
                    }
                    false => {
                        "no mode of the system goes on from there. Where the rates on both sides push back at that surface, the \
                         motion would stick or slide in it: an entry of `sliding` for the two modes is missing, or a mode or a \
                         switch"
                    }
                })
            }
            OrbitTermination::Refused {
                mode,
                guard,
                mistake,
            } => write!(
                formatter,
                "beyond it motions beside its orbit stop where {guard} of `{mode}` is zero: {mistake}"
            ),
            OrbitTermination::Misses { held } => write!(
                formatter,
                "the orbit ends at its graze: beyond it {} of `{}` does not come to zero any more, and the motion goes \
                 elsewhere",
                held.guard, held.mode
            ),
            OrbitTermination::Jumps { held } => write!(
                formatter,
                "the orbit ends where two switches come at one instant: with {} of `{}` the second of them, the motion \
                 beyond goes elsewhere at once",
                held.guard, held.mode
            ),
            OrbitTermination::OthersRemain { held, states } => write!(
                formatter,
                "the orbit is one of a family, which the branch follows with what {} has of its start: beyond it {} of `{}` is \
                 negative on this orbit, and others of the family, which keep another value, go on",
                quoted(states),
                held.guard,
                held.mode
            ),
            OrbitTermination::FamilyBeyond { held, states } => write!(
                formatter,
                "the orbit ends where the zones of `{}` and of the way back shrink to nothing: beyond it nothing moves there \
                 any more, and orbits are a family that keeps what {} {} at the start. The one that keeps the values of \
                 this orbit is not admissible, others are",
                held.mode,
                quoted(states),
                if states.len() == 1 { "has" } else { "have" }
            ),
            OrbitTermination::Held { guard, mode } => write!(
                formatter,
                "beyond it {guard} is met again as soon as `{mode}` begins: infinitely many switches follow at one \
                 instant"
            ),
            OrbitTermination::NegativeBound {
                mode,
                guard,
                value,
                time,
            } => write!(
                formatter,
                "the bound of the friction against {guard} is {value:.6} in `{mode}`, {time:.6} after the entry: it is to be no less \
                 than zero, or friction drives what slips"
            ),
            OrbitTermination::Shrinks => Critical::Shrinking.fmt(formatter),
            OrbitTermination::Slides => Critical::Instant.fmt(formatter),
            OrbitTermination::Vanishes => Critical::Vanishing.fmt(formatter),
            OrbitTermination::Accumulates { zones, ratio } => write!(
                formatter,
                "switches accumulate: {zones} zones in a row last {ratio:.3} times the one before each, and infinitely \
                 many follow in a finite time"
            ),
        }
    }
}

impl TerminationType<Sequence> for OrbitTermination {
    /// Where motions beyond it stop for lack of a mode the model is at fault, and where digits are lost the branch goes on.
    fn completes(&self) -> bool {
        !matches!(
            self,
            OrbitTermination::Halts { .. }
                | OrbitTermination::Refused { .. }
                | OrbitTermination::LosesDigits { .. }
                | OrbitTermination::NegativeBound { .. }
        )
    }

    fn left(&self) -> Option<Sequence> {
        match self {
            OrbitTermination::Centre { zone } => Some(Sequence(vec![zone.clone()])),
            _ => None,
        }
    }
}
