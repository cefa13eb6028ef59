//! First orbits: by a motion that settles, from a guess, from what was saved; and what is refused.

use std::f64::consts::TAU;

use brakewave::affine::motion::Moment;
use brakewave::affine::orbit::AffineOrbit;
use brakewave::affine::orbit::behaviour::{Behaviour, behaviour};
use brakewave::affine::orbit::start::{Beginning, NoStart, Search, Wanted, first, restart};
use brakewave::linalg::Vector;
use brakewave::orbit::follow::{Follower, Limits};
use brakewave::orbit::special::NoFollower;

use crate::affine::systems::{
    BALL, BUCK, CHUA, FRICTION, IMPACT, RELAY, THERMOSTAT, at, system, values,
};

fn wanted(text: &str, replaced: &[(&str, f64)], parameter: &str, periods: u32) -> Wanted {
    let system = system(text);
    let values = values(&system, replaced);
    Wanted {
        periods,
        values,
        ..Wanted::new(system, parameter, (0.0, 1.0)).unwrap()
    }
}

fn from(
    wanted: &Wanted,
    mode: &str,
    state: &[f64],
    phase: f64,
    search: Search,
) -> Result<(AffineOrbit, Vector), NoStart> {
    let beginning = Beginning {
        mode: wanted.system.mode(mode).unwrap(),
        state: state.to_vec(),
        phase,
    };
    first(wanted, &beginning, search)
}

#[test]
fn motions_settle_on_their_orbits() {
    // the entry of the first zone in the canonical order, from the reference
    type Case<'a> = (
        &'a str,
        &'a [(&'a str, f64)],
        &'a str,
        &'a [f64],
        f64,
        u32,
        &'a str,
        f64,
        usize,
        f64,
    );
    let cases: [Case; 8] = [
        (
            IMPACT,
            &[],
            "free",
            &[0.0, 0.0],
            200.0,
            4,
            "free",
            TAU,
            1,
            -1.3565863500759056077,
        ),
        // period 2 of the doubled orbit: two impacts in four forcing periods
        (
            IMPACT,
            &[("A", 3.2), ("w", 2.6), ("e", 0.7)],
            "free",
            &[1.0, -1.015],
            400.0,
            8,
            "free-free",
            9.6664389341224407337,
            2,
            -0.7 * 1.9181042983376358108,
        ),
        (
            FRICTION,
            &[("w", 0.6)],
            "forth",
            &[0.0, 0.1],
            60.0,
            2,
            "forth-stick-back-stick",
            TAU / 0.6,
            4,
            0.0,
        ),
        (
            CHUA,
            &[("alpha", 7.5)],
            "upper",
            &[1.0, 0.2, -0.07],
            400.0,
            3,
            "inner-upper",
            2.1663362998426486422,
            2,
            -0.344025375990686281,
        ),
        (
            RELAY,
            &[("rho", 0.5)],
            "plus",
            &[0.0, 1.0, 1.4],
            100.0,
            3,
            "plus-slide-minus-slide",
            2.0 * 6.3106196225210411327,
            4,
            1.0,
        ),
        (
            BUCK,
            &[],
            "off",
            &[12.0, 0.6, 3.8],
            0.4,
            3,
            "off-on",
            4e-4,
            2,
            0.59963579835236821478,
        ),
        (
            BALL,
            &[("G", 1.2870106258578293052)],
            "flight",
            &[0.0, 2.0],
            200.0,
            2,
            "flight",
            TAU,
            1,
            2.0943951023931954923,
        ),
        (
            THERMOSTAT,
            &[],
            "on",
            &[0.9, 0.3],
            100.0,
            2,
            "on-off",
            1.6276431155305965835,
            2,
            0.32830697326469068393,
        ),
    ];
    for (text, replaced, mode, state, settle, most, names, period, switches, second) in cases {
        // the doubled orbit is stable beside one that does not reach the wall
        let phase = if names == "free-free" { -0.2147 } else { 0.0 };
        let wanted = wanted(
            text,
            replaced,
            system(text).source.parameters.names().next().unwrap(),
            most,
        );
        let (orbit, point) = from(&wanted, mode, state, phase, Search::Settles(settle))
            .unwrap_or_else(|error| panic!("{names}: {error}"));
        let cycle = orbit.cycle(&point).unwrap();
        assert_eq!(cycle.names.join("-"), names);
        assert!(
            (cycle.period - period).abs() < 1e-12 * period,
            "{names}: {}",
            cycle.period
        );
        assert_eq!(cycle.switches.len(), switches);
        let entry = orbit.at(&point).unwrap().zones[cycle.first].state[1];
        assert!(
            (entry - second).abs() < 1e-12,
            "{names}: {entry} for {second}"
        );
        // what was saved leads back to it
        let saved = orbit.saved(&point).unwrap();
        let (again, same) =
            restart(&wanted, &saved).unwrap_or_else(|error| panic!("{names}: {error}, {saved:?}"));
        assert_eq!(again.sequence, orbit.sequence);
        assert!((same - &point).amax() < 1e-11, "{names}");
        // samples begin with the entry and end where the orbit returns
        let samples = orbit.samples(&point, 10).unwrap();
        assert_eq!(samples.len(), 11 * orbit.sequence.len());
        assert!((samples[0].state[1] - second).abs() < 1e-12);
        assert!((samples.last().unwrap().time - period).abs() < 1e-12 * period);
        // extremes hold for every sample
        for (state, (low, high)) in orbit.extremes(&point).unwrap().into_iter().enumerate() {
            for sample in &samples {
                let x = sample.state[state];
                assert!(
                    x >= low - 1e-12 && x <= high + 1e-12,
                    "{names}: {x} beyond {low}..{high}"
                );
            }
        }
        assert_eq!(orbit.traversals(&point), 1);
    }
}

