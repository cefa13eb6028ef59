//! Pictures of a motion of a system: its states over time, and the first two of them over each other.

use std::path::{Path, PathBuf};

use super::orbits::constants;
use super::tables::{column, read};
use super::{Named, PlotError, put};
use crate::output::layout::{OF_MOTION, SERIES, SWITCHES};
use crate::output::render::{
    Axis, CATEGORIES, Extent, Format, GREY, HEIGHT, Key, Layer, Legend, Mark, MarkShape, Panel,
    Pattern, Pen, Picture, Point,
};
use crate::output::store::{Store, StoreError};
use crate::problem::SystemProblem;
use crate::table::Table;

/// Most states whose time series are shown.
const MOST: usize = 5;
/// Most switches that are shown over time, and marked: more are not told apart.
const MARKED: usize = 60;
/// Part of the time, at the end, that the phase plane shows in colour; what is before is grey.
const LAST: f64 = 0.25;

const WIDTH: f64 = 1.6;
const JUMP: Pen = Pen {
    colour: GREY,
    width: 1.0,
    pattern: Pattern::Dotted,
};
const SWITCH: Mark = Mark {
    shape: MarkShape::Circle,
    size: 2.6,
    colour: GREY,
};

/// What an empty phase plane says.
const FLAT: &str = "a single state has no phase plane";

/// A stretch of a motion in one mode, from switch to switch.
struct ModeSpan {
    mode: String,
    /// Time, then the states.
    points: Vec<Vec<f64>>,
}

/// Draws the pictures of a folder.
///
/// # Errors
/// When a table cannot be read, or a file cannot be written.
pub(crate) fn draw(
    store: &Store,
    problem: &SystemProblem,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let states = &problem.system.source.states;
    let zones = zones(store.path(), states)?;
    let title = problem.title.as_deref();
    let subtitle = constants(&problem.system.source, &[]);
    let pictures = [time_series(&zones, states), phase_plane(&zones, states)];
    let pictures = pictures.map(|picture| Ok(picture.titled(title).subtitled(&subtitle)));
    let named = OF_MOTION.into_iter().zip(pictures);
    put(
        store,
        None,
        format,
        named.map(|(name, picture)| -> Named { (name.to_owned(), picture) }),
    )
}

/// The zones of a motion: samples, and the states on both sides of every switch.
fn zones(folder: &Path, states: &[String]) -> Result<Vec<ModeSpan>, StoreError> {
    let series = read(&folder.join(SERIES), &["time", "mode"])?;
    let switches = read(&folder.join(SWITCHES), &["time", "from", "to"])?;
    let numbers = |table: &Table, ending: &str| -> Vec<Vec<f64>> {
        let states = states.iter().map(|state| format!("{state}{ending}"));
        let names = std::iter::once("time".to_owned()).chain(states);
        names.map(|name| column(table, &name)).collect()
    };
    let row = |columns: &[Vec<f64>], row: usize| -> Vec<f64> {
        columns.iter().map(|column| column[row]).collect()
    };
    let samples = numbers(&series, "");
    let [before, after] = ["_before", "_after"].map(|ending| numbers(&switches, ending));
    let mut zones = vec![ModeSpan {
        mode: series.text(0, "mode").to_owned(),
        points: Vec::new(),
    }];
    let mut next = 0;
    for sample in 0..series.len() {
        while next < switches.len() && before[0][next] <= samples[0][sample] {
            if let Some(zone) = zones.last_mut() {
                zone.points.push(row(&before, next));
            }
            zones.push(ModeSpan {
                mode: switches.text(next, "to").to_owned(),
                points: vec![row(&after, next)],
            });
            next += 1;
        }
        if let Some(zone) = zones.last_mut() {
            zone.points.push(row(&samples, sample));
        }
    }
    Ok(zones)
}

/// Two columns of some zones, broken at every switch.
fn line<'a>(
    zones: impl Iterator<Item = &'a ModeSpan>,
    from: f64,
    x: usize,
    y: usize,
) -> Vec<Point> {
    let mut line = Vec::new();
    for zone in zones {
        let points = zone.points.iter().filter(|point| point[0] >= from);
        line.extend(points.map(|point| (point[x], point[y])));
        line.push((f64::NAN, f64::NAN));
    }
    line
}

