//! Pictures of a result folder, one short description each.
//!
//! Everything is read back from the tables on disk, so that a picture can be drawn again long
//! after the run. A description turns columns into layers; [`render`](super::render) draws them.

mod accuracy;
pub(crate) mod codes;
pub(crate) mod colours;
pub(crate) mod curve;
mod diagram;
mod displacement;
pub(crate) mod map;
pub(crate) mod motion;
pub(crate) mod multipliers;
mod names;
mod orbit_kind;
pub(crate) mod orbits;
pub(crate) mod page;
mod profile;
pub(crate) mod scan;
pub(crate) mod shares;
mod simulation;
mod spectrum;
pub(crate) mod steady;
mod switches;
mod tables;
mod view;
mod waves;

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use super::accuracy::rows;
use super::curve::CurveFolder;
use super::layout::{self, STEADY};
use super::render::{Format, Picture, RenderError};
use super::store::{self, FolderKind, Store, StoreError, unfinished};
use super::waves::separates;
use crate::curve::WavesInPlane;
use crate::problem::{Plot, Problem};
use crate::tube::model::{Landing, Parameter};
use names::constant_parameters;
use profile::Profiles;
use tables::Tables;
pub(crate) use view::{NoView, View};

/// Failure to draw a picture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PlotError {
    /// A table could not be read, or a picture not be written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A view would show nothing.
    #[error(transparent)]
    View(#[from] NoView),
    /// A picture could not be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A picture by the name of its file, without the extension.
type Named = (String, Result<Picture, StoreError>);

/// Draws the pictures of a folder, each with the title of its problem, and returns the files. Folders of
/// earlier versions may not tell their problem.
///
/// # Errors
/// When a table cannot be read or lacks a column, when the format was left out of this build, or when a
/// file cannot be written. The other pictures are drawn all the same.
pub(crate) fn draw(
    store: &Store,
    problem: Option<&Problem>,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let folder = store.path();
    let picture = match (store.kind(), problem) {
        (Some(FolderKind::Map), Some(problem)) => map::picture(folder, problem),
        (Some(FolderKind::Curve), _) => CurveFolder::saved::<WavesInPlane>(store).map(|saved| {
            let ranges = saved.head().limits.ranges;
            curve::of_waves(&saved.curve(), ranges, problem)
        }),
        (Some(FolderKind::Accuracy), _) => rows(folder).map(|rows| accuracy::picture(&rows)),
        (Some(FolderKind::Steady), _) => {
            store::table(&folder.join(STEADY)).map(|modes| steady::picture(&modes, problem))
        }
        (Some(FolderKind::Map), None) => {
            return Err(unfinished(folder, "map", "no row is there yet").into());
        }
        (Some(FolderKind::Simulation), None) => {
            return Err(unfinished(folder, "simulate", "nothing is saved yet").into());
        }
        (Some(FolderKind::Simulation), Some(known)) => {
            let pictures = simulation::pictures(folder, known)?.map(Ok);
            let names = layout::MOTION.map(str::to_owned);
            return put(store, problem, format, names.into_iter().zip(pictures));
        }
        (None | Some(FolderKind::Run), Some(known)) => {
            return put(store, problem, format, of_branch(folder, known)?);
        }
        _ => return Ok(Vec::new()),
    };
    let name = store.kind().map_or("", FolderKind::name).to_owned();
    put(store, problem, format, [(name, picture)])
}

/// Draws the errors and run times of a system.
///
/// # Errors
/// As [`draw`].
pub(crate) fn draw_accuracy(
    store: &Store,
    title: Option<&str>,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let picture = rows(store.path()).map(|rows| {
        let picture = accuracy::picture(&rows);
        match title {
            Some(title) => picture.subtitled(title),
            None => picture,
        }
    });
    let name = FolderKind::Accuracy.name().to_owned();
    put(store, None, format, [(name, picture)])
}

/// The pictures that a problem asks for.
fn of_branch(folder: &Path, problem: &Problem) -> Result<Vec<Named>, StoreError> {
    let Some(section) = &problem.continuation else {
        return Ok(Vec::new());
    };
    let plots = &problem.output.plots;
    let tables = Tables::read(folder, section.parameter.column())?;
    let profiles = match plots.iter().any(Plot::shows_profiles) {
        true => Profiles::read(folder, &tables, &problem.output.labels)?,
        false => Profiles::default(),
    };
    let subtitle = caption(problem, section.parameter, &tables);
    let picture = |plot: &Plot| {
        let described = describe(plot, &tables, &profiles);
        (
            layout::plot(plot),
            described.map(|picture| picture.subtitled(&subtitle)),
        )
    };
    Ok(plots.iter().map(picture).collect())
}

/// Name of the file of a view.
pub(crate) fn view_file(format: Format) -> String {
    layout::picture(layout::VIEW, format)
}

/// Draws one column of the branch over another one, or over the parameter.
///
/// # Errors
/// As [`draw`].
pub(crate) fn draw_view(
    store: &Store,
    problem: &Problem,
    x: Option<&str>,
    view: &View,
    format: Format,
) -> Result<Vec<PathBuf>, PlotError> {
    let parameter = problem.parameter();
    let tables = Tables::read(store.path(), x.unwrap_or(parameter.column()))?;
    tables.check_column(&view.column)?;
    view.check(problem, &tables)?;
    let drawn = match view.column.as_str() {
        "speed" => diagram::diagram(&tables, view)?,
        _ => diagram::picture(&tables, view)?,
    };
    let drawn = drawn.subtitled(&caption(problem, parameter, &tables));
    let named = [(layout::VIEW.to_owned(), Ok(drawn))];
    put(store, Some(problem), format, named)
}

/// The constant parameters of a branch, and what its landings are.
fn caption(problem: &Problem, axis: Parameter, tables: &Tables) -> String {
    let mut words = constant_parameters(problem, &[axis]);
    // a restart brings its own model
    if separates(&tables.branch) && problem.wave.start.label().is_none() {
        words.push_str(", ");
        words.push_str(Landing::of(&problem.model, axis).name());
    }
    words
}

/// The picture that is asked for.
fn describe(plot: &Plot, tables: &Tables, profiles: &Profiles) -> Result<Picture, StoreError> {
    Ok(match plot {
        Plot::Diagram => diagram::diagram(tables, &View::whole("speed"))?,
        Plot::Column(name) if name == "switches" => switches::picture(tables)?,
        Plot::Column(name) => diagram::picture(tables, &View::whole(name))?,
        Plot::Pressure => waves::pressure(profiles),
        Plot::Displacement => displacement::picture(profiles),
        Plot::Wave => waves::wave(profiles),
        Plot::PhasePlane => waves::phase_plane(profiles),
        Plot::Friction => waves::friction(profiles),
        Plot::Spectrum => spectrum::picture(tables)?,
        Plot::Multipliers => multipliers::picture(tables)?,
    })
}

/// Writes pictures into a folder, each with the title of the problem.
///
/// # Errors
/// As [`draw`].
pub(crate) fn put(
    store: &Store,
    problem: Option<&Problem>,
    format: Format,
    pictures: impl IntoIterator<Item = Named>,
) -> Result<Vec<PathBuf>, PlotError> {
    let pictures: Vec<Named> = pictures.into_iter().collect();
    store.claim(
        pictures
            .iter()
            .map(|(name, _)| layout::picture(name, format)),
    )?;
    let drawn: Vec<Result<PathBuf, PlotError>> = pictures
        .into_par_iter()
        .map(|(name, picture)| {
            let name = layout::picture(&name, format);
            let picture = match problem {
                Some(problem) => of_problem(problem, picture?),
                None => picture?,
            };
            store.replace_derived(&name, &picture.file(format)?)?;
            Ok(store.path().join(name))
        })
        .collect();
    // the first error in the order of the pictures, whichever came first in time
    drawn.into_iter().collect()
}

/// A picture with the title of its problem, and with units where the problem says what they are.
pub(crate) fn of_problem(problem: &Problem, picture: Picture) -> Picture {
    let title = problem.title.as_deref();
    // one with a title of its own has that of the problem below it
    let below = title.filter(|_| picture.title.is_some() && picture.subtitle.is_none());
    let picture = match below {
        Some(title) => picture.subtitled(title),
        None => picture.titled(title),
    };
    match problem.output.rotation {
        Some(_) => picture.dimensional(),
        None => picture,
    }
}

/// Writes a picture to a file that the user has named, with the title of its problem.
///
/// # Errors
/// When the format was left out of this build or the file cannot be written.
pub(crate) fn save(
    (path, format): (&Path, Format),
    problem: &Problem,
    picture: Picture,
) -> Result<(), PlotError> {
    let bytes = of_problem(problem, picture).file(format)?;
    Ok(fs::write(path, bytes).map_err(store::io_error("write it", path))?)
}

#[cfg(test)]
mod tests;
