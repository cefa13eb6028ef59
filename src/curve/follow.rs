//! An event in two parameters as a curve for the walker.

use serde::{Deserialize, Serialize};

use super::plane::{
    Condition, ExaminationOf, FailureOf, MarginOf, Plane, SignatureOf, Test, TestValues,
};
use super::point::{Gone, Limits, Point, PointType, What};
use super::system::EventSystem;
use super::tube::Tube;
use crate::continuation::Node;
use crate::continuation::limit::limit;
use crate::continuation::locate::{self, Least, Place, Target};
use crate::continuation::newton;
use crate::continuation::walk::{self, Beginning, Curve, End, Outcome, Segment, Within};
use crate::linalg::{self, Vector};
use crate::orbit::change::nearest_beyond;
use crate::orbit::special::{Change, Close};
use crate::orbit::{AtZero, Candidate, EventType, Examined, Orbit, find};

/// A margin below this on the event's own account is the event itself, but for rounding.
const OWN: f64 = 1e-8;

/// F_x with a least singular value below this part of the largest is singular along the whole curve:
/// a zone without length makes the parameters stationary.
const SINGULAR: f64 = 1e-10;

/// Margins and residuals of a candidate below this vanish at the point where two events meet: it is
/// known to 1e-12 or better, and reduced switching functions of nascent zones amplify that.
const AT_SECOND: f64 = 1e-8;

/// A least margin within this of zero is zero but for rounding: points of a curve are known to 1e-12.
const ROUNDED: f64 = 1e-12;

/// Lengths of the first step tried into a candidate.
const TRIES: usize = 8;

/// First step into an orbit beyond an event, as on a branch.
pub(super) const INTO: f64 = 1e-3;

/// Orbits of one signature at an event, as a curve in two parameters.
#[derive(Clone, Debug)]
pub struct EventCurve<P: Plane> {
    pub(super) system: EventSystem<P>,
    pub(super) event: EventType,
    pub(super) limits: Limits,
    /// Margins that vanish along the whole curve.
    pub(super) own: Vec<(P::Watch, usize)>,
    /// Whether det F_x tells a fold.
    pub(super) with_fold: bool,
}

/// Test functions at a point.
#[derive(Clone, Debug)]
pub struct Tests<P: Plane> {
    examination: ExaminationOf<P>,
    /// The slopes of its margins along the curve.
    slopes: Vec<f64>,
    /// det F_x where it tells a fold.
    fold: Option<f64>,
    /// The factor that vanishes at a cusp, with the left null vector behind it.
    pub(super) cusp: Option<(f64, Vector)>,
    /// What the plane watches.
    watched: TestValues,
}

/// A point of a curve with the equations that it solves.
#[derive(Clone, Debug)]
pub struct Solved<P: Plane = Tube> {
    pub(super) point: Point,
    pub(super) system: EventSystem<P>,
    pub(super) unknowns: Vector,
}

/// What is located within a step.
#[derive(Clone, Debug)]
pub enum Event<P: Plane> {
    /// An edge of the range of a parameter.
    Edge(usize, f64),
    /// Another margin vanishes.
    Margin(MarginOf<P>),
    /// det F_x changes its sign.
    Fold,
    /// The factor of a cusp does.
    Cusp,
    /// Another test function does: what it is there.
    Other(Test),
    /// The number of multipliers outside the unit circle changes, from the first to the second.
    Passing([usize; 2]),
    /// Orbits shrink to a point: the unknowns there, and the part of their ranges to which the parameters are known.
    Shrinks(Vector, f64),
}

/// Why an event refuses a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum Refusal<P: Plane = Tube> {
    /// Its test functions cannot be evaluated.
    Flow(FailureOf<P>),
    /// A margin is negative from where it is first posed.
    Posed,
    /// A test function changes its sign and its zero is not found.
    NotLocated,
    /// The event is none any more.
    Gone(Gone),
}

impl<P: Plane> std::error::Error for Refusal<P> {}

/// Why an event ends for reasons of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Stop {
    /// At its last point, which says why.
    There,
    /// It is none any more.
    Gone(Gone),
}

type Stage<'a, P> = Segment<'a, Tests<P>>;

