//! The curve of an event beyond a point at which another inequality fails.

use super::event::{CurveRefusal, EventCurve, INTO, OWN, Stage};
use super::located::StepEvent;
use super::plane::{EventCondition, FailureOf, MarginOf, ParameterPlane, PlaneOfOrbits};
use super::point::{PointType, What};
use super::system::EventSystem;
use crate::continuation::Node;
use crate::continuation::locate::Place;
use crate::continuation::walk::{self, CurveBeginning, WatchedCurve as _};
use crate::linalg::Vector;
use crate::orbit::change::nearest_beyond;
use crate::orbit::special::Change;
use crate::orbit::{Candidate, Changes, Examined, Inequalities, MarginFunction, Orbit, Zones};

/// Margins and residuals of a candidate below this vanish at the point where two events meet: it is
/// known to 1e-12 or better, and reduced switching functions of nascent zones amplify that.
const AT_SECOND: f64 = 1e-8;

/// Lengths of the first step tried into a candidate.
const TRIES: usize = 8;

/// Type of a point where a second event is met, what is said of it, and the curve beyond.
type MetEvent<P> = (
    PointType,
    What<<P as PlaneOfOrbits>::Orbit>,
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
        margins.sort_by_key(MarginFunction::precedence);
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

    /// The same event of the orbit beyond a change of regime, a step into it being admissible. Where several sequences have it,
    /// one in whose zone it keeps its name comes first.
    pub(super) fn enter(
        &self,
        step: &Stage<P>,
        node: &Node,
        second: &MarginOf<P>,
    ) -> Option<CurveBeginning<EventCurve<P>>> {
        let EventCondition::Margin(first) = &self.system.condition else {
            return None;
        };
        let (orbit, unknowns) = self.system.orbit(&node.point, 0).ok()?;
        let unknowns = self.lasting(&orbit, unknowns)?;
        let here = orbit.margin_at(second, &unknowns).ok()?;
        let event = Identity::<P>::of(&orbit, first);
        let mut entries = Vec::new();
        for candidate in orbit.candidates(&unknowns, &here).ok()? {
            let Ok(examination) = candidate.orbit.examination(&candidate.point) else {
                continue;
            };
            let margins = examination.margins().iter();
            let vanish: Vec<MarginOf<P>> = margins
                .filter(|margin| margin.value().abs() < AT_SECOND)
                .cloned()
                .collect();
            let is_nascent = |margin: &MarginOf<P>| {
                is_duration::<P>(margin) && candidate.nascent.contains(&P::key(margin).1)
            };
            let known = vanish.iter().filter_map(|margin| {
                let is_renamed = event.is_renamed(&Identity::of(&candidate.orbit, margin))?;
                Some((is_nascent(margin), is_renamed, margin.clone()))
            });
            let mut known: Vec<_> = known.collect();
            // its zone may be another one beyond, but none that opens beside it
            let lasts = known.iter().any(|(is_nascent, ..)| !is_nascent);
            known.retain(|(is_nascent, ..)| !is_nascent || !lasts && event.guards.is_some());
            entries.extend(known.into_iter().map(|(is_nascent, is_renamed, margin)| {
                let entry = (candidate.clone(), margin, vanish.clone());
                ((is_nascent, is_renamed), entry)
            }));
        }
        entries.sort_by_key(|(order, _)| *order);
        entries.iter().find_map(|(_, (candidate, margin, vanish))| {
            let (system, node, ds, own) =
                self.enter_candidate(step, node, candidate, margin, vanish)?;
            let next = EventCurve::new(system, self.event, &node.point, self.limits).ok()?;
            let curve = EventCurve { own, ..next };
            let watched = curve.tests(&node, None).ok()?;
            Some(CurveBeginning {
                curve,
                node,
                watched,
                ds,
            })
        })
    }

    /// Unknowns in which zones that have no length along the whole curve have one: those of exactly none are taken for zones
    /// that open.
    fn lasting(&self, orbit: &P::Orbit, mut unknowns: Vector) -> Option<Vector> {
        /// In units of time; far below rounding.
        const LEAST: f64 = 1e-200;
        let examination = orbit.examination(&unknowns).ok()?;
        let own =
            |margin: &&MarginOf<P>| is_duration::<P>(margin) && self.own.contains(&P::key(margin));
        for margin in examination.margins().iter().filter(own) {
            let duration = &mut unknowns[orbit.duration_index(P::key(margin).1)];
            if *duration == 0.0 {
                *duration = LEAST;
            }
        }
        Some(unknowns)
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
                let event = P::key(margin);
                let nascent = |margin: &MarginOf<P>| {
                    let key = P::key(margin);
                    is_duration::<P>(margin)
                        && candidate.nascent.contains(&key.1)
                        && key != event
                        && own.contains(&key)
                };
                // the event itself goes on, alone as before, and new zones do grow
                let admitted = own.contains(&event)
                    && own.len() <= self.own.len()
                    && !vanish.iter().any(nascent);
                admitted.then_some(own)
            },
        )?;
        Some((system, node, ds, own))
    }
}

/// What tells an event from others at one point.
struct Identity<P: ParameterPlane> {
    /// What its margin measures.
    watch: P::Watch,
    /// Name of the zone.
    zone: String,
    /// The guards whose zeros meet, where these tell.
    guards: Option<[String; 2]>,
}

impl<P: ParameterPlane> Identity<P> {
    fn of(orbit: &P::Orbit, margin: &MarginOf<P>) -> Identity<P> {
        let (watch, zone) = P::key(margin);
        Identity {
            watch,
            zone: P::zone(orbit.signature(), zone),
            guards: P::guards_of_duration(orbit, margin),
        }
    }

    /// Whether the zone has another name in another orbit; `None` where the event is not the same. Where two zeros swap their
    /// order, the zone between them may be any.
    fn is_renamed(&self, other: &Identity<P>) -> Option<bool> {
        let is_renamed = self.zone != other.zone;
        let is_same = match (&self.guards, &other.guards) {
            (Some(guards), Some(of_other)) => guards == of_other,
            (None, None) => !is_renamed,
            _ => false,
        };
        (is_same && self.watch == other.watch).then_some(is_renamed)
    }
}

/// Whether a margin is the duration of a zone, which says most about what comes next.
fn is_duration<P: ParameterPlane>(margin: &MarginOf<P>) -> bool {
    margin.precedence() == 0
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
        let (key, value) = (P::key(margin), margin.value());
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
