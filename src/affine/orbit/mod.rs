//! Periodic orbits of a hybrid system as orbits that the engine follows.
//!
//! [`signature`] is the sequence of zones, [`layout`] has the unknowns, [`residual`] the equations; [`passage`] is
//! the exact flow through a zone with its derivatives, and [`structure`] knows what is zero at its ends whatever the
//! parameter, as [`forms`] tell, or [`generic`] points. [`margin`] measures the inequalities, [`examine`] decides them; [`candidates`] finds
//! what lies beyond an event; [`multipliers`] has the stability; [`start`] finds the first orbit, [`switch`] that of the
//! other branch at an event, and [`row`] has what results keep of one.

pub mod candidates;
pub mod examine;
mod forms;
mod generic;
pub mod layout;
pub mod margin;
pub mod multipliers;
mod passage;
mod residual;
pub mod row;
pub mod signature;
pub mod start;
mod structure;
pub mod switch;

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::continuation::Node;
use crate::continuation::newton;
use crate::linalg::{Matrix, Vector};
use crate::orbit::{Candidate, EventType, Examined, Orbit};

pub use examine::Examination;
pub use layout::{AffineOrbit, OrbitFailure, Scales, Setting, ZonePoint};
pub use margin::{Margin, Watch};
pub use multipliers::Multiplier;
pub use signature::{Sequence, Way, Zone};

/// What a margin measures, and where.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Held {
    /// Name of the mode.
    pub mode: String,
    /// What it measures.
    pub watch: Watch,
}

impl fmt::Display for Held {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mode = &self.mode;
        match self.watch {
            Watch::Duration => write!(formatter, "the duration of a zone of `{mode}`"),
            Watch::Onset(_) => write!(formatter, "a guard of `{mode}` just after its entry"),
            Watch::Inside(_) => write!(formatter, "the least value of a guard within `{mode}`"),
            Watch::End(_) => write!(formatter, "another guard of `{mode}` at its end"),
            Watch::Speed => write!(
                formatter,
                "the speed at which the guard of `{mode}` falls to zero"
            ),
            Watch::Condition(_) | Watch::Before(_) => {
                write!(formatter, "a condition at the end of `{mode}`")
            }
        }
    }
}

/// Why a point is not admissible.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Inadmissible {
    /// A margin is not positive.
    #[error("{held} is not positive: {value:e}")]
    Margin {
        /// What it measures.
        held: Held,
        /// Its value.
        value: f64,
    },
    /// An inequality holds or fails by no more than rounding.
    #[error("rounding decides whether an inequality holds")]
    Undecided,
}

/// A change of stability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Critical {
    /// A multiplier passes −1.
    PeriodDoubling,
    /// A multiplier passes 1 other than by a fold.
    Branching,
    /// A pair passes the unit circle at this angle.
    Torus {
        /// In radians, between 0 and π.
        angle: f64,
    },
}

impl fmt::Display for Critical {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Critical::PeriodDoubling => write!(formatter, "a multiplier passes -1"),
            Critical::Branching => write!(formatter, "a multiplier passes 1"),
            Critical::Torus { angle } => {
                write!(
                    formatter,
                    "a pair of multipliers passes the unit circle at {angle} rad"
                )
            }
        }
    }
}

/// Ends of a branch for reasons of the system itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OrbitStop {
    /// The orbit has become one of a part of its period, traversed several times.
    Repeats {
        /// How many times.
        times: usize,
    },
    /// Without forcing: beyond it the orbit does not switch any more, and belongs to a family at one value of the
    /// parameter.
    Centre,
    /// The period grows without bound.
    Unbounded,
    /// The orbit shrinks to an equilibrium.
    Shrinks,
}

