//! Sliding as a mode of its own: what ends it, its surface, laws that have no value beyond it, and what it comes to.

use std::f64::consts::TAU;

use brakewave::EventType;
use brakewave::affine::motion::{Halt, Motion, Step, Switching};
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::NoStart;
use brakewave::affine::system::System;
use brakewave::linalg::Vector;
use brakewave::orbit::{Bifurcations, Examined, Zones};

use crate::affine::branches::{follow, started};
use crate::affine::counts::{events, rows};
use crate::affine::systems::{BRAKE_BY_HAND, TWO_MASSES, at, place, system};

/// Every switch of a motion up to a time, and why it does not go on.
fn switches(
    system: &System,
    (mode, state, phase): (&str, &[f64], f64),
    until: f64,
) -> (Vec<Switching>, Option<Halt>) {
    let affine = at(system, &[]);
    let mut motion = Motion::new(&affine, place(system, mode, state, phase), until);
    let mut found = Vec::new();
    loop {
        match motion.step(until) {
            Ok(Step::Switched(switching)) => found.push(switching),
            Ok(_) => return (found, None),
            Err(halt) => return (found, Some(halt)),
        }
    }
}

/// The orbit on which a motion settles.
fn settled(
    text: &str,
    parameter: &str,
    (mode, state): (&str, &[f64]),
    settle: f64,
) -> Result<(AffineOrbit, Vector), NoStart> {
    started(text, (mode, state, 0.0), (parameter, (0.0, 1.0)), settle)
}

/// A block between brakes that let go while sin φ > h: stick by `sliding`.
const BRAKE: &str = r#"(
    states: ["x", "v"],
    parameters: {"A": 0.3, "w": 0.5, "f": 0.4, "g": 0.02, "h": 0.8},
    forcing: "w",
    define: {"a": "A*sin(phase) - x - 0.1*v"},
    modes: {
        "p": (rates: {"x": "v", "v": "a - f"}, until: [(zero: "v", to: "n"), (zero: "h - sin(phase)", to: "P")]),
        "n": (rates: {"x": "v", "v": "a + f"}, until: [(zero: "-v", to: "p"), (zero: "h - sin(phase)", to: "N")]),
        "P": (rates: {"x": "v", "v": "a - g"}, until: [(zero: "v", to: "N"), (zero: "sin(phase) - h", to: "p")]),
        "N": (rates: {"x": "v", "v": "a + g"}, until: [(zero: "-v", to: "P"), (zero: "sin(phase) - h", to: "n")]),
    },
    sliding: {"stick": ("p", "n"), "Stick": ("P", "N")},
)"#;

/// The same with stick written out.
fn with_stick() -> String {
    BRAKE_BY_HAND
        .replace("hold", "stick")
        .replace("Hold", "Stick")
}

/// A sliding mode ends where a guard of its two modes is zero, in the mode that follows there by Filippov.
#[test]
fn sliding_ends_at_the_guards_of_its_modes() {
    let both = [BRAKE.to_owned(), with_stick()].map(|text| {
        let text = text.as_str();
        let system = system(text);
        let (all, halt) = switches(&system, ("p", &[0.0, 0.5], 0.0), 100.0);
        assert_eq!(halt, None);
        let named = all.into_iter().map(|one| {
            let names = [one.from, one.to].map(|mode| system.mode_name(mode).into_owned());
            (names, one)
        });
        named.collect::<Vec<_>>()
    });
    let [sliding, by_hand] = &both;
    assert_eq!(sliding.len(), by_hand.len());
    let to = |name: &str| sliding.iter().filter(|(names, _)| names[1] == name).count();
    assert!(
        to("Stick") > 0 && to("P") > 4,
        "{} {}",
        to("Stick"),
        to("P")
    );
    for ((names, one), (by_hand, other)) in sliding.iter().zip(by_hand) {
        assert_eq!(names, by_hand, "at {}", other.time);
        // times and states of order 1 to 100 with the rounding of a hundred zones
        assert!((one.time - other.time).abs() < 1e-11, "{}", other.time);
        for (x, y) in one.after.iter().zip(&other.after) {
            assert!((x - y).abs() < 1e-11, "{x} {y} at {}", other.time);
        }
    }
    // the same orbit, with the same multipliers
    let orbits = [BRAKE.to_owned(), with_stick()].map(|text| {
        let text = text.as_str();
        let (orbit, point) = settled(text, "A", ("p", &[0.0, 0.5]), 100.0).unwrap();
        let extremes = orbit.extremes(&point).unwrap();
        (orbit.sequence.to_string(), extremes)
    });
    assert_eq!(orbits[0].0, orbits[1].0);
    for ((low, high), (least, most)) in orbits[0].1.iter().zip(&orbits[1].1) {
        assert!((low - least).abs() < 1e-12 && (high - most).abs() < 1e-12);
    }
}

