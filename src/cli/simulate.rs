//! `brakewave simulate`.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use super::progress::{self, Progress};
use super::{Failure, default_folder, inputs, print, warn};
use crate::model::{Constants, Model};
use crate::output::folder::{RESTART, Restart};
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::simulation::{
    CHECKPOINT, Checkpoint, END, SERIES, START, SimulationFolder, columns,
};
use crate::output::store::{Existing, Kind, Store, StoreError, damaged};
use crate::problem::{self, Problem};
use crate::simulation::growth::{self, GrowthRow};
use crate::simulation::measure::{self, Measure, Sample};
use crate::simulation::motion::{Motion, angle};
use crate::simulation::profile::Profile;
use crate::simulation::ring;
use crate::simulation::task::{Body, Circle, Simulation, SimulationStart};
use crate::stability::Sectors;

#[derive(Debug, Args)]
pub struct SimulateArguments {
    /// Problem file with a section `simulation`
    problem: PathBuf,
    /// Result folder [default: results/<name of the problem file>_simulation]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Go on from the last checkpoint; the files end as if it had not been interrupted
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace the results of an earlier simulation
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
    /// Threads, at most one for every core [default: all cores]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

/// A part of a simulation that ends with a checkpoint.
const PARTS: usize = 50;

/// Longest time without a checkpoint, as far as samples allow.
const PATIENCE: Duration = Duration::from_secs(10);

/// Most steps of nodes: four months at 1e8 a second, which one core takes.
const MOST_WORK: f64 = 1e15;

/// Steps of nodes in a second, for a first guess.
const USUAL_PACE: f64 = 1e8;

/// Steps of nodes between two looks at the clock.
const STRIDE: u64 = 10_000_000;

/// Bytes of files that are worth a warning.
const MUCH: f64 = 1e9;

/// Where the motion begins: the model, and the wave if there is one.
struct Beginning {
    model: Model,
    wave: Option<Profile>,
}

fn beginning(problem: &Problem, section: &Simulation) -> Result<Beginning, Failure> {
    let model = problem.model;
    let (dir, label) = match &section.start {
        SimulationStart::SteadySliding => return Ok(Beginning { model, wave: None }),
        SimulationStart::Profile { file, speed } => {
            if !file.is_file() {
                return Err(Failure::Usage(format!(
                    "{} is no file: name a table of a run, like results/x/profiles/3.csv, in \
                     `simulation: (start: Profile(file: .., speed: ..))`",
                    file.display()
                )));
            }
            let wave =
                Profile::read(file, *speed).map_err(|error| Failure::Usage(error.to_string()))?;
            return Ok(Beginning {
                model,
                wave: Some(wave),
            });
        }
        SimulationStart::Wave { dir, label } => (dir, label),
    };
    if !dir.join(RESTART).exists() {
        return Err(Failure::Usage(format!(
            "{} holds no waves to begin with: follow them first with `brakewave run` and `output: \
             (profiles: 9)`, or name the folder of such a run in `simulation: (start: Wave(dir: ..))`",
            dir.display()
        )));
    }
    let restart = Restart::read(dir)?;
    let saved = restart.wave(dir, *label)?;
    let (found, wanted) = (saved.model.constants(), model.constants());
    if found != wanted {
        warn(&format!(
            "the wave brings its own parameters: mismatch {}, friction {}, mass damping {}, \
             stiffness damping {}",
            found.mismatch, found.friction, found.mass_damping, found.stiffness_damping
        ));
    }
    let path = dir.join("profiles").join(format!("{label}.csv"));
    if !path.is_file() {
        return Err(Failure::Usage(format!(
            "label {label} of {} has no profile; `output: (profiles: 9)` in the problem of the run \
             has profiles written",
            dir.display()
        )));
    }
    let wave = Profile::read(&path, saved.model.speed(saved.excess))
        .map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(Beginning {
        model: saved.model,
        wave: Some(wave),
    })
}

pub fn simulate(arguments: &SimulateArguments) -> Result<u8, Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let asked = arguments.threads.map_or(cores, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(asked.min(cores))
        .build()
        .map_err(|error| Failure::Usage(format!("no threads: {error}")))?;
    pool.install(|| simulate_with(arguments))
}

fn simulate_with(arguments: &SimulateArguments) -> Result<u8, Failure> {
    let (problem, text) = problem::read(&arguments.problem)?;
    let name = arguments.problem.display().to_string();
    let section = problem.simulation(&text, &name)?;
    let Beginning { model, wave } = beginning(&problem, section)?;
    let parameters = model.constants();
    let geometry = model.source.geometry();
    let mode = problem.wave.mode;
    let watched = match (&section.start, section.perturbation) {
        (SimulationStart::SteadySliding, Some(perturbation)) => perturbation.mode,
        _ => mode,
    };
    let waves = match section.circle {
        Circle::Whole => mode as usize,
        Circle::Wavelength => 1,
    };
    let out = arguments.out.clone().unwrap_or_else(|| {
        let mut folder = default_folder(&arguments.problem).into_os_string();
        folder.push("_simulation");
        PathBuf::from(folder)
    });
    let mut motion =
        Motion::begin(section, &parameters, geometry, mode, wave.as_ref()).map_err(|error| {
            let (path, help) = error.about();
            problem::refuse_at(&text, &name, path, error.to_string(), help)
        })?;
    let points = motion.line().radial.len();
    let (whole, rest) = section.intervals();
    let count = whole + usize::from(rest > 0.0);
    let growth = growth_requests(&problem, section, &parameters, wave.as_ref())?;
    let steps = section.duration / motion.time_step();
    let work = steps * motion.size() as f64 + growth.iter().map(|one| one.work).sum::<f64>();
    admit_work(&name, &motion, steps, work)?;
    let per_sample = (section.every / motion.time_step()).round() as u64;

    let existing = Existing::of(arguments.resume, arguments.force);
    let inputs = inputs(&arguments.problem, &problem);
    let store = Store::open(&out, Kind::Simulation, &problem, existing, &inputs)?;
    let (mut folder, mut samples, start) = if let Some(checkpoint) = interrupted(&store)? {
        let taken = checkpoint.samples.wrapping_sub(1);
        let steps = taken.min(whole) as u64 * per_sample
            + if taken > whole {
                motion.steps_within(rest)
            } else {
                0
            };
        let snapshots = taken.min(count) * section.snapshots / count;
        let fits = taken <= count && checkpoint.problem == problem;
        if !fits || (checkpoint.steps, checkpoint.snapshots) != (steps, snapshots) {
            let reason = "its problem and its numbers of samples, steps and snapshots do not belong together";
            return Err(damaged(&out.join(CHECKPOINT), reason).into());
        }
        let (folder, samples) = SimulationFolder::reopen(store, points, &checkpoint)?;
        motion
            .resume(checkpoint.state, checkpoint.steps)
            .map_err(|error| damaged(&out.join(CHECKPOINT), error.to_string()))?;
        (folder, samples, checkpoint.energy)
    } else {
        let mut folder = SimulationFolder::create(store, points)?;
        let start = motion.energy().0;
        let sample = Sample::of(&motion, watched, waves, parameters.mismatch, start);
        folder.sample(&sample, &motion.line())?;
        folder.line(START, &motion.line())?;
        folder.checkpoint(&problem, start, &motion)?;
        (folder, vec![sample], start)
    };

    let bytes = disk_space(&motion, count, section.snapshots);
    if bytes > MUCH && !arguments.quiet {
        warn(&format!("the files will take about {:.0} GB", 1e-9 * bytes));
    }
    let mut progress = Progress::new(arguments.quiet);
    let size = motion.size() as u64;
    let clock = Instant::now();
    let mut saved = clock;
    let before = motion.steps();
    while folder.samples() <= count {
        let last = folder.samples() == count;
        let mut left = match last && rest > 0.0 {
            true => motion.shorten(rest),
            false => per_sample,
        };
        while left > 0 {
            let some = left.min(STRIDE.div_ceil(size));
            motion.advance(some);
            left -= some;
            let done = motion.steps();
            progress.show((done * size) as f64 / work, || {
                format!("step {done} of {steps:.0}, t = {:.4}", motion.time())
            });
        }
        if !motion.holds() {
            warn(&format!(
                "a point left the shaft before t = {}: with stiffness damping only contact is \
                 simulated; take a larger mismatch",
                motion.time()
            ));
            return Ok(super::NUMERICAL);
        }
        let mut sample = Sample::of(&motion, watched, waves, parameters.mismatch, start);
        if last && rest > 0.0 {
            sample.time = section.duration;
        }
        folder.sample(&sample, &motion.line())?;
        samples.push(sample);
        let done = folder.samples() - 1;
        while folder.snapshots() < done * section.snapshots / count {
            folder.snapshot(&motion)?;
        }
        if !sample.energy.is_finite() {
            warn(&format!(
                "the motion is no longer finite at t = {}",
                sample.time
            ));
            return Ok(super::NUMERICAL);
        }
        let part = done * PARTS / count > (done - 1) * PARTS / count;
        if part || done == count || saved.elapsed() > PATIENCE {
            folder.checkpoint(&problem, start, &motion)?;
            saved = Instant::now();
        }
    }
    let seconds = clock.elapsed().as_secs_f64();
    let taken = motion.steps() - before;
    folder.line(END, &motion.line())?;
    // samples at equal intervals: a last one that is shorter is left out
    let even = &samples[..=whole];
    let mut measures = measure::linear_growth(even);
    measures.extend(measure::steady_state(even, watched));
    folder.measures(&measures)?;
    let mut eigenvalues = Vec::new();
    if let Some(wave) = &wave {
        let mut done = steps * size as f64;
        for one in &growth {
            match one.eigenvalues(&parameters, wave, &mut |part| {
                done += part;
                progress.show(done / work, || {
                    format!("perturbations of sector {}", one.fine.sector)
                });
            }) {
                Ok(found) => eigenvalues.extend(found),
                Err(error) => {
                    warn(&error.to_string());
                    return Ok(super::NUMERICAL);
                }
            }
        }
        if section.growth.is_some() {
            folder.growth(&eigenvalues)?;
        }
    }
    drop(progress);
    pictures::draw_simulation(&out, problem.title.as_deref(), Format::Svg)?;
    if !arguments.quiet {
        let rate = motion.size() as f64 * taken as f64 / seconds.max(f64::MIN_POSITIVE);
        print(&report(&problem, &measures, &eigenvalues, &samples))?;
        if rest > 0.0 {
            print(&format!(
                "the last sample is at the end, t = {}, {rest:.3e} after the one before; measures \
                 leave it out\n",
                section.duration
            ))?;
        }
        if taken > 0 {
            print(&format!(
                "\n{} nodes, {taken} steps of {:.3e}, {:.2e} node-steps per second\n",
                motion.size(),
                motion.time_step(),
                rate
            ))?;
        }
        print(&format!("results in {}\n", out.display()))?;
    }
    Ok(0)
}

/// Highest |Im λ| listed, in units of Ω.
const HIGHEST: f64 = problem::DEFAULT_MAX_FREQUENCY;

/// |Im λ| below which an eigenvalue counts as real: rounding of a logarithm over the time of a pair.
const REAL: f64 = 1e-6;

/// Eigenvalues listed per sector.
const LISTED: usize = problem::DEFAULT_EIGENVALUES;

/// Largest residual and scatter of an eigenvalue that is listed, in units of Ω.
const RESOLVED: f64 = 1e-2;

/// The checkpoint to go on from; none where the folder has nothing that would be missed.
fn interrupted(store: &Store) -> Result<Option<Checkpoint>, StoreError> {
    let path = store.path().join(CHECKPOINT);
    if !store.resumes() {
        return Ok(None);
    }
    if path.exists() {
        return Checkpoint::read(store.path()).map(Some);
    }
    // a kill before the first checkpoint leaves a header and the sample at the beginning
    let series = std::fs::read(store.path().join(SERIES)).unwrap_or_default();
    if series.iter().filter(|byte| **byte == b'\n').count() > 2 {
        return Err(damaged(&path, "it is no longer there"));
    }
    Ok(None)
}

/// Refuses what no machine ends.
fn admit_work(name: &str, motion: &Motion, steps: f64, work: f64) -> Result<(), Failure> {
    if work <= MOST_WORK {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{name}: {steps:.1e} steps of {:.1e} of {} nodes and what `growth` adds are {work:.1e} steps of a \
         node, {} at {USUAL_PACE:.0e} a second; at most {MOST_WORK:.0e} are admitted: take fewer points, \
         a larger `courant` or a shorter `duration`",
        motion.time_step(),
        motion.size(),
        progress::duration(work / USUAL_PACE)
    )))
}

