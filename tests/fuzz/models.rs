//! Random valid problem files for every verb.

use crate::cli::harness::Bench;
use crate::fuzz::dice::Dice;
use crate::fuzz::watch::Record;

/// A random problem with all that the verb needs.
pub fn problem(dice: &mut Dice, verb: &str) -> String {
    let (nu, xi, gamma) = (
        dice.uniform(-0.5, 0.49),
        1.0 + dice.logarithmic(0.02, 2.0),
        dice.logarithmic(1e-3, 1e3),
    );
    let friction = dice.logarithmic(0.01, 1.6);
    let mismatch = gamma.sqrt() * dice.logarithmic(1e-3, 30.0);
    let mode = 1 + dice.below(16);
    let scale = gamma.sqrt();
    let mass = if dice.happens(0.3) {
        dice.logarithmic(1e-3, 0.5) / scale
    } else {
        0.0
    };
    let given = dice.happens(0.15);
    let law = match dice.below(12) {
        0 => format!("Static(ratio: {})", dice.uniform(1.0, 1.6)),
        1 => format!(
            "Stribeck(ratio: {}, velocity: {})",
            dice.uniform(1.0, 1.5),
            dice.logarithmic(0.05, 5.0)
        ),
        2 => format!("Regularised(epsilon: {})", dice.logarithmic(1e-3, 0.2)),
        _ => "Coulomb".into(),
    };
    let stiffness = if dice.happens(0.15) && law == "Coulomb" {
        dice.logarithmic(1e-6, 0.05) * scale
    } else {
        0.0
    };
    let coefficients = if given {
        let a = dice.logarithmic(0.1, 100.0);
        format!(
            "Given(a: {a}, b: {}, D: {}, g: {}, h: {})",
            a * dice.uniform(0.05, 0.95),
            a.sqrt() * dice.uniform(-2.0, 2.0),
            a * dice.logarithmic(0.5, 50.0),
            a * dice.logarithmic(0.3, 20.0)
        )
    } else {
        format!("Geometry(nu: {nu}, xi: {xi}, gamma: {gamma})")
    };
    let impact = if dice.happens(0.2) && stiffness == 0.0 {
        "Coulomb"
    } else {
        "Frictionless"
    };
    let start = if dice.happens(0.5) { "Fast" } else { "Slow" };
    let parameters = [
        ("Mismatch", mismatch),
        ("Friction", friction),
        ("Gamma", gamma),
        ("Nu", nu),
        ("Xi", xi),
        ("MassDamping", mass),
    ];
    let usable = match (given, mass > 0.0) {
        (true, _) => 2,
        (false, false) => 5,
        (false, true) => 6,
    };
    // the mismatch is what most people vary
    let (parameter, value) = match verb {
        "map" | "curve" => parameters[0],
        _ if dice.happens(0.5) => parameters[0],
        _ => parameters[dice.below(usable)],
    };
    let (low, high) = match parameter {
        "Nu" => (value - dice.uniform(0.001, 0.1), (value + 0.009).min(0.499)),
        "Xi" => (1.0 + (value - 1.0) * 0.7, value + dice.uniform(0.01, 0.5)),
        _ => (
            value * dice.logarithmic(0.01, 0.9),
            value * dice.uniform(1.01, 2.0),
        ),
    };
    let toward = dice.pick(&["Down", "Up", "Both"]);
    let mut sections = String::new();
    if dice.happens(0.4) || verb == "spectrum" {
        let sectors = if dice.happens(0.7) {
            "All"
        } else {
            "Only([0])"
        };
        sections += &format!(
            "stability: (sectors: {sectors}, eigenvalues: {}, max_frequency: {}),\n",
            1 + dice.below(6),
            dice.logarithmic(1.0, 20.0) / scale
        );
    }
    match verb {
        "map" => {
            sections += &format!(
                "map: (first: (parameter: Friction, range: ({friction}, {})), \
                 second: (parameter: Mismatch, range: ({low}, {high})), \
                 points: Grid(rows: {}, columns: {}), starts: [Fast, Slow]),\n",
                friction * 1.3,
                2 + dice.below(3),
                2 + dice.below(6),
            );
        }
        "curve" => {
            sections += &format!(
                "curve: (event: {}, parameters: (Mismatch, Friction), \
                 range: (({low}, {high}), ({}, {}))),\n",
                dice.pick(&["GR", "RV", "CO", "ST", "LP"]),
                friction * 0.7,
                friction * 1.3
            );
        }
        "simulate" => {
            let ring = dice.happens(0.7) || given;
            let body = if ring {
                format!(
                    "Ring(points: {}, friction: {})",
                    mode.max(3) * (8 + dice.below(20)),
                    dice.pick(&["SetValued", "Tanh(epsilon: 0.05)"])
                )
            } else {
                format!(
                    "Annulus(around: {}, across: {})",
                    8 * mode,
                    2 + dice.below(3)
                )
            };
            let every = scale * dice.logarithmic(0.01, 0.1);
            sections += &format!(
                "simulation: (body: {body}, start: SteadySliding, \
                 perturbation: (mode: {mode}, amplitude: {}), duration: {}, every: {every}, \
                 snapshots: {}),\n",
                mismatch * dice.logarithmic(1e-4, 0.3),
                every * dice.uniform(1.0, 60.0),
                dice.below(4)
            );
        }
        _ => {}
    }
    if dice.happens(0.3) {
        let plots = if sections.contains("stability") {
            "Diagram, Pressure, Displacement, Spectrum, Multipliers"
        } else {
            "Diagram, Displacement, PhasePlane, Friction"
        };
        sections += &format!(
            "output: (plots: [{plots}], profiles: {}),\n",
            1 + dice.below(5)
        );
    }
    let law = match law.as_str() {
        "Coulomb" => String::new(),
        law => format!("friction_law: {law},"),
    };
    format!(
        "(model: (coefficients: {coefficients}, friction: {friction}, mismatch: {mismatch}, \
         damping: (mass: {mass}, stiffness: {stiffness}), impact: {impact}, {law}),\n\
         wave: (mode: {mode}, start: {start}),\n\
         continuation: (parameter: {parameter}, range: ({low}, {high}), toward: {toward}, \
         max_points: {}),\n{sections})\n",
        50 + dice.below(1000)
    )
}

