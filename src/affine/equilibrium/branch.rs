//! Equilibria as what the engine follows from mode to mode.

use super::curve::{EquilibriumCurve, EquilibriumFailure, RestMode};
use super::examine::{EquilibriumExamination, EquilibriumMargin};
use super::extended::{Condition, locate};
use super::normal_form::{Lyapunov, normal_form};
use super::spectrum::{BRANCHING, HOPF, critical_pair};
use super::{EquilibriumBifurcation, EquilibriumGuard, EquilibriumTermination, VirtualEquilibrium};
use crate::affine::mode::{Exit, Guard};
use crate::continuation::branch_point::branch_point;
use crate::continuation::locate::{Place, node_at, zero_along};
use crate::continuation::newton;
use crate::continuation::{DEFAULT_TOLERANCE, Node, unbounded};
use crate::linalg::{Matrix, Vector};
use crate::orbit::monitor::MonitorValue;
use crate::orbit::switch::is_in_family;
use crate::orbit::{
    Bifurcations, Candidate, Changes, CoordinateChanges, Covers, Crossed, EventType, Examined,
    Inequalities, MarginFunction, Monitored, Situation, SpecialType, TerminationType, Terminations,
    Zones,
};

/// A state is the one that a reset leaves alone where they differ by no more than this part of their size: an equilibrium
/// is known to rounding.
const SAME: f64 = 1e-9;

/// The equations of a neighbouring mode hold at an equilibrium of this one where no residual, of order one, is larger:
/// the event itself is known to about 1e-13.
const AT_REST: f64 = 1e-8;

/// Part of a step to which a change of stability is known before its extended system is solved.
const NEAR: f64 = 1e-3;

/// Part of the size of states by which they are followed farther where they grow without bound, to see that the slope of the parameter
/// falls, at least like the root of that size.
const FARTHER: f64 = 0.1;

/// Parts of a step from whose ends that is solved where nothing is found so near.
const SAMPLES: u32 = 8;

/// Of the exits of a guard the first whose conditions hold at z, and any before it of which that is not told.
fn taken<'a>(exits: &'a [Exit], z: &Vector) -> Vec<&'a Exit> {
    let mut taken = Vec::new();
    for exit in exits {
        let least = least_condition(exit, z);
        if least >= -SAME {
            taken.push(exit);
        }
        if least > SAME {
            break;
        }
    }
    taken
}

/// The least of the conditions of a switch, each beside the terms that it is made of.
fn least_condition(exit: &Exit, z: &Vector) -> f64 {
    let values = exit.conditions.iter().map(|row| {
        let terms = row.at.iter().zip(z).filter(|(by, _)| **by != 0.0);
        let size: f64 = terms.map(|(by, z)| (by * z).abs()).sum();
        // where every term is zero so is the condition
        if size > 0.0 { row.value(z) / size } else { 0.0 }
    });
    values.fold(f64::INFINITY, f64::min)
}

impl Zones for EquilibriumCurve {
    type Signature = RestMode;
    type Parameter = String;
    type Margin = EquilibriumMargin;
    type Examination = EquilibriumExamination;

    fn signature(&self) -> &RestMode {
        &self.signature
    }

    fn posed(&self, signature: RestMode) -> Option<EquilibriumCurve> {
        let mut posed = self.in_mode(signature.mode)?;
        posed.signature.signs.clone_from(&signature.signs);
        (posed.signature == signature).then_some(posed)
    }

    fn is_rotation(&self, signature: &RestMode) -> bool {
        *signature == self.signature
    }

    fn parameter(&self) -> String {
        let names = self.setting.system.source.parameters.names();
        let mut names = names.skip(self.setting.parameter);
        names.next().unwrap_or_default().to_owned()
    }

    fn column(parameter: &String) -> &str {
        parameter
    }

    /// Equilibria have no zones.
    fn duration_index(&self, _zone: usize) -> usize {
        0
    }

    fn unit(&self) -> f64 {
        self.setting.scales.units[self.states()]
    }

    fn examination(&self, point: &Vector) -> Result<EquilibriumExamination, EquilibriumFailure> {
        self.examined(point)
    }

    fn rounding(&self, matrix: &Matrix, point: &Vector, last: f64) -> Option<f64> {
        let parameter = point.len() - 1;
        let mut noise = newton::noise(self, matrix, point);
        if let Some(noise) = &mut noise {
            noise[parameter] = last;
        }
        Some(newton::rounding(matrix, &point.abs(), noise.as_ref())?[parameter])
    }

    /// The units are those of the first equilibrium, beside which another may be a thousand times as large.
    fn stretch(&self, point: &Vector) -> f64 {
        point.rows(0, self.states()).amax().max(1.0)
    }
}

impl MarginFunction for EquilibriumMargin {
    fn value(&self) -> f64 {
        self.value
    }

