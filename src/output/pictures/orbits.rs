//! Pictures of a branch of orbits: columns over the parameter, phase planes, time series, multipliers.

use std::path::PathBuf;

use super::colours::distinct;
use super::diagram::{self, extent, same_leg};
use super::multipliers::{self, MultipliersAlong};
use super::names::own_quantity;
use super::profile::evenly;
use super::tables::{self, Tables, column, read, read_if_there};
use super::view::{View, parameter_axis};
use super::{Named, PlotError, put};
use crate::affine::system::Source;
use crate::curve::{self, ParameterPlane, WholeCurve};
use crate::orbit::Zones;
use crate::output::curve::CurveFolder;
use crate::output::layout::{self, MULTIPLIERS, profile_file};
use crate::output::render::{
    Axis, Extent, Format, Key, Layer, Legend, Mark, MarkShape, Panel, Pattern, Pen, Picture, Point,
    number,
};
use crate::output::store::{FolderKind, Store, StoreError};
use crate::problem::{SystemPlot, SystemProblem};
use crate::table::Table;

/// Most orbits in a picture of orbits: more colours are not told apart.
const MOST: usize = 6;

const WIDTH: f64 = 1.8;
const JUMP: f64 = 1.0;

/// An orbit that spans less than this share of both axes is a point: its line would be hidden by the width of one.
const POINT: f64 = 0.004;

/// Size of the mark of such an orbit.
const DOT: f64 = 3.4;

/// Between two pieces of a line.
const GAP: Point = (f64::NAN, f64::NAN);

/// Points differ by less than this share of the largest value where a column stays the same along a branch, or an orbit closes: far
/// above rounding, far below what a picture shows.
const STILL: f64 = 1e-9;

/// What an empty picture says.
const NONE: &str = "no orbit was sampled: ask for `profiles` in `output`";
const UNKNOWN: &str = "no multiplier is known: ask for `stability: ()`";

/// A labelled orbit.
struct Sampled {
    label: String,
    value: f64,
    samples: Table,
}

/// Draws the pictures that a problem with a system asks for.
///
/// # Errors
/// As for waves.
pub(crate) fn draw(
    store: &Store,
    problem: &SystemProblem,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    if store.kind() == Some(FolderKind::Curve) {
        return match problem.equilibrium {
            Some(_) => draw_saved_curve::<curve::EquilibriaInPlane>(store, problem, format),
            None => draw_saved_curve::<curve::OrbitsInPlane>(store, problem, format),
        };
    }
    let Some(section) = &problem.continuation else {
        return Ok(Vec::new());
    };
    let tables = Tables::read(store.path(), &section.parameter)?;
    let source = &problem.system.source;
    let orbits = sampled(store, &tables, &problem.output.labels)?;
    let title = problem.title.as_deref();
    let picture = |plot: &SystemPlot| -> Named {
        let drawn = describe(store, source, plot, &tables, &orbits);
        let subtitle = constants(source, &varying(problem, &[&section.parameter]));
        let drawn = drawn.map(|picture| picture.titled(title).subtitled(&subtitle));
        (layout::orbit_plot(plot), drawn)
    };
    put(
        store,
        None,
        format,
        problem.output.plots.iter().map(picture),
    )
}

/// Draws one column of the branch over another one, or over the parameter. `shown` is the view, given the
/// column that a diagram shows unless told otherwise.
///
/// # Errors
/// As [`draw`].
pub(crate) fn draw_view(
    store: &Store,
    problem: &SystemProblem,
    x: Option<&str>,
    shown: impl Fn(&str) -> View,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let section = problem.continuation.as_ref();
    let parameter = section.map_or("", |section| section.parameter.as_str());
    let tables = Tables::read(store.path(), x.unwrap_or(parameter))?;
    let view = shown(&ordinate(&problem.system.source, &tables.branch));
    tables.check_column(&view.column)?;
    let drawn = diagram::picture(&tables, &view)?;
    let subtitle = constants(&problem.system.source, &varying(problem, &[parameter]));
    let drawn = drawn.titled(problem.title.as_deref()).subtitled(&subtitle);
    put(store, None, format, [(layout::VIEW.to_owned(), Ok(drawn))])
}

/// Draws the curve of a folder.
fn draw_saved_curve<P: ParameterPlane>(
    store: &Store,
    problem: &SystemProblem,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let run = CurveFolder::saved::<P>(store)?;
    let ranges = run.head().limits.ranges;
    draw_curve(store, problem, &run.curve(), ranges, format)
}

/// Draws the curve of an event.
///
/// # Errors
/// As [`draw`].
pub(crate) fn draw_curve<P: ParameterPlane>(
    store: &Store,
    problem: &SystemProblem,
    curve: &WholeCurve<P>,
    ranges: [(f64, f64); 2],
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let drawn = super::curve::picture(curve, ranges, own_quantity);
    let followed = curve.parameters.each_ref().map(P::Orbit::column);
    let subtitle = constants(&problem.system.source, &varying(problem, &followed));
    let drawn = drawn.titled(problem.title.as_deref()).subtitled(&subtitle);
    let name = FolderKind::Curve.name().to_owned();
    put(store, None, format, [(name, Ok(drawn))])
}

