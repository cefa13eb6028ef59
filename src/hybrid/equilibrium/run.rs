//! The pipeline from a problem to a branch of equilibria: first equilibrium, legs, points, labels and events.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::super::begin::plan;
use super::begin::{FirstEquilibrium, NamedEquilibrium, NoEquilibriumStart, begin};
use super::point::{EquilibriumEvent, EquilibriumNote, EquilibriumPoint, LabelledEquilibrium};
use super::row::EquilibriumEigenvalueRow;
use crate::affine::equilibrium::{EquilibriumCurve, EquilibriumScales};
use crate::orbit::follow::LocatedPoint;
use crate::orbit::legs::{self, Itemised, Legs, Run};
use crate::orbit::special::{ResumeMismatch, Special};
use crate::orbit::{EventType, Stability, Zones};
use crate::problem::{Continuation, SystemProblem};

/// A row of the branch, with what belongs to it.
#[derive(Clone, Debug)]
pub struct EquilibriumItem {
    /// The row.
    pub point: EquilibriumPoint,
    /// The event, at special points.
    pub event: Option<EquilibriumEvent>,
    /// What makes the point special, on the curve of its mode.
    pub special: Option<(Arc<EquilibriumCurve>, Special<EquilibriumCurve>)>,
    /// Eigenvalues at labelled points.
    pub eigenvalues: Vec<EquilibriumEigenvalueRow>,
    /// The equilibrium in physical numbers, at labelled points.
    pub saved: Option<LabelledEquilibrium>,
}

/// The state of a run of equilibria between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriumProgress {
    /// The legs.
    pub legs: legs::Progress<EquilibriumCurve>,
    /// Units of the unknowns.
    pub scales: EquilibriumScales,
    /// Rows of `eigenvalues.csv` handed out so far.
    pub eigenvalues: usize,
    /// Ways of the legs where they are not those of the problem: the other branch at an event has its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub directions: Vec<bool>,
}

/// A branch of equilibria being computed from a problem.
pub struct EquilibriumRunner {
    problem: SystemProblem,
    continuation: Continuation<String>,
    /// Values of the parameters at the first equilibrium.
    values: Vec<f64>,
    legs: Legs<EquilibriumCurve>,
    scales: EquilibriumScales,
    eigenvalues: usize,
    notes: Vec<EquilibriumNote>,
}

impl EquilibriumRunner {
    /// Finds the first equilibrium. `named` is the one that `start: Restart(…)` or `Switch(…)` names.
    ///
    /// # Errors
    /// There is no first equilibrium.
    pub fn begin(
        problem: &SystemProblem,
        continuation: &Continuation<String>,
        named: Option<&NamedEquilibrium>,
    ) -> Result<EquilibriumRunner, NoEquilibriumStart> {
        let FirstEquilibrium {
            curve,
            point,
            directions,
        } = begin(problem, continuation, named)?;
        let scales = curve.setting.scales.clone();
        let values = curve.values_at(&point);
        let plan = plan(problem, continuation).going(&directions);
        let legs = Legs::begin(curve, &point, plan).map_err(NoEquilibriumStart::NoLeg)?;
        Ok(EquilibriumRunner {
            problem: problem.clone(),
            continuation: continuation.clone(),
            values,
            legs,
            scales,
            eigenvalues: 0,
            notes: Vec::new(),
        })
    }

    /// Goes on from saved progress; `first` is the equilibrium of label 1.
    ///
    /// # Errors
    /// When the progress is not one that a run of this problem leaves.
    pub fn resume(
        problem: &SystemProblem,
        continuation: &Continuation<String>,
        first: &LabelledEquilibrium,
        progress: EquilibriumProgress,
    ) -> Result<EquilibriumRunner, ResumeMismatch<EquilibriumCurve>> {
        let scales = progress.scales.clone();
        let system = problem.system.clone().with_monitors(problem.monitors());
        let curve = EquilibriumCurve::posed_in(
            &system,
            &first.values,
            &continuation.parameter,
            (&first.mode, scales.clone()),
        );
        let curve = curve.ok_or(ResumeMismatch::Progress)?;
        let plan = plan(problem, continuation).going(&progress.directions);
        Ok(EquilibriumRunner {
            problem: problem.clone(),
            continuation: continuation.clone(),
            values: first.values.clone(),
            legs: Legs::resume(&curve, progress.legs, plan)?,
            scales,
            eigenvalues: progress.eigenvalues,
            notes: Vec::new(),
        })
    }

    /// All that is needed to go on from here.
    pub fn state(&self) -> EquilibriumProgress {
        let directions = &self.legs.plan().directions;
        let as_asked = *directions == self.continuation.toward.directions();
        EquilibriumProgress {
            legs: self.legs.progress().clone(),
            scales: self.scales.clone(),
            eigenvalues: self.eigenvalues,
            directions: if as_asked {
                Vec::new()
            } else {
                directions.clone()
            },
        }
    }

    /// What could not be settled so far.
    pub fn notes(&self) -> &[EquilibriumNote] {
        &self.notes
    }

