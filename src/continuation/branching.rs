//! Tangents of the curves that pass through one point.
//!
//! Where the derivative of F has a null space of m > 1 dimensions, spanned by the columns of N, its transpose has one of
//! m − 1, spanned by those of Y. A curve u(s) with F(u(s)) = 0 and the tangent Nz satisfies YᵀF''[Nz, Nz] = 0, m − 1
//! quadratic forms (the algebraic branching equation; Keller, Applications of Bifurcation Theory, 1977). Its zeros are
//! found by Newton's method on the unit sphere.

use super::newton::Equations;
use crate::continuation::newton;
use crate::linalg::{self, Matrix, Vector};

/// The algebraic branching equation at a point.
#[derive(Clone, Debug)]
pub struct Branching {
    /// N: an orthonormal basis, as columns.
    pub null_space: Matrix,
    /// m − 1 symmetric forms of m unknowns, the largest coefficient of all of order one.
    forms: Vec<Matrix>,
}

/// Second derivatives are differences of Jacobians: with steps of the third root of rounding both errors are 1e-10.
const STEP: f64 = 6e-6;

/// A form is zero where it is below this part of the largest: differences are known to 1e-10, and the point to 1e-13.
const ZERO: f64 = 1e-6;

/// Steps of Newton's method: at a double zero, where two curves touch, each takes half of the distance away.
const STEPS: usize = 40;

impl Branching {
    /// The equation at a point. `None` where there is one tangent only: all singular values but the last are above this
    /// part of the largest. Where the second derivative has no value every direction is a zero.
    pub fn at<S: Equations>(system: &S, point: &Vector, part: f64) -> Option<Branching> {
        let (matrix, _) = newton::jacobian(system, point).ok()?;
        let linalg::NullSpaces { right, left } = linalg::null_spaces(&matrix, part)?;
        if right.ncols() < 2 {
            return None;
        }
        let forms = forms(system, point, &right, &left).unwrap_or_default();
        Some(Branching::new(right, forms))
    }

    /// The equation of symmetric forms in the coordinates in a null space. Where they vanish, or have no value, every direction is
    /// a zero.
    pub fn new(null_space: Matrix, mut forms: Vec<Matrix>) -> Branching {
        let largest = forms.iter().map(Matrix::amax).fold(0.0, f64::max);
        if largest.is_finite() && largest > 0.0 {
            forms.iter_mut().for_each(|form| *form /= largest);
        } else {
            forms.clear();
        }
        Branching { null_space, forms }
    }

    /// The unit tangent whose coordinates in the null space are found from these; `None` where Newton's method finds none.
    pub fn tangent_from(&self, coordinates: &Vector) -> Option<Vector> {
        let mut z = coordinates.try_normalize(0.0)?;
        for _ in 0..STEPS {
            let (residual, derivative) = self.evaluate(&z);
            let step = linalg::pseudo_inverse(&derivative, ZERO)? * residual;
            z -= &step;
            if step.amax() <= ZERO * ZERO {
                break;
            }
        }
        let is_zero = self.evaluate(&z).0.amax() <= ZERO;
        (is_zero && z.iter().all(|one| one.is_finite())).then(|| (&self.null_space * z).normalize())
    }

    /// The unit tangents of two curves that cross, where they do so in a plane: the zeros of az² + 2bzw + cw². `None` where
    /// it has no two real ones.
    pub fn tangents(&self) -> Option<[Vector; 2]> {
        let [form] = &self.forms[..] else {
            return None;
        };
        if form.ncols() != 2 {
            return None;
        }
        let (a, b, c) = (form[(0, 0)], form[(0, 1)], form[(1, 1)]);
        let root = (b * b - a * c).sqrt();
        let q = -(b + root.copysign(b));
        let line =
            |z: f64, w: f64| (&self.null_space * Vector::from_vec(vec![z, w])).try_normalize(0.0);
        let lines = (root > 0.0).then(|| Some([line(q, a)?, line(c, q)?]));
        lines.flatten()
    }