#[test]
fn an_orbit_without_switches_is_the_linear_one() {
    let wanted = wanted(IMPACT, &[("A", 0.05)], "A", 1);
    let (orbit, point) = from(&wanted, "free", &[0.0, 0.0], 0.0, Search::Settles(200.0)).unwrap();
    let cycle = orbit.cycle(&point).unwrap();
    assert_eq!(
        (cycle.names.join("-"), cycle.switches.len()),
        ("free".to_owned(), 0)
    );
    // x = A sin(phase)/(cw) at resonance
    let state = &orbit.at(&point).unwrap().zones[0].state;
    assert!(
        state[0].abs() < 1e-13 && (state[1] - 0.5).abs() < 1e-13,
        "{state:?}"
    );
}

#[test]
fn guesses_lead_to_unstable_orbits() {
    // the single-impact orbit beyond its period doubling, and the saddle of the ball
    let one = wanted(
        IMPACT,
        &[("A", 7.3751726459191770445), ("w", 2.6), ("e", 0.7)],
        "A",
        2,
    );
    let beginning = Beginning {
        mode: 0,
        state: vec![1.0, -1.679],
        phase: 0.2652,
    };
    let (orbit, point) = first(&one, &beginning, Search::Guess(0.0)).unwrap();
    let speed = orbit.at(&point).unwrap().zones[0].state[1];
    assert!((speed + 0.7 * 2.4).abs() < 1e-12, "{speed}");
    let saddle = wanted(BALL, &[], "G", 1);
    let beginning = Beginning {
        mode: 0,
        state: vec![0.0, 2.09],
        phase: -0.02,
    };
    let (orbit, point) = first(&saddle, &beginning, Search::Guess(0.0)).unwrap();
    let phase = orbit.at(&point).unwrap().zones[0].phase;
    assert!(
        (phase - (TAU - 0.014141546406084157704)).abs() < 1e-12,
        "{phase}"
    );
}

/// x′ = ±1 − x between ±d: each half lasts ln((1 + d)/(1 − d)) = ln 3 for d = 1/2. An orbit that begins where it has
/// just switched comes back to that at the end of its period, a bit before or after the time that is given.
#[test]
fn a_guess_may_begin_just_after_a_switch() {
    let text = r#"(
        states: ["x"],
        parameters: {"d": 0.5, "u": 1.0},
        modes: {
            "up": (rates: {"x": "u - x"}, until: [(zero: "d - x", to: "down")]),
            "down": (rates: {"x": "-u - x"}, until: [(zero: "x + d", to: "up")]),
        },
    )"#;
    let relay = wanted(text, &[], "d", 1);
    let half = 3.0_f64.ln();
    for off in [0.995, 1.0 - 1e-15, 1.0, 1.0 + 1e-15, 1.005] {
        let guess = Search::Guess(2.0 * half * off);
        let (orbit, point) = from(&relay, "up", &[-0.5], 0.0, guess).unwrap();
        let zones = orbit.at(&point).unwrap().zones;
        let durations: Vec<f64> = zones.iter().map(|zone| zone.duration - half).collect();
        assert!(
            durations.len() == 2 && durations.iter().all(|off| off.abs() < 1e-14),
            "{off}: {durations:?}"
        );
    }
}

