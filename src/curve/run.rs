//! A curve of events from its beginning to both ends, step by step, and its state between two steps.

use super::event::{CurveRefusal, CurveStop, EventCurve, Solved};
use super::plane::{EventCondition, FailureOf, NotEvaluated, ParameterPlane};
use super::point::{CurveLimits, CurvePoint, PointType, Region, What};
use super::regions;
use super::saved::{CurveEnd, CurveEndReason, CurveHead, CurveState, CurveStep, Next, SolvedPoint};
use super::system::EventSystem;
use super::tube::WavesInPlane;
use super::whole::WholeCurve;
use crate::continuation::Node;
use crate::continuation::arclength::NODES_BEFORE;
use crate::continuation::newton;
use crate::continuation::walk::{self, Walker};
use crate::linalg::{self, Vector};
use crate::orbit::{EventType, Zones};

/// Why the curve of an event cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Singular<P: ParameterPlane = WavesInPlane> {
    /// Its equations cannot be evaluated.
    #[error("{0}")]
    NotEvaluated(NotEvaluated<P>),
    /// Its test functions cannot be evaluated, or it is none.
    #[error("{0}")]
    Refused(CurveRefusal<P>),
    /// F_x has no null vector at a fold.
    #[error("the fold has no null vector")]
    NoNullVector,
    /// No margin vanishes at a change of regime.
    #[error("no margin vanishes at the event")]
    NoMargin,
    /// The monitor that is to be constant has no value.
    #[error("the monitor has no value at the first orbit")]
    NoValue,
    /// Its Jacobian has no null vector.
    #[error("the event has no tangent")]
    NoTangent,
    /// Newton's method does not find it.
    #[error("the event of the branch is no solution: {0}")]
    NoSolution(newton::Failure<NotEvaluated<P>>),
    /// A saved event is not one of its equations.
    #[error("the event does not fit its equations")]
    UnfitEvent,
    /// A saved point is not one of its equations.
    #[error("a point does not fit its equations")]
    UnfitPoint,
    /// A saved state is not one of its equations.
    #[error("the saved state does not fit its equations")]
    UnfitState,
    /// There are steps after the last.
    #[error("there are steps beyond the end")]
    BeyondEnd,
}

impl<P: ParameterPlane> Singular<P> {
    /// The orbit cannot be evaluated.
    pub(super) fn flow(failure: FailureOf<P>) -> Singular<P> {
        Singular::NotEvaluated(NotEvaluated::Flow(failure))
    }
}

/// A curve being followed, from its event, first one way and then the other.
pub struct CurveRun<P: ParameterPlane = WavesInPlane> {
    head: CurveHead<P>,
    /// Points on either side, away from the event.
    halves: [Vec<Solved<P>>; 2],
    ends: Vec<CurveEnd<P>>,
    walker: Walker<EventCurve<P>>,
}

/// Follows an event of waves both ways from a solution of its equations.
///
/// # Errors
/// When the start does not solve the equations, or has no tangent.
pub fn follow(
    system: &EventSystem,
    event: EventType,
    start: &Vector,
    limits: CurveLimits,
) -> Result<WholeCurve, Singular> {
    let mut run = CurveRun::begin(system, event, start, limits)?;
    while run.step()?.is_some() {}
    Ok(run.curve())
}

impl<P: ParameterPlane> CurveRun<P> {
    /// Begins at a solution of the equations.
    ///
    /// # Errors
    /// When it is none, or has no tangent.
    pub fn begin(
        system: &EventSystem<P>,
        event: EventType,
        start: &Vector,
        limits: CurveLimits,
    ) -> Result<CurveRun<P>, Singular<P>> {
        let mut system = system.clone();
        let node = first_node(&system, start, limits.steps.tolerance)?;
        system.settle(&node.point);
        let walker = walker(&system, event, node.backwards(), limits)?;
        let mut point = walker.here().point;
        point.kind = Some(PointType::One(event));
        point.what = P::say(&What::Begins);
        // the values of the problem where polishing moved them by rounding only
        for (value, given) in point.parameters.iter_mut().zip(system.values(start)) {
            if (*value - given).abs() <= 1e-13 * given.abs().max(1e-3) {
                *value = given;
            }
        }
        let head = CurveHead {
            event,
            system,
            limits,
            point,
            unknowns: node.point.as_slice().to_vec(),
            tangent: node.tangent.as_slice().to_vec(),
        };
        Ok(CurveRun {
            head,
            halves: [Vec::new(), Vec::new()],
            ends: Vec::new(),
            walker,
        })
    }