/// A mass that sticks to a belt is carried to a stop: it arrives with the speed of the belt, and leaves with −e times that.
/// It comes back too slowly to stick again, and ever shorter bounces end in finite time.
#[test]
fn sliding_takes_the_reset_of_a_guard() {
    let text = r#"(
        states: ["x", "v"],
        parameters: {"V": 0.3, "f": 1.0, "d": 0.5, "e": 0.5},
        modes: {
            "slow": (rates: {"x": "v", "v": "-x + f"}, until: [(zero: "V - v", to: "fast"), (zero: "d - x", to: "slow", reset: {"v": "-e*v"})]),
            "fast": (rates: {"x": "v", "v": "-x - f"}, until: [(zero: "v - V", to: "slow"), (zero: "d - x", to: "slow", reset: {"v": "-e*v"})]),
        },
        sliding: {"stick": ("slow", "fast")},
    )"#;
    let system = system(text);
    let (all, halt) = switches(&system, ("slow", &[0.0, 0.0], 0.0), 20.0);
    assert!(matches!(halt, Some(Halt::Chattering { .. })), "{halt:?}");
    let stick = system.mode("stick").unwrap();
    let hits: Vec<_> = all.iter().filter(|one| one.from == stick).collect();
    assert_eq!(hits.len(), 1);
    for one in hits {
        assert_eq!(one.to, system.mode("slow").unwrap());
        assert!((one.before[0] - 0.5).abs() < 1e-14 && (one.before[1] - 0.3).abs() < 1e-15);
        assert!((one.after[1] + 0.15).abs() < 1e-15);
    }
}

/// An orbit that slides all the time on x = d, where normal speeds change with y: λ = (2 + y/2)/(4 − y/2), and
/// ẏ = −y + F cos φ + λ(0.3 − y). Its multipliers are 0 and exp ∮∂ẏ/∂y, by Runge and Kutta's method.
#[test]
fn an_orbit_that_only_slides_lies_in_its_surface() {
    let text = r#"(
        states: ["x", "y"],
        parameters: {"F": 1.0, "w": 2.0, "d": 0.2},
        forcing: "w",
        modes: {
            "L": (rates: {"x": "2 + 0.5*y", "y": "-y + F*cos(phase)"}, until: [(zero: "d - x", to: "R")]),
            "R": (rates: {"x": "-2 + y", "y": "-2*y + F*cos(phase) + 0.3"}, until: [(zero: "x - d", to: "L")]),
        },
        sliding: {"S": ("L", "R")},
    )"#;
    let (orbit, point) = settled(text, "F", ("L", &[0.0, 0.0]), 100.0).unwrap();
    assert_eq!(orbit.sequence.to_string(), "S");
    let (seen, all) = follow(&orbit, &point, true, (0.5, 1.4), 300);
    let kinds: Vec<String> = seen.iter().map(|one| one.kind.to_string()).collect();
    assert_eq!(
        kinds.iter().filter(|kind| *kind != "EP").count(),
        0,
        "{kinds:?}"
    );
    for found in [&all[0], all.last().unwrap()] {
        let at = found.orbit.at(&found.node.point).unwrap();
        let force = found.parameter;
        // state and ∫∂ẏ/∂y
        let rate = |t: f64, y: f64| {
            let share = (2.0 + 0.5 * y) / (4.0 - 0.5 * y);
            let slope = 3.0 / ((4.0 - 0.5 * y) * (4.0 - 0.5 * y));
            [
                -y + force * (2.0 * t).cos() + share * (0.3 - y),
                -1.0 + slope * (0.3 - y) - share,
            ]
        };
        let (steps, period) = (4000, TAU / 2.0);
        let h = period / f64::from(steps);
        let (mut y, mut growth) = (0.0, 0.0);
        for _ in 0..20 {
            growth = 0.0;
            for step in 0..steps {
                let t = f64::from(step) * h;
                let a = rate(t, y);
                let b = rate(t + 0.5 * h, y + 0.5 * h * a[0]);
                let c = rate(t + 0.5 * h, y + 0.5 * h * b[0]);
                let d = rate(t + h, y + h * c[0]);
                y += h / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0]);
                growth += h / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1]);
            }
        }
        // h⁴ of order 1e-13, and rounding
        let state = &at.zones[0].state;
        assert!((state[0] - 0.2).abs() < 1e-15, "{state:?}");
        assert!((state[1] - y).abs() < 1e-11, "{state:?} {y}");
        let extremes = found.orbit.extremes(&found.node.point).unwrap();
        assert!((extremes[0].0 - 0.2).abs() + (extremes[0].1 - 0.2).abs() < 1e-14);
        let tested = found.orbit.tested().unwrap();
        let examination = tested.examination(&found.node.point).unwrap();
        let own = examination.multipliers.iter().filter(|one| !one.trivial);
        let own: Vec<f64> = own.map(|one| one.value.re).collect();
        assert_eq!(own.len(), 1, "{own:?}");
        assert!(
            (own[0] - growth.exp()).abs() < 1e-11,
            "{own:?} {}",
            growth.exp()
        );
        assert_eq!(examination.multipliers.len(), 2);
        assert!(!examination.tests().is_empty());
    }
}

