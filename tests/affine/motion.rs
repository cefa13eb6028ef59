//! Motions along known periodic orbits, through impacts, stick, sliding and several modes.

use brakewave::affine::motion::{Halt, Motion, Step, Switching};

use crate::affine::systems::{
    BALL, BUCK, CHUA, FRICTION, IMPACT, RELAY, THERMOSTAT, at, place, system,
};

/// A zone of a reference orbit: its mode, its duration, and the state at its end before the reset.
type Zone<'a> = (&'a str, f64, &'a [f64]);

/// Follows an orbit from just after a switch and compares every zone with the reference; errors are relative to
/// the largest number of the zone, and times to the period.
fn agrees(
    text: &str,
    replaced: &[(&str, f64)],
    start: (&str, &[f64], f64),
    zones: &[Zone],
    allowed: f64,
) {
    let system = system(text);
    let affine = at(&system, replaced);
    let (mode, state, phase) = start;
    let period: f64 = zones.iter().map(|(_, duration, _)| duration).sum();
    let mut motion = Motion::new(&affine, place(&system, mode, state, phase), period);
    let mut time = 0.0;
    for (mode, duration, end) in zones {
        let Ok(Step::Switched(Switching {
            time: at,
            from,
            before,
            ..
        })) = motion.step(3.0 * period)
        else {
            panic!("no switch after {time} in {mode}: {:?}", motion.place());
        };
        assert_eq!(system.mode_name(from), *mode, "after {time}");
        let late = (at - time - duration).abs();
        assert!(
            late < allowed * period,
            "{mode}: {} of {duration}",
            at - time
        );
        let size = end.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        for (found, expected) in before.iter().zip(*end) {
            assert!(
                (found - expected).abs() < allowed * size,
                "{mode}: {before:?} for {end:?}"
            );
        }
        time = at;
    }
}

#[test]
fn motions_follow_the_reference_orbits() {
    let tau = std::f64::consts::TAU;
    // a number has 1e-16 of the largest, an unstable orbit multiplies that by its multiplier per period, and each
    // piece adds as much
    agrees(
        IMPACT,
        &[],
        ("free", &[1.0, -1.3565863500759056], 0.07595216493831239),
        &[("free", tau, &[1.0, 1.695732937594882])],
        1e-13,
    );
    // at its fold, from an impact of 4e-3
    agrees(
        IMPACT,
        &[("A", 0.09997075362831327)],
        ("free", &[1.0, -0.0032892245151560843], 1.5466104642377407),
        &[("free", tau, &[1.0, 0.0041115306439451054])],
        1e-12,
    );
    // an impact, a graze and an impact: the touch with speed zero is no impact
    agrees(
        IMPACT,
        &[("A", 2.0902833592017951), ("w", 0.8)],
        ("free", &[1.0, -3.9097702966611666], -0.22376088589243618),
        &[("free", 7.853981633974483, &[1.0, 4.887212870826458])],
        1e-12,
    );
    // half orbits: the other half is the mirror image
    agrees(
        FRICTION,
        &[],
        ("forth", &[-0.5317810120197659, 0.0], -1.3520017654536613),
        &[("forth", 2.6179938779914944, &[0.5317810120197659, 0.0])],
        1e-13,
    );
    agrees(
        FRICTION,
        &[("w", 0.7154524024937617)],
        ("forth", &[-1.3353725171623817, 0.0], -2.3032631942093973),
        &[
            ("forth", 4.357457671131015, &[1.3353725171623817, 0.0]),
            ("stick", 0.03359985085024083, &[1.3353725171623817, 0.0]),
            ("back", 4.357457671131015, &[-1.3353725171623817, 0.0]),
            ("stick", 0.03359985085024083, &[-1.3353725171623817, 0.0]),
        ],
        1e-12,
    );
    // two zones, and the third region never entered
    agrees(
        CHUA,
        &[("alpha", 8.180977741435308)],
        (
            "upper",
            &[1.0, 0.24670019835559305, -0.21924034688918570],
            0.0,
        ),
        &[
            (
                "upper",
                1.3385258278271572,
                &[1.0, -0.3536888989448704, -1.3363052912634864],
            ),
            (
                "inner",
                0.9392728534342899,
                &[1.0, 0.24670019835559305, -0.2192403468891857],
            ),
        ],
        1e-12,
    );
    agrees(
        RELAY,
        &[("rho", 0.1)],
        ("plus", &[0.0, 1.0, 0.26086655101946478], 0.0),
        &[
            (
                "plus",
                7.0802971962724096,
                &[0.0, 0.9928139478692885, -0.21678980709164327],
            ),
            (
                "slide",
                11.219983001198371,
                &[0.0, -1.0, -0.26086655101946478],
            ),
        ],
        1e-11, // sliding leaves where the control comes to ±1 with a slope of 1e-2
    );
    agrees(
        BUCK,
        &[],
        ("off", &[11.998231707599141, 0.5996357983523682, 3.8], 0.0),
        &[
            (
                "off",
                0.45511133260672491 * 4e-4,
                &[11.990772602793999, 0.4901383960180118, 5.8024898634695896],
            ),
            (
                "on",
                0.54488866739327509 * 4e-4,
                &[11.998231707599141, 0.5996357983523682, 8.2],
            ),
        ],
        1e-12,
    );
    agrees(
        BALL,
        &[],
        ("flight", &[0.0, 2.0943951023931955], 0.014141546406084158),
        &[("flight", tau, &[0.0, -4.188790204786391])],
        1e-13,
    );
    agrees(
        THERMOSTAT,
        &[],
        ("on", &[0.9, 0.32830697326469068], 0.0),
        &[
            ("on", 0.8138215577652983, &[1.1, 1.6716930267353093]),
            ("off", 0.8138215577652983, &[0.9, 0.32830697326469068]),
        ],
        1e-13,
    );
}

