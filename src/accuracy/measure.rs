//! The branch or the waves of one rung, compared with the reference.

use crate::orbit::legs::Run as _;
use std::cell::OnceCell;
use std::time::Instant;

use super::rung::{Row, Rung};
use nalgebra::Complex;

use crate::branch::run::{End, RunError, Runner};
use crate::discretised;
use crate::linalg::Vector;
use crate::orbit::EventType;
use crate::problem::{Continuation, Problem};
use crate::tube::flow::method::Method;
use crate::tube::model::FrictionLaw;
use crate::tube::model::signature::{Regime, Signature};
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::spectrum::{Request, spectrum};
use crate::tube::wave::start::{self, SlipStick};
use crate::tube::wave::{Wave, precise, profile};

/// A wave at a value of the parameter that every method meets exactly.
struct Compared {
    wave: Wave,
    point: Vector,
    /// Leading eigenvalues, sector by sector, made when first asked for.
    leading: OnceCell<Option<Vec<Vec<Complex<f64>>>>>,
}

impl Compared {
    fn leading(&self) -> Option<&Vec<Vec<Complex<f64>>>> {
        let made = || leading(&self.wave, &self.point);
        self.leading.get_or_init(made).as_ref()
    }

    fn speed(&self) -> f64 {
        self.wave.speed_at(&self.point)
    }

    /// Ends of the zones; the last one is the wavelength.
    fn switches(&self) -> Vec<f64> {
        profile::switches(&self.wave, &self.point)
    }
}

/// A branch followed by one method.
pub(crate) struct Followed {
    points: usize,
    events: Vec<(EventType, f64)>,
    waves: Vec<Compared>,
    failed: Option<String>,
}

/// Leading eigenvalues compared in each sector.
const LEADING: usize = 1;

/// Largest |Im λ| of the eigenvalues compared.
const HIGHEST: f64 = 8.0;

/// The problem as every method follows it: without stability and profiles, with a few user points
/// if it has none.
pub(crate) fn stripped(problem: &Problem, continuation: &Continuation) -> (Problem, Continuation) {
    let mut problem = problem.clone();
    problem.stability = None;
    problem.output = Default::default();
    problem.expect.clear();
    let mut continuation = continuation.clone();
    if continuation.stop_at.is_empty() {
        let (low, high) = continuation.range;
        continuation.stop_at = [0.25, 0.5, 0.75]
            .map(|share| low + share * (high - low))
            .to_vec();
    }
    (problem, continuation)
}

