//! Eigenfunctions satisfy the equations, close over the wavelength, and follow Bloch's rule.

use brakewave::tube::model::Model;
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::eigenfunction::{Eigenfunction, eigenfunction};
use brakewave::tube::wave::start::Which;

use crate::stability::observed;
use crate::stability::waves::{C64, mode4, tube, wave, window, with_coulomb_impact};

const RESOLUTION: usize = 120;

/// |⟨one, other⟩| of two eigenfunctions of unit size.
fn overlap(one: &Eigenfunction, other: &Eigenfunction) -> f64 {
    let product = |one: &Eigenfunction, other: &Eigenfunction| -> C64 {
        let pairs = one.samples.iter().zip(&other.samples);
        pairs.map(|(a, b)| a.psi.conj() * b.psi).sum()
    };
    product(one, other).norm() / (product(one, one).norm() * product(other, other).norm()).sqrt()
}

#[test]
fn equations_closure_norm_and_bloch_factor() {
    let cases: [(Model, u32); 10] = [
        (mode4(0.2), 4),
        (mode4(0.08), 4),
        (mode4(0.045), 4),
        (mode4(0.02), 4),
        (mode4(0.001), 4),
        (tube(0.25, 1.25, 0.446, 0.06), 8),
        (tube(0.45, 1.25, 0.1, 0.1), 4),
        (tube(0.45, 1.25, 0.1, 0.01), 4),
        (with_coulomb_impact(0.045), 4),
        (with_coulomb_impact(0.01), 4),
    ];
    let [mut equation, mut closure, mut norm, mut bloch] = [0.0_f64; 4];
    let mut largest_overlap = 0.0_f64;
    for (model, mode) in cases {
        let (wave, point) = wave(&model, mode, Which::Fast);
        let characteristic = Characteristic::new(&wave, &point).expect("a linear law");
        let speed = wave.speed_at(&point);
        let spectrum = window(&characteristic);
        let translation = eigenfunction(&characteristic, speed, 0, C64::new(0.0, 0.0), RESOLUTION);
        equation = equation.max(translation.equation_residual);
        for sector in &spectrum.sectors {
            for eigenvalue in spectrum.listed(sector).take(4) {
                let lambda = eigenvalue.value();
                let name = format!("{model:?}, sector {}, {lambda}", sector.sector);
                let mode_shape =
                    eigenfunction(&characteristic, speed, sector.sector, lambda, RESOLUTION);
                equation = equation.max(mode_shape.equation_residual);
                closure = closure.max(mode_shape.closure_residual);
                assert!(
                    mode_shape.equation_residual < 1e-8,
                    "{name}: {:e}",
                    mode_shape.equation_residual
                );
                assert!(
                    mode_shape.closure_residual < 1e-11,
                    "{name}: {:e}",
                    mode_shape.closure_residual
                );
                let samples = &mode_shape.samples;
                let first = samples[0];
                let size = first.psi * first.psi + first.slope * first.slope;
                norm = norm.max((size - 1.0).norm());
                assert!((size - 1.0).norm() < 1e-12, "{name}: {size}");
                // |θ| runs time-forward: against θ for c > 0
                let lap = samples.len() / mode as usize;
                let turn = std::f64::consts::TAU / f64::from(mode);
                let angle = std::f64::consts::TAU * sector.sector as f64 / f64::from(mode);
                let factor = C64::from_polar(1.0, angle);
                for (one, next) in samples.iter().zip(&samples[lap..]) {
                    assert!((next.theta - one.theta - turn).abs() < 1e-10, "{name}");
                    let error = (next.psi - factor * one.psi).norm()
                        + (next.slope - factor * one.slope).norm();
                    bloch = bloch.max(error / (1.0 + one.psi.norm() + one.slope.norm()));
                }
                // and the circle closes: the end of the last lap is its beginning
                let (end, start) = (samples[samples.len() - 1], samples[0]);
                let error = (end.psi - start.psi).norm() / (1.0 + start.psi.norm());
                assert!(error < 1e-10, "{name}: {error:e}");
                if sector.sector == 0 {
                    let other = overlap(&mode_shape, &translation);
                    largest_overlap = largest_overlap.max(other);
                    assert!(other < 0.999, "{name}: {other}");
                }
            }
        }
    }
    assert!(bloch < 1e-12, "{bloch:e}");
    observed("equations of the eigenfunctions", equation);
    observed("closure of the eigenfunctions", closure);
    observed("ψ(0)² + ψ′(0)² − 1", norm);
    observed("ψ(θ + 2π/k) against its factor", bloch);
    println!("observed: largest overlap of another mode: {largest_overlap:.6}");
}
