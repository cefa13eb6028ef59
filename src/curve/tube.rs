//! Waves of the tube over a plane of two parameters.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::plane::{
    EventCondition, EventCurves, NotEvaluated, PlaneNames, PlaneOfOrbits, SpectralEvents, Test,
    TestValues,
};
use super::point::{PointType, RegionName, What};
use crate::branch::run::RunError;
use crate::linalg::Vector;
use crate::orbit::EventType;
use crate::tube::flow::FlowError;
use crate::tube::flow::method::Method;
use crate::tube::model::signature::Signature;
use crate::tube::model::{Model, Parameter};
use crate::tube::stability::characteristic::{Characteristic, NotLinearised};
use crate::tube::stability::spectrum::symmetric;
use crate::tube::stability::track;
use crate::tube::wave::admissibility::{RegimeMargin, WaveWatch};
use crate::tube::wave::{Wave, WaveScales, width};

/// ω in units of the frequency of the wave below which it counts as zero. Parameters are even in ω:
/// the point found lies 1e-8 from the limit.
const LEAST_OMEGA: f64 = 1e-4;

/// All that a wave needs beside its signature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WavesInPlane {
    #[serde(with = "crate::tube::model::saved")]
    model: Model,
    parameters: [Parameter; 2],
    widths: [f64; 2],
    mode: u32,
    scales: WaveScales,
    method: Method,
    material: bool,
}

/// A pair ±iω in a Bloch sector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlochPair {
    /// Sector.
    pub sector: usize,
}

/// Longest step while a pair is followed, in units of the range: its eigenvalue moves little.
const SHORT: f64 = 0.01;
/// Largest way of the eigenvalue from one point to the next, in units of the frequency of the wave. A
/// longer one may have gone to another pair.
const LARGEST_MOVE: f64 = 0.05;

/// The pair of a Hopf point on its way along a branch.
#[derive(Clone, Debug)]
pub struct TrackedPair {
    sector: usize,
    lambda: Complex<f64>,
    most: f64,
}

impl WavesInPlane {
    /// That of a solved wave. `widths` are the units of the parameters.
    pub fn new(
        wave: &Wave,
        point: &Vector,
        parameters: [Parameter; 2],
        widths: [f64; 2],
    ) -> WavesInPlane {
        WavesInPlane {
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

impl PlaneOfOrbits for WavesInPlane {
    type Orbit = Wave;
    type Watch = WaveWatch;

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

    fn admits(&self, index: usize, value: f64) -> bool {
        self.parameters[index].admits(value)
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
        let scales = WaveScales {
            parameter: self.widths[index],
            ..self.scales
        };
        let parameter = self.parameters[index];
        let wave = Wave::new(model, parameter, self.mode, signature.clone(), scales);
        Ok(wave.with_method(self.method).with_material(self.material))
    }

    fn length(wave: &Wave, point: &Vector, zone: usize) -> f64 {
        wave.duration_at(point, zone) * wave.speed_at(point).abs()
    }

    fn key(margin: &RegimeMargin) -> (WaveWatch, usize) {
        (margin.watch, margin.zone)
    }
}

impl SpectralEvents for WavesInPlane {
    type Spectral = BlochPair;
    type NotLinearised = NotLinearised;
    const HAS_SECTORS: bool = true;

    /// F_j(iω), in sector 0 divided by iω: there λ = 0 is an eigenvalue of every wave, translation.
    fn spectral(
        &self,
        spectral: &BlochPair,
        wave: &Wave,
        point: &Vector,
        further: &[f64],
    ) -> Result<Vec<f64>, NotEvaluated<WavesInPlane>> {
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

    fn further(_: &BlochPair) -> usize {
        1
    }

    fn angular(&self, _: &BlochPair, _: &Wave, _: &Vector, further: &[f64]) -> Option<f64> {
        further.first().map(|scaled| scaled * self.frequency())
    }

    fn sector(spectral: &BlochPair) -> Option<usize> {
        Some(spectral.sector)
    }
}

impl EventCurves for WavesInPlane {
    const FOLLOWED: &'static [EventType] = &[
        EventType::LP,
        EventType::GR,
        EventType::RV,
        EventType::CO,
        EventType::ST,
        EventType::HB,
    ];

    /// ω where the pair may meet on the real axis. It is positive there.
    fn watched(
        &self,
        condition: &EventCondition<WavesInPlane>,
        _: &Wave,
        _: &Vector,
        further: &[f64],
    ) -> TestValues {
        let tests = match condition {
            EventCondition::Spectral(BlochPair { sector }) if symmetric(*sector, self.mode) => {
                vec![Test {
                    kind: Some(PointType::BT),
                    value: further[0] - LEAST_OMEGA,
                    ends: true,
                }]
            }
            _ => Vec::new(),
        };
        TestValues {
            tests,
            outside: None,
        }
    }
}

impl PlaneNames for WavesInPlane {
    type NoBranch = RunError;
    type Beside = TrackedPair;
    const ORBIT: &'static str = "wave";
    const ORBITS: &'static str = "waves";
    const ALL_STEPS: usize = 20_000;
    const LONGEST_BESIDE: f64 = SHORT;
    const MEASURE: Option<&'static str> = Some("speed");
    const ANGULAR: &'static str = "omega";
    const SYMBOL: &'static str = "ω";

    fn zone(signature: &Signature, zone: usize) -> String {
        signature.zone(zone).regime.name().to_owned()
    }

    fn name(wave: &Wave, _: &Vector) -> String {
        wave.signature.to_string()
    }

    fn measure(wave: &Wave, point: &Vector) -> (f64, Option<f64>) {
        (wave.speed_at(point), Some(wave.excess_at(point)))
    }

    fn beside(&self, spectral: &BlochPair, angular: Option<f64>) -> Option<TrackedPair> {
        Some(TrackedPair {
            sector: spectral.sector,
            lambda: Complex::new(0.0, angular?),
            most: LARGEST_MOVE * self.frequency(),
        })
    }

    /// Whether it grows. `None` where it may have been mistaken for another one, and beyond a change of regime: the
    /// spectrum passes the opening of reverse slip, but not every other.
    fn name_beside(
        pair: &mut TrackedPair,
        wave: &Wave,
        point: &Vector,
        kind: Option<EventType>,
    ) -> Option<Option<RegionName>> {
        use EventType::{EP, LP, RV, UZ};
        if !matches!(kind, None | Some(UZ | LP | EP | RV)) {
            return None;
        }
        let characteristic = Characteristic::new(wave, point).ok()?;
        let z = characteristic.multiplier(pair.sector);
        let lambda = track::follow(&characteristic, z, pair.lambda)?;
        let near = (lambda - pair.lambda).norm() <= pair.most;
        pair.lambda = lambda;
        near.then_some(Some(RegionName::Pair {
            grows: lambda.re > 0.0,
        }))
    }

    fn say(what: &What<Wave>) -> String {
        what.to_string()
    }
}
