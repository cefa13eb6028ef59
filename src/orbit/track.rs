//! Orbits of one signature as a curve for the walker: what a step watches, what an event within it means, how the curve ends.

use std::sync::Arc;

use super::crossings::{OutsideCount, outside};
use super::follow::{LocatedPoint, Track};
use super::located::{BranchEvent, LocatedEvent};
use super::monitor::MonitorStop;
use super::special::{BranchFailure, BranchTermination, Close, Ending, OrbitRefusal, Special};
use super::{Examined, MarginFunction as _, Orbit, Situation, dip, events, retrace};
use crate::continuation::arclength::{self, LARGEST_ANGLE};
use crate::continuation::locate::{Place, node_at, retangent};
use crate::continuation::walk::{self, Curve, Outcome, Segment, WatchedCurve, Within};
use crate::continuation::{Node, newton};
use crate::linalg::Vector;

/// A step along one branch turns by less but where it is long: one that comes to another branch turns from across it to along it.
const TURNS: f64 = 0.02;

impl<O: Orbit> WatchedCurve for Track<O> {
    type System = O;
    type Name = O::Signature;
    type Watched = O::Examination;
    type Event = LocatedEvent<O>;
    type Found = LocatedPoint<O>;
    type Refusal = OrbitRefusal<O>;
    type End = BranchTermination<O>;
    type Close = Close<O::Inequality>;
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
        dip::may_hide_a_pair(self.orbit.as_ref(), step)
    }

    fn within(
        &self,
        step: &Segment<O::Examination>,
        located: &[(Place, LocatedEvent<O>)],
    ) -> Within<Close<O::Inequality>> {
        dip::within(self.orbit.as_ref(), step, located)
    }

    fn doubted(&self, found: LocatedPoint<O>, close: Close<O::Inequality>) -> LocatedPoint<O> {
        LocatedPoint {
            close: Some(close),
            ..found
        }
    }

    fn locate(
        &self,
        step: &Segment<O::Examination>,
    ) -> Result<Vec<(Place, LocatedEvent<O>)>, OrbitRefusal<O>> {
        // where the branch would turn back a long step may lead on, along the one that it ends on
        let turn = (&step.to.tangent - &step.from.tangent).norm();
        if turn > TURNS
            && self
                .orbit
                .falls_on_another(&step.from.point, &step.to.point)
        {
            return Err(OrbitRefusal::NotFound);
        }
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
        if let BranchEvent::End(special, stop) = event {
            let examination = orbit.examination(&place.node.point);
            let examination = examination.map_err(OrbitRefusal::Flow)?;
            let found = LocatedPoint {
                uncertainty: *uncertainty,
                special: Some(Special::Own(special.clone())),
                ..self.point(place.s, &place.node, &examination)
            };
            return Ok(ended(found, stop.clone()));
        }
        if let Some(ended) = self.vanished(step, place) {
            return Ok(ended);
        }
        let (mut found, place) = self.located(step, place, &together[0])?;
        // the halves of an orbit traversed twice are images, too, and its parameter is stationary
        if event.may_retrace()
            && let Some(ended) = self.repeated(&found)
        {
            return Ok(ended);
        }
        if event.may_retrace()
            && let Some((special, stop)) = orbit.becomes_image(&step.from.point, &found.node.point)
            && let Some(symmetric) = self.symmetric(&found, step, &special)
        {
            found.special = Some(Special::Own(special));
            // what a test takes for its zero may be another place of the step, known to rounding
            let better = Some(symmetric).filter(|(point, error)| {
                let off = (orbit.value_at(point) - found.parameter).abs();
                *error < found.uncertainty || off > found.uncertainty + error
            });
            return Ok(ended(self.moved(found, better), stop));
        }
        match event {
            BranchEvent::End(..) => {}
            BranchEvent::Fold => {
                found.special = Some(Special::Fold(orbit.parameter()));
                found = self.moved(found, orbit.fold_near(&place.node));
            }
            BranchEvent::Image(special, stop) => {
                let found = self.mirrored(found, step, special);
                return Ok(ended(found, stop.clone()));
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
                let edge = || Special::Edge(orbit.parameter(), *value);
                found.parameter = *value;
                found.special = Some(orbit.edge(*value).map_or_else(edge, Special::Own));
                return Ok(Outcome::Ended(vec![found], walk::End::Edge));
            }
            BranchEvent::Crossing(test) => {
                found.special = orbit.crossing(*test, &place.node).map(Special::Own);
            }
            BranchEvent::Passing { outside, between } => {
                let special = orbit.passing(&place.node, *outside, *between);
                found.special = special.map(Special::Own);
            }
            BranchEvent::Change(margin) => {
                if let Some(stop) = orbit.termination(Situation::Change(margin)) {
                    let end = walk::End::Own(BranchTermination::Own(stop));
                    found.special = Some(failed(&end));
                    return Ok(Outcome::Ended(vec![found], end));
                }
                let margins = self.vanishing(step, &place, together, &found.examination);
                let outcome = self.change(found, &margins, step);
                return Ok(match orbit.is_kink(margin) {
                    true => self.round_corner(outcome),
                    false => outcome,
                });
            }
        }
        Ok(Outcome::Passed(found))
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
}

