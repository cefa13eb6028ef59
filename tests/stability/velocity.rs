//! Friction that depends on the velocity: perturbations obey equations with coefficients along the wave.

use brakewave::branch::{Stability, polish};
use brakewave::discretised::{RingSettings, SemiDiscreteWave, solve_from};
use brakewave::linalg::Vector;
use brakewave::tube::flow::method::Method;
use brakewave::tube::model::{FrictionLaw, Model};
use brakewave::tube::stability::asymptotic::HighFrequency;
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::stability::eigenfunction::eigenfunction;
use brakewave::tube::wave::Wave;

use brakewave::tube::wave::start::Which;

use crate::stability::observed;
use crate::stability::waves::{C64, tube, wave, window};

const STRIBECK: FrictionLaw = FrictionLaw::Stribeck {
    ratio: 1.1,
    velocity: 0.5,
};
const SMOOTH: FrictionLaw = FrictionLaw::Regularised { epsilon: 0.1 };

/// The tube of the mode-4 branches under a law.
fn under(law: FrictionLaw, friction: f64, mismatch: f64) -> (Wave, Vector) {
    let model = Model {
        law,
        ..tube(0.3, 1.5, friction, mismatch)
    };
    wave(&model, 4, Which::Fast)
}

fn linearised((wave, point): &(Wave, Vector)) -> Characteristic {
    Characteristic::new(wave, point).expect("friction is smooth enough")
}

/// Waves of several signatures.
fn specimens() -> Vec<(Wave, Vector)> {
    let stribeck = [0.15, 0.1, 0.04].map(|mismatch| under(STRIBECK, 0.3, mismatch));
    let smooth = [0.2, 0.045].map(|mismatch| under(SMOOTH, 0.5, mismatch));
    let narrow = under(FrictionLaw::Regularised { epsilon: 0.02 }, 0.5, 0.2);
    stribeck.into_iter().chain(smooth).chain([narrow]).collect()
}

/// A shifted wave is a wave.
#[test]
fn zero_is_an_eigenvalue() {
    for specimen in specimens() {
        let characteristic = linearised(&specimen);
        let [trace, determinant] = characteristic.evaluate(C64::new(0.0, 0.0)).numbers();
        let defect = (1.0 - trace + determinant).norm();
        observed(&format!("translation of {}", specimen.0.signature), defect);
        // the tolerance of the methods times the growth of a zone
        assert!(defect < 1e-10, "{}: {defect:e}", specimen.0.signature);
    }
}

/// A law whose ratio is one is Coulomb's, whose flow has a closed form.
#[test]
fn constant_friction_is_the_exact_flow() {
    let constant = FrictionLaw::Stribeck {
        ratio: 1.0,
        velocity: 0.5,
    };
    for mismatch in [0.15, 0.05, 0.03] {
        let exact = linearised(&under(FrictionLaw::Coulomb, 0.5, mismatch));
        let along = linearised(&under(constant, 0.5, mismatch));
        for (re, im) in [(0.0, 0.0), (0.1, 2.5), (-0.4, 12.0), (0.05, 150.0)] {
            let lambda = C64::new(re, im);
            let [one, other] = [&exact, &along].map(|of| of.evaluate(lambda).trace);
            let error = (one.number() - other.number()).norm() / one.number().norm().max(1.0);
            // the tolerance 1e-13 of the wave, turned by λT
            assert!(error < 1e-11 * (1.0 + im), "λ = {lambda}: {error:e}");
        }
        let [one, other] = [&exact, &along].map(|of| HighFrequency::new(of).limit());
        assert!((one - other).abs() < 1e-10, "{one} {other}");
    }
}

/// Derivatives against central differences of second order, which err by (hT)²/6 and by rounding.
#[test]
fn derivatives_are_those_of_the_values() {
    for specimen in specimens() {
        let characteristic = linearised(&specimen);
        for (re, im) in [(0.0, 0.3), (0.1, 2.5), (-0.4, 12.0), (0.1, 60.0)] {
            let (lambda, h) = (C64::new(re, im), 1e-5);
            let of = |lambda: C64| {
                let [trace, determinant] = characteristic.evaluate(lambda).numbers();
                1.0 - trace + determinant
            };
            let difference = (of(lambda + h) - of(lambda - h)) / (2.0 * h);
            let value = characteristic.evaluate(lambda);
            let (f, by) = value.sector(C64::new(1.0, 0.0));
            let exact = by / f * of(lambda);
            let error = (difference - exact).norm() / (1.0 + exact.norm());
            let claim = format!("{} at {lambda}", specimen.0.signature);
            assert!(error < 1e-7, "{claim}: {error:e}");
        }
    }
}

