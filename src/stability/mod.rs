//! Stability of a wave: its whole spectrum from the eigenfunction problem.
//!
//! [`characteristic`] turns a wave into analytic functions of λ whose zeros are the eigenvalues,
//! [`asymptotic`] says what they do at high frequency, [`spectrum`] finds all of them in a window,
//! [`eigenfunction`] gives their shapes, and [`track`] follows them along a branch.
//! [`discretised`] is a check that shares nothing with these but the model.

pub mod asymptotic;
pub mod characteristic;
pub mod discretised;
pub mod eigenfunction;
mod material;
mod perturbation;
mod separation;
pub mod spectrum;
pub mod track;

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
