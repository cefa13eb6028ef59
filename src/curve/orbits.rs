//! Orbits of a user's system over a plane of two parameters.

use std::iter;
use std::sync::Arc;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::memo::Memo;
use super::plane::{
    EventCondition, EventCurves, NotEvaluated, PlaneNames, PlaneOfOrbits, SpectralEvents, Test,
    TestValues,
};
use super::point::{Gone, PointType, RegionName, What};
use super::watched::{passed, test_of_pair, tests_of_torus, without};
use crate::affine::closure::Prescribed;
use crate::affine::monitor::{Monitor, MonitorSource};
use crate::affine::monitored;
use crate::affine::orbit::monodromy::Monodromy;
use crate::affine::orbit::symmetry::Kept;
use crate::affine::orbit::{
    AffineOrbit, Examination, Margin, Multiplier, OrbitFailure, Scales, Sequence, Setting, Watch,
};
use crate::affine::system::{Ordered, System};
use crate::linalg::{Matrix, Vector};
use crate::orbit::EventType;

/// All that an orbit needs beside its sequence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitsInPlane {
    system: System,
    values: Vec<f64>,
    parameters: [usize; 2],
    widths: [f64; 2],
    periods: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    prescribed: Option<Prescribed>,
    scales: Scales,
    /// The monitor that keeps its value, by its name, where one does.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    monitor: Ordered<MonitorSource>,
    /// The image under which its orbits are their own along a curve of a margin or of a pair, where they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    symmetry: Option<Kept>,
    #[serde(skip)]
    memo: Memo,
}

/// An event of the multipliers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MultiplierEvent {
    /// One is −1.
    PeriodDoubling,
    /// A pair has the product 1.
    Torus,
    /// That of half a symmetric orbit is −1.
    Branching {
        /// The states that keep their sign in the image.
        kept: Kept,
    },
}

/// Why the multipliers do not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum NoMultipliers {
    /// They are infinite.
    #[error("the multipliers have no limit: a guard is met at zero speed")]
    Infinite,
}

impl OrbitsInPlane {
    /// Those of a solved orbit; `widths` are the units of the parameters.
    pub fn new(
        orbit: &AffineOrbit,
        point: &Vector,
        parameters: [usize; 2],
        widths: [f64; 2],
    ) -> OrbitsInPlane {
        let Setting {
            system,
            periods,
            prescribed,
            scales,
            ..
        } = (*orbit.setting).clone();
        let values = orbit.values_at(point);
        OrbitsInPlane {
            system: system.with_monitors(Vec::new()),
            values,
            parameters,
            widths,
            periods,
            prescribed,
            scales,
            monitor: Ordered::default(),
            symmetry: None,
            memo: Memo::default(),
        }
    }

    /// The same for orbits that are their own image.
    pub fn symmetric(self, kept: Kept) -> OrbitsInPlane {
        OrbitsInPlane {
            symmetry: Some(kept),
            ..self
        }
    }

    /// The image under which the orbits of an event are their own, where its equations are those of half an orbit.
    fn image(&self, condition: &EventCondition<OrbitsInPlane>) -> Option<Kept> {
        match condition {
            EventCondition::Spectral(MultiplierEvent::Branching { kept }) => Some(*kept),
            EventCondition::Margin(_) => self.symmetry,
            _ => None,
        }
    }

    /// The cosine of the angle of the pair of half an orbit that is its own image.
    fn half_cosine(&self, orbit: &AffineOrbit, point: &Vector) -> Option<f64> {
        let half = orbit.half_monodromy(self.symmetry?, point);
        half.ok().flatten()?.cosine()
    }

    /// The same with a monitor that keeps its value.
    pub fn keeping(self, monitor: &Monitor) -> OrbitsInPlane {
        OrbitsInPlane {
            monitor: Ordered(vec![(monitor.name.clone(), monitor.source.clone())]),
            ..self
        }
    }

