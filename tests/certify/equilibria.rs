//! Certificates of equilibria, against closed forms and figures of other origin with 40 digits, and forged ones.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::certify::with_a_field_more;

fn brakewave(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_brakewave"));
    command.args(arguments).output().unwrap()
}

/// A row of `certificates.csv` by its columns.
type Row = std::collections::HashMap<String, String>;

/// A problem file of the repository.
fn problem(name: &str) -> String {
    let problems = concat!(env!("CARGO_MANIFEST_DIR"), "/problems");
    fs::read_to_string(format!("{problems}/{name}.ron")).unwrap()
}

/// Certifies a problem into the folder `out` of a folder.
fn certified(text: &str, folder: &Path) -> (Option<i32>, Vec<Row>) {
    let (file, out) = (folder.join("problem.ron"), folder.join("out"));
    fs::write(&file, text).unwrap();
    let [file, to] = [&file, &out].map(|path| path.to_str().unwrap());
    let run = brakewave(&["certify", file, "--out", to, "--force"]);
    let table = out.join("certificates.csv");
    let mut reader = csv::Reader::from_path(table).unwrap_or_else(|_| panic!("{run:?}"));
    let rows = reader.deserialize().map(Result::unwrap).collect();
    (run.status.code(), rows)
}

/// Exit code and words of a check of what stands in the folder `out`.
fn verified(folder: &Path) -> (Option<i32>, String) {
    let out = folder.join("out");
    let run = brakewave(&["certify", "--verify", out.to_str().unwrap()]);
    (
        run.status.code(),
        String::from_utf8_lossy(&run.stdout).into_owned(),
    )
}

/// The rows of a type.
fn of_type<'a>(rows: &'a [Row], kind: &str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row["type"] == kind).collect()
}

/// That an interval of a row has a number, and is no wider than so many parts of it.
fn encloses(row: &Row, columns: [&str; 2], value: f64, widest: f64) {
    let [low, high] = columns.map(|column| row[column].parse::<f64>().unwrap());
    assert!(low <= value && value <= high, "{row:?}: {value}");
    assert!(high - low <= widest * value.abs(), "{row:?}: {value}");
}

const VALUE: [&str; 2] = ["low", "high"];
const OMEGA: [&str; 2] = ["omega_low", "omega_high"];
const LYAPUNOV: [&str; 2] = ["lyapunov_low", "lyapunov_high"];

