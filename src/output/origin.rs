//! The problem that a result was computed from, kept beside it where nothing else keeps it.

use serde::{Deserialize, Serialize};

use super::store::{Checkpoint, Store, StoreError, VERSION};
use crate::problem::Problem;

/// Content of `problem.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Origin {
    /// Version of brakewave that wrote it.
    version: String,
    /// The problem with all its settings.
    problem: Problem,
}

impl Checkpoint for Origin {
    const FILE: &'static str = "problem.ron";

    fn problem(&self) -> &Problem {
        &self.problem
    }
}

impl Origin {
    /// Keeps the problem of a result.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn keep(store: &Store, problem: &Problem) -> Result<(), StoreError> {
        store.save(&Origin {
            version: VERSION.to_owned(),
            problem: problem.clone(),
        })
    }
}
