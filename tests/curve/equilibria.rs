//! Special equilibria in two parameters against closed forms and figures of an independent program in 40 digits.

#![allow(clippy::excessive_precision)] // figures as they are printed

use std::collections::BTreeSet;

use brakewave::EventType;
use brakewave::continuation::newton::Equations as _;
use brakewave::curve::start::{CurveStart, NoCurve};
use brakewave::curve::{
    CurveHead, CurvePoint, CurveRun, CurveStep, EquilibriaInPlane, PointType, WholeCurve,
    find_of_equilibria,
};
use brakewave::hybrid::equilibrium::EquilibriumRunner;
use brakewave::linalg::Matrix;
use brakewave::problem::{Any, SystemProblem, parse_any};

/// A system, where its branch begins, and the branch.
#[derive(Clone, Copy)]
struct Family<'a> {
    system: &'a str,
    start: &'a str,
    branch: &'a str,
}

const FITZHUGH: Family = Family {
    system: r#"states: ["v", "w"], parameters: {"I": 0.0, "b": 0.45, "eps": 0.08, "a": 0.7},
        modes: {"flow": (rates: {"v": "v - v^3/3 - w + I", "w": "eps*(v + a - b*w)"})}"#,
    start: r#"mode: "flow", state: {"v": -1.2, "w": -0.6}"#,
    branch: r#"parameter: "I", range: (-1.0, 4.0)"#,
};
const SKEW: Family = Family {
    system: r#"states: ["z", "y", "x"], parameters: {"a": -0.24897573502154585, "b": 0.119140625}, define: {
            "u": "236.6875*z + 158.5*y + 4*x", "p": "-48.5*z + 292*y - 96*x", "q": "44*z - 96*y + 256*x",
            "v": "p - 0.1162109375*u^2", "w": "q + 0.1484375*u*v - 0.1533203125*u^2",
            "al": "a + 0.0185546875*b - 0.228515625*b^2", "be": "b + 0.4775390625*a",
            "f": "v/64", "g": "(al + be*v + u^2 + u*v)/64 + 0.232421875*f*u",
            "h": "(-1.5*w + 0.5*u^2 + 0.25*u)/64 - 0.1484375*(f*v + u*(g - 0.232421875*f*u)) + 0.306640625*f*u"},
        modes: {"flow": (rates: {
            "z": "0.00390625*f - 0.00244140625*g - 0.0009765625*h",
            "y": "0.00048828125*f + 0.00360107421875*g + 0.0013427734375*h",
            "x": "-0.00048828125*f + 0.00177001953125*g + 0.00457763671875*h"})}"#,
    start: r#"mode: "flow", state: {"z": -0.0020615257771510616, "y": -8.804780162056068e-5, "x": 0.00047104466008582194}"#,
    branch: r#"parameter: "b", range: (-1.0, 1.0)"#,
};
const LORENZ84: Family = Family {
    system: r#"states: ["x", "y", "z"], parameters: {"F": 1.75, "G": 0.1, "a": 0.25, "b": 4.0},
        modes: {"flow": (rates: {"x": "-y^2 - z^2 - a*x + a*F", "y": "x*y - b*x*z - y + G", "z": "b*x*y + x*z - z"})}"#,
    start: r#"mode: "flow", state: {"x": 1.74, "y": 0.0, "z": 0.0}"#,
    branch: r#"parameter: "G", range: (0.01, 4.0)"#,
};
const TWO: Family = Family {
    system: r#"states: ["x", "v", "y", "w"], parameters: {"m": -1.0, "n": 0.15, "k": 2.0, "kap": 0.5},
        modes: {"flow": (rates: {"x": "v", "v": "-x + (m - x^2)*v + kap*w", "y": "w", "w": "-k*y + (n - y^2)*w + kap*x"})}"#,
    start: r#"mode: "flow", state: {"x": 0.0, "v": 0.0, "y": 0.0, "w": 0.0}"#,
    branch: r#"parameter: "m", range: (-1.0, 1.0)"#,
};
const HARVEST: Family = Family {
    system: r#"states: ["x", "y"], parameters: {"a": 1.0, "b": 0.3, "d": 0.42, "h": 0.15, "al": 0.45},
        define: {"eaten": "a*x*y/(b + x)"},
        modes: {
            "low": (rates: {"x": "x*(1 - x) - eaten", "y": "eaten - d*y"}, until: [(zero: "al - y", to: "high")]),
            "high": (rates: {"x": "x*(1 - x) - eaten", "y": "eaten - (d + h)*y"}, until: [(zero: "y - al", to: "low")]),
        }, sliding: {"slide": ("low", "high")}"#,
    start: r#"mode: "low", state: {"x": 0.21, "y": 0.4}"#,
    branch: r#"parameter: "al", range: (0.3, 0.6)"#,
};
const RELAY: Family = Family {
    system: r#"states: ["s", "x", "y"], parameters: {"mu": -0.3, "k": 0.4, "c": 0.05, "M": 0.8, "p": 0.6, "r": 0.3},
        modes: {
            "plus": (rates: {"s": "p*x + r*y - M", "x": "mu*x - y - x*(x^2 + y^2) + k", "y": "x + mu*y - y*(x^2 + y^2) + c"},
                until: [(zero: "s", to: "minus")]),
            "minus": (rates: {"s": "p*x + r*y + M", "x": "mu*x - y - x*(x^2 + y^2) - k", "y": "x + mu*y - y*(x^2 + y^2) + c"},
                until: [(zero: "-s", to: "plus")]),
        }, sliding: {"slide": ("plus", "minus")}"#,
    start: r#"mode: "slide", state: {"s": 0.0, "x": -0.05, "y": -0.01}"#,
    branch: r#"parameter: "mu", range: (-0.5, 0.3)"#,
};
const PITCHFORK: Family = Family {
    system: r#"states: ["x", "y"], parameters: {"mu": -1.0, "q": 1.0, "f": 0.0},
        modes: {"flow": (rates: {"x": "mu*x + x*y - q*x^5 + f", "y": "-y + x^2*(1 + mu*q)"})}"#,
    start: r#"mode: "flow", state: {"x": 0.0, "y": 0.0}"#,
    branch: r#"parameter: "mu", range: (-1.5, 1.0)"#,
};
const PREDATORS: Family = Family {
    system: r#"states: ["x", "y"], parameters: {"K": 0.2, "a": 1.0, "b": 0.5, "d": 0.4},
        modes: {"flow": (rates: {"x": "x*(1 - x/K) - a*x*y/(b + x)", "y": "a*x*y/(b + x) - d*y"})}"#,
    start: r#"mode: "flow", state: {"x": 0.2, "y": 0.0}"#,
    branch: r#"parameter: "K", range: (0.1, 2.0)"#,
};

