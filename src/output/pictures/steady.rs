//! Growth of the perturbations of steady sliding, and the friction where it begins, by mode.

use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{BLUE, GREEN, GREY, Pen, VERMILLION};
use crate::output::render::{HEIGHT, Layer, Mark, Panel, Picture, Point, Shape};
use crate::steady::Mode;

/// Height of each of two panels.
const HALF_HEIGHT: f64 = 210.0;

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

/// The picture: growth rates and, with damping, the Hopf friction.
pub(crate) fn picture(modes: &[Mode]) -> Picture {
    let curves = curves();
    let mark = |curve: &Curve| Mark::new(curve.shape, SIZE, curve.pen.colour);
    let panel = |quantity, value: fn(&Curve) -> Value, height| {
        let mut layers = match modes {
            [] => Layer::remark("no mode was asked for"),
            _ => vec![Layer::Across(0.0, Pen::solid(GREY, 1.0))],
        };
        for curve in &curves {
            let point = |mode: &Mode| {
                let value = value(curve)(mode).unwrap_or(f64::NAN);
                (f64::from(mode.mode), value)
            };
            let points: Vec<Point> = modes.iter().map(point).collect();
            layers.push(Layer::Line(points.clone(), curve.pen));
            layers.push(Layer::Marks(points, mark(curve)));
        }
        let x = Axis::new(Quantity::new("mode", "k"), Extent::Data(0.04));
        Panel::new(x, Axis::new(quantity, Extent::Data(0.05)), layers).high(height)
    };
    let growth = Quantity::new("growth rate", "Re λ");
    // without damping every friction makes every mode grow: there is nothing to show
    let mut hopfs = curves
        .iter()
        .flat_map(|curve| modes.iter().filter_map(curve.hopf));
    let panels = if hopfs.any(|friction| friction > 0.0) {
        let friction = Quantity::new("Hopf friction", "f");
        vec![
            panel(growth, |curve| curve.growth, HALF_HEIGHT),
            panel(friction, |curve| curve.hopf, HALF_HEIGHT),
        ]
    } else {
        vec![panel(growth, |curve| curve.growth, HEIGHT)]
    };
    let shown = |curve: &&Curve| modes.iter().any(|mode| (curve.growth)(mode).is_some());
    let entries = curves.iter().rev().filter(shown);
    let entries = entries.map(|curve| (Key::Mark(mark(curve)), curve.name));
    Picture::new(panels, Legend::default().with("", entries))
}
