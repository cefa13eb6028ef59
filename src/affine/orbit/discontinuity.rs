//! Whether the return map is discontinuous at an event beyond which no orbit goes on.
//!
//! Motions begin on the orbit of the event, in the middle of its longest zone, at values p ± δ of the parameter: the
//! event lies between them, but for chance. Where the map is continuous both come back next to where they began after one
//! period, and nearer the smaller δ is. Where motions of one side do and those of the other come, however small δ is, to
//! one place at a finite distance, or do not go on, the map jumps at the orbit: no sequence of zones goes on from there.
//! Where those of one side switch no more and stay near their beginnings, as a block that is held for good, the orbit ends too.
//!
//! Where the parameter has no part in the way to the event, as that of an impulse which is given there, rounding decides on
//! both sides what becomes of them: then motions begin beside the orbit in one state after the other, at p itself.

use super::OrbitTermination;
use super::layout::{AffineOrbit, OrbitAt};
use crate::affine::mode::AffineSystem;
use crate::affine::motion::{Halt, Moment, Motion, Step};
use crate::linalg::Vector;
use crate::orbit::Zones;

/// δ, as parts of the range of the parameter, or of the unit of a state.
const BESIDE: [f64; 3] = [1e-5, 1e-7, 1e-9];

/// A motion has come back where it is off by less than this at the least δ, as a part of the range of each state, and by
/// less than the second part of what it is off at the δ before, or by nothing but rounding: √δ falls to a tenth from one δ
/// to the next, its third root to a fifth, and its fourth, of two that graze in one period, to a third. Where it falls so from each
/// to the next it may be off by the last of these parts still.
const NEAR: f64 = 1e-3;
const FALLS: f64 = 0.4;
const ROUNDING: f64 = 1e-8;
const FALLING: f64 = 0.1;

/// It has gone elsewhere where it is off by more than this whatever δ is, and at the least by this much of what it is off
/// at the δ before: what grows with δ from there on is a hundredth of 1e-7 by then.
const FAR: f64 = 1e-6;
const STAYS: f64 = 0.9;

/// Periods without a switch of motions that switch no more: what moves beside a block that is held settles meanwhile.
const WITHOUT_SWITCH: f64 = 8.0;

/// Most switches of a period.
const MOST_SWITCHES: usize = 10_000;

/// What becomes of motions that begin at values of the parameter ever nearer to the event, on one of its sides.
pub(super) enum Fate {
    /// They come back.
    Returns,
    /// They come to a place that is this far off.
    Elsewhere(f64),
    /// They do not go on.
    Halts(Halt),
    /// They come back without a switch, in the mode with this number.
    Stays(usize),
}

/// Where a motion is after a period.
struct PeriodEnd {
    /// How far it is off at the end, in units of the range of each state.
    off: f64,
    /// The mode in which it began, where it has not left it for some periods.
    stays: Option<usize>,
}

impl AffineOrbit {
    /// Why no orbit is near beyond an event, by the motions beside it; `None` where they do not tell.
    pub(super) fn jumps(&self, point: &Vector) -> Option<OrbitTermination> {
        let mut axes = std::iter::once(None).chain((0..self.states()).map(Some));
        let other =
            axes.find_map(
                |axis| match [-1.0, 1.0].map(|side| self.fate(point, axis, side)) {
                    [Some(Fate::Returns), Some(Fate::Returns)] => None,
                    [Some(Fate::Stays(_)), Some(Fate::Stays(_))] => None,
                    // moved in a state it need not be beyond the event
                    [Some(Fate::Stays(mode)), _] | [_, Some(Fate::Stays(mode))] => {
                        axis.is_none().then_some(Fate::Stays(mode))
                    }
                    [Some(Fate::Returns), other] | [other, Some(Fate::Returns)] => other,
                    _ => None,
                },
            )?;
        match other {
            Fate::Returns => None,
            Fate::Elsewhere(apart) => Some(OrbitTermination::Discontinuous { apart }),
            Fate::Stays(mode) => Some(OrbitTermination::Stays {
                mode: self.setting.system.mode_name(mode).into_owned(),
            }),
            Fate::Halts(halt) => {
                let (mode, guard) = halt.place()?;
                let system = &self.setting.system;
                let (mode, guard) = (
                    system.mode_name(mode).into_owned(),
                    system.guard_name(mode, guard),
                );
                Some(match halt {
                    Halt::Refused { mistake, .. } => OrbitTermination::Refused {
                        mode,
                        guard,
                        mistake,
                    },
                    _ => OrbitTermination::Halts {
                        mode,
                        guard,
                        by_contacts: !system.source.contacts.is_empty(),
                    },
                })
            }
        }
    }

