//! The curve of an event in the plane of its parameters, with the regions on either side named.

use super::axis::Axis;
use super::canvas::{Align, Canvas, Place, Shape, text_width};
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
        for (index, regions) in &curve.regions {
            name_sides(canvas, frame, curve, *index, regions);
        }
    })
}

/// Names what lies on either side of the curve at a point.
fn name_sides(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    curve: &Curve,
    index: usize,
    regions: &[Region],
) {
    let around = |index: usize| -> Option<Place> {
        let [one, other] = curve.points[index].parameters;
        frame.place(one, other)
    };
    let (Some(here), Some(before), Some(after)) = (
        around(index),
        around(index.saturating_sub(1)),
        around((index + 1).min(curve.points.len() - 1)),
    ) else {
        return;
    };
    let (dx, dy) = (after.0 - before.0, after.1 - before.1);
    let length = dx.hypot(dy);
    if length.is_nan() || length <= 0.0 {
        return;
    }
    // across the curve, towards larger values of the first parameter
    let mut across = (dy / length, -dx / length);
    if across.0 < 0.0 {
        across = (-across.0, -across.1);
    }
    for direction in [1.0, -1.0] {
        let mut texts: Vec<String> = regions
            .iter()
            .filter(|region| region.direction == direction)
            .map(|region| readable(&region.name))
            .collect();
        texts.dedup();
        if texts.is_empty() {
            continue;
        }
        let text = texts.join(", ");
        // the nearer side of the text keeps its distance from the curve
        let half = 0.5 * text_width(&text, SIZE);
        let reach = AWAY + half * across.0.abs() + 0.5 * SIZE * across.1.abs();
        let left = (frame.from.0 + 4.0 + half).min(frame.to.0 - half);
        let right = (frame.to.0 - 4.0 - half).max(left);
        let place = (
            (here.0 + direction * across.0 * reach).clamp(left, right),
            (here.1 + direction * across.1 * reach + 0.36 * SIZE)
                .clamp(frame.from.1 + SIZE, frame.to.1 - 6.0),
        );
        canvas.text(place, &text, SIZE, Align::Middle);
    }
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
