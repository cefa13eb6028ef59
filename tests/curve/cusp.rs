//! A cusp of folds: waves counted on branches on either side of it.

use brakewave::branch::EventType;
use brakewave::branch::run::WaveRunner;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::parse;

use crate::curve::{observed, unnamed};

/// Folds in f of the slip-stick branch of mode 2 at this β.
fn folds(beta: f64) -> Vec<f64> {
    let text = format!(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 2.0, \
         mismatch: 2.0, damping: (stiffness: {beta:?})), wave: (mode: 2, start: Fast), \
         continuation: (parameter: Friction, range: (2.0, 3.2), toward: Up))"
    );
    let problem = parse(&text, "folds").unwrap();
    let continuation = problem.continuation(&text, "folds").unwrap();
    let mut branch = WaveRunner::begin(&problem, continuation, None).unwrap();
    let mut found = Vec::new();
    while branch.progress().end.is_none() {
        for item in branch.step() {
            if item.point.kind == Some(EventType::LP) {
                found.push(item.point.model.friction);
            }
        }
    }
    found
}

#[test]
fn two_folds_meet() {
    let text = "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
                mismatch: 2.0), wave: (mode: 2, start: Fast), \
                continuation: (parameter: Friction, range: (0.3, 3.0), toward: Up), \
                curve: (event: LP, parameters: (Friction, StiffnessDamping), \
                range: ((2.1, 3.0), (0.0, 0.02)), ds_max: 0.05))";
    let curve = unnamed(&parse(text, "cusp").unwrap());
    let cusps: Vec<_> = curve
        .points
        .iter()
        .filter(|point| point.kind.is_some_and(|one| one.to_string() == "CP"))
        .collect();
    assert_eq!(cusps.len(), 1);
    let [friction, beta] = cusps[0].parameters;
    assert!((friction - 2.747_409_013).abs() < 1e-8 && (beta - 0.014_405_262_5).abs() < 1e-9);
    // two folds below, none above
    assert!(folds(1.003 * beta).is_empty());
    let widths = [0.99, 0.9975].map(|share| {
        let found = folds(share * beta);
        assert_eq!(found.len(), 2, "{found:?}");
        found[0] - found[1]
    });
    // the wedge closes like the power 3/2 of the distance: 4 times the distance, 8 times the width
    let power = (widths[0] / widths[1]).log2() / 2.0;
    observed("power of the cusp", power);
    // corrections are of the order of the distance, half of 1e-2
    assert!((power - 1.5).abs() < 0.02, "{power}");
    // and both sides of the curve are those folds
    for found in folds(0.99 * beta) {
        let near = curve
            .points
            .windows(2)
            .map(|pair| {
                let [b0, b1] = [pair[0].parameters[1], pair[1].parameters[1]];
                let share = (0.99 * beta - b0) / (b1 - b0);
                if !(0.0..=1.0).contains(&share) {
                    return f64::INFINITY;
                }
                let [f0, f1] = [pair[0].parameters[0], pair[1].parameters[0]];
                (f0 + share * (f1 - f0) - found).abs()
            })
            .fold(f64::INFINITY, f64::min);
        // linear interpolation between points 1e-3 apart
        assert!(near < 1e-6, "{near:e}");
    }
}
