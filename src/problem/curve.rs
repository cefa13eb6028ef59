//! The curve of an event in two parameters.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::continuation::{DEFAULT_DS, DEFAULT_DS_MAX, DEFAULT_DS_MIN, DEFAULT_TOLERANCE, Steps};
use crate::orbit::EventType;
use crate::tube::model::Parameter;

/// Largest number of points of a curve where none is given.
pub(crate) const DEFAULT_CURVE_POINTS: usize = 10_000;

/// The event a curve begins with: the first of its type along the branch of `continuation`, or the
/// one that an earlier run labelled.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum CurveEvent {
    /// Fold.
    LP,
    /// Take-off at zero pressure.
    GR,
    /// Reverse slip opens or closes at stick.
    RV,
    /// Two switching points coalesce.
    CO,
    /// The stick zone vanishes.
    ST,
    /// A complex pair crosses the imaginary axis.
    HB,
    /// An event of an earlier run, whatever its type.
    Label {
        /// Result folder.
        dir: PathBuf,
        /// Label in it.
        label: usize,
    },
}

/// The same for orbits or equilibria of a system.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SystemCurveEvent {
    /// Fold.
    LP,
    /// A multiplier is −1.
    PD,
    /// A pair of multipliers is on the unit circle.
    NS,
    /// A symmetric orbit loses its symmetry; of equilibria: another branch passes.
    BP,
    /// A guard is touched from inside.
    GR,
    /// Two switches coalesce.
    CO,
    /// A condition reaches zero.
    SL,
    /// Of equilibria: a pair of eigenvalues is imaginary.
    HB,
    /// Of equilibria: a guard of the mode is zero.
    BE,
    /// The branch comes to a homoclinic orbit: the curve is that of its saddle.
    HC,
    /// The monitor of this name keeps a value: one that `stop_at` asks for, or else that of the first point.
    Constant(String),
    /// An event of an earlier run, whatever its type.
    Label {
        /// Result folder.
        dir: PathBuf,
        /// Label in it.
        label: usize,
    },
}

impl SystemCurveEvent {
    /// Its type; that of a label is known to the result folder.
    pub fn kind(&self) -> Option<EventType> {
        match self {
            SystemCurveEvent::LP => Some(EventType::LP),
            SystemCurveEvent::PD => Some(EventType::PD),
            SystemCurveEvent::NS => Some(EventType::NS),
            SystemCurveEvent::BP => Some(EventType::BP),
            SystemCurveEvent::GR => Some(EventType::GR),
            SystemCurveEvent::CO => Some(EventType::CO),
            SystemCurveEvent::SL => Some(EventType::SL),
            SystemCurveEvent::HB => Some(EventType::HB),
            SystemCurveEvent::BE => Some(EventType::BE),
            SystemCurveEvent::HC => Some(EventType::HC),
            SystemCurveEvent::Constant(_) => Some(EventType::UZ),
            SystemCurveEvent::Label { .. } => None,
        }
    }
}

impl CurveEvent {
    /// Its type; that of a label is known to the result folder.
    pub fn kind(&self) -> Option<EventType> {
        match self {
            CurveEvent::LP => Some(EventType::LP),
            CurveEvent::GR => Some(EventType::GR),
            CurveEvent::RV => Some(EventType::RV),
            CurveEvent::CO => Some(EventType::CO),
            CurveEvent::ST => Some(EventType::ST),
            CurveEvent::HB => Some(EventType::HB),
            CurveEvent::Label { .. } => None,
        }
    }
}

/// The curve along which an event of the branch of `continuation` moves in two parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Curve", deny_unknown_fields)]
pub struct CurveSection<P = Parameter, E = CurveEvent> {
    /// LP, GR, RV, CO, ST or HB, or a label of a result folder; of a system LP, PD, NS, BP, GR, CO, SL, HC or
    /// a monitor that is constant, of its equilibria LP, HB, BE or BP.
    pub event: E,
    /// Which of its type along the branch, from 1.
    #[serde(default = "one")]
    pub index: usize,
    /// Bloch sector of an HB, at most half the mode.
    #[serde(default)]
    pub sector: usize,
    /// The two parameters, different.
    pub parameters: (P, P),
    /// Lower and upper end of each.
    pub range: ((f64, f64), (f64, f64)),
    /// First step, in dimensionless scaled arclength.
    #[serde(default = "ds")]
    pub ds: f64,
    /// Smallest step before the curve is given up.
    #[serde(default = "ds_min")]
    pub ds_min: f64,
    /// Largest step.
    #[serde(default = "ds_max")]
    pub ds_max: f64,
    /// Largest number of points in either direction, at least 1.
    #[serde(default = "max_points")]
    pub max_points: usize,
    /// Size of the last Newton correction at which a point is accepted.
    #[serde(default = "tolerance")]
    pub tolerance: f64,
}

/// The same for orbits or equilibria of a system, with the names of two of its parameters.
pub type SystemCurve = CurveSection<String, SystemCurveEvent>;

impl<P, E> CurveSection<P, E> {
    /// First step, shortest and longest one, and tolerance.
    pub fn steps(&self) -> Steps {
        Steps {
            ds: self.ds,
            ds_min: self.ds_min,
            ds_max: self.ds_max,
            tolerance: self.tolerance,
        }
    }
}

fn one() -> usize {
    1
}

fn ds() -> f64 {
    DEFAULT_DS
}

fn ds_min() -> f64 {
    DEFAULT_DS_MIN
}

fn ds_max() -> f64 {
    DEFAULT_DS_MAX
}

fn max_points() -> usize {
    DEFAULT_CURVE_POINTS
}

fn tolerance() -> f64 {
    DEFAULT_TOLERANCE
}
