//! `brakewave curve`.

use std::path::PathBuf;

use clap::Args;

use super::progress::Progress;
use super::run::{Prepared, of_mode, ready};
use super::{Failure, FormatArgument, NUMERICAL, default_folder, inputs, print, warn};
use crate::branch::run::Runner;
use crate::curve::Run;
use crate::curve::start::{self, NoCurve, Start};
use crate::output::curve_folder::{self, CurveFolder};
use crate::output::folder::{self, Restart};
use crate::output::render::Format;
use crate::output::store::{Existing, Kind, Store};
use crate::problem::{self, CurveEvent, Problem};

#[derive(Debug, Args)]
pub struct CurveArguments {
    /// Problem file with a section `curve`, and `continuation` unless the event is a label
    problem: PathBuf,
    /// Folder of the curve [default: results/<name of the problem file>_curve]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the picture
    #[arg(long, value_enum, default_value_t = FormatArgument::Svg)]
    format: FormatArgument,
    /// Go on with an interrupted curve; its files end as if it had not been interrupted
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace an earlier curve
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub fn curve(arguments: &CurveArguments) -> Result<u8, Failure> {
    let format = Format::from(arguments.format).available()?;
    let (problem, text) = problem::read(&arguments.problem)?;
    let section = problem.curve(&text, &arguments.problem.display().to_string())?;
    let out = arguments.out.clone().unwrap_or_else(|| {
        let mut name = default_folder(&arguments.problem).into_os_string();
        name.push("_curve");
        PathBuf::from(name)
    });
    let existing = Existing::of(arguments.resume, arguments.force);
    let inputs = inputs(&arguments.problem, &problem);
    let store = Store::open(&out, Kind::Curve, &problem, existing, &inputs)?;
    let mut progress = Progress::new(arguments.quiet);
    let (mut run, mut folder) = match curve_folder::interrupted(&store)? {
        Some((run, length)) => {
            let folder = CurveFolder::reopen(store, &run, length)?;
            (run, folder)
        }
        None => {
            let start = start(arguments, &problem, text, section, &mut progress)?;
            let run = Run::begin(&start.system, start.event, &start.point, start.limits)
                .map_err(NoCurve::from)?;
            let folder = CurveFolder::create(store, &run, format)?;
            (run, folder)
        }
    };
    while let Some(step) = run.step().map_err(NoCurve::from)? {
        folder.write(&step)?;
        progress.show(f64::NAN, || run.position());
    }
    drop(progress);
    let ranges = run.head().limits.ranges;
    let found = run.curve();
    folder.finish(&found, ranges, problem.title.as_deref(), format)?;
    if !arguments.quiet {
        if let Some(title) = &problem.title {
            print(&format!("{title}\n\n"))?;
        }
        print(&curve_folder::summary(&found))?;
        print(&format!("curve in {}\n", out.display()))?;
    }
    if found.failed {
        for end in &found.ends {
            warn(end);
        }
        return Ok(NUMERICAL);
    }
    Ok(0)
}

/// The event that the curve begins with.
fn start(
    arguments: &CurveArguments,
    problem: &Problem,
    text: String,
    section: &problem::Curve,
    progress: &mut Progress,
) -> Result<Start, Failure> {
    if let CurveEvent::Label { dir, label } = &section.event {
        let earlier = Restart::read(dir)?;
        of_mode(&earlier, dir, problem.wave.mode).map_err(|(message, help)| {
            let name = arguments.problem.display().to_string();
            problem::refuse_at(&text, &name, "wave.mode", message, help)
        })?;
        let event = folder::labelled(dir, *label)?;
        return Ok(start::labelled(
            problem,
            earlier.wave(dir, *label)?,
            event,
            section,
        )?);
    }
    let Prepared {
        continuation,
        restart,
        source,
        ..
    } = ready(problem.clone(), text, &arguments.problem)?;
    let mut watch = |branch: &Runner| {
        let points = branch.progress().points;
        progress.show(f64::NAN, || {
            format!("looking for the event: {points} points of the branch")
        });
    };
    start::find(
        problem,
        &continuation,
        restart.as_ref(),
        section,
        &mut watch,
    )
    .map_err(|error| match error {
        NoCurve::Run(error) => source.place(error),
        error => error.into(),
    })
}
