//! Error against run time, both logarithmic, one line per method.

use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{CATEGORIES, Pen};
use crate::output::render::{Layer, Mark, Panel, Picture, Point, Shape};

/// Points of one method.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Series {
    /// Name of the method.
    pub name: String,
    /// (time in seconds, error), both positive, from coarse to fine.
    pub points: Vec<Point>,
}

/// Shapes of the methods, in the order of use.
const SHAPES: [Shape; 4] = [Shape::Star, Shape::Disc, Shape::Square, Shape::Up];

/// The picture.
pub(crate) fn picture(series: &[Series]) -> Picture {
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