impl Family<'_> {
    /// Its problem with other values, and a curve.
    fn problem(self, values: &[(&str, &str)], curve: &str) -> SystemProblem {
        let Family {
            system,
            start,
            branch,
        } = self;
        let mut text = format!(
            "(system: ({system}), equilibrium: (start: Given({start})), continuation: ({branch}), curve: ({curve}))"
        );
        for (from, to) in values {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        match parse_any(&text, "test") {
            Ok(Any::System(problem)) => *problem,
            other => panic!("{other:?}"),
        }
    }

    fn curve(self, values: &[(&str, &str)], curve: &str) -> WholeCurve<EquilibriaInPlane> {
        followed(&self.problem(values, curve))
    }
}

fn start(
    problem: &SystemProblem,
) -> Result<CurveStart<EquilibriaInPlane>, NoCurve<EquilibriaInPlane>> {
    let (Some(continuation), Some(curve)) = (&problem.continuation, &problem.curve) else {
        panic!("the problem has no curve");
    };
    let begin = || EquilibriumRunner::begin(problem, continuation, None);
    find_of_equilibria(problem, curve, begin, &mut |_| ())
}

fn run(problem: &SystemProblem) -> CurveRun<EquilibriaInPlane> {
    let start = start(problem).unwrap_or_else(|error| panic!("{error}"));
    CurveRun::begin(&start.system, start.event, &start.point, start.limits).unwrap()
}

fn followed(problem: &SystemProblem) -> WholeCurve<EquilibriaInPlane> {
    let mut run = run(problem);
    while run.step().unwrap().is_some() {}
    let curve = run.unnamed();
    assert!(!curve.failed, "{} | {}", curve.end(0), curve.end(1));
    curve
}

fn types(curve: &WholeCurve<EquilibriaInPlane>) -> Vec<String> {
    let own = [EventType::EP, curve.event].map(PointType::One);
    let kinds = curve.points.iter().filter_map(|point| point.kind);
    kinds
        .filter(|kind| !own.contains(kind))
        .map(|kind| kind.to_string())
        .collect()
}

/// A number of a point by the name of its column.
fn number(curve: &WholeCurve<EquilibriaInPlane>, point: &CurvePoint, name: &str) -> f64 {
    let place = curve.parameters.iter().position(|one| one == name);
    let column = || curve.columns.iter().position(|one| one == name);
    match place {
        Some(place) => point.parameters[place],
        None if name == "omega" => point.angular.unwrap(),
        None => point.numbers[column().unwrap()].unwrap(),
    }
}

