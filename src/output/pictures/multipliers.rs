//! Floquet multipliers of one wave: what a disturbance is multiplied by while the wave travels its
//! own length.

use std::f64::consts::{PI, TAU};

use super::error::PlotError;
use super::spectrum::{Chosen, unstable};
use super::tables::Tables;
use crate::output::render::axis::{Axis, Extent, Quantity, drawable};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{BLACK, GREY, Pen, WHITE};
use crate::output::render::{Layer, Mark, Panel, Picture, Point, Shape};

/// Distance from μ = 1 within which multipliers belong in the enlarged view.
const NEAR: f64 = 0.35;

/// Distance along an axis beyond which none is taken into the enlarged view.
const FARTHEST: f64 = 0.5;

/// Least half width of the enlarged view.
const FINEST: f64 = 0.1;

/// Parts of half the unit circle.
const PARTS: i32 = 360;

/// A multiplier, and the place of its sector among those that occur.
type Multiplier = (Point, usize);

/// A square part of the plane.
#[derive(Clone, Copy)]
struct Window {
    /// Real part of the centre, which lies on the real axis.
    centre: f64,
    /// Half the side.
    half: f64,
}

/// The picture.
pub(super) fn picture(tables: &Tables) -> Result<Picture, PlotError> {
    let table = tables.spectrum()?;
    let chosen = Chosen::of(table.as_ref(), 1);
    let multipliers = match chosen.labels.first() {
        None => return Ok(blank("no spectrum was asked for")),
        Some(label) => multipliers(tables, label, &chosen),
    };
    if multipliers.is_empty() {
        return Ok(blank("no multiplier of the wave is known"));
    }
    let near = Window::near_one(&multipliers);
    let all = Window::of_all(&multipliers, near);
    let outline = Pen::solid(GREY, 1.3);
    let mut left = all.layers(&multipliers, &chosen);
    left.push(Layer::Line(near.outline(), outline));
    let right = near.layers(&multipliers, &chosen);
    let legend = chosen.legend(tables).with(
        "",
        [
            (Key::Mark(CROSS), "translation, μ = 1"),
            (Key::Line(outline), "enlarged on the right"),
        ],
    );
    let panels = vec![all.panel("Im μ", left), near.panel("", right)];
    Ok(Picture {
        beside: true,
        ..Picture::new(panels, legend)
    })
}

/// The cross at μ = 1.
const CROSS: Mark = Mark {
    shape: Shape::Cross,
    size: 3.6,
    colour: BLACK,
};

/// A frame with a remark instead of data.
fn blank(text: &str) -> Picture {
    let axis = |symbol| Axis::new(Quantity::new("", symbol), Extent::Data(0.0));
    let panel = Panel::new(axis("Re μ"), axis("Im μ"), Layer::remark(text));
    Picture::new(vec![panel], Legend::default())
}

impl Window {
    /// The window around the unit circle, all multipliers and the enlarged window.
    fn of_all(multipliers: &[Multiplier], near: Window) -> Self {
        let sizes = multipliers
            .iter()
            .map(|((re, im), _)| re.abs().max(im.abs()));
        Window {
            centre: 0.0,
            half: f64::max(
                1.12 * sizes.fold(1.0, f64::max),
                1.06 * (near.centre + near.half),
            ),
        }
    }

    /// The window around the multipliers near 1.
    fn near_one(multipliers: &[Multiplier]) -> Self {
        let offsets = || multipliers.iter().map(|((re, im), _)| (re - 1.0, *im));
        let side = |(re, im): Point| re.abs().max(im.abs());
        let close = offsets().filter(|(re, im)| re.hypot(*im) <= NEAR);
        let mut extent = close.map(side).reduce(f64::max).unwrap_or(NEAR);
        // Those that would lie on the edge or just beyond are taken in.
        let mut sides: Vec<f64> = offsets()
            .map(side)
            .filter(|side| *side < FARTHEST)
            .collect();
        sides.sort_by(f64::total_cmp);
        for side in sides {
            if side > extent && side < 1.25 * extent {
                extent = side;
            }
        }
        Window {
            centre: 1.0,
            half: (1.12 * extent).max(FINEST),
        }
    }

