//! Pseudo-arclength continuation of R(u) = 0, n equations in n + 1 unknowns.
//!
//! From a point u₀ with unit tangent t₀ a step predicts u₀ + Δs·t₀, bent as the curve was on its last steps
//! where evaluations are dear ([`Equations::KEEPS`]), and corrects in the plane across t₀ through u₀ + Δs·t₀. Lengths are Euclidean in the scaled unknowns, so the scaling of the system is the
//! norm of the arclength. Keller, in: Applications of Bifurcation Theory (1977).

use serde::{Deserialize, Serialize};

use crate::continuation::newton::{self, Constraint, Equations, Failure, Plane, Solution};
use crate::linalg::{self, Vector};

/// First step along the branch where none is given, in dimensionless scaled arclength.
pub const DEFAULT_DS: f64 = 0.005;
/// Smallest step where none is given, in dimensionless scaled arclength.
pub const DEFAULT_DS_MIN: f64 = 1e-12;
/// Largest step where none is given, in dimensionless scaled arclength.
pub const DEFAULT_DS_MAX: f64 = 0.01;
/// Relative size of the Newton correction at which a point is accepted where none is given.
pub const DEFAULT_TOLERANCE: f64 = 1e-10;

/// Step lengths and tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// First step, in scaled arclength.
    pub ds: f64,
    /// Shortest step; below it the branch ends.
    pub ds_min: f64,
    /// Longest step.
    pub ds_max: f64,
    /// Largest component of the last Newton correction (scaled unknowns).
    pub tolerance: f64,
}

impl Default for Steps {
    fn default() -> Steps {
        Steps {
            ds: DEFAULT_DS,
            ds_min: DEFAULT_DS_MIN,
            ds_max: DEFAULT_DS_MAX,
            tolerance: DEFAULT_TOLERANCE,
        }
    }
}

/// A step turns the tangent by at most this angle (radians), or it is repeated shorter: events
/// are watched at its ends only, and a function that turns less cannot hide a pair of them from
/// the interpolation that looks for it.
pub(crate) const LARGEST_ANGLE: f64 = 0.3;

/// Angle and Newton contraction at which the step length is kept.
const TARGET_ANGLE: f64 = 0.06;
const TARGET_CONTRACTION: f64 = 0.05;

/// Factors by which a step may change from one to the next.
const MOST_GROWTH: f64 = 1.5;
const MOST_SHRINKING: f64 = 0.3;

/// A point of a branch with its unit tangent.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Scaled unknowns; the last one is the parameter.
    pub point: Vector,
    /// Unit tangent, oriented along the branch.
    pub tangent: Vector,
    /// Newton iterations spent.
    pub newton: usize,
    /// Largest residual.
    pub residual: f64,
}

impl Node {
    /// The angle between its tangent and that of another one, in radians.
    pub(crate) fn angle_to(&self, other: &Node) -> f64 {
        self.tangent.dot(&other.tangent).clamp(-1.0, 1.0).acos()
    }

    /// A point that is known already.
    pub(crate) fn at(point: Vector, tangent: Vector) -> Node {
        Node {
            point,
            tangent,
            newton: 0,
            residual: 0.0,
        }
    }

    /// A point of the zero set with the null vector of the Jacobian of its system as tangent, either way round;
    /// `None` where that cannot be evaluated.
    pub fn on<S: Equations>(system: &S, point: Vector) -> Option<Node> {
        Node::within(system, point, f64::INFINITY)
    }

    /// The same where no residual is larger than this.
    pub(crate) fn within<S: Equations>(system: &S, point: Vector, most: f64) -> Option<Node> {
        let (matrix, residual) = newton::jacobian(system, &point).ok()?;
        if residual > most {
            return None;
        }
        let tangent = linalg::kernel(&matrix)?.null_vector;
        Some(Node {
            residual,
            ..Node::at(point, tangent)
        })
    }

    /// The node seen the other way.
    pub fn backwards(&self) -> Node {
        Node {
            tangent: -&self.tangent,
            ..self.clone()
        }
    }
}

/// A step that was taken, with the advice for the next.
#[derive(Clone, Debug)]
pub struct ArclengthStep {
    /// New point.
    pub node: Node,
    /// Advised length of the next step, not yet limited to the settings.
    pub next: f64,
}

/// Why a step was refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Refusal<F: std::error::Error> {
    /// The corrector failed.
    #[error("{0}")]
    Corrector(#[from] Failure<F>),
    /// The branch turns too much within the step.
    #[error("the tangent turns by {angle:.2} rad in one step")]
    Angle {
        /// Angle between the tangents.
        angle: f64,
    },
}

