//! `brakewave simulate`.

use crate::orbit::legs::Run as _;
use std::fmt::Write;
use std::time::{Duration, Instant};

use clap::Args;

use super::failure::{Usage, VerbExit, VerbFailure};
use super::motion;
use super::options::{Task, Threads, cores, read_any};
use super::prepare::ready;
use super::progress::{ProgressLine, drive};
use super::{interrupt, stopped, titled, warn};
use crate::branch::run::RunError;
use crate::output::layout::{END, GROWTH, MEASURES, START, profile_file};
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::run::{PROFILE_RESOLUTION, RESTART};
use crate::output::simulation::{SimulationCheckpoint, SimulationFolder, columns};
use crate::output::store::{Checkpoint, FolderKind, Store, VERSION, damaged};
use crate::output::waves::Waves;
use crate::problem::{self, Any, Continuation, Problem, Start};
use crate::simulation::course::{CoursePiece, NoCourse, SimulationCourse};
use crate::tube::model::{Model, Parameter};

use crate::simulation::growth::GrowthError;
use crate::simulation::measure::{Measure, TimeSample};
use crate::simulation::motion::SimulatedMotion;
use crate::simulation::perturbations::{Grows, GrowthRow};
use crate::simulation::profile::Profile;
use crate::simulation::task::{Simulation, SimulationStart};
use crate::table;

#[derive(Debug, Args)]
pub(crate) struct SimulateArguments {
    /// Its problem file has a section `simulation`
    #[command(flatten)]
    task: Task,
    #[command(flatten)]
    threads: Threads,
}

/// Longest time without a checkpoint, as far as samples allow.
const PATIENCE: Duration = Duration::from_secs(10);

/// Bytes of files that are worth a warning.
const MUCH: f64 = 1e9;

/// Where the motion begins: the model, and the wave if there is one.
fn beginning(
    task: &Task,
    problem: &Problem,
    text: &str,
    section: &Simulation,
) -> Result<(Model, Option<Profile>), VerbFailure> {
    let model = problem.model;
    let (dir, label) = match &section.start {
        SimulationStart::SteadySliding => return Ok((model, None)),
        SimulationStart::OwnWave => {
            let (model, wave) = first_wave(task, problem, text)?;
            return Ok((model, Some(wave)));
        }
        SimulationStart::Profile { file, speed } => {
            if !file.is_file() {
                return Err(Usage::NoProfile(file.clone()).into());
            }
            let wave = Profile::read(file, *speed).map_err(Usage::Profile)?;
            return Ok((model, Some(wave)));
        }
        SimulationStart::Wave { dir, label } => (dir, *label),
    };
    if !dir.join(RESTART).exists() {
        return Err(Usage::NoWaves(dir.clone()).into());
    }
    let restart = Waves::read(dir)?;
    let saved = restart.labelled(dir, label)?;
    remark(&saved.model, &model);
    let path = dir.join(profile_file(label));
    if !path.is_file() {
        let dir = dir.clone();
        return Err(Usage::Unprofiled { dir, label }.into());
    }
    let speed = saved.model.speed(saved.excess);
    let wave = Profile::read(&path, speed).map_err(Usage::Profile)?;
    Ok((saved.model, Some(wave)))
}

/// The wave that the branch of the problem begins with, at the same points as in the table of its profile.
fn first_wave(task: &Task, problem: &Problem, text: &str) -> Result<(Model, Profile), VerbFailure> {
    let mut problem = problem.clone();
    problem.stability = None;
    // a wave in closed form is the beginning of any branch
    if let (Start::Fast | Start::Slow, None) = (&problem.wave.start, &problem.continuation) {
        let range = (0.5 * problem.model.mismatch, problem.model.mismatch);
        problem.continuation = Some(Continuation::new(Parameter::Mismatch, range));
    }
    let prepared = ready(problem, text.to_owned(), &task.problem)?;
    let mut branch = prepared.begin(task.quiet)?;
    // a Hopf point comes with the waves before the first one
    let first = branch.step().pop();
    let first = first.ok_or_else(|| Usage::NoBranch(task.problem.clone()))?;
    remark(&first.point.model, &prepared.problem.model);
    let samples = first.profile(PROFILE_RESOLUTION);
    let samples = samples.map_err(|error| RunError::NoStart(error.into()))?;
    let table = table::table(samples);
    let wave = Profile::of_table(table.as_bytes(), &task.problem, first.point.speed);
    Ok((first.point.model, wave.map_err(Usage::Profile)?))
}

/// Says so where a wave has other parameters than the problem.
fn remark(found: &Model, wanted: &Model) {
    let (found, wanted) = (found.constants(), wanted.constants());
    if found != wanted {
        warn(&format!(
            "the wave brings its own parameters: mismatch {}, friction {}, mass damping {}, \
             stiffness damping {}",
            found.mismatch, found.friction, found.mass_damping, found.stiffness_damping
        ));
    }
}