/// What is drawn of two columns from a time on: a line in the colour of each mode, jumps, and marks of switches.
fn layers(zones: &[ModeSpan], modes: &[&str], from: f64, x: usize, y: usize) -> Vec<Layer> {
    let mut layers = Vec::new();
    let mut jumps = Vec::new();
    let mut marks = Vec::new();
    for pair in zones.windows(2) {
        let (Some(before), Some(after)) = (pair[0].points.last(), pair[1].points.first()) else {
            continue;
        };
        if after[0] >= from {
            marks.push((before[x], before[y]));
            if before != after {
                let ends = [before, after].map(|point| (point[x], point[y]));
                jumps.extend(ends);
                jumps.push((f64::NAN, f64::NAN));
            }
        }
    }
    layers.push(Layer::Line(jumps, JUMP));
    for (mode, colour) in modes.iter().zip(CATEGORIES.into_iter().cycle()) {
        let own = zones.iter().filter(|zone| zone.mode == *mode);
        layers.push(Layer::Line(
            line(own, from, x, y),
            Pen::solid(colour, WIDTH),
        ));
    }
    if marks.len() <= MARKED {
        layers.push(Layer::Marks(marks, SWITCH));
    }
    layers
}

/// Names of the modes in the order of their first zones.
fn modes(zones: &[ModeSpan]) -> Vec<&str> {
    let mut modes: Vec<&str> = Vec::new();
    for zone in zones {
        if !modes.contains(&zone.mode.as_str()) {
            modes.push(&zone.mode);
        }
    }
    modes
}

/// Explains what [`layers`] draws from a time on.
fn legend(zones: &[ModeSpan], modes: &[&str], from: f64, grey: bool) -> Legend {
    let keys = modes.iter().zip(CATEGORIES.into_iter().cycle());
    let keys = keys.map(|(mode, colour)| (Key::Line(Pen::solid(colour, WIDTH)), *mode));
    let late = zones
        .iter()
        .skip(1)
        .filter(|zone| zone.points[0][0] >= from);
    let shown = (1..=MARKED).contains(&late.count());
    let switches = shown.then_some((Key::Mark(SWITCH), "switch"));
    let earlier = grey.then_some((Key::Line(EARLIER), "earlier"));
    Legend::default().with("", keys.chain(switches).chain(earlier))
}

/// The motion before it is shown in colour.
const EARLIER: Pen = Pen {
    colour: plotters::style::RGBColor(215, 215, 215),
    width: 0.9,
    pattern: Pattern::Solid,
};

/// All of the time, or the end with as many switches as can be told apart.
fn time_series(zones: &[ModeSpan], states: &[String]) -> Picture {
    let zones = &zones[zones.len().saturating_sub(MARKED + 1)..];
    let modes = modes(zones);
    let shown = states.iter().take(MOST).enumerate();
    let height = HEIGHT / states.len().clamp(1, MOST) as f64;
    let panels = shown.map(|(index, state)| {
        let axis = |name: &str, room| Axis::new((name, ""), Extent::Data(room));
        let layers = layers(zones, &modes, f64::NEG_INFINITY, 0, index + 1);
        Panel::new(axis("time", 0.01), axis(state, 0.06), layers).high(height.max(0.45 * HEIGHT))
    });
    Picture::new(
        panels.collect(),
        legend(zones, &modes, f64::NEG_INFINITY, false),
    )
}

fn phase_plane(zones: &[ModeSpan], states: &[String]) -> Picture {
    let times = || {
        zones
            .iter()
            .flat_map(|zone| &zone.points)
            .map(|point| point[0])
    };
    let end = times().fold(0.0, f64::max);
    let begin = times().fold(end, f64::min);
    let from = end - LAST * (end - begin);
    let modes = modes(zones);
    let [x, y] = [0, 1].map(|index| states.get(index).map_or("", String::as_str));
    let mut drawn = Vec::new();
    if states.len() > 1 {
        drawn.push(Layer::Line(
            line(zones.iter(), f64::NEG_INFINITY, 1, 2),
            EARLIER,
        ));
        drawn.extend(layers(zones, &modes, from, 1, 2));
    }
    let axis = |name: &str| Axis::new((name, ""), Extent::Data(0.04));
    let panel = Panel::new(axis(x), axis(y), drawn).unless(states.len() < 2, FLAT);
    Picture::new(vec![panel], legend(zones, &modes, from, true))
}
