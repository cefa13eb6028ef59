//! Every verb times every field of a problem file: what a verb does with a field is a table.
//!
//! A field is honoured, refused or irrelevant; nothing is left that looks as if it did something.
//! docs/files.md says the same in words.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

use crate::cli::harness::{Bench, changed, snapshot};

/// A small problem with every section; the branch passes one RV.
pub const BASE: &str = r#"(
    title: "small",
    model: (
        coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0),
        friction: 0.5,
        mismatch: 0.1,
        damping: (mass: 0.0, stiffness: 0.0),
        impact: Frictionless,
        friction_law: Coulomb,
    ),
    wave: (mode: 4, start: Fast),
    method: Exact,
    continuation: (
        parameter: Mismatch,
        range: (0.096, 0.101),
        toward: Down,
        stop_at: [0.098],
        ds: 0.005,
        ds_min: 1e-9,
        ds_max: 0.05,
        max_points: 60,
        tolerance: 1e-10,
        stop_after: [(event: RV, count: 2)],
    ),
    stability: (sectors: Only([0]), eigenvalues: 2, max_frequency: 4.0),
    map: (
        first: (parameter: Friction, range: (0.4, 0.5)),
        second: (parameter: Mismatch, range: (0.095, 0.1)),
        points: Grid(rows: 2, columns: 2),
        starts: [Fast],
    ),
    simulation: (
        body: Ring(points: 32, order: Fourth, friction: SetValued),
        circle: Wavelength,
        start: SteadySliding,
        perturbation: (mode: 4, amplitude: 1e-3),
        duration: 0.4,
        courant: 0.3,
        every: 0.1,
        snapshots: 1,
    ),
    curve: (
        event: RV,
        index: 1,
        parameters: (Mismatch, Friction),
        range: ((0.09, 0.11), (0.45, 0.55)),
        ds: 0.005,
        ds_min: 1e-9,
        ds_max: 0.05,
        max_points: 5,
        tolerance: 1e-10,
    ),
    output: (plots: [Diagram, Pressure, Spectrum], profiles: 1, conditioning: false),
    expect: [
        (event: RV, mismatch: 0.0968, tolerance: 1e-2),
        (event: UZ, mismatch: 0.098, label: 2, tolerance: 1e-9),
        (event: EP, mismatch: 0.096, tolerance: 1e-9),
    ],
)
"#;

/// What stands in the way of a change of the model is that the simulation cannot have it.
const SIMULATION: &str = r#"    simulation: (
        body: Ring(points: 32, order: Fourth, friction: SetValued),
        circle: Wavelength,
        start: SteadySliding,
        perturbation: (mode: 4, amplitude: 1e-3),
        duration: 0.4,
        courant: 0.3,
        every: 0.1,
        snapshots: 1,
    ),
"#;

/// The verbs, a column each; `plot` draws what `run` left.
const VERBS: [(&str, &[&[&str]]); 10] = [
    ("run", &[&["run", "p.ron", "--out", "o"]]),
    ("check", &[&["check", "p.ron"]]),
    ("plot", &[&["run", "p.ron", "--out", "o"], &["plot", "o"]]),
    (
        "spectrum",
        &[&["spectrum", "p.ron", "--at", "mismatch=0.099"]],
    ),
    (
        "spectrum --discretised",
        &[&[
            "spectrum",
            "p.ron",
            "--discretised",
            "24",
            "--epsilon",
            "0.1",
        ]],
    ),
    (
        "steady",
        &[&["steady", "p.ron", "--modes", "4", "--plot", "o.svg"]],
    ),
    ("simulate", &[&["simulate", "p.ron", "--out", "o"]]),
    (
        "accuracy",
        &[&[
            "accuracy",
            "p.ron",
            "--out",
            "o",
            "--budget",
            "0.15",
            "--repeats",
            "1",
        ]],
    ),
    ("curve", &[&["curve", "p.ron", "--out", "o"]]),
    ("map", &[&["map", "p.ron", "--out", "o", "--plot", "o.svg"]]),
];

/// A change of a field and what it does to each verb, in the order of [`VERBS`].
struct Row {
    field: &'static str,
    from: &'static str,
    to: &'static str,
    /// `h` honoured: what is printed or written changes. `-` irrelevant: not a byte changes. `x`
    /// refused with exit code 2 and the name of the field. `~` honoured, but what it changes is
    /// rounding, or needs another problem to be seen. ` ` the verb does not apply.
    verbs: &'static str,
    /// What is changed on both sides of the comparison.
    both: &'static [(&'static str, &'static str)],
}