pub(crate) fn simulate(arguments: &SimulateArguments) -> Result<VerbExit, VerbFailure> {
    let (threads, task) = (&arguments.threads, &arguments.task);
    threads.install(cores(), cores(), || simulate_with(task))
}

fn simulate_with(task: &Task) -> Result<VerbExit, VerbFailure> {
    let (problem, text) = read_any(&task.problem)?;
    match problem {
        Any::Tube(problem) => simulate_tube(task, *problem, text),
        Any::System(problem) => motion::simulate(task, &problem, &text),
    }
}

fn simulate_tube(task: &Task, problem: Problem, text: String) -> Result<VerbExit, VerbFailure> {
    let name = task.name();
    let section = problem.simulation(&text, &name)?;
    let (model, wave) = beginning(task, &problem, &text, section)?;
    let out = task.folder("_simulation");
    let mut course = begun(&problem, section, &model, wave, (&text, &name))?;
    let store = task.open(&out, FolderKind::Simulation, &problem)?;
    let mut folder = open(store, &problem, &mut course)?;
    interrupt::progress_is_kept();
    let bytes = disk_space(course.motion(), course.count(), section.snapshots);
    if bytes > MUCH && !task.quiet {
        warn(&format!("the files will take about {:.0} GB", 1e-9 * bytes));
    }
    let clock = Instant::now();
    let (mut saved, mut refused) = (clock, None);
    drive(task.quiet, || {
        match course.step() {
            Ok(None) => return Ok(None),
            Ok(Some(CoursePiece::Between)) => {}
            Ok(Some(CoursePiece::Sampled { snapshots, part })) => {
                let sample = course.samples().last().copied().unwrap_or_default();
                folder.sample(&sample, &course.motion().line())?;
                while folder.snapshots() < snapshots {
                    folder.snapshot(course.motion())?;
                }
                let late = sample.energy.is_finite() && saved.elapsed() > PATIENCE;
                if part || late {
                    folder.checkpoint(&checkpoint(&problem, &course, folder.snapshots()))?;
                    saved = Instant::now();
                }
            }
            Err(reason) => {
                refused = Some(reason);
                return Ok(None);
            }
        }
        let (motion, steps) = (course.motion(), course.steps());
        let words = format!(
            "step {} of {steps:.0}, t = {:.4}",
            motion.steps(),
            motion.time()
        );
        Ok(Some((course.position(0.0), words)))
    })?;
    if let Some(reason) = refused {
        return stopped(&reason);
    }
    let seconds = clock.elapsed().as_secs_f64();
    folder.line(END, &course.motion().line())?;
    let measures = course.measures();
    folder.table(MEASURES, &measures)?;
    let (eigenvalues, unresolved) = match growth(&course, task.quiet) {
        Ok(found) => found,
        Err(error) => return stopped(&error),
    };
    if section.growth.is_some() && course.has_wave() {
        folder.table(GROWTH, &eigenvalues)?;
    }
    pictures::draw(folder.store(), Some(&problem), Format::Svg)?;
    let mut text = report(&measures, &eigenvalues, course.samples());
    text.push_str(&remarks(&course, section.duration, &unresolved, seconds));
    task.say(&titled(problem.title.as_deref(), &text), "results", &out)?;
    Ok(VerbExit::Done)
}

/// Growth rates of the perturbations that are asked for, and the sectors in which none is resolved.
fn growth(
    course: &SimulationCourse,
    quiet: bool,
) -> Result<(Vec<GrowthRow>, Vec<usize>), GrowthError> {
    let (mut eigenvalues, mut unresolved) = (Vec::new(), Vec::new());
    let progress = ProgressLine::new(quiet);
    let mut done = 0.0;
    for (perturbations, parameters, wave) in course.perturbations() {
        let found = perturbations.growth(parameters, wave, &mut |part| {
            done += part;
            let words = format!("perturbations of sector {}", perturbations.sector());
            progress.show(course.position(done), words);
        })?;
        if found.is_empty() {
            unresolved.push(perturbations.sector());
        }
        eigenvalues.extend(found);
    }
    Ok((eigenvalues, unresolved))
}

/// The simulation that a problem asks for; what its model refuses is shown in the text.
fn begun(
    problem: &Problem,
    section: &Simulation,
    model: &Model,
    wave: Option<Profile>,
    (text, name): (&str, &str),
) -> Result<SimulationCourse, VerbFailure> {
    let begun = SimulationCourse::begin(section, model, problem.wave.mode, wave);
    begun.map_err(|reason| match reason {
        NoCourse::Motion(error) => {
            let (path, help) = error.about();
            problem::refuse_at(text, name, path, error.to_string(), help).into()
        }
        reason => VerbFailure::from(Usage::Simulation {
            file: name.to_owned(),
            reason,
        }),
    })
}

