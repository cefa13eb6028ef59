//! A picture as a value: panels with axes and layers, and a legend.

use plotters::style::RGBColor;

use super::axis::Axis;
use super::legend::Legend;
use super::mark::Mark;
use super::palette::Pen;

/// Height of the only panel of a picture, in pixels of a sheet that is 510 wide.
pub(crate) const HEIGHT: f64 = 300.0;

/// A point in the units of the axes. What is not finite is not drawn.
pub(crate) type Point = (f64, f64);

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Picture {
    /// Line of text above everything.
    pub title: Option<String>,
    pub subtitle: Option<String>,
    /// What is drawn, from top to bottom. Panels one below the other share the horizontal axis.
    pub panels: Vec<Panel>,
    /// Whether the panels are square and stand beside each other instead.
    pub beside: bool,
    pub legend: Legend,
}

/// A frame with axes and what is drawn in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    pub x: Axis,
    pub y: Axis,
    /// Height of the frame in pixels.
    pub height: f64,
    /// What is drawn, the last on top.
    pub layers: Vec<Layer>,
}

/// What is drawn in a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layer {
    /// A line through points, broken where one cannot be drawn.
    Line(Vec<Point>, Pen),
    /// A line across the panel at a value of the vertical axis.
    Across(f64, Pen),
    /// An upright line at a value of the horizontal axis.
    Upright(f64, Pen),
    Marks(Vec<Point>, Mark),
    Area(Vec<Point>, RGBColor),
    /// Filled rectangles; those with infinite ends reach to the frame.
    Cells(Vec<ColourCell>),
    /// Names in the panel, as far as there is room.
    Names(Vec<PanelName>),
    /// Names of stretches of the horizontal axis, above the frame.
    Headings(Vec<Heading>),
    /// A length of the vertical axis, right of the frame.
    Bar {
        foot: f64,
        head: f64,
        /// What it measures and how long it is.
        text: [String; 2],
    },
    /// A remark in grey in the middle.
    Remark(String),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColourCell {
    pub from: Point,
    pub to: Point,
    pub colour: RGBColor,
}

/// A name in a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PanelName {
    /// Of names with the same number the first that has room is written.
    pub group: usize,
    pub at: Point,
    pub text: String,
}

/// Name of a stretch of the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heading {
    pub ends: [f64; 2],
    /// Names in the order of preference: the first that fits is written.
    pub names: Vec<String>,
}

impl Picture {
    /// A picture of panels one below the other.
    pub(crate) fn new(panels: Vec<Panel>, legend: Legend) -> Picture {
        Picture {
            panels,
            legend,
            ..Picture::default()
        }
    }

    /// The picture with a line of text above it, unless it has one of its own.
    pub(crate) fn titled(self, title: Option<&str>) -> Picture {
        Picture {
            title: self.title.or(title.map(str::to_owned)),
            ..self
        }
    }

    /// The picture with the units of its axes in their captions.
    pub(crate) fn dimensional(mut self) -> Picture {
        for panel in &mut self.panels {
            panel.x.quantity.dimensional = true;
            panel.y.quantity.dimensional = true;
        }
        self
    }

    /// The picture with a smaller line below its title.
    pub(crate) fn subtitled(self, subtitle: &str) -> Picture {
        Picture {
            subtitle: Some(subtitle.to_owned()),
            ..self
        }
    }
}

impl Panel {
    /// A panel of the usual height.
    pub(crate) fn new(x: Axis, y: Axis, layers: Vec<Layer>) -> Panel {
        Panel {
            x,
            y,
            height: HEIGHT,
            layers,
        }
    }

    /// The panel with another height.
    pub(crate) fn high(self, height: f64) -> Panel {
        Panel { height, ..self }
    }

    /// The panel with a remark in place of its layers where there is nothing to show.
    pub(crate) fn unless(self, nothing: bool, remark: &str) -> Panel {
        match nothing {
            true => Panel {
                layers: vec![Layer::Remark(remark.to_owned())],
                ..self
            },
            false => self,
        }
    }
}

impl ColourCell {
    /// A stretch of the horizontal axis over the whole height.
    pub(crate) fn upright(from: f64, to: f64, colour: RGBColor) -> ColourCell {
        ColourCell {
            from: (from, f64::NEG_INFINITY),
            to: (to, f64::INFINITY),
            colour,
        }
    }
}

impl Layer {
    /// The points that an axis over all data has to reach.
    pub(super) fn points(&self) -> Vec<Point> {
        match self {
            Layer::Line(points, _) | Layer::Marks(points, _) | Layer::Area(points, _) => {
                points.clone()
            }
            Layer::Across(y, _) => vec![(f64::NAN, *y)],
            Layer::Upright(x, _) => vec![(*x, f64::NAN)],
            Layer::Cells(cells) => cells.iter().flat_map(|cell| [cell.from, cell.to]).collect(),
            Layer::Names(_) | Layer::Headings(_) | Layer::Bar { .. } | Layer::Remark(_) => {
                Vec::new()
            }
        }
    }
}
