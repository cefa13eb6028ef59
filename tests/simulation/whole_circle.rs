//! What becomes of a wave of mode 4 on the whole circle: an unstable one turns irregular, a stable one
//! forgets its perturbation.

use std::f64::consts::TAU;

use brakewave::simulation::growth::place;
use brakewave::simulation::motion::SimulatedMotion;
use brakewave::simulation::profile::Profile;
use brakewave::simulation::ring::{Order, Ring, courant_step};

use crate::simulation::{damped_wave, parameters, setup, wave};

/// Unlikeness of the four waves at the beginning and after a time, perturbed by a harmonic of mode 1.
fn unlikeness(profile: &Profile, mass_damping: f64, time: f64) -> [f64; 2] {
    let parameters = parameters(0.2, mass_damping);
    let points = 256;
    let time_step = courant_step(&parameters, points, TAU, 0.4);
    let setup = setup(points, TAU, Order::Fourth, time_step);
    let mut ring = Ring::new(&parameters, setup).expect("a ring");
    place(&mut ring, profile);
    for point in 0..points {
        let nodes = ring.nodes();
        let values = [
            nodes.radial[point],
            nodes.tangential[point] + 1e-3 * (TAU * point as f64 / points as f64).cos(),
            nodes.radial_rate[point],
            nodes.tangential_rate[point],
        ];
        ring.place(point, values);
    }
    let mut motion = SimulatedMotion::Ring(Box::new(ring));
    let unlike =
        |motion: &SimulatedMotion| motion.line().asymmetry(4).expect("256 points, 4 waves");
    let start = unlike(&motion);
    motion.advance((time / setup.time_step).round() as u64);
    [start, unlike(&motion)]
}

#[test]
fn the_unstable_wave_turns_irregular() {
    // 2·0.128 is the rate of the square in the sector that grows fastest: e^{0.256·60} is 5e6
    let [start, end] = unlikeness(&wave(0.2), 0.0, 60.0);
    assert!(start < 1e-4 && end > 0.05, "{start:e} {end:e}");
}

#[test]
fn the_stable_wave_stays() {
    let [start, end] = unlikeness(&damped_wave(0.316), 0.316, 60.0);
    assert!(end < 1e-2 * start, "{start:e} {end:e}");
}
