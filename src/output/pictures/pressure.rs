//! Contact pressure over the wavelength.

use super::names::angle;
use super::profile::{NONE, Profiles};
use crate::output::render::axis::{Axis, Extent, Quantity};
use crate::output::render::palette::{GREY, Pen};
use crate::output::render::{Layer, Panel, Picture};

/// The picture.
pub(super) fn picture(profiles: &Profiles) -> Picture {
    let shown = profiles.shown();
    let mut layers = match shown.is_empty() {
        true => Layer::remark(NONE),
        // Zero is where contact is lost and belongs into the picture.
        false => vec![Layer::Across(0.0, Pen::solid(GREY, 1.2))],
    };
    layers.extend(shown.iter().map(|one| {
        let points = one.profile.over(|sample| sample.pressure);
        Layer::Line(points, Pen::solid(one.colour, 1.9))
    }));
    let x = Axis::new(angle(), Extent::Data(0.0));
    let y = Axis::new(Quantity::new("pressure", "P"), Extent::Data(0.05));
    Picture::new(vec![Panel::new(x, y, layers)], profiles.legend(&shown))
}