impl<P: Plane> EventCurve<P> {
    /// An event at a solution of its equations.
    pub(super) fn new(
        system: EventSystem<P>,
        event: EventType,
        point: &Vector,
        limits: Limits,
    ) -> Result<EventCurve<P>, FailureOf<P>> {
        let (orbit, unknowns) = system.orbit(point, 0)?;
        let examination = orbit.examination(&unknowns)?;
        let vanish = examination.margins().iter();
        let own = vanish
            .filter(|margin| P::Orbit::value(margin).abs() < OWN)
            .map(P::key)
            .collect();
        let (_, by) = system.orbit_equations(point)?;
        let square = by.columns(0, system.orbit_unknowns()).clone_owned();
        let regular =
            linalg::least(&square).is_some_and(|least| least.value > SINGULAR * least.largest);
        Ok(EventCurve {
            with_fold: regular && system.condition != Condition::Fold,
            system,
            event,
            limits,
            own,
        })
    }

    /// Test functions at a node; `left` orients the left null vector. Refused where the event is none
    /// any more.
    pub(super) fn tests(&self, node: &Node, left: Option<&Vector>) -> Result<Tests<P>, Refusal<P>> {
        let at = self.system.orbit(&node.point, 0).map_err(Refusal::Flow)?;
        let (orbit, unknowns) = &at;
        let examination = orbit.examination(unknowns).map_err(Refusal::Flow)?;
        for own in &self.own {
            let zone = P::zone(orbit.signature(), own.1);
            let itself = match &self.system.condition {
                Condition::Margin(margin) => P::key(margin) == *own,
                _ => false,
            };
            let mut margins = examination.margins().iter();
            let margin = margins.find(|margin| P::key(margin) == *own);
            return Err(Refusal::Gone(match margin.map(P::Orbit::value) {
                Some(value) if value >= -OWN => continue,
                Some(_) if itself => Gone::Lower(zone),
                None if itself => Gone::Left(zone),
                _ => Gone::Along(zone),
            }));
        }
        if let Condition::Spectral(spectral) = &self.system.condition {
            let further = self.system.further(&node.point);
            let lost = self.system.plane.lost(spectral, orbit, unknowns, further);
            lost.map_or(Ok(()), |gone| Err(Refusal::Gone(gone)))?;
        }
        let slopes = self.slopes(node, examination.margins());
        let mut tests = Tests {
            slopes: slopes.map_err(Refusal::Flow)?,
            fold: None,
            cusp: None,
            watched: self.system.watched(&node.point, &at),
            examination,
        };
        if self.with_fold {
            tests.fold = Some(self.determinant(&node.point).map_err(Refusal::Flow)?);
        } else if self.system.condition == Condition::Fold {
            tests.cusp = self.cusp(node, left).map_err(Refusal::Flow)?;
        }
        Ok(tests)
    }

    /// The slopes of margins along the curve: posed in p₁ the orbit gives all but the part of p₂.
    fn slopes(&self, node: &Node, margins: &[MarginOf<P>]) -> Result<Vec<f64>, FailureOf<P>> {
        let count = self.system.orbit_unknowns();
        let parameters = node.tangent.len() - 2;
        let mut along = node.tangent.rows(0, count + 1).clone_owned();
        along[count] = node.tangent[parameters];
        let mut second = Vector::zeros(count + 1);
        second[count] = node.tangent[parameters + 1];
        let (orbit, _) = self.system.orbit(&node.point, 0)?;
        let (other, unknowns) = self.system.orbit(&node.point, 1)?;
        margins
            .iter()
            .map(|margin| {
                let in_second = other.margin_at(margin, &unknowns)?;
                Ok(orbit.slope(margin, &along) + other.slope(&in_second, &second))
            })
            .collect()
    }

    fn determinant(&self, point: &Vector) -> Result<f64, FailureOf<P>> {
        let (_, by) = self.system.orbit_equations(point)?;
        let square = by.columns(0, self.system.orbit_unknowns()).clone_owned();
        Ok(square.determinant())
    }

