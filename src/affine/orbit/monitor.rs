//! Monitors of an orbit: extremes, integrals and values at switches of expressions, with their derivatives in the unknowns.
//!
//! The expressions are laid out in a system of their own, see [`System::monitored`], whose flows are those of the orbit.
//! Extremes are found as those of the states are, by bounds over whole pieces.
//!
//! [`System::monitored`]: crate::affine::system::System::monitored

use std::collections::BTreeMap;
use std::sync::Arc;

use super::examine::{Part, after, parts, stationary};
use super::integral;
use super::layout::{AffineOrbit, OrbitAt};
use super::passage::{Integrated, Jet, Passage};
use super::posed::Posed;
use super::setting::OrbitFailure;
use super::signature::Zone;
use super::turning::Smooth;
use crate::affine::flow::{Expansion, ModeFlow};
use crate::affine::mode::{AffineMode, MatrixBy, Row};
use crate::affine::monitor::MonitorSource;
use crate::affine::series::Field;
use crate::affine::stiff::STIFF;
use crate::linalg::Vector;
use crate::orbit::Monitored;
use crate::orbit::monitor::MonitorValue;

/// An orbit with the system in which its monitors are laid out.
struct Observer<'a> {
    at: OrbitAt<'a>,
    /// Forms of the monitors, mode by mode.
    forms: BTreeMap<usize, Vec<Row>>,
    /// Zone with which the period begins.
    first: usize,
}

/// A place of an orbit at which an expression may be largest or least.
#[derive(Clone, Copy)]
struct ExtremePlace {
    zone: usize,
    instant: MonitorInstant,
    value: f64,
}

/// When in a zone.
#[derive(Clone, Copy)]
enum MonitorInstant {
    Entry,
    /// So long after the entry, where the expression is stationary.
    Within(f64),
    End,
}

/// Of which extremum a monitor is the value.
#[derive(Clone, Copy)]
enum Extreme {
    Largest,
    Least,
    /// The larger of the two in size.
    Size,
}

impl AffineOrbit {
    /// The values of all monitors at a point: none of those that have none there.
    pub fn monitors(&self, point: &Vector) -> Vec<Option<f64>> {
        let count = self.setting.system.monitors().len();
        if count == 0 {
            return Vec::new();
        }
        let Ok(observer) = self.observer(point) else {
            return vec![None; count];
        };
        let value = |number: usize| {
            let measured = observer.measured(number).ok()??;
            Some(measured.value).filter(|value| value.is_finite())
        };
        (0..count).map(value).collect()
    }

    fn observer(&self, point: &Vector) -> Result<Observer<'_>, OrbitFailure> {
        let bare = self.at(point)?;
        let values = self.values_at(point);
        let setting = &self.setting;
        let modes: Vec<usize> = self.sequence.0.iter().map(|zone| zone.mode).collect();
        let monitored = setting
            .system
            .monitored(&values, &setting.varying(), &modes);
        let monitored = monitored.map_err(OrbitFailure::System)?;
        let facts = bare.posed.facts.clone();
        let posed = Posed::new(monitored.system, facts, setting.scales.time, false);
        Ok(Observer {
            first: self.cycle(point)?.first,
            forms: monitored.forms,
            at: OrbitAt {
                posed: Arc::new(posed),
                ..bare
            },
        })
    }
}

impl Monitored for AffineOrbit {
    fn measured(
        &self,
        monitor: usize,
        point: &Vector,
    ) -> Result<Option<MonitorValue>, OrbitFailure> {
        self.observer(point)?.measured(monitor)
    }

    fn monitor_name(&self, monitor: usize) -> &str {
        let monitors = self.setting.system.monitors();
        monitors.get(monitor).map_or("", |one| &one.name)
    }
}

