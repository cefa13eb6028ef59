//! A body in motion, be it the ring or the annulus: what a section `simulation` describes.

use std::f64::consts::TAU;

use faer::c64;
use serde::{Deserialize, Serialize};

use super::annulus::{self, Annulus, State};
use super::growth;
use super::line::{Line, LineRegime};
use super::profile::Profile;
use super::ring::kernel::Nodes;
use super::ring::{self, Ring, RingLaw};
use crate::simulation::task::{Body, Circle, Simulation};
use crate::tube::model::{Constants, Model};

/// A body in motion.
#[derive(Clone, Debug)]
pub enum SimulatedMotion {
    /// System (M).
    Ring(Box<Ring>),
    /// The elastic tube.
    Annulus(Box<Annulus>),
}

/// All that a motion needs to go on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Saved {
    /// Of a ring.
    Ring(Nodes),
    /// Of an annulus.
    Annulus(State),
}

/// Why a motion cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    /// The ring.
    #[error("{0}")]
    Ring(#[from] ring::RingSetupError),
    /// The annulus.
    #[error("{0}")]
    Annulus(#[from] annulus::TubeSetupError),
    /// An annulus without a geometry.
    #[error("an annulus needs the geometry of the tube")]
    Geometry,
    /// The saved state is of another body.
    #[error("it is of another body")]
    Body,
    /// The wave does not fit the ring.
    #[error(
        "the wave is {found} long, but mode {mode} has the wavelength {expected}; take a wave of this mode"
    )]
    Wavelength {
        /// Length of the wave.
        found: f64,
        /// Length expected.
        expected: f64,
        /// Mode of the problem.
        mode: u32,
    },
}

impl MotionError {
    /// The path of the field of the problem that this is about, and what would be right there.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn about(&self) -> (&'static str, &'static str) {
        match self {
            MotionError::Ring(ring::RingSetupError::Step { .. })
            | MotionError::Annulus(annulus::TubeSetupError::Step { .. }) => (
                "simulation.courant",
                "take a smaller Courant number, for example `courant: 0.3`",
            ),
            MotionError::Wavelength { .. } => (
                "simulation.start",
                "take a wave of this mode, or write its mode in `wave`",
            ),
            _ => ("simulation.body", "take another mesh"),
        }
    }
}

/// Relative difference of wavelengths that is still rounding of a table.
const SAME_LENGTH: f64 = 1e-9;

/// Angle of the part of the circle that is simulated.
pub(crate) fn angle(section: &Simulation, mode: u32) -> f64 {
    match section.circle {
        Circle::Whole => TAU,
        Circle::Wavelength => TAU / f64::from(mode),
    }
}

/// λ of the growing travelling wave of steady sliding of the reduced model (M):
/// λ² + αλ + (1 + βλ)(ak² + h + ikfD) = 0, the root with the larger real part.
pub fn steady_growth(parameters: &Constants, mode: u32) -> [f64; 2] {
    let c = parameters.coefficients;
    let k = f64::from(mode);
    let stiffness = c64::new(c.a * k * k + c.h, k * parameters.friction * c.coupling);
    // λ² + 2dλ + K + iS = 0; the principal root has Re ≥ 0
    let half = 0.5 * (parameters.mass_damping + parameters.stiffness_damping * stiffness);
    let growth = (half * half - stiffness).sqrt() - half;
    [growth.re, growth.im]
}

