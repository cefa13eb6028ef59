//! Waves of the tube over a plane of two parameters.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::plane::{Condition, NotEvaluated, Plane, Test};
use super::point::{PointType, What};
use crate::branch::run::RunError;
use crate::linalg::Vector;
use crate::orbit::EventType;
use crate::tube::flow::FlowError;
use crate::tube::flow::method::Method;
use crate::tube::model::signature::Signature;
use crate::tube::model::{Model, Parameter};
use crate::tube::stability::characteristic::{Characteristic, NotLinearised};
use crate::tube::stability::spectrum::symmetric;
use crate::tube::wave::admissibility::{Examination, Margin, Watch};
use crate::tube::wave::{Scales, Wave, width};

/// ω in units of the frequency of the wave below which it counts as zero. Parameters are even in ω:
/// the point found lies 1e-8 from the limit.
const LEAST_OMEGA: f64 = 1e-4;

/// All that a wave needs beside its signature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tube {
    #[serde(with = "crate::tube::model::saved")]
    model: Model,
    parameters: [Parameter; 2],
    widths: [f64; 2],
    mode: u32,
    scales: Scales,
    method: Method,
    material: bool,
}

/// A pair ±iω in a Bloch sector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hopf {
    /// Sector.
    pub sector: usize,
}

impl Tube {
    /// That of a solved wave. `widths` are the units of the parameters.
    pub fn new(wave: &Wave, point: &Vector, parameters: [Parameter; 2], widths: [f64; 2]) -> Tube {
        Tube {
            model: wave.model_at(point),
            parameters,
            widths,
            mode: wave.mode,
            scales: wave.scales,
            method: wave.method,
            material: wave.material || parameters.contains(&Parameter::StiffnessDamping),
        }
    }

    /// Unit of ω: the frequency of the first wave.
    pub fn frequency(&self) -> f64 {
        std::f64::consts::TAU / self.scales.time
    }
}

impl Plane for Tube {
    type Orbit = Wave;
    type Watch = Watch;
    type Spectral = Hopf;
    type NotLinearised = NotLinearised;
    type NoBranch = RunError;

    const FOLLOWED: &'static [EventType] = &[
        EventType::LP,
        EventType::GR,
        EventType::RV,
        EventType::CO,
        EventType::ST,
        EventType::HB,
    ];
    const MEASURE: &'static str = "speed";
    const ANGULAR: &'static str = "omega";
    const SYMBOL: &'static str = "ω";
    const HAS_SECTORS: bool = true;

    fn parameters(&self) -> [Parameter; 2] {
        self.parameters
    }

    fn widths(&self) -> [f64; 2] {
        self.widths
    }

    fn values(&self) -> [f64; 2] {
        self.parameters
            .map(|parameter| self.model.value(parameter).unwrap_or(f64::NAN))
    }

    fn is_bounded(&self, index: usize) -> bool {
        self.parameters[index] == Parameter::StiffnessDamping
    }

    fn unknowns(&self, signature: &Signature) -> usize {
        width(self.material, signature) * signature.len() + 1
    }

    fn zones(signature: &Signature) -> usize {
        signature.len()
    }

    fn orbit(
        &self,
        signature: &Signature,
        [first, second]: [f64; 2],
        index: usize,
    ) -> Result<Wave, FlowError> {
        let model = self
            .model
            .with(self.parameters[0], first)
            .with(self.parameters[1], second);
        let scales = Scales {
            parameter: self.widths[index],
            ..self.scales
        };
        let parameter = self.parameters[index];
        let wave = Wave::new(model, parameter, self.mode, signature.clone(), scales);
        Ok(wave.with_method(self.method).with_material(self.material))
    }

    fn key(margin: &Margin) -> (Watch, usize) {
        (margin.watch, margin.zone)
    }

    fn zone(signature: &Signature, zone: usize) -> String {
        signature.zone(zone).regime.name().to_owned()
    }

    fn length(wave: &Wave, point: &Vector, zone: usize) -> f64 {
        wave.duration_at(point, zone) * wave.speed_at(point).abs()
    }

    fn name(wave: &Wave, _: &Vector) -> String {
        wave.signature.to_string()
    }

    fn measure(wave: &Wave, point: &Vector) -> (f64, Option<f64>) {
        (wave.speed_at(point), Some(wave.excess_at(point)))
    }

    fn further(_: &Hopf) -> usize {
        1
    }

    /// F_j(iω), in sector 0 divided by iω: there λ = 0 is an eigenvalue of every wave, translation.
    fn spectral(
        &self,
        spectral: &Hopf,
        wave: &Wave,
        point: &Vector,
        further: &[f64],
    ) -> Result<Vec<f64>, NotEvaluated<Tube>> {
        let linear = NotEvaluated::Linear;
        let characteristic = Characteristic::new(wave, point).map_err(linear)?;
        let lambda = Complex::new(0.0, further[0] * self.frequency());
        let (value, _) = characteristic
            .evaluate(lambda)
            .sector(characteristic.multiplier(spectral.sector));
        let value = match spectral.sector {
            0 => value / Complex::new(0.0, further[0]),
            _ => value,
        };
        Ok(vec![value.re, value.im])
    }

    fn angular(&self, _: &Hopf, _: &Wave, _: &Vector, further: &[f64]) -> Option<f64> {
        further.first().map(|scaled| scaled * self.frequency())
    }

    fn sector(spectral: &Hopf) -> Option<usize> {
        Some(spectral.sector)
    }

    /// ω where the pair may meet on the real axis. It is positive there.
    fn tests(
        &self,
        condition: &Condition<Tube>,
        _: &Wave,
        _: &Vector,
        further: &[f64],
        _: &Examination,
    ) -> Vec<Test> {
        match condition {
            Condition::Spectral(Hopf { sector }) if symmetric(*sector, self.mode) => vec![Test {
                kind: Some(PointType::BT),
                value: further[0] - LEAST_OMEGA,
                ends: true,
            }],
            _ => Vec::new(),
        }
    }

    fn say(what: &What<Wave>) -> String {
        what.to_string()
    }
}
