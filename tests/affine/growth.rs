//! Cycles that grow from boundary equilibria of two foci, against figures of an independent program in 40 digits; monitors of
//! equilibria.

#![allow(clippy::excessive_precision)] // figures as they are printed

use brakewave::EventType;
use brakewave::affine::equilibrium::cycle::NoCycle;
use brakewave::hybrid::equilibrium::{EquilibriumItem, NamedEquilibrium};
use brakewave::hybrid::{EarlierPoint, NoFirstPoint, OrbitItem, OrbitRunner};
use brakewave::orbit::Stability;
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{Any, SystemProblem, UserPoint, parse_any};

use crate::affine::rests::{BRUSSELATOR, CHUA, Course, FOCI, HARVEST, STARTS, followed, runner};
use EventType::{BE, UZ};

/// The BE of a branch, and its problem with an orbit that begins there.
fn at_boundary(course: &Course) -> (SystemProblem, EarlierPoint) {
    at_boundary_in(course, &[1.0; 9], false)
}

/// The same with the states in these units, in reversed order where asked for.
fn at_boundary_in(course: &Course, units: &[f64], reversed: bool) -> (SystemProblem, EarlierPoint) {
    let all = course.all(units, reversed);
    let at = all.iter().find(|item| item.point.kind == Some(BE)).unwrap();
    let named = EarlierPoint::Equilibrium(NamedEquilibrium {
        saved: at.saved.clone().unwrap(),
        kind: Some(BE),
    });
    let mut problem = course.problem(units, reversed, "stability: ()");
    problem.equilibrium = None;
    problem.orbit = ron::from_str(r#"(start: Switch(dir: "earlier", label: 2))"#).unwrap();
    (problem, named)
}

/// The cycle at a value of the parameter.
fn cycle(course: &Course, value: f64) -> OrbitItem {
    let (mut problem, named) = at_boundary(course);
    let section = problem.continuation.as_mut().unwrap();
    section.stop_at = vec![UserPoint::Parameter(value)];
    let section = section.clone();
    let mut run = OrbitRunner::begin(&problem, &section, Some(&named)).unwrap();
    loop {
        let items = run.step();
        let user = items.into_iter().find(|item| item.point.kind == Some(UZ));
        if let Some(user) = user {
            return user;
        }
        assert!(run.progress().end.is_none());
    }
}

/// [tL, dL, tR, dR] with the extremes of x per unit of μ, the period and the multiplier.
const FIGURES: [([f64; 4], [f64; 4]); 3] = [
    (
        [-0.8, 1.0, 0.4, 1.0],
        [
            5.060_660_145_144_666_911_8,
            -2.957_904_414_822_924_267_2,
            6.535_497_967_735_272_064_8,
            0.499_725_691_733_774_3,
        ],
    ),
    (
        [-1.2, 2.0, 0.5, 0.7],
        [
            10.986_514_370_876_898_923,
            -4.976_900_537_514_027_520_8,
            6.669_741_207_557_524_225_3,
            0.599_879_623_990_209_1,
        ],
    ),
    (
        [-0.7, 1.4, 0.3, 1.1],
        [
            4.157_199_591_248_070_047_5,
            -2.098_669_631_210_749_656_2,
            5.886_915_967_550_317_54,
            0.599_398_788_610_152_5,
        ],
    ),
];

/// A system of two foci with these traces and determinants.
fn foci([tl, dl, tr, dr]: [f64; 4]) -> String {
    let text = FOCI.replace("\"tL\": -0.8", &format!("\"tL\": {tl:?}"));
    let text = text.replace("\"dL\": 1.0", &format!("\"dL\": {dl:?}"));
    let text = text.replace("\"tR\": 0.4", &format!("\"tR\": {tr:?}"));
    text.replace("\"dR\": 1.0", &format!("\"dR\": {dr:?}"))
}

/// For every μ > 0 the cycle is μ times that of μ = 1. From either end of the branch of equilibria it is the same; with time
/// reversed it is one that repels.
#[test]
fn a_cycle_grows_from_two_foci_in_exact_proportion() {
    for (numbers, [largest, least, period, multiplier]) in FIGURES {
        let text = foci(numbers);
        let starts = [
            ("left", -0.5, numbers[0], numbers[1]),
            ("right", 0.5, numbers[2], numbers[3]),
        ];
        for (mode, mu, trace, determinant) in starts {
            let x = mu / determinant;
            let system = text.replace("\"mu\": 0.5", &format!("\"mu\": {mu:?}"));
            let course = Course {
                system: &system,
                mode,
                state: &[x, trace * x],
                parameter: "mu",
                range: (-1.0, 1.0),
            };
            for value in [0.01, 0.1, 0.5] {
                let found = cycle(&course, value).point;
                let (low, high) = found.extremes[0];
                assert!((high / value - largest).abs() <= 1e-10, "{high} at {value}");
                assert!((low / value - least).abs() <= 1e-10, "{low} at {value}");
                assert!((found.period - period).abs() <= 1e-10);
                assert_eq!(found.stable, Some(Stability::Yes));
                let leading = found.leading().unwrap();
                assert!((leading.re - multiplier).abs() <= 1e-10, "{leading}");
            }
        }
    }
}

/// States in units as different as micrometres and kilometres, in either order: the period is the same.
#[test]
fn units_of_the_states_do_not_decide_whether_a_cycle_grows() {
    let system = foci([-1.1, 1.7, 0.35, 0.9]).replace("\"mu\": 0.5", "\"mu\": -0.5");
    let course = Course {
        system: &system,
        mode: "left",
        state: &[-0.5 / 1.7, 0.55 / 1.7],
        parameter: "mu",
        range: (-1.0, 1.0),
    };
    for units in [
        [1.0, 1.0],
        [1000.0, 1.0],
        [1.0, 1e-3],
        [1e-6, 1e3],
        [7e8, 3.0],
    ] {
        for reversed in [false, true] {
            let (problem, named) = at_boundary_in(&course, &units, reversed);
            let section = problem.continuation.clone().unwrap();
            let mut run = OrbitRunner::begin(&problem, &section, Some(&named))
                .unwrap_or_else(|error| panic!("{units:?} {reversed}: {error}"));
            let found = run.step().remove(0).point;
            let off = found.period - 6.300_438_643_117_6;
            assert!(off.abs() <= 1e-11, "{units:?} {reversed}: {off:e}");
        }
    }
}

/// y → −y, t → −t: the same cycle, which repels.
#[test]
fn a_cycle_that_repels_grows_too() {
    let (_, [largest, least, period, multiplier]) = FIGURES[0];
    let system = r#"(states: ["x", "y"], parameters: {"mu": -0.5, "tL": 0.8, "dL": 1.0, "tR": -0.4, "dR": 1.0},
        modes: {
            "left": (rates: {"x": "tL*x - y", "y": "dL*x - mu"}, until: [(zero: "-x", to: "right")]),
            "right": (rates: {"x": "tR*x - y", "y": "dR*x - mu"}, until: [(zero: "x", to: "left")]),
        })"#;
    let course = Course {
        system,
        mode: "left",
        state: &[-0.5, -0.4],
        parameter: "mu",
        range: (-1.0, 1.0),
    };
    let found = cycle(&course, 0.1).point;
    let (low, high) = found.extremes[0];
    assert!((high / 0.1 - largest).abs() <= 1e-10 && (low / 0.1 - least).abs() <= 1e-10);
    assert!((found.period - period).abs() <= 1e-10);
    assert_eq!(found.stable, Some(Stability::No));
    let leading = found.leading().unwrap();
    assert!((leading.re * multiplier - 1.0).abs() <= 1e-9, "{leading}");
}

