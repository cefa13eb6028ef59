//! The states that contacts are in: where motions begin, where parameters have moved, and after resets of the user's own.

use brakewave::EventType;
use brakewave::affine::contact::place::Contradiction;
use brakewave::affine::motion::{Motion, Step};
use brakewave::hybrid::OrbitItem;
use brakewave::hybrid::equilibrium::EquilibriumItem;
use brakewave::hybrid::exponents::Exponent;
use brakewave::hybrid::scan::{Lack, ScannedMotion, Scanner};
use brakewave::problem::{Any, ProblemError, SystemProblem, parse_any};

use super::counts::{events, rows};
use super::rests::{followed, runner};
use super::systems::moved;

fn problem(text: &str) -> Result<SystemProblem, ProblemError> {
    match parse_any(text, "test.ron")? {
        Any::System(problem) => Ok(*problem),
        Any::Tube(_) => panic!("a system"),
    }
}

/// A mass with dry friction that bounces off a wall, by a law or by a switch of its own mode; its branch in A has these events.
fn bouncing(wall: &str, mode: &str) -> Vec<OrbitItem> {
    rows(&format!(
        r#"(system: (states: ["x", "v"],
            parameters: {{"A": 2.0, "w": 1.7, "d": 0.8, "e": 0.6, "N": 0.3, "c": 0.05}}, forcing: "w", {wall}),
        orbit: (start: Simulate(mode: "{mode}", state: {{"x": 0.1, "v": 0.1}}, settle: 200), periods: 4),
        continuation: (parameter: "A", range: (0.8, 2.6), toward: Both), stability: (), output: (plots: []))"#
    ))
}

/// A reset of the user's own turns slip round as the impact of a `Stop` does: the same orbits with the same events.
#[test]
fn a_bounce_of_ones_own_is_the_impact_of_a_stop() {
    let friction = r#""f": Friction(slip: "v", bound: "N")"#;
    let force = "A*sin(phase) - c*v - x + f";
    let own = bouncing(
        &format!(
            r#"contacts: {{{friction}}}, modes: {{"m": (rates: {{"x": "v", "v": "{force}"}},
                until: [(zero: "d - x", to: "m", reset: {{"v": "-e*v"}})])}}"#
        ),
        "m.forward",
    );
    let stop = bouncing(
        &format!(
            r#"contacts: {{{friction}, "s": Stop(gap: "d - x", restitution: "e")}},
            rates: {{"x": "v", "v": "{force} - s"}}"#
        ),
        "forward.open",
    );
    let first = |items: &[OrbitItem]| items[0].point.period;
    assert!((first(&own) - first(&stop)).abs() <= 1e-13);
    let [own, stop] = [own, stop].map(|items| events(&items, "A"));
    assert!(own.len() > 1, "{own:?}");
    assert_eq!(own.len(), stop.len(), "{own:#?}\n{stop:#?}");
    for ((kind, value, _), (other, other_value, _)) in own.iter().zip(&stop) {
        assert_eq!(kind, other);
        assert!(
            (value - other_value).abs() <= 1e-11,
            "{kind} {value} {other_value}"
        );
    }
}

/// A block that sticks is kicked by K to either side in turn, and slips against F and a spring k: by its energy it comes to rest at
/// ±K²/(4F), since ½K² is what friction takes on the way between.
#[test]
fn a_kick_sets_a_block_going() {
    let mode = |to: &str, sign: &str| {
        format!(
            r#"(rates: {{"x": "v", "v": "-k*x + f", "s": "1"}},
            until: [(zero: "P - s", to: "{to}", reset: {{"v": "v {sign} K", "s": "0"}})])"#
        )
    };
    let items = rows(&format!(
        r#"(system: (states: ["x", "v", "s"], parameters: {{"K": 1.0, "F": 0.4, "P": 4.0, "k": 0.1}},
            contacts: {{"f": Friction(slip: "v", bound: "F")}}, modes: {{"a": {}, "b": {}}}),
        orbit: (start: Simulate(mode: "a.stick", state: {{"x": 0.0, "v": 0.0, "s": 0.0}}, settle: 50)),
        continuation: (parameter: "K", range: (0.5, 1.25), toward: Both), stability: (), output: (plots: []))"#,
        mode("b", "+"),
        mode("a", "-"),
    ));
    assert!(items.len() > 20);
    for OrbitItem { point, .. } in &items {
        let rest = point.parameters[0].powi(2) / (4.0 * point.parameters[1]);
        let (least, most) = point.extremes[0];
        let off = (most - rest).abs().max((least + rest).abs());
        assert!(off <= 1e-13, "{off:e} at K = {}", point.parameters[0]);
        assert!((point.period - 8.0).abs() <= 1e-13);
        assert_eq!(
            point.regimes.matches("stick").count(),
            2,
            "{}",
            point.regimes
        );
    }
}

