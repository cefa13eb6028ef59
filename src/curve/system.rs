//! An event as a system of equations: the wave, and the condition that makes it special.
//!
//! With F(x, p₁, p₂) = 0 the equations of an orbit, of a wave in its entry states, durations and ln e,
//!
//! | event | further unknowns | further equations |
//! |---|---|---|
//! | GR, RV, CO, ST, SL | | m(x, p₁, p₂) = 0, the margin that vanishes |
//! | UZ of a monitor | | n(x, p₁, p₂) = n₀ |
//! | LP | v | F_x v = 0, (v·v − 1)/2 = 0 |
//! | HB | ω | Re F_j(iω) = Im F_j(iω) = 0 |
//! | PD | v | (F_x − 2C)v = 0, (v·v − 1)/2 = 0 |
//! | NS | | ∏(1 − μᵢμⱼ) = 0 over pairs |
//! | BP of a symmetric orbit | | det(H + 1) = 0; F of half the orbit, which closes at its image |
//! | HC of a saddle | a | what arrives of its growing directions, [`crate::affine::connection`] |
//!
//! Where an orbit that is its own image half a period later meets a GR, CO or SL its image meets it, too, and F is that of half the
//! orbit, as for a BP. (Moore and Spence for the fold; C is the part of F_x that belongs to the beginning of the next period, where a
//! perturbation that doubles has the other sign: F_x − 2C is singular where F_x of the orbit traversed twice has a null
//! vector (v, −v); F_j is the characteristic function of Bloch sector j, M the linearised motion
//! over a period with the multipliers μ, H that over half of it with the image at its end.) An orbit is posed in one parameter: posed in p₁ it gives all columns but
//! the last, posed in p₂ the last.
//!
//! Equilibria have extended systems of their own ([`ParameterPlane::extended`]), with exact derivatives in all unknowns.
//!
//! Derivatives of F, m and n are exact. Those of F_x v are one-sided differences, those of F_j, of H and of what arrives at a saddle in x, p₁, p₂ central
//! ones, and so are those of a pair μ of M, without switches along its null vectors only: they bend the way of Newton's
//! iterates and not the equations, which are exact.

use serde::{Deserialize, Serialize};

use super::null_pair::NullPair;
use super::plane::{
    EventCondition, FailureOf, MarginOf, NotEvaluated, ParameterOf, ParameterPlane, SignatureOf,
    TestValues,
};
use super::tube::WavesInPlane;
use crate::continuation::Node;
use crate::continuation::locate::retangent;
use crate::continuation::newton::{Constraint, Equations};
use crate::linalg::{Matrix, Vector};
use crate::orbit::monitor::MonitorStop;
use crate::orbit::{AtZero, CoordinateChanges, Monitored, Zones};

/// Step of central differences along a null vector in scaled unknowns of order one: as [`ParameterPlane::difference`].
const DIFFERENCE: f64 = 1e-5;

/// Step of the one-sided difference along a null vector, at half the price: truncation leaves 1e-7 of the derivative, rounding
/// of an integrated flow 1e-6 at most, by which the error of an iterate falls.
const ALONG: f64 = 1e-7;

/// The equations of an event in two parameters. Unknowns: the orbit's without its parameter, those of
/// the condition, both parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct EventSystem<P: ParameterPlane = WavesInPlane> {
    /// The orbits.
    pub plane: P,
    signature: SignatureOf<P>,
    /// The condition; the place of an interior margin follows the curve.
    pub condition: EventCondition<P>,
}

impl<P: ParameterPlane> EventSystem<P> {
    /// The event of an orbit of this signature.
    pub fn new(
        plane: P,
        signature: SignatureOf<P>,
        condition: EventCondition<P>,
    ) -> EventSystem<P> {
        EventSystem {
            plane,
            signature,
            condition,
        }
    }

    /// The same plane with another signature and condition.
    pub fn of(&self, signature: SignatureOf<P>, condition: EventCondition<P>) -> EventSystem<P> {
        EventSystem {
            signature,
            condition,
            plane: self.plane.clone(),
        }
    }

    /// Signature of the orbit.
    pub fn signature(&self) -> &SignatureOf<P> {
        &self.signature
    }

    /// Number of unknowns of the orbit, its parameter left out.
    pub(crate) fn orbit_unknowns(&self) -> usize {
        self.plane.unknowns(&self.signature)
    }