    fn contains(self, (re, im): Point) -> bool {
        (re - self.centre).abs() <= self.half && im.abs() <= self.half
    }

    fn outline(self) -> Vec<Point> {
        let (low, high) = (self.centre - self.half, self.centre + self.half);
        let corner = |(re, sign)| (re, sign * self.half);
        [
            (low, -1.0),
            (high, -1.0),
            (high, 1.0),
            (low, 1.0),
            (low, -1.0),
            (high, -1.0),
        ]
        .map(corner)
        .to_vec()
    }

    fn panel(self, vertical: &str, layers: Vec<Layer>) -> Panel {
        let axis = |middle: f64, symbol| {
            let extent = Extent::Fixed(middle - self.half, middle + self.half);
            Axis::new(Quantity::new("", symbol), extent)
        };
        Panel::new(axis(self.centre, "Re μ"), axis(0.0, vertical), layers)
    }

    /// What lies in the window: the unstable side, the unit circle, the multipliers.
    fn layers(self, multipliers: &[Multiplier], chosen: &Chosen<'_>) -> Vec<Layer> {
        // Around 0 the window holds the whole circle, around 1 what is not too high.
        let around_zero = self.centre == 0.0;
        let reach = if around_zero {
            PI
        } else {
            self.half.min(1.0).asin()
        };
        let circle: Vec<Point> = (-PARTS..=PARTS)
            .map(|part| {
                let (sine, cosine) = (reach * f64::from(part) / f64::from(PARTS)).sin_cos();
                (cosine, sine)
            })
            .collect();
        let mut disc = circle.clone();
        if let (false, Some((re, im))) = (around_zero, circle.last()) {
            // The disc reaches left to the edge of the window.
            let edge = re.min(self.centre - self.half);
            disc.extend([(edge, *im), (edge, -im)]);
        }
        let mut layers = vec![
            Layer::Cells(vec![unstable(f64::NEG_INFINITY)]),
            Layer::Area(disc, WHITE),
            Layer::Line(circle, Pen::solid(BLACK, 1.9)),
        ];
        let inside = multipliers.iter().filter(|one| self.contains(one.0));
        layers.extend(
            inside.map(|(point, sector)| Layer::Marks(vec![*point], chosen.mark(0, *sector))),
        );
        layers.push(Layer::Marks(vec![(1.0, 0.0)], CROSS));
        layers
    }
}

/// The multipliers of a labelled wave; empty where its speed or its length is not known.
fn multipliers(tables: &Tables, label: &str, chosen: &Chosen<'_>) -> Vec<Multiplier> {
    let (speed, length) = (tables.at_label(label, "speed"), tables.length_at(label));
    let (Some(speed), Some(length)) = (speed, length) else {
        return Vec::new();
    };
    let mode = (TAU / length).round();
    let period = TAU / (mode * speed.abs());
    if !(mode >= 1.0 && drawable(mode) && drawable(period)) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for one in &chosen.eigenvalues {
        let (growth, frequency) = one.value;
        let size = (growth * period).exp();
        let (sine, cosine) = (frequency * period).sin_cos();
        let (re, im) = (size * cosine, size * sine);
        if !(drawable(re) && drawable(im)) {
            continue;
        }
        found.push(((re, im), one.sector));
        // Sectors 0 and k/2 are their own conjugates; their tables leave Im λ < 0 out.
        let sector = chosen.sectors[one.sector].parse();
        let own = sector.is_ok_and(|sector: f64| sector == 0.0 || 2.0 * sector == mode);
        if own && frequency > 0.0 {
            found.push(((re, -im), one.sector));
        }
    }
    found
}
