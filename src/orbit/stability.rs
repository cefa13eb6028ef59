//! Whether an orbit is stable.

use serde::{Deserialize, Serialize};

/// Linear stability of an orbit, of a wave against perturbations of the full circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stability {
    /// Stable, as verified up to rounding, against every perturbation.
    Yes,
    /// At least one growing mode.
    No,
    /// Neither could be shown.
    Undecided,
}

impl Stability {
    /// Its word in tables: "yes", "no" or "undecided".
    pub fn word(self) -> &'static str {
        match self {
            Stability::Yes => "yes",
            Stability::No => "no",
            Stability::Undecided => "undecided",
        }
    }
}
