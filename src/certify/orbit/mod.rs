//! Special points of a branch of orbits of a user's system, proven.
//!
//! 1. The numbers of the system are the decimals that were written ([`enclosure`]); what is zero at entries and ends
//!    whatever they are follows from formulas ([`exact`], [`zeros`]), or from symmetry ([`symmetry`]).
//! 2. The equations of the orbit and the condition of the event, in intervals with the exact flow and its remainder
//!    ([`flow`], [`system`], [`equations`], [`extended`]), have exactly one zero in a box, and it is regular.
//! 3. Every inequality of the sequence holds over whole zones ([`inequality`]).
//! 4. Parameter and period follow from the enclosure of that zero, and at values of the parameter how many
//!    multipliers are outside the unit circle ([`multipliers`]).

mod arc;
mod beyond;
mod critical;
mod enclosure;
mod equations;
pub(super) mod exact;
mod extended;
mod facts;
pub(super) mod flow;
mod fraction;
mod inequality;
mod modes;
pub(super) mod multipliers;
mod open;
mod products;
mod ranged;
// certificates are compared with their problem file by the command line
#[cfg(feature = "cli")]
mod requested;
mod symmetry;
mod system;
mod zeros;

use serde::{Deserialize, Serialize};

pub use beyond::SequenceOrbit;
pub use open::{OpenOrbit, OrbitNotBeyond, UnprovenOrbit};
#[cfg(feature = "cli")]
pub(crate) use requested::RequestedOrbits;
pub use system::{NearOrbit, OrbitCondition, PosedOrbit};

use super::arc::{Broken, Moving};
use super::certificate::{CertifiedPoint, GrowthTally, Provable, RefusedProof, begin_alike};
use super::{krawczyk, wider};
use crate::affine::orbit::candidates::candidates;
use crate::affine::orbit::{
    AffineOrbit, Critical, Margin, Scales, Sequence, Watch, Zone, ZonePoint,
};
use crate::affine::system::System;
use crate::hybrid::OrbitItem;
use crate::interval::{Decimal, Interval, Number, PI};
use crate::linalg::Vector;
use crate::orbit::special::{Change, Special};
use crate::orbit::{EventType, Examined, Orbit};
use crate::problem::{decimal_at, decimal_of};
use modes::Structure;
use products::Needed;
use system::{Layout, OrbitSystem};

/// A margin of order one that is smaller than this at an event may vanish there; whether it does is proven.
const VANISHES: f64 = 1e-6;

/// A change of the sequence as the continuation has found it: its type follows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Changed {
    /// What vanishes in the sequence before.
    pub watch: Watch,
    /// Zone of that.
    pub zone: usize,
    /// The sequence before.
    pub before: Sequence,
    /// The sequence beyond, if one was found.
    pub after: Option<Sequence>,
}

/// What is proven of a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrbitStatement {
    /// The continuation parameter lies in here.
    pub parameter: Interval,
    /// The period.
    pub period: Interval,
    /// No other such orbit has its parameter within this distance and all its other unknowns within the same share
    /// of their units.
    pub unique: f64,
    /// Angle of a pair of multipliers on the unit circle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle: Option<Interval>,
    /// Inequalities proven.
    pub inequalities: usize,
    /// Multipliers outside the unit circle, at values of the parameter where that is decided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside: Option<usize>,
}

/// A statement, and what it takes to check it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrbitProof {
    /// The system and its equations.
    pub posed: PosedOrbit,
    /// What singles out the point.
    pub condition: OrbitCondition,
    /// The change of the sequence, at one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub changed: Option<Changed>,
    /// The orbit in the sequences before and beyond a change, where it is proven in another.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seen: Vec<SequenceOrbit>,
    /// The orbit in doubles.
    pub near: NearOrbit,
    /// What is proven.
    pub statement: OrbitStatement,
}

impl Provable for OrbitProof {
    type Parameter = String;
    type Unproven = UnprovenOrbit;
    type Beyond = OrbitNotBeyond;

    fn arc(
        from: &OrbitProof,
        to: &OrbitProof,
    ) -> Result<(), Broken<UnprovenOrbit, OrbitNotBeyond>> {
        arc::prove(from, to)
    }

