//! The ring keeps the laws of contact and friction at every node and every step, balances its energy,
//! and does not depend on how it is cut up.

use std::f64::consts::TAU;

use brakewave::simulation::ring::kernel::Nodes;
use brakewave::simulation::ring::{Law, Order, Ring, Setup, courant_step};

use crate::{parameters, scramble};

/// A ring thrown into rough motion, with every regime in it.
fn rough(points: usize, order: Order, law: Law, mass_damping: f64, courant: f64) -> Ring {
    let parameters = parameters(0.05, mass_damping);
    let setup = Setup {
        points,
        angle: TAU,
        order,
        time_step: courant_step(&parameters, points, TAU, courant),
        law,
        watched: true,
    };
    let mut ring = Ring::new(&parameters, setup).expect("a ring");
    for point in 0..points {
        let phase = TAU * point as f64 / points as f64;
        let noise = |seed: usize| scramble(7 * point + seed);
        let gap = (0.02 * (2.0 * phase).sin() + 0.004 * noise(0)).max(0.0);
        let v = 0.1 + 0.12 * (4.0 * phase).cos() + 0.05 * (3.0 * phase).sin();
        let rate = 0.9 * (5.0 * phase).cos() + 0.6 * (2.0 * phase).sin() + 0.1 * noise(2);
        ring.place(point, [0.05 + gap, v, -0.1 * noise(1), rate]);
    }
    ring
}

/// Forces on a point, from the states before and after a step, with differences written out anew.
struct Forces {
    pressure: f64,
    radial: f64,
    shear: f64,
}

fn forces(ring: &Ring, before: &Nodes, after: &Nodes, i: usize) -> Forces {
    let (c, f) = (ring.parameters().coefficients, ring.parameters());
    let (count, h, dt) = (before.len(), ring.spacing(), ring.setup().time_step);
    let (l, r) = ((i + count - 1) % count, (i + 1) % count);
    let (u, v) = (&before.radial, &before.tangential);
    let slope = |y: &[f64]| (y[r] - y[l]) / (2.0 * h);
    let bend = |y: &[f64]| (y[r] - 2.0 * y[i] + y[l]) / (h * h);
    let alpha = f.mass_damping;
    let force =
        |old: f64, new: f64, elastic: f64| (new - old) / dt + alpha * 0.5 * (new + old) - elastic;
    Forces {
        pressure: c.g * f.mismatch - c.coupling * slope(v),
        radial: force(
            before.radial_rate[i],
            after.radial_rate[i],
            c.b * bend(u) + c.coupling * slope(v) - c.g * u[i],
        ),
        shear: force(
            before.tangential_rate[i],
            after.tangential_rate[i],
            c.a * bend(v) - c.coupling * slope(u) - c.h * v[i],
        ),
    }
}

#[test]
fn friction_and_contact_hold_at_every_node_and_step() {
    for mass_damping in [0.0, 0.3] {
        let mut ring = rough(96, Order::Second, Law::Coulomb, mass_damping, 0.4);
        let friction = ring.parameters().friction;
        let mismatch = ring.parameters().mismatch;
        let dt = ring.setup().time_step;
        // what enters a force has the size of V/Δφ² and V̇/Δt at most: a few units of rounding of that
        let noise = 64.0 * f64::EPSILON * (1.0 / dt + 1.0 / ring.spacing().powi(2));
        let mut seen = [0_usize; 6];
        for _ in 0..4000 {
            let before = ring.nodes().clone();
            ring.advance(1);
            let after = ring.nodes();
            for i in 0..before.len() {
                let Forces {
                    pressure,
                    radial,
                    shear,
                } = forces(&ring, &before, after, i);
                // no penetration, and contact is at δ exactly
                assert!(after.radial[i] >= mismatch);
                let share = before.share[i];
                let held = share != 0.0 && pressure >= 0.0;
                if held {
                    assert_eq!(after.radial[i], mismatch);
                    assert_eq!(after.radial_rate[i], 0.0);
                }
                let landed = !held && after.share[i] != 0.0;
                if landed {
                    // an impact pushes, and ends at δ
                    assert_eq!(after.radial[i], mismatch);
                    assert!(radial >= -noise, "{radial:e}");
                    assert!((0.5..=1.5).contains(&after.share[i]));
                }
                if !held && !landed && share == 0.0 {
                    assert!(radial.abs() <= noise, "free: {radial:e}");
                }
                // |Q| ≤ fP over the share of the step in contact, Q = 0 in the air
                let most = if held {
                    friction * pressure * share
                } else {
                    0.0
                };
                assert!(shear.abs() <= most + noise, "{shear:e} {most:e}");
                // Q (1 − V̇) = fP |1 − V̇| where V̇ − 1 keeps its sign
                let (old, new) = (
                    before.tangential_rate[i] - 1.0,
                    after.tangential_rate[i] - 1.0,
                );
                let kind = match (old, new) {
                    _ if !held => 0,
                    (_, 0.0) => 1,
                    (old, new) if old <= 0.0 && new < 0.0 => {
                        assert!((shear - most).abs() <= noise, "slip {shear:e} {most:e}");
                        2
                    }
                    (old, new) if old >= 0.0 && new > 0.0 => {
                        assert!((shear + most).abs() <= noise, "reverse {shear:e} {most:e}");
                        3
                    }
                    _ => 4,
                };
                seen[kind] += 1;
                seen[5] += usize::from(landed);
            }
        }
        // air, stick, slip, reverse slip, crossings and landings all occurred
        assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
    }
}

