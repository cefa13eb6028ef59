//! The inequalities of an orbit, over whole zones.
//!
//! A guard is a power series from either end of a piece of a stretch. Over half a piece from a known zero of order m
//! it is tᵐg(t), and g > 0 is proven by subdivision; elsewhere m = 0.

use super::enclosure::Enclosure;
use super::flow::{GuardCoefficients, IntervalExponential, Rows, dot, moving, product};
use super::modes::{IntervalModes, Row};
use super::open::UnprovenOrbit;
use super::system::{OrbitSegment, OrbitSystem, Passing, SegmentEnd};
use super::zeros::{FormSource, VanishingForm, less};
use crate::certify::arc::Moving;
use crate::certify::flow::Positive;
use crate::certify::inequality::bisect;
use crate::interval::{Interval, Number};

fn values(row: &Row<Enclosure>) -> Vec<Interval> {
    row.iter().map(|entry| entry.value).collect()
}

/// A form along a curve, on which the parameter has this derivative.
fn along(row: &Row<Enclosure>, rate: Interval) -> Vec<Moving> {
    let entries = row.iter();
    entries
        .map(|entry| moving(entry.value, entry.by[0] * rate))
        .collect()
}

/// A matrix times z.
fn applied<N: Number>(rows: &[Vec<N>], z: &[N]) -> Vec<N> {
    rows.iter().map(|row| dot(row, z)).collect()
}

/// Whether a form is positive within a stretch, with zeros of these orders at its entry and its end.
fn is_positive(
    passing: &Passing,
    row: &GuardCoefficients,
    pieces: &[Vec<Moving>],
    [at_start, at_end]: [usize; 2],
) -> bool {
    let parts = Interval::point(f64::from(passing.halvings).exp2());
    let length = (passing.time / parts).high;
    let last = pieces.len() - 2;
    let half = |z: &[Moving], order: usize, sign: f64, time: f64| {
        let polynomial = passing.flow.polynomial(row, z, time);
        let odd = sign < 0.0 && order % 2 == 1;
        bisect(Moving::double(time), sign, |time| {
            let value = polynomial.over(time, order);
            if odd { -value } else { value }
        })
    };
    pieces.windows(2).enumerate().all(|(index, ends)| {
        let start = if index == 0 { at_start } else { 0 };
        let end = if index == last { at_end } else { 0 };
        // the end of a stretch may move along a curve: times are counted from it
        if index != last && start == 0 {
            return half(&ends[0], 0, 1.0, length);
        }
        // a little more than half, which rounding must not leave out
        let middle = (Interval::point(length) * Interval::point(0.5))
            .high
            .next_up();
        half(&ends[0], start, 1.0, middle) && half(&ends[1], end, -1.0, middle)
    })
}

/// What is to grow is followed over half a piece of a zone, which its length must not exceed where it is shortest.
const LENGTHENS: f64 = 1.9;

/// A stretch of no length is followed over this time: far above where products of times and numbers underflow.
const NO_TIME: f64 = 1e-100;

/// Whether a form is positive within a stretch that may have no length, with a zero of this order at its entry, or at its end.
fn is_positive_beside(
    passing: &Passing,
    row: &GuardCoefficients,
    pieces: &[Vec<Moving>],
    (at_entry, order): (bool, usize),
    duration: Interval,
) -> bool {
    let place = if at_entry {
        pieces.first()
    } else {
        pieces.last()
    };
    let place = place.map_or(&[][..], |z| z);
    let still: Vec<Moving> = place.iter().map(|z| Moving::constant(z.value)).collect();
    let length = duration.high.max(NO_TIME);
    let polynomial = passing.flow.polynomial(row, &still, length);
    let value = |time: Interval| polynomial.over(time, order).value;
    let side = if at_entry { 1.0 } else { -1.0 };
    let odd = !at_entry && order % 2 == 1;
    bisect(Interval::point(length), side, |time| match odd {
        false => value(time),
        true => -value(time),
    })
}

