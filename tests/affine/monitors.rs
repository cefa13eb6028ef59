//! Numbers of orbits that a problem asks for, against figures of an independent program in 40 digits, balances of energy and
//! other identities, differences of neighbouring orbits, and other units and orders of the states.

use brakewave::EventType;
use brakewave::hybrid::{OrbitItem, OrbitRunner};
use brakewave::orbit::legs::Run as _;
use brakewave::problem::{Any, SystemProblem, parse_any};

fn problem(text: &str) -> SystemProblem {
    match parse_any(text, "test").unwrap_or_else(|error| panic!("{error}")) {
        Any::System(problem) => *problem,
        Any::Tube(_) => panic!("a tube"),
    }
}

/// All points of the branch of a problem.
fn points(text: &str) -> Vec<OrbitItem> {
    let problem = problem(text);
    let section = problem.continuation.as_ref().unwrap();
    let mut run =
        OrbitRunner::begin(&problem, section, None).unwrap_or_else(|error| panic!("{error}"));
    let mut items = Vec::new();
    while run.progress().end.is_none() {
        items.extend(run.step());
    }
    items
}

fn monitor(item: &OrbitItem, name: &str) -> f64 {
    let mut monitors = item.point.monitors.iter();
    let found = monitors.find(|(known, _)| known == name);
    let found = found.unwrap_or_else(|| panic!("no monitor {name}"));
    found.1.unwrap_or_else(|| panic!("{name} has no value"))
}

/// Relative, or absolute where the figure is zero or less than one.
fn agrees(item: &OrbitItem, figures: &[(&str, f64)], tolerance: f64) {
    for (name, figure) in figures {
        let found = monitor(item, name);
        let off = (found - figure).abs() / figure.abs().max(1.0);
        assert!(off <= tolerance, "{name} = {found} for {figure}: {off:e}");
    }
}

const MONITORS: &str = r#""peak": Max("x"), "low": Min("x"), "fast": Max("v"), "slow": Min("v"), "mean": Mean("x^2"),
    "loss": Integral("c*v^2"), "hit": Before("p", "v"), "leave": After("p", "v"), "work": Integral("A*cos(phase)*v"),
    "size": Largest("v"), "no_second": Before("p", "v", 2), "power": Max("A*cos(phase)*v"), "travel": Integral("abs(v)")"#;

/// The oscillator with one impact a period; `stop_at` and the range of A are given.
fn impact(stop_at: &str, range: &str) -> String {
    format!(
        r#"(system: (states: ["x", "v"], parameters: {{"A": 1.0, "w": 1.0, "c": 0.1, "e": 0.8, "d": 1.0}}, forcing: "w",
            modes: {{"free": (rates: {{"x": "v", "v": "A*cos(phase) - c*v - x"}},
                until: [(zero: "d - x", name: "p", to: "free", reset: {{"v": "-e*v"}})])}}),
        monitor: {{{MONITORS}}},
        orbit: (start: Simulate(mode: "free", state: {{"x": 0.0, "v": 0.0}}, settle: 200)),
        continuation: (parameter: "A", range: {range}, toward: Down, stop_at: [{stop_at}]))"#
    )
}

/// Figures in closed form, their integrals from the exponential of the Kronecker sum in 40 digits: exact but for the rounding of
/// the orbit, some units in the last place.
#[test]
fn monitors_of_an_impact_oscillator_are_right_to_rounding() {
    let items = points(&impact("0.3", "(0.29, 1.0)"));
    let first = [
        ("hit", 1.6957329375948820097),
        ("leave", -1.3565863500759056077),
        ("peak", 1.0),
        ("low", -1.1840600885370553279),
        ("fast", 1.7043228073187798643),
        ("size", 1.7043228073187798643),
        ("slow", -1.3565863500759056077),
        ("mean", 0.61993246868970274431),
        ("loss", 0.46313955878810613394),
    ];
    agrees(&items[0], &first, 4e-15);
    let at = |item: &&OrbitItem| item.point.kind == Some(EventType::UZ);
    let second = [
        ("hit", 0.48500088142641784457),
        ("leave", -0.38800070514113427566),
        ("peak", 1.0),
        ("low", -1.0055514390810536688),
        ("fast", 0.93978914739764757783),
        ("slow", -0.86728457046301879756),
        ("mean", 0.46055384472809958797),
        ("loss", 0.29539723274444015655),
    ];
    agrees(items.iter().find(at).unwrap(), &second, 4e-15);
    for item in &items {
        // the work of the force is lost to c and at the impact
        let speed = monitor(item, "hit");
        let lost = monitor(item, "loss") + 0.18 * speed * speed;
        assert!((monitor(item, "work") - lost).abs() <= 1e-13);
        // there and back, with one turn: travel is twice the distance
        let travel = 2.0 * (monitor(item, "peak") - monitor(item, "low"));
        assert!(
            (monitor(item, "travel") - travel).abs() <= 1e-13,
            "{travel}"
        );
        let second = item
            .point
            .monitors
            .iter()
            .find(|(name, _)| name == "no_second");
        assert_eq!(
            second.unwrap().1,
            None,
            "an orbit with one impact has no second"
        );
    }
}

