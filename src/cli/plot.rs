//! `brakewave plot`.

use std::path::PathBuf;

use clap::Args;

use super::failure::{Exit, Failure, Usage};
use super::options::format;
use super::print;
use crate::output::pictures::{self, Sole, View, draw_sole};
use crate::output::render::Format;
use crate::output::run::Restart;
use crate::output::simulation::SimulationCheckpoint;
use crate::output::store::{Checkpoint, Kind, Store};
use crate::problem::Plot;

#[derive(Debug, Args)]
pub(crate) struct PlotArguments {
    /// Result folder of an earlier run, map, curve, simulation, accuracy or steady
    folder: PathBuf,
    /// Format of the pictures: svg, png, pdf or tex (pgfplots)
    #[arg(long, default_value = "svg", value_parser = format)]
    format: Format,
    /// Draw one diagram instead, view.svg, with this column of branch.csv on the horizontal axis
    #[arg(long, value_name = "COLUMN")]
    x: Option<String>,
    /// The column on its vertical axis [default: speed]
    #[arg(long, value_name = "COLUMN")]
    y: Option<String>,
    /// A logarithmic horizontal axis
    #[arg(long)]
    log: bool,
    /// Part of the horizontal axis
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    range: Option<(f64, f64)>,
}

impl PlotArguments {
    /// Whether one view is asked for instead of all pictures.
    fn view(&self) -> bool {
        self.x.is_some() || self.y.is_some() || self.log || self.range.is_some()
    }
}

fn range(text: &str) -> Result<(f64, f64), Usage> {
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|value| !value.is_nan())
    };
    let ends = text.split_once(',');
    let ends = ends.and_then(|(low, high)| number(low).zip(number(high)));
    ends.filter(|(low, high)| low < high)
        .ok_or_else(|| Usage::Ends(text.to_owned()))
}

pub(crate) fn plot(arguments: &PlotArguments) -> Result<Exit, Failure> {
    let (folder, format) = (&arguments.folder, arguments.format.available()?);
    // a folder of a version before manifests may still hold a run
    if let Ok(store) = Store::visit(folder)
        && let Some(kind) = store.kind().filter(|kind| *kind != Kind::Run)
    {
        if arguments.view() {
            return Err(Usage::NoView(folder.clone()).into());
        }
        if let Some(sole) = Sole::of(kind) {
            return list(&[draw_sole(&store, sole, format)?]);
        }
        match kind {
            Kind::MapShard => return Err(Usage::Unjoined(folder.clone()).into()),
            Kind::Certificate => return Err(Usage::NoPicture(folder.clone()).into()),
            _ => {}
        }
    }
    if folder.join(SimulationCheckpoint::FILE).exists() {
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
    let (x, y) = (arguments.x.as_deref(), arguments.y.as_deref());
    let parameter = continuation.parameter;
    let mut settings = pictures::Settings::of(problem, parameter);
    if arguments.view() {
        settings.parameter = x.unwrap_or(parameter.column()).to_owned();
        let view = View {
            range: arguments
                .range
                .unwrap_or((f64::NEG_INFINITY, f64::INFINITY)),
            logarithmic: Some(arguments.log),
            ..View::whole(y.unwrap_or("speed"))
        };
        Store::visit(&arguments.folder)?.claim([pictures::view_name(format)])?;
        let folder = &arguments.folder;
        return list(&[pictures::draw_view(folder, &view, format, &settings)?]);
    }
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
    let (folder, format) = (&arguments.folder, arguments.format.available()?);
    let problem = SimulationCheckpoint::read(folder)?.problem;
    Store::visit(folder)?.claim(pictures::simulation_names(format))?;
    list(&pictures::draw_simulation(folder, &problem, format)?)
}

fn list(written: &[PathBuf]) -> Result<Exit, Failure> {
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(Exit::Done)
}
