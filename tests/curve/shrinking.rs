//! Curves of events of cycles that end where the cycles shrink to a point.

use brakewave::EventType;
use brakewave::curve::{CurvePoint, OrbitsInPlane, PointType, WholeCurve};
use brakewave::problem::{Any, parse_any};

use crate::curve::systems::curve;

/// A cycle r = √μ that comes to touch x = g.
const GRAZING: &str = r#"(
    system: (states: ["x", "y"], parameters: {"mu": 0.1, "g": 0.4}, define: {"q": "mu - x^2 - y^2"}, modes: {
        "free": (rates: {"x": "x*q - y", "y": "y*q + x"}, until: [(zero: "g - x", to: "free", reset: {"x": "g - 0.1*y"})]),
    }),
    orbit: (start: Simulate(mode: "free", state: {"x": 0.3, "y": 0.0}, settle: 300)),
    continuation: (parameter: "mu", range: (0.01, 0.5), toward: Up),
    curve: (event: GR, parameters: ("mu", "g"), range: ((-0.2, 0.2), (-0.5, 0.5))),
)"#;

/// Cycles μ + br² − r⁴ = 0, which meet at r² = b/2.
const FOLDING: &str = r#"(
    system: (states: ["x", "y"], parameters: {"mu": -0.1, "b": 1.0}, define: {"r": "x^2 + y^2", "q": "mu + b*r - r^2"}, modes: {
        "free": (rates: {"x": "x*q - y", "y": "y*q + x"}),
    }),
    orbit: (start: Simulate(mode: "free", state: {"x": 0.9, "y": 0.0}, settle: 100)),
    continuation: (parameter: "mu", range: (-0.5, 0.1), toward: Down),
    curve: (event: LP, parameters: ("mu", "b"), range: ((-0.3, 0.5), (-1.0, 2.0))),
)"#;

/// The same cycles in y = v + x²/4, which turn the faster the larger they are.
const SHEARED: &str = r#"(
    system: (states: ["x", "y"], parameters: {"mu": -0.1, "b": 1.0}, define: {
        "v": "y - 0.25*x^2", "r": "x^2 + v^2", "q": "mu + b*r - r^2", "o": "1 + 0.25*r", "f": "x*q - o*v"}, modes: {
        "free": (rates: {"x": "f", "y": "v*q + o*x + 0.5*x*f"}),
    }),
    orbit: (start: Simulate(mode: "free", state: {"x": 0.9, "y": 0.2}, settle: 100)),
    continuation: (parameter: "mu", range: (-0.5, 0.1), toward: Down),
    curve: (event: LP, parameters: ("mu", "b"), range: ((-0.3, 0.5), (-1.0, 2.0))),
)"#;

/// The same cycles, whose growth a third state carries, which follows their size.
const SLAVED: &str = r#"(
    system: (states: ["x", "y", "z"], parameters: {"mu": -0.1, "b": 1.0}, define: {
        "r": "x^2 + y^2", "w": "z - 0.2*x*y", "q": "mu + 0.5*r - r^2 + w", "f": "x*q - y", "g": "y*q + x"}, modes: {
        "free": (rates: {"x": "f", "y": "g", "z": "-w + (b - 0.5)*r + 0.2*(f*y + x*g)"}),
    }),
    orbit: (start: Simulate(mode: "free", state: {"x": 0.9, "y": 0.0, "z": 0.4}, settle: 100)),
    continuation: (parameter: "mu", range: (-0.5, 0.1), toward: Down),
    curve: (event: LP, parameters: ("mu", "b"), range: ((-0.3, 0.5), (-1.0, 1.2))),
)"#;

/// Two oscillators, of which the first moves at r = √m and the second begins to where n = 1.5m.
const BESIDE: &str = r#"(
    system: (states: ["x", "y", "u", "v"], parameters: {"n": 0.72, "m": 0.5}, define: {
        "r": "x^2 + y^2", "s": "u^2 + v^2", "q": "m - r - 0.5*s", "w": "n - 1.5*r - s"}, modes: {
        "free": (rates: {"x": "x*q - y", "y": "y*q + x", "u": "u*w - 1.7*v", "v": "v*w + 1.7*u"}),
    }),
    orbit: (start: Given(mode: "free", state: {"x": 0.70710678, "y": 0.0, "u": 0.0, "v": 0.0}, period: 6.28)),
    continuation: (parameter: "n", range: (0.7, 1.0), toward: Up),
    curve: (event: NS, parameters: ("n", "m"), range: ((-0.5, 0.95), (-0.5, 1.0))),
)"#;

/// The curve of a problem, all points of which solve an equation to the tolerance of curves, and whose only points of
/// codimension two are of this type at the origin.
fn ends_at_the_origin(
    text: &str,
    equation: impl Fn(&CurvePoint) -> f64,
    kind: PointType,
    most: f64,
) {
    let Ok(Any::System(problem)) = parse_any(text, "test") else {
        panic!("a system");
    };
    let found: WholeCurve<OrbitsInPlane> = curve(&problem);
    assert!(!found.failed, "{} | {}", found.end(0), found.end(1));
    let mut ends = 0;
    for point in &found.points {
        let off = equation(point).abs();
        assert!(off <= most, "{:?}: {off:e}", point.parameters);
        match point.kind {
            Some(
                PointType::One(EventType::EP | EventType::GR | EventType::LP | EventType::NS)
                | PointType::Resonance(1),
            )
            | None => (),
            other => {
                assert_eq!(other, Some(kind));
                assert!(point.parameters.iter().all(|value| value.abs() <= most));
                assert!((point.measure - std::f64::consts::TAU).abs() <= most);
                ends += 1;
            }
        }
    }
    assert_eq!(ends, 1);
}

/// μ = g².
#[test]
fn a_graze_ends_where_a_hopf_point_is_on_the_guard() {
    let kind = PointType::Two(EventType::HB, EventType::BE);
    let equation = |point: &CurvePoint| point.parameters[0] - point.parameters[1].powi(2);
    ends_at_the_origin(GRAZING, equation, kind, 1e-12);
}

/// μ = −b²/4. Of a fold beside the origin b is known to rounding divided by the cube of its size, 1e-15 / 6e-3³.
#[test]
fn a_fold_ends_at_a_degenerate_hopf_point() {
    let equation = |point: &CurvePoint| point.parameters[0] + 0.25 * point.parameters[1].powi(2);
    for text in [FOLDING, SHEARED, SLAVED] {
        ends_at_the_origin(text, equation, PointType::GH, 5e-9);
    }
}

/// On the way the second oscillator is at rest but for numbers as small as there are, which have no digits for its multipliers.
#[test]
fn a_torus_ends_where_its_cycle_does() {
    let equation = |point: &CurvePoint| point.parameters[0] - 1.5 * point.parameters[1];
    let kind = PointType::Two(EventType::NS, EventType::HB);
    ends_at_the_origin(BESIDE, equation, kind, 1e-11);
}
