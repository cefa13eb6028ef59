//! The pipeline from a problem to a branch: first wave, legs, points, labels and events.
//!
//! A [`WaveRunner`] is advanced one step at a time and hands out what it found; it prints nothing and
//! touches no file. Its [`WaveProgress`] after any step is all that is needed to go on from there.

use std::sync::Arc;

use super::begin::{Begun, begin};
use super::conditioning::conditioning;
use super::first_wave::Observer;
use super::item::{event, row};
use super::orbit::Found;
use super::progress::{WaveMemory, plan};
use super::row::EigenvalueRow;
use super::saved::SavedWave;
use super::special::{OfWaves, Special, WaveNote};
use super::wanted::NoFirstWave;
use super::{BranchPoint, Stability, VerdictReason};
use crate::continuation::Node;
use crate::linalg::Vector;
use crate::orbit::follow::LocatedPoint;
pub use crate::orbit::legs::Run;
use crate::orbit::legs::{self, LegStep, Legs};
use crate::problem::{Continuation, Problem};
use crate::tube::flow::method::Method;
use crate::tube::model::{Model, Parameter};
use crate::tube::stability::spectrum::Spectrum;
use crate::tube::stability::track::{
    ALLOWANCE, Crossing, GrowingEigenvalues, PER_POINT, PassedPoint, Remark, Tracked, Tracker,
};
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::examine;
use crate::tube::wave::hopf::Family;

pub use super::begin::{RefusedRequest, RunError};
pub use super::item::{WaveItem, answer};
pub use super::progress::WaveProgress;
pub use super::special::ResumeMismatch;

/// How a run of waves ended.
pub type End = legs::RunEnd<Wave>;

/// A branch being computed from a problem.
pub struct WaveRunner {
    problem: Problem,
    continuation: Continuation,
    /// The model of the first wave.
    model: Model,
    /// The vertical family before the first wave, until it is handed out.
    family: Option<Family>,
    legs: Legs<Wave>,
    /// What is saved beside the state of the legs.
    beside: WaveMemory,
    notes: Vec<WaveNote>,
}

impl WaveRunner {
    /// Finds the first wave. `restart` is the wave that `start: Restart(…)` names.
    ///
    /// # Errors
    /// The problem asks for what is not there, or there is no first wave.
    pub fn begin(
        problem: &Problem,
        continuation: &Continuation,
        restart: Option<&SavedWave>,
    ) -> Result<WaveRunner, RunError> {
        WaveRunner::begin_watched(problem, continuation, restart, &mut |_| {})
    }

    /// [`WaveRunner::begin`], with somebody told where the search for the first wave is.
    ///
    /// # Errors
    /// The problem asks for what is not there, or there is no first wave.
    pub(crate) fn begin_watched(
        problem: &Problem,
        continuation: &Continuation,
        restart: Option<&SavedWave>,
        observer: Observer,
    ) -> Result<WaveRunner, RunError> {
        let Begun {
            wave,
            point,
            model,
            family,
            directions,
        } = begin(problem, continuation, restart, observer)?;
        let beside = WaveMemory::new(&wave);
        let plan = plan(problem, continuation, model, &directions);
        let legs =
            Legs::begin(wave, &point, plan).map_err(|reason| NoFirstWave::Newton(reason.into()))?;
        Ok(WaveRunner {
            family,
            ..WaveRunner::at(problem, continuation, model, legs, beside)
        })
    }

    /// Goes on from saved progress. A vertical family was handed out before anything was saved.
    ///
    /// # Errors
    /// When the progress is not one that a run of this problem leaves.
    pub fn resume(
        problem: &Problem,
        continuation: &Continuation,
        saved: &SavedWave,
        progress: WaveProgress,
    ) -> Result<WaveRunner, ResumeMismatch> {
        let model = saved.model;
        let method = problem.method.unwrap_or(Method::cheapest(model.law));
        let wave = progress.wave(problem, continuation, model, method)?;
        let plan = plan(problem, continuation, model, &progress.directions);
        let legs = Legs::resume(&wave, progress.legs, plan)?;
        let beside = progress.beside;
        Ok(WaveRunner::at(problem, continuation, model, legs, beside))
    }

