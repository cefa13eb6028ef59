//! A sheet of SVG to draw on, in pixels of a column that is 510 wide.
//!
//! Of plotters only the SVG backend is used. Its charts do not make a picture for a journal: the legend
//! is one column over the curves, without headings; widths of texts are 0.7 of their size per byte;
//! panels do not share figures; captions know no common factor or base; coordinates are whole pixels.
//!
//! What cannot be seen is left out: marks that cover each other, and points of a long line that lie in
//! the same [`COLUMN`] as those around them. A file grows with what it shows, not with the tables.

use std::borrow::Cow;
use std::collections::HashSet;
use std::error::Error;

use plotters::element::{DashedPathElement, Drawable};
use plotters::prelude::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle};

use super::frame::PanelFrame;
use super::mark::{Mark, MarkShape};
use super::paint::Sheet;
use super::palette::{Pattern, Pen, WHITE};
use super::picture::Layer;
use super::surface::{Align, Drawn, Place, RenderError, Surface, Text, WIDTH};
use super::text::{clean, cut};

/// Units of the file per pixel. The backend knows whole units only; curves need finer ones.
const UNITS: f64 = 10.0;

/// Families in the order of preference; the last one is always mapped on some font.
const FAMILY: &str = "Helvetica, Arial, sans-serif";

/// The backend writes font sizes divided by this.
const FONT_DIVISOR: f64 = 1.24;

/// How far below its place, in font sizes, the backend sets the base line: half an x-height.
const SHIFT: f64 = 0.26;

/// Width in pixels within which the points of a long line are one upright stroke, and marks of one
/// shape and colour one mark: a quarter of the thinnest line.
const COLUMN: f64 = 0.25;

/// Points of a line up to which all are kept.
const LONG: usize = 4000;

pub(super) struct Canvas<'a> {
    backend: SVGBackend<'a>,
    size: (u32, u32),
    /// Marks drawn so far: place and size in units of [`COLUMN`], shape, colour.
    marks: HashSet<([i64; 3], MarkShape, [u8; 3])>,
}

