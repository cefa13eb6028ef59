//! A curve between two steps: what it began with, what its steps found, and how it ended.

use serde::{Deserialize, Serialize};

use super::event::Refusal;
use super::plane::{Condition, NotEvaluated, Plane, SignatureOf};
use super::point::{Gone, Limits, Point};
use super::system::EventSystem;
use super::tube::Tube;
use crate::continuation::walk::Refused;
use crate::orbit::EventType;

/// What a curve begins with: the same for all its steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Head<P: Plane = Tube> {
    /// Type of the event.
    pub event: EventType,
    /// Its equations.
    pub system: EventSystem<P>,
    /// How far to follow.
    #[serde(rename = "settings")]
    pub limits: Limits,
    /// The event on the branch.
    pub point: Point,
    /// Its unknowns.
    pub unknowns: Vec<f64>,
    /// Unit tangent there.
    pub tangent: Vec<f64>,
}

/// A point with the equations that it solves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Found<P: Plane = Tube> {
    /// The point.
    pub point: Point,
    pub(super) signature: SignatureOf<P>,
    pub(super) condition: Condition<P>,
    pub(super) unknowns: Vec<f64>,
}

/// All that the next step depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct State<P: Plane = Tube> {
    pub(super) signature: SignatureOf<P>,
    pub(super) condition: Condition<P>,
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
pub enum Reason<P: Plane = Tube> {
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
        reason: Refused<NotEvaluated<P>, Refusal<P>>,
    },
}

/// The end of the curve in one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct End<P: Plane = Tube> {
    /// Why; earlier versions kept words as `reason`.
    #[serde(rename = "why", default)]
    pub reason: Reason<P>,
    /// Whether it is one of Newton's method or of `max_points` and not of the curve.
    pub failed: bool,
    /// Type of the last point unless it has one.
    pub(super) kind: Option<EventType>,
}

impl<P: Plane> End<P> {
    pub(super) fn new(reason: Reason<P>) -> End<P> {
        let kind = match reason {
            Reason::Unknown | Reason::There | Reason::Closed => None,
            Reason::Gone(_) => Some(EventType::EP),
            _ => Some(EventType::MX),
        };
        End {
            reason,
            failed: kind == Some(EventType::MX),
            kind,
        }
    }
}

/// A step in either direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Step<P: Plane = Tube> {
    /// Points found, in order.
    pub found: Vec<Found<P>>,
    /// What comes next.
    pub next: Next<P>,
}

/// What comes after a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum Next<P: Plane = Tube> {
    /// The next step.
    Going(Box<State<P>>),
    /// The end in this direction.
    Ended(End<P>),
}