    /// What is watched along a curve of grazes of an impact: there a multiplier is infinite, and what is left of the others in the
    /// product of the factors is rounding.
    fn watched_at_graze(
        &self,
        condition: &EventCondition<OrbitsInPlane>,
        orbit: &AffineOrbit,
        point: &Vector,
    ) -> TestValues {
        let test = |kind, value: Option<f64>| {
            passed(Some(PointType::One(kind)), value.unwrap_or(f64::NAN))
        };
        let mut tests = vec![test(EventType::PD, orbit.doubling_determinant(point))];
        if let Some(kept) = self.image(condition) {
            let lost = orbit.asymmetry_determinant(kept, point);
            tests.push(test(EventType::BP, lost));
        }
        TestValues {
            tests,
            outside: None,
        }
    }
}

/// The linearised motion over a period.
fn monodromy(orbit: &AffineOrbit, point: &Vector) -> Option<Monodromy> {
    orbit.monodromy(point).ok()?
}

/// How many multipliers are outside the unit circle, where they have a limit and so many are on it.
fn growing(orbit: &AffineOrbit, point: &Vector, on_circle: usize) -> Option<usize> {
    outside(&monodromy(orbit, point)?.multipliers(), on_circle)
}

/// The same of known ones.
fn outside(all: &[Multiplier], on_circle: usize) -> Option<usize> {
    let count = |is: fn(&Multiplier) -> bool| all.iter().filter(|one| is(one)).count();
    let told =
        all.iter().all(Multiplier::is_finite) && count(Multiplier::is_on_circle) == on_circle;
    told.then(|| count(Multiplier::is_outside))
}

impl PlaneOfOrbits for OrbitsInPlane {
    type Orbit = AffineOrbit;
    type Watch = Watch;

    fn parameters(&self) -> [String; 2] {
        let name = |index| self.system.source.parameters.names().nth(index);
        self.parameters
            .map(|index| name(index).unwrap_or_default().to_owned())
    }

    fn widths(&self) -> [f64; 2] {
        self.widths
    }

    fn values(&self) -> [f64; 2] {
        self.parameters.map(|index| self.values[index])
    }

    /// Where a parameter is positive the system may make sense for positive ones only.
    fn admits(&self, index: usize, value: f64) -> bool {
        self.values()[index] * value > 0.0
    }

    fn unknowns(&self, sequence: &Sequence) -> usize {
        let closed = self.system.source.forcing.is_some() || self.prescribed.is_some();
        let (zones, states) = (sequence.len(), self.scales.states.len());
        (states + 1) * zones + states * sequence.further_shots() + usize::from(closed)
    }

    fn zones(sequence: &Sequence) -> usize {
        sequence.len()
    }

    fn orbit(
        &self,
        sequence: &Sequence,
        values: [f64; 2],
        index: usize,
    ) -> Result<AffineOrbit, OrbitFailure> {
        let pose = || {
            let mut all = self.values.clone();
            for (parameter, value) in self.parameters.into_iter().zip(values) {
                all[parameter] = value;
            }
            let setting = Setting {
                system: monitored::keeping(&self.system, &self.monitor),
                values: all,
                parameter: self.parameters[index],
                second: Some(self.parameters[1 - index]),
                periods: self.periods,
                prescribed: self.prescribed.clone(),
                // what is asked of the multipliers is asked for below
                stability: false,
                scales: Scales {
                    parameter: self.widths[index],
                    ..self.scales.clone()
                },
            };
            AffineOrbit::new(Arc::new(setting), sequence.clone())
        };
        let orbit = self.memo.orbit(sequence, values, index, pose);
        orbit.ok_or(OrbitFailure::NoZones)
    }

    /// As along a branch: steps are relative to the size of orbits that have grown.
    fn stretch(unknowns: &[f64]) -> f64 {
        unknowns.iter().fold(1.0, |most: f64, x| most.max(x.abs()))
    }

    fn length(orbit: &AffineOrbit, point: &Vector, zone: usize) -> f64 {
        let at = orbit.at(point).ok();
        at.map_or(f64::NAN, |at| at.zones[zone].duration)
    }

