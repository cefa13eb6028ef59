//! The event that a curve begins with, looked for along a branch: followed step by step until it has the event of this type and
//! number, with no more of its spectra than the event needs.

use std::fmt::Display;

use super::Singular;
use super::equilibria::EquilibriaInPlane;
use super::orbits::OrbitsInPlane;
use super::plane::ParameterPlane;
use super::start::{CurveStart, FixedMonitor, NoCurve, of_branch, pose_connection, pose_orbit};
use super::tube::WavesInPlane;
use crate::affine::monitor::Monitor;
use crate::branch::run::{RunError, WaveItem, WaveRunner};
use crate::hybrid;
use crate::orbit::legs::{self, Run};
use crate::orbit::special::Special;
use crate::orbit::{EventType, Orbit};
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
    let kept = KeptMonitor::of(problem, curve);
    let kept =
        kept.map(|kept| kept.at::<OrbitsInPlane>(item.special.as_ref(), &item.point.monitors));
    let kept = kept.transpose()?;
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
    let kept = KeptMonitor::of(problem, curve);
    let wanted = wanted(kind, kept.as_ref());
    let of = |item: &hybrid::OrbitItem| match &kept {
        None => item.point.kind,
        Some(kept) => kept.event(item.special.as_ref()),
    };
    event::<OrbitsInPlane, hybrid::OrbitRunner>(branch, (kind, curve.index), wanted, of, watch)
}

/// The event that a curve begins with, as it is called where it is not found.
pub(super) fn wanted(kind: Option<EventType>, kept: Option<&KeptMonitor>) -> String {
    let kind = kind.map_or_else(String::new, |kind| kind.to_string());
    match kept {
        Some(kept) => format!("{kind} of {}", kept.monitor.name),
        None => kind,
    }
}

/// The monitor that is constant along a curve.
pub(super) struct KeptMonitor {
    monitor: Monitor,
    /// Whether the branch asks for a value of it.
    is_asked_for: bool,
}

impl KeptMonitor {
    /// That of a curve; `None` where it is the curve of an event.
    pub(super) fn of(problem: &SystemProblem, curve: &SystemCurve) -> Option<KeptMonitor> {
        let SystemCurveEvent::Constant(name) = &curve.event else {
            return None;
        };
        let stops = problem.continuation.iter().flat_map(|one| &one.stop_at);
        let mut stops = stops.filter_map(|stop| match stop {
            UserPoint::Monitor(known, _) => Some(known),
            UserPoint::Parameter(_) => None,
        });
        let mut monitors = problem.monitors().into_iter();
        Some(KeptMonitor {
            monitor: monitors.find(|one| one.name == *name)?,
            is_asked_for: stops.any(|known| known == name),
        })
    }

    /// The event that a point of a branch is for the curve: a value that nothing asks for is that of the first point.
    pub(super) fn event<O: Orbit>(&self, special: Option<&Special<O>>) -> Option<EventType> {
        let begins = match special {
            Some(Special::Monitor(known, _)) => *known == self.monitor.name,
            Some(Special::Start) => !self.is_asked_for,
            _ => false,
        };
        begins.then_some(EventType::UZ)
    }

    /// It with its value at a point of a branch where monitors have these: the one that was asked for, if any was.
    ///
    /// # Errors
    /// It has no value there.
    pub(super) fn at<P: ParameterPlane>(
        self,
        special: Option<&Special<P::Orbit>>,
        monitors: &[(String, Option<f64>)],
    ) -> Result<FixedMonitor, Singular<P>> {
        let own =
            |(known, value): &(String, Option<f64>)| value.filter(|_| *known == self.monitor.name);
        let value = match special {
            Some(Special::Monitor(_, value)) => Some(*value),
            _ => monitors.iter().find_map(own),
        };
        let value = value.ok_or(Singular::NoValue)?;
        Ok(FixedMonitor {
            monitor: self.monitor,
            value,
        })
    }
}
