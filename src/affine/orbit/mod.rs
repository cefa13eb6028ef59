//! Periodic orbits of a hybrid system as orbits that the engine follows.
//!
//! [`signature`] is the sequence of zones, [`setting`] what the orbits of a branch have in common, [`layout`] the unknowns of one,
//! `posed` its system at one value of the parameter, [`residual`] the equations, `section` the beginning of an orbit that has none by
//! itself; [`passage`] is the exact flow through a zone with its derivatives, `shots` what
//! it is divided into where a motion grows by much, and [`structure`] knows what is zero at its ends
//! whatever the parameter, as [`forms`] tell, or [`generic`] points, and `conserved` which sums never change. [`margin`] measures the
//! inequalities, [`examine`] decides them, by what [`turning`] tells of smooth functions; [`candidates`] finds what lies beyond an
//! event, [`ends`] why nothing does, which is a `stop`, by the motions beside it as [`discontinuity`] has them, `family` where others of
//! a family go on, and `bounds` where friction makes no sense; [`multipliers`] has the stability, [`monodromy`] what tells where it changes,
//! `multiplier` each number of it, with the `saltation` of every switch and what `surface` tells of sliding;
//! [`start`] finds the first orbit, or says by [`behaviour`] what a motion looks like that comes to none, [`switch`] that of the other
//! branch at an event, [`hopf`] that at which orbits shrink to nothing, [`homoclinic`] that at which they `stay` for ever. [`row`] has
//! what results keep of one, `monitor` the numbers of it that a problem asks for, those of them that are integrals by `integral`;
//! `bifurcation` names the changes of a sequence by sliding.

pub mod behaviour;
mod beside;
mod bifurcation;
mod bounds;
pub mod candidates;
mod conserved;
mod critical;
mod discontinuity;
mod ends;
pub mod examine;
mod family;
mod forms;
mod generic;
mod held;
mod homoclinic;
mod hopf;
mod integral;
pub mod layout;
pub mod margin;
mod memory;
mod monitor;
pub mod monodromy;
pub mod multiplier;
pub mod multipliers;
pub(in crate::affine) mod passage;
mod posed;
mod residual;
pub mod row;
pub(super) mod saltation;
mod section;
pub mod setting;
mod shots;
pub mod signature;
pub mod start;
mod stay;
mod stop;
mod structure;
mod surface;
pub mod switch;
pub mod symmetry;
mod turning;

use std::sync::Arc;

use crate::affine::system::DEFAULT_FLOW_TOLERANCE;
use crate::continuation::Node;
use crate::continuation::branch_point::branch_point;
use crate::continuation::locate::Place;
use crate::continuation::newton;
use crate::continuation::walk::Segment;
use crate::linalg::{Matrix, Vector};
use crate::orbit::monitor::MonitorValue;
use crate::orbit::{
    Candidate, Crossed, EndWithin, EventType, Examined, Limit, Orbit, WITHOUT_LENGTH,
};

pub use bifurcation::SlidingBifurcation;
pub use critical::Critical;
pub use examine::Examination;
pub use held::{Held, Inadmissible};
pub use layout::{AffineOrbit, ZonePoint};
pub use margin::{Margin, Watch};
pub use multiplier::Multiplier;
pub use setting::{OrbitFailure, Scales, Setting};
pub use signature::{Sequence, Way, Zone};
pub use stop::OrbitStop;

/// A zone shorter than this, in units of the period, is about to close.
const CLOSING: f64 = 1e-6;

/// Where no step succeeds any more an orbit of this size, in units of its states, is one that shrinks to a point.
const NEARLY_A_POINT: f64 = 1e-6;

impl Orbit for AffineOrbit {
    type Signature = Sequence;
    type Parameter = String;
    type Margin = Margin;
    type Examination = Examination;
    type Held = Held;
    type Inadmissible = Inadmissible;
    type Special = Critical;
    type Remark = Critical;
    type Stop = OrbitStop;

    fn signature(&self) -> &Sequence {
        &self.sequence
    }

    fn posed(&self, signature: Sequence) -> Option<AffineOrbit> {
        self.with_sequence(signature)
    }

    fn is_rotation(&self, signature: &Sequence) -> bool {
        signature.is_rotation_of(&self.sequence)
    }

