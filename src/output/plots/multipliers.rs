//! Floquet multipliers of one wave: what a disturbance is multiplied by while the wave travels its
//! own length.

use std::f64::consts::{PI, TAU};

use super::Settings;
use super::axis::{Axis, drawable};
use super::canvas::{Canvas, Shape};
use super::error::PlotError;
use super::frame::Frame;
use super::legend::Key;
use super::palette::{BLACK, GREY, Pen, VERMILLION, WHITE, mix};
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, remark};
use super::spectrum::{self, Chosen, SIZE, colour, shape};
use super::tables::Tables;

/// Distance from μ = 1 within which multipliers belong in the enlarged view.
const NEAR: f64 = 0.35;

/// Distance along an axis beyond which none is taken into the enlarged view.
const FARTHEST: f64 = 0.5;

/// Least half width of the enlarged view.
const FINEST: f64 = 0.1;

/// Size of the cross at μ = 1.
const CROSS: f64 = 3.6;

/// About the length of an axis, for the choice of the figures.
const LENGTH: f64 = 185.0;

/// A multiplier.
struct Multiplier {
    /// Place of its sector among those that occur.
    sector: usize,
    re: f64,
    im: f64,
}

/// A square part of the plane.
#[derive(Clone, Copy)]
struct Window {
    /// Real part of the centre, which lies on the real axis.
    centre: f64,
    /// Half the side.
    half: f64,
}

impl Window {
    /// The window around the unit circle, all multipliers and the enlarged window.
    fn of_all(multipliers: &[Multiplier], near: Window) -> Self {
        let extent = multipliers
            .iter()
            .map(|one| one.re.abs().max(one.im.abs()))
            .fold(1.0, f64::max);
        Window {
            centre: 0.0,
            half: f64::max(1.12 * extent, 1.06 * (near.centre + near.half)),
        }
    }

    /// The window around the multipliers near 1.
    fn near_one(multipliers: &[Multiplier]) -> Self {
        let mut sides: Vec<f64> = multipliers
            .iter()
            .map(|one| (one.re - 1.0).abs().max(one.im.abs()))
            .filter(|side| *side < FARTHEST)
            .collect();
        sides.sort_by(f64::total_cmp);
        let mut extent = multipliers
            .iter()
            .map(|one| (one.re - 1.0, one.im))
            .filter(|(re, im)| re.hypot(*im) <= NEAR)
            .map(|(re, im)| re.abs().max(im.abs()))
            .reduce(f64::max)
            .unwrap_or(NEAR);
        // Those that would lie on the edge or just beyond are taken in.
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

    fn contains(self, re: f64, im: f64) -> bool {
        (re - self.centre).abs() <= self.half && im.abs() <= self.half
    }

    fn panel(self, vertical: &Quantity) -> Panel {
        let over = |middle: f64, quantity: &Quantity| {
            Axis::fitted(middle - self.half, middle + self.half, quantity, LENGTH)
        };
        let horizontal = Quantity::new("", "Re μ");
        Panel::new(over(self.centre, &horizontal), over(0.0, vertical))
    }

    /// Points of the unit circle inside the window, from below.
    fn circle(self) -> impl Iterator<Item = (f64, f64)> + Clone {
        const PARTS: i32 = 360;
        // Around 0 the window holds the whole circle, around 1 what is not too high.
        let reach = if self.centre == 0.0 {
            PI
        } else {
            self.half.min(1.0).asin()
        };
        (-PARTS..=PARTS).map(move |part| {
            let (sine, cosine) = (reach * f64::from(part) / f64::from(PARTS)).sin_cos();
            (cosine, sine)
        })
    }
}

/// Composes the picture.
pub fn compose(tables: &Tables, settings: &Settings) -> Result<String, PlotError> {
    let chosen = spectrum::choose(tables, 1)?;
    let multipliers = match chosen.labels.first() {
        None => return blank(settings, "no spectrum was asked for"),
        Some(label) => multipliers(tables, label, &chosen),
    };
    if multipliers.is_empty() {
        return blank(settings, "no multiplier of the wave is known");
    }
    let near = Window::near_one(&multipliers);
    let all = Window::of_all(&multipliers, near);
    let frame_pen = Pen::solid(GREY, 1.3);
    let mut legend = spectrum::legend(tables, settings, &chosen);
    let cross = Key::Point(Shape::Cross, CROSS, BLACK);
    legend.add(
        "",
        [
            (cross, "translation, μ = 1".to_owned()),
            (Key::Line(frame_pen), "enlarged on the right".to_owned()),
        ],
    );
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![
            all.panel(&Quantity::new("", "Im μ")),
            near.panel(&Quantity::new("", "")),
        ],
        legend,
        right: 0.0,
    };
    sheet.compose_row(|canvas, frames| {
        let [left, right] = frames else {
            return;
        };
        paint(canvas, left, all, &multipliers);
        let (low, high) = (near.centre - near.half, near.centre + near.half);
        let outline = [
            (low, -near.half),
            (high, -near.half),
            (high, near.half),
            (low, near.half),
            (low, -near.half),
            (high, -near.half),
        ];
        left.curve(canvas, outline, frame_pen);
        paint(canvas, right, near, &multipliers);
    })
}

