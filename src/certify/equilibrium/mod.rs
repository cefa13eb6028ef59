//! Special points of a branch of equilibria of a user's system, proven.
//!
//! 1. The numbers of the system are the decimals that were written; expressions are evaluated in intervals with derivatives to
//!    any order ([`place`]).
//! 2. The equations of the equilibrium ([`field`]) and the condition of the event ([`system`]) have exactly one zero in a box,
//!    and it is regular.
//! 3. Every guard of the mode ([`guard`]) is positive there but the one that vanishes at the event, and what is held is held by its force
//!    ([`inequalities`]).
//! 4. Parameter, states, ω and l₁ ([`lyapunov`]) follow from the enclosure of that zero, and how many eigenvalues grow there
//!    ([`spectrum`]).
//! 5. At a boundary equilibrium of two modes the signs of slopes tell on which sides of it either is admissible ([`beyond`]).

mod beyond;
mod dependence;
mod field;
mod guard;
mod inequalities;
mod lyapunov;
mod open;
mod place;
// certificates are compared with their problem file by the command line
#[cfg(feature = "cli")]
mod requested;
mod resting;
mod spectrum;
mod system;

use crate::orbit::{EventType, Zones};
use serde::{Deserialize, Serialize};

pub use beyond::ModeBeyond;
pub use lyapunov::ProvenLyapunov;
pub use open::OpenEquilibrium;
#[cfg(feature = "cli")]
pub(crate) use requested::RequestedEquilibria;
pub use system::{EquilibriumCondition, NearEquilibrium, PosedEquilibrium};

use super::arc::Broken;
use super::certificate::{CertifiedPoint, GrowthTally, Provable, RefusedProof};
use super::orbit::decimals;
use super::{krawczyk, wider};
use crate::affine::equilibrium::{EquilibriumBifurcation, EquilibriumCurve, EquilibriumMargin};
use crate::affine::system::System;
use crate::hybrid::equilibrium::EquilibriumItem;
use crate::interval::Interval;
use crate::orbit::special::Special;
use crate::problem::decimal_of;
use guard::ProvenGuard;
use resting::Resting;
use system::EquilibriumSystem;

/// Stated intervals are wider than proven by this share of their unit, 2⁻⁶⁰, which is less than a rounding of it.
const ROOM: f64 = 8.673_617_379_884_035e-19;

/// A matrix of intervals.
type Rows = Vec<Vec<Interval>>;

/// What is proven of a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EquilibriumStatement {
    /// The continuation parameter lies in here.
    pub parameter: Interval,
    /// The states.
    pub states: Vec<Interval>,
    /// No other equilibrium that satisfies the equations of the point has its parameter within this distance and all its other unknowns
    /// within the same share of their units.
    pub unique: f64,
    /// Inequalities proven.
    pub inequalities: usize,
    /// Imaginary part of the pair at a Hopf point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub omega: Option<Interval>,
    /// The first Lyapunov coefficient there, where it is enclosed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lyapunov: Option<ProvenLyapunov>,
    /// Eigenvalues with a positive real part, where no other than the critical ones has the real part zero and that is proven.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growing: Option<usize>,
}

/// A statement, and what it takes to check it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EquilibriumProof {
    /// The system and its equations.
    pub posed: PosedEquilibrium,
    /// What singles out the point.
    pub condition: EquilibriumCondition,
    /// The equilibrium in doubles.
    pub near: NearEquilibrium,
    /// The mode beyond a boundary equilibrium, where that is proven.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond: Option<ModeBeyond>,
    /// What is proven.
    pub statement: EquilibriumStatement,
}

impl Provable for EquilibriumProof {
    type Parameter = String;
    type Unproven = OpenEquilibrium;
    type Beyond = OpenEquilibrium;

    fn arc(
        _: &EquilibriumProof,
        _: &EquilibriumProof,
    ) -> Result<(), Broken<OpenEquilibrium, OpenEquilibrium>> {
        Err(Broken::Beyond(OpenEquilibrium::Arcs))
    }

    fn is_event_of(&self, other: &EquilibriumProof) -> bool {
        let meet = |a: Interval, b: Interval| !a.intersection(b).is_empty();
        let (first, second) = (&self.statement, &other.statement);
        let is_value =
            |proof: &EquilibriumProof| matches!(proof.condition, EquilibriumCondition::Value(_));
        let mut states = first.states.iter().zip(&second.states);
        let frequencies = first.omega.zip(second.omega);
        !is_value(self)
            && !is_value(other)
            && meet(first.parameter, second.parameter)
            && states.all(|(a, b)| meet(*a, *b))
            && frequencies.is_none_or(|(a, b)| meet(a, b))
    }

