//! What a curve provides to be followed, and what comes of its steps.

use std::error::Error;

use serde::{Deserialize, Serialize};

use crate::continuation::arclength::{self, Node, Steps};
use crate::continuation::locate::Place;
use crate::continuation::newton::Equations;

/// A zero curve of a system, what is watched along it, and what happens where that vanishes.
pub trait WatchedCurve: Sized {
    /// Its equations.
    type System: Equations;
    /// Tells curves apart that have different equations.
    type Name: Clone + PartialEq;
    /// Values of the watched functions at a node.
    type Watched: Clone;
    /// What is located within a step.
    type Event: Clone;
    /// What is handed out.
    type Found;
    /// Why the curve refuses a step.
    type Refusal: Error;
    /// Why the curve ends for reasons of its own.
    type End;
    /// What comes so close to zero that rounding decides whether it vanishes.
    type Close;
    /// Creeping steps after which the curve ends, and the length below which a step creeps, in units of the
    /// first one. Steps that short come from rejections: they grow by half from one to the next.
    const CREEP: (usize, f64);

    /// Its equations.
    fn system(&self) -> &Self::System;

    /// Its name.
    fn name(&self) -> &Self::Name;

    /// The watched functions at a node; `near` are those of a node nearby.
    fn watch(
        &self,
        node: &Node,
        near: Option<&Self::Watched>,
    ) -> Result<Self::Watched, Self::Refusal>;

    /// Whether a watched function seems to vanish twice within the step, by its values and slopes at both
    /// ends.
    fn may_hide_a_pair(&self, _step: &Segment<Self::Watched>) -> bool {
        false
    }

    /// Whether a watched function that is positive at both ends of the step vanishes in between, and
    /// before the curve ends at one of the events located there.
    fn within(
        &self,
        step: &Segment<Self::Watched>,
        located: &[(Place, Self::Event)],
    ) -> Within<Self::Close>;

    /// A point before which something comes so close to zero that rounding decides.
    fn doubted(&self, found: Self::Found, close: Self::Close) -> Self::Found;

    /// All that happens within a step, in any order.
    fn locate(
        &self,
        step: &Segment<Self::Watched>,
    ) -> Result<Vec<(Place, Self::Event)>, Self::Refusal>;

    /// What comes of an event; `together` are the events at its place, itself the first.
    fn meet(
        &self,
        step: &Segment<Self::Watched>,
        place: &Place,
        together: &[Self::Event],
    ) -> Result<Outcome<Self>, Self::Refusal>;

    /// Takes note of a node that was reached, with what is watched there and what was passed on the way, and may take
    /// other unknowns of the same point.
    fn arrive(&mut self, node: &mut Node, watched: &Self::Watched, passed: &[(Place, Self::Event)]);

    /// A point without an event.
    fn point(&self, s: f64, node: &Node, watched: &Self::Watched) -> Self::Found;

    /// The point of a step that closes the curve: its first point is at arclength `s` of it, and it
    /// comes to `reached`.
    fn closing(&self, s: f64, first: &Node, reached: Self::Found) -> Self::Found;
}

/// A curve that the walker follows: what it knows of its own steps, unknowns and ends.
pub trait Curve: WatchedCurve {
    /// How many times longer than elsewhere the longest step from a node may be: more than 1 where unknowns are
    /// much larger than their units.
    fn stretch(&self, _node: &Node) -> f64 {
        1.0
    }

    /// The same curve in other unknowns, where these suit a node better, the node in these, and what is watched there; `creeps` where
    /// steps from there are short.
    fn renewed(
        &self,
        _node: &Node,
        _watched: &Self::Watched,
        _creeps: bool,
    ) -> Option<(Self, Node, Self::Watched)> {
        None
    }

    /// The node on an edge of the range that a step of this length would pass, and how far along the step it is.
    fn at_edge(&self, _node: &Node, _ds: f64, _tolerance: f64) -> Option<(Node, f64)> {
        None
    }

