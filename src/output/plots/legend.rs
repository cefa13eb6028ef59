//! Explanations below a picture, where they cover nothing.

use plotters::style::RGBColor;

use super::canvas::{Align, Canvas, Shape, WIDTH, cut, text_width};
use super::palette::{BLACK, Pen};

/// Size of the texts.
pub const SIZE: f64 = 15.0;

/// Distance of the base lines.
const LINE: f64 = 21.0;

/// Distance between entries.
const GAP: f64 = 14.0;

/// Room on either side of the sheet.
const MARGIN: f64 = 12.0;

/// Most entries of a group; a spoiled table must not blow up the picture.
const MOST: usize = 40;

/// What stands in front of an explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Key {
    /// A piece of line.
    Line(Pen),
    /// A point.
    Point(Shape, f64, RGBColor),
    /// A coloured area.
    Area(RGBColor),
}

impl Key {
    fn width(self) -> f64 {
        match self {
            Key::Line(_) => 32.0,
            Key::Point(..) => 18.0,
            Key::Area(_) => 24.0,
        }
    }
}

/// A group of entries that starts on a line of its own.
#[derive(Clone, Debug, Default, PartialEq)]
struct Section {
    heading: String,
    entries: Vec<(Key, String)>,
}

/// All explanations of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Legend {
    sections: Vec<Section>,
}

/// An entry or a heading at its place.
struct Item<'a> {
    left: f64,
    line: usize,
    key: Option<Key>,
    text: &'a str,
}

impl Legend {
    /// Adds a group of entries with a heading, which may be empty.
    pub fn add(&mut self, heading: &str, entries: impl IntoIterator<Item = (Key, String)>) {
        let entries: Vec<_> = entries.into_iter().take(MOST).collect();
        if !(entries.is_empty() && heading.is_empty()) {
            self.sections.push(Section {
                heading: heading.to_owned(),
                entries,
            });
        }
    }

    /// Height of the legend.
    pub fn height(&self) -> f64 {
        match self.items().1 {
            0 => 0.0,
            lines => lines as f64 * LINE + 6.0,
        }
    }

    /// Draws the legend below `top`.
    pub fn paint(&self, canvas: &mut Canvas<'_>, top: f64) {
        for item in self.items().0 {
            let base = top + (item.line as f64 + 0.75) * LINE;
            let middle = base - 0.33 * SIZE;
            let mut left = item.left;
            match item.key {
                Some(Key::Line(pen)) => {
                    canvas.line(&[(left, middle), (left + 26.0, middle)], pen);
                }
                Some(Key::Point(shape, size, colour)) => {
                    canvas.point((left + 7.0, middle), shape, size, colour);
                }
                Some(Key::Area(colour)) => {
                    let (from, to) = ((left, middle - 6.0), (left + 18.0, middle + 6.0));
                    canvas.area(from, to, colour);
                    let outline = [
                        from,
                        (to.0, from.1),
                        to,
                        (from.0, to.1),
                        from,
                        (to.0, from.1),
                    ];
                    canvas.line(&outline, Pen::solid(BLACK, 0.8));
                }
                None => {}
            }
            left += item.key.map_or(0.0, Key::width);
            let text = cut(item.text, SIZE, WIDTH - MARGIN - left);
            canvas.text((left, base), &text, SIZE, Align::Left);
        }
    }

    /// Entries at their places, in columns as far as that takes no more lines, and the number of
    /// lines.
    fn items(&self) -> (Vec<Item<'_>>, usize) {
        let mut items = Vec::new();
        let mut line = 0;
        for section in &self.sections {
            let mut start = MARGIN;
            if !section.heading.is_empty() {
                items.push(Item {
                    left: MARGIN,
                    line,
                    key: None,
                    text: &section.heading,
                });
                start += text_width(&section.heading, SIZE) + GAP;
                if start > 0.55 * WIDTH {
                    line += 1;
                    start = MARGIN;
                }
            }
            let widths: Vec<f64> = section
                .entries
                .iter()
                .map(|(key, text)| key.width() + text_width(text, SIZE) + GAP)
                .collect();
            let room = WIDTH - MARGIN - start + GAP;
            let flowing = flow(&widths, room);
            let column = widths.iter().copied().fold(1.0, f64::max);
            let columns = vec![column; widths.len()];
            let aligned = flow(&columns, room);
            let lines = |places: &[(f64, usize)]| places.last().map_or(0, |place| place.1);
            let places = if lines(&aligned) <= lines(&flowing) {
                aligned
            } else {
                flowing
            };
            for ((key, text), (left, row)) in section.entries.iter().zip(&places) {
                items.push(Item {
                    left: start + left,
                    line: line + row,
                    key: Some(*key),
                    text,
                });
            }
            line += lines(&places) + 1;
        }
        (items, line)
    }
}

/// Left ends and lines of entries set one after the other.
fn flow(widths: &[f64], room: f64) -> Vec<(f64, usize)> {
    let (mut left, mut line) = (0.0, 0);
    widths
        .iter()
        .map(|width| {
            if left > 0.0 && left + width > room {
                left = 0.0;
                line += 1;
            }
            let place = (left, line);
            left += width;
            place
        })
        .collect()
}
