//! Eigenfunctions ψ(θ) on the full circle.
//!
//! ψ(−cs) = e^{−λs}η(s), so ψ′ = dψ/dθ = −(1/c)e^{−λs}(η′ − λη). An eigenvalue of Bloch sector j
//! satisfies ψ(θ + 2π/k) = e^{2πij/k}ψ(θ) for c < 0 (the conjugate factor for c > 0): one wavelength
//! determines the whole circle. Normalised as in Nguyen et al. (2008), ψ(0)² + ψ′(0)² = 1, where
//! θ = 0 is the release (or the first switch of a wave without stick).

use nalgebra::Vector4;

use super::boundary::Motion;
use super::perturbation::{Characteristic, LinearZone, PerturbationColumns};
use super::{C64, ZERO};
use crate::tube::model::signature::Regime;

/// A sample of an eigenfunction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeSample {
    /// |θ| from release, time-forward, in [0, 2π].
    pub theta: f64,
    /// ψ(θ), the tangential displacement.
    pub psi: C64,
    /// ψ′ = dψ/dθ.
    pub slope: C64,
}

/// An eigenfunction over 2π with its residuals.
#[derive(Clone, Debug)]
pub struct Eigenfunction {
    /// Samples over the full circle, time-forward.
    pub samples: Vec<ModeSample>,
    /// Largest residual of the differential equations, relative to their largest term.
    pub equation_residual: f64,
    /// |N e^{−λT} − e^{2πij/k}|, or the same of the 2 × 2 problem: what the jumps leave open.
    pub closure_residual: f64,
}

/// (η, η′) and its place, one wavelength long.
struct Trace {
    times: Vec<f64>,
    states: Vec<[C64; 2]>,
    /// (η, η′) at the end of the wavelength.
    end: [C64; 2],
    equation_residual: f64,
}

/// Perturbations at the beginning of the wavelength: (η, η′) = (1, 0) behind a release (η′ is not zero
/// where static friction gives way); without stick the
/// null vector of M e^{−λT} − z.
fn beginning(characteristic: &Characteristic, lambda: C64, z: C64) -> Vector4<C64> {
    if characteristic.stick {
        let mut state = PerturbationColumns::single(Vector4::new(ZERO, ZERO, C64::from(1.0), ZERO));
        characteristic.release(lambda, &mut state);
        return state.columns[0];
    }
    let mut state = PerturbationColumns::unit();
    for zone in &characteristic.zones {
        characteristic.cross(zone, lambda, &mut state, 2);
    }
    let factor = (-lambda * characteristic.period + state.exponent).exp();
    let [one, other] = state.columns;
    // for (η, η′T): the larger row of the singular matrix decides
    let period = characteristic.period;
    let (a, b) = (one[2] * factor - z, other[2] * factor / period);
    let (c, d) = (one[3] * factor * period, other[3] * factor - z);
    let (y, w) = if a.norm() + b.norm() > c.norm() + d.norm() {
        (-b, a)
    } else {
        (-d, c)
    };
    let size = (y.norm_sqr() + w.norm_sqr()).sqrt();
    Vector4::new(ZERO, ZERO, y / size, w / (size * period))
}

/// Where in each zone the equations are tested.
const SHARES: [f64; 3] = [0.25, 0.5, 0.75];

/// The time in which an eigenfunction changes: it turns with λ and with the wave.
fn shortest(characteristic: &Characteristic, lambda: C64) -> f64 {
    1.0 / (characteristic.period.recip() + lambda.norm())
}

/// The sampled times of a zone.
fn sampled(zone: &LinearZone, period: f64, resolution: usize) -> Vec<f64> {
    let share = zone.duration / period * resolution as f64;
    let intervals = share.ceil().max(1.0) as usize;
    (0..=intervals)
        .map(|index| zone.duration * index as f64 / intervals as f64)
        .collect()
}

/// The motion at chosen times of every zone without material damping, u″ and η″ left out, and η and η′ at
/// the end of the period: [`Characteristic::material_states`] with it.
fn undamped_states(
    characteristic: &Characteristic,
    lambda: C64,
    z: C64,
    times: impl Fn(&LinearZone) -> Vec<f64>,
) -> (Vec<Vec<Motion>>, [C64; 2]) {
    let mut column = beginning(characteristic, lambda, z);
    let mut states = Vec::with_capacity(characteristic.zones.len());
    for zone in &characteristic.zones {
        let at = |time: f64| {
            let mut state = PerturbationColumns::single(column);
            characteristic.flow(zone, lambda, time, &mut state, 1);
            let moved = state.columns[0] * C64::from(state.exponent.exp());
            [moved[0], moved[1], ZERO, moved[2], moved[3], ZERO]
        };
        states.push(times(zone).into_iter().map(at).collect());
        let mut state = PerturbationColumns::single(column);
        characteristic.cross(zone, lambda, &mut state, 1);
        column = state.columns[0] * C64::from(state.exponent.exp());
    }
    (states, [column[2], column[3]])
}

