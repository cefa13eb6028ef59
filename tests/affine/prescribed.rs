//! Orbits of a prescribed period: a wave of the tube, written down as a system, is one whose speed is free.

use std::f64::consts::TAU;
use std::fs;

use brakewave::EventType;
use brakewave::affine::closure::Prescribed;
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::affine::system::System;
use brakewave::continuation::newton::{self, Equations as _};
use brakewave::linalg::{Matrix, Vector};
use brakewave::orbit::Zones;
use brakewave::tube::model::{Impact, Parameter};

use crate::affine::branches::follow;
use crate::affine::counts::{events, rows};
use crate::affine::systems::{system, values};
use crate::waves::branches::{
    Case, fast_in_friction, fast_in_mismatch, slow_in_mismatch, speed, tube, with_coulomb_impact,
    with_the_shaft,
};

/// What a material point of the tube meets of a wave that runs at the speed c: displacements U and V, and their rates u and W.
fn wave(impact: Impact) -> String {
    let landing = match impact {
        Impact::Frictionless => {
            r#"(zero: "U - d", to: "separation", reset: {"U": "d", "u": "0"}, if: ["-P"]),
               (zero: "U - d", to: "slip", reset: {"U": "d", "u": "0"}, if: ["1 - W"]),
               (zero: "U - d", to: "reverse", reset: {"U": "d", "u": "0"})"#
        }
        // the tangential velocity jumps towards that of the shaft, and not beyond
        Impact::Coulomb => {
            r#"(zero: "U - d", to: "slip", reset: {"U": "d", "u": "0", "W": "W - j"}, if: ["1 - W + j"]),
               (zero: "U - d", to: "reverse", reset: {"U": "d", "u": "0", "W": "W + j"}, if: ["W - 1 + j"]),
               (zero: "U - d", to: "stick", reset: {"U": "d", "u": "0", "W": "1"}, if: ["F - Q", "F + Q"]),
               (zero: "U - d", to: "reverse", reset: {"U": "d", "u": "0", "W": "1"}, if: ["-F - Q"]),
               (zero: "U - d", to: "slip", reset: {"U": "d", "u": "0", "W": "1"})"#
        }
    };
    format!(
        r#"(
        states: ["U", "u", "V", "W"],
        parameters: {{"d": 0.2, "c": 1.2, "f": 0.5, "n": 4.0, "a": 1.0, "b": 1.0, "D": 1.0, "g": 1.0, "h": 1.0}},
        define: {{
            "ma": "1 - a/c^2", "mb": "1 - b/c^2", "k": "D/c", "P": "g*d + k*W", "Q": "h*V", "F": "f*(g*d + k)",
            "j": "f*mb/ma*u",
        }},
        modes: {{
            "slip": (rates: {{"U": "0", "u": "0", "V": "W", "W": "(f*P - Q)/ma"}}, until: [
                (zero: "1 - W", to: "stick", reset: {{"W": "1"}}, if: ["Q + f*P"]),
                (zero: "1 - W", to: "reverse", reset: {{"W": "1"}}),
                (zero: "P", to: "separation", reset: {{"U": "d", "u": "0"}}),
            ]),
            "reverse": (rates: {{"U": "0", "u": "0", "V": "W", "W": "(-f*P - Q)/ma"}}, until: [
                (zero: "W - 1", to: "stick", reset: {{"W": "1"}}, if: ["f*P - Q"]),
                (zero: "W - 1", to: "slip", reset: {{"W": "1"}}),
                (zero: "P", to: "separation", reset: {{"U": "d", "u": "0"}}),
            ]),
            "stick": (rates: {{"U": "0", "u": "0", "V": "1", "W": "0"}}, until: [
                (zero: "F - Q", to: "slip", reset: {{"U": "d", "u": "0", "W": "1"}}),
                (zero: "F + Q", to: "reverse", reset: {{"U": "d", "u": "0", "W": "1"}}),
            ]),
            "separation": (
                rates: {{"U": "u", "u": "-(g*U + k*W)/mb", "V": "W", "W": "(k*u - Q)/ma"}},
                until: [{landing}],
            ),
        }},
    )"#
    )
}

/// A period that is prescribed, with c free for it.
fn prescribed(system: &System, period: &str) -> Prescribed {
    let free = system.source.parameters.index("c").unwrap();
    Prescribed::new(&system.source, period, free).unwrap()
}

