//! Following a branch of waves through all its regimes: a wave as a curve for the walker.
//!
//! Every inequality is watched, every event within a step is met in order, and at a change
//! of regime the successor signature goes on.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cascade::Cascade;
use super::change::{self, Beyond, Both};
use super::crossings::{OutsideCount, outside};
use super::events;
use super::located::{BranchEvent, LocatedEvent};
use super::monitor::MonitorStop;
use super::special::{
    BranchFailure, BranchStop, Change, Close, Ending, NoFollower, OrbitRefusal, Special,
};
use super::switch::is_in_family;
use super::{EventType, Examined, Orbit, find, retrace};
use crate::continuation::arclength::NODES_BEFORE;
use crate::continuation::locate::{Place, node_at, retangent};
use crate::continuation::walk::{self, Beginning, Curve, Outcome, Segment, Walker, Within};
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
    pub close: Option<Close<O::Held>>,
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
    limits: Arc<Limits>,
    /// Values of monitors at which a user point is wanted, too.
    monitors: Arc<[MonitorStop]>,
    /// Direction of the parameter: +1 or −1.
    heading: f64,
    /// Changes of signature in a row that are alike.
    cascade: Cascade,
    /// Where the number of multipliers outside the unit circle was last told.
    told: Option<OutsideCount>,
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

/// The first step tried into a new wave is at least this part of the first step of all, however close two
/// events lie: what opens like the square of a duration is lost in rounding where that is 1e-8.
const INTO: f64 = 1e-2;

impl<O: Orbit> Curve for Track<O> {
    type System = O;
    type Name = O::Signature;
    type Watched = O::Examination;
    type Event = LocatedEvent<O>;
    type Found = LocatedPoint<O>;
    type Refusal = OrbitRefusal<O>;
    type End = BranchStop<O>;
    type Close = Close<O::Held>;

    const CREEP: (usize, f64) = (40, 1e-5);

    fn system(&self) -> &O {
        &self.orbit
    }

    fn name(&self) -> &O::Signature {
        self.orbit.signature()
    }

    fn watch(
        &self,
        node: &Node,
        _: Option<&O::Examination>,
    ) -> Result<O::Examination, OrbitRefusal<O>> {
        self.orbit
            .examination(&node.point)
            .map_err(OrbitRefusal::Flow)
    }

    fn may_hide_a_pair(&self, step: &Segment<O::Examination>) -> bool {
        events::may_hide_a_pair(self.orbit.as_ref(), step)
    }

    fn within(
        &self,
        step: &Segment<O::Examination>,
        located: &[(Place, LocatedEvent<O>)],
    ) -> Within<Close<O::Held>> {
        events::within(self.orbit.as_ref(), step, located)
    }

    fn doubted(&self, found: LocatedPoint<O>, close: Close<O::Held>) -> LocatedPoint<O> {
        LocatedPoint {
            close: Some(close),
            ..found
        }
    }

    fn locate(
        &self,
        step: &Segment<O::Examination>,
    ) -> Result<Vec<(Place, LocatedEvent<O>)>, OrbitRefusal<O>> {
        events::located(
            self.orbit.as_ref(),
            self.limits.range,
            (&self.limits.stop_at, &self.monitors),
            self.told,
            step,
        )
    }

