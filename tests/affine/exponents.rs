//! Lyapunov exponents: closed forms, the multipliers of orbits as a second method, and what no unit or way of writing a
//! system changes.

use std::path::Path;

use brakewave::hybrid::OrbitRunner;
use brakewave::hybrid::exponents::Exponent;
use brakewave::hybrid::scan::Scanner;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{Any, Scan, SystemProblem, parse_any, read_any};

fn problem(text: &str) -> SystemProblem {
    match parse_any(text, "test").unwrap_or_else(|error| panic!("{error}\n{text}")) {
        Any::System(problem) => *problem,
        Any::Tube(_) => panic!("a system"),
    }
}

/// The exponents of the first value of a scan.
fn exponents(problem: &SystemProblem, scan: &Scan) -> Vec<Exponent> {
    let scanner = Scanner::new(problem, scan).unwrap();
    let settled = scanner.piece(0, None).swap_remove(0);
    assert_eq!(settled.lacks, None);
    settled.exponents
}

/// Those of a system with a start and a section `scan`.
fn of(system: &str, start: &str, scan: &str) -> Vec<Exponent> {
    let problem = problem(&format!(
        "(system: ({system}), orbit: (start: Simulate({start}, settle: 10)), scan: ({scan}))"
    ));
    let scan = problem.scan.clone().unwrap();
    exponents(&problem, &scan)
}

fn finite(exponent: Exponent) -> (f64, f64) {
    match exponent {
        Exponent::Finite { value, error } => (value, error.unwrap()),
        other => panic!("{other:?}"),
    }
}

/// Exponents are these, within a tolerance.
fn are(found: &[Exponent], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        match (found, expected.is_finite()) {
            (Exponent::Lost, false) => {}
            _ => {
                let (value, error) = finite(*found);
                assert!((value - expected).abs() < tolerance, "{value} {expected}");
                assert!(error < tolerance, "{error:e}");
            }
        }
    }
}

/// A clock that resets x in one of two ways at s = 1.
fn clock(rate: &str, reset: &str, otherwise: &str, when: &str) -> String {
    format!(
        r#"states: ["x", "s"], parameters: {{"b": 1.8}}, modes: {{"run": (
            rates: {{"x": "{rate}", "s": "1"}},
            until: [
                (zero: "1 - s", to: "run", reset: {{"x": "{reset}", "s": "0"}}, if: ["{when}"]),
                (zero: "1 - s", to: "run", reset: {{"x": "{otherwise}", "s": "0"}}),
            ],
        )}}"#
    )
}

const STARTED: &str = r#"mode: "run", state: {"x": 0.3123, "s": 0.0}"#;
const CLOCKED: &str = r#"parameter: "b", values: Linear(1.8, 1.9, 2), sweep: Fresh, settle: 80, keep: 100,
    section: Zero("s - 0.5"), lyapunov: 2"#;

/// On its section a state is zero but for rounding, which is no unit: whatever a motion begins with there, the cycle r = 1 has the
/// exponents 0 and −2, and a state that decays beside it −a.
#[test]
fn a_state_that_is_zero_on_the_section_has_a_unit() {
    let system = r#"states: ["x", "y", "z"], parameters: {"a": 0.5}, define: {"q": "1 - x^2 - y^2"}, modes: {"flow": (
        rates: {"x": "x*q - 1.5*y", "y": "y*q + 1.5*x", "z": "-a*z + x*z"})}"#;
    let scan = r#"parameter: "a", values: Linear(0.5, 1.0, 2), sweep: Fresh, settle: 60, keep: 100,
        section: Zero("x"), lyapunov: 3"#;
    for x in ["0.0", "5.551115123125783e-17", "-1e-300"] {
        let start = format!(r#"mode: "flow", state: {{"x": {x}, "y": -1.0, "z": 0.1}}"#);
        are(&of(system, &start, scan), &[0.0, -0.5, -2.0], 1e-10);
    }
}

