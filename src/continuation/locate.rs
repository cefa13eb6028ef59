//! Points within a step: at an arclength, under a constraint, at the zero of a function.
//!
//! A step sets out from u₀ with tangent t₀; s = t₀·(u − u₀) orders what lies within it.

use super::arclength::{LARGEST_ANGLE, Node};
use super::newton::{self, Constraint, Equations, Fixed, Plane};
use super::zero::{Bracket, zero};
use crate::linalg::{Factors, Matrix, Vector};

/// A point within a step.
#[derive(Clone, Debug)]
pub struct Place {
    /// Arclength from the beginning of the step.
    pub s: f64,
    /// The point, its tangent along the curve.
    pub node: Node,
    /// Largest component of the last Newton correction: the scaled unknowns are known no better.
    pub blur: f64,
}

/// Settings of the Newton iterations that locate points: one iteration more than needed.
fn settings(tolerance: f64) -> newton::Settings {
    newton::Settings {
        tolerance,
        most_iterations: 12,
        halvings: 0,
        polish: 1,
    }
}

/// A solved point as a node: the tangent from a Jacobian evaluated there, oriented like `along`.
pub fn retangent<S: Equations>(
    system: &S,
    point: &Vector,
    along: &Vector,
    newton: usize,
) -> Option<Node> {
    let n = system.unknowns();
    let mut matrix = Matrix::zeros(n, n);
    let mut residual = Vector::zeros(n - 1);
    system
        .evaluate(point, residual.as_mut_slice(), &mut matrix)
        .ok()?;
    let relative = newton::relative_residual(&matrix, residual.as_slice());
    for column in 0..n {
        matrix[(n - 1, column)] = along[column];
    }
    let mut tangent = Vector::zeros(n);
    tangent[n - 1] = 1.0;
    if !Factors::new(&matrix).solve(&mut tangent) {
        return None;
    }
    let length = tangent.norm();
    tangent /= length;
    Some(Node {
        point: point.clone(),
        tangent,
        newton,
        residual: relative,
    })
}

/// Solves the system together with a constraint, from a guess within the step that sets out from a node.
/// The tangent comes from the arclength border: the constraint's own may be singular there.
pub fn solve<S: Equations>(
    system: &S,
    from: &Node,
    guess: &Vector,
    constraint: &mut impl Constraint<S>,
    tolerance: f64,
) -> Option<Place> {
    let solution = newton::solve(system, constraint, guess, &settings(tolerance)).ok()?;
    let node = retangent(system, &solution.point, &from.tangent, solution.iterations)?;
    Some(Place {
        s: from.tangent.dot(&(&node.point - &from.point)),
        node,
        blur: solution.correction,
    })
}

/// The node at arclength s of the step that sets out from a node; `None` where Newton's method finds none.
pub fn node_at<S: Equations>(system: &S, from: &Node, s: f64, tolerance: f64) -> Option<Node> {
    node_beside(system, from, (0.0, from), s, tolerance)
}

/// The same by the tangent of a node of the step that is known, at an arclength of its own.
pub fn node_beside<S: Equations>(
    system: &S,
    from: &Node,
    (known, near): (f64, &Node),
    s: f64,
    tolerance: f64,
) -> Option<Node> {
    let along = (s - known) / near.tangent.dot(&from.tangent);
    let predicted = &near.point + &near.tangent * along;
    let through = &from.point + &from.tangent * s;
    let mut plane = Plane {
        normal: &from.tangent,
        through: &through,
    };
    let solution = newton::solve(system, &mut plane, &predicted, &settings(tolerance)).ok()?;
    // beside a place where curves cross the plane meets others, too
    let off = (&solution.point - &near.point).norm();
    if off > SIDEWAYS * (s - known).abs() + BESIDE * near.point.amax().max(1.0) {
        return None;
    }
    retangent(system, &solution.point, &from.tangent, solution.iterations)
}

