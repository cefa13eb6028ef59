//! What a problem file says of the statements on its branch: its model, and the values that it asks for.

use super::system::WaveCondition;
use super::{CertifiedPoint, Counted, PosedWave, RefusedProof, WaveProof, WrittenModel};
use crate::interval::Decimal;
use crate::orbit::EventType;
use crate::problem::{Continuation, Problem, StabilitySection, Start, decimal_at, decimal_of};

/// The values of the continuation parameter that a problem file asks for.
pub(super) struct RequestedValues {
    /// `stop_at`.
    stops: Vec<Decimal>,
    /// The range, and the value at which the branch begins; `None` where that is one of an earlier run.
    ends: Option<Vec<Decimal>>,
}

impl RequestedValues {
    /// Those of a `continuation` section, with the value at which the branch begins.
    pub(super) fn new<P>(
        section: &Continuation<P>,
        start: Option<Decimal>,
        text: &str,
    ) -> RequestedValues {
        let (low, high) = section.range;
        let value = |value: f64| decimal_of(text, "continuation", value);
        RequestedValues {
            stops: section.values().map(value).collect(),
            ends: Some([low, high].map(value).into_iter().chain(start).collect()),
        }
    }

    /// The same where the branch may begin with an earlier run.
    pub(super) fn restarted(self, restarted: bool) -> RequestedValues {
        RequestedValues {
            ends: self.ends.filter(|_| !restarted),
            ..self
        }
    }

    /// Whether the value at a point, where it is one of the parameter, is asked for: at an `EP` as an end.
    ///
    /// # Errors
    /// It is not.
    pub(super) fn check(
        &self,
        kind: EventType,
        value: Option<&Decimal>,
    ) -> Result<(), RefusedProof> {
        let values = match kind {
            EventType::EP => self.ends.as_ref(),
            _ => Some(&self.stops),
        };
        let mut both = value.zip(values).into_iter();
        match both.all(|(value, values)| values.contains(value)) {
            true => Ok(()),
            false => Err(RefusedProof::Problem("the value of the parameter")),
        }
    }
}

/// What the branch of a problem file is about.
pub(crate) struct RequestedWaves {
    posed: PosedWave,
    /// Whether the numbers of the model are those of an earlier run, and do not stand in the file.
    restarted: bool,
    /// Whether the branch begins at a value of the parameter that is computed, whatever the file says.
    computed: bool,
    values: RequestedValues,
    /// Largest |Im λ| of the eigenvalues that are counted; `None` where it follows from the model of an earlier run.
    window: Option<f64>,
}

impl RequestedWaves {
    /// Of a problem with its text; `None` where no branch is followed.
    pub(crate) fn new(problem: &Problem, text: &str) -> Option<RequestedWaves> {
        let start = &problem.wave.start;
        let restarted = matches!(start, Start::Restart { .. } | Start::Switch { .. });
        let computed = matches!(start, Start::Hopf);
        let (model, section) = (&problem.model, problem.continuation.as_ref()?);
        let (parameter, (low, high)) = (section.parameter, section.range);
        let material = model.has_material_damping(parameter);
        let start = model.value(parameter);
        let start = start.map(|start| decimal_of(text, parameter.path(), start));
        let values = RequestedValues::new(section, start, text);
        let window = match restarted {
            true => decimal_at(text, "stability.max_frequency").map(|decimal| decimal.nearest()),
            false => {
                let stability = problem.stability.clone();
                let stability = stability.unwrap_or_else(|| StabilitySection::of(model));
                Some(stability.max_frequency)
            }
        };
        Some(RequestedWaves {
            posed: PosedWave {
                written: WrittenModel::new(model, material, |path| decimal_at(text, path)),
                impact: model.impact,
                parameter,
                mode: problem.wave.mode,
                unit: high - low,
            },
            restarted,
            computed,
            values: values.restarted(restarted),
            window,
        })
    }

    /// Whether the branch begins with an earlier run.
    pub(crate) fn is_restarted(&self) -> bool {
        self.restarted
    }

    /// Whether a proven point is one of the branch.
    ///
    /// # Errors
    /// Its equations, the value of its parameter or the window of its eigenvalues are not those of the problem.
    pub(crate) fn check(
        &self,
        point: &CertifiedPoint,
        proof: &WaveProof,
    ) -> Result<(), RefusedProof> {
        let about = |posed: &PosedWave| (posed.impact, posed.parameter, posed.mode, posed.unit);
        let equal = match (self.restarted, self.computed) {
            (true, _) => about(&proof.posed) == about(&self.posed),
            (false, true) => proof.posed.fixed() == self.posed.fixed(),
            (false, false) => proof.posed == self.posed,
        };
        if !equal {
            return Err(RefusedProof::Problem("the model"));
        }
        if let (Some(Counted::Proven(growth)), Some(window)) = (&point.growth, self.window)
            && growth.window != window
        {
            return Err(RefusedProof::Problem("the window of its eigenvalues"));
        }
        let value = match &proof.condition {
            WaveCondition::Value(value) => Some(value),
            _ => None,
        };
        self.values.check(point.kind, value)
    }
}
