//! A system that tests are made on: a circle has two folds and closes.

use super::newton::Equations;
use crate::linalg::{Matrix, Vector};

/// x² + y² = 1, with y as parameter.
pub(super) struct UnitCircle;

impl Equations for UnitCircle {
    type Failure = std::convert::Infallible;

    fn unknowns(&self) -> usize {
        2
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), Self::Failure> {
        residual[0] = point.norm_squared() - 1.0;
        jacobian[(0, 0)] = 2.0 * point[0];
        jacobian[(0, 1)] = 2.0 * point[1];
        Ok(())
    }
}
