//! Periodic orbits of a hybrid system as the engine sees them, and how a branch of them is followed: it knows
//! no tube and no file.
//!
//! An orbit passes through zones in a known order, its *signature*. For one signature it solves a boundary-value
//! problem, its [`Equations`], and its inequalities hold while its *margins* are positive: durations, least values
//! of guards within a zone, conditions of switches. The margin that vanishes first ends the signature, and one
//! of the [`Candidate`]s goes on.
//!
//! - [`sign`] tells the sign of a function over a whole interval;
//! - [`event`] has the types of special points, [`special`] what makes a point special and why a branch ends;
//! - [`monitor`] locates values of numbers of an orbit that are asked for;
//! - [`events`] locates what happens within a step, `retrace` where the branch would retrace itself;
//! - [`change`] finds the signature beyond a change, [`entry`] takes the first step into it;
//! - [`cascade`] recognises changes that follow one another without end;
//! - [`follow`] puts them together into a curve for the walker of [`crate::continuation`];
//! - [`legs`] goes both ways from a first orbit, and numbers points, labels and events.

pub mod cascade;
pub mod change;
mod crossings;
mod dip;
pub mod entry;
pub mod event;
mod events;
pub mod follow;
pub mod legs;
pub mod located;
pub mod monitor;
mod retrace;
pub mod sign;
pub mod special;
mod stability;
pub mod switch;
mod together;
mod track;
mod transition;

use std::fmt::{Debug, Display};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::continuation::Node;
use crate::continuation::locate::Place;
use crate::continuation::newton::{self, Constraint, Equations, Plane};
use crate::continuation::walk::Segment;
use crate::linalg::{Matrix, Vector};
pub use event::{EventType, UnknownType};
pub use located::{Crossed, EndWithin, Limit};
use monitor::MonitorValue;
use sign::SignVerdict;
pub use stability::Stability;

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

/// The precedence of a margin that is the duration of a zone.
pub(crate) const WITHOUT_LENGTH: usize = 0;

/// The boundary-value problem of one signature in scaled unknowns, of which the last is the parameter.
pub trait Orbit: Equations<Failure: Data> + Clone + Debug + PartialEq {
    /// Sequence of zones.
    type Signature: Data + Display;
    /// Name of the parameter.
    type Parameter: Data;
    /// A smooth function of the unknowns that is positive while the signature holds.
    type Margin: Clone + Debug + PartialEq;
    /// What an examination of a point found.
    type Examination: Examined<Margin = Self::Margin>;
    /// What a margin measures, and where.
    type Held: Clone + Debug + PartialEq + Display;
    /// Why a point is not admissible.
    type Inadmissible: Data + std::error::Error;
    /// Points that are special for reasons of the system itself.
    type Special: Clone + Debug + PartialEq + Display;
    /// What remains to be said of the stability at a change of signature.
    type Remark: Clone + Debug + PartialEq + Display;
    /// Ends of a branch for reasons of the system itself.
    type Stop: Data + Display;

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

    /// A margin that was seen nearby, at a point.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    fn margin_at(&self, seen: &Self::Margin, point: &Vector)
    -> Result<Self::Margin, Self::Failure>;

    /// Value of a margin, scaled to order one.
    fn value(margin: &Self::Margin) -> f64;

    /// Adds the derivatives of a margin in the unknowns to those of the gradient.
    fn add_gradient(&self, margin: &Self::Margin, gradient: &mut [f64]);

    /// Whether two margins of one signature are the same function.
    fn is_same(one: &Self::Margin, other: &Self::Margin) -> bool;

    /// Which of several margins that vanish at one place says most about what comes next: the least first, and that is
    /// [`WITHOUT_LENGTH`] where a zone has no length.
    fn precedence(margin: &Self::Margin) -> usize;

    /// Whether a margin of this orbit and one of another signature measure the same.
    fn is_alike(&self, margin: &Self::Margin, other: &Self, of_other: &Self::Margin) -> bool;

    /// What a margin measures, and where.
    fn held(&self, margin: &Self::Margin) -> Self::Held;

    /// The worst of what an examination found.
    fn inadmissible(&self, examination: &Self::Examination) -> Self::Inadmissible;

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

    /// Whether the parameter is stationary at a point because a zone opens there.
    fn opens(&self, point: &Vector) -> bool;

    /// Whether the parameter is stationary near a point because a zone closes there.
    fn closes(&self, _point: &Vector) -> bool {
        false
    }

    /// Whether the parameter may be stationary where a margin vanishes, since a guard is met at zero speed there.
    fn grazes(_margin: &Self::Margin) -> bool {
        false
    }

    /// How many times longer than elsewhere steps from a point may be: more than 1 where unknowns are much larger
    /// than their units.
    fn stretch(&self, _point: &Vector) -> f64 {
        1.0
    }

