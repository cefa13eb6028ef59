//! What is located within a step of a curve of an event.

use super::closing::Closing;
use super::event::{CurveRefusal, EventCurve, Stage};
use super::plane::{MarginOf, ParameterPlane, Test};
use crate::continuation::Node;
use crate::continuation::limit;
use crate::continuation::locate::{self, Place, Target};
use crate::continuation::walk::WatchedCurve as _;
use crate::linalg::Vector;
use crate::orbit::{AtZero, Examined, Inequalities, MarginFunction, find};

/// What is located within a step.
#[derive(Clone, Debug)]
pub enum StepEvent<P: ParameterPlane> {
    /// An edge of the range of a parameter.
    Edge(usize, f64),
    /// Another margin vanishes.
    Margin(MarginOf<P>),
    /// det F_x changes its sign.
    Fold,
    /// The factor of a cusp does.
    Cusp,
    /// Another test function does: what it is there.
    Other(Test),
    /// The number of multipliers outside the unit circle changes, from the first to the second.
    Passing([usize; 2]),
    /// A limit of the curve, at which its equations are singular: the unknowns there, and the part of their ranges to which the
    /// parameters are known.
    Limit(Vector, f64),
    /// A zone shrinks to nothing where the equations are singular.
    Closing(Closing<P>),
}

impl<P: ParameterPlane> EventCurve<P> {
    /// Edges of the ranges within a step.
    pub(super) fn edges(&self, step: &Stage<P>) -> Option<Vec<(Place, StepEvent<P>)>> {
        let first = step.to.point.len() - 2;
        let way = [&step.from.point, &step.to.point];
        let mut located = Vec::new();
        for (index, (low, high)) in self.limits.ranges.into_iter().enumerate() {
            for (value, outside) in [(low, -1.0), (high, 1.0)] {
                let target = Target {
                    index: first + index,
                    value: value / self.system.widths()[index],
                    outside,
                };
                let places =
                    target.meetings(&self.system, step.from, &way, step.steps.tolerance)?;
                let event = StepEvent::Edge(index, value);
                located.extend(places.into_iter().map(|place| (place, event.clone())));
            }
        }
        Some(located)
    }

    /// The zero of a function along a step from its values at both ends, or none where they have one sign.
    fn zero(
        &self,
        step: &Stage<P>,
        before: f64,
        after: f64,
        event: StepEvent<P>,
        value: impl FnMut(&Node) -> Option<f64>,
    ) -> Result<(Place, StepEvent<P>), CurveRefusal<P>> {
        /// Relative width of the bracket, or value, at which the place is known to rounding.
        const EXACT: f64 = 1e-14;
        let size = before.abs().max(after.abs());
        let small = (EXACT * size, EXACT * step.ds);
        let ends = ((0.0, before), (step.ds, after));
        let tolerance = step.steps.tolerance;
        let (place, _) = locate::zero_along(&self.system, step.from, ends, small, tolerance, value)
            .ok_or(CurveRefusal::NotLocated)?;
        Ok((place, event))
    }

    /// Margins that vanish within a step, but for those that vanish with a zone; where the curve ends within it some may be
    /// posed beyond its end first.
    pub(super) fn margins(
        &self,
        step: &Stage<P>,
        with_zone: &[(P::Watch, usize)],
        is_ended: bool,
    ) -> Result<Vec<(Place, StepEvent<P>)>, CurveRefusal<P>> {
        let mut located = Vec::new();
        for margin in step.after.examination.margins() {
            let value = margin.value();
            let key = P::key(margin);
            if self.own.contains(&key) || value > 0.0 || with_zone.contains(&key) {
                continue;
            }
            let before = find::<P::Orbit>(&step.before.examination, margin);
            let before = before
                .map(MarginFunction::value)
                .filter(|before| *before > 0.0);
            let Some(before) = before else {
                if is_ended {
                    continue;
                }
                return Err(self.posed(step));
            };
            located.push(self.margin_zero(step, margin, before)?);
        }
        Ok(located)
    }