    fn at(
        problem: &Problem,
        continuation: &Continuation,
        model: Model,
        legs: Legs<Wave>,
        beside: WaveMemory,
    ) -> WaveRunner {
        WaveRunner {
            problem: problem.clone(),
            continuation: continuation.clone(),
            model,
            family: None,
            legs,
            beside,
            notes: Vec::new(),
        }
    }

    /// Spectrum at the point the branch has reached, where stability is asked for.
    pub fn spectrum(&self) -> Option<&Spectrum> {
        self.beside.spectrum.as_ref()
    }

    /// The first points of a leg: the waves of a vertical family, the first wave.
    fn first_step(&mut self, tracker: Option<&mut Tracker>) -> Vec<WaveItem> {
        let mut items = self.family();
        let mut found = self.legs.set_out();
        if !items.is_empty() {
            found.special = None;
        }
        // the value of the problem, not the scaled unknown's
        let exact = self.model.value(self.continuation.parameter);
        found.parameter = exact.unwrap_or(found.parameter);
        let spectrum = tracker.and_then(|tracker| {
            let spectrum = tracker.start(&found.orbit, &found.node);
            self.take_over(tracker);
            spectrum
        });
        items.push(self.item(found, spectrum.as_ref()));
        self.check_points(&mut items);
        items
    }

    /// Adds the points and the crossings of a step in order. Returns whether the run is to stop there.
    fn add(
        &mut self,
        items: &mut Vec<WaveItem>,
        wave: &Arc<Wave>,
        found: Vec<Found>,
        tracked: Tracked,
        mut growing: Option<GrowingEigenvalues>,
    ) -> bool {
        let Tracked {
            crossings,
            spectra,
            mut remark,
        } = tracked;
        let is_lost = matches!(remark, Some(Remark::Lost | Remark::Unpaid));
        let parameter = self.continuation.parameter;
        let last = found.len().saturating_sub(1);
        let mut spectra = spectra.into_iter();
        let repeats = |found: &Found| matches!(found.special, Some(Special::Own(OfWaves::Repeats)));
        let ends_double = found.iter().any(repeats);
        // what is seen of the end of a branch by its eigenvalue is that end
        let seen = |(located, _): &Crossing| !(ends_double && wave.is_double(&located.node.point));
        let mut crossings = crossings.into_iter().filter(seen).peekable();
        for (index, mut found) in found.into_iter().enumerate() {
            let value = found.parameter;
            while let Some(crossing) = crossings.next_if(|(located, _)| located.s < found.s) {
                if let Some(growing) = &mut growing {
                    growing.cross(&crossing.0);
                }
                let item = self.crossing(wave, crossing);
                if item.is_none() {
                    self.notes
                        .push(WaveNote::CrossingLeftOut { parameter, value });
                }
                let kind = item.as_ref().and_then(|item| item.point.kind);
                items.extend(item);
                if self.legs.stops_at(kind) {
                    return true;
                }
            }
            self.note(&mut found, &mut remark, index == last);
            let kind = found.kind();
            let folds = matches!(found.special, Some(Special::Fold(_)));
            let spectrum = spectra.next().flatten();
            let mut item = self.item(found, spectrum.as_ref());
            let here = spectrum
                .as_ref()
                .map(GrowingEigenvalues::new)
                .filter(|_| !folds);
            if let (Some(before), Some(here)) = (&growing, &here) {
                item.point.why.extend(before.unexplained(here, is_lost));
            }
            growing = here;
            items.push(item);
            if self.legs.stops_at(kind) {
                return true;
            }
        }
        false
    }

    /// Notes what remains to be said of the spectrum, at a change of regime in its event, and what rounding decides at a point.
    fn note(&mut self, found: &mut LocatedPoint<Wave>, remark: &mut Option<Remark>, is_last: bool) {
        let (parameter, value) = (self.continuation.parameter, found.parameter);
        match &mut found.special {
            Some(Special::Change(change)) if found.entered.is_some() => {
                change.spectrum = remark.take();
            }
            special if special.is_none() || is_last => {
                let note = |remark| WaveNote::Spectrum {
                    parameter,
                    value,
                    remark,
                };
                self.notes.extend(remark.clone().map(note));
            }
            _ => {}
        }
        if let Some(what) = found.close {
            self.notes.push(WaveNote::Close {
                parameter,
                value,
                what,
            });
        }
    }

