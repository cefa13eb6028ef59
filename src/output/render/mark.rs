//! Points as they are drawn.

use plotters::style::RGBColor;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    pub shape: MarkShape,
    /// About half the width, in pixels.
    pub size: f64,
    pub colour: RGBColor,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MarkShape {
    Disc,
    /// One of many: without the white rim that sets others apart.
    Dot,
    Circle,
    Square,
    OpenSquare,
    Up,
    /// Outline of a triangle on its tip.
    OpenDown,
    Diamond,
    OpenDiamond,
    Star,
    Plus,
    Cross,
    Tick,
}

impl Mark {
    /// A mark of this look.
    pub(crate) fn new(shape: MarkShape, size: f64, colour: RGBColor) -> Mark {
        Mark {
            shape,
            size,
            colour,
        }
    }
}
