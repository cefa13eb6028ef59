//! `brakewave run`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::progress::Progress;
use super::report::report;
use super::{Failure, NUMERICAL, default_folder, inputs, print, warn};
use crate::branch::SavedWave;
use crate::branch::run::{End, RunError, Runner};
use crate::output::folder::{self, Folder, Restart};
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::store::{Existing, Kind, Store, damaged};
use crate::problem::{self, Continuation, Problem, Start, Toward};

#[derive(Debug, Args)]
pub struct RunArguments {
    /// Problem file
    problem: PathBuf,
    /// Result folder [default: results/<name of the problem file>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Go on with an interrupted run; its files end as if it had not been interrupted
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace the results of an earlier run
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
    /// Threads that draw the pictures; a branch is followed by one, and the results do not depend on
    /// it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    threads: u16,
}

/// A problem read and ready to run.
pub struct Prepared {
    pub problem: Problem,
    pub continuation: Continuation,
    pub restart: Option<SavedWave>,
    pub source: Source,
}

/// The file of a problem, for messages that point into it.
pub struct Source {
    name: String,
    text: String,
}

impl Source {
    /// A refusal of what stands at a path.
    fn refuse(&self, path: &str, message: String, help: &str) -> Failure {
        problem::refuse_at(&self.text, &self.name, path, message, help).into()
    }

    /// What ends a run before it begins, with the line it is about if there is one.
    pub fn place(&self, error: RunError) -> Failure {
        match error.about() {
            None => error.into(),
            Some((path, help)) => {
                let message = error.to_string();
                let place = problem::refuse_at(&self.text, &self.name, path, message, help);
                Failure::Placed(place, Failure::Run(error).code())
            }
        }
    }
}

/// Reads a problem file, and the wave it restarts from if it does.
pub fn prepare(path: &Path) -> Result<Prepared, Failure> {
    let (problem, text) = problem::read(path)?;
    ready(problem, text, path)
}

/// The branch of a problem that was read, and the wave it restarts from if it does.
pub fn ready(problem: Problem, text: String, path: &Path) -> Result<Prepared, Failure> {
    let name = path.display().to_string();
    let mut continuation = problem.continuation(&text, &name)?.clone();
    let source = Source { name, text };
    let restart = match &problem.wave.start {
        Start::Restart { dir, label } => {
            let earlier = Restart::read(dir)?;
            of_mode(&earlier, dir, problem.wave.mode)
                .map_err(|(message, help)| source.refuse("wave.mode", message, &help))?;
            let wave = earlier.wave(dir, *label)?.clone();
            let law = problem.model.law;
            let other = std::mem::discriminant(&law) != std::mem::discriminant(&wave.model.law);
            if other && problem::says(&source.text, "model.friction_law") {
                let message = format!(
                    "label {label} of {} was computed under another friction law",
                    dir.display()
                );
                let help = "leave out `friction_law`: a restart brings its own";
                return Err(source.refuse("model.friction_law", message, help));
            }
            Some(wave)
        }
        Start::Fast | Start::Slow | Start::Hopf => None,
    };
    if problem.wave.start == Start::Hopf {
        // there are waves on one side of it only
        continuation.toward = Toward::beyond_hopf(continuation.parameter);
        return Ok(Prepared {
            problem,
            continuation,
            restart,
            source,
        });
    }
    let first = match &restart {
        Some(wave) => wave.model.value(continuation.parameter),
        None => problem.model.value(continuation.parameter),
    };
    continuation.toward = ways(&continuation, first.unwrap_or(f64::NAN)).map_err(|message| {
        let help = "go the other way, or widen the range";
        source.refuse("continuation.toward", message, help)
    })?;
    Ok(Prepared {
        problem,
        continuation,
        restart,
        source,
    })
}