    /// The factor that vanishes at a cusp, and the left null vector behind it.
    fn cusp(
        &self,
        node: &Node,
        near: Option<&Vector>,
    ) -> Result<Option<(f64, Vector)>, FailureOf<P>> {
        let count = self.system.orbit_unknowns();
        let (_, by) = self.system.orbit_equations(&node.point)?;
        let square = by.columns(0, count).clone_owned();
        Ok(linalg::least(&square).map(|least| {
            let mut left = least.left;
            if near.is_some_and(|near| near.dot(&left) < 0.0) {
                left.neg_mut();
            }
            let last = node.tangent.len() - 2;
            let factor = -node.tangent[last] * left.dot(&by.column(count + 1))
                + node.tangent[last + 1] * left.dot(&by.column(count));
            (factor, left)
        }))
    }

    /// Edges of the ranges within a step.
    fn edges(&self, step: &Stage<P>) -> Option<Vec<(Place, Event<P>)>> {
        let first = step.to.point.len() - 2;
        let way = [&step.from.point, &step.to.point];
        let mut located = Vec::new();
        for (index, (low, high)) in self.limits.ranges.into_iter().enumerate() {
            for (value, outside) in [(low, -1.0), (high, 1.0)] {
                let target = Target {
                    index: first + index,
                    value: value / self.system.widths()[index],
                    outside,
                };
                let places =
                    target.meetings(&self.system, step.from, &way, step.steps.tolerance)?;
                let event = Event::Edge(index, value);
                located.extend(places.into_iter().map(|place| (place, event.clone())));
            }
        }
        Some(located)
    }

    /// The zero of a function along a step from its values at both ends, or none where they have one sign.
    fn zero(
        &self,
        step: &Stage<P>,
        before: f64,
        after: f64,
        event: Event<P>,
        value: impl FnMut(&Node) -> Option<f64>,
    ) -> Result<(Place, Event<P>), Refusal<P>> {
        /// Relative width of the bracket, or value, at which the place is known to rounding.
        const EXACT: f64 = 1e-14;
        let size = before.abs().max(after.abs());
        let small = (EXACT * size, EXACT * step.ds);
        let ends = ((0.0, before), (step.ds, after));
        let tolerance = step.steps.tolerance;
        let (place, _) = locate::zero_along(&self.system, step.from, ends, small, tolerance, value)
            .ok_or(Refusal::NotLocated)?;
        Ok((place, event))
    }

    /// Margins that vanish within a step.
    fn margins(&self, step: &Stage<P>) -> Result<Vec<(Place, Event<P>)>, Refusal<P>> {
        let mut located = Vec::new();
        for margin in step.after.examination.margins() {
            let value = P::Orbit::value(margin);
            if self.own.contains(&P::key(margin)) || value > 0.0 {
                continue;
            }
            let before = find::<P::Orbit>(&step.before.examination, margin);
            let before = before.map(P::Orbit::value).filter(|before| *before > 0.0);
            let before = before.ok_or(Refusal::Posed)?;
            let mut at = AtZero {
                margin: margin.clone(),
            };
            let event = Event::Margin(margin.clone());
            located.push(self.zero(step, before, value, event, |node| {
                let (orbit, unknowns) = self.system.orbit(&node.point, 0).ok()?;
                Some(P::Orbit::value(at.margin_at(&orbit, &unknowns).ok()?))
            })?);
        }
        Ok(located)
    }

    /// Smooth test functions that change their sign within a step.
    fn signs(&self, step: &Stage<P>) -> Result<Vec<(Place, Event<P>)>, Refusal<P>> {
        let mut located = Vec::new();
        if let (Some(before), Some(after)) = (step.before.fold, step.after.fold)
            && before * after < 0.0
        {
            located.push(self.zero(step, before, after, Event::Fold, |node| {
                self.determinant(&node.point).ok()
            })?);
        }
        if let (Some((before, left)), Some((after, _))) = (&step.before.cusp, &step.after.cusp)
            && before * after < 0.0
        {
            located.push(self.zero(step, *before, *after, Event::Cusp, |node| {
                Some(self.cusp(node, Some(left)).ok()??.0)
            })?);
        }
        let [before, after] = [&step.before, &step.after].map(|tests| &tests.watched.tests);
        let tests = before.iter().zip(after);
        for (index, (before, after)) in tests.enumerate() {
            if before.value * after.value < 0.0 {
                let tests = |node: &Node| {
                    let at = self.system.orbit(&node.point, 0)?;
                    Ok(self.system.watched(&node.point, &at).tests)
                };
                let event = Event::Other(*after);
                let (place, _) = self.zero(step, before.value, after.value, event, |node| {
                    tests(node).ok()?.get(index).map(|test| test.value)
                })?;
                // what it is, the place itself tells
                let there = tests(&place.node).map_err(Refusal::Flow)?;
                let there = there.get(index).unwrap_or(after);
                if there.kind.is_some() || there.ends {
                    located.push((place, Event::Other(*there)));
                }
            }
        }
        Ok(located)
    }