impl OrbitSystem<'_> {
    /// Proves the inequalities of the orbit over intervals of its unknowns, but for what vanishes at the event;
    /// returns how many there are. Along a curve what is not positive may grow from where it is not negative; stretches that are
    /// `closed` there have nothing to grow from but their duration.
    pub fn inequalities(
        &self,
        modes: &IntervalModes<Enclosure>,
        passings: &[Passing],
        x: &[Moving],
        closed: &[usize],
    ) -> Result<usize, UnprovenOrbit> {
        let rate = x[self.parameter()].by[0];
        let mut proven = 0;
        let mut hold = |holds: bool, otherwise: UnprovenOrbit| {
            proven += usize::from(holds);
            if holds { Ok(()) } else { Err(otherwise) }
        };
        for (index, passing) in passings.iter().enumerate() {
            let OrbitSegment { zone, mode, end } = self.stretches[index];
            let known = &self.exact.modes[mode];
            let (facts, lasting) = (&self.facts[index], &self.lasting[index]);
            let duration = x[self.duration(index)];
            let at_event = self.closed.contains(&index);
            hold(
                at_event || duration.is_positive(),
                UnprovenOrbit::Duration(zone),
            )?;
            let mut pieces = self.pieces(passing, index, x);
            // a time that is in the zone all along the piece is so at its beginning
            if duration.value.low * LENGTHENS < duration.value.high {
                let all = pieces.iter_mut().flatten();
                all.for_each(|z| *z = Moving::constant(z.value));
            }
            let matrix = passing.flow.moving(rate);
            for (guard, formula) in known.guards.iter().enumerate() {
                let Some(at_start) = facts.entry.order(&formula.row, known) else {
                    // in a zone of no duration it may be so at the event only
                    let opens = self.closed.contains(&index)
                        && lasting.entry.order(&formula.row, known).is_some();
                    hold(opens, UnprovenOrbit::Zero(zone, guard))?;
                    continue;
                };
                let at_end = facts.end.order(&formula.row, known).unwrap_or(0);
                let mut row = along(&modes.modes[mode].guards[guard].row, rate);
                let closes = closed.contains(&index);
                let ends = matches!(end, SegmentEnd::Exit { guard: own, .. } if own == guard);
                let divisor = match ends && closes {
                    true => self.divisor(index),
                    false => 0,
                };
                // what is zero at the entry of every such stretch grows from there
                let begins = lasting.entry.order(&formula.row, known);
                let at_entry = !ends && begins.is_some_and(|order| order > 0);
                if divisor > 0 {
                    // zero at the end, and less the later over the power of time that it has as a factor from the entry on
                    let falls = (0..=divisor).fold(vec![row], |row, _| product(&row, &matrix));
                    row = falls[0].iter().map(|entry| -*entry).collect();
                }
                let row = passing.flow.along(&matrix, &row);
                let positive = match closes {
                    true => {
                        let order = match at_entry {
                            true => at_start,
                            false if divisor > 0 => 0,
                            false => at_end,
                        };
                        let zero = (at_entry, order);
                        is_positive_beside(passing, &row, &pieces, zero, duration.value)
                    }
                    false => is_positive(passing, &row, &pieces, [at_start, at_end]),
                };
                hold(positive, UnprovenOrbit::Guard(zone, guard))?;
            }
            let SegmentEnd::Exit { guard, exit } = end else {
                continue;
            };
            let z = self.lift(&x[self.place(index, true)..][..self.width()]);
            let exits = &modes.modes[mode].guards[guard].exits;
            let at = |exit: usize, condition: usize| {
                dot(&along(&exits[exit].conditions[condition], rate), &z)
            };
            let zero = |exit: usize, condition: usize| {
                facts
                    .end
                    .have(&known.guards[guard].exits[exit].conditions[condition])
            };
            // of several guards that are zero at once none is the first
            for (other, formula) in known.guards.iter().enumerate() {
                if other == guard || !lasting.end.have(&formula.row) {
                    continue;
                }
                let taken = &known.guards[guard].exits[exit];
                let others = &modes.modes[mode].guards[other].exits;
                let agree = formula.exits.iter().zip(others).all(|(known, other)| {
                    let mut conditions = other.conditions.iter();
                    let fails = |row| (-dot(&along(row, rate), &z).value).is_positive();
                    let mut resets = known.reset.iter().zip(&taken.reset);
                    conditions.any(fails)
                        || known.to == taken.to && resets.all(|(a, b)| facts.end.have(&less(a, b)))
                });
                hold(agree, UnprovenOrbit::Together(zone, other))?;
            }
            for condition in 0..exits[exit].conditions.len() {
                if !zero(exit, condition) {
                    let holds = at(exit, condition).is_positive();
                    hold(holds, UnprovenOrbit::Condition(zone, condition))?;
                }
            }
            for (before, other) in exits.iter().enumerate().take(exit) {
                let about = |one: &VanishingForm| {
                    let earlier =
                        matches!(one.source, FormSource::Condition { exit, .. } if exit == before);
                    one.stretch == index && one.at_end && earlier
                };
                let conditions = 0..other.conditions.len();
                // where a zone of no duration begins or ends, what is zero at the event may open another
                let next = (index + 1) % self.stretches.len();
                let opens = [index, next].iter().any(|one| self.closed.contains(one))
                    && conditions.clone().any(|condition| {
                        let row = &known.guards[guard].exits[before].conditions[condition];
                        zero(before, condition) && !lasting.end.have(row)
                    });
                if opens || self.vanishing.iter().any(about) {
                    continue;
                }
                let failing: Vec<Moving> = conditions
                    .filter(|condition| !zero(before, *condition))
                    .map(|condition| -at(before, condition))
                    .collect();
                let fails = match &failing[..] {
                    [only] => only.is_positive(),
                    // which of several fails at an end of a curve, and so may grow from there, is not known
                    several => several.iter().any(|one| one.value.is_positive()),
                };
                hold(fails, UnprovenOrbit::Before(zone, before))?;
            }
        }
        Ok(proven)
    }

    /// z at the ends of the pieces of a stretch, from its entry to its end.
    fn pieces(&self, passing: &Passing, index: usize, x: &[Moving]) -> Vec<Vec<Moving>> {
        let at = |step: usize| self.lift(&x[self.node(index, step)..][..self.width()]);
        let parts = 1_usize << passing.halvings;
        let share = Interval::ONE / Interval::point((parts * self.steps[index]) as f64);
        let time = x[self.duration(index)].by[0] * share;
        let rate = x[self.parameter()].by[0];
        let IntervalExponential { at: whole, by } = &passing.part;
        let moved = product(&passing.flow.matrix, whole);
        let part: Vec<Vec<Moving>> = (0..whole.len())
            .map(|i| {
                let entry = |j: usize| moving(whole[i][j], by[i][j] * rate + moved[i][j] * time);
                (0..whole.len()).map(entry).collect()
            })
            .collect();
        let mut pieces = vec![at(0)];
        for step in 0..self.steps[index] {
            let mut z = at(step);
            for _ in 1..parts {
                z = applied(&part, &z);
                pieces.push(z.clone());
            }
            pieces.push(at(step + 1));
        }
        pieces
    }

    /// The linearised return to the first entry, at equal time with a forcing: y there a period later.
    pub fn monodromy(
        &self,
        modes: &IntervalModes<Enclosure>,
        passings: &[Passing],
        x: &[Interval],
    ) -> Option<Rows> {
        let (states, width) = (modes.states, self.width());
        let mut monodromy = super::flow::identity(width);
        for (index, passing) in passings.iter().enumerate() {
            let OrbitSegment { mode, end, .. } = self.stretches[index];
            for step in 0..self.steps[index] {
                let z = self.lift(&x[self.node(index, step)..][..width]);
                monodromy = product(&self.linear(&passing.whole.at[..states], &z), &monodromy);
            }
            let z = self.lift(&x[self.place(index, true)..][..width]);
            let SegmentEnd::Exit { guard, exit } = end else {
                continue;
            };
            let guard = &modes.modes[mode].guards[guard];
            let of = |row: &Row<Enclosure>| self.linear(&[values(row)], &z);
            let normal = of(&guard.row).remove(0);
            let mut rate = applied(&passing.flow.matrix[..states], &z);
            if self.is_forced() {
                rate.push(modes.omega.value);
            }
            let fall = dot(&normal, &rate);
            if fall.contains(0.0) {
                return None;
            }
            // perturbations on the guard: I − ẏgᵀ/ġ
            let onto: Rows = (0..width)
                .map(|i| {
                    let shift = rate[i] / fall;
                    let unit = |j: usize| Interval::point(f64::from(u8::from(i == j)));
                    (0..width).map(|j| unit(j) - shift * normal[j]).collect()
                })
                .collect();
            let reset: Vec<Vec<Interval>> = guard.exits[exit].reset.iter().map(values).collect();
            let jump = self.linear(&reset, &z);
            monodromy = product(&product(&jump, &onto), &monodromy);
        }
        if let Some(OrbitSegment {
            end: SegmentEnd::Never,
            ..
        }) = self.stretches.last()
        {
            // the phase and the period are fixed
            monodromy.truncate(states);
            for row in &mut monodromy {
                row.truncate(states);
            }
        }
        Some(monodromy)
    }

    /// Forms as derivatives in y: the phase comes last, and stays.
    fn linear(&self, forms: &[Vec<Interval>], z: &[Interval]) -> Rows {
        let states = self.exact.states;
        let turned = self.turned(z);
        let mut rows: Rows = forms
            .iter()
            .map(|form| {
                let mut row = form[..states].to_vec();
                if self.is_forced() {
                    row.push(dot(form, &turned));
                }
                row
            })
            .collect();
        if self.is_forced() && forms.len() == states {
            let mut last = vec![Interval::ZERO; states];
            last.push(Interval::ONE);
            rows.push(last);
        }
        rows
    }
}