/// A falling law of friction, 1/(1 + δ|v − V|), written for each mode without the absolute value, with it, and with that of a
/// multiple: the first has a pole where its mode never is, the others a kink at the switch. One orbit, of the period that an
/// event-driven integration gives.
#[test]
fn expressions_are_evaluated_where_they_act() {
    let with = |below: &str, above: &str| {
        let text = format!(
            r#"(
            states: ["x", "v"],
            parameters: {{"V": 0.2, "delta": 3.0}},
            modes: {{
                "slow": (rates: {{"x": "v", "v": "1/(1 + delta*{below}) - x"}}, until: [(zero: "V - v", to: "fast")]),
                "fast": (rates: {{"x": "v", "v": "-1/(1 + delta*{above}) - x"}}, until: [(zero: "v - V", to: "slow")]),
            }},
            sliding: {{"stick": ("slow", "fast")}},
        )"#
        );
        let (orbit, point) = settled(&text, "V", ("slow", &[1.0, 0.0]), 200.0).unwrap();
        assert_eq!(orbit.zones(), 2);
        let at = orbit.at(&point).unwrap();
        at.zones.iter().map(|zone| zone.duration).sum::<f64>()
    };
    for (below, above) in [
        ("(V - v)", "(v - V)"),
        ("abs(V - v)", "abs(v - V)"),
        ("(0.5*abs(2*v - 2*V))", "abs(V - v)"),
    ] {
        let period = with(below, above);
        assert!(
            (period - 12.00103129483058).abs() < 1e-11,
            "{below}: {period}"
        );
    }
}

/// A reset and a condition that have no value within the flight: each impact takes a fixed energy.
#[test]
fn resets_and_conditions_have_values_at_their_switch_alone() {
    let text = r#"(
        states: ["x", "v"],
        parameters: {"c": 0.1, "A": 1.0, "w": 0.8, "d": 1.0, "q": 0.02},
        forcing: "w",
        modes: {"free": (
            rates: {"x": "v", "v": "A*cos(phase) - c*v - x"},
            until: [(zero: "d - x", to: "free", reset: {"v": "-sqrt(v^2 - q)"}, if: ["1/v"])],
        )},
    )"#;
    let system = system(text);
    let (all, halt) = switches(&system, ("free", &[0.0, 0.5], 0.0), 60.0);
    assert_eq!(halt, None);
    assert!(all.len() > 4);
    for one in all {
        let (before, after) = (one.before[1], one.after[1]);
        assert!((before * before - after * after - 0.02).abs() < 1e-14 && after < 0.0);
    }
}