    fn tally(_: &CertifiedPoint<EquilibriumProof>) -> GrowthTally {
        GrowthTally::Unknown
    }

    fn take_system(&mut self) -> Option<System> {
        self.posed.system.take()
    }

    fn give_system(&mut self, system: &System) {
        self.posed.system.get_or_insert_with(|| system.clone());
    }
}

impl EquilibriumProof {
    /// In words, the guard that vanishes at a boundary equilibrium.
    pub fn vanishing(&self, system: &System) -> Option<String> {
        let EquilibriumCondition::Boundary { guard } = self.condition else {
            return None;
        };
        let resting = Resting::new(system, &self.near.mode).ok()?;
        let guards = guard::guards(system, &resting);
        Some(guards.get(guard)?.name(system, &resting))
    }
}

/// Proves a special point of a branch; `None` for points without an event, and for failures. `text` is that of the
/// problem file, whose decimals are taken as they are written.
pub fn certify(item: &EquilibriumItem, text: &str) -> Option<CertifiedPoint<EquilibriumProof>> {
    let (event, special) = (item.event.as_ref()?, item.special.as_ref()?);
    let (curve, _) = item.orbit();
    if event.kind == EventType::MX {
        return None;
    }
    Some(CertifiedPoint {
        label: event.label,
        kind: event.kind,
        parameter: curve.parameter(),
        leg: item.point.leg,
        arc: None,
        growth: None,
        outcome: prepared(item, (curve, special), text).into(),
    })
}

fn prepared(
    item: &EquilibriumItem,
    (curve, special): (&EquilibriumCurve, &Special<EquilibriumCurve>),
    text: &str,
) -> Result<EquilibriumProof, OpenEquilibrium> {
    let setting = &curve.setting;
    let at = setting.parameter;
    let system = setting.system.clone().with_monitors(Vec::new());
    let names = system.source.parameters.names();
    let values = decimals(names.zip(setting.values.iter().copied()), text);
    let value = item.point.parameters.get(at).copied().unwrap_or(f64::NAN);
    let near = NearEquilibrium {
        mode: item.point.mode.clone(),
        state: item.point.state.clone(),
        parameter: value,
    };
    let mut units = setting.scales.units.clone();
    let forces = field::units_of_forces(&system, (&values, at), &setting.scales);
    units.splice(near.state.len()..near.state.len(), forces);
    let posed = PosedEquilibrium {
        system: Some(system),
        values,
        parameter: at,
        units,
    };
    let condition = singled_out(&posed, &near, (curve, special), text)?;
    let after = special.after().map(|after| after.name);
    prove(posed, near, condition, after.as_deref())
}

/// What singles out a special point.
fn singled_out(
    posed: &PosedEquilibrium,
    near: &NearEquilibrium,
    (curve, special): (&EquilibriumCurve, &Special<EquilibriumCurve>),
    text: &str,
) -> Result<EquilibriumCondition, OpenEquilibrium> {
    let setting = &curve.setting;
    Ok(match special {
        Special::User(..) | Special::Edge(..) => {
            EquilibriumCondition::Value(decimal_of(text, "continuation", near.parameter))
        }
        Special::Monitor(..) => return Err(OpenEquilibrium::Monitor),
        Special::Start | Special::Closed => {
            let path = format!("system.parameters.{}", curve.parameter());
            // scaled unknowns know it to rounding
            EquilibriumCondition::Value(decimal_of(text, &path, setting.values[setting.parameter]))
        }
        Special::Fold(_) => EquilibriumCondition::Fold,
        Special::Own(EquilibriumBifurcation::Hopf { omega, .. }) => {
            EquilibriumCondition::Hopf { omega: *omega }
        }
        Special::Own(EquilibriumBifurcation::Branching) => return Err(OpenEquilibrium::Branching),
        Special::Own(
            EquilibriumBifurcation::Several { .. } | EquilibriumBifurcation::Unlocated { .. },
        ) => return Err(OpenEquilibrium::Several),
        Special::Change(change) => {
            let guard = vanishing(posed, near, (curve, &change.margin))?;
            EquilibriumCondition::Boundary { guard }
        }
        Special::Failed(_) => return Err(OpenEquilibrium::System),
    })
}