    fn parameter(&self) -> String {
        let names = self.setting.system.source.parameters.names();
        let mut names = names.skip(self.setting.parameter);
        names.next().unwrap_or_default().to_owned()
    }

    fn column(parameter: &String) -> &str {
        parameter
    }

    fn duration_index(&self, zone: usize) -> usize {
        self.width() * zone + self.states()
    }

    fn unit(&self) -> f64 {
        self.setting.scales.parameter
    }

    fn examination(&self, point: &Vector) -> Result<Examination, OrbitFailure> {
        self.at(point)?.examine()
    }

    fn margin_at(&self, seen: &Margin, point: &Vector) -> Result<Margin, OrbitFailure> {
        self.at(point)?.again(seen)
    }

    fn value(margin: &Margin) -> f64 {
        margin.value
    }

    fn add_gradient(&self, margin: &Margin, gradient: &mut [f64]) {
        for (index, by) in &margin.gradient {
            gradient[*index] += by;
        }
    }

    fn slope(&self, margin: &Margin, direction: &Vector) -> f64 {
        let terms = margin.gradient.iter();
        terms.map(|(index, by)| by * direction[*index]).sum()
    }

    fn is_same(one: &Margin, other: &Margin) -> bool {
        (one.watch, one.zone) == (other.watch, other.zone)
    }

    /// A zone without length says most, then a switch without speed: where an orbit that is traversed several
    /// times grazes, every traversal touches, and the one that has touched before goes first. With the speed of a switch that
    /// of the next entry may vanish, the slip after a reset that turns it.
    fn precedence(margin: &Margin) -> usize {
        match margin.watch {
            Watch::Duration => WITHOUT_LENGTH,
            Watch::Speed => WITHOUT_LENGTH + 1,
            Watch::Onset(_) => WITHOUT_LENGTH + 2,
            _ => WITHOUT_LENGTH + 3,
        }
    }

    fn is_alike(&self, margin: &Margin, other: &AffineOrbit, of_other: &Margin) -> bool {
        self.held(margin) == other.held(of_other)
    }

    fn held(&self, margin: &Margin) -> Held {
        let zone = self.sequence.zone(margin.zone);
        let guard = match margin.watch {
            Watch::Onset(guard) | Watch::Inside(guard) | Watch::End(guard) => Some(guard),
            _ => zone.way.map(|way| way.guard),
        };
        let name = |guard| self.setting.system.guard_name(zone.mode, guard);
        Held {
            mode: zone.name.clone(),
            guard: guard.map_or_else(String::new, name),
            watch: margin.watch,
        }
    }

    fn inadmissible(&self, examination: &Examination) -> Inadmissible {
        let margins = examination.margins().iter();
        let worst = margins.min_by(|one, other| one.value.total_cmp(&other.value));
        match worst.filter(|margin| margin.value <= 0.0) {
            Some(margin) => Inadmissible::Margin {
                held: self.held(margin),
                value: margin.value,
                zone: margin.zone,
                time: margin.time,
            },
            None => Inadmissible::Undecided,
        }
    }

    fn candidates(
        &self,
        point: &Vector,
        margin: &Margin,
    ) -> Result<Vec<Candidate<AffineOrbit>>, OrbitFailure> {
        if self.lasts_no_time(point) {
            return Ok(Vec::new());
        }
        candidates::candidates(self, point, margin)
    }

    /// The same from either side: a zone that is split by a touch from inside merges on the way back.
    fn classify(before: &Sequence, after: Option<&Sequence>, margin: &Margin) -> EventType {
        if matches!(margin.watch, Watch::Inside(_) | Watch::Speed) {
            return EventType::GR;
        }
        match after {
            Some(after) if before.is_split_in(after) || after.is_split_in(before) => EventType::GR,
            Some(after) if before.leads_elsewhere(after) => EventType::SL,
            Some(_) => EventType::CO,
            None => match margin.watch {
                Watch::Condition(_) | Watch::Before(_) => EventType::SL,
                _ => EventType::CO,
            },
        }
    }

    fn opens(&self, point: &Vector) -> bool {
        (0..self.zones()).any(|zone| point[self.duration_index(zone)] == 0.0)
    }

