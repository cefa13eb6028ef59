//! Slip-stick waves in closed form, solved a second time here.
//!
//! With F = fD/c − α and y = V − fgδ/h the slip zone is m_a ÿ − Fẏ + hy = 0 from y = F/h, ẏ = 1 to
//! the next ẏ = 1 after T1, and stick lasts T2 = y(0) − y(T1). With p = F/(2m_a) and
//! w = √(h/m_a − p²) > 0,
//!
//! ```text
//! y = e^{pt}(A cos wt + B sin wt),   A = F/h,   pA + wB = 1,
//! ```
//!
//! and ẏ has its minimum −e^{pπ/w} at wt = π, before it comes back to 1. The speed is the root of
//! (T1 + T2)|c| = 2π/k, found by bisection on both sides of the shortest wave.

use std::f64::consts::{PI, TAU};

use brakewave::branch::EventType;
use brakewave::branch::first_wave::first_wave;
use brakewave::tube::model::{Damping, Model, Parameter};
use brakewave::tube::wave::start::{Which, least_mismatch, slip_stick};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use crate::waves::branches::{Case, STEPS, fast_in_mismatch, lengths, speed, tube};
use crate::waves::observed;
use crate::waves::tube::{Coefficients, coefficients};

/// A slip zone and the stick zone after it.
#[derive(Clone, Copy, Debug)]
struct Wave {
    slip: f64,
    stick: f64,
    least_rate: f64,
    release: f64,
    /// Radians and e-folds of the slip zone: how often rounding is amplified.
    growth: f64,
}

/// The number between two at which an increasing function passes zero, to the last digit.
fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low.min(high) || middle >= low.max(high) {
            return middle;
        }
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

fn at_speed(tube: &Coefficients, friction: f64, damping: f64, magnitude: f64) -> Option<Wave> {
    let root = tube.a.sqrt();
    let ma = (magnitude - root) * (magnitude + root) / magnitude.powi(2);
    let force = friction * tube.coupling.abs() / magnitude - damping;
    let p = force / (2.0 * ma);
    let square = tube.h / ma - p * p;
    if !(ma > 0.0 && force > 0.0 && square > 0.0) {
        return None;
    }
    let w = square.sqrt();
    let a = force / tube.h;
    let b = (1.0 - p * a) / w;
    let y = |t: f64| (p * t).exp() * (a * (w * t).cos() + b * (w * t).sin());
    // (ẏ − 1)e^{−pt}
    let rate = |t: f64| (w * t).cos() + (p * b - w * a) * (w * t).sin() - (-p * t).exp();
    let slip = bisect(PI / w, TAU / w, rate);
    Some(Wave {
        slip,
        stick: a - y(slip),
        least_rate: -(p * PI / w).exp(),
        release: a,
        growth: 1.0 + (p + w) * slip,
    })
}

/// |c| of the wave: a scan of |c|/√a − 1 over many decades, and bisection. `None` if every length
/// of the scan is larger than the wavelength; the shortest one, relative to it, comes along.
fn solve(
    tube: &Coefficients,
    friction: f64,
    damping: f64,
    mode: u32,
    which: Which,
) -> (Option<f64>, f64) {
    const SCAN: u32 = 1500;
    let wanted = TAU / f64::from(mode);
    let excess = |magnitude: f64| {
        if friction * tube.coupling.abs() <= damping * magnitude {
            // no force: the linear wave of slip alone goes on where stick has vanished
            let square = magnitude * magnitude - tube.a;
            return TAU * (square / tube.h).sqrt() / wanted - 1.0;
        }
        at_speed(tube, friction, damping, magnitude).map_or(f64::INFINITY, |wave| {
            (wave.slip + wave.stick) * magnitude / wanted - 1.0
        })
    };
    let magnitude = |index: u32| {
        tube.a.sqrt() * (1.0 + 10.0_f64.powf(-9.0 + 13.0 * f64::from(index) / f64::from(SCAN)))
    };
    let values: Vec<f64> = (0..=SCAN).map(|index| excess(magnitude(index))).collect();
    let best = (0..=SCAN)
        .min_by(|one, other| values[*one as usize].total_cmp(&values[*other as usize]))
        .expect("a scan");
    let least = values[best as usize];
    if least > 0.0 {
        return (None, least);
    }
    // the length falls towards the shortest wave and rises beyond it
    let outside = |index: &u32| values[*index as usize] > 0.0;
    let outer = match which {
        Which::Fast => (best..=SCAN).find(outside),
        Which::Slow => (0..=best).rev().find(outside),
    };
    let root = outer.map(|outer| bisect(magnitude(best), magnitude(outer), excess));
    (root, least)
}

