//! What stands in and around a frame, drawn on a surface.

use super::axis::{Scale, TICK_SIZE, Tick};
use super::frame::{CAPTION_SIZE, PanelFrame};
use super::palette::{BLACK, GREY, Pen};
use super::picture::{ColourCell, Heading, Layer, Point};
use super::placement::{NAME_SIZE, written};
use super::surface::{Align, Drawn, Place, Surface, Text};
use super::text::width;

/// Size of small texts beside a frame.
const SMALL: f64 = 0.88 * TICK_SIZE;

const TICK: f64 = 6.0;

/// Width of the rim of areas: without it paper shows between areas that only touch.
const RIM: f64 = 0.8;

/// How far cells reach over their upper edge, for the same reason, in pixels.
const SEAM: f64 = 1.0;

/// A sheet that takes panels.
pub(super) trait Sheet: Surface {
    /// What is drawn in a frame.
    fn panel(&mut self, frame: &PanelFrame, layers: &[Layer]) -> Drawn;

    /// A frame with its ticks, figures and captions, over all panels.
    fn border(&mut self, frame: &PanelFrame) -> Drawn;
}

impl PanelFrame {
    pub(crate) fn paint(&self, canvas: &mut dyn Surface, layers: &[Layer]) -> Drawn {
        layers.iter().try_for_each(|layer| match layer {
            Layer::Line(points, pen) => {
                let places: Vec<_> = points.iter().map(|point| self.place(*point)).collect();
                let unbroken = places
                    .split(Option::is_none)
                    .map(|stretch| stretch.iter().flatten());
                unbroken
                    .map(|stretch| stretch.copied().collect::<Vec<Place>>())
                    .try_for_each(|stretch| canvas.line(&stretch, *pen))
            }
            Layer::Across(y, pen) => {
                let up = self.y.part(*y);
                canvas.line(&[self.at(0.0, up), self.at(1.0, up)], *pen)
            }
            Layer::Upright(x, pen) => {
                let across = self.x.part(*x);
                canvas.line(&[self.at(across, 0.0), self.at(across, 1.0)], *pen)
            }
            Layer::Marks(points, mark) => {
                let mut places = points.iter().filter_map(|point| self.place(*point));
                places.try_for_each(|place| canvas.mark(place, *mark))
            }
            Layer::Area(corners, colour) => {
                let corners: Vec<_> = corners.iter().filter_map(|p| self.place(*p)).collect();
                canvas.polygon(&corners, *colour)?;
                canvas.line(&corners, Pen::solid(*colour, RIM))
            }
            Layer::Cells(cells) => cells.iter().try_for_each(|cell| self.cell(canvas, cell)),
            layer => self.outside(canvas, layers, layer),
        })
    }

    /// Draws a layer of texts, which the frame does not clip.
    pub(super) fn outside(&self, on: &mut dyn Surface, layers: &[Layer], layer: &Layer) -> Drawn {
        match layer {
            Layer::Names(names) => {
                let mut texts = written(self, layers, names).into_iter();
                texts.try_for_each(|((x, y), text)| {
                    let base = (x, y + 0.36 * NAME_SIZE);
                    on.text(Text::new(base, text, NAME_SIZE, Align::Middle))
                })
            }
            Layer::Headings(headings) => {
                let mut texts = headings.iter().filter_map(|heading| self.heading(heading));
                texts.try_for_each(|text| on.text(text))
            }
            Layer::Bar { foot, head, text } => self.bar(on, [*foot, *head], text),
            Layer::Remark(text) => {
                let (x, y) = self.at(0.5, 0.5);
                let base = (x, y + 0.35 * TICK_SIZE);
                on.text(Text::new(base, text, TICK_SIZE, Align::Middle).coloured(GREY))
            }
            _ => Ok(()),
        }
    }

    fn cell(&self, canvas: &mut dyn Surface, cell: &ColourCell) -> Drawn {
        let within = |scale: &Scale, value: f64| match value {
            value if value.is_nan() => None,
            value => Some(scale.part(value).clamp(0.0, 1.0)),
        };
        let place = |(x, y): Point| Some(self.at(within(&self.x, x)?, within(&self.y, y)?));
        let (Some(from), Some(to)) = (place(cell.from), place(cell.to)) else {
            return Ok(());
        };
        // over the seam to what comes next, which is drawn on top
        canvas.area(from, (to.0, to.1 - SEAM), cell.colour)
    }

    /// The name of a stretch that fits.
    fn heading<'a>(&self, heading: &'a Heading) -> Option<Text<'a>> {
        let [from, to] = heading.ends.map(|end| self.at(self.x.part(end), 1.0));
        let fits = |text: &&String| width(text, SMALL) <= to.0 - from.0;
        let text = heading.names.iter().find(fits)?;
        let base = (0.5 * (from.0 + to.0), from.1 - 5.0);
        Some(Text::new(base, text, SMALL, Align::Middle))
    }

    fn bar(&self, on: &mut dyn Surface, ends: [f64; 2], text: &[String; 2]) -> Drawn {
        let [foot, head] = ends.map(|end| self.at(1.0, self.y.part(end)).1);
        let x = self.to.0 + 12.0;
        let pen = Pen::solid(BLACK, 1.6);
        on.line(&[(x, foot), (x, head)], pen)?;
        for y in [foot, head] {
            on.line(&[(x - 4.0, y), (x + 4.0, y)], pen)?;
        }
        let middle = 0.5 * (foot + head);
        for (line, base) in text.iter().zip([middle - 1.0, middle + 1.1 * SMALL]) {
            on.text(Text::new((x + 8.0, base), line, SMALL, Align::Left))?;
        }
        Ok(())
    }

    /// Draws the border, the ticks, their figures and the captions.
    pub(crate) fn border(&self, canvas: &mut dyn Surface) -> Drawn {
        let pen = Pen::solid(BLACK, 1.3);
        let ((left, top), (right, bottom)) = (self.from, self.to);
        let long = |tick: &Tick| match tick.text.is_empty() {
            true => 0.5 * TICK,
            false => TICK,
        };
        for tick in &self.x.ticks {
            let (x, _) = self.at(self.x.part(tick.value), 0.0);
            canvas.line(&[(x, bottom), (x, bottom - long(tick))], pen)?;
            canvas.line(&[(x, top), (x, top + long(tick))], pen)?;
            if self.labelled_below && !tick.text.is_empty() {
                let base = (x, bottom + 1.25 * TICK_SIZE);
                canvas.text(Text::new(base, &tick.text, TICK_SIZE, Align::Middle))?;
            }
        }
        for tick in &self.y.ticks {
            let (_, y) = self.at(0.0, self.y.part(tick.value));
            canvas.line(&[(left, y), (left + long(tick), y)], pen)?;
            canvas.line(&[(right, y), (right - long(tick), y)], pen)?;
            if !tick.text.is_empty() {
                let base = (left - 6.0, y + 0.36 * TICK_SIZE);
                canvas.text(Text::new(base, &tick.text, TICK_SIZE, Align::Right))?;
            }
        }
        canvas.outline(&[self.from, (right, top), self.to, (left, bottom)], pen)?;
        let mut caption = |base, scale: &Scale, align, room| {
            canvas.text(Text::new(base, &scale.caption, CAPTION_SIZE, align).within(room))
        };
        if self.labelled_below {
            let base = (0.5 * (left + right), bottom + 2.6 * CAPTION_SIZE);
            caption(base, &self.x, Align::Middle, right)?;
        }
        let base = (left - self.figures - 18.0, 0.5 * (top + bottom));
        caption(base, &self.y, Align::Upward, bottom)
    }
}
