//! Special points of a branch, proven.
//!
//! A point that continuation has located is proven in four steps.
//!
//! 1. The numbers of the problem are the decimals that were written; a, b, D, g, h are enclosed ([`frame`]).
//! 2. The equations of the wave and the condition of the event, evaluated in intervals with the exact flow
//!    and its remainder ([`flow`], [`system`], [`perturbation`]), have exactly one zero in a box, and it is regular
//!    ([`krawczyk`]): the margin changes its sign along the branch, a fold is quadratic.
//! 3. Every other inequality of the signature holds over whole zones ([`inequality`]).
//! 4. What is said of parameter, speed and lengths follows from the enclosure of that zero.
//!
//! Beyond that there are arcs between two points ([`arc`]), and the number of eigenvalues that grow ([`count`]).
//! [`orbit`] does the same for orbits of a user's system, and [`equilibrium`] for its equilibria.
//!
//! A [`Certificate`] has what is needed to do steps 2 to 4 again without continuation.

mod analytic;
mod arc;
mod certificate;
mod change;
mod count;
mod equations;
pub mod equilibrium;
mod flow;
mod fold;
mod frame;
mod inequality;
mod krawczyk;
mod layer;
mod meaning;
mod open;
pub mod orbit;
mod perturbation;
mod propagator;
#[cfg(feature = "cli")]
mod requested;
#[cfg(feature = "cli")]
mod requested_system;
mod stretch;
mod system;
mod tail;
mod tally;

pub use certificate::repeated;
pub use certificate::{
    ArcOutcome, Certificate, CertifiedPoint, Counted, GrowthTally, ProofOutcome, Provable,
    RefusedProof, WaveProof, WaveStatement,
};
pub use change::WaveBeyond;
pub use count::{GrowthCount, Leading, ProvenVerdict, Uncounted};
pub use frame::{WrittenCoefficients, WrittenModel};
pub use inequality::UnprovenWave;
pub use open::OpenPoint;
pub use perturbation::ProvenEigenvalue;
#[cfg(feature = "cli")]
pub(crate) use requested::RequestedWaves;
pub use system::{NearWave, PosedWave, WaveCondition};
pub use tally::miscounted;

use crate::branch::row::EigenvalueRow;
use crate::branch::run::WaveItem;
use crate::branch::special::{OfWaves, Special};
use crate::interval::{Decimal, Interval};
use crate::linalg::Vector;
use crate::orbit::EventType;
use crate::problem::{decimal_at, decimal_of};
use crate::tube::flow::method::Method;
use crate::tube::model::signature::{Regime, ZoneEntry, switches};
use crate::tube::model::{Impact, Parameter};
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::WaveWatch;
use arc::Broken;
use change::WaveNotBeyond;
use inequality::ProvenPart;
use system::WaveSystem;

impl Provable for WaveProof {
    type Parameter = Parameter;
    type Unproven = UnprovenWave;
    type Beyond = WaveNotBeyond;

    fn arc(from: &WaveProof, to: &WaveProof) -> Result<(), Broken<UnprovenWave, WaveNotBeyond>> {
        stretch::prove(from, to)
    }

    fn is_event_of(&self, other: &WaveProof) -> bool {
        meaning::is_event_of(self, other)
    }

    fn tally(point: &CertifiedPoint) -> GrowthTally {
        let Some(proof) = point.proof() else {
            return GrowthTally::Unknown;
        };
        let neutral = match &proof.condition {
            WaveCondition::Value(_) => 0,
            WaveCondition::Fold => 1,
            // with its conjugate
            WaveCondition::Crossing { omega: 0.0, .. } => 1,
            WaveCondition::Crossing { .. } => 2,
            WaveCondition::Margin { .. } => return GrowthTally::Unknown,
        };
        match &point.growth {
            Some(Counted::Proven(growth)) => GrowthTally::Known {
                growing: growth.on_circle(),
                neutral,
            },
            _ => GrowthTally::Passes(neutral),
        }
    }
}

