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

/// Least distance of a name from the curve, and from the frame.
const CLEAR: f64 = 4.0;
const EDGE: f64 = 8.0;

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
        for (centre, text) in labels(frame, &line, &curve.regions) {
            let place = (centre.0, centre.1 + 0.36 * SIZE);
            canvas.text(place, &text, SIZE, Align::Middle);
        }
    })
}

/// The names that are written, each with its middle at its place: one for every stretch and side, at the
/// first of its places that has room.
pub fn labels(frame: &Frame, line: &[Place], regions: &[Region]) -> Vec<(Place, String)> {
    let mut taken: Vec<Room> = Vec::new();
    let mut named: Vec<(usize, bool)> = Vec::new();
    let mut written = Vec::new();
    for region in regions {
        let side = (region.stretch, region.left);
        if named.contains(&side) {
            continue;
        }
        let text = readable(&region.name);
        if let Some(found) = room(frame, line, &taken, region.place, &text) {
            written.push((found.centre, text));
            taken.push(found);
            named.push(side);
        }
    }
    written
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

/// Room for a text with its middle at a place of the plane, within the frame, that covers neither the
/// curve nor another text.
fn room(
    frame: &Frame,
    line: &[Place],
    taken: &[Room],
    place: [f64; 2],
    text: &str,
) -> Option<Room> {
    let room = Room {
        centre: frame.place(place[0], place[1])?,
        half: (0.5 * text_width(text, SIZE), 0.6 * SIZE),
    };
    let (centre, half) = (room.centre, room.half);
    let inside = centre.0 - half.0 - EDGE >= frame.from.0
        && centre.0 + half.0 + EDGE <= frame.to.0
        && centre.1 - half.1 - EDGE >= frame.from.1
        && centre.1 + half.1 + EDGE <= frame.to.1;
    let covers = line.iter().any(|place| room.holds(*place, CLEAR))
        || line.windows(2).any(|pair| room.holds(middle(pair), CLEAR))
        || taken.iter().any(|other| {
            let both = (half.0 + other.half.0, half.1 + other.half.1);
            (centre.0 - other.centre.0).abs() < both.0 && (centre.1 - other.centre.1).abs() < both.1
        });
    (inside && !covers).then_some(room)
}

/// The middle of a piece of the curve.
fn middle(pair: &[Place]) -> Place {
    (0.5 * (pair[0].0 + pair[1].0), 0.5 * (pair[0].1 + pair[1].1))
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
