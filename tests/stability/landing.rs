//! Waves that separate with material damping β: the limit β → 0, which is the wave with Coulomb impacts,
//! spectral collocation, eigenfunctions, and the damping of high frequencies.

use brakewave::branch::{Stability, polish};
use brakewave::linalg::Vector;
use brakewave::problem;
use brakewave::tube::model::signature::Regime;
use brakewave::tube::model::{Impact, Parameter};
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::wave::{Wave, WaveScales};
use nalgebra::{DMatrix, DVector};

use crate::stability::material::{eigenfunction_defects, leading};
use crate::stability::observed;
use crate::stability::waves::{C64, follow, window};

/// The wave of mode 4 with Coulomb impacts at a mismatch, posed in β at β = 0.
fn undamped(mismatch: f64) -> (Wave, Vector) {
    undamped_of(
        "Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5",
        4,
        mismatch,
    )
}

/// The same of any tube.
fn undamped_of(tube: &str, mode: u32, mismatch: f64) -> (Wave, Vector) {
    let text = format!(
        "(model: (coefficients: {tube}, mismatch: 0.2), \
         wave: (mode: {mode}, start: Fast), continuation: (parameter: Mismatch, \
         range: ({mismatch:?}, 0.2), toward: Down))"
    );
    let mut problem = problem::parse(&text, "landing").expect("a problem");
    problem.model.impact = Impact::Coulomb;
    let items = follow(&problem, &text).items;
    let (found, point) = items.last().expect("points").wave();
    let wave = Wave::new(
        found.model_at(point),
        Parameter::StiffnessDamping,
        found.mode,
        found.signature.clone(),
        WaveScales {
            parameter: 0.01,
            ..found.scales
        },
    );
    let guess = wave.pack(&found.unpack(point), found.excess_at(point), 0.0);
    let point = polish(&wave, &guess).expect("the limit");
    (wave, point)
}

/// The wave of the same signature at another β, admissible or not, in steps of β.
fn damped((wave, point): &(Wave, Vector), beta: f64) -> (Wave, Vector) {
    let mut point = point.clone();
    let steps = (beta / 5e-4).ceil().max(1.0);
    for step in 1..=steps as usize {
        let value = beta * step as f64 / steps;
        let guess = wave.pack(&wave.unpack(&point), wave.excess_at(&point), value);
        point = polish(wave, &guess).expect("the wave at this damping");
    }
    (wave.clone(), point)
}

fn linearised((wave, point): &(Wave, Vector)) -> Characteristic {
    Characteristic::new(wave, point).expect("Coulomb's law")
}

/// Waves that land into stick and into slip, from β = 5e-3 to 1e-10.
fn specimens() -> Vec<(f64, Wave, Vector)> {
    let mut waves = Vec::new();
    for (mismatch, largest) in [(0.01, 5e-3), (0.045, 2e-3)] {
        let limit = undamped(mismatch);
        for beta in [largest, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10] {
            let (wave, point) = damped(&limit, beta);
            waves.push((beta, wave, point));
        }
    }
    waves
}

#[test]
fn zero_is_an_eigenvalue() {
    let mut worst = 0.0_f64;
    for (beta, wave, point) in specimens() {
        let characteristic = linearised(&(wave, point));
        let [trace, _] = characteristic.evaluate(C64::new(0.0, 0.0)).numbers();
        println!("observed: β = {beta:e}: {:.1e}", (trace - 1.0).norm());
        worst = worst.max((trace - 1.0).norm());
    }
    observed(
        "translation of separated waves with material damping",
        worst,
    );
    assert!(worst < 1e-11, "{worst:e}");
}

