//! The Coulomb impact: at landing m_a[V̇] = f m_b|U̇⁻| towards V̇ = 1, and not beyond it.

use brakewave::branch::EventType::{CO, GR, RV};
use brakewave::branch::special::Stop;
use brakewave::continuation::walk::End;
use brakewave::tube::wave::profile::sample;

use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::signature::ZoneEntry;
use brakewave::tube::model::{Impact, Model, Parameter};
use brakewave::tube::wave::start::{Which, fold_in_friction};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use crate::waves::branches::{Case, Run, STEPS, speed, to_the_end, with_coulomb_impact};
use crate::waves::observed;
use crate::waves::tube::coefficients;

/// Rounding of U̇⁻, with |U̇⁻| of the order of the velocities, and of V̇ on both sides.
const ROUNDING: f64 = 1e-12;

/// Largest violation of the law, and the number of free and of capped landings.
fn landings(run: &Run) -> (f64, usize, usize) {
    let tube = coefficients(0.3, 1.5, 1.0);
    let (mut worst, mut free, mut capped) = (0.0_f64, 0, 0);
    for found in &run.points {
        assert_eq!(found.orbit.model.impact, Impact::Coulomb);
        let square = speed(found).powi(2);
        let (ma, mb) = (1.0 - tube.a / square, 1.0 - tube.b / square);
        let friction = found.orbit.model.friction;
        let samples = sample(&found.orbit, &found.node.point, 100).expect("a profile");
        for pair in samples.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            if before.regime != "separation" || after.regime == "separation" {
                continue;
            }
            assert!(before.radial_rate <= 0.0 && after.radial_rate == 0.0);
            let largest = friction * mb * before.radial_rate.abs() / ma;
            let lag = 1.0 - before.tangential_rate;
            let jump = after.tangential_rate - before.tangential_rate;
            let size = 1.0 + lag.abs() + largest;
            let arrested = (after.tangential_rate - 1.0).abs() <= ROUNDING * size;
            let error = if arrested && lag.abs() <= largest {
                capped += 1;
                (jump - lag).abs()
            } else {
                free += 1;
                // towards V̇ = 1, and not as far as that
                assert!(largest < lag.abs() + ROUNDING * size, "{largest} {lag}");
                (jump - largest.copysign(lag)).abs()
            };
            worst = worst.max(error / size);
            assert!(error <= ROUNDING * size, "{before:?} {after:?}");
        }
    }
    (worst, free, capped)
}

#[test]
fn coulomb_impact_obeys_its_law() {
    let run = with_coulomb_impact().follow(&[]);
    let last = run.points.last().expect("points");
    let kinds: Vec<_> = run
        .events()
        .iter()
        .filter_map(|found| found.kind())
        .collect();
    assert_eq!(kinds, [RV, GR, CO, RV]);
    assert_eq!(last.parameter, 0.001, "{:?}", run.end);
    let (worst, free, capped) = landings(&run);
    observed(
        &format!("Coulomb impact, {free} free and {capped} capped landings"),
        worst,
    );
    assert!(free > 0 && capped > 0, "{free} {capped}");
}

/// The tube whose landing pressure reaches zero.
fn touching() -> Case {
    let geometry = Geometry {
        nu: -0.3,
        xi: 1.5,
        gamma: 1.0,
    };
    let case = with_coulomb_impact();
    Case {
        model: Model {
            impact: Impact::Coulomb,
            ..Model::tube(geometry, 0.3, 1.0)
        },
        range: (0.01, 1.0),
        ..case
    }
}

/// Where contact after landing would need tension the surface takes off at once: a touch, with its
/// share of friction on the impulse.
#[test]
fn a_touch_obeys_the_law_of_the_impact() {
    let run = touching().follow(&[]);
    assert_eq!(run.end, Some(End::Edge));
    let (mut worst, mut touches) = (0.0_f64, 0);
    for found in &run.points {
        let (wave, point) = (&found.orbit, &found.node.point);
        let flows = wave.flows(point).expect("a frame");
        let at = &flows.frame.at;
        for zone in 0..wave.zones() {
            if wave.signature.zone(zone).entry != ZoneEntry::Touch {
                continue;
            }
            let before = zone + wave.zones() - 1;
            let [_, normal, y, w] = flows
                .separation()
                .state(
                    &wave.slide_at(point, before),
                    wave.duration_at(point, before),
                )
                .expect("a state");
            let [y_after, w_after] = wave.entry_at(point, zone);
            let jump = at.friction * at.mb * normal.abs() / at.ma;
            let size = 1.0 + w.abs();
            worst = worst
                .max((w_after - w - jump).abs() / size)
                .max((y_after - y).abs());
            // tension, so that nothing stays in contact, and V̇ far from 1
            assert!(at.g * at.mismatch + at.kappa * w_after < ROUNDING * size);
            touches += 1;
        }
    }
    observed(&format!("Coulomb impact, {touches} touches"), worst);
    assert!(touches > 50 && worst < ROUNDING, "{touches} {worst:e}");
}

/// The successor of every event of random branches is found: none ends for want of a signature.
#[test]
fn random_branches_never_want_a_signature() {
    let config = Config {
        cases: 24,
        failure_persistence: None,
        ..Config::default()
    };
    let mut runner = TestRunner::new_with_rng(
        config,
        proptest::test_runner::TestRng::deterministic_rng(
            proptest::test_runner::RngAlgorithm::ChaCha,
        ),
    );
    let seen = std::cell::Cell::new((0, 0));
    let draw = (
        -0.4..0.45_f64,
        1.15..2.0_f64,
        2..9_u32,
        0.1..0.9_f64,
        prop::bool::ANY,
    );
    runner
        .run(&draw, |(nu, xi, mode, share, slow)| {
            let geometry = Geometry { nu, xi, gamma: 1.0 };
            let model = Model {
                impact: Impact::Coulomb,
                ..Model::tube(geometry, 0.1, 1.0)
            };
            let fold = fold_in_friction(&model, mode).expect("a fold");
            // beside D = 0 any friction will do
            prop_assume!(fold < 10.0);
            let model = model.with(Parameter::Friction, share * fold);
            let which = if slow { Which::Slow } else { Which::Fast };
            let closed =
                brakewave::tube::wave::start::slip_stick(&model, mode, which).expect("a wave");
            let least = brakewave::tube::wave::start::least_mismatch(&model, &closed);
            let case = Case {
                model: model.with(Parameter::Mismatch, 1.2 * least),
                mode,
                which,
                range: (0.02 * least, 4.0 * least),
                until: Some((CO, 6)),
                ..with_coulomb_impact()
            };
            let run = to_the_end(case.follower(STEPS, &[]), case.until);
            let none = matches!(
                run.end,
                Some(End::Own(Stop::NoSignature | Stop::NoneAdmissible(_)))
            );
            prop_assert!(!none, "{:?}: {:?}", case, run.end);
            let (runs, events) = seen.get();
            seen.set((runs + 1, events + run.events().len()));
            Ok(())
        })
        .expect("every event has a successor");
    let (runs, events) = seen.get();
    assert!(runs >= 24 && events > 72, "{runs} runs, {events} events");
}