/// Bytes of the files, roughly: 25 for a number in words, 8 for one in an array.
fn disk_space(motion: &Motion, count: usize, snapshots: usize) -> f64 {
    let snapshot = match motion {
        Motion::Ring(_) => 7 * 8,
        Motion::Annulus(_) => 9 * 25,
    };
    let row = 14 * 25 + columns(motion.line().radial.len());
    count as f64 * row as f64 + snapshots as f64 * (snapshot * motion.size()) as f64
}

/// The perturbations of one sector, on the ring and on one of half as many points.
struct Sector {
    setup: ring::Setup,
    fine: growth::Request,
    coarse: growth::Request,
    real: bool,
    /// Steps of nodes.
    work: f64,
}

/// What `growth` asks for, with every ring known to be one.
fn growth_requests(
    problem: &Problem,
    section: &Simulation,
    parameters: &Constants,
    wave: Option<&Profile>,
) -> Result<Vec<Sector>, Failure> {
    let (Some(growth), Body::Ring { points, .. }, Some(wave)) =
        (&section.growth, section.body, wave)
    else {
        return Ok(Vec::new());
    };
    let mode = problem.wave.mode as usize;
    let points = match section.circle {
        Circle::Whole => points / mode,
        Circle::Wavelength => points,
    };
    let sectors = match &growth.sectors {
        Sectors::All => (0..=mode / 2).collect(),
        Sectors::Only(list) => list.clone(),
    };
    let failed = |error: &dyn std::fmt::Display| Failure::Usage(error.to_string());
    let Motion::Ring(ring) = Motion::begin(section, parameters, None, mode as u32, None)
        .map_err(|error| failed(&error))?
    else {
        return Ok(Vec::new());
    };
    let setup = ring::Setup {
        angle: angle(section, mode as u32),
        ..*ring.setup()
    };
    sectors
        .into_iter()
        .map(|sector| {
            let request = |points: usize| growth::Request {
                points,
                waves: if sector == 0 { 1 } else { mode },
                sector,
                shift: points,
                courant: section.courant,
                amplitude: growth.amplitude,
                pairs: growth.pairs,
                settling: growth::SETTLING,
            };
            let (fine, coarse) = (request(points), request(points / 2));
            let work = |request| growth::work(parameters, &setup, wave, request, growth::INSTANTS);
            let work = work(&fine).and_then(|one| Ok(one + work(&coarse)?));
            Ok(Sector {
                work: work.map_err(|error| failed(&error))?,
                real: sector == 0 || 2 * sector == mode,
                setup,
                fine,
                coarse,
            })
        })
        .collect()
}

