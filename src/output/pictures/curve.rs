//! The curve of an event in the plane of its parameters, with the regions on either side named.

use super::names::{event, occurring, quantity, short_signature};
use crate::curve::{self, Curve, Region};
use crate::output::render::{
    Axis, BLACK, BLUE, Extent, Key, Layer, Legend, Mark, Name, Panel, Pen, Picture, Point, Shape,
    VERMILLION,
};

/// Size of the marks of special points.
const MARK: f64 = 4.6;

/// Shapes of the special points, in the order of their names.
const SHAPES: [Shape; 5] = [
    Shape::Diamond,
    Shape::Square,
    Shape::Up,
    Shape::Star,
    Shape::Circle,
];

/// The picture of a curve over these ranges of its parameters.
pub(crate) fn picture(curve: &Curve, ranges: [(f64, f64); 2]) -> Picture {
    let [x, y] = [0, 1].map(|index: usize| {
        let quantity = quantity(curve.parameters[index].column());
        Axis::new(quantity, Extent::Fixed(ranges[index].0, ranges[index].1))
    });
    let plane = |point: &curve::Point| (point.parameters[0], point.parameters[1]);
    let line: Vec<Point> = curve.points.iter().map(plane).collect();
    let start = line.get(curve.start).copied().into_iter().collect();
    let special = curve
        .points
        .iter()
        .enumerate()
        .filter_map(|(index, point)| {
            let kind = point.kind.as_deref()?;
            let shown = index != curve.start && !matches!(kind, "EP" | "MX");
            shown.then_some((plane(point), kind))
        });
    let special: Vec<(Point, &str)> = special.collect();
    let mut kinds = occurring(special.iter().map(|one| one.1));
    kinds.sort_unstable();
    let mark = |kind: &str| {
        let rank = kinds.iter().position(|known| *known == kind).unwrap_or(0);
        Mark::new(SHAPES[rank % SHAPES.len()], MARK, VERMILLION)
    };

    let same = common_signature(&curve.regions);
    let (pen, on_branch) = (Pen::solid(BLUE, 2.2), Mark::new(Shape::Disc, MARK, BLACK));
    let mut layers = vec![Layer::Line(line, pen)];
    let marked = special.iter();
    layers.extend(marked.map(|(point, kind)| Layer::Marks(vec![*point], mark(kind))));
    layers.push(Layer::Marks(start, on_branch));
    let names = curve.regions.iter().map(|region| name(region, same));
    layers.push(Layer::Names(names.collect()));

    let mut what = format!("{} ({})", curve.event, event(curve.event));
    if let Some(sector) = curve.sector {
        what.push_str(&format!(", sector {sector}"));
    }
    if let Some(signature) = same {
        what.push_str(&format!(" of waves {}", short_signature(signature)));
    }
    let entries = [
        (Key::Line(pen), what),
        (Key::Mark(on_branch), "on the branch".to_owned()),
    ];
    let kinds = kinds
        .iter()
        .map(|kind| (Key::Mark(mark(kind)), (*kind).to_owned()));
    let legend = Legend::default().with("", entries.into_iter().chain(kinds));
    Picture::new(vec![Panel::new(x, y, layers)], legend)
}

/// The signature that all counts of waves have in common: said once, it leaves room for the counts.
fn common_signature(regions: &[Region]) -> Option<&str> {
    let mut signatures = regions
        .iter()
        .map(|region| Some(region.name.split_once(' ')?.1.split_once(' ')?.1));
    let first = signatures.next()??;
    let counts = regions[0]
        .name
        .starts_with(|first: char| first.is_ascii_digit());
    (counts && !first.contains(' ') && signatures.all(|one| one == Some(first))).then_some(first)
}

/// The name of a region, its signature shortened, or left out where it is the same everywhere; one for
/// every stretch and side.
fn name(region: &Region, same: Option<&str>) -> Name {
    let shortened = |word: &str| match word.contains('-') {
        true => short_signature(word),
        false => word.to_owned(),
    };
    let words = region.name.split(' ').filter(|word| Some(*word) != same);
    let words: Vec<String> = words.map(shortened).collect();
    Name {
        group: 2 * region.stretch + usize::from(region.left),
        at: (region.place[0], region.place[1]),
        text: words.join(" "),
    }
}
