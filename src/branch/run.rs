//! The pipeline from a problem to a branch: first wave, legs, points, labels and events.
//!
//! A [`Runner`] is advanced one step at a time and hands out what it found; it prints nothing and
//! touches no file. Its [`Progress`] after any step is all that is needed to go on from there.

use std::sync::Arc;

use super::begin::{Begun, begin};
use super::conditioning::conditioning;
use super::first_wave::Observer;
use super::item::{event, row};
use super::orbit::{Follower, Found};
use super::progress::legs;
use super::row::EigenvalueRow;
use super::saved::SavedWave;
use super::special::{Ending, Failure, Note, OfWaves, Special, Stop, WaveStop};
use super::wanted::NoStart;
use super::{BranchPoint, EventType, Reason, Stability};
use crate::continuation::{Node, walk};
use crate::flow::method::Method;
use crate::linalg::Vector;
use crate::model::{Model, Parameter};
use crate::problem::{Continuation, Problem};
use crate::stability::spectrum::Spectrum;
use crate::stability::track::{ALLOWANCE, Crossing, PER_POINT, Passed, Tracked, Tracker};
use crate::wave::Wave;
use crate::wave::admissibility::examine;
use crate::wave::hopf::Family;

pub use super::begin::{Refused, RunError};
pub use super::item::{Item, answer};
pub use super::progress::{End, Progress};
pub use super::special::ResumeMismatch;

/// A branch being computed from a problem.
pub struct Runner {
    problem: Problem,
    continuation: Continuation,
    /// The model of the first wave.
    model: Model,
    method: Method,
    /// The vertical family before the first wave, until it is handed out.
    family: Option<Family>,
    progress: Progress,
    follower: Follower,
    notes: Vec<Note>,
}

impl Runner {
    /// Finds the first wave. `restart` is the wave that `start: Restart(…)` names.
    ///
    /// # Errors
    /// The problem asks for what is not there, or there is no first wave.
    pub fn begin(
        problem: &Problem,
        continuation: &Continuation,
        restart: Option<&SavedWave>,
    ) -> Result<Runner, RunError> {
        Runner::begin_watched(problem, continuation, restart, &mut |_| {})
    }

