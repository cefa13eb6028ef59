//! What happens along a branch of waves.

use std::fmt::{self, Display, Formatter};

use super::branch::Told;
use super::figures::{PLACE, significant};
use super::{list, near_zero};
use crate::branch::VerdictReason;
use crate::branch::special::{
    Change, InadmissibleWave, OfWaves, WaveMargin, WaveNote, WaveTermination,
};
use crate::orbit::EventType;
use crate::orbit::special::BranchTermination;
use crate::tube::model::signature::Regime;
use crate::tube::model::{Impact, Landing};
use crate::tube::stability::track::Remark;
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::WaveWatch;

/// What is left of a wave where D = 0.
const D_ZERO: &str = "D = 0: nothing drives a wave here; what is left is steady sliding with a linear wave \
                      of arbitrary amplitude, which neither grows nor decays";

#[cfg_attr(not(feature = "cli"), allow(dead_code))]
impl Landing {
    /// Its name, for captions too.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Landing::Impact(Impact::Frictionless) => "frictionless impact",
            Landing::Impact(Impact::Coulomb) => "Coulomb impact",
            Landing::Damped => "damped landing",
        }
    }

    pub(crate) fn remark(self) -> &'static str {
        match self {
            Landing::Impact(Impact::Frictionless) => {
                "the law of the 2008 paper, which is not the limit of any damped model; \
                 `impact: Coulomb` is (docs/waves.md)"
            }
            Landing::Impact(Impact::Coulomb) => {
                "the limit of small material damping (docs/waves.md)"
            }
            Landing::Damped => "with material damping there is no impact (docs/waves.md)",
        }
    }
}

impl Display for OfWaves {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            OfWaves::HopfPoint => f.write_str("the Hopf point of steady sliding"),
            OfWaves::StickOpens => f.write_str("V̇ reaches 1: a stick zone opens"),
            OfWaves::CoulombLimit => f.write_str(
                "edge of the range, stiffness_damping = 0: the limit of little damping is this wave \
                 with Coulomb impacts, whatever `impact` says",
            ),
            OfWaves::Crossing {
                sector,
                omega,
                grows,
            } => {
                let what = if omega.is_some() {
                    "complex pair"
                } else {
                    "real eigenvalue"
                };
                let becomes = if *grows { "unstable" } else { "stable" };
                write!(f, "a {what} of sector {sector} becomes {becomes}")
            }
            OfWaves::Repeats => f.write_str("the wave is one of half its wavelength"),
        }
    }
}

impl Told for Wave {
    const NAME: &'static str = "wave";

    fn event(change: &Change) -> String {
        let regime = change.before.zone(change.margin.zone).regime;
        let name = regime.name();
        let closes = change.margin.watch == WaveWatch::Duration;
        match change.kind {
            EventType::GR if closes => "the separation zone closes".into(),
            EventType::GR => {
                format!("the pressure touches zero in a {name} zone: separation opens")
            }
            EventType::RV if closes => "the reverse-slip zone closes before stick".into(),
            EventType::RV => "reverse slip opens before stick".into(),
            EventType::ST if closes && regime == Regime::Stick => "the stick zone vanishes".into(),
            EventType::ST
                if matches!(
                    change.end,
                    Some(BranchTermination::Own(WaveTermination::Misses))
                ) =>
            {
                "slip reaches V̇ = 1 with V̈ = 0".into()
            }
            EventType::ST => "a stick zone opens".into(),
            _ if closes => {
                let after = change.after.as_ref();
                if after.is_some_and(|after| after.len() == change.before.len()) {
                    format!("V̇ = 1 at both ends of a {name} zone: it gives way to another")
                } else {
                    format!("the {name} zone between its neighbours shrinks to nothing")
                }
            }
            _ => match change.margin.watch {
                WaveWatch::Gap => "the separated surface touches the shaft".into(),
                WaveWatch::Rate => format!("V̇ = 1 is touched inside a {name} zone"),
                WaveWatch::LandingRate => "landing passes through V̇ = 1".into(),
                WaveWatch::LandingPressure => "the pressure after landing reaches zero".into(),
                WaveWatch::Tension => {
                    "the tension after a touch reaches zero: contact begins".into()
                }
                WaveWatch::Impulse => "the impulse of landing no longer arrests the surface".into(),
                _ => "two switching points coalesce".into(),
            },
        }
    }
}

impl Display for Remark {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Remark::Unpaid => f.write_str(
                "more eigenvalues cross the imaginary axis here than could be located: take a smaller \
                 `max_frequency` or `ds_max`",
            ),
            Remark::Lost => f.write_str(
                "the unstable count changes here and the crossing could not be located",
            ),
            Remark::Jump { before, after } => {
                let counts = |counts: &[(usize, usize)]| {
                    let words = counts.iter();
                    let words = words.map(|(sector, count)| format!("{count} in sector {sector}"));
                    list(&words.collect::<Vec<_>>(), ", ")
                };
                write!(
                    f,
                    "the spectrum is discontinuous here and the unstable count jumps without a crossing: \
                     {} before, {} after",
                    counts(before),
                    counts(after)
                )
            }
        }
    }
}