    /// Goes on after the steps of an earlier run.
    ///
    /// # Errors
    /// When they do not fit.
    pub fn resume(
        head: CurveHead<P>,
        steps: Vec<CurveStep<P>>,
    ) -> Result<CurveRun<P>, Singular<P>> {
        let mut run = CurveRun {
            walker: head.walker(0)?,
            head,
            halves: [Vec::new(), Vec::new()],
            ends: Vec::new(),
        };
        let count = steps.len();
        for (index, step) in steps.into_iter().enumerate() {
            if run.ended() {
                return Err(Singular::BeyondEnd);
            }
            for found in step.found {
                let system = run.head.system.of(found.signature, found.condition);
                let unknowns = Vector::from_vec(found.unknowns);
                if !system.fits(&unknowns) {
                    return Err(Singular::UnfitPoint);
                }
                run.halves[run.ends.len()].push(Solved {
                    point: found.point,
                    system,
                    unknowns,
                });
            }
            match step.next {
                Next::Ended(end) => run.end(end)?,
                Next::Going(state) if index + 1 == count => {
                    run.walker = resumed(&run.walker, &run.head, *state)?;
                }
                Next::Going(_) => {}
            }
        }
        Ok(run)
    }

    /// What the curve begins with.
    pub fn head(&self) -> &CurveHead<P> {
        &self.head
    }

    /// Where the curve is, in words.
    pub fn position(&self) -> String {
        let parameters = self.head.system.parameters();
        let [first, second] = parameters.each_ref().map(<P::Orbit as Zones>::column);
        let half = &self.halves[self.ends.len().min(1)];
        let point = half.last().map_or(&self.head.point, |solved| &solved.point);
        format!(
            "{} points, {first} {:.6}, {second} {:.6}",
            1 + self.halves[0].len() + self.halves[1].len(),
            point.parameters[0],
            point.parameters[1]
        )
    }

