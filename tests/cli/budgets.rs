//! Every run ends, and says why: most points, branches that never arrive, limits, absurd requests.

use crate::cli::harness::{Bench, SMALL, Table, changed, off};

/// Runs a problem and returns its branch, its last row's reason and what was said on stderr.
fn run(text: &str, code: i32) -> (Table, Table, String) {
    let bench = Bench::new();
    bench.put("problem.ron", text);
    let outcome = bench
        .run(&["run", "problem.ron", "--out", "out"])
        .expect(code);
    let out = bench.path("out");
    (
        Table::read(&out.join("branch.csv")),
        Table::read(&out.join("events.csv")),
        outcome.stderr,
    )
}

/// Rows of a leg, and the type of the last of them.
fn leg(branch: &Table, number: &str) -> (usize, String) {
    let rows: Vec<usize> = (0..branch.rows.len())
        .filter(|row| branch.text(*row, "leg") == number)
        .collect();
    let last = rows.last().expect("the leg has points");
    (rows.len(), branch.text(*last, "type").to_owned())
}

/// `max_points` counts in each leg; its end is a failure, all that was found is kept, and the other
/// leg is followed all the same.
#[test]
fn most_points_are_an_end_with_its_reason() {
    let few = changed(SMALL, "ds_max: 0.02,", "ds_max: 0.02, max_points: 7,");
    let (branch, events, stderr) = run(&few, 3);
    assert!(stderr.contains("max_points = 7"), "{stderr}");
    assert_eq!(leg(&branch, "1"), (8, "MX".to_owned()));
    let last = events.rows.len() - 1;
    assert_eq!(events.text(last, "type"), "MX");
    assert!(events.text(last, "what").contains("max_points = 7"));

    let both = changed(&few, "range: (0.19, 0.2)", "range: (0.19, 0.21)");
    let (branch, _, _) = run(&changed(&both, "toward: Down", "toward: Both"), 3);
    for number in ["1", "2"] {
        assert_eq!(leg(&branch, number), (8, "MX".to_owned()));
    }

    // what was asked for is no failure
    let until = "stop_after: [(event: UZ, count: 1)],";
    let enough = changed(SMALL, "stop_at:", &format!("{until} stop_at:"));
    let (branch, ..) = run(&enough, 0);
    assert_eq!(leg(&branch, "1").1, "UZ");
}

/// A tolerance below rounding asks for what rounding allows: the same events in as many steps, not
/// 100 000 points of nothing.
#[test]
fn a_tolerance_below_rounding_does_not_creep() {
    let problem = |tolerance: &str| {
        format!(
            "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
             mismatch: 0.2), wave: (mode: 4, start: Fast), continuation: (parameter: Mismatch, \
             range: (0.03, 0.2), toward: Down, tolerance: {tolerance}))"
        )
    };
    let (branch, events, _) = run(&problem("1e-10"), 0);
    let (found, strict, _) = run(&problem("1e-17"), 0);
    assert!(
        found.rows.len() < 2 * branch.rows.len(),
        "{}",
        found.rows.len()
    );
    assert_eq!(strict.rows.len(), events.rows.len());
    for row in 0..events.rows.len() {
        let error = off(strict.number(row, "speed"), events.number(row, "speed"));
        assert!(error < 1e-12, "{error}");
    }
}

