//! The equations of an orbit: the end of every zone against the entry of the next.

use std::f64::consts::TAU;

use super::layout::{AffineOrbit, OrbitAt};
use super::passage::Jet;
use super::passage::Passage;
use super::setting::{OrbitFailure, Scales};
use super::signature::exit_of;
use crate::affine::closure::Prescribed;
use crate::affine::mode::Row;
use crate::continuation::newton::{self, Equations};
use crate::linalg::{self, Matrix, Vector};

/// Where the equations are written.
struct Filled<'a> {
    at: &'a OrbitAt<'a>,
    residual: &'a mut [f64],
    jacobian: &'a mut Matrix,
    /// What of the Jacobian is that of the beginning of the next period, where it is asked for.
    closing: Option<&'a mut Matrix>,
}

impl Filled<'_> {
    /// Adds a jet of a zone to an equation, times a factor.
    fn add(&mut self, row: usize, zone: usize, jet: &Jet, factor: f64) {
        self.residual[row] += factor * jet.value;
        let jacobian = &mut *self.jacobian;
        let mut add = |column: usize, by: f64| jacobian[(row, column)] += by;
        self.at.spread(zone, jet, factor, &mut add);
    }

    /// The same of a jet at the entry of the zone after the one that the equation is about.
    fn add_next(&mut self, row: usize, zone: usize, jet: &Jet, factor: f64) {
        self.add(row, zone, jet, factor);
        if zone == 0
            && let Some(closing) = &mut self.closing
        {
            let mut add = |column: usize, by: f64| closing[(row, column)] += by;
            self.at.spread(zone, jet, factor, &mut add);
        }
    }

    /// The states at the beginning of the next shot of a zone against those to which a shot leads.
    fn add_shot(&mut self, zone: usize, passage: &Passage) {
        let orbit = self.at.orbit;
        let next = passage.shot + 1;
        let entry = self.at.shot_entry(zone, next);
        for (state, unit) in orbit.setting.scales.states.iter().enumerate() {
            let row = orbit.shot_index(zone, next) + state;
            let arrives = passage.at_end(&Row::unit(entry.len(), state));
            self.add(row, zone, &arrives, unit.recip());
            let begins = Jet::of_component(state, &entry).of_shot(next);
            self.add(row, zone, &begins, -unit.recip());
        }
    }

    /// The states at the entry of the next zone against those to which a zone leads: what is zero there by the structure takes the
    /// place of what the reset would give.
    fn add_entry(&mut self, zone: usize, passage: &Passage) {
        let at = self.at;
        let orbit = at.orbit;
        let Scales { states, time, .. } = &orbit.setting.scales;
        let next = (zone + 1) % orbit.zones();
        let facts = &at.posed.facts[next];
        let entry = at.entry(next);
        let exit = exit_of(&at.posed.system, &orbit.sequence, zone);
        for (state, unit) in states.iter().enumerate() {
            let row = orbit.width() * zone + state;
            let pivot = facts.zero.pivots.iter().position(|pivot| *pivot == state);
            if let Some(generic) = &facts.generic {
                let mut own = generic.surfaces.iter();
                let number = own.find(|(_, given)| *given == state);
                let surface = number.and_then(|(number, _)| at.mode(next).surfaces().nth(*number));
                if let Some(surface) = surface {
                    let factor = orbit.size(surface).recip();
                    self.add(row, next, &at.at_entry(next, surface, 0), factor);
                    continue;
                }
                let mut sums = generic.sums.iter();
                if let Some((sum, _)) = sums.find(|(_, given)| *given == state) {
                    self.add_next(row, next, &at.at_entry(next, sum, 0), unit.recip());
                    continue;
                }
                // the derivatives of the guard that are divided out are zero at the entry
                let order = generic.pivots.iter().position(|pivot| *pivot == state);
                let way = orbit.sequence.zone(next).way;
                if let Some((order, way)) = order.zip(way) {
                    let guard = &at.mode(next).guards[way.guard].row;
                    let factor = time.powi(order as i32) / orbit.size(guard);
                    self.add_next(row, next, &at.at_entry(next, guard, order), factor);
                    continue;
                }
            } else if let Some(form) = pivot.and_then(|index| facts.zero.row(index)) {
                self.add_next(row, next, &at.at_entry(next, &form, 0), unit.recip());
                continue;
            }
            let own = || Row::unit(entry.len(), state);
            let arrives = exit.map_or_else(own, |exit| exit.reset.row(state));
            self.add(row, zone, &passage.at_end(&arrives), unit.recip());
            let begins = Jet::of_component(state, &entry);
            self.add_next(row, next, &begins, -unit.recip());
        }
    }

    /// The sum of the durations against the periods of the forcing; `index` is that of the phase.
    fn add_forced_period(&mut self, index: usize) {
        let orbit = self.at.orbit;
        let Scales {
            time, parameter, ..
        } = &orbit.setting.scales;
        let (width, n) = (orbit.width(), orbit.states());
        let row = orbit.unknowns_of_zones();
        // the phase is the same after the period, and perturbed as everything is
        if let Some(closing) = &mut self.closing {
            closing[(row, index)] = -TAU.recip();
        }
        let omega = self.at.posed.system.omega;
        let turns = f64::from(orbit.setting.periods);
        let total = self.at.period();
        self.residual[row] = total * omega.value / TAU - turns;
        for zone in 0..orbit.zones() {
            self.jacobian[(row, width * zone + n)] = time * omega.value / TAU;
        }
        self.jacobian[(row, orbit.count() - 1)] = total * omega.by[0] / TAU * parameter;
    }

    /// The sum of the durations against a prescribed period; `index` is that of the free parameter.
    fn add_prescribed_period(
        &mut self,
        index: usize,
        prescribed: &Prescribed,
    ) -> Result<(), OrbitFailure> {
        let orbit = self.at.orbit;
        let Scales {
            time,
            parameter,
            free,
            ..
        } = &orbit.setting.scales;
        let (width, n) = (orbit.width(), orbit.states());
        let row = orbit.unknowns_of_zones();
        let period = prescribed.period(&self.at.values, &orbit.setting.varying());
        let period = period.map_err(OrbitFailure::System)?;
        let total = self.at.period();
        self.residual[row] = (total - period.value) / time;
        for zone in 0..orbit.zones() {
            self.jacobian[(row, width * zone + n)] = 1.0;
        }
        self.jacobian[(row, index)] = -period.by[1] * free.unwrap_or(1.0) / time;
        self.jacobian[(row, orbit.count() - 1)] = -period.by[0] * parameter / time;
        Ok(())
    }
}

