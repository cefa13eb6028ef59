//! Colours that the colour-blind can tell apart (Okabe and Ito) and the patterns of lines.

use plotters::style::RGBColor;

pub(crate) const BLACK: RGBColor = RGBColor(0, 0, 0);
pub(crate) const WHITE: RGBColor = RGBColor(255, 255, 255);
/// For helper lines and what is left over.
pub(crate) const GREY: RGBColor = RGBColor(130, 130, 130);
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const PURPLE: RGBColor = RGBColor(204, 121, 167);
pub(crate) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(crate) const SKY: RGBColor = RGBColor(86, 180, 233);

/// Colours of categories, in the order of use; yellow is left out, it is lost on white paper.
pub(crate) const CATEGORIES: [RGBColor; 7] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, BLACK];

/// Colour at `position` in [0, 1] of an ordered scale whose lightness only grows.
pub(crate) fn ordered(position: f64) -> RGBColor {
    const ANCHORS: [RGBColor; 4] = [RGBColor(20, 20, 40), BLUE, GREEN, ORANGE];
    let position = if position.is_finite() { position } else { 0.0 };
    let scaled = position.clamp(0.0, 1.0) * (ANCHORS.len() - 1) as f64;
    let index = (scaled.floor() as usize).min(ANCHORS.len() - 2);
    mix(ANCHORS[index], ANCHORS[index + 1], scaled - index as f64)
}

/// `part` of the way from one colour to another.
pub(crate) fn mix(from: RGBColor, to: RGBColor, part: f64) -> RGBColor {
    let blend = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * part).round() as u8;
    RGBColor(
        blend(from.0, to.0),
        blend(from.1, to.1),
        blend(from.2, to.2),
    )
}

/// A colour as HTML and SVG write it.
pub(crate) fn hexadecimal(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pattern {
    Solid,
    Dashed,
    Dotted,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pen {
    pub colour: RGBColor,
    /// Width in pixels of the sheet.
    pub width: f64,
    pub pattern: Pattern,
}

impl Pen {
    pub(crate) fn solid(colour: RGBColor, width: f64) -> Self {
        Pen {
            colour,
            width,
            pattern: Pattern::Solid,
        }
    }

    /// A line of long strokes.
    pub(crate) fn dashed(colour: RGBColor, width: f64) -> Self {
        Pen {
            colour,
            width,
            pattern: Pattern::Dashed,
        }
    }
}
