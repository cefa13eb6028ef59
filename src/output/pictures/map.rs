//! The plane of a map, coloured by the signatures of its waves, in the colours of all pictures; white where no
//! branch comes to a point, hatched where the search for one was cut short.

use crate::output::render::{
    Axis, BLACK, Cell, Extent, GREY, HEIGHT, Key, Layer, Legend, Mark, Panel, Pen, Picture, Point,
    Shape, WHITE, mix,
};
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use plotters::style::RGBColor;

use super::names::{quantity, short_signature, signature_colour};
use crate::map::NOT_REACHED;
use crate::output::layout::MAP;
use crate::output::store::{StoreError, resumable, unfinished};
use crate::problem::{Map, MapAxis, MapPoints};

/// How much of its colour a region keeps, by the stability of its waves; unknown stability counts
/// as stable.
const SHADES: [(&str, f64); 3] = [("yes", 1.0), ("undecided", 0.7), ("no", 0.45)];

/// The wave shown at a point: the first passage of its branch.
struct Wave {
    row: usize,
    column: usize,
    at: Point,
    start: String,
    regimes: String,
    stable: String,
}

/// A point without a wave of a start.
struct Blank {
    row: usize,
    column: usize,
    at: Point,
    start: String,
    /// Whether a search was cut short.
    cut: bool,
}

/// The picture of the table in a map's folder.
///
/// # Errors
/// When the table cannot be read.
pub(crate) fn picture(folder: &Path, map: &Map) -> Result<Picture, StoreError> {
    let path = folder.join(MAP);
    if !path.exists() {
        return Err(unfinished(folder, "map", "its rows are not joined yet"));
    }
    let (waves, blanks) = read(&path, map)?;
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for wave in &waves {
        *counts.entry(&wave.regimes).or_default() += 1;
    }
    let mut names: Vec<&str> = counts.keys().copied().collect();
    names.sort_by_key(|name| std::cmp::Reverse(counts[name]));
    let colour = |wave: &Wave| {
        let shade = SHADES.iter().find(|shade| shade.0 == wave.stable);
        let share = shade.map_or(1.0, |shade| shade.1);
        mix(WHITE, signature_colour(&wave.regimes), share)
    };
    let mut starts: Vec<&str> = waves.iter().map(|wave| wave.start.as_str()).collect();
    starts.sort_unstable();
    starts.dedup();
    // half a cell more on either side
    let half = |axis: &MapAxis, count: usize| {
        0.5 * (axis.range.1 - axis.range.0) / (count.max(2) - 1) as f64
    };
    let (half_width, half_height) = match map.points {
        MapPoints::Grid { rows, columns } => (half(&map.second, columns), half(&map.first, rows)),
        MapPoints::QuasiRandom { .. } => (0.0, 0.0),
    };
    let axis = |axis: &MapAxis, half: f64, prefix: &str| {
        let mut quantity = quantity(axis.parameter.column());
        quantity.word.insert_str(0, prefix);
        Axis::new(
            quantity,
            Extent::Fixed(axis.range.0 - half, axis.range.1 + half),
        )
    };
    let panel = |layers, prefix: &str, height| {
        let x = axis(&map.second, half_width, "");
        Panel::new(x, axis(&map.first, half_height, prefix), layers).high(height)
    };
    let panels = starts.iter().map(|start| {
        let shown: Vec<&Wave> = waves.iter().filter(|wave| wave.start == *start).collect();
        let cut = blanks.iter().filter(|one| one.cut && one.start == *start);
        let layers = match map.points {
            MapPoints::QuasiRandom { .. } => {
                let mut layers = scattered(&shown, colour);
                let cut = cut.map(|blank| blank.at).collect();
                layers.push(Layer::Marks(cut, Mark::new(Shape::Cross, 3.0, GREY)));
                layers
            }
            MapPoints::Grid { rows, columns } => {
                let mut layers = vec![cells(&shown, (half_width, half_height), colour)];
                let cut = cut.map(|blank| (blank.row, blank.column)).collect();
                let low = |axis: &MapAxis, half: f64| axis.range.0 - half;
                let corner = (low(&map.second, half_width), low(&map.first, half_height));
                let cell = (2.0 * half_width, 2.0 * half_height);
                layers.extend(hatched(&cut, (rows, columns), corner, cell));
                layers
            }
        };
        match starts.len() {
            1 => panel(layers, "", HEIGHT),
            _ => panel(layers, &format!("{start}: "), HEIGHT / 1.3),
        }
    });
    let mut panels: Vec<Panel> = panels.collect();
    if panels.is_empty() {
        panels.push(panel(Vec::new(), "", HEIGHT).unless(true, "no wave was found"));
    }

    let shades = SHADES
        .into_iter()
        .filter(|(verdict, _)| waves.iter().any(|wave| wave.stable == *verdict))
        .map(|(verdict, share)| (Key::Area(mix(WHITE, BLACK, 0.75 * share)), verdict));
    let coloured = names
        .iter()
        .map(|name| (Key::Area(signature_colour(name)), short_signature(name)));
    let blank = |cut: bool| {
        let of_panel = |one: &&Blank| one.cut == cut && starts.contains(&one.start.as_str());
        blanks.iter().find(of_panel)
    };
    let cut = match map.points {
        MapPoints::QuasiRandom { .. } => Key::Mark(Mark::new(Shape::Cross, 3.0, GREY)),
        MapPoints::Grid { .. } => Key::Hatched(hatching()),
    };
    let none = blank(false).map(|_| (Key::Area(WHITE), "no branch comes here".to_owned()));
    let cut = blank(true).map(|_| (cut, "not reached: a branch fails before".to_owned()));
    let mut legend = Legend::default().with("", coloured.chain(none).chain(cut));
    if waves.iter().any(|wave| !wave.stable.is_empty()) {
        legend = legend.with("stable", shades);
    }
    Ok(Picture::new(panels, legend))
}

