//! Equilibria and cycles in what contacts hold: a slip that sticks and a gap that is closed are surfaces like that of a sliding
//! mode written by hand.

use brakewave::EventType;
use brakewave::affine::steady::{Admissibility, NoEquilibrium};
use brakewave::hybrid::equilibrium::{EquilibriumEvent, NamedEquilibrium};
use brakewave::hybrid::{EarlierPoint, OrbitRunner};
use brakewave::orbit::legs::Run as _;

use super::rests::{Course, RELAY, STARTS, events, meets, number};
use super::systems::{at, system};
use EventType::{BE, HB, LP};

/// A relay −M sign(s) with s behind a curved front of two states.
const CONTACT: &str = r#"(states: ["s", "x", "y"], parameters: {"mu": -0.3, "k": 0.4, "c": 0.05, "M": 0.8, "p": 0.6, "r": 0.3},
    contacts: {"q": Friction(slip: "s", bound: "M")},
    rates: {"s": "p*x + r*y + q", "x": "mu*x - y - x*(x^2 + y^2) - k*q/M", "y": "x + mu*y - y*(x^2 + y^2) + c"})"#;

/// The same events in both formulations, by their names for a mode each.
fn are_alike(own: &[EquilibriumEvent], by_hand: &[EquilibriumEvent], names: &[(&str, &str)]) {
    assert_eq!(own.len(), by_hand.len(), "{own:#?}\n{by_hand:#?}");
    let named = |name: &str| names.iter().find(|(one, _)| *one == name).unwrap().1;
    for (one, other) in own.iter().zip(by_hand) {
        assert_eq!(one.kind, other.kind);
        assert_eq!(named(&one.regimes_before), other.regimes_before);
        assert_eq!(named(&one.regimes_after), other.regimes_after);
        for ((_, one), (_, other)) in one.parameters.iter().zip(&other.parameters) {
            assert!(
                (one - other).abs() <= 1e-13 * (1.0 + other.abs()),
                "{one} {other}"
            );
        }
        for name in ["omega", "lyapunov"] {
            let [one, other] = [one, other].map(|event| event.number(name));
            let near = |(one, other): (f64, f64)| (one - other).abs() <= 1e-12 * other.abs();
            assert!(one.zip(other).is_none_or(near), "{one:?} {other:?}");
            assert_eq!(one.is_some(), other.is_some());
        }
    }
}

/// A relay as friction has the events, the eigenvalues and the coefficients of the one whose modes are written by hand, also where
/// its surface is curved.
#[test]
fn what_sticks_rests_as_what_slides() {
    let names = [
        ("forward", "plus"),
        ("backward", "minus"),
        ("stick", "slide"),
    ];
    let course = |system, mode, parameter, range| Course {
        system,
        mode,
        parameter,
        range,
        ..STARTS[9]
    };
    let range = (-0.6, 0.3);
    let own = course(CONTACT, "stick", "mu", range);
    are_alike(&own.events(), &STARTS[9].events(), &names);
    let all = own.all(&[1.0; 3], false);
    assert!(all.iter().all(|item| item.point.eigenvalues.len() == 2));
    // s with a part of x², out of sliding through both boundaries
    let bent = |text: &str, slip: &str, curved: &str| {
        let text = text.replace(&format!("\"{slip}\""), &format!("\"{curved}\""));
        text.replace("p*x + r*y", "c - p*x - r*s")
    };
    let slip = "s - 0.2*x^2 + 0.1*x";
    let friction = bent(CONTACT, "s", "s").replace("slip: \"s\"", &format!("slip: \"{slip}\""));
    let relay = bent(RELAY, "s", "s").replace("zero: \"s\"", &format!("zero: \"{slip}\""));
    let relay = relay.replace("zero: \"-s\"", &format!("zero: \"-({slip})\""));
    let [one, other] = [(&friction, "stick"), (&relay, "slide")]
        .map(|(text, mode)| course(text, mode, "c", (-3.0, 3.0)).events());
    assert!(
        one.iter().filter(|event| event.kind == BE).count() >= 2,
        "{one:#?}"
    );
    are_alike(&one, &other, &names);
}

