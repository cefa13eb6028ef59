//! The first wave of a branch.

use std::fmt;

use super::orbit::Follower;
use super::slip_stick::{polish, slip_stick_wave, smooth_wave};
use super::special::{InadmissibleWave, Special};
use super::wanted::{MOST_STEPS, NoFirstWave, SearchFailure, WaveRequest};
use crate::continuation::arclength::{self, DEFAULT_DS, DEFAULT_DS_MAX, DEFAULT_DS_MIN, Steps};
use crate::continuation::walk;
use crate::orbit::entry;
use crate::orbit::follow::Limits;
use crate::orbit::sign::SignVerdict;

use crate::linalg::Vector;
use crate::tube::model::{FrictionLaw, Model, Parameter};
use crate::tube::wave::admissibility::examine;
use crate::tube::wave::hopf::{Family, NoHopf, family};
use crate::tube::wave::start::{self, Which};
use crate::tube::wave::{Wave, WaveScales};

/// The wave of the model, as a boundary-value problem in `parameter` and its solution: the
/// slip-stick wave in closed form or, at a mismatch where that is not admissible any more, the
/// wave that continues it. `width` is the unit of the parameter.
///
/// # Errors
/// There is no such wave, or the search does not come to it.
pub fn first_wave(
    model: &Model,
    parameter: Parameter,
    mode: u32,
    which: Which,
    width: f64,
    steps: Steps,
) -> Result<(Wave, Vector), NoFirstWave> {
    let wanted = WaveRequest {
        model: *model,
        parameter,
        mode,
        which,
        width,
    };
    find(&wanted, steps, &mut |_| {})
}

/// The wave wanted and its solution, with somebody told where the search for it is.
///
/// # Errors
/// There is no such wave, or the search does not come to it.
pub fn find(
    wanted: &WaveRequest,
    steps: Steps,
    observer: Observer,
) -> Result<(Wave, Vector), NoFirstWave> {
    let mut search = FirstWaveSearch {
        wanted,
        steps,
        observer,
    };
    if wanted.model.damping.stiffness > 0.0 {
        search.with_material_damping()
    } else {
        search.slip_stick()
    }
}

/// A search for a first wave.
struct FirstWaveSearch<'a> {
    wanted: &'a WaveRequest,
    steps: Steps,
    observer: Observer<'a>,
}

