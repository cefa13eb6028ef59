//! `brakewave plot`.

use std::path::PathBuf;

use clap::Args;

use super::failure::{Exit, Failure, Usage};
use super::options::format;
use super::print;
use crate::output::pictures;
use crate::output::render::Format;
use crate::output::run::Restart;
use crate::output::simulation::SimulationCheckpoint;
use crate::output::store::{Checkpoint, Store};
use crate::problem::Plot;

#[derive(Debug, Args)]
pub(crate) struct PlotArguments {
    /// Result folder of an earlier run
    folder: PathBuf,
    /// Format of the pictures: svg, png or pdf
    #[arg(long, default_value = "svg", value_parser = format)]
    format: Format,
}

pub(crate) fn plot(arguments: &PlotArguments) -> Result<Exit, Failure> {
    if arguments.folder.join(SimulationCheckpoint::FILE).exists() {
        return plot_simulation(arguments);
    }
    let restart = Restart::read(&arguments.folder)?;
    let problem = &restart.problem;
    let Some(continuation) = &problem.continuation else {
        return Err(Usage::NoBranch(arguments.folder.clone()).into());
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
    let format = arguments.format.available()?;
    let names = plots.iter();
    Store::visit(&arguments.folder)?.claim(names.map(|plot| pictures::file_name(plot, format)))?;
    list(&pictures::draw(
        &arguments.folder,
        plots,
        format,
        &settings,
    )?)
}

fn plot_simulation(arguments: &PlotArguments) -> Result<Exit, Failure> {
    let checkpoint = SimulationCheckpoint::read(&arguments.folder)?;
    let title = checkpoint.problem.title.as_deref();
    let format = arguments.format.available()?;
    Store::visit(&arguments.folder)?.claim(pictures::simulation_names(format))?;
    list(&pictures::draw_simulation(
        &arguments.folder,
        title,
        format,
    )?)
}

fn list(written: &[PathBuf]) -> Result<Exit, Failure> {
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(Exit::Done)
}
