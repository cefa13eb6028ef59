//! Homoclinic orbits, at which branches of cycles end, in one parameter and in two, against closed forms and figures of an
//! independent program.

use std::f64::consts::TAU;

use brakewave::EventType;
use brakewave::continuation::newton::Equations as _;
use brakewave::curve::search::find_connection;
use brakewave::curve::start::CurveStart;
use brakewave::curve::{CurvePoint, CurveRun, EquilibriaInPlane, PointType, WholeCurve};
use brakewave::hybrid::{OrbitItem, OrbitRunner};
use brakewave::linalg::{Matrix, Vector};
use brakewave::orbit::legs::{self, Run as _};
use brakewave::problem::{Any, SystemProblem, parse_any};

/// y² = x²(1 + x), −1 ≤ x < 0, is a homoclinic orbit of 0 where μ = 0.4ν + ν²: then F = y² − x²(1 + x) divides dF/dt. The
/// eigenvalues of 0 are 2(s ± 1).
const LOOP: &str = r#"(
    system: (states: ["x", "y"], parameters: {"mu": -0.1, "nu": -0.5, "s": -0.3}, modes: {"flow": (rates: {
        "x": "2*y + 2*s*x*(1 + x)", "y": "(3*x + 2)*(x + s*y) + (mu - (0.4*nu + nu^2))*y"})}),
    orbit: (start: Simulate(mode: "flow", state: {"x": -0.5, "y": 0.0}, settle: 200)),
    continuation: (parameter: "mu", range: (-0.5, 0.3)),
    curve: (event: HC, parameters: ("mu", "nu"), range: ((-0.5, 0.9), (-0.7, 0.3))),
)"#;

/// The same with a third state that grows and does not act on the others: 0 has two growing directions.
const WITH_A_GROWING_STATE: &str = r#"(
    system: (states: ["x", "y", "z"], parameters: {"mu": -0.1, "nu": -0.5, "s": -0.3}, modes: {"flow": (rates: {
        "x": "2*y + 2*s*x*(1 + x)", "y": "(3*x + 2)*(x + s*y) + (mu - (0.4*nu + nu^2))*y", "z": "0.5*z - x + y"})}),
    orbit: (start: Given(mode: "flow", state: {"x": -0.52368802, "y": -0.2216479, "z": -1.1311767}, period: 3.40635)),
    continuation: (parameter: "mu", range: (-0.5, 0.3)),
    curve: (event: HC, parameters: ("mu", "nu"), range: ((-0.5, 0.9), (-0.55, -0.4))),
)"#;

/// The saddle cycle of Lorenz that ends at the homoclinic orbit of 0.
const LORENZ: &str = r#"(
    system: (states: ["x", "y", "z"], parameters: {"r": 24.0, "s": 10.0, "b": 2.6666666666666667},
        modes: {"flow": (rates: {"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"})}),
    orbit: (start: Given(mode: "flow", state: {"x": 5.4323790804425727, "y": 5.2501859726023137, "z": 20.643095844284553},
        period: 0.67933676419821826)),
    continuation: (parameter: "r", range: (1, 30), toward: Down),
    curve: (event: HC, parameters: ("r", "s"), range: ((5.0, 30.0), (8.0, 11.0))),
)"#;

/// Out of the saddle at 0 along x, from (1, 0) by (1 − t, t) to the line x = p − q + 0.2y, which is met on the decaying
/// direction x = 0 where p − q = −0.2.
const SADDLE_WITH_SWITCHES: &str = r#"(
    system: (states: ["x", "y"], parameters: {"p": 0.4, "q": 0.3}, modes: {
        "saddle": (rates: {"x": "x", "y": "-1.5*y"}, until: [(zero: "1 - x", to: "back")]),
        "back": (rates: {"x": "-1", "y": "1"}, until: [(zero: "x - p + q - 0.2*y", to: "saddle")]),
    }),
    orbit: (start: Simulate(mode: "saddle", state: {"x": 0.2, "y": 1.0}, settle: 200)),
    continuation: (parameter: "p", range: (0.0, 1.0), toward: Down),
    curve: (event: HC, parameters: ("p", "q"), range: ((0.0, 1.0), (0.1, 0.9))),
)"#;

