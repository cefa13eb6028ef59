//! Returns of a motion to the end of a forcing period, or to a switch without forcing: the least number of them after which it
//! is where it was.

use std::f64::consts::TAU;

use super::failure::NoStart;
use super::guess::OrbitGuess;
use super::rest::spirals_in;
use super::switches::{MOST_SWITCHES, Settling, Switches, closed, next_switch, run, zones};
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Moment, Motion, Switching};
use crate::affine::orbit::behaviour::RETURNED;

/// One that settles slowly has returned, too, where it is off by no more than this: Newton's method does the rest.
const NEARLY: f64 = 1e-3;

/// A state smaller than this part of its size over the whole motion has decayed to zero: Newton's method does the rest.
const DECAYED: f64 = 1e-9;

/// So many roundings of the terms of a rate are what a motion may leave in a state over a return.
const ROUNDINGS: f64 = 100.0;

/// How far a place is from another one that should be the same after so many returns, relative to the states on the way and
/// to what their rates, and those of the rates, make of the time of one return: a state may be zero at all of the switches,
/// begin and end a zone of sliding with no rate, or be at rest at the beginning.
///
/// A state whose size is next to nothing of the one in `whole`, that over the whole motion, has decayed to zero: it is the
/// same as before however fast it decays. One that is off by no more than rounding of the terms of its rate has come back: what is at
/// rest has a velocity of rounding.
fn distance(
    system: &AffineSystem,
    begin: &Moment,
    here: &Moment,
    (switches, returns): (&[(Switching, Moment)], usize),
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
    let mut terms = sizes.clone();
    for (mode, states, phase) in ends.chain(edges) {
        let matrix = &system.modes[mode].matrix.at * (time / TAU);
        let lifted = system.lift(mode, states, phase);
        let of_rates = system.terms_of_rates(mode, states, phase);
        let first = &matrix * &lifted;
        let second = &matrix * &first;
        for (state, x) in states.iter().enumerate() {
            let size = x.abs().max(first[state].abs()).max(second[state].abs());
            sizes[state] = sizes[state].max(size);
            terms[state] = terms[state].max(of_rates[state] * time);
        }
    }
    let off = |state: usize| {
        let off = (begin.state[state] - here.state[state]).abs();
        let decayed = sizes[state] <= DECAYED * whole[state];
        let is_rounding = off <= ROUNDINGS * f64::EPSILON * terms[state];
        if decayed || is_rounding {
            0.0
        } else {
            off / sizes[state]
        }
    };
    (0..sizes.len()).map(off).fold(0.0, f64::max)
}

/// What counts as a return of a motion.
pub(super) enum Recurrence {
    /// The end of a forcing period.
    Phase(f64),
    /// Without forcing: this switch again, none of those between later than this time after the one before.
    Switch(Switching, f64),
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
pub(super) struct Returns<'a> {
    system: &'a AffineSystem,
    recurrence: &'a Recurrence,
    settling: &'a Settling,
    /// Where it is at first and at every return, and how many switches it has come through until then.
    places: Vec<(Moment, usize)>,
    switches: Switches,
}

impl<'a> Returns<'a> {
    /// None yet.
    pub fn none(
        system: &'a AffineSystem,
        recurrence: &'a Recurrence,
        settling: &'a Settling,
        motion: &Motion,
    ) -> Returns<'a> {
        Returns {
            system,
            recurrence,
            settling,
            places: vec![(motion.place().clone(), 0)],
            switches: Switches::new(),
        }
    }

    /// None yet of those that follow.
    fn after(&self, motion: &Motion) -> Returns<'a> {
        Returns::none(self.system, self.recurrence, self.settling, motion)
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
    fn between(&self, from: usize, to: usize) -> &[(Switching, Moment)] {
        &self.switches[self.places[from].1..self.places[to].1]
    }

    /// Whether the motion spirals into a point.
    fn spirals_in(&self) -> bool {
        let own = zones(&self.places[0].0, &self.switches).rev();
        let all = own.chain(self.settling.zones().rev());
        spirals_in(self.system, all, &self.settling.sizes)
    }

    /// How far the motion is off at one from where it is at an earlier one.
    fn off(&self, from: usize, to: usize) -> f64 {
        let [begin, here] = [from, to].map(|index| &self.places[index].0);
        if begin.mode != here.mode {
            return f64::INFINITY;
        }
        let way = (self.between(from, to), to - from);
        distance(self.system, begin, here, way, &self.settling.sizes)
    }

    /// The course over so many more.
    pub fn followed(mut self, motion: &mut Motion, most: usize) -> Result<OrbitGuess, NoStart> {
        while self.count() < most {
            if !self.extend(motion)? {
                return Err(NoStart::Switches(self.switches.len()));
            }
        }
        self.course(motion, [0, most])
    }

    /// The course from one of them to another; the motion goes on to phase 0 where it does not switch.
    fn course(&self, motion: &mut Motion, [from, to]: [usize; 2]) -> Result<OrbitGuess, NoStart> {
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
            let place = Moment {
                phase: 0.0,
                ..motion.place().clone()
            };
            whole = Some((place, time));
        }
        Ok(OrbitGuess {
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
pub(super) fn returning(
    none: &Returns,
    motion: &mut Motion,
    most: usize,
) -> Result<OrbitGuess, NoStart> {
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
        if let Recurrence::Switch(..) = all.recurrence
            && all.spirals_in()
        {
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
            return Ok(OrbitGuess {
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
