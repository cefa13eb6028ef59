//! The branch to follow.

use std::fmt;

use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::continuation::{DEFAULT_DS, DEFAULT_DS_MAX, DEFAULT_DS_MIN, DEFAULT_TOLERANCE, Steps};
use crate::orbit::EventType;
use crate::orbit::legs::Plan;
use crate::orbit::monitor::MonitorStop;
use crate::tube::model::{FrictionLaw, Parameter};

/// Largest number of points of a leg where none is given.
pub(crate) const DEFAULT_MAX_POINTS: usize = 100_000;
/// The same under a `Regularised` law, whose zones are integrated: some 20 ms a point, five seconds a leg.
pub(crate) const DEFAULT_MAX_POINTS_INTEGRATED: usize = 150;

/// Which way a branch leaves its first point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Toward {
    /// Toward smaller values of the parameter.
    Down,
    /// Toward larger values of the parameter.
    Up,
    /// One branch each way.
    #[default]
    Both,
}

impl Toward {
    /// Whether the parameter grows at first, leg by leg.
    pub(crate) fn directions(self) -> &'static [bool] {
        match self {
            Toward::Down => &[false],
            Toward::Up => &[true],
            Toward::Both => &[false, true],
        }
    }

    /// The way a branch leaves a Hopf point of steady sliding: damping ends the waves that friction
    /// drives.
    pub(crate) fn beyond_hopf(parameter: Parameter) -> Toward {
        match parameter {
            Parameter::MassDamping | Parameter::StiffnessDamping => Toward::Down,
            _ => Toward::Up,
        }
    }
}

/// The branch to follow, with every default filled in. Its parameter is one of a tube, or has a name in a
/// system of one's own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "WrittenContinuation<P>")]
pub struct Continuation<P = Parameter> {
    /// Parameter of the branch.
    pub parameter: P,
    /// Lower and upper end of the parameter, lower < upper.
    pub range: (f64, f64),
    /// Which way to go first.
    pub toward: Toward,
    /// Where a user point is wanted: at values of the parameter, within `range`, or of a monitor.
    pub stop_at: Vec<UserPoint>,
    /// First step, in dimensionless scaled arclength; `ds_min` ≤ `ds` ≤ `ds_max`.
    pub ds: f64,
    /// Smallest step before the branch is given up, in dimensionless scaled arclength.
    pub ds_min: f64,
    /// Largest step, in dimensionless scaled arclength.
    pub ds_max: f64,
    /// Largest number of points of a leg, at least 1; see [`Continuation::most_points`].
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "bare")]
    pub max_points: Option<usize>,
    /// Relative size of the Newton correction at which a point is accepted.
    pub tolerance: f64,
    /// Events that end the branch.
    pub stop_after: Vec<StopAfter>,
}

impl<P> Continuation<P> {
    /// A branch through a range both ways, with every default.
    pub fn new(parameter: P, range: (f64, f64)) -> Continuation<P> {
        Continuation {
            parameter,
            range,
            toward: Toward::Both,
            stop_at: Vec::new(),
            ds: DEFAULT_DS,
            ds_min: DEFAULT_DS_MIN,
            ds_max: DEFAULT_DS_MAX,
            max_points: None,
            tolerance: DEFAULT_TOLERANCE,
            stop_after: Vec::new(),
        }
    }
}

impl<P> Continuation<P> {
    /// Step lengths and tolerance.
    pub fn steps(&self) -> Steps {
        Steps {
            ds: self.ds,
            ds_min: self.ds_min,
            ds_max: self.ds_max,
            tolerance: self.tolerance,
        }
    }

    /// The values of the parameter at which a user point is wanted.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.stop_at.iter().filter_map(|point| match point {
            UserPoint::Parameter(value) => Some(*value),
            UserPoint::Monitor(..) => None,
        })
    }

    /// The values of monitors at which a user point is wanted, where `number` is that of a monitor.
    fn monitors(&self, number: impl Fn(&str) -> Option<usize>) -> Vec<MonitorStop> {
        let stops = self.stop_at.iter().filter_map(|point| match point {
            UserPoint::Parameter(_) => None,
            UserPoint::Monitor(name, value) => Some(MonitorStop {
                monitor: number(name)?,
                value: *value,
            }),
        });
        stops.collect()
    }

    /// What is asked for of the legs of a run; `samples` are the profiles wanted, `number` is that of a monitor.
    pub(crate) fn plan(
        &self,
        most_points: usize,
        samples: usize,
        number: impl Fn(&str) -> Option<usize>,
    ) -> Plan {
        let stops = self.stop_after.iter();
        Plan {
            range: self.range,
            directions: self.toward.directions().to_vec(),
            stop_at: self.values().collect(),
            monitors: self.monitors(number),
            stop_after: stops.map(|stop| (stop.event, stop.count)).collect(),
            steps: self.steps(),
            most_points,
            samples,
        }
    }
}