/// ln b of x → bx mod 1 and of the tent map, and the 0 of the shift in time: every period expands alike, so that errors are
/// rounding. What is left of the start is b^−80.
#[test]
fn maps_by_a_clock_expand_uniformly() {
    for system in [
        clock("ln(b)*x", "x - 1", "x", "x - 1"),
        clock("ln(b)*x", "b - x", "x", "x - b/2"),
        // the rate is no linear one, and its flow takes x to bx all the same
        clock(
            "ln(b)*x + 0*x^2 + ln(b)*(exp(x)*exp(-x) - 1)",
            "x - 1",
            "x",
            "x - 1",
        ),
    ] {
        are(&of(&system, STARTED, CLOCKED), &[1.8_f64.ln(), 0.0], 1e-12);
    }
}

/// A forcing adds nothing, and the phase is no state.
#[test]
fn a_forced_clock_expands_by_its_rate() {
    let system = r#"states: ["x", "s"], parameters: {"lam": 0.15, "A": 1.0, "w": 2.0}, forcing: "w",
        modes: {"run": (rates: {"x": "lam*x + A*cos(phase)", "s": "1"}, until: [
            (zero: "2*pi/w - s", to: "run", reset: {"x": "x - 1", "s": "0"}, if: ["x - 1"]),
            (zero: "2*pi/w - s", to: "run", reset: {"s": "0"}),
        ])}"#;
    let scan = r#"parameter: "lam", values: Linear(0.15, 0.16, 2), settle: 80, keep: 60, section: Phase(1.0), lyapunov: 2"#;
    are(&of(system, STARTED, scan), &[0.15, 0.0], 1e-12);
}

/// Their sum is the divergence −(s + 1 + b), and one is that of the shift in time.
#[test]
fn the_exponents_of_lorenz_add_up_to_the_divergence() {
    let system = r#"states: ["x", "y", "z"], parameters: {"r": 28.0, "s": 10.0, "b": 2.6666666666666667},
        modes: {"flow": (rates: {"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"})}"#;
    let start = r#"mode: "flow", state: {"x": 1.0, "y": 1.0, "z": 20.0}"#;
    let scan = r#"parameter: "r", values: Linear(28, 29, 2), settle: 20, keep: 200, section: Zero("z - r + 1"), lyapunov: 3"#;
    let found: Vec<(f64, f64)> = of(system, start, scan).into_iter().map(finite).collect();
    let sum: f64 = found.iter().map(|one| one.0).sum();
    assert!((sum + 13.666666666666666667).abs() < 1e-9, "{sum}");
    // the largest is 0.9056 in the literature
    for ((value, error), expected) in found.iter().zip([0.9056, 0.0]) {
        assert!((value - expected).abs() < 4.0 * error, "{value} ± {error}");
    }
}

/// The second exponent of van der Pol's cycle is the mean of its divergence, in any units.
#[test]
fn van_der_pol_has_the_mean_of_its_divergence() {
    for (x, t) in [(1.0, 1.0), (1e-6, 1e3)] {
        let system = format!(
            r#"states: ["x", "v"], parameters: {{"mu": 1.0}}, modes: {{"flow": (
                rates: {{"x": "v", "v": "(mu*(1 - (x/{x:?})^2)*v*{t:?} - x)/{t:?}^2"}},
            )}}"#
        );
        let start = format!(r#"mode: "flow", state: {{"x": {:?}, "v": 0.0}}"#, 2.0 * x);
        let settle = 60.0 * t;
        let scan = format!(
            r#"parameter: "mu", values: Linear(1, 1.1, 2), settle: {settle:?}, keep: 20, section: Zero("v"), lyapunov: 2"#
        );
        let found = of(&system, &start, &scan);
        are(&found, &[0.0, -1.0593769948418548927 / t], 1e-11 / t);
    }
}

/// A block that sticks for ever: its place stays where it is (0), its velocity is lost (−∞), and its neighbour decays by
/// its own eigenvalues −1 and −2, which no rounding of what is lost may cover.
#[test]
fn what_sticks_loses_a_dimension() {
    let system = r#"states: ["x", "v", "y", "u"], parameters: {"c": 3.0, "A": 0.5, "w": 1.3}, forcing: "w",
        contacts: {"q": Friction(slip: "v", bound: "5")},
        rates: {"x": "v", "v": "y - 2*x + q", "y": "u", "u": "A*cos(phase) - 2*y - c*u + x"}"#;
    let start = r#"mode: "forward", state: {"x": 0.0, "v": 0.5, "y": 0.0, "u": 0.0}"#;
    let scan = r#"parameter: "c", values: Linear(3, 3.1, 2), settle: 40, keep: 300, lyapunov: 4"#;
    let expected = [0.0, -1.0, -2.0, f64::NEG_INFINITY];
    are(&of(system, start, scan), &expected, 1e-12);
}

