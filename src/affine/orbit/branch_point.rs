//! Where two branches of orbits without a symmetry cross.
//!
//! With F(u) = 0 the n equations of an orbit in the n + 1 unknowns u, the parameter among them, F_u has rank n − 1 at a
//! simple branch point: a left null vector ψ and two null vectors, the columns of N. In the bordered equations
//!
//! > (1) F(u) + μψ = 0, Nᵀ(u − u₀) = c,
//!
//! which are regular there, μ is a function of the two numbers c, and both branches are its level μ = 0: they cross
//! where ∇μ = 0 (the Lyapunov-Schmidt reduction; Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria,
//! 2000). With w the solution of
//!
//! > (2) F_uᵀw + N∇μ = 0, ψ·w = 1
//!
//! the gradient is exact. Its own derivative H is a central difference, which bends the way of Newton's iterates and not
//! their limit. det H < 0 where two branches cross; along them τᵀHτ = 0.

use super::layout::AffineOrbit;
use crate::continuation::Node;
use crate::continuation::locate::{Place, node_at};
use crate::continuation::newton::{self, Equations};
use crate::linalg::{self, Factors, Matrix, Vector};
use crate::orbit::Orbit;

/// Newton's iterates at most, of the reduced equations and of the bordered ones: both are quadratic.
const MOST: usize = 12;

/// Step of the central differences in scaled unknowns of order one: truncation and rounding both leave 1e-8 of H.
const DIFFERENCE: f64 = 1e-4;

/// A last iterate smaller than this leaves nothing but rounding.
const STILL: f64 = 1e-11;

/// μ is zero to rounding at a branch point: more than this at the place where its gradient vanishes is an imperfect one,
/// which no branch passes.
const PERFECT: f64 = 1e-9;

/// Equations (1) at a base u₀.
struct BorderedOrbit<'a> {
    orbit: &'a AffineOrbit,
    base: Vector,
    left: Vector,
    null: Matrix,
}

/// A solution of (1) with ∇μ.
struct BorderedSolution {
    point: Vector,
    mu: f64,
    /// [F_u ψ; Nᵀ 0].
    matrix: Matrix,
    gradient: Vector,
}

impl<'a> BorderedOrbit<'a> {
    /// The borders at a point; `None` where the decomposition fails.
    fn new(orbit: &'a AffineOrbit, base: Vector) -> Option<BorderedOrbit<'a>> {
        let (jacobian, _) = newton::jacobian(orbit, &base).ok()?;
        let n = jacobian.nrows();
        let along = linalg::kernel(&jacobian)?.null_vector;
        let mut square = jacobian.insert_row(n, 0.0);
        square.row_mut(n).copy_from(&along.transpose());
        let least = linalg::least(&square)?;
        Some(BorderedOrbit {
            orbit,
            base,
            left: least.left.rows(0, n).into_owned(),
            null: Matrix::from_columns(&[along, least.right]),
        })
    }

    /// F and the bordered matrix at a point.
    fn at(&self, point: &Vector) -> Option<(Vector, Matrix)> {
        let unknowns = point.len();
        let n = unknowns - 1;
        let mut residual = Vector::zeros(n);
        let mut jacobian = Matrix::zeros(n, unknowns);
        let evaluated = self
            .orbit
            .evaluate(point, residual.as_mut_slice(), &mut jacobian);
        evaluated.ok()?;
        let mut matrix = Matrix::zeros(n + 2, n + 2);
        matrix.view_mut((0, 0), (n, unknowns)).copy_from(&jacobian);
        matrix.view_mut((0, unknowns), (n, 1)).copy_from(&self.left);
        matrix
            .view_mut((n, 0), (2, unknowns))
            .copy_from(&self.null.transpose());
        Some((residual, matrix))
    }

    /// ∇μ by (2).
    fn gradient(matrix: &Matrix) -> Option<Vector> {
        let size = matrix.nrows();
        let mut weights = Vector::zeros(size);
        weights[size - 1] = 1.0;
        let solved = Factors::new(&matrix.transpose()).solve(&mut weights);
        solved.then(|| weights.rows(size - 2, 2).into_owned())
    }

    /// The solution at c.
    fn solve(&self, c: &Vector) -> Option<BorderedSolution> {
        let unknowns = self.base.len();
        let n = unknowns - 1;
        let mut point = &self.base + &self.null * c;
        let mut mu = 0.0;
        for _ in 0..MOST {
            let (residual, matrix) = self.at(&point)?;
            let mut step = Vector::zeros(n + 2);
            step.rows_mut(0, n).copy_from(&(residual + &self.left * mu));
            let across = self.null.tr_mul(&(&point - &self.base)) - c;
            step.rows_mut(n, 2).copy_from(&across);
            if !Factors::new(&matrix).solve(&mut step) {
                return None;
            }
            point -= step.rows(0, unknowns);
            mu -= step[unknowns];
            if step.amax() <= STILL * point.amax().max(1.0) {
                let (_, matrix) = self.at(&point)?;
                let gradient = BorderedOrbit::gradient(&matrix)?;
                return Some(BorderedSolution {
                    point,
                    mu,
                    matrix,
                    gradient,
                });
            }
        }
        None
    }

    /// H at c = 0.
    fn hessian(&self) -> Option<Matrix> {
        let columns = (0..2).map(|column| {
            let at = |by: f64| {
                let mut c = Vector::zeros(2);
                c[column] = by;
                Some(self.solve(&c)?.gradient)
            };
            Some((at(DIFFERENCE)? - at(-DIFFERENCE)?) / (2.0 * DIFFERENCE))
        });
        let columns: Option<Vec<Vector>> = columns.collect();
        let hessian = Matrix::from_columns(&columns?);
        Some((&hessian + hessian.transpose()) * 0.5)
    }

    /// What ∇μ changes by, at most, where every unknown of a point does by some roundings.
    fn noise(&self, at: &BorderedSolution) -> Option<Vector> {
        const SAMPLES: u32 = 8;
        const ROUNDINGS: f64 = 16.0;
        let mut noise = Vector::zeros(2);
        for sample in 1..=SAMPLES {
            let beside = Vector::from_fn(at.point.len(), |unknown, _| {
                let place = (f64::from(sample) * (unknown as f64 + 1.0).sqrt()).fract();
                at.point[unknown] * (1.0 + ROUNDINGS * f64::EPSILON * (place - 0.5))
            });
            let (_, matrix) = self.at(&beside)?;
            let moved = BorderedOrbit::gradient(&matrix)? - &at.gradient;
            noise = noise.sup(&moved.abs());
        }
        Some(noise)
    }
}

impl AffineOrbit {
    /// Where another branch crosses this one between two arclengths of the step that sets out from a node, and the error
    /// of the parameter there.
    pub(super) fn branch_point(
        &self,
        from: &Node,
        [low, high]: [f64; 2],
        tolerance: f64,
    ) -> Option<(Place, f64)> {
        let mut point = node_at(self, from, 0.5 * (low + high), tolerance)?.point;
        for iteration in 1..=MOST {
            let bordered = BorderedOrbit::new(self, point.clone())?;
            let here = bordered.solve(&Vector::zeros(2))?;
            let hessian = bordered.hessian()?;
            let mut c = -&here.gradient;
            if !Factors::new(&hessian).solve(&mut c) {
                return None;
            }
            let far = c.norm() > high - low;
            if far {
                c *= (high - low) / c.norm();
            }
            let next = bordered.solve(&c)?;
            if !far && c.amax() <= STILL {
                let s = from.tangent.dot(&(&next.point - &from.point));
                let crosses = hessian.determinant() < 0.0 && next.mu.abs() <= PERFECT;
                if !crosses || s < low || s > high {
                    return None;
                }
                let error = self.error_of_branch_point(&bordered, &next, &hessian, c.amax())?;
                let tangent = along(&bordered.null, &hessian, &from.tangent)?;
                let (_, residual) = newton::jacobian(self, &next.point).ok()?;
                let node = Node {
                    point: next.point,
                    tangent,
                    newton: iteration,
                    residual,
                };
                let blur = c.amax();
                return Some((Place { s, node, blur }, error));
            }
            point = next.point;
        }
        None
    }

