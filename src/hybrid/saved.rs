//! Orbits in physical numbers, as result folders keep them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::affine::orbit::row::SavedOrbit;
use crate::affine::orbit::{AffineOrbit, Scales, Setting};
use crate::problem::SystemProblem;

/// An orbit in physical numbers: what a restart needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LabelledOrbit {
    /// Label.
    pub label: usize,
    /// The orbit.
    pub orbit: SavedOrbit,
}

impl LabelledOrbit {
    /// Whether every zone has its numbers and all of them are finite: a damaged file may say otherwise.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn is_whole(&self, states: usize, parameters: usize) -> bool {
        let SavedOrbit {
            sequence,
            zones,
            values,
            ..
        } = &self.orbit;
        let known = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        !zones.is_empty()
            && zones.len() == sequence.len()
            && zones.iter().all(|zone| {
                zone.state.len() == states
                    && known(&zone.state)
                    && known(&[zone.duration, zone.phase])
            })
            && values.len() == parameters
            && known(values)
    }

    /// The boundary-value problem of it in these units; `None` where the system has no such sequence.
    pub(super) fn posed(
        &self,
        problem: &SystemProblem,
        parameter: usize,
        scales: Scales,
    ) -> Option<AffineOrbit> {
        let units = scales
            .states
            .iter()
            .chain([&scales.time, &scales.parameter]);
        let fits = units
            .into_iter()
            .all(|unit| unit.is_finite() && *unit > 0.0);
        let setting = Setting {
            system: problem.system.clone(),
            values: self.orbit.values.clone(),
            parameter,
            periods: self.orbit.periods,
            stability: problem.stability.is_some(),
            scales,
        };
        fits.then(|| AffineOrbit::new(Arc::new(setting), self.orbit.sequence.clone()))?
    }
}
