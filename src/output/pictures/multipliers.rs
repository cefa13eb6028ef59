//! Floquet multipliers: what a disturbance is multiplied by while the wave travels its own length, or
//! from one point of a ring to the next.

use crate::output::render::{
    Axis, BLACK, BLUE, Extent, GREY, Key, Layer, Legend, Mark, MarkShape, Panel, Pen, Picture,
    Point, VERMILLION, WHITE, drawable, number,
};
use std::f64::consts::TAU;

use faer::c64;

use super::diagram::same_leg;
use super::spectrum::{Chosen, NONE, unstable};
use super::tables::{Tables, column, list, number as value_of};
use super::view::parameter_axis;
use crate::output::store::StoreError;

/// Half width of the enlarged view in distances of the foremost multiplier from the unit circle.
const ROOM: f64 = 2.5;

/// Least half width of the enlarged view, in units of T, and the largest.
const HALF: (f64, f64) = (0.04, 0.45);

/// Room beyond the moduli along a branch, as a part of what they cover, and the least that this is taken to be: they may all be 1.
const ROOM_OVER: f64 = 0.08;
const LEAST_OVER: f64 = 1e-3;

/// How near to 1 the multiplier of the translation lies.
const TRANSLATION: f64 = 1e-9;

/// Corners of the disc per half width of a window.
const CORNERS: f64 = 720.0;

/// A multiplier and how it is drawn.
type Multiplier = (Point, Mark);

/// A square part of the plane.
#[derive(Clone, Copy)]
struct PlaneWindow {
    centre: Point,
    half: f64,
}

/// The picture of a wave of `spectrum.csv`, with the modulus of the leading multiplier along the branch where that is known.
pub(super) fn picture(tables: &Tables) -> Result<Picture, StoreError> {
    let table = tables.spectrum()?;
    let chosen = Chosen::of(table.as_ref(), 1);
    let Some(label) = chosen.labels.first() else {
        return Ok(blank(NONE));
    };
    let (speed, length) = (tables.at_label(label, "speed"), tables.length_at(label));
    let (Some(speed), Some(length)) = (speed, length) else {
        return Ok(blank(UNKNOWN));
    };
    let Some(period) = period_of(length, speed) else {
        return Ok(blank(UNKNOWN));
    };
    let mode = (TAU / length).round();
    let sectors: Vec<f64> = chosen
        .sectors
        .iter()
        .map(|sector| sector.parse().unwrap_or(f64::NAN))
        .collect();
    let mut multipliers = Vec::new();
    for one in &chosen.eigenvalues {
        let (mark, sector) = (chosen.mark(0, one.sector), sectors[one.sector]);
        let partner = sectors.contains(&(mode - sector)) && 2.0 * sector != mode;
        multipliers.extend(multiplied(one.value, period, !partner).map(|place| (place, mark)));
    }
    let leading = leading(tables);
    let known = leading.iter().filter(|(_, size)| size.is_finite());
    let legend = chosen.legend(tables);
    Ok(match known.count() > 1 {
        true => with_branch(&multipliers, leading, parameter_axis(tables), legend),
        false => plane(&multipliers, legend, period, "k|c|"),
    })
}

/// The modulus of the leading multiplier over the parameter, wave by wave; gaps between legs and where it is unknown.
fn leading(tables: &Tables) -> Vec<Point> {
    let branch = &tables.branch;
    let values = column(branch, &tables.parameter);
    let mut leading = Vec::with_capacity(branch.len());
    for (row, value) in values.into_iter().enumerate() {
        if row > 0 && !same_leg(branch, row - 1) {
            leading.push((f64::NAN, f64::NAN));
        }
        let size = || {
            let number = |name| value_of(branch, row, name);
            let length = list(branch, row, "switches").last().copied()?;
            let period = period_of(length, number("speed")?)?;
            Some((number("lead_re")? * period).exp()).filter(|size| drawable(*size))
        };
        leading.push((value, size().unwrap_or(f64::NAN)));
    }
    leading
}

