//! What a problem file says of the statements on its branch: its model, and the values that it asks for.

use super::system::Condition;
use super::{Point, Posed, Proof, Refused, Written};
use crate::interval::Decimal;
use crate::orbit::EventType;
use crate::problem::{Continuation, Problem, Start, decimal_at, decimal_of};

/// What the branch of a problem file is about.
pub(crate) struct Requested {
    posed: Posed,
    /// `stop_at`.
    values: Vec<Decimal>,
    /// The range, and the value of the model.
    ends: Vec<Decimal>,
}

impl Requested {
    /// Of a problem with its text; `None` where the model is that of an earlier run.
    pub(crate) fn new(problem: &Problem, text: &str) -> Option<Requested> {
        if let Start::Restart { .. } | Start::Switch { .. } = problem.wave.start {
            return None;
        }
        let (model, continuation) = (&problem.model, problem.continuation.as_ref()?);
        let Continuation {
            parameter,
            range: (low, high),
            ..
        } = *continuation;
        let material = model.has_material_damping(parameter);
        let value = |value: f64| decimal_of(text, "continuation", value);
        let start = model.value(parameter);
        let start = start.map(|start| decimal_of(text, parameter.path(), start));
        Some(Requested {
            posed: Posed {
                written: Written::new(model, material, |path| decimal_at(text, path)),
                impact: model.impact,
                parameter,
                mode: problem.wave.mode,
                unit: high - low,
            },
            values: continuation.stop_at.iter().copied().map(value).collect(),
            ends: [low, high].map(value).into_iter().chain(start).collect(),
        })
    }

    /// Whether a proven point is one of the branch.
    ///
    /// # Errors
    /// Its equations, or the value of its parameter, are not those of the problem.
    pub(crate) fn check(&self, point: &Point, proof: &Proof) -> Result<(), Refused> {
        if proof.posed.fixed() != self.posed.fixed() {
            return Err(Refused::Problem("the model"));
        }
        let asked = match &proof.condition {
            Condition::Value(value) if point.kind == EventType::EP => self.ends.contains(value),
            Condition::Value(value) => self.values.contains(value),
            _ => true,
        };
        match asked {
            true => Ok(()),
            false => Err(Refused::Problem("the value of the parameter")),
        }
    }
}