/// The orbit of the first wave of a branch, which is one of slip and stick.
fn orbit(case: &Case, c: f64) -> (AffineOrbit, Vector) {
    let model = &case.model;
    let own = model.source.coefficients();
    let (d, f, n) = (model.mismatch, model.friction, f64::from(case.mode));
    let coupling = own.coupling.abs();
    let system: System = system(&wave(model.impact));
    let at = [
        ("d", d),
        ("c", c),
        ("f", f),
        ("n", n),
        ("a", own.a),
        ("b", own.b),
        ("D", coupling),
        ("g", own.g),
        ("h", own.h),
    ];
    let parameter = match case.parameter {
        Parameter::Friction => "f",
        _ => "d",
    };
    let wanted = Wanted {
        values: values(&system, &at),
        prescribed: Some(prescribed(&system, "2*pi/(n*c)")),
        ..Wanted::new(system, parameter, case.range).unwrap()
    };
    let beginning = Beginning {
        mode: wanted.system.mode("slip").unwrap(),
        state: vec![d, 0.0, f * (own.g * d + coupling / c) / own.h, 1.0],
        phase: 0.0,
    };
    first(&wanted, &beginning, Search::Guess(TAU / (n * c))).unwrap()
}

/// Whether a list of names joined by `-` is another one begun elsewhere.
fn is_rotation(one: &str, other: &str) -> bool {
    let twice = format!("-{one}-{one}-");
    one.len() == other.len() && twice.contains(&format!("-{other}-"))
}

/// Every fold and change of regime of the tube's own equations, to what both know of the parameter.
fn is_the_wave(case: Case) {
    let run = case.follow(&[]);
    let events = run.events();
    let c = speed(&run.points[0]).abs();
    let (orbit, point) = orbit(&case, c);
    let (_, all) = follow(&orbit, &point, case.up, case.range, 1500);
    // reverse slip, and two switches that coalesce, lead elsewhere; what vanishes between two zones of one mode is a graze
    let is_known_as = |kind: EventType, own: EventType| match kind {
        EventType::RV => own == EventType::SL,
        EventType::CO => own == EventType::SL || own == EventType::GR,
        EventType::ST => own == EventType::GR,
        kind => own == kind,
    };
    let own: Vec<_> = all.iter().filter(|one| one.special.is_some()).collect();
    assert!(own.len() >= events.len() && events.len() >= 4);
    for (event, own) in events.iter().zip(own) {
        let kind = event.kind().unwrap();
        let as_known = own.kind().is_some_and(|own| is_known_as(kind, own));
        assert!(as_known, "{kind} at {}", event.parameter);
        let off = (event.parameter - own.parameter).abs();
        let allowed = event.known_to() + own.known_to();
        assert!(off <= allowed, "{kind} at {}: {off:e}", event.parameter);
        let values = own.orbit.values_at(&own.node.point);
        let names = &own.orbit.setting.system.source.parameters;
        let c = values[names.index("c").unwrap()];
        let slower = speed(event).abs() - c;
        // at a fold in f the speed is known as the root of what f is
        let rounding = if kind == EventType::LP { 1e-12 } else { 1e-14 };
        // where the equations are ill-conditioned neither is known to rounding
        let allowed = rounding * c + allowed;
        assert!(slower.abs() <= allowed, "{kind}: {slower:e}");
        let names = own.orbit.sequence.to_string().replace(" > ", "-");
        let regimes = event.orbit.signature.to_string();
        assert!(is_rotation(&names, &regimes), "{names}, {regimes}");
    }
}

#[test]
fn a_fast_wave_has_the_events_of_the_tube() {
    is_the_wave(fast_in_mismatch());
}

#[test]
fn a_slow_wave_has_the_events_of_the_tube() {
    is_the_wave(slow_in_mismatch());
}

#[test]
fn a_branch_in_friction_has_the_events_of_the_tube() {
    is_the_wave(fast_in_friction());
}

#[test]
fn coulomb_impacts_have_the_events_of_the_tube() {
    is_the_wave(with_coulomb_impact());
}

#[test]
fn a_wave_with_the_shaft_has_the_events_of_the_tube() {
    is_the_wave(with_the_shaft());
}

