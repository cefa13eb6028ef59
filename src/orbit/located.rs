//! What is located within a step of a branch.

use super::monitor::MonitorStop;
use super::{Orbit, Terminations, Zones};
use crate::continuation::Node;
use crate::continuation::walk::Segment;

/// A step along a branch, with what is watched at its ends.
pub(super) type Step<'a, O> = Segment<'a, <O as Zones>::Examination>;

/// What is located within a step.
#[derive(Clone, Debug, PartialEq)]
pub enum BranchEvent<O: Orbit> {
    /// A fold in the parameter.
    Fold,
    /// A fold beyond which the branch retraces itself: what it is, and why the branch ends there.
    Image(O::Special, O::Termination),
    /// The branch ends: at what, and why.
    End(O::Special, O::Termination),
    /// A value that was asked for.
    User(f64),
    /// A monitor has a value that was asked for.
    Monitor(MonitorStop),
    /// An edge of the range.
    Edge(f64),
    /// A margin vanishes.
    Change(O::Margin),
    /// The function of this place in [`Examined::tests`] changes its sign.
    Crossing(usize),
    /// The number of multipliers outside the unit circle changes.
    Passing {
        /// Before and beyond.
        outside: [usize; 2],
        /// Values of the parameter between which it does, where it is not located.
        between: Option<[f64; 2]>,
    },
}

impl<O: Orbit> BranchEvent<O> {
    /// Whether it may be the place from which the branch would retrace itself.
    pub(super) fn may_retrace(&self) -> bool {
        matches!(
            self,
            BranchEvent::Fold
                | BranchEvent::Image(..)
                | BranchEvent::Crossing(_)
                | BranchEvent::Passing { .. }
        )
    }
}

/// What passes the unit circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossed {
    /// What makes the function of this place in [`Examined::tests`](super::Examined::tests) vanish.
    Zero(usize),
    /// So many multipliers together.
    Several(usize),
}

/// An event and the error of the parameter there, in physical units.
#[derive(Clone, Debug)]
pub struct LocatedEvent<O: Orbit> {
    /// The event.
    pub event: BranchEvent<O>,
    /// The error.
    pub uncertainty: f64,
}

impl<O: Orbit> LocatedEvent<O> {
    /// Whether stability is the same before and beyond it.
    pub(super) fn keeps_stability(&self) -> bool {
        matches!(
            self.event,
            BranchEvent::User(_) | BranchEvent::Monitor(_) | BranchEvent::Edge(_)
        )
    }
}

/// A fold and a crossing of branches closer together than this part of a step, at one parameter to rounding, are one: the
/// fold of a pitchfork is known to the square root of rounding.
pub(super) const TURN: f64 = 1e-3;

/// A scaled margin below this is zero but for rounding.
pub(crate) const AT_ZERO: f64 = 1e-9;

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
