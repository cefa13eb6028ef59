//! Brute force: what motions of a system settle on, for many values of a parameter.

use std::fmt;

use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::system::BeginningSection;
use crate::affine::system::{ModeSource, Ordered, SwitchSource, System, SystemError};

/// Most values of the parameter.
pub(crate) const MAX_VALUES: usize = 1_000_000;
/// Most samples of a value.
pub(crate) const MAX_KEPT: usize = 1_000_000;
/// Most samples of a scan.
pub(crate) const MAX_SCANNED: usize = 100_000_000;

/// The section `scan` of a problem with a system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scan {
    /// The parameter.
    pub parameter: String,
    /// Its values.
    pub values: ScanValues,
    /// In which order, and where each motion begins.
    #[serde(default)]
    pub sweep: Sweep,
    /// Periods of the forcing, or units of time without one, before samples are taken.
    pub settle: f64,
    /// Samples taken of each value.
    pub keep: usize,
    /// Whether the largest Lyapunov exponent is computed, or how many are.
    #[serde(default, skip_serializing_if = "LyapunovCount::is_none")]
    pub lyapunov: LyapunovCount,
    /// Where samples are taken; where the phase is zero unless given.
    #[serde(default)]
    pub section: SampleSection,
    /// Where the first motion begins; where that of `orbit` does unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<BeginningSection>,
    /// With it motions of `Fresh` begin at random states, the same ones for the same number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Ranges of the random states; those that are not named begin as `start` says. Without any of them all states
    /// lie within max(1, |s|) of their start s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<Ordered<(f64, f64)>>,
}

/// How many Lyapunov exponents are computed: `true` is the largest alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum LyapunovCount {
    /// One or none.
    Whether(bool),
    /// So many.
    Count(usize),
}

impl LyapunovCount {
    /// How many they are.
    pub fn count(self) -> usize {
        match self {
            LyapunovCount::Whether(asked) => usize::from(asked),
            LyapunovCount::Count(count) => count,
        }
    }

    fn is_none(&self) -> bool {
        *self == LyapunovCount::default()
    }
}

impl Default for LyapunovCount {
    fn default() -> Self {
        LyapunovCount::Whether(false)
    }
}

impl<'de> Deserialize<'de> for LyapunovCount {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LyapunovCountVisitor)
    }
}

struct LyapunovCountVisitor;

impl Visitor<'_> for LyapunovCountVisitor {
    type Value = LyapunovCount;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("`true`, or how many exponents")
    }

    fn visit_bool<E: de::Error>(self, value: bool) -> Result<LyapunovCount, E> {
        Ok(LyapunovCount::Whether(value))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<LyapunovCount, E> {
        let count = usize::try_from(value);
        let refused = |_| E::invalid_value(de::Unexpected::Unsigned(value), &self);
        Ok(LyapunovCount::Count(count.map_err(refused)?))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<LyapunovCount, E> {
        let refused = |_| E::invalid_value(de::Unexpected::Signed(value), &self);
        let count = u64::try_from(value).map_err(refused)?;
        self.visit_u64(count)
    }
}

/// Values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ScanValues {
    /// Equidistant ones: the least, the greatest, and how many, both ends among them.
    Linear(f64, f64, usize),
}

/// Where the motion of a value begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sweep {
    /// Where that of the value below has come to.
    #[default]
    Up,
    /// Where that of the value above has come to.
    Down,
    /// Both of these, one after the other.
    Both,
    /// At the start, or at random.
    Fresh,
}

/// Where samples of a motion are taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Section")]
pub enum SampleSection {
    /// At this phase of the forcing.
    Phase(f64),
    /// Where this expression comes to zero from below.
    Zero(String),
}

impl Default for SampleSection {
    fn default() -> Self {
        SampleSection::Phase(0.0)
    }
}

impl ScanValues {
    /// How many they are.
    pub fn count(self) -> usize {
        let ScanValues::Linear(_, _, count) = self;
        count
    }

    /// The value with this number from 0, from the least.
    pub fn value(self, number: usize) -> f64 {
        let ScanValues::Linear(low, high, count) = self;
        let part = number as f64 / (count.max(2) - 1) as f64;
        low * (1.0 - part) + high * part
    }
}

impl Scan {
    /// Names of the columns of the Lyapunov exponents that are asked for.
    pub fn exponent_columns(&self) -> Vec<String> {
        let numbers = 1..=self.lyapunov.count();
        let names = numbers.map(|number| match number {
            1 => "lyapunov".to_owned(),
            _ => format!("lyapunov_{number}"),
        });
        names
            .flat_map(|name| [format!("{name}_error"), name].into_iter().rev())
            .collect()
    }

    /// The system with one more mode, which nothing leads to and the first guard of which is the expression of the
    /// section, and the number of that mode; without such an expression the system as it is.
    ///
    /// # Errors
    /// What is wrong with the expression, at the path of that mode.
    pub fn system(&self, system: &System) -> Result<(System, Option<usize>), SystemError> {
        let SampleSection::Zero(zero) = &self.section else {
            return Ok((system.clone(), None));
        };
        if system.products.is_some() {
            let (system, number) = system.with_section(zero)?;
            return Ok((system, Some(number)));
        }
        let mut source = system.source.clone();
        let mut name = "section".to_owned();
        while system.mode(&name).is_some() {
            name.push('_');
        }
        let rates = source.states.iter();
        let rates = rates.map(|state| (state.clone(), "0".to_owned()));
        let mode = ModeSource {
            rates: Ordered(rates.collect()),
            until: vec![SwitchSource {
                zero: zero.clone(),
                to: name.clone(),
                ..SwitchSource::default()
            }],
        };
        let number = source.modes.0.len();
        source.modes.0.push((name, mode));
        Ok((System::new(source)?, Some(number)))
    }
}