/// A problem with a mass at d on a contact.
fn mass(contact: &str, force: &str, mode: &str, state: &str) -> String {
    format!(
        r#"(system: (states: ["x", "v"], parameters: {{"A": 1.1, "w": 0.9, "d": 0.4, "e": 0.5, "k": 3.0}}, forcing: "w",
            define: {{"all": "0*(d + e + k)"}},
            contacts: {{"p": {contact}}}, rates: {{"x": "v", "v": "A*cos(phase) - x - 0.1*v + all {force}"}}),
        orbit: (start: Simulate(mode: "{mode}", state: {{{state}}}, settle: 20)),
        continuation: (parameter: "A", range: (0.9, 1.3), toward: Down), stability: ())"#
    )
}

/// A start that contradicts a slip, a gap, the velocity of what is closed or the force of a spring is refused with what fits; behind
/// a stop nothing does.
#[test]
fn a_start_that_contradicts_its_state_is_refused() {
    let stop = r#"Stop(gap: "d - x", restitution: "e")"#;
    let damped = r#"Spring(gap: "d - x", stiffness: "k", damping: "e")"#;
    let slider = r#"Jenkins(slip: "v", stiffness: "k", bound: "e")"#;
    let friction = r#"Friction(slip: "v", bound: "e", static: "1.2*e")"#;
    for (contact, force, mode, state, fits) in [
        (stop, "- p", "closed", r#""x": 0.4, "v": 0.3"#, "`open`"),
        (stop, "- p", "closed", r#""x": 0.4, "v": -0.3"#, "`open`"),
        (stop, "- p", "closed", r#""x": 0.1, "v": 0.0"#, "`open`"),
        (
            stop,
            "- p",
            "closed",
            r#""x": 0.5, "v": 0.0"#,
            "lies behind the stop `p`: its gap is -0.1",
        ),
        (
            stop,
            "- p",
            "open",
            r#""x": 0.9, "v": 0.1"#,
            "lies behind the stop `p`: its gap is -0.5",
        ),
        // kg + cġ = 1.2: there would be tension
        (damped, "- p", "closed", r#""x": 0.5, "v": -3.0"#, "`open`"),
        (damped, "- p", "closed", r#""x": 0.3, "v": 3.0"#, "`open`"),
        (damped, "- p", "open", r#""x": 0.5, "v": 3.0"#, "`closed`"),
        (
            slider,
            "+ p",
            "forward",
            r#""x": 0.3, "v": -3.0"#,
            "`stick`",
        ),
        (
            slider,
            "+ p",
            "stick",
            r#""x": 0.3, "v": 3.0, "z_p": 1.0"#,
            "`forward`",
        ),
        (
            slider,
            "+ p",
            "forward",
            r#""x": 0.3, "v": 3.0, "z_p": 0.05"#,
            "`stick`",
        ),
        (
            slider,
            "+ p",
            "stick",
            r#""x": 0.3, "v": 3.0, "z_p": -1.0"#,
            "`z_p` is beyond the bound of its element, -0.166667",
        ),
        (
            friction,
            "+ p",
            "stick",
            r#""x": 0.3, "v": 0.5"#,
            "`forward`",
        ),
        (
            friction,
            "+ p",
            "forward",
            r#""x": 0.3, "v": -0.5"#,
            "`backward`",
        ),
    ] {
        let refused = problem(&mass(contact, force, mode, state))
            .unwrap_err()
            .to_string();
        assert!(refused.contains(fits), "{mode} {state}\n{refused}");
    }
    // before its gap is, a damped spring is open once it has lost its force
    for (contact, force, mode, state) in [
        (damped, "- p", "open", r#""x": 0.5, "v": -3.0"#),
        (damped, "- p", "closed", r#""x": 0.5, "v": 3.0"#),
        (stop, "- p", "closed", r#""x": 0.4, "v": 0.0"#),
        (friction, "+ p", "stick", r#""x": 0.3, "v": 0.0"#),
        (slider, "+ p", "stick", r#""x": 0.3, "v": 3.0, "z_p": 0.1"#),
        (slider, "+ p", "forward", r#""x": 0.3, "v": 3.0"#),
    ] {
        let admitted = problem(&mass(contact, force, mode, state));
        admitted.unwrap_or_else(|error| panic!("{mode} {state}\n{error}"));
    }
}

/// Every value of a scan, with its lacks in words.
fn scanned(text: &str) -> Vec<ScannedMotion> {
    let problem = problem(text).unwrap_or_else(|error| panic!("{error}"));
    let scan = problem.scan.clone().unwrap();
    let scanner = Scanner::new(&problem, &scan).unwrap();
    scan.sweeps()
        .into_iter()
        .flat_map(|pieces| {
            let mut last = None;
            let mut all = Vec::new();
            for piece in pieces {
                let motions = scanner.piece(piece, last.take());
                last = motions
                    .last()
                    .and_then(|motion| motion.samples.last().cloned());
                all.extend(motions);
            }
            all
        })
        .collect()
}

/// A ball that rests on a table falls where the table is lower, and cannot begin within one that is higher.
#[test]
fn a_table_that_is_moved_lets_its_ball_fall() {
    let text = |sweep: &str| {
        format!(
            r#"(system: (states: ["y", "v"], parameters: {{"h": 0.0, "e": 0.4, "G": 0.9}}, forcing: "1.0",
                contacts: {{"p": Stop(gap: "y - h", restitution: "e")}}, rates: {{"y": "v", "v": "-G - 0.1*v + p"}}),
            orbit: (start: Simulate(mode: "closed", state: {{"y": 0.0, "v": 0.0}}, settle: 20)),
            scan: (parameter: "h", values: Linear(-0.5, 0.5, 3), sweep: {sweep}, settle: 20, keep: 1,
                section: Phase(0.0)))"#
        )
    };
    // a table that comes up from below has its ball within it, too
    for (sweep, lie_behind) in [
        ("Fresh", [false, false, true]),
        ("Up", [false, true, true]),
        ("Down", [true, false, false]),
    ] {
        for (motion, lies_behind) in scanned(&text(sweep)).iter().zip(lie_behind) {
            let ScannedMotion { value, lacks, .. } = motion;
            if lies_behind {
                let behind = matches!(
                    lacks,
                    Some(Lack::Contradicted(Contradiction::Behind { .. }))
                );
                assert!(behind, "{sweep} {value} {lacks:?}");
                continue;
            }
            assert_eq!(*lacks, None, "{sweep} {value}");
            let height = motion.samples[0].state[0];
            assert!((height - value).abs() <= 1e-12, "{sweep} {height}");
        }
    }
}

/// Random starts in a mode that sticks lie in what fits, and so does a motion whose belt has become faster.
#[test]
fn scans_begin_in_what_fits() {
    let text = |scan: &str| {
        format!(
            r#"(system: (states: ["x", "v"], parameters: {{"vb": 0.3, "F": 0.5, "Fs": 0.85, "c": 0.12, "k": 1.3}},
                contacts: {{"q": Friction(slip: "v - vb", bound: "F", static: "Fs")}},
                rates: {{"x": "v", "v": "-k*x - c*v + q"}}),
            orbit: (start: Simulate(mode: "stick", state: {{"x": 0.0, "v": 0.3}}, settle: 60)),
            scan: (parameter: "vb", values: Linear(0.1, 0.5, 3), settle: 60, keep: 2, section: Zero("v"), {scan}))"#
        )
    };
    for scan in ["sweep: Up", "sweep: Down", "sweep: Fresh, seed: 7"] {
        for motion in scanned(&text(scan)) {
            let lacks = motion.lacks.as_ref().map(|lack| format!("{lack:?}"));
            // a motion that rests comes to no section
            assert!(
                lacks.as_ref().is_none_or(|lacks| lacks.contains("Away")),
                "{scan} {lacks:?}"
            );
        }
    }
}

/// A motion that has come to rest tells nothing of what grows along the next one, which is that of a motion by itself.
#[test]
fn exponents_are_found_after_a_motion_that_rests() {
    let exponents = |sweep: &str| {
        let all = scanned(&format!(
            r#"(system: (states: ["x", "v"],
                parameters: {{"A": 2.2, "M": 0.9, "w": 0.9, "la": 0.7, "d": 0.5, "e": 0.8}}, forcing: "w",
                contacts: {{"q": Friction(slip: "v + la*x", bound: "M"), "s": Stop(gap: "d - x", restitution: "e")}},
                rates: {{"x": "v", "v": "A*cos(phase) - x + q - s"}}),
            orbit: (start: Simulate(mode: "forward.open", state: {{"x": 0.1, "v": 0.1}}, settle: 200), periods: 5),
            scan: (parameter: "A", values: Linear(0.4, 1.3, 2), sweep: {sweep}, settle: 100, keep: 20,
                lyapunov: true, section: Phase(0.0)))"#
        ));
        all[1].exponents.clone()
    };
    let value = |exponents: &[Exponent]| match exponents[0] {
        Exponent::Finite { value, .. } => value,
        other => panic!("{other:?}"),
    };
    let [after, alone] = ["Up", "Fresh"].map(|sweep| value(&exponents(sweep)));
    assert!((after - alone).abs() <= 1e-10, "{after} {alone}");
}

/// Where a damped spring loses its force just as the stop beside it is hit the impact closes it again: the orbit goes on through
/// without a zone between, and the two states of the spring that are called open are one.
#[test]
fn an_impact_closes_a_spring_that_has_lost_its_force() {
    let items = rows(
        r#"(system: (states: ["x", "v"],
            parameters: {"A": 1.3, "w": 0.8, "c": 0.07, "d": 0.4, "kp": 6.0, "cp": 0.9}, forcing: "w",
            contacts: {"p": Spring(gap: "d - x", stiffness: "kp", damping: "cp")},
            rates: {"x": "v", "v": "A*cos(phase) - c*v - x - p"}),
        orbit: (start: Simulate(mode: "open", state: {"x": 0.0, "v": 0.0}, settle: 200)),
        continuation: (parameter: "A", range: (1.25, 1.35), toward: Up), stability: (), output: (plots: []),
        monitor: {"opens": Before("p", "-kp*(d - x) + cp*v"), "closes": Before("p", "x", 2), "third": Before("p", "x", 3)})"#,
    );
    for OrbitItem { point, .. } in &items {
        assert_eq!(point.switches.len(), 2);
        assert_eq!(point.regimes, "open-closed");
        let monitor = |index: usize| point.monitors[index].1;
        // the force is zero where it opens, the gap where it closes, and there is no third switch
        assert!(monitor(0).unwrap().abs() <= 1e-12, "{:?}", point.monitors);
        assert!((monitor(1).unwrap() - 0.4).abs() <= 1e-12);
        assert!(monitor(2).is_none());
    }
}

/// All points of a branch of equilibria, which comes to its end.
fn equilibria(text: &str) -> Vec<EquilibriumItem> {
    let problem = problem(text).unwrap_or_else(|error| panic!("{error}"));
    followed(runner(&problem, None))
}

/// a = x + k|x − 1| − y/10 with y = x/2: a line to either side of x = 1, whatever the angle between them below a right one.
#[test]
fn equilibria_go_on_beyond_a_kink() {
    for k in [0.3, 0.9, -0.9] {
        for (from, toward) in [(-2.0, "Up"), (2.0, "Down")] {
            let x0 = match from < 1.0 {
                true => (from - k) / (0.95 - k),
                false => (from + k) / (0.95 + k),
            };
            let items = equilibria(&format!(
                r#"(system: (states: ["x", "y"], parameters: {{"a": {from:?}, "k": {k:?}}},
                    modes: {{"m": (rates: {{"x": "a - x - k*abs(x - 1) + 0.1*y", "y": "x - 2*y"}})}}),
                equilibrium: (start: Given(mode: "m", state: {{"x": {x0:?}, "y": {:?}}})),
                continuation: (parameter: "a", range: (-2.0, 2.0), toward: {toward}), output: (plots: []))"#,
                0.5 * x0
            ));
            let last = items.last().unwrap();
            assert_eq!(last.point.kind, Some(EventType::EP), "{k} {:?}", last.event);
            let sides = items.iter().map(|item| item.point.state[0] > 1.0);
            assert!(sides.clone().filter(|above| *above).count() > 2);
            for EquilibriumItem { point, .. } in &items {
                let (x, a) = (point.state[0], point.parameters[0]);
                let off = 0.95 * x + k * (x - 1.0).abs() - a;
                assert!(off.abs() <= 1e-13 * (1.0 + x.abs()), "{off:e} at x = {x}");
            }
        }
    }
}

/// Two sliders on two masses, of which one slips no more in the end: it keeps the offset with which that ends. However long the motion
/// settles, the orbit has no zone in which it slips one way only, since that would move its offset in every period.
#[test]
fn slip_that_dies_out_leaves_no_zone() {
    let mut ends: Vec<Vec<f64>> = Vec::new();
    for settle in [50, 100, 150, 200, 400] {
        let items = rows(&format!(
            r#"(system: (states: ["x0", "v0", "x1", "v1"], parameters: {{"w": 1.11, "P": 1.0}}, forcing: "w",
                contacts: {{"c0": Jenkins(slip: "v1 - v0", stiffness: "6.94", bound: "0.89"),
                    "c1": Jenkins(slip: "v0", stiffness: "7.82", bound: "0.28")}},
                rates: {{"x0": "v0", "x1": "v1",
                    "v0": "P*1.23*sin(phase) - 0.1*v0 - 0.55*x0 - 0.5*(x0 - x1) - c0 + c1",
                    "v1": "P*0.92*cos(phase) - 0.13*v1 - 0.39*x1 - 0.5*(x1 - x0) + c0"}}),
            orbit: (start: Simulate(mode: "stick.stick",
                state: {{"x0": -0.26, "v0": -0.1303, "x1": 0.05, "v1": 0.0554}}, settle: {settle}), periods: 4),
            continuation: (parameter: "P", range: (0.9, 1.0), toward: Down), stability: (), output: (plots: []))"#
        ));
        for OrbitItem { point, .. } in &items {
            assert_eq!(
                point.regimes, "stick.stick-stick.forward-stick.stick-stick.backward",
                "{settle}"
            );
        }
        ends.push(items[0].point.switches.clone());
    }
    // when the other one slips depends on the offset of the first, which depends on how that has slipped: little
    for other in &ends[1..] {
        let pairs = ends[0].iter().zip(other);
        assert!(
            pairs
                .map(|(one, other)| (one - other).abs())
                .fold(0.0, f64::max)
                <= 1e-5
        );
    }
}