#[test]
fn what_does_not_return_is_refused() {
    // beyond every doubling the doubled orbit of w = 2.6 is not met within two periods
    let short = wanted(IMPACT, &[("A", 3.2), ("w", 2.6), ("e", 0.7)], "A", 2);
    let refused = from(
        &short,
        "free",
        &[1.0, -1.015],
        -0.2147,
        Search::Settles(400.0),
    )
    .unwrap_err();
    assert!(
        matches!(refused, NoStart::NotPeriodic { periods: 2, .. }),
        "{refused}"
    );
    // a heater too weak to reach the upper threshold
    let rests = wanted(THERMOSTAT, &[("Q", 1.0)], "Q", 1);
    let refused = from(&rests, "on", &[0.9, 0.3], 0.0, Search::Settles(100.0)).unwrap_err();
    assert!(matches!(refused, NoStart::Rests { .. }), "{refused}");
    // a spiral into a focus at the rate 0.0089, which is not at rest yet where no switch is waited for any more
    let spiral = r#"(
        states: ["x", "y"], parameters: {"mu": -0.12, "nu": 0.3, "s": -0.45},
        modes: {"flow": (rates: {
            "x": "2*y + 2*s*x*(1 + x)",
            "y": "(3*x + 2)*(x + s*y) + (mu - 0.2*nu - nu^2)*y",
        })},
    )"#;
    let spiral = wanted(spiral, &[], "mu", 1);
    let refused = from(&spiral, "flow", &[-0.5, 0.0], 0.0, Search::Settles(200.0)).unwrap_err();
    assert!(matches!(refused, NoStart::Rests { .. }), "{refused}");
    // two blocks that are alike all along slip in one instant
    let alike = r#"(states: ["x1", "v1", "x2", "v2"], parameters: {"A": 1.5}, forcing: "0.8",
        contacts: {"q1": Friction(slip: "v1", bound: "0.3"), "q2": Friction(slip: "v2", bound: "0.3")},
        rates: {"x1": "v1", "v1": "A*cos(phase) - 0.05*v1 - x1 - 0.3*(x1 - x2) + q1",
            "x2": "v2", "v2": "A*cos(phase) - 0.05*v2 - x2 - 0.3*(x2 - x1) + q2"})"#;
    let alike = wanted(alike, &[], "A", 1);
    let begin = [0.0, 0.1, 0.0, 0.1];
    let refused = from(
        &alike,
        "forward.forward",
        &begin,
        0.0,
        Search::Settles(300.0),
    );
    let refused = refused.unwrap_err();
    assert!(matches!(refused, NoStart::AtOnce { .. }), "{refused}");
    // a ball on a table at rest
    let chatters = wanted(BALL, &[("G", 0.0)], "G", 1);
    let refused = from(&chatters, "flight", &[0.0, 1.0], 0.0, Search::Settles(10.0)).unwrap_err();
    assert!(matches!(refused, NoStart::Halted(_)), "{refused}");
}

/// Two masses, one of them on a belt: an independent integration finds a largest Lyapunov exponent of 0.037 after t = 10 000,
/// and no return of the motion nearer than 6e-4. Some of its returns are close by chance, by as many as are tried: each is
/// measured by the time of one, and Newton's method is not begun from where no orbit is near.
#[test]
fn a_chaotic_motion_does_not_return() {
    const TWO_MASSES_ON_A_BELT: &str = r#"(
        states: ["x1", "x2", "v1", "v2"],
        parameters: {"vb": 0.3, "kc": 1.2, "ga": 3.0, "c": 0.05},
        define: {"s1": "x1 + kc*(x1 - x2) + c*v1", "s2": "x2 + kc*(x2 - x1) + c*v2"},
        modes: {
            "slow": (rates: {"x1": "v1", "x2": "v2", "v1": "1/(1 + ga*abs(vb - v1)) - s1", "v2": "-s2"}, until: [(zero: "vb - v1", to: "fast")]),
            "fast": (rates: {"x1": "v1", "x2": "v2", "v1": "-1/(1 + ga*abs(v1 - vb)) - s1", "v2": "-s2"}, until: [(zero: "v1 - vb", to: "slow")]),
        },
        sliding: {"stick": ("slow", "fast")},
    )"#;
    let chaos = wanted(TWO_MASSES_ON_A_BELT, &[], "vb", 64);
    let state = [0.3, 0.2, 0.0, 0.1];
    let refused = from(&chaos, "slow", &state, 0.0, Search::Settles(600.0)).unwrap_err();
    assert!(
        matches!(refused, NoStart::NotPeriodic { periods, .. } if periods > 1),
        "{refused}"
    );
}