/// A point of a step lies no further from another than so many times the arclength between them, as beyond a corner of 84 degrees, and
/// a part of unknowns of order one, far above what they are known to.
const SIDEWAYS: f64 = 10.0;
const BESIDE: f64 = 1e-3;

/// The node just beyond a kink of a curve within a step of this length; `None` where the curve turns smoothly. The part of the step within
/// which it turns too far is halved; a smooth curve turns by half as much then.
pub(crate) fn beyond_kink<S: Equations>(
    system: &S,
    from: &Node,
    ds: f64,
    tolerance: f64,
) -> Option<Node> {
    const HALVINGS: u32 = 8;
    let at = |s: f64| node_at(system, from, s, tolerance);
    let (mut low, mut high) = ((0.0, from.clone()), (ds, at(ds)?));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low.0 + high.0);
        let node = at(middle)?;
        let turns = node.angle_to(from) > LARGEST_ANGLE;
        *(if turns { &mut high } else { &mut low }) = (middle, node);
    }
    let is_kink = low.1.angle_to(&high.1) > 0.5 * LARGEST_ANGLE;
    is_kink.then_some(high.1)
}

/// The zero of a function along a step, from places s with values of different signs, and the value
/// found. `size` is a value that is zero but for rounding; from a bracket as narrow as `width` one more
/// value is taken. Where no point is found, as where branches cross at the very zero, one beside it is taken, on either side.
/// `None` where there is none, either.
pub fn zero_along<S: Equations>(
    system: &S,
    from: &Node,
    (low, high): ((f64, f64), (f64, f64)),
    (size, width): (f64, f64),
    tolerance: f64,
    mut value: impl FnMut(&Node) -> Option<f64>,
) -> Option<(Place, f64)> {
    let mut ends = (low.0, high.0);
    let mut last = (0.0, from.clone());
    let at = |s: f64| {
        let near = (last.0, &last.1);
        let node_at = |s: f64| Some((s, node_beside(system, from, near, s, tolerance)?));
        // two of them are a bracket that is narrow enough
        let aside = || node_at(s + (0.25 * width).copysign(0.5 * (ends.0 + ends.1) - s));
        let (s, node) = node_at(s).or_else(aside).ok_or(())?;
        last = (s, node.clone());
        let here = value(&node).ok_or(())?;
        let vanishes = here.abs() <= size || (ends.1 - ends.0).abs() <= width;
        let end = if (here > 0.0) == (low.1 > 0.0) {
            &mut ends.0
        } else {
            &mut ends.1
        };
        *end = s;
        Ok::<_, ()>((if vanishes { 0.0 } else { here }, (s, node, here)))
    };
    let zero = zero(Bracket::new(low, high), 0.0, at).ok()?;
    let (s, node, here) = zero.found;
    Some((Place { s, node, blur: 0.0 }, here))
}

/// Slope of the parameter along the arc at which a fold counts as found. The parameter is
/// quadratic there, so its error is of order 1e-26; speed and zone lengths are linear, with an
/// error near 1e-13.
pub(crate) const FOLD_SLOPE: f64 = 1e-13;

/// The fold between two places s of a step with slopes of the parameter of different signs, and the slope found:
/// the zero of the last component of the tangent.
pub fn fold<S: Equations>(
    system: &S,
    from: &Node,
    (low, high): ((f64, f64), (f64, f64)),
    tolerance: f64,
) -> Option<(Place, f64)> {
    let small = (FOLD_SLOPE, 4.0 * f64::EPSILON * high.0);
    let slope = |node: &Node| node.tangent.as_slice().last().copied();
    zero_along(system, from, (low, high), small, tolerance, slope)
}

/// The fold within a step, where the parameter turns back between its ends.
pub fn turning<S: Equations>(system: &S, [from, to]: &[Node; 2], tolerance: f64) -> Option<Place> {
    let last = from.tangent.len() - 1;
    let length = from.tangent.dot(&(&to.point - &from.point));
    let (low, high) = ((0.0, from.tangent[last]), (length, to.tangent[last]));
    let fold = (low.1 * high.1 < 0.0).then(|| fold(system, from, (low, high), tolerance));
    fold.flatten().map(|(place, _)| place)
}

