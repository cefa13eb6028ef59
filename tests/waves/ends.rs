//! Events beside which the equations of a wave are badly conditioned, or its parameter stands still: what is passed, what ends the branch,
//! and what is no event.

use brakewave::branch::EventType::{CO, GR, LP, ST};
use brakewave::branch::special::{Ending, Stop, WaveTermination};
use brakewave::continuation::walk::End;
use brakewave::tube::model::{Damping, FrictionLaw, Impact, Model, Parameter};

use crate::waves::branches::{Case, fast_in_mismatch, regimes, tube};

/// Why the waves themselves end a branch.
fn own(end: Option<&Ending>) -> &WaveTermination {
    match end {
        Some(End::Own(Stop::Own(own))) => own,
        other => panic!("{other:?}"),
    }
}

/// Where a touch closes, the parameter stands still on both sides of the event and moves on in the direction in which it came: no fold.
#[test]
fn a_touch_closes_without_a_fold() {
    let case = Case {
        model: Model {
            impact: Impact::Coulomb,
            ..tube(0.271, 1.527, 0.329, 0.175)
        },
        parameter: Parameter::Friction,
        mode: 8,
        range: (0.329, 1.5),
        up: true,
        until: Some((LP, 2)),
        ..fast_in_mismatch()
    };
    let run = case.follow(&[]);
    let events = run.events();
    let closes = events
        .iter()
        .rfind(|found| found.kind() == Some(CO) && regimes(found).0.contains("separation-sep"));
    let closes = closes.expect("a touch that closes").parameter;
    let fold = events.last().expect("a fold");
    assert_eq!(fold.kind(), Some(LP));
    assert!(closes - fold.parameter > 1e-3, "{}", fold.parameter);
    let values = run.points.iter().map(|found| found.parameter);
    let beside = values.skip_while(|value| *value != closes);
    let beside: Vec<f64> = beside
        .take_while(|value| *value != fold.parameter)
        .collect();
    assert!(
        beside.len() > 5 && beside.is_sorted_by(|one, other| one >= other),
        "{beside:?}"
    );
}

/// Slip begins beside steady sliding, and what a wave is off grows by e¹⁸ within it: stick vanishes, as from the neighbouring branches in
/// other parameters, and the branch ends where too few digits are left. The margin of V̇ = 1 rises with 75(ν₀ − ν): an independent
/// Newton's method on integrated zones.
#[test]
fn digits_are_lost_beside_steady_sliding() {
    let case = Case {
        model: tube(0.386, 1.674, 1.2, 0.099),
        parameter: Parameter::Nu,
        mode: 3,
        range: (0.386, 0.48),
        up: true,
        ..fast_in_mismatch()
    };
    let run = case.follow(&[]);
    let events = run.events();
    let stick = events.iter().find(|found| found.kind() == Some(ST));
    let stick = stick.expect("stick that vanishes");
    let (before, after) = regimes(stick);
    assert_eq!(before, "slip-separation-slip-stick");
    assert_eq!(after, "slip-separation");
    assert!((stick.parameter - 0.421_838_716_465_4).abs() <= 1e-11);
    assert!(matches!(
        own(run.end.as_ref()),
        WaveTermination::LosesDigits { terms, .. } if (1e7..1e9).contains(terms)
    ));
}

/// With static friction above the kinetic one slip may come to V̇ = 1 with V̈ = 0 while Q = fP is less than what holds: the branch ends
/// there with a stick zone of some length, and has no fold.
#[test]
fn slip_that_hardly_comes_to_stick_ends_a_branch() {
    let case = Case {
        model: Model {
            impact: Impact::Coulomb,
            law: FrictionLaw::Static { ratio: 1.34 },
            damping: Damping {
                mass: 0.0684,
                stiffness: 0.0,
            },
            ..tube(0.437, 2.036, 0.1417, 0.486)
        },
        mode: 6,
        range: (0.002, 0.486),
        ..fast_in_mismatch()
    };
    let run = case.follow(&[]);
    let kinds: Vec<_> = run.events().iter().map(|found| found.kind()).collect();
    assert_eq!(kinds, [Some(GR), Some(ST)]);
    assert_eq!(own(run.end.as_ref()), &WaveTermination::Misses);
    let last = run.points.last().expect("points");
    let stick = last.orbit.zones() - 1;
    let length = last.orbit.duration_at(&last.node.point, stick);
    assert!(length > 0.01, "{length}");
}