    /// A node of orbits of a signature by every set of unknowns of this one, next to another node, that gives the same orbit
    /// with the same tangent.
    fn aliases(&self, signature: &Self::Signature, node: &Node, _near: &Node) -> Vec<Node> {
        let is_own = signature == self.signature();
        is_own.then(|| node.clone()).into_iter().collect()
    }

    /// Whether thin layers may turn the branch within a step: the first step into a signature is then tried
    /// from within the nascent zone, too.
    fn is_layered(&self) -> bool {
        false
    }

    /// The same orbits in unknowns that suit one of them better, where there are any; `creeps` where steps are short.
    fn renewed(
        &self,
        _point: &Vector,
        _examination: &Self::Examination,
        _creeps: bool,
    ) -> Option<Self> {
        None
    }

    /// A point and a direction there in the unknowns of [`Orbit::renewed`].
    fn carried(&self, _renewed: &Self, _node: &Node) -> Option<Node> {
        None
    }

    /// A tangent in those unknowns alone that all of them share.
    fn tangent_of_zones(&self, node: &Node) -> Vector {
        node.tangent.clone()
    }

    /// Error of the parameter at a point where the last equation, a border of `matrix`, is known to `last`.
    fn rounding(&self, matrix: &Matrix, point: &Vector, last: f64) -> Option<f64>;

    /// What integration of the flow leaves out of an equation at a point, beyond rounding.
    fn left_out(&self, _point: &Vector) -> f64 {
        0.0
    }

    /// Why the zero of a margin ends the branch whatever lies beyond.
    fn barred(&self, _margin: &Self::Margin) -> Option<Self::Stop> {
        None
    }

    /// The orbit beside an event, where the parameter is less (`side` −1) or more (1), to which motions lead there.
    fn beside(&self, _point: &Vector, _side: f64) -> Option<Candidate<Self>> {
        None
    }

    /// Why the branch ends where a margin vanishes and no candidate goes on, if the system says so.
    fn ends_at(&self, _point: &Vector, _margin: &Self::Margin) -> Option<Self::Stop> {
        None
    }

    /// When in the period a margin is looked at: margins that vanish together at several instants are changes of
    /// their own, which are all made at once.
    fn instant(&self, _point: &Vector, _margin: &Self::Margin) -> f64 {
        0.0
    }

    /// Why the branch ends at a node from which no step succeeds, if the system says so.
    fn gives_out(&self, _node: &Node) -> Option<Self::Stop> {
        None
    }

    /// Why the branch does not go on from a node within a range of the parameter.
    fn exhausted(&self, _node: &Node, _range: (f64, f64)) -> Option<Self::Stop> {
        None
    }

    /// How far, in scaled units, the parameter is from where the branch would end for such a reason.
    fn short_of(&self, _stop: &Self::Stop, _node: &Node) -> f64 {
        0.0
    }

    /// What it comes to, where that is an event.
    fn limit(&self, _stop: &Self::Stop, _node: &Node) -> Option<Limit<Self::Special>> {
        None
    }

    /// Whether an end leaves nothing undone: it is no failure.
    fn completes(stop: &Self::Stop) -> bool;

    /// What makes an edge of the range special for the system itself.
    fn edge(&self, _value: f64) -> Option<Self::Special> {
        None
    }

    /// What a fold is where the branch would retrace itself, and why it ends there: its orbit is one of a part of
    /// its period.
    fn repeats(&self, _node: &Node) -> Option<(Self::Special, Self::Stop)> {
        None
    }

    /// Whether [`Orbit::image`] may be told: where it may not, orbits on both sides are not asked for.
    fn has_images(&self) -> bool {
        false
    }

    /// What it is, and why the branch ends there, where it turns back and an orbit on one side is the image of one on the
    /// other, at the same value of the parameter, under a symmetry of the system.
    fn image(
        &self,
        _point: &Vector,
        _other: &Self,
        _of_other: &Vector,
    ) -> Option<(Self::Special, Self::Stop)> {
        None
    }

    /// What an orbit may be, and why the branch ends there, where it comes to a symmetry that one before it lacks.
    fn becomes_image(
        &self,
        _before: &Vector,
        _point: &Vector,
    ) -> Option<(Self::Special, Self::Stop)> {
        None
    }

    /// The symmetric orbit next to a point at which a branch without its symmetry ends, and the error of the parameter there, by
    /// equations that are not singular at it; `None` where there are none, or they have no such solution.
    fn symmetric_near(&self, _point: &Vector, _tolerance: f64) -> Option<(Vector, f64)> {
        None
    }

    /// Whether a step leads from one orbit to another beyond the place where the branch would turn back.
    fn falls_on_another(&self, _before: &Vector, _point: &Vector) -> bool {
        false
    }