    fn closes(&self, point: &Vector) -> bool {
        (0..self.zones()).any(|zone| point[self.duration_index(zone)].abs() <= CLOSING)
    }

    fn grazes(margin: &Margin) -> bool {
        margin.watch == Watch::Speed
    }

    /// The units are those of the first orbit, beside which another may be a thousand times as large: steps are then
    /// relative to its size.
    fn stretch(&self, point: &Vector) -> f64 {
        point.rows(0, self.width() * self.zones()).amax().max(1.0)
    }

    /// The phase of the first entry counts up to a turn, and a sequence may begin with another zone: one that repeats itself
    /// with each part, one that changes have led back to with any.
    fn aliases(&self, signature: &Sequence, node: &Node, near: &Node) -> Vec<Node> {
        let rotations = signature.rotations_to(&self.sequence).into_iter();
        let rotated = |shift: usize| {
            let count = self.zones();
            let shots = (0..count).map(|zone| self.shots((zone + count - shift) % count));
            let shots: Vec<usize> = shots.collect();
            let is_own = (0..count).all(|zone| signature.zone(zone).shots() == shots[zone])
                && signature.zone(0).section() == self.sequence.zone(0).section();
            if is_own {
                return self.rotated(node, shift);
            }
            let own = self.with_sequence(signature.clone())?;
            let mut node = match count {
                1 => own.carried_to(self, node)?,
                _ => own.carried_to(&own.in_shots(&shots)?, node)?,
            };
            node.tangent.normalize_mut();
            self.rotated(&node, shift)
        };
        let aliases = rotations.filter_map(rotated);
        aliases.map(|node| self.turned(node, near)).collect()
    }

    fn rounding(&self, matrix: &Matrix, point: &Vector, last: f64) -> Option<f64> {
        let parameter = point.len() - 1;
        // the phase has the rounding of a turn
        let mut sizes = point.abs();
        if let Some(index) = self.phase_index() {
            sizes[index] = sizes[index].max(1.0);
        }
        let mut noise = newton::noise(self, matrix, point);
        let left_out = self.left_out(point);
        if left_out > 0.0 {
            let noise = noise.get_or_insert_with(|| Vector::zeros(matrix.nrows()));
            noise.add_scalar_mut(left_out);
        }
        if let Some(noise) = &mut noise {
            noise[parameter] = last;
        }
        Some(newton::rounding(matrix, &sizes, noise.as_ref())?[parameter])
    }

    fn left_out(&self, point: &Vector) -> f64 {
        let tolerance = self.setting.system.flow_tolerance();
        if tolerance <= DEFAULT_FLOW_TOLERANCE {
            return 0.0;
        }
        let exact = self.at(point).is_ok_and(|at| {
            let mut zones = 0..self.zones();
            zones.all(|zone| at.mode(zone).field.is_exact)
        });
        if exact { 0.0 } else { tolerance }
    }

    fn beside(&self, point: &Vector, side: f64) -> Option<Candidate<AffineOrbit>> {
        AffineOrbit::beside(self, point, side)
    }

    fn ends_at(&self, point: &Vector, margin: &Margin) -> Option<OrbitStop> {
        if self.lasts_no_time(point) {
            return Some(OrbitStop::Slides);
        }
        let vanishes = usize::from(margin.watch == Watch::Duration);
        let last =
            self.zones() - vanishes == 1 && matches!(margin.watch, Watch::Duration | Watch::Speed);
        let remains = margin.zone + vanishes;
        let is_centre = last && self.has_own_period() && self.turns_by_itself(point, remains);
        let centre = is_centre.then(|| OrbitStop::Centre {
            zone: Zone {
                way: None,
                ..self.sequence.zone(remains).clone()
            },
        });
        // the guard is positive before: it touches zero, and what follows without the switch is no orbit nearby
        let misses = || {
            let none = candidates::candidates(self, point, margin).is_ok_and(|all| all.is_empty());
            let held = self.held(margin);
            match margin.watch {
                Watch::Speed if none => Some(OrbitStop::Misses { held }),
                Watch::Duration if none => Some(OrbitStop::Jumps { held }),
                _ => None,
            }
        };
        let accumulates = || self.accumulates(point);
        let barely = || {
            let vanishing = Some(margin).filter(|margin| margin.watch == Watch::Duration)?;
            self.barely_reaches(point, vanishing.zone)
        };
        centre
            .or_else(accumulates)
            .or_else(barely)
            .or_else(misses)
            .or_else(|| self.held_at(point, margin))
            .or_else(|| self.others_remain(point, margin))
            .or_else(|| self.jumps(point))
    }

