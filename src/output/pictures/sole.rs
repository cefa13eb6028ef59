//! Folders with one picture: of a map, a curve, errors against run time, or steady sliding.

use std::path::PathBuf;

use super::error::PlotError;
use super::{accuracy, curve, map, replace, steady};
use crate::curve::Curve;
use crate::output::accuracy as errors;
use crate::output::curve::CurveFolder;
use crate::output::map::Description;
use crate::output::origin::Origin;
use crate::output::render::{Format, Picture};
use crate::output::steady::TABLE as MODES;
use crate::output::store::{self, Checkpoint, Kind, Store, StoreError, damaged};

/// What the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sole {
    /// Which waves exist where in a plane of parameters.
    Map,
    /// An event in a plane of parameters.
    Curve,
    /// Error against run time.
    Accuracy,
    /// Growth and Hopf friction of the modes of steady sliding.
    Steady,
}

impl Sole {
    /// That of a kind of folder.
    pub(crate) fn of(kind: Kind) -> Option<Sole> {
        match kind {
            Kind::Map => Some(Sole::Map),
            Kind::Curve => Some(Sole::Curve),
            Kind::Accuracy => Some(Sole::Accuracy),
            Kind::Steady => Some(Sole::Steady),
            Kind::Run | Kind::MapShard | Kind::Simulation | Kind::Certificate => None,
        }
    }

    /// Name of its file.
    pub(crate) fn file(self, format: Format) -> String {
        let stem = match self {
            Sole::Map => "map",
            Sole::Curve => "curve",
            Sole::Accuracy => "accuracy",
            Sole::Steady => "steady",
        };
        format!("{stem}.{}", format.extension())
    }

    /// The picture of what the folder holds.
    fn picture(self, store: &Store) -> Result<Picture, PlotError> {
        let folder = store.path();
        let missing = |name: &str, reason: &str| {
            PlotError::Read(damaged(&folder.join(name), reason.to_owned()))
        };
        Ok(match self {
            Sole::Map => {
                let problem = Description::read(folder).map_err(PlotError::Read)?.problem;
                let section = problem.map.as_ref();
                let section =
                    section.ok_or_else(|| missing(Description::FILE, "it has no section `map`"))?;
                map::picture(folder, section)?
            }
            Sole::Curve => {
                let saved = CurveFolder::saved(store).map_err(PlotError::Read)?;
                let run = saved
                    .ok_or_else(|| missing(crate::output::curve::STEPS, "it is empty"))?
                    .run;
                let ranges = run.head().limits.ranges;
                curve::picture(&run.curve(), ranges)
            }
            Sole::Accuracy => {
                let path = folder.join(errors::TABLE);
                let rows = store::table(&path).map_err(PlotError::Read)?.rows();
                let rows =
                    rows.map_err(|error| PlotError::Read(damaged(&path, error.to_string())))?;
                accuracy::picture(&rows)
            }
            Sole::Steady => {
                steady::picture(&store::table(&folder.join(MODES)).map_err(PlotError::Read)?)
            }
        })
    }
}

/// Draws the picture of a folder with the title of its problem, and returns the file.
///
/// # Errors
/// When what the folder holds cannot be read, or the picture cannot be written.
pub(crate) fn draw_sole(store: &Store, sole: Sole, format: Format) -> Result<PathBuf, PlotError> {
    put(store, sole, sole.picture(store)?, format)
}

/// Draws a curve just followed: to read it back and name its regions again takes as long once more.
///
/// # Errors
/// As [`draw_sole`].
pub(crate) fn draw_curve(
    store: &Store,
    curve: &Curve,
    ranges: [(f64, f64); 2],
    format: Format,
) -> Result<PathBuf, PlotError> {
    put(store, Sole::Curve, curve::picture(curve, ranges), format)
}

fn put(store: &Store, sole: Sole, picture: Picture, format: Format) -> Result<PathBuf, PlotError> {
    let title = title(store).map_err(PlotError::Read)?;
    let name = sole.file(format);
    store.claim([&name])?;
    let path = store.path().join(name);
    replace(&path, format, &picture.titled(title.as_deref()))?;
    Ok(path)
}

/// The title of the problem that a folder was computed from. Folders of earlier versions may not tell.
fn title(store: &Store) -> Result<Option<String>, StoreError> {
    let folder = store.path();
    if folder.join(Description::FILE).exists() {
        return Ok(Description::read(folder)?.problem.title);
    }
    match folder.join(Origin::FILE).exists() {
        true => Ok(Origin::read(folder)?.problem().title.clone()),
        false => Ok(None),
    }
}
