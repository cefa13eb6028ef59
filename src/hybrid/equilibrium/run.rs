//! A branch of equilibria: where it begins, and what its rows tell.

use super::super::runner::{SystemItem, SystemNote, SystemOrbit, SystemRunner};
use super::begin::{FirstEquilibrium, NamedEquilibrium, NoEquilibriumStart, begin};
use super::point::{EquilibriumEvent, EquilibriumPoint, LabelledEquilibrium};
use super::row::EquilibriumEigenvalueRow;
use crate::affine::equilibrium::{EquilibriumCurve, EquilibriumGuard, EquilibriumScales};
use crate::linalg::Vector;
use crate::orbit::follow::LocatedPoint;
use crate::orbit::legs::{PointNumbers, RunState};
use crate::orbit::special::Special;
use crate::orbit::{EventType, Stability, Zones};
use crate::problem::{Continuation, SystemProblem};

/// A row of a branch of equilibria, with the equilibrium behind it.
pub type EquilibriumItem = SystemItem<EquilibriumCurve>;
/// The state of a run of equilibria between two steps.
pub type EquilibriumProgress = RunState<EquilibriumCurve, EquilibriumScales>;
/// A branch of equilibria being computed from a problem.
pub type EquilibriumRunner = SystemRunner<EquilibriumCurve>;
/// What could not be settled in a run of equilibria.
pub type EquilibriumNote = SystemNote<EquilibriumGuard>;

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
        let curve = curve.on_side_of(&point);
        let values = curve.values_at(&point);
        SystemRunner::set_out(
            (problem, continuation),
            (curve, &point),
            values,
            &directions,
        )
        .map_err(NoEquilibriumStart::NoLeg)
    }
}

impl SystemOrbit for EquilibriumCurve {
    type Scales = EquilibriumScales;
    type Point = EquilibriumPoint;
    type Event = EquilibriumEvent;
    type SpectrumRow = EquilibriumEigenvalueRow;
    type Saved = LabelledEquilibrium;

    fn scales(&self) -> EquilibriumScales {
        self.setting.scales.clone()
    }

    fn parameters(&self, point: &Vector) -> Vec<f64> {
        self.values_at(point)
    }

    fn saved_parameters(saved: &LabelledEquilibrium) -> &[f64] {
        &saved.values
    }

    fn resumed(
        problem: &SystemProblem,
        parameter: &str,
        saved: &LabelledEquilibrium,
        scales: EquilibriumScales,
    ) -> Option<EquilibriumCurve> {
        let system = problem.system.clone().with_monitors(problem.monitors());
        let curve =
            EquilibriumCurve::posed_in(&system, &saved.values, parameter, (&saved.mode, scales))?;
        let index = problem.system.source.parameters.index(parameter)?;
        let value = *saved.values.get(index)?;
        let point = curve.pack(&saved.state, value);
        Some(curve.on_side_of(&point))
    }

    fn point(
        _: &SystemProblem,
        found: &LocatedPoint<EquilibriumCurve>,
        numbers: PointNumbers,
        values: Vec<f64>,
    ) -> EquilibriumPoint {
        EquilibriumPoint {
            point: numbers.point,
            label: numbers.label,
            leg: numbers.leg,
            ..point(found, values)
        }
    }

    fn event(
        problem: &SystemProblem,
        point: &EquilibriumPoint,
        special: &Special<EquilibriumCurve>,
        found: &LocatedPoint<EquilibriumCurve>,
    ) -> EquilibriumEvent {
        let source = &problem.system.source;
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

    fn spectrum(label: usize, point: &EquilibriumPoint) -> Vec<EquilibriumEigenvalueRow> {
        let rows = point.eigenvalues.iter().enumerate();
        rows.map(|(index, one)| EquilibriumEigenvalueRow::new(label, index, one))
            .collect()
    }

    fn saved(
        label: usize,
        point: &EquilibriumPoint,
        found: &LocatedPoint<EquilibriumCurve>,
    ) -> Option<LabelledEquilibrium> {
        Some(LabelledEquilibrium {
            label,
            mode: point.mode.clone(),
            state: point.state.clone(),
            values: point.parameters.clone(),
            along: (point.kind == Some(EventType::BP)).then(|| {
                let units = &found.orbit.setting.scales.units;
                let along = found.node.tangent.iter().zip(units);
                along.map(|(x, unit)| x * unit).collect()
            }),
        })
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
