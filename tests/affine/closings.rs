//! Zones that close together: both halves of a symmetric orbit, and what a damped spring leaves beyond its gap.

use brakewave::EventType;
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};

use crate::affine::branches::{Seen, follow};
use crate::affine::systems::system;
use EventType::{CO, GR, LP, MX};

/// Events of a branch in a direction.
fn met(
    text: &str,
    (mode, state, settle): (&str, &[f64], f64),
    (parameter, range): (&str, (f64, f64)),
    up: bool,
) -> Vec<Seen> {
    let mut wanted = Wanted::new(system(text), parameter, range).unwrap();
    wanted.periods = 4;
    let beginning = Beginning {
        mode: wanted.system.mode(mode).unwrap(),
        state: state.to_vec(),
        phase: 0.0,
    };
    let (orbit, point) = first(&wanted, &beginning, Search::Settles(settle)).unwrap();
    follow(&orbit, &point, up, range, 2000).0
}

/// An element between two masses slips both ways until its linear response is B/kj: there both slips close at once, in either
/// order of states and parameters, and nothing turns back.
#[test]
fn an_element_that_stops_slipping_both_ways_has_no_fold() {
    let element = |order: &str, a: f64, c: f64, k: f64, kj: f64, b: f64, w: f64| {
        format!(
            r#"(states: {order}, parameters: {{"A": {a:?}, "w": {w:?}, "c": {c:?}, "k": {k:?}, "kj": {kj:?}, "B": {b:?}}},
            forcing: "w", contacts: {{"j": Jenkins(slip: "v1 - v2", stiffness: "kj", bound: "B")}},
            rates: {{"x1": "v1", "v1": "A*cos(phase) - x1 - k*(x1 - x2) - c*v1 + j",
                "x2": "v2", "v2": "-1.5*x2 - k*(x2 - x1) - c*v2 - j"}})"#
        )
    };
    // the stretch of the element comes last
    let orders: [(&str, [f64; 5]); 2] = [
        (r#"["x1", "v1", "x2", "v2"]"#, [0.0, 0.1, 0.0, 0.0, 0.0]),
        (r#"["v2", "x2", "v1", "x1"]"#, [0.0, 0.0, 0.1, 0.0, 0.0]),
    ];
    for (order, state) in orders {
        let first = element(order, 0.492, 0.033, 0.491, 0.798, 0.209, 1.022);
        let second = element(order, 0.451, 0.024, 0.35, 0.354, 0.371, 0.77);
        for (text, range, place) in [
            (first, (0.8, 1.5), 1.158_312_836_908_597_3),
            (second, (0.7, 1.155), 1.127_320_936_643_738_4),
        ] {
            let seen = met(&text, ("stick", &state, 400.0), ("w", range), true);
            let last = seen.iter().rfind(|one| one.kind == GR).unwrap();
            assert!(
                (last.value - place).abs() <= 1e-12,
                "{:e}",
                last.value - place
            );
            let wrong = seen.iter().find(|one| matches!(one.kind, LP | MX | CO));
            assert!(wrong.is_none(), "{:?}", wrong.map(|one| &one.what));
        }
    }
}

/// A damped spring lets go before its gap is open again, so that two zones close where it is touched no more: the one that begins
/// beyond its guard is known badly. With the largest x2 at d the orbit that does not touch goes on.
#[test]
fn a_damped_spring_that_is_touched_no_more_is_passed() {
    let masses = |order: &str, shift: f64| {
        format!(
            r#"(states: {order}, parameters: {{"A": 1.045, "w": 1.5, "k": 0.435, "c": 0.16, "F1": 0.43, "d": 1.127, "kn": 18.239,
            "cn": 0.216, "s": {shift:?}}}, forcing: "w",
            contacts: {{"q": Friction(slip: "v1", bound: "F1"), "p": Spring(gap: "d - x2", stiffness: "kn", damping: "cn")}},
            rates: {{"x1": "v1", "v1": "A*cos(phase) - (x1 - s) - k*(x1 - s - x2) - c*v1 + q",
                "x2": "v2", "v2": "-0.8*x2 - k*(x2 - x1 + s) - c*v2 - p"}})"#
        )
    };
    let variants: [(&str, f64, [f64; 4]); 3] = [
        (r#"["x1", "v1", "x2", "v2"]"#, 0.0, [0.0, 0.1, 0.0, 0.0]),
        (r#"["v2", "x2", "v1", "x1"]"#, 0.0, [0.0, 0.0, 0.1, 0.0]),
        (r#"["x1", "v1", "x2", "v2"]"#, 1.7, [1.7, 0.1, 0.0, 0.0]),
    ];
    let mut places = Vec::new();
    for (order, shift, state) in variants {
        let text = masses(order, shift);
        let from = ("forward.open", &state[..], 300.0);
        let seen = met(&text, from, ("w", (1.2075, 1.6)), false);
        let wrong = seen.iter().find(|one| matches!(one.kind, LP | MX | CO));
        assert!(wrong.is_none(), "{:?}", wrong.map(|one| &one.what));
        let grazes: Vec<f64> = seen
            .iter()
            .filter(|one| one.kind == GR)
            .map(|one| one.value)
            .collect();
        assert_eq!(grazes.len(), 2, "{grazes:?}");
        places.push(grazes);
    }
    for place in &places {
        assert!((place[1] - 1.218_305_350_5).abs() <= 1e-10);
        let mut pairs = place.iter().zip(&places[0]);
        assert!(
            pairs.all(|(one, other)| (one - other).abs() <= 1e-12),
            "{places:?}"
        );
    }
}
