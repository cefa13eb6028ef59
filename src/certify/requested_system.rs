//! What a problem file says of a system and its numbers, and the values that it asks for.

use super::RefusedProof;
use super::orbit::decimals;
use super::requested::RequestedValues;
use crate::affine::system::{Source, System};
use crate::interval::Decimal;
use crate::orbit::EventType;
use crate::problem::SystemProblem;

/// What the branch of a system is about.
pub(super) struct RequestedSystem {
    source: Source,
    /// Values of the parameters in order, as they are written; `None` where they are those of an earlier run.
    values: Option<Vec<Decimal>>,
    /// Index of the continuation parameter.
    parameter: usize,
    /// Width of its range.
    unit: f64,
    asked: RequestedValues,
}

impl RequestedSystem {
    /// Of a problem with its text; `None` where no branch is followed. Where that begins with an earlier run, the values of the
    /// parameters do not stand there.
    pub(super) fn new(
        problem: &SystemProblem,
        text: &str,
        restarted: bool,
    ) -> Option<RequestedSystem> {
        let source = &problem.system.source;
        let section = problem.continuation.as_ref()?;
        let (low, high) = section.range;
        let given = source.parameters.0.iter();
        let values = decimals(given.map(|(name, value)| (&**name, *value)), text);
        let parameter = source
            .parameters
            .names()
            .position(|name| *name == section.parameter)?;
        let asked = RequestedValues::new(section, values.get(parameter).cloned(), text);
        Some(RequestedSystem {
            source: source.clone(),
            values: (!restarted).then_some(values),
            parameter,
            unit: high - low,
            asked: asked.restarted(restarted),
        })
    }

    /// Whether a value of the parameter is that at which the branch begins.
    pub(super) fn begins(&self, value: &Decimal) -> bool {
        let values = self.values.as_ref();
        values.and_then(|values| values.get(self.parameter)) == Some(value)
    }

    /// Whether the values of the parameters are those of an earlier run.
    pub(super) fn is_restarted(&self) -> bool {
        self.values.is_none()
    }

    /// Whether a forcing is part of it.
    pub(super) fn is_forced(&self) -> bool {
        self.source.forcing.is_some()
    }

    /// Whether a system, values of its parameters, the index of the one that varies and the unit of that are these.
    ///
    /// # Errors
    /// They are not.
    pub(super) fn check(
        &self,
        system: Option<&System>,
        values: &[Decimal],
        (parameter, unit): (usize, f64),
    ) -> Result<(), RefusedProof> {
        if !system.is_some_and(|system| system.source.is_same(&self.source)) {
            return Err(RefusedProof::Problem("the system"));
        }
        // that of the parameter that varies is in no equation, and is where the branch begins
        let equal = self.values.as_ref().is_none_or(|known| values == known);
        match equal && parameter == self.parameter && unit == self.unit {
            true => Ok(()),
            false => Err(RefusedProof::Problem("a number")),
        }
    }

    /// Whether the value at a point, where it is one of the parameter, is asked for.
    ///
    /// # Errors
    /// It is not.
    pub(super) fn check_value(
        &self,
        kind: EventType,
        value: Option<&Decimal>,
    ) -> Result<(), RefusedProof> {
        self.asked.check(kind, value)
    }
}
