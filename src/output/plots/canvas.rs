//! A sheet of SVG to draw on, in pixels of a column that is 510 wide.
//!
//! What cannot be seen is left out: marks that cover each other, and points of a long line that lie in
//! the same [`COLUMN`] as those around them. A file grows with what it shows, not with the tables.

use std::borrow::Cow;
use std::collections::HashSet;

use plotters::prelude::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle};

use super::error::PlotError;
use super::palette::{BLACK, GREY, Pattern, Pen, WHITE};

/// Width of every picture: 85 mm at six pixels per millimetre.
pub const WIDTH: f64 = 510.0;

/// Units of the file per pixel. The backend knows whole units only; curves need finer ones.
const UNITS: f64 = 10.0;

/// Families in the order of preference; the last one is always mapped on some font.
const FAMILY: &str = "Helvetica, Arial, sans-serif";

/// The backend writes font sizes divided by this.
const FONT_DIVISOR: f64 = 1.24;

/// Width in pixels within which the points of a long line are one upright stroke, and marks of one
/// shape and colour one mark: a quarter of the thinnest line.
const COLUMN: f64 = 0.25;

/// Points of a line up to which all are kept.
const LONG: usize = 4000;

/// A position in pixels, from the upper left corner.
pub type Place = (f64, f64);

/// Which point of a text lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Its left end.
    Left,
    /// Its middle.
    Middle,
    /// Its right end.
    Right,
}

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
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

/// The sheet.
pub struct Canvas<'a> {
    backend: SVGBackend<'a>,
    failure: Option<String>,
    /// Marks drawn so far: place and size in units of [`COLUMN`], shape, colour.
    marks: HashSet<(i64, i64, i64, Shape, [u8; 3])>,
}

