//! Pictures of a simulation: regimes over place and time, a point in its phase plane, the contact
//! line at the beginning and at the end.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use super::axis::Axis;
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::palette::{BLUE, GREY, Pen, zone};
use super::profile::evenly;
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, usual_length};
use super::tables::Table;
use super::{Format, replace};
use crate::output::npy;
use crate::output::simulation::{END, MEASURES, PICTURES, REGIMES, SERIES, START, columns};
use crate::simulation::line::Regime;

/// Most rows of a picture of regimes.
const ROWS: usize = 220;

/// Time that the phase plane shows, at the end, in units of 1/Ω.
const ORBIT: f64 = 12.0;

/// Names of the files of the pictures.
pub fn names(format: Format) -> [String; 3] {
    PICTURES.map(|name| format!("{name}.{}", format.extension()))
}

/// Draws all pictures of a simulation from the tables of its folder and returns the files written.
/// Without a measured speed places are those of the tube; without an end there is none to draw.
///
/// # Errors
///
/// When a table cannot be read, a file cannot be written, or the format is not compiled in.
pub fn draw(folder: &Path, title: Option<&str>, format: Format) -> Result<Vec<PathBuf>, PlotError> {
    let series = Table::read(&folder.join(SERIES))?;
    let measures = Table::read_if_there(&folder.join(MEASURES))?.unwrap_or_default();
    let speed = (0..measures.len())
        .find(|row| measures.text(*row, "name") == "speed")
        .and_then(|row| measures.number(row, "value"))
        .unwrap_or(0.0);
    let start = Table::read(&folder.join(START))?;
    let end = Table::read_if_there(&folder.join(END))?;
    let pictures = [
        space_time(folder, &series, &start, title, speed)?,
        phase_plane(&series, title)?,
        profiles(&start, end.as_ref(), title)?,
    ];
    let mut written = Vec::with_capacity(pictures.len());
    for (name, svg) in names(format).into_iter().zip(pictures) {
        let path = folder.join(name);
        replace(&path, svg, format)?;
        written.push(path);
    }
    Ok(written)
}

/// A column of numbers; gaps are not numbers.
fn column(table: &Table, name: &str) -> Vec<f64> {
    (0..table.len())
        .map(|row| table.number(row, name).unwrap_or(f64::NAN))
        .collect()
}

/// Length of the line: one interval more than from the first to the last point.
fn length(line: &Table) -> f64 {
    let angles = column(line, "phi");
    let width = angles.get(1).copied().unwrap_or(TAU);
    let length = width * angles.len() as f64;
    if length.is_finite() { length } else { TAU }
}

fn space_time(
    folder: &Path,
    series: &Table,
    start: &Table,
    title: Option<&str>,
    speed: f64,
) -> Result<String, PlotError> {
    let path = folder.join(REGIMES);
    let bytes = fs::read(&path).map_err(|source| PlotError::Read {
        path: path.clone(),
        source,
    })?;
    let codes = bytes.get(npy::HEADER..).unwrap_or_default();
    let times = column(series, "time");
    let columns = columns(start.len());
    // what a kill has left of the one without the other
    let times = &times[..times
        .len()
        .min(codes.len().checked_div(columns).unwrap_or(0))];
    let angle = length(start);
    let last = times.last().copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
    let place = match speed {
        0.0 => Quantity::new("place", "φ"),
        _ => Quantity::new("place", "φ − ct"),
    };
    let x = Axis::fitted(0.0, angle, &place, usual_length());
    let y = Axis::over(0.0, last, &Quantity::new("time", "t"), 5);
    let mut legend = Legend::default();
    legend.add(
        "",
        Regime::ALL.map(|regime| (Key::Area(zone(regime.name())), regime.name().to_owned())),
    );
    let mut panel = Panel::new(x, y);
    panel.height = 420.0;
    let sheet = Sheet {
        title: title.map(str::to_owned),
        panels: vec![panel],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        let Some(frame) = frames.first().filter(|_| columns > 0) else {
            return;
        };
        canvas.area(frame.from, frame.to, zone(Regime::Slip.name()));
        let shown = evenly(times.len(), ROWS);
        for (index, &row) in shown.iter().enumerate() {
            let upper = shown.get(index + 1).map_or(last, |next| times[*next]);
            let here = &codes[row * columns..(row + 1) * columns];
            // the first column of the row, moved with the wave
            let shift = (speed * times[row] / angle).rem_euclid(1.0) * columns as f64;
            let shift = (shift.round() as usize) % columns;
            let code = |column: usize| here[(column + shift) % columns];
            let mut from = 0;
            while from < columns {
                let regime = code(from);
                let to = (from..columns)
                    .find(|column| code(*column) != regime)
                    .unwrap_or(columns);
                let name = Regime::ALL
                    .get(usize::from(regime))
                    .map_or("", |regime| regime.name());
                let ends = [from, to].map(|column| angle * column as f64 / columns as f64);
                if name != Regime::Slip.name()
                    && let (Some(low), Some(high)) = (
                        frame.place(ends[0], times[row]),
                        frame.place(ends[1], upper),
                    )
                {
                    canvas.area(low, high, zone(name));
                }
                from = to;
            }
        }
    })
}