    /// Share of the way to both ends that lies behind, for progress: a side of the curve ends where it leaves the ranges of the
    /// parameters, or earlier.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn part(&self) -> f64 {
        let side = self.ends.len().min(1);
        let (Some(first), Some(last)) = (self.halves[side].first(), self.halves[side].last())
        else {
            return self.ends.len() as f64 / 2.0;
        };
        let parts = [0, 1].map(|index| {
            let (low, high) = self.head.limits.ranges[index];
            let [from, towards, here] =
                [&self.head.point, &first.point, &last.point].map(|point| point.parameters[index]);
            // the edge that this parameter set out for
            let edge = if towards < from { low } else { high };
            (here - from) / (edge - from)
        });
        let [one, other] = parts.map(|part| {
            if part.is_finite() {
                part.clamp(0.0, 1.0)
            } else {
                0.0
            }
        });
        (self.ends.len() as f64 + one.max(other)).min(2.0) / 2.0
    }

    /// The points in the order in which they were found.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn so_far(&self) -> impl Iterator<Item = &CurvePoint> {
        let [first, second] = &self.halves;
        let found = first.iter().chain(second).map(|solved| &solved.point);
        std::iter::once(&self.head.point).chain(found)
    }

    /// Whether an earlier version has saved why it ended, in words.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn is_of_earlier_version(&self) -> bool {
        self.ends
            .iter()
            .any(|end| end.reason == CurveEndReason::Unknown)
    }

    /// Whether both ends are reached.
    fn ended(&self) -> bool {
        self.ends.len() == 2
    }

    /// Takes a step; `None` when both ends are reached.
    ///
    /// # Errors
    /// When the curve does not begin the other way.
    pub fn step(&mut self) -> Result<Option<CurveStep<P>>, Singular<P>> {
        if self.ended() {
            return Ok(None);
        }
        let half = &mut self.halves[self.ends.len()];
        let most = self.head.limits.most_points;
        let (found, end) = match half.len() >= most {
            true => (Vec::new(), Some(walk::End::MaxPoints { most })),
            false => self.walker.step(),
        };
        half.extend(found.iter().cloned());
        let standing = end
            .is_none()
            .then(|| standing(half, &self.head.limits))
            .flatten();
        let found = found.into_iter().map(|solved| SolvedPoint {
            point: solved.point,
            signature: solved.system.signature().clone(),
            condition: solved.system.condition.clone(),
            unknowns: solved.unknowns.as_slice().to_vec(),
        });
        let found = found.collect();
        let reason = end.map(|end| self.reason(end)).or(standing);
        let next = match reason {
            Some(reason) => {
                let end = CurveEnd::new(reason);
                self.end(end.clone())?;
                Next::Ended(end)
            }
            None => Next::Going(Box::new(state(&self.walker))),
        };
        Ok(Some(CurveStep { found, next }))
    }

    fn reason(&self, end: walk::EndOf<EventCurve<P>>) -> CurveEndReason<P> {
        match end {
            walk::End::Edge | walk::End::Own(CurveStop::There) => CurveEndReason::There,
            walk::End::Own(CurveStop::Gone(gone)) => CurveEndReason::Gone(gone),
            walk::End::Closed => CurveEndReason::Closed,
            walk::End::MaxPoints { most } => CurveEndReason::MaxPoints { most },
            walk::End::NoStep { ds_min, reason } => CurveEndReason::NoStep { ds_min, reason },
            walk::End::Creeps { steps, longest } => CurveEndReason::Creeps {
                steps,
                longest,
                beside: self.shortest(),
            },
        }
    }

    /// Name and length of the shortest zone where the curve is.
    fn shortest(&self) -> (String, f64) {
        let system = &self.walker.curve().system;
        let signature = system.signature();
        let at = system.orbit(&self.walker.node().point, 0).ok();
        let length = |zone: usize| {
            let at = at.as_ref();
            at.map_or(f64::NAN, |(orbit, point)| P::length(orbit, point, zone))
        };
        let lengths = (0..P::zones(signature)).map(|zone| (zone, length(zone)));
        let shortest = lengths.min_by(|one, other| one.1.total_cmp(&other.1));
        let (zone, length) = shortest.unwrap_or((0, f64::NAN));
        (P::zone(signature, zone), length)
    }

    /// Ends one direction and turns to the other.
    fn end(&mut self, end: CurveEnd<P>) -> Result<(), Singular<P>> {
        if let (Some(last), Some(kind)) = (self.halves[self.ends.len()].last_mut(), end.kind) {
            last.point.kind.get_or_insert(PointType::One(kind));
        }
        let closed = end.reason == CurveEndReason::Closed;
        self.ends.push(end.clone());
        if closed && !self.ended() {
            // the second half would be the first one backwards
            self.ends.push(end);
        } else if !self.ended() {
            self.walker = self.head.walker(1)?;
        }
        Ok(())
    }

    /// The curve without what lies beside it, which takes longer to find than the curve itself.
    pub fn unnamed(self) -> WholeCurve<P> {
        self.with(|_, _| Vec::new())
    }

    /// The curve from one end to the other, with what lies beside it.
    pub fn curve(self) -> WholeCurve<P> {
        self.with(regions::regions)
    }

    fn with(self, beside: impl FnOnce(&[Solved<P>], &CurveLimits) -> Vec<Region>) -> WholeCurve<P> {
        let CurveRun {
            head, halves, ends, ..
        } = self;
        let sector = head.sector();
        let [mut points, second] = halves;
        points.reverse();
        let start = points.len();
        points.push(Solved {
            point: head.point,
            system: head.system.clone(),
            unknowns: Vector::from_vec(head.unknowns),
        });
        points.extend(second);
        let regions = beside(&points, &head.limits);
        let reason = |index: usize| ends.get(index).map(|end| end.reason.clone());
        WholeCurve {
            event: head.event,
            sector,
            parameters: head.system.parameters(),
            columns: head.system.plane.columns(),
            points: points.into_iter().map(|solved| solved.point).collect(),
            start,
            ends: [0, 1].map(|index| reason(index).unwrap_or_default()),
            failed: ends.iter().any(|end| end.failed),
            regions,
        }
    }
}

impl<P: ParameterPlane> CurveHead<P> {
    /// Bloch sector of an HB.
    pub fn sector(&self) -> Option<usize> {
        match &self.system.condition {
            EventCondition::Spectral(spectral) => P::sector(spectral),
            _ => None,
        }
    }

    /// A walker in the first direction (0) or the second (1).
    fn walker(&self, half: usize) -> Result<Walker<EventCurve<P>>, Singular<P>> {
        let node = Node {
            point: Vector::from_column_slice(&self.unknowns),
            tangent: Vector::from_column_slice(&self.tangent),
            newton: self.point.newton,
            residual: self.point.residual,
        };
        if !(self.system.fits(&node.point) && self.system.fits(&node.tangent)) {
            return Err(Singular::UnfitEvent);
        }
        let node = if half == 0 { node.backwards() } else { node };
        walker(&self.system, self.event, node, self.limits)
    }
}

