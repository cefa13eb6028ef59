//! Events of orbits of systems in two parameters against closed forms and figures of an independent program.

use std::f64::consts::TAU;

use brakewave::EventType;
use brakewave::continuation::newton::Equations as _;
use brakewave::curve::search::find_of_system;
use brakewave::curve::start::{CurveStart, NoCurve};
use brakewave::curve::{CurvePoint, CurveRun, OrbitsInPlane, PointType, Region, WholeCurve};
use brakewave::hybrid::{OrbitEvent, OrbitRunner};
use brakewave::linalg::{Matrix, Vector, null_spaces};
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{Any, SystemProblem, parse_any};

use crate::curve::observed;

const BALL: &str = include_str!("../../problems/bouncing_ball.ron");
const CHUA: &str = include_str!("../../problems/chua.ron");
const IMPACT: &str = include_str!("../../problems/impact_oscillator.ron");

/// A problem file with other lines for its start, its branch and its curve.
fn problem(
    text: &str,
    values: &[(&str, &str)],
    start: &str,
    branch: &str,
    curve: &str,
) -> SystemProblem {
    let mut text = text.to_owned();
    for (from, to) in values {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let lines = text.lines().map(|line| match line.trim_start() {
        line if line.starts_with("orbit:") => format!("orbit: ({start}),"),
        line if line.starts_with("continuation:") => {
            format!("continuation: ({branch}), curve: ({curve}),")
        }
        _ => line.to_owned(),
    });
    let text: Vec<String> = lines.collect();
    let text = text.join("\n");
    let (head, _) = text
        .split_once("    expect:")
        .expect("expectations come last");
    let Any::System(problem) = parse_any(&format!("{head})"), "test").unwrap() else {
        panic!("a system");
    };
    *problem
}

fn start(problem: &SystemProblem) -> Result<CurveStart<OrbitsInPlane>, NoCurve<OrbitsInPlane>> {
    let (Some(continuation), Some(curve)) = (&problem.continuation, &problem.curve) else {
        panic!("the problem has no curve");
    };
    let begin = |problem: &SystemProblem| OrbitRunner::begin(problem, continuation, None);
    find_of_system(problem, curve, begin, &mut |_| ())
}

/// The curve of a problem, with nothing named beside it.
pub(super) fn curve(problem: &SystemProblem) -> WholeCurve<OrbitsInPlane> {
    let start = start(problem).unwrap();
    let mut run = CurveRun::begin(&start.system, start.event, &start.point, start.limits).unwrap();
    while run.step().unwrap().is_some() {}
    run.unnamed()
}

/// Names beside the curve of a problem.
fn named(problem: &SystemProblem) -> Vec<Region> {
    let start = start(problem).unwrap();
    let run = CurveRun::begin(&start.system, start.event, &start.point, start.limits);
    let mut run = run.unwrap();
    while run.step().unwrap().is_some() {}
    run.curve().regions
}

/// Points of a type of codimension two.
fn of(curve: &WholeCurve<OrbitsInPlane>, kind: PointType) -> Vec<&CurvePoint> {
    let points = curve.points.iter();
    points.filter(|point| point.kind == Some(kind)).collect()
}

/// The whole curve of the problem of a system.
pub fn whole(text: &str) -> WholeCurve<OrbitsInPlane> {
    let Ok(Any::System(problem)) = parse_any(text, "test") else {
        panic!("a system: {text}");
    };
    let found = curve(&problem);
    assert!(!found.failed, "{} | {}", found.end(0), found.end(1));
    found
}

/// An oscillator below a stop beside two equal maps p → 0.1 − a p e^(−bT) at every period.
const MAPS_BESIDE: &str = r#"(
    system: (
        states: ["x", "v", "p", "q"],
        parameters: {"c": 0.1, "A": 0.05, "w": 1.0, "d": 1.0, "e": 0.8, "a": 1.0, "b": 0.1},
        forcing: "w",
        define: {"force": "A*cos(phase) - c*v - x"},
        modes: {
            "up": (
                rates: {"x": "v", "v": "force", "p": "-b*p", "q": "-b*q"},
                until: [(zero: "cos(phase)", to: "down"), (zero: "d - x", to: "up", reset: {"v": "-e*v"})],
            ),
            "down": (
                rates: {"x": "v", "v": "force", "p": "-b*p", "q": "-b*q"},
                until: [
                    (zero: "-cos(phase)", to: "up", reset: {"p": "0.1 - a*p", "q": "0.1 - a*q"}),
                    (zero: "d - x", to: "down", reset: {"v": "-e*v"}),
                ],
            ),
        },
    ),
    orbit: (start: Simulate(mode: "up", state: {"x": 0.0, "v": 0.0, "p": 0.0, "q": 0.0}, settle: 100)),
    continuation: (parameter: "A", range: (0.04, 0.2), toward: Up),
    curve: (event: GR, parameters: ("A", "a"), range: ((0.04, 0.2), (0.5, 3.0))),
)"#;