    /// Ends a leg that has as many points as it may, with a row that says so.
    fn check_points(&mut self, items: &mut Vec<WaveItem>) {
        let Some((found, end)) = self.legs.at_most_points() else {
            return;
        };
        let spectrum = self.beside.spectrum.clone();
        items.push(self.item(found, spectrum.as_ref()));
        self.legs.finish(Some(end), false);
    }

    /// The waves at the Hopf point, from steady sliding to where a stick zone opens.
    fn family(&mut self) -> Vec<WaveItem> {
        let Some(family) = self.family.take() else {
            return Vec::new();
        };
        let wave = Arc::new(family.wave);
        let last = family.points.len() - 1;
        let mut items = Vec::with_capacity(family.points.len());
        for (index, point) in family.points.into_iter().enumerate() {
            let Ok(examination) = examine(&wave, &point) else {
                continue;
            };
            let mut tangent = Vector::zeros(point.len());
            tangent[0] = -1.0;
            let found = Found {
                parameter: family.critical,
                special: match index {
                    0 => Some(Special::Own(OfWaves::HopfPoint)),
                    _ if index == last => Some(Special::Own(OfWaves::StickOpens)),
                    _ => None,
                },
                uncertainty: 8.0 * f64::EPSILON * family.critical,
                ..Found::new(&wave, 0.0, &Node::at(point, tangent), &examination)
            };
            let mut item = self.item(found, None);
            if self.with_stability() {
                item.point.why = vec![VerdictReason::Family];
            }
            items.push(item);
        }
        items
    }

    /// A crossing of the imaginary axis as a point of the branch.
    fn crossing(&mut self, wave: &Arc<Wave>, (located, spectrum): Crossing) -> Option<WaveItem> {
        let examination = examine(wave, &located.node.point).ok()?;
        let spectrum = spectrum.with_crossing(located.sector, located.omega);
        let found = Found {
            special: Some(Special::Own(OfWaves::Crossing {
                sector: located.sector,
                omega: (located.omega != 0.0).then_some(located.omega),
                grows: located.grows,
            })),
            uncertainty: located.uncertainty * wave.scales.parameter,
            ..Found::new(wave, located.s, &located.node, &examination)
        };
        Some(self.item(found, Some(&spectrum)))
    }

    fn item(&mut self, found: Found, spectrum: Option<&Spectrum>) -> WaveItem {
        let model = self.model.with(found.orbit.parameter, found.parameter);
        let mut point = row(&found, &model);
        let numbers = self.legs.number(&found);
        (point.point, point.label) = (numbers.point, numbers.label);
        point.conditioning = self.known_to(&found.orbit, &found.node);
        let special = found.special.as_ref();
        let event = special.map(|special| event(&point, special, &found));
        self.judge(&mut point, &found, spectrum);
        let eigenvalues = match (point.label, spectrum, &self.problem.stability) {
            (Some(_), Some(spectrum), Some(section)) => spectrum
                .leading(section.eigenvalues)
                .map(|(sector, eigenvalue)| EigenvalueRow::new(sector, eigenvalue))
                .collect(),
            _ => Vec::new(),
        };
        self.legs.count_spectrum(eigenvalues.len());
        let unknowns = found.node.point;
        let saved = point.label;
        let saved = saved.map(|label| SavedWave::new(label, model, &found.orbit, &unknowns));
        WaveItem {
            point,
            leg: numbers.leg,
            eigenvalues,
            event,
            special: found.special,
            saved,
            unknowns,
            wave: found.orbit,
        }
    }

    /// Writes the stability of a point found into its row.
    fn judge(&mut self, point: &mut BranchPoint, found: &Found, spectrum: Option<&Spectrum>) {
        if !self.with_stability() {
            return;
        }
        answer(point, spectrum, &found.orbit, &found.node.point);
        // on the imaginary axis itself nothing is decided
        let on_axis = matches!(found.special, Some(Special::Own(OfWaves::Crossing { .. })));
        if on_axis && point.stable == Some(Stability::Yes) {
            point.stable = Some(Stability::Undecided);
            point.why.push(VerdictReason::OnAxis);
        }
        if self.beside.allowance == 0 && spectrum.is_none() {
            for reason in point
                .why
                .iter_mut()
                .filter(|one| **one == VerdictReason::NoWindow)
            {
                *reason = VerdictReason::Spent;
            }
        }
        let mut reasons = point.why.iter();
        let incomplete = reasons.find(|reason| matches!(reason, VerdictReason::Incomplete { .. }));
        let mut notes = self.notes.iter();
        let noted = notes.any(|note| matches!(note, WaveNote::Incomplete { .. }));
        if let (Some(reason), false) = (incomplete, noted) {
            self.notes.push(WaveNote::Incomplete {
                point: point.point,
                reason: reason.clone(),
            });
        }
    }

