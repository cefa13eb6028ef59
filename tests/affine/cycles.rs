//! Cycles that neither switch nor are forced, against closed forms and figures of an independent program in 50 digits.

use std::f64::consts::{PI, TAU};

use brakewave::EventType;
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::start::{Beginning, NoStart, Search, Wanted, first};
use brakewave::linalg::Vector;

use crate::affine::branches::{follow, meets};
use crate::affine::systems::{in_order, system};
use EventType::{BP, EP, GR, NS, PD};

const VAN_DER_POL: &str = r#"(states: ["x", "v"], parameters: {"mu": 1.0}, modes: {"flow": (
    rates: {"x": "v", "v": "mu*(1 - x^2)*v - x"})})"#;

fn started(
    text: &str,
    (parameter, range): (&str, (f64, f64)),
    state: &[f64],
    search: Search,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let wanted = Wanted::new(system(text), parameter, range).unwrap();
    let beginning = Beginning {
        mode: 0,
        state: state.to_vec(),
        phase: 0.0,
    };
    first(&wanted, &beginning, search)
}

fn period(orbit: &AffineOrbit, point: &Vector) -> f64 {
    orbit.cycle(point).unwrap().period
}

/// At mu = 0 every circle is an orbit of van der Pol's oscillator, and so is the equilibrium: the branch of its cycle comes to the one of
/// radius 2, with the period 2 pi.
#[test]
fn the_edge_of_a_range_lies_on_the_branch() {
    let range = (0.0, 20.0);
    let (orbit, point) = started(
        VAN_DER_POL,
        ("mu", range),
        &[1.0, 0.0],
        Search::Settles(100.0),
    )
    .unwrap();
    let (_, all) = follow(&orbit, &point, false, range, 1000);
    let last = all.last().unwrap();
    assert_eq!(last.parameter, 0.0);
    let there = last.orbit.cycle(&last.node.point).unwrap();
    assert!((there.period - TAU).abs() < 1e-12, "{}", there.period);
    let (low, high) = last.orbit.extremes(&last.node.point).unwrap()[0];
    assert!((high - 2.0).abs() < 1e-10 && (low + 2.0).abs() < 1e-10);
}

/// A motion that settles, a guess, a guess that goes round twice, and one so far off that Newton's method fails.
#[test]
fn a_cycle_is_found_from_wherever() {
    const T: f64 = 6.663_286_859_323_130_189_7;
    let starts = [
        (vec![1.0, 0.0], Search::Settles(60.0)),
        (vec![2.0, 0.0], Search::Guess(6.66)),
        (vec![2.0, 0.0], Search::Guess(13.3)),
        (vec![0.1, 0.0], Search::Guess(3.0)),
    ];
    for (state, search) in starts {
        let (orbit, point) = started(VAN_DER_POL, ("mu", (0.5, 10.0)), &state, search).unwrap();
        let off = period(&orbit, &point) / T - 1.0;
        assert!(off.abs() <= 1e-14, "{search:?}: {off:e}");
        let multipliers = orbit.multipliers(&point).unwrap();
        assert!(multipliers[0].trivial && multipliers[0].value.re == 1.0);
        let off = multipliers[1].value.re - 8.596_950_636_038_1e-4;
        assert!(off.abs() <= multipliers[1].error, "{off:e}");
    }
}

/// An equilibrium is no orbit, and a motion that comes to one has none.
/// The unit of time makes no difference, nor does it to how long is waited for a switch that no mode has.
#[test]
fn a_cycle_is_found_in_any_unit_of_time() {
    let slow = started(
        VAN_DER_POL,
        ("mu", (0.5, 2.0)),
        &[1.0, 0.0],
        Search::Settles(60.0),
    );
    let (orbit, point) = slow.unwrap();
    let expected = period(&orbit, &point);
    for unit in [1e2, 1e4] {
        let text = VAN_DER_POL.replace(
            "\"v\": \"mu*(1 - x^2)*v - x\"",
            &format!("\"v\": \"{unit:?}*(mu*(1 - x^2)*v - x)\""),
        );
        let text = text.replace("\"x\": \"v\"", &format!("\"x\": \"{unit:?}*v\""));
        let fast = started(
            &text,
            ("mu", (0.5, 2.0)),
            &[1.0, 0.0],
            Search::Settles(60.0 / unit),
        );
        let (orbit, point) = fast.unwrap_or_else(|reason| panic!("{unit:e}: {reason}"));
        let off = period(&orbit, &point) * unit / expected - 1.0;
        assert!(off.abs() <= 1e-12, "{unit:e}: {off:e}");
    }
}

