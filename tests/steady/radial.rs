//! The radial problem against itself: orders, symmetries, limits, its Hopf points.

use brakewave::tube::model::{Damping, FrictionLaw};
use brakewave::tube::steady::growth::SteadyWave;
use brakewave::tube::steady::radial::Radial;
use brakewave::tube::steady::reduced::Reduced;
use brakewave::tube::steady::{SteadyFriction, SteadySettings, mode};

use crate::steady::{damping, observed, tube};

const TUBES: [(f64, f64); 6] = [
    (0.3, 1.5),
    (0.45, 1.25),
    (0.0, 1.5),
    (0.3, 1.02),
    (0.49, 1.5),
    (0.3, 3.0),
];

/// One radial function in each direction is the reduced model: κ = K + iS.
#[test]
fn order_one_is_the_reduced_model() {
    let mut worst: f64 = 0.0;
    for (nu, xi) in TUBES {
        for k in [1, 4, 16] {
            let reduced = Reduced::new(&tube(nu, xi).coefficients(), k);
            let kappa = Radial::new(&tube(nu, xi), k, 1).lowest(0.5, 1).unwrap()[0].kappa;
            let expected = reduced.stiffness(0.5);
            // D is a difference: its rounding is relative to what is subtracted, at most K
            worst = worst.max((kappa - expected).norm() / expected.norm());
        }
    }
    observed("order 1 against the reduced model", worst);
    assert!(worst < 1e-13, "{worst:e}");
}

#[test]
fn orders_converge_geometrically() {
    let mut worst: f64 = 0.0;
    for (nu, xi) in TUBES {
        for k in [1, 4, 8, 16] {
            let solve = |order| Radial::new(&tube(nu, xi), k, order).lowest(0.5, 4).unwrap();
            let (middle, fine) = (solve(28), solve(40));
            for (one, other) in middle.iter().zip(&fine) {
                worst = worst.max((one.kappa - other.kappa).norm() / other.kappa.norm());
            }
            // half the order is far from half the digits away
            let coarse = solve(7)[0].kappa;
            let error = (coarse - fine[0].kappa).norm() / fine[0].kappa.norm();
            assert!(error < 1e-2, "ν {nu} ξ {xi} k {k}: {error:e}");
        }
    }
    observed("κ of four families, order 28 against 40", worst);
    assert!(worst < 1e-10, "{worst:e}");
}

/// The order chosen by itself keeps the promise, up to short waves in thick tubes.
#[test]
fn the_order_chosen_is_converged() {
    let settings = |order| SteadySettings {
        friction: 0.5,
        law: FrictionLaw::Coulomb,
        mismatch: 0.2,
        damping: damping(0.05, 1e-3),
        families: 4,
        order,
    };
    for (nu, xi, k) in [
        (0.3, 1.5, 4),
        (0.3, 1.5, 48),
        (0.45, 3.0, 8),
        (0.499, 1.25, 4),
    ] {
        let geometry = tube(nu, xi);
        let coefficients = geometry.coefficients();
        let solve = |order| mode(&coefficients, Some(&geometry), k, &settings(order)).unwrap();
        let chosen = solve(None).full.unwrap();
        assert!(chosen.error < 1e-10, "{:e}", chosen.error);
        let finer = solve(Some(chosen.order + 15)).full.unwrap();
        let mut errors = vec![
            chosen.fundamental.wave.omega / finer.fundamental.wave.omega - 1.0,
            chosen.lead_wave.omega / finer.lead_wave.omega - 1.0,
            (chosen.lead_wave.growth - finer.lead_wave.growth) / finer.lead_wave.omega,
            (chosen.field_error - finer.field_error) * 1e-3,
        ];
        if let (Some(one), Some(other)) = (chosen.fundamental.hopf, finer.fundamental.hopf) {
            errors.push(one.friction / other.friction - 1.0);
            errors.push(one.omega / other.omega - 1.0);
        }
        for error in errors {
            assert!(error.abs() < 1e-10, "ν {nu} ξ {xi} k {k}: {error:e}");
        }
    }
}

/// Without friction elasticity is self-adjoint and positive.
#[test]
fn frictionless_stiffness_is_real_and_positive() {
    for (nu, xi) in TUBES {
        for pair in Radial::new(&tube(nu, xi), 4, 30).lowest(0.0, 6).unwrap() {
            assert!(pair.kappa.re > 0.0);
            assert!(
                pair.kappa.im.abs() < 1e-13 * pair.kappa.re,
                "{}",
                pair.kappa
            );
        }
    }
}

