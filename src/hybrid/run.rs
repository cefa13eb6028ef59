//! The pipeline from a problem to a branch of orbits: first orbit, legs, points, labels and events.

use serde::{Deserialize, Serialize};

use super::begin::{FirstOrbit, NamedOrbit, NoFirstPoint, begin, plan};
use super::equilibrium::begin::NamedEquilibrium;
use super::equilibrium::birth::born;
use super::point::{Note, OrbitEvent, OrbitPoint};
use super::row::MultiplierRow;
use super::saved::LabelledOrbit;
use crate::affine::orbit::{AffineOrbit, Examination, Multiplier, Scales, SlidingBifurcation};
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::follow::LocatedPoint;
use crate::orbit::legs::{self, Itemised, Legs, Run};
use crate::orbit::special::{ResumeMismatch, Special};
use crate::orbit::{EventType, Stability, Zones};
use crate::problem::Continuation;
use crate::problem::SystemProblem;

/// How a run of orbits ended.
pub type End = legs::RunEnd<AffineOrbit>;

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

/// A row of the branch, with the orbit behind it.
#[derive(Clone, Debug)]
pub struct OrbitItem {
    /// The row.
    pub point: OrbitPoint,
    /// The event, at special points.
    pub event: Option<OrbitEvent>,
    /// What makes the point special.
    pub special: Option<Special<AffineOrbit>>,
    /// Multipliers at labelled points.
    pub multipliers: Vec<MultiplierRow>,
    /// The orbit in physical numbers, at labelled points.
    pub saved: Option<LabelledOrbit>,
    found: LocatedPoint<AffineOrbit>,
}

impl OrbitItem {
    /// The orbit as a boundary-value problem, and its scaled unknowns.
    pub fn orbit(&self) -> (&AffineOrbit, &Vector) {
        (&self.found.orbit, &self.found.node.point)
    }
}

/// The state of a run of orbits between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitProgress {
    /// The legs.
    pub legs: legs::Progress<AffineOrbit>,
    /// Units of the unknowns.
    pub scales: Scales,
    /// Rows of `multipliers.csv` handed out so far.
    pub multipliers: usize,
    /// Ways of the legs where they are not those of the problem: the other branch at an event has its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub directions: Vec<bool>,
}

/// A branch of orbits being computed from a problem.
pub struct OrbitRunner {
    problem: SystemProblem,
    continuation: Continuation<String>,
    /// Values of the parameters at the first orbit.
    values: Vec<f64>,
    legs: Legs<AffineOrbit>,
    scales: Scales,
    multipliers: usize,
    notes: Vec<Note>,
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
        let scales = orbit.setting.scales.clone();
        let values = orbit.setting.values.clone();
        let plan = plan(problem, continuation).going(&directions);
        let legs = Legs::begin(orbit, &point, plan).map_err(NoFirstPoint::NoLeg)?;
        Ok(OrbitRunner {
            problem: problem.clone(),
            continuation: continuation.clone(),
            values,
            legs,
            scales,
            multipliers: 0,
            notes: Vec::new(),
        })
    }

    /// Goes on from saved progress; `first` is the orbit of label 1.
    ///
    /// # Errors
    /// When the progress is not one that a run of this problem leaves.
    pub fn resume(
        problem: &SystemProblem,
        continuation: &Continuation<String>,
        first: &LabelledOrbit,
        progress: OrbitProgress,
    ) -> Result<OrbitRunner, ResumeMismatch<AffineOrbit>> {
        let names = &problem.system.source.parameters;
        let parameter = names.index(&continuation.parameter);
        let scales = progress.scales.clone();
        let posed = parameter.and_then(|index| first.posed(problem, index, scales));
        let orbit = posed.ok_or(ResumeMismatch::Progress)?;
        let orbit = orbit.with_monitors(problem.monitors());
        let plan = plan(problem, continuation).going(&progress.directions);
        Ok(OrbitRunner {
            problem: problem.clone(),
            continuation: continuation.clone(),
            values: orbit.setting.values.clone(),
            legs: Legs::resume(&orbit, progress.legs, plan)?,
            scales: progress.scales,
            multipliers: progress.multipliers,
            notes: Vec::new(),
        })
    }

    /// All that is needed to go on from here.
    pub fn state(&self) -> OrbitProgress {
        OrbitProgress {
            legs: self.legs.progress().clone(),
            scales: self.scales.clone(),
            multipliers: self.multipliers,
            directions: if self.legs.plan().directions == self.continuation.toward.directions() {
                Vec::new()
            } else {
                self.legs.plan().directions.clone()
            },
        }
    }

    /// What could not be settled so far.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// The row of an event.
    fn event(
        &self,
        point: &OrbitPoint,
        special: &Special<AffineOrbit>,
        found: &LocatedPoint<AffineOrbit>,
    ) -> OrbitEvent {
        let names = self.problem.system.source.parameters.names();
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
                let system = &self.problem.system;
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
}

impl Run for OrbitRunner {
    type Orbit = AffineOrbit;
    type Item = OrbitItem;

    fn progress(&self) -> &legs::Progress<AffineOrbit> {
        self.legs.progress()
    }

    fn step(&mut self) -> Vec<OrbitItem> {
        legs::step(self)
    }

    fn position(&self) -> f64 {
        self.legs.position()
    }
}

impl Itemised for OrbitRunner {
    fn legs(&mut self) -> &mut Legs<AffineOrbit> {
        &mut self.legs
    }

    fn first_value(&self) -> Option<f64> {
        let parameters = &self.problem.system.source.parameters;
        let index = parameters.index(&self.continuation.parameter)?;
        self.values.get(index).copied()
    }

    fn item(&mut self, found: LocatedPoint<AffineOrbit>) -> OrbitItem {
        let parameter = &self.continuation.parameter;
        if let Some(what) = found.close.clone() {
            self.notes.push(Note::Close {
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
        let asked = self.problem.stability.is_some();
        let LocatedPoint {
            orbit,
            node,
            examination,
            ..
        } = &found;
        let there = point(
            (orbit, &node.point),
            examination,
            found.kind(),
            values,
            asked,
        );
        let there = match (&found.special, &found.entered) {
            (Some(Special::Change(_)), Some((orbit, node))) => jumping(there, orbit, &node.point),
            _ => there,
        };
        let point = OrbitPoint {
            point: numbers.point,
            label: numbers.label,
            leg: numbers.leg,
            newton: node.newton,
            residual: node.residual,
            ..there
        };
        let saved = point.label.and_then(|label| {
            let mut orbit = found.orbit.saved(&found.node.point).ok()?;
            // the value that was asked for, not the scaled unknown's
            orbit.values.clone_from(&point.parameters);
            Some(LabelledOrbit { label, orbit })
        });
        let multipliers = point.label.map(|label| {
            let rows = point.multipliers.iter().enumerate();
            rows.map(|(index, one)| MultiplierRow::new(label, index, one))
                .collect()
        });
        let multipliers: Vec<MultiplierRow> = multipliers.unwrap_or_default();
        self.multipliers += multipliers.len();
        let special = found.special.clone();
        OrbitItem {
            event: special
                .as_ref()
                .map(|special| self.event(&point, special, &found)),
            point,
            special,
            multipliers,
            saved,
            found,
        }
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
