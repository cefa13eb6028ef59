//! Waves in physical numbers, as result folders keep them.

use serde::{Deserialize, Serialize};

use crate::linalg::Vector;
use crate::tube::flow::Slide;
use crate::tube::model::signature::Signature;
use crate::tube::model::{Model, Parameter};
use crate::tube::wave::{Wave, WaveScales};

/// A wave in physical numbers: what a restart needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedWave {
    /// Label.
    pub label: usize,
    /// Value of the continuation parameter and of all others.
    #[serde(with = "crate::tube::model::saved")]
    pub model: Model,
    /// Signature.
    pub signature: Signature,
    /// (Y, W, T) of each zone: Y = V − fgδ/h and W = V̇ at its entry, duration T.
    pub zones: Vec<[f64; 3]>,
    /// Layer G at the end of each zone; none without material damping.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<f64>,
    /// Layer G_U at the end of each zone; none unless a wave with material damping separates.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub radial_layers: Vec<f64>,
    /// Excess speed e = |c|/√a − 1.
    pub excess: f64,
}

impl SavedWave {
    /// A solved wave. The model has the value of the parameter.
    pub fn new(label: usize, model: Model, wave: &Wave, point: &Vector) -> SavedWave {
        let zones = wave.unpack(point);
        let width = wave.width();
        let layers = |of: fn(&Slide) -> f64, least_width: usize| -> Vec<f64> {
            let kept: &[Slide] = if width < least_width { &[] } else { &zones[..] };
            kept.iter().map(of).collect()
        };
        SavedWave {
            label,
            model,
            signature: wave.signature.clone(),
            zones: zones.iter().map(Slide::without_layers).collect(),
            layers: layers(|zone| zone.layer, 4),
            radial_layers: layers(|zone| zone.radial, 5),
            excess: wave.excess_at(point),
        }
    }

    /// Whether every zone has its numbers and all of them are finite: a damaged file may say otherwise.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn is_whole(&self) -> bool {
        let known = |parameter| self.model.value(parameter).is_none_or(f64::is_finite);
        let zones = self.signature.len();
        zones > 0
            && self.zones.len() == zones
            && finite(self.zones.as_flattened())
            && [&self.layers, &self.radial_layers]
                .into_iter()
                .all(|layers| (layers.is_empty() || layers.len() == zones) && finite(layers))
            && Parameter::ALL.into_iter().all(known)
            && self.excess.is_finite()
    }

    /// The same wave over two of its wavelengths.
    pub(super) fn twice(&self) -> SavedWave {
        let mut twice = self.clone();
        twice.signature.0.extend_from_within(..);
        twice.zones.extend_from_within(..);
        twice.layers.extend_from_within(..);
        twice.radial_layers.extend_from_within(..);
        twice
    }

    /// The wave as a boundary-value problem in `parameter`, of which `width` is the unit.
    pub fn wave(&self, parameter: Parameter, mode: u32, width: f64) -> Wave {
        let largest = self
            .zones
            .iter()
            .fold(1.0_f64, |size, [_, w, _]| size.max(w.abs()));
        let scales = WaveScales::new(&self.model, mode, self.excess, largest, width);
        Wave::new(self.model, parameter, mode, self.signature.clone(), scales)
    }

    /// (Y, W, T, G, G_U) of each zone.
    pub fn unknowns(&self) -> Vec<Slide> {
        let of = |layers: &[f64], index: usize| layers.get(index).copied().unwrap_or(0.0);
        let zones = self.zones.iter().enumerate();
        zones
            .map(|(index, &[y, w, duration])| Slide {
                entry: [y, w],
                duration,
                layer: of(&self.layers, index),
                radial: of(&self.radial_layers, index),
            })
            .collect()
    }
}

/// Whether all numbers are finite.
pub(super) fn finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}
