//! Growth of the perturbations of steady sliding, and the friction where it begins, by mode.

use super::axis::{self, Axis};
use super::canvas::Shape;
use super::error::PlotError;
use super::legend::{Key, Legend};
use super::palette::{BLUE, GREEN, GREY, Pen, VERMILLION};
use super::quantity::Quantity;
use super::sheet::{Panel, Sheet, remark, usual_length};
use crate::steady::Mode;

/// Height of each of two frames.
const HEIGHT: f64 = 210.0;

/// Size of the points.
const SIZE: f64 = 3.6;

/// What a curve shows of a mode.
type Value = fn(&Mode) -> Option<f64>;

/// A curve over the modes.
struct Curve {
    name: &'static str,
    shape: Shape,
    pen: Pen,
    growth: Value,
    hopf: Value,
}

/// What is drawn, the last one on top.
fn curves() -> [Curve; 3] {
    [
        Curve {
            name: "tube, leading family",
            shape: Shape::Up,
            pen: Pen::dashed(GREEN, 1.6),
            growth: |mode| Some(mode.full.as_ref()?.lead_wave.growth),
            hopf: |mode| Some(mode.full.as_ref()?.first?.1.friction),
        },
        Curve {
            name: "tube, fundamental family",
            shape: Shape::Disc,
            pen: Pen::solid(BLUE, 1.9),
            growth: |mode| Some(mode.full.as_ref()?.fundamental.wave.growth),
            hopf: |mode| Some(mode.full.as_ref()?.fundamental.hopf?.friction),
        },
        Curve {
            name: "reduced model",
            shape: Shape::OpenSquare,
            pen: Pen::solid(VERMILLION, 1.9),
            growth: |mode| Some(mode.reduced.wave.growth),
            hopf: |mode| Some(mode.reduced.hopf?.friction),
        },
    ]
}

/// Composes the picture.
pub fn compose(modes: &[Mode], title: Option<&str>) -> Result<String, PlotError> {
    let abscissae = || modes.iter().map(|mode| f64::from(mode.mode));
    let mode = Quantity::new("mode", "k");
    let x = match axis::range(abscissae()) {
        Some((low, high)) => {
            let room = 0.04 * (high - low);
            Axis::fitted(low - room, high + room, &mode, usual_length())
        }
        None => Axis::blank(&mode),
    };
    let curves = curves();
    let collect = |value: fn(&Curve) -> Value| -> Vec<f64> {
        let of = |curve: &Curve| modes.iter().filter_map(value(curve)).collect::<Vec<_>>();
        curves.iter().flat_map(of).collect()
    };
    let growths = collect(|curve| curve.growth);
    let hopfs = collect(|curve| curve.hopf);
    // without damping every friction makes every mode grow: there is nothing to show
    let damped = hopfs.iter().any(|friction| *friction > 0.0);
    let y = Axis::around(
        growths.iter().copied().chain([0.0]),
        &Quantity::new("growth rate", "Re λ"),
        5,
    );
    let mut panels = vec![Panel::new(x.clone(), y)];
    if damped {
        let y = Axis::around(
            hopfs.iter().copied().chain([0.0]),
            &Quantity::new("Hopf friction", "f"),
            5,
        );
        for panel in &mut panels {
            panel.height = HEIGHT;
            panel.labelled_below = false;
        }
        let mut below = Panel::new(x, y);
        below.height = HEIGHT;
        below.above = 14.0;
        panels.push(below);
    }
    let mut legend = Legend::default();
    let shown = |curve: &&Curve| modes.iter().any(|mode| (curve.growth)(mode).is_some());
    legend.add(
        "",
        curves.iter().rev().filter(shown).map(|curve| {
            let key = Key::Point(curve.shape, SIZE, curve.pen.colour);
            (key, curve.name.to_owned())
        }),
    );
    let sheet = Sheet {
        title: title.map(str::to_owned),
        panels,
        legend,
        right: 0.0,
    };
    sheet.compose(|canvas, frames| {
        for (index, frame) in frames.iter().enumerate() {
            if modes.is_empty() {
                remark(canvas, frame, "no mode was asked for");
                continue;
            }
            let zero = [(frame.x.low, 0.0), (frame.x.high, 0.0)];
            frame.curve(canvas, zero, Pen::solid(GREY, 1.0));
            for curve in &curves {
                let value = if index == 0 { curve.growth } else { curve.hopf };
                let points = || {
                    modes
                        .iter()
                        .map(|mode| (f64::from(mode.mode), value(mode).unwrap_or(f64::NAN)))
                };
                frame.curve(canvas, points(), curve.pen);
                for (k, value) in points() {
                    if let Some(place) = frame.place(k, value) {
                        canvas.point(place, curve.shape, SIZE, curve.pen.colour);
                    }
                }
            }
        }
    })
}