    fn is_event_of(&self, other: &OrbitProof) -> bool {
        let meet = |a: Interval, b: Interval| !a.intersection(b).is_empty();
        let (first, second) = (&self.statement, &other.statement);
        let angles = match (first.angle, second.angle) {
            (Some(a), Some(b)) => meet(a, b),
            _ => true,
        };
        let is_value = |proof: &OrbitProof| matches!(proof.condition, OrbitCondition::Value(_));
        let entries = |proof: &OrbitProof| -> Vec<Vec<f64>> {
            let zones = proof.near.zones.iter();
            let entry = |zone: &ZonePoint| {
                let states = zone.state.iter().copied();
                states.chain([zone.phase.cos(), zone.phase.sin()]).collect()
            };
            zones.map(entry).collect()
        };
        !is_value(self)
            && !is_value(other)
            && angles
            && meet(first.parameter, second.parameter)
            && meet(first.period, second.period)
            && begin_alike(&entries(self), &entries(other))
    }

    fn tally(point: &CertifiedPoint<OrbitProof>) -> GrowthTally {
        let Some(proof) = point.proof() else {
            return GrowthTally::Unknown;
        };
        match (&proof.condition, proof.statement.outside) {
            (OrbitCondition::Value(_), Some(growing)) => GrowthTally::Known {
                growing,
                neutral: 0,
            },
            (OrbitCondition::Value(_), None) => GrowthTally::Passes(0),
            (OrbitCondition::Fold | OrbitCondition::Doubling | OrbitCondition::Branching, _) => {
                GrowthTally::Passes(1)
            }
            (OrbitCondition::Torus { .. }, _) => GrowthTally::Passes(2),
            (OrbitCondition::Margin { .. }, _) => GrowthTally::Unknown,
        }
    }

    fn take_system(&mut self) -> Option<System> {
        self.posed.system.take()
    }

    fn give_system(&mut self, system: &System) {
        self.posed.system.get_or_insert_with(|| system.clone());
    }
}

impl OrbitProof {
    /// The type of a change of the sequence by what vanishes there.
    fn change(&self) -> Option<EventType> {
        let (system, _) = OrbitSystem::new(&self.posed, &self.near, &self.condition).ok()?;
        system.change()
    }
}

/// Proves a special point of a branch; `None` for points without an event, and for failures. `text` is that of the
/// problem file, whose decimals are taken as they are written.
pub fn certify(item: &OrbitItem, text: &str) -> Option<CertifiedPoint<OrbitProof>> {
    let (event, special) = (item.event.as_ref()?, item.special.as_ref()?);
    if event.kind == EventType::MX {
        return None;
    }
    let (orbit, _) = item.orbit();
    Some(CertifiedPoint {
        label: event.label,
        kind: event.kind,
        parameter: orbit.parameter(),
        leg: item.point.leg,
        arc: None,
        growth: None,
        outcome: prepared(item, special, text).into(),
    })
}

fn prepared(
    item: &OrbitItem,
    special: &Special<AffineOrbit>,
    text: &str,
) -> Result<OrbitProof, OpenOrbit> {
    let (orbit, point) = item.orbit();
    let setting = &orbit.setting;
    if setting.prescribed.is_some() {
        return Err(OpenOrbit::Prescribed);
    }
    let at = setting.parameter;
    let names = setting.system.source.parameters.names();
    let values = names.zip(setting.values.iter().copied());
    let mut posed = PosedOrbit {
        // monitors are no part of what is proven
        system: Some(setting.system.clone().with_monitors(Vec::new())),
        values: decimals(values, text),
        parameter: at,
        periods: setting.periods,
        // where an orbit begins that never switches is none of what is proven
        units: Scales {
            section: None,
            ..setting.scales.clone()
        },
    };
    let value = item.point.parameters.get(at).copied().unwrap_or(f64::NAN);
    let mut near = near(orbit, point)?;
    let condition = match special {
        Special::User(..) | Special::Edge(..) => {
            OrbitCondition::Value(decimal_of(text, "continuation", value))
        }
        Special::Monitor(..) => return Err(OpenOrbit::Monitor),
        Special::Start | Special::Closed => {
            let name = orbit.parameter();
            OrbitCondition::Value(decimal_of(
                text,
                &format!("system.parameters.{name}"),
                value,
            ))
        }
        Special::Fold(_) => OrbitCondition::Fold,
        Special::Own(Critical::PeriodDoubling) => {
            // an orbit that is traversed several times is one of a part of its period
            let times = orbit.traversals(point).max(1);
            near.sequence.0.truncate(near.zones.len() / times);
            near.zones.truncate(near.zones.len() / times);
            posed.periods /= u32::try_from(times).unwrap_or(1);
            OrbitCondition::Doubling
        }
        Special::Own(Critical::Torus { angle }) => OrbitCondition::Torus { angle: *angle },
        Special::Own(Critical::Branching) => OrbitCondition::Branching,
        Special::Own(Critical::Shrinking | Critical::Vanishing) => {
            return Err(OpenOrbit::Shrinking);
        }
        Special::Own(
            Critical::Homoclinic { .. }
            | Critical::SaddleNode { .. }
            | Critical::RestOnBoundary { .. },
        ) => {
            return Err(OpenOrbit::Homoclinic);
        }
        Special::Own(
            Critical::Doublings { .. }
            | Critical::Branchings { .. }
            | Critical::Several { .. }
            | Critical::Unlocated { .. },
        ) => return Err(OpenOrbit::Several),
        Special::Change(change) => return changed(posed, orbit, point, change),
        Special::Failed(_) => return Err(OpenOrbit::Sequence),
    };
    prove(posed, near, condition)
}

