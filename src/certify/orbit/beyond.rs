//! The orbit of an event in another sequence of zones.
//!
//! At a change of the sequence the orbit is one of the sequence before and of that beyond: one zone more has no duration there,
//! or is cut where it touches a guard. It is proven in one of them; an arc that begins or ends there in the other takes it as the
//! zero of that one's equations, and has to know that both are one orbit.
//!
//! Cut open at the instant of the event, and without zones of no duration, both are cycles of the same *legs*. What is zero at
//! the ends of the legs of one, by formulas ([`super::facts`]), makes it a solution of the equations of the other; there it is where these
//! have one solution only.

use serde::{Deserialize, Serialize};

use super::carry::SmoothSpan;
use super::exact::NamePolynomial;
use super::modes::{Row, through};
use super::open::OrbitNotBeyond;
use super::system::{NearOrbit, OrbitCondition, OrbitSegment, OrbitSystem, SegmentEnd};
use super::zeros::{VanishingForm, less, unit, whole};
use super::{OpenOrbit, OrbitProof, VANISHES, near};
use crate::affine::orbit::candidates::candidates;
use crate::affine::orbit::{AffineOrbit, Margin, Sequence};
use crate::certify::arc::Moving;
use crate::certify::krawczyk;
use crate::interval::{Interval, Number, PI};
use crate::linalg::Vector;
use crate::orbit::{Examined, Zones};

/// An orbit in a sequence of zones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SequenceOrbit {
    /// What vanishes there.
    pub condition: OrbitCondition,
    /// The orbit in doubles.
    pub near: NearOrbit,
}

/// So many zones at most begin or end at one event: in both halves of a symmetric orbit.
const INSTANTS: usize = 2;

/// The orbit at the zero of a margin, in another sequence, with each of what vanishes there: formulas may tell all the rest from one
/// of it and not from another.
pub(super) fn seen(
    orbit: &AffineOrbit,
    point: &Vector,
    margin: &Margin,
    sequence: &Sequence,
) -> Vec<SequenceOrbit> {
    let mut open = vec![(orbit.clone(), point.clone(), margin.clone())];
    for _ in 0..INSTANTS {
        let mut next = Vec::new();
        for (orbit, point, margin) in open {
            for candidate in candidates(&orbit, &point, &margin).unwrap_or_default() {
                let (orbit, point) = (candidate.orbit, candidate.point);
                let zeros = zeros(&orbit, &point);
                if orbit.sequence == *sequence {
                    let nascent = candidate.nascent.iter();
                    let nascent = nascent.map(|zone| OrbitCondition::closed(*zone));
                    return nascent
                        .chain(zeros.iter().map(OrbitCondition::from))
                        .flat_map(|condition| seen_at(&orbit, &point, condition))
                        .collect();
                }
                let zeros = zeros.into_iter();
                next.extend(zeros.map(|zero| (orbit.clone(), point.clone(), zero)));
            }
        }
        open = next;
    }
    Vec::new()
}

/// The orbit at the zero of a margin, with that and with each of what vanishes there, too.
pub(super) fn seen_here(
    orbit: &AffineOrbit,
    point: &Vector,
    margin: &Margin,
) -> Vec<SequenceOrbit> {
    let zeros = zeros(orbit, point);
    let all = [margin].into_iter().chain(&zeros);
    all.flat_map(|zero| seen_at(orbit, point, zero.into()))
        .collect()
}

fn seen_at(
    orbit: &AffineOrbit,
    point: &Vector,
    condition: OrbitCondition,
) -> Option<SequenceOrbit> {
    let near = near(orbit, point).ok()?;
    Some(SequenceOrbit { condition, near })
}

/// The margins that may vanish at an event.
fn zeros(orbit: &AffineOrbit, point: &Vector) -> Vec<Margin> {
    let examination = orbit.examination(point);
    let margins = examination.as_ref().map_or(&[][..], Examined::margins);
    let zeros = margins.iter().filter(|one| one.value.abs() <= VANISHES);
    zeros.cloned().collect()
}

