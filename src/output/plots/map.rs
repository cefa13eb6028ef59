//! The plane of a map, coloured by the signatures of its waves.

use std::collections::BTreeMap;
use std::path::Path;

use plotters::style::RGBColor;

use super::axis::Axis;
use super::canvas::Shape;
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::palette::{BLACK, CATEGORIES, GREY, WHITE, mix};
use super::quantity::{Quantity, short_signature};
use super::sheet::{HEIGHT, Panel, Sheet, remark, usual_length};
use crate::problem::{Map, MapAxis, MapPoints};

/// Signatures with a colour of their own, the most frequent ones; the rest share one.
const MOST: usize = 2 * CATEGORIES.len() - 1;

/// How much of its colour a region keeps, by the stability of its waves; unknown stability counts
/// as stable.
const UNSTABLE: f64 = 0.45;
const UNDECIDED: f64 = 0.7;

/// How far rectangles reach over their upper edge, in pixels: renderers leave a pale line between
/// areas that only touch.
const SEAM: f64 = 0.5;

/// The wave shown at a point: the first passage of its branch.
struct Point {
    row: usize,
    column: usize,
    first: f64,
    second: f64,
    start: String,
    regimes: String,
    stable: String,
}

/// Composes the picture from `map.csv`.
pub fn compose(table: &Path, map: &Map, title: Option<&str>) -> Result<String, PlotError> {
    let points = read(table, map)?;
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for point in &points {
        *counts.entry(&point.regimes).or_default() += 1;
    }
    let mut names: Vec<&str> = counts.keys().copied().collect();
    names.sort_by_key(|name| (std::cmp::Reverse(counts[name]), *name));
    let colour = |point: &Point| {
        let place = names.iter().position(|name| *name == point.regimes);
        let full = hue(place.unwrap_or(MOST));
        match point.stable.as_str() {
            "no" => mix(WHITE, full, UNSTABLE),
            "undecided" => mix(WHITE, full, UNDECIDED),
            _ => full,
        }
    };
    let mut starts: Vec<&str> = points.iter().map(|point| point.start.as_str()).collect();
    starts.sort_unstable();
    starts.dedup();
    let (rows, columns) = match map.points {
        MapPoints::Grid { rows, columns } => (rows, columns),
        MapPoints::QuasiRandom { .. } => (usize::MAX, usize::MAX),
    };
    // half a cell more on either side
    let widened = |axis: &MapAxis, count: usize| {
        let (low, high) = axis.range;
        let half = 0.5 * (high - low) / (count.max(2) - 1) as f64;
        (low - half, high + half, half)
    };
    let (left, right, half_width) = widened(&map.second, columns);
    let (bottom, top, half_height) = widened(&map.first, rows);
    let quantity = |axis: &MapAxis| Quantity::of_column(axis.parameter.column());
    let x = Axis::fitted(left, right, &quantity(&map.second), usual_length());
    let count = starts.len().max(1);
    let panels = (0..count)
        .map(|index| {
            let last = index + 1 == count;
            let mut y = quantity(&map.first);
            if count > 1 {
                y.word = format!("{}: {}", starts[index], y.word);
            }
            let mut panel = Panel::new(x.clone(), Axis::over(bottom, top, &y, 5));
            panel.height = HEIGHT / if count > 1 { 1.3 } else { 1.0 };
            panel.labelled_below = last;
            panel.above = if index > 0 { 14.0 } else { 0.0 };
            panel
        })
        .collect();
    let mut legend = Legend::default();
    legend.add(
        "",
        names
            .iter()
            .take(MOST)
            .enumerate()
            .map(|(index, name)| (Key::Area(hue(index)), short_signature(name))),
    );
    if names.len() > MOST {
        let others = names.len() - MOST;
        legend.add("", [(Key::Area(hue(MOST)), format!("{others} others"))]);
    }
    let shades: Vec<(Key, String)> = [("yes", 1.0), ("undecided", UNDECIDED), ("no", UNSTABLE)]
        .into_iter()
        .filter(|(verdict, _)| points.iter().any(|point| point.stable == *verdict))
        .map(|(verdict, share)| {
            (
                Key::Area(mix(WHITE, BLACK, 0.75 * share)),
                verdict.to_owned(),
            )
        })
        .collect();
    if !shades.is_empty() {
        legend.add("stable", shades);
    }
    let sheet = Sheet {
        title: title.map(str::to_owned),
        panels,
        legend,
        right: 0.0,
    };
    let scattered = matches!(map.points, MapPoints::QuasiRandom { .. });
    sheet.compose(|canvas, frames| {
        for (index, frame) in frames.iter().enumerate() {
            let Some(start) = starts.get(index) else {
                remark(canvas, frame, "no wave was found");
                continue;
            };
            let shown: Vec<&Point> = points
                .iter()
                .filter(|point| point.start == *start)
                .collect();
            if scattered {
                let size = (200.0 / (shown.len().max(1) as f64).sqrt()).clamp(1.0, 4.0);
                for point in shown {
                    if let Some(place) = frame.place(point.second, point.first) {
                        canvas.point(place, Shape::Disc, size, colour(point));
                    }
                }
                continue;
            }
            // neighbours of the same colour in a row make one rectangle
            let mut from = 0;
            while from < shown.len() {
                let begin = shown[from];
                let mut to = from;
                while let Some(next) = shown.get(to + 1)
                    && next.row == begin.row
                    && next.column == shown[to].column + 1
                    && colour(next) == colour(begin)
                {
                    to += 1;
                }
                let corners = (
                    frame.place(begin.second - half_width, begin.first - half_height),
                    frame.place(shown[to].second + half_width, begin.first + half_height),
                );
                if let (Some(lower), Some(upper)) = corners {
                    // over the seam to what comes next, which is drawn on top
                    canvas.area(lower, (upper.0, upper.1 - SEAM), colour(begin));
                }
                from = to + 1;
            }
        }
    })
}

