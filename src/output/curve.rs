//! The folder of a curve: `curve.csv`, a picture, `curve.svg` unless another format is asked for,
//! `problem.ron`, and `curve.steps` to go on from.
//!
//! Rows are appended as points are found, away from the event first one way and then the other; at the
//! end the table is put in order from one end to the other. `curve.steps` has a line for what the curve
//! begins with and one for every step: a checksum, and a value as RON. A resumed curve goes on after the
//! last whole line, through the same steps as an uninterrupted one.

use serde::de::DeserializeOwned;
use serde::{Serialize, Serializer};

use super::layout::{self, CURVE as TABLE};
use super::origin::ProblemOrigin;
use super::render::Format;
use super::store::{FolderKind, GrowingFile, Store, StoreError, damaged, encode, hash, unfinished};
use crate::curve::{
    CurveEndReason, CurveHead, CurvePoint, CurveRun, CurveStep, ParameterOf, ParameterPlane,
    PointType, WholeCurve,
};
use crate::orbit::Zones;
use crate::problem::Problem;
use crate::table;

const STEPS: &str = "curve.steps";

/// The folder of a curve being written.
#[derive(Debug)]
pub(crate) struct CurveFolder {
    store: Store,
    table: GrowingFile,
    steps: GrowingFile,
    rows: usize,
    /// Of further numbers.
    columns: Vec<String>,
    sector: Option<Option<usize>>,
}

/// What is wrong with a line of the steps.
#[derive(Debug, thiserror::Error)]
enum LineFlaw {
    #[error("it has no checksum")]
    NoSum,
    #[error("its checksum is another one")]
    OtherSum,
    #[error("{0}")]
    Content(#[from] ron::error::SpannedError),
}

fn value<T: DeserializeOwned>(line: &str) -> Result<T, LineFlaw> {
    let (sum, text) = line.split_once(' ').ok_or(LineFlaw::NoSum)?;
    if u64::from_str_radix(sum, 16) != Ok(hash(text.as_bytes())) {
        return Err(LineFlaw::OtherSum);
    }
    Ok(ron::from_str(text)?)
}

/// A curve to go on with.
pub(crate) struct InterruptedCurve<P: ParameterPlane> {
    /// The curve after its last step.
    pub run: CurveRun<P>,
    length: usize,
}

impl CurveFolder {
    /// What an interrupted run left.
    ///
    /// # Errors
    /// When that is damaged.
    pub(crate) fn interrupted<P: ParameterPlane>(
        store: &Store,
    ) -> Result<Option<InterruptedCurve<P>>, StoreError> {
        // a curve killed before it began has no points
        let path = store.path().join(STEPS);
        if !(store.resumes() && path.exists()) {
            return Ok(None);
        }
        let saved = CurveFolder::steps(store)?;
        match saved
            .as_ref()
            .is_some_and(|saved| saved.run.is_of_earlier_version())
        {
            true => Err(damaged(&path, "it is not as this version writes it")),
            false => Ok(saved),
        }
    }

    /// The curve of a folder as far as its steps are saved.
    ///
    /// # Errors
    /// When they are damaged, or there is none.
    pub(crate) fn saved<P: ParameterPlane>(store: &Store) -> Result<CurveRun<P>, StoreError> {
        let saved = match store.path().join(STEPS).exists() {
            true => CurveFolder::steps(store)?,
            false => None,
        };
        let nothing = || unfinished(store.path(), "curve", "no step is saved yet");
        saved.map(|saved| saved.run).ok_or_else(nothing)
    }

