//! Inequalities of an orbit: what a margin measures, and where it fails.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::examine::Examination;
use super::layout::AffineOrbit;
use super::margin::{Margin, Watch};
use super::setting::OrbitFailure;
use crate::linalg::Vector;
use crate::orbit::{Examined, Inequalities, Zones};

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

impl Inequalities for AffineOrbit {
    type Inequality = OrbitInequality;
    type Inadmissible = Inadmissible;

    fn margin_at(&self, seen: &Margin, point: &Vector) -> Result<Margin, OrbitFailure> {
        self.at(point)?.again(seen)
    }

    fn add_gradient(&self, margin: &Margin, gradient: &mut [f64]) {
        for (index, by) in &margin.gradient {
            gradient[*index] += by;
        }
    }

    fn slope(&self, margin: &Margin, direction: &Vector) -> f64 {
        let terms = margin.gradient.iter();
        terms.map(|(index, by)| by * direction[*index]).sum()
    }

    fn instant(&self, point: &Vector, margin: &Margin) -> f64 {
        let duration = |zone: usize| point[self.duration_index(zone % self.zones())];
        let period: f64 = (0..self.zones()).map(duration).sum();
        let begun: f64 = (0..margin.zone).map(duration).sum();
        let within = match margin.watch {
            Watch::Duration | Watch::Onset(_) => 0.0,
            Watch::Inside(_) => margin.time / self.setting.scales.time,
            Watch::End(_) | Watch::Speed | Watch::Condition(_) | Watch::Before(_) => {
                duration(margin.zone)
            }
        };
        (begun + within) / period
    }

    fn is_alike(&self, margin: &Margin, other: &AffineOrbit, of_other: &Margin) -> bool {
        self.inequality(margin) == other.inequality(of_other)
    }

    fn inequality(&self, margin: &Margin) -> OrbitInequality {
        let zone = self.sequence.zone(margin.zone);
        let guard = match margin.watch {
            Watch::Onset(guard) | Watch::Inside(guard) | Watch::End(guard) => Some(guard),
            _ => zone.way.map(|way| way.guard),
        };
        let name = |guard| self.setting.system.guard_name(zone.mode, guard);
        OrbitInequality {
            mode: zone.name.clone(),
            guard: guard.map_or_else(String::new, name),
            watch: margin.watch,
        }
    }

    fn inadmissible(&self, examination: &Examination) -> Inadmissible {
        let margins = examination.margins().iter();
        let worst = margins.min_by(|one, other| one.value.total_cmp(&other.value));
        match worst.filter(|margin| margin.value <= 0.0) {
            Some(margin) => Inadmissible::Margin {
                held: self.inequality(margin),
                value: margin.value,
                zone: margin.zone,
                time: margin.time,
            },
            None => Inadmissible::Undecided,
        }
    }
}
