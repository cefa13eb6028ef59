//! What motions settle on over a parameter: a dot for every sample, and a branch over it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::diagram;
use super::orbits::constants;
use super::tables::{Tables, read};
use super::view::View;
use super::{Named, PlotError, put};
use crate::output::layout::{SCAN, SCANNED, VIEW};
use crate::output::render::{
    Axis, BLACK, BLUE, Extent, Format, GREY, Key, Layer, Legend, Mark, MarkShape, Panel, Pen,
    Picture, Point, VERMILLION, range,
};
use crate::output::store::{Store, StoreError, refused, unfinished};
use crate::problem::{SampleSection, Scan, ScanValues, SystemProblem};
use crate::table::Table;

/// Radius of a dot.
const DOT: f64 = 0.7;
/// Dots that are told apart over the height of the panel: more is a file without end.
const LEVELS: f64 = 500.0;

/// Height of the panel of exponents, and radius of its dots.
const EXPONENTS_HEIGHT: f64 = 130.0;
const EXPONENT_DOT: f64 = 1.0;

/// What an empty picture says.
const NONE: &str = "no motion came to the section";

/// Draws the picture of a folder, with the branch of a run over it where one is named; as a view that of a state that is named.
///
/// # Errors
/// When a table cannot be read, the branch has other columns, or a file cannot be written.
pub(crate) fn draw(
    store: &Store,
    problem: &SystemProblem,
    (over, state): (Option<&Path>, Option<&str>),
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let picture = picture(store.path(), problem, over, state);
    let name = match state {
        Some(_) => VIEW,
        None => SCANNED[usize::from(over.is_some())],
    };
    put(
        store,
        None,
        format,
        [(name.to_owned(), picture)] as [Named; 1],
    )
}

/// A state of every sample over the parameter, the first where none is named, a colour for each sweep. Of a branch over it the greatest and
/// the least value of the state are shown: samples lie between the two, or on one of them.
///
/// # Errors
/// As [`draw`].
pub(crate) fn picture(
    folder: &Path,
    problem: &SystemProblem,
    over: Option<&Path>,
    state: Option<&str>,
) -> Result<Picture, StoreError> {
    let source = &problem.system.source;
    let state = state.or(source.states.first().map(String::as_str));
    let (Some(scan), Some(state)) = (&problem.scan, state) else {
        return Err(unfinished(folder, "scan", "there is no section `scan`"));
    };
    let path = folder.join(SCAN);
    if !source.states.iter().any(|known| known == state) {
        let known = source.states.join(", ");
        let reason = format!("`{state}` is no state: samples have {known}");
        return Err(refused(&path, reason));
    }
    if !path.exists() {
        return Err(unfinished(folder, "scan", "its pieces are not joined yet"));
    }
    let table = read(&path, &["value", "sweep", "sample", state])?;
    let sweeps = sweeps(&table, state);
    let heights = sweeps.values().flatten().map(|point| point.1);
    let (low, high) = range(heights).unwrap_or((0.0, 1.0));
    // dots that fall on one another are one
    let level = |y: f64| ((y - low) / (high - low).max(f64::MIN_POSITIVE) * LEVELS).round() as i64;
    let mut layers = Vec::new();
    let mut keys = Vec::new();
    for (sweep, mut points) in sweeps {
        let mut seen = BTreeSet::new();
        points.retain(|(x, y)| seen.insert((x.to_bits(), level(*y))));
        let (colour, words) = match sweep {
            "up" => (BLUE, "from below"),
            "down" => (VERMILLION, "from above"),
            _ => (BLACK, "each begun anew"),
        };
        layers.push(Layer::Marks(points, Mark::new(MarkShape::Dot, DOT, colour)));
        keys.push((Key::Mark(Mark::new(MarkShape::Disc, 2.5, colour)), words));
    }
    let mut legend = Legend::default().with("samples:", keys);
    let nothing = layers.is_empty();
    if let Some(run) = over {
        let (lines, key) = branch(run, scan, state)?;
        layers.extend(lines);
        legend.groups.extend(key.groups);
    }
    let caption = match over {
        Some(_) => format!("{state}; branch: greatest and least {state}"),
        None => state.to_owned(),
    };
    let x = || Axis::new((scan.parameter.as_str(), ""), Extent::Data(0.02));
    let y = Axis::new((caption.as_str(), ""), Extent::Data(0.04));
    let mut panels = vec![Panel::new(x(), y, layers).unless(nothing, NONE)];
    if scan.lyapunov.count() > 0 {
        let layers = exponents(scan, &table);
        let y = Axis::new(("exponents λ", ""), Extent::Data(0.06));
        panels.push(Panel::new(x(), y, layers).high(EXPONENTS_HEIGHT));
    }
    let picture = Picture::new(panels, legend).titled(problem.title.as_deref());
    let subtitle = format!("{}; {}", taken(scan), constants(source, &[&scan.parameter]));
    Ok(picture.subtitled(&subtitle))
}

