//! The equations of an orbit at an event: as many as unknowns, so that a regular zero is isolated.
//!
//! An orbit is a cycle of *stretches*: its zones, of which one is cut in two where a guard touches zero inside.
//! Unknowns are, for each stretch, y = (x, φ) at its entry, at its end and between its steps, and its
//! duration; and the parameter. Every step is a flow, y at an entry is what the switch makes of y at the end
//! before, less a turn for every period of the forcing where the cycle closes, and a stretch ends where its guard
//! is zero, or stationary where it is cut. One more equation singles out the event.

use serde::{Deserialize, Serialize};

use super::OpenOrbit;
use super::centre::Centre;
use super::critical::NullVector;
use super::enclosure::Enclosure;
use super::exact::NamePolynomial;
use super::flow::{IntervalExponential, IntervalFlow};
use super::modes::{IntervalModes, Structure};
use super::products::Needed;
use super::zeros::{Facts, InequalityEvent, VanishingForm};
use crate::affine::orbit::setting::Scales;
use crate::affine::orbit::{Margin, Sequence, Watch, ZonePoint};
use crate::affine::system::System;
use crate::interval::{Decimal, Interval, Number, PI};

/// What is asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PosedOrbit {
    /// The system as it is written; of the values of its parameters those below count. In a certificate it stands once, for all
    /// points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub system: Option<System>,
    /// Values of the parameters in order, as they are written.
    pub values: Vec<Decimal>,
    /// Index of the continuation parameter.
    pub parameter: usize,
    /// Periods of the forcing in an orbit.
    pub periods: u32,
    /// Units in which uniqueness is measured.
    pub units: Scales,
}

impl PosedOrbit {
    /// The system.
    ///
    /// # Errors
    /// There is none.
    pub fn system(&self) -> Result<&System, OpenOrbit> {
        self.system.as_ref().ok_or(OpenOrbit::Sequence)
    }
}

/// An orbit in doubles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NearOrbit {
    /// The zones.
    pub sequence: Sequence,
    /// States, phases and durations.
    pub zones: Vec<ZonePoint>,
    /// The continuation parameter.
    pub parameter: f64,
}

/// What singles out a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum OrbitCondition {
    /// The parameter has this value.
    Value(Decimal),
    /// The parameter is stationary.
    Fold,
    /// A multiplier is −1.
    Doubling,
    /// The orbit is its image around a centre half a period later, and the multiplier of its half is −1: a branch without this symmetry passes.
    Branching,
    /// A pair of multipliers is on the unit circle.
    Torus {
        /// Its angle in doubles.
        angle: f64,
    },
    /// A margin vanishes.
    Margin {
        /// What it measures.
        watch: Watch,
        /// Zone.
        zone: usize,
        /// Time after the entry at which a guard is least, for those inside; else 0.
        time: f64,
    },
}

impl OrbitCondition {
    /// What vanishes, and the zone of that.
    pub fn watched(&self) -> Option<(Watch, usize)> {
        match self {
            OrbitCondition::Margin { watch, zone, .. } => Some((*watch, *zone)),
            _ => None,
        }
    }

    /// Whether a null vector is among the unknowns.
    fn has_null_vector(&self) -> bool {
        matches!(
            self,
            OrbitCondition::Fold
                | OrbitCondition::Doubling
                | OrbitCondition::Branching
                | OrbitCondition::Torus { .. }
        )
    }

    /// A zone has no duration.
    pub fn closed(zone: usize) -> OrbitCondition {
        OrbitCondition::Margin {
            watch: Watch::Duration,
            zone,
            time: 0.0,
        }
    }
}

impl From<&Margin> for OrbitCondition {
    fn from(margin: &Margin) -> OrbitCondition {
        OrbitCondition::Margin {
            watch: margin.watch,
            zone: margin.zone,
            time: margin.time,
        }
    }
}

/// How a stretch ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentEnd {
    /// Its guard is zero, and this exit is taken.
    Exit { guard: usize, exit: usize },
    /// A guard is stationary.
    Touch { guard: usize },
    /// With the period.
    Never,
}

/// A zone, or a part of one.
#[derive(Clone, Copy, Debug)]
pub struct OrbitSegment {
    pub zone: usize,
    pub mode: usize,
    pub end: SegmentEnd,
}

