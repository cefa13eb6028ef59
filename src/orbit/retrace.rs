//! Where a branch comes to an orbit beyond which it would retrace itself: one that is a shorter orbit traversed twice,
//! or one with a symmetry that those before it lack.
//!
//! At a loss of symmetry the branch of symmetric orbits passes, and the others are one branch of which each half is the
//! image of the other: seen from it the parameter turns back. What a symmetry leaves alone is then the same on both
//! sides of the fold, as it is not at any other fold, where a multiplier passes 1.

use super::crossings::is_crossing;
use super::{Examined, Orbit, Terminations, uncertainty};
use crate::continuation::Node;
use crate::continuation::locate::{self, Place};
use crate::continuation::newton::{self, Plane};
use crate::linalg::Vector;

/// Orbits that are traversed several times, and orbits that are images of others under a symmetry: beyond them a branch would
/// retrace itself.
pub trait Covers: Terminations {
    /// What a fold is where the branch would retrace itself, and why it ends there: its orbit is one of a part of
    /// its period.
    fn repeats(&self, _node: &Node) -> Option<(Self::Special, Self::Termination)> {
        None
    }

    /// The orbit of half the period that an orbit is when traversed twice, and its scaled unknowns: where the branch
    /// would retrace itself the first of its [`Examined::tests`] vanishes.
    fn part(&self, _point: &Vector) -> Option<(Self, Vector)> {
        None
    }

    /// That orbit traversed as often as this one: scaled unknowns of this one.
    fn whole(&self, _part: &Self, _point: &Vector) -> Option<Vector> {
        None
    }

    /// Whether [`Covers::image`] may be told: where it may not, orbits on both sides are not asked for.
    fn has_images(&self) -> bool {
        false
    }

    /// What it is, and why the branch ends there, where it turns back and an orbit on one side is the image of one on the
    /// other, at the same value of the parameter, under a symmetry of the system.
    fn image(
        &self,
        _point: &Vector,
        _other: &Self,
        _of_other: &Vector,
    ) -> Option<(Self::Special, Self::Termination)> {
        None
    }

    /// What an orbit may be, and why the branch ends there, where it comes to a symmetry that one before it lacks.
    fn becomes_image(
        &self,
        _before: &Vector,
        _point: &Vector,
    ) -> Option<(Self::Special, Self::Termination)> {
        None
    }

    /// The symmetric orbit next to a point at which a branch without its symmetry ends, and the error of the parameter there, by
    /// equations that are not singular at it; `None` where there are none, or they have no such solution.
    fn symmetric_near(&self, _point: &Vector, _tolerance: f64) -> Option<(Vector, f64)> {
        None
    }

    /// Whether a step leads from one orbit to another beyond the place where the branch would turn back.
    fn falls_on_another(&self, _before: &Vector, _point: &Vector) -> bool {
        false
    }
}

/// The orbit with the value of the parameter that another one has, next to a guess.
fn level<O: Orbit>(orbit: &O, guess: &Vector, value: f64, tolerance: f64) -> Option<Node> {
    let last = guess.len() - 1;
    let mut fixed = newton::Fixed { index: last, value };
    let mut along = Vector::zeros(last + 1);
    along[last] = 1.0;
    let mut guess = guess.clone();
    guess[last] = value;
    let from = Node::at(guess.clone(), along);
    Some(locate::solve(orbit, &from, &guess, &mut fixed, tolerance)?.node)
}

/// The same where the guess is next to a place at which the equations are singular: Newton's corrections may grow before they
/// shrink.
fn level_beside<O: Orbit>(orbit: &O, guess: &Vector, value: f64, tolerance: f64) -> Option<Node> {
    let settings = newton::Settings {
        tolerance,
        most_iterations: 30,
        halvings: 8,
        polish: 1,
    };
    let last = guess.len() - 1;
    let mut fixed = newton::Fixed { index: last, value };
    let mut guess = guess.clone();
    guess[last] = value;
    let solution = newton::solve(orbit, &mut fixed, &guess, &settings).ok()?;
    level(orbit, &solution.point, value, tolerance)
}

/// What a fold within a step of length `ds` is where the branch beyond it is the image of that before, and why the
/// branch ends there.
pub(super) fn at_fold<O: Orbit>(
    orbit: &O,
    from: &Node,
    fold: &Place,
    ds: f64,
    tolerance: f64,
) -> Option<(O::Special, O::Termination)> {
    /// Where both sides are compared: a part of the step, and in scaled units far enough from a singular place.
    const PART: f64 = 0.25;
    const AWAY: f64 = 3e-3;
    if !orbit.has_images() {
        return None;
    }
    let away = (PART * ds).max(AWAY);
    let beside = |s: f64| locate::node_at(orbit, from, fold.s + s, tolerance);
    let (one, other) = (beside(-away)?, beside(away)?);
    let last = one.point.len() - 1;
    let other = level(orbit, &other.point, one.point[last], tolerance)?;
    orbit.image(&one.point, orbit, &other.point)
}

