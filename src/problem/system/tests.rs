//! Tests of problem files with a system, and of what is said about those that are refused.

use super::super::examples::example;
use super::super::outline::Subject;
use super::super::tests::{marked, refused};
use super::super::{Any, OrbitStart, SYSTEM_TEMPLATE, parse, parse_any};
use super::*;
use crate::orbit::EventType;

/// Every field of the format.
const FULL: &str = r##"// an oscillator that hits a stop
(
    title: "Impact \"oscillator\"",
    system: (
        states: ["x", "v"],
        parameters: {"c": 0.1, "A": 2.0, "w": 1.5, "d": 1.0, "e": 0.8, "f": 0.2},
        forcing: "w",
        define: {"F": "A*cos(phase)", "rest": "F - c*v - x"},
        modes: {
            "free": (
                rates: {"x": "v", "v": "rest"},
                until: [
                    (zero: "d - x", to: "free", reset: {"v": "-e*v"}, if: ["v - 0.1"], rest: "forth"),
                    (zero: "d - x", to: "forth"),
                ],
            ),
            "forth": (rates: {"x": "v", "v": "rest - f"}, until: [(zero: "v", to: "back")]),
            "back": (rates: {"x": "v", "v": "rest + f"}, until: [(zero: "-v", to: "forth")]),
        },
        sliding: {"stick": ("forth", "back")},
        flow_tolerance: 1e-13,
    ),
    orbit: (start: Simulate(mode: "free", state: {"x": 0.5, "v": 0.25}, phase: 0.1, settle: 200), periods: 2),
    continuation: (
        parameter: "A",
        range: (0.2, 2.0),
        toward: Down,
        stop_at: [0.8, (A: 0.45)],
        ds: 0.001,
        ds_min: 1e-10,
        ds_max: 0.01,
        max_points: 500,
        tolerance: 1e-9,
        stop_after: [(event: PD, count: 1)],
    ),
    stability: (),
    map: (
        first: (parameter: "w", range: (1.2, 1.8)),
        second: (parameter: "e", range: (0.25, 0.75)),
        points: Grid(rows: 20, columns: 30),
        starts: [(mode: "back", state: {"x": 0.25, "v": -0.5}, phase: 0.3)],
    ),
    simulation: (duration: 50.0, samples: 100, start: (mode: "stick", state: {"v": 0.0, "x": 0.1})),
    output: (plots: [Diagram, Phase("x", "v"), Time("x"), Multipliers, Column("max_x")], profiles: 9, labels: [1]),
    expect: [
        (event: LP, A: 0.391117, tolerance: 1e-6, regimes_before: "free", regimes_after: "free"),
        (event: SL, w: 1.5, period: 4.2, multiplier_re: 1.0, multiplier_im: 0.0, label: 2, tolerance: 1e-6),
        (event: GR, numbers: {"A": 0.5}, tolerance: 1e-6),
    ],
)
"##;

/// Without forcing.
const FREE: &str = r#"(
    system: (
        states: ["x"],
        parameters: {"a": 1.0},
        modes: {"up": (rates: {"x": "a"}, until: [(zero: "1 - x", to: "up", reset: {"x": "0"})])},
    ),
    orbit: (start: Given(mode: "up", state: {"x": 0}, period: 1)),
    continuation: (parameter: "a", range: (0.5, 2)),
)"#;

fn system(text: &str) -> SystemProblem {
    match parse_any(text, "p.ron").unwrap() {
        Any::System(problem) => *problem,
        Any::Tube(_) => panic!("a tube"),
    }
}

fn edited(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "{from}");
    text.replace(from, to)
}

/// What is refused otherwise than expected: text, what stands there instead, the text above the carets, words of the
/// message and of the help.
fn wrongly_refused(text: &str, cases: &[[&str; 5]]) -> Vec<String> {
    let wrong = |[from, to, place, message, help]: &[&str; 5]| {
        let error = match parse_any(&edited(text, from, to), "p.ron") {
            Ok(_) => return Some(format!("{to}: not refused")),
            Err(error) => error,
        };
        let told = error.message().contains(message) && error.help().contains(help);
        let right = told && marked(&error) == *place;
        (!right).then(|| format!("{to}: `{place}` {message} {help}\n{error}"))
    };
    cases.iter().filter_map(wrong).collect()
}

