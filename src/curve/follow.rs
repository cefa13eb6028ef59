//! An event in two parameters as a curve for the walker.

use serde::{Deserialize, Serialize};

use super::point::{Limits, Point, PointType};
use super::system::{Condition, EventSystem};
use crate::branch::EventType;
use crate::branch::special::{Change, Close};
use crate::continuation::Node;
use crate::continuation::locate::{self, Least, Place, Target};
use crate::continuation::newton;
use crate::continuation::walk::{self, Beginning, Curve, End, Outcome, Segment, Within};
use crate::flow::FlowError;
use crate::linalg::{self, Vector};
use crate::model::Parameter;
use crate::model::signature::{Regime, Signature};
use crate::orbit::change::beyond;
use crate::orbit::{Candidate, Orbit as _};
use crate::stability::spectrum::symmetric;
use crate::wave::Wave;
use crate::wave::admissibility::{AtZero, Examination, Margin, Watch, examine};
use crate::wave::successor::candidates;

/// A margin below this on the event's own account is the event itself, but for rounding.
const OWN: f64 = 1e-8;

/// ω in units of the frequency of the wave below which it counts as zero. Parameters are even in ω:
/// the point found lies 1e-8 from the limit.
const LEAST_OMEGA: f64 = 1e-4;

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

/// First step into a wave beyond an event, as on a branch.
pub(super) const INTO: f64 = 1e-3;

/// Waves of one signature at an event, as a curve in two parameters.
#[derive(Clone, Debug)]
pub(super) struct EventCurve {
    pub system: EventSystem,
    pub event: EventType,
    pub limits: Limits,
    /// Margins that vanish along the whole curve.
    pub own: Vec<(Watch, usize)>,
    /// Whether det F_x tells a fold.
    pub with_fold: bool,
}

/// Test functions at a point.
#[derive(Clone, Debug)]
pub(super) struct Tests {
    examination: Examination,
    /// The slopes of its margins along the curve.
    slopes: Vec<f64>,
    /// det F_x where it tells a fold.
    fold: Option<f64>,
    /// The factor that vanishes at a cusp, with the left null vector behind it.
    pub cusp: Option<(f64, Vector)>,
}

/// A point of a curve with the equations that it solves.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    pub point: Point,
    pub system: EventSystem,
    pub unknowns: Vector,
}

/// What is located within a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Event {
    Edge(usize, f64),
    Margin(Margin),
    Fold,
    Cusp,
    ZeroOmega,
}

/// What happens at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// The curve begins: the event on the branch.
    Begins,
    /// An edge of the range of a parameter.
    Edge(Parameter, f64),
    /// Another inequality fails.
    Meeting {
        /// The change of regime where it does.
        second: Box<Change>,
        /// Whether this event could go on beyond it.
        may_go_on: bool,
        /// The signature in which it does.
        next: Option<Signature>,
    },
    /// The wave has a fold too.
    Fold,
    /// Two folds meet and vanish.
    Cusp,
    /// ω → 0.
    ZeroOmega,
    /// Something comes so close to zero that rounding decides.
    Close(Close),
}

/// Why an event is no event any more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Gone {
    /// Another minimum inside the zone is lower.
    Lower(Regime),
    /// The minimum leaves the zone through an end.
    Left(Regime),
    /// Another inequality of the zone, which vanishes along with the event, fails.
    Along(Regime),
}

/// Why an event refuses a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Refusal {
    /// Its test functions cannot be evaluated.
    Flow(#[from] FlowError),
    /// A margin is negative from where it is first posed.
    Posed,
    /// A test function changes its sign and its zero is not found.
    NotLocated,
    /// The event is none any more.
    Gone(Gone),
}

/// Why an event ends for reasons of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stop {
    /// At its last point, which says why.
    There,
    /// It is none any more.
    Gone(Gone),
}

type Stage<'a> = Segment<'a, Tests>;

