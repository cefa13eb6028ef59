//! The motion of a hybrid system from a state: the first zero of every guard, found by bounds and not by samples,
//! and what begins there.

mod accumulation;
mod halt;

pub use halt::Halt;

use std::sync::Arc;

use super::flow::{FlowPiece, ModeFlow, Onset, counted};
use super::mode::{AffineSystem, Exit, Row};
use super::slots::Slots;
use crate::linalg::Vector;
use accumulation::{Accumulation, EndedZone};

/// Where a motion is.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time since the beginning.
    pub time: f64,
    /// Phase of the forcing; zero without.
    pub phase: f64,
    /// The mode.
    pub mode: usize,
    /// The state.
    pub state: Vec<f64>,
}

/// A switch from one mode to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Switching {
    /// Its time.
    pub time: f64,
    /// Phase of the forcing there.
    pub phase: f64,
    /// The mode that ends.
    pub from: usize,
    /// The mode that begins.
    pub to: usize,
    /// The guard that is zero, by its number in the mode that ends.
    pub guard: usize,
    /// The exit taken, by its number in the guard.
    pub exit: usize,
    /// Whether a contact makes it.
    pub of_contact: bool,
    /// States before it.
    pub before: Vec<f64>,
    /// States after the reset.
    pub after: Vec<f64>,
}

/// What a step of a motion came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The time asked for.
    Reached,
    /// A switch before it.
    Switched(Switching),
    /// The section that is watched, before it.
    Section,
}

/// Pieces after which a motion asks how many are left.
const PATIENCE: u32 = 100_000;

/// It does not go on where there are more than these: with an exact flow, and with an integrated one, whose pieces take
/// hundreds of times as long. Either is a minute at least. What is fast at the beginning only has died out before.
const HOPELESS: [f64; 2] = [1e8, 1e6];

/// A form that is zero is so within this many units of its terms: the state at a switch is known to a few roundings.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Why a motion does not go on at a time where too many pieces are left, of this length, that of the first being known. Pieces that have
/// come from another length to none at all, beside which no later time has a number, go towards a place where the rates have no
/// value.
fn too_fast(time: f64, piece: f64, first: f64) -> Halt {
    /// Of the length of the first piece.
    const NONE: f64 = 1e-6;
    match piece < f64::EPSILON * time.abs() && piece < NONE * first {
        true => Halt::Unbounded { time },
        false => Halt::Fast { time, piece },
    }
}

/// A motion of a system.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    system: &'a AffineSystem,
    flows: Arc<Slots<ModeFlow>>,
    /// Longest piece of a flow.
    longest: f64,
    place: Moment,
    /// Whether the state has just been entered, so that guards may be zero.
    fresh: bool,
    /// Time at which the zone began.
    entered: f64,
    /// A guard that is zero where the zone begins, and of how many orders.
    tangent: Option<(usize, usize)>,
    /// Guards that are zero all along in the zone and end nothing.
    still: Vec<usize>,
    /// What is known of the last zones.
    accumulation: Accumulation,
    /// Length of the piece it is in.
    unit: f64,
    section: Option<WatchedSection>,
}

/// A section that a motion is watched for, and what is known of its sign.
#[derive(Clone, Debug)]
struct WatchedSection {
    row: Vector,
    /// Whether the motion comes from below; where it does not it has to get there first. Not known in a zone that
    /// lies in the section.
    below: Option<bool>,
    /// Whether the motion is at the section just now.
    there: bool,
}

