//! A branch of orbits: where it begins, and what its rows tell.

use super::begin::{FirstOrbit, NamedOrbit, NoFirstPoint, begin};
use super::equilibrium::begin::NamedEquilibrium;
use super::equilibrium::birth::born;
use super::point::{OrbitEvent, OrbitPoint};
use super::row::MultiplierRow;
use super::runner::{SystemItem, SystemNote, SystemOrbit, SystemRunner};
use super::saved::LabelledOrbit;
use crate::affine::orbit::{
    AffineOrbit, Examination, Multiplier, OrbitInequality, Scales, SlidingBifurcation,
};
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::follow::LocatedPoint;
use crate::orbit::legs::{self, PointNumbers, RunState};
use crate::orbit::special::Special;
use crate::orbit::{EventType, Stability, Zones};
use crate::problem::{Continuation, SystemProblem};

/// How a run of orbits ended.
pub type End = legs::RunEnd<AffineOrbit>;
/// A row of a branch of orbits, with the orbit behind it.
pub type OrbitItem = SystemItem<AffineOrbit>;
/// The state of a run of orbits between two steps.
pub type OrbitProgress = RunState<AffineOrbit, Scales>;
/// A branch of orbits being computed from a problem.
pub type OrbitRunner = SystemRunner<AffineOrbit>;
/// What could not be settled in a run of orbits.
pub type Note = SystemNote<OrbitInequality>;

/// Arclength after which the zones beside an event are where they are from there on.
const A_LITTLE: f64 = 1e-6;

/// The point of an earlier run that a problem names.
#[derive(Clone, Debug)]
pub enum EarlierPoint {
    /// Of a branch of orbits.
    Orbit(NamedOrbit),
    /// Of a branch of equilibria: at a Hopf point cycles are born.
    Equilibrium(NamedEquilibrium),
}

impl EarlierPoint {
    /// Values of its parameters.
    pub fn values(&self) -> &[f64] {
        match self {
            EarlierPoint::Orbit(named) => &named.saved.orbit.values,
            EarlierPoint::Equilibrium(named) => &named.saved.values,
        }
    }
}

impl OrbitRunner {
    /// Finds the first orbit. `named` is the orbit that `start: Restart(…)` or `Switch(…)` names.
    ///
    /// # Errors
    /// There is no first orbit.
    pub fn begin(
        problem: &SystemProblem,
        continuation: &Continuation<String>,
        named: Option<&EarlierPoint>,
    ) -> Result<OrbitRunner, NoFirstPoint> {
        let FirstOrbit {
            orbit,
            point,
            directions,
        } = match named {
            Some(EarlierPoint::Equilibrium(named)) => born(problem, continuation, named)?,
            Some(EarlierPoint::Orbit(named)) => begin(problem, continuation, Some(named))?,
            None => begin(problem, continuation, None)?,
        };
        if let Some(stop) = orbit.negative_bound(&point) {
            return Err(NoFirstPoint::NegativeBound(stop));
        }
        let orbit = orbit.with_monitors(problem.monitors());
        let values = orbit.setting.values.clone();
        let first = (orbit, &point);
        SystemRunner::set_out((problem, continuation), first, values, &directions)
            .map_err(NoFirstPoint::NoLeg)
    }
}

impl SystemOrbit for AffineOrbit {
    type Scales = Scales;
    type Point = OrbitPoint;
    type Event = OrbitEvent;
    type SpectrumRow = MultiplierRow;
    type Saved = LabelledOrbit;

    fn scales(&self) -> Scales {
        self.setting.scales.clone()
    }

    fn parameters(&self, point: &Vector) -> Vec<f64> {
        self.values_at(point)
    }

    fn saved_parameters(saved: &LabelledOrbit) -> &[f64] {
        &saved.orbit.values
    }

    fn resumed(
        problem: &SystemProblem,
        parameter: &str,
        saved: &LabelledOrbit,
        scales: Scales,
    ) -> Option<AffineOrbit> {
        let index = problem.system.source.parameters.index(parameter)?;
        let orbit = saved.posed(problem, index, scales)?;
        Some(orbit.with_monitors(problem.monitors()))
    }

    fn point(
        problem: &SystemProblem,
        found: &LocatedPoint<AffineOrbit>,
        numbers: PointNumbers,
        values: Vec<f64>,
    ) -> OrbitPoint {
        let LocatedPoint {
            orbit,
            node,
            examination,
            ..
        } = found;
        let at = (&**orbit, &node.point);
        let there = point(
            at,
            examination,
            found.kind(),
            values,
            problem.stability.is_some(),
        );
        let there = match (&found.special, &found.entered) {
            (Some(Special::Change(_)), Some((orbit, node))) => jumping(there, orbit, &node.point),
            _ => there,
        };
        OrbitPoint {
            point: numbers.point,
            label: numbers.label,
            leg: numbers.leg,
            newton: node.newton,
            residual: node.residual,
            ..there
        }
    }

