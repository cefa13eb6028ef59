//! Ends of a branch for reasons of the system itself.

use std::fmt::Display;

use super::Data;
use super::bifurcation::Bifurcations;
use crate::continuation::Node;
use crate::continuation::walk::Segment;
use crate::linalg::Vector;

/// Why a branch ends.
pub trait TerminationType<S>: Data + Display {
    /// Whether it leaves nothing undone: it is no failure.
    fn completes(&self) -> bool;

    /// Signature that is left there.
    fn left(&self) -> Option<S> {
        None
    }
}

/// A situation in which a branch may end.
#[derive(Clone, Copy, Debug)]
pub enum Situation<'a, M> {
    /// The branch comes to a node, within this range of the parameter.
    At(&'a Node, (f64, f64)),
    /// No step from a node succeeds.
    NoStep(&'a Node),
    /// A margin vanishes.
    Change(&'a M),
    /// A margin vanishes at a point and no candidate goes on.
    NoCandidate(&'a Vector, &'a M),
}

/// Whether a branch ends within a step: its orbits shrink to an equilibrium, or become those of a family at one value of the
/// parameter.
#[derive(Clone, Debug)]
pub enum EndWithin<O: Terminations> {
    /// It does not.
    Not,
    /// It does, and sets out so far from there that shorter steps are asked for.
    Far,
    /// It does.
    At {
        /// The arclength of the end from the beginning of the step.
        s: f64,
        /// The orbit there, or one of next to no size at the parameter of the equilibrium.
        node: Box<Node>,
        /// What it is.
        special: O::Special,
        /// Why the branch ends there.
        stop: O::Termination,
        /// The error of the parameter, in physical units.
        uncertainty: f64,
    },
}

/// What a branch comes to that it does not reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit<S> {
    /// What it is.
    pub special: S,
    /// The parameter there, or of the last orbit where that is not known, in physical units.
    pub parameter: f64,
    /// Its error.
    pub uncertainty: f64,
}

/// Ends of a branch for reasons of the system itself.
pub trait Terminations: Bifurcations {
    /// Ends of a branch for reasons of the system itself.
    type Termination: TerminationType<Self::Signature>;

    /// Why the branch ends in a situation, if the system ends it there.
    fn termination(&self, _situation: Situation<'_, Self::Margin>) -> Option<Self::Termination> {
        None
    }

    /// How far, in scaled units, the parameter is from where the branch would end for such a reason.
    fn short_of(&self, _stop: &Self::Termination, _node: &Node) -> f64 {
        0.0
    }

    /// What it comes to, where that is an event.
    fn limit(&self, _stop: &Self::Termination, _node: &Node) -> Option<Limit<Self::Special>> {
        None
    }

    /// Where an orbit that shrinks to a point has no size any more: its scaled unknowns, and the error of the parameter
    /// there. `None` where it does not shrink.
    fn shrunk(&self, _node: &Node) -> Option<(Vector, f64)> {
        None
    }

    /// The parameter at which an orbit that shrinks in proportion to it has no size any more, and its error. Beyond a node
    /// so near no inequality tells anything. `None` where it does not shrink so, or is not yet small.
    fn vanishes(&self, _node: &Node) -> Option<(f64, f64)> {
        None
    }

    /// Whether the branch ends within a step, beyond which it would retrace itself, or nothing would tell its orbits apart.
    fn ends_within(&self, _step: &Segment<Self::Examination>) -> EndWithin<Self> {
        EndWithin::Not
    }
}