/// Proves a special point of a branch; `None` for points without an event, and for failures. `text` is that
/// of the problem file, whose decimals are taken as they are written.
pub fn certify(item: &WaveItem, text: &str) -> Option<CertifiedPoint> {
    let (event, special) = (item.event.as_ref()?, item.special.as_ref()?);
    let kind = special.kind();
    let (wave, point) = item.wave();
    if kind == EventType::MX {
        return None;
    }
    let value = event.model.value(wave.parameter).unwrap_or(f64::NAN);
    let prepared = || -> Result<WaveProof, OpenPoint> {
        covered(wave, point)?;
        let (condition, beyond) = condition(wave, point, special, || match special {
            Special::User(..) | Special::Edge(..) | Special::Own(OfWaves::CoulombLimit) => {
                decimal_of(text, "continuation", value)
            }
            _ => decimal_of(text, wave.parameter.path(), value),
        })?;
        let posed = PosedWave {
            written: WrittenModel::new(&wave.model, wave.material, |path| decimal_at(text, path)),
            impact: wave.model.impact,
            parameter: wave.parameter,
            mode: wave.mode,
            unit: wave.scales.parameter.abs(),
        };
        let proof = prove(posed, NearWave::new(wave, point), condition, beyond)?;
        meaning::check_type(kind, &proof.near, &proof.condition).map_err(|_| OpenPoint::Type)?;
        let eigenvalues = match &proof.condition {
            WaveCondition::Value(_) => eigenvalues(&proof, &leading(&item.eigenvalues))?,
            _ => Vec::new(),
        };
        Ok(WaveProof {
            eigenvalues,
            ..proof
        })
    };
    Some(CertifiedPoint {
        label: event.label,
        kind,
        parameter: wave.parameter,
        leg: item.leg,
        arc: None,
        growth: None,
        outcome: prepared().into(),
    })
}

impl CertifiedPoint {
    /// Counts the growing eigenvalues with |Im λ| up to a window; `None` but at user points, ends and crossings.
    pub fn counted(&self, window: f64) -> Option<Counted> {
        let proof = self.proof()?;
        if !proof.condition.is_counted() {
            return None;
        }
        Some(match growth(proof, window, None) {
            Ok(growth) => Counted::Proven(growth),
            Err(reason) => Counted::Open(reason.to_string()),
        })
    }
}

/// Proves the point next to a wave in doubles; the wave beyond it is left out where it is not proven.
///
/// # Errors
/// It is not covered, or not proven.
pub fn prove(
    posed: PosedWave,
    near: NearWave,
    condition: WaveCondition,
    beyond: Option<WaveBeyond>,
) -> Result<WaveProof, OpenPoint> {
    let (system, guess) = system(&posed, &near, &condition)?;
    let equations = |x: &[Interval]| system.evaluate(x);
    let found = krawczyk::refined(&equations, &guess).ok_or(OpenPoint::NotEnclosed)?;
    let (near, condition) = (system.refined(&found), system.located(&found));
    // from what is stored, as a check does it
    let statement = statement(&posed, &near, &condition, None)?;
    let beyond =
        beyond.filter(|beyond| meaning::check_beyond(&posed, &near, &condition, beyond).is_ok());
    Ok(WaveProof {
        posed,
        condition,
        beyond,
        near,
        statement,
        eigenvalues: Vec::new(),
    })
}

/// The first of every sector, of a conjugate pair that with Im λ ≥ 0.
fn leading(rows: &[EigenvalueRow]) -> Vec<(usize, [f64; 2])> {
    let mut found: Vec<(usize, [f64; 2])> = Vec::new();
    for row in rows {
        match found.iter_mut().find(|(sector, _)| *sector == row.sector) {
            None => found.push((row.sector, [row.re, row.im])),
            Some((_, [re, im])) if *re == row.re && *im == -row.im => *im = im.abs(),
            Some(_) => {}
        }
    }
    found
}

/// Proves eigenvalues next to those in doubles; those that are not proven are left out.
fn eigenvalues(
    proof: &WaveProof,
    wanted: &[(usize, [f64; 2])],
) -> Result<Vec<ProvenEigenvalue>, OpenPoint> {
    let layered = proof.posed.written.material.is_some();
    if wanted.is_empty() || layered || lands_with_impulse(&proof.posed, &proof.near) {
        return Ok(Vec::new());
    }
    let (system, wave) = known(proof)?;
    let proven = wanted.iter().filter_map(|(sector, lambda)| {
        let [growth, omega] = system.eigenvalue(&wave, *sector, *lambda)?;
        Some(ProvenEigenvalue {
            sector: *sector,
            near: *lambda,
            growth: wider(growth),
            omega: wider(omega),
        })
    });
    Ok(proven.collect())
}

