//! Bounds of friction that are no constants, at a point of a branch: a negative one makes no sense.

use super::examine::{Part, parts};
use super::layout::{AffineOrbit, OrbitAt};
use super::stop::OrbitStop;
use crate::affine::flow::ModeFlow;
use crate::linalg::Vector;

impl AffineOrbit {
    /// The bound of friction that is negative on an orbit while it slips; `None` also where that is not known.
    pub fn negative_bound(&self, point: &Vector) -> Option<OrbitStop> {
        if !self.setting.system.has_varying_bounds() {
            return None;
        }
        let at = self.at(point).ok()?;
        (0..self.zones()).find_map(|zone| at.negative_bound(zone))
    }
}

impl OrbitAt<'_> {
    /// The same in a zone.
    fn negative_bound(&self, zone: usize) -> Option<OrbitStop> {
        let duration = self.zones[zone].duration;
        let known = self.orbit.sequence.zone(zone);
        let mode = self.mode(zone);
        if mode.bounds.is_empty() || duration.is_nan() || duration <= 0.0 {
            return None;
        }
        let balance = || self.posed.balance(known.mode).clone();
        let mut flow = ModeFlow::balanced(mode, self.orbit.setting.scales.time, balance);
        if mode.field.is_exact {
            let bounds = mode.bounds.iter();
            bounds.for_each(|(_, bound)| flow.watch(bound.at.clone()));
        }
        let all = parts(&flow, self.entry(zone), duration).ok()?;
        let first = mode.guards.len();
        for (index, (guard, bound)) in mode.bounds.iter().enumerate() {
            let least = |part: &Part| {
                let form = (first + index, &bound.at);
                let (after, value) = flow.least_below_zero(form, &part.piece, part.part)?;
                Some((part.begun + after, value))
            };
            let negative = all.iter().filter_map(least);
            if let Some((time, value)) = negative.min_by(|one, other| one.1.total_cmp(&other.1)) {
                return Some(OrbitStop::NegativeBound {
                    mode: known.name.clone(),
                    guard: self.orbit.setting.system.guard_name(known.mode, *guard),
                    value,
                    time,
                });
            }
        }
        None
    }
}
