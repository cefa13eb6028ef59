//! The signatures that meet at a change of signature.

use std::fmt::{Debug, Display};

use super::{EventType, Zones};
use crate::linalg::Vector;

/// A signature to try from an event.
#[derive(Clone, Debug)]
pub struct Candidate<O> {
    /// Its boundary-value problem.
    pub orbit: O,
    /// The orbit of the event in its unknowns.
    pub point: Vector,
    /// Zones that have no length yet.
    pub nascent: Vec<usize>,
}

/// The signatures that meet at a change.
pub trait Changes: Zones {
    /// What remains to be said of the stability at a change of signature.
    type Remark: Clone + Debug + PartialEq + Display;

    /// Every candidate for the signature beyond the zero of a margin.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    fn candidates(
        &self,
        point: &Vector,
        margin: &Self::Margin,
    ) -> Result<Vec<Candidate<Self>>, Self::Failure>;

    /// Type of a change of signature where a margin vanishes.
    fn classify(
        before: &Self::Signature,
        after: Option<&Self::Signature>,
        margin: &Self::Margin,
    ) -> EventType;

    /// The orbit beside an event, where the parameter is less (`side` −1) or more (1), to which motions lead there.
    fn beside(&self, _point: &Vector, _side: f64) -> Option<Candidate<Self>> {
        None
    }

    /// Whether a margin is that of a kink of the equations: beyond it they have the same name, and what is told of it is whether the
    /// parameter turns back there, or the stability changes.
    fn is_kink(&self, _margin: &Self::Margin) -> bool {
        false
    }

    /// Whether the parameter is stationary at a point because a zone opens there.
    fn opens(&self, point: &Vector) -> bool;

    /// Whether the parameter is stationary near a point because a zone closes there.
    fn closes(&self, _point: &Vector) -> bool {
        false
    }

    /// Whether thin layers may turn the branch within a step: the first step into a signature is then tried
    /// from within the nascent zone, too.
    fn is_layered(&self) -> bool {
        false
    }
}