    /// The row of an event.
    fn event(
        &self,
        point: &EquilibriumPoint,
        special: &Special<EquilibriumCurve>,
        found: &LocatedPoint<EquilibriumCurve>,
    ) -> EquilibriumEvent {
        let source = &self.problem.system.source;
        let named = |names: &mut dyn Iterator<Item = &str>, values: &[f64]| {
            names
                .map(str::to_owned)
                .zip(values.iter().copied())
                .collect()
        };
        let hopf = match special {
            Special::Own(bifurcation) => bifurcation.hopf(),
            _ => None,
        };
        let after = special.after().map(|after| after.name);
        EquilibriumEvent {
            label: point.label.unwrap_or_default(),
            kind: special.kind(),
            parameters: named(&mut source.parameters.names(), &point.parameters),
            state: named(&mut source.states.iter().map(String::as_str), &point.state),
            monitors: point.monitors.clone(),
            leading: point.leading(),
            omega: hopf.map(|(omega, _)| omega),
            lyapunov: hopf.and_then(|(_, lyapunov)| lyapunov),
            regimes_before: point.mode.clone(),
            regimes_after: after.unwrap_or_else(|| point.mode.clone()),
            uncertainty: found.known_to(),
            what: special.to_string(),
        }
    }
}

impl Run for EquilibriumRunner {
    type Orbit = EquilibriumCurve;
    type Item = EquilibriumItem;

    fn progress(&self) -> &legs::Progress<EquilibriumCurve> {
        self.legs.progress()
    }

    fn step(&mut self) -> Vec<EquilibriumItem> {
        legs::step(self)
    }

    fn position(&self) -> f64 {
        self.legs.position()
    }
}

impl Itemised for EquilibriumRunner {
    fn legs(&mut self) -> &mut Legs<EquilibriumCurve> {
        &mut self.legs
    }

    fn first_value(&self) -> Option<f64> {
        let parameters = &self.problem.system.source.parameters;
        let index = parameters.index(&self.continuation.parameter)?;
        self.values.get(index).copied()
    }

    fn item(&mut self, found: LocatedPoint<EquilibriumCurve>) -> EquilibriumItem {
        let parameter = &self.continuation.parameter;
        if let Some(what) = found.close.clone() {
            self.notes.push(EquilibriumNote::Close {
                parameter: parameter.clone(),
                value: found.parameter,
                what,
            });
        }
        let mut values = found.orbit.values_at(&found.node.point);
        if let Some(index) = self.problem.system.source.parameters.index(parameter) {
            values[index] = found.parameter;
        }
        let numbers = self.legs.number(&found);
        let point = EquilibriumPoint {
            point: numbers.point,
            label: numbers.label,
            leg: numbers.leg,
            ..point(&found, values)
        };
        let saved = point.label.map(|label| LabelledEquilibrium {
            label,
            mode: point.mode.clone(),
            state: point.state.clone(),
            values: point.parameters.clone(),
            along: (point.kind == Some(EventType::BP)).then(|| {
                let units = &found.orbit.setting.scales.units;
                let along = found.node.tangent.iter().zip(units);
                along.map(|(x, unit)| x * unit).collect()
            }),
        });
        let rows = point.label.map(|label| {
            let all = point.eigenvalues.iter().enumerate();
            all.map(|(index, one)| EquilibriumEigenvalueRow::new(label, index, one))
                .collect()
        });
        let eigenvalues: Vec<EquilibriumEigenvalueRow> = rows.unwrap_or_default();
        self.eigenvalues += eigenvalues.len();
        let special = found.special.as_ref();
        EquilibriumItem {
            event: special.map(|special| self.event(&point, special, &found)),
            special: special.map(|special| (found.orbit.clone(), special.clone())),
            point,
            eigenvalues,
            saved,
        }
    }
}

/// The row of a point, without its place on a branch.
fn point(found: &LocatedPoint<EquilibriumCurve>, parameters: Vec<f64>) -> EquilibriumPoint {
    let LocatedPoint {
        orbit,
        node,
        examination,
        ..
    } = found;
    let critical = matches!(
        found.kind(),
        Some(EventType::LP | EventType::HB | EventType::BP)
    );
    let growing = examination.growing();
    let mut stable = match growing {
        _ if critical || examination.is_undecided() => Stability::Undecided,
        0 => Stability::Yes,
        _ => Stability::No,
    };
    // where the mode changes and stability with it, neither side tells it
    if let Some((beyond, entered)) = &found.entered {
        let other = beyond.examination(&entered.point);
        let alike = other.is_ok_and(|other| (other.growing() == 0) == (growing == 0));
        stable = if alike { stable } else { Stability::Undecided };
    }
    EquilibriumPoint {
        point: 0,
        label: None,
        leg: 0,
        kind: found.kind(),
        mode: orbit.signature().name.clone(),
        parameters,
        state: orbit.state(&node.point),
        monitors: orbit.monitors(&node.point),
        stable,
        unstable: growing,
        eigenvalues: examination.eigenvalues.clone(),
        newton: node.newton,
        residual: node.residual,
    }
}
