//! The plane to map: two parameters, where in it, and the waves to begin with.

use serde::{Deserialize, Serialize};

use super::Start;
use crate::tube::model::Parameter;

/// Most rows or columns of a grid.
pub(crate) const MAX_GRID: usize = 100_000;
/// Most points of a map.
pub(crate) const MAX_MAP_POINTS: usize = 100_000_000;

/// A map of waves over a plane of two parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// The parameter that is the same along a row of a grid.
    pub first: MapAxis,
    /// The parameter that a branch is followed in along a row of a grid.
    pub second: MapAxis,
    /// Where in the plane.
    pub points: MapPoints,
    /// Which waves to begin with, each at most once.
    #[serde(default = "both")]
    pub starts: Vec<Start>,
}

fn both() -> Vec<Start> {
    vec![Start::Fast, Start::Slow]
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