/// Counts the growing eigenvalues of a wave; see [`WaveSystem::growth`].
fn growth(
    proof: &WaveProof,
    window: f64,
    stored: Option<&GrowthCount>,
) -> Result<GrowthCount, Uncounted> {
    if proof.posed.written.material.is_some() {
        return Err(Uncounted::MaterialDamping);
    }
    if lands_with_impulse(&proof.posed, &proof.near) {
        return Err(Uncounted::CoulombImpact);
    }
    let (system, wave) = known(proof).map_err(|_| Uncounted::Wave)?;
    system.growth(&wave, window, &proof.eigenvalues, stored)
}

/// The equations of a point, and intervals of their unknowns.
fn known(proof: &WaveProof) -> Result<(WaveSystem<'_>, Vec<Interval>), OpenPoint> {
    let (system, middle) = system(&proof.posed, &proof.near, &proof.condition)?;
    let wave = enclosed(&proof.posed, &system, &middle).ok_or(OpenPoint::NotIsolated)?;
    Ok((system, wave))
}

/// Intervals of the unknowns of a system next to values in doubles.
fn enclosed(posed: &PosedWave, system: &WaveSystem, middle: &[f64]) -> Option<Vec<Interval>> {
    let equations = |x: &[Interval]| system.evaluate(x);
    let units = units(system, middle, system.near, posed.unit);
    Some(krawczyk::enclosed(&equations, middle, &units)?.at)
}

/// A little wider than proven here: other machines may have other last digits.
fn wider(x: Interval) -> Interval {
    let room = 0.125 * x.width() + f64::MIN_POSITIVE;
    x + Interval::new(-room, room)
}

/// Whether the perturbation of a Coulomb impact enters.
fn lands_with_impulse(posed: &PosedWave, near: &NearWave) -> bool {
    let lands = [
        ZoneEntry::Landing,
        ZoneEntry::Touch,
        ZoneEntry::ArrestedLanding,
    ];
    let impact = |index: usize| lands.contains(&near.signature.zone(index).entry);
    posed.impact == Impact::Coulomb && (0..near.signature.len()).any(impact)
}

/// What singles out a special point, and the wave beyond it.
fn condition(
    wave: &Wave,
    point: &Vector,
    special: &Special,
    value: impl Fn() -> Decimal,
) -> Result<(WaveCondition, Option<WaveBeyond>), OpenPoint> {
    Ok(match special {
        Special::User(..)
        | Special::Edge(..)
        | Special::Own(OfWaves::CoulombLimit)
        | Special::Start
        | Special::Closed => (WaveCondition::Value(value()), None),
        Special::Fold(_) => (WaveCondition::Fold, None),
        Special::Change(change) if change.margin.watch == WaveWatch::Coupling => {
            return Err(OpenPoint::Undriven);
        }
        Special::Change(change) => {
            let entered = || WaveBeyond::new(wave, point, change).ok_or(OpenPoint::Signature);
            let beyond = change.after.as_ref().map(|_| entered()).transpose()?;
            (change.margin.into(), beyond)
        }
        Special::Own(OfWaves::HopfPoint | OfWaves::StickOpens) => return Err(OpenPoint::Family),
        Special::Own(OfWaves::Repeats) => return Err(OpenPoint::Repeats),
        Special::Own(OfWaves::Crossing { sector, omega, .. }) => {
            let (sector, omega) = (*sector, omega.unwrap_or(0.0));
            (WaveCondition::Crossing { sector, omega }, None)
        }
        // a wave has no monitors
        Special::Failed(_) | Special::Monitor(..) => return Err(OpenPoint::Signature),
    })
}

fn covered(wave: &Wave, point: &Vector) -> Result<(), OpenPoint> {
    let beta = match wave.parameter {
        Parameter::StiffnessDamping => wave.parameter_at(point),
        _ => wave.model.damping.stiffness,
    };
    if wave.material && beta <= 0.0 {
        return Err(OpenPoint::NoLayer);
    }
    if !wave.model.law.piecewise_linear() {
        return Err(OpenPoint::Law);
    }
    if wave.method != Method::Exact {
        return Err(OpenPoint::Method);
    }
    Ok(())
}

