//! Pictures that show what is said of them; the discretised ring under the laws of a problem.

use std::fs;

use crate::harness::{Bench, PROBLEMS, Table, changed, problem};

#[allow(dead_code)]
#[path = "../../examples/paper_figures.rs"]
mod paper_figures;

/// The counterpart of figure 7 draws the wave that its caption speaks of: parameters, reverse zone,
/// table and heading.
#[test]
fn figure_7_is_the_wave_of_its_caption() {
    let figure = paper_figures::FIGURES
        .iter()
        .find(|figure| figure.name == "figure_7_reverse")
        .expect("figure 7");
    let bench = Bench::new();
    let file = format!("{PROBLEMS}/{}.ron", figure.problem);
    bench
        .run(&["run", &file, "--out", "out", "--quiet"])
        .expect(0);
    let out = bench.path("out");
    let label = figure
        .table
        .trim_start_matches("profiles/")
        .trim_end_matches(".csv");
    let events = Table::read(&out.join("events.csv"));
    let row = (0..events.rows.len())
        .find(|row| events.text(*row, "label") == label)
        .expect("the label of the table is an event");
    for (column, name, value) in [
        ("mismatch", "δ = 0.02677", 0.026773139826513),
        ("friction", "f = 0.446", 0.44610776254161),
        ("nu", "ν = 0.25", 0.25),
        ("xi", "ξ = 1.25", 1.25),
    ] {
        assert!(figure.caption.contains(name), "{name}");
        assert!((events.number(row, column) / value - 1.0).abs() < 1e-12);
    }
    assert!((events.number(row, "speed") / -1.2006413956628 - 1.0).abs() < 1e-11);
    // the zone as the caption has it, to its two digits
    assert!(
        figure
            .caption
            .contains("from 0.62 to 0.73 of the wavelength 0.785")
    );
    let profile = Table::read(&out.join(figure.table));
    let reverse: Vec<f64> = (0..profile.rows.len())
        .filter(|row| profile.text(*row, "regime") == "reverse")
        .map(|row| profile.number(row, "theta"))
        .collect();
    let (from, to) = (reverse[0], reverse[reverse.len() - 1]);
    assert!(
        (from - 0.62).abs() < 0.005 && (to - 0.73).abs() < 0.005,
        "{from} {to}"
    );
    // the picture is that of this mismatch, not of another wave of the branch
    let svg = fs::read_to_string(out.join(format!("{}.svg", figure.picture))).expect("the picture");
    assert!(svg.contains("at δ = 0.02677:"), "another wave is drawn");
}

/// Speed and leading eigenvalue of sector 0 of the ring.
fn ring(bench: &Bench, more: &[&str]) -> (f64, f64) {
    let arguments = ["spectrum", "problem.ron", "--sector", "0", "--discretised"];
    let outcome = bench.run(&[&arguments[..], more].concat()).expect(0);
    let table = Table::parse(outcome.stdout.as_bytes());
    (table.number(0, "speed"), table.number(0, "re"))
}

/// A problem of one wave under a law.
fn under(law: &str) -> String {
    changed(
        crate::harness::SMALL,
        "mismatch: 0.2,\n    )",
        &format!("mismatch: 0.2,\n        friction_law: {law},\n    )"),
    )
}

/// The ring has the smoothing of the problem; its speed tends to that of the wave under this law, of
/// second order in the spacing.
#[test]
fn the_discretised_ring_has_the_smoothing_of_the_problem() {
    let bench = Bench::new();
    bench.put("problem.ron", under("Regularised(epsilon: 0.1)"));
    // exact speed of problems/mode4_regularised.ron at ε = 0.1
    let exact = -1.253000909251309;
    assert!(problem("mode4_regularised.ron").contains("smoothing: 0.1, speed: -1.253000909251309"));
    let error = |points: &str| (ring(&bench, &[points]).0 / exact - 1.0).abs();
    let (coarse, fine) = (error("30"), error("60"));
    assert!(
        fine < 2e-3 && (coarse / fine - 4.0).abs() < 0.5,
        "{coarse:e} {fine:e}"
    );
    // the same as Coulomb's law smoothed as much, up to the wave it starts from
    let own = ring(&bench, &["40"]);
    bench.put("problem.ron", under("Coulomb"));
    let smoothed = ring(&bench, &["40", "--epsilon", "0.1"]);
    assert!((own.0 / smoothed.0 - 1.0).abs() < 1e-9 && (own.1 - smoothed.1).abs() < 1e-7);
    assert!((own.0 / ring(&bench, &["40"]).0 - 1.0).abs() > 1e-3);
}

#[test]
fn rings_that_are_not_posed_are_refused() {
    let bench = Bench::new();
    let refused = |more: &[&str], words: &[&str]| {
        let arguments = ["spectrum", "problem.ron"];
        let stderr = bench.run(&[&arguments[..], more].concat()).expect(2).stderr;
        for word in words {
            assert!(stderr.contains(word), "no {word} in {stderr}");
        }
    };
    for law in ["Static(ratio: 1.2)", "Stribeck(ratio: 1.2, velocity: 0.5)"] {
        bench.put("problem.ron", under(law));
        refused(&["--discretised", "40"], &["friction_law"]);
    }
    bench.put("problem.ron", under("Regularised(epsilon: 0.1)"));
    let both = ["--discretised", "40", "--epsilon", "0.1"];
    refused(&both, &["friction_law", "smoothing"]);
    bench.put("problem.ron", under("Coulomb"));
    for points in ["0", "7", "-3", "many"] {
        refused(&["--discretised", points], &[points]);
    }
    for points in [
        "4001",
        "100000000000",
        "18446744073709551615",
        "340282366920938463463374607431768211455",
    ] {
        refused(&["--discretised", points], &["GB", "4000"]);
    }
    for epsilon in ["0", "-0.1", "nan", "inf", "wide"] {
        refused(
            &["--discretised", "40", "--epsilon", epsilon],
            &["positive"],
        );
    }
}