/// The multipliers of one wave on the left, and the modulus of the leading one over the parameter on the right.
fn with_branch(
    multipliers: &[Multiplier],
    leading: Vec<Point>,
    parameter: Axis,
    legend: Legend,
) -> Picture {
    let line = Pen::solid(BLACK, 1.6);
    let sizes = leading.iter().map(|place| place.1);
    let known = sizes.filter(|size| size.is_finite());
    let (low, high) = known.fold((1.0_f64, 1.0_f64), |(low, high), size| {
        (low.min(size), high.max(size))
    });
    let room = ROOM_OVER * (high - low).max(LEAST_OVER);
    let extent = Extent::Fixed(low - room, high + room);
    let largest = |(re, im): Point| re.abs().max(im.abs());
    let all = multipliers.iter().map(|one| largest(one.0));
    let all = PlaneWindow {
        centre: (0.0, 0.0),
        half: 1.12 * all.fold(1.0, f64::max),
    };
    let right = vec![
        Layer::Across(1.0, Pen::solid(GREY, 1.2)),
        Layer::Line(leading, line),
    ];
    let keys = [
        (Key::Mark(CROSS), "translation, μ = 1"),
        (Key::Line(line), "the leading one along the branch"),
    ];
    let legend = legend
        .with("", keys)
        .with::<&str>("μ = exp(λT), T = 2π/(k|c|)", []);
    let panels = vec![
        all.panel("Im μ", all.layers(multipliers)),
        Panel::new(parameter, Axis::new(("", "|μ|"), extent), right),
    ];
    Picture {
        beside: true,
        ..Picture::new(panels, legend)
    }
}

/// Time in which a wave travels its own length 2π/k, as T = 2π/(k|c|).
fn period_of(length: f64, speed: f64) -> Option<f64> {
    let mode = (TAU / length).round();
    let period = TAU / (mode * speed.abs());
    (mode >= 1.0 && drawable(mode) && drawable(period)).then_some(period)
}

/// Multipliers of a discretised ring from one of its points to the next, those of the wave itself over
/// them: eigenvalues of the sectors 0 to k/2, whose conjugates are those of the others. `period` is the time
/// from one point to the next.
pub(crate) fn discretised(
    ring: &[(usize, c64)],
    exact: &[(usize, c64)],
    points: usize,
    period: f64,
) -> Picture {
    let marks = [
        Mark::new(MarkShape::Circle, 3.0, BLUE),
        Mark::new(MarkShape::Plus, 4.4, VERMILLION),
    ];
    let mut multipliers = Vec::new();
    for (values, mark) in [ring, exact].into_iter().zip(marks) {
        for (_, value) in values {
            let places = multiplied((value.re, value.im), period, true);
            multipliers.extend(places.map(|place| (place, mark)));
        }
    }
    let names = [
        format!("ring of {points} points per wave"),
        "exact".to_owned(),
    ];
    let legend = Legend::default().with("", marks.map(Key::Mark).into_iter().zip(names));
    plane(&multipliers, legend, period, &format!("{points} k|c|"))
}

/// The multipliers along a branch of orbits.
pub(super) struct MultipliersAlong {
    /// Values of the parameter and the leading multiplier, point by point; gaps between legs and where it is unknown.
    pub leading: Vec<(f64, Point)>,
    /// All multipliers of labelled orbits.
    pub labelled: Vec<(f64, Point)>,
}

/// Multipliers along a branch: in the plane, and their moduli over the parameter. `none` says why there are none.
pub(super) fn of_branch(along: &MultipliersAlong, parameter: Axis, none: &str) -> Picture {
    let known = along.leading.iter().chain(&along.labelled).map(size);
    let known: Vec<f64> = known.filter(|size| size.is_finite()).collect();
    if known.is_empty() {
        return blank(none);
    }
    let largest = known.iter().copied().fold(1.0, f64::max);
    let path = Pen::solid(VERMILLION, 1.6);
    let mark = Mark::new(MarkShape::Circle, 3.4, BLUE);
    let all = PlaneWindow {
        centre: (0.0, 0.0),
        half: 1.12 * largest.min(FAR),
    };
    let mut left = all.layers(&[]);
    // that of a pair and its conjugate
    let mirrored = |sign: f64| {
        let places = along.leading.iter().map(|(_, (re, im))| (*re, sign * im));
        all.cut_line(&unjumped(places))
    };
    let sides = if along.leading.iter().any(|(_, (_, im))| *im != 0.0) {
        2
    } else {
        1
    };
    left.extend(
        [1.0, -1.0]
            .into_iter()
            .take(sides)
            .map(|sign| Layer::Line(mirrored(sign), path)),
    );
    let places = along.labelled.iter().map(|(_, place)| *place);
    let inside = places.filter(|place| all.contains(*place)).collect();
    left.push(Layer::Marks(inside, mark));
    let mut keys = vec![(Key::Mark(mark), "at the labels, all".to_owned())];
    if along.leading.iter().any(|one| size(one).is_finite()) {
        keys.insert(
            0,
            (
                Key::Line(path),
                "along the branch, the leading one".to_owned(),
            ),
        );
    }
    keys.push((Key::Mark(CROSS), "μ = 1".to_owned()));
    if largest > FAR {
        let words = format!("those with |μ| > {FAR} are on the right only");
        keys.push((Key::Word, words));
    }
    let panels = vec![
        all.panel("Im μ", left),
        moduli(along, parameter, largest, (path, mark)),
    ];
    Picture {
        beside: true,
        ..Picture::new(panels, Legend::default().with("", keys))
    }
}

