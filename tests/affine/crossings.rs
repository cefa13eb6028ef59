//! Places where the equations of an orbit are singular: Hopf points through which an artificial section passes, and branches
//! that cross without a symmetry.

use std::sync::Arc;

use brakewave::EventType::{BP, EP, LP};
use brakewave::affine::orbit::start::{Beginning, Search, Wanted, first};
use brakewave::affine::orbit::{AffineOrbit, Critical, Setting};
use brakewave::continuation::newton;
use brakewave::linalg::Vector;
use brakewave::orbit::special::Special;

use crate::affine::branches::{follow, meets, settled};
use crate::affine::systems::system;

/// An orbit by Newton's method from a guess of its place and period.
fn guessed(
    text: &str,
    parameter: &str,
    mode: &str,
    state: &[f64],
    period: f64,
) -> (AffineOrbit, Vector) {
    let wanted = Wanted::new(system(text), parameter, (0.0, 0.2)).unwrap();
    let beginning = Beginning {
        mode: wanted.system.mode(mode).unwrap(),
        state: state.to_vec(),
        phase: 0.0,
    };
    first(&wanted, &beginning, Search::Guess(period)).unwrap()
}

/// Whether the last point of a branch is a Hopf point.
fn ends_at_hopf(all: &[brakewave::orbit::follow::LocatedPoint<AffineOrbit>]) -> bool {
    let last = all.last().unwrap();
    matches!(last.special, Some(Special::Own(Critical::Shrinking)))
}

/// An electronic circuit whose equilibrium 0 lies on the section y = 0. Its characteristic polynomial is
/// λ³ − (a + d)λ² + (ad − bc + 1)λ − a with a = −(be + nu)/r, b = be/r, c = be, d = −(be + ga): a pair is imaginary where
/// (a + d)(ad − bc + 1) = a, a quadratic equation in a. The fold and the branch point before it are the program's own.
#[test]
fn a_section_through_a_hopf_point() {
    const TOR: &str = r#"(
        states: ["x", "y", "z"],
        parameters: {"nu": -0.6, "be": 0.5, "ga": -0.6, "r": 0.6, "a3": 0.328578, "b3": 0.933578},
        define: {"fx": "(-(be + nu)*x + be*y - a3*x^3 + b3*(y - x)^3)/r", "fy": "be*x - (be + ga)*y - z - b3*(y - x)^3"},
        modes: {
            "up": (rates: {"x": "fx", "y": "fy", "z": "y"}, until: [(zero: "y", to: "down")]),
            "down": (rates: {"x": "fx", "y": "fy", "z": "y"}, until: [(zero: "-y", to: "up")]),
        },
    )"#;
    let (b, c, d): (f64, f64, f64) = (0.5 / 0.6, 0.5, 0.1);
    // da² + (d² − bc)a + d(1 − bc) = 0
    let (half, rest) = (0.5 * (d * d - b * c) / d, 1.0 - b * c);
    let a = -half - (half * half - rest).sqrt();
    let nu = -0.6 * a - 0.5;
    assert!((nu + 0.589_336_477_991_8).abs() < 1e-12, "{nu}");
    let (orbit, point) = guessed(TOR, "nu", "down", &[0.31167, 0.0, 0.38787], 8.12);
    let (seen, all) = follow(&orbit, &point, true, (-0.7, -0.5), 500);
    let expected = [
        (BP, -0.587_028_974_364_877, ""),
        (LP, -0.584_334_771_866_183, ""),
        (BP, nu, ""),
    ];
    meets(&seen, &expected, 1e-13);
    assert!(ends_at_hopf(&all));
    let hopf = all.last().unwrap();
    assert!((hopf.parameter - nu).abs() <= hopf.uncertainty.max(2.0 * f64::EPSILON));
    assert!(hopf.uncertainty < 1e-13, "{:e}", hopf.uncertainty);
}

/// The Brusselator, cut at x = A through its equilibrium (A, B/A), which loses its stability where B = 1 + A².
#[test]
fn a_section_through_the_equilibrium_of_the_brusselator() {
    const BRUSSELATOR: &str = r#"(
        states: ["x", "y"],
        parameters: {"A": 1.0, "B": 2.5},
        modes: {
            "up": (rates: {"x": "A + x^2*y - (B + 1)*x", "y": "B*x - x^2*y"}, until: [(zero: "A - x", to: "down")]),
            "down": (rates: {"x": "A + x^2*y - (B + 1)*x", "y": "B*x - x^2*y"}, until: [(zero: "x - A", to: "up")]),
        },
    )"#;
    for (a, start) in [(1.0, 2.2), (1.3, 2.9)] {
        let (orbit, point) = settled(
            BRUSSELATOR,
            &[("A", a), ("B", start)],
            "B",
            "up",
            &[0.5, 1.1],
            100.0,
        );
        let (seen, all) = follow(&orbit, &point, false, (1.0, 6.0), 500);
        meets(&seen, &[(BP, 1.0 + a * a, "")], 3e-14);
        assert!(ends_at_hopf(&all));
        // its period is that of the pair ±iA
        let hopf = all.last().unwrap();
        let cycle = hopf.orbit.cycle(&hopf.node.point).unwrap();
        let off = (cycle.period * a - std::f64::consts::TAU).abs();
        assert!(off < 1e-13, "{off:e}");
    }
}

