//! Pictures that show what is said of them; the discretised ring under the laws of a problem.

use std::fs;
use std::path::Path;

use crate::cli::harness::{Bench, Table, changed, problem};

#[allow(dead_code)]
#[path = "../../examples/paper_figures.rs"]
mod paper_figures;

fn figure(name: &str) -> &'static paper_figures::Figure {
    let mut figures = paper_figures::FIGURES.iter();
    let found = figures.find(|figure| figure.name.starts_with(name));
    found.unwrap_or_else(|| panic!("{name}"))
}

/// Computes a figure; its picture and its table.
fn computed(figure: &paper_figures::Figure, bench: &Bench) -> (String, Table) {
    let program = Path::new(env!("CARGO_BIN_EXE_brakewave"));
    let files = figure.compute(program, &bench.path(""));
    let [picture, table] = files.unwrap_or_else(|error| panic!("{}: {error}", figure.name));
    let svg = fs::read_to_string(picture).expect("the picture");
    (svg, Table::read(&table))
}

/// Places of the samples in a regime.
fn zone(profile: &Table, regime: &str) -> Vec<f64> {
    let rows = (0..profile.rows.len()).filter(|row| profile.text(*row, "regime") == regime);
    rows.map(|row| profile.number(row, "theta")).collect()
}

/// The paper has figures 2 to 9 with curves, the last in two parts; what is changed in their problems is
/// there.
#[test]
fn every_figure_of_the_paper_has_a_counterpart() {
    for number in 2..=9 {
        let figure = figure(&format!("figure_{number}_"));
        let text = figure.text().expect("its problem");
        for (_, to) in figure.changes {
            assert!(text.contains(to), "{to}");
        }
    }
    for name in ["figure_9_velocity", "figure_9_phase_plane"] {
        figure(name);
    }
}

/// Figure 2 shows the two waves of its caption, figures 4 and 5 the events of theirs.
#[test]
fn figures_of_mode_4_show_their_waves() {
    let bench = Bench::new();
    let (svg, profile) = computed(figure("figure_2_"), &bench);
    assert!(
        svg.contains(">\n0.2\n<") && svg.contains(">\n0.001\n<"),
        "two waves"
    );
    let rows = 0..profile.rows.len();
    let mut regimes: Vec<&str> = rows.map(|row| profile.text(row, "regime")).collect();
    regimes.dedup();
    assert_eq!(regimes, ["slip", "separation", "slip", "stick"]);
    for (name, event, value) in [
        ("figure_4_", "GR", "0.05023"),
        ("figure_5_", "CO", "0.02348"),
    ] {
        let figure = figure(name);
        let (_, branch) = computed(figure, &bench);
        let row = (0..branch.rows.len()).find(|row| branch.text(*row, "type") == event);
        let found = branch.number(row.expect(event), "mismatch");
        assert_eq!(format!("{found:.5}"), value);
        assert!(figure.caption.contains(value));
    }
}

/// The counterpart of figure 7 draws the wave that its caption speaks of: parameters, reverse zone,
/// table and heading. That of figure 6 is the same wave.
#[test]
fn figure_7_is_the_wave_of_its_caption() {
    let bench = Bench::new();
    let figure = figure("figure_7_");
    let (svg, profile) = computed(figure, &bench);
    let folder = bench.path("results").join(figure.name);
    let branch = Table::read(&folder.join("branch.csv"));
    let label = figure.table.trim_start_matches("profiles/");
    let label = label.trim_end_matches(".csv");
    let row = (0..branch.rows.len())
        .find(|row| branch.text(*row, "label") == label)
        .expect("the label of the table is on the branch");
    for (column, name, value) in [
        ("mismatch", "δ = 0.02677", 0.026773139826513),
        ("friction", "f = 0.446", 0.44610776254161),
        ("nu", "ν = 0.25", 0.25),
        ("xi", "ξ = 1.25", 1.25),
    ] {
        assert!(figure.caption.contains(name), "{name}");
        assert!((branch.number(row, column) / value - 1.0).abs() < 1e-12);
    }
    assert!((branch.number(row, "speed") / -1.2006413956628 - 1.0).abs() < 1e-11);
    // the zone as the caption has it, to its two digits
    let said = "from 0.62 to 0.73 of the wavelength 0.785";
    assert!(figure.caption.contains(said));
    let reverse = zone(&profile, "reverse");
    let (from, to) = (reverse[0], reverse[reverse.len() - 1]);
    assert!(
        (from - 0.62).abs() < 0.005 && (to - 0.73).abs() < 0.005,
        "{from} {to}"
    );
    // the picture is that of this mismatch, not of another wave of the branch
    assert!(svg.contains("at δ = 0.02677:"), "another wave is drawn");
    let (_, phase_plane) = computed(self::figure("figure_6_"), &bench);
    assert_eq!(phase_plane.rows, profile.rows);
}

/// Multipliers of the ring from point to point: the foremost is one of a pair outside the unit circle, and
/// the picture says what μ and T are.
#[test]
fn figure_8_has_a_pair_outside_the_unit_circle() {
    let bench = Bench::new();
    let (svg, ring) = computed(figure("figure_8_"), &bench);
    let foremost = (0..ring.rows.len())
        .max_by(|one, other| {
            ring.number(*one, "re")
                .total_cmp(&ring.number(*other, "re"))
        })
        .expect("eigenvalues");
    assert!(ring.number(foremost, "re") > 0.1 && ring.number(foremost, "im") != 0.0);
    for words in [
        "μ = exp(λT), T = 2π/(100 k|c|)",
        "exact",
        "ring of 100 points",
    ] {
        assert!(svg.contains(words), "{words}");
    }
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
        crate::cli::harness::SMALL,
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
    bench.put("problem.ron", under("Static(ratio: 1.2)"));
    refused(&["--discretised", "40"], &["friction_law"]);
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