/// Proves that an orbit seen from another sequence is the one of an event, and that its inequalities hold; returns its stretches of no
/// duration.
///
/// # Errors
/// It is not proven.
pub(super) fn prove(
    proof: &OrbitProof,
    seen: &SequenceOrbit,
) -> Result<Vec<usize>, OrbitNotBeyond> {
    let (posed, open) = (&proof.posed, |reason: OpenOrbit| {
        OrbitNotBeyond::Open(reason)
    });
    let enclosed = |near, condition| {
        let (system, middle) = OrbitSystem::new(posed, near, condition).map_err(open)?;
        let equations = |x: &[Interval]| system.evaluate(x);
        let zero = krawczyk::enclosed(&equations, &middle, &system.units(&middle));
        let zero = zero.ok_or(OrbitNotBeyond::Open(OpenOrbit::NotIsolated))?.at;
        Ok::<_, OrbitNotBeyond>((system, middle, zero))
    };
    let (mut system, middle, zero) = enclosed(&seen.near, &seen.condition)?;
    let modes = system.enclosed(zero[system.parameter()]).map_err(open)?;
    let passings = system.passings(&modes, &zero);
    let still: Vec<Moving> = zero.iter().copied().map(Moving::constant).collect();
    let holds =
        |system: &OrbitSystem| system.inequalities(&modes, &passings, &still, &system.closed);
    if let Err(reason) = holds(&system) {
        let reason = open(reason.into());
        system.mirror(&middle, &zero).ok_or(reason)?;
        holds(&system).map_err(|reason| open(reason.into()))?;
    }
    let (mut event, guess, orbit) = enclosed(&proof.near, &proof.condition)?;
    let are_one = |event: &OrbitSystem| {
        are_one([
            (&system, &zero, event, &guess, &orbit),
            (event, &orbit, &system, &middle, &zero),
        ])
    };
    let mut found = are_one(&event);
    // a zone that has no duration at the event has none in the other half of a symmetric orbit
    if found.is_err() && !event.closed.is_empty() && event.mirror(&guess, &orbit).is_some() {
        found = are_one(&event);
    }
    found.map(|()| system.closed.clone())
}

/// The equations and the zero of one orbit, and those of another with their unknowns in doubles.
type Pair<'a> = (
    &'a OrbitSystem<'a>,
    &'a [Interval],
    &'a OrbitSystem<'a>,
    &'a [f64],
    &'a [Interval],
);

/// Proves that two orbits are one, by formulas that lead from either of them to the other.
fn are_one(both: [Pair; 2]) -> Result<(), OrbitNotBeyond> {
    let mut refused = OrbitNotBeyond::Laws;
    for (from, x, to, guess, other) in both {
        // at the event of a symmetric orbit it may be cut open at either of two instants
        for shift in 0..to.stretches.len() {
            let Some(carried) = from.solved(x, to, guess, shift) else {
                continue;
            };
            let pairs = carried.iter().zip(other);
            let hull: Vec<Interval> = pairs.map(|(a, b)| a.hull(*b)).collect();
            let equations = |x: &[Interval]| to.evaluate(x);
            if krawczyk::is_only_zero(&equations, guess, &hull) {
                return Ok(());
            }
            refused = OrbitNotBeyond::Another;
        }
    }
    Err(refused)
}

/// The stretches that have no duration at an event in the sequence in which that is proven.
pub(super) fn closed(proof: &OrbitProof) -> Option<Vec<usize>> {
    let (mut system, middle) =
        OrbitSystem::new(&proof.posed, &proof.near, &proof.condition).ok()?;
    if !system.closed.is_empty() {
        let equations = |x: &[Interval]| system.evaluate(x);
        let zero = krawczyk::enclosed(&equations, &middle, &system.units(&middle))?;
        system.mirror(&middle, &zero.at);
    }
    Some(system.closed)
}

