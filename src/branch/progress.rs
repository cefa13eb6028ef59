//! The state of a run between two steps: all that is needed to go on from there.

use serde::{Deserialize, Serialize};

use super::orbit::{Follower, State};
use super::saved::finite;
use super::special::{Failure, ResumeMismatch};
use crate::continuation::Steps;
use crate::continuation::newton::System;
use crate::flow::method::Method;
use crate::linalg::Vector;
use crate::model::Model;
use crate::model::signature::Signature;
use crate::orbit::follow::Limits;
use crate::problem::{Continuation, Problem, Toward};
use crate::stability::spectrum::Spectrum;
use crate::stability::track::ALLOWANCE;
use crate::wave::{Scales, Wave};

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum End {
    /// All that was asked for was done.
    Finished,
    /// The branch ended before its range.
    Failed(Failure),
}

/// The state of a run between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Leg being followed, from 1.
    pub leg: usize,
    /// Points handed out so far.
    pub points: usize,
    /// Labels handed out so far.
    pub labels: usize,
    /// Events handed out so far.
    pub events: usize,
    /// Points handed out before this leg began: `max_points` counts from there.
    #[serde(default)]
    pub before_leg: usize,
    /// Rows of `spectrum.csv` handed out so far.
    pub eigenvalues: usize,
    /// How often each `stop_after` entry has been met.
    pub met: Vec<usize>,
    /// Parts of the range from which this leg has a profile.
    pub passed: Vec<bool>,
    /// First wave of the run.
    pub first: (Signature, Vec<f64>),
    /// Units of the unknowns: [time, rate, excess, parameter, pressure, layer].
    pub scales: [f64; 6],
    /// State of the branch; `None` before the first step of a leg.
    pub state: Option<State>,
    /// Spectrum at the point the branch has reached, where stability is asked for.
    pub spectrum: Option<Spectrum>,
    /// Eigenvalues that may still be computed; zero once no more spectra are taken.
    #[serde(default = "allowance")]
    pub allowance: usize,
    /// Reason why an earlier leg ended before its range.
    pub failure: Option<Failure>,
    /// How the run ended; `None` while it goes on.
    pub end: Option<End>,
}

/// Allowance of a run that begins, or was saved without one.
fn allowance() -> usize {
    ALLOWANCE
}

impl Progress {
    /// Before the first step from a first wave.
    pub(super) fn new(
        wave: &Wave,
        point: &Vector,
        problem: &Problem,
        continuation: &Continuation,
    ) -> Progress {
        Progress {
            leg: 1,
            points: 0,
            before_leg: 0,
            labels: 0,
            events: 0,
            eigenvalues: 0,
            spectrum: None,
            allowance: ALLOWANCE,
            met: vec![0; continuation.stop_after.len()],
            passed: vec![false; problem.output.profiles],
            first: (wave.signature.clone(), point.iter().copied().collect()),
            scales: pack(&wave.scales),
            state: None,
            failure: None,
            end: None,
        }
    }

    /// Whether it may be one of a problem.
    fn fits(&self, problem: &Problem, continuation: &Continuation) -> bool {
        let (signature, point) = &self.first;
        self.met.len() == continuation.stop_after.len()
            && self.passed.len() == problem.output.profiles
            && self.spectrum.iter().all(|spectrum| {
                let found = spectrum.sectors.iter().map(|sector| sector.sector);
                let request = problem.request();
                request.is_some_and(|request| found.eq(request.sectors))
            })
            && !signature.is_empty()
            && finite(&self.scales)
            && finite(point)
    }

    /// The branch where it is, the legs of `model` being solved by `method`.
    ///
    /// # Errors
    /// When the progress is not one that a run of this problem leaves.
    pub(super) fn follower(
        &self,
        problem: &Problem,
        continuation: &Continuation,
        model: Model,
        method: Method,
    ) -> Result<Follower, ResumeMismatch> {
        let leg = self.leg.checked_sub(1);
        let up = leg.and_then(|leg| legs(continuation.toward).get(leg));
        let (Some(up), true) = (up, self.fits(problem, continuation)) else {
            return Err(ResumeMismatch::Progress);
        };
        let (signature, point) = self.first.clone();
        let mode = problem.wave.mode;
        let scales = unpack(self.scales);
        let wave = Wave::new(model, continuation.parameter, mode, signature, scales);
        let wave = wave.with_method(method);
        if point.len() != wave.unknowns() {
            return Err(ResumeMismatch::FirstWave);
        }
        let limits = Limits {
            range: continuation.range,
            stop_at: continuation.stop_at.clone(),
            steps: steps(continuation),
        };
        Ok(match &self.state {
            Some(state) => Follower::resume(&wave, state.clone(), limits)?,
            None => Follower::new(wave, &Vector::from_vec(point), *up, limits)?,
        })
    }
}

/// Step lengths and tolerance of a problem.
pub(super) fn steps(continuation: &Continuation) -> Steps {
    Steps {
        ds: continuation.ds,
        ds_min: continuation.ds_min,
        ds_max: continuation.ds_max,
        tolerance: continuation.tolerance,
    }
}

pub(super) fn legs(toward: Toward) -> &'static [bool] {
    match toward {
        Toward::Down => &[false],
        Toward::Up => &[true],
        Toward::Both => &[false, true],
    }
}

fn pack(scales: &Scales) -> [f64; 6] {
    [
        scales.time,
        scales.rate,
        scales.excess,
        scales.parameter,
        scales.pressure,
        scales.layer,
    ]
}

fn unpack([time, rate, excess, parameter, pressure, layer]: [f64; 6]) -> Scales {
    Scales {
        time,
        rate,
        excess,
        parameter,
        pressure,
        layer,
    }
}