impl FirstWaveSearch<'_> {
    /// The slip-stick wave, or the wave that continues it.
    fn slip_stick(&mut self) -> Result<(Wave, Vector), NoFirstWave> {
        let wanted = *self.wanted;
        let model = wanted.model;
        let coulomb = Model {
            law: FrictionLaw::Coulomb,
            ..model
        };
        let closed = start::slip_stick(&coulomb, wanted.mode, wanted.which)?;
        let least = start::least_mismatch(&coulomb, &closed);
        if model.mismatch > least {
            let (wave, point) = slip_stick_wave(&wanted, &closed)?;
            let examination = examine(&wave, &point)?;
            match examination.verdict {
                SignVerdict::Positive => return Ok((wave, point)),
                _ if model.law == FrictionLaw::Coulomb => {
                    return Err(NoFirstWave::Newton(
                        InadmissibleWave::of(&wave, &examination).into(),
                    ));
                }
                _ => {}
            }
        }
        if let FrictionLaw::Regularised { epsilon } = model.law
            && let Some(found) = self.beside_coulomb(epsilon)
        {
            return Ok(found);
        }
        // from where the wave is slip-stick, through its changes of regime, down to the δ asked for
        let mut above = 1.05 * least.max(model.mismatch);
        let start = loop {
            let from = wanted.posed_in(Parameter::Mismatch, above - model.mismatch);
            let model = from.model.with(Parameter::Mismatch, above);
            let (wave, point) = slip_stick_wave(&WaveRequest { model, ..from }, &closed)?;
            let admissible = examine(&wave, &point)?.verdict == SignVerdict::Positive;
            if admissible || model.law == FrictionLaw::Coulomb || above > MOST_ABOVE * least {
                break (wave, point);
            }
            above *= 2.0;
        };
        let scales = wanted.scales(closed.excess, closed.least_rate);
        self.lowered(start, above, least, scales)
    }

    /// The wave of the regularised law next to that of Coulomb's, which is searched for with the exact
    /// flow: a step takes a hundredth of the time. `None` where the one is not found or the other is not
    /// near.
    fn beside_coulomb(&mut self, epsilon: f64) -> Option<(Wave, Vector)> {
        let parameter = self.wanted.parameter;
        let wanted = WaveRequest {
            model: Model {
                law: FrictionLaw::Coulomb,
                ..self.wanted.model
            },
            // ε is no parameter of Coulomb's law
            parameter: match parameter {
                Parameter::Smoothing => Parameter::Mismatch,
                other => other,
            },
            ..*self.wanted
        };
        let mut search = FirstWaveSearch {
            wanted: &wanted,
            steps: self.steps,
            observer: self.observer,
        };
        let (sharp, at) = search.slip_stick().ok()?;
        let (wave, point) = smooth_wave(&sharp, &at, parameter, epsilon).ok()?;
        let examination = examine(&wave, &point).ok()?;
        (examination.verdict == SignVerdict::Positive).then_some((wave, point))
    }

    /// Follows a wave posed in the mismatch from `above` down to that of the model, and poses it in
    /// the parameter wanted there.
    fn lowered(
        &mut self,
        start: (Wave, Vector),
        above: f64,
        least: f64,
        scales: WaveScales,
    ) -> Result<(Wave, Vector), NoFirstWave> {
        let mismatch = self.wanted.model.mismatch;
        let range = (mismatch, above * (1.0 + 1e-9));
        let reached = self.followed(start, range, mismatch, true);
        let (wave, point) = reached.map_err(|reason| NoFirstWave::Unreached {
            mismatch,
            least,
            reason,
        })?;
        posed(
            &wave,
            &point,
            &self.wanted.model,
            self.wanted.parameter,
            scales,
        )
    }

    /// Follows a branch from one edge of a range of its parameter to the other, `target`, round folds or
    /// not.
    fn followed(
        &mut self,
        (wave, point): (Wave, Vector),
        range: (f64, f64),
        target: f64,
        round_folds: bool,
    ) -> Result<(Wave, Vector), SearchFailure> {
        let limits = Limits {
            range,
            stop_at: Vec::new(),
            steps: search_steps(self.steps, wave.model.law),
        };
        let mut follower = Follower::new(wave, &point, target == range.1, limits)?;
        let here = |follower: &Follower| follower.here().parameter;
        let column = follower.curve().orbit.parameter.column();
        let begun = here(&follower);
        let (mut nearest, mut folds) = (begun, 0);
        for step in 0..MOST_STEPS {
            (self.observer)(&Walk {
                column,
                from: begun,
                to: target,
                at: here(&follower),
                step,
            });
            let (found, end) = follower.step();
            for point in &found {
                let value = point.parameter;
                if (value - target).abs() < (nearest - target).abs() {
                    nearest = value;
                }
                if !matches!(point.special, Some(Special::Fold(_))) {
                    continue;
                }
                folds += 1;
                if !round_folds {
                    return Err(SearchFailure::Folds { column, value });
                }
            }
            let Some(end) = end else {
                if folds >= MOST_FOLDS {
                    return Err(SearchFailure::Winds {
                        folds,
                        steps: step + 1,
                        column,
                        nearest,
                    });
                }
                continue;
            };
            let (walk::End::Edge | walk::End::Closed, Some(last)) = (&end, found.last()) else {
                return Err(SearchFailure::Ended(Box::new(end)));
            };
            let value = last.orbit.parameter_at(&last.node.point);
            if (value - target).abs() > 1e-9 * target.abs() {
                return Err(SearchFailure::TurnsBack { column, value });
            }
            return Ok((last.orbit.as_ref().clone(), last.node.point.clone()));
        }
        Err(SearchFailure::Slow { column, nearest })
    }

    /// The wave of a model with material damping. Slip-stick waves are followed from β = 0, where they
    /// are known in closed form, at a mismatch at which they stay in contact; the fast wave, where the
    /// undamped one does not exist, from the Hopf point of steady sliding in f.
    fn with_material_damping(&mut self) -> Result<(Wave, Vector), NoFirstWave> {
        let WaveRequest {
            ref model,
            parameter,
            which,
            ..
        } = *self.wanted;
        let found = self.begin_undamped().or_else(|reason| match which {
            Which::Fast => self
                .begin_at_hopf()
                .map_err(|other| SearchFailure::Both(Box::new(reason), Box::new(other))),
            Which::Slow => Err(reason),
        });
        let beta = model.damping.stiffness;
        let (wave, point) = found.map_err(|reason| NoFirstWave::Damped { beta, reason })?;
        let examination = examine(&wave, &point)?;
        // in units that do not depend on where the search came from
        let above = wave.model_at(&point).mismatch;
        let largest = (above * wave.model.constants().coefficients.g - examination.least_pressure)
            / wave.scales.pressure;
        let scales = self.wanted.scales(wave.excess_at(&point), largest);
        // slip-stick waves do not depend on δ: that of the model may be one too
        let direct = posed(&wave, &point, model, parameter, scales)?;
        if examine(&direct.0, &direct.1)?.verdict == SignVerdict::Positive {
            return Ok(direct);
        }
        // if not, it is followed down from where it is one, within a factor of two
        let at = |mismatch: f64| {
            let unit = WaveScales {
                parameter: mismatch - model.mismatch,
                ..scales
            };
            let here = model.with(Parameter::Mismatch, mismatch);
            posed(&wave, &point, &here, Parameter::Mismatch, unit)
        };
        let mut from = (above, at(above)?);
        while from.0 > 2.0 * model.mismatch {
            let lower = 0.5 * from.0;
            let (wave, point) = at(lower)?;
            if examine(&wave, &point)?.verdict != SignVerdict::Positive {
                break;
            }
            from = (lower, (wave, point));
        }
        let (above, start) = from;
        self.lowered(start, above, model.mismatch, scales)
    }

    /// The slip-stick wave at β > 0 from that at β = 0, posed in β.
    fn begin_undamped(&mut self) -> Result<(Wave, Vector), SearchFailure> {
        let wanted = *self.wanted;
        let beta = wanted.model.damping.stiffness;
        let undamped = wanted.model.with(Parameter::StiffnessDamping, 0.0);
        let closed =
            start::slip_stick(&undamped, wanted.mode, wanted.which).map_err(NoFirstWave::from)?;
        let least = start::least_mismatch(&undamped, &closed);
        let above = wanted.model.mismatch.max(ABOVE_UNDAMPED * least);
        let from = WaveRequest {
            model: undamped.with(Parameter::Mismatch, above),
            ..wanted.posed_in(Parameter::StiffnessDamping, beta)
        };
        let start = slip_stick_wave(&from, &closed)?;
        self.followed(start, (0.0, beta), beta, false)
    }

    /// The slip-stick wave at this friction from the Hopf point of steady sliding, posed in f.
    fn begin_at_hopf(&mut self) -> Result<(Wave, Vector), SearchFailure> {
        let WaveRequest { model, mode, .. } = *self.wanted;
        let in_friction =
            |model: &Model| family(model, Parameter::Friction, mode, model.friction, 2);
        let found = in_friction(&model).or_else(|error| match error {
            NoHopf::Separation { least, .. } => {
                in_friction(&model.with(Parameter::Mismatch, ABOVE_UNDAMPED * least))
            }
            error => Err(error),
        })?;
        let (wave, point) = beyond_hopf(&found, self.steps)?;
        let at = wave.parameter_at(&point);
        let range = (at.min(model.friction), at.max(model.friction));
        self.followed((wave, point), range, model.friction, true)
    }
}