impl OrbitSystem<'_> {
    /// The stretches that have a duration, from the instant of the event on; those that no switch lies between are together.
    fn legs(&self) -> Option<Vec<Vec<usize>>> {
        let count = self.stretches.len();
        let first = match (self.closed.first(), self.vanishing.first()) {
            (Some(closed), _) => closed + 1,
            (None, Some(event)) => event.stretch + usize::from(event.at_end),
            (None, None) => return None,
        };
        let mut legs: Vec<Vec<usize>> = Vec::new();
        let mut goes_on = false;
        for index in (first..first + count).map(|index| index % count) {
            if self.closed.contains(&index) {
                continue;
            }
            match legs.last_mut() {
                Some(leg) if goes_on => leg.push(index),
                _ => legs.push(vec![index]),
            }
            goes_on = !matches!(self.stretches[index].end, SegmentEnd::Exit { .. });
        }
        Some(legs)
    }

    /// The states at the entry of a stretch as forms at the end of one before it, between which are none but such without duration;
    /// and likewise what is zero where these end.
    fn led(
        &self,
        last: usize,
        next: usize,
    ) -> (Vec<Row<NamePolynomial>>, Vec<Row<NamePolynomial>>) {
        let (states, size) = (self.exact.states, self.exact.size());
        let mut led: Vec<_> = (0..states).map(|state| unit(state, size)).collect();
        let mut closing = Vec::new();
        let mut at = last;
        loop {
            let before = whole(&led, size);
            let OrbitSegment { mode, end, .. } = self.stretches[at];
            if let (SegmentEnd::Exit { guard, .. }, true) = (end, at != last) {
                let mode = &self.exact.modes[mode];
                let row = mode.derivative(&mode.guards[guard].row, self.divisor(at));
                closing.push(through(&row, &before));
            }
            if let Some(reset) = self.reset(at) {
                led = reset.iter().map(|row| through(row, &before)).collect();
            }
            at = (at + 1) % self.stretches.len();
            if at == next {
                return (led, closing);
            }
        }
    }

    /// Fills in the unknowns of stretches without duration: what switches make of the end of the stretch before.
    pub(super) fn bridge(&self, parts: &mut [Vec<Interval>], parameter: Interval) -> Option<()> {
        let modes = self.enclosed(parameter).ok()?;
        let count = parts.len();
        // as many in a row as there are stretches at most
        for index in (0..2 * count).map(|index| index % count) {
            let before = (index + count - 1) % count;
            if !parts[index].is_empty() || parts[before].is_empty() {
                continue;
            }
            let (width, from) = (self.width(), &parts[before]);
            let end = &from[from.len() - 1 - width..from.len() - 1];
            let mut entry = end.to_vec();
            let OrbitSegment { mode, end: way, .. } = self.stretches[before];
            if let SegmentEnd::Exit { guard, exit } = way {
                let z = self.lift(end);
                let reset = &modes
                    .modes
                    .get(mode)?
                    .guards
                    .get(guard)?
                    .exits
                    .get(exit)?
                    .reset;
                for (state, row) in entry.iter_mut().zip(reset) {
                    let terms = row.iter().zip(&z).map(|(form, z)| form.value * *z);
                    *state = terms.fold(Interval::ZERO, |sum, term| sum + term);
                }
            }
            let nodes = self.steps[index] + 1;
            parts[index] = entry.repeat(nodes);
            parts[index].push(Interval::ZERO);
        }
        parts.iter().all(|part| !part.is_empty()).then_some(())
    }

    /// This orbit in the unknowns of other equations that it solves by formulas; `None` if they do not tell.
    fn solved(
        &self,
        x: &[Interval],
        to: &OrbitSystem,
        middle: &[f64],
        shift: usize,
    ) -> Option<Vec<Interval>> {
        let (mut legs, theirs) = (self.legs()?, to.legs()?);
        let shift = shift % legs.len();
        legs.rotate_left(shift);
        // without a switch a leg has two stretches, between which the forcing begins anew
        let alike = |(own, other): (&Vec<usize>, &Vec<usize>)| {
            let of = to.stretches[other[0]];
            (other.len() == 1 || other.len() == 2 && of.end == SegmentEnd::Never)
                && self.stretches[own[0]].mode == of.mode
        };
        let states = self.exact.states;
        if legs.len() != theirs.len() || !legs.iter().zip(&theirs).all(alike) {
            return None;
        }
        self.solves(to, &legs, &theirs)?;
        let omega = self.enclosed(x[self.parameter()]).ok()?.omega.value;
        let turn = PI * Interval::point(2.0);
        // from the entry of a stretch to the next turn of the forcing
        let next_turn = |stretch: usize| {
            let phase = x[self.node(stretch, 0) + states];
            let turns = (phase.middle() / turn.middle()).floor() + 1.0;
            (turn * Interval::point(turns) - phase) / omega
        };
        let own = |index: usize| {
            let leg = theirs.iter().position(|leg| leg.contains(&index));
            let Some(leg) = leg else {
                return SmoothSpan::whole(Vec::new());
            };
            let mut span = SmoothSpan::whole(legs[leg].clone());
            if theirs[leg].len() > 1 {
                let turn = next_turn(legs[leg][0]);
                match index == theirs[leg][0] {
                    true => span.until = Some(turn),
                    false => span.from = turn,
                }
            }
            span
        };
        let mut carried = self.carried_by(x, to, &own)?;
        // phases count from elsewhere
        if self.is_forced() {
            for (stretch, steps) in to.steps.iter().enumerate() {
                for step in 0..=*steps {
                    let phase = to.node(stretch, step) + states;
                    let turns = (middle[phase] - carried[phase].middle()) / turn.middle();
                    carried[phase] = carried[phase] + turn * Interval::point(turns.round());
                }
            }
        }
        Some(carried)
    }

    /// Whether formulas say that this orbit solves every switch and every vanishing form of the other equations, leg by leg.
    fn solves(&self, to: &OrbitSystem, legs: &[Vec<usize>], theirs: &[Vec<usize>]) -> Option<()> {
        for (index, leg) in legs.iter().enumerate() {
            let (last, next) = (*leg.last()?, legs[(index + 1) % legs.len()][0]);
            let facts = &self.facts[last].end;
            let (led, _) = self.led(last, next);
            let (begins, there) = (theirs[index][0], *theirs[index].last()?);
            let (reset, closing) = to.led(there, theirs[(index + 1) % theirs.len()][0]);
            let OrbitSegment { mode, end, .. } = to.stretches[there];
            let mode = &self.exact.modes[mode];
            let ends = match end {
                SegmentEnd::Exit { guard, .. } => mode.guards[guard].row.clone(),
                SegmentEnd::Touch { guard } => mode.derivative(&mode.guards[guard].row, 1),
                SegmentEnd::Never => return None,
            };
            let mut pairs = reset.iter().zip(&led);
            let about = |one: &&VanishingForm| theirs[index].contains(&one.stretch);
            let mut vanishing = to.vanishing.iter().filter(about);
            let zero = |one: &VanishingForm| {
                let row = one.source.row(mode);
                let (place, facts) = match one.at_end {
                    true => (there, facts),
                    false => (begins, &self.facts[leg[0]].entry),
                };
                one.stretch == place && row.is_some_and(|row| facts.have(&row))
            };
            if !(facts.have(&ends)
                && closing.iter().all(|row| facts.have(row))
                && pairs.all(|(a, b)| facts.have(&less(a, b)))
                && vanishing.all(zero))
            {
                return None;
            }
        }
        Some(())
    }
}
