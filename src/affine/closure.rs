//! What closes an orbit whose period is prescribed: the period as an expression in the parameters, and the parameter that is
//! free for it.
//!
//! A wave f(φ − ct) of wavelength 2π/k is such an orbit: what a material point meets of it is a motion of the period 2π/(kc),
//! and its speed c is not known before.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::algebra::Algebra;
use super::dual::Dual;
use super::expression::Expression;
use super::system::{Mistake, Ordered, Source, SystemError};

/// A prescribed period.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WrittenPeriod", into = "WrittenPeriod")]
pub struct Prescribed {
    written: WrittenPeriod,
    period: Expression,
}

/// The same in words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Written", deny_unknown_fields)]
struct WrittenPeriod {
    /// The period.
    period: String,
    /// Names of all parameters, in their order.
    parameters: Vec<String>,
    /// Index of the parameter that is free.
    free: usize,
}

impl TryFrom<WrittenPeriod> for Prescribed {
    type Error = SystemError;

    fn try_from(written: WrittenPeriod) -> Result<Prescribed, SystemError> {
        let values = written.parameters.into_iter().map(|name| (name, 0.0));
        let source = Source {
            parameters: Ordered(values.collect()),
            ..Source::default()
        };
        Prescribed::new(&source, &written.period, written.free)
    }
}

impl From<Prescribed> for WrittenPeriod {
    fn from(prescribed: Prescribed) -> WrittenPeriod {
        prescribed.written
    }
}

/// Where the period stands in a problem.
pub const PERIOD: &str = "orbit.period";

impl Prescribed {
    /// The period that a text prescribes to orbits of a system, where a parameter of this index is free.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn new(source: &Source, text: &str, free: usize) -> Result<Prescribed, SystemError> {
        let written = WrittenPeriod {
            period: text.to_owned(),
            parameters: source.parameters.names().map(str::to_owned).collect(),
            free,
        };
        Ok(Prescribed {
            period: source.of_parameters(PERIOD, text)?,
            written,
        })
    }

    /// Index of the parameter that is free.
    pub fn free(&self) -> usize {
        self.written.free
    }

    /// Whether the period depends on a parameter.
    pub fn has(&self, parameter: &str) -> bool {
        let mut found = false;
        self.period.names(&mut |name, _| found |= name == parameter);
        found
    }

    /// The period at these values of the parameters, with derivatives in those of the indices `varying`.
    ///
    /// # Errors
    /// It has no value, or is not positive.
    pub fn period(&self, values: &[f64], varying: &[usize]) -> Result<Dual, SystemError> {
        let parameter = Dual::parameters(values, varying);
        let meaning = |name: &str| match name {
            "pi" => Some(Dual::number(PI)),
            _ => {
                let mut names = self.written.parameters.iter();
                let index = names.position(|known| known == name);
                index.map(&parameter)
            }
        };
        let flawed = |flaw| SystemError::at(PERIOD, Mistake::Expression(flaw));
        let period = self.period.evaluate(&meaning).map_err(flawed)?;
        match period.value > 0.0 {
            true => Ok(period),
            false => Err(SystemError::at(PERIOD, Mistake::Period(period.value))),
        }
    }
}