    /// What is negative at the end of a step, though nothing was posed of it before.
    fn posed(&self, step: &Stage<P>) -> CurveRefusal<P> {
        match self.system.orbit(&step.to.point, 0) {
            Ok((orbit, _)) => {
                CurveRefusal::Posed(Box::new(orbit.inadmissible(&step.after.examination)))
            }
            Err(failure) => CurveRefusal::Flow(failure),
        }
    }

    /// The zero of a margin that is positive before a step, and not at its end.
    pub(super) fn margin_zero(
        &self,
        step: &Stage<P>,
        margin: &MarginOf<P>,
        before: f64,
    ) -> Result<(Place, StepEvent<P>), CurveRefusal<P>> {
        let mut at = AtZero {
            margin: margin.clone(),
        };
        let event = StepEvent::Margin(margin.clone());
        self.zero(step, before, margin.value(), event, |node| {
            let (orbit, unknowns) = self.system.orbit(&node.point, 0).ok()?;
            Some(at.margin_at(&orbit, &unknowns).ok()?.value())
        })
    }

    /// Smooth test functions that change their sign within a step.
    pub(super) fn signs(
        &self,
        step: &Stage<P>,
    ) -> Result<Vec<(Place, StepEvent<P>)>, CurveRefusal<P>> {
        let mut located = Vec::new();
        if let (Some(before), Some(after)) = (step.before.fold, step.after.fold)
            && before * after < 0.0
        {
            located.push(self.zero(step, before, after, StepEvent::Fold, |node| {
                self.determinant(&node.point).ok()
            })?);
        }
        if let (Some((before, left)), Some((after, _))) = (&step.before.cusp, &step.after.cusp)
            && before * after < 0.0
        {
            located.push(self.zero(step, *before, *after, StepEvent::Cusp, |node| {
                Some(self.cusp(node, Some(left)).ok()??.0)
            })?);
        }
        let [before, after] = [&step.before, &step.after].map(|tests| &tests.watched.tests);
        let tests = before.iter().zip(after);
        for (index, (before, after)) in tests.enumerate() {
            if before.value * after.value < 0.0 {
                let tests = |node: &Node| {
                    let at = self.system.orbit(&node.point, 0)?;
                    Ok(self.watched(&node.point, &at).tests)
                };
                let event = StepEvent::Other(*after);
                let (place, _) = self.zero(step, before.value, after.value, event, |node| {
                    tests(node).ok()?.get(index).map(|test| test.value)
                })?;
                // what it is, the place itself tells
                let there = tests(&place.node).map_err(CurveRefusal::Flow)?;
                let there = there.get(index).unwrap_or(after);
                if there.kind.is_some() || there.ends {
                    located.push((place, StepEvent::Other(*there)));
                }
            }
        }
        Ok(located)
    }

    /// The same up to a point of the step, before which nothing is located where it lies behind.
    pub(super) fn signs_before(
        &self,
        step: &Stage<P>,
        place: &Place,
    ) -> Result<Vec<(Place, StepEvent<P>)>, CurveRefusal<P>> {
        if place.s <= 0.0 {
            return Ok(Vec::new());
        }
        let after = self.watch(&place.node, Some(step.before))?;
        self.signs(&Stage {
            to: &place.node,
            ds: place.s,
            after: &after,
            ..*step
        })
    }