/// A thin tube is sheared like sin(πx/2ε): κ → μπ²/(4γε²); the reduced field is straight, and
/// K → 3μ/(γε²) is 12/π² of it. The next term is of relative order ε, k²ε².
#[test]
fn thin_tubes_are_sheared() {
    for epsilon in [1e-3, 1e-5] {
        let geometry = tube(0.3, 1.0 + epsilon);
        let exact = geometry.xi - 1.0;
        let mu = 0.5 / 1.3;
        let fundamental = Radial::new(&geometry, 4, 20)
            .lowest(0.1, 1)
            .unwrap()
            .remove(0);
        let limit = mu * (std::f64::consts::PI / (2.0 * exact)).powi(2);
        assert!((fundamental.kappa.re / limit - 1.0).abs() < 3.0 * epsilon);
        let reduced = Reduced::new(&geometry.coefficients(), 4).elastic;
        assert!((reduced / (3.0 * mu / (exact * exact)) - 1.0).abs() < 3.0 * epsilon);
        // sin(πs/2) against s: their cosine is (4/π²)√6 in the mean square
        let cosine = 4.0 / std::f64::consts::PI.powi(2) * 6.0_f64.sqrt();
        let error = Radial::new(&geometry, 4, 20).field_error(&fundamental);
        assert!(
            (error / (1.0 - cosine * cosine).sqrt() - 1.0).abs() < 3.0 * epsilon.sqrt(),
            "{error}"
        );
    }
}

/// (γ, α, β) → (s²γ, α/s, sβ) is a change of the unit of time: κ → κ/s², friction stays.
#[test]
fn time_scales_out() {
    let s = 1.7;
    let slow = brakewave::tube::model::coefficients::Geometry {
        gamma: s * s,
        ..tube(0.3, 1.5)
    };
    for (one, other) in [
        (damping(0.1, 0.0), damping(0.1 / s, 0.0)),
        (damping(0.1, 2e-3), damping(0.1 / s, 2e-3 * s)),
    ] {
        let of = |geometry, damping| {
            Radial::new(geometry, 4, 24)
                .hopf(3, damping, SteadyFriction::COULOMB)
                .unwrap()
        };
        let (fast, slow) = (of(&tube(0.3, 1.5), one), of(&slow, other));
        for (fast, slow) in fast.iter().zip(&slow) {
            let (fast, slow) = (fast.unwrap(), slow.unwrap());
            assert!((fast.friction / slow.friction - 1.0).abs() < 1e-11);
            assert!((fast.omega / (s * slow.omega) - 1.0).abs() < 1e-11);
        }
    }
}

/// At its Hopf point a family neither grows nor decays; above it grows, below it decays.
#[test]
fn hopf_points_are_on_the_imaginary_axis() {
    let mut worst: f64 = 0.0;
    for (nu, xi) in TUBES {
        for Damping { mass, stiffness } in [damping(0.05, 0.0), damping(0.02, 5e-4)] {
            let damping = damping(mass, stiffness);
            for k in [2, 8] {
                let radial = Radial::new(&tube(nu, xi), k, 28);
                for hopf in radial
                    .hopf(2, damping, SteadyFriction::COULOMB)
                    .unwrap()
                    .into_iter()
                    .flatten()
                {
                    let growth = |friction| {
                        let pairs = radial.lowest(friction, 6).unwrap();
                        let waves = pairs
                            .iter()
                            .map(|pair| SteadyWave::fastest(pair.kappa, k, damping));
                        waves
                            .min_by(|one, other| {
                                let distance = |wave: &SteadyWave| (wave.omega - hopf.omega).abs();
                                distance(one).total_cmp(&distance(other))
                            })
                            .unwrap()
                    };
                    let here = growth(hopf.friction);
                    worst = worst.max(here.growth.abs() / hopf.omega.abs());
                    worst = worst.max((here.omega / hopf.omega - 1.0).abs());
                    assert!(growth(1.01 * hopf.friction).growth > 0.0);
                    assert!(growth(0.99 * hopf.friction).growth < 0.0);
                }
            }
        }
    }
    observed("growth at the Hopf points over ω", worst);
    assert!(worst < 1e-11, "{worst:e}");
}

/// Where D is not small the growing wave runs with the sign of D in the tube as in the reduced
/// model: long waves, either sign, thick and thin.
#[test]
fn the_growing_wave_runs_where_the_reduced_one_does() {
    for (nu, xi, k, sign) in [
        (0.3, 1.5, 4, -1.0),
        (0.3, 1.5, 1, -1.0),
        (0.0, 1.5, 4, -1.0),
        (0.3, 3.0, 1, -1.0),
        (0.45, 1.25, 4, 1.0),
        (0.45, 1.1, 8, 1.0),
        (0.3, 1.02, 4, 1.0),
        (0.49, 1.5, 1, 1.0),
    ] {
        let geometry = tube(nu, xi);
        let settings = SteadySettings {
            friction: 0.5,
            law: FrictionLaw::Coulomb,
            mismatch: 0.2,
            damping: damping(0.0, 0.0),
            families: 1,
            order: None,
        };
        let found = mode(&geometry.coefficients(), Some(&geometry), k, &settings).unwrap();
        let full = found.full.unwrap();
        for wave in [found.reduced.wave, full.fundamental.wave] {
            assert!(
                wave.growth > 0.0 && wave.speed * sign > 0.0,
                "ν {nu} ξ {xi} k {k}"
            );
        }
        for hopf in [found.reduced.hopf, full.fundamental.hopf] {
            assert!(hopf.unwrap().omega * sign < 0.0);
        }
    }
}