/// (λ(β) − λ_C)/β tends to a limit, λ_C being the eigenvalues of the wave with Coulomb impacts, from a
/// problem of half the order with other jumps.
#[test]
fn the_limit_is_the_spectrum_of_the_coulomb_impact() {
    // with stick, and two waves without, one of which separates
    let without = |mismatch: f64| {
        undamped_of(
            "Geometry(nu: 0.2, xi: 1.3, gamma: 1.0), friction: 0.1",
            3,
            mismatch,
        )
    };
    for (limit, mismatch) in [
        (undamped(0.01), 0.01),
        (undamped(0.045), 0.045),
        (without(0.06), 0.06),
        (without(0.02), 0.02),
    ] {
        println!("{}", limit.0.signature);
        let undamped = leading(&window(&linearised(&limit)), -0.1);
        assert!(!undamped.is_empty());
        let slopes = |beta: f64| -> Vec<C64> {
            let found = leading(&window(&linearised(&damped(&limit, beta))), -0.3);
            let nearest = |(sector, value): &(usize, C64)| {
                let near = found.iter().filter(|(other, _)| other == sector);
                let moved = near.map(|(_, other)| other - value);
                let least = moved.min_by(|one, other| one.norm().total_cmp(&other.norm()));
                least.expect("eigenvalues of this sector") / beta
            };
            undamped.iter().map(nearest).collect()
        };
        let first = slopes(1e-6);
        for beta in [1e-5, 1e-8] {
            let mut worst = 0.0_f64;
            for (slope, first) in slopes(beta).into_iter().zip(&first) {
                let error = (slope - first).norm() / (1.0 + first.norm());
                // the term of second order, and the rounding of eigenvalues
                let allowed = 1e4 * beta.max(1e-6) + 1e-11 / beta;
                assert!(error < allowed, "β = {beta}: {slope} for {first}");
                worst = worst.max(error);
            }
            println!("observed: δ = {mismatch}, β = {beta:e}: slopes agree to {worst:.1e}");
        }
    }
}

/// A zone as ẋ = Ax on (η, η′, η″), before it (u, u′, u″) in separation.
fn equations(wave: &Wave, point: &Vector, regime: Regime, lambda: C64) -> DMatrix<C64> {
    let model = wave.model_at(point);
    let c = model.constants().coefficients;
    let speed = wave.speed_at(point);
    let kappa = c.coupling / speed;
    let (alpha, beta) = (model.damping.mass, model.damping.stiffness);
    // (d − λ)(1 + βd) in (1, d, d²)
    let turned = [-lambda, C64::from(1.0) - lambda * beta, C64::from(beta)];
    // [stiffness − drive(d − λ) − stress(d − λ)²](1 + βd) + d², solved for βã d³
    let row = |stress: f64, stiffness: f64, drive: f64| -> [C64; 3] {
        let ratio = stress / (speed * speed);
        let square = [
            lambda * lambda,
            lambda * lambda * beta - lambda * 2.0,
            C64::from(1.0) - lambda * (2.0 * beta),
        ];
        [0, 1, 2].map(|i| {
            let plain = [stiffness, stiffness * beta + alpha, 1.0][i];
            (C64::from(plain) - turned[i] * drive - square[i] * ratio) / (beta * ratio)
        })
    };
    let separated = regime == Regime::Separation;
    let first = if separated { 3 } else { 0 };
    let mut matrix = DMatrix::<C64>::zeros(first + 3, first + 3);
    for i in (0..first + 3).filter(|i| i % 3 != 2) {
        matrix[(i, i + 1)] = C64::from(1.0);
    }
    let drive = regime.sliding().unwrap_or(0.0) * model.friction * kappa;
    for (j, entry) in row(c.a, c.h, drive).into_iter().enumerate() {
        matrix[(first + 2, first + j)] = entry;
    }
    if separated {
        for (j, entry) in row(c.b, c.g, 0.0).into_iter().enumerate() {
            matrix[(2, j)] = entry;
            let scale = speed * speed * kappa / beta;
            matrix[(2, 3 + j)] = turned[j] * (scale / c.b);
            matrix[(5, j)] = turned[j] * (-scale / c.a);
        }
    }
    matrix
}

/// Collocation at six Gauss points of each of the intervals, which shrink towards the ends of the zones: of
/// linear equations with constant coefficients it is the diagonal Padé approximant of the exponential.
const INTERVALS: usize = 60;
const SHRINK: f64 = 0.8;
const LARGEST: f64 = 1.0 / 24.0;
const GAUSS: usize = 6;