/// Along the graze at A = 0.1 the multipliers −a e^(−bT) of both maps pass −1 at a = e^(bT) together: no determinant
/// changes its sign there, and a point of the curve says so.
#[test]
fn two_multipliers_that_pass_together_are_told() {
    let Any::System(problem) = parse_any(MAPS_BESIDE, "test").unwrap() else {
        panic!("a system");
    };
    let curve = curve(&problem);
    let told = curve
        .points
        .iter()
        .filter(|point| point.what.contains("pass the unit circle together"));
    let told: Vec<&CurvePoint> = told.collect();
    assert_eq!(
        told.len(),
        1,
        "{:?}",
        curve
            .points
            .iter()
            .map(|point| &point.what)
            .collect::<Vec<_>>()
    );
    let [force, a] = told[0].parameters;
    // located to 1e-9 of a step, which is shorter than the range of 2.5
    let off = (a - (0.1 * TAU).exp()).abs();
    assert!(
        (force - 0.1).abs() < 1e-12 && off < 2.5e-9,
        "{force} {off:e}"
    );
    assert!(
        told[0].what.contains("0 are outside it before, 2 after")
            || told[0].what.contains("2 are outside it before, 0 after")
    );
}

const BALL_START: &str =
    "start: Given(mode: \"flight\", state: {\"y\": 0.0, \"v\": 2.0944}, phase: 0.01414)";

/// One bounce in a period of the table: fold at G = π(1 − e)/(1 + e) = q, doubling at G² = q² + (2(1 + e²)/(1 + e)²)².
#[test]
fn fold_and_doubling_of_the_ball() {
    let (mut worst, mut residual) = ([0.0_f64; 2], 0.0_f64);
    for (index, event) in ["LP", "PD"].into_iter().enumerate() {
        let problem = problem(
            BALL,
            &[],
            BALL_START,
            "parameter: \"G\", range: (1.0, 1.6), toward: Both",
            &format!("event: {event}, parameters: (\"G\", \"e\"), range: ((0.2, 2.5), (0.2, 0.8))"),
        );
        let curve = curve(&problem);
        assert!(curve.points.len() > 20, "{}", curve.points.len());
        for point in &curve.points {
            let [g, e] = point.parameters;
            let fold = 0.5 * TAU * (1.0 - e) / (1.0 + e);
            let expected = match event {
                "LP" => fold,
                _ => fold.hypot(2.0 * (1.0 + e * e) / (1.0 + e).powi(2)),
            };
            worst[index] = worst[index].max((g / expected - 1.0).abs());
            residual = residual.max(point.residual);
        }
        let ends = [curve.points.first(), curve.points.last()];
        for end in ends.into_iter().flatten() {
            assert_eq!(
                end.kind,
                Some(PointType::One(EventType::EP)),
                "{}",
                end.what
            );
        }
    }
    observed("folds of the ball in (G, e)", worst[0]);
    observed("doublings of the ball in (G, e)", worst[1]);
    assert!(
        worst[0].max(worst[1]) < 1e-10 && residual < 1e-12,
        "{worst:?} {residual:e}"
    );
}

/// The single-impact orbit of x″ + cx′ + x = A cos wt with a stop at 1: with N = (1 − E)⁻¹ of the free flight over a
/// period, A²|G|² = (1 − Vy)² + V²q², y = −(1 + e)N₁₂, q = (1 + (1 + e)(N₂₂ − 1))/w.
struct Single {
    gain: f64,
    y: f64,
    q: f64,
}

