//! The reduced model: closed form against a companion matrix, and its limits.

use brakewave::tube::model::Damping;
use brakewave::tube::steady::growth::{SteadyWave, eigenvalues};
use brakewave::tube::steady::reduced::Reduced;
use faer::c64;
use nalgebra::Matrix2;

use crate::steady::{damping, observed, tube};

/// Roots of λ² + αλ + (1 + βλ)κ as eigenvalues of the companion matrix, the fastest first.
fn companion(kappa: c64, Damping { mass, stiffness }: Damping) -> [c64; 2] {
    // in units of √|κ| the matrix is balanced
    let unit = kappa.norm().sqrt();
    let middle = (c64::new(mass, 0.0) + stiffness * kappa) / unit;
    let zero = c64::new(0.0, 0.0);
    let rows = [
        [zero, c64::new(1.0, 0.0)],
        [-kappa / (unit * unit), -middle],
    ];
    let matrix = Matrix2::from_fn(|row, column| rows[row][column]);
    let mut found = matrix.eigenvalues().unwrap();
    found
        .as_mut_slice()
        .sort_by(|one, other| other.re.total_cmp(&one.re));
    [found[0] * unit, found[1] * unit]
}

/// Tubes with either sign of D, modes, and damping from none to so much that nothing grows.
fn cases() -> impl Iterator<Item = (Reduced, u32, Damping)> {
    let tubes = [(0.3, 1.5), (0.45, 1.25), (0.3, 1.02), (-0.4, 3.0)];
    let dampings = [
        (0.0, 0.0),
        (0.1, 0.0),
        (0.0, 1e-3),
        (0.05, 3e-3),
        (1.0, 1e-2),
    ];
    tubes.into_iter().flat_map(move |(nu, xi)| {
        [1, 2, 4, 8, 31].into_iter().flat_map(move |mode| {
            let reduced = Reduced::new(&tube(nu, xi).coefficients(), mode);
            dampings.map(move |(mass, stiffness)| (reduced, mode, damping(mass, stiffness)))
        })
    })
}

#[test]
fn eigenvalues_are_those_of_the_companion_matrix() {
    let mut worst: f64 = 0.0;
    for (reduced, _, damping) in cases() {
        for friction in [0.0, 1e-6, 0.1, 0.5, 3.0] {
            let kappa = reduced.stiffness(friction);
            let found = eigenvalues(kappa, damping);
            let size = found[0].norm().max(found[1].norm());
            for other in companion(kappa, damping) {
                let distance = |one: &c64| (one - other).norm() / size;
                worst = worst.max(distance(&found[0]).min(distance(&found[1])));
            }
        }
    }
    observed("eigenvalues against the companion matrix", worst);
    // two roots at distance ≥ √|κ|: their condition is of order one, and so is the matrix
    assert!(worst < 1e-14, "{worst:e}");
}

#[test]
fn the_companion_matrix_has_an_imaginary_eigenvalue_at_the_hopf_friction() {
    let (mut rate, mut frequency): (f64, f64) = (0.0, 0.0);
    let mut points = 0;
    for (reduced, _, damping) in cases() {
        let Some(hopf) = reduced.hopf(damping) else {
            // then not even a huge friction helps: Re λ < 0
            let [fastest, _] = companion(reduced.stiffness(1e6), damping);
            assert!(fastest.re < 0.0);
            continue;
        };
        let [fastest, _] = companion(reduced.stiffness(hopf.friction), damping);
        // at f = 0 without damping both are imaginary
        let omega = if hopf.friction == 0.0 {
            fastest.im.abs()
        } else {
            fastest.im
        };
        let expected = if hopf.friction == 0.0 {
            hopf.omega.abs()
        } else {
            hopf.omega
        };
        rate = rate.max(fastest.re.abs() / omega.abs());
        frequency = frequency.max((omega / expected - 1.0).abs());
        // the growing wave runs in the direction of D
        assert!(hopf.omega * reduced.coupling < 0.0);
        points += 1;
    }
    observed("growth at the Hopf friction over ω", rate);
    observed("frequency at the Hopf friction", frequency);
    assert!(
        points > 60 && rate < 1e-12 && frequency < 1e-12,
        "{points} {rate:e} {frequency:e}"
    );
}