/// Release from stick where modes are integrated: the guard is zero there with its rate, whatever rounding says. For ever,
/// and as with an exact flow.
#[test]
fn release_from_stick_of_integrated_modes() {
    let text = |cubic: &str| {
        format!(
            r#"(
            states: ["x", "v"],
            parameters: {{"F": 0.5, "w": 0.5}},
            forcing: "w",
            modes: {{
                "forth": (rates: {{"x": "v", "v": "cos(phase) - x{cubic} - F"}}, until: [(zero: "v", to: "back")]),
                "back": (rates: {{"x": "v", "v": "cos(phase) - x{cubic} + F"}}, until: [(zero: "-v", to: "forth")]),
            }},
            sliding: {{"stick": ("forth", "back")}},
        )"#
        )
    };
    let start = ("forth", &[0.0, 0.5][..], 0.0);
    let (all, halt) = switches(&system(&text(" - 0.1*x^3")), start, 2000.0);
    assert_eq!(halt, None);
    // four zones in each of 159 periods
    assert!((600..=640).contains(&all.len()), "{}", all.len());
    let exact = switches(&system(&text("")), start, 200.0).0;
    let integrated = switches(&system(&text("")).integrated(1e-15), start, 200.0).0;
    assert_eq!(exact.len(), integrated.len());
    for (one, other) in exact.iter().zip(&integrated) {
        assert_eq!((one.from, one.to), (other.from, other.to));
        assert!(
            (one.time - other.time).abs() < 1e-10,
            "{} {}",
            one.time,
            other.time
        );
    }
}

/// A relay around a process of relative degree two chatters without end; two blocks of which each sticks stick together.
#[test]
fn what_no_sliding_mode_has_is_told_in_words() {
    let relay = r#"(
        states: ["x", "y", "z", "w"],
        parameters: {"r": 0.2},
        modes: {
            "plus": (rates: {"x": "-4*x + y", "y": "-6*x + z - 1", "z": "-4*x + w + 2*r", "w": "-x - r^2"}, until: [(zero: "x", to: "minus")]),
            "minus": (rates: {"x": "-4*x + y", "y": "-6*x + z + 1", "z": "-4*x + w - 2*r", "w": "-x + r^2"}, until: [(zero: "-x", to: "plus")]),
        },
    )"#;
    let start = ("minus", &[-0.01, -0.02, -1.0, 0.5][..], 0.0);
    let (_, halt) = switches(&system(relay), start, 60.0);
    assert!(matches!(halt, Some(Halt::SecondOrder { .. })), "{halt:?}");
    let (_, halt) = switches(
        &system(TWO_MASSES),
        ("pp", &[0.0, 0.5, 0.0, 0.1], 0.0),
        200.0,
    );
    assert!(matches!(halt, Some(Halt::TwoSurfaces { .. })), "{halt:?}");
}

/// An oscillator that is stiffer on one side than on the other, with damping: it spirals to the origin, which lies on the
/// boundary of both.
#[test]
fn a_motion_spirals_into_an_equilibrium_on_a_surface() {
    let text = r#"(
        states: ["x", "v"],
        parameters: {"c": 0.4, "k": 4.0},
        modes: {
            "right": (rates: {"x": "v", "v": "-x - c*v"}, until: [(zero: "x", to: "left")]),
            "left": (rates: {"x": "v", "v": "-k*x - c*v"}, until: [(zero: "-x", to: "right")]),
        },
    )"#;
    let start = settled(text, "c", ("right", &[1.0, 0.0]), 100.0);
    assert!(matches!(start, Err(NoStart::Rests { .. })), "{start:?}");
}

