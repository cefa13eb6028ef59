//! Samples of a wave over one wavelength.

use serde::Serialize;

use crate::linalg::Vector;
use crate::tube::flow::friction::multiplier;
use crate::tube::flow::{FlowError, Slide};
use crate::tube::model::signature::Regime;

use super::Wave;

/// One sample of a wave over its wavelength: a row of `profiles/LABEL.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ProfileSample {
    /// θ from release, time-forward, in [0, 2π/k].
    pub theta: f64,
    /// Radial displacement U at the contact surface, in units of R; δ in contact.
    #[serde(rename = "U")]
    pub radial: f64,
    /// Tangential displacement V at the contact surface, in units of R.
    #[serde(rename = "V")]
    pub tangential: f64,
    /// U̇ following the material point, in units of RΩ.
    #[serde(rename = "U_dot")]
    pub radial_rate: f64,
    /// V̇ following the material point, in units of RΩ; the shaft has 1.
    #[serde(rename = "V_dot")]
    pub tangential_rate: f64,
    /// Contact pressure P ≥ 0 on the tube, in units of γI₀E.
    #[serde(rename = "P")]
    pub pressure: f64,
    /// Friction Q on the tube, in units of γI₀E; positive along the rotation.
    #[serde(rename = "Q")]
    pub shear: f64,
    /// Name of the regime, see [`Regime::name`].
    pub regime: &'static str,
}

/// End of each zone as θ from release, time-forward: the last is 2π/k.
pub fn switches(wave: &Wave, point: &Vector) -> Vec<f64> {
    let speed = wave.speed_at(point).abs();
    let mut theta = 0.0;
    (0..wave.zones())
        .map(|zone| {
            theta += wave.duration_at(point, zone) * speed;
            theta
        })
        .collect()
}

/// Samples with at least `resolution` intervals per wavelength; both sides of every switch are
/// sampled.
pub fn sample(
    wave: &Wave,
    point: &Vector,
    resolution: usize,
) -> Result<Vec<ProfileSample>, FlowError> {
    let flows = wave.flows(point)?;
    let speed = wave.speed_at(point).abs();
    let wavelength = std::f64::consts::TAU / f64::from(wave.mode);
    let at = &flows.frame.at;
    let weight = at.g * at.mismatch;
    let steady = flows.frame.steady().value;
    let mut samples = Vec::with_capacity(resolution + 2 * wave.zones());
    let mut theta = 0.0;
    for zone in 0..wave.zones() {
        let regime = wave.signature.zone(zone).regime;
        let slide = wave.slide_at(point, zone);
        let Slide {
            entry, duration, ..
        } = slide;
        let share = duration * speed / wavelength * resolution as f64;
        let intervals = share.ceil().clamp(1.0, resolution.max(1) as f64) as usize;
        let times: Vec<f64> = (0..=intervals)
            .map(|index| duration * index as f64 / intervals as f64)
            .collect();
        let sliding = match regime {
            Regime::Stick | Regime::Separation => Vec::new(),
            _ => flows.contact(regime).states(&slide, &times)?,
        };
        for (index, time) in times.into_iter().enumerate() {
            let (radial, radial_rate, [y, w]) = match regime {
                Regime::Stick => (at.mismatch, 0.0, [entry[0] + time, entry[1]]),
                Regime::Separation => {
                    let [u, rate, y, w] = flows.separation().state(&slide, time)?;
                    (u, rate, [y, w])
                }
                _ => (at.mismatch, 0.0, sliding[index]),
            };
            let pressure = match regime {
                Regime::Separation => 0.0,
                Regime::Stick => weight + at.kappa * w,
                _ => weight + at.kappa * flows.contact(regime).drive(&slide, time, [y, w]),
            };
            let shear = match regime {
                Regime::Stick => at.h * (y + steady + at.material) + at.damping,
                Regime::Separation => 0.0,
                sliding => {
                    let sigma = sliding.sliding().unwrap_or(1.0);
                    multiplier(wave.model.law, sigma, w, at.smoothing) * at.friction * pressure
                }
            };
            samples.push(ProfileSample {
                theta: theta + time * speed,
                radial,
                tangential: y + steady,
                radial_rate,
                tangential_rate: w,
                pressure,
                shear,
                regime: regime.name(),
            });
        }
        theta += duration * speed;
    }
    Ok(samples)
}