/// The moduli over the parameter.
fn moduli(
    along: &MultipliersAlong,
    parameter: Axis,
    largest: f64,
    (path, mark): (Pen, Mark),
) -> Panel {
    let logarithmic = largest > FAR;
    let over = |list: &[(f64, Point)]| -> Vec<Point> {
        let shown = |size: f64| {
            if logarithmic && size <= 0.0 {
                f64::NAN
            } else {
                size
            }
        };
        list.iter().map(|one| (one.0, shown(size(one)))).collect()
    };
    let marks = over(&along.labelled)
        .into_iter()
        .filter(|place| place.1.is_finite());
    let layers = vec![
        Layer::Across(1.0, Pen::solid(BLACK, 1.2)),
        Layer::Line(over(&along.leading), path),
        Layer::Marks(marks.collect(), mark),
    ];
    let extent = match logarithmic {
        true => Extent::Logarithmic(0.06),
        false => Extent::Fixed(0.0, 1.08 * largest),
    };
    Panel::new(parameter, Axis::new(("", "|μ|"), extent), layers)
}

/// Modulus of a multiplier at a value of the parameter.
fn size((_, (re, im)): &(f64, Point)) -> f64 {
    re.hypot(*im)
}

/// Modulus up to which a plane shows multipliers: beyond it the unit circle is a dot.
const FAR: f64 = 2.5;

/// Distance of two neighbours in the plane from which on they are two multipliers, of which one leads before the other: steps along
/// a branch are a hundredth of its length.
const JUMP: f64 = 0.3;

/// A path with gaps where it passes from one multiplier to another.
fn unjumped(places: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut path: Vec<Point> = Vec::new();
    for place in places {
        if let Some(last) = path.last() {
            let distance = (place.0 - last.0).hypot(place.1 - last.1);
            if distance > JUMP * last.0.hypot(last.1).max(1.0) {
                path.push((f64::NAN, f64::NAN));
            }
        }
        path.push(place);
    }
    path
}

/// The unit circle with all multipliers on the left, a part of it enlarged on the right.
fn beside(multipliers: &[Multiplier], [all, near]: [PlaneWindow; 2], legend: Legend) -> Picture {
    let outline = Pen::solid(GREY, 1.3);
    let mut left = all.layers(multipliers);
    let corners = near.corners();
    let closed = corners.iter().chain(&corners[..2]).copied().collect();
    left.push(Layer::Line(closed, outline));
    let right = near.layers(multipliers);
    let legend = legend.with("", [(Key::Line(outline), "enlarged on the right")]);
    let panels = vec![all.panel("Im μ", left), near.panel("", right)];
    Picture {
        beside: true,
        ..Picture::new(panels, legend)
    }
}

/// What an empty picture says.
const UNKNOWN: &str = "no multiplier of the wave is known";

/// exp(λT), and its conjugate if that is wanted and another one.
fn multiplied(
    (growth, frequency): Point,
    period: f64,
    conjugate: bool,
) -> impl Iterator<Item = Point> {
    let size = (growth * period).exp();
    let (sine, cosine) = (frequency * period).sin_cos();
    let (re, im) = (size * cosine, size * sine);
    let both = [(re, im), (re, -im)].into_iter();
    both.take(if conjugate && frequency != 0.0 { 2 } else { 1 })
        .filter(|(re, im)| drawable(*re) && drawable(*im))
}

/// The unit circle with all multipliers, and an enlarged view of the one that grows most.
fn plane(multipliers: &[Multiplier], legend: Legend, period: f64, divisor: &str) -> Picture {
    let Some(near) = PlaneWindow::foremost(multipliers, period) else {
        return blank(UNKNOWN);
    };
    let all = PlaneWindow::of_all(multipliers, near);
    let period = number::significant(period, 4);
    let legend = legend
        .with("", [(Key::Mark(CROSS), "translation, μ = 1")])
        .with::<&str>(&format!("μ = exp(λT), T = 2π/({divisor}) = {period}"), []);
    beside(multipliers, [all, near], legend)
}

/// The cross at μ = 1.
const CROSS: Mark = Mark {
    shape: MarkShape::Cross,
    size: 3.6,
    colour: BLACK,
};

/// A frame with a remark instead of data.
fn blank(text: &str) -> Picture {
    let axis = |symbol| Axis::new(("", symbol), Extent::Data(0.0));
    let panel = Panel::new(axis("Re μ"), axis("Im μ"), Vec::new()).unless(true, text);
    Picture::new(vec![panel], Legend::default())
}