/// Composes a picture of this height: hands a white sheet to `paint` and returns the file's text.
pub fn compose(height: f64, paint: impl FnOnce(&mut Canvas<'_>)) -> Result<String, PlotError> {
    let mut buffer = String::new();
    let size = (units(WIDTH).unsigned_abs(), units(height).unsigned_abs());
    let failure = {
        let mut canvas = Canvas {
            backend: SVGBackend::with_string(&mut buffer, size),
            failure: None,
            marks: HashSet::new(),
        };
        canvas.area((0.0, 0.0), (WIDTH, height), WHITE);
        paint(&mut canvas);
        let presented = canvas.backend.present();
        canvas.note(presented);
        canvas.failure.take()
    };
    if let Some(reason) = failure {
        return Err(PlotError::Compose(reason));
    }
    // Sizes in pixels outside, fine units inside; round joins, for mitres spike at sharp turns.
    let raw = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    let wanted = format!("width=\"{WIDTH}\" height=\"{height}\" stroke-linejoin=\"round\"");
    Ok(buffer.replacen(&raw, &wanted, 1))
}

impl Canvas<'_> {
    /// A line through the places.
    pub fn line(&mut self, places: &[Place], pen: Pen) {
        let places = &*thinned(places);
        // A stroke starts with its own length so that short lines show something.
        let strokes = match pen.pattern {
            Pattern::Solid => vec![places.to_vec()],
            Pattern::Dashed => pieces(places, 3.6 * pen.width.max(1.5), 2.0 * pen.width.max(1.5)),
            Pattern::Dotted => pieces(places, 1.0 * pen.width.max(1.5), 1.6 * pen.width.max(1.5)),
        };
        let style = ShapeStyle::from(&pen.colour).stroke_width(units(pen.width).unsigned_abs());
        for stroke in strokes.iter().filter(|stroke| stroke.len() > 1) {
            let drawn = self
                .backend
                .draw_path(stroke.iter().map(|place| coordinate(*place)), &style);
            self.note(drawn);
        }
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[Place], colour: RGBColor) {
        let corners = &*thinned(corners);
        let style = ShapeStyle::from(&colour).filled();
        let drawn = self
            .backend
            .fill_polygon(corners.iter().map(|place| coordinate(*place)), &style);
        self.note(drawn);
    }

    /// A filled rectangle.
    pub fn area(&mut self, from: Place, to: Place, colour: RGBColor) {
        let upper = (from.0.min(to.0), from.1.min(to.1));
        let lower = (from.0.max(to.0), from.1.max(to.1));
        let style = ShapeStyle::from(&colour).filled();
        let drawn = self
            .backend
            .draw_rect(coordinate(upper), coordinate(lower), &style, true);
        self.note(drawn);
    }

    /// A text standing on its base line.
    pub fn text(&mut self, place: Place, text: &str, size: f64, align: Align) {
        self.write(
            (place.0, place.1 - SHIFT * size),
            text,
            size,
            align,
            FontTransform::None,
            BLACK,
        );
    }

    /// A text in another colour.
    pub fn coloured_text(
        &mut self,
        place: Place,
        text: &str,
        size: f64,
        align: Align,
        colour: RGBColor,
    ) {
        self.write(
            (place.0, place.1 - SHIFT * size),
            text,
            size,
            align,
            FontTransform::None,
            colour,
        );
    }

    /// A text that reads upwards, its base line at the place, its middle there too.
    pub fn upward_text(&mut self, place: Place, text: &str, size: f64) {
        self.write(
            (place.0 - SHIFT * size, place.1),
            text,
            size,
            Align::Middle,
            FontTransform::Rotate270,
            BLACK,
        );
    }

    /// A point of this shape, `size` being about half its width, with a white rim.
    pub fn point(&mut self, place: Place, shape: Shape, size: f64, colour: RGBColor) {
        let cell = |value: f64| (value / COLUMN).round() as i64;
        let rgb = [colour.0, colour.1, colour.2];
        if !self
            .marks
            .insert((cell(place.0), cell(place.1), cell(size), shape, rgb))
        {
            return;
        }
        let outline = outline(place, shape, size);
        let stroke = 1.5;
        match shape {
            Shape::Disc | Shape::Square | Shape::Up | Shape::Diamond | Shape::Star => {
                self.polygon(&outline, colour);
                self.line(&closed(&outline), Pen::solid(WHITE, 1.0));
            }
            Shape::Circle | Shape::OpenSquare | Shape::OpenDown | Shape::OpenDiamond => {
                self.polygon(&outline, WHITE);
                self.line(&closed(&outline), Pen::solid(colour, stroke));
            }
            Shape::Plus | Shape::Cross | Shape::Tick => {
                for pair in outline.chunks(2) {
                    self.line(pair, Pen::solid(WHITE, 3.4));
                }
                for pair in outline.chunks(2) {
                    self.line(pair, Pen::solid(colour, 1.8));
                }
            }
        }
    }

    /// A grey remark in the middle of a rectangle, one line per line of text.
    pub fn remark(&mut self, from: Place, to: Place, text: &str, size: f64) {
        let middle = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        let lines: Vec<&str> = text.lines().collect();
        let top = middle.1 - 0.5 * 1.3 * size * (lines.len() as f64 - 1.0) + 0.35 * size;
        for (index, line) in lines.iter().enumerate() {
            let place = (middle.0, top + 1.3 * size * index as f64);
            self.coloured_text(place, line, size, Align::Middle, GREY);
        }
    }

    fn write(
        &mut self,
        place: Place,
        text: &str,
        size: f64,
        align: Align,
        transform: FontTransform,
        colour: RGBColor,
    ) {
        let horizontal = match align {
            Align::Left => HPos::Left,
            Align::Middle => HPos::Center,
            Align::Right => HPos::Right,
        };
        let style: TextStyle<'_> = (FAMILY, size * UNITS * FONT_DIVISOR)
            .into_font()
            .transform(transform)
            .color(&colour)
            .pos(Pos::new(horizontal, VPos::Center));
        // Characters that XML does not allow would spoil the file as a whole.
        let clean: String = text.chars().filter(|c| allowed(*c)).collect();
        let drawn = self.backend.draw_text(&clean, &style, coordinate(place));
        self.note(drawn);
    }

    /// Keeps the first failure for the end: callers draw on regardless.
    fn note<E: std::fmt::Display>(&mut self, result: Result<(), E>) {
        if let Err(error) = result
            && self.failure.is_none()
        {
            self.failure = Some(error.to_string());
        }
    }
}

/// How far below its place, in font sizes, the backend sets the base line: half an x-height.
const SHIFT: f64 = 0.26;

/// Whether XML 1.0 allows a character in a text, and it is to be seen.
fn allowed(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}')
}

/// A long line without the points that cannot be told apart: of successive ones in the same column the
/// first, the lowest, the highest and the last are kept.
fn thinned(places: &[Place]) -> Cow<'_, [Place]> {
    if places.len() <= LONG {
        return Cow::Borrowed(places);
    }
    let column = |place: &Place| (place.0 / COLUMN).floor();
    let mut kept = Vec::new();
    for group in places.chunk_by(|one, other| column(one) == column(other)) {
        let by_height = |one: &usize, other: &usize| group[*one].1.total_cmp(&group[*other].1);
        let last = group.len() - 1;
        let low = (0..=last).min_by(by_height).unwrap_or(0);
        let high = (0..=last).max_by(by_height).unwrap_or(0);
        let mut chosen = [0, low.min(high), low.max(high), last].to_vec();
        chosen.dedup();
        kept.extend(chosen.into_iter().map(|index| group[index]));
    }
    Cow::Owned(kept)
}