/// On y = 0 what slides goes from the pseudo-saddle at 0 to the tangency at 1, x' = cx/(2 − x). There it leaves into `top`,
/// a spiral about (1 − 2αc, c), and lands again where x < 1. With v = y − c and ω² = 1 − α², v(0) = −c and v'(0) = 0, it
/// lands at 0 where ce^(αt) sin ωt = −ω and ce^(αt) cos ωt = c − α.
const SLIDING: &str = r#"(
    system: (states: ["x", "y"], parameters: {"al": 0.01, "c": 1.0}, modes: {
        "top": (rates: {"x": "c - y", "y": "x - 1 + 2*al*y"}, until: [(zero: "y", to: "bottom")]),
        "bottom": (rates: {"x": "-c", "y": "1"}, until: [(zero: "-y", to: "top")]),
    }, sliding: {"slide": ("top", "bottom")}),
    orbit: (start: Simulate(mode: "slide", state: {"x": 0.9, "y": 0.0}, settle: 200)),
    continuation: (parameter: "al", range: (0.001, 0.3), toward: Up),
    curve: (event: HC, parameters: ("al", "c"), range: ((0.001, 0.3), (0.5, 2.0))),
)"#;

/// What is zero where the motion of `SLIDING` lands at the pseudo-saddle.
fn lands_at_the_pseudo_saddle(al: f64, c: f64) -> f64 {
    let omega = (1.0 - al * al).sqrt();
    let time = (1.0 + (1.0 - 2.0 * al * c) / (c * c)).ln() / (2.0 * al);
    omega * time - TAU + omega.atan2(c - al)
}

fn problem(text: &str) -> SystemProblem {
    match parse_any(text, "test") {
        Ok(Any::System(problem)) => *problem,
        other => panic!("{other:?}"),
    }
}

/// The last point of the branch, which is the homoclinic orbit.
fn end(problem: &SystemProblem) -> OrbitItem {
    let continuation = problem.continuation.as_ref().unwrap();
    let mut branch = OrbitRunner::begin(problem, continuation, None).unwrap();
    let mut last = None;
    while branch.progress().end.is_none() {
        last = branch.step().pop().or(last);
    }
    let end = &branch.progress().end;
    assert!(!matches!(end, Some(legs::RunEnd::Failed(_))), "{end:?}");
    let last = last.unwrap();
    assert_eq!(last.point.kind, Some(EventType::HC));
    last
}

fn start(problem: &SystemProblem) -> CurveStart<EquilibriaInPlane> {
    let (continuation, curve) = (problem.continuation.as_ref(), problem.curve.as_ref());
    let begin = |problem: &SystemProblem| OrbitRunner::begin(problem, continuation.unwrap(), None);
    find_connection(problem, curve.unwrap(), begin, &mut |_| ()).unwrap()
}

fn curve(problem: &SystemProblem) -> WholeCurve<EquilibriaInPlane> {
    let start = start(problem);
    let mut run = CurveRun::begin(&start.system, start.event, &start.point, start.limits).unwrap();
    while run.step().unwrap().is_some() {}
    let curve = run.unnamed();
    assert!(!curve.failed, "{} | {}", curve.end(0), curve.end(1));
    curve
}

/// The parameter at the end of a branch, which is known as it says.
fn located(text: &str, parameter: usize, truth: f64, most: f64) {
    let last = end(&problem(text));
    let event = last.event.unwrap();
    let off = (last.point.parameters[parameter] - truth).abs();
    assert!(off <= event.uncertainty, "{off:e} {event:?}");
    assert!(event.uncertainty <= most, "{event:?}");
}

/// All points of a curve, both of whose ends are edges of its range, which lie on a graph to this.
fn follows(text: &str, first_of: impl Fn(f64) -> f64, most: f64) -> Vec<CurvePoint> {
    let curve = curve(&problem(text));
    for point in &curve.points {
        let [first, second] = point.parameters;
        let off = (first - first_of(second)).abs();
        assert!(off <= most, "{first} {second} {off:e}");
    }
    let ends = [curve.points.first(), curve.points.last()];
    assert!(
        ends.iter()
            .all(|end| end.unwrap().kind == Some(PointType::One(EventType::EP)))
    );
    curve.points
}