/// A solved wave posed in another parameter and in other units.
fn posed(
    wave: &Wave,
    point: &Vector,
    model: &Model,
    parameter: Parameter,
    scales: WaveScales,
) -> Result<(Wave, Vector), NoFirstWave> {
    let signature = wave.signature.clone();
    let moved = Wave::new(*model, parameter, wave.mode, signature, scales);
    let value = model.value(parameter).unwrap_or(f64::NAN);
    let guess = moved.pack(&wave.unpack(point), wave.excess_at(point), value);
    let point = polish(&moved, &guess)?;
    Ok((moved, point))
}

/// Where a search for a first wave is: it follows a branch in a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    /// Column of the parameter.
    pub column: &'static str,
    /// Value it set out from.
    pub from: f64,
    /// Value to be reached.
    pub to: f64,
    /// Value reached.
    pub at: f64,
    /// Steps taken.
    pub step: usize,
}

impl Walk {
    /// Share of the way behind it.
    pub fn part(&self) -> f64 {
        (self.at - self.from) / (self.to - self.from)
    }
}

impl fmt::Display for Walk {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let Walk { column, step, .. } = self;
        write!(
            out,
            "walking from {column} = {:.3e} to {:.3e} for a first wave: step {step} of at most \
             {MOST_STEPS}, at {:.3e}",
            self.from, self.to, self.at
        )
    }
}

/// Who is told where a search is.
pub type Observer<'a> = &'a mut dyn FnMut(&Walk);

/// Most folds of a search for a first wave: branches that arrive have few. Others wind up, a bounce of
/// the separated surface more with every turn, and tend to a value they never pass.
const MOST_FOLDS: usize = 40;

/// How much longer the steps of a search are where a point takes a hundred times as long.
const INTEGRATED: f64 = 5.0;

/// The step lengths of a search: those of the problem, but none finer than the defaults; only its end
/// is wanted.
fn search_steps(steps: Steps, law: FrictionLaw) -> Steps {
    let longer = match law {
        FrictionLaw::Regularised { .. } => INTEGRATED,
        _ => 1.0,
    };
    Steps {
        ds: steps.ds.max(longer * DEFAULT_DS),
        ds_min: steps.ds_min.min(DEFAULT_DS_MIN),
        ds_max: steps.ds_max.max(longer * DEFAULT_DS_MAX),
        ..steps
    }
}

/// Mismatches at which slip-stick waves with material damping are looked for, in units of the least
/// one of the undamped wave: they stay in contact on any way between.
const ABOVE_UNDAMPED: f64 = 1e4;

/// Arclength of the first step from a Hopf point into the slip-stick branch: its stick zone is there
/// like the square root of the distance in the parameter.
const BEYOND_HOPF: f64 = 1e-4;

/// The slip-stick wave just beyond the vertical family at a Hopf point.
///
/// # Errors
/// No admissible wave with a short stick zone exists.
pub(crate) fn beyond_hopf(family: &Family, steps: Steps) -> Result<(Wave, Vector), SearchFailure> {
    let beyond = entry::enter(&family.opening(), BEYOND_HOPF, steps.tolerance)?;
    let step = arclength::advance(&beyond.orbit, &beyond.node, &[], beyond.ds, steps.tolerance)?;
    Ok((beyond.orbit, step.node.point))
}

/// The mismatch is raised at most by this factor above that of the Coulomb wave in search of a
/// slip-stick wave under another friction law.
const MOST_ABOVE: f64 = 1e3;