    fn key(margin: &Margin) -> (Watch, usize) {
        (margin.watch, margin.zone)
    }
}

impl SpectralEvents for OrbitsInPlane {
    type Spectral = MultiplierEvent;
    type NotLinearised = NoMultipliers;
    const HAS_SECTORS: bool = false;

    fn spectral(
        &self,
        spectral: &MultiplierEvent,
        orbit: &AffineOrbit,
        point: &Vector,
        _: &[f64],
    ) -> Result<Vec<f64>, NotEvaluated<OrbitsInPlane>> {
        let monodromy = match spectral {
            MultiplierEvent::Branching { kept } => orbit.half_monodromy(*kept, point),
            _ => orbit.monodromy(point),
        };
        let monodromy = monodromy.map_err(NotEvaluated::Flow)?;
        let infinite = NotEvaluated::Linear(NoMultipliers::Infinite);
        let monodromy = monodromy.ok_or(infinite)?;
        let [doubling, _, torus] = monodromy.tests(&monodromy.multipliers());
        Ok(vec![match spectral {
            MultiplierEvent::PeriodDoubling | MultiplierEvent::Branching { .. } => doubling,
            MultiplierEvent::Torus => torus,
        }])
    }

    /// ∂∏(1 − μᵢμⱼ), where one factor is zero, is that of this factor times all others. Only without switches are its
    /// multipliers those of the equations beside an orbit, too: elsewhere Newton's method would not converge quadratically.
    fn critical(
        &self,
        spectral: &MultiplierEvent,
        orbit: &AffineOrbit,
        point: &Vector,
    ) -> Option<Vec<(Complex<f64>, Complex<f64>)>> {
        match spectral {
            MultiplierEvent::Torus if orbit.sequence.zone(0).way.is_none() => {
                monodromy(orbit, point)?.slopes_of_pair()
            }
            _ => None,
        }
    }

    fn is_doubling(spectral: &MultiplierEvent) -> bool {
        *spectral == MultiplierEvent::PeriodDoubling
    }

    fn closing(orbit: &AffineOrbit, point: &Vector) -> Result<Matrix, OrbitFailure> {
        orbit.closing(point)
    }

    fn lost(
        &self,
        spectral: &MultiplierEvent,
        orbit: &AffineOrbit,
        point: &Vector,
        _: &[f64],
    ) -> Option<Gone> {
        let is_branching = matches!(spectral, MultiplierEvent::Branching { .. });
        (is_branching && !orbit.loses_symmetry(point)).then_some(Gone::Asymmetric)
    }

    fn angular(
        &self,
        spectral: &MultiplierEvent,
        orbit: &AffineOrbit,
        point: &Vector,
        _: &[f64],
    ) -> Option<f64> {
        match spectral {
            MultiplierEvent::PeriodDoubling | MultiplierEvent::Branching { .. } => None,
            MultiplierEvent::Torus => monodromy(orbit, point)?.angle_on_circle(),
        }
    }
}