impl Single {
    fn new(c: f64, w: f64, e: f64) -> Single {
        let (decay, omega) = (0.5 * c, (1.0 - 0.25 * c * c).sqrt());
        let time = TAU / w;
        let (sine, cosine) = (omega * time).sin_cos();
        let size = (-decay * time).exp();
        let flight = [
            [size * (cosine + decay / omega * sine), size * sine / omega],
            [-size * sine / omega, size * (cosine - decay / omega * sine)],
        ];
        let [[a, b], [c0, d]] = [
            [1.0 - flight[0][0], -flight[0][1]],
            [-flight[1][0], 1.0 - flight[1][1]],
        ];
        let determinant = a * d - b * c0;
        let (n12, n22) = (-b / determinant, a / determinant);
        Single {
            gain: (1.0 - w * w).hypot(c * w).recip(),
            y: -(1.0 + e) * n12,
            q: (1.0 + (1.0 + e) * (n22 - 1.0)) / w,
        }
    }

    /// dA/dV = 0.
    fn fold(&self) -> f64 {
        self.q.abs() / self.y.hypot(self.q) / self.gain
    }

    /// V = 0.
    fn graze(&self) -> f64 {
        self.gain.recip()
    }
}

const SETTLES: &str =
    "start: Simulate(mode: \"free\", state: {\"x\": 0.0, \"v\": 0.0}, settle: 400)";

/// Fold, doubling and graze of the impact oscillator in (A, w) meet in one point, w = √(4 − c²), A = 1/|G|.
#[test]
fn fold_doubling_and_graze_meet() {
    let (w, a) = (1.997_498_435_543_818, 2.996_664_812_754_339_4);
    let at = |w: &str, force: &str| {
        vec![
            ("\"w\": 1.0".to_owned(), format!("\"w\": {w}")),
            ("\"A\": 1.0".to_owned(), format!("\"A\": {force}")),
        ]
    };
    let along = |frequency: &str, force: &str, event: &str, range: &str| {
        let values = at(frequency, force);
        let values: Vec<(&str, &str)> = values
            .iter()
            .map(|(one, other)| (&**one, &**other))
            .collect();
        let problem = problem(
            IMPACT,
            &values,
            SETTLES,
            &format!("parameter: \"A\", range: (0.5, {force}), toward: Down"),
            &format!("event: {event}, parameters: (\"A\", \"w\"), range: {range}"),
        );
        curve(&problem)
    };
    let met = |curve: &WholeCurve<OrbitsInPlane>, kind: PointType| {
        let points = of(curve, kind);
        assert_eq!(
            points.len(),
            1,
            "{kind}: {:?} {:?}",
            curve.end(0),
            curve.end(1)
        );
        let off = points[0].parameters;
        (off[0] / a - 1.0).abs().max((off[1] / w - 1.0).abs())
    };
    use EventType::{GR, LP, PD};
    let folds = along("1.8", "5.0", "LP", "((0.5, 6.0), (1.797748591989436, 2.3))");
    let mut worst = 0.0_f64;
    for point in &folds.points {
        let [force, w] = point.parameters;
        worst = worst.max((force / Single::new(0.1, w, 0.8).fold() - 1.0).abs());
    }
    let meets = met(&folds, PointType::Two(LP, GR));
    observed("folds of the impact oscillator in (A, w)", worst);
    observed("their meeting with the graze", meets);
    assert!(worst < 1e-9 && meets < 1e-6, "{worst:e} {meets:e}");
    // the other multiplier of a fold is their product, e² exp(−cT) = 0.467: neither -1 nor 1
    for kind in [PointType::Two(LP, PD), PointType::Resonance(1)] {
        assert!(of(&folds, kind).is_empty(), "{kind}");
    }
    let edge = |curve: &WholeCurve<OrbitsInPlane>| {
        let ends = [curve.points.first(), curve.points.last()];
        let mut ends = ends.into_iter().flatten();
        let end = ends.find(|end| end.kind == Some(PointType::One(EventType::EP)));
        end.expect("an end at the edge").parameters
    };
    assert!((edge(&folds)[0] / 1.241_128_668_207_79 - 1.0).abs() < 1e-9);
    let doublings = along("2.1", "8.0", "PD", "((0.5, 6.0), (1.8, 2.197248279098199))");
    let meets = met(&doublings, PointType::Two(PD, GR));
    let off = (edge(&doublings)[0] / 4.243_917_390_471_991 - 1.0).abs();
    observed("doublings of the impact oscillator at w = 2.197…", off);
    observed("their meeting with the graze", meets);
    assert!(off < 1e-9 && meets < 1e-6, "{off:e} {meets:e}");
    let grazes = along("2.1", "8.0", "GR", "((0.5, 6.0), (1.8, 2.3))");
    let mut worst = 0.0_f64;
    for point in &grazes.points {
        let [force, w] = point.parameters;
        worst = worst.max((force / Single::new(0.1, w, 0.8).graze() - 1.0).abs());
    }
    let meets = met(&grazes, PointType::Two(GR, LP));
    observed("grazes of the impact oscillator in (A, w)", worst);
    observed("their meeting with the fold", meets);
    assert!(worst < 1e-12 && meets < 1e-9, "{worst:e} {meets:e}");
}