    fn is_same(&self, other: &EquilibriumMargin) -> bool {
        self.guard == other.guard
    }

    fn precedence(&self) -> usize {
        self.guard
    }
}

impl Inequalities for EquilibriumCurve {
    type Inequality = EquilibriumGuard;
    type Inadmissible = VirtualEquilibrium;

    fn margin_at(
        &self,
        seen: &EquilibriumMargin,
        point: &Vector,
    ) -> Result<EquilibriumMargin, EquilibriumFailure> {
        let examination = self.examined(point)?;
        let known = examination.margins.into_iter().nth(seen.guard);
        Ok(known.unwrap_or_else(|| seen.clone()))
    }

    fn add_gradient(&self, margin: &EquilibriumMargin, gradient: &mut [f64]) {
        for (sum, by) in gradient.iter_mut().zip(&margin.gradient) {
            *sum += by;
        }
    }

    fn is_alike(
        &self,
        margin: &EquilibriumMargin,
        other: &EquilibriumCurve,
        of_other: &EquilibriumMargin,
    ) -> bool {
        self.guard_of(margin).guard == other.guard_of(of_other).guard
    }

    fn inequality(&self, margin: &EquilibriumMargin) -> EquilibriumGuard {
        self.guard_of(margin)
    }

    fn inadmissible(&self, examination: &EquilibriumExamination) -> VirtualEquilibrium {
        self.worst(examination)
    }
}

impl CoordinateChanges for EquilibriumCurve {}

impl Changes for EquilibriumCurve {
    type Remark = EquilibriumGuard;

    fn candidates(
        &self,
        point: &Vector,
        margin: &EquilibriumMargin,
    ) -> Result<Vec<Candidate<EquilibriumCurve>>, EquilibriumFailure> {
        if let Some(kink) = self.kink(margin) {
            let beyond = self.beyond_kink(kink).map(|orbit| Candidate {
                orbit,
                point: point.clone(),
                nascent: Vec::new(),
            });
            return Ok(beyond.into_iter().collect());
        }
        let mode = self.signature.mode;
        let mut found: Vec<Candidate<EquilibriumCurve>> = Vec::new();
        let guards = &self.lifted.modes[mode].guards;
        let exits = guards.get(margin.guard).map(|guard| &guard.exits[..]);
        self.add_candidates((mode, point), exits.unwrap_or_default(), &mut found);
        // a mode that ends at the event, too, leads on: as a damped spring that has lost its force opens
        let between: Vec<usize> = found.iter().map(|one| one.orbit.signature.mode).collect();
        for other in between {
            let z = self.at_switch_in(other, point);
            let ends = |guard: &&Guard| guard.row.value(&z).abs() <= SAME * guard.row.size(&z);
            let ending = self.lifted.modes[other].guards.iter().filter(ends);
            for guard in ending {
                self.add_candidates((other, point), &guard.exits, &mut found);
            }
        }
        Ok(found)
    }

    fn classify(_: &RestMode, _: Option<&RestMode>, _: &EquilibriumMargin) -> EventType {
        EventType::BE
    }

    fn opens(&self, _point: &Vector) -> bool {
        false
    }

    fn is_kink(&self, margin: &EquilibriumMargin) -> bool {
        self.kink(margin).is_some()
    }
}

impl SpecialType<RestMode> for EquilibriumBifurcation {
    fn kind(&self) -> EventType {
        let pairs = match self {
            EquilibriumBifurcation::Hopf { .. } => true,
            EquilibriumBifurcation::Branching => false,
            EquilibriumBifurcation::Several { complex, .. } => *complex,
            EquilibriumBifurcation::Unlocated { growing, .. } => {
                growing[0].abs_diff(growing[1]) > 1
            }
        };
        if pairs { EventType::HB } else { EventType::BP }
    }
}

impl Bifurcations for EquilibriumCurve {
    type Special = EquilibriumBifurcation;

    fn across_folds(&self, test: usize, value: f64, node: &Node) -> f64 {
        match test {
            BRANCHING => self.across(node),
            _ => value,
        }
    }

    fn passed_by(test: usize) -> u64 {
        if test == HOPF { 2 } else { 1 }
    }

    fn turns_at(test: usize) -> bool {
        test == BRANCHING
    }

    fn crossing(&self, test: usize, node: &Node) -> Option<EquilibriumBifurcation> {
        match test {
            BRANCHING => Some(EquilibriumBifurcation::Branching),
            _ => self.hopf(node),
        }
    }

