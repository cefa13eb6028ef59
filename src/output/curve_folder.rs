//! The folder of a curve: `curve.csv`, a picture, `curve.svg` unless another format is asked for, and
//! `curve.steps` to go on from.
//!
//! Rows are appended as points are found, away from the event first one way and then the other; at the
//! end the table is put in order from one end to the other. `curve.steps` has a line for what the curve
//! begins with and one for every step: a checksum, and a value as RON. A resumed curve goes on after the
//! last whole line, through the same steps as an uninterrupted one.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Write;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::pictures::{self, PlotError};
use super::render::Format;
use super::store::{self, Store, StoreError, damaged, encode, hash, io_error};
use crate::curve::{Curve, Head, Point, Run, Step};
use crate::model::Parameter;
use crate::table;

/// Name of the table.
pub const TABLE: &str = "curve.csv";
/// Name of the picture without extension.
pub const PICTURE: &str = "curve";
/// Name of the steps.
pub const STEPS: &str = "curve.steps";

/// The folder of a curve being written.
#[derive(Debug)]
pub struct CurveFolder {
    store: Store,
    table: File,
    steps: File,
    rows: usize,
    sector: Option<usize>,
}

/// The curve of an interrupted run, and the bytes of its steps.
///
/// # Errors
/// When they are damaged.
pub fn interrupted(store: &Store) -> Result<Option<(Run, usize)>, StoreError> {
    let path = store.path().join(STEPS);
    // a curve killed before it began has no points
    if !store.resumes() || !path.exists() {
        return Ok(None);
    }
    let text = store::read(&path)?;
    // a kill may have cut the last line short
    let length = text.rfind('\n').map_or(0, |last| last + 1);
    let mut lines = text[..length].lines().enumerate();
    let wrong =
        |number: usize, reason: &str| damaged(&path, format!("line {}: {reason}", number + 1));
    fn value<T: DeserializeOwned>(line: &str) -> Result<T, String> {
        let (sum, text) = line.split_once(' ').ok_or("it has no checksum")?;
        if u64::from_str_radix(sum, 16) != Ok(hash(text.as_bytes())) {
            return Err("its checksum is another one".into());
        }
        ron::from_str(text).map_err(|error| error.to_string())
    }
    let Some((_, first)) = lines.next() else {
        return Ok(None);
    };
    let head: Head = value(first).map_err(|reason| wrong(0, &reason))?;
    let steps = lines
        .map(|(number, line)| value(line).map_err(|reason| wrong(number, &reason)))
        .collect::<Result<Vec<Step>, StoreError>>()?;
    let run = Run::resume(head, steps).map_err(|reason| damaged(&path, reason.to_string()))?;
    Ok(Some((run, length)))
}

impl CurveFolder {
    /// Begins a curve, in place of an earlier one.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn create(store: Store, run: &Run, format: Format) -> Result<CurveFolder, StoreError> {
        store.begin([STEPS.into(), TABLE.into(), picture(format)], None)?;
        let steps = store.create(STEPS, b"")?;
        let mut folder = CurveFolder::tabulate(store, run, steps)?;
        folder.keep(run.head())?;
        Ok(folder)
    }

    /// Goes on with a curve whose steps take these bytes.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn reopen(store: Store, run: &Run, length: usize) -> Result<CurveFolder, StoreError> {
        let steps = store.cut(STEPS, length)?;
        CurveFolder::tabulate(store, run, steps)
    }

    /// The table of the points so far.
    fn tabulate(store: Store, run: &Run, steps: File) -> Result<CurveFolder, StoreError> {
        let (mut text, mut rows) = (header(run.head().system.parameters()), 0);
        let sector = run.head().sector();
        for point in run.so_far() {
            text.push_str(&row(rows, point, sector, &point.what));
            rows += 1;
        }
        Ok(CurveFolder {
            table: store.create(TABLE, text.as_bytes())?,
            steps,
            rows,
            sector,
            store,
        })
    }

    /// What keeps the files.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// Appends what a step found.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write(&mut self, step: &Step) -> Result<(), StoreError> {
        let mut text = String::new();
        for found in &step.found {
            text.push_str(&row(
                self.rows,
                &found.point,
                self.sector,
                &found.point.what,
            ));
            self.rows += 1;
        }
        let path = self.store.path().join(TABLE);
        (self.table.write_all(text.as_bytes())).map_err(io_error("write it", &path))?;
        self.keep(step)
    }

    /// Appends a line to the steps.
    fn keep(&mut self, value: &impl Serialize) -> Result<(), StoreError> {
        let path = self.store.path().join(STEPS);
        let text = encode(&path, value)?;
        let line = format!("{:016x} {text}\n", hash(text.as_bytes()));
        (self.steps.write_all(line.as_bytes())).map_err(io_error("write it", &path))
    }

    /// Puts the table in order and draws the picture.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn finish(
        &self,
        curve: &Curve,
        ranges: [(f64, f64); 2],
        title: Option<&str>,
        format: Format,
    ) -> Result<(), PlotError> {
        self.store.replace(TABLE, table(curve).as_bytes())?;
        let picture = picture(format);
        self.store.claim([&picture])?;
        let path = self.store.path().join(picture);
        let drawn = pictures::curve::picture(curve, ranges).titled(title);
        pictures::replace(&path, format, &drawn)
    }
}

