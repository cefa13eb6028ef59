//! The event that a curve begins with, looked for along a branch: followed step by step until it has the event of this type and
//! number, with no more of its spectra than the event needs.

use std::fmt::Display;

use super::Singular;
use super::equilibria::EquilibriaInPlane;
use super::orbits::OrbitsInPlane;
use super::plane::ParameterPlane;
use super::start::{CurveStart, FixedMonitor, NoCurve, of_branch, pose_connection, pose_orbit};
use super::tube::WavesInPlane;
use crate::branch::run::{RunError, WaveItem, WaveRunner};
use crate::hybrid;
use crate::orbit::EventType;
use crate::orbit::legs::{self, Run};
use crate::orbit::special::Special;
use crate::problem::{
    self, Problem, StabilitySection, SystemCurve, SystemCurveEvent, SystemProblem, UserPoint,
};
use crate::tube::model::Sectors;

/// Follows a branch to the event of this type and number, which `wanted` names. `watch` sees the branch after every
/// step.
pub(super) fn event<P: ParameterPlane, R: Run<Orbit = P::Orbit>>(
    mut branch: R,
    (kind, index): (Option<EventType>, usize),
    wanted: String,
    of: impl Fn(&R::Item) -> Option<EventType>,
    watch: &mut dyn FnMut(&R),
) -> Result<R::Item, NoCurve<P>>
where
    crate::orbit::special::BranchFailure<P::Orbit>: Display,
{
    let mut found = 0;
    while branch.progress().end.is_none() {
        watch(&branch);
        for item in branch.step() {
            if kind.is_some() && of(&item) == kind {
                found += 1;
                if found == index {
                    return Ok(item);
                }
            }
        }
    }
    Err(NoCurve::NotFound {
        wanted,
        index,
        found,
        end: match &branch.progress().end {
            Some(legs::RunEnd::Failed(reason)) => format!("; it ended before its range: {reason}"),
            _ => String::new(),
        },
    })
}

/// Follows the branch of a problem, which `begin` begins, to the event that its curve begins with. `watch`
/// sees the branch after every step.
///
/// # Errors
/// When the branch does not begin or does not have the event, when that lies outside the ranges,
/// or when its equations are singular.
pub fn find(
    problem: &Problem,
    curve: &problem::CurveSection,
    begin: impl FnOnce(&Problem) -> Result<WaveRunner, RunError>,
    watch: &mut dyn FnMut(&WaveRunner),
) -> Result<CurveStart, NoCurve> {
    let mut plain = problem.clone();
    plain.output.profiles = 0;
    plain.output.conditioning = false;
    // spectra are wanted for the sake of Hopf points only, in their sector only
    let section = problem.stability.clone();
    let section = section.unwrap_or_else(|| StabilitySection::of(&problem.model));
    let of_sector = StabilitySection {
        sectors: Sectors::Only(vec![curve.sector]),
        ..section
    };
    let kind = curve.event.kind();
    plain.stability = (kind == Some(EventType::HB)).then_some(of_sector);
    let branch = begin(&plain).map_err(NoCurve::Run)?;
    let mut wanted = kind.map_or_else(String::new, |kind| kind.to_string());
    if kind == Some(EventType::HB) {
        wanted.push_str(&format!(" of sector {}", curve.sector));
    }
    let of = |item: &WaveItem| item.point.kind;
    let item = event::<WavesInPlane, WaveRunner>(branch, (kind, curve.index), wanted, of, watch)?;
    of_branch(&item, curve)
}

/// Follows the branch of a problem with a system, which `begin` begins, to the event that its curve begins with.
///
/// # Errors
/// As [`find`].
pub fn find_of_system(
    problem: &SystemProblem,
    curve: &SystemCurve,
    begin: impl FnOnce(&SystemProblem) -> Result<hybrid::OrbitRunner, hybrid::NoFirstPoint>,
    watch: &mut dyn FnMut(&hybrid::OrbitRunner),
) -> Result<CurveStart<OrbitsInPlane>, NoCurve<OrbitsInPlane>> {
    let item = found(problem, curve, begin, watch)?;
    let (orbit, point) = item.orbit();
    let kept = match &curve.event {
        SystemCurveEvent::Constant(name) => Some(kept_at(&item, name)?),
        _ => None,
    };
    let kind = match kept {
        Some(_) => EventType::UZ,
        None => item.point.kind.unwrap_or(EventType::EP),
    };
    pose_orbit(orbit, point, (kind, kept), curve)
}