/// How the equations of one sequence are written: those at two ends of an arc alike.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Steps of every stretch.
    pub steps: Vec<usize>,
    /// Stretches whose equation is divided by a power of their duration.
    pub divided: Vec<usize>,
    /// Values of the parameter that are led through.
    pub range: Option<Interval>,
}

impl Layout {
    /// What has all of two.
    pub fn joined(self, other: Layout) -> Layout {
        let steps = self.steps.into_iter().zip(other.steps);
        Layout {
            steps: steps.map(|(a, b)| a.max(b)).collect(),
            divided: [self.divided, other.divided].concat(),
            range: self.range.zip(other.range).map(|(a, b)| a.hull(b)),
        }
    }
}

/// The equations of a point.
pub struct OrbitSystem<'a> {
    pub posed: &'a PosedOrbit,
    pub system: &'a System,
    pub near: &'a NearOrbit,
    pub condition: &'a OrbitCondition,
    pub structure: Structure,
    pub exact: IntervalModes<NamePolynomial>,
    pub stretches: Vec<OrbitSegment>,
    /// Steps of every stretch.
    pub steps: Vec<usize>,
    /// What vanishes at the event: what its equation says, and what follows by symmetry.
    pub vanishing: Vec<VanishingForm>,
    /// Stretches that have no duration at the event: likewise.
    pub closed: Vec<usize>,
    /// Stretches whose equation is divided by a power of their duration.
    pub divided: Vec<(usize, usize)>,
    /// A value of the parameter in the place of the event.
    pub fixed: Option<Interval>,
    pub facts: Vec<Facts>,
    /// What is zero on the branch, apart from the event.
    pub lasting: Vec<Facts>,
    pub critical: Option<NullVector>,
    /// The centre, where the stretches are those of half a symmetric orbit, which closes at its image.
    pub half: Option<Centre>,
}

/// A zone that closes has no duration in doubles but for this share of the unit of time.
const ROUNDING: f64 = 1e-9;
/// A stretch in intervals.
pub struct Passing {
    pub flow: IntervalFlow,
    /// Duration of a step.
    pub time: Interval,
    /// A step, and 1/2ⁿ of it.
    pub whole: IntervalExponential,
    pub part: IntervalExponential,
    pub halvings: u32,
}

impl<'a> OrbitSystem<'a> {
    /// The equations, and their unknowns in doubles.
    pub fn new(
        posed: &'a PosedOrbit,
        near: &'a NearOrbit,
        condition: &'a OrbitCondition,
    ) -> Result<(OrbitSystem<'a>, Vec<f64>), OpenOrbit> {
        Self::laid_out(posed, near, condition, &Layout::default())
    }

    /// The equations with at least what a layout has, and their unknowns in doubles.
    pub fn laid_out(
        posed: &'a PosedOrbit,
        near: &'a NearOrbit,
        condition: &'a OrbitCondition,
        layout: &Layout,
    ) -> Result<(OrbitSystem<'a>, Vec<f64>), OpenOrbit> {
        let of = posed.system()?;
        let range = layout.range.unwrap_or(Interval::point(near.parameter));
        let near_to = (range, posed.units.parameter);
        let zones_of = near.sequence.0.iter();
        let needed = Needed::new(&posed.values, posed.parameter, near_to, zones_of);
        let (structure, exact) = Structure::of(of, &needed)?;
        if !fits(posed, near, of, exact.states) {
            return Err(OpenOrbit::Sequence);
        }
        let mut system = OrbitSystem {
            stretches: stretches(near, condition)?,
            posed,
            system: of,
            near,
            condition,
            structure,
            exact,
            steps: Vec::new(),
            vanishing: Vec::new(),
            closed: Vec::new(),
            divided: Vec::new(),
            fixed: None,
            facts: Vec::new(),
            lasting: Vec::new(),
            critical: None,
            half: None,
        };
        if !system.is_in_order() {
            return Err(OpenOrbit::Sequence);
        }
        if !system.is_forced() && system.stretches[0].end == SegmentEnd::Never {
            return Err(OpenOrbit::Centre);
        }
        let modes = system.enclosed(Interval::point(near.parameter))?;
        let short = system.without_duration(&layout.divided);
        system.divide(&short);
        system.facts = system.known(&[]);
        system.lasting = system.facts.clone();
        match system.event(near, &modes)? {
            Some(InequalityEvent::Zero(vanishing)) => system.vanish(vanishing),
            Some(InequalityEvent::Closed(stretch)) => system.close(stretch),
            None => {}
        }
        let mut guess = system.guess(near, &modes, condition, &layout.steps)?;
        if let Some(steps) = system.steps_of_both_halves() {
            guess = system.guess(near, &modes, condition, &steps)?;
        }
        if *condition == OrbitCondition::Branching {
            system.half = Some(system.centre().ok_or(OpenOrbit::Branching)?);
            let half = system.stretches.len() / 2;
            system.lasting.truncate(half);
            system.stretches.truncate(half);
            let steps = std::mem::take(&mut system.steps);
            guess = system.guess(near, &modes, condition, &steps)?;
        }
        if condition.has_null_vector() {
            let critical = system.direction(&guess).ok_or(OpenOrbit::NotEnclosed)?;
            guess.extend(critical.guess());
            system.critical = Some(critical);
        }
        Ok((system, guess))
    }

