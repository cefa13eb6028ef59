//! What a problem file says of the statements on its branch of equilibria.

use super::{EquilibriumCondition, EquilibriumProof, RefusedProof};
use crate::certify::CertifiedPoint;
use crate::certify::requested_system::RequestedSystem;
use crate::problem::{EquilibriumStart, SystemProblem};

/// What the branch of a problem file is about.
pub(crate) struct RequestedEquilibria(RequestedSystem);

impl RequestedEquilibria {
    /// Of a problem with its text; `None` where no branch of equilibria is followed.
    pub(crate) fn new(problem: &SystemProblem, text: &str) -> Option<RequestedEquilibria> {
        let restarted = match problem.equilibrium.as_ref()?.start {
            EquilibriumStart::Given { .. } | EquilibriumStart::Steady { .. } => false,
            EquilibriumStart::Restart { .. } | EquilibriumStart::Switch { .. } => true,
        };
        RequestedSystem::new(problem, text, restarted).map(RequestedEquilibria)
    }

    /// Whether the branch begins with an earlier run.
    pub(crate) fn is_restarted(&self) -> bool {
        self.0.is_restarted()
    }

    /// Whether the units in which uniqueness is measured are the same at all points, and not smaller than half the equilibrium
    /// that the branch begins with, where that is the first of the points. `false` where it is not one of the points although it
    /// is that of the problem file: then nothing tells what units the statements should have.
    ///
    /// # Errors
    /// They are others.
    pub(crate) fn check_units(
        &self,
        points: &[CertifiedPoint<EquilibriumProof>],
    ) -> Result<bool, RefusedProof> {
        let mut proofs = points.iter().filter_map(CertifiedPoint::proof);
        let Some(first) = proofs.next() else {
            return Ok(true);
        };
        let units = &first.posed.units;
        let alike = proofs.all(|proof| proof.posed.units == *units);
        let is_first = match &first.condition {
            EquilibriumCondition::Value(value) => {
                points.first().is_some_and(CertifiedPoint::is_proven) && self.0.begins(value)
            }
            _ => false,
        };
        let mut states = first.near.state.iter().zip(units);
        match alike && (!is_first || states.all(|(x, unit)| x.abs() <= 2.0 * unit)) {
            true => Ok(is_first || self.0.is_restarted()),
            false => Err(RefusedProof::Problem("the unit of a state")),
        }
    }

    /// Whether a proven point is one of the branch.
    ///
    /// # Errors
    /// Its equations, or the value of its parameter, are not those of the problem.
    pub(crate) fn check(
        &self,
        point: &CertifiedPoint<EquilibriumProof>,
        proof: &EquilibriumProof,
    ) -> Result<(), RefusedProof> {
        let posed = &proof.posed;
        let unit = posed.units.last().copied().unwrap_or(f64::NAN);
        let of = (posed.parameter, unit);
        self.0.check(posed.system.as_ref(), &posed.values, of)?;
        let value = match &proof.condition {
            EquilibriumCondition::Value(value) => Some(value),
            _ => None,
        };
        self.0.check_value(point.kind, value)
    }
}
