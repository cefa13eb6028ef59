//! `brakewave run`.

use std::path::Path;

use clap::Args;

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{Task, Threads, read_any};
use super::prepare::{PreparedSystem, early_end, follow, ready, ready_equilibrium, ready_system};
use super::{interrupt, stopped, summary, titled, warn};
use crate::branch::run::WaveRunner;
use crate::hybrid::runner::{SystemOrbit, SystemRunner};
use crate::orbit::legs::Run;
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::run::{RESTART, Recorded, Restart, RunFolder};
use crate::output::store::{FolderKind, Store, damaged};
use crate::problem::{Any, Problem, SystemProblem};

#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    task: Task,
    #[command(flatten)]
    threads: Threads,
}

pub(crate) fn run(arguments: &RunArguments) -> Result<VerbExit, VerbFailure> {
    let (problem, text) = read_any(&arguments.task.problem)?;
    match problem {
        Any::Tube(problem) => waves(arguments, *problem, text),
        Any::System(problem) if problem.equilibrium.is_some() => {
            equilibria(arguments, *problem, text)
        }
        Any::System(problem) => orbits(arguments, *problem, text),
    }
}

fn waves(
    arguments: &RunArguments,
    problem: Problem,
    text: String,
) -> Result<VerbExit, VerbFailure> {
    let task = &arguments.task;
    let prepared = ready(problem, text, &task.problem)?;
    let problem = &prepared.problem;
    let out = task.folder("");
    let store = task.open(&out, FolderKind::Run, problem)?;
    let followed: Followed<WaveRunner> = Followed::new(
        task,
        &out,
        store,
        problem,
        |saved: &Restart<WaveRunner>| {
            let (first, progress) = (saved.labelled(&out, 1)?, saved.progress.clone());
            WaveRunner::resume(problem, &prepared.continuation, first, progress)
                .map_err(|reason| spoiled(&out, &reason))
        },
        || prepared.begin(task.quiet),
    )?;
    arguments.threads.install(1, usize::MAX, || {
        Ok(pictures::draw(
            followed.folder.store(),
            Some(problem),
            Format::Svg,
        )?)
    })?;
    if !task.quiet {
        let restart = prepared.restart.as_ref();
        let model = restart.map_or(problem.model, |wave| wave.model);
        let text = summary::branch(&out, problem, &model)?;
        followed.say(task, &out, titled(problem.title.as_deref(), &text))?;
    }
    branch_end(&followed.branch, followed.branch.notes())
}

fn orbits(
    arguments: &RunArguments,
    problem: SystemProblem,
    text: String,
) -> Result<VerbExit, VerbFailure> {
    let prepared = ready_system(problem, text, &arguments.task.problem)?;
    // with a prescribed period the parameter that is free tells more
    let free = prepared.problem.orbit.free.as_deref();
    let shown = free.map_or(("period", "T"), |free| (free, free));
    of_system(arguments, &prepared, shown, || prepared.begin())
}

fn equilibria(
    arguments: &RunArguments,
    problem: SystemProblem,
    text: String,
) -> Result<VerbExit, VerbFailure> {
    let prepared = ready_equilibrium(problem, text, &arguments.task.problem)?;
    let state = prepared.problem.system.source.states.first();
    let state = state.map_or("re", String::as_str);
    of_system(arguments, &prepared, (state, state), || prepared.begin())
}

/// Follows a branch of a system into its folder, draws it, and prints what was found with a column of the branch.
fn of_system<O: SystemOrbit, N>(
    arguments: &RunArguments,
    prepared: &PreparedSystem<N>,
    shown: (&str, &str),
    begin: impl FnOnce() -> Result<SystemRunner<O>, VerbFailure>,
) -> Result<VerbExit, VerbFailure>
where
    SystemRunner<O>:
        Recorded<Problem = SystemProblem, Saved = O::Saved, Orbit = O, Beside = O::Scales>,
{
    let task = &arguments.task;
    let (problem, continuation) = (&prepared.problem, &prepared.continuation);
    let out = task.folder("");
    let store = task.open_system(&out, FolderKind::Run, problem)?;
    let resume = |saved: &Restart<SystemRunner<O>>| {
        let (first, progress) = (saved.labelled(&out, 1)?, saved.progress.clone());
        SystemRunner::resume(problem, continuation, first, progress)
            .map_err(|reason| spoiled(&out, &reason))
    };
    let followed = Followed::new(task, &out, store, problem, resume, begin)?;
    let store = followed.folder.store();
    arguments.threads.install(1, usize::MAX, || {
        Ok(pictures::orbits::draw(store, problem, Format::Svg)?)
    })?;
    if !task.quiet {
        let mut text = summary::of_system(&out, &continuation.parameter, shown)?;
        let system = &problem.system;
        let at = system.at(&problem.values(), &[]).map_err(Usage::NoSystem)?;
        text.push_str(&summary::flows(system, &at));
        followed.say(task, &out, titled(problem.title.as_deref(), &text))?;
    }
    branch_end(&followed.branch, followed.branch.notes())
}

/// What was saved does not go on.
fn spoiled(folder: &Path, reason: &impl ToString) -> VerbFailure {
    damaged(&folder.join(RESTART), reason.to_string()).into()
}

/// A branch followed to its end into a folder.
struct Followed<R: Recorded> {
    folder: RunFolder<R>,
    branch: R,
    /// Whether it was at its end before.
    finished: bool,
}

impl<R: Recorded> Followed<R> {
    fn new(
        task: &Task,
        out: &Path,
        store: Store,
        problem: &R::Problem,
        resume: impl FnOnce(&Restart<R>) -> Result<R, VerbFailure>,
        begin: impl FnOnce() -> Result<R, VerbFailure>,
    ) -> Result<Followed<R>, VerbFailure> {
        let saved = RunFolder::<R>::interrupted(&store, problem)?;
        let mut branch = if let Some(saved) = &saved {
            interrupt::progress_is_kept();
            resume(saved)?
        } else {
            let begun = begin();
            if begun.is_err() && store.holds_results() {
                warn(&format!(
                    "nothing was computed; {} keeps the results of the earlier run",
                    out.display()
                ));
            }
            begun?
        };
        let mut folder = RunFolder::open(store, problem, &branch, saved)?;
        interrupt::progress_is_kept();
        let finished = branch.progress().end.is_some();
        follow(task.quiet, &mut branch, |items, branch| {
            folder.write(&items, branch)?;
            let here = branch.progress();
            Ok(format!("{} points, {} events", here.points, here.events))
        })?;
        Ok(Followed {
            folder,
            branch,
            finished,
        })
    }

    /// Prints what was found.
    fn say(&self, task: &Task, out: &Path, mut text: String) -> Result<(), VerbFailure> {
        if self.finished {
            text.push_str("the run was finished already: nothing was left to compute\n");
        }
        task.say(&text, "results", out)
    }
}

/// Warns of what could not be settled, and says how a branch ended.
fn branch_end(branch: &impl Run, notes: &[impl ToString]) -> Result<VerbExit, VerbFailure> {
    for note in notes {
        warn(&note.to_string());
    }
    early_end(branch).map_or(Ok(VerbExit::Done), |why| stopped(&why))
}
