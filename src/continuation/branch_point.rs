//! Where curves cross.
//!
//! With F(u) = 0 the n equations of a curve in n + 1 unknowns, F_u has rank n − k at a branch point: k left null vectors,
//! the columns of Ψ, and k + 1 null vectors, those of N. k is 1 where two curves cross, and larger where a symmetry makes
//! several multipliers pass 1 at once. In the bordered equations
//!
//! > (1) F(u) + Ψμ = 0, Nᵀ(u − u₀) = c,
//!
//! which are regular there, μ is a function of the k + 1 numbers c, and all curves are its level μ = 0: they cross
//! where ∇μ = 0 (the Lyapunov-Schmidt reduction; Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria,
//! 2000). With the columns of W the solutions of
//!
//! > (2) F_uᵀW + N∇μᵀ = 0, ΨᵀW = 1
//!
//! the gradients are exact. For k = 1 they are two equations in two unknowns; for k > 1 there are more equations than unknowns,
//! which agree where a symmetry is the cause. Their own derivatives H are central differences, which bend the way of the
//! iterates and not their limit. Along a curve zᵀHz = 0 for each of them.

use super::arclength::Node;
use super::branching::Branching;
use super::locate::{Place, node_at};
use super::newton::{self, Equations};
use crate::linalg::{self, Factors, Matrix, Vector, even};

/// Newton's iterates at most, of the reduced equations and of the bordered ones: both are quadratic.
const MOST: usize = 12;

/// Step of the central differences in scaled unknowns of order one: truncation and rounding both leave 1e-8 of H.
const DIFFERENCE: f64 = 1e-4;

/// A last iterate smaller than this leaves nothing but rounding.
const STILL: f64 = 1e-11;

/// μ is zero to rounding where curves cross: more than this, in equations of order one, is an imperfect crossing, which no other
/// curve passes.
pub const PERFECT: f64 = 1e-9;

/// Singular values of H below this part of the largest are zero: the point is then no isolated one.
const ISOLATED: f64 = 1e-6;

/// Equations (1) at a base u₀.
struct Reduction<'a, S> {
    system: &'a S,
    base: Vector,
    left: Matrix,
    null: Matrix,
}

/// A solution of (1) with ∇μ, one row after the other.
struct BorderedSolution {
    point: Vector,
    mu: Vector,
    /// [F_u Ψ; Nᵀ 0].
    matrix: Matrix,
    gradient: Vector,
}