impl Observer<'_> {
    fn measured(&self, number: usize) -> Result<Option<MonitorValue>, OrbitFailure> {
        let orbit = self.at.orbit;
        Ok(match &orbit.setting.system.monitors()[number].source {
            MonitorSource::Max(_) => Some(self.extreme(number, Extreme::Largest)?),
            MonitorSource::Min(_) => Some(self.extreme(number, Extreme::Least)?),
            MonitorSource::Largest(_) => Some(self.extreme(number, Extreme::Size)?),
            MonitorSource::Integral(_) => Some(self.integral(number)?),
            MonitorSource::Mean(_) => {
                let integral = self.integral(number)?;
                let period = self.at.period();
                let mean = integral.value / period;
                let mut gradient = integral.gradient;
                gradient.iter_mut().for_each(|by| *by /= period);
                for zone in 0..self.at.zones.len() {
                    let duration = orbit.width() * zone + orbit.states();
                    gradient[duration] -= mean * orbit.setting.scales.time / period;
                }
                Some(MonitorValue {
                    value: mean,
                    gradient,
                })
            }
            MonitorSource::Before(name, _, place) => {
                let zone = self.switch(name, *place);
                let before = |zone: usize| {
                    let jet = self.at_end(number, zone, self.at.zones[zone].duration)?;
                    Ok(self.spread(zone, &jet))
                };
                zone.map(before).transpose()?
            }
            MonitorSource::After(name, _, place) => {
                let after = |zone: usize| {
                    let next = (zone + 1) % self.at.zones.len();
                    self.spread(next, &self.at_entry(number, next))
                };
                self.switch(name, *place).map(after)
            }
        })
    }

    /// The zone that a switch of this name ends, by its number among those of the period, which begins with one.
    fn switch(&self, name: &str, number: usize) -> Option<usize> {
        let sequence = &self.at.orbit.sequence;
        let count = sequence.len();
        let system = &self.at.orbit.setting.system;
        let is_named = |zone: &usize| {
            let modes = [*zone, zone + 1].map(|zone| sequence.zone(zone).mode);
            if let Some(changes) = system.contact_changes(name, modes) {
                return changes;
            }
            let exit = sequence.zone(*zone).way.and_then(|way| {
                let guard = self.at.mode(*zone).guards.get(way.guard)?;
                guard.exits.get(way.exit)
            });
            exit.is_some_and(|exit| exit.name.as_deref() == Some(name))
        };
        let ends = (0..count).map(|index| (self.first + index + count - 1) % count);
        ends.filter(is_named).nth(number.checked_sub(1)?)
    }

    fn row(&self, number: usize, zone: usize) -> &Row {
        &self.forms[&self.at.orbit.sequence.zone(zone).mode][number]
    }

    /// The mode of a zone in which a form is among what its flow is made of.
    fn field(&self, number: usize, zone: usize) -> Field {
        let AffineMode { matrix, field, .. } = self.at.mode(zone);
        let own = self.row(number, zone).clone();
        let watched = (std::iter::once(own), std::iter::empty());
        let program = &self.at.posed.system.program;
        let tolerance = self.at.orbit.setting.system.flow_tolerance();
        Field::new(program, matrix, watched, (tolerance, !field.is_exact))
    }

    /// A monitor of a jet of a zone.
    fn spread(&self, zone: usize, jet: &Jet) -> MonitorValue {
        let mut measured = MonitorValue {
            value: 0.0,
            gradient: vec![0.0; self.at.orbit.count()],
        };
        self.add(zone, jet, &mut measured);
        measured
    }

    fn add(&self, zone: usize, jet: &Jet, sum: &mut MonitorValue) {
        sum.value += jet.value;
        let mut add = |index: usize, by: f64| sum.gradient[index] += by;
        self.at.spread(zone, jet, 1.0, &mut add);
    }

    /// The form of a monitor at the entry of a zone.
    fn at_entry(&self, number: usize, zone: usize) -> Jet {
        let entry = self.at.entry(zone);
        let series = self.field(number, zone).series(&entry, SIDE, true, true);
        let (value, by_z, by) = series.jet(self.row(number, zone), 0);
        Jet {
            value,
            shot: 0,
            by_z,
            by_time: 0.0,
            by,
        }
    }

    /// The same a time after it.
    fn at_end(&self, number: usize, zone: usize, time: f64) -> Result<Jet, OrbitFailure> {
        Ok(self.of_passage(number, zone, &self.at.passage(zone, time)?))
    }

    fn of_passage(&self, number: usize, zone: usize, passage: &Passage) -> Jet {
        // just before its end: there an absolute value has the sign that it has had
        let field = self.field(number, zone);
        let series = field.series(&passage.end, SIDE, true, false);
        let (value, gradient, by) = series.jet(self.row(number, zone), 0);
        Jet {
            value,
            shot: passage.shot,
            by_time: gradient.dot(&passage.rate),
            by: passage.along(&gradient, by),
            by_z: passage.flow.tr_mul(&gradient),
        }
    }

    /// The integral of the form of a monitor over the period.
    fn integral(&self, number: usize) -> Result<MonitorValue, OrbitFailure> {
        let mut sum = MonitorValue {
            value: 0.0,
            gradient: vec![0.0; self.at.orbit.count()],
        };
        for zone in 0..self.at.zones.len() {
            for passage in self.at.shots_of(zone)? {
                let jet = self.integral_over(number, zone, &passage)?;
                self.add(zone, &jet.of_shot(passage.shot), &mut sum);
            }
        }
        Ok(sum)
    }

    /// The same over a shot.
    fn integral_over(
        &self,
        number: usize,
        zone: usize,
        passage: &Passage,
    ) -> Result<Jet, OrbitFailure> {
        let (mode, row) = (self.at.mode(zone), self.row(number, zone));
        let square = self.at.posed.system.program.quadratic(row);
        if let Some(form) = square.filter(|_| mode.field.is_exact) {
            return self.of_square(&form, zone, passage);
        }
        let mode = AffineMode {
            field: self.field(number, zone),
            ..mode.clone()
        };
        let known = Integrated::new(&mode, &passage.entry, passage.time);
        let size = passage.entry.len();
        Ok(Jet {
            by_time: self.of_passage(number, zone, passage).value,
            ..integral::of_series(&known, row, size, passage.time)
        })
    }

    /// The integral of zᵀQz over a zone of a linear mode.
    fn of_square(
        &self,
        form: &MatrixBy,
        zone: usize,
        passage: &Passage,
    ) -> Result<Jet, OrbitFailure> {
        let Zone { mode, name, .. } = self.at.orbit.sequence.zone(zone);
        let (entry, time) = (&passage.entry, passage.time);
        let norm = self.at.posed.balance(*mode).1;
        let linear = self.at.mode(zone);
        let jet = integral::of_square(linear, form, norm, entry, &passage.end, time);
        let flow = self.at.posed.flow(*mode);
        if norm * time <= STIFF || flow.split(time).is_none() {
            return Ok(jet);
        }
        let all = parts(flow, entry.clone(), time);
        let all = all.map_err(|count| OrbitFailure::long(name, time, count))?;
        let mut expansion = Expansion::default();
        let mut value = 0.0;
        for Part { piece, part, .. } in &all {
            flow.expand(piece, *part, form.at.nrows(), &mut expansion);
            value += integral::over_piece(&form.at, &expansion, part * piece.length);
        }
        Ok(Jet { value, ..jet })
    }

    /// The largest or least value of the form of a monitor.
    fn extreme(&self, number: usize, which: Extreme) -> Result<MonitorValue, OrbitFailure> {
        let [least, largest] = self.extrema(number)?;
        let (found, sign) = match which {
            Extreme::Largest => (largest, 1.0),
            Extreme::Least => (least, 1.0),
            Extreme::Size if -least.value > largest.value => (least, -1.0),
            Extreme::Size => (largest, 1.0),
        };
        let ExtremePlace { zone, instant, .. } = found;
        let jet = match instant {
            MonitorInstant::Entry => self.at_entry(number, zone),
            MonitorInstant::End => self.at_end(number, zone, self.at.zones[zone].duration)?,
            // its place is stationary
            MonitorInstant::Within(time) => Jet {
                by_time: 0.0,
                ..self.at_end(number, zone, time)?
            },
        };
        Ok(self.spread(zone, &jet.scaled(sign)))
    }

    /// Where the form of a monitor is least, and where it is largest.
    fn extrema(&self, number: usize) -> Result<[ExtremePlace; 2], OrbitFailure> {
        let mut found = Extrema::default();
        let flows = (0..self.at.zones.len()).map(|zone| self.flow(number, zone));
        let flows: Vec<(ModeFlow, Vec<Part>)> = flows.collect::<Result<_, _>>()?;
        for (zone, (_, parts)) in flows.iter().enumerate() {
            let row = &self.row(number, zone).at;
            found.take(
                zone,
                MonitorInstant::Entry,
                self.at_entry(number, zone).value,
            );
            let duration = self.at.zones[zone].duration;
            let end = self.at_end(number, zone, duration)?;
            found.take(zone, MonitorInstant::End, end.value);
            for part in parts.iter().skip(1) {
                let value = value(row, &part.piece.z);
                found.take(zone, MonitorInstant::Within(part.begun), value);
            }
        }
        let period = self.at.orbit.setting.scales.time;
        for (zone, (flow, parts)) in flows.iter().enumerate() {
            let row = &self.row(number, zone).at;
            let last = self.at.mode(zone).guards.len();
            let mut expansion = Expansion::default();
            for Part {
                piece, begun, part, ..
            } in parts
            {
                flow.expand(piece, *part, self.at.orbit.states(), &mut expansion);
                let (taylor, left_out) = flow.guard_of(last, (piece, *part), &expansion);
                let length = part * piece.length;
                let turns = Smooth::new(&taylor, left_out).turns(found.bounds());
                for near in turns.into_iter().map(|place| begun + place * length) {
                    let better = stationary(flow, row, parts, near, period);
                    // what leads elsewhere leads to no turn
                    let close = (better - near).abs() <= CLOSE * length;
                    let time = if close { better } else { near };
                    if let Some(z) = after(flow, parts, time) {
                        found.take(zone, MonitorInstant::Within(time), value(row, &z));
                    }
                }
            }
        }
        found.both().ok_or(OrbitFailure::NoZones)
    }

    /// The flow of a zone in which the form of a monitor is watched after all guards, and its parts.
    fn flow(&self, number: usize, zone: usize) -> Result<(ModeFlow, Vec<Part>), OrbitFailure> {
        let at = &self.at;
        let (name, mode) = (
            &at.orbit.sequence.zone(zone).name,
            at.orbit.sequence.zone(zone).mode,
        );
        let balance = || at.posed.balance(mode).clone();
        let longest = at.orbit.setting.scales.time;
        let mut flow = ModeFlow::balanced(&at.posed.system.modes[mode], longest, balance);
        flow.watch(self.row(number, zone).at.clone());
        let duration = at.zones[zone].duration;
        if duration.is_nan() || duration <= 0.0 {
            return Ok((flow, Vec::new()));
        }
        let all = parts(&flow, at.entry(zone), duration);
        match all {
            Ok(all) => Ok((flow, all)),
            Err(count) => Err(OrbitFailure::long(name, duration, count)),
        }
    }
}

