//! Bloch sectors.

use serde::{Deserialize, Serialize};

/// A choice of Bloch sectors.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sectors {
    /// Every sector from 0 to half the mode.
    #[default]
    All,
    /// The listed sectors, each at most half the mode.
    Only(Vec<usize>),
}

impl Sectors {
    /// The sectors in ascending order, for waves of a mode.
    pub(crate) fn list(&self, mode: u32) -> Vec<usize> {
        match self {
            Sectors::All => (0..=mode as usize / 2).collect(),
            Sectors::Only(list) => {
                let mut list = list.clone();
                list.sort_unstable();
                list
            }
        }
    }
}