    /// Where the number of multipliers outside the unit circle changes within a step in which nothing else happens that
    /// would tell: an even number passes the circle, of which no test function changes its sign.
    fn passing(&self, step: &Stage<P>) -> Result<Option<(Place, Event<P>)>, Refusal<P>> {
        /// Part of the step to which it is located: nearer the circle the number is not known.
        const WIDTH: f64 = 1e-9;
        let outside = [&step.before, &step.after].map(|tests| tests.watched.outside);
        let [Some(before), Some(after)] = outside else {
            return Ok(None);
        };
        if before == after {
            return Ok(None);
        }
        let (mut low, mut high) = (0.0, step.ds);
        let mut place = Place {
            s: high,
            node: step.to.clone(),
            blur: 0.0,
        };
        while high - low > WIDTH * step.ds {
            let s = 0.5 * (low + high);
            let node = locate::node_at(&self.system, step.from, s, step.steps.tolerance);
            let node = node.ok_or(Refusal::NotLocated)?;
            let at = self.system.orbit(&node.point, 0).map_err(Refusal::Flow)?;
            let outside = self.system.watched(&node.point, &at).outside;
            place = Place {
                s,
                node,
                blur: high - low,
            };
            match outside {
                Some(outside) if outside == before => low = s,
                Some(_) => high = s,
                // on the circle
                None => break,
            }
        }
        Ok(Some((place, Event::Passing([before, after]))))
    }

    /// Where orbits shrink to a point, which small ones tell: beside it the equations are singular to their size, but the curve
    /// is smooth in it.
    fn shrinking(&self, step: &Stage<P>) -> Result<Option<(Place, Event<P>)>, Refusal<P>> {
        /// Size, in units of the states, of the largest orbit that tells, and the number of orbits: what their polynomial leaves out
        /// is of order 1e-13, and rounding of the smallest of folds, which is divided by the cube of its size, 1e-12.
        const SMALL: f64 = 5e-2;
        const SAMPLES: i32 = 8;
        /// Most that the limit of the parameters may be off by, in their ranges.
        const KNOWN: f64 = 1e-8;
        let size = |node: &Node, most: f64| {
            let (orbit, unknowns) = self.system.orbit(&node.point, 0).ok()?;
            P::extent(&orbit, &unknowns, most)
        };
        let [before, after] = [step.from, step.to].map(|node| size(node, 1.0));
        let (Some(before), Some(after)) = (before, after) else {
            return Ok(None);
        };
        // an orbit that has passed a point has moved by its own size
        let moved = (&step.to.point - &step.from.point).norm();
        if moved >= 0.5 * before && P::turns(&step.after.examination, &step.before.examination) {
            return Err(Refusal::NotLocated);
        }
        if after > SMALL || after >= before {
            return Ok(None);
        }
        let largest = SMALL.min(before);
        let samples: Option<Vec<(Place, f64)>> = (1..=SAMPLES)
            .rev()
            .map(|sample| {
                let wanted = largest * f64::from(sample) / f64::from(SAMPLES);
                let s = step.ds * (before - wanted) / (before - after);
                let node = locate::node_at(&self.system, step.from, s, step.steps.tolerance)?;
                let size = size(&node, 1.0)?;
                Some((Place { s, node, blur: 0.0 }, size))
            })
            .collect();
        let Some(samples) = samples else {
            return Ok(None);
        };
        let sized = samples
            .iter()
            .map(|(place, size)| (*size, place.node.point.clone()));
        let last = samples.last().map(|(place, _)| place.clone());
        let (Some((point, error)), Some(place)) = (limit(&sized.collect::<Vec<_>>()), last) else {
            return Ok(None);
        };
        let error = error.rows(point.len() - 2, 2).amax();
        Ok((error <= KNOWN).then_some((place, Event::Shrinks(point, error))))
    }