fn trace(characteristic: &Characteristic, lambda: C64, z: C64, resolution: usize) -> Trace {
    let (period, damped) = (characteristic.period, characteristic.beta > 0.0);
    let states_at = |times: &dyn Fn(&LinearZone) -> Vec<f64>| {
        if damped {
            return characteristic.material_states(lambda, z, times);
        }
        undamped_states(characteristic, lambda, z, times)
    };
    let (sampled_states, end) = states_at(&|zone| sampled(zone, period, resolution));
    let mut times = Vec::with_capacity(resolution + 8);
    let mut states = Vec::with_capacity(resolution + 8);
    let mut start = 0.0;
    for (zone, here) in characteristic.zones.iter().zip(&sampled_states) {
        for (time, [_, _, _, eta, rate, _]) in sampled(zone, period, resolution).iter().zip(here) {
            times.push(start + time);
            states.push([*eta, *rate]);
        }
        start += zone.duration;
    }
    // the highest derivative of η by central differences of sixth order, independent of the derivation
    // of the flow and away from the scale of a layer
    let h = |zone: &LinearZone| 1e-2 * zone.duration.min(shortest(characteristic, lambda));
    let (stencils, _) = states_at(&|zone| {
        let offsets = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0];
        let around = |share: f64| offsets.map(|offset| share * zone.duration + offset * h(zone));
        SHARES.into_iter().flat_map(around).collect()
    });
    let mut equation_residual = 0.0_f64;
    for (zone, stencil) in characteristic.zones.iter().zip(&stencils) {
        if zone.regime == Regime::Stick {
            continue;
        }
        let sigma = zone.regime.sliding().unwrap_or(0.0);
        let constant = [sigma * characteristic.friction * characteristic.kappa, 0.0];
        for (seven, share) in stencil.chunks_exact(7).zip(SHARES) {
            let course = zone.course.as_ref();
            let friction = course.map_or(constant, |course| course.at(share * zone.duration));
            let row = |index: usize| seven[index][if damped { 5 } else { 4 }];
            let highest = ((row(4) - row(2)) * 45.0 - (row(5) - row(1)) * 9.0 + (row(6) - row(0)))
                / (60.0 * h(zone));
            let [u, u_rate, u_bend, eta, rate, bend] = seven[3];
            let (bend, third) = if damped {
                (bend, highest)
            } else {
                (highest, ZERO)
            };
            let motion = [u, u_rate, u_bend, eta, rate, bend];
            let (terms, size) = characteristic.material_terms(lambda, friction, motion, third);
            equation_residual = equation_residual.max(terms.norm() / size.max(1e-300));
        }
    }
    Trace {
        times,
        states,
        end,
        equation_residual,
    }
}

/// The eigenfunction of an eigenvalue λ of a Bloch sector, over the full circle, for a wave of
/// signed speed c.
pub fn eigenfunction(
    characteristic: &Characteristic,
    speed: f64,
    sector: usize,
    lambda: C64,
    resolution: usize,
) -> Eigenfunction {
    let z = characteristic.multiplier(sector);
    let trace = trace(characteristic, lambda, z, resolution);
    let first = trace.states[0];
    let slope =
        |s: f64, state: &[C64; 2]| -(-lambda * s).exp() * (state[1] - lambda * state[0]) / speed;
    let norm = (first[0] * first[0] + slope(0.0, &first) * slope(0.0, &first)).sqrt();
    // ψ(0)² + ψ′(0)² may vanish for a complex ψ: then its modulus serves
    let norm = if norm.norm() > 1e-8 {
        norm
    } else {
        C64::from((first[0].norm_sqr() + slope(0.0, &first).norm_sqr()).sqrt())
    };
    let turn = (-lambda * characteristic.period).exp();
    let period = characteristic.period;
    let size = first[0].norm().hypot(first[1].norm() * period);
    let mut closure = (trace.end[0] * turn - z * first[0]).norm();
    if !characteristic.stick {
        closure = closure.hypot((trace.end[1] * turn - z * first[1]).norm() * period);
    }
    let mut samples = Vec::with_capacity(trace.times.len() * characteristic.mode as usize);
    let mut factor = C64::from(1.0);
    for lap in 0..characteristic.mode {
        let offset = f64::from(lap) * characteristic.period;
        for (time, state) in trace.times.iter().zip(&trace.states) {
            let decay = (-lambda * *time).exp();
            samples.push(ModeSample {
                theta: (offset + time) * speed.abs(),
                psi: factor * decay * state[0] / norm,
                slope: factor * slope(*time, state) / norm,
            });
        }
        factor *= z;
    }
    Eigenfunction {
        samples,
        equation_residual: trace.equation_residual,
        closure_residual: closure / size,
    }
}