impl SimulatedMotion {
    /// The body of a section, at its beginning.
    pub(crate) fn begin(
        section: &Simulation,
        model: &Model,
        mode: u32,
        wave: Option<&Profile>,
    ) -> Result<SimulatedMotion, MotionError> {
        let parameters = &model.constants();
        let angle = angle(section, mode);
        let whole_steps = |longest: f64| section.every / (section.every / longest).ceil();
        let mut motion = match section.body {
            Body::Ring {
                points,
                order,
                friction,
            } => {
                let longest = ring::courant_step(parameters, points, angle, section.courant);
                let setup = ring::RingSetup {
                    points,
                    angle,
                    order,
                    time_step: whole_steps(longest),
                    law: friction,
                    impact: model.impact,
                    watched: true,
                };
                SimulatedMotion::Ring(Box::new(Ring::new(parameters, setup)?))
            }
            Body::Annulus { around, across } => {
                let geometry = model.source.geometry().ok_or(MotionError::Geometry)?;
                let longest = annulus::courant_step(
                    &geometry,
                    around,
                    across,
                    angle,
                    section.courant,
                    parameters.stiffness_damping,
                );
                let setup = annulus::TubeSetup {
                    geometry,
                    friction: parameters.friction,
                    mismatch: parameters.mismatch,
                    mass_damping: parameters.mass_damping,
                    stiffness_damping: parameters.stiffness_damping,
                    around,
                    across,
                    angle,
                    time_step: whole_steps(longest),
                };
                SimulatedMotion::Annulus(Box::new(Annulus::new(setup)?))
            }
        };
        if let (SimulatedMotion::Ring(ring), Some(wave)) = (&mut motion, wave) {
            let expected = TAU / f64::from(mode);
            let found = wave.wavelength();
            if (found / expected - 1.0).abs() > SAME_LENGTH {
                return Err(MotionError::Wavelength {
                    found,
                    expected,
                    mode,
                });
            }
            growth::place(ring, wave);
        }
        if let Some(perturbation) = section.perturbation {
            let lambda = steady_growth(parameters, perturbation.mode);
            motion.perturb(perturbation.mode, perturbation.amplitude, lambda);
        }
        Ok(motion)
    }

    /// Adds A cos kφ to V and A Re(λe^{ikφ}) to V̇; points in the air keep U.
    fn perturb(&mut self, mode: u32, amplitude: f64, lambda: [f64; 2]) {
        match self {
            SimulatedMotion::Annulus(annulus) => annulus.perturb(mode, amplitude, lambda),
            SimulatedMotion::Ring(ring) => {
                let width = ring.spacing();
                for point in 0..ring.setup().points {
                    let (sine, cosine) = (f64::from(mode) * width * point as f64).sin_cos();
                    let rate = amplitude * (lambda[0] * cosine - lambda[1] * sine);
                    ring.push(point, amplitude * cosine, rate);
                }
            }
        }
    }

    /// Takes a number of steps.
    pub fn advance(&mut self, steps: u64) {
        match self {
            SimulatedMotion::Ring(ring) => ring.advance(steps),
            SimulatedMotion::Annulus(annulus) => annulus.advance(steps),
        }
    }

    /// Steps, none longer than those of the motion, that a time is a whole number of.
    pub(crate) fn steps_within(&self, time: f64) -> u64 {
        (time / self.time_step()).ceil().max(1.0) as u64
    }

    /// Goes on with [`SimulatedMotion::steps_within`] a time; takes the first and returns how many are left.
    pub(crate) fn shorten(&mut self, time: f64) -> u64 {
        let steps = self.steps_within(time);
        match self {
            SimulatedMotion::Ring(ring) => ring.shorten(time / steps as f64),
            SimulatedMotion::Annulus(annulus) => annulus.shorten(time / steps as f64),
        }
        steps - 1
    }

    pub(crate) fn steps(&self) -> u64 {
        match self {
            SimulatedMotion::Ring(ring) => ring.steps(),
            SimulatedMotion::Annulus(annulus) => annulus.steps(),
        }
    }

    /// Time since the start.
    pub fn time(&self) -> f64 {
        match self {
            SimulatedMotion::Ring(ring) => ring.time(),
            SimulatedMotion::Annulus(annulus) => annulus.time(),
        }
    }

    /// Time step.
    pub fn time_step(&self) -> f64 {
        match self {
            SimulatedMotion::Ring(ring) => ring.setup().time_step,
            SimulatedMotion::Annulus(annulus) => annulus.setup().time_step,
        }
    }

