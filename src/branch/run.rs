//! The pipeline from a problem to a branch: first wave, legs, points, labels and events.
//!
//! A [`Runner`] is advanced one step at a time and hands out what it found; it prints nothing and
//! touches no file. Its [`Progress`] after any step is all that is needed to go on from there.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::begin::{Begun, begin};
use super::conditioning::conditioning;
use super::first_wave;
use super::follow::{Follower, Found, Limits, State};
use super::row::EigenvalueRow;
use super::saved::{SavedWave, finite};
use super::special::{Ending, Failure, NoFollower, Note, Special};
use super::{BranchPoint, Event, EventType, LeadingEigenvalue, ProfileSample, Reason, Stability};
use crate::continuation::newton::System;
use crate::continuation::walk;
use crate::continuation::{Node, Steps};
use crate::flow::FlowError;
use crate::flow::method::Method;
use crate::linalg::Vector;
use crate::model::signature::Signature;
use crate::model::{Model, Parameter};
use crate::problem::{Continuation, Problem, Toward};
use crate::stability::characteristic::Characteristic;
use crate::stability::spectrum::{Request, Spectrum};
use crate::stability::track::{ALLOWANCE, Crossing, PER_POINT, Passed, Tracked, Tracker};
use crate::wave::admissibility::examine;
use crate::wave::hopf::Family;
use crate::wave::{Scales, Wave, profile};

pub use super::begin::{Refused, RunError};

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum End {
    /// All that was asked for was done.
    Finished,
    /// The branch ended before its range.
    Failed(Failure),
}

