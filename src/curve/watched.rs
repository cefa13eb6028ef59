//! Test functions of multipliers along a curve of events of orbits: where they vanish it meets another event.

use super::plane::Test;
use super::point::PointType;
use crate::orbit::EventType;

/// Half the sum of a pair that is within this of ±2 is that of two multipliers ±1: the place is known to 1e-12.
const MET: f64 = 1e-6;

/// A test that the curve passes.
pub(super) fn passed(kind: Option<PointType>, value: f64) -> Test {
    Test {
        kind,
        value,
        ends: false,
    }
}

/// The function of a pair with the product 1, with the cosine of its angle and whether it is on the circle: beside a multiplier ±1, of this
/// order of resonance, the pair may be that one and another; two real ones μ and 1/μ are no event.
pub(super) fn test_of_pair(
    (cosine, turns): (f64, bool),
    (order, both): (u8, f64),
    torus: f64,
) -> Test {
    let kind = if (cosine - both).abs() <= MET {
        Some(PointType::Resonance(order))
    } else {
        turns.then_some(PointType::One(EventType::NS))
    };
    passed(kind, torus)
}

/// A test without the zero that it has where a double multiplier meets the event.
pub(super) fn without(test: Test, met: f64) -> Test {
    Test {
        value: test.value / met,
        ..test
    }
}

/// What is watched along a curve of NS with the cosine of its angle, and of that of half a symmetric orbit: the strong
/// resonances, of which 1:1 and 1:2 end it, and a multiplier −1 other than the pair. Of a symmetric orbit a pair −1 is the
/// square of a pair ±i of its half: no two eigenvectors become one there, and the curve goes on.
pub(super) fn tests_of_torus((cosine, half): (f64, Option<f64>), doubling: Test) -> Vec<Test> {
    let met = |order, value| Test {
        ends: true,
        ..passed(Some(PointType::Resonance(order)), value)
    };
    let resonance = |order, value| passed(Some(PointType::Resonance(order)), value);
    vec![
        met(1, 1.0 - cosine),
        half.map_or_else(|| met(2, 1.0 + cosine), |half| resonance(2, half)),
        resonance(3, cosine + 0.5),
        resonance(4, cosine),
        Test {
            value: doubling.value / (2.0 + 2.0 * cosine),
            ..doubling
        },
    ]
}