    /// Whether these can be unknowns of the event.
    pub fn fits(&self, point: &Vector) -> bool {
        let zone = match &self.condition {
            EventCondition::Margin(margin) => P::key(margin).1,
            _ => 0,
        };
        zone < P::zones(&self.signature)
            && point.len() == self.unknowns()
            && point.iter().all(|value| value.is_finite())
    }

    /// Both parameters at a point, in physical units.
    pub fn values(&self, point: &Vector) -> [f64; 2] {
        let (count, widths) = (point.len(), self.widths());
        [point[count - 2] * widths[0], point[count - 1] * widths[1]]
    }

    /// The two parameters.
    pub fn parameters(&self) -> [ParameterOf<P>; 2] {
        self.plane.parameters()
    }

    /// Units of the parameters.
    pub fn widths(&self) -> [f64; 2] {
        self.plane.widths()
    }

    /// Further unknowns of an event of the spectrum.
    pub(super) fn further<'a>(&self, point: &'a Vector) -> &'a [f64] {
        let count = self.orbit_unknowns();
        match &self.condition {
            EventCondition::Spectral(spectral) if !P::is_doubling(spectral) => {
                &point.as_slice()[count..count + P::further(spectral)]
            }
            _ => &[],
        }
    }

    /// Frequency or angle of an event of the spectrum.
    pub fn angular(&self, point: &Vector) -> Option<f64> {
        let EventCondition::Spectral(spectral) = &self.condition else {
            return None;
        };
        let (orbit, own) = self.orbit(point, 0).ok()?;
        self.plane
            .angular(spectral, &orbit, &own, self.further(point))
    }

    /// The orbit posed in one of the two parameters, and its unknowns at a point.
    ///
    /// # Errors
    /// The system makes no sense there.
    pub fn orbit(&self, point: &Vector, index: usize) -> Result<(P::Orbit, Vector), FailureOf<P>> {
        let values = self.values(point);
        let orbit = self.plane.orbit(&self.signature, values, index)?;
        let count = self.orbit_unknowns();
        let mut own = point.rows(0, count + 1).clone_owned();
        own[count] = point[point.len() - 2 + index];
        Ok((orbit, own))
    }

    /// Unknowns of the event from those of an orbit; `further` are those of the condition.
    pub fn pack(&self, orbit: &Vector, further: &[f64]) -> Vector {
        let count = self.orbit_unknowns();
        let mut point: Vec<f64> = orbit.iter().take(count).copied().collect();
        point.extend(further);
        for (value, width) in self.plane.values().iter().zip(self.widths()) {
            point.push(value / width);
        }
        Vector::from_vec(point)
    }

    /// F and its derivatives in x, p₁, p₂.
    pub(crate) fn orbit_equations(&self, point: &Vector) -> Result<(Vector, Matrix), FailureOf<P>> {
        let count = self.orbit_unknowns();
        let mut residual = Vector::zeros(count);
        let mut all = Matrix::zeros(count, count + 2);
        for index in 0..2 {
            let (orbit, own) = self.orbit(point, index)?;
            let mut matrix = Matrix::zeros(count, count + 1);
            orbit.evaluate(&own, residual.as_mut_slice(), &mut matrix)?;
            let equations = (residual.as_mut_slice(), &mut matrix);
            self.plane
                .restrict(&self.condition, &orbit, &own, equations)?;
            if index == 0 {
                all.columns_mut(0, count)
                    .copy_from(&matrix.columns(0, count));
            }
            all.column_mut(count + index)
                .copy_from(&matrix.column(count));
        }
        Ok((residual, all))
    }

    /// Whether the condition is a null vector of the equations over a period.
    fn has_null_vector(&self) -> bool {
        match &self.condition {
            EventCondition::Fold => true,
            EventCondition::Spectral(spectral) => P::is_doubling(spectral),
            EventCondition::Margin(_) | EventCondition::Constant(_) => false,
        }
    }

    /// (F_x, F_p₁, F_p₂) as the null vector of the condition sees them, from those of the orbit.
    fn linearised(&self, point: &Vector, by: &Matrix) -> Result<Matrix, FailureOf<P>> {
        match &self.condition {
            EventCondition::Fold => Ok(by.clone()),
            _ => Ok(by - self.closing(point)? * 2.0),
        }
    }

    /// What of (F_x, F_p₁, F_p₂) is that of the beginning of the next period.
    fn closing(&self, point: &Vector) -> Result<Matrix, FailureOf<P>> {
        let count = self.orbit_unknowns();
        let mut all = Matrix::zeros(count, count + 2);
        for index in 0..2 {
            let (orbit, own) = self.orbit(point, index)?;
            let closing = P::closing(&orbit, &own)?;
            if index == 0 {
                all.columns_mut(0, count)
                    .copy_from(&closing.columns(0, count));
            }
            all.column_mut(count + index)
                .copy_from(&closing.column(count));
        }
        Ok(all)
    }

    /// Derivatives of the equation of an event of the spectrum by those of its critical multipliers: with
    /// N = F_x + (μ − 1)C, Nv = 0 and wᴴN = 0 it is wᴴCv·∂μ = −wᴴ(D_v F_u + (μ − 1)D_v C_u), u = (x, p), where D_v is the
    /// derivative along v. `None` where the plane has none, or where one is a double one or nearly so.
    fn gradient_of_multipliers(
        &self,
        spectral: &P::Spectral,
        point: &Vector,
        by: &Matrix,
    ) -> Option<Vec<f64>> {
        let (orbit, own) = self.orbit(point, 0).ok()?;
        let critical = self.plane.critical(spectral, &orbit, &own)?;
        let closing = self.closing(point).ok()?;
        let mut gradient = vec![0.0; by.ncols()];
        for (multiplier, weight) in critical {
            let pair = NullPair::new(by, &closing, multiplier)?;
            let along = |direction: &Vector| self.along(point, direction);
            let slopes = pair.slopes(&closing, multiplier, along)?;
            for (sum, slope) in gradient.iter_mut().zip(slopes) {
                *sum += (weight * slope).re;
            }
        }
        Some(gradient)
    }

    /// Derivatives of (F_x, F_p₁, F_p₂) and of what of them is that of the beginning of the next period, along a
    /// direction in x.
    fn along(&self, point: &Vector, direction: &Vector) -> Option<[Matrix; 2]> {
        let at = |step: f64| {
            let mut there = point.clone();
            let mut states = there.rows_mut(0, direction.len());
            states.axpy(step, direction, 1.0);
            let (_, by) = self.orbit_equations(&there).ok()?;
            Some([by, self.closing(&there).ok()?])
        };
        let ([by, closing], [by_below, closing_below]) = (at(DIFFERENCE)?, at(-DIFFERENCE)?);
        let slope = |above: Matrix, below: Matrix| (above - below) / (2.0 * DIFFERENCE);
        Some([slope(by, by_below), slope(closing, closing_below)])
    }

    /// Derivatives of the equations of an event of the spectrum by differences in every unknown, one row for each.
    fn differences(
        &self,
        spectral: &P::Spectral,
        point: &Vector,
    ) -> Result<Vec<Vec<f64>>, NotEvaluated<P>> {
        let unknowns = self.unknowns();
        let mut gradients = vec![vec![0.0; unknowns]; unknowns - 1 - self.orbit_unknowns()];
        let first = match P::is_of_orbit(spectral) {
            true => 0,
            false => self.orbit_unknowns(),
        };
        let apart = P::difference(spectral);
        for column in first..unknowns {
            let moved = |step: f64| {
                let mut there = point.clone();
                there[column] += step;
                self.spectral(spectral, &there)
            };
            // some parameters have no values below zero: there the difference is one-sided
            let parameter = column.checked_sub(unknowns - 2);
            let bounded = parameter.is_some_and(|index| self.plane.is_bounded(index));
            let down = if bounded && point[column] < apart {
                0.0
            } else {
                apart
            };
            let ends = moved(apart)?.into_iter().zip(moved(-down)?);
            for (gradient, (above, below)) in gradients.iter_mut().zip(ends) {
                gradient[column] = (above - below) / (apart + down);
            }
        }
        Ok(gradients)
    }

    /// The equations of an event of the spectrum.
    fn spectral(
        &self,
        spectral: &P::Spectral,
        point: &Vector,
    ) -> Result<Vec<f64>, NotEvaluated<P>> {
        let (orbit, own) = self.orbit(point, 0).map_err(NotEvaluated::Flow)?;
        self.plane
            .spectral(spectral, &orbit, &own, self.further(point))
    }

    /// What the plane watches at a point, and the orbit there.
    pub(super) fn watched(&self, point: &Vector, (orbit, own): &(P::Orbit, Vector)) -> TestValues {
        let further = self.further(point);
        self.plane.watched(&self.condition, orbit, own, further)
    }

    /// A node of the same point with other further unknowns, its tangent the same way; `None` where it has no tangent.
    pub(super) fn with_further(&self, node: &Node, further: &[f64]) -> Option<Node> {
        let (mut point, mut along) = (node.point.clone(), node.tangent.clone());
        let count = self.orbit_unknowns();
        for (index, value) in further.iter().enumerate() {
            point[count + index] = *value;
        }
        // states and parameters go on as they did
        along.rows_mut(count, further.len()).fill(0.0);
        retangent(self, &point, &along, node.newton)
    }

    /// The same event and a node of it in the unknowns of renewed orbits.
    pub(super) fn renewed(
        &self,
        orbit: &P::Orbit,
        renewed: &P::Orbit,
        node: &Node,
    ) -> Option<(EventSystem<P>, Node)> {
        let count = self.orbit_unknowns();
        let (_, own) = self.orbit(&node.point, 0).ok()?;
        let carried = |direction: &[f64]| {
            let mut along = Vector::zeros(own.len());
            along.rows_mut(0, count).copy_from_slice(direction);
            orbit.carried(renewed, &Node::at(own.clone(), along))
        };
        let last = node.point.len() - 2;
        let tangent = carried(&node.tangent.as_slice()[..count])?;
        // a null vector is carried as any perturbation is, and has the length 1 again
        let further = &node.point.as_slice()[count..last];
        let further = match self.has_null_vector() {
            true => {
                let null = carried(further)?.tangent;
                let null = null.rows(0, null.len() - 1).normalize();
                null.as_slice().to_vec()
            }
            false => further.to_vec(),
        };
        let system = self.of(renewed.signature().clone(), self.condition.clone());
        let unknowns = system.orbit_unknowns();
        let point = |orbit: &Vector, further: &[f64], from: &Vector| {
            let parts = orbit.iter().take(unknowns).chain(further);
            let all = parts.chain(from.rows(last, 2).iter()).copied().collect();
            Vector::from_vec(all)
        };
        let nothing = vec![0.0; further.len()];
        // where shots begin a tangent of the orbit alone, at fixed parameters, goes another way than one of the curve
        let along = point(&renewed.tangent_of_zones(&tangent), &nothing, &node.tangent);
        let point = point(&tangent.point, &further, &node.point);
        let node = retangent(&system, &point, &along, node.newton)?;
        Some((system, node))
    }

    /// Follows the place of an interior margin, or what normalises further unknowns, to a new point of the curve.
    pub fn settle(&mut self, point: &Vector) {
        let further = self.further(point);
        if let EventCondition::Spectral(mut spectral) = self.condition.clone()
            && let Ok((orbit, own)) = self.orbit(point, 0)
        {
            self.plane.settle(&mut spectral, &orbit, &own, further);
            self.condition = EventCondition::Spectral(spectral);
        }
        if let EventCondition::Margin(margin) = &self.condition
            && let Ok((orbit, own)) = self.orbit(point, 0)
        {
            let mut at = AtZero {
                margin: margin.clone(),
            };
            if let Ok(here) = at.margin_at(&orbit, &own) {
                self.condition = EventCondition::Margin(here.clone());
            }
        }
    }
}