/// A cycle r = 1 whose angle has the rate m − cos φ: a saddle-node at φ = 0 where m = 1.
const CIRCLE: &str = r#"(
    system: (states: ["x", "y"], parameters: {"m": 1.5}, define: {"q": "1 - x^2 - y^2", "w": "m - x"}, modes: {
        "flow": (rates: {"x": "x*q - y*w", "y": "y*q + x*w"})}),
    orbit: (start: Simulate(mode: "flow", state: {"x": 0.9, "y": 0.0}, settle: 100)),
    continuation: (parameter: "m", range: (0.5, 2), toward: Down),
)"#;

/// A quadratic neuron that fires at v = 1 and begins anew at -1: at rest where I ≤ 0.
const NEURON: &str = r#"(
    system: (states: ["v"], parameters: {"I": 0.5}, modes: {
        "rise": (rates: {"v": "I + v^2"}, until: [(zero: "1 - v", to: "rise", reset: {"v": "-1"})])}),
    orbit: (start: Simulate(mode: "rise", state: {"v": 0.0}, settle: 100)),
    continuation: (parameter: "I", range: (-0.5, 1), toward: Down),
)"#;

/// A damped pendulum that a torque turns round: its equilibria meet where the torque is 1, and where it is damped less it comes
/// to the saddle before.
const PENDULUM: &str = r#"(
    system: (states: ["p", "v"], parameters: {"I": 1.5, "a": 2.0}, modes: {
        "run": (rates: {"p": "v", "v": "I - sin(p) - a*v"}, until: [(zero: "2*pi - p", to: "run", reset: {"p": "p - 2*pi"})])}),
    orbit: (start: Simulate(mode: "run", state: {"p": 0.0, "v": 0.7}, settle: 100)),
    continuation: (parameter: "I", range: (0.2, 2), toward: Down),
)"#;

/// Bazykin's predator and prey: the cycle spends most of its time beside the saddle-node, and passes two saddles near by at any value.
const BAZYKIN: &str = r#"(
    system: (states: ["x", "y"], parameters: {"al": 0.5589, "g": 1.0, "e": 0.01, "D": 0.05}, modes: {"flow": (rates: {
        "x": "x - x*y/(1 + al*x) - e*x^2", "y": "-g*y + x*y/(1 + al*x) - D*y^2"})}),
    orbit: (start: Simulate(mode: "flow", state: {"x": 10.0, "y": 1.5}, settle: 1000)),
    continuation: (parameter: "al", range: (0.05, 1.2), toward: Up),
)"#;

/// Folds are known to rounding.
#[test]
fn a_saddle_node_on_a_cycle_is_its_fold() {
    // that of Bazykin's equilibria by a program of its own
    let bazykin = (BAZYKIN, 0.559_131_472_077_958);
    for (text, truth) in [(CIRCLE, 1.0), (NEURON, 0.0), (PENDULUM, 1.0), bazykin] {
        located(text, 0, truth, 1e-13);
    }
    let saddle = PENDULUM.replace("\"a\": 2.0", "\"a\": 0.5");
    let last = end(&problem(&saddle));
    assert!(last.point.parameters[0] < 0.6, "{:?}", last.point);
    assert!(last.event.unwrap().what.contains("leaves the saddle of"));
}

/// Two rooms, the second of which a thermostat heats by way of the first: with the heating on it would stay at 0.5 where
/// P = 4.1, for T₁ = 2.5 there, and is switched off at h = 0.5.
const THERMOSTAT: &str = r#"(
    system: (states: ["T1", "T2"], parameters: {"P": 8.0, "h": 0.5}, modes: {
        "on": (rates: {"T1": "-(T1 + 1) + 0.3*(T2 - T1) + P", "T2": "-0.4*(T2 + 1) + 0.3*(T1 - T2)"},
            until: [(zero: "h - T2", to: "off")]),
        "off": (rates: {"T1": "-(T1 + 1) + 0.3*(T2 - T1)", "T2": "-0.4*(T2 + 1) + 0.3*(T1 - T2)"},
            until: [(zero: "T2", to: "on")])}),
    orbit: (start: Simulate(mode: "on", state: {"T1": 0.5, "T2": 0.2}, settle: 100)),
    continuation: (parameter: "P", range: (0.1, 10), toward: Down),
)"#;

