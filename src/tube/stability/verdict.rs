//! The verdict on a wave, and what it rests on.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What a verdict or a count rests on, where the count of growing eigenvalues does not say it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum VerdictReason {
    /// A growing eigenvalue at a frequency above those that count.
    BeyondWindow {
        /// Re λ > 0, in units of Ω.
        re: f64,
        /// Im λ, in units of Ω.
        im: f64,
        /// Bloch sector j of it.
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
    /// The number of growing eigenvalues of a sector is not that at the point before with what crosses the axis between.
    Count {
        /// Bloch sector.
        sector: usize,
        /// Growing ones at the point before, and what crosses.
        before: usize,
        /// Growing ones here.
        here: usize,
        /// Whether a crossing was not located; otherwise they pass the edge of the window.
        is_lost: bool,
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

impl fmt::Display for VerdictReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            VerdictReason::BeyondWindow { re, im, sector } => write!(
                f,
                "grows beyond max_frequency: {re:.3e} at frequency {im:.4e} of sector {sector}"
            ),
            VerdictReason::HighFrequency(limit) if limit.is_infinite() => {
                f.write_str("grows at high frequency without bound")
            }
            VerdictReason::HighFrequency(limit) => {
                write!(f, "grows at high frequency: sup Re = {limit:.3e}")
            }
            VerdictReason::Unsettled(limit) if *limit <= 0.0 => write!(
                f,
                "growth beyond the frequencies searched is not excluded, though sup Re tends to {limit:.3e}"
            ),
            VerdictReason::Unsettled(limit) => {
                write!(f, "high frequency is not settled: sup Re <= {limit:.3e}")
            }
            VerdictReason::Sectors(sectors) => {
                let list: Vec<String> = sectors.iter().map(usize::to_string).collect();
                write!(f, "sectors not asked for: {}", list.join(" "))
            }
            VerdictReason::Incomplete { listed, counted } => match counted {
                Some(counted) if counted == listed => write!(
                    f,
                    "incomplete: all {listed} growing eigenvalues are listed but not all others"
                ),
                Some(counted) => write!(
                    f,
                    "incomplete: {listed} growing eigenvalues listed of {counted} counted"
                ),
                None => write!(
                    f,
                    "incomplete: {listed} growing eigenvalues listed and not counted: a lower bound"
                ),
            },
            VerdictReason::Count {
                sector,
                before,
                here,
                is_lost,
            } => {
                let cause = match is_lost {
                    true => "a crossing that was not located",
                    false => "they pass max_frequency and not the imaginary axis",
                };
                write!(
                    f,
                    "sector {sector} goes from {before} growing eigenvalues to {here} since the point before: {cause}"
                )
            }
            VerdictReason::OnAxis => f.write_str("an eigenvalue is on the imaginary axis"),
            VerdictReason::NoWindow => {
                f.write_str("a zone without length makes the spectrum singular")
            }
            VerdictReason::Spent => {
                f.write_str("the eigenvalues that a run may compute are used up")
            }
            VerdictReason::NotLinearised(reason) => f.write_str(reason),
            VerdictReason::Family => {
                f.write_str("the vertical family at a Hopf point is not examined")
            }
        }
    }
}