#[test]
fn mode_8_has_the_events_of_the_tube() {
    is_the_wave(Case {
        model: tube(0.25, 1.25, 0.446_107_762_541_61, 0.06),
        mode: 8,
        range: (0.003, 0.06),
        ..fast_in_mismatch()
    });
}

/// The equations at a point.
fn residual(orbit: &AffineOrbit, point: &Vector) -> Vector {
    let count = point.len();
    let mut residual = Vector::zeros(count - 1);
    let mut jacobian = Matrix::zeros(count - 1, count);
    orbit
        .evaluate(point, residual.as_mut_slice(), &mut jacobian)
        .unwrap();
    residual
}

/// Central differences of the equations, the prescribed period with them: their error is h² and 1e-16/h, of terms of order
/// one in the unknowns and of up to a hundred in c.
#[test]
fn derivatives_in_the_free_parameter_are_those_of_differences() {
    const STEP: f64 = 1e-6;
    let case = fast_in_mismatch();
    let (orbit, point) = orbit(&case, 1.242_700_800_630_082);
    let (_, all) = follow(&orbit, &point, false, case.range, 200);
    let last = all.last().unwrap();
    assert!(last.orbit.sequence.to_string().contains("separation"));
    for found in [&all[0], last] {
        let (orbit, point): (&AffineOrbit, _) = (&found.orbit, &found.node.point);
        let (exact, _) = newton::jacobian(orbit, point).unwrap();
        for column in 0..point.len() {
            let at = |step: f64| {
                let mut there = point.clone();
                there[column] += step;
                residual(orbit, &there)
            };
            let slope = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            let off = (slope - exact.column(column)).amax();
            assert!(off <= 1e-7 * exact.amax().max(1.0), "{column}: {off:e}");
        }
    }
}

/// The equations know of every sequence of the branch what is zero at its switches, which changes with both parameters. They
/// are the same numbers wherever they were evaluated before: by an orbit that has seen the branch, and by a new one.
#[test]
fn equations_do_not_depend_on_where_they_were_evaluated_before() {
    let case = fast_in_mismatch();
    let (orbit, point) = orbit(&case, 1.242_700_800_630_082);
    let (_, all) = follow(&orbit, &point, false, case.range, 400);
    let mut sequences = Vec::new();
    for found in all.iter().step_by(5) {
        let (used, point): (&AffineOrbit, _) = (&found.orbit, &found.node.point);
        sequences.push(used.sequence.to_string());
        let new = AffineOrbit::new(used.setting.clone(), used.sequence.clone()).unwrap();
        let mut beside = point.clone();
        beside[point.len() - 1] *= 1.01;
        residual(used, &beside);
        assert_eq!(residual(used, point), residual(&new, point));
        let jacobian = |orbit: &AffineOrbit| newton::jacobian(orbit, point).unwrap().0;
        assert_eq!(jacobian(used), jacobian(&new));
    }
    sequences.sort();
    sequences.dedup();
    assert!(sequences.len() >= 5, "{sequences:?}");
}

/// A rotation at the angular velocity c in two halves, of the period 2π/c: prescribed to be T, it has c = 2π/T whatever
/// the first guess, and no fold, no doubling and no stability is told.
#[test]
fn a_rotation_turns_as_fast_as_is_prescribed() {
    let text = r#"(
        states: ["x", "y"],
        parameters: {"c": 1.3, "T": 6.0},
        define: {"r": "1 - x^2 - y^2"},
        modes: {
            "up": (rates: {"x": "-c*y + x*r", "y": "c*x + y*r"}, until: [(zero: "y", to: "down")]),
            "down": (rates: {"x": "-c*y + x*r", "y": "c*x + y*r"}, until: [(zero: "-y", to: "up")]),
        },
    )"#;
    let system = system(text);
    let wanted = Wanted {
        prescribed: Some(prescribed(&system, "T")),
        ..Wanted::new(system, "T", (2.0, 20.0)).unwrap()
    };
    let beginning = Beginning {
        mode: 0,
        state: vec![1.0, 0.0],
        phase: 0.0,
    };
    for search in [Search::Guess(4.8), Search::Settles(30.0)] {
        let (orbit, point) = first(&wanted, &beginning, search).unwrap();
        let (seen, all) = follow(&orbit, &point, true, (2.0, 20.0), 500);
        assert_eq!(seen.len(), 1, "the edge of the range alone");
        for found in &all {
            let values = found.orbit.values_at(&found.node.point);
            let off = values[0] * found.parameter / TAU - 1.0;
            // one unit in the last place of the sum of durations and of T, and half of one of c
            assert!(off.abs() <= 4.0 * f64::EPSILON, "{off:e}");
        }
        let examined = all[0].orbit.examination(&all[0].node.point).unwrap();
        assert!(examined.tests.is_empty() && examined.multipliers.len() == 2);
    }
}