    /// The same orbits with [`Examined::tests`].
    fn tested(&self) -> Option<Self> {
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

    /// Whether the parameter may turn within a step along which it nearly stands still: rounding, which decides about its slope
    /// there, makes no fold where what an orbit has at a fold is far off.
    fn may_turn(&self, _step: &Segment<Self::Examination>) -> bool {
        true
    }

    /// Whether the branch ends within a step, beyond which it would retrace itself, or nothing would tell its orbits apart.
    fn ends_within(&self, _step: &Segment<Self::Examination>) -> EndWithin<Self> {
        EndWithin::Not
    }

    /// A fold next to a node where equations that are regular at folds have it, and the error of the parameter there.
    /// `None` where there are none: the zero of the slope of the parameter is then the fold.
    fn fold_near(&self, _node: &Node) -> Option<(Vector, f64)> {
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

    /// The function of [`Examined::tests`] of this place at a node, without the zero that it has at every fold.
    fn across_folds(&self, _test: usize, value: f64, _node: &Node) -> f64 {
        value
    }

    /// The orbit of half the period that an orbit is when traversed twice, and its scaled unknowns: where the branch
    /// would retrace itself the first of its [`Examined::tests`] vanishes.
    fn part(&self, _point: &Vector) -> Option<(Self, Vector)> {
        None
    }

    /// That orbit traversed as often as this one: scaled unknowns of this one.
    fn whole(&self, _part: &Self, _point: &Vector) -> Option<Vector> {
        None
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

    /// A number of an orbit that is asked for, by its place among those, at a point; `None` where it has no value.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    fn measured(
        &self,
        _monitor: usize,
        _point: &Vector,
    ) -> Result<Option<MonitorValue>, Self::Failure> {
        Ok(None)
    }

    /// Its name.
    fn monitor_name(&self, _monitor: usize) -> &str {
        ""
    }

    /// Type of a point that is special for reasons of the system itself.
    fn kind(special: &Self::Special) -> EventType;

    /// Signature beyond such a point, where it changes.
    fn beyond(_special: &Self::Special) -> Option<Self::Signature> {
        None
    }

    /// Signature that is left where the branch ends for a reason of its own.
    fn left(_stop: &Self::Stop) -> Option<Self::Signature> {
        None
    }

    /// Derivative of a margin along a direction in the scaled unknowns.
    fn slope(&self, margin: &Self::Margin, direction: &Vector) -> f64 {
        let mut gradient = vec![0.0; direction.len()];
        self.add_gradient(margin, &mut gradient);
        gradient
            .iter()
            .zip(direction)
            .map(|(by, along)| by * along)
            .sum()
    }

    /// Σ |∂m/∂uᵢ|·dᵢ: how much a margin may change where every unknown changes by no more than dᵢ.
    fn reach(&self, margin: &Self::Margin, changes: &Vector) -> f64 {
        let mut gradient = vec![0.0; changes.len()];
        self.add_gradient(margin, &mut gradient);
        gradient
            .iter()
            .zip(changes)
            .map(|(by, change)| by.abs() * change)
            .sum()
    }
}

/// The margin of an examination that is the same function.
pub fn find<'a, O: Orbit>(
    examination: &'a O::Examination,
    margin: &O::Margin,
) -> Option<&'a O::Margin> {
    let mut margins = examination.margins().iter();
    margins.find(|known| O::is_same(known, margin))
}

/// The margins of an examination with those of another that are the same functions. Both mostly have them in the same order.
fn paired<'a, O: Orbit>(
    before: &'a O::Examination,
    after: &'a O::Examination,
) -> impl Iterator<Item = (&'a O::Margin, &'a O::Margin)>
where
    O::Margin: 'a,
{
    let after = after.margins();
    let mut next = 0;
    before.margins().iter().filter_map(move |margin| {
        let is_same = |known: &O::Margin| O::is_same(known, margin);
        let here = after.get(next).is_some_and(is_same).then_some(next);
        let place = here.or_else(|| after.iter().position(is_same))?;
        next = place + 1;
        Some((margin, &after[place]))
    })
}

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

/// m(u) = 0.
#[derive(Clone, Debug)]
pub struct AtZero<O: Orbit> {
    /// The margin where it was last seen.
    pub margin: O::Margin,
}

impl<O: Orbit> AtZero<O> {
    /// The margin at a point, from which the next search sets out.
    pub(crate) fn margin_at(
        &mut self,
        orbit: &O,
        point: &Vector,
    ) -> Result<&O::Margin, O::Failure> {
        self.margin = orbit.margin_at(&self.margin, point)?;
        Ok(&self.margin)
    }
}

impl<O: Orbit> Constraint<O> for AtZero<O> {
    fn evaluate(
        &mut self,
        orbit: &O,
        point: &Vector,
        gradient: &mut [f64],
    ) -> Result<f64, O::Failure> {
        let margin = self.margin_at(orbit, point)?;
        orbit.add_gradient(margin, gradient);
        Ok(O::value(margin))
    }
}