/// Units of the unknowns in which uniqueness is measured.
fn units(system: &WaveSystem, guess: &[f64], near: &NearWave, parameter_unit: f64) -> Vec<f64> {
    let period: f64 = near.zones.iter().map(|zone| zone[2].abs()).sum();
    let rate = near
        .zones
        .iter()
        .fold(1.0_f64, |rate, zone| rate.max(zone[1].abs()));
    let [excess, parameter] = system.tail();
    let unit = |(index, value): (usize, &f64)| {
        if index == excess {
            1.0
        } else if index == parameter {
            parameter_unit.abs()
        } else if index >= system.waves() || system.is_amplitude(index) {
            value.abs().max(1.0)
        } else if system.is_rate(index) {
            rate
        } else {
            value.abs().max(period)
        }
    };
    guess.iter().enumerate().map(unit).collect()
}

/// The equations of a point, and their unknowns in doubles.
fn system<'a>(
    posed: &'a PosedWave,
    near: &'a NearWave,
    condition: &WaveCondition,
) -> Result<(WaveSystem<'a>, Vec<f64>), OpenPoint> {
    let signature = &near.signature;
    meaning::is_posed(posed)?;
    match condition {
        WaveCondition::Margin { watch, zone, .. }
            if !meaning::is_condition(posed, signature, *watch, *zone) =>
        {
            return Err(OpenPoint::Margin);
        }
        WaveCondition::Crossing { sector, .. }
            if !u32::try_from(*sector).is_ok_and(|sector| sector < posed.mode) =>
        {
            return Err(OpenPoint::Sector);
        }
        _ => {}
    }
    let crosses = matches!(condition, WaveCondition::Crossing { .. });
    if posed.written.material.is_some() {
        if signature.has(Regime::Separation) {
            return Err(OpenPoint::LayeredSeparation);
        }
        if crosses {
            return Err(OpenPoint::LayeredEigenvalues);
        }
        if let WaveCondition::Margin {
            watch: WaveWatch::Duration,
            zone,
            ..
        } = condition
            && signature.zone(*zone).regime != Regime::Stick
        {
            return Err(OpenPoint::LayeredOpening);
        }
    }
    let follows = |index: usize| {
        let (zone, next) = (signature.zone(index), signature.zone(index + 1));
        switches(zone.regime, next.regime, posed.impact).contains(&next.entry)
    };
    if !(0..signature.len()).all(follows) {
        return Err(OpenPoint::Signature);
    }
    if crosses && lands_with_impulse(posed, near) {
        return Err(OpenPoint::CoulombImpact);
    }
    WaveSystem::new(posed, near, condition).ok_or(OpenPoint::NotEnclosed)
}

/// What is proven of the point next to a wave. The distance of uniqueness is looked for, or that of a stored
/// statement, which is 0 where it does not hold.
fn statement(
    posed: &PosedWave,
    near: &NearWave,
    condition: &WaveCondition,
    stored: Option<f64>,
) -> Result<WaveStatement, OpenPoint> {
    /// The wave in doubles is known to this share of its units, or it is not that of the point.
    const KNOWN: f64 = 1e-9;
    let (system, middle) = system(posed, near, condition)?;
    let units = units(&system, &middle, near, posed.unit);
    let equations = |x: &[Interval]| system.evaluate(x);
    let zero = krawczyk::known(&equations, &middle, &units, KNOWN).ok_or(OpenPoint::NotIsolated)?;
    if !meaning::is_primitive(&system, &zero.at) {
        return Err(OpenPoint::Repeats);
    }
    meaning::crosses_where_said(&system, &middle, &zero.at)?;
    meaning::lies_inside(&system, &zero.at)?;
    let inequalities = inequality::prove(&system, condition, ProvenPart::All, &zero.at)?;
    let frame = system.frame_at(&zero.at).ok_or(OpenPoint::NotEnclosed)?;
    let [_, parameter] = system.tail();
    meaning::is_model(posed, zero.at[parameter], &frame)?;
    let unique = zero.distance(&equations, &middle, &units, parameter, stored);
    let length = |zone: usize| wider(zero.at[system.duration(zone)] * frame.speed);
    Ok(WaveStatement {
        parameter: match condition {
            WaveCondition::Value(value) => value.interval(),
            _ => wider(zero.at[parameter]),
        },
        speed: wider(system.speed(&frame)),
        lengths: (0..near.zones.len()).map(length).collect(),
        unique,
        omega: system.crossing().map(|_| wider(zero.at[system.waves()])),
        inequalities,
    })
}