/// The same for the saddle of a homoclinic orbit.
///
/// # Errors
/// As [`find`].
pub fn find_connection(
    problem: &SystemProblem,
    curve: &SystemCurve,
    begin: impl FnOnce(&SystemProblem) -> Result<hybrid::OrbitRunner, hybrid::NoFirstPoint>,
    watch: &mut dyn FnMut(&hybrid::OrbitRunner),
) -> Result<CurveStart<EquilibriaInPlane>, NoCurve<OrbitsInPlane>> {
    let item = found(problem, curve, begin, watch)?;
    let (orbit, point) = item.orbit();
    pose_connection(orbit, point, curve)
}

/// The event of the branch of a problem with a system.
fn found(
    problem: &SystemProblem,
    curve: &SystemCurve,
    begin: impl FnOnce(&SystemProblem) -> Result<hybrid::OrbitRunner, hybrid::NoFirstPoint>,
    watch: &mut dyn FnMut(&hybrid::OrbitRunner),
) -> Result<hybrid::OrbitItem, NoCurve<OrbitsInPlane>> {
    let mut plain = problem.clone();
    plain.output.profiles = 0;
    let kind = curve.event.kind();
    let of_spectrum = kind.is_some_and(EventType::of_spectrum);
    plain.stability = of_spectrum.then(problem::Multipliers::default);
    let branch = begin(&plain).map_err(NoCurve::Run)?;
    let mut wanted = kind.map_or_else(String::new, |kind| kind.to_string());
    let kept = match &curve.event {
        SystemCurveEvent::Constant(name) => Some(name),
        _ => None,
    };
    if let Some(name) = kept {
        wanted.push_str(&format!(" of {name}"));
    }
    let of = |item: &hybrid::OrbitItem| match (kept, &item.special) {
        (None, _) => item.point.kind,
        (Some(name), Some(Special::Monitor(known, _))) if known == name => Some(EventType::UZ),
        // a value that nothing asks for is that of the first point
        (Some(name), Some(Special::Start)) if !asks_for(problem, name) => Some(EventType::UZ),
        _ => None,
    };
    event::<OrbitsInPlane, hybrid::OrbitRunner>(branch, (kind, curve.index), wanted, of, watch)
}

/// Whether the branch of a problem asks for a value of a monitor.
fn asks_for(problem: &SystemProblem, name: &str) -> bool {
    let stops = problem.continuation.iter().flat_map(|one| &one.stop_at);
    let mut stops = stops.filter_map(|stop| match stop {
        UserPoint::Monitor(known, _) => Some(known),
        UserPoint::Parameter(_) => None,
    });
    stops.any(|known| known == name)
}

/// The monitor of this name with its value at a point of a branch: the one that was asked for, if any was.
fn kept_at(item: &hybrid::OrbitItem, name: &str) -> Result<FixedMonitor, NoCurve<OrbitsInPlane>> {
    let (orbit, _) = item.orbit();
    let mut monitors = orbit.setting.system.monitors().iter();
    let monitor = monitors.find(|one| one.name == name).cloned();
    let value = match &item.special {
        Some(Special::Monitor(_, value)) => Some(*value),
        _ => {
            let mut values = item.point.monitors.iter();
            values
                .find(|(known, _)| known == name)
                .and_then(|(_, value)| *value)
        }
    };
    let kept = monitor.zip(value);
    let kept = kept.map(|(monitor, value)| FixedMonitor { monitor, value });
    kept.ok_or(NoCurve::Singular(Singular::NoValue))
}