/// Unit tangent at a solution, oriented so that it has a positive product with `along`.
pub fn tangent<S: Equations>(
    system: &S,
    solution: &Solution,
    along: &Vector,
) -> Result<Vector, Failure<S::Failure>> {
    let n = system.unknowns();
    let mut direction = Vector::zeros(n);
    direction[n - 1] = 1.0;
    if !solution.factors.solve(&mut direction) {
        return Err(Failure::Singular);
    }
    let length = direction.norm();
    let sign = if direction.dot(along) < 0.0 {
        -1.0
    } else {
        1.0
    };
    Ok(direction * (sign / length))
}

/// Corrects a guess under a constraint and finds the tangent there.
pub(crate) fn correct<S: Equations>(
    system: &S,
    constraint: &mut impl Constraint<S>,
    guess: &Vector,
    along: &Vector,
    settings: &newton::Settings,
) -> Result<(Node, Solution), Failure<S::Failure>> {
    let solution = newton::solve(system, constraint, guess, settings)?;
    let tangent = tangent(system, &solution, along)?;
    let node = Node {
        point: solution.point.clone(),
        tangent,
        newton: solution.iterations,
        residual: solution.residual,
    };
    Ok((node, solution))
}

/// Nodes before the one a step sets out from that tell how the curve bends.
pub(crate) const NODES_BEFORE: usize = 2;

/// What a node tells of w(σ) = σ²q(σ), by which the curve leaves the tangent of another node, σ being the place along that.
struct Bend {
    place: f64,
    /// q, and its slope.
    value: Vector,
    slope: Vector,
}

impl Bend {
    /// `None` where the curve has turned too far in between.
    fn seen(before: &Node, from: &Node) -> Option<Bend> {
        /// Of the tangents, the least cosine.
        const TURNED: f64 = 0.5;
        let away = &before.point - &from.point;
        let (place, cosine) = (from.tangent.dot(&away), from.tangent.dot(&before.tangent));
        if place >= 0.0 || cosine < TURNED {
            return None;
        }
        let value = (away - &from.tangent * place) / (place * place);
        let leaves = (&before.tangent / cosine - &from.tangent) / (place * place);
        let slope = leaves - &value * (2.0 / place);
        Some(Bend {
            place,
            value,
            slope,
        })
    }
}

/// By what a curve leaves its tangent beyond a node, where it is in the plane across at `ds`: as the polynomial does that has
/// the points and the tangents of the node and of those before it, the last first. An error of it costs corrections and
/// nothing else.
fn bend(before: &[Node], from: &Node, ds: f64) -> Option<Vector> {
    /// Steps longer than this in the last one leave what nodes before tell of.
    const FARTHEST: f64 = 4.0;
    /// No curve is believed to leave its tangent by more than this part of a step.
    const MOST: f64 = 0.5;
    let last = Bend::seen(before.first()?, from)?;
    let (beyond, other) = (ds - last.place, before.get(1));
    if ds > -FARTHEST * last.place {
        return None;
    }
    let mut q = &last.value + &last.slope * beyond;
    if let Some(other) = other.and_then(|node| Bend::seen(node, from))
        && other.place < last.place
    {
        let apart = last.place - other.place;
        let mean = (&last.value - &other.value) / apart;
        let second = (&last.slope - &mean) / apart;
        let third = (&second - (mean - other.slope) / apart) / apart;
        q += (second + third * (ds - other.place)) * (beyond * beyond);
    }
    let bend = q * (ds * ds);
    (bend.norm() <= MOST * ds.abs()).then_some(bend)
}

/// One step of length `ds` from `from` along its tangent; `before` are nodes before it on the same curve, the last first.
pub fn advance<S: Equations>(
    system: &S,
    from: &Node,
    before: &[Node],
    ds: f64,
    tolerance: f64,
) -> Result<ArclengthStep, Refusal<S::Failure>> {
    let through = &from.point + &from.tangent * ds;
    let bend = || bend(before, from, ds);
    let predicted = match S::KEEPS.then(bend).flatten() {
        Some(bend) => &through + bend,
        None => through.clone(),
    };
    let mut plane = Plane {
        normal: &from.tangent,
        through: &through,
    };
    let settings = newton::Settings {
        tolerance,
        ..newton::Settings::default()
    };
    let (node, solution) = correct(system, &mut plane, &predicted, &from.tangent, &settings)?;
    let angle = node.angle_to(from);
    if angle > LARGEST_ANGLE {
        return Err(Refusal::Angle { angle });
    }
    // the angle is proportional to the step, the contraction to its square
    let by_angle = TARGET_ANGLE / angle.max(1e-12);
    let by_contraction = (TARGET_CONTRACTION / solution.contraction.max(1e-12)).sqrt();
    let factor = by_angle
        .min(by_contraction)
        .clamp(MOST_SHRINKING, MOST_GROWTH);
    Ok(ArclengthStep {
        node,
        next: ds * factor,
    })
}

