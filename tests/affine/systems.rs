//! Systems of the literature, as a problem file has them.

use brakewave::affine::mode::AffineSystem;
use brakewave::affine::motion::Place;
use brakewave::affine::system::{Source, System};
use ron::extensions::Extensions;

/// COCO, hspo `demo_impact` (Dankowicz & Schilder, Recipes for Continuation, ex. 15.2).
pub const IMPACT: &str = r#"(
    states: ["x", "v"],
    parameters: {"c": 0.1, "A": 1.0, "w": 1.0, "d": 1.0, "e": 0.8},
    forcing: "w",
    modes: {"free": (
        rates: {"x": "v", "v": "A*cos(phase) - c*v - x"},
        until: [(zero: "d - x", to: "free", reset: {"v": "-e*v"})],
    )},
)"#;

/// Den Hartog 1930: dry friction, forced by cos(phase).
pub const FRICTION: &str = r#"(
    states: ["x", "v"],
    parameters: {"w": 1.2, "F": 0.6666666666666666, "z": 0.05},
    forcing: "w",
    define: {"rest": "cos(phase) - 2*z*v - x"},
    modes: {
        "forth": (rates: {"x": "v", "v": "rest - F"}, until: [(zero: "v", to: "back")]),
        "back": (rates: {"x": "v", "v": "rest + F"}, until: [(zero: "-v", to: "forth")]),
    },
    sliding: {"stick": ("forth", "back")},
)"#;

/// AUTO-07p, demo chu, without its smoothing.
pub const CHUA: &str = r#"(
    states: ["x", "y", "z"],
    parameters: {"alpha": 8.180977741435308, "beta": 14.3, "m": -0.14285714285714285, "n": 0.2857142857142857},
    modes: {
        "inner": (
            rates: {"x": "alpha*(y - m*x)", "y": "x - y + z", "z": "-beta*y"},
            until: [(zero: "1 - x", to: "upper"), (zero: "1 + x", to: "lower")],
        ),
        "upper": (
            rates: {"x": "alpha*(y - n*x - (m - n))", "y": "x - y + z", "z": "-beta*y"},
            until: [(zero: "x - 1", to: "inner")],
        ),
        "lower": (
            rates: {"x": "alpha*(y - n*x + (m - n))", "y": "x - y + z", "z": "-beta*y"},
            until: [(zero: "-1 - x", to: "inner")],
        ),
    },
)"#;

/// A relay with the process (s − ρ)²/(s + 1)³, after Johansson, Rantzer & Åström 1999.
pub const RELAY: &str = r#"(
    states: ["x", "y", "z"],
    parameters: {"rho": 0.1},
    modes: {
        "plus": (
            rates: {"x": "-3*x + y - 1", "y": "-3*x + z + 2*rho", "z": "-x - rho^2"},
            until: [(zero: "x", to: "minus")],
        ),
        "minus": (
            rates: {"x": "-3*x + y + 1", "y": "-3*x + z - 2*rho", "z": "-x + rho^2"},
            until: [(zero: "-x", to: "plus")],
        ),
    },
    sliding: {"slide": ("plus", "minus")},
)"#;

/// Buck converter (Hamill & Deane; Fossas & Olivar), its ramp a state.
pub const BUCK: &str = r#"(
    states: ["v", "i", "ramp"],
    parameters: {"R": 22.0, "C": 4.7e-5, "L": 0.02, "T": 4e-4, "low": 3.8, "high": 8.2, "ref": 11.3, "a": 8.4, "E": 22.0},
    define: {"control": "a*(v - ref)", "charge": "(i - v/R)/C", "slope": "(high - low)/T"},
    modes: {
        "off": (
            rates: {"v": "charge", "i": "-v/L", "ramp": "slope"},
            until: [
                (zero: "control - ramp", to: "on"),
                (zero: "high - ramp", to: "off", reset: {"ramp": "low"}, if: ["control - low"]),
                (zero: "high - ramp", to: "on", reset: {"ramp": "low"}),
            ],
        ),
        "on": (
            rates: {"v": "charge", "i": "(E - v)/L", "ramp": "slope"},
            until: [
                (zero: "ramp - control", to: "off"),
                (zero: "high - ramp", to: "off", reset: {"ramp": "low"}, if: ["control - low"]),
                (zero: "high - ramp", to: "on", reset: {"ramp": "low"}),
            ],
        ),
    },
)"#;

/// A ball on a table that moves like a sine.
pub const BALL: &str = r#"(
    states: ["y", "v"],
    parameters: {"G": 1.0473022709517175, "e": 0.5},
    forcing: "1",
    modes: {"flight": (
        rates: {"y": "v", "v": "-1 + G*sin(phase)"},
        until: [(zero: "y", to: "flight", reset: {"v": "-e*v"})],
    )},
)"#;

/// A thermostat with hysteresis and a heater that lags behind.
pub const THERMOSTAT: &str = r#"(
    states: ["x", "y"],
    parameters: {"a": 1.0, "b": 1.0, "th": 0.5, "low": 0.9, "high": 1.1, "Q": 2.0},
    modes: {
        "on": (rates: {"x": "-a*x + b*y", "y": "(Q - y)/th"}, until: [(zero: "high - x", to: "off")]),
        "off": (rates: {"x": "-a*x + b*y", "y": "-y/th"}, until: [(zero: "x - low", to: "on")]),
    },
)"#;

/// A section `system`, read as a problem file is.
pub fn source(text: &str) -> Source {
    let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
    options.from_str(text).unwrap()
}

/// A system that makes sense.
pub fn system(text: &str) -> System {
    System::new(source(text)).unwrap()
}

/// Values of the parameters, some of them replaced.
pub fn values(system: &System, replaced: &[(&str, f64)]) -> Vec<f64> {
    let parameters = &system.source.parameters;
    let mut values: Vec<f64> = parameters.0.iter().map(|(_, value)| *value).collect();
    for (name, value) in replaced {
        values[parameters.index(name).unwrap()] = *value;
    }
    values
}

/// A system at its parameters, some of them replaced.
pub fn at(system: &System, replaced: &[(&str, f64)]) -> AffineSystem {
    system.at(&values(system, replaced), &[]).unwrap()
}

/// A place at time zero.
pub fn place(system: &System, mode: &str, state: &[f64], phase: f64) -> Place {
    Place {
        time: 0.0,
        phase,
        mode: system.mode(mode).unwrap(),
        state: state.to_vec(),
    }
}