impl fmt::Display for OrbitStop {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OrbitStop::Repeats { times } => write!(
                formatter,
                "the orbit is one of 1/{times} of its period, traversed {times} times"
            ),
            OrbitStop::Centre => write!(
                formatter,
                "beyond it nothing switches: a family of orbits at one value of the parameter"
            ),
            OrbitStop::Unbounded => write!(formatter, "the period grows without bound"),
            OrbitStop::Shrinks => write!(
                formatter,
                "the orbit shrinks to an equilibrium: its Hopf point"
            ),
        }
    }
}

/// The parameter is stationary, to rounding, where it changes by less than this along a unit tangent; if nothing but
/// durations changes there, by this part at least, they grow without bound.
const STATIONARY: f64 = 1e-8;
const GROWING: f64 = 0.9;

/// A zone shorter than this, in units of the period, is about to close.
const CLOSING: f64 = 1e-6;

impl Orbit for AffineOrbit {
    type Signature = Sequence;
    type Parameter = String;
    type Margin = Margin;
    type Examination = Examination;
    type Held = Held;
    type Inadmissible = Inadmissible;
    type Special = Critical;
    type Remark = Critical;
    type Stop = OrbitStop;

    fn signature(&self) -> &Sequence {
        &self.sequence
    }

    fn posed(&self, signature: Sequence) -> Option<AffineOrbit> {
        self.with_sequence(signature)
    }

    fn is_rotation(&self, signature: &Sequence) -> bool {
        signature.is_rotation_of(&self.sequence)
    }

    fn parameter(&self) -> String {
        let names = self.setting.system.source.parameters.names();
        let mut names = names.skip(self.setting.parameter);
        names.next().unwrap_or_default().to_owned()
    }

    fn column(parameter: &String) -> &str {
        parameter
    }

    fn duration_index(&self, zone: usize) -> usize {
        self.width() * zone + self.states()
    }

    fn unit(&self) -> f64 {
        self.setting.scales.parameter
    }

    fn examination(&self, point: &Vector) -> Result<Examination, OrbitFailure> {
        self.at(point)?.examine()
    }

    fn margin_at(&self, seen: &Margin, point: &Vector) -> Result<Margin, OrbitFailure> {
        self.at(point)?.again(seen)
    }

    fn value(margin: &Margin) -> f64 {
        margin.value
    }

    fn add_gradient(&self, margin: &Margin, gradient: &mut [f64]) {
        for (sum, by) in gradient.iter_mut().zip(&margin.gradient) {
            *sum += by;
        }
    }

    fn is_same(one: &Margin, other: &Margin) -> bool {
        (one.watch, one.zone) == (other.watch, other.zone)
    }

    /// A zone without length says most, then a switch without speed: where an orbit that is traversed several
    /// times grazes, every traversal touches, and the one that has touched before goes first.
    fn precedence(margin: &Margin) -> usize {
        match margin.watch {
            Watch::Duration => 0,
            Watch::Speed | Watch::Onset(_) => 1,
            _ => 2,
        }
    }

    fn is_alike(&self, margin: &Margin, other: &AffineOrbit, of_other: &Margin) -> bool {
        self.held(margin) == other.held(of_other)
    }

    fn held(&self, margin: &Margin) -> Held {
        Held {
            mode: self.sequence.zone(margin.zone).name.clone(),
            watch: margin.watch,
        }
    }

    fn inadmissible(&self, examination: &Examination) -> Inadmissible {
        let margins = examination.margins().iter();
        let worst = margins.min_by(|one, other| one.value.total_cmp(&other.value));
        match worst.filter(|margin| margin.value <= 0.0) {
            Some(margin) => Inadmissible::Margin {
                held: self.held(margin),
                value: margin.value,
            },
            None => Inadmissible::Undecided,
        }
    }

    fn candidates(
        &self,
        point: &Vector,
        margin: &Margin,
    ) -> Result<Vec<Candidate<AffineOrbit>>, OrbitFailure> {
        candidates::candidates(self, point, margin)
    }