/// A leaky neuron with adaptation that fires at V = 1: it rests at I/(1 + a). A cubic law adds what it asks for.
const LEAKY: &str = r#"(
    system: (states: ["V", "w"], parameters: {"I": 2.0, "a": 0.3}, modes: {
        "rest": (rates: {"V": "-V + I - w", "w": "5*(a*V - w)"}, until: [(zero: "1 - V", to: "rest", reset: {"V": "0"})])}),
    orbit: (start: Simulate(mode: "rest", state: {"V": 0.0, "w": 0.0}, settle: 100)),
    continuation: (parameter: "I", range: (0.5, 4), toward: Down),
)"#;

/// A cycle whose motion comes to rest just where it would switch is known as its equilibrium is; in any units of a state.
#[test]
fn a_cycle_that_rests_on_its_boundary_is_its_equilibrium() {
    located(THERMOSTAT, 0, 4.1, 1e-12);
    located(LEAKY, 0, 1.3, 1e-12);
    located(&LEAKY.replace("-V + I", "-V - 0.2*V^3 + I"), 0, 1.5, 1e-12);
    let small = LEAKY.replace("a*V - w", "1e-6*a*V - w");
    located(&small.replace("I - w", "I - 1e6*w"), 0, 1.3, 1e-12);
    let last = end(&problem(LEAKY)).event.unwrap();
    assert!(
        last.what.contains("rests on the boundary of `rest`"),
        "{}",
        last.what
    );
}

#[test]
fn a_loop_in_closed_form() {
    located(LOOP, 0, 0.05, 1e-13);
    // the parabola turns at ν = −0.2
    let points = follows(LOOP, |nu| 0.4 * nu + nu * nu, 1e-12);
    let below = points.iter().filter(|point| point.parameters[1] < -0.2);
    assert!(below.count() > 3 && points.len() > 10);
}

/// The third state is left in a direction that only one value of the further unknown has. Directions that grow at different
/// rates are left where they bend by the square of 1e-3, as far as they do: here the slow one is straight.
#[test]
fn a_loop_with_two_growing_directions() {
    located(WITH_A_GROWING_STATE, 0, 0.05, 1e-12);
    follows(WITH_A_GROWING_STATE, |nu| 0.4 * nu + nu * nu, 1e-12);
}

#[test]
fn a_loop_through_switches() {
    located(SADDLE_WITH_SWITCHES, 0, 0.1, 1e-13);
    follows(SADDLE_WITH_SWITCHES, |q| q - 0.2, 1e-12);
}

