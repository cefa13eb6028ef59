//! A picture as a value, and the one renderer of such values.
//!
//! A picture has panels, a panel has axes and layers; what a picture shows is decided by those who
//! describe it. Here it is decided how that looks in a column of a journal: [`axis`] chooses ranges
//! and figures, [`layout`] arranges panels, title and legend, [`frame`] draws the layers, [`placement`]
//! finds room for names. What stands outside of the data is drawn on a [`surface`]: [`canvas`] writes SVG,
//! from which PNG and PDF are converted, [`tex`] the same as source for pgfplots.

mod axis;
mod canvas;
mod frame;
mod layout;
mod legend;
pub(crate) mod number;
mod palette;
mod placement;
#[cfg(feature = "raster")]
mod raster;
mod surface;
mod tex;
mod text;

use std::error::Error;
use std::path::Path;

use plotters::style::RGBColor;

pub(crate) use axis::{Axis, Extent, Quantity, Tick, drawable, range};
pub(crate) use legend::{Key, Legend};
pub(crate) use palette::{
    BLACK, BLUE, CATEGORIES, GREEN, GREY, ORANGE, PURPLE, Pattern, Pen, SKY, VERMILLION, WHITE,
    hexadecimal, mix, ordered,
};

/// Height of the only panel of a picture, in pixels of a sheet that is 510 wide.
pub(crate) const HEIGHT: f64 = 300.0;

/// A point in the units of the axes. What is not finite is not drawn.
pub(crate) type Point = (f64, f64);

/// A picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Picture {
    /// Line of text above everything.
    pub title: Option<String>,
    /// Smaller line below it.
    pub subtitle: Option<String>,
    /// What is drawn, from top to bottom. Panels one below the other share the horizontal axis.
    pub panels: Vec<Panel>,
    /// Whether the panels are square and stand beside each other instead.
    pub beside: bool,
    /// Explanations.
    pub legend: Legend,
}

/// A frame with axes and what is drawn in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
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
    /// Points.
    Marks(Vec<Point>, Mark),
    /// A filled polygon.
    Area(Vec<Point>, RGBColor),
    /// Filled rectangles; those with infinite ends reach to the frame.
    Cells(Vec<Cell>),
    /// Names in the panel, as far as there is room.
    Names(Vec<Name>),
    /// Names of stretches of the horizontal axis, above the frame.
    Headings(Vec<Heading>),
    /// A length of the vertical axis, right of the frame.
    Bar {
        /// Where it stands.
        foot: f64,
        /// Where it ends.
        head: f64,
        /// What it measures and how long it is.
        text: [String; 2],
    },
    /// A remark in grey in the middle.
    Remark(String),
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// Shape.
    pub shape: Shape,
    /// About half the width, in pixels.
    pub size: f64,
    /// Colour.
    pub colour: RGBColor,
}

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Shape {
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

/// A filled rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    /// Lower left corner.
    pub from: Point,
    /// Upper right corner.
    pub to: Point,
    /// Colour.
    pub colour: RGBColor,
}

/// A name in a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Name {
    /// Of names with the same number the first that has room is written.
    pub group: usize,
    /// Where its middle is.
    pub at: Point,
    /// The name.
    pub text: String,
}

/// Name of a stretch of the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heading {
    /// The stretch.
    pub ends: [f64; 2],
    /// Names in the order of preference: the first that fits is written.
    pub names: Vec<String>,
}

/// Failure to render a picture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum RenderError {
    /// PNG and PDF were left out when the program was built.
    #[error("this build writes SVG and TeX only; build it with the feature `raster` for {0}")]
    FormatMissing(&'static str),
    /// The backend failed.
    #[error("cannot compose the picture: {0}")]
    Compose(Box<dyn Error + Send + Sync>),
    /// The picture could not be converted.
    #[error("cannot convert the picture to {format}: {source}")]
    #[cfg_attr(not(feature = "raster"), allow(dead_code))] // SVG needs no conversion
    Convert {
        /// The format asked for.
        format: &'static str,
        /// Why.
        source: Box<dyn Error + Send + Sync>,
    },
}

/// File format of the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Pixels, about 460 per inch at the width of a column.
    Png,
    /// One page of the width of a column.
    Pdf,
    /// The same as source for pdfLaTeX with pgfplots.
    Tex,
}

impl Format {
    const ALL: [Format; 4] = [Format::Svg, Format::Png, Format::Pdf, Format::Tex];

    /// Extension of the file name.
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Format::Svg => "svg",
            Format::Png => "png",
            Format::Pdf => "pdf",
            Format::Tex => "tex",
        }
    }

    /// The format itself, if this build can write it.
    ///
    /// # Errors
    /// When it was left out.
    pub(crate) fn available(self) -> Result<Format, RenderError> {
        if matches!(self, Format::Png | Format::Pdf) && cfg!(not(feature = "raster")) {
            return Err(RenderError::FormatMissing(self.extension()));
        }
        Ok(self)
    }

    /// The format with this extension.
    pub(crate) fn named(extension: &str) -> Option<Format> {
        let mut all = Format::ALL.into_iter();
        all.find(|format| format.extension() == extension)
    }

    /// The format of a file by its extension.
    pub(crate) fn of(path: &Path) -> Option<Format> {
        Format::named(&path.extension()?.to_str()?.to_ascii_lowercase())
    }
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

    /// The picture with a line of text above it.
    pub(crate) fn titled(self, title: Option<&str>) -> Picture {
        Picture {
            title: title.map(str::to_owned),
            ..self
        }
    }

    /// The picture with a smaller line below its title.
    pub(crate) fn subtitled(self, subtitle: &str) -> Picture {
        Picture {
            subtitle: Some(subtitle.to_owned()),
            ..self
        }
    }

    /// The bytes of the picture's file.
    ///
    /// # Errors
    /// When the format was left out of this build or a library refuses.
    pub(crate) fn file(&self, format: Format) -> Result<Vec<u8>, RenderError> {
        match format.available()? {
            Format::Svg => Ok(self.svg()?.into_bytes()),
            Format::Tex => Ok(self.tex()?.into_bytes()),
            #[cfg(feature = "raster")]
            Format::Png => raster::png(&self.svg()?),
            #[cfg(feature = "raster")]
            Format::Pdf => raster::pdf(&self.svg()?),
            #[cfg(not(feature = "raster"))]
            Format::Png | Format::Pdf => Err(RenderError::FormatMissing(format.extension())),
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

impl Cell {
    /// A stretch of the horizontal axis over the whole height.
    pub(crate) fn upright(from: f64, to: f64, colour: RGBColor) -> Cell {
        Cell {
            from: (from, f64::NEG_INFINITY),
            to: (to, f64::INFINITY),
            colour,
        }
    }
}

impl Layer {
    /// The points that an axis over all data has to reach.
    fn points(&self) -> Vec<Point> {
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

impl Mark {
    /// A mark of this look.
    pub(crate) fn new(shape: Shape, size: f64, colour: RGBColor) -> Mark {
        Mark {
            shape,
            size,
            colour,
        }
    }
}
