//! A frame with axes that curves are drawn in.

use super::axis::{Axis, TICK_SIZE, drawable};
use super::canvas::{Align, Canvas, Place, cut};
use super::palette::{BLACK, Pen};

/// Size of the texts along the axes.
pub const CAPTION_SIZE: f64 = 18.0;

/// Length of the ticks.
const TICK: f64 = 6.0;

/// A frame on a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Upper left corner.
    pub from: Place,
    /// Lower right corner.
    pub to: Place,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Room for the figures of the vertical axis, the same in all frames of a sheet.
    pub figures: f64,
    /// Whether figures and caption stand below the frame.
    pub labelled_below: bool,
}

impl Frame {
    /// Where a point of the data lies; none for what cannot be drawn.
    pub fn place(&self, x: f64, y: f64) -> Option<Place> {
        (drawable(x) && drawable(y)).then(|| {
            (
                self.from.0 + self.x.part(x) * (self.to.0 - self.from.0),
                self.to.1 - self.y.part(y) * (self.to.1 - self.from.1),
            )
        })
    }

    /// Draws a curve, broken where a point cannot be drawn.
    pub fn curve(
        &self,
        canvas: &mut Canvas<'_>,
        points: impl IntoIterator<Item = (f64, f64)>,
        pen: Pen,
    ) {
        let mut stretch: Vec<Place> = Vec::new();
        for (x, y) in points {
            match self.place(x, y) {
                Some(place) => stretch.push(place),
                None => canvas.line(&std::mem::take(&mut stretch), pen),
            }
        }
        canvas.line(&stretch, pen);
    }

    /// Draws the border, the ticks, their figures and the captions.
    pub fn border(&self, canvas: &mut Canvas<'_>) {
        let pen = Pen::solid(BLACK, 1.3);
        let ((left, top), (right, bottom)) = (self.from, self.to);
        for tick in &self.x.ticks {
            let x = left + self.x.part(tick.value) * (right - left);
            canvas.line(&[(x, bottom), (x, bottom - TICK)], pen);
            canvas.line(&[(x, top), (x, top + TICK)], pen);
            if self.labelled_below {
                canvas.text(
                    (x, bottom + 1.25 * TICK_SIZE),
                    &tick.text,
                    TICK_SIZE,
                    Align::Middle,
                );
            }
        }
        for tick in &self.y.ticks {
            let y = bottom - self.y.part(tick.value) * (bottom - top);
            canvas.line(&[(left, y), (left + TICK, y)], pen);
            canvas.line(&[(right, y), (right - TICK, y)], pen);
            canvas.text(
                (left - 6.0, y + 0.36 * TICK_SIZE),
                &tick.text,
                TICK_SIZE,
                Align::Right,
            );
        }
        canvas.line(
            &[
                (left, top),
                (right, top),
                (right, bottom),
                (left, bottom),
                (left, top),
                (right, top),
            ],
            pen,
        );
        if self.labelled_below {
            canvas.text(
                (0.5 * (left + right), bottom + 2.6 * CAPTION_SIZE),
                &cut(&self.x.caption, CAPTION_SIZE, right),
                CAPTION_SIZE,
                Align::Middle,
            );
        }
        canvas.upward_text(
            (left - self.figures - 15.0, 0.5 * (top + bottom)),
            &cut(&self.y.caption, CAPTION_SIZE, bottom),
            CAPTION_SIZE,
        );
    }
}
