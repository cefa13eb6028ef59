//! Result vocabulary: what a branch is made of, as plain data.
//!
//! The continuation produces these values, the exporters and the plots read them; neither side
//! knows the other.

pub use crate::orbit::EventType;
pub use crate::orbit::Stability;
use crate::problem::compare::Occurrence;
use crate::tube::model::{Model, Parameter};
pub use crate::tube::stability::verdict::VerdictReason;
pub use crate::tube::wave::profile::ProfileSample;

/// The leading eigenvalue of a wave, the translation mode left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadingEigenvalue {
    /// Re λ, in units of Ω.
    pub re: f64,
    /// Im λ in its sector, in units of Ω.
    pub im: f64,
    /// Bloch sector.
    pub sector: usize,
}

/// One accepted point of a branch: a row of `branch.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchPoint {
    /// Running number from 1.
    pub point: usize,
    /// Label of a labelled point: the key of events, spectra and profiles.
    pub label: Option<usize>,
    /// Type of a special point.
    pub kind: Option<EventType>,
    /// Regimes from release, time-forward, joined by `-`.
    pub regimes: String,
    /// Model with the parameters of the point.
    pub model: Model,
    /// Wave speed c, signed, in units of Ω (radians of φ per unit of time).
    pub speed: f64,
    /// End of each zone: θ from release, time-forward, in (0, 2π/k].
    pub switches: Vec<f64>,
    /// Least contact pressure P over the zones in contact.
    pub min_pressure: f64,
    /// max(U − δ), zero without separation.
    pub max_gap: f64,
    /// Half the difference of the largest and the smallest V.
    pub amplitude: f64,
    /// Stability; `None` when not asked for.
    pub stable: Option<Stability>,
    /// Eigenvalues counted with Re λ > 0; `None` when not asked for.
    pub unstable: Option<usize>,
    /// Leading eigenvalue; `None` when not asked for.
    pub lead: Option<LeadingEigenvalue>,
    /// What the verdict and the count rest on, where that is not plain.
    pub why: Vec<VerdictReason>,
    /// Newton iterations spent on the point.
    pub newton: usize,
    /// Largest scaled residual of the boundary-value problem.
    pub residual: f64,
    /// Condition number of the Newton matrix and expected error of the scaled unknowns; `None` when
    /// not asked for.
    pub conditioning: Option<(f64, f64)>,
}

/// A special point: a row of `events.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Label of the point in `branch.csv`.
    pub label: usize,
    /// Type of the event.
    pub kind: EventType,
    /// Model with the parameters of the event.
    pub model: Model,
    /// Wave speed c at the event.
    pub speed: f64,
    /// Bloch sector (`HB`, `BP`).
    pub sector: Option<usize>,
    /// Im λ at the crossing (`HB`).
    pub omega: Option<f64>,
    /// Regimes before the event, along the branch.
    pub regimes_before: String,
    /// Regimes after the event, along the branch.
    pub regimes_after: String,
    /// Bound or honest estimate of the error of the located parameter.
    pub uncertainty: f64,
    /// A short sentence.
    pub what: String,
}

impl Event {
    /// What can be expected of it.
    pub fn occurrence(&self) -> Occurrence {
        let parameters = Parameter::ALL.into_iter();
        let parameters = parameters.map(|one| (one.column(), self.model.value(one)));
        let own = [("speed", Some(self.speed)), ("omega", self.omega)];
        let numbers = own.into_iter().chain(parameters);
        Occurrence {
            kind: self.kind,
            label: self.label,
            sector: self.sector,
            numbers: numbers
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
            regimes: [self.regimes_before.clone(), self.regimes_after.clone()],
        }
    }
}
