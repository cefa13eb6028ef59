//! The unknowns of an orbit: their order and their units.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, OnceLock};

use super::conserved::Conserved;
use super::forms::Units;
use super::memory::Memory;
use super::passage::{Jet, derivative};
use super::posed::Posed;
use super::setting::{OrbitFailure, Scales, Setting};
use super::signature::Sequence;
pub use super::signature::ZonePoint;
use super::structure::{ZoneFacts, facts, section};
use crate::affine::mode::{AffineMode, AffineSystem, Row};
use crate::affine::monitor::Monitor;
use crate::affine::origin::Origin;
use crate::continuation::Node;
use crate::linalg::Vector;

/// The last values of the parameters that are unknown, as bits, and the system there: one point is looked at several times.
type Last = Arc<Mutex<Option<((u64, Option<u64>), Arc<Posed>)>>>;

/// The boundary-value problem of one sequence of zones.
///
/// Unknowns: for every zone the states at its entry and its duration; with forcing the phase of the first entry, for a
/// prescribed period the parameter that is free; the parameter.
#[derive(Clone, Debug)]
pub struct AffineOrbit {
    /// What all orbits of the branch have in common.
    pub setting: Arc<Setting>,
    /// The zones; every mode, guard and exit is in the system.
    pub sequence: Sequence,
    /// How many shots there are before every zone, and in all.
    pub(super) firsts: Vec<usize>,
    /// Sizes of the components of z.
    sizes: Vector,
    last: Last,
    /// The first system whose facts were told by points. At a value that is tried where an event is sought they may be zero by chance,
    /// and do not last.
    first: Arc<OnceLock<Arc<Posed>>>,
    /// Passages through its zones that are known.
    pub(super) memory: Arc<Memory>,
    /// Sums of states that never change.
    pub(super) conserved: Arc<Conserved>,
    /// The system where the parameter is zero, if all of it is affine in that.
    origin: Arc<OnceLock<Option<Origin>>>,
}

impl PartialEq for AffineOrbit {
    fn eq(&self, other: &AffineOrbit) -> bool {
        let same = |one: &Arc<Setting>, other| Arc::ptr_eq(one, other) || one == other;
        self.sequence == other.sequence && same(&self.setting, &other.setting)
    }
}

/// Sizes of the components of z: those of states are given, cosines and sines have 1, and what is made of others
/// that which it has where all states are as large as their units.
fn sizes(system: &AffineSystem, states: &[f64]) -> Vector {
    let base = system.size() - system.program.made();
    let places = [1.0, -1.0].map(|sign| states.iter().map(|unit| sign * unit).collect());
    // of what is linear nothing is made
    let modes = if base == system.size() {
        0
    } else {
        system.modes.len()
    };
    let places: Vec<Vector> = (0..modes)
        .flat_map(|mode| {
            places.each_ref().map(|place: &Vec<f64>| {
                let mut z = system.lift(mode, place, 0.0);
                system.modes[mode].field.complete_at_switch(&mut z);
                z
            })
        })
        .collect();
    let made = |index: usize| {
        let sizes = places.iter().map(|z| z[index].abs());
        let largest = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    };
    Vector::from_fn(system.size(), |index, _| match states.get(index) {
        Some(unit) => *unit,
        None if index < base => 1.0,
        None => made(index),
    })
}

/// An orbit at a point.
#[derive(Clone, Debug)]
pub struct OrbitAt<'a> {
    /// The orbit.
    pub orbit: &'a AffineOrbit,
    /// The system there.
    pub posed: Arc<Posed>,
    /// Its zones.
    pub zones: Vec<ZonePoint>,
    /// Values of all parameters.
    pub(super) values: Vec<f64>,
}

