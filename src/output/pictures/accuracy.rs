//! Error against run time, both logarithmic, one line per method.

use crate::accuracy::Row;
use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{CATEGORIES, Pen};
use crate::output::render::{Layer, Mark, Panel, Picture, Point, Shape};

/// Points of one method.
#[derive(Clone, Debug, Default, PartialEq)]
struct Series {
    /// Name of the method.
    name: String,
    /// (time in seconds, error), both positive, from coarse to fine.
    points: Vec<Point>,
}

/// Shapes of the methods, in the order of use.
const SHAPES: [Shape; 4] = [Shape::Star, Shape::Disc, Shape::Square, Shape::Up];

/// The picture.
pub(super) fn picture(rows: &[Row]) -> Picture {
    let series = series(rows);
    let mark = |index: usize| {
        let colour = CATEGORIES[index % CATEGORIES.len()];
        Mark::new(SHAPES[index % SHAPES.len()], 6.0, colour)
    };
    let mut layers = Vec::new();
    for (index, one) in series.iter().enumerate() {
        let (mark, points) = (mark(index), &one.points);
        layers.push(Layer::Line(points.clone(), Pen::solid(mark.colour, 1.8)));
        layers.push(Layer::Marks(points.clone(), mark));
    }
    if series.iter().all(|one| one.points.is_empty()) {
        layers = Layer::remark("no method has an error to show");
    }
    let names = series.iter().enumerate();
    let entries = names.map(|(index, one)| (Key::Mark(mark(index)), one.name.as_str()));
    let axis = |word| Axis::new(Quantity::new(word, ""), Extent::Decades);
    let panel = Panel::new(
        axis("run time in seconds"),
        axis("largest error of the branch"),
        layers,
    );
    Picture::new(vec![panel], Legend::default().with("", entries))
}

/// What the picture shows: methods with an error and a time.
fn series(rows: &[Row]) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    // a branch that ended early took less time than the whole of it
    for row in rows.iter().filter(|row| row.failure.is_none()) {
        // an error of zero has no logarithm: it is below the rounding unit
        let Some(error) = row.error().map(|error| error.max(f64::EPSILON)) else {
            continue;
        };
        let Some(seconds) = row
            .seconds
            .filter(|seconds| *seconds > 0.0 && error.is_finite())
        else {
            continue;
        };
        let name = match row.method.as_str() {
            "ring" => "ring (a wave)",
            other => other,
        };
        let point = (seconds, error);
        match all.iter_mut().find(|one| one.name == name) {
            Some(one) => one.points.push(point),
            None => all.push(Series {
                name: name.into(),
                points: vec![point],
            }),
        }
    }
    all
}
