//! The first orbit of a branch: by a motion that settles on it, or from a guess.

mod approach;
mod failure;
mod guess;
mod rest;
mod returns;
mod switches;
mod unknowns;

pub use failure::NoStart;
pub(super) use switches::run;
pub(super) use unknowns::scaled;

use serde::{Deserialize, Serialize};

use super::behaviour::Behaviour;
use super::layout::AffineOrbit;
use super::row::SavedOrbit;
use crate::affine::closure::Prescribed;
use crate::affine::motion::{Halt, Moment};
use crate::affine::system::System;
use crate::linalg::Vector;
use approach::Approach;
use guess::{FROM_A_GUESS, OrbitGuess};
use rest::lost_in_a_point;
use unknowns::{lasts_by_rounding, pose};

/// Where a motion begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beginning {
    /// Number of the mode.
    pub mode: usize,
    /// States.
    pub state: Vec<f64>,
    /// Phase of the forcing.
    pub phase: f64,
}

impl From<&Beginning> for Moment {
    fn from(beginning: &Beginning) -> Moment {
        Moment {
            time: 0.0,
            phase: beginning.phase,
            mode: beginning.mode,
            state: beginning.state.clone(),
        }
    }
}

impl From<Moment> for Beginning {
    fn from(place: Moment) -> Beginning {
        Beginning {
            mode: place.mode,
            state: place.state,
            phase: place.phase,
        }
    }
}

/// How the first orbit is found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Search {
    /// What a motion settles on after so many forcing periods, or so long a time without forcing.
    Settles(f64),
    /// What Newton's method finds from the motion over one period, this one without forcing.
    Guess(f64),
}

/// The first orbit that is asked for.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// The system.
    pub system: System,
    /// Values of its parameters.
    pub values: Vec<f64>,
    /// Index of the continuation parameter.
    pub parameter: usize,
    /// Width of its range.
    pub width: f64,
    /// Forcing periods of the orbit, or switches back to the first one without forcing: where it settles at most,
    /// the least number is found.
    pub periods: u32,
    /// Whether changes of stability are looked for.
    pub stability: bool,
    /// The period, where it is prescribed.
    pub prescribed: Option<Prescribed>,
}

impl Wanted {
    /// An orbit of one period of a system at its own values, to be followed in a parameter through a range with its
    /// stability; `None` where the system has no such parameter.
    pub fn new(system: System, parameter: &str, (low, high): (f64, f64)) -> Option<Wanted> {
        Some(Wanted {
            values: system.values(),
            parameter: system.source.parameters.index(parameter)?,
            width: high - low,
            periods: 1,
            stability: true,
            prescribed: None,
            system,
        })
    }
}

/// The first orbit and its point.
///
/// # Errors
/// Why there is none.
pub fn first(
    wanted: &Wanted,
    beginning: &Beginning,
    search: Search,
) -> Result<(AffineOrbit, Vector), NoStart> {
    settled(wanted, beginning, search).map_err(|reason| {
        let NoStart::Halted(halt) = reason else {
            return reason;
        };
        if let Some(place) = resting(wanted, beginning, search, &halt) {
            let time = place.time;
            return NoStart::Rests { time, place };
        }
        match halt.place() {
            Some((mode, guard)) => NoStart::Stuck {
                mode: wanted.system.mode_name(mode).into_owned(),
                guard: wanted.system.guard_name(mode, guard),
                halt,
            },
            None => NoStart::Halted(halt),
        }
    })
}

/// Where a motion without forcing spirals in that halts for lack of numbers.
fn resting(wanted: &Wanted, beginning: &Beginning, search: Search, halt: &Halt) -> Option<Moment> {
    let Search::Settles(settle) = search else {
        return None;
    };
    if matches!(halt, Halt::Chattering { .. } | Halt::Unbounded { .. }) {
        return None;
    }
    let system = wanted.system.at(&wanted.values, &[]).ok()?;
    let begin = Moment::from(beginning);
    (system.omega.value == 0.0)
        .then(|| lost_in_a_point(&system, begin, settle))
        .flatten()
}

/// The same, with numbers of modes and guards in its failures. Where what dies out on the way still has a zone that no orbit has, the
/// motion settles on.
fn settled(
    wanted: &Wanted,
    beginning: &Beginning,
    search: Search,
) -> Result<(AffineOrbit, Vector), NoStart> {
    /// How many times as long it is given.
    const LONGER: [f64; 2] = [2.0, 4.0];
    let reason = match found(wanted, beginning, search) {
        Ok(found) => return Ok(found),
        Err(reason) => reason,
    };
    let Search::Settles(time) = search else {
        return Err(reason);
    };
    let dies_out = matches!(
        reason,
        NoStart::Inadmissible(_) | NoStart::AtOnce { .. } | NoStart::Shrinks { .. }
    );
    let mut further = LONGER.iter().filter(|_| dies_out && time > 0.0);
    let later = further.find_map(|longer| {
        let search = Search::Settles(longer * time);
        found(wanted, beginning, search).ok()
    });
    later.ok_or(reason)
}

