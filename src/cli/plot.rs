//! `brakewave plot`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{format, there};
use super::print;
use crate::branch::run::WaveRunner;
use crate::output::layout;
use crate::output::origin;
use crate::output::pictures::{self, View};
use crate::output::render::Format;
use crate::output::run::RunFolder;
use crate::output::store::{FolderKind, Store};
use crate::output::waves::Waves;
use crate::problem::{Any, Plot, SystemPlot, SystemProblem};

#[derive(Debug, Args)]
pub(crate) struct PlotArguments {
    /// Result folder of an earlier run, map, curve, scan, simulation, accuracy or steady
    folder: PathBuf,
    /// Format of the pictures: svg, png, pdf or tex (pgfplots)
    #[arg(long, default_value = "svg", value_parser = format)]
    format: Format,
    /// Draw one diagram instead, view.svg, with this column of branch.csv on the horizontal axis
    #[arg(long, value_name = "COLUMN")]
    x: Option<String>,
    /// The column on its vertical axis [default: speed]; of a scan, a state
    #[arg(long, value_name = "COLUMN")]
    y: Option<String>,
    /// A logarithmic axis: x, which is assumed, or y; give it twice for both
    #[arg(long, value_name = "AXIS", value_enum, num_args = 0..=1, default_missing_value = "x")]
    log: Vec<DiagramAxis>,
    /// Part of the horizontal axis
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    range: Option<(f64, f64)>,
    /// Part of the vertical axis
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    range_y: Option<(f64, f64)>,
    /// Draw a scan with the branch of this run folder over it, scan_over.svg
    #[arg(long, value_name = "RUN")]
    over: Option<PathBuf>,
    /// Replace a view that was drawn before
    #[arg(long)]
    force: bool,
}

/// An axis of a diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DiagramAxis {
    X,
    Y,
}

impl PlotArguments {
    /// Whether one view is asked for instead of all pictures.
    fn view(&self) -> bool {
        self.y.is_some() || self.view_of_branch()
    }

