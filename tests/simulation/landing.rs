//! Landings whose reaction carries friction: Coulomb impacts for β = 0, and material damping β > 0, which has
//! no impact. Speeds and shapes of waves, their perturbations, and the impulses of single points. The
//! waves with β > 0 that are compared with were computed by collocation in an independent program.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::OnceLock;

use brakewave::simulation::growth::{self, Request, SETTLING, SimulatedEigenvalue, place};
use brakewave::simulation::profile::Profile;
use brakewave::simulation::ring::{Order, Ring, RingSetup, courant_step};
use brakewave::tube::model::{Constants, Impact};
use tempfile::TempDir;

use crate::simulation::laws::rough;
use crate::simulation::{compare_grids, parameters, results, setup, wave_at};

/// Mode-4 waves with the Coulomb impact, β = 0.
fn coulomb(mismatch: f64) -> Profile {
    static CELL: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let folder = results(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.2,
                  impact: Coulomb),
          wave: (mode: 4, start: Fast),
          continuation: (parameter: Mismatch, range: (0.009, 0.2), toward: Down,
                         stop_at: [0.045, 0.02, 0.01]),
          output: (profiles: 1))",
        &CELL,
    );
    wave_at(folder, "mismatch", mismatch).0
}

fn damped(mismatch: f64, stiffness_damping: f64) -> Constants {
    Constants {
        stiffness_damping,
        ..parameters(mismatch, 0.0)
    }
}

/// A ring with the wave on it, and the steps of the time in which the wave moves by its length.
fn begin(profile: &Profile, parameters: &Constants, points: usize, impact: Impact) -> (Ring, u64) {
    let angle = profile.wavelength();
    let period = angle / profile.speed().abs();
    let steps = (period / courant_step(parameters, points, angle, 0.3)).ceil();
    let setup = RingSetup {
        impact,
        ..setup(points, angle, Order::Fourth, period / steps)
    };
    let mut ring = Ring::new(parameters, setup).expect("a ring");
    place(&mut ring, profile);
    (ring, steps as u64)
}

fn phase(ring: &Ring) -> f64 {
    let v = &ring.nodes().tangential;
    let sum = v
        .iter()
        .enumerate()
        .fold([0.0; 2], |sum: [f64; 2], (point, v)| {
            let (sine, cosine) = (TAU * point as f64 / ring.setup().points as f64).sin_cos();
            [sum[0] + v * cosine, sum[1] - v * sine]
        });
    sum[1].atan2(sum[0])
}

/// Part of a turn between two phases.
fn turn(from: f64, to: f64) -> f64 {
    ((to - from) / TAU + 0.5).rem_euclid(1.0) - 0.5
}

/// Errors of the speed over the second wavelength, and of V after it, up to a shift.
fn errors(profile: &Profile, points: usize, impact: Impact) -> [f64; 2] {
    let mismatch = profile.at(0.0, 0.0).values[0];
    let (mut ring, steps) = begin(profile, &damped(mismatch, 0.0), points, impact);
    let start = phase(&ring);
    ring.advance(steps);
    let once = phase(&ring);
    ring.advance(steps);
    let moved = turn(start, phase(&ring)) * profile.wavelength();
    let worst = (0..points).map(|point| {
        let place = point as f64 * ring.spacing() + moved;
        (ring.nodes().tangential[point] - profile.at(place, 0.0).values[1]).abs()
    });
    let worst = worst.fold(0.0, f64::max);
    [profile.speed() * turn(once, phase(&ring)), worst]
}

/// Landing into slip (δ = 0.045), into reverse slip with V̇ arrested at 1 on the way (0.02), into stick
/// (0.01): errors of speed and shape fall with the spacing, while friction without part in the impulse leads
/// elsewhere.
#[test]
fn waves_with_coulomb_impacts_travel_at_their_speed() {
    for mismatch in [0.045, 0.02, 0.01] {
        let profile = coulomb(mismatch);
        let found = [96, 192, 384, 768].map(|points| errors(&profile, points, Impact::Coulomb));
        println!("observed: {mismatch} {found:?}");
        for quantity in 0..2 {
            // a factor of 8 at order 1; how the fronts stand between the points may cost half of it
            let ratio = (found[0][quantity] / found[3][quantity]).abs();
            assert!(ratio > 4.0, "{mismatch} {found:?}");
        }
        let [speed, shape] = found[3];
        let [other_speed, other_shape] = errors(&profile, 768, Impact::Frictionless);
        println!("observed: frictionless {other_speed:e} {other_shape:e}");
        assert!(
            10.0 * speed.abs() < other_speed.abs(),
            "{speed:e} {other_speed:e}"
        );
        assert!(10.0 * shape < other_shape, "{shape:e} {other_shape:e}");
    }
}

/// With β > 0 the landing carries friction without an impact. From the wave with β = 0 the ring comes to
/// that with β, whatever `impact` says; where the layers of thickness βb/(m_b c²), 0.0015 and 0.0003, are far
/// below the spacing of 0.008, too.
#[test]
fn separated_waves_with_material_damping_travel_at_their_speed() {
    for (beta, exact) in [(0.005, -1.262_878_26), (0.001, -1.259_299_59)] {
        let profile = coulomb(0.01);
        let errors = [48, 96, 192].map(|points| {
            let impact = if points == 96 {
                Impact::Coulomb
            } else {
                Impact::Frictionless
            };
            let (mut ring, steps) = begin(&profile, &damped(0.01, beta), points, impact);
            ring.advance(25 * steps);
            let before = phase(&ring);
            ring.advance(steps);
            profile.speed() * (1.0 + turn(before, phase(&ring))) - exact
        });
        println!("observed: {beta} {errors:?}");
        let order = (errors[0] / errors[2]).abs().log2() / 2.0;
        assert!(order > 0.75, "{beta} {errors:?}");
        // the wave with β = 0 is 4.2e-3 or 6.6e-4 off
        assert!(
            errors[2].abs() < 0.05 * (exact - profile.speed()).abs(),
            "{errors:?}"
        );
    }
}

