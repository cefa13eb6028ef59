//! The state of a verb that was interrupted.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::{StoreError, damaged};
use super::file::decode;

/// What is saved to go on from: RON, replaced as a whole.
pub(crate) trait Checkpoint: Serialize + DeserializeOwned {
    /// The problem that it is of.
    type Problem: PartialEq;

    const FILE: &'static str;

    /// The problem with all its settings.
    fn problem(&self) -> &Self::Problem;

    /// What is wrong with it, if its parts do not belong together.
    fn flaw(&self) -> Option<String> {
        None
    }

    /// Reads that of a folder.
    ///
    /// # Errors
    /// When it cannot be read, or is damaged.
    fn read(folder: &Path) -> Result<Self, StoreError> {
        let path = folder.join(Self::FILE);
        let found: Self = decode(&path)?;
        match found.flaw() {
            Some(flaw) => Err(damaged(&path, flaw)),
            None => Ok(found),
        }
    }
}