/// Composes a picture of this height: hands a white sheet to `paint` and returns the file's text.
pub(super) fn compose(
    height: f64,
    paint: impl FnOnce(&mut Canvas<'_>) -> Drawn,
) -> Result<String, RenderError> {
    let mut buffer = String::new();
    let size = (units(WIDTH).unsigned_abs(), units(height).unsigned_abs());
    {
        let mut canvas = Canvas {
            backend: SVGBackend::with_string(&mut buffer, size),
            size,
            marks: HashSet::new(),
        };
        canvas.area((0.0, 0.0), (WIDTH, height), WHITE)?;
        paint(&mut canvas)?;
        canvas.backend.present().map_err(refused)?;
    }
    // Sizes in pixels outside, fine units inside; round joins, for mitres spike at sharp turns.
    let raw = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    let wanted = format!("width=\"{WIDTH}\" height=\"{height}\" stroke-linejoin=\"round\"");
    Ok(buffer.replacen(&raw, &wanted, 1))
}

impl Surface for Canvas<'_> {
    fn line(&mut self, places: &[Place], pen: Pen) -> Drawn {
        let places = coordinates(places);
        if places.len() < 2 {
            return Ok(());
        }
        let style = ShapeStyle::from(&pen.colour).stroke_width(units(pen.width).unsigned_abs());
        let (on, off) = match pen.pattern {
            Pattern::Solid => {
                let drawn = self.backend.draw_path(places, &style);
                return drawn.map_err(refused);
            }
            Pattern::Dashed => (3.6, 2.0),
            Pattern::Dotted => (1.0, 1.6),
        };
        let unit = pen.width.max(1.5);
        let dashes = (units(on * unit), units(off * unit));
        let line = DashedPathElement::new(places.iter().copied(), dashes.0, dashes.1, style);
        line.draw(places.iter().copied(), &mut self.backend, self.size)
            .map_err(refused)
    }

    fn area(&mut self, from: Place, to: Place, colour: RGBColor) -> Drawn {
        let upper = (from.0.min(to.0), from.1.min(to.1));
        let lower = (from.0.max(to.0), from.1.max(to.1));
        let style = ShapeStyle::from(&colour).filled();
        self.backend
            .draw_rect(coordinate(&upper), coordinate(&lower), &style, true)
            .map_err(refused)
    }

    fn polygon(&mut self, corners: &[Place], colour: RGBColor) -> Drawn {
        let corners = coordinates(corners);
        let style = ShapeStyle::from(&colour).filled();
        let drawn = self.backend.fill_polygon(corners, &style);
        drawn.map_err(refused)
    }

    fn text(&mut self, text: Text<'_>) -> Drawn {
        let ((x, y), size) = (text.place, text.size);
        let above = (x, y - SHIFT * size);
        let (horizontal, transform, place) = match text.align {
            Align::Left => (HPos::Left, FontTransform::None, above),
            Align::Middle => (HPos::Center, FontTransform::None, above),
            Align::Right => (HPos::Right, FontTransform::None, above),
            Align::Upward => (
                HPos::Center,
                FontTransform::Rotate270,
                (x - SHIFT * size, y),
            ),
        };
        let style: TextStyle<'_> = (FAMILY, size * UNITS * FONT_DIVISOR)
            .into_font()
            .transform(transform)
            .color(&text.colour)
            .pos(Pos::new(horizontal, VPos::Center));
        let shown = clean(&cut(text.text, size, text.room));
        self.backend
            .draw_text(&shown, &style, coordinate(&place))
            .map_err(refused)
    }

    fn mark(&mut self, place: Place, mark: Mark) -> Drawn {
        let cells = [place.0, place.1, mark.size].map(|value| (value / COLUMN).round() as i64);
        let colour = mark.colour;
        let key = (cells, mark.shape, [colour.0, colour.1, colour.2]);
        if !self.marks.insert(key) {
            return Ok(());
        }
        let outline = outline(place, mark.shape, mark.size);
        match mark.shape {
            MarkShape::Dot => self.polygon(&outline, colour),
            MarkShape::Disc
            | MarkShape::Square
            | MarkShape::Up
            | MarkShape::Diamond
            | MarkShape::Star => {
                self.polygon(&outline, colour)?;
                self.outline(&outline, Pen::solid(WHITE, 1.0))
            }
            MarkShape::Circle
            | MarkShape::OpenSquare
            | MarkShape::OpenDown
            | MarkShape::OpenDiamond => {
                self.polygon(&outline, WHITE)?;
                self.outline(&outline, Pen::solid(colour, 1.5))
            }
            MarkShape::Plus | MarkShape::Cross | MarkShape::Tick => {
                for pen in [Pen::solid(WHITE, 3.4), Pen::solid(colour, 1.8)] {
                    for stroke in outline.chunks(2) {
                        self.line(stroke, pen)?;
                    }
                }
                Ok(())
            }
        }
    }
}

impl Sheet for Canvas<'_> {
    fn panel(&mut self, frame: &PanelFrame, layers: &[Layer]) -> Drawn {
        frame.paint(self, layers)
    }

    fn border(&mut self, frame: &PanelFrame) -> Drawn {
        frame.border(self)
    }
}

fn refused(error: impl Error + Send + Sync + 'static) -> RenderError {
    RenderError::Compose(Box::new(error))
}

/// A long line without the points that cannot be told apart: of successive ones in the same column the
/// first, the lowest, the highest and the last are kept.
pub(super) fn thinned<T: Copy>(points: &[T], place: impl Fn(&T) -> Place) -> Cow<'_, [T]> {
    if points.len() <= LONG {
        return Cow::Borrowed(points);
    }
    let column = |point: &T| (place(point).0 / COLUMN).floor();
    let mut kept = Vec::new();
    for group in points.chunk_by(|one, other| column(one) == column(other)) {
        let height = |index: usize| place(&group[index]).1;
        let by_height = |one: &usize, other: &usize| height(*one).total_cmp(&height(*other));
        let last = group.len() - 1;
        let low = (0..=last).min_by(by_height).unwrap_or(0);
        let high = (0..=last).max_by(by_height).unwrap_or(0);
        let mut chosen = [0, low.min(high), low.max(high), last].to_vec();
        chosen.dedup();
        kept.extend(chosen.into_iter().map(|index| group[index]));
    }
    Cow::Owned(kept)
}

