//! Friction that depends on the velocity: its slope at steady sliding against computations that differentiate the
//! law by themselves.

use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Damping, FrictionLaw};
use brakewave::tube::steady::growth::stiffness_at;
use brakewave::tube::steady::radial::Radial;
use brakewave::tube::steady::{SteadyFriction, SteadyMode, SteadySettings, mode};
use faer::c64;
use nalgebra::Matrix2;

use crate::steady::bessel::{LARGEST_ARGUMENT, determinant, root};
use crate::steady::{damping, observed, tube};

const MISMATCH: f64 = 0.2;

const LAWS: [FrictionLaw; 3] = [
    FrictionLaw::Stribeck {
        ratio: 1.4,
        velocity: 0.7,
    },
    FrictionLaw::Stribeck {
        ratio: 2.5,
        velocity: 3.0,
    },
    // wide enough to have a slope where the tube slides
    FrictionLaw::Regularised { epsilon: 0.4 },
];

/// The coefficient of friction by unit of f, as the documentation of the laws has it.
fn coefficient(law: FrictionLaw, rate: f64) -> f64 {
    let sliding: f64 = 1.0 - rate;
    match law {
        FrictionLaw::Coulomb | FrictionLaw::Static { .. } => 1.0,
        FrictionLaw::Stribeck { ratio, velocity } => {
            1.0 + (ratio - 1.0) * (-sliding / velocity).exp()
        }
        FrictionLaw::Regularised { epsilon } => (sliding / epsilon).tanh(),
    }
}

/// Its slope in V̇ where V̇ = 0: a central difference of fourth order, exact to 1e-12.
fn slope(law: FrictionLaw) -> f64 {
    let step = 1e-3;
    let at = |times: f64| coefficient(law, times * step);
    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step)
}

fn solve(
    geometry: &Geometry,
    k: u32,
    friction: f64,
    law: FrictionLaw,
    damping: Damping,
) -> SteadyMode {
    let settings = SteadySettings {
        friction,
        law,
        mismatch: MISMATCH,
        damping,
        families: 1,
        order: Some(24),
    };
    mode(&geometry.coefficients(), Some(geometry), k, &settings).unwrap()
}

/// The largest real part among the eigenvalues of v̈ = −αv̇ − K(v + βv̇) + fS(0)p + fS′(0)gδv̇,
/// p = −ikD(v + βv̇), and its imaginary part.
fn companion(geometry: &Geometry, k: u32, f: f64, law: FrictionLaw, with: Damping) -> c64 {
    let c = geometry.coefficients();
    let k = f64::from(k);
    let elastic = c64::new(
        c.a * k * k + c.h,
        k * c.coupling * f * coefficient(law, 0.0),
    );
    let rubbed = f * slope(law) * c.g * MISMATCH;
    let rows = [
        [c64::new(0.0, 0.0), c64::new(1.0, 0.0)],
        [-elastic, -elastic * with.stiffness - with.mass + rubbed],
    ];
    let matrix = Matrix2::from_fn(|row, column| rows[row][column]);
    let found = matrix.eigenvalues().unwrap();
    if found[0].re >= found[1].re {
        found[0]
    } else {
        found[1]
    }
}

#[test]
fn the_reduced_model_has_the_eigenvalues_of_its_linearised_equation() {
    let mut worst: f64 = 0.0;
    for law in LAWS {
        for (nu, xi) in [(0.3, 1.5), (0.45, 1.25)] {
            for k in [1, 4, 8] {
                for with in [damping(0.0, 0.0), damping(0.3, 0.0), damping(0.1, 2e-3)] {
                    let found = solve(&tube(nu, xi), k, 0.5, law, with).reduced.wave;
                    let exact = companion(&tube(nu, xi), k, 0.5, law, with);
                    let error = (c64::new(found.growth, found.omega) - exact).norm() / exact.norm();
                    worst = worst.max(error);
                }
            }
        }
    }
    observed("λ against a matrix with a difference for the slope", worst);
    // the difference itself is exact to 1e-12 of a slope of order one
    assert!(worst < 1e-11, "{worst:e}");
}

/// σ_rφ = fS(0)σ_rr − p₀fS′(0)λ/(1 + βλ)v at the shaft, in Bessel functions.
#[test]
fn the_tube_meets_the_bessel_functions_under_every_law() {
    let (mut worst, mut compared): (f64, usize) = (0.0, 0);
    for law in LAWS {
        for (nu, xi, gamma) in [(0.3, 1.5, 1.0), (0.0, 1.5, 2.0)] {
            for k in [1, 4] {
                for with in [damping(0.0, 0.0), damping(0.1, 2e-3)] {
                    let geometry = Geometry { nu, xi, gamma };
                    let found = solve(&geometry, k, 0.5, law, with).full.unwrap();
                    let wave = found.fundamental.wave;
                    let start = c64::new(wave.growth, wave.omega);
                    let (kappa, _) = stiffness_at(start, with);
                    let mu = 0.5 / (1.0 + nu);
                    if (gamma * kappa.norm() / mu).sqrt() * xi > LARGEST_ARGUMENT {
                        continue;
                    }
                    let pressure = MISMATCH * (xi * xi + 1.0 / (1.0 - 2.0 * nu))
                        / ((xi * xi - 1.0) * (1.0 + nu));
                    let rubbed = 0.5 * pressure * slope(law);
                    let exact = root(
                        |lambda| {
                            let drag = rubbed * lambda / (1.0 + with.stiffness * lambda);
                            let kappa = stiffness_at(lambda, with).0;
                            let friction = 0.5 * coefficient(law, 0.0);
                            determinant(&geometry, k, friction, drag, kappa)
                        },
                        start * (1.0 + 1e-7),
                    );
                    let error = (start - exact).norm() / exact.norm();
                    assert!(error < 1e-9, "{law:?} ν {nu} ξ {xi} k {k}: {error:e}");
                    worst = worst.max(error);
                    compared += 1;
                }
            }
        }
    }
    observed("λ of the tube against Bessel functions", worst);
    assert!(compared >= 20, "{compared}");
}

