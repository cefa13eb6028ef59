//! `brakewave curve`.

use std::path::PathBuf;

use clap::Args;

use super::run::{Prepared, of_mode, ready};
use super::{Failure, FormatArgument, NUMERICAL, default_folder, print, warn};
use crate::curve;
use crate::curve::start::{self, NoCurve};
use crate::output::curve_folder;
use crate::output::folder::{self, Restart};
use crate::output::plots::Format;
use crate::problem::{self, CurveEvent};

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
    /// Replace an earlier curve
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub fn curve(arguments: &CurveArguments) -> Result<u8, Failure> {
    Format::from(arguments.format).available()?;
    let (problem, text) = problem::read(&arguments.problem)?;
    let section = problem.curve(&text, &arguments.problem.display().to_string())?;
    let out = arguments.out.clone().unwrap_or_else(|| {
        let mut name = default_folder(&arguments.problem).into_os_string();
        name.push("_curve");
        PathBuf::from(name)
    });
    curve_folder::admit(&out, arguments.force)?;
    let start = match &section.event {
        CurveEvent::Label { dir, label } => {
            let earlier = Restart::read(dir)?;
            of_mode(&earlier, dir, problem.wave.mode).map_err(|(message, help)| {
                let name = arguments.problem.display().to_string();
                problem::refuse_at(&text, &name, "wave.mode", message, help)
            })?;
            let event = folder::labelled(dir, *label)?;
            start::labelled(&problem, earlier.wave(dir, *label)?, event, section)?
        }
        _ => {
            let Prepared {
                continuation,
                restart,
                source,
                ..
            } = ready(problem.clone(), text, &arguments.problem)?;
            start::find(&problem, &continuation, restart.as_ref(), section).map_err(|error| {
                match error {
                    NoCurve::Run(error) => source.place(error),
                    error => error.into(),
                }
            })?
        }
    };
    let found = curve::follow(&start.system, start.event, &start.point, start.settings)
        .map_err(NoCurve::Singular)?;
    let title = problem.title.as_deref();
    let format = arguments.format.into();
    curve_folder::write(&out, &found, start.settings.ranges, title, format)?;
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