/// Where a slider slips no more in either direction orbits beyond are a family, of which the one with the offset of the end is not
/// admissible on either side: one of its bounds comes first. The branch ends there, and nothing is left undone.
#[test]
fn a_branch_ends_where_what_slips_becomes_a_family() {
    let text = |value: f64, range: &str, toward: &str, mode: &str, state: &str| {
        format!(
            r#"(system: (states: ["x0", "v0", "x1", "v1"], parameters: {{"w": 1.09, "P": {value:?}}}, forcing: "w",
                contacts: {{"c0": Friction(slip: "v0 - 0.05", bound: "0.87"),
                    "c1": Jenkins(slip: "v0 - v1", stiffness: "3.61", bound: "0.92"),
                    "c2": Friction(slip: "v1 - 0.15", bound: "0.94")}},
                rates: {{"x0": "v0", "x1": "v1",
                    "v0": "P*1.65*cos(phase) - 0.11*v0 - 1.24*x0 - 0.93*(x0 - x1) + c0 + c1",
                    "v1": "P*2.8*sin(phase) - 0.26*v1 - 1.2*x1 - 0.93*(x1 - x0) - c1 + c2"}}),
            orbit: (start: Simulate(mode: "{mode}", state: {{{state}}}, settle: 200), periods: 4),
            continuation: (parameter: "P", range: {range}, toward: {toward}), stability: (), output: (plots: []))"#
        )
    };
    let state = r#""x0": -0.21, "v0": 0.2517, "x1": -0.14, "v1": -0.1366"#;
    let items = rows(&text(
        1.0,
        "(0.8, 1.0)",
        "Down",
        "forward.stick.backward",
        state,
    ));
    let all = events(&items, "P");
    let (_, value, what) = all.last().unwrap();
    assert!(what.contains("orbits are a family"), "{what}");
    assert!(
        all.iter().all(|(kind, ..)| *kind != EventType::MX),
        "{all:?}"
    );
    // just below motions come to an orbit along which the slider never slips
    let beyond = rows(&text(
        0.8288,
        "(0.8287, 0.8288)",
        "Down",
        "forward.stick.backward",
        state,
    ));
    assert!(*value > 0.8288 && *value < 0.829, "{value}");
    let slips = |name: &str| {
        let slider = name.split('-').filter_map(|zone| zone.split('.').nth(1));
        slider.filter(|state| *state != "stick").count()
    };
    assert_eq!(slips(&beyond[0].point.regimes), 0);
    assert_eq!(slips(&items[items.len() - 2].point.regimes), 2);
}