/// The equations that single out the event, behind those of the orbit.
impl<P: ParameterPlane> EventSystem<P> {
    /// A margin is zero.
    fn margin_equation(
        &self,
        margin: &MarginOf<P>,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), NotEvaluated<P>> {
        let count = self.orbit_unknowns();
        let last = self.unknowns() - 2;
        for index in 0..2 {
            let (orbit, own) = self.orbit(point, index).map_err(NotEvaluated::Flow)?;
            let mut gradient = vec![0.0; count + 1];
            let mut at = AtZero {
                margin: margin.clone(),
            };
            let value = at.evaluate(&orbit, &own, &mut gradient);
            residual[count] = value.map_err(NotEvaluated::Flow)?;
            for (column, entry) in gradient.iter().take(count).enumerate() {
                jacobian[(count, column)] = *entry;
            }
            jacobian[(count, last + index)] = gradient[count];
        }
        Ok(())
    }

    /// A monitor has its value, in the unit of its largest derivative.
    fn constant_equation(
        &self,
        stop: &MonitorStop,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), NotEvaluated<P>> {
        let count = self.orbit_unknowns();
        let last = self.unknowns() - 2;
        let mut unit = None;
        for index in 0..2 {
            let (orbit, own) = self.orbit(point, index).map_err(NotEvaluated::Flow)?;
            let measured = orbit.measured(stop.monitor, &own);
            let Some(measured) = measured.map_err(NotEvaluated::Flow)? else {
                residual[count] = f64::NAN;
                break;
            };
            let unit = *unit.get_or_insert_with(|| measured.slope());
            residual[count] = (measured.value - stop.value) / unit;
            let columns = measured.gradient.iter().enumerate();
            for (column, entry) in columns.take(count) {
                jacobian[(count, column)] = entry / unit;
            }
            jacobian[(count, last + index)] = measured.gradient[count] / unit;
        }
        Ok(())
    }

