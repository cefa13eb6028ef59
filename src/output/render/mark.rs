//! Points as they are drawn.

use plotters::style::RGBColor;

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// Shape.
    pub shape: Shape,
    /// About half the width, in pixels.
    pub size: f64,
    /// Colour.
    pub colour: RGBColor,
}

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Shape {
    /// Disc.
    Disc,
    /// Circle.
    Circle,
    /// Filled square.
    Square,
    /// Square outline.
    OpenSquare,
    /// Triangle on its base.
    Up,
    /// Outline of a triangle on its tip.
    OpenDown,
    /// Filled rhombus.
    Diamond,
    /// Outline of a rhombus.
    OpenDiamond,
    /// Star with five points.
    Star,
    /// Upright cross.
    Plus,
    /// Diagonal cross.
    Cross,
    /// Short upright stroke.
    Tick,
}

impl Mark {
    /// A mark of this look.
    pub(crate) fn new(shape: Shape, size: f64, colour: RGBColor) -> Mark {
        Mark {
            shape,
            size,
            colour,
        }
    }
}
