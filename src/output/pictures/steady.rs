//! Growth of the perturbations of steady sliding, and the friction where it begins, by mode.

use super::tables::column;
use crate::output::render::{
    Axis, BLUE, Extent, GREEN, GREY, HEIGHT, Key, Layer, Legend, Mark, Panel, Pen, Picture, Point,
    Shape, VERMILLION,
};
use crate::table::Table;

/// Height of each of two panels.
const HALF_HEIGHT: f64 = 210.0;

/// Size of the points.
const SIZE: f64 = 3.6;

/// Curves over the modes, the last one on top: name, shape, line, and the columns of the growth rate and of
/// the friction at the Hopf point.
type Curve = (&'static str, Shape, Pen, [&'static str; 2]);

fn curves() -> [Curve; 3] {
    let leading = ["lead_growth", "lead_hopf_friction"];
    let fundamental = ["full_growth", "full_hopf_friction"];
    let reduced = ["growth", "hopf_friction"];
    let solid = |colour| Pen::solid(colour, 1.9);
    [
        (
            "tube, leading family",
            Shape::Up,
            Pen::dashed(GREEN, 1.6),
            leading,
        ),
        (
            "tube, fundamental family",
            Shape::Disc,
            solid(BLUE),
            fundamental,
        ),
        (
            "reduced model",
            Shape::OpenSquare,
            solid(VERMILLION),
            reduced,
        ),
    ]
}

/// The picture: growth rates and, with damping, the Hopf friction.
pub(crate) fn picture(modes: &Table) -> Picture {
    let curves = curves();
    let known = |name: &str| column(modes, name).into_iter().any(f64::is_finite);
    let mark = |(_, shape, pen, _): &Curve| Mark::new(*shape, SIZE, pen.colour);
    let panel = |quantity, of: usize, height| {
        let mut layers = vec![Layer::Across(0.0, Pen::solid(GREY, 1.0))];
        for curve in &curves {
            let values = column(modes, curve.3[of]);
            let points: Vec<Point> = column(modes, "mode").into_iter().zip(values).collect();
            layers.push(Layer::Line(points.clone(), curve.2));
            layers.push(Layer::Marks(points, mark(curve)));
        }
        let x = Axis::new(("mode", "k"), Extent::Data(0.04));
        let panel = Panel::new(x, Axis::new(quantity, Extent::Data(0.05)), layers).high(height);
        panel.unless(modes.is_empty(), "no mode was asked for")
    };
    let growth = ("growth rate", "Re λ");
    // without damping every friction makes every mode grow: there is nothing to show
    let hopfs = |curve: &Curve| column(modes, curve.3[1]);
    let panels = if curves.iter().flat_map(hopfs).any(|friction| friction > 0.0) {
        let friction = ("Hopf friction", "f");
        vec![
            panel(growth, 0, HALF_HEIGHT),
            panel(friction, 1, HALF_HEIGHT),
        ]
    } else {
        vec![panel(growth, 0, HEIGHT)]
    };
    let entries = curves.iter().rev().filter(|curve| known(curve.3[0]));
    let entries = entries.map(|curve| (Key::Mark(mark(curve)), curve.0));
    Picture::new(panels, Legend::default().with("", entries))
}
