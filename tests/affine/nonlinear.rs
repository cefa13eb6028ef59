//! Systems whose rates, guards and resets are not affine: functions in closed form, and branches of orbits against
//! figures of an independent program in 38 digits.

use std::f64::consts::TAU;

use brakewave::EventType::{BP, EP, GR, PD};
use brakewave::affine::mode::Row;
use brakewave::affine::motion::{Motion, Step};
use brakewave::affine::steady::NoEquilibrium;
use brakewave::affine::system::System;
use brakewave::linalg::Vector;
use brakewave::orbit::Zones;

use crate::affine::branches::{follow, meets, settled};
use crate::affine::systems::{IMPACT, at, moved, place, system};

const PENDULUM: &str = r#"(
    states: ["x", "v"],
    parameters: {"c": 0.1, "A": 0.6, "w": 0.5, "d": 1.0, "e": 0.8},
    forcing: "w",
    modes: {"free": (
        rates: {"x": "v", "v": "A*cos(phase) - c*v - sin(x)"},
        until: [(zero: "d - x", to: "free", reset: {"v": "-e*v"})],
    )},
)"#;

const BELT: &str = r#"(
    states: ["x", "v"],
    parameters: {"ze": 0.1, "ms": 1.0, "mk": 0.5, "vs": 0.5, "mst": 1.2, "vb": 0.9},
    modes: {
        "slip": (
            rates: {"x": "v", "v": "mk + (ms - mk)*exp(-(vb - v)/vs) - 2*ze*v - x"},
            until: [(zero: "vb - v", to: "stick", if: ["mst - x - 2*ze*vb"])],
        ),
        "stick": (
            rates: {"x": "v", "v": "0"},
            until: [(zero: "mst - x - 2*ze*vb", to: "slip")],
        ),
    },
)"#;

const WALKER: &str = r#"(
    states: ["th", "thd", "ph", "phd"],
    parameters: {"g": 0.009},
    define: {"swing": "sin(th - g) + (thd^2 - cos(th - g))*sin(ph)"},
    modes: {
        "early": (
            rates: {"th": "thd", "thd": "sin(th - g)", "ph": "phd", "phd": "swing"},
            until: [(zero: "ph - 2*th", to: "late")],
        ),
        "late": (
            rates: {"th": "thd", "thd": "sin(th - g)", "ph": "phd", "phd": "swing"},
            until: [(zero: "2*th - ph", to: "early", reset: {
                "th": "-th", "thd": "cos(2*th)*thd", "ph": "-2*th", "phd": "cos(2*th)*(1 - cos(2*th))*thd",
            })],
        ),
    },
)"#;