fn scattered(waves: &[&Wave], colour: impl Fn(&Wave) -> RGBColor) -> Vec<Layer> {
    let size = (200.0 / (waves.len().max(1) as f64).sqrt()).clamp(1.0, 4.0);
    let layer =
        |wave: &&Wave| Layer::Marks(vec![wave.at], Mark::new(Shape::Disc, size, colour(wave)));
    waves.iter().map(layer).collect()
}

/// Rectangles around the points; neighbours of the same colour in a row make one.
fn cells(waves: &[&Wave], half: Point, colour: impl Fn(&Wave) -> RGBColor) -> Layer {
    let rows = waves.chunk_by(|one, next| {
        one.row == next.row && one.column + 1 == next.column && colour(one) == colour(next)
    });
    let cell = |stretch: &[&Wave]| {
        let (first, last) = (stretch[0], stretch[stretch.len() - 1]);
        Cell {
            from: (first.at.0 - half.0, first.at.1 - half.1),
            to: (last.at.0 + half.0, last.at.1 + half.1),
            colour: colour(first),
        }
    };
    Layer::Cells(rows.map(cell).collect())
}

/// Lines of the hatching across the panel, how far each leans, as a part of the width, and parts of the
/// height in which they are looked at: less than a pixel.
const HATCHES: usize = 60;
const LEANS: f64 = 0.5;
const PARTS: usize = 600;

fn hatching() -> Pen {
    Pen::solid(GREY, 0.8)
}

/// Leaning lines over these cells of a grid, whose lower left corner and size of a cell are given.
fn hatched(
    cut: &HashSet<(usize, usize)>,
    (rows, columns): (usize, usize),
    corner: Point,
    cell: Point,
) -> Vec<Layer> {
    if cut.is_empty() {
        return Vec::new();
    }
    let mut layers = Vec::new();
    for number in 0..HATCHES {
        let foot = (1.0 + LEANS) * (number as f64 + 0.5) / HATCHES as f64 - LEANS;
        let place = |part: usize| {
            let up = (part as f64 + 0.5) / PARTS as f64;
            (foot + LEANS * up, up)
        };
        let inside = |part: usize| {
            let (across, up) = place(part);
            let number = |share: f64, count: usize| (share * count as f64) as usize;
            (0.0..1.0).contains(&across)
                && cut.contains(&(number(up, rows), number(across, columns)))
        };
        let parts: Vec<usize> = (0..PARTS).collect();
        for run in parts.chunk_by(|one, next| inside(*one) == inside(*next)) {
            let (first, last) = (run[0], run[run.len() - 1]);
            if inside(first) {
                let ends = [first, last].map(|part| {
                    let (across, up) = place(part);
                    (
                        corner.0 + across * columns as f64 * cell.0,
                        corner.1 + up * rows as f64 * cell.1,
                    )
                });
                layers.push(Layer::Line(ends.to_vec(), hatching()));
            }
        }
    }
    layers
}

