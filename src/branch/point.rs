//! Result vocabulary: what a branch is made of, as plain data without behaviour.
//!
//! The continuation produces these values, the exporters and the plots read them; neither side
//! knows the other.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::model::Model;

/// Kind of a special point, two letters after the habit of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum EventType {
    /// End point of the branch: an edge of the range, the start, or a requested stop.
    EP,
    /// The continuation failed here; the reason is in [`Event::what`].
    MX,
    /// User point: a value asked for in `stop_at`.
    UZ,
    /// Limit point (fold) in the continuation parameter.
    LP,
    /// A complex pair of eigenvalues crosses Re λ = 0 in the named Bloch sector.
    HB,
    /// A real eigenvalue crosses zero in the named Bloch sector other than by a fold.
    BP,
    /// Take-off at zero pressure: a separation zone opens or closes.
    GR,
    /// A reverse-slip zone opens or closes between slip and stick.
    RV,
    /// Two switching points coalesce: a zone vanishes or is born between others.
    CO,
    /// The stick zone vanishes.
    ST,
}

impl EventType {
    /// All types, in the order in which legends list them.
    pub const ALL: [EventType; 10] = [
        EventType::EP,
        EventType::MX,
        EventType::UZ,
        EventType::LP,
        EventType::HB,
        EventType::BP,
        EventType::GR,
        EventType::RV,
        EventType::CO,
        EventType::ST,
    ];

    /// Whether events of this type are found in the spectrum: they have a sector and an Im λ.
    pub fn of_spectrum(self) -> bool {
        matches!(self, EventType::HB | EventType::BP)
    }
}

impl fmt::Display for EventType {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            EventType::EP => "EP",
            EventType::MX => "MX",
            EventType::UZ => "UZ",
            EventType::LP => "LP",
            EventType::HB => "HB",
            EventType::BP => "BP",
            EventType::GR => "GR",
            EventType::RV => "RV",
            EventType::CO => "CO",
            EventType::ST => "ST",
        })
    }
}

impl FromStr for EventType {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        EventType::ALL
            .into_iter()
            .find(|kind| kind.to_string() == text)
            .ok_or_else(|| format!("`{text}` is not an event type"))
    }
}

impl Stability {
    /// As a word.
    pub fn word(self) -> &'static str {
        match self {
            Stability::Yes => "yes",
            Stability::No => "no",
            Stability::Undecided => "undecided",
        }
    }
}

/// Stability of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stability {
    /// Proven stable against every perturbation of the full circle.
    Yes,
    /// At least one growing mode.
    No,
    /// Neither could be shown.
    Undecided,
}

/// What a verdict or a count rests on, where the count of growing eigenvalues does not say it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reason {
    /// A growing eigenvalue at a frequency above those that count.
    BeyondWindow {
        /// Re λ.
        re: f64,
        /// Im λ.
        im: f64,
        /// Bloch sector.
        sector: usize,
    },
    /// Eigenvalues grow at high frequency: the limit of sup Re λ, infinite with static friction.
    HighFrequency(f64),
    /// No growth was found, and the limit of sup Re λ at high frequency is positive but only a bound,
    /// or negative but not shown to hold beyond the frequencies searched.
    Unsettled(f64),
    /// Bloch sectors that were not asked for, and may hold growth.
    Sectors(Vec<usize>),
    /// Fewer eigenvalues are listed than there are.
    Incomplete {
        /// Growing ones in the list, on the full circle.
        listed: usize,
        /// Growing ones by the argument principle, where they could be counted.
        counted: Option<usize>,
    },
    /// An eigenvalue lies on the imaginary axis.
    OnAxis,
    /// No window could be searched: a zone without length makes its switch 0/0.
    NoWindow,
    /// The eigenvalues that a run may compute are used up.
    Spent,
    /// There is no eigenvalue problem for this wave.
    NotLinearised(String),
    /// Waves of the vertical family at a Hopf point are not examined.
    Family,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Reason::BeyondWindow { re, im, sector } => write!(
                f,
                "grows beyond max_frequency: {re:.3e} at frequency {im:.4e} of sector {sector}"
            ),
            Reason::HighFrequency(limit) if limit.is_infinite() => {
                f.write_str("grows at high frequency without bound")
            }
            Reason::HighFrequency(limit) => {
                write!(f, "grows at high frequency: sup Re = {limit:.3e}")
            }
            Reason::Unsettled(limit) => {
                write!(f, "high frequency is not settled: sup Re <= {limit:.3e}")
            }
            Reason::Sectors(sectors) => {
                let list: Vec<String> = sectors.iter().map(usize::to_string).collect();
                write!(f, "sectors not asked for: {}", list.join(" "))
            }
            Reason::Incomplete { listed, counted } => {
                write!(f, "incomplete: {listed} growing eigenvalues listed")?;
                match counted {
                    Some(counted) => write!(f, " of {counted} counted"),
                    None => f.write_str(" and not counted: a lower bound"),
                }
            }
            Reason::OnAxis => f.write_str("an eigenvalue is on the imaginary axis"),
            Reason::NoWindow => f.write_str("a zone without length makes the spectrum singular"),
            Reason::Spent => f.write_str("the eigenvalues that a run may compute are used up"),
            Reason::NotLinearised(reason) => f.write_str(reason),
            Reason::Family => f.write_str("the vertical family at a Hopf point is not examined"),
        }
    }
}

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
    pub why: Vec<Reason>,
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

/// One sample of a wave over its wavelength: a row of `profiles/LABEL.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ProfileSample {
    /// θ from release, time-forward, in [0, 2π/k].
    pub theta: f64,
    /// Radial displacement U at the contact surface.
    #[serde(rename = "U")]
    pub radial: f64,
    /// Tangential displacement V at the contact surface.
    #[serde(rename = "V")]
    pub tangential: f64,
    /// U̇ following the material point.
    #[serde(rename = "U_dot")]
    pub radial_rate: f64,
    /// V̇ following the material point.
    #[serde(rename = "V_dot")]
    pub tangential_rate: f64,
    /// Contact pressure P.
    #[serde(rename = "P")]
    pub pressure: f64,
    /// Friction force Q.
    #[serde(rename = "Q")]
    pub shear: f64,
    /// Name of the regime.
    pub regime: &'static str,
}
