//! The ring keeps the laws of contact and friction at every node and every step, balances its energy,
//! and does not depend on how it is cut up.

use std::f64::consts::TAU;

use brakewave::simulation::ring::kernel::Nodes;
use brakewave::simulation::ring::{Order, Ring, RingLaw, RingSetup, courant_step};
use brakewave::tube::model::{Constants, Impact};

use crate::simulation::{parameters, scramble, setup};

/// A ring with α, β thrown into rough motion, with every regime in it.
pub fn rough(
    points: usize,
    order: Order,
    law: RingLaw,
    [mass_damping, stiffness_damping]: [f64; 2],
    impact: Impact,
    courant: f64,
) -> Ring {
    let parameters = Constants {
        stiffness_damping,
        ..parameters(0.05, mass_damping)
    };
    let time_step = courant_step(&parameters, points, TAU, courant);
    let setup = RingSetup {
        law,
        impact,
        watched: true,
        ..setup(points, TAU, order, time_step)
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
    let (c, f) = (ring.constants().coefficients, ring.constants());
    let (count, h, dt) = (before.count(), ring.spacing(), ring.setup().time_step);
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
        let mut ring = rough(
            96,
            Order::Second,
            RingLaw::Coulomb,
            [mass_damping, 0.0],
            Impact::Frictionless,
            0.4,
        );
        let friction = ring.constants().friction;
        let mismatch = ring.constants().mismatch;
        let dt = ring.setup().time_step;
        // what enters a force has the size of V/Δφ² and V̇/Δt at most: a few units of rounding of that
        let noise = 64.0 * f64::EPSILON * (1.0 / dt + 1.0 / ring.spacing().powi(2));
        let mut seen = [0_usize; 6];
        for _ in 0..4000 {
            let before = ring.nodes().clone();
            ring.advance(1);
            let after = ring.nodes();
            for i in 0..before.count() {
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

/// Elastic forces b∂²U + D∂V − gU and a∂²V − D∂U − hV on a point, with the differences written out
/// anew, and the sums of the absolute values in them.
fn elastic(ring: &Ring, u: &[f64], v: &[f64], i: usize) -> [[f64; 2]; 2] {
    let (second, first): (&[f64], &[f64]) = match ring.setup().order {
        Order::Second => (&[-2.0, 1.0], &[0.5]),
        Order::Fourth => (&[-2.5, 4.0 / 3.0, -1.0 / 12.0], &[2.0 / 3.0, -1.0 / 12.0]),
        Order::Sixth => (
            &[-49.0 / 18.0, 1.5, -0.15, 1.0 / 90.0],
            &[0.75, -0.15, 1.0 / 60.0],
        ),
    };
    let (c, h, count) = (ring.constants().coefficients, ring.spacing(), u.len());
    let mut sums = [[0.0; 2]; 2];
    let mut add = |field: usize, part: f64| {
        sums[0][field] += part;
        sums[1][field] += part.abs();
    };
    add(0, (c.b * second[0] / (h * h) - c.g) * u[i]);
    add(1, (c.a * second[0] / (h * h) - c.h) * v[i]);
    for k in 1..second.len() {
        for (other, sign) in [((i + count - k) % count, -1.0), ((i + k) % count, 1.0)] {
            let slope = sign * c.coupling * first[k - 1] / h;
            add(0, c.b * second[k] / (h * h) * u[other] + slope * v[other]);
            add(1, c.a * second[k] / (h * h) * v[other] - slope * u[other]);
        }
    }
    sums
}

/// What a rough motion leaves of its balance of energy.
struct Balance {
    /// E − E₀ − work.
    imbalance: f64,
    /// ½Δt²⟨ζ, K(ẏ + ζ)⟩, summed over the steps, where Δtζ is added to V at kinks.
    kinks: f64,
    /// What rounding can add up to.
    rounding: f64,
    /// Largest energy.
    scale: f64,
}

fn balance(order: Order, law: RingLaw, damping: [f64; 2], impact: Impact, courant: f64) -> Balance {
    let mut ring = rough(96, order, law, damping, impact, courant);
    let (dt, width) = (ring.setup().time_step, ring.spacing());
    let start = ring.energy();
    let (mut kinks, mut rounding, mut scale) = (0.0, 0.0, start.abs());
    let mut before = ring.nodes().clone();
    for _ in 0..(160.0 / courant) as usize {
        ring.advance(1);
        let after = ring.nodes();
        let (u, v) = (&after.radial_rate, &after.tangential_rate);
        let bent: Vec<f64> = (0..v.len())
            .map(|i| (after.tangential[i] - before.tangential[i]) / dt - v[i])
            .collect();
        let moved: Vec<f64> = v
            .iter()
            .zip(&bent)
            .map(|(one, other)| one + other)
            .collect();
        for (i, zeta) in bent.iter().enumerate() {
            let [force, _] = elastic(&ring, u, &moved, i);
            kinks -= 0.5 * dt * dt * width * zeta * force[1];
            // forces, displacements and ledgers are rounded, each relative to what is summed in it
            let [_, sizes] = elastic(&ring, &before.radial, &before.tangential, i);
            let [_, rates] = elastic(&ring, u, v, i);
            let rate = |nodes: &Nodes| [nodes.radial_rate[i].abs(), nodes.tangential_rate[i].abs()];
            for field in 0..2 {
                let place = [after.radial[i], after.tangential[i]][field].abs();
                rounding += dt * (rate(&before)[field] + rate(after)[field]) * sizes[field];
                rounding += dt * place * rates[field] + rate(after)[field].powi(2);
            }
            rounding += after.friction_work[i].abs();
            rounding += after.contact_work[i].abs() + after.damping_work[i].abs();
        }
        scale = scale.max(ring.energy().abs());
        before = after.clone();
    }
    let [friction, contact, damping] = ring.work();
    // landings only take energy, and so does damping
    assert!(contact < 0.0 && damping <= 0.0 && friction != 0.0);
    Balance {
        imbalance: ring.energy() - start - (friction + contact + damping),
        kinks,
        rounding: ROUNDINGS * f64::EPSILON * width * rounding,
        scale,
    }
}

/// Roundings behind a term of the balance: a dozen sums and products on the way to a force, each
/// off by half a unit.
const ROUNDINGS: f64 = 6.0;

/// A step that moves V by Δt(V̇ + ζ) leaves ½Δt²⟨ζ, K(ẏ + ζ)⟩ of the energy beside all work, and nothing
/// else: whatever the law, to rounding. With smooth friction ζ ≠ 0 after landings only; with the set-valued law
/// at every crossing of V̇ = 1, as many times for any step, where ζ is of the first order: the sum falls
/// faster than with the square of the step.
#[test]
fn energy_is_balanced() {
    for order in [Order::Second, Order::Fourth, Order::Sixth] {
        for law in [RingLaw::Coulomb, RingLaw::Smoothed { epsilon: 0.01 }] {
            for (damping, impact) in [
                ([0.0, 0.0], Impact::Frictionless),
                ([0.2, 0.0], Impact::Frictionless),
                ([0.2, 0.0], Impact::Coulomb),
                ([0.2, 0.002], Impact::Coulomb),
            ] {
                let parts = [0.4, 0.1].map(|courant| {
                    let found = balance(order, law, damping, impact, courant);
                    let Balance {
                        imbalance,
                        kinks,
                        rounding,
                        scale,
                    } = found;
                    assert!(
                        (imbalance - kinks).abs() <= rounding,
                        "{law:?} {imbalance:e}"
                    );
                    // that is no excuse for what is not rounding
                    assert!(rounding < 1e-10 * scale, "{rounding:e}");
                    kinks.abs() / scale
                });
                // two halvings of the step at order 2 would be a factor of 16; concentrated reactions start and
                // end at instants of their own, which leave the first order
                let concentrated = impact == Impact::Coulomb;
                let factor = if concentrated { 4.0 } else { 16.0 };
                assert!(parts[1] < parts[0] / factor, "{law:?} {parts:?}");
            }
        }
    }
}

/// Where everything stays in contact smooth friction has no kinks: the energy is balanced to rounding.
#[test]
fn smooth_friction_in_contact_has_no_kinks() {
    let parameters = parameters(0.4, 0.0);
    let mut ring = Ring::new(
        &parameters,
        RingSetup {
            law: RingLaw::Smoothed { epsilon: 0.01 },
            watched: true,
            ..setup(
                96,
                TAU,
                Order::Fourth,
                courant_step(&parameters, 96, TAU, 0.4),
            )
        },
    )
    .expect("a ring");
    for point in 0..96 {
        let phase = TAU * point as f64 / 96.0;
        ring.push(point, 0.02 * (4.0 * phase).cos(), 0.9 * (2.0 * phase).sin());
    }
    let start = ring.energy();
    let steps = 2000;
    ring.advance(steps);
    assert!(ring.nodes().share.iter().all(|share| *share == 1.0));
    let [friction, contact, _] = ring.work();
    assert!(friction != 0.0 && contact == 0.0);
    // the energy is a difference of terms of the size of V²/Δφ², each rounded in every step
    let largest = ring
        .nodes()
        .tangential
        .iter()
        .fold(1.0_f64, |most, v| most.max(v.abs()));
    let size = TAU * (largest / ring.spacing()).powi(2) * parameters.coefficients.a;
    let imbalance = ring.energy() - start - friction;
    assert!(
        imbalance.abs() <= steps as f64 * f64::EPSILON * size,
        "{imbalance:e}"
    );
}

/// One ring of three stretches, on one thread and on two, in blocks and step by step: the same bits.
#[test]
fn cutting_and_threads_change_nothing() {
    crate::simulation::cutting_and_threads_change_nothing(|| {
        rough(
            2500,
            Order::Fourth,
            RingLaw::Coulomb,
            [0.0; 2],
            Impact::Frictionless,
            0.4,
        )
    });
    crate::simulation::cutting_and_threads_change_nothing(|| {
        rough(
            2500,
            Order::Fourth,
            RingLaw::Coulomb,
            [0.0, 0.001],
            Impact::Coulomb,
            0.4,
        )
    });
}

/// As ε falls, tanh approaches the set-valued law: the difference after a time in which everything
/// slips or sticks falls about in proportion.
#[test]
fn smoothed_friction_tends_to_coulomb() {
    let run = |law| {
        let parameters = parameters(0.3, 0.2);
        let time_step = courant_step(&parameters, 64, TAU / 4.0, 0.2);
        let setup = RingSetup {
            law,
            ..setup(64, TAU / 4.0, Order::Fourth, time_step)
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
    let exact = run(RingLaw::Coulomb);
    let distance = |epsilon: f64| {
        run(RingLaw::Smoothed { epsilon })
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
    let setup = setup(64, TAU, Order::Second, 0.01);
    for wrong in [
        RingSetup { points: 3, ..setup },
        RingSetup {
            time_step: 0.0,
            ..setup
        },
        RingSetup {
            time_step: f64::NAN,
            ..setup
        },
        RingSetup {
            time_step: 10.0,
            ..setup
        },
    ] {
        assert!(Ring::new(&parameters, wrong).is_err());
    }
    let mut ring = Ring::new(&parameters, setup).expect("a ring");
    assert!(ring.resume(Nodes::new(63, false, false), 0).is_err());
}
