//! The slip-stick wave of a model under every friction law, as a boundary-value problem.

use super::wanted::{NoFirstWave, WaveRequest};
use crate::continuation::newton::{self, Equations, Fixed};
use crate::linalg::Vector;
use crate::tube::flow::{FlowError, Slide};
use crate::tube::model::signature::{Regime, Signature, WaveZone, ZoneEntry};
use crate::tube::model::{FrictionLaw, Model, Parameter};
use crate::tube::wave::Wave;
use crate::tube::wave::start;

/// Longest and shortest part of the way from Coulomb's law to the one asked for that is taken at once: a stiff wave, whose slip
/// grows a hundredfold, changes by its own size within a hundredth of it.
const LAW_STEP: f64 = 0.125;
const LEAST_LAW_STEP: f64 = 1e-5;

/// The slip-stick wave of a model as a boundary-value problem, admissible or not: in closed form
/// under Coulomb's law, and from there in steps of the law.
pub(super) fn slip_stick_wave(
    wanted: &WaveRequest,
    closed: &start::SlipStick,
) -> Result<(Wave, Vector), NoFirstWave> {
    let WaveRequest {
        ref model,
        parameter,
        ..
    } = *wanted;
    let value = model.value(parameter).unwrap_or(f64::NAN);
    let posed = |law: FrictionLaw| {
        Wave::new(
            Model { law, ..*model },
            parameter,
            wanted.mode,
            Signature::slip_stick(),
            wanted.scales(closed.excess, closed.least_rate),
        )
    };
    let mut wave = posed(FrictionLaw::Coulomb);
    let zones = [
        Slide::bare([closed.release, 1.0], closed.slip),
        Slide::bare([closed.release - closed.stick, 1.0], closed.stick),
    ];
    let mut guess = wave.pack(&zones, closed.excess, value);
    if wave.material {
        (wave, guess) = wave.with_layers(&guess)?;
    }
    let mut point = polish(&wave, &guess)?;
    if model.law == FrictionLaw::Coulomb {
        return Ok((wave, point));
    }
    if let FrictionLaw::Regularised { epsilon } = model.law {
        return smooth_wave(&wave, &point, parameter, epsilon);
    }
    let turned = |share: f64| {
        let partly = |ratio: f64| 1.0 + share * (ratio - 1.0);
        posed(match model.law {
            FrictionLaw::Static { ratio } => FrictionLaw::Static {
                ratio: partly(ratio),
            },
            FrictionLaw::Stribeck { ratio, velocity } => FrictionLaw::Stribeck {
                ratio: partly(ratio),
                velocity,
            },
            other => other,
        })
    };
    let (mut share, mut step) = (0.0, LAW_STEP);
    while share < 1.0 {
        let next = (share + step).min(1.0);
        match polish(&turned(next), &point) {
            Ok(found) => {
                (share, point) = (next, found);
                step = LAW_STEP.min(2.0 * step);
            }
            Err(reason) if step <= LEAST_LAW_STEP => return Err(reason),
            Err(_) => step *= 0.5,
        }
    }
    Ok((posed(model.law), point))
}

/// ε from which the regularised wave is reached if the one asked for is too far from Coulomb's, and
/// the factor from one to the next.
const FIRST_SMOOTHING: f64 = 0.01;
const SMOOTHING_STEP: f64 = 1.4;

