//! Waves at the ends of the ranges of their parameters: nothing is lost and nothing overflows.

use brakewave::branch::Stability;
use brakewave::linalg::Vector;
use brakewave::tube::model::{Model, Parameter};
use brakewave::tube::stability::characteristic::Characteristic;
use brakewave::tube::wave::Wave;
use brakewave::tube::wave::start::{Which, fold_in_friction, least_mismatch, slip_stick};

use crate::stability::observed;
use crate::stability::waves::{C64, damped, tube, wave, window};

/// The slip-stick wave at a mismatch where it is one; stability does not depend on δ then.
fn slip_stick_wave(model: &Model, mode: u32, which: Which) -> (Wave, Vector) {
    let closed = slip_stick(model, mode, which).expect("there is a wave");
    let mismatch = 1.2 * least_mismatch(model, &closed).abs() + 1e-3;
    let (wave, point) = wave(&model.with(Parameter::Mismatch, mismatch), mode, which);
    assert_eq!(wave.signature.to_string(), "slip-stick");
    (wave, point)
}

/// The spectrum is complete and finite. Returns the defect of the translation mode.
fn check(name: &str, model: &Model, mode: u32, which: Which) -> f64 {
    let (wave, point) = slip_stick_wave(model, mode, which);
    let characteristic = Characteristic::new(&wave, &point).expect("no impact");
    let started = std::time::Instant::now();
    let spectrum = window(&characteristic);
    let zones: Vec<f64> = (0..2).map(|zone| wave.duration_at(&point, zone)).collect();
    let total: usize = spectrum
        .sectors
        .iter()
        .map(|sector| sector.eigenvalues.len())
        .sum();
    let defect = spectrum.translation_defect.unwrap_or(f64::NAN);
    println!(
        "observed: {name}: durations {:.1e} and {:.1e}, {total} eigenvalues, left {:.2}, limit \
         {:.1e}, {:?}, translation {defect:.1e}, {:.0} ms",
        zones[0],
        zones[1],
        spectrum.left,
        spectrum.limit,
        spectrum.stable,
        started.elapsed().as_secs_f64() * 1e3
    );
    assert!(
        spectrum.complete || spectrum.stable != Stability::Yes,
        "{name}"
    );
    assert!(spectrum.complete, "{name}: not as many found as counted");
    assert!(
        spectrum.left.is_finite() && spectrum.right.is_finite(),
        "{name}"
    );
    assert!(spectrum.limit.is_finite(), "{name}");
    assert_eq!(spectrum.sectors.len(), mode as usize / 2 + 1, "{name}");
    for sector in &spectrum.sectors {
        let z = characteristic.multiplier(sector.sector);
        for one in &sector.eigenvalues {
            assert!(one.re.is_finite() && one.im.is_finite(), "{name}: {one:?}");
            let (f, by) = characteristic.evaluate(one.value()).sector(z);
            let distance = (f / by).norm();
            assert!(
                distance <= 1e-11 * (1.0 + one.value().norm()) || f.norm() < 1e-13,
                "{name}, sector {}: {one:?} misses a zero by {distance:e}",
                sector.sector
            );
        }
    }
    // the translation mode is a simple zero: rounding of F over F′
    let zero = characteristic.evaluate(C64::new(0.0, 0.0));
    let (f, by) = zero.sector(C64::new(1.0, 0.0));
    let expected = (f.norm() + 1e-13) / by.norm();
    assert!(
        defect <= 20.0 * expected,
        "{name}: translation mode at {defect:e}, rounding explains {expected:e}"
    );
    defect
}

#[test]
fn close_to_the_fold() {
    let mut worst = 0.0_f64;
    for mode in [1, 4, 8] {
        let model = tube(0.3, 1.5, 0.5, 0.2);
        let fold = fold_in_friction(&model, mode).expect("there is a fold");
        for share in [0.99, 0.9999, 0.999_999] {
            let model = model.with(Parameter::Friction, share * fold);
            for which in [Which::Fast, Which::Slow] {
                let name = format!("{which:?}, mode {mode}, {share} of the fold");
                worst = worst.max(check(&name, &model, mode, which));
            }
        }
    }
    observed("translation mode close to the fold", worst);
}