impl<'a> Motion<'a> {
    /// A motion that begins at a place; pieces are no longer than `longest`.
    pub fn new(system: &'a AffineSystem, place: Moment, longest: f64) -> Motion<'a> {
        Motion {
            flows: Arc::new(Slots::new(system.modes.len())),
            longest,
            system,
            fresh: true,
            entered: place.time,
            tangent: None,
            still: Vec::new(),
            accumulation: Accumulation::default(),
            section: None,
            unit: longest,
            place,
        }
    }

    /// The same motion, which now stops wherever this linear form of z comes to zero from below: also at a switch,
    /// before it, but not where a reset leads across. The form is that of the first guard of a mode.
    pub fn watching(mut self, mode: usize) -> Motion<'a> {
        let form = self.system.modes.get(mode);
        let form = form.and_then(|mode| Some(mode.guards.first()?.row.at.clone()));
        self.section = form.map(|row| WatchedSection {
            row,
            below: None,
            there: true,
        });
        self.flows = Arc::new(Slots::new(self.system.modes.len()));
        self
    }

    /// The flow of a mode, which watches the section, too; `flows` are those of the motion.
    fn flow<'f>(&self, flows: &'f Slots<ModeFlow>, mode: usize) -> &'f ModeFlow {
        flows.get_or_make(mode, || {
            let mut flow = ModeFlow::new(&self.system.modes[mode], self.longest);
            if let Some(WatchedSection { row, .. }) = &self.section {
                flow.watch(-row);
                flow.watch(row.clone());
            }
            flow.watch_bounds(&self.system.modes[mode]);
            flow
        })
    }

    /// Whether every guard of the mode is positive at the place, or about to be.
    pub fn is_inside(&self) -> bool {
        let Moment {
            state, phase, mode, ..
        } = &self.place;
        let flow = self.flow(&self.flows, *mode);
        let piece = flow.piece(self.system.lift(*mode, state, *phase));
        let mut guards = 0..self.system.modes[*mode].guards.len();
        guards.all(|guard| match flow.onset(guard, &piece) {
            Onset::Positive(_) => true,
            Onset::Negative => false,
            Onset::Zero => self.keeps(*mode, guard),
        })
    }

    /// Where it is.
    pub fn place(&self) -> &Moment {
        &self.place
    }

    /// Moves on to a time, or to the first switch before it.
    ///
    /// # Errors
    /// Why the motion does not go on.
    pub fn step(&mut self, until: f64) -> Result<Step, Halt> {
        loop {
            if let Some(step) = self.move_on(until)? {
                return Ok(step);
            }
        }
    }

    /// The same; none where the motion has only come below its section.
    fn move_on(&mut self, until: f64) -> Result<Option<Step>, Halt> {
        let Moment {
            time: start,
            phase,
            mode,
            ..
        } = self.place;
        self.check_contacts()?;
        let flows = self.flows.clone();
        let flow = self.flow(&flows, mode);
        let corrected = |mut z: Vector| {
            self.system.correct(mode, &mut z);
            z
        };
        let mut piece = flow.piece(corrected(self.system.lift(mode, &self.place.state, phase)));
        if !flow.is_defined(&piece) {
            return Err(Halt::Unbounded { time: start });
        }
        self.unit = piece.length;
        let count = self.system.modes[mode].guards.len();
        let mut orders = vec![0; count];
        if let Some(guard) = self.begin_zone(flow, &piece, &mut orders)? {
            return self.switch(guard, 0.0, &piece.z).map(Some);
        }
        let watched = self.watch_section(flow, &piece, &mut orders);
        let (mut time, mut begun) = (start, 0.0);
        let is_integrated = !self.system.modes[mode].field.is_exact;
        let (mut pieces, hopeless) = (0, HOPELESS[usize::from(is_integrated)]);
        let (first, mut longest) = (piece.length, piece.length);
        while time < until {
            self.unit = piece.length;
            pieces += 1;
            if !flow.is_defined(&piece) {
                return Err(Halt::Unbounded {
                    time: start + begun,
                });
            }
            let rest = until - time;
            longest = counted(longest, piece.length);
            if pieces > PATIENCE && rest > hopeless * longest {
                return Err(too_fast(time, longest, first));
            }
            let part = (rest / piece.length).min(1.0);
            let own = (0..count).filter(|guard| !self.still.contains(guard));
            let guards = watched.into_iter().chain(own);
            let crossing = self.first_crossing(flow, &piece, guards, (&mut orders, part));
            let lasts = crossing.map_or(part, |(after, _)| after / piece.length);
            self.check_bounds(flow, (&piece, lasts), start + begun)?;
            if let Some((after, guard)) = crossing {
                return self.cross(
                    guard,
                    begun + after,
                    start + begun + after,
                    &flow.within(&piece, after),
                );
            }
            if part < 1.0 {
                piece.z = flow.within(&piece, rest);
                time = until;
            } else {
                begun += piece.length;
                time = start + begun;
                let next = flow.piece(corrected(flow.advance(&piece)));
                if (!flow.is_defined(&next) || flow.begins_at_root(&next))
                    && let Some(guard) = self.touched([&piece.z, &next.z])
                {
                    return self.cross(guard, begun, time, &next.z);
                }
                piece = next;
            }
        }
        if !piece.z.iter().all(|x| x.is_finite()) {
            return Err(Halt::Unbounded { time: start });
        }
        let phase = phase + self.system.omega.value * (until - start);
        self.come(until, phase, &piece.z);
        Ok(Some(Step::Reached))
    }

    /// When the first of these guards becomes negative within a part of a piece, and which; zeros of these orders at its beginning
    /// are none. At one instant their order decides, but an impact comes before what it takes back: a slider that has given at
    /// a stop comes to its bound where the stop is reached, and turns there.
    fn first_crossing(
        &self,
        flow: &ModeFlow,
        piece: &FlowPiece,
        guards: impl Iterator<Item = usize>,
        (orders, part): (&mut [usize], f64),
    ) -> Option<(f64, usize)> {
        let mut first: Option<(f64, usize)> = None;
        let mut impacts = Vec::new();
        for guard in guards {
            let crossing = flow.crossing(guard, piece, orders[guard], part);
            orders[guard] = 0;
            let Some(after) = crossing else { continue };
            if first.is_none_or(|(known, _)| after < known) {
                first = Some((after, guard));
            }
            if self.is_impact(guard) {
                impacts.push(guard);
            }
        }
        let (after, guard) = first?;
        impacts.retain(|impact| *impact != guard);
        if impacts.is_empty() || self.is_impact(guard) {
            return first;
        }
        let z = flow.within(piece, after);
        let mode = &self.system.modes[self.place.mode];
        let is_zero = |impact: &usize| {
            let row = &mode.guards[*impact].row;
            let approaches = flow.slopes(&row.at, &z)[1] < 0.0;
            approaches && row.value(&z).abs() <= ROUNDING * row.size(&z)
        };
        let impact = impacts.into_iter().find(is_zero);
        Some((after, impact.unwrap_or(guard)))
    }

    /// Whether a contact has an impact at a guard of the mode.
    fn is_impact(&self, guard: usize) -> bool {
        let guards = &self.system.modes[self.place.mode].guards;
        let exit = guards.get(guard).and_then(|guard| guard.exits.first());
        exit.is_some_and(|exit| exit.of_contact && !exit.is_continuous())
    }

    /// The guard that is zero at the end of a piece, by these places of its beginning and its end, where a root in the rates comes to zero:
    /// a tank that empties touches zero, and its rate has no derivative there.
    fn touched(&self, [begin, end]: [&Vector; 2]) -> Option<usize> {
        /// Part of what the guard is at the beginning, which rounding leaves of its terms.
        const ZERO: f64 = 1e-12;
        let guards = self.system.modes[self.place.mode].guards.iter();
        let mut guards = guards.map(|guard| [begin, end].map(|z| guard.row.value(z)));
        guards.position(|[begin, end]| begin > 0.0 && end.abs() <= ZERO * begin)
    }

    /// Goes over a guard, or the section, which is reached so long after the zone began.
    fn cross(
        &mut self,
        guard: usize,
        elapsed: f64,
        time: f64,
        z: &Vector,
    ) -> Result<Option<Step>, Halt> {
        match self.rises_at(guard, z) {
            None => self.switch(guard, elapsed, z).map(Some),
            Some(risen) => {
                let phase = self.place.phase + self.system.omega.value * elapsed;
                self.come(time, phase, z);
                Ok(risen.then_some(Step::Section))
            }
        }
    }

    /// Refuses a mode in which the forces of contacts make no motion.
    fn check_contacts(&self) -> Result<(), Halt> {
        let Moment { time, mode, .. } = self.place;
        match self.system.modes[mode].obstruction.clone() {
            Some(mistake) => Err(Halt::Obstructed {
                time,
                mode,
                mistake,
            }),
            None => Ok(()),
        }
    }

    /// Refuses a bound of friction that is negative over a part of a piece, which begins at this time.
    fn check_bounds(
        &self,
        flow: &ModeFlow,
        (piece, part): (&FlowPiece, f64),
        begun: f64,
    ) -> Result<(), Halt> {
        let mode = self.place.mode;
        let lasts = part > 0.0;
        let negative = || flow.negative_bound(&self.system.modes[mode], piece, part);
        match lasts.then(negative).flatten() {
            Some((guard, after, value)) => Err(Halt::NegativeBound {
                time: begun + after,
                mode,
                guard,
                value,
            }),
            None => Ok(()),
        }
    }

    /// The guard that is negative at once where the zone begins; `orders` are those of the zeros of the others.
    fn begin_zone(
        &mut self,
        flow: &ModeFlow,
        piece: &FlowPiece,
        orders: &mut [usize],
    ) -> Result<Option<usize>, Halt> {
        if !self.fresh {
            return Ok(None);
        }
        let Moment { time, mode, .. } = self.place;
        self.still.clear();
        for (guard, known) in orders.iter_mut().enumerate() {
            let tangent = self.tangent.filter(|(known, _)| *known == guard);
            let zeros = tangent.map_or(0, |(_, zeros)| zeros);
            match flow.onset_from(guard, piece, zeros) {
                Onset::Positive(order) => *known = order,
                Onset::Negative => return Ok(Some(guard)),
                Onset::Zero if self.is_void(mode, guard) => {
                    return Err(Halt::Void { mode, guard });
                }
                Onset::Zero if self.keeps(mode, guard) => self.still.push(guard),
                Onset::Zero => return Err(Halt::Undecided { time, mode, guard }),
            }
        }
        Ok(None)
    }

    /// The form that is positive on the side of the section where the motion is, behind the guards: below the section its
    /// negative, above it the section itself. `orders` get those of both.
    fn watch_section(
        &mut self,
        flow: &ModeFlow,
        piece: &FlowPiece,
        orders: &mut Vec<usize>,
    ) -> Option<usize> {
        let count = orders.len();
        let section = self.section.as_mut()?;
        let mut order = 0;
        if self.fresh || section.there {
            section.below = match flow.onset(count, piece) {
                Onset::Positive(_) => Some(true),
                Onset::Negative => Some(false),
                Onset::Zero => None,
            };
            let side = section.below.map(|below| count + usize::from(!below));
            if let Some(Onset::Positive(zero)) = side.map(|side| flow.onset(side, piece)) {
                order = zero;
            }
            section.there = false;
        }
        orders.resize(count + 2, order);
        section.below.map(|below| count + usize::from(!below))
    }

    /// Whether the motion rises through its section where a guard, or the form of the section behind them, is zero; none where
    /// it switches there.
    fn rises_at(&mut self, guard: usize, z: &Vector) -> Option<bool> {
        let count = self.system.modes[self.place.mode].guards.len();
        let section = self.section.as_mut()?;
        // a switch in the section itself: which of the two comes first is rounding
        let size: f64 = section.row.iter().zip(z).map(|(c, z)| (c * z).abs()).sum();
        let zero = section.row.dot(z).abs() <= ROUNDING * size;
        let risen = section.below == Some(true);
        if guard < count && !(risen && zero) {
            return None;
        }
        section.there = true;
        Some(risen)
    }

    /// Whether a guard keeps its value within its mode, and may be zero there.
    fn keeps(&self, mode: usize, guard: usize) -> bool {
        let exits = &self.system.modes[mode].guards[guard].exits;
        exits.iter().any(|exit| exit.keeps)
    }

    /// Whether a guard is zero whatever the state.
    fn is_void(&self, mode: usize, guard: usize) -> bool {
        let row = &self.system.modes[mode].guards[guard].row.at;
        row.iter().all(|c| *c == 0.0)
    }

    /// Takes a place within the zone.
    fn come(&mut self, time: f64, phase: f64, z: &Vector) {
        self.place.state.clear();
        let state = z.rows(0, self.system.states);
        self.place.state.extend(state.iter());
        self.place.phase = phase;
        self.place.time = time;
        self.fresh = false;
    }

    /// The exit that is taken where a guard is zero, and its number.
    fn exit(&self, guard: usize, time: f64, z: &Vector) -> Result<(usize, &'a Exit), Halt> {
        let mode = self.place.mode;
        let exits = &self.system.modes[mode].guards[guard].exits;
        // a condition that is zero holds; so it does where rounding alone makes it negative
        let holds = |row: &Row| row.value(z) >= -ROUNDING * row.size(z);
        let mut numbered = exits.iter().enumerate();
        let exit = numbered.find(|(_, exit)| exit.conditions.iter().all(holds));
        exit.ok_or_else(|| {
            let mut conditions = exits.iter().flat_map(|exit| &exit.conditions);
            if exits.is_empty() {
                Halt::Parted { time, mode, guard }
            } else if conditions.any(|row| !row.value(z).is_finite()) {
                Halt::Unbounded { time }
            } else {
                Halt::NoExit { time, mode, guard }
            }
        })
    }

    /// Goes over to the mode that a guard leads to, so long after the last place.
    fn switch(&mut self, guard: usize, elapsed: f64, z: &Vector) -> Result<Step, Halt> {
        let Moment {
            time: start,
            phase,
            mode,
            ..
        } = self.place;
        let time = start + elapsed;
        let known = &self.system.modes[mode];
        let mut z = z.clone();
        known.field.complete_at_switch(&mut z);
        let (number, exit) = self.exit(guard, time, &z)?;
        if let Some(mistake) = exit.refusal.clone() {
            let phase = phase + self.system.omega.value * elapsed;
            self.come(time, phase, &z);
            return Err(Halt::Refused {
                time,
                mode,
                guard,
                mistake: Box::new(mistake),
            });
        }
        let lasted = time - self.entered;
        let ended = EndedZone {
            mode,
            guard,
            exit,
            time,
            lasted,
            unit: self.unit,
            z: &z,
        };
        let rest = self.accumulation.ended(self.system, &ended)?;
        let states = 0..self.system.states;
        let (to, reset) = match &rest {
            Some((rest, reset)) => (*rest, reset),
            None => (exit.to, &exit.reset),
        };
        let mut after: Vec<f64> = states.map(|state| reset.value(state, &z)).collect();
        let before: Vec<f64> = z.rows(0, self.system.states).iter().copied().collect();
        let phase = phase + self.system.omega.value * elapsed;
        if rest.is_some() {
            accumulation::stop(self.system, to, (&before, &mut after), phase);
        }
        self.tangent = exit.tangent.filter(|_| lasted > 0.0);
        self.place = Moment {
            time,
            phase: phase.rem_euclid(std::f64::consts::TAU),
            mode: to,
            state: after.clone(),
        };
        (self.fresh, self.entered) = (true, time);
        Ok(Step::Switched(Switching {
            time,
            phase,
            from: mode,
            to,
            guard,
            exit: number,
            of_contact: exit.of_contact,
            before,
            after,
        }))
    }
}
