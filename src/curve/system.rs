//! An event as a system of equations: the wave, and the condition that makes it special.
//!
//! With F(x, p₁, p₂) = 0 the equations of a wave in its entry states, durations and ln e,
//!
//! | event | further unknowns | further equations |
//! |---|---|---|
//! | GR, RV, CO, ST | | m(x, p₁, p₂) = 0, the margin that vanishes |
//! | LP | v | F_x v = 0, (v·v − 1)/2 = 0 |
//! | HB | ω | Re F_j(iω) = Im F_j(iω) = 0 |
//!
//! (Moore and Spence for the fold; F_j is the characteristic function of Bloch sector j.) A wave is
//! posed in one parameter: posed in p₁ it gives all columns but the last, posed in p₂ the last.
//!
//! Derivatives of F and m are exact. Those of F_x v and of F_j in x, p₁, p₂ are central differences:
//! they bend the way of Newton's iterates and not the equations, which are exact.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::continuation::newton::{Constraint, System};
use crate::flow::FlowError;
use crate::flow::method::Method;
use crate::linalg::{Matrix, Vector};
use crate::model::signature::Signature;
use crate::model::{Model, Parameter};
use crate::stability::characteristic::{Characteristic, NotLinearised};
use crate::wave::admissibility::{AtZero, Margin};
use crate::wave::width;
use crate::wave::{Scales, Wave};

/// Step of central differences in scaled unknowns of order one: truncation and rounding both stay
/// near 1e-10 of the derivative, far below what keeps Newton's convergence fast.
const DIFFERENCE: f64 = 1e-5;

/// What makes the wave special.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Condition {
    /// A margin vanishes.
    Margin(Margin),
    /// Fold in either parameter.
    Fold,
    /// A pair ±iω in a Bloch sector.
    Hopf {
        /// Sector.
        sector: usize,
    },
}

/// Why the equations could not be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum NotEvaluated {
    /// The flow overflows or the wave is subsonic.
    #[error("{0}")]
    Flow(#[from] FlowError),
    /// There is no eigenfunction problem.
    #[error("{0}")]
    Linear(#[from] NotLinearised),
}

/// The equations of an event in two parameters. Unknowns: the wave's without its parameter, those of
/// the condition, both parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventSystem {
    #[serde(with = "crate::model::saved")]
    model: Model,
    parameters: [Parameter; 2],
    widths: [f64; 2],
    mode: u32,
    signature: Signature,
    scales: Scales,
    method: Method,
    material: bool,
    /// The condition; the place of an interior margin follows the curve.
    pub condition: Condition,
}

impl EventSystem {
    /// The event at a solved wave. `widths` are the units of the parameters.
    pub fn new(
        wave: &Wave,
        point: &Vector,
        parameters: [Parameter; 2],
        widths: [f64; 2],
        condition: Condition,
    ) -> EventSystem {
        EventSystem {
            model: wave.model_at(point),
            parameters,
            widths,
            mode: wave.mode,
            signature: wave.signature.clone(),
            scales: wave.scales,
            method: wave.method,
            material: wave.material || parameters.contains(&Parameter::StiffnessDamping),
            condition,
        }
    }

    /// The same plane and model with another signature and condition.
    pub fn of(&self, signature: Signature, condition: Condition) -> EventSystem {
        EventSystem {
            signature,
            condition,
            ..self.clone()
        }
    }

    /// Signature of the wave.
    pub fn signature(&self) -> &Signature {
        &self.signature
    }

    /// Number of unknowns of the wave, its parameter left out.
    pub(crate) fn wave_unknowns(&self) -> usize {
        width(self.material, &self.signature) * self.signature.len() + 1
    }

    /// Whether these can be unknowns of the event.
    pub fn fits(&self, point: &Vector) -> bool {
        let zone = match self.condition {
            Condition::Margin(margin) => margin.zone,
            _ => 0,
        };
        zone < self.signature.len()
            && point.len() == self.unknowns()
            && point.iter().all(|value| value.is_finite())
    }

    /// Both parameters at a point, in physical units.
    pub fn values(&self, point: &Vector) -> [f64; 2] {
        let count = point.len();
        [
            point[count - 2] * self.widths[0],
            point[count - 1] * self.widths[1],
        ]
    }

    /// The two parameters.
    pub fn parameters(&self) -> [Parameter; 2] {
        self.parameters
    }

    /// Units of the parameters.
    pub fn widths(&self) -> [f64; 2] {
        self.widths
    }

    /// Unit of ω: the frequency of the first wave.
    pub fn frequency(&self) -> f64 {
        std::f64::consts::TAU / self.scales.time
    }

    /// ω at a point of a Hopf curve.
    pub fn omega(&self, point: &Vector) -> Option<f64> {
        match self.condition {
            Condition::Hopf { .. } => Some(point[self.wave_unknowns()] * self.frequency()),
            _ => None,
        }
    }

    /// The wave posed in one of the two parameters, and its unknowns at a point.
    pub fn wave(&self, point: &Vector, index: usize) -> (Wave, Vector) {
        let [first, second] = self.values(point);
        let model = self
            .model
            .with(self.parameters[0], first)
            .with(self.parameters[1], second);
        let scales = Scales {
            parameter: self.widths[index],
            ..self.scales
        };
        let wave = Wave::new(
            model,
            self.parameters[index],
            self.mode,
            self.signature.clone(),
            scales,
        )
        .with_method(self.method)
        .with_material(self.material);
        let mut own = point.rows(0, self.wave_unknowns() + 1).clone_owned();
        own[self.wave_unknowns()] = point[point.len() - 2 + index];
        (wave, own)
    }