/// With negative damping the product of both multipliers, e² exp(−cT), is 1 at c = 2 ln e/T: on that line lie the
/// Neimark-Sacker points, between resonances 1:1, where the fold is, and 1:2; 1:4 and 1:3 on the way.
#[test]
fn a_torus_between_its_resonances() {
    let problem = problem(
        IMPACT,
        &[],
        SETTLES,
        "parameter: \"c\", range: (-0.2, 0.1), toward: Down",
        "event: NS, parameters: (\"A\", \"c\"), range: ((0.01, 4.0), (-0.2, 0.1))",
    );
    let curve = curve(&problem);
    let expected = 2.0 * 0.8_f64.ln() / TAU;
    let off = |point: &CurvePoint| (point.parameters[1] / expected - 1.0).abs();
    let worst = curve.points.iter().map(off).fold(0.0, f64::max);
    observed(
        "Neimark-Sacker points of the impact oscillator in (A, c)",
        worst,
    );
    assert!(worst < 1e-10, "{worst:e}");
    let at = |order: u8| {
        let points = of(&curve, PointType::Resonance(order));
        assert_eq!(
            points.len(),
            1,
            "1:{order}: {} {}",
            curve.end(0),
            curve.end(1)
        );
        points[0]
    };
    for order in [3, 4] {
        let found = at(order).angular.unwrap();
        assert!(
            (found - TAU / f64::from(order)).abs() < 1e-9,
            "1:{order} at {found}"
        );
    }
    // the fold lies at 1:1
    let [force, c] = at(1).parameters;
    let fold = Single::new(c, 1.0, 0.8).fold();
    observed("resonance 1:1 and the fold", (force / fold - 1.0).abs());
    assert!((force / fold - 1.0).abs() < 1e-9, "{force} {fold}");
    let meet = at(2);
    assert!(meet.what.contains("1:2"), "{}", meet.what);
}

/// Forced oscillations of van der Pol's equation beside the edge at which they lose their lock.
const FORCED: &str = r#"(
    system: (
        states: ["x", "v"],
        parameters: {"w": 1.4, "m": 0.2, "A": 2.5},
        forcing: "w",
        modes: {"flow": (rates: {"x": "v", "v": "A*cos(phase) + m*(1 - x^2)*v - x"})},
    ),
    orbit: (start: Simulate(mode: "flow", state: {"x": 0.0, "v": 0.0}, settle: 300)),
    continuation: (parameter: "A", range: (0.2, 3.0), toward: Down),
    stability: (),
    curve: (event: NS, parameters: ("A", "w"), range: ((0.3, 4.0), (1.1, 2.5))),
)"#;

/// Along orbits, F = 0, the equation of an NS has the slopes of its row of the Jacobian: by its critical multipliers without
/// switches, by differences with them.
#[test]
fn derivatives_of_a_torus_are_slopes_of_its_equation() {
    let Any::System(forced) = parse_any(FORCED, "test").unwrap() else {
        panic!("a system");
    };
    let impact = problem(
        IMPACT,
        &[],
        SETTLES,
        "parameter: \"c\", range: (-0.2, 0.1), toward: Down",
        "event: NS, parameters: (\"A\", \"c\"), range: ((0.01, 4.0), (-0.2, 0.1))",
    );
    for problem in [*forced, impact] {
        let CurveStart { system, point, .. } = start(&problem).unwrap();
        let last = system.unknowns() - 2;
        let evaluate = |point: &Vector| {
            let mut residual = Vector::zeros(last + 1);
            let mut jacobian = Matrix::zeros(last + 1, last + 2);
            let residuals = residual.as_mut_slice();
            system.evaluate(point, residuals, &mut jacobian).unwrap();
            (residual, jacobian)
        };
        let (_, jacobian) = evaluate(&point);
        let orbits = null_spaces(&jacobian.rows(0, last).into_owned(), 1e-9)
            .unwrap()
            .right;
        assert_eq!(orbits.ncols(), 2);
        for direction in orbits.column_iter() {
            let at = |step: f64| evaluate(&(&point + direction * step)).0[last];
            let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
            let slope = (jacobian.row(last) * direction)[0];
            let off = (slope - difference).abs() / (1.0 + slope.abs());
            observed("slope of the equation of a torus against a difference", off);
            assert!(off < 1e-7, "{slope} {difference}");
        }
    }
}

