//! Derivatives of matrices, guards and resets against differences.

use brakewave::affine::mode::AffineSystem;

use crate::affine::systems::{BUCK, CHUA, FRICTION, IMPACT, RELAY, system, values};

/// Every number of a system, and its derivatives in the first parameter that varies.
fn numbers(system: &AffineSystem) -> Vec<[f64; 2]> {
    let mut numbers = vec![[system.omega.value, system.omega.by[0]]];
    let mut take = |at: &[f64], by: &[f64]| {
        numbers.extend(at.iter().zip(by).map(|(at, by)| [*at, *by]));
    };
    for mode in system.modes.written() {
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
            let mut moved = origin.clone();
            for factor in [0.3, 1.0, 1.7] {
                let mut values = here.clone();
                values[index] *= factor;
                assert!(moved.move_to(&origin, values[index]), "{name}");
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