/// The words that run a verb on `problem.ron` with the results in `out`.
pub fn words<'a>(dice: &mut Dice, verb: &'a str) -> Vec<&'a str> {
    let mut words = vec![verb, "problem.ron"];
    match verb {
        "run" | "map" | "curve" | "simulate" => words.extend(["--out", "out"]),
        "accuracy" => words.extend(["--out", "out", "--budget", "2", "--repeats", "1"]),
        "steady" => words.extend(["--modes", "1..6"]),
        "spectrum" if dice.happens(0.3) => words.extend(["--sector", "0"]),
        "spectrum" if dice.happens(0.2) => words.extend(["--discretised", "40"]),
        _ => {}
    }
    words
}

/// Verbs that read a problem file, by how often they are used.
pub const VERBS: [&str; 12] = [
    "run", "run", "run", "run", "check", "check", "spectrum", "steady", "simulate", "curve", "map",
    "accuracy",
];

#[test]
fn random_models_end_by_the_contract() {
    let mut record = Record::default();
    for index in 0..crate::fuzz::inputs(25) {
        let mut dice = Dice::new("models", index);
        let verb = *dice.pick(&VERBS);
        let text = problem(&mut dice, verb);
        let bench = Bench::new();
        let path = bench.put("problem.ron", &text);
        record.input();
        let words = words(&mut dice, verb);
        // nothing is wrong with the disk, and a file without `expect` has nothing unmet
        record.run(&bench, &words, &[0, 2, 3], &text);
        record.untouched(&path, text.as_bytes(), verb);
    }
    record.close("random models");
}