/// Two masses, one of them on a belt, that come to an orbit of two slips by 0.88 of what is left in each period: still
/// 1.6e-3 off from one return to the next after the 400 units of time given, less and less further on. Period, extreme values
/// and multipliers are those of an independent program (event-driven DOP853 in extended precision, with shooting).
#[test]
fn what_settles_slowly_is_followed_while_it_comes_nearer() {
    let text = r#"(
        states: ["x", "v", "y", "u"],
        parameters: {"ms": 0.626, "g": 2.603, "vb": 0.128, "c": 0.076, "m": 1.664, "K": 1.576, "C": 0.056, "kc": 1.131, "M": 1.931},
        define: {"s": "-x - c*v - kc*(x - y)", "s2": "(-K*y - C*u - kc*(y - x))/M", "mu": "ms/(1 + g*(v - vb)^2)"},
        modes: {
            "slow": (rates: {"x": "v", "v": "(s + mu)/m", "y": "u", "u": "s2"}, until: [(zero: "vb - v", to: "fast")]),
            "fast": (rates: {"x": "v", "v": "(s - mu)/m", "y": "u", "u": "s2"}, until: [(zero: "v - vb", to: "slow")]),
        },
        sliding: {"stick": ("slow", "fast")},
    )"#;
    let slow = wanted(text, &[], "ms", 64);
    let state = [-0.712, -0.019, -0.034, 0.265];
    let (orbit, point) = from(&slow, "slow", &state, 0.0, Search::Settles(400.0)).unwrap();
    let cycle = orbit.cycle(&point).unwrap();
    assert_eq!(orbit.sequence.to_string(), "slow-stick-slow-stick");
    assert!(
        (cycle.period - 16.202_913_860_851_023).abs() < 1e-12,
        "{}",
        cycle.period
    );
    let extremes = [
        (0.025_112_196_597_984_797, 0.566_034_852_648_101_3),
        (-0.260_761_215_007_188_6, 0.128),
        (-0.052_396_104_196_445_414, 0.338_842_684_763_157_3),
        (-0.129_020_372_199_525, 0.186_940_559_736_156_86),
    ];
    for ((low, high), (least, most)) in orbit.extremes(&point).unwrap().iter().zip(extremes) {
        assert!(
            (low - least).abs() < 1e-12 && (high - most).abs() < 1e-12,
            "{low} {high}"
        );
    }
    let multipliers = orbit.multipliers(&point).unwrap();
    for (one, known) in multipliers.iter().zip([1.0, 0.878_555_99, 0.203_522_96]) {
        assert!((one.value.re - known).abs() < 1e-8 && one.value.im == 0.0);
    }
}

