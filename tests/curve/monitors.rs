//! Curves along which a monitor keeps its value, against a closed form.

#![allow(clippy::excessive_precision)] // figures as they are printed

use std::f64::consts::TAU;

use brakewave::EventType;
use brakewave::curve::search::find_of_system;
use brakewave::curve::start::{CurveStart, NoCurve};
use brakewave::curve::{CurveRun, OrbitsInPlane, PointType, WholeCurve, find_of_equilibria};
use brakewave::hybrid::OrbitRunner;
use brakewave::hybrid::equilibrium::EquilibriumRunner;
use brakewave::problem::{Any, SystemProblem, parse_any};

/// The oscillator with one impact of speed `hit` a period.
fn problem(monitor: &str, stop_at: &str, event: &str) -> SystemProblem {
    let text = format!(
        r#"(system: (states: ["x", "v"], parameters: {{"A": 1.0, "w": 1.0, "c": 0.1, "e": 0.8, "d": 1.0}}, forcing: "w",
            modes: {{"free": (rates: {{"x": "v", "v": "A*cos(phase) - c*v - x"}},
                until: [(zero: "d - x", name: "p", to: "free", reset: {{"v": "-e*v"}})])}}),
        monitor: {{{monitor}}},
        orbit: (start: Simulate(mode: "free", state: {{"x": 0.0, "v": 0.0}}, settle: 200)),
        continuation: (parameter: "A", range: (0.15, 1.0), toward: Down, stop_at: [{stop_at}]),
        curve: (event: {event}, parameters: ("A", "w"), range: ((0.1, 1.5), (0.9, 1.35))))"#
    );
    match parse_any(&text, "test").unwrap_or_else(|error| panic!("{error}")) {
        Any::System(problem) => *problem,
        Any::Tube(_) => panic!("a tube"),
    }
}

fn start(problem: &SystemProblem) -> Result<CurveStart<OrbitsInPlane>, NoCurve<OrbitsInPlane>> {
    let (Some(continuation), Some(curve)) = (&problem.continuation, &problem.curve) else {
        panic!("the problem has no curve");
    };
    let begin = |problem: &SystemProblem| OrbitRunner::begin(problem, continuation, None);
    find_of_system(problem, curve, begin, &mut |_| ())
}

fn curve(problem: &SystemProblem) -> WholeCurve<OrbitsInPlane> {
    let start = start(problem).unwrap_or_else(|error| panic!("{error}"));
    let mut run = CurveRun::begin(&start.system, start.event, &start.point, start.limits).unwrap();
    while run.step().unwrap().is_some() {}
    run.curve()
}

/// The amplitude of the force at which the impact has the speed V: between two impacts x = x_p + ξ, x_p = B cos(φ + β) and ξ free,
/// with ξ(T) = ξ(0) and ξ̇(T) = V − ẋ_p, ξ̇(0) = −eV − ẋ_p; then A = |1 − w² + icw| √(x_p² + (ẋ_p/w)²) at the impact.
fn force(speed: f64, w: f64) -> f64 {
    let (c, e, d) = (0.1, 0.8, 1.0);
    let (h, time) = (0.5 * c, TAU / w);
    let omega = (1.0_f64 - h * h).sqrt();
    let (sine, cosine) = (omega * time).sin_cos();
    let decay = (-h * time).exp();
    // the free motion over the period: rows of position and velocity
    let [a, b] = [decay * (cosine + h / omega * sine), decay * sine / omega];
    let [f, g] = [-decay * sine / omega, decay * (cosine - h / omega * sine)];
    // ξ(1 − a) + pb = −beV and fξ + (1 − g)p = V + geV for the position ξ and the forced velocity p
    let determinant = (1.0 - a) * (1.0 - g) - b * f;
    let (right, lower) = (-b * e * speed, speed + g * e * speed);
    let xi = (right * (1.0 - g) - b * lower) / determinant;
    let p = ((1.0 - a) * lower - f * right) / determinant;
    (1.0 - w * w).hypot(c * w) * (d - xi).hypot(p / w)
}

/// The closed form itself, at figures of an independent program.
#[test]
fn the_closed_form_is_that_of_the_figures() {
    for (w, figure) in [
        (0.9, 0.43759911499587313608),
        (1.0, 0.30833205715293267775),
        (1.1, 0.16907397871994311541),
        (1.3, 0.37366663127602993544),
    ] {
        let off = force(0.5, w) / figure - 1.0;
        assert!(off.abs() <= 1e-13, "{w}: {off:e}");
    }
}