fn eigenvalues(
    (profile, parameters): (&Profile, &Constants),
    (sector, pairs, amplitude): (usize, usize, f64),
    points: usize,
) -> Vec<SimulatedEigenvalue> {
    let request = Request {
        points,
        waves: if sector == 0 { 1 } else { 4 },
        sector,
        shift: points,
        courant: 0.2,
        amplitude,
        pairs,
        settling: SETTLING,
    };
    let setup = RingSetup {
        impact: Impact::Coulomb,
        ..setup(points, profile.wavelength(), Order::Fourth, 1.0)
    };
    growth::averaged(parameters, &setup, profile, &request, 2, &mut || ()).expect("eigenvalues")
}

/// Rings of 96 and 192 points against the eigenfunction problem.
#[track_caller]
fn compare(wave: (&Profile, &Constants), how: (usize, usize, f64), exact: &[[f64; 2]], most: f64) {
    let sets = [96, 192].map(|points| eigenvalues(wave, how, points));
    compare_grids(&sets, exact, most);
}

/// Landing into stick and into slip, β = 0.
#[test]
fn perturbations_of_waves_with_coulomb_impacts_grow_and_decay() {
    let (profile, parameters) = (coulomb(0.01), damped(0.01, 0.0));
    let wave = (&profile, &parameters);
    compare(
        wave,
        (0, 40, 1e-6),
        &[[0.00506, 2.55473], [-0.03554, 9.27756]],
        0.05,
    );
    // four wavelengths: rings of half the points for each
    let sets = [48, 96].map(|points| eigenvalues(wave, (1, 40, 1e-6), points));
    compare_grids(&sets, &[[-0.08905, 1.95708]], 0.05);
    let (profile, parameters) = (coulomb(0.045), damped(0.045, 0.0));
    let exact = [[-0.07423, 10.02086], [-0.18044, 2.89491]];
    compare((&profile, &parameters), (0, 80, 3e-4), &exact, 0.1);
}

/// The friction that a point has had since it landed never exceeds f times the reaction since then, the
/// impact included, with both from the states before and after each step and differences written out
/// anew; and there is no penetration, no tension on the whole, and no friction in the air.
#[test]
fn friction_never_exceeds_its_share_of_the_reaction() {
    for beta in [0.0, 0.002] {
        let mut ring = rough(
            96,
            Order::Second,
            Default::default(),
            [0.0, beta],
            Impact::Coulomb,
            0.4,
        );
        let (c, f) = (ring.constants().coefficients, ring.constants().friction);
        let (mismatch, h, dt) = (
            ring.constants().mismatch,
            ring.spacing(),
            ring.setup().time_step,
        );
        let noise = 64.0 * f64::EPSILON * (1.0 + dt / (h * h));
        let (mut normal, mut tangential) = (vec![0.0; 96], vec![0.0; 96]);
        let mut begun = vec![f64::NAN; 96];
        let mut slack = vec![0.0; 96];
        let mut seen = [0_usize; 3];
        for _ in 0..4000 {
            let before = ring.nodes().clone();
            ring.advance(1);
            let after = ring.nodes();
            for i in 0..96 {
                let (l, r) = ((i + 95) % 96, (i + 1) % 96);
                let (u, v) = (&before.effective_radial, &before.effective);
                let slope = |y: &[f64]| c.coupling * (y[r] - y[l]) / (2.0 * h);
                let bend = |y: &[f64]| (y[r] - 2.0 * y[i] + y[l]) / (h * h);
                let shear = after.tangential_rate[i]
                    - before.tangential_rate[i]
                    - dt * (c.a * bend(v) - slope(u) - c.h * v[i]);
                let reaction = after.radial_rate[i]
                    - before.radial_rate[i]
                    - dt * (c.b * bend(u) + slope(v) - c.g * u[i]);
                let regular = dt * (c.g * mismatch - slope(v));
                assert!(after.radial[i] >= mismatch);
                if before.share[i] == 0.0 {
                    assert!(shear.abs() <= noise, "in the air: {shear:e}");
                    (normal[i], tangential[i], slack[i]) = (0.0, 0.0, 0.0);
                    begun[i] = if after.share[i] == 0.0 {
                        f64::NAN
                    } else {
                        regular
                    };
                    seen[0] += 1;
                }
                if begun[i].is_nan() {
                    continue;
                }
                if before.share[i] != 0.0 && before.age[i] == 0.0 {
                    // at most half a step of P, before landing or after it, is counted with the other
                    slack[i] = 0.5 * f * (regular - begun[i]).abs() + 0.5 * f * begun[i].max(0.0);
                    seen[1] += 1;
                }
                normal[i] += reaction;
                tangential[i] += shear;
                if before.share[i] != 0.0 && after.age[i] > 0.0 {
                    assert!(normal[i] >= -noise, "{:e}", normal[i]);
                    let most = f * normal[i] + slack[i] + noise;
                    assert!(tangential[i].abs() <= most, "{:e} {most:e}", tangential[i]);
                    seen[2] += usize::from(tangential[i].abs() > 0.9 * f * normal[i]);
                }
            }
        }
        // air, landings and full friction all occurred
        assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
    }
}