/// Why a method has no answer.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Missed {
    /// The branch does not begin.
    #[error("{0}")]
    Run(#[from] RunError),
    /// The ring is not solved.
    #[error("{0}")]
    Ring(#[from] discretised::Error),
    #[error("the time is over")]
    Time,
}

/// Whether a time has come; there may be none.
fn in_time(until: Option<Instant>) -> Result<(), Missed> {
    match until {
        Some(until) if Instant::now() >= until => Err(Missed::Time),
        _ => Ok(()),
    }
}

/// Follows the branch by a method, until its end or a time.
///
/// # Errors
/// When it does not begin, or not end in time.
pub(crate) fn follow(
    problem: &Problem,
    continuation: &Continuation,
    method: Method,
    until: Option<Instant>,
) -> Result<Followed, Missed> {
    let mut problem = problem.clone();
    problem.method = Some(method);
    let mut branch = Runner::begin(&problem, continuation, None)?;
    let mut followed = Followed {
        points: 0,
        events: Vec::new(),
        waves: Vec::new(),
        failed: None,
    };
    while branch.progress().end.is_none() {
        in_time(until)?;
        for item in branch.step() {
            followed.points += 1;
            let Some(kind) = item.point.kind else {
                continue;
            };
            let (wave, point) = item.wave();
            if !matches!(kind, EventType::UZ | EventType::EP | EventType::MX) {
                followed.events.push((kind, wave.parameter_at(point)));
            }
            if matches!(kind, EventType::UZ | EventType::EP) {
                followed.waves.push(Compared {
                    leading: OnceCell::new(),
                    wave: wave.clone(),
                    point: point.clone(),
                });
            }
        }
    }
    if let Some(End::Failed(reason)) = &branch.progress().end {
        followed.failed = Some(reason.to_string());
    }
    Ok(followed)
}

fn leading(wave: &Wave, point: &Vector) -> Option<Vec<Vec<Complex<f64>>>> {
    let characteristic = Characteristic::new(wave, point).ok()?;
    let request = Request {
        sectors: (0..=wave.mode as usize / 2).collect(),
        eigenvalues: LEADING,
        max_frequency: HIGHEST,
    };
    let spectrum = spectrum(&characteristic, &request, None);
    Some(
        spectrum
            .sectors
            .iter()
            .map(|sector| {
                let listed = spectrum.listed(sector).take(LEADING);
                listed.map(|eigenvalue| eigenvalue.value()).collect()
            })
            .collect(),
    )
}

/// Largest of the errors, if there is any.
fn worst(errors: impl Iterator<Item = f64>) -> Option<f64> {
    errors.reduce(f64::max)
}

/// Largest distance of the reference's leading eigenvalues from the nearest found.
fn eigenvalue_error(reference: &[Vec<Complex<f64>>], found: &[Vec<Complex<f64>>]) -> Option<f64> {
    worst(reference.iter().zip(found).flat_map(|(one, other)| {
        one.iter().filter_map(|value| {
            other
                .iter()
                .map(|candidate| (candidate - value).norm())
                .reduce(f64::min)
        })
    }))
}

/// How often a rung is repeated, and for how long at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Repeats {
    pub most: usize,
    /// Seconds after which no further one begins.
    pub seconds: f64,
    /// When no work of any kind goes on.
    pub until: Option<Instant>,
}

