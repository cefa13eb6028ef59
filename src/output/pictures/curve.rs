//! The curve of an event in the plane of its parameters, with the regions on either side named.

use super::names::{constant_parameters, event, quantity, short_signature};
use crate::curve::{self, Curve, Plane, PointType, Region};
use crate::orbit::{EventType, Orbit};
use crate::output::render::{
    Axis, BLACK, BLUE, Extent, Key, Layer, Legend, Mark, Name, Panel, Pen, Picture, Point,
    Quantity, Shape, VERMILLION,
};
use crate::problem::Problem;

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

/// The picture of a curve of waves over these ranges of its parameters, with those that stay as they are.
pub(crate) fn of_waves(
    curve: &Curve,
    ranges: [(f64, f64); 2],
    problem: Option<&Problem>,
) -> Picture {
    let drawn = picture(curve, ranges, quantity);
    match problem {
        Some(problem) => drawn.subtitled(&constant_parameters(problem, &curve.parameters)),
        None => drawn,
    }
}

/// The picture of a curve over these ranges of its parameters.
pub(super) fn picture<P: Plane>(
    curve: &Curve<P>,
    ranges: [(f64, f64); 2],
    quantity: fn(&str) -> Quantity,
) -> Picture {
    let [x, y] = [0, 1].map(|index: usize| {
        let quantity = quantity(P::Orbit::column(&curve.parameters[index]));
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
            let kind = point.kind?;
            let ends = [EventType::EP, EventType::MX].map(PointType::One);
            let shown = index != curve.start && !ends.contains(&kind);
            shown.then_some((plane(point), kind))
        });
    let special: Vec<(Point, PointType)> = special.collect();
    let mut kinds: Vec<PointType> = Vec::new();
    for (_, kind) in &special {
        if !kinds.contains(kind) {
            kinds.push(*kind);
        }
    }
    kinds.sort_by_key(PointType::to_string);
    let mark = |kind: PointType| {
        let rank = kinds.iter().position(|known| *known == kind).unwrap_or(0);
        Mark::new(SHAPES[rank % SHAPES.len()], MARK, VERMILLION)
    };

    let same = common_signature(&curve.regions);
    let (pen, on_branch) = (Pen::solid(BLUE, 2.2), Mark::new(Shape::Disc, MARK, BLACK));
    let mut layers = vec![Layer::Line(line, pen)];
    let marked = special.iter();
    layers.extend(marked.map(|(point, kind)| Layer::Marks(vec![*point], mark(*kind))));
    layers.push(Layer::Marks(start, on_branch));
    let names = curve.regions.iter().map(|region| name(region, same));
    layers.push(Layer::Names(names.collect()));

    let mut what = format!("{} ({})", curve.event, event(curve.event));
    if let Some(sector) = curve.sector {
        what.push_str(&format!(", sector {sector}"));
    }
    if let Some(signature) = same {
        what.push_str(&format!(" of {} {}", short_signature(signature), P::ORBITS));
    }
    let entries = [
        (Key::Line(pen), what),
        (Key::Mark(on_branch), "on the branch".to_owned()),
    ];
    let kinds = kinds
        .iter()
        .map(|kind| (Key::Mark(mark(*kind)), kind.to_string()));
    let legend = Legend::default().with("", entries.into_iter().chain(kinds));
    Picture::new(vec![Panel::new(x, y, layers)], legend)
}

/// The regimes that all counts of orbits have in common: said once, they leave room for the counts.
fn common_signature(regions: &[Region]) -> Option<&str> {
    let mut signatures = regions.iter().map(|region| match &region.name {
        curve::Name::Orbits {
            count: Some(_),
            regimes,
        } => match &regimes[..] {
            [one] => Some(one.as_str()),
            _ => None,
        },
        _ => None,
    });
    let first = signatures.next()??;
    signatures.all(|one| one == Some(first)).then_some(first)
}

/// The name of a region, its signatures shortened, or left out where they are the same everywhere; one for
/// every stretch and side.
fn name(region: &Region, same: Option<&str>) -> Name {
    let text = match &region.name {
        curve::Name::Orbits { count, regimes } => {
            let others = regimes.iter().filter(|one| Some(one.as_str()) != same);
            let short = others.map(|one| short_signature(one)).collect();
            let name = curve::Name::Orbits {
                count: *count,
                regimes: short,
            };
            name.to_string().trim_end().to_owned()
        }
        other => other.to_string(),
    };
    Name {
        group: 2 * region.stretch + usize::from(region.left),
        at: (region.place[0], region.place[1]),
        text,
    }
}