/// t and the integral of a function of it, next to what it is.
#[test]
fn every_function_has_its_series() {
    let t = 1.3_f64;
    let root = (4.0 - t * t).sqrt();
    // u/(eᵘ − 1) = Σ Bₙuⁿ/n! with Bernoulli's numbers, of which odd ones beyond the first are zero; what is left out is less than
    // 2(t/2π)²⁴
    let bernoulli = [
        1.0,
        1.0 / 6.0,
        -1.0 / 30.0,
        1.0 / 42.0,
        -1.0 / 30.0,
        5.0 / 66.0,
        -691.0 / 2730.0,
        7.0 / 6.0,
        -3617.0 / 510.0,
        43867.0 / 798.0,
        -174611.0 / 330.0,
        854513.0 / 138.0,
    ];
    let even = (0..).step_by(2).zip(bernoulli);
    let integral: f64 = even
        .map(|(n, number)| {
            let factorial: f64 = (1..=n).map(f64::from).product();
            number * t.powi(n + 1) / (f64::from(n + 1) * factorial)
        })
        .sum();
    let terms = (1..25).scan(1.0, |term, n| {
        *term *= t / f64::from(n);
        Some(*term / f64::from(n))
    });
    let relative: f64 = terms.sum();
    // u/(1 − e⁻ᵘ) + u/(1 − eᵘ) = u
    let cases: [(&str, f64); 26] = [
        ("t/(exp(t) - 1)", integral - t * t / 4.0),
        ("t*exp(t)/(exp(t) - 1)", integral + t * t / 4.0),
        ("2*exp(t)*t/(1 - exp(t))", -2.0 * integral - t * t / 2.0),
        ("(1 - exp(t))/(2*t)", -0.5 * relative),
        (
            "(t - p)/(1 - exp(p - t)) + (t - p)/(1 - exp(t - p))",
            t * t / 2.0 - 0.3 * t,
        ),
        (
            "2*(t - 0.5)/(2 - exp(3*t - 1.5)*2) + (3*t - 1.5)/(3 - 3*exp(1.5 - 3*t))",
            t * t / 2.0 - 0.5 * t,
        ),
        ("sin(2*t)", (1.0 - (2.0 * t).cos()) / 2.0),
        ("cos(t)*sin(t)", t.sin().powi(2) / 2.0),
        ("tan(t)", -t.cos().ln()),
        ("tanh(t)", t.cosh().ln()),
        ("exp(-t)", 1.0 - (-t).exp()),
        ("ln(1 + t)", (1.0 + t) * (1.0 + t).ln() - t),
        ("sqrt(1 + t)", ((1.0 + t).powf(1.5) - 1.0) / 1.5),
        ("(1 + t)^p", ((1.0 + t).powf(1.3) - 1.0) / 1.3),
        ("t^5", t.powi(6) / 6.0),
        ("(1 + t)^-2", 1.0 - 1.0 / (1.0 + t)),
        ("1/(1 + t^2)", t.atan()),
        ("abs(t - 0.4)", (0.16 + 0.81) / 2.0),
        ("max(t, 0.4)", 0.16 + (t * t - 0.16) / 2.0),
        ("min(t, 0.4)", 0.08 + 0.4 * (t - 0.4)),
        ("max(min(t, 0.8), 1 - t)", 0.375 + 0.195 + 0.4),
        ("atan(t)", t * t.atan() - (t * t).ln_1p() / 2.0),
        ("asin(t/2)", t * (t / 2.0).asin() + root - 2.0),
        ("acos(t/2)", t * (t / 2.0).acos() - root + 2.0),
        ("sinh(t)", t.cosh() - 1.0),
        ("cosh(t)", t.sinh()),
    ];
    for (text, expected) in cases {
        let file = format!(
            r#"(states: ["t", "y"], parameters: {{"p": 0.3}},
                modes: {{"only": (rates: {{"t": "1", "y": "{text}"}})}})"#
        );
        let system = system(&file);
        let affine = at(&system, &[]);
        let mut motion = Motion::new(&affine, place(&system, "only", &[0.0, 0.0], 0.0), 10.0);
        assert_eq!(motion.step(t).unwrap(), Step::Reached);
        // tan has its pole at 1.57; a piece adds rounding of 1e-16
        let off = motion.place().state[1] - expected;
        assert!(
            off.abs() < 1e-14 * expected.abs().max(1.0),
            "{text}: {off:e}"
        );
    }
}

/// Coefficients of series have the derivatives that differences of coefficients have.
#[test]
fn every_function_has_its_derivatives() {
    const STEP: f64 = 1e-5;
    for text in [
        "sin(t)",
        "tan(t)",
        "tanh(t)",
        "exp(t)",
        "ln(t)",
        "sqrt(t)",
        "t^1.3",
        "asin(t)",
        "acos(t)",
        "atan(t)",
        "sinh(t)",
        "cosh(t)",
        "max(t, t^2)",
        "min(t, t^2)",
        "t/(exp(t) - 1)",
        "(t - 0.4)/(1 - exp(4 - 10*t))",
        "t/(exp(5*t) - 1)",
        "(t - 0.4)*exp(t)/(1 - exp(4 - 10*t))",
        "(exp(3*t - 1.2) - 1)/(t - 0.4)",
    ] {
        let file = format!(
            r#"(states: ["t", "y"], modes: {{"only": (rates: {{"t": "1 + 0.5*t", "y": "{text}"}})}})"#
        );
        let system = at(&system(&file), &[]);
        let series = |t: f64| {
            let z = system.lift(0, &[t, 0.0], 0.0);
            system.modes[0].field.series(&z, 6, true, true)
        };
        let [below, here, above] = [-STEP, 0.0, STEP].map(|step| series(0.4 + step));
        let mut row = Row {
            at: Vector::zeros(system.size()),
            by: [Vector::zeros(system.size()), Vector::zeros(system.size())],
        };
        row.at[1] = 1.0;
        for k in 1..=6 {
            let (_, gradient, _) = here.jet(&row, k);
            let difference = (above.value(k, 1) - below.value(k, 1)) / (2.0 * STEP);
            // central: an error of STEP²/6 times a third derivative, which grows like k³, and of rounding
            let off = (gradient[0] - difference).abs();
            assert!(
                off <= 1e-6 * difference.abs().max(1.0),
                "{text}, {k}: {off:e}"
            );
        }
    }
}