    /// F_x v = 0 and |v|² = 1 for the null vector v; of a doubling F_x is linearised about the orbit traversed twice.
    fn null_vector_equations(
        &self,
        point: &Vector,
        by: &Matrix,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), NotEvaluated<P>> {
        let flow = NotEvaluated::Flow;
        let count = self.orbit_unknowns();
        let last = self.unknowns() - 2;
        let null = point.rows(count, count).clone_owned();
        let seen = self.linearised(point, by).map_err(flow)?;
        let linear = seen.columns(0, count);
        residual[count..2 * count].copy_from_slice((linear * &null).as_slice());
        residual[2 * count] = 0.5 * (null.norm_squared() - 1.0);
        // ∂(F_x v)/∂(x, p) is the derivative of (F_x, F_p) along v
        let mut there = point.clone();
        for index in 0..count {
            there[index] += ALONG * null[index];
        }
        let (_, moved) = self.orbit_equations(&there).map_err(flow)?;
        let moved = self.linearised(&there, &moved).map_err(flow)?;
        let second = (moved - &seen) / ALONG;
        jacobian
            .view_mut((count, 0), (count, count))
            .copy_from(&second.columns(0, count));
        jacobian
            .view_mut((count, count), (count, count))
            .copy_from(&linear);
        jacobian
            .view_mut((count, last), (count, 2))
            .copy_from(&second.columns(count, 2));
        for index in 0..count {
            jacobian[(2 * count, count + index)] = null[index];
        }
        Ok(())
    }
}