/// The equations within a slip zone and the separation zone behind it, and how many they are: three unknowns
/// at each of the places of the first, then six at each of the second. The switches are left open.
fn collocated(wave: &Wave, point: &Vector, lambda: C64) -> (DMatrix<C64>, usize) {
    let sizes = [3 * (INTERVALS + 1), 6 * (INTERVALS + 1)];
    let total = sizes[0] + sizes[1];
    let mut matrix = DMatrix::<C64>::zeros(total, total);
    let mut row = 0;
    for (zone, regime) in [Regime::Slip, Regime::Separation].into_iter().enumerate() {
        let generator = equations(wave, point, regime, lambda);
        let size = generator.nrows();
        let duration = wave.duration_at(point, zone);
        let mut left = duration;
        for interval in 0..INTERVALS {
            let rest = if interval + 1 == INTERVALS {
                0.0
            } else {
                (SHRINK * left).max(left - LARGEST * duration)
            };
            let step = &generator * C64::from(left - rest);
            left = rest;
            // Σ (2s − j)! s!/((2s)! j! (s − j)!) (±hA)^j
            let mut power = DMatrix::<C64>::identity(size, size);
            let (mut forth, mut back) = (power.clone(), -power.clone());
            let mut factor = 1.0;
            for j in 1..=GAUSS {
                factor *= (GAUSS + 1 - j) as f64 / ((2 * GAUSS + 1 - j) * j) as f64;
                power = &power * &step;
                let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
                forth += &power * C64::from(factor);
                back -= &power * C64::from(factor * sign);
            }
            let column = zone * sizes[0] + interval * size;
            matrix
                .view_mut((row, column), (size, size))
                .copy_from(&forth);
            matrix
                .view_mut((row, column + size), (size, size))
                .copy_from(&back);
            row += size;
        }
    }
    (matrix, row)
}

/// σfb/a of slip.
fn share(wave: &Wave, point: &Vector) -> f64 {
    let c = wave.model_at(point).constants().coefficients;
    wave.model.friction * c.b / c.a
}

/// N(λ) of slip-separation-stick waves by collocation. All of it is one linear system.
#[test]
fn collocation_finds_the_same_function() {
    let limit = undamped(0.01);
    let mut worst = 0.0_f64;
    for (beta, places) in [(5e-3, 3), (2e-3, 1)] {
        let (wave, point) = damped(&limit, beta);
        assert_eq!(wave.signature.to_string(), "slip-separation-stick");
        let characteristic = linearised(&(wave.clone(), point.clone()));
        let share = share(&wave, &point);
        let posed = wave.at(&point).expect("a frame");
        let end = posed.zone_end(1).expect("a landing");
        let ratio = end.impulse[1].value / end.impulse[0].value;
        let lambdas = [
            C64::new(0.05, 2.5),
            C64::new(-0.3, -6.0),
            C64::new(0.4, 11.0),
        ];
        for lambda in lambdas.into_iter().take(places) {
            let (mut matrix, mut row) = collocated(&wave, &point, lambda);
            let total = matrix.nrows();
            let mut right = DVector::<C64>::zeros(total);
            let entry = 3 * (INTERVALS + 1);
            let (leave, land) = (entry - 3, total - 6);
            let mut condition = |terms: &[(usize, f64)], value: f64| {
                for &(column, factor) in terms {
                    matrix[(row, column)] = C64::from(factor);
                }
                right[row] = C64::from(value);
                row += 1;
            };
            condition(&[(0, 1.0)], 1.0);
            condition(&[(1, 1.0)], 0.0);
            condition(&[(entry, 1.0)], 0.0);
            condition(&[(entry + 1, 1.0)], 0.0);
            condition(&[(entry + 3, 1.0), (leave, -1.0)], 0.0);
            condition(&[(entry + 4, 1.0), (leave + 1, -1.0)], 0.0);
            condition(
                &[(entry + 5, 1.0), (entry + 2, -share), (leave + 2, -1.0)],
                0.0,
            );
            condition(&[(land, 1.0)], 0.0);
            condition(&[(land + 4, 1.0), (land + 1, -ratio)], 0.0);
            assert_eq!(row, total);
            for index in 0..total {
                let size = matrix
                    .row(index)
                    .iter()
                    .map(|x| x.norm())
                    .fold(0.0, f64::max);
                matrix.row_mut(index).unscale_mut(size);
                right[index] /= size;
            }
            let motion = matrix.lu().solve(&right).expect("a regular problem");
            let expected = motion[land + 3] * (-lambda * characteristic.period).exp();
            let [found, _] = characteristic.evaluate(lambda).numbers();
            let error = (found - expected).norm() / expected.norm().max(1.0);
            println!("observed: β = {beta}, λ = {lambda}: {error:.1e}");
            worst = worst.max(error);
        }
    }
    observed("N(λ) of separated waves against collocation", worst);
    assert!(worst < 1e-9, "{worst:e}");
}

/// A wave of slip and separation alone, mode 4.
fn without_stick(mass: f64, stiffness: f64) -> (Wave, Vector) {
    let text = format!(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, mismatch: 0.06, \
         damping: (mass: {mass:?}, stiffness: {stiffness:?})), wave: (mode: 4, start: Fast), \
         continuation: (parameter: Mismatch, range: (0.003, 0.06), toward: Down))"
    );
    let problem = problem::parse(&text, "without stick").expect("a problem");
    let items = follow(&problem, &text).items;
    let (wave, point) = items.last().expect("points").wave();
    assert_eq!(wave.signature.to_string(), "slip-separation");
    (wave.clone(), point.clone())
}