impl<'a, S: Equations> Reduction<'a, S> {
    /// The borders at a point where the rank falls by so many; `None` where the decomposition fails.
    fn new(system: &'a S, base: Vector, fall: usize) -> Option<Reduction<'a, S>> {
        let (jacobian, _) = newton::jacobian(system, &base).ok()?;
        let linalg::NullSpaces { right, left } = linalg::least_spaces(&jacobian, fall)?;
        Some(Reduction {
            system,
            base,
            left,
            null: right,
        })
    }

    /// F and the bordered matrix at a point.
    fn at(&self, point: &Vector) -> Option<(Vector, Matrix)> {
        let unknowns = point.len();
        let n = unknowns - 1;
        let (fall, size) = (self.left.ncols(), unknowns + self.left.ncols());
        let (jacobian, residual) = newton::evaluated(self.system, point).ok()?;
        let mut matrix = Matrix::zeros(size, size);
        matrix.view_mut((0, 0), (n, unknowns)).copy_from(&jacobian);
        matrix
            .view_mut((0, unknowns), (n, fall))
            .copy_from(&self.left);
        matrix
            .view_mut((n, 0), (fall + 1, unknowns))
            .copy_from(&self.null.transpose());
        Some((residual, matrix))
    }

    /// ∇μ by (2).
    fn gradient(&self, matrix: &Matrix) -> Option<Vector> {
        let (fall, size) = (self.left.ncols(), matrix.nrows());
        let factors = Factors::new(&matrix.transpose());
        let mut gradient = Vector::zeros(fall * (fall + 1));
        for row in 0..fall {
            let mut weights = Vector::zeros(size);
            weights[size - fall + row] = 1.0;
            if !factors.solve(&mut weights) {
                return None;
            }
            let own = weights.rows(size - fall - 1, fall + 1);
            gradient
                .rows_mut(row * (fall + 1), fall + 1)
                .copy_from(&own);
        }
        Some(gradient)
    }

    /// The solution at c.
    fn solve(&self, c: &Vector) -> Option<BorderedSolution> {
        let unknowns = self.base.len();
        let n = unknowns - 1;
        let mut point = &self.base + &self.null * c;
        let mut mu = Vector::zeros(self.left.ncols());
        for _ in 0..MOST {
            let (residual, matrix) = self.at(&point)?;
            let mut step = Vector::zeros(matrix.nrows());
            step.rows_mut(0, n)
                .copy_from(&(residual + &self.left * &mu));
            let across = self.null.tr_mul(&(&point - &self.base)) - c;
            step.rows_mut(n, across.len()).copy_from(&across);
            if !Factors::new(&matrix).solve(&mut step) {
                return None;
            }
            point -= step.rows(0, unknowns);
            mu -= step.rows(unknowns, mu.len());
            if step.amax() <= STILL * point.amax().max(1.0) {
                let (_, matrix) = self.at(&point)?;
                let gradient = self.gradient(&matrix)?;
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

    /// H of every μ at c = 0.
    fn hessians(&self) -> Option<Vec<Matrix>> {
        let (fall, dimensions) = (self.left.ncols(), self.null.ncols());
        let columns = (0..dimensions).map(|column| {
            let at = |by: f64| {
                let mut c = Vector::zeros(dimensions);
                c[column] = by;
                Some(self.solve(&c)?.gradient)
            };
            Some((at(DIFFERENCE)? - at(-DIFFERENCE)?) / (2.0 * DIFFERENCE))
        });
        let columns: Option<Vec<Vector>> = columns.collect();
        let all = Matrix::from_columns(&columns?);
        let symmetric = |row: usize| {
            let own = all.rows(row * dimensions, dimensions);
            (own + own.transpose()) * 0.5
        };
        Some((0..fall).map(symmetric).collect())
    }

    /// What ∇μ changes by, at most, where every unknown of a point does by some roundings.
    fn noise(&self, at: &BorderedSolution) -> Option<Vector> {
        const SAMPLES: usize = 8;
        const ROUNDINGS: f64 = 16.0;
        let mut noise = Vector::zeros(at.gradient.len());
        for sample in 1..=SAMPLES {
            let mut places = even(sample);
            let beside = Vector::from_fn(at.point.len(), |unknown, _| {
                let place = places.next().unwrap_or_default();
                at.point[unknown] * (1.0 + ROUNDINGS * f64::EPSILON * (place - 0.5))
            });
            let (_, matrix) = self.at(&beside)?;
            let moved = self.gradient(&matrix)? - &at.gradient;
            noise = noise.sup(&moved.abs());
        }
        Some(noise)
    }

    /// The error of the last unknown: that of the equations (1) at c, and that of c. `own` is that of the equations of the curve besides
    /// rounding.
    fn error(&self, at: &BorderedSolution, inverse: &Matrix, own: f64) -> Option<f64> {
        let (last, unknowns) = (at.point.len() - 1, at.point.len());
        let jacobian = at.matrix.view((0, 0), (last, unknowns)).into_owned();
        let mut noise = Vector::zeros(at.matrix.nrows());
        if let Some(seen) = newton::noise(self.system, &jacobian, &at.point) {
            noise.rows_mut(0, last).copy_from(&seen.rows(0, last));
        }
        noise.rows_mut(0, last).add_scalar_mut(own);
        let sizes = at.point.abs().resize_vertically(at.matrix.nrows(), 0.0);
        let at_c = newton::rounding(&at.matrix, &sizes, Some(&noise))?[last];
        let of_c = inverse.abs() * (self.noise(at)? * 3.0);
        let across = self.null.row(last).abs() * of_c;
        Some(at_c + across[0])
    }
}

/// Where other curves cross the one that sets out from a node, between two arclengths of its step, and the error of the last
/// unknown there. The rank of the derivative falls by `fall` at it, one or more; `left_out` is what the equations are off by at a
/// point besides rounding. `None` where none cross.
pub fn branch_point<S: Equations>(
    system: &S,
    fall: usize,
    (from, [low, high]): (&Node, [f64; 2]),
    tolerance: f64,
    left_out: impl Fn(&Vector) -> f64,
) -> Option<(Place, f64)> {
    if fall == 0 || fall + 1 >= system.unknowns() {
        return None;
    }
    let middle = node_at(system, from, 0.5 * (low + high), tolerance)?.point;
    let mut point = middle.clone();
    for iteration in 1..=MOST {
        let bordered = Reduction::new(system, point, fall)?;
        let here = bordered.solve(&Vector::zeros(fall + 1))?;
        let forms = bordered.hessians()?;
        let rows: Vec<_> = forms.iter().flat_map(|form| form.row_iter()).collect();
        let derivative = Matrix::from_rows(&rows);
        let inverse = linalg::pseudo_inverse(&derivative, ISOLATED)?;
        let identity = Matrix::identity(fall + 1, fall + 1);
        if (&inverse * &derivative - identity).amax() > 0.5 {
            return None;
        }
        let mut c = -(&inverse * here.gradient);
        let far = c.norm() > high - low;
        if far {
            c *= (high - low) / c.norm();
        }
        let next = bordered.solve(&c)?;
        if far || c.amax() > STILL {
            point = next.point;
            continue;
        }
        let s = from.tangent.dot(&(&next.point - &from.point));
        let perfect = next.mu.amax().max(next.gradient.amax()) <= PERFECT;
        // along the curve that crosses iterates may have come to another crossing
        let is_away = (&next.point - &middle).norm() > high - low;
        if !perfect || s < low || s > high || is_away {
            return None;
        }
        // H is known to 1e-8, and so much of the last iterate is left
        let blur = DIFFERENCE * c.amax();
        let error = bordered.error(&next, &inverse, left_out(&next.point))? + blur;
        let near = bordered.null.tr_mul(&from.tangent);
        let tangent = Branching::new(bordered.null, forms).tangent_from(&near)?;
        let (_, residual) = newton::jacobian(system, &next.point).ok()?;
        let node = Node {
            tangent: &tangent * tangent.dot(&from.tangent).signum(),
            point: next.point,
            newton: iteration,
            residual,
        };
        return Some((Place { s, node, blur }, error));
    }
    None
}