/// What spirals out of the focus comes to a surface, slides back along it and leaves where the first did: at x = −am.
#[test]
fn a_cycle_that_slides_grows_in_proportion() {
    let system = r#"(states: ["x", "y"], parameters: {"m": 0.5, "a": 0.1},
        modes: {
            "low": (rates: {"x": "a*x - y - m", "y": "x + a*(y + m)"}, until: [(zero: "-y", to: "up")]),
            "up": (rates: {"x": "-2", "y": "-1"}, until: [(zero: "y", to: "low")]),
        }, sliding: {"slide": ("low", "up")})"#;
    let course = Course {
        system,
        mode: "low",
        state: &[0.0, -0.5],
        parameter: "m",
        range: (-1.0, 1.0),
    };
    let [small, large] = [0.01, 0.5].map(|m| (m, cycle(&course, m).point));
    for (m, point) in [&small, &large] {
        assert_eq!(point.regimes, "low-slide");
        assert_eq!(point.stable, Some(Stability::Yes));
        let ((least, _), (first, _)) = (point.extremes[0], small.1.extremes[0]);
        assert!((least / m - first / small.0).abs() <= 1e-10);
        // the way through the mode takes the same time
        let [own, known] = [point, &small.1].map(|point| point.switches[1]);
        assert!((own - known).abs() <= 1e-10);
    }
}