/// The least pivot of all conditions of a wave of slip and separation, by collocation: the number s of
/// Ax + sb = 0, b·x = 1, which vanishes where A is singular.
fn singular((wave, point): &(Wave, Vector), lambda: C64, z: C64) -> C64 {
    let period = wave.duration_at(point, 0) + wave.duration_at(point, 1);
    let (mut matrix, mut row) = collocated(wave, point, lambda);
    let total = matrix.nrows();
    let entry = 3 * (INTERVALS + 1);
    let (leave, land) = (entry - 3, total - 6);
    let share = share(wave, point);
    // Ü, V̈ before the landing, and U⃛, V⃛ by the equations on both of its sides
    let posed = wave.at(point).expect("a frame");
    let flows = &posed.flows;
    let at = flows.frame.at;
    let end = posed.zone_end(1).expect("a landing");
    let [lift, bend] = end.impulse.map(|jet| jet.value / at.material);
    let slip = wave.slide_at(point, 0);
    let after = flows
        .contact(Regime::Slip)
        .acceleration(&slip, 0.0, slip.entry);
    let (alpha, beta) = (at.damping, at.material);
    let (rate, place) = (end.w.value, end.y.value + flows.frame.steady().value);
    let pressed = at.g * at.mismatch + at.kappa * rate;
    let lift_rate = (at.mb * lift + at.kappa * beta * bend + pressed) / (beta * at.radial_stress);
    let held = (alpha + beta * at.h) * rate + at.h * place;
    let free = (at.ma * bend - at.kappa * beta * lift + held) / (beta * at.stress);
    let rubbed = at.friction * (pressed + at.kappa * beta * after);
    let slid = (at.ma * after + held - rubbed) / (beta * at.stress);
    let turned = (slid - free + share * lift_rate) / lift;
    let turn = (-lambda * period).exp() / z;
    let mut condition = |terms: &[(usize, f64)], closing: &[(usize, f64)]| {
        for &(column, factor) in terms {
            matrix[(row, column)] = C64::from(factor);
        }
        for &(column, factor) in closing {
            matrix[(row, column)] = turn * factor;
        }
        row += 1;
    };
    condition(&[(entry, 1.0)], &[]);
    condition(&[(entry + 1, 1.0)], &[]);
    condition(&[(entry + 3, 1.0), (leave, -1.0)], &[]);
    condition(&[(entry + 4, 1.0), (leave + 1, -1.0)], &[]);
    condition(
        &[(entry + 5, 1.0), (entry + 2, -share), (leave + 2, -1.0)],
        &[],
    );
    condition(&[(land, 1.0)], &[]);
    condition(&[(0, -1.0)], &[(land + 3, 1.0)]);
    // [V̈] = −sÜ⁻ and τ = −u′/Ü⁻
    condition(&[(1, -1.0)], &[(land + 4, 1.0), (land + 1, -share)]);
    condition(
        &[(2, -1.0)],
        &[(land + 5, 1.0), (land + 2, -share), (land + 1, turned)],
    );
    assert_eq!(row, total);
    let mut bordered = DMatrix::<C64>::zeros(total + 1, total + 1);
    for index in 0..total {
        let size = matrix
            .row(index)
            .iter()
            .map(|x| x.norm())
            .fold(0.0, f64::max);
        matrix.row_mut(index).unscale_mut(size);
    }
    bordered.view_mut((0, 0), (total, total)).copy_from(&matrix);
    for index in 0..total {
        let number = |frequency: f64| C64::from((frequency * (index + 1) as f64).sin());
        bordered[(index, total)] = number(1.3);
        bordered[(total, index)] = number(0.7);
    }
    let mut right = DVector::<C64>::zeros(total + 1);
    right[total] = C64::from(1.0);
    bordered.lu().solve(&right).expect("a regular problem")[total]
}

