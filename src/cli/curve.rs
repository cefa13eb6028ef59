//! `brakewave curve`.

use clap::Args;
use serde::Serialize;

use super::failure::{VerbExit, VerbFailure};
use super::options::{Task, format, read_any};
use super::prepare::{
    ProblemSource, named, named_equilibrium, ready, ready_equilibrium, ready_system,
};
use super::progress::{ProgressLine, drive};
use super::{interrupt, summary, titled, warn};
use crate::branch::run::WaveRunner;
use crate::curve::search;
use crate::curve::start::{self, CurveStart, NoCurve};
use crate::curve::{
    CurveRun, EquilibriaInPlane, OrbitsInPlane, ParameterPlane, WholeCurve, find_of_equilibria,
    labelled_of_equilibria,
};
use crate::hybrid;
use crate::hybrid::equilibrium::{EquilibriumRunner, NoEquilibriumStart};
use crate::orbit::EventType;
use crate::orbit::legs;
use crate::output::curve::CurveFolder;
use crate::output::pictures::{self, PlotError};
use crate::output::render::Format;
use crate::output::store::{FolderKind, Store};
use crate::output::waves::labelled;
use crate::problem::{self, Any, CurveEvent, Problem, SystemCurveEvent, SystemProblem};

#[derive(Debug, Args)]
pub(crate) struct CurveArguments {
    /// Its problem file has a section `curve`, and `continuation` unless the event is a label
    #[command(flatten)]
    task: Task,
    /// Format of the picture: svg, png, pdf or tex (pgfplots)
    #[arg(long, default_value = "svg", value_parser = format)]
    format: Format,
}

pub(crate) fn curve(arguments: &CurveArguments) -> Result<VerbExit, VerbFailure> {
    let task = &arguments.task;
    let format = arguments.format.available()?;
    let (problem, text) = read_any(&task.problem)?;
    match problem {
        Any::Tube(problem) => of_tube(task, &problem, text, format),
        Any::System(problem) if problem.equilibrium.is_some() => {
            of_equilibria(task, &problem, text, format)
        }
        Any::System(problem) => of_system(task, &problem, text, format),
    }
}

fn of_tube(
    task: &Task,
    problem: &Problem,
    text: String,
    format: Format,
) -> Result<VerbExit, VerbFailure> {
    let name = task.name();
    let section = problem.curve(&text, &name)?;
    let store = task.open(&task.folder("_curve"), FolderKind::Curve, problem)?;
    let begin = || start(task, problem, text, section);
    let draw = |store: &Store, found: &WholeCurve, ranges| {
        let picture = (
            FolderKind::Curve.name().to_owned(),
            Ok(pictures::curve::of_waves(found, ranges, Some(problem))),
        );
        pictures::put(store, Some(problem), format, [picture]).map(|_| ())
    };
    let title = problem.title.as_deref();
    follow(
        task,
        store,
        (problem, title, format),
        begin,
        &VerbFailure::from,
        draw,
    )
}

fn of_system(
    task: &Task,
    problem: &SystemProblem,
    text: String,
    format: Format,
) -> Result<VerbExit, VerbFailure> {
    let name = task.name();
    let section = problem.curve(&text, &name)?;
    let source = ProblemSource::new(name, text.clone());
    let earlier = match &section.event {
        SystemCurveEvent::Label { dir, label } => Some(named(problem, dir, *label, true, &source)?),
        _ => None,
    };
    let kind = match &earlier {
        Some(named) => named.kind,
        None => section.event.kind(),
    };
    let refuse =
        |error: NoCurve<OrbitsInPlane>| refusal(&source, &error, hybrid::NoFirstPoint::about);
    let ready = || ready_system(problem.clone(), text, &task.problem);
    let progress = || ProgressLine::new(task.quiet);
    // a homoclinic orbit is followed as its saddle
    if kind == Some(EventType::HC) {
        let begin = || {
            let begun = match &earlier {
                Some(named) => start::labelled_connection(problem, &named.saved, section),
                None => {
                    let (prepared, progress) = (ready()?, progress());
                    let mut watch = |branch: &hybrid::OrbitRunner| looking(&progress, branch);
                    let begun = |problem: &SystemProblem| prepared.start(problem);
                    search::find_connection(problem, section, begun, &mut watch)
                }
            };
            begun.map_err(&refuse)
        };
        let about = NoEquilibriumStart::about;
        let refuse = |error: NoCurve<EquilibriaInPlane>| refusal(&source, &error, about);
        return follow_system(task, problem, format, begin, &refuse);
    }
    let begin = || {
        let begun = match &earlier {
            Some(named) => {
                let kind = named.kind.unwrap_or(EventType::EP);
                start::labelled_of_system(problem, &named.saved, kind, section)
            }
            None => {
                let (prepared, progress) = (ready()?, progress());
                let mut watch = |branch: &hybrid::OrbitRunner| looking(&progress, branch);
                let begun = |problem: &SystemProblem| prepared.start(problem);
                search::find_of_system(problem, section, begun, &mut watch)
            }
        };
        begun.map_err(&refuse)
    };
    follow_system(task, problem, format, begin, &refuse)
}

fn of_equilibria(
    task: &Task,
    problem: &SystemProblem,
    text: String,
    format: Format,
) -> Result<VerbExit, VerbFailure> {
    let name = task.name();
    let section = problem.curve(&text, &name)?;
    let source = ProblemSource::new(name, text.clone());
    let refuse =
        |error: NoCurve<EquilibriaInPlane>| refusal(&source, &error, NoEquilibriumStart::about);
    let begin = || {
        if let SystemCurveEvent::Label { dir, label } = &section.event {
            let at = ("curve.event", true);
            let named = named_equilibrium(problem, (dir, *label), at, &source)?;
            let begun = labelled_of_equilibria(problem, &named, section);
            return begun.map_err(&refuse);
        }
        let prepared = ready_equilibrium(problem.clone(), text, &task.problem)?;
        let progress = ProgressLine::new(task.quiet);
        let mut watch = |branch: &EquilibriumRunner| looking(&progress, branch);
        let begun = || prepared.start();
        find_of_equilibria(problem, section, begun, &mut watch).map_err(&refuse)
    };
    follow_system(task, problem, format, begin, &refuse)
}