    /// [`Runner::begin`], with somebody told where the search for the first wave is.
    ///
    /// # Errors
    /// The problem asks for what is not there, or there is no first wave.
    pub(crate) fn begin_watched(
        problem: &Problem,
        continuation: &Continuation,
        restart: Option<&SavedWave>,
        observer: Observer,
    ) -> Result<Runner, RunError> {
        let Begun {
            wave,
            point,
            model,
            family,
        } = begin(problem, continuation, restart, observer)?;
        let progress = Progress::new(&wave, &point, problem, continuation);
        let runner = Runner::at(problem, continuation, model, wave.method, progress);
        Ok(Runner {
            family,
            ..runner.map_err(|reason| NoStart::Newton(reason.into()))?
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
        progress: Progress,
    ) -> Result<Runner, ResumeMismatch> {
        let model = saved.model;
        let method = problem.method.unwrap_or(Method::cheapest(model.law));
        Runner::at(problem, continuation, model, method, progress)
    }

    fn at(
        problem: &Problem,
        continuation: &Continuation,
        model: Model,
        method: Method,
        progress: Progress,
    ) -> Result<Runner, ResumeMismatch> {
        Ok(Runner {
            follower: progress.follower(problem, continuation, model, method)?,
            problem: problem.clone(),
            continuation: continuation.clone(),
            model,
            method,
            family: None,
            progress,
            notes: Vec::new(),
        })
    }

    /// The state after the last step.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Takes one step and returns the points found; empty once the run has ended.
    pub fn step(&mut self) -> Vec<Item> {
        if self.progress.end.is_some() {
            return Vec::new();
        }
        let mut tracker = self.problem.request().map(|request| {
            let (last, left) = (self.progress.spectrum.take(), self.progress.allowance);
            Tracker::new(request, last, self.continuation.tolerance, left)
        });
        if self.progress.state.is_none() {
            return self.first_step(tracker.as_mut());
        }
        let from = (
            self.follower.curve().orbit.clone(),
            self.follower.node().clone(),
        );
        let (found, end) = self.follower.step();
        let mut tracked = Tracked::default();
        if let Some(tracker) = &mut tracker {
            let passed: Vec<Passed> = found.iter().map(passed).collect();
            tracked = tracker.step(&from.0, &from.1, &passed);
            self.take_over(tracker);
        }
        let mut items = Vec::with_capacity(found.len() + tracked.crossings.len());
        let stopped = self.add(&mut items, &from.0, found, tracked);
        self.progress.state = Some(self.follower.state());
        match end {
            _ if stopped => self.end_leg(None, true),
            None => self.check_points(&mut items),
            Some(
                walk::End::Edge
                | walk::End::Closed
                | walk::End::Own(Stop::Own(WaveStop::SlipAlone)),
            ) => self.end_leg(None, false),
            Some(end) => self.end_leg(Some(Failure::Ended(Box::new(end))), false),
        }
        items
    }

    /// The first points of a leg: the waves of a vertical family, the first wave.
    fn first_step(&mut self, tracker: Option<&mut Tracker>) -> Vec<Item> {
        let mut items = self.family();
        let mut found = self.follower.here();
        if items.is_empty() {
            found.special = Some(Special::Start);
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
        self.progress.state = Some(self.follower.state());
        self.check_points(&mut items);
        items
    }

    /// Adds the points and the crossings of a step in order. Returns whether the run is to stop there.
    fn add(
        &mut self,
        items: &mut Vec<Item>,
        wave: &Arc<Wave>,
        found: Vec<Found>,
        tracked: Tracked,
    ) -> bool {
        let Tracked {
            crossings,
            spectra,
            mut remark,
        } = tracked;
        let parameter = self.continuation.parameter;
        let last = found.len().saturating_sub(1);
        let mut spectra = spectra.into_iter();
        let mut crossings = crossings.into_iter().peekable();
        for (index, mut found) in found.into_iter().enumerate() {
            let value = found.parameter;
            while let Some(crossing) = crossings.next_if(|(located, _)| located.s < found.s) {
                let item = self.crossing(wave, crossing);
                if item.is_none() {
                    self.notes.push(Note::CrossingLeftOut { parameter, value });
                }
                let kind = item.as_ref().and_then(|item| item.point.kind);
                items.extend(item);
                if self.stop_requested(kind) {
                    return true;
                }
            }
            match &mut found.special {
                Some(Special::Change(change)) if found.entered.is_some() => {
                    change.spectrum = remark.take();
                }
                special if special.is_none() || index == last => {
                    let note = |remark| Note::Spectrum {
                        parameter,
                        value,
                        remark,
                    };
                    self.notes.extend(remark.clone().map(note));
                }
                _ => {}
            }
            if let Some(what) = found.close {
                self.notes.push(Note::Close {
                    parameter,
                    value,
                    what,
                });
            }
            let kind = found.kind();
            let spectrum = spectra.next().flatten();
            items.push(self.item(found, spectrum.as_ref()));
            if self.stop_requested(kind) {
                return true;
            }
        }
        false
    }

    /// Ends a leg that has as many points as it may, with a row that says so.
    fn check_points(&mut self, items: &mut Vec<Item>) {
        let most = self.continuation.most_points(self.model.law);
        if self.progress.points - self.progress.before_leg < most {
            return;
        }
        let end: Ending = walk::End::MaxPoints { most };
        let failure = Failure::Ended(Box::new(end));
        let found = Found {
            special: Some(Special::Failed(failure.clone())),
            ..self.follower.here()
        };
        let spectrum = self.progress.spectrum.clone();
        items.push(self.item(found, spectrum.as_ref()));
        self.end_leg(Some(failure), false);
    }

    /// The waves at the Hopf point, from steady sliding to where a stick zone opens.
    fn family(&mut self) -> Vec<Item> {
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
                item.point.why = vec![Reason::Family];
            }
            items.push(item);
        }
        items
    }

    /// Whether a `stop_after` entry is met by a point of this kind.
    fn stop_requested(&mut self, kind: Option<EventType>) -> bool {
        let mut stop = false;
        let entries = &self.continuation.stop_after;
        for (met, wanted) in self.progress.met.iter_mut().zip(entries) {
            if Some(wanted.event) == kind {
                *met += 1;
                stop |= *met >= wanted.count;
            }
        }
        stop
    }

    /// A crossing of the imaginary axis as a point of the branch.
    fn crossing(&mut self, wave: &Arc<Wave>, (located, spectrum): Crossing) -> Option<Item> {
        let examination = examine(wave, &located.node.point).ok()?;
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

    /// Ends a leg; the next one begins unless the whole run is to stop.
    fn end_leg(&mut self, failure: Option<Failure>, stop: bool) {
        if let Some(reason) = failure {
            self.progress.failure.get_or_insert(reason);
        }
        let another = self.progress.leg < legs(self.continuation.toward).len();
        if another && !stop {
            let next = Progress {
                leg: self.progress.leg + 1,
                before_leg: self.progress.points,
                state: None,
                passed: vec![false; self.problem.output.profiles],
                ..self.progress.clone()
            };
            let (problem, continuation) = (&self.problem, &self.continuation);
            match next.follower(problem, continuation, self.model, self.method) {
                Ok(follower) => {
                    self.follower = follower;
                    self.progress = next;
                    return;
                }
                Err(reason) => {
                    self.progress.failure.get_or_insert(Failure::NoLeg(reason));
                }
            }
        }
        self.progress.end = Some(match self.progress.failure.clone() {
            Some(reason) => End::Failed(reason),
            None => End::Finished,
        });
    }

    fn item(&mut self, found: Found, spectrum: Option<&Spectrum>) -> Item {
        let model = self.model.with(found.orbit.parameter, found.parameter);
        let mut point = row(&found, &model);
        self.progress.points += 1;
        point.point = self.progress.points;
        // a special point serves as the sample of its part of the range
        let sampled = self.passes_profile_target(found.parameter);
        if point.kind.is_some() || sampled {
            self.progress.labels += 1;
            point.label = Some(self.progress.labels);
        }
        point.conditioning = self.known_to(&found.orbit, &found.node);
        let special = found.special.as_ref();
        let event = special.map(|special| event(&point, special, &found));
        self.progress.events += usize::from(event.is_some());
        self.judge(&mut point, &found, spectrum);
        let eigenvalues = match (point.label, spectrum, &self.problem.stability) {
            (Some(_), Some(spectrum), Some(section)) => spectrum
                .leading(section.eigenvalues)
                .map(|(sector, eigenvalue)| EigenvalueRow::new(sector, eigenvalue))
                .collect(),
            _ => Vec::new(),
        };
        self.progress.eigenvalues += eigenvalues.len();
        let unknowns = found.node.point;
        let saved = point.label;
        let saved = saved.map(|label| SavedWave::new(label, model, &found.orbit, &unknowns));
        Item {
            point,
            leg: self.progress.leg,
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
            point.why.push(Reason::OnAxis);
        }
        if self.progress.allowance == 0 && spectrum.is_none() {
            for reason in point.why.iter_mut().filter(|one| **one == Reason::NoWindow) {
                *reason = Reason::Spent;
            }
        }
        let mut reasons = point.why.iter();
        let incomplete = reasons.find(|reason| matches!(reason, Reason::Incomplete { .. }));
        let mut notes = self.notes.iter();
        let noted = notes.any(|note| matches!(note, Note::Incomplete { .. }));
        if let (Some(reason), false) = (incomplete, noted) {
            self.notes.push(Note::Incomplete {
                point: point.point,
                reason: reason.clone(),
            });
        }
    }

    /// Takes over from a step what is known of the spectrum and what is left of the allowance, and notes
    /// its end.
    fn take_over(&mut self, tracker: &Tracker) {
        self.progress.spectrum = tracker.last().cloned();
        let before = self.progress.allowance;
        self.progress.allowance = match tracker.allowance() {
            0 => 0,
            left => ALLOWANCE.min(left + PER_POINT),
        };
        if before > 0 && self.progress.allowance == 0 {
            self.notes.push(Note::Spent {
                points: self.progress.points,
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
            self.notes.push(Note::NotConverged {
                point: self.progress.points,
                parameter: self.continuation.parameter,
                value: wave.parameter_at(&node.point),
                tolerance,
                known,
            });
        }
        Some((known.condition, known.expected_error))
    }

    /// Whether a point is the first of its leg in one of the equal parts of the range from which
    /// a profile is wanted.
    fn passes_profile_target(&mut self, value: f64) -> bool {
        let (low, high) = self.continuation.range;
        let count = self.progress.passed.len();
        if count == 0 {
            return false;
        }
        let width = (high - low) / count as f64;
        let cell = ((value - low) / width)
            .floor()
            .clamp(0.0, (count - 1) as f64) as usize;
        let new = !self.progress.passed[cell];
        self.progress.passed[cell] = true;
        new
    }

    /// What could not be settled so far.
    pub fn notes(&self) -> &[Note] {
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

    /// Share of the way to the ends of the range behind the branch, for progress.
    pub fn position(&self) -> f64 {
        let (low, high) = self.continuation.range;
        let directions = legs(self.continuation.toward);
        let leg = self.progress.leg.clamp(1, directions.len());
        let edge = if directions[leg - 1] { high } else { low };
        let first = self.model.value(self.continuation.parameter).unwrap_or(low);
        let part = (self.follower.here().parameter - first) / (edge - first);
        let behind = (leg - 1) as f64 + part.clamp(0.0, 1.0);
        behind / directions.len() as f64
    }
}

/// A point found, as far as the spectrum is concerned.
fn passed(found: &Found) -> Passed<'_> {
    let entered = found.entered.as_ref();
    Passed {
        s: found.s,
        wave: &found.orbit,
        node: &found.node,
        folds: matches!(found.special, Some(Special::Fold(_))),
        entered: entered.map(|(wave, node)| (wave.as_ref(), node)),
    }
}