/// A curve resumed after its steps takes the same steps.
#[test]
fn curves_of_systems_are_resumed() {
    let problem = problem(
        BALL,
        &[],
        BALL_START,
        "parameter: \"G\", range: (1.0, 1.6), toward: Both",
        "event: PD, parameters: (\"G\", \"e\"), range: ((1.2, 1.8), (0.4, 0.6))",
    );
    let start = start(&problem).unwrap();
    let begin = || CurveRun::begin(&start.system, start.event, &start.point, start.limits);
    let mut run = begin().unwrap();
    let head = ron::from_str(&ron::to_string(run.head()).unwrap()).unwrap();
    let mut steps = Vec::new();
    while let Some(step) = run.step().unwrap() {
        steps.push(ron::to_string(&step).unwrap());
    }
    let points = |run: CurveRun<OrbitsInPlane>| run.unnamed().points;
    let whole = points(run);
    for count in [0, 3, steps.len() / 2 + 2, steps.len()] {
        let saved = steps[..count]
            .iter()
            .map(|step| ron::from_str(step).unwrap());
        let mut run = CurveRun::resume(Clone::clone(&head), saved.collect()).unwrap();
        while run.step().unwrap().is_some() {}
        assert_eq!(points(run), whole, "{count}");
    }
}

/// What cannot be followed says why.
#[test]
fn events_that_have_no_curve() {
    let with = |curve: &str| {
        problem(
            BALL,
            &[],
            BALL_START,
            "parameter: \"G\", range: (1.0, 1.6), toward: Both",
            curve,
        )
    };
    for (curve, message) in [
        (
            "event: NS, parameters: (\"G\", \"e\"), range: ((0.2, 2.5), (0.2, 0.8))",
            "the branch has 0 events of the kind asked for, NS",
        ),
        (
            "event: PD, parameters: (\"G\", \"e\"), range: ((0.2, 1.5), (0.2, 0.8))",
            "outside the range from 0.2 to 1.5",
        ),
    ] {
        let refused = start(&with(curve)).err().map(|error| error.to_string());
        assert!(
            refused.as_ref().is_some_and(|text| text.contains(message)),
            "{refused:?}"
        );
    }
}

/// Names beside curves of the ball: one multiplier is outside beyond the doubling, and beside the fold there are two
/// orbits above it and none below.
#[test]
fn places_beside_the_curves_of_the_ball() {
    let beside = |event: &str, range: &str| {
        let problem = problem(
            BALL,
            &[],
            BALL_START,
            "parameter: \"G\", range: (1.0, 1.6), toward: Both",
            &format!(
                "event: {event}, parameters: (\"G\", \"e\"), range: {range}, ds: 0.1, ds_max: 0.3"
            ),
        );
        named(&problem)
    };
    let fold = |e: f64| 0.5 * TAU * (1.0 - e) / (1.0 + e);
    let doubling = |e: f64| fold(e).hypot(2.0 * (1.0 + e * e) / (1.0 + e).powi(2));
    let found = beside("PD", "((1.4, 1.7), (0.45, 0.55))");
    let mut seen = [0; 2];
    for region in &found {
        let [g, e] = region.place;
        let beyond = g > doubling(e);
        let name = ["stable", "1 multiplier outside"][usize::from(beyond)];
        assert_eq!(region.name.to_string(), name, "{:?}", region.place);
        seen[usize::from(beyond)] += 1;
    }
    assert!(seen[0] > 2 && seen[1] > 2, "{seen:?}");
    let found = beside("LP", "((0.9, 1.2), (0.45, 0.55))");
    for region in &found {
        let [g, e] = region.place;
        assert!(g > fold(e), "{:?}", region.place);
        assert_eq!(
            region.name.to_string(),
            "2 orbits flight",
            "{:?}",
            region.place
        );
    }
    assert!(found.len() > 2, "{}", found.len());
}

