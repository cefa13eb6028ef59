//! Systems of the literature: most of them are those of the repository's problem files.

use brakewave::affine::mode::AffineSystem;
use brakewave::affine::motion::{Moment, Motion, Step};
use brakewave::affine::system::{Source, System};
use ron::extensions::Extensions;

/// A system of one mode, its states in an order of these rates.
pub fn in_order(rates: &[(&str, &str)], order: &[usize], more: &str) -> String {
    let list = |of: &dyn Fn(&(&str, &str)) -> String| {
        let all: Vec<String> = order.iter().map(|index| of(&rates[*index])).collect();
        all.join(", ")
    };
    let names = list(&|(name, _)| format!("\"{name}\""));
    let rates = list(&|(name, rate)| format!("\"{name}\": \"{rate}\""));
    format!(r#"(states: [{names}], modes: {{"flow": (rates: {{{rates}}})}}, {more})"#)
}

/// COCO, hspo `demo_impact` (Dankowicz & Schilder, Recipes for Continuation, ex. 15.2).
pub const IMPACT: &str = include_str!("../../problems/impact_oscillator.ron");

/// Den Hartog 1930: dry friction, forced by cos(phase).
pub const FRICTION: &str = include_str!("../../problems/friction_oscillator.ron");

/// AUTO-07p, demo chu, without its smoothing.
pub const CHUA: &str = include_str!("../../problems/chua.ron");

/// A relay with the process (s − ρ)²/(s + 1)³, after Johansson, Rantzer & Åström 1999.
pub const RELAY: &str = include_str!("../../problems/relay.ron");

/// A mass on a belt, whose friction at rest exceeds that of slip.
pub const BELT: &str = include_str!("../../problems/belt.ron");

/// Buck converter (Hamill & Deane; Fossas & Olivar), its ramp a state.
pub const BUCK: &str = include_str!("../../problems/buck_converter.ron");

/// A ball on a table that moves like a sine.
pub const BALL: &str = include_str!("../../problems/bouncing_ball.ron");

/// A thermostat with hysteresis and a heater that lags behind.
pub const THERMOSTAT: &str = r#"(
    states: ["x", "y"],
    parameters: {"a": 1.0, "b": 1.0, "th": 0.5, "low": 0.9, "high": 1.1, "Q": 2.0},
    modes: {
        "on": (rates: {"x": "-a*x + b*y", "y": "(Q - y)/th"}, until: [(zero: "high - x", to: "off")]),
        "off": (rates: {"x": "-a*x + b*y", "y": "-y/th"}, until: [(zero: "x - low", to: "on")]),
    },
)"#;

/// Two masses with Coulomb friction, the first of them forced.
pub const TWO_MASSES: &str = r#"(
    states: ["x", "v", "y", "u"],
    parameters: {"A": 0.5, "w": 0.7, "f": 0.4, "g": 0.9, "k": 0.8},
    forcing: "w",
    define: {"a": "A*cos(phase) - x - k*(x - y)", "b": "-y + k*(x - y) - 0.05*u"},
    modes: {
        "pp": (rates: {"x": "v", "v": "a - f", "y": "u", "u": "b - g"}, until: [(zero: "v", to: "np"), (zero: "u", to: "pn")]),
        "pn": (rates: {"x": "v", "v": "a - f", "y": "u", "u": "b + g"}, until: [(zero: "v", to: "nn"), (zero: "-u", to: "pp")]),
        "np": (rates: {"x": "v", "v": "a + f", "y": "u", "u": "b - g"}, until: [(zero: "-v", to: "pp"), (zero: "u", to: "nn")]),
        "nn": (rates: {"x": "v", "v": "a + f", "y": "u", "u": "b + g"}, until: [(zero: "-v", to: "pn"), (zero: "-u", to: "np")]),
    },
    sliding: {"sp": ("pp", "np"), "sn": ("pn", "nn"), "ps": ("pp", "pn"), "ns": ("np", "nn")},
)"#;

/// The section `system` of a problem file, or the section alone.
pub fn source(text: &str) -> Source {
    #[derive(serde::Deserialize)]
    struct File {
        system: Source,
    }
    let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
    match options.from_str::<File>(text) {
        Ok(file) => file.system,
        Err(_) => options.from_str(text).unwrap(),
    }
}

/// A system that makes sense.
pub fn system(text: &str) -> System {
    System::new(source(text)).unwrap()
}

/// Values of the parameters, some of them replaced.
pub fn values(system: &System, replaced: &[(&str, f64)]) -> Vec<f64> {
    let parameters = &system.source.parameters;
    let mut values = system.values();
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
pub fn place(system: &System, mode: &str, state: &[f64], phase: f64) -> Moment {
    Moment {
        time: 0.0,
        phase,
        mode: system.mode(mode).unwrap(),
        state: state.to_vec(),
    }
}

/// A mass with a brake that is let go while sin φ > h: friction falls from f to g, and stick lasts in both.
pub const BRAKE_BY_HAND: &str = r#"(
    states: ["x", "v"],
    parameters: {"A": 0.3, "w": 0.5, "f": 0.4, "g": 0.02, "h": 0.8},
    forcing: "w",
    define: {"a": "A*sin(phase) - x - 0.1*v", "s": "A*sin(phase) - x"},
    modes: {
        "p": (rates: {"x": "v", "v": "a - f"}, until: [(zero: "v", to: "n", if: ["-s - f"]), (zero: "v", to: "hold"), (zero: "h - sin(phase)", to: "P")]),
        "n": (rates: {"x": "v", "v": "a + f"}, until: [(zero: "-v", to: "p", if: ["s - f"]), (zero: "-v", to: "hold"), (zero: "h - sin(phase)", to: "N")]),
        "P": (rates: {"x": "v", "v": "a - g"}, until: [(zero: "v", to: "N", if: ["-s - g"]), (zero: "v", to: "Hold"), (zero: "sin(phase) - h", to: "p")]),
        "N": (rates: {"x": "v", "v": "a + g"}, until: [(zero: "-v", to: "P", if: ["s - g"]), (zero: "-v", to: "Hold"), (zero: "sin(phase) - h", to: "n")]),
        "hold": (rates: {"x": "0", "v": "0"}, until: [(zero: "f - s", to: "p"), (zero: "f + s", to: "n"), (zero: "h - sin(phase)", to: "P", if: ["s - g"]), (zero: "h - sin(phase)", to: "N", if: ["-s - g"]), (zero: "h - sin(phase)", to: "Hold")]),
        "Hold": (rates: {"x": "0", "v": "0"}, until: [(zero: "g - s", to: "P"), (zero: "g + s", to: "N"), (zero: "sin(phase) - h", to: "hold")]),
    },
)"#;

/// The modes that a motion switches to and where it is at a time; or the last thing that was said.
pub fn moved(
    text: &str,
    mode: &str,
    state: &[f64],
    until: f64,
) -> Result<(Vec<String>, Vec<f64>), String> {
    let system = system(text);
    let affine = at(&system, &[]);
    let mut motion = Motion::new(&affine, place(&system, mode, state, 0.0), 10.0);
    let mut modes = Vec::new();
    loop {
        match motion.step(until).map_err(|halt| halt.to_string())? {
            Step::Reached => return Ok((modes, motion.place().state.clone())),
            Step::Switched(switching) => modes.push(system.mode_name(switching.to).into_owned()),
            Step::Section => {}
        }
    }
}