/// The phase inside a function of the state, of which the derivative is known: d/dt sin(x + φ) = 0 where ẋ = −ω.
#[test]
fn the_phase_may_stand_beside_states() {
    let system = system(
        r#"(states: ["x", "y"], parameters: {"w": 2.0}, forcing: "w",
            modes: {"only": (rates: {"x": "-w", "y": "cos(x + phase) + sin(2*phase - x)"})})"#,
    );
    let affine = at(&system, &[]);
    let mut motion = Motion::new(&affine, place(&system, "only", &[0.5, 0.0], 0.25), 10.0);
    motion.step(3.0).unwrap();
    // 2φ − x = 0 + 6t: the first term is constant
    let expected = 3.0 * 0.75_f64.cos() + (1.0 - (18.0_f64).cos()) / 6.0;
    assert!((motion.place().state[1] - expected).abs() < 1e-13);
}

/// A step leaves out its tolerance of each component and a time of 40 has less than a hundred of them, in which the
/// oscillator and its impacts contract.
#[test]
fn an_integrated_flow_comes_to_the_exact_one() {
    let ends = |system: &System| {
        let affine = at(system, &[]);
        let mut motion = Motion::new(&affine, place(system, "free", &[0.5, 0.25], 0.3), 10.0);
        let mut switches = 0;
        while let Step::Switched(_) = motion.step(40.0).unwrap() {
            switches += 1;
        }
        (switches, motion.place().state.clone())
    };
    let system = system(IMPACT);
    let (switches, exact) = ends(&system);
    assert!(switches > 2);
    let tolerances = [1e-5, 1e-8, 1e-11, 1e-15];
    let errors = tolerances.map(|tolerance| {
        let (also, state) = ends(&system.clone().integrated(tolerance));
        assert_eq!(also, switches);
        let off = state.iter().zip(&exact).map(|(one, other)| one - other);
        off.fold(0.0_f64, |most, off| most.max(off.abs()))
    });
    for (error, tolerance) in errors.iter().zip(tolerances) {
        assert!(*error < 100.0 * tolerance, "{errors:?}");
    }
    assert!(errors[0] > errors[1] && errors[1] > errors[2], "{errors:?}");
}

/// A motion over a bump of its potential that is nothing but for a small part of it, or against a spring that is touched: the energy
/// v²/2 + x²/2 + U(x) stays what it is, to the tolerance of some hundreds of steps.
#[test]
fn what_a_step_begins_without_is_not_stepped_over() {
    type Potential = fn(f64) -> f64;
    let cases: [(&str, Potential); 6] = [
        ("40*x*exp(-100*x^2)", |x| 0.2 * (-100.0 * x * x).exp()),
        ("160*x*exp(-400*x^2)", |x| 0.2 * (-400.0 * x * x).exp()),
        ("2000*x*exp(-5000*x^2)", |x| 0.2 * (-5000.0 * x * x).exp()),
        // far below all numbers where it begins
        ("0.2*80*(x/0.9)^79/0.9", |x| -0.2 * (x / 0.9).powi(80)),
        ("-20*max(0, x - 0.5)^1.5", |x| {
            8.0 * (x - 0.5).max(0.0).powf(2.5)
        }),
        ("-20*max(0, x - 0.5)^2.25", |x| {
            80.0 / 13.0 * (x - 0.5).max(0.0).powf(3.25)
        }),
    ];
    for (force, potential) in cases {
        let text = format!(
            r#"(states: ["x", "v"], modes: {{"free": (rates: {{"x": "v", "v": "-x + {force}"}})}})"#
        );
        let energy = |x: f64, v: f64| 0.5 * (v * v + x * x) + potential(x);
        let (_, state) = moved(&text, "free", &[-0.3, 0.7], 30.0).unwrap();
        let off = energy(state[0], state[1]) - energy(-0.3, 0.7);
        assert!(off.abs() < 1e-12, "{force}: {off:e}");
    }
}

