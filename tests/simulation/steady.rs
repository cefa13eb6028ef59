//! Steady sliding of the ring: it stays, and a small harmonic grows as λ² + αλ + (ak² + h) + ikfD = 0
//! says.

use std::f64::consts::TAU;

use brakewave::simulation::motion::steady_growth;
use brakewave::simulation::ring::{Order, Ring, RingSetup, courant_step};

use crate::simulation::{parameters, setup};

#[test]
fn steady_sliding_stays() {
    let parameters = parameters(0.2, 0.0);
    let time_step = courant_step(&parameters, 132, TAU, 0.4);
    let setup = RingSetup {
        watched: true,
        ..setup(132, TAU, Order::Fourth, time_step)
    };
    let mut ring = Ring::new(&parameters, setup).expect("a ring");
    let start = ring.nodes().clone();
    ring.advance(2000);
    // rounding of V, amplified by the waves that grow at 0.19 at most
    let time = ring.time();
    let allowed = 1e-13 * (0.19 * time).exp();
    for (now, then) in ring.nodes().tangential.iter().zip(&start.tangential) {
        assert!((now - then).abs() < allowed);
    }
    assert!(ring.nodes().share.iter().all(|share| *share == 1.0));
}

/// The mode's complex amplitude z(t) = Ae^{λt} once the decaying wave has gone; sixth-order differences
/// leave the error of leapfrog, relative ω²Δt²/24, and kΔφ to the sixth power.
#[test]
fn small_waves_grow_at_the_rate_of_the_closed_form() {
    for (mode, mass_damping) in [(4, 0.0), (4, 0.1), (3, 0.0)] {
        let parameters = parameters(0.2, mass_damping);
        let points = 240;
        let time_step = courant_step(&parameters, points, TAU, 0.4);
        let setup = setup(points, TAU, Order::Sixth, time_step);
        let [growth, frequency] = steady_growth(&parameters, mode);
        // the square satisfies the equation
        let k = f64::from(mode);
        let c = parameters.coefficients;
        let real =
            growth * growth - frequency * frequency + mass_damping * growth + c.a * k * k + c.h;
        let imaginary = 2.0 * growth * frequency
            + mass_damping * frequency
            + k * parameters.friction * c.coupling;
        assert!(real.abs() < 1e-12 * c.a * k * k && imaginary.abs() < 1e-12 * c.a * k * k);
        assert!(growth > 0.0);
        let mut ring = Ring::new(&parameters, setup).expect("a ring");
        let rest = ring.nodes().tangential[0];
        for point in 0..points {
            let (sine, cosine) = (k * TAU * point as f64 / points as f64).sin_cos();
            let size = 1e-7;
            let rate = size * (growth * cosine - frequency * sine);
            ring.place(point, [0.2, rest + size * cosine, 0.0, rate]);
        }
        let amplitude = |ring: &Ring| {
            let mut sum = [0.0; 2];
            for (point, v) in ring.nodes().tangential.iter().enumerate() {
                let (sine, cosine) = (k * TAU * point as f64 / points as f64).sin_cos();
                sum[0] += (v - rest) * cosine;
                sum[1] -= (v - rest) * sine;
            }
            sum
        };
        // the wave the other way has |e^{−2·growth·t}| of it left, and that of the start is of order Δt
        let settle = (12.0 / setup.time_step) as u64;
        ring.advance(settle);
        let first = amplitude(&ring);
        // whole turns of the phase in between are known from the closed form
        let steps = (TAU / frequency.abs() / setup.time_step).round() as u64;
        ring.advance(steps);
        let second = amplitude(&ring);
        let time = steps as f64 * setup.time_step;
        let found = (second[0].hypot(second[1]) / first[0].hypot(first[1])).ln() / time;
        let turned = second[1].atan2(second[0]) - first[1].atan2(first[0]);
        let turns = (frequency * time - turned) / TAU;
        let rate = (turned + TAU * turns.round()) / time;
        let step_error = (frequency * setup.time_step).powi(2) / 24.0;
        let left = setup.time_step * (-2.0 * growth * 12.0).exp();
        let allowed = 2.0 * frequency.abs() * (step_error + left) + 1e-6;
        assert!(
            (found - growth).abs() < allowed,
            "{found} {growth} {allowed:e}"
        );
        assert!(
            (rate - frequency).abs() < allowed,
            "{rate} {frequency} {allowed:e}"
        );
    }
}
