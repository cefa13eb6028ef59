//! The event that a curve begins with, found on a branch.

use super::equilibria::{CriticalEquilibrium, EquilibriaInPlane};
use super::orbits::{MultiplierEvent, OrbitsInPlane};
use super::plane::{
    EventCondition, EventCurves, MarginOf, ParameterPlane, PlaneOfOrbits, SpectralEvents,
};
use super::system::EventSystem;
use super::tube::{BlochPair, WavesInPlane};
use super::{CurveLimits, Singular};
use crate::affine::equilibrium::EquilibriumCurve;
use crate::affine::equilibrium::start::EquilibriumRequest;
use crate::affine::monitor::Monitor;
use crate::affine::orbit::AffineOrbit;
use crate::affine::orbit::start::saved as posed;
use crate::branch::SavedWave;
use crate::branch::run::WaveItem;
use crate::continuation::newton;
use crate::hybrid::{self, LabelledOrbit};
use crate::linalg::{self, Vector};
use crate::orbit::monitor::MonitorStop;
use crate::orbit::{Covers, EventType, Examined, MarginFunction, Zones};
use crate::problem::{self, Problem, SystemCurve, SystemProblem};
use crate::tube::model::Parameter;
use crate::tube::wave::Wave;

/// Settings of Newton's method for the first point of a curve of connections, which the end of a branch has told but for
/// rounding.
const BEGINS: newton::Settings = newton::Settings {
    tolerance: 1e-12,
    most_iterations: 12,
    halvings: 0,
    polish: 1,
};

/// Why there is no curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoCurve<P: ParameterPlane = WavesInPlane> {
    /// The branch does not begin.
    #[error("{0}")]
    Run(P::NoBranch),
    /// The branch has no such event.
    #[error(
        "the branch has {found} events of the kind asked for, {wanted}, and not number {index}{end}"
    )]
    NotFound {
        /// Kind asked for.
        wanted: String,
        /// Number asked for.
        index: usize,
        /// How many there are.
        found: usize,
        /// Why the branch went no further.
        end: String,
    },
    /// The label is no event that has a curve.
    #[error("label {label} is of type {kind}; curves follow {}", list(P::FOLLOWED))]
    Kind {
        /// Label.
        label: usize,
        /// Its type.
        kind: EventType,
    },
    /// The event lies outside the ranges of the curve.
    #[error(
        "the event lies at {name} = {value}, outside the range from {low} to {high} of the curve; \
         widen it"
    )]
    Outside {
        /// Parameter.
        name: String,
        /// Its value at the event.
        value: f64,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// A BP of an orbit without the symmetry that makes a curve of it.
    #[error(
        "the BP is no loss of symmetry: half a period later its orbit is not the same with some signs changed, and other BP have no \
         curve"
    )]
    NotSymmetric,
    /// A BP of a symmetric orbit in a parameter with which the system has no symmetry.
    #[error(
        "with `{parameter}` the system is not symmetric: the BP is a point of the plane and has no curve"
    )]
    Unfolds {
        /// Parameter.
        parameter: String,
    },
    /// An HC whose connection is not known.
    #[error(
        "the curve cannot begin: the orbit that leaves the saddle is not found to return, so that the HC has no equations; the HC \
         of a saddle-node is an LP of its equilibria, that of an orbit which rests where it would switch a BE: their branches \
         have curves of these"
    )]
    NoConnection,
    /// The equations of the event cannot be posed or solved.
    #[error("the curve cannot begin: {0}")]
    Singular(Singular<P>),
}

impl<P: ParameterPlane> From<Singular<P>> for NoCurve<P> {
    fn from(reason: Singular<P>) -> NoCurve<P> {
        NoCurve::Singular(reason)
    }
}

/// Types in a sentence.
fn list(kinds: &[EventType]) -> String {
    let words: Vec<String> = kinds.iter().map(EventType::to_string).collect();
    match words.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, before)) => format!("{} and {last}", before.join(", ")),
        None => String::new(),
    }
}