/// The zones that a wave of Coulomb's law has under the regularised one: stick and both directions of
/// sliding are one zone of contact, cut where V̇ = 0 rises if the surface never separates.
fn smoothed(sharp: &Wave, at: &Vector) -> Result<(Signature, Vec<Slide>), FlowError> {
    let zones = sharp.unpack(at);
    let free = |index: usize| sharp.signature.zone(index).regime == Regime::Separation;
    let Some(first) = (0..zones.len()).find(|&index| free(index)) else {
        let slip = sharp.flows(at)?.contact(Regime::Slip).clone();
        let slide = sharp.slide_at(at, 0);
        let crossings = slip.extremes(&slide)?;
        let rising = crossings.last().copied().unwrap_or(0.5 * slide.duration);
        let [y, _] = slip.state(&slide, rising)?;
        let period: f64 = zones.iter().map(|zone| zone.duration).sum();
        return Ok((Signature::contact(), vec![Slide::bare([y, 0.0], period)]));
    };
    let mut signature = Vec::new();
    let mut merged: Vec<Slide> = Vec::new();
    for index in first..first + zones.len() {
        let zone = zones[index % zones.len()];
        match merged.last_mut() {
            Some(contact) if !free(index) && !free(index - 1) => contact.duration += zone.duration,
            _ => {
                let entered = sharp.signature.zone(index);
                signature.push(match entered.regime {
                    Regime::Separation => entered,
                    _ => WaveZone {
                        regime: Regime::Contact,
                        entry: ZoneEntry::Landing,
                    },
                });
                merged.push(zone);
            }
        }
    }
    Ok((Signature(signature), merged))
}

/// The wave of the regularised law next to a wave of Coulomb's.
pub(super) fn smooth_wave(
    sharp: &Wave,
    at: &Vector,
    parameter: Parameter,
    epsilon: f64,
) -> Result<(Wave, Vector), NoFirstWave> {
    let (signature, first) = smoothed(sharp, at)?;
    let posed = |epsilon: f64| {
        let law = FrictionLaw::Regularised { epsilon };
        let model = Model {
            law,
            ..sharp.model_at(at)
        };
        Wave::new(
            model,
            parameter,
            sharp.mode,
            signature.clone(),
            sharp.scales,
        )
    };
    let guess = |wave: &Wave, zones: &[Slide], excess: f64| {
        let value = wave.model.value(parameter).unwrap_or(f64::NAN);
        wave.pack(zones, excess, value)
    };
    let wave = posed(epsilon);
    let reach = |wave: &Wave| {
        let guess = guess(wave, &first, sharp.excess_at(at));
        polish_within(wave, &guess, SMOOTH_ITERATIONS)
    };
    if let Ok(point) = reach(&wave) {
        return Ok((wave, point));
    }
    let frame = sharp.flows(at)?.frame.at;
    let mut reached = FIRST_SMOOTHING.min(epsilon);
    let mut wave = posed(reached);
    let mut point = reach(&wave).map_err(|error| {
        // V̇ comes to rest at 1 in layers of this length
        let period: f64 = first.iter().map(|zone| zone.duration).sum();
        let pull = frame.friction * (frame.g * frame.mismatch + frame.kappa);
        NoFirstWave::Smoothing {
            epsilon: reached,
            layer: frame.ma * reached / pull / period,
            reason: Box::new(error),
        }
    })?;
    while reached != epsilon {
        reached = (reached * SMOOTHING_STEP).min(epsilon);
        let next = posed(reached);
        let start = guess(&next, &wave.unpack(&point), wave.excess_at(&point));
        point = polish(&next, &start)?;
        wave = next;
    }
    Ok((wave, point))
}

/// Iterations in which a wave of the regularised law is reached from a good guess, if at all: each
/// integrates all its layers, and ten times as slowly where the wave cannot be resolved.
const SMOOTH_ITERATIONS: usize = 12;

/// Newton's method at the parameter value of the guess.
pub fn polish(wave: &Wave, guess: &Vector) -> Result<Vector, NoFirstWave> {
    polish_within(wave, guess, 40)
}

fn polish_within(
    wave: &Wave,
    guess: &Vector,
    most_iterations: usize,
) -> Result<Vector, NoFirstWave> {
    let index = wave.unknowns() - 1;
    let mut fixed = Fixed {
        index,
        value: guess[index],
    };
    let settings = newton::Settings {
        most_iterations,
        halvings: 10,
        polish: 1,
        ..newton::Settings::default()
    };
    newton::solve(wave, &mut fixed, guess, &settings)
        .map(|solution| solution.point)
        .map_err(|failure| NoFirstWave::Newton(failure.into()))
}