fn picture(format: Format) -> String {
    format!("{PICTURE}.{}", format.extension())
}

/// A row of `curve.csv`; the columns of the parameters have their names.
#[derive(Default, Serialize)]
struct Row<'a> {
    point: usize,
    #[serde(rename = "type")]
    kind: Option<&'a str>,
    first: f64,
    second: f64,
    speed: f64,
    regimes_before: &'a str,
    regimes_after: &'a str,
    sector: Option<usize>,
    omega: Option<f64>,
    newton: usize,
    residual: f64,
    what: &'a str,
}

fn header(parameters: [Parameter; 2]) -> String {
    let [first, second] = parameters.map(|parameter| parameter.column());
    let mut columns = table::columns(&Row::default());
    for column in &mut columns {
        match column.as_str() {
            "first" => *column = first.to_owned(),
            "second" => *column = second.to_owned(),
            _ => {}
        }
    }
    table::line_of(&columns)
}

fn row(index: usize, point: &Point, sector: Option<usize>, what: &str) -> String {
    table::line(&Row {
        point: index + 1,
        kind: point.kind.as_deref(),
        first: point.parameters[0],
        second: point.parameters[1],
        speed: point.speed,
        regimes_before: &point.before,
        regimes_after: &point.after,
        sector,
        omega: point.omega,
        newton: point.newton,
        residual: point.residual,
        what,
    })
}

/// The curve as CSV, from one end to the other.
pub fn table(curve: &Curve) -> String {
    let mut text = header(curve.parameters);
    for (index, point) in curve.points.iter().enumerate() {
        text.push_str(&row(index, point, curve.sector, &words(curve, index)));
    }
    text
}

/// What happens at a point; the reason of an end stands at the first and at the last one.
fn words(curve: &Curve, index: usize) -> String {
    let mut text = curve.points[index].what.clone();
    let last = curve.points.len() - 1;
    for (place, end) in [(0, &curve.ends[0]), (last, &curve.ends[1])] {
        if place == index && !text.contains(end.as_str()) {
            if !text.is_empty() {
                text.push_str("; ");
            }
            text.push_str(end);
        }
    }
    text
}

/// The special points, a line each.
pub fn summary(curve: &Curve) -> String {
    let mut text = String::new();
    let [first, second] = curve.parameters.map(|parameter| parameter.column());
    let _ = writeln!(
        text,
        "{} points; event, {first}, {second}, speed",
        curve.points.len()
    );
    let last = curve.points.len().saturating_sub(1);
    for (index, point) in curve.points.iter().enumerate() {
        let end = index == 0 || index == last;
        let Point {
            kind: Some(kind), ..
        } = point
        else {
            if end {
                let _ = writeln!(text, "  end: {}", words(curve, index));
            }
            continue;
        };
        let [one, other] = point.parameters;
        let _ = write!(
            text,
            "  {kind:<6} {one:.12}  {other:.12}  {:.12}",
            point.speed
        );
        if let Some(omega) = point.omega {
            let _ = write!(text, "  ω {omega:.12}");
        }
        let _ = writeln!(text, "  {}", words(curve, index));
    }
    text
}