/// Sliding whose normal speeds depend on a state, entered by an orbit that comes to slide for ever: the event and the multiplier are the
/// same in any units of the states, to the rounding of the integration.
#[test]
fn sliding_is_the_same_in_any_units_of_the_states() {
    const SAME: f64 = 1e-11;
    let in_units = |x: f64, y: f64| {
        let text = format!(
            r#"(
            states: ["x", "y"],
            parameters: {{"F": 8.0, "w": 2.0, "d": 0.2}},
            forcing: "w",
            define: {{"X": "{x:e}*x", "Y": "{y:e}*y"}},
            modes: {{
                "L": (rates: {{"x": "(2 + 0.5*Y)/{x:e}", "y": "(-Y + F*cos(phase))/{y:e}"}},
                    until: [(zero: "d - X", to: "R")]),
                "R": (rates: {{"x": "(-2 + Y)/{x:e}", "y": "(-2*Y + F*cos(phase) + 0.3)/{y:e}"}},
                    until: [(zero: "X - d", to: "L")]),
            }},
            sliding: {{"S": ("L", "R")}},
        )"#
        );
        let (orbit, point) = settled(&text, "F", ("L", &[0.0, 0.0]), 100.0).unwrap();
        let (seen, all) = follow(&orbit, &point, false, (2.0, 8.0), 1000);
        let events: Vec<(String, f64)> = seen
            .iter()
            .map(|one| (one.what.clone(), one.value))
            .collect();
        let last = &all[all.len() - 1];
        let multipliers = last.orbit.multipliers(&last.node.point).unwrap();
        (events, multipliers[0].value.re)
    };
    let (events, multiplier) = in_units(1.0, 1.0);
    assert_eq!(events.len(), 2, "{events:?}");
    for (x, y) in [
        (1.0, 1e-9),
        (1.0, 1e9),
        (1e-9, 1.0),
        (1e9, 1.0),
        (1e-6, 1e6),
    ] {
        let (others, other) = in_units(x, y);
        assert_eq!(events.len(), others.len(), "{x:e}, {y:e}: {others:?}");
        for ((what, value), (other, at)) in events.iter().zip(&others) {
            let off = (value / at - 1.0).abs();
            assert!(
                what == other && off <= SAME,
                "{x:e}, {y:e}: {other} {off:e}"
            );
        }
        let off = (multiplier / other - 1.0).abs();
        assert!(off <= SAME, "{x:e}, {y:e}: {multiplier} {other}");
    }
}

/// A relay on v + ax + ex², forced, and the same with V = v + ax + ex² in the place of v, where the surface is flat: the events are the same.
#[test]
fn a_curved_surface_is_one_that_is_flat_elsewhere() {
    let text = |states: &str, velocity: &str, surface: &str, rates: &str| {
        format!(
            r#"(system: (states: ["x", "{states}"], parameters: {{"c": 0.38783474954324304, "m": 0.3139856325505693,
                "A": 1.9719832395937509, "w": 0.6738139972412229, "a": 1.4822412871616704, "e": -0.38649547663361905}}, forcing: "w",
                define: {{"v": "{velocity}", "f": "A*cos(phase)-c*v-x"}},
                modes: {{"P": (rates: {{"x": "v", "{states}": "{rates}-m"}}, until: [(zero: "{surface}", to: "M")]),
                    "M": (rates: {{"x": "v", "{states}": "{rates}+m"}}, until: [(zero: "-({surface})", to: "P")])}},
                sliding: {{"S": ("P", "M")}}),
            orbit: (start: Simulate(mode: "P", state: {{"x": 0.5, "{states}": 1.0}}, settle: 100.0)),
            continuation: (parameter: "A", range: (1.9, 2.4), toward: Up), stability: ())"#
        )
    };
    let curved = text("u", "u", "u+a*x+e*x^2", "f");
    let flat = text("V", "V-a*x-e*x^2", "V", "f+(a+2*e*x)*v");
    let [curved, flat] = [curved, flat].map(|text| events(&rows(&text), "A"));
    assert_eq!(flat.len(), 3, "{flat:?}");
    assert_eq!(curved.len(), flat.len(), "{curved:?}");
    for ((kind, value, _), (other, expected, _)) in curved.iter().zip(&flat) {
        assert_eq!(kind, other);
        let off = (value - expected).abs();
        assert!(off <= 1e-11, "{kind:?} {off:e}");
    }
}

/// Prey that is harvested above y = al + be x²: a cycle that slides goes on to the edge.
#[test]
fn a_cycle_slides_in_a_curved_surface() {
    let items = rows(
        r#"(system: (states: ["x", "y"], parameters: {"b": 0.245, "d": 0.489, "h": 0.151, "al": 0.482, "be": -0.249},
            define: {"eaten": "x*y/(b+x)", "H": "y-al-be*x^2"},
            modes: {"low": (rates: {"x": "x*(1-x)-eaten", "y": "eaten-d*y"}, until: [(zero: "-H", to: "high")]),
                "high": (rates: {"x": "x*(1-x)-eaten-0.3*h*x", "y": "eaten-(d+h)*y"}, until: [(zero: "H", to: "low")])},
            sliding: {"slide": ("low", "high")}),
        orbit: (start: Simulate(mode: "low", state: {"x": 0.373, "y": 0.1}, settle: 100.0)),
        continuation: (parameter: "d", range: (0.4, 0.6), toward: Up), stability: ())"#,
    );
    assert!(events(&items, "d").is_empty());
    assert_eq!(items.last().unwrap().point.regimes, "low-slide");
    // an event-driven integration has this period at d = 0.489
    let period = items[0].point.period;
    assert!((period - 17.527_844_675_27).abs() <= 1e-10, "{period}");
}