impl EventCurve {
    /// An event at a solution of its equations.
    pub fn new(
        system: EventSystem,
        event: EventType,
        point: &Vector,
        limits: Limits,
    ) -> Result<EventCurve, FlowError> {
        let (wave, unknowns) = system.wave(point, 0);
        let examination = examine(&wave, &unknowns)?;
        let vanish = examination.margins.iter();
        let own = vanish
            .filter(|margin| margin.jet.value.abs() < OWN)
            .map(|margin| (margin.watch, margin.zone))
            .collect();
        let (_, by) = system.wave_equations(point)?;
        let square = by.columns(0, system.wave_unknowns()).clone_owned();
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
    pub fn tests(&self, node: &Node, left: Option<&Vector>) -> Result<Tests, Refusal> {
        let (wave, unknowns) = self.system.wave(&node.point, 0);
        let examination = examine(&wave, &unknowns)?;
        for (watch, zone) in &self.own {
            let regime = wave.signature.zone(*zone).regime;
            let itself = match self.system.condition {
                Condition::Margin(margin) => (margin.watch, margin.zone) == (*watch, *zone),
                _ => false,
            };
            return Err(Refusal::Gone(match examination.find(*watch, *zone) {
                Some(margin) if margin.jet.value >= -OWN => continue,
                Some(_) if itself => Gone::Lower(regime),
                None if itself => Gone::Left(regime),
                _ => Gone::Along(regime),
            }));
        }
        let mut tests = Tests {
            slopes: self.slopes(node, &examination.margins)?,
            examination,
            fold: None,
            cusp: None,
        };
        if self.with_fold {
            tests.fold = Some(self.determinant(&node.point)?);
        } else if self.system.condition == Condition::Fold {
            tests.cusp = self.cusp(node, left)?;
        }
        Ok(tests)
    }

    /// The slopes of margins along the curve: posed in p₁ the wave gives all but the part of p₂.
    fn slopes(&self, node: &Node, margins: &[Margin]) -> Result<Vec<f64>, FlowError> {
        let count = self.system.wave_unknowns();
        let parameters = node.tangent.len() - 2;
        let mut along = node.tangent.rows(0, count + 1).clone_owned();
        along[count] = node.tangent[parameters];
        let mut second = Vector::zeros(count + 1);
        second[count] = node.tangent[parameters + 1];
        let (wave, _) = self.system.wave(&node.point, 0);
        let (other, unknowns) = self.system.wave(&node.point, 1);
        margins
            .iter()
            .map(|margin| {
                let in_second = AtZero { margin: *margin }.margin_at(&other, &unknowns)?;
                Ok(margin.slope(&wave, &along) + in_second.slope(&other, &second))
            })
            .collect()
    }

    fn determinant(&self, point: &Vector) -> Result<f64, FlowError> {
        let (_, by) = self.system.wave_equations(point)?;
        let square = by.columns(0, self.system.wave_unknowns()).clone_owned();
        Ok(square.determinant())
    }

    /// The factor that vanishes at a cusp, and the left null vector behind it.
    fn cusp(&self, node: &Node, near: Option<&Vector>) -> Result<Option<(f64, Vector)>, FlowError> {
        let count = self.system.wave_unknowns();
        let (_, by) = self.system.wave_equations(&node.point)?;
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
    fn edges(&self, step: &Stage) -> Option<Vec<(Place, Event)>> {
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
                located.extend(places.into_iter().map(|place| (place, event)));
            }
        }
        Some(located)
    }