/// t tends to its limit like 1/ω.
#[test]
fn high_frequencies_see_the_means() {
    let characteristic = linearised(&under(STRIBECK, 0.3, 0.15));
    let high = HighFrequency::new(&characteristic);
    let error = |im: f64| {
        let lambda = C64::new(0.02, im);
        let [trace, _] = characteristic.evaluate(lambda).numbers();
        (trace - high.trace_at(lambda)).norm() * im
    };
    let largest = |from: f64| {
        (0..40)
            .map(|n| error(from + 0.3 * f64::from(n)))
            .fold(0.0, f64::max)
    };
    let (near, far) = (largest(100.0), largest(1000.0));
    observed("error of the limit times ω", far);
    assert!(far < 1.3 * near, "{near} {far}");
    assert!(far < 20.0, "{far}");
}

fn nearest(wave: &SemiDiscreteWave, sector: u32, to: C64) -> C64 {
    let all = wave.eigenvalues(sector, 12.0, 400).expect("eigenvalues");
    let near = all.into_iter().map(|one| C64::new(one.re, one.im));
    near.min_by(|one, other| (one - to).norm().total_cmp(&(other - to).norm()))
        .expect("an eigenvalue")
}

/// The ring knows nothing of fronts and of coefficients along the wave. It errs like Δφ²: from n and 2n
/// points its leading eigenvalues extrapolate to these.
#[test]
fn rings_extrapolate_to_these_eigenvalues() {
    let narrow = 2e-4;
    for (law, friction, mismatch, epsilon) in
        [(SMOOTH, 0.5, 0.2, 0.1), (STRIBECK, 0.3, 0.15, narrow)]
    {
        let (wave, point) = under(law, friction, mismatch);
        let spectrum = window(&linearised(&(wave.clone(), point.clone())));
        assert!(spectrum.complete);
        let rings = [60, 120].map(|points| {
            let settings = RingSettings {
                points,
                epsilon,
                ..RingSettings::default()
            };
            solve_from(&wave, &point, &settings).expect("a ring")
        });
        let leading = spectrum.sectors.iter().flat_map(|sector| {
            let first = spectrum.listed(sector).next();
            first.map(|one| (sector.sector as u32, one.value()))
        });
        for (sector, exact) in leading {
            let [coarse, fine] = [&rings[0], &rings[1]].map(|ring| nearest(ring, sector, exact));
            let extrapolated = fine + (fine - coarse) / 3.0;
            let (error, before) = ((extrapolated - exact).norm(), (fine - exact).norm());
            observed(
                &format!("{law:?}, sector {sector}: {exact}, ring {fine}"),
                error,
            );
            assert!(
                error < 0.3 * before,
                "{law:?}, sector {sector}: {error:e} {before:e}"
            );
        }
    }
}

/// A coarse method errs, and the column says by how much.
#[test]
fn errors_contain_those_of_the_wave() {
    for law in [
        STRIBECK,
        FrictionLaw::Stribeck {
            ratio: 1.3,
            velocity: 0.8,
        },
    ] {
        let (wave, point) = under(law, 0.3, 0.15);
        let fine = window(&linearised(&(wave.clone(), point.clone())));
        let coarse = wave.clone().with_method(Method::Collocation {
            intervals: 8,
            degree: 3,
        });
        let moved = polish(&coarse, &point).expect("the coarse method solves it too");
        let found = window(&linearised(&(coarse, moved)));
        let (mut worst, mut share) = (0.0_f64, 0.0_f64);
        for (one, other) in fine.sectors.iter().zip(&found.sectors) {
            for exact in one.eigenvalues.iter().filter(|one| one.re > -0.3) {
                let all = other.eigenvalues.iter();
                let error = |known: &&brakewave::tube::stability::spectrum::WaveEigenvalue| {
                    (known.value() - exact.value()).norm()
                };
                let near = all
                    .min_by(|a, b| error(a).total_cmp(&error(b)))
                    .expect("one");
                worst = worst.max(error(&near));
                share = share.max(error(&near) / near.error);
                assert!(error(&near) <= near.error, "{near:?} {exact:?}");
            }
        }
        observed("coarse collocation", worst);
        observed("share of the stated error", share);
        assert!(worst > 1e-9, "{worst:e}");
    }
}

/// Eigenfunctions satisfy the equations with their coefficients along the wave, and close.
#[test]
fn eigenfunctions_satisfy_their_equations() {
    for specimen in specimens() {
        let characteristic = linearised(&specimen);
        let spectrum = window(&characteristic);
        let speed = specimen.0.speed_at(&specimen.1);
        let sector = &spectrum.sectors[1];
        let first = spectrum.listed(sector).next().expect("an eigenvalue");
        let shape = eigenfunction(&characteristic, speed, 1, first.value(), 60);
        let (equation, closure) = (shape.equation_residual, shape.closure_residual);
        observed(&format!("equations of {}", specimen.0.signature), equation);
        // differences of sixth order, across what tanh makes of a front where friction is smooth
        assert!(equation < 1e-4, "{equation:e}");
        assert!(closure < 1e-9, "{closure:e}");
    }
}

/// Damping makes such waves stable, and that is decided; a window is never the whole answer.
#[test]
fn verdicts_are_decided() {
    let spectrum = window(&linearised(&under(STRIBECK, 0.3, 0.15)));
    assert_eq!(spectrum.stable, Stability::No, "{:?}", spectrum.reasons);
}