fn describe(
    store: &Store,
    source: &Source,
    plot: &SystemPlot,
    tables: &Tables,
    orbits: &[Sampled],
) -> Result<Picture, StoreError> {
    match plot {
        SystemPlot::Diagram => {
            let column = ordinate(source, &tables.branch);
            diagram::picture(tables, &View::whole(&column))
        }
        SystemPlot::Column(name) => diagram::picture(tables, &View::whole(name)),
        SystemPlot::Phase(one, other) => Ok(curves(orbits, one, other, &tables.parameter)),
        SystemPlot::Time(state) => Ok(curves(orbits, "time", state, &tables.parameter)),
        SystemPlot::Multipliers => {
            let path = store.path().join(MULTIPLIERS);
            let table = read_if_there(&path, &["label", "re", "im"])?;
            let along = along(table.as_ref(), tables);
            Ok(multipliers::of_branch(
                &along,
                parameter_axis(tables),
                UNKNOWN,
            ))
        }
    }
}

/// The column that a diagram shows: the greatest value of the first state, unless it stays the same along most of
/// the branch, as at a stop; then the first of its least value and those of the other states that does not.
pub(super) fn ordinate(source: &Source, branch: &Table) -> String {
    let extrema = |state: &String| ["max", "min"].map(|end| format!("{end}_{state}"));
    // a branch of equilibria has the states themselves; an orbit's other columns may have the name of a state
    let columns = |state: &String| match extrema(state) {
        extrema if branch.has(&extrema[0]) => extrema.to_vec(),
        _ => vec![state.clone()],
    };
    let mut columns = source.states.iter().flat_map(columns);
    let changes = |name: &String| {
        let values = column(branch, name);
        let size = values
            .iter()
            .fold(0.0, |size: f64, value| size.max(value.abs()));
        let still = |pair: &&[f64]| (pair[1] - pair[0]).abs() <= STILL * size;
        2 * values.windows(2).filter(still).count() < values.len()
    };
    let first = columns.clone().next();
    let chosen = columns.find(changes).or(first);
    chosen.unwrap_or("period".to_owned())
}