/// A = |1 − ω² + icω| √((d − Vy)² + V²(e + W)²/ω²) at the speed V.
#[test]
fn a_value_of_a_monitor_is_located_to_rounding() {
    let items = points(&impact(
        "(\"hit\", 0.5), (\"hit\", 1.1), (\"loss\", 0.3)",
        "(0.15, 1.0)",
    ));
    let users = items
        .iter()
        .filter(|item| item.point.kind == Some(EventType::UZ));
    let users: Vec<(&OrbitItem, &str)> = users
        .map(|item| (item, &*item.event.as_ref().unwrap().what))
        .collect();
    let of = |what: &str| -> Vec<&OrbitItem> {
        let same = users.iter().filter(|(_, known)| known.contains(what));
        same.map(|(item, _)| *item).collect()
    };
    let [half] = of("hit = 0.5")[..] else {
        panic!()
    };
    let value = half.point.parameters[0];
    assert!((value - 0.30833205715293267775).abs() <= 4e-15, "{value}");
    let error = half.event.as_ref().unwrap().uncertainty;
    assert!(error > 0.0 && error < 1e-12, "{error:e}");
    assert_eq!(of("hit = 1.1").len(), 1);
    // the loss is least between the two
    let [one, other] = of("loss = 0.3")[..] else {
        panic!()
    };
    for item in [one, other] {
        assert!((monitor(item, "loss") - 0.3).abs() <= 1e-14);
    }
}

/// Positions in units of 1/1000, time in units of 1/16, states in the other order and with other names: the same numbers in
/// these units.
#[test]
fn units_and_order_of_states_do_not_matter() {
    let text = r#"(system: (states: ["u", "q"], parameters: {"A": 1.0, "w": 16.0, "c": 1.6, "e": 0.8, "d": 1000.0}, forcing: "w",
            modes: {"free": (rates: {"q": "16000*u", "u": "16*(A*cos(phase) - q/1000) - c*u"},
                until: [(zero: "d - q", name: "p", to: "free", reset: {"u": "-e*u"})])}),
        monitor: {"low": Min("q"), "fast": Max("u"), "mean": Mean("q^2"), "loss": Integral("c*u^2"), "hit": Before("p", "u")},
        orbit: (start: Simulate(mode: "free", state: {"q": 0.0, "u": 0.0}, settle: 200)),
        continuation: (parameter: "A", range: (0.9, 1.0), toward: Down))"#;
    let items = points(text);
    let figures = [
        ("low", -1184.0600885370553279),
        ("fast", 1.7043228073187798643),
        ("mean", 619932.46868970274431),
        // c has 16 times the value, and the period is a 16th
        ("loss", 0.46313955878810613394),
        ("hit", 1.6957329375948820097),
    ];
    agrees(&items[0], &figures, 6e-15);
}

const VAN_DER_POL: &str = r#"(system: (states: ["x", "v"], parameters: {"mu": 1.0},
        modes: {"flow": (rates: {"x": "v", "v": "mu*(1 - x^2)*v - x"})}),
    monitor: {"top": Max("x"), "low": Min("x"), "fast": Max("v"), "mean": Mean("x^2"), "mean_v": Mean("v^2"),
        "loss": Integral("0.3*v^2"), "zero": Integral("mu*(1 - x^2)*v^2"), "size": Largest("x - 1")},
    orbit: (start: Simulate(mode: "flow", state: {"x": 2.0, "v": 0.0}, settle: 100)),
    continuation: (parameter: "mu", range: (1.0, 1.5), toward: Up, stop_at: [("fast", 3.0)]))"#;

/// An integrated flow: figures in 40 digits, and identities along the branch.
#[test]
fn monitors_of_an_integrated_flow_are_right_to_rounding() {
    let items = points(VAN_DER_POL);
    let figures = [
        ("top", 2.0086198608748431365),
        ("low", -2.0086198608748431365),
        ("size", 3.0086198608748431365),
        ("fast", 2.6784414796069779493),
        ("mean", 2.0593769948418548927),
        ("mean_v", 2.0593769948418548927),
        ("loss", 4.1166659004366268106),
        ("zero", 0.0),
    ];
    agrees(&items[0], &figures, 1e-14);
    for item in &items {
        // d(xv)/dt has the mean 0, and so has v dv/dt
        let off = monitor(item, "mean_v") - monitor(item, "mean");
        assert!(off.abs() <= 1e-13, "{off:e}");
        assert!(monitor(item, "zero").abs() <= 1e-13);
    }
    let mut users = items
        .iter()
        .filter(|item| item.point.kind == Some(EventType::UZ));
    let user = users.next().unwrap();
    assert!((monitor(user, "fast") - 3.0).abs() <= 1e-14);
    assert!(users.next().is_none());
}

