//! Arrangement of a picture: title, frames one below the other or in a row, legend.

use super::axis::{Axis, TICK_SIZE};
use super::canvas::{self, Align, Canvas, Place, WIDTH, cut, text_width};
use super::error::PlotError;
use super::frame::{CAPTION_SIZE, Frame};
use super::legend::Legend;

/// Height of the frame of a picture that has one frame.
pub const HEIGHT: f64 = 300.0;

/// Size of the title.
const TITLE_SIZE: f64 = 18.0;

/// Size that a long title shrinks to before it is cut.
const SMALLEST_TITLE: f64 = 14.0;

/// A frame to be placed.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Height of the frame.
    pub height: f64,
    /// Room above the frame.
    pub above: f64,
    /// Whether figures and caption stand below the frame.
    pub labelled_below: bool,
}

impl Panel {
    /// The only frame of a picture.
    pub fn new(x: Axis, y: Axis) -> Self {
        Panel {
            x,
            y,
            height: HEIGHT,
            above: 0.0,
            labelled_below: true,
        }
    }
}

/// Length of the horizontal axis between two margins of the usual width.
pub fn usual_length() -> f64 {
    WIDTH - 110.0
}

/// A picture to be composed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// Line of text above everything.
    pub title: Option<String>,
    /// Frames from top to bottom.
    pub panels: Vec<Panel>,
    /// Explanations.
    pub legend: Legend,
    /// Room right of the frames.
    pub right: f64,
}

impl Sheet {
    /// Composes the picture: `paint` draws the contents of the frames, the borders come on top.
    pub fn compose(
        self,
        paint: impl FnOnce(&mut Canvas<'_>, &[Frame]),
    ) -> Result<String, PlotError> {
        let figures = self
            .panels
            .iter()
            .map(|panel| panel.y.figures_width())
            .fold(0.0, f64::max);
        let left = figures + CAPTION_SIZE + 18.0;
        let right = WIDTH - self.right.max(self.overhang()).max(12.0);
        let mut top = self.top();
        let mut frames = Vec::with_capacity(self.panels.len());
        for panel in &self.panels {
            top += panel.above;
            frames.push(Frame {
                from: (left, top),
                to: (right, top + panel.height),
                x: panel.x.clone(),
                y: panel.y.clone(),
                figures,
                labelled_below: panel.labelled_below,
            });
            top += panel.height;
            if panel.labelled_below {
                top += 3.2 * CAPTION_SIZE;
            }
        }
        self.finish(&frames, top, paint)
    }

    /// Composes the picture with square frames from left to right instead.
    pub fn compose_row(
        self,
        paint: impl FnOnce(&mut Canvas<'_>, &[Frame]),
    ) -> Result<String, PlotError> {
        let top = self.top();
        // Left of each frame stand its figures and, if it has one, its caption.
        let rooms: Vec<f64> = self
            .panels
            .iter()
            .map(|panel| match panel.y.caption.is_empty() {
                true => panel.y.figures_width() + 18.0,
                false => panel.y.figures_width() + CAPTION_SIZE + 18.0,
            })
            .collect();
        let room = WIDTH - self.right.max(14.0) - rooms.iter().sum::<f64>();
        let side = room / self.panels.len().max(1) as f64;
        let mut right = 0.0;
        let mut frames = Vec::with_capacity(self.panels.len());
        for (panel, room) in self.panels.iter().zip(rooms) {
            let left = right + room;
            right = left + side;
            frames.push(Frame {
                from: (left, top),
                to: (right, top + side),
                x: panel.x.clone(),
                y: panel.y.clone(),
                figures: panel.y.figures_width(),
                labelled_below: true,
            });
        }
        self.finish(&frames, top + side + 3.2 * CAPTION_SIZE, paint)
    }

    /// Where the frames begin.
    fn top(&self) -> f64 {
        match self.title {
            Some(_) => 12.0 + 1.5 * TITLE_SIZE,
            None => 12.0,
        }
    }

    /// Composes the picture from its frames; the legend begins at `top`.
    fn finish(
        &self,
        frames: &[Frame],
        top: f64,
        paint: impl FnOnce(&mut Canvas<'_>, &[Frame]),
    ) -> Result<String, PlotError> {
        let height = (top + self.legend.height()).ceil();
        canvas::compose(height, |canvas| {
            if let Some(title) = &self.title {
                let place = (0.5 * WIDTH, 1.3 * TITLE_SIZE);
                let room = WIDTH - 20.0;
                let size = (TITLE_SIZE * room / text_width(title, TITLE_SIZE))
                    .clamp(SMALLEST_TITLE, TITLE_SIZE);
                canvas.text(place, &cut(title, size, room), size, Align::Middle);
            }
            paint(canvas, frames);
            for frame in frames {
                frame.border(canvas);
            }
            self.legend.paint(canvas, top);
        })
    }

    /// Half the last figures of a horizontal axis, which may stand out on the right.
    fn overhang(&self) -> f64 {
        self.panels
            .iter()
            .filter_map(|panel| {
                let tick = panel.x.ticks.last()?;
                let out = 0.5 * text_width(&tick.text, TICK_SIZE);
                let inside = (1.0 - panel.x.part(tick.value)) * usual_length();
                Some(out - inside + 6.0)
            })
            .fold(0.0, f64::max)
    }
}

/// A grey remark in the middle of a frame.
pub fn remark(canvas: &mut Canvas<'_>, frame: &Frame, text: &str) {
    let (from, to): (Place, Place) = (frame.from, frame.to);
    canvas.remark(from, to, text, TICK_SIZE);
}