/// From a value that the branch is asked for, and from that of its first point: on the closed form at every point.
#[test]
fn a_monitor_keeps_its_value_along_a_curve() {
    let monitor = "\"low\": Min(\"x\"), \"hit\": Before(\"p\", \"v\")";
    let first = 1.6957329375948820097;
    for (stop_at, speed) in [("(\"low\", -1.1), (\"hit\", 0.5)", 0.5), ("", first)] {
        let curve = curve(&problem(monitor, stop_at, "Constant(\"hit\")"));
        assert!(!curve.failed && curve.regions.is_empty());
        assert!(curve.points.len() > 20);
        for point in &curve.points {
            let [a, w] = point.parameters;
            let off = a / force(speed, w) - 1.0;
            assert!(off.abs() <= 2e-12, "{a}, {w}: {off:e}");
        }
        let ends =
            [curve.points.first(), curve.points.last()].map(|end| end.unwrap().parameters[1]);
        assert!(ends.contains(&0.9), "{ends:?}");
    }
}

/// The equilibria of FitzHugh's oscillator, w = (v + a)/b and I = w - v + v³/3, along which v, or vw, keeps a value: I(b) is known, and
/// where a pair of eigenvalues crosses, 1 - v² = εb.
#[test]
fn a_monitor_keeps_its_value_along_equilibria() {
    let of = |monitor: &str, stop_at: &str| {
        let text = format!(
            r#"(system: (states: ["v", "w"], parameters: {{"I": 0.0, "b": 0.45, "eps": 0.08, "a": 0.7}},
                modes: {{"flow": (rates: {{"v": "v - v^3/3 - w + I", "w": "eps*(v + a - b*w)"}})}}),
            monitor: {{"kept": {monitor}}},
            equilibrium: (start: Given(mode: "flow", state: {{"v": -1.2, "w": -0.6}})),
            continuation: (parameter: "I", range: (-1.0, 4.0), toward: Up, stop_at: [{stop_at}]),
            curve: (event: Constant("kept"), parameters: ("I", "b"), range: ((-3.0, 6.0), (0.1, 0.9))))"#
        );
        let Ok(Any::System(problem)) = parse_any(&text, "test") else {
            panic!("{text}");
        };
        let (continuation, section) = (problem.continuation.as_ref(), problem.curve.as_ref());
        let begin = || EquilibriumRunner::begin(&problem, continuation.unwrap(), None);
        let start = find_of_equilibria(&problem, section.unwrap(), begin, &mut |_| ()).unwrap();
        let mut run =
            CurveRun::begin(&start.system, start.event, &start.point, start.limits).unwrap();
        while run.step().unwrap().is_some() {}
        run.curve()
    };
    let current = |v: f64, w: f64| w - v + v * v * v / 3.0;
    let v: f64 = -0.99;
    let curve = of("Max(\"v\")", "(\"kept\", -0.99)");
    assert!(!curve.failed && curve.points.len() > 10);
    for point in &curve.points {
        let [i, b] = point.parameters;
        let off = i - current(v, (v + 0.7) / b);
        assert!(off.abs() <= 1e-13 * (1.0 + i.abs()), "{i}, {b}: {off:e}");
    }
    let ends = [curve.points.first(), curve.points.last()].map(|end| end.unwrap().parameters[1]);
    assert!(ends.contains(&0.1) && ends.contains(&0.9), "{ends:?}");
    let crossing = (1.0 - v * v) / 0.08;
    let hopf = PointType::Two(EventType::UZ, EventType::HB);
    let found: Vec<f64> = curve
        .points
        .iter()
        .filter(|one| one.kind == Some(hopf))
        .map(|one| one.parameters[1])
        .collect();
    assert!(
        matches!(found[..], [b] if (b - crossing).abs() < 1e-11),
        "{found:?} for {crossing}"
    );
    // that of the first point, where nothing asks for a value
    let curve = of("Mean(\"v*w\")", "");
    let kept = {
        let [i, b] = curve.points[0].parameters;
        let mut v: f64 = -1.0;
        for _ in 0..60 {
            let slope = 1.0 / b - 1.0 + v * v;
            v -= (current(v, (v + 0.7) / b) - i) / slope;
        }
        v * (v + 0.7) / b
    };
    assert!(!curve.failed && curve.points.len() > 10);
    for point in &curve.points {
        let [i, b] = point.parameters;
        // v² + av = bk, on the side of the first one
        let v = -0.35 - (0.1225 + b * kept).sqrt();
        let off = i - current(v, (v + 0.7) / b);
        assert!(off.abs() <= 1e-12 * (1.0 + i.abs()), "{i}, {b}: {off:e}");
    }
}

/// A value that the branch does not have is no start.
#[test]
fn a_value_that_is_not_met_begins_no_curve() {
    let problem = problem("\"low\": Min(\"x\")", "(\"low\", 5.0)", "Constant(\"low\")");
    assert!(matches!(
        start(&problem),
        Err(NoCurve::NotFound { found: 0, .. })
    ));
}
