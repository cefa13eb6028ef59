//! A branch that comes upon its first point ends there, on that point.
//!
//! No closed branch is known, so a first point is planted ahead: the state of a branch remembers where
//! it began, and nothing else tells a branch that closes from one that goes on.

use brakewave::branch::EventType::EP;
use brakewave::branch::orbit::{Follower, Found, State};
use brakewave::branch::special::{Ending, Special};
use brakewave::continuation::walk::End;
use brakewave::orbit::follow::Limits;

use crate::waves::branches::{STEPS, fast_in_mismatch, to_the_end};

/// Goes on from a state with another first point.
fn with_origin(state: &State, origin: &State, backwards: f64) -> (Vec<Found>, Option<Ending>) {
    let case = fast_in_mismatch();
    let wave = case.follower(STEPS, &[]).curve().orbit.as_ref().clone();
    let state = State {
        origin: (
            origin.signature.clone(),
            origin.point.clone(),
            origin.tangent.iter().map(|t| backwards * t).collect(),
        ),
        ..state.clone()
    };
    let settings = Limits {
        range: case.range,
        stop_at: Vec::new(),
        steps: STEPS,
    };
    let run = to_the_end(
        Follower::resume(&wave, state, settings).expect("the state fits"),
        None,
    );
    (run.points, run.end)
}

#[test]
fn a_branch_ends_on_its_first_point() {
    let mut follower = fast_in_mismatch().follower(STEPS, &[]);
    let mut states = vec![follower.state()];
    for _ in 0..60 {
        assert_eq!(follower.step().1, None);
        states.push(follower.state());
    }
    // within the first signature, and beyond a change of regime
    for (from, origin) in [(5, 9), (5, 55)] {
        let (from, origin) = (&states[from], &states[origin]);
        let (points, ended) = with_origin(from, origin, 1.0);
        assert_eq!(ended, Some(End::Closed));
        let end = points.last().expect("points");
        assert_eq!(end.kind(), Some(EP));
        assert_eq!(end.special, Some(Special::Closed));
        assert_eq!(end.node.point.as_slice(), origin.point);
        assert!(
            points
                .iter()
                .rev()
                .skip(1)
                .all(|found| found.kind() != Some(EP))
        );
        // a branch that passes the point the other way is another one
        let (points, _) = with_origin(from, origin, -1.0);
        let end = points.last().expect("points");
        assert!(
            matches!(end.special, Some(Special::Edge(..))),
            "{:?}",
            end.special
        );
    }
    // a first point behind is not met again
    let (points, _) = with_origin(&states[9], &states[5], 1.0);
    let end = points.last().expect("points");
    assert!(
        matches!(end.special, Some(Special::Edge(..))),
        "{:?}",
        end.special
    );
}