    /// The same from either side: a zone that is split by a touch from inside merges on the way back.
    fn classify(before: &Sequence, after: Option<&Sequence>, margin: &Margin) -> EventType {
        if matches!(margin.watch, Watch::Inside(_) | Watch::Speed) {
            return EventType::GR;
        }
        match after {
            Some(after) if before.is_split_in(after) || after.is_split_in(before) => EventType::GR,
            Some(after) if before.leads_elsewhere(after) => EventType::SL,
            Some(_) => EventType::CO,
            None => match margin.watch {
                Watch::Condition(_) | Watch::Before(_) => EventType::SL,
                _ => EventType::CO,
            },
        }
    }

    fn opens(&self, point: &Vector) -> bool {
        (0..self.zones()).any(|zone| point[self.duration_index(zone)] == 0.0)
    }

    fn closes(&self, point: &Vector) -> bool {
        (0..self.zones()).any(|zone| point[self.duration_index(zone)].abs() <= CLOSING)
    }

    fn rounding(&self, matrix: &Matrix, point: &Vector, last: f64) -> Option<f64> {
        let parameter = point.len() - 1;
        // the phase has the rounding of a turn
        let mut sizes = point.abs();
        if let Some(index) = self.phase_index() {
            sizes[index] = sizes[index].max(1.0);
        }
        let mut noise = newton::noise(self, matrix, point);
        if let Some(noise) = &mut noise {
            noise[parameter] = last;
        }
        Some(newton::rounding(matrix, &sizes, noise.as_ref())?[parameter])
    }

    fn ends_at(&self, point: &Vector, margin: &Margin) -> Option<OrbitStop> {
        // beyond it a mode that is not linear has an orbit of its own
        let at = self.at(point).ok()?;
        let remains = margin.zone + usize::from(margin.watch == Watch::Duration);
        if !at.mode(remains).field.is_exact {
            return None;
        }
        let left = self.zones() - usize::from(margin.watch == Watch::Duration);
        let last = left == 1 && matches!(margin.watch, Watch::Duration | Watch::Speed);
        (last && !self.is_forced()).then_some(OrbitStop::Centre)
    }

    fn exhausted(&self, node: &Node, _: (f64, f64)) -> Option<OrbitStop> {
        let tangent = &node.tangent;
        let along = tangent[tangent.len() - 1].abs();
        let growth: f64 = (0..self.zones())
            .map(|zone| tangent[self.duration_index(zone)])
            .sum();
        let unbounded =
            !self.is_forced() && along < STATIONARY && growth > GROWING && !self.opens(&node.point);
        unbounded.then_some(OrbitStop::Unbounded)
    }

    fn completes(_: &OrbitStop) -> bool {
        true
    }

    fn repeats(&self, node: &Node) -> Option<(Critical, OrbitStop)> {
        let times = self.traversals(&node.point);
        if times > 1 {
            return Some((Critical::PeriodDoubling, OrbitStop::Repeats { times }));
        }
        self.is_point(&node.point)
            .then_some((Critical::Branching, OrbitStop::Shrinks))
    }

    /// det(M − 1) vanishes at folds, as the parameter along the unit tangent does; their quotient does not.
    fn across_folds(&self, test: usize, value: f64, node: &Node) -> f64 {
        match test {
            1 => value / node.tangent[node.tangent.len() - 1],
            _ => value,
        }
    }

    fn crossing(&self, test: usize, node: &Node) -> Option<Critical> {
        match test {
            0 => Some(Critical::PeriodDoubling),
            1 => Some(Critical::Branching),
            _ => {
                let at = self.at(&node.point).ok()?;
                at.monodromy(&at.passages().ok()?)?
                    .angle_on_circle()
                    .map(|angle| Critical::Torus { angle })
            }
        }
    }

    fn kind(special: &Critical) -> EventType {
        match special {
            Critical::PeriodDoubling => EventType::PD,
            Critical::Branching => EventType::BP,
            Critical::Torus { .. } => EventType::NS,
        }
    }
}
