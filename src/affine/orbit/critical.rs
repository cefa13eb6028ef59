//! Changes of stability of an orbit, and the ends at which it has no size or no period.

use std::fmt;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use std::sync::Arc;

use super::examine::Examination;
use super::layout::AffineOrbit;
use super::multiplier::{self, Multiplier};
use super::setting::Setting;
use super::signature::Sequence;
use crate::continuation::Node;
use crate::continuation::branch_point::branch_point;
use crate::continuation::locate::Place;
use crate::continuation::walk::Segment;
use crate::linalg::Vector;
use crate::orbit::{Bifurcations, Crossed, EventType, SpecialType, Zones};

/// A change of stability.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Critical {
    /// A multiplier passes −1.
    PeriodDoubling,
    /// The orbit has become one of a part of its period, traversed so many times: a multiplier of that passes −1.
    Repeats {
        /// Two or more.
        times: usize,
    },
    /// A multiplier passes 1 other than by a fold.
    Branching,
    /// The orbit has become its own image by a symmetry of the system, of which a multiplier passes 1.
    Symmetric,
    /// Orbits beyond it are a family at one value of the parameter.
    Family,
    /// The orbit has no size: an equilibrium with a pair of imaginary eigenvalues.
    Shrinking,
    /// The orbit has no size: a point on the boundaries of its modes.
    Vanishing,
    /// The orbit has no size, and its period no length.
    Instant,
    /// So many multipliers pass −1 together.
    Doublings {
        /// Two or more.
        count: usize,
    },
    /// So many pass 1 together.
    Branchings {
        /// Two or more.
        count: usize,
    },
    /// So many pass the unit circle together, not all of them at −1 or all at 1, nor as one pair.
    Several {
        /// Two or more.
        count: usize,
    },
    /// The number of those outside the unit circle changes, and where is not known.
    Unlocated {
        /// Number before and beyond.
        outside: [usize; 2],
        /// Between these values of the parameter.
        between: [f64; 2],
    },
    /// The orbit comes to one that leaves a saddle and returns to it, or to a cycle of connections between saddles.
    Homoclinic {
        /// Name of the mode of the saddle.
        mode: String,
        /// Name of the mode of the next saddle, where it leads to another one.
        next: Option<String>,
    },
    /// The orbit comes to one that leaves a saddle-node and returns to it: beyond it equilibria take its place.
    SaddleNode {
        /// Name of the mode of the saddle-node.
        mode: String,
    },
    /// The orbit comes to one that rests on the boundary of a mode: beyond it an equilibrium takes its place.
    RestOnBoundary {
        /// Name of the mode.
        mode: String,
    },
    /// A pair passes the unit circle at this angle.
    Torus {
        /// In radians, between 0 and π.
        angle: f64,
    },
}

impl Critical {
    /// What passes the unit circle where the number of multipliers outside is the first before it and the second beyond.
    pub(super) fn passing(all: &[Multiplier], [before, after]: [usize; 2]) -> Option<Critical> {
        /// One that is located on the circle is ±1 to this.
        const REAL: f64 = 1e-6;
        let own: Vec<Complex<f64>> = multiplier::own(all).map(|one| one.value).collect();
        let passing = own.get(before.min(after)..before.max(after))?;
        let count = passing.len();
        let near = |to: f64| passing.iter().all(|one| (one - to).norm() <= REAL);
        Some(match passing {
            [_] if near(-1.0) => Critical::PeriodDoubling,
            [_] if near(1.0) => Critical::Branching,
            _ if near(-1.0) => Critical::Doublings { count },
            _ if near(1.0) => Critical::Branchings { count },
            [one, other] if *one == other.conj() => Critical::Torus {
                angle: one.arg().abs(),
            },
            _ => Critical::Several { count },
        })
    }
}

impl SpecialType<Sequence> for Critical {
    fn kind(&self) -> EventType {
        match self {
            Critical::PeriodDoubling | Critical::Repeats { .. } | Critical::Doublings { .. } => {
                EventType::PD
            }
            Critical::Branching
            | Critical::Symmetric
            | Critical::Branchings { .. }
            | Critical::Family
            | Critical::Shrinking
            | Critical::Vanishing
            | Critical::Instant => EventType::BP,
            Critical::Unlocated { .. } => EventType::MX,
            Critical::Homoclinic { .. }
            | Critical::SaddleNode { .. }
            | Critical::RestOnBoundary { .. } => EventType::HC,
            Critical::Torus { .. } | Critical::Several { .. } => EventType::NS,
        }
    }
}

impl Bifurcations for AffineOrbit {
    type Special = Critical;