/// Part of the smaller value at the ends of a step below which what is least in it comes near zero.
const DEEP: f64 = 0.5;

/// A function that is positive at both ends of a step: its value and its slope along the curve at either end.
pub(crate) type Ends = [(f64, f64); 2];

/// How far along a step of length `ds` a function is least that falls at its beginning and rises at its
/// end, by the cubic that shares values and slopes; `None` where it does not come near zero.
pub(crate) fn dip(ds: f64, [(m0, d0), (m1, d1)]: Ends) -> Option<f64> {
    let (d0, d1) = (ds * d0, ds * d1);
    if !(d0 < 0.0 && d1 > 0.0) {
        return None;
    }
    // m0 + d0·x + b·x² + a·x³, whose slope changes its sign once
    let a = 2.0 * (m0 - m1) + d0 + d1;
    let b = 3.0 * (m1 - m0) - 2.0 * d0 - d1;
    let x = -d0 / (b + (b * b - 3.0 * a * d0).sqrt());
    let least = m0 + x * (d0 + x * (b + x * a));
    (least < DEEP * m0.min(m1)).then_some(x * ds)
}

/// How far along a step the tangents at both ends of a function meet near zero or below; `None` where they do not. The larger
/// or smaller of two functions that pass one another has a kink there, which no cubic has.
pub(crate) fn kink(ds: f64, [(m0, d0), (m1, d1)]: Ends) -> Option<f64> {
    let s = (m1 - d1 * ds - m0) / (d0 - d1);
    (0.0 < s && s < ds && m0 + d0 * s < DEEP * m0.min(m1)).then_some(s)
}

/// What a function does within a step that is positive at both ends.
pub(crate) enum LeastWithin {
    /// It does not come near zero.
    Far,
    /// Its least value and where that is.
    Found(Place, f64),
    /// It may vanish and its least value is not found.
    NotFound,
}

/// The least value of a function within a step of length `ds`: the zero of its slope. `f` gives value and
/// slope along the curve.
pub(crate) fn least<S: Equations>(
    system: &S,
    from: &Node,
    ds: f64,
    ends: Ends,
    tolerance: f64,
    f: impl FnMut(&Node) -> Option<(f64, f64)>,
) -> LeastWithin {
    match dip(ds, ends) {
        Some(guess) => least_from(system, from, (ds, guess), ends, tolerance, f),
        None => LeastWithin::Far,
    }
}

/// The same from a guess how far along the step that is.
pub(crate) fn least_from<S: Equations>(
    system: &S,
    from: &Node,
    (ds, guess): (f64, f64),
    ends: Ends,
    tolerance: f64,
    mut f: impl FnMut(&Node) -> Option<(f64, f64)>,
) -> LeastWithin {
    /// A slope below this part of those at the ends, or a place known to this part of the step, leaves an
    /// error of its square in the value.
    const LEVEL: f64 = 1e-8;
    let [(_, d0), (_, d1)] = ends;
    let level = LEVEL * d1.min(-d0);
    let mut bracket = Bracket::new((0.0, d0), (ds, d1));
    let mut at = |s: f64| {
        let node = node_at(system, from, s, tolerance).ok_or(())?;
        let (value, slope) = f(&node).ok_or(())?;
        Ok::<_, ()>((slope, (node, value)))
    };
    let found = match at(guess) {
        Err(()) => return LeastWithin::NotFound,
        Ok((slope, found)) if slope.abs() <= level => Ok((guess, found)),
        Ok((slope, _)) => {
            bracket.shrink(guess, slope);
            let level_at = |s: f64| {
                at(s).map(|(slope, found)| (if slope.abs() <= level { 0.0 } else { slope }, found))
            };
            zero(bracket, LEVEL * ds, level_at).map(|zero| (zero.place, zero.found))
        }
    };
    match found {
        Ok((s, (node, value))) => LeastWithin::Found(Place { s, node, blur: 0.0 }, value),
        Err(()) => LeastWithin::NotFound,
    }
}