/// Rounding of one length: coefficients by quadrature (some 1e-14), exponential and circular
/// functions of arguments that grow with the slip zone.
const ROUNDING: f64 = 3e-14;

/// The library's closed form, and its first wave, against the solution above.
fn compare(nu: f64, xi: f64, friction: f64, damping: f64, mode: u32, which: Which) -> Option<f64> {
    let tube_numbers = coefficients(nu, xi, 1.0);
    let model = Model {
        damping: Damping {
            mass: damping,
            stiffness: 0.0,
        },
        ..tube(nu, xi, friction, 1.0)
    };
    let (magnitude, least) = solve(&tube_numbers, friction, damping, mode, which);
    let found = slip_stick(&model, mode, which);
    // the scan cannot tell on which side of the fold waves lie that are this close to it
    if least.abs() < 1e-4 || tube_numbers.coupling.abs() < 1e-3 * tube_numbers.a {
        return None;
    }
    let wave = magnitude.and_then(|magnitude| {
        at_speed(&tube_numbers, friction, damping, magnitude).map(|wave| (magnitude, wave))
    });
    let Some((magnitude, expected)) = wave else {
        assert!(found.is_err(), "{found:?} where there is no wave");
        return None;
    };
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    // an error of the length moves the root by its inverse slope
    let step = 1e-5 * (magnitude / tube_numbers.a.sqrt() - 1.0);
    let length = |magnitude: f64| {
        at_speed(&tube_numbers, friction, damping, magnitude)
            .map_or(f64::NAN, |wave| (wave.slip + wave.stick) * magnitude)
    };
    let around = [magnitude * (1.0 - step), magnitude * (1.0 + step)];
    let slope = (length(around[1]) - length(around[0])) / (2.0 * step * length(magnitude));
    let allowed_speed = ROUNDING * expected.growth * (1.0 + 1.0 / slope.abs());
    // and the zones with it
    let moved = around.map(|magnitude| {
        at_speed(&tube_numbers, friction, damping, magnitude).expect("a wave close by")
    });
    let model = Model {
        mismatch: 2.0 * least_mismatch(&model, &found).max(1e-3),
        ..model
    };
    // Newton's method stops at corrections of 1e-10, which rounding of c alone exceeds where the
    // length changes by more than 1e5 for a change of one in log c: the slow wave next to √a
    let stiff = slope.abs() * f64::EPSILON > 1e-11;
    let first = match first_wave(&model, Parameter::Mismatch, mode, which, 1.0, STEPS) {
        Ok((wave, point)) => {
            assert_eq!(wave.signature.to_string(), "slip-stick");
            let zones = wave.unpack(&point);
            Some([
                wave.speed_at(&point),
                zones[0].duration,
                zones[1].duration,
                zones[0].entry[0],
            ])
        }
        Err(error) => {
            assert!(stiff, "{error}: slope {slope:e}");
            None
        }
    };
    assert!(found.speed * tube_numbers.coupling > 0.0);
    let mut worst = 0.0_f64;
    let mut check = |value: f64, expected: f64, slope: f64, size: f64| {
        let allowed = ROUNDING * size + allowed_speed * slope.abs();
        let error = (value - expected).abs();
        worst = worst.max(error / size.max(slope.abs()));
        assert!(
            error <= allowed,
            "{value} for {expected}, allowed {allowed:e}"
        );
    };
    let by = |part: fn(&Wave) -> f64| (part(&moved[1]) - part(&moved[0])) / (2.0 * step);
    let size = expected.growth * (expected.slip + expected.stick + expected.release);
    let closed = [found.speed, found.slip, found.stick, found.release];
    for [speed, slip, stick, release] in std::iter::once(closed).chain(first) {
        assert!(speed * found.speed > 0.0);
        check(speed.abs(), magnitude, magnitude, 0.0);
        check(slip, expected.slip, by(|wave| wave.slip), size);
        check(stick, expected.stick, by(|wave| wave.stick), size);
        check(release, expected.release, by(|wave| wave.release), size);
    }
    let size = expected.growth * expected.least_rate.abs();
    check(
        found.least_rate,
        expected.least_rate,
        by(|wave| wave.least_rate),
        size,
    );
    Some(worst)
}

