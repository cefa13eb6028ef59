//! The problem that a result was computed from, kept beside it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::layout::MAP_ORIGIN;
use super::run::Restart;
use super::simulation::SimulationCheckpoint;
use super::store::{Checkpoint, Store, StoreError, VERSION, decode};
use crate::problem::Problem;

/// Content of `problem.ron`, and of `map.ron` in the folder of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Origin {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: Problem,
}

impl Origin {
    /// Name of the file where nothing else keeps the problem.
    pub(crate) const FILE: &'static str = "problem.ron";

    /// A problem of this version.
    pub(crate) fn of(problem: &Problem) -> Origin {
        Origin {
            version: VERSION.to_owned(),
            problem: problem.clone(),
        }
    }

    /// Keeps the problem of a result.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn keep(store: &Store, problem: &Problem) -> Result<(), StoreError> {
        store.save(Origin::FILE, &Origin::of(problem))
    }
}

/// The problem of a folder; those of earlier versions may not tell.
///
/// # Errors
/// When what is saved of it is damaged.
pub(crate) fn problem(folder: &Path) -> Result<Option<Problem>, StoreError> {
    // what else a checkpoint holds is for going on, and may be of an earlier version
    let files = [
        Restart::FILE,
        SimulationCheckpoint::FILE,
        MAP_ORIGIN,
        Origin::FILE,
    ];
    let file = files.into_iter().find(|name| folder.join(name).exists());
    let origin = file.map(|file| decode::<Origin>(&folder.join(file)));
    Ok(origin.transpose()?.map(|origin| origin.problem))
}
