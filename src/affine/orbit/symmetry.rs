//! Orbits that are their own image: half a period later some states have the other sign, the others the same.
//!
//! Where they lose this symmetry the multiplier of their half, with the image at its end, is −1: that of the orbit
//! passes 1, the parameter does not turn back, and the equations are singular. Those of half the orbit are not.

use std::f64::consts::TAU;

use super::critical::Critical;
use super::ends::{NEARLY_A_POINT, vanishes};
use super::layout::AffineOrbit;
use super::monodromy::Monodromy;
use super::passage::Jet;
use super::row;
use super::setting::OrbitFailure;
use super::termination::OrbitTermination;
use crate::affine::mode::Row;
use crate::continuation::Node;
use crate::continuation::locate::{self, Place};
use crate::continuation::newton::{self, Equations, Plane};
use crate::linalg::{self, Matrix, Vector};
use crate::orbit::{Covers, Zones};

/// A located event is its own image to this in scaled unknowns: at a threefold zero Newton's method comes to the
/// cube root of rounding.
const IMAGE: f64 = 1e-4;

/// One that comes to a symmetric orbit is its image to this: there the equations are singular, and places known to the root of
/// rounding.
const ALMOST: f64 = 1e-2;

/// One that differs from its image by more is not symmetric: symmetric orbits are found to rounding.
const LACKS: f64 = 1e-6;

/// An orbit of half the equations solves all of them to this, and they are singular to this part of the largest
/// singular value.
const SOLVED: f64 = 1e-9;
const SINGULAR: f64 = 1e-7;

/// The states that keep their sign in an image, bit by bit: there are fewer than 64. At least one does not.
pub type Kept = u64;

/// What an orbit is half a period later.
enum HalfLater {
    /// The same: it is traversed twice.
    Same,
    /// Its image, in which these states keep their sign.
    Image(Kept),
}

impl HalfLater {
    fn kept(self) -> Option<Kept> {
        match self {
            HalfLater::Same => None,
            HalfLater::Image(kept) => Some(kept),
        }
    }
}

/// The equations of half a symmetric orbit.
struct Half<'a> {
    orbit: &'a AffineOrbit,
    kept: Kept,
}

impl Equations for Half<'_> {
    type Failure = OrbitFailure;

    fn unknowns(&self) -> usize {
        self.orbit.unknowns()
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), OrbitFailure> {
        self.orbit.evaluate(point, residual, jacobian)?;
        self.orbit
            .close_at_image(self.kept, point, residual, jacobian)
    }
}

impl Half<'_> {
    /// Where the multiplier of the half passes −1 between two arclengths from a symmetric orbit, and the error of the parameter
    /// there.
    fn loss(&self, from: &Node, [low, high]: [f64; 2], tolerance: f64) -> Option<(Place, f64)> {
        let test = |node: &Node| {
            let monodromy = self.orbit.half_monodromy(self.kept, &node.point).ok()??;
            Some(monodromy.tests(&monodromy.multipliers())[0])
        };
        let at = |s: f64| Some((s, test(&locate::node_at(self, from, s, tolerance)?)?));
        let (low, high) = (at(low)?, at(high)?);
        if low.1 * high.1 >= 0.0 {
            return None;
        }
        let small = (0.0, 4.0 * f64::EPSILON * (high.0 - low.0));
        let (place, _) = locate::zero_along(self, from, (low, high), small, tolerance, test)?;
        let point = &place.node.point;
        let mut plane = Plane {
            normal: &from.tangent,
            through: point,
        };
        let matrix = newton::bordered(self, &mut plane, point).ok()?.matrix;
        let rounding = newton::rounding(&matrix, &point.abs(), None)?[point.len() - 1];
        Some((place, rounding * self.orbit.unit().abs()))
    }
}

/// The sign of a state in an image.
fn sign(kept: Kept, state: usize) -> f64 {
    if kept >> state & 1 == 1 { 1.0 } else { -1.0 }
}

