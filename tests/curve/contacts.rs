//! Curves of contacts, and the points at which they end, against closed forms.

use brakewave::curve::{CurvePoint, OrbitsInPlane, WholeCurve};
use brakewave::problem::{Any, parse_any};

use crate::curve::systems;

/// A forced mass with friction, whose orbit is its own image: F = 0.4, c = 0.05.
const FORCED: &str = r#"(
    system: (
        states: ["x", "v"], parameters: {"A": 1.6, "w": 0.45, "F": 0.4, "c": 0.05}, forcing: "w",
        contacts: {"q": Friction(slip: "v", bound: "F")},
        rates: {"x": "v", "v": "A*cos(phase) - x - c*v + q"},
    ),
    orbit: (start: Simulate(mode: "forward", state: {"x": 0.0, "v": 0.1}, settle: 200)),
    continuation: (parameter: "A", range: (0.5, 2.5), toward: Both),
    stability: (),
    curve: (event: GR, index: 1, parameters: ("A", "w"), range: ((0.45, 2.0), (0.2, 1.8))),
)"#;

/// A brake whose pad is pressed by a spring that may open.
const BRAKE: &str = r#"(
    system: (
        states: ["x", "v", "y", "u"],
        parameters: {"k1": 9.0, "k2": 1.2, "kc": -1.8, "kn": 9.0, "N": 1.5, "mu": 0.5, "vb": 0.4, "c": 0.12},
        contacts: {"p": Spring(gap: "y", stiffness: "kn"), "q": Friction(slip: "v - vb", bound: "mu*p")},
        rates: {"x": "v", "v": "-k1*x - kc*y - c*v + q", "y": "u", "u": "-N - k2*y - kc*x - c*u + p"},
    ),
    orbit: (start: Simulate(mode: "closed.backward", state: {"x": 0.2, "v": 0.0, "y": -0.05, "u": 0.0}, settle: 400)),
    continuation: (parameter: "mu", range: (0.2, 0.8), toward: Both),
    stability: (),
    curve: (event: SL, index: 1, parameters: ("mu", "vb"), range: ((0.1, 1.0), (0.05, 0.9))),
)"#;