#[test]
fn short_waves() {
    let mut worst = 0.0_f64;
    for mode in [12, 32, 64] {
        let fold = fold_in_friction(&tube(0.3, 1.5, 0.01, 0.2), mode).expect("there is a fold");
        for share in [0.1, 0.9] {
            let model = tube(0.3, 1.5, share * fold, 0.2);
            let name = format!("fast, mode {mode}, {share} of the fold");
            worst = worst.max(check(&name, &model, mode, Which::Fast));
        }
    }
    observed("translation mode of short waves", worst);
}

/// c → √a: one delay grows like 1/√(|c|/√a − 1), and the zeros lie as dense.
#[test]
fn slow_waves() {
    let mut worst = 0.0_f64;
    for (mode, friction) in [(4, 0.5), (4, 0.1), (1, 0.1), (1, 0.02)] {
        let name = format!("slow, mode {mode}, f = {friction}");
        let model = tube(0.3, 1.5, friction, 0.2);
        worst = worst.max(check(&name, &model, mode, Which::Slow));
    }
    observed("translation mode of slow waves", worst);
}

/// Where more zeros than can be listed lie in the window, it is cut and said to be incomplete.
#[test]
fn a_window_with_too_many_zeros() {
    let model = tube(0.3, 1.5, 1e-3, 0.2);
    let (wave, point) = slip_stick_wave(&model, 4, Which::Slow);
    let spectrum = window(&Characteristic::new(&wave, &point).expect("no impact"));
    assert!(!spectrum.complete);
    // growth was found all the same
    assert!(spectrum.unstable() > 0);
    assert_eq!(spectrum.stable, Stability::No);
}

/// ν → ½: a and D grow without bound, b does not.
#[test]
fn nearly_incompressible() {
    let mut worst = 0.0_f64;
    for nu in [0.45, 0.49, 0.4999] {
        for mode in [1, 4] {
            let fold = fold_in_friction(&tube(nu, 1.5, 1e-3, 0.2), mode).expect("there is a fold");
            for share in [0.1, 0.9] {
                let name = format!("fast, mode {mode}, ν = {nu}, {share} of the fold");
                let model = tube(nu, 1.5, share * fold, 0.2);
                worst = worst.max(check(&name, &model, mode, Which::Fast));
            }
        }
    }
    observed("translation mode as ν → ½", worst);
}

/// Where the stick zone vanishes: α√(ak² + h) = kf|D|.
fn end_of_stick(mode: u32) -> f64 {
    let parameters = damped(0.0).constants();
    let coefficients = parameters.coefficients;
    let k = f64::from(mode);
    k * parameters.friction * coefficients.coupling.abs()
        / (coefficients.a * k * k + coefficients.h).sqrt()
}

#[test]
fn damping_up_to_the_end_of_stick() {
    let mut worst = 0.0_f64;
    let end = end_of_stick(4);
    for share in [0.5, 0.99, 0.9999, 0.999_999, 0.999_999_9] {
        let name = format!("{share} of the largest α");
        worst = worst.max(check(&name, &damped(share * end), 4, Which::Fast));
    }
    observed("translation mode up to the end of stick", worst);
}

#[test]
fn stick_of_no_length() {
    let stick =
        |damping: f64| slip_stick(&damped(damping), 4, Which::Fast).map_or(0.0, |wave| wave.stick);
    let mut worst = 0.0_f64;
    for length in [1e-2, 1e-4, 1e-6] {
        let (mut low, mut high) = (0.0, end_of_stick(4));
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if stick(middle) > length {
                low = middle;
            } else {
                high = middle;
            }
        }
        let name = format!("stick {:.1e} long", stick(low));
        worst = worst.max(check(&name, &damped(low), 4, Which::Fast));
    }
    observed("translation mode of waves with little stick", worst);
}