/// A ball on a table at rest bounces after vₙ = eⁿv₀ for 2vₙ, all of it over at 2v₀/(1 − e).
#[test]
fn chattering_ends_at_its_limit() {
    let system = system(BALL);
    for e in [0.05, 0.3, 0.5, 0.9] {
        let affine = at(&system, &[("G", 0.0), ("e", e)]);
        let mut motion = Motion::new(&affine, place(&system, "flight", &[0.0, 1.0], 0.0), 10.0);
        let (mut bounces, mut speed) = (0, 1.0);
        let halt = loop {
            match motion.step(1e3) {
                Ok(Step::Switched(switching)) => {
                    speed *= e;
                    bounces += 1;
                    if speed > 1e-6 {
                        let relative = switching.after[1] / speed - 1.0;
                        // the time of flight 2v is known to some units of rounding of a piece
                        assert!(relative.abs() < 1e-14 / speed, "{speed:e} {relative:e}");
                    }
                }
                Ok(Step::Reached | Step::Section) => panic!("{bounces} bounces and no end"),
                Err(halt) => break halt,
            }
        };
        let end = 2.0 / (1.0 - e);
        match halt {
            Halt::Chattering { time, ratio } => {
                assert!((time - end).abs() < 1e-9 * end, "{time} for {end}");
                // from the first duration to one of some 1e-6, as a difference of times known to 1e-15
                assert!((ratio - e).abs() < 1e-8, "{ratio} for {e}");
            }
            other => panic!("{other}"),
        }
    }
}