/// A motion that slides comes to its pseudo-saddle from without, in a finite time, and takes for ever to leave it.
#[test]
fn a_loop_that_slides() {
    let (mut low, mut high) = (0.01, 0.3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match lands_at_the_pseudo_saddle(middle, 1.0) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    located(SLIDING, 0, low, 1e-12);
    let curve = curve(&problem(SLIDING));
    assert!(curve.points.len() > 5);
    for point in &curve.points {
        let [al, c] = point.parameters;
        let off = lands_at_the_pseudo_saddle(al, c);
        assert!(off.abs() <= 1e-12 / al, "{al} {c} {off:e}");
    }
}

/// Figures of an independent program by bisection on the side to which the growing direction of 0 returns.
#[test]
fn lorenz() {
    located(LORENZ, 0, 13.926_557_407_520_128, 1e-12);
    // beside the curve: where it meets s = 11 the branch in r ends there, too
    let curve = curve(&problem(LORENZ));
    let edge = curve
        .points
        .iter()
        .find(|point| point.parameters[1] == 11.0);
    let [r, _] = edge.unwrap().parameters;
    let text = LORENZ.replace("\"s\": 10.0", "\"s\": 11.0");
    located(&text, 0, r, 1e-12);
}

/// The derivatives of the equations along a curve are those of differences on a coarser grid, to the distance from which
/// what arrives is told.
#[test]
fn derivatives() {
    let start = start(&problem(WITH_A_GROWING_STATE));
    let count = start.system.unknowns();
    let value = |point: &Vector| {
        let mut residual = vec![0.0; count - 1];
        let mut jacobian = Matrix::zeros(count - 1, count);
        start
            .system
            .evaluate(point, &mut residual, &mut jacobian)
            .unwrap();
        (residual, jacobian)
    };
    let (at, jacobian) = value(&start.point);
    assert!(at.iter().all(|value| value.abs() < 1e-12), "{at:?}");
    for column in 0..count {
        const STEP: f64 = 1e-9;
        let mut beside = start.point.clone();
        beside[column] += STEP;
        let (there, _) = value(&beside);
        for row in 0..count - 1 {
            let slope = (there[row] - at[row]) / STEP;
            let off = (slope - jacobian[(row, column)]).abs();
            assert!(
                off < 1e-2 * slope.abs().max(1.0),
                "{row} {column} {slope} {off:e}"
            );
        }
    }
}

/// ẋ = y, ẏ = b₁ + b₂y + x² + xy: towards the Bogdanov-Takens point at 0 the homoclinic orbit becomes a thousand times smaller, and slower. Figures
/// are zeros of what the manifolds of the saddle are apart, as an independent program integrates them to 13 digits; to leading order
/// b₁ = −(49/25)b₂².
#[test]
fn a_homoclinic_orbit_shrinks_to_a_bogdanov_takens_point() {
    for (least, expected) in [
        (-0.01, 0.071_727_763_016_25),
        (-0.000_1, 0.007_145_855_228_41),
    ] {
        let points = curve(&problem(&format!(
            r#"(system: (states: ["x", "y"], parameters: {{"b1": -0.25, "b2": 0.49994375}}, modes: {{"flow": (rates: {{
                "x": "y", "y": "b1 + b2*y + x^2 + x*y"}})}}),
            orbit: (start: Given(mode: "flow", state: {{"x": -0.485, "y": 0.0}}, period: 6.2838)),
            continuation: (parameter: "b2", range: (-0.5, 1), toward: Down),
            curve: (event: HC, parameters: ("b2", "b1"), range: ((0.0, 1.0), (-0.3, {least:?}))))"#
        )))
        .points;
        let ends = [points.first().unwrap(), points.last().unwrap()];
        let small = ends
            .into_iter()
            .find(|end| end.parameters[1] == least)
            .unwrap();
        let off = small.parameters[0] / expected - 1.0;
        assert!(off.abs() <= 1e-10, "{off:e}");
    }
}

/// Followed to its end, that curve comes to that point, where neither rate of the saddle is left.
#[test]
fn a_curve_of_homoclinic_orbits_ends_at_a_bogdanov_takens_point() {
    let curve = curve(&problem(
        r#"(system: (states: ["x", "y"], parameters: {"b1": -0.25, "b2": 0.49994375}, modes: {"flow": (rates: {
            "x": "y", "y": "b1 + b2*y + x^2 + x*y"})}),
        orbit: (start: Given(mode: "flow", state: {"x": -0.485, "y": 0.0}, period: 6.2838)),
        continuation: (parameter: "b2", range: (-0.5, 1), toward: Down),
        curve: (event: HC, parameters: ("b2", "b1"), range: ((-0.1, 1.0), (-0.3, 0.1))))"#,
    ));
    let ends = [curve.points.first().unwrap(), curve.points.last().unwrap()];
    let end = ends.into_iter().find(|end| end.kind == Some(PointType::BT));
    let end = end.unwrap_or_else(|| panic!("{} {}", curve.end(0), curve.end(1)));
    let off = end
        .parameters
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(off <= 1e-12, "{off:e}");
}
