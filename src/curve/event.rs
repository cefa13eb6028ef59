//! An event as a curve in two parameters: what it is at a point, and what is watched there.

use serde::{Deserialize, Serialize};

use super::plane::{
    EventCondition, ExaminationOf, FailureOf, InadmissibleOf, MarginOf, ParameterPlane, TestValues,
};
use super::point::{CurveLimits, CurvePoint, Gone, PointType, What};
use super::system::EventSystem;
use super::tube::WavesInPlane;
use crate::continuation::Node;
use crate::continuation::walk::Segment;
use crate::linalg::{self, Vector};
use crate::orbit::{EventType, Examined, Inequalities, MarginFunction, Zones};

/// A margin below this on the event's own account is the event itself, but for rounding.
pub(super) const OWN: f64 = 1e-8;

/// F_x with a least singular value below this part of the largest is singular along the whole curve:
/// a zone without length makes the parameters stationary.
const SINGULAR: f64 = 1e-10;

/// First step into an orbit beyond an event, as on a branch.
pub(super) const INTO: f64 = 1e-3;

/// Orbits of one signature at an event, as a curve in two parameters.
#[derive(Clone, Debug)]
pub struct EventCurve<P: ParameterPlane> {
    pub(super) system: EventSystem<P>,
    pub(super) event: EventType,
    pub(super) limits: CurveLimits,
    /// Margins that vanish along the whole curve.
    pub(super) own: Vec<(P::Watch, usize)>,
    /// Whether det F_x tells a fold.
    pub(super) with_fold: bool,
}

/// Test functions at a point.
#[derive(Clone, Debug)]
pub struct Tests<P: ParameterPlane> {
    pub(super) examination: ExaminationOf<P>,
    /// The slopes of its margins along the curve.
    pub(super) slopes: Vec<f64>,
    /// det F_x where it tells a fold.
    pub(super) fold: Option<f64>,
    /// The factor that vanishes at a cusp, with the left null vector behind it.
    pub(super) cusp: Option<(f64, Vector)>,
    /// What the plane watches.
    pub(super) watched: TestValues,
}

/// A point of a curve with the equations that it solves.
#[derive(Clone, Debug)]
pub struct Solved<P: ParameterPlane = WavesInPlane> {
    pub(super) point: CurvePoint,
    pub(super) system: EventSystem<P>,
    pub(super) unknowns: Vector,
}

impl<P: ParameterPlane> Solved<P> {
    /// Makes it a special point of this type.
    pub(super) fn say(&mut self, kind: PointType, what: &What<P::Orbit>) {
        self.point.kind = Some(kind);
        self.point.what = P::say(what);
    }
}

/// Why an event refuses a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum CurveRefusal<P: ParameterPlane = WavesInPlane> {
    /// Its test functions cannot be evaluated.
    Flow(FailureOf<P>),
    /// A margin is negative from where it is first posed: the orbit there is not admissible.
    Posed(Box<InadmissibleOf<P>>),
    /// A test function changes its sign and its zero is not found.
    NotLocated,
    /// The event is none any more.
    Gone(Gone),
}

impl<P: ParameterPlane> std::error::Error for CurveRefusal<P> {}

/// Why an event ends for reasons of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveStop {
    /// At its last point, which says why.
    There,
    /// It is none any more.
    Gone(Gone),
}

pub(super) type Stage<'a, P> = Segment<'a, Tests<P>>;

impl<P: ParameterPlane> EventCurve<P> {
    /// An event at a solution of its equations.
    pub(super) fn new(
        system: EventSystem<P>,
        event: EventType,
        point: &Vector,
        limits: CurveLimits,
    ) -> Result<EventCurve<P>, FailureOf<P>> {
        let (orbit, unknowns) = system.orbit(point, 0)?;
        let examination = orbit.examination(&unknowns)?;
        let vanish = examination.margins().iter();
        let own = vanish
            .filter(|margin| margin.value().abs() < OWN)
            .map(P::key)
            .collect();
        let (_, by) = system.orbit_equations(point)?;
        let square = by.columns(0, system.orbit_unknowns()).clone_owned();
        let regular =
            linalg::least(&square).is_some_and(|least| least.value > SINGULAR * least.largest);
        Ok(EventCurve {
            with_fold: regular && P::tells_fold(&system.condition, &orbit),
            system,
            event,
            limits,
            own,
        })
    }

    /// Test functions at a node; `left` orients the left null vector. Refused where the event is none
    /// any more.
    pub(super) fn tests(
        &self,
        node: &Node,
        left: Option<&Vector>,
    ) -> Result<Tests<P>, CurveRefusal<P>> {
        let at = self
            .system
            .orbit(&node.point, 0)
            .map_err(CurveRefusal::Flow)?;
        let (orbit, unknowns) = &at;
        let examination = orbit.examination(unknowns).map_err(CurveRefusal::Flow)?;
        for own in &self.own {
            let zone = P::zone(orbit.signature(), own.1);
            let itself = match &self.system.condition {
                EventCondition::Margin(margin) => P::key(margin) == *own,
                _ => false,
            };
            let mut margins = examination.margins().iter();
            let margin = margins.find(|margin| P::key(margin) == *own);
            return Err(CurveRefusal::Gone(
                match margin.map(MarginFunction::value) {
                    Some(value) if value >= -OWN => continue,
                    Some(_) if itself => Gone::Lower(zone),
                    None if itself => Gone::Left(zone),
                    _ => Gone::Along(zone),
                },
            ));
        }
        if let EventCondition::Spectral(spectral) = &self.system.condition {
            let further = self.system.further(&node.point);
            let lost = self.system.plane.lost(spectral, orbit, unknowns, further);
            lost.map_or(Ok(()), |gone| Err(CurveRefusal::Gone(gone)))?;
        }
        let slopes = self.slopes(node, examination.margins());
        let mut tests = Tests {
            slopes: slopes.map_err(CurveRefusal::Flow)?,
            fold: None,
            cusp: None,
            watched: self.watched(&node.point, &at),
            examination,
        };
        if self.with_fold {
            tests.fold = Some(self.determinant(&node.point).map_err(CurveRefusal::Flow)?);
        } else if self.system.condition == EventCondition::Fold {
            tests.cusp = self.cusp(node, left).map_err(CurveRefusal::Flow)?;
        }
        Ok(tests)
    }

    /// What the plane watches, and the rates of guards that stay at zero where a zone begins.
    pub(super) fn watched(&self, point: &Vector, at: &(P::Orbit, Vector)) -> TestValues {
        let mut watched = self.system.watched(point, at);
        watched.tests.extend(P::onsets(at, &self.own));
        watched
    }

    /// The slopes of margins along the curve: posed in p₁ the orbit gives all but the part of p₂.
    pub(super) fn slopes(
        &self,
        node: &Node,
        margins: &[MarginOf<P>],
    ) -> Result<Vec<f64>, FailureOf<P>> {
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

    pub(super) fn determinant(&self, point: &Vector) -> Result<f64, FailureOf<P>> {
        let (_, by) = self.system.orbit_equations(point)?;
        let square = by.columns(0, self.system.orbit_unknowns()).clone_owned();
        Ok(square.determinant())
    }

    /// The factor that vanishes at a cusp, and the left null vector behind it.
    pub(super) fn cusp(
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
}
