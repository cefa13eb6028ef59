//! Tests of problem files and of what is said about those that are refused.

use std::time::{Duration, Instant};

use super::continuation::{DEFAULT_MAX_POINTS, DEFAULT_MAX_POINTS_INTEGRATED};
use super::template::{OPTIONAL, TEMPLATE};
use super::*;
use crate::continuation::{DEFAULT_DS, DEFAULT_DS_MAX, DEFAULT_DS_MIN, DEFAULT_TOLERANCE};
use crate::orbit::EventType;
use crate::simulation::task::{DEFAULT_COURANT, SimulationStart};
use crate::tube::model::{Damping, FrictionLaw, Impact, Parameter};

/// Every field of the format, each on a line of its own or nearly so.
const FULL: &str = r#"// Каждое поле — every field, with "quotes" and ( in a comment
(
    title: "Mode 4: (brackets] in a \"title\"",
    model: ( /* a /* nested */ friction: 9 */
        coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
        friction: 0.5,
        mismatch: 0.2,
        damping: (mass: 0.01, stiffness: 0.02),
        impact: Coulomb,
    ),
    wave: (mode: 4, start: Fast),
    continuation: (
        parameter: Mismatch,
        range: (0.004, 0.2),
        toward: Down,
        stop_at: [0.08, (mismatch: 0.045)],
        ds: 0.001,
        ds_min: 1e-10,
        ds_max: 0.01,
        max_points: 500,
        tolerance: 1e-9,
        stop_after: [(event: HB, count: 1)],
    ),
    stability: (sectors: Only([0, 2]), eigenvalues: 8, max_frequency: 10.0),
    map: (
        first: (parameter: Friction, range: (0.1, 0.9)),
        second: (parameter: MassDamping, range: (0.25, 0.45)),
        points: Grid(rows: 3, columns: 5),
        starts: [Slow],
    ),
    output: (plots: [Diagram, Column("amplitude"), PhasePlane, Friction], profiles: 9),
    expect: [
        (event: GR, mismatch: 0.05, speed: -1.2, tolerance: 1e-9),
        (event: HB, sector: 0, omega: 2.5, friction: 0.5, mass_damping: 0, tolerance: 1e-9,
         stiffness_damping: 0.0, gamma: 1.0, nu: 0.3, xi: 1.5, regimes_before: "slip",
         regimes_after: "slip-stick", label: 7),
    ],
)
"#;

/// `FULL` with one text replaced.
fn edited(from: &str, to: &str) -> String {
    assert_eq!(FULL.matches(from).count(), 1, "{from}");
    FULL.replace(from, to)
}

/// The text above the carets.
pub(super) fn marked(error: &ProblemError) -> String {
    let display = error.to_string();
    let lines: Vec<&str> = display.lines().collect();
    let columns = lines[1].chars().zip(lines[2].chars());
    columns
        .filter(|(_, mark)| *mark == '^')
        .map(|(c, _)| c)
        .collect()
}

/// Asserts that the text is refused at the marked place with these words.
pub(super) fn refused(text: &str, place: &str, message: &str, help: &str) -> ProblemError {
    let error = parse_any(text, "p.ron").expect_err(text);
    let display = error.to_string();
    assert_eq!(marked(&error), place, "{display}");
    assert!(
        error.message().contains(message),
        "{display}\nlacks {message}"
    );
    assert!(error.help().contains(help), "{display}\nlacks {help}");
    error
}

fn coefficients(given: &str) -> String {
    edited("Geometry(nu: 0.3, xi: 1.5, gamma: 1.0)", given)
        .replace("gamma: 1.0, nu: 0.3, xi: 1.5, ", "")
}

#[test]
fn template_parses() {
    let problem = parse(TEMPLATE, "template.ron").unwrap();
    assert_eq!(problem.wave.mode, 4);
    assert_eq!(problem.wave.start, Start::Fast);
    assert_eq!(problem.model.damping, Damping::default());
    assert_eq!(problem.model.impact, Impact::Frictionless);
    assert_eq!(problem.stability, None);
    assert_eq!(problem.output.profiles, 9);
    // as many where a plot shows some and the file does not say
    let unsaid = parse(&edited(", profiles: 9", ""), "unsaid").unwrap();
    assert_eq!(unsaid.output.profiles, 9);
    let none = edited("PhasePlane, Friction], profiles: 9", "]");
    assert_eq!(parse(&none, "none").unwrap().output.profiles, 0);
    let mut expected = problem.expect[0].numbers();
    assert!(expected.any(|number| number == ("mismatch", 0.05022841036275642)));
    let continuation = problem.continuation(TEMPLATE, "template.ron").unwrap();
    assert_eq!(continuation.stop_at, [0.08, 0.045]);
    assert_eq!(continuation.ds, DEFAULT_DS);
    assert_eq!(continuation.ds_min, DEFAULT_DS_MIN);
    assert_eq!(continuation.ds_max, DEFAULT_DS_MAX);
    assert_eq!(continuation.max_points, None);
    assert_eq!(
        continuation.most_points(FrictionLaw::Coulomb),
        DEFAULT_MAX_POINTS
    );
    let smooth = FrictionLaw::Regularised { epsilon: 0.1 };
    assert_eq!(
        continuation.most_points(smooth),
        DEFAULT_MAX_POINTS_INTEGRATED
    );
    assert_eq!(continuation.tolerance, DEFAULT_TOLERANCE);
}

/// Eigenvalues are proportional to 1/√γ, and so is the window where the file gives none.
#[test]
fn the_window_of_stability_fits_the_model() {
    let window = |gamma: &str, section: &str| {
        let text = TEMPLATE
            .replace("gamma: 1.0", &format!("gamma: {gamma}"))
            .replace(
                "    output:",
                &format!("    stability: {section},\n    output:"),
            );
        let problem = parse(&text, "p.ron").unwrap();
        problem.request().unwrap().max_frequency
    };
    assert_eq!(window("1.0", "()").to_bits(), 12.0_f64.to_bits());
    assert_eq!(window("0.0625", "(sectors: All)"), 48.0);
    assert_eq!(window("0.0625", "(max_frequency: 12.0)"), 12.0);
}

