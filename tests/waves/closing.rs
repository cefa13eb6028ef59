//! A branch that comes upon its first point ends there, on that point.
//!
//! No closed branch is known, so a first point is planted ahead: the state of a branch remembers where
//! it began, and nothing else tells a branch that closes from one that goes on.

use brakewave::branch::EventType::EP;
use brakewave::follow::{Follower, Found, Settings, State, Status};

use crate::branches::{STEPS, fast_in_mismatch, to_the_end};

/// Goes on from a state with another first point.
fn with_origin(state: &State, origin: &State, backwards: f64) -> (Vec<Found>, Status) {
    let case = fast_in_mismatch();
    let wave = case.follower(STEPS, &[]).from().0.as_ref().clone();
    let state = State {
        origin: (
            origin.signature.clone(),
            origin.point.clone(),
            origin.tangent.iter().map(|t| backwards * t).collect(),
        ),
        ..state.clone()
    };
    let settings = Settings {
        range: case.range,
        stop_at: Vec::new(),
        continuation: STEPS,
    };
    let run = to_the_end(
        Follower::resume(&wave, state, settings).expect("the state fits"),
        None,
    );
    (run.points, run.status)
}

#[test]
fn a_branch_ends_on_its_first_point() {
    let mut follower = fast_in_mismatch().follower(STEPS, &[]);
    let mut states = vec![follower.state()];
    for _ in 0..60 {
        assert_eq!(follower.step().1, Status::Going);
        states.push(follower.state());
    }
    // within the first signature, and beyond a change of regime
    for (from, origin) in [(5, 9), (5, 55)] {
        let (from, origin) = (&states[from], &states[origin]);
        let (points, status) = with_origin(from, origin, 1.0);
        assert_eq!(status, Status::Finished);
        let end = points.last().expect("points");
        assert_eq!(end.kind, Some(EP));
        assert_eq!(end.what, "the branch closes on its first point");
        assert_eq!(end.node.point.as_slice(), origin.point);
        assert!(
            points
                .iter()
                .rev()
                .skip(1)
                .all(|found| found.kind != Some(EP))
        );
        // a branch that passes the point the other way is another one
        let (points, _) = with_origin(from, origin, -1.0);
        let end = points.last().expect("points");
        assert!(end.what.starts_with("edge of the range"), "{}", end.what);
    }
    // a first point behind is not met again
    let (points, _) = with_origin(&states[9], &states[5], 1.0);
    let end = points.last().expect("points");
    assert!(end.what.starts_with("edge of the range"), "{}", end.what);
}