/// Imbalance of energy relative to the largest energy after a rough motion of this time.
fn imbalance(order: Order, law: Law, mass_damping: f64, courant: f64) -> f64 {
    let mut ring = rough(96, order, law, mass_damping, courant);
    let start = ring.energy();
    let mut scale = start.abs();
    let steps = (0.2 * 3000.0 / courant) as u64;
    for _ in 0..30 {
        ring.advance(steps / 30);
        scale = scale.max(ring.energy().abs());
    }
    let [friction, contact, damping] = ring.work();
    // landings only take energy, and so does damping
    assert!(contact < 0.0 && damping <= 0.0 && friction != 0.0);
    (ring.energy() - start - (friction + contact + damping)).abs() / scale
}

/// With smooth friction E − work stays what it was to rounding: each of the S steps adds that of a sum.
/// Landings start friction within a step, and with the set-valued law there are kinks; each leaves
/// an error of third order in the step at a number of times that does not depend on it.
#[test]
fn energy_is_balanced() {
    for order in [Order::Second, Order::Fourth, Order::Sixth] {
        for law in [Law::Coulomb, Law::Smoothed { epsilon: 0.01 }] {
            for mass_damping in [0.0, 0.2] {
                let parts = [0.4, 0.2, 0.1].map(|c| imbalance(order, law, mass_damping, c));
                assert!(parts.iter().all(|part| *part < 2e-3), "{law:?} {parts:?}");
                // two halvings of the step at order 2 would be a factor of 16
                let falls = law != Law::Coulomb || parts[2] < parts[0] / 16.0;
                assert!(falls, "{parts:?}");
            }
        }
    }
}

/// One ring of three stretches, on one thread and on two, in blocks and step by step: the same bits.
#[test]
fn cutting_and_threads_change_nothing() {
    crate::cutting_and_threads_change_nothing(|| {
        rough(2500, Order::Fourth, Law::Coulomb, 0.0, 0.4)
    });
}

/// As ε falls, tanh approaches the set-valued law: the difference after a time in which everything
/// slips or sticks falls about in proportion.
#[test]
fn smoothed_friction_tends_to_coulomb() {
    let run = |law| {
        let parameters = parameters(0.3, 0.2);
        let setup = Setup {
            points: 64,
            angle: TAU / 4.0,
            order: Order::Fourth,
            time_step: courant_step(&parameters, 64, TAU / 4.0, 0.2),
            law,
            watched: false,
        };
        let mut ring = Ring::new(&parameters, setup).expect("a ring");
        for point in 0..64 {
            let phase = TAU * point as f64 / 64.0;
            ring.place(
                point,
                [0.3, 0.3 + 0.25 * phase.cos(), 0.0, -1.3 * phase.sin()],
            );
        }
        ring.advance(200);
        ring.nodes().tangential.clone()
    };
    let exact = run(Law::Coulomb);
    let distance = |epsilon: f64| {
        run(Law::Smoothed { epsilon })
            .iter()
            .zip(&exact)
            .map(|(one, other)| (one - other).abs())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (distance(0.04), distance(0.01));
    assert!(fine < 0.5 * coarse && fine < 0.01, "{coarse:e} {fine:e}");
}

#[test]
fn what_cannot_be_is_refused() {
    let parameters = parameters(0.2, 0.0);
    let setup = Setup {
        points: 64,
        angle: TAU,
        order: Order::Second,
        time_step: 0.01,
        law: Law::Coulomb,
        watched: false,
    };
    for wrong in [
        Setup { points: 3, ..setup },
        Setup {
            time_step: 0.0,
            ..setup
        },
        Setup {
            time_step: f64::NAN,
            ..setup
        },
        Setup {
            time_step: 10.0,
            ..setup
        },
    ] {
        assert!(Ring::new(&parameters, wrong).is_err());
    }
    let mut ring = Ring::new(&parameters, setup).expect("a ring");
    assert!(ring.resume(Nodes::new(63, false, false), 0).is_err());
}