impl<O: Orbit> Curve for Track<O> {
    fn stretch(&self, node: &Node) -> f64 {
        self.orbit.stretch(&node.point)
    }

    fn renewed(
        &self,
        node: &Node,
        examination: &O::Examination,
        creeps: bool,
    ) -> Option<(Track<O>, Node, O::Examination)> {
        let orbit = self.orbit.renewed(&node.point, examination, creeps)?;
        let carried = self.orbit.carried(&orbit, node)?;
        let node = retangent(&orbit, &carried.point, &carried.tangent, node.newton)?;
        let examination = orbit.examination(&node.point).ok()?;
        let curve = Track {
            orbit: Arc::new(orbit),
            ..self.clone()
        };
        Some((curve, node, examination))
    }

    fn at_edge(&self, node: &Node, ds: f64, tolerance: f64) -> Option<(Node, f64)> {
        let orbit = self.orbit.as_ref();
        let (lower, upper) = self.limits.range;
        let index = node.point.len() - 1;
        let edges = [lower, upper].map(|edge| edge / orbit.unit());
        let along = edges.map(|value| (value, (value - node.point[index]) / node.tangent[index]));
        let (value, s) = along.into_iter().find(|(_, s)| *s > 0.0 && *s <= ds)?;
        let mut edge = newton::Fixed { index, value };
        let guess = &node.point + &node.tangent * s;
        let settings = newton::Settings {
            tolerance,
            ..newton::Settings::default()
        };
        let met = arclength::correct(orbit, &mut edge, &guess, &node.tangent, &settings);
        let (mut met, _) = met.ok()?;
        // exactly the value that was asked for, not the next number
        met.point[index] = value;
        (met.angle_to(node) <= LARGEST_ANGLE).then_some((met, s))
    }

    fn aliases(&self, name: &O::Signature, first: &Node, near: &Node) -> Vec<Node> {
        self.orbit.aliases(name, first, near)
    }

    fn exhausted(&self, node: &Node) -> Option<BranchTermination<O>> {
        let stop = self
            .orbit
            .termination(Situation::At(node, self.limits.range));
        stop.map(BranchTermination::Own)
    }

    fn leads_on(&self, node: &Node, examination: &O::Examination) -> Option<Outcome<Track<O>>> {
        self.change_from_beyond(node, examination)
    }

    fn ends_at(&self, node: &Node) -> Option<BranchTermination<O>> {
        let repeats = self.orbit.repeats(node).map(|(_, stop)| stop);
        let stop = repeats.or_else(|| self.orbit.termination(Situation::NoStep(node)));
        stop.map(BranchTermination::Own)
    }

