//! An event in two parameters as a curve for the walker.

use super::entry::successor;
use super::event::{CurveRefusal, CurveStop, EventCurve, OWN, Solved, Stage, Tests};
use super::located::StepEvent;
use super::plane::{EventCondition, MarginOf, ParameterPlane, SignatureOf};
use super::point::{CurvePoint, PointType, What};
use super::system::EventSystem;
use crate::continuation::Node;
use crate::continuation::locate::{self, LeastWithin, Place};
use crate::continuation::newton;
use crate::continuation::walk::{Curve, End, Outcome, WatchedCurve, Within};
use crate::orbit::special::{Change, Close};
use crate::orbit::{CoordinateChanges, EventType, Examined, Inequalities, MarginFunction, Zones};

/// A least margin within this of zero is zero but for rounding: points of a curve are known to 1e-12.
const ROUNDED: f64 = 1e-12;

impl<P: ParameterPlane> WatchedCurve for EventCurve<P> {
    type System = EventSystem<P>;
    type Name = SignatureOf<P>;
    type Watched = Tests<P>;
    type Event = StepEvent<P>;
    type Found = Solved<P>;
    type Refusal = CurveRefusal<P>;
    type End = CurveStop;
    type Close = Close<<P::Orbit as Inequalities>::Inequality>;
    /// Beside the opening of a separation zone the landing jump of a perturbation is singular, and
    /// Newton's method converges slowly at any length of step.
    const CREEP: (usize, f64) = (200, 2e-4);

    fn system(&self) -> &EventSystem<P> {
        &self.system
    }

    fn name(&self) -> &SignatureOf<P> {
        self.system.signature()
    }

    fn watch(&self, node: &Node, near: Option<&Tests<P>>) -> Result<Tests<P>, CurveRefusal<P>> {
        let cusp = near.and_then(|near| near.cusp.as_ref());
        self.tests(node, cusp.map(|(_, left)| left))
    }

