//! Eigenfunctions ψ(θ) on the full circle.
//!
//! ψ(−cs) = e^{−λs}η(s), so ψ′ = dψ/dθ = −(1/c)e^{−λs}(η′ − λη). An eigenvalue of Bloch sector j
//! satisfies ψ(θ + 2π/k) = e^{2πij/k}ψ(θ) for c < 0 (the conjugate factor for c > 0): one wavelength
//! determines the whole circle. Normalised as in Nguyen et al. (2008), ψ(0)² + ψ′(0)² = 1, where
//! θ = 0 is the release (or the first switch of a wave without stick).

use nalgebra::Vector4;

use super::perturbation::{C64, Characteristic, LinearZone, Perturbations, ZERO};
use crate::model::signature::Regime;

/// A sample of an eigenfunction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeSample {
    /// |θ| from release, time-forward.
    pub theta: f64,
    /// ψ.
    pub psi: C64,
    /// ψ′.
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
    states: Vec<Vector4<C64>>,
    /// Perturbations at the end of the wavelength.
    end: Vector4<C64>,
    equation_residual: f64,
}

/// Perturbations at the beginning of the wavelength: (η, η′) = (1, 0) behind a release (η′ is not zero
/// where static friction gives way); without stick the
/// null vector of M e^{−λT} − z.
fn beginning(characteristic: &Characteristic, lambda: C64, z: C64) -> Vector4<C64> {
    if characteristic.stick {
        let mut state = single(Vector4::new(ZERO, ZERO, C64::from(1.0), ZERO));
        characteristic.release(lambda, &mut state);
        return state.columns[0];
    }
    let mut state = unit_columns();
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

fn unit_columns() -> Perturbations {
    let column = |row: usize| {
        let mut column = Vector4::repeat(ZERO);
        column[row] = C64::from(1.0);
        column
    };
    Perturbations {
        columns: [column(2), column(3)],
        by: [Vector4::repeat(ZERO); 2],
        exponent: 0.0,
    }
}

fn single(column: Vector4<C64>) -> Perturbations {
    Perturbations {
        columns: [column, Vector4::repeat(ZERO)],
        by: [Vector4::repeat(ZERO); 2],
        exponent: 0.0,
    }
}

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

/// With material damping: the boundary-value problem is solved zone by zone.
fn material_trace(
    characteristic: &Characteristic,
    lambda: C64,
    z: C64,
    resolution: usize,
) -> Trace {
    let period = characteristic.period;
    let (sampled_states, end) =
        characteristic.material_states(lambda, z, |zone| sampled(zone, period, resolution));
    let mut times = Vec::with_capacity(resolution + 8);
    let mut states = Vec::with_capacity(resolution + 8);
    let mut start = 0.0;
    for (zone, here) in characteristic.zones.iter().zip(&sampled_states) {
        for (time, state) in sampled(zone, period, resolution).iter().zip(here) {
            times.push(start + time);
            states.push(Vector4::new(state[0], state[1], state[3], state[4]));
        }
        start += zone.duration;
    }
    // η‴ from η″ by central differences of sixth order, away from the layer's own scale
    let h = |zone: &LinearZone| 1e-2 * zone.duration.min(shortest(characteristic, lambda));
    const PLACES: [f64; 3] = [0.25, 0.5, 0.75];
    let (stencils, _) = characteristic.material_states(lambda, z, |zone| {
        let offsets = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0];
        let around = |share: f64| offsets.map(|offset| share * zone.duration + offset * h(zone));
        PLACES.into_iter().flat_map(around).collect()
    });
    let mut equation_residual = 0.0_f64;
    for (zone, stencil) in characteristic.zones.iter().zip(&stencils) {
        if zone.regime == Regime::Stick {
            continue;
        }
        let sigma = zone.regime.sliding().unwrap_or(0.0);
        for seven in stencil.chunks_exact(7) {
            let row = |index: usize| seven[index][5];
            let third = ((row(4) - row(2)) * 45.0 - (row(5) - row(1)) * 9.0 + (row(6) - row(0)))
                / (60.0 * h(zone));
            let (terms, size) = characteristic.material_terms(lambda, sigma, seven[3], third);
            equation_residual = equation_residual.max(terms.norm() / size.max(1e-300));
        }
    }
    Trace {
        times,
        states,
        end: Vector4::new(ZERO, ZERO, end[0], end[1]),
        equation_residual,
    }
}