    fn tested(&self) -> Option<AffineOrbit> {
        let setting = Setting {
            stability: true,
            ..(*self.setting).clone()
        };
        AffineOrbit::new(Arc::new(setting), self.sequence.clone())
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

    fn passing(
        &self,
        node: &Node,
        outside: [usize; 2],
        between: Option<[f64; 2]>,
    ) -> Option<Critical> {
        if let Some(between) = between {
            return Some(Critical::Unlocated { outside, between });
        }
        Critical::passing(&self.multipliers(&node.point).ok()?, outside)
    }

    fn zero_of(
        &self,
        what: Crossed,
        from: &Node,
        ends: [f64; 2],
        tolerance: f64,
    ) -> Option<(Place, f64)> {
        let crossing = |count: usize| {
            let off = |point: &Vector| self.left_out(point);
            let (place, error) = branch_point(self, count, (from, ends), tolerance, off)?;
            Some((place, error * self.unit().abs()))
        };
        match what {
            Crossed::Zero(1) => {
                let lost = self.symmetry_lost(from, ends, tolerance);
                lost.or_else(|| crossing(1))
            }
            Crossed::Zero(_) => None,
            Crossed::Several(count) => crossing(count),
        }
    }

    fn turns(&self, step: &Segment<Examination>) -> Option<bool> {
        // where stability is not asked for they are found here
        let ends = [(step.before, step.from), (step.after, step.to)];
        let [before, after] =
            ends.map(
                |(examination, node)| match examination.multipliers.is_empty() {
                    true => self.multipliers(&node.point).unwrap_or_default(),
                    false => examination.multipliers.clone(),
                },
            );
        multiplier::turns([&before, &after])
    }
}

impl fmt::Display for Critical {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Critical::PeriodDoubling => write!(formatter, "a multiplier passes -1"),
            Critical::Repeats { times } => write!(
                formatter,
                "the orbit has become one of 1/{times} of its period, traversed {times} times, of which a multiplier passes -1: the \
                 branch ends"
            ),
            Critical::Branching => write!(formatter, "a multiplier passes 1"),
            Critical::Symmetric => write!(
                formatter,
                "a multiplier passes 1: the orbit has become its own image by a symmetry of the system, and beyond it the branch \
                 would be the image of what it was before: the branch ends"
            ),
            Critical::Doublings { count } => {
                write!(formatter, "{} multipliers pass -1", in_words(*count))
            }
            Critical::Branchings { count } => {
                write!(formatter, "{} multipliers pass 1", in_words(*count))
            }
            Critical::Several { count } => write!(
                formatter,
                "{} multipliers pass the unit circle together",
                in_words(*count)
            ),
            Critical::Homoclinic { mode, next: None } => write!(
                formatter,
                "the period grows without bound: the orbit comes to one that leaves the saddle of `{mode}` and returns to it, \
                 a homoclinic orbit"
            ),
            Critical::Homoclinic {
                mode,
                next: Some(next),
            } if mode == next => write!(
                formatter,
                "the period grows without bound: the orbit comes to a cycle of connections between saddles of `{mode}`, a \
                 heteroclinic cycle"
            ),
            Critical::Homoclinic {
                mode,
                next: Some(next),
            } => write!(
                formatter,
                "the period grows without bound: the orbit comes to a cycle of connections between saddles, from that of \
                 `{mode}` to that of `{next}` first, a heteroclinic cycle"
            ),
            Critical::SaddleNode { mode } => write!(
                formatter,
                "the period grows without bound: the orbit comes to one that leaves the saddle-node of `{mode}` and returns to it, \
                 beyond which equilibria take its place"
            ),
            Critical::RestOnBoundary { mode } => write!(
                formatter,
                "the period grows without bound: the orbit comes to one that rests on the boundary of `{mode}`, in an \
                 equilibrium beyond which it does not switch any more"
            ),
            Critical::Unlocated {
                outside: [before, after],
                between: [from, to],
            } => write!(
                formatter,
                "the number of multipliers outside the unit circle changes from {before} to {after} between {from} and {to}: \
                 where is not known"
            ),
            Critical::Family => write!(
                formatter,
                "multipliers are 1 from here on: orbits beyond are a family at this one value of the parameter: the branch ends"
            ),
            Critical::Shrinking => {
                write!(
                    formatter,
                    "the orbit shrinks to an equilibrium: its Hopf point"
                )
            }
            Critical::Instant => write!(
                formatter,
                "the orbit and its period shrink to nothing together: switches follow one another ever faster, and in \
                 the limit without end at one place, as in sliding"
            ),
            Critical::Vanishing => write!(
                formatter,
                "the orbit shrinks in proportion to the parameter, while its period does not, to a point where its modes \
                 meet: a boundary equilibrium bifurcation"
            ),
            Critical::Torus { angle } => {
                write!(
                    formatter,
                    "a pair of multipliers passes the unit circle at {angle} rad"
                )
            }
        }
    }
}

fn in_words(count: usize) -> String {
    const WORDS: [&str; 6] = ["one", "two", "three", "four", "five", "six"];
    let word = count.checked_sub(1).and_then(|index| WORDS.get(index));
    word.map_or_else(|| count.to_string(), |word| (*word).to_owned())
}