/// What is to be said of the run beside its measures.
fn remarks(course: &SimulationCourse, duration: f64, unresolved: &[usize], seconds: f64) -> String {
    let (motion, taken) = (course.motion(), course.taken());
    let mut text = String::new();
    // writing to a string does not fail
    for sector in unresolved {
        let _ = writeln!(
            text,
            "sector {sector}: no growth rate is resolved; take more `pairs`, or another `amplitude`"
        );
    }
    if course.rest() > 0.0 {
        let _ = writeln!(
            text,
            "the last sample is at the end, t = {}, {:.3e} after the one before; measures leave it out",
            duration,
            course.rest()
        );
    }
    if taken > 0 {
        let rate = motion.size() as f64 * taken as f64 / seconds.max(f64::MIN_POSITIVE);
        let _ = writeln!(
            text,
            "\n{} nodes, {taken} steps of {:.3e}, {rate:.2e} node-steps per second",
            motion.size(),
            motion.time_step()
        );
    }
    text
}

/// The folder of a simulation that begins, or of one that goes on.
fn open(
    store: Store,
    problem: &Problem,
    course: &mut SimulationCourse,
) -> Result<SimulationFolder, VerbFailure> {
    let points = course.motion().line().radial.len();
    let Some(saved) = SimulationFolder::interrupted(&store, problem)? else {
        let mut folder = SimulationFolder::create(store, problem, points)?;
        let line = course.motion().line();
        for sample in course.samples() {
            folder.sample(sample, &line)?;
        }
        folder.line(START, &line)?;
        folder.checkpoint(&checkpoint(problem, course, 0))?;
        return Ok(folder);
    };
    let path = store.path().join(SimulationCheckpoint::FILE);
    if course.at_sample(saved.samples) != Some((saved.steps, saved.snapshots)) {
        let reason = "its numbers of samples, steps and snapshots do not belong together";
        return Err(damaged(&path, reason).into());
    }
    let (folder, samples) = SimulationFolder::reopen(store, points, &saved)?;
    course
        .resume(samples, saved.energy, saved.state, saved.steps)
        .map_err(|error| damaged(&path, error.to_string()))?;
    Ok(folder)
}

fn checkpoint(
    problem: &Problem,
    course: &SimulationCourse,
    snapshots: usize,
) -> SimulationCheckpoint {
    SimulationCheckpoint {
        version: VERSION.to_string(),
        problem: problem.clone(),
        samples: course.samples().len(),
        snapshots,
        steps: course.motion().steps(),
        energy: course.start(),
        state: course.motion().saved(),
    }
}

/// Bytes of the files, roughly: 25 for a number in words, 8 for one in an array.
fn disk_space(motion: &SimulatedMotion, count: usize, snapshots: usize) -> f64 {
    let snapshot = match motion {
        SimulatedMotion::Ring(_) => 7 * 8,
        SimulatedMotion::Annulus(_) => 9 * 25,
    };
    let row = 14 * 25 + columns(motion.line().radial.len());
    count as f64 * row as f64 + snapshots as f64 * (snapshot * motion.size()) as f64
}

/// Whether a perturbation grows, in a word.
fn grows(grows: Grows) -> &'static str {
    match grows {
        Grows::Yes => "yes",
        Grows::No => "no",
        Grows::Undecided => "undecided",
    }
}

fn report(measures: &[Measure], eigenvalues: &[GrowthRow], samples: &[TimeSample]) -> String {
    let mut text = String::new();
    // writing to a string does not fail
    let _ = writeln!(
        text,
        "{:<12} {:>18} {:>9}  window",
        "measure", "value", "error"
    );
    for measure in measures {
        let _ = writeln!(
            text,
            "{:<12} {:>18.9} {:>9.1e}  {:.1} to {:.1}",
            measure.name, measure.value, measure.error, measure.from, measure.to
        );
    }
    if !eigenvalues.is_empty() {
        let _ = writeln!(
            text,
            "\n{:>6} {:>12} {:>12} {:>9} {:>9} {:>9} {:>9}  grows",
            "sector", "growth", "frequency", "error", "residual", "scatter", "grid"
        );
        for row in eigenvalues {
            let value = row.eigenvalue;
            let _ = writeln!(
                text,
                "{:>6} {:>12.6} {:>12.6} {:>9.1e} {:>9.1e} {:>9.1e} {:>9.1e}  {}",
                row.sector,
                value.re,
                value.im,
                row.error,
                value.residual,
                value.scatter,
                row.grid,
                grows(row.grows)
            );
        }
    }
    let (mut largest, mut scale) = (0.0_f64, 0.0_f64);
    for sample in samples {
        largest = largest.max(sample.imbalance.abs());
        scale = scale.max(sample.energy.abs());
    }
    let _ = writeln!(
        text,
        "\nenergy balance closes to {:.1e} of the energy",
        largest / scale.max(f64::MIN_POSITIVE)
    );
    text
}