/// Both foci attract: no cycle. Three states are refused.
#[test]
fn where_no_cycle_grows_words_say_so() {
    let text = foci([-0.8, 1.0, -0.2, 1.0]).replace("\"mu\": 0.5", "\"mu\": -0.5");
    let course = Course {
        system: &text,
        mode: "left",
        state: &[-0.5, 0.4],
        parameter: "mu",
        range: (-1.0, 1.0),
    };
    let chua = Course {
        system: CHUA,
        mode: "right",
        state: &[1.5, 0.0, -1.5],
        parameter: "E",
        range: (-2.0, 2.0),
    };
    for (course, reason) in [(course, NoCycle::NoneGrows), (chua, NoCycle::NotPlanar)] {
        let (problem, named) = at_boundary(&course);
        let section = problem.continuation.clone().unwrap();
        let refused = OrbitRunner::begin(&problem, &section, Some(&named)).err();
        assert_eq!(refused, Some(NoFirstPoint::NoCycle(reason)));
    }
}

fn monitored(problem: &SystemProblem) -> Vec<EquilibriumItem> {
    followed(runner(problem, None))
}

fn monitor(item: &EquilibriumItem, name: &str) -> f64 {
    let mut all = item.point.monitors.iter();
    all.find(|(known, _)| known == name).unwrap().1.unwrap()
}

/// x = A, y = B/A: expressions of both, and points at which they have a value.
#[test]
fn monitors_of_equilibria_are_values_of_their_expressions() {
    let more = r#"monitor: {"product": Max("x*y^2"), "mean": Mean("x - y"), "size": Largest("A - B*y"), "low": Min("exp(-y)")}"#;
    let mut problem = STARTS[0].problem(&[1.0; 2], false, more);
    let section = problem.continuation.as_mut().unwrap();
    section.stop_at = vec![UserPoint::Monitor("product".to_owned(), 3.0)];
    let all = monitored(&problem);
    for item in &all {
        let b = item.point.parameters[1];
        let expected = [
            ("product", b * b),
            ("mean", 1.0 - b),
            ("size", b * b - 1.0),
            ("low", (-b).exp()),
        ];
        for (name, value) in expected {
            assert!(
                (monitor(item, name) - value).abs() <= 1e-13 * value.abs().max(1.0),
                "{name} at {b}"
            );
        }
    }
    let user: Vec<_> = all
        .iter()
        .filter(|item| item.point.kind == Some(UZ))
        .collect();
    assert_eq!(user.len(), 1);
    assert!((user[0].point.parameters[1] - 3.0_f64.sqrt()).abs() <= 1e-14);
    let event = user[0].event.as_ref().unwrap();
    assert!(event.uncertainty <= 1e-13 && event.monitors == user[0].point.monitors);
}

/// In sliding and beyond a boundary: the values of the mode there.
#[test]
fn monitors_go_through_boundaries() {
    let course = STARTS
        .iter()
        .find(|course| course.system == HARVEST)
        .unwrap();
    let more = r#"monitor: {"prey": Max("x + 2*al"), "gap": Min("al - y")}"#;
    let all = monitored(&course.problem(&[1.0; 2], false, more));
    let mut modes: Vec<&str> = all.iter().map(|item| item.point.mode.as_str()).collect();
    modes.dedup();
    assert!(modes.len() > 2, "{modes:?}");
    for item in &all {
        let al = item.point.parameters[4];
        let [x, y] = [item.point.state[0], item.point.state[1]];
        assert!((monitor(item, "prey") - (x + 2.0 * al)).abs() <= 1e-14);
        assert!((monitor(item, "gap") - (al - y)).abs() <= 1e-14);
    }
}

#[test]
fn what_an_equilibrium_has_not_is_refused() {
    for (monitor, word) in [
        (r#"Integral("x")"#, "an integral over a period"),
        (r#"Before("p", "x")"#, "a value at a switch"),
        (r#"After("p", "x")"#, "a value at a switch"),
    ] {
        let system = BRUSSELATOR.replace(
            "\"B*x - x^2*y\"})",
            "\"B*x - x^2*y\"}, until: [(zero: \"x + 9\", name: \"p\", to: \"flow\")])",
        );
        let text = format!(
            "(system: {system}, equilibrium: (start: Given(mode: \"flow\", state: {{\"x\": 1.0, \"y\": 1.5}})),
            monitor: {{\"m\": {monitor}}}, continuation: (parameter: \"B\", range: (1.0, 3.0)))"
        );
        let refused = match parse_any(&text, "test") {
            Err(error) => error.to_string(),
            Ok(Any::System(_) | Any::Tube(_)) => panic!("{monitor} is taken"),
        };
        assert!(refused.contains(word), "{refused}");
    }
}