/// An event ready to be followed.
#[derive(Clone, Debug)]
pub struct CurveStart<P: ParameterPlane = WavesInPlane> {
    /// Its type.
    pub event: EventType,
    /// Its equations.
    pub system: EventSystem<P>,
    /// Their solution on the branch.
    pub point: Vector,
    /// How far to follow.
    pub limits: CurveLimits,
}

/// A scaled margin below this vanishes at a located event.
const VANISHED: f64 = 1e-9;

/// So far beside an event, in the ranges of the parameters, orbits are looked at for their symmetry: what an image does not solve
/// is of that size.
const BESIDE: f64 = 1e-3;

/// A monitor with the value that it keeps.
pub(super) struct FixedMonitor {
    pub(super) monitor: Monitor,
    pub(super) value: f64,
}

/// A start where the margin of an event vanishes at orbits that are their own image: the equations of half of them, whose
/// solutions beside the event solve all of them.
fn symmetric(
    start: CurveStart<OrbitsInPlane>,
    orbit: &AffineOrbit,
    point: &Vector,
) -> CurveStart<OrbitsInPlane> {
    /// An orbit of half the equations solves all of them to this.
    const SOLVED: f64 = 1e-9;
    let EventCondition::Margin(_) = &start.system.condition else {
        return start;
    };
    let Some(kept) = orbit.symmetry(point) else {
        return start;
    };
    let plane = start.system.plane.clone().symmetric(kept);
    let signature = start.system.signature().clone();
    let half = EventSystem::new(plane, signature, start.system.condition.clone());
    let solves_all = |(index, by): (usize, f64)| {
        let index = start.point.len() - 1 - index;
        let mut beside = newton::Fixed {
            index,
            value: start.point[index] + by,
        };
        let solved = newton::solve(&half, &mut beside, &start.point, &BEGINS).ok()?;
        let (all, _) = start.system.orbit_equations(&solved.point).ok()?;
        Some(all.amax() <= SOLVED)
    };
    // a parameter may have its least or largest value at the event
    let mut places = [(0, BESIDE), (0, -BESIDE), (1, BESIDE), (1, -BESIDE)].into_iter();
    match places.find_map(solves_all) {
        Some(true) => CurveStart {
            system: half,
            ..start
        },
        _ => start,
    }
}

/// The event of a system that an earlier run labelled, with its saved orbit.
///
/// # Errors
/// As [`labelled`].
pub fn labelled_of_system(
    problem: &SystemProblem,
    saved: &LabelledOrbit,
    kind: EventType,
    curve: &SystemCurve,
) -> Result<CurveStart<OrbitsInPlane>, NoCurve<OrbitsInPlane>> {
    let label = saved.label;
    if !OrbitsInPlane::FOLLOWED.contains(&kind) {
        return Err(NoCurve::Kind { label, kind });
    }
    let (orbit, point) = posed_in_first(problem, saved, curve)?;
    pose_orbit(&orbit, &point, (kind, None), curve)
}

/// The same for the saddle of a homoclinic orbit.
///
/// # Errors
/// As [`labelled`].
pub fn labelled_connection(
    problem: &SystemProblem,
    saved: &LabelledOrbit,
    curve: &SystemCurve,
) -> Result<CurveStart<EquilibriaInPlane>, NoCurve<OrbitsInPlane>> {
    let (orbit, point) = posed_in_first(problem, saved, curve)?;
    pose_connection(&orbit, &point, curve)
}

/// A saved orbit, posed in the first parameter of a curve.
fn posed_in_first(
    problem: &SystemProblem,
    saved: &LabelledOrbit,
    curve: &SystemCurve,
) -> Result<(AffineOrbit, Vector), NoCurve<OrbitsInPlane>> {
    let first = &curve.parameters.0;
    let (low, high) = curve.range.0;
    let none = |reason| NoCurve::Run(hybrid::NoFirstPoint::NoOrbit(reason));
    let parameter = problem.system.source.parameters.index(first);
    let parameter = parameter.ok_or(NoCurve::Run(hybrid::NoFirstPoint::Unknown))?;
    let prescribed = problem.prescribed();
    let posed = posed(
        &problem.system,
        &saved.orbit,
        parameter,
        high - low,
        prescribed,
    );
    posed.map_err(none)
}

