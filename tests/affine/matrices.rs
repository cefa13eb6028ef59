//! Derivatives of matrices, guards and resets against differences.

use brakewave::affine::mode::{AffineMode, AffineSystem};

use crate::affine::systems::{BUCK, CHUA, FRICTION, IMPACT, RELAY, system, values};

/// Every number of a system, and its derivatives in the first parameter that varies.
fn numbers(system: &AffineSystem) -> Vec<[f64; 2]> {
    let mut numbers = vec![[system.omega.value, system.omega.by[0]]];
    let mut take = |at: &[f64], by: &[f64]| {
        numbers.extend(at.iter().zip(by).map(|(at, by)| [*at, *by]));
    };
    for number in 0..system.modes.len() {
        let mode = &system.modes[number];
        take(mode.matrix.at.as_slice(), mode.matrix.by[0].as_slice());
        for guard in &mode.guards {
            take(guard.row.at.as_slice(), guard.row.by[0].as_slice());
            for exit in &guard.exits {
                take(exit.reset.at.as_slice(), exit.reset.by[0].as_slice());
                for row in &exit.conditions {
                    take(row.at.as_slice(), row.by[0].as_slice());
                }
            }
        }
    }
    numbers
}

#[test]
fn derivatives_in_every_parameter_are_those_of_differences() {
    let relay = &[("rho", 0.1)][..];
    for (text, replaced) in [
        (IMPACT, &[][..]),
        (FRICTION, &[]),
        (CHUA, &[]),
        (RELAY, relay),
        (BUCK, &[]),
    ] {
        let system = system(text);
        let here = values(&system, replaced);
        for (index, value) in here.iter().enumerate() {
            let at = |factor: f64| {
                let mut values = here.clone();
                values[index] = value * factor;
                numbers(&system.at(&values, &[index]).unwrap())
            };
            let (step, middle) = (1e-5, at(1.0));
            for ((low, high), [size, by]) in at(1.0 - step).iter().zip(at(1.0 + step)).zip(middle) {
                let difference = (high[0] - low[0]) / (2.0 * step * value);
                // rounding 1e-16/h and the third derivative times h², both relative
                let allowed = 1e-9 * (size / value).abs().max(by.abs());
                let name = system
                    .source
                    .parameters
                    .names()
                    .nth(index)
                    .unwrap_or_default();
                assert!(
                    (by - difference).abs() <= allowed,
                    "{name}: {by} for {difference}"
                );
            }
        }
    }
}

/// What is affine in a parameter is led to any value of it; what is not is never taken for it.
#[test]
fn affine_systems_are_led_to_other_values_of_a_parameter() {
    for (text, affine) in [
        (IMPACT, &["c", "A", "w", "d", "e"][..]),
        (FRICTION, &["w", "z"]),
        (CHUA, &["alpha", "beta", "m", "n"]),
        (RELAY, &[]),
        (BUCK, &["low", "high", "ref", "a", "E"]),
    ] {
        let system = system(text);
        let here = values(&system, &[]);
        let mut found = Vec::new();
        for (index, name) in system.source.parameters.names().enumerate() {
            let Some(origin) = system.origin(&here, index) else {
                continue;
            };
            found.push(name.to_owned());
            let mut moved = origin.at(here[index]).unwrap();
            for factor in [0.3, 1.0, 1.7] {
                let mut values = here.clone();
                values[index] *= factor;
                assert!(origin.lead(&mut moved, values[index]), "{name}");
                let at = numbers(&system.at(&values, &[index]).unwrap());
                for (one, other) in numbers(&moved).iter().flatten().zip(at.iter().flatten()) {
                    // a few roundings of the terms
                    let allowed = 1e-15 * (1.0 + other.abs());
                    assert!((one - other).abs() <= allowed, "{name}: {one} for {other}");
                }
            }
        }
        assert_eq!(found, affine);
    }
}

/// Modes that contacts make are led one by one: a mass bends what holds and nothing else, and what is bent is made anew. All are
/// the same as those that are made there.
#[test]
fn modes_of_contacts_are_led_to_other_values_of_a_parameter() {
    const TEXT: &str = r#"(
        states: ["x", "v", "y", "u"],
        parameters: {"A": 1.0, "w": 1.1, "m": 2.0, "k": 1.5, "c": 0.2, "F": 0.4, "G": 0.6, "mu": 0.3, "d": 1.0, "K": 30.0, "D": 0.5, "e": 0.5},
        forcing: "w",
        contacts: {
            "q": Friction(slip: "v - 0.1", bound: "F", static: "F + G"),
            "r": Friction(slip: "v - u", bound: "mu*s"),
            "s": Spring(gap: "d - y", stiffness: "K", damping: "D"),
            "p": Stop(gap: "d + x", restitution: "e"),
            "j": Jenkins(slip: "u", stiffness: "k", bound: "G"),
        },
        rates: {"x": "v", "v": "(A*cos(phase) - c*v - k*x + q + r + p)/m", "y": "u", "u": "-u - y - r - s + j"},
    )"#;
    let system = system(TEXT);
    let here = values(&system, &[]);
    let mut found = Vec::new();
    for (index, name) in system.source.parameters.names().enumerate() {
        let Some(origin) = system.origin(&here, index) else {
            continue;
        };
        found.push(name.to_owned());
        let mut moved = origin.at(here[index]).unwrap();
        let mut led = 0;
        for factor in [0.3, 1.0, 1.7] {
            let mut values = here.clone();
            values[index] *= factor;
            assert!(origin.lead(&mut moved, values[index]), "{name}");
            let formed = system.at(&values, &[index]).unwrap();
            for number in 0..formed.modes.len() {
                let (one, other) = (&moved.modes[number], &formed.modes[number]);
                assert_eq!(one.obstruction, other.obstruction);
                let to = |mode: &AffineMode| -> Vec<usize> {
                    let exits = mode.guards.iter().flat_map(|guard| &guard.exits);
                    exits.map(|exit| exit.to).collect()
                };
                assert_eq!(to(one), to(other), "{name}");
                led += usize::from(one.leads);
            }
            let pairs = numbers(&moved);
            let pairs = pairs.iter().zip(numbers(&formed));
            for (one, other) in pairs {
                for (one, other) in one.iter().zip(other) {
                    // a few roundings of the terms, of which the largest is a hundred
                    let allowed = 1e-13 * (1.0 + other.abs());
                    assert!((one - other).abs() <= allowed, "{name}: {one} for {other}");
                }
            }
        }
        assert!(led > 0, "{name}");
    }
    assert_eq!(
        found,
        ["A", "w", "k", "c", "F", "G", "mu", "d", "K", "D", "e"]
    );
}