    fn meet(
        &self,
        step: &Segment<O::Examination>,
        place: &Place,
        together: &[LocatedEvent<O>],
    ) -> Result<Outcome<Track<O>>, OrbitRefusal<O>> {
        let LocatedEvent { event, uncertainty } = &together[0];
        let orbit = self.orbit.as_ref();
        if let BranchEvent::Shrinks(special, stop) = event {
            let examination = orbit.examination(&place.node.point);
            let found = LocatedPoint {
                uncertainty: *uncertainty,
                special: Some(Special::Own(special.clone())),
                ..self.point(
                    place.s,
                    &place.node,
                    &examination.map_err(OrbitRefusal::Flow)?,
                )
            };
            let end = walk::End::Own(BranchStop::Own(stop.clone()));
            return Ok(Outcome::Ended(vec![found], end));
        }
        if let Some(ended) = self.vanished(step, place) {
            return Ok(ended);
        }
        let mut examination = orbit.examination(&place.node.point);
        let sharper = match (&examination, event) {
            (Ok(examination), BranchEvent::Change(_)) => self.at_once(step, place, examination),
            _ => None,
        };
        if let Some((place, _)) = &sharper {
            examination = orbit.examination(&place.node.point);
        }
        let examination = examination.map_err(OrbitRefusal::Flow)?;
        let (place, uncertainty) = sharper
            .as_ref()
            .map_or((place, uncertainty), |(place, uncertainty)| {
                (place, uncertainty)
            });
        // nothing may have failed before: another event would have come first
        if !events::holds(orbit, place, &examination) {
            return Err(OrbitRefusal::Order);
        }
        let mut found = LocatedPoint {
            uncertainty: *uncertainty,
            ..self.point(place.s, &place.node, &examination)
        };
        // an inequality that fails by no more than rounding
        let mut fails = examination.margins().iter();
        let fails = fails.find(|margin| O::value(margin) <= 0.0);
        if !matches!(event, BranchEvent::Change(_)) {
            found.close = fails.map(|margin| Close::Margin(orbit.held(margin)));
        }
        match event {
            BranchEvent::Shrinks(..) => {}
            BranchEvent::Fold => {
                if let Some(ended) = self.repeated(&found) {
                    return Ok(ended);
                }
                found.special = Some(Special::Fold(orbit.parameter()));
                found = self.moved(found, orbit.fold_near(&place.node));
            }
            BranchEvent::Image(special, stop) => {
                // the halves of an orbit traversed twice are images, too
                if let Some(ended) = self.repeated(&found) {
                    return Ok(ended);
                }
                let side = step.from.tangent[step.from.tangent.len() - 1];
                let tolerance = step.steps.tolerance;
                let sharper = retrace::symmetric(orbit, &place.node, -side, special, tolerance);
                if !found.uncertainty.is_finite() {
                    found.uncertainty = REPEATS * found.parameter.abs().max(orbit.unit());
                }
                found.special = Some(Special::Own(special.clone()));
                let end = walk::End::Own(BranchStop::Own(stop.clone()));
                return Ok(Outcome::Ended(vec![self.moved(found, sharper)], end));
            }
            BranchEvent::User(value) => {
                found.parameter = *value;
                found.special = Some(Special::User(orbit.parameter(), *value));
            }
            BranchEvent::Monitor(MonitorStop { monitor, value }) => {
                let name = orbit.monitor_name(*monitor).to_owned();
                found.special = Some(Special::Monitor(name, *value));
            }
            BranchEvent::Edge(value) => {
                found.parameter = *value;
                found.special = Some(match orbit.edge(*value) {
                    Some(special) => Special::Own(special),
                    None => Special::Edge(orbit.parameter(), *value),
                });
                return Ok(Outcome::Ended(vec![found], walk::End::Edge));
            }
            BranchEvent::Crossing(test) => {
                if let Some(ended) = self.repeated(&found) {
                    return Ok(ended);
                }
                found.special = orbit.crossing(*test, &place.node).map(Special::Own);
            }
            BranchEvent::Passing { outside, between } => {
                if let Some(ended) = self.repeated(&found) {
                    return Ok(ended);
                }
                let special = orbit.passing(&place.node, *outside, *between);
                found.special = special.map(Special::Own);
            }
            BranchEvent::Change(margin) => {
                if let Some(stop) = orbit.barred(margin) {
                    let end = walk::End::Own(BranchStop::Own(stop));
                    found.special = Some(failed(&end));
                    return Ok(Outcome::Ended(vec![found], end));
                }
                // several margins may vanish at one event: the table is asked for each. At the stiff
                // end rounding keeps their zeros apart, or one of them from being located
                let seen = together.iter().filter_map(|located| match &located.event {
                    BranchEvent::Change(margin) => Some(margin),
                    _ => None,
                });
                let vanished = examination.margins().iter().filter(|margin| {
                    let beyond = find::<O>(step.after, margin);
                    O::value(margin).abs() <= events::rounding(orbit, place, margin)
                        && beyond.is_some_and(|beyond| O::value(beyond) <= 0.0)
                });
                let mut margins: Vec<O::Margin> = seen.chain(vanished).cloned().collect();
                margins.sort_by_key(O::precedence);
                return Ok(self.change(found, &margins, step));
            }
        }
        Ok(Outcome::Passed(found))
    }

    fn stretch(&self, node: &Node) -> f64 {
        self.orbit.stretch(&node.point)
    }

