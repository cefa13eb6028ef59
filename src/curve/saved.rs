//! A curve between two steps: what it began with, what its steps found, and how it ended.

use serde::{Deserialize, Serialize};

use super::event::CurveRefusal;
use super::plane::{EventCondition, NotEvaluated, ParameterPlane, SignatureOf};
use super::point::{CurveLimits, CurvePoint, Gone};
use super::system::EventSystem;
use super::tube::WavesInPlane;
use crate::continuation::walk::Refused;
use crate::orbit::EventType;

/// What a curve begins with: the same for all its steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct CurveHead<P: ParameterPlane = WavesInPlane> {
    /// Type of the event.
    pub event: EventType,
    /// Its equations.
    pub system: EventSystem<P>,
    /// How far to follow.
    #[serde(rename = "settings")]
    pub limits: CurveLimits,
    /// The event on the branch.
    pub point: CurvePoint,
    /// Its unknowns.
    pub unknowns: Vec<f64>,
    /// Unit tangent there.
    pub tangent: Vec<f64>,
}

/// A point with the equations that it solves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct SolvedPoint<P: ParameterPlane = WavesInPlane> {
    /// The point.
    pub point: CurvePoint,
    pub(super) signature: SignatureOf<P>,
    pub(super) condition: EventCondition<P>,
    pub(super) unknowns: Vec<f64>,
}

/// All that the next step depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct CurveState<P: ParameterPlane = WavesInPlane> {
    pub(super) signature: SignatureOf<P>,
    pub(super) condition: EventCondition<P>,
    pub(super) unknowns: Vec<f64>,
    pub(super) tangent: Vec<f64>,
    /// Unknowns and tangents of the points before it, the last first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) before: Vec<(Vec<f64>, Vec<f64>)>,
    pub(super) own: Vec<(P::Watch, usize)>,
    pub(super) with_fold: bool,
    /// The left null vector behind the factor that vanishes at a cusp, for its sign.
    pub(super) left: Option<Vec<f64>>,
    pub(super) travelled: f64,
    pub(super) ds: f64,
    /// Steps in a row that creep.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(super) creeping: usize,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Why a curve ends in one direction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum CurveEndReason<P: ParameterPlane = WavesInPlane> {
    /// It has not ended yet, or an earlier version has said why in words.
    #[default]
    Unknown,
    /// For what happens at its last point.
    There,
    /// The event is none any more.
    Gone(Gone),
    /// The curve closes on its start.
    Closed,
    /// It has as many points as it may.
    MaxPoints {
        /// How many.
        most: usize,
    },
    /// Its steps creep.
    Creeps {
        /// How many in a row.
        steps: usize,
        /// All are shorter than this.
        longest: f64,
        /// Name and length of the shortest zone.
        beside: (String, f64),
    },
    /// It hardly moves in the plane.
    Stands {
        /// Points in a row.
        points: usize,
        /// How far apart they are at most, in units of the ranges.
        moved: f64,
    },
    /// No step succeeds.
    NoStep {
        /// The shortest one.
        ds_min: f64,
        /// Why it was refused.
        reason: Refused<NotEvaluated<P>, CurveRefusal<P>>,
    },
}

/// The end of the curve in one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct CurveEnd<P: ParameterPlane = WavesInPlane> {
    /// Why; earlier versions kept words as `reason`.
    #[serde(rename = "why", default)]
    pub reason: CurveEndReason<P>,
    /// Whether it is one of Newton's method or of `max_points` and not of the curve.
    pub failed: bool,
    /// Type of the last point unless it has one.
    pub(super) kind: Option<EventType>,
}

impl<P: ParameterPlane> CurveEnd<P> {
    pub(super) fn new(reason: CurveEndReason<P>) -> CurveEnd<P> {
        let kind = match reason {
            CurveEndReason::Unknown | CurveEndReason::There | CurveEndReason::Closed => None,
            CurveEndReason::Gone(_) => Some(EventType::EP),
            _ => Some(EventType::MX),
        };
        CurveEnd {
            reason,
            failed: kind == Some(EventType::MX),
            kind,
        }
    }
}

/// A step in either direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct CurveStep<P: ParameterPlane = WavesInPlane> {
    /// Points found, in order.
    pub found: Vec<SolvedPoint<P>>,
    /// What comes next.
    pub next: Next<P>,
}

/// What comes after a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum Next<P: ParameterPlane = WavesInPlane> {
    /// The next step.
    Going(Box<CurveState<P>>),
    /// The end in this direction.
    Ended(CurveEnd<P>),
}
