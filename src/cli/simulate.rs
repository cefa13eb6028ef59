//! `brakewave simulate`.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, default_folder, print, warn};
use crate::model::{Model, Source};
use crate::output::folder::Restart;
use crate::output::plots::{self, Format};
use crate::output::simulation::{CHECKPOINT, Checkpoint, END, START, SimulationFolder};
use crate::problem::{self, Body, Circle, Problem, Sectors, Simulation, SimulationStart};
use crate::simulation::growth::{self, Eigenvalue};
use crate::simulation::measure::{self, Measure, Sample};
use crate::simulation::motion::{Motion, angle};
use crate::simulation::profile::Profile;
use crate::simulation::ring;

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
    /// Threads [default: all cores]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

/// A part of a simulation that ends with a checkpoint.
const PARTS: usize = 50;

/// Where the motion begins: the model, and the wave if there is one.
struct Beginning {
    model: Model,
    wave: Option<Profile>,
}

fn beginning(problem: &Problem, section: &Simulation) -> Result<Beginning, Failure> {
    let model = crate::run::model(&problem.model);
    let (dir, label) = match &section.start {
        SimulationStart::SteadySliding => return Ok(Beginning { model, wave: None }),
        SimulationStart::Profile { file, speed } => {
            let wave =
                Profile::read(file, *speed).map_err(|error| Failure::Usage(error.to_string()))?;
            return Ok(Beginning {
                model,
                wave: Some(wave),
            });
        }
        SimulationStart::Wave { dir, label } => (dir, label),
    };
    let restart = Restart::read(dir)?;
    let saved = restart.wave(dir, *label)?;
    let (found, wanted) = (saved.model.parameters(), model.parameters());
    if found != wanted {
        warn(&format!(
            "the wave brings its own parameters: mismatch {}, friction {}, mass damping {}, \
             stiffness damping {}",
            found.mismatch, found.friction, found.mass_damping, found.stiffness_damping
        ));
    }
    let path = dir.join("profiles").join(format!("{label}.csv"));
    let wave = Profile::read(&path, saved.model.speed(saved.excess)).map_err(|error| {
        Failure::Usage(format!(
            "{error}; `output: (profiles: 9)` in the problem of the run has profiles written"
        ))
    })?;
    Ok(Beginning {
        model: saved.model,
        wave: Some(wave),
    })
}

pub fn simulate(arguments: &SimulateArguments) -> Result<u8, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| Failure::Usage(format!("no threads: {error}")))?;
    pool.install(|| simulate_with(arguments))
}