/// Coulomb friction that the spring between two masses, or the force, does not overcome: a mass that has come to rest may
/// be anywhere, while the other one, driven, goes on. Where all states rest that is an equilibrium; where a law brings a
/// state to rest at one place the orbit is alone, and is found.
/// An oscillator with other springs on both sides of x = d loses the part e^{-cT} of its amplitude in every period T: wherever it
/// has settled, and whatever numbers are lost by then, it comes to rest on the surface. A relay that switches at ±1e-5 settles on an
/// orbit of that size from a start at 1.
#[test]
fn a_spiral_into_a_point_on_a_surface_comes_to_rest() {
    for d in [0.0, 1.0] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"c": 0.2, "m": 3.0, "d": {d:?}}}, modes: {{
                "p": (rates: {{"x": "y", "y": "d - x - 2*c*y"}}, until: [(zero: "x - d", to: "n")]),
                "n": (rates: {{"x": "y", "y": "m*(d - x) - 2*c*y"}}, until: [(zero: "d - x", to: "p")])}})"#
        );
        for (settle, c, m) in [
            (1.0, 0.1, 4.0),
            (5.0, 0.3, 2.0),
            (50.0, 0.5, 3.0),
            (200.0, 0.1, 5.0),
            (1000.0, 0.25, 2.0),
        ] {
            let wanted = wanted(&text, &[("c", c), ("m", m)], "c", 64);
            let found = from(&wanted, "p", &[d, 1.0], 0.0, Search::Settles(settle));
            let Err(NoStart::Rests { place, .. }) = found else {
                panic!("{d}, {settle}: {found:?}");
            };
            let off = (place.state[0] - d).abs().max(place.state[1].abs());
            assert!(off <= 1e-5, "{:?}", place.state);
        }
    }
    let relay = r#"(states: ["x"], parameters: {"h": 1e-5}, modes: {
        "up": (rates: {"x": "1 - x"}, until: [(zero: "h - x", to: "down")]),
        "down": (rates: {"x": "-1 - x"}, until: [(zero: "x + h", to: "up")])})"#;
    let wanted = wanted(relay, &[], "h", 64);
    let (orbit, point) = from(&wanted, "down", &[1.0], 0.0, Search::Settles(2.0)).unwrap();
    // from ∓h to ±h in the time ln((1 + h)/(1 - h)) each
    let period = 2.0 * (2.0 * 1e-5_f64.atanh());
    let off = (orbit.cycle(&point).unwrap().period / period - 1.0).abs();
    assert!(off < 1e-10, "{off:e}");
}

#[test]
fn a_mass_that_sticks_for_ever_is_told() {
    let text = r#"(
        states: ["x", "v", "y", "u"],
        parameters: {"ms": 1.275, "k": 1.0, "kc": 0.316, "w": 0.691, "A": 0.942},
        forcing: "w",
        define: {"s": "-k*x - kc*(x - y)", "b": "(-1.316*y - 0.123*u - kc*(y - x) + A*cos(phase))/1.803"},
        modes: {
            "slow": (rates: {"x": "v", "v": "s + ms", "y": "u", "u": "b"}, until: [(zero: "-v", to: "fast")]),
            "fast": (rates: {"x": "v", "v": "s - ms", "y": "u", "u": "b"}, until: [(zero: "v", to: "slow")]),
        },
        sliding: {"stick": ("slow", "fast")},
    )"#;
    let stuck = wanted(text, &[], "ms", 12);
    let state = [0.594, -0.112, 0.235, -0.373];
    let stands = from(&stuck, "slow", &state, 0.0, Search::Settles(300.0)).unwrap_err();
    let NoStart::Stands {
        time, mode, states, ..
    } = &stands
    else {
        panic!("{stands}")
    };
    assert_eq!(
        (mode.as_str(), states.join(" ")),
        ("stick", "x v".to_owned())
    );
    assert!(*time > 0.0 && *time < 100.0, "{time}");
    let words = stands.to_string();
    assert!(
        words.contains("in `stick` for ever, where `x`, `v` stand still while the rest moves"),
        "{words}"
    );
    // the force on the mass itself: nothing is left that moves
    let one = r#"(
        states: ["x", "v"],
        parameters: {"ms": 1.0, "w": 0.7, "A": 0.4},
        forcing: "w",
        modes: {
            "slow": (rates: {"x": "v", "v": "A*cos(phase) - x + ms"}, until: [(zero: "-v", to: "fast")]),
            "fast": (rates: {"x": "v", "v": "A*cos(phase) - x - ms"}, until: [(zero: "v", to: "slow")]),
        },
        sliding: {"stick": ("slow", "fast")},
    )"#;
    let rests = wanted(one, &[], "ms", 1);
    let rests = from(&rests, "slow", &[2.3, -0.1], 0.0, Search::Settles(100.0)).unwrap_err();
    assert!(
        matches!(&rests, NoStart::Rests { time, place } if *time > 0.0 && place.state[0].abs() < 0.6),
        "{rests}"
    );
    // the other one's spring and damper bring it to x = 0
    let held = r#"(
        states: ["x", "v", "y"],
        parameters: {"c": 0.5, "w": 0.7, "A": 0.4},
        forcing: "w",
        modes: {"only": (rates: {"x": "v", "v": "-x - c*v", "y": "A*cos(phase) - y"})},
    )"#;
    let held = wanted(held, &[], "A", 1);
    let found = from(&held, "only", &[0.0, 0.0, 0.1], 0.0, Search::Settles(100.0));
    assert!(found.is_ok(), "{:?}", found.err());
}

