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
mod carry;
mod centre;
mod changed;
mod check;
mod critical;
mod enclosure;
mod equations;
pub(super) mod exact;
mod extended;
mod facts;
pub(super) mod flow;
mod fraction;
mod guess;
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

use crate::orbit::{EventType, Zones};
use serde::{Deserialize, Serialize};

pub use beyond::SequenceOrbit;
#[cfg(feature = "cli")]
pub(crate) use check::proven_again;
pub use check::verify;
pub use open::{OpenOrbit, OrbitNotBeyond, UnprovenOrbit};
#[cfg(feature = "cli")]
pub(crate) use requested::RequestedOrbits;
pub use system::{NearOrbit, OrbitCondition, PosedOrbit};

use super::arc::{Broken, Moving};
use super::certificate::{CertifiedPoint, GrowthTally, Provable, begin_alike};
use super::{krawczyk, wider};
use crate::affine::orbit::row::first_of;
use crate::affine::orbit::setting::Setting;
use crate::affine::orbit::{AffineOrbit, Critical, Scales, Sequence, Watch, ZonePoint};
use crate::affine::system::System;
use crate::hybrid::OrbitItem;
use crate::interval::{Decimal, Interval, Number, PI};
use crate::linalg::Vector;
use crate::orbit::special::Special;
use crate::problem::{decimal_at, decimal_of};

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
    let mut posed = posed(setting, text);
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
        Special::Own(Critical::PeriodDoubling | Critical::Repeats { .. }) => {
            // an orbit that is traversed several times is one of a part of its period
            let times = orbit.traversals(point).max(1);
            (near.sequence, near.zones) = first_of(times, &near.sequence, &near.zones);
            posed.periods /= u32::try_from(times).unwrap_or(1);
            OrbitCondition::Doubling
        }
        Special::Own(Critical::Torus { angle }) => OrbitCondition::Torus { angle: *angle },
        Special::Own(Critical::Branching | Critical::Symmetric) => OrbitCondition::Branching,
        Special::Own(Critical::Shrinking | Critical::Vanishing | Critical::Instant) => {
            return Err(OpenOrbit::Shrinking);
        }
        Special::Own(Critical::Family) => return Err(OpenOrbit::Family),
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
        Special::Change(change) => return changed::changed(posed, orbit, point, change),
        Special::Failed(_) => return Err(OpenOrbit::Sequence),
    };
    prove(posed, near, condition)
}

/// What is asked of a branch with this setting.
fn posed(setting: &Setting, text: &str) -> PosedOrbit {
    let names = setting.system.source.parameters.names();
    let values = names.zip(setting.values.iter().copied());
    PosedOrbit {
        // monitors are no part of what is proven
        system: Some(setting.system.clone().with_monitors(Vec::new())),
        values: decimals(values, text),
        parameter: setting.parameter,
        periods: setting.periods,
        // where an orbit begins that never switches is none of what is proven
        units: Scales {
            section: None,
            ..setting.scales.clone()
        },
    }
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
    let zones = at.zones.into_iter();
    // a proof has steps of its own
    let whole = |zone: ZonePoint| ZonePoint::new(zone.state, zone.duration, zone.phase);
    Ok(NearOrbit {
        sequence: orbit.sequence.in_whole_zones(),
        zones: zones.map(whole).collect(),
        parameter: orbit.parameter_at(point),
    })
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
    let checked = match system.half.is_some() {
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
    let cycles = Interval::point(if system.half.is_some() { 2.0 } else { 1.0 });
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