/// A mass on a table lifts off where its load is gone, and lands, whatever the restitution: x = 1/2 on the table, where the
/// eigenvalues are those of the other mass alone.
#[test]
fn a_gap_that_is_closed_rests_on_its_stop() {
    for (restitution, unit) in [("0", 1.0), ("0.6", 1.0), ("0", 1e-5), ("0.6", 1e5)] {
        // y and u in these units
        let text = format!(
            r#"(states: ["x", "v", "y", "u"], parameters: {{"N": 0.2, "U": {unit:?}}},
            contacts: {{"p": Stop(gap: "y*U", restitution: "{restitution}")}},
            rates: {{"x": "v", "v": "-x + 0.3*y*U - 0.1*v + 0.5", "y": "u", "u": "(-N - y*U + x - 0.1*u*U + p)/U"}})"#
        );
        for (mode, state, value) in [
            ("open", [0.6, 0.0, 0.4 / unit, 0.0], 0.2),
            ("closed", [0.5, 0.0, 0.0, 0.0], 0.9),
        ] {
            let text = text.replace("\"N\": 0.2", &format!("\"N\": {value:?}"));
            let course = Course {
                system: &text,
                mode,
                state: &state,
                parameter: "N",
                range: (-1.0, 2.0),
            };
            let all = course.all(&[1.0; 4], false);
            let found = events(&all);
            assert_eq!(found.len(), 1, "{found:#?}");
            meets(&found, BE, "N", 0.5, &[("x", 0.5), ("y", 0.0), ("u", 0.0)]);
            assert!(
                found[0].what.starts_with("persistence"),
                "{}",
                found[0].what
            );
            let sequence = [&found[0].regimes_before, &found[0].regimes_after];
            let other = if mode == "open" { "closed" } else { "open" };
            assert_eq!(sequence, [mode, other]);
            let closed = all.iter().filter(|item| item.point.eigenvalues.len() == 2);
            let mut count = 0;
            for item in closed {
                let [one, other] = [0, 1].map(|index| item.point.eigenvalues[index].value);
                assert!((one.re + 0.05).abs() <= 1e-15 && (other.re + 0.05).abs() <= 1e-15);
                assert!((one.im - 0.9975_f64.sqrt()).abs() <= 1e-15);
                count += 1;
            }
            assert!(count > 2);
        }
    }
}

/// Friction on a stop that is closed: both contacts hold. In `closed` p = N − 0.3x; in `backward` x = 0.3p + 0.2, in `forward`
/// −x = 0.3p + 0.2, and the slip −w + 0.2x is zero where they end.
#[test]
fn friction_sticks_on_a_closed_stop() {
    let text = r#"(states: ["x", "v", "y", "u"], parameters: {"N": 0.9, "w": 0.5},
        contacts: {"p": Stop(gap: "y", restitution: "0"), "q": Friction(slip: "v - w + 0.2*x", bound: "0.3*p + 0.2")},
        rates: {"x": "v", "v": "-x - 0.3*v + q", "y": "u", "u": "-N - y + 0.3*x - 0.1*u + p"})"#;
    let course = Course {
        system: text,
        mode: "closed.backward",
        state: &[0.4, 0.0, 0.0, 0.0],
        parameter: "w",
        range: (-0.5, 1.0),
    };
    let found = course.events();
    let [up, down] = [0.47 / 1.09, -0.47 / 0.91];
    meets(&found, BE, "w", 0.2 * up, &[("x", up), ("y", 0.0)]);
    meets(&found, BE, "w", 0.2 * down, &[("x", down), ("y", 0.0)]);
    let names: Vec<&str> = found.iter().map(|one| one.regimes_after.as_str()).collect();
    assert_eq!(names, ["closed.stick", "closed.forward"]);
    // x = 5w, v′ left out: x′ = −0.2x about it
    let own = system(&text.replace("\"w\": 0.5", "\"w\": 0.01"));
    let mode = own.mode("closed.stick").unwrap();
    let found = at(&own, &[]).equilibria(mode).unwrap().remove(0);
    assert_eq!(found.place, Admissibility::Admissible);
    assert_eq!(found.stable, Some(true));
    assert_eq!(found.eigenvalues.len(), 1);
    assert!((found.eigenvalues[0] + 0.2).norm() <= 1e-15);
    assert!((found.state[0] - 0.05).abs() <= 1e-16);
    // where the slip is the velocity alone a block may rest anywhere
    let own = system(&text.replace("v - w + 0.2*x", "v"));
    let mode = own.mode("closed.stick").unwrap();
    let all = at(&own, &[]).equilibria(mode);
    assert_eq!(all, Err(NoEquilibrium::Singular));
}

