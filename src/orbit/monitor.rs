//! Values of monitors that are asked for: numbers of an orbit, located along a branch where they have these values.
//!
//! A monitor is continuous along a branch of one signature, but for a switch that begins the period instead of another, and
//! smooth but for an extreme that another place takes over. A change of side within a step is therefore bracketed first, and
//! then brought to rounding by Newton's method; what only jumps past a value does not have it.

use serde::{Deserialize, Serialize};

use super::{Orbit, Zones, uncertainty};
use crate::continuation::Node;
use crate::continuation::locate::{self, LeastWithin, Place};
use crate::continuation::newton::Constraint;
use crate::continuation::walk::Segment;
use crate::linalg::Vector;

/// A number of an orbit with its derivatives in the scaled unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitorValue {
    /// Its value.
    pub value: f64,
    /// Its derivatives.
    pub gradient: Vec<f64>,
}

impl MonitorValue {
    /// Its largest derivative; 1 where there is none.
    pub fn slope(&self) -> f64 {
        let sizes = self.gradient.iter().map(|by| by.abs());
        let largest = sizes.fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    }
}

/// Numbers of an orbit that the user requests.
pub trait Monitored: Zones {
    /// A number of an orbit that is asked for, by its place among those, at a point; `None` where it has no value.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    fn measured(
        &self,
        _monitor: usize,
        _point: &Vector,
    ) -> Result<Option<MonitorValue>, Self::Failure> {
        Ok(None)
    }

    /// Its name.
    fn monitor_name(&self, _monitor: usize) -> &str {
        ""
    }
}

/// A value of a monitor that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonitorStop {
    /// Number of the monitor.
    pub monitor: usize,
    /// Its value.
    pub value: f64,
}

/// (m(u) − m₀)/size = 0; no number where the monitor has no value.
struct AtValue {
    stop: MonitorStop,
    size: f64,
}

impl<O: Orbit> Constraint<O> for AtValue {
    fn evaluate(
        &mut self,
        orbit: &O,
        point: &Vector,
        gradient: &mut [f64],
    ) -> Result<f64, O::Failure> {
        let Some(measured) = orbit.measured(self.stop.monitor, point)? else {
            return Ok(f64::NAN);
        };
        for (sum, by) in gradient.iter_mut().zip(&measured.gradient) {
            *sum += by / self.size;
        }
        Ok((measured.value - self.stop.value) / self.size)
    }
}

/// A step ends, and its bracket is narrow, within this part of its length.
const NARROW: f64 = 1e-9;

/// Newton's method moves a bracketed place by no more than this part of the step.
const BESIDE: f64 = 1e-6;

/// A step from a place at which a monitor has a value but for this part of it does not meet it once more at once.
const ON_VALUE: f64 = 1e-12;

/// A place at which a monitor has a value that is asked for.
pub(super) struct LocatedMonitor {
    /// The place.
    pub place: Place,
    /// The value, and of which monitor.
    pub stop: MonitorStop,
    /// The error of the parameter there, in physical units.
    pub uncertainty: f64,
}

/// Where monitors have the values that are asked for within a step, up to an end at an arclength. `None` if a place is not
/// found.
pub(super) fn located<O: Orbit>(
    orbit: &O,
    stops: &[MonitorStop],
    step: &Segment<O::Examination>,
    end: (f64, &Node),
) -> Option<Vec<LocatedMonitor>> {
    let mut all = Vec::new();
    for stop in stops {
        for bracket in brackets(orbit, *stop, step, end) {
            all.extend(zero(orbit, *stop, step, bracket)?);
        }
    }
    Some(all)
}

/// Value less what is asked for, and its slope along the curve.
fn at<O: Orbit>(orbit: &O, stop: MonitorStop, node: &Node) -> Option<(f64, f64)> {
    let measured = orbit.measured(stop.monitor, &node.point).ok()??;
    let slope = measured.gradient.iter().zip(&node.tangent);
    let slope = slope.map(|(by, along)| by * along).sum();
    let value = measured.value - stop.value;
    (value.is_finite()).then_some((value, slope))
}