#[test]
fn optional_lines_of_the_template_are_right() {
    let all = template(&OPTIONAL);
    assert_eq!(template(&["continuation", "expect"]), TEMPLATE);
    for section in OPTIONAL {
        let with = parse(&template(&[section]), "p.ron").unwrap();
        let given = [
            with.continuation.is_some(),
            with.stability.is_some(),
            with.map.is_some(),
            with.curve.is_some(),
            with.simulation.is_some(),
            !with.expect.is_empty(),
        ];
        assert_eq!(given, OPTIONAL.map(|one| one == section), "{section}");
    }
    let lines: Vec<String> = all
        .lines()
        .map(|line| match line.trim_start().strip_prefix("// ") {
            Some(rest) if COMMENTED_FIELDS.iter().any(|field| rest.starts_with(field)) => {
                rest.to_owned()
            }
            _ => line.to_owned(),
        })
        .collect();
    let problem = parse(&lines.join("\n"), "template.ron").unwrap();
    assert_eq!(problem.stability, Some(StabilitySection::default()));
    let continuation = problem.continuation.unwrap();
    assert_eq!(continuation.stop_after.len(), 1);
    assert_eq!(continuation.ds_max, DEFAULT_DS_MAX);
    let map = problem.map.unwrap();
    assert_eq!(map.starts.0, [Start::Fast, Start::Slow]);
    assert_eq!(problem.curve.unwrap().event, CurveEvent::GR);
    assert_eq!(problem.method, Some(Method::Exact));
    assert_eq!(problem.simulation.unwrap().courant, DEFAULT_COURANT);
}

const COMMENTED_FIELDS: [&str; 10] = [
    "friction_law: ",
    "method: ",
    "damping: ",
    "impact: ",
    "ds: ",
    "ds_min: ",
    "ds_max: ",
    "max_points: ",
    "stop_after: ",
    "stability: ",
];

#[test]
fn every_field_is_read() {
    let problem = parse(FULL, "p.ron").unwrap();
    assert_eq!(problem.model.damping.stiffness, 0.02);
    assert_eq!(problem.model.impact, Impact::Coulomb);
    let continuation = problem.continuation.as_ref().unwrap();
    assert_eq!(continuation.stop_at, [0.08, 0.045]);
    assert_eq!(continuation.stop_after[0].event, EventType::HB);
    assert_eq!(
        problem.stability.as_ref().unwrap().sectors,
        Sectors::Only(vec![0, 2])
    );
    assert_eq!(
        problem.output.plots[1],
        Plot::Column("amplitude".to_owned())
    );
    assert_eq!(problem.expect[1].label, Some(7));
    assert_eq!(problem.expect[1].numbers().count(), 7);
}

#[test]
fn every_field_has_an_example_that_is_right() {
    let sections = [
        ("", "(@)"),
        ("model", "(model: (@))"),
        ("model.coefficients", "(model: (coefficients: Geometry(@)))"),
        ("model.coefficients", "(model: (coefficients: Given(@)))"),
        ("model.damping", "(model: (damping: (@)))"),
        ("wave", "(wave: (@))"),
        ("wave.start", "(wave: (start: Restart(@)))"),
        ("continuation", "(continuation: (@))"),
        (
            "continuation.stop_after",
            "(continuation: (stop_after: [(@)]))",
        ),
        ("stability", "(stability: (@))"),
        ("curve", "(curve: (@))"),
        ("map", "(map: (@))"),
        ("map.first", "(map: (first: (@)))"),
        ("map.second", "(map: (second: (@)))"),
        ("map.points", "(map: (points: Grid(@)))"),
        ("map.points", "(map: (points: QuasiRandom(@)))"),
        ("simulation", "(simulation: (@))"),
        ("simulation.body", "(simulation: (body: Ring(@)))"),
        ("simulation.body", "(simulation: (body: Annulus(@)))"),
        ("simulation.start", "(simulation: (start: Wave(@)))"),
        ("simulation.start", "(simulation: (start: Profile(@)))"),
        (
            "simulation.perturbation",
            "(simulation: (perturbation: (@)))",
        ),
        ("simulation.growth", "(simulation: (growth: (@)))"),
        ("output", "(output: (@))"),
        ("tube", "(tube: (@))"),
        ("tube.damping", "(tube: (damping: (@)))"),
        ("expect", "(expect: [(@)])"),
    ];
    for (home, section) in sections {
        let error = parse(&section.replace('@', "zzzzzzzz: 1"), "p.ron").unwrap_err();
        let (_, known) = error.message().split_once("known: ").unwrap();
        for field in known.split(", ").map(|field| field.trim_matches('`')) {
            let example = examples::example(Subject::Tube, home, field).expect(field);
            let error = parse(&section.replace('@', &example), "p.ron").unwrap_err();
            assert!(error.message().starts_with("missing field"), "{error}");
        }
    }
    let known = |field| examples::home(Subject::Tube, field).unwrap();
    assert_eq!([known("wave"), known("ds")], ["", "continuation"]);
}

#[test]
fn maps_are_checked() {
    let problem = parse(FULL, "p.ron").unwrap();
    let map = problem.map.unwrap();
    assert_eq!(map.second.parameter, Parameter::MassDamping);
    assert_eq!(
        map.points,
        MapPoints::Grid {
            rows: 3,
            columns: 5
        }
    );
    let scattered = edited("Grid(rows: 3, columns: 5)", "QuasiRandom(count: 7)");
    let scattered = parse(&scattered, "p.ron").unwrap().map.unwrap();
    assert_eq!(scattered.points, MapPoints::QuasiRandom { count: 7 });
    for (from, to, place, message) in [
        (
            "range: (0.1, 0.9)",
            "range: (0.9, 0.1)",
            "(0.9, 0.1)",
            "`map.first.range` is",
        ),
        (
            "range: (0.1, 0.9)",
            "range: (-0.1, 0.9)",
            "-0.1",
            "`map.first.range` is",
        ),
        (
            "range: (0.25, 0.45)",
            "range: (0.25, -0.45)",
            "-0.45",
            "`map.second.range` is",
        ),
        (
            "parameter: MassDamping",
            "parameter: Friction",
            "Friction",
            "`map.second.parameter` is",
        ),
        ("rows: 3", "rows: 1", "1", "`map.points.rows` is 1"),
        (
            "columns: 5",
            "columns: 1000000",
            "1000000",
            "`map.points.columns` is",
        ),
        (
            "Grid(rows: 3, columns: 5)",
            "QuasiRandom(count: 0)",
            "0",
            "`map.points.count` is 0",
        ),
        ("[Slow]", "[]", "[]", "`map.starts` is"),
        ("[Slow]", "[Slow, Slow]", "Slow", "`map.starts` is Slow"),
    ] {
        refused(&edited(from, to), place, message, "");
    }
    let unknown = edited("columns: 5", "colums: 5");
    let error = parse(&unknown, "p.ron").unwrap_err();
    assert_eq!(marked(&error), "colums");
    let none = parse(TEMPLATE, "p.ron")
        .unwrap()
        .map(TEMPLATE, "p.ron")
        .unwrap_err();
    assert!(none.message().contains("missing field `map`"), "{none}");
}

