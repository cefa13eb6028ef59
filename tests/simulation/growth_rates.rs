//! Growth rates that `simulate` measures, against the eigenfunction problem: their errors hold, and so does
//! what is said of their sign.

use std::collections::HashMap;
use std::fs;

use crate::simulation::verb::Bench;

/// Rows of a table by the names of its columns.
fn rows(text: &str) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows = reader.deserialize().collect::<Result<_, _>>();
    rows.expect("a table")
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().expect("a number")
}

/// A wave, a Bloch sector of it, and the pairs of runs that measure it on a ring of 96 points.
struct Case {
    model: &'static str,
    mode: u32,
    mismatch: &'static str,
    sector: usize,
    pairs: usize,
}

/// Measures the growth rates of a wave; what is said of the sign of each, how far it is off, and its error.
fn measured(case: &Case) -> Vec<(String, f64, f64)> {
    let Case {
        model,
        mode,
        mismatch,
        sector,
        pairs,
    } = case;
    let problem = |more: &str| {
        format!(
            "(model: ({model}, mismatch: 0.4), wave: (mode: {mode}, start: Fast),
             continuation: (parameter: Mismatch, range: ({mismatch}, 0.4), toward: Down),
             output: (profiles: 1), {more})"
        )
    };
    let bench = Bench::new(&problem(""));
    bench.run(&["run", "p.ron", "--out", "wave", "--quiet"], 0);
    let branch = fs::read_to_string(bench.path("wave/branch.csv")).expect("a branch");
    let last = rows(&branch).pop().expect("a point");
    let simulation = format!(
        "simulation: (body: Ring(points: 96), circle: Wavelength, duration: 0.1, courant: 0.2,
                      start: Wave(dir: \"wave\", label: {}),
                      growth: (sectors: Only([{sector}]), pairs: {pairs}, amplitude: 1e-6))",
        last["label"]
    );
    fs::write(bench.path("s.ron"), problem(&simulation)).expect("a file");
    bench.run(&["simulate", "s.ron", "--out", "s"], 0);
    let stability = "stability: (sectors: All, eigenvalues: 24, max_frequency: 12.0)";
    fs::write(bench.path("e.ron"), problem(stability)).expect("a file");
    let (at, sector) = (format!("mismatch={mismatch}"), sector.to_string());
    let out = [
        "spectrum", "e.ron", "--at", &at, "--sector", &sector, "--csv",
    ];
    let said = bench.run(&out, 0);
    // rows have many columns, warnings a comma or two
    let row = |line: &&str| line.matches(',').count() > 4;
    let table: Vec<&str> = said.lines().filter(row).collect();
    let both = *sector == *"0" || 2 * case.sector == *mode as usize;
    let exact: Vec<[f64; 2]> = (rows(&table.join("\n")).iter())
        .map(|row| [number(row, "re"), number(row, "im")])
        .flat_map(|[re, im]| [[re, im], [re, if both { -im } else { im }]])
        // translation is not listed
        .chain((case.sector == 0).then_some([0.0; 2]))
        .collect();
    let growth = fs::read_to_string(bench.path("s/growth.csv")).expect("growth rates");
    let row = |row: &HashMap<String, String>| {
        let (re, im, error) = (number(row, "re"), number(row, "im"), number(row, "error"));
        let off = |[a, b]: &[f64; 2]| (a - re).hypot(b - im);
        let nearest = exact
            .iter()
            .min_by(|one, other| off(one).total_cmp(&off(other)));
        let nearest = nearest.expect("an eigenvalue");
        println!("observed: {re:+.4} {im:+.4}i ± {error:.4}, exact {nearest:?}");
        match row["grows"].as_str() {
            "yes" => assert!(nearest[0] > 0.0, "{re} {im} {nearest:?}"),
            "no" => assert!(nearest[0] < 0.0, "{re} {im} {nearest:?}"),
            "undecided" => assert!(re.abs() <= error),
            other => panic!("{other}"),
        }
        (row["grows"].clone(), off(nearest), error)
    };
    rows(&growth).iter().map(row).collect()
}

const CASES: [Case; 4] = [
    // the landing is arrested at V̇ = 1 and goes on in reverse slip, without stick
    Case {
        model: "coefficients: Geometry(nu: 0.27, xi: 1.43, gamma: 1.3), friction: 0.43, impact: Coulomb",
        mode: 3,
        mismatch: "0.015",
        sector: 1,
        pairs: 30,
    },
    // a coarse eigenvalue is near by accident
    Case {
        model: "coefficients: Geometry(nu: 0.263, xi: 1.529, gamma: 0.725), friction: 0.441, impact: Coulomb",
        mode: 3,
        mismatch: "0.0135",
        sector: 0,
        pairs: 60,
    },
    Case {
        model: "coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5",
        mode: 4,
        mismatch: "0.2",
        sector: 1,
        pairs: 30,
    },
    Case {
        model: "coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, damping: (stiffness: 0.005)",
        mode: 4,
        mismatch: "0.2",
        sector: 0,
        pairs: 30,
    },
];

#[test]
fn measured_growth_rates_hold_within_their_errors() {
    let mut seen = [0_usize; 3];
    for (index, case) in CASES.iter().enumerate() {
        let found = measured(case);
        assert!(!found.is_empty(), "case {index}");
        for (grows, off, error) in found {
            assert!(off <= error, "case {index}: {off:e} {error:e}");
            let kind = ["yes", "no", "undecided"]
                .iter()
                .position(|kind| *kind == grows);
            seen[kind.expect("one of three")] += 1;
        }
    }
    // every answer occurs: an error that excluded none of them would say nothing
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
}
