//! A panel at its place on the sheet.

use super::axis::{Scale, drawable};
use super::picture::Point;
use super::surface::Place;

/// Size of the texts along the axes.
pub(super) const CAPTION_SIZE: f64 = 18.0;

/// A frame on a sheet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PanelFrame {
    pub from: Place,
    pub to: Place,
    pub x: Scale,
    pub y: Scale,
    /// Room for the figures of the vertical axis, the same in all frames below each other.
    pub figures: f64,
    /// Whether figures and caption stand below the frame.
    pub labelled_below: bool,
}

impl PanelFrame {
    /// Where a point of the data lies; none for what cannot be drawn.
    pub(crate) fn place(&self, (x, y): Point) -> Option<Place> {
        (drawable(x) && drawable(y)).then(|| self.at(self.x.part(x), self.y.part(y)))
    }

    /// A place by its parts of the axes.
    pub(super) fn at(&self, across: f64, up: f64) -> Place {
        (
            self.from.0 + across * (self.to.0 - self.from.0),
            self.to.1 - up * (self.to.1 - self.from.1),
        )
    }
}