#[test]
fn parameters_by_column() {
    for parameter in Parameter::ALL {
        assert_eq!(Parameter::from_column(parameter.column()), Some(parameter));
        assert!(!parameter.symbol().is_empty());
    }
    assert_eq!(Parameter::from_column("speed"), None);
    let model = parse(FULL, "p.ron").unwrap().model;
    let values = Parameter::ALL.map(|parameter| model.value(parameter));
    let expected = [0.2, 0.5, 0.01, 0.02, 1.0, 0.3, 1.5].map(Some);
    assert_eq!(values[..7], expected);
    // only the regularised law has a smoothing
    assert_eq!(values[7], None);
    let given = parse(
        &coefficients("Given(a: 2, b: 1, D: -1, g: 1, h: 1)"),
        "p.ron",
    )
    .unwrap()
    .model;
    assert_eq!(given.value(Parameter::Nu), None);
    assert_eq!(given.value(Parameter::Friction), Some(0.5));
}

#[test]
fn problems_survive_a_round_trip() {
    let restart = edited("start: Fast", "start: Restart(dir: \"r/x\", label: 3)");
    let given = coefficients("Given(a: 2, b: 1, D: -1e-300, g: 0.1, h: 1)");
    let simulated = |section: &str| {
        let model =
            "coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1), friction: 0.5, mismatch: 1";
        format!("(model: ({model}), wave: (mode: 4, start: Fast), simulation: ({section}))")
    };
    let ring = simulated(
        "body: Ring(points: 96, order: Sixth, friction: Tanh(epsilon: 0.01)), circle: Wavelength, \
         start: Wave(dir: \"r/x\", label: 3), perturbation: (mode: 8, amplitude: 1e-3), duration: 1, \
         courant: 0.1, every: 0.1, snapshots: 2, growth: (sectors: Only([0, 2]), pairs: 9)",
    );
    let tube = simulated("body: Annulus(around: 64, across: 4), start: SteadySliding, duration: 9");
    let own = ring.replace(
        "Wave(dir: \"r/x\", label: 3)",
        "/* of its own */ Wave // bare\n",
    );
    let parsed = parse(&own, "p.ron").unwrap().simulation.unwrap();
    assert_eq!(parsed.start, SimulationStart::OwnWave);
    // what is shown, and counted, is the text as it was written
    let wrong = own
        .replace("// bare\n", "")
        .replace("points: 96", "points: 0");
    let marked = wrong.find("points: 0").unwrap() + "points: ".len();
    assert_eq!(
        parse(&wrong, "p.ron").unwrap_err().column(),
        Some(marked + 1)
    );
    let wrong = own.replace("// bare\n, ", ", duratoin: 1, ");
    refused(&wrong, "duratoin", "unknown field `duratoin`", "duration");
    for start in [
        "Wave(dir: \"r/x\")",
        "Wave()",
        "Wave(3)",
        "OwnWave",
        "Wave(dir: \"r/x\", label: -3)",
    ] {
        let error = parse(
            &own.replace("/* of its own */ Wave // bare\n", start),
            "p.ron",
        )
        .unwrap_err();
        assert!(error.to_string().contains(start), "{error}");
    }
    for text in [FULL, TEMPLATE, &restart, &given, &ring, &tube, &own] {
        let problem = parse(text, "p.ron").unwrap();
        let stored = ron::to_string(&problem).unwrap();
        assert_eq!(ron::from_str::<Problem>(&stored).unwrap(), problem);
        let pretty = options()
            .to_string_pretty(&problem, ron::ser::PrettyConfig::default())
            .unwrap();
        assert_eq!(options().from_str::<Problem>(&pretty).unwrap(), problem);
    }
}

#[test]
fn user_points_keep_all_digits() {
    for value in ["0.1", "0.049999999999999996", "1e-2", "0.05022841036275642"] {
        let text = edited("0.08, (mismatch: 0.045)", value);
        let continuation = parse(&text, "p.ron").unwrap().continuation.unwrap();
        assert_eq!(continuation.stop_at, [value.parse::<f64>().unwrap()]);
    }
}

#[test]
fn optional_forms_are_accepted() {
    for (from, to) in [
        (
            "title: \"Mode 4: (brackets] in a \\\"title\\\"\",",
            "title: Some(r#\"a \"b\" ( \"#),",
        ),
        ("model: (", "model: Model("),
        (
            "damping: (mass: 0.01, stiffness: 0.02)",
            "damping: (mass: 0.1)",
        ),
        ("damping: (mass: 0.01, stiffness: 0.02)", "damping: ()"),
        ("mode: 4", "r#mode: 4"),
        (
            "[Diagram, Column(\"amplitude\"), PhasePlane, Friction]",
            "[]",
        ),
        ("toward: Down,", ""),
        (
            "(sectors: Only([0, 2]), eigenvalues: 8, max_frequency: 10.0)",
            "(eigenvalues: 8)",
        ),
    ] {
        parse(&edited(from, to), "p.ron").unwrap();
        let windows = edited(from, to).replace('\n', "\r\n");
        parse(&windows, "p.ron").unwrap();
    }
    parse(&format!("\u{FEFF}{FULL}"), "p.ron").unwrap();
    let headed = FULL.replacen("(\n", "#![enable(implicit_some)]\nProblem (\n", 1);
    parse(&headed, "p.ron").unwrap();
    let headed = headed.replace("mode: 4", "mode: 0");
    refused(&headed, "0", "`wave.mode` is 0", "");
}