/// Beside the fold of the impact oscillator: one orbit without impacts before it, two more with them between the fold and
/// the graze, and one beyond.
#[test]
fn places_between_fold_and_graze() {
    let problem = problem(
        IMPACT,
        &[("\"w\": 1.0", "\"w\": 1.8"), ("\"A\": 1.0", "\"A\": 5.0")],
        SETTLES,
        "parameter: \"A\", range: (0.5, 5.0), toward: Down",
        "event: LP, parameters: (\"A\", \"w\"), range: ((0.5, 4.0), (1.75, 1.85)), ds: 0.1, ds_max: 0.3",
    );
    let regions = named(&problem);
    for region in &regions {
        let [force, w] = region.place;
        let single = Single::new(0.1, w, 0.8);
        let between = force > single.fold() && force < single.graze();
        let name = ["1 orbit free", "3 orbits free"][usize::from(between)];
        assert_eq!(region.name.to_string(), name, "{:?}", region.place);
    }
    assert!(regions.len() > 2, "{}", regions.len());
}

/// A symmetric orbit of Chua's circuit, followed to where it loses its symmetry.
fn symmetric(values: &[(&str, &str)], curve: &str) -> SystemProblem {
    let clock = if values.len() > 3 { "\"s\": 0.0, " } else { "" };
    let start = format!(
        "start: Given(mode: \"upper\", state: {{{clock}\"x\": 1.0, \"y\": 0.0937, \"z\": -0.8123}}, period: 4.6152)"
    );
    let branch = "parameter: \"alpha\", range: (13.5, 15.5), toward: Down";
    problem(
        CHUA,
        values,
        &start,
        branch,
        &format!("event: BP, parameters: {curve}"),
    )
}

/// The loss of symmetry of Chua's circuit moves along a curve through the figure of an independent program, and where the
/// curve ends a run in one parameter finds the same.
#[test]
fn loss_of_symmetry_in_two_parameters() {
    let plane = "(\"alpha\", \"beta\"), range: ((13.0, 14.5), (14.2, 14.4))";
    let curve = curve(&symmetric(&[("alpha\": 7.5", "alpha\": 13.74")], plane));
    let [first] = of(&curve, PointType::One(EventType::BP))[..] else {
        panic!("it begins with one");
    };
    let off = (first.parameters[0] - 13.728_817_274_033_318).abs();
    observed("loss of symmetry of Chua's circuit", off);
    assert!(off < 1e-11, "{off:e}");
    let [_, last] = of(&curve, PointType::One(EventType::EP))[..] else {
        panic!("two ends");
    };
    assert_eq!(last.parameters[1], 14.4);
    let there = [
        ("alpha\": 7.5", "alpha\": 13.848"),
        ("beta\": 14.3", "beta\": 14.4"),
    ];
    let found = start(&symmetric(&there, plane)).unwrap();
    let [alpha, _] = found.system.values(&found.point);
    assert!((alpha - last.parameters[0]).abs() < 1e-11, "{alpha}");
    assert!(curve.points.iter().all(|point| point.residual < 1e-12));
}

/// Where a clock runs in every mode from zero on, the image keeps its sign, and nothing else is changed.
#[test]
fn an_image_may_keep_a_sign() {
    let clock = [
        ("alpha\": 7.5", "alpha\": 13.74"),
        ("\"z\"]", "\"z\", \"s\"]"),
        ("rates: {", "rates: {\"s\": \"1\", "),
        ("er\")", "er\", reset: {\"s\": \"0\"})"),
    ];
    let plane = "(\"alpha\", \"beta\"), range: ((13.0, 14.5), (14.2, 14.4))";
    let found = start(&symmetric(&clock, plane)).unwrap();
    let [alpha, _] = found.system.values(&found.point);
    assert!((alpha - 13.728_817_274_033_318).abs() < 1e-11, "{alpha}");
    let run = CurveRun::begin(&found.system, found.event, &found.point, found.limits);
    assert!(run.is_ok());
}

/// With a parameter that takes the symmetry away the event is a point of the plane.
#[test]
fn no_curve_without_symmetry() {
    let biased = [
        ("alpha\": 7.5", "alpha\": 13.74"),
        ("857142857142857}", "857142857142857, \"d\": 0.0}"),
        ("alpha*(y - m*x)", "alpha*(y - m*x) + d"),
    ];
    let plane = "(\"alpha\", \"d\"), range: ((13.0, 14.5), (-0.1, 0.1))";
    let refused = start(&symmetric(&biased, plane)).unwrap_err();
    let parameter = "d".to_owned();
    assert_eq!(refused, NoCurve::Unfolds { parameter });
}