/// tanh kv is 1 − 2/(1 + exp 2kv), of which the exponential is never as good as nothing: the same motions with steep friction by either.
/// Between them they contract, so that errors of steps do not add up.
#[test]
fn a_saturated_function_comes_back() {
    // from 320 on the exponential overflows
    for slope in [5.0, 20.0, 100.0, 400.0, 3000.0] {
        let ends = |law: String| {
            let text = format!(
                r#"(states: ["x", "v"], forcing: "0.8", modes: {{"free": (rates: {{"x": "v", "v": "cos(phase) - x - 0.1*v - 0.3*({law})"}})}})"#
            );
            moved(&text, "free", &[0.0, 0.0], 30.0).unwrap().1
        };
        let one = ends(format!("tanh({slope:?}*v)"));
        let twice = 2.0 * slope;
        for law in [
            format!("1 - 2/(1 + exp({twice:?}*v))"),
            format!("(1 - exp(-{twice:?}*v))/(exp(-{twice:?}*v) + 1)"),
            format!("2*exp({twice:?}*v)/(1 + exp({twice:?}*v)) - 1"),
        ] {
            for (one, other) in one.iter().zip(&ends(law)) {
                assert!((one - other).abs() < 1e-11, "{slope}: {one} {other}");
            }
        }
    }
}

/// A tank that empties as h = (1 − 0.35t)² touches zero, where the root in its rate comes to zero, and is filled again; one that begins
/// to be filled while it empties has −(2/a)(u + (q/a) ln(1 − au/q)) = t with u = √h.
#[test]
fn a_tank_is_empty_in_finite_time() {
    let text = r#"(states: ["h"], modes: {
        "drain": (rates: {"h": "-0.7*sqrt(h)"}, until: [(zero: "h", to: "empty", reset: {"h": "0"})]),
        "empty": (rates: {"h": "1"}, until: [(zero: "1 - h", to: "drain")])})"#;
    let times = 1.0 / 0.35 + 1.0;
    for power in ["sqrt(h)", "h^0.5"] {
        let (modes, state) = moved(&text.replace("sqrt(h)", power), "drain", &[1.0], 9.0).unwrap();
        assert_eq!(modes, ["empty", "drain", "empty", "drain"]);
        let height = f64::powi(1.0 - 0.35 * (9.0 - 2.0 * times), 2);
        assert!((state[0] - height).abs() < 1e-14, "{} {height}", state[0]);
    }
    let filled = r#"(states: ["h"], modes: {"fill": (rates: {"h": "1 - 0.7*sqrt(h)"})})"#;
    let (_, state) = moved(filled, "fill", &[0.0], 2.0).unwrap();
    let root = state[0].sqrt();
    let time = -(2.0 / 0.7) * (root + (1.0 - 0.7 * root).ln() / 0.7);
    assert!((time - 2.0).abs() < 1e-13, "{time}");
}