    fn passing(
        &self,
        node: &Node,
        outside: [usize; 2],
        between: Option<[f64; 2]>,
    ) -> Option<EquilibriumBifurcation> {
        if let Some(between) = between {
            let growing = outside;
            return Some(EquilibriumBifurcation::Unlocated { growing, between });
        }
        let count = outside[0].abs_diff(outside[1]);
        match (count, self.hopf(node)) {
            (0, _) => None,
            (1, _) => Some(EquilibriumBifurcation::Branching),
            (2, Some(hopf)) => Some(hopf),
            (_, pair) => Some(EquilibriumBifurcation::Several {
                count,
                complex: pair.is_some(),
            }),
        }
    }

    fn zero_of(
        &self,
        what: Crossed,
        from: &Node,
        ends: [f64; 2],
        tolerance: f64,
    ) -> Option<(Place, f64)> {
        let (test, condition) = match what {
            Crossed::Zero(BRANCHING) => (BRANCHING, Condition::Branching),
            Crossed::Zero(test) => (test, Condition::Hopf),
            Crossed::Several(count) => {
                let (place, error) = branch_point(self, count, (from, ends), tolerance, |_| 0.0)?;
                return Some((place, error * self.unit().abs()));
            }
        };
        let located = |near: Node| {
            let located = locate(self, &near, condition)?;
            let s = from.tangent.dot(&(&located.point - &from.point));
            let node = Node {
                point: located.point,
                ..near
            };
            let place = Place { s, node, blur: 0.0 };
            // another one may lie beyond the step
            (ends[0]..=ends[1])
                .contains(&s)
                .then_some((place, located.uncertainty))
        };
        let near = self.near_zero(test, from, ends, tolerance);
        near.and_then(located).or_else(|| {
            // beside a crossing of branches rounding may leave no equilibrium: from farther away its own equations lead to it
            let mut parts = (1..SAMPLES).map(|part| f64::from(part) / f64::from(SAMPLES));
            let at =
                |part: f64| node_at(self, from, ends[0] + part * (ends[1] - ends[0]), tolerance);
            parts.find_map(|part| at(part).and_then(located))
        })
    }

    /// By the extended system: the state is known as well as the parameter.
    fn fold_near(&self, node: &Node) -> Option<(Vector, f64)> {
        let located = locate(self, node, Condition::Fold)?;
        Some((located.point, located.uncertainty))
    }
}

impl TerminationType<RestMode> for EquilibriumTermination {
    fn completes(&self) -> bool {
        match self {
            EquilibriumTermination::NoneBeyond { .. } | EquilibriumTermination::Grows => true,
        }
    }
}

impl Terminations for EquilibriumCurve {
    type Termination = EquilibriumTermination;

    fn termination(
        &self,
        situation: Situation<'_, EquilibriumMargin>,
    ) -> Option<EquilibriumTermination> {
        match situation {
            Situation::At(node, _) => self.grows(node),
            Situation::NoStep(_) | Situation::Change(_) => None,
            Situation::NoCandidate(point, margin) => self.ends_at_change(point, margin),
        }
    }

    fn short_of(&self, stop: &EquilibriumTermination, node: &Node) -> f64 {
        match stop {
            EquilibriumTermination::Grows => unbounded::short_of(&node.point, &node.tangent),
            EquilibriumTermination::NoneBeyond { .. } => 0.0,
        }
    }
}

impl Covers for EquilibriumCurve {}

impl Monitored for EquilibriumCurve {
    fn measured(
        &self,
        monitor: usize,
        point: &Vector,
    ) -> Result<Option<MonitorValue>, EquilibriumFailure> {
        Ok(self.observed_at(monitor, point))
    }

    fn monitor_name(&self, monitor: usize) -> &str {
        let mut monitors = self.setting.system.monitors().iter().skip(monitor);
        monitors.next().map_or("", |monitor| &monitor.name)
    }
}

impl EquilibriumCurve {
    /// Adds the candidates to which exits of a mode lead at a point, of modes that are none of them yet.
    fn add_candidates(
        &self,
        (mode, point): (usize, &Vector),
        exits: &[Exit],
        found: &mut Vec<Candidate<EquilibriumCurve>>,
    ) {
        let leads = |exit: &Exit| std::iter::once(exit.to).chain(exit.rest);
        let z = self.at_switch_in(mode, point);
        let ways = taken(exits, &z).into_iter();
        for (exit, to) in ways.flat_map(|exit| leads(exit).map(move |to| (exit, to))) {
            let known = |one: &Candidate<EquilibriumCurve>| one.orbit.signature.mode == to;
            let is_new = to != self.signature.mode && !found.iter().any(known);
            if !is_new || !self.stays(exit, point, &z) {
                continue;
            }
            // equilibria at this value of the parameter alone are no branch, as where no rate of a mode has some state
            let single = |orbit: &EquilibriumCurve| !is_in_family(orbit, point);
            let own = self.in_mode(to).map(|own| own.on_side_of(point));
            found.extend(own.filter(single).map(|orbit| Candidate {
                orbit,
                point: point.clone(),
                nascent: Vec::new(),
            }));
        }
    }

