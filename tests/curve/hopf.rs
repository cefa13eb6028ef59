//! A curve of Hopf points against those that the tracker of eigenvalues locates on branches.

use brakewave::branch::EventType;
use brakewave::branch::run::WaveRunner;
use brakewave::orbit::legs::Run as _;

use crate::curve::{observed, tube, unnamed};

#[test]
fn a_pair_of_sector_0_on_its_axis() {
    let problem = tube(
        0.5,
        0.072,
        0.0,
        "continuation: (parameter: Mismatch, range: (0.06, 0.2), toward: Down), curve: (event: HB, \
         sector: 0, parameters: (Mismatch, Friction), range: ((0.01, 0.3), (0.1, 1.2)))",
    );
    let curve = unnamed(&problem);
    assert_eq!(curve.sector, Some(0));
    let first = &curve.points[curve.start];
    assert!((first.parameters[0] - 0.071_075_493_844_074).abs() < 1e-11);
    assert!((first.angular.unwrap() - 2.574_979_462_664).abs() < 1e-9);
    let residual = curve
        .points
        .iter()
        .map(|point| point.residual)
        .fold(0.0, f64::max);
    observed("residual along the Hopf curve", residual);
    assert!(residual < 1e-11);
    assert!(!curve.failed);
    println!("{:?}", curve.ends);
    assert!(
        [0, 1]
            .into_iter()
            .any(|side| curve.end(side) == "edge of the range, friction = 0.1"),
        "{:?}",
        curve.ends
    );

    // at some points of the curve a branch in the mismatch finds the same crossing
    let count = curve.points.len();
    for index in [count / 6, count / 2, 5 * count / 6] {
        let point = &curve.points[index];
        let [mismatch, friction] = point.parameters;
        let across = tube(
            friction,
            1.002 * mismatch,
            0.0,
            &format!(
                "continuation: (parameter: Mismatch, range: ({}, 1.0), toward: Down), \
                 stability: (sectors: Only([0]))",
                0.998 * mismatch
            ),
        );
        let continuation = across.continuation.clone().unwrap();
        let mut branch = WaveRunner::begin(&across, &continuation, None).unwrap();
        let mut best = f64::INFINITY;
        while branch.progress().end.is_none() {
            for event in branch.step().into_iter().filter_map(|item| item.event) {
                if event.kind == EventType::HB {
                    let off = (event.model.mismatch / mismatch - 1.0).abs();
                    let turn = (event.omega.unwrap() - point.angular.unwrap()).abs();
                    best = best.min(off.max(turn));
                }
            }
        }
        observed("Hopf point on the curve and on a branch", best);
        assert!(best < 1e-9, "{mismatch} {friction}: {best:e}");
    }
}
