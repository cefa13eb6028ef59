//! Growth of the perturbations of steady sliding, and the friction where it begins, by mode.

use super::names::{Named, RATE, parameters};
use super::tables::column;
use crate::output::render::{
    Axis, BLUE, Extent, GREEN, GREY, HEIGHT, Key, Layer, Legend, Mark, MarkShape, Panel, Pen,
    Picture, Point, VERMILLION,
};
use crate::problem::Problem;
use crate::table::Table;
use crate::tube::model::Parameter;

/// Height of each of two panels.
const HALF_HEIGHT: f64 = 210.0;

const SIZE: f64 = 3.6;

/// A curve over the modes.
struct ModeCurve {
    name: &'static str,
    mark: Mark,
    pen: Pen,
    /// Growth rates, and the friction at the Hopf points.
    values: [Vec<f64>; 2],
}

impl ModeCurve {
    /// The curve of the columns that begin with a word.
    fn of(modes: &Table, word: &str, name: &'static str, shape: MarkShape, pen: Pen) -> ModeCurve {
        let columns = ["growth", "hopf_friction"].map(|quantity| format!("{word}{quantity}"));
        ModeCurve {
            name,
            mark: Mark::new(shape, SIZE, pen.colour),
            pen,
            values: columns.map(|name| column(modes, &name)),
        }
    }
}

/// The picture: growth rates and, with damping, the Hopf friction.
pub(crate) fn picture(modes: &Table, problem: Option<&Problem>) -> Picture {
    let solid = |colour| Pen::solid(colour, 1.9);
    let dashed = Pen::dashed(GREEN, 1.6);
    // the last one on top
    let curves = [
        ModeCurve::of(
            modes,
            "lead_",
            "tube, leading family",
            MarkShape::Up,
            dashed,
        ),
        ModeCurve::of(
            modes,
            "full_",
            "tube, fundamental family",
            MarkShape::Disc,
            solid(BLUE),
        ),
        ModeCurve::of(
            modes,
            "",
            "reduced model",
            MarkShape::OpenSquare,
            solid(VERMILLION),
        ),
    ];
    let panel = |quantity: Named, of: usize, height| {
        let mut layers = vec![Layer::Across(0.0, Pen::solid(GREY, 1.0))];
        for curve in &curves {
            let values = curve.values[of].iter().copied();
            let points: Vec<Point> = column(modes, "mode").into_iter().zip(values).collect();
            layers.push(Layer::Line(points.clone(), curve.pen));
            layers.push(Layer::Marks(points, curve.mark));
        }
        let x = Axis::new(("mode", "k"), Extent::Data(0.04));
        let panel = Panel::new(x, Axis::new(quantity, Extent::Data(0.05)), layers).high(height);
        panel.unless(modes.is_empty(), "no mode was asked for")
    };
    let growth = ("growth rate", "Re λ", RATE);
    // without damping every friction makes every mode grow: there is nothing to show
    let mut hopf = curves.iter().flat_map(|curve| &curve.values[1]);
    let panels = match hopf.any(|friction| *friction > 0.0) {
        true => vec![
            panel(growth, 0, HALF_HEIGHT),
            panel(("Hopf friction", "f", ""), 1, HALF_HEIGHT),
        ],
        false => vec![panel(growth, 0, HEIGHT)],
    };
    let known = |curve: &&ModeCurve| curve.values[0].iter().any(|growth| growth.is_finite());
    let entries = curves.iter().rev().filter(known);
    let entries = entries.map(|curve| (Key::Mark(curve.mark), curve.name));
    let mut legend = Legend::default().with("", entries);
    if let Some(problem) = problem {
        // the mismatch changes nothing under Coulomb's law
        legend = legend.with::<&str>(&parameters(problem, &[Parameter::Mismatch]), []);
    }
    Picture::new(panels, legend).titled(Some("Perturbations of steady sliding, by mode"))
}