/// Runs a piece of work repeatedly; the median time and the first result.
fn timed<T>(repeats: Repeats, work: impl Fn() -> Result<T, Missed>) -> Result<(f64, T), Missed> {
    let begun = Instant::now();
    let first = work()?;
    let mut times = vec![begun.elapsed().as_secs_f64()];
    while times.len() < repeats.most && begun.elapsed().as_secs_f64() < repeats.seconds {
        let start = Instant::now();
        if work().is_err() {
            break;
        }
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok((times[times.len() / 2], first))
}

/// Measures one rung against the reference; none if the time does not suffice.
pub(crate) fn measure(
    problem: &Problem,
    continuation: &Continuation,
    rung: Rung,
    reference: &Followed,
    repeats: Repeats,
) -> Option<Row> {
    let row = match rung {
        Rung::Flow(method) => flow_row(problem, continuation, method, reference, repeats),
        Rung::Ring { points, epsilon } => ring_row(points, epsilon, reference, repeats),
    };
    match row {
        Err(Missed::Time) => None,
        Err(error) => Some(Row::failed(
            rung,
            reference.events.len(),
            Some(error.to_string()),
        )),
        Ok(row) => Some(row),
    }
}

fn flow_row(
    problem: &Problem,
    continuation: &Continuation,
    method: Method,
    reference: &Followed,
    repeats: Repeats,
) -> Result<Row, Missed> {
    let rung = Rung::Flow(method);
    let work = || follow(problem, continuation, method, repeats.until);
    let (seconds, found) = timed(repeats, work)?;
    let mut row = Row {
        points: found.points,
        events_found: found.events.len(),
        failure: found.failed.clone(),
        ..Row::failed(rung, reference.events.len(), None)
    }
    .took(seconds);
    if method == Method::Exact && problem.model.law == FrictionLaw::Coulomb {
        let precise: Vec<(f64, f64)> = found.waves.iter().filter_map(against_closed_form).collect();
        row.speed_error = worst(precise.iter().map(|errors| errors.0));
        row.switch_error = worst(precise.iter().map(|errors| errors.1));
        return Ok(row);
    }
    let pairs = || {
        let pairs = reference.waves.iter().zip(&found.waves);
        pairs.filter(|(one, other)| one.wave.signature == other.wave.signature)
    };
    row.speed_error = worst(pairs().map(|(one, other)| (other.speed() / one.speed() - 1.0).abs()));
    row.switch_error = worst(pairs().flat_map(|(one, other)| {
        let switches = one.switches();
        let wavelength = switches.last().copied().unwrap_or(1.0);
        let both = switches.into_iter().zip(other.switches());
        both.map(move |(one, other)| (one - other).abs() / wavelength)
    }));
    let same = reference.events.len() == found.events.len()
        && (reference.events.iter().zip(&found.events)).all(|(one, other)| one.0 == other.0);
    if same {
        let both = reference.events.iter().zip(&found.events);
        row.event_error = worst(both.map(|(one, other)| (other.1 / one.1 - 1.0).abs()));
    } else if row.failure.is_none() {
        row.failure = Some("not the events of the reference".into());
    }
    let mut errors = Vec::new();
    for (one, other) in pairs() {
        in_time(repeats.until)?;
        let both = one.leading().zip(other.leading());
        errors.extend(both.and_then(|(one, other)| eigenvalue_error(one, other)));
    }
    row.eigenvalue_error = worst(errors.into_iter());
    Ok(row)
}

/// Relative error of c and of the zone lengths of a slip-stick wave against the closed form in
/// higher precision.
fn against_closed_form(compared: &Compared) -> Option<(f64, f64)> {
    let Compared { wave, point, .. } = compared;
    // with material damping there is no closed form
    if wave.signature != Signature::slip_stick() || wave.material {
        return None;
    }
    let zones = wave.unpack(point);
    let near = SlipStick {
        excess: wave.excess_at(point),
        speed: compared.speed(),
        slip: zones[0].duration,
        stick: zones[1].duration,
        least_rate: f64::NAN,
        release: zones[0].entry[0],
    };
    let exact = precise::slip_stick(&wave.model_at(point), wave.mode, &near)?;
    let speed = (compared.speed() / exact.speed - 1.0).abs();
    let period = exact.slip + exact.stick;
    let switch = (near.slip - exact.slip).abs() / period;
    Some((speed, switch))
}

fn ring_row(
    points: usize,
    epsilon: f64,
    reference: &Followed,
    repeats: Repeats,
) -> Result<Row, Missed> {
    let rung = Rung::Ring { points, epsilon };
    let waves: Vec<&Compared> = reference
        .waves
        .iter()
        .filter(|compared| !compared.wave.signature.has(Regime::Separation))
        .collect();
    if waves.is_empty() {
        return Ok(Row::failed(
            rung,
            reference.events.len(),
            Some("every wave has separation".into()),
        ));
    }
    let settings = discretised::Settings {
        points,
        epsilon,
        which: start::Which::Fast,
        ..discretised::Settings::default()
    };
    let solve = || -> Result<Vec<_>, Missed> {
        let solved = waves.iter().map(|compared| {
            in_time(repeats.until)?;
            let Compared { wave, point, .. } = compared;
            Ok(discretised::solve_from(wave, point, &settings)?)
        });
        solved.collect()
    };
    let (seconds, rings) = timed(repeats, solve)?;
    let pairs = || waves.iter().zip(&rings);
    let mut errors = Vec::new();
    for (compared, ring) in pairs() {
        let Some(exact) = compared.leading() else {
            continue;
        };
        let mut found: Vec<Vec<Complex<f64>>> = Vec::new();
        for sector in 0..exact.len() {
            in_time(repeats.until)?;
            if let Ok(values) = ring.eigenvalues(sector as u32, 2.0 * HIGHEST, usize::MAX) {
                found.push(values.iter().map(|v| Complex::new(v.re, v.im)).collect());
            }
        }
        if found.len() == exact.len() {
            errors.extend(eigenvalue_error(exact, &found));
        }
    }
    Ok(Row {
        points: waves.len(),
        speed_error: worst(
            pairs().map(|(compared, ring)| (ring.speed / compared.speed() - 1.0).abs()),
        ),
        eigenvalue_error: worst(errors.into_iter()),
        events_expected: 0,
        ..Row::failed(rung, reference.events.len(), None)
    }
    .took(seconds))
}
