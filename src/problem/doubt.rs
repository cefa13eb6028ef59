//! Numbers of a problem that no real tube has: nothing is wrong with the file, and yet it may not be meant.

use std::f64::consts::TAU;

use super::{Problem, Rotation};
use crate::tube::model::Parameter;

/// Interference d/R from which on linear elasticity, the theory of small strains, describes no tube: 20 %,
/// whichever way the quotient was rounded.
const LARGE_INTERFERENCE: f64 = 0.2 * (1.0 - 4.0 * f64::EPSILON);
/// (RΩ/c₀)² with c₀ = √(E/ρ), above which the shaft outruns sound in a thin bar. γ = 1 is the unit of tables.
const SONIC_GAMMA: f64 = 1.0;
/// Speed of the surface of a shaft that no brake reaches, m/s: twice that of a fast train's disc.
const FAST_SURFACE: f64 = 50.0;
/// The highest frequency that people hear, Hz.
const AUDIBLE: f64 = 20e3;

/// A number that no real tube has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// γ above that of a shaft as fast as sound.
    Supersonic {
        /// γ.
        gamma: f64,
    },
    /// The shaft is far too thick for the tube.
    Interference {
        /// d/R.
        mismatch: f64,
    },
    /// The surface of the shaft is faster than in any brake.
    Fast {
        /// RΩ in m/s.
        speed: f64,
        /// How the rotation is written.
        rotation: Rotation,
    },
    /// Waves of the problem's mode are too high to be heard.
    Inaudible {
        /// Frequency of the growing perturbation of steady sliding of that mode without damping, about that
        /// of the wave.
        hertz: f64,
        /// Mode.
        mode: u32,
        /// Whether the rotation stands in `output`, a bare number in rad/s.
        bare: bool,
    },
}

impl Problem {
    /// What may not be meant. A mismatch is taken as d/R where γ < 1; tables with γ = 1 have it in other units.
    pub fn doubts(&self) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        let gamma = self.model.value(Parameter::Gamma);
        if let Some(gamma) = gamma.filter(|gamma| *gamma > SONIC_GAMMA) {
            doubts.push(Doubt::Supersonic { gamma });
        }
        let mismatch = self.model.mismatch;
        if gamma.is_some_and(|gamma| gamma < SONIC_GAMMA) && mismatch >= LARGE_INTERFERENCE {
            doubts.push(Doubt::Interference { mismatch });
        }
        if let Some(tube) = self.tube.filter(|tube| tube.bore_speed() >= FAST_SURFACE) {
            let (speed, rotation) = (tube.bore_speed(), tube.rotation);
            doubts.push(Doubt::Fast { speed, rotation });
        }
        let (mode, tube) = (self.wave.mode, self.model.source.coefficients());
        let omega = (tube.a * f64::from(mode).powi(2) + tube.h).sqrt();
        let hertz = self.output.rotation.map(|rotation| omega * rotation / TAU);
        if let Some(hertz) = hertz.filter(|hertz| *hertz > AUDIBLE) {
            let bare = self.tube.is_none();
            doubts.push(Doubt::Inaudible { hertz, mode, bare });
        }
        doubts
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    fn doubts(tube: &str) -> Vec<Doubt> {
        let text = format!("({tube}, wave: (mode: 4, start: Fast))");
        parse(&text, "p.ron").unwrap().doubts()
    }

    fn tube(oversize: f64, rotation: &str) -> Vec<Doubt> {
        doubts(&format!(
            "tube: (young: 2e9, density: 2000, poisson: 0.3, inner: 0.1, outer: 0.15, oversize: {oversize}, \
             rotation: {rotation}, friction: 0.5)"
        ))
    }

    fn model(gamma: f64, mismatch: f64, output: &str) -> Vec<Doubt> {
        doubts(&format!(
            "model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: {gamma}), friction: 0.5, \
             mismatch: {mismatch}){output}"
        ))
    }

    #[test]
    fn numbers_of_no_real_tube_are_doubted() {
        assert_eq!(tube(50e-6, "Rpm(600)"), []);
        let mismatch = 0.02 / 0.1;
        assert_eq!(tube(0.02, "Rpm(600)"), [Doubt::Interference { mismatch }]);
        let rotation = Rotation::RadPerSecond(600.0);
        assert_eq!(
            tube(50e-6, "RadPerSecond(600)"),
            [Doubt::Fast {
                speed: 60.0,
                rotation
            }]
        );
        // 7.9 kHz with 62.8 rad/s, and nothing else tells that these were revolutions per minute
        let [
            Doubt::Inaudible {
                hertz,
                mode: 4,
                bare: true,
            },
        ] = model(3.9478e-5, 5e-4, ", output: (rotation: 600)")[..]
        else {
            panic!("one doubt");
        };
        assert!((hertz / 77.3e3 - 1.0).abs() < 1e-3, "{hertz}");
        assert_eq!(model(3.9478e-5, 5e-4, ", output: (rotation: 62.8)"), []);
        assert_eq!(
            model(3.9478e-5, 0.2, ""),
            [Doubt::Interference { mismatch: 0.2 }]
        );
        // the tables with γ = 1
        assert_eq!(model(1.0, 0.2, ""), []);
        assert_eq!(model(2e9, 5e-4, ""), [Doubt::Supersonic { gamma: 2e9 }]);
    }
}