fn simulate_with(arguments: &SimulateArguments) -> Result<u8, Failure> {
    let (problem, text) = problem::read(&arguments.problem)?;
    let name = arguments.problem.display().to_string();
    let section = problem.simulation(&text, &name)?;
    let Beginning { model, wave } = beginning(&problem, section)?;
    let parameters = model.parameters();
    let geometry = match model.source {
        Source::Geometry(geometry) => Some(geometry),
        Source::Given(_) => None,
    };
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
    let usage = |error: &dyn std::fmt::Display| Failure::Usage(error.to_string());
    let mut motion = Motion::begin(section, &parameters, geometry, mode, wave.as_ref())
        .map_err(|error| usage(&error))?;
    let points = motion.line().radial.len();
    let per_sample = (section.every / motion.time_step()).round() as u64;
    let count = (section.duration / section.every).round() as usize;

    let resumes = arguments.resume && out.join(CHECKPOINT).exists();
    let (mut folder, mut samples, start) = if resumes {
        let checkpoint = Checkpoint::read(&out)?;
        if checkpoint.problem != problem {
            return Err(Failure::Usage(format!(
                "{} was written for another problem than {name}; --force starts it anew",
                out.display()
            )));
        }
        let (folder, samples) = SimulationFolder::reopen(&out, points, &checkpoint)?;
        motion
            .resume(checkpoint.state, checkpoint.steps)
            .map_err(|error| usage(&error))?;
        (folder, samples, checkpoint.energy)
    } else {
        // a folder without a checkpoint holds nothing that would be missed
        let force = arguments.force || arguments.resume;
        let mut folder = SimulationFolder::create(&out, points, force)?;
        let start = motion.energy().0;
        let sample = Sample::of(&motion, watched, waves, parameters.mismatch, start);
        folder.sample(&sample, &motion.line())?;
        folder.line(START, &motion.line())?;
        folder.checkpoint(&problem, start, &motion)?;
        (folder, vec![sample], start)
    };

    let bar = (!arguments.quiet && stderr().is_terminal()).then(|| progress_bar(count));
    let clock = Instant::now();
    let before = motion.steps();
    while folder.samples() <= count {
        motion.advance(per_sample);
        if !motion.holds() {
            warn(&format!(
                "a point left the shaft before t = {}: with stiffness damping only contact is \
                 simulated; take a larger mismatch",
                motion.time()
            ));
            return Ok(super::NUMERICAL);
        }
        let sample = Sample::of(&motion, watched, waves, parameters.mismatch, start);
        folder.sample(&sample, &motion.line())?;
        samples.push(sample);
        let done = folder.samples() - 1;
        while folder.snapshots() < done * section.snapshots / count {
            folder.snapshot(&motion)?;
        }
        if done * PARTS / count > (done - 1) * PARTS / count || done == count {
            folder.checkpoint(&problem, start, &motion)?;
        }
        if let Some(bar) = &bar {
            bar.set_position(done as u64);
        }
        if !sample.energy.is_finite() {
            warn(&format!(
                "the motion is no longer finite at t = {}",
                sample.time
            ));
            return Ok(super::NUMERICAL);
        }
    }
    let seconds = clock.elapsed().as_secs_f64();
    let steps = motion.steps() - before;
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    folder.line(END, &motion.line())?;
    let mut measures = measure::linear_growth(&samples);
    measures.extend(measure::steady_state(&samples, watched));
    folder.measures(&measures)?;
    let mut eigenvalues = Vec::new();
    if let Some(wave) = &wave {
        eigenvalues = wave_growth(&problem, section, &model, wave)?;
        if section.growth.is_some() {
            folder.growth(&eigenvalues)?;
        }
    }
    plots::draw_simulation(&out, problem.title.as_deref(), Format::Svg)?;
    if !arguments.quiet {
        let rate = motion.size() as f64 * steps as f64 / seconds.max(f64::MIN_POSITIVE);
        print(&report(&problem, &measures, &eigenvalues, &samples))?;
        if steps > 0 {
            print(&format!(
                "\n{} nodes, {steps} steps of {:.3e}, {:.2e} node-steps per second\n",
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

/// Growth of perturbations of the wave, with the difference from a ring of half as many points.
fn wave_growth(
    problem: &Problem,
    section: &Simulation,
    model: &Model,
    wave: &Profile,
) -> Result<Vec<(usize, Eigenvalue, f64)>, Failure> {
    let (Some(growth), Body::Ring { points, .. }) = (&section.growth, section.body) else {
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
    let parameters = model.parameters();
    let failed = |error: growth::GrowthError| Failure::Usage(error.to_string());
    let Motion::Ring(ring) = Motion::begin(section, &parameters, None, mode as u32, None)
        .map_err(|error| Failure::Usage(error.to_string()))?
    else {
        return Ok(Vec::new());
    };
    let setup = ring::Setup {
        angle: angle(section, mode as u32),
        ..*ring.setup()
    };
    let mut rows = Vec::new();
    for sector in sectors {
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
        let of = |points: usize| {
            growth::averaged(
                &parameters,
                &setup,
                wave,
                &request(points),
                growth::INSTANTS,
            )
            .map_err(failed)
        };
        let (fine, coarse) = (of(points)?, of(points / 2)?);
        let real = sector == 0 || 2 * sector == mode;
        let listed = fine.into_iter().filter(|value| {
            value.residual.max(value.scatter) <= RESOLVED
                && value.im.abs() <= HIGHEST
                && !(real && value.im < -REAL)
        });
        for value in listed.take(LISTED) {
            let nearest = coarse
                .iter()
                .map(|other| (other.re - value.re).hypot(other.im - value.im))
                .fold(f64::INFINITY, f64::min);
            rows.push((sector, value, nearest));
        }
    }
    Ok(rows)
}

fn report(
    problem: &Problem,
    measures: &[Measure],
    eigenvalues: &[(usize, Eigenvalue, f64)],
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
            measure.name, measure.value, measure.error, measure.window[0], measure.window[1]
        );
    }
    if !eigenvalues.is_empty() {
        let _ = writeln!(
            text,
            "\n{:>6} {:>12} {:>12} {:>9} {:>9} {:>9}",
            "sector", "growth", "frequency", "residual", "scatter", "grid"
        );
        for (sector, value, grid) in eigenvalues {
            let _ = writeln!(
                text,
                "{sector:>6} {:>12.6} {:>12.6} {:>9.1e} {:>9.1e} {:>9.1e}",
                value.re, value.im, value.residual, value.scatter, grid
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

fn progress_bar(samples: usize) -> ProgressBar {
    let bar = ProgressBar::new(samples as u64);
    // the template is constant and valid
    if let Ok(style) =
        ProgressStyle::with_template("{spinner} [{bar:40}] {percent}% ({elapsed}, {eta} left)")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}