    /// Where the number of multipliers outside the unit circle changes within a step in which nothing else happens that
    /// would tell: an even number passes the circle, of which no test function changes its sign.
    pub(super) fn passing(
        &self,
        step: &Stage<P>,
    ) -> Result<Option<(Place, StepEvent<P>)>, CurveRefusal<P>> {
        /// Part of the step to which it is located: nearer the circle the number is not known.
        const WIDTH: f64 = 1e-9;
        let outside = [&step.before, &step.after].map(|tests| tests.watched.outside);
        let [Some(before), Some(after)] = outside else {
            return Ok(None);
        };
        if before == after {
            return Ok(None);
        }
        let (mut low, mut high) = (0.0, step.ds);
        let mut place = Place {
            s: high,
            node: step.to.clone(),
            blur: 0.0,
        };
        while high - low > WIDTH * step.ds {
            let s = 0.5 * (low + high);
            let node = locate::node_at(&self.system, step.from, s, step.steps.tolerance);
            let node = node.ok_or(CurveRefusal::NotLocated)?;
            let at = self
                .system
                .orbit(&node.point, 0)
                .map_err(CurveRefusal::Flow)?;
            let outside = self.system.watched(&node.point, &at).outside;
            place = Place {
                s,
                node,
                blur: high - low,
            };
            match outside {
                Some(outside) if outside == before => low = s,
                Some(_) => high = s,
                // on the circle
                None => break,
            }
        }
        Ok(Some((place, StepEvent::Passing([before, after]))))
    }

    /// Where orbits shrink to a point, which those next to it tell: there the equations are singular to their extent, but the
    /// curve is smooth in it.
    pub(super) fn limit(
        &self,
        step: &Stage<P>,
    ) -> Result<Option<(Place, StepEvent<P>)>, CurveRefusal<P>> {
        /// Extent of the largest orbit that tells, what part of it the next has, and the number of orbits: what their polynomial leaves
        /// out is of order 1e-14, and rounding of the smallest of folds, which is divided by the cube of its size, 1e-12. Each is found
        /// from the one before: Newton's method comes no nearer to the point than by a part of the extent.
        const SMALL: f64 = 5e-2;
        const PART: f64 = 0.75;
        const SAMPLES: i32 = 8;
        /// Most that the limit of the parameters may be off by, in their ranges.
        const KNOWN: f64 = 1e-8;
        let size = |node: &Node, most: f64| {
            let (orbit, unknowns) = self.system.orbit(&node.point, 0).ok()?;
            P::extent(&self.system.condition, &orbit, &unknowns, most)
        };
        // an orbit that has passed a point has moved by its own size; few turn so much, and what costs comes after that
        if P::turns(&step.after.examination, &step.before.examination)
            && let (Some(before), Some(_)) = (size(step.from, 1.0), size(step.to, 1.0))
            && (&step.to.point - &step.from.point).norm() >= 0.5 * before
        {
            return Err(CurveRefusal::NotLocated);
        }
        let Some(after) = size(step.to, SMALL) else {
            return Ok(None);
        };
        let before = size(step.from, 1.0).filter(|before| after < *before);
        let Some(before) = before else {
            return Ok(None);
        };
        let largest = SMALL.min(before);
        let mut near = (0.0, step.from.clone());
        let samples: Option<Vec<(Place, f64)>> = (0..SAMPLES)
            .map(|sample| {
                let wanted = largest * PART.powi(sample);
                let s = step.ds * (before - wanted) / (before - after);
                let (tolerance, known) = (step.steps.tolerance, (near.0, &near.1));
                let node = locate::node_beside(&self.system, step.from, known, s, tolerance)?;
                near = (s, node.clone());
                let size = size(&node, 1.0)?;
                Some((Place { s, node, blur: 0.0 }, size))
            })
            .collect();
        let Some(samples) = samples else {
            return Ok(None);
        };
        let sized = samples
            .iter()
            .map(|(place, size)| (*size, place.node.point.clone()));
        let last = samples.last().map(|(place, _)| place.clone());
        let (Some((point, error)), Some(place)) = (limit::limit(&sized.collect::<Vec<_>>()), last)
        else {
            return Ok(None);
        };
        let error = error.rows(point.len() - 2, 2).amax();
        // beyond an edge there is no limit to come to
        let widths = self.system.widths();
        let is_within = |(index, (low, high)): (usize, (f64, f64))| {
            let value = point[point.len() - 2 + index] * widths[index];
            let off = error * widths[index];
            low - off <= value && value <= high + off
        };
        let is_known = error <= KNOWN;
        let comes = is_known && self.limits.ranges.into_iter().enumerate().all(is_within);
        Ok(comes.then_some((place, StepEvent::Limit(point, error))))
    }
}
