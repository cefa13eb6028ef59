//! What is located within a step of a branch.

use super::monitor::MonitorStop;
use super::{Orbit, Zones};
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