#[test]
fn structure_errors_point_and_explain() {
    #[rustfmt::skip]
    let cases = [
        // (text, replacement, marked, message, help)
        ("        friction: 0.5,\n", "frcition: 0.5,\n", "frcition", "unknown field `frcition` in `model`; did you mean `friction`? known: `coefficients`", "friction: 0.5"),
        ("start: Fast", "start: Fsat", "Fsat", "did you mean `Fast`? known: `Fast`, `Slow`", "start: Fast"),
        ("start: Fast", "start: fast", "fast", "did you mean `Fast`?", ""),
        ("start: Fast", "start: \"Fast\"", "\"Fast\"", "must be a name", "without quotes"),
        ("start: Fast", "start: Fast()", "Fast()", "without parentheses", "`start: Fast`"),
        ("start: Fast", "start: Restart", "Restart", "must be followed by", "label: 3"),
        ("start: Fast", "start: Restart(dir: \"x\")", "Restart(", "missing field `label` in `wave.start`", "label: 3"),
        ("start: Fast", "start: Restart(dir: 3, label: 1)", "3", "must be a text", "dir: "),
        ("start: Fast", "start: 7", "7", "`wave.start` must be a name, found `7`", ""),
        ("event: HB, count", "event: XX, count", "XX", "unknown choice `XX` for `continuation.stop_after.event`", "LP fold"),
        ("(event: GR", "(event: Gr", "Gr", "did you mean `GR`?", "take-off"),
        ("mode: 4,", "mode: -4,", "-4", "a whole number from 0 up, but not too large, found `-4`", "mode: 4"),
        ("mode: 4,", "mode: 4294967296,", "4294967296", "not too large", "mode: 4"),
        ("mode: 4,", "mode: 4.5,", "4.5", "a whole number from 0 up, found `4.5`", "mode: 4"),
        ("mode: 4,", "mode: four,", "four", "a whole number from 0 up, found `four`", "mode: 4"),
        ("mode: 4,", "mode: ,", ",", "a whole number from 0 up should stand before `,`", "mode: 4"),
        ("mode: 4,", "mode = 4,", "=", "`:` should stand before `=`", "name: value"),
        ("mode: 4,", "mode: 4, mode: 5,", "mode", "`mode` is given twice in `wave`", "keep one"),
        ("mode: 4,", "4,", "4", "`wave` holds named fields, found `4`", "name: value"),
        ("mode: 4,", "mo-de: 4,", "mo-de", "`wave` holds named fields, found `mo-de`", "name: value"),
        ("mode: 4,", "\"mode\": 4,", "\"mode\"", "`wave` holds named fields, found `\"mode\"`", "name: value"),
        ("mode: 4,", "", "(", "missing field `mode` in `wave`", "mode: 4"),
        ("        friction: 0.5,\n", "friction: \"0.5\",\n", "\"0.5\"", "must be a number, found `\"0.5\"`", "without quotes"),
        ("        friction: 0.5,\n", "friction: 0,5,\n", "5", "holds named fields, found `5`", "decimal point"),
        ("range: (0.004, 0.2)", "range: [0.004, 0.2]", "[0.004, 0.2]", "values in parentheses", "range: (0.004, 0.2)"),
        ("range: (0.004, 0.2)", "range: (0.004)", "(0.004)", "two numbers in parentheses, found `(0.004)`", ""),
        ("range: (0.004, 0.2)", "range: (0.004, 0.2, 1)", "1", "`)` should stand before `1`", ""),
        ("range: (0.004, 0.2)", "range: (0.004, abc)", "abc", "must be a number, found `abc`", "range: (0.004, 0.2)"),
        ("range: (0.004, 0.2),", "", "(", "missing field `range` in `continuation`", "range: (0.004, 0.2)"),
        ("stop_at: [0.08, (mismatch: 0.045)]", "stop_at: 0.08", "0.08", "a list in square brackets", "stop_at: ["),
        ("(mismatch: 0.045)", "(mismatch: 0.045, mismatch: 0.05)", "(mismatch: 0.045, mismatch: 0.05)", "one named number", ""),
        ("(mismatch: 0.045)", "(mismatch: x)", "x", "must be a number", ""),
        ("(mismatch: 0.045)", "()", "()", "one named number", ""),
        ("(mismatch: 0.045)", "\"0.045\"", "\"0.045\"", "an entry of `continuation.stop_at`", "without quotes"),
        ("Only([0, 2])", "Only(0)", "0", "a list", ""),
        ("Only([0, 2])", "Only", "Only", "must be followed by", "Only([0, 2])"),
        ("Column(\"amplitude\")", "Column(amplitude)", "amplitude", "a text in double quotes", "Column("),
        ("Column(\"amplitude\")", "Colum(\"amplitude\")", "Colum", "did you mean `Column`?", ""),
        ("Geometry(nu: 0.3, xi: 1.5, gamma: 1.0)", "Given(a: 2, b: 1, d: 1, g: 1, h: 1)", "d", "did you mean", ""),
        ("Geometry(nu: 0.3, xi: 1.5, gamma: 1.0)", "(nu: 0.3, xi: 1.5, gamma: 1.0)", "(nu: 0.3, xi: 1.5, gamma: 1.0)", "`model.coefficients` must be a name", "Geometry"),
        ("sector: 0, ", "sectors: 0, ", "sectors", "did you mean `sector`?", ""),
        ("    wave: (mode: 4, start: Fast),\n", "    wave: (mode: 4, start: Fast, ds: 1),\n", "ds", "unknown field `ds` in `wave`", "`ds` belongs to `continuation`"),
        ("wave: (mode: 4, start: Fast)", "wave: Wvae(mode: 4, start: Fast)", "Wvae(mode: 4, start: Fast)", "a section of fields", "wave: (mode"),
        ("wave: (mode: 4, start: Fast)", "wave: {mode: 4}", "{mode: 4}", "a section of fields", "wave: (mode"),
        ("title: \"", "title: 'x', a: \"", "'x'", "a text in double quotes", "title: \"Mode 4\""),
        ("damping: (mass: 0.01, stiffness: 0.02)", "damping: None", "None", "a section of fields", "damping: ("),
        ("        friction: 0.5,\n", "friction: 0.24Some(1),\n", "0.24Some(1)", "must be a number, found `0.24Some(1)`", "friction: 0.5"),
        ("        friction: 0.5,\n", "friction: 24Some(1),\n", "24Some(1)", "must be a number, found `24Some(1)`", "friction: 0.5"),
        ("        friction: 0.5,\n", "friction: 0.5$x,\n", "0.5$x", "must be a number", "friction: 0.5"),
        ("        friction: 0.5,\n", "friction: 1/5,\n", "/", "there is no arithmetic", "`friction: 0.5`; 1/5 is 0.2"),
        ("        friction: 0.5,\n", "friction: ½,\n", "½", "must be a number, found `½`", "friction: 0.5"),
        ("stop_at: [0.08,", "stop_at: [∞,", "∞", "`∞` makes no sense here", "stop_at: ["),
        ("stop_at: [0.08,", "stop_at: [1e5e,", "1e5e", "must be a number, found", "stop_at: [0.08"),
        ("range: (0.1, 0.9)", "range: (4u32, 0.9)", "4u32", "must be a number, found", "range: (0.1"),
        ("mode: 4,", "mode: 4(1,2),", "4(1,2)", "a whole number from 0 up", "mode: 4"),
        ("first: (parameter: Friction, range: (0.1, 0.9)),", "first: 'a'parameter: Friction,", "'a'parameter", "should stand here", "map: (first: (parameter"),
    ];
    for (from, to, place, message, help) in cases {
        refused(&edited(from, to), place, message, help);
    }
    // Left to the words of `ron`; only the line is certain.
    let escape = parse(&edited("title: \"", "title: \"\\q"), "p.ron").unwrap_err();
    assert_eq!(escape.line(), Some(3));
}