    /// Whether it is one that only a branch has.
    fn view_of_branch(&self) -> bool {
        let ranges = self.range.is_some() || self.range_y.is_some();
        self.x.is_some() || !self.log.is_empty() || ranges
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

pub(crate) fn plot(arguments: &PlotArguments) -> Result<VerbExit, VerbFailure> {
    let (folder, format) = (&arguments.folder, arguments.format.available()?);
    there(folder)?;
    let store = Store::visit(folder);
    let kind = store.as_ref().ok().and_then(Store::kind);
    let run = kind.is_none_or(|kind| kind == FolderKind::Run);
    let viewed = run || kind == Some(FolderKind::Scan) && !arguments.view_of_branch();
    if !viewed && arguments.view() {
        return Err(Usage::NoView(folder.clone()).into());
    }
    if arguments.over.is_some() && kind != Some(FolderKind::Scan) {
        return Err(Usage::NoScan(folder.clone()).into());
    }
    let mut problem = match kind {
        Some(FolderKind::MapShard | FolderKind::ScanShard) => {
            let verb = match kind {
                Some(FolderKind::MapShard) => FolderKind::Map.name(),
                _ => FolderKind::Scan.name(),
            };
            let folder = folder.clone();
            return Err(Usage::Unjoined { folder, verb }.into());
        }
        Some(FolderKind::Certificate) => return Err(Usage::NoPicture(folder.clone()).into()),
        _ => match origin::problem(folder)? {
            Some(Any::System(problem)) if kind == Some(FolderKind::Curve) => {
                return list(&pictures::orbits::draw(&store?, &problem, format)?);
            }
            Some(Any::System(problem)) if run => {
                return plot_orbits(arguments, &store?, *problem, format);
            }
            Some(Any::System(problem)) => {
                return plot_system(arguments, &store?, &problem, format);
            }
            known => known.and_then(Any::tube),
        },
    };
    if run && problem.is_none() {
        problem = Some(match &store {
            Ok(store) => RunFolder::<WaveRunner>::saved(store)?.problem,
            // a folder of a version before manifests may still hold a run
            Err(_) => Waves::read(folder)?.problem,
        });
    }
    let store = store?;
    if let Some(problem) = problem.as_mut().filter(|_| run) {
        if problem.continuation.is_none() {
            return Err(Usage::NoBranch(folder.clone()).into());
        }
        if arguments.view() {
            refuse_drawn(arguments, &store, format)?;
            let view = arguments.shown("speed");
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

/// The pictures of what is no branch of a system.
fn plot_system(
    arguments: &PlotArguments,
    store: &Store,
    problem: &SystemProblem,
    format: Format,
) -> Result<VerbExit, VerbFailure> {
    match store.kind() {
        Some(FolderKind::Scan) => {
            let over = arguments.over.as_deref();
            if let Some(run) = over {
                of_parameter(run, problem)?;
            }
            let state = arguments.y.as_deref();
            if state.is_some() {
                refuse_drawn(arguments, store, format)?;
            }
            let shown = (over, state);
            list(&pictures::scan::draw(store, problem, shown, format)?)
        }
        Some(FolderKind::Map) => {
            let picture = pictures::map::of_system(store.path(), problem);
            let mut named = vec![(FolderKind::Map.name().to_owned(), picture)];
            if problem.map.as_ref().is_some_and(|map| map.shares.is_some()) {
                let shares = pictures::shares::picture(store.path(), problem);
                named.push((layout::SHARES_PICTURE.to_owned(), shares));
            }
            list(&pictures::put(store, None, format, named)?)
        }
        Some(FolderKind::Simulation) => list(&pictures::motion::draw(store, problem, format)?),
        Some(FolderKind::Accuracy) => {
            let title = problem.title.as_deref();
            list(&pictures::draw_accuracy(store, title, format)?)
        }
        _ => Err(Usage::Unpictured(arguments.folder.clone()).into()),
    }
}

/// The pictures of a branch of orbits: those asked for, one view, or the diagram.
fn plot_orbits(
    arguments: &PlotArguments,
    store: &Store,
    mut problem: SystemProblem,
    format: Format,
) -> Result<VerbExit, VerbFailure> {
    if problem.continuation.is_none() {
        return Err(Usage::NoBranch(arguments.folder.clone()).into());
    }
    if arguments.view() {
        refuse_drawn(arguments, store, format)?;
        let (x, shown) = (arguments.x.as_deref(), |column: &str| {
            arguments.shown(column)
        });
        return list(&pictures::orbits::draw_view(
            store, &problem, x, shown, format,
        )?);
    }
    // a run that asked for no pictures still has its diagram
    if problem.output.plots.is_empty() {
        problem.output.plots.push(SystemPlot::Diagram);
    }
    list(&pictures::orbits::draw(store, &problem, format)?)
}

/// Refuses a run that is no branch in the parameter of a scan.
fn of_parameter(run: &Path, scan: &SystemProblem) -> Result<(), VerbFailure> {
    there(run)?;
    let is_run = Store::visit(run)?.kind() == Some(FolderKind::Run);
    let found = match origin::problem(run)? {
        Some(Any::System(problem)) if is_run => problem.continuation,
        _ => None,
    };
    let scanned = scan
        .scan
        .as_ref()
        .map_or("", |scan| scan.parameter.as_str());
    match found {
        Some(branch) if branch.parameter == scanned => Ok(()),
        _ => {
            let (folder, parameter) = (run.to_owned(), scanned.to_owned());
            Err(Usage::NoBranchIn { folder, parameter }.into())
        }
    }
}

/// Refuses to replace a view that was drawn before.
fn refuse_drawn(
    arguments: &PlotArguments,
    store: &Store,
    format: Format,
) -> Result<(), VerbFailure> {
    let earlier = store.path().join(pictures::view_file(format));
    if earlier.exists() && !arguments.force {
        return Err(Usage::Drawn(earlier).into());
    }
    Ok(())
}

impl PlotArguments {
    /// The view that is asked for, of this column where none is named.
    fn shown(&self, column: &str) -> View {
        View {
            column: self.y.clone().unwrap_or(column.to_owned()),
            range: self.range.unwrap_or(View::EVERYWHERE),
            logarithmic: Some(self.log.contains(&DiagramAxis::X)),
            height: self.range_y.unwrap_or(View::EVERYWHERE),
            logarithmic_height: self.log.contains(&DiagramAxis::Y),
        }
    }
}

fn list(written: &[PathBuf]) -> Result<VerbExit, VerbFailure> {
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(VerbExit::Done)
}
