//! Waves of a tube by every method, and single ones by the discretised ring.

use std::cell::OnceCell;
use std::time::Instant;

use super::measure::{
    MeasuredBranch, MeasuredFamily, Missed, Repeats, eigenvalue_error, in_time, timed, with_stops,
    worst,
};
use super::rung::{Rung, RungRow, ladder, reference_method};
use nalgebra::Complex;

use crate::branch::run::WaveRunner;
use crate::discretised;
use crate::linalg::Vector;
use crate::problem::{Continuation, Problem};
use crate::tube::flow::method::Method;
use crate::tube::model::FrictionLaw;
use crate::tube::model::signature::{Regime, Signature};
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::spectrum::{SpectrumRequest, spectrum};
use crate::tube::wave::start::{self, SlipStick};
use crate::tube::wave::{Wave, precise, profile};

/// A wave at a value of the parameter that every method meets exactly.
pub(crate) struct ComparedWave {
    wave: Wave,
    point: Vector,
    /// Leading eigenvalues, sector by sector, made when first asked for.
    leading: OnceCell<Option<Vec<Vec<Complex<f64>>>>>,
}

impl ComparedWave {
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

/// Leading eigenvalues compared in each sector.
const LEADING: usize = 1;

/// Largest |Im λ| of the eigenvalues compared.
const HIGHEST: f64 = 8.0;

/// A branch of waves.
pub(crate) struct WaveBranch {
    problem: Problem,
    continuation: Continuation,
}

impl WaveBranch {
    /// The problem as every method follows it: without stability and profiles.
    pub(crate) fn new(problem: &Problem, continuation: &Continuation) -> WaveBranch {
        let mut problem = problem.clone();
        problem.stability = None;
        problem.output = Default::default();
        problem.expect.clear();
        WaveBranch {
            problem,
            continuation: with_stops(continuation),
        }
    }
}

impl MeasuredFamily for WaveBranch {
    type Compared = ComparedWave;

    fn ladder(&self) -> Vec<Rung> {
        ladder(self.problem.model.law)
    }

    fn reference(&self) -> Rung {
        Rung::Flow(reference_method(self.problem.model.law))
    }

    fn remark(&self) -> &'static str {
        if self.problem.model.law.piecewise_linear() {
            "Errors are against the exact flow, those of the exact flow against the closed form in \
             higher precision."
        } else {
            "Errors are against collocation of high order on a fine mesh: this friction law has no \
             exact flow."
        }
    }

    fn follow(
        &self,
        rung: Rung,
        until: Option<Instant>,
    ) -> Result<MeasuredBranch<ComparedWave>, Missed> {
        let mut problem = self.problem.clone();
        if let Rung::Flow(method) = rung {
            problem.method = Some(method);
        }
        let branch = WaveRunner::begin(&problem, &self.continuation, None)?;
        MeasuredBranch::collect(
            branch,
            until,
            |item| {
                let (wave, point) = item.wave();
                Some((item.point.kind?, wave.parameter_at(point)))
            },
            |item| {
                let (wave, point) = item.wave();
                Some(ComparedWave {
                    leading: OnceCell::new(),
                    wave: wave.clone(),
                    point: point.clone(),
                })
            },
        )
    }

    fn row(
        &self,
        rung: Rung,
        reference: &MeasuredBranch<ComparedWave>,
        repeats: Repeats,
    ) -> Result<RungRow, Missed> {
        match rung {
            Rung::Ring { points, epsilon } => ring_row(points, epsilon, reference, repeats),
            _ => self.flow_row(rung, reference, repeats),
        }
    }
}

impl WaveBranch {
    fn flow_row(
        &self,
        rung: Rung,
        reference: &MeasuredBranch<ComparedWave>,
        repeats: Repeats,
    ) -> Result<RungRow, Missed> {
        let (seconds, found) = timed(repeats, || self.follow(rung, repeats.until))?;
        let mut row = found.row(rung, reference, seconds);
        let exact = rung == Rung::Flow(Method::Exact);
        if exact && self.problem.model.law == FrictionLaw::Coulomb {
            let waves = found.compared.iter();
            let precise: Vec<(f64, f64)> = waves.filter_map(against_closed_form).collect();
            row.speed_error = worst(precise.iter().map(|errors| errors.0));
            row.switch_error = worst(precise.iter().map(|errors| errors.1));
            // its events are those of the reference itself
            row.event_error = None;
            return Ok(row);
        }
        let pairs = || {
            let pairs = reference.compared.iter().zip(&found.compared);
            pairs.filter(|(one, other)| one.wave.signature == other.wave.signature)
        };
        row.speed_error =
            worst(pairs().map(|(one, other)| (other.speed() / one.speed() - 1.0).abs()));
        row.switch_error = worst(pairs().flat_map(|(one, other)| {
            let switches = one.switches();
            let wavelength = switches.last().copied().unwrap_or(1.0);
            let both = switches.into_iter().zip(other.switches());
            both.map(move |(one, other)| (one - other).abs() / wavelength)
        }));
        let mut errors = Vec::new();
        for (one, other) in pairs() {
            in_time(repeats.until)?;
            let both = one.leading().zip(other.leading());
            errors.extend(both.and_then(|(one, other)| eigenvalue_error(one, other)));
        }
        row.eigenvalue_error = worst(errors.into_iter());
        Ok(row)
    }
}

fn leading(wave: &Wave, point: &Vector) -> Option<Vec<Vec<Complex<f64>>>> {
    let characteristic = Characteristic::new(wave, point).ok()?;
    let request = SpectrumRequest {
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

/// Relative error of c and of the zone lengths of a slip-stick wave against the closed form in
/// higher precision.
fn against_closed_form(compared: &ComparedWave) -> Option<(f64, f64)> {
    let ComparedWave { wave, point, .. } = compared;
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
    reference: &MeasuredBranch<ComparedWave>,
    repeats: Repeats,
) -> Result<RungRow, Missed> {
    let rung = Rung::Ring { points, epsilon };
    let waves: Vec<&ComparedWave> = reference
        .compared
        .iter()
        .filter(|compared| !compared.wave.signature.has(Regime::Separation))
        .collect();
    if waves.is_empty() {
        return Ok(RungRow::failed(
            rung,
            reference.events.len(),
            Some("every wave has separation".into()),
        ));
    }
    let settings = discretised::RingSettings {
        points,
        epsilon,
        which: start::Which::Fast,
        ..discretised::RingSettings::default()
    };
    let solve = || -> Result<Vec<_>, Missed> {
        let solved = waves.iter().map(|compared| {
            in_time(repeats.until)?;
            let ComparedWave { wave, point, .. } = compared;
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
    Ok(RungRow {
        points: waves.len(),
        speed_error: worst(
            pairs().map(|(compared, ring)| (ring.speed / compared.speed() - 1.0).abs()),
        ),
        eigenvalue_error: worst(errors.into_iter()),
        events_expected: 0,
        ..RungRow::failed(rung, reference.events.len(), None)
    }
    .took(seconds))
}
