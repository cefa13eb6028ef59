//! `brakewave accuracy`.

use std::fmt::Display;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{Task, format, positive, read_any};
use super::prepare::{ProblemSource, ready, ready_system};
use super::progress::{ProgressLine, drive};
use super::{interrupt, warn};
use crate::accuracy::{
    MeasuredFamily, MeasurementLimits, Measurements, Missed, OrbitBranch, RungRow, WaveBranch,
};
use crate::hybrid::NoFirstPoint;
use crate::output::accuracy::{AccuracyFolder, InterruptedTable};
use crate::output::pictures::{self, PlotError};
use crate::output::render::Format;
use crate::output::store::{FolderKind, Store};
use crate::problem::Any;

#[derive(Debug, Args)]
#[command(mut_arg("resume", |one| one.help(RESUME)))]
pub(crate) struct AccuracyArguments {
    #[command(flatten)]
    task: Task,
    /// Seconds to spend: methods are repeated within it, and cut and left out when it is over
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = positive)]
    budget: f64,
    /// Most repetitions of a run, whose median time is given
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
    /// Format of the picture: svg, png, pdf or tex (pgfplots)
    #[arg(long, default_value = "svg", value_parser = format)]
    format: Format,
}

/// What `--resume` does here: times are not measured twice alike.
const RESUME: &str = "Keep the rows that are measured, times included, and measure the others within a \
                      budget of their own; the reference is computed anew";

pub(crate) fn accuracy(arguments: &AccuracyArguments) -> Result<VerbExit, VerbFailure> {
    let (task, format) = (&arguments.task, arguments.format.available()?);
    let (problem, text) = read_any(&task.problem)?;
    let out = task.folder("_accuracy");
    match problem {
        Any::Tube(problem) => {
            let prepared = ready(*problem, text, &task.problem)?;
            let problem = &prepared.problem;
            if prepared.restart.is_some() {
                return Err(Usage::Restarted.into());
            }
            let store = task.open(&out, FolderKind::Accuracy, problem)?;
            let subject = WaveBranch::new(problem, &prepared.continuation);
            let draw = |store: &Store| pictures::draw(store, Some(problem), format);
            measure(arguments, store, subject, problem, &prepared.source, draw)
        }
        Any::System(problem) => {
            let prepared = ready_system(*problem, text, &task.problem)?;
            let problem = &prepared.problem;
            let store = task.open_system(&out, FolderKind::Accuracy, problem)?;
            let named = prepared.named.as_ref();
            let subject = OrbitBranch::new(problem, &prepared.continuation, named);
            let subject = subject.ok_or(NoFirstPoint::Unknown);
            let subject = subject.map_err(|error| prepared.source.place_orbit(&error))?;
            let title = problem.title.as_deref();
            let draw = |store: &Store| pictures::draw_accuracy(store, title, format);
            measure(arguments, store, subject, problem, &prepared.source, draw)
        }
    }
}

/// Measures every rung that has no row yet.
fn measure<S: MeasuredFamily>(
    arguments: &AccuracyArguments,
    store: Store,
    subject: S,
    problem: &(impl Clone + Serialize),
    source: &ProblemSource,
    draw: impl Fn(&Store) -> Result<Vec<PathBuf>, PlotError>,
) -> Result<VerbExit, VerbFailure> {
    let task = &arguments.task;
    let (ladder, reference, remark) = (subject.ladder(), subject.reference(), subject.remark());
    let earlier = AccuracyFolder::interrupted(&store, &ladder)?;
    if earlier.is_some() {
        interrupt::progress_is_kept();
    }
    let measured = |earlier: &InterruptedTable| earlier.rows.clone();
    let mut rows: Vec<RungRow> = earlier.as_ref().map(measured).unwrap_or_default();
    let mut course = None;
    if rows.len() < ladder.len() {
        let progress = ProgressLine::new(task.quiet);
        progress.show(f64::NAN, "the reference".into());
        let limits = MeasurementLimits {
            budget: arguments.budget,
            repeats: arguments.repeats.into(),
        };
        let begun = Measurements::begin(subject, &rows, limits);
        course = Some(begun.map_err(|missed| match missed {
            Missed::Run(error) => source.place(error),
            Missed::Orbit(error) => source.place_orbit(&error),
            _ => VerbFailure::from(Usage::Budget {
                method: reference.to_string(),
                budget: arguments.budget,
            }),
        })?);
    }
    let mut folder = AccuracyFolder::open(store, problem, arguments.format, earlier.as_ref())?;
    interrupt::progress_is_kept();
    if let Some(course) = &mut course {
        drive(task.quiet, || {
            if let Some(row) = course.measure_next() {
                folder.write(&row)?;
                rows.push(row);
            }
            let next = course.next_rung();
            Ok(next.map(|(index, rung)| (index as f64 / ladder.len() as f64, rung.to_string())))
        })?;
    }
    folder.sort(&mut rows, &ladder)?;
    draw(folder.store())?;
    let out = task.folder("_accuracy");
    task.say(&text(&rows, remark), "results", &out)?;
    let left_out = course.map_or(0, |course| course.left_out());
    if left_out > 0 {
        warn(&format!(
            "{left_out} of {} settings were left out: --resume with a larger --budget adds them",
            ladder.len()
        ));
    }
    Ok(VerbExit::Done)
}

/// A line of the table for a reader.
fn line<T: Display>(method: &str, setting: &str, cells: impl IntoIterator<Item = T>) -> String {
    let mut text = format!("{method:<11} {setting:<26}");
    for (cell, width) in cells.into_iter().zip([6, 6, 9, 9, 9, 11, 10, 10]) {
        text.push_str(&format!(" {cell:>width$}"));
    }
    text
}

/// The rows for a reader.
fn text(rows: &[RungRow], remark: &str) -> String {
    let names = "points events speed switches events eigenvalues seconds points/s";
    let mut text = line("method", "setting", names.split(' ')) + "\n";
    let shown =
        |value: Option<f64>, text: fn(f64) -> String| value.map_or_else(|| "–".into(), text);
    let error = |value| shown(value, |error| format!("{error:.1e}"));
    let measured = |value: Option<f64>, text| shown(value.filter(|value| value.is_finite()), text);
    for row in rows {
        let cells = [
            row.points.to_string(),
            format!("{}/{}", row.events_found, row.events_expected),
            error(row.speed_error),
            error(row.switch_error),
            error(row.event_error),
            error(row.eigenvalue_error),
            measured(row.seconds, |seconds| format!("{seconds:.2e}")),
            measured(row.points_per_second, |rate| format!("{rate:.0}")),
        ];
        text.push_str(&line(&row.method, &row.setting, cells));
        if let Some(failure) = &row.failure {
            text.push_str(&format!("  {failure}"));
        }
        text.push('\n');
    }
    text.push_str(remark);
    text.push('\n');
    text
}