/// A switch through a mode that ends as it begins is that from the first mode to the last.
#[test]
fn a_mode_of_no_duration_changes_nothing() {
    let modes = |to: &str, last: &str| {
        format!(
            r#"states: ["x", "v"], parameters: {{"A": 1.7, "w": 0.8, "e": 0.8}}, forcing: "w", modes: {{
                "free": (
                    rates: {{"x": "v", "v": "A*cos(phase) - 0.1*v - x"}},
                    until: [(zero: "1 - x", to: "{to}", reset: {{"v": "-e*v"}})],
                ),
                {last}
            }}"#
        )
    };
    let start = r#"mode: "free", state: {"x": 0.0, "v": 0.0}"#;
    let scan = r#"parameter: "A", values: Linear(1.7, 1.8, 2), settle: 50, keep: 60, lyapunov: 2"#;
    let through = r#""gone": (rates: {"x": "1", "v": "x"}, until: [(zero: "x - 9", to: "free")]),"#;
    let direct = of(&modes("free", ""), start, scan);
    let passed = of(&modes("gone", through), start, scan);
    for (one, other) in direct.into_iter().zip(passed) {
        let (one, other) = (finite(one), finite(other));
        assert!((one.0 - other.0).abs() < 1e-9, "{one:?} {other:?}");
    }
}

/// On an orbit the exponents are the logarithms of the moduli of its multipliers by its period. Their sum, the growth of a
/// volume, is so exactly; those of a complex pair go to and fro within their errors.
#[test]
fn exponents_of_orbits_are_those_of_their_multipliers() {
    for (name, section) in [
        ("impact_oscillator", None),
        ("relay", Some("x")),
        ("contact_relay", Some("x")),
        ("two_blocks", Some("v1")),
        ("gear_rattle", None),
        ("blade_dampers", None),
        ("contact_friction", None),
        ("stribeck_belt", Some("v - 0.0123")),
        ("resting_ball", None),
        ("brake_coupling", Some("v")),
    ] {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/problems");
        let path = format!("{folder}/{name}.ron");
        let Any::System(problem) = read_any(Path::new(&path))
            .unwrap_or_else(|error| panic!("{error}"))
            .0
        else {
            panic!("{name} has a system");
        };
        let continuation = problem.continuation.as_ref().unwrap();
        let mut runner = OrbitRunner::begin(&problem, continuation, None).unwrap();
        let orbit = runner.step().swap_remove(0).point;
        let names = &problem.system.source;
        let count = names.states.len();
        let section = match section {
            Some(zero) => format!("section: Zero({zero:?}),"),
            None => String::new(),
        };
        let value = orbit.parameters[names.parameters.index(&continuation.parameter).unwrap()];
        let scan = format!(
            "(parameter: {:?}, values: Linear({value:?}, {:?}, 2), settle: 400, keep: 41, {section} lyapunov: {count})",
            continuation.parameter,
            value + 1.0
        );
        let scan: Scan = ron::from_str(&scan).unwrap();
        let found = exponents(&problem, &scan);
        let expected = orbit.multipliers.iter();
        let expected = expected.map(|one| one.value.norm().ln() / orbit.period);
        let (mut sum, mut all) = (0.0, 0.0);
        for (found, expected) in found.iter().zip(expected) {
            if *found == Exponent::Lost {
                // a multiplier 0 is so to rounding
                assert!(expected < -10.0 / orbit.period, "{name}: {expected}");
                continue;
            }
            let (value, error) = finite(*found);
            let off = (value - expected).abs();
            assert!(
                off < 6.0 * error + 1e-6,
                "{name}: {value} ± {error}, {expected}"
            );
            sum += value;
            all += expected;
        }
        assert!((sum - all).abs() < 1e-7, "{name}: {sum} {all}");
    }
}
