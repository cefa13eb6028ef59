//! `brakewave plot`.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, FormatArgument, print};
use crate::output::folder::Restart;
use crate::output::store::Store;
use crate::output::{pictures, simulation};
use crate::problem::Plot;

#[derive(Debug, Args)]
pub struct PlotArguments {
    /// Result folder of an earlier run
    folder: PathBuf,
    /// Format of the pictures
    #[arg(long, value_enum, default_value = "svg")]
    format: FormatArgument,
}

pub fn plot(arguments: &PlotArguments) -> Result<u8, Failure> {
    if arguments.folder.join(simulation::CHECKPOINT).exists() {
        return plot_simulation(arguments);
    }
    let restart = Restart::read(&arguments.folder)?;
    let problem = &restart.problem;
    let Some(continuation) = &problem.continuation else {
        return Err(Failure::Usage(format!(
            "{} holds no branch",
            arguments.folder.display()
        )));
    };
    // a run that asked for no pictures still has its diagram
    let plots = match problem.output.plots.as_slice() {
        [] => &[Plot::Diagram],
        plots => plots,
    };
    let settings = pictures::Settings {
        parameter: continuation.parameter.column().to_string(),
        title: problem.title.clone(),
    };
    let format = arguments.format.into();
    let names = plots.iter();
    Store::visit(&arguments.folder)?.claim(names.map(|plot| pictures::file_name(plot, format)))?;
    list(&pictures::draw(
        &arguments.folder,
        plots,
        format,
        &settings,
    )?)
}

fn plot_simulation(arguments: &PlotArguments) -> Result<u8, Failure> {
    let checkpoint = simulation::Checkpoint::read(&arguments.folder)?;
    let title = checkpoint.problem.title.as_deref();
    let format = arguments.format.into();
    Store::visit(&arguments.folder)?.claim(pictures::simulation_names(format))?;
    list(&pictures::draw_simulation(
        &arguments.folder,
        title,
        format,
    )?)
}

fn list(written: &[PathBuf]) -> Result<u8, Failure> {
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(0)
}
