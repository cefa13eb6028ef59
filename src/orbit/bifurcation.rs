//! Bifurcations of orbits whose signature holds.

use std::fmt::{Debug, Display};

use super::{EventType, Zones};
use crate::continuation::Node;
use crate::continuation::locate::Place;
use crate::continuation::walk::Segment;
use crate::linalg::Vector;

/// What makes a point special for a reason of the system itself.
pub trait SpecialType<S>: Clone + Debug + PartialEq + Display {
    /// Type of the point.
    fn kind(&self) -> EventType;

    /// Signature beyond it, if it changes there.
    fn beyond(&self) -> Option<S> {
        None
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

/// Points of a branch at which its orbits bifurcate although the signature holds.
pub trait Bifurcations: Zones {
    /// Points that are special for reasons of the system itself.
    type Special: SpecialType<Self::Signature>;

    /// The same orbits with [`Examined::tests`].
    fn tested(&self) -> Option<Self> {
        None
    }

    /// The function of [`Examined::tests`] of this place at a node, without the zero that it has at every fold.
    fn across_folds(&self, _test: usize, value: f64, _node: &Node) -> f64 {
        value
    }

    /// How many multipliers pass where a function of [`Examined::tests`] vanishes.
    fn passed_by(test: usize) -> u64 {
        if test < 2 { 1 } else { 2 }
    }

    /// Whether the parameter may be stationary at the zero of a function of [`Examined::tests`], as where a branch ends on
    /// the middle of another one: what is seen as a fold is then that.
    fn turns_at(_test: usize) -> bool {
        false
    }

    /// What the zero of a function of [`Examined::tests`] is at a node: none where it is no event.
    fn crossing(&self, _test: usize, _node: &Node) -> Option<Self::Special> {
        None
    }

    /// What passes the unit circle at a node, where the number of multipliers outside is the first before it and the second
    /// beyond; `between` are values of the parameter between which that happens, where it is not located.
    fn passing(
        &self,
        _node: &Node,
        _outside: [usize; 2],
        _between: Option<[f64; 2]>,
    ) -> Option<Self::Special> {
        None
    }

    /// Where something passes the unit circle between two arclengths of the step that sets out from a node, and the error of the
    /// parameter there, by equations that are regular where those of the orbit are singular. `None` where there are none.
    fn zero_of(
        &self,
        _what: Crossed,
        _from: &Node,
        _ends: [f64; 2],
        _tolerance: f64,
    ) -> Option<(Place, f64)> {
        None
    }

    /// A fold next to a node where equations that are regular at folds have it, and the error of the parameter there.
    /// `None` where there are none: the zero of the slope of the parameter is then the fold.
    fn fold_near(&self, _node: &Node) -> Option<(Vector, f64)> {
        None
    }

    /// Whether the parameter turns within a step along which it nearly stands still, by what an orbit has at a fold, where that tells:
    /// rounding decides about its slope there.
    fn turns(&self, _step: &Segment<Self::Examination>) -> Option<bool> {
        None
    }

    /// What makes an edge of the range special for the system itself.
    fn edge(&self, _value: f64) -> Option<Self::Special> {
        None
    }
}