const fn row(
    field: &'static str,
    from: &'static str,
    to: &'static str,
    verbs: &'static str,
) -> Row {
    let both = &[];
    Row {
        field,
        from,
        to,
        verbs,
        both,
    }
}

const fn with(row: Row, both: &'static [(&'static str, &'static str)]) -> Row {
    Row { both, ..row }
}

const EXPECTED: &str = r#"        (event: RV, mismatch: 0.0968, tolerance: 1e-2),
        (event: UZ, mismatch: 0.098, label: 2, tolerance: 1e-9),
        (event: EP, mismatch: 0.096, tolerance: 1e-9),
"#;
/// The first of two places each, told by what follows.
const STEPS: &str =
    "ds: 0.005,\n        ds_min: 1e-9,\n        ds_max: 0.05,\n        max_points: 60";
const CURVE_STEPS: &str =
    "ds: 0.005,\n        ds_min: 1e-9,\n        ds_max: 0.05,\n        max_points: 5,";
const CURVE: &str =
    "parameters: (Mismatch, Friction),\n        range: ((0.09, 0.11), (0.45, 0.55))";

const NO_SIMULATION: &[(&str, &str)] = &[(SIMULATION, "")];
const SHOOTING: &[(&str, &str)] = &[("method: Exact", "method: Shooting(tolerance: 1e-5)")];
const COLLOCATION: &[(&str, &str)] = &[(
    "method: Exact",
    "method: Collocation(intervals: 4, degree: 2)",
)];
const STRIBECK: &[(&str, &str)] = &[
    (SIMULATION, ""),
    ("    method: Exact,\n", ""),
    (
        "friction_law: Coulomb",
        "friction_law: Stribeck(ratio: 1.1, velocity: 0.5)",
    ),
];
const REGULARISED: &[(&str, &str)] = &[
    (SIMULATION, ""),
    ("    method: Exact,\n", ""),
    (
        "friction_law: Coulomb",
        "friction_law: Regularised(epsilon: 0.1)",
    ),
];
/// A wave that separates: only that lands again.
const SEPARATED: &[(&str, &str)] = &[
    (EXPECTED, ""),
    ("mismatch: 0.1,", "mismatch: 0.04,"),
    ("range: (0.096, 0.101)", "range: (0.038, 0.041)"),
    ("[0.098]", "[]"),
];
const ANNULUS: &[(&str, &str)] = &[(
    "Ring(points: 32, order: Fourth, friction: SetValued)",
    "Annulus(around: 16, across: 2)",
)];