/// Generous estimate of a text's width; the font of the reader is not known.
pub fn text_width(text: &str, size: f64) -> f64 {
    text.chars()
        .map(|c| match c {
            '\u{300}'..='\u{36f}' => 0.0,
            'i' | 'j' | 'l' | '.' | ',' | '\'' | '|' | 'I' => 0.27,
            'f' | 't' | 'r' | ' ' | '(' | ')' | '-' | '[' | ']' => 0.36,
            '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' => 0.4,
            'm' | 'w' | 'M' | 'W' => 0.85,
            '\u{2212}' | '×' | '+' | '=' | '±' => 0.66,
            c if c.is_uppercase() => 0.68,
            _ => 0.57,
        })
        .sum::<f64>()
        * size
}

/// The text cut to a width, with an ellipsis in place of what is lost.
pub fn cut(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut kept = String::new();
    for c in text.chars() {
        kept.push(c);
        if text_width(&kept, size) + size > width {
            break;
        }
    }
    format!("{}…", kept.trim_end())
}

/// Units of a length. The conversion saturates; no picture is that large.
fn units(length: f64) -> i32 {
    (length * UNITS).round() as i32
}

fn coordinate(place: Place) -> (i32, i32) {
    // Far outside the sheet everything looks the same, and sums of units must not overflow.
    let limited = |value: f64| units(value.clamp(-1e6, 1e6));
    (limited(place.0), limited(place.1))
}

/// The polygon with its first corner repeated, and the second, so that the last corner is joined.
fn closed(outline: &[Place]) -> Vec<Place> {
    outline
        .iter()
        .chain(outline.iter().take(2))
        .copied()
        .collect()
}

/// Corners of a shape; pairs of ends for those made of strokes.
fn outline((x, y): Place, shape: Shape, size: f64) -> Vec<Place> {
    let turned = |angle: f64, radius: f64| {
        let (sine, cosine) = angle.to_radians().sin_cos();
        (x + radius * sine, y - radius * cosine)
    };
    match shape {
        Shape::Disc | Shape::Circle => (0..24).map(|i| turned(15.0 * f64::from(i), size)).collect(),
        Shape::Square | Shape::OpenSquare => {
            let half = 0.88 * size;
            vec![
                (x - half, y - half),
                (x + half, y - half),
                (x + half, y + half),
                (x - half, y + half),
            ]
        }
        Shape::Up => [0.0, 120.0, 240.0].map(|a| turned(a, 1.3 * size)).to_vec(),
        Shape::OpenDown => [60.0, 180.0, 300.0].map(|a| turned(a, 1.2 * size)).to_vec(),
        Shape::Diamond | Shape::OpenDiamond => vec![
            (x, y - 1.3 * size),
            (x + 1.05 * size, y),
            (x, y + 1.3 * size),
            (x - 1.05 * size, y),
        ],
        Shape::Star => (0..10)
            .map(|i| {
                let radius = if i % 2 == 0 { 1.45 } else { 0.6 };
                turned(36.0 * f64::from(i), radius * size)
            })
            .collect(),
        Shape::Plus => vec![(x - size, y), (x + size, y), (x, y - size), (x, y + size)],
        Shape::Cross => {
            let half = 0.85 * size;
            vec![
                (x - half, y - half),
                (x + half, y + half),
                (x - half, y + half),
                (x + half, y - half),
            ]
        }
        Shape::Tick => vec![(x, y - size), (x, y + size)],
    }
}

/// Cuts a line into strokes of length `on` with gaps of length `off`.
fn pieces(places: &[Place], on: f64, off: f64) -> Vec<Vec<Place>> {
    let mut strokes = Vec::new();
    let mut current = places.first().map(|place| vec![*place]).unwrap_or_default();
    let mut drawing = true;
    let mut left = on;
    for pair in places.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        if !length.is_finite() {
            continue;
        }
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let part = done / length;
            let place = (
                from.0 + part * (to.0 - from.0),
                from.1 + part * (to.1 - from.1),
            );
            if drawing {
                current.push(place);
                strokes.push(std::mem::take(&mut current));
            } else {
                current = vec![place];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
        left -= length - done;
        if drawing {
            current.push(to);
        }
    }
    if drawing {
        strokes.push(current);
    }
    strokes
}