impl Continuation {
    /// Largest number of points of a leg: the one given, or what a law can do in seconds.
    pub(crate) fn most_points(&self, law: FrictionLaw) -> usize {
        self.max_points.unwrap_or(match law {
            FrictionLaw::Regularised { .. } => DEFAULT_MAX_POINTS_INTEGRATED,
            _ => DEFAULT_MAX_POINTS,
        })
    }
}

/// Ends a branch after a number of events of one type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StopAfter {
    /// Type of the event.
    pub event: EventType,
    /// Which occurrence ends the branch, at least 1.
    pub count: usize,
}

/// The section before the defaults are filled in.
#[derive(Deserialize)]
#[serde(rename = "Continuation", deny_unknown_fields)]
struct WrittenContinuation<P> {
    parameter: P,
    range: (f64, f64),
    #[serde(default)]
    toward: Toward,
    #[serde(default)]
    stop_at: Vec<UserPoint>,
    #[serde(default, deserialize_with = "given")]
    ds: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    ds_min: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    ds_max: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    max_points: Option<usize>,
    #[serde(default = "default_tolerance")]
    tolerance: f64,
    #[serde(default)]
    stop_after: Vec<StopAfter>,
}

fn given<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

/// As a problem file has it, and [`given`] reads it.
fn bare<S: Serializer>(points: &Option<usize>, serializer: S) -> Result<S::Ok, S::Error> {
    match points {
        Some(points) => points.serialize(serializer),
        None => serializer.serialize_none(),
    }
}

fn default_tolerance() -> f64 {
    DEFAULT_TOLERANCE
}

impl<P> From<WrittenContinuation<P>> for Continuation<P> {
    fn from(written: WrittenContinuation<P>) -> Self {
        // A default gives way to what was written, unless that makes no sense for a step.
        let sensible = |step: Option<f64>| step.filter(|step| step.is_finite() && *step > 0.0);
        let floor = sensible(written.ds_min).unwrap_or(0.0);
        let ceiling = sensible(written.ds_max).unwrap_or(f64::INFINITY);
        let ds = sensible(written.ds).unwrap_or(DEFAULT_DS.max(floor).min(ceiling));
        Continuation {
            parameter: written.parameter,
            range: written.range,
            toward: written.toward,
            stop_at: written.stop_at,
            ds: written.ds.unwrap_or(ds),
            ds_min: written.ds_min.unwrap_or(DEFAULT_DS_MIN.min(ds)),
            ds_max: written.ds_max.unwrap_or(DEFAULT_DS_MAX.max(ds)),
            max_points: written.max_points,
            tolerance: written.tolerance,
            stop_after: written.stop_after,
        }
    }
}

/// Where a user point is wanted: a bare number, or one with the name of its column, as in `(mismatch: 0.08)`; or the name of
/// a monitor and its value, as in `("peak", 0.5)`.
#[derive(Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum UserPoint {
    /// A value of the parameter.
    Parameter(f64),
    /// One of the monitor of this name.
    Monitor(String, f64),
}

/// As a problem file has it.
impl fmt::Debug for UserPoint {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            UserPoint::Parameter(value) => write!(formatter, "{value:?}"),
            UserPoint::Monitor(name, value) => write!(formatter, "({name:?}, {value:?})"),
        }
    }
}

impl PartialEq<f64> for UserPoint {
    fn eq(&self, other: &f64) -> bool {
        matches!(self, UserPoint::Parameter(value) if value == other)
    }
}

impl From<f64> for UserPoint {
    fn from(value: f64) -> UserPoint {
        UserPoint::Parameter(value)
    }
}

impl<'de> Deserialize<'de> for UserPoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(UserPointVisitor)
    }
}

struct UserPointVisitor;

impl<'de> Visitor<'de> for UserPointVisitor {
    type Value = UserPoint;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number or one named number such as `(mismatch: 0.08)`")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<UserPoint, E> {
        Ok(value.into())
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<UserPoint, E> {
        Ok((value as f64).into())
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<UserPoint, E> {
        Ok((value as f64).into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<UserPoint, A::Error> {
        let lacking = |count| de::Error::invalid_length(count, &self);
        let name: String = entries.next_element()?.ok_or_else(|| lacking(0))?;
        let value: f64 = entries.next_element()?.ok_or_else(|| lacking(1))?;
        Ok(UserPoint::Monitor(name, value))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<UserPoint, A::Error> {
        // Whether the name is that of the parameter is known only later.
        match map.next_entry::<String, f64>()? {
            Some((_, value)) if map.next_key::<String>()?.is_none() => Ok(value.into()),
            Some(_) => Err(de::Error::invalid_length(2, &self)),
            None => Err(de::Error::invalid_length(0, &self)),
        }
    }
}