impl Equations for AffineOrbit {
    type Failure = OrbitFailure;

    const KEEPS: bool = true;

    fn unknowns(&self) -> usize {
        self.count()
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), OrbitFailure> {
        self.equations(point, residual, jacobian, None)
    }
}

impl AffineOrbit {
    /// What of the Jacobian is that of the beginning of the next period: where a perturbation is multiplied by μ over the
    /// period the equations have the null vector of F_x + (μ − 1)C.
    ///
    /// # Errors
    /// They cannot be evaluated.
    pub fn closing(&self, point: &Vector) -> Result<Matrix, OrbitFailure> {
        let unknowns = self.count();
        let mut closing = Matrix::zeros(unknowns - 1, unknowns);
        let mut residual = vec![0.0; unknowns - 1];
        let mut jacobian = closing.clone();
        self.equations(point, &mut residual, &mut jacobian, Some(&mut closing))?;
        Ok(closing)
    }

    /// The derivative in μ of det(F_x + (μ − 1)C) where that is zero, but for a positive factor, 1 or −1: it vanishes where
    /// the multiplier is a double one. With the null vectors v and w of the matrix it is ±w·Cv, the sign that of the
    /// determinant bordered by both.
    pub fn is_double(&self, point: &Vector, multiplier: f64) -> Option<f64> {
        let (matrix, _) = newton::jacobian(self, point).ok()?;
        let count = matrix.nrows();
        let closing = self.closing(point).ok()?.columns(0, count).into_owned();
        let matrix = matrix.columns(0, count) + &closing * (multiplier - 1.0);
        let linalg::Least { left, right, .. } = linalg::least(&matrix)?;
        let mut bordered = matrix.resize(count + 1, count + 1, 0.0);
        bordered.view_mut((0, count), (count, 1)).copy_from(&left);
        bordered
            .view_mut((count, 0), (1, count))
            .copy_from(&right.transpose());
        Some(-bordered.determinant().signum() * left.dot(&(closing * right)))
    }

