//! What a perturbation is on the surface of a sliding mode.

use super::layout::OrbitAt;

use super::signature::exit_of;
use crate::affine::mode::Exit;
use crate::linalg::{Matrix, Vector};

impl OrbitAt<'_> {
    /// I − d nᵀ/(nᵀd) at the entry of a sliding zone, with n the gradient of its surface and d = F₊ − F₋: what lies
    /// beside the surface comes to it along d, whichever field takes it there. `None` where the zone does not slide, or
    /// where the zone before ends on the surface by a jump, which takes that direction away.
    pub(super) fn onto_surface(&self, zone: usize) -> Option<Matrix> {
        let zone = zone % self.zones.len();
        let before = zone + self.zones.len() - 1;
        let mode = self.mode(zone);
        let (surface, sides) = mode.surface.as_ref().zip(mode.sides)?;
        if self.mode(before).surface.is_none() && !self.comes_straight(before) {
            return None;
        }
        let n = self.orbit.states();
        let at = &self.zones[zone];
        let system = &self.posed.system;
        let [below, above] = sides.map(|side| {
            let z = system.lift(side, &at.state, at.phase);
            &system.modes[side].matrix.at * z
        });
        let across: Vector = (above - below).rows(0, n).into_owned();
        let normal = self.at_entry(zone, surface, 0).by_z.rows(0, n).into_owned();
        Some(Matrix::identity(n, n) - &across * normal.transpose() / normal.dot(&across))
    }

    /// Whether a zone on one side of the surface in which the next one slides leads to it without a jump.
    pub(super) fn comes_straight(&self, zone: usize) -> bool {
        let mode = self.orbit.sequence.zone(zone).mode;
        let is_side = |sides: [usize; 2]| sides.contains(&mode);
        let exit = exit_of(&self.posed.system, &self.orbit.sequence, zone);
        self.mode(zone + 1).sides.is_some_and(is_side) && exit.is_some_and(Exit::is_continuous)
    }
}
