//! What happens to the multipliers along a curve of grazes of an impact, where one of them is infinite.

use brakewave::EventType::{BP, GR, LP, PD};
use brakewave::curve::{OrbitsInPlane, PointType, WholeCurve};

use crate::curve::systems::whole;

/// An oscillator that bounces from a stop, with its states in an order, in a unit of length and from an origin of its own.
fn oscillator(
    order: &str,
    unit: f64,
    shift: f64,
    start: &str,
    walls: &[f64],
    range: &str,
) -> String {
    let wall = |side: &f64| {
        let reset = r#"to: "free", reset: {"v": "-0.8*v"}"#;
        format!(r#"(zero: "{unit} - {side}*(x - s)", {reset})"#)
    };
    let walls: Vec<String> = walls.iter().map(wall).collect();
    format!(
        r#"(system: (states: [{order}], parameters: {{"A": {start}, "w": 0.8, "s": {shift}}}, forcing: "w",
        modes: {{"free": (rates: {{"x": "v", "v": "{unit}*A*cos(phase) - 0.1*v - x + s"}}, until: [{}])}}),
        orbit: (start: Simulate(mode: "free", state: {{"x": {shift}, "v": 0.0}}, settle: 200)),
        continuation: (parameter: "A", range: (0.2, 1.5), toward: Down),
        curve: (event: GR, parameters: ("A", "w"), range: {range}))"#,
        walls.join(", ")
    )
}

/// The second parameter at all points of codimension two, sorted, with their types.
fn double(found: &WholeCurve<OrbitsInPlane>) -> Vec<(f64, PointType)> {
    let points = found.points.iter();
    let two = points.filter_map(|point| match point.kind {
        Some(kind @ PointType::Two(..)) => Some((point.parameters[1], kind)),
        _ => None,
    });
    let mut two: Vec<_> = two.collect();
    two.sort_by(|one, other| one.0.total_cmp(&other.0));
    two
}

/// With M = E(R + σugᵀ), σ → ∞ at the graze and E the flow of a period, gᵀ adj(E ∓ 1)Eu is a multiple of sin ΩT, Ω² = 1 − c²/4: a fold and a doubling are at
/// w = 2Ω/n together, and of an orbit between two stops a fold and the loss of its symmetry at w = Ω/n.
#[test]
fn folds_and_doublings_at_the_graze_of_an_oscillator() {
    let free = (1.0_f64 - 0.0025).sqrt();
    let variants = [(r#""x", "v""#, 1.0, 0.0), (r#""v", "x""#, 1e-3, 1.7)];
    for (order, unit, shift) in variants {
        let range = "((0.01, 2.0), (0.45, 0.85))";
        let one = oscillator(order, unit, shift, "0.8", &[1.0], range);
        let met = double(&whole(&one));

        let expected = (3..=4).rev().map(|n| 2.0 * free / f64::from(n));
        let expected: Vec<f64> = expected.flat_map(|w| [w, w]).collect();
        assert_eq!(met.len(), expected.len(), "{order} {unit} {shift}: {met:?}");
        for (pair, w) in met.chunks(2).zip(expected.chunks(2)) {
            assert!(
                pair.iter().all(|(at, _)| (at / w[0] - 1.0).abs() < 1e-10),
                "{pair:?} {w:?}"
            );
            let kinds = [PointType::Two(GR, LP), PointType::Two(GR, PD)];
            assert!(
                kinds
                    .iter()
                    .all(|kind| pair.iter().any(|(_, at)| at == kind)),
                "{pair:?}"
            );
        }
    }
    for (order, unit, _) in variants {
        let both = oscillator(
            order,
            unit,
            0.0,
            "1.0",
            &[1.0, -1.0],
            "((0.01, 2.0), (0.75, 1.1))",
        );
        let met = double(&whole(&both));
        assert_eq!(met.len(), 2, "{order} {unit}: {met:?}");
        for (pair, n) in met.chunks(2).zip([1.0]) {
            assert!(
                pair.iter()
                    .all(|(at, _)| (at * n / free - 1.0).abs() < 1e-10),
                "{pair:?}"
            );
            let kinds = [PointType::Two(GR, LP), PointType::Two(GR, BP)];
            assert!(
                kinds
                    .iter()
                    .all(|kind| pair.iter().any(|(_, at)| at == kind)),
                "{pair:?}"
            );
        }
    }
}

/// Two masses that hit one another, the graze of which has a multiplier −1 at one place: det(M + 1) of the limit in 60 digits.
#[test]
fn one_doubling_at_the_graze_of_two_masses() {
    let masses = |order: &str, unit: f64, shift: f64| {
        format!(
            r#"(system: (states: [{order}], parameters: {{"A": 1.2, "w": 1.3, "s": {shift}}}, forcing: "w", modes: {{"f": (
            rates: {{"x": "v", "v": "{unit}*A*cos(phase) - .1*v - x + s", "y": "u", "u": "-.1*u - 0.5*y"}},
            until: [(zero: "{unit}*1.5 + y - x + s", to: "f", reset: {{"v": "0.2*v + 0.8*u", "u": "0.8*v + 0.2*u"}})])}}),
            orbit: (start: Simulate(mode: "f", state: {{"x": {shift}, "v": 0.0, "y": 0.0, "u": 0.0}}, settle: 200)),
            continuation: (parameter: "A", range: (0.2, 3.0), toward: Both),
            curve: (event: GR, parameters: ("A", "w"), range: ((1.0, 1.7), (1.25, 1.5))))"#
        )
    };
    let variants = [
        (r#""x", "v", "y", "u""#, 1.0, 0.0),
        (r#""u", "y", "v", "x""#, 1e-3, 1.7),
    ];
    for (order, unit, shift) in variants {
        let met = double(&whole(&masses(order, unit, shift)));
        assert_eq!(met.len(), 1, "{order} {unit} {shift}: {met:?}");
        assert_eq!(met[0].1, PointType::Two(GR, PD));
        assert!((met[0].0 - 1.421_017_492_169).abs() < 1e-9, "{met:?}");
    }
}
