//! Friction laws beyond Coulomb's.

use brakewave::orbit::sign::SignVerdict;
use brakewave::tube::flow::method::Method;
use brakewave::tube::model::FrictionLaw;
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::wave::admissibility::examine;
use nalgebra::Complex;

use crate::methods::observed;
use crate::methods::waves::{by_method, difference, fast, tube};

/// Shooting and collocation share the right side alone, and agree on a Stribeck wave.
#[test]
fn stribeck_by_both_methods() {
    let law = FrictionLaw::Stribeck {
        ratio: 1.1,
        velocity: 0.5,
    };
    for mismatch in [0.15, 0.1, 0.04] {
        let (wave, shot) = fast(&tube(0.3, mismatch, law));
        let collocated = by_method(
            &wave,
            &shot,
            Method::Collocation {
                intervals: 40,
                degree: 4,
            },
        );
        let error = difference(&wave, &shot, &collocated);
        observed(
            &format!("Stribeck, {} at δ = {mismatch}", wave.signature),
            error,
        );
        assert!(error < 1e-9, "{error:e}");
    }
}

/// A law whose ratio is one is Coulomb's.
#[test]
fn ratio_one_is_coulomb() {
    let (wave, coulomb) = fast(&tube(0.3, 0.15, FrictionLaw::Coulomb));
    for law in [
        FrictionLaw::Static { ratio: 1.0 },
        FrictionLaw::Stribeck {
            ratio: 1.0,
            velocity: 0.5,
        },
    ] {
        let (other, found) = fast(&tube(0.3, 0.15, law));
        assert_eq!(wave.signature, other.signature);
        let error = difference(&wave, &coulomb, &found);
        observed(&format!("{law:?} against Coulomb"), error);
        // the tolerance 1e-13 of shooting times the condition of the wave
        assert!(error < 1e-11, "{law:?}: {error:e}");
    }
}

/// Static friction: the exact flow agrees with shooting, and λ = 0 is an eigenvalue with the jump of
/// the perturbation at release.
#[test]
fn static_friction() {
    let law = FrictionLaw::Static { ratio: 1.3 };
    for mismatch in [0.3, 0.2, 0.12] {
        let (wave, exact) = fast(&tube(0.4, mismatch, law));
        assert_eq!(wave.method, Method::Exact);
        let verdict = examine(&wave, &exact).expect("an examination").verdict;
        assert_eq!(verdict, SignVerdict::Positive);
        let shot = by_method(&wave, &exact, Method::Shooting { tolerance: 1e-13 });
        let error = difference(&wave, &exact, &shot);
        observed(&format!("static friction at δ = {mismatch}"), error);
        assert!(error < 1e-10, "{error:e}");
        let characteristic = Characteristic::new(&wave, &exact).expect("piecewise linear");
        let zero = characteristic.evaluate(Complex::new(0.0, 0.0));
        let defect = (zero.trace.number() - 1.0).norm();
        observed(&format!("translation mode at δ = {mismatch}"), defect);
        assert!(defect < 1e-11, "{defect:e}");
    }
}

/// Regularised friction tends to Coulomb's: the error of the speed falls like ε, and so do three
/// differences in a row by their ratio. Below take-off the first wave is found next to Coulomb's.
#[test]
fn regularised_friction_tends_to_coulomb() {
    for (mismatch, zones) in [(0.2, 1), (0.045, 2)] {
        let (wave, coulomb) = fast(&tube(0.5, mismatch, FrictionLaw::Coulomb));
        let speed = wave.speed_at(&coulomb);
        let errors: Vec<f64> = [4e-3, 2e-3, 1e-3]
            .into_iter()
            .map(|epsilon| {
                let law = FrictionLaw::Regularised { epsilon };
                let (smooth, point) = fast(&tube(0.5, mismatch, law));
                let verdict = examine(&smooth, &point).expect("an examination").verdict;
                assert_eq!(verdict, SignVerdict::Positive);
                assert_eq!(smooth.zones(), zones, "{}", smooth.signature);
                (smooth.speed_at(&point) / speed - 1.0).abs()
            })
            .collect();
        observed("speed at ε = 1e-3 against the limit", errors[2]);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            observed("order in ε", order);
            // ε times powers of ln ε
            assert!((0.8..1.05).contains(&order), "δ = {mismatch}: {errors:?}");
        }
    }
}