/// The equations of the saddle that an orbit comes to.
pub(super) fn pose_connection(
    orbit: &AffineOrbit,
    point: &Vector,
    section: &SystemCurve,
) -> Result<CurveStart<EquilibriaInPlane>, NoCurve<OrbitsInPlane>> {
    let limits = CurveLimits::of(section);
    let (connection, connected) = orbit.homoclinic(point).ok_or(NoCurve::NoConnection)?;
    let setting = &orbit.setting;
    let parameters = &setting.system.source.parameters;
    let (first, second) = &section.parameters;
    let pair = parameters.index(first).zip(parameters.index(second));
    let (one, other) = pair.ok_or(NoCurve::Run(hybrid::NoFirstPoint::Unknown))?;
    let saddle = &connection.ends()[0];
    let values = setting.values_at(connected.value * setting.scales.parameter);
    let request = EquilibriumRequest {
        system: setting.system.clone().with_monitors(Vec::new()),
        values,
        parameter: one,
        width: limits.widths()[0],
        mode: saddle.mode,
    };
    let none = |_| NoCurve::NoConnection;
    let (curve, at) = EquilibriumCurve::at(&request, &saddle.state).map_err(none)?;
    let plane = EquilibriaInPlane::new(&curve, &at, [one, other], limits.widths(), None);
    let plane = plane.map_err(none)?;
    within(&plane, &limits)?;
    let posed = plane.orbit(curve.signature(), plane.values(), 0);
    let posed = posed.map_err(none)?;
    let point = posed.pack(&saddle.state, plane.values()[0]);
    let spectral = CriticalEquilibrium::Connection(Box::new(connection));
    let condition = EventCondition::Spectral(spectral);
    let system = EventSystem::new(plane, curve.signature().clone(), condition);
    // what is asked of a branch at one value of the other parameter stays there
    let guess = system.pack(&point, &connected.turns);
    let index = guess.len() - 1;
    let mut kept = newton::Fixed {
        index,
        value: guess[index],
    };
    let solved = newton::solve(&system, &mut kept, &guess, &BEGINS);
    Ok(CurveStart {
        event: EventType::HC,
        point: solved.map_or(guess, |solution| solution.point),
        system,
        limits,
    })
}

/// The plane of a pair of multipliers; of orbits that are their own image in all of it where they are so at the event and
/// beside it.
fn of_pair(plane: OrbitsInPlane, orbit: &AffineOrbit, point: &Vector) -> OrbitsInPlane {
    let Some(kept) = orbit.symmetry(point) else {
        return plane;
    };
    let last = point.len() - 1;
    let beside = |index: usize| {
        let posed = plane.orbit(orbit.signature(), plane.values(), index).ok()?;
        let mut own = point.clone();
        own[last] = plane.values()[index] / plane.widths()[index] + BESIDE;
        let value = own[last];
        let mut level = newton::Fixed { index: last, value };
        let solved = newton::solve(&posed, &mut level, &own, &BEGINS).ok()?;
        posed.symmetry(&solved.point)
    };
    match [beside(0), beside(1)] == [Some(kept); 2] {
        true => plane.symmetric(kept),
        false => plane,
    }
}

