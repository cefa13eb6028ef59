//! The elastic annulus in Bessel functions: an independent characteristic equation.
//!
//! u = φ′ + ikψ/r, v = ikφ/r − ψ′ with φ, ψ combinations of J_k, Y_k of pr and qr, p² = γκ/C and
//! q² = γκ/μ, solve div σ = −γκ(u, v). Four boundary conditions make a determinant.

use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::steady::radial::Radial;
use faer::c64;
use nalgebra::Matrix4;

use crate::steady::{observed, tube};

const EULER: f64 = 0.577_215_664_901_532_9;

/// J_n and Y_n by their power series; n ≥ 0.
fn bessel(n: u32, z: c64) -> [c64; 2] {
    let half = 0.5 * z;
    let square = -half * half;
    let harmonic = |m: u32| (1..=m).map(|i| 1.0 / f64::from(i)).sum::<f64>();
    let mut term = (1..=n).fold(c64::new(1.0, 0.0), |term, i| term * half / f64::from(i));
    let (mut first, mut series) = (c64::new(0.0, 0.0), c64::new(0.0, 0.0));
    for m in 0..80 {
        first += term;
        series += term * (harmonic(m) + harmonic(n + m) - 2.0 * EULER);
        term *= square / (f64::from(m + 1) * f64::from(n + m + 1));
    }
    // (n−m−1)!/m! (z/2)^{2m−n}
    let mut poles = c64::new(0.0, 0.0);
    for m in 0..n {
        let mut one = (1..n - m).fold(c64::new(1.0, 0.0), |one, i| one * f64::from(i));
        for i in 1..=m {
            one = one * half * half / f64::from(i);
        }
        for _ in 0..n {
            one /= half;
        }
        poles += one;
    }
    let pi = std::f64::consts::PI;
    [first, (2.0 * half.ln() * first - poles - series) / pi]
}

/// A potential and its first two derivatives in r.
fn potentials(k: u32, wave_number: c64, r: f64) -> [[c64; 3]; 2] {
    let z = wave_number * r;
    let (here, below) = (bessel(k, z), bessel(k - 1, z));
    [0, 1].map(|kind| {
        let slope = wave_number * (below[kind] - f64::from(k) / z * here[kind]);
        let k = f64::from(k);
        let bend = -slope / r - (wave_number * wave_number - k * k / (r * r)) * here[kind];
        [here[kind], slope, bend]
    })
}

/// The determinant of u = v = 0 at ξ, u = 0 and σ_rφ = fσ_rr − sv at 1.
pub fn determinant(tube: &Geometry, k: u32, friction: f64, s: c64, kappa: c64) -> c64 {
    let nu = tube.nu;
    let product = (1.0 + nu) * (1.0 - 2.0 * nu);
    let (c, lambda, mu) = ((1.0 - nu) / product, nu / product, 0.5 / (1.0 + nu));
    let mut columns = Vec::new();
    for (shear, stiffness) in [(false, c), (true, mu)] {
        let wave_number = (tube.gamma * kappa / stiffness).sqrt();
        let inner = potentials(k, wave_number, 1.0);
        let outer = potentials(k, wave_number, tube.xi);
        let ik = c64::new(0.0, f64::from(k));
        for kind in 0..2 {
            // (u, v, u′, v′) of a potential
            let field = |[f, slope, bend]: [c64; 3], r: f64| {
                let over = ik * f / r;
                let over_slope = ik * (slope / r - f / (r * r));
                if shear {
                    [over, -slope, over_slope, -bend]
                } else {
                    [slope, over, bend, over_slope]
                }
            };
            let [u, v, u_slope, v_slope] = field(inner[kind], 1.0);
            let [u_outer, v_outer, ..] = field(outer[kind], tube.xi);
            let radial = (c * u_slope) + lambda * (u + ik * v);
            let tangential = mu * (v_slope - v + ik * u);
            let rubbed = tangential - friction * radial + s * v;
            let column = [u_outer, v_outer, u, rubbed];
            let size = column.iter().map(|one| one.norm()).fold(0.0, f64::max);
            columns.push(column.map(|one| one / size));
        }
    }
    Matrix4::from_fn(|row, column| columns[column][row]).determinant()
}

/// The root nearest to a guess, by the secant method.
pub fn root(function: impl Fn(c64) -> c64, guess: c64) -> c64 {
    let (mut before, mut here) = (guess * 1.000_01, guess);
    let mut value_before = function(before);
    for _ in 0..20 {
        let value = function(here);
        let next = here - value * (here - before) / (value - value_before);
        if !next.is_finite() || (next - here).norm() <= 1e-14 * here.norm() {
            break;
        }
        (before, value_before, here) = (here, value, next);
    }
    here
}

/// The terms of the power series grow to e^{|z|} before they cancel: up to this |z| = qξ that costs
/// five of sixteen digits.
pub const LARGEST_ARGUMENT: f64 = 10.5;

#[test]
fn the_radial_problem_meets_the_bessel_functions() {
    let (mut worst, mut compared): (f64, usize) = (0.0, 0);
    for (nu, xi) in [
        (0.3, 1.5),
        (0.45, 1.25),
        (0.0, 1.5),
        (-0.3, 2.0),
        (0.3, 1.1),
    ] {
        for k in [1, 2, 4, 8] {
            for friction in [0.1, 0.5, 1.5] {
                let tube = tube(nu, xi);
                let radial = Radial::new(&tube, k, 32);
                for pair in radial.lowest(friction, 3).unwrap() {
                    let mu = 0.5 / (1.0 + nu);
                    if (tube.gamma * pair.kappa.norm() / mu).sqrt() * xi > LARGEST_ARGUMENT {
                        continue;
                    }
                    let exact = root(
                        |kappa| determinant(&tube, k, friction, c64::new(0.0, 0.0), kappa),
                        pair.kappa * (1.0 + 1e-7),
                    );
                    let error = (pair.kappa - exact).norm() / exact.norm();
                    assert!(error < 1e-10, "ν {nu} ξ {xi} k {k} f {friction}: {error:e}");
                    worst = worst.max(error);
                    compared += 1;
                }
            }
        }
    }
    observed("κ against the determinant of Bessel functions", worst);
    assert!(compared >= 40, "{compared}");
}
