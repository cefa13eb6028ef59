//! Families of orbits.
//!
//! An orbit that keeps a sum of states is one of a family, of which the branch follows the member with the value of its start.
//! Where that member ends others may go on. Where a law becomes linear, as below a saturation, a branch comes to a family at
//! one value of the parameter, and ends.

use super::candidates::candidates;
use super::examine::Examination;
use super::layout::AffineOrbit;
use super::multiplier::{Multiplier, own};
use super::{Critical, Margin, OrbitTermination, Watch};
use crate::continuation::Node;
use crate::continuation::locate::node_at;
use crate::continuation::newton::{self, Fixed, Settings};
use crate::continuation::walk::Segment;
use crate::linalg::Vector;
use crate::orbit::located::AT_ZERO;
use crate::orbit::sign::SignVerdict;
use crate::orbit::{EndWithin, Examined as _, Inequalities, Zones, rounding_at};

/// How far beside the member of the branch another one is looked at, in units of the states: far above what an event is
/// located to, and little enough for other margins to stay as they are.
const BESIDE: f64 = 1e-6;

/// The parameter of a family changes by no more than this along a unit tangent, as rounding makes it do.
const LEVEL: f64 = 1e-9;

impl AffineOrbit {
    /// Where the branch comes to a family at one value of the parameter within a step: of its orbits a multiplier is 1, here and
    /// farther on. A canard stands as still and has a multiplier 1 at its fold alone.
    pub(super) fn enters_a_family(
        &self,
        step: &Segment<Examination>,
    ) -> Option<EndWithin<AffineOrbit>> {
        /// How far on another orbit is looked at: a multiplier at a fold whose parameter stands still moves by much more than
        /// that.
        const FARTHER: f64 = 1e-2;
        /// Halvings of the step: the branch may come to the family tangentially, and where is told by the least slope only.
        const HALVINGS: usize = 30;
        let last = step.to.tangent.len() - 1;
        let is_level = |node: &Node| node.tangent[last].abs() <= LEVEL;
        // what an inequality changes comes first
        let is_admissible = step.after.verdict() == SignVerdict::Positive;
        if !is_level(step.to) || !is_admissible || !self.has_a_multiplier_one(&step.to.point) {
            return None;
        }
        let tolerance = step.steps.tolerance;
        let farther = node_at(self, step.to, FARTHER, tolerance)?;
        let moved = (farther.point[last] - step.to.point[last]).abs();
        if moved > LEVEL * FARTHER || !self.has_a_multiplier_one(&farther.point) {
            return None;
        }
        let (mut low, mut high, mut node) = (0.0, step.ds, step.to.clone());
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match node_at(self, step.from, middle, tolerance) {
                Some(there) if is_level(&there) => (high, node) = (middle, there),
                _ => low = middle,
            }
        }
        let rounding = rounding_at(self, &node);
        Some(EndWithin::At {
            s: high,
            node: Box::new(node),
            special: Critical::Family,
            stop: OrbitTermination::Family,
            uncertainty: rounding + moved * self.setting.scales.parameter.abs(),
        })
    }

    /// Whether a multiplier of an orbit that is not trivial is 1, as far as it is known, and it is known well.
    fn has_a_multiplier_one(&self, point: &Vector) -> bool {
        /// It is known to this, and 1 to this: the monodromy matrix of a family has a double multiplier 1, as well known as the
        /// root of rounding.
        const KNOWN: f64 = 1e-6;
        let multipliers = self.multipliers(point).unwrap_or_default();
        let is_one = |one: &Multiplier| (one.value - 1.0).norm() <= KNOWN && one.error <= KNOWN;
        own(&multipliers).any(is_one)
    }

    /// Whether the branch ends at the zero of a margin since it keeps what it does: at the same value of the parameter orbits of
    /// the same zones are admissible that keep another value.
    pub(super) fn others_remain(
        &self,
        point: &Vector,
        margin: &Margin,
    ) -> Option<OrbitTermination> {
        if self.conserved.count() == 0 {
            return None;
        }
        let units = &self.setting.scales.states;
        let index = point.len() - 1;
        let remains = |state: &usize| {
            let moved = |by: f64| self.member(point, (*state, by * units[*state]), point[index]);
            [BESIDE, -BESIDE]
                .into_iter()
                .any(|by| moved(by) == Some(SignVerdict::Positive))
        };
        let states = self.names_of((0..self.states()).filter(remains));
        (!states.is_empty()).then(|| OrbitTermination::OthersRemain {
            held: self.inequality(margin),
            states,
        })
    }

    fn names_of(&self, states: impl Iterator<Item = usize>) -> Vec<String> {
        let names = &self.setting.system.source.states;
        states.map(|state| names[state].clone()).collect()
    }

    /// Whether the branch ends at the zero of a margin since what slips there and back slips no more beyond, and keeps what it has: next
    /// to it orbits are a family, of which some are admissible.
    pub(super) fn family_beyond(
        &self,
        point: &Vector,
        margin: &Margin,
    ) -> Option<OrbitTermination> {
        /// Values that are tried, in parts of how far the parameter is moved: bounds of a force that are reached on both sides leave
        /// room in proportion to that.
        const PARTS: [f64; 8] = [-4.0, -2.0, -1.0, -0.5, 0.5, 1.0, 2.0, 4.0];
        if margin.watch != Watch::Duration {
            return None;
        }
        let (orbit, point) = self.without_vanished(point)?;
        if orbit.conserved.count() <= self.conserved.count() {
            return None;
        }
        let units = &self.setting.scales.states;
        let index = point.len() - 1;
        let is_member = |state: &usize| {
            [BESIDE, -BESIDE].into_iter().any(|side| {
                PARTS.into_iter().any(|part| {
                    let by = part * BESIDE * units[*state];
                    let verdict = orbit.member(&point, (*state, by), point[index] + side);
                    verdict == Some(SignVerdict::Positive)
                })
            })
        };
        let states = self.names_of((0..self.states()).filter(is_member));
        (!states.is_empty()).then(|| OrbitTermination::FamilyBeyond {
            held: self.inequality(margin),
            states,
        })
    }

    /// The orbit without the zones that last no time at a point, and its unknowns there.
    fn without_vanished(&self, point: &Vector) -> Option<(AffineOrbit, Vector)> {
        let (mut orbit, mut point) = (self.clone(), point.clone());
        while let Some(zone) =
            (0..orbit.zones()).find(|zone| point[orbit.duration_index(*zone)].abs() <= AT_ZERO)
        {
            let examination = orbit.examination(&point).ok()?;
            let mut margins = examination.margins().iter();
            let vanished =
                margins.find(|margin| margin.zone == zone && margin.watch == Watch::Duration)?;
            let candidates = candidates(&orbit, &point, vanished).ok()?;
            let shorter = candidates
                .into_iter()
                .find(|one| one.nascent.is_empty() && one.orbit.zones() < orbit.zones())?;
            (orbit, point) = (shorter.orbit, shorter.point);
        }
        Some((orbit, point))
    }

    /// Whether the orbit of the family is admissible that keeps another value of a state, at this scaled parameter.
    fn member(
        &self,
        point: &Vector,
        (state, by): (usize, f64),
        parameter: f64,
    ) -> Option<SignVerdict> {
        let mut kept = self.sequence.kept().to_vec();
        *kept.get_mut(state)? += by;
        let sequence = self.sequence.clone().keeping(&kept);
        let orbit = AffineOrbit::new(self.setting.clone(), sequence)?;
        let index = point.len() - 1;
        let mut fixed = Fixed {
            index,
            value: parameter,
        };
        let solved = newton::solve(&orbit, &mut fixed, point, &Settings::default()).ok()?;
        Some(orbit.examination(&solved.point).ok()?.verdict())
    }
}
