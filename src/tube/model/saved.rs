//! The model in restart files: flat, for `#[serde(with)]`.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::coefficients::{Coefficients, Geometry};
use super::{CoefficientSource, Damping, FrictionLaw, Impact, Model};

#[derive(Serialize, Deserialize)]
enum SavedSource {
    Geometry(Geometry),
    Given(Coefficients),
}

#[derive(Serialize, Deserialize)]
struct SavedModel {
    source: SavedSource,
    friction: f64,
    mismatch: f64,
    mass_damping: f64,
    stiffness_damping: f64,
    impact: Impact,
    #[serde(default)]
    law: FrictionLaw,
}

pub(crate) fn serialize<S: Serializer>(model: &Model, serializer: S) -> Result<S::Ok, S::Error> {
    SavedModel {
        source: match model.source.geometry() {
            Some(tube) => SavedSource::Geometry(tube),
            None => SavedSource::Given(model.source.coefficients()),
        },
        friction: model.friction,
        mismatch: model.mismatch,
        mass_damping: model.damping.mass,
        stiffness_damping: model.damping.stiffness,
        impact: model.impact,
        law: model.law,
    }
    .serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Model, D::Error> {
    let saved = SavedModel::deserialize(deserializer)?;
    Ok(Model {
        source: match saved.source {
            SavedSource::Geometry(tube) => CoefficientSource::from(tube),
            SavedSource::Given(coefficients) => CoefficientSource::from(coefficients),
        },
        friction: saved.friction,
        mismatch: saved.mismatch,
        damping: Damping {
            mass: saved.mass_damping,
            stiffness: saved.stiffness_damping,
        },
        impact: saved.impact,
        law: saved.law,
    })
}
