//! Pictures of a result folder, made for a column of a journal.
//!
//! Everything is read back from the tables on disk, so that a picture can be drawn again long
//! after the run. Each picture is composed as SVG; PNG and PDF are converted from it.

pub mod accuracy;
mod axis;
mod canvas;
mod curve;
mod diagram;
mod displacement;
mod error;
mod frame;
mod friction;
mod legend;
mod map;
mod multipliers;
mod number;
mod palette;
mod phase_plane;
mod pressure;
mod profile;
mod quantity;
#[cfg(feature = "raster")]
mod raster;
mod sheet;
mod simulation;
mod spectrum;
mod steady;
mod switches;
mod tables;
#[cfg(test)]
mod tests;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

pub use error::PlotError;
pub use simulation::{draw as draw_simulation, names as simulation_names};

use profile::Profiles;
use tables::Tables;

use super::store;
use crate::curve::Curve;
use crate::problem::Map;
pub use crate::problem::Plot as Picture;
use crate::steady::Mode;

/// Name of a picture's file without extension.
fn stem(picture: &Picture) -> String {
    match picture {
        Picture::Diagram => "diagram".to_owned(),
        Picture::Pressure => "pressure".to_owned(),
        Picture::Displacement => "displacement".to_owned(),
        Picture::PhasePlane => "phase_plane".to_owned(),
        Picture::Friction => "friction".to_owned(),
        Picture::Spectrum => "spectrum".to_owned(),
        Picture::Multipliers => "multipliers".to_owned(),
        Picture::Column(name) => {
            // A column name comes from a file and must not lead out of the folder.
            let safe: String = name
                .chars()
                .map(|c| {
                    if c.is_alphanumeric() || c == '-' {
                        c
                    } else {
                        '_'
                    }
                })
                .collect();
            format!("column_{safe}")
        }
    }
}

/// Name of a picture's file.
pub fn file_name(picture: &Picture, format: Format) -> String {
    format!("{}.{}", stem(picture), format.extension())
}

/// Whether a picture is made from the files in `profiles`.
fn needs_profiles(picture: &Picture) -> bool {
    matches!(
        picture,
        Picture::Pressure | Picture::Displacement | Picture::PhasePlane | Picture::Friction
    )
}

/// File format of the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Pixels, about 460 per inch at the width of a column.
    Png,
    /// One page of the width of a column.
    Pdf,
}

impl Format {
    /// Extension of the file name.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Svg => "svg",
            Format::Png => "png",
            Format::Pdf => "pdf",
        }
    }
}

impl Format {
    /// The format itself, if this build can write it.
    ///
    /// # Errors
    /// When it was left out.
    pub fn available(self) -> Result<Format, PlotError> {
        if self != Format::Svg && cfg!(not(feature = "raster")) {
            return Err(PlotError::FormatMissing(self.extension()));
        }
        Ok(self)
    }

    /// The format of a file by its extension.
    pub fn of(path: &Path) -> Option<Format> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        [Format::Svg, Format::Png, Format::Pdf]
            .into_iter()
            .find(|format| format.extension() == extension)
    }
}

/// Draws growth rates of steady sliding against the mode and, with damping, the Hopf friction.
///
/// # Errors
///
/// When the format is not compiled in or the file cannot be written.
pub fn draw_steady(
    path: &Path,
    format: Format,
    title: Option<&str>,
    modes: &[Mode],
) -> Result<(), PlotError> {
    save(path, steady::compose(modes, title)?, format)
}

/// Draws the regions of a map from the `map.csv` of its folder.
///
/// # Errors
///
/// When the table cannot be read, the format is not compiled in, or the file cannot be written.
pub fn draw_map(
    path: &Path,
    format: Format,
    folder: &Path,
    section: &Map,
    title: Option<&str>,
) -> Result<(), PlotError> {
    let table = folder.join(super::map_folder::TABLE);
    save(path, map::compose(&table, section, title)?, format)
}