/// A damped spring that holds a mass opens where the force on it falls to what the gap takes: F = x = d, and the branch of equilibria goes on
/// in `open` through the state in which the spring has lost its force and its gap is not yet open.
#[test]
fn an_equilibrium_lets_a_damped_spring_open() {
    for (from, toward) in [(1.0, "Down"), (0.0, "Up")] {
        let (mode, x) = if from > 0.5 {
            ("closed", 2.0 / 3.0)
        } else {
            ("open", 0.0)
        };
        let items = equilibria(&format!(
            r#"(system: (states: ["x", "v"], parameters: {{"F": {from:?}}},
                contacts: {{"p": Spring(gap: "0.5 - x", stiffness: "2", damping: "0.3")}},
                rates: {{"x": "v", "v": "F - x - 0.2*v - p"}}),
            equilibrium: (start: Given(mode: "{mode}", state: {{"x": {x:?}, "v": 0.0}})),
            continuation: (parameter: "F", range: (0.0, 1.0), toward: {toward}), output: (plots: []))"#
        ));
        let kinds: Vec<EventType> = items.iter().filter_map(|item| item.point.kind).collect();
        assert_eq!(kinds, [EventType::EP, EventType::BE, EventType::EP]);
        for EquilibriumItem { point, .. } in &items {
            let (f, x) = (point.parameters[0], point.state[0]);
            // F = x + 2(x − 1/2) where it is closed
            let right = if f < 0.5 { f } else { (f + 1.0) / 3.0 };
            assert!((x - right).abs() <= 1e-13, "{x} at F = {f}");
            let is_event = point.kind == Some(EventType::BE);
            let expected = if f < 0.5 { "open" } else { "closed" };
            assert!(
                is_event || point.mode == expected,
                "{} at F = {f}",
                point.mode
            );
        }
    }
}