/// A curve of a text in which some parts are replaced.
fn curve(text: &str, replaced: &[(&str, &str)]) -> WholeCurve<OrbitsInPlane> {
    let mut text = text.to_owned();
    for (from, to) in replaced {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let Any::System(problem) = parse_any(&text, "test").unwrap() else {
        panic!("a system");
    };
    systems::curve(&problem)
}

/// The special points of a curve, the event that it begins with left out.
fn special(curve: &WholeCurve<OrbitsInPlane>) -> Vec<(String, [f64; 2])> {
    let named = |point: &CurvePoint| Some((point.kind?.to_string(), point.parameters));
    let all = curve.points.iter().filter_map(named);
    all.filter(|(kind, _)| kind.contains('+') || kind == "EP" || kind == "MX")
        .collect()
}

/// Where a mass turns with no acceleration and no change of it stick has no length, and slip the other way before it has none: with
/// v = v' = v'' = 0 at the instant, half a period apart from its image, in 30 digits.
const TURNS: [f64; 2] = [1.381_025_057_126_226_8, 0.488_733_051_141_105_8];

fn ends_there(found: &(String, [f64; 2]), kind: &str) {
    assert_eq!(found.0, kind, "{found:?}");
    for (value, expected) in found.1.iter().zip(TURNS) {
        assert!((value - expected).abs() < 1e-9, "{found:?}");
    }
}

/// Both halves of a symmetric orbit graze at once: the curve goes on to the edge of its range and to where the slip before the
/// graze has no length, with the multiplier 0.57 and none at −1.
#[test]
fn a_graze_of_a_symmetric_orbit() {
    let special = special(&curve(FORCED, &[]));
    assert_eq!(special.len(), 2, "{special:?}");
    ends_there(&special[0], "GR+CO");
    assert_eq!(special[1].0, "EP", "{special:?}");
    assert!((special[1].1[0] - 2.0).abs() < 1e-15);
}

/// The curve on which stick just holds ends at the same point, in either order of the states and in other units: the
/// duration of the stick falls to zero in proportion with the rate at which its bound rises from zero.
#[test]
fn stick_that_just_holds_ends_where_it_has_no_length() {
    let onset: (&str, &str) = ("event: GR", "event: SL");
    let turned: [(&str, &str); 3] = [
        onset,
        (r#"["x", "v"]"#, r#"["v", "x"]"#),
        (
            r#"{"x": "v", "v": "A*cos(phase) - x - c*v + q"}"#,
            r#"{"v": "A*cos(phase) - x - c*v + q", "x": "v"}"#,
        ),
    ];
    let scaled: [(&str, &str); 3] = [
        onset,
        (
            "A*cos(phase) - x - c*v + q",
            "1000*(A*cos(phase) + q) - x - c*v",
        ),
        (r#""v": 0.1"#, r#""v": 100.0"#),
    ];
    for replaced in [&[onset][..], &turned, &scaled] {
        let special = special(&curve(FORCED, replaced));
        assert_eq!(special.len(), 2, "{special:?}");
        ends_there(&special[0], "SL+CO");
    }
}

/// A curve on which a guard is zero where a zone begins ends where its rate is zero there, too, in either order of the states: at
/// first it is by less than rounding that the guard falls below zero within the zone.
#[test]
fn a_guard_that_has_no_rate_where_a_zone_begins() {
    let range: (&str, &str) = ("(0.1, 1.0), (0.05, 0.9)", "(0.1, 1.0), (0.05, 0.41)");
    let turned: [(&str, &str); 3] = [
        range,
        (r#"["x", "v", "y", "u"]"#, r#"["y", "u", "x", "v"]"#),
        (
            r#"{"x": 0.2, "v": 0.0, "y": -0.05, "u": 0.0}"#,
            r#"{"y": -0.05, "u": 0.0, "x": 0.2, "v": 0.0}"#,
        ),
    ];
    let ends = [&[range][..], &turned].map(|replaced| {
        let special = special(&curve(BRAKE, replaced));
        let end = special.iter().find(|(kind, _)| kind != "EP");
        let (kind, place) = end.unwrap_or_else(|| panic!("{special:?}")).clone();
        assert_eq!(kind, "SL+GR", "{special:?}");
        place
    });
    for (one, other) in ends[0].iter().zip(ends[1]) {
        assert!((one - other).abs() < 1e-10, "{ends:?}");
    }
}

/// Two blocks with friction, one of them on a belt: at one instant the first comes to the belt and the second turns (CO), or the
/// second turns and its stick just holds (SL).
const TWO_BLOCKS: &str = r#"(
    system: (
        states: ["x1", "v1", "x2", "v2"],
        parameters: {"a": 1.0, "vb": 0.06, "w": 0.48, "k": 0.6, "F1": 0.2, "F2": 0.25, "c": 0.1, "m": 1.5},
        forcing: "w",
        contacts: {"q1": Friction(slip: "v1 - vb", bound: "F1"), "q2": Friction(slip: "v2", bound: "F2")},
        rates: {
            "x1": "v1", "v1": "a*cos(phase) - (x1 - 0) - k*((x1 - 0) - x2) - c*v1 + q1",
            "x2": "v2", "v2": "(-x2 - k*(x2 - (x1 - 0)) - c*v2 + q2)/m",
        },
    ),
    orbit: (start: Simulate(mode: "forward.forward", state: {"x1": 0, "v1": 0.1, "x2": 0, "v2": 0.1}, settle: 300)),
    continuation: (parameter: "w", range: (0.46, 0.53), toward: Up),
    stability: (),
    curve: (event: CO, parameters: ("w", "F2"), range: ((0.485, 0.51), (0.24, 0.275))),
)"#;

/// Where three zeros come to one instant, each of the curves on which two of them meet goes on through it: whichever of the zones
/// without length it is that the event has beyond, in any order of the contacts, and wherever a coordinate has its zero. Beyond, the
/// events are those of the branch at F2 = 0.24.
#[test]
fn an_event_goes_on_through_a_third_zero() {
    let turned: [(&str, &str); 3] = [
        (r#"["x1", "v1", "x2", "v2"]"#, r#"["v2", "x2", "v1", "x1"]"#),
        (
            r#""q1": Friction(slip: "v1 - vb", bound: "F1"), "q2": Friction(slip: "v2", bound: "F2")"#,
            r#""q2": Friction(slip: "v2", bound: "F2"), "q1": Friction(slip: "v1 - vb", bound: "F1")"#,
        ),
        (r#""x1": 0,"#, r#""x1": 0.0,"#),
    ];
    let shifted: [(&str, &str); 2] = [("(x1 - 0)", "(x1 - 1.7)"), (r#""x1": 0,"#, r#""x1": 1.7,"#)];
    let events = [
        ("CO", 2, 0.496_843_844_032_566),
        ("SL", 1, 0.486_330_892_595_566),
    ];
    for (event, seconds, below) in events {
        let followed = format!("event: {event}");
        let followed = ("event: CO", followed.as_str());
        for replaced in [&[][..], &turned, &shifted] {
            let special = special(&curve(TWO_BLOCKS, &[&[followed], replaced].concat()));
            let count = |kind: &str| special.iter().filter(|(one, _)| one == kind).count();
            assert_eq!(count(&format!("{event}+CO")), seconds, "{special:?}");
            assert_eq!(count("EP"), 2, "{special:?}");
            let (_, [w, f2]) = special[0];
            assert!(
                (f2 - 0.24).abs() < 1e-15 && (w - below).abs() < 1e-11,
                "{special:?}"
            );
        }
    }
}