/// What a motion comes to in this time, or a guess leads to.
fn found(
    wanted: &Wanted,
    beginning: &Beginning,
    search: Search,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let system = wanted.system.at(&wanted.values, &[wanted.parameter]);
    let system = system.map_err(NoStart::System)?;
    let mut approach = Approach::settled(wanted, &system, beginning, search)?;
    let begin = approach.motion.place().clone();
    let guess = match (search, approach.forcing) {
        (Search::Guess(time), _) if approach.is_on_guard() => approach.begun_at_switch(time)?,
        (_, Some(period)) => approach.over_periods(period, search)?,
        (Search::Guess(time), None) => match approach.over_time(time)? {
            Some(guess) => guess,
            None => return approach.unswitched(begin, time),
        },
        (Search::Settles(_), None) => approach.over_returns()?,
    };
    approach.admit(&guess)?;
    let attracting = guess.attracting(wanted);
    let attracting = attracting.and_then(|found| match lasts_by_rounding(&found.0, &found.1) {
        Some(mode) => Err(NoStart::Shrinks { mode }),
        None => Ok(found),
    });
    attracting.or_else(|reason| {
        // a switch on the way to an orbit within one mode
        let whole = approach
            .forcing
            .filter(|_| matches!(reason, NoStart::Shrinks { .. }));
        let whole = whole.map(|period| OrbitGuess {
            periods: guess.periods,
            ..OrbitGuess::unswitched(begin, f64::from(guess.periods) * period)
        });
        match whole.map(|guess| guess.orbit(wanted, &FROM_A_GUESS)) {
            Some(Ok(found)) => Ok(found),
            _ => Err(told_apart(wanted, &guess, reason)),
        }
    })
}

/// Why there is no orbit, where that may be since two switches of the motion are told apart by rounding alone.
fn told_apart(wanted: &Wanted, guess: &OrbitGuess, reason: NoStart) -> NoStart {
    let at_once = guess.at_once();
    match at_once.filter(|_| matches!(reason, NoStart::Inadmissible(_))) {
        Some(switches) => {
            let name = |(mode, guard)| wanted.system.guard_name(mode, guard);
            let [first, second] = switches.map(name);
            NoStart::AtOnce { first, second }
        }
        None => reason,
    }
}

/// The orbit that was saved, at the values wanted.
///
/// # Errors
/// Why it is not found again.
pub fn restart(wanted: &Wanted, saved: &SavedOrbit) -> Result<(AffineOrbit, Vector), NoStart> {
    pose(
        wanted,
        saved.parts().ok_or(NoStart::NoZones)?,
        saved.periods,
        &FROM_A_GUESS,
    )
}

/// The orbit that was saved as it is: at an event its equations may be singular.
///
/// # Errors
/// The system does not have its zones.
pub fn saved(
    system: &System,
    saved: &SavedOrbit,
    parameter: usize,
    width: f64,
    prescribed: Option<Prescribed>,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let wanted = Wanted {
        prescribed,
        system: system.clone(),
        values: saved.values.clone(),
        parameter,
        width,
        periods: saved.periods,
        stability: false,
    };
    let parts = saved.parts().ok_or(NoStart::NoZones)?;
    scaled(&wanted, parts, saved.periods)
}

/// A reason with what the motion looks like, where it is not periodic within the periods asked for or does not switch;
/// other reasons stay.
pub fn explained(
    wanted: &Wanted,
    beginning: &Beginning,
    search: Search,
    reason: NoStart,
) -> NoStart {
    let NoStart::NotPeriodic {
        periods,
        off,
        looks: None,
    } = reason
    else {
        return reason;
    };
    let (Search::Settles(_), Ok(system)) = (search, wanted.system.at(&wanted.values, &[])) else {
        return reason;
    };
    let Ok(mut approach) = Approach::settled(wanted, &system, beginning, search) else {
        return reason;
    };
    match approach.behaviour() {
        Some(Behaviour::Drifts(state, by)) => NoStart::Drifts {
            state: wanted.system.source.states[state].clone(),
            by,
        },
        looks => NoStart::NotPeriodic {
            periods,
            off,
            looks,
        },
    }
}
