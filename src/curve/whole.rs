//! The curve of an event from one end to the other.

use super::plane::{ParameterOf, ParameterPlane};
use super::point::{CurvePoint, Region};
use super::saved::CurveEndReason;
use super::tube::WavesInPlane;
use crate::orbit::EventType;

/// The curve of an event.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeCurve<P: ParameterPlane = WavesInPlane> {
    /// Type of the event.
    pub event: EventType,
    /// Bloch sector of an HB.
    pub sector: Option<usize>,
    /// The two parameters.
    pub parameters: [ParameterOf<P>; 2],
    /// Names of their further numbers.
    pub columns: Vec<String>,
    /// Points from one end to the other.
    pub points: Vec<CurvePoint>,
    /// Index of the event on the branch.
    pub start: usize,
    /// Why the curve ends at its first and at its last point.
    pub ends: [CurveEndReason<P>; 2],
    /// Whether an end is one of Newton's method and not of the curve.
    pub failed: bool,
    /// Names of places beside it.
    pub regions: Vec<Region>,
}

impl<P: ParameterPlane> WholeCurve<P>
where
    CurveEndReason<P>: std::fmt::Display,
{
    /// Why the curve ends, in words, at its first point (0) or at its last one (1).
    pub fn end(&self, side: usize) -> String {
        let point = match side {
            0 => self.points.first(),
            _ => self.points.last(),
        };
        match (&self.ends[side.min(1)], point) {
            (CurveEndReason::There, Some(point)) => point.what.clone(),
            (reason, _) => reason.to_string(),
        }
    }
}