    fn aliases(&self, first: &Node, near: &Node) -> Vec<Node> {
        self.orbit.aliases(first, near)
    }

    fn arrive(
        &mut self,
        node: &mut Node,
        examination: &O::Examination,
        passed: &[(Place, LocatedEvent<O>)],
    ) {
        if node.tangent[node.tangent.len() - 1] * self.heading < 0.0 {
            self.heading = -self.heading;
        }
        let value = self.orbit.value_at(&node.point);
        let told = self.told.take();
        let kept = || told.filter(|_| passed.iter().all(|(_, one)| one.keeps_stability()));
        self.told = OutsideCount::at(value, examination).or_else(kept);
    }

    fn point(&self, s: f64, node: &Node, examination: &O::Examination) -> LocatedPoint<O> {
        LocatedPoint::new(&self.orbit, s, node, examination)
    }

    fn closing(&self, s: f64, first: &Node, reached: LocatedPoint<O>) -> LocatedPoint<O> {
        let examination = self.orbit.examination(&first.point);
        let examination = examination.unwrap_or(reached.examination);
        LocatedPoint {
            special: Some(Special::Closed),
            ..self.point(s, first, &examination)
        }
    }

    fn exhausted(&self, node: &Node) -> Option<BranchStop<O>> {
        let stop = self.orbit.exhausted(node, self.limits.range);
        stop.map(BranchStop::Own)
    }

    fn ends_at(&self, node: &Node) -> Option<BranchStop<O>> {
        let repeats = self.orbit.repeats(node).map(|(_, stop)| stop);
        let stop = repeats.or_else(|| self.orbit.gives_out(node));
        stop.map(BranchStop::Own)
    }

    fn last(&self, end: &Ending<O>, here: LocatedPoint<O>) -> Option<LocatedPoint<O>> {
        let own = match end {
            walk::End::Own(BranchStop::Own(stop)) => Some(stop),
            _ => None,
        };
        if let Some(limit) = own.and_then(|stop| self.orbit.limit(stop, &here.node)) {
            return Some(LocatedPoint {
                parameter: limit.parameter,
                uncertainty: limit.uncertainty,
                special: Some(Special::Own(limit.special)),
                ..here
            });
        }
        let repeats = own.and_then(|_| self.orbit.repeats(&here.node));
        let unit = self.orbit.unit();
        let short = own.map_or(0.0, |stop| self.orbit.short_of(stop, &here.node));
        Some(match repeats {
            Some((special, _)) => self.sharpened(LocatedPoint {
                uncertainty: REPEATS * here.parameter.abs().max(unit),
                special: Some(Special::Own(special)),
                ..here
            }),
            None => LocatedPoint {
                uncertainty: here.uncertainty + short * unit,
                special: Some(failed(end)),
                ..here
            },
        })
    }
}

fn failed<O: Orbit>(end: &Ending<O>) -> Special<O> {
    Special::Failed(BranchFailure::Ended(Box::new(end.clone())))
}

/// Where a branch that comes to an orbit traversed several times finds no step any more, its parameter is off by
/// the square of what the parts differ by, and of the order of one part of a million.
const REPEATS: f64 = 1e-6;

impl<O: Orbit> Track<O> {
    /// The end of a branch where it would retrace itself: whatever test sees it there.
    fn repeated(&self, found: &LocatedPoint<O>) -> Option<Outcome<Track<O>>> {
        let (special, stop) = self.orbit.repeats(&found.node)?;
        let found = self.sharpened(LocatedPoint {
            special: Some(Special::Own(special)),
            ..found.clone()
        });
        let end = walk::End::Own(BranchStop::Own(stop));
        Some(Outcome::Ended(vec![found], end))
    }

    /// The end of a branch at the point to which its orbit has shrunk. There all its guards vanish and multipliers are
    /// rounding: what is told is the orbit just before it.
    fn vanished(&self, step: &Segment<O::Examination>, place: &Place) -> Option<Outcome<Track<O>>> {
        /// So far before it, in scaled units.
        const BEFORE: f64 = 1e-9;
        let orbit = self.orbit.as_ref();
        orbit.vanishes(&place.node)?;
        let s = place.s - BEFORE;
        let node = node_at(orbit, step.from, s, step.steps.tolerance)?;
        let examination = orbit.examination(&node.point).ok()?;
        self.repeated(&self.point(s, &node, &examination))
    }

