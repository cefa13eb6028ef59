//! Tangential and radial displacement over the wavelength.

use super::names::angle;
use super::profile::{NONE, Profiles, Sample};
use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::palette::Pen;
use crate::output::render::{Layer, Panel, Picture};

/// Height of each panel.
const HEIGHT: f64 = 180.0;

/// The picture.
pub(super) fn picture(profiles: &Profiles) -> Picture {
    let shown = profiles.shown();
    let panel = |quantity, value: fn(&Sample) -> f64| {
        let mut layers = match shown.is_empty() {
            true => Layer::remark(NONE),
            false => Vec::new(),
        };
        layers.extend(shown.iter().map(|one| {
            let pen = Pen::solid(one.colour, 1.9);
            Layer::Line(one.profile.over(value), pen)
        }));
        let x = Axis::new(angle(), Extent::Data(0.0));
        Panel::new(x, Axis::new(quantity, Extent::Data(0.06)), layers).high(HEIGHT)
    };
    let panels = vec![
        panel(Quantity::new("tangential", "V"), |sample| sample.tangential),
        panel(Quantity::new("radial", "U"), |sample| sample.radial),
    ];
    Picture::new(panels, profiles.legend(&shown))
}