    fn steps<P: ParameterPlane>(store: &Store) -> Result<Option<InterruptedCurve<P>>, StoreError> {
        let path = store.path().join(STEPS);
        let bytes = store.lines(STEPS, None)?;
        let text = std::str::from_utf8(&bytes).map_err(|_| damaged(&path, "it is no text"))?;
        let wrong =
            |number: usize, flaw: LineFlaw| damaged(&path, format!("line {number}: {flaw}"));
        let mut lines = text.lines();
        let Some(first) = lines.next() else {
            return Ok(None);
        };
        let head: CurveHead<P> = value(first).map_err(|flaw| wrong(1, flaw))?;
        let steps = lines
            .zip(2..)
            .map(|(line, number)| value(line).map_err(|flaw| wrong(number, flaw)))
            .collect::<Result<Vec<CurveStep<P>>, StoreError>>()?;
        let run =
            CurveRun::resume(head, steps).map_err(|reason| damaged(&path, reason.to_string()))?;
        let length = bytes.len();
        Ok(Some(InterruptedCurve { run, length }))
    }

    /// Begins a curve, in place of an earlier one.
    ///
    /// # Errors
    /// When a file cannot be written, like all that follow.
    pub(crate) fn create<P: ParameterPlane>(
        store: Store,
        run: &CurveRun<P>,
        problem: &(impl Clone + Serialize),
        format: Format,
    ) -> Result<CurveFolder, StoreError> {
        let pictures = vec![layout::picture(FolderKind::Curve.name(), format)];
        store.begin(
            &[ProblemOrigin::<Problem>::FILE, STEPS, TABLE],
            pictures,
            None,
        )?;
        ProblemOrigin::keep(&store, problem)?;
        let steps = store.create(STEPS, b"")?;
        let mut folder = CurveFolder::tabulate(store, run, steps)?;
        folder.keep(run.head())?;
        Ok(folder)
    }

    /// Goes on with a curve.
    pub(crate) fn reopen<P: ParameterPlane>(
        store: Store,
        interrupted: &InterruptedCurve<P>,
    ) -> Result<CurveFolder, StoreError> {
        let steps = store.cut(STEPS, interrupted.length)?;
        CurveFolder::tabulate(store, &interrupted.run, steps)
    }

    /// The table of the points so far.
    fn tabulate<P: ParameterPlane>(
        store: Store,
        run: &CurveRun<P>,
        steps: GrowingFile,
    ) -> Result<CurveFolder, StoreError> {
        let system = &run.head().system;
        let columns = system.plane.columns();
        let header = header::<P>(&system.parameters(), &columns);
        let mut folder = CurveFolder {
            table: store.create(TABLE, header.as_bytes())?,
            steps,
            rows: 0,
            columns,
            sector: P::HAS_SECTORS.then(|| run.head().sector()),
            store,
        };
        for point in run.so_far() {
            folder.append::<P>(point)?;
        }
        Ok(folder)
    }

    fn append<P: ParameterPlane>(&mut self, point: &CurvePoint) -> Result<(), StoreError> {
        let told = (point.what.as_str(), &self.columns[..]);
        let row = CurveRow::new::<P>(self.rows, point, self.sector, told);
        self.table.row(&row)?;
        self.rows += 1;
        Ok(())
    }

    /// Appends what a step found.
    pub(crate) fn write<P: ParameterPlane>(
        &mut self,
        step: &CurveStep<P>,
    ) -> Result<(), StoreError> {
        for found in &step.found {
            self.append::<P>(&found.point)?;
        }
        self.keep(step)
    }

    /// Appends a line to the steps.
    fn keep(&mut self, value: &impl Serialize) -> Result<(), StoreError> {
        let text = encode(&self.store.path().join(STEPS), value)?;
        let line = format!("{:016x} {text}\n", hash(text.as_bytes()));
        self.steps.push(line.as_bytes())
    }

    /// Puts the table in order.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn finish<P: ParameterPlane>(
        &self,
        curve: &WholeCurve<P>,
    ) -> Result<(), StoreError> {
        self.store.replace(TABLE, table(curve).as_bytes())
    }

    pub(crate) fn store(&self) -> &Store {
        &self.store
    }
}

