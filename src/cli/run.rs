//! `brakewave run`.

use clap::Args;

use super::failure::{Exit, Failure};
use super::options::{Task, Threads};
use super::prepare::{Prepared, begin, prepare};
use super::progress::drive;
use super::summary;
use super::{print, warn};
use crate::branch::run::{End, Runner};
use crate::model::Sectors;
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
    let Prepared {
        problem,
        continuation,
        restart,
        source,
    } = prepare(&task.problem)?;
    let out = task.folder("");
    let store = task.open(&out, Kind::Run, &problem)?;
    let saved = RunFolder::interrupted(&store, &problem)?;
    let mut branch = if let Some(saved) = &saved {
        let (first, progress) = (saved.wave(&out, 1)?, saved.progress.clone());
        Runner::resume(&problem, &continuation, first, progress)
            .map_err(|reason| damaged(&out.join(Restart::FILE), reason.to_string()))?
    } else {
        let begun = begin(task.quiet, &problem, &continuation, restart.as_ref());
        if begun.is_err() && store.holds_results() {
            warn(&format!(
                "nothing was computed; {} keeps the results of the earlier run",
                out.display()
            ));
        }
        begun.map_err(|error| source.place(error))?
    };
    let mut folder = RunFolder::open(store, &problem, &branch, saved)?;
    let finished = branch.progress().end.is_some();
    drive(task.quiet, || {
        if branch.progress().end.is_some() {
            return Ok(None);
        }
        let items = branch.step();
        folder.write(&items, &branch)?;
        let here = branch.progress();
        let words = format!("{} points, {} events", here.points, here.events);
        Ok(Some((branch.position(), words)))
    })?;
    if !problem.output.plots.is_empty() {
        let settings = pictures::Settings::of(&problem, continuation.parameter);
        let (folder, plots) = (folder.store().path(), &problem.output.plots);
        arguments.threads.install(1, usize::MAX, || {
            Ok(pictures::draw(folder, plots, Format::Svg, &settings)?)
        })?;
    }
    if !task.quiet {
        if let Some(title) = &problem.title {
            print(&format!("{title}\n\n"))?;
        }
        let section = problem.stability.as_ref();
        let whole_circle = section.is_some_and(|section| section.sectors == Sectors::All);
        print(&summary::branch(
            &out,
            continuation.parameter,
            whole_circle,
        )?)?;
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
            Ok(Exit::Numerical)
        }
        _ => Ok(Exit::Done),
    }
}
