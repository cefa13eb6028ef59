//! What is said does not depend on where the origin of the states lies, nor on how far from it one begins.

use brakewave::EventType;
use brakewave::affine::steady::Isolation;

use super::branches::{follow, started};
use super::rests::{Course, LORENZ, STARTS, meets, number};
use super::systems::{at, system};
use EventType::{BP, EP, GR, HB, HC, LP, SL};

/// Lorenz's equations with the origin elsewhere.
fn lorenz([x, y, z]: [f64; 3]) -> String {
    LORENZ.replace(
        r#""x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z""#,
        &format!(
            r#""x": "s*((y + {y:?}) - (x + {x:?}))", "y": "r*(x + {x:?}) - (y + {y:?}) - (x + {x:?})*(z + {z:?})",
            "z": "(x + {x:?})*(y + {y:?}) - b*(z + {z:?})""#
        ),
    )
}

/// Shifts of up to 3, some of one state alone.
fn shifts() -> impl Iterator<Item = [f64; 3]> {
    let share = |k: u32, by: f64| ((f64::from(k) * by).fract() - 0.5) * 6.0;
    let all = (1..=12).map(move |k| [2.0, 3.0, 5.0].map(|root: f64| share(k, root.sqrt())));
    all.chain([
        [1.0, 2.0, 3.0],
        [0.001, 0.0, 0.0],
        [-1.6, -2.4, -0.6],
        [0.9, 0.0, 0.0],
    ])
}

/// The pitchfork at r = 1, on the branch that turns back there, and the Hopf point on both of its arms: r = s(s + b + 3)/(s − b − 1).
#[test]
fn a_pitchfork_is_one_event() {
    for shift in shifts() {
        let text = lorenz(shift).replace("\"r\": 20.0", "\"r\": 15.0");
        let roll = [6.11 - shift[0], 6.11 - shift[1], 14.0 - shift[2]];
        let course = Course {
            system: &text,
            state: &roll,
            range: (0.2, 30.0),
            ..STARTS[2]
        };
        let events = course.events();
        let kinds: Vec<EventType> = events.iter().map(|event| event.kind).collect();
        assert_eq!(
            kinds.iter().filter(|kind| **kind == BP).count(),
            1,
            "{shift:?}: {kinds:?}"
        );
        assert!(
            kinds.iter().all(|kind| [BP, HB].contains(kind)),
            "{shift:?}: {kinds:?}"
        );
        let place = [("x", -shift[0]), ("y", -shift[1]), ("z", -shift[2])];
        meets(&events, BP, "r", 1.0, &place);
    }
}

/// All three equilibria, of which none is degenerate.
#[test]
fn equilibria_are_found_from_any_origin() {
    for shift in shifts() {
        let text = lorenz(shift).replace("\"r\": 20.0", "\"r\": 15.0");
        let found = at(&system(&text), &[]).equilibria(0).unwrap();
        assert_eq!(found.len(), 3, "{shift:?}");
        let root = (14.0_f64 * 8.0 / 3.0).sqrt();
        for (rest, x) in found.iter().zip([-root, 0.0, root]) {
            assert!(
                (rest.state[0] - (x - shift[0])).abs() <= 1e-13,
                "{shift:?}: {:?}",
                rest.state
            );
            assert_eq!(
                rest.isolation,
                Isolation::Simple,
                "{shift:?}: {:?}",
                rest.state
            );
        }
    }
}

/// A branch that begins at its fold, but for rounding, has a fold there: x = 1 ± √μ, and a ball whose two bounces meet at G = π/3.
#[test]
fn a_fold_at_the_beginning_is_a_fold() {
    let text = r#"(states: ["x"], parameters: {"mu": 0.0}, modes: {"flow": (rates: {"x": "mu - (x - 1)^2"})})"#;
    for mu in [1e-16_f64, 1e-13, 1e-6] {
        let text = text.replace("\"mu\": 0.0", &format!("\"mu\": {mu:?}"));
        for x in [1.0 + mu.sqrt(), 1.0 - mu.sqrt()] {
            let course = Course {
                system: &text,
                mode: "flow",
                state: &[x],
                parameter: "mu",
                range: (-1.0, 1.0),
            };
            let events = course.events();
            let kinds: Vec<EventType> = events.iter().map(|event| event.kind).collect();
            assert_eq!(kinds, [LP], "{mu:e} {x}");
            assert!(number(&events[0], "mu").abs() <= 1e-13, "{mu:e} {x}");
        }
    }
}