/// A ball falls from y = 1 with the acceleration g = 2 and bounces with e = 0.6 until t = 1 + 2·0.6·2/(2·0.4) = 4, where it rests, also
/// where the last of its flights are looked at on the way: they are at heights below the rounding of the heights before.
#[test]
fn the_last_flights_before_a_rest_are_as_short_as_they_are() {
    let text = r#"(
        states: ["y", "v"], parameters: {"g": 2.0, "e": 0.6}, contacts: {"p": Stop(gap: "y", restitution: "e")},
        rates: {"y": "v", "v": "-g + p"},
    )"#;
    let system = system(text);
    let affine = at(&system, &[]);
    for apart in [10.0, 0.5, 0.01] {
        let start = place(&system, "open", &[1.0, 0.0], 0.0);
        let mut motion = Motion::new(&affine, start, 10.0);
        let (mut last, mut samples) = (0.0, 1);
        while motion.place().time < 5.0 {
            match motion.step(apart * f64::from(samples)) {
                Ok(Step::Switched(switching)) => last = switching.time,
                Ok(Step::Reached | Step::Section) => samples += 1,
                Err(halt) => panic!("{halt}"),
            }
        }
        // flights shorter than 1e-12 of a piece are left out
        assert!((last - 4.0_f64).abs() < 1e-11, "{last} with {apart}");
    }
}

/// Oscillations of 10⁻¹² would take 10¹² pieces: the motion says so and ends, whether its flow is exact or integrated.
#[test]
fn motions_that_are_too_fast_end() {
    for cubic in ["0", "x^3"] {
        let text = format!(
            r#"(
                states: ["x", "v"],
                modes: {{"free": (
                    rates: {{"x": "v", "v": "-1e24*x - {cubic}"}},
                    until: [(zero: "2 - x", to: "free", reset: {{"v": "-v"}})],
                )}},
            )"#
        );
        let system = system(&text);
        let affine = at(&system, &[]);
        let mut motion = Motion::new(&affine, place(&system, "free", &[1.0, 0.0], 0.0), 1.0);
        let halt = motion.step(1.0);
        assert!(
            matches!(halt, Err(Halt::Fast { piece, .. }) if piece < 1e-11),
            "{cubic}: {halt:?}"
        );
    }
}

/// Without forcing and damping the energy of x'' = −x between two elastic walls stays what it is.
#[test]
fn elastic_walls_keep_the_energy() {
    let text = r#"(
        states: ["x", "v"],
        modes: {"free": (
            rates: {"x": "v", "v": "-x"},
            until: [
                (zero: "1 - x", to: "free", reset: {"v": "-v"}),
                (zero: "x + 0.5", to: "free", reset: {"v": "-v"}),
            ],
        )},
    )"#;
    let system = system(text);
    let affine = at(&system, &[]);
    let mut motion = Motion::new(&affine, place(&system, "free", &[0.2, 1.5], 0.0), 10.0);
    let mut switches = 0;
    while motion.place().time < 1000.0 {
        if let Step::Switched(_) = motion.step(1000.0).unwrap() {
            switches += 1;
        }
    }
    let [x, v] = motion.place().state[..] else {
        panic!()
    };
    // from wall to wall by arcs of a circle of this radius
    let radius = (0.2_f64 * 0.2 + 1.5 * 1.5).sqrt();
    let passage = (1.0 / radius).asin() + (0.5 / radius).asin();
    assert!((f64::from(switches) - 1000.0 / passage).abs() < 2.0);
    // each switch adds a few roundings
    assert!((x.hypot(v) - radius).abs() < 1e-16 * 8.0 * f64::from(switches));
}

