//! Bounds of friction that are no constants, and negative somewhere.

use std::f64::consts::PI;

use brakewave::affine::motion::{Halt, Motion};
use brakewave::affine::orbit::OrbitTermination;
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::continuation::walk::End;
use brakewave::orbit::follow::{Follower, Limits};
use brakewave::orbit::special::BranchTermination;

use crate::affine::systems::{at, place, system};

/// A block on a fast belt, which never sticks. The bound is least at half of the period: F − G.
const BELT: &str = r#"(
    states: ["x", "v"],
    parameters: {"F": 0.5, "G": 0.3, "vb": 9.0, "w": 1.3},
    forcing: "w",
    contacts: {"q": Friction(slip: "v - vb", bound: "F + G*cos(phase)")},
    rates: {"x": "v", "v": "cos(phase) - x - 0.2*v + q"},
)"#;

#[test]
fn a_motion_ends_where_its_bound_is_negative() {
    let system = system(BELT);
    for (force, negative) in [(0.4, false), (0.3, false), (0.2, true)] {
        let at = at(&system, &[("F", force)]);
        let begun = place(&system, "backward", &[0.0, 0.0], 0.0);
        let mut motion = Motion::new(&at, begun, 1.0);
        match (motion.step(20.0), negative) {
            (Ok(_), false) => {}
            (Err(Halt::NegativeBound { time, value, .. }), true) => {
                // least over a piece of the motion, of which the first that has negative values may not have the least one
                assert!(
                    (force + 0.3 * (1.3 * time).cos() - value).abs() < 1e-9,
                    "{value} at {time}"
                );
                assert!(time <= PI / 1.3 + 1e-6 && value < 0.0, "{value} at {time}");
            }
            (other, _) => panic!("{other:?} at F = {force}"),
        }
    }
}

#[test]
fn a_branch_ends_where_its_bound_is_negative() {
    let range = (0.1, 0.6);
    let wanted = Wanted::new(system(BELT), "F", range).unwrap();
    let beginning = Beginning {
        mode: wanted.system.mode("backward").unwrap(),
        state: vec![0.0, 0.0],
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &beginning, Search::Settles(100.0)).unwrap();
    assert_eq!(orbit.negative_bound(&point), None);
    let mut follower = Follower::new(orbit, &point, false, Limits::within(range)).unwrap();
    let mut before = 0.5;
    loop {
        let (found, end) = follower.step();
        let last = found.last().unwrap();
        let Some(end) = end else {
            before = last.parameter;
            assert!(before > 0.3 - 1e-9, "{before} is passed");
            continue;
        };
        let End::Own(BranchTermination::Own(OrbitTermination::NegativeBound {
            mode,
            guard,
            value,
            ..
        })) = end
        else {
            panic!("{end:?}");
        };
        assert_eq!(
            (mode.as_str(), guard.as_str()),
            ("backward", "the slip of `q`")
        );
        assert!(
            before > 0.3 && last.parameter < 0.3,
            "{before} and {}",
            last.parameter
        );
        assert!(
            (value - (last.parameter - 0.3)).abs() < 1e-9,
            "{value} at {}",
            last.parameter
        );
        break;
    }
}