/// A zero times what is positive is the same switch, also where that changes in the reset: the same doubling and the same graze.
#[test]
fn a_switch_is_where_its_zero_is() {
    let events = |zero: &str| {
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"A": 1.0}}, forcing: "0.8", modes: {{"f": (
                rates: {{"x": "v", "v": "A*cos(phase) - 0.1*v - x"}}, until: [(zero: "{zero}", to: "f", reset: {{"v": "-0.8*v"}})])}})"#
        );
        let (orbit, point) = settled(&text, &[], "A", "f", &[0.0, 0.0], 200.0);
        let (seen, _) = follow(&orbit, &point, false, (0.36, 1.0), 500);
        let first: Vec<_> = seen
            .iter()
            .take(2)
            .map(|one| (one.kind, one.value))
            .collect();
        first
    };
    let plain = events("1 - x");
    assert_eq!(plain.iter().map(|one| one.0).collect::<Vec<_>>(), [PD, GR]);
    for zero in ["(1 - x)*(1 + v^2)", "(1 - x)/(1 + v^2)", "(1 - x)*exp(v)"] {
        for (one, other) in events(zero).iter().zip(&plain) {
            assert_eq!(one.0, other.0, "{zero}");
            assert!(
                (one.1 - other.1).abs() < 1e-12,
                "{zero}: {} {}",
                one.1,
                other.1
            );
        }
    }
}

/// The kink of |sin 2x| at x = −π/2 is not where a double is: its sine is not zero to rounding there. By Runge's method of order 8 to 7 digits.
#[test]
fn a_kink_of_a_sine_is_passed() {
    let text = r#"(states: ["x", "v"], forcing: "0.8",
        modes: {"f": (rates: {"x": "v", "v": "-0.1*v - x + cos(phase) - abs(sin(2*x))"})})"#;
    let (_, state) = moved(text, "f", &[0.3, 0.0], 30.0).unwrap();
    for (one, other) in state.iter().zip([0.4063902, 1.3100006]) {
        assert!((one - other).abs() < 1e-7, "{one} {other}");
    }
}

/// A contact whose friction has a narrow peak at v = 0 (Stribeck): by an independent program with steps of 3e-3 at most, to 8 digits.
#[test]
fn a_narrow_peak_of_friction_is_met() {
    let text = r#"(states: ["x", "v"], forcing: "0.8",
        contacts: {"q": Friction(slip: "v", bound: "0.3*(1 + exp(-(v/0.03)^2))")},
        rates: {"x": "v", "v": "-x - 0.1*v + cos(phase) + q"})"#;
    let (_, state) = moved(text, "stick", &[0.0, 0.0], 30.0).unwrap();
    for (one, other) in state.iter().zip([-0.35230694, 1.81667406]) {
        assert!((one - other).abs() < 1e-8, "{one} {other}");
    }
}

/// A spring whose force is the power 3/2 of its compression: the period doubles at the force which an integration with steps to the
/// instants of touch, and its derivatives, have as 0.34592102916552. A mode of its own for the touch has the same motion.
#[test]
fn a_contact_of_hertz() {
    let head = r#"(states: ["x", "v"], parameters: {"A": 0.38}, forcing: "0.8", modes: "#;
    let whole = r#"{"free": (rates: {"x": "v", "v": "-0.1*v - x - 20*max(0, x - 0.5)^1.5 + A*cos(phase)"})})"#;
    let parted = r#"{"free": (rates: {"x": "v", "v": "-0.1*v - x + A*cos(phase)"}, until: [(zero: "0.5 - x", to: "touch")]),
        "touch": (rates: {"x": "v", "v": "-0.1*v - x - 20*(x - 0.5)^1.5 + A*cos(phase)"}, until: [(zero: "x - 0.5", to: "free")])})"#;
    let [whole, parted] = [whole, parted].map(|modes| format!("{head}{modes}"));
    let ends = [&whole, &parted].map(|text| moved(text, "free", &[0.0, 0.0], 60.0).unwrap().1);
    for (one, other) in ends[0].iter().zip(&ends[1]) {
        assert!((one - other).abs() < 1e-11, "{one} {other}");
    }
    let (orbit, point) = settled(&whole, &[], "A", "free", &[0.0, 0.0], 100.0);
    let (seen, _) = follow(&orbit, &point, false, (0.34, 0.38), 500);
    let doubles = seen.iter().find(|one| one.kind == PD).unwrap();
    assert!(
        (doubles.value - 0.34592102916552).abs() < 1e-12,
        "{}",
        doubles.value
    );
}

