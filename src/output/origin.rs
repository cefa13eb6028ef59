//! The problem that a result was computed from, kept beside it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::layout::{MAP_ORIGIN, SCAN_ORIGIN};
use super::run::RESTART;
use super::simulation::SimulationCheckpoint;
use super::store::{Checkpoint, Store, StoreError, VERSION, decode};
use crate::problem::{Any, Problem, SystemProblem};

/// Content of `problem.ron`, and of `map.ron` in the folder of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ProblemOrigin<P = Problem> {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: P,
}

impl<P: Clone + Serialize> ProblemOrigin<P> {
    /// Name of the file where nothing else keeps the problem.
    pub(crate) const FILE: &'static str = "problem.ron";

    /// A problem of this version.
    pub(crate) fn of(problem: &P) -> ProblemOrigin<P> {
        ProblemOrigin {
            version: VERSION.to_owned(),
            problem: problem.clone(),
        }
    }

    /// Keeps the problem of a result.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn keep(store: &Store, problem: &P) -> Result<(), StoreError> {
        store.save(Self::FILE, &ProblemOrigin::of(problem))
    }
}

/// The problem of a folder; those of earlier versions may not tell.
///
/// # Errors
/// When what is saved of it is damaged.
pub(crate) fn problem(folder: &Path) -> Result<Option<Any>, StoreError> {
    // what else a checkpoint holds is for going on, and may be of an earlier version
    let files: [&str; 5] = [
        RESTART,
        SimulationCheckpoint::FILE,
        MAP_ORIGIN,
        SCAN_ORIGIN,
        ProblemOrigin::<Problem>::FILE,
    ];
    let file = files.into_iter().find(|name| folder.join(name).exists());
    let Some(path) = file.map(|file| folder.join(file)) else {
        return Ok(None);
    };
    // each kind lacks what the other has
    Ok(Some(match decode::<ProblemOrigin<SystemProblem>>(&path) {
        Ok(origin) => Any::System(Box::new(origin.problem)),
        Err(_) => Any::Tube(Box::new(decode::<ProblemOrigin>(&path)?.problem)),
    }))
}
