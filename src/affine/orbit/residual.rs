//! The equations of an orbit: the end of every zone against the entry of the next.

use std::f64::consts::TAU;

use super::layout::{AffineOrbit, OrbitAt, OrbitFailure, Scales};
use super::passage::Jet;
use super::structure::{exit_of, section};
use crate::affine::mode::Row;
use crate::continuation::newton::System;
use crate::linalg::{Matrix, Vector};

/// Where the equations are written.
struct Equations<'a> {
    at: &'a OrbitAt<'a>,
    residual: &'a mut [f64],
    jacobian: &'a mut Matrix,
}

impl Equations<'_> {
    /// Adds a jet of a zone to an equation, times a factor.
    fn add(&mut self, row: usize, zone: usize, jet: &Jet, factor: f64) {
        self.residual[row] += factor * jet.value;
        let jacobian = &mut *self.jacobian;
        let mut add = |column: usize, by: f64| jacobian[(row, column)] += by;
        self.at.spread(zone, jet, factor, &mut add);
    }
}

impl System for AffineOrbit {
    type Failure = OrbitFailure;

    fn unknowns(&self) -> usize {
        self.count()
    }

    /// Per zone: the states at the next entry, where what is zero by the structure takes the place of what the
    /// reset would give; and its guard at the end, divided by the power of the duration by which it vanishes
    /// with it. With forcing ΣT = periods·2π/ω.
    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), OrbitFailure> {
        let at = self.at(point)?;
        let Scales { states, time, .. } = &self.setting.scales;
        let (width, count) = (self.width(), self.zones());
        let n = states.len();
        residual[..width * count].fill(0.0);
        let mut equations = Equations {
            at: &at,
            residual,
            jacobian,
        };
        for zone in 0..count {
            let passage = at.passage(zone, at.zones[zone].duration)?;
            let next = (zone + 1) % count;
            let facts = &at.posed.facts[next];
            let entry = at.entry(next);
            let first = width * zone;
            let exit = exit_of(&at.posed.system, &self.sequence, zone);
            for (state, unit) in states.iter().enumerate() {
                let row = first + state;
                let pivot = facts.zero.pivots.iter().position(|pivot| *pivot == state);
                if let Some(generic) = &facts.generic {
                    // the derivatives of the guard that are divided out are zero at the entry
                    let order = generic.pivots.iter().position(|pivot| *pivot == state);
                    let way = self.sequence.zone(next).way;
                    if let Some((order, way)) = order.zip(way) {
                        let guard = &at.mode(next).guards[way.guard].row;
                        let factor = time.powi(order as i32) / self.size(guard);
                        equations.add(row, next, &at.at_entry(next, guard, order), factor);
                        continue;
                    }
                } else if let Some(form) = pivot.map(|index| &facts.zero.rows[index]) {
                    equations.add(row, next, &at.at_entry(next, form, 0), unit.recip());
                    continue;
                }
                let own = Row::unit(entry.len(), state);
                let arrives = exit.map_or_else(|| own.clone(), |exit| exit.reset.row(state));
                equations.add(row, zone, &passage.at_end(&arrives), unit.recip());
                equations.add(row, next, &Jet::at_entry(&own, &entry), -unit.recip());
            }
            let row = first + n;
            let mode = &at.posed.system.modes[self.sequence.zone(zone).mode];
            if let Some(way) = self.sequence.zone(zone).way {
                let guard = &mode.guards[way.guard].row;
                let order = at.posed.facts[zone].divided;
                let [divided, _] = passage.divided(guard, order);
                let factor = time.powi(order as i32) / self.size(guard);
                equations.add(row, zone, &divided, factor);
            } else if let Some(index) = self.phase_index() {
                equations.residual[row] = point[index];
                equations.jacobian[(row, index)] = 1.0;
            } else {
                let rate = mode.matrix.row(section(mode));
                let factor = self.size(&rate).recip();
                equations.add(row, zone, &at.at_entry(zone, &rate, 0), factor);
            }
        }
        if self.is_forced() {
            let row = width * count;
            let omega = at.posed.system.omega;
            let turns = f64::from(self.setting.periods);
            let total: f64 = at.zones.iter().map(|zone| zone.duration).sum();
            residual[row] = total * omega.value / TAU - turns;
            for zone in 0..count {
                jacobian[(row, width * zone + n)] = time * omega.value / TAU;
            }
            jacobian[(row, self.count() - 1)] =
                total * omega.by[0] / TAU * self.setting.scales.parameter;
        }
        Ok(())
    }
}