    /// Segments that last no longer than rounding, and those that are `divided`.
    fn without_duration(&self, divided: &[usize]) -> Vec<usize> {
        let lasts = |index: &usize| {
            let zone = &self.near.zones[self.stretches[*index].zone];
            zone.duration > ROUNDING * self.posed.units.time && !divided.contains(index)
        };
        let short = (0..self.stretches.len()).filter(|index| !lasts(index));
        short.collect()
    }

    /// How the equations are written.
    pub fn layout(&self) -> Layout {
        Layout {
            steps: self.steps.clone(),
            divided: self.divided.iter().map(|(index, _)| *index).collect(),
            range: Some(Interval::point(self.near.parameter)),
        }
    }

    /// Whether every stretch leads to the next.
    fn is_in_order(&self) -> bool {
        let count = self.stretches.len();
        (0..count).all(|index| {
            let OrbitSegment { mode, end, .. } = self.stretches[index];
            let next = self.stretches[(index + 1) % count].mode;
            let Some(known) = self.exact.modes.get(mode) else {
                return false;
            };
            match end {
                SegmentEnd::Exit { guard, exit } => {
                    let exit = known
                        .guards
                        .get(guard)
                        .and_then(|guard| guard.exits.get(exit));
                    exit.is_some_and(|exit| exit.to == next)
                }
                SegmentEnd::Touch { guard } => guard < known.guards.len() && next == mode,
                SegmentEnd::Never => next == mode && index + 1 == count,
            }
        })
    }

    /// The modes over an interval of the parameter.
    pub fn enclosed(&self, parameter: Interval) -> Result<IntervalModes<Enclosure>, OpenOrbit> {
        if !self.structure.covers(parameter) {
            return Err(OpenOrbit::Range);
        }
        let of = |index: usize| match index == self.posed.parameter {
            true => Enclosure::variable(parameter, 0),
            false => Enclosure::constant(self.posed.values[index].interval()),
        };
        let modes = self
            .structure
            .modes(self.system, &of, Enclosure::constant(PI))?;
        let forced = self.is_forced();
        match !forced || modes.omega.value.is_positive() {
            true => Ok(modes),
            false => Err(OpenOrbit::Numbers),
        }
    }

    /// The flows over intervals of the unknowns.
    pub fn passings(&self, modes: &IntervalModes<Enclosure>, x: &[Interval]) -> Vec<Passing> {
        (0..self.stretches.len())
            .map(|index| {
                let flow = IntervalFlow::new(&modes.modes[self.stretches[index].mode].matrix);
                let steps = Interval::point(self.steps[index] as f64);
                let time = x[self.duration(index)] / steps;
                let halvings = flow.parts(time);
                let part = flow.part(time, halvings);
                let whole = (0..halvings).fold(part.clone(), |part, _| part.doubled());
                Passing {
                    flow,
                    time,
                    whole,
                    part,
                    halvings,
                }
            })
            .collect()
    }

    pub fn is_forced(&self) -> bool {
        self.system.source.forcing.is_some()
    }

    /// States, and the phase where there is a forcing.
    pub fn width(&self) -> usize {
        self.exact.states + usize::from(self.is_forced())
    }

