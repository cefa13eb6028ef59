//! Following a branch of waves through all its regimes: a wave as a curve for the walker.
//!
//! Every inequality is watched, every event within a step is met in order, and at a change
//! of regime the successor signature goes on.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cascade::Cascade;
use super::crossings::{OutsideCount, outside};
use super::monitor::MonitorStop;
use super::special::{Close, NoFollower, Special};
use super::switch::is_in_family;
use super::{EventType, Orbit};
use crate::continuation::arclength::NODES_BEFORE;
use crate::continuation::locate::retangent;
use crate::continuation::walk::Walker;
use crate::continuation::{Node, Steps};
use crate::linalg::Vector;

/// How far to follow a branch, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Range of the continuation parameter.
    pub range: (f64, f64),
    /// User points.
    pub stop_at: Vec<f64>,
    /// Step lengths and tolerance.
    pub steps: Steps,
}

impl Limits {
    /// A range without user points, with the steps that are taken where none are given.
    pub fn within(range: (f64, f64)) -> Limits {
        Limits {
            range,
            stop_at: Vec::new(),
            steps: Steps::default(),
        }
    }

    /// With every user point once, in order: a step then looks at those within it only.
    fn ordered(mut self) -> Limits {
        self.stop_at.sort_by(f64::total_cmp);
        self.stop_at.dedup();
        self
    }
}

/// A point found, in order along the branch.
#[derive(Clone, Debug)]
pub struct LocatedPoint<O: Orbit> {
    /// Boundary-value problem before the point.
    pub orbit: Arc<O>,
    /// Arclength from the beginning of the step.
    pub s: f64,
    /// Boundary-value problem beyond a change of regime, and the point in its unknowns.
    pub entered: Option<(Arc<O>, Node)>,
    /// Value of the continuation parameter: exactly the one asked for at user points and edges.
    pub parameter: f64,
    /// The point.
    pub node: Node,
    /// Its margins, extrema and verdict.
    pub examination: O::Examination,
    /// What makes it special, if anything does.
    pub special: Option<Special<O>>,
    /// Estimated error of the parameter of a special point.
    pub uncertainty: f64,
    /// What comes so close to zero, here or on the way from the point before, that rounding decides.
    pub close: Option<Close<O::Inequality>>,
}

impl<O: Orbit> LocatedPoint<O> {
    /// A point without an event.
    pub(crate) fn new(
        orbit: &Arc<O>,
        s: f64,
        node: &Node,
        examination: &O::Examination,
    ) -> LocatedPoint<O> {
        LocatedPoint {
            orbit: orbit.clone(),
            s,
            entered: None,
            parameter: orbit.value_at(&node.point),
            node: node.clone(),
            examination: examination.clone(),
            special: None,
            uncertainty: 0.0,
            close: None,
        }
    }

    /// The error that is told: the parameter is known no better than to half a unit in its last place.
    pub fn known_to(&self) -> f64 {
        let size = self.parameter.abs();
        let half_unit = 0.5 * (size.next_up() - size);
        if self.uncertainty < half_unit {
            half_unit
        } else {
            self.uncertainty
        }
    }

    /// Its type, if it is special.
    pub fn kind(&self) -> Option<EventType> {
        self.special.as_ref().map(Special::kind)
    }
}

/// The state of a branch between two steps: all that its continuation depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BranchState<S> {
    /// Signature.
    pub signature: S,
    /// Scaled unknowns.
    pub point: Vec<f64>,
    /// Unit tangent.
    pub tangent: Vec<f64>,
    /// Scaled unknowns and tangents of the points before it on the same curve, the last first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub before: Vec<(Vec<f64>, Vec<f64>)>,
    /// Length of the next step.
    pub ds: f64,
    /// Direction of the parameter along the branch: +1 or −1.
    pub heading: f64,
    /// Scaled unknowns of the first point, its signature and tangent: a closed branch comes back.
    pub origin: (S, Vec<f64>, Vec<f64>),
    /// Arclength since the first point.
    pub travelled: f64,
    /// Steps in a row that creep.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub creeping: usize,
    /// Changes of signature in a row that are alike.
    #[serde(default, skip_serializing_if = "Cascade::is_empty")]
    pub cascade: Cascade,
    /// Where the number of multipliers outside the unit circle was last told, if it is not at the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub told: Option<OutsideCount>,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Orbits of one signature as a curve in the continuation parameter.