/// Values of parameters as a text has them; one that is another there, after a restart, is the decimal of its double.
pub(super) fn decimals<'a>(
    parameters: impl Iterator<Item = (&'a str, f64)>,
    text: &str,
) -> Vec<Decimal> {
    let written = |(name, value): (&str, f64)| {
        let there = decimal_at(text, &format!("system.parameters.{name}"));
        let there = there.filter(|decimal| decimal.nearest() == value);
        there.unwrap_or_else(|| Decimal::of(value))
    };
    parameters.map(written).collect()
}

fn near(orbit: &AffineOrbit, point: &Vector) -> Result<NearOrbit, OpenOrbit> {
    let at = orbit.at(point).map_err(|_| OpenOrbit::NotEnclosed)?;
    Ok(NearOrbit {
        sequence: orbit.sequence.clone(),
        zones: at.zones,
        parameter: orbit.parameter_at(point),
    })
}

/// Proves a change of the sequence: in the sequence before or, where a zone of that has no duration, in one without
/// it, where another margin vanishes. At a graze several do, all for one reason: they are tried in turn.
fn changed(
    posed: PosedOrbit,
    orbit: &AffineOrbit,
    point: &Vector,
    change: &Change<AffineOrbit>,
) -> Result<OrbitProof, OpenOrbit> {
    let (before, after) = (&change.before, &change.after);
    // where several things happen at once, what was entered before has no duration yet
    let tiny = VANISHES * orbit.setting.scales.time;
    let zones = near(orbit, point)?.zones;
    let closed = match change.margin.watch {
        Watch::Duration => Some(change.margin.zone),
        Watch::Inside(_) | Watch::Speed => None,
        _ => zones.iter().position(|zone| zone.duration < tiny),
    };
    let closes = closed.is_some();
    let mut list = vec![(orbit.clone(), point.clone())];
    if let Some(zone) = closed {
        let margin = Margin {
            watch: Watch::Duration,
            zone,
            ..change.margin.clone()
        };
        let found = candidates(orbit, point, &margin).map_err(|_| OpenOrbit::Duration)?;
        list = found
            .into_iter()
            .filter(|candidate| candidate.nascent.is_empty())
            .filter(|candidate| {
                let mut sides = [before].into_iter().chain(after);
                sides.any(|side| side.is_rotation_of(&candidate.orbit.sequence))
            })
            .map(|candidate| (candidate.orbit, candidate.point))
            .collect();
        // that of the branch beyond first
        list.sort_by_key(|(orbit, _)| Some(&orbit.sequence) != after.as_ref());
    }
    let branch = (orbit, point);
    let mut reason = None;
    for (orbit, point) in list {
        let Ok(examination) = orbit.examination(&point) else {
            continue;
        };
        let mut margins: Vec<&Margin> = match closes {
            true => Vec::new(),
            false => vec![&change.margin],
        };
        let alike = |one: &&Margin| {
            let kind = AffineOrbit::classify(before, after.as_ref(), one);
            one.value.abs() <= VANISHES
                && one.watch != Watch::Duration
                && (closes || !AffineOrbit::is_same(one, &change.margin) && kind == change.kind)
        };
        margins.extend(examination.margins().iter().filter(alike));
        for vanishing in margins {
            let near = near(&orbit, &point)?;
            match prove(posed.clone(), near, vanishing.into()) {
                Ok(proof) if proof.change() != Some(change.kind) => {
                    reason = reason.or(Some(OpenOrbit::Kind));
                }
                Ok(proof) => return Ok(completed(proof, branch, change)),
                Err(other) => reason = reason.or(Some(other)),
            }
        }
    }
    // two contacts that change their order have a zone between them on both sides, and no sequence without one
    if let Some(zone) = closed {
        let (orbit, point) = branch;
        match prove(posed, near(orbit, point)?, OrbitCondition::closed(zone)) {
            Ok(proof) if proof.change() == Some(change.kind) => {
                return Ok(completed(proof, branch, change));
            }
            Ok(_) => {}
            Err(other) => reason = reason.or(Some(other)),
        }
    }
    Err(reason.unwrap_or(OpenOrbit::Duration))
}