/// Every point of the curve of this type, of which one has these numbers, known to a few roundings.
fn has(curve: &WholeCurve<EquilibriaInPlane>, kind: &str, numbers: &[(&str, f64)]) {
    let of_kind = |point: &&CurvePoint| point.kind.is_some_and(|own| own.to_string() == kind);
    let distance = |point: &CurvePoint| {
        let each = numbers
            .iter()
            .map(|(name, value)| (number(curve, point, name) - value).abs() / value.abs().max(1.0));
        each.fold(0.0, f64::max)
    };
    let distances = curve.points.iter().filter(of_kind).map(distance);
    let nearest = distances.fold(f64::INFINITY, f64::min);
    assert!(
        nearest <= 1e-12,
        "{kind} {numbers:?}: {nearest:e}, {:?}",
        types(curve)
    );
}

/// HB at v² = 1 − εb, with ω² = ε(1 − εb²) and l₁ zero at εb² − 2b + 1 = 0; BT where ω is zero.
#[test]
fn hopf_curves_of_fitzhugh_and_nagumo_have_gh_and_end_in_bt() {
    for (eps, a) in [(0.08_f64, 0.7), (0.05, 0.8)] {
        let values = [
            ("\"eps\": 0.08", &*format!("\"eps\": {eps}")),
            ("\"a\": 0.7", &*format!("\"a\": {a}")),
        ];
        for (index, side) in [(1, -1.0), (2, 1.0)] {
            let asked = format!(
                "event: HB, index: {index}, parameters: (\"I\", \"b\"), range: ((-1.0, 4.0), (0.1, 5.0))"
            );
            let curve = FITZHUGH.curve(&values, &asked);
            let mut seen = types(&curve);
            seen.sort();
            assert_eq!(seen, ["BT", "GH"]);
            let at = |b: f64| {
                let v = side * (1.0 - eps * b).sqrt();
                let w = (v + a) / b;
                [("b", b), ("v", v), ("w", w), ("I", w - v + v.powi(3) / 3.0)]
            };
            for point in &curve.points {
                let b = number(&curve, point, "b");
                let told = point.numbers.clone();
                for (name, value) in at(b) {
                    assert!(
                        (number(&curve, point, name) - value).abs() <= 1e-12 * value.abs().max(1.0)
                    );
                }
                let square = number(&curve, point, "omega").powi(2);
                assert!((square - eps * (1.0 - eps * b * b)).abs() <= 1e-13);
                // the sign of l₁ is that of 2b − 1 − εb²
                if point.kind.is_none() {
                    let coefficient = told[2].unwrap();
                    assert!(
                        coefficient * (2.0 * b - 1.0 - eps * b * b) > 0.0,
                        "{b} {coefficient}"
                    );
                }
            }
            has(&curve, "GH", &at((1.0 - (1.0 - eps).sqrt()) / eps));
            has(&curve, "BT", &at(1.0 / eps.sqrt()));
        }
    }
}

/// Drag q|v|v is no smooth function where v is zero, as it is at all equilibria of v̇ = μv − kx − q|v|v: their pair is ±i√k along μ = 0.
#[test]
fn a_hopf_curve_stays_at_a_kink() {
    let family = Family {
        system: r#"states: ["x", "v"], parameters: {"mu": -0.5, "k": 1.0}, modes: {"flow": (rates: {
            "x": "v", "v": "mu*v - k*x - 0.5*abs(v)*v"})}"#,
        start: r#"mode: "flow", state: {"x": 0.0, "v": 0.0}"#,
        branch: r#"parameter: "mu", range: (-1.0, 1.0)"#,
    };
    let asked = r#"event: HB, parameters: ("mu", "k"), range: ((-1.0, 1.0), (0.5, 2.0))"#;
    let curve = family.curve(&[], asked);
    let [mut least, mut most] = [f64::INFINITY, 0.0_f64];
    for point in &curve.points {
        let [mu, k] = point.parameters;
        let omega = number(&curve, point, "omega");
        assert!(
            mu.abs() <= 1e-14 && (omega * omega - k).abs() <= 1e-13,
            "{mu} {k} {omega}"
        );
        (least, most) = (least.min(k), most.max(k));
    }
    assert_eq!([least, most], [0.5, 2.0]);
}

/// ẋ = p + qx − |x − r| turns in p at x = r, p = −qr while |q| < 1: at q = ±1 one of its slopes is zero there. In units of x and of time
/// that are others it does so, too.
#[test]
fn a_fold_at_a_kink_lasts_while_the_slopes_on_both_sides_have_two_signs() {
    for (unit, time) in [(1.0, 1.0), (1e-6, 1e3)] {
        let system = format!(
            r#"states: ["x"], parameters: {{"p": 0.5, "q": 0.2, "r": 0.3}}, modes: {{"m": (rates: {{
                "x": "{time:?}*{unit:?}*(p + q*x/{unit:?} - abs(x/{unit:?} - r))"}})}}"#
        );
        let start = format!(r#"mode: "m", state: {{"x": {:?}}}"#, 0.9 * unit);
        let family = Family {
            system: &system,
            start: &start,
            branch: r#"parameter: "p", range: (-1.0, 1.0)"#,
        };
        let curve = family.curve(
            &[],
            r#"event: LP, parameters: ("p", "q"), range: ((-2.0, 2.0), (-3.0, 3.0))"#,
        );
        assert_eq!(types(&curve), ["LP+LP", "LP+LP"]);
        let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
        for point in &curve.points {
            let [p, q] = point.parameters;
            assert!((p + 0.3 * q).abs() <= 1e-14, "{p} {q}");
            assert!((number(&curve, point, "x") / unit - 0.3).abs() <= 1e-14);
            (least, most) = (least.min(q), most.max(q));
        }
        assert!((least + 1.0).abs() <= 1e-13 && (most - 1.0).abs() <= 1e-13);
    }
}