/// x' = μ − x² from as near to its fold as may be, alone and with a state that follows: the whole range both ways, in units of what the states
/// become.
#[test]
fn a_branch_that_begins_small_gets_on() {
    for mu in [1e-6_f64, 1e-10, 1e-12, 1e-14] {
        let alone = format!(
            r#"(states: ["x"], parameters: {{"mu": {mu:?}}}, modes: {{"flow": (rates: {{"x": "mu - x^2"}})}})"#
        );
        let followed = format!(
            r#"(states: ["y", "x"], parameters: {{"mu": {mu:?}}}, modes: {{"flow": (rates: {{"x": "mu - x^2", "y": "3*x^2 - y"}})}})"#
        );
        for (text, state) in [
            (alone, vec![mu.sqrt()]),
            (followed, vec![3.0 * mu, mu.sqrt()]),
        ] {
            let course = Course {
                system: &text,
                mode: "flow",
                state: &state,
                parameter: "mu",
                range: (-1.0, 1.0),
            };
            // `all` sees that both ways end well
            let events = course.events();
            let kinds: Vec<EventType> = events.iter().map(|event| event.kind).collect();
            assert_eq!(kinds, [LP], "{mu:e} {state:?}");
        }
    }
}

/// x = db/(a − d) has no bifurcation, and ends where it leaves every bound, at d = a as far as it says.
#[test]
fn an_equilibrium_that_grows_without_bound_ends() {
    for (a, b) in [(0.85, 0.34), (0.4, 2.0), (3.0, 0.01)] {
        let text = format!(
            r#"(states: ["x"], parameters: {{"a": {a:?}, "b": {b:?}, "d": {:?}}}, modes: {{"flow": (rates: {{"x": "d - a*x/(b + x)"}})}})"#,
            0.3 * a
        );
        let course = Course {
            system: &text,
            mode: "flow",
            state: &[0.3 * b / 0.7],
            parameter: "d",
            range: (0.1 * a, 1.4 * a),
        };
        let events = course.events();
        let kinds: Vec<EventType> = events.iter().map(|event| event.kind).collect();
        assert_eq!(kinds, [EventType::MX], "{a} {b}");
        let off = (number(&events[0], "d") - a).abs();
        assert!(off <= 2.0 * events[0].uncertainty, "{a} {b}: {off:e}");
        assert!(events[0].uncertainty <= 1e-2 * a, "{a} {b}");
    }
}

/// Beside a homoclinic orbit the slope of the parameter is rounding: no multiplier passes 1, in any coordinates.
#[test]
fn no_multiplier_passes_beside_a_homoclinic_orbit() {
    let plain = r#"(states: ["x", "y"], parameters: {"mu": -0.0967799, "nu": -0.456702, "s": -0.353818}, modes: {"flow": (rates: {
        "x": "2*y + 2*s*x*(1 + x)", "y": "(3*x + 2)*(x + s*y) + (mu - 0.4*nu - nu^2)*y"})})"#;
    let turned = r#"(states: ["x", "y"], parameters: {"mu": -0.0967799, "nu": -0.456702, "s": -0.353818}, modes: {"flow": (rates: {
        "x": "-((3*y + 2)*(y - s*x) - (mu - 0.4*nu - nu^2)*x)", "y": "-2*x + 2*s*y*(1 + y)"})})"#;
    let mut ends = Vec::new();
    for (text, state) in [(plain, [-0.5, 0.0]), (turned, [0.0, -0.5])] {
        let range = (-0.74, 0.54);
        let from = ("flow", &state[..], 0.0);
        let (orbit, point) = started(text, from, ("mu", range), 200.0).unwrap();
        let seen = follow(&orbit, &point, true, range, 2000).0;
        let kinds: Vec<EventType> = seen.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [HC]);
        ends.push(seen[0].value);
    }
    assert!((ends[0] - ends[1]).abs() <= 1e-12, "{ends:?}");
}

