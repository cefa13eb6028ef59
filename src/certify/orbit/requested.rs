//! What a problem file says of the statements on its branch: its system, its numbers, and the values that it asks for.

use super::OrbitProof;
use super::system::{OrbitCondition, PosedOrbit};
use crate::certify::CertifiedPoint;
use crate::certify::certificate::RefusedProof;
use crate::certify::requested_system::RequestedSystem;
use crate::problem::{OrbitStart, SystemProblem};

/// What the branch of a problem file is about.
pub(crate) struct RequestedOrbits {
    system: RequestedSystem,
    /// Periods of the forcing in an orbit, or the most that are looked for; `None` where they are those of an orbit of an earlier run.
    periods: Option<usize>,
    /// Whether an orbit of fewer periods may be found.
    at_most: bool,
    /// Whether the period is prescribed, and a second parameter free.
    prescribed: bool,
}

impl RequestedOrbits {
    /// Of a problem with its text; `None` where no branch of orbits is followed.
    pub(crate) fn new(problem: &SystemProblem, text: &str) -> Option<RequestedOrbits> {
        let orbit = &problem.orbit;
        let restarted = match orbit.start {
            OrbitStart::Nowhere => return None,
            OrbitStart::Simulate { .. } | OrbitStart::Given { .. } => false,
            OrbitStart::Restart { .. } | OrbitStart::Switch { .. } => true,
        };
        Some(RequestedOrbits {
            system: RequestedSystem::new(problem, text, restarted)?,
            periods: (!restarted).then_some(orbit.periods),
            at_most: matches!(orbit.start, OrbitStart::Simulate { .. }),
            prescribed: orbit.period.is_some(),
        })
    }

    /// Whether the branch begins with an earlier run.
    pub(crate) fn is_restarted(&self) -> bool {
        self.system.is_restarted()
    }

    /// Whether the units in which uniqueness is measured are those of the branch: the same at all points, and about the size of the
    /// orbit that it begins with, where that is the first of the points. That orbit was given roughly. `false` where it is not one of
    /// the points although it is that of the problem file: then nothing tells what units the statements should have.
    ///
    /// # Errors
    /// They are others.
    pub(crate) fn check_units(
        &self,
        points: &[CertifiedPoint<OrbitProof>],
    ) -> Result<bool, RefusedProof> {
        /// A rough orbit is no more than so many times smaller or larger.
        const ROUGH: f64 = 2.0;
        let mut proofs = points.iter().filter_map(CertifiedPoint::proof);
        let refused = Err(RefusedProof::Problem("the unit of a state or of time"));
        let Some(first) = proofs.next() else {
            return Ok(true);
        };
        let units = &first.posed.units;
        if proofs.any(|proof| proof.posed.units != *units) {
            return refused;
        }
        let is_first = match &first.condition {
            OrbitCondition::Value(value) => {
                points.first().is_some_and(CertifiedPoint::is_proven) && self.system.begins(value)
            }
            _ => false,
        };
        let zones = &first.near.zones;
        let period: f64 = zones.iter().map(|zone| zone.duration).sum();
        let largest = |state: usize| {
            zones
                .iter()
                .filter_map(move |zone| zone.state.get(state))
                .fold(0.0_f64, |most, x| most.max(x.abs()))
        };
        let mut states = units.states.iter().enumerate();
        let has_size = |(state, unit): (usize, &f64)| largest(state) <= ROUGH * unit;
        let lasts = period <= ROUGH * units.time && units.time <= ROUGH * period;
        match !is_first || lasts && states.all(has_size) {
            true => Ok(is_first || self.system.is_restarted()),
            false => refused,
        }
    }

    /// Whether a proven point is one of the branch.
    ///
    /// # Errors
    /// Its equations, or the value of its parameter, are not those of the problem.
    pub(crate) fn check(
        &self,
        point: &CertifiedPoint<OrbitProof>,
        proof: &OrbitProof,
    ) -> Result<(), RefusedProof> {
        let PosedOrbit {
            system,
            values,
            parameter,
            periods,
            units,
        } = &proof.posed;
        let of = (*parameter, units.parameter);
        self.system.check(system.as_ref(), values, of)?;
        if self.prescribed {
            return Err(RefusedProof::Problem("the period"));
        }
        let periods = usize::try_from(*periods).unwrap_or(usize::MAX);
        let fits = |asked: usize| {
            // a doubling on the branch of the doubled orbit is one of the shorter orbit
            let part = proof.condition == OrbitCondition::Doubling
                && periods > 0
                && asked.is_multiple_of(periods);
            periods == asked || part || self.at_most && periods > 0 && periods <= asked
        };
        if self.system.is_forced() && !self.periods.is_none_or(fits) {
            return Err(RefusedProof::Problem("the number of periods"));
        }
        let value = match &proof.condition {
            OrbitCondition::Value(value) => Some(value),
            _ => None,
        };
        self.system.check_value(point.kind, value)
    }
}