/// ẋ = y, ẏ = p − x − ay + b|x + y| has at x = p = 0 the traces −a ± b and the determinants 1 ∓ b on both sides of the kink: growing pairs are more on one
/// side while |a| < |b|.
#[test]
fn a_jump_at_a_kink_lasts_while_the_traces_on_both_sides_have_two_signs() {
    let family = Family {
        system: r#"states: ["x", "y"], parameters: {"p": 0.5, "a": 0.2, "b": 0.5}, modes: {"m": (rates: {
            "x": "y", "y": "p - x - a*y + b*abs(x + y)"})}"#,
        start: r#"mode: "m", state: {"x": 0.9, "y": 0.0}"#,
        branch: r#"parameter: "p", range: (-1.0, 1.0)"#,
    };
    let asked = r#"event: HB, parameters: ("a", "p"), range: ((-3.0, 3.0), (-2.0, 2.0))"#;
    let curve = family.curve(&[], asked);
    assert_eq!(types(&curve), ["HB+HB", "HB+HB"]);
    let ends = [curve.points.first(), curve.points.last()].map(|point| point.unwrap().parameters);
    let mut edges = ends.map(|[a, _]| a);
    edges.sort_by(f64::total_cmp);
    assert!((edges[0] + 0.5).abs() <= 1e-13 && (edges[1] - 0.5).abs() <= 1e-13);
    for point in &curve.points {
        assert!(point.parameters[1].abs() <= 1e-14);
    }
    // to a determinant that is zero it comes with b
    let asked = r#"event: HB, parameters: ("b", "p"), range: ((0.0, 3.0), (-2.0, 2.0))"#;
    let curve = family.curve(&[], asked);
    has(&curve, "HB+HB", &[("b", 0.2), ("p", 0.0)]);
    has(&curve, "HB+LP", &[("b", 1.0), ("p", 0.0)]);
}

/// u̇ = v, v̇ = α + βv + u² + uv (Bogdanov and Takens) with a state that follows, in small units and skew coordinates: HB at α = −β², to the
/// BT at 0, on the way to which the vectors of the pair come to lie along one another.
#[test]
fn a_hopf_curve_comes_to_its_bt_in_skew_coordinates() {
    let asked = r#"event: HB, parameters: ("a", "b"), range: ((-1.0, 1.0), (-1.0, 1.0))"#;
    let curve = SKEW.curve(&[], asked);
    assert_eq!(types(&curve), ["BT"]);
    has(&curve, "BT", &[("a", 0.0), ("b", 0.0)]);
    for point in &curve.points {
        let [a, b] = point.parameters;
        let alpha = a + 0.0185546875 * b - 0.228515625 * b * b;
        let beta = b + 0.4775390625 * a;
        assert!((alpha + beta * beta).abs() <= 1e-12, "{a} {b}");
    }
}

/// ẋ = y, ẏ = b₁ + b₂y + x² + xy (Bogdanov and Takens): HB at x = −b₂, b₁ = −b₂², ω² = 2b₂, to the BT at 0, where states and
/// parameters vanish. y stays zero; what its unit is makes no difference, nor does the order of the states.
#[test]
fn the_hopf_curve_of_the_normal_form_comes_to_its_bt_at_zero() {
    for names in [r#"["x", "y"]"#, r#"["y", "x"]"#] {
        for unit in [1.0, 1e-3, 100.0] {
            let system = format!(
                r#"states: {names}, parameters: {{"b1": -0.25, "b2": 0.2}}, modes: {{"flow": (rates: {{
                    "x": "{unit:?}*y", "y": "(b1 + b2*{unit:?}*y + x^2 + x*{unit:?}*y)/{unit:?}"}})}}"#
            );
            let family = Family {
                system: system.leak(),
                start: r#"mode: "flow", state: {"x": -0.5, "y": 0.0}"#,
                branch: r#"parameter: "b2", range: (-0.5, 1.0)"#,
            };
            let asked =
                "event: HB, parameters: (\"b1\", \"b2\"), range: ((-1.0, 0.2), (-0.5, 1.5))";
            let curve = family.curve(&[], asked);
            assert_eq!(types(&curve), ["BT"]);
            has(&curve, "BT", &[("x", 0.0), ("b1", 0.0), ("b2", 0.0)]);
            for point in &curve.points {
                let [x, one, two] = ["x", "b1", "b2"].map(|name| number(&curve, point, name));
                assert!((x + two).abs() <= 1e-12 && (one + two * two).abs() <= 1e-12);
                assert!((number(&curve, point, "omega").powi(2) - 2.0 * two).abs() <= 1e-12);
            }
        }
    }
}

