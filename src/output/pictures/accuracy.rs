//! Error against run time, both logarithmic, one line per method.

use super::names::occurring;
use crate::accuracy::RungRow;
use crate::output::render::{
    Axis, CATEGORIES, Extent, Key, Layer, Legend, Mark, MarkShape, Panel, Pen, Picture, Point,
};

/// Shapes of the methods, in the order of use.
const SHAPES: [MarkShape; 4] = [
    MarkShape::Star,
    MarkShape::Disc,
    MarkShape::Square,
    MarkShape::Up,
];

pub(super) fn picture(rows: &[RungRow]) -> Picture {
    // a branch that ended early took less time than the whole of it
    let whole = rows.iter().filter(|row| row.failure.is_none());
    let points: Vec<(&str, Point)> = whole.filter_map(point).collect();
    let (mut layers, mut entries) = (Vec::new(), Vec::new());
    let names = occurring(points.iter().map(|point| point.0));
    for (index, name) in names.into_iter().enumerate() {
        let colour = CATEGORIES[index % CATEGORIES.len()];
        let mark = Mark::new(SHAPES[index % SHAPES.len()], 6.0, colour);
        let own = points.iter().filter(|point| point.0 == name);
        let own: Vec<Point> = own.map(|point| point.1).collect();
        layers.push(Layer::Line(own.clone(), Pen::solid(colour, 1.8)));
        layers.push(Layer::Marks(own, mark));
        entries.push((Key::Mark(mark), name));
    }
    let axis = |word| Axis::new((word, ""), Extent::Decades);
    let (x, y) = (
        axis("run time in seconds"),
        axis("largest error of the branch"),
    );
    let panel = Panel::new(x, y, layers);
    let panel = panel.unless(points.is_empty(), "no method has an error to show");
    let picture = Picture::new(vec![panel], Legend::default().with("", entries));
    picture.titled(Some("Methods: error against run time"))
}

/// Name of a method, its time in seconds and its error, where both are positive.
fn point(row: &RungRow) -> Option<(&str, Point)> {
    // an error of zero has no logarithm: it is below the rounding unit
    let error = row.error()?.max(f64::EPSILON);
    let seconds = row.seconds.filter(|seconds| *seconds > 0.0)?;
    let name = match row.method.as_str() {
        "ring" => "ring (a wave)",
        "dop853" => "dop853 (single orbits)",
        other => other,
    };
    error.is_finite().then_some((name, (seconds, error)))
}