#[test]
fn missing_sections_are_named() {
    refused(
        "()",
        "(",
        "missing field `model` in the problem",
        "model: (coefficients: Geometry",
    );
    let text = "(model: (coefficients: Given(a: 2, b: 1, D: 1, g: 1, h: 1), friction: 0.5, \
                mismatch: 0.2), wave: (mode: 4, start: Slow))";
    let problem = parse(text, "p.ron").unwrap();
    assert_eq!(problem.output, Output::default());
    let error = problem.continuation(text, "p.ron").unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("p.ron:1:1: missing field `continuation`"),
        "{error}"
    );
    assert!(error.help().contains("continuation: (parameter: Mismatch"));
}

#[test]
fn syntax_errors_point_and_explain() {
    for empty in ["", " \n\t ", "// only a comment", "/* one */ \n"] {
        let error = parse(empty, "p.ron").unwrap_err().to_string();
        assert!(error.starts_with("p.ron:1:1: the file is empty"), "{error}");
    }
    let unclosed = edited(
        "        impact: Coulomb,\n    ),",
        "        impact: Coulomb,",
    );
    let help = "`wave` belongs to the problem; is a bracket out of place?";
    refused(&unclosed, "wave", "unknown field `wave` in `model`", help);
    let comma = edited("parameter: Mismatch,", "parameter: Mismatch");
    refused(&comma, "range", "`,` should stand before `range`", "commas");
    let crossed = edited("Only([0, 2])", "Only([0, 2))");
    refused(&crossed, ")", "does not close the `[` of line 24", "`]`");
    let comment = edited("title: \"", "/* title: \"");
    refused(&comment, "/", "comment that begins here never ends", "*/");
    refused("(title: \"abc", "\"", "never ends", "\"");
    refused("(title: r##\"abc\"#)", "r", "never ends", "#");
    let open = edited("in a \\\"title\\\"\",", "in");
    let error = parse(&open, "p.ron").unwrap_err();
    assert!(error.message().contains("several lines"), "{error}");
    assert_eq!(error.line(), Some(3));
    refused(
        "title: \"a\"",
        "title",
        "in parentheses should stand",
        "brakewave new",
    );
    refused("(title: \"a\"", "(", "never closed", "close");
    refused("(title:", "(", "never closed", "close");
    refused("(title: , )", ",", "should stand before `,`", "");
    refused(
        "(title: §)",
        "§",
        "must be a text in double quotes, found `§`",
        "",
    );
    refused("(title:\u{A0}\"a\")", "\u{A0}", "must be a text", "");
    refused(&format!("{FULL})"), ")", "not open", "one too many");
    refused(
        "hello",
        "hello",
        "the problem must be a section",
        "brakewave new",
    );
    refused("[1]", "[1]", "the problem must be a section", "");
}