/// Saved progress that is none of its problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// It is of another problem.
    #[error("the saved progress does not fit its problem")]
    Progress,
    /// The first wave has other unknowns.
    #[error("the first wave does not fit its signature")]
    FirstWave,
    /// The branch does not go on from it.
    #[error("{0}")]
    State(#[from] NoFollower),
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

/// A row of the branch, with the wave behind it.
#[derive(Clone, Debug)]
pub struct Item {
    /// The row.
    pub point: BranchPoint,
    /// Leg it belongs to.
    pub leg: usize,
    /// The event, at special points.
    pub event: Option<Event>,
    /// What makes the point special.
    pub special: Option<Special>,
    /// The wave in physical numbers, at labelled points.
    pub saved: Option<SavedWave>,
    /// Leading eigenvalues by sector at labelled points.
    pub eigenvalues: Vec<EigenvalueRow>,
    wave: Arc<Wave>,
    unknowns: Vector,
}

impl Item {
    /// The wave as a boundary-value problem and its solution in scaled unknowns.
    pub fn wave(&self) -> (&Wave, &Vector) {
        (&self.wave, &self.unknowns)
    }

    /// Samples of the wave over one wavelength.
    pub fn profile(&self, resolution: usize) -> Result<Vec<ProfileSample>, FlowError> {
        profile::sample(&self.wave, &self.unknowns, resolution)
    }
}

/// A branch being computed from a problem.
pub struct Runner {
    model: Model,
    mode: u32,
    method: Method,
    continuation: Continuation,
    profiles: usize,
    conditioning: bool,
    family: Option<Family>,
    progress: Progress,
    follower: Follower,
    stability: Option<Request>,
    notes: Vec<Note>,
    /// Whether an incomplete spectrum has been noted.
    incomplete: bool,
}

/// Writes the stability of a wave into its point; `None` where its spectrum is not known.
pub fn answer(
    point: &mut BranchPoint,
    spectrum: Option<&Spectrum>,
    wave: &Wave,
    unknowns: &Vector,
) {
    let spectrum = spectrum.filter(|spectrum| !spectrum.sectors.is_empty());
    let lead = spectrum.and_then(Spectrum::lead);
    point.stable = Some(spectrum.map_or(Stability::Undecided, |spectrum| spectrum.stable));
    point.unstable = spectrum.map(Spectrum::unstable);
    point.lead = lead.map(|(eigenvalue, sector)| LeadingEigenvalue {
        re: eigenvalue.re,
        im: eigenvalue.im,
        sector,
    });
    point.why = match spectrum {
        Some(spectrum) => spectrum.reasons.clone(),
        None => vec![match Characteristic::new(wave, unknowns) {
            Err(error) => Reason::NotLinearised(error.to_string()),
            Ok(_) => Reason::NoWindow,
        }],
    };
}

fn limits(continuation: &Continuation) -> Limits {
    Limits {
        range: continuation.range,
        stop_at: continuation.stop_at.clone(),
        steps: steps(continuation),
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

fn pack_scales(scales: &Scales) -> [f64; 6] {
    [
        scales.time,
        scales.rate,
        scales.excess,
        scales.parameter,
        scales.pressure,
        scales.layer,
    ]
}

fn unpack_scales([time, rate, excess, parameter, pressure, layer]: [f64; 6]) -> Scales {
    Scales {
        time,
        rate,
        excess,
        parameter,
        pressure,
        layer,
    }
}

/// Directions of the legs.
fn legs(toward: Toward) -> &'static [bool] {
    match toward {
        Toward::Down => &[false],
        Toward::Up => &[true],
        Toward::Both => &[false, true],
    }
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
    pub fn begin_watched(
        problem: &Problem,
        continuation: &Continuation,
        restart: Option<&SavedWave>,
        watch: first_wave::Watch,
    ) -> Result<Runner, RunError> {
        let Begun {
            wave,
            point,
            model,
            family,
        } = begin(problem, continuation, restart, watch)?;
        let progress = Progress {
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
            scales: pack_scales(&wave.scales),
            state: None,
            failure: None,
            end: None,
        };
        let up = legs(continuation.toward)[0];
        let method = wave.method;
        let follower = Follower::new(wave, &point, up, limits(continuation))
            .map_err(|reason| first_wave::NoStart::Newton(reason.into()))?;
        Ok(Runner {
            family,
            method,
            ..Runner::at(problem, continuation, model, progress, follower)
        })
    }

    fn at(
        problem: &Problem,
        continuation: &Continuation,
        model: Model,
        progress: Progress,
        follower: Follower,
    ) -> Runner {
        Runner {
            model,
            mode: problem.wave.mode,
            method: problem.method.unwrap_or(Method::cheapest(model.law)),
            continuation: continuation.clone(),
            profiles: problem.output.profiles,
            conditioning: problem.output.conditioning,
            family: None,
            progress,
            follower,
            stability: problem.request(),
            notes: Vec::new(),
            incomplete: false,
        }
    }

    /// Goes on from saved progress.
    ///
    /// # Errors
    /// When the progress is not one that a run of this problem leaves.
    pub fn resume(
        problem: &Problem,
        continuation: &Continuation,
        saved: &SavedWave,
        progress: Progress,
    ) -> Result<Runner, Unfit> {
        let model = saved.model;
        let (signature, point) = progress.first.clone();
        let leg = progress.leg.checked_sub(1);
        let up = leg.and_then(|leg| legs(continuation.toward).get(leg));
        let fits = progress.met.len() == continuation.stop_after.len()
            && progress.passed.len() == problem.output.profiles
            && progress.spectrum.iter().all(|spectrum| {
                let found = spectrum.sectors.iter().map(|sector| sector.sector);
                problem
                    .request()
                    .is_some_and(|request| found.eq(request.sectors))
            })
            && !signature.is_empty()
            && finite(&progress.scales)
            && finite(&point);
        let (Some(up), true) = (up, fits) else {
            return Err(Unfit::Progress);
        };
        let first = Wave::new(
            model,
            continuation.parameter,
            problem.wave.mode,
            signature,
            unpack_scales(progress.scales),
        )
        .with_method(problem.method.unwrap_or(Method::cheapest(model.law)));
        if point.len() != first.unknowns() {
            return Err(Unfit::FirstWave);
        }
        let follower = match &progress.state {
            Some(state) => Follower::resume(&first, state.clone(), limits(continuation)),
            None => Follower::new(first, &Vector::from_vec(point), *up, limits(continuation)),
        }?;
        // a vertical family was handed out before anything was saved
        Ok(Runner::at(problem, continuation, model, progress, follower))
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
        let mut tracker = self.stability.clone().map(|request| {
            let (last, left) = (self.progress.spectrum.take(), self.progress.allowance);
            Tracker::new(request, last, self.continuation.tolerance, left)
        });
        if self.progress.state.is_none() {
            return self.first_step(tracker.as_mut());
        }
        let from = (
            self.follower.curve().wave.clone(),
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
            Some(walk::End::Edge | walk::End::Closed) => self.end_leg(None, false),
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
            let spectrum = tracker.start(&found.wave, &found.node);
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
            while let Some(crossing) = crossings.next_if(|crossing| crossing.s < found.s) {
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
                wave: wave.clone(),
                s: 0.0,
                entered: None,
                parameter: family.critical,
                node: Node {
                    point,
                    tangent,
                    newton: 0,
                    residual: 0.0,
                },
                examination,
                special: match index {
                    0 => Some(Special::HopfPoint),
                    _ if index == last => Some(Special::StickOpens),
                    _ => None,
                },
                uncertainty: 8.0 * f64::EPSILON * family.critical,
            };
            let mut item = self.item(found, None);
            if self.stability.is_some() {
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
    fn crossing(&mut self, wave: &Arc<Wave>, crossing: Crossing) -> Option<Item> {
        let found = Found {
            wave: wave.clone(),
            s: crossing.s,
            entered: None,
            parameter: wave.parameter_at(&crossing.node.point),
            examination: examine(wave, &crossing.node.point).ok()?,
            node: crossing.node,
            special: Some(Special::Crossing {
                sector: crossing.sector,
                omega: (crossing.omega != 0.0).then_some(crossing.omega),
                grows: crossing.grows,
            }),
            uncertainty: crossing.uncertainty * wave.scales.parameter,
        };
        Some(self.item(found, Some(&crossing.spectrum)))
    }

    /// Ends a leg; the next one begins unless the whole run is to stop.
    fn end_leg(&mut self, failure: Option<Failure>, stop: bool) {
        if let Some(reason) = failure {
            self.progress.failure.get_or_insert(reason);
        }
        let directions = legs(self.continuation.toward);
        if let Some(up) = directions.get(self.progress.leg).filter(|_| !stop) {
            let (signature, point) = self.progress.first.clone();
            let first = Wave::new(
                self.model,
                self.continuation.parameter,
                self.mode,
                signature,
                unpack_scales(self.progress.scales),
            )
            .with_method(self.method);
            let point = Vector::from_vec(point);
            match Follower::new(first, &point, *up, limits(&self.continuation)) {
                Ok(follower) => {
                    self.follower = follower;
                    self.progress.leg += 1;
                    self.progress.before_leg = self.progress.points;
                    self.progress.state = None;
                    self.progress.passed = vec![false; self.profiles];
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
        let wave = &found.wave;
        let unknowns = &found.node.point;
        let model = self.model.with(wave.parameter, found.parameter);
        let kind = found.kind();
        self.progress.points += 1;
        // a special point serves as the sample of its part of the range
        let sampled = self.passes_profile_target(found.parameter);
        let label = (kind.is_some() || sampled).then(|| {
            self.progress.labels += 1;
            self.progress.labels
        });
        let examination = &found.examination;
        let (low, high) = examination.tangential;
        let mut point = BranchPoint {
            point: self.progress.points,
            label,
            kind,
            regimes: wave.signature.to_string(),
            model,
            speed: wave.speed_at(unknowns),
            switches: profile::switches(wave, unknowns),
            min_pressure: examination.least_pressure,
            max_gap: examination.largest_gap,
            amplitude: 0.5 * (high - low),
            stable: None,
            unstable: None,
            lead: None,
            why: Vec::new(),
            newton: found.node.newton,
            residual: found.node.residual,
            conditioning: self.known_to(wave, &found.node),
        };
        let event = match (&found.special, label) {
            (Some(special), Some(label)) => Some(event(&point, label, special, found.uncertainty)),
            _ => None,
        };
        self.progress.events += usize::from(event.is_some());
        self.judge(&mut point, &found, spectrum);
        let saved = label.map(|label| SavedWave::new(label, model, wave, unknowns));
        let eigenvalues = match (label, spectrum, &self.stability) {
            (Some(_), Some(spectrum), Some(request)) => spectrum
                .leading(request.eigenvalues)
                .map(|(sector, eigenvalue)| EigenvalueRow::new(sector, eigenvalue))
                .collect(),
            _ => Vec::new(),
        };
        self.progress.eigenvalues += eigenvalues.len();
        Item {
            point,
            leg: self.progress.leg,
            eigenvalues,
            event,
            special: found.special,
            saved,
            unknowns: found.node.point,
            wave: found.wave,
        }
    }

    /// Writes the stability of a point found into its row.
    fn judge(&mut self, point: &mut BranchPoint, found: &Found, spectrum: Option<&Spectrum>) {
        if self.stability.is_none() {
            return;
        }
        answer(point, spectrum, &found.wave, &found.node.point);
        // on the imaginary axis itself nothing is decided
        let on_axis = matches!(found.special, Some(Special::Crossing { .. }));
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
        if let (Some(reason), false) = (incomplete, self.incomplete) {
            self.incomplete = true;
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
        if !self.conditioning {
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
    pub fn with_stability(&self) -> bool {
        self.stability.is_some()
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
        wave: &found.wave,
        node: &found.node,
        folds: matches!(found.special, Some(Special::Fold(_))),
        entered: entered.map(|(wave, node)| (wave.as_ref(), node)),
    }
}

/// The row of an event at a point.
fn event(point: &BranchPoint, label: usize, special: &Special, uncertainty: f64) -> Event {
    let (sector, omega) = match special {
        Special::Crossing { sector, omega, .. } => (Some(*sector), *omega),
        _ => (None, None),
    };
    let after = special.after();
    Event {
        label,
        kind: special.kind(),
        model: point.model,
        speed: point.speed,
        sector,
        omega,
        regimes_before: point.regimes.clone(),
        regimes_after: after.map_or_else(|| point.regimes.clone(), |after| after.to_string()),
        uncertainty,
        what: special.to_string(),
    }
}