/// The rate of the radial displacement is zero on every wave until separation opens: its unit is that in which it acts in `separation`,
/// and the events are the same in whatever units it stands.
#[test]
fn a_state_that_is_zero_before_an_event_has_its_unit_beyond() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/wave_as_orbit.ron");
    let plain = fs::read_to_string(path).unwrap();
    let expected = events(&rows(&plain), "d");
    assert!(expected.len() >= 5, "{expected:?}");
    for unit in ["1e-6", "1e9"] {
        let text = plain
            .replace(r#""U": "u""#, &format!(r#""U": "{unit}*u""#))
            .replace("-(g*U + k*W)/mb", &format!("-(g*U + k*W)/mb/{unit}"))
            .replace("k*u - Q", &format!("k*{unit}*u - Q"));
        let found = events(&rows(&text), "d");
        assert_eq!(found.len(), expected.len(), "{unit}: {found:?}");
        for ((kind, d, _), (same, exact, _)) in found.iter().zip(&expected) {
            assert!(
                kind == same && (d - exact).abs() < 1e-13,
                "{unit}: {kind} at {d}, {same} at {exact}"
            );
        }
    }
}

/// Of prescribed period, a cycle of r' = (m + r² − r⁴)r shrinks at m = 0, which is known to the rounding of the growth, and a thermostat with
/// hysteresis h = (1 − |b|) tanh(L/2) to a point on both of its guards, which is no Hopf point.
#[test]
fn what_an_orbit_shrinks_to_is_told_by_eigenvalues() {
    let cycle = rows(
        r#"(system: (states: ["x", "y"], parameters: {"m": -0.1, "w": 1.3, "b": 0.3, "L": 4.0},
            define: {"q": "x^2 + y^2", "g": "m + q - q^2", "o": "w + b*q"},
            modes: {"flow": (rates: {"x": "g*x - o*y", "y": "o*x + g*y"})}),
        orbit: (start: Simulate(mode: "flow", state: {"x": 1.0, "y": 0.1}, settle: 60), period: "L", free: "w"),
        continuation: (parameter: "m", range: (-0.5, 1.0), toward: Down), stability: ())"#,
    );
    let shrinks = cycle.iter().filter_map(|item| item.event.as_ref());
    let shrinks = shrinks.filter(|event| event.kind == EventType::BP);
    let shrinks: Vec<_> = shrinks.collect();
    assert_eq!(shrinks.len(), 1);
    let (value, error) = (shrinks[0].parameters[0].1, shrinks[0].uncertainty);
    assert!(
        value.abs() <= error && error <= 1e-12,
        "{value:e} {error:e}"
    );
    assert!(shrinks[0].what.contains("Hopf"), "{}", shrinks[0].what);

    let thermostat = rows(
        r#"(system: (states: ["x"], parameters: {"h": 0.5, "L": 2.0, "b": 0.1}, modes: {
            "on": (rates: {"x": "1 + b - x"}, until: [(zero: "h - x", name: "u", to: "off")]),
            "off": (rates: {"x": "-1 + b - x"}, until: [(zero: "x + h", name: "d", to: "on")])}),
        orbit: (start: Simulate(mode: "on", state: {"x": 0.0}, settle: 50), period: "L", free: "h"),
        continuation: (parameter: "b", range: (-1.5, 1.5)), stability: ())"#,
    );
    let ends = events(&thermostat, "b");
    assert_eq!(ends.len(), 2);
    for (_, value, what) in ends {
        assert!((value.abs() - 1.0).abs() <= 1e-14, "{value}");
        assert!(what.contains("boundary equilibrium"), "{what}");
    }
}