/// One radial function is the reduced model, Hopf points included.
#[test]
fn order_one_is_the_reduced_model_under_every_law() {
    let with = damping(0.6, 1e-3);
    for law in LAWS {
        let geometry = tube(0.3, 1.5);
        let coefficients = geometry.coefficients();
        let sliding = SteadyFriction::new(law, coefficients.g * MISMATCH);
        let radial = Radial::new(&geometry, 4, 1);
        let mut pair = radial.lowest(0.5 * sliding.strength, 1).unwrap().remove(0);
        let lambda = radial.leading(&mut pair, 0.5, sliding, with).unwrap();
        let reduced = solve(&geometry, 4, 0.5, law, with).reduced;
        let wave = c64::new(reduced.wave.growth, reduced.wave.omega);
        assert!(
            (lambda - wave).norm() < 1e-12 * wave.norm(),
            "{lambda} {wave}"
        );
        let hopf = radial.hopf(1, with, sliding).unwrap()[0].unwrap();
        let closed = reduced.hopf.unwrap();
        assert!((hopf.friction / closed.friction - 1.0).abs() < 1e-11);
        assert!((hopf.omega / closed.omega - 1.0).abs() < 1e-11);
    }
}

/// At the friction of the Hopf point, and only there, growth changes its sign.
#[test]
fn growth_begins_at_the_hopf_friction() {
    let mut points = 0;
    for law in LAWS {
        for with in [damping(0.6, 0.0), damping(0.6, 1e-3)] {
            let k = 4;
            let geometry = tube(0.3, 1.5);
            let at = |friction| solve(&geometry, k, friction, law, with);
            let here = at(0.1);
            let hopf = here.reduced.hopf.unwrap();
            let wave = |share: f64| at(share * hopf.friction).reduced.wave;
            let (below, on, above) = (wave(0.99), wave(1.0), wave(1.01));
            assert!(below.growth < 0.0 && above.growth > 0.0, "{law:?} k {k}");
            assert!(on.growth.abs() < 1e-12 * on.omega.abs());
            assert!((on.omega / hopf.omega - 1.0).abs() < 1e-12);
            let hopf = here.full.unwrap().fundamental.hopf.unwrap();
            let wave = |share: f64| at(share * hopf.friction).full.unwrap().fundamental.wave;
            let (below, on, above) = (wave(0.99), wave(1.0), wave(1.01));
            assert!(below.growth < 0.0 && above.growth > 0.0, "{law:?} k {k}");
            assert!(on.growth.abs() < 1e-10 * on.omega.abs(), "{}", on.growth);
            points += 2;
        }
    }
    assert_eq!(points, 12);
}

/// Static friction is Coulomb's while the tube slides; the others tend to it, linearly in their slope.
#[test]
fn the_laws_tend_to_coulombs() {
    let (geometry, with) = (tube(0.3, 1.5), damping(0.1, 1e-3));
    let of = |law| {
        let found = solve(&geometry, 4, 0.5, law, with);
        (found.reduced, found.full.unwrap())
    };
    let coulomb = of(FrictionLaw::Coulomb);
    assert_eq!(of(FrictionLaw::Static { ratio: 1.5 }), coulomb);
    let distance = |law| {
        let found = of(law);
        let off = |one: f64, other: f64| (one - other).abs();
        [
            off(found.0.wave.growth, coulomb.0.wave.growth),
            off(found.1.lead_wave.growth, coulomb.1.lead_wave.growth),
            off(
                found.0.hopf.unwrap().friction,
                coulomb.0.hopf.unwrap().friction,
            ),
            off(
                found.1.fundamental.hopf.unwrap().friction,
                coulomb.1.fundamental.hopf.unwrap().friction,
            ),
        ]
    };
    let stribeck = |more: f64| FrictionLaw::Stribeck {
        ratio: 1.0 + more,
        velocity: 0.5,
    };
    for (near, nearer) in distance(stribeck(1e-4))
        .into_iter()
        .zip(distance(stribeck(1e-5)))
    {
        assert!(
            near > 1e-8 && (near / nearer - 10.0).abs() < 0.01,
            "{near} {nearer}"
        );
    }
}

/// Friction so large that nothing else counts in its row: an answer in a moment, that of its limit.
#[test]
fn huge_friction_has_a_limit() {
    let geometry = tube(0.3, 1.5);
    let radial = Radial::new(&geometry, 4, 24);
    let of = |friction: f64| radial.lowest(friction, 3).unwrap();
    for (one, other) in of(1e12).iter().zip(&of(1e16)) {
        let error = (one.kappa - other.kappa).norm() / other.kappa.norm();
        assert!(error < 1e-10, "{error:e}");
    }
}
