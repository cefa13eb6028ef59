//! Explanations below a picture, where they cover nothing.

use plotters::style::RGBColor;

use super::mark::Mark;
use super::palette::{BLACK, Pen};
use super::surface::{Align, Drawn, Surface, Text, WIDTH};
use super::text::width;

const SIZE: f64 = 15.0;

/// Distance of the base lines.
const LINE: f64 = 21.0;

const GAP: f64 = 14.0;

/// Room on either side of the sheet.
const MARGIN: f64 = 12.0;

/// Most entries of a group; a spoiled table must not blow up the picture.
const MOST: usize = 40;

/// What stands in front of an explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Key {
    Line(Pen),
    Mark(Mark),
    Area(RGBColor),
    /// Leaning lines over an area.
    Hatched(Pen, RGBColor),
    /// Nothing: the text begins with what it explains.
    Word,
}

impl Key {
    fn width(self) -> f64 {
        match self {
            Key::Line(_) => 32.0,
            Key::Mark(_) => 18.0,
            Key::Area(_) | Key::Hatched(..) => 24.0,
            Key::Word => 0.0,
        }
    }
}

/// A group of entries that starts on a line of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LegendGroup {
    /// Text in front of the entries; may be empty.
    pub heading: String,
    pub entries: Vec<(Key, String)>,
}

/// All explanations of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Legend {
    /// The groups from top to bottom.
    pub groups: Vec<LegendGroup>,
}

/// An entry or a heading at its place.
struct LegendItem<'a> {
    left: f64,
    line: usize,
    key: Option<Key>,
    text: &'a str,
}

impl Legend {
    /// The legend with one more group, unless that says nothing.
    pub(crate) fn with<T: Into<String>>(
        mut self,
        heading: &str,
        entries: impl IntoIterator<Item = (Key, T)>,
    ) -> Legend {
        let entries = entries.into_iter().take(MOST);
        let entries: Vec<_> = entries.map(|(key, text)| (key, text.into())).collect();
        if !(entries.is_empty() && heading.is_empty()) {
            let heading = heading.to_owned();
            self.groups.push(LegendGroup { heading, entries });
        }
        self
    }

    pub(super) fn height(&self) -> f64 {
        match self.items().1 {
            0 => 0.0,
            lines => lines as f64 * LINE + 6.0,
        }
    }

    /// Draws the legend below `top`.
    pub(super) fn paint(&self, on: &mut dyn Surface, top: f64) -> Drawn {
        for item in self.items().0 {
            let (mut left, base) = (item.left, top + (item.line as f64 + 0.75) * LINE);
            let middle = base - 0.33 * SIZE;
            match item.key {
                Some(Key::Line(pen)) => on.line(&[(left, middle), (left + 26.0, middle)], pen)?,
                Some(Key::Mark(mark)) => on.mark((left + 7.0, middle), mark)?,
                Some(Key::Area(colour)) => {
                    let (from, to) = ((left, middle - 6.0), (left + 18.0, middle + 6.0));
                    on.area(from, to, colour)?;
                    let corners = [from, (to.0, from.1), to, (from.0, to.1)];
                    on.outline(&corners, Pen::solid(BLACK, 0.8))?;
                }
                Some(Key::Hatched(pen, colour)) => {
                    let (from, to) = ((left, middle - 6.0), (left + 18.0, middle + 6.0));
                    on.area(from, to, colour)?;
                    for foot in [0.0, 6.0, 12.0] {
                        let foot = (left + foot, to.1);
                        on.line(&[foot, (foot.0 + 6.0, from.1)], pen)?;
                    }
                    let corners = [from, (to.0, from.1), to, (from.0, to.1)];
                    on.outline(&corners, Pen::solid(BLACK, 0.8))?;
                }
                Some(Key::Word) | None => {}
            }
            left += item.key.map_or(0.0, Key::width);
            let text = Text::new((left, base), item.text, SIZE, Align::Left);
            on.text(text.within(WIDTH - MARGIN - left))?;
        }
        Ok(())
    }

    /// Entries at their places, in columns as far as that takes no more lines, and the number of
    /// lines.
    fn items(&self) -> (Vec<LegendItem<'_>>, usize) {
        let mut items = Vec::new();
        let mut line = 0;
        for group in &self.groups {
            let mut start = MARGIN;
            if !group.heading.is_empty() {
                items.push(LegendItem {
                    left: MARGIN,
                    line,
                    key: None,
                    text: &group.heading,
                });
                start += width(&group.heading, SIZE) + GAP;
                if start > 0.55 * WIDTH && !group.entries.is_empty() {
                    line += 1;
                    start = MARGIN;
                }
            }
            let room = WIDTH - MARGIN - start + GAP;
            let full = |(key, text): &(Key, String)| key.width() + width(text, SIZE) + GAP;
            let widths: Vec<f64> = group.entries.iter().map(full).collect();
            let column = widths.iter().copied().fold(1.0, f64::max);
            let aligned = flow(&vec![column; widths.len()], room);
            let flowing = flow(&widths, room);
            let last = |places: &[(f64, usize)]| places.last().map_or(0, |place| place.1);
            let places = match last(&aligned) <= last(&flowing) {
                true => aligned,
                false => flowing,
            };
            let placed = group.entries.iter().zip(&places);
            items.extend(placed.map(|((key, text), (left, row))| LegendItem {
                left: start + left,
                line: line + row,
                key: Some(*key),
                text,
            }));
            line += last(&places) + 1;
        }
        (items, line)
    }
}

/// Left ends and lines of entries set one after the other.
fn flow(widths: &[f64], room: f64) -> Vec<(f64, usize)> {
    let (mut left, mut line) = (0.0, 0);
    let place = |width: &f64| {
        if left > 0.0 && left + width > room {
            left = 0.0;
            line += 1;
        }
        let place = (left, line);
        left += width;
        place
    };
    widths.iter().map(place).collect()
}
