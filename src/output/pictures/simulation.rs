//! Pictures of a simulation: regimes over place and time, the velocity of the contact line as time goes
//! on, a point in its phase plane, the contact line at the beginning and at the end.

use crate::output::render::{
    Axis, BLACK, BLUE, ColourCell, Extent, GREY, Key, Layer, Legend, Panel, Pen, Picture, Point,
    range,
};
use std::f64::consts::TAU;
use std::path::Path;

use super::colours;
use super::names::{ANGLE, LENGTH, Named, STRESS, TIME, VELOCITY, zone_keys};
use super::profile::evenly;
use super::tables::{column, needed, number, read, read_if_there};
use super::waves::{STICK, plane};
use crate::output::layout::{END, MEASURES, REGIMES, SERIES, START, snapshot_file};
use crate::output::simulation::columns;
use crate::output::store::StoreError;
use crate::output::{npy, vtk};
use crate::problem::Problem;
use crate::simulation::line::LineRegime;
use crate::simulation::task::Body;
use crate::table::Table;
use crate::tube::model::signature;

/// Most rows of a picture of regimes.
const ROWS: usize = 220;

/// Columns of a ring's snapshot, and that of V̇.
const RING_COLUMNS: usize = 7;
const RING_VELOCITY: usize = 4;

/// Height of the middle one of the curves of V̇ in distances of their base lines.
const LIFT: f64 = 1.6;

pub(super) const SHOWN: [&str; 4] = [
    "Regimes of contact over place and time",
    "Velocity V\u{307} along the contact line at the beginning and at every snapshot, one above the other",
    "One point of the contact line in the plane of V and V\u{307}",
    "Radial displacement, velocity and pressure along the contact line at the beginning and at the end",
];

/// Time that the phase plane shows, at the end, in units of 1/Ω.
const ORBIT: f64 = 12.0;

/// What is drawn of a simulation.
struct DrawnMotion {
    /// A row per sample in time.
    series: Table,
    /// Codes of the regimes, a row of places per sample.
    codes: Vec<u8>,
    /// Contact line at the beginning.
    start: Table,
    length: f64,
    /// Contact line at the end, if that was reached.
    end: Option<Table>,
    /// V̇ along the contact line at the time of each snapshot.
    snapshots: Vec<(f64, Vec<f64>)>,
    /// Speed of the wave; zero where none was measured.
    speed: f64,
    stress: &'static str,
}

/// The pictures of a simulation from the tables of its folder, in the order of their names. Without a
/// measured speed places are those of the tube.
pub(super) fn pictures(folder: &Path, problem: &Problem) -> Result<[Picture; 4], StoreError> {
    let measures = read_if_there(&folder.join(MEASURES), &["name", "value"])?.unwrap_or_default();
    let speed = (0..measures.len()).find(|row| measures.text(*row, "name") == "speed");
    let codes = needed(&folder.join(REGIMES))?;
    let line = ["phi", "U", "V_dot", "P"];
    let start = read(&folder.join(START), &line)?;
    let motion = DrawnMotion {
        series: read(&folder.join(SERIES), &["time", "V", "V_dot"])?,
        codes: codes.get(npy::HEADER..).unwrap_or_default().to_vec(),
        length: length(&start),
        start,
        end: read_if_there(&folder.join(END), &line)?,
        snapshots: snapshots(folder, problem)?,
        speed: speed
            .and_then(|row| number(&measures, row, "value"))
            .unwrap_or(0.0),
        stress: match problem.simulation.as_ref().map(|section| &section.body) {
            Some(Body::Annulus { .. }) => "E",
            _ => STRESS,
        },
    };
    Ok([
        motion.space_time(),
        motion.velocity(),
        motion.phase_plane(),
        motion.profiles(),
    ])
}

/// Times of the snapshots that are there, and V̇ along the contact line.
fn snapshots(folder: &Path, problem: &Problem) -> Result<Vec<(f64, Vec<f64>)>, StoreError> {
    let Some(section) = &problem.simulation else {
        return Ok(Vec::new());
    };
    let mut found = Vec::new();
    for number in 1..=section.snapshots {
        let path = folder.join(snapshot_file(number, &section.body));
        if !path.exists() {
            break;
        }
        let content = needed(&path)?;
        let values = match section.body {
            Body::Ring { .. } => npy::column(&content, RING_COLUMNS, RING_VELOCITY),
            Body::Annulus { around, .. } => vtk::velocity(&content, around),
        };
        let part = number as f64 / section.snapshots as f64;
        found.push((part * section.duration, values));
    }
    Ok(found)
}

/// Length of the contact line: one interval more than from the first to the last point.
fn length(line: &Table) -> f64 {
    let angles = column(line, "phi");
    let width = angles.get(1).copied().unwrap_or(TAU);
    let length = width * angles.len() as f64;
    if length.is_finite() { length } else { TAU }
}

/// A regime of a simulation among those of waves.
fn of_waves(regime: LineRegime) -> Option<signature::Regime> {
    signature::Regime::named(regime.name())
}