    /// The change of regime where another margin vanishes.
    fn second(
        &self,
        point: &Vector,
        margin: &MarginOf<P>,
        tolerance: f64,
    ) -> Result<Change<P::Orbit>, FailureOf<P>> {
        let (orbit, unknowns) = self.system.orbit(point, 0)?;
        let here = orbit.margin_at(margin, &unknowns);
        let here = here.unwrap_or_else(|_| margin.clone());
        let after = successor(&orbit, &unknowns, &here, tolerance);
        let after = after.map(|(orbit, _)| orbit.signature().clone());
        Ok(Change::new(&orbit, after, here))
    }

    /// The same event of the orbit beyond a change of regime, a step into it being admissible.
    fn enter(
        &self,
        step: &Stage<P>,
        node: &Node,
        second: &MarginOf<P>,
    ) -> Option<Beginning<EventCurve<P>>> {
        let Condition::Margin(first) = &self.system.condition else {
            return None;
        };
        let first_key = P::key(first);
        let (orbit, unknowns) = self.system.orbit(&node.point, 0).ok()?;
        let zone = P::zone(orbit.signature(), first_key.1);
        let here = orbit.margin_at(second, &unknowns).ok()?;
        for candidate in orbit.candidates(&unknowns, &here).ok()? {
            let Ok(examination) = candidate.orbit.examination(&candidate.point) else {
                continue;
            };
            let margins = examination.margins().iter();
            let vanish: Vec<MarginOf<P>> = margins
                .filter(|margin| P::Orbit::value(margin).abs() < AT_SECOND)
                .cloned()
                .collect();
            let same = |margin: &&MarginOf<P>| {
                let key = P::key(margin);
                key.0 == first_key.0
                    && P::zone(candidate.orbit.signature(), key.1) == zone
                    && !(is_duration::<P>(margin) && candidate.nascent.contains(&key.1))
            };
            for margin in vanish.iter().filter(same) {
                let entered = self.enter_candidate(step, node, &candidate, margin, &vanish);
                if let Some((system, node, ds, own)) = entered {
                    let next =
                        EventCurve::new(system, self.event, &node.point, self.limits).ok()?;
                    let curve = EventCurve { own, ..next };
                    let watched = curve.tests(&node, None).ok()?;
                    return Some(Beginning {
                        curve,
                        node,
                        watched,
                        ds,
                    });
                }
            }
        }
        None
    }

    /// The first admissible step into the curve on which a margin of a candidate vanishes: its equations,
    /// its beginning, its length, and the margins that vanish along it.
    #[allow(clippy::type_complexity)] // taken apart at once by its one caller
    fn enter_candidate(
        &self,
        step: &Stage<P>,
        node: &Node,
        candidate: &Candidate<P::Orbit>,
        margin: &MarginOf<P>,
        vanish: &[MarginOf<P>],
    ) -> Option<(EventSystem<P>, Node, f64, Vec<(P::Watch, usize)>)> {
        let signature = candidate.orbit.signature().clone();
        let system = self.system.of(signature, Condition::Margin(margin.clone()));
        let count = system.orbit_unknowns();
        let parameters = node.point.len() - 2;
        let point = Vector::from_fn(count + 2, |row, _| match row {
            row if row < count => candidate.point[row],
            row => node.point[parameters + row - count],
        });
        let from = Node::on(&system, point).filter(|node| node.residual <= AT_SECOND)?;
        let (ds, tolerance) = (step.ds.min(step.steps.ds), step.steps.tolerance);
        let (node, ds, own) = walk::enter(
            &system,
            (&from, &walk::EITHER_WAY),
            ds,
            TRIES,
            tolerance,
            |_, to| {
                let own = vanishing(&system, &to.ok()?, vanish)?;
                let nascent = |margin: &MarginOf<P>| {
                    let key = P::key(margin);
                    is_duration::<P>(margin)
                        && candidate.nascent.contains(&key.1)
                        && own.contains(&key)
                };
                // the event itself goes on, alone as before, and new zones do grow
                let admitted = own.contains(&P::key(margin))
                    && own.len() <= self.own.len()
                    && !vanish.iter().any(nascent);
                admitted.then_some(own)
            },
        )?;
        Some((system, node, ds, own))
    }
}