    fn last(&self, end: &Ending<O>, here: LocatedPoint<O>) -> Option<LocatedPoint<O>> {
        let own = match end {
            walk::End::Own(BranchTermination::Own(stop)) => Some(stop),
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

/// The special point of an end that comes too early.
pub(super) fn failed<O: Orbit>(end: &Ending<O>) -> Special<O> {
    Special::Failed(BranchFailure::Ended(Box::new(end.clone())))
}

/// Where a branch that comes to an orbit traversed several times finds no step any more, its parameter is off by
/// the square of what the parts differ by, and of the order of one part of a million.
const REPEATS: f64 = 1e-6;

/// The end of a branch at a point for a reason of the system itself.
fn ended<O: Orbit>(found: LocatedPoint<O>, stop: O::Termination) -> Outcome<Track<O>> {
    Outcome::Ended(vec![found], walk::End::Own(BranchTermination::Own(stop)))
}

impl<O: Orbit> Track<O> {
    /// What comes of a kink of the equations: a row where the parameter turns back there, or where the stability changes.
    fn round_corner(&self, outcome: Outcome<Track<O>>) -> Outcome<Track<O>> {
        let Outcome::Entered(points, entry) = outcome else {
            return outcome;
        };
        let Some(corner) = points.into_iter().next() else {
            return Outcome::Entered(Vec::new(), entry);
        };
        let slope = |node: &Node| node.tangent[node.tangent.len() - 1];
        let counts = outside(&corner.examination).zip(outside(&entry.watched));
        let value = corner.parameter;
        let special = match counts {
            _ if slope(&corner.node) * slope(&entry.node) < 0.0 => {
                Some(Special::Fold(self.orbit.parameter()))
            }
            Some((before, after)) if before != after => {
                let passing = self
                    .orbit
                    .passing(&corner.node, [before, after], Some([value; 2]));
                passing.map(Special::Own)
            }
            _ => None,
        };
        let row = special.map(|special| LocatedPoint {
            special: Some(special),
            ..corner
        });
        Outcome::Entered(row.into_iter().collect(), entry)
    }

    /// The point of an event, before it is said what makes it special: where several margins vanish at once at the place
    /// where they do so together.
    fn located(
        &self,
        step: &Segment<O::Examination>,
        place: &Place,
        LocatedEvent { event, uncertainty }: &LocatedEvent<O>,
    ) -> Result<(LocatedPoint<O>, Place), OrbitRefusal<O>> {
        let orbit = self.orbit.as_ref();
        let examine = |place: &Place| {
            let examination = orbit.examination(&place.node.point);
            examination.map_err(OrbitRefusal::Flow)
        };
        let changes = matches!(event, BranchEvent::Change(_));
        let mut examination = examine(place)?;
        let (mut place, mut uncertainty) = (place.clone(), *uncertainty);
        if changes && let Some(sharper) = self.at_once(step, &place, &examination) {
            (place, uncertainty) = sharper;
            examination = examine(&place)?;
        }
        // nothing may have failed before: another event would have come first
        if !events::holds(orbit, &place, &examination) {
            return Err(OrbitRefusal::Order);
        }
        // an inequality that fails by no more than rounding
        let mut fails = examination.margins().iter();
        let fails = fails.find(|margin| !changes && margin.value() <= 0.0);
        let close = fails.map(|margin| Close::Margin(orbit.inequality(margin)));
        let found = LocatedPoint {
            uncertainty,
            close,
            ..self.point(place.s, &place.node, &examination)
        };
        Ok((found, place))
    }

    /// The symmetric orbit to which a branch comes at a point.
    fn symmetric(
        &self,
        found: &LocatedPoint<O>,
        step: &Segment<O::Examination>,
        special: &O::Special,
    ) -> Option<(Vector, f64)> {
        let side = step.from.tangent[step.from.tangent.len() - 1];
        let tolerance = step.steps.tolerance;
        retrace::symmetric(self.orbit.as_ref(), &found.node, -side, special, tolerance)
    }

    /// The point at which an orbit is its own image: known better by the equations of those on both sides.
    fn mirrored(
        &self,
        mut found: LocatedPoint<O>,
        step: &Segment<O::Examination>,
        special: &O::Special,
    ) -> LocatedPoint<O> {
        let orbit = self.orbit.as_ref();
        let sharper = self.symmetric(&found, step, special);
        if !found.uncertainty.is_finite() {
            found.uncertainty = REPEATS * found.parameter.abs().max(orbit.unit());
        }
        found.special = Some(Special::Own(special.clone()));
        self.moved(found, sharper)
    }

    /// The end of a branch where it would retrace itself: whatever test sees it there.
    fn repeated(&self, found: &LocatedPoint<O>) -> Option<Outcome<Track<O>>> {
        let (special, stop) = self.orbit.repeats(&found.node)?;
        let found = self.sharpened(LocatedPoint {
            special: Some(Special::Own(special)),
            ..found.clone()
        });
        Some(ended(found, stop))
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
}
