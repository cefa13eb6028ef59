//! `brakewave accuracy`.

use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use super::progress::Progress;
use super::run::{Prepared, prepare};
use super::{Failure, FormatArgument, default_folder, inputs, print, warn};
use crate::accuracy::{self, Missed, Repeats, Row, Rung};
use crate::output::pictures;
use crate::output::pictures::accuracy::Series;
use crate::output::render::Format;
use crate::output::store::{self, Existing, Kind, Store, StoreError, damaged, io_error};
use crate::table::{self, Table};

#[derive(Debug, Args)]
pub struct AccuracyArguments {
    /// Problem file
    problem: PathBuf,
    /// Folder of the table and the picture [default: results/<name of the problem file>_accuracy]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Keep what an earlier run has measured and go on with the rest
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace the results of an earlier run
    #[arg(long)]
    force: bool,
    /// Seconds to spend: methods are repeated within it, and cut and left out when it is over
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

/// Name of the table.
const TABLE: &str = "accuracy.csv";

pub fn accuracy(arguments: &AccuracyArguments) -> Result<u8, Failure> {
    let format = Format::from(arguments.format).available()?;
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
    let picture = format!("accuracy.{}", format.extension());
    let existing = Existing::of(arguments.resume, arguments.force);
    let inputs = inputs(&arguments.problem, &problem);
    let store = Store::open(&out, Kind::Accuracy, &problem, existing, &inputs)?;
    let law = problem.model.law;
    let ladder = accuracy::ladder(law);
    let earlier = if store.resumes() {
        earlier(&store, &ladder)?
    } else {
        None
    };
    let resumed = earlier.is_some();
    let (mut rows, length) = earlier.unwrap_or_default();
    let mut left_out = 0;
    if rows.len() < ladder.len() {
        let begun = Instant::now();
        let until = Duration::try_from_secs_f64(arguments.budget)
            .ok()
            .and_then(|budget| begun.checked_add(budget));
        let mut progress = Progress::new(arguments.quiet);
        progress.show(f64::NAN, || "the reference".into());
        let (stripped, continuation) = accuracy::stripped(&problem, &continuation);
        let method = accuracy::reference_method(law);
        let reference = accuracy::follow(&stripped, &continuation, method, until);
        let reference = reference.map_err(|missed| match missed {
            Missed::Run(error) => source.place(error),
            _ => Failure::Usage(format!(
                "the reference, {}, takes longer than --budget {}: give a larger one",
                Rung::Flow(method),
                arguments.budget
            )),
        })?;
        let mut file = if resumed {
            store.cut(TABLE, length)?
        } else {
            store.begin([TABLE.to_owned(), picture.clone()], None)?;
            store.create(TABLE, table::header::<Row>().as_bytes())?
        };
        // the shortest time of the rung before, by method: a finer one takes no less
        let mut least = ("", 0.0);
        for (index, rung) in ladder.iter().enumerate() {
            if rows.iter().any(|row| row.is_of(*rung)) {
                continue;
            }
            let left = arguments.budget - begun.elapsed().as_secs_f64();
            if left <= 0.0 || least.0 == rung.method() && least.1 > left {
                left_out += 1;
                continue;
            }
            progress.show(index as f64 / ladder.len() as f64, || rung.to_string());
            let repeats = Repeats {
                most: arguments.repeats.into(),
                seconds: left / (ladder.len() - index) as f64,
                until,
            };
            match accuracy::measure(&stripped, &continuation, *rung, &reference, repeats) {
                Some(row) => {
                    least = (rung.method(), row.seconds.unwrap_or(f64::NAN));
                    let path = store.path().join(TABLE);
                    (file.write_all(table::line(&row).as_bytes()))
                        .map_err(io_error("write it", &path))?;
                    rows.push(row);
                }
                None => {
                    least = (rung.method(), f64::INFINITY);
                    left_out += 1;
                }
            }
        }
    }
    // those of a resumed run come after the others
    rows.sort_by_key(|row| ladder.iter().position(|rung| row.is_of(*rung)));
    store.replace(TABLE, table::table(rows.iter().cloned()).as_bytes())?;
    store.claim([&picture])?;
    let drawn = pictures::accuracy::picture(&series(&rows)).titled(problem.title.as_deref());
    pictures::replace(&out.join(picture), format, &drawn)?;
    if !arguments.quiet {
        print(&text(&rows, law.piecewise_linear()))?;
        print(&format!("results in {}\n", out.display()))?;
    }
    if left_out > 0 {
        warn(&format!(
            "{left_out} of {} settings were left out: --resume with a larger --budget adds them",
            ladder.len()
        ));
    }
    Ok(0)
}

/// The rows of an earlier run and the bytes they take with the header; none where there is no table.
fn earlier(store: &Store, ladder: &[Rung]) -> Result<Option<(Vec<Row>, usize)>, StoreError> {
    let path = store.path().join(TABLE);
    if !path.exists() {
        return Ok(None);
    }
    let text = store::read(&path)?;
    // a kill may have cut the last row short
    let length = text.rfind('\n').map_or(0, |last| last + 1);
    let text = &text[..length];
    if text.is_empty() {
        return Ok(None);
    }
    if !text.starts_with(&table::header::<Row>()) {
        return Err(damaged(&path, "its header is another one"));
    }
    let rows = Table::parse(text.as_bytes()).and_then(|table| table.rows::<Row>());
    let rows = rows.map_err(|error| damaged(&path, error.to_string()))?;
    let of = |row: &Row| ladder.iter().position(|rung| row.is_of(*rung));
    for (index, row) in rows.iter().enumerate() {
        if of(row).is_none() || rows[..index].iter().any(|other| of(other) == of(row)) {
            let reason = format!("row {} is of no method, or of one twice", index + 1);
            return Err(damaged(&path, reason));
        }
    }
    Ok(Some((rows, length)))
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
    let measured = |value: Option<f64>, text: fn(f64) -> String| {
        let value = value.filter(|value| value.is_finite());
        value.map_or_else(|| "–".into(), text)
    };
    for row in rows {
        text.push_str(&format!(
            "{:<11} {:<26} {:>6} {:>6} {:>9} {:>9} {:>9} {:>11} {:>10} {:>10}",
            row.method,
            row.setting,
            row.points,
            format!("{}/{}", row.events_found, row.events_expected),
            error(row.speed_error),
            error(row.switch_error),
            error(row.event_error),
            error(row.eigenvalue_error),
            measured(row.seconds, |seconds| format!("{seconds:.2e}")),
            measured(row.points_per_second, |rate| format!("{rate:.0}")),
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
        let Some(seconds) = row
            .seconds
            .filter(|seconds| *seconds > 0.0 && error.is_finite())
        else {
            continue;
        };
        let name = match row.method.as_str() {
            "ring" => "ring (a wave)",
            other => other,
        };
        let point = (seconds, error);
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