/// Whether the last points of a curve have come so little further in both parameters that going on is of no use.
fn standing<P: ParameterPlane>(
    half: &[Solved<P>],
    limits: &CurveLimits,
) -> Option<CurveEndReason<P>> {
    /// So many points, and the part of what as many of the longest steps would do, in units of the ranges. A curve that
    /// lets its orbits grow without bound comes to a limit, and one that turns sharply is beyond the turn after so many.
    const POINTS: usize = 300;
    const PART: f64 = 2.5e-3;
    let last = half.get(half.len().checked_sub(POINTS)?..)?;
    let widths = limits.widths();
    let moved = [0, 1].map(|index| {
        let values = last.iter().map(|solved| solved.point.parameters[index]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        (high - low) / widths[index]
    });
    let moved = moved[0].max(moved[1]);
    let full = POINTS as f64 * limits.steps.ds_max;
    (moved <= PART * full).then_some(CurveEndReason::Stands {
        points: POINTS,
        moved,
    })
}

/// A walker from a node.
fn walker<P: ParameterPlane>(
    system: &EventSystem<P>,
    event: EventType,
    node: Node,
    limits: CurveLimits,
) -> Result<Walker<EventCurve<P>>, Singular<P>> {
    let curve = EventCurve::new(system.clone(), event, &node.point, limits);
    let curve = curve.map_err(Singular::flow)?;
    Walker::begin(curve, node, limits.steps).map_err(Singular::Refused)
}

/// A walker at a saved state.
fn resumed<P: ParameterPlane>(
    walker: &Walker<EventCurve<P>>,
    head: &CurveHead<P>,
    state: CurveState<P>,
) -> Result<Walker<EventCurve<P>>, Singular<P>> {
    let system = head.system.of(state.signature, state.condition);
    let zones = P::zones(system.signature());
    let left = state.left.map(Vector::from_vec);
    let node = Node::at(
        Vector::from_vec(state.unknowns),
        Vector::from_vec(state.tangent),
    );
    let before = state.before.into_iter().take(NODES_BEFORE);
    let before = before
        .map(|(unknowns, tangent)| Node::at(Vector::from_vec(unknowns), Vector::from_vec(tangent)));
    let before: Vec<Node> = before.collect();
    let count = system.orbit_unknowns();
    let is_whole = |node: &Node| system.fits(&node.point) && system.fits(&node.tangent);
    let fits = is_whole(&node)
        && before.iter().all(is_whole)
        && left.as_ref().is_none_or(|left| left.len() == count)
        && state.own.iter().all(|(_, zone)| *zone < zones);
    if !fits {
        return Err(Singular::UnfitState);
    }
    let curve = EventCurve {
        system,
        own: state.own,
        with_fold: state.with_fold,
        ..walker.curve.clone()
    };
    Ok(Walker {
        watched: curve
            .tests(&node, left.as_ref())
            .map_err(Singular::Refused)?,
        curve,
        node,
        before,
        ds: state.ds,
        travelled: state.travelled,
        creeping: state.creeping,
        ..walker.clone()
    })
}

/// The state of a walker.
fn state<P: ParameterPlane>(walker: &Walker<EventCurve<P>>) -> CurveState<P> {
    let left = walker.watched.cusp.as_ref();
    CurveState {
        signature: walker.curve.system.signature().clone(),
        condition: walker.curve.system.condition.clone(),
        unknowns: walker.node.point.as_slice().to_vec(),
        tangent: walker.node.tangent.as_slice().to_vec(),
        before: (walker.before.iter())
            .map(|Node { point, tangent, .. }| {
                [point, tangent].map(|list| list.as_slice().to_vec()).into()
            })
            .collect(),
        own: walker.curve.own.clone(),
        with_fold: walker.curve.with_fold,
        left: left.map(|(_, left)| left.as_slice().to_vec()),
        travelled: walker.travelled,
        ds: walker.ds,
        creeping: walker.creeping,
    }
}

/// The start with its unit tangent, the null vector of the Jacobian.
fn first_node<P: ParameterPlane>(
    system: &EventSystem<P>,
    start: &Vector,
    tolerance: f64,
) -> Result<Node, Singular<P>> {
    let tangent = |point: &Vector| {
        let evaluated = newton::jacobian(system, point);
        let (matrix, residual) = evaluated.map_err(Singular::NotEvaluated)?;
        let kernel = linalg::kernel(&matrix).ok_or(Singular::NoTangent)?;
        Ok::<_, Singular<P>>((kernel.null_vector, residual))
    };
    let (normal, _) = tangent(start)?;
    let mut plane = newton::Plane {
        normal: &normal,
        through: start,
    };
    let settings = newton::Settings {
        tolerance,
        most_iterations: 20,
        halvings: 4,
        polish: 1,
    };
    let solution = newton::solve(system, &mut plane, start, &settings);
    let solution = solution.map_err(Singular::NoSolution)?;
    let (mut null, residual) = tangent(&solution.point)?;
    // towards larger values of the first parameter, the second where that is stationary
    let count = null.len();
    let heading = if null[count - 2].abs() > 1e-9 {
        null[count - 2]
    } else {
        null[count - 1]
    };
    if heading < 0.0 {
        null.neg_mut();
    }
    Ok(Node {
        point: solution.point,
        tangent: null,
        newton: solution.iterations,
        residual,
    })
}
