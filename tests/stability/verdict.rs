//! A wave is called stable only when that is proven.

use brakewave::branch::{Stability, VerdictReason};
use brakewave::tube::wave::start::Which;

use crate::stability::waves::{C64, damped, follow, linearised, mode4, window};

/// Above α = 0.3151 no eigenvalue grows, and the limit at high frequency is negative.
#[test]
fn damped_wave_is_stable_at_last() {
    let spectrum = window(&linearised(&damped(0.317), 4, Which::Fast));
    assert!(spectrum.complete && spectrum.limit < 0.0);
    assert_eq!(spectrum.unstable(), 0);
    assert_eq!(spectrum.stable, Stability::Yes);
    for damping in [0.0, 0.1, 0.2, 0.3] {
        let spectrum = window(&linearised(&damped(damping), 4, Which::Fast));
        assert_eq!(spectrum.stable, Stability::No, "α = {damping}");
        assert!(spectrum.unstable() > 0);
    }
}

/// Undamped waves have growing eigenvalues at high frequency, also where the window has none: `no`, with
/// the limit or an eigenvalue beyond the window as its reason.
#[test]
fn undamped_wave_is_unstable_beyond_the_window() {
    let mut quiet = 0;
    for mismatch in [0.2, 0.08, 0.045, 0.0225, 0.02, 0.012, 0.004, 0.001] {
        let characteristic = linearised(&mode4(mismatch), 4, Which::Fast);
        let spectrum = window(&characteristic);
        println!(
            "observed: δ = {mismatch}: {} unstable in the window, limit {:.4}, {:?}",
            spectrum.unstable(),
            spectrum.limit,
            spectrum.stable
        );
        assert!(spectrum.limit > 1e-3, "δ = {mismatch}: {}", spectrum.limit);
        assert_eq!(spectrum.stable, Stability::No, "δ = {mismatch}");
        if spectrum.unstable() > 0 {
            assert!(spectrum.reasons.is_empty());
            continue;
        }
        quiet += 1;
        match spectrum.reasons[..] {
            [VerdictReason::HighFrequency(limit)] => assert_eq!(limit, spectrum.limit),
            [VerdictReason::BeyondWindow { re, im, sector }] => {
                assert!(re > 0.0 && im.abs() > spectrum.max_frequency);
                let lambda = C64::new(re, im);
                let z = characteristic.multiplier(sector);
                let (f, by) = characteristic.evaluate(lambda).sector(z);
                assert!((f / by).norm() < 1e-11 * lambda.norm());
            }
            _ => panic!("δ = {mismatch}: {:?}", spectrum.reasons),
        }
    }
    assert!(quiet > 0, "some windows are empty");
}

/// A narrow window at realistic γ: what grows far above it is found in finite time and named.
#[test]
fn growth_beyond_a_narrow_window_is_named() {
    // λ of γ = 1 divided by 1e-4
    let (problem, text) = {
        let text = "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1e-8), friction: 0.5, \
             mismatch: 2e-5, damping: (mass: 2e3)), wave: (mode: 4, start: Fast), \
             continuation: (parameter: Mismatch, range: (1.999e-5, 2e-5), toward: Down), \
             stability: (sectors: All, max_frequency: 12.0))";
        (
            brakewave::problem::parse(text, "narrow").expect("a problem"),
            text,
        )
    };
    for item in follow(&problem, text).items {
        let point = &item.point;
        assert_eq!(
            (point.stable, point.unstable),
            (Some(Stability::No), Some(0))
        );
        let [VerdictReason::BeyondWindow { re, im, sector }] = point.why[..] else {
            panic!("{:?}", point.why);
        };
        // the leading one of the table of reference figures at α = 0.2
        assert_eq!(sector, 2);
        assert!((re * 1e-4 - 0.04781284620294).abs() < 1e-9, "{re}");
        assert!((im.abs() * 1e-4 - 0.8714186486489).abs() < 1e-9, "{im}");
    }
}
