//! Pictures of a result folder, one short description each.
//!
//! Everything is read back from the tables on disk, so that a picture can be drawn again long
//! after the run. A description turns columns into layers; [`render`](super::render) draws them.

mod accuracy;
mod curve;
mod diagram;
mod displacement;
mod error;
mod friction;
pub(crate) mod map;
pub(crate) mod multipliers;
mod names;
mod phase_plane;
mod pressure;
mod profile;
mod simulation;
mod sole;
mod spectrum;
pub(crate) mod steady;
mod switches;
mod tables;
mod wave;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

pub use error::PlotError;

use super::render::{Format, Picture, number};
use super::store;
use crate::model::Parameter;
use crate::problem::{Plot, Problem};
pub(crate) use diagram::View;
use profile::Profiles;
pub(crate) use sole::{Sole, draw_curve, draw_sole};
use tables::Tables;

/// Name of a picture's file.
pub(crate) fn file_name(plot: &Plot, format: Format) -> String {
    // A column name comes from a file and must not lead out of the folder.
    let safe = |c: char| {
        if c.is_alphanumeric() || c == '-' {
            c
        } else {
            '_'
        }
    };
    let stem = match plot {
        Plot::Diagram => "diagram",
        Plot::Pressure => "pressure",
        Plot::Displacement => "displacement",
        Plot::Wave => "wave",
        Plot::PhasePlane => "phase_plane",
        Plot::Friction => "friction",
        Plot::Spectrum => "spectrum",
        Plot::Multipliers => "multipliers",
        Plot::Column(name) => &format!("column_{}", name.chars().map(safe).collect::<String>()),
    };
    format!("{stem}.{}", format.extension())
}

/// Names of the files of a simulation's pictures.
pub(crate) fn simulation_names(format: Format) -> [String; 4] {
    ["space_time", "velocity", "phase_plane", "profiles"]
        .map(|name| format!("{name}.{}", format.extension()))
}

/// What the pictures have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Settings {
    /// Column of `branch.csv` on the horizontal axis.
    pub parameter: String,
    /// Line of text above each picture.
    pub title: Option<String>,
    /// The parameters that are the same along the branch.
    pub subtitle: String,
    /// Labels of the waves to draw; chosen where it is empty.
    pub labels: Vec<usize>,
}

impl Settings {
    /// Those of a problem.
    pub(crate) fn of(problem: &Problem, parameter: Parameter) -> Settings {
        Settings {
            parameter: parameter.column().to_owned(),
            title: problem.title.clone(),
            subtitle: constant_parameters(problem, parameter),
            labels: problem.output.labels.clone(),
        }
    }

    /// A picture with its title and subtitle.
    fn above(&self, picture: Picture) -> Picture {
        Picture {
            subtitle: Some(self.subtitle.clone()).filter(|text| !text.is_empty()),
            ..picture.titled(self.title.as_deref())
        }
    }
}

/// The mode and the parameters that differ from zero, but for the one on the axis.
fn constant_parameters(problem: &Problem, axis: Parameter) -> String {
    let others = Parameter::ALL.into_iter().filter(|one| *one != axis);
    let values = others.filter_map(|one| Some((one, problem.model.value(one)?)));
    let mut words = vec![format!("k = {}", problem.wave.mode)];
    words.extend(
        values
            .filter(|(_, value)| *value != 0.0)
            .map(|(one, value)| format!("{} = {}", one.symbol(), number::significant(value, 4))),
    );
    words.join(", ")
}

/// Draws one column of the branch, the parameter of the settings on the horizontal axis.
///
/// # Errors
///
/// As [`draw`].
pub(crate) fn draw_view(
    folder: &Path,
    view: &View,
    format: Format,
    settings: &Settings,
) -> Result<PathBuf, PlotError> {
    let tables = Tables::read(folder, &settings.parameter)?;
    let drawn = match view.column.as_str() {
        "speed" => diagram::diagram(&tables, view)?,
        _ => diagram::picture(&tables, view)?,
    };
    let path = folder.join(view_name(format));
    replace(&path, format, &settings.above(drawn))?;
    Ok(path)
}