/// The wave of the Note as an orbit whose period is prescribed: means are over that period, and V̇ = W has the mean zero in
/// every part of time that V returns in.
#[test]
fn a_prescribed_period_has_monitors() {
    let text = include_str!("../../problems/wave_as_orbit.ron");
    let text = text.replace(
        "    orbit: (",
        "    monitor: {\"mean_w\": Mean(\"W\"), \"period_w\": Integral(\"1\"), \"largest_w\": Largest(\"W\")},\n    orbit: (",
    );
    let items = points(&text);
    for item in items.iter().take(20) {
        assert!(monitor(item, "mean_w").abs() <= 1e-13);
        assert!((monitor(item, "period_w") - item.point.period).abs() <= 1e-14);
        assert!(monitor(item, "largest_w") >= 1.0 - 1e-13);
    }
}

/// An orbit with two impacts a period, of which the second is named by its number; and a switch that does not happen.
#[test]
fn switches_are_counted_as_the_column_of_switches_has_them() {
    let text = r#"(system: (states: ["x", "v"], parameters: {"A": 1.0, "k": 1.0},
        modes: {
            "up": (rates: {"x": "1", "v": "-v"}, until: [(zero: "1 - x", name: "top", to: "down", reset: {"v": "v + A"})]),
            "down": (rates: {"x": "-k", "v": "-v"}, until: [(zero: "x", name: "bottom", to: "up")]),
        }),
        monitor: {"top": Before("top", "v"), "bottom": After("bottom", "v"), "both": After("top", "v - x"), "mean": Mean("v")},
        orbit: (start: Simulate(mode: "up", state: {"x": 0.5, "v": 0.0}, settle: 40)),
        continuation: (parameter: "A", range: (0.5, 2.0), stop_at: [("top", 0.2)]))"#;
    let items = points(text);
    // v falls by e^−2 over the period and gains A: before the jump A/(e² − 1), after a half A e/(e² − 1)
    let e = 1.0_f64.exp();
    for item in &items {
        let a = item.point.parameters[0];
        let before = a / (e * e - 1.0);
        let figures = [
            ("top", before),
            ("bottom", before * e),
            ("both", before + a - 1.0),
            ("mean", a / 2.0),
        ];
        agrees(item, &figures, 1e-14);
    }
    let user = items
        .iter()
        .find(|item| item.point.kind == Some(EventType::UZ));
    let value = user.unwrap().point.parameters[0];
    assert!((value - 0.2 * (e * e - 1.0)).abs() <= 1e-14);
}

/// A heater that lags by 1/10000 of the time of what it heats. The means of ẋ = y − x and of xẋ are zero; and in closed form, for
/// y = Q(1 − exp(−t/th)) where it is on and Q exp(−t/th) where it is off, the mean of y² is Q times that of y, less Q²th/T.
#[test]
fn integrals_of_a_stiff_mode_are_right_to_rounding() {
    let text = r#"(system: (states: ["x", "y"], parameters: {"th": 1e-4, "Q": 2.0},
        modes: {
            "on": (rates: {"x": "y - x", "y": "(Q - y)/th"}, until: [(zero: "1.1 - x", to: "off")]),
            "off": (rates: {"x": "y - x", "y": "-y/th"}, until: [(zero: "x - 0.9", to: "on")]),
        }),
        monitor: {"mx": Mean("x"), "my": Mean("y"), "xx": Mean("x^2"), "xy": Mean("x*y"), "yy": Mean("y^2")},
        orbit: (start: Simulate(mode: "on", state: {"x": 0.5, "y": 0.0}, settle: 20)),
        continuation: (parameter: "Q", range: (1.99, 2.0), toward: Down))"#;
    for (index, item) in points(text).iter().enumerate() {
        // the first orbit is solved to rounding, those of a branch as far as Newton's last step takes them
        let tolerance = if index == 0 { 1.5e-14 } else { 1e-13 };
        let of = |name: &str| monitor(item, name);
        let heat = item.point.parameters[1];
        let square = heat * of("my") - heat * heat * 1e-4 / item.point.period;
        for (one, other) in [
            (of("mx"), of("my")),
            (of("xx"), of("xy")),
            (of("yy"), square),
        ] {
            assert!((one - other).abs() <= tolerance, "{one} {other}");
        }
    }
}
