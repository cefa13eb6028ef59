//! The pipeline from a problem to a branch: first wave, legs, points, labels and events.
//!
//! A [`Branch`] is advanced one step at a time and hands out what it found; it prints nothing and
//! touches no file. Its [`Progress`] after any step is all that is needed to go on from there.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::begin::{self, NoStart};
use crate::branch::{
    BranchPoint, Event, EventType, LeadingEigenvalue, ProfileSample, Reason, Stability,
};
use crate::conditioning::{Conditioning, conditioning};
use crate::continuation::{self, Node};
use crate::flow::FlowError;
use crate::flow::method::Method;
use crate::follow::{Follower, Found, Settings, State, Status};
use crate::linalg::Vector;
use crate::model::signature::{Regime, Signature};
use crate::model::{FrictionLaw, Model, Parameter};
use crate::newton::{self, System};
use crate::problem::{Continuation, Problem, Start, Toward};
use crate::stability::characteristic::Characteristic;
use crate::stability::spectrum::{Request, Spectrum};
use crate::stability::track::{ALLOWANCE, Crossing, PER_POINT, Tracked, Tracker};
use crate::wave::admissibility::examine;
use crate::wave::hopf::{Family, NoHopf, family};
use crate::wave::start::{NoWave, Which};
use crate::wave::{Scales, Wave, ZoneUnknowns, profile};

/// Why a run cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunError {
    /// Something the problem asks for that this version does not do, or a bad restart.
    #[error("{0}")]
    Input(String),
    /// The same, said of a field of the problem.
    #[error("{message}")]
    Asked {
        /// Path of the field.
        path: &'static str,
        /// What is wrong.
        message: String,
        /// What would be right.
        help: &'static str,
    },
    /// There is no first wave.
    #[error("no start: {0}")]
    NoStart(#[from] NoStart),
    /// There is no Hopf point to start from.
    #[error("no start: {0}")]
    NoHopf(#[from] NoHopf),
}

impl RunError {
    /// The path of the field of the problem that this is about, and what would be right there.
    pub fn about(&self) -> Option<(&'static str, &'static str)> {
        let friction = "model.friction";
        let mass = "model.damping.mass";
        let stiffness = "model.damping.stiffness";
        let mismatch = "model.mismatch";
        let elsewhere = "begin at other values of the model, or restart from a wave near these";
        Some(match self {
            RunError::Input(_) => return None,
            RunError::Asked { path, help, .. } => (*path, *help),
            RunError::NoStart(NoStart::NoWave(reason)) => match reason {
                NoWave::Uncoupled => ("model.coefficients", "take coefficients with D ≠ 0"),
                NoWave::Frictionless => (friction, "write for example `friction: 0.5`"),
                NoWave::BeyondFold { .. } => (friction, "take a smaller friction coefficient"),
                NoWave::BeyondHopf { .. } => (mass, "take less damping, or more friction"),
            },
            RunError::NoStart(NoStart::Damped { .. }) => (
                stiffness,
                "take less damping, or follow the branch to it in StiffnessDamping from 0",
            ),
            RunError::NoStart(NoStart::Unreached { .. }) => (
                mismatch,
                "take a larger mismatch, or follow the branch to it in Mismatch",
            ),
            RunError::NoStart(NoStart::Smoothing { .. }) => (
                "model.friction_law",
                "write `friction_law: Coulomb`, or take another ε",
            ),
            RunError::NoStart(NoStart::Flow(_) | NoStart::Newton(_)) => ("wave.start", elsewhere),
            RunError::NoHopf(reason) => match reason {
                NoHopf::Parameter => (
                    "continuation.parameter",
                    "write for example `parameter: MassDamping`",
                ),
                NoHopf::Zero { missing: "f" } => (friction, "write for example `friction: 0.5`"),
                NoHopf::Zero { .. } => (
                    "model.damping",
                    "give damping, for example `damping: (mass: 0.1)`, or continue in MassDamping",
                ),
                NoHopf::Stable { .. } => ("wave.start", "take less damping, or more friction"),
                NoHopf::Separation { .. } => (mismatch, "take a mismatch above that value"),
            },
        })
    }
}

/// A wave in physical numbers: what a restart needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedWave {
    /// Label.
    pub label: usize,
    /// Value of the continuation parameter and of all others.
    #[serde(with = "crate::model::saved")]
    pub model: Model,
    /// Signature.
    pub signature: Signature,
    /// (Y, W, T) of each zone: Y = V − fgδ/h and W = V̇ at its entry, duration T.
    pub zones: Vec<[f64; 3]>,
    /// Layer G at the end of each zone; none without material damping.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<f64>,
    /// Excess speed e = |c|/√a − 1.
    pub excess: f64,
}