/// A fold of equilibria that stick: x² = c where s = 0.
#[test]
fn equilibria_that_stick_have_folds() {
    let text = r#"(states: ["s", "x"], parameters: {"c": 0.25},
        contacts: {"q": Friction(slip: "s", bound: "2")}, rates: {"s": "x - s + q", "x": "c - x^2 + 0.5*s"})"#;
    let course = Course {
        system: text,
        mode: "stick",
        state: &[0.0, 0.5],
        parameter: "c",
        range: (-1.0, 1.0),
    };
    let found = course.events();
    assert_eq!(found.len(), 1, "{found:#?}");
    meets(&found, LP, "c", 0.0, &[("s", 0.0), ("x", 0.0)]);
}

/// The cycle that is born within what sticks, from its Hopf point and as a motion finds it, is that of the sliding mode.
#[test]
fn cycles_within_what_sticks_are_those_within_sliding() {
    let born = |text: &str, mode: &str| {
        let course = Course {
            system: text,
            mode,
            ..STARTS[9]
        };
        let all = course.all(&[1.0; 3], false);
        let at = all.iter().find(|item| item.point.kind == Some(HB)).unwrap();
        let named = EarlierPoint::Equilibrium(NamedEquilibrium {
            saved: at.saved.clone().unwrap(),
            kind: Some(HB),
        });
        let beginnings = [
            (
                r#"(start: Switch(dir: "earlier", label: 2))"#.to_owned(),
                None,
                Some(&named),
            ),
            (
                format!(
                    r#"(start: Simulate(mode: "{mode}", state: {{"s": 0.0, "x": 0.4, "y": 0.0}}, settle: 100))"#
                ),
                Some(-0.05),
                None,
            ),
        ];
        beginnings.map(|(orbit, value, named)| {
            let text = match value {
                Some(value) => text.replace("\"mu\": -0.3", &format!("\"mu\": {value:?}")),
                None => text.to_owned(),
            };
            let course = Course {
                system: &text,
                ..course
            };
            let mut problem = course.problem(&[1.0; 3], false, "stability: ()");
            problem.equilibrium = None;
            problem.orbit = ron::from_str(&orbit).unwrap();
            let section = problem.continuation.as_mut().unwrap();
            section.stop_at = vec![brakewave::problem::UserPoint::Parameter(-0.1)];
            let section = section.clone();
            let mut runner = OrbitRunner::begin(&problem, &section, named).unwrap();
            loop {
                let items = runner.step();
                let user = items
                    .into_iter()
                    .find(|item| item.point.kind == Some(EventType::UZ));
                if let Some(user) = user {
                    let index = problem.parameter().unwrap();
                    assert!((user.point.parameters[index] + 0.1).abs() <= 1e-15);
                    break (user.point.period, user.point.multipliers);
                }
                assert!(runner.progress().end.is_none());
            }
        })
    };
    let own = born(CONTACT, "stick");
    let by_hand = born(RELAY, "slide");
    for (period, multipliers) in own.iter().chain(&by_hand) {
        assert!((period / own[0].0 - 1.0).abs() <= 1e-12);
        for (one, first) in multipliers.iter().zip(&own[0].1) {
            assert_eq!(one.trivial, first.trivial);
            assert!((one.value - first.value).norm() <= one.error + first.error);
        }
    }
    assert!(number(&STARTS[9].events()[0], "omega") > 0.9);
}