impl Display for InadmissibleWave {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let InadmissibleWave::Margin {
            regime,
            watch,
            value,
        } = self
        else {
            return f.write_str(match self {
                InadmissibleWave::Undecided => {
                    "an inequality is closer to zero than rounding can tell"
                }
                _ => "a switching condition is crossed the wrong way",
            });
        };
        let what = match watch {
            WaveWatch::Duration => "would have a negative length",
            WaveWatch::Pressure | WaveWatch::LandingPressure => "would have a negative pressure",
            WaveWatch::Rate | WaveWatch::LandingRate => "would pass through V̇ = 1",
            WaveWatch::Gap => "would penetrate the shaft",
            WaveWatch::LandingSpeed => "would land from below",
            WaveWatch::Tension => "would stay in contact",
            WaveWatch::LowerForce | WaveWatch::UpperForce => "would violate the friction law",
            WaveWatch::Impulse => "would land with too small an impulse",
            WaveWatch::Release => "would be released into reverse slip",
            WaveWatch::Coupling => {
                return f.write_str("D = 0 is passed: waves run in the direction of D");
            }
        };
        write!(f, "the {} zone {what} ({value:.1e})", regime.name())
    }
}

impl Display for WaveTermination {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            WaveTermination::Undriven => f.write_str(D_ZERO),
            WaveTermination::Against => f.write_str(
                "D = 0: waves run in the direction of D, and beyond it this one would run against it; \
                 such waves are not followed",
            ),
            WaveTermination::Sonic {
                excess,
                parameter,
                value,
            } => write!(
                f,
                "the speed tends to √a: |c|/√a − 1 = {excess:.1e} falls without end while everything \
                 else tends to a limit; {} is {value:.6} here; waves must be faster than √a",
                parameter.column()
            ),
            WaveTermination::Misses => f.write_str(
                "beyond it slip does not reach V̇ = 1 any more where stick began, and the surface slides on: no wave nearby has \
                 these zones",
            ),
            WaveTermination::LosesDigits { regime, terms } => write!(
                f,
                "what a wave is off at the beginning of a {} zone, which lies next to steady sliding, grows {terms:.0e} times \
                 within it: too few digits are left to go on",
                regime.name()
            ),
            WaveTermination::SlipAlone => f.write_str(
                "what is left is one zone of slip around the whole circumference: linear waves on \
                 steady sliding at its Hopf point, of every amplitude down to none at this one value; \
                 `start: Hopf` lists them",
            ),
            WaveTermination::Repeats { mode } => write!(
                f,
                "the wave is one of mode {mode}, traversed twice: beyond it the branch retraces itself with its halves \
                 exchanged"
            ),
        }
    }
}

impl Display for WaveMargin {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let WaveMargin { regime, watch } = self;
        let regime = regime.name();
        match watch {
            WaveWatch::Duration => write!(f, "the length of a {regime} zone"),
            WaveWatch::Pressure => write!(f, "the least pressure in a {regime} zone"),
            WaveWatch::LandingPressure | WaveWatch::Tension => {
                f.write_str("the pressure after a landing")
            }
            WaveWatch::Rate => write!(f, "|1 − V̇| inside a {regime} zone"),
            WaveWatch::LandingRate => f.write_str("|1 − V̇| after a landing"),
            WaveWatch::Gap => f.write_str("the gap inside a separation zone"),
            WaveWatch::LandingSpeed => f.write_str("the speed of a landing"),
            WaveWatch::Impulse => f.write_str("what the impulse of a landing can arrest"),
            WaveWatch::LowerForce | WaveWatch::UpperForce | WaveWatch::Release => {
                f.write_str("the distance of the friction force from its limit")
            }
            WaveWatch::Coupling => f.write_str("D"),
        }
    }
}

impl Display for WaveNote {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            WaveNote::CrossingLeftOut { parameter, value } => write!(
                f,
                "{} = {}: the wave at a crossing of the imaginary axis before this point could \
                 not be examined, and the crossing is left out",
                parameter.column(),
                significant(*value, PLACE)
            ),
            WaveNote::Spectrum {
                parameter,
                value,
                remark,
            } => {
                let value = significant(*value, PLACE);
                write!(f, "{} = {value}: {remark}", parameter.column())
            }
            WaveNote::Spent { points, allowance } => write!(
                f,
                "after point {points}: {} at {:.0e} a run; take a smaller `max_frequency`, fewer \
                 sectors or fewer points",
                VerdictReason::Spent,
                *allowance as f64
            ),
            WaveNote::Incomplete { point, reason } => write!(
                f,
                "point {point}: the spectrum is {reason}; see the column `why` for others"
            ),
            WaveNote::Close {
                parameter,
                value,
                what,
            } => near_zero(f, parameter.column(), *value, what),
            WaveNote::NotConverged {
                point,
                parameter,
                value,
                tolerance,
                known,
            } => {
                write!(
                    f,
                    "point {point}, {} = {}: not converged to the tolerance {tolerance:.0e}; ",
                    parameter.column(),
                    significant(*value, PLACE)
                )?;
                if known.expected_error.is_nan() {
                    return f.write_str("its equations are singular to rounding");
                }
                write!(
                    f,
                    "the expected error is {:.1e}, the condition number {:.1e}",
                    known.expected_error, known.condition
                )
            }
        }
    }
}