/// Follows a curve of a system into its folder.
fn follow_system<P: ParameterPlane>(
    task: &Task,
    problem: &SystemProblem,
    format: Format,
    begin: impl FnOnce() -> Result<CurveStart<P>, VerbFailure>,
    refuse: &dyn Fn(NoCurve<P>) -> VerbFailure,
) -> Result<VerbExit, VerbFailure> {
    let store = task.open_system(&task.folder("_curve"), FolderKind::Curve, problem)?;
    let draw = |store: &Store, found: &WholeCurve<P>, ranges| {
        let drawn = pictures::orbits::draw_curve(store, problem, found, ranges, format);
        drawn.map(|_| ())
    };
    let title = problem.title.as_deref();
    follow(task, store, (problem, title, format), begin, refuse, draw)
}

/// Why there is no curve of a system, at the line of the problem file that it is about; of a branch that does not begin that
/// is known to the reason.
fn refusal<P: ParameterPlane>(
    source: &ProblemSource,
    error: &NoCurve<P>,
    about: impl Fn(&P::NoBranch) -> (&'static str, &'static str),
) -> VerbFailure {
    let (path, help) = match error {
        NoCurve::Run(reason) => about(reason),
        NoCurve::Outside { .. } => ("curve.range", "widen it"),
        NoCurve::Kind { .. } => ("curve.event", "name a label of one of these types"),
        NoCurve::NotFound { .. } => ("curve.event", "follow the branch further, or another way"),
        NoCurve::Unfolds { .. } => ("curve.parameters", "take another parameter"),
        NoCurve::NotSymmetric | NoCurve::NoConnection | NoCurve::Singular(_) => {
            ("curve.event", "begin with another event of the branch")
        }
    };
    let exit = match error {
        NoCurve::Outside { .. } | NoCurve::Kind { .. } => VerbExit::BadInput,
        _ => VerbExit::Numerical,
    };
    source.placed(path, error.to_string(), help, exit)
}

/// Says how far the branch is on which the event is looked for.
fn looking(progress: &ProgressLine, branch: &impl legs::Run) {
    let points = branch.progress().points;
    let words = format!("looking for the event: {points} points of the branch");
    progress.show(f64::NAN, words);
}

/// Follows a curve to both ends into a folder.
fn follow<P: ParameterPlane>(
    task: &Task,
    store: Store,
    (problem, title, format): (&(impl Clone + Serialize), Option<&str>, Format),
    begin: impl FnOnce() -> Result<CurveStart<P>, VerbFailure>,
    refuse: &dyn Fn(NoCurve<P>) -> VerbFailure,
    draw: impl Fn(&Store, &WholeCurve<P>, [(f64, f64); 2]) -> Result<(), PlotError>,
) -> Result<VerbExit, VerbFailure> {
    let singular = |reason| refuse(NoCurve::Singular(reason));
    let (mut run, mut folder) = match CurveFolder::interrupted(&store)? {
        Some(interrupted) => {
            interrupt::progress_is_kept();
            let folder = CurveFolder::reopen(store, &interrupted)?;
            (interrupted.run, folder)
        }
        None => {
            let start = begin()?;
            let run = CurveRun::begin(&start.system, start.event, &start.point, start.limits);
            let run = run.map_err(singular)?;
            let folder = CurveFolder::create(store, &run, problem, format)?;
            interrupt::progress_is_kept();
            (run, folder)
        }
    };
    drive(task.quiet, || {
        let Some(step) = run.step().map_err(singular)? else {
            return Ok(None);
        };
        folder.write(&step)?;
        Ok(Some((run.part(), run.position())))
    })?;
    let ranges = run.head().limits.ranges;
    let progress = ProgressLine::new(task.quiet);
    progress.show(
        f64::NAN,
        "the names of the regions beside the curve".to_owned(),
    );
    let found = run.curve();
    drop(progress);
    folder.finish(&found)?;
    // to read it back and name its regions again takes as long once more
    draw(folder.store(), &found, ranges)?;
    task.say(
        &titled(title, &summary::curve(&found)),
        "curve",
        &task.folder("_curve"),
    )?;
    if found.failed {
        for side in [0, 1] {
            warn(&found.end(side));
        }
        return Ok(VerbExit::Numerical);
    }
    Ok(VerbExit::Done)
}

/// The event that the curve begins with.
fn start(
    task: &Task,
    problem: &Problem,
    text: String,
    section: &problem::CurveSection,
) -> Result<CurveStart, VerbFailure> {
    if let CurveEvent::Label { dir, label } = &section.event {
        let source = ProblemSource::new(task.name(), text);
        let earlier = source.restart(dir, problem.wave.mode)?;
        let (event, wave) = (labelled(dir, *label)?, earlier.labelled(dir, *label)?);
        return Ok(start::labelled(problem, wave, event, section)?);
    }
    let prepared = ready(problem.clone(), text, &task.problem)?;
    let progress = ProgressLine::new(task.quiet);
    let mut watch = |branch: &WaveRunner| looking(&progress, branch);
    let begun = |problem: &Problem| prepared.start(task.quiet, problem);
    search::find(problem, section, begun, &mut watch).map_err(|error| match error {
        NoCurve::Run(error) => prepared.source.place(error),
        error => error.into(),
    })
}