/// The touch of such a spring in a mode of its own begins and ends as a graze of the motion without it, at A = d|1 − w² + icw|.
#[test]
fn a_contact_of_hertz_is_grazed_from_both_sides() {
    let graze = 0.5 * f64::hypot(1.0 - 0.64, 0.2 * 0.8);
    for force in ["(x - 0.5)", "max(0, x - 0.5)"] {
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"A": 0.2}}, forcing: "0.8", modes: {{
            "free": (rates: {{"x": "v", "v": "A*cos(phase) - x - 0.2*v"}}, until: [(zero: "0.5 - x", to: "touch")]),
            "touch": (rates: {{"x": "v", "v": "A*cos(phase) - x - 0.2*v - 3*{force}^1.5"}},
                until: [(zero: "x - 0.5", to: "free")])}})"#
        );
        for (start, up, after) in [
            (0.15, true, "free > free-touch"),
            (0.21, false, "touch-free > free"),
        ] {
            let values = [("A", start)];
            let (orbit, point) = settled(&text, &values, "A", "free", &[0.1, 0.0], 60.0);
            let (seen, _) = follow(&orbit, &point, up, (0.1, 0.22), 500);
            let edge = if up { 0.22 } else { 0.1 };
            meets(&seen, &[(GR, graze, after), (EP, edge, "")], 1e-12);
        }
    }
}

#[test]
fn a_pendulum_at_a_wall_grazes_inside() {
    let (orbit, point) = settled(
        PENDULUM,
        &[("w", 0.7), ("A", 0.637301088456668717)],
        "A",
        "free",
        &[0.0, 0.0],
        100.0,
    );
    let (seen, _) = follow(&orbit, &point, false, (0.2, 1.4), 500);
    let expected = [
        (PD, 0.489045417196253371, "free"),
        (GR, 0.399375023774311944, "free > free"),
        (EP, 0.2, "free"),
    ];
    meets(&seen, &expected, 1e-12);
}

/// Errors of events tell what steps of a coarser tolerance leave out.
#[test]
fn errors_of_events_know_of_the_tolerance() {
    let coarse = PENDULUM.replacen("states:", "flow_tolerance: 1e-8, states:", 1);
    let values = [("w", 0.7), ("A", 0.52)];
    let (orbit, point) = settled(&coarse, &values, "A", "free", &[0.0, 0.0], 100.0);
    let (_, all) = follow(&orbit, &point, false, (0.4885, 1.4), 50);
    let doubling = all.iter().find(|one| one.kind() == Some(PD)).unwrap();
    let off = (doubling.parameter - 0.489045417196253371).abs();
    let told = doubling.known_to();
    assert!(
        off > 1e-14 && off <= told && told < 1e-5,
        "{off:e}, {told:e}"
    );
}

#[test]
fn a_belt_with_falling_friction_lets_go() {
    let (orbit, point) = settled(BELT, &[], "vb", "slip", &[1.6, 0.0], 100.0);
    let (seen, _) = follow(&orbit, &point, true, (0.3, 1.2), 500);
    let end = 1.09190200570966893;
    meets(&seen, &[(GR, end, "")], 1e-12);
}

/// Without stick left over, the cycle goes on as an unstable one that does not stick, down to the Hopf point of the
/// equilibrium: vb = vs ln((ms − mk)/(2 ze vs)), with the frequency 1.
#[test]
fn a_cycle_shrinks_to_its_hopf_point() {
    let values = [("mst", 1.0), ("vb", 1.0)];
    let (orbit, point) = settled(BELT, &values, "vb", "slip", &[1.6, 0.0], 100.0);
    let (seen, all) = follow(&orbit, &point, true, (0.3, 1.2), 500);
    let hopf = 0.5 * 5.0_f64.ln();
    meets(
        &seen,
        &[(GR, 1.06272678404880064, ""), (BP, hopf, "")],
        1e-12,
    );
    let last = all.last().unwrap();
    let what = last.special.as_ref().unwrap().to_string();
    assert!(what.contains("Hopf"), "{what}");
    let off = (last.parameter - hopf).abs();
    assert!(off < 1e-13 && off <= last.known_to(), "{off:e}");
    let period = last.orbit.cycle(&last.node.point).unwrap().period;
    assert!((period - TAU).abs() < 1e-12, "{period}");
}