/// A reset to rest leaves a slider that gives to its acceleration: it goes on or holds, in one switch, and the branch passes from the one to
/// the other both ways.
#[test]
fn a_reset_to_rest_leaves_a_slider_to_its_acceleration() {
    let items = |from: f64, toward: &str| {
        rows(&format!(
            r#"(system: (states: ["x", "v"], parameters: {{"A": {from:?}, "w": 1.0, "B": 0.5}}, forcing: "w",
                contacts: {{"j": Jenkins(slip: "v", stiffness: "3", bound: "B")}},
                modes: {{"a": (rates: {{"x": "v", "v": "A*sin(phase) - 0.2*v - x + j"}},
                    until: [(zero: "0.7 - x", to: "a", reset: {{"v": "0", "x": "x - 0.3"}}, name: "catch")])}}),
            orbit: (start: Simulate(mode: "a.stick", state: {{"x": 0.0, "v": 0.1}}, settle: 100), periods: 3),
            continuation: (parameter: "A", range: (1.65, 1.8), toward: {toward}), stability: (), output: (plots: []))"#
        ))
    };
    let [up, down] = [(1.65, "Up"), (1.8, "Down")].map(|(from, toward)| {
        let items = items(from, toward);
        assert_eq!(items.last().unwrap().point.kind, Some(EventType::EP));
        events(&items, "A")
    });
    assert_eq!([up.len(), down.len()], [1, 1], "{up:?} {down:?}");
    assert_eq!([up[0].0, down[0].0], [EventType::SL; 2]);
    assert!((up[0].1 - down[0].1).abs() <= 1e-12, "{up:?} {down:?}");
}

