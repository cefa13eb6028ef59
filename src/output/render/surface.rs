//! What a picture is drawn on, and the pieces that stand outside of the data: the same for SVG and TeX.

use std::error::Error;

use plotters::style::RGBColor;

use super::mark::Mark;
use super::palette::{BLACK, Pen};

/// Width of every picture: 85 mm at six pixels per millimetre.
pub(super) const WIDTH: f64 = 510.0;

/// Failure to render a picture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum RenderError {
    /// PNG and PDF were left out when the program was built.
    #[error("this build writes SVG and TeX only; build it with the feature `raster` for {0}")]
    FormatMissing(&'static str),
    #[error("cannot compose the picture: {0}")]
    Compose(Box<dyn Error + Send + Sync>),
    /// The picture could not be converted.
    #[error("cannot convert the picture to {format}: {source}")]
    #[cfg_attr(not(feature = "raster"), allow(dead_code))] // SVG needs no conversion
    Convert {
        format: &'static str,
        source: Box<dyn Error + Send + Sync>,
    },
}

/// A position in pixels, from the upper left corner.
pub(super) type Place = (f64, f64);

/// Whether something could be drawn.
pub(super) type Drawn = Result<(), RenderError>;

/// Which point of a text, on its base line, lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Middle,
    Right,
    /// Its middle, and it reads upwards.
    Upward,
}

/// A text standing on its base line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Text<'a> {
    pub place: Place,
    pub text: &'a str,
    pub size: f64,
    pub align: Align,
    pub colour: RGBColor,
    /// Width that it is cut to where nobody else sets it.
    pub room: f64,
}

impl<'a> Text<'a> {
    /// A text in black, as long as it is.
    pub(crate) fn new(place: Place, text: &'a str, size: f64, align: Align) -> Text<'a> {
        Text {
            place,
            text,
            size,
            align,
            colour: BLACK,
            room: f64::INFINITY,
        }
    }

    /// The text cut to a width.
    pub(crate) fn within(self, room: f64) -> Text<'a> {
        Text { room, ..self }
    }

    /// The text in another colour.
    pub(crate) fn coloured(self, colour: RGBColor) -> Text<'a> {
        Text { colour, ..self }
    }
}

/// A sheet to draw on.
pub(super) trait Surface {
    /// A line through the places.
    fn line(&mut self, places: &[Place], pen: Pen) -> Drawn;

    fn area(&mut self, from: Place, to: Place, colour: RGBColor) -> Drawn;

    fn polygon(&mut self, corners: &[Place], colour: RGBColor) -> Drawn;

    /// A point with a white rim.
    fn mark(&mut self, place: Place, mark: Mark) -> Drawn;

    fn text(&mut self, text: Text<'_>) -> Drawn;

    fn outline(&mut self, corners: &[Place], pen: Pen) -> Drawn {
        // the second corner, too, so that the last one is joined
        let repeated = corners.iter().take(2);
        let closed: Vec<Place> = corners.iter().chain(repeated).copied().collect();
        self.line(&closed, pen)
    }
}
