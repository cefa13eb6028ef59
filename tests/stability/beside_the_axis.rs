//! A crossing is found wherever the branch begins, also right beside it.

use brakewave::branch::EventType;
use brakewave::problem;

use crate::stability::observed;
use crate::stability::waves::follow;

/// HB of sector 0 on the mode-4 branch, by an independent program; and dRe λ/dδ > 0 there.
const HB: f64 = 0.07107549384407419;
const OMEGA: f64 = 2.57497946266399;

/// The HB of a branch from `start` down to 0.9 `start`, all in units of s.
fn found(start: f64, s: f64, continuation: &str) -> Vec<(f64, f64)> {
    let text = format!(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: {:?}), friction: 0.5, \
         mismatch: {:?}), wave: (mode: 4, start: Fast), \
         continuation: (parameter: Mismatch, range: ({:?}, {:?}), toward: Down {continuation}), \
         stability: (sectors: Only([0]), eigenvalues: 4, max_frequency: {:?}))",
        s * s,
        start * s,
        0.95 * start * s,
        start * s,
        8.0 / s,
    );
    let problem = problem::parse(&text, "beside an HB").expect("a problem");
    let rows = follow(&problem, &text);
    assert!(rows.notes.is_empty(), "{:?}", rows.notes);
    let events = rows.items.iter().filter_map(|item| item.event.as_ref());
    events
        .filter(|event| event.kind == EventType::HB)
        .map(|event| {
            let omega = event.omega.expect("a pair");
            (event.model.mismatch / s, omega * s)
        })
        .collect()
}

/// Re λ at the start is about the distance times 1.5: from 1e-3 down to what rounding leaves of it.
#[test]
fn a_branch_that_begins_beside_a_crossing_finds_it() {
    let mut worst = 0.0_f64;
    for distance in [1e-3, 1e-5, 1.2e-8, 1e-9, 1e-11] {
        for s in [1e-4, 1.0, 1e3] {
            let events = found(HB + distance, s, "");
            let [(mismatch, omega)] = events[..] else {
                panic!("from {distance:e} above, s = {s}: {events:?}");
            };
            let error = (mismatch - HB).abs().max((omega - OMEGA).abs());
            worst = worst.max(error);
            assert!(error < 1e-11, "from {distance:e} above, s = {s}: {error:e}");
            // and from below there is none
            assert!(
                found(HB - distance, s, "").is_empty(),
                "{distance:e}, s = {s}"
            );
        }
    }
    observed("an HB in the first step", worst);
}

/// The wave at a crossing is solved to the tolerance of the problem: fewer iterations for a loose one,
/// more for a tight one, and the same place.
#[test]
fn a_crossing_is_located_to_the_tolerance_of_the_problem() {
    let mut worst = 0.0_f64;
    for tolerance in ["1e-4", "1e-7", "1e-10", "1e-13"] {
        let events = found(HB + 1e-3, 1.0, &format!(", tolerance: {tolerance}"));
        let [(mismatch, omega)] = events[..] else {
            panic!("tolerance {tolerance}: {events:?}");
        };
        // the last correction is below the tolerance, and the error is of the order of its square
        let bound: f64 = tolerance
            .parse::<f64>()
            .expect("a number")
            .powi(2)
            .max(1e-11);
        let error = (mismatch - HB).abs().max((omega - OMEGA).abs());
        worst = worst.max(error);
        assert!(error < bound, "tolerance {tolerance}: {error:e}");
    }
    observed("an HB under other tolerances", worst);
}