impl SavedWave {
    fn new(label: usize, model: Model, wave: &Wave, point: &Vector) -> SavedWave {
        let zones = wave.unpack(point);
        let layers = zones.iter().map(|zone| zone[3]);
        SavedWave {
            label,
            model,
            signature: wave.signature.clone(),
            zones: zones.iter().map(|[y, w, t, _]| [*y, *w, *t]).collect(),
            layers: layers
                .take(if wave.material { zones.len() } else { 0 })
                .collect(),
            excess: wave.excess_at(point),
        }
    }

    /// Whether every zone has its numbers and all of them are finite: a damaged file may say otherwise.
    pub fn is_whole(&self) -> bool {
        let known = |parameter| self.model.value(parameter).is_none_or(f64::is_finite);
        let zones = self.signature.len();
        zones > 0
            && self.zones.len() == zones
            && (self.layers.is_empty() || self.layers.len() == zones)
            && finite(self.zones.as_flattened())
            && finite(&self.layers)
            && Parameter::ALL.into_iter().all(known)
            && self.excess.is_finite()
    }

    /// The wave as a boundary-value problem in `parameter`, of which `width` is the unit.
    pub fn wave(&self, parameter: Parameter, mode: u32, width: f64) -> Wave {
        let largest = self
            .zones
            .iter()
            .fold(1.0_f64, |size, [_, w, _]| size.max(w.abs()));
        let scales = begin::scales(&self.model, mode, self.excess, largest, width);
        Wave::new(self.model, parameter, mode, self.signature.clone(), scales)
    }

    /// (Y, W, T, G) of each zone.
    pub fn unknowns(&self) -> Vec<ZoneUnknowns> {
        let layers = self.layers.iter().copied().chain(std::iter::repeat(0.0));
        let zones = self.zones.iter().zip(layers);
        zones
            .map(|([y, w, t], layer)| [*y, *w, *t, layer])
            .collect()
    }
}

