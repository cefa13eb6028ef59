//! What happens along a branch depends neither on its direction nor on the steps.

use brakewave::branch::EventType::{EP, UZ};
use brakewave::branch::orbit::{Follower, Found};
use brakewave::continuation::Steps;
use brakewave::continuation::walk::End;
use brakewave::orbit::follow::Limits;

use brakewave::tube::model::coefficients::Geometry;
use brakewave::tube::model::{Damping, Impact, Model};

use crate::waves::branches::{
    Case, Run, STEPS, fast_in_friction, fast_in_mismatch, regimes, slow_in_mismatch, to_the_end,
    tube, with_the_shaft,
};
use crate::waves::observed;

/// The same events in the same order. Parameters of events are exact to the uncertainty that the
/// program states for each, and 1e-10 is a hundred times the largest of these.
pub fn same(one: &[&Found], other: &[&Found], reversed: bool) -> f64 {
    let list = |found: &[&Found]| -> Vec<String> {
        found
            .iter()
            .map(|found| format!("{:?} at {}", found.kind(), found.parameter))
            .collect()
    };
    assert_eq!(one.len(), other.len(), "{:?} {:?}", list(one), list(other));
    let mut worst = 0.0_f64;
    for (one, other) in one.iter().zip(other) {
        assert_eq!(one.kind(), other.kind(), "at {}", other.parameter);
        let error = (one.parameter / other.parameter - 1.0).abs();
        worst = worst.max(error);
        assert!(error < 1e-10, "{} for {}", one.parameter, other.parameter);
        let (before, after) = regimes(one);
        let (mut before_other, mut after_other) = regimes(other);
        if reversed {
            std::mem::swap(&mut before_other, &mut after_other);
        }
        assert_eq!((before, after), (before_other, after_other));
    }
    worst
}

/// From a point of a branch back, to the edge of the range.
pub fn back(from: &Found, case: &Case) -> Run {
    let settings = Limits {
        range: case.range,
        stop_at: Vec::new(),
        steps: STEPS,
    };
    let up = !case.up;
    let follower = Follower::new(from.orbit.as_ref().clone(), &from.node.point, up, settings)
        .expect("a regular start");
    let run = to_the_end(follower, None);
    assert_eq!(run.end, Some(End::Edge));
    run
}

/// Mode 10 with a Coulomb impact: the stick zone between an arrested landing and its release vanishes, and
/// slip begins at the landing.
fn stick_after_an_arrest_vanishes() -> Case {
    let mismatch = 0.027272575135998733;
    let model = tube(
        0.3319942798678392,
        1.6239117116239252,
        0.224278766669479,
        mismatch,
    );
    Case {
        model: Model {
            impact: Impact::Coulomb,
            ..model
        },
        mode: 10,
        range: (0.02, mismatch),
        ..fast_in_mismatch()
    }
}

/// Mode 10, damped: between reverse slip and slip a stick zone opens.
fn stick_opens_at_a_reversal() -> Case {
    let geometry = Geometry {
        nu: 0.0,
        xi: 1.8731904965408703,
        gamma: 2.5021742637739085e-5,
    };
    let mismatch = 0.0017759901352672987;
    Case {
        model: Model {
            damping: Damping {
                mass: 0.04743039130394452,
                stiffness: 0.0,
            },
            ..Model::tube(geometry, 0.011008802452546977, mismatch)
        },
        mode: 10,
        range: (0.000785297127128887, mismatch),
        ..fast_in_mismatch()
    }
}

#[test]
fn there_and_back() {
    for (name, case) in [
        ("fast", fast_in_mismatch()),
        ("friction", fast_in_friction()),
        ("with the shaft", with_the_shaft()),
        ("stick after an arrest", stick_after_an_arrest_vanishes()),
        ("stick at a reversal", stick_opens_at_a_reversal()),
    ] {
        let run = case.follow(&[]);
        assert_eq!(run.end, Some(End::Edge), "{name}");
        let last = run.points.last().expect("points");
        assert_eq!(last.kind(), Some(EP));
        let returned = back(last, &case);
        let mut events = returned.events();
        events.reverse();
        let worst = same(&run.events(), &events, true);
        observed(&format!("{name}: there and back"), worst);
        // and the first wave is met again
        let (first, again) = (&run.points[0], returned.points.last().expect("points"));
        assert_eq!(first.orbit.signature, again.orbit.signature);
        let distance = (&first.node.point - &again.node.point).amax();
        observed(&format!("{name}: first wave met again"), distance);
        assert!(distance < 1e-12, "{name}: {distance:e}");
    }
}

/// Round two folds and back round them, from just before the second separation zone opens.
#[test]
fn there_and_back_round_folds() {
    let case = slow_in_mismatch();
    let run = case.follow(&[]);
    let turn = run.points.len() - 2;
    assert_eq!(run.points[turn].kind(), None);
    let returned = back(&run.points[turn], &case);
    let mut events = returned.events();
    events.reverse();
    let there = run.events();
    assert_eq!(there.len(), 6);
    let worst = same(&there[..5], &events, true);
    observed("slow: there and back", worst);
}

fn steps(factor: f64) -> Steps {
    Steps {
        ds: STEPS.ds * factor,
        ds_max: STEPS.ds_max * factor,
        ..STEPS
    }
}

/// Events of a branch with steps of several lengths are those with the default ones.
fn check_steps(name: &str, case: &Case, factors: &[f64]) {
    let run = case.follow(&[]);
    for &factor in factors {
        let other = case.follow_with(steps(factor), &[]);
        assert_eq!(other.points.len() > run.points.len(), factor < 1.0);
        let worst = same(&other.events(), &run.events(), false);
        observed(
            &format!(
                "{name}: steps times {factor}, {} points for {}",
                other.points.len(),
                run.points.len()
            ),
            worst,
        );
    }
}

#[test]
fn steps_do_not_matter() {
    check_steps("fast", &fast_in_mismatch(), &[0.5, 2.0, 5.0, 10.0]);
    check_steps("slow", &slow_in_mismatch(), &[0.5, 2.0, 5.0, 10.0]);
    check_steps("friction", &fast_in_friction(), &[0.5, 2.0, 5.0, 10.0]);
    check_steps("with the shaft", &with_the_shaft(), &[0.5, 2.0]);
}

/// Where the second separation zone has closed, at δ = 0.0029106079, the branch turns up in δ and
/// folds at δ = 0.0029112625, 0.012 of scaled arclength further on.
#[test]
fn a_fold_next_to_a_change_is_found_with_coarse_steps() {
    check_steps("with the shaft", &with_the_shaft(), &[5.0, 10.0]);
}

/// User points are met once each, in order along the branch, however they are listed; a hundred thousand
/// that the branch does not come to change nothing.
#[test]
fn user_points_are_met_once() {
    let case = Case {
        range: (0.15, 0.25),
        ..fast_in_mismatch()
    };
    let met = |stop_at: &[f64]| -> Vec<f64> {
        let run = case.follow(stop_at);
        run.points
            .iter()
            .filter(|point| point.kind() == Some(UZ))
            .map(|point| point.parameter)
            .collect()
    };
    let mut list = vec![0.16, 0.19, 0.17, 0.19, 0.16];
    assert_eq!(met(&list), [0.19, 0.17, 0.16]);
    list.extend((0..100_000).map(|index| 0.21 + 1e-7 * f64::from(index)));
    assert_eq!(met(&list), [0.19, 0.17, 0.16]);
}
