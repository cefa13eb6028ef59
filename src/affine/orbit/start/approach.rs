//! The motion that leads to a first orbit: it settles, and is followed until it is back where it was.

use std::f64::consts::TAU;

use super::failure::NoStart;
use super::guess::{FROM_A_GUESS, OrbitGuess};
use super::rest::{ENDLESS, moves, rests, speed};
use super::returns::{Recurrence, Returns, returning};
use super::switches::{Settling, closed, from_switch, next_switch, run};
use super::{Beginning, Search, Wanted};
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Moment, Motion, Step, Switching};
use crate::affine::orbit::behaviour::{Behaviour, RETURNED, behaviour, cycle};
use crate::affine::orbit::layout::AffineOrbit;
use crate::linalg::Vector;

/// A motion that has settled, and what is known of it from its beginning on.
pub(super) struct Approach<'a> {
    wanted: &'a Wanted,
    system: &'a AffineSystem,
    pub motion: Motion<'a>,
    /// Period of the forcing.
    pub forcing: Option<f64>,
    /// Time that it was given to settle.
    settle: f64,
    settling: Settling,
}

impl<'a> Approach<'a> {
    /// The motion once it has settled; a guess is where it begins.
    pub fn settled(
        wanted: &'a Wanted,
        system: &'a AffineSystem,
        beginning: &'a Beginning,
        search: Search,
    ) -> Result<Approach<'a>, NoStart> {
        let omega = system.omega.value;
        let forcing = (omega > 0.0).then(|| TAU / omega);
        let settle = match search {
            Search::Settles(periods) => periods * forcing.unwrap_or(1.0),
            Search::Guess(_) => 0.0,
        };
        let longest = match (forcing, search) {
            (Some(period), _) => period,
            (None, Search::Guess(time)) => time,
            (None, Search::Settles(_)) => settle.max(1.0),
        };
        let begin = Moment::from(beginning);
        let mut motion = Motion::new(system, begin.clone(), longest);
        let switches = run(&mut motion, settle)?;
        Ok(Approach {
            settling: Settling::new(system, begin, switches, motion.place()),
            wanted,
            system,
            motion,
            forcing,
            settle,
        })
    }

    /// Periods of the forcing, or returns to a switch, that are asked for.
    fn periods(&self) -> u32 {
        self.wanted.periods.max(1)
    }

    /// Whether it is where a zone begins at a switch: a guard of its own mode is zero.
    pub fn is_on_guard(&self) -> bool {
        let place = self.motion.place();
        let z = self.system.lift(place.mode, &place.state, place.phase);
        let mut guards = self.system.modes[place.mode].guards.iter();
        guards.any(|guard| {
            let terms = guard.row.at.iter().zip(&z).map(|(c, z)| c * z);
            let size: f64 = terms.clone().map(f64::abs).sum();
            // a guard of states that are all zero is zero
            terms.sum::<f64>().abs() <= RETURNED * size
        })
    }

    /// The orbit from the switch where it is, over the periods of the forcing, or this time without forcing.
    pub fn begun_at_switch(&mut self, time: f64) -> Result<OrbitGuess, NoStart> {
        let periods = self.periods();
        let time = self
            .forcing
            .map_or(time, |period| f64::from(periods) * period);
        Ok(OrbitGuess {
            zones: from_switch(&mut self.motion, time)?,
            whole: None,
            periods,
            nearly: None,
        })
    }

    /// The orbit over periods of the forcing: as many as are asked for from a guess, else the least number after which the
    /// motion is back.
    pub fn over_periods(&mut self, period: f64, search: Search) -> Result<OrbitGuess, NoStart> {
        let most = self.periods() as usize;
        let recurrence = Recurrence::Phase(period);
        let none = Returns::none(self.system, &recurrence, &self.settling, &self.motion);
        match search {
            Search::Settles(_) => returning(&none, &mut self.motion, most),
            Search::Guess(_) => none.followed(&mut self.motion, most),
        }
    }

    /// The orbit over this time without forcing; none where the motion does not switch until then.
    pub fn over_time(&mut self, time: f64) -> Result<Option<OrbitGuess>, NoStart> {
        /// How much later than the time the last switch may come.
        const LATE: f64 = 1.01;
        let begin = self.motion.place().time;
        let mut switches = run(&mut self.motion, begin + LATE * time)?;
        let Some((first, _)) = switches.first() else {
            return Ok(None);
        };
        // the first comes again as much later than the period as it came after the beginning: what comes in the
        // first half of that is the last of the orbit, as where it begins just after a switch
        let end = begin + time + 0.5 * (first.time - begin);
        switches.retain(|(switching, _)| switching.time <= end);
        Ok(Some(OrbitGuess {
            zones: closed(switches, time),
            whole: None,
            periods: 1,
            nearly: None,
        }))
    }

    /// The orbit within one mode that takes about this time from where the motion began, or the cycle on which it settles: a
    /// guess may lie beside that.
    pub fn unswitched(&self, begin: Moment, time: f64) -> Result<(AffineOrbit, Vector), NoStart> {
        /// Periods after which a motion is on its cycle.
        const SETTLED: f64 = 40.0;
        let orbit = |place: Moment, period: f64| {
            OrbitGuess::unswitched(place, period).orbit(self.wanted, &FROM_A_GUESS)
        };
        orbit(begin, time).or_else(|reason| {
            let cycle = cycle(self.system, self.motion.place(), SETTLED * time);
            let (place, period) = cycle.ok_or(reason)?;
            orbit(place, period)
        })
    }

    /// The orbit to which the motion settles without forcing: over the least number of returns to its next switch, or within
    /// one mode.
    pub fn over_returns(&mut self) -> Result<OrbitGuess, NoStart> {
        let settled = self.motion.place().clone();
        let reason = match self.returning_to_switch() {
            Ok(guess) => return Ok(guess),
            Err(reason) => reason,
        };
        if let NoStart::Leaves { time } = reason
            && self.comes_to_rest()
        {
            let place = self.motion.place().clone();
            return Err(NoStart::Rests { time, place });
        }
        let here = self.motion.place();
        let rests = |place: &Moment| rests(self.system, place, &self.settling.begin.state);
        match reason {
            // of what decays for ever numbers are lost in the end
            NoStart::Halted(_) if rests(&settled) => {
                let (time, place) = (settled.time, settled);
                Err(NoStart::Rests { time, place })
            }
            NoStart::Leaves { .. } => {
                let cycle = cycle(self.system, here, self.settle.max(1.0));
                let (place, period) = cycle.ok_or(reason)?;
                Ok(OrbitGuess::unswitched(place, period))
            }
            reason => Err(reason),
        }
    }

    /// Whether the motion, which does not switch, rests where it is, or does so in the end: its rates fall in every further
    /// interval of as long a time as was waited for a switch, as those of a slow spiral do.
    fn comes_to_rest(&mut self) -> bool {
        /// Intervals at most, and by how much rates fall in each: they turn with the motion.
        const INTERVALS: usize = 8;
        const FALLS: f64 = 0.1;
        let mut before = f64::INFINITY;
        for _ in 0..INTERVALS {
            let here = self.motion.place();
            if rests(self.system, here, &self.settling.begin.state) {
                return true;
            }
            let now = speed(self.system, here);
            if now > FALLS * before {
                return false;
            }
            before = now;
            let until = here.time + self.longest();
            if !matches!(self.motion.step(until), Ok(Step::Reached)) {
                return false;
            }
        }
        false
    }

    /// How long the next switch is waited for. Where a mode has none the motion settles further in that time, which is then so many
    /// times that for which it was asked to settle: in whatever unit of time.
    fn longest(&self) -> f64 {
        const FURTHER: f64 = 40.0;
        let mode = &self.system.modes[self.motion.place().mode];
        let further = match mode.guards.is_empty() && self.settle > 0.0 {
            true => ENDLESS.min(FURTHER * self.settle),
            false => ENDLESS,
        };
        self.settle.max(further)
    }

    fn returning_to_switch(&mut self) -> Result<OrbitGuess, NoStart> {
        let longest = self.longest();
        let (first, _) = next_switch(&mut self.motion, longest)?;
        let most = self.periods() as usize;
        let recurrence = Recurrence::Switch(first, longest);
        let none = Returns::none(self.system, &recurrence, &self.settling, &self.motion);
        returning(&none, &mut self.motion, most)
    }

    /// Refuses a guess of which no branch is followed: one that stands still in part, or with infinitely many switches.
    pub fn admit(&self, guess: &OrbitGuess) -> Result<(), NoStart> {
        if let Some((place, _)) = &guess.whole {
            moves(
                self.wanted,
                self.system,
                (place, self.settling.last_switch()),
                &self.settling.sizes,
            )?;
        }
        // a switch that leads to where infinitely many others end
        let leads = |(_, switching, _): &&(Moment, Switching, f64)| {
            let exits = &self.system.modes[switching.from].guards[switching.guard].exits;
            exits.get(switching.exit).map(|exit| exit.to) == Some(switching.to)
        };
        let Some((_, switching, _)) = guess.zones.iter().find(|zone| !leads(zone)) else {
            return Ok(());
        };
        let name = |mode: usize| self.wanted.system.mode_name(mode).into_owned();
        Err(NoStart::Accumulates {
            time: switching.time,
            from: name(switching.from),
            to: name(switching.to),
        })
    }

    /// What the motion looks like where it is not periodic.
    pub fn behaviour(&mut self) -> Option<Behaviour> {
        let interval = self.forcing.or_else(|| return_time(&mut self.motion))?;
        behaviour(self.system, self.motion.place(), interval)
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