/// Where v² is larger than on the curve both eigenvalues decay, and on the other side both grow, up to a fold of the branch. What lies
/// beyond it is elsewhere: there the upper branch is stable again.
#[test]
fn beside_a_curve_of_hopf_points_nothing_is_named_beyond_a_fold() {
    let asked = "event: HB, parameters: (\"I\", \"b\"), range: ((-1.0, 4.0), (0.1, 5.0))";
    let mut run = run(&FITZHUGH.problem(&[], asked));
    while run.step().unwrap().is_some() {}
    let curve = run.curve();
    let sides = [true, false].map(|left| {
        let side = curve.regions.iter().filter(|region| region.left == left);
        let names = side.map(|region| region.name.to_string());
        names.collect::<BTreeSet<String>>()
    });
    let mut names: Vec<Vec<&str>> = sides
        .iter()
        .map(|side| side.iter().map(String::as_str).collect())
        .collect();
    names.sort();
    assert_eq!(names, [["2 eigenvalues grow"], ["stable"]]);
}

/// LP at v² = 1 − 1/b: round their cusp at v = 0, I = a, b = 1, through both BT.
#[test]
fn folds_of_fitzhugh_and_nagumo_turn_in_a_cusp() {
    for (eps, a) in [(0.08_f64, 0.7), (0.05, 0.8)] {
        let values = [
            ("\"eps\": 0.08", &*format!("\"eps\": {eps}")),
            ("\"a\": 0.7", &*format!("\"a\": {a}")),
            ("\"b\": 0.45", "\"b\": 1.5"),
        ];
        let asked = "event: LP, parameters: (\"I\", \"b\"), range: ((-1.0, 4.0), (0.1, 5.0))";
        let curve = FITZHUGH.curve(&values, asked);
        assert_eq!(types(&curve), ["BT", "CP", "BT"]);
        has(&curve, "CP", &[("I", a), ("b", 1.0), ("v", 0.0), ("w", a)]);
        for side in [-1.0, 1.0] {
            let v: f64 = side * (1.0 - eps.sqrt()).sqrt();
            let w = (v + a) * eps.sqrt();
            let current = w - v + v.powi(3) / 3.0;
            has(
                &curve,
                "BT",
                &[("b", 1.0 / eps.sqrt()), ("v", v), ("w", w), ("I", current)],
            );
        }
        for point in &curve.points {
            let (b, v) = (number(&curve, point, "b"), number(&curve, point, "v"));
            assert!((b * (1.0 - v * v) - 1.0).abs() <= 1e-12);
        }
    }
}

#[test]
fn a_zero_beside_a_pair_lies_on_folds_and_hopf_points() {
    let plane = "parameters: (\"F\", \"G\"), range: ((0.1, 4.0), (0.01, 4.0))";
    let figures = [
        (
            ["0.25", "4.0"],
            [
                1.684_051_724_137_931_034_5,
                1.682_968_552_660_949_055_8,
                1.125,
            ],
            [
                -0.010_380_684_981_717_496_104,
                0.373_704_659_341_829_859_73,
                4.525_776_271_764_764,
            ],
            [
                0.466_364_895_898_559_363_18,
                0.291_954_465_600_658_697_71,
                0.194_670_651_574_029_591_65,
            ],
        ),
        (
            ["0.2", "5.0"],
            [
                1.648_188_405_797_101_449_3,
                1.821_437_957_187_688_007_5,
                1.1,
            ],
            [
                -6.019_292_654_288_460_038_1e-3,
                0.331_061_095_985_865_302_1,
                5.517_180_019_024_107,
            ],
            [
                0.371_548_232_224_784_094_91,
                0.238_616_630_538_999_897_16,
                0.149_490_436_382_620_339_33,
            ],
        ),
    ];
    for ([a, b], [force, heat, x], [y, z, omega], cusp) in figures {
        let values = [
            ("\"a\": 0.25", &*format!("\"a\": {a}")),
            ("\"b\": 4.0", &*format!("\"b\": {b}")),
        ];
        let place = [("F", force), ("G", heat), ("x", x), ("y", y), ("z", z)];
        let hopf = LORENZ84.curve(&values, &format!("event: HB, {plane}"));
        assert_eq!(types(&hopf), ["ZH"]);
        has(&hopf, "ZH", &[&place[..], &[("omega", omega)]].concat());
        let folds = LORENZ84.curve(&values, &format!("event: LP, {plane}"));
        has(&folds, "ZH", &place);
        has(
            &folds,
            "CP",
            &[("F", cusp[0]), ("G", cusp[1]), ("x", cusp[2])],
        );
    }
}