/// The equations of an event of a system.
pub(super) fn pose_orbit(
    orbit: &AffineOrbit,
    point: &Vector,
    (kind, kept): (EventType, Option<FixedMonitor>),
    curve: &SystemCurve,
) -> Result<CurveStart<OrbitsInPlane>, NoCurve<OrbitsInPlane>> {
    // where a doubled orbit has become one of half its period the event is that of this one
    let half = Some(kind).filter(|kind| *kind == EventType::PD);
    let half = half.and_then(|_| orbit.part(point));
    let (orbit, point) = half
        .as_ref()
        .map_or((orbit, point), |(orbit, point)| (orbit, point));
    let limits = CurveLimits::of(curve);
    let parameters = &orbit.setting.system.source.parameters;
    let index = |name: &String| parameters.index(name).unwrap_or(0);
    let pair = [index(&curve.parameters.0), index(&curve.parameters.1)];
    let mut plane = OrbitsInPlane::new(orbit, point, pair, limits.widths());
    if let Some(FixedMonitor { monitor, value }) = kept {
        return pose_constant(plane.keeping(&monitor), (orbit, point), value, limits);
    }
    let spectral = match kind {
        EventType::PD => {
            let (matrix, _) = newton::jacobian(orbit, point).map_err(Singular::flow)?;
            let twice = matrix - orbit.closing(point).map_err(Singular::flow)? * 2.0;
            let square = twice.columns(0, twice.nrows()).clone_owned();
            let least = linalg::least(&square).ok_or(Singular::NoNullVector)?;
            let null = least.right.as_slice().to_vec();
            Some((MultiplierEvent::PeriodDoubling, null))
        }
        EventType::NS => {
            plane = of_pair(plane, orbit, point);
            Some((MultiplierEvent::Torus, Vec::new()))
        }
        EventType::BP => {
            let kept = orbit.symmetry(point).ok_or(NoCurve::NotSymmetric)?;
            for index in [0, 1] {
                let posed = plane.orbit(orbit.signature(), plane.values(), index);
                let posed = posed.map_err(Singular::flow)?;
                let mut own = point.clone();
                own[point.len() - 1] = plane.values()[index] / plane.widths()[index];
                if !posed.keeps_symmetry(&own) {
                    let parameter = plane.parameters()[index].clone();
                    return Err(NoCurve::Unfolds { parameter });
                }
            }
            Some((MultiplierEvent::Branching { kept }, Vec::new()))
        }
        _ => None,
    };
    let start = pose(plane, orbit, point, (kind, spectral), limits)?;
    Ok(symmetric(start, orbit, point))
}

/// The equations of an orbit at which the one monitor that is kept has a value.
pub(super) fn pose_constant<P: ParameterPlane>(
    plane: P,
    (orbit, point): (&P::Orbit, &Vector),
    value: f64,
    limits: CurveLimits,
) -> Result<CurveStart<P>, NoCurve<P>> {
    within(&plane, &limits)?;
    let constant = EventCondition::Constant(MonitorStop { monitor: 0, value });
    let system = EventSystem::new(plane, orbit.signature().clone(), constant);
    Ok(CurveStart {
        event: EventType::UZ,
        point: system.pack(point, &[]),
        system,
        limits,
    })
}

/// An event as a result folder tells it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labelled {
    /// Type.
    pub kind: EventType,
    /// Bloch sector of an HB.
    pub sector: usize,
    /// Im λ of an HB.
    pub omega: Option<f64>,
}

/// The event of a branch.
pub(super) fn of_branch(
    item: &WaveItem,
    curve: &problem::CurveSection,
) -> Result<CurveStart, NoCurve> {
    let (wave, point) = item.wave();
    let event = item.event.as_ref();
    let labelled = Labelled {
        kind: item.point.kind.unwrap_or(EventType::EP),
        sector: curve.sector,
        omega: event.and_then(|event| event.omega),
    };
    pose_wave(wave, point, labelled, curve)
}

/// The event that an earlier run labelled, with its saved wave.
///
/// # Errors
/// When the label is no event that can be followed, when it lies outside the ranges, or when its
/// equations are singular.
pub fn labelled(
    problem: &Problem,
    saved: &SavedWave,
    event: Labelled,
    curve: &problem::CurveSection,
) -> Result<CurveStart, NoCurve> {
    if !WavesInPlane::FOLLOWED.contains(&event.kind) {
        return Err(NoCurve::Kind {
            label: saved.label,
            kind: event.kind,
        });
    }
    let (low, high) = curve.range.0;
    let wave = saved.wave(curve.parameters.0, problem.wave.mode, high - low);
    let wave = match problem.method {
        Some(method) => wave.with_method(method),
        None => wave,
    };
    let value = saved.model.value(curve.parameters.0).unwrap_or(f64::NAN);
    let point = wave.pack(&saved.unknowns(), saved.excess, value);
    pose_wave(&wave, &point, event, curve)
}