/// A row of `curve.csv`; the columns of the parameters have their names.
#[derive(Default, Serialize)]
struct CurveRow<'a> {
    point: usize,
    #[serde(rename = "type")]
    kind: Option<PointType>,
    first: f64,
    second: f64,
    /// Of what has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    measure: Option<f64>,
    regimes_before: &'a str,
    regimes_after: &'a str,
    /// Of waves.
    #[serde(skip_serializing_if = "Option::is_none")]
    sector: Option<Option<usize>>,
    angular: Option<f64>,
    numbers: FurtherNumbers<'a>,
    newton: usize,
    residual: f64,
    what: &'a str,
}

/// Further numbers, each in its column.
#[derive(Clone, Copy, Default)]
struct FurtherNumbers<'a> {
    columns: &'a [String],
    values: &'a [Option<f64>],
}

impl Serialize for FurtherNumbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let columns = self.columns.iter().enumerate();
        let value = |index: usize| self.values.get(index).copied().flatten();
        serializer.collect_map(columns.map(|(index, name)| (name, value(index))))
    }
}

fn header<P: ParameterPlane>([first, second]: &[ParameterOf<P>; 2], further: &[String]) -> String {
    let row = CurveRow {
        sector: P::HAS_SECTORS.then_some(None),
        measure: P::MEASURE.map(|_| 0.0),
        numbers: FurtherNumbers {
            columns: further,
            values: &[],
        },
        ..CurveRow::default()
    };
    let mut columns = table::columns(&row);
    let named = [
        ("first", Some(P::Orbit::column(first))),
        ("second", Some(P::Orbit::column(second))),
        ("measure", P::MEASURE),
        ("angular", Some(P::ANGULAR)),
    ];
    // further numbers, which come after these, have names of their own
    let places = named.map(|(own, name)| (columns.iter().position(|column| column == own), name));
    for (place, name) in places {
        if let (Some(place), Some(name)) = (place, name) {
            columns[place] = name.to_owned();
        }
    }
    table::line_of(&columns)
}

impl<'a> CurveRow<'a> {
    fn new<P: ParameterPlane>(
        index: usize,
        point: &'a CurvePoint,
        sector: Option<Option<usize>>,
        (what, columns): (&'a str, &'a [String]),
    ) -> CurveRow<'a> {
        CurveRow {
            point: index + 1,
            kind: point.kind,
            first: point.parameters[0],
            second: point.parameters[1],
            measure: P::MEASURE.map(|_| point.measure),
            regimes_before: &point.before,
            regimes_after: &point.after,
            sector,
            angular: point.angular,
            numbers: FurtherNumbers {
                columns,
                values: &point.numbers,
            },
            newton: point.newton,
            residual: point.residual,
            what,
        }
    }
}

/// The curve as CSV, from one end to the other.
pub(crate) fn table<P: ParameterPlane>(curve: &WholeCurve<P>) -> String {
    let mut text = header::<P>(&curve.parameters, &curve.columns);
    let sector = P::HAS_SECTORS.then_some(curve.sector);
    for (index, point) in curve.points.iter().enumerate() {
        let what = words(curve, index);
        let told = (what.as_str(), &curve.columns[..]);
        text.push_str(&table::line(&CurveRow::new::<P>(
            index, point, sector, told,
        )));
    }
    text
}

/// What happens at a point; the reason of an end stands at the first and at the last one.
pub(crate) fn words<P: ParameterPlane>(curve: &WholeCurve<P>, index: usize) -> String {
    let last = curve.points.len() - 1;
    let ends = [0, last].into_iter().zip(&curve.ends);
    let ends = ends.filter(|(place, end)| {
        *place == index && !matches!(end, CurveEndReason::There | CurveEndReason::Unknown)
    });
    let mut ends: Vec<&CurveEndReason<P>> = ends.map(|(_, end)| end).collect();
    ends.dedup();
    let what = Some(curve.points[index].what.clone()).filter(|what| !what.is_empty());
    let words = what
        .into_iter()
        .chain(ends.into_iter().map(CurveEndReason::to_string));
    words.collect::<Vec<_>>().join("; ")
}
