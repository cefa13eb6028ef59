//! What is no system, and where its text says so.

use brakewave::affine::system::{System, SystemError};

use crate::affine::systems::{IMPACT, RELAY, source, system};

fn refused(text: &str, from: &str, to: &str) -> SystemError {
    assert!(text.contains(from), "{from}");
    let refused = System::new(source(&text.replacen(from, to, 1))).and_then(|system| {
        let values: Vec<f64> = system
            .source
            .parameters
            .0
            .iter()
            .map(|(_, value)| *value)
            .collect();
        system.at(&values, &[]).map(|_| ())
    });
    refused.unwrap_err()
}

#[test]
fn mistakes_are_told_with_their_place() {
    for (text, from, to, path, message) in [
        (
            IMPACT,
            "\"A*cos(phase) - c*v - x\"",
            "\"A*cos(phase) - phase*x\"",
            "modes.free.rates.v",
            "`sin` and `cos` only",
        ),
        (
            IMPACT,
            "- c*v - x",
            "- c*vv - x",
            "modes.free.rates.v",
            "`vv` is no state",
        ),
        (
            IMPACT,
            "\"x\": \"v\", ",
            "",
            "modes.free.rates",
            "rate of `x` is missing",
        ),
        (
            IMPACT,
            "reset: {\"v\"",
            "reset: {\"u\"",
            "modes.free.until.0.reset.u",
            "`u` is no state",
        ),
        (
            IMPACT,
            "to: \"free\"",
            "to: \"fre\"",
            "modes.free.until.0.to",
            "`fre` is no mode",
        ),
        (
            IMPACT,
            "forcing: \"w\"",
            "forcing: \"x\"",
            "forcing",
            "`x` is no parameter",
        ),
        (
            IMPACT,
            "forcing: \"w\",",
            "",
            "modes.free.rates.v",
            "without `forcing`",
        ),
        (
            IMPACT,
            "\"w\": 1.0",
            "\"w\": -1.0",
            "forcing",
            "must be positive",
        ),
        (
            IMPACT,
            "\"c\": 0.1",
            "\"x\": 0.1",
            "parameters.x",
            "something else already",
        ),
        (
            IMPACT,
            "\"c\": 0.1",
            "\"pi\": 0.1",
            "parameters.pi",
            "a meaning of its own",
        ),
        (IMPACT, "[\"x\", \"v\"]", "[]", "states", "0 states"),
        (
            RELAY,
            "zero: \"-x\"",
            "zero: \"-y\"",
            "sliding.slide",
            "do not meet in one surface",
        ),
    ] {
        let error = refused(text, from, to);
        assert_eq!(error.path, path, "{error}");
        assert!(error.to_string().contains(message), "{error}");
    }
    let error = refused(IMPACT, "to: \"free\"", "to: \"fre\"");
    assert_eq!(error.nearest.as_deref(), Some("free"));
}

#[test]
fn what_is_never_used_is_told() {
    let text = IMPACT.replace("\"c\": 0.1", "\"c\": 0.1, \"k\": 1.0");
    assert_eq!(system(&text).unused_parameters(), ["k"]);
    assert!(system(&text).unentered_modes().is_empty());
    let text = IMPACT.replace(
        "modes: {",
        "modes: {\"off\": (rates: {\"x\": \"0\", \"v\": \"0\"}), ",
    );
    assert_eq!(system(&text).unentered_modes(), ["off"]);
}
