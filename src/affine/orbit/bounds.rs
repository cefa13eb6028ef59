//! Bounds of friction that are no constants, at a point of a branch: a negative one makes no sense.

use super::layout::{AffineOrbit, OrbitAt};
use super::termination::OrbitTermination;
use crate::linalg::Vector;

impl AffineOrbit {
    /// The bound of friction that is negative on an orbit while it slips; `None` also where that is not known.
    pub fn negative_bound(&self, point: &Vector) -> Option<OrbitTermination> {
        if !self.setting.system.has_varying_bounds() {
            return None;
        }
        let at = self.at(point).ok()?;
        (0..self.zones()).find_map(|zone| at.negative_bound(zone))
    }
}

impl OrbitAt<'_> {
    /// The same in a zone.
    fn negative_bound(&self, zone: usize) -> Option<OrbitTermination> {
        let mode = self.mode(zone);
        if mode.bounds.is_empty() {
            return None;
        }
        let known = self.orbit.sequence.zone(zone);
        let flow = self.posed.flow(known.mode);
        let parts = self.parts(zone).ok()?;
        let negative = parts.iter().filter_map(|part| {
            let (guard, after, value) = flow.negative_bound(mode, &part.piece, part.part)?;
            Some((guard, part.begun + after, value))
        });
        let (guard, time, value) =
            negative.min_by(|one, other| one.0.cmp(&other.0).then(one.2.total_cmp(&other.2)))?;
        Some(OrbitTermination::NegativeBound {
            mode: known.name.clone(),
            guard: self.orbit.setting.system.guard_name(known.mode, guard),
            value,
            time,
        })
    }
}
