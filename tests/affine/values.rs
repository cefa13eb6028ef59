//! Values of parameters that are written as expressions.

use std::f64::consts::PI;

use brakewave::problem::{Any, SystemProblem, parse_any};

/// A problem with these parameters.
fn problem(parameters: &str) -> String {
    format!(
        r#"(
    system: (
        states: ["x"],
        parameters: {{{parameters}}},
        modes: {{"m": (rates: {{"x": "a - b*x + c"}})}},
    ),
    orbit: (start: Simulate(mode: "m", state: {{"x": 0.0}}, settle: 1)),
)"#
    )
}

fn read(parameters: &str) -> Result<Box<SystemProblem>, String> {
    match parse_any(&problem(parameters), "test.ron") {
        Ok(Any::System(problem)) => Ok(problem),
        Ok(Any::Tube(_)) => panic!("a system"),
        Err(error) => Err(error.to_string()),
    }
}

/// Each is that of its expression in those before it, and what is written of the problem has the numbers.
#[test]
fn values_follow_from_those_before_them() {
    let problem = read(r#""a": 3, "b": "2*pi/a", "c": "-b^2 + min(a, 1e2)*sqrt(4)""#).unwrap();
    let b = 2.0 * PI / 3.0;
    assert_eq!(problem.values(), [3.0, b, -(b * b) + 6.0]);
    let numbers = format!("\"a\": 3.0, \"b\": {b:?}, \"c\": {:?}", -(b * b) + 6.0);
    assert_eq!(read(&numbers).unwrap(), problem);
}

#[test]
fn what_is_no_value_is_told_at_its_place() {
    for (parameters, message, at) in [
        (
            r#""a": "b", "b": 1.0, "c": 1.0"#,
            "`b` is no parameter that stands before this one",
            "test.ron:4:28",
        ),
        (
            r#""a": 1.0, "b": "a + x", "c": 1.0"#,
            "`x` is no parameter that stands before",
            "test.ron:4:42",
        ),
        (
            r#""a": 1.0, "b": "a +", "c": 1.0"#,
            "makes no sense from here on",
            "test.ron:4:",
        ),
        (
            r#""a": 1.0, "b": "1/(a - 1)", "c": 1.0"#,
            "`system.parameters.b` is inf",
            "test.ron:4:",
        ),
        (
            r#""a": 1.0, "b": "0/(a - 1)", "c": 1.0"#,
            "`system.parameters.b` is NaN",
            "test.ron:4:",
        ),
        (
            r#""a": true, "b": 1.0, "c": 1.0"#,
            "a number, or an expression in quotes",
            "test.ron:4:",
        ),
        (
            r#""a": [1.0], "b": 1.0, "c": 1.0"#,
            "a number, or an expression in quotes",
            "test.ron:4:",
        ),
    ] {
        let error = read(parameters).unwrap_err();
        assert!(
            error.contains(message) && error.contains(at),
            "{parameters}: {error}"
        );
    }
}
