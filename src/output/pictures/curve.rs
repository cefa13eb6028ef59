//! The curve of an event in the plane of its parameters, with the regions on either side named.

use super::names::{constant_parameters, event, quantity, short_signature};
use crate::curve::{self, ParameterPlane, PointType, Region, WholeCurve};
use crate::orbit::{EventType, Zones};
use crate::output::render::{
    Axis, BLACK, BLUE, Extent, Key, Layer, Legend, Mark, MarkShape, Panel, PanelName, Pen, Picture,
    Point, Quantity, VERMILLION,
};
use crate::problem::Problem;

/// Size of the marks of special points.
const MARK: f64 = 4.6;

/// Special points are at one place where they are nearer than this share of both axes, and by how much each is larger than the one
/// that lies on it.
const SAME: f64 = 0.004;
const RIM: f64 = 0.8;

/// Shapes of the special points, in the order of their names.
const SHAPES: [MarkShape; 5] = [
    MarkShape::Diamond,
    MarkShape::Square,
    MarkShape::Up,
    MarkShape::Star,
    MarkShape::Circle,
];

/// The picture of a curve of waves over these ranges of its parameters, with those that stay as they are.
pub(crate) fn of_waves(
    curve: &WholeCurve,
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
pub(super) fn picture<P: ParameterPlane>(
    curve: &WholeCurve<P>,
    ranges: [(f64, f64); 2],
    quantity: fn(&str) -> Quantity,
) -> Picture {
    let [x, y] = [0, 1].map(|index: usize| {
        let quantity = quantity(P::Orbit::column(&curve.parameters[index]));
        Axis::new(quantity, Extent::Fixed(ranges[index].0, ranges[index].1))
    });
    let plane = |point: &curve::CurvePoint| (point.parameters[0], point.parameters[1]);
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
    let (pen, on_branch) = (
        Pen::solid(BLUE, 2.2),
        Mark::new(MarkShape::Disc, MARK, BLACK),
    );
    let mut layers = vec![Layer::Line(line, pen)];
    let ranks = nested(&special, &kinds, ranges);
    for (rank, (point, kind)) in ranks {
        let mut mark = mark(*kind);
        mark.size *= 1.0 + RIM * rank as f64;
        layers.push(Layer::Marks(vec![*point], mark));
    }
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

/// Special points with the number of others that lie on them, those with most first: marks at one place are drawn one in the other.
fn nested<'a>(
    special: &'a [(Point, PointType)],
    kinds: &[PointType],
    [across, up]: [(f64, f64); 2],
) -> Vec<(usize, &'a (Point, PointType))> {
    let is_near = |one: &Point, other: &Point| {
        let [x, y] = [(one.0 - other.0, across), (one.1 - other.1, up)]
            .map(|(distance, (low, high))| (distance / (high - low)).abs());
        x.max(y) <= SAME
    };
    let rank = |kind: &PointType| kinds.iter().position(|known| known == kind);
    let on = |(index, (point, kind)): (usize, &(Point, PointType))| {
        let before = |(other, (there, another)): &(usize, &(Point, PointType))| {
            let order = (rank(another), *other) < (rank(kind), index);
            order && another != kind && is_near(there, point)
        };
        special.iter().enumerate().filter(before).count()
    };
    let mut all: Vec<(usize, &(Point, PointType))> = special
        .iter()
        .enumerate()
        .map(|one| (on(one), one.1))
        .collect();
    all.sort_by_key(|(rank, _)| std::cmp::Reverse(*rank));
    all
}

/// The regimes that all counts of orbits have in common: said once, they leave room for the counts.
fn common_signature(regions: &[Region]) -> Option<&str> {
    let mut signatures = regions.iter().map(|region| match &region.name {
        curve::RegionName::Orbits {
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
fn name(region: &Region, same: Option<&str>) -> PanelName {
    let text = match &region.name {
        curve::RegionName::Orbits { count, regimes } => {
            let others = regimes.iter().filter(|one| Some(one.as_str()) != same);
            let short = others.map(|one| short_signature(one)).collect();
            let name = curve::RegionName::Orbits {
                count: *count,
                regimes: short,
            };
            name.to_string().trim_end().to_owned()
        }
        other => other.to_string(),
    };
    PanelName {
        group: 2 * region.stretch + usize::from(region.left),
        at: (region.place[0], region.place[1]),
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of marks at one place each has a size of its own, and the smallest is drawn last.
    #[test]
    fn marks_at_one_place_are_nested() {
        let [one, other] = [EventType::GR, EventType::PD].map(PointType::One);
        let ranges = [(0.0, 1.0), (0.0, 10.0)];
        let special = [
            ((0.5, 5.0), other),
            ((0.501, 5.01), one),
            ((0.5, 6.0), other),
        ];
        let found = nested(&special, &[one, other], ranges);
        let ranks: Vec<(usize, PointType)> = found.iter().map(|(rank, it)| (*rank, it.1)).collect();
        assert_eq!(ranks, [(1, other), (0, one), (0, other)]);
    }
}