/// Newton's method in (ω, f) on the real and imaginary part of the quadratic at λ = iω, from a
/// guess 3 per cent away: the Hopf friction without its formula.
#[test]
fn newton_on_the_quadratic_meets_the_hopf_formula() {
    let mut worst: f64 = 0.0;
    for (reduced, _, Damping { mass, stiffness }) in cases() {
        let Some(hopf) = reduced.hopf(damping(mass, stiffness)) else {
            continue;
        };
        if hopf.friction == 0.0 {
            continue;
        }
        let (k, s) = (reduced.elastic, reduced.coupling);
        let (mut omega, mut friction) = (1.03 * hopf.omega, 0.97 * hopf.friction);
        for _ in 0..60 {
            // real: K − ω² − βωfs, imaginary: αω + fs + βωK
            let real = k - omega * omega - stiffness * omega * friction * s;
            let imaginary = mass * omega + friction * s + stiffness * omega * k;
            let (real_omega, real_friction) = (
                -2.0 * omega - stiffness * friction * s,
                -stiffness * omega * s,
            );
            let (imaginary_omega, imaginary_friction) = (mass + stiffness * k, s);
            let determinant = real_omega * imaginary_friction - real_friction * imaginary_omega;
            omega -= (real * imaginary_friction - imaginary * real_friction) / determinant;
            friction -= (imaginary * real_omega - real * imaginary_omega) / determinant;
        }
        let error = (omega / hopf.omega - 1.0).abs() + (friction / hopf.friction - 1.0).abs();
        // near 1 − αβ − β²K = 0 both go to infinity, and rounding with them
        let margin = 1.0 - mass * stiffness - stiffness * stiffness * k;
        worst = worst.max(error * margin);
    }
    observed("Hopf friction and frequency against Newton's method", worst);
    assert!(worst < 1e-12, "{worst:e}");
}

/// The stick zone of the slip-stick wave (mode 4, f = 0.5) vanishes at α = 0.3189475197930335,
/// the figure of an independent program: there the wave meets the Hopf point.
#[test]
fn mass_damping_alone() {
    let coefficients = tube(0.3, 1.5).coefficients();
    let hopf = Reduced::new(&coefficients, 4)
        .hopf(damping(0.3189475197930335, 0.0))
        .unwrap();
    assert!(
        (hopf.friction / 0.5 - 1.0).abs() < 1e-13,
        "{}",
        hopf.friction
    );
    assert!((hopf.omega / (4.0 * 1.271294354034047) - 1.0).abs() < 1e-13);
    for mode in [1, 3, 16] {
        let k = f64::from(mode);
        let alpha = 0.02;
        let hopf = Reduced::new(&coefficients, mode)
            .hopf(damping(alpha, 0.0))
            .unwrap();
        let root = (coefficients.a * k * k + coefficients.h).sqrt();
        assert!(
            (hopf.friction * k * coefficients.coupling.abs() / (alpha * root) - 1.0).abs() < 1e-14
        );
        assert!((hopf.omega / root - 1.0).abs() < 1e-14);
    }
}

/// Undamped at small friction: growth |S|/(2√K), speed ±√(a + h/k²), each to its own precision.
#[test]
fn small_friction() {
    for (nu, xi, sign) in [(0.3, 1.5, -1.0), (0.45, 1.25, 1.0)] {
        let coefficients = tube(nu, xi).coefficients();
        for mode in [1, 4, 32] {
            let reduced = Reduced::new(&coefficients, mode);
            for friction in [1e-7, 1e-9, 1e-12] {
                let wave =
                    SteadyWave::fastest(reduced.stiffness(friction), mode, damping(0.0, 0.0));
                let k = f64::from(mode);
                let growth = friction * reduced.coupling.abs() / (2.0 * reduced.elastic.sqrt());
                let speed = sign * (coefficients.a + coefficients.h / (k * k)).sqrt();
                // the next terms are of relative order f²
                assert!((wave.growth / growth - 1.0).abs() < 1e-12);
                assert!((wave.speed / speed - 1.0).abs() < 1e-12);
            }
        }
    }
}