impl AffineOrbit {
    /// The orbits of a sequence of zones; `None` where it is empty or the system does not have one of them at the
    /// values of `setting`.
    pub fn new(setting: Arc<Setting>, sequence: Sequence) -> Option<AffineOrbit> {
        let system = setting
            .system
            .at(&setting.values, &setting.varying())
            .ok()?;
        let states = system.states;
        let known = |zone: &super::signature::Zone| {
            let mode = system.modes.get(zone.mode)?;
            match zone.way {
                Some(way) => mode.guards.get(way.guard)?.exits.get(way.exit).map(|_| ()),
                None => (sequence.len() == 1).then_some(()),
            }
        };
        let known = sequence.0.iter().all(|zone| known(zone).is_some());
        let fits = !sequence.is_empty() && setting.scales.states.len() == states;
        (known && fits).then(|| {
            let orbit = AffineOrbit {
                sizes: sizes(&system, &setting.scales.states),
                last: Last::default(),
                first: Arc::default(),
                memory: Arc::default(),
                conserved: Arc::default(),
                origin: Arc::default(),
                firsts: sequence.shots_before(),
                sequence: sequence.labelled(&system),
                setting,
            };
            let conserved = Conserved::new(&system, &orbit.sequence, &orbit.units());
            AffineOrbit {
                conserved: Arc::new(conserved),
                ..orbit
            }
        })
    }

    /// The same orbits where sums of states that never change are those of these states.
    pub fn keeping(mut self, states: &[f64]) -> AffineOrbit {
        let kept = if self.conserved.count() > 0 {
            states
        } else {
            &[]
        };
        if !(kept.is_empty() && self.sequence.kept().is_empty()) {
            self.sequence = self.sequence.keeping(kept);
            self.first = Arc::default();
        }
        self
    }

    /// The same problem for another sequence.
    pub fn with_sequence(&self, sequence: Sequence) -> Option<AffineOrbit> {
        let other = AffineOrbit::new(self.setting.clone(), sequence)?;
        let origin = self.origin.clone();
        // most zones beside an event are those of the event
        Some(AffineOrbit { origin, ..other }.with_memory_of(self))
    }

    /// The same orbits with monitors.
    pub fn with_monitors(self, monitors: Vec<Monitor>) -> AffineOrbit {
        let setting = Setting {
            system: self.setting.system.clone().with_monitors(monitors),
            ..(*self.setting).clone()
        };
        AffineOrbit {
            setting: Arc::new(setting),
            ..self
        }
    }

    /// The same with the passages of other orbits of its zones.
    pub fn with_memory_of(self, other: &AffineOrbit) -> AffineOrbit {
        AffineOrbit {
            memory: other.memory.clone(),
            ..self
        }
    }

    /// Number of zones.
    pub fn zones(&self) -> usize {
        self.sequence.len()
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.setting.scales.states.len()
    }

    /// Whether there is a forcing.
    pub fn is_forced(&self) -> bool {
        self.setting.system.forcing.is_some()
    }

    /// Whether the period is neither that of a forcing nor prescribed.
    pub fn has_own_period(&self) -> bool {
        !self.is_forced() && self.setting.prescribed.is_none()
    }

    /// The state that is greatest where an orbit of this mode begins that neither switches nor is forced.
    pub(super) fn section(&self, mode: &AffineMode) -> usize {
        let known = self.sequence.zone(0).section();
        let known = known.or(self.setting.scales.section);
        known.unwrap_or_else(|| section(mode))
    }

    /// Unknowns of a zone.
    pub(super) fn width(&self) -> usize {
        self.states() + 1
    }

    /// Number of unknowns.
    pub(super) fn count(&self) -> usize {
        self.unknowns_of_zones() + usize::from(!self.has_own_period()) + 1
    }

    /// Index of the parameter that is free for a prescribed period.
    pub(super) fn free_index(&self) -> Option<usize> {
        let prescribed = self.setting.prescribed.is_some();
        prescribed.then_some(self.unknowns_of_zones())
    }

    /// Index of the phase of the first entry.
    pub(super) fn phase_index(&self) -> Option<usize> {
        self.is_forced().then_some(self.unknowns_of_zones())
    }

