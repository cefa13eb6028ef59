//! The first wave of a branch.

use crate::events;
use crate::flow::FlowError;
use crate::flow::sign::Verdict;
use crate::follow::{Follower, Settings, Status};
use crate::linalg::Vector;
use crate::model::Model;
use crate::model::signature::Signature;
use crate::newton::{self, Fixed, System};
use crate::problem::Parameter;
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
    let closed = start::slip_stick(model, mode, which)?;
    let least = start::least_mismatch(model, &closed);
    let value = |model: &Model, parameter| model.value(parameter).unwrap_or(f64::NAN);
    let solve = |model: &Model, parameter: Parameter, width: f64| {
        let wave = Wave::new(
            *model,
            parameter,
            mode,
            Signature::slip_stick(),
            scales(model, mode, closed.excess, closed.least_rate, width),
        );
        let guess = wave.pack(
            &[
                [closed.release, 1.0, closed.slip],
                [closed.release - closed.stick, 1.0, closed.stick],
            ],
            closed.excess,
            value(model, parameter),
        );
        polish(&wave, &guess).map(|point| (wave, point))
    };
    if model.mismatch > least {
        let (wave, point) = solve(model, parameter, width)?;
        let examination = examine(&wave, &point)?;
        return match examination.verdict {
            Verdict::Positive => Ok((wave, point)),
            _ => Err(NoStart::Newton(events::refusal(&wave, &examination))),
        };
    }
    // from where the wave is slip-stick, through its changes of regime, down to the δ asked for
    let above = 1.05 * least;
    let from = model.with(Parameter::Mismatch, above);
    let (wave, point) = solve(&from, Parameter::Mismatch, above - model.mismatch)?;
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
                let guess = wave.pack(&zones, excess, value(model, parameter));
                let point = polish(&wave, &guess)?;
                return Ok((wave, point));
            }
        }
    }
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