/// A proof with the change of the sequence, and with the orbit in the sequences in which it is not proven itself: what is not
/// proven there is not stated.
fn completed(
    mut proof: OrbitProof,
    (orbit, point): (&AffineOrbit, &Vector),
    change: &Change<AffineOrbit>,
) -> OrbitProof {
    let margin = &change.margin;
    let own = SequenceOrbit {
        condition: proof.condition.clone(),
        near: proof.near.clone(),
    };
    let proven =
        |sequence: &Sequence, list: &dyn Fn() -> Vec<SequenceOrbit>| match own.near.sequence
            == *sequence
        {
            true => Some(own.clone()),
            false => {
                let mut list = list().into_iter();
                list.find(|one| beyond::prove(&proof, one).is_ok())
            }
        };
    let first = proven(&change.before, &|| beyond::seen_here(orbit, point, margin));
    let first = first.unwrap_or_else(|| own.clone());
    let beyond = |after| proven(after, &|| beyond::seen(orbit, point, margin, after));
    let other = change.after.as_ref().and_then(beyond);
    let other = other.filter(|one| !one.near.sequence.is_rotation_of(&first.near.sequence));
    let vanishing = first.condition.watched();
    let (watch, zone) = vanishing.unwrap_or((margin.watch, margin.zone));
    proof.changed = Some(Changed {
        watch,
        zone,
        before: first.near.sequence.clone(),
        after: other.as_ref().map(|one| one.near.sequence.clone()),
    });
    let seen = [first].into_iter().chain(other);
    proof.seen = seen.filter(|one| one.near != proof.near).collect();
    proof
}

/// Proves the point next to an orbit in doubles.
///
/// # Errors
/// It is not covered, or not proven.
pub fn prove(
    posed: PosedOrbit,
    near: NearOrbit,
    condition: OrbitCondition,
) -> Result<OrbitProof, OpenOrbit> {
    let (system, guess) = OrbitSystem::new(&posed, &near, &condition)?;
    let equations = |x: &[Interval]| system.evaluate(x);
    let found = krawczyk::refined(&equations, &guess).ok_or(OpenOrbit::NotEnclosed)?;
    let (near, condition) = system.near(&near, &found);
    // from what is stored, as a check does it
    let statement = statement(&posed, &near, &condition, None)?;
    Ok(OrbitProof {
        posed,
        condition,
        changed: None,
        seen: Vec::new(),
        near,
        statement,
    })
}

/// What is proven of the point next to an orbit. The distance of uniqueness is looked for, or that of a stored
/// statement, which is 0 where it does not hold.
fn statement(
    posed: &PosedOrbit,
    near: &NearOrbit,
    condition: &OrbitCondition,
    stored: Option<f64>,
) -> Result<OrbitStatement, OpenOrbit> {
    /// The orbit in doubles is known to this share of its units, or it is not that of the point.
    const KNOWN: f64 = 1e-7;
    let (mut system, middle) = OrbitSystem::new(posed, near, condition)?;
    let units = system.units(&middle);
    let equations = |x: &[Interval]| system.evaluate(x);
    let zero = krawczyk::known(&equations, &middle, &units, KNOWN).ok_or(OpenOrbit::NotIsolated)?;
    let parameter = system.parameter();
    let angle = match condition {
        OrbitCondition::Torus { .. } => zero.at.last().copied(),
        _ => None,
    };
    // at 0 and π the equations of a pair are those of one multiplier, with any complex multiple of its vector
    if angle.is_some_and(|angle| !(angle.is_positive() && (PI - angle).is_positive())) {
        return Err(OpenOrbit::Angle);
    }
    if !system.is_primitive(&zero.at) {
        return Err(OpenOrbit::Repeated);
    }
    let modes = system.enclosed(zero.at[parameter])?;
    let passings = system.passings(&modes, &zero.at);
    let still: Vec<Moving> = zero.at.iter().copied().map(Moving::constant).collect();
    let checked = match system.half {
        true => halved(&system, &zero.at),
        false => system
            .inequalities(&modes, &passings, &still, &system.closed)
            .map_err(OpenOrbit::from),
    };
    let inequalities = match checked {
        Ok(inequalities) => inequalities,
        Err(reason) => {
            system.mirror(&middle, &zero.at).ok_or(reason)?;
            system.inequalities(&modes, &passings, &still, &system.closed)?
        }
    };
    let equations = |x: &[Interval]| system.evaluate(x);
    let unique = zero.distance(&equations, &middle, &units, parameter, stored);
    let durations = (0..system.stretches.len()).map(|index| zero.at[system.duration(index)]);
    let cycles = Interval::point(if system.half { 2.0 } else { 1.0 });
    let period = cycles * durations.fold(Interval::ZERO, |sum, duration| sum + duration);
    let monodromy = match condition {
        OrbitCondition::Value(_) => system.monodromy(&modes, &passings, &zero.at),
        _ => None,
    };
    Ok(OrbitStatement {
        parameter: match condition {
            OrbitCondition::Value(value) => value.interval(),
            _ => wider(zero.at[parameter]),
        },
        period: wider(period),
        unique,
        angle: angle.map(wider),
        inequalities,
        outside: monodromy.and_then(|monodromy| multipliers::outside(&monodromy)),
    })
}