#[test]
fn values_are_checked() {
    #[rustfmt::skip]
    let cases = [
        ("nu: 0.3, xi: 1.5, gamma: 1.0)", "nu: 0.5, xi: 1.5, gamma: 1.0)", "0.5", "`model.coefficients.nu` is 0.5", "between -1 and 0.5"),
        ("nu: 0.3, xi: 1.5, gamma: 1.0)", "nu: -1, xi: 1.5, gamma: 1.0)", "-1", "", "between"),
        ("nu: 0.3, xi: 1.5, gamma: 1.0)", "nu: NaN, xi: 1.5, gamma: 1.0)", "NaN", "is NaN", "between"),
        ("nu: 0.3, xi: 1.5, gamma: 1.0)", "nu: 0.3, xi: 1, gamma: 1.0)", "1", "coefficients.xi", "greater than 1"),
        ("nu: 0.3, xi: 1.5, gamma: 1.0)", "nu: 0.3, xi: 1.5, gamma: 0)", "0", "gamma", "greater than 0"),
        ("        friction: 0.5", "        friction: -0.5", "-0.5", "`model.friction` is -0.5", "at least 0"),
        ("        friction: 0.5", "        friction: inf", "inf", "is inf", "finite"),
        ("        friction: 0.5", "        friction: 1e999", "1e999", "is inf", "finite"),
        ("        mismatch: 0.2", "        mismatch: 0", "0", "`model.mismatch` is 0.0", "greater than 0"),
        ("mass: 0.01", "mass: -0.01", "-0.01", "model.damping.mass", "at least 0"),
        ("stiffness: 0.02", "stiffness: -inf", "-inf", "model.damping.stiffness", ""),
        ("mode: 4,", "mode: 0,", "0", "`wave.mode` is 0", "1 to 4096"),
        ("mode: 4,", "mode: 4097,", "4097", "4097", "4096"),
        ("start: Fast", "start: Restart(dir: \"\", label: 1)", "\"\"", "`wave.start.dir` is", "directory"),
        ("range: (0.004, 0.2)", "range: (0.2, 0.004)", "(0.2, 0.004)", "`continuation.range` is (0.2, 0.004)", "lower end first"),
        ("range: (0.004, 0.2)", "range: (0.2, 0.2)", "(0.2, 0.2)", "is (0.2, 0.2)", ""),
        ("range: (0.004, 0.2)", "range: (0, 0.2)", "0", "`continuation.range` is 0.0", "greater than 0"),
        ("range: (0.004, 0.2)", "range: (0.004, inf)", "inf", "is inf", "finite"),
        ("range: (0.004, 0.2)", "range: (0.004, 0.1)", "(0.004, 0.1)", "starts at mismatch = 0.2, outside", "widen"),
        ("range: (0.004, 0.2)", "range: (0.2, 0.4)", "Down", "the lower end of the range", "toward: Up"),
        ("toward: Down", "toward: Up", "Up", "the upper end", "toward: Down"),
        ("stop_at: [0.08", "stop_at: [0.3", "0.3", "stop_at` is 0.3", "from 0.004 to 0.2"),
        ("(mismatch: 0.045)", "(friction: 0.045)", "(friction: 0.045)", "names `friction`, but the branch is in `mismatch`", "(mismatch: 0.045)"),
        ("(mismatch: 0.045)", "(mismatch: NaN)", "(mismatch: NaN)", "is NaN", "finite"),
        ("ds: 0.001", "ds: 0", "0", "`continuation.ds` is 0.0", "greater than 0"),
        ("ds_min: 1e-10", "ds_min: 0.5", "0.5", "`ds_min` is 0.5 but `ds_max` is 0.01", "ds_min <= ds <= ds_max"),
        ("ds_min: 1e-10", "ds_min: 0.005", "0.005", "`ds_min` is 0.005 but `ds` is 0.001", ""),
        ("ds: 0.001", "ds: 0.5", "0.5", "`ds` is 0.5 but `ds_max` is 0.01", ""),
        ("max_points: 500", "max_points: 0", "0", "max_points", "at least 1"),
        ("tolerance: 1e-9,\n        stop_after", "tolerance: 0,\n        stop_after", "0", "continuation.tolerance", "at most 0.0001"),
        ("tolerance: 1e-9,\n        stop_after", "tolerance: 1e-3,\n        stop_after", "1e-3", "is 0.001", ""),
        ("count: 1", "count: 0", "0", "count` is 0", "count: 1"),
        ("Only([0, 2])", "Only([])", "Only([])", "is []", "Only([0])"),
        ("Only([0, 2])", "Only([0, 3])", "3", "stability.sectors` is 3", "mode 4 run from 0 to 2"),
        ("Only([0, 2])", "Only([2, 2])", "2", "listed twice", ""),
        ("eigenvalues: 8", "eigenvalues: 0", "0", "eigenvalues", "at least 1"),
        ("max_frequency: 10.0", "max_frequency: -1.0", "-1.0", "max_frequency", "greater than 0"),
        ("profiles: 9", "profiles: 1001", "1001", "1001", "at most 1000"),
        ("Column(\"amplitude\")", "Column(\"\")", "Column(\"\")", "output.plots` is", "amplitude"),
        ("speed: -1.2, tolerance: 1e-9", "speed: -1.2, tolerance: 0.0", "0.0", "expect.tolerance", "greater than 0"),
        ("speed: -1.2, tolerance: 1e-9", "speed: -1.2, tolerance: 0.2", "0.2", "expect.tolerance", "at most 0.1"),
        ("mismatch: 0.05, speed: -1.2, tolerance: 1e-9", "mismatch: 0.11, tolerance: 0.99", "0.99", "expect.tolerance", "at most 0.1"),
        ("(event: GR, mismatch: 0.05, speed: -1.2", "(event: GR, sector: 0, mismatch: 0.05, speed: -1.2", "0", "`sector` is expected of a GR", "HB"),
        ("(event: GR, mismatch: 0.05, speed: -1.2", "(event: GR, omega: 0.05, speed: -1.2", "0.05", "`omega` is expected of a GR", "HB"),
        ("(event: GR, mismatch: 0.05, speed: -1.2, tolerance: 1e-9)", "(event: GR, friction: 0.5, tolerance: 1e-9)", "(event: GR, friction: 0.5, tolerance: 1e-9)", "keeps them", "`mismatch` or `speed`"),
        ("(event: HB, sector: 0,", "(event: HB, sector: 1,", "HB", "leaves out sector 1", "`All`"),
        ("label: 7", "label: 0", "0", "`expect.label` is 0", "from 1"),
        ("stop_at: [0.08,", "stop_at: [0.08, 0.08,", "0.08", "0.08 is listed twice", "once"),
        ("(event: HB, count: 1)", "(event: HB, count: 1), (event: HB, count: 2)", "HB", "HB is listed twice", "once"),
        ("PhasePlane, Friction]", "PhasePlane, PhasePlane]", "PhasePlane", "PhasePlane is listed twice", "once"),
        ("PhasePlane, Friction]", "Column(\"condition\")]", "Column(\"condition\")", "nothing without `conditioning`", "conditioning: true"),
        ("PhasePlane, Friction]", "Column(\"hertz\")]", "Column(\"hertz\")", "the angular velocity", "rotation: 62.8"),
        ("PhasePlane, Friction]", "Column(\"smoothing\")]", "Column(\"smoothing\")", "this parameter", "Regularised"),
        ("profiles: 9", "profiles: 0", "PhasePlane", "nothing without profiles", "leave out `profiles: 0`"),
        ("stability: (sectors: Only([0, 2]), eigenvalues: 8, max_frequency: 10.0),\n", "\n", "HB", "no HB is found without the section", "stability: ("),
        ("title: \"", "title: \"\\u{1b}", "\"\\u{1b}Mode 4: (brackets] in a \\\"title\\\"\"", "`title` holds the control character U+001B", "without it"),
        ("title: \"", "title: \"\\n", "\"\\nMode 4: (brackets] in a \\\"title\\\"\"", "U+000A", "one line"),
        ("title: \"", "title: \"\u{1b}", " ", "the control character U+001B is no text", "remove it"),
        ("start: Fast", "start: /* \u{fffe} */ Fast", " ", "U+FFFE", "remove it"),
        ("start: Fast", "start: Restart(dir: \"a\\x07\", label: 1)", "\"a\\x07\"", "`wave.start.dir` holds the control character U+0007", ""),
        ("parameter: MassDamping", "parameter: Smoothing", "Smoothing", "the friction law has no smoothing", "Regularised"),
        ("parameter: Mismatch,", "parameter: Smoothing,", "Smoothing", "the friction law has no smoothing", "Regularised"),
        ("speed: -1.2", "smoothing: 0.1", "0.1", "the friction law has no smoothing", "Regularised"),
        ("start: Fast", "start: Hopf", "Down", "`continuation.toward` is Down", "`toward: Up`"),
        ("speed: -1.2", "speed: NaN", "NaN", "`expect.speed` is NaN", "finite"),
        ("sector: 0", "sector: 3", "3", "expect.sector` is 3", "from 0 to 2"),
        ("mismatch: 0.05, speed: -1.2, tolerance", "tolerance", "(event: GR, tolerance: 1e-9)", "nothing to compare this GR event", "at least one number"),
    ];
    for (from, to, place, message, help) in cases {
        refused(&edited(from, to), place, message, help);
    }
    for (given, place, message) in [
        ("Given(a: 2, b: 1, D: 0, g: 1, h: 1)", "0", "coefficients.D"),
        (
            "Given(a: 2, b: 1, D: -0.0, g: 1, h: 1)",
            "-0.0",
            "coefficients.D",
        ),
        ("Given(a: 2, b: 3, D: 1, g: 1, h: 1)", "2", "coefficients.a"),
        ("Given(a: 2, b: 0, D: 1, g: 1, h: 1)", "0", "coefficients.b"),
        ("Given(a: inf, b: 1, D: 1, g: 1, h: 1)", "inf", "is inf"),
        (
            "Given(a: 2, b: 1, D: NaN, g: 1, h: 1)",
            "NaN",
            "coefficients.D",
        ),
        (
            "Given(a: 2, b: 1, D: 1, g: -1, h: 1)",
            "-1",
            "coefficients.g",
        ),
        (
            "Given(a: 2, b: 1, D: 1, g: 1, h: 0.0)",
            "0.0",
            "coefficients.h",
        ),
    ] {
        refused(&coefficients(given), place, message, "");
    }
    let given = "Given(a: 2, b: 1, D: 1, g: 1, h: 1)";
    let nu = coefficients(given)
        .replace("parameter: Mismatch", "parameter: Nu")
        .replace("range: (0.004, 0.2)", "range: (0.1, 0.4)");
    refused(&nu, "Nu", "`nu` is unknown: the coefficients", "Geometry");
    let expected = edited("Geometry(nu: 0.3, xi: 1.5, gamma: 1.0)", given);
    refused(&expected, "1.0", "`gamma` is unknown", "Geometry");
}