/// Van der Pol's oscillator with a relay on x − c + ky: the fields touch the surface at y = ∓g and meet where b = −g/k, where the cycle
/// shrinks to a point in no time.
#[test]
fn a_cycle_shrinks_to_two_tangencies() {
    let items = rows(
        r#"(system: (states: ["x", "y"], parameters: {"mu": 0.49, "b": 1.4, "c": -0.45, "k": 0.33, "g": -0.41},
            define: {"H": "x-c+k*y"},
            modes: {"P": (rates: {"x": "y-g", "y": "mu*(1-x^2)*y-x-b"}, until: [(zero: "H", to: "M")]),
                "M": (rates: {"x": "y+g", "y": "mu*(1-x^2)*y-x+b"}, until: [(zero: "-H", to: "P")])},
            sliding: {"S": ("P", "M")}),
        orbit: (start: Simulate(mode: "P", state: {"x": 0.55, "y": 0.0}, settle: 100.0)),
        continuation: (parameter: "b", range: (0.1, 4.0), toward: Up), stability: ())"#,
    );
    let end = items.last().and_then(|item| item.event.as_ref()).unwrap();
    assert_eq!(end.kind, EventType::BP);
    let off = end
        .parameters
        .iter()
        .find(|(name, _)| name == "b")
        .unwrap()
        .1
        - 0.41 / 0.33;
    assert!(
        off.abs() <= end.uncertainty && end.uncertainty <= 1e-7,
        "{off:e}"
    );
}

/// x' = −x − x³ beside a forced state: once x³ is less than the smallest number the motion goes on all the same.
#[test]
fn a_state_dies_out_to_nothing() {
    let items = rows(
        r#"(system: (states: ["x", "y"], parameters: {"A": 1.0}, forcing: "1",
            modes: {"m": (rates: {"x": "-x-x^3", "y": "A*cos(phase)-y+x*y"})}),
        orbit: (start: Simulate(mode: "m", state: {"x": 0.5, "y": 0.3}, settle: 100)),
        continuation: (parameter: "A", range: (0.5, 2.0)), stability: ())"#,
    );
    assert!(items.len() > 2 && events(&items, "A").is_empty());
}

/// Two genes slide along x = t1 to the corner of both thresholds. Beyond, both fields point away from x = t1, and that of `q01` back to y = t2: the
/// motion goes on in `q11`, as that of a relay with a little hysteresis does.
#[test]
fn a_corner_is_left_by_the_mode_that_leads_away() {
    let system = system(
        r#"(states: ["x", "y"], parameters: {"t1": 0.5898282714754193, "t2": 0.6629890010629022}, modes: {
            "q00": (rates: {"x": "1.3328-x*(1+0.2*y)", "y": "0.2852-1.3*y"}, until: [(zero: "t1-x", to: "q10"), (zero: "t2-y", to: "q01")]),
            "q01": (rates: {"x": "0.0217-x*(1+0.2*y)", "y": "0.7495-1.3*y"}, until: [(zero: "t1-x", to: "q11"), (zero: "y-t2", to: "q00")]),
            "q10": (rates: {"x": "0.5481-x*(1+0.2*y)", "y": "1.6207-1.3*y"}, until: [(zero: "x-t1", to: "q00"), (zero: "t2-y", to: "q11")]),
            "q11": (rates: {"x": "1.3812-x*(1+0.2*y)", "y": "1.2029-1.3*y"}, until: [(zero: "x-t1", to: "q01"), (zero: "y-t2", to: "q10")])},
            sliding: {"sx0": ("q00", "q10"), "sx1": ("q01", "q11"), "sy0": ("q00", "q01"), "sy1": ("q10", "q11")})"#,
    );
    let (found, halt) = switches(&system, ("q00", &[0.33, 0.44], 0.0), 1.6);
    assert_eq!(halt, None);
    let names = found
        .iter()
        .map(|one| system.mode_name(one.to).into_owned());
    assert_eq!(names.collect::<Vec<_>>(), ["sx0", "q11"]);
}
