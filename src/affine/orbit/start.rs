//! The first orbit of a branch: by a motion that settles on it, or from a guess.

use std::f64::consts::TAU;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Inadmissible;
use super::behaviour::{Behaviour, RETURNED, behaviour, cycle};
use super::layout::{AffineOrbit, ZonePoint};
use super::multipliers::Multiplier;
use super::row::SavedOrbit;
use super::section::of_orbit;
use super::setting::{OrbitFailure, Scales, Setting};
use super::signature::{Sequence, Way, Zone};
use super::stop::quoted;
use crate::affine::closure::Prescribed;
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Halt, Motion, Place, Step, Switching};
use crate::affine::system::{System, SystemError};
use crate::continuation::newton::{self, Fixed, Settings};
use crate::linalg::Vector;
use crate::orbit::special::NoFollower;
use crate::orbit::switch::{NoBranch, admitted, is_in_family};

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

impl From<Place> for Beginning {
    fn from(place: Place) -> Beginning {
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

/// Why there is no first orbit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStart {
    /// The system makes no sense at these values.
    #[error("{0}")]
    System(SystemError),
    /// The motion does not go on.
    #[error("{0}")]
    Halted(Halt),
    /// The same, about a guard.
    #[error("{}", .halt.named(&format!("the mode `{mode}`"), guard))]
    Stuck {
        /// Why.
        halt: Halt,
        /// Name of the mode.
        mode: String,
        /// The guard, as the file has it.
        guard: String,
    },
    /// The motion comes to rest.
    #[error("the motion comes to rest after its last switch, at t = {time}")]
    Rests {
        /// Time of the last switch, or of the beginning.
        time: f64,
        /// Where it rests.
        place: Place,
    },
    /// Some states stand still for ever, where the motion happened to leave them, while the rest moves with the forcing.
    #[error(
        "the motion comes to rest in part: after its last switch, at t = {time}, it stays in `{mode}` for ever, where {} \
         stand{} still while the rest moves with the forcing. Where depends on where the motion begins, so that the orbit is \
         one of a family, without a branch of its own",
        quoted(.states), if .states.len() == 1 { "s" } else { "" }
    )]
    Stands {
        /// Time of the last switch, or of the beginning.
        time: f64,
        /// Name of the mode.
        mode: String,
        /// Names of the states.
        states: Vec<String>,
    },
    /// The motion switches no more and does not come to rest.
    #[error(
        "the motion does not switch any more after t = {time}, and is not seen to rest or to return: it leaves, settles \
         slowly, or wanders"
    )]
    Leaves {
        /// Time of the last switch.
        time: f64,
    },
    /// The motion does not return within the periods asked for.
    #[error(
        "after {periods} periods the motion does not return: it is off by {off:.1e} of its size{}", in_words(*.looks)
    )]
    NotPeriodic {
        /// How many were tried.
        periods: u32,
        /// Least distance found, relative to the size of the states.
        off: f64,
        /// What it looks like, where it was asked.
        looks: Option<Behaviour>,
    },
    /// More switches than an orbit is followed through.
    #[error("{0} switches in one period are more than are followed")]
    Switches(usize),
    /// Newton's method finds no orbit.
    #[error("no orbit is found: {0}")]
    Newton(newton::Failure<OrbitFailure>),
    /// What Newton's method finds is no orbit.
    #[error("the solution found is an equilibrium and no orbit")]
    Equilibrium,
    /// The orbit is not isolated.
    #[error("{0}")]
    Family(NoFollower<AffineOrbit>),
    /// The orbit is not admissible.
    #[error("the solution found is not an admissible orbit: {0}")]
    Inadmissible(Inadmissible),
    /// The motion has infinitely many switches in a period: no orbit is followed through them.
    #[error(
        "infinitely many switches of `{from}` end in `{to}` at t = {time}, and so in every period: `simulate` and `scan` go on \
         through them, but no orbit is followed through infinitely many zones"
    )]
    Accumulates {
        /// Where they end.
        time: f64,
        /// Name of the mode before.
        from: String,
        /// Name of that which goes on.
        to: String,
    },
    /// The system does not have these zones.
    #[error("the motion has zones that no orbit has")]
    NoZones,
    /// The equations of an orbit are regular at a fixed parameter: no other branch passes there.
    #[error("no other branch passes through the orbit: its equations are singular to {0:.1e} only")]
    Regular(f64),
}