#[test]
fn ranges_follow_the_parameter() {
    for (parameter, range, good) in [
        ("Friction", "(0, 1)", true),
        ("Friction", "(-0.1, 1)", false),
        ("MassDamping", "(0, 1)", true),
        ("StiffnessDamping", "(-1, 1)", false),
        ("Gamma", "(0, 2)", false),
        ("Gamma", "(0.1, 2)", true),
        ("Nu", "(-0.9, 0.49)", true),
        ("Nu", "(-1, 0.49)", false),
        ("Xi", "(1.1, 2)", true),
        ("Xi", "(1, 2)", false),
    ] {
        let text = edited("parameter: Mismatch", &format!("parameter: {parameter}"))
            .replace("range: (0.004, 0.2)", &format!("range: {range}"))
            .replace("stop_at: [0.08, (mismatch: 0.045)],", "");
        assert_eq!(parse(&text, "p.ron").is_ok(), good, "{parameter} {range}");
    }
}

#[test]
fn a_restart_may_start_outside_the_range() {
    let text = edited("range: (0.004, 0.2)", "range: (0.004, 0.1)");
    assert!(parse(&text, "p.ron").is_err());
    let text = text.replace("start: Fast", "start: Restart(dir: \"x\", label: 3)");
    parse(&text, "p.ron").unwrap();
}

#[test]
fn default_steps_give_way() {
    let three = "ds: 0.001,\n        ds_min: 1e-10,\n        ds_max: 0.01,";
    for (written, expected) in [
        ("", (DEFAULT_DS, DEFAULT_DS_MIN, DEFAULT_DS_MAX)),
        ("ds: 0.5,", (0.5, DEFAULT_DS_MIN, 0.5)),
        ("ds: 1e-14,", (1e-14, 1e-14, DEFAULT_DS_MAX)),
        ("ds_max: 0.001,", (0.001, DEFAULT_DS_MIN, 0.001)),
        ("ds_max: 1e-13,", (1e-13, 1e-13, 1e-13)),
        ("ds_min: 0.01,", (0.01, 0.01, DEFAULT_DS_MAX)),
        ("ds_min: 0.1,", (0.1, 0.1, 0.1)),
        ("ds_min: 0.1, ds_max: 0.2,", (0.1, 0.1, 0.2)),
    ] {
        let continuation = parse(&edited(three, written), "p.ron")
            .unwrap()
            .continuation
            .unwrap();
        let found = (continuation.ds, continuation.ds_min, continuation.ds_max);
        assert_eq!(found, expected, "{written}");
    }
}

