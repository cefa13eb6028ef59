//! The plane to map: two parameters, where in it, and what to begin with.

use serde::{Deserialize, Serialize};

use super::{BeginningSection, ScanValues, Start};
use crate::affine::system::Ordered;
use crate::tube::model::Parameter;

/// Most rows or columns of a grid.
pub(crate) const MAX_GRID: usize = 100_000;
/// Most points of a map.
pub(crate) const MAX_MAP_POINTS: usize = 100_000_000;
/// Most motions of a value of shares.
pub(crate) const MAX_DRAWS: usize = 1_000_000;

/// A map over a plane of two parameters, of waves unless told otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(bound(deserialize = "X: Deserialize<'de>, S: Deserialize<'de> + Default"))]
pub struct Map<X = MapAxis, S = WaveStarts> {
    /// What is the same along a row of a grid.
    pub first: X,
    /// What changes along a row of a grid: branches of waves are followed in it.
    pub second: X,
    /// Where in the plane.
    pub points: MapPoints,
    /// Which waves to begin with, each at most once; of a system where motions begin.
    #[serde(default)]
    pub starts: S,
    /// Of a system: how large a share of motions comes to which attractor, along a parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shares: Option<Shares>,
}

/// Shares of attractors along a parameter, by motions that begin at random.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shares {
    /// The parameter.
    pub parameter: String,
    /// Its values.
    pub values: ScanValues,
    /// How many motions begin at each value: at the same states at all of them.
    pub draws: usize,
    /// The same random states for the same number.
    pub seed: u64,
    /// Ranges of the random states; those that are not named begin as the start says. Without any of them all states
    /// lie within max(1, |s|) of their start s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<Ordered<(f64, f64)>>,
}

/// The same for motions of a system; those of `orbit` where no starts are given.
pub type SystemMap = Map<SystemAxis, Vec<BeginningSection>>;

/// The waves that a map begins with: both, unless the file says which.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct WaveStarts(pub Vec<Start>);

impl Default for WaveStarts {
    fn default() -> WaveStarts {
        WaveStarts(vec![Start::Fast, Start::Slow])
    }
}

/// One side of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapAxis {
    /// Parameter.
    pub parameter: Parameter,
    /// Lower and upper end, lower < upper.
    pub range: (f64, f64),
}

/// The same of a system: of a parameter, or of a state in which motions begin. A problem that is checked has one of both,
/// the same for both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SystemAxis {
    /// Parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameter: Option<String>,
    /// State.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<String>,
    /// Lower and upper end, lower < upper.
    pub range: (f64, f64),
}

/// A side of a plane.
pub trait PlaneAxis {
    /// What changes along it, as the file writes it, and in which field.
    fn written(&self) -> (String, &'static str);
    /// Lower and upper end.
    fn range(&self) -> (f64, f64);
}

impl PlaneAxis for MapAxis {
    fn written(&self) -> (String, &'static str) {
        (format!("{:?}", self.parameter), PARAMETER)
    }

    fn range(&self) -> (f64, f64) {
        self.range
    }
}

impl PlaneAxis for SystemAxis {
    fn written(&self) -> (String, &'static str) {
        let field = if self.state.is_some() {
            STATE
        } else {
            PARAMETER
        };
        (format!("{:?}", self.name()), field)
    }

    fn range(&self) -> (f64, f64) {
        self.range
    }
}

impl SystemAxis {
    /// The name of the parameter or the state.
    pub fn name(&self) -> &str {
        let name = self.state.as_ref().or(self.parameter.as_ref());
        name.map_or("", String::as_str)
    }
}

/// The fields of an axis that may name what changes.
pub(crate) const PARAMETER: &str = "parameter";
pub(crate) const STATE: &str = "state";

impl SystemMap {
    /// Whether it is one of initial states: a basin of attraction.
    pub fn is_basin(&self) -> bool {
        self.first.state.is_some()
    }
}

/// Points of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MapPoints {
    /// Equidistant values of both parameters, ends included.
    Grid {
        /// Values of the first parameter, at least 2.
        rows: usize,
        /// Values of the second parameter, at least 2.
        columns: usize,
    },
    /// A quasi-random sequence: it fills the plane evenly at any length.
    QuasiRandom {
        /// Number of points, at least 1.
        count: usize,
    },
}