impl AffineOrbit {
    /// The image under which an orbit is its own half a period later, as far as a located event may tell. A state that is
    /// zero at every entry is told by its rate.
    pub fn symmetry(&self, point: &Vector) -> Option<Kept> {
        self.has_half()
            .then(|| self.half_later(point, IMAGE)?.kept())?
    }

    /// What any orbit is half a period later, to this in units of the states; `None` where that is something else. An orbit that
    /// never switches is seen at its beginning and half a period later.
    fn half_later(&self, point: &Vector, most: f64) -> Option<HalfLater> {
        let switches = self.sequence.switches() > 0;
        if switches && !self.zones().is_multiple_of(2) {
            return None;
        }
        let at = self.at(point).ok()?;
        let scales = &self.setting.scales;
        let places: Vec<Vector> = match switches {
            true => (0..self.zones()).map(|zone| at.entry(zone)).collect(),
            false => vec![
                at.entry(0),
                at.passage(0, 0.5 * at.zones[0].duration).ok()?.end,
            ],
        };
        let half = places.len() / 2;
        let rates = places.iter().enumerate();
        let rates = rates.map(|(zone, z)| &at.mode(zone % self.zones()).matrix.at * z);
        let rates: Vec<Vector> = rates.collect();
        let is = |state: usize, sign: f64| {
            let unit = scales.states[state];
            (0..half).all(|zone| {
                let place = |zone: usize| places[zone][state] / unit;
                let rate = |zone: usize| rates[zone][state] * scales.time / unit;
                let values = (place(zone + half) - sign * place(zone)).abs();
                let slopes = (rate(zone + half) - sign * rate(zone)).abs();
                values <= most && slopes <= most * rate(zone).abs().max(1.0)
            })
        };
        let mut kept = 0;
        // a state that is zero all along is its own image with either sign
        let repeats = (0..self.states()).all(|state| is(state, 1.0));
        for state in (0..self.states()).filter(|_| !repeats) {
            if is(state, -1.0) {
                continue;
            }
            kept |= u64::from(is(state, 1.0)) << state;
            if sign(kept, state) < 0.0 {
                return None;
            }
        }
        let turns = !repeats && (0..self.states()).any(|state| sign(kept, state) < 0.0);
        let duration = |zone: usize| point[self.duration_index(zone % self.zones())];
        let durations = (0..half).map(|zone| duration(zone + half) - duration(zone));
        let alike = durations.fold(0.0, |most: f64, off| most.max(off.abs())) <= most;
        // half of the period is half of that of the forcing or a whole number of them
        let fits = !self.is_forced() || self.setting.periods.is_multiple_of(2) != turns;
        let is_image = fits && alike && (turns || repeats);
        is_image.then_some(match turns {
            true => HalfLater::Image(kept),
            false => HalfLater::Same,
        })
    }

    /// Whether an orbit is so small that any image is near to it.
    fn is_small(&self, point: &Vector) -> bool {
        self.varies_within(point, 10.0 * ALMOST)
    }

    /// Where a symmetric orbit loses its symmetry between two arclengths of a step, and the error of the parameter there.
    pub(super) fn symmetry_lost(
        &self,
        from: &Node,
        [low, high]: [f64; 2],
        tolerance: f64,
    ) -> Option<(Place, f64)> {
        let kept = self.symmetry(&from.point)?;
        Half { orbit: self, kept }.loss(from, [low, high], tolerance)
    }

    /// Whether the second half of an orbit may be the image of the first.
    fn has_half(&self) -> bool {
        let is_smooth = self.sequence.switches() == 0;
        // the half of an orbit without switches is one shot
        let even = self.zones().is_multiple_of(2) || is_smooth && self.shots(0) == 1;
        even && (!self.is_forced() || self.setting.periods % 2 == 1)
    }

    /// Number of zones in half a period, where there is such a half: none in an orbit that never switches.
    fn zones_of_half(&self) -> usize {
        if self.has_half() { self.zones() / 2 } else { 0 }
    }