/// The slip between two blocks ends, and the lower one, which has stuck to the floor, gives way: both move as one, with the acceleration
/// (r + g − 0.51)/2, whatever a stop far away would do, in any order of the contacts.
#[test]
fn a_stop_far_away_changes_nothing() {
    let contacts = [
        r#""c0": Friction(slip: "u - v", bound: "0.5")"#,
        r#""c1": Friction(slip: "v", bound: "0.51", static: "0.566")"#,
        r#""p": Stop(gap: "5 - y", restitution: "0.5")"#,
    ];
    let states = ["backward", "stick", "open"];
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0], [2, 0, 1]] {
        let [contacts, states] = [contacts, states].map(|all| order.map(|index| all[index]));
        let text = format!(
            r#"(states: ["y", "v", "x", "u"], parameters: {{"r": 0.62, "g": 0.3}}, contacts: {{{}}},
            rates: {{"y": "v", "v": "r - c0 + c1 - p", "x": "u", "u": "g + c0"}})"#,
            contacts.join(", ")
        );
        let (modes, end) = moved(&text, &states.join("."), &[0.0, 0.0, 0.0, -0.2], 2.0).unwrap();
        assert_eq!(modes.len(), 1, "{modes:?}");
        // u = −0.2 + 0.8 t is zero at t = 1/4
        let speed = 0.205 * 1.75;
        assert!(
            (end[1] - speed).abs() <= 1e-14 && (end[3] - speed).abs() <= 1e-14,
            "{end:?}"
        );
    }
}