/// Waves without stick: translation, and eigenvalues where the problem by collocation is singular.
#[test]
fn collocation_finds_the_spectrum_without_stick() {
    let (mut translation, mut worst) = (0.0_f64, 0.0_f64);
    for (mass, stiffness) in [(0.0, 0.012), (0.1, 0.008)] {
        let solved = without_stick(mass, stiffness);
        let characteristic = linearised(&solved);
        let value = characteristic.evaluate(C64::new(0.0, 0.0));
        let unit = value.unit.value.norm() * (value.unit.exponent - value.top()).exp();
        translation = translation.max(value.sector(C64::new(1.0, 0.0)).0.norm() / unit);
        let spectrum = window(&characteristic);
        println!(
            "observed: α = {mass}, β = {stiffness}: stable {:?}, {:?}",
            spectrum.stable, spectrum.reasons
        );
        let found = leading(&spectrum, -0.4);
        assert!(found.len() > 2, "{found:?}");
        for (sector, lambda) in found.into_iter().take(3) {
            let z = characteristic.multiplier(sector);
            let step = 1e-4;
            let mut last = (lambda + step, singular(&solved, lambda + step, z));
            let mut here = lambda;
            for _ in 0..3 {
                let value = singular(&solved, here, z);
                let next = here - value * (here - last.0) / (value - last.1);
                last = (here, value);
                here = next;
            }
            println!(
                "observed: sector {sector}, {lambda}: {:.1e}",
                (here - lambda).norm()
            );
            worst = worst.max((here - lambda).norm());
        }
    }
    observed("translation without stick", translation);
    observed("eigenvalues without stick against collocation", worst);
    assert!(translation < 1e-11, "{translation:e}");
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn eigenfunctions_close() {
    let (mut closure, mut residual) = (0.0_f64, 0.0_f64);
    for (_, wave, point) in specimens() {
        let speed = wave.speed_at(&point);
        let characteristic = linearised(&(wave, point));
        let defects = eigenfunction_defects(&characteristic, speed);
        closure = closure.max(defects[0]);
        residual = residual.max(defects[1]);
    }
    observed("closure of eigenfunctions", closure);
    observed("their equations, by differences", residual);
    assert!(closure < 1e-9, "{closure:e}");
    // sixth-order differences err by (h|λ|)⁶/140, h being 1e-2 of a zone and |λ| up to 13
    assert!(residual < 2e-7, "{residual:e}");
}

/// On Re λ = 0 far above 1/β the perturbation decays like e^{−s/β} wherever it does not stick.
#[test]
fn high_frequencies_decay_out_of_stick() {
    let (wave, point) = without_stick(0.0, 0.012);
    let waves = specimens().into_iter().chain([(0.012, wave, point)]);
    for (beta, wave, point) in waves {
        // e^{−T/β} is a number down to e^{−745}
        if beta < 2e-3 {
            continue;
        }
        let zones = 0..wave.zones();
        let moving = zones.filter(|&zone| wave.signature.zone(zone).regime != Regime::Stick);
        let time: f64 = moving.map(|zone| wave.duration_at(&point, zone)).sum();
        let characteristic = linearised(&(wave, point));
        let exponent = |omega: f64| {
            let value = characteristic.evaluate(C64::new(0.0, omega));
            let (trace, unit) = (value.trace, value.unit);
            trace.value.norm().ln() + trace.exponent - unit.value.norm().ln() - unit.exponent
        };
        let last = exponent(1e5 / beta) * beta / time;
        // what is left of it falls like 1/(βω)²
        assert!((last + 1.0).abs() < 1e-9, "{last}");
    }
}

/// With both kinds of damping a wave that sticks, slips and separates is stable on the full circle below the
/// last of its Hopf points, δ = 0.009443.
#[test]
fn a_separated_wave_is_stable_on_the_full_circle() {
    let stability = |mismatch: f64| {
        let text = format!(
            "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
             mismatch: 0.06, damping: (mass: 0.1, stiffness: 0.005)), wave: (mode: 4, start: Fast), \
             continuation: (parameter: Mismatch, range: ({mismatch:?}, 0.06), toward: Down))"
        );
        let problem = problem::parse(&text, "stable").expect("a problem");
        let items = follow(&problem, &text).items;
        let (wave, point) = items.last().expect("points").wave();
        assert_eq!(wave.signature.to_string(), "slip-separation-slip-stick");
        let spectrum = window(&Characteristic::new(wave, point).expect("Coulomb's law"));
        assert!(spectrum.complete);
        (spectrum.stable, spectrum.unstable())
    };
    assert_eq!(stability(0.007), (Stability::Yes, 0));
    // just opened, and between the Hopf points
    for mismatch in [0.0389, 0.025, 0.012] {
        let (stable, unstable) = stability(mismatch);
        assert_eq!(stable, Stability::No, "δ = {mismatch}");
        assert!(unstable > 0, "δ = {mismatch}");
    }
}