#[test]
fn every_field_is_read() {
    let problem = system(FULL);
    assert_eq!(problem.values(), [0.1, 2.0, 1.5, 1.0, 0.8, 0.2]);
    assert_eq!(problem.parameter(), Some(1));
    assert_eq!(problem.system.flow_tolerance(), 1e-13);
    let at = problem.system.at(&problem.values(), &[]).unwrap();
    let beginning = problem.beginning().unwrap();
    let place = beginning.place(&problem.system, &at).unwrap();
    assert_eq!(
        (place.mode, place.state, place.phase),
        (3, vec![0.1, 0.0], 0.0)
    );
    let OrbitStart::Simulate { settle, .. } = problem.orbit.start else {
        panic!("{:?}", problem.orbit.start);
    };
    assert_eq!((settle, problem.orbit.periods), (200.0, 2));
    assert_eq!(problem.stability, Some(Multipliers {}));
    let section = problem.continuation.as_ref().unwrap();
    assert_eq!(section.stop_at, [0.8, 0.45]);
    assert_eq!(section.stop_after[0].event, EventType::PD);
    let phase = SystemPlot::Phase("x".into(), "v".into());
    assert_eq!(problem.output.plots[1], phase);
    let numbers = |index: usize| problem.expect[index].numbers().collect::<Vec<_>>();
    assert_eq!(numbers(0), [("A", 0.391117)]);
    assert_eq!(numbers(1).len(), 4);
    assert_eq!(numbers(2), [("A", 0.5)]);
    let simulation = system(FREE);
    assert_eq!((simulation.simulation, simulation.stability), (None, None));
}

/// The template, as it is and with the lines in use that are comments in it.
#[test]
fn the_template_is_right() {
    let problem = system(SYSTEM_TEMPLATE);
    assert_eq!(problem.expect.len(), 1);
    let optional = [
        "ds",
        "max_points",
        "tolerance",
        "stop_after",
        "flow_tolerance",
        "samples",
        "start",
    ];
    let lines = SYSTEM_TEMPLATE.lines().map(|line| {
        let comment = line.trim_start().strip_prefix("// ");
        let used = comment.filter(|rest| optional.iter().any(|name| rest.starts_with(name)));
        used.unwrap_or(line)
    });
    let all = system(&lines.collect::<Vec<_>>().join("\n"));
    let tolerances = [&all, &problem].map(|problem| problem.system.flow_tolerance());
    assert_eq!(tolerances[0], tolerances[1]);
    let (all, usual) = (all.continuation.unwrap(), problem.continuation.unwrap());
    assert_eq!(
        (all.ds, all.ds_max, all.tolerance),
        (usual.ds, usual.ds_max, usual.tolerance)
    );
    assert_eq!(all.stop_after.len(), 1);
    // the modes that are written there as a comment, in the place of the contacts
    let lines = SYSTEM_TEMPLATE.lines();
    let lines = lines.filter(|line| {
        !["contacts: {", "rates: {"]
            .iter()
            .any(|own| line.trim().starts_with(own))
    });
    let of_modes = ["// modes: {", "//     \"open\"", "// },"];
    let lines = lines.map(|line| {
        let own = of_modes.iter().any(|own| line.trim().starts_with(own));
        if own {
            line.replacen("//", "", 1)
        } else {
            line.to_owned()
        }
    });
    let modes = system(&lines.collect::<Vec<_>>().join("\n"));
    assert_eq!(modes.system.source.modes.names().count(), 1);
}

#[test]
fn problems_survive_a_round_trip() {
    let switch = edited(
        FULL,
        "Simulate(mode: \"free\", state: {\"x\": 0.5, \"v\": 0.25}, phase: 0.1, settle: 200)",
        "Switch(dir: \"r/x\", label: 3)",
    );
    for text in [FULL, FREE, &switch] {
        let problem = system(text);
        let stored = ron::to_string(&problem).unwrap();
        assert_eq!(ron::from_str::<SystemProblem>(&stored).unwrap(), problem);
        let windows = text.replace('\n', "\r\n");
        assert_eq!(system(&windows), problem);
    }
}

