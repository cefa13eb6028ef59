//! The first wave of a branch.

use crate::events;
use crate::flow::FlowError;
use crate::flow::sign::Verdict;
use crate::follow::{Follower, Settings, Status};
use crate::linalg::Vector;
use crate::model::Model;
use crate::model::signature::{Regime, Signature};
use crate::newton::{self, Fixed, System};
use crate::problem::{FrictionLaw, Parameter};
use crate::wave::admissibility::examine;
use crate::wave::start::{self, NoWave, Which};
use crate::wave::{RATE_UNITS, Scales, Wave};

/// Why there is no first wave.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStart {
    /// No slip-stick wave exists.
    #[error("{0}")]
    NoWave(#[from] NoWave),
    /// The equations could not be evaluated.
    #[error("{0}")]
    Flow(#[from] FlowError),
    /// Newton's method failed on the closed form.
    #[error("Newton's method fails at the start: {0}")]
    Newton(String),
    /// The slip-stick wave does not exist at this δ, and the branch from where it exists does
    /// not reach it.
    #[error(
        "at δ = {mismatch} the wave is no longer slip-stick (its pressure vanishes or it reverses \
         below δ = {least:.15}), and the branch from there does not reach it: {reason}"
    )]
    Unreached {
        /// δ asked for.
        mismatch: f64,
        /// Least δ of the slip-stick wave.
        least: f64,
        /// How the branch ended.
        reason: String,
    },
}

/// The units of a branch that begins with a wave of this excess speed and this largest |V̇|.
pub fn scales(model: &Model, mode: u32, excess: f64, largest_rate: f64, width: f64) -> Scales {
    let speed = model.speed(excess);
    Scales {
        rate: RATE_UNITS * largest_rate.abs().max(1.0),
        time: std::f64::consts::TAU / (f64::from(mode) * speed.abs()),
        excess,
        parameter: width,
        pressure: (model.parameters().coefficients.coupling / speed).abs(),
    }
}

/// The wave of the model, as a boundary-value problem in `parameter` and its solution: the
/// slip-stick wave in closed form or, at a mismatch where that is not admissible any more, the
/// wave that continues it. `width` is the unit of the parameter.
pub fn first_wave(
    model: &Model,
    parameter: Parameter,
    mode: u32,
    which: Which,
    width: f64,
    continuation: crate::continuation::Settings,
) -> Result<(Wave, Vector), NoStart> {
    let coulomb = Model {
        law: FrictionLaw::Coulomb,
        ..*model
    };
    let closed = start::slip_stick(&coulomb, mode, which)?;
    let least = start::least_mismatch(&coulomb, &closed);
    let start = |model: &Model, parameter: Parameter, width: f64| {
        slip_stick_wave(model, parameter, mode, &closed, width)
    };
    if model.mismatch > least {
        let (wave, point) = start(model, parameter, width)?;
        let examination = examine(&wave, &point)?;
        match examination.verdict {
            Verdict::Positive => return Ok((wave, point)),
            _ if model.law == FrictionLaw::Coulomb => {
                return Err(NoStart::Newton(events::refusal(&wave, &examination)));
            }
            _ => {}
        }
    }
    // from where the wave is slip-stick, through its changes of regime, down to the δ asked for
    let mut above = 1.05 * least.max(model.mismatch);
    let (wave, point) = loop {
        let from = model.with(Parameter::Mismatch, above);
        let (wave, point) = start(&from, Parameter::Mismatch, above - model.mismatch)?;
        let admissible = examine(&wave, &point)?.verdict == Verdict::Positive;
        if admissible || model.law == FrictionLaw::Coulomb || above > MOST_ABOVE * least {
            break (wave, point);
        }
        above *= 2.0;
    };
    let settings = Settings {
        range: (model.mismatch, above * (1.0 + 1e-9)),
        stop_at: Vec::new(),
        continuation,
    };
    let unreached = |reason: String| NoStart::Unreached {
        mismatch: model.mismatch,
        least,
        reason,
    };
    let mut follower = Follower::new(wave, &point, false, settings).map_err(unreached)?;
    loop {
        let (found, status) = follower.step();
        match status {
            Status::Going => {}
            Status::Failed(reason) => return Err(unreached(reason)),
            Status::Finished => {
                let end = found.last().ok_or_else(|| unreached("no point".into()))?;
                let reached = end.wave.parameter_at(&end.node.point);
                if (reached / model.mismatch - 1.0).abs() > 1e-9 {
                    return Err(unreached(format!("it turns back to δ = {reached}")));
                }
                let excess = end.wave.excess_at(&end.node.point);
                let wave = Wave::new(
                    *model,
                    parameter,
                    mode,
                    end.wave.signature.clone(),
                    scales(model, mode, excess, closed.least_rate, width),
                );
                let zones = end.wave.unpack(&end.node.point);
                let value = model.value(parameter).unwrap_or(f64::NAN);
                let guess = wave.pack(&zones, excess, value);
                let point = polish(&wave, &guess)?;
                return Ok((wave, point));
            }
        }
    }
}