/// Proves a stored statement again, without continuation.
///
/// # Errors
/// The proof fails, or it proves something else.
pub fn verify(point: &CertifiedPoint, proof: &WaveProof) -> Result<(), RefusedProof> {
    proven_again(point, proof).map(|_| ())
}

/// Proves a stored statement again; returns the proof with intervals of it that are no wider than they are proven.
///
/// # Errors
/// The proof fails, or it proves something else.
pub(crate) fn proven_again(
    point: &CertifiedPoint,
    proof: &WaveProof,
) -> Result<WaveProof, RefusedProof> {
    let WaveProof {
        posed,
        condition,
        beyond,
        near,
        statement: said,
        eigenvalues: spectrum,
    } = proof;
    if point.parameter != posed.parameter {
        return Err(RefusedProof::Statement("the parameter"));
    }
    if !(posed.unit > 0.0 && posed.unit.is_finite()) {
        return Err(RefusedProof::Statement("the unit of the parameter"));
    }
    meaning::check_type(point.kind, near, condition)?;
    let proven = statement(posed, near, condition, Some(said.unique))?;
    compared("the parameter", said.parameter, proven.parameter)?;
    compared("the speed", said.speed, proven.speed)?;
    let mut lengths = said.lengths.iter().zip(&proven.lengths);
    if said.lengths.len() != proven.lengths.len() || !lengths.all(|(a, b)| same(*a, *b)) {
        return Err(RefusedProof::Statement("a length"));
    }
    let both = said.omega.zip(proven.omega);
    if said.omega.is_some() != proven.omega.is_some() || both.is_some_and(|(a, b)| !same(a, b)) {
        return Err(RefusedProof::Statement("ω"));
    }
    compared_unique(said.unique, proven.unique)?;
    if said.inequalities != proven.inequalities {
        return Err(RefusedProof::Statement("the number of inequalities"));
    }
    let wanted: Vec<_> = spectrum
        .iter()
        .map(|said| (said.sector, said.near))
        .collect();
    let found = eigenvalues(proof, &wanted)?;
    let mut both = spectrum.iter().zip(&found);
    let sectors = 0..usize::try_from(posed.mode).unwrap_or(usize::MAX);
    if found.len() != spectrum.len()
        || !spectrum.iter().all(|said| sectors.contains(&said.sector))
        || !both.all(|(a, b)| same(a.growth, b.growth) && same(a.omega, b.omega))
    {
        return Err(RefusedProof::Statement("an eigenvalue"));
    }
    if let Some(beyond) = beyond {
        meaning::check_beyond(posed, near, condition, beyond)?;
    }
    let counted = point.growth.is_some() && !condition.is_counted();
    if counted || !spectrum.is_empty() && !matches!(condition, WaveCondition::Value(_)) {
        return Err(RefusedProof::Statement("where eigenvalues are looked for"));
    }
    let mut again = proof.clone();
    again.eigenvalues = found;
    if let Some(Counted::Proven(said)) = &point.growth
        && growth(&again, said.window, Some(said)).as_ref() != Ok(said)
    {
        return Err(RefusedProof::Statement("what grows"));
    }
    again.eigenvalues.clone_from(spectrum);
    let statement = &mut again.statement;
    statement.parameter = narrowed(said.parameter, proven.parameter);
    statement.speed = narrowed(said.speed, proven.speed);
    Ok(again)
}

/// An interval that is proven, without the room that stored ones have.
fn roomless(proven: Interval) -> Interval {
    let room = 0.0625 * proven.width();
    Interval::new(proven.low + room, proven.high - room)
}

/// Whether an interval is as stated, without the room that both have. A wider one says less, and is as true.
fn same(said: Interval, proven: Interval) -> bool {
    roomless(proven).within(said)
}

/// What is both stated and proven.
fn narrowed(said: Interval, proven: Interval) -> Interval {
    said.intersection(roomless(proven))
}

fn compared(what: &'static str, said: Interval, proven: Interval) -> Result<(), RefusedProof> {
    match same(said, proven) {
        true => Ok(()),
        false => Err(RefusedProof::Statement(what)),
    }
}

fn compared_unique(said: f64, proven: f64) -> Result<(), RefusedProof> {
    match said >= 0.0 && said <= proven * (1.0 + 1e-9) {
        true => Ok(()),
        false => Err(RefusedProof::Statement("the distance of uniqueness")),
    }
}