    /// Units in which forms are compared.
    pub(super) fn units(&self) -> Units<'_> {
        Units {
            z: &self.sizes,
            states: self.states(),
            parameters: [
                self.setting.scales.parameter,
                self.setting
                    .scales
                    .free
                    .unwrap_or(self.setting.scales.parameter),
            ],
            varying: 1 + usize::from(self.setting.varies_in_two()),
        }
    }

    /// Size of a form: the sum of its terms for states of their units.
    pub(super) fn size(&self, row: &Row) -> f64 {
        self.units().sum(row)
    }

    /// Value of the continuation parameter at a point.
    pub fn parameter_at(&self, point: &Vector) -> f64 {
        point[point.len() - 1] * self.setting.scales.parameter
    }

    /// Values of all parameters at a point.
    pub fn values_at(&self, point: &Vector) -> Vec<f64> {
        let mut values = self.setting.values_at(self.parameter_at(point));
        if let Some((index, parameter)) = self.free_index().zip(self.setting.free()) {
            values[parameter] = point[index] * self.setting.scales.free.unwrap_or(1.0);
        }
        values
    }

    /// The system at the parameters of a point.
    fn posed(&self, point: &Vector) -> Result<Arc<Posed>, OrbitFailure> {
        let value = self.parameter_at(point);
        let free = self.free_index().map(|index| point[index].to_bits());
        let bits = (value.to_bits(), free);
        let last = self.last.lock().ok().and_then(|mut last| last.take());
        let posed = match last {
            Some((known, posed)) if known == bits => posed,
            last => Arc::new(self.posed_at(point, value, last.map(|(_, posed)| posed))?),
        };
        if posed.facts.iter().any(|facts| facts.generic.is_some()) {
            self.first.get_or_init(|| posed.clone());
        }
        if let Ok(mut last) = self.last.lock() {
            *last = Some((bits, posed.clone()));
        }
        Ok(posed)
    }

    /// The same, where it has been posed at another value.
    fn posed_at(
        &self,
        point: &Vector,
        value: f64,
        last: Option<Arc<Posed>>,
    ) -> Result<Posed, OrbitFailure> {
        let setting = &self.setting;
        // what is led there has its derivatives in one parameter
        let of_origin = || match setting.varying().get(1) {
            None => setting.system.origin(&setting.values, setting.parameter),
            Some(_) => None,
        };
        let origin = self.origin.get_or_init(of_origin).as_ref();
        let facts = |system: &AffineSystem, known: Option<&[ZoneFacts]>| {
            let zones = self.unpack(point, system.omega.value);
            let of = (&self.sequence, &*self.conserved);
            facts(system, of, &self.units(), &zones, known)
        };
        let mut known = last;
        if let Some(origin) = origin {
            match known.take().map(Arc::try_unwrap) {
                Some(Ok(own)) => {
                    let changed = |system: &_, known: &_| facts(system, Some(known));
                    if let Some(posed) = own.moved_to(origin, value, changed) {
                        return Ok(posed);
                    }
                }
                Some(Err(shared)) => known = Some(shared),
                None => {}
            }
        }
        let moved = origin.and_then(|origin| origin.at(value));
        let is_moved = moved.is_some();
        let at = || {
            let values = self.values_at(point);
            setting.system.at(&values, &setting.varying())
        };
        let system = moved.map_or_else(at, Ok);
        let system = system.map_err(OrbitFailure::System)?;
        // where an expression has no value z may have other components
        if system.size() != self.sizes.len() {
            return Err(OrbitFailure::NoZones);
        }
        let known = self.first.get().cloned().or(known);
        let known = known.filter(|posed| posed.has_same_zeros(&system, &self.sequence));
        let lasting = known
            .as_ref()
            .and_then(|posed| posed.lasting_facts(&system, &self.sequence));
        let facts = lasting.unwrap_or_else(|| {
            let known = known.as_ref().map(|posed| posed.facts.as_slice());
            Arc::new(facts(&system, known))
        });
        Ok(Posed::new(system, facts, setting.scales.time, is_moved))
    }

    /// The orbit at a point.
    ///
    /// # Errors
    /// The system makes no sense there.
    pub fn at(&self, point: &Vector) -> Result<OrbitAt<'_>, OrbitFailure> {
        let posed = self.posed(point)?;
        Ok(OrbitAt {
            zones: self.unpack(point, posed.system.omega.value),
            values: self.values_at(point),
            orbit: self,
            posed,
        })
    }

    /// Scaled unknowns from physical ones, with values of all parameters: of the phases that of the first zone counts.
    pub fn pack(&self, zones: &[ZonePoint], values: &[f64]) -> Vector {
        let Scales {
            states,
            time,
            parameter: unit,
            free,
            ..
        } = &self.setting.scales;
        let mut point = Vec::with_capacity(self.count());
        for zone in zones {
            point.extend(zone.state.iter().zip(states).map(|(x, unit)| x / unit));
            point.push(zone.duration / time);
        }
        for (index, zone) in zones
            .iter()
            .enumerate()
            .filter(|(index, _)| self.shots(*index) > 1)
        {
            for state in self.inner_states(index, zone, values) {
                point.extend(state.iter().zip(states).map(|(x, unit)| x / unit));
            }
        }
        if self.is_forced() {
            point.push(zones[0].phase.rem_euclid(TAU));
        }
        if let Some(parameter) = self.setting.free() {
            point.push(values[parameter] / free.unwrap_or(1.0));
        }
        point.push(values[self.setting.parameter] / unit);
        Vector::from_vec(point)
    }

    /// The same orbit begun with another zone, of a sequence that is the own one from there on: zone k + `shift` becomes k.
    pub(super) fn rotated(&self, node: &Node, shift: usize) -> Option<Node> {
        if shift == 0 {
            return Some(node.clone());
        }
        let (width, count) = (self.width(), self.zones());
        let mut rotated = node.clone();
        for zone in 0..count {
            let (to, from) = (width * zone, width * ((zone + shift) % count));
            let of = |vector: &Vector| vector.rows(from, width).into_owned();
            rotated
                .point
                .rows_mut(to, width)
                .copy_from(&of(&node.point));
            let tangent = of(&node.tangent);
            rotated.tangent.rows_mut(to, width).copy_from(&tangent);
        }
        // those of further shots follow in the order of the zones
        let (entries, all) = (width * count, self.unknowns_of_zones());
        let first = (0..count - shift).map(|zone| self.states() * (self.shots(zone) - 1));
        let first: usize = first.sum();
        for vector in [&mut rotated.point, &mut rotated.tangent] {
            vector.as_mut_slice()[entries..all].rotate_right(first);
        }
        if let Some(index) = self.phase_index() {
            // φ + ω(p)·(durations before)
            let omega = self.at(&node.point).ok()?.posed.system.omega;
            let Scales {
                time, parameter, ..
            } = self.setting.scales;
            let before = |vector: &Vector| -> f64 {
                let durations = (0..shift).map(|zone| vector[width * zone + self.states()]);
                time * durations.sum::<f64>()
            };
            let last = node.tangent.len() - 1;
            let by_parameter = parameter * node.tangent[last] * omega.by[0];
            rotated.point[index] += omega.value * before(&node.point);
            rotated.tangent[index] +=
                omega.value * before(&node.tangent) + by_parameter * before(&node.point);
            rotated.tangent.normalize_mut();
        }
        Some(rotated)
    }

    /// The same node with the phase, up to whole turns, next to that of another one.
    pub(super) fn turned(&self, mut node: Node, near: &Node) -> Node {
        if let Some(index) = self.phase_index() {
            let apart = near.point[index] - node.point[index];
            node.point[index] += TAU * (apart / TAU).round();
        }
        node
    }

    fn unpack(&self, point: &Vector, omega: f64) -> Vec<ZonePoint> {
        let Scales { states, time, .. } = &self.setting.scales;
        let mut phase = self.phase_index().map_or(0.0, |index| point[index]);
        let zones = (0..self.zones()).map(|zone| {
            let first = self.width() * zone;
            let duration = point[first + states.len()] * time;
            let at = |first: usize| {
                let state = states.iter().enumerate();
                let state = state.map(|(index, unit)| point[first + index] * unit);
                state.collect()
            };
            let further = 1..self.shots(zone);
            let zone = ZonePoint {
                state: at(first),
                inner: further
                    .map(|shot| at(self.shot_index(zone, shot)))
                    .collect(),
                duration,
                phase,
            };
            phase += omega * duration;
            zone
        });
        zones.collect()
    }
}