#[derive(Clone, Debug)]
pub struct Track<O> {
    /// Their boundary-value problem.
    pub orbit: Arc<O>,
    pub(super) limits: Arc<Limits>,
    /// Values of monitors at which a user point is wanted, too.
    pub(super) monitors: Arc<[MonitorStop]>,
    /// Direction of the parameter: +1 or −1.
    pub(super) heading: f64,
    /// Changes of signature in a row that are alike.
    pub(super) cascade: Cascade,
    /// Where the number of multipliers outside the unit circle was last told.
    pub(super) told: Option<OutsideCount>,
}

/// A branch being followed.
pub type Follower<O> = Walker<Track<O>>;

impl<O: Orbit> Walker<Track<O>> {
    /// Starts at a solved point; `up` is the direction of the parameter.
    ///
    /// # Errors
    /// When the point is a fold, or its inequalities cannot be evaluated.
    pub fn new(
        orbit: O,
        point: &Vector,
        up: bool,
        limits: Limits,
    ) -> Result<Follower<O>, NoFollower<O>> {
        if is_in_family(&orbit, point) {
            return Err(NoFollower::Family);
        }
        let last = orbit.unknowns() - 1;
        let heading = if up { 1.0 } else { -1.0 };
        let mut along = Vector::zeros(last + 1);
        along[last] = heading;
        let node = retangent(&orbit, point, &along, 0).ok_or(NoFollower::Fold)?;
        let steps = limits.steps;
        let branch = Track {
            orbit: Arc::new(orbit),
            limits: Arc::new(limits.ordered()),
            monitors: Arc::default(),
            heading,
            cascade: Cascade::default(),
            told: None,
        };
        Ok(Walker::begin(branch, node, steps)?)
    }

    /// Goes on from a saved state. `orbit` gives everything but the signature.
    ///
    /// # Errors
    /// When the state does not fit, or its inequalities cannot be evaluated.
    pub fn resume(
        orbit: &O,
        state: BranchState<O::Signature>,
        limits: Limits,
    ) -> Result<Follower<O>, NoFollower<O>> {
        let of = |signature: &O::Signature, point: Vec<f64>, tangent: Vec<f64>| {
            let posed = orbit.posed(signature.clone()).ok_or(NoFollower::Saved)?;
            let fits = [&point, &tangent].iter().all(|list| {
                list.len() == posed.unknowns() && list.iter().all(|number| number.is_finite())
            });
            let node = Node::at(Vector::from_vec(point), Vector::from_vec(tangent));
            fits.then_some((posed, node)).ok_or(NoFollower::Saved)
        };
        let (posed, node) = of(&state.signature, state.point, state.tangent)?;
        let before = state.before.into_iter();
        let before = before.map(|(point, tangent)| of(&state.signature, point, tangent));
        let before = before.map(|known| known.map(|(_, node)| node));
        let before = before.take(NODES_BEFORE).collect::<Result<_, _>>()?;
        let (signature, point, tangent) = state.origin;
        let (_, first) = of(&signature, point, tangent)?;
        let numbers = [state.ds, state.heading, state.travelled];
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(NoFollower::Saved);
        }
        let steps = limits.steps;
        let branch = Track {
            orbit: Arc::new(posed),
            limits: Arc::new(limits.ordered()),
            monitors: Arc::default(),
            heading: state.heading,
            cascade: state.cascade,
            told: state.told,
        };
        Ok(Walker {
            ds: state.ds,
            before,
            origin: (signature, first),
            travelled: state.travelled,
            creeping: state.creeping,
            ..Walker::begin(branch, node, steps)?
        })
    }

    /// The same with user points at these values of monitors, too.
    pub fn stopping_at(mut self, monitors: &[MonitorStop]) -> Follower<O> {
        self.curve.monitors = monitors.into();
        self
    }

    /// The state to resume from.
    pub fn state(&self) -> BranchState<O::Signature> {
        let list = |vector: &Vector| vector.iter().copied().collect::<Vec<f64>>();
        let (signature, first) = &self.origin;
        BranchState {
            signature: self.curve.orbit.signature().clone(),
            point: list(&self.node.point),
            tangent: list(&self.node.tangent),
            before: (self.before.iter())
                .map(|node| (list(&node.point), list(&node.tangent)))
                .collect(),
            ds: self.ds.max(self.steps.ds_min),
            heading: self.curve.heading,
            origin: (signature.clone(), list(&first.point), list(&first.tangent)),
            travelled: self.travelled,
            creeping: self.creeping,
            cascade: self.curve.cascade.clone(),
            told: (self.curve.told).filter(|_| outside(&self.watched).is_none()),
        }
    }
}
