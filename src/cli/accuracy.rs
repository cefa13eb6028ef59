//! `brakewave accuracy`.

use std::fs;
use std::io::{IsTerminal, stderr};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::run::{Prepared, prepare};
use super::{Failure, FormatArgument, default_folder, print, warn};
use crate::accuracy::{self, Repeats, Row};
use crate::output::plots::accuracy::Series;
use crate::output::plots::{Format, PlotError, Settings, draw_accuracy};
use crate::output::tables::number;

#[derive(Debug, Args)]
pub struct AccuracyArguments {
    /// Problem file
    problem: PathBuf,
    /// Folder of the table and the picture [default: results/<name of the problem file>_accuracy]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the results of an earlier run
    #[arg(long)]
    force: bool,
    /// Seconds to spend: methods are repeated within it, and left out when it is over
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = positive)]
    budget: f64,
    /// Most repetitions of a run, whose median time is given
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
    /// Format of the picture
    #[arg(long, value_enum, default_value = "svg")]
    format: FormatArgument,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("give a positive number of seconds".into()),
    }
}

/// Header of `accuracy.csv`.
const HEADER: &str = "method,setting,points,events_found,events_expected,speed_error,switch_error,\
event_error,eigenvalue_error,seconds,points_per_second,failure";

pub fn accuracy(arguments: &AccuracyArguments) -> Result<u8, Failure> {
    Format::from(arguments.format).available()?;
    let Prepared {
        problem,
        continuation,
        restart,
        source,
    } = prepare(&arguments.problem)?;
    if restart.is_some() {
        return Err(Failure::Usage(
            "every method begins from the closed form: give a problem that starts from `Fast` or \
             `Slow`"
                .into(),
        ));
    }
    let out = arguments.out.clone().unwrap_or_else(|| {
        let mut folder = default_folder(&arguments.problem).into_os_string();
        folder.push("_accuracy");
        folder.into()
    });
    prepare_folder(&out, arguments.force)?;
    let begun = Instant::now();
    let law = problem.model.friction_law;
    let (stripped, continuation) = accuracy::stripped(&problem, &continuation);
    let method = accuracy::reference_method(law);
    let reference =
        accuracy::follow(&stripped, &continuation, method).map_err(|error| source.place(error))?;
    let ladder = accuracy::ladder(law);
    let bar = (!arguments.quiet && stderr().is_terminal()).then(|| {
        let bar = ProgressBar::new(ladder.len() as u64);
        if let Ok(style) =
            ProgressStyle::with_template("{spinner} [{bar:40}] {pos}/{len} {msg} ({eta} left)")
        {
            bar.set_style(style.progress_chars("=> "));
        }
        bar
    });
    let mut rows = Vec::with_capacity(ladder.len());
    let mut left_out = 0;
    for (index, rung) in ladder.iter().enumerate() {
        let left = arguments.budget - begun.elapsed().as_secs_f64();
        if left <= 0.0 {
            left_out += 1;
            continue;
        }
        if let Some(bar) = &bar {
            bar.set_message(format!("{} {}", rung.method(), rung.setting()));
        }
        let repeats = Repeats {
            most: arguments.repeats.into(),
            seconds: left / (ladder.len() - index) as f64,
        };
        let row = accuracy::measure(&stripped, &continuation, *rung, &reference, repeats);
        rows.push(row);
        if let Some(bar) = &bar {
            bar.inc(1);
        }
    }
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    let path = out.join("accuracy.csv");
    fs::write(&path, table(&rows))
        .map_err(|source| Failure::Plot(PlotError::Write { path, source }))?;
    let settings = Settings {
        parameter: continuation.parameter.column().into(),
        title: problem.title.clone(),
    };
    let format = Format::from(arguments.format);
    let picture = out.join(format!("accuracy.{}", format.extension()));
    draw_accuracy(&picture, format, &series(&rows), &settings)?;
    if !arguments.quiet {
        print(&text(&rows, law.piecewise_linear()))?;
        print(&format!("results in {}\n", out.display()))?;
    }
    if left_out > 0 {
        warn(&format!(
            "{left_out} of {} settings were left out: give a larger --budget",
            ladder.len()
        ));
    }
    Ok(0)
}

fn prepare_folder(out: &Path, force: bool) -> Result<(), Failure> {
    if out.join("accuracy.csv").exists() && !force {
        return Err(Failure::Usage(format!(
            "{} holds results already; give another --out, or --force to replace them",
            out.display()
        )));
    }
    fs::create_dir_all(out)
        .map_err(|error| Failure::Usage(format!("cannot create {}: {error}", out.display())))
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// The rows as CSV.
fn table(rows: &[Row]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // writing to memory does not fail
    let _ = writer.write_record(HEADER.split(','));
    for row in rows {
        let _ = writer.write_record([
            row.rung.method().to_string(),
            row.rung.setting(),
            row.points.to_string(),
            row.events.0.to_string(),
            row.events.1.to_string(),
            optional(row.speed_error),
            optional(row.switch_error),
            optional(row.event_error),
            optional(row.eigenvalue_error),
            number(row.seconds),
            number(row.rate()),
            row.failure.clone().unwrap_or_default(),
        ]);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// The rows for a reader.
fn text(rows: &[Row], exact: bool) -> String {
    let mut text = format!(
        "{:<11} {:<26} {:>6} {:>6} {:>9} {:>9} {:>9} {:>11} {:>10} {:>10}\n",
        "method",
        "setting",
        "points",
        "events",
        "speed",
        "switches",
        "events",
        "eigenvalues",
        "seconds",
        "points/s"
    );
    let error = |value: Option<f64>| match value {
        Some(value) => format!("{value:.1e}"),
        None => "–".into(),
    };
    let measured = |value: f64, text: String| {
        if value.is_finite() {
            text
        } else {
            "–".into()
        }
    };
    for row in rows {
        text.push_str(&format!(
            "{:<11} {:<26} {:>6} {:>6} {:>9} {:>9} {:>9} {:>11} {:>10} {:>10}",
            row.rung.method(),
            row.rung.setting(),
            row.points,
            format!("{}/{}", row.events.0, row.events.1),
            error(row.speed_error),
            error(row.switch_error),
            error(row.event_error),
            error(row.eigenvalue_error),
            measured(row.seconds, format!("{:.2e}", row.seconds)),
            measured(row.rate(), format!("{:.0}", row.rate())),
        ));
        if let Some(failure) = &row.failure {
            text.push_str(&format!("  {failure}"));
        }
        text.push('\n');
    }
    text.push_str(if exact {
        "Errors are against the exact flow, those of the exact flow against the closed form in \
         higher precision.\n"
    } else {
        "Errors are against collocation of high order on a fine mesh: this friction law has no \
         exact flow.\n"
    });
    text
}

/// What the picture shows: methods with an error and a time.
fn series(rows: &[Row]) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    // a branch that ended early took less time than the whole of it
    for row in rows.iter().filter(|row| row.failure.is_none()) {
        // an error of zero has no logarithm: it is below the rounding unit
        let Some(error) = row.error().map(|error| error.max(f64::EPSILON)) else {
            continue;
        };
        if !(row.seconds > 0.0 && error.is_finite()) {
            continue;
        }
        let name = match row.rung.method() {
            "ring" => "ring (a wave)",
            other => other,
        };
        let point = (row.seconds, error);
        match all.iter_mut().find(|one| one.name == name) {
            Some(one) => one.points.push(point),
            None => all.push(Series {
                name: name.into(),
                points: vec![point],
            }),
        }
    }
    all
}