/// The same of a change beyond which the branch turns back, from a node before it to one beyond of another signature.
pub(super) fn at_change<O: Orbit>(
    orbit: &O,
    node: &Node,
    (beyond, entered): (&O, &Node),
    ds: f64,
    tolerance: f64,
) -> Option<(O::Special, O::Termination)> {
    /// How many times as far an orbit before the change may be.
    const FAR: f64 = 10.0;
    if !orbit.has_images() {
        return None;
    }
    let after = locate::node_at(beyond, entered, ds, tolerance)?;
    let (here, there) = (node.point.len() - 1, after.point.len() - 1);
    let value = after.point[there];
    let back = (value - node.point[here]) / node.tangent[here];
    let guess = &node.point + &node.tangent * back;
    // images are as far from the change, but for the zones that arclength counts
    let is_near = back < 0.0 && back > -FAR * ds;
    let before = is_near.then(|| level(orbit, &guess, value, tolerance))??;
    orbit.image(&before.point, beyond, &after.point)
}

/// The symmetric orbit at which the branch turns back, and the error of the parameter there, from the branch of symmetric
/// orbits, which passes. `side` is the way that the parameter goes along the branch on both sides. `None` where it is not
/// found.
pub(super) fn symmetric<O: Orbit>(
    orbit: &O,
    fold: &Node,
    side: f64,
    special: &O::Special,
    tolerance: f64,
) -> Option<(Vector, f64)> {
    /// How far from the fold the parameter is where there is none but the symmetric orbit.
    const BEYOND: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];
    if let Some(known) = orbit.symmetric_near(&fold.point, tolerance) {
        return Some(known);
    }
    let tested = orbit.tested()?;
    let last = fold.point.len() - 1;
    BEYOND.into_iter().find_map(|beyond| {
        let value = fold.point[last] - side.signum() * beyond;
        let begin = level(&tested, &fold.point, value, tolerance);
        let begin = begin.or_else(|| level_beside(&tested, &fold.point, value, tolerance))?;
        let tests = |node: &Node| Some(tested.examination(&node.point).ok()?.tests().to_vec());
        let far = side.signum() * 2.0 * beyond / begin.tangent[last];
        let values = [
            tests(&begin)?,
            tests(&locate::node_at(&tested, &begin, far, tolerance)?)?,
        ];
        let crosses = |test: &usize| {
            values[0][*test] * values[1][*test] < 0.0
                && is_crossing(&tested, *test, &begin, special)
        };
        let test = (0..values[0].len()).find(crosses)?;
        let [first, second] = [(0.0, values[0][test]), (far, values[1][test])];
        let ends = if far > 0.0 {
            (first, second)
        } else {
            (second, first)
        };
        let small = (0.0, 4.0 * f64::EPSILON * far.abs());
        let value = |node: &Node| Some(tests(node)?[test]);
        let (place, _) = locate::zero_along(&tested, &begin, ends, small, tolerance, value)?;
        let mut plane = Plane {
            normal: &begin.tangent,
            through: &place.node.point,
        };
        let error = uncertainty(&tested, &mut plane, &place);
        Some((place.node.point, error + small.1 * orbit.unit().abs()))
    })
}

/// An orbit that is traversed twice, at the place where the multiplier of the single one is −1, and the error of the
/// parameter there: the branch of the single orbit passes it, while that of doubled ones turns back. `None` where it
/// is not found.
pub(super) fn doubling<O: Orbit>(orbit: &O, node: &Node, tolerance: f64) -> Option<(Vector, f64)> {
    /// Arclengths to either side within which it is looked for.
    const NEAR: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];
    let (part, point) = orbit.part(&node.point)?;
    let value = point[point.len() - 1];
    let middle = level(&part, &point, value, tolerance)?;
    let test = |node: &Node| Some(*part.examination(&node.point).ok()?.tests().first()?);
    let at = |s: f64| test(&locate::node_at(&part, &middle, s, tolerance)?);
    NEAR.into_iter().find_map(|near| {
        let ends = ((-near, at(-near)?), (near, at(near)?));
        if ends.0.1 * ends.1.1 >= 0.0 {
            return None;
        }
        let small = (0.0, 4.0 * f64::EPSILON * near);
        let (place, _) = locate::zero_along(&part, &middle, ends, small, tolerance, test)?;
        let mut plane = Plane {
            normal: &middle.tangent,
            through: &place.node.point,
        };
        let error = uncertainty(&part, &mut plane, &place) + small.1 * orbit.unit().abs();
        Some((orbit.whole(&part, &place.node.point)?, error))
    })
}