    fn instant(&self, point: &Vector, margin: &Margin) -> f64 {
        let duration = |zone: usize| point[self.duration_index(zone % self.zones())];
        let period: f64 = (0..self.zones()).map(duration).sum();
        let begun: f64 = (0..margin.zone).map(duration).sum();
        let within = match margin.watch {
            Watch::Duration | Watch::Onset(_) => 0.0,
            Watch::Inside(_) => margin.time / self.setting.scales.time,
            Watch::End(_) | Watch::Speed | Watch::Condition(_) | Watch::Before(_) => {
                duration(margin.zone)
            }
        };
        (begun + within) / period
    }

    fn renewed(
        &self,
        point: &Vector,
        examination: &Examination,
        creeps: bool,
    ) -> Option<AffineOrbit> {
        let parted = self.in_shots_for_growth(point, &examination.growths, creeps);
        parted.or_else(|| self.in_sharper_section(point, examination))
    }

    fn carried(&self, renewed: &AffineOrbit, node: &Node) -> Option<Node> {
        self.carried_to(renewed, node)
    }

    fn tangent_of_zones(&self, node: &Node) -> Vector {
        AffineOrbit::tangent_of_zones(self, node)
    }

    fn gives_out(&self, node: &Node) -> Option<OrbitStop> {
        self.nearly_ends(node)
    }

    fn part(&self, point: &Vector) -> Option<(AffineOrbit, Vector)> {
        self.half(point)
    }

    fn whole(&self, part: &AffineOrbit, point: &Vector) -> Option<Vector> {
        let mut zones = part.at(point).ok()?.zones;
        row::twice(&self.sequence, &mut zones);
        Some(self.pack(&zones, &part.values_at(point)))
    }

    fn exhausted(&self, node: &Node, _: (f64, f64)) -> Option<OrbitStop> {
        self.ends(node).or_else(|| self.negative_bound(&node.point))
    }

    fn short_of(&self, stop: &OrbitStop, node: &Node) -> f64 {
        self.to_limit(stop, node)
    }

    fn limit(&self, stop: &OrbitStop, node: &Node) -> Option<Limit<Critical>> {
        self.limit_of(stop, node)
    }

    fn left(stop: &OrbitStop) -> Option<Sequence> {
        match stop {
            OrbitStop::Centre { zone } => Some(Sequence(vec![zone.clone()])),
            _ => None,
        }
    }

    /// Where motions beyond it stop for lack of a mode the model is at fault, and where digits are lost the branch goes on.
    fn completes(stop: &OrbitStop) -> bool {
        !matches!(
            stop,
            OrbitStop::Halts { .. }
                | OrbitStop::Refused { .. }
                | OrbitStop::LosesDigits { .. }
                | OrbitStop::NegativeBound { .. }
        )
    }

    fn repeats(&self, node: &Node) -> Option<(Critical, OrbitStop)> {
        // a point is the same after every part of its period
        if self.is_point(&node.point) {
            return Some((Critical::Shrinking, OrbitStop::Shrinks));
        }
        if let Some(vanishing) = self.comes_to_a_point(node, NEARLY_A_POINT) {
            return Some((vanishing.special(), vanishing.stop()));
        }
        let times = self.traversals(&node.point);
        (times > 1).then_some((Critical::Repeats { times }, OrbitStop::Repeats { times }))
    }

    fn vanishes(&self, node: &Node) -> Option<(f64, f64)> {
        let vanishing = self.comes_to_a_point(node, NEARLY_A_POINT)?;
        Some((vanishing.parameter, vanishing.error))
    }

    fn may_turn(&self, step: &Segment<Examination>) -> bool {
        multiplier::may_turn(
            [step.before, step.after].map(|examination| &examination.multipliers[..]),
        )
    }

    fn ends_within(&self, step: &Segment<Examination>) -> EndWithin<AffineOrbit> {
        let shrinks = self.shrinks_within(step);
        let ends = shrinks.or_else(|| self.enters_a_family(step));
        ends.unwrap_or(EndWithin::Not)
    }