/// The multipliers of a labelled wave; empty where its speed or its length is not known.
fn multipliers(tables: &Tables, label: &str, chosen: &Chosen<'_>) -> Vec<Multiplier> {
    let speed = tables.at_label(label, "speed");
    let length = tables.list_at_label(label, "switches").last().copied();
    let (Some(speed), Some(length)) = (speed, length) else {
        return Vec::new();
    };
    // The last switching position ends the wavelength.
    let mode = (TAU / length).round();
    let period = TAU / (mode * speed.abs());
    if !(mode >= 1.0 && drawable(mode) && drawable(period)) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for one in &chosen.eigenvalues {
        let growth = (one.re * period).exp();
        let (sine, cosine) = (one.im * period).sin_cos();
        let (re, im) = (growth * cosine, growth * sine);
        if !(drawable(re) && drawable(im)) {
            continue;
        }
        let sector = one.sector;
        found.push(Multiplier { sector, re, im });
        // Sectors 0 and k/2 are their own conjugates; their tables leave Im λ < 0 out.
        let own = chosen.sectors[sector]
            .parse()
            .is_ok_and(|sector: f64| sector == 0.0 || 2.0 * sector == mode);
        if own && one.im > 0.0 {
            let im = -im;
            found.push(Multiplier { sector, re, im });
        }
    }
    found
}

/// Draws what lies in the window: the unstable side, the unit circle, the multipliers.
fn paint(canvas: &mut Canvas<'_>, frame: &Frame, window: Window, multipliers: &[Multiplier]) {
    canvas.area(frame.from, frame.to, mix(WHITE, VERMILLION, 0.12));
    // The disc reaches left to the edge of the window.
    let edge = window.centre - window.half;
    let mut disc: Vec<(f64, f64)> = window.circle().collect();
    if window.centre != 0.0
        && let (Some(first), Some(last)) = (disc.first().copied(), disc.last().copied())
    {
        disc.push((edge.min(last.0), last.1));
        disc.push((edge.min(first.0), first.1));
    }
    let corners: Vec<_> = disc
        .into_iter()
        .filter_map(|(re, im)| frame.place(re, im))
        .collect();
    canvas.polygon(&corners, WHITE);
    frame.curve(canvas, window.circle(), Pen::solid(BLACK, 1.9));
    for one in multipliers {
        if window.contains(one.re, one.im)
            && let Some(place) = frame.place(one.re, one.im)
        {
            let colour = colour(0, one.sector, 1);
            canvas.point(place, shape(one.sector), SIZE, colour);
        }
    }
    if let Some(place) = frame.place(1.0, 0.0) {
        canvas.point(place, Shape::Cross, CROSS, BLACK);
    }
}

/// A frame with a remark instead of data.
fn blank(settings: &Settings, text: &str) -> Result<String, PlotError> {
    let axis = |symbol| Axis::blank(&Quantity::new("", symbol));
    let sheet = Sheet {
        title: settings.title.clone(),
        panels: vec![Panel::new(axis("Re μ"), axis("Im μ"))],
        ..Sheet::default()
    };
    sheet.compose(|canvas, frames| {
        for frame in frames {
            remark(canvas, frame, text);
        }
    })
}