    /// Takes over from a step what is known of the spectrum and what is left of the allowance, and notes
    /// its end.
    fn take_over(&mut self, tracker: &Tracker) {
        self.beside.spectrum = tracker.last().cloned();
        let before = self.beside.allowance;
        self.beside.allowance = match tracker.allowance() {
            0 => 0,
            left => ALLOWANCE.min(left + PER_POINT),
        };
        if before > 0 && self.beside.allowance == 0 {
            self.notes.push(WaveNote::Spent {
                points: self.progress().points,
                allowance: ALLOWANCE,
            });
        }
    }

    /// Conditioning of a point, where asked for; a point known less well than the tolerance asks is
    /// noted as not converged to it.
    fn known_to(&mut self, wave: &Wave, node: &Node) -> Option<(f64, f64)> {
        if !self.problem.output.conditioning {
            return None;
        }
        let known = conditioning(wave, node).ok()?;
        let tolerance = self.continuation.tolerance;
        if known.expected_error.is_nan() || known.expected_error > tolerance {
            self.notes.push(WaveNote::NotConverged {
                point: self.progress().points,
                parameter: self.continuation.parameter,
                value: wave.parameter_at(&node.point),
                tolerance,
                known,
            });
        }
        Some((known.condition, known.expected_error))
    }

    /// What could not be settled so far.
    pub fn notes(&self) -> &[WaveNote] {
        &self.notes
    }

    /// The parameter that it is followed in.
    pub fn parameter(&self) -> Parameter {
        self.continuation.parameter
    }

    /// Whether stability is asked for.
    pub(crate) fn with_stability(&self) -> bool {
        self.problem.stability.is_some()
    }
}

impl Run for WaveRunner {
    type Orbit = Wave;
    type Item = WaveItem;
    type Beside = WaveMemory;

    fn progress(&self) -> &legs::Progress<Wave> {
        self.legs.progress()
    }

    fn state(&self) -> WaveProgress {
        let requested = self.continuation.toward.directions();
        self.legs.state(requested, self.beside.clone())
    }

    fn step(&mut self) -> Vec<WaveItem> {
        if self.progress().end.is_some() {
            return Vec::new();
        }
        let mut tracker = self.problem.request().map(|request| {
            let (last, left) = (self.beside.spectrum.take(), self.beside.allowance);
            Tracker::new(request, last, self.continuation.tolerance, left)
        });
        if self.legs.at_beginning() {
            return self.first_step(tracker.as_mut());
        }
        let LegStep {
            orbit,
            node,
            found,
            end,
        } = self.legs.step();
        let mut tracked = Tracked::default();
        let growing = tracker
            .as_ref()
            .and_then(Tracker::last)
            .map(GrowingEigenvalues::new);
        if let Some(tracker) = &mut tracker {
            let passed: Vec<PassedPoint> = found.iter().map(passed).collect();
            tracked = tracker.step(&orbit, &node, &passed);
            self.take_over(tracker);
        }
        let mut items = Vec::with_capacity(found.len() + tracked.crossings.len());
        let stopped = self.add(&mut items, &orbit, found, tracked, growing);
        if stopped || end.is_some() {
            self.legs.finish(end, stopped);
        } else {
            self.check_points(&mut items);
        }
        items
    }

    fn position(&self) -> f64 {
        self.legs.position()
    }
}

/// A point found, as far as the spectrum is concerned.
fn passed(found: &Found) -> PassedPoint<'_> {
    let entered = found.entered.as_ref();
    PassedPoint {
        s: found.s,
        wave: &found.orbit,
        node: &found.node,
        folds: matches!(found.special, Some(Special::Fold(_))),
        entered: entered.map(|(wave, node)| (wave.as_ref(), node)),
    }
}