#[test]
fn an_equilibrium_is_no_cycle() {
    let text = r#"(states: ["x", "v"], parameters: {"k": 1.0}, modes: {"flow": (
        rates: {"x": "v", "v": "-k*x - v - x^3"})})"#;
    for search in [Search::Settles(200.0), Search::Guess(6.0)] {
        let reason = started(text, ("k", (0.5, 2.0)), &[0.1, 0.0], search).unwrap_err();
        let told = matches!(
            reason,
            NoStart::Rests { .. } | NoStart::Equilibrium | NoStart::Newton(_) | NoStart::Family(_)
        );
        assert!(told, "{search:?}: {reason}");
    }
    // a guess that rests is told from a family of orbits
    let rests = started(
        VAN_DER_POL,
        ("mu", (0.5, 10.0)),
        &[0.0; 2],
        Search::Guess(6.3),
    );
    assert!(matches!(rests, Err(NoStart::Equilibrium)));
}

/// Hodgkin and Huxley's axon, whose rates are 0/0 at -55 and -40 mV, in millivolts and in units of .1 V above -65 mV: the period as an
/// integration by DOP853 has it to 1e-12, and the same multipliers, each within its error.
#[test]
fn a_nerve_passes_where_its_rates_are_zero_over_zero() {
    let file = |v: &str, unit: &str, channels: [&str; 2]| {
        format!(
            r#"(states: ["V", "m", "h", "n"], parameters: {{"I": 15.0}}, define: {{
                "am": "{}", "bm": "4*exp(-({v} + 65)/18)", "ah": "0.07*exp(-({v} + 65)/20)",
                "bh": "1/(1 + exp(-({v} + 35)/10))", "an": "{}", "bn": "0.125*exp(-({v} + 65)/80)"}},
                modes: {{"flow": (rates: {{
                    "V": "(I - 120*m^3*h*({v} - 50) - 36*n^4*({v} + 77) - 0.3*({v} + 54.4))/{unit}",
                    "m": "am*(1 - m) - bm*m", "h": "ah*(1 - h) - bh*h", "n": "an*(1 - n) - bn*n"}})}})"#,
            channels[0], channels[1]
        )
    };
    let as_today = file(
        "V",
        "1",
        [
            "0.1*(V + 40)/(1 - exp(-(V + 40)/10))",
            "0.01*(V + 55)/(1 - exp(-(V + 55)/10))",
        ],
    );
    let as_then = file(
        "(100*V - 65)",
        "100",
        [
            "(2.5 - 10*V)/(exp(2.5 - 10*V) - 1)",
            "0.1*(1 - 10*V)/(exp(1 - 10*V) - 1)",
        ],
    );
    let found = [(as_today, -65.0), (as_then, 0.0)].map(|(text, rest)| {
        let state = [rest, 0.05, 0.6, 0.3];
        let (orbit, point) =
            started(&text, ("I", (10.0, 20.0)), &state, Search::Settles(200.0)).unwrap();
        let off = period(&orbit, &point) - 12.715_800_877_092;
        assert!(off.abs() <= 2e-12, "{off:e}");
        orbit.multipliers(&point).unwrap()
    });
    for (one, other) in found[0].iter().zip(&found[1]) {
        let off = (one.value - other.value).norm();
        assert!(off <= one.error + other.error, "{off:e}");
    }
}

/// The Brusselator: the cycle shrinks to its equilibrium at B = 1 + A².
#[test]
fn a_cycle_shrinks_at_its_hopf_point() {
    let text = r#"(states: ["x", "y"], parameters: {"A": 1.0, "B": 2.5}, modes: {"flow": (
        rates: {"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"})})"#;
    let (orbit, point) =
        started(text, ("B", (1.9, 3.0)), &[1.5, 2.0], Search::Settles(60.0)).unwrap();
    let off = period(&orbit, &point) / 6.577_284_341_905_833_303_4 - 1.0;
    assert!(off.abs() <= 1e-14, "{off:e}");
    let (seen, all) = follow(&orbit, &point, false, (1.9, 3.0), 500);
    meets(&seen[..1], &[(BP, 2.0, "")], 1e-14);
    let last = all.last().unwrap();
    let off = period(&last.orbit, &last.node.point) - TAU;
    assert!(off.abs() <= 1e-13, "{off:e}");
}