impl EventCurves for OrbitsInPlane {
    const FOLLOWED: &'static [EventType] = &[
        EventType::LP,
        EventType::PD,
        EventType::NS,
        EventType::BP,
        EventType::GR,
        EventType::CO,
        EventType::SL,
    ];
    const CLOSES: bool = true;

    /// Where a symmetric orbit meets an event its image meets it, too, and all equations of both halves are singular.
    fn restrict(
        &self,
        condition: &EventCondition<OrbitsInPlane>,
        orbit: &AffineOrbit,
        point: &Vector,
        (residual, matrix): (&mut [f64], &mut Matrix),
    ) -> Result<(), OrbitFailure> {
        let image = self.image(condition);
        image.map_or(Ok(()), |kept| {
            orbit.close_at_image(kept, point, residual, matrix)
        })
    }

    /// A multiplier −1 beside the event, a pair with the product 1, and of a pair that is followed the cosine of its
    /// angle: it passes ±1 where the pair meets, and beyond that the multipliers are real.
    fn watched(
        &self,
        condition: &EventCondition<OrbitsInPlane>,
        orbit: &AffineOrbit,
        point: &Vector,
        _: &[f64],
    ) -> TestValues {
        if let EventCondition::Margin(margin) = condition
            && orbit.grazes_impact(point, margin)
        {
            return self.watched_at_graze(condition, orbit, point);
        }
        let Some(monodromy) = monodromy(orbit, point) else {
            return TestValues::default();
        };
        let multipliers = monodromy.multipliers();
        // at the end of a curve on a graze one of them is infinite, and the sign of the speed that is divided out is rounding
        if !multipliers.iter().all(Multiplier::is_known) {
            return TestValues::default();
        }
        let [doubling, _, torus] = monodromy.tests(&multipliers);
        let on_circle = match condition {
            EventCondition::Margin(_) | EventCondition::Constant(_) => 0,
            EventCondition::Spectral(MultiplierEvent::Torus) => 2,
            EventCondition::Fold | EventCondition::Spectral(_) => 1,
        };
        let cosine = monodromy.cosine().unwrap_or(f64::NAN);
        let doubling = passed(Some(PointType::One(EventType::PD)), doubling);
        let turns = monodromy.angle_on_circle().is_some();
        let pair = |order: u8, both: f64| test_of_pair((cosine, turns), (order, both), torus);
        // the multiplier of the event is a double one where the derivative of its own equations in the multiplier vanishes;
        // another pair with the product 1 is an event of its own
        let double = |order: u8, multiplier: f64| match orbit.is_double(point, multiplier) {
            None => vec![pair(order, multiplier)],
            Some(met) => {
                let other = without(pair(order, f64::NAN), met);
                vec![passed(Some(PointType::Resonance(order)), met), other]
            }
        };
        let of_half = |kept: Kept, test: usize| {
            let half = orbit.half_monodromy(kept, point).ok().flatten();
            half.map_or(f64::NAN, |half| half.tests(&half.multipliers())[test])
        };
        let tests = match condition {
            EventCondition::Spectral(MultiplierEvent::Torus) => {
                tests_of_torus((cosine, self.half_cosine(orbit, point)), doubling)
            }
            EventCondition::Spectral(MultiplierEvent::PeriodDoubling) => double(2, -1.0),
            EventCondition::Fold => iter::once(doubling).chain(double(1, 1.0)).collect(),
            // a multiplier −1 of the whole is a pair ±i of the half, which touches and does not cross
            EventCondition::Spectral(MultiplierEvent::Branching { kept }) => {
                vec![passed(pair(1, 1.0).kind, of_half(*kept, 2))]
            }
            EventCondition::Margin(_) | EventCondition::Constant(_) => {
                let mut tests = vec![doubling, pair(1, f64::NAN)];
                let lost = self.image(condition).map(|kept| of_half(kept, 0));
                let lost = lost.map(|lost| passed(Some(PointType::One(EventType::BP)), lost));
                tests.extend(lost);
                tests
            }
        };
        TestValues {
            tests,
            outside: outside(&multipliers, on_circle),
        }
    }

    fn onsets((orbit, point): &(AffineOrbit, Vector), own: &[(Watch, usize)]) -> Vec<Test> {
        let lasts = |zone: usize| !own.contains(&(Watch::Duration, zone));
        let onsets = own.iter().filter_map(|(watch, zone)| match watch {
            Watch::Onset(guard) if lasts(*zone) => Some((*guard, *zone)),
            _ => None,
        });
        let tests = onsets.filter_map(|(guard, zone)| {
            Some(Test {
                kind: Some(PointType::One(EventType::GR)),
                value: orbit.onset_rate(point, guard, zone)?,
                ends: true,
            })
        });
        tests.collect()
    }

    fn extent(
        _: &EventCondition<OrbitsInPlane>,
        orbit: &AffineOrbit,
        point: &Vector,
        most: f64,
    ) -> Option<f64> {
        let shrinks = orbit.has_own_period();
        shrinks.then(|| orbit.extent_within(point, most)).flatten()
    }

    fn turns(examination: &Examination, before: &Examination) -> bool {
        examination.rate.dot(&before.rate) < 0.0
    }

    /// An equilibrium with a pair on the imaginary axis, and on the guard where the orbits graze it; an orbit that switches
    /// shrinks to a boundary equilibrium.
    fn at_limit(
        event: EventType,
        condition: &EventCondition<OrbitsInPlane>,
        orbit: &AffineOrbit,
        point: &Vector,
    ) -> PointType {
        let is_smooth = orbit.sequence.switches() == 0 || orbit.is_smooth_near(point);
        match condition {
            _ if !is_smooth => PointType::Two(event, EventType::BE),
            EventCondition::Margin(_) => PointType::Two(EventType::HB, EventType::BE),
            EventCondition::Fold => PointType::GH,
            _ => PointType::Two(event, EventType::HB),
        }
    }
}