/// A value of one unknown to be met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Which unknown.
    pub index: usize,
    /// Its value.
    pub value: f64,
    /// Where the target is an edge of a range, the side that lies outside: −1 below, 1 above; 0 for
    /// a value inside.
    pub outside: f64,
}

/// Relative distance at which a point lies on a target.
const ON_TARGET: f64 = 1e-13;
/// Distance in the unit of the unknown at which it lies on an edge.
const ON_EDGE: f64 = 8.0 * f64::EPSILON;

impl Target {
    /// Whether the way from one point to another meets the target. A beginning on the target has met it
    /// already, unless it is an edge and the way leads out.
    fn is_met(&self, one: &Vector, other: &Vector) -> bool {
        let (before, after) = (one[self.index] - self.value, other[self.index] - self.value);
        // an edge at zero is met to rounding of the range, by what was solved for
        let least = if self.outside == 0.0 {
            f64::MIN_POSITIVE
        } else {
            ON_EDGE
        };
        if before.abs() <= (ON_TARGET * self.value.abs()).max(least) {
            return after * self.outside > 0.0;
        }
        before * after <= 0.0
    }

    /// The points at which the target is met on a way through points of one step, between which the
    /// unknown is monotone. `None` if one is not found.
    pub(crate) fn meetings<S: Equations>(
        &self,
        system: &S,
        from: &Node,
        way: &[&Vector],
        tolerance: f64,
    ) -> Option<Vec<Place>> {
        let pairs = way.windows(2).filter(|pair| self.is_met(pair[0], pair[1]));
        let place = |pair: &[&Vector]| {
            let (one, other) = (pair[0], pair[1]);
            let (before, after) = (one[self.index] - self.value, other[self.index] - self.value);
            let guess = one + (other - one) * (before / (before - after));
            let mut fixed = Fixed {
                index: self.index,
                value: self.value,
            };
            let mut near = |guess: &Vector| {
                let solved = solve(system, from, guess, &mut fixed, tolerance)?;
                let off = (&solved.node.point - guess).norm();
                (off <= (other - one).norm()).then_some(solved)
            };
            // where a family of solutions has the value that is asked for, others than the one of the step have it as well
            let mut place = match near(&guess) {
                Some(place) => place,
                None => {
                    let along = |point: &Vector| from.tangent.dot(&(point - &from.point));
                    let ends = ((along(one), before), (along(other), after));
                    let rounding = ON_TARGET * self.value.abs().max(1.0);
                    let value = |node: &Node| Some(node.point[self.index] - self.value);
                    let (place, _) =
                        zero_along(system, from, ends, (rounding, 0.0), tolerance, value)?;
                    near(&place.node.point).unwrap_or(place)
                }
            };
            // exactly the value that was asked for, not the next number
            place.node.point[self.index] = self.value;
            Some(place)
        };
        pairs.map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A beginning that is solved for lies on an edge to rounding, on either side of it: the way out meets the edge, the way in does
    /// not, whatever the value of the edge.
    #[test]
    fn an_edge_is_met_on_the_way_out_alone() {
        for value in [0.0, 1.0, -0.3] {
            for outside in [-1.0, 1.0] {
                let edge = Target {
                    index: 0,
                    value,
                    outside,
                };
                for rounding in [-1.2e-16, 0.0, 1.2e-16] {
                    let at = |x: f64| Vector::from_element(1, x);
                    let begin = at(value + rounding);
                    assert!(edge.is_met(&begin, &at(value + 0.1 * outside)));
                    assert!(!edge.is_met(&begin, &at(value - 0.1 * outside)));
                }
                let inside = Vector::from_element(1, value - 0.1 * outside);
                assert!(edge.is_met(&inside, &Vector::from_element(1, value + 0.1 * outside)));
            }
        }
    }
}
