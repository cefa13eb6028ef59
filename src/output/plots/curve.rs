//! The curve of an event in the plane of its parameters, with the regions on either side named.

use super::axis::Axis;
use super::canvas::{Align, Place, Shape, text_width};
use super::error::PlotError;
use super::frame::Frame;
use super::legend::{Key, Legend};
use super::palette::{BLACK, BLUE, Pen, VERMILLION};
use super::quantity::{Quantity, event_name, short_signature};
use super::sheet::{HEIGHT, Panel, Sheet, usual_length};
use crate::curve::{Curve, Region};

/// Size of the names of regions.
const SIZE: f64 = 16.0;

/// Distance of a name from the curve.
const AWAY: f64 = 14.0;

/// Size of the marks of special points.
const MARK: f64 = 4.6;

/// Composes the picture.
pub fn compose(
    curve: &Curve,
    ranges: [(f64, f64); 2],
    title: Option<&str>,
) -> Result<String, PlotError> {
    let quantities = curve
        .parameters
        .map(|parameter| Quantity::of_column(parameter.column()));
    let x = Axis::fitted(ranges[0].0, ranges[0].1, &quantities[0], usual_length());
    let y = Axis::over(ranges[1].0, ranges[1].1, &quantities[1], 5);
    let mut panel = Panel::new(x, y);
    panel.height = HEIGHT;
    let mut name = format!("{} ({})", curve.event, event_name(curve.event));
    if let Some(sector) = curve.sector {
        name.push_str(&format!(", sector {sector}"));
    }
    let pen = Pen::solid(BLUE, 2.2);
    let mut legend = Legend::default();
    let mut keys = vec![
        (Key::Line(pen), name),
        (
            Key::Point(Shape::Disc, MARK, BLACK),
            "on the branch".to_owned(),
        ),
    ];
    let special: Vec<usize> = (0..curve.points.len())
        .filter(|index| {
            let kind = curve.points[*index].kind.as_deref();
            *index != curve.start && kind.is_some_and(|kind| !matches!(kind, "EP" | "MX"))
        })
        .collect();
    let mut names: Vec<&str> = special
        .iter()
        .filter_map(|index| curve.points[*index].kind.as_deref())
        .collect();
    names.sort_unstable();
    names.dedup();
    let shapes = [
        Shape::Diamond,
        Shape::Square,
        Shape::Up,
        Shape::Star,
        Shape::Circle,
    ];
    let shape = |name: &str| {
        let place = names.iter().position(|known| *known == name).unwrap_or(0);
        shapes[place % shapes.len()]
    };
    keys.extend(names.iter().map(|name| {
        (
            Key::Point(shape(name), MARK, VERMILLION),
            (*name).to_owned(),
        )
    }));
    legend.add("", keys);
    let sheet = Sheet {
        title: title.map(str::to_owned),
        panels: vec![panel],
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        let Some(frame) = frames.first() else {
            return;
        };
        let plane = |index: usize| {
            let [one, other] = curve.points[index].parameters;
            (one, other)
        };
        frame.curve(canvas, (0..curve.points.len()).map(plane), pen);
        for index in special {
            let (one, other) = plane(index);
            let kind = curve.points[index].kind.as_deref().unwrap_or_default();
            if let Some(place) = frame.place(one, other) {
                canvas.point(place, shape(kind), MARK, VERMILLION);
            }
        }
        let (one, other) = plane(curve.start);
        if let Some(place) = frame.place(one, other) {
            canvas.point(place, Shape::Disc, MARK, BLACK);
        }
        let line: Vec<Place> = (0..curve.points.len())
            .filter_map(|index| {
                let (one, other) = plane(index);
                frame.place(one, other)
            })
            .collect();
        if line.len() != curve.points.len() {
            return;
        }
        let mut taken = Vec::new();
        for (index, regions) in &curve.regions {
            for (direction, text) in sides(regions) {
                let stretch = stretch(curve, *index);
                if let Some(found) = room(frame, &line, &taken, &stretch, direction, &text) {
                    let place = (found.centre.0, found.centre.1 + 0.36 * SIZE);
                    canvas.text(place, &text, SIZE, Align::Middle);
                    taken.push(found);
                }
            }
        }
    })
}

/// Names on either side of the curve.
fn sides(regions: &[Region]) -> Vec<(f64, String)> {
    [-1.0, 1.0]
        .into_iter()
        .filter_map(|direction| {
            let mut texts: Vec<String> = regions
                .iter()
                .filter(|region| region.direction == direction)
                .map(|region| readable(&region.name))
                .collect();
            texts.dedup();
            (!texts.is_empty()).then(|| (direction, texts.join(", ")))
        })
        .collect()
}

/// Points with the same waves around one, the nearest first.
fn stretch(curve: &Curve, index: usize) -> Vec<usize> {
    let same = |other: &usize| curve.points[*other].before == curve.points[index].before;
    let mut found: Vec<usize> = (index..curve.points.len()).take_while(same).collect();
    found.extend((0..index).rev().take_while(same));
    found.sort_by_key(|other| other.abs_diff(index));
    found
}

/// The place of a text.
struct Room {
    centre: Place,
    half: Place,
}

impl Room {
    /// Whether a place lies within, or nearer than a margin.
    fn holds(&self, place: Place, margin: f64) -> bool {
        (place.0 - self.centre.0).abs() < self.half.0 + margin
            && (place.1 - self.centre.1).abs() < self.half.1 + margin
    }
}

/// Room for a text beside a stretch of the curve, on the side of larger (1) or smaller (−1) values of
/// the first parameter, that covers neither the curve nor another text.
fn room(
    frame: &Frame,
    line: &[Place],
    taken: &[Room],
    stretch: &[usize],
    direction: f64,
    text: &str,
) -> Option<Room> {
    let half = (0.5 * text_width(text, SIZE), 0.6 * SIZE);
    stretch.iter().find_map(|&index| {
        let (before, after) = (
            line[index.saturating_sub(1)],
            line[(index + 1).min(line.len() - 1)],
        );
        let (dx, dy) = (after.0 - before.0, after.1 - before.1);
        let length = dx.hypot(dy);
        if length.is_nan() || length <= 0.0 {
            return None;
        }
        // across the curve, towards larger values of the first parameter
        let sign = direction * if dy < 0.0 { -1.0 } else { 1.0 };
        let across = (sign * dy / length, -sign * dx / length);
        // the nearer side of the text keeps its distance from the curve
        let reach = AWAY + half.0 * across.0.abs() + half.1 * across.1.abs();
        let within = |value: f64, low: f64, high: f64| value.clamp(low, high.max(low));
        let room = Room {
            centre: (
                within(
                    line[index].0 + across.0 * reach,
                    frame.from.0 + half.0 + 8.0,
                    frame.to.0 - half.0 - 8.0,
                ),
                within(
                    line[index].1 + across.1 * reach,
                    frame.from.1 + half.1 + 8.0,
                    frame.to.1 - half.1 - 8.0,
                ),
            ),
            half,
        };
        let covers = line.iter().any(|place| room.holds(*place, 4.0))
            || taken.iter().any(|other| {
                let both = (half.0 + other.half.0, half.1 + other.half.1);
                (room.centre.0 - other.centre.0).abs() < both.0
                    && (room.centre.1 - other.centre.1).abs() < both.1
            });
        (!covers).then_some(room)
    })
}

/// A region's name with its signature shortened, if it has one.
fn readable(name: &str) -> String {
    name.split(' ')
        .map(|word| match word.contains('-') {
            true => short_signature(word),
            false => word.to_owned(),
        })
        .collect::<Vec<_>>()
        .join(" ")
}