/// The equations of an event of waves.
fn pose_wave(
    wave: &Wave,
    point: &Vector,
    event: Labelled,
    curve: &problem::CurveSection,
) -> Result<CurveStart, NoCurve> {
    let limits = CurveLimits::of(curve);
    let parameters = [curve.parameters.0, curve.parameters.1];
    let material = wave.material || parameters.contains(&Parameter::StiffnessDamping);
    let layered;
    let (wave, point) = if material && !wave.material {
        layered = wave.with_layers(point).map_err(Singular::flow)?;
        (&layered.0, &layered.1)
    } else {
        (wave, point)
    };
    let plane = WavesInPlane::new(wave, point, parameters, limits.widths());
    let spectral = (event.kind == EventType::HB).then(|| {
        let scaled = event.omega.unwrap_or(f64::NAN) / plane.frequency();
        let sector = event.sector;
        (BlochPair { sector }, vec![scaled])
    });
    pose(plane, wave, point, (event.kind, spectral), limits)
}

/// What of the spectrum makes an event, and its further unknowns.
pub(super) type OfSpectrum<P> = Option<(<P as SpectralEvents>::Spectral, Vec<f64>)>;

/// Refuses an event outside the ranges.
fn within<P: ParameterPlane, Q: ParameterPlane>(
    plane: &P,
    limits: &CurveLimits,
) -> Result<(), NoCurve<Q>> {
    let named = plane.parameters().into_iter().zip(plane.values());
    for ((parameter, value), (low, high)) in named.zip(limits.ranges) {
        if !(value >= low && value <= high) {
            return Err(NoCurve::Outside {
                name: P::Orbit::column(&parameter).to_owned(),
                value,
                low,
                high,
            });
        }
    }
    Ok(())
}

/// The equations of an event.
pub(super) fn pose<P: ParameterPlane>(
    plane: P,
    orbit: &P::Orbit,
    point: &Vector,
    (event, spectral): (EventType, OfSpectrum<P>),
    limits: CurveLimits,
) -> Result<CurveStart<P>, NoCurve<P>> {
    within(&plane, &limits)?;
    let (condition, further) = match (event, spectral) {
        (_, Some((spectral, further))) => (EventCondition::Spectral(spectral), further),
        (EventType::LP, None) => {
            let (matrix, _) = newton::jacobian(orbit, point).map_err(Singular::flow)?;
            let count = matrix.nrows();
            let least = linalg::least(&matrix.columns(0, count).clone_owned())
                .ok_or(Singular::NoNullVector)?;
            (EventCondition::Fold, least.right.as_slice().to_vec())
        }
        _ => return pose_margin(plane, orbit, point, event, limits),
    };
    let system = EventSystem::new(plane, orbit.signature().clone(), condition);
    Ok(CurveStart {
        event,
        point: system.pack(point, &further),
        system,
        limits,
    })
}

/// The equations of an event at which a margin vanishes.
pub(super) fn pose_margin<P: ParameterPlane>(
    plane: P,
    orbit: &P::Orbit,
    point: &Vector,
    event: EventType,
    limits: CurveLimits,
) -> Result<CurveStart<P>, NoCurve<P>> {
    within(&plane, &limits)?;
    let examination = orbit.examination(point).map_err(Singular::flow)?;
    let mut margins: Vec<MarginOf<P>> = examination
        .margins()
        .iter()
        .filter(|margin| margin.value().abs() < VANISHED)
        .cloned()
        .collect();
    // a zone without length says most, as on the branch
    margins.sort_by_key(MarginFunction::precedence);
    let margin = margins.first().cloned().ok_or(Singular::NoMargin)?;
    let system = EventSystem::new(
        plane,
        orbit.signature().clone(),
        EventCondition::Margin(margin),
    );
    Ok(CurveStart {
        event,
        point: system.pack(point, &[]),
        system,
        limits,
    })
}
