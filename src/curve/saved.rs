//! A curve between two steps: what it began with, what its steps found, and how it ended.

use serde::{Deserialize, Serialize};

use super::follow::{Gone, Refusal};
use super::point::{Limits, Point};
use super::system::{Condition, EventSystem, NotEvaluated};
use crate::continuation::walk::Refused;
use crate::model::signature::{Regime, Signature};
use crate::orbit::EventType;
use crate::wave::admissibility::Watch;

/// What a curve begins with: the same for all its steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Type of the event.
    pub event: EventType,
    /// Its equations.
    pub system: EventSystem,
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
pub struct Found {
    /// The point.
    pub point: Point,
    pub(super) signature: Signature,
    pub(super) condition: Condition,
    pub(super) unknowns: Vec<f64>,
}

/// All that the next step depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    pub(super) signature: Signature,
    pub(super) condition: Condition,
    pub(super) unknowns: Vec<f64>,
    pub(super) tangent: Vec<f64>,
    pub(super) own: Vec<(Watch, usize)>,
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
pub enum Reason {
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
        /// Regime and length of the shortest zone.
        beside: (Regime, f64),
    },
    /// No step succeeds.
    NoStep {
        /// The shortest one.
        ds_min: f64,
        /// Why it was refused.
        reason: Refused<NotEvaluated, Refusal>,
    },
}

/// The end of the curve in one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Why; earlier versions kept words as `reason`.
    #[serde(rename = "why", default)]
    pub reason: Reason,
    /// Whether it is one of Newton's method or of `max_points` and not of the curve.
    pub failed: bool,
    /// Type of the last point unless it has one.
    pub(super) kind: Option<EventType>,
}

impl End {
    pub(super) fn new(reason: Reason) -> End {
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
pub struct Step {
    /// Points found, in order.
    pub found: Vec<Found>,
    /// What comes next.
    pub next: Next,
}

/// What comes after a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Next {
    /// The next step.
    Going(Box<State>),
    /// The end in this direction.
    Ended(End),
}