    fn has_images(&self) -> bool {
        true
    }

    fn becomes_image(&self, before: &Vector, point: &Vector) -> Option<(Critical, OrbitStop)> {
        self.becomes_symmetric(before, point)
            .then_some((Critical::Symmetric, OrbitStop::Retraces))
    }

    fn symmetric_near(&self, point: &Vector, tolerance: f64) -> Option<(Vector, f64)> {
        AffineOrbit::symmetric_near(self, point, tolerance)
    }

    fn falls_on_another(&self, before: &Vector, point: &Vector) -> bool {
        self.falls(before, point)
    }

    /// A symmetry may exchange zones and modes and begin elsewhere in time: durations and multipliers are the same.
    fn image(
        &self,
        point: &Vector,
        other: &AffineOrbit,
        of_other: &Vector,
    ) -> Option<(Critical, OrbitStop)> {
        self.has_image(point, other, of_other)
            .then_some((Critical::Symmetric, OrbitStop::Retraces))
    }

    fn tested(&self) -> Option<AffineOrbit> {
        let setting = Setting {
            stability: true,
            ..(*self.setting).clone()
        };
        AffineOrbit::new(Arc::new(setting), self.sequence.clone())
    }

    /// An orbit of amplitude a is off by a², and so is the parameter, which changes by its slope times a.
    fn shrunk(&self, node: &Node) -> Option<(Vector, f64)> {
        let point = &node.point;
        if !self.is_point(point) {
            return None;
        }
        let beside = || {
            let extremes = self.extremes(point).ok()?;
            let units = &self.setting.scales.states;
            let sizes = extremes
                .iter()
                .zip(units)
                .map(|((low, high), unit)| (high - low) / unit);
            let slope = node.tangent[node.tangent.len() - 1].abs();
            let error = slope * sizes.fold(0.0, f64::max) * self.unit().abs();
            Some((point.clone(), error))
        };
        self.hopf(point).or_else(beside)
    }

    fn zero_of(
        &self,
        what: Crossed,
        from: &Node,
        ends: [f64; 2],
        tolerance: f64,
    ) -> Option<(Place, f64)> {
        let crossing = |count: usize| {
            let off = |point: &Vector| self.left_out(point);
            let (place, error) = branch_point(self, count, (from, ends), tolerance, off)?;
            Some((place, error * self.unit().abs()))
        };
        match what {
            Crossed::Zero(1) => {
                let lost = self.symmetry_lost(from, ends, tolerance);
                lost.or_else(|| crossing(1))
            }
            Crossed::Zero(_) => None,
            Crossed::Several(count) => crossing(count),
        }
    }

    /// det(M − 1) vanishes at folds, as the parameter along the unit tangent does; their quotient does not.
    fn across_folds(&self, test: usize, value: f64, node: &Node) -> f64 {
        match test {
            1 => value / node.tangent[node.tangent.len() - 1],
            _ => value,
        }
    }

    fn crossing(&self, test: usize, node: &Node) -> Option<Critical> {
        match test {
            0 => Some(Critical::PeriodDoubling),
            1 => Some(Critical::Branching),
            _ => {
                let at = self.at(&node.point).ok()?;
                at.monodromy(&at.passages().ok()?)?
                    .angle_on_circle()
                    .map(|angle| Critical::Torus { angle })
            }
        }
    }

    fn passing(
        &self,
        node: &Node,
        outside: [usize; 2],
        between: Option<[f64; 2]>,
    ) -> Option<Critical> {
        if let Some(between) = between {
            return Some(Critical::Unlocated { outside, between });
        }
        Critical::passing(&self.multipliers(&node.point).ok()?, outside)
    }

    fn measured(
        &self,
        monitor: usize,
        point: &Vector,
    ) -> Result<Option<MonitorValue>, OrbitFailure> {
        AffineOrbit::measured(self, monitor, point)
    }

    fn monitor_name(&self, monitor: usize) -> &str {
        let monitors = self.setting.system.monitors();
        monitors.get(monitor).map_or("", |one| &one.name)
    }

    fn kind(special: &Critical) -> EventType {
        special.kind()
    }
}