    /// Why the branch ends where a margin vanishes and no candidate goes on.
    fn ends_at_change(
        &self,
        point: &Vector,
        margin: &EquilibriumMargin,
    ) -> Option<EquilibriumTermination> {
        let candidates = self.candidates(point, margin).ok()?;
        let none = !candidates
            .iter()
            .any(|one| one.orbit.goes_on_from(&one.point));
        none.then(|| EquilibriumTermination::NoneBeyond {
            guard: self.guard_of(margin),
        })
    }

    /// Whether the branch ends as its states grow without bound.
    fn grows(&self, node: &Node) -> Option<EquilibriumTermination> {
        let Node { point, tangent, .. } = node;
        let slope = |node: &Node| node.tangent[self.states()].abs();
        // beside a fold the slope is as small, but rises; a family at one value of the parameter has none
        let falls = || {
            let beyond = node_at(self, node, FARTHER * point.norm(), DEFAULT_TOLERANCE);
            beyond.is_some_and(|beyond| {
                let [there, here] = [&beyond, node].map(slope);
                there < (1.0 - 0.5 * FARTHER) * here || there.max(here) <= f64::EPSILON
            })
        };
        let grows = unbounded::grows(point, tangent, self.stretch(point)) && falls();
        grows.then_some(EquilibriumTermination::Grows)
    }

    /// z at an equilibrium, in a mode, with what conditions and resets are made of.
    fn at_switch_in(&self, mode: usize, point: &Vector) -> Vector {
        let mut z = self.lifted.lift(mode, &self.place(point), 0.0);
        self.lifted.modes[mode].field.complete_at_switch(&mut z);
        z
    }

    /// Whether equilibria of this mode may go on from an event of another one: it is one of them, and no guard is negative there, as
    /// what holds a sliding mode is where one of the two fields points away from its surface. Such a guard is negative on both sides.
    fn goes_on_from(&self, point: &Vector) -> bool {
        let is_negative = |margin: &EquilibriumMargin| margin.value < -AT_REST;
        let rests = Node::within(self, point.clone(), AT_REST).is_some();
        rests && (self.examined(point)).is_ok_and(|at| !at.margins.iter().any(is_negative))
    }

    /// Whether a switch leaves the state of an equilibrium, with this z, as it is.
    fn stays(&self, exit: &Exit, point: &Vector, z: &Vector) -> bool {
        if exit.is_continuous() {
            return true;
        }
        let place = self.place(point);
        let units = &self.setting.scales.units;
        (0..self.states()).all(|state| {
            let moved = exit.reset.value(state, z) - place[state];
            moved.abs() <= SAME * units[state].max(place[state].abs())
        })
    }

    /// The mode and the switch of the file whose `zero` a margin is; `None` for what holds a sliding mode.
    pub fn written_guard(&self, margin: &EquilibriumMargin) -> Option<[usize; 2]> {
        let guards = &self.lifted.modes[self.signature.mode].guards;
        guards.get(margin.guard)?.written
    }

    /// A node next to the zero of a function of the stability between two arclengths of a step.
    fn near_zero(&self, test: usize, from: &Node, ends: [f64; 2], tolerance: f64) -> Option<Node> {
        let value = |node: &Node| match test {
            BRANCHING => Some(self.across(node)),
            _ => Some(self.examined(&node.point).ok()?.tests()[test]),
        };
        let at = |s: f64| {
            let node = node_at(self, from, s, tolerance)?;
            Some((s, value(&node)?))
        };
        let ends = (at(ends[0])?, at(ends[1])?);
        let width = NEAR * (ends.1.0 - ends.0.0);
        let found = zero_along(self, from, ends, (0.0, width), tolerance, value)?;
        Some(found.0.node)
    }

    /// Whether the rates of the mode are affine in the states.
    pub(super) fn is_affine(&self, point: &Vector) -> bool {
        let own = self.setting.system.at(&self.values_at(point), &[]).ok();
        own.is_some_and(|own| own.modes[self.signature.mode].field.is_exact)
    }

    /// The Hopf point at a node; none where the two eigenvalues of sum zero are real.
    fn hopf(&self, node: &Node) -> Option<EquilibriumBifurcation> {
        let examination = self.examined(&node.point).ok()?;
        let omega = critical_pair(&examination.eigenvalues)?;
        let lyapunov = match self.is_affine(&node.point) {
            true => Some(Lyapunov::Vertical),
            false => {
                let place = self.place(&node.point);
                let at = self.linearised(&node.point).ok()?;
                normal_form(self.local(&place), &at, omega).map(|form| form.lyapunov)
            }
        };
        Some(EquilibriumBifurcation::Hopf { omega, lyapunov })
    }
}