/// These parameters and the one that is free for a prescribed period.
fn varying<'a>(problem: &'a SystemProblem, followed: &[&'a str]) -> Vec<&'a str> {
    let free = problem.orbit.free.as_deref();
    followed.iter().copied().chain(free).collect()
}

/// The parameters that stay as they are.
pub(super) fn constants(source: &Source, followed: &[&str]) -> String {
    let others = source
        .parameters
        .0
        .iter()
        .filter(|(name, _)| !followed.contains(&name.as_str()));
    let words: Vec<String> = others
        .map(|(name, value)| format!("{name} = {}", number::significant(*value, 4)))
        .collect();
    words.join(", ")
}

/// Orbits that have a profile: those of the labels that are asked for, or else some that are evenly spread.
fn sampled(store: &Store, tables: &Tables, asked: &[usize]) -> Result<Vec<Sampled>, StoreError> {
    // the orbit at which both legs begin has a label in each
    let begun = tables.begun();
    let again = |label: &&str| begun.iter().skip(1).any(|begun| begun == label);
    let labels: Vec<String> = (0..tables.branch.len())
        .map(|row| tables.branch.text(row, "label"))
        .filter(|label| !asked.is_empty() || !again(label))
        .map(str::to_owned)
        .filter(|label| {
            let file = label.parse().map(profile_file);
            file.is_ok_and(|file| store.path().join(file).exists())
        })
        .collect();
    let chosen: Vec<&String> = match asked {
        [] => evenly(labels.len(), MOST)
            .into_iter()
            .map(|index| &labels[index])
            .collect(),
        asked => labels
            .iter()
            .filter(|label| asked.iter().any(|one| one.to_string() == **label))
            .collect(),
    };
    let read = chosen.into_iter().map(|label| {
        let label = label.clone();
        let file = profile_file(label.parse().unwrap_or_default());
        Ok(Sampled {
            value: tables.parameter_at(&label).unwrap_or(f64::NAN),
            samples: read(&store.path().join(file), &["time", "mode"])?,
            label,
        })
    });
    read.collect()
}

/// An orbit over two columns: its line, and its jumps.
fn traced(samples: &Table, x: &str, y: &str) -> [Vec<Point>; 2] {
    let times = column(samples, "time");
    let pairs = column(samples, x).into_iter().zip(column(samples, y));
    let mut line: Vec<Point> = Vec::with_capacity(samples.len() + 8);
    let mut jumps: Vec<Point> = Vec::new();
    let mut before: Option<(Point, f64)> = None;
    for (point, time) in pairs.zip(times) {
        // two samples at one time are the two sides of a switch
        if let Some((last, _)) = before.filter(|(_, before)| time == *before) {
            line.push(GAP);
            if last != point {
                jumps.extend([last, point, GAP]);
            }
        }
        before = Some((point, time));
        line.push(point);
    }
    // an orbit that begins with a jump ends before it
    if let (Some(&first), Some((last, _))) = (line.first(), before.filter(|_| x != "time")) {
        let apart = (last.0 - first.0).hypot(last.1 - first.1);
        if apart > STILL * last.0.hypot(last.1).max(first.0.hypot(first.1)) {
            jumps.extend([last, first, GAP]);
        }
    }
    [line, jumps]
}

/// Columns of the orbits over one another, dotted where a reset makes a state jump; those of no size are dots.
fn curves(orbits: &[Sampled], x: &str, y: &str, parameter: &str) -> Picture {
    let traces: Vec<[Vec<Point>; 2]> = orbits
        .iter()
        .map(|orbit| traced(&orbit.samples, x, y))
        .collect();
    let all = extent(traces.iter().flat_map(|[line, _]| line));
    let mut layers = Vec::new();
    let mut keys = Vec::new();
    for (place, (orbit, [line, jumps])) in orbits.iter().zip(traces).enumerate() {
        let mut spans = extent(line.iter()).into_iter().zip(all);
        let is_point = spans.all(|(own, all)| own < POINT * all);
        let pen = Pen::solid(distinct(place), WIDTH);
        let jump = Pen {
            width: JUMP,
            pattern: Pattern::Dotted,
            ..pen
        };
        let dot = Mark::new(MarkShape::Disc, DOT, pen.colour);
        if is_point {
            let middle = line.first().copied().into_iter().collect();
            layers.push(Layer::Marks(middle, dot));
        } else {
            layers.push(Layer::Line(jumps, jump));
            layers.push(Layer::Line(line, pen));
        }
        let key = if is_point {
            Key::Mark(dot)
        } else {
            Key::Line(pen)
        };
        let value = number::significant(orbit.value, 6);
        keys.push((key, format!("{} ({parameter} = {value})", orbit.label)));
    }
    let axis = |name: &str| Axis::new((name, ""), Extent::Data(0.04));
    let panel = Panel::new(axis(x), axis(y), layers).unless(orbits.is_empty(), NONE);
    Picture::new(vec![panel], Legend::default().with("label:", keys))
}

/// The multipliers of a branch: of every point that which leads, of every label all.
fn along(table: Option<&Table>, tables: &Tables) -> MultipliersAlong {
    let branch = &tables.branch;
    let [values, re, im] =
        [&*tables.parameter, "multiplier_re", "multiplier_im"].map(|name| column(branch, name));
    let mut leading = Vec::with_capacity(branch.len());
    for row in 0..branch.len() {
        if row > 0 && !same_leg(branch, row - 1) {
            leading.push((f64::NAN, (f64::NAN, f64::NAN)));
        }
        leading.push((values[row], (re[row], im[row])));
    }
    let rows = table
        .into_iter()
        .flat_map(|table| (0..table.len()).map(move |row| (table, row)));
    let labelled = rows.filter_map(|(table, row)| {
        let number = |column| tables::number(table, row, column);
        let value = tables.parameter_at(table.text(row, "label"))?;
        Some((value, (number("re")?, number("im")?)))
    });
    MultipliersAlong {
        leading,
        labelled: labelled.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A state with the name of a column of orbits has its extrema on the axis, and a state of equilibria itself.
    #[test]
    fn a_diagram_shows_the_first_state() {
        let source = |state: &str| -> Source {
            let text = format!(
                "(states: [\"{state}\"], parameters: {{\"p\": 1.0}}, modes: {{\"m\": (rates: {{\"{state}\": \"p\"}})}})"
            );
            ron::from_str(&text).unwrap()
        };
        let shown = |state: &str, table: &str| {
            ordinate(&source(state), &Table::parse(table.as_bytes()).unwrap())
        };
        let orbits = "period,min_period,max_period\n1,0,1\n2,0,2\n";
        assert_eq!(shown("period", orbits), "max_period");
        assert_eq!(shown("x", "x,re\n1,0\n2,1\n"), "x");
        // what stays the same is passed over
        assert_eq!(shown("x", "min_x,max_x\n1,3\n2,3\n3,3\n"), "min_x");
    }

    /// An orbit of no size beside others is a dot, in the legend, too.
    #[test]
    fn an_orbit_of_no_size_is_a_dot() {
        let orbit = |label: &str, size: f64| {
            let row =
                |angle: f64| format!("{angle},{},{},m\n", size * angle.cos(), size * angle.sin());
            let rows: String = (0..=12).map(|k| row(0.5 * f64::from(k))).collect();
            Sampled {
                label: label.to_owned(),
                value: 1.0,
                samples: Table::parse(format!("time,x,y,mode\n{rows}").as_bytes()).unwrap(),
            }
        };
        let picture = curves(&[orbit("1", 1.0), orbit("2", 1e-9)], "x", "y", "p");
        let keys: Vec<bool> = picture.legend.groups[0]
            .entries
            .iter()
            .map(|(key, _)| matches!(key, Key::Mark(_)))
            .collect();
        assert_eq!(keys, [false, true]);
        let marks = picture.panels[0].layers.iter();
        let marks =
            marks.filter(|layer| matches!(layer, Layer::Marks(points, _) if points.len() == 1));
        assert_eq!(marks.count(), 1);
    }
}
