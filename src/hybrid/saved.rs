//! Orbits in physical numbers, as result folders keep them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::affine::orbit::layout::ZonePoint;
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
            beside,
            ..
        } = &self.orbit;
        let known = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        let whole = |zones: &[ZonePoint], values: &[f64]| {
            zones.len() == sequence.len()
                && zones.iter().all(|zone| {
                    zone.state.len() == states
                        && known(&zone.state)
                        && known(&[zone.duration, zone.phase])
                })
                && values.len() == parameters
                && known(values)
        };
        let beside = beside.as_ref();
        !zones.is_empty()
            && whole(zones, values)
            && beside.is_none_or(|one| whole(&one.zones, &one.values))
    }

    /// Whether no state differs between its switches by more than a part of one million of what it does in the largest
    /// of other orbits. A state that is the same at all of them, but for rounding, tells nothing.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn has_shrunk(&self, others: &[LabelledOrbit]) -> bool {
        const NOTHING: f64 = 1e-6;
        const ROUNDING: f64 = 1e-9;
        let at = |orbit: &LabelledOrbit, state: usize| -> (f64, f64) {
            let zones = orbit.orbit.zones.iter();
            let all = zones.filter_map(|zone| zone.state.get(state));
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (x.min(low), x.max(high))
            })
        };
        let largest = |of: fn((f64, f64)) -> f64, state: usize| {
            let all = others.iter().map(|other| of(at(other, state)));
            all.fold(0.0, f64::max)
        };
        let states = || 0..self.orbit.zones.first().map_or(0, |zone| zone.state.len());
        let size = states().map(|state| largest(|(low, high)| high.max(-low), state));
        let least = ROUNDING * size.fold(0.0, f64::max);
        let moving = states().map(|state| (state, largest(|(low, high)| high - low, state)));
        let moving: Vec<(usize, f64)> = moving.filter(|(_, spread)| *spread > least).collect();
        let shrunk = |(state, largest): &(usize, f64)| {
            let (low, high) = at(self, *state);
            high - low <= NOTHING * largest
        };
        !moving.is_empty() && moving.iter().all(shrunk)
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
            .chain([&scales.time, &scales.parameter])
            .chain(&scales.free);
        let fits = units
            .into_iter()
            .all(|unit| unit.is_finite() && *unit > 0.0);
        let prescribed = problem.prescribed();
        let fits = fits && scales.free.is_some() == prescribed.is_some();
        let setting = Setting {
            system: problem.system.clone(),
            values: self.orbit.values.clone(),
            parameter,
            second: None,
            periods: self.orbit.periods,
            prescribed,
            stability: problem.stability.is_some(),
            scales,
        };
        fits.then(|| AffineOrbit::new(Arc::new(setting), self.orbit.sequence.clone()))?
    }
}