fn finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum End {
    /// All that was asked for was done.
    Finished,
    /// The branch ended before its range.
    Failed(String),
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
    pub failure: Option<String>,
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
    /// The wave in physical numbers, at labelled points.
    pub saved: Option<SavedWave>,
    /// Leading eigenvalues by sector at labelled points: sector, Re λ, Im λ, error.
    pub eigenvalues: Vec<(usize, [f64; 3])>,
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
pub struct Branch {
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
    notes: Vec<String>,
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

fn which(start: &Start) -> Option<Which> {
    match start {
        Start::Fast => Some(Which::Fast),
        Start::Slow => Some(Which::Slow),
        Start::Hopf => Some(Which::Fast),
        Start::Restart { .. } => None,
    }
}

fn settings(continuation: &Continuation) -> Settings {
    Settings {
        range: continuation.range,
        stop_at: continuation.stop_at.clone(),
        continuation: step_settings(continuation),
    }
}

fn step_settings(continuation: &Continuation) -> continuation::Settings {
    continuation::Settings {
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

/// Waves shown of the vertical family at a Hopf point.
const FAMILY: usize = 11;

/// The slip-stick branch is entered at this relative distance from the Hopf point: its stick zone is
/// there like the square root of it.
const BEYOND_HOPF: f64 = 1e-9;

/// Relative residual up to which a saved wave is taken as it is: rounding leaves about 1e-13.
const RESTART_RESIDUAL: f64 = 1e-11;

/// Most eigenvalues of a sector that a spectrum may take in: one of so many takes half a minute.
const MOST_EIGENVALUES: f64 = 2e4;

/// Directions of the legs.
fn legs(toward: Toward) -> &'static [bool] {
    match toward {
        Toward::Down => &[false],
        Toward::Up => &[true],
        Toward::Both => &[false, true],
    }
}

impl Branch {
    /// Finds the first wave. `restart` is the wave that `start: Restart(…)` names.
    pub fn begin(
        problem: &Problem,
        continuation: &Continuation,
        restart: Option<&SavedWave>,
    ) -> Result<Branch, RunError> {
        Branch::begin_watched(problem, continuation, restart, &mut |_| {})
    }

    /// [`Branch::begin`], with somebody told where the search for the first wave is.
    pub fn begin_watched(
        problem: &Problem,
        continuation: &Continuation,
        restart: Option<&SavedWave>,
        watch: begin::Watch,
    ) -> Result<Branch, RunError> {
        let parameter = continuation.parameter;
        let mut model = problem.model;
        let material = model.has_material_damping(parameter);
        if material && model.law != FrictionLaw::Coulomb {
            return Err(RunError::Asked {
                path: "model.friction_law",
                message:
                    "material damping β > 0 is posed for Coulomb's law, also as the parameter \
                          of a branch"
                        .into(),
                help: "leave out `friction_law`, or take `damping: (stiffness: 0)` and another \
                       parameter",
            });
        }
        if material && problem.method.is_some_and(|method| method != Method::Exact) {
            return Err(RunError::Asked {
                path: "method",
                message: "with material damping β > 0 the waves are solved in closed form".into(),
                help: "write `method: Exact`, or leave it out",
            });
        }
        let width = continuation.range.1 - continuation.range.0;
        let mode = problem.wave.mode;
        let mut opened = None;
        let family = match problem.wave.start {
            Start::Hopf => {
                let found = family(&model, parameter, mode, width, FAMILY)?;
                let (low, high) = continuation.range;
                if !(low..=high).contains(&found.critical) {
                    return Err(RunError::Asked {
                        path: "continuation.range",
                        message: format!(
                            "the Hopf point of mode {mode} lies at {} = {:.15}, outside the range \
                             ({low}, {high})",
                            parameter.column(),
                            found.critical
                        ),
                        help: "widen the range to contain the Hopf point",
                    });
                }
                if material {
                    let (wave, point) = begin::beyond_hopf(&found, step_settings(continuation))
                        .map_err(NoStart::Newton)?;
                    model = wave.model_at(&point);
                    opened = Some((wave, point));
                } else {
                    let beyond = match parameter {
                        Parameter::MassDamping => 1.0 - BEYOND_HOPF,
                        _ => 1.0 + BEYOND_HOPF,
                    };
                    model = model.with(parameter, found.critical * beyond);
                }
                Some(found)
            }
            _ => None,
        };
        let (wave, point) = match (opened, which(&problem.wave.start), restart) {
            (Some(found), ..) => found,
            (None, Some(which), _) => begin::search_first_wave(
                &model,
                parameter,
                mode,
                which,
                width,
                &mut begin::Search {
                    steps: step_settings(continuation),
                    watch,
                },
            )?,
            (None, None, Some(saved)) => {
                let impact = model.impact;
                model = saved.model;
                model.impact = impact;
                let value = model.value(parameter).unwrap_or(f64::NAN);
                let (low, high) = continuation.range;
                if !(value >= low && value <= high) {
                    return Err(RunError::Asked {
                        path: "continuation.range",
                        message: format!(
                            "label {} has {} = {value}, outside the range ({low}, {high})",
                            saved.label,
                            parameter.column()
                        ),
                        help: "widen the range to contain the point to restart from",
                    });
                }
                let saved = SavedWave {
                    model,
                    ..saved.clone()
                };
                let mut wave = saved.wave(parameter, mode, width);
                let mut guess = wave.pack(&saved.unknowns(), saved.excess, value);
                if wave.material && wave.signature.has(Regime::Separation) {
                    return Err(RunError::Asked {
                        path: "wave.start.label",
                        message: format!(
                            "label {} is a wave with separation, which is not covered with material \
                             damping",
                            saved.label
                        ),
                        help: "restart from a wave in contact all round",
                    });
                }
                if wave.material && saved.layers.is_empty() {
                    (wave, guess) = wave.with_layers(&guess).map_err(NoStart::Flow)?;
                }
                // a saved wave solves its equations already; at a fold polishing it at a fixed
                // parameter would fail
                let solved = newton::jacobian(&wave, &guess)
                    .is_ok_and(|(_, residual)| residual <= RESTART_RESIDUAL);
                let point = if solved {
                    guess
                } else {
                    begin::polish(&wave, &guess)?
                };
                (wave, point)
            }
            (None, None, None) => {
                return Err(RunError::Input(
                    "the wave to restart from is missing".into(),
                ));
            }
        };
        let (wave, point) = match problem.method {
            Some(method) if method != wave.method => {
                let wave = wave.with_method(method);
                let point = begin::polish(&wave, &point)?;
                (wave, point)
            }
            _ => (wave, point),
        };
        if let Some(request) = problem.request() {
            let period: f64 = wave.unpack(&point).iter().map(|zone| zone[2]).sum();
            let count = request.max_frequency * period / std::f64::consts::PI;
            if count > MOST_EIGENVALUES {
                let most = MOST_EIGENVALUES * std::f64::consts::PI / period;
                return Err(RunError::Asked {
                    path: "stability.max_frequency",
                    message: format!(
                        "max_frequency = {:e} takes in about {count:.0e} eigenvalues in each sector at \
                         each point; lower it below {most:.0e}",
                        request.max_frequency
                    ),
                    help: "write for example `max_frequency: 12.0`",
                });
            }
        }
        let directions = legs(continuation.toward);
        let follower = Follower::new(wave.clone(), &point, directions[0], settings(continuation))
            .map_err(NoStart::Newton)?;
        Ok(Branch {
            progress: Progress {
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
            },
            model,
            mode,
            method: wave.method,
            continuation: continuation.clone(),
            profiles: problem.output.profiles,
            conditioning: problem.output.conditioning,
            family,
            stability: problem.request(),
            notes: Vec::new(),
            incomplete: false,
            follower,
        })
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
    ) -> Result<Branch, String> {
        let model = saved.model;
        let (signature, point) = progress.first.clone();
        let method = problem.method.unwrap_or(Method::cheapest(model.law));
        let up = progress
            .leg
            .checked_sub(1)
            .and_then(|leg| legs(continuation.toward).get(leg));
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
            return Err("the saved progress does not fit its problem".into());
        };
        let first = Wave::new(
            model,
            continuation.parameter,
            problem.wave.mode,
            signature,
            unpack_scales(progress.scales),
        )
        .with_method(method);
        if point.len() != first.unknowns() {
            return Err("the first wave does not fit its signature".into());
        }
        let follower = match &progress.state {
            Some(state) => Follower::resume(&first, state.clone(), settings(continuation)),
            None => Follower::new(first, &Vector::from_vec(point), *up, settings(continuation)),
        }?;
        Ok(Branch {
            model,
            mode: problem.wave.mode,
            method,
            continuation: continuation.clone(),
            profiles: problem.output.profiles,
            conditioning: problem.output.conditioning,
            // it was handed out before anything was saved
            family: None,
            progress,
            stability: problem.request(),
            notes: Vec::new(),
            incomplete: false,
            follower,
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
        let tolerance = self.continuation.tolerance;
        let mut tracker = self.stability.clone().map(|request| {
            let (last, left) = (self.progress.spectrum.take(), self.progress.allowance);
            Tracker::new(request, last, tolerance, left)
        });
        if self.progress.state.is_none() {
            let mut items = self.family();
            let mut found = self.follower.here();
            if items.is_empty() {
                found.kind = Some(EventType::EP);
                found.what = "start".into();
            }
            // the value of the problem, not the scaled unknown's
            let exact = self.model.value(self.continuation.parameter);
            found.parameter = exact.unwrap_or(found.parameter);
            let mut spectrum = None;
            if let Some(tracker) = &mut tracker {
                spectrum = tracker.start(&found.wave, &found.node);
                self.progress.spectrum = tracker.last().cloned();
                self.spend(tracker.allowance());
            }
            items.push(self.item(found, spectrum.as_ref(), None));
            self.progress.state = Some(self.follower.state());
            self.check_points(&mut items);
            return items;
        }
        let from = tracker.is_some().then(|| {
            (
                self.follower.from().0.clone(),
                self.follower.from().1.clone(),
            )
        });
        let (found, status) = self.follower.step();
        let mut tracked = Tracked::default();
        if let (Some(tracker), Some((wave, node))) = (&mut tracker, &from) {
            tracked = tracker.step(wave, node, &found);
            self.progress.spectrum = tracker.last().cloned();
            self.spend(tracker.allowance());
        }
        let last = found.len().saturating_sub(1);
        let mut items = Vec::with_capacity(found.len() + tracked.crossings.len());
        let mut spectra = tracked.spectra.into_iter();
        let mut crossings = tracked.crossings.into_iter().peekable();
        for (index, mut found) in found.into_iter().enumerate() {
            while let Some(crossing) = crossings.next_if(|crossing| crossing.s < found.s) {
                if let Some((wave, _)) = &from {
                    let item = self.crossing(wave, crossing);
                    if item.is_none() {
                        self.notes.push(format!(
                            "{} = {:.12}: the wave at a crossing of the imaginary axis before this \
                             point could not be examined, and the crossing is left out",
                            self.continuation.parameter.column(),
                            found.parameter
                        ));
                    }
                    let kind = item.as_ref().and_then(|item| item.point.kind);
                    items.extend(item);
                    if self.stop_requested(kind) {
                        self.progress.state = Some(self.follower.state());
                        self.end_leg(None, true);
                        return items;
                    }
                }
            }
            if let Some(remark) = &tracked.remark {
                if found.entered.is_some() {
                    found.what.push_str("; ");
                    found.what.push_str(remark);
                } else if tracked.lost && (found.kind.is_none() || index == last) {
                    self.notes.push(format!(
                        "{} = {:.12}: {remark}",
                        self.continuation.parameter.column(),
                        found.parameter
                    ));
                }
            }
            let kind = found.kind;
            let spectrum = spectra.next().flatten();
            items.push(self.item(found, spectrum.as_ref(), None));
            if self.stop_requested(kind) {
                self.progress.state = Some(self.follower.state());
                self.end_leg(None, true);
                return items;
            }
        }
        self.progress.state = Some(self.follower.state());
        match status {
            Status::Going => self.check_points(&mut items),
            Status::Finished => self.end_leg(None, false),
            Status::Failed(reason) => self.end_leg(Some(reason), false),
        }
        items
    }

    /// Ends a leg that has as many points as it may, with a row that says so.
    fn check_points(&mut self, items: &mut Vec<Item>) {
        let most = self.continuation.most_points(self.model.law);
        if self.progress.points - self.progress.before_leg < most {
            return;
        }
        let what = format!(
            "max_points = {most} points are reached before the end of the range; raise `max_points` \
             to go on, or the steps `ds` and `ds_max` if they are small"
        );
        let found = Found {
            kind: Some(EventType::MX),
            what: what.clone(),
            ..self.follower.here()
        };
        let spectrum = self.progress.spectrum.clone();
        items.push(self.item(found, spectrum.as_ref(), None));
        self.end_leg(Some(what), false);
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
            let (kind, what) = match index {
                0 => (Some(EventType::EP), "the Hopf point of steady sliding"),
                _ if index == last => (Some(EventType::ST), "V̇ reaches 1: a stick zone opens"),
                _ => (None, ""),
            };
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
                kind,
                after: (index == last).then(Signature::slip_stick),
                uncertainty: 8.0 * f64::EPSILON * family.critical,
                what: what.into(),
            };
            let mut item = self.item(found, None, None);
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
        for (met, wanted) in self
            .progress
            .met
            .iter_mut()
            .zip(&self.continuation.stop_after)
        {
            if Some(wanted.event) == kind {
                *met += 1;
                stop |= *met >= wanted.count;
            }
        }
        stop
    }

    /// A crossing of the imaginary axis as a point of the branch.
    fn crossing(&mut self, wave: &Arc<Wave>, crossing: Crossing) -> Option<Item> {
        let real = crossing.omega == 0.0;
        let becomes = if crossing.grows { "unstable" } else { "stable" };
        let what = if real {
            format!(
                "a real eigenvalue of sector {} becomes {becomes}",
                crossing.sector
            )
        } else {
            format!(
                "a complex pair of sector {} becomes {becomes}",
                crossing.sector
            )
        };
        let found = Found {
            wave: wave.clone(),
            s: crossing.s,
            entered: None,
            parameter: wave.parameter_at(&crossing.node.point),
            examination: examine(wave, &crossing.node.point).ok()?,
            node: crossing.node,
            kind: Some(if real { EventType::BP } else { EventType::HB }),
            after: None,
            uncertainty: crossing.uncertainty * wave.scales.parameter,
            what,
        };
        Some(self.item(
            found,
            Some(&crossing.spectrum),
            Some((crossing.sector, (!real).then_some(crossing.omega))),
        ))
    }

    /// Ends a leg; the next one begins unless the whole run is to stop.
    fn end_leg(&mut self, failure: Option<String>, stop: bool) {
        if let Some(reason) = failure {
            self.progress.failure.get_or_insert(reason);
        }
        let directions = legs(self.continuation.toward);
        let another = !stop && self.progress.leg < directions.len();
        if another {
            let up = directions[self.progress.leg];
            let (signature, point) = self.progress.first.clone();
            let first = Wave::new(
                self.model,
                self.continuation.parameter,
                self.mode,
                signature,
                unpack_scales(self.progress.scales),
            )
            .with_method(self.method);
            match Follower::new(
                first,
                &Vector::from_vec(point),
                up,
                settings(&self.continuation),
            ) {
                Ok(follower) => {
                    self.follower = follower;
                    self.progress.leg += 1;
                    self.progress.before_leg = self.progress.points;
                    self.progress.state = None;
                    self.progress.passed = vec![false; self.profiles];
                    return;
                }
                Err(reason) => {
                    self.progress.failure.get_or_insert(reason);
                }
            }
        }
        self.progress.end = Some(match self.progress.failure.clone() {
            Some(reason) => End::Failed(reason),
            None => End::Finished,
        });
    }

    fn item(
        &mut self,
        found: Found,
        spectrum: Option<&Spectrum>,
        crossing: Option<(usize, Option<f64>)>,
    ) -> Item {
        let wave = &found.wave;
        let parameter = wave.parameter;
        let model = self.model.with(parameter, found.parameter);
        let values = model.values();
        let speed = wave.speed_at(&found.node.point);
        self.progress.points += 1;
        // a special point serves as the sample of its part of the range
        let sampled = self.passes_profile_target(found.parameter);
        let labelled = found.kind.is_some() || sampled;
        let label = labelled.then(|| {
            self.progress.labels += 1;
            self.progress.labels
        });
        let regimes = wave.signature.to_string();
        let event = match (found.kind, label) {
            (Some(kind), Some(label)) => {
                self.progress.events += 1;
                Some(Event {
                    label,
                    kind,
                    parameters: values,
                    speed,
                    sector: crossing.map(|(sector, _)| sector),
                    omega: crossing.and_then(|(_, omega)| omega),
                    regimes_before: regimes.clone(),
                    regimes_after: found
                        .after
                        .as_ref()
                        .map_or_else(|| regimes.clone(), Signature::to_string),
                    uncertainty: found.uncertainty,
                    what: found.what.clone(),
                })
            }
            _ => None,
        };
        let examination = &found.examination;
        let (low, high) = examination.tangential;
        let mut point = BranchPoint {
            point: self.progress.points,
            label,
            kind: found.kind,
            regimes,
            parameters: values,
            speed,
            switches: profile::switches(wave, &found.node.point),
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
        if self.stability.is_some() {
            answer(&mut point, spectrum, wave, &found.node.point);
            // on the imaginary axis itself nothing is decided
            if crossing.is_some() && point.stable == Some(Stability::Yes) {
                point.stable = Some(Stability::Undecided);
                point.why.push(Reason::OnAxis);
            }
            if self.progress.allowance == 0 && spectrum.is_none() {
                for reason in point.why.iter_mut().filter(|one| **one == Reason::NoWindow) {
                    *reason = Reason::Spent;
                }
            }
            self.note_incomplete(&point);
        }
        let saved = label.map(|label| SavedWave::new(label, model, wave, &found.node.point));
        let eigenvalues = match (label, spectrum, &self.stability) {
            (Some(_), Some(spectrum), Some(request)) => spectrum
                .sectors
                .iter()
                .flat_map(|sector| {
                    spectrum
                        .listed(sector)
                        .take(request.eigenvalues)
                        .map(|one| (sector.sector, [one.re, one.im, one.error]))
                })
                .collect(),
            _ => Vec::new(),
        };
        self.progress.eigenvalues += eigenvalues.len();
        Item {
            point,
            leg: self.progress.leg,
            eigenvalues,
            event,
            saved,
            unknowns: found.node.point.clone(),
            wave: found.wave,
        }
    }

    /// Takes over what a step has left of the allowance, and notes its end.
    fn spend(&mut self, left: usize) {
        let before = self.progress.allowance;
        self.progress.allowance = if left == 0 {
            0
        } else {
            ALLOWANCE.min(left + PER_POINT)
        };
        if before > 0 && left == 0 {
            self.notes.push(format!(
                "after point {}: {} at {:.0e} a run; take a smaller `max_frequency`, fewer sectors or \
                 fewer points",
                self.progress.points,
                Reason::Spent,
                ALLOWANCE as f64
            ));
        }
    }

    /// Notes the first point whose eigenvalues are not all listed.
    fn note_incomplete(&mut self, point: &BranchPoint) {
        let Some(reason) = point
            .why
            .iter()
            .find(|reason| matches!(reason, Reason::Incomplete { .. }))
        else {
            return;
        };
        if !self.incomplete {
            self.incomplete = true;
            let number = point.point;
            self.notes.push(format!(
                "point {number}: the spectrum is {reason}; see the column `why` for others"
            ));
        }
    }

    /// Conditioning of a point, where asked for; a point known less well than the tolerance asks is
    /// noted as not converged to it.
    fn known_to(&mut self, wave: &Wave, node: &Node) -> Option<(f64, f64)> {
        if !self.conditioning {
            return None;
        }
        let Conditioning {
            condition,
            expected_error,
        } = conditioning(wave, node).ok()?;
        let tolerance = self.continuation.tolerance;
        if expected_error.is_nan() || expected_error > tolerance {
            let known = if expected_error.is_nan() {
                "its equations are singular to rounding".to_owned()
            } else {
                format!(
                    "the expected error is {expected_error:.1e}, the condition number {condition:.1e}"
                )
            };
            self.notes.push(format!(
                "point {}, {} = {:.12}: not converged to the tolerance {tolerance:.0e}; {known}",
                self.progress.points,
                self.continuation.parameter.column(),
                wave.parameter_at(&node.point)
            ));
        }
        Some((condition, expected_error))
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

    /// What could not be settled so far, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
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