/// Refuses an earlier run of another mode: a message, and what would be right.
pub fn of_mode(earlier: &Restart, dir: &Path, mode: u32) -> Result<(), (String, String)> {
    let known = earlier.problem.wave.mode;
    if known == mode {
        return Ok(());
    }
    Err((
        format!(
            "{} holds waves of mode {known}, not of mode {mode}",
            dir.display()
        ),
        format!("write `mode: {known}`, or name another folder"),
    ))
}

/// The ways a branch can go from its first point: at an end of the range there is but one.
fn ways(continuation: &Continuation, first: f64) -> Result<Toward, String> {
    let (low, high) = continuation.range;
    match continuation.toward {
        Toward::Both if first == low => Ok(Toward::Up),
        Toward::Both if first == high => Ok(Toward::Down),
        // a problem with its own start has been checked for this; a restart brings its own value
        toward
            if (toward == Toward::Down && first == low)
                || (toward == Toward::Up && first == high) =>
        {
            Err(format!(
                "the branch starts at {} = {first:?}, an end of the range from {low:?} to \
                 {high:?} with nothing beyond",
                continuation.parameter.column()
            ))
        }
        toward => Ok(toward),
    }
}

pub fn run(arguments: &RunArguments) -> Result<u8, Failure> {
    let Prepared {
        problem,
        continuation,
        restart,
        source,
    } = prepare(&arguments.problem)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| default_folder(&arguments.problem));
    let store = Store::open(
        &out,
        Kind::Run,
        &problem,
        Existing::of(arguments.resume, arguments.force),
        &inputs(&arguments.problem, &problem),
    )?;
    let (mut branch, mut folder) = match folder::interrupted(&store, &problem)? {
        Some(saved) => {
            let first = saved.wave(&out, 1)?;
            let progress = saved.progress.clone();
            let branch = Runner::resume(&problem, &continuation, first, progress)
                .map_err(|reason| damaged(&out.join(folder::RESTART), reason.to_string()))?;
            (branch, Folder::reopen(store, saved)?)
        }
        None => {
            let mut progress = Progress::new(arguments.quiet);
            let begun =
                Runner::begin_watched(&problem, &continuation, restart.as_ref(), &mut |walk| {
                    progress.show(walk.part(), || walk.to_string())
                })
                .map_err(|error| source.place(error));
            drop(progress);
            if begun.is_err() && store.holds_results() {
                warn(&format!(
                    "nothing was computed; {} keeps the results of the earlier run",
                    out.display()
                ));
            }
            let branch = begun?;
            let folder = Folder::create(store, &problem, &branch)?;
            (branch, folder)
        }
    };
    let finished = branch.progress().end.is_some();
    let mut progress = Progress::new(arguments.quiet);
    while branch.progress().end.is_none() {
        let items = branch.step();
        folder.write(&items, &branch)?;
        progress.show(branch.position(), || {
            let here = branch.progress();
            format!("{} points, {} events", here.points, here.events)
        });
    }
    drop(progress);
    if !problem.output.plots.is_empty() {
        let settings = pictures::Settings {
            parameter: continuation.parameter.column().to_string(),
            title: problem.title.clone(),
        };
        let plots = &problem.output.plots;
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(arguments.threads.into())
            .build()
            .map_err(|error| Failure::Usage(format!("cannot start threads: {error}")))?;
        threads.install(|| pictures::draw(folder.store().path(), plots, Format::Svg, &settings))?;
    }
    if !arguments.quiet {
        if let Some(title) = &problem.title {
            print(&format!("{title}\n\n"))?;
        }
        print(&report(&out, continuation.parameter)?)?;
        if finished {
            print("the run was finished already: nothing was left to compute\n")?;
        }
        print(&format!("results in {}\n", out.display()))?;
    }
    for note in branch.notes() {
        warn(&note.to_string());
    }
    match &branch.progress().end {
        Some(End::Failed(reason)) => {
            warn(&format!("the branch ended before its range: {reason}"));
            Ok(NUMERICAL)
        }
        _ => Ok(0),
    }
}