impl PlaneWindow {
    /// The window around the unit circle, all multipliers and the enlarged window.
    fn of_all(multipliers: &[Multiplier], near: PlaneWindow) -> Self {
        let largest = |(re, im): Point| re.abs().max(im.abs());
        let sizes = multipliers.iter().map(|(place, _)| largest(*place));
        let half = 1.12 * sizes.fold(1.0, f64::max);
        PlaneWindow {
            centre: (0.0, 0.0),
            half: half.max(1.06 * (largest(near.centre) + near.half)),
        }
    }

    /// The window around the multiplier of largest modulus but for the translation; on the real axis,
    /// with its conjugate, where that is near.
    fn foremost(multipliers: &[Multiplier], period: f64) -> Option<Self> {
        let size = |(re, im): Point| re.hypot(im);
        let moved = |place: &Point| size((place.0 - 1.0, place.1)) > TRANSLATION;
        let places = multipliers.iter().map(|one| one.0).filter(moved);
        let lead = places.max_by(|one, other| size(*one).total_cmp(&size(*other)))?;
        let (re, im) = (lead.0, lead.1.abs());
        let least = (HALF.0 * period).min(HALF.1);
        let half = (ROOM * (size(lead) - 1.0).abs()).clamp(least, HALF.1);
        let wide = half.max(1.5 * im);
        Some(match re > 0.0 && wide <= HALF.1 {
            true => PlaneWindow {
                centre: (re, 0.0),
                half: wide,
            },
            false => PlaneWindow {
                centre: (re, im),
                half,
            },
        })
    }

    fn contains(self, (re, im): Point) -> bool {
        (re - self.centre.0).abs() <= self.half && (im - self.centre.1).abs() <= self.half
    }

    /// A line with gaps where it is outside the window.
    fn cut_line(self, line: &[Point]) -> Vec<Point> {
        let shown = |place: &Point| match self.contains(*place) {
            true => *place,
            false => (f64::NAN, f64::NAN),
        };
        line.iter().map(shown).collect()
    }

    fn corners(self) -> [Point; 4] {
        let ((re, im), half) = (self.centre, self.half);
        [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| (re + x, im + y))
    }

    fn panel(self, vertical: &str, layers: Vec<Layer>) -> Panel {
        let axis = |middle: f64, symbol| {
            let extent = Extent::Fixed(middle - self.half, middle + self.half);
            Axis::new(("", symbol), extent)
        };
        let (re, im) = self.centre;
        Panel::new(axis(re, "Re μ"), axis(im, vertical), layers)
    }

    /// The part of a polygon in the window: cut along one side after the other.
    fn cut(self, mut polygon: Vec<Point>) -> Vec<Point> {
        let corners = self.corners();
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            // positive left of the side, which runs round the window with the inside on its left
            let inside = |place: &Point| {
                (to.0 - from.0) * (place.1 - from.1) - (to.1 - from.1) * (place.0 - from.0)
            };
            let mut kept = Vec::with_capacity(polygon.len() + 4);
            for (one, next) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
                let (a, b) = (inside(one), inside(next));
                if a >= 0.0 {
                    kept.push(*one);
                }
                if (a >= 0.0) != (b >= 0.0) {
                    let part = a / (a - b);
                    kept.push((
                        one.0 + part * (next.0 - one.0),
                        one.1 + part * (next.1 - one.1),
                    ));
                }
            }
            polygon = kept;
        }
        polygon
    }

    /// What lies in the window: the unstable side, the unit circle, the multipliers.
    fn layers(self, multipliers: &[Multiplier]) -> Vec<Layer> {
        let corners = (CORNERS / self.half.min(1.0)).round() as i32;
        let circle: Vec<Point> = (0..=corners)
            .map(|corner| {
                let (sine, cosine) = (TAU * f64::from(corner) / f64::from(corners)).sin_cos();
                (cosine, sine)
            })
            .collect();
        let arc = self.cut_line(&circle);
        let mut layers = vec![
            Layer::Cells(vec![unstable(f64::NEG_INFINITY)]),
            Layer::Area(self.cut(circle), WHITE),
            Layer::Line(arc, Pen::solid(BLACK, 1.9)),
        ];
        let inside = multipliers.iter().filter(|one| self.contains(one.0));
        layers.extend(inside.map(|(place, mark)| Layer::Marks(vec![*place], *mark)));
        if self.contains((1.0, 0.0)) {
            layers.push(Layer::Marks(vec![(1.0, 0.0)], CROSS));
        }
        layers
    }
}