    /// Puts in the place of the equations of the second half that it is the image of the first; of an orbit that never switches, in the
    /// place of those of the whole, that half a period after the entry the motion is at its image.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn close_at_image(
        &self,
        kept: Kept,
        point: &Vector,
        residual: &mut [f64],
        matrix: &mut Matrix,
    ) -> Result<(), OrbitFailure> {
        if self.has_half() && self.sequence.switches() == 0 {
            return self.close_smooth_at_image(kept, point, residual, matrix);
        }
        let half = self.width() * self.zones_of_half();
        matrix.rows_mut(half, half).fill(0.0);
        for index in 0..half {
            let place = index % self.width();
            let sign = if place == self.states() {
                1.0
            } else {
                sign(kept, place)
            };
            residual[half + index] = point[half + index] - sign * point[index];
            matrix[(half + index, index)] = -sign;
            matrix[(half + index, half + index)] = 1.0;
        }
        Ok(())
    }

    /// z(T/2) − Sz(0) = 0 in units of the states.
    fn close_smooth_at_image(
        &self,
        kept: Kept,
        point: &Vector,
        residual: &mut [f64],
        matrix: &mut Matrix,
    ) -> Result<(), OrbitFailure> {
        let at = self.at(point)?;
        let passage = at.passage(0, 0.5 * at.zones[0].duration)?;
        let entry = at.entry(0);
        for (state, unit) in self.setting.scales.states.iter().enumerate() {
            let end = passage.at_end(&Row::unit(entry.len(), state));
            let end = Jet {
                by_time: 0.5 * end.by_time,
                ..end
            };
            let begins = Jet::of_component(state, &entry);
            residual[state] = 0.0;
            matrix.row_mut(state).fill(0.0);
            for (jet, by) in [(end, 1.0), (begins, -sign(kept, state))] {
                residual[state] += by / unit * jet.value;
                let mut add = |column: usize, by: f64| matrix[(state, column)] += by;
                at.spread(0, &jet, by / unit, &mut add);
            }
        }
        Ok(())
    }

    /// The same as [`AffineOrbit::doubling_determinant`] of half the orbit, with the image at its end: it changes its sign where the
    /// symmetry is lost.
    pub fn asymmetry_determinant(&self, kept: Kept, point: &Vector) -> Option<f64> {
        let (matrix, _) = newton::jacobian(self, point).ok()?;
        let count = matrix.nrows();
        let mut square = matrix.columns(0, count).into_owned();
        let mut residual = vec![0.0; count];
        self.close_at_image(kept, point, &mut residual, &mut square)
            .ok()?;
        // a perturbation has the other sign in the second half
        let half = self.width() * self.zones_of_half();
        square.view_mut((half, 0), (half, half)).neg_mut();
        let last = count - 1;
        if let Some(phase) = self.phase_index() {
            square.view_mut((last, half), (1, half)).fill(0.0);
            square[(last, phase)] = 2.0 / TAU;
        }
        self.hold_free(&mut square);
        Some(square.determinant())
    }

    /// Whether symmetric orbits go on with the parameter from where one loses its symmetry: the derivative of the
    /// equations has nothing of their left null vector there, which changes its sign in the image.
    pub fn keeps_symmetry(&self, point: &Vector) -> bool {
        newton::jacobian(self, point).is_ok_and(|(matrix, _)| {
            let count = matrix.nrows();
            let square = matrix.columns(0, count).clone_owned();
            let by = matrix.column(count);
            let least = linalg::least(&square);
            least.is_some_and(|least| least.left.dot(&by).abs() <= IMAGE * by.norm())
        })
    }

    /// Whether a symmetric orbit of half the equations solves all of them, with a multiplier 1.
    pub fn loses_symmetry(&self, point: &Vector) -> bool {
        newton::jacobian(self, point).is_ok_and(|(matrix, residual)| {
            let square = matrix.columns(0, matrix.nrows()).clone_owned();
            let least = linalg::least(&square);
            let singular = least.is_some_and(|least| least.value <= SINGULAR * least.largest);
            residual <= SOLVED && singular
        })
    }

    /// The linearised motion over half a period, with the image at its end; `None` where it is infinite or there is
    /// no half.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn half_monodromy(
        &self,
        kept: Kept,
        point: &Vector,
    ) -> Result<Option<Monodromy>, OrbitFailure> {
        let at = self.at(point)?;
        let passages = if self.has_half() && self.sequence.switches() == 0 {
            vec![at.passage(0, 0.5 * at.zones[0].duration)?]
        } else {
            let mut passages = Vec::new();
            for zone in 0..self.zones_of_half() {
                passages.extend(at.shots_of(zone)?);
            }
            passages
        };
        let signs = Vector::from_fn(self.states(), |state, _| sign(kept, state));
        Ok(at.half_monodromy(&passages, &signs))
    }
}