fn trace(characteristic: &Characteristic, lambda: C64, z: C64, resolution: usize) -> Trace {
    if characteristic.beta > 0.0 {
        return material_trace(characteristic, lambda, z, resolution);
    }
    let mut column = beginning(characteristic, lambda, z);
    let mut times = Vec::with_capacity(resolution + 8);
    let mut states = Vec::with_capacity(resolution + 8);
    let mut start = 0.0;
    let mut equation_residual = 0.0_f64;
    for zone in &characteristic.zones {
        let at = |time: f64| {
            let mut state = single(column);
            characteristic.flow(zone, lambda, time, &mut state, 1);
            state.columns[0] * C64::from(state.exponent.exp())
        };
        for time in sampled(zone, characteristic.period, resolution) {
            times.push(start + time);
            states.push(at(time));
        }
        if zone.regime != Regime::Stick {
            // central differences of sixth order of the exact flow: independent of its derivation
            let h = 1e-2 * zone.duration.min(shortest(characteristic, lambda));
            for time in [0.25, 0.5, 0.75].map(|share| share * zone.duration) {
                let row = |offset: f64| at(time + offset * h)[3];
                let curvature = ((row(1.0) - row(-1.0)) * 45.0 - (row(2.0) - row(-2.0)) * 9.0
                    + (row(3.0) - row(-3.0)))
                    / (60.0 * h);
                let (terms, size) =
                    tangential_terms(characteristic, zone.regime, lambda, &at(time), curvature);
                equation_residual = equation_residual.max(terms.norm() / size.max(1e-300));
            }
        }
        let mut state = single(column);
        characteristic.cross(zone, lambda, &mut state, 1);
        column = state.columns[0] * C64::from(state.exponent.exp());
        start += zone.duration;
    }
    Trace {
        times,
        states,
        end: column,
        equation_residual,
    }
}

/// Sum and largest of the terms of the tangential equation.
fn tangential_terms(
    characteristic: &Characteristic,
    regime: Regime,
    lambda: C64,
    state: &Vector4<C64>,
    curvature: C64,
) -> (C64, f64) {
    let [u, u_rate, y, rate] = state.data.0[0];
    let force = regime.sliding().unwrap_or(0.0) * characteristic.friction * characteristic.kappa;
    let mut terms = vec![
        curvature * characteristic.ma,
        rate * (lambda * (2.0 * characteristic.a) - force + characteristic.damping),
        y * (lambda * force - lambda * lambda * characteristic.a + characteristic.h),
    ];
    if regime == Regime::Separation {
        terms.push(-(u_rate - lambda * u) * characteristic.kappa);
    }
    let size = terms
        .iter()
        .fold(0.0_f64, |size, term| size.max(term.norm()));
    (terms.into_iter().sum(), size)
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
    let slope = |s: f64, state: &Vector4<C64>| {
        -(-lambda * s).exp() * (state[3] - lambda * state[2]) / speed
    };
    let norm = (first[2] * first[2] + slope(0.0, &first) * slope(0.0, &first)).sqrt();
    // ψ(0)² + ψ′(0)² may vanish for a complex ψ: then its modulus serves
    let norm = if norm.norm() > 1e-8 {
        norm
    } else {
        C64::from((first[2].norm_sqr() + slope(0.0, &first).norm_sqr()).sqrt())
    };
    let turn = (-lambda * characteristic.period).exp();
    let period = characteristic.period;
    let size = first[2].norm().hypot(first[3].norm() * period);
    let mut closure = (trace.end[2] * turn - z * first[2]).norm();
    if !characteristic.stick {
        closure = closure.hypot((trace.end[3] * turn - z * first[3]).norm() * period);
    }
    let mut samples = Vec::with_capacity(trace.times.len() * characteristic.mode as usize);
    let mut factor = C64::from(1.0);
    for lap in 0..characteristic.mode {
        let offset = f64::from(lap) * characteristic.period;
        for (time, state) in trace.times.iter().zip(&trace.states) {
            let decay = (-lambda * *time).exp();
            samples.push(ModeSample {
                theta: (offset + time) * speed.abs(),
                psi: factor * decay * state[2] / norm,
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