    /// Whether a margin vanishes twice.
    fn within(
        &self,
        step: &Stage<P>,
        located: &[(Place, StepEvent<P>)],
    ) -> Within<Close<<P::Orbit as Inequalities>::Inequality>> {
        let ends = |event: &StepEvent<P>| match event {
            StepEvent::Fold | StepEvent::Cusp | StepEvent::Passing(_) => false,
            StepEvent::Other(test) => test.ends,
            StepEvent::Edge(..)
            | StepEvent::Margin(_)
            | StepEvent::Limit(..)
            | StepEvent::Closing(_) => true,
        };
        let with_zone = located.iter().flat_map(|(_, event)| match event {
            StepEvent::Closing(closing) => &closing.vanishing[..],
            _ => &[],
        });
        let with_zone: Vec<_> = with_zone.collect();
        let end = located.iter().find(|(_, event)| ends(event));
        let end = end.map_or(f64::INFINITY, |(place, _)| place.s - step.at_once());
        let mut close = None;
        let mut pair = f64::INFINITY;
        let after = step.after.examination.margins();
        for (index, margin) in step.before.examination.margins().iter().enumerate() {
            let same = |other: &MarginOf<P>| P::key(other) == P::key(margin);
            let key = P::key(margin);
            let own = self.own.contains(&key) || with_zone.contains(&&key);
            let Some(other) = after.iter().position(same).filter(|_| !own) else {
                continue;
            };
            let ends = [
                (margin.value(), step.before.slopes[index]),
                (after[other].value(), step.after.slopes[other]),
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
                Some((margin.value(), slopes[0]))
            });
            let held = || {
                let (orbit, _) = self.system.orbit(&step.from.point, 0).ok()?;
                Some(Close::Margin(orbit.inequality(margin)))
            };
            let found = match least {
                LeastWithin::Found(place, _) if place.s >= end => None,
                LeastWithin::Found(place, value) if value < -ROUNDED => {
                    pair = pair.min(place.s);
                    None
                }
                LeastWithin::Found(place, value) if value <= ROUNDED => Some(place.s),
                LeastWithin::NotFound if step.ds < end => Some(step.ds),
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

    fn doubted(
        &self,
        mut found: Solved<P>,
        close: Close<<P::Orbit as Inequalities>::Inequality>,
    ) -> Solved<P> {
        if found.point.what.is_empty() {
            found.point.what = P::say(&What::Close(close));
        }
        found
    }

    fn locate(&self, step: &Stage<P>) -> Result<Vec<(Place, StepEvent<P>)>, CurveRefusal<P>> {
        let mut located = self.edges(step).ok_or(CurveRefusal::NotLocated)?;
        let closing = self.closing(step);
        let (with_zone, signs) = match &closing {
            Some((_, closing)) => (
                &closing.vanishing[..],
                self.signs_before(step, &closing.nearest)?,
            ),
            None => (&[][..], self.signs(step)?),
        };
        let ends = |event: &StepEvent<P>| matches!(event, StepEvent::Other(test) if test.ends);
        let is_ended = signs.iter().any(|(_, event)| ends(event));
        located.extend(self.margins(step, with_zone, is_ended)?);
        located.extend(signs);
        let closing = closing.map(|(place, closing)| (place, StepEvent::Closing(closing)));
        located.extend(closing);
        located.extend(self.limit(step)?);
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
        together: &[StepEvent<P>],
    ) -> Result<Outcome<EventCurve<P>>, CurveRefusal<P>> {
        let mut solved = self.point(place.s, &place.node, step.after);
        let there = End::Own(CurveStop::There);
        // where a pair meets at ±1 there is a fold or a doubling, too: the end goes first
        let ends = |event: &&StepEvent<P>| matches!(event, StepEvent::Other(test) if test.ends);
        let first = together.iter().find(ends).unwrap_or(&together[0]);
        Ok(match first {
            StepEvent::Edge(index, value) => {
                let (index, value) = (*index, *value);
                let parameter = self.system.parameters()[index].clone();
                let what = What::Edge(parameter, value);
                solved.say(PointType::One(EventType::EP), &what);
                // exactly the value that was asked for
                solved.point.parameters[index] = value;
                Outcome::Ended(vec![solved], End::Edge)
            }
            StepEvent::Margin(_) => {
                let (kind, what, entry) = self.second_event(step, place, together)?;
                solved.say(kind, &what);
                match entry {
                    Some(entry) => Outcome::Entered(vec![solved], entry),
                    None => Outcome::Ended(vec![solved], there),
                }
            }
            StepEvent::Fold => {
                solved.say(P::with_fold(self.event), &What::Fold);
                Outcome::Passed(solved)
            }
            StepEvent::Cusp => {
                solved.say(PointType::CP, &What::Cusp);
                Outcome::Passed(solved)
            }
            StepEvent::Passing(outside) => {
                solved.point.what = P::say(&What::Passing(*outside));
                Outcome::Passed(solved)
            }
            StepEvent::Limit(point, error) => {
                let orbit = self.system.orbit(&place.node.point, 0);
                let (orbit, unknowns) = orbit.map_err(CurveRefusal::Flow)?;
                let kind = P::at_limit(self.event, &self.system.condition, &orbit, &unknowns);
                let error = *error;
                solved.say(kind, &What::Limit { kind, error });
                solved.point.parameters = self.system.values(point);
                if let Ok((orbit, unknowns)) = self.system.orbit(point, 0) {
                    (solved.point.measure, _) = P::measure(&orbit, &unknowns);
                }
                Outcome::Ended(vec![solved], there)
            }
            StepEvent::Closing(closing) => {
                let (orbit, unknowns) = self
                    .system
                    .orbit(&closing.point, 0)
                    .map_err(CurveRefusal::Flow)?;
                let second = Change::new(&orbit, None, closing.margin.clone());
                let kind = P::with_event(self.event, second.kind);
                let what = What::Meeting {
                    second: Box::new(second),
                    may_go_on: true,
                    next: None,
                };
                solved.say(kind, &what);
                solved.point.parameters = self.system.values(&closing.point);
                (solved.point.measure, _) = P::measure(&orbit, &unknowns);
                Outcome::Ended(vec![solved], there)
            }
            StepEvent::Other(test) => {
                let kind = match test.kind {
                    Some(PointType::One(other)) => Some(P::with_event(self.event, other)),
                    kind => kind,
                };
                if let Some(kind) = kind {
                    solved.say(kind, &What::Other(kind));
                }
                match test.ends {
                    true => Outcome::Ended(vec![solved], there),
                    false => Outcome::Passed(solved),
                }
            }
        })
    }

    fn arrive(&mut self, node: &mut Node, _: &Self::Watched, _: &[(Place, Self::Event)]) {
        self.system.settle(&node.point);
        let further = self.system.further(&node.point);
        let renewed = match &self.system.condition {
            EventCondition::Spectral(spectral) => P::renewed(spectral, further),
            _ => None,
        };
        if let Some((spectral, further)) = renewed {
            let signature = self.system.signature().clone();
            let system = self
                .system
                .of(signature, EventCondition::Spectral(spectral));
            if let Some(renewed) = system.with_further(node, &further) {
                self.system = system;
                *node = renewed;
            }
        }
    }

    fn point(&self, _: f64, node: &Node, _: &Tests<P>) -> Solved<P> {
        let mut point = CurvePoint {
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
                EventCondition::Margin(margin) => {
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
}

impl<P: ParameterPlane> Curve for EventCurve<P> {
    fn stretch(&self, node: &Node) -> f64 {
        P::stretch(&node.point.as_slice()[..self.system.orbit_unknowns()])
    }

    fn renewed(
        &self,
        node: &Node,
        tests: &Tests<P>,
        creeps: bool,
    ) -> Option<(EventCurve<P>, Node, Tests<P>)> {
        let (orbit, own) = self.system.orbit(&node.point, 0).ok()?;
        let renewed = orbit.renewed(&own, &tests.examination, creeps)?;
        let (system, node) = self.system.renewed(&orbit, &renewed, node)?;
        let curve = EventCurve {
            system,
            ..self.clone()
        };
        let tests = curve.watch(&node, None).ok()?;
        Some((curve, node, tests))
    }

    fn aliases(&self, name: &SignatureOf<P>, first: &Node, near: &Node) -> Vec<Node> {
        /// Points whose states or parameters are further apart, in their units, are not the same: far beyond a step.
        const FAR: f64 = 1.0;
        // one begun in fewer shots is not carried into those that the curve has come to
        if name != self.name() || first.point.len() != near.point.len() {
            return Vec::new();
        }
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

    fn ends_with(&self, refusal: &CurveRefusal<P>) -> Option<CurveStop> {
        match refusal {
            CurveRefusal::Gone(gone) => Some(CurveStop::Gone(gone.clone())),
            _ => None,
        }
    }
}
