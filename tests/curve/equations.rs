//! The Jacobian of every kind of event against central differences.

use brakewave::continuation::newton::Equations;
use brakewave::curve::start::CurveStart;
use brakewave::curve::system::EventSystem;
use brakewave::linalg::{Matrix, Vector};
use brakewave::problem::parse;

use crate::curve::{observed, start, tube};

fn evaluate(system: &EventSystem, point: &Vector) -> (Vector, Matrix) {
    let n = system.unknowns();
    let mut residual = Vector::zeros(n - 1);
    let mut jacobian = Matrix::zeros(n - 1, n);
    system
        .evaluate(point, residual.as_mut_slice(), &mut jacobian)
        .unwrap();
    (residual, jacobian)
}

fn worst(start: &CurveStart) -> f64 {
    let (residual, jacobian) = evaluate(&start.system, &start.point);
    // the branch locates its events to 1e-10 or better
    assert!(residual.amax() < 1e-8, "{:e}", residual.amax());
    let step = 1e-6;
    let mut worst = 0.0_f64;
    for column in 0..start.point.len() {
        let mut there = start.point.clone();
        there[column] += step;
        let (above, _) = evaluate(&start.system, &there);
        there[column] -= 2.0 * step;
        let (below, _) = evaluate(&start.system, &there);
        for row in 0..residual.len() {
            let slope = (above[row] - below[row]) / (2.0 * step);
            let size = 1.0 + jacobian.row(row).amax();
            worst = worst.max((slope - jacobian[(row, column)]).abs() / size);
        }
    }
    worst
}

#[test]
fn jacobians_are_derivatives_with_material_damping() {
    for (event, along, parameters, ranges) in [
        (
            "ST",
            "(parameter: StiffnessDamping, range: (0, 0.1), toward: Up)",
            "(StiffnessDamping, Friction)",
            "((0.0001, 0.02), (0.1, 1.2))",
        ),
        (
            "RV",
            "(parameter: Mismatch, range: (0.02, 0.3), toward: Down)",
            "(Mismatch, StiffnessDamping)",
            "((0.02, 0.3), (0.0001, 0.02))",
        ),
    ] {
        let beta = if event == "ST" { "0.0001" } else { "0.002" };
        let text = format!(
            "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
             mismatch: 0.2, damping: (stiffness: {beta})), wave: (mode: 4, start: Fast), \
             continuation: {along}, \
             curve: (event: {event}, parameters: {parameters}, range: {ranges}))"
        );
        let worst = worst(&start(&parse(&text, "test").unwrap()).unwrap());
        observed(&format!("Jacobian of {event} with material damping"), worst);
        assert!(worst < 1e-8, "{event}: {worst:e}");
    }
}

#[test]
fn jacobians_are_derivatives() {
    let ranges = "range: ((0.01, 0.6), (0.1, 1.2)))";
    for (event, friction, mismatch, bound) in [
        ("event: GR", 0.5, 0.1, 1e-8),
        ("event: RV", 0.5, 0.1, 1e-8),
        ("event: CO", 0.5, 0.1, 1e-8),
        ("event: HB, sector: 0", 0.5, 0.072, 1e-6),
        ("event: HB, sector: 1", 0.5, 0.0875, 1e-6),
        ("event: LP", 1.0, 0.3, 1e-6),
    ] {
        let fold = event == "event: LP";
        let along = match fold {
            true => "(parameter: Friction, range: (0.9, 1.2), toward: Up)",
            false => "(parameter: Mismatch, range: (0.02, 0.3), toward: Down)",
        };
        let problem = tube(
            friction,
            mismatch,
            0.0,
            &format!(
                "continuation: {along}, curve: ({event}, parameters: (Mismatch, Friction), {ranges}"
            ),
        );
        let start = start(&problem).unwrap();
        let worst = worst(&start);
        observed(&format!("Jacobian of {event}"), worst);
        assert!(worst < bound, "{event}: {worst:e}");
    }
}