    /// An orbit traversed twice where the branch of the single one says that it doubles, and one that shrinks where it
    /// has no size: both are known much better.
    fn sharpened(&self, found: LocatedPoint<O>) -> LocatedPoint<O> {
        let orbit = self.orbit.as_ref();
        let tolerance = self.limits.steps.tolerance;
        if let Some((parameter, uncertainty)) = orbit.vanishes(&found.node) {
            return LocatedPoint {
                parameter,
                uncertainty,
                ..found
            };
        }
        let shrunk = orbit.shrunk(&found.node);
        let sharper = shrunk.or_else(|| retrace::doubling(orbit, &found.node, tolerance));
        self.moved(found, sharper)
    }

    /// A point found at a better place, if there is one, known with this error.
    fn moved(&self, found: LocatedPoint<O>, better: Option<(Vector, f64)>) -> LocatedPoint<O> {
        let orbit = self.orbit.as_ref();
        let Some((point, uncertainty)) = better else {
            return found;
        };
        let Ok(examination) = orbit.examination(&point) else {
            return found;
        };
        LocatedPoint {
            parameter: orbit.value_at(&point),
            node: Node {
                point,
                ..found.node
            },
            examination,
            uncertainty,
            ..found
        }
    }

    /// Where margins vanish at several instants of the period at once, and the error of the parameter there. Zones
    /// that vanish together do so like square roots: each alone is located badly.
    fn at_once(
        &self,
        step: &Segment<O::Examination>,
        place: &Place,
        examination: &O::Examination,
    ) -> Option<(Place, f64)> {
        /// The square root of rounding, at most, in units of a margin.
        const NEARLY: f64 = 1e-6;
        let orbit = self.orbit.as_ref();
        let near = examination.margins().iter().filter(|margin| {
            let beyond = find::<O>(step.after, margin);
            O::value(margin).abs() <= NEARLY && beyond.is_some_and(|beyond| O::value(beyond) <= 0.0)
        });
        let mut near: Vec<O::Margin> = near.cloned().collect();
        near.sort_by_key(O::precedence);
        let instants = change::instants(orbit, &place.node.point, &near);
        let first = instants.iter().filter_map(|margins| margins.first());
        let first: Vec<O::Margin> = first.cloned().collect();
        (first.len() > 1)
            .then(|| events::together(orbit, place, &first))
            .flatten()
    }