/// Draws the curve of an event in the plane of its parameters, `ranges` wide.
///
/// # Errors
///
/// When the format is not compiled in or the file cannot be written.
pub fn draw_curve(
    path: &Path,
    format: Format,
    curve: &Curve,
    ranges: [(f64, f64); 2],
    title: Option<&str>,
) -> Result<(), PlotError> {
    replace(path, curve::compose(curve, ranges, title)?, format)
}

/// Draws error against run time of several methods.
///
/// # Errors
///
/// When the format is not compiled in or the file cannot be written.
pub fn draw_accuracy(
    path: &Path,
    format: Format,
    series: &[accuracy::Series],
    settings: &Settings,
) -> Result<(), PlotError> {
    replace(path, accuracy::compose(series, settings)?, format)
}

/// Writes a composed picture.
fn save(path: &Path, svg: String, format: Format) -> Result<(), PlotError> {
    let bytes = convert(svg, format)?;
    Ok(fs::write(path, bytes).map_err(store::io_error("write it", path))?)
}

/// Writes a composed picture into a result folder.
fn replace(path: &Path, svg: String, format: Format) -> Result<(), PlotError> {
    let bytes = convert(svg, format)?;
    Ok(store::replace(path, |out| {
        out.write_all(&bytes)
            .map_err(store::io_error("write it", path))
    })?)
}

/// What the pictures have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Column of `branch.csv` on the horizontal axis.
    pub parameter: String,
    /// Line of text above each picture.
    pub title: Option<String>,
}

/// Draws the pictures into the folder and returns the files written.
///
/// # Errors
///
/// Returns an error when a table cannot be read or lacks a column, when the parameter or a
/// picture's column is unknown, when the format is not compiled in, or when a file cannot be
/// written. The other pictures are drawn all the same.
pub fn draw(
    folder: &Path,
    pictures: &[Picture],
    format: Format,
    settings: &Settings,
) -> Result<Vec<PathBuf>, PlotError> {
    let format = format.available()?;
    let tables = Tables::read(folder)?;
    tables.check_parameter(&settings.parameter)?;
    let profiles = if pictures.iter().any(needs_profiles) {
        Profiles::read(folder, &tables, &settings.parameter)?
    } else {
        Profiles::default()
    };
    let drawn: Vec<Result<PathBuf, PlotError>> = pictures
        .par_iter()
        .map(|picture| {
            let svg = compose(picture, &tables, &profiles, settings)?;
            let path = folder.join(file_name(picture, format));
            replace(&path, svg, format)?;
            Ok(path)
        })
        .collect();
    // the first error in the order of the pictures, whichever came first in time
    drawn.into_iter().collect()
}

/// The picture as SVG.
fn compose(
    picture: &Picture,
    tables: &Tables,
    profiles: &Profiles,
    settings: &Settings,
) -> Result<String, PlotError> {
    match picture {
        Picture::Diagram => diagram::compose(tables, "speed", settings),
        Picture::Column(name) if name == "switches" => switches::compose(tables, settings),
        Picture::Column(name) => diagram::compose(tables, name, settings),
        Picture::Pressure => pressure::compose(profiles, settings),
        Picture::Displacement => displacement::compose(profiles, settings),
        Picture::PhasePlane => phase_plane::compose(profiles, settings),
        Picture::Friction => friction::compose(profiles, settings),
        Picture::Spectrum => spectrum::compose(tables, settings),
        Picture::Multipliers => multipliers::compose(tables, settings),
    }
}

/// The bytes of the picture's file.
#[cfg(feature = "raster")]
fn convert(svg: String, format: Format) -> Result<Vec<u8>, PlotError> {
    match format {
        Format::Svg => Ok(svg.into_bytes()),
        Format::Png => raster::png(&svg),
        Format::Pdf => raster::pdf(&svg),
    }
}

/// The bytes of the picture's file.
#[cfg(not(feature = "raster"))]
fn convert(svg: String, format: Format) -> Result<Vec<u8>, PlotError> {
    match format {
        Format::Svg => Ok(svg.into_bytes()),
        Format::Png | Format::Pdf => Err(PlotError::FormatMissing(format.extension())),
    }
}