/// A predator and its prey through a year, doubled at −1: on the curve of doublings the second multiplier comes to −1 too.
/// The place of the resonance 1:2 is that of an independent program in 16 digits.
#[test]
fn a_doubling_comes_to_its_resonance() {
    let text = r#"(
        title: "seasons",
        system: (
            states: ["x", "y"],
            parameters: {"r": 6.28, "K": 1.0, "a": 12.56, "b0": 0.36, "e": 1.0, "d": 6.28, "eps": 0.28, "w": 6.283185307179586},
            forcing: "w",
            define: {"q": "a*x/(b0*(1 + eps*cos(phase)) + x)"},
            modes: {"only": (rates: {"x": "r*(1 - x/K)*x - q*y", "y": "e*q*y - d*y"}, until: [])},
        ),
        orbit: (start: Simulate(mode: "only", state: {"x": 0.3, "y": 0.3}, settle: 300)),
        continuation: (parameter: "eps", range: (0.2, 0.5), toward: Up),
        stability: (),
        curve: (event: PD, parameters: ("b0", "eps"), range: ((0.32, 0.4), (0.2, 0.5))),
    )"#;
    let Any::System(problem) = parse_any(text, "test").unwrap() else {
        panic!("a system");
    };
    let curve = curve(&problem);
    let met = of(&curve, PointType::Resonance(2));
    assert_eq!(met.len(), 1, "{} {}", curve.end(0), curve.end(1));
    let expected = [0.340_130_111_780_859_4, 0.336_221_646_704_923_2];
    for (found, expected) in met[0].parameters.iter().zip(expected) {
        let off = (found - expected).abs();
        assert!(off < 2e-13, "{off:e}");
    }
}

/// Half of a period takes an orbit of van der Pol's oscillator to its image: where the multipliers of that half are ±i all of them are −1, with
/// two eigenvectors, and the curve of NS goes on. The place is a zero of M₁₂ along the curve between w = 0.659 and 0.66, by variational
/// equations of an independent program.
#[test]
fn a_symmetric_orbit_passes_its_resonance() {
    let curve = whole(
        r#"(system: (states: ["x", "v"], parameters: {"A": 0.6, "w": 1.1, "mu": 0.3}, forcing: "w", modes: {"f": (
            rates: {"x": "v", "v": "A*cos(phase) + mu*(1 - x^2)*v - x"})}),
        orbit: (start: Simulate(mode: "f", state: {"x": 1.0, "v": 0.0}, settle: 300)),
        continuation: (parameter: "w", range: (0.5, 2.0)), stability: (),
        curve: (event: NS, parameters: ("w", "A"), range: ((0.64, 0.78), (0.59, 0.9))))"#,
    );
    let met = of(&curve, PointType::Resonance(2));
    assert_eq!(met.len(), 1, "{} {}", curve.end(0), curve.end(1));
    let [w, amplitude] = met[0].parameters;
    assert!((w - 0.659_93).abs() <= 1e-5, "{w}");
    assert!((amplitude - 0.805_35).abs() <= 2e-5, "{amplitude}");
    assert!(
        curve
            .points
            .iter()
            .any(|point| point.parameters[0] < w - 0.01)
    );
}

/// u' = (m + ax² − u²)u beside x' = cos φ − x: the symmetric cycle u = 0, which never switches, loses its symmetry where the mean of
/// m + ax² is zero, m = −a/(2(1 + w²)).
#[test]
fn a_cycle_without_switches_loses_its_symmetry_along_a_curve() {
    for states in [r#""x", "u""#, r#""u", "x""#] {
        let text = format!(
            r#"(system: (states: [{states}], parameters: {{"m": 0.1, "w": 1.5}}, forcing: "w", modes: {{"all": (
            rates: {{"x": "cos(phase) - x", "u": "(m + 0.4*x^2 - u^2)*u"}})}}),
            orbit: (start: Given(mode: "all", state: {{"x": 0.3, "u": 0.0}})),
            continuation: (parameter: "m", range: (-0.3, 0.2), toward: Down),
            curve: (event: BP, parameters: ("m", "w"), range: ((-0.3, 0.2), (1.0, 2.0))))"#
        );
        let Ok(Any::System(problem)) = parse_any(&text, "test") else {
            panic!("a system");
        };
        let curve = curve(&problem);
        assert!(!curve.failed, "{} | {}", curve.end(0), curve.end(1));
        let off = curve.points.iter().map(|point| {
            let [m, w] = point.parameters;
            (m + 0.2 / (1.0 + w * w)).abs()
        });
        let worst = off.fold(0.0, f64::max);
        observed(
            "losses of symmetry of a smooth cycle in two parameters",
            worst,
        );
        assert!(curve.points.len() > 10 && worst < 1e-10, "{worst:e}");
    }
}

