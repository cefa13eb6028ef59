//! The state of a run between two steps: all that is needed to go on from there.

use serde::{Deserialize, Serialize};

use super::saved::finite;
use super::special::ResumeMismatch;
use crate::orbit::legs;
use crate::problem::{Continuation, Problem};
use crate::tube::flow::method::Method;
use crate::tube::model::Model;
use crate::tube::stability::spectrum::Spectrum;
use crate::tube::stability::track::ALLOWANCE;
use crate::tube::wave::{Wave, WaveScales};

/// The state of a run of waves between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveProgress {
    /// The legs.
    pub legs: legs::Progress<Wave>,
    /// What waves add.
    pub beside: WaveMemory,
}

/// What a run of waves remembers beside the state of its legs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveMemory {
    /// Rows of `spectrum.csv` handed out so far.
    pub eigenvalues: usize,
    /// Units of the unknowns.
    pub scales: WaveScales,
    /// Spectrum at the point the branch has reached, where stability is asked for.
    pub spectrum: Option<Spectrum>,
    /// Eigenvalues that may still be computed; zero once no more spectra are taken.
    pub allowance: usize,
    /// Ways of the legs where they are not those of the problem: the other branch at an event has its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub directions: Vec<bool>,
}

impl WaveMemory {
    /// Before the first step from a first wave.
    pub(super) fn new(wave: &Wave, directions: Vec<bool>) -> WaveMemory {
        WaveMemory {
            eigenvalues: 0,
            scales: wave.scales,
            spectrum: None,
            allowance: ALLOWANCE,
            directions,
        }
    }

    /// What the legs are asked for.
    pub(super) fn plan(
        &self,
        problem: &Problem,
        continuation: &Continuation,
        model: Model,
    ) -> legs::Plan {
        let points = continuation.most_points(model.law);
        let plan = continuation.plan(points, problem.output.profiles, |_| None);
        plan.going(&self.directions)
    }

    /// Whether it may be one of a problem.
    fn fits(&self, problem: &Problem) -> bool {
        let WaveScales {
            time,
            rate,
            excess,
            parameter,
            pressure,
            layer,
        } = self.scales;
        self.spectrum.iter().all(|spectrum| {
            let found = spectrum.sectors.iter().map(|sector| sector.sector);
            let request = problem.request();
            request.is_some_and(|request| found.eq(request.sectors))
        }) && finite(&[time, rate, excess, parameter, pressure, layer])
    }
}

impl WaveProgress {
    /// The first wave, posed by `method`.
    ///
    /// # Errors
    /// When the progress is not one that a run of this problem leaves.
    pub(super) fn wave(
        &self,
        problem: &Problem,
        continuation: &Continuation,
        model: Model,
        method: Method,
    ) -> Result<Wave, ResumeMismatch> {
        let (signature, _) = &self.legs.first;
        if signature.is_empty() || !self.beside.fits(problem) {
            return Err(ResumeMismatch::Progress);
        }
        let (parameter, mode) = (continuation.parameter, problem.wave.mode);
        let scales = self.beside.scales;
        let wave = Wave::new(model, parameter, mode, signature.clone(), scales);
        Ok(wave.with_method(method))
    }
}