/// What a motion that does not return looks like, in words.
fn in_words(looks: Option<Behaviour>) -> String {
    match looks {
        None | Some(Behaviour::Unclear) => String::new(),
        Some(Behaviour::Periodic(count)) => {
            format!("; later it is seen to be periodic: it is back after {count} of them")
        }
        Some(Behaviour::Settles) => {
            "; it settles slowly: motions next to it come nearer".to_owned()
        }
        Some(Behaviour::QuasiPeriodic) => {
            "; it looks quasi-periodic: motions next to it neither come nearer nor part".to_owned()
        }
        Some(Behaviour::Chaotic(exponent)) => {
            format!("; it looks chaotic: motions next to it part like exp({exponent:.2e} t)")
        }
    }
}

/// One that settles slowly has returned, too, where it is off by no more than this: Newton's method does the rest.
const NEARLY: f64 = 1e-3;

/// A state smaller than this part of its size over the whole motion has decayed to zero: Newton's method does the rest.
const DECAYED: f64 = 1e-9;

/// Newton's method from a guess, or from a motion that has returned to rounding.
const FROM_A_GUESS: Settings = Settings {
    tolerance: 1e-10,
    most_iterations: 40,
    halvings: 12,
    polish: 1,
};

/// The same from a motion that has nearly returned: within [`NEARLY`] of an orbit it is quadratic at once, or there is none.
const FROM_NEARBY: Settings = Settings {
    most_iterations: 12,
    halvings: 2,
    ..FROM_A_GUESS
};

/// Most switches of one orbit.
const MOST_SWITCHES: usize = 200;

/// Switches of a motion, each with the place where the next zone begins.
type Switches = Vec<(Switching, Place)>;

/// Zones of a motion that returns: where they begin, how they end, how long they last. None where it never switches.
struct Course {
    zones: Vec<(Place, Switching, f64)>,
    /// Where a motion that never switches begins, at phase 0 with a forcing, and how long it takes until it is back.
    whole: Option<(Place, f64)>,
    periods: u32,
    /// Where it has returned nearly only: after how many tries, and by how much it is off then.
    nearly: Option<(u32, f64)>,
}

impl Course {
    /// That of a motion that never switches without forcing.
    fn unswitched(place: Place, period: f64) -> Course {
        Course {
            zones: Vec::new(),
            whole: Some((place, period)),
            periods: 1,
            nearly: None,
        }
    }