/// A fold of a bilinear oscillator towards resonance, where the orbit grows as 1/c, comes to the edge of its range at the place of a
/// separate solution by the flow in closed form.
#[test]
fn a_curve_of_folds_goes_on_as_its_orbits_grow() {
    for (states, unit) in [(r#""x", "v""#, 1.0), (r#""v", "x""#, 1e-3)] {
        let text = format!(
            r#"(system: (states: [{states}], parameters: {{"c": 0.08, "w": 0.55}}, forcing: "w", define: {{
            "soft": "{unit}*0.6*cos(phase) - c*v - x"}}, modes: {{
            "soft": (rates: {{"x": "v", "v": "soft"}}, until: [(zero: "{unit} - x", to: "hard")]),
            "hard": (rates: {{"x": "v", "v": "soft - 6*(x - {unit})"}}, until: [(zero: "x - {unit}", to: "soft")])}}),
            orbit: (start: Simulate(mode: "soft", state: {{"x": 0.0, "v": 0.0}}, settle: 200)),
            continuation: (parameter: "w", range: (0.3, 2.2)),
            curve: (event: LP, parameters: ("w", "c"), range: ((1.35, 2.2), (0.012, 0.1))))"#
        );
        let Ok(Any::System(problem)) = parse_any(&text, "test") else {
            panic!("a system");
        };
        let curve = curve(&problem);
        assert!(!curve.failed, "{} | {}", curve.end(0), curve.end(1));
        let least = curve
            .points
            .iter()
            .find(|point| point.parameters[1] == 0.012);
        let off = least.map_or(f64::NAN, |point| point.parameters[0] - 1.441_205_265_80);
        assert!(off.abs() < 1e-10, "{off:e}");
    }
}

/// Wave trains of McKean's nerve at their slowest or fastest: along the curve of these folds the speed, which is free, has a column, and
/// every orbit has the length L that is prescribed. Where the curve begins the speed is that of the branch.
#[test]
fn the_speed_of_a_wave_is_in_the_table() {
    let text = r#"(
        system: (
            states: ["u", "p", "w"], parameters: {"L": 10.0, "c": 0.3172, "a": 0.15, "b": 0.05},
            modes: {
                "high": (rates: {"u": "p", "p": "c*p + u - 1 + w", "w": "b*u/c"}, until: [(zero: "u - a", to: "low")]),
                "low": (rates: {"u": "p", "p": "c*p + u + w", "w": "b*u/c"}, until: [(zero: "a - u", to: "high")]),
            },
        ),
        orbit: (start: Given(mode: "high", state: {"u": 0.15, "p": 0.46877, "w": 0.2366}, period: 10.0), period: "L", free: "c"),
        continuation: (parameter: "a", range: (0.1, 0.45)),
        curve: (event: LP, parameters: ("L", "a"), range: ((8.0, 12.0), (0.02, 0.45))),
    )"#;
    let Any::System(problem) = parse_any(text, "test").unwrap() else {
        panic!("a system");
    };
    let continuation = problem.continuation.as_ref().unwrap();
    let mut branch = OrbitRunner::begin(&problem, continuation, None).unwrap();
    let mut events = Vec::new();
    while branch.progress().end.is_none() {
        events.extend(branch.step().into_iter().filter_map(|item| item.event));
    }
    let is_fold = |event: &&OrbitEvent| event.kind == EventType::LP;
    let fold = events.iter().find(is_fold).unwrap();
    let (name, speed) = &fold.parameters[1];
    let curve = curve(&problem);
    assert_eq!(
        (name.as_str(), &curve.columns[..]),
        ("c", &["c".to_owned()][..])
    );
    let fold_itself = PointType::One(EventType::LP);
    let own = &curve.points[curve.start];
    assert_eq!(own.kind, Some(fold_itself));
    assert!((own.numbers[0].unwrap() - speed).abs() <= 1e-12 * speed);
    for point in &curve.points {
        assert!((point.measure - point.parameters[0]).abs() <= 1e-12 * point.measure);
        assert!(point.numbers[0].is_some_and(|c| c > 0.0 && c.is_finite()));
    }
}
