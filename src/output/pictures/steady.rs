//! Growth of the perturbations of steady sliding, and the friction where it begins, by mode.

use super::tables::column;
use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::legend::{Key, Legend};
use crate::output::render::palette::{BLUE, GREEN, GREY, Pen, VERMILLION};
use crate::output::render::{HEIGHT, Layer, Mark, Panel, Picture, Point, Shape};
use crate::table::Table;

/// Height of each of two panels.
const HALF_HEIGHT: f64 = 210.0;

/// Size of the points.
const SIZE: f64 = 3.6;

/// A curve over the modes.
struct Curve {
    name: &'static str,
    shape: Shape,
    pen: Pen,
    /// Columns of the growth rate and of the friction at the Hopf point.
    columns: [&'static str; 2],
}

/// What is drawn, the last one on top.
fn curves() -> [Curve; 3] {
    [
        Curve {
            name: "tube, leading family",
            shape: Shape::Up,
            pen: Pen::dashed(GREEN, 1.6),
            columns: ["lead_growth", "lead_hopf_friction"],
        },
        Curve {
            name: "tube, fundamental family",
            shape: Shape::Disc,
            pen: Pen::solid(BLUE, 1.9),
            columns: ["full_growth", "full_hopf_friction"],
        },
        Curve {
            name: "reduced model",
            shape: Shape::OpenSquare,
            pen: Pen::solid(VERMILLION, 1.9),
            columns: ["growth", "hopf_friction"],
        },
    ]
}

/// The picture: growth rates and, with damping, the Hopf friction.
pub(crate) fn picture(modes: &Table) -> Picture {
    let curves = curves();
    let known = |name: &str| column(modes, name).into_iter().any(f64::is_finite);
    let mark = |curve: &Curve| Mark::new(curve.shape, SIZE, curve.pen.colour);
    let panel = |quantity, of: usize, height| {
        let mut layers = match modes.is_empty() {
            true => Layer::remark("no mode was asked for"),
            false => vec![Layer::Across(0.0, Pen::solid(GREY, 1.0))],
        };
        for curve in &curves {
            let values = column(modes, curve.columns[of]);
            let points: Vec<Point> = column(modes, "mode").into_iter().zip(values).collect();
            layers.push(Layer::Line(points.clone(), curve.pen));
            layers.push(Layer::Marks(points, mark(curve)));
        }
        let x = Axis::new(Quantity::new("mode", "k"), Extent::Data(0.04));
        Panel::new(x, Axis::new(quantity, Extent::Data(0.05)), layers).high(height)
    };
    let growth = Quantity::new("growth rate", "Re λ");
    // without damping every friction makes every mode grow: there is nothing to show
    let hopfs = |curve: &Curve| column(modes, curve.columns[1]);
    let panels = if curves.iter().flat_map(hopfs).any(|friction| friction > 0.0) {
        let friction = Quantity::new("Hopf friction", "f");
        vec![
            panel(growth, 0, HALF_HEIGHT),
            panel(friction, 1, HALF_HEIGHT),
        ]
    } else {
        vec![panel(growth, 0, HEIGHT)]
    };
    let entries = curves.iter().rev().filter(|curve| known(curve.columns[0]));
    let entries = entries.map(|curve| (Key::Mark(mark(curve)), curve.name));
    Picture::new(panels, Legend::default().with("", entries))
}
