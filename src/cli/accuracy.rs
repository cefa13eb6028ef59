//! `brakewave accuracy`.

use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use super::progress::Progress;
use super::run::{Prepared, prepare};
use super::{Failure, FormatArgument, default_folder, inputs, print, warn};
use crate::accuracy::{self, Missed, Repeats, Row, Rung};
use crate::output::plots::accuracy::Series;
use crate::output::plots::{Format, Settings, draw_accuracy};
use crate::output::store::{self, Existing, Kind, Store, StoreError, damaged, io_error};
use crate::output::tables::number;

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

/// Its header.
const HEADER: &str = "method,setting,points,events_found,events_expected,speed_error,switch_error,\
event_error,eigenvalue_error,seconds,points_per_second,failure";

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
    let law = problem.model.friction_law;
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
            store.create(TABLE, format!("{HEADER}\n").as_bytes())?
        };
        // the shortest time of the rung before, by method: a finer one takes no less
        let mut least = ("", 0.0);
        for (index, rung) in ladder.iter().enumerate() {
            if rows.iter().any(|row| row.rung == *rung) {
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
                    least = (rung.method(), row.seconds);
                    let path = store.path().join(TABLE);
                    (file.write_all(record(&row).as_bytes()))
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
    rows.sort_by_key(|row| ladder.iter().position(|rung| *rung == row.rung));
    let table: String = rows.iter().map(record).collect();
    store.replace(TABLE, format!("{HEADER}\n{table}").as_bytes())?;
    let settings = Settings {
        parameter: continuation.parameter.column().into(),
        title: problem.title.clone(),
    };
    store.claim([&picture])?;
    draw_accuracy(&out.join(picture), format, &series(&rows), &settings)?;
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
    if !text.starts_with(HEADER) {
        return match text.is_empty() {
            true => Ok(None),
            false => Err(damaged(&path, "its header is another one")),
        };
    }
    let mut rows: Vec<Row> = Vec::new();
    for record in csv::Reader::from_reader(text.as_bytes()).records() {
        let row = record.ok().and_then(|record| row(&record, ladder));
        let row = row.filter(|row| rows.iter().all(|other| other.rung != row.rung));
        let number = rows.len() + 1;
        rows.push(row.ok_or_else(|| damaged(&path, format!("row {number} is none")))?);
    }
    Ok(Some((rows, length)))
}

/// A row as it was written.
fn row(record: &csv::StringRecord, ladder: &[Rung]) -> Option<Row> {
    let (method, setting) = (record.get(0)?, record.get(1)?);
    let rung = ladder
        .iter()
        .find(|rung| rung.method() == method && rung.setting() == setting)?;
    let number = |column: usize| -> Option<Option<f64>> {
        match record.get(column)? {
            "" => Some(None),
            text => text.parse().ok().map(Some),
        }
    };
    let count = |column: usize| record.get(column)?.parse().ok();
    Some(Row {
        rung: *rung,
        points: count(2)?,
        events: (count(3)?, count(4)?),
        speed_error: number(5)?,
        switch_error: number(6)?,
        event_error: number(7)?,
        eigenvalue_error: number(8)?,
        seconds: number(9)?.unwrap_or(f64::NAN),
        failure: Some(record.get(11)?.to_owned()).filter(|failure| !failure.is_empty()),
    })
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// A row as CSV.
fn record(row: &Row) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // writing to memory does not fail
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