impl<P: ParameterPlane> Equations for EventSystem<P> {
    type Failure = NotEvaluated<P>;

    fn unknowns(&self) -> usize {
        let count = self.orbit_unknowns();
        match &self.condition {
            _ if self.has_null_vector() => 2 * count + 2,
            EventCondition::Spectral(spectral) => count + P::further(spectral) + 2,
            _ => count + 2,
        }
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), NotEvaluated<P>> {
        let equations = (&mut *residual, &mut *jacobian);
        let whole = self
            .plane
            .extended(&self.signature, &self.condition, point, equations);
        if let Some(evaluated) = whole {
            return evaluated.map_err(NotEvaluated::Flow);
        }
        let count = self.orbit_unknowns();
        let last = self.unknowns() - 2;
        let (value, by) = self.orbit_equations(point).map_err(NotEvaluated::Flow)?;
        residual[..count].copy_from_slice(value.as_slice());
        jacobian
            .view_mut((0, 0), (count, count))
            .copy_from(&by.columns(0, count));
        jacobian
            .view_mut((0, last), (count, 2))
            .copy_from(&by.columns(count, 2));
        match &self.condition {
            EventCondition::Margin(margin) => {
                self.margin_equation(margin, point, residual, jacobian)
            }
            EventCondition::Constant(stop) => {
                self.constant_equation(stop, point, residual, jacobian)
            }
            EventCondition::Spectral(spectral) if !P::is_doubling(spectral) => {
                let value = self.spectral(spectral, point)?;
                residual[count..].copy_from_slice(&value);
                let gradients = match self.gradient_of_multipliers(spectral, point, &by) {
                    Some(gradient) => vec![gradient],
                    None => self.differences(spectral, point)?,
                };
                for (row, gradient) in gradients.iter().enumerate() {
                    for (column, entry) in gradient.iter().enumerate() {
                        jacobian[(count + row, column)] = *entry;
                    }
                }
                Ok(())
            }
            _ => self.null_vector_equations(point, &by, residual, jacobian),
        }
    }
}