/// Proves the inequalities of a symmetric orbit whose half is enclosed.
fn halved(half: &OrbitSystem, x: &[Interval]) -> Result<usize, OpenOrbit> {
    let value = OrbitCondition::Value(Decimal::of(half.near.parameter));
    let layout = Layout {
        steps: half.steps.repeat(2),
        ..Layout::default()
    };
    let (system, _) = OrbitSystem::laid_out(half.posed, half.near, &value, &layout)?;
    let whole = half.whole(x, &system).ok_or(OpenOrbit::NotEnclosed)?;
    let modes = system.enclosed(whole[system.parameter()])?;
    let passings = system.passings(&modes, &whole);
    let still: Vec<Moving> = whole.iter().copied().map(Moving::constant).collect();
    Ok(system.inequalities(&modes, &passings, &still, &[])?)
}

/// Proves a stored statement again, without continuation.
///
/// # Errors
/// The proof fails, or it proves something else.
pub fn verify(point: &CertifiedPoint<OrbitProof>, proof: &OrbitProof) -> Result<(), RefusedProof> {
    proven_again(point, proof).map(|_| ())
}

/// Proves a stored statement again; returns the proof with intervals of it that are no wider than they are proven.
///
/// # Errors
/// The proof fails, or it proves something else.
pub(crate) fn proven_again(
    point: &CertifiedPoint<OrbitProof>,
    proof: &OrbitProof,
) -> Result<OrbitProof, RefusedProof> {
    let OrbitProof {
        posed,
        condition,
        near,
        statement: said,
        ..
    } = proof;
    let open = |open: OpenOrbit| RefusedProof::NoProof(open.to_string());
    let mut names = posed.system().map_err(open)?.source.parameters.names();
    if names.nth(posed.parameter) != Some(&point.parameter) {
        return Err(RefusedProof::Statement("the parameter"));
    }
    check_zones(proof)?;
    check_kind(proof, point.kind)?;
    let proven = statement(posed, near, condition, Some(said.unique)).map_err(open)?;
    super::compared("the parameter", said.parameter, proven.parameter)?;
    super::compared("the period", said.period, proven.period)?;
    match (said.angle, proven.angle) {
        (Some(said), Some(proven)) => super::compared("the angle", said, proven)?,
        (None, None) => {}
        _ => return Err(RefusedProof::Statement("the angle")),
    }
    super::compared_unique(said.unique, proven.unique)?;
    if said.inequalities != proven.inequalities {
        return Err(RefusedProof::Statement("the number of inequalities"));
    }
    if said.outside.is_some() && said.outside != proven.outside {
        return Err(RefusedProof::Statement(
            "the number of multipliers outside the unit circle",
        ));
    }
    let mut again = proof.clone();
    let statement = &mut again.statement;
    statement.parameter = super::narrowed(said.parameter, proven.parameter);
    statement.period = super::narrowed(said.period, proven.period);
    let angles = said.angle.zip(proven.angle);
    statement.angle = angles.map(|(said, proven)| super::narrowed(said, proven));
    Ok(again)
}