fn phase_plane(series: &Table, title: Option<&str>) -> Result<String, PlotError> {
    let times = column(series, "time");
    let (v, rate) = (column(series, "V"), column(series, "V_dot"));
    let last = times.last().copied().unwrap_or(0.0);
    let first = times.partition_point(|time| *time < last - ORBIT);
    let (v, rate) = (&v[first..], &rate[first..]);
    let displacement = Quantity::new("tangential displacement", "V");
    let velocity = Quantity::new("velocity", "V\u{307}");
    let x = super::diagram::horizontal(v.iter().copied(), &displacement);
    let y = Axis::around(rate.iter().copied().chain([1.0]), &velocity, 5);
    let stick = Pen::dashed(GREY, 1.5);
    let mut legend = Legend::default();
    legend.add("", [(Key::Line(stick), "stick, V\u{307} = 1".to_owned())]);
    let sheet = Sheet {
        title: title.map(str::to_owned),
        panels: vec![Panel::new(x, y)],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            frame.curve(canvas, [(frame.x.low, 1.0), (frame.x.high, 1.0)], stick);
            let orbit = v.iter().copied().zip(rate.iter().copied());
            frame.curve(canvas, orbit, Pen::solid(BLUE, 1.2));
        }
    })
}

fn profiles(start: &Table, end: Option<&Table>, title: Option<&str>) -> Result<String, PlotError> {
    let angle = length(start);
    let place = Quantity::new("place", "φ");
    let panels = [
        ("V_dot", Quantity::new("velocity", "V\u{307}")),
        ("P", Quantity::new("pressure", "P")),
    ];
    let pens: Vec<(&Table, Pen, &str)> = [
        (Some(start), Pen::dashed(GREY, 1.6), "at the beginning"),
        (end, Pen::solid(BLUE, 1.6), "at the end"),
    ]
    .into_iter()
    .filter_map(|(table, pen, name)| Some((table?, pen, name)))
    .collect();
    let count = panels.len();
    let frames: Vec<Panel> = panels
        .iter()
        .enumerate()
        .map(|(index, (name, quantity))| {
            let values = pens.iter().flat_map(|(table, _, _)| column(table, name));
            let x = Axis::fitted(0.0, angle, &place, usual_length());
            let mut panel = Panel::new(x, Axis::around(values, quantity, 4));
            panel.height = 190.0;
            panel.above = if index == 0 { 0.0 } else { 14.0 };
            panel.labelled_below = index + 1 == count;
            panel
        })
        .collect();
    let mut legend = Legend::default();
    legend.add(
        "",
        (pens.iter()).map(|(_, pen, name)| (Key::Line(*pen), (*name).to_owned())),
    );
    let sheet = Sheet {
        title: title.map(str::to_owned),
        panels: frames,
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for (frame, (name, _)) in frames.iter().zip(&panels) {
            for (table, pen, _) in &pens {
                let points = column(table, "phi").into_iter().zip(column(table, name));
                frame.curve(canvas, points, *pen);
            }
        }
    })
}