/// Puts a node that has been passed before those that were passed earlier, of which few are kept.
pub(crate) fn passed(before: &mut Vec<Node>, node: Node) {
    before.truncate(NODES_BEFORE - 1);
    before.insert(0, node);
}

/// A zero curve step by step: where each step sets out and where it comes to, as long as there are steps.
/// [`Walker`](super::walk::Walker) does more: it also meets what happens on the way.
pub struct Path<'a, S> {
    system: &'a S,
    node: Node,
    before: Vec<Node>,
    steps: Steps,
}

impl<'a, S: Equations> Path<'a, S> {
    /// From a point of the zero set, toward greater values of the parameter or toward smaller ones; `None` where
    /// the system cannot be evaluated or its Jacobian has no full rank.
    pub fn from(system: &'a S, point: Vector, up: bool, steps: Steps) -> Option<Path<'a, S>> {
        let node = Node::on(system, point)?;
        let is_up = node.tangent[node.tangent.len() - 1] > 0.0;
        let node = if is_up == up { node } else { node.backwards() };
        Some(Path {
            system,
            node,
            before: Vec::new(),
            steps,
        })
    }
}

impl<S: Equations> Iterator for Path<'_, S> {
    type Item = [Node; 2];

    fn next(&mut self) -> Option<[Node; 2]> {
        let Steps { ds_min, ds_max, .. } = self.steps;
        let mut ds = self.steps.ds.clamp(ds_min, ds_max);
        loop {
            match advance(
                self.system,
                &self.node,
                &self.before,
                ds,
                self.steps.tolerance,
            ) {
                Ok(step) => {
                    self.steps.ds = step.next;
                    let from = std::mem::replace(&mut self.node, step.node);
                    passed(&mut self.before, from.clone());
                    return Some([from, self.node.clone()]);
                }
                Err(_) if ds <= ds_min => return None,
                Err(_) => ds = (0.5 * ds).max(ds_min),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::circle::UnitCircle;

    /// w(σ) = 1 − √(1 − σ²) has the coefficients 1/8 and 1/16 of σ⁴ and σ⁶: at σ = h, by nodes near −h and −2h, the polynomial is
    /// off by the first times h²·(2h)², with two of them by the second times h²·(2h)²·(3h)², and by half of that again at most.
    #[test]
    fn a_circle_bends_as_nodes_before_tell() {
        let node = |angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            let [point, tangent] =
                [[cosine, sine], [-sine, cosine]].map(|of| Vector::from_vec(of.into()));
            Node::at(point, tangent)
        };
        for h in [0.02_f64, 0.05, 0.1] {
            let before = [node(-h), node(-2.0 * h)];
            let off = |before: &[Node]| {
                let bend = bend(before, &node(0.0), h).unwrap();
                assert!(bend[1].abs() <= f64::EPSILON);
                (bend[0] - ((1.0 - h * h).sqrt() - 1.0)).abs()
            };
            assert!(off(&before[..1]) <= 1.5 * 0.5 * h.powi(4));
            assert!(off(&before) <= 1.5 * 2.25 * h.powi(6) + 100.0 * f64::EPSILON);
        }
        assert!(
            bend(&[], &node(0.0), 0.1).is_none() && bend(&[node(-0.01)], &node(0.0), 0.1).is_none()
        );
    }

    /// Round both folds and back to the start; every point lies on the circle to rounding.
    #[test]
    fn follows_a_circle_round_its_folds() {
        let steps = Steps {
            ds: 0.05,
            ds_max: 0.1,
            ..Steps::default()
        };
        let begin = Vector::from_vec(vec![1.0, 0.0]);
        let path = Path::from(&UnitCircle, begin, true, steps).unwrap();
        let (mut turned, mut last) = (0.0, 0.0_f64);
        for [_, node] in path.take(1000) {
            assert!((node.point.norm() - 1.0).abs() < 4.0 * f64::EPSILON);
            let angle = node.point[1].atan2(node.point[0]);
            turned += (angle - last).rem_euclid(std::f64::consts::TAU);
            last = angle;
            if turned > std::f64::consts::TAU {
                return;
            }
        }
        panic!("the circle was not closed: turned by {turned}");
    }
}
