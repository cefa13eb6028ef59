//! Arrangement of a picture: title, panels one below the other or beside each other, legend.

use super::axis::{Scale, TICK_SIZE, Tick, Ticks};
use super::canvas::compose;
use super::frame::{CAPTION_SIZE, PanelFrame};
use super::paint::Sheet;
use super::palette::GREY;
use super::picture::{Layer, Panel, Picture};
use super::surface::{Align, Drawn, RenderError, Text, WIDTH};
use super::text::width;

const TITLE_SIZE: f64 = 18.0;

/// Size of the line below it.
const SUBTITLE_SIZE: f64 = 14.0;

/// Size that a long title shrinks to before it is cut.
const SMALLEST_TITLE: f64 = 12.5;

/// Length of a horizontal axis between margins of the usual width, for the choice of its figures.
const LENGTH: f64 = WIDTH - 110.0;

/// The same for two panels beside each other.
const HALF_LENGTH: f64 = 185.0;

/// Height for which an axis has one more tick.
const PER_TICK: f64 = 45.0;

/// Room between panels, above headings, and right of a frame with a bar.
const BETWEEN: f64 = 14.0;
const HEADINGS: f64 = 17.0;
const BAR: f64 = 74.0;

impl Picture {
    /// The picture as SVG. The same picture gives the same bytes.
    ///
    /// # Errors
    /// When the backend fails.
    pub(crate) fn svg(&self) -> Result<String, RenderError> {
        let frames = self.frames();
        compose(self.height(&frames), |canvas| self.draw(canvas, &frames))
    }

    /// Draws the picture with its frames.
    pub(super) fn draw(
        &self,
        on: &mut dyn Sheet,
        (frames, bottom): &(Vec<PanelFrame>, f64),
    ) -> Drawn {
        let (middle, room) = (0.5 * WIDTH, WIDTH - 20.0);
        if let Some(title) = &self.title {
            // what fits exactly must not be cut by rounding
            let size = (0.999 * TITLE_SIZE * room / width(title, TITLE_SIZE))
                .clamp(SMALLEST_TITLE, TITLE_SIZE);
            let place = (middle, 1.3 * TITLE_SIZE);
            on.text(Text::new(place, title, size, Align::Middle).within(room))?;
        }
        if let Some(subtitle) = &self.subtitle {
            let place = (middle, self.top() - 12.0);
            let text = Text::new(place, subtitle, SUBTITLE_SIZE, Align::Middle);
            on.text(text.within(room).coloured(GREY))?;
        }
        for (frame, panel) in frames.iter().zip(&self.panels) {
            on.panel(frame, &panel.layers)?;
        }
        for frame in frames {
            on.border(frame)?;
        }
        self.legend.paint(on, *bottom)
    }

    pub(super) fn height(&self, (_, bottom): &(Vec<PanelFrame>, f64)) -> f64 {
        (bottom + self.legend.height()).ceil()
    }

    /// The frames of the panels, and where they end.
    pub(super) fn frames(&self) -> (Vec<PanelFrame>, f64) {
        if self.beside {
            self.beside()
        } else {
            self.below()
        }
    }

    fn top(&self) -> f64 {
        let title = self.title.as_ref().map_or(0.0, |_| 1.5 * TITLE_SIZE);
        let subtitle = self.subtitle.as_ref().map_or(0.0, |_| 1.4 * SUBTITLE_SIZE);
        12.0 + title + subtitle
    }

    /// Frames from top to bottom, and where they end.
    fn below(&self) -> (Vec<PanelFrame>, f64) {
        let scaled = |panel: &Panel| panel.scales(LENGTH, panel.ticks());
        let scales: Vec<[Scale; 2]> = self.panels.iter().map(scaled).collect();
        let figures = scales
            .iter()
            .map(|[_, y]| y.figures_width())
            .fold(0.0, f64::max);
        let left = figures + CAPTION_SIZE + 21.0;
        let has = |panel: &Panel, wanted: fn(&Layer) -> bool| panel.layers.iter().any(wanted);
        let bar = |panel: &Panel| has(panel, |layer| matches!(layer, Layer::Bar { .. }));
        let mut margin: f64 = if self.panels.iter().any(bar) {
            BAR
        } else {
            12.0
        };
        for [x, _] in &scales {
            margin = margin.max(overhang(x));
        }
        let mut top = self.top();
        let mut frames: Vec<PanelFrame> = Vec::with_capacity(scales.len());
        let last = scales.len().saturating_sub(1);
        for (index, (panel, [x, y])) in self.panels.iter().zip(scales).enumerate() {
            if index > 0 {
                top += BETWEEN;
            } else if has(panel, |layer| matches!(layer, Layer::Headings(_))) {
                top += HEADINGS;
            }
            frames.push(PanelFrame {
                from: (left, top),
                to: (WIDTH - margin, top + panel.height),
                x,
                y,
                figures,
                labelled_below: index == last,
            });
            top += panel.height;
        }
        (frames, top + 3.2 * CAPTION_SIZE)
    }

    /// Square frames from left to right, and where they end.
    fn beside(&self) -> (Vec<PanelFrame>, f64) {
        let scaled = |panel: &Panel| panel.scales(HALF_LENGTH, Ticks::Within(HALF_LENGTH));
        let scales: Vec<[Scale; 2]> = self.panels.iter().map(scaled).collect();
        // Left of each frame stand its figures and, if it has one, its caption.
        let room = |[_, y]: &[Scale; 2]| match y.caption.is_empty() {
            true => y.figures_width() + 18.0,
            false => y.figures_width() + CAPTION_SIZE + 21.0,
        };
        let rooms: f64 = scales.iter().map(room).sum();
        let side = (WIDTH - 14.0 - rooms) / scales.len().max(1) as f64;
        let (top, mut right) = (self.top(), 0.0);
        let mut frames = Vec::with_capacity(scales.len());
        for scale in scales {
            let left = right + room(&scale);
            right = left + side;
            let [x, y] = scale;
            frames.push(PanelFrame {
                from: (left, top),
                to: (right, top + side),
                figures: y.figures_width(),
                x,
                y,
                labelled_below: true,
            });
        }
        (frames, top + side + 3.2 * CAPTION_SIZE)
    }
}

impl Panel {
    /// How many ticks the vertical axis has.
    fn ticks(&self) -> Ticks {
        Ticks::About((self.height / PER_TICK).round().clamp(3.0, 5.0) as usize)
    }

    /// The axes over what the panel shows; the horizontal one is about this long.
    fn scales(&self, length: f64, vertical: Ticks) -> [Scale; 2] {
        let points: Vec<_> = self.layers.iter().flat_map(Layer::points).collect();
        let (xs, ys) = (points.iter().map(|p| p.0), points.iter().map(|p| p.1));
        [
            Scale::of(&self.x, xs, Ticks::Within(length)),
            Scale::of(&self.y, ys, vertical),
        ]
    }
}

/// How far the last figures of a horizontal axis stand out on the right.
fn overhang(x: &Scale) -> f64 {
    let over = |tick: &Tick| {
        let inside = (1.0 - x.part(tick.value)) * LENGTH;
        0.5 * width(&tick.text, TICK_SIZE) - inside + 6.0
    };
    let figures = x.ticks.iter().filter(|tick| !tick.text.is_empty());
    figures.map(over).fold(0.0, f64::max)
}
