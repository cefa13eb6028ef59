//! How well the unknowns of a point are known.
//!
//! With J the Jacobian of the scaled equations R(u) = 0 at a point and t its tangent, a perturbation r
//! of the residuals moves the point, across the tangent, by B⁻¹(r, 0), B = (J; tᵀ). Every residual
//! carries the rounding of the unknowns it is formed from, |r| ≤ m ε |J||u|, and what is left of it
//! after Newton's method; by a numerical method also the discretisation error, which the same
//! residual by a finer method shows. So
//!
//! ```text
//! expected error = max |B⁻¹| (|R_finer(u)| + m ε |J||u|),      condition = σ₁/σₙ of J.
//! ```

use crate::continuation::Node;
use crate::continuation::newton::Equations;
use crate::linalg::{Factors, Matrix, Vector, kernel};
use crate::tube::flow::FlowError;
use crate::tube::flow::method::{MAX_INTERVALS, Method};
use crate::tube::wave::Wave;

/// Condition number and expected error of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditioning {
    /// Largest by smallest singular value of the Jacobian of the scaled equations.
    pub condition: f64,
    /// Expected error of the scaled unknowns, which are of order one; the unknown of the speed is
    /// ln e, e = |c|/√a − 1.
    pub expected_error: f64,
}

/// m: operations behind a residual whose roundings add up.
const OPERATIONS: f64 = 4.0;

/// A method whose discretisation error is smaller by orders of magnitude.
fn finer(method: Method) -> Method {
    match method {
        Method::Exact => Method::Exact,
        Method::Shooting { tolerance } => Method::Shooting {
            tolerance: (1e-2 * tolerance).max(1e-14),
        },
        Method::Collocation { intervals, degree } => Method::Collocation {
            intervals: (2 * intervals).min(MAX_INTERVALS),
            degree,
        },
    }
}

/// Conditioning of a solved point.
///
/// # Errors
/// The equations cannot be evaluated there.
pub fn conditioning(wave: &Wave, node: &Node) -> Result<Conditioning, FlowError> {
    let n = wave.unknowns();
    let mut matrix = Matrix::zeros(n - 1, n);
    let mut residual = vec![0.0; n - 1];
    wave.evaluate(&node.point, &mut residual, &mut matrix)?;
    if wave.method != finer(wave.method) {
        let fine = wave.clone().with_method(finer(wave.method));
        fine.evaluate(&node.point, &mut residual, &mut Matrix::zeros(n - 1, n))?;
    }
    let condition =
        kernel(&matrix).map_or(f64::INFINITY, |kernel| kernel.largest / kernel.smallest);
    // ln(e/e₀) is near zero, but e has the rounding of a number of its own size
    let extent = |column: usize| {
        if column == n - 2 {
            1.0
        } else {
            node.point[column].abs()
        }
    };
    let perturbation = Vector::from_fn(n, |row, _| {
        if row == n - 1 {
            return 0.0;
        }
        let size: f64 = (0..n)
            .map(|column| matrix[(row, column)].abs() * extent(column))
            .sum();
        residual[row].abs() + OPERATIONS * f64::EPSILON * size
    });
    let mut bordered = matrix.insert_row(n - 1, 0.0);
    for column in 0..n {
        bordered[(n - 1, column)] = node.tangent[column];
    }
    let expected_error = match Factors::new(&bordered).inverse() {
        Some(inverse) => (inverse.abs() * perturbation).amax(),
        None => f64::INFINITY,
    };
    Ok(Conditioning {
        condition,
        expected_error,
    })
}