/// The guard whose zero a change of mode is.
fn vanishing(
    posed: &PosedEquilibrium,
    near: &NearEquilibrium,
    (curve, margin): (&EquilibriumCurve, &EquilibriumMargin),
) -> Result<usize, OpenEquilibrium> {
    let system = posed.system()?;
    let resting = Resting::new(system, &near.mode)?;
    if let Resting::Contacts(_) = resting {
        return inequalities::nearest_to_zero(posed, near).ok_or(OpenEquilibrium::System);
    }
    let is_vanishing = |guard: &ProvenGuard| match (curve.written_guard(margin), guard) {
        (None, ProvenGuard::FirstPush) => margin.guard == 0,
        (None, ProvenGuard::SecondPush) => margin.guard == 1,
        (Some(at), ProvenGuard::Zero(own)) => guard::are_one(system, at, *own),
        _ => false,
    };
    let guards = guard::guards(system, &resting);
    let vanishing = guards.iter().position(is_vanishing);
    vanishing.ok_or(OpenEquilibrium::System)
}

/// Proves the point next to an equilibrium in doubles; the mode beyond it, of which the name is given, is left out where nothing is
/// proven of it.
///
/// # Errors
/// It is not covered, or not proven.
pub fn prove(
    posed: PosedEquilibrium,
    near: NearEquilibrium,
    condition: EquilibriumCondition,
    after: Option<&str>,
) -> Result<EquilibriumProof, OpenEquilibrium> {
    let (system, guess) = EquilibriumSystem::new(&posed, &near, &condition)?;
    let equations = |x: &[Interval]| system.evaluate(x);
    let found = krawczyk::refined(&equations, &guess).ok_or(OpenEquilibrium::NotEnclosed)?;
    let (near, condition) = system.refined(&found);
    // from what is stored, as a check does it
    let statement = statement(&posed, &near, &condition, None)?;
    let beyond = after.and_then(|mode| beyond::found(&posed, &near, &condition, mode));
    Ok(EquilibriumProof {
        posed,
        condition,
        near,
        beyond,
        statement,
    })
}

/// The equations of the point next to an equilibrium in doubles, their unknowns in doubles, and their zero.
fn enclosed<'a>(
    posed: &'a PosedEquilibrium,
    near: &'a NearEquilibrium,
    condition: &'a EquilibriumCondition,
) -> Result<(EquilibriumSystem<'a>, Vec<f64>, krawczyk::ProvenZero), OpenEquilibrium> {
    /// The equilibrium in doubles is known to this share of its units, or it is not that of the point.
    const KNOWN: f64 = 1e-7;
    let (system, middle) = EquilibriumSystem::new(posed, near, condition)?;
    let units = system.units(&middle);
    let equations = |x: &[Interval]| system.evaluate(x);
    let zero =
        krawczyk::known(&equations, &middle, &units, KNOWN).ok_or(OpenEquilibrium::NotIsolated)?;
    Ok((system, middle, zero))
}

/// What is proven of the point next to an equilibrium. The distance of uniqueness is looked for, or that of a stored statement, which is
/// 0 where it does not hold.
fn statement(
    posed: &PosedEquilibrium,
    near: &NearEquilibrium,
    condition: &EquilibriumCondition,
    stored: Option<f64>,
) -> Result<EquilibriumStatement, OpenEquilibrium> {
    let (system, middle, zero) = enclosed(posed, near, condition)?;
    let units = system.units(&middle);
    let equations = |x: &[Interval]| system.evaluate(x);
    let parameter = system.parameter();
    let omega = match condition {
        EquilibriumCondition::Hopf { .. } => zero.at.last().copied(),
        _ => None,
    };
    // two real eigenvalues with the sum zero have no ω, and at ω = 0 any multiple of one vector is a pair
    if omega.is_some_and(|omega| !omega.is_positive()) {
        return Err(OpenEquilibrium::Frequency);
    }
    let inequalities = system.inequalities(&zero.at)?;
    let lyapunov = omega.and_then(|_| system.lyapunov(&zero.at));
    // balls of another program have a width even where a number is zero
    let told = |index: usize| {
        let room = units[index] * ROOM;
        wider(zero.at[index]) + Interval::new(-room, room)
    };
    Ok(EquilibriumStatement {
        parameter: match condition {
            EquilibriumCondition::Value(value) => value.interval(),
            _ => told(parameter),
        },
        states: (0..system.states()).map(told).collect(),
        unique: zero.distance(&equations, &middle, &units, parameter, stored),
        inequalities,
        omega: omega.map(wider),
        lyapunov: lyapunov.map(|lyapunov| match lyapunov {
            ProvenLyapunov::Within(interval) => ProvenLyapunov::Within(wider(interval)),
            ProvenLyapunov::Vertical => ProvenLyapunov::Vertical,
        }),
        growing: system.growing(&zero.at),
    })
}