    /// A change of regime: the event, and the branch beyond it.
    fn change(
        &self,
        mut found: LocatedPoint<O>,
        margins: &[O::Margin],
        step: &Segment<O::Examination>,
    ) -> Outcome<Track<O>> {
        let point = &found.node.point;
        let ds = step.ds.clamp(INTO * step.steps.ds, step.steps.ds);
        let search = |margin: &O::Margin| {
            change::beyond(self.orbit.as_ref(), point, margin, ds, step.steps.tolerance)
        };
        let instants = change::instants(self.orbit.as_ref(), point, margins);
        let together = (instants.len() > 1).then(|| {
            let tolerance = step.steps.tolerance;
            change::beyond_together(self.orbit.as_ref(), point, &instants, ds, tolerance)
        });
        let (mut margin, mut search_there, between) = match together.flatten() {
            Some(all) => (all.margin, all.search, Some(all.between)),
            None => (margins[0].clone(), search(&margins[0]), None),
        };
        for other in &margins[1..] {
            if search_there.beyond.is_some() {
                break;
            }
            let found = search(other);
            if found.beyond.is_some() {
                (margin, search_there) = (other.clone(), found);
            } else {
                search_there.add_refused(found.refused);
            }
        }
        let mut passed = Vec::new();
        if search_there.beyond.is_none()
            && let Some(both) = change::beyond_both(
                self.orbit.as_ref(),
                &found.node,
                margins,
                ds,
                step.steps.tolerance,
            )
        {
            let second = self.second(&mut found, &both);
            margin = both.second;
            passed.push(std::mem::replace(&mut found, second));
            search_there = both.search;
        }
        let change::Search {
            beyond,
            refused,
            others,
        } = search_there;
        let after = beyond
            .as_ref()
            .map(|beyond| beyond.orbit.signature().clone());
        let mut change = Change {
            others,
            ..Change::new(found.orbit.as_ref(), after, margin.clone())
        };
        // of several changes at once the first says what they are
        if let Some(between) = between {
            change.kind = O::classify(&change.before, Some(&between), &margin);
        }
        let Some(Beyond { orbit, node, ds }) = beyond else {
            let stop = change::ending(self.orbit.as_ref(), &found.node.point, &margin, refused);
            change.end = Some(stop.clone());
            let completes = stop.completes();
            let end = walk::End::Own(stop);
            found.special = Some(Special::Change(Box::new(change)));
            if completes {
                return Outcome::Ended(vec![found], end);
            }
            let failure = LocatedPoint {
                special: Some(failed(&end)),
                ..found.clone()
            };
            return Outcome::Ended(vec![found, failure], end);
        };
        let watched = match orbit.examination(&node.point) {
            Ok(watched) => watched,
            Err(error) => {
                found.special = Some(Special::Change(Box::new(change)));
                passed.push(found);
                return Outcome::Ended(passed, walk::End::Own(BranchStop::Flow(error)));
            }
        };
        // an orbit of a part of the period: only where this one is none already
        let repeats = orbit.repeats(&node);
        let already = self.orbit.repeats(&found.node).is_some();
        if let Some((_, stop)) = repeats.filter(|_| !already) {
            change.end = Some(BranchStop::Own(stop.clone()));
            found.special = Some(Special::Change(Box::new(change)));
            found.entered = Some((Arc::new(orbit), node));
            passed.push(found);
            return Outcome::Ended(passed, walk::End::Own(BranchStop::Own(stop)));
        }
        let tolerance = step.steps.tolerance;
        let image = || {
            let here = passed.is_empty().then_some(self.orbit.as_ref())?;
            retrace::at_change(here, &found.node, (&orbit, &node), ds, tolerance)
        };
        if let Some((_, stop)) = image() {
            change.end = Some(BranchStop::Own(stop.clone()));
            found.special = Some(Special::Change(Box::new(change)));
            passed.push(found);
            return Outcome::Ended(passed, walk::End::Own(BranchStop::Own(stop)));
        }
        let mut cascade = self.cascade.clone();
        let more = orbit.unknowns().saturating_sub(self.orbit.unknowns());
        cascade.take(change.kind, more, found.parameter);
        let (low, high) = self.limits.range;
        let limit = cascade.limit();
        if let Some(limit) = limit.filter(|limit| low < limit.value && limit.value < high) {
            let stop = BranchStop::Converges {
                kind: change.kind,
                changes: limit.changes,
                ratio: limit.ratio,
                parameter: self.orbit.parameter(),
                limit: limit.value,
                error: limit.error,
            };
            change.end = Some(stop.clone());
            found.special = Some(Special::Change(Box::new(change)));
            found.entered = Some((Arc::new(orbit), node));
            passed.push(found);
            return Outcome::Ended(passed, walk::End::Own(stop));
        }
        let drift = node.tangent[node.tangent.len() - 1];
        change.turned_back = drift * self.heading < 0.0 && !events::is_vertical(&orbit, &node);
        let orbit = Arc::new(orbit);
        let curve = Track {
            orbit: orbit.clone(),
            limits: self.limits.clone(),
            monitors: self.monitors.clone(),
            heading: if change.turned_back {
                -self.heading
            } else {
                self.heading
            },
            cascade,
            told: None,
        };
        found.entered = Some((orbit, node.clone()));
        found.special = Some(Special::Change(Box::new(change)));
        let entry = Beginning {
            curve,
            node,
            watched,
            ds: ds.max(step.steps.ds_min),
        };
        passed.push(found);
        Outcome::Entered(passed, entry)
    }

    /// The second of two changes at the place of the first, which leads to the orbit in between.
    fn second(&self, first: &mut LocatedPoint<O>, both: &Both<O>) -> LocatedPoint<O> {
        let between = Arc::new(both.between.clone());
        let after = Some(between.signature().clone());
        let change = Change::new(self.orbit.as_ref(), after, both.first.clone());
        first.special = Some(Special::Change(Box::new(change)));
        first.entered = Some((between.clone(), both.node.clone()));
        let examination = between.examination(&both.node.point);
        let examination = examination.unwrap_or_else(|_| first.examination.clone());
        let drift = first.node.tangent[first.node.tangent.len() - 1].abs();
        LocatedPoint {
            uncertainty: first.uncertainty + both.distance * drift * between.unit(),
            ..LocatedPoint::new(&between, first.s, &both.node, &examination)
        }
    }
}