#[test]
fn slip_stick_waves_equal_an_independent_solution() {
    let mut runner = TestRunner::new_with_rng(
        Config {
            cases: 200,
            failure_persistence: None,
            ..Config::default()
        },
        proptest::test_runner::TestRng::deterministic_rng(
            proptest::test_runner::RngAlgorithm::ChaCha,
        ),
    );
    let strategy = (
        -0.4..0.47_f64,
        1.08..3.0_f64,
        0.02..0.8_f64,
        prop_oneof![Just(0.0), 0.0..0.1_f64],
        1..11_u32,
        prop_oneof![Just(Which::Fast), Just(Which::Slow)],
    );
    let outcome = std::cell::Cell::new((0, 0.0_f64));
    runner
        .run(&strategy, |(nu, xi, friction, damping, mode, which)| {
            if let Some(worst) = compare(nu, xi, friction, damping, mode, which) {
                let (count, before) = outcome.get();
                outcome.set((count + 1, before.max(worst)));
            }
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    let (count, worst) = outcome.get();
    observed(&format!("closed form, {count} waves of 200"), worst);
    assert!(count > 60, "{count}");
}

/// Pressure touches zero at δ = −(D/(cg)) min V̇ and reverse slip appears at
/// δ = −(α + fD/c + h(F/h − T2))/(2fg): whichever comes first as δ falls is the first event, and
/// up to there the wave does not depend on δ at all.
#[test]
fn onsets_and_independence_of_the_mismatch() {
    let sets = [
        (0.3, 1.5, 0.5, 0.0, 4, Which::Fast),
        (0.3, 1.5, 0.5, 0.05, 4, Which::Fast),
        (0.3, 1.5, 0.5, 0.0, 4, Which::Slow),
        (0.25, 1.25, 0.3, 0.0, 8, Which::Fast),
        (0.45, 1.25, 0.1, 0.0, 4, Which::Fast),
        (0.1, 2.0, 0.3, 0.02, 3, Which::Fast),
        (0.3, 1.5, 1.05, 0.0, 4, Which::Slow),
        (0.0, 1.3, 0.4, 0.0, 6, Which::Slow),
    ];
    let mut seen = Vec::new();
    for (nu, xi, friction, damping, mode, which) in sets {
        let numbers = coefficients(nu, xi, 1.0);
        let (magnitude, _) = solve(&numbers, friction, damping, mode, which);
        let Some(magnitude) = magnitude else {
            panic!("{nu} {xi} {friction} {damping}")
        };
        let wave = at_speed(&numbers, friction, damping, magnitude).expect("a wave");
        let kappa = numbers.coupling.abs() / magnitude;
        let grazing = -kappa * wave.least_rate / numbers.g;
        let reverse = -(damping + friction * kappa + numbers.h * (wave.release - wave.stick))
            / (2.0 * friction * numbers.g);
        let (expected, kind) = if grazing > reverse {
            (grazing, EventType::GR)
        } else {
            (reverse, EventType::RV)
        };
        seen.push(kind);
        let case = Case {
            model: Model {
                damping: Damping {
                    mass: damping,
                    stiffness: 0.0,
                },
                ..tube(nu, xi, friction, 2.0 * expected)
            },
            mode,
            which,
            range: (0.99 * expected, 2.0 * expected),
            until: Some((kind, 1)),
            ..fast_in_mismatch()
        };
        let run = case.follow(&[]);
        let event = run.events()[0];
        assert_eq!(event.kind(), Some(kind), "{nu} {xi} {friction}");
        let error = (event.parameter / expected - 1.0).abs();
        observed(&format!("onset {kind} at δ = {expected:.6}"), error);
        // rounding of the scan's wave, amplified in m_a by |c|/(|c| − √a)
        let stiffness = magnitude / (magnitude - numbers.a.sqrt());
        assert!(
            error < 1e-13 * wave.growth * stiffness.max(10.0),
            "{} for {expected}",
            event.parameter
        );
        let first = &run.points[0];
        let zones = lengths(&first.orbit, &first.node.point);
        for found in run.points.iter().take_while(|found| found.kind().is_none()) {
            let change = (speed(found) / speed(first) - 1.0).abs();
            assert!(change <= 4.0 * f64::EPSILON, "{change:e}");
            for (length, other) in lengths(&found.orbit, &found.node.point).iter().zip(&zones) {
                assert!((length - other).abs() < 1e-13 * other.max(0.1) * stiffness);
            }
        }
    }
    assert!(seen.contains(&EventType::GR) && seen.contains(&EventType::RV));
}
