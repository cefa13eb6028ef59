//! What makes a wave special for reasons of the tube, why it is not admissible, and why its branch ends: as data.
//! Their sentences are made in one place, `messages`.

use serde::{Deserialize, Serialize};

use super::VerdictReason;
use super::conditioning::Conditioning;
use crate::orbit::sign::SignVerdict;
use crate::orbit::special as engine;
use crate::tube::model::Parameter;
use crate::tube::model::signature::Regime;
use crate::tube::stability::track::Remark;
use crate::tube::wave::Wave;
use crate::tube::wave::admissibility::{WaveExamination, WaveWatch};

/// What makes a wave special for reasons of the tube.
#[derive(Clone, Debug, PartialEq)]
pub enum OfWaves {
    /// The Hopf point of steady sliding, where a vertical family begins.
    HopfPoint,
    /// The end of that family, where a stick zone opens.
    StickOpens,
    /// An edge of the range at β = 0, where a wave that separates is one with Coulomb impacts.
    CoulombLimit,
    /// An eigenvalue crosses the imaginary axis.
    Crossing {
        /// Bloch sector.
        sector: usize,
        /// Im λ of a complex pair; `None` where the eigenvalue is real.
        omega: Option<f64>,
        /// Whether it becomes unstable along the branch.
        grows: bool,
    },
    /// The wave is one of half its wavelength, traversed twice.
    Repeats,
}

/// A margin of a wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveMargin {
    /// Regime of its zone.
    pub regime: Regime,
    /// What it measures.
    pub watch: WaveWatch,
}

/// Why a branch of waves ends for reasons of the tube.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum WaveTermination {
    /// D = 0 ends the wave.
    Undriven,
    /// D = 0: the wave would run against D.
    Against,
    /// The speed tends to √a.
    Sonic {
        /// |c|/√a − 1.
        excess: f64,
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// One zone of slip is left: steady sliding at its Hopf point.
    SlipAlone,
    /// Slip reaches V̇ = 1, where it ends, with V̈ = 0, and beyond it does not.
    Misses,
    /// The end of a zone is what rounding of its beginning has grown to.
    LosesDigits {
        /// Its regime.
        regime: Regime,
        /// How many times larger than its units are the terms of which the end is the sum.
        terms: f64,
    },
    /// The wave has become one of half its wavelength, traversed twice: the branch would retrace itself with the halves
    /// exchanged.
    Repeats {
        /// Mode of the wave that is left.
        mode: u32,
    },
}

/// What makes a wave special.
pub type Special = engine::Special<Wave>;
/// A change of regime.
pub type Change = engine::Change<Wave>;
/// Why a wave refuses a step.
pub type Refusal = engine::OrbitRefusal<Wave>;
/// Why a branch of waves ends for reasons of its own.
pub type Stop = engine::BranchTermination<Wave>;
/// A signature tried beyond an event and refused.
pub type Tried = engine::Tried<Wave>;
/// Why a branch cannot be followed from a wave.
pub type NoFollower = engine::NoFollower<Wave>;
/// Saved progress from which a run does not go on.
pub type ResumeMismatch = engine::ResumeMismatch<Wave>;
/// What is so close to zero that rounding decides its sign.
pub type Close = engine::Close<WaveMargin>;
/// Why a step along a branch of waves was refused.
pub type StepRefused = engine::StepRefused<Wave>;
/// How the walk along a branch of waves ended.
pub type Ending = engine::Ending<Wave>;
/// Why a branch of waves ended before its range.
pub type Failure = engine::BranchFailure<Wave>;

/// Why a point is not admissible.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum InadmissibleWave {
    /// A margin is negative.
    Margin {
        /// Regime of its zone.
        regime: Regime,
        /// What it measures.
        watch: WaveWatch,
        /// Its value.
        value: f64,
    },
    /// An inequality is closer to zero than rounding can tell.
    Undecided,
    /// A switching condition is crossed the wrong way.
    WrongWay,
}

impl InadmissibleWave {
    /// The worst of what an examination found.
    pub fn of(wave: &Wave, examination: &WaveExamination) -> InadmissibleWave {
        let negative = examination.margins.iter();
        let negative = negative.filter(|margin| margin.jet.value <= 0.0);
        match negative.min_by(|one, other| one.jet.value.total_cmp(&other.jet.value)) {
            Some(margin) => InadmissibleWave::Margin {
                regime: wave.signature.zone(margin.zone).regime,
                watch: margin.watch,
                value: margin.jet.value,
            },
            None if examination.verdict == SignVerdict::Undecided => InadmissibleWave::Undecided,
            None => InadmissibleWave::WrongWay,
        }
    }
}

/// What could not be settled in a run.
#[derive(Clone, Debug, PartialEq)]
pub enum WaveNote {
    /// A crossing before a point is left out: its wave cannot be examined.
    CrossingLeftOut {
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// Something remains to be said of the spectrum.
    Spectrum {
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// What.
        remark: Remark,
    },
    /// The eigenvalues that a run may compute are used up.
    Spent {
        /// Points so far.
        points: usize,
        /// How many there were.
        allowance: usize,
    },
    /// The first point whose eigenvalues are not all listed.
    Incomplete {
        /// Its number.
        point: usize,
        /// Why.
        reason: VerdictReason,
    },
    /// What comes so close to zero at a point, or between it and the one before, that rounding decides.
    Close {
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// What.
        what: Close,
    },
    /// A point is known less well than the tolerance asks.
    NotConverged {
        /// Its number.
        point: usize,
        /// Parameter of the branch.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// The tolerance.
        tolerance: f64,
        /// How well it is known.
        known: Conditioning,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::newton;
    use crate::continuation::walk::{End, Refused};
    use crate::tube::flow::{FlowError, Unsolved};
    use crate::tube::model::signature::Signature;

    /// Why a branch ended is the same after it was saved, whatever it is.
    #[test]
    fn reasons_are_saved_as_data() {
        let flow = FlowError::Integration {
            duration: 0.1 + 0.2,
            reason: Unsolved::NotConverged,
        };
        let inadmissible = Refusal::Inadmissible(InadmissibleWave::Margin {
            regime: Regime::Slip,
            watch: WaveWatch::Pressure,
            value: -1.0e-300,
        });
        let tried = |reason| Tried {
            signature: Some(Signature::slip_stick()),
            reason,
        };
        let step = newton::Failure::Slow {
            correction: f64::INFINITY,
            iterations: 7,
        };
        let ends = [
            End::NoStep {
                ds_min: 1e-9,
                reason: Refused::Curve(inadmissible.clone()),
            },
            End::Own(Stop::NoneAdmissible(vec![
                tried(Refused::Step(step.into())),
                tried(Refused::Step(newton::Failure::System(flow).into())),
                tried(Refused::Pair),
                tried(Refused::Curve(inadmissible.clone())),
            ])),
            End::Own(Stop::Flow(flow)),
        ];
        let mut reasons: Vec<Failure> = ends.map(|end| Failure::Ended(Box::new(end))).into();
        reasons.push(Failure::NoLeg(NoFollower::Refused(inadmissible).into()));
        for reason in reasons {
            let text = ron::to_string(&reason).unwrap();
            let again: Failure = ron::from_str(&text).unwrap();
            assert_eq!(again, reason);
            assert_eq!(again.to_string(), reason.to_string());
        }
    }
}