/// Refuses zones that are no modes of the system, by their numbers and their names, or have labels that their switches do not give.
fn check_zones(proof: &OrbitProof) -> Result<(), RefusedProof> {
    let open = |open: OpenOrbit| RefusedProof::NoProof(open.to_string());
    let system = proof.posed.system().map_err(open)?;
    let seen = proof.seen.iter().map(|seen| &seen.near.sequence);
    let changed = proof.changed.iter();
    let changed = changed.flat_map(|changed| [&changed.before].into_iter().chain(&changed.after));
    let sequences = [&proof.near.sequence]
        .into_iter()
        .chain(seen)
        .chain(changed);
    let zones: Vec<&Zone> = sequences.flat_map(|sequence| &sequence.0).collect();
    let PosedOrbit {
        values,
        parameter,
        units,
        ..
    } = &proof.posed;
    let near = (Interval::point(proof.near.parameter), units.parameter);
    let needed = Needed::new(values, *parameter, near, zones.iter().copied());
    let (_, modes) = Structure::of(system, &needed).map_err(open)?;
    let is_mode = |zone: &Zone| {
        let way = zone.way.map(|way| [way.guard, way.exit]);
        let label = way.and_then(|way| modes.label(zone.mode, way));
        modes.modes.get(zone.mode).is_some()
            && system.mode_name(zone.mode) == zone.name
            && zone.has_label(label)
    };
    match zones.into_iter().all(is_mode) {
        true => Ok(()),
        false => Err(RefusedProof::Statement("the name of a zone")),
    }
}

/// Proves that the sequence changes from the one that is stated, by what is stated to vanish there, to the other, if there is one: in
/// each of them the orbit of the event is proven.
fn check_change(proof: &OrbitProof, changed: &Changed) -> Result<(), RefusedProof> {
    let Changed {
        watch,
        zone,
        before,
        after,
    } = changed;
    let refused = || RefusedProof::Statement("the change of the sequence");
    let mut sides = [before].into_iter().chain(after);
    let is_none = |after: &Sequence| after.is_rotation_of(before);
    if !sides.clone().any(|one| *one == proof.near.sequence) || after.as_ref().is_some_and(is_none)
    {
        return Err(refused());
    }
    let condition = match *before == proof.near.sequence {
        true => Some(&proof.condition),
        false => {
            let mut seen = proof.seen.iter();
            let there = seen.find(|seen| seen.near.sequence == *before);
            there.map(|seen| &seen.condition)
        }
    };
    let vanishing = condition.and_then(OrbitCondition::watched);
    if vanishing != Some((*watch, *zone)) {
        return Err(refused());
    }
    for seen in &proof.seen {
        beyond::prove(proof, seen).map_err(|reason| RefusedProof::NoProof(reason.to_string()))?;
    }
    let is_proven = |side: &Sequence| {
        let mut seen = proof.seen.iter();
        *side == proof.near.sequence || seen.any(|seen| seen.near.sequence == *side)
    };
    match sides.all(is_proven) {
        true => Ok(()),
        false => Err(refused()),
    }
}

/// Whether the type of an event follows from what vanishes there.
fn check_kind(proof: &OrbitProof, said: EventType) -> Result<(), RefusedProof> {
    let OrbitProof {
        posed,
        condition,
        changed,
        near,
        ..
    } = proof;
    let open = |open: OpenOrbit| RefusedProof::NoProof(open.to_string());
    if changed.is_none() && !proof.seen.is_empty() {
        return Err(RefusedProof::Statement("the change of the sequence"));
    }
    let found = match (condition, changed.as_ref()) {
        // of a value the certificate does not say who asked for it
        (OrbitCondition::Value(_), None) if said == EventType::EP => EventType::EP,
        (OrbitCondition::Value(_), None) => EventType::UZ,
        (OrbitCondition::Fold, None) => EventType::LP,
        (OrbitCondition::Doubling, None) => EventType::PD,
        (OrbitCondition::Branching, None) => EventType::BP,
        (OrbitCondition::Torus { .. }, None) => EventType::NS,
        (OrbitCondition::Margin { .. }, Some(changed)) => {
            check_change(proof, changed)?;
            let (system, _) = OrbitSystem::new(posed, near, condition).map_err(open)?;
            system.change().ok_or_else(|| open(OpenOrbit::Kind))?
        }
        _ => return Err(RefusedProof::Statement("the change of the sequence")),
    };
    match found == said {
        true => Ok(()),
        false => Err(RefusedProof::Kind { said, found }),
    }
}