    /// det(F_x − 2C), which changes its sign where a multiplier passes −1. Nothing in it is divided by the speed of a guard: at the
    /// graze of an impact, where det(M + 1) has a pole, it is the residue of that but for a factor.
    pub fn doubling_determinant(&self, point: &Vector) -> Option<f64> {
        let (matrix, _) = newton::jacobian(self, point).ok()?;
        let closing = self.closing(point).ok()?;
        let count = matrix.nrows();
        let mut square = (matrix - closing * 2.0).columns(0, count).into_owned();
        self.hold_free(&mut square);
        Some(square.determinant())
    }

    /// Of perturbations: a parameter that gives the orbit its period is not perturbed.
    pub(super) fn hold_free(&self, square: &mut Matrix) {
        let last = square.nrows() - 1;
        if let Some(free) = self.free_index() {
            square.row_mut(last).fill(0.0);
            square[(last, free)] = 1.0;
        }
    }

    /// Per zone: the states at the beginning of every further shot; those at the next entry, where what is zero by the structure
    /// takes the place of what the reset would give; and its guard at the end, divided by the power of the duration by which it
    /// vanishes with it. With forcing ΣT = periods·2π/ω; a prescribed period is ΣT.
    fn equations(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
        closing: Option<&mut Matrix>,
    ) -> Result<(), OrbitFailure> {
        let at = self.at(point)?;
        let Scales { states, time, .. } = &self.setting.scales;
        let (width, count) = (self.width(), self.zones());
        let n = states.len();
        residual[..self.unknowns_of_zones()].fill(0.0);
        let mut equations = Filled {
            at: &at,
            residual,
            jacobian,
            closing,
        };
        for zone in 0..count {
            for shot in 0..self.shots(zone) - 1 {
                equations.add_shot(zone, &at.shot(zone, shot, at.share(zone))?);
            }
            let passage = at.passage(zone, at.zones[zone].duration)?;
            equations.add_entry(zone, &passage);
            let row = width * zone + n;
            let mode = &at.posed.system.modes[self.sequence.zone(zone).mode];
            if let Some(way) = self.sequence.zone(zone).way {
                let guard = &mode.guards[way.guard].row;
                let order = at.divided(zone);
                let [divided, _] = passage.divided(guard, order);
                let factor = time.powi(order as i32) / self.size(guard);
                equations.add(row, zone, &divided, factor);
            } else if let Some(index) = self.phase_index() {
                equations.residual[row] = point[index];
                equations.jacobian[(row, index)] = 1.0;
            } else {
                let rate = mode.matrix.row(self.section(mode));
                let factor = self.size(&rate).recip();
                equations.add(row, zone, &at.at_entry(zone, &rate, 0), factor);
            }
        }
        if let Some(index) = self.phase_index() {
            equations.add_forced_period(index);
        }
        if let (Some(index), Some(prescribed)) = (self.free_index(), &self.setting.prescribed) {
            equations.add_prescribed_period(index, prescribed)?;
        }
        Ok(())
    }
}