/// Whether a monitor has the value at a node but for the rounding of unknowns of order one.
fn has_value<O: Orbit>(orbit: &O, stop: MonitorStop, node: &Node) -> bool {
    const ROUNDINGS: f64 = 16.0 * f64::EPSILON;
    let measured = orbit.measured(stop.monitor, &node.point);
    let measured = measured.ok().flatten();
    measured.is_some_and(|measured| {
        let off = (measured.value - stop.value).abs();
        off <= ROUNDINGS * measured.slope().max(stop.value.abs())
    })
}

/// Two places of a step with the values of a function there, of different signs.
type Signs = [(f64, f64); 2];

/// Brackets of the places at which a monitor has a value: one where it changes its side, two where it comes back.
fn brackets<O: Orbit>(
    orbit: &O,
    stop: MonitorStop,
    step: &Segment<O::Examination>,
    (end, to): (f64, &Node),
) -> Vec<Signs> {
    let ends = (at(orbit, stop, step.from), at(orbit, stop, to));
    let (Some((m0, d0)), Some((m1, d1))) = ends else {
        return Vec::new();
    };
    if m0 == 0.0 || end <= 0.0 {
        return Vec::new();
    }
    if m0 * m1 <= 0.0 {
        // one that has the value all along, as the least size of what passes zero, changes its sign by rounding
        let stays = [step.from, to]
            .iter()
            .all(|node| has_value(orbit, stop, node));
        return match stays {
            true => Vec::new(),
            false => vec![[(0.0, m0), (end, m1)]],
        };
    }
    let side = m0.signum();
    let both = [(side * m0, side * d0), (side * m1, side * d1)];
    let tolerance = step.steps.tolerance;
    let least = locate::least(orbit, step.from, end, both, tolerance, |node| {
        let (value, slope) = at(orbit, stop, node)?;
        Some((side * value, side * slope))
    });
    match least {
        // a value that is only touched has rounding on either side
        LeastWithin::Found(place, value) if value < 0.0 => {
            let middle = (place.s, side * value);
            vec![[(0.0, m0), middle], [middle, (end, m1)]]
        }
        LeastWithin::Far | LeastWithin::Found(..) | LeastWithin::NotFound => Vec::new(),
    }
}

/// The place in a bracket, if the monitor has the value there and does not jump past it.
#[allow(clippy::option_option)] // found or not, there or not
fn zero<O: Orbit>(
    orbit: &O,
    stop: MonitorStop,
    step: &Segment<O::Examination>,
    [low, high]: Signs,
) -> Option<Option<LocatedMonitor>> {
    let tolerance = step.steps.tolerance;
    let size = |value: f64| value.abs().max(stop.value.abs());
    let narrow = NARROW * step.ds;
    let value = |node: &Node| Some(at(orbit, stop, node)?.0);
    let near = match high.1 == 0.0 {
        true => locate::node_at(orbit, step.from, high.0, tolerance).map(|node| (high.0, node)),
        false => {
            let small = (f64::EPSILON * size(low.1), narrow);
            let found = locate::zero_along(orbit, step.from, (low, high), small, tolerance, value);
            found.map(|(place, _)| (place.s, place.node))
        }
    };
    let (s, node) = near?;
    let measured = orbit.measured(stop.monitor, &node.point).ok()??;
    let mut constraint = AtValue {
        stop,
        size: measured.slope(),
    };
    let place = locate::solve(orbit, step.from, &node.point, &mut constraint, tolerance);
    let place = place.filter(|place| (place.s - s).abs() <= BESIDE * step.ds);
    let Some(place) = place else {
        return Some(None);
    };
    // where it set out from the value it has been met already
    let met = low.0 == 0.0 && low.1.abs() <= ON_VALUE * size(0.0);
    if met && place.s <= narrow {
        return Some(None);
    }
    Some(Some(LocatedMonitor {
        uncertainty: uncertainty(orbit, &mut constraint, &place),
        place,
        stop,
    }))
}