/// What settles slowly returns after several periods as nearly as after one, and a state may be zero at every switch, or
/// move at none of the entries.
#[test]
fn the_least_period_is_found() {
    let free = [("c", 0.05), ("w", 2.9647), ("A", 2.7887)];
    let slow = wanted(IMPACT, &free, "A", 8);
    let (orbit, _) = from(&slow, "free", &[0.0, 0.0], 0.0, Search::Settles(200.0)).unwrap();
    assert_eq!((orbit.setting.periods, orbit.zones()), (1, 1));
    let relay = wanted(RELAY, &[("rho", 1.1907)], "rho", 64);
    let (orbit, _) = from(&relay, "plus", &[1.0, 0.0, 0.0], 0.0, Search::Settles(80.0)).unwrap();
    assert_eq!(orbit.zones(), 4);
}

/// Impacts that count themselves, set back at every 250th: the orbit has as many zones, and no fewer.
#[test]
fn an_orbit_of_many_periods_starts() {
    let counted = r#"(states: ["x", "v", "k"], parameters: {"A": 1.0}, forcing: "1", modes: {"free": (
        rates: {"x": "v", "v": "A*cos(phase) - 0.1*v - x", "k": "0"}, until: [
            (zero: "1 - x", to: "free", reset: {"v": "-0.8*v", "k": "0"}, if: ["k - 248.5"]),
            (zero: "1 - x", to: "free", reset: {"v": "-0.8*v", "k": "k + 1"})])})"#;
    let wanted = wanted(counted, &[], "A", 250);
    let (orbit, point) = from(&wanted, "free", &[0.0; 3], 0.0, Search::Settles(1000.0)).unwrap();
    assert_eq!((orbit.setting.periods, orbit.zones()), (250, 250));
    let period = orbit.cycle(&point).unwrap().period;
    assert!((period / (250.0 * TAU) - 1.0).abs() <= 1e-12);
}

/// A guard that is zero all along is named as the file has it.
#[test]
fn what_is_stuck_is_named() {
    let text = IMPACT.replace("d - x", "x - x");
    let stuck = from(
        &wanted(&text, &[], "A", 1),
        "free",
        &[0.0, 0.0],
        0.0,
        Search::Settles(1.0),
    );
    let words = stuck.unwrap_err().to_string();
    assert!(
        words.contains("`x - x` of the mode `free` is zero at every state"),
        "{words}"
    );
    // a state beyond the stop is in no mode
    let outside = wanted(IMPACT, &[("e", 1.0)], "A", 1);
    let outside = from(&outside, "free", &[2.0, 0.0], 0.0, Search::Settles(1.0));
    let words = outside.unwrap_err().to_string();
    assert!(
        words.contains("begins outside the mode `free`: `d - x` is -1.0"),
        "{words}"
    );
}

/// Without loss multipliers are exp(±2πi/w): both are 1 at w = 1/2, where every free motion is periodic.
#[test]
fn a_family_of_orbits_has_no_branch() {
    let begin = |w: f64| {
        let x = 0.1 / (1.0 - w * w);
        let free = wanted(IMPACT, &[("c", 0.0), ("A", 0.1), ("w", w)], "A", 1);
        let (orbit, point) = from(&free, "free", &[x, 0.0], 0.0, Search::Guess(0.0)).unwrap();
        let limits = Limits::within((0.05, 1.0));
        Follower::new(orbit, &point, true, limits).map(|_| ())
    };
    assert_eq!(begin(0.5), Err(NoFollower::Family));
    // begun at rest, where neither a state nor its rate has a size
    let rest = wanted(IMPACT, &[("c", 0.0), ("A", 0.1), ("w", 0.5)], "A", 1);
    let found = from(&rest, "free", &[0.0, 0.0], 0.0, Search::Settles(10.0));
    let found = found.map(|(orbit, point)| {
        let limits = Limits::within((0.05, 1.0));
        Follower::new(orbit, &point, true, limits).map(|_| ())
    });
    let family = matches!(found, Err(NoStart::Family(_)) | Ok(Err(NoFollower::Family)));
    assert!(family, "{:?}", found.err());
    assert_eq!(begin(0.45), Ok(()));
}

