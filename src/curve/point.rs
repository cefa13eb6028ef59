//! A point of a curve of events, and how far to follow, as plain data.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::continuation::Steps;
use crate::orbit::special::{Change, Close};
use crate::orbit::{EventType, Orbit, UnknownType};
use crate::problem;

/// How far to follow, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveLimits {
    /// Range of each parameter.
    pub ranges: [(f64, f64); 2],
    /// Step lengths and tolerance.
    pub steps: Steps,
    /// Largest number of points in either direction.
    pub most_points: usize,
}

impl CurveLimits {
    /// Those of a section of a problem.
    pub fn of<P, E>(section: &problem::CurveSection<P, E>) -> CurveLimits {
        CurveLimits {
            ranges: [section.range.0, section.range.1],
            steps: section.steps(),
            most_points: section.max_points,
        }
    }

    /// Widths of the ranges: the units of the parameters.
    pub fn widths(&self) -> [f64; 2] {
        self.ranges.map(|(low, high)| high - low)
    }
}

/// Type of a point of a curve; written as tables have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum PointType {
    /// The start, or an end.
    One(EventType),
    /// Two events at once.
    Two(EventType, EventType),
    /// Cusp.
    CP,
    /// ω → 0.
    BT,
    /// The first Lyapunov coefficient of a Hopf point is zero.
    GH,
    /// An eigenvalue zero beside a pair on the imaginary axis.
    ZH,
    /// Two pairs on the imaginary axis.
    HH,
    /// Resonance 1:n of a pair of multipliers at e^(2πi/n), n = 1, 2, 3 or 4.
    Resonance(u8),
}

impl fmt::Display for PointType {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PointType::One(event) => event.fmt(formatter),
            PointType::Two(one, other) => write!(formatter, "{one}+{other}"),
            PointType::CP => formatter.write_str("CP"),
            PointType::BT => formatter.write_str("BT"),
            PointType::GH => formatter.pad("GH"),
            PointType::ZH => formatter.pad("ZH"),
            PointType::HH => formatter.pad("HH"),
            PointType::Resonance(order) => write!(formatter, "R{order}"),
        }
    }
}

impl From<PointType> for String {
    fn from(kind: PointType) -> String {
        kind.to_string()
    }
}

impl TryFrom<String> for PointType {
    type Error = UnknownType;

    fn try_from(text: String) -> Result<PointType, UnknownType> {
        Ok(match (text.as_str(), text.split_once('+')) {
            ("CP", _) => PointType::CP,
            ("BT", _) => PointType::BT,
            ("GH", _) => PointType::GH,
            ("ZH", _) => PointType::ZH,
            ("HH", _) => PointType::HH,
            ("R1", _) => PointType::Resonance(1),
            ("R2", _) => PointType::Resonance(2),
            ("R3", _) => PointType::Resonance(3),
            ("R4", _) => PointType::Resonance(4),
            (_, Some((one, other))) => PointType::Two(one.parse()?, other.parse()?),
            (one, None) => PointType::One(one.parse()?),
        })
    }
}

/// A point of the curve: a row of `curve.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint {
    /// Both parameters.
    pub parameters: [f64; 2],
    /// Wave speed c, signed; the period of an orbit of a system.
    pub measure: f64,
    /// Regimes before the event.
    pub before: String,
    /// Regimes after it; empty where no admissible wave was found to go on.
    pub after: String,
    /// ω of a Hopf point; the angle of a pair of multipliers on the unit circle.
    pub angular: Option<f64>,
    /// Type of a point of codimension two, of the start and of the ends.
    pub kind: Option<PointType>,
    /// What happens there, in words; empty at ordinary points.
    pub what: String,
    /// Newton iterations.
    pub newton: usize,
    /// Largest residual relative to its row of the Jacobian.
    pub residual: f64,
    /// Excess speed e = |c|/√a − 1 of a wave.
    pub excess: Option<f64>,
    /// Further numbers; of an equilibrium its states, and the first Lyapunov coefficient of a Hopf point; of an orbit of a prescribed period
    /// the parameter that is free.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<Option<f64>>,
}

/// The name of a place beside the curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Stretch of the curve with the same waves that it belongs to, from 0.
    pub stretch: usize,
    /// Whether it lies on the left of the curve, in the order of its points, the second parameter
    /// pointing upwards.
    pub left: bool,
    /// Both parameters.
    pub place: [f64; 2],
    /// What is there.
    pub name: RegionName,
}

/// What is at a place beside a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum RegionName {
    /// The pair of a Hopf point.
    Pair {
        /// Whether it grows.
        grows: bool,
    },
    /// How many multipliers of the orbit are outside the unit circle.
    Outside(usize),
    /// How many eigenvalues of the equilibrium grow.
    Growing(usize),
    /// Orbits.
    Orbits {
        /// How many, where that is known, and what one of them is called.
        count: Option<(usize, &'static str)>,
        /// Their regimes, each once.
        regimes: Vec<String>,
    },
}

/// Why an event is no event any more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Gone {
    /// Another minimum inside the zone of this name is lower.
    Lower(String),
    /// The minimum leaves the zone through an end.
    Left(String),
    /// Another inequality of the zone, which vanishes along with the event, fails.
    Along(String),
    /// The system has no symmetry there.
    Asymmetric,
    /// The branches that cross have come apart.
    Opened,
}

/// What happens at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum What<O: Orbit> {
    /// The curve begins: the event on the branch.
    Begins,
    /// An edge of the range of a parameter.
    Edge(O::Parameter, f64),
    /// Another inequality fails.
    Meeting {
        /// The change of regime where it does.
        second: Box<Change<O>>,
        /// Whether this event could go on beyond it.
        may_go_on: bool,
        /// The signature in which it does.
        next: Option<O::Signature>,
    },
    /// The orbit has a fold too.
    Fold,
    /// Two folds meet and vanish.
    Cusp,
    /// Another test function vanishes.
    Other(PointType),
    /// The number of multipliers outside the unit circle changes, from the first to the second.
    Passing([usize; 2]),
    /// The orbit shrinks to a point; the parameters are known to this part of their ranges.
    Limit {
        /// Type of the point.
        kind: PointType,
        /// The part.
        error: f64,
    },
    /// Something comes so close to zero that rounding decides.
    Close(Close<O::Inequality>),
}