    /// The fate of motions on one side, of the parameter or of a state; `None` where there is none.
    pub(super) fn fate(&self, point: &Vector, axis: Option<usize>, side: f64) -> Option<Fate> {
        let offs = BESIDE.map(|part| self.off_after_a_period(point, axis, side * part));
        let [first, between, last] = offs;
        match (first?, last?) {
            (Ok(first), Ok(last)) => {
                let before = between.and_then(Result::ok)?;
                let modes = [first.stays, before.stays, last.stays];
                let [first, before, last] = [first.off, before.off, last.off];
                let least = first.min(before).min(last);
                let falls = last <= (FALLS * before).max(ROUNDING);
                let falling = before <= FALLS * first && last <= FALLING;
                if falls && (last <= NEAR || falling) {
                    Some(match modes {
                        [Some(mode), Some(_), Some(_)] => Fate::Stays(mode),
                        _ => Fate::Returns,
                    })
                } else if least >= FAR && last >= STAYS * before {
                    Some(Fate::Elsewhere(last))
                } else {
                    None
                }
            }
            (Err(one), Err(halt)) => {
                let same = std::mem::discriminant(&one) == std::mem::discriminant(&halt);
                same.then_some(Fate::Halts(halt))
            }
            _ => None,
        }
    }

    /// How far a motion is off after a period that begins on the orbit of a point at another value of the parameter, or beside
    /// it in a state, in units of the range of each state; why it does not go on. `None` where it cannot be looked at: beside
    /// its surface no motion slides.
    fn off_after_a_period(
        &self,
        point: &Vector,
        axis: Option<usize>,
        by: f64,
    ) -> Option<Result<PeriodEnd, Halt>> {
        let at = self.at(point).ok()?;
        let zone = self.longest(point)?;
        let setting = &self.setting;
        let units = &setting.scales.states;
        if axis.is_some() && at.mode(zone).surface.is_some() {
            return None;
        }
        let mut begin = at.middle(zone)?;
        let mut values = self.values_at(point);
        match axis {
            None => values[setting.parameter] += by * self.unit(),
            Some(axis) => begin.state[axis] += by * units[axis],
        }
        let system = setting.system.at(&values, &[setting.parameter]).ok()?;
        let period = at.period();
        let mut motion = Motion::new(&system, begin.clone(), period);
        let off = |motion: &Motion| {
            let extremes = self.extremes(point).ok()?;
            let states = begin.state.iter().zip(&motion.place().state);
            let offs = states.zip(&extremes).zip(units);
            let offs = offs.map(|(((one, other), (low, high)), unit)| {
                let range = high - low;
                // a state that does not move has its own unit
                let size = if range > NEAR * unit { range } else { *unit };
                (one - other).abs() / size
            });
            Some(offs.fold(0.0, f64::max))
        };
        let ended = |off, stays| Some(Ok(PeriodEnd { off, stays }));
        // how far it was off after a period without a switch
        let mut without_switch = None;
        let mut switched = self.sequence.zone(zone).way.is_none();
        for _ in 0..MOST_SWITCHES {
            let until = without_switch.map_or(period, |_| WITHOUT_SWITCH * period);
            match (motion.step(until), without_switch) {
                (Ok(Step::Section), _) => {}
                (Ok(Step::Reached), Some(off)) => return ended(off, Some(begin.mode)),
                (Ok(Step::Reached), None) if switched => return ended(off(&motion)?, None),
                (Ok(Step::Reached), None) => without_switch = Some(off(&motion)?),
                (_, Some(off)) => return ended(off, None),
                (Ok(Step::Switched(_)), None) => switched = true,
                (Err(halt), None) => {
                    // not of a motion that has not begun, nor of one beside what a mode holds at zero
                    let there = motion.place();
                    let tells =
                        there.time > begin.time && self.halts_at_zero(&system, there, &halt);
                    return tells.then_some(Err(halt));
                }
            }
        }
        None
    }

    /// Whether the guard where a motion does not go on is zero there, and not negative since it began: one that was moved off
    /// what a stick holds comes into the next mode beyond its guard.
    fn halts_at_zero(&self, system: &AffineSystem, place: &Moment, halt: &Halt) -> bool {
        /// In units of the guard: the least δ is a hundred times as large.
        const AT_ZERO: f64 = 1e-11;
        let Some((mode, guard)) = halt.place() else {
            return true;
        };
        let row = &system.modes[mode].guards[guard].row;
        let z = system.lift(mode, &place.state, place.phase);
        row.value(&z).abs() <= AT_ZERO * self.size(row)
    }
}

impl OrbitAt<'_> {
    /// The place in the middle of a zone.
    pub(super) fn middle(&self, zone: usize) -> Option<Moment> {
        let half = 0.5 * self.zones[zone].duration;
        let z = self.along(zone, std::iter::once(half)).ok()?.pop()?;
        Some(Moment {
            time: 0.0,
            phase: self.zones[zone].phase + self.posed.system.omega.value * half,
            mode: self.orbit.sequence.zone(zone).mode,
            state: z.rows(0, self.orbit.states()).iter().copied().collect(),
        })
    }
}