#[test]
fn expressions_are_marked_where_they_are_wrong() {
    #[rustfmt::skip]
    let cases = [
        // text, replacement, marked, message, help
        ["F - c*v - x", "F - c*vv - x", "vv", "`vv` is no state, parameter or abbreviation; did you mean `v`?", "`x`, `v`, `c`"],
        ["F - c*v - x", "F - phase*x", "phase*x", "the phase may stand in `sin` and `cos` only", "cos(phase)"],
        ["F - c*v - x", "F - (c*v - x", "\"", "a `)` is missing here", "close every bracket"],
        ["F - c*v - x", "F - c v", "v", "an operator is missing", "`c*v`"],
        ["F - c*v - x", "F - c*v) - x", ")", "this `)` closes nothing", "open a bracket"],
        ["F - c*v - x", "F - 3x", "x", "an operator is missing", "`c*v`"],
        ["F - c*v - x", "F - x**3", "**", "a power is written `^`", "x^3"],
        ["F - c*v - x", "F - sin(x, v)", ",", "functions have one argument", "max(a, b)"],
        ["A*cos(phase)", "A*cos(w*t)", "t", "`t` is no state", "cos(phase)"],
        ["F - c*v - x", "F - max(x)", ")", "the second is missing here", "max(x, 0)"],
        ["F - c*v - x", "F - sign(v)", "sign(v)", "`sign` is no function", "what jumps is a switch"],
        ["F - c*v - x", "F - sine(c)", "sine(c)", "`sine` is no function", "did you mean `sin` or"],
        ["F - c*v - x", "F/(w - w)", "F/(w - w)", "not a finite number", "division by zero"],
        ["F - c*v - x", "F \\u{2d} c*\\x76v", "\\x76v", "`vv` is no state", ""],
        ["\"F - c*v - x\"", "r#\"F - c*vv\"#", "vv", "`vv` is no state", ""],
        ["A*cos(phase)", "A*rest", "rest", "`rest` is no state", "before it in `define`"],
        ["A*cos(phase)", "A*phase", "rest", "the phase may stand in `sin` and `cos` only", "cos(phase)"],
        ["forcing: \"w\"", "forcing: \"w + x\"", "x", "`x` is no parameter", "the parameters are `c`"],
        ["forcing: \"w\"", "forcing: \"-w\"", "\"-w\"", "the angular frequency of the forcing is -1.5", "change"],
        ["        forcing: \"w\",\n", "", "\"A*cos(phase)\"", "`phase` has no meaning without `forcing`", "forcing: \"1.5\""],
        ["[\"v - 0.1\"]", "[\"v -\"]", "\"", "makes no sense", ""],
        ["\"-e*v\"", "\"-e*\"", "\"", "makes no sense", ""],
    ];
    assert_eq!(wrongly_refused(FULL, &cases).join("\n"), "");
    // at its column, in characters
    let text = edited(
        FULL,
        "\"rest\": \"F - c*v - x\"",
        "\"rest\": /* ξ */ \"F - c*uu - x\"",
    );
    let error = refused(&text, "uu", "`uu` is no state", "");
    let line = text.lines().nth(7).unwrap();
    let before = line.split("uu").next().unwrap().chars().count();
    assert_eq!((error.line(), error.column()), (Some(8), Some(before + 1)));
}