/// First passages of the table and points without a wave, in its order, row by row: maps may be long.
fn read(path: &Path, map: &Map) -> Result<(Vec<Wave>, Vec<Blank>), StoreError> {
    let fault = |error: csv::Error| resumable(path, error.to_string());
    let mut reader = csv::Reader::from_path(path).map_err(fault)?;
    let header = reader.headers().map_err(fault)?.clone();
    let place = |column: &str| {
        let place = header.iter().position(|name| name == column);
        place.ok_or_else(|| resumable(path, format!("it has no column `{column}`")))
    };
    let (x, y) = (map.second.parameter.column(), map.first.parameter.column());
    let [row, column, passage] = [place("row")?, place("column")?, place("passage")?];
    let [x, y] = [place(x)?, place(y)?];
    let [start, regimes, stable] = [place("start")?, place("regimes")?, place("stable")?];
    // tables of earlier versions do not tell
    let found = place("found").ok();
    let (mut waves, mut blanks) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(fault)?;
        let cell = |place: usize| record.get(place).unwrap_or("");
        let value = |place: usize| cell(place).parse::<f64>().unwrap_or(f64::NAN);
        let count = |place: usize| cell(place).parse().unwrap_or(usize::MAX - 1);
        let (row, column) = (count(row), count(column));
        let (at, start) = ((value(x), value(y)), cell(start).to_owned());
        if cell(passage) == "0" {
            blanks.push(Blank {
                row,
                column,
                at,
                start,
                cut: found.is_some_and(|found| cell(found) == NOT_REACHED),
            });
        } else if cell(passage) == "1" {
            waves.push(Wave {
                row,
                column,
                at,
                start,
                regimes: cell(regimes).to_owned(),
                stable: cell(stable).to_owned(),
            });
        }
    }
    Ok((waves, blanks))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Start;
    use crate::tube::model::Parameter::{Friction, Mismatch};

    /// White has a legend entry, and only cells that were not reached are hatched.
    #[test]
    fn cells_without_a_wave_are_white_or_hatched() {
        let folder = tempfile::tempdir().unwrap();
        let axis = |parameter| MapAxis {
            parameter,
            range: (0.1, 0.2),
        };
        let map = Map {
            first: axis(Friction),
            second: axis(Mismatch),
            points: MapPoints::Grid {
                rows: 2,
                columns: 2,
            },
            starts: vec![Start::Fast],
        };
        let table = "row,column,start,passage,found,regimes,mismatch,friction,stable\n\
            0,0,fast,1,wave,slip-stick,0.1,0.1,\n\
            0,1,fast,0,none,,0.2,0.1,\n\
            1,0,fast,0,not reached,,0.1,0.2,\n\
            1,1,fast,1,wave,slip-stick,0.2,0.2,\n";
        std::fs::write(folder.path().join(MAP), table).unwrap();
        let picture = picture(folder.path(), &map).unwrap();
        let entries = picture
            .legend
            .groups
            .iter()
            .flat_map(|group| &group.entries);
        let words: Vec<&str> = entries.map(|(_, word)| word.as_str()).collect();
        assert_eq!(
            words,
            [
                "sl-st",
                "no branch comes here",
                "not reached: a branch fails before"
            ]
        );
        let lines = picture.panels[0]
            .layers
            .iter()
            .filter_map(|layer| match layer {
                Layer::Line(points, _) => Some(points),
                _ => None,
            });
        let points: Vec<&Point> = lines.flatten().collect();
        assert!(points.len() >= 20);
        assert!(points.iter().all(|(x, y)| *x < 0.15 && *y > 0.15));
    }
}
