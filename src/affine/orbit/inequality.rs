//! Inequalities of an orbit in words: what a margin measures, and where it fails.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::layout::AffineOrbit;
use super::margin::{Margin, Watch};

/// What a margin measures, and where.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitInequality {
    /// Name of the mode.
    pub mode: String,
    /// The guard that it is about, or that ends the mode, as the file has it.
    pub guard: String,
    /// What it measures.
    pub watch: Watch,
}

impl OrbitInequality {
    /// That it fails in a zone, from 0, so long after its entry, in words.
    fn failure(&self, zone: usize, time: f64, value: f64) -> String {
        let OrbitInequality { mode, guard, watch } = self;
        let zone = format!("zone {} of the orbit, `{mode}`", zone + 1);
        let sign = if value < 0.0 { "negative" } else { "zero" };
        match watch {
            Watch::Duration => format!("{zone}, has a {sign} duration"),
            Watch::Onset(_) => {
                format!("{guard} of `{mode}` is {sign} just after the entry of {zone}")
            }
            Watch::Inside(_) => {
                format!("{guard} of `{mode}` is {sign} at t = {time:.6} after the entry of {zone}")
            }
            Watch::End(_) => format!("{guard} of `{mode}` is {sign} at the end of {zone}"),
            Watch::Speed => format!("{guard} of `{mode}` does not fall at the end of {zone}"),
            Watch::Condition(_) | Watch::Before(_) => {
                format!(
                    "a condition of the switch at {guard} of `{mode}` fails at the end of {zone}"
                )
            }
        }
    }
}

impl fmt::Display for OrbitInequality {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OrbitInequality { mode, guard, watch } = self;
        match watch {
            Watch::Duration => write!(formatter, "the duration of a zone of `{mode}`"),
            Watch::Onset(_) => write!(formatter, "{guard} just after the entry of `{mode}`"),
            Watch::Inside(_) => write!(formatter, "the least value of {guard} within `{mode}`"),
            Watch::End(_) => write!(formatter, "{guard} at the end of `{mode}`"),
            Watch::Speed => write!(
                formatter,
                "the speed at which {guard} of `{mode}` falls to zero"
            ),
            Watch::Condition(_) | Watch::Before(_) => {
                write!(formatter, "a condition where {guard} of `{mode}` is zero")
            }
        }
    }
}

/// Why a point is not admissible.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Inadmissible {
    /// A margin is not positive.
    #[error("{}", .held.failure(*zone, *time, *value))]
    Margin {
        /// What it measures.
        held: OrbitInequality,
        /// Its value.
        value: f64,
        /// Zone of the orbit, from 0.
        #[serde(default)]
        zone: usize,
        /// Time after the entry of the zone, of a minimum within it.
        #[serde(default)]
        time: f64,
    },
    /// An inequality holds or fails by no more than rounding.
    #[error("rounding decides whether an inequality holds")]
    Undecided,
}

impl AffineOrbit {
    /// The guards, in the order of their names, that begin and end a zone where a margin is its duration.
    pub fn guards_of_duration(&self, margin: &Margin) -> Option<[String; 2]> {
        let at_end = |zone: usize| {
            let zone = self.sequence.zone(zone);
            let system = &self.setting.system;
            zone.way.map(|way| system.guard_name(zone.mode, way.guard))
        };
        let is_duration = margin.watch == Watch::Duration;
        let before = is_duration.then_some(margin.zone + self.sequence.len() - 1)?;
        let mut guards = [at_end(before)?, at_end(margin.zone)?];
        guards.sort_unstable();
        Some(guards)
    }
}