/// Name of the picture of a view.
pub(crate) fn view_name(format: Format) -> String {
    format!("view.{}", format.extension())
}

/// Draws the pictures into the folder and returns the files written.
///
/// # Errors
///
/// Returns an error when a table cannot be read or lacks a column, when the parameter or a
/// picture's column is unknown, when the format is not compiled in, or when a file cannot be
/// written. The other pictures are drawn all the same.
pub(crate) fn draw(
    folder: &Path,
    plots: &[Plot],
    format: Format,
    settings: &Settings,
) -> Result<Vec<PathBuf>, PlotError> {
    let format = format.available()?;
    let tables = Tables::read(folder, &settings.parameter)?;
    let profiles = match plots.iter().any(of_waves) {
        true => Profiles::read(folder, &tables, &settings.labels)?,
        false => Profiles::default(),
    };
    let drawn: Vec<Result<PathBuf, PlotError>> = plots
        .par_iter()
        .map(|plot| {
            let path = folder.join(file_name(plot, format));
            let picture = describe(plot, &tables, &profiles)?;
            replace(&path, format, &settings.above(picture))?;
            Ok(path)
        })
        .collect();
    // the first error in the order of the pictures, whichever came first in time
    drawn.into_iter().collect()
}

/// Whether a picture shows the waves in the folder of profiles.
fn of_waves(plot: &Plot) -> bool {
    use Plot::{Displacement, Friction, PhasePlane, Pressure, Wave};
    matches!(plot, Pressure | Displacement | Wave | PhasePlane | Friction)
}

/// The picture that is asked for.
fn describe(plot: &Plot, tables: &Tables, profiles: &Profiles) -> Result<Picture, PlotError> {
    Ok(match plot {
        Plot::Diagram => diagram::diagram(tables, &View::whole("speed"))?,
        Plot::Column(name) if name == "switches" => switches::picture(tables)?,
        Plot::Column(name) => diagram::picture(tables, &View::whole(name))?,
        Plot::Pressure => pressure::picture(profiles),
        Plot::Displacement => displacement::picture(profiles),
        Plot::Wave => wave::picture(profiles),
        Plot::PhasePlane => phase_plane::picture(profiles),
        Plot::Friction => friction::picture(profiles),
        Plot::Spectrum => spectrum::picture(tables)?,
        Plot::Multipliers => multipliers::picture(tables)?,
    })
}

/// Draws the pictures of a simulation from the tables of its folder and returns the files written.
///
/// # Errors
///
/// When a table cannot be read, a file cannot be written, or the format is not compiled in.
pub(crate) fn draw_simulation(
    folder: &Path,
    problem: &Problem,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let pictures = simulation::pictures(folder, problem)?;
    let title = problem.title.as_deref();
    let named = simulation_names(format).into_iter().zip(pictures);
    named
        .map(|(name, picture)| {
            let path = folder.join(name);
            replace(&path, format, &picture.titled(title))?;
            Ok(path)
        })
        .collect()
}

/// Writes a picture.
///
/// # Errors
///
/// When the format is not compiled in or the file cannot be written.
pub(crate) fn save(path: &Path, format: Format, picture: &Picture) -> Result<(), PlotError> {
    let bytes = picture.file(format)?;
    Ok(fs::write(path, bytes).map_err(store::io_error("write it", path))?)
}

/// Writes a picture into a result folder.
///
/// # Errors
///
/// When the format is not compiled in or the file cannot be written.
pub(crate) fn replace(path: &Path, format: Format, picture: &Picture) -> Result<(), PlotError> {
    let bytes = picture.file(format)?;
    Ok(store::replace(path, |out| {
        out.write_all(&bytes)
            .map_err(store::io_error("write it", path))
    })?)
}

#[cfg(test)]
mod tests;