impl Sector {
    /// Growth of perturbations of the wave, with the difference from a ring of half as many points.
    /// `tick` is told the work of every pair of runs.
    fn eigenvalues(
        &self,
        parameters: &Constants,
        wave: &Profile,
        tick: &mut dyn FnMut(f64),
    ) -> Result<Vec<GrowthRow>, growth::GrowthError> {
        let count = (self.fine.pairs * growth::INSTANTS) as f64;
        let mut of = |request: &growth::Request| {
            // half the points take a quarter of the steps of nodes
            let share = if request.points == self.fine.points {
                0.8
            } else {
                0.2
            };
            let mut tick = || tick(share * self.work / count);
            let instants = growth::INSTANTS;
            growth::averaged(parameters, &self.setup, wave, request, instants, &mut tick)
        };
        let (fine, coarse) = (of(&self.fine)?, of(&self.coarse)?);
        let listed = fine.into_iter().filter(|value| {
            value.residual.max(value.scatter) <= RESOLVED
                && value.im.abs() <= HIGHEST
                && !(self.real && value.im < -REAL)
        });
        let mut rows = Vec::new();
        for value in listed.take(LISTED) {
            let nearest = coarse
                .iter()
                .map(|other| (other.re - value.re).hypot(other.im - value.im))
                .fold(f64::INFINITY, f64::min);
            rows.push(GrowthRow {
                sector: self.fine.sector,
                eigenvalue: value,
                grid: nearest,
            });
        }
        Ok(rows)
    }
}

fn report(
    problem: &Problem,
    measures: &[Measure],
    eigenvalues: &[GrowthRow],
    samples: &[Sample],
) -> String {
    let mut text = String::new();
    // writing to a string does not fail
    if let Some(title) = &problem.title {
        let _ = writeln!(text, "{title}\n");
    }
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
            "\n{:>6} {:>12} {:>12} {:>9} {:>9} {:>9}",
            "sector", "growth", "frequency", "residual", "scatter", "grid"
        );
        for row in eigenvalues {
            let value = row.eigenvalue;
            let _ = writeln!(
                text,
                "{:>6} {:>12.6} {:>12.6} {:>9.1e} {:>9.1e} {:>9.1e}",
                row.sector, value.re, value.im, value.residual, value.scatter, row.grid
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