    /// The orbit next to it.
    fn posed(
        &self,
        wanted: &Wanted,
        settings: &Settings,
    ) -> Result<(AffineOrbit, Vector), NoStart> {
        let zones = self.zones.iter().map(|(place, switching, duration)| {
            let way = Way {
                guard: switching.guard,
                exit: switching.exit,
            };
            zone(wanted, place, Some(way), *duration)
        });
        let whole = self.whole.iter();
        let whole = whole.map(|(place, duration)| zone(wanted, place, None, *duration));
        pose(wanted, zones.chain(whole).collect(), self.periods, settings)
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
    found(wanted, beginning, search).map_err(|reason| {
        let NoStart::Halted(halt) = reason else {
            return reason;
        };
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

/// The same, with numbers of modes and guards in its failures.
fn found(
    wanted: &Wanted,
    beginning: &Beginning,
    search: Search,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let system = wanted.system.at(&wanted.values, &[wanted.parameter]);
    let system = system.map_err(NoStart::System)?;
    let place = Place {
        time: 0.0,
        phase: beginning.phase,
        mode: beginning.mode,
        state: beginning.state.clone(),
    };
    let omega = system.omega.value;
    let is_forced = omega > 0.0;
    let period = if is_forced { TAU / omega } else { 1.0 };
    let (settle, guess) = match search {
        Search::Settles(periods) => (periods * period, None),
        Search::Guess(time) => (0.0, Some(time)),
    };
    let longest = match guess {
        _ if is_forced => period,
        Some(time) => time,
        None => settle.max(1.0),
    };
    let mut motion = Motion::new(&system, place, longest);
    let settling = run(&mut motion, settle)?;
    let whole = sizes(&beginning.state, &settling);
    let time = guess.map(|time| {
        if is_forced {
            f64::from(wanted.periods.max(1)) * period
        } else {
            time
        }
    });
    let course = match time {
        Some(time) if is_on_guard(&system, motion.place()) => Course {
            zones: from_switch(&mut motion, time)?,
            whole: None,
            periods: wanted.periods.max(1),
            nearly: None,
        },
        _ if is_forced => {
            let recurrence = Recurrence::Phase(period);
            let none = Returns::none(&system, &recurrence, &whole, &motion);
            let most = wanted.periods.max(1) as usize;
            match guess {
                None => returning(&none, &mut motion, most)?,
                Some(_) => none.followed(&mut motion, most)?,
            }
        }
        Some(time) => {
            /// How much later than the time the last switch may come.
            const LATE: f64 = 1.01;
            /// Periods after which a motion is on its cycle.
            const SETTLED: f64 = 40.0;
            let place = motion.place().clone();
            let begin = place.time;
            let mut switches = run(&mut motion, begin + LATE * time)?;
            if switches.is_empty() {
                let guess = Course::unswitched(place, time);
                let posed = guess.posed(wanted, &FROM_A_GUESS);
                // a guess may lie beside the cycle that motions settle on
                let settled = || cycle(&system, motion.place(), SETTLED * time);
                return posed.or_else(|reason| match settled() {
                    Some((place, period)) => {
                        Course::unswitched(place, period).posed(wanted, &FROM_A_GUESS)
                    }
                    None => Err(reason),
                });
            }
            // the first comes again as much later than the period as it came after the beginning: what comes in the
            // first half of that is the last of the orbit, as where it begins just after a switch
            let first = switches.first().map_or(begin, |(first, _)| first.time);
            let end = begin + time + 0.5 * (first - begin);
            switches.retain(|(switching, _)| switching.time <= end);
            Course {
                zones: closed(switches, time),
                whole: None,
                periods: 1,
                nearly: None,
            }
        }
        None => {
            let longest = longest.max(ENDLESS);
            let settled = motion.place().clone();
            let first = next_switch(&mut motion, longest);
            let settles = first.and_then(|(first, _)| {
                let recurrence = Recurrence::Switch(first, longest);
                let none = Returns::none(&system, &recurrence, &whole, &motion);
                returning(&none, &mut motion, wanted.periods.max(1) as usize)
            });
            settles.or_else(|reason| match reason {
                NoStart::Leaves { time } if rests(&system, motion.place(), &beginning.state) => {
                    let place = motion.place().clone();
                    Err(NoStart::Rests { time, place })
                }
                // of what decays for ever numbers are lost in the end
                NoStart::Halted(_) if rests(&system, &settled, &beginning.state) => {
                    let (time, place) = (settled.time, settled);
                    Err(NoStart::Rests { time, place })
                }
                NoStart::Leaves { .. } => {
                    let cycle = cycle(&system, motion.place(), settle.max(1.0));
                    let (place, period) = cycle.ok_or(reason)?;
                    Ok(Course::unswitched(place, period))
                }
                reason => Err(reason),
            })?
        }
    };
    if let Some((place, _)) = &course.whole {
        let time = settling.last().map_or(0.0, |(last, _)| last.time);
        moves(wanted, &system, (place, time), &whole)?;
    }
    // a switch that leads to where infinitely many others end
    let leads = |(_, switching, _): &&(Place, Switching, f64)| {
        let exits = &system.modes[switching.from].guards[switching.guard].exits;
        exits.get(switching.exit).map(|exit| exit.to) == Some(switching.to)
    };
    if let Some((_, switching, _)) = course.zones.iter().find(|zone| !leads(zone)) {
        let name = |mode: usize| wanted.system.mode_name(mode).into_owned();
        return Err(NoStart::Accumulates {
            time: switching.time,
            from: name(switching.from),
            to: name(switching.to),
        });
    }
    let Some((tried, off)) = course.nearly else {
        return course.posed(wanted, &FROM_A_GUESS);
    };
    let by_chance = NoStart::NotPeriodic {
        periods: tried,
        off,
        looks: None,
    };
    // an orbit that it settles on is next to a motion that has nearly returned, and does not repel it: otherwise it came close by
    // chance
    let posed = course.posed(wanted, &FROM_NEARBY);
    let (orbit, point) = posed.map_err(|reason| match reason {
        NoStart::Newton(_) | NoStart::Inadmissible(_) => by_chance.clone(),
        reason => reason,
    })?;
    let multipliers = orbit.multipliers(&point).unwrap_or_default();
    match multipliers.iter().any(Multiplier::is_outside) {
        true => Err(by_chance),
        false => Ok((orbit, point)),
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

/// Whether a place is one where a zone begins at a switch: a guard of its own mode is zero.
fn is_on_guard(system: &AffineSystem, place: &Place) -> bool {
    let z = system.lift(place.mode, &place.state, place.phase);
    let mut guards = system.modes[place.mode].guards.iter();
    guards.any(|guard| {
        let terms = guard.row.at.iter().zip(&z).map(|(c, z)| c * z);
        let size: f64 = terms.clone().map(f64::abs).sum();
        // a guard of states that are all zero is zero
        terms.sum::<f64>().abs() <= RETURNED * size
    })
}

/// The zones of a motion from a switch to the one that comes nearest to this time.
fn from_switch(motion: &mut Motion, time: f64) -> Result<Vec<(Place, Switching, f64)>, NoStart> {
    /// How much later than the time the switch may come.
    const LATE: f64 = 1.25;
    let begin = motion.place().clone();
    let switches = run(motion, begin.time + LATE * time)?;
    if switches.len() > MOST_SWITCHES {
        return Err(NoStart::Switches(switches.len()));
    }
    let off = |index: &usize| (switches[*index].0.time - begin.time - time).abs();
    let last = (0..switches.len()).min_by(|one, other| off(one).total_cmp(&off(other)));
    let last = last.ok_or(NoStart::Leaves { time: begin.time })?;
    let mut place = begin;
    let zones = switches
        .into_iter()
        .take(last + 1)
        .map(|(switching, next)| {
            let from = std::mem::replace(&mut place, next);
            let duration = switching.time - from.time;
            (from, switching, duration)
        });
    Ok(zones.collect())
}

fn zone(wanted: &Wanted, place: &Place, way: Option<Way>, duration: f64) -> (Zone, ZonePoint) {
    let name = wanted.system.mode_name(place.mode).into_owned();
    let zone = Zone::new(place.mode, way, name);
    let point = ZonePoint {
        state: place.state.clone(),
        duration,
        phase: place.phase,
    };
    (zone, point)
}

/// Moves on to a time: the switches on the way.
fn run(motion: &mut Motion, until: f64) -> Result<Switches, NoStart> {
    let mut switches = Vec::new();
    loop {
        match motion.step(until).map_err(NoStart::Halted)? {
            Step::Reached | Step::Section => return Ok(switches),
            Step::Switched(switching) => switches.push((switching, motion.place().clone())),
        }
    }
}

/// How far a place is from another one that should be the same after so many returns, relative to the states on the way and
/// to what their rates, and those of the rates, make of the time of one return: a state may be zero at all of the switches,
/// begin and end a zone of sliding with no rate, or be at rest at the beginning.
///
/// A state whose size is next to nothing of the one in `whole`, that over the whole motion, has decayed to zero: it is the
/// same as before however fast it decays.
fn distance(
    system: &AffineSystem,
    begin: &Place,
    here: &Place,
    (switches, returns): (&[(Switching, Place)], usize),
    whole: &[f64],
) -> f64 {
    let ends = switches
        .iter()
        .flat_map(|(Switching { from, before, .. }, place)| {
            [
                (*from, before, place.phase),
                (place.mode, &place.state, place.phase),
            ]
        });
    let edges = [begin, here].map(|place| (place.mode, &place.state, place.phase));
    let time = (here.time - begin.time) / returns as f64;
    let mut sizes = vec![0.0_f64; begin.state.len()];
    for (mode, states, phase) in ends.chain(edges) {
        let matrix = &system.modes[mode].matrix.at * (time / TAU);
        let first = &matrix * system.lift(mode, states, phase);
        let second = &matrix * &first;
        for (state, x) in states.iter().enumerate() {
            let size = x.abs().max(first[state].abs()).max(second[state].abs());
            sizes[state] = sizes[state].max(size);
        }
    }
    let pairs = begin
        .state
        .iter()
        .zip(&here.state)
        .zip(sizes.iter().zip(whole));
    let off = |((x, y), (size, whole)): ((&f64, &f64), (&f64, &f64))| {
        let off = (x - y).abs();
        let decayed = *size <= DECAYED * whole;
        if off == 0.0 || decayed {
            0.0
        } else {
            off / size
        }
    };
    pairs.map(off).fold(0.0, f64::max)
}

/// The largest value of every state where a motion begins and at its switches.
fn sizes(begin: &[f64], switches: &Switches) -> Vec<f64> {
    let mut sizes: Vec<f64> = begin.iter().map(|x| x.abs()).collect();
    for (Switching { before, .. }, place) in switches {
        for (size, (x, y)) in sizes.iter_mut().zip(before.iter().zip(&place.state)) {
            *size = size.max(x.abs()).max(y.abs());
        }
    }
    sizes
}

/// The zones of a motion that has returned after `time` to where it was: from its first switch on.
fn closed(mut switches: Switches, time: f64) -> Vec<(Place, Switching, f64)> {
    let count = switches.len();
    switches.rotate_left(count.min(1));
    let ends = (0..count).map(|index| switches[index].0.clone());
    let zones = ends.enumerate().map(|(index, end)| {
        // entered by the switch before
        let (_, place) = &switches[(index + count - 1) % count];
        let wrapped = if index + 1 == count { time } else { 0.0 };
        (place.clone(), end.clone(), end.time - place.time + wrapped)
    });
    zones.collect()
}

/// A reason with what the motion looks like, where it is not periodic within the periods asked for or does not switch;
/// other reasons stay.
pub fn explained(
    wanted: &Wanted,
    beginning: &Beginning,
    search: Search,
    reason: NoStart,
) -> NoStart {
    let Search::Settles(settle) = search else {
        return reason;
    };
    let (NoStart::NotPeriodic { looks: None, .. }, Ok(system)) =
        (&reason, wanted.system.at(&wanted.values, &[]))
    else {
        return reason;
    };
    let place = Place {
        time: 0.0,
        phase: beginning.phase,
        mode: beginning.mode,
        state: beginning.state.clone(),
    };
    let is_forced = system.omega.value > 0.0;
    let period = if is_forced {
        TAU / system.omega.value
    } else {
        1.0
    };
    let mut motion = Motion::new(
        &system,
        place,
        if is_forced { period } else { settle.max(1.0) },
    );
    if run(&mut motion, settle * period).is_err() {
        return reason;
    }
    match reason {
        NoStart::NotPeriodic { periods, off, .. } => {
            let interval = if is_forced {
                Some(period)
            } else {
                return_time(&mut motion)
            };
            let looks = interval.and_then(|interval| behaviour(&system, motion.place(), interval));
            NoStart::NotPeriodic {
                periods,
                off,
                looks,
            }
        }
        _ => reason,
    }
}

/// Mean time between returns to the next switch of a motion.
fn return_time(motion: &mut Motion) -> Option<f64> {
    /// Switches, and time for each at most.
    const SWITCHES: usize = 64;
    let mut first = None;
    let mut returns = (0, 0.0);
    for _ in 0..SWITCHES {
        let until = motion.place().time + ENDLESS;
        let Ok(Step::Switched(one)) = motion.step(until) else {
            return None;
        };
        let by = (one.from, one.guard, one.exit);
        let (known, since) = *first.get_or_insert((by, one.time));
        if known == by && one.time > since {
            returns = (returns.0 + 1, one.time - since);
        }
    }
    (returns.0 > 0).then(|| returns.1 / f64::from(returns.0))
}

/// What counts as a return of a motion.
enum Recurrence {
    /// The end of a forcing period.
    Phase(f64),
    /// Without forcing: this switch again, none of those between later than this time after the one before.
    Switch(Switching, f64),
}

/// Moves on to the next switch without forcing.
fn next_switch(motion: &mut Motion, longest: f64) -> Result<(Switching, Place), NoStart> {
    let since = motion.place().time;
    match motion.step(since + longest).map_err(NoStart::Halted)? {
        Step::Switched(switching) => Ok((switching, motion.place().clone())),
        Step::Reached | Step::Section => Err(NoStart::Leaves { time: since }),
    }
}

impl Recurrence {
    /// Moves on to the next return, or through more switches than are followed.
    fn next_return(&self, motion: &mut Motion) -> Result<Switches, NoStart> {
        let (first, longest) = match self {
            Recurrence::Phase(period) => {
                let until = motion.place().time + period;
                return run(motion, until);
            }
            Recurrence::Switch(first, longest) => (first, *longest),
        };
        let by = |one: &Switching| (one.from, one.to, one.guard, one.exit);
        let mut switches = Switches::new();
        loop {
            let (switching, place) = next_switch(motion, longest)?;
            let returned = by(&switching) == by(first);
            switches.push((switching, place));
            if returned || switches.len() > MOST_SWITCHES {
                return Ok(switches);
            }
        }
    }
}

/// Returns of a motion in a row.
struct Returns<'a> {
    system: &'a AffineSystem,
    recurrence: &'a Recurrence,
    /// Sizes of the states over the whole motion.
    whole: &'a [f64],
    /// Where it is at first and at every return, and how many switches it has come through until then.
    places: Vec<(Place, usize)>,
    switches: Switches,
}

impl<'a> Returns<'a> {
    /// None yet.
    fn none(
        system: &'a AffineSystem,
        recurrence: &'a Recurrence,
        whole: &'a [f64],
        motion: &Motion,
    ) -> Returns<'a> {
        Returns {
            system,
            recurrence,
            whole,
            places: vec![(motion.place().clone(), 0)],
            switches: Switches::new(),
        }
    }

    /// None yet of those that follow.
    fn after(&self, motion: &Motion) -> Returns<'a> {
        Returns::none(self.system, self.recurrence, self.whole, motion)
    }

    fn count(&self) -> usize {
        self.places.len() - 1
    }

    /// Goes on to another one. False where that takes more switches in all than are followed.
    fn extend(&mut self, motion: &mut Motion) -> Result<bool, NoStart> {
        self.switches.extend(self.recurrence.next_return(motion)?);
        let follows = self.switches.len() <= MOST_SWITCHES;
        if follows {
            let place = motion.place().clone();
            self.places.push((place, self.switches.len()));
        }
        Ok(follows)
    }

    /// Switches between two of them.
    fn between(&self, from: usize, to: usize) -> &[(Switching, Place)] {
        &self.switches[self.places[from].1..self.places[to].1]
    }

    /// How far the motion is off at one from where it is at an earlier one.
    fn off(&self, from: usize, to: usize) -> f64 {
        let [begin, here] = [from, to].map(|index| &self.places[index].0);
        if begin.mode != here.mode {
            return f64::INFINITY;
        }
        let way = (self.between(from, to), to - from);
        distance(self.system, begin, here, way, self.whole)
    }

    /// The course over so many more.
    fn followed(mut self, motion: &mut Motion, most: usize) -> Result<Course, NoStart> {
        while self.count() < most {
            if !self.extend(motion)? {
                return Err(NoStart::Switches(self.switches.len()));
            }
        }
        self.course(motion, [0, most])
    }

    /// The course from one of them to another; the motion goes on to phase 0 where it does not switch.
    fn course(&self, motion: &mut Motion, [from, to]: [usize; 2]) -> Result<Course, NoStart> {
        let switches = self.between(from, to).to_vec();
        let returns = (to - from) as u32;
        let (time, periods) = match self.recurrence {
            Recurrence::Phase(period) => (f64::from(returns) * period, returns),
            Recurrence::Switch(..) => (self.places[to].0.time - self.places[from].0.time, 1),
        };
        let mut whole = None;
        if switches.is_empty() {
            let here = motion.place().clone();
            let turn = (TAU - here.phase.rem_euclid(TAU)) / TAU;
            run(motion, here.time + turn * time / f64::from(returns))?;
            let place = Place {
                phase: 0.0,
                ..motion.place().clone()
            };
            whole = Some((place, time));
        }
        Ok(Course {
            zones: closed(switches, time),
            whole,
            periods,
            nearly: None,
        })
    }
}

/// The course over the least number of returns after which a motion is where it was.
///
/// One that settles slowly comes away from where it was first while its returns come ever nearer to one another. It is
/// followed as long as the distance over as many returns as came nearest falls; of a chaotic motion some returns are near by
/// chance, and later ones after as many are not.
fn returning(none: &Returns, motion: &mut Motion, most: usize) -> Result<Course, NoStart> {
    /// From the first of the returns to the last the distance falls to this part.
    const FALLS: f64 = 0.5;
    let mut before = f64::INFINITY;
    loop {
        let mut all = none.after(motion);
        let mut tried = Vec::new();
        while tried.len() < most && tried.last().is_none_or(|off| *off > RETURNED) {
            if !all.extend(motion)? {
                if tried.is_empty() {
                    return Err(NoStart::Switches(all.switches.len()));
                }
                break;
            }
            tried.push(all.off(0, all.count()));
        }
        if matches!(all.recurrence, Recurrence::Switch(..)) && shrinks(&all) {
            let place = motion.place().clone();
            let time = place.time;
            return Err(NoStart::Rests { time, place });
        }
        let numbered = tried.iter().copied().zip(1..);
        let nearest = numbered.min_by(|(one, _), (other, _)| one.total_cmp(other));
        let Some((off, over)) = nearest else {
            return Err(NoStart::NoZones);
        };
        if off <= RETURNED {
            return all.course(motion, [0, over]);
        }
        let not_periodic = |off: f64| NoStart::NotPeriodic {
            periods: tried.len() as u32,
            off,
            looks: None,
        };
        let count = all.count();
        let last = all.off(count - over, count);
        let (ends, least) = match last < off {
            true => ([count - over, count], last),
            false => ([0, over], off),
        };
        if least <= NEARLY {
            // without damping the distance goes up and down
            const FURTHER: f64 = 10.0;
            let mut more = none.after(motion);
            while more.count() < over && more.extend(motion)? {}
            let later = match more.count() == over {
                true => more.off(0, over),
                false => f64::INFINITY,
            };
            if later > FURTHER * least {
                return Err(not_periodic(later));
            }
            let nearly = Some((tried.len() as u32, least));
            return Ok(Course {
                nearly,
                ..all.course(motion, ends)?
            });
        }
        if !(last <= FALLS * off.min(before) && last.is_finite()) {
            return Err(not_periodic(off));
        }
        before = last;
    }
}

/// A zone longer than this, and than the motion that settled, does not end.
const ENDLESS: f64 = 1000.0;

/// Whether a motion would not move from a place by a part of its size that counts, in as long a time as was waited for
/// a switch. Its size is that of the states where it began and where it is: an equilibrium may have none.
fn rests(system: &AffineSystem, place: &Place, begun: &[f64]) -> bool {
    let states = begun.iter().chain(&place.state);
    let size = states.fold(0.0_f64, |size, x| size.max(x.abs()));
    let z = system.lift(place.mode, &place.state, place.phase);
    let rates = &system.modes[place.mode].matrix.at * z;
    rates.rows(0, system.states).amax() * ENDLESS <= RETURNED * size
}

/// The states that stand still for ever in the mode of a place, whatever the others and the phase do, if one of them could
/// stand elsewhere as well: none where they do not, or where a law holds them where they are. Sizes are those of the states
/// over the whole motion.
fn standing(system: &AffineSystem, place: &Place, sizes: &[f64]) -> Vec<usize> {
    let n = system.states;
    let matrix = &system.modes[place.mode].matrix.at;
    let rates = matrix * system.lift(place.mode, &place.state, place.phase);
    let stands = |state: &usize| rates[*state].abs() * ENDLESS <= RETURNED * sizes[*state];
    let mut all: Vec<usize> = (0..n).filter(stands).collect();
    loop {
        // states come first in z, and the constant after them
        let acts = |column: &usize| *column != n && !all.contains(column);
        let others: Vec<usize> = (0..matrix.ncols()).filter(acts).collect();
        let before = all.len();
        all.retain(|state| others.iter().all(|column| matrix[(*state, *column)] == 0.0));
        if all.len() == before {
            break;
        }
    }
    let is_free = |column: &usize| all.iter().all(|state| matrix[(*state, *column)] == 0.0);
    if all.iter().any(is_free) {
        all
    } else {
        Vec::new()
    }
}

/// Whether a motion that does not switch moves all states that could stand elsewhere, from this time on.
///
/// # Errors
/// It rests, or some of its states stand still for ever.
fn moves(
    wanted: &Wanted,
    system: &AffineSystem,
    (place, time): (&Place, f64),
    sizes: &[f64],
) -> Result<(), NoStart> {
    let states = standing(system, place, sizes);
    if states.len() == system.states {
        let place = place.clone();
        return Err(NoStart::Rests { time, place });
    }
    // where they stand is kept along a branch, but where a motion slides
    let mode = &system.modes[place.mode];
    if states.is_empty() || mode.surface.is_none() && mode.field.is_exact {
        return Ok(());
    }
    let names = &wanted.system.source.states;
    Err(NoStart::Stands {
        time,
        mode: wanted.system.mode_name(place.mode).into_owned(),
        states: states.iter().map(|state| names[*state].clone()).collect(),
    })
}

/// Whether a motion that returns to a switch shrinks to a point, as where it spirals into an equilibrium on a surface: its
/// rates move no state by a part that counts of its size over the whole motion, and the change from one return to the next
/// is no less than a part of that.
fn shrinks(all: &Returns) -> bool {
    /// The orbit that a motion settles on changes by much less over a return.
    const SHRINKS: f64 = 1e-3;
    let whole = all.whole;
    let [begin, last] = [0, all.count()].map(|index| &all.places[index].0);
    let mut sizes = vec![0.0; whole.len()];
    let mut from = begin;
    for (switching, place) in all.between(0, all.count()) {
        let z = all.system.lift(from.mode, &from.state, from.phase);
        let rates = &all.system.modes[from.mode].matrix.at * z;
        for (size, rate) in sizes.iter_mut().zip(&rates) {
            *size += rate.abs() * (switching.time - from.time);
        }
        from = place;
    }
    let pairs = begin.state.iter().zip(&last.state);
    let changes: Vec<f64> = pairs.map(|(x, y)| (x - y).abs()).collect();
    let mut pairs = sizes.iter().zip(whole);
    let small = pairs.all(|(size, whole)| *size <= RETURNED * whole);
    let mut changing = changes.iter().zip(&sizes);
    small && changing.any(|(change, size)| *size > 0.0 && *change >= SHRINKS * size)
}

/// The orbit with these zones next to these places.
fn pose(
    wanted: &Wanted,
    parts: Vec<(Zone, ZonePoint)>,
    periods: u32,
    settings: &Settings,
) -> Result<(AffineOrbit, Vector), NoStart> {
    /// Parts of an orbit that differ by less, in its own units, are the same.
    const SAME: f64 = 1e-9;
    let (orbit, guess) = scaled(wanted, parts, periods)?;
    let index = guess.len() - 1;
    let mut fixed = Fixed {
        index,
        value: guess[index],
    };
    let solution = newton::solve(&orbit, &mut fixed, &guess, settings).map_err(|failure| {
        let singular = matches!(failure, newton::Failure::Singular);
        if singular && is_in_family(&orbit, &guess) {
            NoStart::Family(NoFollower::Family)
        } else {
            NoStart::Newton(failure)
        }
    })?;
    let point = solution.point;
    let rests = !orbit.is_forced() && orbit.sequence.switches() == 0;
    if rests && orbit.varies_within(&point, SAME) {
        return Err(NoStart::Equilibrium);
    }
    let turns = orbit.turns_within(&point, SAME);
    let times = turns * orbit.traversals_within(&point, SAME);
    // a prescribed period is meant, however often the orbit is traversed in it
    if times > 1 && wanted.prescribed.is_none() {
        // the least period is meant: this one several times over would retrace its branch
        let mut zones = orbit.at(&point).map_err(failed)?.zones;
        zones[0].duration /= turns as f64;
        let parts = orbit.sequence.0.iter().cloned().zip(zones);
        let parts = parts.take((orbit.zones() / times).max(1));
        let periods = periods / if orbit.is_forced() { times as u32 } else { 1 };
        return pose(wanted, parts.collect(), periods, settings);
    }
    admitted(&orbit, &point)?;
    Ok((orbit, point))
}

impl From<NoBranch<AffineOrbit>> for NoStart {
    fn from(reason: NoBranch<AffineOrbit>) -> NoStart {
        match reason {
            NoBranch::Regular(singular) => NoStart::Regular(singular),
            NoBranch::Newton(failure) => NoStart::Newton(failure),
            NoBranch::Inadmissible(reason) => NoStart::Inadmissible(reason),
        }
    }
}

fn failed(failure: OrbitFailure) -> NoStart {
    NoStart::Newton(newton::Failure::System(failure))
}

/// The orbits with these zones, in units of these places, and the places in those.
pub(super) fn scaled(
    wanted: &Wanted,
    parts: Vec<(Zone, ZonePoint)>,
    periods: u32,
) -> Result<(AffineOrbit, Vector), NoStart> {
    /// A state that never exceeds this is zero but for rounding.
    const NOTHING: f64 = 1e-15;
    let (zones, points): (Vec<Zone>, Vec<ZonePoint>) = parts.into_iter().unzip();
    if wanted.values.len() != wanted.system.source.parameters.0.len() {
        return Err(NoStart::NoZones);
    }
    let states = wanted.system.source.states.len();
    if points.is_empty() || points.iter().any(|point| point.state.len() != states) {
        return Err(NoStart::NoZones);
    }
    let unit = |size: f64| {
        if size > NOTHING && size.is_finite() {
            size
        } else {
            1.0
        }
    };
    let scales = Scales {
        states: vec![1.0; states],
        time: unit(points.iter().map(|point| point.duration).sum()),
        parameter: wanted.width,
        free: wanted
            .prescribed
            .as_ref()
            .map(|prescribed| unit(wanted.values[prescribed.free()].abs())),
        section: None,
    };
    let setting = |scales: Scales| Setting {
        system: wanted.system.clone(),
        values: wanted.values.clone(),
        parameter: wanted.parameter,
        second: None,
        periods,
        prescribed: wanted.prescribed.clone(),
        stability: wanted.stability,
        scales,
    };
    let sequence = Sequence(zones);
    let posed = |scales: Scales| {
        let orbit = AffineOrbit::new(Arc::new(setting(scales)), sequence.clone());
        orbit.ok_or(NoStart::NoZones)
    };
    // a state may be zero at all of the switches: its size is that between them
    let bare = posed(scales.clone())?;
    let extremes = bare
        .extremes(&bare.pack(&points, &wanted.values))
        .map_err(failed)?;
    let units: Vec<f64> = extremes
        .iter()
        .map(|(low, high)| unit(low.abs().max(high.abs())))
        .collect();
    let free = wanted.system.source.forcing.is_none();
    let orbit = posed(Scales {
        section: free.then(|| of_orbit(&extremes, &units)).flatten(),
        states: units,
        ..scales
    })?;
    let orbit = orbit.keeping(&points[0].state);
    let point = orbit.pack(&points, &wanted.values);
    let begun = free && orbit.sequence.switches() == 0;
    let point = match begun {
        true => orbit.begun_at_section(&point).map_err(failed)?,
        false => point,
    };
    Ok((orbit, point))
}