    pub(crate) fn size(&self) -> usize {
        match self {
            SimulatedMotion::Ring(ring) => ring.setup().points,
            SimulatedMotion::Annulus(annulus) => annulus.state().radial.len(),
        }
    }

    /// Energy, and the work of friction, contact and damping since the start.
    pub fn energy(&self) -> (f64, [f64; 3]) {
        match self {
            SimulatedMotion::Ring(ring) => (ring.energy(), ring.work()),
            SimulatedMotion::Annulus(annulus) => (annulus.energy(), annulus.state().work),
        }
    }

    /// The state to go on from.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn saved(&self) -> Saved {
        match self {
            SimulatedMotion::Ring(ring) => Saved::Ring(ring.nodes().clone()),
            SimulatedMotion::Annulus(annulus) => Saved::Annulus(annulus.state().clone()),
        }
    }

    /// Goes on from a state.
    pub(crate) fn resume(&mut self, saved: Saved, steps: u64) -> Result<(), MotionError> {
        match (self, saved) {
            (SimulatedMotion::Ring(ring), Saved::Ring(nodes)) => Ok(ring.resume(nodes, steps)?),
            (SimulatedMotion::Annulus(annulus), Saved::Annulus(state)) => {
                Ok(annulus.resume(state, steps)?)
            }
            _ => Err(MotionError::Body),
        }
    }

    /// The contact line.
    pub fn line(&self) -> Line {
        match self {
            SimulatedMotion::Ring(ring) => ring_line(ring),
            SimulatedMotion::Annulus(annulus) => {
                let around = annulus.setup().around;
                let state = annulus.state();
                let rates = &state.tangential_rate[..around];
                Line {
                    width: annulus.width(),
                    radial: state.radial[..around].to_vec(),
                    tangential: state.tangential[..around].to_vec(),
                    radial_rate: state.radial_rate[..around].to_vec(),
                    tangential_rate: rates.to_vec(),
                    pressure: state.pressure.clone(),
                    shear: state.shear.clone(),
                    regimes: (0..around)
                        .map(|point| LineRegime::of(state.pressure[point] > 0.0, rates[point], 0.0))
                        .collect(),
                }
            }
        }
    }
}

/// The ring is its contact line. Q follows from the law, and in stick from V̈ = 0.
fn ring_line(ring: &Ring) -> Line {
    let nodes = ring.nodes();
    let count = nodes.count();
    let parameters = ring.constants();
    let within = match ring.setup().law {
        RingLaw::Coulomb => 0.0,
        RingLaw::Smoothed { epsilon } => epsilon,
    };
    let pressure: Vec<f64> = (0..count).map(|point| ring.pressure(point)).collect();
    let regimes: Vec<LineRegime> = (0..count)
        .map(|point| {
            let contact = nodes.share[point] != 0.0;
            LineRegime::of(contact, nodes.tangential_rate[point], within)
        })
        .collect();
    let shear = (0..count)
        .map(|point| {
            let most = parameters.friction * pressure[point].max(0.0);
            match (regimes[point], ring.setup().law) {
                (LineRegime::Separation, _) => 0.0,
                (_, RingLaw::Smoothed { epsilon }) => {
                    most * ((1.0 - nodes.tangential_rate[point]) / epsilon).tanh()
                }
                (LineRegime::Slip, _) => most,
                (LineRegime::Reverse, _) => -most,
                (LineRegime::Stick, _) => ring.holding_shear(point).clamp(-most, most),
            }
        })
        .collect();
    Line {
        width: ring.spacing(),
        radial: nodes.radial.clone(),
        tangential: nodes.tangential.clone(),
        radial_rate: nodes.radial_rate.clone(),
        tangential_rate: nodes.tangential_rate.clone(),
        pressure,
        shear,
        regimes,
    }
}