#[test]
fn messages_are_laid_out() {
    let error = parse(
        &edited("        friction: 0.5,\n", "\tfrcition: 0.5,\r\n"),
        "p.ron",
    )
    .unwrap_err()
    .to_string();
    let lines: Vec<&str> = error.lines().collect();
    assert!(
        lines[0].starts_with("p.ron:6:2: unknown field `frcition`"),
        "{error}"
    );
    assert_eq!(lines[1], "6 |  frcition: 0.5,");
    assert_eq!(lines[2], "  |  ^^^^^^^^");
    assert_eq!(lines[3], "help: write for example `friction: 0.5`");
    assert_eq!(lines.len(), 4);

    let wide = "(title: \"волна — δ\", modle: (), /* ξ */)";
    let error = refused(wide, "modle", "did you mean `model`?", "");
    assert_eq!((error.line(), error.column()), (Some(1), Some(22)));

    for repeats in [10, 30, 1000] {
        let long = format!(
            "(title: \"{}\", modle: 1, {})",
            "é".repeat(repeats),
            "ξ".repeat(repeats)
        );
        let error = refused(&long, "modle", "unknown field", "");
        let longest = error
            .to_string()
            .lines()
            .skip(1)
            .map(|line| line.chars().count())
            .max();
        assert!(longest < Some(120), "{error}");
    }
    let huge = format!("(title: {})", "x".repeat(5000));
    assert!(
        parse(&huge, "p.ron")
            .unwrap_err()
            .to_string()
            .chars()
            .count()
            < 600
    );
}

#[test]
fn files_are_read_and_refused() {
    let directory = std::env::temp_dir().join(format!("problem-test-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let file = directory.join("p.ron");
    std::fs::write(&file, TEMPLATE).unwrap();
    let (problem, text) = read(&file).unwrap();
    assert_eq!(problem, parse(TEMPLATE, "p").unwrap());
    assert_eq!(text, TEMPLATE);

    assert!(read(&directory).is_err());
    let error = read(&directory.join("none.ron")).unwrap_err();
    assert!(error.message().contains("cannot read"), "{error}");
    assert!(error.to_string().contains("none.ron: cannot"), "{error}");
    assert_eq!(error.line(), None);

    std::fs::write(&file, b"(\n  title: \"\xC3\xA9 \xFF\"").unwrap();
    let error = read(&file).unwrap_err();
    assert!(
        error
            .message()
            .contains("not UTF-8 text: unexpected byte 0xFF"),
        "{error}"
    );
    assert_eq!((error.line(), error.column()), (Some(2), Some(13)));
    assert_eq!(marked(&error), "\u{FFFD}");

    std::fs::write(&file, vec![b'('; 10 << 20]).unwrap();
    let error = read(&file).unwrap_err();
    assert!(error.message().contains("larger than 4 MiB"), "{error}");
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn large_garbage_is_refused_quickly() {
    let stop_at = |inside: &str| edited("0.08, (mismatch: 0.045)", inside);
    let many = |piece: &str| piece.repeat(1_000_000 / piece.len());
    for text in [
        many("("),
        many("["),
        many("{"),
        many(")"),
        many("a("),
        many("(a:"),
        many("1,"),
        format!("[{}]", many("1,")),
        format!("({})", many("a:1,")),
        format!("(title: ({}))", many("\n[\n]\n,")),
        many("/*"),
        many("/**/"),
        many("//\n"),
        many("\""),
        many("\\\""),
        many("r#"),
        many("#!["),
        many("ξ"),
        many("- "),
        many("\n"),
        format!("(model: {})", many("r#é")),
        edited(
            "Column(\"amplitude\")",
            &format!("Column(\"{}\")", many(" ")),
        ),
        stop_at(&many("(")),
        stop_at(&many("[")),
        stop_at(&many("9")),
        stop_at(&many("0.3,")),
        stop_at(&format!("{}, 1", many("0.1,"))),
        stop_at(&format!("({}: 1)", many("x"))),
        format!("({})", many("(\n),")),
        format!("(expect: [{}])", many("(event:GR,tolerance:1),")),
    ] {
        let before = Instant::now();
        let error = parse(&text, "p.ron").unwrap_err().to_string();
        let elapsed = before.elapsed();
        // A fraction of a second when alone; anything quadratic in a million characters takes much longer.
        assert!(elapsed < Duration::from_secs(100), "{elapsed:?} {error}");
        assert!(error.len() < 2000);
    }
    assert!(parse(&"(".repeat(10 << 20), "p.ron").is_err());
}

/// Changes texts at random places; nothing may panic, and every error must be complete.
#[test]
fn damaged_texts_do_not_panic() {
    const PIECES: [&str; 36] = [
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        ":",
        ",",
        "\"",
        "'",
        "\\",
        "/*",
        "*/",
        "//",
        "\n",
        "\r",
        "#",
        "#![",
        "r#\"",
        "NaN",
        "-inf",
        "1e999",
        "-",
        "0",
        "99999999999999999999",
        ".",
        "Some(",
        "None",
        "ξ",
        "é",
        "\u{FEFF}",
        "\u{0}",
        "😀",
        "x",
        "HB",
        " ",
    ];
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    let mut below = |limit: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % limit.max(1)
    };
    let mut refusals = 0;
    for round in 0..6000 {
        let source = if round % 2 == 0 { FULL } else { TEMPLATE };
        let mut text: Vec<char> = source.chars().collect();
        for _ in 0..=below(3) {
            let at = below(text.len());
            match below(5) {
                0 => drop(text.remove(at)),
                1 => text.truncate(at),
                2 => drop(text.splice(at..at, PIECES[below(PIECES.len())].chars())),
                3 => {
                    let end = (at + below(20)).min(text.len());
                    drop(text.splice(at..end, PIECES[below(PIECES.len())].chars()));
                }
                _ => {
                    let end = (at + below(40)).min(text.len());
                    let copy: Vec<char> = text[at..end].to_vec();
                    let target = below(text.len());
                    drop(text.splice(target..target, copy));
                }
            }
            if text.is_empty() {
                break;
            }
        }
        let text: String = text.into_iter().collect();
        match parse(&text, "p.ron") {
            Ok(problem) => drop(problem.continuation(&text, "p.ron")),
            Err(error) => {
                refusals += 1;
                assert!(!error.message().is_empty() && !error.help().is_empty());
                let lines = text.split('\n').count();
                assert!(error.line().is_some_and(|line| (1..=lines).contains(&line)));
                assert!(error.to_string().lines().count() >= 4, "{error}");
            }
        }
        let place = Outline::of(&text).locate("expect.1.tolerance");
        assert!(text.get(place).is_some());
    }
    assert!(refusals > 2000, "{refusals}");
}