/// Branches that wind up, a bounce of the surface more with each turn, and never come down to the
/// mismatch asked for. They were followed for 100 000 steps.
#[test]
fn a_branch_that_winds_does_not_start() {
    let models = [
        // mode 6: turns between δ = 0.09 and 0.1 for ever, far above δ = 0.014
        "(model: (coefficients: Geometry(nu: 0.0543047829751004, xi: 2.2190138649013544, \
         gamma: 2.2761687225675398), friction: 0.1375035781455164, mismatch: 0.013983490909273883), \
         wave: (mode: 6, start: Fast), \
         continuation: (parameter: Friction, range: (0.026816841793337123, 0.2392976966504612)))",
        // a slow wave next to its limit √a
        "(model: (coefficients: Geometry(nu: -0.999999, xi: 1.0237602781246635, gamma: 1.0), \
         friction: 0.8640954570553661, mismatch: 4.924178737515484e-05), \
         wave: (mode: 1, start: Slow), \
         continuation: (parameter: MassDamping, range: (0.0, 0.1)))",
    ];
    for model in models {
        let bench = Bench::new();
        bench.put("problem.ron", model);
        let outcome = bench.run(&["run", "problem.ron"]).expect(3);
        let stderr = &outcome.stderr;
        assert!(stderr.contains("winds through 40 folds in "), "{stderr}");
        let steps = stderr
            .split_once("folds in ")
            .and_then(|(_, rest)| rest.split_whitespace().next())
            .and_then(|word| word.parse::<usize>().ok())
            .expect("the message counts steps");
        assert!(steps < 5000, "{steps} steps");
        assert_eq!(bench.names(), ["problem.ron"]);
    }
}

/// The damped slow branch tends to |c| = √a: the excess speed falls without end while all else has a
/// limit. The limit of the mismatch, 1.1980374, is that of a branch followed 16 e-folds further.
#[test]
fn a_branch_that_tends_to_the_sonic_limit_says_so() {
    let problem = "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.5, \
         mismatch: 0.8, damping: (mass: 0.02, stiffness: 0.0)), wave: (mode: 4, start: Slow), \
         continuation: (parameter: Mismatch, range: (0.05, 20), toward: Down))";
    let (branch, events, stderr) = run(problem, 3);
    assert!(stderr.contains("the speed tends to √a"), "{stderr}");
    assert!(branch.rows.len() < 1300, "{} rows", branch.rows.len());
    let last = events.rows.len() - 1;
    assert_eq!(events.text(last, "type"), "MX");
    let a = 1.0875712069293_f64;
    assert!(off(events.number(last, "speed").abs(), a.sqrt()) < 1e-4);
    assert!(off(events.number(last, "mismatch"), 1.1980374) < 1e-3);
}

/// A spectrum of a million frequencies is refused before it is begun.
#[test]
fn absurd_frequencies_are_refused() {
    let bench = Bench::new();
    let wanted = "stability: (sectors: All, eigenvalues: 1, max_frequency: 1e6), output:";
    bench.put("problem.ron", changed(SMALL, "output:", wanted));
    let outcome = bench.run(&["run", "problem.ron"]).expect(2);
    let stderr = &outcome.stderr;
    assert!(stderr.contains("max_frequency = 1e6"), "{stderr}");
    assert!(stderr.contains("lower it below"), "{stderr}");
}

/// Under regularised friction the branch meets D = 0 in waves of every amplitude, a vertical line. It was
/// followed down to rest and back again on the same waves half a turn on, with a dozen folds of rounding.
#[test]
fn regularised_friction_ends_where_nothing_drives_the_wave() {
    let problem = "(model: (coefficients: Geometry(nu: 0.4155, xi: 2.211416854515969, \
         gamma: 5.958841045184008), friction: 0.5907392485733198, mismatch: 0.2360285504611487, \
         friction_law: Regularised(epsilon: 0.05)), method: Collocation(intervals: 60, degree: 4), \
         wave: (mode: 2, start: Fast), continuation: (parameter: Nu, range: (0.41, 0.4155), \
         toward: Down, tolerance: 5e-16, max_points: 300))";
    let (branch, events, stderr) = run(problem, 3);
    assert!(stderr.contains("D = 0: nothing drives a wave"), "{stderr}");
    let types: Vec<&str> = (0..events.rows.len())
        .map(|row| events.text(row, "type"))
        .collect();
    assert_eq!(types, ["EP", "MX"]);
    assert!(branch.rows.len() < 100, "{} rows", branch.rows.len());
}