impl PlaneNames for OrbitsInPlane {
    type NoBranch = crate::hybrid::NoFirstPoint;
    type Beside = ();
    const ORBIT: &'static str = "orbit";
    const ORBITS: &'static str = "orbits";
    const ALL_STEPS: usize = 1800;
    const LONGEST_BESIDE: f64 = f64::INFINITY;
    const MEASURE: Option<&'static str> = Some("period");
    const ANGULAR: &'static str = "angle";
    const SYMBOL: &'static str = "angle";

    fn zone(sequence: &Sequence, zone: usize) -> String {
        format!("`{}`", sequence.zone(zone).name)
    }

    fn guards_of_duration(orbit: &AffineOrbit, margin: &Margin) -> Option<[String; 2]> {
        orbit.guards_of_duration(margin)
    }

    fn name(orbit: &AffineOrbit, point: &Vector) -> String {
        let cycle = orbit.cycle(point);
        cycle.map_or_else(
            |_| orbit.sequence.to_string(),
            |cycle| cycle.names.join("-"),
        )
    }

    fn passing(orbit: &AffineOrbit, point: &Vector) -> String {
        let name = OrbitsInPlane::name(orbit, point);
        match growing(orbit, point, 0) {
            None => name,
            Some(0) => format!("stable {name}"),
            Some(_) => format!("unstable {name}"),
        }
    }

    fn measure(orbit: &AffineOrbit, point: &Vector) -> (f64, Option<f64>) {
        let cycle = orbit.cycle(point);
        (cycle.map_or(f64::NAN, |cycle| cycle.period), None)
    }

    /// The parameter that is free for a prescribed period.
    fn columns(&self) -> Vec<String> {
        let name = |one: &Prescribed| self.system.source.parameters.names().nth(one.free());
        let free = self.prescribed.iter().filter_map(name);
        free.map(str::to_owned).collect()
    }

    fn numbers(
        &self,
        _: &EventCondition<OrbitsInPlane>,
        orbit: &AffineOrbit,
        point: &Vector,
        _: &[f64],
    ) -> Vec<Option<f64>> {
        let value = |one: &Prescribed| Some(orbit.values_at(point)[one.free()]);
        self.prescribed.iter().map(value).collect()
    }

    /// At a BP two branches pass, and equations do not tell which is followed.
    fn beside(&self, spectral: &MultiplierEvent, _: Option<f64>) -> Option<()> {
        (!matches!(spectral, MultiplierEvent::Branching { .. })).then_some(())
    }

    fn name_beside(
        (): &mut (),
        orbit: &AffineOrbit,
        point: &Vector,
        _: Option<EventType>,
    ) -> Option<Option<RegionName>> {
        Some(growing(orbit, point, 0).map(RegionName::Outside))
    }

    fn say(what: &What<AffineOrbit>) -> String {
        what.to_string()
    }
}