/// FULL with monitors, with a value of one that is asked for, and a named switch.
fn monitored() -> String {
    let named = edited(FULL, "to: \"forth\"),", "to: \"forth\", name: \"hit\"),");
    let text = edited(&named, "(A: 0.45)]", "(A: 0.45), (\"peak\", 0.9)]");
    let monitors = r#"    monitor: {"peak": Max("x"), "loss": Integral("c*v^2"), "after": After("hit", "v", 2)},
    orbit: ("#;
    edited(&text, "    orbit: (", monitors)
}

/// A parameter may serve the value of another alone, which is found once: one that varies would change nothing.
#[test]
fn a_parameter_may_serve_the_value_of_another() {
    let text = edited(FULL, "\"c\": 0.1", "\"n\": 10, \"c\": \"1/n\"");
    assert_eq!(system(&text).values()[1], 0.1);
    let text = edited(
        &text,
        "parameter: \"A\",\n        range: (0.2",
        "parameter: \"n\",\n        range: (0.2",
    );
    let message = "no expression has the parameter `n`, but the value of another one";
    refused(&text, "\"n\"", message, "`define`");
}

#[test]
fn monitors_are_read() {
    let problem = system(&monitored());
    assert_eq!(
        problem.monitor.names().collect::<Vec<_>>(),
        ["peak", "loss", "after"]
    );
    assert_eq!(problem.monitors().len(), 3);
    let after = &problem.monitor.0[2].1;
    assert_eq!(after.switch(), Some(("hit", 2)));
    let section = problem.continuation.as_ref().unwrap();
    assert_eq!(section.values().collect::<Vec<_>>(), [0.8, 0.45]);
    let stored = ron::to_string(&problem).unwrap();
    assert_eq!(ron::from_str::<SystemProblem>(&stored).unwrap(), problem);
    assert!(problem.drawable_columns().contains(&"loss".to_owned()));
    // what nothing but a monitor has is used
    system(
        &monitored()
            .replace("\"f\": 0.2", "\"f\": 0.2, \"k\": 3.0")
            .replace("c*v^2", "k*v^2"),
    );
}

#[test]
fn monitors_are_marked_where_they_are_wrong() {
    #[rustfmt::skip]
    let cases = [
        ["Max(\"x\")", "Max(\"y\")", "y", "`y` is no state", "`x`, `v`"],
        ["Max(\"x\")", "Max(\"1/(w - w)\")", "1/(w - w)", "not a finite number", ""],
        ["Max(\"x\")", "Max(\"phase\")", "phase", "the phase may stand in", ""],
        ["Max(\"x\")", "Most(\"x\")", "Most", "unknown choice `Most` for `monitor.peak`", ""],
        ["After(\"hit\"", "After(\"hot\"", "\"hot\"", "no switch has the name `hot`; did you mean `hit`?", "`hit`"],
        ["\"v\", 2)", "\"v\", 0)", "0", "which is not admitted", "the first switch"],
        ["\"peak\": Max", "\"period\": Max", "\"period\"", "is a column of the results already", "another name"],
        ["\"peak\": Max", "\"max_v\": Max", "\"max_v\"", "is a column of the results already", ""],
        ["\"peak\": Max", "\"c\": Max", "\"c\"", "is a state or a parameter already", ""],
        ["\"peak\": Max", "\"a b\": Max", "\"a b\"", "a name is a letter followed by", ""],
        ["\"loss\": Integral", "\"peak\": Integral", "\"peak\"", "something else already", "keep one"],
        ["(\"peak\", 0.9)", "(\"peek\", 0.9)", "(\"peek\", 0.9)", "`peek` is no monitor; did you mean `peak`?", "section `monitor`"],
        ["(\"peak\", 0.9)", "(peak: 0.9)", "(peak: 0.9)", "names `peak`, but the branch is in `A`", "(\"peak\", 0.9)"],
        ["(\"peak\", 0.9)", "(\"peak\", 0.9), (\"peak\", 0.9)", "(\"peak\", 0.9)", "is listed twice", ""],
    ];
    assert_eq!(wrongly_refused(&monitored(), &cases).join("\n"), "");
}

/// Of what has no names none is listed.
#[test]
fn a_list_of_known_names_is_not_empty() {
    let text = edited(FULL, "(A: 0.45)]", "(A: 0.45), (\"peak\", 0.9)]");
    let error = parse_any(&text, "p.ron").unwrap_err();
    assert!(error.message().ends_with("`peak` is no monitor"), "{error}");
}

#[test]
fn names_are_marked_where_they_are_wrong() {
    #[rustfmt::skip]
    let cases = [
        ["states: [\"x\", \"v\"]", "states: []", "[]", "0 states", "states: ["],
        ["states: [\"x\", \"v\"]", "states: [\"x\", \"v\", \"x\"]", "\"x\"", "it stands for something else already", "keep one"],
        ["states: [\"x\", \"v\"]", "states: [\"x\", \"v\", \"cos\"]", "\"cos\"", "a meaning of its own", "another name"],
        ["states: [\"x\", \"v\"]", "states: [\"x\", \"v\", \"time\"]", "{", "the rate of `time` is missing", "\"time\": \"0\""],
        ["\"c\": 0.1", "\"c\": 0.1, \"c d\": 1", "\"c d\"", "a name is a letter followed by", "theta_2"],
        ["\"c\": 0.1", "\"c\": 0.1, \"A\": 1", "\"A\"", "something else already", "keep one"],
        ["\"c\": 0.1", "\"c\": 0.1, \"v\": 1", "\"v\"", "something else already", ""],
        ["\"c\": 0.1", "\"c\": 0.1, \"k\": 1", "\"k\"", "the parameter `k` is not used", "remove it"],
        ["\"c\": 0.1", "\"c\": 0.1, \"k\": 1, \"m\": \"2*k\"", "\"m\"", "the parameter `m` is not used", "remove it"],
        ["\"c\": 0.1", "\"c\": 0.1, \"period\": 1", "\"period\"", "a column of the results", "another name"],
        ["\"c\": 0.1", "\"c\": 0.1, \"max_x\": 1", "\"max_x\"", "a column of the results", ""],
        ["\"c\": 0.1", "\"c\": inf", "inf", "`system.parameters.c` is inf", "finite"],
        ["\"c\": 0.1", "\"c\": x", "x", "must be a number", "\"c\": 0.1"],
        ["\"c\": 0.1", "c: 0.1", "c", "", ""],
        ["rates: {\"x\": \"v\", \"v\": \"rest\"}", "rates: {\"v\": \"rest\"}", "{", "the rate of `x` is missing", "\"x\": \"0\""],
        ["rates: {\"x\": \"v\", \"v\": \"rest\"}", "rates: {\"x\": \"v\", \"v\": \"rest\", \"y\": \"0\"}", "\"y\"", "`y` is no state", "`x`, `v`"],
        ["reset: {\"v\"", "reset: {\"w\"", "\"w\"", "`w` is no state", "the states are"],
        ["to: \"back\"", "to: \"bak\"", "\"bak\"", "`bak` is no mode; did you mean `back`?", "`free`, `forth`, `back`"],
        ["rest: \"forth\"", "rest: \"fort\"", "\"fort\"", "did you mean `forth`?", ""],
        ["(\"forth\", \"back\")", "(\"forth\", \"bac\")", "\"bac\"", "did you mean `back`?", ""],
        ["(\"forth\", \"back\")", "(\"forth\", \"free\")", "(\"forth\", \"free\")", "do not meet in one surface", "one `zero`"],
        ["(\"forth\", \"back\")", "(\"forth\")", "(\"forth\")", "two names in parentheses", ""],
        ["\"back\": (rates", "\"alone\": (rates: {\"x\": \"0\", \"v\": \"0\"}), \"back\": (rates", "\"alone\"", "no switch leads to the mode `alone`", "remove it"],
        ["sliding: {", "slidng: {", "slidng", "unknown field `slidng` in `system`; did you mean `sliding`?", ""],
        ["until: [(zero: \"v\"", "until: [(zeor: \"v\"", "zeor", "unknown field `zeor` in `system.modes.forth.until`; did you mean `zero`?", ""],
        ["until: [(zero: \"v\", ", "until: [(", "(", "missing field `zero` in `system.modes.forth.until`", "zero: \"1 - x\""],
        ["rates: {\"x\": \"v\", \"v\": \"rest\"}", "rates: [\"v\", \"rest\"]", "[\"v\", \"rest\"]", "`system.modes.free.rates` must be a map", "rates: {"],
    ];
    assert_eq!(wrongly_refused(FULL, &cases).join("\n"), "");
    let text = edited(FREE, "states: [\"x\"]", "states: [\"time\"]").replace("\"x\":", "\"time\":");
    let text = text.replace("1 - x", "1 - time");
    refused(&text, "\"time\"", "a column of the results", "another name");
}

#[test]
fn values_are_checked() {
    #[rustfmt::skip]
    let cases = [
        ["mode: \"free\", state: {\"x\": 0.5", "mode: \"fre\", state: {\"x\": 0.5", "\"fre\"", "`fre` is no mode; did you mean `free`?", "mode"],
        ["\"x\": 0.5, ", "", "{", "the state `x` is missing in `orbit.start.state`", "\"x\": 0.0"],
        ["\"x\": 0.5, ", "\"x\": 0.5, \"y\": 1, ", "\"y\"", "`y` is no state", ""],
        ["\"x\": 0.5, ", "\"x\": 0.5, \"x\": 1, ", "\"x\"", "`x` is given twice in `orbit.start.state`", "keep one"],
        ["\"x\": 0.5, ", "\"x\": NaN, ", "NaN", "`orbit.start.state.x` is NaN", "finite"],
        ["settle: 200", "settle: -1", "-1", "`orbit.start.settle` is -1.0", "at least 0"],
        ["settle: 200", "", "Simulate(", "missing field `settle` in `orbit.start`", "settle"],
        ["flow_tolerance: 1e-13", "flow_tolerance: 1e-3", "1e-3", "`system.flow_tolerance` is 0.001", "1e-16 to 0.0001"],
        ["periods: 2", "periods: 0", "0", "`orbit.periods` is 0", "1 to 1000"],
        ["Simulate(mode", "Simulat(mode", "Simulat", "did you mean `Simulate`?", ""],
        ["parameter: \"A\"", "parameter: \"B\"", "\"B\"", "`B` is no parameter; known: `c`", "parameter of `system`"],
        ["parameter: \"A\"", "parameter: A", "A", "a text in double quotes", "parameter: \"A\""],
        ["range: (0.2, 2.0)", "range: (2.0, 0.2)", "(2.0, 0.2)", "`continuation.range` is (2.0, 0.2)", "lower end first"],
        ["range: (0.2, 2.0)", "range: (0.2, 1.0)", "(0.2, 1.0)", "starts at A = 2.0, outside the range", "in the system"],
        ["range: (0.2, 2.0)", "range: (2.0, 3.0)", "Down", "the lower end of the range", "toward: Up"],
        ["stop_at: [0.8", "stop_at: [3.0", "3.0", "`continuation.stop_at` is 3.0", "from 0.2 to 2.0"],
        ["(A: 0.45)", "(c: 0.45)", "(c: 0.45)", "names `c`, but the branch is in `A`", "(A: 0.45)"],
        ["event: PD", "event: HB", "HB", "a HB is an event of waves of a tube", "LP, PD"],
        ["stability: (),", "", "PD", "no PD is found without the section `stability`", "stability: ()"],
        ["stability: ()", "stability: (sectors: All)", "sectors", "unknown field `sectors` in `stability`", ""],
        ["duration: 50.0", "duration: 0", "0", "`simulation.duration` is 0.0", "greater than 0"],
        ["samples: 100", "samples: 0", "0", "`simulation.samples` is 0", ""],
        ["mode: \"stick\"", "mode: \"stik\"", "\"stik\"", "did you mean `stick`?", ""],
        ["Time(\"x\")", "Time(\"y\")", "\"y\"", "`y` is no state", ""],
        ["Phase(\"x\", \"v\")", "Phase(\"x\", \"u\")", "\"u\"", "`u` is no state", ""],
        ["Phase(\"x\", \"v\")", "Phase(\"x\")", "Phase(\"x\")", "", ""],
        ["Column(\"max_x\")", "Column(\"max_y\")", "Column(\"max_y\")", "`output.plots` is", "max_x"],
        ["Diagram, ", "Pressure, ", "Pressure", "unknown choice `Pressure` for `output.plots`", ""],
        ["Diagram, ", "Diagram, Diagram, ", "Diagram", "listed twice", ""],
        ["profiles: 9", "profiles: 0", "Phase(\"x\", \"v\")", "shows nothing without profiles", "leave out `profiles: 0`"],
        ["profiles: 9", "profiles: 9, rotation: 3", "3", "`output.rotation` is for waves", "leave it out"],
        ["event: LP, A: 0.391117", "event: RV, A: 0.391117", "RV", "a RV is an event of waves", "GR"],
        ["event: LP, A: 0.391117", "event: LP, B: 0.391117", "B", "unknown field `B` in `expect`; known: `event`", "known names"],
        ["event: LP, A: 0.391117", "event: LP, A: 0.391117, A: 0.4", "A", "`A` is given twice in `expect`", "keep one"],
        ["event: LP, A: 0.391117", "event: LP, A: nan", "nan", "must be a number", ""],
        ["event: LP, A: 0.391117", "event: LP, A: NaN", "NaN", "`expect.A` is NaN", "finite"],
        ["event: LP, A: 0.391117", "event: LP, sector: 0, A: 0.391117", "0", "`sector` is expected of an orbit", "leave it out"],
        ["event: LP, A: 0.391117, ", "event: LP, ", "(event: LP, tolerance: 1e-6, regimes_before: \"free\", regimes_after: \"free\")", "nothing to compare this LP event with", "period"],
        ["event: LP, A: 0.391117", "event: LP, c: 0.1", "(event: LP, c: 0.1, tolerance: 1e-6, regimes_before: \"free\", regimes_after: \"free\")", "keeps them", "add `A`, which the branch changes"],
        ["event: LP, A: 0.391117", "event: LP, period: 6.28", "(event: LP, period: 6.28, tolerance: 1e-6, regimes_before: \"free\", regimes_after: \"free\")", "keeps them", "add `A`, which the branch changes"],
        ["{\"A\": 0.5}", "{\"B\": 0.5}", "\"B\"", "unknown field `B` in `expect`", ""],
        ["{\"A\": 0.5}", "{\"A\": inf}", "inf", "`expect.numbers.A` is inf", "finite"],
        ["(parameter: \"w\", range: (1.2, 1.8))", "(parameter: \"ww\", range: (1.2, 1.8))", "\"ww\"", "`ww` is no parameter", ""],
        ["(parameter: \"w\", range: (1.2, 1.8))", "(parameter: \"e\", range: (1.2, 1.8))", "\"e\"", "`map.second.parameter` is", "must be different"],
        ["range: (1.2, 1.8)", "range: (1.8, 1.2)", "(1.8, 1.2)", "`map.first.range` is", "the lower end first"],
        ["range: (1.2, 1.8)", "range: (-1.2, 1.8)", "-1.2", "the system makes no sense", "positive"],
        ["Grid(rows: 20,", "Grid(rows: 1,", "1", "`map.points.rows` is 1", ""],
        ["starts: [(mode: \"back\"", "starts: [(mode: \"bck\"", "\"bck\"", "`bck` is no mode", ""],
        ["state: {\"x\": 0.25, \"v\": -0.5}", "state: {\"x\": 0.25}", "{", "the state `v` is missing in `map.starts.0.state`", ""],
        ["    simulation: (", "    simulaton: (", "simulaton", "did you mean `simulation`?", ""],
        ["    title: ", "    model: (), title: ", "()", "`model` is given beside `system`, in whose place it stands", "keep one"],
        ["    title: ", "    wave: (), title: ", "()", "`wave` is given beside `orbit`", "keep one"],
        ["    title: ", "    method: Exact, title: ", "method", "`method` is for waves of a tube", "leave it out"],
        ["    orbit: (", "    orbti: (", "orbti", "did you mean `orbit`?", ""],
    ];
    assert_eq!(wrongly_refused(FULL, &cases).join("\n"), "");
    #[rustfmt::skip]
    let free = [
        ["state: {\"x\": 0}, period: 1", "state: {\"x\": 0}", "Given(", "missing field `period`", "period: 6.28"],
        ["period: 1", "period: 1, phase: 0.5", "0.5", "`orbit.start.phase` is 0.5", "no `forcing`"],
        ["period: 1)", "period: 1), periods: 2", "2", "`orbit.periods` is 2", "without `forcing`"],
        ["range: (0.5, 2)", "range: (0.5, 0.5)", "(0.5, 0.5)", "`continuation.range` is", ""],
        ["    orbit:", "    simulation: (duration: 1, start: (mode: \"up\", state: {})),\n    orbit:", "{", "the state `x` is missing in `simulation.start.state`", ""],
        ["    orbit: (start: Given(mode: \"up\", state: {\"x\": 0}, period: 1)),\n", "", "(", "missing field `orbit` in the problem", "orbit: (start: Simulate"],
    ];
    assert_eq!(wrongly_refused(FREE, &free).join("\n"), "");
    let text = edited(FREE, "system: (", "wave: (mode: 4), sistem: (");
    refused(&text, "(mode: 4)", "`wave` is given beside `orbit`", "");
    let given = edited(
        FULL,
        "Simulate(mode: \"free\", state: {\"x\": 0.5, \"v\": 0.25}, phase: 0.1, settle: 200)",
        "Given(mode: \"free\", state: {\"x\": 0.5, \"v\": 0.25}, period: 8.38)",
    );
    system(&given);
    refused(
        &given.replace("8.38", "4.2"),
        "4.2",
        "`orbit.start.period` is 4.2",
        "the period is 8.37",
    );
    // a forcing that stands still at an end of the range
    let text = FULL.replace("parameter: \"A\"", "parameter: \"w\"");
    let text = text
        .replace("range: (0.2, 2.0)", "range: (0.0, 2.0)")
        .replace("(A: 0.45)", "0.45");
    refused(
        &text,
        "0.0",
        "at w = 0.0, an end of the range",
        "in which it is positive",
    );
}

#[test]
fn a_tube_is_refused_in_the_words_of_a_tube() {
    let error = parse(FULL, "p.ron").unwrap_err();
    assert!(error.message().contains("a section `system`"), "{error}");
    assert!(error.message().contains("waves of a tube"), "{error}");
    assert_eq!((error.line(), error.column()), (Some(4), Some(5)));
    let tube = "(model: (coefficients: Given(a: 2, b: 1, D: 1, g: 1, h: 1), friction: 0.5, mismatch: 0.2), \
                wave: (mode: 4, start: Slow), @)";
    for (section, place, message) in [
        (
            "expect: [(event: PD, speed: 1, tolerance: 1e-6)]",
            "PD",
            "a PD is an event of orbits",
        ),
        (
            "output: (plots: [Phase(\"x\", \"v\")])",
            "Phase",
            "unknown choice `Phase`",
        ),
        (
            "expect: [(event: GR, A: 1, tolerance: 1e-6)]",
            "A",
            "unknown field `A` in `expect`",
        ),
    ] {
        refused(&tube.replace('@', section), place, message, "");
    }
    parse(&tube.replace('@', ""), "p.ron").unwrap();
}

#[test]
fn every_field_has_an_example_that_is_right() {
    let sections = [
        ("", "(@, orbit: ())"),
        ("system", "(system: (@))"),
        ("system.modes.m", "(system: (modes: {\"m\": (@)}))"),
        (
            "system.modes.m.until",
            "(system: (modes: {\"m\": (until: [(@)])}))",
        ),
        ("orbit", "(orbit: (@))"),
        ("orbit.start", "(orbit: (start: Simulate(@)))"),
        ("orbit.start", "(orbit: (start: Given(@)))"),
        ("orbit.start", "(orbit: (start: Restart(@)))"),
        ("orbit.start", "(orbit: (start: Switch(@)))"),
        ("continuation", "(continuation: (@), orbit: ())"),
        ("curve", "(curve: (@), orbit: ())"),
        ("simulation", "(simulation: (@), orbit: ())"),
        ("simulation.start", "(simulation: (start: (@)), orbit: ())"),
        ("output", "(output: (@), orbit: ())"),
    ];
    for (home, section) in sections {
        let error = parse_any(&section.replace('@', "zzzzzzzz: 1"), "p.ron").unwrap_err();
        let (_, known) = error.message().split_once("known: ").expect(home);
        for field in known.split(", ").map(|field| field.trim_matches('`')) {
            // those of tubes are refused later, in words
            if ["orbit", "conditioning", "rotation"].contains(&field) {
                continue;
            }
            let example = example(Subject::System, home, field).expect(field);
            let error = parse_any(&section.replace('@', &example), "p.ron").unwrap_err();
            assert!(error.message().starts_with("missing field"), "{error}");
        }
    }
    let shown = example(Subject::System, "expect", "numbers").unwrap();
    system(&edited(FULL, "numbers: {\"A\": 0.5}", &shown));
}

/// A rotation of two halves, as fast as a prescribed period asks for.
const PRESCRIBED: &str = r#"(
    system: (
        states: ["x", "y"],
        parameters: {"c": 1.3, "n": 2.0, "m": 1.0},
        define: {"r": "m - x^2 - y^2"},
        modes: {
            "up": (rates: {"x": "-c*y + x*r", "y": "c*x + y*r"}, until: [(zero: "y", to: "down")]),
            "down": (rates: {"x": "-c*y + x*r", "y": "c*x + y*r"}, until: [(zero: "-y", to: "up")]),
        },
    ),
    orbit: (start: Given(mode: "up", state: {"x": 1, "y": 0}, period: 4.8), period: "2*pi/n", free: "c"),
    continuation: (parameter: "n", range: (0.5, 4)),
    expect: [(event: EP, c: 4, tolerance: 1e-9)],
)"#;

