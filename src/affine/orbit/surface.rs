//! What a perturbation is on the surface of a sliding mode.

use super::layout::OrbitAt;
use crate::linalg::{Matrix, Vector};

impl OrbitAt<'_> {
    /// I − d nᵀ/(nᵀd) at the entry of a sliding zone, with n the gradient of its surface and d = F₊ − F₋: what lies
    /// beside the surface comes to it along d, whichever field takes it there. `None` where the zone does not slide, or
    /// where the zone before, which ends on the surface, takes that direction away already.
    pub(super) fn onto_surface(&self, zone: usize) -> Option<Matrix> {
        let zone = zone % self.zones.len();
        let mode = self.mode(zone);
        let (surface, sides) = mode.surface.as_ref().zip(mode.sides)?;
        self.mode(zone + self.zones.len() - 1).surface.as_ref()?;
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
}
