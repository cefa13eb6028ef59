//! Periodic orbits of a hybrid system as the engine sees them, and how a branch of them is followed: it knows
//! no tube and no file.
//!
//! An orbit passes through zones in a known order, its *signature*. For one signature it solves a boundary-value
//! problem, its [`Equations`], and its inequalities hold while its *margins* are positive: durations, least values
//! of guards within a zone, conditions of switches. The margin that vanishes first ends the signature, and one
//! of the [`Candidate`]s goes on.
//!
//! What the engine asks of such orbits, an [`Orbit`], stands in parts: its equations in [`Zones`], its [`Inequalities`], what
//! meets at [`Changes`], its [`Bifurcations`] and [`Terminations`], what would make a branch retrace itself in [`Covers`], other
//! unknowns in [`CoordinateChanges`], numbers that a user requests in [`Monitored`]. The last five have answers for orbits that know
//! nothing of them.
//!
//! - [`sign`] tells the sign of a function over a whole interval;
//! - [`event`] has the types of special points, [`special`] what makes a point special and why a branch ends;
//! - [`monitor`] locates values of numbers of an orbit that are asked for;
//! - [`events`] locates what happens within a step, `retrace` where the branch would retrace itself;
//! - [`change`] finds the signature beyond a change, [`entry`] takes the first step into it;
//! - [`cascade`] recognises changes that follow one another without end;
//! - [`follow`] puts them together into a curve for the walker of [`crate::continuation`];
//! - [`legs`] goes both ways from a first orbit, and numbers points, labels and events.

mod bifurcation;
mod candidate;
pub mod cascade;
pub mod change;
mod coordinates;
mod crossings;
mod dip;
pub mod entry;
pub mod event;
mod events;
pub mod follow;
pub mod legs;
pub mod located;
pub mod margin;
pub mod monitor;
mod retrace;
pub mod sign;
pub mod special;
mod stability;
pub mod switch;
pub mod termination;
mod together;
mod track;
mod transition;

use std::fmt::{Debug, Display};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::continuation::Node;
use crate::continuation::locate::Place;
use crate::continuation::newton::{self, Constraint, Equations, Plane};
use crate::linalg::{Matrix, Vector};
pub use bifurcation::{Bifurcations, Crossed, SpecialType};
pub use candidate::{Candidate, Changes};
pub use coordinates::CoordinateChanges;
pub(crate) use dip::rounding_across;
pub use event::{EventType, UnknownType};
pub(crate) use margin::WITHOUT_LENGTH;
use margin::paired;
pub use margin::{AtZero, Inequalities, MarginFunction, find};
pub use monitor::Monitored;
pub use retrace::Covers;
use sign::SignVerdict;
pub use stability::Stability;
pub use termination::{EndWithin, Limit, Situation, TerminationType, Terminations};

/// Data that results keep: what is compared, shown and saved.
pub trait Data: Clone + Debug + PartialEq + Serialize + DeserializeOwned {}

impl<T: Clone + Debug + PartialEq + Serialize + DeserializeOwned> Data for T {}

/// What an examination of a point found.
pub trait Examined: Clone + Debug {
    /// A smooth function of the unknowns that is positive while the signature holds.
    type Margin;

    /// All margins, in the order of the zones.
    fn margins(&self) -> &[Self::Margin];

    /// Whether every inequality holds over the whole of every zone.
    fn verdict(&self) -> SignVerdict;

    /// Functions that change their sign where the stability changes, in a fixed order; none where stability is
    /// found otherwise.
    fn tests(&self) -> &[f64] {
        &[]
    }

    /// Whether more than rounding tells the sign of one of them.
    fn is_told(&self, _test: usize) -> bool {
        true
    }

    /// How all perturbations grow that may, the fastest first: `None` where that has no limit, or is found otherwise.
    fn growths(&self) -> Option<Vec<Growth>> {
        None
    }
}

/// Growth of a perturbation over a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Logarithm of the modulus of its multiplier.
    pub log: f64,
    /// Error of that.
    pub error: f64,
    /// Whether more than rounding tells its sign.
    pub told: bool,
}

/// The boundary-value problem of one signature in scaled unknowns, of which the last is the parameter.
pub trait Zones: Equations<Failure: Data> + Clone + Debug + PartialEq {
    /// Sequence of zones.
    type Signature: Data + Display;
    /// Name of the parameter.
    type Parameter: Data;

    /// A smooth function of the unknowns that is positive while the signature holds.
    type Margin: MarginFunction;
    /// What an examination of a point found.
    type Examination: Examined<Margin = Self::Margin>;

    /// Sequence of zones.
    fn signature(&self) -> &Self::Signature;

    /// The same system in another signature; `None` if that has no zones.
    fn posed(&self, signature: Self::Signature) -> Option<Self>;

    /// Whether a signature is this one but for the zone it begins with.
    fn is_rotation(&self, signature: &Self::Signature) -> bool;

    /// Name of the parameter.
    fn parameter(&self) -> Self::Parameter;

    /// Column of a parameter in tables.
    fn column(parameter: &Self::Parameter) -> &str;

    /// Index of the unknown that is the duration of a zone.
    fn duration_index(&self, zone: usize) -> usize;

    /// Unit of the parameter: its value at a scaled unknown of 1.
    fn unit(&self) -> f64;

    /// Value of the parameter at a point.
    fn value_at(&self, point: &Vector) -> f64 {
        point[point.len() - 1] * self.unit()
    }

    /// All margins at a point, and whether every inequality holds.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    fn examination(&self, point: &Vector) -> Result<Self::Examination, Self::Failure>;

    /// Error of the parameter at a point where the last equation, a border of `matrix`, is known to `last`.
    fn rounding(&self, matrix: &Matrix, point: &Vector, last: f64) -> Option<f64>;

    /// What integration of the flow leaves out of an equation at a point, beyond rounding.
    fn left_out(&self, _point: &Vector) -> f64 {
        0.0
    }

    /// How many times longer than elsewhere steps from a point may be: more than 1 where unknowns are much larger
    /// than their units.
    fn stretch(&self, _point: &Vector) -> f64 {
        1.0
    }
}

/// A boundary-value problem that a branch is followed with: the orbits of one signature, and all that the engine asks of them.
pub trait Orbit: Inequalities + CoordinateChanges + Changes + Covers + Monitored {}

impl<T: Inequalities + CoordinateChanges + Changes + Covers + Monitored> Orbit for T {}

/// Error of the parameter at a point that a constraint fixes: rounding, and the last correction.
fn uncertainty<O: Orbit>(orbit: &O, constraint: &mut impl Constraint<O>, place: &Place) -> f64 {
    let point = &place.node.point;
    let left_out = orbit.left_out(point);
    let noise = (left_out > 0.0).then(|| Vector::from_element(point.len(), left_out));
    newton::bordered(orbit, constraint, point)
        .ok()
        .and_then(|bordered| newton::rounding(&bordered.matrix, &point.abs(), noise.as_ref()))
        .map_or(f64::NAN, |rounding| {
            (rounding[rounding.len() - 1] + place.blur) * orbit.unit()
        })
}

/// Error of the parameter, in physical units, at a node of a branch: rounding.
pub fn rounding_at<O: Orbit>(orbit: &O, node: &Node) -> f64 {
    let mut plane = Plane {
        normal: &node.tangent,
        through: &node.point,
    };
    let place = Place {
        s: 0.0,
        node: node.clone(),
        blur: 0.0,
    };
    uncertainty(orbit, &mut plane, &place)
}