/// A ball on a table that shakes it no more lies on it for ever, below G = g, whatever g.
#[test]
fn a_ball_comes_to_lie_on_its_table() {
    for g in [0.83, 0.5, 1.1] {
        let text = format!(
            r#"(states: ["y", "u"], parameters: {{"G": {:?}, "g": {g:?}}}, forcing: "1", contacts: {{"p": Stop(gap: "y", restitution: "0")}},
            rates: {{"y": "u", "u": "G*sin(phase) - g + p"}})"#,
            1.5 * g
        );
        let range = (0.4 * g, 3.0 * g);
        let from = ("open", &[1.0, 0.0][..], 0.0);
        let (orbit, point) = started(&text, from, ("G", range), 60.0).unwrap();
        let seen = follow(&orbit, &point, false, range, 2000).0;
        let kinds: Vec<EventType> = seen.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [GR, EP], "{g}");
        assert!((seen[0].value - g).abs() <= 1e-12, "{g}: {}", seen[0].value);
    }
}

/// A harvest that begins at a threshold of the predators, which slides there, left at a tangency: the ends of its second zone are those of
/// problems/predator_prey.ron wherever the origin is.
#[test]
fn a_tangency_is_one_far_from_the_origin() {
    for [a, b] in [[0.0, 0.0], [8.0, -8.0], [-25.0, 17.0], [71.0, 79.0]] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"a": 1.0, "b": 0.3, "d": 0.42, "h": 0.15, "al": 0.6}},
            define: {{"X": "x + {a:?}", "Y": "y + {b:?}", "eaten": "a*X*Y/(b + X)"}},
            modes: {{
                "low": (rates: {{"x": "X*(1 - X) - eaten", "y": "eaten - d*Y"}}, until: [(zero: "al - Y", to: "high")]),
                "high": (rates: {{"x": "X*(1 - X) - eaten", "y": "eaten - (d + h)*Y"}}, until: [(zero: "Y - al", to: "low")]),
            }}, sliding: {{"slide": ("low", "high")}})"#
        );
        let range = (0.43, 0.77);
        let from = ("low", &[0.3 - a, 0.5 - b][..], 0.0);
        let (orbit, point) = started(&text, from, ("al", range), 200.0).unwrap();
        for (up, known) in [(false, 0.514_811_352_892_52), (true, 0.692_771_225_622_60)] {
            let seen = follow(&orbit, &point, up, range, 2000).0;
            let kinds: Vec<EventType> = seen.iter().map(|one| one.kind).collect();
            assert_eq!(kinds, [SL, EP], "{a} {b}");
            // a rounding of the states, which the tangency magnifies
            let rounding = 2e-14 * (1.0 + a.abs().max(b.abs()));
            let off = (seen[0].value - known).abs();
            assert!(off <= 20.0 * rounding, "{a} {b}: {off:e}");
        }
    }
}

/// The connection of a homoclinic orbit is found wherever its saddle lies: it is no farther from there than the orbit is large.
#[test]
fn a_homoclinic_orbit_is_found_far_from_the_origin() {
    for [a, b] in [[0.0, 0.0], [-2.92, 2.02], [14.0, -9.0]] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"mu": -0.0893601, "nu": -0.477427, "s": -0.269664}},
            define: {{"X": "x + {a:?}", "Y": "y + {b:?}"}},
            modes: {{"flow": (rates: {{"x": "2*Y + 2*s*X*(1 + X)", "y": "(3*X + 2)*(X + s*Y) + (mu - 0.4*nu - nu^2)*Y"}})}})"#
        );
        let range = (-0.5, 0.3);
        let from = ("flow", &[-0.5 - a, -b][..], 0.0);
        let (orbit, point) = started(&text, from, ("mu", range), 200.0).unwrap();
        let seen = follow(&orbit, &point, true, range, 2000).0;
        let kinds: Vec<EventType> = seen.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [HC], "{a} {b}");
        // roundings of the states, of which the parameter is a part of order one
        let off = (seen[0].value - 0.036_965_740_329_000).abs();
        assert!(
            off <= 1e-13 * (1.0 + a.abs().max(b.abs())),
            "{a} {b}: {off:e}"
        );
    }
}
