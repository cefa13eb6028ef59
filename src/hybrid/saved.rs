//! Orbits in physical numbers, as result folders keep them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::affine::orbit::{AffineOrbit, Scales, Sequence, Setting, ZonePoint};
use crate::linalg::Vector;
use crate::problem::SystemProblem;

/// An orbit in physical numbers: what a restart needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedOrbit {
    /// Label.
    pub label: usize,
    /// Values of the parameters in the order of the file.
    pub parameters: Vec<f64>,
    /// Forcing periods in one orbit.
    pub periods: u32,
    /// Sequence of zones.
    pub sequence: Sequence,
    /// State at the entry of each zone, its duration, and the phase there.
    pub zones: Vec<(Vec<f64>, f64, f64)>,
}

impl SavedOrbit {
    /// A solved orbit; `parameters` have the value of the point.
    pub(super) fn new(
        label: usize,
        parameters: Vec<f64>,
        orbit: &AffineOrbit,
        zones: &[ZonePoint],
    ) -> SavedOrbit {
        let zones = zones.iter();
        SavedOrbit {
            label,
            parameters,
            periods: orbit.setting.periods,
            sequence: orbit.sequence.clone(),
            zones: zones
                .map(|zone| (zone.state.clone(), zone.duration, zone.phase))
                .collect(),
        }
    }

    /// Whether every zone has its numbers and all of them are finite: a damaged file may say otherwise.
    pub fn is_whole(&self, states: usize, parameters: usize) -> bool {
        let fits = |(state, duration, phase): &(Vec<f64>, f64, f64)| {
            state.len() == states
                && state
                    .iter()
                    .chain([duration, phase])
                    .all(|number| number.is_finite())
        };
        self.zones.len() == self.sequence.len()
            && !self.zones.is_empty()
            && self.zones.iter().all(fits)
            && self.parameters.len() == parameters
            && self.parameters.iter().all(|value| value.is_finite())
    }

    /// The orbit as a boundary-value problem of this system in a parameter of which `width` is the unit, and its
    /// scaled unknowns; `None` where the system has no such sequence.
    pub fn orbit(
        &self,
        problem: &SystemProblem,
        parameter: usize,
        width: f64,
    ) -> Option<(AffineOrbit, Vector)> {
        let states = problem.system.source.states.len();
        let largest = (0..states).map(|state| {
            let sizes = self.zones.iter().map(|(at, ..)| at[state].abs());
            let largest = sizes.fold(0.0, f64::max);
            if largest > 0.0 { largest } else { 1.0 }
        });
        let setting = Setting {
            system: problem.system.clone(),
            values: self.parameters.clone(),
            parameter,
            periods: self.periods,
            stability: problem.stability.is_some(),
            scales: Scales {
                states: largest.collect(),
                time: self.zones.iter().map(|(_, duration, _)| duration).sum(),
                parameter: width,
            },
        };
        let orbit = AffineOrbit::new(Arc::new(setting), self.sequence.clone())?;
        let zones = self.zones.iter().map(|(state, duration, phase)| ZonePoint {
            state: state.clone(),
            duration: *duration,
            phase: *phase,
        });
        let zones: Vec<ZonePoint> = zones.collect();
        let point = orbit.pack(&zones, self.parameters[parameter]);
        Some((orbit, point))
    }
}
