//! The state of a run between two steps: all that is needed to go on from there.

use serde::{Deserialize, Serialize};

use super::saved::finite;
use super::special::ResumeMismatch;
use crate::orbit::legs::{self, RunState};
use crate::problem::{Continuation, Problem};
use crate::tube::flow::method::Method;
use crate::tube::model::Model;
use crate::tube::stability::spectrum::Spectrum;
use crate::tube::stability::track::ALLOWANCE;
use crate::tube::wave::{Wave, WaveScales};

/// The state of a run of waves between two steps.
pub type WaveProgress = RunState<Wave, WaveMemory>;

/// What a run of waves remembers beside the state of its legs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveMemory {
    /// Units of the unknowns.
    pub scales: WaveScales,
    /// Spectrum at the point the branch has reached, where stability is asked for.
    pub spectrum: Option<Spectrum>,
    /// Eigenvalues that may still be computed; zero once no more spectra are taken.
    pub allowance: usize,
}

impl WaveMemory {
    /// Before the first step from a first wave.
    pub(super) fn new(wave: &Wave) -> WaveMemory {
        WaveMemory {
            scales: wave.scales,
            spectrum: None,
            allowance: ALLOWANCE,
        }
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

/// What the legs of a run of waves are asked for.
pub(super) fn plan(
    problem: &Problem,
    continuation: &Continuation,
    model: Model,
    directions: &[bool],
) -> legs::Plan {
    let points = continuation.most_points(model.law);
    let plan = continuation.plan(points, problem.output.profiles, |_| None);
    plan.going(directions)
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