/// A block that is pressed on a stop has friction of a direction, which its force alone tells: what another contact or a switch of the user's
/// own changes does not let it stick, since both forces together are not determined.
#[test]
fn what_is_pressed_on_a_stop_does_not_stick() {
    let text = r#"(states: ["y", "v", "s"], parameters: {"F": 0.1},
        contacts: {"c": Friction(slip: "v", bound: "F"), "p": Stop(gap: "-y", restitution: "0")},
        modes: {"a": (rates: {"y": "v", "v": "1 + c - p", "s": "1"}, until: [(zero: "0.5 - s", to: "b")]),
            "b": (rates: {"y": "v", "v": "0.8 + c - p", "s": "1"})})"#;
    let (modes, end) = moved(text, "a.backward.closed", &[0.0; 3], 2.0).unwrap();
    assert_eq!(modes, ["b.backward.closed"]);
    assert_eq!(&end[..2], [0.0, 0.0]);
}

/// The switches of a motion as the file begins it, by the names of their modes, with the states after them.
fn switched(text: &str, duration: f64) -> Vec<(f64, [String; 2], Vec<f64>)> {
    let problem = problem(text).unwrap_or_else(|error| panic!("{error}"));
    let system = &problem.system;
    let at = system.at(&problem.values(), &[]).unwrap();
    let start = problem.beginning().unwrap().place(system, &at).unwrap();
    let mut motion = Motion::new(&at, start, duration);
    let mut all = Vec::new();
    while let Step::Switched(one) = motion.step(duration).unwrap() {
        let names = [one.from, one.to].map(|mode| system.mode_name(mode).into_owned());
        all.push((one.time, names, one.after));
    }
    all
}

/// A slider that is said to slip is at its bound, B/k = 1/4, and where the mass turns it holds from there: its force is −B before and
/// after. One that is unloaded by a reset while it slips holds, and slips again once the mass has gone B/k further.
#[test]
fn a_slider_that_slips_is_at_its_bound() {
    let slider = r#"parameters: {"k": 4.0, "B": 1.0}, contacts: {"j": Jenkins(slip: "v", stiffness: "k", bound: "B")}"#;
    let begun = switched(
        &format!(
            r#"(system: (states: ["x", "v"], {slider}, rates: {{"x": "v", "v": "-0.5*x + j"}}),
            orbit: (start: Simulate(mode: "forward", state: {{"x": 0.0, "v": 1.0}}, settle: 10)))"#
        ),
        4.0,
    );
    // v = 0 where x² / 4 + x = 1/2
    let turns = -2.0 + 6.0_f64.sqrt();
    assert_eq!(begun[0].1, ["forward", "stick"]);
    let [x, z] = [begun[0].2[0], begun[0].2[2]];
    assert!((x - turns).abs() <= 1e-15 && z == 0.25, "{x} {z}");
    // it gives where the mass has come back by 2B/k
    assert_eq!(begun[1].1, ["stick", "backward"]);
    assert!((begun[1].2[0] - (turns - 0.5)).abs() <= 1e-15);
    let unloaded = switched(
        &format!(
            r#"(system: (states: ["x", "v", "s"], {slider}, modes: {{
                "a": (rates: {{"x": "v", "v": "j", "s": "1"}}, until: [(zero: "0.5 - s", to: "b", reset: {{"z_j": "0"}})]),
                "b": (rates: {{"x": "v", "v": "j", "s": "1"}}, until: [(zero: "10 - s", to: "a", reset: {{"s": "0"}})])}}),
            orbit: (start: Simulate(mode: "a.stick", state: {{"x": 0.0, "v": 2.0, "s": 0.0}}, settle: 10)))"#
        ),
        0.8,
    );
    let names: Vec<&str> = unloaded.iter().map(|(_, [_, to], _)| to.as_str()).collect();
    assert_eq!(names, ["a.forward", "b.stick", "b.forward"]);
    let [before, after] = [&unloaded[1].2, &unloaded[2].2];
    assert_eq!(before[3], 0.0);
    assert!((after[0] - before[0] - 0.25).abs() <= 1e-15, "{after:?}");
}