/// Whether a margin is the duration of a zone, which says most about what comes next.
fn is_duration<P: Plane>(margin: &MarginOf<P>) -> bool {
    P::Orbit::precedence(margin) == 0
}

/// Which of the margins that vanish at the beginning of a step vanish at its end too; `None` where that
/// is not admissible.
fn vanishing<P: Plane>(
    system: &EventSystem<P>,
    to: &Node,
    vanish: &[MarginOf<P>],
) -> Option<Vec<(P::Watch, usize)>> {
    let (orbit, unknowns) = system.orbit(&to.point, 0).ok()?;
    let examination = orbit.examination(&unknowns).ok()?;
    let mut along = Vec::new();
    for margin in examination.margins() {
        let (key, value) = (P::key(margin), P::Orbit::value(margin));
        let began = vanish.iter().any(|known| P::key(known) == key);
        if began && value.abs() < OWN {
            along.push(key);
        } else if value.is_nan() || value <= 0.0 {
            return None;
        }
    }
    Some(along)
}

impl<P: Plane> Curve for EventCurve<P> {
    type System = EventSystem<P>;
    type Name = SignatureOf<P>;
    type Watched = Tests<P>;
    type Event = Event<P>;
    type Found = Solved<P>;
    type Refusal = Refusal<P>;
    type End = Stop;
    type Close = Close<<P::Orbit as Orbit>::Held>;

    /// Beside the opening of a separation zone the landing jump of a perturbation is singular, and
    /// Newton's method converges slowly at any length of step.
    const CREEP: (usize, f64) = (200, 2e-4);

    fn system(&self) -> &EventSystem<P> {
        &self.system
    }

    fn name(&self) -> &SignatureOf<P> {
        self.system.signature()
    }

    fn watch(&self, node: &Node, near: Option<&Tests<P>>) -> Result<Tests<P>, Refusal<P>> {
        let cusp = near.and_then(|near| near.cusp.as_ref());
        self.tests(node, cusp.map(|(_, left)| left))
    }

    /// Whether a margin vanishes twice.
    fn within(
        &self,
        step: &Stage<P>,
        located: &[(Place, Event<P>)],
    ) -> Within<Close<<P::Orbit as Orbit>::Held>> {
        let ends = |event: &Event<P>| match event {
            Event::Fold | Event::Cusp | Event::Passing(_) => false,
            Event::Other(test) => test.ends,
            Event::Edge(..) | Event::Margin(_) | Event::Shrinks(..) => true,
        };
        let end = located.iter().find(|(_, event)| ends(event));
        let end = end.map_or(f64::INFINITY, |(place, _)| place.s - step.at_once());
        let mut close = None;
        let mut pair = f64::INFINITY;
        let after = step.after.examination.margins();
        let value = P::Orbit::value;
        for (index, margin) in step.before.examination.margins().iter().enumerate() {
            let same = |other: &MarginOf<P>| P::key(other) == P::key(margin);
            let own = self.own.contains(&P::key(margin));
            let Some(other) = after.iter().position(same).filter(|_| !own) else {
                continue;
            };
            let ends = [
                (value(margin), step.before.slopes[index]),
                (value(&after[other]), step.after.slopes[other]),
            ];
            // margins at zero belong to the point the step starts from
            if ends[0].0 <= OWN || ends[1].0 <= 0.0 {
                continue;
            }
            let tolerance = step.steps.tolerance;
            let least = locate::least(&self.system, step.from, step.ds, ends, tolerance, |node| {
                let (orbit, unknowns) = self.system.orbit(&node.point, 0).ok()?;
                let examination = orbit.examination(&unknowns).ok()?;
                let margin = examination.margins().iter().find(|other| same(other))?;
                let slopes = self.slopes(node, std::slice::from_ref(margin)).ok()?;
                Some((value(margin), slopes[0]))
            });
            let held = || {
                let (orbit, _) = self.system.orbit(&step.from.point, 0).ok()?;
                Some(Close::Margin(orbit.held(margin)))
            };
            let found = match least {
                Least::Found(place, _) if place.s >= end => None,
                Least::Found(place, value) if value < -ROUNDED => {
                    pair = pair.min(place.s);
                    None
                }
                Least::Found(place, value) if value <= ROUNDED => Some(place.s),
                Least::NotFound if step.ds < end => Some(step.ds),
                _ => None,
            };
            if let Some((s, held)) = found.zip(held()) {
                close.get_or_insert((s, held));
            }
        }
        match close {
            _ if pair.is_finite() => Within::Pair(pair),
            Some((s, what)) => Within::Close(s, what),
            None => Within::Nothing,
        }
    }

