//! Two events at once lie on the curves of both.

use brakewave::curve::{CurvePoint, WholeCurve};

use crate::curve::{observed, start, tube, unnamed};

fn along(event: &str, friction: f64) -> WholeCurve {
    unnamed(&tube(
        friction,
        0.3,
        0.0,
        &format!(
            "continuation: (parameter: Mismatch, range: (0.02, 0.3), toward: Down), curve: (event: \
             {event}, parameters: (Mismatch, Friction), range: ((0.01, 0.6), (0.1, 1.2)))"
        ),
    ))
}

fn named<'a>(curve: &'a WholeCurve, kind: &str) -> &'a CurvePoint {
    let found = curve
        .points
        .iter()
        .find(|point| point.kind.is_some_and(|one| one.to_string() == kind));
    found.unwrap_or_else(|| panic!("{kind} on {:?}", curve.ends))
}

/// Where pressure and force both vanish three curves meet: take-off of slip-stick waves, of those
/// with reverse slip, and the opening of reverse slip.
#[test]
fn take_off_and_reverse_slip() {
    let points = [
        named(&along("RV", 0.5), "RV+GR").clone(),
        named(&along("GR", 1.08), "GR+RV").clone(),
        named(&along("GR", 0.5), "GR+RV").clone(),
    ];
    let mut worst = 0.0_f64;
    for point in &points[1..] {
        for (one, other) in point.parameters.iter().zip(points[0].parameters) {
            worst = worst.max((one / other - 1.0).abs());
        }
        worst = worst.max((point.measure / points[0].measure - 1.0).abs());
    }
    observed("the point where three curves meet", worst);
    assert!(worst < 1e-10);
}

/// An event that is not there, or lies outside the ranges, is said to.
#[test]
fn curves_without_a_beginning() {
    let range = "continuation: (parameter: Mismatch, range: (0.2, 0.3), toward: Down)";
    let ask = |curve: &str| {
        let problem = tube(0.5, 0.3, 0.0, &format!("{range}, curve: ({curve})"));
        start(&problem).unwrap_err().to_string()
    };
    let none = ask("event: GR, parameters: (Mismatch, Friction), range: ((0.01, 0.6), (0.1, 1.2))");
    assert!(none.contains("has 0 events"), "{none}");
    let range = "continuation: (parameter: Mismatch, range: (0.02, 0.3), toward: Down)";
    let curve = "event: RV, parameters: (Mismatch, Friction), range: ((0.2, 0.6), (0.1, 1.2))";
    let outside = start(&tube(0.5, 0.3, 0.0, &format!("{range}, curve: ({curve})")));
    let outside = outside.unwrap_err().to_string();
    assert!(
        outside.contains("mismatch = 0.0968") && outside.contains("widen"),
        "{outside}"
    );
}
