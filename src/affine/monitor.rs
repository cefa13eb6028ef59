//! Monitors: numbers of an orbit that a problem asks for, as they are written and once their expressions are read.

use serde::{Deserialize, Serialize};

use super::expression::Expression;

/// A monitor as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MonitorSource {
    /// The largest value of an expression over the period.
    Max(String),
    /// The least.
    Min(String),
    /// The largest size.
    Largest(String),
    /// The mean over the period.
    Mean(String),
    /// The integral over the period.
    Integral(String),
    /// The value just before a switch of this name, by its number among those of the period, from 1.
    Before(String, String, #[serde(default = "first")] usize),
    /// The value just after it.
    After(String, String, #[serde(default = "first")] usize),
}

fn first() -> usize {
    1
}

impl MonitorSource {
    /// Its expression, and the place of that among its entries.
    pub(super) fn expression(&self) -> (usize, &str) {
        match self {
            MonitorSource::Max(text)
            | MonitorSource::Min(text)
            | MonitorSource::Largest(text)
            | MonitorSource::Mean(text)
            | MonitorSource::Integral(text) => (0, text),
            MonitorSource::Before(_, text, _) | MonitorSource::After(_, text, _) => (1, text),
        }
    }

    /// The name of the switch that it is about, and the number of that in the period.
    pub fn switch(&self) -> Option<(&str, usize)> {
        match self {
            MonitorSource::Before(name, _, number) | MonitorSource::After(name, _, number) => {
                Some((name, *number))
            }
            _ => None,
        }
    }
}

/// Where monitors stand in a problem.
pub const MONITOR: &str = "monitor";

/// A monitor with its expression read.
#[derive(Clone, Debug, PartialEq)]
pub struct Monitor {
    /// Its name: that of a column.
    pub name: String,
    /// What it is of its expression.
    pub source: MonitorSource,
    pub(super) expression: Expression,
}

impl Monitor {
    /// Where its expression stands in a problem.
    pub(super) fn path(&self) -> String {
        let (place, _) = self.source.expression();
        format!("{MONITOR}.{}.{place}", self.name)
    }

    /// Whether its expression names this.
    pub fn has(&self, name: &str) -> bool {
        let mut found = false;
        self.expression.names(&mut |one, _| found |= one == name);
        found
    }
}