impl Covers for AffineOrbit {
    fn repeats(&self, node: &Node) -> Option<(Critical, OrbitTermination)> {
        // a point is the same after every part of its period
        if self.is_point(&node.point) {
            return Some(vanishes(self.is_hopf(&node.point)));
        }
        if let Some(vanishing) = self.comes_to_a_point(node, NEARLY_A_POINT) {
            return Some(vanishing.outcome());
        }
        let times = self.traversals(&node.point);
        (times > 1).then_some((
            Critical::Repeats { times },
            OrbitTermination::Repeats { times },
        ))
    }

    fn part(&self, point: &Vector) -> Option<(AffineOrbit, Vector)> {
        self.half(point)
    }

    fn whole(&self, part: &AffineOrbit, point: &Vector) -> Option<Vector> {
        let mut zones = part.at(point).ok()?.zones;
        row::twice(&self.sequence, &mut zones);
        Some(self.pack(&zones, &part.values_at(point)))
    }

    fn has_images(&self) -> bool {
        true
    }

    /// A symmetry may exchange zones and modes and begin elsewhere in time: durations and multipliers are the same.
    fn image(
        &self,
        point: &Vector,
        other: &AffineOrbit,
        of_other: &Vector,
    ) -> Option<(Critical, OrbitTermination)> {
        self.has_image(point, other, of_other)
            .then_some((Critical::Symmetric, OrbitTermination::Retraces))
    }

    fn becomes_image(
        &self,
        before: &Vector,
        point: &Vector,
    ) -> Option<(Critical, OrbitTermination)> {
        let own = self.half_later(point, ALMOST);
        let own = own.and_then(HalfLater::kept);
        let becomes =
            own.is_some() && self.half_later(before, LACKS).is_none() && !self.is_small(point);
        becomes.then_some((Critical::Symmetric, OrbitTermination::Retraces))
    }

    /// The symmetric orbit at which a branch without symmetry ends, from a point next to it, and the error of the parameter
    /// there: the branch of symmetric orbits, by the equations of half of them, passes it.
    fn symmetric_near(&self, point: &Vector, tolerance: f64) -> Option<(Vector, f64)> {
        /// Arclengths to either side within which it is looked for.
        const NEAR: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];
        if !self.has_half() {
            return None;
        }
        let kept = self.half_later(point, ALMOST)?.kept()?;
        let half = Half { orbit: self, kept };
        let last = point.len() - 1;
        let mut level = newton::Fixed {
            index: last,
            value: point[last],
        };
        let mut along = Vector::zeros(last + 1);
        along[last] = 1.0;
        let from = Node::at(point.clone(), along);
        let middle = locate::solve(&half, &from, point, &mut level, tolerance)?.node;
        let lost = NEAR.into_iter();
        let (place, error) = lost
            .filter_map(|near| half.loss(&middle, [-near, near], tolerance))
            .next()?;
        let point = place.node.point;
        self.loses_symmetry(&point).then_some((point, error))
    }

    /// Whether a step leads from a branch to one that it ends on, beyond the place where it would turn back: from an orbit to one of
    /// half its period or to a symmetric one.
    fn falls_on_another(&self, before: &Vector, point: &Vector) -> bool {
        self.half_later(point, LACKS).is_some()
            && self.half_later(before, IMAGE).is_none()
            && !self.is_small(point)
    }
}