/// The greatest and the least value of a state along a branch over the parameter, and what explains the lines.
fn branch(run: &Path, scan: &Scan, state: &str) -> Result<(Vec<Layer>, Legend), StoreError> {
    let (mut layers, mut legend) = (Vec::new(), Legend::default());
    let tables = Tables::read(run, &scan.parameter)?;
    for (number, extremum) in ["max", "min"].into_iter().enumerate() {
        let column = format!("{extremum}_{state}");
        let ScanValues::Linear(low, high, _) = scan.values;
        let view = View {
            range: (low, high),
            logarithmic: Some(false),
            ..View::whole(&column)
        };
        let branch = diagram::picture(&tables, &view)?;
        let lines = branch.panels.into_iter().flat_map(|panel| panel.layers);
        layers.extend(lines.filter(|layer| matches!(layer, Layer::Line(..) | Layer::Marks(..))));
        if number == 0 {
            legend = branch.legend;
        }
    }
    Ok((layers, legend))
}

/// The samples of every sweep: parameter and state.
fn sweeps<'a>(table: &'a Table, state: &str) -> BTreeMap<&'a str, Vec<Point>> {
    let mut sweeps: BTreeMap<&str, Vec<Point>> = BTreeMap::new();
    for row in 0..table.len() {
        let point = (table.field(row, "value"), table.field(row, state));
        if let (Some(x), Some(y)) = point {
            sweeps
                .entry(table.text(row, "sweep"))
                .or_default()
                .push((x, y));
        }
    }
    sweeps
}

/// Every finite exponent over the parameter, the largest in black and others in grey, one dot a value and sweep, with the
/// line 0 that order and chaos lie beside.
fn exponents(scan: &Scan, table: &Table) -> Vec<Layer> {
    let columns = scan.exponent_columns();
    let values = columns.iter().step_by(2).enumerate().rev();
    let marks = values.map(|(number, column)| {
        let mut seen = BTreeSet::new();
        let rows = (0..table.len()).filter_map(|row| {
            let (x, y): (f64, f64) = (table.field(row, "value")?, table.field(row, column)?);
            seen.insert((x.to_bits(), y.to_bits())).then_some((x, y))
        });
        let points = rows.filter(|(_, y)| y.is_finite()).collect();
        let colour = if number == 0 { BLACK } else { GREY };
        Layer::Marks(points, Mark::new(MarkShape::Dot, EXPONENT_DOT, colour))
    });
    let zero = Layer::Across(0.0, Pen::solid(GREY, 0.6));
    std::iter::once(zero).chain(marks).collect()
}

/// Where samples are taken, in words.
fn taken(scan: &Scan) -> String {
    match &scan.section {
        SampleSection::Phase(phase) => format!("at phase {phase}"),
        SampleSection::Zero(expression) => format!("where {expression} rises to 0"),
    }
}
