//! `brakewave plot`.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, FormatArgument, print};
use crate::output::folder::Restart;
use crate::output::store::Store;
use crate::output::{plots, simulation};
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
    let pictures = if problem.output.plots.is_empty() {
        vec![Plot::Diagram]
    } else {
        problem.output.plots.clone()
    };
    let settings = plots::Settings {
        parameter: continuation.parameter.column().to_string(),
        title: problem.title.clone(),
    };
    let format = arguments.format.into();
    let names = pictures.iter();
    Store::visit(&arguments.folder)?
        .claim(names.map(|picture| plots::file_name(picture, format)))?;
    let written = plots::draw(&arguments.folder, &pictures, format, &settings)?;
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(0)
}

fn plot_simulation(arguments: &PlotArguments) -> Result<u8, Failure> {
    let checkpoint = simulation::Checkpoint::read(&arguments.folder)?;
    let title = checkpoint.problem.title.as_deref();
    let format = arguments.format.into();
    Store::visit(&arguments.folder)?.claim(plots::simulation_names(format))?;
    let written = plots::draw_simulation(&arguments.folder, title, format)?;
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(0)
}
