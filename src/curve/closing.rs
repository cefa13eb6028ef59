//! The end of a curve where a zone shrinks to nothing and the equations are singular.
//!
//! Where the guard that ends a zone leaves zero at its entry slower and slower, as the zone shrinks, both zeros of the guard meet:
//! orbits without the zone solve the equations, too, and cross the curve there. Newton's method comes to the one or the
//! other, and what vanishes in proportion with the zone has its zero by rounding. Away from there the curve is smooth in
//! the duration of the zone: the polynomial through points with a longer zone meets the end.

use super::event::{EventCurve, Stage};
use super::plane::{MarginOf, ParameterPlane};
use crate::continuation::limit::limit;
use crate::continuation::locate::{self, Place};
use crate::linalg::Vector;
use crate::orbit::{AtZero, Examined, MarginFunction, find};

/// Longest durations of the points that tell, in units of the period, and their number: the one with the least error serves.
const LONGEST: [f64; 5] = [5e-2, 2e-2, 1e-2, 5e-3, 2e-3];
const SAMPLES: i32 = 8;

/// Most that the parameters may be off by, in their ranges.
const KNOWN: f64 = 1e-8;

/// A margin vanishes with the zone where its limit is below this, or below so many of its errors.
const VANISHED: f64 = 1e-9;
const ERRORS: f64 = 10.0;

/// Where a zone shrinks to nothing.
#[derive(Clone, Debug)]
pub struct Closing<P: ParameterPlane> {
    /// The duration of the zone.
    pub margin: MarginOf<P>,
    /// The unknowns there.
    pub point: Vector,
    /// The nearest point that tells it, with its arclength: nearer ones may be orbits without the zone.
    pub nearest: Place,
    /// The margins that vanish there, the duration one of them.
    pub vanishing: Vec<(P::Watch, usize)>,
}

/// Points of a curve with their arclengths, and the durations of a zone that shrinks.
type Shrinking = Vec<(Place, f64)>;

impl<P: ParameterPlane> EventCurve<P> {
    /// Where a zone shrinks to nothing within a step at a place that its own zero does not meet.
    pub(super) fn closing(&self, step: &Stage<P>) -> Option<(Place, Closing<P>)> {
        let margins = step.after.examination.margins().iter();
        let mut closing = margins.filter(|margin| {
            P::CLOSES
                && margin.precedence() == 0
                && margin.value() <= 0.0
                && !self.own.contains(&P::key(margin))
        });
        closing.find_map(|margin| {
            let before =
                find::<P::Orbit>(&step.before.examination, margin).map(MarginFunction::value)?;
            (before > 0.0)
                .then(|| self.closing_of(step, margin, before))
                .flatten()
        })
    }

    fn closing_of(
        &self,
        step: &Stage<P>,
        margin: &MarginOf<P>,
        before: f64,
    ) -> Option<(Place, Closing<P>)> {
        let limits = LONGEST.iter().filter_map(|longest| {
            let samples = self.shrinking(step, margin, before, *longest)?;
            let points = samples.iter();
            let points = points.map(|(place, length)| (*length, place.node.point.clone()));
            let (point, error) = limit(&points.collect::<Vec<_>>())?;
            let error = error.rows(point.len() - 2, 2).amax();
            Some((error, point, samples))
        });
        let (error, point, samples) = limits.min_by(|one, other| one.0.total_cmp(&other.0))?;
        let parameters = |point: &Vector| point.rows(point.len() - 2, 2).into_owned();
        let ordinary = self.margin_zero(step, margin, before).ok();
        let agrees = ordinary.is_some_and(|(place, _)| {
            let off = parameters(&place.node.point) - parameters(&point);
            off.amax() <= VANISHED.max(ERRORS * error)
        });
        if agrees || error > KNOWN {
            return None;
        }
        let nearest = samples.last()?.0.clone();
        let place = Place {
            s: step.from.tangent.dot(&(&point - &step.from.point)),
            node: nearest.node.clone(),
            blur: error,
        };
        let margins = step.after.examination.margins().iter();
        let vanishing = margins.filter(|other| self.vanishes(other, &samples));
        let closing = Closing {
            margin: margin.clone(),
            point,
            nearest,
            vanishing: vanishing.map(P::key).collect(),
        };
        Some((place, closing))
    }

    /// Points of the curve at which the zone takes up to so long, the nearest to its end last.
    fn shrinking(
        &self,
        step: &Stage<P>,
        margin: &MarginOf<P>,
        before: f64,
        longest: f64,
    ) -> Option<Shrinking> {
        let after = margin.value();
        let samples = (1..=SAMPLES).rev().map(|sample| {
            let wanted = longest * f64::from(sample) / f64::from(SAMPLES);
            let s = step.ds * (before - wanted) / (before - after);
            let node = locate::node_at(&self.system, step.from, s, step.steps.tolerance)?;
            let length = self.margin_at(&node.point, margin)?;
            // another solution has another zone
            let is_near = length >= 0.5 * wanted && length <= 2.0 * wanted;
            is_near.then_some((Place { s, node, blur: 0.0 }, length))
        });
        samples.collect()
    }

    /// The value of a margin at a point.
    fn margin_at(&self, point: &Vector, margin: &MarginOf<P>) -> Option<f64> {
        let (orbit, unknowns) = self.system.orbit(point, 0).ok()?;
        let mut at = AtZero {
            margin: margin.clone(),
        };
        Some(at.margin_at(&orbit, &unknowns).ok()?.value())
    }

    /// Whether a margin vanishes as the zone shrinks.
    fn vanishes(&self, margin: &MarginOf<P>, samples: &Shrinking) -> bool {
        let value = |(place, length): &(Place, f64)| {
            let value = self.margin_at(&place.node.point, margin)?;
            Some((*length, Vector::from_element(1, value)))
        };
        let values: Option<Vec<(f64, Vector)>> = samples.iter().map(value).collect();
        let limit = values.and_then(|values| limit(&values));
        limit.is_some_and(|(value, error)| value[0].abs() <= VANISHED.max(ERRORS * error[0]))
    }
}
