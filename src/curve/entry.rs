//! The curve of an event beyond a point at which another inequality fails.

use super::event::{CurveRefusal, EventCurve, INTO, OWN, Stage};
use super::located::StepEvent;
use super::plane::{EventCondition, FailureOf, MarginOf, ParameterPlane};
use super::point::{PointType, What};
use super::system::EventSystem;
use crate::continuation::Node;
use crate::continuation::locate::Place;
use crate::continuation::walk::{self, Curve as _, CurveBeginning};
use crate::linalg::Vector;
use crate::orbit::change::nearest_beyond;
use crate::orbit::special::Change;
use crate::orbit::{Candidate, Examined, Orbit};

/// Margins and residuals of a candidate below this vanish at the point where two events meet: it is
/// known to 1e-12 or better, and reduced switching functions of nascent zones amplify that.
const AT_SECOND: f64 = 1e-8;

/// Lengths of the first step tried into a candidate.
const TRIES: usize = 8;

/// Type of a point where a second event is met, what is said of it, and the curve beyond.
type MetEvent<P> = (
    PointType,
    What<<P as ParameterPlane>::Orbit>,
    Option<CurveBeginning<EventCurve<P>>>,
);

impl<P: ParameterPlane> EventCurve<P> {
    /// Where further margins vanish: the type of the point, what is said of it, and the curve that goes on, if one does.
    pub(super) fn second_event(
        &self,
        step: &Stage<P>,
        place: &Place,
        together: &[StepEvent<P>],
    ) -> Result<MetEvent<P>, CurveRefusal<P>> {
        let margins = together.iter().filter_map(|event| match event {
            StepEvent::Margin(margin) => Some(margin.clone()),
            _ => None,
        });
        let mut margins: Vec<MarginOf<P>> = margins.collect();
        // a zone without length says most about what comes next
        margins.sort_by_key(P::Orbit::precedence);
        let second = self.second(&place.node.point, &margins[0], step.steps.tolerance);
        let second = second.map_err(CurveRefusal::Flow)?;
        let mut entries = margins.iter();
        let entry = entries.find_map(|margin| self.enter(step, &place.node, margin));
        let kind = P::with_event(self.event, second.kind);
        let what = What::Meeting {
            second: Box::new(second),
            may_go_on: matches!(self.system.condition, EventCondition::Margin(_)),
            next: entry.as_ref().map(|entry| entry.curve.name().clone()),
        };
        Ok((kind, what, entry))
    }

    /// The change of regime where another margin vanishes.
    pub(super) fn second(
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
    pub(super) fn enter(
        &self,
        step: &Stage<P>,
        node: &Node,
        second: &MarginOf<P>,
    ) -> Option<CurveBeginning<EventCurve<P>>> {
        let EventCondition::Margin(first) = &self.system.condition else {
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
                    return Some(CurveBeginning {
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
        let system = self
            .system
            .of(signature, EventCondition::Margin(margin.clone()));
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
fn is_duration<P: ParameterPlane>(margin: &MarginOf<P>) -> bool {
    P::Orbit::precedence(margin) == 0
}

/// Which of the margins that vanish at the beginning of a step vanish at its end too; `None` where that
/// is not admissible.
fn vanishing<P: ParameterPlane>(
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

/// The orbit beyond a change of regime, and the event in its unknowns.
pub(super) fn successor<O: Orbit>(
    orbit: &O,
    point: &Vector,
    margin: &O::Margin,
    tolerance: f64,
) -> Option<(O, Node)> {
    let beyond = nearest_beyond(orbit, point, margin, INTO, tolerance)?;
    Some((beyond.orbit, beyond.node))
}