#[test]
fn a_prescribed_period_is_read() {
    let problem = system(PRESCRIBED);
    // a parameter that stands in the period alone counts as used
    assert_eq!(problem.orbit.period.as_deref(), Some("2*pi/n"));
    let prescribed = problem.prescribed().unwrap();
    let period = prescribed.period(&problem.values(), &[1, 0]).unwrap();
    let pi = std::f64::consts::PI;
    assert_eq!((period.value, period.by), (pi, [-pi / 2.0, 0.0]));
    #[rustfmt::skip]
    let cases = [
        [", free: \"c\"", "", "(", "missing field `free` in `orbit`", "free: \"c\""],
        [", period: \"2*pi/n\"", "", "(", "missing field `period` in `orbit`", "leave out `free`"],
        ["free: \"c\"", "free: \"cc\"", "\"cc\"", "`cc` is no parameter", "parameter of `system`"],
        ["2*pi/n", "2*pi/k", "k", "`k` is no parameter", "the parameters are `c`"],
        ["2*pi/n", "2*pi/x", "x", "`x` is no parameter", "the parameters are `c`"],
        ["2*pi/n", "2*pi/r", "r", "`r` is no parameter", "the parameters are `c`"],
        ["2*pi/n", "2*pi/", "\"", "makes no sense from here on", "an expression has"],
        ["2*pi/n", "-2*pi/n", "\"-2*pi/n\"", "it must be positive", "change the parameters"],
        ["2*pi/n", "2*pi/(n - 2)", "2*pi/(n - 2)", "not a finite number", "division by zero"],
        ["free: \"c\"", "free: \"n\"", "\"n\"", "`continuation.parameter` is", "take another one"],
        ["states: [", "forcing: \"m\", states: [", "\"2*pi/n\"", "`forcing` has one", "leave out one"],
        ["Given(mode: \"up\", state: {\"x\": 1, \"y\": 0}, period: 4.8)", "Switch(dir: \"d\", label: 2)", "Switch(dir: \"d\", label: 2)", "not prescribed", "`free`"],
        ["    expect:", "    curve: (event: LP, parameters: (\"n\", \"c\"), range: ((1, 2), (1, 2))),\n    expect:", "\"c\"", "`curve.parameters` is", "take another one"],
    ];
    assert_eq!(wrongly_refused(PRESCRIBED, &cases).join("\n"), "");
}
