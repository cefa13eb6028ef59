//! (γ, δ, α, β) → (s²γ, sδ, α/s, sβ) leaves the lengths of all zones alone and divides c and every
//! eigenvalue by s: an exact symmetry of the model. The whole answer follows it, and bit by bit where
//! s is a power of two, since then no number is rounded otherwise.

use brakewave::branch::{Stability, VerdictReason};
use brakewave::problem;

use crate::stability::observed;
use crate::stability::waves::{Rows, follow};

/// α, β, f, δ at the start, range of δ, `stability` but for the frequency, at s = 1.
struct Case {
    name: &'static str,
    damping: [f64; 2],
    friction: f64,
    range: [f64; 2],
    sectors: &'static str,
}

const CASES: [Case; 5] = [
    Case {
        name: "undamped, through a change of regime and several HB",
        damping: [0.0, 0.0],
        friction: 0.5,
        range: [0.06, 0.1],
        sectors: "All",
    },
    Case {
        name: "with separation",
        damping: [0.0, 0.0],
        friction: 0.5,
        range: [0.0485, 0.0505],
        sectors: "All",
    },
    Case {
        name: "proven stable",
        damping: [0.3172, 0.0],
        friction: 0.5,
        range: [0.199, 0.2],
        sectors: "All",
    },
    Case {
        name: "one sector",
        damping: [0.26, 0.0],
        friction: 0.5,
        range: [0.19, 0.2],
        sectors: "Only([0])",
    },
    Case {
        name: "material damping",
        damping: [0.05, 1e-3],
        friction: 0.5,
        range: [0.195, 0.2],
        sectors: "All",
    },
];

/// The window is the one assumed, which scales with the model.
fn run(case: &Case, s: f64) -> Rows {
    let [alpha, beta] = [case.damping[0] / s, case.damping[1] * s];
    let [low, high] = case.range.map(|delta| delta * s);
    let text = format!(
        "(model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: {:?}), friction: {:?}, \
         mismatch: {high:?}, damping: (mass: {alpha:?}, stiffness: {beta:?})), \
         wave: (mode: 4, start: Fast), \
         continuation: (parameter: Mismatch, range: ({low:?}, {high:?}), toward: Down), \
         stability: (sectors: {}, eigenvalues: 6), \
         output: (plots: [], profiles: 3))",
        s * s,
        case.friction,
        case.sectors
    );
    let problem = problem::parse(&text, case.name).expect("a problem");
    follow(&problem, &text)
}

/// Every number of stability in a run, times s where it is a rate, and the words with them.
fn answers(rows: &Rows, s: f64) -> (Vec<String>, Vec<f64>) {
    let mut words = Vec::new();
    let mut numbers = Vec::new();
    for item in &rows.items {
        let point = &item.point;
        let mut rates = Vec::new();
        for reason in &point.why {
            match reason {
                VerdictReason::BeyondWindow { re, im, .. } => rates.extend([*re, *im]),
                VerdictReason::HighFrequency(limit) | VerdictReason::Unsettled(limit) => {
                    rates.push(*limit)
                }
                _ => {}
            }
        }
        let lead = point.lead.expect("there is an eigenvalue");
        rates.extend([lead.re, lead.im]);
        rates.extend(
            item.eigenvalues
                .iter()
                .flat_map(|one| [one.re, one.im, one.error]),
        );
        numbers.extend(rates.into_iter().map(|rate| rate * s));
        numbers.push(point.model.mismatch / s);
        if let Some(event) = &item.event {
            numbers.extend(event.omega.map(|omega| omega * s));
        }
        let sectors: Vec<usize> = item.eigenvalues.iter().map(|one| one.sector).collect();
        words.push(format!(
            "{:?} {} {:?} {:?} {} {sectors:?} {:?}",
            point.kind,
            point.regimes,
            point.stable,
            point.unstable,
            lead.sector,
            point
                .why
                .iter()
                .map(std::mem::discriminant)
                .collect::<Vec<_>>(),
        ));
    }
    (words, numbers)
}

#[test]
fn the_whole_answer_scales() {
    /// Relative to the larger of a number and 1: α, δ and the frequency of the window are rounded
    /// otherwise where s is no power of two, and an eigenvalue moves by ε times its condition.
    const BOUND: f64 = 1e-9;
    let mut worst = 0.0_f64;
    for case in &CASES {
        let rows = run(case, 1.0);
        let proven = case.name == "proven stable";
        for item in &rows.items {
            assert_eq!(
                item.point.stable == Some(Stability::Yes),
                proven,
                "{}",
                case.name
            );
        }
        let (words, numbers) = answers(&rows, 1.0);
        // γ from 1e-8 to 1e12
        for s in [1e-4, 1e6, (-13_f64).exp2()] {
            let (other_words, others) = answers(&run(case, s), s);
            assert_eq!(other_words, words, "{}, s = {s}", case.name);
            assert_eq!(others.len(), numbers.len());
            let power = s.log2().fract() == 0.0 && case.damping[1] == 0.0;
            for (number, other) in numbers.iter().zip(&others) {
                let error = (number - other).abs() / number.abs().max(1.0);
                worst = worst.max(error);
                let bound = if power { 0.0 } else { BOUND };
                assert!(
                    error <= bound,
                    "{}, s = {s}: {other} for {number}",
                    case.name
                );
            }
        }
    }
    observed("eigenvalues of a scaled model", worst);
}

/// Where a flight closes the jump of a perturbation at its end is 0/0, and rounding alone gives it a length: what is said of the
/// spectrum there, and up to there, does not depend on the units.
#[test]
fn where_a_flight_closes_the_units_do_not_matter() {
    let counts = |s: f64| -> Vec<String> {
        let [low, high] = [0.0358, 0.13150263936514733].map(|delta| delta * s);
        let text = format!(
            "(model: (coefficients: Geometry(nu: 0.014, xi: 1.781, gamma: {:?}), friction: 0.284, mismatch: {high:?}), \
             wave: (mode: 4, start: Fast), \
             continuation: (parameter: Mismatch, range: ({low:?}, {high:?}), toward: Down, tolerance: 1e-13, ds_max: 0.1), \
             stability: (sectors: Only([0]), eigenvalues: 1, max_frequency: {:?}), output: (plots: []))",
            0.916 * s * s,
            2.0 / s,
        );
        let problem = problem::parse(&text, "a flight that closes").expect("a problem");
        let rows = follow(&problem, &text);
        let row = |point: &brakewave::branch::BranchPoint| {
            format!("{:?} {} {:?}", point.kind, point.regimes, point.unstable)
        };
        rows.items.iter().map(|item| row(&item.point)).collect()
    };
    let here = counts(1.0);
    // two flights, one of which closes, and then one
    let closes = "Some(CO) slip-separation-separation-slip-reverse-stick";
    let closed: Vec<&String> = here.iter().filter(|row| row.starts_with(closes)).collect();
    assert!(closed.len() > 1, "{here:?}");
    assert!(closed.iter().any(|row| row.ends_with("None")), "{closed:?}");
    for s in [0.37, 1e3] {
        assert_eq!(counts(s), here, "s = {s}");
    }
}