/// Two Hopf curves cross at m = κ²/(1 − k), n = −m, with ω² the roots of s² − (1 + k + mn)s + k = 0.
#[test]
fn two_pairs_on_the_imaginary_axis_lie_on_both_of_their_curves() {
    for (k, kap, n) in [(2.0_f64, 0.5, "0.15"), (3.0, 0.6, "0.17")] {
        let values = [
            ("\"k\": 2.0", &*format!("\"k\": {k:?}")),
            ("\"kap\": 0.5", &*format!("\"kap\": {kap:?}")),
            ("\"n\": 0.15", &*format!("\"n\": {n}")),
        ];
        let m = kap * kap / (1.0 - k);
        let sum = 1.0 + k - m * m;
        let root = (0.25 * sum * sum - k).sqrt();
        let mut seen = Vec::new();
        for index in [1, 2] {
            let asked = format!(
                "event: HB, index: {index}, parameters: (\"m\", \"n\"), range: ((-4.0, 1.0), (-0.5, 0.5))"
            );
            let curve = TWO.curve(&values, &asked);
            let crossing = curve
                .points
                .iter()
                .find(|point| point.kind == Some(PointType::HH));
            let omega = number(&curve, crossing.unwrap(), "omega");
            let square = [0.5 * sum - root, 0.5 * sum + root];
            let own = usize::from(omega * omega > 0.5 * sum);
            has(
                &curve,
                "HH",
                &[("m", m), ("n", -m), ("omega", square[own].sqrt())],
            );
            seen.push(own);
        }
        seen.sort_unstable();
        assert_eq!(seen, [0, 1]);
    }
}

/// BE of `low` at x = bd/(a − d), al = (1 − x)(b + x)/a; at the top of the isocline, x = (1 − b)/2, its pair is imaginary, and
/// the equilibrium in sliding has a fold where it meets a boundary there.
#[test]
fn boundary_equilibria_meet_hopf_points_and_folds() {
    let asked = "event: BE, parameters: (\"al\", \"d\"), range: ((0.3, 0.6), (0.1, 0.7))";
    let curve = HARVEST.curve(&[], asked);
    assert_eq!(types(&curve), ["HB+BE"]);
    let low = |d: f64| 0.3 * d / (1.0 - d);
    for point in &curve.points {
        let (x, al) = (number(&curve, point, "x"), number(&curve, point, "al"));
        assert!((x - low(number(&curve, point, "d"))).abs() <= 1e-13);
        assert!((al - (1.0 - x) * (0.3 + x)).abs() <= 1e-13);
    }
    has(
        &curve,
        "HB+BE",
        &[("x", 0.35), ("al", 0.4225), ("d", 0.35 / 0.65)],
    );
    let asked = "event: LP, parameters: (\"al\", \"h\"), range: ((0.3, 0.6), (0.01, 0.3))";
    let curve = HARVEST.curve(&[], asked);
    let h = 0.35 / 0.65 - 0.42;
    assert_eq!(types(&curve), ["LP+BE"]);
    has(&curve, "LP+BE", &[("x", 0.35), ("al", 0.4225), ("h", h)]);
    let asked =
        "event: BE, index: 2, parameters: (\"al\", \"h\"), range: ((0.3, 0.6), (0.01, 0.3))";
    let curve = HARVEST.curve(&[], asked);
    assert_eq!(types(&curve), ["LP+BE"]);
    has(&curve, "LP+BE", &[("x", 0.35), ("al", 0.4225), ("h", h)]);
}

