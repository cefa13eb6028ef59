//! F₀′(0) = d(cT)/dc along the waves of any wavelength.
//!
//! A wave of speed c + ε is a perturbation of the wave of speed c that grows like t: with V(s; c) at the
//! material point φ = 0, c∂V/∂c is the derivative in λ of the eigenfunction that begins as V̇ at λ = 0.
//! From release to arrest N′(0) = c d(V_a − T_a − V_r)/dc = −c dT/dc, and F₀ = 1 − Ne^{−λT}. The right side
//! comes from the Jacobian of the nonlinear wave, which knows nothing of perturbations: it sees every
//! term of a jump that is linear in λ, as the changed speed of a front is.

use std::collections::BTreeMap;

use brakewave::continuation::newton::Equations;
use brakewave::linalg::{Matrix, Vector};
use brakewave::problem;
use brakewave::tube::model::Impact;
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::wave::Wave;
use nalgebra::{DMatrix, DVector};

use crate::stability::observed;
use crate::stability::waves::{C64, follow};

/// d(cT)/dc: the equations but the last, which sets the wavelength, are solved for dx/d ln e,
/// |c| = √a(1 + e).
fn slope_of_wavelength(wave: &Wave, point: &Vector) -> f64 {
    let n = wave.unknowns() - 1;
    let mut jacobian = Matrix::zeros(n, n + 1);
    wave.evaluate(point, &mut vec![0.0; n], &mut jacobian)
        .expect("the equations can be evaluated");
    let free = DMatrix::from_fn(n - 1, n - 1, |i, j| jacobian[(i, j)]);
    let right = DVector::from_fn(n - 1, |i, _| -jacobian[(i, n - 1)]);
    let moved = free.full_piv_lu().solve(&right).expect("a regular wave");
    let row = |j: usize| jacobian[(n - 1, j)];
    let lengthened: f64 = (0..n - 1).map(|j| row(j) * moved[j]).sum::<f64>() + row(n - 1);
    let excess = wave.excess_at(point);
    let unit = wave.speed_at(point).abs() / (1.0 + excess) * excess;
    std::f64::consts::TAU / f64::from(wave.mode) * lengthened / unit
}

/// F₀′(0) where F₀ is 1 − N e^{−λT}.
fn slope_of_characteristic(characteristic: &Characteristic) -> f64 {
    let value = characteristic.evaluate(C64::new(0.0, 0.0));
    let (_, by) = value.sector(C64::new(1.0, 0.0));
    let unit = value.unit.value * (value.unit.exponent - value.top()).exp();
    (by / unit).re
}

/// Both sides along a branch, and |F₀(0)|, every signature with a stick zone by itself.
fn compare(text: &str, impact: Impact, beta: f64) -> BTreeMap<String, f64> {
    let mut problem = problem::parse(text, "wavelength").expect("a problem");
    problem.model.impact = impact;
    problem.model.damping.stiffness = beta;
    let mut worst = BTreeMap::new();
    for item in follow(&problem, text).items {
        if item.point.kind.is_some() || !item.point.regimes.ends_with("stick") {
            continue;
        }
        let (wave, point) = item.wave();
        let characteristic = Characteristic::new(wave, point).expect("a linear law");
        let [one, _] = characteristic.evaluate(C64::new(0.0, 0.0)).numbers();
        let slopes = [
            slope_of_characteristic(&characteristic),
            slope_of_wavelength(wave, point),
        ];
        let size = characteristic.period.max(slopes[1].abs());
        let error = ((slopes[0] - slopes[1]).abs() / size).max((one - 1.0).norm());
        let name = format!("{}, β = {beta}", item.point.regimes);
        assert!(error < BOUND, "{name}, {impact:?}: {slopes:?}, {one}");
        let entry = worst.entry(name).or_insert(0.0_f64);
        *entry = entry.max(error);
    }
    worst
}

/// The tolerance of the equations of a wave: beside an event U̇⁻ is small, and errors of this size count.
const BOUND: f64 = 1e-10;

#[test]
fn slope_at_zero_is_that_of_the_wavelength() {
    let text = |nu: f64, friction: f64, low: f64, high: f64| {
        format!(
            "(model: (coefficients: Geometry(nu: {nu:?}, xi: 1.5, gamma: 1.0), friction: {friction:?}, \
             mismatch: {high:?}), wave: (mode: 4, start: Fast), continuation: (parameter: Mismatch, \
             range: ({low:?}, {high:?}), toward: Down))"
        )
    };
    for (impact, beta, nu, friction, low, high) in [
        (Impact::Frictionless, 0.0, 0.3, 0.5, 0.001, 0.2),
        (Impact::Coulomb, 0.0, 0.3, 0.5, 0.001, 0.2),
        // with touches
        (Impact::Coulomb, 0.0, -0.3, 0.3, 0.01, 1.0),
        (Impact::Frictionless, 5e-3, 0.3, 0.5, 0.004, 0.2),
        (Impact::Frictionless, 1e-3, 0.3, 0.5, 0.004, 0.2),
        (Impact::Frictionless, 1e-5, 0.3, 0.5, 0.004, 0.2),
    ] {
        let worst = compare(&text(nu, friction, low, high), impact, beta);
        for (regimes, error) in &worst {
            observed(
                &format!("F₀(0) and F₀′(0) of {regimes}, {impact:?}"),
                *error,
            );
        }
        let separated = worst.keys().filter(|one| one.contains("separation"));
        assert!(separated.count() > 1, "{worst:?}");
    }
}