/// A section is met once on every way up: in the open at the times of sin, at the wall before its impact, and not
/// by a reset that leads across it; a zone that lies in it does not meet it.
#[test]
fn sections_are_met_from_below() {
    let meets = |section: &str, wall: &str, periods: f64| {
        let text = format!(
            r#"(
                states: ["x", "v"],
                modes: {{
                    "free": (
                        rates: {{"x": "v", "v": "-x"}},
                        until: [(zero: "{wall}", to: "held", reset: {{"v": "-v"}})],
                    ),
                    "held": (rates: {{"x": "v", "v": "-x"}}, until: [(zero: "{wall}", to: "free")]),
                    "section": (rates: {{"x": "0", "v": "0"}}, until: [(zero: "{section}", to: "free")]),
                }},
            )"#
        );
        let system = system(&text);
        let affine = at(&system, &[]);
        let start = place(&system, "free", &[0.0, -1.0], 0.0);
        let mut motion = Motion::new(&affine, start, 10.0).watching(2);
        let end = periods * std::f64::consts::TAU;
        let mut times = Vec::new();
        loop {
            match motion.step(end).unwrap() {
                Step::Section => times.push(motion.place().clone()),
                Step::Switched(_) => {}
                Step::Reached => return times,
            }
        }
    };
    let pi = std::f64::consts::PI;
    // x = −sin t rises through 0 at the odd multiples of π, and is greatest at 3π/2
    for (section, wall, first) in [("x", "2 - x", pi), ("-v", "2 - x", 1.5 * pi)] {
        let met = meets(section, wall, 10.2);
        assert_eq!(met.len(), 10);
        for (number, place) in met.iter().enumerate() {
            let time = first + number as f64 * 2.0 * pi;
            // a few roundings of each of the pieces, a radian long at most
            assert!(
                (place.time - time).abs() < 4e-16 * (1.0 + time) * 10.0,
                "{place:?}"
            );
        }
    }
    // an elastic wall at 1/2 met by x = −sin t, v > 0, at 7π/6: from wall to wall it takes 2·(π − π/6 − π/2) + π
    for section in ["x - 0.5", "3*x - 1.5", "2*x - v - v + v + v - 1"] {
        let met = meets(section, "0.5 - x", 6.0);
        let arc = 2.0 * pi - 2.0 * (pi / 3.0);
        let count = ((12.0 * pi - 7.0 * pi / 6.0) / arc).floor() as usize + 1;
        assert_eq!(met.len(), count, "{section}");
        for (number, place) in met.iter().enumerate() {
            let time = 7.0 * pi / 6.0 + number as f64 * arc;
            assert!(
                (place.time - time).abs() < 1e-13 * (1.0 + time),
                "{place:?}"
            );
            // before the impact
            assert!(
                (place.state[1] - 0.75_f64.sqrt()).abs() < 1e-12,
                "{place:?}"
            );
        }
    }
    // the reset leads across v = 0 downwards; upwards v comes at every least x, from π/2 on 4π/3 apart
    assert_eq!(meets("v", "0.5 - x", 6.0).len(), 9);
    assert!(meets("0*x", "0.5 - x", 6.0).is_empty());
}

/// Of an impact oscillator: a reset that does not turn the motion back, a guard of the wrong sign, a start beyond the stop,
/// and a guard that is no function of the state.
#[test]
fn a_motion_that_cannot_go_on_has_one_cause() {
    let halts = |zero: &str, reset: &str, x: f64| {
        let text = format!(
            r#"(states: ["x", "v"], parameters: {{"d": 1.0, "w": 1.0}}, forcing: "w", modes: {{"free": (
                rates: {{"x": "v", "v": "cos(phase) - 0.1*v - x"}},
                until: [(zero: "{zero}", to: "free", reset: {{"v": "{reset}"}})])}})"#
        );
        let system = system(&text);
        let affine = at(&system, &[]);
        let mut motion = Motion::new(&affine, place(&system, "free", &[x, 0.0], 0.0), 6.0);
        loop {
            match motion.step(100.0) {
                Err(halt) => break halt,
                Ok(Step::Reached) => panic!("it goes on"),
                Ok(_) => {}
            }
        }
    };
    assert!(
        matches!(halts("d - x", "0.8*v", 0.0), Halt::Outward { guard: 0, time, .. } if time > 0.0)
    );
    for (zero, x) in [("x - d", 0.0), ("d - x", 2.0)] {
        let halt = halts(zero, "-0.8*v", x);
        assert!(
            matches!(halt, Halt::Outside { value, .. } if value == -1.0),
            "{zero}: {halt}"
        );
    }
    assert_eq!(
        halts("d - d", "-0.8*v", 0.0),
        Halt::Void { mode: 0, guard: 0 }
    );
}