impl OrbitAt<'_> {
    /// z at the entry of a zone.
    pub(super) fn entry(&self, zone: usize) -> Vector {
        self.shot_entry(zone, 0)
    }

    /// The derivative of this order in time of a form, at the entry of a zone.
    pub(super) fn at_entry(&self, zone: usize, row: &Row, order: usize) -> Jet {
        let mode = self.mode(zone);
        let entry = self.entry(zone);
        if mode.field.is_exact {
            return Jet::at_entry(&derivative(mode, row, order), &entry);
        }
        // the series at the entry is that of the passage through all of its first shot
        let time = self.share(zone).max(0.0);
        let passage = self.integrated(zone, entry, (time, false));
        let jets = passage.derivatives_at_entry(row, order, 1);
        jets.into_iter()
            .next()
            .unwrap_or_else(|| Jet::nothing(row.at.len()))
    }

    /// Adds the derivatives of a jet of a zone in the scaled unknowns, times a factor.
    pub(super) fn spread(
        &self,
        zone: usize,
        jet: &Jet,
        factor: f64,
        add: &mut impl FnMut(usize, f64),
    ) {
        let OrbitAt { orbit, posed, .. } = self;
        let zone = zone % self.zones.len();
        let Scales {
            states,
            time,
            parameter,
            free,
            ..
        } = &orbit.setting.scales;
        let n = states.len();
        let width = orbit.width();
        let first = orbit.shot_index(zone, jet.shot);
        for (state, unit) in states.iter().enumerate() {
            add(first + state, factor * unit * jet.by_z[state]);
        }
        // times within a shot are in proportion to the duration of the zone
        let shots = orbit.shots(zone) as f64;
        add(width * zone + n, factor * time * jet.by_time / shots);
        let begun_in_zone = jet.shot as f64 / shots;
        let [mut by_parameter, by_free] = jet.by;
        if let Some(index) = orbit.phase_index() {
            // cos hφ and sin hφ turn into each other
            let omega = posed.system.omega;
            let turned = omega.value * begun_in_zone * self.zones[zone].duration;
            let mut by_phase = 0.0;
            for h in 1..=posed.system.harmonics {
                let (cosine, sine) = (n + 2 * h - 1, n + 2 * h);
                let angle = h as f64 * (self.zones[zone].phase + turned);
                let turn = jet.by_z[sine] * angle.cos() - jet.by_z[cosine] * angle.sin();
                by_phase += h as f64 * turn;
            }
            // φ = φ₀ + ω·(durations before)
            for before in 0..zone {
                add(width * before + n, factor * time * by_phase * omega.value);
            }
            let of_zone = begun_in_zone * omega.value;
            add(width * zone + n, factor * time * by_phase * of_zone);
            add(index, factor * by_phase);
            let begun: f64 = self.zones[..zone].iter().map(|zone| zone.duration).sum();
            let begun = begun + begun_in_zone * self.zones[zone].duration;
            by_parameter += by_phase * omega.by[0] * begun;
        }
        if let Some(index) = orbit.free_index() {
            add(index, factor * free.unwrap_or(1.0) * by_free);
        }
        add(orbit.count() - 1, factor * parameter * by_parameter);
    }
}