    fn event(
        problem: &SystemProblem,
        point: &OrbitPoint,
        special: &Special<AffineOrbit>,
        found: &LocatedPoint<AffineOrbit>,
    ) -> OrbitEvent {
        let names = problem.system.source.parameters.names();
        let parameters = names
            .map(str::to_owned)
            .zip(point.parameters.iter().copied());
        // a little way off: at the event itself a new zone may begin at the phase 0, or 2π
        let beside = |orbit: &AffineOrbit, node: &Node, way: f64| {
            let cycle = orbit.cycle(&(&node.point + &node.tangent * way));
            Some(cycle.ok()?.names.join("-"))
        };
        let before = match special {
            Special::Change(_) => beside(&found.orbit, &found.node, -A_LITTLE),
            _ => None,
        };
        let beyond = || match &found.entered {
            Some((orbit, node)) => beside(orbit, node, A_LITTLE),
            None => special.after().map(|after| after.to_string()),
        };
        let sliding = match special {
            Special::Change(change) => change.after.as_ref().and_then(|after| {
                let system = &problem.system;
                SlidingBifurcation::between(system, &change.before, after, &change.margin)
            }),
            _ => None,
        };
        OrbitEvent {
            label: point.label.unwrap_or_default(),
            kind: special.kind(),
            parameters: parameters.collect(),
            period: point.period,
            monitors: point.monitors.clone(),
            leading: point.leading(),
            regimes_before: before.unwrap_or_else(|| point.regimes.clone()),
            regimes_after: beyond().unwrap_or_else(|| point.regimes.clone()),
            uncertainty: found.known_to(),
            what: match sliding {
                Some(sliding) => format!("{sliding}: {special}"),
                None => special.to_string(),
            },
            sliding,
        }
    }

    fn spectrum(label: usize, point: &OrbitPoint) -> Vec<MultiplierRow> {
        let rows = point.multipliers.iter().enumerate();
        rows.map(|(index, one)| MultiplierRow::new(label, index, one))
            .collect()
    }

    fn saved(
        label: usize,
        point: &OrbitPoint,
        found: &LocatedPoint<AffineOrbit>,
    ) -> Option<LabelledOrbit> {
        let mut orbit = AffineOrbit::saved(&found.orbit, &found.node.point).ok()?;
        // the value that was asked for, not the scaled unknown's
        orbit.values.clone_from(&point.parameters);
        if point.kind == Some(EventType::BP) {
            orbit.beside = found.orbit.beside(&found.node).ok();
        }
        Some(LabelledOrbit { label, orbit })
    }
}

/// The row of a change of the sequence beyond which the orbit is this one: where multipliers jump so that stability does,
/// neither side tells it.
fn jumping(point: OrbitPoint, beyond: &AffineOrbit, unknowns: &Vector) -> OrbitPoint {
    let asked = point.stable.is_some();
    let examination = asked.then(|| beyond.examination(unknowns).ok()).flatten();
    let Some(examination) = examination else {
        return point;
    };
    let other = self::point((beyond, unknowns), &examination, None, Vec::new(), true);
    let told = other.stable == point.stable;
    OrbitPoint {
        stable: if told {
            point.stable
        } else {
            Some(Stability::Undecided)
        },
        ..point
    }
}

/// The row of a point, without its place on a branch. What cannot be evaluated there is left out.
pub(crate) fn point(
    (orbit, unknowns): (&AffineOrbit, &Vector),
    examination: &Examination,
    kind: Option<EventType>,
    parameters: Vec<f64>,
    asked: bool,
) -> OrbitPoint {
    let cycle = orbit.cycle(unknowns).ok();
    let multipliers = asked.then(|| {
        let all = &examination.multipliers;
        let known = all.iter().all(Multiplier::is_known);
        let all = all.iter().filter(|_| known);
        all.map(|one| one.at(kind)).collect::<Vec<_>>()
    });
    // at a graze there are none; where all are trivial nothing grows
    let known = multipliers.as_ref().filter(|all| !all.is_empty());
    let outside = known.map(|all| all.iter().filter(|one| one.is_outside()).count());
    let critical = matches!(
        kind,
        Some(EventType::LP | EventType::PD | EventType::NS | EventType::BP)
    );
    // beside a wave there are perturbations of other wavelengths than that of a prescribed period
    let tells = multipliers
        .as_ref()
        .filter(|_| orbit.setting.prescribed.is_none());
    let stable = tells.map(|all| match outside {
        None => Stability::Undecided,
        Some(_) if critical || all.iter().any(Multiplier::is_on_circle) => Stability::Undecided,
        Some(0) => Stability::Yes,
        Some(_) => Stability::No,
    });
    let (regimes, period, switches) = cycle.map_or_else(
        || (orbit.sequence.to_string(), f64::NAN, Vec::new()),
        |cycle| (cycle.names.join("-"), cycle.period, cycle.switches),
    );
    OrbitPoint {
        point: 0,
        label: None,
        leg: 0,
        kind,
        regimes,
        parameters,
        period,
        switches,
        extremes: examination.extremes.clone(),
        monitors: {
            let names = orbit.setting.system.monitors().iter();
            let names = names.map(|monitor| monitor.name.clone());
            names.zip(orbit.monitors(unknowns)).collect()
        },
        stable,
        unstable: tells.and(outside),
        multipliers: multipliers.unwrap_or_default(),
        newton: 0,
        residual: f64::NAN,
    }
}