/// Units of a length. The conversion saturates; no picture is that large.
fn units(length: f64) -> i32 {
    (length * UNITS).round() as i32
}

fn coordinates(places: &[Place]) -> Vec<(i32, i32)> {
    let seen = thinned(places, |place| *place);
    seen.iter().map(coordinate).collect()
}

fn coordinate(place: &Place) -> (i32, i32) {
    // Far outside the sheet everything looks the same, and sums of units must not overflow.
    let limited = |value: f64| units(value.clamp(-1e6, 1e6));
    (limited(place.0), limited(place.1))
}

/// Corners of a shape; pairs of ends for those made of strokes.
fn outline((x, y): Place, shape: MarkShape, size: f64) -> Vec<Place> {
    let turned = |degrees: f64, radius: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        (radius * sine, -radius * cosine)
    };
    let offsets = match shape {
        MarkShape::Dot => (0..6).map(|i| turned(60.0 * f64::from(i), 1.0)).collect(),
        MarkShape::Disc | MarkShape::Circle => {
            (0..24).map(|i| turned(15.0 * f64::from(i), 1.0)).collect()
        }
        MarkShape::Square | MarkShape::OpenSquare => {
            vec![(-0.88, -0.88), (0.88, -0.88), (0.88, 0.88), (-0.88, 0.88)]
        }
        MarkShape::Up => [0.0, 120.0, 240.0].map(|a| turned(a, 1.3)).to_vec(),
        MarkShape::OpenDown => [60.0, 180.0, 300.0].map(|a| turned(a, 1.2)).to_vec(),
        MarkShape::Diamond | MarkShape::OpenDiamond => {
            vec![(0.0, -1.3), (1.05, 0.0), (0.0, 1.3), (-1.05, 0.0)]
        }
        MarkShape::Star => (0..10)
            .map(|i| turned(36.0 * f64::from(i), if i % 2 == 0 { 1.45 } else { 0.6 }))
            .collect(),
        MarkShape::Plus => vec![(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)],
        MarkShape::Cross => vec![(-0.85, -0.85), (0.85, 0.85), (-0.85, 0.85), (0.85, -0.85)],
        MarkShape::Tick => vec![(0.0, -1.0), (0.0, 1.0)],
    };
    let placed = offsets
        .into_iter()
        .map(|(dx, dy)| (x + size * dx, y + size * dy));
    placed.collect()
}

/// The path of a mark around the origin as SVG writes it, and how it is painted: `solid`, `hollow`, or as strokes, `ink`.
pub(crate) fn path(mark: Mark) -> (String, &'static str) {
    let corners = outline((0.0, 0.0), mark.shape, mark.size);
    let corners: Vec<String> = corners
        .iter()
        .map(|(x, y)| format!("{x:.1} {y:.1}"))
        .collect();
    let (parts, end, look) = match mark.shape {
        MarkShape::Dot
        | MarkShape::Disc
        | MarkShape::Square
        | MarkShape::Up
        | MarkShape::Diamond
        | MarkShape::Star => (corners.len(), "z", "solid"),
        MarkShape::Circle
        | MarkShape::OpenSquare
        | MarkShape::OpenDown
        | MarkShape::OpenDiamond => (corners.len(), "z", "hollow"),
        MarkShape::Plus | MarkShape::Cross | MarkShape::Tick => (2, "", "ink"),
    };
    let parts = corners.chunks(parts);
    let parts = parts.map(|part| format!("M{}{end}", part.join("L")));
    (parts.collect(), look)
}