/// Roessler's band doubles.
#[test]
fn a_cycle_doubles() {
    let text = r#"(states: ["x", "y", "z"], parameters: {"a": 0.2, "b": 0.2, "c": 2.7}, modes: {"flow": (
        rates: {"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"})})"#;
    let start = started(
        text,
        ("c", (2.5, 4.0)),
        &[1.0, 1.0, 0.0],
        Search::Settles(200.0),
    );
    let (orbit, point) = start.unwrap();
    let (seen, _) = follow(&orbit, &point, true, (2.5, 3.0), 200);
    let expected = [(PD, 2.832_445_027_862_538_913_7, "flow"), (EP, 3.0, "flow")];
    meets(&seen, &expected, 1e-13);
}

/// The doubled cycles come back to the single one where they were born: a doubling, which says that the orbit has become one of half
/// its period, and the end, not the single cycle traversed twice.
#[test]
fn doubled_cycles_end_where_they_are_born() {
    let roessler = r#"(states: ["x", "y", "z"], parameters: {"a": 0.2, "b": 0.2, "c": 3.3}, modes: {"flow": (
        rates: {"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"})})"#;
    let lorenz = r#"(states: ["x", "y", "z"], parameters: {"r": 227.0, "s": 10.0, "b": 2.6666666666666665}, modes: {"flow": (
        rates: {"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"})})"#;
    for (text, parameter, range, state, up, place, known) in [
        (
            roessler,
            "c",
            (2.5, 4.0),
            [1.0, 1.0, 0.0],
            false,
            2.832_445_027_862_538_9,
            1e-12,
        ),
        (
            lorenz,
            "r",
            (200.0, 345.0),
            [10.0, 10.0, 200.0],
            true,
            229.406_708_561_44,
            1e-10,
        ),
    ] {
        let start = started(text, (parameter, range), &state, Search::Settles(400.0));
        let (orbit, point) = start.unwrap();
        let (seen, all) = follow(&orbit, &point, up, range, 400);
        let kinds: Vec<EventType> = seen.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [PD]);
        assert!(
            (seen[0].value / place - 1.0).abs() <= known,
            "{:e}",
            seen[0].value - place
        );
        let what = all.last().unwrap().special.as_ref().unwrap().to_string();
        assert!(
            what.contains("1/2 of its period, traversed 2 times"),
            "{what}"
        );
    }
}

/// Langford's field without its last term: a circle at z = b, on which z stands still, whatever the order of the states.
#[test]
fn a_state_may_stand_still_on_a_cycle() {
    let rates = [
        ("x", "(z - b)*x - d*y"),
        ("y", "d*x + (z - b)*y"),
        ("z", "c + a*z - z^3/3 - (x^2 + y^2)*(1 + e*z)"),
    ];
    let values = [("x", 0.84), ("y", 0.0), ("z", 0.7)];
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
        let states = order
            .map(|index| format!("\"{}\"", rates[index].0))
            .join(", ");
        let rates = order.map(|index| format!("\"{}\": \"{}\"", rates[index].0, rates[index].1));
        let text = format!(
            r#"(states: [{states}], parameters: {{"a": 0.5, "b": 0.7, "c": 0.6, "d": 3.5, "e": 0.25}},
            modes: {{"flow": (rates: {{{}}})}})"#,
            rates.join(", ")
        );
        let state = order.map(|index| values[index].1);
        let start = started(&text, ("a", (0.3, 0.9)), &state, Search::Guess(1.8));
        let (orbit, point) = start.unwrap();
        let (seen, all) = follow(&orbit, &point, true, (0.3, 0.9), 300);
        // a = b²(1 + eb) + e(c − b³/3)
        let value = 0.49 * 1.175 + 0.25 * (0.6 - 0.343 / 3.0);
        meets(&seen, &[(NS, value, "flow"), (EP, 0.9, "flow")], 1e-13);
        for found in &all {
            let off = period(&found.orbit, &found.node.point) * 3.5 / TAU - 1.0;
            assert!(off.abs() <= 1e-14, "{off:e}");
        }
    }
}

