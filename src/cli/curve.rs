//! `brakewave curve`.

use crate::orbit::legs::Run as _;
use clap::Args;

use super::failure::{Exit, Failure};
use super::options::{Task, format};
use super::prepare::{Source, ready};
use super::progress::{Progress, drive};
use super::{summary, titled, warn};
use crate::branch::run::Runner;
use crate::curve::Run;
use crate::curve::start::{self, NoCurve, Start};
use crate::output::curve::CurveFolder;
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::store::Kind;
use crate::output::waves::labelled;
use crate::problem::{self, CurveEvent, Problem};

#[derive(Debug, Args)]
pub(crate) struct CurveArguments {
    /// Its problem file has a section `curve`, and `continuation` unless the event is a label
    #[command(flatten)]
    task: Task,
    /// Format of the picture: svg, png, pdf or tex (pgfplots)
    #[arg(long, default_value = "svg", value_parser = format)]
    format: Format,
}

pub(crate) fn curve(arguments: &CurveArguments) -> Result<Exit, Failure> {
    let task = &arguments.task;
    let format = arguments.format.available()?;
    let (problem, text, name) = task.read()?;
    let section = problem.curve(&text, &name)?;
    let out = task.folder("_curve");
    let store = task.open(&out, Kind::Curve, &problem)?;
    let (mut run, mut folder) = match CurveFolder::interrupted(&store)? {
        Some(interrupted) => {
            let folder = CurveFolder::reopen(store, &interrupted)?;
            (interrupted.run, folder)
        }
        None => {
            let start = start(task, &problem, text, section)?;
            let run = Run::begin(&start.system, start.event, &start.point, start.limits)
                .map_err(NoCurve::from)?;
            let folder = CurveFolder::create(store, &run, &problem, format)?;
            (run, folder)
        }
    };
    drive(task.quiet, || {
        let Some(step) = run.step().map_err(NoCurve::from)? else {
            return Ok(None);
        };
        folder.write(&step)?;
        Ok(Some((f64::NAN, run.position())))
    })?;
    let ranges = run.head().limits.ranges;
    let found = run.curve();
    folder.finish(&found)?;
    // to read it back and name its regions again takes as long once more
    let drawn = (
        "curve".to_owned(),
        Ok(pictures::curve::picture(&found, ranges)),
    );
    pictures::put(folder.store(), Some(&problem), format, [drawn])?;
    task.say(
        &titled(problem.title.as_deref(), &summary::curve(&found)),
        "curve",
        &out,
    )?;
    if found.failed {
        for side in [0, 1] {
            warn(&found.end(side));
        }
        return Ok(Exit::Numerical);
    }
    Ok(Exit::Done)
}

/// The event that the curve begins with.
fn start(
    task: &Task,
    problem: &Problem,
    text: String,
    section: &problem::Curve,
) -> Result<Start, Failure> {
    if let CurveEvent::Label { dir, label } = &section.event {
        let source = Source::new(task.problem.display().to_string(), text);
        let earlier = source.restart(dir, problem.wave.mode)?;
        let (event, wave) = (labelled(dir, *label)?, earlier.labelled(dir, *label)?);
        return Ok(start::labelled(problem, wave, event, section)?);
    }
    let prepared = ready(problem.clone(), text, &task.problem)?;
    let progress = Progress::new(task.quiet);
    let mut watch = |branch: &Runner| {
        let points = branch.progress().points;
        let words = format!("looking for the event: {points} points of the branch");
        progress.show(f64::NAN, words);
    };
    let begun = |problem: &Problem| prepared.start(task.quiet, problem);
    start::find(problem, section, begun, &mut watch).map_err(|error| match error {
        NoCurve::Run(error) => prepared.source.place(error),
        error => error.into(),
    })
}
