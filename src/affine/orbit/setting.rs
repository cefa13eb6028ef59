//! What the orbits of a branch have in common, and why equations cannot be evaluated.

use serde::{Deserialize, Serialize};

use crate::affine::closure::Prescribed;
use crate::affine::flow::MOST_PIECES;
use crate::affine::system::{System, SystemError};

/// Units of the unknowns, constant along a branch: they make every scaled unknown of order one. The phase is in
/// radians.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scales {
    /// Largest |xᵢ| of the first orbit, or 1 where that is 0.
    pub states: Vec<f64>,
    /// Its period.
    pub time: f64,
    /// Width of the range of the parameter.
    pub parameter: f64,
    /// Size of the parameter that is free for a prescribed period, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free: Option<f64>,
    /// The state that is greatest where an orbit begins that neither switches nor is forced, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<usize>,
}

/// What all orbits of a branch have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The system.
    pub system: System,
    /// Values of its parameters; that of the continuation parameter is overridden by the unknown.
    pub values: Vec<f64>,
    /// Index of the continuation parameter.
    pub parameter: usize,
    /// That of another one, of orbits that are posed in it at the same points: derivatives of integrated flows are had in both
    /// at once.
    pub second: Option<usize>,
    /// Forcing periods in one orbit; without forcing it has no meaning.
    pub periods: u32,
    /// The period, where it is prescribed: then a parameter is free.
    pub prescribed: Option<Prescribed>,
    /// Whether changes of stability are looked for.
    pub stability: bool,
    /// Units.
    pub scales: Scales,
}

impl Setting {
    /// The parameters of which derivatives are asked for, that of continuation first.
    pub fn varying(&self) -> Vec<usize> {
        let second = self.free().or(self.second);
        std::iter::once(self.parameter).chain(second).collect()
    }

    /// Whether derivatives in two parameters are asked for.
    pub(super) fn varies_in_two(&self) -> bool {
        self.prescribed.is_some() || self.second.is_some()
    }

    /// Index of the parameter that is free for a prescribed period.
    pub fn free(&self) -> Option<usize> {
        self.prescribed.as_ref().map(|prescribed| prescribed.free())
    }

    /// Values of all parameters at one of the continuation parameter.
    pub fn values_at(&self, value: f64) -> Vec<f64> {
        let mut values = self.values.clone();
        values[self.parameter] = value;
        values
    }
}

/// Why the equations of an orbit cannot be evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum OrbitFailure {
    /// The system makes no sense at this value of the parameter.
    #[error("{0}")]
    System(SystemError),
    /// The system has other zones there.
    #[error("the system does not have these zones there, or makes no sense")]
    NoZones,
    /// The flow leaves the range of numbers.
    #[error("the motion of the mode `{mode}` leaves the range of numbers within {duration}")]
    Overflow {
        /// Name of the mode.
        mode: String,
        /// Duration of the zone.
        duration: f64,
    },
    /// What a power is of becomes negative within a zone.
    #[error(
        "the rates of the mode `{mode}` have no value {time} after its beginning, where a power would be of a negative number"
    )]
    NoValue {
        /// Name of the mode.
        mode: String,
        /// Time since the beginning of the zone.
        time: f64,
    },
    /// A zone is too long for the time scale of its mode.
    #[error(
        "{duration} in the mode `{mode}` are {pieces:.0} of its own time scales; at most {most} are followed"
    )]
    Long {
        /// Name of the mode.
        mode: String,
        /// Duration of the zone.
        duration: f64,
        /// That in units of the time scale of the mode.
        pieces: f64,
        /// Most of them.
        most: f64,
    },
}

impl OrbitFailure {
    /// A zone of a mode that takes so many pieces, more than are followed.
    pub(super) fn long(mode: &str, duration: f64, pieces: f64) -> OrbitFailure {
        OrbitFailure::Long {
            mode: mode.to_owned(),
            duration,
            pieces,
            most: MOST_PIECES,
        }
    }
}