/// The type of a point by what singles it out; of a value the certificate does not say who asked for it.
fn kind(condition: &EquilibriumCondition, said: EventType) -> EventType {
    match condition {
        EquilibriumCondition::Value(_) if said == EventType::EP => EventType::EP,
        EquilibriumCondition::Value(_) => EventType::UZ,
        EquilibriumCondition::Fold => EventType::LP,
        EquilibriumCondition::Hopf { .. } => EventType::HB,
        EquilibriumCondition::Boundary { .. } => EventType::BE,
    }
}

/// Proves a stored statement again, without continuation.
///
/// # Errors
/// The proof fails, or it proves something else.
pub fn verify(
    point: &CertifiedPoint<EquilibriumProof>,
    proof: &EquilibriumProof,
) -> Result<(), RefusedProof> {
    proven_again(point, proof).map(|_| ())
}

/// Proves a stored statement again; returns the proof with intervals of it that are no wider than they are proven.
///
/// # Errors
/// The proof fails, or it proves something else.
pub(crate) fn proven_again(
    point: &CertifiedPoint<EquilibriumProof>,
    proof: &EquilibriumProof,
) -> Result<EquilibriumProof, RefusedProof> {
    let EquilibriumProof {
        posed,
        condition,
        near,
        beyond,
        statement: said,
    } = proof;
    if point.growth.is_some() {
        return Err(RefusedProof::Statement("what grows"));
    }
    if posed.name() != Some(&point.parameter) {
        return Err(RefusedProof::Statement("the parameter"));
    }
    let (said_kind, found) = (point.kind, kind(condition, point.kind));
    if found != said_kind {
        return Err(RefusedProof::Kind {
            said: said_kind,
            found,
        });
    }
    let open = |open: OpenEquilibrium| RefusedProof::NoProof(open.to_string());
    let proven = statement(posed, near, condition, Some(said.unique)).map_err(open)?;
    super::compared("the parameter", said.parameter, proven.parameter)?;
    if said.states.len() != proven.states.len() {
        return Err(RefusedProof::Statement("the number of states"));
    }
    for (said, proven) in said.states.iter().zip(&proven.states) {
        super::compared("a state", *said, *proven)?;
    }
    match (said.omega, proven.omega) {
        (Some(said), Some(proven)) => super::compared("ω", said, proven)?,
        (None, None) => {}
        _ => return Err(RefusedProof::Statement("ω")),
    }
    compare_lyapunov(said.lyapunov, proven.lyapunov)?;
    super::compared_unique(said.unique, proven.unique)?;
    if said.inequalities != proven.inequalities {
        return Err(RefusedProof::Statement("the number of inequalities"));
    }
    if said.growing.is_some() && said.growing != proven.growing {
        return Err(RefusedProof::Statement("the number of growing eigenvalues"));
    }
    if let Some(said) = beyond {
        let (system, _, zero) = enclosed(posed, near, condition).map_err(open)?;
        let found = beyond::persists(&system, &zero.at, (&said.mode, said.guard)).map_err(open)?;
        if found != said.persists {
            return Err(RefusedProof::Statement("on which sides equilibria lie"));
        }
    }
    let mut again = proof.clone();
    let statement = &mut again.statement;
    statement.parameter = super::narrowed(said.parameter, proven.parameter);
    let frequencies = said.omega.zip(proven.omega);
    statement.omega = frequencies.map(|(said, proven)| super::narrowed(said, proven));
    if let (Some(ProvenLyapunov::Within(said)), Some(ProvenLyapunov::Within(proven))) =
        (said.lyapunov, proven.lyapunov)
    {
        statement.lyapunov = Some(ProvenLyapunov::Within(super::narrowed(said, proven)));
    }
    Ok(again)
}

/// Whether the first Lyapunov coefficient that is proven is the one that is stated, if one is.
fn compare_lyapunov(
    said: Option<ProvenLyapunov>,
    proven: Option<ProvenLyapunov>,
) -> Result<(), RefusedProof> {
    match (said, proven) {
        (Some(ProvenLyapunov::Within(said)), Some(ProvenLyapunov::Within(proven))) => {
            super::compared("the first Lyapunov coefficient", said, proven)
        }
        (None, _) => Ok(()),
        (said, proven) if said == proven => Ok(()),
        _ => Err(RefusedProof::Statement("the first Lyapunov coefficient")),
    }
}