/// Order of the series that tells on which side of its kink an absolute value is at a switch.
const SIDE: usize = 2;

/// Part of a piece by which Newton's method moves a turn that its polynomial has.
const CLOSE: f64 = 1e-3;

/// A row times z. Components that it does not have may have no value.
fn value(row: &Vector, z: &Vector) -> f64 {
    let terms = row.iter().zip(z).filter(|(c, _)| **c != 0.0);
    terms.map(|(c, z)| c * z).sum()
}

/// The least and the largest value so far.
#[derive(Default)]
struct Extrema {
    least: Option<ExtremePlace>,
    largest: Option<ExtremePlace>,
}

impl Extrema {
    fn take(&mut self, zone: usize, instant: MonitorInstant, value: f64) {
        let one = ExtremePlace {
            zone,
            instant,
            value,
        };
        if self.least.is_none_or(|least| value < least.value) {
            self.least = Some(one);
        }
        if self.largest.is_none_or(|largest| value > largest.value) {
            self.largest = Some(one);
        }
    }

    fn bounds(&self) -> (f64, f64) {
        let of = |one: Option<ExtremePlace>| one.map_or(f64::NAN, |one| one.value);
        (of(self.least), of(self.largest))
    }

    fn both(self) -> Option<[ExtremePlace; 2]> {
        Some([self.least?, self.largest?])
    }
}