    /// The zero of a function along a step from its values at both ends, or none where they have one sign.
    fn zero(
        &self,
        step: &Stage,
        before: f64,
        after: f64,
        event: Event,
        value: impl FnMut(&Node) -> Option<f64>,
    ) -> Result<(Place, Event), Refusal> {
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
    fn margins(&self, step: &Stage) -> Result<Vec<(Place, Event)>, Refusal> {
        let mut located = Vec::new();
        for margin in &step.after.examination.margins {
            let own = self.own.contains(&(margin.watch, margin.zone));
            if own || margin.jet.value > 0.0 {
                continue;
            }
            let before = step.before.examination.find(margin.watch, margin.zone);
            let before = before.filter(|before| before.jet.value > 0.0);
            let before = before.ok_or(Refusal::Posed)?.jet.value;
            let mut at = AtZero { margin: *margin };
            let event = Event::Margin(*margin);
            located.push(self.zero(step, before, margin.jet.value, event, |node| {
                let (wave, unknowns) = self.system.wave(&node.point, 0);
                Some(at.margin_at(&wave, &unknowns).ok()?.jet.value)
            })?);
        }
        Ok(located)
    }

    /// Smooth test functions that change their sign within a step.
    fn signs(&self, step: &Stage) -> Result<Vec<(Place, Event)>, Refusal> {
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
        if let Condition::Hopf { sector } = self.system.condition {
            let count = self.system.wave_unknowns();
            let (wave, _) = self.system.wave(&step.to.point, 0);
            let sign = step.from.point[count].signum();
            let least = |node: &Node| sign * node.point[count] - LEAST_OMEGA;
            let (before, after) = (least(step.from), least(step.to));
            if symmetric(sector, wave.mode) && before > 0.0 && after <= 0.0 {
                let zero = self.zero(step, before, after, Event::ZeroOmega, |node| {
                    Some(least(node))
                });
                located.push(zero?);
            }
        }
        Ok(located)
    }

    /// The change of regime where another margin vanishes.
    fn second(&self, point: &Vector, margin: &Margin, tolerance: f64) -> Change {
        let (wave, unknowns) = self.system.wave(point, 0);
        let mut at = AtZero { margin: *margin };
        let here = at.margin_at(&wave, &unknowns).unwrap_or(*margin);
        let after = successor(&wave, &unknowns, &here, tolerance);
        Change::new(&wave, after, here)
    }

    /// The same event of the wave beyond a change of regime, a step into it being admissible.
    fn enter(&self, step: &Stage, node: &Node, second: &Margin) -> Option<Beginning<EventCurve>> {
        let Condition::Margin(first) = self.system.condition else {
            return None;
        };
        let (wave, unknowns) = self.system.wave(&node.point, 0);
        let regime = wave.signature.zone(first.zone).regime;
        let here = AtZero { margin: *second }
            .margin_at(&wave, &unknowns)
            .ok()?;
        for candidate in candidates(&wave, &unknowns, &here).ok()? {
            let Ok(examination) = examine(&candidate.orbit, &candidate.point) else {
                continue;
            };
            let vanish: Vec<Margin> = examination
                .margins
                .into_iter()
                .filter(|margin| margin.jet.value.abs() < AT_SECOND)
                .collect();
            let same = |margin: &&Margin| {
                margin.watch == first.watch
                    && candidate.orbit.signature.zone(margin.zone).regime == regime
                    && !(margin.watch == Watch::Duration
                        && candidate.nascent.contains(&margin.zone))
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
        step: &Stage,
        node: &Node,
        candidate: &Candidate<Wave>,
        margin: &Margin,
        vanish: &[Margin],
    ) -> Option<(EventSystem, Node, f64, Vec<(Watch, usize)>)> {
        let signature = candidate.orbit.signature.clone();
        let system = self.system.of(signature, Condition::Margin(*margin));
        let count = system.wave_unknowns();
        let parameters = node.point.len() - 2;
        let point = Vector::from_fn(count + 2, |row, _| match row {
            row if row < count => candidate.point[row],
            row => node.point[parameters + row - count],
        });
        let from = Node::on(&system, point).filter(|node| node.residual <= AT_SECOND)?;
        let (ds, tolerance) = (step.ds.min(step.steps.ds), step.steps.tolerance);
        let (node, ds, own) = walk::enter(&system, &from, ds, TRIES, tolerance, |_, to| {
            let own = vanishing(&system, &to.ok()?, vanish)?;
            let nascent = |zone: &usize| own.contains(&(Watch::Duration, *zone));
            // the event itself goes on, alone as before, and new zones do grow
            let admitted = own.contains(&(margin.watch, margin.zone))
                && own.len() <= self.own.len()
                && !candidate.nascent.iter().any(nascent);
            admitted.then_some(own)
        })?;
        Some((system, node, ds, own))
    }
}

/// Which of the margins that vanish at the beginning of a step vanish at its end too; `None` where that
/// is not admissible.
fn vanishing(system: &EventSystem, to: &Node, vanish: &[Margin]) -> Option<Vec<(Watch, usize)>> {
    let (wave, unknowns) = system.wave(&to.point, 0);
    let examination = examine(&wave, &unknowns).ok()?;
    let mut along = Vec::new();
    for margin in &examination.margins {
        let began = vanish
            .iter()
            .any(|known| known.watch == margin.watch && known.zone == margin.zone);
        if began && margin.jet.value.abs() < OWN {
            along.push((margin.watch, margin.zone));
        } else if margin.jet.value.is_nan() || margin.jet.value <= 0.0 {
            return None;
        }
    }
    Some(along)
}

impl Curve for EventCurve {
    type System = EventSystem;
    type Name = Signature;
    type Watched = Tests;
    type Event = Event;
    type Found = Solved;
    type Refusal = Refusal;
    type End = Stop;
    type Close = Close;

    /// Beside the opening of a separation zone the landing jump of a perturbation is singular, and
    /// Newton's method converges slowly at any length of step.
    const CREEP: (usize, f64) = (200, 2e-4);

    fn system(&self) -> &EventSystem {
        &self.system
    }

    fn name(&self) -> &Signature {
        self.system.signature()
    }

    fn watch(&self, node: &Node, near: Option<&Tests>) -> Result<Tests, Refusal> {
        let cusp = near.and_then(|near| near.cusp.as_ref());
        self.tests(node, cusp.map(|(_, left)| left))
    }

    /// Whether a margin vanishes twice.
    fn within(&self, step: &Stage, located: &[(Place, Event)]) -> Within<Close> {
        let ends = |event: &Event| !matches!(event, Event::Fold | Event::Cusp);
        let end = located.iter().find(|(_, event)| ends(event));
        let end = end.map_or(f64::INFINITY, |(place, _)| place.s - step.at_once());
        let mut close = None;
        let mut pair = f64::INFINITY;
        let after = &step.after.examination.margins;
        for (index, margin) in step.before.examination.margins.iter().enumerate() {
            let same = |other: &&Margin| (other.watch, other.zone) == (margin.watch, margin.zone);
            let own = self.own.contains(&(margin.watch, margin.zone));
            let Some(other) = after.iter().position(|other| same(&other)).filter(|_| !own) else {
                continue;
            };
            let ends = [
                (margin.jet.value, step.before.slopes[index]),
                (after[other].jet.value, step.after.slopes[other]),
            ];
            // margins at zero belong to the point the step starts from
            if ends[0].0 <= OWN || ends[1].0 <= 0.0 {
                continue;
            }
            let tolerance = step.steps.tolerance;
            let least = locate::least(&self.system, step.from, step.ds, ends, tolerance, |node| {
                let (wave, unknowns) = self.system.wave(&node.point, 0);
                let examination = examine(&wave, &unknowns).ok()?;
                let margin = examination.find(margin.watch, margin.zone)?;
                Some((margin.jet.value, self.slopes(node, &[*margin]).ok()?[0]))
            });
            let (wave, _) = self.system.wave(&step.from.point, 0);
            match least {
                Least::Found(place, _) if place.s >= end => {}
                Least::Found(place, value) if value < -ROUNDED => pair = pair.min(place.s),
                Least::Found(place, value) if value <= ROUNDED => {
                    close.get_or_insert((place.s, Close::Margin(wave.held(margin))));
                }
                Least::NotFound if step.ds < end => {
                    close.get_or_insert((step.ds, Close::Margin(wave.held(margin))));
                }
                _ => {}
            }
        }
        match close {
            _ if pair.is_finite() => Within::Pair(pair),
            Some((s, what)) => Within::Close(s, what),
            None => Within::Nothing,
        }
    }

    fn doubted(&self, mut found: Solved, close: Close) -> Solved {
        if found.point.what.is_empty() {
            found.point.what = What::Close(close).to_string();
        }
        found
    }

    fn locate(&self, step: &Stage) -> Result<Vec<(Place, Event)>, Refusal> {
        let mut located = self.edges(step).ok_or(Refusal::NotLocated)?;
        located.extend(self.margins(step)?);
        located.extend(self.signs(step)?);
        Ok(located)
    }

    fn meet(
        &self,
        step: &Stage,
        place: &Place,
        together: &[Event],
    ) -> Result<Outcome<EventCurve>, Refusal> {
        let mut solved = self.point(place.s, &place.node, step.after);
        let mut say = |kind: PointType, what: &What| {
            solved.point.kind = Some(kind);
            solved.point.what = what.to_string();
        };
        let there = End::Own(Stop::There);
        Ok(match together[0] {
            Event::Edge(index, value) => {
                let parameter = self.system.parameters()[index];
                say(PointType::One(EventType::EP), &What::Edge(parameter, value));
                // exactly the value that was asked for
                solved.point.parameters[index] = value;
                Outcome::Ended(vec![solved], End::Edge)
            }
            Event::Margin(_) => {
                let margins = together.iter().filter_map(|event| match event {
                    Event::Margin(margin) => Some(*margin),
                    _ => None,
                });
                let mut margins: Vec<Margin> = margins.collect();
                // a zone without length says most about what comes next
                margins.sort_by_key(|margin| margin.watch != Watch::Duration);
                let second = self.second(&place.node.point, &margins[0], step.steps.tolerance);
                let mut entries = margins.iter();
                let entry = entries.find_map(|margin| self.enter(step, &place.node, margin));
                let kind = PointType::Two(self.event, second.kind);
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
                say(PointType::Two(self.event, EventType::LP), &What::Fold);
                Outcome::Passed(solved)
            }
            Event::Cusp => {
                say(PointType::CP, &What::Cusp);
                Outcome::Passed(solved)
            }
            Event::ZeroOmega => {
                say(PointType::BT, &What::ZeroOmega);
                Outcome::Ended(vec![solved], there)
            }
        })
    }

    fn arrive(&mut self, node: &Node) {
        self.system.settle(&node.point);
    }

    fn point(&self, _: f64, node: &Node, _: &Tests) -> Solved {
        let (wave, unknowns) = self.system.wave(&node.point, 0);
        let before = wave.signature.to_string();
        let after = match self.system.condition {
            Condition::Margin(margin) => {
                let here = AtZero { margin }
                    .margin_at(&wave, &unknowns)
                    .unwrap_or(margin);
                successor(&wave, &unknowns, &here, self.limits.steps.tolerance)
                    .map_or_else(String::new, |after| after.to_string())
            }
            _ => before.clone(),
        };
        Solved {
            point: Point {
                parameters: self.system.values(&node.point),
                speed: wave.speed_at(&unknowns),
                excess: wave.excess_at(&unknowns),
                before,
                after,
                omega: self.system.omega(&node.point),
                kind: None,
                what: String::new(),
                newton: node.newton,
                residual: newton::jacobian(&self.system, &node.point)
                    .map_or(node.residual, |(_, residual)| residual),
            },
            system: self.system.clone(),
            unknowns: node.point.clone(),
        }
    }

    fn closing(&self, _: f64, _: &Node, reached: Solved) -> Solved {
        reached
    }

    fn ends_with(&self, refusal: &Refusal) -> Option<Stop> {
        match refusal {
            Refusal::Gone(gone) => Some(Stop::Gone(*gone)),
            _ => None,
        }
    }
}

/// The signature beyond a change of regime.
fn successor(wave: &Wave, point: &Vector, margin: &Margin, tolerance: f64) -> Option<Signature> {
    beyond(wave, point, margin, INTO, tolerance)
        .beyond
        .map(|beyond| beyond.orbit.signature)
}
