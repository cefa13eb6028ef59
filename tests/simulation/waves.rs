//! Waves of the boundary-value problem, put on the ring: they travel at their speed, and their
//! perturbations grow and decay as the eigenfunction problem says. The figures compared with were
//! computed by an independent program.

use brakewave::simulation::growth::{self, Request, SETTLING, SimulatedEigenvalue, place};
use brakewave::simulation::ring::{Order, Ring, courant_step};

use crate::simulation::{parameters, setup, wave};

/// Phase speed of the fundamental over the second of two times that the wave takes for its length.
fn speed(points: usize, order: Order) -> f64 {
    let profile = wave(0.2);
    let parameters = parameters(0.2, 0.0);
    let angle = profile.wavelength();
    let period = angle / profile.speed().abs();
    let steps = (period / courant_step(&parameters, points, angle, 0.2)).ceil();
    let setup = setup(points, angle, order, period / steps);
    let mut ring = Ring::new(&parameters, setup).expect("a ring");
    place(&mut ring, &profile);
    let phase = |ring: &Ring| {
        let mut sum = [0.0; 2];
        for (point, v) in ring.nodes().tangential.iter().enumerate() {
            let (sine, cosine) = (std::f64::consts::TAU * point as f64 / points as f64).sin_cos();
            sum[0] += v * cosine;
            sum[1] -= v * sine;
        }
        sum[1].atan2(sum[0])
    };
    ring.advance(steps as u64);
    let before = phase(&ring);
    ring.advance(steps as u64);
    // after a period the phase is back, but for what the speed is off by
    let turn = std::f64::consts::TAU;
    let late = (phase(&ring) - before + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
    profile.speed() - late / turn * angle / period
}

#[test]
fn the_wave_travels_at_its_speed() {
    const SPEED: f64 = -1.242700800630082;
    let errors = |order| [48, 96, 192, 384].map(|points| (speed(points, order) - SPEED).abs());
    let second = errors(Order::Second);
    // order 2: halving the spacing divides the error by four, give or take where the fronts stand
    for pair in second.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.6..2.6).contains(&order), "{second:?}");
    }
    // across fronts there is no order 4, but far less error
    let fourth = errors(Order::Fourth);
    assert!(
        fourth[3] < 0.2 * second[3] && fourth[3] < 2e-6,
        "{fourth:?} {second:?}"
    );
}

fn eigenvalues(
    mismatch: f64,
    points: usize,
    sector: usize,
    pairs: usize,
) -> Vec<SimulatedEigenvalue> {
    let profile = wave(mismatch);
    let request = Request {
        points,
        waves: if sector == 0 { 1 } else { 4 },
        sector,
        shift: points,
        courant: 0.2,
        // the step is smooth in the state where nothing lifts off; landings need some averaging
        amplitude: if mismatch > 0.1 { 1e-6 } else { 3e-4 },
        pairs,
        settling: SETTLING,
    };
    let setup = setup(points, profile.wavelength(), Order::Fourth, 1.0);
    growth::averaged(
        &parameters(mismatch, 0.0),
        &setup,
        &profile,
        &request,
        2,
        &mut || (),
    )
    .expect("eigenvalues")
}

/// Compares eigenvalues of two grids with references. With errors that fall at least in proportion
/// to the spacing, that of the finer grid is no larger than the difference of the two; to this come
/// four standard errors of each and the residual of the shape.
#[track_caller]
fn compare(mismatch: f64, sector: usize, pairs: usize, references: &[[f64; 2]], most: f64) {
    let (coarse, fine) = (
        eigenvalues(mismatch, 96, sector, pairs),
        eigenvalues(mismatch, 192, sector, pairs),
    );
    for [re, im] in references {
        let nearest = |set: &[SimulatedEigenvalue]| {
            set.iter()
                .copied()
                .min_by(|one, other| {
                    let off = |value: &SimulatedEigenvalue| (value.re - re).hypot(value.im - im);
                    off(one).total_cmp(&off(other))
                })
                .expect("an eigenvalue")
        };
        let (rough, value) = (nearest(&coarse), nearest(&fine));
        let off = (value.re - re).hypot(value.im - im);
        let allowed = (value.re - rough.re).hypot(value.im - rough.im)
            + 4.0 * (value.scatter + rough.scatter)
            + value.residual;
        assert!(
            off <= allowed,
            "{re} {im}: {value:?}, off {off:e}, allowed {allowed:e}"
        );
        assert!(
            allowed < most,
            "{re} {im}: the simulation decides nothing, {allowed:e}"
        );
    }
}

#[test]
fn perturbations_of_slip_stick_grow() {
    let references = [
        [0.049650637482, 2.541566892289],
        [0.018831920003, 8.649209681975],
    ];
    compare(0.2, 0, 50, &references, 0.03);
}

#[test]
fn perturbations_grow_in_other_sectors() {
    let references = [
        [0.1279698868278, 1.319591652955],
        [0.053191653498, 6.57203730256],
    ];
    compare(0.2, 1, 40, &references, 0.03);
    compare(0.2, 2, 40, &[[0.107573000269, 0.8365151274592]], 0.03);
}

#[test]
fn perturbations_of_separated_waves_decay() {
    compare(
        0.045,
        0,
        80,
        &[[-0.0656004525, 9.948578715806], [-0.24180, 2.90776]],
        0.07,
    );
    compare(
        0.02,
        0,
        60,
        &[
            [-0.0718682012, 3.057910193071],
            [-0.0878128708, 2.465433134414],
        ],
        0.03,
    );
}

#[test]
fn there_is_no_sector_beyond_the_waves() {
    let profile = wave(0.2);
    let request = Request {
        points: 48,
        waves: 4,
        sector: 4,
        shift: 48,
        courant: 0.3,
        amplitude: 1e-4,
        pairs: 4,
        settling: 0.0,
    };
    let setup = setup(48, profile.wavelength(), Order::Second, 1.0);
    assert!(
        growth::eigenvalues(
            &parameters(0.2, 0.0),
            &setup,
            &profile,
            &request,
            &mut || ()
        )
        .is_err()
    );
}