/// Every field; the columns are run, check, plot, spectrum, discretised, steady, simulate, accuracy,
/// curve, map.
const TABLE: &[Row] = &[
    //                                                                    RCPSDTMAUG
    row("title", "\"small\"", "\"other\"", "h-h--hh~hh"),
    row("nu", "nu: 0.3", "nu: 0.31", "hhhhhhhhhh"),
    row("xi", "xi: 1.5", "xi: 1.51", "hhhhhhhhhh"),
    row("gamma", "gamma: 1.0", "gamma: 1.01", "hhhhhhhhhh"),
    row(
        "friction",
        "        friction: 0.5",
        "        friction: 0.49",
        "hhhhhhhhh-",
    ),
    row(
        "mismatch",
        "mismatch: 0.1,",
        "mismatch: 0.1005,",
        "h~h~h-hh~-",
    ),
    row("mass", "mass: 0.0,", "mass: 0.01,", "hhhhhhhhhh"),
    row(
        "stiffness",
        "stiffness: 0.0)",
        "stiffness: 1e-3)",
        "hhhhhhhhhh",
    ),
    // it is not simulated: the problem is refused whatever is done with it
    row(
        "friction_law",
        "friction_law: Coulomb",
        "friction_law: Static(ratio: 1.1)",
        "xxxxxxxxxx",
    ),
    with(
        row(
            "impact",
            "impact: Frictionless",
            "impact: Coulomb",
            "h~h~~-~~~~",
        ),
        SEPARATED,
    ),
    with(
        row(
            "friction_law",
            "friction_law: Coulomb",
            "friction_law: Static(ratio: 1.1)",
            "hhhhx- hhh",
        ),
        NO_SIMULATION,
    ),
    with(
        row("ratio", "ratio: 1.1", "ratio: 1.2", "h~~~~h ~~~"),
        STRIBECK,
    ),
    with(
        row("velocity", "velocity: 0.5", "velocity: 0.4", "h~~~~h ~~~"),
        STRIBECK,
    ),
    with(
        row("epsilon", "epsilon: 0.1", "epsilon: 0.11", "~~~~~h ~~~"),
        REGULARISED,
    ),
    with(
        row(
            "mode",
            "(mode: 4, start: Fast)",
            "(mode: 3, start: Fast)",
            "hhhhh~ hhh",
        ),
        NO_SIMULATION,
    ),
    row("start", "start: Fast", "start: Slow", "hhhhh--hh-"),
    row(
        "method",
        "method: Exact",
        "method: Shooting(tolerance: 1e-6)",
        "hhhhh---hh",
    ),
    with(
        row(
            "tolerance",
            "tolerance: 1e-5)",
            "tolerance: 1e-6)",
            "hh~hh---hh",
        ),
        SHOOTING,
    ),
    with(
        row("intervals", "intervals: 4", "intervals: 5", "hhhhh---hh"),
        COLLOCATION,
    ),
    with(
        row("degree", "degree: 2", "degree: 3", "hhhhh---hh"),
        COLLOCATION,
    ),
    with(
        row(
            "parameter",
            "parameter: Mismatch,\n        range: (0.096, 0.101)",
            "parameter: Friction,\n        range: (0.49, 0.501)",
            "h~h~---hh-",
        ),
        &[("[0.098]", "[]"), (EXPECTED, "")],
    ),
    row("range", "(0.096, 0.101)", "(0.0965, 0.101)", "hhh~---~h-"),
    row("toward", "toward: Down", "toward: Up", "hhhh---hh-"),
    row("stop_at", "[0.098]", "[0.0985]", "hhh----~--"),
    row(
        "ds",
        STEPS,
        "ds: 0.004,\n        ds_min: 1e-9,\n        ds_max: 0.05,\n        max_points: 60",
        "h~h~---h~h",
    ),
    row(
        "ds_min",
        STEPS,
        "ds: 0.005,\n        ds_min: 1e-8,\n        ds_max: 0.05,\n        max_points: 60",
        "~~~~---~~~",
    ),
    row(
        "ds_max",
        STEPS,
        "ds: 0.005,\n        ds_min: 1e-9,\n        ds_max: 0.005,\n        max_points: 60",
        "hhh~---hhh",
    ),
    row(
        "max_points",
        "max_points: 60",
        "max_points: 3",
        "hhhh---hhh",
    ),
    row(
        "tolerance",
        "tolerance: 1e-10,\n        stop_after",
        "tolerance: 1e-4,\n        stop_after",
        "h~~~~--~~h",
    ),
    row(
        "stop_after",
        "(event: RV, count: 2)",
        "(event: RV, count: 1)",
        "hhh----h--",
    ),
    // the spectrum is to be drawn
    row(
        "stability",
        "    stability: (sectors: Only([0]), eigenvalues: 2, max_frequency: 4.0),\n",
        "",
        "xxxxxxxxxx",
    ),
    row("sectors", "Only([0])", "Only([1])", "h-hhh----h"),
    row(
        "eigenvalues",
        "eigenvalues: 2",
        "eigenvalues: 1",
        "h-hhh-----",
    ),
    row(
        "max_frequency",
        "max_frequency: 4.0",
        "max_frequency: 2.0",
        "h-hhh----h",
    ),
    row(
        "first",
        "first: (parameter: Friction, range: (0.4, 0.5))",
        "first: (parameter: MassDamping, range: (0.0, 0.1))",
        "---------h",
    ),
    row("first.range", "(0.4, 0.5)", "(0.41, 0.5)", "---------h"),
    row(
        "second",
        "second: (parameter: Mismatch, range: (0.095, 0.1))",
        "second: (parameter: Gamma, range: (0.9, 1.0))",
        "---------h",
    ),
    row(
        "second.range",
        "(0.095, 0.1))",
        "(0.096, 0.1))",
        "---------h",
    ),
    row("points", "rows: 2", "rows: 3", "---------h"),
    row("starts", "[Fast]", "[Slow]", "---------h"),
    row("body.points", "points: 32", "points: 48", "------h---"),
    row("order", "Fourth", "Second", "------h---"),
    row(
        "body.friction",
        "SetValued",
        "Tanh(epsilon: 0.1)",
        "------h---",
    ),
    with(
        row(
            "body.epsilon",
            "Tanh(epsilon: 0.1)",
            "Tanh(epsilon: 0.2)",
            "------h---",
        ),
        &[("SetValued", "Tanh(epsilon: 0.1)")],
    ),
    with(
        row("around", "around: 16", "around: 20", "------h---"),
        ANNULUS,
    ),
    with(
        row("across", "across: 2", "across: 3", "------h---"),
        ANNULUS,
    ),
    row(
        "circle",
        "circle: Wavelength",
        "circle: Whole",
        "------h---",
    ),
    row(
        "perturbation.amplitude",
        "amplitude: 1e-3",
        "amplitude: 2e-3",
        "------h---",
    ),
    row(
        "perturbation.mode",
        "perturbation: (mode: 4",
        "perturbation: (mode: 8",
        "------h---",
    ),
    row("duration", "duration: 0.4", "duration: 0.5", "------h---"),
    row("courant", "courant: 0.3", "courant: 0.1", "------h---"),
    row("every", "every: 0.1", "every: 0.2", "------h---"),
    row("snapshots", "snapshots: 1", "snapshots: 2", "------h---"),
    row(
        "curve.event",
        "event: RV,\n        index",
        "event: HB,\n        index",
        "--------h-",
    ),
    row("curve.index", "index: 1", "index: 2", "--------h-"),
    row("sector", "index: 1", "index: 1, sector: 0", "xxxxxxxxxx"),
    row(
        "curve.parameters",
        CURVE,
        "parameters: (Mismatch, MassDamping),\n        range: ((0.09, 0.11), (0.0, 0.1))",
        "--------h-",
    ),
    row(
        "curve.range",
        "((0.09, 0.11)",
        "((0.095, 0.11)",
        "--------h-",
    ),
    row(
        "curve.ds",
        CURVE_STEPS,
        "ds: 0.004,\n        ds_min: 1e-9,\n        ds_max: 0.05,\n        max_points: 5,",
        "--------h-",
    ),
    row(
        "curve.ds_min",
        CURVE_STEPS,
        "ds: 0.005,\n        ds_min: 1e-8,\n        ds_max: 0.05,\n        max_points: 5,",
        "--------~-",
    ),
    row(
        "curve.ds_max",
        CURVE_STEPS,
        "ds: 0.005,\n        ds_min: 1e-9,\n        ds_max: 0.005,\n        max_points: 5,",
        "--------h-",
    ),
    row(
        "curve.max_points",
        "max_points: 5,",
        "max_points: 4,",
        "--------h-",
    ),
    row(
        "curve.tolerance",
        "tolerance: 1e-10,\n    ),\n    output",
        "tolerance: 1e-4,\n    ),\n    output",
        "--------h-",
    ),
    row(
        "plots",
        "[Diagram, Pressure",
        "[Diagram, Column(\"amplitude\"), Pressure",
        "h-h-------",
    ),
    row("profiles", "profiles: 1", "profiles: 2", "hhh-------"),
    row(
        "labels",
        "conditioning: false",
        "conditioning: false, labels: [2]",
        "h-h-------",
    ),
    row(
        "conditioning",
        "conditioning: false",
        "conditioning: true",
        "h---------",
    ),
    row(
        "rotation",
        "conditioning: false",
        "conditioning: false, rotation: 62.8",
        "h-h--hh-hh",
    ),
    row(
        "expect",
        "mismatch: 0.0968,",
        "mismatch: 0.0969,",
        "-h--------",
    ),
    row(
        "certify",
        "    expect: [",
        "    certify: true,\n    expect: [",
        "-h--------",
    ),
];

