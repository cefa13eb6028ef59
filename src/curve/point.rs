//! What a curve of events is made of, as plain data.

use serde::{Deserialize, Serialize};

use super::regions::Region;
use crate::continuation::Steps;
use crate::model::EventType;
use crate::model::Parameter;

/// How far to follow, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Range of each parameter.
    pub ranges: [(f64, f64); 2],
    /// Step lengths and tolerance.
    pub steps: Steps,
    /// Largest number of points in either direction.
    pub most_points: usize,
}

/// A point of the curve: a row of `curve.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Both parameters.
    pub parameters: [f64; 2],
    /// Wave speed c, signed.
    pub speed: f64,
    /// Regimes before the event.
    pub before: String,
    /// Regimes after it; empty where no admissible wave was found to go on.
    pub after: String,
    /// ω of a Hopf point.
    pub omega: Option<f64>,
    /// Type of a point of codimension two, of the start and of the ends.
    pub kind: Option<String>,
    /// What happens there, in words; empty at ordinary points.
    pub what: String,
    /// Newton iterations.
    pub newton: usize,
    /// Largest residual relative to its row of the Jacobian.
    pub residual: f64,
    /// Excess speed e = |c|/√a − 1.
    pub excess: f64,
}

/// The curve of an event.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Type of the event.
    pub event: EventType,
    /// Bloch sector of an HB.
    pub sector: Option<usize>,
    /// The two parameters.
    pub parameters: [Parameter; 2],
    /// Points from one end to the other.
    pub points: Vec<Point>,
    /// Index of the event on the branch.
    pub start: usize,
    /// Why the curve ends at its first and at its last point, in words.
    pub ends: [String; 2],
    /// Whether an end is one of Newton's method and not of the curve.
    pub failed: bool,
    /// Names of places beside it.
    pub regions: Vec<Region>,
}