    fn doubted(&self, mut found: Solved<P>, close: Close<<P::Orbit as Orbit>::Held>) -> Solved<P> {
        if found.point.what.is_empty() {
            found.point.what = P::say(&What::Close(close));
        }
        found
    }

    fn locate(&self, step: &Stage<P>) -> Result<Vec<(Place, Event<P>)>, Refusal<P>> {
        let mut located = self.edges(step).ok_or(Refusal::NotLocated)?;
        located.extend(self.margins(step)?);
        located.extend(self.signs(step)?);
        located.extend(self.shrinking(step)?);
        // what is located accounts for the number, or ends the step before its end
        if located.is_empty() {
            located.extend(self.passing(step)?);
        }
        Ok(located)
    }

    fn meet(
        &self,
        step: &Stage<P>,
        place: &Place,
        together: &[Event<P>],
    ) -> Result<Outcome<EventCurve<P>>, Refusal<P>> {
        let mut solved = self.point(place.s, &place.node, step.after);
        let mut say = |kind: PointType, what: &What<P::Orbit>| {
            solved.point.kind = Some(kind);
            solved.point.what = P::say(what);
        };
        let there = End::Own(Stop::There);
        // where a pair meets at ±1 there is a fold or a doubling, too: the end goes first
        let ends = |event: &&Event<P>| matches!(event, Event::Other(test) if test.ends);
        let first = together.iter().find(ends).unwrap_or(&together[0]);
        Ok(match first {
            Event::Edge(index, value) => {
                let (index, value) = (*index, *value);
                let parameter = self.system.parameters()[index].clone();
                say(PointType::One(EventType::EP), &What::Edge(parameter, value));
                // exactly the value that was asked for
                solved.point.parameters[index] = value;
                Outcome::Ended(vec![solved], End::Edge)
            }
            Event::Margin(_) => {
                let margins = together.iter().filter_map(|event| match event {
                    Event::Margin(margin) => Some(margin.clone()),
                    _ => None,
                });
                let mut margins: Vec<MarginOf<P>> = margins.collect();
                // a zone without length says most about what comes next
                margins.sort_by_key(P::Orbit::precedence);
                let second = self.second(&place.node.point, &margins[0], step.steps.tolerance);
                let second = second.map_err(Refusal::Flow)?;
                let mut entries = margins.iter();
                let entry = entries.find_map(|margin| self.enter(step, &place.node, margin));
                let kind = P::with_event(self.event, second.kind);
                let what = What::Meeting {
                    second: Box::new(second),
                    may_go_on: matches!(self.system.condition, Condition::Margin(_)),
                    next: entry.as_ref().map(|entry| entry.curve.name().clone()),
                };
                say(kind, &what);
                match entry {
                    Some(entry) => Outcome::Entered(vec![solved], entry),
                    None => Outcome::Ended(vec![solved], there),
                }
            }
            Event::Fold => {
                say(P::with_fold(self.event), &What::Fold);
                Outcome::Passed(solved)
            }
            Event::Cusp => {
                say(PointType::CP, &What::Cusp);
                Outcome::Passed(solved)
            }
            Event::Passing(outside) => {
                solved.point.what = P::say(&What::Passing(*outside));
                Outcome::Passed(solved)
            }
            Event::Shrinks(point, error) => {
                let (orbit, unknowns) = self
                    .system
                    .orbit(&place.node.point, 0)
                    .map_err(Refusal::Flow)?;
                let kind = P::of_no_size(self.event, &self.system.condition, &orbit, &unknowns);
                say(
                    kind,
                    &What::Shrinks {
                        kind,
                        error: *error,
                    },
                );
                solved.point.parameters = self.system.values(point);
                if let Ok((orbit, unknowns)) = self.system.orbit(point, 0) {
                    (solved.point.measure, _) = P::measure(&orbit, &unknowns);
                }
                Outcome::Ended(vec![solved], there)
            }
            Event::Other(test) => {
                let kind = match test.kind {
                    Some(PointType::One(other)) => Some(P::with_event(self.event, other)),
                    kind => kind,
                };
                if let Some(kind) = kind {
                    say(kind, &What::Other(kind));
                }
                match test.ends {
                    true => Outcome::Ended(vec![solved], there),
                    false => Outcome::Passed(solved),
                }
            }
        })
    }

