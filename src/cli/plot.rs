//! `brakewave plot`.

use std::path::PathBuf;

use clap::Args;

use super::failure::{Exit, Failure, Usage};
use super::options::format;
use super::print;
use crate::output::origin;
use crate::output::pictures::{self, View};
use crate::output::render::Format;
use crate::output::run::{Restart, RunFolder};
use crate::output::store::{Kind, Store};
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
    let store = Store::visit(folder);
    let kind = store.as_ref().ok().and_then(Store::kind);
    let run = kind.is_none_or(|kind| kind == Kind::Run);
    if !run && arguments.view() {
        return Err(Usage::NoView(folder.clone()).into());
    }
    let mut problem = match kind {
        Some(Kind::MapShard) => return Err(Usage::Unjoined(folder.clone()).into()),
        Some(Kind::Certificate) => return Err(Usage::NoPicture(folder.clone()).into()),
        // a folder of a version before manifests may still hold a run
        _ if run => Some(match &store {
            Ok(store) => RunFolder::saved(store)?.problem,
            Err(_) => Restart::read(folder)?.problem,
        }),
        _ => origin::problem(folder)?,
    };
    let store = store?;
    if let Some(problem) = problem.as_mut().filter(|_| run) {
        if problem.continuation.is_none() {
            return Err(Usage::NoBranch(folder.clone()).into());
        }
        if arguments.view() {
            let view = View {
                column: arguments.y.clone().unwrap_or("speed".to_owned()),
                range: arguments.range.unwrap_or(View::EVERYWHERE),
                logarithmic: Some(arguments.log),
            };
            let x = arguments.x.as_deref();
            return list(&pictures::draw_view(&store, problem, x, &view, format)?);
        }
        // a run that asked for no pictures still has its diagram
        if problem.output.plots.is_empty() {
            problem.output.plots.push(Plot::Diagram);
        }
    }
    list(&pictures::draw(&store, problem.as_ref(), format)?)
}

fn list(written: &[PathBuf]) -> Result<Exit, Failure> {
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(Exit::Done)
}
