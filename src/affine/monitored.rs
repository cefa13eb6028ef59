//! A system with its monitors: their expressions read, and laid out at given values of the parameters.

use std::collections::BTreeMap;

use super::algebra::Obstacle;
use super::dual::Dual;
use super::evaluation::Evaluation;
use super::expression::ExpressionFlaw;
use super::form::Form;
use super::mode::AffineSystem;
use super::monitor::{MONITOR, Monitor, MonitorSource};
use super::rows::Row;
use super::system::{Mistake, Ordered, Source, System, SystemError};

/// Monitors of a system, their expressions read.
///
/// # Errors
/// An expression that is none, with its place; a switch that no entry of `until` is the name of.
pub fn read(
    source: &Source,
    written: &Ordered<MonitorSource>,
) -> Result<Vec<Monitor>, SystemError> {
    let monitors = written.0.iter().map(|(name, one)| {
        let (place, text) = one.expression();
        let expression = source.of_all(&format!("{MONITOR}.{name}.{place}"), text)?;
        if let Some((switch, _)) = one.switch()
            && !source.switch_names().any(|known| known == switch)
        {
            let mistake = Mistake::NoSwitch(switch.to_owned());
            let error = SystemError::at(format!("{MONITOR}.{name}.0"), mistake);
            return Err(error.near(switch, source.switch_names()));
        }
        Ok(Monitor {
            name: name.clone(),
            source: one.clone(),
            expression,
        })
    });
    monitors.collect()
}

/// A system with these monitors alone, which were read before.
pub fn keeping(system: &System, written: &Ordered<MonitorSource>) -> System {
    let monitors = read(&system.source, written);
    system.clone().with_monitors(monitors.unwrap_or_default())
}

/// A system in which the expressions of its monitors are laid out, too. The flows of its modes have nothing to do with what
/// these expressions are made of.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitoredSystem {
    /// The system.
    pub system: AffineSystem,
    /// The forms of all monitors by mode: of those that contacts make, in the modes that were asked for.
    pub forms: BTreeMap<usize, Vec<Row>>,
}

/// The expressions of monitors as forms, whatever the mode.
///
/// # Errors
/// One that has no finite value, with its place.
pub(super) fn of_monitors(
    evaluation: &Evaluation<Dual>,
    monitors: &[Monitor],
) -> Result<Vec<Form>, SystemError> {
    let forms = monitors
        .iter()
        .map(|monitor| evaluation.form(&|| monitor.path(), &monitor.expression));
    forms.collect()
}

impl Monitor {
    /// That its expression has no value.
    pub(super) fn failed(&self, obstacle: Obstacle) -> SystemError {
        let flaw = ExpressionFlaw {
            wrong: obstacle.into(),
            span: self.expression.span.clone(),
        };
        SystemError::at(self.path(), Mistake::Expression(flaw))
    }
}

impl System {
    /// The same system with monitors.
    pub fn with_monitors(mut self, monitors: Vec<Monitor>) -> System {
        self.monitors = monitors;
        self
    }

    /// Its monitors.
    pub fn monitors(&self) -> &[Monitor] {
        &self.monitors
    }
}