/// The mismatch is raised at most by this factor above that of the Coulomb wave in search of a
/// slip-stick wave under another friction law.
const MOST_ABOVE: f64 = 1e3;

/// Steps in which the friction law is turned from Coulomb's into the one asked for.
const LAW_STEPS: usize = 8;

/// The slip-stick wave of a model as a boundary-value problem, admissible or not: in closed form
/// under Coulomb's law, and from there in steps of the law.
fn slip_stick_wave(
    model: &Model,
    parameter: Parameter,
    mode: u32,
    closed: &start::SlipStick,
    width: f64,
) -> Result<(Wave, Vector), NoStart> {
    let value = model.value(parameter).unwrap_or(f64::NAN);
    let posed = |law: FrictionLaw| {
        Wave::new(
            Model { law, ..*model },
            parameter,
            mode,
            Signature::slip_stick(),
            scales(model, mode, closed.excess, closed.least_rate, width),
        )
    };
    let wave = posed(FrictionLaw::Coulomb);
    let guess = wave.pack(
        &[
            [closed.release, 1.0, closed.slip],
            [closed.release - closed.stick, 1.0, closed.stick],
        ],
        closed.excess,
        value,
    );
    let mut point = polish(&wave, &guess)?;
    if model.law == FrictionLaw::Coulomb {
        return Ok((wave, point));
    }
    if let FrictionLaw::Regularised { epsilon } = model.law {
        return smooth_wave(&wave, &point, parameter, epsilon);
    }
    for step in 1..=LAW_STEPS {
        let share = step as f64 / LAW_STEPS as f64;
        let partly = |ratio: f64| 1.0 + share * (ratio - 1.0);
        let law = match model.law {
            FrictionLaw::Static { ratio } => FrictionLaw::Static {
                ratio: partly(ratio),
            },
            FrictionLaw::Stribeck { ratio, velocity } => FrictionLaw::Stribeck {
                ratio: partly(ratio),
                velocity,
            },
            other => other,
        };
        point = polish(&posed(law), &point)?;
    }
    Ok((posed(model.law), point))
}

/// ε from which the regularised wave is reached if the one asked for is too far from Coulomb's, and
/// the factor from one to the next.
const FIRST_SMOOTHING: f64 = 0.01;
const SMOOTHING_STEP: f64 = 1.4;

/// The wave of the regularised law next to a slip-stick wave of Coulomb's: one zone of contact, cut
/// where V̇ = 0 rises.
fn smooth_wave(
    sharp: &Wave,
    at: &Vector,
    parameter: Parameter,
    epsilon: f64,
) -> Result<(Wave, Vector), NoStart> {
    let flows = sharp.flows(at)?;
    let slip = flows.contact(Regime::Slip);
    let (entry, duration) = (sharp.entry_at(at, 0), sharp.duration_at(at, 0));
    let crossings = slip.extremes(entry, duration)?;
    let rising = crossings.last().copied().unwrap_or(0.5 * duration);
    let [y, _] = slip.state(entry, rising)?;
    let period: f64 = sharp.unpack(at).iter().map(|zone| zone[2]).sum();
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
            Signature::contact(),
            sharp.scales,
        )
    };
    let guess = |wave: &Wave, zones: &[[f64; 3]], excess: f64| {
        let value = wave.model.value(parameter).unwrap_or(f64::NAN);
        wave.pack(zones, excess, value)
    };
    let first = [[y, 0.0, period]];
    let wave = posed(epsilon);
    if let Ok(point) = polish(&wave, &guess(&wave, &first, sharp.excess_at(at))) {
        return Ok((wave, point));
    }
    let mut reached = FIRST_SMOOTHING.min(epsilon);
    let mut wave = posed(reached);
    let mut point = polish(&wave, &guess(&wave, &first, sharp.excess_at(at)))?;
    while reached != epsilon {
        reached = (reached * SMOOTHING_STEP).min(epsilon);
        let next = posed(reached);
        let start = guess(&next, &wave.unpack(&point), wave.excess_at(&point));
        point = polish(&next, &start)?;
        wave = next;
    }
    Ok((wave, point))
}

/// Newton's method at the parameter value of the guess.
pub fn polish(wave: &Wave, guess: &Vector) -> Result<Vector, NoStart> {
    let index = wave.unknowns() - 1;
    let mut fixed = Fixed {
        index,
        value: guess[index],
    };
    let settings = newton::Settings {
        most_iterations: 40,
        halvings: 10,
        polish: 1,
        ..newton::Settings::default()
    };
    newton::solve(wave, &mut fixed, guess, &settings)
        .map(|solution| solution.point)
        .map_err(|failure| NoStart::Newton(failure.to_string()))
}