/// What a verb leaves: exit code, what it said, and its tables and pictures.
struct Trace {
    code: i32,
    said: String,
    kept: Vec<(String, Vec<u8>)>,
}

/// Runs a verb on a problem.
fn trace(verb: usize, text: &str) -> Trace {
    let (name, commands) = VERBS[verb];
    let bench = Bench::new();
    bench.put("p.ron", text);
    let mut said = String::new();
    let mut code = 0;
    for command in commands {
        let mut outcome = bench.run(command);
        // beside other work the time may not suffice for the first method
        if name == "accuracy" && !measured(&bench) {
            let patient = command.iter().map(|word| match *word {
                "0.15" => "60",
                word => word,
            });
            let patient: Vec<&str> = patient.chain(["--force"]).collect();
            outcome = bench.run(&patient);
        }
        assert!(
            !outcome.stderr.contains("panicked"),
            "{name}: {}",
            outcome.stderr
        );
        code = outcome.code.expect("an exit code");
        // times are not figures, and what `run` says is not what `plot` draws
        said = match (name, code) {
            (_, 2) => outcome.stdout + &outcome.stderr,
            ("plot" | "accuracy", _) => String::new(),
            _ => outcome
                .stdout
                .lines()
                .filter(|line| !line.contains("per second"))
                .collect(),
        };
        if code != 0 {
            break;
        }
    }
    let mut kept = Vec::new();
    for (path, bytes) in snapshot(&bench.path("")) {
        let extension = path
            .extension()
            .unwrap_or_default()
            .to_str()
            .unwrap_or_default();
        let wanted = match (name, extension) {
            ("plot", extension) => extension == "svg",
            // the rows it is joined from say which problem they belong to
            ("map", "csv") => path.ends_with("map.csv"),
            // the picture is of times
            ("accuracy", extension) => extension == "csv",
            (_, extension) => ["csv", "svg", "npy", "vtk"].contains(&extension),
        };
        if wanted {
            let bytes = if name == "accuracy" {
                without_times(&bytes)
            } else {
                bytes
            };
            kept.push((path.display().to_string(), bytes));
        }
    }
    Trace { code, said, kept }
}