    fn stretch(&self, node: &Node) -> f64 {
        P::stretch(&node.point.as_slice()[..self.system.orbit_unknowns()])
    }

    fn arrive(&mut self, node: &mut Node) {
        self.system.settle(&node.point);
        let further = self.system.further(&node.point);
        let renewed = match &self.system.condition {
            Condition::Spectral(spectral) => P::renewed(spectral, further),
            _ => None,
        };
        if let Some((spectral, further)) = renewed {
            let signature = self.system.signature().clone();
            let system = self.system.of(signature, Condition::Spectral(spectral));
            if let Some(renewed) = system.with_further(node, &further) {
                self.system = system;
                *node = renewed;
            }
        }
    }

    fn aliases(&self, first: &Node, near: &Node) -> Vec<Node> {
        /// Points whose states or parameters are further apart, in their units, are not the same: far beyond a step.
        const FAR: f64 = 1.0;
        let (count, last) = (self.system.orbit_unknowns(), first.point.len() - 2);
        let apart = |from: usize, length: usize| {
            let difference = first.point.rows(from, length) - near.point.rows(from, length);
            difference.norm()
        };
        let further = |node: &Node| node.point.as_slice()[count..last].to_vec();
        let is_near = apart(0, count).max(apart(last, 2)) <= FAR;
        let alias = is_near
            .then(|| P::alias(&self.system.condition, &further(first), &further(near)))
            .flatten();
        let alias = alias.map(|further| self.system.with_further(first, &further));
        alias.map_or_else(|| vec![first.clone()], |node| node.into_iter().collect())
    }

    fn point(&self, _: f64, node: &Node, _: &Tests<P>) -> Solved<P> {
        let mut point = Point {
            parameters: self.system.values(&node.point),
            measure: f64::NAN,
            excess: None,
            numbers: Vec::new(),
            before: String::new(),
            after: String::new(),
            angular: self.system.angular(&node.point),
            kind: None,
            what: String::new(),
            newton: node.newton,
            residual: newton::jacobian(&self.system, &node.point)
                .map_or(node.residual, |(_, residual)| residual),
        };
        // the step has evaluated the same
        if let Ok((orbit, unknowns)) = self.system.orbit(&node.point, 0) {
            (point.measure, point.excess) = P::measure(&orbit, &unknowns);
            point.before = P::name(&orbit, &unknowns);
            let further = self.system.further(&node.point);
            let condition = &self.system.condition;
            point.numbers = self
                .system
                .plane
                .numbers(condition, &orbit, &unknowns, further);
            point.after = match &self.system.condition {
                Condition::Margin(margin) => {
                    let here = orbit.margin_at(margin, &unknowns);
                    let here = here.unwrap_or_else(|_| margin.clone());
                    let tolerance = self.limits.steps.tolerance;
                    successor(&orbit, &unknowns, &here, tolerance)
                        .map_or_else(String::new, |(orbit, node)| P::name(&orbit, &node.point))
                }
                _ => point.before.clone(),
            };
        }
        Solved {
            point,
            system: self.system.clone(),
            unknowns: node.point.clone(),
        }
    }

    fn closing(&self, _: f64, _: &Node, reached: Solved<P>) -> Solved<P> {
        reached
    }

    fn ends_with(&self, refusal: &Refusal<P>) -> Option<Stop> {
        match refusal {
            Refusal::Gone(gone) => Some(Stop::Gone(gone.clone())),
            _ => None,
        }
    }
}

/// The orbit beyond a change of regime, and the event in its unknowns.
fn successor<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    tolerance: f64,
) -> Option<(O, Node)> {
    let beyond = nearest_beyond(orbit, point, margin, INTO, tolerance)?;
    Some((beyond.orbit, beyond.node))
}