    /// The first node of the walk, which is one of the curve of this name, by every set of unknowns of this curve next to
    /// a node that gives the same point: an angle has many, and a cycle may begin at several places. None where no unknowns
    /// of this curve give that point.
    fn aliases(&self, name: &Self::Name, first: &Node, _near: &Node) -> Vec<Node> {
        let is_own = name == self.name();
        is_own.then(|| first.clone()).into_iter().collect()
    }

    /// Why the curve does not go on from a node that was reached.
    fn exhausted(&self, _node: &Node) -> Option<Self::End> {
        None
    }

    /// Whether a step refused at its shortest ends the curve itself, and not only the search for it.
    fn ends_with(&self, _refusal: &Self::Refusal) -> Option<Self::End> {
        None
    }

    /// An event at a node from which no step succeeds, where it is known otherwise than by steps.
    fn leads_on(&self, _node: &Node, _watched: &Self::Watched) -> Option<Outcome<Self>> {
        None
    }

    /// Whether a curve that finds no step from a node ends there for a reason of its own.
    fn ends_at(&self, _node: &Node) -> Option<Self::End> {
        None
    }

    /// The point that tells of an end other than an event.
    fn last(&self, _end: &EndOf<Self>, _here: Self::Found) -> Option<Self::Found> {
        None
    }
}

/// What happens between the ends of a step to functions that are positive at both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Within<K> {
    /// None of them vanishes.
    Nothing,
    /// One of them is least, and negative, this far along the step: it vanishes before and after.
    Pair(f64),
    /// One of them is zero but for rounding, this far along the step.
    Close(f64, K),
}

/// Why a step was refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Refused<F: Error, R: Error> {
    /// There is no such step.
    #[error("{0}")]
    Step(#[from] arclength::Refusal<F>),
    /// A watched function vanishes twice within it.
    #[error("two events lie closer together than a step")]
    Pair,
    /// The curve refuses it.
    #[error("{0}")]
    Curve(R),
}

/// Why a step of a curve was refused.
pub(crate) type RefusalOf<C> =
    Refused<<<C as WatchedCurve>::System as Equations>::Failure, <C as WatchedCurve>::Refusal>;

/// How a curve ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum End<R, E> {
    /// At an edge of a range.
    Edge,
    /// On its first point.
    Closed,
    /// After as many points as it may have.
    MaxPoints {
        /// How many.
        most: usize,
    },
    /// With steps in a row so short that they do not lead on.
    Creeps {
        /// How many.
        steps: usize,
        /// All are shorter than this.
        longest: f64,
    },
    /// Where no step succeeds.
    NoStep {
        /// The shortest one.
        ds_min: f64,
        /// Why it was refused.
        reason: R,
    },
    /// For a reason of its own.
    Own(E),
}

/// How a curve of a kind ended.
pub(crate) type EndOf<C> = End<RefusalOf<C>, <C as WatchedCurve>::End>;

/// What comes of an event.
pub enum Outcome<C: WatchedCurve> {
    /// The curve passes it.
    Passed(C::Found),
    /// Another curve goes on, also where two events at one place lead there.
    Entered(Vec<C::Found>, CurveBeginning<C>),
    /// The curve ends there.
    Ended(Vec<C::Found>, EndOf<C>),
}

/// The beginning of another curve.
pub struct CurveBeginning<C: WatchedCurve> {
    /// The curve.
    pub curve: C,
    /// Its first node.
    pub node: Node,
    /// The watched functions there.
    pub watched: C::Watched,
    /// Length of its first step.
    pub ds: f64,
}

/// A step along a curve, from one node to the next, with the values `W` of the watched functions at both.
pub struct Segment<'a, W> {
    /// Where it sets out.
    pub from: &'a Node,
    /// The watched functions there.
    pub before: &'a W,
    /// Where it comes to.
    pub to: &'a Node,
    /// The watched functions there.
    pub after: &'a W,
    /// Its length.
    pub ds: f64,
    /// Step lengths and tolerance of the walk.
    pub steps: &'a Steps,
}

impl<W> Segment<'_, W> {
    /// Zeros closer together than this are one event that several watched functions see.
    pub(crate) fn at_once(&self) -> f64 {
        /// As a part of the step.
        const AT_ONCE: f64 = 1e-6;
        AT_ONCE * self.ds.max(1e-3)
    }
}