/// The fold in sliding, x = (1 − b)/2, al = (1 + b)²/4, has no eigenvalue but zero. It ends where the field of either mode is in the
/// surface: x = eb/(1 − e) with e = d or d + h.
#[test]
fn folds_in_sliding_end_where_sliding_does() {
    let asked = "event: LP, parameters: (\"al\", \"b\"), range: ((0.2, 0.7), (0.1, 0.9))";
    let order = [r#"states: ["x", "y"]"#, r#"states: ["y", "x"]"#];
    for states in order {
        let curve = HARVEST.curve(&[(order[0], states)], asked);
        assert_eq!(types(&curve), ["LP+BE", "LP+BE"]);
        for point in &curve.points {
            let [x, y, b, al] = ["x", "y", "b", "al"].map(|name| number(&curve, point, name));
            assert!((x - 0.5 * (1.0 - b)).abs() <= 1e-12);
            assert!((al - 0.25 * (1.0 + b).powi(2)).abs() <= 1e-12 && (y - al).abs() <= 1e-15);
        }
        for eaten in [0.42, 0.42 + 0.15] {
            let b = 1.0 / (1.0 + 2.0 * eaten / (1.0 - eaten));
            has(
                &curve,
                "LP+BE",
                &[("b", b), ("al", 0.25 * (1.0 + b).powi(2))],
            );
        }
    }
}

/// x = p, y = q within x < 1, y < 1: the corner.
#[test]
fn two_boundaries_are_met_at_once() {
    let corner = Family {
        system: r#"states: ["x", "y"], parameters: {"p": 0.0, "q": 0.0},
            modes: {
                "in": (rates: {"x": "p - x + 0.1*y^2", "y": "q - y"}, until: [(zero: "1 - x", to: "out"), (zero: "1 - y", to: "out")]),
                "out": (rates: {"x": "p - x + 0.1*y^2", "y": "q - y"}, until: [(zero: "x - 1", to: "in")]),
            }"#,
        start: r#"mode: "in", state: {"x": 0.0, "y": 0.0}"#,
        branch: r#"parameter: "p", range: (-1.0, 2.0)"#,
    };
    let asked = "event: BE, parameters: (\"p\", \"q\"), range: ((-1.0, 2.0), (-1.0, 2.0))";
    let curve = corner.curve(&[], asked);
    assert_eq!(types(&curve), ["BE+BE"]);
    has(
        &curve,
        "BE+BE",
        &[("p", 0.9), ("q", 1.0), ("x", 1.0), ("y", 1.0)],
    );
}

/// In sliding the trace 2μ − 4ρ² + kp/M is zero; the curve ends where |px + ry| = M.
#[test]
fn hopf_points_in_sliding_end_where_sliding_does() {
    let asked = "event: HB, parameters: (\"mu\", \"M\"), range: ((-1.0, 1.0), (0.01, 2.0))";
    let curve = RELAY.curve(&[], asked);
    assert_eq!(types(&curve), ["HB+BE"]);
    for point in &curve.points {
        let [mu, bound, x, y] = ["mu", "M", "x", "y"].map(|name| number(&curve, point, name));
        let trace = 2.0 * mu - 4.0 * (x * x + y * y) + 0.4 * 0.6 / bound;
        assert!(trace.abs() <= 1e-12, "{trace:e}");
        assert_eq!(number(&curve, point, "s"), 0.0);
    }
    let end = curve
        .points
        .iter()
        .find(|point| point.kind.is_some_and(|kind| kind.to_string() == "HB+BE"));
    let [bound, x, y] = ["M", "x", "y"].map(|name| number(&curve, end.unwrap(), name));
    assert!(((0.6 * x + 0.3 * y).abs() - bound).abs() <= 1e-12);
}

#[test]
fn branch_points_have_a_curve_where_branches_stay_crossed() {
    let pitchfork = |second: &str| {
        format!("event: BP, parameters: (\"mu\", \"{second}\"), range: ((-1.5, 1.0), (-2.0, 2.0))")
    };
    let curve = PITCHFORK.curve(&[], &pitchfork("q"));
    assert!(
        curve
            .points
            .iter()
            .all(|point| point.parameters[0].abs() <= 1e-13)
    );
    // a force breaks the symmetry
    let refused = start(&PITCHFORK.problem(&[], &pitchfork("f")));
    let parameter = "f".to_owned();
    assert_eq!(refused.err(), Some(NoCurve::Unfolds { parameter }));
    // predators die out at K = x = bd/(a − d), y = 0
    let asked = "event: BP, parameters: (\"K\", \"d\"), range: ((0.05, 2.0), (0.05, 0.9))";
    let curve = PREDATORS.curve(&[], asked);
    for point in &curve.points {
        let [k, d, x, y] = ["K", "d", "x", "y"].map(|name| number(&curve, point, name));
        assert!(
            (k - 0.5 * d / (1.0 - d)).abs() <= 1e-12 && (x - k).abs() <= 1e-12 && y.abs() <= 1e-13
        );
    }
}

/// A circle of Hopf points: μ = 1 − p² − q².
#[test]
fn a_closed_curve_of_hopf_points_ends_where_it_began() {
    let circle = Family {
        system: r#"states: ["x", "y", "z"], parameters: {"p": -2.0, "q": 0.1},
            modes: {"flow": (rates: {
                "x": "(1 - p^2 - q^2)*x - 2*y + p*z - x^3", "y": "x + (1 - p^2 - q^2)*y + q*z - y^3", "z": "-z + x^2"})}"#,
        start: r#"mode: "flow", state: {"x": 0.0, "y": 0.0, "z": 0.0}"#,
        branch: r#"parameter: "p", range: (-2.0, 2.0)"#,
    };
    let asked = "event: HB, parameters: (\"p\", \"q\"), range: ((-2.0, 2.0), (-2.0, 2.0)), max_points: 3000";
    let curve = circle.curve(&[], asked);
    assert!(
        curve.end(1).contains("closes on its start"),
        "{}",
        curve.end(1)
    );
    for point in &curve.points {
        let [p, q] = point.parameters;
        assert!((p * p + q * q - 1.0).abs() <= 1e-12);
    }
}

/// Derivatives of the equations of folds, pairs and crossings are those of central differences.
#[test]
fn derivatives_of_extended_systems_are_exact() {
    let plane = |event: &str| {
        format!("event: {event}, parameters: (\"I\", \"b\"), range: ((-1.0, 4.0), (0.1, 5.0))")
    };
    let folds = [("\"b\": 0.45", "\"b\": 1.5")];
    let relay = "event: HB, parameters: (\"mu\", \"M\"), range: ((-1.0, 1.0), (0.01, 2.0))";
    let fork = "event: BP, parameters: (\"mu\", \"q\"), range: ((-1.5, 1.0), (-2.0, 2.0))";
    let slide = "event: LP, parameters: (\"al\", \"b\"), range: ((0.3, 0.6), (0.01, 0.9))";
    let problems = [
        FITZHUGH.problem(&folds, &plane("LP")),
        FITZHUGH.problem(&[], &plane("HB")),
        RELAY.problem(&[], relay),
        PITCHFORK.problem(&[], fork),
        HARVEST.problem(&[], slide),
    ];
    for problem in problems {
        let CurveStart { system, point, .. } = start(&problem).unwrap();
        // beside the curve the equations are as good
        let point = point.map_with_location(|row, _, x| x + 0.01 * ((3 * row + 1) as f64).sin());
        let count = system.unknowns();
        let at = |point: &_| {
            let (mut residual, mut jacobian) = (vec![0.0; count - 1], Matrix::zeros(count, count));
            system
                .evaluate(point, &mut residual, &mut jacobian)
                .unwrap();
            (residual, jacobian)
        };
        let (_, jacobian) = at(&point);
        const STEP: f64 = 1e-5;
        for column in 0..count {
            let moved = |step: f64| {
                let mut there = point.clone();
                there[column] += step;
                at(&there).0
            };
            let (above, below) = (moved(STEP), moved(-STEP));
            for row in 0..count - 1 {
                let difference = (above[row] - below[row]) / (2.0 * STEP);
                let own = jacobian[(row, column)];
                // truncation of the differences, with third derivatives of order ten
                assert!(
                    (own - difference).abs() <= 1e-8 * own.abs().max(1.0),
                    "{row} {column}: {own} {difference}"
                );
            }
        }
    }
}

/// A curve resumed before its first step, after every seventeenth and after the last takes the very next two, to the last bit.
#[test]
fn curves_of_equilibria_resumed_after_their_steps_take_the_same_steps() {
    let hopf =
        "event: HB, parameters: (\"I\", \"b\"), range: ((-1.0, 4.0), (0.1, 5.0)), ds_max: 0.1";
    let boundary =
        "event: BE, parameters: (\"al\", \"d\"), range: ((0.3, 0.6), (0.1, 0.7)), ds_max: 0.1";
    let fork =
        "event: BP, parameters: (\"mu\", \"q\"), range: ((-1.5, 1.0), (-2.0, 2.0)), ds_max: 0.1";
    let problems = [
        FITZHUGH.problem(&[], hopf),
        HARVEST.problem(&[], boundary),
        PITCHFORK.problem(&[], fork),
    ];
    for problem in problems {
        let mut whole = run(&problem);
        let head: CurveHead<EquilibriaInPlane> =
            ron::from_str(&ron::to_string(whole.head()).unwrap()).unwrap();
        let text = |head: &CurveHead<EquilibriaInPlane>| ron::to_string(head).unwrap();
        assert_eq!(text(&head), text(whole.head()));
        let mut steps: Vec<CurveStep<EquilibriaInPlane>> = Vec::new();
        while let Some(step) = whole.step().unwrap() {
            steps.push(step);
        }
        let written: Vec<String> = steps
            .iter()
            .map(|step| ron::to_string(step).unwrap())
            .collect();
        assert!(steps.len() > 10, "{}", steps.len());
        let counts = 0..=steps.len();
        for count in counts.filter(|count| count % 17 == 0 || *count == steps.len()) {
            let saved = written[..count]
                .iter()
                .map(|text| ron::from_str(text).unwrap());
            let mut resumed = CurveRun::resume(head.clone(), saved.collect()).unwrap();
            for next in 0..2 {
                let step = resumed.step().unwrap();
                let step = step.map(|step| ron::to_string(&step).unwrap());
                assert_eq!(step.as_ref(), written.get(count + next), "{count} + {next}");
            }
        }
    }
}