    /// The error of the parameter: that of the equations (1) at c, and that of c.
    fn error_of_branch_point(
        &self,
        bordered: &BorderedOrbit,
        at: &BorderedSolution,
        hessian: &Matrix,
        blur: f64,
    ) -> Option<f64> {
        let (last, unknowns) = (at.point.len() - 1, at.point.len());
        let jacobian = at.matrix.view((0, 0), (last, unknowns)).into_owned();
        let mut noise = Vector::zeros(unknowns + 1);
        if let Some(seen) = newton::noise(self, &jacobian, &at.point) {
            noise.rows_mut(0, last).copy_from(&seen.rows(0, last));
        }
        noise
            .rows_mut(0, last)
            .add_scalar_mut(self.left_out(&at.point));
        let sizes = at.point.abs().insert_row(unknowns, 0.0);
        let own = newton::rounding(&at.matrix, &sizes, Some(&noise))?[last];
        let inverse = Factors::new(hessian).inverse()?.abs();
        let reduced = inverse * (bordered.noise(at)? * 3.0);
        let across = bordered.null.row(last).abs() * reduced;
        Some((own + across[0] + blur) * self.unit().abs())
    }
}

/// The direction along which a branch passes, of the two in the plane of the null vectors on which τᵀHτ = 0 the one that
/// is nearer to another.
fn along(null: &Matrix, hessian: &Matrix, near: &Vector) -> Option<Vector> {
    let (a, b, c) = (hessian[(0, 0)], hessian[(0, 1)], hessian[(1, 1)]);
    let root = (b * b - a * c).sqrt();
    // both roots without cancellation
    let q = -(b + root.copysign(b));
    let directions = [[q, a], [c, q]].map(|[x, y]| {
        let direction = null * Vector::from_vec(vec![x, y]);
        let length = direction.norm();
        direction / length
    });
    let cosine = |direction: &Vector| direction.dot(near);
    let nearer = directions
        .into_iter()
        .filter(|direction| direction.iter().all(|x| x.is_finite()))
        .max_by(|one, other| cosine(one).abs().total_cmp(&cosine(other).abs()))?;
    let sign = cosine(&nearer).signum();
    Some(nearer * sign)
}
