//! The plane to map: two parameters, where in it, and what to begin with.

use serde::{Deserialize, Serialize};

use super::{Beginning, Start};
use crate::tube::model::Parameter;

/// Most rows or columns of a grid.
pub(crate) const MAX_GRID: usize = 100_000;
/// Most points of a map.
pub(crate) const MAX_MAP_POINTS: usize = 100_000_000;

/// A map over a plane of two parameters, of waves unless told otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(bound(deserialize = "P: Deserialize<'de>, S: Deserialize<'de> + Starts"))]
pub struct Map<P = Parameter, S = Start> {
    /// The parameter that is the same along a row of a grid.
    pub first: MapAxis<P>,
    /// The parameter that changes along a row of a grid: branches of waves are followed in it.
    pub second: MapAxis<P>,
    /// Where in the plane.
    pub points: MapPoints,
    /// Which waves to begin with, each at most once; of a system where motions begin.
    #[serde(default = "Starts::unless_given")]
    pub starts: Vec<S>,
}

/// The same for motions of a system; those of `orbit` where no starts are given.
pub type SystemMap = Map<String, Beginning>;

/// What a map begins with.
pub trait Starts: Sized {
    /// Where the file does not say.
    fn unless_given() -> Vec<Self>;
}

impl Starts for Start {
    fn unless_given() -> Vec<Start> {
        vec![Start::Fast, Start::Slow]
    }
}

impl Starts for Beginning {
    fn unless_given() -> Vec<Beginning> {
        Vec::new()
    }
}

/// One side of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapAxis<P = Parameter> {
    /// Parameter.
    pub parameter: P,
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