    fn first(&self, stretch: usize) -> usize {
        let steps = self.steps[..stretch].iter();
        steps.map(|steps| (steps + 1) * self.width() + 1).sum()
    }

    /// Where y at the beginning of a step stands; at the end of the stretch after the last.
    pub fn node(&self, stretch: usize, step: usize) -> usize {
        self.first(stretch) + step * self.width()
    }

    /// Where the duration of a stretch stands.
    pub fn duration(&self, stretch: usize) -> usize {
        self.node(stretch, self.steps[stretch] + 1)
    }

    /// Where the parameter stands: behind all else that an orbit needs.
    pub fn parameter(&self) -> usize {
        self.first(self.stretches.len())
    }

    /// The end of a stretch, or its entry.
    pub fn place(&self, stretch: usize, at_end: bool) -> usize {
        self.node(stretch, if at_end { self.steps[stretch] } else { 0 })
    }

    /// z from y.
    pub fn lift<N: Number>(&self, y: &[N]) -> Vec<N> {
        let mut z = y[..self.exact.states].to_vec();
        z.push(N::double(1.0));
        for h in 1..=self.exact.harmonics {
            let angle = y[self.exact.states].scaled(Interval::point(h as f64));
            let (cosine, sine) = angle.circular();
            z.extend([cosine, sine]);
        }
        z
    }

    /// ∂z/∂φ.
    pub fn turned<N: Number>(&self, z: &[N]) -> Vec<N> {
        let mut turned = vec![N::double(0.0); z.len()];
        for h in 1..=self.exact.harmonics {
            let (cosine, sine) = (self.exact.states + 2 * h - 1, self.exact.states + 2 * h);
            turned[cosine] = -z[sine].scaled(Interval::point(h as f64));
            turned[sine] = z[cosine].scaled(Interval::point(h as f64));
        }
        turned
    }

    /// Turns of the phase in a cycle, or in half of it.
    pub fn turns(&self) -> Interval {
        let halves = if self.half.is_some() { 1.0 } else { 2.0 };
        PI * Interval::point(halves * f64::from(self.posed.periods))
    }
}

/// Whether an orbit in doubles has as many numbers as its system and its sequence ask for, and units that are units.
fn fits(posed: &PosedOrbit, near: &NearOrbit, system: &System, states: usize) -> bool {
    let zones = &near.zones;
    let known = zones.iter().flat_map(|zone| {
        let rest = [zone.duration, zone.phase];
        zone.state.iter().copied().chain(rest)
    });
    let units = &posed.units;
    let positive = units.states.iter().chain([&units.time, &units.parameter]);
    !zones.is_empty()
        && zones.len() == near.sequence.len()
        && zones
            .iter()
            .all(|zone| zone.state.len() == states && zone.duration > -ROUNDING * units.time)
        && known.chain([near.parameter]).all(f64::is_finite)
        && posed.values.len() == system.source.parameters.0.len()
        && posed.parameter < posed.values.len()
        && units.states.len() == states
        && positive
            .into_iter()
            .all(|unit| unit.is_finite() && *unit > 0.0)
}

/// The zones of an orbit, one of them cut where the condition says so.
fn stretches(near: &NearOrbit, condition: &OrbitCondition) -> Result<Vec<OrbitSegment>, OpenOrbit> {
    let mut stretches = Vec::new();
    for (zone, at) in near.sequence.0.iter().enumerate() {
        let end = match at.way {
            Some(way) => SegmentEnd::Exit {
                guard: way.guard,
                exit: way.exit,
            },
            None if near.sequence.len() == 1 => SegmentEnd::Never,
            None => return Err(OpenOrbit::Sequence),
        };
        let mode = at.mode;
        if let OrbitCondition::Margin {
            watch: Watch::Inside(guard),
            zone: cut,
            time,
        } = condition
            && *cut == zone
        {
            if !(*time > 0.0 && *time < near.zones.get(zone).map_or(0.0, |at| at.duration)) {
                return Err(OpenOrbit::Sequence);
            }
            let end = SegmentEnd::Touch { guard: *guard };
            stretches.push(OrbitSegment { zone, mode, end });
        }
        stretches.push(OrbitSegment { zone, mode, end });
    }
    Ok(stretches)
}