#[test]
fn the_walker_doubles() {
    let start = [0.2003109, -0.1998325, 0.4006218, -0.0158];
    let (orbit, point) = settled(WALKER, &[], "g", "early", &start, 40.0);
    let multipliers = orbit.multipliers(&point).unwrap();
    let (re, im) = (-0.190099841065888, 0.557598776682068);
    let own = multipliers.iter().filter(|one| !one.trivial);
    for one in own {
        // figures of 15 digits
        let off = (one.value.re - re).hypot(one.value.im.abs() - im);
        assert!(off < 1e-12, "{}", one.value);
    }
    let (seen, _) = follow(&orbit, &point, true, (0.001, 0.019), 500);
    let expected = [
        (PD, 0.0150884379411194636, "early-late"),
        (EP, 0.019, "early-late"),
    ];
    meets(&seen, &expected, 1e-12);
}

/// x = √(1 − 2at) has no value after t = 1/(2a): a guess beyond it is told to be none, however many pieces would fit in.
#[test]
fn a_guess_beyond_a_singular_time_ends() {
    let root = r#"(
        states: ["x"],
        parameters: {"a": 1.0},
        modes: {"down": (rates: {"x": "-a/x"}, until: [(zero: "x - 0.5", to: "down", reset: {"x": "1"})])},
    )"#;
    let (orbit, mut point) = settled(root, &[], "a", "down", &[0.9], 3.0);
    let index = orbit.duration_index(0);
    let period = orbit.cycle(&point).unwrap().period;
    assert!((period - 0.375).abs() < 1e-15, "{period}");
    point[index] *= 4.0;
    assert!(orbit.examination(&point).is_err());
}

/// x(1 − x) has two equilibria, cos x those of every half turn.
#[test]
fn all_equilibria_are_found() {
    let found = |rate: &str| {
        let file = format!(r#"(states: ["x"], modes: {{"only": (rates: {{"x": "{rate}"}})}})"#);
        at(&system(&file), &[]).equilibria(0)
    };
    let places = |rate: &str| -> Vec<f64> {
        let all = found(rate).unwrap();
        all.iter().map(|one| one.state[0]).collect()
    };
    assert_eq!(places("x*(1 - x)"), [0.0, 1.0]);
    let turns = places("cos(x)");
    assert_eq!(turns.len(), 6);
    for (index, x) in turns.iter().enumerate() {
        assert!((x - (index as f64 - 2.5) * TAU / 2.0).abs() < 1e-14);
    }
    assert_eq!(found("1 + x^2"), Err(NoEquilibrium::NotFound));
}

/// Where a relay with hysteresis only just switches, the equations are even in the speed at the switch: their
/// parameter is stationary there, which is no fold. Where the graze lies was computed with
/// half orbits of an independent integration (DOP853), whose k(v) − k(0) is 0.209·v².
#[test]
fn a_relay_that_only_just_switches_ends_without_a_fold() {
    let text = r#"(
        states: ["x", "v"],
        parameters: {"c": 0.2, "de": 0.8, "k": 0.4},
        modes: {
            "plus": (rates: {"x": "v", "v": "k - c*v - sin(x)"}, until: [(zero: "de - x", to: "minus")]),
            "minus": (rates: {"x": "v", "v": "-k - c*v - sin(x)"}, until: [(zero: "x + de", to: "plus")]),
        },
    )"#;
    let (orbit, point) = settled(text, &[], "k", "plus", &[-0.8, 1.5], 300.0);
    let (seen, all) = follow(&orbit, &point, false, (0.02, 0.5), 2000);
    let kinds: Vec<_> = seen.iter().map(|one| one.kind).collect();
    assert_eq!(kinds, [GR]);
    let last = all.last().unwrap();
    assert!(
        (last.parameter - 0.121068221830).abs() < 1e-11,
        "{}",
        last.parameter
    );
}