/// Whether a table of `accuracy` has a method.
fn measured(bench: &Bench) -> bool {
    let table = std::fs::read_to_string(bench.path("o/accuracy.csv"));
    table.is_ok_and(|table| table.lines().count() > 1)
}

/// The first method of a table of `accuracy`, without times: how many fit into a time is chance.
fn without_times(table: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(table);
    let first = text.lines().nth(1).expect("a method");
    let columns: Vec<&str> = first.split(',').take(9).collect();
    columns.join(",").into_bytes()
}

/// A comparison that has to be made.
struct Cell<'a> {
    verb: usize,
    what: char,
    /// The fields changed.
    fields: Vec<&'a str>,
    before: String,
    after: String,
}

/// The cells of the table; what is irrelevant to a verb is changed at once as far as it can be.
fn cells(table: &[Row]) -> Vec<Cell<'_>> {
    let mut cells: Vec<Cell> = Vec::new();
    for verb in 0..VERBS.len() {
        let mut together: Vec<Cell> = Vec::new();
        for row in table {
            let what = row.verbs.chars().nth(verb).expect("a letter per verb");
            if matches!(what, '~' | ' ') {
                continue;
            }
            let mut before = BASE.to_owned();
            for (from, to) in row.both {
                before = changed(&before, from, to);
            }
            let joins = what == '-' && row.both.is_empty();
            let open = together
                .iter_mut()
                .find(|cell| cell.after.matches(row.from).count() == 1);
            if let (true, Some(cell)) = (joins, open) {
                cell.after = changed(&cell.after, row.from, row.to);
                cell.fields.push(row.field);
                continue;
            }
            let after = changed(&before, row.from, row.to);
            let cell = Cell {
                verb,
                what,
                fields: vec![row.field],
                before,
                after,
            };
            if joins {
                together.push(cell);
            } else {
                cells.push(cell);
            }
        }
        cells.append(&mut together);
    }
    cells
}

/// What is wrong with a cell; `before` is what its verb leaves of its problem before the change.
fn wrong(cell: &Cell, before: &OnceLock<Trace>) -> Option<String> {
    let (name, _) = VERBS[cell.verb];
    let fields = cell.fields.join(", ");
    let after = trace(cell.verb, &cell.after);
    if cell.what == 'x' {
        let named = cell.fields.iter().all(|field| after.said.contains(field));
        let cured = ["help: ", "leave out"]
            .iter()
            .any(|cure| after.said.contains(cure));
        return (after.code != 2 || !named || !cured).then(|| {
            format!(
                "{name}, {fields}: not refused by name: {} {}",
                after.code, after.said
            )
        });
    }
    let before = before.get_or_init(|| trace(cell.verb, &cell.before));
    if before.code == 2 || after.code == 2 {
        return Some(format!(
            "{name}, {fields}: refused: {} {}",
            before.said, after.said
        ));
    }
    let same = before.code == after.code && before.said == after.said && before.kept == after.kept;
    match (cell.what, same) {
        ('h', true) => Some(format!("{name}: {fields} changes nothing")),
        ('-', false) => Some(format!("{name}: one of {fields} is not irrelevant")),
        _ => None,
    }
}

#[test]
fn every_field_is_honoured_refused_or_irrelevant() {
    let cells = cells(TABLE);
    // most cells change the same problem
    let befores: HashMap<(usize, &str), OnceLock<Trace>> = cells
        .iter()
        .map(|cell| ((cell.verb, &*cell.before), OnceLock::new()))
        .collect();
    let next = AtomicUsize::new(0);
    let found = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let trouble = wrong(cell, &befores[&(cell.verb, &*cell.before)]);
                    found.lock().expect("no panic before").extend(trouble);
                }
            });
        }
    });
    let found = found.into_inner().expect("no panic");
    assert!(found.is_empty(), "{}", found.join("\n"));
}
