//! Pictures of a simulation: regimes over place and time, a point in its phase plane, the contact
//! line at the beginning and at the end.

use std::f64::consts::TAU;
use std::path::Path;

use super::error::PlotError;
use super::names::{velocity, zone_colour, zone_keys};
use super::phase_plane::{explained, plane, stick};
use super::profile::evenly;
use super::tables::{column, number, read, read_if_there};
use crate::output::npy;
use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{BLUE, GREY, Pen};
use crate::output::render::{Cell, Layer, Panel, Picture, Point};
use crate::output::simulation::{END, MEASURES, REGIMES, SERIES, START, columns};
use crate::output::store::bytes;
use crate::simulation::line::Regime;
use crate::table::Table;

/// Most rows of a picture of regimes.
const ROWS: usize = 220;

/// Time that the phase plane shows, at the end, in units of 1/Ω.
const ORBIT: f64 = 12.0;

/// What is drawn of a simulation.
struct Motion {
    /// A row per sample in time.
    series: Table,
    /// Codes of the regimes, a row of places per sample.
    codes: Vec<u8>,
    /// Contact line at the beginning.
    start: Table,
    /// Contact line at the end, if that was reached.
    end: Option<Table>,
    /// Speed of the wave; zero where none was measured.
    speed: f64,
}

/// The pictures of a simulation from the tables of its folder, in the order of their names. Without a
/// measured speed places are those of the tube.
pub(super) fn pictures(folder: &Path) -> Result<[Picture; 3], PlotError> {
    let measures = read_if_there(&folder.join(MEASURES), &["name", "value"])?.unwrap_or_default();
    let speed = (0..measures.len()).find(|row| measures.text(*row, "name") == "speed");
    let codes = bytes(&folder.join(REGIMES)).map_err(PlotError::Read)?;
    let line = ["phi", "V_dot", "P"];
    let motion = Motion {
        series: read(&folder.join(SERIES), &["time", "V", "V_dot"])?,
        codes: codes.get(npy::HEADER..).unwrap_or_default().to_vec(),
        start: read(&folder.join(START), &line)?,
        end: read_if_there(&folder.join(END), &line)?,
        speed: speed
            .and_then(|row| number(&measures, row, "value"))
            .unwrap_or(0.0),
    };
    Ok([motion.space_time(), motion.phase_plane(), motion.profiles()])
}

impl Motion {
    /// Length of the line: one interval more than from the first to the last point.
    fn length(&self) -> f64 {
        let angles = column(&self.start, "phi");
        let width = angles.get(1).copied().unwrap_or(TAU);
        let length = width * angles.len() as f64;
        if length.is_finite() { length } else { TAU }
    }

    fn space_time(&self) -> Picture {
        let columns = columns(self.start.len());
        let times = column(&self.series, "time");
        // what a kill has left of the one without the other
        let kept = self.codes.len().checked_div(columns).unwrap_or(0);
        let times = &times[..times.len().min(kept)];
        let length = self.length();
        let last = times.last().copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
        let mut cells = Vec::new();
        let shown = evenly(times.len(), ROWS);
        for (index, &row) in shown.iter().enumerate() {
            let until = shown.get(index + 1).map_or(last, |next| times[*next]);
            let mut codes = self.codes[row * columns..(row + 1) * columns].to_vec();
            // the first column of the row, moved with the wave
            let shift = (self.speed * times[row] / length).rem_euclid(1.0) * columns as f64;
            codes.rotate_left((shift.round() as usize) % columns.max(1));
            let mut from = 0;
            for stretch in codes.chunk_by(|one, other| one == other) {
                let to = from + stretch.len();
                let regime = Regime::ALL.get(usize::from(stretch[0]));
                let name = regime.map_or("", |regime| regime.name());
                let place = |column: usize| length * column as f64 / columns as f64;
                cells.push(Cell {
                    from: (place(from), times[row]),
                    to: (place(to), until),
                    colour: zone_colour(name),
                });
                from = to;
            }
        }
        let place = if self.speed == 0.0 { "φ" } else { "φ − ct" };
        let x = Axis::new(Quantity::new("place", place), Extent::Fixed(0.0, length));
        let y = Axis::new(Quantity::new("time", "t"), Extent::Fixed(0.0, last));
        let panel = Panel::new(x, y, vec![Layer::Cells(cells)]).high(420.0);
        let names = Regime::ALL.map(|regime| regime.name());
        Picture::new(vec![panel], Legend::default().with("", zone_keys(&names)))
    }

    fn phase_plane(&self) -> Picture {
        let [times, v, rates] = ["time", "V", "V_dot"].map(|name| column(&self.series, name));
        let last = times.last().copied().unwrap_or(0.0);
        let first = times.partition_point(|time| *time < last - ORBIT);
        let orbit: Vec<Point> = v.into_iter().zip(rates).skip(first).collect();
        let layers = vec![stick(), Layer::Line(orbit, Pen::solid(BLUE, 1.2))];
        plane(layers, explained(Legend::default()))
    }

    fn profiles(&self) -> Picture {
        let start = (&self.start, Pen::dashed(GREY, 1.6), "at the beginning");
        let end = self
            .end
            .as_ref()
            .map(|end| (end, Pen::solid(BLUE, 1.6), "at the end"));
        let lines: Vec<(&Table, Pen, &str)> = [start].into_iter().chain(end).collect();
        let panel = |(name, quantity): (&str, Quantity)| {
            let layers = lines.iter().map(|(table, pen, _)| {
                let points = column(table, "phi").into_iter().zip(column(table, name));
                Layer::Line(points.collect(), *pen)
            });
            let x = Axis::new(
                Quantity::new("place", "φ"),
                Extent::Fixed(0.0, self.length()),
            );
            let y = Axis::new(quantity, Extent::Data(0.05));
            Panel::new(x, y, layers.collect()).high(190.0)
        };
        let panels = [("V_dot", velocity()), ("P", Quantity::new("pressure", "P"))].map(panel);
        let entries = lines.iter().map(|(_, pen, name)| (Key::Line(*pen), *name));
        Picture::new(panels.to_vec(), Legend::default().with("", entries))
    }
}
