//! How fast the simulation is, beside what the machine could do.
//!
//!     cargo run --release --example simulation_speed
//!
//! Node-steps per second of the ring with 4096 points by order, account of work and threads; run time
//! of the annulus; and, measured in the same minute, the rate at which the same number of cores copies
//! the arrays of the ring within their caches, and the rate of additions and multiplications in
//! vector registers. Each figure is the best of several repeats: other work on the machine only slows.

use std::hint::black_box;
use std::time::Instant;

use brakewave::simulation::annulus::{self, Annulus};
use brakewave::simulation::ring::{self, Order, Ring, RingLaw};
use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Constants, Impact};
use rayon::prelude::*;

const GEOMETRY: Geometry = Geometry {
    nu: 0.3,
    xi: 1.5,
    gamma: 1.0,
};
const POINTS: usize = 4096;
const REPEATS: usize = 7;

/// Shortest time of several repeats, in seconds.
fn best(mut work: impl FnMut()) -> f64 {
    (0..REPEATS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

fn ring(order: Order, watched: bool) -> f64 {
    let parameters = Constants {
        coefficients: GEOMETRY.coefficients(),
        friction: 0.5,
        mismatch: 0.2,
        mass_damping: 0.0,
        stiffness_damping: 0.0,
        smoothing: 0.0,
    };
    let angle = std::f64::consts::TAU;
    let setup = ring::RingSetup {
        points: POINTS,
        angle,
        order,
        time_step: ring::courant_step(&parameters, POINTS, angle, 0.3),
        law: RingLaw::Coulomb,
        impact: Impact::Frictionless,
        watched,
    };
    let mut ring = Ring::new(&parameters, setup).expect("the ring can be set up");
    for point in 0..POINTS {
        let phase = 4.0 * angle * point as f64 / POINTS as f64;
        ring.place(
            point,
            [0.2, 0.2 + 0.1 * phase.cos(), 0.0, 0.5 * phase.sin()],
        );
    }
    let steps = 4800;
    let time = best(|| ring.advance(steps));
    POINTS as f64 * steps as f64 / time
}

/// Seconds per unit of time, and node-steps per second.
fn tube() -> (f64, f64) {
    let angle = std::f64::consts::TAU;
    let step = annulus::courant_step(&GEOMETRY, 132, 8, angle, 0.3, 0.0);
    let steps = (1.0 / step).ceil();
    let mut annulus = Annulus::new(annulus::TubeSetup {
        geometry: GEOMETRY,
        friction: 0.5,
        mismatch: 0.2,
        mass_damping: 0.0,
        stiffness_damping: 0.0,
        around: 132,
        across: 8,
        angle,
        time_step: 1.0 / steps,
    })
    .expect("the annulus can be set up");
    annulus.perturb(4, 0.05, [0.0, 5.0]);
    let time = best(|| annulus.advance(steps as u64));
    (time, 132.0 * 8.0 * steps / time)
}

/// Bytes per second, read and written, of a sum of two arrays into a third within the second-level
/// cache of each core.
fn cache(threads: usize) -> f64 {
    const COUNT: usize = 4096;
    const PASSES: usize = 20_000;
    let mut sets: Vec<[Vec<f64>; 3]> = (0..threads)
        .map(|_| [vec![1.0; COUNT], vec![2.0; COUNT], vec![0.0; COUNT]])
        .collect();
    let time = best(|| {
        sets.par_iter_mut().for_each(|[one, other, sum]| {
            pulp::Arch::new().dispatch(|| {
                for _ in 0..PASSES {
                    let (one, other) = (black_box(&*one), black_box(&*other));
                    for i in 0..COUNT {
                        sum[i] = one[i] + 3.0 * other[i];
                    }
                }
            });
        });
    });
    24.0 * (threads * COUNT * PASSES) as f64 / time
}

/// Additions and multiplications per second on numbers that stay in registers.
fn arithmetic(threads: usize) -> f64 {
    const LANES: usize = 64;
    const PASSES: usize = 4_000_000;
    let time = best(|| {
        (0..threads).into_par_iter().for_each(|seed| {
            pulp::Arch::new().dispatch(|| {
                let mut values = [1.0 + seed as f64 * 1e-9; LANES];
                let (factor, summand) = (black_box(0.999_999_9), black_box(1e-7));
                for _ in 0..PASSES {
                    for value in &mut values {
                        *value = *value * factor + summand;
                    }
                }
                black_box(values);
            });
        });
    });
    2.0 * (threads * LANES * PASSES) as f64 / time
}

fn main() {
    println!("| ring, {POINTS} points | threads | node-steps/s |\n|---|---|---|");
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        for (name, order) in [
            ("order 2", Order::Second),
            ("order 4", Order::Fourth),
            ("order 6", Order::Sixth),
        ] {
            for watched in [false, true] {
                let rate = pool.install(|| ring(order, watched));
                let account = if watched { ", account of work" } else { "" };
                println!("| {name}{account} | {threads} | {rate:.2e} |");
            }
        }
        let bytes = pool.install(|| cache(threads));
        let operations = pool.install(|| arithmetic(threads));
        println!("| limit: caches, {bytes:.2e} B/s | {threads} | |");
        println!("| limit: arithmetic, {operations:.2e} op/s | {threads} | |");
    }
    let (seconds, rate) = tube();
    println!("\nannulus, 132 × 8: one unit of time in {seconds:.2e} s, {rate:.2e} node-steps/s");
}