/// Boundary equilibria and the fold of sliding ones of a harvest, by closed forms: what is there for larger or smaller values follows
/// from the eigenvalues and places that the reference has. Then each statement is made another, and every record gets a field.
#[test]
fn boundary_equilibria_and_a_fold_of_sliding_ones() {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(&problem("harvest"), folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let boundary = of_type(&rows, "BE");
    encloses(boundary[0], VALUE, 0.404_875_148_632_580_3, 1e-13);
    encloses(boundary[1], VALUE, 0.420_227_149_810_708_5, 1e-13);
    let beyond: Vec<[&str; 3]> = boundary
        .iter()
        .map(|row| ["beyond", "persists", "growing"].map(|column| &*row[column]))
        .collect();
    assert_eq!(beyond, [["slide", "no", "2"], ["high", "yes", "0"]]);
    let fold = of_type(&rows, "LP");
    encloses(fold[0], VALUE, 0.4225, 1e-13);
    assert_eq!(fold[0]["inequalities"], "3");
    let (code, told) = verified(folder.path());
    assert_eq!(code, Some(0), "{told}");

    let file = folder.path().join("out/certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    for (old, new) in [
        ("kind: BE", "kind: LP"),
        ("kind: LP", "kind: BE"),
        ("kind: LP", "kind: HB"),
        ("condition: Fold", "condition: Boundary(guard: 0)"),
        ("condition: Fold", "condition: Hopf(omega: 0.4)"),
        ("condition: Boundary", "condition: Hopf(omega: 0.4), // "),
        ("mode: \"low\"", "mode: \"high\""),
        ("mode: \"slide\"", "mode: \"low\""),
        ("persists: false", "persists: true"),
        ("persists: true", "persists: false"),
        ("guard: 1", "guard: 0"),
        ("guard: 0", "guard: 7"),
        ("\"al - y\"", "\"al - 2*y\""),
        ("\"eaten - d*y\"", "\"eaten - 2*d*y\""),
        ("low: 0.404875148632", "low: 0.404875148633"),
        ("growing: Some(2)", "growing: Some(1)"),
        ("inequalities: 3", "inequalities: 4"),
        ("unique: 0.00", "unique: 0.01"),
        ("parameter: 4", "parameter: 3"),
        ("0.42249999999", "0.4249999999"),
    ] {
        assert!(honest.contains(old), "{old}");
        fs::write(&file, honest.replace(old, new)).unwrap();
        let (code, told) = verified(folder.path());
        assert_ne!(code, Some(0), "{old} as {new}: {told}");
    }
    // no part of it has a field that says more
    let parts = with_a_field_more(&honest);
    for (first, forged) in &parts {
        fs::write(&file, forged).unwrap();
        let (code, told) = verified(folder.path());
        assert_ne!(code, Some(0), "{first}: {told}");
    }
    assert!(parts.len() > 8, "{:?}", parts.keys());
}

/// The Hopf points of the Brusselator and of Lorenz by closed forms, and one of 40 digits of an exponential reaction, with the frequencies
/// and the first Lyapunov coefficients; where the trace is zero at a saddle there is none, whatever a certificate says.
#[test]
fn hopf_points_with_their_lyapunov_coefficients() {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(&problem("brusselator"), folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let hopf = of_type(&rows, "HB");
    encloses(hopf[0], VALUE, 2.0, 1e-13);
    encloses(hopf[0], OMEGA, 1.0, 1e-13);
    encloses(hopf[0], LYAPUNOV, -0.5, 1e-11);
    assert_eq!(hopf[0]["growing"], "0");
    let file = folder.path().join("out/certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    assert_eq!(verified(folder.path()).0, Some(0));
    for (old, new) in [
        (
            "lyapunov: Some(Within((\n                        low: -0.5",
            "lyapunov: Some(Within((\n                        low: 0.5",
        ),
        (
            "omega: Some((\n                        low: 0.9",
            "omega: Some((\n                        low: 1.9",
        ),
        ("kind: HB", "kind: LP"),
        ("kind: HB", "kind: BP"),
    ] {
        assert!(honest.contains(old), "{old}: {honest}");
        fs::write(&file, honest.replace(old, new)).unwrap();
        let (code, told) = verified(folder.path());
        assert_eq!(code, Some(1), "{old} as {new}: {told}");
    }

    let (code, rows) = certified(&problem("lorenz"), folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let hopf = of_type(&rows, "HB");
    encloses(hopf[0], VALUE, 470.0 / 19.0, 1e-12);
    encloses(hopf[0], OMEGA, 9.624_530_063_715_756, 1e-12);
    encloses(hopf[0], LYAPUNOV, 2.655_189_725_836_714e-4, 1e-8);

    let text = r#"(
        system: (states: ["u1", "u2"], parameters: {"p1": 0.05, "p2": 14.0, "p3": 2.0},
            modes: {"flow": (rates: {"u1": "-u1 + p1*(1 - u1)*exp(u2)", "u2": "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"})}),
        equilibrium: (start: Given(mode: "flow", state: {"u1": 0.06, "u2": 0.3})),
        continuation: (parameter: "p1", range: (0.05, 0.15), toward: Up),
    )"#;
    let (code, rows) = certified(text, folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let folds = of_type(&rows, "LP");
    encloses(folds[0], VALUE, 0.105_738_978_271_650_66, 1e-13);
    encloses(folds[1], VALUE, 0.088_931_846_185_772_8, 1e-13);
    let counts: Vec<&str> = folds.iter().map(|row| &*row["growing"]).collect();
    assert_eq!(counts, ["0", "1"]);
    let hopf = of_type(&rows, "HB");
    assert_eq!(hopf.len(), 1);
    encloses(hopf[0], VALUE, 0.130_900_044_820_043_32, 1e-13);
    encloses(hopf[0], OMEGA, 4.007_774_662_864_487, 1e-13);
    encloses(hopf[0], LYAPUNOV, -0.388_954_535_527_405_5, 1e-10);
    // the trace is zero at a saddle, and a fold has an eigenvalue zero
    let honest = fs::read_to_string(&file).unwrap();
    let (before, point) = honest.split_once("condition: Hopf(").unwrap();
    let (_, after) = point.split_once("statement: (").unwrap();
    for (omega, state, parameter) in [
        (
            "0.2495150261979219",
            "0.3192050804179089, 1.4896237086169084",
            "0.10571050120633914",
        ),
        (
            "1e-9",
            "0.3110177634953864, 1.4514162296451365",
            "0.10573897827165065",
        ),
    ] {
        let forged = format!(
            "{before}condition: Hopf(omega: {omega}), near: (mode: \"flow\", state: [{state}], parameter: {parameter}), \
             statement: ({after}"
        );
        fs::write(&file, forged).unwrap();
        let (code, told) = verified(folder.path());
        assert_eq!(code, Some(1), "{omega}: {told}");
        let refused = told
            .lines()
            .any(|line| line.contains("HB: refused: it is no proof"));
        assert!(refused, "{told}");
    }
}

/// A Hopf point in a sliding mode, whose coefficient is that of the field in the surface (40 digits).
#[test]
fn a_hopf_point_in_sliding() {
    let text = r#"(
        system: (
            states: ["s", "x", "y"], parameters: {"mu": -0.3, "k": 0.4, "c0": 0.05, "M": 0.8, "p": 0.6, "r": 0.3},
            modes: {
                "plus": (rates: {"s": "p*x + r*y - M", "x": "mu*x - y - x*(x^2 + y^2) + k", "y": "x + mu*y - y*(x^2 + y^2) + c0"},
                    until: [(zero: "s", to: "minus")]),
                "minus": (rates: {"s": "p*x + r*y + M", "x": "mu*x - y - x*(x^2 + y^2) - k", "y": "x + mu*y - y*(x^2 + y^2) + c0"},
                    until: [(zero: "-s", to: "plus")]),
            },
            sliding: {"slide": ("plus", "minus")},
        ),
        equilibrium: (start: Given(mode: "slide", state: {"s": 0.0, "x": -0.05, "y": 0.0})),
        continuation: (parameter: "mu", range: (-0.3, 0.1), toward: Up),
    )"#;
    let folder = TempDir::new().unwrap();
    let (_, rows) = certified(text, folder.path());
    let hopf = of_type(&rows, "HB");
    encloses(hopf[0], VALUE, -0.144_554_186_825_393_42, 1e-12);
    encloses(hopf[0], OMEGA, 0.910_165_120_233_586, 1e-12);
    encloses(hopf[0], LYAPUNOV, -2.195_034_368_307_057, 1e-9);
    assert_eq!(hopf[0]["growing"], "0");
    let (_, told) = verified(folder.path());
    assert!(!told.contains("refused"), "{told}");
}

const CHUA: &str = r#"(
    system: (states: ["x", "y", "z"],
        parameters: {"alpha": 6.0, "beta": 14.28, "a0": -0.14285714285714285714, "a1": 0.28571428571428571429, "E": 1.2857142857142857143},
        modes: {
            "left": (rates: {"x": "alpha*(y - a1*x - (a1 - a0)) + E", "y": "x - y + z", "z": "-beta*y"}, until: [(zero: "-1 - x", to: "middle")]),
            "middle": (rates: {"x": "alpha*(y - a0*x) + E", "y": "x - y + z", "z": "-beta*y"},
                until: [(zero: "1 - x", to: "right"), (zero: "x + 1", to: "left")]),
            "right": (rates: {"x": "alpha*(y - a1*x - (a0 - a1)) + E", "y": "x - y + z", "z": "-beta*y"}, until: [(zero: "x - 1", to: "middle")]),
        }),
    equilibrium: (start: Given(mode: "right", state: {"x": 2.2, "y": 0.0, "z": -2.2})),
    continuation: (parameter: "E", range: (-2.0, 2.0)),
)"#;

/// Continuous pieces of Chua's circuit: nonsmooth folds of affine modes, and a Hopf point with a vertical family.
#[test]
fn pieces_of_affine_modes() {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(CHUA, folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let boundary = of_type(&rows, "BE");
    encloses(boundary[0], VALUE, -0.857_142_857_142_857_1, 1e-13);
    encloses(boundary[1], VALUE, 0.857_142_857_142_857_1, 1e-13);
    for (row, mode) in boundary.iter().zip(["middle", "left"]) {
        assert_eq!([&*row["beyond"], &*row["persists"]], [mode, "no"]);
    }
    let text = CHUA
        .replace("\"E\": 1.2857142857142857143", "\"E\": 0.0")
        .replace(
            "\"x\": 2.2, \"y\": 0.0, \"z\": -2.2",
            "\"x\": 1.5, \"y\": 0.0, \"z\": -1.5",
        )
        .replace(
            "parameter: \"E\", range: (-2.0, 2.0)",
            "parameter: \"alpha\", range: (6.0, 8.0), toward: Up",
        );
    let (code, rows) = certified(&text, folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let hopf = of_type(&rows, "HB");
    encloses(hopf[0], VALUE, 6.796_022_466_621_534, 1e-13);
    encloses(hopf[0], OMEGA, 3.070_130_003_457_097, 1e-13);
    assert_eq!(
        LYAPUNOV.map(|column| hopf[0][column].parse::<f64>()),
        [Ok(0.0), Ok(0.0)]
    );
    let theorem = fs::read_to_string(folder.path().join("out/theorem.md")).unwrap();
    assert!(theorem.contains("affine in the states"), "{theorem}");
    assert_eq!(verified(folder.path()).0, Some(0));
    // what is vertical is no sign
    let file = folder.path().join("out/certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    let sign = "lyapunov: Some(Within((low: -1.0, high: -0.5)))";
    fs::write(&file, honest.replace("lyapunov: Some(Vertical)", sign)).unwrap();
    assert_eq!(verified(folder.path()).0, Some(1));
}

/// What is not covered is said so, and nothing is proven where another guard vanishes with that of the event: of one formula the two
/// are one, of two they may be two.
#[test]
fn what_is_not_proven_is_said() {
    let folder = TempDir::new().unwrap();
    let system = |guards: &str| {
        format!(
            r#"(
            system: (states: ["x", "y"], parameters: {{"p": -1.0}}, modes: {{
                "a": (rates: {{"x": "p - x", "y": "x - y"}}, until: [{guards}]),
                "b": (rates: {{"x": "p - x", "y": "x - 2*y"}}, until: [(zero: "x", to: "a")]),
            }}),
            equilibrium: (start: Given(mode: "a", state: {{"x": -1.0, "y": -1.0}})),
            continuation: (parameter: "p", range: (-1.0, 1.0), toward: Up),
        )"#
        )
    };
    for (guards, proven) in [
        (r#"(zero: "-x", to: "b")"#, "yes"),
        (
            r#"(zero: "-x", to: "b"), (zero: "x - 2*x", to: "b")"#,
            "yes",
        ),
        (r#"(zero: "-x", to: "b"), (zero: "-y", to: "b")"#, "no"),
    ] {
        let (_, rows) = certified(&system(guards), folder.path());
        let boundary = of_type(&rows, "BE");
        assert_eq!(boundary[0]["proven"], proven, "{guards}: {rows:?}");
        // the rates differ by y where x is zero
        assert_eq!(boundary[0]["beyond"], "", "{rows:?}");
    }
    let text = r#"(
        system: (states: ["x", "v"], parameters: {"F": 0.5}, contacts: {"r": Friction(slip: "v - 0.2", bound: "1")},
            rates: {"x": "v", "v": "F - x + r"}),
        equilibrium: (start: Given(mode: "backward", state: {"x": 1.5, "v": 0.0})),
        continuation: (parameter: "F", range: (0.0, 0.9)),
    )"#;
    let file = folder.path().join("contact.ron");
    fs::write(&file, text).unwrap();
    let run = brakewave(&["certify", file.to_str().unwrap(), "--arcs"]);
    assert_eq!(run.status.code(), Some(2), "{run:?}");
}

/// A mass between a stop and a damped spring.
const STOPS: &str = r#"(
    system: (
        states: ["x", "v", "y", "w"], parameters: {"F": 1.0, "d": 0.5, "k": 2.0, "c": 0.2, "g": 0.3},
        contacts: {
            "p": Stop(gap: "d - x", restitution: "0.5"),
            "s": Spring(gap: "g + y", stiffness: "k", damping: "c"),
        },
        rates: {
            "x": "v", "v": "-x + k*(y - x) - c*v + F - p + 0.1*x^3",
            "y": "w", "w": "-y - k*(y - x) - c*w - F/2 + s",
        },
    ),
    equilibrium: (start: Given(mode: "open.open", state: {"x": 0.2, "v": 0.0, "y": -0.1, "w": 0.0})),
    continuation: (parameter: "F", range: (-5.0, 5.0), toward: Both),
)"#;

/// An oscillator on a damped spring, with friction that the force of a stop bounds, beside a mass that rests on this stop.
const PRESSED: &str = r#"(
    system: (
        states: ["x", "v", "y", "w"],
        parameters: {"m": -0.5, "d": 0.5, "k": 2.0, "f": 0.3, "mu": 0.2, "e": 0.1, "vb": 1.0},
        contacts: {
            "p": Spring(gap: "x + d", stiffness: "k", damping: "e"),
            "s": Stop(gap: "1 - y", restitution: "0"),
            "q": Friction(slip: "v - vb", bound: "mu*s*exp(v - vb)"),
        },
        rates: {
            "x": "v", "v": "m*v - v^3 - x - x^2/3 - 3*d + p + q + 0.1*y",
            "y": "w", "w": "-y/2 + 2 + f*x - s - w",
        },
    ),
    equilibrium: (start: Given(mode: "closed.closed.backward", state: {"x": -0.9, "v": 0.0, "y": 1, "w": 0.0})),
    continuation: (parameter: "m", range: (-1.0, 3.0), toward: Up),
)"#;

/// Equilibria of modes that contacts make. At the stop and at the spring they go on in the other state of this contact; by hand:
/// x = 1/2 and 3y = 1 - F/2 give F = 1.23125, y = -3/10 there 3.8; x³ + 10x + 12 = 0 and F = 4x + 1.8 the other touch of the spring; and with
/// the spring closed x² = 22/3 the fold. Then each statement is made another.
#[test]
fn equilibria_between_a_stop_and_a_spring() {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(STOPS, folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let boundary = of_type(&rows, "BE");
    for (row, (value, beyond)) in boundary.iter().zip([
        (-2.502_287_708_147_197, "open.closed"),
        (1.231_25, "closed.open"),
        (3.8, "closed.closed"),
    ]) {
        encloses(row, VALUE, value, 1e-14);
        assert_eq!([&*row["beyond"], &*row["persists"]], [beyond, "yes"]);
    }
    assert_eq!(boundary.len(), 3);
    let x = -f64::sqrt(22.0 / 3.0);
    let fold = of_type(&rows, "LP");
    encloses(fold[0], VALUE, (22.0 / 15.0 * x + 0.24) / 0.8, 1e-14);
    // with three guards less of the event: p and s act, e and 1 - e, k and c
    assert_eq!(fold[0]["inequalities"], "8");
    // beyond the fold one eigenvalue grows; on the stop there are two states less
    let growing: Vec<&str> = rows.iter().map(|row| &*row["growing"]).collect();
    assert_eq!(growing, ["0", "0", "0", "1", "0", "0", "0", "0"]);
    assert_eq!(verified(folder.path()).0, Some(0));

    let file = folder.path().join("out/certificate.ron");
    let honest = fs::read_to_string(&file).unwrap();
    for (old, new) in [
        ("mode: \"open.closed\"", "mode: \"open.open\""),
        ("mode: \"closed.open\"", "mode: \"open.open\""),
        ("mode: \"closed.open\"", "mode: \"closed.closed\""),
        ("mode: \"closed.closed\"", "mode: \"closed.closed.open\""),
        ("restitution: \"0.5\"", "restitution: \"1.5\""),
        ("damping: Some(\"c\")", "damping: Some(\"-c\")"),
        ("gap: \"d - x\"", "gap: \"d - x + v\""),
        ("F - p + 0.1", "F + p + 0.1"),
        ("kind: BE", "kind: LP"),
        ("persists: true", "persists: false"),
        ("guard: 0", "guard: 1"),
        ("growing: Some(1)", "growing: Some(0)"),
        ("inequalities: 8", "inequalities: 9"),
    ] {
        assert!(honest.contains(old), "{old}");
        fs::write(&file, honest.replace(old, new)).unwrap();
        let (code, told) = verified(folder.path());
        assert_ne!(code, Some(0), "{old} as {new}: {told}");
    }
}

/// A Hopf point beside what a stop holds, whose force is in the friction: with y = 1, w = 0 it is one of two states, of which the same
/// formulas give 40 digits of m, ω and l₁. In the mode coupling of a brake, which is affine, it is at mu = 0.2055 with ω² = 11.
#[test]
fn hopf_points_of_modes_that_contacts_make() {
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(PRESSED, folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let hopf = of_type(&rows, "HB");
    encloses(hopf[0], VALUE, 0.008_390_983_231_158_686, 1e-13);
    encloses(hopf[0], OMEGA, 1.552_891_842_207_146_7, 1e-14);
    encloses(hopf[0], LYAPUNOV, -0.672_562_803_052_45, 1e-12);
    assert_eq!(hopf[0]["growing"], "0");
    assert_eq!(verified(folder.path()).0, Some(0));

    let brake = problem("brake_coupling");
    let (system, _) = brake.split_once("    orbit:").unwrap();
    let text = format!(
        r#"{system}    equilibrium: (start: Given(mode: "closed.backward", state: {{"x": 0.02, "v": 0, "y": -0.18, "u": 0}})),
            continuation: (parameter: "mu", range: (0.0, 0.45), toward: Down),
        )"#
    );
    let (code, rows) = certified(&text, folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let hopf = of_type(&rows, "HB");
    encloses(hopf[0], VALUE, 0.2055, 1e-13);
    encloses(hopf[0], OMEGA, f64::sqrt(11.0), 1e-14);
    let lyapunov = LYAPUNOV.map(|column| hopf[0][column].parse::<f64>());
    assert_eq!(lyapunov, [Ok(0.0), Ok(0.0)]);
    assert_eq!(hopf[0]["growing"], "0");
}

/// In modes of one's own that have contacts a boundary is one of the mode or one of a contact.
#[test]
fn boundaries_of_own_modes_and_of_their_contacts() {
    let text = r#"(
        system: (
            states: ["x", "v"], parameters: {"F": 0.2, "d": 0.5, "k": 2.0},
            contacts: {"p": Stop(gap: "d - x", restitution: "0.5")},
            modes: {
                "soft": (rates: {"x": "v", "v": "-x - 0.1*v + F - p"}, until: [(zero: "x + 1", to: "hard")]),
                "hard": (rates: {"x": "v", "v": "-x - 0.1*v + F - p - k*(x + 1)"}, until: [(zero: "-1 - x", to: "soft")]),
            },
        ),
        equilibrium: (start: Given(mode: "soft.open", state: {"x": 0.2, "v": 0.0})),
        continuation: (parameter: "F", range: (-5.0, 5.0), toward: Both),
    )"#;
    let folder = TempDir::new().unwrap();
    let (code, rows) = certified(text, folder.path());
    assert_eq!(code, Some(0), "{rows:?}");
    let boundary = of_type(&rows, "BE");
    for (row, (value, beyond)) in boundary
        .iter()
        .zip([(-1.0, "hard.open"), (0.5, "soft.closed")])
    {
        encloses(row, VALUE, value, 1e-14);
        assert_eq!([&*row["beyond"], &*row["persists"]], [beyond, "yes"]);
    }
    assert_eq!(boundary.len(), 2);
}
