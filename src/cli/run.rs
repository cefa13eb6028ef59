//! `brakewave run`.

use crate::orbit::legs::Run as _;
use clap::Args;

use super::failure::{Exit, Failure};
use super::options::{Task, Threads};
use super::prepare::{early_end, follow, prepare};
use super::{stopped, summary, titled, warn};
use crate::branch::run::Runner;
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::run::{Restart, RunFolder};
use crate::output::store::{Checkpoint, Kind, damaged};

#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    task: Task,
    #[command(flatten)]
    threads: Threads,
}

pub(crate) fn run(arguments: &RunArguments) -> Result<Exit, Failure> {
    let task = &arguments.task;
    let prepared = prepare(&task.problem)?;
    let problem = &prepared.problem;
    let out = task.folder("");
    let store = task.open(&out, Kind::Run, problem)?;
    let saved = RunFolder::interrupted(&store, problem)?;
    let mut branch = if let Some(saved) = &saved {
        let (first, progress) = (saved.wave(&out, 1)?, saved.progress.clone());
        Runner::resume(problem, &prepared.continuation, first, progress)
            .map_err(|reason| damaged(&out.join(Restart::FILE), reason.to_string()))?
    } else {
        let begun = prepared.begin(task.quiet);
        if begun.is_err() && store.holds_results() {
            warn(&format!(
                "nothing was computed; {} keeps the results of the earlier run",
                out.display()
            ));
        }
        begun?
    };
    let mut folder = RunFolder::open(store, problem, &branch, saved)?;
    let finished = branch.progress().end.is_some();
    follow(task.quiet, &mut branch, |items, branch| {
        folder.write(&items, branch)?;
        let here = branch.progress();
        Ok(format!("{} points, {} events", here.points, here.events))
    })?;
    arguments.threads.install(1, usize::MAX, || {
        Ok(pictures::draw(folder.store(), Some(problem), Format::Svg)?)
    })?;
    if !task.quiet {
        let restart = prepared.restart.as_ref();
        let model = restart.map_or(problem.model, |wave| wave.model);
        let mut text = titled(
            problem.title.as_deref(),
            &summary::branch(&out, problem, &model)?,
        );
        if finished {
            text.push_str("the run was finished already: nothing was left to compute\n");
        }
        task.say(&text, "results", &out)?;
    }
    for note in branch.notes() {
        warn(&note.to_string());
    }
    early_end(&branch).map_or(Ok(Exit::Done), |why| stopped(&why))
}