    /// Unknowns of the event from those of a wave; `further` are those of the condition.
    pub fn pack(&self, wave: &Vector, further: &[f64]) -> Vector {
        let count = self.wave_unknowns();
        let mut point: Vec<f64> = wave.iter().take(count).copied().collect();
        point.extend(further);
        for (parameter, width) in self.parameters.iter().zip(self.widths) {
            point.push(self.model.value(*parameter).unwrap_or(f64::NAN) / width);
        }
        Vector::from_vec(point)
    }

    /// F and its derivatives in x, p₁, p₂.
    pub(crate) fn wave_equations(&self, point: &Vector) -> Result<(Vector, Matrix), FlowError> {
        let count = self.wave_unknowns();
        let mut residual = Vector::zeros(count);
        let mut all = Matrix::zeros(count, count + 2);
        for index in 0..2 {
            let (wave, own) = self.wave(point, index);
            let mut matrix = Matrix::zeros(count, count + 1);
            wave.evaluate(&own, residual.as_mut_slice(), &mut matrix)?;
            if index == 0 {
                all.columns_mut(0, count)
                    .copy_from(&matrix.columns(0, count));
            }
            all.column_mut(count + index)
                .copy_from(&matrix.column(count));
        }
        Ok((residual, all))
    }

    /// F_j(iω), in sector 0 divided by iω: there λ = 0 is an eigenvalue of every wave, translation.
    pub fn characteristic(
        &self,
        point: &Vector,
        sector: usize,
    ) -> Result<Complex<f64>, NotEvaluated> {
        let (wave, own) = self.wave(point, 0);
        let characteristic = Characteristic::new(&wave, &own)?;
        let scaled = point[self.wave_unknowns()];
        let lambda = Complex::new(0.0, scaled * self.frequency());
        let (value, _) = characteristic
            .evaluate(lambda)
            .sector(characteristic.multiplier(sector));
        Ok(match sector {
            0 => value / Complex::new(0.0, scaled),
            _ => value,
        })
    }

    /// Follows the place of an interior margin to a new point of the curve.
    pub fn settle(&mut self, point: &Vector) {
        if let Condition::Margin(margin) = self.condition {
            let (wave, own) = self.wave(point, 0);
            let mut at = AtZero { margin };
            if let Ok(here) = at.margin_at(&wave, &own) {
                self.condition = Condition::Margin(here);
            }
        }
    }
}

impl System for EventSystem {
    type Failure = NotEvaluated;

    fn unknowns(&self) -> usize {
        let count = self.wave_unknowns();
        match self.condition {
            Condition::Margin(_) => count + 2,
            Condition::Fold => 2 * count + 2,
            Condition::Hopf { .. } => count + 3,
        }
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), NotEvaluated> {
        let count = self.wave_unknowns();
        let last = self.unknowns() - 2;
        let (value, by) = self.wave_equations(point)?;
        residual[..count].copy_from_slice(value.as_slice());
        jacobian
            .view_mut((0, 0), (count, count))
            .copy_from(&by.columns(0, count));
        jacobian
            .view_mut((0, last), (count, 2))
            .copy_from(&by.columns(count, 2));
        match self.condition {
            Condition::Margin(margin) => {
                for index in 0..2 {
                    let (wave, own) = self.wave(point, index);
                    let mut gradient = vec![0.0; count + 1];
                    residual[count] = AtZero { margin }.evaluate(&wave, &own, &mut gradient)?;
                    for (column, entry) in gradient.iter().take(count).enumerate() {
                        jacobian[(count, column)] = *entry;
                    }
                    jacobian[(count, last + index)] = gradient[count];
                }
            }
            Condition::Fold => {
                let null = point.rows(count, count).clone_owned();
                let linear = by.columns(0, count);
                residual[count..2 * count].copy_from_slice((linear * &null).as_slice());
                residual[2 * count] = 0.5 * (null.norm_squared() - 1.0);
                // ∂(F_x v)/∂(x, p) is the derivative of (F_x, F_p) along v
                let moved = |sign: f64| {
                    let mut there = point.clone();
                    for index in 0..count {
                        there[index] += sign * DIFFERENCE * null[index];
                    }
                    self.wave_equations(&there).map(|(_, by)| by)
                };
                let second = (moved(1.0)? - moved(-1.0)?) / (2.0 * DIFFERENCE);
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
            }
            Condition::Hopf { sector } => {
                let value = self.characteristic(point, sector)?;
                residual[count] = value.re;
                residual[count + 1] = value.im;
                for column in 0..self.unknowns() {
                    let moved = |step: f64| {
                        let mut there = point.clone();
                        there[column] += step;
                        self.characteristic(&there, sector)
                    };
                    // β has no values below zero: there the difference is one-sided
                    let is_beta = column >= last
                        && self.parameters[column - last] == Parameter::StiffnessDamping;
                    let down = if is_beta && point[column] < DIFFERENCE {
                        0.0
                    } else {
                        DIFFERENCE
                    };
                    let slope = (moved(DIFFERENCE)? - moved(-down)?) / (DIFFERENCE + down);
                    jacobian[(count, column)] = slope.re;
                    jacobian[(count + 1, column)] = slope.im;
                }
            }
        }
        Ok(())
    }
}