    /// The forms and (z·z − 1)/2, with their derivatives.
    fn evaluate(&self, z: &Vector) -> (Vector, Matrix) {
        let count = self.forms.len();
        let mut residual = Vector::zeros(count + 1);
        let mut derivative = Matrix::zeros(count + 1, z.len());
        for (row, form) in self.forms.iter().enumerate() {
            let product = form * z;
            residual[row] = z.dot(&product);
            derivative.set_row(row, &(2.0 * product).transpose());
        }
        residual[count] = 0.5 * (z.norm_squared() - 1.0);
        derivative.set_row(count, &z.transpose());
        (residual, derivative)
    }
}

/// YᵀF''[Nx, Nz] as symmetric forms in x and z. `None` where F has no value beside the point.
fn forms<S: Equations>(
    system: &S,
    point: &Vector,
    right: &Matrix,
    left: &Matrix,
) -> Option<Vec<Matrix>> {
    let dimensions = right.ncols();
    let mut forms = vec![Matrix::zeros(dimensions, dimensions); left.ncols()];
    for (index, direction) in right.column_iter().enumerate() {
        let beside = |step: f64| newton::jacobian(system, &(point + direction * step)).ok();
        let ((after, _), (before, _)) = beside(STEP).zip(beside(-STEP))?;
        let change = left.transpose() * (after - before) * right / (2.0 * STEP);
        for (form, row) in forms.iter_mut().zip(change.row_iter()) {
            form.set_row(index, &row);
        }
    }
    for form in &mut forms {
        *form = (&*form + form.transpose()) * 0.5;
    }
    Some(forms)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three unknowns that are zero to first order: x² = a y² and z = x y.
    struct Crossing {
        a: f64,
    }

    impl Equations for Crossing {
        type Failure = std::convert::Infallible;

        fn unknowns(&self) -> usize {
            3
        }

        fn evaluate(
            &self,
            u: &Vector,
            residual: &mut [f64],
            jacobian: &mut Matrix,
        ) -> Result<(), Self::Failure> {
            residual[0] = u[0] * u[0] - self.a * u[1] * u[1] + u[2] * u[1];
            residual[1] = u[2] - u[0] * u[1];
            let rows = [
                [2.0 * u[0], u[2] - 2.0 * self.a * u[1], u[1]],
                [-u[1], -u[0], 1.0],
            ];
            *jacobian = Matrix::from_fn(2, 3, |row, column| rows[row][column]);
            Ok(())
        }
    }

    /// Two curves cross at the origin with x = ±√a y; where a < 0 none passes. Newton's method on the forms is exact but
    /// for their differences, 1e-10 of the largest, over the slope 2√a.
    #[test]
    fn curves_cross_along_the_zeros_of_the_second_order() {
        for a in [4.0, 1.0, 0.09] {
            let crossing = Crossing { a };
            let branching = Branching::at(&crossing, &Vector::zeros(3), 1e-9).unwrap();
            for sign in [1.0, -1.0] {
                let start = Vector::from_vec(vec![1.0, 0.7 * sign, 0.0]);
                let coordinates = branching.null_space.transpose() * start;
                let tangent = branching.tangent_from(&coordinates).unwrap();
                let exact = a.sqrt() * sign;
                assert!((tangent[0] / tangent[1] - exact).abs() < 1e-8, "{tangent}");
                assert!(tangent[2].abs() < 1e-8);
                let tangents = branching.tangents().unwrap();
                let along = tangents.map(|one| one.dot(&tangent).abs());
                assert!(
                    along.iter().any(|along| (along - 1.0).abs() < 1e-8),
                    "{along:?}"
                );
            }
        }
        let none = Branching::at(&Crossing { a: -1.0 }, &Vector::zeros(3), 1e-9).unwrap();
        assert_eq!(none.tangent_from(&Vector::from_vec(vec![1.0, 0.3])), None);
        assert_eq!(none.tangents(), None);
        let regular = Vector::from_vec(vec![0.5, 0.2, 0.1]);
        assert!(Branching::at(&Crossing { a: 1.0 }, &regular, 1e-9).is_none());
    }
}
