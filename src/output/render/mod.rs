//! A picture as a value, and the one renderer of such values.
//!
//! What a picture shows is decided by those who describe it; here it is decided how that looks in a column
//! of a journal. Each of these imports only those above it:
//!
//! - [`text`], [`number`], [`palette`] and [`mark`] are what everything is made of; a [`surface`] draws lines,
//!   areas, marks and texts;
//! - [`axis`] chooses ranges and figures, [`legend`] places explanations, [`picture`] is the value;
//! - a [`frame`] is a panel at its place, [`placement`] finds room for names in it, [`paint`] draws layers;
//! - [`layout`] arranges panels, title and legend;
//! - [`canvas`] writes SVG, from which `raster` makes PNG and PDF, and [`tex`] the same as source for pgfplots;
//!   [`format`] chooses among them.

mod axis;
mod canvas;
mod format;
mod frame;
mod layout;
mod legend;
mod mark;
pub(crate) mod number;
mod paint;
mod palette;
mod picture;
mod placement;
#[cfg(feature = "raster")]
mod raster;
mod surface;
mod tex;
mod text;

pub(crate) use axis::{Axis, Extent, Quantity, Tick, drawable, range};
pub(crate) use canvas::path;
pub(crate) use format::Format;
pub(crate) use legend::{Key, Legend};
pub(crate) use mark::{Mark, MarkShape};
pub(crate) use palette::{
    BLACK, BLUE, CATEGORIES, GREEN, GREY, ORANGE, PURPLE, Pattern, Pen, SKY, VERMILLION, WHITE,
    hexadecimal, mix, ordered,
};
pub(crate) use picture::{ColourCell, HEIGHT, Heading, Layer, Panel, PanelName, Picture, Point};
pub(crate) use surface::RenderError;