/// An impact carries a mass past the `zero` of a mode of its own, which follows in the same instant: the orbit and its events are those of the
/// modes written out, in which the stop is a switch to the other mode.
#[test]
fn an_impact_carries_a_mass_past_a_zero() {
    let rest = |mode: &str| {
        format!(
            r#"orbit: (start: Simulate(mode: "{mode}", state: {{"x": 0.0, "v": 0.5}}, settle: 200)),
            continuation: (parameter: "F", range: (0.05, 1.0), toward: Both), stability: (), output: (plots: []))"#
        )
    };
    let parameters = r#"parameters: {"F": 0.6, "c": 0.3, "e": 0.8, "h": 0.05, "d": 1.0}"#;
    let contact = rows(&format!(
        r#"(system: (states: ["x", "v"], {parameters}, contacts: {{"p": Stop(gap: "d - x", restitution: "e")}},
            modes: {{
                "push": (rates: {{"x": "v", "v": "-x - c*v + F - p"}}, until: [(zero: "v + h", to: "pull")]),
                "pull": (rates: {{"x": "v", "v": "-x - c*v - F - p"}}, until: [(zero: "h - v", to: "push")])}}), {}"#,
        rest("push.open")
    ));
    let written = rows(&format!(
        r#"(system: (states: ["x", "v"], {parameters}, modes: {{
            "push": (rates: {{"x": "v", "v": "-x - c*v + F"}}, until: [(zero: "v + h", to: "pull"),
                (zero: "d - x", to: "push", reset: {{"v": "-e*v"}}, if: ["h - e*v"]),
                (zero: "d - x", to: "pull", reset: {{"v": "-e*v"}})]),
            "pull": (rates: {{"x": "v", "v": "-x - c*v - F"}}, until: [(zero: "h - v", to: "push"),
                (zero: "d - x", to: "pull", reset: {{"v": "-e*v"}})])}}), {}"#,
        rest("push")
    ));
    let [one, other] = [&contact, &written].map(|items| items[0].point.period);
    assert!((one - other).abs() <= 1e-13, "{one} {other}");
    assert_eq!(contact[0].point.regimes, "push.open-pull.open");
    let [contact, written] = [contact, written].map(|items| events(&items, "F"));
    assert!(!written.is_empty());
    assert_eq!(contact.len(), written.len(), "{contact:#?}\n{written:#?}");
    for ((kind, value, _), (other, expected, _)) in contact.iter().zip(&written) {
        assert_eq!(kind, other);
        assert!(
            (value - expected).abs() <= 1e-12,
            "{kind} {value} {expected}"
        );
    }
}

/// A block is put back to its damped bumper, which touches it without a force for as long as friction holds it there: until the force r s on
/// it is F.
#[test]
fn a_bumper_without_a_force_ends_nothing() {
    let all = switched(
        r#"(system: (states: ["x", "v", "s"], parameters: {"r": -0.5, "F": 0.4, "P": 2.0, "d": 0.0},
            contacts: {"b": Spring(gap: "x - d", stiffness: "5", damping: "0.2"), "f": Friction(slip: "v", bound: "F")},
            modes: {"a": (rates: {"x": "v", "v": "r*s - 0.1*v + f + b", "s": "1"},
                until: [(zero: "P - s", to: "a", reset: {"x": "d", "v": "0", "s": "0"}, name: "back")])}),
        orbit: (start: Simulate(mode: "a.open.stick", state: {"x": 0.02, "v": 0.0, "s": 0.0}, settle: 20)))"#,
        7.0,
    );
    let times = all
        .iter()
        .map(|(time, [_, to], _)| (*time, to.ends_with("stick")));
    let held: Vec<f64> = times
        .filter(|(_, sticks)| *sticks)
        .map(|(time, _)| time)
        .collect();
    assert_eq!(held, [2.0, 4.0, 6.0]);
    let slips = all
        .iter()
        .filter(|(_, [from, _], _)| from == "a.closed.stick");
    for ((time, _, _), back) in slips.zip(held) {
        assert!((time - back - 0.8).abs() <= 1e-14, "{time}");
    }
}

/// A push moves a mass back over the gap of a damped spring that has lost its force: in `open` before and after, it is told by its name.
#[test]
fn a_push_across_a_gap_is_told() {
    let text = r#"(system: (states: ["x", "v", "s"], parameters: {"d": 0.5, "k": 6.0, "c": 1.0, "A": 1.5, "w": 1.1, "t1": 1.555, "b": 0.02},
        forcing: "w", contacts: {"p": Spring(gap: "d - x", stiffness: "k", damping: "c")},
        modes: {
            "a": (rates: {"x": "v", "v": "A*sin(phase) - 0.2*v - 2*x - p", "s": "0"},
                until: [(zero: "-x", to: "b", reset: {"s": "0"}, name: "up")]),
            "b": (rates: {"x": "v", "v": "A*sin(phase) - 0.2*v - 2*x - p", "s": "1"}, until: [
                (zero: "t1 - s", to: "b", reset: {"x": "x + b", "s": "-100"}, name: "push"),
                (zero: "x + 0.2", to: "a", reset: {"s": "0"}, name: "down")])}),
        orbit: (start: Simulate(mode: "a.open", state: {"x": -0.5, "v": 0.1, "s": 0.0}, settle: 100)),
        continuation: (parameter: "b", range: (0.01, 0.03), toward: Up), stability: ())"#;
    let all = rows(text);
    assert_eq!(
        all[0].point.regimes,
        "a.open-b.open-b.closed-b.open(push)-b.open"
    );
}