/// A signature in one of its cyclic forms: where there is no stick zone, waves begin anywhere.
fn canonical(regimes: &str) -> String {
    let zones: Vec<&str> = regimes.split('-').collect();
    if zones.contains(&"stick") {
        return regimes.to_owned();
    }
    (0..zones.len())
        .map(|from| [&zones[from..], &zones[..from]].concat().join("-"))
        .max()
        .unwrap_or_default()
}

/// Colour of a signature by its rank.
fn hue(rank: usize) -> RGBColor {
    let count = CATEGORIES.len();
    match rank {
        rank if rank < count => mix(WHITE, CATEGORIES[rank], 0.9),
        // dark shades of all but black, the last one
        rank if rank < MOST => mix(BLACK, CATEGORIES[rank - count], 0.55),
        _ => GREY,
    }
}

/// First passages of `map.csv`, in its order.
fn read(path: &Path, map: &Map) -> Result<Vec<Point>, PlotError> {
    let refuse = |source| PlotError::Table {
        path: path.to_owned(),
        source,
    };
    let mut reader = csv::Reader::from_path(path).map_err(refuse)?;
    let header = reader.headers().map_err(refuse)?.clone();
    let column = |name: &str| {
        header
            .iter()
            .position(|known| known == name)
            .ok_or_else(|| PlotError::MissingColumn {
                path: path.to_owned(),
                column: name.to_owned(),
            })
    };
    let places = [
        column("row")?,
        column("column")?,
        column("passage")?,
        column(map.first.parameter.column())?,
        column(map.second.parameter.column())?,
        column("start")?,
        column("regimes")?,
        column("stable")?,
    ];
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(refuse)?;
        let text = |index: usize| record.get(places[index]).unwrap_or("");
        if text(2) != "1" {
            continue;
        }
        let number = |index: usize| text(index).parse::<f64>().unwrap_or(f64::NAN);
        points.push(Point {
            row: text(0).parse().unwrap_or(usize::MAX),
            column: text(1).parse().unwrap_or(usize::MAX - 1),
            first: number(3),
            second: number(4),
            start: text(5).to_owned(),
            regimes: canonical(text(6)),
            stable: text(7).to_owned(),
        });
    }
    Ok(points)
}