/// The circle of radius √μ comes to touch a line at the distance 3/2, wherever that is seen from its beginning, and
/// switches from there on; coming back it does so no more at the same place.
#[test]
fn a_cycle_that_touches_a_guard_switches_from_there_on() {
    for angle in [0.0, 0.3, 0.5 * PI, 2.0, PI, -0.5 * PI] {
        let (sine, cosine) = f64::sin_cos(angle);
        let line = format!("1.5 - ({cosine:?})*x - ({sine:?})*y");
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"mu": 1.0}}, define: {{"r": "mu - x^2 - y^2", "g": "{line}"}}, modes: {{
                "free": (rates: {{"x": "x*r - y", "y": "x + y*r"}}, until: [(zero: "g", to: "held")]),
                "held": (rates: {{"x": "x*r - y + ({cosine:?})*g", "y": "x + y*r + ({sine:?})*g"}}, until: [(zero: "-g", to: "free")]),
            }})"#
        );
        let range = ("mu", (0.5, 3.0));
        let (orbit, point) = started(&text, range, &[0.5, 0.1], Search::Settles(40.0)).unwrap();
        let (up, all) = follow(&orbit, &point, true, range.1, 300);
        meets(&up, &[(GR, 2.25, ""), (EP, 3.0, "")], 1e-13);
        let last = all.last().unwrap();
        assert_eq!(last.orbit.sequence.switches(), 2);
        let (down, all) = follow(&last.orbit, &last.node.point, false, range.1, 300);
        meets(&down[..1], &[(GR, 2.25, "")], 1e-13);
        assert_eq!(all.last().unwrap().orbit.sequence.switches(), 0);
    }
}

/// The circle y² + z² = mu, with a third state X = 0.3y² + 0.2z along it that is greatest at one place or at two: that at which
/// X is greatest becomes flat and vanishes at mu = 1/9, where the cycle does not change at all. In every order of the states.
#[test]
fn a_maximum_that_vanishes_is_no_event() {
    let rates = [
        ("X", "0.3*y^2 + 0.2*z - X + 0.6*y*f + 0.2*g"),
        ("y", "f"),
        ("z", "g"),
    ];
    for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
        let text = in_order(
            &rates,
            &order,
            r#"parameters: {"mu": 1.0}, define: {"f": "mu*y - z - y*(y^2 + z^2)", "g": "y + mu*z - z*(y^2 + z^2)"}"#,
        );
        let begin = order.map(|index| [0.0, 0.9, 0.0][index]);
        let range = (0.02, 2.0);
        let (orbit, point) = started(&text, ("mu", range), &begin, Search::Settles(60.0)).unwrap();
        let (seen, all) = follow(&orbit, &point, false, range, 1000);
        meets(&seen, &[(EP, 0.02, "")], 0.0);
        let last = all.last().unwrap();
        let multipliers = last.orbit.multipliers(&last.node.point).unwrap();
        for (found, expected) in multipliers[1..].iter().zip([-4.0 * PI * 0.02, -TAU]) {
            let off = (found.value.re - expected.exp()).abs();
            assert!(off <= found.error, "{order:?}: {off:e}");
        }
    }
}

/// A unit circle with what is across it turned by half a turn a period: multipliers −exp(2π(a ± √(b² − W²/4))/W), of which one is −1 at
/// a = ∓√(b² − W²/4). The third state is zero all along: the unit that it has in the file is that of its action alone.
#[test]
fn a_state_that_stays_zero_may_have_any_unit() {
    for unit in [1.0, 1e-6, 1e3, 1e6] {
        let text = format!(
            r#"(states: ["x", "y", "z"], parameters: {{"a": -2.5, "b": 2.2, "W": 3.1}},
                modes: {{"flow": (rates: {{"x": "across*C - W*y", "y": "across*S + W*x", "z": "{unit:?}*(a*Z + b*(S*p - C*Z) - q*Z)"}})}},
                define: {{"Z": "z/{unit:?}", "r": "sqrt(x^2 + y^2)", "p": "r - 1", "C": "x/r", "S": "y/r", "q": "p^2 + Z^2",
                    "across": "a*p + b*(C*p + S*Z) - q*p"}})"#
        );
        let range = (-3.0, 2.0);
        let search = Search::Guess(TAU / 3.1);
        let (orbit, point) = started(&text, ("a", range), &[1.0, 0.0, 0.0], search).unwrap();
        let (seen, _) = follow(&orbit, &point, true, range, 1000);
        let half = (2.2_f64 * 2.2 - 0.25 * 3.1 * 3.1).sqrt();
        let expected = [(PD, -half, ""), (PD, half, ""), (EP, 2.0, "")];
        meets(&seen, &expected, 1e-12);
    }
}