/// The tent map of slope 1.9 at the ticks of a clock has the exponent ln 1.9; a free oscillator is back after its period, and
/// after no whole number of units of time; motions of a damped one come together.
#[test]
fn motions_are_told_by_how_their_neighbours_part() {
    let looks = |text: &str, state: &[f64], interval: f64| {
        let system = system(text);
        let place = Moment {
            time: 0.0,
            phase: 0.0,
            mode: 0,
            state: state.to_vec(),
        };
        behaviour(&at(&system, &[]), &place, interval)
    };
    let tent = r#"(states: ["x", "y"], modes: {"ticks": (rates: {"x": "1", "y": "0"}, until: [
        (zero: "1 - x", to: "ticks", reset: {"x": "0", "y": "1 - 1.9*y"}, if: ["y"]),
        (zero: "1 - x", to: "ticks", reset: {"x": "0", "y": "1 + 1.9*y"}),
    ])})"#;
    let Some(Behaviour::Chaotic(exponent)) = looks(tent, &[0.5, 0.3], 1.0) else {
        panic!("not chaotic")
    };
    assert!((exponent - 1.9_f64.ln()).abs() < 1e-6, "{exponent}");
    let free = |damping: &str| {
        format!(
            r#"(states: ["x", "v"], modes: {{"only": (rates: {{"x": "v", "v": "-x - {damping}*v"}})}})"#
        )
    };
    assert_eq!(
        looks(&free("0"), &[1.0, 0.0], 1.0),
        Some(Behaviour::QuasiPeriodic)
    );
    assert_eq!(
        looks(&free("0"), &[1.0, 0.0], TAU / 3.0),
        Some(Behaviour::Periodic(3))
    );
    assert_eq!(
        looks(&free("0.1"), &[1.0, 0.0], 1.0),
        Some(Behaviour::Settles)
    );
    let winds_up = r#"(states: ["s", "y"], modes: {"ticks": (rates: {"s": "1", "y": "0.3*s"},
        until: [(zero: "1 - s", to: "ticks", reset: {"s": "0"})])})"#;
    let Some(Behaviour::Drifts(1, by)) = looks(winds_up, &[0.5, 0.0], 1.0) else {
        panic!("no drift")
    };
    assert!((by - 0.15).abs() < 1e-12, "{by}");
}

/// A relay whose signal passes twelve lags: what one state makes of the next falls along the chain in units alike, and the last one is
/// not zero for that. The orbit starts in whatever units the first state stands.
#[test]
fn a_long_chain_starts_in_any_units() {
    const LAGS: usize = 12;
    let period = |unit: f64| {
        let names: Vec<String> = (0..LAGS).map(|lag| format!("\"x{lag}\"")).collect();
        let mode = |name: &str, other: &str, signal: &str, zero: &str| {
            let rate = |lag: usize| match lag {
                0 => format!("({signal} - {unit:e}*x0)/{unit:e}"),
                1 => format!("{unit:e}*x0 - x1"),
                _ => format!("x{} - x{lag}", lag - 1),
            };
            let rates = names.iter().enumerate();
            let rates: Vec<String> = rates
                .map(|(lag, name)| format!("{name}: \"{}\"", rate(lag)))
                .collect();
            let rates = rates.join(", ");
            format!(r#""{name}": (rates: {{{rates}}}, until: [(zero: "{zero}", to: "{other}")])"#)
        };
        let text = format!(
            r#"(states: [{}], parameters: {{"d": 0.1}}, modes: {{{}, {}}})"#,
            names.join(", "),
            mode("p", "m", "-1", "x11 + d"),
            mode("m", "p", "1", "d - x11"),
        );
        let wanted = wanted(&text, &[], "d", 1);
        let mut state = [0.1; LAGS];
        state[0] /= unit;
        let (orbit, point) = from(&wanted, "p", &state, 0.0, Search::Settles(600.0)).unwrap();
        orbit.cycle(&point).unwrap().period
    };
    let expected = period(1.0);
    for unit in [1e-6, 1e-3, 1e6] {
        let period = period(unit);
        assert!(
            (period - expected).abs() < 1e-12 * expected,
            "{unit:e}: {period}"
        );
    }
}
