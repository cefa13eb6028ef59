//! What to simulate in time, and from where.

use std::fmt;
use std::marker::PhantomData;
use std::path::PathBuf;

use serde::de::value::MapAccessDeserializer;
use serde::de::{EnumAccess, MapAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::ring::{Order, RingLaw};
use crate::tube::model::Sectors;

/// Fewest points of a ring, or of the contact line of an annulus, per wavelength simulated.
pub(crate) const MIN_SIMULATION_POINTS: usize = 16;
/// Fewest points per wavelength for [`GrowthTask`], which looks at half as many, too: seven points are the
/// least on which differences of every order do not reach round a ring.
pub(crate) const MIN_GROWTH_POINTS: usize = 14;
/// Most points of a ring, and most nodes of an annulus.
pub(crate) const MAX_SIMULATION_POINTS: usize = 1 << 20;
/// Most samples of a simulation.
pub(crate) const MAX_SAMPLES: usize = 1 << 20;
pub(crate) const MAX_SNAPSHOTS: usize = 1000;
/// Largest Courant number: beyond it, rates are off by a percent long before the scheme breaks.
pub(crate) const MAX_COURANT: f64 = 0.9;
/// Courant number where none is given.
pub(crate) const DEFAULT_COURANT: f64 = 0.3;
/// Time between samples where none is given, in units of 1/Ω.
pub(crate) const DEFAULT_EVERY: f64 = 0.05;
/// Pairs of runs of [`GrowthTask`] where none are given.
pub(crate) const DEFAULT_PAIRS: usize = 80;
/// Largest difference of the two runs of a pair where none is given, in units of RΩ.
pub(crate) const DEFAULT_GROWTH_AMPLITUDE: f64 = 1e-4;

/// A simulation in time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simulation {
    /// What moves.
    pub body: Body,
    /// How much of the circle is simulated.
    #[serde(default)]
    pub circle: Circle,
    /// The motion at the beginning.
    pub start: SimulationStart,
    /// What is added to it.
    #[serde(default)]
    pub perturbation: Option<Perturbation>,
    /// Time simulated, in units of 1/Ω.
    pub duration: f64,
    /// Largest Courant number; with stiffness damping the part of √(4β² + Δφ²/a) − 2β that a step takes.
    #[serde(default = "default_courant")]
    pub courant: f64,
    /// Time between samples, in units of 1/Ω; the last one is at the end of the duration.
    #[serde(default = "default_every")]
    pub every: f64,
    /// Number of snapshots, evenly spread over the duration, the last at its end.
    #[serde(default)]
    pub snapshots: usize,
    /// Growth of perturbations of the wave at the beginning.
    #[serde(default)]
    pub growth: Option<GrowthTask>,
}

impl Simulation {
    /// Whole intervals between samples, and the time that they leave of the duration, 0 for none.
    pub(crate) fn intervals(&self) -> (usize, f64) {
        let ratio = self.duration / self.every;
        // both were rounded once, and so was their ratio: two units of it
        if (ratio - ratio.round()).abs() <= 2.0 * f64::EPSILON * ratio {
            return (ratio.round() as usize, 0.0);
        }
        (ratio as usize, self.duration - ratio.floor() * self.every)
    }
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Body {
    /// System (M) by finite differences.
    Ring {
        /// Points on what is simulated of the circle.
        points: usize,
        /// Accuracy of the space differences.
        #[serde(default)]
        order: Order,
        /// Friction law.
        #[serde(default)]
        friction: RingLaw,
    },
    /// The elastic tube by finite elements.
    Annulus {
        /// Elements along what is simulated of the circle.
        around: usize,
        /// Elements from the inner to the outer radius.
        across: usize,
    },
}

/// How much of the circle is simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Circle {
    /// All of it.
    #[default]
    Whole,
    /// One wavelength 2π/mode, its ends joined.
    Wavelength,
}

/// The motion at the beginning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum SimulationStart {
    /// Steady sliding.
    SteadySliding,
    /// The wave that the branch of the problem begins with, written `start: Wave`.
    #[serde(rename = "Wave")]
    OwnWave,
    /// A wave of a result folder that has its profile.
    Wave {
        /// Directory with the results of a run.
        dir: PathBuf,
        /// Label of the point.
        label: usize,
    },
    /// A table like those in `profiles` of a result folder, over one wavelength.
    Profile {
        /// The file.
        file: PathBuf,
        /// Speed c ≠ 0 of the wave.
        speed: f64,
    },
}

impl<'de> Deserialize<'de> for SimulationStart {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum(
            "SimulationStart",
            &["SteadySliding", "Wave", "Profile"],
            StartVisitor,
        )
    }
}

/// Reads a start: values follow the name `Wave`, or they do not.
struct StartVisitor;

#[derive(Deserialize)]
#[serde(variant_identifier)]
enum StartName {
    SteadySliding,
    Wave,
    Profile,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredWave {
    dir: PathBuf,
    label: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tabulated {
    file: PathBuf,
    speed: f64,
}

impl<'de> Visitor<'de> for StartVisitor {
    type Value = SimulationStart;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("the start of a simulation")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<SimulationStart, A::Error> {
        let (name, content): (StartName, _) = data.variant()?;
        let mut entered = false;
        match name {
            StartName::SteadySliding => {
                content.unit_variant()?;
                Ok(SimulationStart::SteadySliding)
            }
            StartName::Profile => {
                let values = Values::<Tabulated>::new(&mut entered);
                let Tabulated { file, speed } =
                    content.struct_variant(&["file", "speed"], values)?;
                Ok(SimulationStart::Profile { file, speed })
            }
            StartName::Wave => {
                let values = Values::<StoredWave>::new(&mut entered);
                match content.struct_variant(&["dir", "label"], values) {
                    Ok(StoredWave { dir, label }) => Ok(SimulationStart::Wave { dir, label }),
                    // no bracket was opened
                    Err(_) if !entered => Ok(SimulationStart::OwnWave),
                    Err(error) => Err(error),
                }
            }
        }
    }
}

/// Reads the values of a variant, and tells whether there are any.
struct Values<'a, T>(&'a mut bool, PhantomData<T>);

impl<'a, T> Values<'a, T> {
    fn new(entered: &'a mut bool) -> Self {
        Values(entered, PhantomData)
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Values<'_, T> {
    type Value = T;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("values in parentheses")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        *self.0 = true;
        T::deserialize(MapAccessDeserializer::new(map))
    }
}

/// A travelling harmonic added at the beginning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Perturbation {
    /// Waves around the whole circumference.
    pub mode: u32,
    /// Amplitude in V, in units of R.
    pub amplitude: f64,
}

/// Growth of perturbations of the wave at the beginning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Growth", default, deny_unknown_fields)]
pub struct GrowthTask {
    /// Bloch sectors to look at.
    pub sectors: Sectors,
    /// Pairs of runs.
    pub pairs: usize,
    /// Largest difference between the runs of a pair and the wave.
    pub amplitude: f64,
}

impl Default for GrowthTask {
    fn default() -> GrowthTask {
        GrowthTask {
            sectors: Sectors::All,
            pairs: DEFAULT_PAIRS,
            amplitude: DEFAULT_GROWTH_AMPLITUDE,
        }
    }
}

fn default_courant() -> f64 {
    DEFAULT_COURANT
}

fn default_every() -> f64 {
    DEFAULT_EVERY
}