impl DrawnMotion {
    fn space_time(&self) -> Picture {
        let columns = columns(self.start.len());
        let times = column(&self.series, "time");
        // what a kill has left of the one without the other
        let kept = self.codes.len().checked_div(columns).unwrap_or(0);
        let times = &times[..times.len().min(kept)];
        let length = self.length;
        let last = times.last().copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
        let mut cells = Vec::new();
        let shown = evenly(times.len(), ROWS);
        for (index, &row) in shown.iter().enumerate() {
            let until = shown.get(index + 1).map_or(last, |next| times[*next]);
            let codes = self.moving(times[row], &self.codes[row * columns..(row + 1) * columns]);
            let mut from = 0;
            for stretch in codes.chunk_by(|one, other| one == other) {
                let to = from + stretch.len();
                let regime = LineRegime::ALL.get(usize::from(stretch[0]));

                let place = |column: usize| length * column as f64 / columns as f64;
                cells.push(ColourCell {
                    from: (place(from), times[row]),
                    to: (place(to), until),
                    colour: colours::of_zone(regime.and_then(|regime| of_waves(*regime))),
                });
                from = to;
            }
        }
        let x = Axis::new(self.place(), Extent::Fixed(0.0, length));
        let y = Axis::new(("time", "t", TIME), Extent::Fixed(0.0, last));
        let panel = Panel::new(x, y, vec![Layer::Cells(cells)]).high(420.0);
        let regimes = LineRegime::ALL.map(of_waves);
        Picture::new(vec![panel], Legend::default().with("", zone_keys(&regimes)))
    }

    /// V̇ of the contact line at the beginning and at the snapshots, curve above curve in the order of time,
    /// moving with the wave where its speed was measured.
    fn velocity(&self) -> Picture {
        let start = (0.0, column(&self.start, "V_dot"));
        let curves: Vec<&(f64, Vec<f64>)> = [&start].into_iter().chain(&self.snapshots).collect();
        // distance of the base lines; a simulation without snapshots has one
        let step = match self.snapshots.first() {
            Some((time, _)) => *time,
            None => 1.0,
        };
        // the median height: single spikes of an irregular motion shall not flatten the others
        let height = |curve: &&(f64, Vec<f64>)| {
            let ends = range(curve.1.iter().copied());
            ends.map_or(1.0, |(low, high)| high - low)
        };
        let mut heights: Vec<f64> = curves.iter().map(height).collect();
        heights.sort_by(f64::total_cmp);
        let scale = LIFT * step / heights[heights.len() / 2];
        let length = self.length;
        let line = |(time, values): &(f64, Vec<f64>)| {
            let (count, values) = (values.len(), self.moving(*time, values));
            let point = |(index, value): (usize, &f64)| {
                (length * index as f64 / count as f64, time + scale * value)
            };
            let points = values.iter().chain(values.first()).enumerate().map(point);
            Layer::Line(points.collect(), Pen::solid(BLACK, 1.1))
        };
        let mut layers: Vec<Layer> = curves.iter().map(|curve| line(curve)).collect();
        layers.push(Layer::Bar {
            foot: 0.0,
            head: scale,
            text: ["V\u{307}:".to_owned(), "1".to_owned()],
        });
        let x = Axis::new(self.place(), Extent::Fixed(0.0, length));
        let y = Axis::new(("velocity at time", "t", TIME), Extent::Data(0.03));
        Picture::new(
            vec![Panel::new(x, y, layers).high(420.0)],
            Legend::default(),
        )
    }

    /// Values along the contact line from the point on that moves with the wave.
    fn moving<T: Copy>(&self, time: f64, values: &[T]) -> Vec<T> {
        let count = values.len();
        let shift = (self.speed * time / self.length).rem_euclid(1.0) * count as f64;
        let mut values = values.to_vec();
        values.rotate_left((shift.round() as usize) % count.max(1));
        values
    }

    /// Place on the tube, or in the frame of the wave where that is known.
    fn place(&self) -> Named {
        let symbol = if self.speed == 0.0 { "φ" } else { "φ − ct" };
        ("place", symbol, ANGLE.2)
    }

    fn phase_plane(&self) -> Picture {
        let [times, v, rates] = ["time", "V", "V_dot"].map(|name| column(&self.series, name));
        let last = times.last().copied().unwrap_or(0.0);
        let first = times.partition_point(|time| *time < last - ORBIT);
        let orbit: Vec<Point> = v.into_iter().zip(rates).skip(first).collect();
        let layers = vec![STICK, Layer::Line(orbit, Pen::solid(BLUE, 1.2))];
        plane(layers, Legend::default())
    }

    fn profiles(&self) -> Picture {
        let start = (&self.start, Pen::dashed(GREY, 1.6), "at the beginning");
        let end = self
            .end
            .as_ref()
            .map(|end| (end, Pen::solid(BLUE, 1.6), "at the end"));
        let lines: Vec<(&Table, Pen, &str)> = [start].into_iter().chain(end).collect();
        let panel = |(name, quantity): (&str, Named)| {
            let layers = lines.iter().map(|(table, pen, _)| {
                let points = column(table, "phi").into_iter().zip(column(table, name));
                Layer::Line(points.collect(), *pen)
            });
            let x = Axis::new(("place", "φ", ANGLE.2), Extent::Fixed(0.0, self.length));
            let y = Axis::new(quantity, Extent::Data(0.05));
            Panel::new(x, y, layers.collect()).high(150.0)
        };
        let panels = [
            ("U", ("radial", "U", LENGTH)),
            ("V_dot", VELOCITY),
            ("P", ("pressure", "P", self.stress)),
        ]
        .map(panel);
        let entries = lines.iter().map(|(_, pen, name)| (Key::Line(*pen), *name));
        Picture::new(panels.to_vec(), Legend::default().with("", entries))
    }
}