/// A predator and its prey through a year: where the prey alone (y = 0) loses its stability to a predator, two branches
/// cross without a symmetry. Figure of an independent program in 16 digits.
#[test]
fn branches_cross_without_a_symmetry() {
    const SEASONS: &str = r#"(
        states: ["x", "y"],
        parameters: {"r": 6.28, "K": 1.0, "a": 12.56, "b0": 0.5, "e": 1.0, "d": 6.28, "eps": 0.2, "w": 6.283185307179586},
        forcing: "w",
        define: {"q": "a*x/(b0*(1 + eps*cos(phase)) + x)"},
        modes: {"only": (rates: {"x": "r*(1 - x/K)*x - q*y", "y": "e*q*y - d*y"}, until: [])},
    )"#;
    let (orbit, point) = settled(SEASONS, &[("b0", 0.9)], "b0", "only", &[0.3, 0.3], 300.0);
    let (seen, all) = follow(&orbit, &point, true, (0.1, 1.2), 500);
    let value = 1.010_178_708_707_521_8;
    meets(&seen, &[(BP, value, ""), (EP, 1.2, "")], 2e-14);
    let found = all.iter().find(|one| one.special.is_some()).unwrap();
    assert!(found.uncertainty < 1e-12, "{:e}", found.uncertainty);
    assert!((found.parameter - value).abs() <= found.uncertainty);
}

/// n cells x' = (p + cos t)x - x² + k(sum of all - nx): in step they follow Bernoulli's equation, whose mean is p, so that the n - 1
/// multipliers across it are exp(-2π(p + nk)). The equations of an orbit lose n - 1 ranks where they pass 1.
#[test]
fn many_branches_cross_where_a_symmetry_makes_multipliers_equal() {
    for (cells, words) in [(3, "two multipliers"), (4, "three multipliers")] {
        let names: Vec<String> = (1..=cells).map(|cell| format!("x{cell}")).collect();
        let sum = names.join(" + ");
        let rate = |x: &String| {
            format!("\"{x}\": \"(p + cos(phase))*{x} - {x}^2 + k*({sum} - {cells}*{x})\"")
        };
        let rates: Vec<String> = names.iter().map(rate).collect();
        let coupling = -1.2 / f64::from(cells);
        let text = format!(
            "(states: {names:?}, parameters: {{\"p\": 2.0, \"k\": {coupling:?}, \"w\": 1.0}}, forcing: \"w\", \
             modes: {{\"only\": (rates: {{{}}}, until: [])}})",
            rates.join(", ")
        );
        let (orbit, point) = settled(&text, &[], "p", "only", &vec![2.0; names.len()], 60.0);
        let (_, all) = follow(&orbit, &point, false, (0.9, 2.5), 500);
        let special: Vec<_> = all.iter().filter(|one| one.special.is_some()).collect();
        let [crossing, end] = &special[..] else {
            panic!("{cells}: {} events", special.len());
        };
        let (off, told) = ((crossing.parameter - 1.2).abs(), crossing.uncertainty);
        assert!(
            off <= told && told < 1e-10,
            "{cells}: {off:e}, told {told:e}"
        );
        let what = crossing.special.as_ref().unwrap().to_string();
        assert!(what.starts_with(words), "{what}");
        assert_eq!(end.parameter, 0.9);
    }
}

/// A state that decays to zero beside an oscillator is zero along the branch, whatever its rate makes of it in a period.
#[test]
fn a_state_that_decays_is_found() {
    const DECAYS: &str = r#"(
        states: ["x", "v", "z"],
        parameters: {"c": 0.1, "A": 2.0, "w": 1.5, "d": 1.0, "e": 0.8},
        forcing: "w",
        modes: {"free": (
            rates: {"x": "v", "v": "A*cos(phase) - c*v - x", "z": "-0.4*z"},
            until: [(zero: "d - x", to: "free", reset: {"v": "-e*v", "z": "0.5*z"})],
        )},
    )"#;
    let (orbit, point) = settled(DECAYS, &[], "A", "free", &[0.5, 0.0, 0.5], 300.0);
    let at = orbit.at(&point).unwrap();
    assert!(at.zones.iter().all(|zone| zone.state[2].abs() < 1e-15));
    let extremes = orbit.extremes(&point).unwrap();
    assert!(extremes[0].1 > 0.9);
}

/// Beside a fast decay the motion is smooth, and a piece that is long enough for it is too long for perturbations, whose
/// series then grows. The derivatives of the integrated equations are those of the exact ones, whatever the decay: each piece
/// leaves out 1e-12 of them and the next forgets it.
#[test]
fn stiff_motions_have_the_right_derivatives() {
    const STIFF: &str = r#"(
        states: ["x", "v", "z"],
        parameters: {"c": 0.1, "A": 2.0, "w": 1.5, "d": 1.0, "e": 0.8, "K": 150.0},
        forcing: "w",
        modes: {"free": (
            rates: {"x": "v", "v": "A*cos(phase) - c*v - x - 0.1*z", "z": "-K*(z - x)"},
            until: [(zero: "d - x", to: "free", reset: {"v": "-e*v"})],
        )},
    )"#;
    for decay in [1.0, 150.0, 1000.0] {
        let start = [0.5, 0.0, 0.5];
        let (exact, point) = settled(STIFF, &[("K", decay)], "A", "free", &start, 300.0);
        let setting = Setting {
            system: exact.setting.system.clone().integrated(1e-15),
            ..(*exact.setting).clone()
        };
        let integrated = AffineOrbit::new(Arc::new(setting), exact.sequence.clone()).unwrap();
        let [(one, _), (other, _)] =
            [&exact, &integrated].map(|orbit| newton::jacobian(orbit, &point).unwrap());
        let off = (&one - &other).amax() / one.amax();
        assert!(off < 1e-11, "{decay}: {off:e}");
    }
}
